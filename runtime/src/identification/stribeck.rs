//! Regression of the five-parameter Stribeck law `τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)`.
//!
//! Starts are found on binned data, where (a1, a2, a4) follow from (a3, a5) by linear least squares and
//! Levenberg–Marquardt costs microseconds; the best one is refined on all samples with one pass per iteration.

use super::error::{
    IdentificationError, Result, require_finite, require_length, require_samples, require_setting,
};
use super::kernel::{BLOCK, add_products, stribeck_block};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Dyn, Matrix3, OMatrix, OVector, Owned, SMatrix, SVector, U5, Vector3, Vector5};
use statrs::distribution::{ContinuousCDF, StudentsT};

pub(super) const NAMES: [&str; 5] = ["a1", "a2", "a3", "a4", "a5"];
const BINS: usize = 400;

/// The law's value at velocity `v` [N·m or N].
pub fn stribeck_torque(v: f64, a: &[f64; 5]) -> f64 {
    a[0] * v + a[1] * (a[2] * v).tanh() + a[3] * (-a[4] * v.abs()).exp() * (3.0 * a[2] * v).tanh()
}

/// Weights against outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Robustness {
    /// Least squares.
    None,
    /// Huber's weights `min(1, k s/|r|)`; k = 1.345 keeps 95 % of the efficiency under normal errors.
    Huber(f64),
}

/// Settings of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckRegression {
    /// How many of the best starts are refined on the binned data.
    pub starts: usize,
    /// Weights against outliers.
    pub robustness: Robustness,
    /// Limit of the passes over all samples, for each set of weights.
    pub max_iterations: usize,
    /// The refinement ends when a step lowers the cost by less than this share.
    pub tolerance: f64,
}

impl Default for StribeckRegression {
    fn default() -> Self {
        Self {
            starts: 3,
            robustness: Robustness::None,
            max_iterations: 100,
            tolerance: 1e-13,
        }
    }
}

/// Result of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct StribeckFit {
    /// a1 … a5 [N·m·s/rad, N·m, s/rad, N·m, s/rad].
    pub parameters: [f64; 5],
    /// Covariance of the parameters for independent errors; rows and columns of parameters that are not
    /// identifiable are zero, see [`Self::standard_errors`].
    pub covariance: SMatrix<f64, 5, 5>,
    /// Standard errors; `None` where a parameter is not identifiable from these data.
    pub standard_errors: [Option<f64>; 5],
    /// Residual variance σ² [(N·m)²].
    pub variance: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Condition number of the sensitivities, columns scaled.
    pub condition: f64,
    /// Passes over all samples.
    pub iterations: usize,
    /// Whether the iteration reached its tolerance; if not, a warning says so.
    pub converged: bool,
    /// Doubts about the parameters, with numbers.
    pub warnings: Vec<String>,
}

impl StribeckRegression {
    /// Fits the law.
    ///
    /// - `velocities`, `torques`: m samples [rad/s, N·m]; `weights`: m or none
    ///
    /// # Errors
    /// Fewer than six samples, values that are not finite, or constant velocity. Parameters that run away end with a warning.
    pub fn fit(
        &self,
        velocities: &[f64],
        torques: &[f64],
        weights: Option<&[f64]>,
    ) -> Result<StribeckFit> {
        self.check(velocities, torques, weights)?;
        let bins = Bins::new(velocities, torques, weights);
        let start = bins.best_start(self.starts.max(1))?;
        let data = Data {
            v: velocities,
            torque: torques,
        };
        let mut state = data.refine(start, weights, self);
        if let Robustness::Huber(k) = self.robustness {
            state = data.reweighted(state, weights, k, self);
        }
        Ok(summarize(&data, state))
    }

    fn check(&self, v: &[f64], torque: &[f64], weights: Option<&[f64]>) -> Result<()> {
        require_samples("the Stribeck law with five parameters", 6, v.len())?;
        require_length("torques", v.len(), torque.len())?;
        require_finite("the velocity", v)?;
        require_finite("the torque", torque)?;
        if let Some(weights) = weights {
            require_length("weights", v.len(), weights.len())?;
            require_finite("the weights", weights)?;
            let least = weights.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            require_setting(
                "least weight",
                least,
                least >= 0.0,
                "weights must not be negative",
            )?;
        }
        if let Robustness::Huber(k) = self.robustness {
            require_setting("Huber's k", k, k > 0.0, "it must be positive")?;
        }
        if v.iter().all(|x| *x == v[0]) {
            return Err(IdentificationError::Constant {
                what: "the velocity".into(),
                value: v[0],
                samples: v.len(),
            });
        }
        Ok(())
    }
}

