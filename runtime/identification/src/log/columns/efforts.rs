//! Search for the columns of the efforts: torques at the joints, inputs, or currents.

use super::super::super::error::{IdentificationError, Result};
use super::super::super::run::Effort;
use super::families::Targets;
use super::finder::Finder;
use super::found::Found;
use super::pattern::{Chosen, Pattern};
use super::table::Kind;
use gelenk_findings::Finding;

impl Finder<'_> {
    /// Returns the columns of the efforts, and the kind of the efforts.
    ///
    /// - `stated`: kind of efforts that the user specifies
    ///
    /// # Errors
    /// [`IdentificationError::File`] if columns are missing or ambiguous. If joints have quaternions, there are two more
    /// errors: the efforts are currents, or they are torques at the joints although inputs act at frames.
    pub(super) fn efforts(&self, stated: Option<Effort>) -> Result<(Effort, Found)> {
        let pattern = self.pattern(Kind::is_effort);
        let wanted = stated.or_else(|| pattern.map(|pattern| of_kind(pattern.kind)));
        let has_quaternions = !self.robot.quaternions.is_empty();
        if has_quaternions {
            self.require_inputs_at_frames(wanted)?;
        }
        let (effort, targets, choice) = match (pattern, wanted) {
            (Some(pattern), Some(effort)) => self.named_efforts(pattern, effort)?,
            _ if has_quaternions => self.efforts_or_frames(wanted)?,
            _ => self.best_efforts(stated)?,
        };
        Ok((effort, self.found(choice, kind_of(effort), targets)?))
    }

    /// Returns the joints or inputs for which a log may have efforts of this kind.
    fn targets_of(&self, effort: Effort) -> &Targets {
        if effort == Effort::Joint { &self.robot.torques } else { &self.robot.inputs }
    }

    /// Returns whether the log has only the efforts of inputs at frames, although the robot has other inputs.
    pub(super) fn has_frames_alone(&self, efforts: &Found) -> bool {
        let (frames, inputs) = (&self.robot.frame_inputs.places, &self.robot.inputs.places);
        efforts.kind == Kind::Input && efforts.places == *frames && inputs.len() > frames.len()
    }

    fn has_frames(&self) -> bool {
        !self.robot.frame_inputs.names.is_empty()
    }

    fn require_inputs_at_frames(&self, wanted: Option<Effort>) -> Result<()> {
        match wanted {
            Some(Effort::Current) => Err(self.fault(
                "currents are not supported for robots with spherical or floating joints. Convert the currents to torques, and \
                 name the columns of the torques".into(),
            )),
            Some(Effort::Joint) if self.has_frames() => Err(self.fault(format!(
                "torques of the joints are not enough, because inputs of this robot act at frames: {}. Name the columns of the \
                 inputs with --columns 'input=…'",
                self.robot.frame_inputs.names.join(", ")
            ))),
            _ => Ok(()),
        }
    }

    /// Returns the columns that the user names. For a robot with quaternions, the columns of the inputs at frames are
    /// enough.
    fn named_efforts(&self, pattern: &Pattern, effort: Effort) -> Result<(Effort, &Targets, Chosen)> {
        let frames = &self.robot.frame_inputs;
        let all = self.targets_of(effort);
        match self.by_pattern(pattern, all) {
            Ok(choice) => Ok((effort, all, choice)),
            Err(fault) if self.robot.quaternions.is_empty() || !self.has_frames() => Err(fault),
            Err(fault) => {
                let choice = self.by_pattern(pattern, frames).map_err(|_| fault)?;
                Ok((effort, frames, choice))
            }
        }
    }

    /// Returns the best columns for a robot without quaternions.
    fn best_efforts(&self, stated: Option<Effort>) -> Result<(Effort, &Targets, Chosen)> {
        let tried: &[(Effort, &[Kind])] = match stated {
            Some(Effort::Joint) => &[(Effort::Joint, &[Kind::Torque, Kind::Input])],
            Some(Effort::Input) => &[(Effort::Input, &[Kind::Input, Kind::Torque])],
            Some(Effort::Current) => &[(Effort::Current, &[Kind::Current, Kind::Torque, Kind::Input])],
            None => &[
                (Effort::Joint, &[Kind::Torque]),
                (Effort::Input, &[Kind::Input]),
                (Effort::Current, &[Kind::Current]),
            ],
        };
        let mut found = Vec::new();
        for (effort, kinds) in tried {
            let targets = self.targets_of(*effort);
            // A robot without drives has no inputs, so that an empty list of columns would fit.
            if !targets.names.is_empty() {
                found.extend(self.best(kinds, targets)?.map(|choice| (*effort, targets, choice)));
            } else if stated.is_some() {
                return Err(self.missing(kinds, targets));
            }
        }
        // Commanded columns are the last choice. A measured current contains more information than a commanded torque.
        let best = found.iter().position(|(.., choice)| !self.is_commanded(&choice.columns));
        match best.or((!found.is_empty()).then_some(0)) {
            Some(best) => Ok(found.swap_remove(best)),
            None => Err(self.missing(&[Kind::Torque, Kind::Input, Kind::Current], &self.robot.joints)),
        }
    }

    /// Returns the best columns for a robot with quaternions: torques at the joints, all inputs, or the inputs at frames.
    fn efforts_or_frames(&self, wanted: Option<Effort>) -> Result<(Effort, &Targets, Chosen)> {
        let robot = self.robot;
        if wanted != Some(Effort::Input)
            && !self.has_frames()
            && !robot.torques.names.is_empty()
            && let Some(choice) = self.best(&[Kind::Torque], &robot.torques)?
        {
            return Ok((Effort::Joint, &robot.torques, choice));
        }
        let kinds = [Kind::Input, Kind::Torque];
        if !robot.inputs.names.is_empty()
            && let Some(choice) = self.best(&kinds, &robot.inputs)?
        {
            return Ok((Effort::Input, &robot.inputs, choice));
        }
        if !self.has_frames() {
            return Err(self.nothing_acts(self.missing(&kinds, &robot.inputs)));
        }
        let Some(choice) = self.best(&kinds, &robot.frame_inputs)? else {
            return Err(self.nothing_acts(self.missing(&kinds, &robot.frame_inputs)));
        };
        Ok((Effort::Input, &robot.frame_inputs, choice))
    }

    /// Adds to the error which efforts a robot with a floating base needs at least.
    fn nothing_acts(&self, error: IdentificationError) -> IdentificationError {
        let base = self.robot.quaternions.iter().find(|joint| joint.is_floating);
        let (IdentificationError::File(finding), Some(base)) = (&error, base) else { return error };
        let enough = if self.has_frames() {
            "the log needs the forces of the inputs at frames. It does not need efforts of the joints"
                .to_owned()
        } else {
            format!(
                "the six equations of the base `{}` are enough if the external forces are measured. Describe the forces on the \
                 feet as `[[inputs]]` with `frame` and `wrench`, and add their columns to the log. Without any force, as in free \
                 flight, only ratios of masses and inertias can be determined",
                base.name
            )
        };
        IdentificationError::File(Box::new(Finding::clone(finding).help(enough)))
    }
}

fn of_kind(kind: Kind) -> Effort {
    match kind {
        Kind::Input => Effort::Input,
        Kind::Current => Effort::Current,
        _ => Effort::Joint,
    }
}

pub(super) fn kind_of(effort: Effort) -> Kind {
    match effort {
        Effort::Joint => Kind::Torque,
        Effort::Input => Kind::Input,
        Effort::Current => Kind::Current,
    }
}
