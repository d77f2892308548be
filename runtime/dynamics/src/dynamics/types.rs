//! Types of results with named blocks, and limits.

use super::dependent::{self, DependentJoint};
use super::solve::product;
use super::torque_speed::TorqueSpeedLine;
use gelenk_kernels::discrete_time;

/// Forces of the inverse dynamics and their derivatives. Row i of a derivative belongs to force i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceDerivatives<const N: usize> {
    /// Forces of the inverse dynamics, `M ÿ + k − q` [N m or N], with the mass matrix M, the Coriolis forces
    /// k and the applied forces q.
    pub forces: [f64; N],
    /// Derivative ∂forces/∂y with respect to the coordinates y.
    pub by_coordinates: [[f64; N]; N],
    /// Derivative ∂forces/∂ẏ with respect to the velocities ẏ.
    pub by_velocities: [[f64; N]; N],
}

/// Forces of the inverse dynamics, their derivatives with respect to coordinates and velocities, and ∂forces/∂ÿ.
pub type ForceDerivativesAndMass<const N: usize> = (ForceDerivatives<N>, [[f64; N]; N]);

/// Linearized forward dynamics `ÿ = A_y y + A_v ẏ + B_x u + c` with the blocks A_y, A_v and B_x and the
/// affine term c. The blocks are the lower halves of the matrices in `ẋ = A x + B_x u + c` for the state x =
/// (y, ẏ). The upper halves are `[0 I]`, 0 and 0.
///
/// For a robot with quaternions (NY ≠ N), let ȳ and v̄ be the positions and velocities of the linearization. The derivatives are
/// those with respect to a small displacement δ in `y = ȳ ⊕ δ`: `v̇ = A_y δ + A_v v + B_x u + c`, so `c = v̇ − A_v v̄ − B_x ū`.
/// Small deviations δ from the motion with the velocities v̄ satisfy `δ̇ = D δ + v − v̄` with `D = −ad_v̄`
/// ([`Differentiable::drift`](super::Differentiable::drift)). Therefore A is `[D I; A_y A_v]`. For robots without quaternions D
/// is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linearization<const N: usize, const M: usize, const NY: usize = N> {
    /// Derivative ∂ÿ/∂y of the accelerations with respect to the coordinates (block A_y).
    pub by_coordinates: [[f64; N]; N],
    /// Derivative ∂ÿ/∂ẏ of the accelerations with respect to the velocities (block A_v).
    pub by_velocities: [[f64; N]; N],
    /// Derivative ∂ÿ/∂u of the accelerations with respect to the inputs (block B_x).
    pub by_inputs: [[f64; M]; N],
    /// Affine term c, which is the acceleration of the linearized robot if y, ẏ and u are zero.
    pub affine: [f64; N],
}

impl<const N: usize, const M: usize> Linearization<N, M> {
    /// Accelerations of the linearized robot [rad/s² or m/s²].
    #[must_use]
    pub fn accelerations(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        core::array::from_fn(|i| {
            product(&self.by_coordinates[i], y)
                + product(&self.by_velocities[i], v)
                + product(&self.by_inputs[i], u)
                + self.affine[i]
        })
    }

    /// Discrete-time system (exact zero-order hold) for a period (s) with constant inputs. The accuracy is that of
    /// [`Discretizable::discretize`](super::Discretizable::discretize).
    #[must_use]
    pub fn discretize(&self, period: f64) -> Discretization<N, M> {
        self.held(period)
    }
}

impl<const N: usize, const M: usize, const NY: usize> Linearization<N, M, NY> {
    /// Linearization whose blocks are all zero.
    pub const ZERO: Self = Self {
        by_coordinates: [[0.0; N]; N],
        by_velocities: [[0.0; N]; N],
        by_inputs: [[0.0; M]; N],
        affine: [0.0; N],
    };

