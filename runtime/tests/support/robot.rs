//! The PowerCube with its loop, and a transport that watches the plant's own state.

use gelenk_runtime::control_loop::{
    Clock, ControlLoop, Controller, FeedForwardPd, JointGains, JointPd, LoopReport, LoopSettings,
    VirtualClock,
};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::{InProcess, Reading, Transport, TransportError};
use std::time::Duration;

gelenk_runtime::dynamics!(
    pub struct PowerCube = gelenk_generated::powercube: Discretizable []
);

/// Positions that the tests allow [rad]; the description has no limits.
pub const LIMITS: [[f64; 2]; 2] = [[-1.0, 1.2], [-1.0, 1.0]];
pub const START: [f64; 2] = [-0.6, 0.4];
pub const END: [f64; 2] = [0.8, -0.5];
/// Length of the motion [s].
pub const DURATION: f64 = 5.0;

pub type Law = JointPd<PowerCube, 2, 2>;
/// Feed-forward with joint PD of a model of the arm.
pub type PdOf<D> = FeedForwardPd<D, RestToRest<2>, 2, 2>;
pub type Pd = PdOf<PowerCube>;
pub type Simulated = InProcess<PowerCube, VirtualClock, 2, 2>;

pub fn motion() -> RestToRest<2> {
    RestToRest::new(START, END, DURATION).unwrap()
}

pub fn settings(rate: f64) -> LoopSettings<2, 2> {
    LoopSettings { position_limits: LIMITS, ..LoopSettings::for_robot(rate, &PowerCube) }
}

pub fn law() -> Law {
    law_of(PowerCube)
}

fn law_of<D: Dynamics<2, 2>>(model: D) -> JointPd<D, 2, 2> {
    JointPd::new(model, JointGains::from_bandwidth(&PowerCube, &START, 10.0, 0.7)).unwrap()
}

pub fn pd_of<D: Dynamics<2, 2>>(model: D, motion: RestToRest<2>, rate: f64) -> PdOf<D> {
    FeedForwardPd::new(law_of(model), motion, 1.0 / rate, 0.01).unwrap()
}

pub fn pd(rate: f64) -> Pd {
    made(rate, |model| pd_of(model, motion(), rate))
}

/// A controller with the described model, like [`super::learning::made`].
pub fn made<C>(_rate: f64, make: impl FnOnce(PowerCube) -> C) -> C {
    make(PowerCube)
}

pub fn plant_options() -> PlantOptions<2, 2> {
    PlantOptions { encoder_resolution: [1e-4; 2], input_limits: [[-0.5, 0.5]; 2], ..PlantOptions::default() }
}

/// One in five measurements and one in five inputs are lost.
pub fn lossy(seed: u64) -> PlantOptions<2, 2> {
    PlantOptions { measurement_loss: 0.2, input_loss: 0.2, seed, ..plant_options() }
}

pub fn plant_at(positions: [f64; 2], options: PlantOptions<2, 2>) -> Plant<PowerCube, 2, 2> {
    let mut plant = Plant::new(PowerCube, options).unwrap();
    plant.reset(positions, [0.0; 2]).unwrap();
    plant
}

/// Extremes of the true motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    pub lowest: [f64; 2],
    pub highest: [f64; 2],
    pub fastest: [f64; 2],
}

impl Seen {
    /// The arm stayed within positions, and within the speed of its drives.
    pub fn assert_within_limits(&self) {
        let speeds = PowerCube.limits().velocity;
        for i in 0..2 {
            assert!(
                self.lowest[i] >= LIMITS[i][0]
                    && self.highest[i] <= LIMITS[i][1]
                    && self.fastest[i] <= speeds[i],
                "joint {i}: {self:?}"
            );
        }
    }
}

/// Fault of a reading; gets the number of the reading, 0 for the one at the start.
pub type Fault = Box<dyn FnMut(u64, Reading<2>) -> Option<Reading<2>>>;

/// A simulated robot with faults, watched.
pub struct Watched {
    pub robot: Simulated,
    pub clock: VirtualClock,
    pub fault: Fault,
    /// Turns inputs around, as wrongly wired drives do.
    pub input_sign: f64,
    pub reads: u64,
    pub releases: u64,
    pub seen: Seen,
}

impl Watched {
    pub fn new(rate: f64, plant: Plant<PowerCube, 2, 2>) -> Self {
        let clock = VirtualClock::new();
        let positions = plant.state().0;
        Self {
            robot: InProcess::new(plant, clock.clone(), Duration::from_secs_f64(1.0 / rate)),
            clock,
            fault: Box::new(|_, reading| Some(reading)),
            input_sign: 1.0,
            reads: 0,
            releases: 0,
            seen: Seen { lowest: positions, highest: positions, fastest: [0.0; 2] },
        }
    }

