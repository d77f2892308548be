//! Conversion of counted times to seconds: the unit if none is named, and the counts.

use super::levels;
use gelenk_findings::{Finding, Rule};

/// Sees: times without a unit, or times that step by exactly one second.
/// Matters: a wrong unit of the time makes every rate wrong.
/// Example: times that step by 4, taken as ms.
/// Fixture: `epoch_times_keep_their_digits` in `log/tests/styles.rs`.
pub(super) const UNIT_ASSUMED: Rule = Rule::note("unit-assumed");

/// Seconds of a unit that is not named, by the median step. It is assumed that robots are sampled with 5 Hz to 20 kHz.
/// Returns the factor, and a message if the factor is not 1.
///
/// - `step`: median step in 10⁻¹² of the unit
pub(super) fn assumed_unit(step: i128) -> (f64, Option<String>) {
    let steps = step as f64 / 1e12;
    let (factor, name) = match steps {
        s if s <= 0.2 => return (1.0, None),
        s if s < 100.0 => (1e-3, "ms"),
        s if s < 1e5 => (1e-6, "µs"),
        _ => (1e-9, "ns"),
    };
    let message = format!(
        "the time has no unit and steps by {steps}: taken as {name} ({:.6} Hz); --columns 'time=…[s]' sets another unit{}",
        1.0 / (steps * factor),
        if steps == 1.0 { ", and the period of a counter of samples, as in 'time=…[4 ms]'" } else { "" }
    );
    (factor, Some(message))
}

/// A finding if all steps are exactly one second. Robots are not recorded so slowly, but a counter of samples has steps of
/// one.
///
/// - `times`: times in 10⁻¹² of the unit
/// - `unit`: unit of the times [s]
pub(super) fn counter_finding(times: &[i128], unit: f64, place: &str) -> Option<Finding> {
    const ONE: i128 = 1_000_000_000_000;
    let counts = unit == 1.0 && times.len() > 1 && times.windows(2).all(|pair| pair[1] - pair[0] == ONE);
    counts.then(|| {
        let message = "its times step by exactly 1 s: if they are a counter of samples, name the period, as in --columns \
                       'time=…[4 ms]'";
        UNIT_ASSUMED.found(message).log(place, None)
    })
}

/// Conversion of counts to seconds since the beginning of the log if the times have an epoch, otherwise since 0.
pub(super) struct Clock {
    zero: i128,
    per_second: f64,
}

impl Clock {
    /// The clock of times in 10⁻¹² of a unit of `unit` seconds.
    pub(super) fn new(times: &[i128], unit: f64) -> Self {
        // These powers of ten are exact floating-point numbers. A quotient by them is the floating-point number nearest to
        // the decimal number.
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
