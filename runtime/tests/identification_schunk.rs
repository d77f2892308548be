//! Friction of a real arm: the measured runs of a Schunk LWA 4P (S. Liu, M. Althoff, 2018), with
//! `models/schunk_lwa4p.toml`.
//!
//! The recorded torques exclude gravity and Coulomb friction, which the robot compensated itself; so the arm
//! here has no gravity. The runs of one group replay one input; the last run of each group is never used for
//! fitting, and once more whole groups are left out.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "test code: what cannot be set up ends the test")]

use crate::methods::torque::{Motion, friction_torques};
use crate::support::data::shared;
use crate::support::named_robot::NamedRobot;
use gelenk_identification::Result;
use gelenk_identification::friction::{FrictionData, FrictionIdentification, FrictionMethod};
use gelenk_identification::log::{ColumnOptions, runs};
use gelenk_identification::preparation::{PreparationSettings, prepare_all};
use gelenk_identification::result::FrictionLaw;
use gelenk_identification::run::{Effort, PreparedRun};
use gelenk_runtime::dynamics::{Dynamics, Limits};
use std::ops::Range;
use std::sync::OnceLock;

const GROUPS: [&[u32]; 6] = [
    &[1, 2, 3, 4, 5],
    &[21, 22, 23, 24, 25],
    &[41, 42, 43, 44, 45],
    &[61, 62, 63, 64, 65],
    &[80, 81, 82, 83, 84],
    &[94, 95, 96],
];
const JOINTS: [&str; 6] = ["joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6"];

gelenk_runtime::dynamics!(struct Arm = gelenk_generated::schunk_lwa4p);

/// The arm as it was recorded: without gravity, torques at the joints, friction by terms of the velocity.
struct Recorded<'a> {
    friction: &'a dyn Fn(usize, f64) -> f64,
}

impl Dynamics<6, 6> for Recorded<'_> {
    fn limits(&self) -> Limits<6, 6> {
        Arm.limits()
    }
    fn mass_matrix(&self, y: &[f64; 6]) -> [[f64; 6]; 6] {
        Arm.mass_matrix(y)
    }
    fn coriolis_forces(&self, y: &[f64; 6], v: &[f64; 6]) -> [f64; 6] {
        Arm.coriolis_forces(y, v)
    }
    fn gravity_forces(&self, _: &[f64; 6]) -> [f64; 6] {
        [0.0; 6]
    }
    fn spring_forces(&self, _: &[f64; 6], _: &[f64; 6]) -> [f64; 6] {
        [0.0; 6]
    }
    fn friction_torques(&self, _: &[f64; 6], v: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| (self.friction)(i, v[i]))
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[[0, 0], [1, 1], [2, 2], [3, 3], [4, 4], [5, 5]]
    }
    fn input_matrix(&self, _: &[f64; 6]) -> [[f64; 6]; 6] {
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
    }
}

/// A recorded run, its motion smoothed: positions, velocities and accelerations, and the torques as they were recorded.
struct Recorder {
    number: u32,
    columns: [[Vec<f64>; 6]; 4],
}

fn recorded() -> Option<&'static [Recorder]> {
    static RUNS: OnceLock<Option<Vec<Recorder>>> = OnceLock::new();
    RUNS.get_or_init(read).as_deref()
}

fn read() -> Option<Vec<Recorder>> {
    let path = shared("data/schunk_lwa4p/runs.csv")?;
    let robot = NamedRobot { names: JOINTS.map(str::to_owned).to_vec(), ..NamedRobot::default() };
    let columns = ColumnOptions { effort: Some(Effort::Joint), ..ColumnOptions::default() };
    let recording = runs(&[path], &robot, &columns).unwrap();
    // By hand: what the encoders show faster than that is vibration of the gears, not motion of a rigid arm.
    let settings = PreparationSettings {
        bandwidth: Some(7.0),
        rate: Some(250.0),
        cut: Some(0.04),
        delay: Some(0.0),
        ..PreparationSettings::default()
    };
    let (prepared, _) = prepare_all(&recording.runs, None, &settings).unwrap();
    let of_run = |run: PreparedRun| {
        let recorded = recording.runs.iter().find(|recorded| recorded.name == run.name).unwrap();
        let rows = run.rows.iter().map(|row| recorded.rows.binary_search(row).unwrap());
        let rows: Vec<usize> = rows.collect();
        let column = |column: &Vec<f64>| rows.iter().map(|i| column[*i]).collect();
        let raw = |columns: &[Vec<f64>]| six(columns.iter().map(column).collect());
        Recorder {
            number: run.name.rsplit(' ').next().unwrap().parse().unwrap(),
            columns: [
                raw(&recorded.positions),
                six(run.velocities),
                six(run.accelerations),
                raw(&recorded.efforts),
            ],
        }
    };
    Some(prepared.into_iter().map(of_run).collect())
}

