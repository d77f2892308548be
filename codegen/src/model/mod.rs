//! Stage 1: a robot description becomes a validated [`Model`].
//!
//! A `Model` that exists is correct: names are distinct, and so are their Rust identifiers; the links form
//! one tree whose parents stand before their children, axes have unit length, limits are ordered, numbers are
//! finite. Later stages need no checks.

mod angles;
mod composite;
mod description;
mod description_files;
mod distances;
mod file_kind;
mod floating_base;
mod inertia;
mod load;
mod mjcf;
mod name;
mod options;
mod pose;
mod quaternion_joint;
mod read;
mod regularity;
mod table;
mod toml_couplings;
mod toml_file;
mod toml_forces;
mod toml_frame_forces;
mod toml_joints;
mod toml_values;
mod tree;
mod urdf;
mod urdf_limits;
mod urdf_notes;
mod urdf_text;
mod validate;
mod xacro;

pub use angles::{NEARLY_RIGHT, NEARLY_RIGHT_ANGLE};
pub use description_files::{DescriptionFiles, read};
pub(crate) use inertia::principal_axes;
pub use load::Load;
pub(crate) use name::identifier;
pub use options::{FUNCTIONS, is_known_function};
pub use quaternion_joint::{CarryingJoint, JointPosition, QuaternionJoint, QuaternionKind};
pub use read::{Loaded, ReadOptions, from_mjcf, from_toml, from_urdf};

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::formula::Formula;

/// A robot: one tree of links, its drives, force laws and named frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Name of the generated module; a Rust identifier in snake case.
    pub name: String,
    /// Free text of the author, one line per entry; shown escaped in documentation.
    pub description: Vec<String>,
    /// Gravitational acceleration in the base frame (m/s²).
    pub gravity: [Formula; 3],
    /// Free parameters, in the order of their description.
    pub parameters: Vec<Parameter>,
    /// All links; `links[0]` is the base, every parent stands before its children.
    pub links: Vec<Link>,
    /// Link indices of the moving joints, in the order of the coordinates: coordinate `i` moves
    /// `links[coordinates[i]]`.
    pub coordinates: Vec<usize>,
    /// Link indices of the driven joints, whose motion is prescribed. They stand behind the coordinates where all
    /// that moves is counted: driven joint `k` is `Motion::Coordinate(coordinates.len() + k)`.
    pub driven: Vec<usize>,
    /// The spherical and floating joints, in the order of their coordinates: each stands for several of them.
    pub quaternion_joints: Vec<QuaternionJoint>,
    /// The joints that follow coordinates. They come after those of the coordinates in the order of the
    /// moving joints.
    pub followers: Vec<Follower>,
    /// The inputs u in their order.
    pub drives: Vec<Drive>,
    /// Forces between two frames.
    pub point_forces: Vec<PointForce>,
    /// The inputs that are forces at frames; they come after those of the drives.
    pub force_inputs: Vec<ForceInput>,
    /// Wrenches that are arguments of functions.
    pub wrenches: Vec<Wrench>,
    /// Named frames.
    pub frames: Vec<Frame>,
    /// Options that the description sets for the generator.
    pub options: Options,
}

/// A free parameter: a field of the generated `Parameters`.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// A Rust identifier.
    pub name: String,
    /// The described value.
    pub default: f64,
    /// Unit as text, empty where unknown.
    pub unit: String,
    /// One line of meaning, may be empty.
    pub description: String,
}

/// A joint that follows coordinates: `y_joint = Σ ratio · y[coordinate] + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// Link that the joint carries.
    pub link: usize,
    /// The coordinates that it follows, each once.
    pub follows: Vec<FollowedCoordinate>,
    /// Its position where all of them are 0 (rad or m).
    pub offset: f64,
}

/// A coordinate that a joint or a drive follows.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedCoordinate {
    /// The coordinate.
    pub coordinate: usize,
    /// Motion for a unit of the coordinate's motion; depends on parameters only.
    pub ratio: Formula,
}

impl FollowedCoordinate {
    /// A coordinate itself.
    #[must_use]
    pub fn itself(coordinate: usize) -> Self {
        Self { coordinate, ratio: Formula::ONE }
    }
}

