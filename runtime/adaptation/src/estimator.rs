//! Recursive estimation of the friction of all joints.

use super::filter::Window;
use super::joint::{Derived, Instant, Joint, Prediction};
use super::law::{JointScale, TERM_NAMES, TERMS, dot, root, terms};
use super::settings::{AdaptationError, AdaptationSettings, MOST_DELAY};
use super::trust::Trust;
use gelenk_dynamics::dynamics::{Dynamics, load, under_load};
use gelenk_kernels::hash::fnv1a;

/// Measurements of one period, as input of [`Adaptation::step`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured<const N: usize> {
    /// Measured positions [rad or m]; `None` without a plausible measurement.
    pub positions: Option<[f64; N]>,
    /// Torques that the drives exerted at the joints during the previous period [N m or N].
    pub torques: [f64; N],
    /// Whether the torque of each joint was at a limit, so that the actual torque of the drive is unknown.
    pub saturated: [bool; N],
    /// Number of periods since the last call.
    pub periods: u32,
}

/// Torques of the described robot at given positions, velocities and accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DescribedForces<const N: usize> {
    /// Torques of the drives by inverse dynamics, including friction [N m or N].
    pub forces: [f64; N],
    /// Friction without its load-dependent part [N m or N].
    pub friction: [f64; N],
    /// Load-dependent friction |τ_l| s₁ [N m or N]. τ_l is the load, the force of the drive without all friction, and s₁ is the
    /// friction per unit of load.
    pub load_friction: [f64; N],
}

impl<const N: usize> DescribedForces<N> {
    /// Torques of `robot` at positions y [rad or m], velocities v [rad/s or m/s] and accelerations a [rad/s² or m/s²].
    pub fn of<const M: usize>(robot: &impl Dynamics<N, M>, y: &[f64; N], v: &[f64; N], a: &[f64; N]) -> Self {
        let (forces, friction) = (robot.inverse_dynamics(y, v, a), robot.friction_torques(y, v));
        Self::new(forces, friction, &robot.load_friction(y, v))
    }

    /// Torques from the functions of a robot.
    ///
    /// - `forces`: inverse dynamics including friction [N m or N]
    /// - `friction`: friction without its load-dependent part [N m or N]
    /// - `shares`: load-dependent friction per unit of load, s₁. The load is the force of the drive without all friction.
    #[must_use]
    pub fn new(forces: [f64; N], friction: [f64; N], shares: &[f64; N]) -> Self {
        let of_load = |i: usize| under_load(load(forces[i] - friction[i], shares[i]), shares[i]);
        Self { forces, friction, load_friction: core::array::from_fn(of_load) }
    }
}

/// State of the learned law of a joint, for logs and figures. The learned law is estimated from the motion.
/// The acting law, which controllers use, follows the learned law or the described law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState {
    /// Coefficients δ of the learned law within their bounds, one for each of the [`terms`].
    pub learned: [f64; TERMS],
    /// Half width of the 90 % confidence interval of each learned coefficient.
    pub half_widths: [f64; TERMS],
    /// Whether the motion excites each term. A term counts as excited if the variance of its coefficient is below half of the
    /// variance before the first sample.
    pub is_excited: [bool; TERMS],
    /// Coefficients δ of the acting law.
    pub acting: [f64; TERMS],
    /// Whether the learned law acts, and the reason.
    pub trust: Trust,
    /// Time of the last change of `trust` (s).
    pub since: f64,
    /// Root-mean-square one-step prediction errors of the described and of the learned law [N m or N]; NaN before the first
    /// sample.
    pub errors: [f64; 2],
    /// Standard deviation of the noise of a sample of the filtered torque [N m or N].
    pub noise: f64,
    /// Number of correlated samples that have the information of one independent sample.
    pub correlated: f64,
    /// Whether the estimator learns from samples at present. False at rest, after a reversal and in saturation.
    pub is_learning: bool,
}

