//! Inertial parameters from a regressor, `W π = M ÿ + k − q_gravity`: base parameters, and physically
//! consistent ones.
//!
//! π has ten numbers per body, all in the body's frame: m, m cₓ, m c_y, m c_z, then Ixx, Ixy, Iyy, Ixz, Iyz,
//! Izz about the frame's origin, in the order of a generated module's `INERTIAL_PARAMETER_NAMES`; W stacks
//! its `inertial_regressor` at all samples. Further parameters (rotor inertias) may stand behind those of the
//! bodies. A body exists with these numbers if and only if its pseudo-inertia `[[Σ, m c], [m cᵀ, m]]`,
//! `Σ = ½ tr(I) 1 − I`, is positive definite (Wensing, Kim, Slotine 2017).

use super::error::{
    IdentificationError, Result, require_finite, require_length, require_samples, require_setting,
};
use super::least_squares::triangular_factor;
use super::moments::Samples;
use super::torque::Motion;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Matrix3, Matrix4, OMatrix, OVector, Owned};

/// Parameters per body.
pub const PER_BODY: usize = 10;

/// Stacked equations `W π = τ`, reduced to the triangle of their factorization.
#[derive(Debug, Clone)]
pub struct InertialRegression {
    names: Vec<String>,
    samples: usize,
    /// R and Qᵀτ.
    triangle: DMatrix<f64>,
    right: DVector<f64>,
    /// Residual that no π can explain.
    unexplained: f64,
}

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

    /// Parameters of bodies that can exist, nearest to the data, in log-Cholesky coordinates (Rucker, Wensing
    /// 2022): `min ‖W π − τ‖² + weight · Σ ((π − π₀)/s)²`, s the size of the prior's entries.
    ///
    /// - `prior`: π₀ of all bodies, physically consistent, e.g. the description's; behind them further
    ///   parameters, which are positive and stay so
    /// - `bodies`: how many bodies there are
    /// - `weight`: how strongly directions that the data do not show are held at the prior, small and
    ///   positive
    ///
    /// # Errors
    /// Wrong length, a prior that is not consistent, or a search that does not end.
    pub fn consistent_estimate(&self, prior: &[f64], bodies: usize, weight: f64) -> Result<Vec<f64>> {
        require_length("prior parameters", self.triangle.ncols(), prior.len())?;
        if prior.len() < bodies * PER_BODY {
            require_length("parameters, ten per body", bodies * PER_BODY, prior.len())?;
        }
        let (of_bodies, others) = prior.split_at(bodies * PER_BODY);
        require_setting("weight of the prior", weight, weight > 0.0, "it must be positive")?;
        let mut coordinates = Vec::with_capacity(prior.len());
        for (body, pi) in of_bodies.chunks_exact(PER_BODY).enumerate() {
            coordinates.extend(log_cholesky(body, pi)?);
        }
        for (i, &value) in others.iter().enumerate() {
            let name = format!("prior of parameter {} behind the bodies", i + 1);
            require_setting(&name, value, value > 0.0, "it must be positive")?;
            coordinates.push(value.ln());
        }
        let problem = ConsistentProblem {
            regression: self,
            prior: DVector::from_column_slice(prior),
            bodies,
            scale: of_bodies
                .chunks_exact(PER_BODY)
                .flat_map(sizes)
                .chain(others.iter().copied())
                .map(|s| weight.sqrt() / s)
                .collect(),
            coordinates: DVector::from_vec(coordinates),
        };
        let (problem, report) = LevenbergMarquardt::new().with_patience(200).minimize(problem);
        if !report.termination.was_successful() {
            return Err(IdentificationError::NotConverged {
                what: "the physically consistent estimate".into(),
                iterations: report.number_of_evaluations,
                detail: format!("{:?}, cost {:e}", report.termination, 2.0 * report.objective_function),
            });
        }
        Ok(problem.parameters().as_slice().to_vec())
    }

    /// `‖W π − τ‖²`.
    pub fn residual(&self, parameters: &[f64]) -> Result<f64> {
        require_length("parameters", self.triangle.ncols(), parameters.len())?;
        let difference = &self.triangle * DVector::from_column_slice(parameters) - &self.right;
        Ok(difference.norm_squared() + self.unexplained)
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

/// Pseudo-inertia of ten parameters [kg, kg m, kg m²].
pub fn pseudo_inertia(pi: &[f64; PER_BODY]) -> Matrix4<f64> {
    let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *pi;
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let sigma = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
    let mut j = Matrix4::zeros();
    j.fixed_view_mut::<3, 3>(0, 0).copy_from(&sigma);
    for (i, h) in [hx, hy, hz].into_iter().enumerate() {
        j[(i, 3)] = h;
        j[(3, i)] = h;
    }
    j[(3, 3)] = m;
    j
}

/// Ten parameters of a pseudo-inertia; linear in it.
fn from_pseudo_inertia(j: &Matrix4<f64>) -> [f64; PER_BODY] {
    let trace = j[(0, 0)] + j[(1, 1)] + j[(2, 2)];
    [
        j[(3, 3)],
        j[(0, 3)],
        j[(1, 3)],
        j[(2, 3)],
        trace - j[(0, 0)],
        -j[(0, 1)],
        trace - j[(1, 1)],
        -j[(0, 2)],
        -j[(1, 2)],
        trace - j[(2, 2)],
    ]
}

/// Whether a body with these parameters can exist.
pub fn is_physically_consistent(pi: &[f64; PER_BODY]) -> bool {
    pseudo_inertia(pi).cholesky().is_some()
}

/// Coordinates (α, d1, d2, d3, s12, s13, s23, t1, t2, t3) of `J = U Uᵀ`,
/// `U = e^α [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]]`.
fn log_cholesky(body: usize, pi: &[f64]) -> Result<[f64; PER_BODY]> {
    let mut parameters = [0.0; PER_BODY];
    parameters.copy_from_slice(pi);
    let reversed = |j: &Matrix4<f64>| Matrix4::from_fn(|r, c| j[(3 - r, 3 - c)]);
    let factor = reversed(&pseudo_inertia(&parameters)).cholesky().ok_or_else(|| IdentificationError::Setting {
        name: format!("prior mass of body {body}"),
        value: pi[0],
        requirement: "the prior's pseudo-inertia must be positive definite (mass, inertia and centre of mass fit together)".into(),
    })?;
    let u = reversed(&factor.l());
    let scale = u[(3, 3)];
    let e = |r: usize, c: usize| u[(r, c)] / scale;
    Ok([
        scale.ln(),
        e(0, 0).ln(),
        e(1, 1).ln(),
        e(2, 2).ln(),
        e(0, 1),
        e(0, 2),
        e(1, 2),
        e(0, 3),
        e(1, 3),
        e(2, 3),
    ])
}

fn upper_factor(x: &[f64]) -> Matrix4<f64> {
    let u = Matrix4::new(
        x[1].exp(),
        x[4],
        x[5],
        x[7],
        0.0,
        x[2].exp(),
        x[6],
        x[8],
        0.0,
        0.0,
        x[3].exp(),
        x[9],
        0.0,
        0.0,
        0.0,
        1.0,
    );
    u * x[0].exp()
}

/// ∂U/∂xₖ.
fn upper_factor_derivative(x: &[f64], k: usize) -> Matrix4<f64> {
    const PLACES: [(usize, usize); 9] =
        [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)];
    if k == 0 {
        return upper_factor(x);
    }
    let mut d = Matrix4::zeros();
    d[PLACES[k - 1]] = x[0].exp() * if k <= 3 { x[k].exp() } else { 1.0 };
    d
}

