//! Rows of the predictive controllers: the torque–speed line of a motor, limits of joints that follow others.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::tracking::{self, PEAK, PERIOD, PowerCube, exact};
use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{
    LinearizationPoint, LtvMpc, MpcError, MpcNote, MpcOptions, MpcRow, Nmpc, RowFault,
};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::qp::Penalty;
use gelenk_runtime::trajectory::{RestToRest, Trajectory};

const HORIZON: usize = 12;
const START: [f64; 2] = [0.1, -0.3];
const GOAL: [f64; 2] = [0.7, 0.4];

/// At its fastest 0.66 rad/s: most of the motors' torque, because of the friction.
fn motion() -> RestToRest<2> {
    RestToRest::new(START, GOAL, 2.0).unwrap()
}

/// Linearized around the plan: limits lead far from the trajectory.
fn options() -> MpcOptions<2, 2> {
    let linearization = LinearizationPoint::Plan;
    MpcOptions { linearization, ..tracking::options(&PowerCube, PERIOD, HORIZON) }
}

/// Peak torque at rest, none at `speed` [rad/s] of the joint.
fn lines(speed: f64) -> [MpcRow<2, 2>; 2] {
    let slope = PEAK / speed;
    [
        MpcRow::torque_speed_line("motor 1", [1.0, 0.0], [slope, 0.0], PEAK),
        MpcRow::torque_speed_line("motor 2", [0.0, 1.0], [0.0, slope], PEAK),
    ]
}

/// Results of a run with rows: the largest excess at the start of a period, by the controller's estimate and
/// in truth, and the final error [rad].
#[derive(Debug)]
struct Shown {
    estimated: f64,
    true_one: f64,
    final_error: f64,
}