impl StribeckFit {
    /// The law at velocity `v`.
    pub fn torque(&self, v: f64) -> f64 {
        stribeck_torque(v, &self.parameters)
    }

    /// Confidence interval of each parameter at `level` (e.g. 0.95); `None` where not identifiable.
    ///
    /// # Errors
    /// A level outside (0, 1).
    pub fn confidence_intervals(&self, level: f64) -> Result<[Option<[f64; 2]>; 5]> {
        let t = self.quantile(level)?;
        Ok(std::array::from_fn(|i| {
            self.standard_errors[i]
                .map(|s| [self.parameters[i] - t * s, self.parameters[i] + t * s])
        }))
    }

    /// Half widths at velocity `v`: of the confidence band of the law, and of the prediction band of a new sample.
    ///
    /// # Errors
    /// A level outside (0, 1).
    pub fn half_widths(&self, v: f64, level: f64) -> Result<[f64; 2]> {
        let t = self.quantile(level)?;
        let mut columns = [[0.0; BLOCK]; 6];
        stribeck_block(&[v], &[0.0], &self.parameters, &mut columns);
        let g = Vector5::from_fn(|i, _| columns[i][0]);
        let law = g.dot(&(self.covariance * g)).max(0.0);
        Ok([t * law.sqrt(), t * (law + self.variance).sqrt()])
    }

    /// The law as coefficients of expressions in `v`, as friction terms of a description.
    pub fn terms(&self) -> Vec<(String, f64)> {
        let [a1, a2, a3, a4, a5] = self.parameters;
        vec![
            ("v".into(), a1),
            (format!("tanh({a3:?}*v)"), a2),
            (format!("exp(-{a5:?}*abs(v))*tanh({:?}*v)", 3.0 * a3), a4),
        ]
    }

    fn quantile(&self, level: f64) -> Result<f64> {
        require_setting(
            "level",
            level,
            level > 0.0 && level < 1.0,
            "it must lie between 0 and 1",
        )?;
        let distribution = StudentsT::new(0.0, 1.0, self.freedom.max(1) as f64).map_err(|e| {
            IdentificationError::Setting {
                name: "degrees of freedom".into(),
                value: self.freedom as f64,
                requirement: e.to_string(),
            }
        })?;
        Ok(distribution.inverse_cdf(0.5 * (1.0 + level)))
    }
}

/// Means over bins of velocity, finer towards zero, where the law bends.
struct Bins {
    v: Vec<f64>,
    torque: Vec<f64>,
    root_weight: Vec<f64>,
    fastest: f64,
}

impl Bins {
    fn new(v: &[f64], torque: &[f64], weights: Option<&[f64]>) -> Self {
        let fastest = v.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut sums = vec![[0.0; 3]; BINS];
        let (half, scale) = (0.5 * BINS as f64, 0.499_999 * BINS as f64 / fastest.sqrt());
        for i in 0..v.len() {
            let w = weights.map_or(1.0, |w| w[i]);
            let position = half + v[i].abs().sqrt().copysign(v[i]) * scale;
            let sum = &mut sums[(position as usize).min(BINS - 1)];
            *sum = [sum[0] + w, sum[1] + w * v[i], sum[2] + w * torque[i]];
        }
        sums.retain(|s| s[0] > 0.0);
        Self {
            v: sums.iter().map(|s| s[1] / s[0]).collect(),
            torque: sums.iter().map(|s| s[2] / s[0]).collect(),
            root_weight: sums.iter().map(|s| s[0].sqrt()).collect(),
            fastest,
        }
    }

