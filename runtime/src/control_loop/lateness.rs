//! Histogram of the lateness of wake-ups.

use std::fmt;
use std::time::Duration;

/// Number of intervals of the histogram. The last interval begins at 0.26 s, which is longer than every
/// period of the loop ([`RATES`](super::RATES)).
const INTERVALS: usize = 20;
/// Length of the longest bar in characters.
const LONGEST_BAR: u64 = 40;

/// Histogram of the delays with which the loop wakes up at the start of its periods (jitter). The intervals are
/// [0, 1) µs and [2ᵏ⁻¹, 2ᵏ) µs for k = 1, 2, …. The last interval has no upper end. [`fmt::Display`] plots the
/// histogram. The plot has one line for each interval from the first to the last interval with a wake-up.
///
/// ```
/// use gelenk_runtime::control_loop::Lateness;
/// use std::time::Duration;
///
/// let mut lateness = Lateness::default();
/// for microseconds in [0, 3, 3, 3, 3, 9] {
///     lateness.add(Duration::from_micros(microseconds));
/// }
/// let plot = "\
/// below       1 µs        1 ##########
/// below       2 µs        0
/// below       4 µs        4 ########################################
/// below       8 µs        0
/// below      16 µs        1 ##########";
/// assert_eq!(lateness.to_string(), plot);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lateness {
    /// Number of wake-ups in each interval.
    pub counts: [u64; INTERVALS],
}

impl Lateness {
    /// Counts one wake-up.
    pub fn add(&mut self, lateness: Duration) {
        let microseconds = lateness.as_micros();
        let index = (u128::BITS - microseconds.leading_zeros()) as usize;
        self.counts[index.min(INTERVALS - 1)] += 1;
    }

    /// Whether a wake-up was late by 1 µs or more.
    #[must_use]
    pub fn any(&self) -> bool {
        self.counts[1..].iter().any(|count| *count > 0)
    }
}

impl fmt::Display for Lateness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let filled = |&index: &usize| self.counts[index] > 0;
        let (Some(first), Some(last)) = ((0..INTERVALS).find(filled), (0..INTERVALS).rfind(filled)) else {
            return Ok(());
        };
        let most = self.counts.iter().max().copied().unwrap_or(0).max(1);
        for (index, count) in self.counts.iter().enumerate().take(last + 1).skip(first) {
            // Rounding up makes a single wake-up visible in a plot of millions.
            let bar = (u128::from(*count) * u128::from(LONGEST_BAR)).div_ceil(u128::from(most)) as usize;
            let end = if index + 1 < INTERVALS { 1_u64 << index } else { 1 << (index - 1) };
            let side = if index + 1 < INTERVALS { "below" } else { "from " };
            let line = format!("{side} {end:7} µs {count:8} {}", "#".repeat(bar));
            write!(f, "{}{}", if index > first { "\n" } else { "" }, line.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{INTERVALS, Lateness};
    use std::time::Duration;

    #[test]
    fn every_lateness_has_an_interval() {
        let mut lateness = Lateness::default();
        assert_eq!((lateness.to_string(), lateness.any()), (String::new(), false));
        for late in [Duration::ZERO, Duration::from_nanos(999)] {
            lateness.add(late);
        }
        assert!(!lateness.any());
        for late in
            [Duration::from_micros(1), Duration::from_millis(20), Duration::from_secs(1), Duration::MAX]
        {
            lateness.add(late);
        }
        let mut expected = [0; INTERVALS];
        (expected[0], expected[1], expected[15], expected[INTERVALS - 1]) = (2, 1, 1, 2);
        assert_eq!((lateness.counts, lateness.any()), (expected, true));
        assert!(
            lateness
                .to_string()
                .ends_with("from   262144 µs        2 ########################################")
        );
    }
}
