//! Motions through points without a stop: what they promise, looked at by dense sampling and by differences,
//! which know nothing of how they were made.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::trajectory::{MotionLimits, PointSequence, Trajectory, TrajectoryError, ViaPoints};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Random points and limits: distances from 1e-4 to 3, and limits over two decades.
fn random(generator: &mut ChaCha8Rng, count: usize) -> (Vec<[f64; 3]>, MotionLimits<3>) {
    let mut at = [0.0; 3];
    let points = (0..count)
        .map(|_| {
            let scale = 10_f64.powf(generator.random_range(-4.0..0.3));
            for y in &mut at {
                if generator.random_bool(0.8) {
                    *y = (*y + scale * generator.random_range(-1.0..1.0)).clamp(-2.0, 2.0);
                }
            }
            at[0] += 1e-4;
            at
        })
        .collect();
    let mut decades = || 10_f64.powf(generator.random_range(-1.0..1.0));
    let limits = MotionLimits {
        positions: [[-2.0, 2.1]; 3],
        speeds: [decades(), decades(), decades()],
        accelerations: [decades(), decades(), decades()],
        ..MotionLimits::default()
    };
    (points, limits)
}

/// Largest position, speed and acceleration over their limits, at 40 instants between any two points.
fn largest(motion: &ViaPoints<3>, limits: &MotionLimits<3>) -> [f64; 3] {
    let mut largest = [f64::NEG_INFINITY; 3];
    for pair in motion.times().windows(2) {
        for k in 0..=40 {
            let t = pair[0] + (pair[1] - pair[0]) * f64::from(k) / 40.0;
            let sample = motion.sample(t);
            for i in 0..3 {
                let [low, high] = limits.positions[i];
                let y = sample.positions[i];
                let over = [
                    (low - y).max(y - high),
                    sample.velocities[i].abs() / limits.speeds[i],
                    sample.accelerations[i].abs() / limits.accelerations[i],
                ];
                for (largest, over) in largest.iter_mut().zip(over) {
                    *largest = largest.max(over);
                }
            }
        }
    }
    largest
}

#[test]
fn limits_are_kept_and_one_is_reached() {
    let mut generator = ChaCha8Rng::seed_from_u64(7);
    for count in [2, 3, 4, 5, 8, 13, 30] {
        for _ in 0..12 {
            let (points, limits) = random(&mut generator, count);
            let motion = ViaPoints::within(&points, &limits).unwrap();
            let [position, speed, acceleration] = largest(&motion, &limits);
            assert!(position <= 1e-11, "{position}");
            assert!(speed <= 1.0 + 1e-9 && acceleration <= 1.0 + 1e-9, "{speed} {acceleration}");
            // Accelerations of splines are largest in a point, those of monotone polynomials may lie between
            // two samples.
            assert!(speed.max(acceleration) > 0.95, "{speed} {acceleration}");
            for (time, point) in motion.times().iter().zip(&points) {
                let at = motion.sample(*time).positions;
                for i in 0..3 {
                    assert!((at[i] - point[i]).abs() < 1e-9, "{at:?} {point:?}");
                }
            }
        }
    }
}

