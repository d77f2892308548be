//! The PowerCube along its published trajectory: plant, controllers, measures.
#![allow(dead_code, reason = "each test binary uses its own part")]
#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::{Dynamics, LimitRows};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LinearizationPoint, MpcOptions};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, Sampled, Smoothing, Trajectory};

gelenk_runtime::dynamics!(
    pub struct PowerCube = gelenk_generated::powercube: Discretizable []
);
gelenk_runtime::dynamics!(
    pub struct FreePowerCube { parameters } =
        gelenk_generated::powercube_parameters: Discretizable []
);

/// Period of the published trajectory, and of control along it [s].
pub const PERIOD: f64 = 0.02;
/// Gear ratio of both joints.
pub const GEAR: f64 = 161.0;
/// Peak torque of the motors [N m].
pub const PEAK: f64 = 0.5;

pub fn recording() -> Recording<2> {
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/powercube_trajectory.csv");
    Recording::open(path, &columns).unwrap()
}

pub fn smoothed(recording: &Recording<2>) -> Sampled<2> {
    recording.smoothed(&Smoothing::of(PERIOD)).unwrap().trajectory
}

/// Options for tracking: velocity errors weigh so little that positions return within about a period.
pub fn options<D>(model: &D, period: f64, horizon: usize) -> MpcOptions<2, 2>
where
    D: Dynamics<2, 2> + LimitRows<0>,
{
    let mut options = MpcOptions::new(model, period, horizon);
    options.velocity_weight = [5.0, 3.5];
    options.linearization = LinearizationPoint::Reference;
    // The paper has no estimate of disturbances.
    options.observer.disturbance_noise = [0.0; 2];
    options
}

/// Results of a run, by joint.
#[derive(Debug, Clone, Copy, Default)]
pub struct Run {
    /// Rms of y − y_ref [rad].
    pub rms: [f64; 2],
    pub largest: [f64; 2],
    /// Rms of y minus the samples of the file [rad].
    pub rms_to_file: [f64; 2],
    /// i·rms(u − u_ff) at the joint [N m], u_ff in the middle of each period.
    pub correction: [f64; 2],
    /// Largest |u|.
    pub input: f64,
    /// y − y_ref when the last period begins [rad].
    pub last: [f64; 2],
    pub iterations: u32,
}

/// Runs `controller` on `plant_model` along `reference`, with the controller's feed-forward `inputs` at a
/// time.
pub fn run(
    plant_model: impl Dynamics<2, 2>,
    options: PlantOptions<2, 2>,
    controller: &mut impl Controller<2, 2>,
    reference: &impl Trajectory<2>,
    period: f64,
    inputs: impl Fn(f64) -> [f64; 2],
) -> Run {
    let file = recording();
    let mut plant = Plant::new(plant_model, options).unwrap();
    let start = reference.sample(0.0);
    plant.reset(start.positions, start.velocities).unwrap();
    let mut last = inputs(0.0);
    plant.preload(last);
    controller.reset(&start.positions, &last);
    let steps = (reference.duration() / period).floor() as usize;
    let mut run = Run::default();
    for k in 0..steps {
        let time = k as f64 * period;
        let (y, _) = plant.state();
        let desired = reference.sample(time).positions;
        let row = ((time / PERIOD).round() as usize).min(file.positions().len() - 1);
        let cycle = Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs: last,
            ..Cycle::default()
        };
        let command = controller.step(&cycle).unwrap();
        let forward = inputs(time + 0.5 * period);
        for i in 0..2 {
            let error = y[i] - desired[i];
            run.rms[i] += error * error;
            run.last[i] = error;
            run.largest[i] = run.largest[i].max(error.abs());
            run.rms_to_file[i] += (y[i] - file.positions()[row][i]).powi(2);
            run.correction[i] += (GEAR * (command.inputs[i] - forward[i])).powi(2);
            run.input = run.input.max(command.inputs[i].abs());
        }
        run.iterations = run.iterations.max(command.iterations);
        last = command.inputs;
        plant.apply(&last, period).unwrap();
    }
    for sum in [&mut run.rms, &mut run.rms_to_file, &mut run.correction] {
        *sum = sum.map(|x| (x / steps as f64).sqrt());
    }
    run
}

/// A plant like the model, but for the motors' peak torque.
pub fn exact() -> PlantOptions<2, 2> {
    PlantOptions { input_limits: [[-PEAK, PEAK]; 2], ..PlantOptions::default() }
}

/// Feed-forward of `model` along `reference`.
pub fn feed_forward(model: impl Dynamics<2, 2>, reference: &impl Trajectory<2>) -> impl Fn(f64) -> [f64; 2] {
    let feed_forward = FeedForward::new(model).unwrap();
    move |time| feed_forward.at(&reference.sample(time)).inputs
}

/// Feed-forward alone, held over each period from its `share`; largest deviation by joint [rad].
pub fn open_loop(reference: &Sampled<2>, share: f64) -> [f64; 2] {
    let inputs = feed_forward(PowerCube, reference);
    let mut plant = Plant::new(PowerCube, exact()).unwrap();
    plant.reset(reference.sample(0.0).positions, [0.0; 2]).unwrap();
    let mut largest = [0.0_f64; 2];
    for k in 0..reference.samples().len() - 1 {
        plant.apply(&inputs((k as f64 + share) * PERIOD), PERIOD).unwrap();
        let desired = reference.samples()[k + 1].positions;
        for i in 0..2 {
            largest[i] = largest[i].max((plant.state().0[i] - desired[i]).abs());
        }
    }
    largest
}
