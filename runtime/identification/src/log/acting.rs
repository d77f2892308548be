//! What acts on a robot with quaternions: torques of its joints, its inputs, or those inputs alone that act at frames.

use super::super::error::{IdentificationError, Result};
use super::super::run::Effort;
use super::finder::Finder;
use super::options::{Named, is_effort};
use super::search::Found;
use super::vocabulary::Kind;

/// What the efforts of a log act on.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Acting {
    /// The joints, one column for each without a quaternion.
    Joints,
    /// These inputs; what the others do is not known.
    Inputs(Vec<usize>),
}

impl Finder<'_> {
    /// Columns of the efforts, and what they act on.
    ///
    /// # Errors
    /// Currents, torques at the joints where inputs act at frames, and columns that are missing or ambiguous.
    pub(super) fn acting(&self, wanted: Option<Effort>) -> Result<(Acting, Found)> {
        let told = self.pattern(is_effort);
        let named = told.map(|pattern| match pattern.named {
            Named::Input => Effort::Input,
            Named::Current => Effort::Current,
            _ => Effort::Joint,
        });
        let wanted = wanted.or(named);
        if wanted == Some(Effort::Current) {
            return Err(self.fault(
                "currents are not identified where joints have quaternions: convert them to torques, and name these".into(),
            ));
        }
        let has_frames = self.robot.at_frames.contains(&true);
        if wanted == Some(Effort::Joint) && has_frames {
            return Err(self.fault(format!(
                "inputs of this robot act at frames ({}), and torques at the joints do not hold what they do to the base: \
                 name the columns of the inputs with --columns 'input=…'",
                self.robot.frame_inputs.names.join(", ")
            )));
        }
        if let Some(pattern) = told {
            return self.told_efforts(wanted == Some(Effort::Joint), pattern);
        }
        self.found_efforts(wanted, has_frames)
    }

    fn told_efforts(&self, at_joints: bool, pattern: &super::options::Pattern) -> Result<(Acting, Found)> {
        if at_joints {
            return Ok((Acting::Joints, self.by_pattern(pattern, &self.robot.torques)?));
        }
        let all = self.by_pattern(pattern, &self.robot.inputs);
        match all {
            Ok(found) => Ok((Acting::Inputs((0..self.robot.at_frames.len()).collect()), found)),
            Err(fault) => match self.by_pattern(pattern, &self.robot.frame_inputs) {
                Ok(found) if self.robot.at_frames.contains(&true) => Ok((self.at_frames(), found)),
                _ => Err(fault),
            },
        }
    }

    fn found_efforts(&self, wanted: Option<Effort>, has_frames: bool) -> Result<(Acting, Found)> {
        let robot = self.robot;
        if wanted != Some(Effort::Input)
            && !has_frames
            && !robot.torques.names.is_empty()
            && let Some(found) = self.best(&[Kind::Torque], &robot.torques)?
        {
            return Ok((Acting::Joints, found));
        }
        let kinds = [Kind::Input, Kind::Torque];
        if !robot.inputs.names.is_empty()
            && let Some(found) = self.best(&kinds, &robot.inputs)?
        {
            return Ok((Acting::Inputs((0..robot.at_frames.len()).collect()), found));
        }
        if !has_frames {
            return Err(self.nothing_acts(self.missing(&kinds, &robot.inputs)));
        }
        match self.best(&kinds, &robot.frame_inputs)? {
            Some(mut found) => {
                found.remarks.push(
                    "No efforts of the joints are found: the rows of the base alone, and of joints without a drive, are \
                     fitted."
                        .into(),
                );
                Ok((self.at_frames(), found))
            }
            None => Err(self.nothing_acts(self.missing(&kinds, &robot.frame_inputs))),
        }
    }

    /// The same error, with what would be enough of a robot whose base floats.
    fn nothing_acts(&self, error: IdentificationError) -> IdentificationError {
        let IdentificationError::File { place, message } = error else { return error };
        let Some(base) = self.robot.quaternions.iter().find(|joint| joint.is_floating) else {
            return IdentificationError::File { place, message };
        };
        let enough = if self.robot.at_frames.contains(&true) {
            "Efforts of the joints may be missing, those of the inputs at frames may not".to_owned()
        } else {
            format!(
                "Without efforts of the joints the six rows of `{}` are enough, where what acts on the robot from outside is                  measured: describe the forces of its feet as `[[inputs]]` with `frame` and `wrench`, and add their columns to                  the log. In free flight nothing acts, and a motion tells ratios of masses and inertias alone",
                base.name
            )
        };
        IdentificationError::File { place, message: format!("{message}. {enough}") }
    }

    fn at_frames(&self) -> Acting {
        let at_frames = self.robot.at_frames.iter().enumerate();
        Acting::Inputs(at_frames.filter(|(_, at)| **at).map(|(input, _)| input).collect())
    }
}