/// Runs a controller for one and a half times the motion's duration, pushed by `disturbance` [N m at the motors].
fn run<const NR: usize>(
    controller: &mut (impl Controller<2, 2> + ?Sized),
    rows: &[MpcRow<2, 2>; NR],
    disturbance: [f64; 2],
) -> Shown {
    let mut plant = Plant::new(PowerCube, exact()).unwrap();
    plant.reset(START, [0.0; 2]).unwrap();
    controller.reset(&START, &[0.0; 2]);
    let mut shown = Shown { estimated: f64::NEG_INFINITY, true_one: f64::NEG_INFINITY, final_error: 0.0 };
    let mut last_inputs = [0.0; 2];
    for k in 0..(1.5 * motion().duration() / PERIOD) as u32 {
        let cycle = Cycle {
            time: PERIOD * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        let (y, v) = plant.state();
        let u = controller.step(&cycle).unwrap().inputs;
        let estimate = controller.estimate().unwrap();
        for row in rows {
            let beyond = |value: f64| (row.lower - value).max(value - row.upper);
            let guess = beyond(row.value(&estimate.positions, &estimate.velocities, &u));
            shown.estimated = shown.estimated.max(guess);
            shown.true_one = shown.true_one.max(beyond(row.value(&y, &v, &u)));
        }
        last_inputs = u;
        plant.apply(&core::array::from_fn(|i| u[i] + disturbance[i]), PERIOD).unwrap();
    }
    let (y, _) = plant.state();
    shown.final_error = (0..2).map(|i| (y[i] - GOAL[i]).abs()).fold(0.0, f64::max);
    shown
}

/// Runs both controllers, without rows and with them.
fn both<const NR: usize>(rows: [MpcRow<2, 2>; NR], disturbance: [f64; 2]) -> [[Shown; 2]; 2] {
    let with = || options().with_rows(rows);
    let mut plain = LtvMpc::new(PowerCube, motion(), options()).unwrap();
    let mut limited = LtvMpc::new(PowerCube, motion(), with()).unwrap();
    let linear = [run(&mut plain, &rows, disturbance), run(&mut limited, &rows, disturbance)];
    let mut plain = Nmpc::new(PowerCube, motion(), options()).unwrap();
    let mut limited = Nmpc::new(PowerCube, motion(), with()).unwrap();
    [linear, [run(&mut plain, &rows, disturbance), run(&mut limited, &rows, disturbance)]]
}

#[test]
fn a_torque_speed_line_is_kept() {
    for [plain, limited] in both(lines(1.0), [0.0; 2]) {
        println!("{plain:?}\n{limited:?}");
        assert!(plain.true_one > 0.1 * PEAK, "the motion needs more: {plain:?}");
        assert!(limited.estimated < 1e-9, "{limited:?}");
        // The estimate of the speed is not the speed.
        assert!(limited.true_one < 0.01 * PEAK, "{limited:?}");
        assert!(limited.final_error < 1e-3 && plain.final_error < 1e-3, "{limited:?}");
    }
}

/// Rows limit the forces of the motors, not those at the joints: an estimated disturbance has no part in
/// them.
#[test]
fn a_torque_speed_line_is_kept_beside_an_estimated_disturbance() {
    let rows = lines(1.0);
    let mut limited = options().with_rows(rows);
    limited.observer.disturbance_noise = [1e-3; 2];
    for push in [0.04, -0.04] {
        let mut linear = LtvMpc::new(PowerCube, motion(), limited.clone()).unwrap();
        let mut nonlinear = Nmpc::new(PowerCube, motion(), limited.clone()).unwrap();
        let controllers = [&mut linear as &mut dyn Controller<2, 2>, &mut nonlinear];
        for (i, controller) in controllers.into_iter().enumerate() {
            let shown = run(controller, &rows, [push; 2]);
            println!("{i} {push}: {shown:?}");
            assert!(shown.estimated > -1e-6, "the line is reached: {shown:?}");
            assert!(shown.estimated < 1e-9 && shown.true_one < 0.01 * PEAK, "{shown:?}");
            assert!(shown.final_error < 1e-3, "{shown:?}");
        }
    }
}

/// The third joint of a parallelogram stops before the motion has ended; a push does not make a fault.
#[test]
fn the_limit_of_a_dependent_joint_is_kept_softly() {
    let row = MpcRow::dependent_joint("rod", [1.0, 1.0], -0.2, [f64::NEG_INFINITY, 0.6]);
    for [plain, limited] in both([row], [0.0; 2]) {
        println!("{plain:?}\n{limited:?}");
        assert!(plain.true_one > 0.2, "the motion goes on to 0.9 rad: {plain:?}");
        assert!(limited.true_one < 1e-3, "{limited:?}");
    }
    // Beyond its limit from the beginning, it is brought back.
    let row = MpcRow::dependent_joint("rod", [1.0, 1.0], 0.0, [0.0, f64::INFINITY]);
    for [_, limited] in both([row], [0.02, 0.0]) {
        assert!((limited.true_one - 0.2).abs() < 0.05, "{limited:?}");
        assert!(limited.final_error < 0.1, "{limited:?}");
    }
}

/// The sum of two inputs, and a sum of speeds.
#[test]
fn rows_of_any_sort_are_kept() {
    let supply = MpcRow::new("supply", [0.0; 2], [0.0; 2], [1.0, 1.0], [-0.55, 0.55]);
    let tip = MpcRow::new("tip", [0.0; 2], [1.0, 1.0], [0.0; 2], [-0.9, 0.9]);
    for [plain, limited] in both([supply, tip], [0.0; 2]) {
        println!("{plain:?}\n{limited:?}");
        assert!(plain.true_one > 0.2, "{plain:?}");
        assert!(limited.true_one < 5e-3, "{limited:?}");
        assert!(limited.final_error < 1e-3, "{limited:?}");
    }
    for [_, limited] in both([supply], [0.0; 2]) {
        assert!(limited.true_one < 1e-9, "no estimate has a part in it: {limited:?}");
    }
}

/// Rows without sides change no bit of the inputs.
#[test]
fn rows_without_limits_change_nothing() {
    let free = MpcRow::new("free", [1.0, 2.0], [0.5, 0.0], [1.0, -1.0], [f64::NEG_INFINITY, f64::INFINITY]);
    let mut plain = LtvMpc::new(PowerCube, motion(), options()).unwrap();
    let mut limited = LtvMpc::new(PowerCube, motion(), options().with_rows([free])).unwrap();
    for controller in [&mut plain as &mut dyn Controller<2, 2>, &mut limited] {
        controller.reset(&START, &[0.0; 2]);
    }
    for k in 0..50_u32 {
        let positions = Some(motion().sample(PERIOD * f64::from(k)).positions.map(|y| y + 1e-3));
        let cycle =
            Cycle { time: PERIOD * f64::from(k), periods: u32::from(k > 0), positions, ..Cycle::default() };
        assert_eq!(plain.step(&cycle).unwrap().inputs, limited.step(&cycle).unwrap().inputs);
    }
}

fn refuse(row: MpcRow<2, 2>) -> (RowFault, String) {
    let error = LtvMpc::new(PowerCube, motion(), options().with_rows([lines(1.0)[0], row])).unwrap_err();
    let text = error.to_string();
    assert!(text.contains(row.name), "{text}");
    match error {
        MpcError::Row { fault, .. } => (fault, text),
        other => panic!("{other}"),
    }
}

#[test]
fn senseless_rows_are_refused_by_name() {
    let row = |lower, upper| MpcRow::new("odd", [1.0, 0.0], [0.0; 2], [0.0; 2], [lower, upper]);
    let mut wild = row(-1.0, 1.0);
    wild.velocities[1] = f64::NAN;
    assert!(matches!(refuse(wild).0, RowFault::NotFinite { value } if value.is_nan()));
    wild.velocities[1] = f64::INFINITY;
    assert!(refuse(wild).1.contains("coefficient is inf"));
    let infinite = f64::INFINITY;
    for [lower, upper] in
        [[1.0, -1.0], [f64::NAN, 1.0], [0.0, f64::NAN], [infinite, infinite], [-infinite, -infinite]]
    {
        assert!(matches!(refuse(row(lower, upper)).0, RowFault::Sides { .. }), "{lower} {upper}");
    }
    let zero = MpcRow::new("nothing", [0.0; 2], [0.0; 2], [0.0; 2], [0.1, 1.0]);
    assert!(refuse(zero).1.contains("all its coefficients are zero"));
    let beyond = MpcRow::new("too strong", [0.0; 2], [0.0; 2], [1.0, 1.0], [1.5, 2.0]);
    let (fault, text) = refuse(beyond);
    assert_eq!(fault, RowFault::OutOfReach { lower: 1.5, upper: 2.0, least: -1.0, most: 1.0 });
    assert!(text.contains("inputs within their limits give -1 to 1"), "{text}");
    for penalty in [Penalty { linear: 0.0, quadratic: 1.0 }, Penalty { linear: 1.0, quadratic: f64::NAN }] {
        let fault = refuse(row(-1.0, 1.0).penalized(penalty)).0;
        assert!(matches!(fault, RowFault::Penalty { .. }));
    }
    let spread = MpcRow::new("spread", [1e-300, 0.0], [0.0; 2], [0.0; 2], [1e300, infinite]);
    assert!(matches!(refuse(spread).0, RowFault::Sides { .. }));
    // What can be kept is taken: zero rows that hold, equalities, soft rows out of reach.
    let zero = MpcRow::new("nothing", [0.0; 2], [0.0; 2], [0.0; 2], [0.0, 1.0]);
    let equal = MpcRow::new("equal", [0.0; 2], [0.0; 2], [1.0, -1.0], [0.0, 0.0]);
    let mut mpc =
        LtvMpc::new(PowerCube, motion(), options().with_rows([zero, equal, beyond.soft()])).unwrap();
    mpc.reset(&START, &[0.0; 2]);
    let cycle = Cycle { positions: Some(START), ..Cycle::default() };
    let u = mpc.step(&cycle).unwrap().inputs;
    assert!((u[0] - u[1]).abs() < 1e-9, "{u:?}");
}

/// A penalty that the QP refuses would leave no step a solution.
#[test]
fn senseless_penalties_are_refused_by_name() {
    for (linear, quadratic, name) in [
        (0.0, 1.0, "limit_penalty.linear"),
        (f64::NAN, 1.0, "limit_penalty.linear"),
        (1.0, -1.0, "limit_penalty.quadratic"),
    ] {
        let options = MpcOptions { limit_penalty: Penalty { linear, quadratic }, ..options() };
        let error = LtvMpc::new(PowerCube, motion(), options).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}

/// A motion that its motors cannot make is said to be one.
#[test]
fn a_trajectory_beyond_a_row_is_noted() {
    let limited = LtvMpc::new(PowerCube, motion(), options().with_rows(lines(1.0))).unwrap();
    let notes = limited.notes().iter().filter(|note| matches!(note, MpcNote::Row { .. }));
    let notes: Vec<String> = notes.map(ToString::to_string).collect();
    assert!(!notes.is_empty() && notes.iter().all(|note| note.contains("motor")), "{notes:?}");
    let slow = RestToRest::new(START, GOAL, 4.0).unwrap();
    let slow = LtvMpc::new(PowerCube, slow, options().with_rows(lines(1.0))).unwrap();
    assert!(!slow.notes().iter().any(|note| matches!(note, MpcNote::Row { .. })));
}

gelenk_runtime::dynamics!(struct Wrist = gelenk_generated::differential_wrist);
gelenk_runtime::dynamics!(struct Palletizer = gelenk_generated::palletizer);
gelenk_runtime::dynamics!(struct Scara = gelenk_generated::scara);

/// Runs a controller on its own robot's plant; the largest error of position at the end [rad], and the largest value
/// of `shown` at the start of a period.
fn follow<const N: usize, D: Dynamics<N, N> + Copy>(
    model: D,
    controller: &mut impl Controller<N, N>,
    [start, goal]: [[f64; N]; 2],
    seconds: f64,
    shown: impl Fn(&[f64; N], &[f64; N]) -> f64,
) -> [f64; 2] {
    let period = 0.01;
    let mut plant = Plant::new(model, PlantOptions::default()).unwrap();
    plant.reset(start, [0.0; N]).unwrap();
    controller.reset(&start, &[0.0; N]);
    let (mut last_inputs, mut largest) = ([0.0; N], f64::NEG_INFINITY);
    for k in 0..(seconds / period) as u32 {
        let cycle = Cycle {
            time: period * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        let (y, _) = plant.state();
        let u = controller.step(&cycle).unwrap().inputs;
        largest = largest.max(shown(&y, &u));
        last_inputs = u;
        plant.apply(&u, period).unwrap();
    }
    let (y, _) = plant.state();
    [(0..N).map(|i| (y[i] - goal[i]).abs()).fold(0.0, f64::max), largest]
}

/// Two motors move pitch and roll together: B is full, and each keeps its own limit.
#[test]
fn a_differential_wrist_is_controlled_in_its_motors_torques() {
    let [start, goal] = [[0.2, 0.6, -0.4, 0.0], [-0.2, 1.0, 0.5, 1.0]];
    let motion = RestToRest::new(start, goal, 1.5).unwrap();
    let mut controller = LtvMpc::new(Wrist, motion, MpcOptions::new(&Wrist, 0.01, 15)).unwrap();
    let peak = gelenk_generated::differential_wrist::PEAK_INPUT_LIMITS;
    let beyond =
        |_: &[f64; 4], u: &[f64; 4]| (0..4).map(|j| u[j].abs() - peak[j]).fold(f64::NEG_INFINITY, f64::max);
    let [error, beyond] = follow(Wrist, &mut controller, [start, goal], 2.5, beyond);
    assert!(error < 5e-3 && beyond <= 1e-9, "{error} {beyond}");
}

/// A screw spline moves the quill by two nuts, and the tap slides while it turns: lengths and angles in one controller.
#[test]
fn a_scara_taps_in_its_motors_torques() {
    let [start, goal] = [[0.2, 0.4, 0.0, -0.02, 0.0], [-0.2, 0.9, 1.0, -0.1, -60.0]];
    let motion = RestToRest::new(start, goal, 1.5).unwrap();
    let mut controller = LtvMpc::new(Scara, motion, MpcOptions::new(&Scara, 0.01, 15)).unwrap();
    let peak = gelenk_generated::scara::PEAK_INPUT_LIMITS;
    let beyond =
        |_: &[f64; 5], u: &[f64; 5]| (0..5).map(|j| u[j].abs() - peak[j]).fold(f64::NEG_INFINITY, f64::max);
    let [error, beyond] = follow(Scara, &mut controller, [start, goal], 2.5, beyond);
    assert!(error < 5e-3 && beyond <= 1e-9, "{error} {beyond}");
}

/// The forearm of a parallelogram follows two coordinates: the module's constants make the row that keeps its limits.
#[test]
fn the_forearm_of_a_palletizer_keeps_its_limits() {
    use gelenk_generated::palletizer::{
        DEPENDENT_JOINT_NAMES, DEPENDENT_JOINT_OFFSETS, DEPENDENT_JOINT_RATIOS, DEPENDENT_POSITION_LIMITS,
    };
    let forearm = DEPENDENT_JOINT_NAMES.iter().position(|name| *name == "forearm").unwrap();
    let limits = DEPENDENT_POSITION_LIMITS[forearm];
    let row = MpcRow::dependent_joint(
        "forearm",
        DEPENDENT_JOINT_RATIOS[forearm],
        DEPENDENT_JOINT_OFFSETS[forearm],
        limits,
    );
    // Both coordinates stay within their limits, the forearm would end at 1.7 rad.
    let [start, goal] = [[0.0, 0.3, 0.8, 0.0], [0.4, -0.1, 1.6, 0.5]];
    let motion = RestToRest::new(start, goal, 2.0).unwrap();
    let angle = |y: &[f64; 4], u: &[f64; 4]| row.value(y, &[0.0; 4], u) + DEPENDENT_JOINT_OFFSETS[forearm];
    let plain = MpcOptions::new(&Palletizer, 0.01, 15);
    let free = MpcRow { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..row };
    let mut without = LtvMpc::new(Palletizer, motion, plain.clone().with_rows([free])).unwrap();
    let [error, largest] = follow(Palletizer, &mut without, [start, goal], 3.0, angle);
    assert!(error < 5e-3 && largest > limits[1] + 0.15, "{error} {largest}");
    let mut with = LtvMpc::new(Palletizer, motion, plain.with_rows([row])).unwrap();
    let [_, largest] = follow(Palletizer, &mut with, [start, goal], 3.0, angle);
    assert!(largest < limits[1] + 5e-3, "{largest}");
}
