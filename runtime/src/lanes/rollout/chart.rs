//! Positions of robots with quaternions during a Runge–Kutta step: `y ⊕ d` with a displacement d.
//!
//! The displacement has the rate `v + ½ [d, v] + 1/12 [d, [d, v]]` with the Lie bracket `[·, ·]` (Munthe-Kaas, *High order
//! Runge–Kutta methods on manifolds*, 1999). With the matrix `ad_a b = [a, b]`, for which `ad_[d, v] = ad_d ad_v − ad_v ad_d`, the
//! derivatives of the rate are
//!
//! ```text
//!     ∂/∂d: −½ ad_v − 1/12 (2 ad_d ad_v − ad_v ad_d)     ∂/∂v: 1 + ½ ad_d + 1/12 ad_d²
//! ```

use super::super::packed::{pack, unpack};
use super::super::product::{Half, Start, entries, sum};
use super::{Motion, add_scaled};
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

/// Lie bracket of two velocities: `[a, b]_i = Σ c a_k b_j` over the rows `([i, k, j], c)`.
#[derive(Debug, Clone)]
pub(super) struct Bracket(Vec<([usize; 3], f64)>);

impl Bracket {
    /// Bracket of a robot. A floating joint has 18 rows, a spherical joint has 6, and the other joints have none.
    pub fn new<const N: usize, const M: usize, const NY: usize>(
        model: &impl Discretizable<N, M, NY>,
    ) -> Self {
        let mut rows = Vec::new();
        for k in 0..N {
            let mut unit = [0.0; N];
            unit[k] = 1.0;
            let minus_ad = model.drift(&unit);
            for i in 0..N {
                let entries = minus_ad[i].iter().enumerate().filter(|(_, entry)| **entry != 0.0);
                rows.extend(entries.map(|(j, entry)| ([i, k, j], -entry)));
            }
        }
        Self(rows)
    }

    /// Computes `ad_a b` for each column of b.
    #[inline(always)]
    fn of<V: Vector, const N: usize, const C: usize>(&self, a: &[V; N], b: &[[V; C]; N]) -> [[V; C]; N] {
        let mut product = [[V::zero(); C]; N];
        for ([i, k, j], c) in &self.0 {
            let factor = V::splat(*c) * a[*k];
            add_scaled(&mut product[*i], factor, &b[*j]);
        }
        product
    }
}

impl<V: Vector, const N: usize, const M: usize> Chart<V, N, M> {
    /// Sets the positions to the initial state.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.positions = [Motion::zero(); 2];
        self.positions.iter_mut().for_each(|positions| positions.begin(0));
    }

    /// Computes the positions at a stage with the displacement d.
    pub fn place<const NY: usize>(
        &mut self,
        model: &impl Discretizable<N, M, NY>,
        d: &Motion<V, N, M>,
        starts: &[Point<N, M, NY>; WIDTH],
        points: &mut [Point<N, M, NY>; WIDTH],
    ) {
        let mut values = [[0.0; N]; WIDTH];
        vectorized!(V, { unpack(entries(&d.value), values.each_mut().map(|value| &mut value[..])) });
        let mut tangents = [[[[0.0; N]; N]; 2]; WIDTH];
        for e in 0..WIDTH {
            let start = &starts[e].positions;
            points[e].positions = model.integrate(start, &values[e]);
            tangents[e] = model.integrate_derivatives(start, &values[e]).into();
        }
        let [start, stage] = &mut self.positions;
        vectorized!(V, {
            let mut half: Half<V, N> = [[[V::zero(); N]; 2]; N];
            for i in 0..N {
                for block in 0..2 {
                    pack(&mut half[i][block], tangents.each_ref().map(|tangents| &tangents[block][i][..]));
                }
            }
            combine(stage, &half, [start, d]);
        });
    }

    /// Computes the rate at a stage with displacement and velocities.
    pub fn set_rate(&mut self, bracket: &Bracket, motion: [&Motion<V, N, M>; 2]) {
        vectorized!(V, { set_rate(&mut self.rate, bracket, motion) });
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

/// Computes the rate of the displacement d and its derivatives.
#[inline(always)]
fn set_rate<V: Vector, const N: usize, const M: usize>(
    rate: &mut Motion<V, N, M>,
    bracket: &Bracket,
    [d, v]: [&Motion<V, N, M>; 2],
) {
    let unit = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { V::one() } else { V::zero() }));
    let [of_d, of_v]: [[V; N]; 2] = [d, v].map(|motion| core::array::from_fn(|i| motion.value[i][0][0]));
    let (ad_d, ad_v): ([[V; N]; N], [[V; N]; N]) = (bracket.of(&of_d, &unit), bracket.of(&of_v, &unit));
    let (d_v, v_d, d_d) = (bracket.of(&of_d, &ad_v), bracket.of(&of_v, &ad_d), bracket.of(&of_d, &ad_d));
    let [half_one, twelfth] = [0.5, 1.0 / 12.0].map(V::splat);
    let minus_half = V::splat(-0.5);
    let mut half: Half<V, N> = [[[V::zero(); N]; 2]; N];
    for i in 0..N {
        for j in 0..N {
            let second = twelfth * (v_d[i][j] - (d_v[i][j] + d_v[i][j]));
            half[i][0][j] = ad_v[i][j].mul_add(minus_half, second);
            half[i][1][j] = d_d[i][j].mul_add(twelfth, ad_d[i][j].mul_add(half_one, unit[i][j]));
        }
    }
    combine(rate, &half, [d, v]);
    // The rate is linear in v.
    rate.value = core::array::from_fn(|i| {
        let sum = (0..N).fold(V::zero(), |sum, j| half[i][1][j].mul_add(of_v[j], sum));
        [[sum]]
    });
}
