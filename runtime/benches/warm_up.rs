//! The first step of a controller after a pause, with and without the loop's warm-up:
//!
//! ```text
//! cargo bench -p gelenk-runtime --bench warm_up
//! ```
//!
//! The loop runs at 50 Hz on the monotonic clock against a robot that is where it should be. In the pause
//! between two periods nothing happens, or another program does its work: here 64 MiB are walked through,
//! which pushes the controller's code and data out of the caches. Printed are median, 99 % and worst of the
//! controller's steps, and their ratios.

use gelenk_runtime::control_loop::{
    AccelerationGains, Command, ComputedTorque, ControlLoop, Controller, ControllerFault, Cycle,
    FeedForwardPd, JointGains, JointPd, LawController, LoopReport, LoopSettings, MonotonicClock,
    RealtimeRequest,
};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::trajectory::{RestToRest, Trajectory};
use gelenk_runtime::transport::{Brakes, Reading, Transport, TransportError};
use std::error::Error;
use std::hint::black_box;
use std::time::{Duration, Instant};

gelenk_runtime::dynamics!(
    struct PowerCube = gelenk_generated::powercube
);
gelenk_runtime::dynamics!(
    struct Ur5 = gelenk_generated::ur5
);

const RATE: f64 = 50.0;
const DURATION: f64 = 5.0;
/// Larger than any last-level cache of a robot's computer.
const MEMORY: usize = 64 << 20;

/// A robot that is where the trajectory wants it, and a neighbour that fills the caches after each input.
struct Obedient<const N: usize> {
    motion: RestToRest<N>,
    period: u32,
    running: bool,
    memory: Option<Vec<u64>>,
}

impl<const N: usize, const M: usize> Transport<N, M> for Obedient<N> {
    fn read(&mut self) -> Result<Option<Reading<N>>, TransportError> {
        let time = f64::from(self.period) / RATE;
        self.period += u32::from(self.running);
        let brakes = if self.running { Brakes::Released } else { Brakes::Engaged };
        Ok(Some(Reading::of(self.motion.sample(time).positions, brakes)))
    }

    fn write(&mut self, _: &[f64; M]) -> Result<(), TransportError> {
        if let Some(memory) = &mut self.memory {
            for line in memory.chunks_mut(8) {
                line[0] = line[0].wrapping_add(1);
            }
            black_box(memory);
        }
        Ok(())
    }

    fn release(&mut self) -> Result<(), TransportError> {
        self.running = true;
        Ok(())
    }

    fn brake(&mut self) -> Result<(), TransportError> {
        self.running = false;
        Ok(())
    }
}

/// Times its steps.
struct Timed<'t, C> {
    controller: C,
    times: &'t mut Vec<Duration>,
}

impl<C: Controller<N, M>, const N: usize, const M: usize> Controller<N, M> for Timed<'_, C> {
    fn reset(&mut self, positions: &[f64; N], inputs: &[f64; M]) {
        self.controller.reset(positions, inputs);
    }

    fn step(&mut self, cycle: &Cycle<N, M>) -> Result<Command<M>, ControllerFault> {
        let begin = Instant::now();
        let command = self.controller.step(cycle);
        self.times.push(begin.elapsed());
        command
    }

    fn warm_up(&mut self, next: &Cycle<N, M>) {
        self.controller.warm_up(next);
    }
}

/// Median, 99 % and worst (µs).
fn quantiles(times: &mut [Duration]) -> [f64; 3] {
    times.sort();
    let at = |share: f64| {
        let index = (share * (times.len() - 1) as f64).round() as usize;
        times[index].as_secs_f64() * 1e6
    };
    [at(0.5), at(0.99), at(1.0)]
}

