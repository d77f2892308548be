//! Detection of logs whose rows come in bursts, so that their times are times of arrival.

use super::super::error::{Result, at};
use super::super::numeric::statistics::median;
use super::levels;
use gelenk_findings::digits::plain;

/// Fails if the times of a log are times of arrival instead of times of measurement. A network or a buffer delivers such rows
/// in bursts. In a log with times of measurement, pauses are rare. In a log with bursts, there is a pause after each burst.
///
/// # Errors
/// [`IdentificationError::File`](crate::error::IdentificationError::File). The message contains the period with which rows
/// can be counted instead.
pub(super) fn require_steady(parts: &[Vec<usize>], times: &[i128], unit: f64, source: &str) -> Result<()> {
    let pairs = parts.iter().flat_map(|part| part.windows(2));
    let steps: Vec<f64> = pairs.map(|pair| (times[pair[1]] - times[pair[0]]) as f64 * unit / 1e12).collect();
    let usual = median(steps.iter().copied()).unwrap_or(0.0);
    let pauses: Vec<usize> = (0..steps.len()).filter(|i| steps[*i] > levels::BURST.get() * usual).collect();
    let paused: f64 = pauses.iter().map(|i| steps[*i]).sum();
    let is_rare = (pauses.len() as f64) < levels::PAUSES.get() * steps.len() as f64;
    // Only bursts between the first and the last pause are complete.
    let [first, .., last] = pauses[..] else { return Ok(()) };
    if is_rare || 2.0 * paused < steps.iter().sum::<f64>() {
        return Ok(());
    }
    let rows = (last - first) as f64;
    let size = rows / (pauses.len() - 1) as f64;
    let message = format!(
        "the times are times of arrival, because rows come in bursts: {size:.0} rows within {} s, then none for {} s. If rows \
         were recorded at equal intervals, give the period: --columns 'time=row[{} ms]'",
        plain(usual * (size - 1.0), 2),
        plain(paused / pauses.len() as f64, 2),
        plain(1e3 * steps[first + 1..=last].iter().sum::<f64>() / rows, 3)
    );
    Err(at(source).fault(message))
}
