//! Link frames of trees by the modified Denavit–Hartenberg convention.
//!
//! The z axis is the joint's axis. The x axis is on the common normal of z and the axis of the main child,
//! which is the child with the largest subtree. The origin is the intersection of this normal and z (Craig
//! 1986; Khalil and Kleinfinger 1986). Other children of a branching body have an additional angle γ. If the
//! convention leaves a choice (leaves of the tree, parallel or coincident axes), offsets are set to zero.

use nalgebra::{Matrix3, Vector3 as Numeric3};

use super::joint::JointAxis;
use super::lower::{lower, lower_followed};
use super::mechanism::{Body, Mechanism, Rotor};
use super::quaternion::{self, ChainPlace, Displaced};
use super::tree::{DescribedBody, DescribedTree};
use crate::graph::{Graph, Scalar};
use crate::model::{self, Model, RotorCoupling};
use crate::numeric;
use crate::spatial::{Angle, MassMoments, Pose, Twist, Vector3, cleaned, rotate};

/// Axes are exactly parallel if the length of their cross product is below this value. Smaller values are
/// rounding errors.
const PARALLEL: f64 = 1e-12;

/// Axes are treated as parallel if the sine of the angle between them is at most this value. Their common
/// normal would be far away, and moments of mass about a point there would lose digits. For example, 1.5708
/// instead of 90° moves the normal by kilometres.
const NEARLY_PARALLEL: f64 = 1e-2;

/// Lengths below this value \[m\] are rounding errors.
const ROUNDING: f64 = 1e-14;

/// Frame of a body before all free choices are made, in the frame of the description. A part is `None` if the
/// axes do not determine it.
#[derive(Clone, Copy)]
struct Draft<'g> {
    z: Numeric3<f64>,
    x: Option<Numeric3<f64>>,
    origin: Option<Vector3<Scalar<'g>>>,
}

/// Chooses the frames of all bodies, and expresses all quantities in these frames.
pub fn assign<'g>(graph: &'g Graph, model: &Model, tree: &DescribedTree<'g>) -> Mechanism<Scalar<'g>> {
    let directions = directions(model, tree);
    let drafts = common_normals(model, tree, &directions);
    let moving_joints = model.moving_joints();
    let mut placed: Vec<Pose<Scalar<'g>>> = Vec::new();
    let mut bodies = Vec::new();
    for (index, described) in tree.bodies.iter().enumerate() {
        let chain = chain_place(model, described, index);
        let parent = described.parent.map_or(Pose::identity(graph), |parent| placed[parent]);
        let (axis, moving) = (described.motion, &moving_joints[described.joint]);
        let frame = match chain {
            Some(place) => quaternion::frame(graph, place),
            None => complete(&drafts[index], described, &parent, axis),
        };
        let rate = described.rate * directions[index];
        let from_parent = parent.inverse().then(described.pose);
        let mut step = Step::new(graph, &from_parent.then(frame), chain.is_some());
        step.shift(graph, axis, moving.offset * rate);
        let displaced = displaced(graph, model, described, chain, index);
        if let Some(origin) = displaced.as_ref().and_then(|displaced| displaced.origin) {
            step.translation = step.translation + rotate(&from_parent.rotation, origin);
        }
        bodies.push(Body {
            name: name(model, described),
            identifier: identifier(model, described),
            joint: described.joint,
            is_screw_slide: described.is_screw_slide,
            transmission: lower_followed(graph, &moving.follows).scaled(graph.constant(rate)),
            chain,
            attitude: displaced.map(|displaced| displaced.attitude),
            parent: described.parent,
            axis,
            twist: step.twist,
            translation: step.translation,
            lift: step.lift,
            offset: step.offset,
            moments: described.moments.moved(&frame.inverse()),
            length_unit: 1.0,
            unit_ratio: 1.0,
        });
        placed.push(frame);
    }
    let links = tree.links.iter().map(|&(body, pose)| match body {
        Some(index) => (body, placed[index].inverse().then(pose)),
        None => (body, pose),
    });
    let mut mechanism = Mechanism {
        graph,
        coordinates: model.motion_count(),
        driven: model.driven.len(),
        positions: (0..model.motion_count()).map(|coordinate| model.position_of(coordinate)).collect(),
        bodies,
        gravity: Vector3(model.gravity.each_ref().map(|formula| lower(graph, formula))),
        rotors: Vec::new(),
        base_moments: MassMoments::zero(graph),
        links: links.collect(),
    };
    add_rotors(model, &mut mechanism);
    mechanism
}

