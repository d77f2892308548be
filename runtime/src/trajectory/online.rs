//! Motion with limited jerk to a target that can change at run time.

use super::sums;
use super::{MotionLimits, Sample, Trajectory, TrajectoryError};
use rsruckig::prelude::{DataArrayOrVec, InputParameter, Ruckig, RuckigErrorHandler, RuckigResult};
use rsruckig::trajectory::Trajectory as Profile;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A motion to rest at a target that can change at any time, also during the motion. All joints arrive at the same time.
/// They arrive as early as the limits of positions, speeds, accelerations and jerks allow. A new target starts a new motion
/// from the current state, so positions, velocities and accelerations are continuous.
///
/// The crate `rsruckig` computes the motion (Berscheid, Kröger, *Jerk-limited Real-time Trajectory Generation
/// with Arbitrary Target States*, RSS 2021). The thread of the loop needs about 10 µs for this computation with seven
/// joints, and does not allocate.
///
/// Clones share target and motion. Use one clone in the loop, one clone in the controller, and one clone to
/// [`set`](Self::set) targets from any thread. The loop applies a new target at the start of a period
/// ([`Trajectory::begin_period`]). Without a loop, call this method yourself. The duration of the motion is infinite, so the
/// loop runs until a stop is requested. A predictive controller predicts with the motion to the current target. Its
/// terminal weights are those of the initial motion.
///
/// ```
/// use gelenk_runtime::trajectory::{MotionLimits, OnlineTarget, Trajectory};
///
/// let limits = MotionLimits {
///     speeds: [1.0; 2],
///     accelerations: [3.0; 2],
///     jerks: [30.0; 2],
///     ..MotionLimits::default()
/// };
/// let motion = OnlineTarget::new([0.0, 0.0], &limits)?;
/// motion.set([0.5, -0.2])?;
/// motion.begin_period(0.0);
/// assert!(motion.sample(0.3).velocities[0] > 0.1);
/// motion.set([0.1, 0.0])?;
/// motion.begin_period(0.3);
/// assert_eq!(motion.sample(10.0).positions, [0.1, 0.0]);
/// # Ok::<(), gelenk_runtime::trajectory::TrajectoryError>(())
/// ```
#[derive(Clone)]
pub struct OnlineTarget<const N: usize> {
    limits: MotionLimits<N>,
    /// Target from other threads. The loop never waits for this lock.
    requests: Arc<Mutex<Requests<N>>>,
    /// Motion of the loop and its controller, which run in one thread.
    plan: Arc<Mutex<Plan<N>>>,
}

impl<const N: usize> fmt::Debug for OnlineTarget<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OnlineTarget").field("limits", &self.limits).finish_non_exhaustive()
    }
}

struct Requests<const N: usize> {
    /// Target that the loop has not applied yet; `None` if there is no new target.
    pending: Option<[f64; N]>,
    status: TargetStatus<N>,
}

/// Status of the last target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TargetStatus<const N: usize> {
    /// The motion leads to this target.
    Followed {
        /// Target position of each joint [rad or m].
        target: [f64; N],
        /// Time of arrival on the trajectory (s).
        arrival: f64,
    },
    /// The loop has not applied this target yet.
    Waiting {
        /// Target position of each joint [rad or m].
        target: [f64; N],
    },
    /// No motion from the current state to this target keeps the limits. The motion to the previous target continues.
    Refused {
        /// Target position of each joint [rad or m].
        target: [f64; N],
    },
}

struct Plan<const N: usize> {
    generator: Ruckig<N, Quiet>,
    input: InputParameter<N>,
    profile: Profile<N>,
    /// Memory for the next profile, which is computed while `profile` is still needed.
    next: Profile<N>,
    /// Time on the trajectory at which `profile` begins (s).
    begin: f64,
    target: [f64; N],
    /// Number of periods in which no motion to the new target was found.
    attempts: u32,
}

/// Error handler that does not create texts, because the loop must not allocate.
struct Quiet;