    /// At the start of the motion, with the usual encoders.
    pub fn at_start(rate: f64) -> Self {
        Self::new(rate, plant_at(START, plant_options()))
    }

    pub fn with_fault(mut self, fault: impl FnMut(u64, Reading<2>) -> Option<Reading<2>> + 'static) -> Self {
        self.fault = Box::new(fault);
        self
    }

    /// Encoders of these joints freeze from a reading on.
    pub fn frozen(self, joints: &[usize], from: u64) -> Self {
        let joints = joints.to_vec();
        let mut held = [0.0; 2];
        self.with_fault(move |k, mut reading| {
            for &i in &joints {
                if k < from {
                    held[i] = reading.positions[i];
                }
                reading.positions[i] = held[i];
            }
            Some(reading)
        })
    }

    pub fn state(&self) -> ([f64; 2], [f64; 2]) {
        self.robot.plant().state()
    }

    /// At the end of the motion.
    pub fn assert_at_end(&self, tolerance: f64) {
        let (positions, _) = self.state();
        for i in 0..2 {
            let error = positions[i] - END[i];
            assert!(error.abs() < tolerance, "joint {i} is off by {error}");
        }
    }

    /// Two seconds on: braked, at rest, and within limits all the time.
    pub fn assert_stopped_safely(&mut self) {
        for _ in 0..100 {
            self.clock.advance(Duration::from_millis(20));
            let _ = self.robot.read();
            self.watch();
        }
        assert!(self.robot.plant().is_braked());
        let (_, velocities) = self.state();
        assert!(velocities.iter().all(|v| v.abs() < 1e-6), "{velocities:?}");
        self.seen.assert_within_limits();
    }

    fn watch(&mut self) {
        let (positions, velocities) = self.state();
        for i in 0..2 {
            self.seen.lowest[i] = self.seen.lowest[i].min(positions[i]);
            self.seen.highest[i] = self.seen.highest[i].max(positions[i]);
            self.seen.fastest[i] = self.seen.fastest[i].max(velocities[i].abs());
        }
    }
}

impl Transport<2, 2> for Watched {
    fn read(&mut self) -> Result<Option<Reading<2>>, TransportError> {
        let reading = self.robot.read()?;
        self.watch();
        let number = self.reads;
        self.reads += 1;
        Ok(reading.and_then(|reading| (self.fault)(number, reading)))
    }

    fn write(&mut self, inputs: &[f64; 2]) -> Result<(), TransportError> {
        self.robot.write(&inputs.map(|u| u * self.input_sign))
    }

    fn release(&mut self) -> Result<(), TransportError> {
        self.releases += 1;
        self.robot.release()
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        self.robot.brake()
    }
}

/// Oversleeps once by a span, as a busy machine does.
pub struct Oversleeping {
    pub clock: VirtualClock,
    pub at: Duration,
    pub by: Duration,
}

impl Clock for Oversleeping {
    fn now(&self) -> Duration {
        self.clock.now()
    }

    fn sleep_until(&self, wake: Duration) {
        let asleep = self.clock.now() < self.at;
        self.clock.sleep_until(wake);
        if asleep && wake >= self.at {
            self.clock.advance(self.by);
        }
    }
}

/// The loop of a controller on a watched robot and its clock.
pub type WatchedLoop<'a, C, K> = ControlLoop<Law, RestToRest<2>, C, &'a mut Watched, K, 2, 2>;

pub fn loop_with<'a, C: Controller<2, 2>>(
    settings: LoopSettings<2, 2>,
    controller: C,
    robot: &'a mut Watched,
) -> WatchedLoop<'a, C, VirtualClock> {
    let clock = robot.clock.clone();
    ControlLoop::new(settings, law(), motion(), controller, robot, clock).unwrap()
}

/// Where the loop's thread oversleeps.
pub fn run_oversleeping<C: Controller<2, 2>>(
    settings: LoopSettings<2, 2>,
    controller: C,
    robot: &mut Watched,
    [at, by]: [Duration; 2],
) -> LoopReport<2> {
    let clock = Oversleeping { clock: robot.clock.clone(), at, by };
    let control: WatchedLoop<'_, _, _> =
        ControlLoop::new(settings, law(), motion(), controller, robot, clock).unwrap();
    { control }.run()
}
