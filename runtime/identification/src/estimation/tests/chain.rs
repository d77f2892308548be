//! A serial arm with its regressor by recursion, written without the generator: an independent check of the regressor W.

use super::super::super::robot::{JointLimits, Robot};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Revolute joints, each with a body; frames at zero positions.
pub(in super::super) struct Chain {
    pub(in super::super) joints: Vec<Link>,
    pub(in super::super) gravity: Vector3<f64>,
    /// Diagonal of B.
    pub(in super::super) gears: Vec<f64>,
    /// Largest forces.
    pub(in super::super) efforts: Vec<f64>,
    /// Whether inputs are currents. B then contains motor constants.
    pub(in super::super) currents: bool,
}

/// A joint's place on its parent, its axis, and the ten parameters of the body that it moves.
pub(in super::super) struct Link {
    pub(in super::super) origin: Vector3<f64>,
    pub(in super::super) rotation: Rotation3<f64>,
    pub(in super::super) axis: Vector3<f64>,
    pub(in super::super) parameters: [f64; 10],
}

/// Ten parameters of a mass m with centre c and diagonal moments about it.
pub(in super::super) fn body(m: f64, c: [f64; 3], moments: [f64; 3]) -> [f64; 10] {
    let c = Vector3::from(c);
    let about = Matrix3::from_diagonal(&moments.into())
        + m * (Matrix3::identity() * c.norm_squared() - c * c.transpose());
    let i = |r: usize, k: usize| about[(r, k)];
    [m, m * c.x, m * c.y, m * c.z, i(0, 0), i(0, 1), i(1, 1), i(0, 2), i(1, 2), i(2, 2)]
}

/// Force and moment about the frame's origin for one parameter.
type Wrench = [[f64; 3]; 2];

/// `f = m a + α×h + ω×(ω×h)`, `n = I α + ω×(I ω) + h×a`, for each of the ten parameters.
fn newton_euler(a: [f64; 3], omega: [f64; 3], alpha: [f64; 3]) -> [Wrench; 10] {
    let mut wrenches = [[[0.0; 3]; 2]; 10];
    wrenches[0][0] = a;
    for k in 0..3 {
        let mut h = [0.0; 3];
        h[k] = 1.0;
        wrenches[1 + k] = [add(cross(alpha, h), cross(omega, cross(omega, h))), cross(h, a)];
    }
    for (k, (r, c)) in [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)].into_iter().enumerate() {
        let apply = |x: [f64; 3]| {
            let mut y = [0.0; 3];
            y[r] += x[c];
            y[c] += if r == c { 0.0 } else { x[r] };
            y
        };
        wrenches[4 + k][1] = add(apply(alpha), cross(omega, apply(omega)));
    }
    wrenches
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn times(m: &[[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}

fn transpose(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|c| [m[0][c], m[1][c], m[2][c]])
}

impl Chain {
    fn count(&self) -> usize {
        self.joints.len()
    }

    fn regressor(&self, gravity: Vector3<f64>, [y, v, a]: [&[f64]; 3], regressor: &mut [f64]) {
        let n = self.count();
        let (mut omega, mut alpha) = ([0.0; 3], [0.0; 3]);
        let mut acceleration: [f64; 3] = (-gravity).into();
        let mut rotations: Vec<[[f64; 3]; 3]> = Vec::new();
        for (i, link) in self.joints.iter().enumerate() {
            let turn = link.rotation.matrix() * Rotation3::new(link.axis * y[i]).matrix();
            let to_parent = [0, 1, 2].map(|r| [turn[(r, 0)], turn[(r, 1)], turn[(r, 2)]]);
            let back = transpose(&to_parent);
            let (origin, axis): ([f64; 3], [f64; 3]) = (link.origin.into(), link.axis.into());
            // Motion of the parent at the child's origin, in the child's axes.
            let turned = add(cross(alpha, origin), cross(omega, cross(omega, origin)));
            acceleration = times(&back, add(acceleration, turned));
            let carried = times(&back, omega);
            let spin = axis.map(|x| x * v[i]);
            alpha = add(add(times(&back, alpha), axis.map(|x| x * a[i])), cross(carried, spin));
            omega = add(carried, spin);
            rotations.push(to_parent);
            for (k, mut wrench) in newton_euler(acceleration, omega, alpha).into_iter().enumerate() {
                for j in (0..=i).rev() {
                    let axis = self.joints[j].axis;
                    let moment = wrench[1];
                    regressor[j * n * 10 + i * 10 + k] =
                        axis.x * moment[0] + axis.y * moment[1] + axis.z * moment[2];
                    let force = times(&rotations[j], wrench[0]);
                    wrench = [
                        force,
                        add(times(&rotations[j], moment), cross(self.joints[j].origin.into(), force)),
                    ];
                }
            }
        }
    }
}

impl Robot for Chain {
    fn joint_names(&self) -> Vec<String> {
        (1..=self.count()).map(|i| format!("joint_{i}")).collect()
    }
    fn input_names(&self) -> Vec<String> {
        (1..=self.count()).map(|i| format!("motor_{i}")).collect()
    }
    fn position_units(&self) -> Vec<&'static str> {
        vec!["rad"; self.count()]
    }
    fn limits(&self) -> Vec<JointLimits> {
        let limited = |effort: &f64| JointLimits {
            position: [f64::NEG_INFINITY, f64::INFINITY],
            velocity: f64::INFINITY,
            effort: *effort,
        };
        self.efforts.iter().map(limited).collect()
    }
    fn parameter_names(&self) -> Vec<String> {
        let one = |i: usize| {
            ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"].map(|n| format!("{n}_{i}"))
        };
        (1..=self.count()).flat_map(one).collect()
    }
    fn parameters(&self) -> Vec<f64> {
        self.joints.iter().flat_map(|l| l.parameters).collect()
    }
    fn bodies(&self) -> usize {
        self.count()
    }
    fn input_matrix(&self) -> Vec<f64> {
        let n = self.count();
        (0..n * n).map(|k| if k / n == k % n { self.gears[k / n] } else { 0.0 }).collect()
    }
    fn described_currents(&self) -> Vec<bool> {
        vec![self.currents; self.count()]
    }
    fn gravity(&self) -> Option<[f64; 3]> {
        Some(self.gravity.into())
    }
    fn regressor_at_rest(&self, y: &[f64], gravity: [f64; 3], regressor: &mut [f64]) {
        let zero = vec![0.0; self.count()];
        self.regressor(gravity.into(), [y, &zero, &zero], regressor);
    }
    fn inertial_regressor(&self, y: &[f64], v: &[f64], a: &[f64], regressor: &mut [f64]) {
        self.regressor(self.gravity, [y, v, a], regressor);
    }
    fn rigid_forces(&self, y: &[f64], v: &[f64], a: &[f64], forces: &mut [f64]) {
        let parameters = self.parameters();
        let mut regressor = vec![0.0; self.count() * parameters.len()];
        self.inertial_regressor(y, v, a, &mut regressor);
        for (force, row) in forces.iter_mut().zip(regressor.chunks_exact(parameters.len())) {
            *force = row.iter().zip(&parameters).map(|(w, p)| w * p).sum();
        }
    }
}

