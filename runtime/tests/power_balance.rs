//! Power along simulated motions of robots with cylinders, springs and dampers: kinetic energy and weight, by hand from the
//! description where that is short, change by what each force does over its own way. The ways are distances of frames.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_generated::{balanced_arm, excavator};
use gelenk_runtime::dynamics::{Discretizable, Dynamics};

gelenk_runtime::dynamics!(struct Excavator = gelenk_generated::excavator);
gelenk_runtime::dynamics!(struct BalancedArm = gelenk_generated::balanced_arm);

/// Step of the simulation (s), whose error of energy falls with its fourth power.
const STEP: f64 = 5e-4;

type Pose = ([f64; 3], [[f64; 3]; 3]);

/// Two frames, by the functions of their poses.
type Ends<const N: usize> = [fn(&[f64; N]) -> Pose; 2];

/// The state at each step of a motion with inputs that change over time.
fn simulated<D: Discretizable<N, M>, const N: usize, const M: usize>(
    model: &D,
    start: [[f64; N]; 2],
    steps: usize,
    inputs: impl Fn(f64) -> [f64; M],
) -> Vec<([f64; N], [f64; N], [f64; M])> {
    let mut states = Vec::with_capacity(steps + 1);
    let [mut y, mut v] = start;
    for k in 0..=steps {
        // Held over two steps, between which Simpson's rule has its middle.
        let u = inputs(2.0 * STEP * (k / 2) as f64);
        states.push((y, v, u));
        (y, v) = model.step(&y, &v, &u, STEP);
    }
    states
}

/// Simpson's rule over pairs of steps, of a power that may jump between them: by state and the inputs of the pair.
fn work<S>(states: &[S], power: impl Fn(&S, &S) -> f64) -> f64 {
    let pairs = states.windows(3).step_by(2);
    pairs
        .map(|pair| {
            let [first, middle, last] = [0, 1, 2].map(|k| power(&pair[k], &pair[0]));
            STEP / 3.0 * (first + 4.0 * middle + last)
        })
        .sum()
}

/// Distance of two frames and its rate, by differences along the motion.
fn stretch<const N: usize>(ends: Ends<N>, y: &[f64; N], v: &[f64; N]) -> [f64; 2] {
    let length = |time: f64| {
        let at = core::array::from_fn(|i| y[i] + time * v[i]);
        let [(a, _), (b, _)] = ends.map(|pose| pose(&at));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    };
    let h = 1e-3;
    // Of the fourth order.
    let rate = (8.0 * (length(h) - length(-h)) - (length(2.0 * h) - length(-2.0 * h))) / (12.0 * h);
    [length(0.0), rate]
}

#[test]
fn cylinders_and_their_dampers_do_what_the_excavator_gains() {
    let cylinders: [Ends<4>; 3] = [
        [excavator::frame_boom_cylinder_foot_pose, excavator::frame_boom_cylinder_rod_pose],
        [excavator::frame_stick_cylinder_foot_pose, excavator::frame_stick_cylinder_rod_pose],
        [excavator::frame_bucket_cylinder_foot_pose, excavator::frame_bucket_cylinder_rod_pose],
    ];
    // As described: of the laws over dl, of the joints' friction, and of the swing's drive.
    let (damping, friction) = ([2500.0, 1800.0, 1200.0], [300.0, 60.0, 40.0, 15.0]);
    let swing = excavator::input_matrix(&[0.0; 4])[0][0];
    let inputs = |t: f64| {
        [600.0 / swing * (3.0 * t).sin(), -30e3 - 4e3 * (2.0 * t).cos(), 6e3 * (4.0 * t).sin(), -4e3 * t]
    };
    let states = simulated(&Excavator, [[0.1, -0.4, 1.3, 0.6], [0.2, 0.1, -0.1, 0.3]], 1600, inputs);
    let energy = |(y, v, _): &([f64; 4], [f64; 4], [f64; 4])| {
        excavator::kinetic_energy(y, v) + excavator::potential_energy(y)
    };
    let gained = energy(&states[1600]) - energy(&states[0]);
    let mut works = vec![work(&states, |(_, v, _), (_, _, u)| swing * u[0] * v[0])];
    for (k, ends) in cylinders.into_iter().enumerate() {
        let rate = |(y, v, _): &([f64; 4], [f64; 4], [f64; 4])| stretch(ends, y, v)[1];
        works.push(work(&states, |state, (_, _, u)| -u[k + 1] * rate(state)));
        works.push(work(&states, |state, _| -damping[k] * rate(state).powi(2)));
    }
    for (joint, friction) in friction.into_iter().enumerate() {
        works.push(work(&states, |(_, v, _), _| -friction * v[joint].powi(2)));
    }
    assert_balance(gained, &works);
}

#[test]
fn a_gas_spring_and_its_damper_do_what_the_arm_gains() {
    let ends: Ends<2> = [balanced_arm::frame_spring_foot_pose, balanced_arm::frame_spring_head_pose];
    let ([gears, friction], gravity) = ([[80.0, 60.0], [4.0, 2.0]], 9.81);
    let inputs = |t: f64| [0.4 * (2.0 * t).cos(), 0.3 * (3.0 * t).sin()];
    let states = simulated(&BalancedArm, [[0.3, 0.4], [0.5, -0.3]], 2000, inputs);
    // Heights of the two centres of mass: y = 0 is upright.
    let weight = |y: &[f64; 2]| {
        gravity * (18.0 * 0.35 * y[0].cos() + 7.0 * (0.7 * y[0].cos() + 0.3 * (y[0] + y[1]).cos()))
    };
    let law = |l: f64| -400.0 * (1.0 + 1.1 * (0.6 - l));
    let state = |k: usize| (states[k].0, states[k].1);
    let ([y0, v0], [y1, v1]) = ([state(0).0, state(0).1], [state(2000).0, state(2000).1]);
    let kinetic = balanced_arm::kinetic_energy(&y1, &v1) - balanced_arm::kinetic_energy(&y0, &v0);
    let spring = work(&states, |(y, v, _), _| {
        let [l, rate] = stretch(ends, y, v);
        -law(l) * rate
    });
    let mut works = vec![spring, work(&states, |(y, v, _), _| -150.0 * stretch(ends, y, v)[1].powi(2))];
    for joint in 0..2 {
        works.push(work(&states, |(_, v, _), (_, _, u)| gears[joint] * u[joint] * v[joint]));
        works.push(work(&states, |(_, v, _), _| -friction[joint] * v[joint].powi(2)));
    }
    assert_balance(kinetic + weight(&y1) - weight(&y0), &works);
    // What the module calls potential energy is weight and spring.
    let potential = balanced_arm::potential_energy(&y1) - balanced_arm::potential_energy(&y0);
    let error = (potential - (weight(&y1) - weight(&y0) - spring)).abs();
    assert!(error <= 1e-8 * spring.abs(), "{potential} {error}");
    assert!(BalancedArm.spring_forces(&y0, &v0)[0] != 0.0);
}

/// The sum of all work is what was gained, and no part of it could be left out.
fn assert_balance(gained: f64, works: &[f64]) {
    let (sum, size) = works.iter().fold((0.0, 0.0), |(sum, size), work| (sum + work, size + work.abs()));
    println!("{gained} {works:?}");
    assert!((sum - gained).abs() <= 1e-8 * size, "{gained} is not {sum}: {works:?}");
    assert!(works.iter().all(|work| work.abs() > 1e-6 * size), "a force does nothing: {works:?}");
}
