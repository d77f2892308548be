//! The friction law of one joint from sums of products by share, where the samples are gone.

use super::super::ensemble::{Ensemble, bootstrap};
use super::super::error::Result;
use super::super::least_squares::{Reduced, Solution};
use super::super::library::Library;
use super::super::moments::Moments;
use super::super::result::{FrictionLaw, FrictionResult, FrictionTerm};
use super::super::subset::{ModelAverage, requirements};
use super::errors::null_space;
use super::findings::Findings;
use super::held_out::{Unseen, by_folds};
use super::passivity::{doubt, passive, restrict};
use super::report::FrictionReport;
use super::selection::{Selection, choose};
use super::task::{FrictionData, FrictionIdentification};
use nalgebra::{DMatrix, DVector};

/// What is known about the friction of one joint without its samples.
#[derive(Debug, Clone)]
pub(crate) struct SharedFriction<'a> {
    /// Name, units, limits, source and settings; no samples.
    pub(crate) about: FrictionData<'a>,
    /// Sums over each share of the columns of terms and torque, offsets of the runs taken out. The terms are those
    /// of a library in `v`.
    pub(crate) shares: Vec<Moments>,
    /// What outliers lost with their weight: Σ (1 − w) r² and Σ (1 − w)(τ − τ̄)².
    pub(crate) lost: [f64; 2],
    /// Least and largest ẏ.
    pub(crate) velocity_range: [f64; 2],
    /// Largest friction torque.
    pub(crate) largest_torque: f64,
    /// Samples whose speed, and whose torque, is beyond the described limit.
    pub(crate) beyond: [u64; 2],
}

impl FrictionIdentification {
    /// Finds the law of one joint as [`Self::identify`] does, the shares being folds and blocks. What needs samples is
    /// left out: drift, dependences of the residual, offsets.
    ///
    /// # Errors
    /// As [`Self::identify`].
    pub(crate) fn identify_shares(&self, data: &SharedFriction) -> Result<FrictionReport> {
        let reduced = Reduced::from_moments(Moments::sum(&data.shares)?)?;
        let terms = reduced.moments().names().to_vec();
        let library = Library::new(&terms, &["v"])?;
        let mut findings = Findings::new(&data.about);
        let (text, condition) = (terms.join(", "), reduced.condition());
        findings
            .note(format!("library [{text}] beside the offset of each run, condition number {condition:.1}"));
        let chosen = choose(&self.method, &reduced, || Ok(data.shares.clone()))?;
        findings.note(chosen.note.clone());
        let ensemble = self.draw_shares(data, &chosen.selection, &mut findings);
        let rows = self.passive.then(|| passive(&library, data.velocity_range)).transpose()?;
        let samples = reduced.moments().samples();
        let (solution, binding) = restrict(&reduced, chosen.solution, rows.as_ref(), samples, &mut findings)?;
        doubt(&reduced, &solution.active, &mut findings);
        let errors = Errors::new(&reduced, data, &solution.coefficients, &solution.active, &binding);
        let average = ModelAverage::new(
            reduced.moments(),
            0,
            errors.effective_samples,
            &requirements(reduced.moments().names()),
        )?;
        let unseen = data.unseen(&chosen.selection, rows.as_ref(), &mut findings);
        let held_out = unseen.and_then(|unseen| unseen.r_squared());
        findings.judge(held_out, self.least_r_squared);
        data.require_limits(&mut findings);
        let law = law(&terms, &solution, &errors, &average, ensemble.as_ref());
        let result = data.result(law, reduced.moments(), &solution.coefficients, held_out, findings);
        Ok(FrictionReport {
            result: FrictionResult { freedom: errors.freedom, ..result },
            correlation: reduced.moments().correlation(),
            condition,
            terms,
            covariance: errors.covariance,
            validation: None,
            front: Vec::new(),
            subsets: chosen.subsets,
            ensemble,
            average: Some(average),
            residuals: Vec::new(),
        })
    }

    /// How often draws of shares choose each term.
    fn draw_shares(
        &self,
        data: &SharedFriction,
        selection: &Selection,
        findings: &mut Findings,
    ) -> Option<Ensemble> {
        let fit = |moments: Moments| -> Result<DVector<f64>> {
            Ok(selection.fit(&Reduced::from_moments(moments)?)?.coefficients)
        };
        match bootstrap(&data.shares, self.draws.max(1), self.seed, fit) {
            Ok(ensemble) => {
                let (shares, seed) = (data.shares.len(), self.seed);
                findings.note(format!("inclusion: {} draws of {shares} shares, seed {seed}", self.draws));
                Some(ensemble)
            }
            Err(reason) => {
                findings.warn(format!("no bootstrap draw gave a model: {reason}"));
                None
            }
        }
    }
}