/// A term of the learned law with its coefficient δ, see [`terms`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermState {
    /// Name of the term, one of [`TERM_NAMES`](super::TERM_NAMES).
    pub name: &'static str,
    /// Coefficient δ of the learned law within its bounds.
    pub learned: f64,
    /// Half width of the 90 % confidence interval of the coefficient.
    pub half_width: f64,
    /// Coefficient δ of the acting law, which controllers use.
    pub acting: f64,
    /// Whether the variance of the coefficient is below half of the variance before the first sample. If it is not, the motion
    /// does not excite the term.
    pub is_excited: bool,
}

impl JointState {
    /// Returns the terms that the learned law of the joint has, with their coefficients.
    pub fn terms(&self) -> impl Iterator<Item = TermState> + '_ {
        let term = |k: usize| TermState {
            name: TERM_NAMES[k],
            learned: self.learned[k],
            half_width: self.half_widths[k],
            acting: self.acting[k],
            is_excited: self.is_excited[k],
        };
        (0..TERMS).map(term).filter(|term| term.half_width > 0.0)
    }
}

/// Number of periods for which torques are stored. For the largest delay, the periods before and after an instant are needed.
const HISTORY: usize = MOST_DELAY + 2;

/// Recursive estimator of the friction of a robot with N joints. The [crate](super) explains the method. Friction is learned
/// for joints on which a drive acts. Other joints keep the described law.
#[derive(Debug, Clone, PartialEq)]
pub struct Adaptation<const N: usize> {
    pub(super) settings: AdaptationSettings,
    pub(super) scales: [Option<JointScale>; N],
    pub(super) derived: [Option<Derived>; N],
    pub(super) joints: [Option<Joint>; N],
    window: Window<N>,
    /// Torques of the last periods, newest first.
    torques: [[f64; N]; HISTORY],
    saturated: [[bool; N]; HISTORY],
    /// Number of consecutive periods with known torques.
    known: usize,
    pub(super) periods: f64,
    /// Hash of torques of the described robot.
    pub(super) described: u64,
}

impl<const N: usize> Adaptation<N> {
    /// Constructs an estimator for a robot. The scales of friction follow from the limits and the friction of its description
    /// ([`Magnitudes::scale`]).
    ///
    /// # Errors
    /// - [`AdaptationError::Scale`] if the description of a joint has no finite speed limit, or neither friction nor a finite
    ///   effort limit.
    /// - [`AdaptationError::Setting`] for a setting out of range.
    pub fn for_robot<const M: usize>(
        robot: &impl Dynamics<N, M>,
        settings: AdaptationSettings,
    ) -> Result<Self, AdaptationError> {
        let (limits, inputs) = (robot.limits(), robot.drive_matrix());
        let names = robot.joint_names();
        let mut scales = [None; N];
        for i in 0..N {
            if inputs[i].iter().any(|b| *b != 0.0) {
                let friction = |v: &[f64; N]| robot.friction_torques(&robot.neutral(), v)[i];
                let magnitudes = Magnitudes {
                    speed: limits.velocity[i],
                    effort: limits.peak_effort[i],
                    range: limits.position[i][1] - limits.position[i][0],
                };
                scales[i] =
                    Some(magnitudes.scale(i, friction).ok_or(AdaptationError::Scale { name: names[i] })?);
            }
        }
        Self::new(scales, settings, |y, v, a| DescribedForces::of(robot, y, v, a))
    }