    /// Discrete-time system (exact zero-order hold) for a period (s) with constant inputs, for a robot with quaternions. It is the
    /// exact solution of `δ̇ = D δ + v`, `v̇ = A_y δ + A_v v + B_x u + c` for `x = (δ, v)`. `drift` is the matrix D = −ad_v̄.
    ///
    /// δ is the displacement from ȳ. Because `D v̄ = 0`, `δ − v̄ t` is the deviation from the motion with the velocities v̄.
    /// Derivatives of δ⁺ are with respect to small displacements from the final position of the linearized robot.
    #[must_use]
    pub fn discretize_with(&self, drift: &[[f64; N]; N], period: f64) -> Discretization<N, M, NY> {
        let linear = (self.by_coordinates, self.by_velocities, self.by_inputs, self.affine, *drift);
        let (state, input, affine) = discrete_time::zero_order_hold_on_manifold(&linear, period);
        Discretization { state, input, affine }
    }

    #[inline]
    pub(super) fn held(&self, period: f64) -> Discretization<N, M, NY> {
        let linear = (self.by_coordinates, self.by_velocities, self.by_inputs, self.affine);
        let (state, input, affine) = discrete_time::zero_order_hold(&linear, period);
        Discretization { state, input, affine }
    }
}

/// Discrete-time linear system `x⁺ = A_d x + B_d u + c_d` for a period with constant inputs u and the state
/// `x = (y, ẏ)`. For a robot with quaternions (NY ≠ N) the state is `x = (δ, v)` with a displacement δ of the
/// positions and the velocities v, see [`Linearization::discretize_with`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discretization<const N: usize, const M: usize, const NY: usize = N> {
    /// State matrix A_d in blocks `[[∂y⁺/∂y, ∂y⁺/∂ẏ], [∂ẏ⁺/∂y, ∂ẏ⁺/∂ẏ]]`, with positions y⁺ and velocities ẏ⁺
    /// after the period.
    pub state: [[[[f64; N]; N]; 2]; 2],
    /// Input matrix B_d in blocks `[∂y⁺/∂u, ∂ẏ⁺/∂u]`, with positions y⁺ and velocities ẏ⁺ after the period.
    pub input: [[[f64; M]; N]; 2],
    /// Affine terms c_d of the positions and velocities after the period.
    pub affine: [[f64; N]; 2],
}

impl<const N: usize, const M: usize, const NY: usize> Discretization<N, M, NY> {
    /// Whether every entry is finite. Entries are infinite if the robot is too fast for the period. Entries are NaN if the
    /// linearization is not finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let state = self.state.as_flattened().as_flattened().as_flattened();
        let input = self.input.as_flattened().as_flattened();
        let affine = self.affine.as_flattened();
        state.iter().chain(input).chain(affine).all(|entry| entry.is_finite())
    }

    /// Displacement and velocities after a period, for the displacement `d` and the velocities `v` before the
    /// period. With quaternions, displacements are relative to the positions of the linearization. Without
    /// quaternions, the displacements are the coordinates.
    #[must_use]
    pub fn displaced(&self, d: &[f64; N], v: &[f64; N], u: &[f64; M]) -> ([f64; N], [f64; N]) {
        let half = |h: usize| {
            core::array::from_fn(|i| {
                product(&self.state[h][0][i], d)
                    + product(&self.state[h][1][i], v)
                    + product(&self.input[h][i], u)
                    + self.affine[h][i]
            })
        };
        (half(0), half(1))
    }
}

impl<const N: usize, const M: usize> Discretization<N, M> {
    /// Coordinates and velocities after a period.
    #[must_use]
    pub fn step(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> ([f64; N], [f64; N]) {
        self.displaced(y, v, u)
    }
}

/// Result of a step of the nonlinear robot, with its derivatives. For robots with quaternions, derivatives of positions and with
/// respect to positions refer to small displacements (⊕).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<const N: usize, const M: usize, const NY: usize = N> {
    /// Positions y⁺ after the step.
    pub coordinates: [f64; NY],
    /// Velocities ẏ⁺ after the step.
    pub velocities: [f64; N],
    /// Derivatives of the positions y⁺ and velocities ẏ⁺ after the step with respect to the state: `[[∂y⁺/∂y,
    /// ∂y⁺/∂ẏ], [∂ẏ⁺/∂y, ∂ẏ⁺/∂ẏ]]`.
    pub state: [[[[f64; N]; N]; 2]; 2],
    /// Derivatives of the positions y⁺ and velocities ẏ⁺ after the step with respect to the inputs: `[∂y⁺/∂u,
    /// ∂ẏ⁺/∂u]`.
    pub input: [[[f64; M]; N]; 2],
}

