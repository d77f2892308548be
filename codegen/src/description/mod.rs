//! Unchecked contents of a description. TOML, URDF and MJCF are read into the same types.
//!
//! Entries refer to each other by name, and each entry keeps its location in the file. A value that cannot be
//! read causes an error and is replaced by a valid value, so that no further errors follow from it.

pub(crate) mod angles;

use crate::diagnostic::{At, Span};
use crate::model::pose::{Unsaid, rotate_inertia};
use crate::model::{
    FrictionTerm, Input, JointKind, MotorTorque, Options, Parameter, Pose, QuaternionKind, RotorCoupling,
    TorqueSpeedLine, WrenchAxes,
};
use gelenk_formula::Formula;
use std::collections::BTreeSet;

/// A name in a description, with its place.
pub(crate) type Name = At<String>;

impl Name {
    /// The name in backticks, for messages.
    pub fn quoted(&self) -> String {
        format!("`{}`", self.value)
    }
}

/// A robot as its description defines it. A field is `None` if the description does not contain the entry.
#[derive(Debug, Default)]
pub(crate) struct RobotDescription {
    pub name: Name,
    pub description: Vec<String>,
    pub gravity: Option<[Formula; 3]>,
    pub parameters: Vec<At<Parameter>>,
    /// Name of the base link; `None` if the description does not name it.
    pub base: Option<Name>,
    /// Place of the entry that makes the base floating; `None` if the base is fixed.
    pub floating_base: Option<Span>,
    /// Whether the floating joint of the base was already added.
    pub is_freed: bool,
    /// Limits, friction and drives that the description gives for the velocities of the floating base, until
    /// the floating joint is added.
    pub velocities: Vec<JointDescription>,
    /// Whether the description is an MJCF or extends one.
    pub is_mjcf: bool,
    /// Links that the description lists, including links that no joint refers to.
    pub links: Vec<Name>,
    /// Links with a visual or collision shape, but without mass and inertia.
    pub weightless_shapes: Vec<Name>,
    /// Rotors of a URDF that could not be assigned to a joint.
    pub skipped_rotors: Vec<SkippedRotor>,
    pub bodies: Vec<BodyDescription>,
    pub joints: Vec<JointDescription>,
    pub frames: Vec<FrameDescription>,
    /// Names of the joints in the order of the coordinates; `None` without a given order.
    pub coordinates: Option<Vec<Name>>,
    /// Whether the children of a link have the order of their joints' names, as in Pinocchio. Otherwise they
    /// have the order of the description.
    pub sort_joints: bool,
    /// Held joints that follow other joints. It is an error if a followed joint is not held, too.
    pub resting: Vec<Name>,
    /// Drives of the tables `[[drives]]`, which may act on several joints.
    pub drives: Vec<SharedDriveDescription>,
    /// Forces between two frames.
    pub point_forces: Vec<PointForceDescription>,
    /// Inputs that act as a wrench in a frame.
    pub wrench_inputs: Vec<WrenchInputDescription>,
    /// Wrenches that are arguments of generated functions.
    pub wrenches: Vec<WrenchDescription>,
    /// Drive of all joints for which the description gives no drive.
    pub default_drive: DriveChoice,
    /// Whether a mass matrix that is not positive definite causes a warning instead of an error.
    pub accept_unphysical: bool,
    pub options: Option<Options>,
}

impl RobotDescription {
    /// Drive of a joint. If the joint has no drive of its own, the drive is [`Self::default_drive`]. By
    /// default, joints that follow others and joints on which `[[drives]]` act have no drive.
    pub fn drive_of<'d>(&'d self, joint: &'d JointDescription) -> &'d DriveChoice {
        match &joint.drive {
            Some(drive) => &drive.value,
            None if joint.is_follower() || self.is_acted_on(joint) => &DriveChoice::Passive,
            None => &self.default_drive,
        }
    }

