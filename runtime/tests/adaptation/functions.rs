//! The robot with its learned friction is a robot: functions agree with each other, and derivatives with differences.

use super::random::SplitMix64;
use gelenk_runtime::adaptation::{
    Adaptation, AdaptationSettings, DescribedForces, LearnedFriction, Magnitudes, Measured, TERMS, Trust,
};
use gelenk_runtime::dynamics::{Differentiable, Discretizable, Dynamics};
use nalgebra::{SMatrix, SVector};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct GearedArm = gelenk_generated::geared_arm);
gelenk_runtime::dynamics!(struct CoupledWrist = gelenk_test_robots::tx40_like);

const PERIOD: f64 = 0.01;

/// Estimator of a robot that moves along sines. Its friction, and its load-dependent friction, are these multiples of the described.
fn taught<D: Dynamics<N, N>, const N: usize>(robot: &D, friction: f64, of_load: f64) -> Adaptation<N> {
    let mut adaptation = Adaptation::for_robot(robot, AdaptationSettings::new(PERIOD)).unwrap();
    for k in 0..8000 {
        let t = PERIOD * f64::from(k);
        let rate = |i: usize| 1.0 + 0.3 * i as f64;
        let y = core::array::from_fn(|i| 0.4 * (rate(i) * t).sin());
        let v = core::array::from_fn(|i| 0.4 * rate(i) * (rate(i) * t).cos());
        let a = core::array::from_fn(|i| -0.4 * rate(i) * rate(i) * (rate(i) * t).sin());
        let described = DescribedForces::of(robot, &y, &v, &a);
        let torques = core::array::from_fn(|i| {
            described.forces[i]
                + (friction - 1.0) * described.friction[i]
                + (of_load - 1.0) * described.load_friction[i]
        });
        let measured = Measured { positions: Some(y), torques, saturated: [false; N], periods: 1 };
        adaptation.step(&measured, |y, v, a| DescribedForces::of(robot, y, v, a));
    }
    for state in adaptation.states().into_iter().flatten() {
        assert_eq!(state.trust, Trust::Learned, "{state:?}");
    }
    adaptation
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * (1.0 + expected.abs()), "{found} is not {expected}");
}

fn moved<const K: usize>(x: &[f64; K], k: usize, by: f64) -> [f64; K] {
    core::array::from_fn(|i| if i == k { x[i] + by } else { x[i] })
}

/// Central difference of a function of a vector by its entry k.
fn difference<const K: usize, const N: usize>(
    x: &[f64; K],
    k: usize,
    f: impl Fn(&[f64; K]) -> [f64; N],
) -> [f64; N] {
    let (high, low) = (f(&moved(x, k, 1e-5)), f(&moved(x, k, -1e-5)));
    core::array::from_fn(|i| (high[i] - low[i]) / 2e-5)
}

/// States and inputs near holding torques, with velocities that are not at rest.
fn agrees<D: Discretizable<N, N>, const N: usize>(robot: &LearnedFriction<D, N, N>, seed: u64) {
    let mut random = SplitMix64::new(seed);
    for _ in 0..20 {
        let y: [f64; N] = core::array::from_fn(|_| random.normal());
        let v: [f64; N] = core::array::from_fn(|_| (0.1 + random.uniform()) * random.normal().signum());
        let a: [f64; N] = core::array::from_fn(|_| random.normal());
        let (forces, matrix) = (robot.inverse_dynamics(&y, &v, &a), robot.drive_matrix());
        let inverse = SMatrix::<f64, N, N>::from_fn(|i, j| matrix[i][j]).try_inverse().unwrap();
        let u: [f64; N] = (inverse * SVector::from(forces)).into();
        let found = robot.forward_dynamics(&y, &v, &u);
        (0..N).for_each(|i| close(found[i], a[i], 1e-8));

        let linear = robot.linearize(&y, &v, &u);
        let (inverse, mass) = robot.inverse_dynamics_derivatives_and_mass_matrix(&y, &v, &a);
        let only = robot.inverse_dynamics_derivatives(&y, &v, &a);
        assert_eq!(inverse, only);
        for k in 0..N {
            let forward = [
                difference(&y, k, |y| robot.forward_dynamics(y, &v, &u)),
                difference(&v, k, |v| robot.forward_dynamics(&y, v, &u)),
                difference(&u, k, |u| robot.forward_dynamics(&y, &v, u)),
            ];
            let backward = [
                difference(&y, k, |y| robot.inverse_dynamics(y, &v, &a)),
                difference(&v, k, |v| robot.inverse_dynamics(&y, v, &a)),
                difference(&a, k, |a| robot.inverse_dynamics(&y, &v, a)),
            ];
            for i in 0..N {
                let found = [linear.by_coordinates, linear.by_velocities, linear.by_inputs].map(|d| d[i][k]);
                (0..3).for_each(|d| close(found[d], forward[d][i], 1e-4));
                let found = [inverse.by_coordinates, inverse.by_velocities, mass].map(|d| d[i][k]);
                (0..3).for_each(|d| close(found[d], backward[d][i], 1e-4));
            }
        }
        let found = linear.accelerations(&y, &v, &u);
        (0..N).for_each(|i| close(found[i], a[i], 1e-7));
        let [_, velocities] = <[_; 2]>::from(robot.step(&y, &v, &u, 1e-4));
        (0..N).for_each(|i| close(velocities[i], v[i] + 1e-4 * a[i], 1e-3));
    }
}

