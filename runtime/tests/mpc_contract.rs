//! What the predictive controllers promise beyond tracking.

#![allow(clippy::unwrap_used, reason = "test code")]

#[path = "support/tracking.rs"]
mod tracking;

use gelenk_runtime::control_loop::{Controller, ControllerFault, Cycle};
use gelenk_runtime::lqr::Lqr;
use gelenk_runtime::mpc::{DisturbanceObserver, LtvMpc, MpcError, Nmpc, ObserverOptions};
use gelenk_runtime::trajectory::RestToRest;
use tracking::{PERIOD, PowerCube, options};

type Ltv = LtvMpc<PowerCube, RestToRest<2>, 2, 2, 4>;

fn motion() -> RestToRest<2> {
    RestToRest::new([0.1, -0.2], [0.5, 0.4], 2.0).unwrap()
}

fn cycle(time: f64, positions: Option<[f64; 2]>) -> Cycle<2, 2> {
    Cycle {
        time,
        periods: u32::from(time > 0.0),
        positions,
        last_inputs: [0.0; 2],
        ..Cycle::default()
    }
}

#[test]
fn horizons_from_one_to_a_hundred() {
    for horizon in [1, 2, 50, 100] {
        let mut mpc = Ltv::new(PowerCube, motion(), options(&PowerCube, PERIOD, horizon)).unwrap();
        mpc.reset(&[0.1, -0.2], &[0.0; 2]);
        let command = mpc.step(&cycle(0.0, Some([0.1, -0.2]))).unwrap();
        assert!(command.inputs.iter().all(|u| u.abs() <= 0.5));
        assert_eq!(mpc.planned(0), Some(command.inputs));
        assert!(mpc.planned(horizon as u32).is_none());
        assert!(mpc.planned(horizon as u32 - 1).is_some());
    }
    for horizon in [0, 101] {
        let refused = Ltv::new(PowerCube, motion(), options(&PowerCube, PERIOD, horizon));
        assert!(matches!(refused, Err(MpcError::Qp(_))));
    }
}

#[test]
fn senseless_options_are_refused_by_name() {
    let refuse = |change: fn(&mut gelenk_runtime::mpc::MpcOptions<2, 2>)| {
        let mut options = options(&PowerCube, PERIOD, 10);
        change(&mut options);
        Ltv::new(PowerCube, motion(), options)
            .unwrap_err()
            .to_string()
    };
    assert!(refuse(|o| o.period = 0.0).contains("period"));
    assert!(refuse(|o| o.position_weight[1] = -1.0).contains("position_weight[1] is -1"));
    assert!(refuse(|o| o.input_weight = [0.0; 2]).contains("input_weight"));
    assert!(refuse(|o| o.velocity_limits[0] = f64::NAN).contains("velocity_limits"));
    assert!(refuse(|o| o.input_limits[0] = [1.0, -1.0]).contains("lower before upper"));
    assert!(refuse(|o| o.observer.encoder_noise[0] = 0.0).contains("encoder_noise"));
}

#[test]
fn measurements_that_are_not_numbers_give_a_fault_and_no_input() {
    let mut mpc = Ltv::new(PowerCube, motion(), options(&PowerCube, PERIOD, 10)).unwrap();
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    let fault = mpc.step(&cycle(0.0, Some([f64::NAN, 0.0]))).unwrap_err();
    assert_eq!(fault, ControllerFault::NotFinite);
    assert!(mpc.planned(1).is_none());
    // A reset makes it usable again.
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    assert!(mpc.step(&cycle(0.0, Some([0.1, -0.2]))).is_ok());
}

#[test]
fn without_a_measurement_the_model_goes_on() {
    let mut mpc = Ltv::new(PowerCube, motion(), options(&PowerCube, PERIOD, 10)).unwrap();
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    for k in 0..5 {
        assert!(mpc.step(&cycle(f64::from(k) * PERIOD, None)).is_ok());
    }
}

