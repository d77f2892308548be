//! Rows of robots whose values are known.

use super::super::methods::library::Library;
use super::super::robot::{JointLimits, Robot};
use super::*;
use gelenk_findings::Subject;

/// Two masses of 2 kg and 3 kg, with viscous friction described on the second joint.
struct Masses(Vec<Shaft>);

impl Robot for Masses {
    fn joint_names(&self) -> Vec<String> {
        ["one", "two"].map(String::from).to_vec()
    }

    fn input_names(&self) -> Vec<String> {
        ["left", "right"].map(String::from).to_vec()
    }

    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; 2]
    }

    fn limits(&self) -> Vec<JointLimits> {
        vec![JointLimits { position: [-1.0, 1.0], velocity: 2.0, effort: 5.0 }; 2]
    }

    fn parameter_names(&self) -> Vec<String> {
        ["m_one", "m_two"].map(String::from).to_vec()
    }

    fn parameters(&self) -> Vec<f64> {
        vec![2.0, 3.0]
    }

    fn bodies(&self) -> usize {
        0
    }

    fn input_matrix(&self) -> Vec<f64> {
        vec![10.0, 10.0, 10.0, -10.0]
    }

    fn shafts(&self) -> Vec<Shaft> {
        self.0.clone()
    }

    fn joint_terms(&self) -> Vec<JointTerm> {
        vec![JointTerm { joint: 1, basis: "v".into(), coefficient: 0.5 }]
    }

    fn joint_term_values(&self, _: &[f64], v: &[f64], values: &mut [f64]) {
        values[0] = v[1];
    }

    fn inertial_regressor(&self, _: &[f64], _: &[f64], a: &[f64], regressor: &mut [f64]) {
        regressor.copy_from_slice(&[a[0], 0.0, 0.0, a[1]]);
    }

    fn rigid_forces(&self, _: &[f64], _: &[f64], a: &[f64], forces: &mut [f64]) {
        forces.copy_from_slice(&[2.0 * a[0], 3.0 * a[1]]);
    }
}

fn shaft(name: &str, joint: usize, ratios: [f64; 2]) -> Shaft {
    Shaft { name: name.into(), joint, ratios: ratios.to_vec(), torque: 0.1 }
}

#[test]
fn a_differential_has_the_torques_of_its_motors_as_rows() {
    let robot = Masses(vec![shaft("left", 0, [10.0, 10.0]), shaft("right", 1, [10.0, -10.0])]);
    let shafts = RobotRows::of(&robot);
    assert_eq!(shafts.joint_names(), ["left", "right"]);
    assert_eq!(shafts.input_matrix(), [1.0, 0.0, 0.0, 1.0]);
    assert_eq!(shafts.limits()[0].velocity, 40.0);
    let [_, along, _] = shafts.instant(&[vec![0.0; 2], vec![0.3, 0.1], vec![0.0; 2]]);
    assert_eq!([along, shafts.speeds(&[2.0, 3.0])], [[4.0, 2.0], [50.0, 50.0]]);
    // ÿ = (0.4, −0.2) and ẏ = (0.3, 0.1): forces (0.8, −0.6 + 0.05), and B u are the forces.
    let (v, a) = ([4.0, 2.0], [2.0, 6.0]);
    let mut forces = [0.0; 2];
    shafts.rigid_forces(&[0.0; 2], &v, &a, &mut forces);
    let expected = [(0.8 - 0.55) / 20.0, (0.8 + 0.55) / 20.0];
    let mut regressor = [0.0; 6];
    shafts.inertial_regressor(&[0.0; 2], &v, &a, &mut regressor);
    for (row, (force, expected)) in forces.iter().zip(expected).enumerate() {
        assert!((force - expected).abs() < 1e-15, "{forces:?}");
        let by_columns: f64 =
            regressor[3 * row..3 * row + 3].iter().zip([2.0, 3.0, 0.5]).map(|(w, p)| w * p).sum();
        assert!((by_columns - expected).abs() < 1e-15, "{regressor:?}");
    }
    assert_eq!(shafts.parameter_names()[2], "friction of two: v");
}

#[test]
fn slopes_of_shafts_are_those_of_joints() {
    let library = Library::new(&["v", "tanh(20*v)", "abs(tanh(20*v))", "tanh(v)"], &["v"]).unwrap();
    assert_eq!(library.scaled(80.0).unwrap().terms(), ["v", "tanh(0.25*v)", "abs(tanh(0.25*v))", "tanh(v)"]);
    assert_eq!(library.scaled(1.0).unwrap().terms(), library.terms());
}

#[test]
fn rows_of_shafts_are_called_shafts() {
    // A shaft with the name of a joint, and a joint that is not replaced by a shaft.
    let robot = Masses(vec![shaft("two", 0, [10.0, 10.0])]);
    let shafts = RobotRows::of(&robot);
    assert_eq!(shafts.subject(0), Subject::Shaft("two".into()));
    assert_eq!(shafts.subject(1), Subject::Joint("two".into()));
    assert!(ShaftRows::of(&Masses(Vec::new())).is_none());
}
