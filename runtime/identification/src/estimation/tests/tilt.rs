//! Robots whose base is mounted at an angle that their description does not have.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun};
use super::super::{Estimate, EstimationSettings, estimate};
use super::chain::{Chain, ur10};
use super::data::as_simulated;
use gelenk_findings::{Severity, texts};
use nalgebra::{Rotation3, Vector3};

/// The last three joints stand still in front of the first ones: three axes are enough.
fn arm() -> Chain {
    let mut arm = ur10();
    arm.joints.truncate(3);
    arm.gears.truncate(3);
    arm.efforts.truncate(3);
    arm
}

/// A run along sines with friction, offsets and noise that is correlated over some ten samples.
fn run(truth: &Chain, noise: f64, random: &mut SplitMix64) -> PreparedRun {
    const JOINTS: usize = 3;
    let phases: [f64; 3 * JOINTS] = std::array::from_fn(|_| std::f64::consts::TAU * random.uniform());
    let mut columns: [Vec<Vec<f64>>; 4] = std::array::from_fn(|_| vec![Vec::new(); JOINTS]);
    let (mut times, mut error) = (Vec::new(), [0.0; JOINTS]);
    for i in 0..2000 {
        let t = 0.01 * f64::from(i);
        let mut motion = [[0.0; JOINTS]; 3];
        for (k, phase) in phases.iter().enumerate() {
            let (joint, w) = (k % JOINTS, 0.7 + 0.6 * (k / JOINTS) as f64 + 0.2 * (k % JOINTS) as f64);
            let ((s, c), size) = ((w * t + phase).sin_cos(), 0.8 / (1.0 + (k / JOINTS) as f64));
            let waves = [size * s, size * w * c, -size * w * w * s];
            motion.iter_mut().zip(waves).for_each(|(sum, wave)| sum[joint] += wave);
        }
        let [y, v, a] = motion;
        let mut force = [0.0; JOINTS];
        truth.rigid_forces(&y, &v, &a, &mut force);
        for j in 0..JOINTS {
            error[j] = 0.9 * error[j] + noise * random.normal();
            let effort = force[j] + 8.0 * v[j] + 5.0 * (20.0 * v[j]).tanh() + 1.0 + error[j];
            [y[j], v[j], a[j], effort].iter().zip(&mut columns).for_each(|(x, column)| column[j].push(*x));
        }
        times.push(t);
    }
    as_simulated(times, columns, Effort::Joint)
}

/// Bodies that differ from the described ones, on a base that is turned by an angle [°] about one of its axes.
fn estimated(turn: Vector3<f64>, noise: f64, seed: u64) -> Estimate {
    let mut random = SplitMix64::new(seed);
    let mut truth = arm();
    let turn = Rotation3::new(turn * std::f64::consts::PI / 180.0);
    truth.gravity = turn * truth.gravity;
    for link in &mut truth.joints {
        let scale = 1.0 + 0.2 * random.normal();
        link.parameters.iter_mut().for_each(|pi| *pi *= scale);
        let (m, moved) = (link.parameters[0], [0.02 * random.normal(), 0.02 * random.normal()]);
        link.parameters[1] += m * moved[0];
        link.parameters[2] += m * moved[1];
    }
    let run = run(&truth, noise, &mut random);
    let settings =
        EstimationSettings { folds: 5, robust_passes: 0, accept_poor: true, ..EstimationSettings::default() };
    estimate(&arm(), &[run], &settings, &mut |_| ()).unwrap()
}

fn doubt(found: &Estimate) -> Option<String> {
    texts(&found.findings, Severity::Warning).into_iter().find(|warning| warning.contains("tilted-gravity"))
}

#[test]
fn a_base_that_is_mounted_at_an_angle_is_told_with_its_gravity() {
    for turn in [[5.0, 0.0, 0.0], [0.0, -12.0, 0.0], [18.0, 18.0, 0.0], [0.0, 90.0, 0.0]] {
        let turn = Vector3::from(turn);
        let found = estimated(turn, 0.3, 4);
        let said = doubt(&found)
            .unwrap_or_else(|| panic!("{turn}: {:?}", texts(&found.findings, Severity::Warning)));
        println!("{said}");
        let number = |word: &str| said.split(word).nth(1).unwrap().split('°').next().unwrap().parse::<f64>();
        assert!((number("show gravity ").unwrap() / turn.norm() - 1.0).abs() < 0.1, "{said}");
        let gravity = said.split("gravity = [").nth(1).unwrap().split(']').next().unwrap();
        let gravity = Vector3::from_iterator(gravity.split(", ").map(|x| x.parse::<f64>().unwrap()));
        let truth = Rotation3::new(turn * std::f64::consts::PI / 180.0) * arm().gravity;
        assert!((gravity - truth).norm() < 0.3, "{said}");
    }
}

#[test]
fn a_level_base_and_a_small_angle_are_no_doubt() {
    for seed in 0..6 {
        let found = estimated(Vector3::zeros(), 1.0, seed);
        assert!(doubt(&found).is_none(), "{:?}", texts(&found.findings, Severity::Warning));
    }
    assert!(doubt(&estimated(Vector3::new(1.0, 0.0, 0.0), 0.3, 4)).is_none());
}

/// Bodies whose weights pull upwards would also explain the forces, but do not exist. A small tilt of gravity is not the
/// right result.
#[test]
fn a_robot_that_hangs_from_the_ceiling_is_not_told_of_a_small_angle() {
    let found = estimated(Vector3::new(177.0, 0.0, 0.0), 0.3, 4);
    let doubt = doubt(&found).unwrap();
    assert!(doubt.contains("show gravity 177.0° ") && doubt.contains("set `gravity = ["), "{doubt}");
    let codes: Vec<&str> = found.findings.iter().map(|finding| finding.code).collect();
    assert!(!codes.contains(&"other-gravity"), "{codes:?}");
}

#[test]
#[ignore = "200 logs, a minute: cargo test --release -p gelenk-identification --lib tilts -- --ignored --nocapture"]
fn tilts_are_found_by_chance_in_few_logs() {
    for noise in [0.3, 3.0] {
        let count =
            (0..100).filter(|seed| doubt(&estimated(Vector3::zeros(), noise, *seed)).is_some()).count();
        println!("noise {noise}: {count} of 100");
        assert!(count <= 2);
    }
}
