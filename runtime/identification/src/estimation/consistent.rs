//! The fit over bodies that can exist.

use super::super::error::Result;
use super::super::inertial::consistent::{ConsistentProblem, MARGIN, solve};
use super::super::inertial::{PER_BODY, margin};
use super::layout::{ARMATURE, Layout};
use super::prior::Prior;
use nalgebra::{DMatrix, DVector};

/// The minimum of `½ xᵀ A x − gᵀ x` where the description plus x has positive pseudo-inertias, and rotor
/// inertias, reflected inertias and shares of the load that are not negative. `free` is the minimum without these bounds.
pub(super) fn bounded(
    layout: &Layout,
    prior: &Prior,
    active: &[usize],
    regularized: &DMatrix<f64>,
    linear: &DVector<f64>,
    free: &DVector<f64>,
) -> Result<DVector<f64>> {
    let order = bodies_first(prior, active);
    let globals: Vec<usize> = order.iter().map(|place| active[*place]).collect();
    let described = |global: &usize| prior.described.get(*global).copied().unwrap_or(0.0);
    let described = DVector::from_iterator(order.len(), globals.iter().map(described));
    let nonnegative = nonnegative(layout, prior, &globals);
    let absolute = &described + free.select_rows(&order);
    if can_exist(&absolute, prior.bodies.len(), &nonnegative) {
        return Ok(free.clone());
    }
    let hessian = regularized.select_rows(&order).select_columns(&order);
    let linear = linear.select_rows(&order) + &hessian * &described;
    let problem = ConsistentProblem { hessian, linear, bodies: prior.bodies.len(), nonnegative };
    let found = solve(&problem)?.parameters - described;
    let mut bounded = free.clone();
    order.iter().zip(found.iter()).for_each(|(place, x)| bounded[*place] = *x);
    Ok(bounded)
}

/// Places of the active unknowns, those of bodies first.
fn bodies_first(prior: &Prior, active: &[usize]) -> Vec<usize> {
    let of_body =
        |global: usize| prior.bodies.iter().any(|start| (*start..start + PER_BODY).contains(&global));
    let (mut order, others): (Vec<usize>, Vec<usize>) =
        (0..active.len()).partition(|place| of_body(active[*place]));
    order.extend(others);
    order
}

/// Places of rotor inertias, reflected inertias and shares of the load among unknowns.
fn nonnegative(layout: &Layout, prior: &Prior, globals: &[usize]) -> Vec<usize> {
    let bodies = PER_BODY * prior.bodies.len();
    let of_joint = |j: usize| (ARMATURE..layout.terms).map(move |term| layout.term(j, term));
    let terms: Vec<usize> = (0..layout.joints).flat_map(of_joint).collect();
    let bounded = |i: &usize| globals[*i] < layout.own_parameters || terms.contains(&globals[*i]);
    (bodies..globals.len()).filter(bounded).collect()
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
