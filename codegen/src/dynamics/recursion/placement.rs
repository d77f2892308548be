//! Working frames: the frame of each body's equations, and its pose relative to the parent's.

use crate::dynamics::formulation::{Formulation, WorkingFrame};
use crate::graph::Scalar;
use crate::kinematics::{JointAxis, Mechanism, Transmission};
use crate::spatial::{Angle, Attitude, MassMoments, Matrix3, Motion, Symmetric3, Twist, Vector3};
use gelenk_formula::Function;

/// Sine and cosine of an angle.
pub type Turn<'g> = (Scalar<'g>, Scalar<'g>);

/// The working frame of one body.
#[derive(Debug, Clone, Copy)]
pub struct Placement<'g> {
    /// Turn about z relative to the parent's working frame, after the twist; `None` if the frames coincide.
    pub turn: Option<Turn<'g>>,
    /// Rotation by a quaternion after that turn.
    pub attitude: Option<Attitude<Scalar<'g>>>,
    /// Origin in the parent's working frame (m).
    pub translation: Vector3<Scalar<'g>>,
    /// Displacement along z: constant for revolute joints; includes the coordinate for prismatic ones.
    pub extension: Scalar<'g>,
    /// First body of this body's run of parallel revolute joints.
    pub run: usize,
    /// Turn about z relative to the frame before the run's first joint.
    pub turn_from_run: Option<Turn<'g>>,
    /// Moments of mass in the working frame.
    pub moments: MassMoments<Scalar<'g>>,
    /// Turn about z from the working frame to the body's own frame.
    pub to_body: Option<Turn<'g>>,
    /// Parent's unit of length divided by this body's.
    pub unit_ratio: f64,
    /// Body whose own frame is parallel to the working frame; `None`: the frame before the run's first joint.
    aligned: Option<usize>,
}

/// Computes the placement of each body at the coordinates `y`.
pub fn place<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    y: &[Scalar<'g>],
) -> Vec<Placement<'g>> {
    let mut placements: Vec<Placement<'g>> = Vec::with_capacity(mechanism.bodies.len());
    for index in 0..mechanism.bodies.len() {
        placements.push(place_body(mechanism, formulation, y, &placements, index));
    }
    placements
}

fn place_body<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    y: &[Scalar<'g>],
    placed: &[Placement<'g>],
    index: usize,
) -> Placement<'g> {
    let body = &mechanism.bodies[index];
    let revolute = body.axis == JointAxis::Revolute;
    let previous = run_parent(mechanism, index);
    let before = previous.and_then(|p| placed[p].aligned);
    let aligned = match formulation.bodies[index].frame {
        WorkingFrame::BeforeJoint if revolute => before,
        WorkingFrame::Body | WorkingFrame::BeforeJoint => Some(index),
    };
    let turn = |from, to| {
        if revolute && body.chain.is_none() {
            turn_between(mechanism, y, from, to, index)
        } else if from == to {
            None
        } else {
            body.offset.constant_turn(mechanism.graph)
        }
    };
    let to_body = turn(aligned, Some(index));
    let translation = match body.parent.and_then(|p| placed[p].to_body) {
        Some(ahead) => body.translation.turned(ahead),
        None => body.translation,
    };
    Placement {
        turn: turn(before, aligned),
        attitude: body.attitude,
        translation,
        extension: if revolute { body.lift } else { body.lift + body.transmission.motion(y) },
        run: previous.map_or(index, |p| placed[p].run),
        turn_from_run: turn(None, aligned),
        moments: to_body.map_or(body.moments, |ahead| body.moments.turned(ahead)),
        to_body,
        unit_ratio: body.unit_ratio,
        aligned,
    }
}

/// The turn between two frames of one run: from the own frame of body `from` to that of body `to`, `None`
/// standing for the frame before the run. Angles are added before the sine.
fn turn_between<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    y: &[Scalar<'g>],
    from: Option<usize>,
    to: Option<usize>,
    member: usize,
) -> Option<Turn<'g>> {
    if from == to {
        return None;
    }
    let chain = run_chain(mechanism, member);
    let position =
        |end: Option<usize>| end.and_then(|body| chain.iter().position(|&k| k == body)).map_or(0, |k| k + 1);
    let joints = &chain[position(from)..position(to)];
    let zero = mechanism.graph.constant(0.0);
    let mut offset = Angle::default();
    let mut name = String::new();
    for &joint in joints {
        let body = &mechanism.bodies[joint];
        name = format!("{name}_{}", body.identifier);
        offset = offset + body.offset;
    }
    let transmissions = joints.iter().map(|&joint| &mechanism.bodies[joint].transmission);
    let angle = Transmission::sum_of_motions(transmissions, zero, y);
    if angle.is_zero() && mechanism.is_coupled() {
        // The joints of a parallelogram turn each other back.
        return offset.constant_turn(mechanism.graph);
    }
    let angle = angle.named(|| format!("angle{name}")) + zero.constant(offset.remainder);
    let angle = angle.named(|| format!("angle{name}_offset"));
    let sine = angle.call(Function::Sin).named(|| format!("sin{name}"));
    let cosine = angle.call(Function::Cos).named(|| format!("cos{name}"));
    Some(offset.advance((sine, cosine)))
}