/// A joint that moves, with its row of G in `y_joint = G y + g₀`.
#[derive(Debug, Clone)]
pub struct MovingJoint<'m> {
    /// The joint.
    pub joint: &'m Joint,
    /// Link that it carries.
    pub link: usize,
    /// The coordinates that it follows: its own, or those of others.
    pub follows: Vec<FollowedCoordinate>,
    /// Its position where all of them are 0 (rad or m).
    pub offset: f64,
}

/// A link and the joint that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name in the description.
    pub name: String,
    /// The joint to the parent; `None` for the base alone.
    pub joint: Option<Joint>,
    /// Rigid bodies fixed to this link; lumped by the kinematics stage.
    pub bodies: Vec<Body>,
}

/// A rigid body fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in the description.
    pub name: String,
    /// Mass (kg).
    pub mass: Formula,
    /// Centre of mass in the link's frame (m).
    pub center_of_mass: [Formula; 3],
    /// Inertia about the centre of mass, axes of the link's frame: xx, xy, xz, yy, yz, zz (kg m²).
    pub inertia: [Formula; 6],
}

/// A joint between a parent link and the link that carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name in the description, to the letter.
    pub name: String,
    /// The name as a Rust identifier, distinct among the joints: it labels values in generated functions.
    pub identifier: String,
    /// Index of the parent link.
    pub parent: usize,
    /// The kind of motion that the joint allows.
    pub kind: JointKind,
    /// Pose of the joint frame in the parent link's frame; the link's frame coincides with it at position 0.
    pub origin: Pose,
    /// Axis in the joint frame, unit length.
    pub axis: [f64; 3],
    /// The coordinate that the joint moves with, if it moves.
    pub motion: Motion,
    /// Limits on position, speed and force.
    pub limits: Limits,
    /// Forces of springs and dampers on this joint as functions of y and v (N m or N); they add to q.
    pub springs: Vec<Formula>,
    /// Friction torque τ(v) = Σ coefficient · basis, positive for positive velocity; it is subtracted from q.
    pub friction: Vec<FrictionTerm>,
    /// Friction s₁(v) = Σ coefficient · basis for each unit of the load τ_l: the joint feels |τ_l| s₁ beside
    /// the friction above. Empty where friction does not grow with the load; else the joint has an input of
    /// its own, and |s₁| < 1.
    pub load_friction: Vec<FrictionTerm>,
}

/// Signs of the eigenvalues of a mass matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Definiteness {
    /// All are positive.
    Positive,
    /// Some are zero: joints move nothing that has inertia.
    Semidefinite,
    /// Some are negative: bodies are none that there can be.
    Indefinite,
}

/// Positions of a joint without limits, for seeded states: a turn to each side, or half a metre.
const TURN: f64 = std::f64::consts::PI;
const SLIDE: f64 = 0.5;

/// Farther positions add nothing but rounding: limits of ±1e9 m stand for none.
const FARTHEST: f64 = 20.0;

impl Joint {
    /// Tells whether friction or a spring jumps, because it has an exact `sign`.
    #[must_use]
    pub fn jumps(&self) -> bool {
        let friction = self.friction.iter().chain(&self.load_friction);
        let friction = friction.filter(|term| !term.coefficient.is_zero());
        let mut laws = friction.map(|term| &term.basis).chain(&self.springs);
        laws.any(|law| law.calls(crate::formula::Function::Sign))
    }

    /// Range of positions for seeded states: within the limits, where there are some.
    pub(crate) fn seeded_range(&self) -> [f64; 2] {
        let free = match self.kind {
            JointKind::Prismatic => SLIDE,
            _ => TURN,
        };
        match self.limits.position {
            None => [-free, free],
            Some([low, high]) if low < FARTHEST && high > -FARTHEST => {
                [low.max(-FARTHEST), high.min(FARTHEST)]
            }
            Some(limits) => limits,
        }
    }
}

impl Model {
    /// The definiteness of M at seeded states, at the described values of free parameters.
    #[must_use]
    pub fn definiteness(&self) -> Definiteness {
        let pivots = regularity::Pivots::of(self);
        match (pivots.negative.is_empty(), pivots.zero.is_empty()) {
            (false, _) => Definiteness::Indefinite,
            (true, false) => Definiteness::Semidefinite,
            (true, true) => Definiteness::Positive,
        }
    }

