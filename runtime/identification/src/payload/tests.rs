//! Simulated logs of a UR5 with and without a load.

use super::*;
use crate::inertial::bodies::body;
use crate::inertial::pseudo_inertia;
use crate::numeric::levels::varied::{Outcomes, page};
use crate::numeric::random::SplitMix64;
use crate::robot::JointLimits;
use crate::run::Effort;
use gelenk_findings::{Severity, texts};
use gelenk_generated::ur5;
use std::slice;
use std::sync::OnceLock;

const N: usize = ur5::N;
const P: usize = 60;
/// Gear ratio of the inputs, for logs of inputs and currents.
const RATIO: f64 = 101.0;

/// The described robot, and whether its inputs are currents.
struct Described {
    currents: bool,
}

const UR5: Described = Described { currents: false };

impl Robot for Described {
    fn joint_names(&self) -> Vec<String> {
        ur5::JOINT_NAMES.map(String::from).to_vec()
    }
    fn input_names(&self) -> Vec<String> {
        self.joint_names()
    }
    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; N]
    }
    fn limits(&self) -> Vec<JointLimits> {
        vec![JointLimits { position: [-6.3, 6.3], velocity: 3.0, effort: 150.0 }; N]
    }
    fn parameter_names(&self) -> Vec<String> {
        ur5::INERTIAL_PARAMETER_NAMES.map(String::from).to_vec()
    }
    fn parameters(&self) -> Vec<f64> {
        ur5::inertial_parameters().to_vec()
    }
    fn bodies(&self) -> usize {
        N
    }
    fn described_currents(&self) -> Vec<bool> {
        vec![self.currents; N]
    }
    fn input_matrix(&self) -> Vec<f64> {
        (0..N * N).map(|k| if k % (N + 1) == 0 { RATIO } else { 0.0 }).collect()
    }
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        let [y, v, a] = [y, v, a].map(|x| std::array::from_fn(|j| x[j]));
        regressor.copy_from_slice(ur5::inertial_regressor(&y, &v, &a).as_flattened());
    }
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        forces.copy_from_slice(&product(y, v, a, &self.parameters()));
    }
}

fn product(y: &[f64], v: &[f64], a: &[f64], pi: &[f64]) -> Vec<f64> {
    let mut w = vec![0.0; N * P];
    UR5.inertial_regressor(y, v, a, &mut w);
    w.chunks_exact(P).map(|row| row.iter().zip(pi).map(|(w, p)| w * p).sum()).collect()
}

/// Motion and measurements of a simulated log.
struct Simulation {
    samples: usize,
    /// Joints that move.
    moving: usize,
    noise: f64,
    seed: u64,
}

impl Simulation {
    /// Stribeck friction with an offset; noise that is correlated over 0.05 s; a robot that differs from its
    /// description.
    fn run(&self, load: &[f64; PER_BODY]) -> PreparedRun {
        let mut pi = UR5.parameters();
        pi.iter_mut().for_each(|x| *x *= 1.08);
        pi[P - PER_BODY..].iter_mut().zip(load).for_each(|(x, l)| *x += l);
        let mut random = SplitMix64::new(self.seed);
        let step = 0.01;
        let empty = || vec![Vec::new(); N];
        let [mut y, mut v, mut a, mut efforts] = [empty(), empty(), empty(), empty()];
        let mut error = [0.0; N];
        for i in 0..self.samples {
            let now: [[f64; 3]; N] = std::array::from_fn(|j| {
                if j < self.moving { motion(j, step * i as f64) } else { [0.3, 0.0, 0.0] }
            });
            let at = |k: usize| now.map(|x| x[k]);
            let forces = product(&at(0), &at(1), &at(2), &pi);
            for j in 0..N {
                let speed = now[j][1];
                let friction = 5.0 * (speed / 0.02).tanh() * (1.0 + 0.4 * (-(speed / 0.1).powi(2)).exp())
                    + 8.0 * speed
                    + 0.7;
                error[j] = 0.8 * error[j] + 0.6 * self.noise * random.normal();
                efforts[j].push(forces[j] + friction + error[j]);
            }
            for (columns, k) in [(&mut y, 0), (&mut v, 1), (&mut a, 2)] {
                columns.iter_mut().zip(&now).for_each(|(c, x)| c.push(x[k]));
            }
        }
        PreparedRun {
            poses: Vec::new(),
            resting: Vec::new(),
            name: "simulated".into(),
            times: (0..self.samples).map(|i| step * i as f64).collect(),
            rows: (0..self.samples).collect(),
            positions: y,
            velocities: v,
            accelerations: a,
            efforts,
            effort: Effort::Joint,
        }
    }
}

