//! Friction that grows with the load of the gear, `τ = s₀(v) + |τ_l| s₁(v)` (Hamon, Gautier, Garrec 2010). It is
//! linear in its coefficients, so choice of terms, offsets and standard errors are those of friction in the
//! velocity. [`LoadFriction::result`] is what a description gets: its key `load` holds s₁.

use super::super::error::Result;
use super::super::least_squares::Reduced;
use super::super::library::Library;
use super::super::offset::Offset;
use super::super::result::{FrictionLaw, FrictionResult, FrictionTerm};
use super::design::{Design, seen};
use super::errors::Errors;
use super::held_out::{Unseen, by_folds, variation};
use super::selection::choose;
use super::task::{FrictionData, FrictionIdentification, Offsets};
use nalgebra::{DMatrix, DVector};

/// Friction over speed and load.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadFriction {
    /// Terms of s₀ in `v` [N·m or N].
    pub speed: Vec<FrictionTerm>,
    /// Terms of s₁ in `v`, a share of the load.
    pub load: Vec<FrictionTerm>,
    /// The constant torque of each run.
    pub offsets: Vec<Offset>,
    /// Residual rms.
    pub residual: f64,
    /// R² of the fit, centred by run where offsets are separate.
    pub r_squared: f64,
    /// Degrees of freedom of the standard errors, for Student's distribution.
    pub freedom: f64,
    /// R² on left-out data, centred; `None` where the samples are too few.
    pub held_out: Option<f64>,
    /// The same for terms of the speed alone.
    pub held_out_without_load: Option<f64>,
    /// Largest |s₁| over the speeds in the data.
    pub largest_share: f64,
    /// Doubts.
    pub warnings: Vec<String>,
    /// Why the law must not be used: |s₁| ≥ 1, with which forward dynamics has no unique solution; or data that
    /// were left out are predicted no better with the load than without.
    pub refusal: Option<String>,
}

impl LoadFriction {
    /// τ at speeds and loads.
    ///
    /// # Errors
    /// A basis that is no expression in `v`, or lengths that disagree.
    pub fn torques(&self, velocities: &[f64], loads: &[f64]) -> Result<Vec<f64>> {
        super::super::error::require_length("loads", velocities.len(), loads.len())?;
        let (speed, load) = (sum(&self.speed, velocities)?, sum(&self.load, velocities)?);
        Ok((0..loads.len()).map(|i| speed[i] + loads[i].abs() * load[i]).collect())
    }

    /// The law as a result, which [`description_toml`](crate::description::description_toml) writes unless it is
    /// refused.
    ///
    /// - `data`: those that the law was found in
    #[must_use]
    pub fn result(&self, data: &FrictionData) -> FrictionResult {
        let bound = |fold: fn(f64, f64) -> f64| data.velocities.iter().copied().fold(f64::NAN, fold);
        FrictionResult {
            joint: data.joint.into(),
            unit: data.unit.into(),
            velocity_unit: data.velocity_unit.into(),
            law: FrictionLaw::Terms(self.speed.clone()),
            load: self.load.clone(),
            offsets: self.offsets.clone(),
            samples: data.velocities.len(),
            freedom: self.freedom,
            velocity_range: [bound(f64::min), bound(f64::max)],
            residual: self.residual,
            r_squared: self.r_squared,
            held_out: self.held_out,
            data: data.data.into(),
            settings: data.settings.to_vec(),
            warnings: self.warnings.clone(),
            refusal: self.refusal.clone(),
            ..FrictionResult::default()
        }
    }
}

