//! The distance from the description: a quadratic form in the inertial parameters that does not depend on units or frames.
//!
//! For each body the form is ½ tr((P₀⁻¹ ΔP)²), with the described pseudo-inertia P₀ and the difference ΔP from it (Lee,
//! Wensing, Park 2020: the affine-invariant metric at P₀). A value of one is an error of the mass or inertia by about 100 %.
//! For the inertia J of a rotor the form is (ΔJ / J)².

use super::super::inertial::{PER_BODY, margin, pseudo_inertia};
use super::joint_prior::JointPrior;
use super::layout::Layout;
use super::levels;
use super::normal::Model;
use nalgebra::{Cholesky, Const, DMatrix, DVector, Matrix3, Matrix4};

/// The quadratic form, the parameters that the data may change, and the priors of friction and offsets.
#[derive(Clone)]
pub(super) struct Prior {
    pub(super) metric: DMatrix<f64>,
    /// Inertial parameters in the description [kg, kg m, kg m²].
    pub(super) described: Vec<f64>,
    /// Whether each parameter is held at its described value. Parameters of bodies without mass and of rotors without
    /// inertia are held.
    pub(super) held: Vec<bool>,
    /// Indices of the bodies with mass.
    pub(super) bodies: Vec<usize>,
    /// Mean squared radius of gyration of the bodies [m²].
    size: f64,
    /// Prior of each joint; empty if nothing is known.
    pub(super) joints: Vec<JointPrior>,
}

/// A Gaussian about described values, for each active unknown.
pub(super) struct Gaussian {
    pub(super) mean: DVector<f64>,
    /// Inverses of the prior variances; zero if nothing is known.
    pub(super) precision: DVector<f64>,
    /// Number of correlated samples that count as one independent sample.
    pub(super) time: DVector<f64>,
}

impl Prior {
    pub(super) fn new(described: &[f64], bodies: usize, joints: Vec<JointPrior>) -> Self {
        let (metric, held) = distance(described, bodies);
        let size = mean_radius(described, bodies);
        let (bodies, described) =
            ((0..bodies).filter(|body| !held[body * PER_BODY]).collect(), described.to_vec());
        Self { metric, described, held, bodies, size, joints }
    }

    /// Prior of the friction terms among the active unknowns.
    pub(super) fn friction(&self, layout: &Layout, model: &Model, active: &[usize]) -> Gaussian {
        let zero = DVector::zeros(active.len());
        let mut found = Gaussian { mean: zero.clone(), precision: zero.clone(), time: zero.add_scalar(1.0) };
        for (place, &global) in active.iter().enumerate() {
            let Some((joint, term)) = layout.joint_and_term(global) else { continue };
            let Some(prior) = self.joints.get(joint) else { continue };
            let [mean, precision] = prior.term(term, model.coulomb[joint]);
            found.mean[place] = mean;
            found.precision[place] = precision;
            found.time[place] = prior.time;
        }
        found
    }

    /// The metric for bodies that are replaced by bodies with the same radius of gyration about the centre in all directions.
    /// The centre of a slender link is then as uncertain across the link as along it. The diagonal is one for held parameters.
    pub(super) fn round_metric(&self) -> DMatrix<f64> {
        let mut metric = self.metric.clone();
        (0..self.held.len()).filter(|i| self.held[*i]).for_each(|i| metric[(i, i)] = 1.0);
        for &body in &self.bodies {
            let start = body * PER_BODY;
            let mut p = pseudo_inertia(&std::array::from_fn(|k| self.described[start + k]));
            let (mass, first) = (p[(3, 3)], p.fixed_view::<3, 1>(0, 3).into_owned());
            let about = first * first.transpose() / mass;
            let moments = (p.fixed_view::<3, 3>(0, 0) - about)
                .trace()
                .max(levels::COMMON_FLOOR.get() * mass * self.size);
            p.fixed_view_mut::<3, 3>(0, 0).copy_from(&(about + Matrix3::identity() * (moments / 3.0)));
            if let Some(inverse) = p.try_inverse() {
                metric.view_mut((start, start), (PER_BODY, PER_BODY)).copy_from(&body_metric(&inverse));
            }
        }
        metric
    }

    /// Whether all bodies with mass are physically possible if `changes` are added to the described parameters.
    pub(super) fn can_exist(&self, changes: &DVector<f64>) -> bool {
        let value = |i: usize| self.described[i] + changes[i];
        self.bodies.iter().all(|body| margin(&std::array::from_fn(|k| value(body * PER_BODY + k))) > 0.0)
    }
}