/// Two sines for each joint.
fn motion(joint: usize, t: f64) -> [f64; 3] {
    let (w1, w2) = (0.7 + 0.13 * joint as f64, 1.9 - 0.17 * joint as f64);
    let (a1, a2) = (0.9, 0.5);
    let offset = [0.0, -1.2, 1.0, 0.2, 0.5, 0.0][joint];
    [
        offset + a1 * (w1 * t).sin() + a2 * (w2 * t).cos(),
        a1 * w1 * (w1 * t).cos() - a2 * w2 * (w2 * t).sin(),
        -a1 * w1 * w1 * (w1 * t).sin() - a2 * w2 * w2 * (w2 * t).cos(),
    ]
}

fn of(mass: f64, size: f64, centre: [f64; 3]) -> [f64; PER_BODY] {
    let mut j = pseudo_inertia(&body(&mut SplitMix64::new(1), mass, size));
    // The same body, its centre of mass elsewhere.
    let old: [f64; 3] = std::array::from_fn(|k| j[(k, 3)] / j[(3, 3)]);
    let factor = mass / j[(3, 3)];
    let mut moved = Matrix4::identity();
    for k in 0..3 {
        moved[(k, 3)] = centre[k] - old[k];
    }
    j = moved * j * moved.transpose() * factor;
    from_pseudo_inertia(&j)
}

const NOTHING: [f64; PER_BODY] = [0.0; PER_BODY];
const LOG: Simulation = Simulation { samples: 600, moving: N, noise: 0.3, seed: 1 };

/// The log of a motion without load.
fn without() -> &'static PreparedRun {
    static RUN: OnceLock<PreparedRun> = OnceLock::new();
    RUN.get_or_init(|| LOG.run(&NOTHING))
}

fn inside(e: &crate::estimation::Uncertain, truth: f64) -> bool {
    e.interval[0] <= truth && truth <= e.interval[1]
}

#[test]
fn a_load_is_found_whatever_the_efforts_are() {
    let truth = of(2.5, 0.15, [0.02, -0.03, 0.09]);
    let with = Simulation { seed: 2, samples: 500, ..LOG }.run(&truth);
    let settings = PayloadSettings::default();
    let found = estimate(&UR5, slice::from_ref(without()), slice::from_ref(&with), &settings).unwrap();
    assert_eq!(found.body, 5);
    assert!((found.mass.value - 2.5).abs() < 0.05, "{:?}", found.mass);
    for (e, truth) in found.centre_of_mass.iter().zip([0.02, -0.03, 0.09]) {
        assert!((e.value - truth).abs() < 0.005, "{e:?}");
    }
    let held = found.parameters.iter().zip(truth).filter(|(e, truth)| inside(e, *truth)).count();
    assert!(held >= 8, "{held} {:?} {truth:?}", found.parameters);
    assert!(found.shown[..4].iter().all(|shown| *shown) && found.explained[1].unwrap() > 0.9, "{found:?}");
    assert!(found.residuals.iter().flatten().all(|r| (r - 0.3).abs() < 0.12), "{:?}", found.residuals);
    // The same logs as currents of motors with gears.
    let runs = [without(), &with].map(|run| {
        let mut run = PreparedRun { effort: Effort::Current, ..run.clone() };
        run.efforts.iter_mut().flatten().for_each(|x| *x /= RATIO);
        run
    });
    let described = Described { currents: true };
    let again = estimate(&described, &runs[..1], &runs[1..], &settings).unwrap();
    assert!((again.mass.value - found.mass.value).abs() < 1e-6);
    // Without motor constants, and against a log of another kind.
    assert!(
        estimate(&UR5, &runs[..1], &runs[1..], &settings)
            .unwrap_err()
            .to_string()
            .starts_with("motor constants (`motor_constant`")
    );
    let other =
        estimate(&described, slice::from_ref(without()), &runs[1..], &settings).unwrap_err().to_string();
    assert!(
        other.contains("its efforts are currents, but those of the first run are forces at the joints"),
        "{other}"
    );
}