    /// The joints that move nothing with inertia along their axis, so that M is singular; at the described
    /// values of free parameters.
    #[must_use]
    pub fn joints_without_inertia(&self) -> Vec<&Joint> {
        self.joints_of(&regularity::Pivots::of(self).zero)
    }

    /// For each coordinate the smallest pivot of M at seeded states.
    pub(crate) fn least_pivots(&self) -> Vec<f64> {
        let least = regularity::Pivots::of(self).least;
        let pivots = self.coordinates.iter();
        pivots.filter_map(|&link| least.get(link).copied()).collect()
    }

    /// The moving joints in the order of the coordinates.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = &Joint> {
        self.coordinates.iter().map(|&link| self.joint_of(link))
    }

    /// Tells whether a joint follows others, or a drive acts on several coordinates.
    #[must_use]
    pub fn is_coupled(&self) -> bool {
        !self.followers.is_empty() || self.moving_drives().any(|drive| drive.coordinate().is_none())
    }

    /// Number of coordinates, driven ones included.
    #[must_use]
    pub fn motion_count(&self) -> usize {
        self.coordinates.len() + self.driven.len()
    }

    /// The driven joints in their order.
    pub fn driven_joints(&self) -> impl ExactSizeIterator<Item = &Joint> {
        self.driven.iter().map(|&link| self.joint_of(link))
    }

    /// The error of what is not offered where joints are driven; none where no joint is.
    pub(crate) fn refuse_driven(&self, what: &str, help: &str) -> Result<(), Diagnostics> {
        let Some(joint) = self.driven_joints().next() else { return Ok(()) };
        let message = format!("{what} where joints are driven, as `{}` is", joint.name);
        Err(Diagnostic::error("driven-joint", message).help(help).into())
    }

    fn joint_of(&self, link: usize) -> &Joint {
        let joint = self.links.get(link).and_then(|link| link.joint.as_ref());
        joint.unwrap_or_else(|| unreachable!("validation gives every moving link its joint"))
    }

    /// The link that a coordinate moves, a driven one included.
    #[must_use]
    pub fn link_of(&self, coordinate: usize) -> Option<usize> {
        self.coordinates.iter().chain(&self.driven).nth(coordinate).copied()
    }

    /// All joints that move: those of the coordinates in their order, the driven ones, then those that follow them.
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

    /// The inputs: the drives that move coordinates, then the forces at frames.
    pub fn inputs(&self) -> impl Iterator<Item = Actuator<'_>> {
        self.input_drives().map(Actuator::Drive).chain(self.force_inputs.iter().map(Actuator::Force))
    }

    /// The drives that move coordinates, in the order of the inputs.
    pub fn input_drives(&self) -> impl Iterator<Item = &Drive> {
        let drives = self.drives.iter();
        drives.filter(|drive| !drive.acts_on.is_empty() && drive.input != Input::None)
    }

    /// The drives whose rotors move with coordinates, with an input or without.
    pub fn moving_drives(&self) -> impl Iterator<Item = &Drive> {
        self.drives.iter().filter(|drive| !drive.acts_on.is_empty())
    }

    /// The drives whose shafts have friction of their own.
    pub fn rubbing_drives(&self) -> impl Iterator<Item = &Drive> {
        self.drives.iter().filter(|drive| !drive.friction.is_empty())
    }

    /// Tells whether B depends on the coordinates.
    #[must_use]
    pub fn inputs_depend_on_position(&self) -> bool {
        !self.force_inputs.is_empty()
    }

    /// Unit of an input: that of a motor's torque or current; a drive without gear on a prismatic joint is a
    /// force.
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

    /// The joints of these links.
    fn joints_of(&self, links: &[usize]) -> Vec<&Joint> {
        let joints = links.iter().filter_map(|&link| self.links.get(link)?.joint.as_ref());
        joints.collect()
    }
}

/// Type of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// No motion.
    Fixed,
    /// Rotation about the axis.
    Revolute,
    /// Rotation about the axis without position limits.
    Continuous,
    /// Translation along the axis.
    Prismatic,
    /// Rotation about the axis by the position, and translation along it by pitch · position.
    Helical {
        /// Translation for each radian (m/rad): finite, not 0, negative for a left-handed screw.
        pitch: f64,
    },
}

