//! Traits of robots for generic code.

use super::at_rest::either_side;
use super::defaults;
use super::dependent::LimitRows;
use super::lanes::{Instructions, Point};
use super::manifold::{self, AttitudeError, NO_WIDTHS, QuaternionJoint};
use super::names::{names_of_arms, numbered};
use super::types::{
    Discretization, ForceDerivatives, ForceDerivativesAndMass, InputLimits, Limits, Linearization, Step,
};

/// Equations of motion `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a robot with `N` coordinates and `M` inputs. The applied forces are
/// q = gravity + springs − friction. Load-dependent friction is an additional term ([`Dynamics::load_friction`]).
///
/// The arguments `y`, `v`, `a`, `u` are coordinates, velocities, accelerations and inputs. Arrays have one
/// entry for each coordinate or input, in the order of `JOINT_NAMES` and `INPUT_NAMES` of the module.
/// Matrices are stored row by row. Units are rad or m, s, and N m or N (A for inputs that are currents).
///
/// Methods with a default combine other methods. The defaults are used for modules that were generated without the corresponding
/// function. The functions of a module are faster, because they share intermediate results.
///
/// # Robots with quaternions
///
/// The positions of a floating or spherical joint contain a quaternion x, y, z, w. The robot then has `NY` position entries and
/// `N` velocities v, with `ẏ = T(y) v`. If NY = N (the default), v is ẏ. Otherwise:
///
/// - y has NY entries, and all other arrays have N entries. v replaces ẏ, and v̇ replaces ÿ. The velocities of a floating joint are
///   its linear velocity and then its angular velocity. The velocity of a spherical joint is its angular velocity. All these
///   velocities are expressed in the frame of the body.
/// - `y ⊕ d` ([`Self::integrate`]) and `y₂ ⊖ y₁` ([`Self::difference`]) replace sums and differences. Every derivative with respect
///   to y has N columns, which are derivatives with respect to a small displacement d in `y ⊕ d`.
/// - Quaternions must have unit length, see [`Self::check_attitudes`].
/// - [`Self::joint_names`] are the names of the velocities, and [`Self::position_names`] are the names of the positions. Limits
///   belong to velocity entries. Position limits of joints with a quaternion are infinite.
///
/// The default methods on positions, for example the sum `y + d`, are only correct for robots without quaternions (called arms in
/// this documentation). For robots with quaternions these defaults do not compile. Implement these methods, or use
/// [`dynamics!`](crate::dynamics!).
///
/// ```compile_fail,E0080
/// use gelenk_dynamics::dynamics::{Dynamics, Limits};
///
/// struct Body;
///
/// impl Dynamics<6, 4, 7> for Body {
///     fn limits(&self) -> Limits<6, 4> { todo!() }
///     fn mass_matrix(&self, _: &[f64; 7]) -> [[f64; 6]; 6] { todo!() }
///     fn coriolis_forces(&self, _: &[f64; 7], _: &[f64; 6]) -> [f64; 6] { todo!() }
///     fn gravity_forces(&self, _: &[f64; 7]) -> [f64; 6] { todo!() }
///     fn spring_forces(&self, _: &[f64; 7], _: &[f64; 6]) -> [f64; 6] { todo!() }
///     fn friction_torques(&self, _: &[f64; 7], _: &[f64; 6]) -> [f64; 6] { todo!() }
///     fn friction_jumps(&self) -> &'static [[usize; 2]] { todo!() }
///     fn input_matrix(&self, _: &[f64; 7]) -> [[f64; 4]; 6] { todo!() }
/// }
///
/// // The default would add quaternions.
/// let _ = Body.integrate(&[0.0; 7], &[0.0; 6]);
/// ```
pub trait Dynamics<const N: usize, const M: usize, const NY: usize = N> {
    /// Names of the coordinates for messages and logs. They are `JOINT_NAMES` of the module, or "1", "2", … by default. For robots
    /// with quaternions they are the names of the velocities.
    fn joint_names(&self) -> [&'static str; N] {
        numbered()
    }

