//! Effect of the thresholds and constants of a planned motion.

use super::super::numeric::levels::varied::page;
use super::super::robot::{JointLimits, Robot};
use super::inputs::longest_side;
use super::{Excitation, PlanSettings, levels, plan};

/// A link on a horizontal axis, whose weight needs 4.9 N·m.
struct Arm {
    effort: f64,
}

impl Robot for Arm {
    fn joint_names(&self) -> Vec<String> {
        vec!["arm".into()]
    }
    fn input_names(&self) -> Vec<String> {
        self.joint_names()
    }
    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"]
    }
    fn limits(&self) -> Vec<JointLimits> {
        vec![JointLimits { position: [-2.5, 0.5], velocity: 9.0, effort: self.effort }]
    }
    fn parameter_names(&self) -> Vec<String> {
        (0..10).map(|i| format!("p{i}")).collect()
    }
    fn parameters(&self) -> Vec<f64> {
        vec![2.0, 0.5, 0.0, 0.0, 0.02, 0.0, 0.16, 0.0, 0.0, 0.16]
    }
    fn bodies(&self) -> usize {
        1
    }
    fn input_matrix(&self) -> Vec<f64> {
        vec![1.0]
    }
    fn inertial_regressor(&self, y: &[f64], _: &[f64], a: &[f64], regressor: &mut [f64]) {
        regressor.fill(0.0);
        (regressor[1], regressor[2], regressor[9]) = (9.81 * y[0].cos(), -9.81 * y[0].sin(), a[0]);
    }
    fn rigid_forces(&self, y: &[f64], _: &[f64], a: &[f64], forces: &mut [f64]) {
        forces[0] = 4.905 * y[0].cos() + 0.16 * a[0];
    }
}

fn planned(effort: f64) -> String {
    let excitation =
        Excitation { period: 4.0, harmonics: 3, samples: 40, starts: 2, iterations: 20, seed: 1 };
    let settings = PlanSettings { excitation, ..PlanSettings::default() };
    let said = |findings: &[gelenk_findings::Finding]| {
        let texts: Vec<String> = findings.iter().map(|finding| finding.message.clone()).collect();
        texts.join("; ")
    };
    match plan(&Arm { effort }, &settings, &mut |_| ()) {
        Ok(found) => format!("condition {:.3}, {}", found.condition, said(&found.findings)),
        Err(error) => error.to_string(),
    }
}

/// Enough effort, effort for the weight and a small motion, and hardly that of a small motion.
#[test]
fn each_number_of_a_plan_is_halved_and_doubled() {
    let levers = [0.2, 0.5, 1.0, 0.5, 0.3, -0.1, -0.5];
    let outcomes = || {
        let plans = [100.0, 7.3, 4.0].map(|effort| (format!("{effort} N m"), planned(effort)));
        let side = ("levers".to_owned(), format!("{:?}", longest_side(&levers)));
        plans.into_iter().chain([side]).collect()
    };
    insta::assert_snapshot!("numbers_of_a_plan", page(levels::NAMES.iter(), &outcomes));
}
