//! Inverse kinematics against the generated poses: the round trip over random configurations, all branches,
//! singularities.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_generated::{powercube_six_axis, puma560, ur5};
use gelenk_runtime::kinematics::{GeometryError, KinematicsError, Pose, Screws, Singularity, SphericalWrist};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

type PoseFunction = fn(&[f64; 6]) -> Pose;
const ARMS: [(&str, PoseFunction); 2] =
    [("powercube", powercube_six_axis::frame_tool_pose), ("puma", puma560::frame_tool_pose)];

fn difference(a: &Pose, b: &Pose) -> f64 {
    let position = a.0.iter().zip(&b.0).map(|(a, b)| (a - b).abs());
    let rotation = a.1.iter().flatten().zip(b.1.iter().flatten()).map(|(a, b)| (a - b).abs());
    position.chain(rotation).fold(0.0, f64::max)
}

/// Largest difference of angles, full turns aside.
fn apart(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    let turn = |d: f64| (d - (d / TAU).round() * TAU).abs();
    a.iter().zip(b).map(|(a, b)| turn(a - b)).fold(0.0, f64::max)
}

#[test]
fn every_configuration_is_found_again_among_eight() {
    for (name, pose) in ARMS {
        let arm = SphericalWrist::from_poses(pose).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let (mut worst_pose, mut worst_angle) = (0.0_f64, 0.0_f64);
        for _ in 0..10_000 {
            let y: [f64; 6] = core::array::from_fn(|_| random.random_range(-PI..PI));
            let target = pose(&y);
            let found = arm.solve(&target, &y).unwrap();
            let all: Vec<_> = found.all().collect();
            let singular = all.iter().any(|s| s.singularities().count() > 0);
            assert!(all.len() == 8 || singular, "{name}: {} at {y:?}", all.len());
            for (i, s) in all.iter().enumerate() {
                worst_pose = worst_pose.max(difference(&pose(&s.positions), &target));
                for other in &all[..i] {
                    assert!(
                        apart(&s.positions, &other.positions) > 1e-7 && s.branch != other.branch,
                        "{name}: {y:?}"
                    );
                }
            }
            worst_angle = worst_angle.max(apart(&found.closest(&y).positions, &y));
        }
        println!("{name}: poses to {worst_pose:.1e}, angles to {worst_angle:.1e} rad");
        assert!(worst_pose < 1e-9, "{name}: {worst_pose}");
        // Angles near a singularity lose half the digits.
        assert!(worst_angle < 1e-6, "{name}: {worst_angle}");
    }
}

#[test]
fn the_geometry_is_that_of_the_description() {
    let puma = Screws::from_poses(puma560::frame_tool_pose).unwrap();
    for y in [[0.0; 6], [0.4, -1.0, 2.0, -0.3, 1.1, 3.0]] {
        assert!(difference(&puma.pose(&y), &puma560::frame_tool_pose(&y)) < 1e-12);
    }
    let shoulder = Screws::from_poses(ur5::frame_tool_pose).unwrap();
    let error = SphericalWrist::new(shoulder).unwrap_err();
    assert!(matches!(error, GeometryError::NoSphericalWrist { distance } if distance > 0.05), "{error}");
}

#[test]
fn other_mechanisms_are_refused() {
    let slides = |y: &[f64; 6]| -> Pose {
        let (mut p, r) = puma560::frame_tool_pose(&[y[0], y[1], y[2], y[3], y[4], 0.0]);
        p[2] += y[5];
        (p, r)
    };
    assert_eq!(Screws::from_poses(slides).unwrap_err(), GeometryError::NotRevolute { joint: 5 });
    let coupled =
        |y: &[f64; 6]| puma560::frame_tool_pose(&[y[0], y[1] + 0.2 * y[1] * y[2], y[2], y[3], y[4], y[5]]);
    assert!(matches!(Screws::from_poses(coupled).unwrap_err(), GeometryError::NotSerial { .. }));
    let broken = |_: &[f64; 6]| -> Pose { ([f64::NAN; 3], [[f64::NAN; 3]; 3]) };
    assert!(Screws::from_poses(broken).is_err());
}

/// The upright PowerCube is singular in all three ways at once; the given angles decide what is free.
#[test]
fn singularities_are_named() {
    let pose = powercube_six_axis::frame_tool_pose;
    let arm = SphericalWrist::from_poses(pose).unwrap();
    let named = |y: [f64; 6]| -> Vec<Singularity> {
        let found = arm.solve(&pose(&y), &y).unwrap();
        let closest = found.closest(&y);
        assert!(difference(&pose(&closest.positions), &pose(&y)) < 1e-9, "{closest:?}");
        assert!(apart(&closest.positions, &y) < 1e-6, "{closest:?} for {y:?}");
        closest.singularities().collect()
    };
    use Singularity::{Elbow, Shoulder, Wrist};
    assert_eq!(named([0.3, 0.0, 0.0, 0.2, 0.0, 0.1]), [Shoulder, Elbow, Wrist]);
    assert_eq!(named([0.3, 0.7, 0.0, 0.2, 0.5, 0.1]), [Elbow]);
    assert_eq!(named([0.3, 0.7, 0.4, 0.2, 0.0, 0.1]), [Wrist]);
    assert_eq!(named([0.3, 0.7, 0.4, 0.2, 0.5, 0.1]), []);
    // Bent so that the wrist's centre returns to the first axis: 0.18 sin β + 0.46445 sin(β + γ) = 0.
    let sum = (-0.18 * 1.0_f64.sin() / 0.46445).asin();
    assert_eq!(named([0.3, 1.0, sum - 1.0, 0.2, 0.5, 0.1]), [Shoulder]);
}