    /// Names of the position entries. For robots without quaternions they are equal to [`Self::joint_names`].
    fn position_names(&self) -> [&'static str; NY] {
        *names_of_arms(&self.joint_names())
    }

    /// Joints with quaternions in order; empty for robots without quaternions.
    fn quaternion_joints(&self) -> &'static [QuaternionJoint] {
        const { assert!(NY == N, "a robot with quaternions must list its joints with quaternions") }
        &[]
    }

    /// Checks that the quaternions in the positions y are attitudes.
    ///
    /// # Errors
    /// [`AttitudeError`] for the first quaternion that is zero, not finite, or whose length differs from 1 by
    /// more than [`UNIT_LENGTH`](super::UNIT_LENGTH).
    fn check_attitudes(&self, y: &[f64; NY]) -> Result<(), AttitudeError> {
        manifold::check(self.quaternion_joints(), y)
    }

    /// Positions 0 with identity quaternions.
    fn neutral(&self) -> [f64; NY] {
        const { assert!(NY == N, "a quaternion of length 0 is not an attitude") }
        [0.0; NY]
    }

    /// Positions `y ⊕ d` after a motion from y with the constant velocities d for one second. For a floating joint with the pose X
    /// this is `X exp(d)` on SE(3). Quaternions of the result have unit length within 1e-15.
    fn integrate(&self, y: &[f64; NY], d: &[f64; N]) -> [f64; NY] {
        manifold::integrate(&NO_WIDTHS, y, d)
    }

    /// Difference `to ⊖ from`, which are the constant velocities that lead from `from` to `to` in one second. Rotations are the
    /// shortest rotations. Quaternions with opposite signs are the same attitude.
    fn difference(&self, from: &[f64; NY], to: &[f64; NY]) -> [f64; N] {
        manifold::difference(&NO_WIDTHS, from, to)
    }

    /// Derivatives of `y ⊕ d` with respect to small displacements of y, and with respect to d. Their rows are small displacements
    /// of the result.
    fn integrate_derivatives(&self, _: &[f64; NY], d: &[f64; N]) -> ([[f64; N]; N], [[f64; N]; N]) {
        const { assert!(NY == N, "a robot with quaternions must implement the derivatives of its positions") }
        manifold::integrate_derivatives(&NO_WIDTHS, d)
    }

    /// Derivatives of `d = to ⊖ from` with respect to small displacements of `to`, and with respect to small displacements of
    /// `from`.
    fn difference_derivatives(&self, d: &[f64; N]) -> ([[f64; N]; N], [[f64; N]; N]) {
        const { assert!(NY == N, "a robot with quaternions must implement the derivatives of differences") }
        manifold::difference_derivatives(&NO_WIDTHS, d)
    }

    /// Lie bracket `ad_a b` of the velocities a and b of each joint. It is zero for joints without a quaternion.
    fn bracket(&self, a: &[f64; N], b: &[f64; N]) -> [f64; N] {
        const { assert!(NY == N, "a robot with quaternions must implement the Lie bracket") }
        manifold::bracket(&NO_WIDTHS, a, b)
    }

    /// Normalizes all quaternions. If a quaternion is zero or not finite, it is set to the identity, and the result is false.
    #[must_use]
    fn normalize(&self, y: &mut [f64; NY]) -> bool {
        const { assert!(NY == N, "a robot with quaternions must normalize them") }
        manifold::normalize(&NO_WIDTHS, y)
    }

    /// Calls `f` with the robot at `time` (s) and returns the result of `f`. The default ignores the time, which is correct for
    /// robots without driven joints.
    ///
    /// The equations of robots with driven joints depend on the time, because the motion of these joints is prescribed. Plants,
    /// predictive controllers and control laws call this method. A type that wraps a robot must forward the call to this robot.
    #[inline]
    fn at_time<R>(&self, time: f64, f: impl FnOnce(&Self) -> R) -> R
    where
        Self: Sized,
    {
        let _ = time;
        f(self)
    }

    /// Position [rad or m], velocity [rad/s or m/s] and acceleration [rad/s² or m/s²] of each driven joint. The result is empty
    /// for robots without driven joints, and if the motion is unknown.
    #[inline]
    fn driven_motion(&self) -> &[[f64; 3]] {
        &[]
    }

    /// Names of the inputs. They are `INPUT_NAMES` of the module, or "1", "2", … by default.
    fn input_names(&self) -> [&'static str; M] {
        numbered()
    }

    /// Limits of joints and inputs in the description. [`Self::input_limits`] combines limits of motors and joints.
    fn limits(&self) -> Limits<N, M>;

    /// Mass matrix `M(y)`. The matrix is symmetric and positive definite.
    fn mass_matrix(&self, y: &[f64; NY]) -> [[f64; N]; N];

    /// Coriolis, centrifugal and gyroscopic forces `k(y, ẏ)` [N m or N], which are on the left-hand side of the equations.
    fn coriolis_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];

    /// Generalized forces of gravity [N m or N], a part of the applied forces q.
    fn gravity_forces(&self, y: &[f64; NY]) -> [f64; N];

    /// Generalized forces of springs and dampers [N m or N], a part of the applied forces q.
    fn spring_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];

    /// Joint friction `τ(y, ẏ)` [N m or N], which is positive for a positive velocity. The applied forces
    /// contain −τ. Most friction laws only depend on velocities.
    fn friction_torques(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];

    /// Uncertainty of the friction, as inputs `B⁺ diag(σ)` with the pseudoinverse B⁺ of the input matrix. σ_j is the standard
    /// deviation of the friction of joint j at the velocities v [N m or N]. Column j contains the inputs that produce the force
    /// σ_j at joint j, as closely as B allows. The default is zero, which means that friction is known exactly.
    fn friction_uncertainty(&self, y: &[f64; NY], v: &[f64; N]) -> [[f64; N]; M] {
        let _ = (y, v);
        [[0.0; N]; M]
    }

    /// Load-dependent friction `s₁(y, ẏ)`, as friction per unit of the load τ_l (no unit). The load of a
    /// joint is the force of its drive minus all friction, `τ_l = M ÿ + k − gravity − springs` with the mass
    /// matrix M and the Coriolis forces k. The total friction is `τ + |τ_l| s₁` with the other friction τ,
    /// see [`load`](super::load) and [`under_load`](super::under_load). The equations of motion are `M ÿ + k
    /// = q + B u − |τ_l| s₁` with the applied forces q and the forces B u of the inputs. For most robots s₁
    /// is zero.
    fn load_friction(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        defaults::load_friction(self, y, v)
    }

    /// Pairs of coordinates i, j for which friction at i can be discontinuous at a sign change of velocity j, for example because of
    /// an exact `sign`. Load-dependent friction is included. The pairs are `FRICTION_JUMPS` of the module. The size of the jump
    /// depends on positions and free parameters, and can be zero.
    fn friction_jumps(&self) -> &'static [[usize; 2]];

    /// Joint friction just before and just after rest, `[τ(y, 0−), τ(y, 0+)]` of each joint [N m or N]. The two values differ if
    /// [`Self::friction_jumps`] contains the pair i, i of this joint, and the jump is not zero at these positions. See
    /// [`jumps`](super::jumps).
    fn friction_at_rest(&self, y: &[f64; NY]) -> [[f64; 2]; N] {
        either_side(self.friction_jumps(), |v| self.friction_torques(y, v))
    }

    /// Load-dependent friction s₁ per unit of load just before and just after rest, `[s₁(y, 0−), s₁(y, 0+)]`
    /// of each joint. See [`Self::friction_at_rest`].
    fn load_friction_at_rest(&self, y: &[f64; NY]) -> [[f64; 2]; N] {
        either_side(self.friction_jumps(), |v| self.load_friction(y, v))
    }

    /// Input matrix `B(y)`, which maps inputs to generalized forces. The first columns belong to [drives](Self::drives). They are
    /// constant and contain the gear ratios. The other columns belong to inputs at frames, for example cylinders or propellers.
    fn input_matrix(&self, y: &[f64; NY]) -> [[f64; M]; N];

    /// Number of inputs that are drives of joints. The drives precede the other inputs.
    fn drives(&self) -> usize {
        M
    }

    /// Input matrix of the drives alone. The columns of other inputs are zero.
    fn drive_matrix(&self) -> [[f64; M]; N] {
        let mut matrix = self.input_matrix(&self.neutral());
        for row in &mut matrix {
            row.iter_mut().skip(self.drives()).for_each(|entry| *entry = 0.0);
        }
        matrix
    }

    /// Bounds of the inputs [N m, N or A] that keep the limits of motors and joints, see [`Limits::at_inputs`]. The control loop and
    /// predictive controllers use these bounds. The effort limit of a joint limits its drives, but not inputs at frames.
    fn input_limits(&self) -> InputLimits<M> {
        self.limits().at_inputs(&self.drive_matrix())
    }

    /// Applied forces `q(y, ẏ) = gravity + springs − τ` [N m or N] with the friction τ, without
    /// load-dependent friction.
    fn applied_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        defaults::applied_forces(self, y, v)
    }

    /// Bias forces [N m or N]: Coriolis, centrifugal and gyroscopic forces minus gravity. Some libraries call
    /// them nonlinear effects (`nle`).
    fn bias_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        defaults::bias_forces(self, y, v)
    }

    /// Mass matrix M, Coriolis forces k and applied forces q of the equations of motion.
    fn equations_of_motion(&self, y: &[f64; NY], v: &[f64; N]) -> ([[f64; N]; N], [f64; N], [f64; N]) {
        defaults::equations_of_motion(self, y, v)
    }

    /// Forces `M ÿ + k − q` [N m or N] that the inputs must produce at the joints, including load-dependent
    /// friction. M is the mass matrix, k are the Coriolis forces, and q are the applied forces.
    fn inverse_dynamics(&self, y: &[f64; NY], v: &[f64; N], a: &[f64; N]) -> [f64; N] {
        defaults::inverse_dynamics(self, y, v, a)
    }

    /// Accelerations `ÿ = M⁻¹ (q + B u − k)` [rad/s² or m/s²] for the inputs u and the input matrix B. The
    /// applied forces q include load-dependent friction here, and k are the Coriolis forces. The result is
    /// NaN if the mass matrix M is not positive definite.
    fn forward_dynamics(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        defaults::forward_dynamics(self, y, v, u)
    }

    /// Kinetic energy `½ ẏᵀ M ẏ` (J) with the mass matrix M.
    fn kinetic_energy(&self, y: &[f64; NY], v: &[f64; N]) -> f64 {
        defaults::kinetic_energy(self, y, v)
    }
}

