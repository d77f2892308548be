//! Detection of rows of zeros, which programs write if they have no values.

use std::ops::Range;

/// Returns the indices of rows that contain only zeros, if positions jump at the beginning and at the end of each block of
/// such rows. A jump is larger than the largest step between any two neighbouring rows with values. A robot that starts or
/// rests at zero does not jump.
///
/// - `columns`: all columns, first those of positions; NaN is a missing value
/// - `is_same_run`: whether a row belongs to the run of the row before
pub(super) fn zero_rows(
    columns: &[Vec<f64>],
    positions: usize,
    is_same_run: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let count = columns.first().map_or(0, Vec::len);
    let is_zero = |row: usize| columns.iter().map(|column| column[row]).all(|x| x == 0.0 || x.is_nan());
    let zero: Vec<bool> = (0..count).map(is_zero).collect();
    let step = |column: &Vec<f64>, row: usize| (column[row] - column[row - 1]).abs();
    let usual = (1..count).filter(|&row| !zero[row] && !zero[row - 1] && is_same_run(row));
    let largest: Vec<f64> = columns[..positions]
        .iter()
        .map(|column| usual.clone().map(|row| step(column, row)).fold(0.0, f64::max))
        .collect();
    let jumps =
        |row: usize| columns.iter().zip(&largest).any(|(column, largest)| step(column, row) > *largest);
    let is_missing = |block: &Range<usize>| {
        let borders =
            [block.start, block.end].into_iter().filter(|&row| 0 < row && row < count && is_same_run(row));
        let jumps: Vec<bool> = borders.map(jumps).collect();
        !jumps.is_empty() && jumps.iter().all(|jumps| *jumps)
    };
    let rows: Vec<usize> = (0..count).filter(|&row| zero[row]).collect();
    let blocks = rows.chunk_by(|a, b| a + 1 == *b).map(|block| block[0]..block[block.len() - 1] + 1);
    blocks.filter(is_missing).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swing(phase: f64) -> Vec<f64> {
        (0..100).map(|i| (0.1 * f64::from(i) + phase).sin()).collect()
    }

    fn found(columns: &[Vec<f64>], runs: usize) -> Vec<usize> {
        zero_rows(columns, 1, |row| row % runs != 0)
    }

    #[test]
    fn rows_without_values_are_found_wherever_they_lie() {
        for missing in [0..3, 50..51, 60..70, 97..100] {
            let mut columns = [swing(1.0), swing(2.0)];
            columns.iter_mut().for_each(|column| column[missing.clone()].fill(0.0));
            assert_eq!(found(&columns, 100), missing.collect::<Vec<_>>());
        }
    }

    #[test]
    fn robots_at_rest_at_zero_have_values() {
        let mut start = swing(0.0);
        start.splice(0..0, [0.0; 5]);
        // The second run begins at zero, but the first run did not end there.
        let mut second = swing(0.0);
        second[50..].copy_from_slice(&swing(0.0)[..50]);
        assert!(found(&[start.clone(), start], 200).is_empty());
        assert!(found(&[second.clone(), second], 50).is_empty());
        assert!(found(&[vec![0.0; 9]], 9).is_empty());
        assert!(found(&[vec![]], 9).is_empty());
    }
}
