//! Search for the columns of poses: position x, y, z (`place`) and quaternion of each joint with a quaternion.

use super::super::super::error::{IdentificationError, Result};
use super::super::super::pose::QuaternionJoint;
use super::super::sheet::shortened;
use super::families::{Family, Targets, angles, by_component};
use super::finder::Finder;
use super::found::Found;
use super::header::words;
use super::pattern::Chosen;
use super::table::Kind;

impl Finder<'_> {
    /// Returns the columns of the position of each floating joint.
    ///
    /// # Errors
    /// The errors are those of [`Self::attitudes`].
    pub(super) fn places(&self) -> Result<Vec<Found>> {
        let joints = self.robot.quaternions.iter().filter(|joint| joint.is_floating);
        self.components(Kind::Place, &joints.collect::<Vec<_>>())
    }

    /// Returns the columns of the quaternion of each joint with a quaternion.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if a pose has no columns or two possible sets of columns, if a component is missing,
    /// if a unit does not fit, or if the log has angles instead of quaternions.
    pub(super) fn attitudes(&self) -> Result<Vec<Found>> {
        self.components(Kind::Attitude, &self.robot.quaternions.iter().collect::<Vec<_>>())
    }

    /// Returns the columns of positions and quaternions in the order of the robot's positions.
    pub(super) fn poses(&self, places: Vec<Found>, attitudes: Vec<Found>) -> Vec<Found> {
        let mut places = places.into_iter();
        let joints = self.robot.quaternions.iter().zip(attitudes);
        let of = |(joint, attitude): (&QuaternionJoint, Found)| {
            joint.is_floating.then(|| places.next()).flatten().into_iter().chain([attitude])
        };
        joints.flat_map(of).collect()
    }

    /// Returns the components of a quantity, joint by joint.
    fn components(&self, kind: Kind, joints: &[&QuaternionJoint]) -> Result<Vec<Found>> {
        let letters = kind.row().components;
        if self.robot.quaternions.is_empty() && self.pattern(|k| k == kind).is_some() {
            return Err(self.fault(
                "`--columns` names a place or a quaternion, but this robot has no spherical or floating joint. Remove this part".into(),
            ));
        }
        let targets = joints.iter().map(|joint| Targets::new(&vec![joint.name.clone(); letters.len()], &[]));
        let targets: Vec<Targets> = targets.collect();
        let choices = match self.pattern(|k| k == kind) {
            Some(pattern) => {
                let all: Vec<String> = targets.iter().flat_map(|of| of.names.clone()).collect();
                self.by_pattern(pattern, &Targets::new(&all, &[]))?.split(letters.len())
            }
            None => joints.iter().map(|joint| self.nearest(joint, kind)).collect::<Result<_>>()?,
        };
        choices.into_iter().zip(&targets).map(|(choice, of)| self.found(choice, kind, of)).collect()
    }

    /// Returns the family of columns whose name fits the joint best. Fails if two families fit equally well.
    fn nearest(&self, joint: &QuaternionJoint, kind: Kind) -> Result<Chosen> {
        // If several joints have quaternions, the columns must contain the names of the joints.
        let farthest = if self.robot.quaternions.len() > 1 { 0 } else { 2 };
        let mut near = by_component(&self.headers, kind, &words(&joint.name));
        near.retain(|family| family.meaning.doubt <= farthest);
        near.sort_by_key(|family| (family.complete().is_none(), family.meaning.doubt));
        let Some(first) = near.first() else { return Err(self.no_pose(joint, kind)) };
        let labels = |family: &Family| {
            let labels: Vec<String> =
                family.columns.iter().flatten().map(|column| self.label(*column)).collect();
            labels.join(", ")
        };
        let (what, name) = (kind.singular(), &joint.name);
        let Some(columns) = first.complete() else {
            let letters = kind.row().components.iter().zip(&first.columns);
            let absent: Vec<&str> = letters.filter(|(_, column)| column.is_none()).map(|(l, _)| *l).collect();
            return Err(self.undecided(format!(
                "the {what} of `{name}` has only the columns {}, but {} is missing. Name all {} columns: {}",
                labels(first),
                absent.join(", "),
                first.columns.len(),
                remedy(kind)
            )));
        };
        let is_rival = |other: &&Family| other.meaning == first.meaning && other.complete().is_some();
        match near.iter().skip(1).find(is_rival) {
            Some(other) => Err(self.undecided(format!(
                "both {} and {} could be the {what} of `{name}`. Name the right columns: {}",
                labels(first),
                labels(other),
                remedy(kind)
            ))),
            None => Ok(Chosen::alike(columns, None)),
        }
    }

    fn no_pose(&self, joint: &QuaternionJoint, kind: Kind) -> IdentificationError {
        let (what, name) = (kind.singular(), &joint.name);
        let angles = angles(&self.headers);
        if kind == Kind::Attitude && !angles.is_empty() {
            return self.fault(format!(
                "the log has no quaternion of `{name}`, but {} look like angles. A log does not show the convention of its \
                 angles. Convert them to a quaternion, e.g. by `Rotation.from_euler(…).as_quat()` of scipy, and name the four \
                 columns qx, qy, qz, qw",
                angles.join(", ")
            ));
        }
        let several = if self.robot.quaternions.len() > 1 {
            " (the headers must contain the name of the joint)"
        } else {
            ""
        };
        self.undecided(format!(
            "the log has no columns with a usual name for the {what} ({}) of `{name}`{several}. The columns are: {}. Name \
             the right ones: {}",
            kind.row().components.join(", "),
            shortened(&self.sheet.headers),
            remedy(kind)
        ))
    }
}

fn remedy(kind: Kind) -> &'static str {
    match kind {
        Kind::Attitude => {
            "--columns 'xyzw=a|b|c|d', or 'wxyz=…' if w comes first. Numbers such as `5..8` are also possible"
        }
        _ => "--columns 'place=a|b|c' (numbers such as `2..4` are also possible)",
    }
}