impl<const N: usize, const M: usize, const NY: usize> Step<N, M, NY> {
    /// Whether every entry is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let state = self.state.as_flattened().as_flattened().as_flattened();
        let input = self.input.as_flattened().as_flattened();
        let end = self.coordinates.iter().chain(&self.velocities);
        end.chain(state).chain(input).all(|entry| entry.is_finite())
    }
}

/// Limits of joints and inputs. Limits that the description does not contain are infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<const N: usize, const M: usize> {
    /// Lowest and highest positions [rad or m].
    pub position: [[f64; 2]; N],
    /// Largest speeds [rad/s or m/s].
    pub velocity: [f64; N],
    /// Largest continuous forces at the joints [N m or N].
    pub effort: [f64; N],
    /// Largest short-time forces at the joints [N m or N].
    pub peak_effort: [f64; N],
    /// Lowest and highest inputs that the motors can produce continuously [N m, N or A], with 0 between the two values. The effort
    /// limits of the joints apply in addition, see [`Self::at_inputs`].
    pub input: [[f64; 2]; M],
    /// Lowest and highest inputs that the motors can produce for a short time [N m, N or A]. The peak effort limits of the joints
    /// apply in addition.
    pub peak_input: [[f64; 2]; M],
    /// Joints that follow coordinates, and their limits.
    pub dependent: &'static [DependentJoint<N>],
    /// Torque–speed lines of motors.
    pub torque_speed: &'static [TorqueSpeedLine<N>],
}

impl<const N: usize, const M: usize> Limits<N, M> {
    /// Narrows the position and speed limits of coordinates so that joints that follow a single coordinate keep their limits.
    /// Joints that follow several coordinates have no effect.
    #[must_use]
    pub fn narrowed(&self) -> Self {
        let mut limits = *self;
        dependent::narrowed(self.dependent, &mut limits.position, &mut limits.velocity);
        limits
    }

    /// Bounds of the inputs that keep the limits of motors and the effort limits of joints, for an input matrix B. Here motor_j is
    /// the larger magnitude of the limits of input j, and effort_i is the effort limit of joint i:
    ///
    /// ```text
    ///     c_j = min(motor_j, min_i effort_i / |B_ij|)          input j alone
    ///     ū_j = c_j · min(1, min_i effort_i / Σ_l |B_il| c_l)    over the joints i that input j acts on together with others
    /// ```
    ///
    /// The results are the limits of input j, narrowed to ±ū_j. If `|u_j| ≤ ū_j` for all j, then `|(B u)_i| ≤ effort_i` for all i and
    /// all signs of the inputs. If every joint has a separate input with a gear ratio, `ū_j = min(motor_j, effort_i / |ratio|)`. If
    /// several inputs act on a joint, the bound is conservative, because opposing inputs could be larger.
    ///
    /// If a limit is NaN, the result is NaN, which controllers reject.
    #[must_use]
    pub fn at_inputs(&self, input_matrix: &[[f64; M]; N]) -> InputLimits<M> {
        InputLimits {
            nominal: within_efforts(self.input, &self.effort, input_matrix),
            peak: within_efforts(self.peak_input, &self.peak_effort, input_matrix),
        }
    }
}

/// Lowest and highest inputs that keep the limits of motors and joints. Limits that the description does not contain are infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputLimits<const M: usize> {
    /// Continuous limits of motors and joints [N m, N or A].
    pub nominal: [[f64; 2]; M],
    /// Short-time limits of motors and joints [N m, N or A].
    pub peak: [[f64; 2]; M],
}

