//! Moments of mass of bodies, and their transfer towards the base, which does not change the equations of
//! motion.

use super::joint::JointAxis;
use super::lower::lower;
use super::mechanism::Body;
use crate::graph::{Graph, Scalar};
use crate::model;
use crate::spatial::{MassMoments, Symmetric3, Vector3};

/// Choice of the mass that is shifted from a body to its parent, at a point on the joint's axis. It
/// determines how inertial constants that act only as a sum are distributed to the two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegroupChoice {
    /// If the joint is revolute, the whole mass is shifted, so the body becomes massless. If it is prismatic,
    /// the second moment of mass is shifted.
    Massless,
    /// The mass is chosen so that the x component of the parent's first moment of mass becomes zero.
    BalanceParent,
    /// The mass is chosen so that the component 0, 1 or 2 (x, y or z) of the parent's first moment of mass
    /// becomes zero. The masses of all children with this choice are computed together.
    Take(usize),
}

/// Moments of mass of a body about the origin of its link's frame.
pub fn moments_of_body<'g>(graph: &'g Graph, body: &model::Body) -> MassMoments<Scalar<'g>> {
    let mass = lower(graph, &body.mass);
    let center = Vector3(body.center_of_mass.each_ref().map(|f| lower(graph, f)));
    let inertia = body.inertia.each_ref().map(|f| lower(graph, f));
    MassMoments::of_inertia(mass, center, inertia)
}

/// Shifts masses that act only as sums from a body to its parent (base parameters; Gautier and Khalil 1990):
/// masses on the axis of a revolute joint, and the second moment of a prismatic joint's body. The equations
/// of motion do not change.
///
/// `base` receives the moments that reach the base, in the base frame. The second moment of `base` has no
/// meaning afterwards.
pub fn regroup<'g>(
    bodies: &mut [Body<Scalar<'g>>],
    base: &mut MassMoments<Scalar<'g>>,
    choices: &[RegroupChoice],
) {
    for index in (0..bodies.len()).rev() {
        balance_by_children(bodies, choices, index);
        if bodies[index].chain.is_some() {
            // Only the last body of a chain has the motion of the joint.
            continue;
        }
        let given = match bodies[index].axis {
            JointAxis::Revolute => on_axis(bodies[index].moments),
            JointAxis::Prismatic => second_only(bodies[index].moments),
        };
        bodies[index].moments = (bodies[index].moments - given).map(|x| x.cleaned(f64::MIN_POSITIVE));
        let Body { twist, translation, lift, parent, axis, offset, .. } = bodies[index];
        // Masses on the axis of a revolute joint do not change if the joint turns.
        let ahead = match axis {
            JointAxis::Revolute => None,
            JointAxis::Prismatic => offset.constant_turn(given.mass.graph()),
        };
        let given = ahead.map_or(given, |ahead| given.turned(ahead));
        let arrived = given.lifted(lift).to_parent(&twist, translation);
        let Some(parent) = parent else {
            *base = *base + arrived;
            continue;
        };
        bodies[parent].moments = bodies[parent].moments + arrived;
        if choices[index] == RegroupChoice::BalanceParent {
            balance_parent(bodies, index, parent);
        }
    }
}

