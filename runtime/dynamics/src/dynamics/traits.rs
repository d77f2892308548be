//! Traits that generic code asks of a robot.

use super::at_rest::either_side;
use super::defaults;
use super::dependent::LimitRows;
use super::lanes::{Instructions, Point, linearize_one_by_one};
use super::manifold::{self, AttitudeError, NO_WIDTHS, QuaternionJoint};
use super::names::{names_of_arms, numbered};
use super::types::{
    Discretization, ForceDerivatives, ForceDerivativesAndMass, InputLimits, Limits, Linearization, Step,
};

/// Equations of motion `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a robot with `N` coordinates and `M` inputs,
/// with `q = gravity + springs − friction`; where friction grows with the load, there is one more term
/// ([`Dynamics::load_friction`]).
///
/// Arrays are indexed by coordinate or input in the order of the module's `JOINT_NAMES` and `INPUT_NAMES`,
/// matrices rows first; units are rad or m, s, N m or N. `y`, `v`, `a`, `u` are the coordinates, velocities,
/// accelerations and inputs.
///
/// The methods with a body combine the others, for modules that were generated without these functions. What
/// a module has is faster, because it shares work.
///
/// # Robots with quaternions
///
/// A floating or spherical joint has a quaternion x, y, z, w among its positions: `NY` position entries, `N`
/// velocities, `ẏ = T(y) v`. Where NY = N, which is the default, v is ẏ. Else:
///
/// - y is an array of NY, everything else has N entries; v stands in place of ẏ, v̇ in place of ÿ. A floating
///   joint has the velocities (linear, angular), a spherical one its angular velocity, in the body's own frame.
/// - `y ⊕ d` ([`Self::integrate`]) and `y₂ ⊖ y₁` ([`Self::difference`]) stand in place of sums and differences,
///   and every derivative by y has N columns: those along ⊕.
/// - Quaternions are taken to be of unit length, see [`Self::check_attitudes`].
/// - [`Self::joint_names`] names velocities, [`Self::position_names`] positions; limits belong to velocity entries
///   and are infinite for positions of joints with a quaternion.
///
/// The bodies of methods about positions serve arms, `y + d` and so on. For other robots they do not compile:
/// whoever implements the trait by hand for a robot with quaternions writes these methods too, or calls
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
/// // It would add quaternions.
/// let _ = Body.integrate(&[0.0; 7], &[0.0; 6]);
/// ```
pub trait Dynamics<const N: usize, const M: usize, const NY: usize = N> {
    /// Names of the coordinates, for messages and logs: the module's `JOINT_NAMES`; "1", "2", … where there
    /// are none. Of a robot with quaternions the names of the velocities.
    fn joint_names(&self) -> [&'static str; N] {
        numbered()
    }

    /// Names of the position entries: those of [`Self::joint_names`] but for robots with quaternions.
    fn position_names(&self) -> [&'static str; NY] {
        *names_of_arms(&self.joint_names())
    }

