//! Motion with limited jerk to a target that may change at run time.

use super::sums;
use super::{MotionLimits, Sample, Trajectory, TrajectoryError};
use rsruckig::prelude::{DataArrayOrVec, InputParameter, Ruckig, RuckigErrorHandler, RuckigResult};
use rsruckig::trajectory::Trajectory as Profile;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A motion to rest at a target that may change at any time, also during the motion. All joints arrive at the
/// same time, as early as the limits of positions, speeds, accelerations and jerks allow. A new target starts
/// a new motion from the current state, so positions, velocities and accelerations are continuous.
///
/// The crate `rsruckig` computes the motion (Berscheid, Kröger, *Jerk-limited Real-time Trajectory Generation
/// with Arbitrary Target States*, RSS 2021). This takes about 10 µs for seven joints, is done in the thread
/// of the loop, and allocates nothing.
///
/// Clones share target and motion. Use one clone in the loop, one in its controller, and one to
/// [`set`](Self::set) targets from any thread. The loop applies a new target at the start of a period
/// ([`Trajectory::begin_period`]; without a loop, call this method yourself). The duration is infinite: the
/// loop runs until a stop is requested. A predictive controller predicts with the motion to the current
/// target. Its terminal weights are those of the initial motion.
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
    /// State of the loop and its controller, which are in one thread.
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
        /// Target [rad or m].
        target: [f64; N],
        /// Time of arrival on the trajectory (s).
        arrival: f64,
    },
    /// The loop has not applied this target yet.
    Waiting {
        /// Target [rad or m].
        target: [f64; N],
    },
    /// There is no motion from the current state to this target that keeps the limits. The motion to the
    /// previous target continues.
    Refused {
        /// Target [rad or m].
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

/// Errors without text, because the loop must not allocate a text.
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
/// Largest position and largest limit. The inverse is the least limit. Over eight decades the generator kept
/// its limits in tests, over twelve decades it did not.
const LARGEST: f64 = 1e4;
/// Number of periods in which a target is tried before it is refused. For eight of four million random
/// targets no motion was found. One period later the state is another one, so the next trial may succeed.
const ATTEMPTS: u32 = 5;

impl<const N: usize> OnlineTarget<N> {
    /// A motion at rest at `start` [rad or m] until a target is set.
    ///
    /// # Errors
    /// [`TrajectoryError::OutOfRange`] for limits of speed, acceleration or jerk outside 1e-4 to 1e4, for
    /// which the equations of the generator are well scaled, or for a start beyond 1e4.
    /// [`TrajectoryError::DependentNotKept`] for a joint in [`MotionLimits::dependent`] that follows several
    /// coordinates, because this motion does not keep its limits. [`TrajectoryError::NotFinite`] or
    /// [`TrajectoryError::PointOutside`] for a start that is not finite or outside the position limits.
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
                // Durations are not rounded to periods, so that the period has no influence.
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

    /// Sets a target [rad or m], from any thread. It replaces a target that was not applied yet.
    ///
    /// # Errors
    /// [`TrajectoryError::NotFinite`], [`TrajectoryError::PointOutside`] or [`TrajectoryError::OutOfRange`]
    /// for a target that is not finite, outside the position limits, or beyond 1e4. The motion then continues
    /// unchanged.
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
    /// State at `time` (s) of the trajectory. After the motion it is at rest at the target. The motion before
    /// the last change of target is not stored.
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

    /// Starts a motion to `target` from the state at `time` (s). Returns false, and changes nothing, if there
    /// is no motion within the limits.
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
        // Another thread is writing a target at this moment: it can wait for the next period, the loop cannot
        // wait for it.
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
            range: "at most 1e4; limits of motions also at least 1e-4",
        }),
    }
}

/// Locks a mutex, also after a thread panicked. The data are then still consistent, because no change is made
/// in parts.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn stack<const N: usize>(values: [f64; N]) -> DataArrayOrVec<f64, N> {
    DataArrayOrVec::Stack(values)
}

fn array<const N: usize>(values: &DataArrayOrVec<f64, N>) -> [f64; N] {
    core::array::from_fn(|i| values[i])
}
