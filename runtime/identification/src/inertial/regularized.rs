//! Holding what data do not show at the description.
//!
//! The distance of a body π from its description π₀ is `½ tr((J₀⁻¹ (J(π) − J₀))²)` with the pseudo-inertias J:
//! the constant pullback of the affine-invariant metric at J₀ (Lee, Wensing, Park 2020, "Geometric robot
//! dynamic identification", eq. 25). It is quadratic in π, has no unit and does not change when the body's
//! frame is moved or turned; a body of twice the described mass and size distribution has the distance 2.

use super::pseudo_inertia::{PER_BODY, from_pseudo_inertia, pseudo_inertia};
use crate::error::{Result, require_finite, require_length, require_setting};
use crate::numeric::spectrum::symmetric_eigen;
use crate::numeric::statistics::median;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, SMatrix, Vector3};

/// Smallest radius of gyration along any direction of a reference body, as a share of the median one of all
/// bodies: a point mass has no metric of its own.
const THINNEST: f64 = 1.0 / 30.0;

/// Mass of a massless body's reference, as a share of the median mass.
const LIGHTEST: f64 = 1e-2;

/// Length that stands for the size of bodies if no description has any [m].
const UNKNOWN_SIZE: f64 = 0.1;

/// Mass that stands for the bodies' if no description has any [kg].
const UNKNOWN_MASS: f64 = 1.0;

/// `weight · Σ ½ tr((J₀⁻¹ (J − J₀))²) = ½ πᵀ H π − gᵀ π + const`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Regularization {
    /// H, `10 bodies × 10 bodies`, one block for each body.
    pub hessian: DMatrix<f64>,
    /// g.
    pub linear: DVector<f64>,
    /// The reference bodies, all of which can exist: π₀, and its nearest reference where π₀ cannot.
    pub reference: Vec<f64>,
    /// Bodies whose description cannot exist or is nearly singular, with what was done.
    pub(crate) repaired: Vec<Repair>,
}

/// A described body that cannot serve as a reference without changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Repair {
    /// Number of the body, from 0.
    pub body: usize,
    /// Fault of the description.
    pub fault: Fault,
}

/// Reason why a described body cannot serve as a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The mass is zero or negative: the reference has a hundredth of the median mass, at the frame's origin.
    Massless,
    /// A principal moment exceeds the sum of the others: the spread of mass along that axis was raised to the
    /// least one.
    Impossible,
    /// All mass lies (nearly) in a point, a line or a plane: the spread of mass was raised to the least one.
    Thin,
}

impl std::fmt::Display for Repair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let body = self.body;
        match self.fault {
            Fault::Massless => write!(
                f,
                "body {body} is described without mass; it is held near a hundredth of the median body's mass"
            ),
            Fault::Impossible => write!(
                f,
                "the described moments of inertia of body {body} cannot exist; it is held near the closest body that can"
            ),
            Fault::Thin => write!(
                f,
                "the described moments of inertia of body {body} vanish about some axis; it is held near a body that has some"
            ),
        }
    }
}

/// Sizes that stand in where a description has none.
struct Typical {
    mass: f64,
    /// Mean square distance of the mass from its centre, along one direction [m²].
    spread: f64,
}

/// The regularization of all bodies towards their description.
///
/// - `prior`: π₀, ten parameters for each body, as described
/// - `weight`: cost of a body at distance one, in the unit of the objective that it is added to: for least
///   squares weighted by 1/σ², weight λ holds as strongly as λ samples with an error of one σ
///
/// A description that cannot exist, or whose mass lies in a point, a line or a plane, is first moved to the
/// nearest body whose spread of mass about its centre is at least a thirtieth of the median body's along each
/// direction; [`Regularization::repaired`] says so. The result is the same for every choice of frames, up to
/// the frame of a massless body.
///
/// # Errors
/// A length that is not a multiple of ten, values that are not finite, or a weight that is not positive.
pub(crate) fn towards(prior: &[f64], weight: f64) -> Result<Regularization> {
    let bodies = prior.len() / PER_BODY;
    require_length("parameters, ten per body", bodies * PER_BODY, prior.len())?;
    require_finite("the prior", prior)?;
    require_setting("weight of the prior", weight, weight > 0.0, "it must be positive")?;
    let described: Vec<Matrix4<f64>> =
        prior.chunks_exact(PER_BODY).map(|pi| pseudo_inertia(&std::array::from_fn(|k| pi[k]))).collect();
    let typical = typical(&described);
    let n = prior.len();
    let (mut hessian, mut linear) = (DMatrix::zeros(n, n), DVector::zeros(n));
    let (mut reference, mut repaired) = (Vec::with_capacity(n), Vec::new());
    for (body, j) in described.iter().enumerate() {
        let (possible, fault) = repair(j, &typical);
        let block = metric(&possible) * weight;
        let pi = from_pseudo_inertia(&possible);
        let at = PER_BODY * body;
        hessian.fixed_view_mut::<PER_BODY, PER_BODY>(at, at).copy_from(&block);
        linear.fixed_rows_mut::<PER_BODY>(at).copy_from(&(block * SMatrix::<f64, PER_BODY, 1>::from(pi)));
        reference.extend(pi);
        repaired.extend(fault.map(|fault| Repair { body, fault }));
    }
    Ok(Regularization { hessian, linear, reference, repaired })
}