fn within_efforts<const N: usize, const M: usize>(
    motors: [[f64; 2]; M],
    efforts: &[f64; N],
    input_matrix: &[[f64; M]; N],
) -> [[f64; 2]; M] {
    let mut alone = motors.map(|[low, high]| larger(low.abs(), high.abs()));
    for (row, effort) in input_matrix.iter().zip(efforts) {
        for (bound, b) in alone.iter_mut().zip(row).filter(|(_, b)| **b != 0.0) {
            *bound = smaller(*bound, effort / b.abs());
        }
    }
    let mut share = [1.0; M];
    for (row, effort) in input_matrix.iter().zip(efforts) {
        // A joint with a single input needs no further reduction, which would only add rounding. A joint without a limit does
        // not reduce inputs.
        let several = row.iter().filter(|b| **b != 0.0).count() > 1;
        if !several || *effort == f64::INFINITY {
            continue;
        }
        let together: f64 =
            row.iter().zip(&alone).filter(|(b, _)| **b != 0.0).map(|(b, u)| b.abs() * u).sum();
        for (share, _) in share.iter_mut().zip(row).filter(|(_, b)| **b != 0.0) {
            *share = smaller(*share, effort / together);
        }
    }
    core::array::from_fn(|j| {
        let ([low, high], bound) = (motors[j], alone[j] * share[j]);
        [larger(low, -bound), smaller(high, bound)]
    })
}

/// The larger number; NaN if a number is NaN.
fn larger(a: f64, b: f64) -> f64 {
    -smaller(-a, -b)
}

/// The smaller number; NaN if a number is NaN.
fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

/// Conversion from the results `T` of a function of a module.
pub trait OfResults<T> {
    /// Converts the results of a generated function.
    fn of(results: T) -> Self;
}

impl<const N: usize> OfResults<([f64; N], [[f64; N]; N], [[f64; N]; N])> for ForceDerivatives<N> {
    #[inline]
    fn of((forces, by_coordinates, by_velocities): ([f64; N], [[f64; N]; N], [[f64; N]; N])) -> Self {
        Self { forces, by_coordinates, by_velocities }
    }
}

impl<const N: usize> OfResults<([f64; N], [[f64; N]; N], [[f64; N]; N], [[f64; N]; N])>
    for ForceDerivativesAndMass<N>
{
    #[inline]
    fn of(
        (forces, by_coordinates, by_velocities, mass): (
            [f64; N],
            [[f64; N]; N],
            [[f64; N]; N],
            [[f64; N]; N],
        ),
    ) -> Self {
        (ForceDerivatives { forces, by_coordinates, by_velocities }, mass)
    }
}

impl<const N: usize, const M: usize> OfResults<discrete_time::Linear<N, M>> for Linearization<N, M> {
    #[inline]
    fn of((by_coordinates, by_velocities, by_inputs, affine): discrete_time::Linear<N, M>) -> Self {
        Self { by_coordinates, by_velocities, by_inputs, affine }
    }
}

/// Omits the matrix D, because [`Differentiable::drift`](super::Differentiable::drift) computes it from the velocities.
impl<const N: usize, const M: usize, const NY: usize> OfResults<discrete_time::LinearOnManifold<N, M>>
    for Linearization<N, M, NY>
{
    #[inline]
    fn of(results: discrete_time::LinearOnManifold<N, M>) -> Self {
        let (by_coordinates, by_velocities, by_inputs, affine, _) = results;
        Self { by_coordinates, by_velocities, by_inputs, affine }
    }
}

impl<const N: usize, const M: usize, const NY: usize> OfResults<discrete_time::Discrete<N, M>>
    for Discretization<N, M, NY>
{
    #[inline]
    fn of((state, input, affine): discrete_time::Discrete<N, M>) -> Self {
        Self { state, input, affine }
    }
}

impl<const N: usize, const M: usize, const NY: usize> OfResults<discrete_time::SteppedOnManifold<N, M, NY>>
    for Step<N, M, NY>
{
    #[inline]
    fn of(results: discrete_time::SteppedOnManifold<N, M, NY>) -> Self {
        let (coordinates, velocities, state, input) = results;
        Self { coordinates, velocities, state, input }
    }
}
