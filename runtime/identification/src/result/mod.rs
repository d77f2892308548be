//! Identified friction: the law, its statistics, and text about both. The module [`description`] writes the law as TOML.

use super::error::Result;
use super::methods::confidence::quantile;
use super::methods::library::Library;
pub use super::methods::offset::Offset;
use super::methods::stribeck::{StribeckWords, stribeck_gradient, stribeck_torque};
use gelenk_findings::digits::{plain, rounded, vanishes, with_error};
use gelenk_findings::{Finding, Severity};
use nalgebra::DMatrix;

pub mod description;

/// Confidence level of the intervals in tables and descriptions.
pub(crate) const CONFIDENCE: f64 = 0.95;

/// A coefficient of a friction law, with its errors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrictionTerm {
    /// Expression in the joint's velocity `v`, or the name a1 … a5 of a parameter of a Stribeck law.
    pub basis: String,
    /// Coefficient in N·m or N, divided by the unit of the expression. For a Stribeck law it is the value of the parameter.
    pub coefficient: f64,
    /// Standard error of the coefficient for correlated residuals; `None` if it is unknown. If [`Self::reach`] is not
    /// `None`, this error includes the possible bias: it is the root of (error without bias)² + bias².
    pub standard_error: Option<f64>,
    /// Half width of the 95 % interval if the coefficient may be biased: the half width by Student's distribution plus the
    /// possible bias. `None` if the interval follows from the standard error alone. The possible bias is the change of the
    /// coefficient if the samples near rests and reversals are left out.
    pub reach: Option<f64>,
    /// Standard error if all other coefficients were known; `None` if it is unknown. This error decides how many digits of
    /// the coefficient are written. Terms that are nearly collinear have inaccurate coefficients but an accurate sum, so
    /// that the standard error would give too few digits.
    pub resolution: Option<f64>,
    /// Probability that the term belongs to the law: the sum of the probabilities (from BIC) of all subsets of the library
    /// that contain the term. `None` if it is unknown.
    pub probability: Option<f64>,
}

/// Friction torque τ(v) of a joint as a function of its velocity v, in a form that descriptions can contain.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionLaw {
    /// Sum of terms `Σ coefficient · basis(v)` with the velocity v.
    Terms(Vec<FrictionTerm>),
    /// Stribeck law `a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)` with the velocity v and the
    /// parameters a1 … a5.
    Stribeck(Box<[FrictionTerm; 5]>),
}

impl Default for FrictionLaw {
    fn default() -> Self {
        Self::Terms(Vec::new())
    }
}

impl FrictionLaw {
    /// Creates the Stribeck law with parameters a1 … a5 (see [`Self::Stribeck`]).
    ///
    /// - `standard_errors`: standard errors for correlated residuals; `None` if a parameter is not identifiable
    /// - `resolutions`: standard errors if all other parameters were known; `None` if a parameter is not identifiable
    pub fn stribeck(
        parameters: [f64; 5],
        standard_errors: [Option<f64>; 5],
        resolutions: [Option<f64>; 5],
    ) -> Self {
        Self::Stribeck(Box::new(std::array::from_fn(|i| FrictionTerm {
            basis: super::methods::stribeck::NAMES[i].into(),
            coefficient: parameters[i],
            standard_error: standard_errors[i],
            resolution: resolutions[i],
            ..FrictionTerm::default()
        })))
    }

    /// Returns the terms, or the five parameters of a Stribeck law.
    pub fn coefficients(&self) -> &[FrictionTerm] {
        match self {
            Self::Terms(terms) => terms,
            Self::Stribeck(parameters) => &**parameters,
        }
    }

    /// Returns the friction torques at `velocities`, in N·m or N.
    ///
    /// # Errors
    /// [`IdentificationError::Expression`](super::error::IdentificationError::Expression) or
    /// [`UnknownChannel`](super::error::IdentificationError::UnknownChannel) if a term is not an expression in `v`, and
    /// [`Empty`](super::error::IdentificationError::Empty) if the law has no terms.
    pub fn torques(&self, velocities: &[f64]) -> Result<Vec<f64>> {
        match self {
            Self::Terms(terms) => sum(terms, velocities),
            Self::Stribeck(parameters) => {
                let parameters = values(parameters);
                Ok(velocities.iter().map(|v| stribeck_torque(*v, &parameters)).collect())
            }
        }
    }

