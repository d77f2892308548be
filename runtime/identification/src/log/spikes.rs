//! Removal of single efforts far beyond all others: bit errors, and values that a driver writes instead of a missing value.

use super::super::numeric::statistics::quantile;
use super::levels;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: single efforts far beyond all others.
/// Matters: these efforts are not used.
/// Example: a driver writes 999999 if it has no value.
/// Fixture: `spikes` in `codegen/tests/findings/arm.rs`.
const OUTLIER: Rule = Rule::note("outliers");

/// Replaces the spikes of a column by NaN, and returns a finding; `None` if there are no spikes.
///
/// - `lines`: lines of the samples in the file
/// - `label`, `place`: name of the column, name of the file
pub(super) fn leave_out_spikes(
    column: &mut [f64],
    lines: &[usize],
    label: Option<String>,
    place: &str,
) -> Option<Finding> {
    let rows = spikes(column);
    let (first, last) = (*rows.first()?, *rows.last()?);
    let (label, value) = (label?, plain(column[first], 6));
    let message = match rows.len() {
        1 => format!("{label} has 1 effort far beyond all others, {value}. It is left out"),
        n => format!(
            "{label} has {n} efforts far beyond all others. The first is {value}. These efforts are left out"
        ),
    };
    rows.iter().for_each(|row| column[*row] = f64::NAN);
    Some(OUTLIER.found(message).log(place, Some((lines[first], lines[last]))))
}

/// Returns the indices of the spikes of a column.
fn spikes(column: &[f64]) -> Vec<usize> {
    let mut sorted: Vec<f64> = column.iter().copied().filter(|x| x.is_finite()).collect();
    if sorted.is_empty() {
        return Vec::new();
    }
    sorted.sort_unstable_by(f64::total_cmp);
    let outer = 2.0 * levels::MOST_SPIKES.get();
    let [low, high] = [outer, 1.0 - outer].map(|share| quantile(&sorted, share));
    let reach = levels::SPIKE.get() * (high - low);
    if reach <= 0.0 {
        return Vec::new();
    }
    let is_far = |row: &usize| column[*row] > high + reach || column[*row] < low - reach;
    let rows: Vec<usize> = (0..column.len()).filter(is_far).collect();
    let is_short = rows.chunk_by(|a, b| a + 1 == *b).all(|chunk| chunk.len() <= levels::LONGEST_SPIKE.get());
    let are_few = rows.len() as f64 <= (levels::MOST_SPIKES.get() * sorted.len() as f64).max(1.0);
    if is_short && are_few { rows } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swing() -> Vec<f64> {
        (0..1000).map(|i| 20.0 * (0.02 * f64::from(i)).sin()).collect()
    }

    #[test]
    fn single_values_far_beyond_all_others_are_spikes() {
        let mut column = swing();
        assert!(spikes(&column).is_empty());
        (column[100], column[500], column[501]) = (1e5, -999_999.0, f64::NAN);
        assert_eq!(spikes(&column), [100, 500]);
    }

    #[test]
    fn events_motions_and_noise_are_none() {
        let mut collision = swing();
        collision[300..304].fill(900.0);
        let mut short = vec![0.1; 2000];
        for (i, x) in short.iter_mut().enumerate() {
            *x = if (1000..1010).contains(&i) { 30.0 } else { 0.01 * (i as f64).sin() };
        }
        let stuck = vec![3.0; 500];
        for column in [collision, short, stuck, swing()[..50].to_vec()] {
            assert!(spikes(&column).is_empty());
        }
    }
}
