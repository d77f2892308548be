//! Table of hypotheses about faults of the log or of the description. Each row is a kind of change that may explain the efforts
//! better. Another fit tests each change. A change is offered as a remedy only if it
//! lowers the error on held-out data clearly ([`Case::offered`]).

use super::super::error::Result;
use super::factors::OTHER_FACTOR;
use super::gravity::OTHER_GRAVITY;
use super::orders::OTHER_ORDER;
use super::other_delay::OTHER_DELAY;
use super::springs::OTHER_STIFFNESS;
use super::tilt::TILTED;
use super::trial::{Bodies, Case, Change, FALL, Hypothesis};
use super::under_load::FRICTION_UNDER_LOAD;
use super::unit::COMMON_FACTOR;
use gelenk_findings::{Finding, Rule};

const TABLE: [Hypothesis; 7] =
    [OTHER_GRAVITY, TILTED, OTHER_FACTOR, OTHER_ORDER, OTHER_STIFFNESS, OTHER_DELAY, FRICTION_UNDER_LOAD];

/// Hypothesis that all efforts are in another unit. Its finding is only a part of the finding about the ratio of estimated to
/// described forces.
const UNITS: Hypothesis =
    Hypothesis { bodies: Bodies::Described, ..Hypothesis::of(COMMON_FACTOR, units, other_unit) };

/// Decrease of the held-out error by the change that a finding offers, in percent.
fn fall(doubt: &Finding) -> f64 {
    doubt.value(FALL).unwrap_or(0.0)
}

impl Case<'_> {
    /// Tries the hypotheses of all rows of the table, and returns the findings about the changes that are offered.
    pub(super) fn doubts(&self) -> Result<Vec<Finding>> {
        let mut doubts = self.signs()?;
        for row in &TABLE {
            if !(row.when)(self, &doubts) {
                continue;
            }
            let most = doubts.iter().map(fall).fold(0.0, f64::max);
            let mut found = self.offered(row)?;
            found.retain(|doubt| !row.is_alone || fall(doubt) > most);
            if row.is_alone && !found.is_empty() {
                doubts.clear();
            }
            doubts.extend(found);
        }
        Ok(doubts)
    }

    /// The finding that all efforts are in another unit; `None` if the described bodies do not explain the efforts better in
    /// any other unit.
    pub(super) fn unit(&self) -> Result<Option<Finding>> {
        Ok(self.offered(&UNITS)?.pop())
    }
}

fn units(case: &Case) -> Result<Vec<Change>> {
    Ok(case.ratio.iter().flat_map(|ratio| ratio.units()).copied().map(Change::Unit).collect())
}

fn other_unit(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let Change::Unit(name) = change else { return Ok(None) };
    Ok(case.ratio.map(|ratio| ratio.finding(Some(name), rule)))
}