fn run<D, C, const N: usize, const M: usize>(
    model: D,
    motion: RestToRest<N>,
    controller: C,
    warm_up: f64,
    crowded: bool,
) -> Result<([f64; 3], LoopReport<N>), Box<dyn Error>>
where
    D: Dynamics<N, M> + Copy,
    C: Controller<N, M>,
{
    let settings = LoopSettings {
        warm_up,
        hold_periods: 1000,
        following_error: [10.0; N],
        input_limits: [[-1e6, 1e6]; M],
        ..LoopSettings::for_robot(RATE, &model)
    };
    let start = motion.sample(0.0).positions;
    let gains = JointGains::from_bandwidth(&model, &start, 10.0, 0.7);
    let mut times = Vec::with_capacity(1000);
    let robot = Obedient { motion, period: 0, running: false, memory: crowded.then(|| vec![0; MEMORY / 8]) };
    let timed = Timed { controller, times: &mut times };
    let law = JointPd::new(model, gains)?;
    let mut control = ControlLoop::new(settings, law, motion, timed, robot, MonotonicClock)?;
    let report = control.run();
    drop(control);
    Ok((quantiles(&mut times), report))
}

fn compare<D, C, const N: usize, const M: usize>(
    name: &str,
    model: D,
    motion: RestToRest<N>,
    controller: impl Fn() -> Result<C, Box<dyn Error>>,
) -> Result<(), Box<dyn Error>>
where
    D: Dynamics<N, M> + Copy,
    C: Controller<N, M>,
{
    for crowded in [false, true] {
        let pause = if crowded { "64 MiB" } else { "quiet" };
        let (cold, _) = run(model, motion, controller()?, 0.0, crowded)?;
        let (warm, report) = run(model, motion, controller()?, 2e-3, crowded)?;
        let show = |[median, most, worst]: [f64; 3]| format!("{median:8.1} {most:8.1} {worst:8.1}");
        println!(
            "{name:24} {pause:8} {}   {}   {:6.2} {:6.2} {:6.2}{}",
            show(cold),
            show(warm),
            cold[0] / warm[0],
            cold[1] / warm[1],
            cold[2] / warm[2],
            if report.counts.late_warm_ups > 0 {
                format!("   warm-ups left out after {}", report.counts.warm_ups)
            } else {
                String::new()
            }
        );
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("{}", RealtimeRequest::default().apply());
    println!(
        "{:33} {:26}   {:26}   without/with",
        "steps [µs]: median, 99 %, worst", "without warm-up", "with warm-up"
    );
    let arm = RestToRest::new([-0.6, 0.4], [0.8, -0.5], DURATION)?;
    let robot = RestToRest::new([0.1; 6], [0.5, -0.8, 0.9, -0.4, 0.3, 0.2], DURATION)?;
    let period = 1.0 / RATE;
    compare("joint PD, UR5", Ur5, robot, || {
        let gains = JointGains::from_bandwidth(&Ur5, &[0.1; 6], 10.0, 0.7);
        let law = JointPd::new(Ur5, gains)?;
        Ok(FeedForwardPd::new(law, robot, period, 0.01)?)
    })?;
    compare("computed torque, UR5", Ur5, robot, || {
        let law = ComputedTorque::new(Ur5, AccelerationGains::from_bandwidth(10.0, 0.7))?;
        Ok(LawController::new(law, robot, period, 0.01)?)
    })?;
    compare("LTV-MPC, PowerCube", PowerCube, arm, || {
        let options = MpcOptions::new(&PowerCube, period, 20);
        Ok(LtvMpc::new(PowerCube, arm, options)?)
    })?;
    compare("LTV-MPC, UR5", Ur5, robot, || {
        let options = MpcOptions::new(&Ur5, period, 20);
        Ok(LtvMpc::new(Ur5, robot, options)?)
    })?;
    compare("NMPC, PowerCube", PowerCube, arm, || {
        let options = MpcOptions::new(&PowerCube, period, 20);
        Ok(Nmpc::new(PowerCube, arm, options)?)
    })?;
    Ok(())
}
