//! Order statistics, such as medians.

/// Returns the quantile of sorted values, with linear interpolation between the values.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let position = share * (sorted.len() - 1) as f64;
    let (low, fraction) = (position.floor() as usize, position.fract());
    let high = (low + 1).min(sorted.len() - 1);
    sorted[low] + fraction * (sorted[high] - sorted[low])
}

/// Returns the median of the finite values, or the upper one of two middle values; `None` if there are no finite values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Number of values per value that [`span`] leaves out at each end.
const OUTLIERS: usize = 200;

/// Returns the smallest and the largest value without the outermost 0.5 % at both ends; `None` if there are no values.
pub(crate) fn span(mut values: Vec<f64>) -> Option<[f64; 2]> {
    let last = values.len().checked_sub(1)?;
    let cut = values.len() / OUTLIERS;
    Some([cut, last - cut].map(|at| *values.select_nth_unstable_by(at, f64::total_cmp).1))
}

/// Smallest and largest value; infinite if there are no values.
pub(crate) fn extremes(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// Largest magnitude; 0 if there are no values.
pub(crate) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// Returns the mean of the values, and its standard error if the values are independent.
pub(crate) fn mean_with_error(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

/// Returns the index of the model with the smallest error, and the index of the simplest model whose error exceeds the
/// smallest error by at most one standard error (Breiman 1984). Models are ordered from the simplest to the most complex.
/// The result is `None` if there are no models.
///
/// - `errors`: error of each model, with its standard error
pub(crate) fn simplest(errors: &[[f64; 2]]) -> Option<[usize; 2]> {
    let least = (0..errors.len()).min_by(|&i, &j| errors[i][0].total_cmp(&errors[j][0]))?;
    let bound = errors[least][0] + errors[least][1];
    let simplest = errors.iter().position(|[error, _]| *error <= bound).unwrap_or(least);
    Some([least, simplest])
}
