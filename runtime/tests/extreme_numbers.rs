//! Every public function of trajectories, kinematics and feed-forward that takes a number gets those at the
//! ends of what a number is. What comes back is an error, or a result that is finite; nothing panics, hangs
//! or fills the memory.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::feed_forward::{FeedForward, FeedForwardError};
use gelenk_runtime::kinematics::{Screws, SphericalWrist};
use gelenk_runtime::limits::{CheckError, Rating, violations};
use gelenk_runtime::trajectory::{
    Along, IdentificationSine, PointSequence, Recording, RestToRest, Sample, Sampled, Smoothing, Trajectory,
    TrajectoryError, pose_sequence, straight_ways,
};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const EXTREMES: [f64; 13] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    -f64::MAX,
    1e300,
    1e154,
    1e-154,
    f64::MIN_POSITIVE,
    5e-324,
    0.0,
    -0.0,
    -1.0,
];

/// Extremes, and a number that is none.
fn numbers() -> impl Iterator<Item = f64> + Clone {
    EXTREMES.into_iter().chain([0.7])
}

/// Where it can be sampled, it is finite, at ordinary times and at extreme ones.
fn assert_sound<const N: usize>(what: &str, motion: Result<impl Trajectory<N>, impl std::error::Error>) {
    let Ok(motion) = motion else { return };
    let duration = motion.duration();
    assert!(duration.is_finite() && duration > 0.0, "{what}: {duration}");
    let shares = (0..=16).map(|k| duration * f64::from(k) / 16.0);
    for t in shares.chain(EXTREMES) {
        assert!(motion.sample(t).is_finite(), "{what} at {t}");
    }
}

#[test]
fn motions_between_points() {
    for a in numbers() {
        for b in numbers() {
            for c in numbers() {
                let what = format!("{a:e} {b:e} {c:e}");
                assert_sound(&what, RestToRest::new([a, 0.1], [b, 0.2], c));
                let within = RestToRest::within([0.3, a], [0.1, 0.5], &[b, 1.0], &[c, 1.0], 1e-3);
                assert_sound(&what, within);
                let shortest = RestToRest::within([0.3], [0.1], &[a], &[b], c);
                assert_sound(&what, shortest);
                assert_sound(&what, PointSequence::timed(&[[a], [b], [0.2]], &[c, 1.0], a));
                let points = [[0.1], [a], [0.2]];
                assert_sound(&what, PointSequence::within(&points, &[b], &[c], c));
            }
        }
    }
    for share in numbers() {
        let within = RestToRest::within_limits([0.0; 2], [0.1; 2], &PowerCube.limits(), share, &[share; 2]);
        assert_sound(&format!("{share:e}"), within);
    }
}

#[test]
fn sines_along_ways_and_samples() {
    let ordinary = IdentificationSine {
        center: [0.1],
        amplitude: [0.4],
        first_frequency: [1.0],
        last_frequency: [2.0],
        sine_duration: 5.0,
        run_in: 1.0,
    };
    for a in numbers() {
        for b in numbers() {
            let what = format!("{a:e} {b:e}");
            for sine in [
                IdentificationSine { center: [a], amplitude: [b], ..ordinary },
                IdentificationSine { first_frequency: [a], last_frequency: [b], ..ordinary },
                IdentificationSine { sine_duration: a, run_in: b, ..ordinary },
                IdentificationSine { amplitude: [a], sine_duration: b, ..ordinary },
                IdentificationSine { amplitude: [a], run_in: b, ..ordinary },
            ] {
                assert_sound(&what, sine.motion());
            }
            let sample = |y: f64, v: f64| Sample { positions: [y], velocities: [v], accelerations: [0.0] };
            for period in numbers() {
                let samples = vec![sample(0.0, 0.0), sample(a, b), sample(0.1, 0.0)];
                assert_sound(&format!("{what} {period:e}"), Sampled::new(samples, period));
            }
        }
        // One way of 1 m in 1 s, in every share: what overflows is infinite, and never NaN.
        let one = RestToRest::new([0.0], [1.0], 1.0).unwrap();
        if let Ok(along) = Along::new([0.1, 0.2], [a, 1.0], one) {
            assert!(along.sample(0.5).positions.iter().all(|y| y.is_finite()));
        }
        let motion = RestToRest::new([0.0], [1.0], 1.0).unwrap();
        assert_sound(&format!("period {a:e}"), Sampled::of(&motion, a));
    }
}

/// A trajectory of any length.
struct Long(f64);

impl Trajectory<2> for Long {
    fn duration(&self) -> f64 {
        self.0
    }

    fn sample(&self, _: f64) -> Sample<2> {
        Sample::at_rest([0.1, 0.2])
    }
}