#[test]
fn what_cannot_be_reached_is_said_in_numbers() {
    let arm = SphericalWrist::from_poses(powercube_six_axis::frame_tool_pose).unwrap();
    let upright = powercube_six_axis::frame_tool_pose(&[0.0; 6]);
    let error = arm.solve(&([1.0, 0.0, 0.5], upright.1), &[0.0; 6]).unwrap_err();
    let KinematicsError::OutOfReach { least, most, distance } = error else {
        panic!("{error}");
    };
    assert!((most - 0.64445).abs() < 1e-9 && (least - 0.28445).abs() < 1e-9 && distance > 1.0, "{error}");
    let puma = SphericalWrist::from_poses(puma560::frame_tool_pose).unwrap();
    let above = puma560::frame_tool_pose(&[0.0; 6]).1;
    let error = puma.solve(&([0.0, 0.1, 1.2], above), &[0.0; 6]).unwrap_err();
    let KinematicsError::TooCloseToFirstAxis { least, .. } = error else {
        panic!("{error}");
    };
    assert!((least - 0.15005).abs() < 1e-9, "{error}");
    let skewed = ([0.3, 0.2, 0.5], [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert!(matches!(puma.solve(&skewed, &[0.0; 6]), Err(KinematicsError::NotAPose(_))));
    assert!(puma.solve(&([f64::NAN; 3], above), &[0.0; 6]).is_err());
}

#[test]
fn limits_choose_among_the_solutions() {
    let pose = powercube_six_axis::frame_tool_pose;
    let arm = SphericalWrist::from_poses(pose).unwrap();
    let y = [0.3, 0.7, 0.4, 0.2, 0.5, 0.1];
    let found = arm.solve(&pose(&y), &y).unwrap();
    let mut limits = [[-FRAC_PI_2, FRAC_PI_2]; 6];
    let chosen = found.within(&limits, &y).unwrap();
    assert!(apart(&chosen.positions, &y) < 1e-9);
    limits[2] = [-FRAC_PI_2, 0.0];
    limits[0] = [0.0, TAU];
    let other = found.within(&limits, &y).unwrap();
    assert!(other.positions[2] < 0.0 && difference(&pose(&other.positions), &pose(&y)) < 1e-9);
    let error = found.within(&[[0.0, 0.01]; 6], &y).unwrap_err();
    assert!(matches!(error, KinematicsError::Limits { excess, .. } if excess > 0.0), "{error}");
}

/// Rates against central differences of the poses along a motion of the joints.
#[test]
fn rates_invert_the_motion_of_the_frame() {
    for (name, pose) in ARMS {
        let screws = Screws::from_poses(pose).unwrap();
        let joint = |t: f64| -> [f64; 6] { core::array::from_fn(|j| 0.4 + 0.3 * ((j + 1) as f64 * t).sin()) };
        let (t, h) = (0.3, 1e-4);
        let [before, now, after] = [t - h, t, t + h].map(|t| pose(&joint(t)));
        let rotation = |p: &Pose| nalgebra::Matrix3::from_fn(|i, j| p.1[i][j]);
        let omega = |a: &Pose, b: &Pose, dt: f64| {
            let turn = nalgebra::Rotation3::from_matrix_unchecked(rotation(b) * rotation(a).transpose());
            turn.scaled_axis() / dt
        };
        let (first, second) = (omega(&before, &now, h), omega(&now, &after, h));
        let (mut velocity, mut acceleration) = ([0.0; 6], [0.0; 6]);
        for i in 0..3 {
            velocity[i] = (after.0[i] - before.0[i]) / (2.0 * h);
            acceleration[i] = (after.0[i] - 2.0 * now.0[i] + before.0[i]) / (h * h);
            velocity[i + 3] = 0.5 * (first[i] + second[i]);
            acceleration[i + 3] = (second[i] - first[i]) / h;
        }
        let (v, a) = screws.rates(&joint(t), &velocity, &acceleration).unwrap();
        for j in 0..6 {
            let k = (j + 1) as f64;
            assert!((v[j] - 0.3 * k * (k * t).cos()).abs() < 1e-5, "{name}: {v:?}");
            assert!((a[j] + 0.3 * k * k * (k * t).sin()).abs() < 1e-3, "{name}: {a:?}");
        }
    }
}
