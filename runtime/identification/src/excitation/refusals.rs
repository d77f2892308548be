//! What keeps motions from being possible, counted for the message of a search that finds none.

use std::cell::RefCell;
use std::collections::BTreeMap;

/// How many motions were refused for what.
#[derive(Default)]
pub(super) struct Refusals {
    counts: RefCell<BTreeMap<String, usize>>,
}

impl Refusals {
    /// Counts a refused motion; its score.
    pub(super) fn refuse(&self, what: &str) -> f64 {
        *self.counts.borrow_mut().entry(what.to_owned()).or_default() += 1;
        f64::INFINITY
    }

    /// Why no motion was found, and what helps.
    pub(super) fn detail(&self) -> String {
        let counts = self.counts.borrow();
        let most = counts.iter().max_by_key(|(_, count)| **count);
        let most = most.map_or_else(String::new, |(what, count)| {
            format!(" (what stood in the way most often, in {count} motions: {what})")
        });
        format!(
            "no motion tried shows all parameters within the efforts of joints and inputs, and within the limits of joints that \
             follow others{most}: raise the efforts, lower the speed, lengthen the period, or narrow the limits of the joints that \
             are followed"
        )
    }
}