impl JointKind {
    /// Unit of the coordinate.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Prismatic => "m",
            Self::Fixed | Self::Revolute | Self::Continuous | Self::Helical { .. } => "rad",
        }
    }

    /// Rotation about the axis (rad) and translation along it (m) for a unit of the position.
    #[must_use]
    pub fn turn_and_slide(self) -> [f64; 2] {
        match self {
            Self::Fixed => [0.0, 0.0],
            Self::Revolute | Self::Continuous => [1.0, 0.0],
            Self::Prismatic => [0.0, 1.0],
            Self::Helical { pitch } => [1.0, pitch],
        }
    }

    /// The type as the format calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Helical { .. } => "helical",
        }
    }
}

/// The way in which a joint moves, or does not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// A fixed joint.
    Fixed,
    /// Held at this position (rad or m).
    Held(f64),
    /// Coordinate with this index; the indices of driven ones come after those of the others.
    Coordinate(usize),
    /// It follows coordinates; the index is that among the moving joints, and so not below the number of
    /// coordinates, driven ones included.
    Follower(usize),
}

/// Limits of a joint; `None` where the description gives none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Lowest and highest position (rad or m).
    pub position: Option<[f64; 2]>,
    /// Highest speed (rad/s or m/s).
    pub velocity: Option<f64>,
    /// Nominal force at the joint (N m or N).
    pub effort: Option<f64>,
    /// Peak force at the joint (N m or N).
    pub peak_effort: Option<f64>,
}

/// One term of a friction law, linear in its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionTerm {
    /// Factor; depends on parameters only.
    pub coefficient: Formula,
    /// Function of the joint's velocity `v` (and position `y` where described so).
    pub basis: Formula,
}

/// A drive: one input, acting on one coordinate or on the sum of several.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Name in the description, to the letter; that of the joint where the drive has none of its own.
    pub name: String,
    /// The name as a Rust identifier, distinct among the drives.
    pub identifier: String,
    /// The coordinates whose weighted sum its gear turns into the motor's angle; empty where its joint is held:
    /// no input then, but its rotor stays on the carrier.
    pub acts_on: Vec<FollowedCoordinate>,
    /// Gear ratio i: motor angle over that sum.
    pub gear_ratio: Formula,
    /// Axial inertia J_R of the rotor (kg m²).
    pub rotor_inertia: Formula,
    /// Link that carries the rotor.
    pub carrier: usize,
    /// Rotor axis in the carrier link's frame, unit length.
    pub axis: [f64; 3],
    /// How the rotor enters M.
    pub coupling: RotorCoupling,
    /// The kind of the input.
    pub input: Input,
    /// Limits of the input's torque at the motor (N m).
    pub torque: MotorTorque,
    /// Friction of the shaft over its angle `y` and speed `v`, where the drive acts on several coordinates; that of a
    /// drive on one coordinate is part of its joint's.
    pub friction: Vec<FrictionTerm>,
}

impl Drive {
    /// Tells whether friction of its shaft jumps.
    #[must_use]
    pub fn jumps(&self) -> bool {
        let mut terms = self.friction.iter().filter(|term| !term.coefficient.is_zero());
        terms.any(|term| term.basis.calls(crate::formula::Function::Sign))
    }

    /// The coordinate that it moves, where it moves that one alone.
    #[must_use]
    pub fn coordinate(&self) -> Option<usize> {
        match &self.acts_on[..] {
            [only] if only.ratio == Formula::ONE => Some(only.coordinate),
            _ => None,
        }
    }
}

/// Nominal and peak torque of a motor (N m), `None` where not described.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotorTorque {
    /// The torque that the motor bears continuously.
    pub nominal: Option<f64>,
    /// The torque that the motor bears for a short time.
    pub peak: Option<f64>,
}

/// How the rotor enters the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotorCoupling {
    /// A body carried by its link: diagonal i² J_R and the coupling terms.
    Body,
    /// Only i² J_R on the diagonal.
    Diagonal,
}

