//! Unchecked contents of a description, in a form common to TOML, URDF and MJCF.
//!
//! Entries refer to each other by name and know their place in the file. A value that could not be read was
//! reported, and a valid value replaces it to avoid further errors.

pub(crate) mod angles;

use crate::diagnostic::{At, Span};
use crate::model::pose::{Unsaid, rotate_inertia};
use crate::model::{
    FrictionTerm, Input, JointKind, MotorTorque, Options, Parameter, Pose, QuaternionKind, RotorCoupling,
    TorqueSpeedLine, WrenchAxes,
};
use gelenk_formula::Formula;
use std::collections::BTreeSet;

/// A described name.
pub(crate) type Name = At<String>;

impl Name {
    /// The name in the form for messages.
    pub fn quoted(&self) -> String {
        format!("`{}`", self.value)
    }
}

/// A described robot.
#[derive(Debug, Default)]
pub(crate) struct RobotDescription {
    pub name: Name,
    pub description: Vec<String>,
    pub gravity: Option<[Formula; 3]>,
    pub parameters: Vec<At<Parameter>>,
    /// Name of the base link, if described.
    pub base: Option<Name>,
    /// Place where the base is described as floating.
    pub floating_base: Option<Span>,
    /// Whether the base was made floating.
    pub is_freed: bool,
    /// Velocities of the base, kept until its floating joint exists.
    pub velocities: Vec<JointDescription>,
    /// Whether the description is an MJCF or extends one.
    pub is_mjcf: bool,
    /// Links that exist even if no joint names them.
    pub links: Vec<Name>,
    /// Links with a shape but no body.
    pub weightless_shapes: Vec<Name>,
    /// Rotors that could not be assigned to a joint.
    pub skipped_rotors: Vec<SkippedRotor>,
    pub bodies: Vec<BodyDescription>,
    pub joints: Vec<JointDescription>,
    pub frames: Vec<FrameDescription>,
    /// Joint names in the order of the coordinates, if described.
    pub coordinates: Option<Vec<Name>>,
    /// Whether children of a link are ordered by the names of their joints, as in Pinocchio, not as
    /// described.
    pub sort_joints: bool,
    /// Followers that match patterns of held joints; they must be at rest.
    pub resting: Vec<Name>,
    /// Drives under `[[drives]]`.
    pub drives: Vec<SharedDriveDescription>,
    /// Forces between two frames.
    pub point_forces: Vec<PointForceDescription>,
    /// Inputs that are wrenches.
    pub wrench_inputs: Vec<WrenchInputDescription>,
    /// Wrenches that are arguments of functions.
    pub wrenches: Vec<WrenchDescription>,
    /// Drive of joints that describe none.
    pub default_drive: DriveChoice,
    /// Whether a mass matrix that is not positive definite gives a warning instead of an error.
    pub accept_unphysical: bool,
    pub options: Option<Options>,
}

impl RobotDescription {
    /// Drive of a joint: the described one, otherwise the default of the robot. Followers, and joints with a
    /// drive under `[[drives]]`, have none by default.
    pub fn drive_of<'d>(&'d self, joint: &'d JointDescription) -> &'d DriveChoice {
        match &joint.drive {
            Some(drive) => &drive.value,
            None if joint.is_follower() || self.is_acted_on(joint) => &DriveChoice::Passive,
            None => &self.default_drive,
        }
    }

    /// Place of the first of some names; the place of the robot's name if there is none.
    pub fn place_among<'r>(&'r self, mut names: impl Iterator<Item = &'r Name>, wanted: &str) -> Span {
        names.find(|name| name.value == wanted).unwrap_or(&self.name).span
    }

    /// All motors with the names of their drives.
    pub fn motors(&self) -> impl Iterator<Item = (&str, &DriveDescription)> {
        let of_joints = self.joints.iter().filter_map(|joint| match self.drive_of(joint) {
            DriveChoice::Motor(motor) => {
                Some((&motor.name.as_ref().unwrap_or(&joint.name).value[..], &**motor))
            }
            DriveChoice::Ideal | DriveChoice::Passive => None,
        });
        of_joints.chain(self.drives.iter().map(|drive| (&drive.name.value[..], &drive.motor)))
    }

    /// Frames and links named by forces, inputs and wrenches.
    pub fn names_at_frames(&self) -> impl Iterator<Item = &Name> {
        let between = self.point_forces.iter().flat_map(|force| &force.between);
        let inputs = self.wrench_inputs.iter().map(|input| &input.frame);
        between.chain(inputs).chain(self.wrenches.iter().map(|wrench| &wrench.frame))
    }

    /// Links of a list that are described, without those between the velocities of one joint.
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

