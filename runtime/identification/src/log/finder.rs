//! What finding columns needs: a sheet, a robot's names, and what the user said.

use super::super::error::IdentificationError;
use super::super::robot::Robot;
use super::families::Targets;
use super::options::{Named, Pattern};
use super::sheet::Sheet;
use super::vocabulary::Header;

/// A robot's joints and inputs as columns are matched with them.
pub(super) struct RobotColumns {
    pub joints: Targets,
    pub inputs: Targets,
    /// `rad` or `m`, of each joint.
    pub units: Vec<&'static str>,
    /// Unit of the position of the joint that an input drives, where it is one.
    pub input_units: Vec<&'static str>,
    /// B is the identity: forces at the joints and inputs are the same.
    pub direct: bool,
}

impl RobotColumns {
    pub(super) fn new(robot: &dyn Robot) -> Self {
        let (joints, inputs) = (robot.joint_names(), robot.input_names());
        let (n, m) = (joints.len(), inputs.len());
        let matrix = robot.input_matrix();
        let entry = |row: usize, column: usize| matrix.get(row * m + column).copied().unwrap_or(0.0);
        let driven = |input: usize| {
            let mut rows = (0..n).filter(|joint| entry(*joint, input) != 0.0);
            let joint = rows.next()?;
            rows.next().is_none().then_some(joint)
        };
        let driven: Vec<Option<usize>> = (0..m).map(driven).collect();
        let others: Vec<Option<String>> = driven.iter().map(|j| j.map(|j| joints[j].clone())).collect();
        let units = robot.position_units();
        let unit = |joint: Option<usize>| joint.and_then(|j| units.get(j).copied()).unwrap_or("rad");
        let direct = n == m
            && (0..n)
                .all(|row| (0..m).all(|column| entry(row, column) == f64::from(u8::from(row == column))));
        Self {
            inputs: Targets::new(&inputs, &others),
            joints: Targets::new(&joints, &[]),
            input_units: driven.into_iter().map(unit).collect(),
            units,
            direct,
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
