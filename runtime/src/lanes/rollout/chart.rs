//! Positions of robots with quaternions during a Runge–Kutta step: `y ⊕ d` with a displacement d.
//!
//! The displacement has the rate `v + ½ [d, v] + 1/12 [d, [d, v]]` with the Lie bracket `[·, ·]` (Munthe-Kaas, *High order
//! Runge–Kutta methods on manifolds*, 1999). With the matrix `ad_a b = [a, b]` and `w = [d, v]`, its derivatives are
//!
//! ```text
//!     ∂/∂d: −½ ad_v − 1/12 (ad_w + ad_d ad_v)     ∂/∂v: 1 + ½ ad_d + 1/12 ad_d²
//! ```

use super::super::packed::{pack, unpack};
use super::super::product::{Half, Start, entries, entries_mut, sum};
use super::Motion;
use crate::dynamics::{Discretizable, Point};
use crate::qp::lanes::{Vector, WIDTH, vectorized};

/// Positions on the manifold of four robots. They have only derivatives along ⊕; their values are zero.
#[derive(Debug, Clone)]
pub(super) struct Chart<V, const N: usize, const M: usize> {
    /// Positions at the beginning of the step, and at the present stage.
    pub positions: [Motion<V, N, M>; 2],
    /// Rate of the displacement at the present stage.
    pub rate: Motion<V, N, M>,
}

/// Derivatives of the positions at a stage (with respect to the positions at the beginning and to the displacement), and
/// derivatives of the rate (with respect to displacement and velocities). The last array is the rate.
type Factors<const N: usize> = ([[[f64; N]; N]; 2], [[[f64; N]; N]; 2], [f64; N]);

impl<V: Vector, const N: usize, const M: usize> Chart<V, N, M> {
    /// Sets the positions to the initial state.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.positions = [Motion::zero(); 2];
        self.positions.iter_mut().for_each(|positions| positions.begin(0));
    }

    /// Computes positions and rates at a stage with displacement and velocities `[d, v]`.
    pub fn place<const NY: usize>(
        &mut self,
        model: &impl Discretizable<N, M, NY>,
        [d, v]: [&Motion<V, N, M>; 2],
        starts: &[Point<N, M, NY>; WIDTH],
        points: &mut [Point<N, M, NY>; WIDTH],
    ) {
        let mut values = [[[0.0; N]; WIDTH]; 2];
        for (motion, values) in [d, v].into_iter().zip(&mut values) {
            vectorized!(V, { unpack(entries(&motion.value), values.each_mut().map(|value| &mut value[..])) });
        }
        let [d_values, v_values] = &values;
        let mut factors: [Factors<N>; WIDTH] = [([[[0.0; N]; N]; 2], [[[0.0; N]; N]; 2], [0.0; N]); WIDTH];
        for e in 0..WIDTH {
            let start = &starts[e].positions;
            points[e].positions = model.integrate(start, &d_values[e]);
            let (by_start, by_displacement) = model.integrate_derivatives(start, &d_values[e]);
            let (of_rate, rate) = rate(model, &d_values[e], &v_values[e]);
            factors[e] = ([by_start, by_displacement], of_rate, rate);
        }
        let Self { positions: [start, stage], rate } = self;
        vectorized!(V, {
            let mut half: Half<V, N> = [[[V::zero(); N]; 2]; N];
            for i in 0..N {
                for block in 0..2 {
                    pack(&mut half[i][block], factors.each_ref().map(|factors| &factors.0[block][i][..]));
                }
            }
            combine(stage, &half, [start, d]);
            for i in 0..N {
                for block in 0..2 {
                    pack(&mut half[i][block], factors.each_ref().map(|factors| &factors.1[block][i][..]));
                }
            }
            combine(rate, &half, [d, v]);
            pack(entries_mut(&mut rate.value), factors.each_ref().map(|factors| &factors.2[..]));
        });
    }

    /// Begins the next step at the present positions.
    pub fn continue_from<const NY: usize>(
        &mut self,
        starts: &mut [Point<N, M, NY>; WIDTH],
        points: &[Point<N, M, NY>; WIDTH],
    ) {
        self.positions[0] = self.positions[1];
        for (start, point) in starts.iter_mut().zip(points) {
            start.positions = point.positions;
        }
    }
}

/// Computes the derivatives of a sum `A x + B y` with `half` = (A, B).
#[inline(always)]
fn combine<V: Vector, const N: usize, const M: usize>(
    result: &mut Motion<V, N, M>,
    half: &Half<V, N>,
    [x, y]: [&Motion<V, N, M>; 2],
) {
    sum(&mut result.by_state, Start::Zero, half, &[(0, &x.by_state), (1, &y.by_state)]);
    sum(&mut result.by_inputs, Start::Zero, half, &[(0, &x.by_inputs), (1, &y.by_inputs)]);
}

/// Derivatives of the rate of the displacement with respect to displacement and velocities, then the rate.
fn rate<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    d: &[f64; N],
    v: &[f64; N],
) -> ([[[f64; N]; N]; 2], [f64; N]) {
    let once = model.bracket(d, v);
    let twice = model.bracket(d, &once);
    // Each matrix is −ad of its argument.
    let [of_d, of_v, of_once] = [d, v, &once].map(|velocities| model.drift(velocities));
    let (mut by_d, mut by_v) = ([[0.0; N]; N], [[0.0; N]; N]);
    for i in 0..N {
        by_v[i][i] = 1.0;
        for j in 0..N {
            by_d[i][j] = 0.5 * of_v[i][j] + of_once[i][j] / 12.0;
            by_v[i][j] -= 0.5 * of_d[i][j];
        }
        for k in 0..N {
            let factor = of_d[i][k] / 12.0;
            for j in 0..N {
                by_d[i][j] -= factor * of_v[k][j];
                by_v[i][j] += factor * of_d[k][j];
            }
        }
    }
    ([by_d, by_v], core::array::from_fn(|i| v[i] + 0.5 * once[i] + twice[i] / 12.0))
}
