//! Controllers whose model follows the learned friction, on a simulated PowerCube.

use crate::allocations;
use gelenk_runtime::adaptation::{
    Adaptation, AdaptationError, AdaptationSettings, Adaptive, DescribedForces, LearnedFriction, Measured,
    TakesModel, Trust,
};
use gelenk_runtime::control_loop::{
    ControlLoop, Controller, Cycle, End, FeedForwardPd, JointGains, JointPd, LoopSettings, VirtualClock,
};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{IdentificationSine, Sampled, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Free { parameters } = gelenk_generated::powercube_parameters);

const PERIOD: f64 = 0.01;
const GEAR: f64 = 161.0;

/// The arm with other friction: factors of the viscous and the dry terms of both joints.
fn warm(viscous: f64, dry: f64) -> Free {
    let mut arm = Free::default();
    let p = &mut arm.parameters;
    for parameter in [&mut p.beta_viscous, &mut p.gamma_viscous] {
        *parameter *= viscous;
    }
    for parameter in [&mut p.beta_tanh_5, &mut p.beta_tanh_10, &mut p.beta_tanh_20] {
        *parameter *= dry;
    }
    for parameter in [&mut p.gamma_sign, &mut p.gamma_tanh_5, &mut p.gamma_tanh_10, &mut p.gamma_tanh_100] {
        *parameter *= dry;
    }
    arm
}

fn motion(duration: f64) -> Sampled<2> {
    let sine = IdentificationSine {
        center: [0.0, 0.0],
        amplitude: [0.3, 0.4],
        first_frequency: [0.15, 0.1],
        last_frequency: [0.25, 0.2],
        sine_duration: duration,
        run_in: 2.0,
    };
    Sampled::of(&sine.motion().unwrap(), PERIOD).unwrap()
}

fn settings() -> AdaptationSettings {
    AdaptationSettings::new(PERIOD)
}

type Model = LearnedFriction<PowerCube, 2, 2>;

/// Root mean square of the position errors from 20 s on [rad], and the controller. A change of the law changes the input of its period by
/// at most the share of the learned friction that [`AdaptationSettings::blending`] passes on in a period.
fn run<C: Controller<2, 2> + TakesModel<Model> + Clone>(
    plant: Free,
    motion: &Sampled<2>,
    make: impl FnOnce(Model) -> C,
    learns: bool,
) -> ([f64; 2], Adaptive<C, PowerCube, 2, 2>) {
    let ok = |model| Ok::<C, AdaptationError>(make(model));
    let mut controller = Adaptive::new(PowerCube, settings(), ok).unwrap().unwrap();
    let options = PlantOptions { encoder_resolution: [1e-4; 2], ..PlantOptions::default() };
    let mut plant = Plant::new(plant, options).unwrap();
    let start = motion.sample(0.0);
    plant.reset(start.positions, start.velocities).unwrap();
    controller.reset(&start.positions, &[0.0; 2]);
    let (mut last, mut sums, mut count) = ([0.0; 2], [0.0; 2], 0.0);
    let (mut jump, mut learned) = ([0.0_f64; 2], [0.0_f64; 2]);
    for k in 0..(motion.duration() / PERIOD) as u32 {
        let time = f64::from(k) * PERIOD;
        let positions = Some(plant.measure().positions);
        let cycle = Cycle { time, positions, last_inputs: last, ..Cycle::default() };
        // The same step with the law of the last period.
        let kept = controller.inner().clone().step(&cycle).unwrap();
        let step = if learns { controller.step(&cycle) } else { controller.inner_mut().step(&cycle) };
        last = step.unwrap().inputs;
        if learns {
            let (_, v) = plant.state();
            let (with, without) = (controller.robot(), PowerCube);
            let [with, without] =
                [with.friction_torques(&[0.0; 2], &v), without.friction_torques(&[0.0; 2], &v)];
            for i in 0..2 {
                jump[i] = jump[i].max((last[i] - kept.inputs[i]).abs());
                learned[i] = learned[i].max((with[i] - without[i]).abs() / GEAR);
            }
        }
        plant.apply(&last, PERIOD).unwrap();
        if time > 20.0 {
            let (y, _) = plant.state();
            let desired = motion.sample(time + PERIOD).positions;
            (0..2).for_each(|i| sums[i] += (y[i] - desired[i]).powi(2));
            count += 1.0;
        }
    }
    println!("largest change of the inputs by the law {jump:?} N m, of a learned torque of {learned:?} N m");
    let share = PERIOD / (PERIOD + settings().blending);
    (0..2).for_each(|i| assert!(jump[i] <= share * learned[i], "{jump:?} {learned:?}"));
    (sums.map(|sum: f64| (sum / count).sqrt()), controller)
}

