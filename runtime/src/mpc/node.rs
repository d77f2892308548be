//! States of reference and plan, and predictions of deviations from the reference.

use super::integrate::{add_product, join};
use crate::dynamics::{Dynamics, plain_positions};

/// State with positions and velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node<const N: usize, const NY: usize> {
    pub positions: [f64; NY],
    pub velocities: [f64; N],
}

impl<const N: usize, const NY: usize> Node<N, NY> {
    pub fn is_finite(&self) -> bool {
        self.positions.iter().chain(&self.velocities).all(|x| x.is_finite())
    }

    /// Deviation `(y ⊖ y_ref, v − v_ref)` of this state (y, v) from the state (y_ref, v_ref) of `reference`.
    #[inline]
    pub fn from<const M: usize, const NX: usize>(
        &self,
        reference: &Self,
        model: &impl Dynamics<N, M, NY>,
    ) -> [f64; NX] {
        let displacement = model.difference(&reference.positions, &self.positions);
        join(&displacement, &core::array::from_fn(|i| self.velocities[i] - reference.velocities[i]))
    }

    /// State with the given deviation from this state.
    #[inline]
    pub fn moved<const M: usize, const NX: usize>(
        &self,
        deviation: &[f64; NX],
        model: &impl Dynamics<N, M, NY>,
    ) -> Self {
        let displacement = core::array::from_fn(|i| deviation[i]);
        Self {
            positions: model.integrate(&self.positions, &displacement),
            velocities: core::array::from_fn(|i| self.velocities[i] + deviation[N + i]),
        }
    }

    /// State halfway between this state and `next`.
    pub fn middle<const M: usize>(&self, next: &Self, model: &impl Dynamics<N, M, NY>) -> Self {
        let positions = if N == NY {
            core::array::from_fn(|i| 0.5 * (self.positions[i] + next.positions[i]))
        } else {
            let way = model.difference(&self.positions, &next.positions);
            model.integrate(&self.positions, &way.map(|d| 0.5 * d))
        };
        let velocities = core::array::from_fn(|i| 0.5 * (self.velocities[i] + next.velocities[i]));
        Self { positions, velocities }
    }

    /// Positions and velocities to which limits and rows apply, with one position for each velocity. The positions of
    /// joints with a quaternion are 0, because they have neither limits nor rows.
    pub fn coordinates<const M: usize, const NX: usize>(&self, model: &impl Dynamics<N, M, NY>) -> [f64; NX] {
        join(&plain_positions(model.quaternion_joints(), &self.positions), &self.velocities)
    }
}

/// Linear prediction of the state x after one period, `x⁺ = A x + B (u + d) + c`, with the input u and its
/// disturbance d.
pub(super) struct Prediction<'a, const N: usize, const M: usize, const NY: usize> {
    pub state: &'a [[[[f64; N]; N]; 2]; 2],
    pub input: &'a [[[f64; M]; N]; 2],
    /// Predicted state x⁺. It follows from the state and the input in the field `at`.
    pub next: Node<N, NY>,
    pub at: (Node<N, NY>, [f64; M]),
}

/// Blocks of derivatives with respect to state and input.
type Blocks<const N: usize, const M: usize> = ([[[[f64; N]; N]; 2]; 2], [[[f64; M]; N]; 2]);

/// The blocks of a prediction as derivatives of the deviation after the period with respect to the deviation before
/// the period. Deviations are relative to the reference.
///
/// With `y = y_ref ⊕ e` and `e⁺ = y⁺ ⊖ y_ref⁺`, `∂e⁺/∂e = J_r⁻¹(e⁺) A J_r(e)` in the rows and columns of
/// positions, where J_r is the right Jacobian of the rotation.
///
/// - `before`, `after`: the deviations e and e⁺ of the prediction
pub(super) fn in_deviations<const N: usize, const M: usize, const NY: usize>(
    prediction: &Prediction<'_, N, M, NY>,
    before: &[f64; N],
    after: &[f64; N],
    reference: &[f64; NY],
    model: &impl Dynamics<N, M, NY>,
) -> Blocks<N, M> {
    let (_, by_before) = model.integrate_derivatives(reference, before);
    let (by_after, _) = model.difference_derivatives(after);
    let (mut state, mut input) = (*prediction.state, *prediction.input);
    for half in &mut state {
        let mut block = [[0.0; N]; N];
        add_product(&mut block, &half[0], &by_before);
        half[0] = block;
    }
    for block in &mut state[0] {
        let mut rows = [[0.0; N]; N];
        add_product(&mut rows, &by_after, block);
        *block = rows;
    }
    let mut rows = [[0.0; M]; N];
    add_product(&mut rows, &by_after, &input[0]);
    input[0] = rows;
    (state, input)
}

#[cfg(test)]
#[path = "../../tests/support/quadrotor.rs"]
#[allow(dead_code, missing_docs, reason = "it has the face of a generated module")]
mod quadrotor;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Discretizable;

    gelenk_dynamics::dynamics!(struct Quadrotor = super::quadrotor);

    /// Compares the derivatives of `y⁺ ⊖ y_ref⁺` by `y ⊖ y_ref` with difference quotients, far from the reference.
    #[test]
    fn predictions_are_derivatives_of_deviations() {
        let reference = Node {
            positions: [0.1, 0.2, 1.0, 0.5, -0.5, 0.5, 0.5],
            velocities: [0.3, 0.0, 0.1, 0.2, 1.0, -0.4],
        };
        let end = Node {
            positions: [0.2, 0.1, 1.1, 0.6, 0.0, 0.8, 0.0],
            velocities: [0.1, 0.0, 0.4, -0.2, 1.0, 0.3],
        };
        let deviation: [f64; 12] = [0.4, -0.3, 0.2, 1.1, -0.9, 0.7, 0.5, -0.2, 0.1, 1.0, 2.0, -1.5];
        let at = reference.moved(&deviation, &Quadrotor);
        let u = [3.0, 4.0, 3.5, 4.2];
        let period = 0.05;
        let step = Quadrotor.step_derivatives(&at.positions, &at.velocities, &u, period);
        let next = Node { positions: step.coordinates, velocities: step.velocities };
        let prediction = Prediction { state: &step.state, input: &step.input, next, at: (at, u) };
        let back: [f64; 12] = at.from(&reference, &Quadrotor);
        let ahead: [f64; 12] = next.from(&end, &Quadrotor);
        let (before, after) = (core::array::from_fn(|i| back[i]), core::array::from_fn(|i| ahead[i]));
        let (state, input) = in_deviations(&prediction, &before, &after, &reference.positions, &Quadrotor);
        for j in 0..16 {
            let moved = |h: f64| -> [f64; 12] {
                let (mut deviation, mut u) = (deviation, u);
                if j < 12 {
                    deviation[j] += h
                } else {
                    u[j - 12] += h
                }
                let at = reference.moved(&deviation, &Quadrotor);
                let (positions, velocities) = Quadrotor.step(&at.positions, &at.velocities, &u, period);
                Node { positions, velocities }.from(&end, &Quadrotor)
            };
            let (plus, minus) = (moved(1e-5), moved(-1e-5));
            for i in 0..12 {
                let quotient = (plus[i] - minus[i]) / 2e-5;
                let (half, row) = (i / 6, i % 6);
                let found = match j {
                    0..12 => state[half][j / 6][row][j % 6],
                    _ => input[half][row][j - 12],
                };
                assert!((found - quotient).abs() <= 1e-7, "{i} {j}: {found} is not {quotient}");
            }
        }
    }
}