/// The displacement from the frame of a body's parent to the frame of the body:
///
/// - a translation perpendicular to z
/// - a constant rotation
/// - a translation along z (lift)
/// - a rotation about z
///
/// The joint's position is added to the lift or to the angle about z.
struct Step<'g> {
    translation: Vector3<Scalar<'g>>,
    twist: Twist,
    lift: Scalar<'g>,
    offset: Angle,
}

impl<'g> Step<'g> {
    fn new(graph: &'g Graph, relative: &Pose<Scalar<'g>>, is_in_chain: bool) -> Self {
        let (twist, offset) = decompose(&relative.rotation);
        let z = twist.matrix().column(2).into_owned();
        let zero = graph.constant(0.0);
        let along = || (0..3).fold(zero, |sum, k| sum + relative.translation[k] * z[k]).cleaned(ROUNDING);
        // In a chain, a rotation by a quaternion follows the translation, so the translation is not along the
        // axis.
        let lift = if is_in_chain { zero } else { along() };
        let lateral = relative.translation - Vector3([0, 1, 2].map(|k| lift * z[k]));
        Self { translation: lateral.map(|x| x.cleaned(ROUNDING)), twist, lift, offset }
    }

    /// Shifts the zero position of a joint about or along its axis.
    fn shift(&mut self, graph: &'g Graph, axis: JointAxis, shift: f64) {
        match axis.turns() {
            _ if shift == 0.0 => {}
            true => self.offset = self.offset + Angle::new(shift),
            false => self.lift = self.lift + graph.constant(shift),
        }
    }
}

/// The place of a body among the bodies that replace a joint with a quaternion; `None` for other joints.
fn chain_place(model: &Model, described: &DescribedBody<'_>, index: usize) -> Option<ChainPlace> {
    quaternion::chain_place(model, described.joint, index)
}

/// Displacement of the first body of a joint with a quaternion by the joint's position entries; `None` for
/// other bodies.
fn displaced<'g>(
    graph: &'g Graph,
    model: &Model,
    described: &DescribedBody<'_>,
    chain: Option<ChainPlace>,
    index: usize,
) -> Option<Displaced<'g>> {
    let joint = model.quaternion_joint_of(described.joint)?;
    chain.filter(|place| place.first == index).map(|_| quaternion::displaced(graph, model, joint))
}

fn joint<'m>(model: &'m Model, described: &DescribedBody<'_>) -> &'m model::Joint {
    #[expect(clippy::expect_used, reason = "only links with a joint become bodies")]
    model.links[described.link].joint.as_ref().expect("a moving body has a joint")
}

/// The name of a body's joint. `(slide)` is appended for the slide of a helical joint.
fn name(model: &Model, described: &DescribedBody<'_>) -> String {
    let name = &joint(model, described).name;
    match described.is_screw_slide {
        true => format!("{name} (slide)"),
        false => name.clone(),
    }
}

/// Name of a body's values in generated code.
fn identifier(model: &Model, described: &DescribedBody<'_>) -> String {
    let identifier = &joint(model, described).identifier;
    match described.is_screw_slide {
        true => format!("{identifier}_slide"),
        false => identifier.clone(),
    }
}

/// Sign of each joint's axis: −1 if the axis is antiparallel to the axis of its parent and is therefore
/// reversed. The sign of the coordinate is then reversed, too.
fn directions(model: &Model, tree: &DescribedTree<'_>) -> Vec<f64> {
    let mut directions = vec![1.0; tree.bodies.len()];
    for (index, described) in tree.bodies.iter().enumerate() {
        let Some(parent) = described.parent else {
            continue;
        };
        if model.quaternion_joint_of(described.joint).is_some() {
            // The velocities of this joint are in the frame of the description.
            continue;
        }
        let z = described.pose.rotation * Numeric3::from(joint(model, described).axis);
        let parent_z = Numeric3::from(joint(model, &tree.bodies[parent]).axis) * directions[parent];
        if z.cross(&parent_z).norm() < PARALLEL && z.dot(&parent_z) < 0.0 {
            directions[index] = -1.0;
        }
    }
    directions
}

