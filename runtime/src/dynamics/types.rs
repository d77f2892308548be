//! Results with named blocks.

use super::discrete_time;
use super::solve::product;

/// Inverse dynamics and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceDerivatives<const N: usize> {
    /// The forces `M ÿ + k − q`.
    pub forces: [f64; N],
    /// ∂forces/∂y.
    pub by_coordinates: [[f64; N]; N],
    /// ∂forces/∂ẏ.
    pub by_velocities: [[f64; N]; N],
}

/// Accelerations as an affine function of state and input: the lower halves of A, B_x and c of `ẋ = A x + B_x u + c`.
/// The upper halves are `[0 I]`, 0 and 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linearization<const N: usize, const M: usize> {
    /// ∂ÿ/∂y.
    pub by_coordinates: [[f64; N]; N],
    /// ∂ÿ/∂ẏ.
    pub by_velocities: [[f64; N]; N],
    /// ∂ÿ/∂u.
    pub by_inputs: [[f64; M]; N],
    /// What remains: ÿ where y, ẏ and u are zero.
    pub affine: [f64; N],
}

impl<const N: usize, const M: usize> Linearization<N, M> {
    /// Accelerations of the linearized robot.
    #[must_use]
    pub fn accelerations(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        core::array::from_fn(|i| {
            product(&self.by_coordinates[i], y)
                + product(&self.by_velocities[i], v)
                + product(&self.by_inputs[i], u)
                + self.affine[i]
        })
    }

    /// Exact solution over a period (s) in which the inputs are held: the zero-order hold. What
    /// [`Discretizable::discretize`](super::Discretizable::discretize) says of its error holds here.
    #[must_use]
    pub fn discretize(&self, period: f64) -> Discretization<N, M> {
        let linear = (
            self.by_coordinates,
            self.by_velocities,
            self.by_inputs,
            self.affine,
        );
        let (state, input, affine) = discrete_time::zero_order_hold(&linear, period);
        Discretization {
            state,
            input,
            affine,
        }
    }
}

/// Blocks of `x⁺ = A_d x + B_d u + c_d` over a sample time, with `x = (y, ẏ)` and the inputs held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discretization<const N: usize, const M: usize> {
    /// A_d by blocks: `[[∂y⁺/∂y, ∂y⁺/∂ẏ], [∂ẏ⁺/∂y, ∂ẏ⁺/∂ẏ]]`.
    pub state: [[[[f64; N]; N]; 2]; 2],
    /// B_d by blocks: `[∂y⁺/∂u, ∂ẏ⁺/∂u]`.
    pub input: [[[f64; M]; N]; 2],
    /// c_d: what remains of y⁺ and ẏ⁺.
    pub affine: [[f64; N]; 2],
}

impl<const N: usize, const M: usize> Discretization<N, M> {
    /// Whether every entry is finite. Infinite ones stand where the robot is too fast for the period, NaN where its
    /// linearization was not finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let state = self.state.as_flattened().as_flattened().as_flattened();
        let input = self.input.as_flattened().as_flattened();
        let affine = self.affine.as_flattened();
        state
            .iter()
            .chain(input)
            .chain(affine)
            .all(|entry| entry.is_finite())
    }

    /// Coordinates and velocities a sample time later.
    #[must_use]
    pub fn step(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> ([f64; N], [f64; N]) {
        let half = |h: usize| {
            core::array::from_fn(|i| {
                product(&self.state[h][0][i], y)
                    + product(&self.state[h][1][i], v)
                    + product(&self.input[h][i], u)
                    + self.affine[h][i]
            })
        };
        (half(0), half(1))
    }
}

/// A step of the nonlinear robot with its sensitivities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<const N: usize, const M: usize> {
    /// y⁺.
    pub coordinates: [f64; N],
    /// ẏ⁺.
    pub velocities: [f64; N],
    /// Derivatives by the state: `[[∂y⁺/∂y, ∂y⁺/∂ẏ], [∂ẏ⁺/∂y, ∂ẏ⁺/∂ẏ]]`.
    pub state: [[[[f64; N]; N]; 2]; 2],
    /// Derivatives by the inputs: `[∂y⁺/∂u, ∂ẏ⁺/∂u]`.
    pub input: [[[f64; M]; N]; 2],
}

/// Limits of joints and inputs; infinite where the description gives none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<const N: usize, const M: usize> {
    /// Lowest and highest position [rad or m].
    pub position: [[f64; 2]; N],
    /// Highest speed [rad/s or m/s].
    pub velocity: [f64; N],
    /// Nominal force at the joint [N m or N].
    pub effort: [f64; N],
    /// Peak force at the joint [N m or N].
    pub peak_effort: [f64; N],
    /// Magnitude of the input that its motor bears continuously.
    pub input: [f64; M],
    /// Magnitude of the input that its motor bears for a short time.
    pub peak_input: [f64; M],
}