    /// Constructs an estimator for joints with given scales of friction.
    ///
    /// - `scales`: scale of each joint; `None` for joints whose friction is not learned. [`JointScale::is_loaded`] is replaced
    /// - `described`: function that returns the torques of the described robot. The saved state contains a fingerprint of the
    ///   robot, which is computed from these torques and the scales.
    ///
    /// # Errors
    /// [`AdaptationError::Setting`] for a setting out of range.
    pub fn new(
        scales: [Option<JointScale>; N],
        settings: AdaptationSettings,
        described: impl FnOnce(&[f64; N], &[f64; N], &[f64; N]) -> DescribedForces<N>,
    ) -> Result<Self, AdaptationError> {
        settings.check()?;
        // Generic values, at which load-dependent friction is zero only if the joint has none.
        let of = |unit: f64| core::array::from_fn(|i| unit / (i + 1) as f64);
        let forces = described(&of(0.7), &of(0.3), &of(0.5));
        let scales: [Option<JointScale>; N] = core::array::from_fn(|i| {
            let is_loaded = forces.load_friction[i] != 0.0;
            scales[i].map(|scale| JointScale { is_loaded, ..scale })
        });
        let derived = scales.map(|scale| scale.map(|scale| Derived::new(&settings, &scale)));
        let joint =
            |i: usize| derived[i].zip(scales[i]).map(|(derived, scale)| Joint::new(i, &derived, &scale));
        Ok(Self {
            settings,
            scales,
            derived,
            joints: core::array::from_fn(joint),
            window: Window::EMPTY,
            torques: [[0.0; N]; HISTORY],
            saturated: [[false; N]; HISTORY],
            known: 0,
            periods: 0.0,
            described: hash(forces.forces.into_iter().chain(forces.friction)),
        })
    }

    /// Returns the settings of the estimator.
    #[must_use]
    pub fn settings(&self) -> &AdaptationSettings {
        &self.settings
    }

    /// Returns the scale of friction of each joint; `None` for joints whose friction is not learned.
    #[must_use]
    pub fn scales(&self) -> &[Option<JointScale>; N] {
        &self.scales
    }

    /// Restarts at time 0: forgets motion and torques of the last periods, but keeps the learned laws.
    pub fn restart(&mut self) {
        self.window.clear();
        self.known = 0;
        self.periods = 0.0;
        for (joint, derived) in self.joints.iter_mut().zip(&self.derived) {
            if let (Some(joint), Some(derived)) = (joint, derived) {
                joint.pause(derived);
                joint.since = 0.0;
            }
        }
    }

    /// Processes the measurements of one period. Does not allocate.
    ///
    /// The sample belongs to the time one period ago, because central differences need earlier and later positions.
    ///
    /// - `described`: function that returns the torques of the described robot for positions, velocities and accelerations. It
    ///   is called at most once.
    pub fn step(
        &mut self,
        measured: &Measured<N>,
        described: impl FnOnce(&[f64; N], &[f64; N], &[f64; N]) -> DescribedForces<N>,
    ) {
        self.periods += f64::from(measured.periods);
        if measured.periods > 1 {
            self.window.clear();
            self.known = 0;
        }
        self.torques.rotate_right(1);
        self.saturated.rotate_right(1);
        (self.torques[0], self.saturated[0]) = (measured.torques, measured.saturated);
        self.known = (self.known + 1).min(HISTORY);
        match &measured.positions {
            Some(positions) if self.known > self.settings.delay => {
                self.window.push(positions);
            }
            _ => self.window.clear(),
        }
        let instants = self.instants(described);
        let time = self.periods * self.settings.period;
        for i in 0..N {
            if let (Some(joint), Some(derived), Some(scale)) =
                (&mut self.joints[i], &self.derived[i], &self.scales[i])
            {
                joint.step(&self.settings, derived, scale, instants.as_ref().map(|all| &all[i]), time);
            }
        }
    }

    /// Motion and unexplained torque of all joints one period ago; `None` if a number is not finite or a speed is impossible.
    fn instants(
        &self,
        described: impl FnOnce(&[f64; N], &[f64; N], &[f64; N]) -> DescribedForces<N>,
    ) -> Option<[Instant; N]> {
        let [y, v, a] = self.window.middle(self.settings.period)?;
        let possible = |i: usize| self.scales[i].is_none_or(|scale| v[i].abs() <= 2.0 * scale.speed);
        if !(0..N).all(possible) {
            return None;
        }
        let DescribedForces { forces, friction, load_friction } = described(&y, &v, &a);
        let ends = [self.settings.delay, self.settings.delay + 1];
        let instant = |i: usize| {
            let measured = ends.map(|ago| self.torques[ago][i]);
            let applied = 0.5 * (measured[0] + measured[1]);
            Instant {
                position: y[i],
                velocity: v[i],
                friction: friction[i],
                load_friction: load_friction[i],
                measured,
                applied,
                torque: applied - forces[i],
                is_exact: !ends.iter().any(|ago| self.saturated[*ago][i]),
            }
        };
        let instants: [Instant; N] = core::array::from_fn(instant);
        let finite =
            |now: &Instant| [now.torque, now.friction, now.load_friction].iter().all(|x| x.is_finite());
        instants.iter().all(finite).then_some(instants)
    }