#[test]
fn the_laws_of_all_controllers_follow_the_arm() {
    let motion = motion(40.0);
    let options = |robot: &Model| {
        let mut options = MpcOptions::new(robot, PERIOD, 12);
        options.observer.disturbance_noise = [0.0; 2];
        options
    };
    let gains = JointGains::from_bandwidth(&PowerCube, &[0.0; 2], 8.0, 0.8);
    let pd = |robot| FeedForwardPd::new(JointPd::new(robot, gains).unwrap(), &motion, PERIOD, 0.01).unwrap();
    let ltv = |robot: Model| LtvMpc::<_, _, 2, 2, 4>::new(robot, &motion, options(&robot)).unwrap();
    let nmpc = |robot: Model| Nmpc::<_, _, 2, 2, 4>::new(robot, &motion, options(&robot)).unwrap();
    let warm = warm(0.7, 0.8);
    compare("joint PD", run(warm, &motion, pd, true), run(warm, &motion, pd, false));
    compare("LTV-MPC", run(warm, &motion, ltv, true), run(warm, &motion, ltv, false));
    compare("NMPC", run(warm, &motion, nmpc, true), run(warm, &motion, nmpc, false));
}

fn compare<C>(
    name: &str,
    (with, controller): ([f64; 2], Adaptive<C, PowerCube, 2, 2>),
    (without, _): ([f64; 2], Adaptive<C, PowerCube, 2, 2>),
) where
    C: Controller<2, 2> + TakesModel<Model>,
{
    println!("{name}: rms errors {with:?} rad with the learned law, {without:?} without");
    for (i, state) in controller.adaptation().states().into_iter().enumerate() {
        let state = state.unwrap();
        assert_eq!(state.trust, Trust::Learned, "{name}, joint {i}: {state:?}");
        assert!(with[i] < 0.3 * without[i], "{name}, joint {i}: {with:?} {without:?} {state:?}");
    }
}

/// A loop with its guards, on an arm as described: the option changes hardly anything.
#[test]
fn an_arm_as_described_moves_as_without_the_option() {
    let motion = motion(40.0);
    let gains = JointGains::from_bandwidth(&PowerCube, &[0.0; 2], 8.0, 0.8);
    let law = JointPd::new(PowerCube, gains).unwrap();
    let loop_settings = LoopSettings::for_robot(1.0 / PERIOD, &PowerCube);
    let pd =
        |robot| FeedForwardPd::new(JointPd::new(robot, gains)?, &motion, PERIOD, 0.01).map_err(Into::into);
    let controller: Result<_, Box<dyn std::error::Error>> = Adaptive::new(PowerCube, settings(), pd).unwrap();
    let clock = VirtualClock::new();
    let mut plant = Plant::new(warm(1.0, 1.0), PlantOptions::default()).unwrap();
    plant.reset(motion.sample(0.0).positions, [0.0; 2]).unwrap();
    let robot = InProcess::new(plant, clock.clone(), loop_settings.period());
    let mut control =
        ControlLoop::new(loop_settings, law, &motion, controller.unwrap(), robot, clock).unwrap();
    let report = control.run();
    assert_eq!(report.end, End::Finished, "{report}");
    for state in control.controller().adaptation().states().into_iter().flatten() {
        assert!(state.acting[0].abs() < 0.02, "{state:?}");
    }
}

/// Teaches friction that is a quarter smaller, along a sine.
fn teach(adaptation: &mut Adaptation<2>) {
    for k in 0..6000 {
        let t = PERIOD * f64::from(k);
        let [y, v, a] = [
            [0.4 * t.sin(), 0.4 * (1.3 * t).sin()],
            [0.4 * t.cos(), 0.52 * (1.3 * t).cos()],
            [-0.4 * t.sin(), -0.676 * (1.3 * t).sin()],
        ];
        let described = DescribedForces::of(&PowerCube, &y, &v, &a);
        let torques = core::array::from_fn(|i| described.forces[i] - 0.25 * described.friction[i]);
        let measured = Measured { positions: Some(y), torques, saturated: [false; 2], periods: 1 };
        adaptation.step(&measured, |y, v, a| DescribedForces::of(&PowerCube, y, v, a));
    }
    for state in adaptation.states().into_iter().flatten() {
        assert_eq!(state.trust, Trust::Learned, "{state:?}");
    }
}

#[test]
fn nothing_is_allocated() {
    let mut adaptation = Adaptation::for_robot(&PowerCube, settings()).unwrap();
    let before = allocations::count();
    teach(&mut adaptation);
    assert_eq!(allocations::count() - before, 0);
}
