//! Load-dependent friction of a gear, together with inertia and other friction.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun};
use super::super::{Estimate, EstimationSettings, Uncertain, estimate};
use super::data::as_simulated;
use super::pendulum::{FRICTION, Pendulum, STEEPNESS};
use gelenk_findings::{Severity, texts};

/// A run along sines whose forces contain load-dependent friction with these coefficients.
fn run(truth: &Pendulum, shares: [f64; 2], random: &mut SplitMix64) -> PreparedRun {
    let phases: [f64; 6] = std::array::from_fn(|_| std::f64::consts::TAU * random.uniform());
    let columns = || vec![Vec::new(); 2];
    let (mut positions, mut velocities, mut accelerations) = (columns(), columns(), columns());
    let (mut efforts, mut times) = (columns(), Vec::new());
    for i in 0..3000 {
        let t = 0.008 * f64::from(i);
        let mut motion = [[0.0; 2]; 3];
        for (k, phase) in phases.iter().enumerate() {
            let (joint, w) = (k % 2, 0.9 + 0.7 * (k / 2) as f64 + 0.3 * (k % 2) as f64);
            let ((s, c), size) = ((w * t + phase).sin_cos(), 0.8 / (1.0 + (k / 2) as f64));
            let waves = [size * s, size * w * c, -size * w * w * s];
            motion.iter_mut().zip(waves).for_each(|(sum, wave)| sum[joint] += wave);
        }
        let [y, v, a] = motion;
        let mut load = [0.0; 2];
        truth.rigid_forces(&y, &v, &a, &mut load);
        for j in 0..2 {
            let direction = (STEEPNESS * v[j]).tanh();
            let friction = FRICTION[j][0] * v[j] + (FRICTION[j][1] + shares[j] * load[j].abs()) * direction;
            efforts[j].push(load[j] + friction + 0.1 + 0.1 * random.normal());
            positions[j].push(y[j]);
            velocities[j].push(v[j]);
            accelerations[j].push(a[j]);
        }
        times.push(t);
    }
    as_simulated(times, [positions, velocities, accelerations, efforts], Effort::Input)
}

fn estimated(shares: [f64; 2], load_friction: bool, seed: u64) -> (Pendulum, Estimate) {
    let mut random = SplitMix64::new(seed);
    let truth = Pendulum::described().other(0.1, &mut random);
    let settings = EstimationSettings {
        load_friction,
        steepness: Some(vec![STEEPNESS; 2]),
        folds: 5,
        ..EstimationSettings::default()
    };
    let run = run(&truth, shares, &mut random);
    (truth, estimate(&Pendulum::described(), &[run], &settings, &mut |_| ()).unwrap())
}

#[test]
fn shares_of_the_load_come_back_beside_masses_and_friction() {
    let shares = [0.15, 0.08];
    let (truth, found) = estimated(shares, true, 3);
    for ((joint, share), friction) in found.joints.iter().zip(shares).zip(FRICTION) {
        let term = joint.load.as_ref().unwrap();
        let value = term.coefficient;
        assert!((value.value - share).abs() < 4.0 * value.standard_error, "{term:?} {share}");
        assert!((value.value / share - 1.0).abs() < 0.1 && value.standard_error < 0.1 * share, "{term:?}");
        for (term, truth) in joint.terms.iter().zip(friction) {
            assert!((term.coefficient.value / truth - 1.0).abs() < 0.05, "{term:?} {truth}");
        }
        assert!((joint.sigma - 0.1).abs() < 0.01 && joint.held_out_r_squared > 0.99, "{joint:?}");
    }
    assert!((found.parameters[11].value / truth.parameters[11] - 1.0).abs() < 0.01);
    assert!(
        !texts(&found.findings, Severity::Warning).join(" ").contains("--load-friction"),
        "{:?}",
        texts(&found.findings, Severity::Warning)
    );
    // Without the term the fit is worse, and a finding names the missing term.
    let (_, without) = estimated(shares, false, 3);
    let lacking = without.findings.iter().filter(|finding| finding.code == "friction-under-load");
    let lacking: Vec<f64> = lacking.filter_map(|finding| finding.value("share of the load")).collect();
    assert!(lacking.iter().any(|share| (share - shares[0]).abs() < 0.05), "{:?}", without.findings);
    assert!(without.joints[0].sigma > 3.0 * found.joints[0].sigma);
    assert!(without.joints.iter().all(|joint| joint.load.is_none()) && without.load_friction.is_empty());
}

#[test]
fn friction_that_does_not_grow_with_the_load_gets_no_term() {
    let (_, found) = estimated([0.0, 0.0], true, 5);
    for joint in &found.joints {
        let by_chance = |share: Uncertain| share.value < 3.0 * share.standard_error && share.value < 0.01;
        assert!(joint.load.as_ref().is_none_or(|term| by_chance(term.coefficient)), "{joint:?}");
    }
    let (_, plain) = estimated([0.0, 0.0], false, 5);
    assert!(
        !texts(&plain.findings, Severity::Warning).join(" ").contains("--load-friction"),
        "{:?}",
        texts(&plain.findings, Severity::Warning)
    );
}

/// One motor drives both joints, so the load of neither gear is known.
struct Coupled(Pendulum);

impl Robot for Coupled {
    fn joint_names(&self) -> Vec<String> {
        self.0.joint_names()
    }
    fn input_names(&self) -> Vec<String> {
        self.0.input_names()
    }
    fn position_units(&self) -> Vec<&'static str> {
        self.0.position_units()
    }
    fn limits(&self) -> Vec<super::super::super::robot::JointLimits> {
        self.0.limits()
    }
    fn parameter_names(&self) -> Vec<String> {
        self.0.parameter_names()
    }
    fn parameters(&self) -> Vec<f64> {
        self.0.parameters()
    }
    fn bodies(&self) -> usize {
        self.0.bodies()
    }
    fn input_matrix(&self) -> Vec<f64> {
        vec![1.0, 1.0, 0.0, 1.0]
    }
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        self.0.inertial_regressor(y, v, a, regressor);
    }
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        self.0.rigid_forces(y, v, a, forces);
    }
}

#[test]
fn loads_are_refused_where_no_joint_has_an_input_of_its_own() {
    let robot = Coupled(Pendulum::described());
    assert_eq!(robot.own_inputs(), [false, false]);
    assert_eq!(robot.0.own_inputs(), [true, true]);
    let run = PreparedRun { effort: Effort::Joint, ..run(&robot.0, [0.1, 0.1], &mut SplitMix64::new(1)) };
    let settings = EstimationSettings {
        load_friction: true,
        folds: 4,
        robust_passes: 0,
        ..EstimationSettings::default()
    };
    let fault = estimate(&robot, &[run], &settings, &mut |_| ()).unwrap_err().to_string();
    assert!(fault.contains("a moving joint with an input that drives only this joint"), "{fault}");
}
