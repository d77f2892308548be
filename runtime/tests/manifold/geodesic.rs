//! Motions through poses.

use super::Quadrotor;
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::trajectory::{Columns, GeodesicMotion, Recording, Sample, Smoothing, Trajectory};

type Motion = GeodesicMotion<Quadrotor, 6, 4, 7>;

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A turn by `angle` about an axis that is none of the body's.
fn pose(position: [f64; 3], angle: f64) -> [f64; 7] {
    let axis = [0.48, -0.6, 0.64];
    let [x, y, z] = axis.map(|a| a * (angle / 2.0).sin());
    let [a, b, c] = position;
    [a, b, c, x, y, z, (angle / 2.0).cos()]
}

/// A roll by a whole turn while it flies, with a turn about another axis at the end.
fn points() -> Vec<(f64, [f64; 7])> {
    let mut last = pose([2.0, 0.3, 1.2], 0.0);
    last[3..].copy_from_slice(&[0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]);
    vec![
        (0.0, pose([0.0, 0.0, 1.0], 0.0)),
        (0.8, pose([0.5, 0.1, 1.5], 1.9)),
        (1.3, pose([1.0, 0.4, 1.7], 4.0)),
        (2.0, pose([1.5, 0.2, 1.4], 6.0)),
        (3.0, last),
    ]
}

#[test]
fn it_passes_its_points_at_their_times() {
    let motion = Motion::through(Quadrotor, &points()).unwrap();
    assert_eq!(motion.duration(), 3.0);
    for (time, point) in points() {
        for t in [time, time - 1e-9] {
            let d = Quadrotor.difference(&point, &motion.sample(t).positions);
            assert!(distance(&d, &[0.0; 6]) <= 1e-7, "{t}: {d:?}");
        }
    }
    for t in [-1.0, f64::NAN, 3.0, 9.0] {
        let sample = motion.sample(t);
        assert_eq!((sample.velocities, sample.accelerations), ([0.0; 6], [0.0; 6]));
        assert!(sample.is_finite());
    }
}

/// Velocities are the derivatives of positions along ⊕, accelerations those of velocities, and nothing jumps.
#[test]
fn velocities_and_accelerations_are_consistent() {
    let motion = Motion::through(Quadrotor, &points()).unwrap();
    let h = 1e-5;
    let mut fastest = 0.0_f64;
    for k in 1..600 {
        let t = 3.0 * f64::from(k) / 600.0;
        let [before, at, after] = [t - h, t, t + h].map(|t| motion.sample(t));
        let length: f64 = at.positions[3..].iter().map(|q| q * q).sum();
        assert!((length - 1.0).abs() <= 1e-15);
        let v = Quadrotor.difference(&before.positions, &after.positions).map(|d| d / (2.0 * h));
        assert!(distance(&v, &at.velocities) <= 1e-6, "{t}: {v:?} is not {:?}", at.velocities);
        let a: [f64; 6] = core::array::from_fn(|i| (after.velocities[i] - before.velocities[i]) / (2.0 * h));
        // At a point the third derivative jumps: there the quotient is off by half its jump times h.
        let bound = if [0.8, 1.3, 2.0].iter().any(|point| (t - point).abs() < 2.0 * h) { 2e-2 } else { 1e-5 };
        assert!(distance(&a, &at.accelerations) <= bound, "{t}: {a:?} is not {:?}", at.accelerations);
        fastest = fastest.max(at.velocities[3].abs());
    }
    assert!(fastest > 1.0);
}

/// Between two points it is a screw about one axis, halfway at half the time.
#[test]
fn two_points_are_joined_by_a_geodesic() {
    let (start, end) = (pose([0.0, 0.0, 1.0], 0.3), pose([1.0, -0.5, 1.2], 2.9));
    let motion = Motion::between(Quadrotor, start, end, 2.0).unwrap();
    let way = Quadrotor.difference(&start, &end);
    let middle = Quadrotor.integrate(&start, &way.map(|d| 0.5 * d));
    assert!(distance(&Quadrotor.difference(&middle, &motion.sample(1.0).positions), &[0.0; 6]) <= 1e-14);
    let rate = motion.sample(1.0).velocities;
    assert!(distance(&rate, &way.map(|d| d * 1.875 / 2.0)) <= 1e-13);
}

