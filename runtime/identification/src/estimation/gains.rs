//! Gains of drives if efforts are currents and no motor constants are described.
//!
//! Currents determine forces up to a factor, the gain. The described bodies determine the scale of forces, so a gain is as
//! accurate as the description of these bodies. The measured effort z of a joint with the gain K is
//!
//! `z = (f₀ + W δ + Θ φ + o) / K + e`
//!
//! with the described force f₀, the regressor W, the difference δ of the inertial parameters from the description, friction
//! Θ φ, the offset o and the error e. There are two sources of information on the gains.
//!
//! First, a least-squares fit with f₀, friction, offset and inertia of the drive as columns gives the factor of f₀ in z. The
//! mean of this factor over all δ is 1/K, whatever the size of δ. The variance of its relative error is the sum of two parts:
//! - `s² bᵀ M⁻¹ b` with the standard deviation s of [`levels::BODIES`], the metric M of the bodies and `b = Wᵀ f₀ / ‖f₀‖²`
//! - the jackknife variance over the folds
//!
//! Second, several joints move the same bodies. This determines ratios of gains, because with free bodies the equations of
//! all joints hold only for the right ratios. If a joint has only inertial forces, its gain is known only if its bodies also
//! load other joints.

use super::super::error::{IdentificationError, Result};
use super::super::methods::margin::LEAST_SHARE;
use super::super::numeric::spectrum::symmetric_eigen;
use super::fit::deviations;
use super::layout::{ARMATURE, ASYMMETRY, Layout, VISCOUS};
use super::levels;
use super::normal::{Centred, Factor, RIDGE, Values};
use super::normal::{assemble, force_vector, inverse, regularized, residual_vector, selection, with_ridge};
use super::prior::Prior;
use super::sums::Sums;
use nalgebra::{DMatrix, DVector};

/// Smallest usable share of the squared described force that friction and inertia do not explain. A smaller share is due to
/// rounding.
const LEAST: f64 = 1e-6;
/// Longest step of the logarithm of a gain.
const STEP: f64 = 1.0;
/// Largest number of steps of the iteration for the gains.
const STEPS: u32 = 200;
/// Step of the logarithms of the gains below which the iteration has settled.
const SETTLED: f64 = 1e-4;

/// Gains of the drives of all joints, with their covariance.
pub(super) struct Gains {
    /// Gain of each joint; one if the effort is a force or was not measured.
    pub(super) values: Vec<f64>,
    /// Covariance of the logarithms of the gains; zero for known gains.
    pub(super) covariance: DMatrix<f64>,
}

/// Estimates the gains of all joints.
///
/// # Errors
/// The call fails if the equations have no solution or if the iteration does not converge.
pub(super) fn gains(centred: &Centred, prior: &Prior) -> Result<Gains> {
    let layout = centred.layout;
    let joints: Vec<usize> = layout.unknown_gains().collect();
    let mut found =
        Gains { values: vec![1.0; layout.joints], covariance: DMatrix::zeros(layout.joints, layout.joints) };
    if joints.is_empty() {
        return Ok(found);
    }
    let equations = Equations::new(centred, prior, &joints)?;
    let at = equations.solved()?;
    let covariance = equations.covariance(&at)?;
    for (i, &row) in joints.iter().enumerate() {
        for (k, &column) in joints.iter().enumerate() {
            found.covariance[(row, column)] = covariance[(i, k)];
        }
    }
    found.values = at.values.gains;
    Ok(found)
}

/// The gain that follows from the factor of a joint's described force in its effort.
struct Projection {
    /// Inverse of the factor's absolute value, with the sign of the gain.
    gain: f64,
    /// Influence on ln K, with the gain K, of the errors of the described bodies and of each fold. The errors
    /// of the bodies are in coordinates in which they are independent with variance one. A single entry means
    /// that the gain is unknown.
    influence: DVector<f64>,
}

