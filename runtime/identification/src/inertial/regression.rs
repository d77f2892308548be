//! Equations of the inertial parameters, stacked along a motion and reduced to a triangle.

use super::consistent::{ConsistentProblem, ConsistentSolution, solve};
use super::pseudo_inertia::PER_BODY;
use super::regularized::towards;
use crate::error::{Result, require_finite, require_length, require_samples, require_setting};
use crate::least_squares::triangular_factor;
use crate::moments::Samples;
use crate::torque::Motion;
use nalgebra::{DMatrix, DVector};

/// Stacked equations `W π = τ`, reduced to the triangle of their factorization.
#[derive(Debug, Clone)]
pub struct InertialRegression {
    pub(super) names: Vec<String>,
    pub(super) samples: usize,
    /// R and Qᵀτ.
    pub(super) triangle: DMatrix<f64>,
    pub(super) right: DVector<f64>,
    /// Residual that no π can explain.
    pub(super) unexplained: f64,
}

impl InertialRegression {
    /// Factors the equations once.
    ///
    /// - `regressor`: W `[equations × parameters]`; `torques`: τ; `weights`: of the equations, e.g. 1/σ² per
    ///   joint
    ///
    /// # Errors
    /// Fewer equations than parameters, lengths that disagree, or values that are not finite.
    pub fn new(
        names: &[String],
        regressor: &DMatrix<f64>,
        torques: &[f64],
        weights: Option<&[f64]>,
    ) -> Result<Self> {
        let (rows, p) = regressor.shape();
        require_samples("the inertial regression", p, rows)?;
        require_length("torques", rows, torques.len())?;
        require_finite("the torque", torques)?;
        for (name, column) in names.iter().zip(regressor.column_iter()) {
            require_finite(&format!("the regressor of {name}"), column.as_slice())?;
        }
        let mut samples = Samples::from_matrix(names, regressor, vec![torques])?;
        if let Some(weights) = weights {
            samples = samples.with_weights(weights)?;
        }
        let full = triangular_factor(&samples);
        Ok(Self {
            names: names.to_vec(),
            samples: rows,
            triangle: full.view((0, 0), (p, p)).into_owned(),
            right: full.view((0, p), (p, 1)).column(0).into_owned(),
            unexplained: full[(p, p)] * full[(p, p)],
        })
    }

    /// Stacks the regressor's rows along a motion.
    ///
    /// - `torques`: `M ÿ + k − q_gravity` by joint, as measured: `B u − τ` with known friction τ
    /// - `weights`: of each joint's equations, e.g. 1/σ²
    /// - `regressor`: writes W at y, ẏ, ÿ row by row, `N` rows of `names.len()` entries, e.g. the generated
    ///   `inertial_regressor` or `base_regressor`
    ///
    /// # Errors
    /// As [`Self::new`], or columns of different length.
    pub fn from_motion<const N: usize, const M: usize>(
        names: &[String],
        motion: &Motion<N, M>,
        torques: &[Vec<f64>; N],
        weights: Option<&[f64; N]>,
        mut regressor: impl FnMut(&[f64; N], &[f64; N], &[f64; N], &mut [f64]),
    ) -> Result<Self> {
        let (samples, p) = (motion.positions.first().map_or(0, |c| c.len()), names.len());
        let columns = [motion.positions, motion.velocities, motion.accelerations];
        let torque_columns = torques.each_ref().map(Vec::as_slice);
        for column in columns.iter().chain([&torque_columns]).flatten() {
            require_length("samples of a column of the motion", samples, column.len())?;
        }
        let mut matrix = DMatrix::zeros(N * samples, p);
        let mut rows = vec![0.0; N * p];
        for i in 0..samples {
            let [y, v, a] = columns.map(|kind| kind.map(|c| c[i]));
            rows.fill(0.0);
            regressor(&y, &v, &a, &mut rows);
            for (joint, row) in rows.chunks_exact(p.max(1)).enumerate() {
                for (column, value) in row.iter().enumerate() {
                    matrix[(i * N + joint, column)] = *value;
                }
            }
        }
        let stack = |column: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            (0..samples).flat_map(|i| (0..N).map(move |j| (i, j))).map(|(i, j)| column(i, j)).collect()
        };
        let right = stack(&|i, j| torques[j][i]);
        let weights = weights.map(|weights| stack(&|_, j| weights[j]));
        Self::new(names, &matrix, &right, weights.as_deref())
    }

    /// Parameters of bodies that can exist, nearest to the data: `min ½ ‖W π − τ‖² + weight · d(π, π₀)` with
    /// the distance d of [`towards`], and `d = ½ ((π − π₀) / π₀)²` for parameters behind the bodies.
    ///
    /// - `prior`: π₀ of all bodies, e.g. the description's; behind them further parameters, which are positive
    ///   and do not become negative
    /// - `bodies`: how many bodies there are
    /// - `weight`: how strongly directions that the data do not show are held at the prior, small and
    ///   positive, as in [`towards`]
    ///
    /// # Errors
    /// Wrong length, a prior that is not finite, or as [`solve`].
    pub fn consistent_estimate(
        &self,
        prior: &[f64],
        bodies: usize,
        weight: f64,
    ) -> Result<ConsistentSolution> {
        let p = self.triangle.ncols();
        require_length("prior parameters", p, prior.len())?;
        let of_bodies = bodies * PER_BODY;
        if p < of_bodies {
            require_length("parameters, ten per body", of_bodies, p)?;
        }
        let regularization = towards(&prior[..of_bodies], weight)?;
        let mut hessian = self.triangle.tr_mul(&self.triangle);
        let mut linear = self.triangle.tr_mul(&self.right);
        let mut part = hessian.view_mut((0, 0), (of_bodies, of_bodies));
        part += &regularization.hessian;
        let mut part = linear.rows_mut(0, of_bodies);
        part += &regularization.linear;
        for (i, &value) in prior.iter().enumerate().skip(of_bodies) {
            let name = format!("prior of {}", self.names[i]);
            require_setting(&name, value, value > 0.0, "it must be positive")?;
            hessian[(i, i)] += weight / (value * value);
            linear[i] += weight / value;
        }
        solve(&ConsistentProblem { hessian, linear, bodies, nonnegative: (of_bodies..p).collect() })
    }

    /// `‖W π − τ‖²`.
    pub fn residual(&self, parameters: &[f64]) -> Result<f64> {
        require_length("parameters", self.triangle.ncols(), parameters.len())?;
        let difference = &self.triangle * DVector::from_column_slice(parameters) - &self.right;
        Ok(difference.norm_squared() + self.unexplained)
    }
}

