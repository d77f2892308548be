//! A robot: a tree of links with drives, force laws and named frames.

use super::{
    Drive, FollowedCoordinate, Follower, ForceInput, Input, Joint, JointKind, MovingJoint, PointForce, Pose,
    QuaternionJoint, RotorCoupling, Wrench,
};
use gelenk_formula::Formula;
use std::collections::BTreeSet;

/// A robot: a tree of links with drives, force laws and named frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Name of the generated module: a Rust identifier in snake case.
    pub name: String,
    /// Text of the description, one entry per line. Generated documentation escapes this text.
    pub description: Vec<String>,
    /// Gravitational acceleration in the base frame (m/s²).
    pub gravity: [Formula; 3],
    /// Free parameters of the robot, in the order of the description.
    pub parameters: Vec<Parameter>,
    /// All links of the robot. `links[0]` is the base. Parents precede children.
    pub links: Vec<Link>,
    /// Indices of the links that the joints of the coordinates carry: the joint of coordinate `i` carries
    /// `links[coordinates[i]]`.
    pub coordinates: Vec<usize>,
    /// Indices of the links that the driven joints (with prescribed motion) carry. In lists of all moving
    /// joints, driven joints come after the joints of the coordinates. The motion of driven joint `k` is
    /// `Motion::Coordinate(coordinates.len() + k)`.
    pub driven: Vec<usize>,
    /// Spherical and floating joints, in the order of their coordinates. Each of these joints has several
    /// coordinates.
    pub quaternion_joints: Vec<QuaternionJoint>,
    /// Joints that follow coordinates. In lists of all moving joints, they are the last entries.
    pub followers: Vec<Follower>,
    /// Drives of the robot. Drives with an input have the order of the inputs u.
    pub drives: Vec<Drive>,
    /// Forces between two frames, for example of springs.
    pub point_forces: Vec<PointForce>,
    /// Inputs that are forces at frames. In the vector of inputs they follow the inputs of drives.
    pub force_inputs: Vec<ForceInput>,
    /// Wrenches that are arguments of functions.
    pub wrenches: Vec<Wrench>,
    /// Named frames that are fixed to links.
    pub frames: Vec<Frame>,
    /// Options of the generator that the description sets.
    pub options: Options,
}

/// A free parameter: a field of the struct `Parameters` in generated modules.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name of the parameter, a Rust identifier.
    pub name: String,
    /// Value of the parameter in the description.
    pub default: f64,
    /// Unit of the parameter as text, empty if unknown.
    pub unit: String,
    /// Meaning of the parameter in one line; may be empty.
    pub description: String,
}

/// A link, and the joint that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name of the link in the description.
    pub name: String,
    /// Joint between the parent link and this link; `None` only for the base.
    pub joint: Option<Joint>,
    /// Rigid bodies that are fixed to this link. Generated functions treat them as one body.
    pub bodies: Vec<Body>,
}

/// A rigid body that is fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name of the body in the description.
    pub name: String,
    /// Mass of the body (kg).
    pub mass: Formula,
    /// Centre of mass of the body in the link's frame (m).
    pub center_of_mass: [Formula; 3],
    /// Inertia of the body about its centre of mass in the axes of the link's frame: xx, xy, xz, yy, yz, zz
    /// (kg m²).
    pub inertia: [Formula; 6],
}

