//! Robots with driven joints, whose motion is prescribed as a function of time.
//!
//! A joint with `motion = "driven"` is not a coordinate. Its position, velocity and acceleration d(t), ḋ(t), d̈(t)
//! are given. Examples are a linear axis with a separate controller, a ship's deck and a turntable. The equations
//! of motion of the coordinates y are
//!
//! ```text
//!     M(y, d) ÿ + k(y, ẏ, d) = q(y, ẏ, d) + B u        k contains M_d d̈
//! ```
//!
//! [`dynamics!`](crate::dynamics!) wraps a generated module as a robot at one time
//! (`struct Arm { driven } = module`). [`DrivenRobot`] adds the motion d(t). Plants, feed-forward, control
//! laws, predictive controllers and observers set the time of each evaluation ([`Dynamics::at_time`]), for
//! example for each stage of an integration. If the time is not set, d is unknown, and every result that
//! depends on d is NaN.
//!
//! ```
//! use gelenk_runtime::driven::DrivenRobot;
//! use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
//! use gelenk_runtime::plant::{Plant, PlantOptions};
//! use gelenk_runtime::trajectory::RestToRest;
//!
//! gelenk_runtime::dynamics!(pub struct RailArm { driven } = gelenk_generated::rail_arm);
//!
//! // The controller of the rail moves it by a metre within two seconds.
//! let rail = RestToRest::new([-0.5], [0.5], 2.0)?;
//! let robot = DrivenRobot::new(RailArm::default(), rail);
//!
//! let mut plant = Plant::new(robot, PlantOptions::default())?;
//! plant.apply(&[0.0; 2], 0.5)?;
//! assert!(plant.state().0[0] < -0.01, "the rail moves from below the arm, which falls back");
//!
//! let motion = RestToRest::new([0.0, 0.3], [0.4, -0.2], 2.0)?;
//! let options = MpcOptions::new(&robot, 0.01, 20);
//! let mpc = LtvMpc::new(robot, motion, options)?;
//! # assert!(mpc.notes().is_empty(), "{:?}", mpc.notes());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Controllers use the time of their trajectory. Plants use the time since their construction. If the two times
//! differ, for example because a loop starts later than the plant, [`DrivenRobot::beginning_at`] sets the time at
//! which the motion begins.

use crate::dynamics::{
    self, Differentiable, Discretizable, DrivenJoints, Dynamics, ForceDerivatives, ForceDerivativesAndMass,
    InputLimits, LimitRows, Limits, Linearization, PhaseSpace, Step,
};
use crate::trajectory::Trajectory;

/// A robot together with the prescribed motion of its `K` driven joints, see the [module](self).
///
/// - `R`: robot at one time, made by [`dynamics!`](crate::dynamics!)
/// - `T`: motion of the K joints, a [`Trajectory`] that is [`Copy`]. Pass a large motion by reference, so
///   that a copy is cheap.
///
/// This type does not call [`begin_period`](Trajectory::begin_period) of `T`. If the motion changes at run time,
/// its owner must call this method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrivenRobot<R, T, const K: usize> {
    /// The robot at `time`.
    robot: R,
    motion: T,
    /// Time at which the motion begins (s).
    begins: f64,
    /// Time of the robot (s); NaN if the time is not set.
    time: f64,
}

impl<R: DrivenJoints<K>, T: Trajectory<K> + Copy, const K: usize> DrivenRobot<R, T, K> {
    /// A robot whose driven joints move along `motion` [rad or m]. The order of the joints is that of
    /// `DRIVEN_NAMES` in the generated module. The field `driven` of `robot` is ignored.
    pub fn new(robot: R, motion: T) -> Self {
        Self { robot, motion, begins: 0.0, time: f64::NAN }.at(f64::NAN)
    }

    /// Sets the time (s) at which the motion begins. The default is 0.
    #[must_use]
    pub fn beginning_at(self, time: f64) -> Self {
        Self { begins: time, ..self }.at(self.time)
    }

    /// The robot at `time` (s). If the time is not finite, the driven motion is unknown.
    #[inline]
    #[must_use]
    pub fn at(&self, time: f64) -> Self {
        Self { robot: self.robot.with_driven(&self.driven_at(time)), time, ..*self }
    }

