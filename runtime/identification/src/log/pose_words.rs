//! Words in the headers of poses: which columns are the letters of one place or of one quaternion.

use super::vocabulary::Header;
use std::collections::BTreeMap;

/// Words before the letter of a quaternion's entry, as in `orientation.x`.
const ATTITUDE: [&str; 8] = ["quat", "quaternion", "orientation", "rotation", "attitude", "rot", "ori", "q"];

/// Words in the names of poses that do not say of which joint they are.
#[rustfmt::skip]
const PLAIN: [&str; 38] = [
    "pose", "position", "pos", "place", "translation", "transform", "trans", "p", "r", "quat", "quaternion",
    "orientation", "rotation", "attitude", "rot", "ori", "q", "base", "root", "trunk", "body", "torso", "odom",
    "link", "frame", "world", "state", "robot", "floating", "field", "msg", "data", "measured", "meas", "actual",
    "mocap", "vicon", "local",
];

/// Words of what is no pose, or none that was measured.
#[rustfmt::skip]
const OTHER: [&str; 40] = [
    "dq", "vel", "velocity", "velocities", "twist", "linear", "angular", "acc", "accel", "acceleration", "omega",
    "gyro", "imu", "mag", "force", "forces", "torque", "moment", "wrench", "u", "input", "tau", "effort", "desired",
    "des", "target", "ref", "reference", "cmd", "command", "commanded", "setpoint", "goal", "planned", "error",
    "covariance", "ddq", "qvel", "speed", "rate",
];

/// Words of other ways to write an attitude.
const ANGLES: [&str; 6] = ["roll", "pitch", "yaw", "rpy", "euler", "heading"];

/// The entries of a place, in the order of the positions y.
pub(super) const PLACE: &[&str] = &["x", "y", "z"];
/// The entries of a quaternion, in the order of the positions y.
pub(super) const QUATERNION: &[&str] = &["x", "y", "z", "w"];

/// Columns that differ in their letter alone.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    /// Words before the letter, without those that make it a quaternion's.
    pub stem: Vec<String>,
    /// Column of each letter.
    pub columns: Vec<Option<usize>>,
}

impl Group {
    /// All columns, where none is missing.
    pub(super) fn complete(&self) -> Option<Vec<usize>> {
        self.columns.iter().copied().collect()
    }

    /// How far the name is from that of a joint: 0 where it holds the joint's, 1 where it says nothing, else 2.
    pub(super) fn distance(&self, joint: &[String]) -> u8 {
        let names = !joint.is_empty() && self.stem.windows(joint.len()).any(|window| window == joint);
        let says_nothing = self.stem.iter().all(|word| PLAIN.contains(&word.as_str()));
        if names { 0 } else { 2 - u8::from(says_nothing) }
    }
}

/// The groups of places or quaternions in a header, in the order of their stems.
pub(super) fn groups(headers: &[Header], letters: &'static [&'static str]) -> Vec<Group> {
    let mut groups: BTreeMap<Vec<String>, Vec<Option<usize>>> = BTreeMap::new();
    for header in headers {
        let Some((stem, letter, is_attitude)) = parsed(&header.words) else { continue };
        let Some(place) = letters.iter().position(|known| *known == letter) else { continue };
        if is_attitude == (letters.len() == QUATERNION.len()) {
            let columns = groups.entry(stem).or_insert_with(|| vec![None; letters.len()]);
            // The first of two columns of one name; the other is no part of the pose.
            columns[place].get_or_insert(header.index);
        }
    }
    groups.into_iter().map(|(stem, columns)| Group { stem, columns }).collect()
}

/// Stem, letter, and whether it is that of a quaternion.
fn parsed(words: &[String]) -> Option<(Vec<String>, String, bool)> {
    let (last, before) = words.split_last()?;
    if words.iter().any(|word| OTHER.contains(&word.as_str())) {
        return None;
    }
    let is_letter = |letter: &str| QUATERNION.contains(&letter);
    if let Some(letter) = last.strip_prefix('q').filter(|letter| is_letter(letter)) {
        return Some((before.to_vec(), letter.to_owned(), true));
    }
    if let Some(letter) = last.strip_prefix('p').filter(|letter| PLACE.contains(letter)) {
        return Some((before.to_vec(), letter.to_owned(), false));
    }
    if !is_letter(last) {
        return None;
    }
    match before.split_last() {
        Some((mark, stem)) if ATTITUDE.contains(&mark.as_str()) => Some((stem.to_vec(), last.clone(), true)),
        _ => Some((before.to_vec(), last.clone(), false)),
    }
}

/// The headers that write an attitude as angles.
pub(super) fn angles(headers: &[Header]) -> Vec<String> {
    let is_angle = |header: &&Header| {
        let measured = !header.words.iter().any(|word| OTHER.contains(&word.as_str()));
        measured && header.words.iter().any(|word| ANGLES.contains(&word.as_str()))
    };
    headers.iter().filter(is_angle).map(|header| header.text.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(texts: &[&str], letters: &'static [&'static str]) -> Vec<Vec<Option<usize>>> {
        let headers: Vec<Header> = texts.iter().enumerate().map(|(i, t)| Header::new(i, t, None)).collect();
        groups(&headers, letters).into_iter().map(|group| group.columns).collect()
    }

    #[test]
    fn quaternions_are_told_by_their_letters() {
        let cases: [[&str; 4]; 7] = [
            ["qw", "qx", "qy", "qz"],
            ["quat_w", "quat_x", "quat_y", "quat_z"],
            ["pose.orientation.w", "pose.orientation.x", "pose.orientation.y", "pose.orientation.z"],
            ["q_base_qw", "q_base_qx", "q_base_qy", "q_base_qz"],
            [
                "/odom/pose/pose/orientation/w",
                "/odom/pose/pose/orientation/x",
                "/odom/pose/pose/orientation/y",
                "/odom/pose/pose/orientation/z",
            ],
            ["Rotation W", "Rotation X", "Rotation Y", "Rotation Z"],
            ["q_w", "q_x", "q_y", "q_z"],
        ];
        for texts in cases {
            assert_eq!(found(&texts, QUATERNION), [[Some(1), Some(2), Some(3), Some(0)]], "{texts:?}");
            assert!(found(&texts, PLACE).is_empty(), "{texts:?}");
        }
    }

    #[test]
    fn places_are_neither_velocities_nor_what_was_asked_for() {
        let texts = ["x", "y", "z", "dq_base_x", "twist.linear.y", "desired_base_z", "base_x", "px"];
        assert_eq!(found(&texts, PLACE), [[Some(0), Some(1), Some(2)], [Some(6), None, None]]);
        let headers = [Header::new(0, "roll_deg", None), Header::new(1, "desired_yaw", None)];
        assert_eq!(angles(&headers), ["roll_deg"]);
    }
}
