//! The moving bodies of a model in modified Denavit–Hartenberg frames.

use nalgebra::Matrix3;

use super::inertia::{MassMoments, RegroupChoice, regroup};
use super::pose::{ScalarPose, rotation_about};
use super::{frames, tree};
use crate::graph::{Graph, Scalar, Vector3};
use crate::model::Model;
use crate::numeric;

/// The moving bodies of a model; body `i` carries one coordinate, parents stand before their children.
#[derive(Debug, Clone)]
pub struct Mechanism<'g> {
    /// The graph of all scalars.
    pub graph: &'g Graph,
    /// Bodies, parents first.
    pub bodies: Vec<Body<'g>>,
    /// Gravitational acceleration in the base frame [m/s²].
    pub gravity: Vector3<'g>,
    /// Rotors that turn relative to the body that carries them.
    pub rotors: Vec<Rotor<'g>>,
    /// Moments of moving mass that acts as if it were fixed to the base, in the base frame.
    pub base_moments: MassMoments<'g>,
    /// For every link of the model: the body that carries it (`None`: the base) and its pose in that body's frame.
    pub links: Vec<(Option<usize>, ScalarPose<'g>)>,
}

/// A moving body in its own frame: z along the joint's axis.
#[derive(Debug, Clone)]
pub struct Body<'g> {
    /// Name of the joint, as described.
    pub name: String,
    /// The joint's identifier, which labels values.
    pub identifier: String,
    /// Coordinate that moves it.
    pub coordinate: usize,
    /// Parent body; `None` where the base carries the joint.
    pub parent: Option<usize>,
    /// Type of the joint.
    pub axis: JointAxis,
    /// Sign of the joint's position relative to the coordinate.
    pub direction: f64,
    /// Rotation from the parent's frame to the joint's frame before its motion.
    pub twist: Twist,
    /// From the parent's origin to the joint's axis, in the parent's frame and unit.
    pub translation: Vector3<'g>,
    /// From there to the origin along the axis, in this body's unit.
    pub lift: Scalar<'g>,
    /// Angle about z where the coordinate is 0.
    pub offset: Angle,
    /// Moments of its mass, in this body's unit of length.
    pub moments: MassMoments<'g>,
    /// Unit of length (m) in which forces, accelerations, masses and the children's translations are expressed.
    pub length_unit: f64,
    /// The parent's unit of length over this one; 1 where the base carries the joint.
    pub unit_ratio: f64,
}

/// Type of a moving joint; z is its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointAxis {
    /// Rotation about z.
    Revolute,
    /// Translation along z.
    Prismatic,
}

/// An angle as quarter turns and a remainder, so that multiples of 90° cost nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Angle {
    /// Quarter turns, 0 to 3.
    pub quarters: u8,
    /// The rest (rad).
    pub remainder: f64,
}

/// A constant rotation `R_z(γ) R_x(α)`, kept as sines and cosines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// sin γ, cos γ
    pub gamma: (f64, f64),
    /// sin α, cos α
    pub alpha: (f64, f64),
}

/// A rotor: carried by a body, turning `ratio · ẏ` relative to it.
#[derive(Debug, Clone, Copy)]
pub struct Rotor<'g> {
    /// Coordinate that its drive moves.
    pub coordinate: usize,
    /// Body that carries it; `None` for the base, and for rotors that only enter the diagonal.
    pub carrier: Option<usize>,
    /// Its axis in the carrier's frame.
    pub axis: Vector3<'g>,
    /// Gear ratio i.
    pub ratio: Scalar<'g>,
    /// Axial inertia J_R [kg m²].
    pub inertia: Scalar<'g>,
}

impl<'g> Mechanism<'g> {
    /// The mechanism of a model, with all inertial constants where the description puts them.
    pub fn new(graph: &'g Graph, model: &Model) -> Self {
        frames::assign(graph, model, &tree::moving_bodies(graph, model))
    }

    /// Moves inertial constants towards the base; M, k, q and energies do not change.
    pub fn regrouped(mut self, choices: &[RegroupChoice]) -> Self {
        regroup(&mut self.bodies, &mut self.base_moments, choices);
        self
    }

    /// The number of coordinates.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Children of each body.
    pub fn children(&self) -> Vec<Vec<usize>> {
        let mut children = vec![Vec::new(); self.len()];
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some(parent) = body.parent {
                children[parent].push(index);
            }
        }
        children
    }
}

impl<'g> Body<'g> {
    /// Origin in the parent's frame, at coordinate 0 where the joint is prismatic. With γ in the twist the lift along
    /// the axis has a component along the parent's x.
    pub fn origin_in_parent(&self) -> Vector3<'g> {
        let zero = self.lift.constant(0.0);
        self.translation + self.twist.to_parent(Vector3([zero, zero, self.lift]))
    }
}

