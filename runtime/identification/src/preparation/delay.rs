//! Estimation of the delay between efforts and positions: the delay at which the motion explains the efforts best.

use super::super::numeric::shifted::shifted;
use super::super::run::PreparedRun;
use super::levels;
use super::regression::{Columns, Problem, Sample, problems, spread};
use nalgebra::{DMatrix, DVector};

/// Delay of an effort, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DelayEstimate {
    /// Delay of the effort relative to the positions in s. It is positive if the effort is late.
    pub value: f64,
    /// Standard error in s; infinite if the effort does not show a delay.
    pub error: f64,
    /// Decrease of ln RSS (residual sum of squares) on held-out folds if the effort has its own delay instead of the common
    /// one. The value is zero if the decrease is within two standard errors, or if both delays do not differ significantly.
    pub drop: f64,
}

impl DelayEstimate {
    const UNKNOWN: Self = Self { value: f64::NAN, error: f64::INFINITY, drop: 0.0 };

    /// Returns the delay if it is certainly too large for the linear correction in the common estimate; otherwise zero,
    /// because the common estimate finds the delay.
    pub(super) fn if_far(&self) -> f64 {
        if self.value.abs() - 2.0 * self.error > levels::FAR.get() { self.value } else { 0.0 }
    }
}

/// Delay of each effort, and common delay of all efforts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Delays {
    /// Delay that fits best for all efforts together.
    pub common: DelayEstimate,
    /// Best delay of each effort.
    pub own: Vec<DelayEstimate>,
}

/// Distance in s from an end of the searched range within which a delay counts as lying at that end.
const AT_END: f64 = 1e-4;

/// Finds the delays with the smallest residual sum of squares: one for each effort, and one for all efforts together. The
/// result is `None` if there are too few samples, or if at most half of the efforts show a delay.
///
/// `runs` have smoothed efforts without a removed delay. The standard error is that of a one-step estimator whose scores
/// are summed over blocks (sandwich form; Newey and West 1987 with blocks).
///
/// - `step`: time between samples in s
pub(super) fn estimate(columns: &Columns, runs: &[&PreparedRun], step: f64) -> Option<Delays> {
    let margin = (levels::DELAYS.get()[1] / step).ceil() as usize + 2;
    let samples = spread(runs, levels::DELAY_SAMPLES.get(), margin);
    if samples.len() < 4 * levels::DELAY_BLOCKS.get() {
        return None;
    }
    let problems = problems(columns, runs, &samples);
    let range = levels::USUAL_DELAYS.get();
    let usual = Search { runs, samples: &samples, problems: &problems, step, range };
    let all: Vec<usize> = (0..problems.len()).collect();
    let is_early = |m: &&usize| problems[**m].is_some() && usual.least(&[**m]) <= range[0] + AT_END;
    let early = 2 * all.iter().filter(is_early).count() > all.len();
    let search = if early { Search { range: levels::DELAYS.get(), ..usual } } else { usual };
    let mut own: Vec<DelayEstimate> = all.iter().map(|m| search.own(*m)).collect();
    let known: Vec<usize> = all.into_iter().filter(|m| own[*m].error.is_finite()).collect();
    // More than half of the efforts must show a delay, because an error of the model can imitate the delay of a single
    // effort.
    if 2 * known.len() <= own.len() {
        return None;
    }
    let value = search.least(&known);
    for m in &known {
        let spread = spread_of_others(&own, &known, *m, value);
        let DelayEstimate { value: alone, error, .. } = own[*m];
        let shrunk = value + (alone - value) / (1.0 + (error / spread).powi(2));
        let differs = (alone - value).abs() > 3.0 * error.hypot(spread);
        let drop = if differs { search.held_out_drop(*m, value, shrunk) } else { 0.0 };
        own[*m] = DelayEstimate { value: shrunk, drop, ..own[*m] };
    }
    let error = common_error(&known.iter().map(|m| own[*m]).collect::<Vec<_>>(), value);
    Some(Delays { common: DelayEstimate { value, error, drop: 0.0 }, own })
}

/// Returns the rms difference between the delays of the other efforts and the common delay, in s. It is the expected
/// difference of this effort's delay.
fn spread_of_others(own: &[DelayEstimate], known: &[usize], effort: usize, common: f64) -> f64 {
    let others = known.iter().filter(|m| **m != effort).map(|m| (own[*m].value - common).powi(2));
    let count = (known.len() - 1).max(1) as f64;
    (others.sum::<f64>() / count).sqrt().max(levels::DELAY_SPREAD.get())
}

/// Returns the standard error of the common delay in s. The error is larger if the delays of the efforts disagree (Birge
/// 1932).
fn common_error(own: &[DelayEstimate], common: f64) -> f64 {
    let information: f64 = own.iter().map(|e| e.error.powi(-2)).sum();
    let disagreement: f64 = own.iter().map(|e| ((e.value - common) / e.error).powi(2)).sum();
    let ratio = disagreement / (own.len() as f64 - 1.0).max(1.0);
    (ratio.max(1.0) / information).sqrt()
}