#[cfg(test)]
mod tests {
    use super::super::is_physically_consistent;
    use super::super::pseudo_inertia::tests::body;
    use super::*;
    use crate::random::SplitMix64;

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|i| format!("p{i}")).collect()
    }

    #[test]
    fn consistent_estimates_follow_the_data_and_stay_possible() {
        let mut random = SplitMix64::new(3);
        let (truth, other) = (
            [body(&mut random, 6.0, 0.15), body(&mut random, 6.0, 0.15)].concat(),
            [body(&mut random, 6.0, 0.15), body(&mut random, 6.0, 0.15)].concat(),
        );
        // A regressor that shows 14 of the 20 directions, and noise that makes plain least squares impossible.
        let mixing = DMatrix::from_fn(14, 20, |_, _| random.normal());
        let w = DMatrix::from_fn(400, 14, |_, _| random.normal()) * mixing;
        let torque: Vec<f64> =
            (&w * DVector::from_column_slice(&truth)).iter().map(|t| t + 0.05 * random.normal()).collect();
        let regression = InertialRegression::new(&names(20), &w, &torque, None).unwrap();
        let solution = regression.consistent_estimate(&other, 2, 1e-4).unwrap();
        let estimate = solution.parameters.as_slice();
        for pi in estimate.chunks_exact(PER_BODY) {
            assert!(is_physically_consistent(pi.try_into().unwrap()));
        }
        let (fitted, prior) = (regression.residual(estimate).unwrap(), regression.residual(&other).unwrap());
        assert!(fitted < 1.1 * 400.0 * 0.05 * 0.05 && fitted < 1e-2 * prior, "{fitted} {prior}");
        // A rotor's inertia behind the bodies: the last column scaled, so that it can be told from the rest.
        let mut with_rotor = w.clone().insert_column(20, 0.0).insert_row(400, 0.0);
        with_rotor[(400, 20)] = 10.0;
        let mut torque = torque;
        torque.push(10.0 * 0.7);
        let larger = InertialRegression::new(&names(21), &with_rotor, &torque, None).unwrap();
        let prior = [other.clone(), vec![0.1]].concat();
        let found = larger.consistent_estimate(&prior, 2, 1e-4).unwrap().parameters;
        assert!((found[20] - 0.7).abs() < 0.01, "{}", found[20]);
        let prior = [other.clone(), vec![-0.1]].concat();
        let message = larger.consistent_estimate(&prior, 2, 1e-4).unwrap_err().to_string();
        assert!(message.starts_with("prior of p20 = -0.1"), "{message}");
        let again = regression.consistent_estimate(estimate, 2, 1e3).unwrap().parameters;
        for (a, b) in again.iter().zip(estimate) {
            assert!((a - b).abs() < 1e-3);
        }
    }

    #[test]
    fn bad_input_has_messages() {
        let w = DMatrix::from_element(5, 10, 1.0);
        let message = InertialRegression::new(&names(10), &w, &[0.0; 5], None).unwrap_err().to_string();
        assert!(message.contains("needs at least 10 samples, there are 5"));
        let w = DMatrix::zeros(30, 10);
        let regression = InertialRegression::new(&names(10), &w, &[0.0; 30], None).unwrap();
        assert!(
            regression.base_parameters(1e-9).unwrap_err().to_string().contains("is zero in all 30 samples")
        );
        assert!(regression.consistent_estimate(&[0.0; 9], 1, 1.0).is_err());
        assert!(regression.consistent_estimate(&[0.0; 10], 1, 0.0).is_err());
        assert!(regression.consistent_estimate(&[0.0; 10], 2, 1.0).is_err());
    }
}