/// A brake holds the last joint, and the recorded velocity of this joint is noise.
#[test]
fn the_effort_of_a_joint_at_rest_is_not_used() {
    let truth = of(2.5, 0.15, [0.02, -0.03, 0.09]);
    let braked = |seed: u64, load: &[f64; PER_BODY]| {
        let mut run = Simulation { seed, moving: N - 1, ..LOG }.run(load);
        let mut random = SplitMix64::new(seed);
        run.velocities[N - 1].iter_mut().for_each(|v| *v = 2e-2 * random.normal());
        run.efforts[N - 1].iter_mut().for_each(|effort| *effort = 0.05 * random.normal());
        run.resting = (0..N).map(|joint| vec![joint == N - 1; run.times.len()]).collect();
        run
    };
    let [without, with] = [braked(1, &NOTHING), braked(2, &truth)];
    let settings = PayloadSettings::default();
    let found = estimate(&UR5, slice::from_ref(&without), slice::from_ref(&with), &settings).unwrap();
    let said = texts(&found.findings, Severity::Warning);
    assert!(said.iter().any(|text| text.contains("[load-efforts-not-used]: wrist_3_joint")), "{said:?}");
    let held = found.parameters.iter().zip(truth).filter(|(e, truth)| inside(e, *truth)).count();
    assert!(held >= 8, "{held} {:?} {truth:?}", found.parameters);
}

#[test]
fn what_the_motion_does_not_show_is_said() {
    // No load at all.
    let with = Simulation { seed: 3, ..LOG }.run(&NOTHING);
    let settings = PayloadSettings::default();
    let found = estimate(&UR5, slice::from_ref(without()), slice::from_ref(&with), &settings).unwrap();
    assert!(
        found.mass.value < 0.05
            && texts(&found.findings, Severity::Warning).iter().any(|w| w.contains("[no-load]")),
        "{found:?}"
    );
    // Only the vertical axis moves. The other joints hold the load, and dry friction may carry any part of it. So the motion
    // determines one moment of inertia, but not the mass.
    let alone = Simulation { moving: 1, ..LOG };
    let load = of(2.5, 0.15, [0.02, -0.03, 0.09]);
    let with = Simulation { seed: 4, ..alone }.run(&load);
    let found = estimate(&UR5, &[alone.run(&NOTHING)], &[with], &settings).unwrap();
    assert!(!found.shown[0] && found.residuals[1].is_none() && found.residuals[0].is_some(), "{found:?}");
    let said = |start: &str| texts(&found.findings, Severity::Warning).iter().any(|w| w.contains(start));
    assert!(
        said("[load-hidden]: the motion does not determine m, "),
        "{:?}",
        texts(&found.findings, Severity::Warning)
    );
    assert!(
        said("[load-efforts-not-used]: shoulder_lift_joint, elbow_joint, "),
        "{:?}",
        texts(&found.findings, Severity::Warning)
    );
}

