//! Integration with error control until the end of a period or the first event.
//!
//! The method is DOP853, order 8(5,3) with dense output of order 7 (Hairer, Nørsett, Wanner, *Solving
//! Ordinary Differential Equations I*, 1993, sections II.5 and II.6), from the crate
//! `differential-equations`. Only the functions for a single step are used, because the loop of the crate collects
//! solutions in vectors.

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;
use differential_equations::traits::State;

/// Largest number of steps until an event or the end of a period. A smooth robot needs about ten.
const MAX_STEPS: usize = 20_000;
/// Largest number of steps in one period with all events.
pub(super) const MAX_PERIOD_STEPS: usize = 100_000;
const TOO_SMALL: &str =
    "the steps became too small, because accelerations are not finite or the model is stiff or discontinuous";
/// Number of bisections that locate an event. After 60 bisections the time is exact to the last bit.
const BISECTIONS: usize = 60;

/// Positions and velocities, or their derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion<const N: usize, const NY: usize = N> {
    pub positions: [f64; NY],
    pub velocities: [f64; N],
}

impl<const N: usize, const NY: usize> Motion<N, NY> {
    pub fn is_finite(&self) -> bool {
        let all = self.positions.iter().chain(&self.velocities);
        all.into_iter().all(|x| x.is_finite())
    }
}

impl<const N: usize, const NY: usize> State<f64> for Motion<N, NY> {
    fn len(&self) -> usize {
        NY + N
    }

    fn get_component(&self, index: usize) -> f64 {
        if index < NY { self.positions[index] } else { self.velocities[index - NY] }
    }

    fn set_component(&mut self, index: usize, value: f64) {
        if index < NY {
            self.positions[index] = value;
        } else {
            self.velocities[index - NY] = value;
        }
    }

    fn map_components_mut<F: FnMut(usize, &mut f64)>(&mut self, mut f: F) {
        let all = self.positions.iter_mut().chain(&mut self.velocities);
        for (i, x) in all.enumerate() {
            f(i, x);
        }
    }

    fn zeros_like(&self) -> Self {
        Self::zeros()
    }

    fn zeros() -> Self {
        Self { positions: [0.0; NY], velocities: [0.0; N] }
    }

    fn mul_add_assign(&mut self, alpha: f64, other: &Self) {
        self.map_components_mut(|i, x| *x += alpha * other.get_component(i));
    }

    fn scale_mut(&mut self, alpha: f64) {
        self.map_components_mut(|_, x| *x *= alpha);
    }
}

/// Differential equations of a motion that is smooth until an event. All times are times of the integration (s).
pub(super) trait Flow<const N: usize, const NY: usize> {
    /// Rates ẏ of the positions.
    fn rates(&self, motion: &Motion<N, NY>) -> [f64; NY];

    /// Accelerations v̇ at `time` (s).
    fn accelerations(&self, time: f64, motion: &Motion<N, NY>) -> [f64; N];

    /// Whether an event has happened until `time` (s).
    fn has_ended(&self, time: f64, motion: &Motion<N, NY>) -> bool;
}

struct Equations<'f, F>(&'f F);

impl<const N: usize, const NY: usize, F: Flow<N, NY>> ODE<f64, Motion<N, NY>> for Equations<'_, F> {
    fn diff(&self, time: f64, motion: &Motion<N, NY>, derivative: &mut Motion<N, NY>) {
        derivative.positions = self.0.rates(motion);
        derivative.velocities = self.0.accelerations(time, motion);
    }
}

/// State at the end of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arrival<const N: usize, const NY: usize> {
    pub time: f64,
    pub motion: Motion<N, NY>,
    pub by_event: bool,
}

/// Length of the first step if the integration has no earlier step (s).
const FIRST_STEP: f64 = 1e-3;

type Method<const N: usize, const NY: usize> =
    ExplicitRungeKutta<Ordinary, DormandPrince, f64, Motion<N, NY>, 8, 12, 16>;

#[derive(Clone)]
pub(super) struct Integrator<const N: usize, const NY: usize> {
    method: Method<N, NY>,
    /// Step length that the error control proposed last (s). It is the first step length of the next call.
    step: f64,
}

impl<const N: usize, const NY: usize> Integrator<N, NY> {
    pub fn new(relative_tolerance: f64, absolute_tolerance: f64) -> Self {
        let method = Method::dop853()
            .rtol(relative_tolerance)
            .atol(absolute_tolerance)
            // The method counts all steps since its construction. `advance` bounds the steps of a call.
            .max_steps(usize::MAX);
        Self { method, step: FIRST_STEP }
    }

    /// Integrates from `start` to `end` (s), or to the first event of `flow`, in at most `budget` steps.
    /// Reduces the budget by the number of steps.
    ///
    /// # Errors
    /// Text with the reason why the integration failed.
    pub fn advance(
        &mut self,
        flow: &impl Flow<N, NY>,
        motion: &Motion<N, NY>,
        start: f64,
        end: f64,
        budget: &mut usize,
    ) -> Result<Arrival<N, NY>, &'static str> {
        let arrival = self.try_advance(flow, motion, start, end, budget);
        if arrival.is_err() {
            // After a failure the last step is very small. The next call must not begin with this step.
            self.step = FIRST_STEP;
        }
        arrival
    }

    fn try_advance(
        &mut self,
        flow: &impl Flow<N, NY>,
        motion: &Motion<N, NY>,
        start: f64,
        end: f64,
        budget: &mut usize,
    ) -> Result<Arrival<N, NY>, &'static str> {
        let equations = Equations(flow);
        let negligible = 4.0 * f64::EPSILON * end.abs();
        if end - start <= negligible {
            return Ok(Arrival { time: end, motion: *motion, by_event: false });
        }
        self.method.h0 = self.step.min(end - start);
        self.method.init(&equations, start, end, motion).map_err(|_| "the first step length is not valid")?;
        for _ in 0..MAX_STEPS {
            *budget = budget.checked_sub(1).ok_or("one period needed more than 100000 steps")?;
            let remaining = end - self.method.t();
            if remaining <= negligible {
                return Ok(Arrival { time: end, motion: *self.method.y(), by_event: false });
            }
            let proposed = self.method.h();
            if proposed < negligible.max(f64::MIN_POSITIVE) {
                return Err(TOO_SMALL);
            }
            let taken = proposed.min(remaining);
            self.method.set_h(taken);
            self.method.step(&equations).map_err(|_| "the model is too stiff for an explicit method")?;
            let next = self.method.h();
            if matches!(self.method.status(), Status::RejectedStep) {
                self.step = next;
                continue;
            }
            // A step that was shortened by the end of the period does not determine the length of the next step.
            self.step = if taken < proposed { proposed.max(next) } else { next };
            if !self.method.y().is_finite() {
                return Err("positions or velocities are no longer finite");
            }
            if flow.has_ended(self.method.t(), self.method.y()) {
                return Ok(self.locate(flow));
            }
        }
        Err("20000 steps were not enough to reach the next event or the end of the period")
    }

    /// Locates the event in the last step by bisection on the dense output.
    fn locate(&mut self, flow: &impl Flow<N, NY>) -> Arrival<N, NY> {
        let (mut before, mut after) = (self.method.t_prev(), self.method.t());
        let mut motion = *self.method.y();
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + after);
            // The interpolation only fails outside the step.
            let Ok(there) = self.method.interpolate(middle) else {
                break;
            };
            if flow.has_ended(middle, &there) {
                (after, motion) = (middle, there);
            } else {
                before = middle;
            }
        }
        Arrival { time: after, motion, by_event: true }
    }
}
