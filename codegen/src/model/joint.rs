//! Joints: types, limits, friction, and coordinates that they follow.

use super::Pose;
use gelenk_formula::{Formula, FrictionTerm, Function};

/// A joint that follows coordinates: its position is `Σ ratio · y[coordinate] + offset` with the coordinates y.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// Index of the link that the joint carries.
    pub link: usize,
    /// Followed coordinates, each once.
    pub follows: Vec<FollowedCoordinate>,
    /// Position of the joint if all followed coordinates are 0 (rad or m).
    pub offset: f64,
}

/// A coordinate that a joint or a drive follows.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedCoordinate {
    /// Index of the followed coordinate.
    pub coordinate: usize,
    /// Motion of the joint or drive per unit of the coordinate's motion. It depends only on parameters.
    pub ratio: Formula,
}

impl FollowedCoordinate {
    /// The only term of an independent joint: its own coordinate, with the ratio 1.
    #[must_use]
    pub fn itself(coordinate: usize) -> Self {
        Self { coordinate, ratio: Formula::ONE }
    }
}

/// A moving joint, with its ratios to the coordinates y. Its position is the sum of ratio times coordinate,
/// plus an offset.
#[derive(Debug, Clone)]
pub struct MovingJoint<'m> {
    /// The joint with its type, axis and limits.
    pub joint: &'m Joint,
    /// Index of the link that the joint carries.
    pub link: usize,
    /// Coordinates of the joint: its own coordinate, or the coordinates that it follows.
    pub follows: Vec<FollowedCoordinate>,
    /// Position of the joint if all these coordinates are 0 (rad or m).
    pub offset: f64,
}

/// A joint between a parent link and the link that the joint carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name of the joint exactly as in the description.
    pub name: String,
    /// Name of the joint as a Rust identifier, distinct among the joints. Values in generated functions have
    /// this name.
    pub identifier: String,
    /// Index of the link before the joint.
    pub parent: usize,
    /// Type of the joint, for example revolute.
    pub kind: JointKind,
    /// Pose of the joint frame in the parent link's frame. At position 0 the joint frame is the frame of the
    /// carried link.
    pub origin: Pose,
    /// Axis of the joint in the joint frame, with unit length.
    pub axis: [f64; 3],
    /// Motion of the joint: fixed, held, by its own coordinate, or following coordinates.
    pub motion: Motion,
    /// Limits on position, speed and force.
    pub limits: Limits,
    /// Forces of springs and dampers on this joint as functions of position y and velocity v (N m or N). They
    /// are added to the joint's generalized force.
    pub springs: Vec<Formula>,
    /// Terms of the friction torque (or force) τ = Σ coefficient · basis, functions of the velocity v and
    /// possibly of the position y. τ is positive at positive velocity. It is subtracted from the joint's
    /// generalized force.
    pub friction: Vec<FrictionTerm>,
    /// Terms of the load-dependent friction: s₁ = Σ coefficient · basis is the friction per unit of the load
    /// τ_l. The load is the drive's force without friction. The friction |τ_l| s₁ is added to `friction`. The
    /// list is empty without load-dependent friction. Otherwise the joint has its own input, and |s₁| < 1.
    pub load_friction: Vec<FrictionTerm>,
}

/// Half the range of random positions for a rotating joint without limits: half a turn to each side \[rad\].
const TURN: f64 = std::f64::consts::PI;
const SLIDE: f64 = 0.5;

/// Largest magnitude of random positions (rad or m). Limits of ±1e9 m mean that a limit is missing, and
/// positions within such limits would only add rounding errors.
const FARTHEST: f64 = 20.0;

impl Joint {
    /// Whether the friction or a spring law contains an exact `sign` and is therefore discontinuous.
    #[must_use]
    pub fn jumps(&self) -> bool {
        let friction = self.friction.iter().chain(&self.load_friction);
        let friction = friction.filter(|term| !term.coefficient.is_zero());
        let mut laws = friction.map(|term| &term.basis).chain(&self.springs);
        laws.any(|law| law.calls(Function::Sign))
    }

    /// Range of positions for pseudo-random states, within the position limits.
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

/// Type of a joint, for example revolute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// The joint does not move.
    Fixed,
    /// Rotation about the joint's axis.
    Revolute,
    /// Rotation about the joint's axis without position limits.
    Continuous,
    /// Translation along the joint's axis.
    Prismatic,
    /// Rotation about the joint's axis by the position, and translation along it by pitch · position.
    Helical {
        /// Translation per radian (m/rad). The pitch is finite and non-zero, and negative for a left-handed
        /// screw.
        pitch: f64,
    },
}

impl JointKind {
    /// Unit of the joint's position: `rad` or `m`.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Prismatic => "m",
            Self::Fixed | Self::Revolute | Self::Continuous | Self::Helical { .. } => "rad",
        }
    }

    /// Unit of the force or torque on the joint: `N m` or `N`.
    #[must_use]
    pub fn effort_unit(self) -> &'static str {
        match self {
            Self::Prismatic => "N",
            Self::Fixed | Self::Revolute | Self::Continuous | Self::Helical { .. } => "N m",
        }
    }

    /// Rotation about the axis (rad) and translation along it (m) per unit of the position.
    #[must_use]
    pub fn turn_and_slide(self) -> [f64; 2] {
        match self {
            Self::Fixed => [0.0, 0.0],
            Self::Revolute | Self::Continuous => [1.0, 0.0],
            Self::Prismatic => [0.0, 1.0],
            Self::Helical { pitch } => [1.0, pitch],
        }
    }

    /// Name of the joint type in descriptions, for example `revolute`.
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

/// Motion of a joint: fixed, held, by its own coordinate, or following coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// The joint is fixed, without a position.
    Fixed,
    /// The joint is held at this position (rad or m).
    Held(f64),
    /// The joint has a coordinate with this index, because it is independent or driven (with prescribed
    /// motion). Coordinates of driven joints have the largest indices.
    Coordinate(usize),
    /// The joint follows coordinates. The field is its index among the moving joints. All coordinates,
    /// including those with prescribed motion, have smaller indices.
    Follower(usize),
}

/// Limits of a joint. A field is `None` if the description has no such limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Lowest and highest position of the joint (rad or m).
    pub position: Option<[f64; 2]>,
    /// Highest speed of the joint (rad/s or m/s).
    pub velocity: Option<f64>,
    /// Limit of the continuous (nominal) force at the joint (N m or N).
    pub effort: Option<f64>,
    /// Limit of the short-time (peak) force at the joint (N m or N).
    pub peak_effort: Option<f64>,
    /// Highest acceleration of the joint (rad/s² or m/s²).
    pub acceleration: Option<f64>,
    /// Highest jerk of the joint (rad/s³ or m/s³).
    pub jerk: Option<f64>,
}
