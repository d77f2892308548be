//! Nonlinear model predictive control.

use super::delegation::{delegated_controller_methods, delegated_methods};
use super::error::MpcError;
use super::horizon::Horizon;
use super::integrate::{Span, integrate};
use super::node::{Node, Prediction};
use super::options::MpcOptions;
use crate::control_loop::{Command, Controller, ControllerFault, Cycle};
use crate::dynamics::{Discretizable, PhaseSpace};
use crate::feed_forward::FeedForwardError;
use crate::trajectory::Trajectory;

/// Nonlinear MPC: multiple shooting with Runge–Kutta integration, a Gauss–Newton step of sequential quadratic
/// programming per period (real-time iteration), exact sensitivities. See the [module](super).
///
/// A period has two parts. [`prepare`](Self::prepare) integrates and differentiates the shifted plan and
/// needs no measurement; [`feedback`](Self::feedback) takes the measurement and solves the QP, so that only
/// this lies between measurement and input. [`Controller::step`] does both, the first only if it has not
/// been done.
#[derive(Debug, Clone)]
pub struct Nmpc<
    D,
    T,
    const N: usize,
    const M: usize,
    const NX: usize,
    const NR: usize = 0,
    const NY: usize = N,
> {
    horizon: Horizon<D, T, N, M, NX, NR, NY>,
    /// Start of the prepared horizon (s); NaN if none is.
    prepared: f64,
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Nmpc<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    /// A controller of `model` along `trajectory`. All memory is allocated here, and all terminal weights are
    /// computed. [`MpcOptions::linearization`] and [`MpcOptions::prediction`] have no influence.
    ///
    /// # Errors
    /// [`MpcError`].
    pub fn new(model: D, trajectory: T, options: MpcOptions<N, M, NR>) -> Result<Self, MpcError>
    where
        D: PhaseSpace<NX>,
    {
        Ok(Self { horizon: Horizon::new(model, trajectory, options)?, prepared: f64::NAN })
    }

    delegated_methods!();

    /// Goes on with another model from the next step on, e.g. with friction that was identified in operation.
    /// Estimate and plan stay; so do the terminal weights, which stand for what lies beyond the horizon and
    /// change little with friction. Allocates nothing if the input matrix is the same.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`]; the model then stays.
    pub fn set_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        self.prepared = f64::NAN;
        self.horizon.set_model(model)
    }

    /// Prepares the next period, which follows `time` (s), the one of the last [`feedback`](Self::feedback).
    pub fn prepare(&mut self, time: f64) {
        let period = self.horizon.options.period;
        let ahead = if self.horizon.options.delay { 2.0 } else { 1.0 };
        self.predict(time + ahead * period);
    }

    /// Integrates and differentiates the plan, shifted to begin at `start`.
    fn predict(&mut self, start: f64) {
        self.horizon.look_ahead(start);
        self.horizon.shift_plan(start);
        self.set_stages(start);
        self.prepared = start;
    }

    fn set_stages(&mut self, start: f64) {
        let horizon = &mut self.horizon;
        for k in 0..horizon.options.horizon {
            let (at, u) = horizon.planned_point(k);
            let (period, substeps) = (horizon.options.period, horizon.substeps);
            let span = Span { start: start + k as f64 * period, period, substeps };
            let step = integrate(horizon.model(), &at.positions, &at.velocities, &u, span);
            let prediction = Prediction {
                state: &step.state,
                input: &step.input,
                next: Node { positions: step.coordinates, velocities: step.velocities },
                at: (at, u),
            };
            horizon.set_stage(k, &prediction);
        }
    }

    /// Takes in the measurement and gives the input of this period.
    ///
    /// # Errors
    /// As [`Controller::step`].
    pub fn feedback(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault> {
        let (start, state) = self.horizon.observe(cycle)?;
        let late = (start - self.prepared).abs() > 1e-6 * self.horizon.options.period;
        if late || self.prepared.is_nan() {
            self.predict(start);
        }
        self.prepared = f64::NAN;
        self.horizon.solve(start, &state)
    }
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Controller<N, M, NY> for Nmpc<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    fn reset(&mut self, positions: &[f64; NY], inputs: &[f64; M]) {
        self.horizon.reset(positions, inputs);
        self.prepared = f64::NAN;
    }

    fn step(&mut self, cycle: &Cycle<N, M, NY>) -> Result<Command<M>, ControllerFault> {
        self.feedback(cycle)
    }

    delegated_controller_methods!();

    /// All that this writes, the step writes anew: reference, stages, solution. Estimate and plan stay, and
    /// stages that [`prepare`](Nmpc::prepare) has set.
    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        if self.prepared.is_nan() {
            let start = self.horizon.start_at(next.time);
            self.horizon.look_ahead(start);
            self.set_stages(start);
        }
        self.horizon.rehearse(next);
    }
}
