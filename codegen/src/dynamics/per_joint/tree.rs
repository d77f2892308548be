//! Joints of the loops. Each follows exactly one coordinate.
//!
//! A joint that follows several coordinates is a series of joints along one axis, one per coordinate; the
//! last carries the mass. The ratio is part of the joint's screw, so sums over the joints of a coordinate
//! have no factors:
//!
//! ```text
//! τ_c = Σ_{i of c} τ_i      M_cd = Σ_{i of c, j of d} M_ij      (∂τ/∂y)_cd = Σ_{i of c, j of d} ∂τ_i/∂y_j
//! ```
//!
//! A joint with a quaternion is a series of joints, one per velocity.
//!
//! A rotor whose momentum is not added at a neighbouring joint is also a joint: it turns about its axis on
//! its carrier and has only its axial inertia.

use crate::kinematics::{Followed, Mechanism, Numbers, Rotor};
use crate::program::arrays::{Coordinates, Tree};

/// A joint of the loops.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopJoint<S> {
    /// Object that the joint moves.
    pub moved: Moved,
    /// Followed coordinate, and motion per unit of it.
    pub follows: Followed<S>,
    /// Whether the joint carries the mass: the last in a series.
    pub is_last: bool,
}

/// Object moved by a joint of the loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moved {
    /// A body of the mechanism.
    Body(usize),
    /// A rotor of the mechanism.
    Rotor(usize),
}

/// All joints of the loops.
pub(super) struct LoopJoints<S> {
    /// Joints, parents first.
    pub list: Vec<LoopJoint<S>>,
    /// Row of each joint in arrays.
    pub places: Vec<usize>,
    /// Tree of the joints, by row.
    pub tree: Tree,
    /// For each rotor the neighbouring joint that turns it, if the rotor is on that joint's parent.
    pub beside: Vec<Option<usize>>,
}

/// Joints while they are collected, each with its parent.
struct Collected<S> {
    joints: Vec<(LoopJoint<S>, Option<usize>)>,
    /// For each body the joint that carries it.
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

    /// Coordinates of the joints; `None` if each joint is a coordinate.
    pub(super) fn coordinates(&self, mechanism: &Mechanism<S>) -> Option<Coordinates> {
        let mut of_joints = vec![0; self.list.len()];
        for (joint, &place) in self.list.iter().zip(&self.places) {
            of_joints[place] = joint.follows.coordinate;
        }
        (of_joints.len() > mechanism.coordinates).then(|| Coordinates::new(&self.tree, of_joints))
    }

    /// Velocities of each joint with a quaternion, by row.
    pub(super) fn chains(&self, mechanism: &Mechanism<S>) -> Vec<Vec<usize>> {
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for (joint, &place) in self.list.iter().zip(&self.places) {
            let Moved::Body(index) = joint.moved else { continue };
            match mechanism.bodies[index].chain {
                Some(chain) if chain.first == index => chains.push(vec![place]),
                // The bodies of a chain stand together.
                Some(_) => chains.last_mut().into_iter().for_each(|chain| chain.push(place)),
                None => {}
            }
        }
        chains
    }

    /// The coordinate that a joint follows.
    pub(super) fn coordinate(&self, joint: usize) -> usize {
        self.list[joint].follows.coordinate
    }

    /// Whether a joint is the joint of its coordinate.
    pub(super) fn is_own(&self, joint: usize) -> bool {
        self.places[joint] == self.coordinate(joint)
    }
}

impl<S: Numbers> Collected<S> {
    /// Adds a joint for each followed coordinate; the last of them.
    fn row(&mut self, moved: Moved, mut parent: Option<usize>, terms: &[Followed<S>]) -> Option<usize> {
        for (k, &follows) in terms.iter().enumerate() {
            let is_last = k + 1 == terms.len();
            self.joints.push((LoopJoint { moved, follows, is_last }, parent));
            parent = Some(self.joints.len() - 1);
        }
        parent
    }

    /// The joint that turns with a rotor, where it stands on the rotor's carrier.
    fn beside(&self, rotor: &Rotor<S>) -> Option<usize> {
        let (carrier, turned) = (rotor.carrier?, rotor.transmission.single()?);
        let turns = |&(joint, parent): &(LoopJoint<S>, Option<usize>)| {
            joint.follows.coordinate == turned.coordinate && parent == Some(self.carriers[carrier])
        };
        self.joints.iter().position(turns)
    }
}

/// Whether a rotor only adds to the diagonal of M.
pub(super) fn is_on_diagonal<S: Numbers>(rotor: &Rotor<S>) -> bool {
    rotor.carrier.is_none() && rotor.transmission.single().is_some()
}

/// The joints of the coordinates stand first, in order; all others follow them.
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
