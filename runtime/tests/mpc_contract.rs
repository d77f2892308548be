//! Contract of the predictive controllers except tracking.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::tracking::{PERIOD, PowerCube, options};
use gelenk_runtime::control_loop::{Controller, ControllerFault, Cycle};
use gelenk_runtime::dynamics::{
    Differentiable, Discretizable, Dynamics, ForceDerivatives, LimitRows, Limits, Linearization, PhaseSpace,
};
use gelenk_runtime::lqr::Lqr;
use gelenk_runtime::mpc::{
    DisturbanceObserver, LinearizationPoint, LtvMpc, MpcError, MpcNote, MpcOptions, Nmpc, ObserverOptions,
    PredictionRule,
};
use gelenk_runtime::trajectory::RestToRest;

type Ltv = LtvMpc<PowerCube, RestToRest<2>, 2, 2, 4>;

fn motion() -> RestToRest<2> {
    RestToRest::new([0.1, -0.2], [0.5, 0.4], 2.0).unwrap()
}

fn cycle(time: f64, positions: Option<[f64; 2]>) -> Cycle<2, 2> {
    Cycle { time, periods: u32::from(time > 0.0), positions, last_inputs: [0.0; 2], ..Cycle::default() }
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
    let refuse = |change: fn(&mut MpcOptions<2, 2>)| {
        let mut options = options(&PowerCube, PERIOD, 10);
        change(&mut options);
        Ltv::new(PowerCube, motion(), options).unwrap_err().to_string()
    };
    assert_eq!(refuse(|o| o.period = 0.0), "period is 0, but must be positive and finite (s)");
    assert_eq!(refuse(|o| o.horizon = 200), "the horizon is 200 stages, but must be 1 to 100");
    assert!(refuse(|o| o.position_weight[1] = -1.0).contains("position_weight[1] is -1"));
    assert!(refuse(|o| o.input_weight = [0.0; 2]).contains("input_weight"));
    assert!(refuse(|o| o.velocity_limits[0] = f64::NAN).contains("velocity_limits"));
    assert!(
        refuse(|o| o.input_limits[0] = [1.0, -1.0]).contains("input_limits (upper minus lower)[0] is -2")
    );
    assert!(refuse(|o| o.observer.encoder_noise[0] = 0.0).contains("encoder_noise"));
}

#[test]
fn measurements_that_are_not_numbers_give_a_fault_and_no_input() {
    let mut mpc = Ltv::new(PowerCube, motion(), options(&PowerCube, PERIOD, 10)).unwrap();
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    let fault = mpc.step(&cycle(0.0, Some([f64::NAN, 0.0]))).unwrap_err();
    assert_eq!(fault, ControllerFault::NotFinite);
    assert!(mpc.planned(1).is_none());
    // A reset makes it usable again, and so do finite measurements.
    let mut going_on = mpc.clone();
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    let after_reset = mpc.step(&cycle(0.0, Some([0.1, -0.2]))).unwrap();
    let next = cycle(0.0, Some([0.1, -0.2]));
    let mut commands = (0..3).map(|_| going_on.step(&next));
    let last = commands.by_ref().last().unwrap().unwrap();
    for i in 0..2 {
        assert!((last.inputs[i] - after_reset.inputs[i]).abs() < 1e-6);
    }
}

/// Checks the answer of a step to any reading: inputs within the limits and a plan of such inputs, or a fault
/// and no plan.
fn answer(mpc: &mut impl Controller<2, 2>, cycle: &Cycle<2, 2>, limit: f64) -> bool {
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    let within = |inputs: [f64; 2]| inputs.iter().all(|u| u.is_finite() && u.abs() <= limit);
    let plan = |mpc: &_, k| Controller::planned(mpc, k);
    if let Ok(command) = mpc.step(cycle) {
        assert!(within(command.inputs), "{cycle:?} {command:?}");
        assert!((0..5).all(|k| plan(mpc, k).is_some_and(within)), "{cycle:?}");
        true
    } else {
        assert!((0..5).all(|k| plan(mpc, k).is_none()), "{cycle:?}");
        false
    }
}