/// A rigid body; fields are `None` if not described.
#[derive(Debug, Clone)]
pub(crate) struct BodyDescription {
    pub name: Name,
    pub link: Name,
    /// Pose of the body's own frame in the link's described frame.
    pub origin: Option<Pose>,
    /// Fields of the base description that this file does not override.
    pub unsaid: Unsaid,
    pub mass: Option<At<Formula>>,
    pub center_of_mass: Option<[Formula; 3]>,
    pub inertia: Option<At<[Formula; 6]>>,
    pub accept_unphysical: bool,
    /// Whether the body is from a URDF; its inertia is then accepted as published.
    pub is_published: bool,
}

impl BodyDescription {
    /// Centre of mass in the link's described frame.
    pub fn center_in_link(&self) -> [Formula; 3] {
        let center = self.center_of_mass.clone().unwrap_or([Formula::ZERO; 3]);
        match &self.origin {
            Some(origin) => origin.point(&center),
            None => center,
        }
    }

    /// Inertia about the centre of mass in axes of the link's described frame.
    pub fn inertia_in_link(&self) -> [Formula; 6] {
        let inertia = self.inertia.clone().map_or([Formula::ZERO; 6], |inertia| inertia.value);
        match &self.origin {
            Some(origin) => rotate_inertia(&origin.rotation, &inertia),
            None => inertia,
        }
    }
}

/// A joint; fields are `None` if not described.
#[derive(Debug, Clone)]
pub(crate) struct JointDescription {
    pub name: Name,
    pub kind: Option<JointKind>,
    pub parent: Option<Name>,
    pub child: Option<Name>,
    pub origin: Option<Pose>,
    /// Fields of the base description that this file does not override.
    pub unsaid: Unsaid,
    /// Pose of the child link's described frame in the frame that moves with the joint (standard DH).
    pub link_frame: Option<Pose>,
    pub axis: Option<[f64; 3]>,
    pub held: Option<f64>,
    /// Whether the motion is prescribed; `None` if not described.
    pub driven: Option<At<bool>>,
    pub limits: LimitsDescription,
    pub springs: Option<At<Vec<Formula>>>,
    pub friction: Option<At<FrictionDescription>>,
    pub drive: Option<At<DriveChoice>>,
    /// The joints that this one follows.
    pub follows: Option<At<Vec<FollowsDescription>>>,
    /// Position when the followed joints are at 0.
    pub offset: Option<At<f64>>,
    /// The spherical or floating joint whose velocity this is.
    pub part_of: Option<PartOf>,
    /// Whether this is a part of a joint with several degrees of freedom, but not the last. Its link is not
    /// described.
    pub leads_on: bool,
}

/// Position of a velocity within a joint with a quaternion.
#[derive(Debug, Clone)]
pub(crate) struct PartOf {
    pub joint: Name,
    pub kind: QuaternionKind,
    /// Index among the velocities of the joint.
    pub index: usize,
}

/// A joint followed by another joint or a drive.
#[derive(Debug, Clone)]
pub(crate) struct FollowsDescription {
    pub joint: Name,
    pub ratio: At<Formula>,
}

/// A drive under `[[drives]]`.
#[derive(Debug, Clone)]
pub(crate) struct SharedDriveDescription {
    pub name: Name,
    /// Joints with weights; the gear converts their weighted sum to the motor's angle.
    pub on: Vec<FollowsDescription>,
    pub motor: DriveDescription,
}

impl JointDescription {
    /// A joint with only a name.
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

    /// Whether the joint moves.
    pub fn moves(&self) -> bool {
        self.held.is_none() && self.kind.is_some_and(|kind| kind != JointKind::Fixed)
    }

    /// Whether the joint moves with others.
    pub fn is_follower(&self) -> bool {
        self.moves() && self.follows.is_some()
    }

    /// Whether the joint is a coordinate.
    pub fn is_coordinate(&self) -> bool {
        self.moves() && self.follows.is_none() && !self.is_driven()
    }

    /// Whether the joint is a coordinate whose motion is prescribed.
    pub fn is_driven(&self) -> bool {
        self.moves() && self.follows.is_none() && self.driven.as_ref().is_some_and(|driven| driven.value)
    }

