//! The moving bodies of a model in modified Denavit–Hartenberg frames.

use super::joint::JointAxis;
use super::number::{Number, Numbers};
use super::quaternion::{ChainPlace, POSITIONS};
use super::transmission::Transmission;
use crate::graph::{Graph, Scalar};
use crate::numeric;
use crate::spatial::{Angle, Attitude, MassMoments, Pose, Twist, Vector3, rotation_about};

/// The moving bodies of a model with joints, rotors and gravity. Parents precede children. Each body follows
/// one or several coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism<S: Numbers> {
    /// Graph that contains the scalars, or list of nodes without a graph.
    pub graph: S::Graph,
    /// Number of coordinates of the robot, including driven coordinates (with prescribed motion).
    pub coordinates: usize,
    /// Number of driven coordinates, whose motion is prescribed. They are the last coordinates.
    pub driven: usize,
    /// Index of each coordinate's position among the position entries; `None` if the position belongs to a
    /// quaternion.
    pub positions: Vec<Option<usize>>,
    /// Moving bodies of the robot. Parents precede children.
    pub bodies: Vec<Body<S>>,
    /// Gravitational acceleration in the base frame (m/s²).
    pub gravity: Vector3<S>,
    /// Rotors that turn relative to the body that carries them.
    pub rotors: Vec<Rotor<S>>,
    /// Moments of the moving mass that acts like mass fixed to the base, in the base frame.
    pub base_moments: MassMoments<S>,
    /// For each link of the model, the body that carries the link (`None`: base), and the pose of the link in
    /// the body's frame.
    pub links: Vec<(Option<usize>, Pose<S>)>,
}

/// A moving body in its own frame. z is along the joint's axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Body<S> {
    /// Name of the joint in the description. For the slide of a helical joint, `(slide)` is appended.
    pub name: String,
    /// Identifier of the joint, for names of values in generated code.
    pub identifier: String,
    /// Index among the moving joints: first the joints of the coordinates, then joints that follow them.
    pub joint: usize,
    /// Whether this is the slide of a helical joint: a massless body between the joint's parent and the body
    /// that the joint turns.
    pub is_screw_slide: bool,
    /// Coordinates that the body's joint follows, with their ratios.
    pub transmission: Transmission<S>,
    /// Place of this body in the chain of bodies of a joint with a quaternion; `None` for other joints.
    pub chain: Option<ChainPlace>,
    /// Rotation by the quaternion of a joint; `None` except for the first body of such a joint. The rotation
    /// follows the constant rotation between the links and precedes the body's motion.
    pub attitude: Option<Attitude<S>>,
    /// Index of the parent body; `None` if the base carries the joint.
    pub parent: Option<usize>,
    /// Elementary motion of the body's joint: rotation or translation.
    pub axis: JointAxis,
    /// Constant rotation from the parent's frame to the joint's frame before its motion.
    pub twist: Twist,
    /// Vector from the parent's origin to the joint's axis, in the parent's frame and unit of length.
    pub translation: Vector3<S>,
    /// Distance along the joint's axis from the end of `translation` to this body's origin, in this body's
    /// unit of length.
    pub lift: S,
    /// Angle about the joint's axis at position 0 of the coordinate.
    pub offset: Angle,
    /// Moments of mass of the body, in this body's unit of length.
    pub moments: MassMoments<S>,
    /// Unit of length, in metres. The forces, accelerations and moments of mass of this body and the
    /// translations of its children are expressed in this unit.
    pub length_unit: f64,
    /// The parent's unit of length divided by this body's unit; 1 if the base carries the joint.
    pub unit_ratio: f64,
}

/// A rotor: an axisymmetric body that turns about its axis relative to its carrier.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotor<S> {
    /// Motion of the rotor's drive: a coordinate, or a sum of several coordinates.
    pub transmission: Transmission<S>,
    /// Gear ratio i: turns of the rotor per unit of the drive's motion.
    pub ratio: S,
    /// Index of the body whose joint the drive moves; `None` if the drive moves a sum of coordinates.
    pub driven: Option<usize>,
    /// Index of the body that carries the rotor; `None` for the base, and for rotors that only enter the
    /// diagonal of the mass matrix.
    pub carrier: Option<usize>,
    /// Axis of the rotor in the carrier's frame, with unit length.
    pub axis: Vector3<S>,
    /// Axial inertia J_R of the rotor (kg m²).
    pub inertia: S,
}

impl<'g> Rotor<Scalar<'g>> {
    /// Inertia `i J_R` of the rotor that couples joint and carrier, with the gear ratio i and the axial
    /// inertia J_R.
    pub fn coupling_inertia(&self) -> Scalar<'g> {
        self.ratio * self.inertia
    }

    /// Inertia `i² J_R` of the rotor that acts at its joint, with the gear ratio i and the axial inertia J_R.
    pub fn reflected_inertia(&self) -> Scalar<'g> {
        self.ratio * self.coupling_inertia()
    }
}