impl Projection {
    /// The gain of a joint, from the sums of products of its columns.
    ///
    /// - `root`: L⁻¹ of the bodies' metric `M = L Lᵀ`, with zeros for held parameters
    /// - `all`: sums of products of the joint's columns
    /// - `without`: the same sums without each fold
    fn new(
        layout: &Layout,
        root: &DMatrix<f64>,
        all: &DMatrix<f64>,
        without: &[&DMatrix<f64>],
        joint: usize,
    ) -> Self {
        let left = without_friction(layout, all, joint);
        let (force, effort) = (left.nrows() - 2, left.nrows() - 1);
        let [energy, measured] = [force, effort].map(|place| left[(place, place)].max(0.0));
        let (own, count) = (left[(force, effort)] / energy, without.len() as f64);
        let sign = sign(layout, all, joint);
        let unknown = Self { gain: sign, influence: DVector::from_element(1, levels::GAINS.get()) };
        let is_shown = energy > LEAST * all[(force, force)] && measured > 0.0 && own != 0.0;
        if !is_shown {
            return unknown;
        }
        let bodies = layout.local[joint].iter().take_while(|global| **global < layout.parameters);
        let mut slopes = DVector::zeros(root.nrows());
        bodies
            .enumerate()
            .for_each(|(k, &global)| slopes[global] = levels::BODIES.get() * left[(force, k)] / energy);
        let of_fold = |products: &&DMatrix<f64>| {
            let left = without_friction(layout, products, joint);
            (left[(force, effort)] / left[(force, force)] / own - 1.0) * ((count - 1.0) / count).sqrt()
        };
        let mut folds = DVector::from_iterator(without.len(), without.iter().map(of_fold));
        folds.add_scalar_mut(-folds.mean());
        let bodies = root * slopes;
        let mut influence =
            DVector::from_iterator(bodies.len() + folds.len(), bodies.iter().chain(&folds).copied());
        let error = influence.norm();
        // The error is not finite if the described force is zero without one of the folds.
        if !error.is_finite() {
            return unknown;
        }
        // This is the logarithm of a factor that is one standard deviation smaller. A factor that may be zero gives no
        // information.
        let logarithm = (-(-error.min(1.0)).ln_1p()).min(levels::GAINS.get());
        influence *= logarithm / error;
        Self { gain: sign / own.abs(), influence }
    }
}

/// Sums of products of a joint's columns without the part that friction and the inertia of the drive explain.
fn without_friction(layout: &Layout, products: &DMatrix<f64>, joint: usize) -> DMatrix<f64> {
    let places: Vec<usize> = terms(layout, joint).map(|term| layout.first_term(joint) + term).collect();
    let rows = products.select_rows(&places);
    let explained = with_ridge(rows.select_columns(&places)).cholesky().map(|factor| factor.solve(&rows));
    explained.map_or_else(|| products.clone(), |explained| products - rows.tr_mul(&explained))
}

/// Indices of all friction terms of a joint and of the inertia of its drive.
fn terms(layout: &Layout, joint: usize) -> std::ops::Range<usize> {
    VISCOUS..if layout.takes_inertia[joint] { ARMATURE + 1 } else { ASYMMETRY + 1 }
}

/// Sign of a gain, from a least-squares fit of the effort with the described force and friction as columns. With the right
/// sign, friction brakes and the factor of the described force is positive. If the two criteria disagree, the larger
/// contribution decides.
fn sign(layout: &Layout, products: &DMatrix<f64>, joint: usize) -> f64 {
    let (first, effort) = (layout.first_term(joint), products.nrows() - 1);
    let (speed, force) = (first + VISCOUS, effort - 1);
    let places: Vec<usize> = (speed..=first + ASYMMETRY).chain([force]).collect();
    let normal = with_ridge(products.select_rows(&places).select_columns(&places));
    let Some(normal) = normal.cholesky() else { return 1.0 };
    let mut factors = normal.solve(&products.column(effort).select_rows(&places));
    let of_force = factors[places.len() - 1] * products[(force, force)].sqrt();
    factors[places.len() - 1] = 0.0;
    let power = products.column(speed).select_rows(&places).dot(&factors);
    let of_friction = if power == 0.0 { 0.0 } else { power / products[(speed, speed)].sqrt() };
    if of_force * of_force.abs() + of_friction * of_friction.abs() < 0.0 { -1.0 } else { 1.0 }
}