/// Analytic derivatives of the equations of motion.
pub trait Differentiable<const N: usize, const M: usize, const NY: usize = N>: Dynamics<N, M, NY> {
    /// Inverse dynamics, and its derivatives with respect to coordinates and velocities. Row i of a
    /// derivative belongs to force i. The derivative with respect to accelerations is the mass matrix. With
    /// load-dependent friction, row i of this matrix is multiplied by `1 + s₁ sign τ_l`, with the friction s₁
    /// per unit of load and the load τ_l of joint i.
    fn inverse_dynamics_derivatives(&self, y: &[f64; NY], v: &[f64; N], a: &[f64; N]) -> ForceDerivatives<N>;

    /// Inverse dynamics and its derivatives with respect to coordinates, velocities and accelerations, see
    /// [`Self::inverse_dynamics_derivatives`].
    fn inverse_dynamics_derivatives_and_mass_matrix(
        &self,
        y: &[f64; NY],
        v: &[f64; N],
        a: &[f64; N],
    ) -> ForceDerivativesAndMass<N> {
        defaults::inverse_dynamics_derivatives_and_mass_matrix(self, y, v, a)
    }

    /// Forces `B(y) u` of the inputs, and their derivative ∂(B u)/∂y. The derivative is zero if all inputs are
    /// [drives](Dynamics::drives).
    ///
    /// The default computes the derivative as `∂f/∂y + (∂f/∂ÿ) (∂ÿ/∂y)`. The inverse dynamics f is evaluated at velocity 0 and at
    /// the accelerations that u causes there.
    fn input_forces_derivatives(&self, y: &[f64; NY], u: &[f64; M]) -> ([f64; N], [[f64; N]; N]) {
        defaults::input_forces_derivatives(self, y, u)
    }

