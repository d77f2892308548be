//! Finds angles close to a multiple of 90°. A note lists these angles, and the option `snap_angles` rounds them
//! to the multiple.

use crate::diagnostic::{At, Report, Span};
use crate::model::pose::{Rotation, from_quaternion, from_rpy, is_nearly_right, snapped};
use crate::wording::{listed, three_digits};
use gelenk_findings::counted;

/// Largest difference \[rad\] between an angle and a multiple of 90° for which a note is printed.
pub const NEARLY_RIGHT: f64 = 1e-4;
/// Code of the note about angles close to a multiple of 90°.
pub const NEARLY_RIGHT_ANGLE: &str = "nearly-right-angle";
/// Converts the angles of a description to rotations, and collects angles that are probably mistakes for
/// notes.
#[derive(Debug, Default)]
pub(crate) struct Angles {
    /// Largest distance (rad) of an angle from a multiple of 90° for which the angle is rounded to this
    /// multiple. `None` rounds no angle.
    pub snap: Option<f64>,
    near: Vec<(Span, String, f64)>,
    gained: usize,
    /// Places and texts of angles that are probably in degrees instead of radians.
    degrees: Vec<(Span, String)>,
}

/// Whether an angle of a description is probably in degrees: a multiple of 5 with a magnitude from 30 to 720,
/// for example −180.
pub(crate) fn looks_like_degrees(angle: f64) -> bool {
    is_beyond_turns(angle) && angle % 5.0 == 0.0
}

/// Whether the magnitude of an angle is from 30 to 720. In radians this is almost five turns or more, in
/// degrees at most two turns.
pub(crate) fn is_beyond_turns(angle: f64) -> bool {
    (30.0..=720.0).contains(&angle.abs())
}

impl Angles {
    /// Rotation from roll, pitch and yaw (rad), as in URDF. In notes, `owner` is the name of the angles.
    pub fn rpy(&mut self, rpy: &At<[f64; 3]>, owner: &str) -> Rotation {
        let angles = rpy.value.map(|angle| self.snapped(angle));
        for angle in angles {
            self.remember(angle, rpy.span, owner);
        }
        let rotation = from_rpy(angles);
        let exact = from_rpy(angles.map(|angle| snapped(angle, NEARLY_RIGHT)));
        self.gained += trivial_entries(&exact).saturating_sub(trivial_entries(&rotation));
        rotation
    }

    /// Rotation from a unit quaternion (w, x, y, z).
    pub fn quaternion(&self, quaternion: [f64; 4]) -> Rotation {
        from_quaternion(quaternion, self.snap.unwrap_or(0.0))
    }

    /// Returns an angle of a Denavit–Hartenberg row (rad), rounded if [`Self::snap`] is set. In notes, `owner`
    /// is the name of the angle.
    pub fn angle(&mut self, angle: &At<f64>, owner: &str) -> f64 {
        let value = self.snapped(angle.value);
        if self.remember(value, angle.span, owner) {
            self.gained += 4;
        }
        value
    }

    fn snapped(&self, angle: f64) -> f64 {
        self.snap.map_or(angle, |tolerance| snapped(angle, tolerance))
    }

    fn remember(&mut self, angle: f64, span: Span, owner: &str) -> bool {
        if looks_like_degrees(angle) {
            self.degrees.push((span, format!("{owner} {angle}")));
        }
        let near = is_nearly_right(angle, NEARLY_RIGHT);
        if near {
            self.near.push((span, owner.to_owned(), angle));
        }
        near
    }

    /// Adds the notes about the collected angles to the report.
    pub fn report(self, report: &mut Report) {
        self.note_degrees(report);
        let Some((first, ..)) = self.near.first() else {
            return;
        };
        let entries = self.near.iter();
        let entries = entries.map(|(_, owner, angle)| {
            let distance = angle - snapped(*angle, NEARLY_RIGHT);
            format!("{owner} (off by {})", three_digits(distance))
        });
        let message = format!(
            "{} within 1e-4 rad of a multiple of 90°, but not equal to it: {}; rounding would set {} of rotation \
             matrices to exactly 0 or ±1, and products with these numbers cost no operations",
            counted(self.near.len(), "angle is", "angles are"),
            listed(entries),
            counted(self.gained, "entry", "entries"),
        );
        let help = "use `--snap-angles 1e-4` or the key `snap_angles = 1e-4`";
        report.note(Some(*first), NEARLY_RIGHT_ANGLE, message).help(help);
    }

    fn note_degrees(&self, report: &mut Report) {
        let Some((first, _)) = self.degrees.first() else {
            return;
        };
        let entries = self.degrees.iter().map(|(_, entry)| entry.clone());
        let message =
            format!("these rotations look like degrees, but are read as radians: {}", listed(entries));
        report.note(Some(*first), "looks-like-degrees", message);
        report.help("90° is 1.5707963267948966 in a URDF, `\"pi/2\"` in TOML");
    }
}

fn trivial_entries(rotation: &Rotation) -> usize {
    rotation.iter().flatten().filter(|entry| entry.abs() == 1.0 || **entry == 0.0).count()
}