/// The kind of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// Motor torque (N m); the input matrix holds the gear ratio.
    Torque,
    /// None: a rotor that moves with joints by itself, or friction of a transmission.
    None,
    /// Motor current (A); the input matrix holds gear ratio times motor constant K_M (N m/A).
    Current(Formula),
}

/// Where a force acts: a frame fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// Name of the frame or link in the description.
    pub name: String,
    /// Link that carries it.
    pub link: usize,
    /// Its pose in that link's frame.
    pub pose: Pose,
}

/// A force between the origins of two frames, as of a spring.
#[derive(Debug, Clone, PartialEq)]
pub struct PointForce {
    /// Name in the description, or the names of the two frames.
    pub name: String,
    /// The frames.
    pub between: [Attachment; 2],
    /// The force (N), positive where it pulls together, over the distance of the origins (m) as position and its
    /// rate (m/s) as velocity.
    pub law: Formula,
}

/// An input that is a force at frames.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceInput {
    /// Name in the description.
    pub name: String,
    /// Lowest and highest value; `None` where not described.
    pub limits: Option<[f64; 2]>,
    /// What a unit of the input does.
    pub effect: ForceEffect,
}

impl ForceInput {
    /// N where a unit of the input makes a force, else N m.
    fn unit(&self) -> &'static str {
        match &self.effect {
            ForceEffect::Wrench { wrench, .. } if wrench[..3].iter().all(Formula::is_zero) => "N m",
            ForceEffect::Wrench { .. } | ForceEffect::Pull(_) => "N",
        }
    }
}

/// What a unit of an input does.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceEffect {
    /// A wrench, fixed in a frame: force (N), then moment about its origin (N m).
    Wrench {
        /// The frame.
        at: Attachment,
        /// Force and moment for a unit of the input.
        wrench: [Formula; 6],
    },
    /// A force (N) that pulls the origins of two frames together.
    Pull([Attachment; 2]),
}

/// A wrench that is an argument of functions: force (N), then moment about its frame's origin (N m).
#[derive(Debug, Clone, PartialEq)]
pub struct Wrench {
    /// Name in the description.
    pub name: String,
    /// The frame.
    pub at: Attachment,
    /// The axes of force and moment.
    pub axes: WrenchAxes,
}

/// Axes in which a wrench is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrenchAxes {
    /// Those of its frame.
    Frame,
    /// Those of the base.
    Base,
}

/// What makes an input act.
#[derive(Debug, Clone, Copy)]
pub enum Actuator<'m> {
    /// A drive of joints.
    Drive(&'m Drive),
    /// A force at frames.
    Force(&'m ForceInput),
}

impl<'m> Actuator<'m> {
    /// Name of the input.
    #[must_use]
    pub fn name(self) -> &'m str {
        match self {
            Self::Drive(drive) => &drive.name,
            Self::Force(force) => &force.name,
        }
    }

    /// The coordinate that it moves, where it moves that one alone.
    #[must_use]
    pub fn coordinate(self) -> Option<usize> {
        match self {
            Self::Drive(drive) => drive.coordinate(),
            Self::Force(_) => None,
        }
    }

    /// The drive, where it is one.
    #[must_use]
    pub fn drive(self) -> Option<&'m Drive> {
        match self {
            Self::Drive(drive) => Some(drive),
            Self::Force(_) => None,
        }
    }
}

/// A named frame fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Name in the description, to the letter.
    pub name: String,
    /// The name as a Rust identifier, distinct among the frames: its functions are `frame_<identifier>_…`.
    pub identifier: String,
    /// Link that carries it.
    pub link: usize,
    /// Its pose in that link's frame.
    pub pose: Pose,
}

/// Position and orientation of a frame in another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Origin (m).
    pub translation: [Formula; 3],
    /// Rotation matrix, rows first; its columns are the frame's axes.
    pub rotation: [[f64; 3]; 3],
}

/// Options that the description sets for the generator.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// Names of the functions to generate; empty means all.
    pub functions: Vec<String>,
    /// Names of the functions that are also written over several states at once.
    pub lanes: Vec<String>,
    /// Replace exact `sign` by a smooth `tanh` of this slope in generated code.
    pub smooth_sign: Option<f64>,
    /// Runge–Kutta steps in one period of the generated `step`; 1 where absent.
    pub substeps: Option<usize>,
}