    /// Sets the defaults of a new joint: it is revolute and moves a link of the same name.
    pub fn complete(&mut self) {
        self.kind.get_or_insert(JointKind::Revolute);
        self.child.get_or_insert_with(|| self.name.clone());
    }
}

/// Friction of a joint.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrictionDescription {
    /// Friction as a function of velocity and position.
    pub terms: Vec<FrictionTerm>,
    /// Friction per unit of load.
    pub load: Option<At<Vec<FrictionTerm>>>,
}

impl FrictionDescription {
    /// Whether there is no friction.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty() && self.load.is_none()
    }
}

/// Limits with their places in the file.
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
    /// Limits of magnitudes and their names.
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

/// Drive of a joint.
#[derive(Debug, Clone, Default)]
pub(crate) enum DriveChoice {
    /// No drive.
    #[default]
    Passive,
    /// A torque or force at the joint, without rotor.
    Ideal,
    /// A described motor.
    Motor(Box<DriveDescription>),
}

/// A described motor.
#[derive(Debug, Clone)]
pub(crate) struct DriveDescription {
    pub name: Option<Name>,
    pub gear_ratio: At<Formula>,
    pub rotor_inertia: At<Formula>,
    pub carrier: Option<Name>,
    pub axis: Option<[f64; 3]>,
    pub coupling: RotorCoupling,
    pub input: Input,
    /// Place of the motor constant, or else of the motor.
    pub input_span: Span,
    pub torque: MotorTorque,
    /// Highest speed of the shaft (rad/s).
    pub speed: Option<At<f64>>,
    /// Torque–speed line: stall torque and no-load speed.
    pub line: Option<At<TorqueSpeedLine>>,
    /// Friction of the shaft as a function of the motor's angle and speed.
    pub friction: Option<At<Vec<FrictionTerm>>>,
}

impl DriveDescription {
    /// An ideal drive at a joint; its rotor adds a reflected inertia to the diagonal of M.
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

/// A rotor of a URDF with its possible joints and gear ratios.
#[derive(Debug, Clone)]
pub(crate) struct SkippedRotor {
    /// Inertia about the rotor's axis, on the rotor's side of the gear (kg m²).
    pub inertia: At<f64>,
    pub joints: Vec<String>,
    pub ratios: Vec<f64>,
}

impl SkippedRotor {
    /// Joint of the rotor and reflected inertia on the diagonal of M; `None` if not unique.
    pub fn place(&self) -> Option<(&str, f64)> {
        match (&self.joints[..], &self.ratios[..]) {
            ([joint], [ratio]) => Some((joint, ratio * ratio * self.inertia.value)),
            _ => None,
        }
    }
}

/// A force between the origins of two frames; positive forces pull together.
#[derive(Debug, Clone)]
pub(crate) struct PointForceDescription {
    pub name: Name,
    /// Two frames or links.
    pub between: [Name; 2],
    /// Force law in the distance and its rate.
    pub law: Option<At<Formula>>,
    pub input: Option<PullDescription>,
    /// Shortest and longest distance (m).
    pub stroke: Option<At<[f64; 2]>>,
    /// Highest rate of the distance (m/s).
    pub speed: Option<At<f64>>,
}

/// An input that pulls two frames together.
#[derive(Debug, Clone)]
pub(crate) struct PullDescription {
    pub name: Name,
    pub limits: Option<At<[f64; 2]>>,
}

/// An input that is a wrench fixed in a frame.
#[derive(Debug, Clone)]
pub(crate) struct WrenchInputDescription {
    pub name: Name,
    /// Frame or link of the wrench.
    pub frame: Name,
    /// Force, and moment about the frame's origin, per unit of the input.
    pub wrench: At<[Formula; 6]>,
    pub limits: Option<At<[f64; 2]>>,
}

/// A wrench that is an argument of functions.
#[derive(Debug, Clone)]
pub(crate) struct WrenchDescription {
    pub name: Name,
    /// Frame or link of the wrench.
    pub frame: Name,
    pub axes: WrenchAxes,
}

/// A named frame.
#[derive(Debug, Clone)]
pub(crate) struct FrameDescription {
    pub name: Name,
    pub link: Name,
    pub pose: Pose,
    /// Whether the frame is a site of an MJCF; sites and bodies may have equal names.
    pub is_site: bool,
}