impl Model {
    /// The joints of the coordinates, in order. Joints with prescribed motion, and joints that follow others,
    /// are not included.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = &Joint> {
        self.coordinates.iter().map(|&link| self.joint_of(link))
    }

    /// Values of the free parameters that the description gives.
    #[must_use]
    pub fn described_parameters(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.default).collect()
    }

    /// Whether a joint follows coordinates, or a drive acts on several coordinates.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        !self.followers.is_empty() || self.moving_drives().any(|drive| drive.coordinate().is_none())
    }

    /// Number of coordinates, including driven coordinates (with prescribed motion).
    #[must_use]
    pub fn motion_count(&self) -> usize {
        self.coordinates.len() + self.driven.len()
    }

    /// Whether friction or a spring is discontinuous, at a joint or on the shaft of a drive.
    #[must_use]
    pub fn has_dry_friction(&self) -> bool {
        self.moving_joints().iter().any(|moving| moving.joint.jumps()) || self.drives.iter().any(Drive::jumps)
    }

    /// Sorted pairs of coordinates (i, j): the friction force at coordinate i jumps if velocity j changes its
    /// sign.
    #[must_use]
    pub fn friction_jumps(&self) -> Vec<[usize; 2]> {
        let moving = self.moving_joints();
        let joints = moving.iter().map(|moving| {
            let terms = moving.joint.friction.iter().chain(&moving.joint.load_friction);
            (terms.collect::<Vec<_>>(), &moving.follows)
        });
        let shafts = self.rubbing_drives().map(|drive| (drive.friction.iter().collect(), &drive.acts_on));
        let mut pairs = BTreeSet::new();
        for (terms, follows) in joints.chain(shafts) {
            if terms.iter().any(|term| !term.coefficient.is_zero() && term.basis_jumps()) {
                let moves = follows.iter().filter(|each| !each.ratio.is_zero()).map(|each| each.coordinate);
                let coordinates: Vec<usize> = moves.filter(|&each| each < self.coordinates.len()).collect();
                pairs.extend(coordinates.iter().flat_map(|&i| coordinates.iter().map(move |&j| [i, j])));
            }
        }
        pairs.into_iter().collect()
    }

    /// The driven joints, whose motion is prescribed, in their order.
    pub fn driven_joints(&self) -> impl ExactSizeIterator<Item = &Joint> {
        self.driven.iter().map(|&link| self.joint_of(link))
    }

    pub(crate) fn joint_of(&self, link: usize) -> &Joint {
        let joint = self.links.get(link).and_then(|link| link.joint.as_ref());
        joint.unwrap_or_else(|| unreachable!("validation gives every moving link its joint"))
    }

    /// Index of the link that a coordinate moves, also for coordinates with prescribed motion; `None` if
    /// there is no such coordinate.
    #[must_use]
    pub fn link_of(&self, coordinate: usize) -> Option<usize> {
        self.coordinates.iter().chain(&self.driven).nth(coordinate).copied()
    }

    /// All moving joints: first the joints of the coordinates in order, then the joints with prescribed
    /// motion, then joints that follow others.
    #[must_use]
    pub fn moving_joints(&self) -> Vec<MovingJoint<'_>> {
        let links = self.coordinates.iter().chain(&self.driven);
        let own = links.enumerate().map(|(coordinate, &link)| MovingJoint {
            joint: self.joint_of(link),
            link,
            follows: vec![FollowedCoordinate::itself(coordinate)],
            offset: 0.0,
        });
        let followers = self.followers.iter().map(|follower| MovingJoint {
            joint: self.joint_of(follower.link),
            link: follower.link,
            follows: follower.follows.clone(),
            offset: follower.offset,
        });
        own.chain(followers).collect()
    }

    /// The inputs: drives that move coordinates, then forces at frames.
    pub fn inputs(&self) -> impl Iterator<Item = Actuator<'_>> {
        self.input_drives().map(Actuator::Drive).chain(self.force_inputs.iter().map(Actuator::Force))
    }

    /// Drives that move coordinates, in the order of the inputs.
    pub fn input_drives(&self) -> impl Iterator<Item = &Drive> {
        let drives = self.drives.iter();
        drives.filter(|drive| !drive.acts_on.is_empty() && drive.input != Input::None)
    }

    /// Drives whose rotors move with coordinates, with or without an input.
    pub fn moving_drives(&self) -> impl Iterator<Item = &Drive> {
        self.drives.iter().filter(|drive| !drive.acts_on.is_empty())
    }

    /// Drives of held joints, whose rotors do not turn and are parts of their carriers.
    pub(crate) fn held_rotors(&self) -> impl Iterator<Item = &Drive> {
        let drives = self.drives.iter();
        drives.filter(|drive| drive.acts_on.is_empty() && drive.coupling == RotorCoupling::Body)
    }

    /// Drives on several coordinates whose shafts have friction.
    pub fn rubbing_drives(&self) -> impl Iterator<Item = &Drive> {
        self.drives.iter().filter(|drive| !drive.friction.is_empty())
    }

    /// Whether the input matrix depends on the positions.
    #[must_use]
    pub fn inputs_depend_on_position(&self) -> bool {
        !self.force_inputs.is_empty()
    }

    /// Unit of an input. For a drive it is the unit of the motor's torque or current, or N for a drive without
    /// gear and rotor on a prismatic joint. For a force at frames it is N, or N m for a wrench whose force is
    /// zero.
    pub fn input_unit(&self, input: Actuator<'_>) -> &'static str {
        match input {
            Actuator::Drive(drive) => self.drive_unit(drive),
            Actuator::Force(force) => force.unit(),
        }
    }

    fn drive_unit(&self, drive: &Drive) -> &'static str {
        let joint = drive.coordinate().and_then(|moved| self.joints().nth(moved));
        let is_force = joint.is_some_and(|joint| joint.kind == JointKind::Prismatic);
        let is_direct =
            drive.gear_ratio.value(&[]) == Some(1.0) && drive.rotor_inertia.value(&[]) == Some(0.0);
        match drive.input {
            Input::Current(_) => "A",
            Input::Torque if is_direct && is_force => "N",
            Input::Torque | Input::None => "N m",
        }
    }

    /// The joints that carry the given links.
    pub(crate) fn joints_of(&self, links: &[usize]) -> Vec<&Joint> {
        let joints = links.iter().filter_map(|&link| self.links.get(link)?.joint.as_ref());
        joints.collect()
    }
}