/// The quadratic form of the distance from described parameters, and whether each parameter is held. Parameters of bodies
/// without mass and of rotors without inertia are held.
pub(crate) fn distance(described: &[f64], bodies: usize) -> (DMatrix<f64>, Vec<bool>) {
    let p = described.len();
    let (mut metric, mut held) = (DMatrix::zeros(p, p), vec![false; p]);
    let size = mean_radius(described, bodies);
    for start in (0..bodies).map(|body| body * PER_BODY) {
        let parameters: [f64; PER_BODY] = std::array::from_fn(|k| described[start + k]);
        if parameters[0] > 0.0 {
            let block = body_metric(&believed(&parameters, size).inverse());
            metric.view_mut((start, start), (PER_BODY, PER_BODY)).copy_from(&block);
        } else {
            held[start..start + PER_BODY].fill(true);
        }
    }
    for i in bodies * PER_BODY..p {
        held[i] = described[i] <= 0.0;
        metric[(i, i)] = if held[i] { 0.0 } else { described[i].powi(-2) };
    }
    (metric, held)
}

/// Squared radius of gyration, averaged over the bodies with mass [m²].
fn mean_radius(described: &[f64], bodies: usize) -> f64 {
    let (mut sum, mut mass) = (0.0, 0.0);
    for pi in described[..bodies * PER_BODY].chunks_exact(PER_BODY).filter(|pi| pi[0] > 0.0) {
        sum += 0.5 * (pi[4] + pi[6] + pi[9]).max(0.0);
        mass += pi[0];
    }
    if sum > 0.0 { sum / mass } else { 0.01 }
}

fn body_metric(inverse: &Matrix4<f64>) -> DMatrix<f64> {
    let unit = |i: usize| {
        let mut e = [0.0; PER_BODY];
        e[i] = 1.0;
        inverse * pseudo_inertia(&e)
    };
    let scaled: Vec<Matrix4<f64>> = (0..PER_BODY).map(unit).collect();
    DMatrix::from_fn(PER_BODY, PER_BODY, |i, k| 0.5 * (scaled[i] * scaled[k]).trace())
}

/// Cholesky factor of the described pseudo-inertia P₀ plus a floor on its second moments. If the body is not physically
/// possible with this floor, the floor is doubled until the body is possible.
fn believed(pi: &[f64; PER_BODY], mean_radius: f64) -> Cholesky<f64, Const<4>> {
    let mut p = pseudo_inertia(pi);
    let own = (p[(0, 0)] + p[(1, 1)] + p[(2, 2)]).abs() / pi[0];
    let mut floor = pi[0] * (levels::OWN_FLOOR.get() * own + levels::COMMON_FLOOR.get() * mean_radius);
    loop {
        for i in 0..3 {
            p[(i, i)] += floor;
        }
        if let Some(factor) = p.cholesky() {
            return factor;
        }
        floor *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    const BODY: [f64; PER_BODY] = [2.0, 0.1, 0.0, 0.4, 0.5, 0.01, 0.4, 0.02, 0.0, 0.2];

    fn distance(prior: &Prior, change: &[f64]) -> f64 {
        let change = DVector::from_column_slice(change);
        (&prior.metric * &change).dot(&change)
    }

    #[test]
    fn a_body_and_a_rotor_of_other_size_are_as_far_as_the_factor() {
        let mut described = BODY.to_vec();
        described.push(1e-4);
        let prior = Prior::new(&described, 1, Vec::new());
        // P = (1 + s) P₀: ½ tr(s² 1) = 2 s², where the floor of the inertia adds little.
        let change: Vec<f64> = described[..10].iter().map(|x| 0.1 * x).chain([0.0]).collect();
        assert!((distance(&prior, &change) - 2.0 * 0.01).abs() < 2e-3, "{}", distance(&prior, &change));
        let mut rotor = vec![0.0; 11];
        rotor[10] = 3e-5;
        assert!((distance(&prior, &rotor) - 0.09).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_mass_is_held_and_what_cannot_exist_still_has_a_distance() {
        let mut described = vec![0.0; 10];
        described.extend([1.0, 0.0, 0.0, 0.5, 1e-9, 0.0, 1e-9, 0.0, 0.0, 1e-9, 0.0]);
        let prior = Prior::new(&described, 2, Vec::new());
        assert!(prior.held[..10].iter().all(|h| *h) && prior.held[20] && prior.bodies == [1]);
        let block = prior.metric.view((10, 10), (10, 10)).into_owned();
        assert!(block.symmetric_eigenvalues().min() > 0.0);
    }
}