/// Positions, velocities and accelerations have no jump, and each is the derivative of the one before.
#[test]
fn the_motion_is_twice_continuously_differentiable() {
    let mut generator = ChaCha8Rng::seed_from_u64(8);
    for count in [2, 3, 6, 12] {
        let (points, limits) = random(&mut generator, count);
        let motion = ViaPoints::within(&points, &limits).unwrap();
        let duration = motion.duration();
        assert_eq!(motion.sample(0.0).velocities, [0.0; 3]);
        assert_eq!(motion.sample(duration), motion.sample(duration + 1.0));
        let steps = 20_000;
        let h = duration / f64::from(steps);
        let mut before = motion.sample(-h);
        let scale: f64 = limits.accelerations.iter().copied().fold(0.0, f64::max);
        let mut jumps = [0.0_f64; 3];
        for k in 0..=steps + 1 {
            let now = motion.sample(f64::from(k) * h);
            for i in 0..3 {
                let mean = |a: &[f64; 3], b: &[f64; 3]| 0.5 * (a[i] + b[i]) * h;
                let step = now.positions[i] - before.positions[i];
                jumps[0] = jumps[0].max((step - mean(&now.velocities, &before.velocities)).abs());
                let step = now.velocities[i] - before.velocities[i];
                let mean = mean(&now.accelerations, &before.accelerations);
                jumps[1] = jumps[1].max((step - mean).abs());
                let step = now.accelerations[i] - before.accelerations[i];
                jumps[2] = jumps[2].max(step.abs());
            }
            before = now;
        }
        // The shortest way may be some ten steps long: the acceleration changes by a part of its limit from
        // step to step.
        let [position, velocity, acceleration] = jumps;
        assert!(acceleration < 0.5 * scale, "{jumps:?}");
        assert!(velocity < 0.2 * h * scale, "{jumps:?}");
        assert!(position < 0.2 * h * h * scale, "{jumps:?}");
    }
}

/// Between points of one joint the accelerations are straight lines: that, together with the other tests,
/// makes it *the* spline.
#[test]
fn without_position_limits_it_is_a_cubic_spline() {
    let limits = MotionLimits { speeds: [1.0], accelerations: [2.0], ..MotionLimits::default() };
    let points = [[0.0], [0.4], [0.1], [0.7], [0.9]];
    let motion = ViaPoints::within(&points, &limits).unwrap();
    for pair in motion.times().windows(2).skip(1).take(2) {
        let at = |share: f64| {
            let t = pair[0] + share * (pair[1] - pair[0]);
            motion.sample(t).accelerations[0]
        };
        assert!((at(0.5) - 0.5 * (at(0.25) + at(0.75))).abs() < 1e-12);
        assert!((at(0.0) - (2.0 * at(0.25) - at(0.5))).abs() < 1e-12);
    }
    // It turns around near the second and the third point, and beyond them.
    let highest = (0..1000)
        .map(|k| motion.sample(motion.times()[2] * f64::from(k) / 1000.0).positions[0])
        .fold(0.0, f64::max);
    assert!(highest > 0.404, "{highest}");
}

/// The same points with position limits where they turn around: no overshoot, and still no stop on the way.
#[test]
fn position_limits_are_kept_where_splines_overshoot() {
    let limits = MotionLimits {
        positions: [[0.0, 0.4], [-10.0, 10.0]],
        speeds: [1.0; 2],
        accelerations: [2.0; 2],
        ..MotionLimits::default()
    };
    let points = [[0.0, 0.0], [0.4, 1.0], [0.1, 2.0], [0.2, 3.0], [0.4, 4.0]];
    let motion = ViaPoints::within(&points, &limits).unwrap();
    for k in 0..=5000 {
        let y = motion.sample(motion.duration() * f64::from(k) / 5000.0).positions[0];
        assert!((-1e-12..=0.4 + 1e-12).contains(&y), "{y}");
    }
    for time in &motion.times()[1..4] {
        assert!(motion.sample(*time).velocities[1] > 0.3, "the other joint passes");
    }
}

#[test]
fn it_is_faster_than_stopping() {
    let mut generator = ChaCha8Rng::seed_from_u64(9);
    let (mut passing, mut stopping) = (0.0, 0.0);
    for _ in 0..30 {
        let (points, limits) = random(&mut generator, 8);
        passing += ViaPoints::within(&points, &limits).unwrap().duration();
        stopping +=
            PointSequence::within(&points, &limits.speeds, &limits.accelerations, 0.0).unwrap().duration();
    }
    // Random points are a succession of reversals, in which some joint stops anyway.
    assert!(passing < 0.93 * stopping, "{passing} {stopping}");
    let limits = MotionLimits { speeds: [1.0; 3], accelerations: [3.0; 3], ..MotionLimits::default() };
    let curve: Vec<[f64; 3]> =
        (0..12).map(|k| [0.3, 0.5, 0.7].map(|rate| (rate * f64::from(k)).sin())).collect();
    let passing = ViaPoints::within(&curve, &limits).unwrap().duration();
    let stopping = PointSequence::within(&curve, &limits.speeds, &limits.accelerations, 0.0);
    let ratio = passing / stopping.unwrap().duration();
    assert!(ratio < 0.65, "{ratio}");
    // Along a line at an even distance nearly all of the way has the highest speed.
    let points: Vec<[f64; 1]> = (0..21).map(|k| [0.5 * f64::from(k)]).collect();
    let limits = MotionLimits { speeds: [1.0], accelerations: [2.0], ..MotionLimits::default() };
    let line = ViaPoints::within(&points, &limits).unwrap();
    assert!(line.duration() < 1.15 * 10.5, "{}", line.duration());
}

