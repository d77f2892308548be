//! Control allocates nothing: ten thousand steps of each controller.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::allocations;
use crate::support::learning;
use crate::support::tracking::{PERIOD, PowerCube, options};
use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::lqr::{Lqr, TimeVaryingLqr};
use gelenk_runtime::mpc::{LinearizationPoint, LtvMpc, MpcRow, Nmpc, PredictionRule};
use gelenk_runtime::trajectory::RestToRest;

const STEPS: u32 = 10_000;

/// Steps with measurements that wander about the trajectory, are missing at times, and once are
/// not numbers.
fn drive(steps: u32, controller: &mut impl Controller<2, 2>, motion: &RestToRest<2>) {
    use gelenk_runtime::trajectory::Trajectory;
    let mut last = [0.0; 2];
    controller.reset(&motion.sample(0.0).positions, &last);
    let (mut solved, mut iterated, mut faults) = (0, 0, 0);
    let before = allocations::count();
    for k in 0..steps {
        let time = f64::from(k % 150) * PERIOD;
        if k % 150 == 0 {
            controller.reset(&motion.sample(0.0).positions, &last);
        }
        let wobble = 0.05 * (f64::from(k) * 0.37).sin();
        let mut positions = motion.sample(time).positions.map(|y| y + wobble);
        if k == 777 {
            positions[0] = f64::NAN;
        }
        let cycle = Cycle {
            time,
            periods: 1 + u32::from(k % 50 == 49),
            positions: (k % 11 != 5).then_some(positions),
            last_inputs: last,
            ..Cycle::default()
        };
        match controller.step(&cycle) {
            Ok(command) => {
                last = command.inputs;
                solved += 1;
                iterated += u32::from(command.iterations > 0);
            }
            Err(_) => faults += 1,
        }
        std::hint::black_box((
            controller.planned(1),
            controller.estimate(),
            controller.learned(&positions, &[0.1; 2]),
        ));
    }
    assert_eq!(allocations::count(), before);
    assert!(solved > steps - 200 && iterated > 100 && faults > 0, "{solved} {iterated} {faults}");
}

fn motion() -> RestToRest<2> {
    RestToRest::new([0.1, -0.2], [0.5, 0.4], 2.0).unwrap()
}

#[test]
fn linear_predictive_control_allocates_nothing() {
    let mut options = options(&PowerCube, PERIOD, 5);
    options.observer.disturbance_noise = [1e-3; 2];
    options.input_rate_weight = [1e-6; 2];
    let points = [LinearizationPoint::Reference, LinearizationPoint::Plan];
    let rules = [PredictionRule::ExactHold, PredictionRule::ImplicitMidpoint];
    for (point, rule) in points.into_iter().flat_map(|point| rules.map(|rule| (point, rule))) {
        (options.linearization, options.prediction) = (point, rule);
        options.delay = point == LinearizationPoint::Plan;
        let mut mpc = LtvMpc::new(PowerCube, motion(), options.clone()).unwrap();
        drive(STEPS, &mut mpc, &motion());
    }
}

#[test]
fn nonlinear_predictive_control_allocates_nothing() {
    let mut options = options(&PowerCube, PERIOD, 3);
    options.observer.disturbance_noise = [1e-3; 2];
    let mut mpc = Nmpc::new(PowerCube, motion(), options).unwrap();
    drive(STEPS, &mut mpc, &motion());
}

#[test]
fn controllers_that_learn_friction_allocate_nothing() {
    let options = options(&PowerCube, PERIOD, 3);
    let linear = |model| LtvMpc::new(model, motion(), options.clone()).unwrap();
    let nonlinear = |model| Nmpc::new(model, motion(), options.clone()).unwrap();
    drive(1000, &mut learning::made(1.0 / PERIOD, linear), &motion());
    drive(1000, &mut learning::made(1.0 / PERIOD, nonlinear), &motion());
}

#[test]
fn rows_allocate_nothing() {
    let rows = [
        MpcRow::torque_speed_line("motor", [1.0, 0.0], [0.2, 0.0], 0.5),
        MpcRow::dependent_joint("rod", [1.0, 1.0], 0.1, [-0.1, 0.8]),
    ];
    let options = options(&PowerCube, PERIOD, 5).with_rows(rows);
    drive(1000, &mut LtvMpc::new(PowerCube, motion(), options).unwrap(), &motion());
}

#[test]
fn replacing_the_model_allocates_nothing() {
    let options = options(&PowerCube, PERIOD, 20);
    let mut linear = LtvMpc::new(PowerCube, motion(), options.clone()).unwrap();
    let mut nonlinear = Nmpc::new(PowerCube, motion(), options).unwrap();
    let before = allocations::count();
    for _ in 0..1000 {
        linear.set_model(PowerCube).unwrap();
        nonlinear.set_model(PowerCube).unwrap();
    }
    assert_eq!(allocations::count(), before);
}

#[test]
fn linear_quadratic_regulators_allocate_nothing() {
    let (a, b) = ([[1.0, 0.02], [0.1, 0.99]], [[0.0002], [0.02]]);
    let (q, r) = ([[100.0, 0.0], [0.0, 1.0]], [[0.1]]);
    let regulator = Lqr::new(&a, &b, &q, &r).unwrap();
    let mut varying = TimeVaryingLqr::new(20).unwrap();
    let before = allocations::count();
    let mut state = [1.0, 0.0];
    for k in 0..STEPS {
        let u = regulator.input(&state);
        state = core::array::from_fn(|i| a[i][0] * state[0] + a[i][1] * state[1] + b[i][0] * u[0]);
        if k % 10 == 0 {
            for stage in 0..20 {
                varying.set_stage(stage, &a, &b);
            }
            varying.solve(&q, &r, &regulator.cost_to_go).unwrap();
            std::hint::black_box(varying.gain(0));
        }
    }
    assert_eq!(allocations::count(), before);
    assert!(state[0].abs() < 1e-9);
}
