//! Preparation of the measured logs of the shared data.

use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun, Run};
use super::super::{PreparationReport, PreparationSettings, prepare_all};
use super::arm::Arm;
use super::fit::{fit, r_squared};
use std::path::PathBuf;

fn shared(path: &str) -> Option<String> {
    let folder = std::env::var_os("GELENK_SHARED").map(PathBuf::from);
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let file = folder.unwrap_or(beside).join(path);
    let text = std::fs::read_to_string(&file).ok();
    if text.is_none() {
        println!("skipped: {} is not there; set GELENK_SHARED", file.display());
    }
    text
}

/// Returns the rows of numbers, each with its row in the log.
fn table(text: &str) -> Vec<(usize, Vec<f64>)> {
    let numbers = |line: &str| line.split(',').map(|x| x.trim().parse().unwrap_or(f64::NAN)).collect();
    text.lines().enumerate().skip(1).map(|(i, line)| (i + 1, numbers(line))).collect()
}

fn run(name: String, rows: &[(usize, Vec<f64>)], first: usize) -> Run {
    let column = |k: usize| rows.iter().map(|(_, r)| r[k]).collect::<Vec<f64>>();
    Run {
        poses: Vec::new(),
        name,
        times: column(first),
        rows: rows.iter().map(|(i, _)| *i).collect(),
        positions: (0..6).map(|j| column(first + 1 + j)).collect(),
        velocities: (0..6).map(|j| Some(column(first + 7 + j))).collect(),
        efforts: (0..6).map(|j| column(first + 13 + j)).collect(),
        effort: Effort::Joint,
    }
}

pub(crate) fn ur10() -> Option<Run> {
    Some(run("exciting".into(), &table(&shared("data/ur10/exciting.csv")?), 0))
}

pub(crate) fn schunk() -> Option<Vec<Run>> {
    let all = table(&shared("data/schunk_lwa4p/runs.csv")?);
    let runs = all.chunk_by(|a, b| a.1[0] == b.1[0]);
    Some(runs.map(|rows| run(format!("run {}", rows[0].1[0]), rows, 1)).collect())
}

/// The LWA 4P without gravity, which its controller has removed from the torques.
pub(crate) struct Schunk;

impl Robot for Schunk {
    fn joint_names(&self) -> Vec<String> {
        (1..=6).map(|i| format!("q{i}")).collect()
    }
    fn input_names(&self) -> Vec<String> {
        self.joint_names()
    }
    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; 6]
    }
    fn limits(&self) -> Vec<super::super::super::robot::JointLimits> {
        Arm::ur10().limits()
    }
    fn parameter_names(&self) -> Vec<String> {
        (0..66).map(|k| format!("p{k}")).collect()
    }
    fn parameters(&self) -> Vec<f64> {
        gelenk_generated::schunk_lwa4p::inertial_parameters().to_vec()
    }
    fn bodies(&self) -> usize {
        6
    }
    fn input_matrix(&self) -> Vec<f64> {
        Arm::ur10().input_matrix()
    }
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        use gelenk_generated::schunk_lwa4p::inertial_regressor;
        let six = |x: &[f64]| -> [f64; 6] { std::array::from_fn(|i| x[i]) };
        let (moving, still) = (
            inertial_regressor(&six(y), &six(v), &six(a)),
            inertial_regressor(&six(y), &[0.0; 6], &[0.0; 6]),
        );
        for (k, w) in regressor.iter_mut().enumerate() {
            *w = moving[k / 66][k % 66] - still[k / 66][k % 66];
        }
    }
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        let mut w = vec![0.0; 6 * 66];
        self.inertial_regressor(y, v, a, &mut w);
        for (force, row) in forces.iter_mut().zip(w.chunks(66)) {
            *force = row.iter().zip(self.parameters()).map(|(w, p)| w * p).sum();
        }
    }
}

fn print(report: &PreparationReport) {
    println!("{:.3} Hz at {:.1} samples/s", report.filter.bandwidth(), report.sample_rate);
    for j in &report.joints {
        println!(
            "{}: σ {:.2e} resolution {:.1e} noise of ÿ {:.4} {:?}",
            j.name, j.noise, j.resolution, j.acceleration_noise, j.fault
        );
    }
    for d in &report.delays {
        println!("delay {:.2} ± {:.2} ms {}", 1e3 * d.removed, 1e3 * d.error, d.own);
    }
    println!("{:?}", report.findings);
}