/// The equations of all joints for the logarithms of the gains.
struct Equations<'a> {
    centred: &'a Centred<'a>,
    /// Sums of products of each joint's columns, for all data.
    all: Vec<DMatrix<f64>>,
    /// Sums of products of each joint's columns, without each fold.
    without: Vec<Vec<DMatrix<f64>>>,
    /// For each joint, the number of correlated samples that count as one independent sample.
    times: Vec<f64>,
    /// Indices of the joints with unknown gains.
    joints: &'a [usize],
    /// First values of the unknown gains, according to [`Projection`].
    first: Vec<f64>,
    /// Inverse of the covariance of the logarithms of the first gains.
    precision: DMatrix<f64>,
    active: Vec<usize>,
    /// Number of inertial parameters among the active unknowns.
    bodies: usize,
    /// Metric of the inertial parameters among the active unknowns.
    metric: DMatrix<f64>,
}

/// The fitted values for given gains, and the quality of this fit.
struct At {
    values: Values,
    /// Weights of the joints' equations in units of force.
    weights: Vec<f64>,
    /// Negative logarithm of the likelihood.
    objective: f64,
    /// Negative gradient of the objective with respect to the logarithms of the gains.
    score: DVector<f64>,
    /// Curvature of the objective with respect to the logarithms of the gains.
    curvature: DMatrix<f64>,
    /// Derivatives of the active unknowns with respect to ln K, for each unknown gain K.
    slopes: DMatrix<f64>,
}

impl<'a> Equations<'a> {
    fn new(centred: &'a Centred<'a>, prior: &Prior, joints: &'a [usize]) -> Result<Self> {
        let layout = centred.layout;
        let (all, without) = away_from_stops(centred);
        let metric = prior.round_metric();
        let count = metric.nrows();
        let free = DMatrix::from_diagonal(&DVector::from_fn(count, |i, _| f64::from(!prior.held[i])));
        let root = Factor::new(&metric)?.whitened(free);
        let project = |&joint: &usize| {
            let without: Vec<&DMatrix<f64>> = without.iter().map(|fold| &fold[joint]).collect();
            Projection::new(layout, &root, &all[joint], &without, joint)
        };
        let projections: Vec<Projection> = joints.iter().map(project).collect();
        let covariance = DMatrix::from_fn(joints.len(), joints.len(), |i, k| {
            let [one, other] = [&projections[i].influence, &projections[k].influence];
            // If a gain is unknown, its projection has no influences by bodies.
            let shares = one.len() == other.len() && one.len() > 1;
            if i == k || shares { one.dot(other) } else { 0.0 }
        });
        let precision = inverse(&covariance)?;
        let active = active(layout, prior);
        let bodies = active.iter().take_while(|&&global| global < layout.parameters).count();
        let metric = DMatrix::from_fn(bodies, bodies, |i, k| metric[(active[i], active[k])]);
        let times =
            (0..layout.joints).map(|joint| prior.joints.get(joint).map_or(1.0, |prior| prior.time)).collect();
        let first = projections.iter().map(|projection| projection.gain).collect();
        Ok(Self { centred, all, without, times, joints, first, precision, active, bodies, metric })
    }

