//! Nonlinear model predictive control.

use super::delegation::{delegated_controller_methods, delegated_methods};
use super::error::MpcError;
use super::horizon::Horizon;
use super::node::{Node, Prediction};
use super::options::MpcOptions;
use crate::control_loop::{Command, Controller, ControllerFault, Cycle};
use crate::dynamics::{Discretizable, PhaseSpace, Point, Step};
use crate::feed_forward::FeedForwardError;
use crate::lanes::rollout::{Rollouts, TOGETHER};
use crate::trajectory::Trajectory;

/// Nonlinear MPC by multiple shooting with Runge–Kutta integration and exact sensitivities. Each period makes one
/// Gauss–Newton step of sequential quadratic programming (real-time iteration). The [module](super) documents the
/// equations.
///
/// The computation of a period has two parts. [`prepare`](Self::prepare) integrates and differentiates the shifted
/// plan and needs no measurement. [`feedback`](Self::feedback) takes the measurement and solves the QP. Call
/// `prepare` before the measurement arrives to shorten the time between measurement and input. [`Controller::step`]
/// does both parts, but skips `prepare` if it was already called.
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
    rollouts: Rollouts<N, M, NY>,
    /// Time at which the prepared horizon begins (s); NaN if no horizon is prepared.
    prepared: f64,
}

impl<D, T, const N: usize, const M: usize, const NX: usize, const NR: usize, const NY: usize>
    Nmpc<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    /// Constructs a controller of `model` along `trajectory`. Allocates all memory and computes all terminal weights.
    /// [`MpcOptions::linearization`] and [`MpcOptions::prediction`] have no effect.
    ///
    /// # Errors
    /// [`MpcError`] with the reason why the controller cannot be constructed.
    pub fn new(model: D, trajectory: T, options: MpcOptions<N, M, NR>) -> Result<Self, MpcError>
    where
        D: PhaseSpace<NX>,
    {
        let horizon = Horizon::new(model, trajectory, options)?;
        let rollouts = Rollouts::new(horizon.model());
        Ok(Self { horizon, rollouts, prepared: f64::NAN })
    }

    delegated_methods!();

    /// Replaces the model from the next step on, for example by a model with friction that was identified in
    /// operation. The estimate and the plan are kept. The terminal weights are kept too, because they represent the
    /// time after the horizon and depend little on friction. Does not allocate if the input matrix is unchanged.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`] if the input matrix cannot be used. The old model is then kept.
    pub fn set_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        self.prepared = f64::NAN;
        self.horizon.set_model(model)
    }

    /// Integrates and differentiates the plan for the next period. `time` is the trajectory time (s) at which
    /// [`feedback`](Self::feedback) was last called.
    pub fn prepare(&mut self, time: f64) {
        let period = self.horizon.options.period;
        let ahead = if self.horizon.options.delay { 2.0 } else { 1.0 };
        self.predict(time + ahead * period);
    }

    /// Integrates and differentiates the plan, shifted to begin at `start` (s).
    fn predict(&mut self, start: f64) {
        self.horizon.look_ahead(start);
        self.horizon.shift_plan(start);
        self.set_stages(start);
        self.prepared = start;
    }

    fn set_stages(&mut self, start: f64) {
        let Self { horizon, rollouts, .. } = self;
        let (stages, period, substeps) = (horizon.options.horizon, horizon.options.period, horizon.substeps);
        let time = |k: usize| start + k as f64 * period;
        for first in (0..stages).step_by(TOGETHER) {
            let starts = (first..stages).map(|k| {
                let (Node { positions, velocities }, inputs) = horizon.planned_point(k);
                Point { time: time(k), positions, velocities, inputs }
            });
            let steps = rollouts.integrate(horizon.model(), starts, period, substeps);
            for (k, step) in (first..).zip(steps) {
                horizon.set_integrated_stage(k, step);
            }
        }
    }

    /// Processes the measurement and returns the inputs of this period.
    ///
    /// # Errors
    /// The errors of [`Controller::step`].
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
    Horizon<D, T, N, M, NX, NR, NY>
where
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
{
    /// Sets stage `k` to the integration of the plan over this period.
    fn set_integrated_stage(&mut self, k: usize, step: &Step<N, M, NY>) {
        let prediction = Prediction {
            state: &step.state,
            input: &step.input,
            next: Node { positions: step.coordinates, velocities: step.velocities },
            at: self.planned_point(k),
        };
        self.set_stage(k, &prediction);
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

    /// Computes reference, stages and solution in advance. The next step computes them again. The estimate, the plan,
    /// and stages that [`prepare`](Nmpc::prepare) has set do not change.
    fn warm_up(&mut self, next: &Cycle<N, M, NY>) {
        if self.prepared.is_nan() {
            let start = self.horizon.start_at(next.time);
            self.horizon.look_ahead(start);
            self.set_stages(start);
        }
        self.horizon.rehearse(next);
    }
}
