//! Currents determine forces up to a factor, whose scale the description determines.

use super::super::super::inertial::{from_pseudo_inertia, pseudo_inertia};
use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun};
use super::super::{Estimate, EstimationSettings, estimate};
use super::chain::{Chain, ur10};
use super::data::as_simulated;
use gelenk_findings::{Severity, texts};
use nalgebra::Vector3;

/// Motor constants times gears.
const CONSTANTS: [f64; 6] = [12.0, 13.0, 9.0, 5.0, 6.0, 4.5];
const FRICTION: [[f64; 2]; 6] = [[9.0, 8.0], [11.0, 9.0], [7.0, 6.0], [2.0, 2.0], [1.5, 2.0], [1.2, 1.5]];
const STEEPNESS: f64 = 20.0;

/// Inertia of drives that the description does not have.
const ROTORS: [f64; 6] = [3.0, 3.0, 1.0, 0.2, 0.2, 0.2];

/// The described arm with other masses, and centres and moments that differ by a share of the body's radius of gyration and of
/// the moments.
fn truth([masses, shapes]: [f64; 2], random: &mut SplitMix64) -> Chain {
    let mut arm = ur10();
    for link in &mut arm.joints {
        let p = pseudo_inertia(&link.parameters);
        let (mass, first) = (p[(3, 3)], p.fixed_view::<3, 1>(0, 3).into_owned());
        let about = p.fixed_view::<3, 3>(0, 0) - first * first.transpose() / mass;
        let radius = (about.trace() / mass).sqrt();
        let centre = first / mass + Vector3::from_fn(|_, _| shapes * radius * random.normal());
        let (mass, about) =
            (mass * (1.0 + masses * random.normal()), about * (1.0 + shapes * random.normal()));
        let mut other = p;
        other.fixed_view_mut::<3, 3>(0, 0).copy_from(&(about + mass * centre * centre.transpose()));
        other.fixed_view_mut::<3, 1>(0, 3).copy_from(&(mass * centre));
        other.fixed_view_mut::<1, 3>(3, 0).copy_from(&(mass * centre).transpose());
        other[(3, 3)] = mass;
        link.parameters = from_pseudo_inertia(&other);
    }
    arm
}

/// A run along sines with efforts in amperes.
///
/// - `moving`: the joints that move
fn run(arm: &Chain, (noise, rotors): (f64, f64), moving: &[usize], random: &mut SplitMix64) -> PreparedRun {
    let phases: [[f64; 4]; 6] =
        std::array::from_fn(|_| std::array::from_fn(|_| std::f64::consts::TAU * random.uniform()));
    let columns = || vec![Vec::new(); 6];
    let (mut positions, mut velocities, mut accelerations) = (columns(), columns(), columns());
    let (mut efforts, mut times) = (columns(), Vec::new());
    for i in 0..2000 {
        let t = 0.01 * f64::from(i);
        let motion = |joint: usize| {
            let mut sum = [0.0; 3];
            for (k, phase) in phases[joint].iter().enumerate().filter(|_| moving.contains(&joint)) {
                let w = 0.31 * (k + 1) as f64 * std::f64::consts::TAU / 2.0;
                let ((s, c), size) = ((w * t + phase).sin_cos(), 0.7 / (1.0 + k as f64));
                sum = [sum[0] + size * s, sum[1] + size * w * c, sum[2] - size * w * w * s];
            }
            sum
        };
        let [y, v, a]: [Vec<f64>; 3] = std::array::from_fn(|d| (0..6).map(|j| motion(j)[d]).collect());
        let mut forces = vec![0.0; 6];
        arm.rigid_forces(&y, &v, &a, &mut forces);
        for j in 0..6 {
            let friction = FRICTION[j][0] * v[j] + FRICTION[j][1] * (STEEPNESS * v[j]).tanh();
            let scale = forces[j].abs().max(FRICTION[j][1]);
            let rest = friction + rotors * ROTORS[j] * a[j] + noise * scale * random.normal();
            efforts[j].push((forces[j] + rest) / CONSTANTS[j]);
            positions[j].push(y[j]);
            velocities[j].push(v[j]);
            accelerations[j].push(a[j]);
        }
        times.push(t);
    }
    as_simulated(times, [positions, velocities, accelerations, efforts], Effort::Current)
}

/// - `robust_passes`: number of passes; with 0 all samples of the residuals count as independent
fn found(described: &Chain, run: PreparedRun, robust_passes: usize) -> Result<Estimate, String> {
    let settings =
        EstimationSettings { folds: 5, robust_passes, accept_poor: true, ..EstimationSettings::default() };
    estimate(described, &[run], &settings, &mut |_| ()).map_err(|e| e.to_string())
}

fn gains(found: &Estimate) -> Vec<f64> {
    found.joints.iter().map(|joint| joint.gain.unwrap().value).collect()
}