/// Readings from sane to the largest number, with and without limits of the inputs, early and late.
#[test]
fn absurd_readings_give_finite_inputs_within_the_limits_or_a_fault() {
    let mut answers = [0, 0];
    for limit in [0.5, 1e300, f64::INFINITY] {
        let mut options = options(&PowerCube, PERIOD, 5);
        options.input_limits = [[-limit, limit]; 2];
        options.observer.velocity_sensor_noise = Some([1e-3; 2]);
        let mut linear = Ltv::new(PowerCube, motion(), options.clone()).unwrap();
        let mut nonlinear = Nmpc::new(PowerCube, motion(), options).unwrap();
        for power in (0..309).step_by(14) {
            let absurd = 10.0_f64.powi(power);
            for (q, v) in [(absurd, 0.0), (0.1, -absurd), (-absurd, absurd)] {
                let cycle = Cycle {
                    velocities: Some([v, 0.0]),
                    ..cycle(f64::from(power % 2) * PERIOD, Some([q, -0.2]))
                };
                answers[usize::from(answer(&mut linear, &cycle, limit))] += 1;
                answers[usize::from(answer(&mut nonlinear, &cycle, limit))] += 1;
            }
        }
        for (time, last) in [(f64::NAN, 0.0), (f64::INFINITY, 0.0), (0.0, f64::INFINITY)] {
            let cycle = Cycle { last_inputs: [last, 0.0], ..cycle(time, Some([0.1, -0.2])) };
            assert!(!answer(&mut linear, &cycle, limit));
            assert!(!answer(&mut nonlinear, &cycle, limit));
        }
        // A reset makes it usable again.
        let sane = cycle(0.0, Some([0.1, -0.2]));
        assert!(answer(&mut linear, &sane, limit) && answer(&mut nonlinear, &sane, limit));
    }
    assert!(answers.iter().all(|n| *n > 20), "{answers:?}");
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
        let mut mpc = Nmpc::new(PowerCube, motion(), options).unwrap();
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
        let mut mpc = Nmpc::new(PowerCube, motion(), options).unwrap();
        mpc.reset(&[0.1, -0.2], &[0.0; 2]);
        mpc
    };
    let (mut whole, mut parts) = (new(), new());
    for k in 0..20 {
        let cycle = cycle(f64::from(k) * PERIOD, Some([0.1 + 1e-3 * f64::from(k), -0.2]));
        let (split, whole) = (parts.feedback(&cycle).unwrap(), whole.step(&cycle).unwrap());
        // Equal but for the last bits of the time at which the prepared period begins.
        for i in 0..2 {
            assert!((split.inputs[i] - whole.inputs[i]).abs() < 1e-12);
        }
        parts.prepare(cycle.time);
    }
}

/// A trajectory beyond the soft limits is followed as far as they allow, and this is said beforehand, by
/// joint and number.
#[test]
fn a_trajectory_beyond_the_soft_limits_is_noted() {
    let notes = |change: fn(&mut MpcOptions<2, 2>)| -> Vec<String> {
        let mut options = options(&PowerCube, PERIOD, 10);
        change(&mut options);
        let mpc = Ltv::new(PowerCube, motion(), options.clone()).unwrap();
        let nonlinear = Nmpc::new(PowerCube, motion(), options).unwrap();
        assert_eq!(mpc.notes(), nonlinear.notes());
        let of_limits = |note: &&MpcNote| !matches!(note, MpcNote::DryFriction { .. });
        let notes = mpc.notes().iter().filter(of_limits);
        notes.map(ToString::to_string).collect()
    };
    assert!(notes(|_| {}).is_empty());
    // 0.6 rad in 2 s by a polynomial of degree 5: 15/8 of the mean speed in the middle.
    assert_eq!(
        notes(|o| o.velocity_limits = [0.375, 0.4]),
        [
            "at 1.000 s the trajectory moves joint gamma at 0.5625 rad/s (or m/s), above its soft limit of 0.4000. The robot will \
             lag behind. Slow the trajectory down, or raise `velocity_limits`"
        ]
    );
    assert_eq!(
        notes(|o| o.position_limits[0] = [0.2, 0.6]),
        [
            "at 0.000 s the trajectory has joint beta at 0.1000 rad (or m), outside its soft limits of 0.2000 to 0.6000. The controller \
             will stop the joint near the limit. Change the trajectory, or `position_limits`"
        ]
    );
}

