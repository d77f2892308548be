/// A quantity that a Runge–Kutta step advances: coordinates or velocities, with or without sensitivities.
pub trait Advance: Copy {
    /// The sum `self + factor · rate`.
    fn advanced(&self, factor: f64, rate: &Self) -> Self;
}

impl<const N: usize> Advance for [f64; N] {
    #[inline]
    fn advanced(&self, factor: f64, rate: &Self) -> Self {
        let mut sum = *self;
        add_scaled(&mut sum, factor, rate);
        sum
    }
}

/// Performs steps of the classical Runge–Kutta method of order 4 (Hairer, Nørsett and Wanner, Solving
/// Ordinary Differential Equations I, 1993, table II.1.2).
pub fn runge_kutta<V: Advance>(
    mut y: V,
    mut v: V,
    period: f64,
    substeps: usize,
    acceleration: impl Fn(&V, &V) -> V,
) -> (V, V) {
    let h = period / substeps as f64;
    for _ in 0..substeps {
        let a1 = acceleration(&y, &v);
        let (y2, v2) = (y.advanced(h / 2.0, &v), v.advanced(h / 2.0, &a1));
        let a2 = acceleration(&y2, &v2);
        let (y3, v3) = (y.advanced(h / 2.0, &v2), v.advanced(h / 2.0, &a2));
        let a3 = acceleration(&y3, &v3);
        let (y4, v4) = (y.advanced(h, &v3), v.advanced(h, &a3));
        let a4 = acceleration(&y4, &v4);
        y = y
            .advanced(h / 6.0, &v)
            .advanced(h / 3.0, &v2)
            .advanced(h / 3.0, &v3)
            .advanced(h / 6.0, &v4);
        v = v
            .advanced(h / 6.0, &a1)
            .advanced(h / 3.0, &a2)
            .advanced(h / 3.0, &a3)
            .advanced(h / 6.0, &a4);
    }
    (y, v)
}