impl Twist {
    /// No rotation.
    pub const NONE: Self = Self {
        gamma: (0.0, 1.0),
        alpha: (0.0, 1.0),
    };

    /// Whether the joint's axis is parallel to the parent's, with aligned frames.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The rotation matrix.
    pub fn matrix(&self) -> Matrix3<f64> {
        let ((sg, cg), (sa, ca)) = (self.gamma, self.alpha);
        Matrix3::new(cg, -sg * ca, sg * sa, sg, cg * ca, -cg * sa, 0.0, sa, ca)
    }

    /// From the joint's frame before its motion to the parent's frame.
    pub fn to_parent<'g>(&self, v: Vector3<'g>) -> Vector3<'g> {
        let ((sg, cg), (sa, ca)) = (self.gamma, self.alpha);
        let (x, y, z) = (v[0], v[1] * ca - v[2] * sa, v[1] * sa + v[2] * ca);
        Vector3([x * cg - y * sg, x * sg + y * cg, z])
    }

    /// From the parent's frame to the joint's frame before its motion.
    pub fn to_child<'g>(&self, v: Vector3<'g>) -> Vector3<'g> {
        let ((sg, cg), (sa, ca)) = (self.gamma, self.alpha);
        let (x, y, z) = (v[0] * cg + v[1] * sg, v[1] * cg - v[0] * sg, v[2]);
        Vector3([x, y * ca + z * sa, z * ca - y * sa])
    }
}

impl Angle {
    /// From radians; remainders below 1e-13 are rounding and vanish.
    pub fn new(radians: f64) -> Self {
        let quarters = (radians / std::f64::consts::FRAC_PI_2).round();
        let remainder = radians - quarters * std::f64::consts::FRAC_PI_2;
        Self {
            quarters: quarters.rem_euclid(4.0) as u8,
            remainder: if remainder.abs() < 1e-13 {
                0.0
            } else {
                remainder
            },
        }
    }

    /// The angle in radians, between −45° and 315°.
    pub fn radians(self) -> f64 {
        f64::from(self.quarters) * std::f64::consts::FRAC_PI_2 + self.remainder
    }

    /// Sine and cosine of the angle itself, by which a sliding joint's frame is turned; `None` for 0.
    pub fn constant_turn(self, graph: &Graph) -> Option<(Scalar<'_>, Scalar<'_>)> {
        if self == Self::default() {
            return None;
        }
        let (sine, cosine) = numeric::sin_cos(self.remainder);
        Some(self.advance((graph.constant(sine), graph.constant(cosine))))
    }

    /// Turns the sine and cosine of an angle into those of the angle plus the quarter turns.
    pub fn advance<'g>(self, (s, c): (Scalar<'g>, Scalar<'g>)) -> (Scalar<'g>, Scalar<'g>) {
        match self.quarters {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }
}

impl std::ops::Add for Angle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let sum = Self::new(self.remainder + other.remainder);
        Self {
            quarters: (self.quarters + other.quarters + sum.quarters) % 4,
            remainder: sum.remainder,
        }
    }
}

impl<'g> Mechanism<'g> {
    /// Gives each body its own unit of length (m), so that one length in it becomes 1: moments of force keep their
    /// values, forces and accelerations scale. Only where every joint is revolute.
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

    /// Gravitational acceleration in the frame of the base, in the unit of length of a body on it.
    pub fn gravity_for(&self, root: usize) -> Vector3<'g> {
        self.gravity
            .map(|x| scaled_down(x, self.bodies[root].length_unit))
    }

    /// Turns a leaf's frame about its axis until its first moment has no y component.
    pub fn align_first_moment(&mut self, index: usize) {
        let first = self.bodies[index].moments.first;
        if let (Some(x), Some(y)) = (first[0].value(), first[1].value())
            && (x != 0.0 || y != 0.0)
        {
            self.turn_leaf(index, numeric::atan2(y, x));
            self.bodies[index].moments.first.0[1] = self.graph.constant(0.0);
        }
    }

    /// Turns a leaf's frame about its axis until its second moment has no xy component.
    pub fn align_second_moment(&mut self, index: usize) {
        let second = self.bodies[index].moments.second;
        if let (Some(xx), Some(xy), Some(yy)) =
            (second.xx.value(), second.xy.value(), second.yy.value())
            && xy != 0.0
        {
            self.turn_leaf(index, 0.5 * numeric::atan2(2.0 * xy, xx - yy));
            self.bodies[index].moments.second.xy = self.graph.constant(0.0);
        }
    }

    /// Turns the frame of a leaf about its axis; all that is given in it turns the other way.
    fn turn_leaf(&mut self, index: usize, angle: f64) {
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
        let back = ScalarPose {
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

/// `x / unit`, exact where both are the same constant.
fn scaled_down(x: Scalar<'_>, unit: f64) -> Scalar<'_> {
    match x.value() {
        Some(value) => x.constant(value / unit),
        None => x * (1.0 / unit),
    }
}
