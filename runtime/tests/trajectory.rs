//! Trajectories: C² everywhere, and their closed forms.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::trajectory::{RestToRest, Sample, Sampled, Trajectory};

/// Velocities and accelerations are the derivatives of what stands before them, and nothing jumps: by central differences at `n` times.
fn assert_c2<const N: usize>(trajectory: &impl Trajectory<N>, n: usize, tolerance: f64) {
    let duration = trajectory.duration();
    let h = 1e-5 * duration;
    let samples = (0..=n).map(|k| duration * (-0.01 + 1.02 * k as f64 / n as f64));
    for t in samples {
        let (a, b, c) = (
            trajectory.sample(t - h),
            trajectory.sample(t),
            trajectory.sample(t + h),
        );
        for i in 0..N {
            let velocity = (c.positions[i] - a.positions[i]) / (2.0 * h);
            let acceleration = (c.velocities[i] - a.velocities[i]) / (2.0 * h);
            let jump = c.accelerations[i] - a.accelerations[i];
            assert!(
                (velocity - b.velocities[i]).abs() < tolerance,
                "velocity of {i} at {t}: {velocity} and {}",
                b.velocities[i]
            );
            assert!(
                (acceleration - b.accelerations[i]).abs() < 100.0 * tolerance,
                "acceleration of {i} at {t}: {acceleration} and {}",
                b.accelerations[i]
            );
            assert!(
                jump.abs() < 1000.0 * tolerance,
                "acceleration of {i} jumps by {jump} at {t}"
            );
        }
    }
}

#[test]
fn rest_to_rest_has_its_peaks() {
    let way = RestToRest::new([0.0, 1.0], [2.0, 0.5], 4.0).unwrap();
    assert_c2(&way, 500, 1e-6);
    assert_eq!(way.sample(-1.0), Sample::at_rest([0.0, 1.0]));
    assert_eq!(way.sample(f64::NAN), Sample::at_rest([0.0, 1.0]));
    assert_eq!(way.sample(4.0), Sample::at_rest([2.0, 0.5]));
    let middle = way.sample(2.0);
    assert!((middle.velocities[0] - 15.0 / 8.0 * 2.0 / 4.0).abs() < 1e-12);
    assert!((middle.positions[1] - 0.75).abs() < 1e-12);
    let peak = (0..=4000)
        .map(|k| way.sample(f64::from(k) * 1e-3).accelerations[0])
        .fold(0.0, f64::max);
    assert!(
        (peak - 10.0 / 3.0_f64.sqrt() * 2.0 / 16.0).abs() < 1e-6,
        "{peak}"
    );
}

#[test]
fn the_fastest_rest_to_rest_touches_one_limit() {
    let infinite = [f64::INFINITY; 2];
    let by_speed = RestToRest::within([0.0; 2], [2.0, -1.0], &[0.5, 0.4], &infinite, 0.1).unwrap();
    assert!((by_speed.duration() - 7.5).abs() < 1e-12);
    assert!((by_speed.sample(3.75).velocities[0] - 0.5).abs() < 1e-12);
    let both = RestToRest::within([0.0; 2], [2.0, -1.0], &[10.0; 2], &[0.5, 9.0], 0.1).unwrap();
    assert!((both.duration().powi(2) - 10.0 / 3.0_f64.sqrt() * 2.0 / 0.5).abs() < 1e-9);
    assert_eq!(
        RestToRest::within([1.0; 2], [1.0; 2], &[1.0; 2], &infinite, 0.1)
            .unwrap()
            .duration(),
        0.1
    );
    assert!(RestToRest::within([0.0; 2], [1.0; 2], &[0.0; 2], &infinite, 0.1).is_err());
}

#[test]
fn bad_numbers_are_named() {
    let error = RestToRest::new([0.0, f64::NAN], [0.0; 2], 1.0).unwrap_err();
    assert_eq!(error.to_string(), "start[1] is NaN; it must be finite");
    let error = RestToRest::new([0.0; 2], [0.0; 2], -1.0).unwrap_err();
    assert_eq!(error.to_string(), "duration is -1; it must be positive");
    let one = vec![Sample::at_rest([0.0])];
    assert!(
        Sampled::new(one, 0.02)
            .unwrap_err()
            .to_string()
            .contains("at least 2")
    );
}

#[test]
fn samples_are_met_and_joined() {
    let way = RestToRest::new([0.0, 1.0], [2.0, 0.5], 4.0).unwrap();
    let sampled = Sampled::of(&way, 0.02).unwrap();
    assert_c2(&sampled, 1500, 1e-6);
    assert_eq!(sampled.samples().len(), 201);
    for k in 0..=400 {
        let t = 0.01 * f64::from(k);
        let (a, b) = (way.sample(t), sampled.sample(t));
        for i in 0..2 {
            // A polynomial of degree five is met exactly by pieces of degree five.
            assert!((a.positions[i] - b.positions[i]).abs() < 1e-12);
            assert!((a.accelerations[i] - b.accelerations[i]).abs() < 1e-9);
        }
    }
    assert_eq!(sampled.sample(5.0), Sample::at_rest([2.0, 0.5]));
}
