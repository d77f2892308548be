//! What finding columns needs: a sheet, a robot's names, and what the user said.

use super::super::error::IdentificationError;
use super::super::pose::{QuaternionJoint, rows_of};
use super::super::robot::Robot;
use super::families::Targets;
use super::options::{Named, Pattern};
use super::sheet::Sheet;
use super::vocabulary::Header;

/// A robot's joints and inputs as columns are matched with them. Velocities of joints with a quaternion are no joints here.
pub(super) struct RobotColumns {
    pub joints: Targets,
    /// Joints whose torques a log may have: all but those that something else moves.
    pub torques: Targets,
    /// `rad` or `m`, of each of them.
    pub torque_units: Vec<&'static str>,
    pub inputs: Targets,
    /// Joints with a quaternion.
    pub quaternions: Vec<QuaternionJoint>,
    /// Of each input whether it acts at frames.
    pub at_frames: Vec<bool>,
    pub frame_inputs: Targets,
    /// `rad` or `m`, of each joint.
    pub units: Vec<&'static str>,
    /// Unit of the position of the joint that an input drives, where it is one.
    pub input_units: Vec<&'static str>,
    /// B is the identity: forces at the joints and inputs are the same.
    pub direct: bool,
}

impl RobotColumns {
    pub(super) fn new(robot: &dyn Robot) -> Self {
        let (names, inputs) = (robot.joint_names(), robot.input_names());
        let quaternions = robot.quaternion_joints();
        let rows = rows_of(&quaternions, names.len());
        let plain = || (0..names.len()).filter(|joint| !rows[*joint]);
        let joints: Vec<String> = plain().map(|joint| names[joint].clone()).collect();
        let (n, m) = (joints.len(), inputs.len());
        let matrix = robot.input_matrix();
        let lines: Vec<usize> = plain().collect();
        let entry = |row: usize, column: usize| matrix.get(lines[row] * m + column).copied().unwrap_or(0.0);
        let driven = |input: usize| {
            let mut rows = (0..n).filter(|joint| entry(*joint, input) != 0.0);
            let joint = rows.next()?;
            rows.next().is_none().then_some(joint)
        };
        let driven: Vec<Option<usize>> = (0..m).map(driven).collect();
        let others: Vec<Option<String>> = driven.iter().map(|j| j.map(|j| joints[j].clone())).collect();
        let all_units = robot.position_units();
        let units: Vec<&'static str> =
            plain().map(|joint| all_units.get(joint).copied().unwrap_or("rad")).collect();
        let acts =
            |input: usize| (0..names.len()).any(|row| matrix.get(row * m + input).is_some_and(|b| *b != 0.0));
        let at_frames: Vec<bool> = (0..m).map(|input| robot.has_inputs_at_frames() && !acts(input)).collect();
        let frame_inputs = inputs.iter().zip(&at_frames).filter(|(_, at)| **at).map(|(name, _)| name.clone());
        let frame_inputs: Vec<String> = frame_inputs.collect();
        let unmeasured = robot.unmeasured();
        let measured: Vec<usize> = (0..n).filter(|j| !unmeasured[lines[*j]]).collect();
        let unit = |joint: Option<usize>| joint.and_then(|j| units.get(j).copied()).unwrap_or("rad");
        let direct = n == m
            && (0..n)
                .all(|row| (0..m).all(|column| entry(row, column) == f64::from(u8::from(row == column))));
        Self {
            inputs: Targets::new(&inputs, &others),
            joints: Targets::new(&joints, &[]),
            torques: Targets::new(&measured.iter().map(|j| joints[*j].clone()).collect::<Vec<_>>(), &[]),
            torque_units: measured.iter().map(|j| units[*j]).collect(),
            input_units: driven.into_iter().map(unit).collect(),
            units,
            direct,
            quaternions,
            at_frames,
            frame_inputs: Targets::new(&frame_inputs, &[]),
        }
    }
}

/// What finding columns needs.
pub(super) struct Finder<'a> {
    pub sheet: &'a Sheet<'a>,
    pub headers: &'a [Header],
    pub robot: &'a RobotColumns,
    pub patterns: &'a [Pattern],
    pub listed: Option<&'a [Option<usize>]>,
    pub source: &'a str,
}

impl Finder<'_> {
    pub(super) fn fault(&self, message: String) -> IdentificationError {
        IdentificationError::File { place: self.source.into(), message }
    }

    pub(super) fn pattern(&self, matches: impl Fn(Named) -> bool) -> Option<&Pattern> {
        self.patterns.iter().find(|p| matches(p.named))
    }

    /// Name of a column for people.
    pub(super) fn label(&self, column: usize) -> String {
        match self.headers.get(column) {
            Some(header) => format!("`{}`", header.text),
            None => format!("number {}", column + 1),
        }
    }

    /// What `--columns` takes for a header: its text, or its number where others have the same text.
    pub(super) fn unique(&self, header: &Header) -> String {
        let same = self.headers.iter().filter(|h| h.text == header.text).count();
        if same > 1 { (header.index + 1).to_string() } else { header.text.clone() }
    }
}
