//! A whole control step, and the share of each stage: `cargo bench -p gelenk-runtime --bench control_step`.
//!
//! LTV-MPC with N = 20 in closed loop with its own model, encoders with noise, disturbance observer on. The
//! step is timed as a whole, per period; the stages once more each by itself: observer (prediction and
//! correction), horizon (desired states, feed-forward, linearization, discretization), log (one record into
//! the queue). What is left is the QP with its set-up. Times are CPU times of the thread, medians over the
//! periods; "bounded" counts only periods whose QP has active bounds.

use gelenk_runtime::control_loop::{Controller, Cycle, LogRecord, LogSink, Source, log_to};
use gelenk_runtime::dynamics::{Discretizable, PhaseSpace};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{DisturbanceObserver, LtvMpc, MpcError, MpcOptions, Nmpc};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;

const HORIZON: usize = 20;
const ENCODER_STEP: f64 = 1e-5;

gelenk_runtime::dynamics!(
    struct PowerCube = gelenk_generated::powercube: Discretizable []
);
gelenk_runtime::dynamics!(
    struct Panda = gelenk_generated::panda: Discretizable []
);

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

/// Times of all periods, and of those with active bounds.
struct Loop {
    all: Vec<f64>,
    bounded: Vec<f64>,
    iterations: u32,
}

fn drive<D: Discretizable<N, M>, const N: usize, const M: usize>(
    model: &D,
    motion: &RestToRest<N>,
    period: f64,
    substeps: usize,
    log: &mut LogSink<N, M>,
    controller: &mut impl Controller<N, M>,
) -> Result<Loop, Box<dyn Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut record = Loop { all: vec![], bounded: vec![], iterations: 0 };
    for _ in 0..3 {
        let start = motion.sample(0.0);
        let mut state = (start.positions, start.velocities);
        let mut last = [0.0; M];
        controller.reset(&state.0, &last);
        for k in 0..(motion.duration() / period) as usize + 20 {
            let time = k as f64 * period;
            let positions = state.0.map(|y| y + ENCODER_STEP * random.random_range(-0.5..0.5));
            let cycle = Cycle {
                time,
                periods: u32::from(k > 0),
                positions: Some(positions),
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
                record.iterations = record.iterations.max(command.iterations);
            }
            last = command.inputs;
            for _ in 0..substeps {
                state = model.step(&state.0, &state.1, &last, period / substeps as f64);
            }
        }
    }
    Ok(record)
}

fn log_record<const N: usize, const M: usize>(
    time: f64,
    positions: &[f64; N],
    inputs: &[f64; M],
) -> LogRecord<N, M> {
    LogRecord {
        time,
        positions: *positions,
        velocities: [0.0; N],
        measured_velocities: None,
        measured_torques: None,
        desired: [0.0; N],
        inputs: *inputs,
        source: Source::Controller,
        believed: true,
        iterations: 0,
        lateness: 0,
        stages: [0; 4],
    }
}

/// One robot: whole steps of both controllers, stages of the linear one.
fn bench<D: Discretizable<N, M> + PhaseSpace<NX> + Copy, const N: usize, const M: usize, const NX: usize>(
    name: &str,
    model: D,
    motion: RestToRest<N>,
    period: f64,
    substeps: usize,
    torque: [f64; M],
) -> Result<(), Box<dyn Error>> {
    let mut options = MpcOptions::new(&model, period, HORIZON);
    options.input_limits = torque.map(|u| [-u, u]);
    options.observer.disturbance_noise = torque.map(|u| 1e-3 * u);
    let (mut log, writer) = log_to::<N, M, N>(std::io::sink(), &model, 100_000)?;
    let new = || -> Result<LtvMpc<D, _, N, M, NX>, MpcError> { LtvMpc::new(model, motion, options.clone()) };
    let linear = drive(&model, &motion, period, substeps, &mut log, &mut new()?)?;
    let mut nmpc = Nmpc::new(model, motion, options.clone())?;
    let nonlinear = drive(&model, &motion, period, substeps, &mut log, &mut nmpc)?;

    let sample = motion.sample(0.5 * motion.duration());
    let feed_forward = FeedForward::new(model)?;
    let inputs = feed_forward.at(&sample).inputs;
    let mut observer = DisturbanceObserver::<N, M>::new(options.observer)?;
    observer.reset(&sample.positions, &sample.velocities);
    let observing = time_alone(|_| {
        observer.predict(&model, &inputs, period, substeps);
        observer.correct(&sample.positions);
        std::hint::black_box(&observer);
    });
    let looking = time_alone(|i| {
        for k in 0..HORIZON {
            let time = (i % 50 + k) as f64 * period;
            std::hint::black_box(motion.sample(time));
            let middle = motion.sample(time + 0.5 * period);
            let u = feed_forward.at(&middle).inputs;
            let (y, v) = (&middle.positions, &middle.velocities);
            std::hint::black_box(model.discretize(y, v, &u, period));
        }
    });
    let logging = time_alone(|_| log.push(log_record(0.0, &sample.positions, &inputs)));
    drop(log);
    writer.finish()?;

    let whole = median(linear.bounded.clone());
    let share = |stage: f64| format!("{stage:.1} ({:.0} %)", 100.0 * stage / whole);
    println!(
        "{name:<10} LTV-MPC {:>6.1} us, bounded {whole:>6.1} us in {} of {} periods, at most {} iterations: observer {}, horizon {}, QP {}, log {}",
        median(linear.all.clone()),
        linear.bounded.len(),
        linear.all.len(),
        linear.iterations,
        share(observing),
        share(looking),
        share(whole - observing - looking - logging),
        share(logging),
    );
    println!(
        "{:<10} NMPC    {:>6.1} us, bounded {:>6.1} us",
        "",
        median(nonlinear.all),
        median(nonlinear.bounded)
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let swing = RestToRest::new([-0.8, -1.0], [0.6, 0.9], 3.0)?;
    bench::<_, 2, 2, 4>("PowerCube", PowerCube, swing, 0.02, 12, [0.4; 2])?;
    let reach =
        RestToRest::new([0.0, -0.8, 0.0, -2.2, 0.0, 1.5, 0.8], [1.0, 0.3, -0.6, -1.2, 0.7, 2.3, -0.4], 1.0)?;
    let torque = [25.0, 60.0, 20.0, 25.0, 4.0, 3.0, 1.5];
    bench::<_, 7, 7, 14>("Panda", Panda, reach, 0.02, 1, torque)?;
    Ok(())
}
