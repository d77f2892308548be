//! Residuals that depend on what friction does not know: signs of a wrong rigid body.

use super::super::estimation::{ACCELERATION, POSITION};
use super::super::methods::moments::{Moments, Samples};
use super::super::methods::offset::centre;
use super::super::numeric::digits::plain;
use super::design::offset_ranges;
use super::held_out::{Unseen, by_folds};
use super::selection::Selection;
use super::task::FrictionData;
use gelenk_findings::{Finding, Rule};

/// Share of the residual's variance that another quantity must explain on left-out folds to be named.
const NAMED_SHARE: f64 = 0.1;
/// Share of the friction torque's rms below which a dependence does not matter.
const NEGLIGIBLE: f64 = 0.02;

/// A finding for each quantity that the residuals depend on.
///
/// - `scale`: rms of the friction torque
pub(super) fn dependences(data: &FrictionData, folds: usize, residuals: &[f64], scale: f64) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut look = |(rule, what): (Rule, &str), columns: Vec<Vec<f64>>, remedy: &str| {
        let Some(share) = explained_share(data, folds, residuals, columns) else { return };
        let variance = residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64;
        let rms = (share * variance).max(0.0).sqrt();
        if share > NAMED_SHARE && rms > NEGLIGIBLE * scale {
            let percent = 100.0 * share;
            let message = format!(
                "the residual depends on the {what}, which explains {percent:.0} % of it on left-out data ({} {} rms)",
                plain(rms, 3),
                data.unit
            );
            found.push(rule.found(message).help(remedy));
        }
    };
    if let Some(y) = data.positions {
        look((POSITION, "position"), functions_of_position(y, data.velocity_unit), POSITION_REMEDY);
    }
    if let Some(a) = data.accelerations {
        look((ACCELERATION, "acceleration"), vec![a.to_vec()], ACCELERATION_REMEDY);
    }
    found
}

const POSITION_REMEDY: &str = "check masses, centres of mass, the load and the mounting (`gravity`) of the description, \
    and describe springs and cables";
const ACCELERATION_REMEDY: &str = "check inertia and rotor inertia of the description, and the delay of the torque \
    against the position (--delay)";

/// Gravity of turning links, or a polynomial for sliding ones.
fn functions_of_position(y: &[f64], velocity_unit: &str) -> Vec<Vec<f64>> {
    let functions: &[fn(f64) -> f64] = if velocity_unit.starts_with("rad") {
        &[f64::sin, f64::cos, |y| (2.0 * y).sin(), |y| (2.0 * y).cos()]
    } else {
        &[|y| y, |y| y * y]
    };
    functions.iter().map(|f| y.iter().map(|y| f(*y)).collect()).collect()
}

/// Share of the residuals' variance that the columns explain on folds left out; `None` where that cannot be told.
fn explained_share(
    data: &FrictionData,
    folds: usize,
    residuals: &[f64],
    mut columns: Vec<Vec<f64>>,
) -> Option<f64> {
    columns.iter_mut().for_each(|column| centre(column, &offset_ranges(data), data.weights));
    let names: Vec<String> = (0..columns.len()).map(|i| format!("f{i}")).collect();
    let slices = columns.iter().map(Vec::as_slice).collect();
    let mut samples = Samples::from_columns(&names, slices, vec![residuals]).ok()?;
    if let Some(weights) = data.weights {
        samples = samples.with_weights(weights).ok()?;
    }
    let folds = Moments::folds(&samples, &super::design::folds(data, folds)).ok()?;
    let energy: f64 = folds.iter().map(|fold| fold.energy(0)).sum();
    let left = by_folds(&folds, &Selection::All, None).ok()?;
    Unseen { folds: left, total: energy }.r_squared(0.0)
}