/// The moments of those masses that are on the z axis: mass m, first moment h_z and second moment Σ_zz.
fn on_axis(moments: MassMoments<Scalar<'_>>) -> MassMoments<Scalar<'_>> {
    let zero = moments.mass.constant(0.0);
    let mut second = Symmetric3::zero(zero);
    second.zz = moments.second.zz;
    MassMoments { mass: moments.mass, first: Vector3([zero, zero, moments.first[2]]), second }
}

/// The second moment alone, with zero mass and first moment. It depends only on the orientation, which a
/// prismatic joint does not change.
fn second_only(moments: MassMoments<Scalar<'_>>) -> MassMoments<Scalar<'_>> {
    let zero = moments.mass.constant(0.0);
    MassMoments { mass: zero, first: Vector3::zero(zero), second: moments.second }
}

/// Shortest lever arm \[m\] at which a mass may balance a first moment. Shorter lever arms require masses
/// that are so large that digits are lost.
pub const SHORTEST_LEVER: f64 = 1e-3;

/// A mass at the origin of a child's joint, which may belong to either of the joint's two bodies.
struct Shared<'g> {
    child: usize,
    /// Moments of a unit mass at the child's joint, in the parent's frame.
    in_parent: MassMoments<Scalar<'g>>,
    /// Component of the parent's first moment of mass that becomes zero.
    component: usize,
}

/// Shifts masses between a body and its children until components of the body's first moment are zero. The
/// masses of all children are computed together.
fn balance_by_children<'g>(bodies: &mut [Body<Scalar<'g>>], choices: &[RegroupChoice], index: usize) {
    let shared: Vec<Shared<'g>> = (index + 1..bodies.len())
        .filter(|&child| bodies[child].parent == Some(index) && bodies[child].chain.is_none())
        .filter_map(|child| shared_with(&bodies[child], choices[child], child))
        .collect();
    let zero = bodies[index].lift.constant(0.0);
    let Some(masses) = balancing_masses(&shared, bodies[index].moments.first) else { return };
    for (Shared { child, in_parent, .. }, mass) in shared.iter().zip(masses) {
        let mass = zero.constant(mass);
        bodies[index].moments = bodies[index].moments + in_parent.map(|x| x * mass);
        bodies[*child].moments.mass = bodies[*child].moments.mass - mass;
    }
    for Shared { component, .. } in shared {
        bodies[index].moments.first.0[component] = zero;
    }
}

fn shared_with<'g>(body: &Body<Scalar<'g>>, choice: RegroupChoice, child: usize) -> Option<Shared<'g>> {
    let RegroupChoice::Take(component) = choice else { return None };
    let mut point = MassMoments::zero(body.lift.graph());
    point.mass = body.lift.constant(1.0);
    let in_parent = point.lifted(body.lift).to_parent(&body.twist, body.translation);
    (body.axis == JointAxis::Revolute).then_some(Shared { child, in_parent, component })
}

/// The masses at the children's joints that balance a first moment of mass. `None` if the levers are not
/// constant or digits would be lost.
fn balancing_masses(shared: &[Shared<'_>], first: Vector3<Scalar<'_>>) -> Option<Vec<f64>> {
    let row = |component: usize| -> Option<Vec<f64>> {
        let levers = shared.iter().map(|each| each.in_parent.first[component].value());
        levers.chain([first[component].value().map(|x| -x)]).collect()
    };
    let rows: Vec<Vec<f64>> = shared.iter().map(|each| row(each.component)).collect::<Option<_>>()?;
    if rows.is_empty() { None } else { solved(rows) }
}

/// Solution of linear equations by Gauss–Jordan elimination with row pivots. The last column is the right
/// side. `None` if a pivot is too small.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let size = rows.len();
    for k in 0..size {
        let largest = (k..size).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, largest);
        let pivot = rows[k].clone();
        if pivot[k].abs() < SHORTEST_LEVER {
            return None;
        }
        for (_, row) in rows.iter_mut().enumerate().filter(|(other, _)| *other != k) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
        }
    }
    Some((0..size).map(|k| rows[k][size] / rows[k][k]).collect())
}

/// Shifts mass between a revolute joint's origin and its parent until the x component of the parent's first
/// moment is zero.
fn balance_parent(bodies: &mut [Body<Scalar<'_>>], index: usize, parent: usize) {
    let origin = bodies[index].origin_in_parent();
    let (Some(hx), Some(px)) = (bodies[parent].moments.first[0].value(), origin[0].value()) else {
        return;
    };
    if px.abs() < SHORTEST_LEVER || bodies[index].axis != JointAxis::Revolute {
        return;
    }
    let mass = origin[0].constant(-hx / px);
    let mut point = MassMoments::zero(mass.graph());
    point.mass = mass;
    bodies[index].moments.mass = bodies[index].moments.mass - mass;
    let Body { twist, translation, lift, .. } = bodies[index];
    bodies[parent].moments = bodies[parent].moments + point.lifted(lift).to_parent(&twist, translation);
    bodies[parent].moments.first.0[0] = mass.constant(0.0);
}