    /// Location of the first name in `names` that equals `wanted`, or of the robot's name if no name equals
    /// `wanted`.
    pub fn place_among<'r>(&'r self, mut names: impl Iterator<Item = &'r Name>, wanted: &str) -> Span {
        names.find(|name| name.value == wanted).unwrap_or(&self.name).span
    }

    /// All motors with the names of their drives: motors of joints, then motors of `[[drives]]`.
    pub fn motors(&self) -> impl Iterator<Item = (&str, &DriveDescription)> {
        let of_joints = self.joints.iter().filter_map(|joint| match self.drive_of(joint) {
            DriveChoice::Motor(motor) => {
                Some((&motor.name.as_ref().unwrap_or(&joint.name).value[..], &**motor))
            }
            DriveChoice::Ideal | DriveChoice::Passive => None,
        });
        of_joints.chain(self.drives.iter().map(|drive| (&drive.name.value[..], &drive.motor)))
    }

    /// Names of frames and links to which forces, inputs and wrenches refer.
    pub fn names_at_frames(&self) -> impl Iterator<Item = &Name> {
        let between = self.point_forces.iter().flat_map(|force| &force.between);
        let inputs = self.wrench_inputs.iter().map(|input| &input.frame);
        between.chain(inputs).chain(self.wrenches.iter().map(|wrench| &wrench.frame))
    }

    /// Names of the links in `links` that the description contains. The generator adds links between the
    /// velocities of a spherical or floating joint. These inner links are left out.
    pub fn described_links<'l>(&self, links: &'l [Name]) -> impl Iterator<Item = &'l str> + use<'l> {
        let inner =
            self.joints.iter().filter(|joint| joint.leads_on).filter_map(|joint| joint.child.as_ref());
        let inner: BTreeSet<String> = inner.map(|link| link.value.clone()).collect();
        links.iter().map(|link| link.value.as_str()).filter(move |link| !inner.contains(*link))
    }

    /// Whether a drive under `[[drives]]` acts on the joint.
    pub fn is_acted_on(&self, joint: &JointDescription) -> bool {
        let mut terms = self.drives.iter().flat_map(|drive| &drive.on);
        terms.any(|term| term.joint.value == joint.name.value)
    }
}

impl Default for At<String> {
    fn default() -> Self {
        Self::new(String::new(), Span::default())
    }
}

/// A rigid body of a description. A field is `None` if the description does not contain it.
#[derive(Debug, Clone)]
pub(crate) struct BodyDescription {
    pub name: Name,
    pub link: Name,
    /// Pose of the body's frame in the frame of the link.
    pub origin: Option<Pose>,
    /// Parts of the body's pose that this file does not give. If the file extends another description, these
    /// parts keep the values of that description.
    pub unsaid: Unsaid,
    pub mass: Option<At<Formula>>,
    pub center_of_mass: Option<[Formula; 3]>,
    pub inertia: Option<At<[Formula; 6]>>,
    pub accept_unphysical: bool,
    /// Whether mass and inertia come from a URDF or an MJCF. A physically impossible inertia then causes a
    /// warning. In TOML it causes an error.
    pub is_published: bool,
}

impl BodyDescription {
    /// Centre of mass of the body in the frame of the link (m).
    pub fn center_in_link(&self) -> [Formula; 3] {
        let center = self.center_of_mass.clone().unwrap_or([Formula::ZERO; 3]);
        match &self.origin {
            Some(origin) => origin.point(&center),
            None => center,
        }
    }

    /// Inertia of the body about its centre of mass, in the axes of the link's frame [kg m²]: xx, xy, xz, yy,
    /// yz, zz.
    pub fn inertia_in_link(&self) -> [Formula; 6] {
        let inertia = self.inertia.clone().map_or([Formula::ZERO; 6], |inertia| inertia.value);
        match &self.origin {
            Some(origin) => rotate_inertia(&origin.rotation, &inertia),
            None => inertia,
        }
    }
}

/// A joint of a description. A field is `None` if the description does not contain it.
#[derive(Debug, Clone)]
pub(crate) struct JointDescription {
    pub name: Name,
    pub kind: Option<JointKind>,
    pub parent: Option<Name>,
    pub child: Option<Name>,
    pub origin: Option<Pose>,
    /// Parts of the joint's pose that this file does not give. If the file extends another description, these
    /// parts keep the values of that description.
    pub unsaid: Unsaid,
    /// Pose of the child link's frame in the frame that moves with the joint. The two frames differ only for
    /// standard Denavit–Hartenberg rows.
    pub link_frame: Option<Pose>,
    pub axis: Option<[f64; 3]>,
    pub held: Option<f64>,
    /// Whether the motion of the joint is prescribed, so that the joint is driven.
    pub driven: Option<At<bool>>,
    pub limits: LimitsDescription,
    pub springs: Option<At<Vec<Formula>>>,
    pub friction: Option<At<FrictionDescription>>,
    pub drive: Option<At<DriveChoice>>,
    /// Joints that this joint follows, with ratios.
    pub follows: Option<At<Vec<FollowsDescription>>>,
    /// Position of this joint when the joints that it follows are at position 0 (rad or m).
    pub offset: Option<At<f64>>,
    /// The spherical or floating joint, if this entry is one of its velocities.
    pub part_of: Option<PartOf>,
    /// Whether this entry is a part of a spherical or floating joint, but not its last part. The child link
    /// of such a part is added by the generator and is not in the description.
    pub leads_on: bool,
}

