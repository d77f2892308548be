//! Trajectories: C² everywhere, and their closed forms.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_generated::{powercube_six_axis, puma560};
use gelenk_runtime::kinematics::{Singularity, SphericalWrist};
use gelenk_runtime::limits::{Quantity, Rating, violations};
use gelenk_runtime::trajectory::{
    Along, CartesianError, IdentificationSine, PointSequence, RestToRest, Sample, Sampled, Trajectory,
    joint_points, pose_sequence, straight_ways,
};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct CartPole = gelenk_generated::cart_pole);

/// Velocities and accelerations are the derivatives of what stands before them, and nothing jumps: by central
/// differences at `n` times.
fn assert_c2<const N: usize>(trajectory: &impl Trajectory<N>, n: usize, tolerance: f64) {
    let duration = trajectory.duration();
    let h = 1e-5 * duration;
    let samples = (0..=n).map(|k| duration * (-0.01 + 1.02 * k as f64 / n as f64));
    for t in samples {
        let (a, b, c) = (trajectory.sample(t - h), trajectory.sample(t), trajectory.sample(t + h));
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
            assert!(jump.abs() < 1000.0 * tolerance, "acceleration of {i} jumps by {jump} at {t}");
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
    let peak = (0..=4000).map(|k| way.sample(f64::from(k) * 1e-3).accelerations[0]).fold(0.0, f64::max);
    assert!((peak - 10.0 / 3.0_f64.sqrt() * 2.0 / 16.0).abs() < 1e-6, "{peak}");
}

#[test]
fn the_fastest_rest_to_rest_touches_one_limit() {
    let infinite = [f64::INFINITY; 2];
    let by_speed = RestToRest::within([0.0; 2], [2.0, -1.0], &[0.5, 0.4], &infinite, 0.1).unwrap();
    assert!((by_speed.duration() - 7.5).abs() < 1e-12);
    assert!((by_speed.sample(3.75).velocities[0] - 0.5).abs() < 1e-12);
    let both = RestToRest::within([0.0; 2], [2.0, -1.0], &[10.0; 2], &[0.5, 9.0], 0.1).unwrap();
    assert!((both.duration().powi(2) - 10.0 / 3.0_f64.sqrt() * 2.0 / 0.5).abs() < 1e-9);
    assert_eq!(RestToRest::within([1.0; 2], [1.0; 2], &[1.0; 2], &infinite, 0.1).unwrap().duration(), 0.1);
    assert!(RestToRest::within([0.0; 2], [1.0; 2], &[0.0; 2], &infinite, 0.1).is_err());
}

#[test]
fn bad_numbers_are_named() {
    let error = RestToRest::new([0.0, f64::NAN], [0.0; 2], 1.0).unwrap_err();
    assert_eq!(error.to_string(), "start of joint 2 is NaN, but must be finite");
    let error = RestToRest::new([0.0; 2], [0.0; 2], -1.0).unwrap_err();
    assert_eq!(error.to_string(), "duration is -1, but must be positive");
    let one = vec![Sample::at_rest([0.0])];
    assert!(Sampled::new(one, 0.02).unwrap_err().to_string().contains("2 are needed"));
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

#[test]
fn the_identification_sine_runs_in_and_out() {
    let sine = IdentificationSine {
        center: [0.1, -0.5],
        amplitude: [0.4, 0.0],
        first_frequency: [1.0, 0.0],
        last_frequency: [3.0, 0.0],
        sine_duration: 10.0,
        run_in: 1.5,
    };
    let motion = sine.motion().unwrap();
    assert_eq!(motion.duration(), 13.0);
    assert_c2(&motion, 3000, 1e-4);
    // â sin(ω(t) t) with ω(4) = 1.8, and its derivatives by hand.
    let (t, omega) = (4.0_f64, 1.0 + 2.0 * 4.0 / 10.0);
    let rate = 1.0 + 2.0 * 0.2 * t;
    let at = motion.sample(1.5 + t);
    assert!((at.positions[0] - (0.1 + 0.4 * (omega * t).sin())).abs() < 1e-12);
    assert!((at.velocities[0] - 0.4 * (omega * t).cos() * rate).abs() < 1e-12);
    assert_eq!([at.positions[1], at.velocities[1]], [-0.5, 0.0]);
    // The run-in only speeds up.
    assert!((0..=150).all(|k| motion.sample(0.01 * f64::from(k)).velocities[0] >= 0.0));
    assert!((motion.sample(0.0).positions[0] - (0.1 - 0.5 * 0.4 * 1.5)).abs() < 1e-12);
    assert!(IdentificationSine { run_in: 0.0, ..sine }.motion().is_err());
}

#[test]
fn the_compensated_motion_keeps_the_sum() {
    let sine = IdentificationSine {
        center: [0.0],
        amplitude: [0.6],
        first_frequency: [1.0],
        last_frequency: [2.0],
        sine_duration: 5.0,
        run_in: 1.0,
    };
    let motion = Along::compensated([0.2, 0.3], sine.motion().unwrap()).unwrap();
    assert_c2(&motion, 1000, 1e-5);
    for k in 0..=70 {
        let s = motion.sample(0.1 * f64::from(k));
        assert!((s.positions[0] + s.positions[1] - 0.5).abs() < 1e-15);
        assert_eq!(s.velocities[0], -s.velocities[1]);
        assert_eq!(s.accelerations[0], -s.accelerations[1]);
    }
    // Gravity on the second joint depends on the sum alone.
    use gelenk_runtime::dynamics::Dynamics;
    let gravity = |t: f64| PowerCube.gravity_forces(&motion.sample(t).positions);
    assert!((gravity(1.7)[1] - gravity(4.0)[1]).abs() < 1e-12);
    assert!((gravity(1.7)[0] - gravity(4.0)[0]).abs() > 0.1);
}

#[test]
fn points_are_visited_one_after_the_other() {
    let points = [[0.0, 0.0], [0.5, -0.2], [0.5, -0.2], [-0.3, 1.0]];
    let sequence = PointSequence::within(&points, &[0.4; 2], &[1.0; 2], 0.5).unwrap();
    assert_c2(&sequence, 4000, 1e-5);
    for (time, point) in sequence.times().iter().zip(points) {
        assert_eq!(sequence.sample(*time).positions, point);
    }
    let fastest = (0..=5000)
        .map(|k| sequence.sample(sequence.duration() * f64::from(k) / 5000.0))
        .flat_map(|s| s.velocities)
        .fold(0.0, |a: f64, v| a.max(v.abs()));
    assert!((fastest - 0.4).abs() < 1e-5, "{fastest}");
    let timed = PointSequence::timed(&points[..2], &[2.0], 0.0).unwrap();
    assert_eq!(timed.duration(), 2.0);
    assert!(PointSequence::timed(&points, &[2.0], 0.0).is_err());
    assert!(PointSequence::within(&points[..1], &[0.4; 2], &[1.0; 2], 0.0).is_err());
    assert!(PointSequence::within(&points, &[0.4; 2], &[1.0; 2], -1.0).is_err());
}

#[test]
fn broken_limits_are_named_with_their_time() {
    let slow = RestToRest::new([2.9, 0.0], [3.2, 0.3], 3.0).unwrap();
    assert_eq!(violations(&slow, PowerCube, Rating::Peak, 0.01).unwrap(), []);
    // 3 rad in 1.5 s: 3.75 rad/s where 2.618 rad/s are allowed, from 0.45 s on.
    let fast = RestToRest::new([2.0, 0.0], [5.0, 0.0], 1.5).unwrap();
    let found = violations(&fast, PowerCube, Rating::Peak, 0.01).unwrap();
    let speed = found.iter().find(|v| v.quantity == Quantity::Velocity).unwrap();
    assert_eq!((speed.index, speed.limit), (0, 25.0 * std::f64::consts::TAU / 60.0));
    assert!((speed.value - 3.75).abs() < 1e-9 && (speed.worst_time - 0.75).abs() < 1e-9, "{speed}");
    assert!((speed.from + speed.to - 1.5).abs() < 0.011, "{speed}");
    assert!(found.iter().any(|v| v.quantity == Quantity::Effort && v.limit.abs() == 80.5));
    assert!(found.iter().any(|v| v.quantity == Quantity::Input && v.limit.abs() == 0.5));
    // Cart: the position beyond ±2.4 m, and a pole that no input holds upright.
    let far = RestToRest::new([0.0, 0.0], [3.0, 0.0], 4.0).unwrap();
    let found = violations(&far, CartPole, Rating::Nominal, 0.01).unwrap();
    assert!(found.iter().any(|v| v.quantity == Quantity::Position && v.limit == 2.4 && v.to == 4.0));
    assert!(found.iter().any(|v| v.quantity == Quantity::Unreachable && v.index == 1));
    let text = found[0].to_string();
    assert!(text.contains(" s to "), "{text}");
    // NaN breaks every limit rather than none.
    let huge = [1e200; 2];
    let samples = vec![Sample { positions: [0.0; 2], velocities: huge, accelerations: huge }; 3];
    let wild = Sampled::new(samples, 0.02).unwrap();
    assert!(!violations(&wild, PowerCube, Rating::Peak, 0.01).unwrap().is_empty());
}

#[test]
fn poses_are_visited_in_joint_space() {
    let pose = powercube_six_axis::frame_tool_pose;
    let arm = SphericalWrist::from_poses(pose).unwrap();
    let points =
        [[0.2, 0.5, 0.6, 0.1, 0.7, -0.2], [0.5, 0.7, 0.4, 0.3, 0.9, 0.2], [-0.4, 0.3, 0.9, -0.2, 0.5, 0.1]];
    let poses = points.map(|y| pose(&y));
    let free = [[f64::NEG_INFINITY, f64::INFINITY]; 6];
    let sequence = pose_sequence(&arm, &poses, &free, &points[0], &[0.5; 6], &[2.0; 6]).unwrap();
    assert_c2(&sequence, 1000, 1e-5);
    for (time, point) in sequence.times().iter().zip(points) {
        let reached = sequence.sample(*time).positions;
        assert!(reached.iter().zip(&point).all(|(a, b)| (a - b).abs() < 1e-9), "{reached:?}");
    }
    let far = ([5.0, 0.0, 0.0], poses[0].1);
    let error = joint_points(&arm, &[poses[0], far], &free, &points[0]).unwrap_err();
    assert!(matches!(error, CartesianError::Unreachable { pose: 1, .. }), "{error}");
}

#[test]
fn straight_ways_are_straight() {
    let pose = puma560::frame_tool_pose;
    let arm = SphericalWrist::from_poses(pose).unwrap();
    let start = [0.2, 0.5, -0.6, 0.1, 0.7, -0.2];
    let (a, b) = (pose(&start), pose(&[0.6, 0.7, -0.9, 0.4, 1.0, 0.3]));
    let motion = straight_ways(&arm, &start, &[b, a], &[2.0, 2.0], 0.01).unwrap();
    assert_c2(&motion, 1500, 1e-4);
    assert_eq!(motion.duration(), 4.0);
    let way: Vec<f64> = (0..3).map(|i| b.0[i] - a.0[i]).collect();
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    for k in 0..=4000 {
        let t = 1e-3 * f64::from(k);
        let p = pose(&motion.sample(t).positions).0;
        let r: Vec<f64> = (0..3).map(|i| p[i] - a.0[i]).collect();
        let along = r.iter().zip(&way).map(|(r, w)| r * w).sum::<f64>() / length;
        let off = (r.iter().map(|x| x * x).sum::<f64>() - along * along).max(0.0).sqrt();
        // Between the samples, joints follow polynomials: nanometres from the line.
        assert!(off < 1e-7, "{off} m beside the line at {t} s");
    }
    let (back, first) = (motion.sample(4.0).positions, start);
    assert!(back.iter().zip(&first).all(|(x, y)| (x - y).abs() < 1e-9), "{back:?}");
}

#[test]
fn straight_ways_through_singularities_are_refused() {
    let pose = powercube_six_axis::frame_tool_pose;
    let arm = SphericalWrist::from_poses(pose).unwrap();
    let refusal = |start: &[f64; 6], end| match straight_ways(&arm, start, &[end], &[2.0], 0.005) {
        Ok(_) => panic!("a way through a singularity"),
        Err(error) => error,
    };
    // It begins with the fourth and sixth axes in line.
    let straight = [0.2, 0.5, 0.6, 0.0, 0.0, 0.0];
    let end = pose(&[0.2, 0.5, 0.6, 0.3, 0.4, 0.0]);
    let error = refusal(&straight, end);
    assert!(matches!(error, CartesianError::Singular { singularity: Singularity::Wrist, .. }), "{error}");
    // It passes close by: the fourth joint would have to turn almost half around at once, and the sixth back.
    let error = refusal(&[0.2, 0.5, 0.6, 0.4, 0.3, 0.0], pose(&[0.2, 0.5, 0.6, 0.4 + 3.1, 0.3, -3.1]));
    assert!(matches!(error, CartesianError::Jump { joint: 3, .. }), "{error}");
    let far = ([5.0, 0.0, 0.0], end.1);
    let error = refusal(&[0.2, 0.5, 0.6, 0.0, 0.3, 0.0], far);
    assert!(
        matches!(error, CartesianError::WayUnreachable { pose: 0, .. } | CartesianError::Jump { .. }),
        "{error}"
    );
}
