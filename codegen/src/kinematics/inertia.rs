//! What of the moments of mass may move towards the base.

use super::joint::JointAxis;
use super::lower::lower;
use super::mechanism::Body;
use crate::graph::{Graph, Scalar};
use crate::model;
use crate::spatial::{MassMoments, Symmetric3, Vector3};

/// The use of a joint's freedom to shift mass along its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegroupChoice {
    /// The body itself becomes massless.
    Massless,
    /// The parent's first moment loses its component along x.
    BalanceParent,
}

/// Moments of a described body, about its link frame's origin.
pub fn moments_of_body<'g>(graph: &'g Graph, body: &model::Body) -> MassMoments<Scalar<'g>> {
    let mass = lower(graph, &body.mass);
    let center = Vector3(body.center_of_mass.each_ref().map(|f| lower(graph, f)));
    let inertia = body.inertia.each_ref().map(|f| lower(graph, f));
    MassMoments::of_inertia(mass, center, inertia)
}

/// Moves what acts only through its sum from body to parent (base parameters; Gautier and Khalil 1990):
/// masses on a revolute joint's axis, and the whole second moment of a prismatic joint's body. Leaves M, k
/// and q unchanged.
///
/// `base` receives what arrives there, in the base frame; its second moment then means nothing.
pub fn regroup<'g>(
    bodies: &mut [Body<Scalar<'g>>],
    base: &mut MassMoments<Scalar<'g>>,
    choices: &[RegroupChoice],
) {
    for index in (0..bodies.len()).rev() {
        if bodies[index].chain.is_some() {
            // Only the last body of the chain moves as the joint does.
            continue;
        }
        let given = match bodies[index].axis {
            JointAxis::Revolute => on_axis(bodies[index].moments),
            JointAxis::Prismatic => second_only(bodies[index].moments),
        };
        bodies[index].moments = (bodies[index].moments - given).map(|x| x.cleaned(f64::MIN_POSITIVE));
        let Body { twist, translation, lift, parent, axis, offset, .. } = bodies[index];
        // Masses on a revolute joint's axis look the same from all sides.
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

/// The moments of the masses on the z axis.
fn on_axis(moments: MassMoments<Scalar<'_>>) -> MassMoments<Scalar<'_>> {
    let zero = moments.mass.constant(0.0);
    let mut second = Symmetric3::zero(zero);
    second.zz = moments.second.zz;
    MassMoments { mass: moments.mass, first: Vector3([zero, zero, moments.first[2]]), second }
}

/// The second moment alone: it depends on the orientation only, which a prismatic joint does not change.
fn second_only(moments: MassMoments<Scalar<'_>>) -> MassMoments<Scalar<'_>> {
    let zero = moments.mass.constant(0.0);
    MassMoments { mass: zero, first: Vector3::zero(zero), second: moments.second }
}

/// Balancing over a shorter lever (m) takes masses so large that digits are lost.
pub const SHORTEST_LEVER: f64 = 1e-3;

/// Shifts mass between a revolute joint's origin and its parent until the parent's h_x vanishes.
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