#[test]
fn lengths_without_an_end_are_errors() {
    let feed_forward = FeedForward::new(PowerCube).unwrap();
    for duration in [f64::NAN, f64::INFINITY, 1e300, 1e6] {
        let long = Long(duration);
        assert!(matches!(Sampled::of(&long, 0.02), Err(TrajectoryError::OutOfRange { .. })));
        assert!(matches!(feed_forward.along(&long, 0.02, 1.0), Err(FeedForwardError::Duration { .. })));
        assert!(matches!(violations(&long, PowerCube, Rating::Peak, 0.02), Err(CheckError::Duration { .. })));
    }
    let short = Long(0.1);
    for period in EXTREMES {
        // Periods far above the duration are one step.
        let possible = period.is_finite() && period > 1e-7;
        let sampled = Sampled::of(&short, period);
        assert_eq!(sampled.is_ok(), possible && period < 1e308, "{period:e}");
        assert_eq!(feed_forward.along(&short, period, 1.0).is_ok(), possible, "{period:e}");
        let checked = violations(&short, PowerCube, Rating::Peak, period);
        assert_eq!(checked.is_ok(), possible, "{period:e}");
    }
    assert!(matches!(feed_forward.along(&short, 0.02, f64::NAN), Err(FeedForwardError::Tolerance(_))));
    assert!(feed_forward.along(&Long(-1.0), 0.02, 1.0).unwrap().is_empty());
    assert_eq!(
        feed_forward.along(&Long(f64::INFINITY), 0.02, 1.0).unwrap_err().to_string(),
        "a trajectory of inf s has more than 10000000 periods of 0.02 s"
    );
}

#[test]
fn recordings() {
    for a in numbers() {
        for b in numbers() {
            let positions = vec![[0.0], [a], [0.2], [0.3]];
            for velocities in [None, Some(vec![[0.0], [b], [0.1], [0.0]])] {
                for period in [b, 0.02, 1e-300, 1e300] {
                    let what = format!("{a:e} {b:e} {period:e}");
                    let recording = Recording::new(period, positions.clone(), velocities.clone());
                    let Ok(recording) = recording else { continue };
                    assert_sound(&what, recording.raw());
                    let smoothed = recording.smoothed(&Smoothing::of(period));
                    assert_sound(&what, smoothed.map(|s| s.trajectory));
                    let smoothing = Smoothing { time_constant: a, correction_time: b };
                    let smoothed = recording.smoothed(&smoothing);
                    assert_sound(&what, smoothed.map(|s| s.trajectory));
                }
            }
        }
    }
    let positions = vec![[0.0], [1.0], [2.0]];
    let velocities = Some(vec![[50.0]; 3]);
    let exact = Recording::new(0.02, positions, velocities).unwrap();
    assert!(exact.inconsistencies(1e-12).is_empty());
    assert_eq!(exact.inconsistencies(f64::NAN).len(), 2, "no number tolerates nothing");
}

/// Poses, angles and limits; what is solved reaches its pose.
#[test]
fn inverse_kinematics() {
    let pose = gelenk_generated::puma560::frame_tool_pose;
    let arm = SphericalWrist::from_poses(pose).unwrap();
    let y = [0.3, 0.5, -0.4, 0.2, 0.7, -0.1];
    let (p, r) = pose(&y);
    for x in EXTREMES {
        for i in 0..3 {
            let mut target = (p, r);
            target.0[i] = x;
            check_solutions(&arm, &target, &y);
            for j in 0..3 {
                let mut target = (p, r);
                target.1[i][j] = x;
                check_solutions(&arm, &target, &y);
            }
        }
        for j in 0..6 {
            let mut near = y;
            near[j] = x;
            check_solutions(&arm, &(p, r), &near);
            let found = arm.solve(&(p, r), &y).unwrap();
            let mut limits = [[-7.0, 7.0]; 6];
            limits[j] = [x, 7.0];
            if let Ok(within) = found.within(&limits, &y) {
                assert!(within.positions[j] >= x, "{x:e} {within:?}");
            }
            limits[j] = [-7.0, x];
            if let Ok(within) = found.within(&limits, &y) {
                assert!(within.positions[j] <= x, "{x:e} {within:?}");
            }
            let speeds = [1.0; 6];
            let mut accelerations = [1.0; 6];
            accelerations[j] = x;
            let poses = [(p, r), pose(&[0.0, 0.4, -0.3, 0.2, 0.7, 0.1])];
            let wide = [[-7.0, 7.0]; 6];
            let sequence = pose_sequence(&arm, &poses, &wide, &near, &speeds, &accelerations);
            assert_sound(&format!("{x:e}"), sequence);
        }
        let ways = straight_ways(&arm, &y, &[pose(&[0.3, 0.5, -0.4, 0.2, 0.7, 0.1])], &[x], 0.05);
        assert_sound(&format!("{x:e} s"), ways);
        let ways = straight_ways(&arm, &y, &[pose(&[0.3, 0.5, -0.4, 0.2, 0.7, 0.1])], &[1.0], x);
        assert_sound(&format!("every {x:e} s"), ways);
        let mut velocity = [0.1; 6];
        velocity[3] = x;
        let rates = arm.screws().rates(&y, &velocity, &velocity);
        assert!(rates.is_none_or(|(v, a)| v.iter().chain(&a).all(|x| x.is_finite())));
        assert!(Screws::from_poses(|y| pose(&y.map(|y| y * x))).is_err() || x == -1.0);
        assert!(Screws::from_poses(|y| (pose(y).0.map(|p| p + x), pose(y).1)).is_ok() == (x.abs() < 1e3));
    }
}

fn check_solutions(arm: &SphericalWrist, target: &gelenk_runtime::kinematics::Pose, near: &[f64; 6]) {
    let Ok(found) = arm.solve(target, near) else {
        return;
    };
    for solution in found.all() {
        let (p, _) = arm.screws().pose(&solution.positions);
        for i in 0..3 {
            let error = (p[i] - target.0[i]).abs();
            assert!(error < 1e-6, "{target:?} {near:?} {solution:?}");
        }
    }
}
