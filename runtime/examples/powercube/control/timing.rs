//! Claim 11: computing time of a step and of the regressions.

use super::identified::{FrictionSamples, identify, record};
use super::run::{Faster, HORIZON, Ltv, Modelled, Nonlinear, Run, Setup, drive};
use super::{limits, show};
use crate::arm::{self, Arm, Friction, GEAR, JOINTS, PEAK, Regime, arm};
use crate::study::{Outcome, Part, Study};
use gelenk_identification::methods::cross_validation::{CrossValidation, refit};
use gelenk_identification::methods::lasso::Lasso;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::moments::{Moments, Samples};
use gelenk_identification::methods::stribeck::StribeckRegression;
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle, Estimate};
use gelenk_runtime::trajectory::{Sample, Sampled, Trajectory};
use rustix::time::{ClockId, clock_gettime};

/// Largest allowed number of iterations in a period.
const ITERATIONS: f64 = 15.0;
/// Number of folds of the LASSO.
const FOLDS: usize = 10;
/// Number of values of λ that the LASSO tries.
const LAMBDAS: usize = 100;

/// CPU time of this thread (µs).
fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// A controller whose steps are timed.
struct Timed<C> {
    controller: C,
    times: Vec<f64>,
}

impl<C: Controller<2, 2>> Controller<2, 2> for Timed<C> {
    fn reset(&mut self, positions: &[f64; 2], inputs: &[f64; 2]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let start = cpu_time();
        let command = self.controller.step(cycle);
        self.times.push(cpu_time() - start);
        command
    }

    fn planned(&self, periods: u32) -> Option<[f64; 2]> {
        self.controller.planned(periods)
    }

    fn estimate(&self) -> Option<Estimate<2>> {
        self.controller.estimate()
    }
}

impl<C: Modelled> Modelled for Timed<C> {
    fn forward(&self, sample: &Sample<2>) -> Outcome<[f64; 2]> {
        self.controller.forward(sample)
    }
}

/// A run, and the CPU time of its steps (µs).
struct Measured {
    name: &'static str,
    run: Run,
    times: Vec<f64>,
}

fn measured(
    name: &'static str,
    controller: impl Modelled,
    reference: &impl Trajectory<2>,
) -> Outcome<Measured> {
    let setup = Setup::new(arm([Friction::B, Friction::C]), Regime::IDEAL);
    let mut timed = Timed { controller, times: Vec::new() };
    let run = drive(&setup, &mut timed, reference)?;
    Ok(Measured { name, run, times: timed.times })
}

/// Number of iterations in the worst period of two runs. The first run is `factor` times as fast as published, with active torque
/// limits. The second run has the published speed, with an active speed limit.
pub fn worst_iterations(model: Arm, motion: &Sampled<2>, factor: f64) -> Outcome<u32> {
    let fast = limits::torque_limited(model, motion, factor, GEAR * PEAK)?;
    let slow = limits::speed_limited(model, motion, limits::SPEED, limits::PENALTY)?;
    Ok(fast.most_iterations().max(slow.most_iterations()))
}

/// Number of passes of the nonlinear regression over all samples of a joint, after a start on binned data. Sparse regression makes
/// one pass, which computes moments.
pub fn passes(samples: &FrictionSamples, joint: usize) -> Outcome<usize> {
    let (v, torque) = (&samples.velocities[joint], &samples.torques[joint]);
    let fit = StribeckRegression::default().fit(v, torque)?;
    Ok(fit.iterations)
}

pub fn claim(worst: u32, passes: [usize; 2]) -> Claim {
    let mut claim = Claim::new(
        "claim-11",
        "A step of the MPC fits into its period of 20 ms, also in the worst case; sparse regression is cheaper than nonlinear regression.",
    )
    .criterion(Criterion::at_most(
        "iterations of the worst period",
        f64::from(worst),
        ITERATIONS,
        "",
    ));
    for (joint, passes) in JOINTS.into_iter().zip(passes) {
        claim = claim.criterion(Criterion::at_least(
            format!(
                "passes of nonlinear regression over the data of {joint}, where sparse regression makes one"
            ),
            passes as f64,
            2.0,
            "",
        ));
    }
    claim
        .flipped_by(
            "a solver that takes more than 15 iterations, which no faster motion makes; joints without friction, of which one pass tells all",
        )
        .remark("Decided by counts, which are the same on every machine; the times beside them are not, and decide nothing.")
        .shown_in("time-iterations")
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let reference = arm::reference()?;
    let plant = arm([Friction::B, Friction::C]);
    let duration = study.pick(60.0, 30.0);
    let model = arm(identify(plant, plant, duration)?);
    let samples = record(plant, plant, duration)?;
    let fast = Faster { motion: &reference, factor: limits::FACTOR };
    let usual = limits::options(&model);
    let runs = [
        measured("LTV-MPC, as published", Ltv::new(model, &reference, usual.clone())?, &reference)?,
        measured("LTV-MPC, 1.5 times as fast", Ltv::new(model, fast, usual.clone())?, &fast)?,
        measured("NMPC, as published", Nonlinear::new(model, &reference, usual.clone())?, &reference)?,
        measured("NMPC, 1.5 times as fast", Nonlinear::new(model, fast, usual)?, &fast)?,
    ];
    let passes = [passes(&samples, 0)?, passes(&samples, 1)?];
    let claim = claim(worst_iterations(model, &reference, limits::FACTOR)?, passes);
    let section = Section::new("time", "11 · Time")
        .block(text(&format!("A step: observer, {HORIZON} linearizations and discretizations, QP. The QP follows the active set of the period before; if that fails, an interior-point method solves it. If no bound is active, it takes 0 iterations. Along the trajectory as published no bound is.")))
        .block(Block::Figure(iterations(&runs[1].run)))
        .block(Block::Table(step_table(&runs)))
        .block(Block::Table(regression_table(&samples, study.pick(21, 5))?));
    Ok(Part { section, claims: vec![claim] })
}