/// Identifies one velocity of a spherical or floating joint.
#[derive(Debug, Clone)]
pub(crate) struct PartOf {
    pub joint: Name,
    pub kind: QuaternionKind,
    /// Index of the velocity among the velocities of the spherical or floating joint.
    pub index: usize,
}

/// A joint that another joint or a drive follows, with the ratio.
#[derive(Debug, Clone)]
pub(crate) struct FollowsDescription {
    pub joint: Name,
    pub ratio: At<Formula>,
}

/// A drive of a table `[[drives]]`.
#[derive(Debug, Clone)]
pub(crate) struct SharedDriveDescription {
    pub name: Name,
    /// Joints on which the drive acts, with weights. The motor's angle is the gear ratio times the weighted
    /// sum of the joints' positions.
    pub on: Vec<FollowsDescription>,
    pub motor: DriveDescription,
}

impl JointDescription {
    /// Creates a joint with a name and no other entries.
    pub fn named(name: Name) -> Self {
        Self {
            name,
            kind: None,
            parent: None,
            child: None,
            origin: None,
            unsaid: Unsaid::default(),
            link_frame: None,
            axis: None,
            held: None,
            driven: None,
            limits: LimitsDescription::default(),
            springs: None,
            friction: None,
            drive: None,
            follows: None,
            offset: None,
            part_of: None,
            leads_on: false,
        }
    }

    /// Whether the joint moves: it is neither fixed nor held.
    pub fn moves(&self) -> bool {
        self.held.is_none() && self.kind.is_some_and(|kind| kind != JointKind::Fixed)
    }

    /// Whether the joint moves with other joints.
    pub fn is_follower(&self) -> bool {
        self.moves() && self.follows.is_some()
    }

    /// Whether the position of the joint is a coordinate: the joint moves independently of other joints, and
    /// its motion is not prescribed.
    pub fn is_coordinate(&self) -> bool {
        self.moves() && self.follows.is_none() && !self.is_driven()
    }

    /// Whether the motion of the joint is prescribed as a function of time.
    pub fn is_driven(&self) -> bool {
        self.moves() && self.follows.is_none() && self.driven.as_ref().is_some_and(|driven| driven.value)
    }

    /// Sets the defaults of a new joint: the type is revolute, and the child link has the joint's name.
    pub fn complete(&mut self) {
        self.kind.get_or_insert(JointKind::Revolute);
        self.child.get_or_insert_with(|| self.name.clone());
    }
}

/// Friction law of a joint in a description.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrictionDescription {
    /// Terms of the friction force or torque, functions of velocity and position.
    pub terms: Vec<FrictionTerm>,
    /// Terms of the load-dependent friction: friction divided by the load, without unit.
    pub load: Option<At<Vec<FrictionTerm>>>,
}

impl FrictionDescription {
    /// Whether the friction law has no terms.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty() && self.load.is_none()
    }
}

/// Limits of a joint in a description, with their places in the file.
#[derive(Debug, Clone, Default)]
pub(crate) struct LimitsDescription {
    pub position: Option<At<[f64; 2]>>,
    pub velocity: Option<At<f64>>,
    pub effort: Option<At<f64>>,
    pub peak_effort: Option<At<f64>>,
    pub acceleration: Option<At<f64>>,
    pub jerk: Option<At<f64>>,
}