struct Search<'a> {
    runs: &'a [&'a PreparedRun],
    samples: &'a [Sample],
    problems: &'a [Option<Problem>],
    step: f64,
    /// Range of the search in s.
    range: [f64; 2],
}

impl Search<'_> {
    /// Returns effort `m` at the times of the samples plus `delay` (in s), and its time derivative.
    fn effort(&self, m: usize, delay: f64) -> (DVector<f64>, DVector<f64>) {
        let at = |(r, i): &Sample| shifted(&self.runs[*r].efforts[m], *i as f64 + delay / self.step);
        let values: Vec<(f64, f64)> = self.samples.iter().map(at).collect();
        let part =
            |f: &dyn Fn(&(f64, f64)) -> f64| DVector::from_iterator(values.len(), values.iter().map(f));
        (part(&|p| p.0), part(&|p| p.1 / self.step))
    }

    /// Returns ln RSS at each of the `delays`, summed over the efforts `of`.
    fn misfits(&self, of: &[usize], delays: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; delays.len()];
        for m in of {
            let Some(problem) = &self.problems[*m] else { continue };
            let targets: Vec<DVector<f64>> = delays.iter().map(|d| self.effort(*m, *d).0).collect();
            let squares = problem.misfits(&DMatrix::from_columns(&targets));
            for (sum, squares) in sums.iter_mut().zip(squares) {
                *sum += if squares > 0.0 { squares.ln() } else { 0.0 };
            }
        }
        sums
    }

    /// Returns the decrease of ln RSS of an effort between two delays, on held-out folds; zero if it is within two standard
    /// errors.
    fn held_out_drop(&self, m: usize, from: f64, to: f64) -> f64 {
        let Some(problem) = &self.problems[m] else { return 0.0 };
        let targets = [from, to].map(|delay| self.effort(m, delay).0);
        let Some(errors) = problem.held_out(&DMatrix::from_columns(&targets), levels::DELAY_FOLDS.get())
        else {
            return 0.0;
        };
        let gains: Vec<f64> = errors.iter().map(|fold| fold[0] - fold[1]).collect();
        let (gain, count) = (gains.iter().sum::<f64>(), gains.len() as f64);
        let squares: f64 = gains.iter().map(|g| (g - gain / count).powi(2)).sum();
        let deviation = (squares * count / (count - 1.0)).sqrt();
        let total: f64 = errors.iter().map(|fold| fold[0]).sum();
        if gain > 2.0 * deviation && gain < total { -(1.0 - gain / total).ln() } else { 0.0 }
    }

    fn own(&self, m: usize) -> DelayEstimate {
        let value = self.least(&[m]);
        let Some(problem) = &self.problems[m] else { return DelayEstimate::UNKNOWN };
        let (effort, rate) = self.effort(m, value);
        let (residual, rate) = (problem.residual(&effort), problem.residual(&rate));
        let scores: Vec<f64> = residual.iter().zip(&rate).map(|(r, x)| r * x).collect();
        let blocks = scores.chunks(scores.len().div_ceil(levels::DELAY_BLOCKS.get()));
        let spread: f64 = blocks.map(|b| b.iter().sum::<f64>().powi(2)).sum();
        let at_end = value <= self.range[0] + AT_END || value >= self.range[1] - AT_END;
        let error = if at_end { f64::INFINITY } else { spread.sqrt() / rate.norm_squared() };
        let known = error.is_finite() && error > 0.0;
        if known { DelayEstimate { value, error, drop: 0.0 } } else { DelayEstimate::UNKNOWN }
    }

    /// Returns the delay in s with the smallest misfit. The search uses a grid of 4 ms, then a grid of 0.5 ms, and finally
    /// a parabola.
    fn least(&self, of: &[usize]) -> f64 {
        let best = |grid: &[f64]| {
            let misfits = self.misfits(of, grid);
            let index = (0..grid.len()).min_by(|a, b| misfits[*a].total_cmp(&misfits[*b])).unwrap_or(0);
            (index, misfits)
        };
        let [first, last] = self.range;
        let steps = ((last - first) / levels::COARSE_DELAYS.get()).round() as usize;
        let coarse: Vec<f64> = (0..=steps).map(|k| first + levels::COARSE_DELAYS.get() * k as f64).collect();
        let around = coarse[best(&coarse).0];
        let fine: Vec<f64> = (-8..=8).map(|k| around + 5e-4 * f64::from(k)).collect();
        let (index, misfits) = best(&fine);
        let [a, b, c] = [-1, 0, 1].map(|k| misfits[index.saturating_add_signed(k).min(fine.len() - 1)]);
        let curvature = a - 2.0 * b + c;
        let shift = if curvature > 0.0 { 0.5 * (a - c) / curvature } else { 0.0 };
        (fine[index] + 5e-4 * shift.clamp(-0.5, 0.5)).clamp(self.range[0], self.range[1])
    }
}
