//! Arms of revolute joints with their regressor, derived from the equations of a body's wrench.

use super::super::super::robot::{JointLimits, Robot};
use nalgebra::{Matrix3, Rotation3, SMatrix, Unit, Vector3};

/// A joint with its origin and orientation in the frame before it, and its axis in its own frame.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub origin: Vector3<f64>,
    pub turned: Rotation3<f64>,
    pub axis: Unit<Vector3<f64>>,
}

/// A chain of bodies. Each body has the parameters m, m c, and Ixx Ixy Ixz Iyy Iyz Izz about the frame of its joint. The
/// inertias of the rotors follow. They are on the diagonal of the mass matrix.
#[derive(Debug, Clone)]
pub(crate) struct Arm {
    pub joints: Vec<Joint>,
    pub gravity: Vector3<f64>,
    pub parameters: Vec<f64>,
}

type Wrenches = SMatrix<f64, 6, 10>;

impl Joint {
    pub(crate) fn new(origin: [f64; 3], rpy: [f64; 3], axis: [f64; 3]) -> Self {
        Self {
            origin: Vector3::from(origin),
            turned: Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]),
            axis: Unit::new_normalize(Vector3::from(axis)),
        }
    }
}

impl Arm {
    /// Creates two links of 0.4 m and 0.3 m that swing in a vertical plane.
    pub(crate) fn pendulum() -> Self {
        let joints = vec![
            Joint::new([0.0; 3], [0.0; 3], [0.0, 1.0, 0.0]),
            Joint::new([0.0, 0.0, 0.4], [0.0; 3], [0.0, 1.0, 0.0]),
        ];
        let body = |m: f64, c: f64, i: f64| vec![m, 0.0, 0.0, m * c, i, 0.0, 0.0, i, 0.0, 0.1 * i];
        let mut parameters = [body(4.0, 0.2, 0.25), body(2.5, 0.14, 0.08)].concat();
        parameters.extend([0.4, 0.15]);
        Self { joints, gravity: Vector3::new(0.0, 0.0, -9.81), parameters }
    }

    /// Creates the kinematics of a UR10, whose inertias are to be identified.
    pub(crate) fn ur10() -> Self {
        let right = std::f64::consts::FRAC_PI_2;
        let joints = vec![
            Joint::new([0.0, 0.0, 0.1273], [0.0; 3], [0.0, 0.0, 1.0]),
            Joint::new([0.0, 0.220941, 0.0], [0.0, right, 0.0], [0.0, 1.0, 0.0]),
            Joint::new([0.0, -0.1719, 0.612], [0.0; 3], [0.0, 1.0, 0.0]),
            Joint::new([0.0, 0.0, 0.5723], [0.0, right, 0.0], [0.0, 1.0, 0.0]),
            Joint::new([0.0, 0.1149, 0.0], [0.0; 3], [0.0, 0.0, 1.0]),
            Joint::new([0.0, 0.0, 0.1157], [0.0; 3], [0.0, 1.0, 0.0]),
        ];
        Self { joints, gravity: Vector3::new(0.0, 0.0, -9.81), parameters: vec![0.0; 66] }
    }

    /// Returns the spatial velocities and accelerations of the bodies in their own frames. Gravity counts as an
    /// acceleration.
    fn motion(&self, y: &[f64], v: &[f64], a: &[f64]) -> Vec<[Vector3<f64>; 3]> {
        let mut states = Vec::new();
        let mut state = [Vector3::zeros(), Vector3::zeros(), -self.gravity];
        for (i, joint) in self.joints.iter().enumerate() {
            let back = self.rotation(i, y[i]).inverse();
            let [w, dw, acceleration] = state;
            let carried = acceleration + dw.cross(&joint.origin) + w.cross(&w.cross(&joint.origin));
            let axis = joint.axis.into_inner();
            let w_new = back * w + axis * v[i];
            state = [w_new, back * dw + axis * a[i] + (back * w).cross(&(axis * v[i])), back * carried];
            states.push(state);
        }
        states
    }

    fn rotation(&self, i: usize, y: f64) -> Rotation3<f64> {
        self.joints[i].turned * Rotation3::from_axis_angle(&self.joints[i].axis, y)
    }
}

