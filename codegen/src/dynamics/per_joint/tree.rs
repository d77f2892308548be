//! Joints of the loops. Each joint of the loops follows exactly one coordinate.
//!
//! A joint of the robot that follows several coordinates becomes a series of joints along one axis, one joint
//! per coordinate. The last joint of the series carries the mass. The ratio is part of a joint's screw, so
//! sums over the joints of a coordinate have no factors:
//!
//! ```text
//! τ_c = Σ_{i of c} τ_i      M_cd = Σ_{i of c, j of d} M_ij      (∂τ/∂y)_cd = Σ_{i of c, j of d} ∂τ_i/∂y_j
//! ```
//!
//! A joint with a quaternion becomes a series of joints, one joint per velocity.
//!
//! A rotor becomes a joint if its momentum cannot be added at a joint of its carrier. This joint turns about
//! the rotor's axis and moves only the rotor's axial inertia.

use crate::kinematics::{Followed, Mechanism, Numbers, Rotor};
use crate::program::arrays::{Coordinates, Tree};

/// A joint of the loops over joints, which follows exactly one coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopJoint<S> {
    /// Body or rotor that the joint moves.
    pub moved: Moved,
    /// Coordinate that the joint follows, with the ratio of the joint's motion to the motion of the
    /// coordinate.
    pub follows: Followed<S>,
    /// Whether the joint is the last of the joints that replace one joint of the robot. Only the last joint
    /// carries the mass.
    pub is_last: bool,
}

/// Object that a joint of the loops moves: a body or a rotor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moved {
    /// The body with this index in the mechanism.
    Body(usize),
    /// The rotor with this index in the mechanism.
    Rotor(usize),
}

/// All joints of the loops over joints, with their tree.
pub(super) struct LoopJoints<S> {
    /// The joints of the loops. Parents precede children.
    pub list: Vec<LoopJoint<S>>,
    /// Position of each joint's entry in arrays.
    pub places: Vec<usize>,
    /// Tree of the joints, indexed by their positions in arrays.
    pub tree: Tree,
    /// For each rotor, the joint that turns it. `None` if the rotor's carrier is not the parent body of that
    /// joint.
    pub beside: Vec<Option<usize>>,
}

/// Joints while they are collected, each with the index of its parent.
struct Collected<S> {
    joints: Vec<(LoopJoint<S>, Option<usize>)>,
    /// For each body, the joint that carries it.
    carriers: Vec<usize>,
}

impl<S: Numbers> LoopJoints<S> {
    pub(super) fn new(mechanism: &Mechanism<S>) -> Self {
        let mut collected = Collected { joints: Vec::new(), carriers: Vec::new() };
        for (index, body) in mechanism.bodies.iter().enumerate() {
            let parent = body.parent.map(|parent| collected.carriers[parent]);
            let last = collected.row(Moved::Body(index), parent, &body.transmission.terms);
            collected.carriers.extend(last);
        }
        let mut beside = Vec::with_capacity(mechanism.rotors.len());
        for (index, rotor) in mechanism.rotors.iter().enumerate() {
            let joint = collected.beside(rotor);
            beside.push(joint);
            if joint.is_none() && !is_on_diagonal(rotor) {
                let parent = rotor.carrier.map(|carrier| collected.carriers[carrier]);
                collected.row(Moved::Rotor(index), parent, &rotor.transmission.terms);
            }
        }
        let (list, parents): (Vec<_>, Vec<_>) = collected.joints.into_iter().unzip();
        let places = places(mechanism, &list);
        let mut tree = Tree { parents: vec![None; list.len()], order: places.clone() };
        for (&place, parent) in places.iter().zip(parents) {
            tree.parents[place] = parent.map(|parent: usize| places[parent]);
        }
        Self { list, places, tree, beside }
    }

    /// Coordinates that the joints follow, indexed by the joints' positions in arrays; `None` if each joint
    /// is independent.
    pub(super) fn coordinates(&self, mechanism: &Mechanism<S>) -> Option<Coordinates> {
        let mut of_joints = vec![0; self.list.len()];
        for (joint, &place) in self.list.iter().zip(&self.places) {
            of_joints[place] = joint.follows.coordinate;
        }
        (of_joints.len() > mechanism.coordinates).then(|| Coordinates::new(&self.tree, of_joints))
    }

    /// For each joint with a quaternion, the positions of its velocities in arrays.
    pub(super) fn chains(&self, mechanism: &Mechanism<S>) -> Vec<Vec<usize>> {
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for (joint, &place) in self.list.iter().zip(&self.places) {
            let Moved::Body(index) = joint.moved else { continue };
            match mechanism.bodies[index].chain {
                Some(chain) if chain.first == index => chains.push(vec![place]),
                // The bodies of a chain are adjacent.
                Some(_) => chains.last_mut().into_iter().for_each(|chain| chain.push(place)),
                None => {}
            }
        }
        chains
    }

    /// Index of the coordinate that a joint follows.
    pub(super) fn coordinate(&self, joint: usize) -> usize {
        self.list[joint].follows.coordinate
    }

    /// Whether a joint's position is a coordinate itself, so that the joint is independent.
    pub(super) fn is_own(&self, joint: usize) -> bool {
        self.places[joint] == self.coordinate(joint)
    }
}

impl<S: Numbers> Collected<S> {
    /// Adds one joint for each coordinate that the body or rotor follows. Returns the last added joint.
    fn row(&mut self, moved: Moved, mut parent: Option<usize>, terms: &[Followed<S>]) -> Option<usize> {
        for (k, &follows) in terms.iter().enumerate() {
            let is_last = k + 1 == terms.len();
            self.joints.push((LoopJoint { moved, follows, is_last }, parent));
            parent = Some(self.joints.len() - 1);
        }
        parent
    }

    /// The joint that turns a rotor, if the rotor's carrier is the parent body of this joint.
    fn beside(&self, rotor: &Rotor<S>) -> Option<usize> {
        let (carrier, turned) = (rotor.carrier?, rotor.transmission.single()?);
        let turns = |&(joint, parent): &(LoopJoint<S>, Option<usize>)| {
            joint.follows.coordinate == turned.coordinate && parent == Some(self.carriers[carrier])
        };
        self.joints.iter().position(turns)
    }
}

/// Whether a rotor only adds its inertia to a diagonal entry of the mass matrix.
pub(super) fn is_on_diagonal<S: Numbers>(rotor: &Rotor<S>) -> bool {
    rotor.carrier.is_none() && rotor.transmission.single().is_some()
}

/// Positions of the joints in arrays: first the independent joints in the order of the coordinates, then all
/// other joints.
fn places<S: Numbers>(mechanism: &Mechanism<S>, list: &[LoopJoint<S>]) -> Vec<usize> {
    let mut next = mechanism.coordinates;
    let place = |joint: &LoopJoint<S>| {
        if let Moved::Body(index) = joint.moved {
            let body = &mechanism.bodies[index];
            if body.joint < mechanism.coordinates && !body.is_screw_slide {
                return body.joint;
            }
        }
        next += 1;
        next - 1
    };
    list.iter().map(place).collect()
}
