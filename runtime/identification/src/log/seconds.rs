//! Conversion of times to seconds. If no unit is named, the unit follows from the time step.

use super::levels;
use gelenk_findings::{Finding, Rule};

/// Sees: times without a unit, or times with steps of exactly one second.
/// Matters: a wrong unit of the time makes every rate wrong.
/// Example: times with steps of 4, which are read as ms.
/// Fixture: `epoch_times_keep_their_digits` in `log/tests/styles.rs`.
pub(super) const UNIT_ASSUMED: Rule = Rule::note("unit-assumed");

/// Returns the value in s of the unit of times whose unit is not named. Steps up to 0.2 are in s, steps below 100 in ms,
/// steps below 1e5 in µs, and longer steps in ns. If the unit is not s, it also returns a message.
///
/// - `step`: median time step in 10⁻¹² of the unit
pub(super) fn assumed_unit(step: i128) -> (f64, Option<String>) {
    let steps = step as f64 / 1e12;
    let (factor, name) = match steps {
        s if s <= 0.2 => return (1.0, None),
        s if s < 100.0 => (1e-3, "ms"),
        s if s < 1e5 => (1e-6, "µs"),
        _ => (1e-9, "ns"),
    };
    let message = format!(
        "the time has no unit. Its step is {steps}, so the unit is assumed to be {name} (rate {:.6} Hz). --columns 'time=…[s]' \
         sets another unit{}",
        1.0 / (steps * factor),
        if steps == 1.0 {
            ". If the column counts samples, give the period, as in 'time=…[4 ms]'"
        } else {
            ""
        }
    );
    (factor, Some(message))
}

/// Returns a finding if all time steps are exactly one second. Robots are not recorded at such a low rate, but a counter of
/// samples has steps of one.
///
/// - `times`: times in 10⁻¹² of the unit
/// - `unit`: unit of the times in s
pub(super) fn counter_finding(times: &[i128], unit: f64, place: &str) -> Option<Finding> {
    const ONE: i128 = 1_000_000_000_000;
    let counts = unit == 1.0 && times.len() > 1 && times.windows(2).all(|pair| pair[1] - pair[0] == ONE);
    counts.then(|| {
        let message = "all time steps are exactly 1 s. If the column counts samples, give the period, as in --columns \
                       'time=…[4 ms]'";
        UNIT_ASSUMED.found(message).log(place, None)
    })
}

/// Conversion of times to seconds. The seconds count from the beginning of the log if the times count from an epoch,
/// otherwise from 0.
pub(super) struct Clock {
    zero: i128,
    per_second: f64,
}

impl Clock {
    /// Creates the clock of times in 10⁻¹² of a unit of `unit` seconds.
    pub(super) fn new(times: &[i128], unit: f64) -> Self {
        // These powers of ten are exact floating-point numbers. Therefore a quotient by them is the floating-point number
        // that is nearest to the decimal number.
        let exact = [1e12, 1e15, 1e18, 1e21].into_iter().find(|p| (p * unit / 1e12 - 1.0).abs() < 1e-9);
        let per_second = exact.unwrap_or(1e12 / unit);
        let first = times.first().copied().unwrap_or(0);
        let is_epoch = first as f64 / per_second > levels::EPOCH.get();
        Self { zero: if is_epoch { first } else { 0 }, per_second }
    }

    pub(super) fn seconds(&self, time: i128) -> f64 {
        time.saturating_sub(self.zero) as f64 / self.per_second
    }
}