#[test]
fn what_cannot_be_is_named() {
    let limits = MotionLimits {
        positions: [[-1.0, 1.0], [f64::NEG_INFINITY, f64::INFINITY]],
        speeds: [1.0; 2],
        accelerations: [2.0; 2],
        ..MotionLimits::default()
    };
    let message = |points: &[[f64; 2]], limits: &MotionLimits<2>| {
        ViaPoints::within(points, limits).unwrap_err().to_string()
    };
    assert_eq!(message(&[[0.0; 2]], &limits), "1 points are given, but 2 are needed");
    assert_eq!(
        message(&[[0.0; 2], [0.1, 0.2], [0.1, 0.2]], &limits),
        "points 2 and 3 are equal. Remove one of them, or use `PointSequence` to stop there"
    );
    assert_eq!(
        message(&[[0.0; 2], [1.2, 0.2]], &limits),
        "point 2 has joint 1 at 1.2 rad (or m), outside its limits -1 to 1"
    );
    assert_eq!(
        message(&[[0.0; 2], [0.1, f64::NAN]], &limits),
        "point 2, joint 2, is NaN, but must be finite"
    );
    let unlimited = MotionLimits::default();
    assert_eq!(
        message(&[[0.0; 2], [0.0, 0.2]], &unlimited),
        "joint 2 moves, but neither its speed nor its acceleration is limited. Set one of these limits"
    );
    for bad in [0.0, -1.0, f64::NAN] {
        let limits = MotionLimits { speeds: [1.0, bad], ..limits };
        assert!(message(&[[0.0; 2], [0.1; 2]], &limits).contains("speed limit of joint 2"));
    }
    let crossed = MotionLimits { positions: [[1.0, -1.0]; 2], ..limits };
    assert!(message(&[[0.0; 2], [0.1; 2]], &crossed).contains("width of the position limits"));
}

/// Ends of what a number is: an error, or a motion that is one.
#[test]
fn extreme_numbers_are_errors_or_motions() {
    let extremes = [1e308, -1e308, 1e154, 1e-154, 5e-324, 1e-300, f64::INFINITY, 0.3];
    for a in extremes {
        for b in extremes {
            for c in extremes {
                let limits = MotionLimits {
                    speeds: [b.abs(), 1.0],
                    accelerations: [c.abs(), 1.0],
                    ..MotionLimits::default()
                };
                let points = [[0.0, 0.0], [a, 0.1], [0.1, b], [0.2, 0.0]];
                let Ok(motion) = ViaPoints::within(&points, &limits) else {
                    continue;
                };
                assert!(motion.duration().is_finite() && motion.duration() > 0.0);
                for k in 0..=50 {
                    let sample = motion.sample(motion.duration() * f64::from(k) / 50.0);
                    assert!(sample.is_finite(), "{a:e} {b:e} {c:e}");
                }
            }
        }
    }
    assert!(matches!(
        ViaPoints::within(
            &[[0.0], [1e308], [-1e308]],
            &MotionLimits { speeds: [1e-300], ..MotionLimits::default() }
        ),
        Err(TrajectoryError::OutOfRange { .. } | TrajectoryError::NotFinite { .. })
    ));
}
