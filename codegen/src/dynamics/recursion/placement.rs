//! Frames in which the equations of the bodies are written (working frames). A placement is the pose of a
//! body's working frame in the parent's working frame. A run is a sequence of revolute joints with parallel
//! axes.

use crate::dynamics::formulation::{Formulation, WorkingFrame};
use crate::graph::Scalar;
use crate::kinematics::{JointAxis, Mechanism, Transmission};
use crate::spatial::{Angle, Attitude, MassMoments, Matrix3, Motion, Symmetric3, Twist, Vector3};
use gelenk_formula::Function;

/// Sine and cosine of an angle.
pub type Turn<'g> = (Scalar<'g>, Scalar<'g>);

/// Frame of one body's equations relative to the frame of the parent's equations.
#[derive(Debug, Clone, Copy)]
pub struct Placement<'g> {
    /// Rotation about z from the frame of the parent's equations, after the constant rotation between the
    /// links; `None` if there is no rotation.
    pub turn: Option<Turn<'g>>,
    /// Rotation by a quaternion after the rotation about z; `None` if there is no quaternion.
    pub attitude: Option<Attitude<Scalar<'g>>>,
    /// Vector from the parent's origin to the joint's axis, in the frame and unit of length of the parent's
    /// equations.
    pub translation: Vector3<Scalar<'g>>,
    /// Displacement of the body's origin along the joint's axis, in the body's unit of length. It is constant
    /// for revolute joints and includes the position for prismatic joints.
    pub extension: Scalar<'g>,
    /// First body of the run to which this body belongs. A run is a sequence of revolute joints with parallel
    /// axes.
    pub run: usize,
    /// Rotation about z from the frame before the body's run of parallel joints; `None` if there is no
    /// rotation.
    pub turn_from_run: Option<Turn<'g>>,
    /// Moments of mass in the frame of the body's equations.
    pub moments: MassMoments<Scalar<'g>>,
    /// Rotation about z from the frame of the equations to the body's own frame; `None` if the frames are
    /// equal.
    pub to_body: Option<Turn<'g>>,
    /// The parent's unit of length divided by the body's unit of length.
    pub unit_ratio: f64,
    /// Body whose own frame is parallel to the frame of these equations. `None` if that frame is parallel to
    /// the frame before the sequence of joints with parallel axes.
    aligned: Option<usize>,
}

/// Computes the frame of each body's equations at the coordinates `y`.
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

/// Rotation between two frames in a sequence of joints with parallel axes, from the frame of body `from` to
/// the frame of body `to`. `None` is the frame before the sequence. Angles are added before the sine is
/// computed.
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
        // In a parallelogram the angles add up to zero.
        return offset.constant_turn(mechanism.graph);
    }
    let angle = angle.named(|| format!("angle{name}")) + zero.constant(offset.remainder);
    let angle = angle.named(|| format!("angle{name}_offset"));
    let sine = angle.call(Function::Sin).named(|| format!("sin{name}"));
    let cosine = angle.call(Function::Cos).named(|| format!("cos{name}"));
    Some(offset.advance((sine, cosine)))
}

/// Whether the joint of a body's parent is revolute, connects the parent to the base, and is not parallel to
/// the body's joint. Then the recursion ends at the parent, and needs only the torque about the parent's
/// joint axis, not the whole wrench.
pub fn ends_at_root(mechanism: &Mechanism<Scalar<'_>>, body: usize) -> bool {
    let child = &mechanism.bodies[body];
    let root = child.parent.map(|parent| &mechanism.bodies[parent]);
    !child.twist.is_none()
        && root.is_some_and(|root| root.parent.is_none() && root.axis == JointAxis::Revolute)
}

