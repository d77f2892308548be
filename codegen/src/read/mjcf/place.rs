//! Poses in MJCF, which has five representations of an orientation.

use super::Reader;
use super::files::{Element, Given};
use crate::diagnostic::At;
use crate::model::Pose;
use crate::model::pose::{IDENTITY, Rotation, about_x, about_y, about_z, product};
use crate::numeric::{cross, length};
use crate::spatial::rotation_about;
use gelenk_formula::Formula;

/// Vectors up to this length are treated as vectors without direction.
const NO_LENGTH: f64 = 1e-14;

/// Function that finds an attribute of an orientation in the element, and for some elements in its default
/// class.
type Find<'f, 'a> = dyn Fn(&str) -> Option<Given<'a>> + 'f;

impl<'a> Reader<'_, 'a> {
    /// Pose from the attributes of an element.
    pub(super) fn pose(&mut self, element: Element<'a>, owner: &str) -> Pose {
        self.pose_by(&|key| element.attribute(key), owner)
    }

    pub(super) fn pose_by(&mut self, find: &Find<'_, 'a>, owner: &str) -> Pose {
        let position = self.vector(find("pos"), "pos").map_or([0.0; 3], |position| position.value);
        Pose { translation: position.map(Formula::Number), rotation: self.attitude(find, owner) }
    }

    fn attitude(&mut self, find: &Find<'_, 'a>, owner: &str) -> Rotation {
        if let Some(given) = self.vector::<4>(find("quat"), "quat") {
            let size = length(given.value);
            if size <= NO_LENGTH {
                let message = "`quat` has length 0 and is not a rotation";
                self.report.error(given.span, "quaternion-not-unit", message);
                self.report.help("the identity is \"1 0 0 0\"");
                return IDENTITY;
            }
            return self.angles.quaternion(given.value.map(|x| x / size));
        }
        if let Some(given) = self.vector::<4>(find("axisangle"), "axisangle") {
            let [x, y, z, angle] = given.value;
            let size = length([x, y, z]);
            if !self.is_direction(&given, size, "axisangle") {
                return IDENTITY;
            }
            let angle = self.angles.angle(&At::new(angle * self.compiler.angle, given.span), owner);
            return by_axis([x, y, z].map(|x| x / size), angle);
        }
        if let Some(given) = self.vector::<3>(find("euler"), "euler") {
            return self.euler(&given, owner);
        }
        if let Some(given) = self.vector::<6>(find("xyaxes"), "xyaxes") {
            return self.by_axes(&given);
        }
        match self.vector::<3>(find("zaxis"), "zaxis") {
            Some(given) => {
                let size = length(given.value);
                match self.is_direction(&given, size, "zaxis") {
                    true => z_to(given.value.map(|x| x / size)),
                    false => IDENTITY,
                }
            }
            None => IDENTITY,
        }
    }

    pub(super) fn euler(&mut self, given: &At<[f64; 3]>, owner: &str) -> Rotation {
        let angles = given.value.map(|angle| {
            let angle = At::new(angle * self.compiler.angle, given.span);
            self.angles.angle(&angle, owner)
        });
        let mut rotation = IDENTITY;
        for (axis, angle) in self.compiler.eulerseq.into_iter().zip(angles) {
            let turn = match axis.to_ascii_lowercase() {
                'x' => about_x(angle),
                'y' => about_y(angle),
                _ => about_z(angle),
            };
            rotation = match axis.is_lowercase() {
                true => product(&rotation, &turn),
                false => product(&turn, &rotation),
            };
        }
        rotation
    }

    /// Rotation matrix from the axes x and y. The part of y along x is removed.
    fn by_axes(&mut self, given: &At<[f64; 6]>) -> Rotation {
        let [a, b, c, d, e, f] = given.value;
        let size = length([a, b, c]);
        if !self.is_direction(given, size, "xyaxes") {
            return IDENTITY;
        }
        let x = [a, b, c].map(|entry| entry / size);
        let along = x[0] * d + x[1] * e + x[2] * f;
        let y = [d - along * x[0], e - along * x[1], f - along * x[2]];
        let size = length(y);
        if !self.is_direction(given, size, "xyaxes") {
            return IDENTITY;
        }
        let y = y.map(|entry| entry / size);
        let z = cross(&x, &y);
        std::array::from_fn(|row| [x[row], y[row], z[row]])
    }

    /// Whether a vector has a direction. A vector without a direction is reported.
    fn is_direction<const N: usize>(&mut self, given: &At<[f64; N]>, size: f64, key: &str) -> bool {
        let is_direction = size > NO_LENGTH;
        if !is_direction {
            self.report.error(
                given.span,
                "axis-not-unit",
                format!("`{key}` has no direction: its length is 0"),
            );
        }
        is_direction
    }

    /// Reads a direction and returns it as a unit vector.
    pub(super) fn direction(&mut self, given: Option<Given<'a>>, key: &str) -> Option<[f64; 3]> {
        let given = self.vector::<3>(given, key)?;
        let size = length(given.value);
        self.is_direction(&given, size, key).then(|| given.value.map(|x| x / size))
    }
}

pub(super) fn by_axis(axis: [f64; 3], angle: f64) -> Rotation {
    let rotation = rotation_about(axis, angle);
    std::array::from_fn(|row| std::array::from_fn(|column| rotation[(row, column)]))
}

/// Shortest rotation from z to a direction, or a rotation by 180° about x if the direction is opposite to z.
pub(super) fn z_to(z: [f64; 3]) -> Rotation {
    let [a, b, c] = z;
    let below = 1.0 + c;
    if below < 1e-12 {
        return [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    }
    [[1.0 - a * a / below, -a * b / below, a], [-a * b / below, 1.0 - b * b / below, b], [-a, -b, c]]
}
