//! Moving bodies of a model in the frames of the description. Fixed bodies and bodies of held joints are part
//! of the moving body that carries them.

use super::inertia::moments_of_body;
use super::joint::JointAxis;
use super::lower::{lower, lower_pose};
use crate::graph::{Graph, Scalar};
use crate::model::{Joint, Model, Motion};
use crate::spatial::{MassMoments, Pose, Vector3, rotate, rotation_about};

/// The tree of moving bodies, in the frames of the description.
pub struct DescribedTree<'g> {
    /// Moving bodies of the tree. Parents precede children.
    pub bodies: Vec<DescribedBody<'g>>,
    /// For each link, the body that carries the link (`None`: base), and the pose of the link in the body's
    /// frame.
    pub links: Vec<(Option<usize>, Pose<Scalar<'g>>)>,
}

/// A moving body of a model in the frame of the description.
pub struct DescribedBody<'g> {
    /// Index of the link that the joint carries.
    pub link: usize,
    /// Index of the joint among the model's moving joints.
    pub joint: usize,
    /// Rotation or translation of this body relative to its parent.
    pub motion: JointAxis,
    /// Rate of the body's rotation or translation per unit of the joint's velocity.
    pub rate: f64,
    /// Whether this body is the slide of a helical joint.
    pub is_screw_slide: bool,
    /// Index of the parent body; `None` for the base.
    pub parent: Option<usize>,
    /// Pose of the joint's frame in the parent body's frame.
    pub pose: Pose<Scalar<'g>>,
    /// Moments of the body's mass, including bodies that are fixed to it.
    pub moments: MassMoments<Scalar<'g>>,
}

/// Collects the moving bodies of a model.
pub fn moving_bodies<'g>(graph: &'g Graph, model: &Model) -> DescribedTree<'g> {
    let mut tree = DescribedTree { bodies: Vec::new(), links: vec![(None, Pose::identity(graph))] };
    for (link, joint) in
        model.links.iter().enumerate().filter_map(|(k, link)| Some((k, link.joint.as_ref()?)))
    {
        tree.attach(graph, link, joint);
    }
    for (link, &(body, pose)) in model.links.iter().zip(&tree.links) {
        // Bodies that are fixed to the base never move.
        let Some(index) = body else { continue };
        let moments = &mut tree.bodies[index].moments;
        for described in &link.bodies {
            *moments = *moments + moments_of_body(graph, described).moved(&pose);
        }
    }
    tree
}

/// Moments of mass of the link of each joint that carries a link, in the order of these joints. The moments of a
/// link are in its frame of the description. Rotors of held joints are included.
pub fn described_moments<'g>(graph: &'g Graph, model: &Model) -> Vec<MassMoments<Scalar<'g>>> {
    let tree = moving_bodies(graph, model);
    let mut moments = vec![MassMoments::zero(graph); model.moving_joints().len()];
    for body in tree.bodies.iter().filter(|body| !body.is_screw_slide) {
        moments[body.joint] = body.moments;
    }
    for drive in model.held_rotors() {
        let (Some(index), pose) = tree.links[drive.carrier] else {
            continue;
        };
        let axis = Vector3(drive.axis.map(|x| graph.constant(x)));
        let axis = rotate(&pose.rotation, axis);
        let own = MassMoments::of_axial_inertia(lower(graph, &drive.rotor_inertia), axis);
        let joint = tree.bodies[index].joint;
        moments[joint] = moments[joint] + own;
    }
    model.carrying_joints().into_iter().map(|joint| moments[joint.index]).collect()
}

impl<'g> DescribedTree<'g> {
    fn attach(&mut self, graph: &'g Graph, link: usize, joint: &Joint) {
        let (carrier, parent_pose) = self.links[joint.parent];
        let pose = parent_pose.then(lower_pose(graph, &joint.origin));
        let position = match joint.motion {
            Motion::Coordinate(index) | Motion::Follower(index) => {
                return self.attach_moving(graph, link, joint, index, carrier, pose);
            }
            Motion::Fixed => 0.0,
            Motion::Held(position) => position,
        };
        self.links.push((carrier, pose.then(displacement(graph, joint, position))));
    }

    /// Adds the body of a moving joint. A sliding body precedes it if the joint is helical.
    fn attach_moving(
        &mut self,
        graph: &'g Graph,
        link: usize,
        joint: &Joint,
        index: usize,
        mut parent: Option<usize>,
        mut pose: Pose<Scalar<'g>>,
    ) {
        let motions = JointAxis::of(joint.kind);
        for (at, &(motion, rate)) in motions.iter().enumerate() {
            let is_screw_slide = at + 1 < motions.len();
            let moments = MassMoments::zero(graph);
            self.bodies.push(DescribedBody {
                link,
                joint: index,
                motion,
                rate,
                is_screw_slide,
                parent,
                pose,
                moments,
            });
            (parent, pose) = (Some(self.bodies.len() - 1), Pose::identity(graph));
        }
        self.links.push((parent, pose));
    }
}

/// Pose of a link in its joint's frame if the joint is at `position`.
fn displacement<'g>(graph: &'g Graph, joint: &Joint, position: f64) -> Pose<Scalar<'g>> {
    let mut pose = Pose::identity(graph);
    for (motion, rate) in JointAxis::of(joint.kind) {
        let amount = rate * position;
        match motion {
            JointAxis::Revolute => pose.rotation = rotation_about(joint.axis, amount),
            JointAxis::Prismatic => {
                pose.translation = Vector3(joint.axis.map(|x| graph.constant(x * amount)))
            }
        }
    }
    pose
}