    /// Returns the state of the learned law of each joint; `None` for joints whose friction is not learned.
    #[must_use]
    pub fn states(&self) -> [Option<JointState>; N] {
        core::array::from_fn(|i| {
            let (joint, derived) = (self.joints[i].as_ref()?, self.derived[i].as_ref()?);
            Some(JointState {
                learned: joint.learned,
                half_widths: joint.term_half_widths(),
                is_excited: core::array::from_fn(|k| joint.law.covariance[k][k] < 0.5 * derived.unknown[k]),
                acting: joint.acting,
                trust: joint.trust,
                since: joint.since,
                errors: joint.comparison.errors(),
                noise: root(joint.bank.noise),
                correlated: joint.bank.correlated(),
                is_learning: joint.settling == 0,
            })
        })
    }

    /// Returns the sample of each joint in the last period. Samples are several periods apart. In the periods between them, the
    /// entry is `None`.
    #[must_use]
    pub fn predictions(&self) -> [Option<Prediction>; N] {
        core::array::from_fn(|i| self.joints[i].as_ref()?.prediction)
    }

    /// Returns the coefficients δ ([`terms`]) of the acting law of each joint; zero for joints whose friction is not learned.
    #[must_use]
    pub fn acting(&self) -> [[f64; TERMS]; N] {
        core::array::from_fn(|i| self.joints[i].as_ref().map_or([0.0; TERMS], |joint| joint.acting))
    }

    /// Returns for each joint the matrix `P + d dᵀ` of the expected products of errors of the acting coefficients δ
    /// ([`terms`]). P is the covariance of the learned coefficients, and d is the difference between the acting and the learned
    /// coefficients. The matrix is zero for joints whose friction is not learned.
    #[must_use]
    pub fn acting_errors(&self) -> [[[f64; TERMS]; TERMS]; N] {
        let errors = |joint: &Joint| {
            let covariance = &joint.law.covariance;
            let lacking: [f64; TERMS] = core::array::from_fn(|k| joint.acting[k] - joint.learned[k]);
            core::array::from_fn(|k| core::array::from_fn(|l| covariance[k][l] + lacking[k] * lacking[l]))
        };
        core::array::from_fn(|i| self.joints[i].as_ref().map_or([[0.0; TERMS]; TERMS], errors))
    }

    /// Returns the friction of a joint [N m or N] at the velocity `v` [rad/s or m/s] by the learned law, and the half width
    /// [N m or N] of its 90 % confidence interval. The friction includes the offset, but not load-dependent friction. `None` for
    /// joints whose friction is not learned.
    ///
    /// - `described`: described friction at this velocity [N m or N]
    #[must_use]
    pub fn friction(&self, joint: usize, described: f64, v: f64) -> Option<[f64; 2]> {
        let (state, phi) = (self.joints[joint].as_ref()?, self.terms(joint, described, v)?);
        Some([described + dot(&phi, &state.learned), state.half_width(&phi)])
    }

    /// Returns the friction of a joint [N m or N] at the velocity `v` [rad/s or m/s] by the acting law, which controllers use
    /// ([crate documentation](crate)). The arguments are those of [`Self::friction`].
    #[must_use]
    pub fn acting_friction(&self, joint: usize, described: f64, v: f64) -> Option<f64> {
        let (state, phi) = (self.joints[joint].as_ref()?, self.terms(joint, described, v)?);
        Some(described + dot(&phi, &state.acting))
    }

    /// Values of the learned law's [`terms`] at velocity `v` without load.
    fn terms(&self, joint: usize, described: f64, v: f64) -> Option<[f64; TERMS]> {
        let scale = self.scales[joint].as_ref()?;
        Some(terms(scale.shape(described, v, self.rest(joint)), v, 0.0))
    }

