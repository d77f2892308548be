//! Gains of drives where efforts are currents: the scale of torque is that of the described masses.
//!
//! Currents tell forces up to a factor. A fit of gains beside free bodies has no scale of its own: bodies and gains that
//! shrink together leave the data as they are, and make all that differs from the description small. So a gain is the
//! one with which a force that does not know it explains the current of its joint, beside friction and an offset: that of the
//! description, as the joints have corrected it whose gains are known already. The joint that shows the described force
//! best comes first. What the description has wrong counts by the forces that it makes.

use super::super::error::Result;
use super::fit::{Weighting, deviations, fit};
use super::layout::{ASYMMETRY, Layout, VISCOUS};
use super::normal::{Centred, Model, Values, force_vector};
use super::prior::Prior;
use nalgebra::{DMatrix, DVector};

/// Share of the diagonal that keeps equal columns of friction apart.
const RIDGE: f64 = 1e-9;

/// Partial correlation of effort and force below which neither size nor sign of a gain follow from it.
const LEAST_CORRELATION: f64 = 0.1;

/// Weights of the description beside the joints before: from one sample to a million, by decades.
const WEIGHTS: i32 = 7;

/// Relative standard error beyond which the description does not tell a gain.
pub(super) const UNTOLD: f64 = 0.3;

/// A gain and its relative standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gain {
    pub(super) value: f64,
    pub(super) relative_error: f64,
}

impl Gain {
    /// That of efforts which are forces.
    pub(super) const ONE: Self = Self { value: 1.0, relative_error: 0.0 };
}

/// The gain of each joint; one where nothing was measured.
///
/// - `model`: what is estimated to correct the description
pub(super) fn gains(centred: &Centred, model: &Model, prior: &Prior) -> Result<Vec<Gain>> {
    let layout = centred.layout;
    let as_described = Values { unknowns: DVector::zeros(layout.len()), gains: vec![1.0; layout.joints] };
    let mut gains: Vec<Gain> = (0..layout.joints)
        .map(|joint| Explanation::new(centred, joint, &as_described).gain(centred))
        .collect();
    let mut order: Vec<usize> = (0..layout.joints).filter(|&joint| layout.measured[joint]).collect();
    order.sort_by(|a, b| gains[*a].relative_error.total_cmp(&gains[*b].relative_error));
    for place in 1..order.len() {
        let (known, joint) = (&order[..place], order[place]);
        let mut best = Explanation::new(centred, joint, &as_described);
        for decade in 0..WEIGHTS {
            let corrected = corrected(centred, (model, prior), known, &gains, 10_f64.powi(decade))?;
            let explanation = Explanation::new(centred, joint, &corrected);
            if explanation.correlation() > best.correlation() {
                best = explanation;
            }
        }
        gains[joint] = best.gain(centred);
    }
    Ok(gains)
}

/// The description as joints with known gains correct it.
fn corrected(
    centred: &Centred,
    (model, prior): (&Model, &Prior),
    known: &[usize],
    gains: &[Gain],
    description: f64,
) -> Result<Values> {
    let layout = centred.layout;
    let start = Values {
        unknowns: DVector::zeros(layout.len()),
        gains: gains.iter().map(|gain| gain.value).collect(),
    };
    let mut sigma = deviations(centred, &start);
    (0..layout.joints).filter(|joint| !known.contains(joint)).for_each(|joint| sigma[joint] = f64::INFINITY);
    let weighting = Weighting { sigma, description, trust: vec![1.0; layout.parameters] };
    fit(centred, &centred.all, model, prior, &weighting, &start).map(|solved| solved.values)
}

/// A joint's effort over a force that may explain it.
struct Explanation {
    joint: usize,
    /// Factors of the force in the joint's columns.
    force: DVector<f64>,
    all: Regression,
}

impl Explanation {
    fn new(centred: &Centred, joint: usize, values: &Values) -> Self {
        let force = force_vector(centred.layout, values, joint);
        let all = Regression::new(centred.layout, &centred.all[joint], joint, &force);
        Self { joint, force, all }
    }

    fn correlation(&self) -> f64 {
        (self.all.factor * self.all.force / self.all.effort).abs()
    }

    /// The gain. Where the force explains nothing, it is that with which the force is as large as what friction leaves.
    ///
    /// Its error is that of the jackknife over the folds: contiguous pieces, whose residuals hardly know of each other.
    fn gain(&self, centred: &Centred) -> Gain {
        let Regression { factor, effort, force } = self.all;
        if effort == 0.0 || force == 0.0 {
            return Gain { relative_error: f64::INFINITY, ..Gain::ONE };
        }
        if self.correlation() < LEAST_CORRELATION {
            return Gain { value: force / effort, relative_error: f64::INFINITY };
        }
        let of_fold = |products: &Vec<DMatrix<f64>>| {
            Regression::new(centred.layout, &products[self.joint], self.joint, &self.force).factor
        };
        let without: Vec<f64> = centred.without.iter().map(of_fold).collect();
        let n = without.len() as f64;
        let mean = without.iter().sum::<f64>() / n;
        let squares: f64 = without.iter().map(|factor| (factor - mean).powi(2)).sum();
        Gain { value: 1.0 / factor, relative_error: (squares * (n - 1.0) / n).sqrt() / factor.abs() }
    }
}

/// Least squares of a joint's effort over a force, with friction taken out of both.
struct Regression {
    /// Effort per force.
    factor: f64,
    /// Size of the effort without what friction explains.
    effort: f64,
    /// The same of the force.
    force: f64,
}

impl Regression {
    fn new(layout: &Layout, products: &DMatrix<f64>, joint: usize, force: &DVector<f64>) -> Self {
        let first = layout.first_term(joint);
        let friction = products.rows(first + VISCOUS, ASYMMETRY + 1 - VISCOUS);
        let mut normal = friction.columns(first + VISCOUS, ASYMMETRY + 1 - VISCOUS).into_owned();
        for i in 0..normal.nrows() {
            normal[(i, i)] = normal[(i, i)] * (1.0 + RIDGE) + f64::MIN_POSITIVE;
        }
        let effort =
            DVector::from_fn(products.nrows(), |i, _| if i + 1 == products.nrows() { 1.0 } else { 0.0 });
        let factor = normal.cholesky();
        // Σ of two columns without what friction explains of them.
        let left = |a: &DVector<f64>, b: &DVector<f64>| {
            let explained =
                factor.as_ref().map_or(0.0, |factor| factor.solve(&(friction * a)).dot(&(friction * b)));
            (products * a).dot(b) - explained
        };
        let sizes = [&effort, force].map(|column| left(column, column).max(0.0).sqrt());
        let factor = if sizes[1] > 0.0 { left(force, &effort) / (sizes[1] * sizes[1]) } else { 0.0 };
        Self { factor, effort: sizes[0], force: sizes[1] }
    }
}
