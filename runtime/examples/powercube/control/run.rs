//! Runs of a controller on the simulated arm, and their results.

use crate::arm::{Arm, GEAR, PEAK, PERIOD, Regime};
use crate::study::Outcome;
use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle};
use gelenk_runtime::dynamics::Predictable;
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LinearizationPoint, LtvMpc, MpcOptions, Nmpc, ObserverOptions};
use gelenk_runtime::plant::Plant;
use gelenk_runtime::trajectory::{Sample, Sampled, Trajectory};

pub type Ltv<T> = LtvMpc<Arm, T, 2, 2, 4>;
pub type Nonlinear<T> = Nmpc<Arm, T, 2, 2, 4>;

/// Number of stages of the horizon at 50 Hz.
pub const HORIZON: usize = 20;

/// Options as in the paper: linearization around the desired trajectory, without estimation of disturbances. The weight of velocity
/// errors is so small that position errors vanish within about a period.
pub fn options(model: &Arm, period: f64) -> MpcOptions<2, 2> {
    // The horizon covers the same time for all sample times, but has at least eight stages.
    let stages = (HORIZON as f64 * PERIOD / period).round() as usize;
    MpcOptions {
        velocity_weight: [5.0, 3.5],
        linearization: LinearizationPoint::Reference,
        observer: ObserverOptions::default(),
        ..MpcOptions::new(model, period, stages.clamp(8, HORIZON))
    }
}

/// A controller with the feed-forward of its model.
pub trait Modelled: Controller<2, 2> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]>;
}

impl<D: Predictable<2, 2, 4>, T: Trajectory<2>> Modelled for LtvMpc<D, T, 2, 2, 4>
where
    D: Clone,
{
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        Ok(FeedForward::new(self.model().clone())?.at(sample).inputs)
    }
}

impl<T: Trajectory<2>> Modelled for Nonlinear<T> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        Ok(FeedForward::new(*self.model())?.at(sample).inputs)
    }
}

/// Controller without feedback.
pub struct FeedForwardAlone<'t> {
    feed_forward: FeedForward<Arm, 2, 2>,
    reference: &'t Sampled<2>,
    period: f64,
}

impl<'t> FeedForwardAlone<'t> {
    pub fn new(model: Arm, reference: &'t Sampled<2>, period: f64) -> Outcome<Self> {
        Ok(Self { feed_forward: FeedForward::new(model)?, reference, period })
    }
}

impl Controller<2, 2> for FeedForwardAlone<'_> {
    fn reset(&mut self, _: &[f64; 2], _: &[f64; 2]) {}

    /// Returns the feed-forward in the middle of the period, which is the best choice for an input that is constant in the period.
    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let sample = self.reference.sample(cycle.time + 0.5 * self.period);
        Ok(Command { inputs: limited(self.feed_forward.at(&sample).inputs), iterations: 0 })
    }
}

impl Modelled for FeedForwardAlone<'_> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        Ok(self.feed_forward.at(sample).inputs)
    }
}

fn limited(inputs: [f64; 2]) -> [f64; 2] {
    inputs.map(|u| u.clamp(-PEAK, PEAK))
}

/// The plant of a run.
#[derive(Clone, Copy)]
pub struct Setup {
    pub plant: Arm,
    pub regime: Regime,
    pub seed: u64,
    /// Distance of the arm from the start of the reference [rad].
    pub offset: [f64; 2],
    /// Function that returns the plant at a time (s); `None` if the plant does not change.
    pub change: Option<fn(f64) -> Arm>,
}

impl Setup {
    /// A plant that starts on the reference and does not change.
    pub fn new(plant: Arm, regime: Regime) -> Self {
        Self { plant, regime, seed: 1, offset: [0.0; 2], change: None }
    }
}

/// State at the beginning of a period, and the inputs for this period.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub time: f64,
    pub desired: [f64; 2],
    /// True positions and velocities.
    pub positions: [f64; 2],
    pub velocities: [f64; 2],
    /// Motor torques [N m] of the controller, and of the feed-forward of its model.
    pub inputs: [f64; 2],
    pub forward: [f64; 2],
    /// Measured positions of the encoders.
    pub measured: [f64; 2],
    pub iterations: u32,
}

impl Row {
    pub fn error(&self, i: usize) -> f64 {
        self.positions[i] - self.desired[i]
    }

    /// Part of the torque at the joint that feedback adds [N m].
    pub fn gap(&self, i: usize) -> f64 {
        GEAR * (self.inputs[i] - self.forward[i])
    }
}

/// Recorded motion along a trajectory.
#[derive(Debug, Clone)]
pub struct Run {
    pub rows: Vec<Row>,
}