impl<S: Numbers> Mechanism<S> {
    /// Whether motions are coupled: a coordinate moves several joints or a helical joint, or a joint or rotor
    /// follows several coordinates.
    pub fn is_coupled(&self) -> bool {
        self.bodies.len() > self.coordinates || self.rotors.iter().any(|rotor| rotor.driven.is_none())
    }

    /// Whether there are joints with quaternions.
    pub fn has_quaternions(&self) -> bool {
        self.bodies.iter().any(|body| body.chain.is_some())
    }

    /// Number of free coordinates, that is without the coordinates whose motion is prescribed.
    pub fn free(&self) -> usize {
        self.coordinates - self.driven
    }

    /// Bodies with independent joints whose motion is not prescribed. Parents precede children. A helical
    /// joint has one such body.
    pub fn independent(&self) -> impl Iterator<Item = &Body<S>> {
        self.bodies.iter().filter(|body| body.joint < self.free() && !body.is_screw_slide)
    }

    /// Index of the body that a moving joint carries; `None` if the mechanism has no joint with this index.
    pub fn carried_by(&self, joint: usize) -> Option<usize> {
        self.bodies.iter().position(|body| body.joint == joint && !body.is_screw_slide)
    }

    /// Whether every rotor is on the base or on the parent of the body that it drives. A rotor on another
    /// body would couple bodies that are not neighbours.
    pub fn rotors_are_neighbours(&self) -> bool {
        let sits_near = |rotor: &Rotor<S>| match rotor.driven {
            _ if rotor.carrier.is_none() => true,
            Some(driven) => self.bodies[driven].parent == rotor.carrier,
            None => false,
        };
        self.rotors.iter().all(sits_near)
    }

    /// Number of pairs of joints of which one is on the other's path to the base.
    pub fn pairs(&self) -> usize {
        let mut depths: Vec<usize> = Vec::with_capacity(self.bodies.len());
        for body in &self.bodies {
            depths.push(body.parent.map_or(0, |parent| depths[parent] + 1));
        }
        depths.iter().sum()
    }

    /// Whether the tree has more than one leaf (a body without children).
    pub fn branches(&self) -> bool {
        self.children().iter().filter(|children| children.is_empty()).count() > 1
    }

    /// Indices of the children of each body.
    pub fn children(&self) -> Vec<Vec<usize>> {
        let mut children = vec![Vec::new(); self.bodies.len()];
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some(parent) = body.parent {
                children[parent].push(index);
            }
        }
        children
    }
}

impl<S> Body<S> {
    /// Label of motions and forces in generated code: the identifier of the joint. For a joint with a
    /// quaternion, the label does not contain the suffix of the velocity.
    pub fn label(&self) -> &str {
        let whole = self.chain.and(self.identifier.rsplit_once('_'));
        whole.map_or(self.identifier.as_str(), |(joint, _)| joint)
    }
}

impl<'g> Body<Scalar<'g>> {
    /// Origin of this body in the parent's frame, at position 0 of a prismatic joint. If the constant
    /// rotation has an angle γ about z, the translation along the axis has a component along the parent's x.
    pub fn origin_in_parent(&self) -> Vector3<Scalar<'g>> {
        let zero = self.lift.constant(0.0);
        self.translation + self.twist.to_parent(Vector3([zero, zero, self.lift]))
    }
}

impl Body<Number> {
    /// Component along the parent's x of [`Self::origin_in_parent`], the position of the body's origin;
    /// `None` if it depends on free parameters.
    pub fn lever(&self) -> Option<f64> {
        let share = self.twist.matrix()[(0, 2)];
        let lifted = if share == 0.0 { 0.0 } else { share * self.lift.value()? };
        Some(self.translation[0].value()? + lifted)
    }
}

impl<S: Numbers> Mechanism<S> {
    /// Position of each coordinate on a graph: an input, or 0 if the position belongs to a quaternion.
    pub fn positions_on<'g>(&self, graph: &'g Graph) -> Vec<Scalar<'g>> {
        let position = |entry: &Option<usize>| match entry {
            Some(entry) => graph.input(POSITIONS, *entry),
            None => graph.constant(0.0),
        };
        self.positions.iter().map(position).collect()
    }
}

impl<'g> Mechanism<Scalar<'g>> {
    /// Gives each body its own unit of length \[m\], so that one of its lengths becomes 1. Torques keep their
    /// values, but forces and accelerations are scaled. All joints must be revolute.
    pub fn in_length_units(mut self, units: &[f64]) -> Self {
        for (body, &unit) in self.bodies.iter_mut().zip(units) {
            let parent_unit = body.parent.map_or(unit, |parent| units[parent]);
            body.translation = body.translation.map(|x| scaled_down(x, parent_unit));
            body.lift = scaled_down(body.lift, unit);
            body.moments.mass = body.moments.mass * (unit * unit);
            body.moments.first = body.moments.first.map(|x| x * unit);
            body.length_unit = unit;
            body.unit_ratio = parent_unit / unit;
        }
        self
    }

