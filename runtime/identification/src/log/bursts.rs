//! Detection of rows that come in bursts. Their times are times of arrival.

use super::super::error::{Result, at};
use super::super::numeric::statistics::median;
use super::levels;
use gelenk_findings::digits::plain;

/// Fails if times are times of arrival: rows that a network or a buffer delivers in bursts were recorded at other times. A
/// recording has few pauses, but bursts have a pause between each two of them.
///
/// # Errors
/// [`IdentificationError::File`](crate::error::IdentificationError::File), with the period by which rows can be counted
/// instead.
pub(super) fn require_steady(parts: &[Vec<usize>], times: &[i128], unit: f64, source: &str) -> Result<()> {
    let pairs = parts.iter().flat_map(|part| part.windows(2));
    let steps: Vec<f64> = pairs.map(|pair| (times[pair[1]] - times[pair[0]]) as f64 * unit / 1e12).collect();
    let usual = median(steps.iter().copied()).unwrap_or(0.0);
    let pauses: Vec<usize> = (0..steps.len()).filter(|i| steps[*i] > levels::BURST.get() * usual).collect();
    let paused: f64 = pauses.iter().map(|i| steps[*i]).sum();
    let is_rare = (pauses.len() as f64) < levels::PAUSES.get() * steps.len() as f64;
    // Whole bursts lie between the first and the last pause.
    let [first, .., last] = pauses[..] else { return Ok(()) };
    if is_rare || 2.0 * paused < steps.iter().sum::<f64>() {
        return Ok(());
    }
    let rows = (last - first) as f64;
    let size = rows / (pauses.len() - 1) as f64;
    let message = format!(
        "rows come in bursts, {size:.0} within {} s and then none for {} s: these are times of arrival. If rows were recorded at equal \
         times, give the period: --columns 'time=row[{} ms]'",
        plain(usual * (size - 1.0), 2),
        plain(paused / pauses.len() as f64, 2),
        plain(1e3 * steps[first + 1..=last].iter().sum::<f64>() / rows, 3)
    );
    Err(at(source).fault(message))
}
