//! What is suspicious in a log.

use std::fmt;

/// Kind of a [`RunFinding`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FindingKind {
    /// A field is absent.
    Missing,
    /// A field is no number.
    NotANumber,
    /// A channel never changes.
    Constant,
    /// A time stands twice.
    Repeated,
    /// A jump like that of an overflowing counter.
    Wrap,
    /// Rows or runs that are not used.
    LeftOut,
    /// Time goes back, a new run begins.
    NewRun,
    /// A unit that nobody names was taken for granted.
    UnitAssumed,
    /// A joint does not move.
    StoodStill,
    /// A single sample far from its neighbours.
    Outlier,
    /// Positions beyond the joint's limits.
    BeyondPosition,
    /// Speeds beyond the joint's limit.
    BeyondSpeed,
    /// Efforts beyond the joint's limit.
    BeyondEffort,
    /// Efforts that look as if they were on the other side of the gears.
    GearDoubtful,
    /// A column of velocities that is not the slope of the positions.
    VelocityDisagrees,
    /// Samples that repeat the values of the ones before.
    Stuck,
    /// Efforts that stand at their largest or smallest value.
    CutOff,
    /// Quaternions that are not quite of unit length.
    NotUnit,
}

/// Something suspicious in a log, or something that was done to it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFinding {
    /// The log's file; none for all of them.
    pub file: Option<String>,
    /// First and last row in the file, as an editor shows them; none where no row is meant.
    pub rows: Option<(usize, usize)>,
    /// Name of the joint or input; none for all of them.
    pub joint: Option<String>,
    /// Kind.
    pub kind: FindingKind,
    /// A sentence with the numbers.
    pub message: String,
}

impl fmt::Display for RunFinding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let rows = match self.rows {
            Some((first, last)) if first == last => Some(format!("row {first}")),
            Some((first, last)) => Some(format!("rows {first} to {last}")),
            None => None,
        };
        let joint = self.joint.as_ref().map(|joint| format!("joint {joint}"));
        let place: Vec<String> = [self.file.clone(), rows, joint].into_iter().flatten().collect();
        let colon = if place.is_empty() { "" } else { ": " };
        write!(f, "{}{colon}{}", place.join(", "), self.message)
    }
}

/// A finding about a whole file, or about rows of it.
pub(super) fn file_finding(
    place: &str,
    rows: Option<(usize, usize)>,
    kind: FindingKind,
    message: String,
) -> RunFinding {
    RunFinding { file: Some(place.into()), rows, joint: None, kind, message }
}