impl RuckigErrorHandler for Quiet {
    fn handle_validation_error(_: &str) -> Result<(), rsruckig::error::RuckigError> {
        Err(rsruckig::error::RuckigError::ValidationError(String::new()))
    }

    fn handle_calculator_error(_: &str) -> Result<(), rsruckig::error::RuckigError> {
        Err(rsruckig::error::RuckigError::CalculatorError(String::new()))
    }
}

/// Tolerance of the position limits for a computed motion [rad or m]. A computed motion ends within 1e-8 of
/// its target.
const SLACK: f64 = 1e-7;
/// Largest allowed position and limit. The inverse is the smallest allowed limit. In tests with limits over eight orders of
/// magnitude, the generator kept its limits. Over twelve orders of magnitude, it did not.
const LARGEST: f64 = 1e4;
/// Number of periods in which a target is tried before it is refused. For eight of four million random targets no motion
/// was found. One period later the state is different, so the next trial can succeed.
const ATTEMPTS: u32 = 5;

impl<const N: usize> OnlineTarget<N> {
    /// A motion at rest at `start` [rad or m] until a target is set.
    ///
    /// # Errors
    /// - [`TrajectoryError::OutOfRange`] for limits of speed, acceleration or jerk outside 1e-4 to 1e4, or for a start
    ///   beyond 1e4. The equations of the generator are only well scaled in this range.
    /// - [`TrajectoryError::DependentNotKept`] for a joint in [`MotionLimits::dependent`] that follows several
    ///   coordinates, because this motion does not keep the limits of this joint.
    /// - [`TrajectoryError::NotFinite`] or [`TrajectoryError::PointOutside`] for a start that is not finite or outside the
    ///   position limits.
    /// - [`TrajectoryError::NotPositive`] for a limit that is not positive.
    pub fn new(start: [f64; N], limits: &MotionLimits<N>) -> Result<Self, TrajectoryError> {
        limits.check()?;
        if let Some(joint) = sums::of(limits).next() {
            return Err(TrajectoryError::DependentNotKept { joint: joint.name });
        }
        require_scaled("speed limit", &limits.speeds, 1.0 / LARGEST)?;
        require_scaled("acceleration limit", &limits.accelerations, 1.0 / LARGEST)?;
        require_scaled("jerk limit", &limits.jerks, 1.0 / LARGEST)?;
        check_target(limits, &start)?;
        let mut input = InputParameter::new(None);
        input.max_velocity = stack(limits.speeds);
        input.max_acceleration = stack(limits.accelerations);
        input.max_jerk = stack(limits.jerks);
        input.min_position = Some(stack(limits.positions.map(|[low, _]| low - SLACK)));
        input.max_position = Some(stack(limits.positions.map(|[_, high]| high + SLACK)));
        let status = TargetStatus::Followed { target: start, arrival: 0.0 };
        Ok(Self {
            limits: *limits,
            requests: Arc::new(Mutex::new(Requests { pending: None, status })),
            plan: Arc::new(Mutex::new(Plan {
                // Durations are not rounded to periods, so the given period has no influence.
                generator: Ruckig::new(None, 1e-3),
                input,
                profile: Profile::new(None),
                next: Profile::new(None),
                begin: 0.0,
                target: start,
                attempts: 0,
            })),
        })
    }

    /// Sets a target [rad or m]. Any thread can call this method. A target that was not applied yet is replaced.
    ///
    /// # Errors
    /// - [`TrajectoryError::NotFinite`] for a target that is not finite.
    /// - [`TrajectoryError::PointOutside`] for a target outside the position limits.
    /// - [`TrajectoryError::OutOfRange`] for a target beyond 1e4.
    ///
    /// After an error the motion continues unchanged.
    pub fn set(&self, target: [f64; N]) -> Result<(), TrajectoryError> {
        check_target(&self.limits, &target)?;
        let mut requests = lock(&self.requests);
        requests.pending = Some(target);
        requests.status = TargetStatus::Waiting { target };
        Ok(())
    }

