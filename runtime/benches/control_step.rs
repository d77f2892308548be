//! A whole control step, and the share of each stage: `cargo bench -p gelenk-runtime --bench control_step`.
//!
//! LTV-MPC with N = 20 in closed loop with its own model, encoders with noise, disturbance observer on. The
//! step is timed as a whole, per period; the stages once more each by itself: observer (prediction and
//! correction), horizon (desired states, feed-forward, linearization, discretization), log (one record into
//! the queue). What is left is the QP with its set-up. Times are CPU times of the thread, medians over the
//! periods; "bounded" counts only periods whose QP has active bounds, and "per iteration" divides their QP with
//! its set-up by its iterations.
//!
//! The modules have lanes for `linearize`. The exact hold is computed over lanes, as the controller does ([`ZeroOrderHolds`]); the
//! line "one by one" has the horizon with `discretize` of each stage, and the ratio of the two.
//!
//! Each robot's linear controller predicts by the exact zero-order hold and by the implicit midpoint rule; the line "midpoint
//! to hold" has the ratios of whole steps, of bounded ones, of the horizon, and of the prediction of a stage alone.
//!
//! The last line compares the quadrotor on its figure (`examples/quadrotor.rs`: 12 states, 4 inputs) with UR5 (12
//! states, 6 inputs). Over all periods the ratio depends on how often the bounds of each motion are active.