    /// Solves the equations by Newton's method, with shorter steps if the objective would rise. Between the steps the
    /// residuals' standard deviations are updated: their logarithms move half of the way to the new values, and a smaller part
    /// in later steps. In logs of simulated arms, full updates did not converge in one of four logs, and constant half updates
    /// in one of fifty.
    ///
    /// # Errors
    /// [`IdentificationError::NotConverged`] if the iteration does not converge.
    fn solved(&self) -> Result<At> {
        let mut logs = DVector::zeros(self.joints.len());
        let values = Values { unknowns: DVector::zeros(self.centred.layout.len()), gains: self.gains(&logs) };
        let mut sigma = deviations(self.centred, &values);
        let mut at = self.at(&sigma, &logs)?;
        for step in 0..STEPS {
            let share = 0.5_f64.min(25.0 / f64::from(step + 1));
            let other = deviations(self.centred, &at.values);
            let between = |(sigma, other): (&mut f64, f64)| *sigma *= (other / *sigma).powf(share);
            sigma.iter_mut().zip(other).for_each(between);
            at = self.at(&sigma, &logs)?;
            let right = DMatrix::from_column_slice(logs.len(), 1, at.score.as_slice());
            let mut step = Factor::new(&at.curvature)?.solve(&right).column(0).into_owned();
            step *= (STEP / step.amax()).min(1.0);
            let mut next = self.at(&sigma, &(&logs + &step))?;
            while next.objective > at.objective && step.amax() > SETTLED {
                step *= 0.5;
                next = self.at(&sigma, &(&logs + &step))?;
            }
            if step.amax() <= SETTLED {
                return Ok(at);
            }
            logs += step;
            at = next;
        }
        Err(IdentificationError::NotConverged {
            what: "the estimate of motor constants".into(),
            iterations: STEPS as usize,
            detail: format!(
                "in the last one, ln(constant) still changed by more than {SETTLED}. Record a longer motion"
            ),
        })
    }

    fn gains(&self, logs: &DVector<f64>) -> Vec<f64> {
        let mut gains = vec![1.0; self.centred.layout.joints];
        for ((&joint, first), log) in self.joints.iter().zip(&self.first).zip(logs.iter()) {
            gains[joint] = first * log.exp();
        }
        gains
    }

    /// Solution for given gains, with the objective and its derivatives.
    ///
    /// - `sigma`: standard deviations of the joints' residuals in units of their efforts
    /// - `logs`: logarithms of the gains divided by their first values
    fn at(&self, sigma: &[f64], logs: &DVector<f64>) -> Result<At> {
        let (layout, n, count) = (self.centred.layout, self.active.len(), logs.len());
        let mut values = Values { unknowns: DVector::zeros(layout.len()), gains: self.gains(logs) };
        let scales = sigma.iter().zip(&values.gains).zip(&self.times);
        let weights: Vec<f64> = scales.map(|((sigma, gain), time)| (sigma * gain).powi(-2) / time).collect();
        let normal = assemble(layout, &self.all, &self.active, &weights, &values.gains);
        let mut stiffness = DMatrix::zeros(n, n);
        stiffness.view_mut((0, 0), (self.bodies, self.bodies)).copy_from(&self.metric);
        // The terms of friction are nearly collinear.
        (self.bodies..n).for_each(|i| stiffness[(i, i)] = RIDGE * normal.hessian[(i, i)]);
        let factor = Factor::new(&regularized(&normal, &stiffness))?;
        let x = factor.solve(&DMatrix::from_column_slice(n, 1, normal.linear.as_slice()));
        self.active.iter().zip(x.iter()).for_each(|(&global, x)| values.unknowns[global] = *x);
        let pull = &self.precision * logs;
        let mut objective = 0.5 * ((&stiffness * &x).dot(&x) + pull.dot(logs));
        for (joint, weight) in weights.iter().enumerate() {
            let residual = residual_vector(layout, &values, joint);
            objective += 0.5 * weight * (&self.all[joint] * &residual).dot(&residual);
        }
        let (mut score, mut own, mut mixed) = (-pull, DMatrix::zeros(count, count), DMatrix::zeros(n, count));
        for (k, &joint) in self.joints.iter().enumerate() {
            let force = self.force(&values, joint);
            let products = &self.all[joint] * &force * weights[joint];
            score[k] -= products.dot(&residual_vector(layout, &values, joint));
            own[(k, k)] = products.dot(&force);
            mixed.set_column(k, &self.columns(&values.gains, joint).tr_mul(&products));
        }
        let slopes = factor.solve(&mixed);
        let curvature = without_negative(own - mixed.tr_mul(&slopes)) + &self.precision;
        Ok(At { values, weights, objective, score, curvature, slopes })
    }

