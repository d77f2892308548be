//! Sparse identification of dynamics in general form: `ẋ ≈ Θ(x, u) Ξ` or `x⁺ ≈ Θ(x, u) Ξ` (Brunton, Proctor,
//! Kutz 2016).

use super::error::{IdentificationError, Result, require_length, require_samples};
use super::expression::Workspace;
use super::lasso::Lasso;
use super::least_squares::{Reduced, Solution};
use super::library::Library;
use super::moments::Samples;
use super::thresholding::Thresholding;
use nalgebra::DMatrix;
use std::fmt;

/// How terms are chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum SparseMethod {
    /// Sequential thresholding.
    Thresholding(Thresholding),
    /// LASSO at one λ, then least squares on the chosen terms.
    Lasso(Lasso, f64),
}

impl SparseMethod {
    /// Chooses terms for one target and refits.
    ///
    /// # Errors
    /// As the method.
    pub fn fit(&self, reduced: &Reduced, target: usize) -> Result<Solution> {
        match self {
            Self::Thresholding(settings) => settings.fit(reduced, target),
            Self::Lasso(lasso, lambda) => {
                let (_, active) = lasso.fit(reduced.moments(), target, *lambda)?;
                reduced.fit(target, &active)
            }
        }
    }
}

/// Identified right-hand sides, one column of Ξ for each state.
#[derive(Debug, Clone)]
pub struct SparseDynamics {
    library: Library,
    states: usize,
    /// Whether a step maps x to x⁺ instead of ẋ.
    pub discrete: bool,
    /// Ξ `[terms × states]`.
    pub coefficients: DMatrix<f64>,
    /// Fit of each column.
    pub solutions: Vec<Solution>,
    /// Condition number of the library on the data.
    pub condition: f64,
}

impl SparseDynamics {
    /// Continuous time: `derivatives` are ẋ at the samples, measured or from [`super::differentiation`].
    ///
    /// - `library`: over the states, then the inputs; `channels`: their samples in that order
    ///
    /// # Errors
    /// Lengths that disagree, or as least squares and the method.
    pub fn continuous(
        library: Library,
        channels: &[&[f64]],
        derivatives: &[&[f64]],
        method: &SparseMethod,
    ) -> Result<Self> {
        Self::fit(library, channels.to_vec(), derivatives.to_vec(), false, method)
    }

    /// Discrete time: each state's next sample is the target.
    ///
    /// - `states`: how many of the channels, the first ones, are states; the rest are inputs
    ///
    /// # Errors
    /// Fewer than two samples, or as [`Self::continuous`].
    pub fn discrete(
        library: Library,
        channels: &[&[f64]],
        states: usize,
        method: &SparseMethod,
    ) -> Result<Self> {
        let m = channels.first().map_or(0, |c| c.len());
        require_samples("dynamics in discrete time", 2, m)?;
        if states == 0 || states > channels.len() {
            return require_length("states among the channels", channels.len(), states)
                .and(Err(IdentificationError::Empty { what: "the list of states".into() }));
        }
        for channel in channels {
            require_length("samples of a channel", m, channel.len())?;
        }
        let now = channels.iter().map(|c| &c[..m - 1]).collect();
        let next = channels[..states].iter().map(|c| &c[1..]).collect();
        Self::fit(library, now, next, true, method)
    }

    fn fit(
        library: Library,
        channels: Vec<&[f64]>,
        targets: Vec<&[f64]>,
        discrete: bool,
        method: &SparseMethod,
    ) -> Result<Self> {
        let states = targets.len();
        if states > library.channels().len() {
            require_length("states among the library's channels", library.channels().len(), states)?;
        }
        let samples = Samples::from_library(&library, channels, targets)?;
        let reduced = Reduced::new(&samples)?;
        let solutions = (0..states).map(|k| method.fit(&reduced, k)).collect::<Result<Vec<_>>>()?;
        let coefficients = DMatrix::from_fn(library.len(), states, |i, j| solutions[j].coefficients[i]);
        let condition = reduced.condition();
        Ok(Self { library, states, discrete, coefficients, solutions, condition })
    }

    /// Buffers for [`Self::evaluate`].
    pub fn workspace(&self) -> (Workspace, Vec<f64>) {
        (self.library.workspace(), vec![0.0; self.library.len()])
    }

    /// ẋ or x⁺ at `channels` (states, then inputs), without allocation.
    ///
    /// # Errors
    /// Wrong lengths.
    pub fn evaluate(
        &self,
        channels: &[f64],
        workspace: &mut (Workspace, Vec<f64>),
        out: &mut [f64],
    ) -> Result<()> {
        require_length("states", self.states, out.len())?;
        let (workspace, theta) = workspace;
        self.library.row(channels, workspace, theta)?;
        for (k, out) in out.iter_mut().enumerate() {
            *out = theta.iter().zip(self.coefficients.column(k).iter()).map(|(t, c)| t * c).sum();
        }
        Ok(())
    }
}