    /// Linearization of the forward dynamics around a state and inputs.
    fn linearize(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M]) -> Linearization<N, M, NY>;

    /// Linearizes at each of the points. The results equal those of [`Self::linearize`] bit for bit. If the module has
    /// `linearize_lanes`, eight points are computed at a time. `points` and `results` should have the same length; additional
    /// elements are ignored.
    fn linearize_along(
        &self,
        instructions: Instructions,
        points: &[Point<N, M, NY>],
        results: &mut [Linearization<N, M, NY>],
    ) where
        Self: Sized,
    {
        let _ = instructions;
        defaults::linearize_one_by_one(self, points, results);
    }

    /// Matrix `D = −ad_v` of the equation `δ̇ = D δ + v − v̄` for small deviations δ from a motion with the velocities v̄, see
    /// [`Linearization`]. D is zero for robots without quaternions.
    fn drift(&self, v: &[f64; N]) -> [[f64; N]; N] {
        if NY == N { [[0.0; N]; N] } else { manifold::drift(|a, b| self.bracket(a, b), v) }
    }
}

/// Length `NX = 2 N` of the state `x = (y, ẏ)` of a robot. A separate trait is necessary because stable Rust cannot compute `2 N`
/// in a type. [`dynamics!`](crate::dynamics!) implements this trait, so the compiler infers all sizes of
/// `LtvMpc::new(arm, motion, options)`.
pub trait PhaseSpace<const NX: usize> {}