impl SharedFriction<'_> {
    fn unseen(
        &self,
        selection: &Selection,
        rows: Option<&DMatrix<f64>>,
        findings: &mut Findings,
    ) -> Option<Unseen> {
        let total: f64 = self.shares.iter().map(|share| share.energy(0)).sum();
        match by_folds(&self.shares, selection, rows) {
            Ok(residual) => Some(Unseen { residual: residual + self.lost[0], total: total + self.lost[1] }),
            Err(reason) => {
                findings.warn(format!("no R² on left-out data: {reason}"));
                None
            }
        }
    }

    fn result(
        &self,
        law: FrictionLaw,
        moments: &Moments,
        coefficients: &DVector<f64>,
        held_out: Option<f64>,
        findings: Findings,
    ) -> FrictionResult {
        let samples = moments.samples();
        let rss = moments.residual(0, coefficients) + self.lost[0];
        let total = moments.energy(0) + self.lost[1];
        let (settings, warnings, refusal) = findings.texts();
        FrictionResult {
            joint: self.about.joint.into(),
            unit: self.about.unit.into(),
            velocity_unit: self.about.velocity_unit.into(),
            law,
            samples,
            velocity_range: self.velocity_range,
            residual: (rss / samples.max(1) as f64).sqrt(),
            r_squared: if total > 0.0 { 1.0 - rss / total } else { 1.0 },
            held_out,
            data: self.about.data.into(),
            settings,
            warnings,
            refusal,
            ..FrictionResult::default()
        }
    }

    fn require_limits(&self, findings: &mut Findings) {
        let Some(limits) = self.about.limits else { return };
        let samples: usize = self.shares.iter().map(Moments::samples).sum();
        let fastest = self.velocity_range.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        let kinds = [
            ("speeds", self.beyond[0], limits.velocity, self.about.velocity_unit, fastest),
            ("friction torques", self.beyond[1], limits.effort, self.about.unit, self.largest_torque),
        ];
        for (what, count, limit, unit, largest) in kinds {
            findings.judge_limit(what, count as f64 / samples.max(1) as f64, [limit, largest], unit);
        }
    }
}

fn law(
    terms: &[String],
    solution: &Solution,
    errors: &Errors,
    average: &ModelAverage,
    ensemble: Option<&Ensemble>,
) -> FrictionLaw {
    let term = |(k, &i): (usize, &usize)| FrictionTerm {
        basis: terms[i].clone(),
        coefficient: solution.coefficients[i],
        standard_error: Some(errors.covariance[(k, k)].max(0.0).sqrt()),
        resolution: Some(errors.resolution[k]),
        inclusion: ensemble.map(|ensemble| ensemble.inclusion[i]),
        probability: Some(average.inclusion[i]),
    };
    FrictionLaw::Terms(solution.active.iter().enumerate().map(term).collect())
}

/// Standard errors from the scores of the shares.
struct Errors {
    covariance: DMatrix<f64>,
    resolution: Vec<f64>,
    freedom: f64,
    effective_samples: f64,
}

impl Errors {
    fn new(
        reduced: &Reduced,
        data: &SharedFriction,
        coefficients: &DVector<f64>,
        active: &[usize],
        binding: &DMatrix<f64>,
    ) -> Self {
        let gram = reduced.moments().gram().select_rows(active).select_columns(active);
        let bread = inverse_on_face(&gram, &binding.select_columns(active));
        let count = data.shares.len() as f64;
        let score = |share: &Moments| -> DVector<f64> {
            let all = share.projection(0) - share.gram() * coefficients;
            all.select_rows(active)
        };
        let mut scores = DMatrix::zeros(active.len(), active.len());
        for score in data.shares.iter().map(score) {
            scores += &score * score.transpose();
        }
        scores *= count / (count - 1.0).max(1.0);
        let covariance = &bread * &scores * &bread;
        let samples = reduced.moments().samples() as f64;
        let variance = reduced.moments().residual(0, coefficients) / samples;
        let inflation = |k: usize| covariance[(k, k)] / (variance * bread[(k, k)]).max(f64::MIN_POSITIVE);
        let mut inflations: Vec<f64> = (0..active.len()).map(inflation).collect();
        inflations.sort_by(f64::total_cmp);
        let median = inflations.get(inflations.len() / 2).copied().unwrap_or(1.0);
        Self {
            resolution: (0..active.len()).map(|k| scores[(k, k)].max(0.0).sqrt() / gram[(k, k)]).collect(),
            freedom: (count - 1.0).max(1.0),
            effective_samples: (samples / median.max(1.0)).max(2.0),
            covariance,
        }
    }
}

/// The inverse of a Gram matrix, on the face where constraints bind.
fn inverse_on_face(gram: &DMatrix<f64>, binding: &DMatrix<f64>) -> DMatrix<f64> {
    let z = null_space(binding, gram.nrows());
    if z.ncols() == 0 {
        // Constraints fix all coefficients.
        return DMatrix::zeros(gram.nrows(), gram.nrows());
    }
    let inner = (z.transpose() * gram * &z).pseudo_inverse(1e-14 * gram.amax());
    inner.map_or_else(|_| DMatrix::zeros(gram.nrows(), gram.nrows()), |inner| &z * inner * z.transpose())
}