/// The UR10 as its vendor describes it (ros-industrial, BSD).
pub(in super::super) fn ur10() -> Chain {
    let turned = Rotation3::new(Vector3::y() * std::f64::consts::FRAC_PI_2);
    let link = |xyz: [f64; 3], rotation: Rotation3<f64>, axis: Vector3<f64>, parameters| Link {
        origin: xyz.into(),
        rotation,
        axis,
        parameters,
    };
    let none = Rotation3::identity();
    let wrist = body(1.96, [0.0; 3], [0.0051082479567, 0.0051082479567, 0.0055125]);
    let joints = vec![
        link(
            [0.0, 0.0, 0.1273],
            none,
            Vector3::z(),
            body(7.778, [0.0; 3], [0.0314743125769, 0.0314743125769, 0.021875625]),
        ),
        link(
            [0.0, 0.220941, 0.0],
            turned,
            Vector3::y(),
            body(12.93, [0.0, 0.0, 0.306], [0.421753803798, 0.421753803798, 0.036365625]),
        ),
        link(
            [0.0, -0.1719, 0.612],
            none,
            Vector3::y(),
            body(3.87, [0.0, 0.0, 0.28615], [0.111069694097, 0.111069694097, 0.010884375]),
        ),
        link([0.0, 0.0, 0.5723], turned, Vector3::y(), wrist),
        link([0.0, 0.1149, 0.0], none, Vector3::z(), wrist),
        link(
            [0.0, 0.0, 0.1157],
            none,
            Vector3::y(),
            body(0.202, [0.0; 3], [0.000526462289415, 0.000526462289415, 0.000568125]),
        ),
    ];
    let efforts = vec![330.0, 330.0, 150.0, 54.0, 54.0, 54.0];
    Chain { joints, gravity: Vector3::new(0.0, 0.0, -9.80665), gears: vec![1.0; 6], efforts, currents: false }
}