fn iterations(run: &Run) -> Figure {
    Figure::new("time-iterations", "Iterations of the QP in each period, 1.5 times as fast as published.")
        .plot(Plot::new("", show::time(), Axis::new("iterations", "")).series(
            "LTV-MPC",
            Marks::Points,
            run.points(|row| f64::from(row.iterations)),
        ))
}

fn step_table(runs: &[Measured]) -> Table {
    let mut table = Table::new(
        "measured-step-times",
        &format!("A step of 20 ms, {HORIZON} stages. Iterations are the same everywhere; CPU times are this machine's, and differ from run to run."),
    )
    .column("controller and motion", "controller", "")
    .column("periods at a bound", "bounded periods", "")
    .column("iterations there, median", "median iterations", "")
    .column("worst", "most iterations", "")
    .column("CPU time, median", "measured median time", "µs")
    .column("at a bound, median", "measured median time at a bound", "µs");
    for one in runs {
        let counts: Vec<f64> = one.run.rows.iter().map(|row| f64::from(row.iterations)).collect();
        let bounded: Vec<f64> = counts.iter().copied().filter(|n| *n > 0.0).collect();
        let pairs = counts.iter().zip(&one.times);
        let slow: Vec<f64> = pairs.filter(|(n, _)| **n > 0.0).map(|(_, time)| *time).collect();
        let or_empty = |values: Vec<f64>, digits: usize| {
            if values.is_empty() { Cell::Empty } else { Cell::Rounded(median(values), digits) }
        };
        table = table.row([
            Cell::text(one.name),
            Cell::Count(bounded.len()),
            or_empty(bounded, 2),
            Cell::Count(one.run.most_iterations() as usize),
            Cell::Rounded(median(one.times.clone()), 2),
            or_empty(slow, 2),
        ]);
    }
    table
}

/// Median CPU time of a few calls (µs).
fn time_of(calls: usize, mut work: impl FnMut() -> Outcome<()>) -> Outcome<f64> {
    let mut times = Vec::with_capacity(calls);
    for _ in 0..calls {
        let start = cpu_time();
        work()?;
        times.push(cpu_time() - start);
    }
    Ok(median(times))
}

fn regression_table(samples: &FrictionSamples, calls: usize) -> Outcome<Table> {
    let mut table = Table::new(
        "measured-regression-times",
        &format!("Friction of one joint from its log, library and all. LASSO: {LAMBDAS} values of λ, {FOLDS} folds, refit. CPU times are this machine's, and differ from run to run."),
    )
    .column("joint", "joint", "")
    .column("samples", "samples", "")
    .column("STLS", "measured STLS", "µs")
    .column("LASSO", "measured LASSO", "µs")
    .column("nonlinear regression", "measured regression", "µs")
    .column("over STLS", "measured regression over STLS", "")
    .column("over LASSO", "measured regression over LASSO", "");
    for (joint, name) in JOINTS.into_iter().enumerate() {
        let (v, torque) = (&samples.velocities[joint], &samples.torques[joint]);
        let library = Friction::library()?;
        let sparse = time_of(calls, || {
            let samples = Samples::from_library(&library, vec![v], vec![torque])?;
            Thresholding::default().fit(&Reduced::new(&samples)?, 0)?;
            Ok(())
        })?;
        let lasso = time_of(calls, || {
            let samples = Samples::from_library(&library, vec![v], vec![torque])?;
            let folds = Moments::blocks(&samples, FOLDS)?;
            let all = Moments::sum(&folds)?;
            let lasso = Lasso::default();
            let lambdas = lasso.lambda_grid(&all, 0, LAMBDAS, 1e-3)?;
            let validated = CrossValidation::new(&lasso, &folds, 0, &lambdas)?;
            let reduced = Reduced::from_moments(all)?;
            refit(&reduced, 0, &validated.path, validated.one_standard_error)?;
            Ok(())
        })?;
        let regression = time_of(calls, || {
            StribeckRegression::default().fit(v, torque)?;
            Ok(())
        })?;
        table = table.row([
            Cell::text(name),
            Cell::Count(v.len()),
            Cell::Rounded(sparse, 2),
            Cell::Rounded(lasso, 2),
            Cell::Rounded(regression, 2),
            Cell::Rounded(regression / sparse, 2),
            Cell::Rounded(regression / lasso, 2),
        ]);
    }
    Ok(table)
}