    /// The joints with a quaternion, in their order; none for arms.
    fn quaternion_joints(&self) -> &'static [QuaternionJoint] {
        const { assert!(NY == N, "a robot with quaternions says which joints have them") }
        &[]
    }

    /// Whether the quaternions of positions are attitudes.
    ///
    /// # Errors
    /// The first one that is zero, not finite, or whose length differs from 1 by more than
    /// [`UNIT_LENGTH`](super::UNIT_LENGTH).
    fn check_attitudes(&self, y: &[f64; NY]) -> Result<(), AttitudeError> {
        manifold::check(self.quaternion_joints(), y)
    }

    /// Positions 0, and the identity for quaternions.
    fn neutral(&self) -> [f64; NY] {
        const { assert!(NY == N, "zero is not an attitude") }
        [0.0; NY]
    }

    /// `y ⊕ d`: the positions that are reached by moving with the velocities d for one second; `X exp(d)` on SE(3)
    /// for a floating joint. Quaternions of the result have unit length to 1e-15.
    fn integrate(&self, y: &[f64; NY], d: &[f64; N]) -> [f64; NY] {
        manifold::integrate(&NO_WIDTHS, y, d)
    }

    /// `to ⊖ from`: the velocities that lead from one to the other within one second, by the shortest rotation.
    /// Both signs of a quaternion are the same attitude.
    fn difference(&self, from: &[f64; NY], to: &[f64; NY]) -> [f64; N] {
        manifold::difference(&NO_WIDTHS, from, to)
    }

    /// The derivatives of `y ⊕ d` by y and by d, both along ⊕ at the result.
    fn integrate_derivatives(&self, _: &[f64; NY], d: &[f64; N]) -> ([[f64; N]; N], [[f64; N]; N]) {
        const { assert!(NY == N, "only for arms they are the identity") }
        manifold::integrate_derivatives(&NO_WIDTHS, d)
    }

    /// The derivatives of `d = to ⊖ from` by `to` and by `from`, both along ⊕.
    fn difference_derivatives(&self, d: &[f64; N]) -> ([[f64; N]; N], [[f64; N]; N]) {
        const { assert!(NY == N, "only for arms they are the identity") }
        manifold::difference_derivatives(&NO_WIDTHS, d)
    }

    /// The Lie bracket `ad_a b` of each joint; zero for arms.
    fn bracket(&self, a: &[f64; N], b: &[f64; N]) -> [f64; N] {
        const { assert!(NY == N, "only for arms it is zero") }
        manifold::bracket(&NO_WIDTHS, a, b)
    }

    /// Gives all quaternions unit length. The result is false if one is zero or not finite, which then is the
    /// identity.
    #[must_use]
    fn normalize(&self, y: &mut [f64; NY]) -> bool {
        const { assert!(NY == N, "only arms have no quaternions") }
        manifold::normalize(&NO_WIDTHS, y)
    }

    /// Calls `f` with the robot as it is at `time` (s). Most robots are the same at all times, and so says this body.
    ///
    /// Of robots with driven joints the equations depend on time: position, velocity and acceleration of these joints
    /// are given. Whatever knows the time asks through this method: plants, predictive controllers, laws in a loop.
    /// Whoever wraps a robot passes it on.
    #[inline]
    fn at_time<R>(&self, time: f64, f: impl FnOnce(&Self) -> R) -> R
    where
        Self: Sized,
    {
        let _ = time;
        f(self)
    }

    /// Position, velocity and acceleration of each driven joint, if the robot has some and their motion is known.
    #[inline]
    fn driven_motion(&self) -> &[[f64; 3]] {
        &[]
    }

    /// Names of the inputs: the module's `INPUT_NAMES`; "1", "2", … if there are none.
    fn input_names(&self) -> [&'static str; M] {
        numbered()
    }

    /// Limits of joints and inputs, as described; [`Self::input_limits`] combines them.
    fn limits(&self) -> Limits<N, M>;

    /// Mass matrix `M(y)`, symmetric and positive definite.
    fn mass_matrix(&self, y: &[f64; NY]) -> [[f64; N]; N];

    /// Coriolis, centrifugal and gyroscopic forces `k(y, ẏ)`, on the left-hand side.
    fn coriolis_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];

    /// Generalized forces of gravity, a part of q.
    fn gravity_forces(&self, y: &[f64; NY]) -> [f64; N];

    /// Generalized forces of springs and dampers, a part of q.
    fn spring_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];

    /// Joint friction `τ(y, ẏ)`, positive for positive velocity; q holds −τ. Most laws depend on the
    /// velocities alone.
    fn friction_torques(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N];

    /// Friction under load `s₁(y, ẏ)`, without unit: what friction gains for each unit of the load τ_l. The load
    /// is what the drive of a joint would exert without friction, `M ÿ + k − gravity − springs`; the whole
    /// friction is `τ + |τ_l| s₁`, see [`load`](super::load) and [`under_load`](super::under_load). Zero for most
    /// robots. Where it is not, `M ÿ + k = q + B u − |τ_l| s₁`.
    fn load_friction(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        defaults::load_friction(self, y, v)
    }

    /// Pairs of coordinates i, j: friction at i, that under load included, may jump where velocity j changes its
    /// sign, as with an exact `sign`. The module's `FRICTION_JUMPS`; how high a jump is depends on positions and
    /// free parameters.
    fn friction_jumps(&self) -> &'static [[usize; 2]];

    /// Joint friction just before and just after rest, `[τ(y, 0−), τ(y, 0+)]` of each joint: the two differ where
    /// [`Self::friction_jumps`] and the jump is not zero at these positions; see [`jumps`](super::jumps).
    fn friction_at_rest(&self, y: &[f64; NY]) -> [[f64; 2]; N] {
        either_side(self.friction_jumps(), |v| self.friction_torques(y, v))
    }

    /// Friction under load just before and just after rest, `[s₁(y, 0−), s₁(y, 0+)]` of each joint; as
    /// [`Self::friction_at_rest`].
    fn load_friction_at_rest(&self, y: &[f64; NY]) -> [[f64; 2]; N] {
        either_side(self.friction_jumps(), |v| self.load_friction(y, v))
    }

    /// Input matrix `B(y)`. The columns of the drives, the first [`Self::drives`] ones, are constant and hold the
    /// gear ratios; the others belong to inputs at frames: cylinders, propellers.
    fn input_matrix(&self, y: &[f64; NY]) -> [[f64; M]; N];

    /// Number of inputs that are drives of joints; they come first. Mostly all.
    fn drives(&self) -> usize {
        M
    }

    /// The columns of B that belong to drives, which are constant; those of other inputs are zero here.
    fn drive_matrix(&self) -> [[f64; M]; N] {
        let mut matrix = self.input_matrix(&self.neutral());
        for row in &mut matrix {
            row.iter_mut().skip(self.drives()).for_each(|entry| *entry = 0.0);
        }
        matrix
    }

    /// Bounds of the inputs that keep the limits of motors and joints: what the loop and the predictive
    /// controllers use, see [`Limits::at_inputs`]. The effort of a joint limits its drives; inputs at frames have
    /// their own limits alone.
    fn input_limits(&self) -> InputLimits<M> {
        self.limits().at_inputs(&self.drive_matrix())
    }

    /// Applied forces `q(y, ẏ) = gravity + springs − τ`, without friction under load.
    fn applied_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        defaults::applied_forces(self, y, v)
    }

    /// Bias forces `k − gravity`; other libraries call them `nle`.
    fn bias_forces(&self, y: &[f64; NY], v: &[f64; N]) -> [f64; N] {
        defaults::bias_forces(self, y, v)
    }

    /// M, k and q at once.
    fn equations_of_motion(&self, y: &[f64; NY], v: &[f64; N]) -> ([[f64; N]; N], [f64; N], [f64; N]) {
        defaults::equations_of_motion(self, y, v)
    }

    /// Forces `M ÿ + k − q` that the inputs must make at the joints, friction under load included.
    fn inverse_dynamics(&self, y: &[f64; NY], v: &[f64; N], a: &[f64; N]) -> [f64; N] {
        defaults::inverse_dynamics(self, y, v, a)
    }

    /// Accelerations `ÿ = M⁻¹ (q + B u − k)`, with friction under load subtracted from q; NaN if M is not
    /// positive definite.
    fn forward_dynamics(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
        defaults::forward_dynamics(self, y, v, u)
    }

    /// Kinetic energy `½ ẏᵀ M ẏ` in J.
    fn kinetic_energy(&self, y: &[f64; NY], v: &[f64; N]) -> f64 {
        defaults::kinetic_energy(self, y, v)
    }
}