/// Visits the bodies from the leaves to the root, and computes the axes and origins that the main child
/// determines.
fn common_normals<'g>(model: &Model, tree: &DescribedTree<'g>, directions: &[f64]) -> Vec<Draft<'g>> {
    let main = main_children(tree);
    let mut drafts: Vec<Draft<'g>> = tree
        .bodies
        .iter()
        .zip(directions)
        .map(|(body, direction)| Draft {
            z: Numeric3::from(joint(model, body).axis) * *direction,
            x: None,
            origin: None,
        })
        .collect();
    for index in (0..drafts.len()).rev() {
        let Some(child) = main[index] else { continue };
        let described = &tree.bodies[child];
        if model.quaternion_joint_of(described.joint).is_some() {
            // The axes of this joint do not have constant directions.
            continue;
        }
        let z = described.pose.rotation * drafts[child].z;
        let point = match drafts[child].origin {
            Some(origin) => described.pose.translation + rotate(&described.pose.rotation, origin),
            None => described.pose.translation,
        };
        let (x, along) = normal_to_line(drafts[index].z, point, z);
        // If both axes are parallel and the child's position along its axis is free, the position of this
        // body along its axis is free, too.
        let along = along.filter(|_| drafts[child].origin.is_some() || !are_parallel(drafts[index].z, z));
        // A prismatic joint has no angle about its axis. Its x axis follows from the parent, and the child's
        // twist has an angle γ.
        if tree.bodies[index].motion == JointAxis::Revolute {
            drafts[index].x = x;
        }
        if described.motion == JointAxis::Revolute {
            let origin = along.map(|t| Vector3([0, 1, 2].map(|k| t * drafts[index].z[k])));
            drafts[index].origin = origin.map(|origin| origin.map(|x| x.cleaned(ROUNDING)));
        }
    }
    drafts
}

/// The main child of each body: the child with the largest subtree, or the first of several equally large
/// subtrees.
fn main_children(tree: &DescribedTree<'_>) -> Vec<Option<usize>> {
    let mut sizes = vec![1; tree.bodies.len()];
    let mut main: Vec<Option<usize>> = vec![None; tree.bodies.len()];
    for (index, body) in tree.bodies.iter().enumerate().rev() {
        let Some(parent) = body.parent else { continue };
        sizes[parent] += sizes[index];
        if main[parent].is_none_or(|other| sizes[index] >= sizes[other]) {
            main[parent] = Some(index);
        }
    }
    main
}

/// The common normal of two axes: the axis through 0 along `a`, and the axis through `point` along `b`.
/// Returns the direction of the normal if it is determined, and its intersection with the first axis as a
/// distance from 0.
fn normal_to_line<'g>(
    a: Numeric3<f64>,
    point: Vector3<Scalar<'g>>,
    b: Numeric3<f64>,
) -> (Option<Numeric3<f64>>, Option<Scalar<'g>>) {
    let dot = |n: Numeric3<f64>| point[0] * n[0] + point[1] * n[1] + point[2] * n[2];
    let normal = a.cross(&b);
    if !are_parallel(a, b) {
        let cosine = a.dot(&b);
        let along = (dot(a) - dot(b) * cosine) * (1.0 / normal.norm_squared());
        return (Some(tidy(normal)), Some(along));
    }
    let along = dot(a);
    let across = point - Vector3([0, 1, 2].map(|k| along * a[k]));
    let direction = across.values().map(Numeric3::from).or_else(|| single_direction(across));
    (direction.filter(|d| d.norm() > ROUNDING).map(tidy), Some(along))
}

fn are_parallel(a: Numeric3<f64>, b: Numeric3<f64>) -> bool {
    a.cross(&b).norm() <= NEARLY_PARALLEL
}

/// The direction of a vector that contains parameters, if only one component is non-zero.
fn single_direction(v: Vector3<Scalar<'_>>) -> Option<Numeric3<f64>> {
    let mut present = (0..3).filter(|&k| !v[k].cleaned(ROUNDING).is_zero());
    let (axis, None) = (present.next()?, present.next()) else {
        return None;
    };
    let mut direction = Numeric3::zeros();
    direction[axis] = 1.0;
    Some(direction)
}

/// Scales a vector to unit length, and removes rounding errors of directions along an axis.
fn tidy(v: Numeric3<f64>) -> Numeric3<f64> {
    v.normalize().map(|x| if x.abs() < PARALLEL { 0.0 } else { x }).normalize()
}