    /// Narrows the bounds of the coefficients δ ([`terms`]) of a joint, for example to half of the 95 % interval of an offline
    /// identification. The standard deviation of the prior of a coefficient is half of its bound. A term with the bound 0 is
    /// not learned. The learned law of the joint is reset. A state that was saved with other bounds cannot be restored.
    ///
    /// - `most`: largest magnitude of each coefficient; the bounds by [`AdaptationSettings::largest_change`] also apply
    ///
    /// # Errors
    /// [`AdaptationError::Bounds`] for a joint that is not learned, and for bounds that are negative or NaN.
    pub fn set_bounds(&mut self, joint: usize, most: [f64; TERMS]) -> Result<(), AdaptationError> {
        let scale =
            self.scales.get(joint).copied().flatten().filter(|_| most.iter().all(|most| *most >= 0.0));
        let scale = JointScale { most, ..scale.ok_or(AdaptationError::Bounds(joint))? };
        let derived = Derived::new(&self.settings, &scale);
        self.scales[joint] = Some(scale);
        self.derived[joint] = Some(derived);
        self.joints[joint] = Some(Joint::new(joint, &derived, &scale));
        Ok(())
    }

    /// Returns the speed [rad/s or m/s] below which a joint counts as at rest; 0 for joints whose friction is not learned.
    #[must_use]
    pub fn rest(&self, joint: usize) -> f64 {
        self.derived[joint].map_or(0.0, |derived| derived.rest)
    }
}

/// Largest speed, effort and range of a joint, from limits or data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitudes {
    /// Largest speed of the joint [rad/s or m/s].
    pub speed: f64,
    /// Largest effort of the joint's drive [N m or N]; infinite if unknown.
    pub effort: f64,
    /// Width of the range of positions [rad or m]; infinite if unlimited.
    pub range: f64,
}

/// Assumed friction at the largest speed for joints without described friction, relative to the largest effort.
const USUAL: f64 = 0.1;

impl Magnitudes {
    /// Returns the scale of the friction of a joint; `None` if the speed is unknown, or if both friction and effort are
    /// unknown.
    ///
    /// If the friction at the largest speed exceeds the largest effort, the drive cannot reach this speed. The scale then
    /// contains the largest of 64 equidistant speeds at which friction does not exceed the effort.
    ///
    /// - `joint`: index of the joint
    /// - `friction`: function that returns the described friction of this joint for the velocities of all joints
    #[must_use]
    pub fn scale<const N: usize>(
        &self,
        joint: usize,
        friction: impl Fn(&[f64; N]) -> f64,
    ) -> Option<JointScale> {
        const STEPS: i32 = 64;
        let at = |v: f64| {
            let mut velocities = [0.0; N];
            velocities[joint] = v;
            friction(&velocities).abs()
        };
        let is_reached = |v: &f64| at(*v).max(at(-v)) <= self.effort;
        let mut speeds = (1..=STEPS).rev().map(|k| self.speed * f64::from(k) / f64::from(STEPS));
        let speed = speeds.find(is_reached).unwrap_or(self.speed);
        let described = at(speed).max(at(-speed));
        let torque = if described > 0.0 { described } else { USUAL * self.effort };
        let possible = [speed, torque].iter().all(|x| x.is_finite() && *x > 0.0);
        let slope = |k: i32| {
            let v = 2.0 * speed * f64::from(k) / f64::from(STEPS);
            at(v).min(at(-v)) / v
        };
        let least = (1..=STEPS).map(slope).fold(f64::INFINITY, f64::min);
        possible.then_some(JointScale {
            torque,
            speed,
            least_slope: if described > 0.0 { least } else { 0.0 },
            range: if self.range.is_finite() && self.range > 0.0 {
                self.range
            } else {
                core::f64::consts::TAU
            },
            is_described: described > 0.0,
            most: [f64::INFINITY; TERMS],
            is_loaded: false,
        })
    }
}

/// Hash of the bits of numbers.
pub(super) fn hash(numbers: impl Iterator<Item = f64>) -> u64 {
    fnv1a(numbers.flat_map(|x| x.to_bits().to_le_bytes()))
}