impl LimitsDescription {
    /// Limits on speed, force and other magnitudes, each with its name in messages.
    pub fn amounts(&self) -> [(&'static str, &Option<At<f64>>); 5] {
        [
            ("speed", &self.velocity),
            ("effort", &self.effort),
            ("peak effort", &self.peak_effort),
            ("acceleration", &self.acceleration),
            ("jerk", &self.jerk),
        ]
    }
}

/// Drive of a joint in a description: none, ideal, or a motor.
#[derive(Debug, Clone, Default)]
pub(crate) enum DriveChoice {
    /// The joint has no drive and no input.
    #[default]
    Passive,
    /// The input is a torque or force at the joint, without a rotor.
    Ideal,
    /// The joint is driven by a motor with gear and rotor.
    Motor(Box<DriveDescription>),
}

/// A motor with gear and rotor in a description.
#[derive(Debug, Clone)]
pub(crate) struct DriveDescription {
    pub name: Option<Name>,
    pub gear_ratio: At<Formula>,
    pub rotor_inertia: At<Formula>,
    pub carrier: Option<Name>,
    pub axis: Option<[f64; 3]>,
    pub coupling: RotorCoupling,
    pub input: Input,
    /// Location of the motor constant, or of the motor if the description has no motor constant.
    pub input_span: Span,
    pub torque: MotorTorque,
    /// Highest speed of the motor's shaft (rad/s).
    pub speed: Option<At<f64>>,
    /// Torque–speed line from the stall torque to the no-load speed.
    pub line: Option<At<TorqueSpeedLine>>,
    /// Friction terms of the motor's shaft, functions of the motor's angle and speed.
    pub friction: Option<At<Vec<FrictionTerm>>>,
}

impl DriveDescription {
    /// A drive without a gear whose rotor adds `rotor_inertia` to the joint's diagonal entry of the mass
    /// matrix.
    pub fn at_joint(rotor_inertia: At<Formula>) -> Self {
        let span = rotor_inertia.span;
        Self {
            name: None,
            gear_ratio: At::new(Formula::ONE, span),
            rotor_inertia,
            carrier: None,
            axis: None,
            coupling: RotorCoupling::Diagonal,
            input: Input::Torque,
            input_span: span,
            torque: MotorTorque::default(),
            speed: None,
            line: None,
            friction: None,
        }
    }
}

/// A rotor of a URDF that was not assigned to a joint, with the possible joints and gear ratios.
#[derive(Debug, Clone)]
pub(crate) struct SkippedRotor {
    /// Inertia about the rotor's axis, before the gear (kg m²).
    pub inertia: At<f64>,
    pub joints: Vec<String>,
    pub ratios: Vec<f64>,
}

impl SkippedRotor {
    /// Name of the rotor's joint, and the inertia that the rotor adds to the diagonal of the mass matrix
    /// (ratio² times rotor inertia). `None` if several joints or ratios are possible.
    pub fn place(&self) -> Option<(&str, f64)> {
        match (&self.joints[..], &self.ratios[..]) {
            ([joint], [ratio]) => Some((joint, ratio * ratio * self.inertia.value)),
            _ => None,
        }
    }
}

/// A force between the origins of two frames. A positive force pulls the origins together.
#[derive(Debug, Clone)]
pub(crate) struct PointForceDescription {
    pub name: Name,
    /// Names of the two frames or links between which the force acts.
    pub between: [Name; 2],
    /// Force law as a function of the distance between the frames (m) and its rate (m/s).
    pub law: Option<At<Formula>>,
    pub input: Option<PullDescription>,
    /// Shortest and longest distance between the frames (m).
    pub stroke: Option<At<[f64; 2]>>,
    /// Highest rate of the distance between the frames (m/s).
    pub speed: Option<At<f64>>,
}

/// An input that is a force pulling two frames together.
#[derive(Debug, Clone)]
pub(crate) struct PullDescription {
    pub name: Name,
    pub limits: Option<At<[f64; 2]>>,
}

/// An input that is a wrench fixed in a frame.
#[derive(Debug, Clone)]
pub(crate) struct WrenchInputDescription {
    pub name: Name,
    /// Name of the frame or link at which the wrench acts.
    pub frame: Name,
    /// Force (N), then moment about the frame's origin (N m), if the input is 1.
    pub wrench: At<[Formula; 6]>,
    pub limits: Option<At<[f64; 2]>>,
}

/// A wrench that is an argument of functions.
#[derive(Debug, Clone)]
pub(crate) struct WrenchDescription {
    pub name: Name,
    /// Name of the frame or link at which the wrench acts.
    pub frame: Name,
    pub axes: WrenchAxes,
}

/// A named frame in a description.
#[derive(Debug, Clone)]
pub(crate) struct FrameDescription {
    pub name: Name,
    pub link: Name,
    pub pose: Pose,
    /// Whether the frame is a site of an MJCF; sites and bodies may have equal names.
    pub is_site: bool,
}