impl Run {
    fn rms(&self, value: impl Fn(&Row) -> f64) -> f64 {
        let sum: f64 = self.rows.iter().map(|row| value(row).powi(2)).sum();
        (sum / self.rows.len() as f64).sqrt()
    }

    fn largest(&self, value: impl Fn(&Row) -> f64) -> f64 {
        let values = self.rows.iter().map(|row| value(row).abs());
        values.fold(0.0, f64::max)
    }

    /// Root mean square of the error y − y_ref of joint `i` [rad].
    pub fn rms_error(&self, i: usize) -> f64 {
        self.rms(|row| row.error(i))
    }

    /// Largest error |y − y_ref| of joint `i` [rad].
    pub fn largest_error(&self, i: usize) -> f64 {
        self.largest(|row| row.error(i))
    }

    /// Root mean square of the torque that feedback adds at the joint, gear ratio times rms(u − u_ff) [N m].
    pub fn gap(&self, i: usize) -> f64 {
        self.rms(|row| row.gap(i))
    }

    pub fn largest_torque(&self) -> f64 {
        let largest = |i: usize| self.largest(|row| row.inputs[i]);
        GEAR * largest(0).max(largest(1))
    }

    pub fn largest_speed(&self) -> f64 {
        let largest = |i: usize| self.largest(|row| row.velocities[i]);
        largest(0).max(largest(1))
    }

    pub fn most_iterations(&self) -> u32 {
        self.rows.iter().map(|row| row.iterations).max().unwrap_or(0)
    }

    /// The part of the run between two times (s).
    pub fn between(&self, from: f64, to: f64) -> Self {
        let rows = self.rows.iter();
        let rows = rows.filter(|row| (from..to).contains(&row.time));
        Self { rows: rows.copied().collect() }
    }

    /// Points over time for a figure.
    pub fn points(&self, value: impl Fn(&Row) -> f64) -> Vec<[f64; 2]> {
        self.rows.iter().map(|row| [row.time, value(row)]).collect()
    }
}

/// Runs `controller` along `reference` to its end.
pub fn drive(setup: &Setup, controller: &mut impl Modelled, reference: &impl Trajectory<2>) -> Outcome<Run> {
    let period = setup.regime.period;
    let mut plant = Plant::new(setup.plant, setup.regime.plant(setup.seed))?;
    let start = reference.sample(0.0);
    let positions = core::array::from_fn(|i| start.positions[i] + setup.offset[i]);
    plant.reset(positions, start.velocities)?;
    let mut last = limited(controller.forward(&start)?);
    plant.preload(last);
    controller.reset(&plant.measure().positions, &last);
    let steps = (reference.duration() / period + 1e-9).floor() as usize;
    let mut rows = Vec::with_capacity(steps);
    for k in 0..steps {
        let time = k as f64 * period;
        if let Some(at) = setup.change {
            plant.set_model(at(time));
        }
        let (positions, velocities) = plant.state();
        let measured = plant.measure().positions;
        let command = controller.step(&Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(measured),
            last_inputs: last,
            ..Cycle::default()
        })?;
        rows.push(Row {
            time,
            desired: reference.sample(time).positions,
            positions,
            velocities,
            inputs: command.inputs,
            forward: controller.forward(&reference.sample(time + 0.5 * period))?,
            measured,
            iterations: command.iterations,
        });
        last = command.inputs;
        plant.apply(&last, period)?;
    }
    Ok(Run { rows })
}

/// Runs the LTV-MPC with `model`.
pub fn linear(
    setup: &Setup,
    model: Arm,
    options: MpcOptions<2, 2>,
    reference: &impl Trajectory<2>,
) -> Outcome<Run> {
    drive(setup, &mut Ltv::new(model, reference, options)?, reference)
}

/// Runs the nonlinear MPC with `model`.
pub fn nonlinear(
    setup: &Setup,
    model: Arm,
    options: MpcOptions<2, 2>,
    reference: &impl Trajectory<2>,
) -> Outcome<Run> {
    let mut controller = Nonlinear::new(model, reference, options)?;
    drive(setup, &mut controller, reference)
}

/// A motion that is `factor` times as fast as another motion.
#[derive(Clone, Copy)]
pub struct Faster<'t> {
    pub motion: &'t Sampled<2>,
    pub factor: f64,
}

impl Trajectory<2> for Faster<'_> {
    fn duration(&self) -> f64 {
        self.motion.duration() / self.factor
    }

    fn sample(&self, t: f64) -> Sample<2> {
        let sample = self.motion.sample(self.factor * t);
        Sample {
            positions: sample.positions,
            velocities: sample.velocities.map(|v| self.factor * v),
            accelerations: sample.accelerations.map(|a| self.factor * self.factor * a),
        }
    }
}