/// The published friction of joint gamma has 0.492 sign(v) in addition to tanh(100 v); that of beta is smooth.
#[test]
fn friction_that_jumps_is_noted() {
    let mpc = Ltv::new(PowerCube, motion(), options(&PowerCube, PERIOD, 10)).unwrap();
    let notes: Vec<String> = mpc.notes().iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        [
            "the friction of joint gamma jumps by 0.984 N m (or N) at rest, so the joint may stop before its goal. Linear \
             predictions cannot represent the jump. Generate a smooth model with `--control-model`"
        ]
    );
    let smooth = LightWrist { viscous: [1e3; 2] };
    let options = MpcOptions::new(&smooth, 1e-3, 5);
    let mpc = LtvMpc::new(smooth, motion(), options).unwrap();
    assert!(mpc.notes().is_empty(), "{:?}", mpc.notes());
}

/// A mass on ice, `ẏ` and `u` in SI units.
mod mass {
    pub const N: usize = 1;
    pub const M: usize = 1;
    pub const FUNCTIONS: [&str; 2] = ["inverse_dynamics_derivatives", "linearize"];
    pub const JOINT_NAMES: [&str; N] = ["mass"];
    pub const INPUT_NAMES: [&str; M] = ["force"];
    pub const POSITION_LIMITS: [[f64; 2]; N] = [[f64::NEG_INFINITY, f64::INFINITY]];
    pub const VELOCITY_LIMITS: [f64; N] = [f64::INFINITY];
    pub const EFFORT_LIMITS: [f64; N] = [f64::INFINITY];
    pub const PEAK_EFFORT_LIMITS: [f64; N] = [f64::INFINITY];
    pub const FRICTION_JUMPS: [[usize; 2]; 0] = [];
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

gelenk_runtime::dynamics!(struct Mass = mass);

#[test]
fn the_observer_converges_to_the_dual_of_the_regulator() {
    // Stationary Kalman gain of the augmented mass by duality: the regulator of (Aᵀ, Cᵀ) (Anderson, Moore,
    // Optimal Filtering, 1979, section 4.4).
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
    let before = [observer.positions()[0], observer.velocities()[0], observer.disturbance()[0]];
    observer.correct(&[before[0] + 1.0]);
    let gain = [
        observer.positions()[0] - before[0],
        observer.velocities()[0] - before[1],
        observer.disturbance()[0] - before[2],
    ];
    for i in 0..3 {
        let predicted: f64 = (0..3).map(|j| a[i][j] * gain[j]).sum();
        let expected = -dual.gain[0][i];
        assert!((predicted - expected).abs() <= 1e-6 * expected.abs(), "{i}: {predicted} and {expected}");
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

/// An arm of 1 kg m² and a wrist of 1e-6 kg m², with viscous friction.
#[derive(Debug, Clone, Copy)]
struct LightWrist {
    viscous: [f64; 2],
}

const INERTIA: [f64; 2] = [1.0, 1e-6];

fn diagonal(values: [f64; 2]) -> [[f64; 2]; 2] {
    [[values[0], 0.0], [0.0, values[1]]]
}

impl Dynamics<2, 2> for LightWrist {
    fn joint_names(&self) -> [&'static str; 2] {
        ["arm", "wrist"]
    }
    fn limits(&self) -> Limits<2, 2> {
        Limits {
            position: [[-3.0, 3.0]; 2],
            velocity: [2.0; 2],
            effort: [f64::INFINITY; 2],
            peak_effort: [f64::INFINITY; 2],
            input: [[-1e6, 1e6]; 2],
            peak_input: [[-1e6, 1e6]; 2],
            dependent: &[],
            torque_speed: &[],
        }
    }
    fn mass_matrix(&self, _: &[f64; 2]) -> [[f64; 2]; 2] {
        diagonal(INERTIA)
    }
    fn coriolis_forces(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn gravity_forces(&self, _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn spring_forces(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn friction_torques(&self, _: &[f64; 2], v: &[f64; 2]) -> [f64; 2] {
        [self.viscous[0] * v[0], self.viscous[1] * v[1]]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[]
    }
    fn input_matrix(&self, _: &[f64; 2]) -> [[f64; 2]; 2] {
        diagonal([1.0; 2])
    }
}

impl Differentiable<2, 2> for LightWrist {
    fn inverse_dynamics_derivatives(&self, y: &[f64; 2], v: &[f64; 2], a: &[f64; 2]) -> ForceDerivatives<2> {
        ForceDerivatives {
            forces: self.inverse_dynamics(y, v, a),
            by_coordinates: [[0.0; 2]; 2],
            by_velocities: diagonal(self.viscous),
        }
    }
    fn linearize(&self, _: &[f64; 2], _: &[f64; 2], _: &[f64; 2]) -> Linearization<2, 2> {
        let over = |x: [f64; 2]| diagonal([x[0] / INERTIA[0], x[1] / INERTIA[1]]);
        Linearization {
            by_coordinates: [[0.0; 2]; 2],
            by_velocities: over(self.viscous.map(|d| -d)),
            by_inputs: over([1.0; 2]),
            affine: [0.0; 2],
        }
    }
}

impl Discretizable<2, 2> for LightWrist {}

impl PhaseSpace<4> for LightWrist {}

impl LimitRows<0> for LightWrist {}

/// Rates of 1e9 1/s over 0.1 s have no zero-order hold: the controller is refused, or faults where its model
/// is replaced in operation, by joint, slope and period. Rates of 1e8 1/s have one.
#[test]
fn a_joint_too_fast_for_the_period_is_named() {
    let bearable = LightWrist { viscous: [1.0, 100.0] };
    let steep = LightWrist { viscous: [1.0, 1000.0] };
    let options = MpcOptions::new(&steep, 0.1, 5);
    let motion = || RestToRest::new([0.0, 0.0], [0.1, 0.1], 1.0).unwrap();
    let expected = "the motion of joint wrist cannot be predicted over a period of 0.1 s. The slope of its force over its speed, \
                    1.000e3 N m s/rad (or N s/m), causes a rate of 1.0e9 1/s. Use a model with less steep friction";
    let linear = LtvMpc::new(steep, motion(), options.clone());
    let nonlinear = Nmpc::new(steep, motion(), options.clone());
    for error in [linear.unwrap_err(), nonlinear.unwrap_err()] {
        assert_eq!(error.to_string(), format!("at 0 s of the trajectory, {expected}"));
    }
    for linearization in [LinearizationPoint::Plan, LinearizationPoint::Reference] {
        let options = MpcOptions { linearization, ..options.clone() };
        let mut mpc = LtvMpc::new(bearable, motion(), options).unwrap();
        assert!(mpc.step(&cycle(0.0, Some([0.0; 2]))).is_ok());
        mpc.set_model(steep).unwrap();
        let fault = mpc.step(&cycle(0.1, Some([0.0; 2]))).unwrap_err();
        assert_eq!(fault.to_string(), expected);
        assert!(mpc.planned(1).is_none());
        mpc.set_model(bearable).unwrap();
        assert!(mpc.step(&cycle(0.2, Some([0.0; 2]))).is_ok());
    }
}

/// Friction of the wrist stops it within 1e-8 s: by the midpoint rule its velocity alternates.
#[test]
fn a_joint_that_is_too_steep_for_the_midpoint_rule_is_noted() {
    let model = LightWrist { viscous: [1.0, 100.0] };
    let motion = || RestToRest::new([0.0, 0.0], [0.1, 0.1], 1.0).unwrap();
    let notes = |prediction| {
        let options = MpcOptions { prediction, ..MpcOptions::new(&model, 0.1, 5) };
        LtvMpc::new(model, motion(), options).unwrap().notes().to_vec()
    };
    let [MpcNote::Alternating { joint: "wrist", share }] = notes(PredictionRule::ImplicitMidpoint)[..] else {
        panic!("{:?}", notes(PredictionRule::ImplicitMidpoint));
    };
    assert!((-1.0..-0.99).contains(&share), "{share}");
    assert_eq!(notes(PredictionRule::ExactHold), []);
}
