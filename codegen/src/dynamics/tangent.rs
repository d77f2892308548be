//! Derivatives along small motions. They are needed for joints with quaternions, whose positions do not form
//! a vector space.
//!
//! The derivative of f(y) along coordinate i is the derivative of `δ ↦ f(y ⊕ δ e_i)` at δ = 0, with the unit
//! vector e_i. A quaternion q has the rate `q̇ = ½ q ⊗ (ν, 0)`, and the origin p of a floating body has the
//! rate `ṗ = R l`. The linear velocity l and the angular velocity ν are in the frame of the body, and R is
//! its rotation.

use crate::graph::{Graph, Scalar, differentiate, gradient};
use crate::kinematics::{PositionEntries, position_entries};
use crate::model::{Model, QuaternionJoint, QuaternionKind};
use crate::spatial::{Attitude, Vector3};

/// Derivatives of `results` along small motions of one coordinate. For a coordinate without a quaternion,
/// they are the partial derivatives.
///
/// - `y`: positions by coordinate
pub fn differentiate_along<'g>(
    graph: &'g Graph,
    model: &Model,
    results: &[Scalar<'g>],
    y: &[Scalar<'g>],
    coordinate: usize,
) -> Vec<Scalar<'g>> {
    let Some(joint) = model.quaternion_joint_of(coordinate) else {
        return differentiate(graph, results, y[coordinate]);
    };
    let zero = graph.constant(0.0);
    let mut sum = vec![zero; results.len()];
    for (entry, rate) in rates(graph, model, joint, coordinate - joint.first) {
        if rate.is_zero() {
            continue;
        }
        for (sum, by) in sum.iter_mut().zip(differentiate(graph, results, entry)) {
            *sum = *sum + by * rate;
        }
    }
    sum
}

/// Derivatives of one result along small motions of all coordinates, and with respect to all velocities. Uses
/// reverse differentiation.
pub fn gradient_along<'g>(
    graph: &'g Graph,
    model: &Model,
    result: Scalar<'g>,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> (Vec<Scalar<'g>>, Vec<Scalar<'g>>) {
    let mut entries = y.to_vec();
    for joint in &model.quaternion_joints {
        let PositionEntries { origin, quaternion } = position_entries(graph, model, joint);
        entries.extend(origin.into_iter().flat_map(|origin| origin.0).chain(quaternion));
    }
    let mut adjoints = gradient(graph, result, &[entries.as_slice(), v].concat());
    let by_velocities = adjoints.split_off(entries.len());
    let by_entries = adjoints.split_off(y.len());
    let mut along = adjoints;
    let mut first = 0;
    for joint in &model.quaternion_joints {
        let own = &by_entries[first..first + joint.kind.positions()];
        first += joint.kind.positions();
        for coordinate in joint.coordinates() {
            let velocity = coordinate - joint.first;
            let slides = joint.kind.velocities() == 6 && velocity < 3;
            let own = if slides { &own[..3] } else { &own[joint.kind.quaternion()..] };
            let rates = rates(graph, model, joint, velocity);
            let zero = graph.constant(0.0);
            along[coordinate] = rates.iter().zip(own).fold(zero, |sum, ((_, rate), &by)| sum + by * *rate);
        }
    }
    (along, by_velocities)
}

/// Position entries of a joint, each with its rate of change for a unit of one velocity of the joint.
fn rates<'g>(
    graph: &'g Graph,
    model: &Model,
    joint: &QuaternionJoint,
    velocity: usize,
) -> Vec<(Scalar<'g>, Scalar<'g>)> {
    let PositionEntries { origin, quaternion } = position_entries(graph, model, joint);
    let [x, y, z, w] = quaternion;
    let axis = velocity % 3;
    let slides = joint.kind == QuaternionKind::Floating && velocity < 3;
    if let (true, Some(origin)) = (slides, origin) {
        let direction = Attitude::of_quaternion(quaternion).0[axis];
        return origin.0.into_iter().zip(direction.0).collect();
    }
    let mut e = Vector3::zero(w);
    e.0[axis] = graph.constant(1.0);
    let vector = Vector3([x, y, z]);
    let turned = e.scaled(w) + vector.cross(e);
    let rates = turned.0.into_iter().chain([-vector.dot(e)]).map(|rate| rate * 0.5);
    quaternion.into_iter().zip(rates).collect()
}

/// Matrix D in `δ̇ = D δ + v − v̄`. δ is the deviation from a motion with the velocities v̄, which are the
/// argument `v`. D is 0 in the rows of joints without quaternions.
///
/// - floating joint with the linear velocity l and the angular velocity ν: rows (−ν×, −l×) and (0, −ν×)
/// - spherical joint with the angular velocity ν: −ν×
pub fn drift<'g>(graph: &'g Graph, model: &Model, v: &[Scalar<'g>]) -> Vec<Vec<Scalar<'g>>> {
    let n = v.len();
    let mut matrix = vec![vec![graph.constant(0.0); n]; n];
    for joint in &model.quaternion_joints {
        let turning = joint.first + joint.kind.velocities() - 3;
        subtract_cross(&mut matrix, [turning, turning], &v[turning..turning + 3]);
        if joint.kind == QuaternionKind::Floating {
            subtract_cross(&mut matrix, [joint.first, joint.first], &v[turning..turning + 3]);
            subtract_cross(&mut matrix, [joint.first, turning], &v[joint.first..turning]);
        }
    }
    matrix
}

/// Subtracts the matrix v× of the cross product from a block.
fn subtract_cross<'g>(matrix: &mut [Vec<Scalar<'g>>], [row, column]: [usize; 2], v: &[Scalar<'g>]) {
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        // The matrix v× has the entry −v_k at (i, j) and v_k at (j, i).
        matrix[row + i][column + j] = matrix[row + i][column + j] + v[k];
        matrix[row + j][column + i] = matrix[row + j][column + i] - v[k];
    }
}
