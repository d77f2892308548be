//! Constraints of the chosen terms (passivity), and the finding about collinear terms.

use super::super::error::Result;
use super::super::methods::constrained::{breaks, constrained_fit, face, nonnegative_rows, passivity_rows};
use super::super::methods::least_squares::{Reduced, Solution};
use super::super::methods::library::Library;
use super::super::methods::moments::Moments;
use super::super::numeric::spectrum::symmetric_eigenvalues;
use super::super::numeric::statistics::largest;
use super::findings::Findings;
use super::levels;
use gelenk_findings::Rule;
use gelenk_findings::digits::plain;
use nalgebra::{DMatrix, DVector};

/// Sees: a least-squares law that would drive the joint, or diverge beyond the speeds in the data.
/// Matters: the law was refitted with constraints, so that it brakes.
/// Example: terms that nearly cancel.
/// Fixture: `friction/tests.rs`.
const RESTRICTED: Rule = Rule::warning("law-restricted");

/// Sees: chosen terms that are nearly collinear at the velocities of the data.
/// Matters: single coefficients are inaccurate, although the curve may be accurate.
/// Example: `tanh(5*v)` and `tanh(10*v)` of a slow motion.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
const COLLINEAR: Rule = Rule::warning("terms-alike");

/// Share of the rms torque below which the contribution of a term counts as a rounding error of zero.
const NOTHING: f64 = 1e-12;

/// Ratios of speeds beyond the data to the largest speed in the data.
pub(super) fn beyond() -> impl Iterator<Item = f64> {
    (1..=20).map(|i| levels::FARTHEST.get().powf(f64::from(i) / 20.0))
}

/// Matrix A of the constraints `A ξ ≥ 0` on the coefficients ξ of a passive law:
/// - The law dissipates energy.
/// - Viscous friction is not negative.
/// - Beyond the speeds in the data, the torque hardly grows faster than the speed. Without this constraint, terms that cancel
///   each other within the data would diverge at higher speeds.
pub(super) fn passive(library: &Library, velocities: [f64; 2]) -> Result<DMatrix<f64>> {
    let fastest = largest(&velocities);
    let grid: Vec<f64> = (-200..=200).map(|i| fastest * f64::from(i) / 200.0).collect();
    let viscous: Vec<usize> = (0..library.len()).filter(|&i| library.terms()[i] == "v").collect();
    let (signs, slope) = (passivity_rows(library, &grid)?, nonnegative_rows(&viscous, library.len()));
    let [forwards, backwards] = [fastest, -fastest].map(|end| rows_beyond(library, end));
    let all = [signs, slope, forwards?, backwards?];
    let all: Vec<_> = all.iter().flat_map(|rows| rows.row_iter()).collect();
    Ok(DMatrix::from_rows(&all))
}

/// Matrix A of the constraints `A ξ ≥ 0` on the coefficients ξ beyond a speed `end`, for factors c > 1: the
/// torque `τ(c·end)` has the sign of the speed, and its magnitude is at most [`levels::MOST_GROWTH`]` c`
/// times that of `τ(end)`.
fn rows_beyond(library: &Library, end: f64) -> Result<DMatrix<f64>> {
    let speeds: Vec<f64> = beyond().map(|factor| factor * end).collect();
    let signs = passivity_rows(library, &speeds)?;
    let at_end = passivity_rows(library, &[end])?;
    let growth = signs
        .row_iter()
        .zip(beyond())
        .map(|(row, factor)| levels::MOST_GROWTH.get() * factor * &at_end - row);
    let growth: Vec<_> = growth.map(|row| row.row(0).into_owned()).collect();
    let all: Vec<_> = signs.row_iter().map(|row| row.into_owned()).chain(growth).collect();
    Ok(DMatrix::from_rows(&all))
}