/// Whether a body's parent is a revolute joint on the base with another direction. Only that joint's own
/// torque then needs the quantities passed to it.
pub fn ends_at_root(mechanism: &Mechanism<Scalar<'_>>, body: usize) -> bool {
    let child = &mechanism.bodies[body];
    let root = child.parent.map(|parent| &mechanism.bodies[parent]);
    !child.twist.is_none()
        && root.is_some_and(|root| root.parent.is_none() && root.axis == JointAxis::Revolute)
}

/// The parent of a body, if both turn about parallel axes by angles that may be added; they then belong to one run.
/// A body of a quaternion joint belongs to no run: the pose of its joint lies between the two.
fn run_parent(mechanism: &Mechanism<Scalar<'_>>, body: usize) -> Option<usize> {
    let turns = |body: usize| {
        let body = &mechanism.bodies[body];
        body.axis == JointAxis::Revolute && body.chain.is_none()
    };
    let parent = mechanism.bodies[body].parent?;
    let is_run = mechanism.bodies[body].twist.is_none() && turns(body) && turns(parent);
    is_run.then_some(parent)
}

/// The bodies of the run that ends with `member`, from its first body on.
fn run_chain(mechanism: &Mechanism<Scalar<'_>>, member: usize) -> Vec<usize> {
    let mut chain: Vec<usize> =
        std::iter::successors(Some(member), |&body| run_parent(mechanism, body)).collect();
    chain.reverse();
    chain
}

impl<'g> Placement<'g> {
    /// Transforms an angular velocity, angular acceleration or moment from the parent's working frame to this
    /// one.
    pub fn to_child(&self, twist: &Twist, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let v = twist.to_child(v);
        let v = self.turn.map_or(v, |turn| v.turned_back(turn));
        self.attitude.map_or(v, |attitude| attitude.to_child(v))
    }

    /// Transforms an angular velocity, angular acceleration or moment from this working frame to the
    /// parent's.
    pub fn to_parent(&self, twist: &Twist, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        twist.to_parent(self.before_joint(v))
    }

    /// Transforms such a vector from this working frame to the frame before the joint.
    pub fn before_joint(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let v = self.before_attitude(v);
        self.turn.map_or(v, |turn| v.turned(turn))
    }

    fn before_attitude(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.attitude.map_or(v, |attitude| attitude.to_parent(v))
    }

    /// Transforms a matrix to the frame before the joint, `R A Rᵀ`.
    pub fn matrix_before_joint(&self, a: &Matrix3<'g>) -> Matrix3<'g> {
        let a = self.attitude.map_or(*a, |attitude| attitude.matrix_to_parent(a));
        self.turn.map_or(a, |turn| a.turned(turn))
    }

    /// Transforms a second moment to the frame before the joint.
    pub fn second_before_joint(&self, second: Symmetric3<Scalar<'g>>) -> Symmetric3<Scalar<'g>> {
        let second = self.attitude.map_or(second, |attitude| attitude.symmetric_to_parent(second));
        self.turn.map_or(second, |turn| second.turned(turn))
    }

    /// Transforms an acceleration from the parent's working frame and unit to this one's.
    pub fn to_child_unit(&self, twist: &Twist, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let v = self.scaled_turn(twist.to_child(v), |v, turn| v.turned_back(turn));
        self.attitude.map_or(v, |attitude| attitude.to_child(v))
    }

    /// Transforms a force or first moment from this working frame and unit to the frame before the joint and
    /// the parent's unit.
    pub fn before_joint_unit(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.scaled_turn(self.before_attitude(v), |v, turn| v.turned(turn))
    }

    /// Motion of this body per unit of the parent's angular velocity about z: angular velocity and velocity
    /// of the origin, in this working frame and unit. Its products with moment and force give the parent's
    /// component along z in fewer operations than transforming both.
    pub fn parent_screw(&self, twist: &Twist) -> Motion<'g> {
        let zero = self.extension.constant(0.0);
        let z = Vector3([zero, zero, zero.constant(1.0)]);
        let angular = self.to_child(twist, z);
        let lift = Vector3([zero, zero, self.extension]);
        let linear = self.to_child_unit(twist, z.cross(self.translation)) + angular.cross(lift);
        Motion { angular, linear }
    }

    /// Turns, with the change of unit inside the sine and cosine.
    fn scaled_turn(
        &self,
        v: Vector3<Scalar<'g>>,
        turn: impl Fn(Vector3<Scalar<'g>>, Turn<'g>) -> Vector3<Scalar<'g>>,
    ) -> Vector3<Scalar<'g>> {
        let ratio = v[0].constant(self.unit_ratio);
        match self.turn {
            Some((s, c)) => {
                let turned = turn(v, (s * ratio, c * ratio));
                Vector3([turned[0], turned[1], v[2] * ratio])
            }
            None => v.scaled(ratio),
        }
    }
}
