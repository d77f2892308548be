//! The delay between efforts and positions, found where the motion explains the efforts best.

use super::super::run::PreparedRun;
use super::regression::{Columns, Problem, Sample, problems, spread};
use nalgebra::DVector;

/// A delay and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DelayEstimate {
    /// Efforts come this much later than positions [s].
    pub value: f64,
    /// Standard error [s]; infinite where the efforts do not show a delay.
    pub error: f64,
    /// Fall of the logarithm of the residual sum of squares: from no delay for the common one, from the common delay
    /// for an effort's own.
    pub drop: f64,
}

impl DelayEstimate {
    const UNKNOWN: Self = Self { value: f64::NAN, error: f64::INFINITY, drop: 0.0 };
}

/// Delays of each effort, and the one that serves all of them best.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Delays {
    /// For all efforts together.
    pub common: DelayEstimate,
    /// For each effort by itself.
    pub own: Vec<DelayEstimate>,
}

/// Smallest and largest delay looked for [s]; negative where positions are the late ones.
pub(super) const RANGE: [f64; 2] = [-0.02, 0.08];

/// Samples in the regression, at most.
const SAMPLES: usize = 2000;

/// Blocks of consecutive samples, for a standard error that holds under correlated residuals.
const BLOCKS: usize = 16;

/// Delay of each effort whose residual sum of squares is least, and the common one.
///
/// `runs` have undelayed efforts, smoothed. The standard error is that of a one-step estimator with scores summed
/// over blocks (the sandwich form; Newey and West 1987 with blocks).
pub(super) fn estimate(columns: &Columns, runs: &[&PreparedRun], step: f64) -> Option<Delays> {
    let margin = (RANGE[1] / step).ceil() as usize + 2;
    let samples = spread(runs, SAMPLES, margin);
    if samples.len() < 4 * BLOCKS {
        return None;
    }
    let problems = problems(columns, runs, &samples);
    let search = Search { runs, samples: &samples, problems: &problems, step };
    let own: Vec<DelayEstimate> = (0..problems.len()).map(|m| search.own(m)).collect();
    let known: Vec<usize> = (0..own.len()).filter(|m| own[*m].error.is_finite()).collect();
    // Most efforts have to show a delay: one alone may be the model's error.
    if 2 * known.len() <= own.len() {
        return None;
    }
    let sum = |d: f64| known.iter().map(|m| search.misfit(*m, d)).sum::<f64>();
    let value = search.least(&sum);
    let drop = |d: f64, to: f64, m: usize| search.misfit(m, d) - search.misfit(m, to);
    let mut own = own;
    for (m, estimate) in own.iter_mut().enumerate().filter(|(_, e)| e.error.is_finite()) {
        estimate.drop = drop(value, estimate.value, m);
    }
    let error = common_error(&known.iter().map(|m| own[*m]).collect::<Vec<_>>(), value);
    let common = DelayEstimate { value, error, drop: (sum(0.0) - sum(value)) / known.len() as f64 };
    Some(Delays { common, own })
}

/// Standard error of the common delay, widened where the efforts' own delays disagree (Birge 1932).
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
}

impl Search<'_> {
    /// Effort `m` at the samples' times plus `delay`, and its time derivative.
    fn effort(&self, m: usize, delay: f64) -> (DVector<f64>, DVector<f64>) {
        let at = |(r, i): &Sample| shifted(&self.runs[*r].efforts[m], *i as f64 + delay / self.step);
        let values: Vec<(f64, f64)> = self.samples.iter().map(at).collect();
        let part =
            |f: &dyn Fn(&(f64, f64)) -> f64| DVector::from_iterator(values.len(), values.iter().map(f));
        (part(&|p| p.0), part(&|p| p.1 / self.step))
    }

    /// `log` of the residual sum of squares of effort `m`; 0 where there is nothing to explain.
    fn misfit(&self, m: usize, delay: f64) -> f64 {
        let Some(problem) = &self.problems[m] else { return 0.0 };
        let squares = problem.misfit(&self.effort(m, delay).0);
        if squares > 0.0 { squares.ln() } else { 0.0 }
    }

    fn own(&self, m: usize) -> DelayEstimate {
        let value = self.least(&|d| self.misfit(m, d));
        let Some(problem) = &self.problems[m] else { return DelayEstimate::UNKNOWN };
        let (effort, rate) = self.effort(m, value);
        let (residual, rate) = (problem.residual(&effort), problem.residual(&rate));
        let scores: Vec<f64> = residual.iter().zip(&rate).map(|(r, x)| r * x).collect();
        let blocks = scores.chunks(scores.len().div_ceil(BLOCKS));
        let spread: f64 = blocks.map(|b| b.iter().sum::<f64>().powi(2)).sum();
        let at_end = value <= RANGE[0] + 1e-4 || value >= RANGE[1] - 1e-4;
        let error = if at_end { f64::INFINITY } else { spread.sqrt() / rate.norm_squared() };
        let known = error.is_finite() && error > 0.0;
        if known { DelayEstimate { value, error, drop: 0.0 } } else { DelayEstimate::UNKNOWN }
    }

    /// The delay with the least value: the best of a grid of 4 ms, refined by golden sections.
    fn least(&self, misfit: &dyn Fn(f64) -> f64) -> f64 {
        let grid = (0..=25).map(|k| RANGE[0] + 4e-3 * f64::from(k));
        let best = grid.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b))).unwrap_or(0.0);
        let (mut low, mut high) = ((best - 4e-3).max(RANGE[0]), (best + 4e-3).min(RANGE[1]));
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        while high - low > 5e-5 {
            let (left, right) = (high - golden * (high - low), low + golden * (high - low));
            if misfit(left) <= misfit(right) { high = right } else { low = left }
        }
        0.5 * (low + high)
    }
}

/// Value and slope (by sample) at a fractional index, by the cubic through the four nearest samples.
fn shifted(signal: &[f64], index: f64) -> (f64, f64) {
    let i = (index.floor() as usize).clamp(1, signal.len().saturating_sub(3).max(1));
    let x = index - i as f64;
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| signal[(i + k).saturating_sub(1).min(signal.len() - 1)]);
    let (c1, c2) = (c - a / 3.0 - b / 2.0 - d / 6.0, 0.5 * (a + c) - b);
    let c3 = (d - a) / 6.0 + 0.5 * (b - c);
    (b + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + 3.0 * c3 * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_follow_cubics() {
        let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 0.1 * x * x * x;
        let slope = |x: f64| -1.0 + x - 0.3 * x * x;
        let signal: Vec<f64> = (0..10).map(|i| cubic(f64::from(i))).collect();
        for x in [1.0, 2.3, 5.75, 7.9] {
            let (value, rate) = shifted(&signal, x);
            assert!((value - cubic(x)).abs() < 1e-12 && (rate - slope(x)).abs() < 1e-12, "{x}");
        }
    }
}