fn six(columns: Vec<Vec<f64>>) -> [Vec<f64>; 6] {
    columns.try_into().unwrap()
}

/// Velocities and friction torques of all joints.
struct Friction {
    velocities: [Vec<f64>; 6],
    torques: [Vec<f64>; 6],
    /// Samples of each group.
    groups: Vec<Vec<Range<usize>>>,
}

fn friction_of(runs: &[Recorder], groups: &[Vec<u32>]) -> Friction {
    let mut all: [[Vec<f64>; 6]; 4] = Default::default();
    let mut ranges = Vec::new();
    for group in groups {
        let start = all[0][0].len();
        for run in runs.iter().filter(|run| group.contains(&run.number)) {
            for (all, of_run) in all.iter_mut().flatten().zip(run.columns.iter().flatten()) {
                all.extend(of_run);
            }
        }
        ranges.push(start..all[0][0].len());
    }
    let arm = Recorded { friction: &|_, _| 0.0 };
    let [positions, velocities, accelerations, inputs] =
        all.each_ref().map(|columns| columns.each_ref().map(Vec::as_slice));
    let torques = friction_torques(&arm, &Motion { positions, velocities, accelerations, inputs }).unwrap();
    let [_, velocities, ..] = all;
    Friction { velocities, torques, groups: ranges.into_iter().map(|rows| vec![rows]).collect() }
}

/// The fewest terms that explain groups left out as well as any, within one standard error.
///
/// Not forced to dissipate: what remains of a compensated Coulomb friction may drive the joint.
fn identify(runs: &[Recorder], groups: &[Vec<u32>]) -> Result<[FrictionLaw; 6]> {
    let friction = friction_of(runs, groups);
    let settings = FrictionIdentification {
        method: FrictionMethod::BestSubset,
        passive: false,
        ..FrictionIdentification::new()?
    };
    let mut laws = Vec::new();
    for joint in 0..6 {
        let mut data = FrictionData::of(JOINTS[joint], &friction.velocities[joint], &friction.torques[joint]);
        data.folds = Some(&friction.groups);
        let report = settings.identify(&data)?;
        println!("joint {}: {}", joint + 1, report.result.formula());
        laws.push(report.result.law);
    }
    Ok(laws.try_into().expect("six laws"))
}

fn r_squared(law: &FrictionLaw, velocities: &[f64], torques: &[f64]) -> f64 {
    let model = law.torques(velocities).unwrap();
    let rss: f64 = torques.iter().zip(&model).map(|(t, m)| (t - m).powi(2)).sum();
    1.0 - rss / torques.iter().map(|t| t * t).sum::<f64>()
}

/// The groups without their last runs, and those runs.
fn split() -> (Vec<Vec<u32>>, Vec<Vec<u32>>) {
    let parts = GROUPS.iter().map(|group| group.split_at(group.len() - 1));
    parts.map(|(fitted, unseen)| (fitted.to_vec(), unseen.to_vec())).unzip()
}

#[test]
fn two_joints_are_viscous_alone_and_unseen_runs_are_explained() {
    let Some(log) = recorded() else { return };
    let (fitted, unseen) = split();
    let laws = identify(log, &fitted).unwrap();
    for (joint, expected) in [(4, 3.60), (5, 4.05)] {
        let FrictionLaw::Terms(terms) = &laws[joint] else {
            panic!("no terms");
        };
        assert_eq!((terms.len(), terms[0].basis.as_str()), (1, "v"));
        assert!((terms[0].coefficient / expected - 1.0).abs() < 0.05);
    }
    let Friction { velocities, torques, .. } = friction_of(log, &unseen);
    let r: Vec<f64> = (0..6).map(|j| r_squared(&laws[j], &velocities[j], &torques[j])).collect();
    println!("R² on unseen runs: {r:.4?}");
    assert!(r[0] >= 0.93 && r[2] >= 0.93, "{r:?}");
    assert!(r[4] >= 0.97 && r[5] >= 0.97, "{r:?}");
}

