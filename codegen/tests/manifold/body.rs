//! A free rigid body with four inputs: a thrust along its third axis and three moments, as a quadrotor has. Its centre
//! of mass is its origin.

use gelenk_kernels::discrete_time::Linear;
use gelenk_kernels::manifold::integrate;

pub const WIDTHS: [usize; 1] = [7];

pub struct Body {
    pub mass: f64,
    /// Principal moments.
    pub inertia: [f64; 3],
    pub gravity: f64,
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The matrix of `a × …`.
fn skew(a: [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]
}

/// The columns are the body's axes.
pub fn rotation(q: &[f64]) -> [[f64; 3]; 3] {
    let [x, y, z, w] = [q[0], q[1], q[2], q[3]];
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

pub fn in_base(y: &[f64; 7], a: [f64; 3]) -> [f64; 3] {
    rotation(&y[3..]).map(|row| row[0] * a[0] + row[1] * a[1] + row[2] * a[2])
}

impl Body {
    fn weight(&self, y: &[f64; 7]) -> [f64; 3] {
        rotation(&y[3..])[2].map(|axis| -self.gravity * axis)
    }

    pub fn acceleration(&self, y: &[f64; 7], v: &[f64; 6], u: &[f64; 4]) -> [f64; 6] {
        let (l, w) = ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
        let (weight, coriolis) = (self.weight(y), cross(l, w));
        let momentum = core::array::from_fn(|i| self.inertia[i] * w[i]);
        let gyroscopic = cross(momentum, w);
        let mut a = [0.0; 6];
        for i in 0..3 {
            a[i] = weight[i] + coriolis[i];
            a[i + 3] = (gyroscopic[i] + u[i + 1]) / self.inertia[i];
        }
        a[2] += u[0] / self.mass;
        a
    }

    /// `∂v̇/∂y` along ⊕, `∂v̇/∂v`, `∂v̇/∂u` and the affine remainder, by hand.
    pub fn linearize(&self, y: &[f64; 7], v: &[f64; 6], u: &[f64; 4]) -> Linear<6, 4> {
        let (l, w) = ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
        let (gravity, linear, angular) = (skew(self.weight(y)), skew(l), skew(w));
        let momentum = skew(core::array::from_fn(|i| self.inertia[i] * w[i]));
        let (mut by_y, mut by_v, mut by_u) = ([[0.0; 6]; 6], [[0.0; 6]; 6], [[0.0; 4]; 6]);
        for i in 0..3 {
            for j in 0..3 {
                by_y[i][j + 3] = gravity[i][j];
                by_v[i][j] = -angular[i][j];
                by_v[i][j + 3] = linear[i][j];
                by_v[i + 3][j + 3] = (momentum[i][j] - angular[i][j] * self.inertia[j]) / self.inertia[i];
            }
            by_u[i + 3][i + 1] = 1.0 / self.inertia[i];
        }
        by_u[2][0] = 1.0 / self.mass;
        let mut remainder = self.acceleration(y, v, u);
        for i in 0..6 {
            let of_v: f64 = (0..6).map(|j| by_v[i][j] * v[j]).sum();
            let of_u: f64 = (0..4).map(|j| by_u[i][j] * u[j]).sum();
            remainder[i] -= of_v + of_u;
        }
        (by_y, by_v, by_u, remainder)
    }

    pub fn kinetic_energy(&self, v: &[f64; 6]) -> f64 {
        let of = |i: usize| self.mass * v[i] * v[i] + self.inertia[i] * v[i + 3] * v[i + 3];
        0.5 * (of(0) + of(1) + of(2))
    }

    /// In the base's axes.
    pub fn angular_momentum(&self, y: &[f64; 7], v: &[f64; 6]) -> [f64; 3] {
        in_base(y, core::array::from_fn(|i| self.inertia[i] * v[i + 3]))
    }
}

/// The linearization by hand, by quotients along ⊕.
#[test]
fn the_linearization_by_hand_is_right() {
    let body = Body { mass: 1.3, inertia: [0.02, 0.03, 0.05], gravity: 9.81 };
    let mut random = super::random::Random(21);
    let (y, v, u) = (random.pose(), random.vector(2.0), random.vector(1.0));
    let (by_y, by_v, _, _) = body.linearize(&y, &v, &u);
    for j in 0..6 {
        let at = |h: f64, of_y: bool| {
            let mut d = [0.0; 6];
            d[j] = h;
            match of_y {
                true => body.acceleration(&integrate(&WIDTHS, &y, &d), &v, &u),
                false => body.acceleration(&y, &core::array::from_fn(|i| v[i] + d[i]), &u),
            }
        };
        for (of_y, matrix) in [(true, by_y), (false, by_v)] {
            let (after, before) = (at(1e-5, of_y), at(-1e-5, of_y));
            for i in 0..6 {
                let quotient = (after[i] - before[i]) / 2e-5;
                assert!((quotient - matrix[i][j]).abs() <= 1e-8, "{quotient} is not {}", matrix[i][j]);
            }
        }
    }
}
