//! Data of the robot for the 3-D view: poses, axes, masses and limits.

use serde_json::{Value, json};

/// Data of a robot for the 3-D view. Lengths are in m, masses in kg, angles in rad.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Name of the robot.
    pub name: String,
    /// Name of the base link.
    pub base: String,
    /// Gravitational acceleration in the base frame (m/s²).
    pub gravity: [f64; 3],
    /// Joints with the links that they carry. A parent precedes its children.
    pub joints: Vec<SceneJoint>,
    /// Symbols of the coordinates in order.
    pub symbols: Vec<SceneSymbol>,
    /// Bodies on the links.
    pub bodies: Vec<SceneBody>,
    /// Named frames.
    pub frames: Vec<SceneFrame>,
    /// Springs and cylinders, which act between two points.
    pub rods: Vec<SceneRod>,
}

/// Symbol of a coordinate; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SceneSymbol {
    /// Position with this index, written yᵢ.
    Position(usize),
    /// Velocity with this index, written ẏᵢ, of a joint with a quaternion. No position entry corresponds to
    /// this velocity.
    Velocity(usize),
    /// Position with this index, written dᵢ, of a driven joint, whose motion is prescribed.
    Driven(usize),
}

impl SceneSymbol {
    /// Letter of the symbol, and its index from 1.
    pub(super) fn letter(self) -> (char, usize) {
        match self {
            Self::Position(index) => ('y', index + 1),
            Self::Velocity(index) => ('ẏ', index + 1),
            Self::Driven(index) => ('d', index + 1),
        }
    }
}

/// A spring or cylinder, whose force acts between two points. It is drawn as a line.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneRod {
    /// The two end points. Each has the index of the joint that carries the link of the point (`None` for the base), and the
    /// point in the frame of this link (m).
    pub ends: [(Option<usize>, [f64; 3]); 2],
    /// Whether the force is an input, for example the force of a cylinder.
    pub is_input: bool,
}

/// A joint together with the link that it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneJoint {
    /// Name of the joint.
    pub name: String,
    /// Name of the link that the joint carries.
    pub link: String,
    /// Index of the joint whose link carries this joint; `None` if the base carries it.
    pub parent: Option<usize>,
    /// Origin of the joint in the frame of the parent link (m).
    pub translation: [f64; 3],
    /// Rotation matrix of the joint frame in the frame of the parent link, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Unit vector along the axis, in the joint frame.
    pub axis: [f64; 3],
    /// Type of the motion along the axis.
    pub kind: SceneKind,
    /// Motion of the joint in the view.
    pub motion: SceneMotion,
    /// Lowest and highest position (rad or m); `None` for a joint without limits.
    pub limits: Option<[f64; 2]>,
    /// Name of the input of the joint; `None` for a joint without input.
    pub input: Option<String>,
}

/// Type of the motion of a joint along its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SceneKind {
    /// Rotation about the axis.
    Turns,
    /// Translation along the axis.
    Slides,
    /// Rotation about the axis with a proportional translation along the axis (screw motion).
    Screws {
        /// Translation per angle (m/rad).
        pitch: f64,
    },
}

/// Motion of a joint in the view.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneMotion {
    /// The joint is fixed.
    Fixed,
    /// The joint is held at this position (rad or m).
    Held(f64),
    /// The joint is independent. The value is the index of its coordinate, counted from 0.
    Coordinate(usize),
    /// The joint follows coordinates, with the position `Σ ratio · y[coordinate] + offset`.
    Follows {
        /// Index (counted from 0) and ratio of each followed coordinate.
        terms: Vec<(usize, f64)>,
        /// Position if all followed coordinates are 0 (rad or m).
        offset: f64,
    },
}

/// A body on a link. It is drawn as a disc at its centre of mass.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneBody {
    /// Name of the body.
    pub name: String,
    /// Index of the joint that carries the link of the body; `None` for the base.
    pub joint: Option<usize>,
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass in the frame of the link (m).
    pub center: [f64; 3],
}