/// Analytic derivatives of the equations of motion.
pub trait Differentiable<const N: usize, const M: usize, const NY: usize = N>: Dynamics<N, M, NY> {
    /// Inverse dynamics with its derivatives by coordinates and by velocities; row i belongs to force i. The
    /// third, by accelerations, is the mass matrix; where friction grows with the load, its rows times
    /// `1 + s₁ sign τ_l`.
    fn inverse_dynamics_derivatives(&self, y: &[f64; NY], v: &[f64; N], a: &[f64; N]) -> ForceDerivatives<N>;

    /// The same, and ∂forces/∂ÿ.
    fn inverse_dynamics_derivatives_and_mass_matrix(
        &self,
        y: &[f64; NY],
        v: &[f64; N],
        a: &[f64; N],
    ) -> ForceDerivativesAndMass<N> {
        defaults::inverse_dynamics_derivatives_and_mass_matrix(self, y, v, a)
    }

    /// Forces `B(y) u` of the inputs, and ∂(B u)/∂y, which is zero if all inputs are [drives](Dynamics::drives).
    ///
    /// The body computes the derivative from the others, as `∂f/∂y + (∂f/∂ÿ) (∂ÿ/∂y)` with f the inverse dynamics at the
    /// accelerations that u causes at rest.
    fn input_forces_derivatives(&self, y: &[f64; NY], u: &[f64; M]) -> ([f64; N], [[f64; N]; N]) {
        defaults::input_forces_derivatives(self, y, u)
    }