/// Source of an input: a drive, or a force at frames.
#[derive(Debug, Clone, Copy)]
pub enum Actuator<'m> {
    /// A drive that acts on joints.
    Drive(&'m Drive),
    /// A force or wrench at frames.
    Force(&'m ForceInput),
}

impl<'m> Actuator<'m> {
    /// Name of the input: that of its drive or force.
    #[must_use]
    pub fn name(self) -> &'m str {
        match self {
            Self::Drive(drive) => &drive.name,
            Self::Force(force) => &force.name,
        }
    }

    /// The coordinate on which the input acts; `None` if it acts on several coordinates or at frames.
    #[must_use]
    pub fn coordinate(self) -> Option<usize> {
        match self {
            Self::Drive(drive) => drive.coordinate(),
            Self::Force(_) => None,
        }
    }

    /// The drive of the input; `None` if the input acts at frames.
    #[must_use]
    pub fn drive(self) -> Option<&'m Drive> {
        match self {
            Self::Drive(drive) => Some(drive),
            Self::Force(_) => None,
        }
    }
}

/// A named frame that is fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Name of the frame exactly as in the description.
    pub name: String,
    /// Name of the frame as a Rust identifier, distinct among the frames. The frame's functions are
    /// `frame_<identifier>_…`.
    pub identifier: String,
    /// Index of the link that carries the frame.
    pub link: usize,
    /// Pose of the frame in the link's frame.
    pub pose: Pose,
}

/// Options of the generator that the description sets.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// Names of the functions to generate; empty for all functions.
    pub functions: Vec<String>,
    /// Names of the functions that are also generated for eight states at once.
    pub lanes: Vec<String>,
    /// Slope s of `tanh(s v)`, which replaces `sign(v)` in generated code; `None` keeps the exact `sign`.
    pub smooth_sign: Option<f64>,
    /// Number of Runge–Kutta steps in one sample time of the generated `step`. `None` means 1.
    pub substeps: Option<usize>,
}