    /// Best of a grid over (a3, a5), the best `count` of them refined.
    fn best_start(&self, count: usize) -> Result<[f64; 5]> {
        let mut grid = Vec::new();
        for i in 0..8 {
            for j in 0..6 {
                // In units of the fastest velocity: steps 2 to 400 times, decays 1 to 100 times steeper than it.
                let a3 = 2.0 * 200f64.powf(f64::from(i) / 7.0) / self.fastest;
                let a5 = 100f64.powf(f64::from(j) / 5.0) / self.fastest;
                grid.extend(self.linear_part(a3, a5));
            }
        }
        grid.sort_by(|a, b| a.1.total_cmp(&b.1));
        let refined = grid
            .iter()
            .take(count)
            .map(|(a, cost)| self.refine(*a, *cost));
        refined
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(a, _)| a)
            .ok_or_else(|| IdentificationError::NotConverged {
                what: "the search for starts".into(),
                iterations: 48,
                detail: format!(
                    "no finite cost on {} bins up to {} rad/s",
                    self.v.len(),
                    self.fastest
                ),
            })
    }

    /// Least squares of (a1, a2, a4) for given (a3, a5), slightly damped so that few bins are enough.
    fn linear_part(&self, a3: f64, a5: f64) -> Option<([f64; 5], f64)> {
        let (mut h, mut g, mut energy) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
        for ((v, torque), w) in self.v.iter().zip(&self.torque).zip(&self.root_weight) {
            let row = Vector3::new(
                *v,
                (a3 * v).tanh(),
                (-a5 * v.abs()).exp() * (3.0 * a3 * v).tanh(),
            ) * *w;
            h += row * row.transpose();
            g += row * (w * torque);
            energy += (w * torque).powi(2);
        }
        for i in 0..3 {
            h[(i, i)] *= 1.0 + 1e-9;
        }
        let x = h.cholesky()?.solve(&g);
        let cost = energy - g.dot(&x);
        cost.is_finite()
            .then_some(([x[0], x[1], a3, x[2], a5], cost))
    }

    fn refine(&self, start: [f64; 5], cost: f64) -> ([f64; 5], f64) {
        let [a1, a2, a3, a4, a5] = start;
        let problem = BinnedProblem {
            bins: self,
            p: Vector5::new(a1, a2, a3.ln(), a4, a5.ln()),
        };
        let (problem, report) = LevenbergMarquardt::new()
            .with_patience(20)
            .minimize(problem);
        let a = problem.parameters();
        let better =
            report.objective_function.is_finite() && 2.0 * report.objective_function <= cost;
        if better && a.iter().all(|a| a.is_finite()) {
            (a, 2.0 * report.objective_function)
        } else {
            (start, cost)
        }
    }
}

/// Binned residuals over (a1, a2, ln a3, a4, ln a5): the logarithms keep both rates positive.
struct BinnedProblem<'a> {
    bins: &'a Bins,
    p: Vector5<f64>,
}

impl BinnedProblem<'_> {
    fn parameters(&self) -> [f64; 5] {
        [
            self.p[0],
            self.p[1],
            self.p[2].exp(),
            self.p[3],
            self.p[4].exp(),
        ]
    }

    fn columns(&self) -> Vec<[f64; 6]> {
        let a = self.parameters();
        let mut columns = [[0.0; BLOCK]; 6];
        let mut rows = Vec::with_capacity(self.bins.v.len());
        for (v, torque) in self
            .bins
            .v
            .chunks(BLOCK)
            .zip(self.bins.torque.chunks(BLOCK))
        {
            stribeck_block(v, torque, &a, &mut columns);
            rows.extend((0..v.len()).map(|i| columns.map(|c| c[i])));
        }
        rows
    }
}

impl LeastSquaresProblem<f64, Dyn, U5> for BinnedProblem<'_> {
    type ParameterStorage = Owned<f64, U5>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U5>;

    fn set_params(&mut self, p: &Vector5<f64>) {
        self.p = *p;
    }

    fn params(&self) -> Vector5<f64> {
        self.p
    }

    fn residuals(&self) -> Option<OVector<f64, Dyn>> {
        let rows = self.columns();
        Some(OVector::<f64, Dyn>::from_fn_generic(
            Dyn(rows.len()),
            nalgebra::U1,
            |i, _| -rows[i][5] * self.bins.root_weight[i],
        ))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U5>> {
        let (rows, a) = (self.columns(), self.parameters());
        Some(OMatrix::<f64, Dyn, U5>::from_fn_generic(
            Dyn(rows.len()),
            U5,
            |i, j| {
                let chain = if j == 2 || j == 4 { a[j] } else { 1.0 };
                rows[i][j] * chain * self.bins.root_weight[i]
            },
        ))
    }
}

struct Data<'a> {
    v: &'a [f64],
    torque: &'a [f64],
}

/// Cost Σ w r², JᵀW J and JᵀW r at one point.
#[derive(Clone, Copy)]
struct Normal {
    a: [f64; 5],
    cost: f64,
    h: SMatrix<f64, 5, 5>,
    g: SVector<f64, 5>,
    iterations: usize,
    converged: bool,
}

