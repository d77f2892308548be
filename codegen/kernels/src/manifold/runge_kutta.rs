/// Performs steps of order 4 for positions on a manifold (Munthe-Kaas, High order Runge–Kutta methods on
/// manifolds, 1999). They apply the classical Runge–Kutta method to δ in `y ⊕ δ`, with the rate `δ̇ = v + ½
/// [δ, v] + 1/12 [δ, [δ, v]]`. `[δ, v]` is the Lie bracket. The neglected terms have order 5 in the step
/// length.
pub fn runge_kutta_on_manifold<const J: usize, const N: usize, const NY: usize>(
    widths: &[usize; J],
    y: &[f64; NY],
    v: &[f64; N],
    period: f64,
    substeps: usize,
    acceleration: impl Fn(&[f64; NY], &[f64; N]) -> [f64; N],
) -> ([f64; NY], [f64; N]) {
    let h = period / substeps as f64;
    let (mut y, mut v) = (*y, *v);
    for _ in 0..substeps {
        let first = acceleration(&y, &v);
        let rates = |d: &[f64; N], v: &[f64; N]| {
            (
                displacement_rate(widths, d, v),
                acceleration(&integrate(widths, &y, d), v),
            )
        };
        let (d, next) = step_in_chart([0.0; N], v, first, h, rates);
        (y, v) = (integrate(widths, &y, &d), next);
    }
    (y, v)
}

/// A classical Runge–Kutta step of displacement and velocity. It starts at the displacement 0, at which the
/// rate of the displacement is the velocity.
fn step_in_chart<V: Advance>(
    zero: V,
    v: V,
    a1: V,
    h: f64,
    rates: impl Fn(&V, &V) -> (V, V),
) -> (V, V) {
    let (d2, v2) = (zero.advanced(h / 2.0, &v), v.advanced(h / 2.0, &a1));
    let (r2, a2) = rates(&d2, &v2);
    let (d3, v3) = (zero.advanced(h / 2.0, &r2), v.advanced(h / 2.0, &a2));
    let (r3, a3) = rates(&d3, &v3);
    let (d4, v4) = (zero.advanced(h, &r3), v.advanced(h, &a3));
    let (r4, a4) = rates(&d4, &v4);
    let d = zero
        .advanced(h / 6.0, &v)
        .advanced(h / 3.0, &r2)
        .advanced(h / 3.0, &r3)
        .advanced(h / 6.0, &r4);
    let v = v
        .advanced(h / 6.0, &a1)
        .advanced(h / 3.0, &a2)
        .advanced(h / 3.0, &a3)
        .advanced(h / 6.0, &a4);
    (d, v)
}

/// The rate of the displacement δ from a fixed position.
fn displacement_rate<const J: usize, const N: usize>(
    widths: &[usize; J],
    d: &[f64; N],
    v: &[f64; N],
) -> [f64; N] {
    let mut rate = [f64::NAN; N];
    for (width, _, first) in places(widths) {
        match width {
            1 => write::<1>(&mut rate, first, &read(v, first)),
            4 => {
                let value = chart_rate(cross, &read(d, first), &read(v, first));
                write(&mut rate, first, &value);
            }
            7 => {
                let value = chart_rate(pose_bracket, &read(d, first), &read(v, first));
                write(&mut rate, first, &value);
            }
            _ => {}
        }
    }
    rate
}

/// The rate `v + ½ [δ, v] + 1/12 [δ, [δ, v]]`.
#[inline]
fn chart_rate<const K: usize>(
    bracket: impl Fn(&[f64; K], &[f64; K]) -> [f64; K],
    d: &[f64; K],
    v: &[f64; K],
) -> [f64; K] {
    let once = bracket(d, v);
    let twice = bracket(d, &once);
    core::array::from_fn(|i| v[i] + (once[i] / 2.0 + twice[i] / 12.0))
}
