//! Methods that identify a friction law, and the error of a law.

use super::data::{Samples, rms};
use crate::arm::Friction;
use crate::study::Outcome;
use gelenk_identification::friction::{
    FrictionData, FrictionIdentification, FrictionMethod, FrictionReport, Offsets,
};
use gelenk_identification::methods::lasso::Lasso;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::stribeck::StribeckRegression;
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_identification::result::FrictionLaw;

/// Method that identifies a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// SINDy by sequentially thresholded least squares with the threshold 0.1.
    Thresholding,
    /// SINDy by LASSO. λ follows from cross-validation with ten folds and the one-standard-error rule. Least squares on the chosen
    /// terms follows.
    Lasso,
    /// Nonlinear regression of the Stribeck form.
    Stribeck,
}

impl Method {
    pub const ALL: [Self; 3] = [Self::Thresholding, Self::Lasso, Self::Stribeck];

    pub fn name(self) -> &'static str {
        match self {
            Self::Thresholding => "SINDy, STLS",
            Self::Lasso => "SINDy, LASSO",
            Self::Stribeck => "nonlinear regression",
        }
    }

    fn settings(self) -> FrictionMethod {
        match self {
            Self::Thresholding => FrictionMethod::Thresholding(Thresholding::default()),
            Self::Lasso => FrictionMethod::Lasso(standardized()),
            Self::Stribeck => FrictionMethod::Stribeck(StribeckRegression::default()),
        }
    }

    /// Identifies the law of these samples with the library of the paper.
    pub fn identify(self, samples: &Samples) -> Outcome<FrictionReport> {
        self.identify_over(Friction::library()?, samples)
    }

    /// Identifies the law of these samples with another library.
    pub fn identify_over(self, library: Library, samples: &Samples) -> Outcome<FrictionReport> {
        let identification = FrictionIdentification {
            library,
            method: self.settings(),
            // The paper counts a constant torque as friction.
            offsets: Offsets::PartOfLaw,
            passive: false,
            ..FrictionIdentification::new()?
        };
        Ok(identification.identify(&FrictionData::of("joint", &samples.velocities, &samples.torques))?)
    }
}

/// The LASSO, with each term divided by its root mean square.
pub fn standardized() -> Lasso {
    Lasso { standardize: true, ..Lasso::default() }
}

/// Velocities from −`fastest` to `fastest`, including zero.
fn speeds(fastest: f64) -> Vec<f64> {
    (-200..=200).map(|i| fastest * f64::from(i) / 200.0).collect()
}

/// A law as points of a curve.
pub fn curve(law: &FrictionLaw, fastest: f64) -> Outcome<Vec<[f64; 2]>> {
    let grid = speeds(fastest);
    let torques = law.torques(&grid)?;
    Ok(grid.into_iter().zip(torques).map(|(v, t)| [v, t]).collect())
}

/// Friction `truth` as points of a curve.
pub fn true_curve(truth: impl Fn(f64) -> f64, fastest: f64) -> Vec<[f64; 2]> {
    let grid = speeds(fastest);
    grid.into_iter().map(|v| [v, truth(v)]).collect()
}

/// Law minus truth over the speeds up to `fastest` [N m].
pub fn deviation(law: &FrictionLaw, truth: impl Fn(f64) -> f64, fastest: f64) -> Outcome<Vec<[f64; 2]>> {
    let points = curve(law, fastest)?;
    Ok(points.into_iter().map(|[v, torque]| [v, torque - truth(v)]).collect())
}

/// Root mean square of law minus truth over the speeds up to `fastest` [N m].
pub fn curve_error(law: &FrictionLaw, truth: impl Fn(f64) -> f64, fastest: f64) -> Outcome<f64> {
    let points = deviation(law, truth, fastest)?;
    Ok(rms(points.iter().map(|[_, error]| *error)))
}