    /// Linearization of the forward dynamics about a state and an input.
    fn linearize(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M]) -> Linearization<N, M, NY>;

    /// [`Self::linearize`] at each of the points, with the same bits: over eight points at once where the module has
    /// `linearize_lanes`, and else one by one. What is longer of `points` and `results` is not read or written.
    fn linearize_along(
        &self,
        instructions: Instructions,
        points: &[Point<N, M, NY>],
        results: &mut [Linearization<N, M, NY>],
    ) where
        Self: Sized,
    {
        let _ = instructions;
        linearize_one_by_one(self, points, results);
    }

    /// `D = −ad_v` in `δ̇ = D δ + v − v̄`: how small deviations δ from a motion with the velocities v̄ turn, see
    /// [`Linearization`]. Zero for arms.
    fn drift(&self, v: &[f64; N]) -> [[f64; N]; N] {
        if NY == N { [[0.0; N]; N] } else { manifold::drift(|a, b| self.bracket(a, b), v) }
    }
}

/// The length of a state `x = (y, ẏ)`: `NX = 2 N`, which is not a type on stable Rust.
/// [`dynamics!`](crate::dynamics!) implements it, so that `LtvMpc::new(arm, motion, options)` finds all sizes
/// by itself.
pub trait PhaseSpace<const NX: usize> {}

/// All that predictive controllers ask of a model, for code that is generic over it. Whatever
/// [`dynamics!`](crate::dynamics!) wraps with its derivatives has it, and so has a robot that is written by hand with
/// these traits.
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

