//! Interface between control loop and controller.

use crate::dynamics::{AttitudeError, Named};
use gelenk_adaptation::JointState;
use thiserror::Error;

/// Time, measurement and last inputs at the start of a period, as input of a controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle<const N: usize, const M: usize, const NY: usize = N> {
    /// Time on the trajectory at the start of the present period (s). The trajectory begins at 0.
    pub time: f64,
    /// Number of periods since the previous call of the controller. The number exceeds 1 if the loop was
    /// stalled. The input was constant during these periods.
    pub periods: u32,
    /// Positions measured at `time` [rad or m], finite and plausible; `None` without a plausible measurement.
    pub positions: Option<[f64; NY]>,
    /// Velocities measured together with `positions` [rad/s or m/s], finite and consistent with the
    /// positions; `None` if velocities are not measured or `positions` is `None`.
    pub velocities: Option<[f64; N]>,
    /// Drive forces at the joints measured together with `positions` [N m or N], finite; `None` if forces are
    /// not measured or `positions` is `None`.
    pub torques: Option<[f64; N]>,
    /// Inputs that the loop wrote last, after limiting [N m, N or A]. If inputs act without delay, these inputs
    /// acted until now. If inputs act one period late, these inputs act from now on, and the inputs that are
    /// computed now act from `time` plus one period on.
    pub last_inputs: [f64; M],
}

impl<const N: usize, const M: usize, const NY: usize> Default for Cycle<N, M, NY> {
    /// Time 0, one period since the previous call, no measurement, zero inputs.
    fn default() -> Self {
        Self {
            time: 0.0,
            periods: 1,
            positions: None,
            velocities: None,
            torques: None,
            last_inputs: [0.0; M],
        }
    }
}

/// Inputs that a controller proposes. The loop checks the inputs before it writes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command<const M: usize> {
    /// Inputs u [N m, N or A].
    pub inputs: [f64; M],
    /// Iterations of an optimizer, for the log; 0 for a controller without optimizer.
    pub iterations: u32,
}

/// Reason why a controller proposes no input in a period. The loop then uses the shifted plan or the fallback
/// law.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ControllerFault {
    /// The measurement is missing, and this controller cannot predict the state without it.
    #[error("the measurement is missing, and this controller cannot compute an input without it")]
    NoMeasurement,
    /// The optimizer ended without a usable input.
    #[error("the solver found no usable input after {iterations} iterations")]
    NoSolution {
        /// Number of iterations.
        iterations: u32,
    },
    /// The state or the model's equations are not finite.
    #[error("the state or the equations of motion are not finite")]
    NotFinite,
    /// A joint of the model is too fast for the prediction over one period.
    #[error("{0}")]
    TooFast(TooFast),
    /// A measured quaternion is not an attitude.
    #[error("the measurement is invalid: {0}")]
    Attitude(AttitudeError),
    /// Too many periods passed since the last step, so the controller cannot predict the state.
    #[error("the state cannot be predicted, because {periods} periods passed since the last step")]
    Stalled {
        /// Number of periods since the last step.
        periods: u32,
    },
}

/// A joint whose dynamics are too fast for the zero-order hold, e.g. because of steep friction. The bound ν (1/s)
/// on its fastest rate times the period exceeds 2e7, see [`Discretizable::discretize`](crate::dynamics::Discretizable::discretize).
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "the motion of joint {} cannot be predicted over a period of {period} s. The slope of its force over its speed, {slope:.3e} N \
     m s/rad (or N s/m), causes a rate of {rate:.1e} 1/s. Use a model with less steep friction",
    Named(.name)
)]
pub struct TooFast {
    /// Index of the coordinate.
    pub joint: usize,
    /// Name of the coordinate.
    pub name: &'static str,
    /// Slope of the force of the coordinate over its speed [N m s/rad or N s/m]. Friction is usually the main
    /// part.
    pub slope: f64,
    /// Rate ν of the coordinate [1/s].
    pub rate: f64,
    /// Period of the prediction (s).
    pub period: f64,
}

/// State estimated by a controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate<const N: usize, const NY: usize = N> {
    /// Estimated positions y [rad or m].
    pub positions: [f64; NY],
    /// Estimated velocities ẏ [rad/s or m/s].
    pub velocities: [f64; N],
}

/// Learned friction of a joint, for log and report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnedJoint {
    /// Learned friction [N m or N] at the given velocity, and the half width [N m or N] of its 90 % confidence interval.
    pub friction: [f64; 2],
    /// Learned terms with their confidence intervals, and the acting law.
    pub state: JointState,
}

/// A controller of a robot with `N` coordinates and `M` inputs. The controller contains the model and the
/// trajectory. The loop handles clock, transport, limits and faults.
///
/// A real-time thread calls the methods. Therefore the methods must not allocate, block or exceed their time
/// budget.
pub trait Controller<const N: usize, const M: usize, const NY: usize = N> {
    /// Resets the controller to rest at `positions` [rad or m] and time 0 of the trajectory. The controller must
    /// forget earlier runs. The loop writes `inputs` [N m, N or A] until the first step.
    fn reset(&mut self, positions: &[f64; NY], inputs: &[f64; M]);

    /// Processes the events since the last call and proposes the inputs of this period. The loop calls this
    /// method in every period, also if the measurement is missing or an earlier proposal was not used.
    ///
    /// # Errors
    /// [`ControllerFault`] if no input can be proposed. The controller must be able to continue in the next
    /// period.
    fn step(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault>;

    /// Inputs that the last successful step planned for `periods` ≥ 1 periods after that step; `None` beyond the
    /// end of the plan, and for controllers without a plan.
    fn planned(&self, periods: u32) -> Option<[f64; M]> {
        let _ = periods;
        None
    }

    /// State estimate after the last step, for the log; `None` for a controller without an estimator.
    fn estimate(&self) -> Option<Estimate<N, NY>> {
        None
    }

    /// Learned friction at positions `y` [rad or m] and velocities `v` [rad/s or m/s], for log and report; `None`
    /// for joints whose friction is not learned.
    fn learned(&self, y: &[f64; NY], v: &[f64; N]) -> [Option<LearnedJoint>; N] {
        let _ = (y, v);
        [None; N]
    }

    /// Warms up the processor caches. The method computes the next step at the expected state `next` and discards
    /// the result. The loop calls this method at most once while it waits for the next period, and only if the
    /// remaining time is long enough (see [`LoopSettings::warm_up`](super::LoopSettings::warm_up)).
    ///
    /// The call must not change the results of later calls in any bit. It may only change scratch memory. To
    /// test this rule, compare a controller with and without warm-ups. The default does nothing.
    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        let _ = next;
    }
}

impl<const N: usize, const M: usize, const NY: usize, C: Controller<N, M, NY> + ?Sized> Controller<N, M, NY>
    for &mut C
{
    fn reset(&mut self, positions: &[f64; NY], inputs: &[f64; M]) {
        (**self).reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault> {
        (**self).step(cycle)
    }

    fn planned(&self, periods: u32) -> Option<[f64; M]> {
        (**self).planned(periods)
    }

    fn estimate(&self) -> Option<Estimate<N, NY>> {
        (**self).estimate()
    }

    fn learned(&self, y: &[f64; NY], v: &[f64; N]) -> [Option<LearnedJoint>; N] {
        (**self).learned(y, v)
    }

    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        (**self).warm_up(next);
    }
}