/// Completes the frame of a body. The free offsets are chosen so that most offsets are zero. Bodies are
/// visited from the root to the leaves.
fn complete<'g>(
    draft: &Draft<'g>,
    described: &DescribedBody<'g>,
    parent: &Pose<Scalar<'g>>,
    axis: JointAxis,
) -> Pose<Scalar<'g>> {
    let to_parent = parent.rotation.transpose() * described.pose.rotation;
    let x = draft.x.unwrap_or_else(|| {
        let (twist, _) = decompose(&cleaned(to_parent * any_frame(draft.z)));
        to_parent.transpose() * twist.matrix().column(0)
    });
    let x = (x - draft.z * x.dot(&draft.z)).normalize();
    let rotation = cleaned(Matrix3::from_columns(&[x, draft.z.cross(&x), draft.z]));
    let offset = parent.translation - described.pose.translation;
    let in_body = rotate(&described.pose.rotation.transpose(), offset);
    let translation = match axis {
        JointAxis::Prismatic if described.parent.is_some() => in_body,
        JointAxis::Prismatic => Vector3::zero(offset[0]),
        JointAxis::Revolute => {
            draft.origin.unwrap_or_else(|| on_axis(draft.z, in_body, described.parent.is_some()))
        }
    };
    Pose { rotation, translation: translation.map(|x| x.cleaned(ROUNDING)) }
}

/// The foot of the perpendicular from the parent's origin to the joint's axis, so that no translation along
/// the axis remains.
fn on_axis<'g>(
    z: Numeric3<f64>,
    parent_origin: Vector3<Scalar<'g>>,
    has_parent: bool,
) -> Vector3<Scalar<'g>> {
    if !has_parent {
        return Vector3::zero(parent_origin[0]);
    }
    let along = parent_origin[0] * z[0] + parent_origin[1] * z[1] + parent_origin[2] * z[2];
    Vector3([0, 1, 2].map(|k| along * z[k]))
}

/// A right-handed frame with this z axis.
fn any_frame(z: Numeric3<f64>) -> Matrix3<f64> {
    let helper = if z[0].abs() < 0.9 { Numeric3::x() } else { Numeric3::y() };
    let x = (helper - z * helper.dot(&z)).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

/// Angles of a rotation matrix `R = R_z(γ) R_x(α) R_z(θ)`, with γ = 0 if possible.
fn decompose(rotation: &Matrix3<f64>) -> (Twist, Angle) {
    let z = rotation.column(2);
    let sine = numeric::length([z[0], z[1]]);
    let twist = if sine < PARALLEL {
        Twist { gamma: (0.0, 1.0), alpha: (0.0, z[2].signum()) }
    } else if z[0].abs() < PARALLEL {
        Twist { gamma: (0.0, 1.0), alpha: exact((-z[1], z[2])) }
    } else {
        Twist { gamma: exact((z[0] / sine, -z[1] / sine)), alpha: exact((sine, z[2])) }
    };
    let turn = twist.matrix().transpose() * rotation;
    (twist, Angle::new(numeric::atan2(turn[(1, 0)], turn[(0, 0)])))
}

/// Scales sine and cosine of an angle to unit length. Multiples of 90° become exact.
fn exact((sine, cosine): (f64, f64)) -> (f64, f64) {
    if sine.abs() < PARALLEL {
        (0.0, cosine.signum())
    } else if cosine.abs() < PARALLEL {
        (sine.signum(), 0.0)
    } else {
        let length = numeric::length([sine, cosine]);
        (sine / length, cosine / length)
    }
}

/// Adds the rotors of a model. The axial inertia of a rotor belongs to its carrier, and its rotation relative
/// to the carrier is described by a [`Rotor`].
fn add_rotors(model: &Model, mechanism: &mut Mechanism<Scalar<'_>>) {
    for drive in &model.drives {
        let inertia = lower(mechanism.graph, &drive.rotor_inertia);
        if inertia.is_zero() {
            continue;
        }
        let (body, pose) = mechanism.links[drive.carrier];
        let axis = rotate(&pose.rotation, Vector3(drive.axis.map(|x| mechanism.graph.constant(x))));
        let carrier = body.filter(|_| drive.coupling == RotorCoupling::Body);
        if let Some(index) = carrier {
            let own = MassMoments::of_axial_inertia(inertia, axis);
            mechanism.bodies[index].moments = mechanism.bodies[index].moments + own;
        }
        if drive.acts_on.is_empty() {
            continue;
        }
        let ratio = lower(mechanism.graph, &drive.gear_ratio);
        let transmission = lower_followed(mechanism.graph, &drive.acts_on);
        let driven = drive.coordinate().and_then(|coordinate| mechanism.carried_by(coordinate));
        mechanism.rotors.push(Rotor { transmission, ratio, driven, carrier, axis, inertia });
    }
}