/// Matrix of `tr(J₀⁻¹ J(a) J₀⁻¹ J(b))` over parameters a, b.
fn metric(reference: &Matrix4<f64>) -> SMatrix<f64, PER_BODY, PER_BODY> {
    // Scaled to a unit diagonal first, so that the inverse keeps its digits for 10⁻⁶ kg m² as well.
    let sizes = reference.diagonal().map(f64::sqrt);
    let unit = Matrix4::from_fn(|r, c| reference[(r, c)] / (sizes[r] * sizes[c]));
    let inverse = unit.cholesky().map_or_else(Matrix4::identity, |factor| factor.inverse());
    let inverse = Matrix4::from_fn(|r, c| inverse[(r, c)] / (sizes[r] * sizes[c]));
    let turned: [Matrix4<f64>; PER_BODY] = std::array::from_fn(|k| {
        let mut unit = [0.0; PER_BODY];
        unit[k] = 1.0;
        inverse * pseudo_inertia(&unit)
    });
    SMatrix::from_fn(|a, b| (turned[a] * turned[b]).trace())
}

/// Median mass and spread of the bodies that have some.
fn typical(described: &[Matrix4<f64>]) -> Typical {
    let masses = described.iter().map(|j| j[(3, 3)]).filter(|&m| m > 0.0);
    let spreads = described.iter().filter(|j| j[(3, 3)] > 0.0).map(|j| central(j).1.trace() / 3.0);
    Typical {
        mass: median(masses).unwrap_or(UNKNOWN_MASS),
        spread: median(spreads.filter(|&s| s > 0.0)).unwrap_or(UNKNOWN_SIZE * UNKNOWN_SIZE),
    }
}

/// Centre of mass, and second moments about it by mass [m²].
fn central(j: &Matrix4<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let mass = j[(3, 3)];
    let centre = Vector3::new(j[(0, 3)], j[(1, 3)], j[(2, 3)]) / mass;
    let sigma = j.fixed_view::<3, 3>(0, 0) / mass;
    (centre, sigma - centre * centre.transpose())
}

/// A body that can exist, nearest to the described one about its centre of mass.
fn repair(j: &Matrix4<f64>, typical: &Typical) -> (Matrix4<f64>, Option<Fault>) {
    if j[(3, 3)] <= 0.0 {
        let spread = Matrix3::from_diagonal_element(typical.spread);
        return (body(LIGHTEST * typical.mass, Vector3::zeros(), spread), Some(Fault::Massless));
    }
    let (centre, sigma) = central(j);
    let least = THINNEST * THINNEST * typical.spread;
    let eigen = symmetric_eigen(sigma);
    let smallest = eigen.eigenvalues.min();
    if smallest >= least {
        return (*j, None);
    }
    let raised = Matrix3::from_diagonal(&eigen.eigenvalues.map(|x| x.max(least)));
    let sigma = eigen.eigenvectors * raised * eigen.eigenvectors.transpose();
    // Negative beyond rounding is no body at all.
    let fault = if smallest < -1e-9 * least { Fault::Impossible } else { Fault::Thin };
    (body(j[(3, 3)], centre, sigma), Some(fault))
}