    /// Gravitational acceleration in the base frame, in the unit of length of body `root`, which is on the
    /// base.
    pub fn gravity_for(&self, root: usize) -> Vector3<Scalar<'g>> {
        self.gravity.map(|x| scaled_down(x, self.bodies[root].length_unit))
    }

    /// Moves the origin of a revolute body along its axis, so that the translation along the axis becomes 0.
    /// This translation is added to those of the children.
    pub fn leave_lift_to_children(&mut self, index: usize) {
        let zero = self.graph.constant(0.0);
        let lift = std::mem::replace(&mut self.bodies[index].lift, zero);
        self.bodies[index].moments = self.bodies[index].moments.lifted(lift);
        let along = Vector3([zero, zero, lift]);
        for child in self.bodies.iter_mut().filter(|body| body.parent == Some(index)) {
            child.translation = child.translation + along;
        }
        for (_, pose) in self.links.iter_mut().filter(|(body, _)| *body == Some(index)) {
            pose.translation = pose.translation + along;
        }
    }

    /// Adds the translation along a revolute body's axis to the translation from its parent. If the distance
    /// from the parent is then equal to a sibling's within rounding, both become the same number.
    pub fn leave_lift_to_parent(&mut self, index: usize) {
        let origin = self.bodies[index].origin_in_parent();
        let parent = self.bodies[index].parent;
        let others = self.bodies.iter().take(index).filter(|body| parent.is_some() && body.parent == parent);
        let levers: Vec<f64> =
            others.filter_map(|body| body.translation.values()).flatten().map(f64::abs).collect();
        let body = &mut self.bodies[index];
        body.translation = origin.map(|x| {
            let Some(value) = x.value() else { return x };
            let same = levers.iter().find(|lever| (value.abs() - **lever).abs() <= SAME_LEVER);
            same.map_or(x, |lever| x.constant(lever.copysign(value))).cleaned(SAME_LEVER)
        });
        body.lift = self.graph.constant(0.0);
    }

    /// Rotates the frame of a body without children about its axis so that the first moment of mass has no y
    /// component.
    pub fn align_first_moment(&mut self, index: usize) {
        let first = self.bodies[index].moments.first;
        if let (Some(x), Some(y)) = (first[0].value(), first[1].value())
            && (x != 0.0 || y != 0.0)
        {
            self.turn_leaf(index, numeric::atan2(y, x));
            self.bodies[index].moments.first.0[1] = self.graph.constant(0.0);
        }
    }

    /// Rotates the frame of a body without children about its axis so that the second moment of mass has no
    /// xy component.
    pub fn align_second_moment(&mut self, index: usize) {
        let second = self.bodies[index].moments.second;
        if let (Some(xx), Some(xy), Some(yy)) = (second.xx.value(), second.xy.value(), second.yy.value())
            && xy != 0.0
        {
            self.turn_leaf(index, 0.5 * numeric::atan2(2.0 * xy, xx - yy));
            self.bodies[index].moments.second.xy = self.graph.constant(0.0);
        }
    }

    /// Rotates the frame of a body without children about its axis. All quantities in this frame are rotated
    /// in the opposite direction.
    ///
    /// The angle is rounded to 2⁻⁵⁰. Otherwise different shifts of mass would give angles with different last
    /// bits, and sines of both angles would be computed.
    fn turn_leaf(&mut self, index: usize, angle: f64) {
        const STEPS: f64 = (1_u64 << 50) as f64;
        let angle = (angle * STEPS).round() / STEPS;
        let body = &mut self.bodies[index];
        let (sine, cosine) = numeric::sin_cos(angle);
        let back = (self.graph.constant(-sine), self.graph.constant(cosine));
        body.offset = body.offset + Angle::new(angle);
        body.moments = body.moments.turned(back);
        for rotor in &mut self.rotors {
            if rotor.carrier == Some(index) {
                rotor.axis = rotor.axis.turned(back);
            }
        }
        let back = Pose {
            rotation: rotation_about([0.0, 0.0, 1.0], -angle),
            translation: Vector3::zero(self.graph.constant(0.0)),
        };
        for (body, pose) in &mut self.links {
            if *body == Some(index) {
                *pose = back.then(*pose);
            }
        }
    }
}

/// Largest difference \[m\] of two bodies' distances from their parent that counts as equal.
const SAME_LEVER: f64 = 1e-15;

/// The quotient `x / unit`, which is exactly 1 if both are the same constant.
fn scaled_down(x: Scalar<'_>, unit: f64) -> Scalar<'_> {
    match x.value() {
        Some(value) => x.constant(value / unit),
        None => x * (1.0 / unit),
    }
}
