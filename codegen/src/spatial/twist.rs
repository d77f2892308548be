//! Constant rotations between joint axes, and constant angles about joint axes.

use nalgebra::Matrix3;

use super::vector::Vector3;
use crate::graph::{Graph, Scalar};
use crate::numeric;

/// An angle in quarter turns plus a remainder. The sine and cosine of multiples of 90° need no operations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Angle {
    /// Number of quarter turns, 0 to 3.
    pub quarters: u8,
    /// Remainder of the angle (rad).
    pub remainder: f64,
}

/// A constant rotation `R_z(γ) R_x(α)`, stored as sines and cosines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// Sine and cosine of the angle γ about z.
    pub gamma: (f64, f64),
    /// Sine and cosine of the angle α about x.
    pub alpha: (f64, f64),
}

impl Twist {
    /// The identity rotation, with both angles 0.
    pub const NONE: Self = Self { gamma: (0.0, 1.0), alpha: (0.0, 1.0) };

    /// Whether the rotation is the identity.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The rotation matrix `R_z(γ) R_x(α)`.
    pub fn matrix(&self) -> Matrix3<f64> {
        let ((sg, cg), (sa, ca)) = (self.gamma, self.alpha);
        Matrix3::new(cg, -sg * ca, sg * sa, sg, cg * ca, -cg * sa, 0.0, sa, ca)
    }

    /// Transforms a vector from the joint's frame before its motion to the parent's frame.
    pub fn to_parent<'g>(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let ((sg, cg), (sa, ca)) = (self.gamma, self.alpha);
        let (x, y, z) = (v[0], v[1] * ca - v[2] * sa, v[1] * sa + v[2] * ca);
        Vector3([x * cg - y * sg, x * sg + y * cg, z])
    }

    /// Transforms a vector from the parent's frame to the joint's frame before its motion.
    pub fn to_child<'g>(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let ((sg, cg), (sa, ca)) = (self.gamma, self.alpha);
        let (x, y, z) = (v[0] * cg + v[1] * sg, v[1] * cg - v[0] * sg, v[2]);
        Vector3([x, y * ca + z * sa, z * ca - y * sa])
    }
}

impl Angle {
    /// Creates the angle from radians. Remainders below 1e-13 are treated as rounding errors and become 0.
    pub fn new(radians: f64) -> Self {
        let quarters = (radians / std::f64::consts::FRAC_PI_2).round();
        let remainder = radians - quarters * std::f64::consts::FRAC_PI_2;
        Self {
            quarters: quarters.rem_euclid(4.0) as u8,
            remainder: if remainder.abs() < 1e-13 { 0.0 } else { remainder },
        }
    }

    /// The angle in radians, between −45° and 315°.
    pub fn radians(self) -> f64 {
        f64::from(self.quarters) * std::f64::consts::FRAC_PI_2 + self.remainder
    }

    /// Sine and cosine of the angle as constants of the graph, for the frame of a prismatic joint; `None` for
    /// the angle 0.
    pub fn constant_turn(self, graph: &Graph) -> Option<(Scalar<'_>, Scalar<'_>)> {
        if self == Self::default() {
            return None;
        }
        let (sine, cosine) = numeric::sin_cos(self.remainder);
        Some(self.advance((graph.constant(sine), graph.constant(cosine))))
    }

    /// Sine and cosine of the sum of a variable angle and the quarter turns. The argument is the sine and
    /// cosine of the variable angle.
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
        Self { quarters: (self.quarters + other.quarters + sum.quarters) % 4, remainder: sum.remainder }
    }
}