/// The parent of a body if both have revolute joints with parallel axes; otherwise `None`. It is also `None`
/// for a body of a joint with a quaternion.
fn run_parent(mechanism: &Mechanism<Scalar<'_>>, body: usize) -> Option<usize> {
    let turns = |body: usize| {
        let body = &mechanism.bodies[body];
        body.axis == JointAxis::Revolute && body.chain.is_none()
    };
    let parent = mechanism.bodies[body].parent?;
    let is_run = mechanism.bodies[body].twist.is_none() && turns(body) && turns(parent);
    is_run.then_some(parent)
}

/// The bodies from the first one of a sequence of joints with parallel axes up to `member`.
fn run_chain(mechanism: &Mechanism<Scalar<'_>>, member: usize) -> Vec<usize> {
    let mut chain: Vec<usize> =
        std::iter::successors(Some(member), |&body| run_parent(mechanism, body)).collect();
    chain.reverse();
    chain
}

impl<'g> Placement<'g> {
    /// Transforms an angular velocity, angular acceleration or moment from the frame of the parent's
    /// equations to the frame of this body's equations.
    pub fn to_child(&self, twist: &Twist, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let v = twist.to_child(v);
        let v = self.turn.map_or(v, |turn| v.turned_back(turn));
        self.attitude.map_or(v, |attitude| attitude.to_child(v))
    }

    /// Transforms an angular velocity, angular acceleration or moment from the frame of this body's equations
    /// to the frame of the parent's equations.
    pub fn to_parent(&self, twist: &Twist, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        twist.to_parent(self.before_joint(v))
    }

    /// Transforms an angular velocity, angular acceleration or moment from the frame of this body's equations
    /// to the frame before the joint.
    pub fn before_joint(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let v = self.before_attitude(v);
        self.turn.map_or(v, |turn| v.turned(turn))
    }

    fn before_attitude(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.attitude.map_or(v, |attitude| attitude.to_parent(v))
    }

    /// Transforms a matrix A to the frame before the joint: `R A Rᵀ` with the joint's rotation R.
    pub fn matrix_before_joint(&self, a: &Matrix3<'g>) -> Matrix3<'g> {
        let a = self.attitude.map_or(*a, |attitude| attitude.matrix_to_parent(a));
        self.turn.map_or(a, |turn| a.turned(turn))
    }

    /// Transforms a second moment of mass to the frame before the joint.
    pub fn second_before_joint(&self, second: Symmetric3<Scalar<'g>>) -> Symmetric3<Scalar<'g>> {
        let second = self.attitude.map_or(second, |attitude| attitude.symmetric_to_parent(second));
        self.turn.map_or(second, |turn| second.turned(turn))
    }

    /// Transforms an acceleration from the frame and unit of length of the parent's equations to those of
    /// this body's equations.
    pub fn to_child_unit(&self, twist: &Twist, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let v = self.scaled_turn(twist.to_child(v), |v, turn| v.turned_back(turn));
        self.attitude.map_or(v, |attitude| attitude.to_child(v))
    }

    /// Transforms a force or first moment of mass to the frame before the joint and to the parent's unit of
    /// length.
    pub fn before_joint_unit(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        self.scaled_turn(self.before_attitude(v), |v, turn| v.turned(turn))
    }

    /// Motion of this body for a unit of the parent's angular velocity about z: angular velocity, and
    /// velocity of the origin, in the frame and unit of length of this body's equations. The product of this
    /// motion and a wrench is the moment of the wrench about the parent's z axis. The product needs fewer
    /// operations than a transformation of the wrench.
    pub fn parent_screw(&self, twist: &Twist) -> Motion<'g> {
        let zero = self.extension.constant(0.0);
        let z = Vector3([zero, zero, zero.constant(1.0)]);
        let angular = self.to_child(twist, z);
        let lift = Vector3([zero, zero, self.extension]);
        let linear = self.to_child_unit(twist, z.cross(self.translation)) + angular.cross(lift);
        Motion { angular, linear }
    }

    /// Rotates a vector and changes its unit of length. Sine and cosine are multiplied by the ratio of the
    /// units.
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
