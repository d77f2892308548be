//! A robot with shafts instead of some joints in the rows of its equations.

use super::super::pose::QuaternionJoint;
use super::super::robot::{Instant, JointLimits, Robot};
use super::super::run::PreparedRun;
use super::Shaft;
use super::rows::ShaftRows;
use gelenk_findings::Subject;

/// A robot as the estimate uses it: with the rows of its joints, or with shafts instead of some joints.
///
/// The factors of the described friction of replaced joints follow the inertial parameters. Positions are those of the rows
/// (joints and shafts). For robots with quaternions, positions are those of the joints.
#[derive(Clone)]
pub(crate) struct RobotRows<'a> {
    robot: &'a dyn Robot,
    rows: Option<ShaftRows>,
}

impl<'a> RobotRows<'a> {
    /// The robot with its shafts in the rows of the joints that they replace.
    pub(crate) fn of(robot: &'a dyn Robot) -> Self {
        Self { robot, rows: ShaftRows::of(robot) }
    }

    /// The robot with given rows of shafts; with `None`, all rows are those of joints.
    ///
    /// - `rows`: rows of the same robot
    pub(crate) fn new(robot: &'a dyn Robot, rows: Option<ShaftRows>) -> Self {
        Self { robot, rows }
    }

    /// The rows of shafts; `None` if all rows are those of joints.
    pub(crate) fn of_shafts(&self) -> Option<&ShaftRows> {
        self.rows.as_ref()
    }

    /// The runs with the signals of the rows instead of the signals of the joints.
    pub(crate) fn along(&self, runs: Vec<PreparedRun>) -> Vec<PreparedRun> {
        match self.of_shafts() {
            Some(rows) => runs.into_iter().map(|run| rows.along(run)).collect(),
            None => runs,
        }
    }

    /// Motion of the rows from a motion of the joints at one time.
    pub(crate) fn instant(&self, joints: &Instant) -> Instant {
        self.of_shafts().map_or_else(|| joints.clone(), |rows| rows.instant(joints))
    }

    /// Largest speeds of the rows from the largest speeds of the joints.
    pub(crate) fn speeds(&self, joints: &[f64]) -> Vec<f64> {
        self.of_shafts().map_or_else(|| joints.to_vec(), |rows| rows.speeds(joints))
    }

    /// The shafts that replace joints.
    pub(crate) fn shafts_of_rows(&self) -> &[Shaft] {
        self.of_shafts().map_or(&[], ShaftRows::shafts)
    }

    fn terms(&self) -> usize {
        self.of_shafts().map_or(0, |rows| rows.joint_terms().len())
    }

    /// Values of the described friction terms of replaced joints at a motion of the joints.
    fn term_values(&self, y: &[f64], v: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.terms()];
        self.robot.joint_term_values(y, v, &mut values);
        values
    }
}

/// Implements functions by calls of the same functions of the robot.
macro_rules! as_of_robot {
    ($($name:ident: $result:ty,)*) => {$(
        fn $name(&self) -> $result {
            self.robot.$name()
        }
    )*};
}