impl fmt::Display for SparseDynamics {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for k in 0..self.states {
            let name = &self.library.channels()[k];
            let side = if self.discrete { format!("{name}⁺") } else { format!("d{name}/dt") };
            let terms: Vec<String> = (0..self.library.len())
                .filter(|&i| self.coefficients[(i, k)] != 0.0)
                .map(|i| format!("{:.6}·{}", self.coefficients[(i, k)], self.library.terms()[i]))
                .collect();
            writeln!(f, "{side} = {}", terms.join(" + ").replace("+ -", "− "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::differentiation::KalmanSmoother;
    use super::super::random::SplitMix64;
    use super::*;

    fn simulate<const N: usize>(
        f: impl Fn([f64; N], f64) -> [f64; N],
        start: [f64; N],
        h: f64,
        count: usize,
    ) -> Vec<[f64; N]> {
        let mut x = start;
        let plus = |a: [f64; N], b: [f64; N], s: f64| std::array::from_fn(|i| a[i] + s * b[i]);
        (0..count)
            .map(|k| {
                let (now, t) = (x, k as f64 * h);
                let k1 = f(x, t);
                let k2 = f(plus(x, k1, h / 2.0), t + h / 2.0);
                let k3 = f(plus(x, k2, h / 2.0), t + h / 2.0);
                let k4 = f(plus(x, k3, h), t + h);
                x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
                now
            })
            .collect()
    }

    fn lorenz(x: [f64; 3], _: f64) -> [f64; 3] {
        [10.0 * (x[1] - x[0]), x[0] * (28.0 - x[2]) - x[1], x[0] * x[1] - 8.0 / 3.0 * x[2]]
    }

    #[test]
    fn lorenz_from_noisy_states() {
        let states = simulate(lorenz, [-8.0, 7.0, 27.0], 1e-3, 20_000);
        let mut random = SplitMix64::new(3);
        let times: Vec<f64> = (0..states.len()).map(|i| i as f64 * 1e-3).collect();
        let smooth: Vec<_> = (0..3)
            .map(|k| {
                let noisy: Vec<f64> = states.iter().map(|x| x[k] + 0.01 * random.normal()).collect();
                KalmanSmoother::from_noise(0.01).differentiate(&times, &noisy).unwrap()
            })
            .collect();
        let inner = 100..states.len() - 100;
        let channels: Vec<&[f64]> = smooth.iter().map(|s| &s.value[inner.clone()]).collect();
        let rates: Vec<&[f64]> = smooth.iter().map(|s| &s.first[inner.clone()]).collect();
        let library = Library::polynomial(&["x", "y", "z"], 3).unwrap();
        let method = SparseMethod::Thresholding(Thresholding { threshold: 0.2, ..Default::default() });
        let model = SparseDynamics::continuous(library, &channels, &rates, &method).unwrap();
        let text = model.to_string();
        let expected = [
            ("x", -10.0, 0),
            ("y", 10.0, 0),
            ("x", 28.0, 1),
            ("y", -1.0, 1),
            ("x*z", -1.0, 1),
            ("x*y", 1.0, 2),
            ("z", -8.0 / 3.0, 2),
        ];
        for (term, value, column) in expected {
            let row = model.library.terms().iter().position(|t| t == term).unwrap();
            let got = model.coefficients[(row, column)];
            assert!((got - value).abs() < 0.01 * value.abs(), "{text}");
        }
        assert_eq!(model.solutions.iter().map(|s| s.active.len()).sum::<usize>(), 7, "{text}");
    }

    #[test]
    fn driven_pendulum_in_continuous_and_discrete_time() {
        let torque = |t: f64| 4.0 * (1.3 * t).sin() + 2.0 * (3.1 * t).cos();
        let pendulum = |x: [f64; 2], t: f64| [x[1], -9.81 * x[0].sin() - 0.4 * x[1] + torque(t)];
        let h = 0.01;
        let states = simulate(pendulum, [1.0, 0.0], h, 4000);
        let (phi, omega): (Vec<f64>, Vec<f64>) = states.iter().map(|x| (x[0], x[1])).unzip();
        let u: Vec<f64> = (0..4000).map(|i| torque(i as f64 * h)).collect();
        let rates: Vec<[f64; 2]> = (0..4000).map(|i| pendulum(states[i], i as f64 * h)).collect();
        let (dphi, domega): (Vec<f64>, Vec<f64>) = rates.iter().map(|r| (r[0], r[1])).unzip();
        let library = || {
            Library::new(
                &["1", "phi", "omega", "sin(phi)", "cos(phi)", "omega*abs(omega)", "u"],
                &["phi", "omega", "u"],
            )
            .unwrap()
        };
        let lasso = SparseMethod::Lasso(Lasso::default(), 1e-2);
        let model =
            SparseDynamics::continuous(library(), &[&phi, &omega, &u], &[&dphi, &domega], &lasso).unwrap();
        let column = |k: usize| model.coefficients.column(k).iter().copied().collect::<Vec<_>>();
        for (got, want) in column(1).iter().zip([0.0, 0.0, -0.4, -9.81, 0.0, 0.0, 1.0]) {
            assert!((got - want).abs() < 1e-6, "{model}");
        }
        let method = SparseMethod::Thresholding(Thresholding { threshold: 2e-3, ..Default::default() });
        let step = SparseDynamics::discrete(library(), &[&phi, &omega, &u], 2, &method).unwrap();
        let (mut x, mut workspace, mut worst) = ([phi[0], omega[0]], step.workspace(), 0.0_f64);
        for i in 0..200 {
            let mut next = [0.0; 2];
            step.evaluate(&[x[0], x[1], u[i]], &mut workspace, &mut next).unwrap();
            x = next;
            worst = worst.max((x[0] - phi[i + 1]).abs());
        }
        assert!(worst < 0.02, "{worst}: {step}");
    }
}