    /// Columns of a joint for the active unknowns, as factors of the columns of its sums.
    fn columns(&self, gains: &[f64], joint: usize) -> DMatrix<f64> {
        selection(self.centred.layout, joint, gains[joint], &self.active)
    }

    /// Force of a joint without the columns of delays, as factors of the columns of its sums.
    fn force(&self, values: &Values, joint: usize) -> DVector<f64> {
        let layout = self.centred.layout;
        let mut force = force_vector(layout, values, joint);
        let local = layout.local[joint].iter().enumerate().filter(|(_, global)| !layout.is_delay(**global));
        local.for_each(|(k, &global)| force[k] = values.unknowns[global]);
        force
    }

    /// Covariance of the logarithms of the gains: `C⁻¹ (S + P) C⁻¹`. C is the curvature of the objective, P
    /// is the precision of the first gains ([`Projection`]), and S is the variance of the gradient between
    /// the folds.
    fn covariance(&self, at: &At) -> Result<DMatrix<f64>> {
        let folds = self.without.len();
        let mut scores = DMatrix::zeros(self.joints.len(), folds);
        for (joint, weight) in at.weights.iter().enumerate() {
            let residual = residual_vector(self.centred.layout, &at.values, joint);
            let mut factors = self.columns(&at.values.gains, joint) * &at.slopes;
            if let Some(k) = self.joints.iter().position(|other| *other == joint) {
                factors.column_mut(k).axpy(-1.0, &self.force(&at.values, joint), 1.0);
            }
            for (without, mut score) in self.without.iter().zip(scores.column_iter_mut()) {
                score += factors.tr_mul(&((&self.all[joint] - &without[joint]) * &residual)) * *weight;
            }
        }
        let mean = scores.column_mean();
        scores.column_iter_mut().for_each(|mut score| score -= &mean);
        let variance = &scores * scores.transpose() * (folds as f64 / (folds as f64 - 1.0).max(1.0));
        let factor = Factor::new(&at.curvature)?;
        Ok(factor.solve(&factor.solve(&(variance + &self.precision)).transpose()))
    }
}

/// A matrix without the negative eigenvalues that are due to rounding.
fn without_negative(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let eigen = symmetric_eigen(matrix);
    let values = DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
    &eigen.eigenvectors * values * eigen.eigenvectors.transpose()
}

/// Sums of products of all joints' columns, for all data and without each fold. If there are enough samples
/// away from the stops of a joint, only these are used. Dry friction jumps at stops, and no smooth term has
/// this jump.
fn away_from_stops(centred: &Centred) -> (Vec<DMatrix<f64>>, Vec<Vec<DMatrix<f64>>>) {
    let (mut all, mut without) = (centred.all.clone(), centred.without.clone());
    let Some(away) = &centred.sums.away else { return (all, without) };
    let away = Centred::new(centred.layout, away, centred.offsets, centred.zeros.clone());
    let weight = |sums: &Sums, joint| sums.by_run(joint, None).iter().map(|(weight, _)| weight).sum::<f64>();
    for joint in 0..centred.layout.joints {
        if weight(away.sums, joint) >= LEAST_SHARE * weight(centred.sums, joint) {
            all[joint].clone_from(&away.all[joint]);
            without.iter_mut().zip(&away.without).for_each(|(own, away)| own[joint].clone_from(&away[joint]));
        }
    }
    (all, without)
}

/// Indices of the unknowns of the bodies, of all terms of friction, of the drives' inertias and of the delays.
fn active(layout: &Layout, prior: &Prior) -> Vec<usize> {
    let bodies = (0..layout.parameters).filter(|&i| !prior.held[i]);
    let of_joint = |joint: usize| terms(layout, joint).map(move |term| layout.term(joint, term));
    let delays = (0..layout.delay_count()).map(|number| layout.delay(number));
    bodies.chain(layout.rubbing().flat_map(of_joint)).chain(delays).collect()
}
