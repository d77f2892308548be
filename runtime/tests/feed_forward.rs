//! Feed-forward: the plant follows it, and what it cannot make is said.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::feed_forward::{FeedForward, FeedForwardError};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, RestToRest, Sample, Sampled, Smoothing, Trajectory};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct CartPole = gelenk_generated::cart_pole);
gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda);

/// Largest distance of each joint from the trajectory, with feed-forward alone, from `offset` away from its
/// start and with `delay` periods.
fn drift<D: Dynamics<N, M> + Copy, const N: usize, const M: usize>(
    model: D,
    trajectory: &impl Trajectory<N>,
    period: f64,
    offset: f64,
    delay: usize,
) -> [f64; N] {
    let inputs = FeedForward::new(model).unwrap().along(trajectory, period, 1e-9).unwrap();
    let options = PlantOptions { delay, ..PlantOptions::default() };
    let mut plant = Plant::new(model, options).unwrap();
    let start = trajectory.sample(0.0).positions.map(|y| y + offset);
    plant.reset(start, [0.0; N]).unwrap();
    plant.preload(inputs[0]);
    let mut largest = [0.0_f64; N];
    for (k, u) in inputs.iter().enumerate() {
        plant.apply(u, period).unwrap();
        let desired = trajectory.sample((k + 1) as f64 * period).positions;
        let actual = plant.state().0;
        for i in 0..N {
            largest[i] = largest[i].max((actual[i] - desired[i]).abs());
        }
    }
    largest
}

/// Held inputs lag by half a period: the error is of first order in the period and vanishes with it.
#[test]
fn a_finely_fed_plant_follows() {
    let motion = RestToRest::new([2.8, 0.3], [3.3, -0.4], 1.5).unwrap();
    let errors = [0.02, 0.002, 0.0002].map(|period| {
        let [a, b] = drift(PowerCube, &motion, period, 0.0, 0);
        a.max(b)
    });
    assert!(errors[0] < 0.02, "{errors:?}");
    assert!(errors[1] < 0.12 * errors[0] && errors[2] < 0.12 * errors[1], "{errors:?}");

    let start = [0.0, -0.5, 0.3, -1.8, 0.2, 1.6, 0.5];
    let end = [0.2, -0.3, 0.4, -1.5, 0.1, 1.8, 0.2];
    let seven = drift(Panda, &RestToRest::new(start, end, 1.0).unwrap(), 0.0002, 0.0, 0);
    assert!(seven.iter().all(|e| *e < 5e-3), "{seven:?}");
}

/// The published trajectory at 50 Hz with the exact model: nothing holds the arm on it.
#[test]
fn feed_forward_alone_leaves_the_published_trajectory() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/powercube_trajectory.csv");
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let recording = Recording::open(path, &columns).unwrap();
    let smoothed = recording.smoothed(&Smoothing::of(0.02)).unwrap().trajectory;
    let raw = drift(PowerCube, &recording.raw().unwrap(), 0.02, 0.0, 0);
    let exact = drift(PowerCube, &smoothed, 0.02, 0.0, 0);
    let beside = drift(PowerCube, &smoothed, 0.02, 1e-3, 0);
    println!(
        "feed-forward alone leaves the file by {raw:?}, the smoothed motion by {exact:?}, from 1 mrad beside its start by {beside:?}"
    );
    // The file's contradictions make the arm fall.
    assert!(raw.iter().all(|e| *e > 1.0));
    // The smoothed motion is left by what held inputs lag, from the very state it starts in; the arm
    // amplifies any other start by 180.
    assert!(exact.iter().all(|e| (5e-3..0.015).contains(e)));
    assert!(beside.iter().all(|e| *e > 0.1));
}

/// A pole kept upright on an accelerating cart: its equation of motion, M21 ẍ = 0, does not hold.
#[test]
fn a_trajectory_against_the_passive_joint_is_refused() {
    let feed_forward = FeedForward::new(CartPole).unwrap();
    let motion = RestToRest::new([0.0, 0.0], [1.0, 0.0], 2.0).unwrap();
    let sample = motion.sample(0.4);
    let input = feed_forward.at(&sample);
    let mass = CartPole.mass_matrix(&sample.positions);
    assert!((input.residual[1] - mass[1][0] * sample.accelerations[0]).abs() < 1e-12);
    assert_eq!(input.residual[0], 0.0);
    assert!(
        (input.inputs[0] - (mass[0][0] * sample.accelerations[0] + 0.1 * sample.velocities[0])).abs() < 1e-12
    );
    let error = feed_forward.along(&motion, 0.02, 1e-6).unwrap_err();
    let FeedForwardError::Infeasible { coordinate, residual, time, .. } = error else {
        panic!("{error}");
    };
    assert_eq!(coordinate, 1);
    // The largest acceleration of the polynomial, 10/√3 · 1/4 m/s², at 0.42 s or 1.58 s.
    assert!((residual.abs() - mass[1][0].abs() * 10.0 / 3.0_f64.sqrt() / 4.0).abs() < 1e-3);
    assert!((time - 0.42).abs() < 0.03 || (time - 1.58).abs() < 0.03, "{time}");
    assert!(feed_forward.along(&motion, 0.02, 1.0).is_ok(), "within the tolerance");
}

/// Recorded motion of a plant is feasible, and its input is recovered.
#[test]
fn a_trajectory_that_the_robot_made_is_feasible() {
    let mut plant = Plant::new(CartPole, PlantOptions::default()).unwrap();
    plant.reset([0.0, 3.0], [0.0, 0.0]).unwrap();
    let feed_forward = FeedForward::new(CartPole).unwrap();
    for k in 0..200 {
        let u = [3.0 * (0.1 * f64::from(k)).sin()];
        plant.apply(&u, 0.01).unwrap();
        let (positions, velocities) = plant.state();
        let accelerations = CartPole.forward_dynamics(&positions, &velocities, &u);
        let input = feed_forward.at(&Sample { positions, velocities, accelerations });
        assert!(input.residual.iter().all(|r| r.abs() < 1e-12), "{input:?}");
        assert!((input.inputs[0] - u[0]).abs() < 1e-12);
    }
}

#[test]
fn bad_requests_are_refused() {
    let feed_forward = FeedForward::new(PowerCube).unwrap();
    let motion = RestToRest::new([0.0; 2], [0.1; 2], 1.0).unwrap();
    assert_eq!(feed_forward.along(&motion, 0.0, 1.0).unwrap_err(), FeedForwardError::Period(0.0));
    let huge = [1e200; 2];
    let samples = vec![Sample { positions: [0.0; 2], velocities: huge, accelerations: huge }; 3];
    let wild = Sampled::new(samples, 0.02).unwrap();
    assert!(matches!(feed_forward.along(&wild, 0.02, 1.0).unwrap_err(), FeedForwardError::NotFinite { .. }));
}
