//! A log of the loop through `gelenk identify --online`: the numbers of the estimator in the loop, bit for bit.

#![allow(clippy::unwrap_used, reason = "test code: what cannot be set up ends the test")]

use std::sync::{Arc, Mutex};

use gelenk_codegen::identify::{DescribedForces, InterpretedRobot, replay};
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_identification::log::{ColumnOptions, runs_of};
use gelenk_identification::run::Effort;
use gelenk_runtime::adaptation::{AdaptationSettings, Adaptive, JointState, TorqueSource, Trust};
use gelenk_runtime::control_loop::{
    ControlLoop, FeedForwardPd, JointGains, JointPd, LoopSettings, VirtualClock, log_to,
};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{IdentificationSine, Sampled, Trajectory};
use gelenk_runtime::transport::InProcess;
use gelenk_tests::workspace;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Free { parameters } = gelenk_generated::powercube_parameters);

const PERIOD: f64 = 0.01;

/// Bytes that the log's thread writes.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// States of the estimator after a loop on a warm arm, and the log.
fn driven(source: TorqueSource) -> ([JointState; 2], Vec<u8>) {
    let sine = IdentificationSine {
        center: [0.0, 0.0],
        amplitude: [0.3, 0.4],
        first_frequency: [0.15, 0.1],
        last_frequency: [0.25, 0.2],
        sine_duration: 20.0,
        run_in: 2.0,
    };
    let motion = Sampled::of(&sine.motion().unwrap(), PERIOD).unwrap();
    let gains = JointGains::from_bandwidth(&PowerCube, &[0.0; 2], 8.0, 0.8);
    let law = JointPd::new(PowerCube, gains).unwrap();
    let settings = LoopSettings::for_robot(1.0 / PERIOD, &PowerCube);
    let pd = |robot| -> Result<_, Box<dyn std::error::Error>> {
        Ok(FeedForwardPd::new(JointPd::new(robot, gains)?, &motion, PERIOD, 0.01)?)
    };
    let controller = Adaptive::new(PowerCube, AdaptationSettings::new(PERIOD), pd).unwrap().unwrap();
    let controller = controller.with_torques(source);
    let mut warm = Free::default();
    warm.parameters.beta_viscous *= 0.7;
    warm.parameters.gamma_viscous *= 0.8;
    let torque_noise = (source == TorqueSource::Measured).then_some([0.01; 2]);
    let options = PlantOptions { encoder_resolution: [1e-4; 2], torque_noise, ..PlantOptions::default() };
    let mut plant = Plant::new(warm, options).unwrap();
    plant.reset(motion.sample(0.0).positions, [0.0; 2]).unwrap();
    let clock = VirtualClock::new();
    let robot = InProcess::new(plant, clock.clone(), settings.period());
    let log = Shared::default();
    let (sink, writer) = log_to(log.clone(), &PowerCube, 10_000).unwrap();
    let mut control =
        ControlLoop::new(settings, law, &motion, controller, robot, clock).unwrap().with_log(sink);
    control.start().unwrap();
    // The last rows of a log come after the controller's last period.
    for _ in 0..1900 {
        assert!(control.period());
    }
    let states = control.controller().adaptation().states().map(Option::unwrap);
    drop(control);
    assert_eq!(writer.finish().unwrap().dropped, 0);
    let bytes = log.0.lock().unwrap().clone();
    (states, bytes)
}

/// - `columns`: those of the torques that the loop learned from
fn compare(source: TorqueSource, columns: &ColumnOptions) {
    let (states, log) = driven(source);
    let path = workspace().join("models/powercube.toml");
    let model = read(&path, &ReadOptions::default()).unwrap().model;
    let robot = InterpretedRobot::new(&model).unwrap();
    let forces = DescribedForces::new(&model, false).unwrap();
    let recording = runs_of(&log, "log.csv", &robot, columns).unwrap();
    let found = replay(&robot, &|y, v, a| forces.at(y, v, a), &recording.runs, 0.0).unwrap();
    for (joint, state) in found.joints.iter().zip(states) {
        let joint = joint.as_ref().unwrap();
        assert_eq!(state.trust, Trust::Learned);
        assert!(joint.samples.len() > 50 && state.learned[1] < 0.0, "{state:?}");
        // Digits of `{:?}` are those that tell a number from its neighbours.
        assert_eq!(format!("{:?}", joint.state), format!("{state:?}"));
    }
    // Changes of the efforts by 1e-9 change the result.
    let mut other = recording.runs;
    other[0].efforts[0][500..].iter_mut().for_each(|effort| *effort *= 1.0 + 1e-9);
    let other = replay(&robot, &|y, v, a| forces.at(y, v, a), &other, 0.0).unwrap();
    assert_ne!(format!("{:?}", other.joints[0]), format!("{:?}", found.joints[0]));
}

#[test]
fn a_replay_has_the_bits_of_the_loop() {
    compare(TorqueSource::Inputs, &ColumnOptions { effort: Some(Effort::Input), ..ColumnOptions::default() });
}

#[test]
fn a_replay_of_measured_torques_has_the_bits_of_the_loop() {
    let columns = Some("torque=measured_tau_{name}".to_owned());
    compare(TorqueSource::Measured, &ColumnOptions { columns, ..ColumnOptions::default() });
}
