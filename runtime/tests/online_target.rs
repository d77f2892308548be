//! Targets that change while the robot moves.

#![allow(clippy::unwrap_used, reason = "test code")]
#![cfg(feature = "online-targets")]

use crate::allocations;
use crate::support::robot::{LIMITS, PowerCube, START, Watched, law, settings};
use gelenk_runtime::control_loop::{ControlLoop, Controller, End, FeedForwardPd, StopReason, StopRequest};
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::trajectory::{MotionLimits, OnlineTarget, TargetStatus, Trajectory, TrajectoryError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const RATE: f64 = 50.0;

fn limits<const N: usize>(speed: f64, acceleration: f64, jerk: f64) -> MotionLimits<N> {
    MotionLimits {
        speeds: [speed; N],
        accelerations: [acceleration; N],
        jerks: [jerk; N],
        ..MotionLimits::default()
    }
}

fn arrival<const N: usize>(motion: &OnlineTarget<N>) -> f64 {
    match motion.status() {
        TargetStatus::Followed { arrival, .. } => arrival,
        other => panic!("{other:?}"),
    }
}

/// Biagiotti, Melchiorri, *Trajectory Planning for Automatic Machines and Robots*, 2008, section 3.4:
/// durations of double-S motions between two rests.
#[test]
fn rest_to_rest_takes_the_time_of_the_double_s() {
    let time = |way: f64, limits: &MotionLimits<1>| {
        let motion = OnlineTarget::new([0.3], limits).unwrap();
        motion.set([0.3 + way]).unwrap();
        motion.begin_period(2.0);
        arrival(&motion) - 2.0
    };
    // Neither speed nor acceleration reach their limits: four jerks of (d/2j)^⅓ each.
    let free = time(0.1, &limits(10.0, 10.0, 20.0));
    assert!((free - 4.0 * (0.1_f64 / 40.0).cbrt()).abs() < 1e-9, "{free}");
    // Both do: d/v + v/a + a/j.
    let full = time(-2.0, &limits(1.0, 2.0, 20.0));
    assert!((full - (2.0 + 0.5 + 0.1)).abs() < 1e-9, "{full}");
}

/// Changes at random times to random targets. What the motion does is looked at by differences.
#[test]
fn limits_hold_and_nothing_jumps_whatever_is_asked() {
    let mut generator = ChaCha8Rng::seed_from_u64(11);
    for _ in 0..20 {
        let mut decade = |low: f64, high: f64| 10_f64.powf(generator.random_range(low..high));
        let limits = MotionLimits {
            positions: [[-1.0, 1.5]; 3],
            speeds: [decade(-1.0, 0.5), decade(-1.0, 0.5), decade(-1.0, 0.5)],
            accelerations: [decade(-0.5, 1.0), decade(-0.5, 1.0), decade(-0.5, 1.0)],
            jerks: [decade(0.5, 2.0), decade(0.5, 2.0), decade(0.5, 2.0)],
            ..MotionLimits::default()
        };
        let motion = OnlineTarget::new([0.0; 3], &limits).unwrap();
        let period = 0.01;
        let mut before = motion.sample(0.0);
        for k in 0..1500_u32 {
            let time = f64::from(k) * period;
            if generator.random_bool(0.03) {
                let target = core::array::from_fn(|_| generator.random_range(-1.0..=1.5));
                motion.set(target).unwrap();
            }
            motion.begin_period(time);
            let now = motion.sample(time);
            for i in 0..3 {
                let most = [limits.speeds[i], limits.accelerations[i], limits.jerks[i]];
                let step = |a: &[f64; 3], b: &[f64; 3]| (a[i] - b[i]).abs();
                assert!((-1.0 - 1e-7..=1.5 + 1e-7).contains(&now.positions[i]));
                assert!(now.velocities[i].abs() <= most[0] * (1.0 + 1e-9));
                assert!(now.accelerations[i].abs() <= most[1] * (1.0 + 1e-9));
                let steps = [
                    step(&now.positions, &before.positions),
                    step(&now.velocities, &before.velocities),
                    step(&now.accelerations, &before.accelerations),
                ];
                for (step, most) in steps.iter().zip(most) {
                    assert!(*step <= most * period + 2e-8, "{steps:?} {time}");
                }
            }
            before = now;
        }
        assert_eq!(motion.sample(1e4).velocities, [0.0; 3]);
    }
}

#[test]
fn what_cannot_be_followed_is_told_and_the_motion_goes_on() {
    let slow = MotionLimits { positions: [[-1e4, 1e4]; 2], ..limits(1e-4, 1.0, 1.0) };
    let motion = OnlineTarget::new([0.0; 2], &slow).unwrap();
    motion.set([0.01; 2]).unwrap();
    motion.begin_period(0.0);
    let before = motion.sample(5.0);
    for bad in [f64::NAN, f64::INFINITY, 2e4] {
        assert!(matches!(
            motion.set([0.0, bad]),
            Err(TrajectoryError::NotFinite { .. } | TrajectoryError::PointOutside { .. })
        ));
    }
    // Years away: no such profile.
    let far = [9e3, -8e3];
    motion.set(far).unwrap();
    assert_eq!(motion.status(), TargetStatus::Waiting { target: far });
    for k in 0..10 {
        motion.begin_period(0.02 * f64::from(k));
    }
    assert_eq!(motion.status(), TargetStatus::Refused { target: far });
    assert_eq!(motion.sample(5.0), before);
    motion.begin_period(f64::NAN);
    motion.set([-0.01; 2]).unwrap();
    for time in [f64::NAN, f64::INFINITY] {
        motion.begin_period(time);
        assert_eq!(motion.sample(5.0), before);
    }
    motion.begin_period(5.0);
    assert_eq!(motion.sample(5.0), before, "continuous");
    for t in [f64::NAN, f64::NEG_INFINITY, f64::INFINITY, 1e300, -1e300] {
        assert!(motion.sample(t).is_finite(), "{t}");
    }
    assert_eq!(motion.sample(f64::INFINITY).positions, [-0.01; 2]);
}

#[test]
fn limits_must_be_numbers() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-5, 1e5] {
        for limits in [limits(bad, 1.0, 1.0), limits(1.0, bad, 1.0), limits(1.0, 1.0, bad)] {
            assert!(OnlineTarget::new([0.0], &limits).is_err(), "{limits:?}");
        }
    }
    let narrow = MotionLimits { positions: [[0.5, 1.0]], ..limits(1.0, 1.0, 1.0) };
    assert_eq!(
        OnlineTarget::new([0.0], &narrow).unwrap_err().to_string(),
        "point 1 has joint 1 at 0 rad (or m), outside its limits 0.5 to 1"
    );
}