/// Pseudo-inertia of a mass, its centre and its second moments about it by mass.
fn body(mass: f64, centre: Vector3<f64>, sigma: Matrix3<f64>) -> Matrix4<f64> {
    let mut j = Matrix4::zeros();
    j.fixed_view_mut::<3, 3>(0, 0).copy_from(&((sigma + centre * centre.transpose()) * mass));
    j.fixed_view_mut::<3, 1>(0, 3).copy_from(&(centre * mass));
    j.fixed_view_mut::<1, 3>(3, 0).copy_from(&(centre.transpose() * mass));
    j[(3, 3)] = mass;
    j
}

#[cfg(test)]
mod tests {
    use super::super::pseudo_inertia::tests::body as sample;
    use super::super::{is_physically_consistent, margin};
    use super::*;
    use crate::numeric::random::SplitMix64;
    use nalgebra::{Rotation3, Translation3};

    fn value(regularization: &Regularization, pi: &[f64]) -> f64 {
        let x = DVector::from_column_slice(pi) - DVector::from_column_slice(&regularization.reference);
        0.5 * x.dot(&(&regularization.hessian * &x))
    }

    /// The same body in a frame that is moved and turned.
    fn moved(pi: &[f64; PER_BODY]) -> [f64; PER_BODY] {
        let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.0).to_homogeneous();
        let t = Translation3::new(0.3, -2.0, 0.5).to_homogeneous() * turn;
        from_pseudo_inertia(&(t * pseudo_inertia(pi) * t.transpose()))
    }

    #[test]
    fn distance_is_that_of_eigenvalues_and_has_no_frame() {
        let mut random = SplitMix64::new(4);
        for size in [0.5, 0.02] {
            let (prior, other) = (sample(&mut random, 3.0, size), sample(&mut random, 2.0, size));
            let here = towards(&prior, 0.1).unwrap();
            assert!(here.repaired.is_empty() && (value(&here, &prior)).abs() < 1e-12);
            assert!(
                (&here.hessian * DVector::from_column_slice(&prior) - &here.linear).amax()
                    <= 1e-9 * here.linear.amax()
            );
            // Twice the body: J₀⁻¹ (J − J₀) is the identity.
            assert!((value(&here, &prior.map(|x| 2.0 * x)) - 0.1 * 2.0).abs() < 1e-9);
            let eigen = (pseudo_inertia(&prior).try_inverse().unwrap() * pseudo_inertia(&other))
                .complex_eigenvalues();
            let distance: f64 = eigen.iter().map(|l| 0.5 * (l.re - 1.0) * (l.re - 1.0)).sum();
            let there = towards(&moved(&prior), 0.1).unwrap();
            for found in [value(&here, &other), value(&there, &moved(&other))] {
                assert!((found / (0.1 * distance) - 1.0).abs() < 1e-6, "{found} {}", 0.1 * distance);
            }
        }
    }

    #[test]
    fn impossible_descriptions_are_repaired_and_said() {
        let mut random = SplitMix64::new(5);
        let real = sample(&mut random, 3.0, 0.2);
        let point = from_pseudo_inertia(&body(2.0, Vector3::new(0.1, 0.2, 0.3), Matrix3::zeros()));
        let mut impossible = sample(&mut random, 3.0, 0.2);
        impossible[9] += 10.0;
        let prior = [real, point, [0.0; PER_BODY], impossible, moved(&real)].concat();
        let found = towards(&prior, 1.0).unwrap();
        let faults: Vec<(usize, Fault)> = found.repaired.iter().map(|r| (r.body, r.fault)).collect();
        assert_eq!(faults, [(1, Fault::Thin), (2, Fault::Massless), (3, Fault::Impossible)]);
        assert!(
            found.repaired[0].to_string().starts_with("the described moments of inertia of body 1 vanish")
        );
        for pi in found.reference.chunks_exact(PER_BODY) {
            let pi: &[f64; PER_BODY] = pi.try_into().unwrap();
            assert!(is_physically_consistent(pi) && margin(pi) > 1e-6, "{pi:?}");
        }
        // Mass and centre of mass stay.
        for (b, described) in [(1, &point), (3, &impossible)] {
            let kept = &found.reference[PER_BODY * b..PER_BODY * b + 4];
            assert!(kept.iter().zip(described.iter()).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        // No body at all has a size: still a reference.
        let found = towards(&[[0.0; PER_BODY], [0.0; PER_BODY]].concat(), 1.0).unwrap();
        assert!(found.hessian.clone().cholesky().is_some());
        assert!(towards(&[0.0; 12], 1.0).is_err() && towards(&real, 0.0).is_err());
    }
}
