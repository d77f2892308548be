//! Interface between loop and controller.

use crate::dynamics::{AttitudeError, Named};
use thiserror::Error;

/// The state of the loop at the start of a period, as a controller learns it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle<const N: usize, const M: usize, const NY: usize = N> {
    /// Time on the trajectory at the start of this period (s); 0 at its start.
    pub time: f64,
    /// Periods since the previous call; 1 unless the loop was stalled. The input stayed the same over all of
    /// them.
    pub periods: u32,
    /// Positions measured at `time` [rad or m], finite and plausible; `None` if nothing arrived, or
    /// nothing believable.
    pub positions: Option<[f64; NY]>,
    /// Velocities measured with these positions, finite and consistent with them [rad/s or m/s]; `None` where
    /// the robot does not measure them, and if there are no positions.
    pub velocities: Option<[f64; N]>,
    /// Forces of the drives at the joints measured with these positions, finite [N m or N]; `None` as above.
    pub torques: Option<[f64; N]>,
    /// Input that the loop wrote last, after its limits. Without delay it acted until now; with one period of
    /// delay it acts from now on, and the input computed now acts from `time + period` on.
    pub last_inputs: [f64; M],
}

impl<const N: usize, const M: usize, const NY: usize> Default for Cycle<N, M, NY> {
    /// Time 0, one period after the last, nothing measured, no inputs before: the rest of a literal that
    /// names what it has.
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

/// The proposal of a controller. The loop checks it before anything is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command<const M: usize> {
    /// Inputs u [N m, N or A: the model's units].
    pub inputs: [f64; M],
    /// Iterations of an optimizer, for the log; 0 if there is none.
    pub iterations: u32,
}

/// Why a controller proposes nothing in this period. The loop then goes down its fallback chain.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ControllerFault {
    /// The measurement is missing, and this controller cannot predict the state without it.
    #[error("no measurement to control by")]
    NoMeasurement,
    /// The optimizer ended without a usable input.
    #[error("no usable input after {iterations} iterations")]
    NoSolution {
        /// Iterations that it took.
        iterations: u32,
    },
    /// The state or the model's equations gave numbers that are not finite.
    #[error("state or equations of motion are not finite")]
    NotFinite,
    /// A joint of the model is too fast to be predicted over a period.
    #[error("{0}")]
    TooFast(TooFast),
    /// A measured quaternion is not an attitude.
    #[error("a measurement cannot be: {0}")]
    Attitude(AttitudeError),
    /// Too many periods went by since the last step for a prediction.
    #[error("{periods} periods went by since the last step, too many to predict over")]
    Stalled {
        /// How many.
        periods: u32,
    },
}

/// A joint that is too fast for the zero-order hold over a period: its rate times the period exceeds 2e7, see
/// [`Discretizable::discretize`](crate::dynamics::Discretizable::discretize).
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "joint {} is too fast to be predicted over a period of {period} s: its force has a slope of {slope:.3e} N m s/rad (or N s/m) \
     over its speed, which gives a rate of {rate:.1e} 1/s; take a model whose friction is less steep",
    Named(.name)
)]
pub struct TooFast {
    /// Which coordinate.
    pub joint: usize,
    /// Its name.
    pub name: &'static str,
    /// Slope of its force over its own speed [N m s/rad or N s/m], friction above all.
    pub slope: f64,
    /// Its rate ν [1/s].
    pub rate: f64,
    /// The period (s).
    pub period: f64,
}

/// A state as a controller estimates it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate<const N: usize, const NY: usize = N> {
    /// y [rad or m].
    pub positions: [f64; NY],
    /// ẏ [rad/s or m/s].
    pub velocities: [f64; N],
}

/// A controller of a robot with `N` coordinates and `M` inputs. It knows its model and its trajectory; the
/// loop knows clock, transport, limits and faults.
///
/// No method may allocate, block, or run for longer than its budget: a real-time thread calls them.
pub trait Controller<const N: usize, const M: usize, const NY: usize = N> {
    /// Begins at rest at `positions`, at time 0 of the trajectory, with nothing carried over. `inputs` is
    /// what the loop writes until the first step.
    fn reset(&mut self, positions: &[f64; NY], inputs: &[f64; M]);

    /// Takes in what happened since the last call and proposes the input of this period. Called once for
    /// every period that the loop sees, also if the measurement is missing or an earlier proposal was not
    /// used.
    ///
    /// # Errors
    /// [`ControllerFault`] if there is no input to propose. The controller must remain able to go on with
    /// the next period.
    fn step(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault>;

    /// Input that the plan of the last successful step holds for `periods` ≥ 1 periods after that step;
    /// `None` beyond its end, and for controllers without a plan.
    fn planned(&self, periods: u32) -> Option<[f64; M]> {
        let _ = periods;
        None
    }

    /// Estimate of the state after the last step, for the log; `None` for controllers without one.
    fn estimate(&self) -> Option<Estimate<N, NY>> {
        None
    }

    /// Brings the code and the data of the next step into the caches: computes what the step will compute,
    /// about the state that `next` expects, and throws the result away. The loop calls it while it waits for
    /// the next period, once at most, and not at all if there is no time for it (see
    /// [`LoopSettings::warm_up`](super::LoopSettings::warm_up)).
    ///
    /// What any later call returns must be the same to the last bit, whether this was called or not: change
    /// scratch memory alone. A test that drives the controller with and without these calls and compares is
    /// short. The default does nothing.
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

    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        (**self).warm_up(next);
    }
}