const ALL: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// A free scale fell to a sixth with the right description, and to 1e-12 with a wrong one: the wrist's inertia hardly affects
/// its currents, and small bodies with small gains cost nothing.
#[test]
fn described_bodies_give_the_scale_of_torque() {
    for (size, seed, allowed) in [(0.0, 1, 0.03), (0.1, 0, 0.1), (0.2, 1, 0.1)] {
        let mut random = SplitMix64::new(seed);
        let run = run(&truth([0.0, size], &mut random), (0.02, 0.0), &ALL, &mut random);
        let found = found(&ur10(), run, 0).unwrap();
        let ratios: Vec<f64> =
            gains(&found).iter().zip(CONSTANTS).map(|(gain, truth)| gain / truth).collect();
        println!("{size} {ratios:.3?}");
        assert!(ratios[..3].iter().all(|ratio| (ratio - 1.0).abs() < allowed), "{size}: {ratios:.3?}");
        assert!(found.joints.iter().all(|joint| joint.held_out_r_squared > 0.99), "{size}: {ratios:.3?}");
    }
}

/// Arms that differ from their descriptions by the assumed standard deviations: masses by 14 %, shapes by a fifth. The
/// descriptions have no rotors.
#[test]
fn intervals_of_motor_constants_hold() {
    let (mut held, mut given) = (0, 0);
    for seed in 0..10 {
        let mut random = SplitMix64::new(seed);
        let moving: &[usize] = [&ALL[..], &[1], &[1, 2, 3]][seed as usize % 3];
        let run = run(&truth([0.14, 0.14], &mut random), (0.02, 1.0), moving, &mut random);
        let found = found(&ur10(), run, 0).unwrap();
        for (joint, truth) in found.joints.iter().zip(CONSTANTS) {
            let Some(gain) = joint.gain else { continue };
            let is_held = gain.interval[0] <= truth && truth <= gain.interval[1];
            println!(
                "{seed} {} {:.2} {:.2?} {is_held}",
                joint.name,
                gain.value / truth,
                gain.interval.map(|x| x / truth)
            );
            given += usize::from(gain.has_one_size());
            held += usize::from(gain.has_one_size() && is_held);
        }
    }
    println!("{held} of {given}");
    assert!(given >= 20 && 10 * held >= 8 * given, "{held} of {given}");
}

/// A joint with a vertical axis shows only the sum of its inertia and the rotor's. The other joints rest, held by stiction.
#[test]
fn a_joint_that_shows_its_inertia_alone_has_no_motor_constant() {
    let mut random = SplitMix64::new(3);
    let run = run(&ur10(), (0.02, 1.0), &[0], &mut random);
    let found = found(&ur10(), run, 0).unwrap();
    let gain = found.joints[0].gain.unwrap();
    assert!(!gain.has_one_size() && gain.interval[1] > CONSTANTS[0], "{gain:?}");
    let said = texts(&found.findings, Severity::Warning);
    assert!(said.iter().any(|said| said.contains("[motor-constant-unknown]: joint joint_1: ")), "{said:?}");
    assert!(found.joints[1..].iter().all(|joint| joint.gain.is_none() && !joint.measured));
    // Its friction is in proportion, and its interval says so.
    let viscous = found.joints[0].terms[0].coefficient;
    assert!(viscous.interval[0] < FRICTION[0][0] && FRICTION[0][0] < viscous.interval[1], "{viscous:?}");
}

/// Currents are forces there: bodies and friction are those of the arm.
#[test]
fn described_motor_constants_stay() {
    let mut random = SplitMix64::new(4);
    let arm = truth([0.14, 0.14], &mut random);
    let run = run(&arm, (0.01, 0.0), &ALL, &mut random);
    let described = Chain { gears: CONSTANTS.to_vec(), currents: true, ..ur10() };
    let found = found(&described, run, 0).unwrap();
    for (joint, friction) in found.joints.iter().zip(FRICTION) {
        let viscous = joint.terms[0].coefficient;
        assert!(joint.gain.is_none() && (viscous.value / friction[0] - 1.0).abs() < 0.03, "{viscous:?}");
    }
}

/// Torques of a log that are declared as currents: the estimated constants are one, and the fit is equally good.
#[test]
fn a_log_of_torques_read_as_currents_keeps_its_scale() {
    let Some(mut run) = super::measured::ur10_run() else { return };
    run.effort = Effort::Current;
    let found = found(&ur10(), run, 1).unwrap();
    println!("{:.3?}", found.joints.iter().map(|joint| joint.gain).collect::<Vec<_>>());
    for joint in &found.joints[..5] {
        let gain = joint.gain.unwrap();
        assert!(
            (0.75..1.2).contains(&gain.value) && gain.interval[0] < 1.0 && gain.interval[1] > 1.0,
            "{gain:?}"
        );
        assert!(joint.held_out_r_squared > 0.98);
    }
}

/// Few joints move, and bodies of the fit are at the boundary of physically possible bodies. With the whole second-order
/// correction the iteration cycled at a relative gap of 2e-8.
#[test]
fn few_moving_joints_converge() {
    for seed in 0..6 {
        let mut random = SplitMix64::new(seed);
        let arm = truth([0.2, 0.2], &mut random);
        let run = run(&arm, (0.005, 1.0), &[2, 3], &mut random);
        found(&ur10(), run, 0).unwrap();
    }
}