pub(super) fn identify(
    settings: &FrictionIdentification,
    load_library: &Library,
    data: &FrictionData,
    loads: &[f64],
) -> Result<LoadFriction> {
    let separate = settings.offsets == Offsets::Separate;
    let (speed, mut notes) = seen(&settings.library, separate, data.velocities)?;
    let (load, more) = seen(load_library, true, data.velocities)?;
    notes.extend(more);
    let combined: Vec<String> = speed
        .terms()
        .iter()
        .cloned()
        .chain(load.terms().iter().map(|t| format!("abs(load)*({t})")))
        .collect();
    let library = Library::new(&combined, &["v", "load"])?;
    let design = Design::over(library, &[data.velocities, loads], separate, data)?;
    let samples = design.samples()?;
    let reduced = Reduced::new(&samples)?;
    let chosen = choose(&settings.method, &reduced, || design.folds(&samples, settings.folds))?;
    let (solution, count) = (&chosen.solution, speed.len());
    let residuals = design.residuals(&solution.coefficients);
    let none = DMatrix::zeros(0, combined.len());
    let errors = Errors::new(&design, &solution.active, &none, &residuals)?;
    let terms = |range: std::ops::Range<usize>, names: &[String]| -> Vec<FrictionTerm> {
        let here = solution.active.iter().enumerate().filter(|(_, i)| range.contains(i));
        here.map(|(k, &i)| errors.term(k, &names[i - range.start], solution.coefficients[i])).collect()
    };
    let all = 0..combined.len();
    let law = LoadFriction {
        speed: terms(0..count, speed.terms()),
        load: terms(count..all.end, load.terms()),
        offsets: Vec::new(),
        residual: (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt(),
        r_squared: r_squared(&design, &residuals),
        freedom: errors.freedom,
        held_out: held_out(settings, &design),
        held_out_without_load: Design::over(speed, &[data.velocities], separate, data)
            .ok()
            .and_then(|design| held_out(settings, &design)),
        largest_share: 0.0,
        warnings: notes,
        refusal: None,
    };
    judged(settings, law, &design, loads, &residuals)
}

fn r_squared(design: &Design, residuals: &[f64]) -> f64 {
    let weight = |i: usize| design.data.weights.map_or(1.0, |w| w[i]);
    let rss: f64 = residuals.iter().enumerate().map(|(i, r)| weight(i) * r * r).sum();
    let whole = 0..residuals.len();
    1.0 - rss / variation(design.data, design.separate, &[whole])
}

/// R² on left-out folds of least squares on all terms: the same for both libraries, whatever the method.
fn held_out(settings: &FrictionIdentification, design: &Design) -> Option<f64> {
    let samples = design.samples().ok()?;
    let folds = design.folds(&samples, settings.folds).ok()?;
    let residual = by_folds(&folds, &super::selection::Selection::All, None).ok()?;
    let total = variation(design.data, design.separate, &design.fold_ranges(settings.folds));
    Unseen { residual, total }.r_squared()
}

/// The law with its offsets, and with what is wrong with it.
fn judged(
    settings: &FrictionIdentification,
    mut law: LoadFriction,
    design: &Design,
    loads: &[f64],
    residuals: &[f64],
) -> Result<LoadFriction> {
    let velocities = design.data.velocities;
    let torques = law.torques(velocities, loads)?;
    law.offsets = design.offsets(&torques, residuals);
    let shares = sum(&law.load, velocities)?;
    law.largest_share = shares.iter().fold(0.0, |a, s| a.max(s.abs()));
    let driving = (0..loads.len()).filter(|&i| torques[i] * velocities[i] < 0.0).count();
    if driving > 0 {
        let share = 100.0 * driving as f64 / loads.len() as f64;
        law.warnings.push(format!("the law drives the joint in {share:.1} % of the samples"));
    }
    law.refusal = refusal(settings, &law);
    Ok(law)
}

fn refusal(settings: &FrictionIdentification, law: &LoadFriction) -> Option<String> {
    if law.largest_share >= 1.0 {
        return Some(format!(
            "|s₁| reaches {:.3}: friction would exceed the load itself, and forward dynamics would have no unique \
             solution",
            law.largest_share
        ));
    }
    if law.speed.is_empty() || law.load.is_empty() {
        return Some("friction does not depend on both velocity and load".into());
    }
    let with = law.held_out?;
    let least = settings.least_r_squared;
    if with < least {
        return Some(format!("the law explains nothing: R² {with:.4} on left-out data, below {least}"));
    }
    let without = law.held_out_without_load.filter(|without| with <= *without)?;
    Some(format!(
        "the load does not help to predict data that were left out: R² {with:.4} with it, {without:.4} without"
    ))
}

fn sum(terms: &[FrictionTerm], velocities: &[f64]) -> Result<Vec<f64>> {
    if terms.is_empty() {
        return Ok(vec![0.0; velocities.len()]);
    }
    let bases: Vec<&str> = terms.iter().map(|t| t.basis.as_str()).collect();
    let coefficients = DVector::from_iterator(terms.len(), terms.iter().map(|t| t.coefficient));
    let torques = Library::new(&bases, &["v"])?.matrix(&[velocities])? * coefficients;
    Ok(torques.as_slice().to_vec())
}

#[cfg(test)]
mod tests {
    use super::super::super::random::SplitMix64;
    use super::super::FrictionMethod;
    use super::*;

    /// Speeds, torques and loads of an arm that swings against gravity; a tenth of the load is friction.
    fn swinging(share: f64) -> [Vec<f64>; 3] {
        let mut random = SplitMix64::new(6);
        let t: Vec<f64> = (0..5000).map(|i| 0.01 * f64::from(i)).collect();
        let v: Vec<f64> = t.iter().map(|t| 0.8 * (0.9 * t).sin() + 0.4 * (2.3 * t).cos()).collect();
        let load: Vec<f64> = t.iter().map(|t| 12.0 * (0.37 * t).sin() + 3.0).collect();
        let torque = (0..5000)
            .map(|i| {
                let s = (20.0 * v[i]).tanh();
                0.6 + 3.0 * v[i] + 1.2 * s + share * load[i].abs() * s + 0.1 * random.normal()
            })
            .collect();
        [v, torque, load]
    }

    fn settings() -> (FrictionIdentification, Library) {
        let settings = FrictionIdentification {
            library: Library::new(&["v", "tanh(20*v)"], &["v"]).unwrap(),
            method: FrictionMethod::LeastSquares,
            ..FrictionIdentification::new().unwrap()
        };
        (settings, Library::new(&["tanh(20*v)"], &["v"]).unwrap())
    }

    fn identify(share: f64) -> LoadFriction {
        let [v, torque, load] = swinging(share);
        let (settings, library) = settings();
        let data = FrictionData { velocities: &v, torques: &torque, ..FrictionData::default() };
        settings.identify_with_load(&library, &data, &load).unwrap()
    }

    #[test]
    fn the_share_of_the_load_is_found_beside_the_speed() {
        let law = identify(0.1);
        let found: Vec<f64> = law.speed.iter().chain(&law.load).map(|t| t.coefficient).collect();
        for (term, truth) in law.speed.iter().chain(&law.load).zip([3.0, 1.2, 0.1]) {
            assert!((term.coefficient - truth).abs() < 4.0 * term.standard_error.unwrap(), "{found:?}");
        }
        assert!((law.offsets[0].value - 0.6).abs() < 0.02 && (law.residual - 0.1).abs() < 0.005, "{law:?}");
        assert!(law.held_out.unwrap() > law.held_out_without_load.unwrap() + 0.01, "{law:?}");
        assert!((law.largest_share - 0.1).abs() < 0.01 && law.refusal.is_none(), "{law:?}");
        let torques = law.torques(&[0.5, -0.5], &[-10.0, 10.0]).unwrap();
        assert!((torques[0] - 3.7).abs() < 0.05 && (torques[1] + 3.7).abs() < 0.05, "{torques:?}");
    }

    #[test]
    fn the_law_is_written_as_a_description_has_it() {
        let [v, torque, load] = swinging(0.1);
        let (settings, library) = settings();
        let data =
            FrictionData { joint: "elbow", velocities: &v, torques: &torque, ..FrictionData::default() };
        let law = settings.identify_with_load(&library, &data, &load).unwrap();
        let result = law.result(&data);
        let text =
            crate::description::description_toml("a", "arm.toml", std::slice::from_ref(&result)).unwrap();
        let table: toml::Table = toml::from_str(&text).unwrap();
        let friction = &table["joints"][0]["friction"];
        assert_eq!(friction["load"][0][0].as_str(), Some("tanh(20*v)"));
        let share = friction["load"][0][1].as_float().unwrap();
        assert!((share - 0.1).abs() < 0.01 && friction["terms"][0][0].as_str() == Some("v"), "{text}");
        assert!(
            text.contains("# load: tanh(20*v): 0.1") && result.table().contains("load: tanh(20*v)"),
            "{text}"
        );
        assert!(result.r_squared > 0.99 && result.velocity_range[0] < -1.0, "{result:?}");
    }

    #[test]
    fn a_load_that_does_not_help_is_refused() {
        let law = identify(0.0);
        let reason = law.refusal.clone().unwrap();
        assert!(
            reason.starts_with("the load does not help to predict")
                || reason.starts_with("friction does not"),
            "{reason}"
        );
        let data = FrictionData { joint: "elbow", velocities: &[0.0, 1.0], ..FrictionData::default() };
        assert!(crate::description::description_toml("a", "arm.toml", &[law.result(&data)]).is_err());
    }

    #[test]
    fn a_share_of_one_is_refused() {
        let law = identify(1.2);
        assert!(law.refusal.unwrap().starts_with("|s₁| reaches 1.2"));
    }
}
