//! Computed torque: the errors of an exact model decay as the gains say, wherever the robot is.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{
    AccelerationGains, ComputedTorque, ComputedTorqueError, ControllerFault, JointGains, JointLaw, JointPd,
};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{RestToRest, Sample, Trajectory};

gelenk_runtime::dynamics!(struct Ur5 = gelenk_generated::ur5);
gelenk_runtime::dynamics!(struct Puma = gelenk_generated::puma560);
gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda);
gelenk_runtime::dynamics!(struct TwoArm = gelenk_generated::two_arm);
gelenk_runtime::dynamics!(struct CartPole = gelenk_generated::cart_pole);

const OMEGA: f64 = 8.0;
const DAMPING: f64 = 0.6;

/// Error of `ë + 2 ζ ω ė + ω² e = 0` from e_0 at rest (Siciliano et al. 2009, appendix; any book on
/// vibrations).
fn decayed(e0: f64, t: f64) -> f64 {
    let damped = OMEGA * (1.0 - DAMPING * DAMPING).sqrt();
    let slope = DAMPING * OMEGA / damped;
    e0 * (-DAMPING * OMEGA * t).exp() * ((damped * t).cos() + slope * (damped * t).sin())
}

/// Largest distance between the errors of a simulated robot and their closed form, relative to the largest
/// error at the start.
fn deviation<D: Dynamics<N, M> + Copy, const N: usize, const M: usize>(
    model: D,
    beside: f64,
    period: f64,
) -> f64 {
    let motion = RestToRest::new(
        core::array::from_fn(|i| 0.3 - 0.1 * i as f64),
        core::array::from_fn(|i| 0.1 + 0.2 * (i % 3) as f64),
        1.0,
    )
    .unwrap();
    let gains = AccelerationGains::from_bandwidth(OMEGA, DAMPING);
    let law = ComputedTorque::new(model, gains).unwrap();
    let mut plant = Plant::new(model, PlantOptions::default()).unwrap();
    let e0: [f64; N] = core::array::from_fn(|i| beside * (1.0 - 0.3 * i as f64));
    let start = motion.sample(0.0).positions;
    let at: [f64; N] = core::array::from_fn(|i| start[i] - e0[i]);
    plant.reset(at, [0.0; N]).unwrap();
    let mut worst = 0.0_f64;
    for k in 0..(1.2 / period) as u32 {
        let desired = motion.sample(f64::from(k) * period);
        let (y, v) = plant.state();
        let inputs = law.inputs(&desired, &y, &v).unwrap();
        plant.apply(&inputs, period).unwrap();
        let t = f64::from(k + 1) * period;
        let (y, desired) = (plant.state().0, motion.sample(t).positions);
        for i in 0..N {
            worst = worst.max((desired[i] - y[i] - decayed(e0[i], t)).abs());
        }
    }
    worst / beside
}

/// Inputs that are held over a period are late by half of it: the deviation from continuous feedback is of
/// first order in it.
#[test]
fn errors_decay_as_the_gains_say_for_every_robot() {
    let check = |name: &str, deviation: &dyn Fn(f64) -> f64| {
        let (coarse, fine) = (deviation(2e-3), deviation(1e-3));
        assert!(fine < 0.01, "{name}: {fine}");
        let ratio = coarse / fine;
        assert!((1.8..2.2).contains(&ratio), "{name}: {coarse} {fine}");
    };
    // Half a radian away: not a small error.
    check("Panda", &|period| deviation(Panda, 0.5, period));
    check("UR5", &|period| deviation(Ur5, 0.5, period));
    check("two arms", &|period| deviation(TwoArm, 0.3, period));
}