use gelenk_runtime::control_loop::{Controller, Cycle, LogRecord, LogSink, Source, log_to};
use gelenk_runtime::dynamics::{Discretizable, Discretization, LimitRows, Linearization, PhaseSpace, Point};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::lanes::{ZeroOrderHolds, instructions};
use gelenk_runtime::mpc::{DisturbanceObserver, LtvMpc, MpcOptions, Nmpc, PredictionRule};
use gelenk_runtime::trajectory::{RestToRest, Sample, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;

#[path = "../examples/support/flight.rs"]
mod flight;

const HORIZON: usize = 20;
const ENCODER_STEP: f64 = 1e-5;

gelenk_runtime::dynamics!(
    struct PowerCube = gelenk_generated::powercube: Discretizable []
);
gelenk_runtime::dynamics!(struct Panda = gelenk_test_robots::panda_over_lanes);
gelenk_runtime::dynamics!(struct Ur5 = gelenk_test_robots::ur5_over_lanes);
gelenk_runtime::dynamics!(struct Quadrotor = gelenk_test_robots::quadrotor_over_lanes);

/// CPU time of this thread in microseconds.
fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v.get(v.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Median time of a call of `work`, in batches, so that the clock does not count.
fn time_alone(mut work: impl FnMut(usize)) -> f64 {
    const BATCH: usize = 20;
    let batches = (0..200).map(|b| {
        let start = cpu_time();
        for i in 0..BATCH {
            work(b * BATCH + i);
        }
        (cpu_time() - start) / BATCH as f64
    });
    median(batches.collect())
}

/// Times of all periods, and times and iterations of those with active bounds.
struct Loop {
    all: Vec<f64>,
    bounded: Vec<f64>,
    iterations: Vec<f64>,
}

/// A robot, its motion, how it is controlled and sampled.
struct Case<D, T, const N: usize, const M: usize> {
    name: &'static str,
    model: D,
    motion: T,
    options: MpcOptions<N, M>,
    substeps: usize,
}

fn drive<
    D: Discretizable<N, M, NY>,
    T: Trajectory<N, NY>,
    const N: usize,
    const M: usize,
    const NY: usize,
>(
    Case { model, motion, options, substeps, .. }: &Case<D, T, N, M>,
    log: &mut LogSink<N, M, NY>,
    controller: &mut impl Controller<N, M, NY>,
) -> Result<Loop, Box<dyn Error>> {
    let period = options.period;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut record = Loop { all: vec![], bounded: vec![], iterations: vec![] };
    for _ in 0..3 {
        let start = motion.sample(0.0);
        let mut state = (start.positions, start.velocities);
        let mut last = [0.0; M];
        controller.reset(&state.0, &last);
        for k in 0..(motion.duration() / period) as usize + 20 {
            let time = k as f64 * period;
            let noise = core::array::from_fn(|_| ENCODER_STEP * random.random_range(-0.5..0.5));
            let positions = model.integrate(&state.0, &noise);
            let cycle = Cycle {
                time,
                periods: u32::from(k > 0),
                positions: Some(positions),
                velocities: options.observer.velocity_sensor_noise.map(|_| state.1),
                last_inputs: last,
                ..Cycle::default()
            };
            let begin = cpu_time();
            let command = controller.step(&cycle)?;
            log.push(log_record(time, &positions, &command.inputs));
            let spent = cpu_time() - begin;
            record.all.push(spent);
            if command.iterations > 0 {
                record.bounded.push(spent);
                record.iterations.push(f64::from(command.iterations));
            }
            last = command.inputs;
            for _ in 0..*substeps {
                state = model.step(&state.0, &state.1, &last, period / *substeps as f64);
            }
        }
    }
    Ok(record)
}

fn log_record<const N: usize, const M: usize, const NY: usize>(
    time: f64,
    positions: &[f64; NY],
    inputs: &[f64; M],
) -> LogRecord<N, M, NY> {
    LogRecord {
        time,
        positions: *positions,
        velocities: [0.0; N],
        measured_velocities: None,
        measured_torques: None,
        desired: [0.0; NY],
        inputs: *inputs,
        source: Source::Controller,
        believed: true,
        iterations: 0,
        lateness: 0,
        stages: [0; 4],
        learned: [None; N],
    }
}

/// Prints whole steps of both controllers and stages of the linear one. Returns the medians of the linear one's
/// steps: of all, and of those with active bounds.
fn bench<D, T, const N: usize, const M: usize, const NX: usize, const NY: usize>(
    case: &Case<D, T, N, M>,
) -> Result<[f64; 2], Box<dyn Error>>
where
    D: Discretizable<N, M, NY> + PhaseSpace<NX> + Copy,
    T: Trajectory<N, NY> + Clone,
{
    let Case { name, model, motion, options, .. } = case;
    let (mut log, writer) = log_to::<N, M, NY>(std::io::sink(), model, 100_000)?;
    let rules = [PredictionRule::ExactHold, PredictionRule::ImplicitMidpoint];
    let mut linear = Vec::new();
    for prediction in rules {
        let options = MpcOptions { prediction, ..options.clone() };
        let mut ltv = LtvMpc::<D, _, N, M, NX, 0, NY>::new(*model, motion.clone(), options)?;
        linear.push((drive(case, &mut log, &mut ltv)?, stages(case, &mut log, prediction)?));
    }
    let mut nmpc = Nmpc::<D, _, N, M, NX, 0, NY>::new(*model, motion.clone(), options.clone())?;
    let nonlinear = drive(case, &mut log, &mut nmpc)?;
    drop(log);
    writer.finish()?;
    let names = [name, "  midpoint"];
    let shown = names.iter().zip(&linear).map(|(name, (times, besides))| print_linear(name, times, besides));
    let medians: Vec<_> = shown.collect();
    let ratio = |of: fn(&Stages) -> f64| of(&linear[1].1) / of(&linear[0].1);
    println!(
        "{:<10} midpoint to hold: step {:.2}, bounded {:.2}, horizon {:.2}, prediction {:.2} ({:.0} to {:.0} ns a stage)",
        "",
        medians[1][0] / medians[0][0],
        medians[1][1] / medians[0][1],
        ratio(|stages| stages.looking),
        ratio(|stages| stages.predicting),
        1e3 * linear[1].1.predicting,
        1e3 * linear[0].1.predicting,
    );
    let Stages { looking, one_by_one, .. } = linear[0].1;
    println!(
        "{:<10} one by one: horizon {one_by_one:.1} us; over lanes {:.2} of it",
        "",
        looking / one_by_one
    );
    println!(
        "{:<10} NMPC    {:>6.1} us, bounded {:>6.1} us",
        "",
        median(nonlinear.all),
        median(nonlinear.bounded)
    );
    Ok(medians[0])
}

/// Time of a step of the linear controller outside its QP (µs).
struct Stages {
    observing: f64,
    /// The horizon: reference, feed-forward and prediction of each period.
    looking: f64,
    /// The same with `discretize` of each period.
    one_by_one: f64,
    /// The prediction of one period alone, its share of all.
    predicting: f64,
    logging: f64,
}

/// Measures each of them alone.
fn stages<D, T, const N: usize, const M: usize, const NY: usize>(
    case: &Case<D, T, N, M>,
    log: &mut LogSink<N, M, NY>,
    rule: PredictionRule,
) -> Result<Stages, Box<dyn Error>>
where
    D: Discretizable<N, M, NY> + Copy,
    T: Trajectory<N, NY>,
{
    let Case { model, motion, options, substeps, .. } = case;
    let period = options.period;
    let sample = motion.sample(0.5 * motion.duration());
    let feed_forward = FeedForward::new(*model)?;
    let mut inputs = feed_forward.at(&sample).inputs;
    let mut observer = DisturbanceObserver::<N, M, NY>::starting_at(&sample.positions, options.observer)?;
    observer.reset(&sample.positions, &sample.velocities);
    let observing = time_alone(|_| {
        observer.predict(model, &inputs, period, *substeps);
        observer.correct_by(model, &sample.positions);
        std::hint::black_box(&observer);
    });
    let mut horizon = vec![(sample, inputs); HORIZON];
    let mut lanes = Lanes::new(model);
    let mut look = |i: usize, lanes: &mut Lanes<N, M, NY>, rule| {
        for k in 0..HORIZON {
            let time = (i % 50 + k) as f64 * period;
            std::hint::black_box(motion.sample(time));
            let middle = motion.sample(time + 0.5 * period);
            // The others are those of the period before.
            if k + 1 == HORIZON {
                inputs = feed_forward.at(&middle).inputs;
            }
            horizon[k] = (middle, inputs);
        }
        predict(model, lanes, &horizon, period, rule);
    };
    let looking = time_alone(|i| look(i, &mut lanes, Some(rule)));
    let one_by_one = time_alone(|i| look(i, &mut lanes, None));
    let horizon = vec![(sample, inputs); HORIZON];
    let all = time_alone(|_| predict(model, &mut lanes, &horizon, period, Some(rule)));
    let predicting = all / HORIZON as f64;
    let logging = time_alone(|_| log.push(log_record(0.0, &sample.positions, &inputs)));
    Ok(Stages { observing, looking, one_by_one, predicting, logging })
}

/// Memory of predictions over lanes.
struct Lanes<const N: usize, const M: usize, const NY: usize> {
    points: Vec<Point<N, M, NY>>,
    linear: Vec<Linearization<N, M, NY>>,
    drifts: Vec<[[f64; N]; N]>,
    held: Vec<Discretization<N, M, NY>>,
    holds: ZeroOrderHolds<N, M>,
}

impl<const N: usize, const M: usize, const NY: usize> Lanes<N, M, NY> {
    fn new(model: &impl Discretizable<N, M, NY>) -> Self {
        Self {
            points: Vec::new(),
            linear: vec![Linearization::ZERO; HORIZON],
            drifts: vec![[[0.0; N]; N]; HORIZON],
            held: vec![model.discretize(&model.neutral(), &[0.0; N], &[0.0; M], 1e-3); HORIZON],
            holds: ZeroOrderHolds::new(),
        }
    }
}

/// Predicts every stage: by the rule, or one by one by the exact hold.
fn predict<const N: usize, const M: usize, const NY: usize>(
    model: &impl Discretizable<N, M, NY>,
    lanes: &mut Lanes<N, M, NY>,
    horizon: &[(Sample<N, NY>, [f64; M])],
    period: f64,
    rule: Option<PredictionRule>,
) {
    let Some(PredictionRule::ExactHold) = rule else {
        for (at, u) in horizon {
            let (y, v, a) = (&at.positions, &at.velocities, &at.accelerations);
            match rule {
                None => drop(std::hint::black_box(model.discretize(y, v, u, period))),
                _ => drop(std::hint::black_box(model.midpoint_step(y, v, a, u, period))),
            }
        }
        return;
    };
    let Lanes { points, linear, drifts, held, holds } = lanes;
    points.clear();
    points.extend(horizon.iter().map(|(at, inputs)| Point {
        time: 0.0,
        positions: at.positions,
        velocities: at.velocities,
        inputs: *inputs,
    }));
    model.linearize_along(instructions(), points, linear);
    if N != NY {
        drifts.iter_mut().zip(&*points).for_each(|(drift, point)| *drift = model.drift(&point.velocities));
    }
    holds.discretize(linear, (N != NY).then_some(&drifts[..]), period, held);
    std::hint::black_box(held);
}

/// Prints the linear controller's steps; their medians, of all, and of those with active bounds.
fn print_linear(name: &str, linear: &Loop, Stages { observing, looking, logging, .. }: &Stages) -> [f64; 2] {
    let (all, whole) = (median(linear.all.clone()), median(linear.bounded.clone()));
    let besides = observing + looking + logging;
    let share = |stage: f64| format!("{stage:.1} ({:.0} %)", 100.0 * stage / whole);
    let sum: f64 = linear.iterations.iter().sum();
    let in_qp: f64 = linear.bounded.iter().map(|spent| spent - besides).sum();
    println!(
        "{name:<10} LTV-MPC {all:>6.1} us, bounded {whole:>6.1} us in {} of {} periods: observer {}, horizon {}, QP {}, log {}",
        linear.bounded.len(),
        linear.all.len(),
        share(*observing),
        share(*looking),
        share(whole - besides),
        share(*logging),
    );
    println!(
        "{:<10} iterations {sum}, median of bounded periods {}, most {}, {:.2} us per iteration",
        "",
        median(linear.iterations.clone()),
        linear.iterations.iter().copied().fold(0.0, f64::max),
        in_qp / sum
    );
    [all, whole]
}

/// Limits of the inputs' magnitudes, and as much noise of the disturbance as they call for.
fn options<D: Discretizable<N, M> + LimitRows<0>, const N: usize, const M: usize>(
    model: &D,
    torque: [f64; M],
) -> MpcOptions<N, M> {
    let mut options = MpcOptions::new(model, 0.02, HORIZON);
    options.input_limits = torque.map(|u| [-u, u]);
    options.observer.disturbance_noise = torque.map(|u| 1e-3 * u);
    options
}

fn main() -> Result<(), Box<dyn Error>> {
    let motion = RestToRest::new([-0.8, -1.0], [0.6, 0.9], 3.0)?;
    let of_cube = options(&PowerCube, [0.4; 2]);
    bench(&Case { name: "PowerCube", model: PowerCube, motion, options: of_cube, substeps: 12 })?;
    let motion =
        RestToRest::new([0.0, -0.8, 0.0, -2.2, 0.0, 1.5, 0.8], [1.0, 0.3, -0.6, -1.2, 0.7, 2.3, -0.4], 1.0)?;
    let of_panda = options(&Panda, [25.0, 60.0, 20.0, 25.0, 4.0, 3.0, 1.5]);
    bench(&Case { name: "Panda", model: Panda, motion, options: of_panda, substeps: 1 })?;
    let motion = RestToRest::new([0.0, -1.2, 1.0, -0.5, 0.5, 0.0], [1.0, -0.6, 1.6, -1.2, 1.0, 0.8], 0.5)?;
    let of_arm = options(&Ur5, [25.0, 60.0, 25.0, 4.0, 2.0, 1.0]);
    let arm = bench(&Case { name: "UR5", model: Ur5, motion, options: of_arm, substeps: 4 })?;
    let (model, motion) = (Quadrotor, flight::figure()?);
    let of_flight = flight::options([10.0, 10.0]);
    let flight = bench(&Case { name: "quadrotor", model, motion, options: of_flight, substeps: 1 })?;
    println!(
        "quadrotor beside UR5: {:.2} times, bounded {:.2} times",
        flight[0] / arm[0],
        flight[1] / arm[1]
    );
    Ok(())
}
