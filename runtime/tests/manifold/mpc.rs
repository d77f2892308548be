//! Predictive control on the error state.

use super::Quadrotor;
use gelenk_runtime::control_loop::{Controller, ControllerFault, Cycle};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{
    DisturbanceObserver, LinearizationPoint, LtvMpc, MpcError, MpcOptions, MpcRow, Nmpc, ObserverOptions,
    PredictionRule,
};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, Trajectory};

type Motion = GeodesicMotion<Quadrotor, 6, 4, 7>;

const PERIOD: f64 = 0.03;
const HOVER: [f64; 7] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// m g in equal parts, but for the propellers' unequal arms.
const INPUTS: [f64; 4] = [3.7; 4];

fn hover(duration: f64) -> Motion {
    Motion::between(Quadrotor, HOVER, HOVER, duration).unwrap()
}

fn options() -> MpcOptions<6, 4> {
    MpcOptions {
        position_weight: [100.0, 100.0, 100.0, 10.0, 10.0, 10.0],
        velocity_weight: [10.0, 10.0, 10.0, 1.0, 1.0, 1.0],
        input_weight: [0.1; 4],
        ..MpcOptions::new(&Quadrotor, PERIOD, 20)
    }
}

fn deviation(y: &[f64; 7], from: &[f64; 7]) -> [f64; 2] {
    let d = Quadrotor.difference(from, y);
    let length = |part: &[f64]| part.iter().map(|d| d * d).sum::<f64>().sqrt();
    [length(&d[..3]), length(&d[3..])]
}

/// Deviations of position [m] and attitude [rad] after each period, and the least height of the body's
/// vertical axis (−1: upside down).
struct Flight {
    deviations: Vec<[f64; 2]>,
    lowest_axis: f64,
}

fn fly(
    controller: &mut impl Controller<6, 4, 7>,
    motion: &Motion,
    start: ([f64; 7], [f64; 6]),
    duration: f64,
) -> Flight {
    let options = PlantOptions { input_limits: [[0.0, 8.0]; 4], ..PlantOptions::default() };
    let mut plant = Plant::new(Quadrotor, options).unwrap();
    plant.reset(start.0, start.1).unwrap();
    controller.reset(&start.0, &INPUTS);
    let mut flight = Flight { deviations: Vec::new(), lowest_axis: 1.0 };
    let mut last_inputs = INPUTS;
    for k in 0..(duration / PERIOD) as u32 {
        let time = PERIOD * f64::from(k);
        let measured = plant.measure().positions;
        let cycle = Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(measured),
            velocities: Some(plant.state().1),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle).unwrap().inputs;
        assert!(last_inputs.iter().all(|u| (0.0..=8.0).contains(u)), "{last_inputs:?}");
        plant.apply(&last_inputs, PERIOD).unwrap();
        let (y, _) = plant.state();
        flight.deviations.push(deviation(&y, &motion.sample(time + PERIOD).positions));
        flight.lowest_axis = flight.lowest_axis.min(1.0 - 2.0 * (y[3] * y[3] + y[4] * y[4]));
    }
    flight
}

fn observed(options: MpcOptions<6, 4>) -> MpcOptions<6, 4> {
    let observer = ObserverOptions { velocity_sensor_noise: Some([1e-5; 6]), ..ObserverOptions::default() };
    MpcOptions { observer, ..options }
}

fn assert_arrived(flight: &Flight, bound: f64) {
    let [position, attitude] = *flight.deviations.last().unwrap();
    assert!(position <= bound && attitude <= bound, "{position:e} m, {attitude:e} rad are left");
}

/// Thrown, turned by 170° about a tilted axis and spinning: both controllers come back to hovering.
#[test]
fn thrown_upside_down_it_recovers() {
    let angle = 170.0_f64.to_radians() / 2.0;
    let [x, y] = [0.8 * angle.sin(), 0.6 * angle.sin()];
    let start = ([0.0, 0.0, 1.0, x, y, 0.0, angle.cos()], [0.5, -0.5, 1.0, 0.5, -1.0, 0.3]);
    let motion = hover(1.0);
    for prediction in [PredictionRule::ExactHold, PredictionRule::ImplicitMidpoint] {
        let options = MpcOptions { prediction, ..observed(options()) };
        let mut ltv = LtvMpc::new(Quadrotor, motion.clone(), options).unwrap();
        let flight = fly(&mut ltv, &motion, start, 4.5);
        assert!(flight.lowest_axis < -0.9);
        assert_arrived(&flight, 1e-3);
    }
    let mut nonlinear = Nmpc::new(Quadrotor, motion.clone(), observed(options())).unwrap();
    assert_arrived(&fly(&mut nonlinear, &motion, start, 4.5), 1e-3);
}

