//! Average over nested friction laws, which have the first 0, 1, … terms.

use super::bank::{Gaussian, average};
use super::law::{JointScale, TERMS};
use libm::log;

/// Number of nested laws. Law j has the first j terms. Law 0 is the described law.
const LAWS: usize = TERMS + 1;

/// Average of the nested laws, weighted by their marginal likelihoods.
///
/// Law j is the full law with the restriction `δ_{j+1} = … = 0`. The ratio of the marginal likelihoods of two nested laws equals
/// the ratio of posterior and prior density at the restriction (Savage–Dickey: Dickey, *Ann. Math. Stat.* 42, 1971; Verdinelli,
/// Wasserman, *JASA* 90, 1995). Therefore one elimination of the covariance from the last term to the first term gives all ratios:
///
/// ```text
///     ln p(law k − 1) − ln p(law k) = ½ ln(V_k/P_kk) − ½ δ_k²/P_kk        P and δ under δ_{k+1} = … = 0
/// ```
///
/// Here V are the variances of the prior, and P is the covariance. All laws have equal prior weights.
pub(super) fn averaged(full: &Gaussian, prior: &[f64; TERMS]) -> Gaussian {
    let mut laws = [*full; LAWS];
    let mut logarithms = [0.0; LAWS];
    for k in (0..TERMS).rev() {
        let above = laws[k + 1];
        if prior[k] == 0.0 {
            // The joint does not have this term, so this law is the next one.
            (laws[k], logarithms[k], logarithms[k + 1]) = (above, logarithms[k + 1], f64::NEG_INFINITY);
            continue;
        }
        let variance = above.covariance[k][k].max(f64::EPSILON * prior[k]);
        logarithms[k] = logarithms[k + 1] + 0.5 * log(prior[k] / variance)
            - 0.5 * above.mean[k] * above.mean[k] / variance;
        laws[k] = conditioned(&above, k, 0.0, variance);
    }
    average(&laws, &logarithms)
}

/// Mean of the law with the bounds of [`JointScale::admissible`], which ensure that friction dissipates energy.
///
/// If a term exceeds its bound, the law is conditioned on the value of the bound, so that the correlated terms change too (Simon,
/// Chia, *IEEE Trans. Aerospace and Electronic Systems* 38, 2002).
pub(super) fn constrained(
    law: &Gaussian,
    scale: &JointScale,
    bounds: &[f64; TERMS],
    prior: &[f64; TERMS],
) -> [f64; TERMS] {
    let mut law = *law;
    // This is the order of the bounds in `admissible`. Each bound depends on earlier terms.
    for k in [0, 3, 1, 2, 4] {
        let nearest = scale.admissible(law.mean, bounds)[k];
        if nearest != law.mean[k] {
            let variance = law.covariance[k][k].max(f64::EPSILON * prior[k]);
            law = conditioned(&law, k, nearest, variance);
        }
    }
    scale.admissible(law.mean, bounds)
}

/// The law under the condition `δ_k = value`.
fn conditioned(law: &Gaussian, k: usize, value: f64, variance: f64) -> Gaussian {
    let column: [f64; TERMS] = core::array::from_fn(|i| law.covariance[i][k]);
    let mut rest = *law;
    for i in 0..TERMS {
        rest.mean[i] -= column[i] / variance * (law.mean[k] - value);
        for j in 0..TERMS {
            rest.covariance[i][j] -= column[i] * column[j] / variance;
        }
    }
    rest.mean[k] = value;
    for i in 0..TERMS {
        rest.covariance[i][k] = 0.0;
        rest.covariance[k][i] = 0.0;
    }
    rest
}
