//! Identified friction: the law, how far to trust it, and a table of both. As TOML: [`super::description`].

use super::error::Result;
use super::library::Library;
use super::stribeck::stribeck_torque;
use std::fmt::Write;

/// One term of a friction law with what is known about its coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionTerm {
    /// Expression in the joint's velocity `v`.
    pub basis: String,
    /// Factor [N·m times the inverse unit of the basis].
    pub coefficient: f64,
    /// Standard error, where known.
    pub standard_error: Option<f64>,
    /// Share of bootstrap draws with this term, where known.
    pub inclusion: Option<f64>,
}

/// Friction τ(v) of a joint, in a form that descriptions have.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionLaw {
    /// `Σ coefficient · basis(v)`.
    Terms(Vec<FrictionTerm>),
    /// `a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)`.
    Stribeck {
        /// a1 … a5.
        parameters: [f64; 5],
        /// Standard errors; `None` where a parameter is not identifiable.
        standard_errors: [Option<f64>; 5],
    },
}

impl FrictionLaw {
    /// Torques at `velocities`.
    ///
    /// # Errors
    /// A basis that is no expression in `v`, or no term.
    pub fn torques(&self, velocities: &[f64]) -> Result<Vec<f64>> {
        let terms = match self {
            Self::Stribeck { parameters, .. } => {
                let law = |v: &f64| stribeck_torque(*v, parameters);
                return Ok(velocities.iter().map(law).collect());
            }
            Self::Terms(terms) => terms,
        };
        let bases: Vec<&str> = terms.iter().map(|t| t.basis.as_str()).collect();
        let theta = Library::new(&bases, &["v"])?.matrix(&[velocities])?;
        let mut torques = vec![0.0; velocities.len()];
        for (column, term) in theta.column_iter().zip(terms) {
            for (torque, value) in torques.iter_mut().zip(column.iter()) {
                *torque += term.coefficient * value;
            }
        }
        Ok(torques)
    }

    /// The law as one line of text.
    pub fn formula(&self) -> String {
        let product = |basis: &str, factor: f64| format!("{factor:.6}*{basis}");
        let terms: Vec<String> = match self {
            Self::Terms(terms) => terms.iter().map(|t| product(&t.basis, t.coefficient)).collect(),
            Self::Stribeck { parameters: [a1, a2, a3, a4, a5], .. } => vec![
                product("v", *a1),
                product(&format!("tanh({a3:.6}*v)"), *a2),
                product(&format!("exp(-{a5:.6}*abs(v))*tanh({:.6}*v)", 3.0 * a3), *a4),
            ],
        };
        terms.join(" + ").replace("+ -", "- ")
    }

    /// Name, value, standard error and inclusion of each coefficient.
    fn rows(&self) -> Vec<(&str, f64, Option<f64>, Option<f64>)> {
        match self {
            Self::Terms(terms) => terms
                .iter()
                .map(|t| (t.basis.as_str(), t.coefficient, t.standard_error, t.inclusion))
                .collect(),
            Self::Stribeck { parameters, standard_errors } => {
                (0..5).map(|i| (super::stribeck::NAMES[i], parameters[i], standard_errors[i], None)).collect()
            }
        }
    }
}

/// The friction law of one joint and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionResult {
    /// Name of the joint in the description.
    pub joint: String,
    /// Unit of the torque, `N·m` or `N`.
    pub unit: String,
    /// Unit of the velocity, `rad/s` or `m/s`.
    pub velocity_unit: String,
    /// The law.
    pub law: FrictionLaw,
    /// Samples used.
    pub samples: usize,
    /// Range of the velocities in the data; outside the law is extrapolated.
    pub velocity_range: [f64; 2],
    /// Residual rms.
    pub residual: f64,
    /// `1 − RSS/Σ τ²`.
    pub r_squared: f64,
    /// File name and SHA-256 of the data.
    pub data: String,
    /// Settings in words: method, λ with its convention, selection, differentiation.
    pub settings: Vec<String>,
    /// Doubts.
    pub warnings: Vec<String>,
}

impl FrictionResult {
    /// A table for people.
    pub fn table(&self) -> String {
        let mut text = String::new();
        let rows = self.law.rows();
        let width = rows.iter().map(|r| r.0.chars().count()).max();
        let width = width.unwrap_or(0).max(4);
        let [slowest, fastest] = self.velocity_range;
        let _ = writeln!(
            text,
            "friction of {} [{}], {} samples, {slowest:.4} to {fastest:.4} {}",
            self.joint, self.unit, self.samples, self.velocity_unit
        );
        let _ = writeln!(
            text,
            "{:<width$}  {:>14}  {:>12}  {:>9}",
            "term", "coefficient", "std. error", "inclusion"
        );
        for (name, value, error, inclusion) in rows {
            let error = error.map_or_else(|| "-".into(), |x| format!("{x:.6}"));
            let inclusion = inclusion.map_or_else(|| "-".into(), |x| format!("{:.0} %", 100.0 * x));
            let _ = writeln!(text, "{name:<width$}  {value:>14.6}  {error:>12}  {inclusion:>9}");
        }
        let _ = writeln!(text, "residual {:.6} {} rms, R² {:.5}", self.residual, self.unit, self.r_squared);
        for warning in &self.warnings {
            let _ = writeln!(text, "warning: {warning}");
        }
        text
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn example() -> FrictionResult {
        let term = |basis: &str, coefficient| FrictionTerm {
            basis: basis.into(),
            coefficient,
            standard_error: Some(0.01),
            inclusion: Some(0.985),
        };
        FrictionResult {
            joint: "beta".into(),
            unit: "N·m".into(),
            velocity_unit: "rad/s".into(),
            law: FrictionLaw::Terms(vec![term("v", 76.556), term("tanh(5*v)", -3.924e-7)]),
            samples: 3000,
            velocity_range: [-0.7, 0.71],
            residual: 0.1234,
            r_squared: 0.998,
            data: "run.csv (sha256 00ff)".into(),
            settings: vec!["λ = 0.01 in 1/(2N)‖·‖² + λ‖·‖₁".into(), "two\nlines".into()],
            warnings: vec![],
        }
    }

    #[test]
    fn the_table_names_units_and_numbers() {
        let table = example().table();
        assert!(table.contains("friction of beta [N·m], 3000 samples, -0.7000 to 0.7100 rad/s"), "{table}");
        assert!(table.lines().nth(2).unwrap().ends_with("98 %"), "{table}");
        assert_eq!(example().law.formula(), "76.556000*v - 0.000000*tanh(5*v)");
    }

    #[test]
    fn a_stribeck_law_and_its_formula_agree() {
        let parameters = [2.1, 1.4, 20.0, 0.9, 8.0];
        let law = FrictionLaw::Stribeck { parameters, standard_errors: [Some(0.1), None, None, None, None] };
        let v = [-0.5, 0.0, 0.02, 1.3];
        let formula = Library::new(&[law.formula()], &["v"]).unwrap();
        let by_formula = formula.matrix(&[&v]).unwrap();
        for (a, b) in law.torques(&v).unwrap().iter().zip(by_formula.iter()) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        let table = FrictionResult { law, ..example() }.table();
        assert!(table.lines().count() == 8 && table.contains("a5"), "{table}");
    }
}
