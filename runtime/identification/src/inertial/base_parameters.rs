//! Base parameters: the combinations of inertial parameters that a motion can show.

use super::InertialRegression;
use crate::error::{IdentificationError, Result, require_setting};
use nalgebra::{DMatrix, DVector};

/// Combinations of parameters that the motion can show (Gautier 1991).
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// Columns that stand for the combinations.
    pub independent: Vec<usize>,
    /// Columns that only act through the independent ones, or not at all.
    pub dependent: Vec<usize>,
    /// Combination i is `π[independent[i]] + Σⱼ regrouping[i, j] π[dependent[j]]`.
    pub regrouping: DMatrix<f64>,
    /// Estimated combinations.
    pub values: DVector<f64>,
    /// Their standard errors, for independent errors of equal variance.
    pub standard_errors: DVector<f64>,
    /// Condition number of the independent columns, unscaled: what excitation should make small.
    pub condition: f64,
    /// Residual variance.
    pub variance: f64,
}

impl InertialRegression {
    /// Base parameters by a column-pivoted factorization of R.
    ///
    /// - `tolerance`: a column counts as dependent if what it adds is below this share of the largest, e.g.
    ///   1e-9
    ///
    /// # Errors
    /// A tolerance outside (0, 1), or a regressor that vanishes.
    pub fn base_parameters(&self, tolerance: f64) -> Result<BaseParameters> {
        require_setting(
            "tolerance",
            tolerance,
            tolerance > 0.0 && tolerance < 1.0,
            "it must lie between 0 and 1",
        )?;
        let p = self.triangle.ncols();
        let order = pivoted_order(&self.triangle, tolerance);
        let (independent, dependent) = order;
        if independent.is_empty() {
            return Err(IdentificationError::ZeroColumn {
                term: self.names.join(", "),
                samples: self.samples,
            });
        }
        let columns = self.triangle.select_columns(&independent);
        let svd = columns.clone().svd(false, false);
        let qr = columns.qr();
        let r = qr.r();
        let mut right = DMatrix::zeros(p, dependent.len() + 1);
        right.view_mut((0, 0), (p, dependent.len())).copy_from(&self.triangle.select_columns(&dependent));
        right.set_column(dependent.len(), &self.right);
        qr.q_tr_mul(&mut right);
        let n = independent.len();
        let collinear = || IdentificationError::Collinear {
            terms: independent.iter().map(|&i| self.names[i].clone()).collect(),
            condition: f64::INFINITY,
            limit: 1.0 / tolerance,
        };
        let solved = r.solve_upper_triangular(&right.rows(0, n).into_owned()).ok_or_else(collinear)?;
        let inverse = r.solve_upper_triangular(&DMatrix::identity(n, n)).ok_or_else(collinear)?;
        let rest = right.view((n, dependent.len()), (p - n, 1)).norm_squared() + self.unexplained;
        let variance = rest / (self.samples - n).max(1) as f64;
        Ok(BaseParameters {
            regrouping: solved.columns(0, dependent.len()).into_owned(),
            values: solved.column(dependent.len()).into_owned(),
            standard_errors: DVector::from_fn(n, |i, _| (variance * inverse.row(i).norm_squared()).sqrt()),
            condition: svd.singular_values.max() / svd.singular_values.min(),
            variance,
            independent,
            dependent,
        })
    }
}

/// Greedy choice of independent columns; each time the one with the most left, earlier ones preferred when
/// equal.
fn pivoted_order(triangle: &DMatrix<f64>, tolerance: f64) -> (Vec<usize>, Vec<usize>) {
    let mut rest = triangle.clone();
    let largest = rest.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
    let (mut independent, mut open): (Vec<usize>, Vec<usize>) = (Vec::new(), (0..rest.ncols()).collect());
    while !open.is_empty() {
        let norm = |j: usize| rest.column(j).norm();
        let best = open
            .iter()
            .copied()
            .fold(open[0], |best, j| if norm(j) > norm(best) * (1.0 + 1e-9) { j } else { best });
        if norm(best) <= tolerance * largest {
            break;
        }
        let q = rest.column(best).normalize();
        open.retain(|&j| j != best);
        independent.push(best);
        for &j in &open {
            // Twice, so that nothing of q survives by rounding.
            for _ in 0..2 {
                let share = q.dot(&rest.column(j));
                rest.column_mut(j).axpy(-share, &q, 1.0);
            }
        }
    }
    independent.sort_unstable();
    (independent, open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|i| format!("p{i}")).collect()
    }

    #[test]
    fn base_parameters_regroup_dependent_columns() {
        let mut random = SplitMix64::new(2);
        let a = DMatrix::from_fn(300, 4, |_, _| random.normal());
        // Columns: a0, a1, a0 − 2 a1, zero, a2, a3 + a2.
        let w = DMatrix::from_columns(&[
            a.column(0).into_owned(),
            a.column(1).into_owned(),
            a.column(0) - 2.0 * a.column(1),
            DVector::zeros(300),
            a.column(2).into_owned(),
            a.column(3) + a.column(2),
        ]);
        let truth = DVector::from_column_slice(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let torque = &w * &truth;
        let regression = InertialRegression::new(&names(6), &w, torque.as_slice(), None).unwrap();
        let base = regression.base_parameters(1e-9).unwrap();
        assert_eq!((base.independent.len(), base.dependent.len()), (4, 2));
        let independent = DVector::from_fn(4, |i, _| truth[base.independent[i]]);
        let dependent = DVector::from_fn(2, |j, _| truth[base.dependent[j]]);
        let expected = independent + &base.regrouping * dependent;
        assert!((expected - &base.values).amax() < 1e-10);
        assert!(base.variance < 1e-20);
    }
}