/// Returns the given solution, or the constrained least-squares solution if the given one violates the
/// constraints. Also returns the active constraints.
///
/// - `rows`: matrix A of the constraints `A ξ ≥ 0` on the coefficients ξ; `None` if there are no constraints
pub(super) fn restrict(
    reduced: &Reduced,
    free: Solution,
    rows: Option<&DMatrix<f64>>,
    samples: usize,
    findings: &mut Findings,
) -> Result<(Solution, DMatrix<f64>)> {
    let none = DMatrix::zeros(0, free.coefficients.len());
    let Some(rows) = rows else { return Ok((free, none)) };
    if !breaks(rows, &free.coefficients) {
        return Ok((free, none));
    }
    findings.add(RESTRICTED.found(
        "the law from least squares drives the joint at some speed, or diverges above the speeds in the data. The law was \
         fitted again with three constraints: friction always brakes, viscous friction is not negative, and the growth with speed \
         is bounded. The standard errors treat active constraints as exact",
    ));
    let mut coefficients = constrained_fit(reduced, 0, &free.active, rows)?;
    remove_rounding(&mut coefficients, reduced.moments(), samples);
    let binding = face(rows, &coefficients);
    Ok((Solution { coefficients, ..free }, binding))
}

fn remove_rounding(coefficients: &mut DVector<f64>, moments: &Moments, samples: usize) {
    let limit = NOTHING * (moments.energy(0) / samples as f64).sqrt();
    for (i, x) in coefficients.iter_mut().enumerate() {
        let rms = (moments.gram()[(i, i)] / samples as f64).sqrt();
        if x.abs() * rms < limit {
            *x = 0.0;
        }
    }
}

/// Adds a finding if the chosen terms are nearly collinear.
pub(super) fn doubt(reduced: &Reduced, active: &[usize], findings: &mut Findings) {
    let chosen = reduced.moments().correlation().select_rows(active).select_columns(active);
    let eigenvalues = symmetric_eigenvalues(&chosen);
    let condition = (eigenvalues.max() / eigenvalues.min().max(f64::MIN_POSITIVE)).sqrt();
    if condition > levels::DOUBTFUL_CONDITION.get() {
        let message = format!(
            "the velocities of the data hardly distinguish the chosen terms (condition number {})",
            plain(condition, 3)
        );
        findings.add(
            COLLINEAR.found(message).help("use the law as a curve, and do not interpret single coefficients"),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::numeric::random::SplitMix64;
    use super::super::selection::FrictionMethod;
    use super::super::task::{FrictionData, FrictionIdentification};

    /// The law of a joint that moved slowly, and its speed.
    fn slow(passive: bool) -> (impl Fn(f64) -> f64, f64) {
        let fastest = 0.05;
        let mut random = SplitMix64::new(5);
        let v: Vec<f64> = (0..400).map(|i| fastest * (0.05 * f64::from(i)).sin()).collect();
        let torque: Vec<f64> = v.iter().map(|v| 4.0 * v + 0.1 * random.normal()).collect();
        let settings = FrictionIdentification {
            method: FrictionMethod::LeastSquares,
            passive,
            ..FrictionIdentification::new().unwrap()
        };
        let data = FrictionData { velocities: &v, torques: &torque, ..FrictionData::default() };
        let law = settings.identify(&data).unwrap().result.law;
        (move |v| law.torques(&[v]).unwrap()[0], fastest)
    }

    #[test]
    fn terms_that_cancel_each_other_at_slow_speeds_do_not_explode_beyond_them() {
        let (free, fastest) = slow(false);
        assert!(free(10.0 * fastest).abs() > 50.0 * free(fastest).abs(), "{}", free(10.0 * fastest));
        let (law, fastest) = slow(true);
        for factor in (10..=100).map(|i| 0.1 * f64::from(i)) {
            for end in [fastest, -fastest] {
                let grown = law(factor * end) / law(end);
                // Between the speeds of the rows a little more is possible.
                assert!((-1e-3..=1.501 * factor).contains(&grown), "{grown} at {factor}");
            }
        }
    }
}
