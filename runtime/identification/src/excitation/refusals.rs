//! Reasons for which motions were rejected, counted for the message of a search without a result.

use gelenk_findings::counted;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Number of rejected motions, by reason.
#[derive(Default)]
pub(super) struct Refusals {
    counts: RefCell<BTreeMap<String, usize>>,
}

impl Refusals {
    /// Counts a rejected motion. Returns the score of a rejected motion, which is infinite.
    pub(super) fn refuse(&self, what: &str) -> f64 {
        *self.counts.borrow_mut().entry(what.to_owned()).or_default() += 1;
        f64::INFINITY
    }

    /// Text with the reason for which no motion was found, and a remedy.
    ///
    /// - `at_rest`: limits that the robot exceeds even at rest
    pub(super) fn detail(&self, at_rest: &[String]) -> String {
        let counts = self.counts.borrow();
        let most = counts.iter().max_by_key(|(_, count)| **count);
        let most = most.map_or_else(String::new, |(what, count)| {
            format!(". Most frequent reason ({}): {what}", counted(*count, "motion", "motions"))
        });
        if !at_rest.is_empty() {
            return format!(
                "holding the robot still at the middle of its position limits needs more effort than the plan may use, at {}. \
                 Raise the effort limits or --effort-share, or narrow the position limits to postures that need less effort",
                at_rest.join(", ")
            );
        }
        format!(
            "no motion within the limits determines all parameters, even at a tenth of the size that the position limits allow. \
             The effort limits and the limits of following joints were checked{most}. Raise the effort limits or --seconds, lower \
             --speed-share, or narrow the position limits of the joints that others follow"
        )
    }
}