#[test]
fn what_is_no_motion_is_refused() {
    let refused = |points: &[(f64, [f64; 7])]| Motion::through(Quadrotor, points).unwrap_err().to_string();
    let [(_, start), (_, next), ..] = points()[..] else { unreachable!() };
    assert!(refused(&[(0.0, start)]).contains("2 are needed"));
    assert!(refused(&[(0.0, start), (0.0, next)]).contains("time"));
    assert!(refused(&[(0.1, start), (0.2, next)]).contains("time"));
    assert!(refused(&[(0.0, start), (f64::NAN, next)]).contains("time"));
    let zero = refused(&[(0.0, start), (1.0, [0.0; 7])]);
    assert!(zero.contains("point 2") && zero.contains("joint base"), "{zero}");
    let nan = refused(&[(0.0, start), (1.0, [f64::NAN; 7])]);
    assert!(nan.contains("point 2") && nan.contains("base x"), "{nan}");
    let half = refused(&[(0.0, pose([0.0; 3], 0.0)), (1.0, pose([0.0; 3], std::f64::consts::PI))]);
    assert!(half.contains("joint base") && half.contains("points 1 and 2"), "{half}");
}

const COLUMNS: Columns<7> =
    Columns { time: "t", positions: ["x", "y", "z", "qx", "qy", "qz", "qw"], velocities: None };

/// A recording with this quaternion in its third sample.
fn recorded(third: &str) -> Recording<7> {
    let head = "t,x,y,z,qx,qy,qz,qw\n0,0,0,1,0,0,0,1\n0.1,0.1,0,1,0,0,0.0998334166,0.9950041653\n";
    let file = format!("{head}0.2,0.2,0,1,{third}\n0.3,0.3,0,1,0,0,-0.2955202067,-0.9553364891\n");
    Recording::read(file.as_bytes(), "flight.csv", &COLUMNS).unwrap()
}