    /// Returns the derivatives of the torques with respect to the coefficients: one row for each velocity, one column for
    /// each coefficient.
    ///
    /// # Errors
    /// The errors are those of [`Self::torques`].
    pub(crate) fn gradients(&self, velocities: &[f64]) -> Result<DMatrix<f64>> {
        match self {
            Self::Terms(terms) => matrix(terms, velocities),
            Self::Stribeck(parameters) => {
                let parameters = values(parameters);
                let rows: Vec<[f64; 5]> =
                    velocities.iter().map(|v| stribeck_gradient(*v, &parameters)).collect();
                Ok(DMatrix::from_fn(rows.len(), 5, |i, j| rows[i][j]))
            }
        }
    }

    /// Returns the law as one line of text, with the digits that are written to a description.
    pub(crate) fn formula(&self) -> String {
        let terms: Vec<String> = match self {
            Self::Terms(terms) => {
                terms.iter().map(|term| format!("{}*{}", term.written(), term.basis)).collect()
            }
            Self::Stribeck(parameters) => {
                let [a1, a2, a3, a4, a5] = parameters.each_ref().map(FrictionTerm::written);
                vec![
                    format!("{a1}*v"),
                    format!("{a2}*tanh({a3}*v)"),
                    format!("{a4}*exp(-{a5}*abs(v))*tanh(3*{a3}*v)"),
                ]
            }
        };
        terms.join(" + ").replace("+ -", "- ")
    }
}

impl FrictionTerm {
    /// Returns the error that decides how many digits are written; `None` if no error is known.
    pub(crate) fn written_error(&self) -> Option<f64> {
        self.resolution.or(self.standard_error)
    }

    /// Returns the coefficient with the digits that are written to a description.
    fn written(&self) -> String {
        rounded(self.coefficient, self.written_error())
    }

    /// Returns the ends of the confidence interval; `None` if the error is unknown.
    ///
    /// - `t`: half width of the interval in standard errors, see [`FrictionResult::interval_factor`]
    pub(crate) fn ends(&self, t: f64) -> Option<[f64; 2]> {
        let error = self.standard_error.filter(|error| error.is_finite() && *error > 0.0)?;
        let half = self.reach.unwrap_or(t * error);
        Some([-half, half].map(|distance| self.coefficient + distance))
    }

    /// Returns the interval as text, `low … high`.
    fn interval(&self, t: f64) -> Option<String> {
        let [low, high] = self.ends(t)?.map(|end| rounded(end, self.standard_error));
        Some(format!("{low} … {high}"))
    }
}

fn values(parameters: &[FrictionTerm; 5]) -> [f64; 5] {
    parameters.each_ref().map(|parameter| parameter.coefficient)
}

fn matrix(terms: &[FrictionTerm], velocities: &[f64]) -> Result<DMatrix<f64>> {
    let bases: Vec<&str> = terms.iter().map(|t| t.basis.as_str()).collect();
    Library::new(&bases, &["v"])?.matrix(&[velocities])
}

/// Returns the sum of the terms at each velocity.
fn sum(terms: &[FrictionTerm], velocities: &[f64]) -> Result<Vec<f64>> {
    let theta = matrix(terms, velocities)?;
    let mut sums = vec![0.0; velocities.len()];
    for (column, term) in theta.column_iter().zip(terms) {
        sums.iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum += term.coefficient * value);
    }
    Ok(sums)
}

/// Friction law of one joint, with its statistics.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrictionResult {
    /// Name of the joint in the description.
    pub joint: String,
    /// Unit of the torque, `N·m` or `N`.
    pub unit: String,
    /// Unit of the velocity, `rad/s` or `m/s`.
    pub velocity_unit: String,
    /// Friction law without the constant and without load-dependent friction.
    pub law: FrictionLaw,
    /// Terms whose sum is s₁(v) in the load-dependent friction `|τ_l| s₁(v)`. The torque τ_l is the load of the gear, the
    /// torque of the drive without all friction. The list is empty if the law has no load-dependent friction.
    pub load: Vec<FrictionTerm>,
    /// Constant torque that all runs have in common, in N·m or N. It is written with the law. `None` if the constant does
    /// not differ significantly from zero.
    pub constant: Option<FrictionTerm>,
    /// Physical parameters of a Stribeck law; `None` for other laws.
    pub(crate) stribeck: Option<StribeckWords>,
    /// Constant torque of each run in addition to [`Self::constant`]. These torques are not written to the description. Empty
    /// if constants are part of the law.
    pub offsets: Vec<Offset>,
    /// Number of samples to which the law was fitted.
    pub samples: usize,
    /// Degrees of freedom of the standard errors, for Student's t distribution.
    pub freedom: f64,
    /// Smallest and largest velocity in the data, in rad/s or m/s. Outside of this range the law is extrapolated.
    pub velocity_range: [f64; 2],
    /// Speed above which the filter does not distort the law, in rad/s or m/s; `None` if the torques were not
    /// filtered. It is the tenth smallest speed of the samples at which no rest or reversal is within the
    /// reach of the filter. If there are fewer than ten of these samples, it is the largest speed. Below this
    /// speed, nearly all samples were changed by the filter.
    pub resolved_from: Option<f64>,
    /// Root mean square of the residual, in N·m or N.
    pub residual: f64,
    /// Coefficient of determination `R² = 1 − RSS/Σ (τ − τ̄)²` on the fitted data. RSS is the residual sum of squares, and τ
    /// is the torque with its mean τ̄.
    pub r_squared: f64,
    /// R² on the held-out folds of a cross-validation; `None` if there are too few samples.
    pub held_out: Option<f64>,
    /// File name and SHA-256 of the data.
    pub data: String,
    /// Notes on the settings: method, λ (weight of the LASSO's penalty) with its objective function, selection of samples,
    /// differentiation.
    pub settings: Vec<Finding>,
    /// Findings about the law. A law with findings of the severity "error" is not written to a description unless the user
    /// accepts poor laws.
    pub findings: Vec<Finding>,
}

