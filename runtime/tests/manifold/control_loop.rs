//! The loop with a quadrotor: guard, limits, fallback, log.

use super::{Quadrotor, quadrotor};
use gelenk_runtime::control_loop::{
    ControlLoop, Controller, Cycle, EncoderFault, End, FeedForwardPd, JointGains, JointLaw, JointPd,
    LoopReport, LoopSettings, Refusal, StopReason, VirtualClock, log_to,
};
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, Trajectory};
use gelenk_runtime::transport::{InProcess, Reading, Transport, TransportError};
use std::io::{self, Write};
use std::sync::{Arc, Mutex};

pub type Motion = GeodesicMotion<Quadrotor, 6, 4, 7>;
type Robot = InProcess<Quadrotor, VirtualClock, 6, 4, 7>;

pub const START: [f64; 7] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
const RATE: f64 = 50.0;

/// A short way with a turn about the vertical axis through two points, by 4 rad in all.
pub fn motion() -> Motion {
    let turned = |x: f64, angle: f64| [x, 0.0, 1.0, 0.0, 0.0, (angle / 2.0).sin(), (angle / 2.0).cos()];
    Motion::through(Quadrotor, &[(0.0, START), (1.2, turned(0.1, 2.0)), (2.4, turned(0.2, 4.0))]).unwrap()
}

pub fn options() -> MpcOptions<6, 4> {
    MpcOptions {
        position_weight: [100.0, 100.0, 100.0, 10.0, 10.0, 10.0],
        velocity_weight: [10.0, 10.0, 10.0, 1.0, 1.0, 1.0],
        input_weight: [0.1; 4],
        ..MpcOptions::new(&Quadrotor, 1.0 / RATE, 15)
    }
}

pub fn law() -> JointPd<Quadrotor, 6, 4, 7> {
    JointPd::new(Quadrotor, JointGains::from_bandwidth(&Quadrotor, &START, 6.0, 0.8)).unwrap()
}

/// Good for the first steps: four propellers cannot push sideways.
fn follower() -> FeedForwardPd<Quadrotor, Motion, 6, 4, 7> {
    FeedForwardPd::new(law(), motion(), 1.0 / RATE, 0.01).unwrap()
}

pub fn settings() -> LoopSettings<6, 4> {
    LoopSettings {
        following_error: [0.3; 6],
        stop_time: 0.2,
        warm_up: 0.0,
        ..LoopSettings::for_robot(RATE, &Quadrotor)
    }
}

fn robot(clock: &VirtualClock, start: [f64; 7]) -> Robot {
    let mut plant = Plant::new(Quadrotor, PlantOptions::default()).unwrap();
    plant.reset(start, [0.0; 6]).unwrap();
    plant.preload([3.715; 4]);
    InProcess::new(plant, clock.clone(), settings().period())
}

/// From period `from` on, readings have this quaternion.
struct Spoilt {
    robot: Robot,
    reads: usize,
    from: usize,
    quaternion: [f64; 4],
}

impl Transport<6, 4, 7> for Spoilt {
    fn read(&mut self) -> Result<Option<Reading<6, 7>>, TransportError> {
        self.reads += 1;
        let mut reading = self.robot.read()?;
        if let Some(reading) = reading.as_mut().filter(|_| self.reads > self.from) {
            reading.positions[3..].copy_from_slice(&self.quaternion);
        }
        Ok(reading)
    }

    fn write(&mut self, inputs: &[f64; 4]) -> Result<(), TransportError> {
        self.robot.write(inputs)
    }

    fn release(&mut self) -> Result<(), TransportError> {
        self.robot.release()
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        self.robot.brake()
    }
}

fn run_spoilt(from: usize, quaternion: [f64; 4]) -> LoopReport<6> {
    let clock = VirtualClock::new();
    let robot = Spoilt { robot: robot(&clock, START), reads: 0, from, quaternion };
    ControlLoop::new(settings(), law(), motion(), follower(), robot, clock).unwrap().run()
}