/// All traits of a model that predictive controllers need, as one trait for generic code. Every type with these traits implements
/// it, for example modules with derivatives that [`dynamics!`](crate::dynamics!) wraps, and hand-written robots.
pub trait Predictable<
    const N: usize,
    const M: usize,
    const NX: usize,
    const NR: usize = 0,
    const NY: usize = N,
>: Discretizable<N, M, NY> + PhaseSpace<NX> + LimitRows<NR>
{
}

impl<D, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Predictable<N, M, NX, NR, NY> for D
where
    D: Discretizable<N, M, NY> + PhaseSpace<NX> + LimitRows<NR>,
{
}

/// Discrete-time model of a robot. Periods are in s. Inputs are constant during a period.
///
/// All methods have a default, which uses [`Differentiable::linearize`], [`Dynamics::forward_dynamics`] or the derivatives of the
/// inverse dynamics. Generated modules can have functions with the same names, which replace the defaults.
#[diagnostic::on_unimplemented(
    note = "a robot with driven joints needs their motion over time: use `DrivenRobot::new(robot, motion)` of gelenk-runtime"
)]
pub trait Discretizable<const N: usize, const M: usize, const NY: usize = N>:
    Differentiable<N, M, NY>
{
    /// Number of Runge–Kutta steps per period in [`Self::step`]. The method is stable if the fastest rate of the robot [1/s] times
    /// `period / SUBSTEPS` is below 2.7. Steep friction at rest makes this rate large.
    const SUBSTEPS: usize = 1;

    /// Exact zero-order hold `x⁺ = A_d x + B_d u + c_d` of the linearization at `(y, ẏ, u)`, with x = (y, ẏ).
    /// For robots with quaternions x is (δ, v) with a small displacement δ of the positions, see
    /// [`Linearization::discretize_with`].
    ///
    /// The method is scaling and squaring (Higham, *Functions of Matrices*, 2008, section 10.3):
    ///
    /// 1. The fastest rate of the robot is at most ν = (b + √(b² + 4a))/2 with the maximum norms a = ‖∂ÿ/∂y‖ and b = ‖∂ÿ/∂ẏ‖. The
    ///    period is halved h times until ν t ≤ 1.25 for the remaining time t.
    /// 2. A Taylor polynomial of degree 17 gives the integral of exp(A t) over this time, with the system matrix A.
    /// 3. Up to six doublings of the integral, and for h > 6 another h − 6 doublings of the step, lead back to the period.
    ///
    /// If 24 halvings are not enough because ν · period > 2e7, every entry of the result is +∞, see
    /// [`Discretization::is_finite`]. The relative truncation error is below 1e-15. The rounding error is below 1e-12 of the largest
    /// entry of each block. For diagonal blocks this entry counts as at least 1.
    fn discretize(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> Discretization<N, M, NY> {
        defaults::discretize(self, y, v, u, period)
    }

    /// State of the nonlinear robot after a period, computed by [`Self::SUBSTEPS`] steps of the classical Runge–Kutta method of
    /// order 4. For robots with quaternions, the form of this method on manifolds is used (Runge–Kutta–Munthe-Kaas).
    fn step(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> ([f64; NY], [f64; N]) {
        defaults::step(self, y, v, u, period)
    }

    /// State after a period like [`Self::step`], with the exact derivatives of the result. They are computed by the chain rule over
    /// the stages.
    fn step_derivatives(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> Step<N, M, NY> {
        defaults::step_derivatives(self, y, v, u, period)
    }

    /// One Newton step for the implicit midpoint rule over a period T. The accelerations `a` are the initial guess, at which the
    /// derivatives are computed. f is the inverse dynamics:
    ///
    /// ```text
    ///     v_m = v + T/2 a,   y_m = y ⊕ T/2 v_m,   r = f(y_m, v_m, a) − B(y_m) u
    ///     m = ∂f/∂ÿ,   D = ∂f/∂ẏ,   K = ∂f/∂y − ∂(B u)/∂y,   f the inverse dynamics, all at (y_m, v_m, a)
    ///     (m + T/2 D + T²/4 K Q_h) δv⁺ = (m − T/2 D − T²/4 K Q_h) δv − T K P_h δy + T B δu − T r
    ///     δy⁺ = P δy + T/2 Q (δv + δv⁺)
    /// ```
    ///
    /// P and Q are the derivatives of `y ⊕ T v_m` with respect to y and to the displacement. P_h and Q_h are the derivatives of
    /// `y ⊕ T/2 v_m`. For robots without quaternions all four matrices are the identity. The result is `v + T a` and `y ⊕ T v_m`,
    /// corrected for the residual r. If r is zero, the result is a step of the midpoint rule and the derivatives are exact.
    /// Otherwise the error of the derivatives is proportional to r.
    ///
    /// The rule has order 2 and is A-stable, so the result is bounded if the robot is stable. The rule is not L-stable. If friction
    /// stops a velocity within much less than T, the sign of this velocity alternates from step to step. For a robot with driven
    /// joints, the equations at the set time are used, which should be the middle of the period.
    ///
    /// A step makes one call each of [`Differentiable::inverse_dynamics_derivatives_and_mass_matrix`],
    /// [`Differentiable::input_forces_derivatives`] and [`Dynamics::input_matrix`], and one factorization of an N × N matrix with
    /// 2 N + M + 1 right-hand sides. It computes neither M⁻¹ nor the forward dynamics. Entries of the result are not finite if the
    /// matrix on the left-hand side is singular.
    ///
    /// Source: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, 2006, section I.1 (the rule) and
    /// section VI.4 (its derivatives are the rule for the variational equation).
    fn midpoint_step(
        &self,
        y: &[f64; NY],
        v: &[f64; N],
        a: &[f64; N],
        u: &[f64; M],
        period: f64,
    ) -> Step<N, M, NY> {
        defaults::midpoint_step(self, y, v, a, u, period)
    }
}