impl FrictionResult {
    /// Accepts a rejected law: its errors become warnings.
    pub(crate) fn accept(&mut self) {
        self.findings.iter_mut().for_each(|finding| *finding = finding.clone().accepted());
    }

    /// Returns the findings that prevent writing the law to a description.
    pub fn refusals(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.severity == Severity::Error)
    }

    /// Returns whether all coefficients of the law round to zero with the digits that their errors justify.
    pub(crate) fn vanishes(&self) -> bool {
        let mut terms = self.law.coefficients().iter().chain(&self.load);
        terms.all(|term| vanishes(term.coefficient, term.written_error()))
    }

    /// Returns the constant that is written, in N·m or N; 0 if there is no constant.
    pub(crate) fn level(&self) -> f64 {
        self.constant.as_ref().map_or(0.0, |term| term.coefficient)
    }

    /// Returns the friction torque at a velocity and a load τ_l of the gear, in N·m or N. The torque is the law with its
    /// constant, plus the load-dependent friction `|τ_l| s₁(v)` if [`Self::load`] has terms.
    ///
    /// # Errors
    /// The errors are those of [`FrictionLaw::torques`].
    pub fn torque(&self, velocity: f64, load: f64) -> Result<f64> {
        let first = |torques: Vec<f64>| torques.first().copied().unwrap_or(0.0);
        let law = self.level() + first(self.law.torques(&[velocity])?);
        if self.load.is_empty() {
            return Ok(law);
        }
        Ok(law + load.abs() * first(sum(&self.load, &[velocity])?))
    }

    /// Returns the law as one line of text, with the digits that are written to a description. In load-dependent friction,
    /// τ_l is called `load`.
    pub fn formula(&self) -> String {
        let under_load = self.load.iter().map(|term| format!("{}*abs(load)*{}", term.written(), term.basis));
        let constant = self.constant.iter().map(FrictionTerm::written);
        let terms = std::iter::once(self.law.formula()).chain(constant).chain(under_load);
        terms.collect::<Vec<_>>().join(" + ").replace("+ -", "- ")
    }

    /// Returns the half width of the 95 % interval in standard errors.
    pub(crate) fn interval_factor(&self) -> f64 {
        let freedom = if self.freedom > 0.0 { self.freedom } else { 1e9 };
        quantile(CONFIDENCE, freedom).unwrap_or(f64::INFINITY)
    }

    /// Returns one line for each coefficient: name, value with standard error, interval, probability.
    pub(crate) fn coefficient_lines(&self) -> Vec<String> {
        let t = self.interval_factor();
        let line = |(name, term): (String, &FrictionTerm)| {
            let range = term
                .interval(t)
                .map_or_else(String::new, |i| format!(", {:.0} % interval {i}", 100.0 * CONFIDENCE));
            let probability = term.probability.map_or_else(String::new, |p| {
                format!(", in the law with a probability of {:.0} %", 100.0 * p)
            });
            format!("{name}: {}{range}{probability}", with_error(term.coefficient, term.standard_error))
        };
        self.named().map(line).collect()
    }

    /// Returns the coefficients of the law, its constant, and the coefficients of load-dependent friction, with their
    /// names.
    fn named(&self) -> impl Iterator<Item = (String, &FrictionTerm)> {
        let law = self.law.coefficients().iter().chain(&self.constant);
        let law = law.map(|term| (term.basis.clone(), term));
        law.chain(self.load.iter().map(|term| (format!("load: {}", term.basis), term)))
    }

    /// Returns lines about the offsets, the parameters of a Stribeck law, and the quality of the fit.
    pub(crate) fn summary_lines(&self) -> Vec<String> {
        let mut lines: Vec<String> =
            self.stribeck.iter().map(|words| words.line(&self.unit, &self.velocity_unit)).collect();
        lines.extend(self.offset_line());
        lines.extend(self.resolved_from.map(|speed| {
            let (speed, unit) = (plain(speed, 2), &self.velocity_unit);
            format!("above {speed} {unit}, the filter does not distort the law. Nearly all slower samples are within a filter \
                     length of a rest or a reversal")
        }));
        let held_out = self.held_out.map_or_else(|| "unknown".into(), |r| format!("{r:.4}"));
        lines.push(format!(
            "residual {} {} rms, R² {:.4} in the fit, {held_out} on held-out data",
            rounded(self.residual, Some(1e-2 * self.residual)),
            self.unit,
            self.r_squared
        ));
        lines
    }

    fn offset_line(&self) -> Option<String> {
        let text = |o: &Offset| with_error(o.value, o.standard_error);
        match self.offsets.as_slice() {
            [] => None,
            [one] => Some(format!("offset {} {}, not part of the law", text(one), self.unit)),
            several => {
                let extreme = |sign: f64| {
                    several
                        .iter()
                        .max_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value)))
                        .map_or_else(String::new, text)
                };
                Some(format!(
                    "offsets of {} runs from {} to {} {}, not part of the law",
                    several.len(),
                    extreme(-1.0),
                    extreme(1.0),
                    self.unit
                ))
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::description::comment_lines;
    use super::*;

    pub(crate) fn example() -> FrictionResult {
        let term = |basis: &str, coefficient| FrictionTerm {
            basis: basis.into(),
            coefficient,
            standard_error: Some(0.0312),
            reach: None,
            resolution: Some(0.0041),
            probability: Some(0.75),
        };
        FrictionResult {
            joint: "beta".into(),
            unit: "N·m".into(),
            velocity_unit: "rad/s".into(),
            law: FrictionLaw::Terms(vec![term("v", 76.556_12), term("tanh(5*v)", -3.924_49)]),
            offsets: vec![Offset { samples: 0..3000, value: 0.503, standard_error: Some(0.021) }],
            samples: 3000,
            freedom: 60.0,
            velocity_range: [-0.7, 0.71],
            resolved_from: Some(0.043),
            residual: 0.1234,
            r_squared: 0.998,
            held_out: Some(0.9971),
            data: "run.csv (sha256 00ff)".into(),
            settings: ["λ = 0.01 in 1/(2N)‖·‖² + λ‖·‖₁", "two\nlines"]
                .map(|text| Finding::note("law-settings", text))
                .into(),
            ..FrictionResult::default()
        }
    }

    #[test]
    fn comments_name_units_and_numbers() {
        let text = comment_lines(&example());
        assert!(text.contains("velocities -0.7 to 0.71 rad/s; torque in N·m"), "{text}");
        // Student's quantile for 60 degrees of freedom is 2.000.
        assert!(text.contains("v: 76.556 ± 0.031, 95 % interval 76.494 … 76.619"), "{text}");
        assert!(text.contains("offset 0.503 ± 0.021 N·m, not part of the law"), "{text}");
        assert!(text.contains("R² 0.9980 in the fit, 0.9971 on held-out data"), "{text}");
        // The formula has the digits that are written, which follow from the resolution.
        assert_eq!(example().law.formula(), "76.5561*v - 3.9245*tanh(5*v)");
    }

    #[test]
    fn a_refused_law_says_so_until_it_is_accepted() {
        let findings = vec![Finding::error("poor-law", "the law explains nothing")];
        let mut result = FrictionResult { findings, ..example() };
        assert!(comment_lines(&result).ends_with("# error[poor-law]: the law explains nothing\n"));
        result.accept();
        assert_eq!(result.refusals().count(), 0);
        assert!(comment_lines(&result).ends_with("# warning[poor-law]: the law explains nothing\n"));
    }

    #[test]
    fn a_stribeck_law_and_its_formula_agree() {
        let parameters = [2.1, 1.4, 20.0, 0.9, 8.0];
        let errors = [Some(0.1), None, None, None, None];
        let law = FrictionLaw::stribeck(parameters, errors, errors);
        let v = [-0.5, 0.0, 0.02, 1.3];
        let formula = Library::new(&[law.formula()], &["v"]).unwrap();
        let by_formula = formula.matrix(&[&v]).unwrap();
        for (a, b) in law.torques(&v).unwrap().iter().zip(by_formula.iter()) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        let text = comment_lines(&FrictionResult { law, ..example() });
        assert!(text.contains("# a5"), "{text}");
    }
}