#[test]
fn functions_agree() {
    let robot = LearnedFriction::new(PowerCube, &taught(&PowerCube, 0.75, 1.0)).unwrap();
    agrees(&robot, 1);
    let robot = LearnedFriction::new(GearedArm, &taught(&GearedArm, 0.8, 1.4)).unwrap();
    agrees(&robot, 2);
    // Its friction at joint 5 depends on the velocity of joint 6.
    let robot = LearnedFriction::new(CoupledWrist, &taught(&CoupledWrist, 0.75, 1.0)).unwrap();
    agrees(&robot, 3);
}

/// The learned forces against the equations of motion, written out.
#[test]
fn the_factor_of_load_dependent_friction_is_learned() {
    let adaptation = taught(&GearedArm, 0.8, 1.4);
    for state in adaptation.states().into_iter().flatten() {
        println!("{:?} ± {:?}", state.learned, state.half_widths);
        let load = state.terms().last().unwrap();
        assert_eq!(load.name, "load");
        assert!((load.learned - 0.4).abs() <= load.half_width && load.half_width < 0.2, "{load:?}");
    }
    let robot = LearnedFriction::new(GearedArm, &adaptation).unwrap();
    let mut random = SplitMix64::new(4);
    for _ in 0..100 {
        let [y, v, a]: [[f64; 2]; 3] = core::array::from_fn(|_| core::array::from_fn(|_| random.normal()));
        let mass = GearedArm.mass_matrix(&y);
        let (coriolis, gravity) = (GearedArm.coriolis_forces(&y, &v), GearedArm.gravity_forces(&y));
        let (springs, friction) = (GearedArm.spring_forces(&y, &v), GearedArm.friction_torques(&y, &v));
        let (shares, found) = (GearedArm.load_friction(&y, &v), robot.inverse_dynamics(&y, &v, &a));
        for i in 0..2 {
            let load = mass[i][0] * a[0] + mass[i][1] * a[1] + coriolis[i] - gravity[i] - springs[i];
            let expected = load + 0.8 * friction[i] + 1.4 * load.abs() * shares[i];
            let allowed = 0.05 * (friction[i].abs() + (load * shares[i]).abs()) + 0.02;
            assert!((found[i] - expected).abs() <= allowed, "{} is not {expected}", found[i]);
        }
    }
}

/// Robots without load-dependent friction have no such term.
#[test]
fn joints_without_described_load_dependent_friction_do_not_learn_it() {
    let adaptation = taught(&PowerCube, 0.75, 1.0);
    for state in adaptation.states().into_iter().flatten() {
        assert_eq!((state.terms().count(), state.learned[TERMS - 1]), (TERMS - 1, 0.0));
    }
}

/// The law of the load is zero at the neutral position and at rest.
#[test]
fn load_dependent_friction_is_found_if_it_is_zero_at_the_neutral_position() {
    let scale = |load: f64| {
        let magnitudes = Magnitudes { speed: 1.0, effort: 10.0, range: f64::INFINITY };
        let scale = magnitudes.scale(0, |v: &[f64; 1]| v[0]);
        let described = |y: &[f64; 1], v: &[f64; 1], a: &[f64; 1]| {
            DescribedForces::new([2.0 * a[0] + v[0]], *v, &[load * y[0].sin() * (20.0 * v[0]).tanh()])
        };
        Adaptation::new([scale], AdaptationSettings::new(PERIOD), described).unwrap().scales()[0].unwrap()
    };
    assert!(scale(0.1).is_loaded && !scale(0.0).is_loaded);
}