/// The robot in discrete time. Periods are in s; inputs are held over them.
///
/// All methods have a body, built from [`Differentiable::linearize`] and [`Dynamics::forward_dynamics`];
/// generated modules have the same functions.
#[diagnostic::on_unimplemented(
    note = "a robot with driven joints needs their motion over time: `DrivenRobot::new(robot, motion)` of gelenk-runtime has it"
)]
pub trait Discretizable<const N: usize, const M: usize, const NY: usize = N>:
    Differentiable<N, M, NY>
{
    /// Runge–Kutta steps in one period of [`Self::step`]. The method is stable while `period / SUBSTEPS`
    /// times the fastest rate of the robot [1/s] stays below 2.7; steep friction at standstill makes this
    /// rate large.
    const SUBSTEPS: usize = 1;

    /// Exact zero-order hold of the linearization at `(y, ẏ, u)`: `x⁺ = A_d x + B_d u + c_d`. For robots with
    /// quaternions x is (δ, v), see [`Linearization::discretize_with`].
    ///
    /// Scaling and squaring (Higham, *Functions of Matrices*, 2008, section 10.3): a Taylor polynomial of
    /// degree 17 over 1/64 of a part of the period, six doublings, and repetitions of that part. The part is
    /// the whole period while ν · period ≤ 80, and is halved for each factor of two beyond, at most 18 times.
    /// With a = ‖∂ÿ/∂y‖ and b = ‖∂ÿ/∂ẏ‖, the largest sums of magnitudes in a row, no part of the robot is
    /// faster than ν = (b + √(b² + 4a))/2. Where 24 halvings do not suffice, for ν · period > 2e7, every
    /// entry of the result is +∞, see [`Discretization::is_finite`].
    ///
    /// The terms left out are below 1e-15 of what they belong to. Rounding stays below 1e-12 of the largest
    /// entry of each block, the diagonal ones counted as at least 1.
    fn discretize(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> Discretization<N, M, NY> {
        defaults::discretize(self, y, v, u, period)
    }

    /// State after a period of the nonlinear robot: [`Self::SUBSTEPS`] steps of the classical Runge–Kutta
    /// method of order 4; for robots with quaternions of its form on manifolds (Runge–Kutta–Munthe-Kaas).
    fn step(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> ([f64; NY], [f64; N]) {
        defaults::step(self, y, v, u, period)
    }

    /// [`Self::step`] with the exact derivatives of its result, by the chain rule over the stages.
    fn step_derivatives(&self, y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> Step<N, M, NY> {
        defaults::step_derivatives(self, y, v, u, period)
    }

    /// One step of Newton's method for a period T of the implicit midpoint rule, from the guess that the accelerations
    /// are `a`, with the derivatives there:
    ///
    /// ```text
    ///     v_m = v + T/2 a,   y_m = y ⊕ T/2 v_m,   r = f(y_m, v_m, a) − B(y_m) u
    ///     m = ∂f/∂ÿ,   D = ∂f/∂ẏ,   K = ∂f/∂y − ∂(B u)/∂y,   f the inverse dynamics, all at (y_m, v_m, a)
    ///     (m + T/2 D + T²/4 K Q_h) δv⁺ = (m − T/2 D − T²/4 K Q_h) δv − T K P_h δy + T B δu − T r
    ///     δy⁺ = P δy + T/2 Q (δv + δv⁺)
    /// ```
    ///
    /// with P, Q the derivatives of `y ⊕ T v_m` by y and by the displacement, and P_h, Q_h those of `y ⊕ T/2 v_m`; for arms
    /// all four are the identity. The result is `v + T a` and `y ⊕ T v_m`, moved by what r adds. Where r is zero it is a step
    /// of the rule, and the derivatives are exactly those of this step; else they are off in proportion to r.
    ///
    /// The rule has order 2 and is A-stable: the result is bounded wherever the robot is stable. It is not L-stable: of
    /// velocities that friction stops within much less than T, the sign alternates from step to step. Of a robot with driven
    /// joints the equations are those at its time, which is best the middle of the period.
    ///
    /// Cost: one call of [`Differentiable::inverse_dynamics_derivatives_and_mass_matrix`], of
    /// [`Differentiable::input_forces_derivatives`] and of [`Dynamics::input_matrix`], and one factorization of N × N with
    /// 2 N + M + 1 right-hand sides. Neither M⁻¹ nor the forward dynamics is computed. An entry is not finite where the
    /// matrix on the left is singular.
    ///
    /// Source: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, 2006, section I.1 (the rule) and VI.4 (its
    /// derivatives are the rule for the variational equation).
    fn midpoint_step(
        &self,
        y: &[f64; NY],
        v: &[f64; N],
        a: &[f64; N],
        u: &[f64; M],
        period: f64,
    ) -> Step<N, M, NY> {
        defaults::midpoint_step(self, (y, v, a), u, period)
    }
}