#[test]
fn a_new_target_allocates_nothing() {
    let motion = OnlineTarget::new([0.0; 6], &limits::<6>(1.0, 3.0, 30.0)).unwrap();
    motion.set([0.1; 6]).unwrap();
    motion.begin_period(0.0);
    let before = allocations::count();
    for k in 1..200_u32 {
        let time = 0.02 * f64::from(k);
        motion.set(core::array::from_fn(|i| (f64::from(k) + i as f64).sin())).unwrap();
        motion.begin_period(time);
        assert!(motion.sample(time + 0.1).is_finite());
    }
    assert_eq!(allocations::count() - before, 0);
}

/// In the loop: an operator, in another thread's place, changes the target on the way, and stops at last.
fn drive(controller: impl Controller<2, 2>, motion: OnlineTarget<2>) {
    let mut robot = Watched::at_start(RATE);
    let clock = robot.clock.clone();
    let stop = StopRequest::new();
    let operator = motion.clone();
    let mut control = ControlLoop::new(settings(RATE), law(), motion, controller, &mut robot, clock)
        .unwrap()
        .with_stop_request(stop.clone());
    control.start().unwrap();
    let targets = [(10, [0.2, 0.1]), (70, [-0.3, -0.4]), (110, [0.4, -0.2])];
    for k in 0..400 {
        if let Some((_, target)) = targets.iter().find(|(at, _)| *at == k) {
            operator.set(*target).unwrap();
        }
        assert!(control.period(), "{}", control.report());
    }
    stop.raise();
    while control.period() {}
    let report = control.report();
    drop(control);
    assert_eq!(report.end, End::Stopped(StopReason::Requested), "{report}");
    assert_eq!(report.counts.controller_faults, 0, "{report}");
    let (positions, _) = robot.state();
    assert!((positions[0] - 0.4).abs() < 5e-3 && (positions[1] + 0.2).abs() < 5e-3);
    robot.assert_stopped_safely();
}

fn of_the_arm() -> OnlineTarget<2> {
    let limits = MotionLimits { positions: LIMITS, ..limits(0.7, 2.0, 20.0) };
    OnlineTarget::new(START, &limits).unwrap()
}

#[test]
fn the_loop_follows_targets_that_change() {
    let motion = of_the_arm();
    let pd = FeedForwardPd::new(law(), motion.clone(), 1.0 / RATE, 0.01).unwrap();
    drive(pd, motion);
}

#[test]
fn a_predictive_controller_sees_the_motion_ahead() {
    let motion = of_the_arm();
    let options = MpcOptions::new(&PowerCube, 1.0 / RATE, 15);
    let mpc = LtvMpc::new(PowerCube, motion.clone(), options).unwrap();
    drive(mpc, motion);
}

/// Another thread hammers targets; the loop neither waits nor sees half of one.
#[test]
fn targets_come_from_any_thread() {
    let motion = OnlineTarget::new([0.0; 2], &limits::<2>(1.0, 3.0, 30.0)).unwrap();
    let operator = motion.clone();
    let done = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let ended = std::sync::Arc::clone(&done);
    let thread = std::thread::spawn(move || {
        let mut k = 0.0_f64;
        while !ended.load(std::sync::atomic::Ordering::Relaxed) {
            k += 1.0;
            operator.set([k.sin(), k.sin()]).unwrap();
        }
    });
    for k in 0..5000_u32 {
        let time = 1e-3 * f64::from(k);
        motion.begin_period(time);
        let end = motion.sample(f64::INFINITY).positions;
        assert_eq!(end[0].to_bits(), end[1].to_bits());
    }
    done.store(true, std::sync::atomic::Ordering::Relaxed);
    thread.join().unwrap();
}
