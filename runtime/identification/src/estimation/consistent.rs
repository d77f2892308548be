//! The fit with constraints of physically possible bodies.

use super::super::error::Result;
use super::super::inertial::consistent::{ConsistentProblem, MARGIN, solve};
use super::super::inertial::{PER_BODY, margin};
use super::layout::{ARMATURE, Layout};
use super::prior::Prior;
use nalgebra::{DMatrix, DVector};

/// The minimum of `½ xᵀ A x − gᵀ x` over the active unknowns x, with constraints. The described bodies plus x must have
/// positive definite pseudo-inertias. Rotor inertias, reflected inertias and coefficients of load-dependent friction must not
/// be negative.
///
/// - `regularized`: A
/// - `linear`: g
/// - `free`: minimum without these constraints
pub(super) fn bounded(
    layout: &Layout,
    prior: &Prior,
    active: &[usize],
    regularized: &DMatrix<f64>,
    linear: &DVector<f64>,
    free: &DVector<f64>,
) -> Result<DVector<f64>> {
    let described =
        DVector::from_fn(active.len(), |i, _| prior.described.get(active[i]).copied().unwrap_or(0.0));
    let nonnegative = nonnegative(layout, prior, active);
    let absolute = &described + free;
    if can_exist(&absolute, prior.bodies.len(), &nonnegative) {
        return Ok(free.clone());
    }
    let problem = ConsistentProblem {
        hessian: regularized.clone(),
        linear: linear + regularized * &described,
        bodies: prior.bodies.len(),
        nonnegative,
    };
    Ok(solve(&problem)?.parameters - described)
}

/// Indices of rotor inertias, reflected inertias and coefficients of load-dependent friction among the active unknowns.
fn nonnegative(layout: &Layout, prior: &Prior, active: &[usize]) -> Vec<usize> {
    let bodies = PER_BODY * prior.bodies.len();
    let of_joint = |j: usize| (ARMATURE..layout.terms).map(move |term| layout.term(j, term));
    let terms: Vec<usize> = (0..layout.joints).flat_map(of_joint).collect();
    let bounded = |i: &usize| active[*i] < layout.parameters || terms.contains(&active[*i]);
    (bodies..active.len()).filter(bounded).collect()
}

fn can_exist(parameters: &DVector<f64>, bodies: usize, nonnegative: &[usize]) -> bool {
    let body = |pi: &[f64]| {
        let mut body = [0.0; PER_BODY];
        body.copy_from_slice(pi);
        margin(&body) >= MARGIN
    };
    parameters.as_slice()[..bodies * PER_BODY].chunks_exact(PER_BODY).all(body)
        && nonnegative.iter().all(|&i| parameters[i] >= 0.0)
}