#[test]
fn the_same_measurements_give_the_same_bits() {
    let inputs = || {
        let options = options(&PowerCube, PERIOD, 10);
        let mut mpc = Nmpc::<_, _, 2, 2, 4>::new(PowerCube, motion(), options).unwrap();
        mpc.reset(&[0.1, -0.2], &[0.0; 2]);
        (0..20)
            .map(|k| {
                let command = mpc.step(&cycle(f64::from(k) * PERIOD, Some([0.1, -0.2])));
                command.unwrap().inputs.map(f64::to_bits)
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(inputs(), inputs());
}

#[test]
fn preparation_and_feedback_are_the_step() {
    let new = || {
        let options = options(&PowerCube, PERIOD, 10);
        let mut mpc = Nmpc::<_, _, 2, 2, 4>::new(PowerCube, motion(), options).unwrap();
        mpc.reset(&[0.1, -0.2], &[0.0; 2]);
        mpc
    };
    let (mut whole, mut parts) = (new(), new());
    for k in 0..20 {
        let cycle = cycle(
            f64::from(k) * PERIOD,
            Some([0.1 + 1e-3 * f64::from(k), -0.2]),
        );
        let (split, whole) = (parts.feedback(&cycle).unwrap(), whole.step(&cycle).unwrap());
        // Equal but for the last bits of the time at which the prepared period begins.
        for i in 0..2 {
            assert!((split.inputs[i] - whole.inputs[i]).abs() < 1e-12);
        }
        parts.prepare(cycle.time);
    }
}

/// A mass on ice, `ẏ` and `u` in SI units.
mod mass {
    pub const N: usize = 1;
    pub const M: usize = 1;
    pub const JOINT_NAMES: [&str; N] = ["mass"];
    pub const INPUT_NAMES: [&str; M] = ["force"];
    pub const POSITION_LIMITS: [[f64; 2]; N] = [[f64::NEG_INFINITY, f64::INFINITY]];
    pub const VELOCITY_LIMITS: [f64; N] = [f64::INFINITY];
    pub const EFFORT_LIMITS: [f64; N] = [f64::INFINITY];
    pub const PEAK_EFFORT_LIMITS: [f64; N] = [f64::INFINITY];
    pub const INPUT_LIMITS: [f64; M] = [f64::INFINITY];
    pub const PEAK_INPUT_LIMITS: [f64; M] = [f64::INFINITY];

    pub fn mass_matrix(_: &[f64; N]) -> [[f64; N]; N] {
        [[2.0]]
    }
    pub fn coriolis_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [0.0]
    }
    pub fn gravity_forces(_: &[f64; N]) -> [f64; N] {
        [0.0]
    }
    pub fn spring_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [0.0]
    }
    pub fn friction_torques(_: &[f64; N]) -> [f64; N] {
        [0.0]
    }
    pub fn input_matrix() -> [[f64; M]; N] {
        [[1.0]]
    }
    pub fn inverse_dynamics_derivatives(
        _: &[f64; N],
        _: &[f64; N],
        a: &[f64; N],
    ) -> ([f64; N], [[f64; N]; N], [[f64; N]; N]) {
        ([2.0 * a[0]], [[0.0]], [[0.0]])
    }
    #[allow(clippy::type_complexity, reason = "as generated")]
    pub fn linearize(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; M],
    ) -> ([[f64; N]; N], [[f64; N]; N], [[f64; M]; N], [f64; N]) {
        ([[0.0]], [[0.0]], [[0.5]], [0.0])
    }
}

gelenk_runtime::dynamics!(struct Mass = mass: Dynamics [
    mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques, input_matrix
] + Differentiable + Discretizable []);

#[test]
fn the_observer_converges_to_the_dual_of_the_regulator() {
    // Stationary Kalman gain of the augmented mass by duality: the regulator of (Aᵀ, Cᵀ) (Anderson, Moore, Optimal Filtering, 1979, section 4.4).
    let noise = ObserverOptions {
        encoder_noise: [1e-3],
        velocity_noise: [2e-3],
        disturbance_noise: [5e-2],
        ..ObserverOptions::default()
    };
    let t = 0.02;
    let a = [[1.0, t, 0.25 * t * t], [0.0, 1.0, 0.5 * t], [0.0, 0.0, 1.0]];
    let transposed: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]));
    let q = [[0.0; 3], [0.0, 4e-6, 0.0], [0.0, 0.0, 2.5e-3]];
    let dual = Lqr::new(&transposed, &[[1.0], [0.0], [0.0]], &q, &[[1e-6]]).unwrap();
    // −K = Cᵀ gain of the predicted estimate; the filter's corrects before predicting: A L = −Kᵀ.
    let mut observer = DisturbanceObserver::<1, 1>::new(noise).unwrap();
    for _ in 0..2000 {
        observer.predict(&Mass, &[0.0], t, 1);
        observer.correct(&[0.0]);
    }
    observer.predict(&Mass, &[0.0], t, 1);
    let before = [
        observer.positions()[0],
        observer.velocities()[0],
        observer.disturbance()[0],
    ];
    observer.correct(&[before[0] + 1.0]);
    let gain = [
        observer.positions()[0] - before[0],
        observer.velocities()[0] - before[1],
        observer.disturbance()[0] - before[2],
    ];
    for i in 0..3 {
        let predicted: f64 = (0..3).map(|j| a[i][j] * gain[j]).sum();
        let expected = -dual.gain[0][i];
        assert!(
            (predicted - expected).abs() <= 1e-6 * expected.abs(),
            "{i}: {predicted} and {expected}"
        );
    }
}

#[test]
fn the_observer_finds_a_constant_force() {
    let noise = ObserverOptions {
        encoder_noise: [1e-5],
        velocity_noise: [1e-4],
        disturbance_noise: [1e-2],
        ..ObserverOptions::default()
    };
    let mut observer = DisturbanceObserver::<1, 1>::new(noise).unwrap();
    let t = 0.01;
    for k in 1..=500 {
        observer.predict(&Mass, &[0.0], t, 1);
        let time = f64::from(k) * t;
        // 3 N on 2 kg.
        observer.correct(&[0.75 * time * time]);
    }
    assert!((observer.disturbance()[0] - 3.0).abs() < 1e-3);
    assert!((observer.velocities()[0] - 7.5).abs() < 1e-3);
}