/// A flight by 1.5 m with a turn about the vertical axis: no offset is left, and the way is not far from the reference.
#[test]
fn it_follows_a_motion_of_position_and_heading() {
    let goal = [1.5, -0.5, 1.4, 0.0, 0.0, 0.6, 0.8];
    let motion = Motion::between(Quadrotor, HOVER, goal, 3.0).unwrap();
    let along = MpcOptions { linearization: LinearizationPoint::Reference, ..observed(options()) };
    let by_midpoint = MpcOptions { prediction: PredictionRule::ImplicitMidpoint, ..along.clone() };
    let mut ltv = LtvMpc::new(Quadrotor, motion.clone(), along).unwrap();
    let mut midpoint = LtvMpc::new(Quadrotor, motion.clone(), by_midpoint).unwrap();
    let mut nonlinear = Nmpc::new(Quadrotor, motion.clone(), observed(options())).unwrap();
    let flights = [
        fly(&mut ltv, &motion, (HOVER, [0.0; 6]), 4.5),
        fly(&mut midpoint, &motion, (HOVER, [0.0; 6]), 4.5),
        fly(&mut nonlinear, &motion, (HOVER, [0.0; 6]), 4.5),
    ];
    for flight in &flights {
        let worst = flight.deviations.iter().map(|[position, _]| *position).fold(0.0, f64::max);
        assert!(worst <= 0.1, "{worst} m");
        assert_arrived(flight, 5e-4);
    }
}

/// A roll by a whole turn in the air, through upside down, along a reference that rolls.
#[test]
fn it_flips_through_half_a_turn() {
    let pose = |roll: f64| [0.0, 0.0, 1.0, (roll / 2.0).sin(), 0.0, 0.0, (roll / 2.0).cos()];
    let rolls = [0.0, 0.3, 1.8, 3.3, 4.8, 6.0, std::f64::consts::TAU];
    let points: Vec<(f64, [f64; 7])> =
        rolls.iter().zip([0.0, 0.25, 0.45, 0.6, 0.75, 0.95, 1.2]).map(|(roll, t)| (t, pose(*roll))).collect();
    let motion = Motion::through(Quadrotor, &points).unwrap();
    let weights = MpcOptions { position_weight: [3.0, 3.0, 3.0, 30.0, 30.0, 30.0], ..options() };
    let mut nonlinear = Nmpc::new(Quadrotor, motion.clone(), observed(weights.clone())).unwrap();
    let mut ltv = LtvMpc::new(Quadrotor, motion.clone(), observed(weights)).unwrap();
    let flights = [
        fly(&mut nonlinear, &motion, (HOVER, [0.0; 6]), 4.0),
        fly(&mut ltv, &motion, (HOVER, [0.0; 6]), 4.0),
    ];
    for flight in &flights {
        // Between two samples it turns by up to 0.3 rad.
        assert!(flight.lowest_axis < -0.95, "{}", flight.lowest_axis);
        let attitude = flight.deviations.iter().map(|[_, attitude]| *attitude).fold(0.0, f64::max);
        assert!(attitude <= 0.6, "{attitude} rad");
        assert_arrived(flight, 1e-2);
    }
}

/// The sign of a quaternion has no influence.
#[test]
fn both_signs_of_a_quaternion_are_the_same_measurement() {
    let commands = [1.0, -1.0].map(|sign| {
        let mut mpc = LtvMpc::new(Quadrotor, hover(1.0), options()).unwrap();
        mpc.reset(&HOVER, &INPUTS);
        let positions = Some([0.1, 0.0, 1.0, 0.0, sign * 0.28, 0.0, sign * 0.96]);
        mpc.step(&Cycle { positions, last_inputs: INPUTS, ..Cycle::default() }).unwrap().inputs
    });
    for (a, b) in commands[0].iter().zip(commands[1]) {
        assert!((a - b).abs() <= 1e-9, "{commands:?}");
    }
}

