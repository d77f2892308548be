//! Robots with couplings, drives on several joints and cylinders, as arms are: in the loop with its guard and its log, under
//! predictive control and regulators.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_generated::{differential_wrist, excavator};
use gelenk_runtime::control_loop::{
    AccelerationGains, ComputedTorque, ControlLoop, Controller, End, JointGains, JointLaw, JointPd,
    LoopSettings, VirtualClock, log_to_file,
};
use gelenk_runtime::dynamics::{Dynamics, Limits};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::lqr::Lqr;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::plant::{Plant, PlantError, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::dynamics!(struct Wrist = gelenk_generated::differential_wrist);
gelenk_runtime::dynamics!(struct Excavator = gelenk_generated::excavator);

/// The wrist, with dry friction on the shaft of a motor that moves pitch and roll.
mod rubbing_wrist {
    pub use gelenk_generated::differential_wrist::*;
    pub const FRICTION_JUMPS: [[usize; 2]; 4] = [[2, 2], [2, 3], [3, 2], [3, 3]];
    pub fn friction_torques(v: &[f64; N]) -> [f64; N] {
        let torque = if v[2] + v[3] == 0.0 { 0.0 } else { 0.1 * (v[2] + v[3]).signum() };
        [v[0], v[1], torque, torque]
    }
}
gelenk_runtime::dynamics!(struct RubbingWrist = rubbing_wrist);

const RATE: f64 = 100.0;
const PERIOD: f64 = 1.0 / RATE;

/// Runs the loop to the end of a motion, with a log; its header, and the largest error of position at the end.
fn run<D>(
    model: D,
    law: impl JointLaw<4, 4>,
    controller: impl Controller<4, 4>,
    motion: RestToRest<4>,
) -> (String, f64)
where
    D: Dynamics<4, 4> + Clone,
{
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.csv");
    let (log, writer) = log_to_file(&file, &model, 1000).unwrap();
    let settings = LoopSettings { warm_up: 0.0, ..LoopSettings::for_robot(RATE, &model) };
    let mut plant = Plant::new(model.clone(), PlantOptions::default()).unwrap();
    let start = motion.sample(0.0);
    plant.reset(start.positions, [0.0; 4]).unwrap();
    let hold = FeedForward::new(model).unwrap().at(&start).inputs;
    plant.preload(hold);
    let clock = VirtualClock::new();
    let transport = InProcess::new(plant, clock.clone(), settings.period());
    let control = ControlLoop::new(settings, law, motion, controller, transport, clock).unwrap();
    let mut control = control.with_log(log);
    let report = control.run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!(report.counts.controller_faults, 0, "{report}");
    let reached = control.transport().plant().state().0;
    drop(control);
    let written = writer.finish().unwrap();
    assert!(written.dropped == 0 && written.written as f64 > RATE * motion.duration(), "{written:?}");
    let goal = motion.sample(f64::INFINITY).positions;
    let error = reached.iter().zip(&goal).map(|(y, goal)| (y - goal).abs()).fold(0.0, f64::max);
    (std::fs::read_to_string(file).unwrap().lines().next().unwrap().to_owned(), error)
}

fn columns(prefix: &str, names: &[&str]) -> String {
    names.iter().map(|name| format!("{prefix}_{name}")).collect::<Vec<_>>().join(",")
}

/// Two motors that move pitch and roll together; the law that takes over where a controller fails acts through B as well.
#[test]
fn a_differential_wrist_runs_in_the_loop() {
    let [start, goal] = [[0.2, 0.6, -0.4, 0.0], [-0.2, 1.0, 0.5, 1.0]];
    let motion = RestToRest::new(start, goal, 1.5).unwrap();
    let options = || MpcOptions::new(&Wrist, PERIOD, 10);
    let law = || JointPd::new(Wrist, JointGains::from_bandwidth(&Wrist, &start, 10.0, 0.8)).unwrap();
    let linear = run(Wrist, law(), LtvMpc::new(Wrist, motion, options()).unwrap(), motion);
    let nonlinear = run(Wrist, law(), Nmpc::new(Wrist, motion, options()).unwrap(), motion);
    for (header, error) in [linear, nonlinear] {
        assert!(error < 5e-3, "{error}");
        assert!(header.contains(&columns("q", &differential_wrist::JOINT_NAMES)), "{header}");
        assert!(header.contains(&columns("u", &differential_wrist::INPUT_NAMES)), "{header}");
    }
}

#[test]
fn an_excavator_runs_in_the_loop() {
    let motion = RestToRest::new([0.0, -0.2, 1.2, 0.6], [0.5, -0.6, 1.8, 1.2], 3.0).unwrap();
    let law = ComputedTorque::new(Excavator, AccelerationGains::from_bandwidth(10.0, 1.0)).unwrap();
    let controller = LtvMpc::new(Excavator, motion, MpcOptions::new(&Excavator, PERIOD, 10)).unwrap();
    let (header, error) = run(Excavator, law, controller, motion);
    assert!(error < 5e-3, "{error}");
    assert!(header.contains(&columns("u", &excavator::INPUT_NAMES)), "{header}");
}

/// Around a rest, where the cylinders carry the weight: the regulator brings the real arm back, the forces alone do not.
#[test]
fn a_regulator_holds_an_excavator_in_cylinder_forces() {
    let rest = [0.0, -0.2, 1.2, 0.6];
    let motion = RestToRest::new(rest, rest, 1.0).unwrap();
    let hold = FeedForward::new(Excavator).unwrap().at(&motion.sample(0.0)).inputs;
    let (a_y, a_v, b, _) = excavator::linearize(&rest, &[0.0; 4], &hold);
    // x⁺ = (1 + h A) x + h B u, in kilonewtons, so that the weights are of one size.
    let state = core::array::from_fn(|i: usize| {
        core::array::from_fn(|j: usize| {
            let one = f64::from(u8::from(i == j));
            match (i < 4, j < 4) {
                (true, true) => one,
                (true, false) => PERIOD * f64::from(u8::from(i + 4 == j)),
                (false, true) => PERIOD * a_y[i - 4][j],
                (false, false) => one + PERIOD * a_v[i - 4][j - 4],
            }
        })
    });
    let input: [[f64; 4]; 8] = core::array::from_fn(|i| {
        core::array::from_fn(|j| if i < 4 { 0.0 } else { PERIOD * 1e3 * b[i - 4][j] })
    });
    let diagonal = |i: usize, j: usize, x: f64| if i == j { x } else { 0.0 };
    let weights =
        core::array::from_fn(|i| core::array::from_fn(|j| diagonal(i, j, if i < 4 { 1e3 } else { 1.0 })));
    let effort = core::array::from_fn(|i| core::array::from_fn(|j| diagonal(i, j, 1e-2)));
    let regulator = Lqr::<8, 4>::new(&state, &input, &weights, &effort).unwrap();
    let [held, regulated] = [false, true].map(|is_closed| {
        let mut plant = Plant::new(Excavator, PlantOptions::default()).unwrap();
        plant.reset(rest.map(|y| y + 0.05), [0.0; 4]).unwrap();
        for _ in 0..300 {
            let (y, v) = plant.state();
            let x = core::array::from_fn(|i| if i < 4 { y[i] - rest[i] } else { v[i - 4] });
            let change = if is_closed { regulator.input(&x) } else { [0.0; 4] };
            plant.apply(&core::array::from_fn(|i| hold[i] + 1e3 * change[i]), PERIOD).unwrap();
        }
        let y = plant.state().0;
        y.iter().zip(rest).map(|(y, rest)| (y - rest).abs()).fold(0.0, f64::max)
    });
    assert!(held > 0.02 && regulated < 1e-3, "{held} {regulated}");
}

/// The wrist with so much dry friction on the shaft [N m], as a free parameter may say.
#[derive(Debug, Clone, Copy)]
struct FreeWrist(f64);

impl Dynamics<4, 4> for FreeWrist {
    fn joint_names(&self) -> [&'static str; 4] {
        Wrist.joint_names()
    }
    fn input_names(&self) -> [&'static str; 4] {
        Wrist.input_names()
    }
    fn limits(&self) -> Limits<4, 4> {
        Wrist.limits()
    }
    fn mass_matrix(&self, y: &[f64; 4]) -> [[f64; 4]; 4] {
        Wrist.mass_matrix(y)
    }
    fn coriolis_forces(&self, y: &[f64; 4], v: &[f64; 4]) -> [f64; 4] {
        Wrist.coriolis_forces(y, v)
    }
    fn gravity_forces(&self, y: &[f64; 4]) -> [f64; 4] {
        Wrist.gravity_forces(y)
    }
    fn spring_forces(&self, _: &[f64; 4], _: &[f64; 4]) -> [f64; 4] {
        [0.0; 4]
    }
    fn friction_torques(&self, _: &[f64; 4], v: &[f64; 4]) -> [f64; 4] {
        let dry = if v[2] + v[3] == 0.0 { 0.0 } else { self.0 * (v[2] + v[3]).signum() };
        [v[0], v[1], 0.2 * v[2] + dry, 0.2 * v[3] + dry]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &rubbing_wrist::FRICTION_JUMPS
    }
    fn input_matrix(&self, y: &[f64; 4]) -> [[f64; 4]; 4] {
        Wrist.input_matrix(y)
    }
}

/// A jump that a parameter makes 0 is none, until a model with another value takes its place.
#[test]
fn friction_on_a_shaft_that_a_parameter_makes_zero_is_smooth() {
    let is_refused = |error| matches!(error, Err(PlantError::SharedFriction { .. }));
    assert!(is_refused(Plant::new(FreeWrist(0.1), PlantOptions::default()).map(|_| ())));
    let mut plant = Plant::new(FreeWrist(0.0), PlantOptions::default()).unwrap();
    plant.reset([0.1, 0.3, 0.2, 0.0], [0.0, 0.0, 0.5, 0.4]).unwrap();
    plant.apply(&[0.0; 4], PERIOD).unwrap();
    let moved = plant.state();
    assert!(moved.0[2] > 0.2, "{moved:?}");
    plant.set_model(FreeWrist(0.1));
    assert!(is_refused(plant.apply(&[0.0; 4], PERIOD)));
    assert_eq!(plant.state(), moved, "it has not moved");
}

/// The plant knows of single joints whether they stick: it does not drive on without such friction at rest.
#[test]
fn a_plant_with_dry_friction_on_a_shaft_of_two_joints_is_refused() {
    let Err(refused) = Plant::new(RubbingWrist, PlantOptions::default()) else { panic!("it is refused") };
    let [.., first, second] = differential_wrist::JOINT_NAMES;
    assert_eq!(refused, PlantError::SharedFriction { first, second });
    assert!(refused.to_string().contains("--smooth-sign"), "{refused}");
}
