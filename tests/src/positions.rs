//! Positions with quaternions: their rates, small motions ⊕ along the velocities, and positions from angles.

use gelenk_codegen::model::{JointPosition, Model, QuaternionKind};
use nalgebra::{UnitQuaternion, Vector3};

use crate::dual::Number;

/// Positions with quaternions from one number for each velocity: those of a joint with a quaternion are slides and the angles of
/// `R_x(a) R_y(b) R_z(c)`.
pub fn positions(model: &Model, y: &[f64]) -> Vec<f64> {
    let entries = model.joint_positions().flat_map(|joint| match joint {
        JointPosition::Coordinate(coordinate) => vec![y[coordinate]],
        JointPosition::Quaternion(joint) => {
            let own = &y[joint.coordinates()];
            let (slides, angles) = own.split_at(own.len() - 3);
            let about = |axis: nalgebra::Unit<Vector3<f64>>, k: usize| {
                UnitQuaternion::from_axis_angle(&axis, angles[k])
            };
            let turn =
                about(Vector3::x_axis(), 0) * about(Vector3::y_axis(), 1) * about(Vector3::z_axis(), 2);
            slides.iter().copied().chain([turn.i, turn.j, turn.k, turn.w]).collect()
        }
    });
    entries.collect()
}

/// Brings the quaternions of positions to unit length; the identity takes the place of zero.
pub fn normalize(model: &Model, y: &mut [f64]) {
    for joint in &model.quaternion_joints {
        let first = model.first_position(joint.first) + joint.kind.quaternion();
        let quaternion = &mut y[first..first + 4];
        let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            quaternion[3] = 1.0;
        } else {
            quaternion.iter_mut().for_each(|x| *x /= length);
        }
    }
}

/// Rates of the positions at velocities: ẏ = T(y) v. Quaternions are taken for unit ones; positions and velocities of driven
/// joints may follow those of the others.
pub fn rates<T: Number>(model: &Model, y: &[T], v: &[T]) -> Vec<T> {
    let half = T::from(0.5);
    let of_joint = |joint: JointPosition| match joint {
        JointPosition::Coordinate(coordinate) => vec![v[coordinate]],
        JointPosition::Quaternion(joint) => {
            let q = model.first_position(joint.first) + joint.kind.quaternion();
            let ([x, y, z, w], turning) = ([y[q], y[q + 1], y[q + 2], y[q + 3]], joint.coordinates().end - 3);
            let [a, b, c] = [v[turning], v[turning + 1], v[turning + 2]];
            let slides =
                v[joint.first..turning].chunks(3).flat_map(|l| turned([x, y, z], w, [l[0], l[1], l[2]]));
            let turns = [
                w * a + y * c - z * b,
                w * b + z * a - x * c,
                w * c + x * b - y * a,
                -(x * a + y * b + z * c),
            ];
            slides.chain(turns.map(|rate| half * rate)).collect()
        }
    };
    let driven = &v[model.coordinates.len()..];
    model.joint_positions().flat_map(of_joint).chain(driven.iter().copied()).collect()
}

/// A vector turned by a unit quaternion: `r + 2 w (q × r) + 2 q × (q × r)`.
pub fn turned<T: Number>(q: [T; 3], w: T, r: [T; 3]) -> [T; 3] {
    let once = cross(q, r).map(|x| x * T::from(2.0));
    let twice = cross(q, once);
    std::array::from_fn(|i| r[i] + w * once[i] + twice[i])
}

fn cross<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// `y ⊕ d` for numbers d without a real part: ⊕ follows ẏ = T(y) d for a unit of time, and a step by the midpoint has its
/// derivatives of first and second order.
pub fn moved<T: Number>(model: &Model, y: &[T], d: &[T]) -> Vec<T> {
    let plus =
        |rates: Vec<T>, by: f64| -> Vec<T> { y.iter().zip(rates).map(|(&y, rate)| y + rate * by).collect() };
    let middle = plus(rates(model, y, d), 0.5);
    plus(rates(model, &middle, d), 1.0)
}

/// `[v, d]`: how a motion with the velocities v turns a small motion d. It is 0 for joints without a quaternion, `ω × d` for
/// spherical ones and `(ω × d_l + l × d_ω, ω × d_ω)` for floating ones.
pub fn bracket<T: Number>(model: &Model, v: &[T], d: &[T]) -> Vec<T> {
    let mut bracket = vec![T::from(0.0); v.len()];
    for joint in &model.quaternion_joints {
        let turning = joint.coordinates().end - 3;
        let part = |of: &[T], first: usize| [of[first], of[first + 1], of[first + 2]];
        let (spin, turn) = (part(v, turning), part(d, turning));
        bracket[turning..turning + 3].copy_from_slice(&cross(spin, turn));
        if joint.kind == QuaternionKind::Floating {
            let (turns, slides) = (cross(spin, part(d, joint.first)), cross(part(v, joint.first), turn));
            let both = [0, 1, 2].map(|k| turns[k] + slides[k]);
            bracket[joint.first..turning].copy_from_slice(&both);
        }
    }
    bracket
}
