//! Friction of a real arm: the measured runs of a Schunk LWA 4P (S. Liu, M. Althoff, 2018), with
//! `models/schunk_lwa4p.toml`.
//!
//! The recorded torques exclude gravity and Coulomb friction, which the robot compensated itself; so the arm
//! here has no gravity. The runs of one group replay one input; the last run of each group is never used for
//! fitting, and once more whole groups are left out.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "test code: what cannot be set up ends the test")]

use crate::support::data::shared;
use gelenk_identification::Result;
use gelenk_identification::differentiation::SavitzkyGolay;
use gelenk_identification::friction::{FrictionData, FrictionIdentification, FrictionMethod};
use gelenk_identification::log::{Differentiation, Log, LogSchema};
use gelenk_identification::result::FrictionLaw;
use gelenk_identification::torque::friction_torques;
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
const POSITIONS: [&str; 6] = ["q1", "q2", "q3", "q4", "q5", "q6"];
const TORQUES: [&str; 6] = ["u1", "u2", "u3", "u4", "u5", "u6"];
/// Samples dropped at both ends of a run; the torque of a run's last row is not recorded.
const MARGIN: usize = 10;

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

/// The log with differentiated positions.
fn runs() -> Option<&'static Log> {
    static LOG: OnceLock<Option<Log>> = OnceLock::new();
    LOG.get_or_init(read).as_ref()
}

fn read() -> Option<Log> {
    let path = shared("data/schunk_lwa4p/runs.csv")?;
    let (mut log, _) = Log::open(&path, &LogSchema::default()).unwrap();
    // By hand: 0.2 s. What the encoders show faster than that is vibration of the gears, not motion of a
    // rigid arm; at the smoothing that the encoders' resolution alone asks for, R² of joints 3 and 5 falls to
    // 0.90 and 0.95.
    let method = SavitzkyGolay::with_window(51, 3);
    for position in POSITIONS {
        log.differentiate(position, &Differentiation::SavitzkyGolay(method)).unwrap();
    }
    Some(log)
}

/// Velocities and friction torques of all joints.
struct Friction {
    velocities: [Vec<f64>; 6],
    torques: [Vec<f64>; 6],
    /// Samples of each group.
    groups: Vec<Vec<Range<usize>>>,
}

fn friction_of(log: &Log, groups: &[Vec<u32>]) -> Friction {
    let (mut rows, mut ranges) = (Vec::new(), Vec::new());
    for group in groups {
        let chosen: Vec<String> = group.iter().map(|r| format!("run == {r}")).collect();
        let all = log.select(&chosen.join(" || ")).unwrap();
        let start = rows.len();
        rows.extend(log.inner_rows(&all, MARGIN).unwrap());
        ranges.push(start..rows.len());
    }
    let columns = log.motion(&POSITIONS, &TORQUES, &rows).unwrap();
    let arm = Recorded { friction: &|_, _| 0.0 };
    let torques = friction_torques(&arm, &columns.motion()).unwrap();
    Friction {
        velocities: columns.velocities,
        torques,
        groups: ranges.into_iter().map(|rows| vec![rows]).collect(),
    }
}

/// The fewest terms that explain groups left out as well as any, within one standard error.
///
/// Not forced to dissipate: what remains of a compensated Coulomb friction may drive the joint.
fn identify(log: &Log, groups: &[Vec<u32>]) -> Result<[FrictionLaw; 6]> {
    let friction = friction_of(log, groups);
    let settings = FrictionIdentification {
        method: FrictionMethod::BestSubset,
        draws: 0,
        passive: false,
        ..FrictionIdentification::new()?
    };
    let mut laws = Vec::new();
    for joint in 0..6 {
        let report = settings.identify(&FrictionData {
            joint: POSITIONS[joint],
            unit: "N·m",
            velocity_unit: "rad/s",
            velocities: &friction.velocities[joint],
            torques: &friction.torques[joint],
            folds: Some(&friction.groups),
            data: log.hash(),
            ..FrictionData::default()
        })?;
        println!("joint {}: {}", joint + 1, report.result.law.formula());
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
    let Some(log) = runs() else { return };
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
    let Some(log) = runs() else { return };
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
fn simulate(log: &Log, runs: &[Vec<u32>], friction: &dyn Fn(usize, f64) -> f64) -> [f64; 6] {
    const STEP: f64 = 0.004;
    let arm = Recorded { friction };
    let column = |name: String| log.channel(&name).unwrap();
    let positions: [&[f64]; 6] = std::array::from_fn(|j| column(format!("q{}", j + 1)));
    let speeds: [&[f64]; 6] = std::array::from_fn(|j| column(format!("q{}_velocity", j + 1)));
    let inputs: [&[f64]; 6] = std::array::from_fn(|j| column(format!("u{}", j + 1)));
    let (mut squares, mut count) = ([0.0; 6], 0.0);
    for run in runs.concat() {
        let rows = log.select(&format!("run == {run}")).unwrap();
        let mut y = positions.map(|c| c[rows[0]]);
        let mut v = speeds.map(|c| c[rows[0]]);
        for pair in rows.windows(2) {
            let u = inputs.map(|c| c[pair[0]]);
            (y, v) = runge_kutta(&arm, &y, &v, &u, STEP);
            for j in 0..6 {
                squares[j] += (y[j] - positions[j][pair[1]]).powi(2);
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
    let Some(log) = runs() else { return };
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