#[test]
fn whole_groups_left_out() {
    let Some(log) = recorded() else { return };
    let (mut rss, mut energy) = ([0.0; 6], [0.0; 6]);
    for left_out in GROUPS {
        let others: Vec<Vec<u32>> =
            GROUPS.iter().filter(|group| **group != left_out).map(|group| group.to_vec()).collect();
        let laws = identify(log, &others).unwrap();
        let Friction { velocities, torques, .. } = friction_of(log, &[left_out.to_vec()]);
        for j in 0..6 {
            let sum: f64 = torques[j].iter().map(|t| t * t).sum();
            energy[j] += sum;
            rss[j] += (1.0 - r_squared(&laws[j], &velocities[j], &torques[j])) * sum;
        }
    }
    let r: Vec<f64> = (0..6).map(|j| 1.0 - rss[j] / energy[j]).collect();
    println!("R² with whole groups left out: {r:.4?}");
    assert!(r[0] > 0.9 && r[2] > 0.9 && r[4] > 0.95 && r[5] > 0.95, "{r:?}");
}

/// Rms position errors of an open-loop simulation of some runs with the recorded torques.
fn simulate(all: &[Recorder], runs: &[Vec<u32>], friction: &dyn Fn(usize, f64) -> f64) -> [f64; 6] {
    const STEP: f64 = 0.004;
    let arm = Recorded { friction };
    let (mut squares, mut count) = ([0.0; 6], 0.0);
    for run in all.iter().filter(|run| runs.iter().flatten().any(|number| *number == run.number)) {
        let at = |of: usize, i: usize| run.columns[of].each_ref().map(|column| column[i]);
        let (mut y, mut v) = (at(0, 0), at(1, 0));
        for i in 1..run.columns[0][0].len() {
            (y, v) = runge_kutta(&arm, &y, &v, &at(3, i - 1), STEP);
            let measured = at(0, i);
            for j in 0..6 {
                squares[j] += (y[j] - measured[j]).powi(2);
            }
            count += 1.0;
        }
    }
    squares.map(|s: f64| (s / count).sqrt())
}

fn runge_kutta(arm: &Recorded, y: &[f64; 6], v: &[f64; 6], u: &[f64; 6], h: f64) -> ([f64; 6], [f64; 6]) {
    let ahead = |x: &[f64; 6], d: &[f64; 6], h: f64| -> [f64; 6] { std::array::from_fn(|i| x[i] + h * d[i]) };
    let a1 = arm.forward_dynamics(y, v, u);
    let v2 = ahead(v, &a1, 0.5 * h);
    let a2 = arm.forward_dynamics(&ahead(y, v, 0.5 * h), &v2, u);
    let v3 = ahead(v, &a2, 0.5 * h);
    let a3 = arm.forward_dynamics(&ahead(y, &v2, 0.5 * h), &v3, u);
    let v4 = ahead(v, &a3, h);
    let a4 = arm.forward_dynamics(&ahead(y, &v3, h), &v4, u);
    let mean = |a: &[f64; 6], b: &[f64; 6], c: &[f64; 6], d: &[f64; 6]| -> [f64; 6] {
        std::array::from_fn(|i| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0)
    };
    (ahead(y, &mean(v, &v2, &v3, &v4), h), ahead(v, &mean(&a1, &a2, &a3, &a4), h))
}

#[test]
fn simulated_positions_of_unseen_runs_are_twice_as_good_as_with_the_published_friction() {
    let Some(log) = recorded() else { return };
    let (fitted, unseen) = split();
    let laws = identify(log, &fitted).unwrap();
    // The laws as tables: a simulation asks for them often.
    let grid: Vec<f64> = (-4000..=4000).map(|i| 1e-3 * f64::from(i)).collect();
    let tables = laws.each_ref().map(|law| law.torques(&grid).unwrap());
    let identified = |joint: usize, v: f64| {
        let position = ((v + 4.0) * 1e3).clamp(0.0, 7999.0);
        let (i, share) = (position.floor() as usize, position.fract());
        tables[joint][i] * (1.0 - share) + tables[joint][i + 1] * share
    };
    // Printed too: what the published viscous friction does alone, as the robot compensated its Coulomb
    // friction.
    let published = |joint: usize, v: f64| [15.68, 13.91, 17.89, 13.63, 4.45, 4.67][joint] * v;
    let own = |joint: usize, v: f64| {
        let mut all = [0.0; 6];
        all[joint] = v;
        Arm.friction_torques(&[0.0; 6], &all)[joint]
    };
    let errors = simulate(log, &unseen, &identified);
    let viscous = simulate(log, &unseen, &published);
    let with_coulomb = simulate(log, &unseen, &own);
    println!("rms position errors [rad]: identified {errors:.4?}");
    println!("published viscous {viscous:.4?}, with Coulomb {with_coulomb:.4?}");
    for j in 0..3 {
        assert!(errors[j] <= 0.5 * with_coulomb[j], "joint {}", j + 1);
    }
}