#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A turn by more than half of one: no coordinate jumps, every reading is believed, and the log has poses.
#[test]
fn a_quadrotor_flies_in_the_loop() {
    let clock = VirtualClock::new();
    let controller = LtvMpc::new(Quadrotor, motion(), options()).unwrap();
    let text = Shared::default();
    let (sink, writer) = log_to(text.clone(), &Quadrotor, 1000).unwrap();
    let robot = robot(&clock, START);
    let mut control =
        ControlLoop::new(settings(), law(), motion(), controller, robot, clock).unwrap().with_log(sink);
    let report = control.run();
    assert_eq!(report.end, End::Finished, "{report}");
    assert_eq!((report.counts.fallback, report.counts.held, report.counts.jumps), (0, 0, 0), "{report}");
    drop(control);
    writer.finish().unwrap();
    let text = String::from_utf8(text.0.lock().unwrap().clone()).unwrap();
    let header = text.lines().next().unwrap();
    let positions = quadrotor::POSITION_NAMES.map(|name| format!("q_{name}")).join(",");
    let velocities = quadrotor::VELOCITY_NAMES.map(|name| format!("dq_{name}")).join(",");
    assert!(header.starts_with(&format!("time,{positions},{velocities},desired_base x,")), "{header}");
    // Near the end it has turned as desired, with the velocity estimated by differences before.
    let row: Vec<f64> =
        text.lines().nth(61).unwrap().split(',').take(21).map(|field| field.parse().unwrap()).collect();
    let (measured, rate, desired) = (&row[1..8], row[13], &row[14..21]);
    assert!(measured.iter().zip(desired).all(|(a, b)| (a - b).abs() < 0.05), "{row:?}");
    assert!((rate - motion().sample(row[0]).velocities[5]).abs() < 0.1, "{rate}");
}

#[test]
fn readings_that_are_no_attitudes_stop_it_by_name() {
    for quaternion in [[0.0; 4], [f64::NAN; 4], [0.0, 0.0, 0.0, 1.5]] {
        let report = run_spoilt(20, quaternion);
        let message = report.to_string();
        assert!(matches!(report.end, End::Stopped(StopReason::Encoder(_))), "{report}");
        assert!(message.contains("quaternion of joint base"), "{message}");
        // From the start on, it does not start.
        let report = run_spoilt(0, quaternion);
        assert!(matches!(report.end, End::Refused(_)), "{report}");
    }
    let refused = run_spoilt(0, [0.0; 4]).end;
    assert!(
        matches!(refused, End::Refused(Refusal::Encoder(EncoderFault::Attitude(error))) if error.joint == "base")
    );
}

/// An attitude that jumps is not believed, whichever its sign.
#[test]
fn attitudes_that_jump_are_not_believed() {
    let clock = VirtualClock::new();
    let quaternion = [0.6, 0.0, 0.0, -0.8];
    let robot = Spoilt { robot: robot(&clock, START), reads: 0, from: 20, quaternion };
    let mut settings = settings();
    settings.guard.jump_speed = [20.0; 6];
    let report = ControlLoop::new(settings, law(), motion(), follower(), robot, clock).unwrap().run();
    assert!(matches!(report.end, End::Stopped(StopReason::Encoder(_))), "{report}");
    assert!(report.counts.jumps > 0, "{report}");
}

#[test]
fn it_starts_at_its_start_alone_and_has_no_limits_of_attitudes() {
    let clock = VirtualClock::new();
    let tilted = [0.0, 0.0, 1.0, 0.0, 0.28, 0.0, 0.96];
    let mut control =
        ControlLoop::new(settings(), law(), motion(), follower(), robot(&clock, tilted), clock.clone())
            .unwrap();
    let report = control.run();
    assert!(matches!(report.end, End::Refused(Refusal::Start { name: "base wy", .. })), "{report}");
    let mut limited = settings();
    limited.position_limits[4] = [-1.0, 1.0];
    let robot = robot(&clock, START);
    let error = ControlLoop::new(limited, law(), motion(), follower(), robot, clock).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("base") && error.to_string().contains("quaternion"), "{error}");
}

/// The law's correction is K_p (y_d ⊖ y) + K_d (v_d − v), the same for both signs.
#[test]
fn joint_pd_works_on_the_error_state() {
    let motion = motion();
    let desired = motion.sample(0.9);
    let law = law();
    let exact = law.inputs(&desired, &desired.positions, &desired.velocities).unwrap();
    let mut other = desired.positions;
    other[3..].iter_mut().for_each(|q| *q = -*q);
    let same = law.inputs(&desired, &other, &desired.velocities).unwrap();
    assert!(exact.iter().zip(same).all(|(a, b)| (a - b).abs() < 1e-12));
    // As a controller it refuses what is not an attitude, and takes velocities from poses.
    let mut controller: FeedForwardPd<Quadrotor, Motion, 6, 4, 7> =
        FeedForwardPd::new(law, motion.clone(), 0.02, 0.0).unwrap();
    controller.reset(&START, &[0.0; 4]);
    for k in 1..=30 {
        let time = 0.02 * f64::from(k);
        let positions = Some(motion.sample(time).positions);
        controller.step(&Cycle { time, positions, ..Cycle::default() }).unwrap();
    }
    let estimate = controller.estimate().unwrap();
    let error = (estimate.velocities[5] - motion.sample(0.59).velocities[5]).abs();
    assert!(error < 1e-3, "{error}");
    assert!(controller.step(&Cycle { positions: Some([0.0; 7]), ..Cycle::default() }).is_err());
}