#[test]
fn bad_logs_have_messages() {
    let run = PreparedRun { times: vec![0.0], ..without().clone() };
    let good = slice::from_ref(without());
    let message = |without: &[PreparedRun], with: &[PreparedRun], settings: PayloadSettings| {
        estimate(&UR5, without, with, &settings).unwrap_err().to_string()
    };
    let default = PayloadSettings::default;
    assert!(message(&[], good, default()).starts_with("the list of runs without the load is empty"));
    assert!(
        message(good, &[run], default()).starts_with("samples of positions of simulated: 1 are expected")
    );
    assert!(
        message(good, good, PayloadSettings { body: Some(6), ..default() })
            .starts_with("body of the load = 6")
    );
    assert!(
        message(good, good, PayloadSettings { confidence: 1.0, ..default() }).contains("between 0 and 1")
    );
    assert!(message(good, good, PayloadSettings { weight: 0.0, ..default() }).contains("must be positive"));
    let mut broken = without().clone();
    broken.efforts[2][7] = f64::NAN;
    assert!(
        message(good, &[broken], default()).starts_with("efforts of simulated is not finite (NaN) at row 7")
    );
}

/// Study, about a minute: `cargo test --release -p gelenk-identification --lib payload -- --ignored --nocapture`.
#[test]
#[ignore = "a hundred simulated pairs of logs"]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let mut counts = [0; PER_BODY];
    const PAIRS: u64 = 100;
    for seed in 0..PAIRS {
        let truth = of(0.5 + 0.04 * seed as f64, 0.05 + 0.002 * seed as f64, [0.02, -0.03, 0.09]);
        let log = Simulation { samples: 2000, seed: 1000 + seed, ..LOG };
        let with = Simulation { seed: 2000 + seed, ..log }.run(&truth);
        let settings = PayloadSettings { confidence: 0.9, ..PayloadSettings::default() };
        let found = estimate(&UR5, &[log.run(&NOTHING)], &[with], &settings).unwrap();
        for k in 0..PER_BODY {
            counts[k] += usize::from(inside(&found.parameters[k], truth[k]));
        }
    }
    println!("{counts:?} of {PAIRS}");
    let share = counts.iter().sum::<usize>() as f64 / (PER_BODY as f64 * PAIRS as f64);
    assert!((0.82..0.97).contains(&share), "{share}");
}

/// Loads with little and much data: values to three digits, and their errors.
fn outcomes() -> Outcomes {
    let creeping = |mut run: PreparedRun| {
        // The first joint creeps at a five-hundredth of the others' speed.
        for columns in [&mut run.positions, &mut run.velocities, &mut run.accelerations] {
            columns[0].iter_mut().for_each(|x| *x *= 2e-3);
        }
        run
    };
    let load = of(2.5, 0.15, [0.02, -0.03, 0.09]);
    let few = Simulation { samples: 300, moving: 3, ..LOG };
    let runs = [
        ("six joints", LOG.run(&NOTHING), Simulation { seed: 2, ..LOG }.run(&load)),
        ("three joints", few.run(&NOTHING), Simulation { seed: 2, ..few }.run(&load)),
        ("a creeping joint", creeping(LOG.run(&NOTHING)), creeping(Simulation { seed: 2, ..LOG }.run(&load))),
    ];
    let outcome = |(name, without, with): (&str, PreparedRun, PreparedRun)| {
        let found =
            estimate(&UR5, slice::from_ref(&without), slice::from_ref(&with), &PayloadSettings::default());
        let said = found.map_or_else(
            |error| error.to_string(),
            |found| {
                let half = |e: &crate::estimation::Uncertain| 0.5 * (e.interval[1] - e.interval[0]);
                let shown = found.shown.iter().filter(|shown| **shown).count();
                let [mass, moment] = [&found.mass, &found.moments[0]];
                format!(
                    "mass {:.2} ± {:.1e}, Ixx {:.1e} ± {:.0e}, {shown} shown",
                    mass.value,
                    half(mass),
                    moment.value,
                    half(moment)
                )
            },
        );
        (name.to_owned(), said)
    };
    runs.into_iter().map(outcome).collect()
}

#[test]
fn each_number_of_a_load_is_halved_and_doubled() {
    insta::assert_snapshot!("numbers_of_a_load", page(levels::NAMES.iter(), &outcomes));
}