impl Robot for RobotRows<'_> {
    as_of_robot! {
        input_names: Vec<String>,
        bodies: usize,
        quaternion_joints: Vec<QuaternionJoint>,
        described_currents: Vec<bool>,
        has_inputs_at_frames: bool,
        unmeasured: Vec<bool>,
        own_inputs: Vec<bool>,
        takes_inertia: Vec<bool>,
    }

    fn joint_names(&self) -> Vec<String> {
        let mut names = self.robot.joint_names();
        for shaft in self.shafts_of_rows() {
            names[shaft.joint].clone_from(&shaft.name);
        }
        names
    }

    fn subject(&self, row: usize) -> Subject {
        let shaft = self.of_shafts().and_then(|rows| rows.shaft(row));
        shaft.map_or_else(|| self.robot.subject(row), |shaft| Subject::Shaft(shaft.name.clone()))
    }

    fn position_units(&self) -> Vec<&'static str> {
        let mut units = self.robot.position_units();
        self.shafts_of_rows().iter().for_each(|shaft| units[shaft.joint] = "rad");
        units
    }

    fn limits(&self) -> Vec<JointLimits> {
        let of_joints = self.robot.limits();
        let mut limits = of_joints.clone();
        for shaft in self.shafts_of_rows() {
            let turning = shaft.ratios.iter().zip(&of_joints).filter(|(ratio, _)| **ratio != 0.0);
            limits[shaft.joint] = JointLimits {
                position: [f64::NEG_INFINITY, f64::INFINITY],
                velocity: turning.map(|(ratio, joint)| ratio.abs() * joint.velocity).sum(),
                effort: shaft.torque,
            };
        }
        limits
    }

    fn parameter_names(&self) -> Vec<String> {
        let mut names = self.robot.parameter_names();
        let joints = self.robot.joint_names();
        let terms = self.of_shafts().map_or(&[][..], ShaftRows::joint_terms).iter();
        names.extend(terms.map(|term| format!("friction of {}: {}", joints[term.joint], term.basis)));
        names
    }

    fn parameters(&self) -> Vec<f64> {
        let mut values = self.robot.parameters();
        values.extend(
            self.of_shafts().map_or(&[][..], ShaftRows::joint_terms).iter().map(|term| term.coefficient),
        );
        values
    }

    fn input_matrix(&self) -> Vec<f64> {
        let joints = self.robot.input_matrix();
        let Some(rows) = self.of_shafts() else { return joints };
        let mut matrix = vec![0.0; joints.len()];
        rows.forces(&joints, self.robot.input_names().len(), &mut matrix);
        let largest = matrix.iter().fold(0.0_f64, |largest, b| largest.max(b.abs()));
        // Rounding in differences of equal numbers would let inputs act on other joints.
        matrix.iter_mut().filter(|b| b.abs() < 1e-12 * largest).for_each(|b| *b = 0.0);
        matrix
    }

    fn input_forces(&self, y: &[f64], u: &[f64], forces: &mut [f64]) {
        let Some(rows) = self.of_shafts() else { return self.robot.input_forces(y, u, forces) };
        let mut joints = vec![0.0; forces.len()];
        self.robot.input_forces(&rows.positions(y), u, &mut joints);
        rows.forces(&joints, 1, forces);
    }

    fn speed_scales(&self) -> Vec<f64> {
        let rows = 0..self.robot.joint_names().len();
        rows.map(|row| self.of_shafts().map_or(1.0, |rows| rows.speed_scale(row))).collect()
    }

    fn friction(&self, row: usize, v: f64) -> f64 {
        self.robot.friction(row, v)
    }

    /// Gravity of the robot; `None` if shafts replace joints. The direction of gravity is then not tested.
    fn gravity(&self) -> Option<[f64; 3]> {
        self.robot.gravity().filter(|_| self.rows.is_none())
    }

    fn regressor_at_rest(&self, y: &[f64], gravity: [f64; 3], regressor: &mut [f64]) {
        self.robot.regressor_at_rest(y, gravity, regressor);
    }

    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        let Some(rows) = self.of_shafts() else { return self.robot.inertial_regressor(y, v, a, regressor) };
        let (joints, inertial) = (v.len(), rows.first_term());
        let [y, v, a] = [rows.positions(y), rows.joint_motion(v), rows.joint_motion(a)];
        let mut bodies = vec![0.0; joints * inertial];
        self.robot.inertial_regressor(&y, &v, &a, &mut bodies);
        let columns = inertial + self.terms();
        let mut of_joints = vec![0.0; joints * columns];
        for (joint, row) in of_joints.chunks_exact_mut(columns.max(1)).enumerate() {
            row[..inertial].copy_from_slice(&bodies[joint * inertial..(joint + 1) * inertial]);
        }
        for ((term, value), place) in rows.joint_terms().iter().zip(self.term_values(&y, &v)).zip(inertial..)
        {
            of_joints[term.joint * columns + place] = value;
        }
        rows.forces(&of_joints, columns, regressor);
    }

    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        let Some(rows) = self.of_shafts() else { return self.robot.rigid_forces(y, v, a, forces) };
        let [y, v, a] = [rows.positions(y), rows.joint_motion(v), rows.joint_motion(a)];
        let mut of_joints = vec![0.0; forces.len()];
        self.robot.rigid_forces(&y, &v, &a, &mut of_joints);
        for (term, value) in rows.joint_terms().iter().zip(self.term_values(&y, &v)) {
            of_joints[term.joint] += term.coefficient * value;
        }
        rows.forces(&of_joints, 1, forces);
    }
}
