//! Currents tell forces up to a scale, which is that of the description.

use super::super::super::inertial::{from_pseudo_inertia, pseudo_inertia};
use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun};
use super::super::{Estimate, EstimationSettings, estimate};
use super::chain::{Chain, ur10};
use super::data::as_simulated;
use gelenk_findings::{Severity, texts};
use nalgebra::{Matrix4, Vector3};

/// Motor constants times gears.
const CONSTANTS: [f64; 6] = [12.0, 13.0, 9.0, 5.0, 6.0, 4.5];
const FRICTION: [[f64; 2]; 6] = [[9.0, 8.0], [11.0, 9.0], [7.0, 6.0], [2.0, 2.0], [1.5, 2.0], [1.2, 1.5]];
const STEEPNESS: f64 = 20.0;

/// The described arm with the described masses, and centres and moments that differ.
fn truth(size: f64, random: &mut SplitMix64) -> Chain {
    let mut arm = ur10();
    for link in &mut arm.joints {
        let p = pseudo_inertia(&link.parameters);
        let radius = ((p[(0, 0)] + p[(1, 1)] + p[(2, 2)]) / p[(3, 3)]).sqrt();
        // An affine map of the body's points keeps its mass.
        let mut map =
            Matrix4::identity() + Matrix4::from_fn(|r, _| if r < 3 { size * random.normal() } else { 0.0 });
        let moved = Vector3::from_fn(|r, _| radius * map[(r, 3)]);
        map.fixed_view_mut::<3, 1>(0, 3).copy_from(&moved);
        link.parameters = from_pseudo_inertia(&(map * p * map.transpose()));
    }
    arm
}

/// A run along sines with efforts in amperes.
fn run(arm: &Chain, noise: f64, random: &mut SplitMix64) -> PreparedRun {
    let phases: [[f64; 4]; 6] =
        std::array::from_fn(|_| std::array::from_fn(|_| std::f64::consts::TAU * random.uniform()));
    let columns = || vec![Vec::new(); 6];
    let (mut positions, mut velocities, mut accelerations) = (columns(), columns(), columns());
    let (mut efforts, mut times) = (columns(), Vec::new());
    for i in 0..2000 {
        let t = 0.01 * f64::from(i);
        let motion: Vec<[f64; 3]> = phases
            .iter()
            .map(|phases| {
                let mut sum = [0.0; 3];
                for (k, phase) in phases.iter().enumerate() {
                    let w = 0.31 * (k + 1) as f64 * std::f64::consts::TAU / 2.0;
                    let ((s, c), size) = ((w * t + phase).sin_cos(), 0.7 / (1.0 + k as f64));
                    sum = [sum[0] + size * s, sum[1] + size * w * c, sum[2] - size * w * w * s];
                }
                sum
            })
            .collect();
        let [y, v, a]: [Vec<f64>; 3] = std::array::from_fn(|d| motion.iter().map(|m| m[d]).collect());
        let mut forces = vec![0.0; 6];
        arm.rigid_forces(&y, &v, &a, &mut forces);
        for j in 0..6 {
            let friction = FRICTION[j][0] * v[j] + FRICTION[j][1] * (STEEPNESS * v[j]).tanh();
            let scale = forces[j].abs().max(FRICTION[j][1]);
            efforts[j].push((forces[j] + friction + noise * scale * random.normal()) / CONSTANTS[j]);
            positions[j].push(y[j]);
            velocities[j].push(v[j]);
            accelerations[j].push(a[j]);
        }
        times.push(t);
    }
    as_simulated(times, [positions, velocities, accelerations, efforts], Effort::Current)
}

fn found(described: &Chain, run: PreparedRun) -> Result<Estimate, String> {
    let settings =
        EstimationSettings { folds: 5, robust_passes: 0, accept_poor: true, ..EstimationSettings::default() };
    estimate(described, &[run], &settings, &mut |_| ()).map_err(|e| e.to_string())
}

fn gains(found: &Estimate) -> Vec<f64> {
    found.joints.iter().map(|joint| joint.gain.unwrap().value).collect()
}

/// Gains over the true ones, and what was said, for descriptions whose shapes are wrong by `size`.
fn ratios(size: f64, seed: u64) -> (Vec<f64>, Estimate) {
    let mut random = SplitMix64::new(seed);
    let arm = truth(size, &mut random);
    let run = run(&arm, 0.02, &mut random);
    let found = found(&ur10(), run).unwrap();
    (gains(&found).iter().zip(CONSTANTS).map(|(gain, truth)| gain / truth).collect(), found)
}

/// A free scale slid to a sixth where the description is right, and to 1e-12 where it is not: the wrist's inertia hardly shows
/// in its own currents, and small bodies with small gains cost nothing.
#[test]
fn described_masses_give_the_scale_of_torque() {
    for (size, seed, allowed) in [(0.0, 1, 0.01), (0.1, 0, 0.08), (0.2, 1, 0.08)] {
        let (ratios, found) = ratios(size, seed);
        println!("{size} {ratios:.3?} {:?}", texts(&found.findings, Severity::Warning));
        assert!(ratios[..3].iter().all(|ratio| (ratio - 1.0).abs() < allowed), "{size}: {ratios:.3?}");
        assert!(found.joints.iter().all(|joint| joint.held_out_r_squared > 0.99), "{size}: {ratios:.3?}");
    }
}

/// The last joint of the described arm turns a light body about its axis.
#[test]
fn a_gain_that_the_description_does_not_tell_is_said_to_be_a_guess() {
    let (ratios, found) = ratios(0.0, 0);
    let guessed = |joint: usize| {
        texts(&found.findings, Severity::Warning)
            .iter()
            .any(|w| w.contains(&format!("joint joint_{joint}: its current")))
    };
    assert!(
        guessed(6) && !(1..=3).any(guessed),
        "{ratios:.3?} {:?}",
        texts(&found.findings, Severity::Warning)
    );
    let wide = |joint: usize| {
        let gain = found.joints[joint].gain.unwrap();
        (gain.interval[1] - gain.interval[0]) / gain.value.abs()
    };
    assert!(wide(5) > 1.0 && wide(1) < 0.1, "{} {}", wide(5), wide(1));
}

/// Torques of a log that are called currents: nothing of the fit is lost.
#[test]
fn a_log_of_torques_read_as_currents_keeps_its_scale() {
    let Some(mut run) = super::measured::ur10_run() else { return };
    run.effort = Effort::Current;
    let found = found(&ur10(), run).unwrap();
    let gains = gains(&found);
    println!("{gains:.3?}");
    assert!(gains[..4].iter().all(|gain| (0.75..1.2).contains(gain)), "{gains:.3?}");
    assert!(found.joints[..5].iter().all(|joint| joint.held_out_r_squared > 0.98));
}