/// A named frame on a link.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFrame {
    /// Name of the frame.
    pub name: String,
    /// Index of the joint that carries the link of the frame; `None` for the base.
    pub joint: Option<usize>,
    /// Origin in the frame of the link (m).
    pub translation: [f64; 3],
    /// Rotation matrix in the frame of the link, row by row.
    pub rotation: [[f64; 3]; 3],
}

/// Largest angle on the slider of a revolute joint without limits, in both directions (rad).
const TURN: f64 = std::f64::consts::PI;
/// Largest displacement on the slider of a prismatic joint without limits, in both directions (m).
const SLIDE: f64 = 0.5;

impl SceneJoint {
    /// Unit of the position, `rad` or `m`.
    pub(super) fn unit(&self) -> &'static str {
        if self.kind == SceneKind::Slides { "m" } else { "rad" }
    }

    /// Range of the slider of the joint.
    pub(super) fn range(&self) -> [f64; 2] {
        let free = if self.kind == SceneKind::Slides { SLIDE } else { TURN };
        match self.limits {
            Some([low, high]) if low.is_finite() && high.is_finite() && low < high => [low, high],
            _ => [-free, free],
        }
    }

    /// Initial value of the slider, which is the value within its range that is closest to 0.
    pub(super) fn start(&self) -> f64 {
        let [low, high] = self.range();
        0.0_f64.clamp(low, high)
    }
}

impl Scene {
    /// Independent joints in the order of their coordinates.
    pub(super) fn coordinates(&self) -> Vec<&SceneJoint> {
        let mut moving: Vec<(usize, &SceneJoint)> = self
            .joints
            .iter()
            .filter_map(|joint| match joint.motion {
                SceneMotion::Coordinate(index) => Some((index, joint)),
                _ => None,
            })
            .collect();
        moving.sort_by_key(|(index, _)| *index);
        moving.into_iter().map(|(_, joint)| joint).collect()
    }

    /// Symbol of a coordinate. The default is its position.
    pub(super) fn symbol(&self, coordinate: usize) -> SceneSymbol {
        self.symbols.get(coordinate).copied().unwrap_or(SceneSymbol::Position(coordinate))
    }

    /// The scene as JSON for the script of the page.
    pub(super) fn json(&self) -> Value {
        let joint = |joint: &SceneJoint| {
            let (terms, position) = match &joint.motion {
                SceneMotion::Fixed => (vec![], 0.0),
                SceneMotion::Held(position) => (vec![], *position),
                SceneMotion::Coordinate(index) => (vec![(*index, 1.0)], 0.0),
                SceneMotion::Follows { terms, offset } => (terms.clone(), *offset),
            };
            let coordinate = match joint.motion {
                SceneMotion::Coordinate(index) => Some(index),
                _ => None,
            };
            let (turn, slide) = match joint.kind {
                SceneKind::Turns => (1.0, 0.0),
                SceneKind::Slides => (0.0, 1.0),
                SceneKind::Screws { pitch } => (1.0, pitch),
            };
            json!({
                "name": joint.name,
                "parent": joint.parent,
                "translation": joint.translation,
                "rotation": joint.rotation,
                "axis": joint.axis,
                "turn": turn,
                "slide": slide,
                "moves": joint.motion != SceneMotion::Fixed,
                "coordinate": coordinate,
                "terms": terms,
                "position": position,
            })
        };
        let body =
            |body: &SceneBody| json!({ "joint": body.joint, "mass": body.mass, "center": body.center });
        let frame = |frame: &SceneFrame| {
            json!({
                "name": frame.name,
                "joint": frame.joint,
                "translation": frame.translation,
                "rotation": frame.rotation,
            })
        };
        let rod = |rod: &SceneRod| {
            let end = |(joint, point): &(Option<usize>, [f64; 3])| json!({ "joint": joint, "point": point });
            json!({ "ends": rod.ends.each_ref().map(end), "input": rod.is_input })
        };
        json!({
            "gravity": self.gravity,
            "joints": self.joints.iter().map(joint).collect::<Value>(),
            "bodies": self.bodies.iter().map(body).collect::<Value>(),
            "frames": self.frames.iter().map(frame).collect::<Value>(),
            "rods": self.rods.iter().map(rod).collect::<Value>(),
        })
    }
}