/// Returns R² on the second half for a fit to the first half.
fn halves(robot: &dyn Robot, runs: &[PreparedRun]) -> Vec<f64> {
    let end = |r: &PreparedRun| *r.times.last().unwrap();
    let middle = 0.5 * runs.iter().map(end).fold(0.0, f64::max);
    let part = |keep: &dyn Fn(f64) -> bool| -> Vec<PreparedRun> {
        let of = |r: &PreparedRun| {
            let kept: Vec<usize> = (0..r.times.len()).filter(|i| keep(r.times[*i])).collect();
            let cut = |c: &Vec<Vec<f64>>| c.iter().map(|x| kept.iter().map(|i| x[*i]).collect()).collect();
            PreparedRun {
                poses: Vec::new(),
                resting: r.resting.iter().map(|rests| kept.iter().map(|i| rests[*i]).collect()).collect(),
                times: kept.iter().map(|i| r.times[*i]).collect(),
                rows: kept.iter().map(|i| r.rows[*i]).collect(),
                positions: cut(&r.positions),
                velocities: cut(&r.velocities),
                accelerations: cut(&r.accelerations),
                efforts: cut(&r.efforts),
                ..r.clone()
            }
        };
        runs.iter().map(of).filter(|r| !r.times.is_empty()).collect()
    };
    let parameters = fit(robot, &part(&|t| t < middle));
    r_squared(robot, &parameters, &part(&|t| t >= middle))
}

/// Fits the even runs and tests on the odd runs. The runs of one group repeat the same input.
fn every_second(robot: &dyn Robot, runs: Vec<PreparedRun>) -> Vec<f64> {
    let (mut fitted, mut unseen) = (Vec::new(), Vec::new());
    for (k, run) in runs.into_iter().enumerate() {
        if k % 2 == 0 { fitted.push(run) } else { unseen.push(run) }
    }
    r_squared(robot, &fit(robot, &fitted), &unseen)
}

/// Requires that every joint reaches `bounds`.
fn require(r_squared: &[f64], bounds: [f64; 6]) {
    println!("R² {r_squared:.4?}");
    assert!(r_squared.iter().zip(bounds).all(|(r, b)| *r >= b), "{r_squared:.4?} {bounds:?}");
}

/// `cargo test --release -p gelenk-identification --lib preparation::study -- --ignored --nocapture`
#[test]
#[ignore = "takes a minute without optimization"]
fn the_ur10_reaches_plain_least_squares_in_python() {
    let Some(run) = ur10() else { return };
    let arm = Arm::ur10();
    let settings = PreparationSettings::default();
    let (runs, report) = prepare_all(std::slice::from_ref(&run), Some(&arm), &settings).unwrap();
    print(&report);
    // The README of the data has .9745 .9985 .9971 .9836 .9876 .9049; the tolerance is 0.01.
    require(&halves(&arm, &runs), [0.9645, 0.9885, 0.9871, 0.9736, 0.9776, 0.8949]);
}

#[test]
#[ignore = "takes a minute without optimization"]
fn the_schunk_arm_is_explained_on_runs_that_were_not_used() {
    let Some(runs) = schunk() else { return };
    let (runs, report) = prepare_all(&runs, Some(&Schunk), &PreparationSettings::default()).unwrap();
    print(&report);
    require(&every_second(&Schunk, runs), [0.95, 0.92, 0.97, 0.90, 0.99, 0.99]);
}

/// The model lacks the load-dependent friction of the second joint, which imitates a delay of 67 ms in the first 12 s.
#[test]
fn an_effort_has_no_delay_of_its_own_that_helps_nothing() {
    let Some(mut run) = ur10() else { return };
    let cut = |column: &mut Vec<f64>| column.truncate(1500);
    cut(&mut run.times);
    run.rows.truncate(1500);
    run.positions.iter_mut().chain(&mut run.efforts).chain(run.velocities.iter_mut().flatten()).for_each(cut);
    let (_, report) = prepare_all(&[run], Some(&Arm::ur10()), &PreparationSettings::default()).unwrap();
    print(&report);
    let delays: Vec<f64> = report.delays.iter().map(|delay| delay.removed).collect();
    assert!(delays.iter().all(|d| (0.01..0.03).contains(d) && (d - delays[0]).abs() < 3e-3), "{delays:?}");
}
