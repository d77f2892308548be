//! Efforts of a description without motors reach everything that bounds inputs: the loop, and predictive
//! controllers.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{
    Command, ControlLoop, Controller, ControllerFault, Cycle, JointGains, JointPd, LoopSettings, VirtualClock,
};
use gelenk_runtime::mpc::MpcOptions;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::{InProcess, Reading, Transport, TransportError};

gelenk_runtime::dynamics!(struct Ur5 = gelenk_generated::ur5);
gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

/// `<limit effort="…"/>` of the published URDF [N m]; its drives are ideal, and no motor limits them.
const EFFORTS: [f64; 6] = [150.0, 150.0, 150.0, 28.0, 28.0, 28.0];

#[test]
fn efforts_without_motors_bound_the_inputs() {
    assert_eq!(LoopSettings::for_robot(200.0, &Ur5).input_limits, EFFORTS.map(|effort| [-effort, effort]));
    let options = MpcOptions::new(&Ur5, 0.01, 10);
    assert_eq!(options.input_limits, EFFORTS.map(|u| [-u, u]));
    assert_eq!(options.input_weight, EFFORTS.map(|u| 1e-3 / (u * u)));
}

/// 80.5 N m behind gears of 161, and 0.5 N m of the motor: the peak, not the nominal 44.8 N m.
#[test]
fn peaks_of_motor_and_joint_that_agree_are_the_bound() {
    assert_eq!(LoopSettings::for_robot(50.0, &PowerCube).input_limits, [[-0.5, 0.5]; 2]);
}

/// Asks for more than any joint bears.
struct Greedy;

impl Controller<6, 6> for Greedy {
    fn reset(&mut self, _: &[f64; 6], _: &[f64; 6]) {}

    fn step(&mut self, _: &Cycle<6, 6>) -> Result<Command<6>, ControllerFault> {
        Ok(Command { inputs: [1000.0; 6], iterations: 0 })
    }
}

/// Remembers the largest magnitude of each input that was sent.
struct Watched {
    robot: InProcess<Ur5, VirtualClock, 6, 6>,
    largest: [f64; 6],
}

impl Transport<6, 6> for Watched {
    fn read(&mut self) -> Result<Option<Reading<6>>, TransportError> {
        self.robot.read()
    }

    fn write(&mut self, inputs: &[f64; 6]) -> Result<(), TransportError> {
        for (largest, u) in self.largest.iter_mut().zip(inputs) {
            *largest = largest.max(u.abs());
        }
        self.robot.write(inputs)
    }

    fn release(&mut self) -> Result<(), TransportError> {
        self.robot.release()
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        self.robot.brake()
    }
}

#[test]
fn the_loop_sends_no_more_than_the_efforts_and_says_so() {
    let start = [0.0, -1.5, 1.0, 0.0, 0.0, 0.0];
    let settings = LoopSettings::for_robot(200.0, &Ur5);
    let motion = RestToRest::new(start, start.map(|y| y + 0.1), 1.0).unwrap();
    let gains = JointGains::from_bandwidth(&Ur5, &start, 10.0, 0.7);
    let law = JointPd::new(Ur5, gains).unwrap();
    let clock = VirtualClock::new();
    let mut plant = Plant::new(Ur5, PlantOptions::default()).unwrap();
    plant.reset(start, [0.0; 6]).unwrap();
    let mut robot =
        Watched { robot: InProcess::new(plant, clock.clone(), settings.period()), largest: [0.0; 6] };
    let report = {
        let mut control = ControlLoop::new(settings, law, motion, Greedy, &mut robot, clock).unwrap();
        control.run()
    };
    assert_eq!(robot.largest, EFFORTS, "{report}");
    assert!(report.counts.limited_inputs >= 6, "{report}");
}