/// Both signs of a quaternion are one attitude; zero, not finite and not of unit length are none.
#[test]
fn recordings_of_poses_become_motions() {
    let motion: Motion = recorded("0,0,0.1986693308,0.9800665778").through_poses(Quadrotor).unwrap();
    assert!((motion.duration() - 0.3).abs() < 1e-12);
    let sample = motion.sample(0.15);
    // A turn of 2 rad/s and a way of 1 m/s, to the rounding of the file.
    assert!((sample.velocities[5] - 2.0).abs() < 0.2 && sample.velocities[4].abs() < 1e-6, "{sample:?}");
    assert!((sample.positions[0] - 0.15).abs() < 1e-2);
    for (third, message) in [
        ("0,0,0,0", "point 3: the quaternion of joint base"),
        ("0,0,0.2,0.9", "point 3: the quaternion of joint base"),
    ] {
        let refused: Result<Motion, _> = recorded(third).through_poses(Quadrotor);
        let error = refused.unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
    let nan = Recording::read(
        "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,NaN,1\n2,0,0,0,0,0,0,1\n".as_bytes(),
        "",
        &COLUMNS,
    );
    assert!(nan.unwrap_err().to_string().contains("NaN"));
}

/// Samples of a motion that has velocities and accelerations give it back; between them accelerations are off to the first
/// order in the period, where turns about different axes follow each other.
#[test]
fn samples_with_accelerations_become_their_motion() {
    let motion = Motion::through(Quadrotor, &points()).unwrap();
    let errors = [(0.02, 30_u32), (0.01, 60)].map(|(period, count)| {
        let samples: Vec<Sample<6, 7>> =
            (0..=count).map(|k| motion.sample(0.1 + f64::from(k) * period)).collect();
        let sampled = Motion::sampled(Quadrotor, &samples, period).unwrap();
        for (k, sample) in samples.iter().enumerate().take(count as usize) {
            let at = sampled.sample(k as f64 * period);
            let way = Quadrotor.difference(&sample.positions, &at.positions);
            assert!(distance(&way, &[0.0; 6]) < 1e-13, "{way:?}");
            assert!(distance(&at.velocities, &sample.velocities) < 1e-9, "{at:?} {sample:?}");
            assert!(distance(&at.accelerations, &sample.accelerations) < 1e-7, "{at:?} {sample:?}");
        }
        let between = (0..count).map(|k| {
            let t = (f64::from(k) + 0.4) * period;
            let [at, other] = [sampled.sample(t), motion.sample(0.1 + t)];
            distance(&at.accelerations, &other.accelerations)
        });
        between.fold(0.0, f64::max)
    });
    println!("accelerations between the samples: {errors:?}");
    assert!(errors[0] < 3e-2 && errors[1] < 0.6 * errors[0], "{errors:?}");
}

/// A recording with noise: the filtered motion is nearer to the true one, in poses, velocities and accelerations.
#[test]
fn recordings_with_noise_are_smoothed_along_the_poses() {
    const PERIOD: f64 = 0.01;
    let motion = Motion::through(Quadrotor, &points()).unwrap();
    let count = (motion.duration() / PERIOD) as usize;
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1e-3 * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let truth: Vec<Sample<6, 7>> = (0..=count).map(|k| motion.sample(k as f64 * PERIOD)).collect();
    let measured: Vec<[f64; 7]> = truth
        .iter()
        .enumerate()
        .map(|(k, sample)| {
            // The first pose is where a smoothed motion begins.
            let way = core::array::from_fn(|_| if k == 0 { 0.0 } else { noise() });
            let pose = Quadrotor.integrate(&sample.positions, &way);
            // Both signs are one attitude.
            let sign = if noise() > 0.0 { 1.0 } else { -1.0 };
            core::array::from_fn(|i| if i < 3 { pose[i] } else { sign * pose[i] })
        })
        .collect();
    let recording = Recording::<7>::new(PERIOD, measured.clone(), None).unwrap();
    let smoothing = Smoothing { time_constant: 0.02, correction_time: 0.5 };
    let smoothed = recording.smoothed_poses(Quadrotor, &smoothing).unwrap();
    let raw = recording.through_poses(Quadrotor).unwrap();
    let root = |of: &dyn Fn(usize) -> [f64; 6]| {
        let squares: f64 = (20..count - 20).flat_map(of).map(|x| x * x).sum();
        (squares / (6 * (count - 40)) as f64).sqrt()
    };
    let at = |k: usize| smoothed.trajectory.sample(k as f64 * PERIOD);
    let pose = root(&|k| Quadrotor.difference(&truth[k].positions, &at(k).positions));
    let noise = root(&|k| Quadrotor.difference(&truth[k].positions, &measured[k]));
    let minus = |a: [f64; 6], b: [f64; 6]| core::array::from_fn(|i| a[i] - b[i]);
    let velocity = root(&|k| minus(at(k).velocities, truth[k].velocities));
    let own = root(&|k| minus(raw.sample(k as f64 * PERIOD).velocities, truth[k].velocities));
    let acceleration = root(&|k| minus(at(k).accelerations, truth[k].accelerations));
    let size = root(&|k| truth[k].accelerations);
    println!(
        "poses {pose:.1e} of {noise:.1e}, velocities {velocity:.1e} of {own:.1e}, accelerations {acceleration:.2} of {size:.2}"
    );
    assert!(pose < 0.6 * noise && velocity < 0.3 * own && acceleration < 0.3 * size);
    assert!(smoothed.position_deviation.iter().all(|d| *d < 4e-3), "{:?}", smoothed.position_deviation);
    let refused = recorded("0,0,0,0").smoothed_poses(Quadrotor, &Smoothing::of(0.1)).unwrap_err().to_string();
    assert!(refused.starts_with("point 3: the quaternion of joint base"), "{refused}");
}