impl Data<'_> {
    /// One pass over the samples.
    fn normal(&self, a: [f64; 5], weights: Option<&[f64]>) -> Normal {
        let mut sums = [0.0; 36];
        let mut columns = [[0.0; BLOCK]; 6];
        for start in (0..self.v.len()).step_by(BLOCK) {
            let rows = start..self.v.len().min(start + BLOCK);
            stribeck_block(
                &self.v[rows.clone()],
                &self.torque[rows.clone()],
                &a,
                &mut columns,
            );
            if let Some(weights) = weights {
                for column in &mut columns {
                    for (c, w) in column.iter_mut().zip(&weights[rows.clone()]) {
                        *c *= w.sqrt();
                    }
                }
            }
            let n = rows.len();
            let [c1, c2, c3, c4, c5, r] = &columns;
            add_products(
                &[&c1[..n], &c2[..n], &c3[..n], &c4[..n], &c5[..n], &r[..n]],
                &mut sums,
            );
        }
        Normal {
            a,
            cost: sums[35],
            h: SMatrix::from_fn(|i, j| sums[i.max(j) * 6 + i.min(j)]),
            g: SVector::from_fn(|i, _| sums[30 + i]),
            iterations: 1,
            converged: false,
        }
    }

    /// Levenberg–Marquardt on the 5 × 5 normal equations, damping in units of the diagonal.
    fn refine(
        &self,
        start: [f64; 5],
        weights: Option<&[f64]>,
        settings: &StribeckRegression,
    ) -> Normal {
        let mut best = self.normal(start, weights);
        // What rounding in the residuals leaves of the cost where the law fits exactly.
        let floor = 1e-28 * self.torque.iter().map(|t| t * t).sum::<f64>();
        // The start comes from the same data, binned: nearly undamped steps succeed at once.
        let mut damping = 1e-8;
        let mut passes = 1;
        while passes < settings.max_iterations {
            let Some(step) = damped_step(&best, damping) else {
                damping = damping.max(1e-8) * 100.0;
                passes += 1;
                continue;
            };
            let a: [f64; 5] = std::array::from_fn(|i| best.a[i] + step[i]);
            // Predicted decrease below the rounding of the cost: nothing is left to gain.
            let expected = step.dot(&best.g);
            if expected <= settings.tolerance * best.cost + floor {
                return Normal {
                    iterations: passes,
                    converged: true,
                    ..best
                };
            }
            if damping > 1e12 {
                break;
            }
            let trial = if a[2] > 0.0 && a[4] > 0.0 {
                Some(self.normal(a, weights))
            } else {
                None
            };
            passes += 1;
            match trial {
                Some(trial) if trial.cost <= best.cost => {
                    damping = (damping / 10.0).max(1e-12);
                    best = trial;
                }
                _ => damping *= 10.0,
            }
        }
        Normal {
            iterations: passes,
            ..best
        }
    }

    fn residual(&self, i: usize, a: &[f64; 5]) -> f64 {
        self.torque[i] - stribeck_torque(self.v[i], a)
    }

    /// Iteratively reweighted least squares with the scale from the median absolute residual.
    fn reweighted(
        &self,
        mut state: Normal,
        given: Option<&[f64]>,
        k: f64,
        settings: &StribeckRegression,
    ) -> Normal {
        let m = self.v.len();
        for _ in 0..50 {
            let residuals: Vec<f64> = (0..m).map(|i| self.residual(i, &state.a).abs()).collect();
            let mut sorted = residuals.clone();
            let scale = 1.4826 * *sorted.select_nth_unstable_by(m / 2, f64::total_cmp).1;
            if scale == 0.0 {
                return state;
            }
            let weight =
                |i: usize| given.map_or(1.0, |w| w[i]) * (k * scale / residuals[i].max(k * scale));
            let weights: Vec<f64> = (0..m).map(weight).collect();
            let before = state;
            state = self.refine(before.a, Some(&weights), settings);
            state.iterations += before.iterations;
            let moved =
                (0..5).map(|i| (state.a[i] - before.a[i]).abs() / (before.a[i].abs() + 1e-12));
            if moved.fold(0.0, f64::max) < 1e-7 {
                break;
            }
        }
        state
    }
}