    /// Position [rad or m], velocity [rad/s or m/s] and acceleration [rad/s² or m/s²] of each driven joint at
    /// `time` (s). The values are NaN if the time is not finite.
    #[inline]
    #[must_use]
    pub fn driven_at(&self, time: f64) -> [[f64; 3]; K] {
        let time = time - self.begins;
        if !time.is_finite() {
            return [[f64::NAN; 3]; K];
        }
        let sample = self.motion.sample(time);
        core::array::from_fn(|i| [sample.positions[i], sample.velocities[i], sample.accelerations[i]])
    }

    /// The robot at one time, for functions that are not in the traits.
    #[must_use]
    pub fn robot(&self) -> &R {
        &self.robot
    }
}

/// Implements methods by calls of the same methods of the robot at the set time.
macro_rules! of_the_robot {
    ($(fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(
            #[inline]
            fn $name(&self, $($argument: $type),*) -> $result {
                self.robot.$name($($argument),*)
            }
        )*
    };
}

impl<R, T, const K: usize, const N: usize, const M: usize> Dynamics<N, M> for DrivenRobot<R, T, K>
where
    R: Dynamics<N, M> + DrivenJoints<K>,
    T: Trajectory<K> + Copy,
{
    #[inline]
    fn at_time<O>(&self, time: f64, f: impl FnOnce(&Self) -> O) -> O {
        f(&self.at(time))
    }

    #[inline]
    fn driven_motion(&self) -> &[[f64; 3]] {
        self.robot.driven_motion()
    }

    of_the_robot! {
        fn joint_names() -> [&'static str; N];
        fn input_names() -> [&'static str; M];
        fn limits() -> Limits<N, M>;
        fn drives() -> usize;
        fn drive_matrix() -> [[f64; M]; N];
        fn input_limits() -> InputLimits<M>;
        fn mass_matrix(y: &[f64; N]) -> [[f64; N]; N];
        fn coriolis_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn gravity_forces(y: &[f64; N]) -> [f64; N];
        fn spring_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn friction_torques(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn load_friction(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn friction_jumps() -> &'static [[usize; 2]];
        fn friction_at_rest(y: &[f64; N]) -> [[f64; 2]; N];
        fn load_friction_at_rest(y: &[f64; N]) -> [[f64; 2]; N];
        fn input_matrix(y: &[f64; N]) -> [[f64; M]; N];
        fn applied_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn bias_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N];
        fn equations_of_motion(y: &[f64; N], v: &[f64; N]) -> ([[f64; N]; N], [f64; N], [f64; N]);
        fn inverse_dynamics(y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> [f64; N];
        fn forward_dynamics(y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> [f64; N];
        fn kinetic_energy(y: &[f64; N], v: &[f64; N]) -> f64;
    }
}

impl<R, T, const K: usize, const N: usize, const M: usize> Differentiable<N, M> for DrivenRobot<R, T, K>
where
    R: Differentiable<N, M> + DrivenJoints<K>,
    T: Trajectory<K> + Copy,
{
    of_the_robot! {
        fn inverse_dynamics_derivatives(y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> ForceDerivatives<N>;
        fn inverse_dynamics_derivatives_and_mass_matrix(
            y: &[f64; N],
            v: &[f64; N],
            a: &[f64; N]
        ) -> ForceDerivativesAndMass<N>;
        fn input_forces_derivatives(y: &[f64; N], u: &[f64; M]) -> ([f64; N], [[f64; N]; N]);
        fn linearize(y: &[f64; N], v: &[f64; N], u: &[f64; M]) -> Linearization<N, M>;
    }
}

/// `discretize` uses the linearization at the set time, which should be the middle of the period. `step` and
/// `step_derivatives` begin at the set time, and each stage of the Runge–Kutta method is evaluated at the time of
/// the stage.
impl<R, T, const K: usize, const N: usize, const M: usize> Discretizable<N, M> for DrivenRobot<R, T, K>
where
    R: Differentiable<N, M> + DrivenJoints<K>,
    T: Trajectory<K> + Copy,
{
    fn step(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M], period: f64) -> ([f64; N], [f64; N]) {
        dynamics::defaults::step_from(self, self.time, y, v, u, period)
    }

    fn step_derivatives(&self, y: &[f64; N], v: &[f64; N], u: &[f64; M], period: f64) -> Step<N, M> {
        dynamics::defaults::step_derivatives_from(self, self.time, y, v, u, period)
    }
}

impl<R: PhaseSpace<NX>, T, const K: usize, const NX: usize> PhaseSpace<NX> for DrivenRobot<R, T, K> {}
impl<R: LimitRows<NR>, T, const K: usize, const NR: usize> LimitRows<NR> for DrivenRobot<R, T, K> {}