    /// Status of the last target.
    #[must_use]
    pub fn status(&self) -> TargetStatus<N> {
        lock(&self.requests).status
    }
}

impl<const N: usize> Plan<N> {
    /// State at `time` (s) of the trajectory. After the motion the state is at rest at the target. The motion before the last
    /// change of target is not stored.
    fn sample(&self, time: f64) -> Sample<N> {
        let t = time - self.begin;
        if t >= self.profile.get_duration() {
            return Sample::at_rest(self.target);
        }
        let (mut y, mut v, mut a) = (stack([0.0; N]), stack([0.0; N]), stack([0.0; N]));
        // NaN counts as the beginning.
        self.profile.at_time(
            t.max(0.0),
            &mut Some(&mut y),
            &mut Some(&mut v),
            &mut Some(&mut a),
            &mut None,
            &mut None,
        );
        Sample { positions: array(&y), velocities: array(&v), accelerations: array(&a) }
    }

    /// Starts a motion to `target` from the state at `time` (s). Returns false and changes nothing if no motion within the
    /// limits is found.
    fn turn_to(&mut self, target: [f64; N], time: f64) -> bool {
        let now = self.sample(time);
        self.input.current_position = stack(now.positions);
        self.input.current_velocity = stack(now.velocities);
        self.input.current_acceleration = stack(now.accelerations);
        self.input.target_position = stack(target);
        let result = self.generator.calculate(&self.input, &mut self.next);
        let found = matches!(result, Ok(RuckigResult::Working | RuckigResult::Finished));
        if !(found && self.next.get_duration().is_finite()) {
            return false;
        }
        core::mem::swap(&mut self.profile, &mut self.next);
        (self.begin, self.target) = (time, target);
        true
    }
}

impl<const N: usize> Trajectory<N> for OnlineTarget<N> {
    /// Infinite, because another target may follow at any time.
    fn duration(&self) -> f64 {
        f64::INFINITY
    }

    fn sample(&self, t: f64) -> Sample<N> {
        lock(&self.plan).sample(t)
    }

    fn begin_period(&self, time: f64) {
        // If another thread is writing a target at this moment, the loop does not wait. It applies the target in the next
        // period.
        let Ok(mut requests) = self.requests.try_lock() else {
            return;
        };
        let Some(target) = requests.pending.filter(|_| time.is_finite()) else {
            return;
        };
        let mut plan = lock(&self.plan);
        if plan.turn_to(target, time) {
            let arrival = time + plan.profile.get_duration();
            requests.status = TargetStatus::Followed { target, arrival };
        } else {
            plan.attempts += 1;
            if plan.attempts < ATTEMPTS {
                return;
            }
            requests.status = TargetStatus::Refused { target };
        }
        plan.attempts = 0;
        requests.pending = None;
    }
}

fn check_target<const N: usize>(limits: &MotionLimits<N>, target: &[f64; N]) -> Result<(), TrajectoryError> {
    limits.check_position(0, target)?;
    require_scaled("position", target, 0.0)
}

fn require_scaled(what: &'static str, values: &[f64], least: f64) -> Result<(), TrajectoryError> {
    match values.iter().find(|x| !(least..=LARGEST).contains(&x.abs())) {
        None => Ok(()),
        Some(value) => Err(TrajectoryError::OutOfRange {
            what,
            value: *value,
            range: "at most 1e4 in magnitude, and limits of speed, acceleration and jerk must be at least 1e-4",
        }),
    }
}

/// Locks a mutex, also after a thread panicked. The data are still consistent then, because each change is made at once.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn stack<const N: usize>(values: [f64; N]) -> DataArrayOrVec<f64, N> {
    DataArrayOrVec::Stack(values)
}

fn array<const N: usize>(values: &DataArrayOrVec<f64, N>) -> [f64; N] {
    core::array::from_fn(|i| values[i])
}