fn damped_step(normal: &Normal, damping: f64) -> Option<SVector<f64, 5>> {
    // A parameter without influence has a zero diagonal; a one keeps its step at zero.
    let d = normal
        .h
        .diagonal()
        .map(|h| if h > 0.0 { h.sqrt() } else { 1.0 });
    let mut scaled = SMatrix::<f64, 5, 5>::from_fn(|i, j| normal.h[(i, j)] / (d[i] * d[j]));
    for i in 0..5 {
        scaled[(i, i)] = scaled[(i, i)].max(1e-12) + damping;
    }
    let z = scaled.cholesky()?.solve(&normal.g.component_div(&d));
    Some(z.component_div(&d))
}

fn summarize(data: &Data, state: Normal) -> StribeckFit {
    let freedom = data.v.len() - 5;
    let variance = state.cost / freedom as f64;
    let d = state
        .h
        .diagonal()
        .map(|h| if h > 0.0 { h.sqrt() } else { 1.0 });
    let scaled = SMatrix::<f64, 5, 5>::from_fn(|i, j| state.h[(i, j)] / (d[i] * d[j]));
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut inverse = SMatrix::<f64, 5, 5>::zeros();
    let mut lost = [false; 5];
    for k in 0..5 {
        let direction = eigen.eigenvectors.column(k);
        if eigen.eigenvalues[k] > 1e-10 * largest {
            inverse += direction * direction.transpose() / eigen.eigenvalues[k];
        } else {
            (0..5)
                .filter(|&i| direction[i].abs() > 0.1)
                .for_each(|i| lost[i] = true);
        }
    }
    let covariance = SMatrix::from_fn(|i, j| {
        if lost[i] || lost[j] {
            0.0
        } else {
            variance * inverse[(i, j)] / (d[i] * d[j])
        }
    });
    let standard_errors =
        std::array::from_fn(|i| (!lost[i]).then(|| covariance[(i, i)].max(0.0).sqrt()));
    let least = eigen.eigenvalues.min().max(0.0);
    let mut fit = StribeckFit {
        parameters: state.a,
        covariance,
        standard_errors,
        variance,
        freedom,
        condition: if least > 0.0 {
            (largest / least).sqrt()
        } else {
            f64::INFINITY
        },
        iterations: state.iterations,
        converged: state.converged,
        warnings: Vec::new(),
    };
    fit.warnings = warnings(&fit, data);
    fit
}