/// Returns force and moment about the frame's origin as functions of the ten parameters.
fn wrenches([w, dw, a]: [Vector3<f64>; 3]) -> Wrenches {
    let cross = |v: &Vector3<f64>| v.cross_matrix();
    let mut all = Wrenches::zeros();
    all.fixed_view_mut::<3, 1>(0, 0).copy_from(&a);
    all.fixed_view_mut::<3, 3>(0, 1).copy_from(&(cross(&dw) + cross(&w) * cross(&w)));
    all.fixed_view_mut::<3, 3>(3, 1).copy_from(&-cross(&a));
    let entries = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    for (k, (r, c)) in entries.into_iter().enumerate() {
        let mut unit = Matrix3::zeros();
        unit[(r, c)] = 1.0;
        unit[(c, r)] = 1.0;
        all.fixed_view_mut::<3, 1>(3, 4 + k).copy_from(&(unit * dw + w.cross(&(unit * w))));
    }
    all
}

impl Robot for Arm {
    fn joint_names(&self) -> Vec<String> {
        (1..=self.joints.len()).map(|i| format!("j{i}")).collect()
    }

    fn input_names(&self) -> Vec<String> {
        self.joint_names()
    }

    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; self.joints.len()]
    }

    fn limits(&self) -> Vec<JointLimits> {
        let free = JointLimits {
            position: [f64::NEG_INFINITY, f64::INFINITY],
            velocity: f64::INFINITY,
            effort: f64::INFINITY,
        };
        vec![free; self.joints.len()]
    }

    fn parameter_names(&self) -> Vec<String> {
        (0..self.parameters.len()).map(|k| format!("p{k}")).collect()
    }

    fn parameters(&self) -> Vec<f64> {
        self.parameters.clone()
    }

    fn bodies(&self) -> usize {
        self.joints.len()
    }

    fn input_matrix(&self) -> Vec<f64> {
        let n = self.joints.len();
        (0..n * n).map(|k| f64::from(u8::from(k % (n + 1) == 0))).collect()
    }

    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        let n = self.joints.len();
        let width = self.parameters.len();
        regressor.fill(0.0);
        for (body, state) in self.motion(y, v, a).into_iter().enumerate() {
            let mut columns = wrenches(state);
            for joint in (0..=body).rev() {
                let axis = self.joints[joint].axis;
                for k in 0..10 {
                    let moment = columns.fixed_view::<3, 1>(3, k);
                    regressor[joint * width + 10 * body + k] = axis.dot(&moment);
                }
                let (turn, arm) = (self.rotation(joint, y[joint]), self.joints[joint].origin);
                let forces = turn * columns.fixed_rows::<3>(0);
                let moments = turn * columns.fixed_rows::<3>(3) + arm.cross_matrix() * forces;
                columns.fixed_rows_mut::<3>(0).copy_from(&forces);
                columns.fixed_rows_mut::<3>(3).copy_from(&moments);
            }
        }
        for joint in 0..n {
            regressor[joint * width + 10 * n + joint] = a[joint];
        }
    }

    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        let width = self.parameters.len();
        let mut regressor = vec![0.0; forces.len() * width];
        self.inertial_regressor(y, v, a, &mut regressor);
        for (force, row) in forces.iter_mut().zip(regressor.chunks(width)) {
            *force = row.iter().zip(&self.parameters).map(|(w, p)| w * p).sum();
        }
    }
}

/// A double pendulum, compared with Lagrange's equations from textbooks.
#[test]
fn the_pendulum_obeys_lagranges_equations() {
    let arm = Arm::pendulum();
    let (y, v, a) = ([0.4, -1.1], [0.7, -1.9], [2.0, 3.5]);
    let mut forces = [0.0; 2];
    arm.rigid_forces(&y, &v, &a, &mut forces);
    let (m1c1, m2, c2, l, g) = (4.0 * 0.2, 2.5, 0.14, 0.4, 9.81);
    let (i1, i2) = (0.25, 0.08);
    let h = m2 * l * c2;
    let m11 = i1 + m2 * l * l + i2 + 2.0 * h * y[1].cos() + 0.4;
    let m12 = i2 + h * y[1].cos();
    let k1 = -h * y[1].sin() * (2.0 * v[0] * v[1] + v[1] * v[1]);
    let k2 = h * y[1].sin() * v[0] * v[0];
    let g2 = m2 * c2 * g * (y[0] + y[1]).sin();
    let g1 = (m1c1 + m2 * l) * g * y[0].sin() + g2;
    // The arm is upright at zero, so that gravity pulls it over.
    assert!((forces[0] - (m11 * a[0] + m12 * a[1] + k1 - g1)).abs() < 1e-12);
    assert!((forces[1] - (m12 * a[0] + (i2 + 0.15) * a[1] + k2 - g2)).abs() < 1e-12);
}