#[test]
fn measured_quaternions_that_are_no_attitudes_are_faults() {
    let mut mpc = LtvMpc::new(Quadrotor, hover(1.0), options()).unwrap();
    mpc.reset(&HOVER, &INPUTS);
    for bad in [[0.0; 4], [0.0, 0.0, 0.0, 2.0], [f64::NAN; 4]] {
        let mut y = HOVER;
        y[3..].copy_from_slice(&bad);
        let fault = mpc.step(&Cycle { positions: Some(y), ..Cycle::default() }).unwrap_err();
        assert!(matches!(fault, ControllerFault::Attitude(error) if error.joint == "base"), "{fault}");
        assert!(fault.to_string().contains("joint base"), "{fault}");
    }
    // Time went on as if nothing had been measured: it falls.
    let mut other = LtvMpc::new(Quadrotor, hover(1.0), options()).unwrap();
    other.reset(&HOVER, &INPUTS);
    for _ in 0..3 {
        assert_ne!(mpc.estimate(), other.estimate());
        other.step(&Cycle { positions: None, ..Cycle::default() }).unwrap();
    }
    assert_eq!(mpc.estimate(), other.estimate());
}

#[test]
fn limits_of_attitudes_are_refused() {
    let mut limited = options();
    limited.position_limits[2] = [0.0, 2.0];
    let error = LtvMpc::new(Quadrotor, hover(1.0), limited).map(|_| ()).unwrap_err();
    assert_eq!(error, MpcError::Limit { joint: "base" });
    let mut of_roll = [0.0; 6];
    of_roll[3] = 1.0;
    let row = MpcRow::new("tilt", of_roll, [0.0; 6], [0.0; 4], [-1.0, 1.0]);
    let error =
        Nmpc::new(Quadrotor, hover(1.0), options().with_rows([row])).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("tilt") && error.contains("joint base"), "{error}");
    // Rows of velocities and inputs are as ever.
    let row = MpcRow::new("thrust", [0.0; 6], [0.0; 6], [1.0; 4], [2.0, 20.0]);
    assert!(LtvMpc::new(Quadrotor, hover(1.0), options().with_rows([row])).is_ok());
}

/// From measured poses alone the filter finds the velocities of a tumbling body.
#[test]
fn the_observer_estimates_tumbling() {
    let mut plant =
        Plant::new(Quadrotor, PlantOptions { encoder_noise: [1e-4; 6], seed: 3, ..PlantOptions::default() })
            .unwrap();
    plant.reset(HOVER, [0.5, -0.3, 2.0, 3.0, -4.0, 2.0]).unwrap();
    let noise = ObserverOptions { encoder_noise: [1e-4; 6], ..ObserverOptions::default() };
    let mut observer = DisturbanceObserver::starting_at(&HOVER, noise).unwrap();
    observer.reset(&HOVER, &[0.0; 6]);
    let unknown = ObserverOptions { velocity_noise: [0.5; 6], ..noise };
    let mut loose: DisturbanceObserver<6, 4, 7> = DisturbanceObserver::starting_at(&HOVER, unknown).unwrap();
    for k in 0..150 {
        plant.apply(&INPUTS, 0.01).unwrap();
        // At first the velocities are unknown, later the model is trusted.
        loose.predict(&Quadrotor, &INPUTS, 0.01, 1);
        loose.correct_by(&Quadrotor, &plant.measure().positions);
        if k < 20 {
            observer.reset(loose.positions(), loose.velocities());
            continue;
        }
        observer.predict(&Quadrotor, &INPUTS, 0.01, 1);
        observer.correct_by(&Quadrotor, &plant.measure().positions);
    }
    let (y, v) = plant.state();
    let [position, attitude] = deviation(observer.positions(), &y);
    assert!(position <= 2e-4 && attitude <= 2e-4, "{position:e} m, {attitude:e} rad");
    let error = v.iter().zip(observer.velocities()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error <= 5e-3, "{error:e}");
}