/// Sizes of a body's parameters: m, m·r, m·r², with r the radius of gyration of the prior.
fn sizes(pi: &[f64]) -> [f64; PER_BODY] {
    let mass = pi[0];
    let radius = ((pi[4] + pi[6] + pi[9]) / (2.0 * mass)).sqrt();
    std::array::from_fn(|i| match i {
        0 => mass,
        1..=3 => mass * radius,
        _ => mass * radius * radius,
    })
}

struct ConsistentProblem<'a> {
    regression: &'a InertialRegression,
    bodies: usize,
    prior: DVector<f64>,
    scale: Vec<f64>,
    coordinates: DVector<f64>,
}

impl ConsistentProblem<'_> {
    fn parameters(&self) -> DVector<f64> {
        let body = |x: &[f64]| {
            let u = upper_factor(x);
            from_pseudo_inertia(&(u * u.transpose()))
        };
        let (bodies, others) = self.split();
        let all = bodies.chunks_exact(PER_BODY).flat_map(body);
        DVector::from_vec(all.chain(others.iter().map(|x| x.exp())).collect())
    }

    /// Coordinates of the bodies, and logarithms of the other parameters.
    fn split(&self) -> (&[f64], &[f64]) {
        self.coordinates.as_slice().split_at(self.bodies * PER_BODY)
    }

    /// ∂π/∂x, one 10 × 10 block per body, then a diagonal.
    fn parameter_jacobian(&self) -> DMatrix<f64> {
        let p = self.coordinates.len();
        let mut jacobian = DMatrix::zeros(p, p);
        let (bodies, others) = self.split();
        for (i, x) in others.iter().enumerate() {
            jacobian[(bodies.len() + i, bodies.len() + i)] = x.exp();
        }
        for (body, x) in bodies.chunks_exact(PER_BODY).enumerate() {
            let u = upper_factor(x);
            for k in 0..PER_BODY {
                let d = upper_factor_derivative(x, k) * u.transpose();
                for (i, value) in from_pseudo_inertia(&(d + d.transpose())).into_iter().enumerate() {
                    jacobian[(body * PER_BODY + i, body * PER_BODY + k)] = value;
                }
            }
        }
        jacobian
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for ConsistentProblem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, x: &OVector<f64, Dyn>) {
        self.coordinates.copy_from(x);
    }

    fn params(&self) -> OVector<f64, Dyn> {
        self.coordinates.clone()
    }

    fn residuals(&self) -> Option<OVector<f64, Dyn>> {
        let (pi, p) = (self.parameters(), self.coordinates.len());
        let data = &self.regression.triangle * &pi - &self.regression.right;
        Some(DVector::from_fn(2 * p, |i, _| {
            if i < p { data[i] } else { (pi[i - p] - self.prior[i - p]) * self.scale[i - p] }
        }))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, Dyn>> {
        let p = self.coordinates.len();
        let inner = self.parameter_jacobian();
        let mut jacobian = DMatrix::zeros(2 * p, p);
        jacobian.view_mut((0, 0), (p, p)).copy_from(&(&self.regression.triangle * &inner));
        for i in 0..p {
            jacobian.row_mut(p + i).copy_from(&(inner.row(i) * self.scale[i]));
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    /// A body made of point masses: consistent by construction.
    fn body(random: &mut SplitMix64) -> [f64; PER_BODY] {
        let mut j = Matrix4::zeros();
        for _ in 0..12 {
            let x = nalgebra::Vector4::new(
                0.1 * random.normal(),
                0.2 * random.normal(),
                0.1 * random.normal() + 0.1,
                1.0,
            );
            j += x * x.transpose() * (0.1 + random.uniform());
        }
        from_pseudo_inertia(&j)
    }

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|i| format!("p{i}")).collect()
    }

    #[test]
    fn coordinates_and_pseudo_inertia_invert_each_other() {
        let mut random = SplitMix64::new(1);
        for _ in 0..20 {
            let pi = body(&mut random);
            let x = log_cholesky(0, &pi).unwrap();
            let u = upper_factor(&x);
            let back = from_pseudo_inertia(&(u * u.transpose()));
            for (a, b) in pi.iter().zip(back) {
                assert!((a - b).abs() < 1e-12);
            }
            for k in 0..PER_BODY {
                let (mut plus, mut minus) = (x, x);
                plus[k] += 1e-6;
                minus[k] -= 1e-6;
                let numeric = (upper_factor(&plus) - upper_factor(&minus)) / 2e-6;
                assert!((numeric - upper_factor_derivative(&x, k)).amax() < 1e-8);
            }
            assert!(is_physically_consistent(&pi));
        }
        // Triangle inequality broken: Izz > Ixx + Iyy.
        assert!(!is_physically_consistent(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 2.5]));
        assert!(
            log_cholesky(3, &[-1.0; 10])
                .unwrap_err()
                .to_string()
                .starts_with("prior mass of body 3 = -1 is not possible")
        );
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

    #[test]
    fn consistent_estimates_follow_the_data_and_stay_possible() {
        let mut random = SplitMix64::new(3);
        let (truth, other) = (
            [body(&mut random), body(&mut random)].concat(),
            [body(&mut random), body(&mut random)].concat(),
        );
        // A regressor that shows 14 of the 20 directions, and noise that makes plain least squares
        // impossible.
        let mut mixing = DMatrix::from_fn(14, 20, |_, _| random.normal());
        for body in [0, PER_BODY] {
            // Drawn row by row of the inertia; π goes through the columns of its upper triangle.
            mixing.swap_columns(body + 5, body + 6);
        }
        let w = DMatrix::from_fn(400, 14, |_, _| random.normal()) * mixing;
        let torque: Vec<f64> =
            (&w * DVector::from_column_slice(&truth)).iter().map(|t| t + 0.05 * random.normal()).collect();
        let regression = InertialRegression::new(&names(20), &w, &torque, None).unwrap();
        let estimate = regression.consistent_estimate(&other, 2, 1e-4).unwrap();
        for pi in estimate.chunks_exact(PER_BODY) {
            assert!(is_physically_consistent(pi.try_into().unwrap()));
        }
        let (fitted, prior) = (regression.residual(&estimate).unwrap(), regression.residual(&other).unwrap());
        assert!(fitted < 1.1 * 400.0 * 0.05 * 0.05 && fitted < 1e-2 * prior, "{fitted} {prior}");
        // A rotor's inertia behind the bodies: the last column scaled, so that it can be told from the rest.
        let mut with_rotor = w.clone().insert_column(20, 0.0).insert_row(400, 0.0);
        with_rotor[(400, 20)] = 10.0;
        let mut torque = torque;
        torque.push(10.0 * 0.7);
        let larger = InertialRegression::new(&names(21), &with_rotor, &torque, None).unwrap();
        let prior = [other.clone(), vec![0.1]].concat();
        let found = larger.consistent_estimate(&prior, 2, 1e-4).unwrap();
        assert!((found[20] - 0.7).abs() < 0.01, "{}", found[20]);
        let prior = [other.clone(), vec![-0.1]].concat();
        let message = larger.consistent_estimate(&prior, 2, 1e-4).unwrap_err().to_string();
        assert!(message.starts_with("prior of parameter 1 behind the bodies = -0.1"), "{message}");
        let again = regression.consistent_estimate(&estimate, 2, 1e3).unwrap();
        for (a, b) in again.iter().zip(&estimate) {
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
        assert!(regression.consistent_estimate(&[0.0; 10], 1, 1.0).is_err());
    }
}