fn warnings(fit: &StribeckFit, data: &Data) -> Vec<String> {
    let mut warnings = Vec::new();
    let a = &fit.parameters;
    if !fit.converged {
        warnings.push(format!(
            "no convergence in {} passes: some parameters run away",
            fit.iterations
        ));
    }
    for i in 0..5 {
        match fit.standard_errors[i] {
            None => warnings.push(format!(
                "{} is not identifiable: the data do not depend on it",
                NAMES[i]
            )),
            Some(s) if s > 0.5 * a[i].abs() => {
                warnings.push(format!(
                    "{} = {:.4} has a standard error of {s:.4}",
                    NAMES[i], a[i]
                ));
            }
            Some(_) => {}
        }
        for j in 0..i {
            let c =
                fit.covariance[(i, j)] / (fit.covariance[(i, i)] * fit.covariance[(j, j)]).sqrt();
            if c.abs() > 0.995 {
                warnings.push(format!(
                    "{} and {} are correlated with {c:.4}: only a combination is known",
                    NAMES[j], NAMES[i]
                ));
            }
        }
    }
    let slow = data.v.iter().filter(|v| v.abs() < 1.0 / a[2]).count();
    if slow < 10 {
        warnings.push(format!(
            "only {slow} samples are slower than 1/a3 = {:.4}: the step at zero is a guess",
            1.0 / a[2]
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    const TRUE: [f64; 5] = [2.1, 1.4, 20.0, 0.9, 8.0];

    fn data(m: usize, sigma: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut random = SplitMix64::new(seed);
        let v: Vec<f64> = (0..m)
            .map(|i| 1.2 * (0.002 * i as f64).sin() + 0.7 * (0.0052 * i as f64 + 0.4).sin())
            .collect();
        let torque = v
            .iter()
            .map(|v| stribeck_torque(*v, &TRUE) + sigma * random.normal())
            .collect();
        (v, torque)
    }

    #[test]
    fn finds_the_parameters_without_noise() {
        for a in [
            TRUE,
            [76.0, 4.0, 5.0, 2.0, 30.0],
            [0.1, 10.0, 80.0, -3.0, 2.0],
        ] {
            let (v, _) = data(5000, 0.0, 1);
            let torque: Vec<f64> = v.iter().map(|v| stribeck_torque(*v, &a)).collect();
            let fit = StribeckRegression::default()
                .fit(&v, &torque, None)
                .unwrap();
            for i in 0..5 {
                assert!(
                    (fit.parameters[i] / a[i] - 1.0).abs() < 1e-5,
                    "{:?} instead of {a:?}",
                    fit.parameters
                );
            }
        }
    }

    #[test]
    fn intervals_cover_the_truth_as_often_as_they_say() {
        let (mut covered, mut inside, mut count) = ([0; 5], 0, 0);
        for seed in 0..200 {
            let (v, torque) = data(2000, 0.05, seed);
            let fit = StribeckRegression::default()
                .fit(&v, &torque, None)
                .unwrap();
            let intervals = fit.confidence_intervals(0.9).unwrap();
            for i in 0..5 {
                let [low, high] = intervals[i].unwrap();
                covered[i] += usize::from(low <= TRUE[i] && TRUE[i] <= high);
            }
            let [_, prediction] = fit.half_widths(0.3, 0.9).unwrap();
            let fresh =
                stribeck_torque(0.3, &TRUE) + 0.05 * SplitMix64::new(10_000 + seed).normal();
            inside += usize::from((fresh - fit.torque(0.3)).abs() <= prediction);
            count += 1;
        }
        // 90 % of 200, ± 3 binomial standard deviations of 4.2, and a little for the law being nonlinear.
        for c in covered.into_iter().chain([inside]) {
            assert!((165..=195).contains(&c), "{covered:?} {inside} of {count}");
        }
    }

    #[test]
    fn outliers_hardly_move_the_robust_fit() {
        let (v, mut torque) = data(4000, 0.05, 3);
        (0..4000).step_by(20).for_each(|i| torque[i] += 8.0);
        let error = |robustness| {
            let fit = StribeckRegression {
                robustness,
                ..Default::default()
            }
            .fit(&v, &torque, None)
            .unwrap();
            (0..40)
                .map(|i| 0.05 * f64::from(i) - 1.0)
                .map(|v| (fit.torque(v) - stribeck_torque(v, &TRUE)).abs())
                .fold(0.0, f64::max)
        };
        let (plain, robust) = (error(Robustness::None), error(Robustness::Huber(1.345)));
        assert!(robust < 0.03 && plain > 5.0 * robust, "{plain} {robust}");
    }

    #[test]
    fn parameters_without_influence_are_named() {
        let (v, _) = data(3000, 0.0, 1);
        let mut random = SplitMix64::new(5);
        let viscous: Vec<f64> = v.iter().map(|v| 3.6 * v + 0.05 * random.normal()).collect();
        let fit = StribeckRegression::default()
            .fit(&v, &viscous, None)
            .unwrap();
        assert!(!fit.warnings.is_empty());
        assert!((fit.torque(1.0) - 3.6).abs() < 0.1);
        let fast: Vec<f64> = v.iter().map(|v| 2.0 + v.abs()).collect();
        let torque: Vec<f64> = fast
            .iter()
            .map(|v| stribeck_torque(*v, &TRUE) + 0.05 * random.normal())
            .collect();
        let fit = StribeckRegression::default()
            .fit(&fast, &torque, None)
            .unwrap();
        assert!(
            fit.warnings
                .iter()
                .any(|w| w.contains("slower than 1/a3") || w.contains("not identifiable")),
            "{:?}",
            fit.warnings
        );
        for s in fit.standard_errors.iter().flatten() {
            assert!(s.is_finite());
        }
    }

    #[test]
    fn bad_input_has_messages() {
        let regression = StribeckRegression::default();
        let message = |v: &[f64], t: &[f64]| regression.fit(v, t, None).unwrap_err().to_string();
        assert!(message(&[], &[]).contains("empty"));
        assert!(message(&[1.0; 5], &[1.0; 5]).contains("at least 6 samples, there are 5"));
        assert!(
            message(&[0.3; 9], &[1.0; 9])
                .contains("the velocity is constant (0.3) in all 9 samples")
        );
        assert!(message(&[f64::NAN; 9], &[1.0; 9]).contains("9 such values of 9"));
        let zero = regression
            .fit(&data(100, 0.0, 1).0, &[0.0; 100], None)
            .unwrap();
        assert!(zero.parameters.iter().all(|a| a.is_finite()) && zero.torque(0.7).abs() < 1e-9);
    }
}