/// The same law from its parts: M, k, q and B.
#[test]
fn the_law_is_its_equation() {
    let gains = AccelerationGains { position: [90.0, 40.0], velocity: [11.0, 7.0] };
    let law = ComputedTorque::new(PowerCube, gains).unwrap();
    let desired = Sample { positions: [0.2, 0.1], velocities: [0.4, -0.3], accelerations: [1.0, 2.0] };
    let (y, v) = ([0.15, 0.3], [0.5, 0.1]);
    let inputs = law.inputs(&desired, &y, &v).unwrap();
    let (mass, coriolis) = (PowerCube.mass_matrix(&y), PowerCube.coriolis_forces(&y, &v));
    let (applied, gears) = (PowerCube.applied_forces(&y, &v), PowerCube.input_matrix(&y));
    let a = [1.0 + 11.0 * (0.4 - 0.5) + 90.0 * (0.2 - 0.15), 2.0 + 7.0 * (-0.3 - 0.1) + 40.0 * (0.1 - 0.3)];
    for i in 0..2 {
        let forces = mass[i][0] * a[0] + mass[i][1] * a[1] + coriolis[i] - applied[i];
        let made = gears[i][0] * inputs[0] + gears[i][1] * inputs[1];
        assert!((forces - made).abs() < 1e-10, "{forces} {made}");
    }
}

/// Far from its trajectory the joint PD's error depends on the pose, computed torque's does not.
#[test]
fn large_errors_decay_like_small_ones_and_with_the_joint_pd_they_do_not() {
    let period = 1e-3;
    let gains = JointGains::from_bandwidth(&Puma, &[0.0; 6], OMEGA, DAMPING);
    let pd = JointPd::new(Puma, gains).unwrap();
    let law = ComputedTorque::new(Puma, AccelerationGains::from_bandwidth(OMEGA, DAMPING)).unwrap();
    let goal = Sample::at_rest([0.5, -0.8, 1.2, 0.3, 0.4, -0.2]);
    let error = |law: &dyn JointLaw<6, 6>| {
        let mut plant = Plant::new(Puma, PlantOptions::default()).unwrap();
        plant.reset([0.0; 6], [0.0; 6]).unwrap();
        let mut worst = 0.0_f64;
        for k in 1..=400 {
            let (y, v) = plant.state();
            plant.apply(&law.inputs(&goal, &y, &v).unwrap(), period).unwrap();
            let t = f64::from(k) * period;
            for i in 0..6 {
                let e = goal.positions[i] - plant.state().0[i];
                worst = worst.max((e - decayed(goal.positions[i], t)).abs());
            }
        }
        worst
    };
    let (exact, independent) = (error(&law), error(&pd));
    assert!(exact < 0.02, "{exact}");
    assert!(independent > 10.0 * exact, "{independent} {exact}");
}

#[test]
fn robots_with_fewer_drives_than_joints_are_refused() {
    let gains = AccelerationGains::from_bandwidth(OMEGA, DAMPING);
    let error = ComputedTorque::new(CartPole, gains).unwrap_err();
    assert_eq!(error, ComputedTorqueError::Underactuated { joint: 1, name: "pole" });
    assert_eq!(
        error.to_string(),
        "the inputs cannot produce an arbitrary force at joint pole. Computed torque needs a drive for every coordinate. Use \
         `JointPd` instead"
    );
}

#[test]
fn what_is_no_number_is_told() {
    let bad = AccelerationGains { position: [1.0, f64::INFINITY], velocity: [1.0; 2] };
    assert_eq!(
        ComputedTorque::new(PowerCube, bad).unwrap_err().to_string(),
        "setting gains.position[gamma] of the loop is inf, but must be finite and not negative"
    );
    let gains = AccelerationGains::from_bandwidth(OMEGA, DAMPING);
    let law = ComputedTorque::new(PowerCube, gains).unwrap();
    let rest = Sample::at_rest([0.0; 2]);
    for bad in [f64::NAN, f64::INFINITY, 1e308] {
        let faults = [
            law.inputs(&rest, &[bad, 0.0], &[0.0; 2]),
            law.inputs(&rest, &[0.0; 2], &[0.0, bad]),
            law.inputs(&Sample::at_rest([bad; 2]), &[0.0; 2], &[0.0; 2]),
        ];
        assert_eq!(faults, [Err(ControllerFault::NotFinite); 3], "{bad}");
    }
}
