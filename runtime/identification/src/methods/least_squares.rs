//! Linear least squares on subsets of the terms, with a check for ill-conditioned libraries.

use super::super::error::{IdentificationError, Result, require_length, require_samples};
use super::super::numeric::spectrum::{svd, symmetric_eigen};
use super::moments::{Moments, Samples};
use nalgebra::{DMatrix, DVector};

/// Condition number of the library above which the samples are factored orthogonally. The normal equations square the
/// condition number, so they lose six digits at this limit.
const NORMAL_EQUATIONS_LIMIT: f64 = 1e3;

/// Condition number above which a library counts as collinear.
pub(crate) const COLLINEAR_LIMIT: f64 = 1e10;

/// Data of a regression with the matrix Θ of the terms and the targets Y, reduced to the sums that its solution needs.
#[derive(Debug, Clone)]
pub struct Reduced {
    moments: Moments,
    /// Upper triangular factor R of `[Θ | Y] = Q R`, with the columns Θ of the terms and the targets Y;
    /// `None` if the condition number is small enough for the normal equations.
    triangle: Option<DMatrix<f64>>,
    condition: f64,
}

/// Least-squares solution on some of the terms of a library.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Coefficients of all p terms. The coefficients of terms that were not chosen are zero.
    pub coefficients: DVector<f64>,
    /// Indices of the chosen terms in ascending order.
    pub active: Vec<usize>,
    /// Residual sum of squares, RSS.
    pub residual: f64,
    /// Residual variance `RSS / (m − |active|)` for m samples and |active| chosen terms; 0 if the denominator is zero.
    pub variance: f64,
    /// Standard error of each chosen coefficient, in the order of [`Self::active`], for independent errors of equal
    /// variance.
    pub standard_errors: Vec<f64>,
}

impl Reduced {
    /// Reduces the samples to their sums in one pass. If the library is ill-conditioned, an orthogonal factorization
    /// follows in a second pass.
    ///
    /// # Errors
    /// - [`NotFinite`](IdentificationError::NotFinite): a value is not finite
    /// - [`Overflow`](IdentificationError::Overflow): squares of the values overflow
    /// - [`ZeroColumn`](IdentificationError::ZeroColumn): a term is zero in all samples
    /// - [`Collinear`](IdentificationError::Collinear): terms are collinear
    /// - [`TooFewSamples`](IdentificationError::TooFewSamples): there are fewer samples than terms
    pub fn new(samples: &Samples) -> Result<Self> {
        let moments = Moments::new(samples)?;
        require_samples("least squares with this library", moments.terms(), moments.samples())?;
        moments.require_no_zero_column()?;
        let condition = moments.condition();
        if condition <= NORMAL_EQUATIONS_LIMIT {
            return Ok(Self { moments, triangle: None, condition });
        }
        let triangle = triangular_factor(samples);
        let condition = require_independent(&triangle, moments.names())?;
        Ok(Self { moments, triangle: Some(triangle), condition })
    }

    /// Creates the data from given sums, if the samples are not available.
    ///
    /// # Errors
    /// The errors are those of [`Self::new`]. However, terms count as collinear already above a condition number of 1e7,
    /// because the sums are not accurate enough.
    pub fn from_moments(moments: Moments) -> Result<Self> {
        require_samples("least squares with this library", moments.terms(), moments.samples())?;
        moments.require_no_zero_column()?;
        let condition = moments.condition();
        if condition > 1e7 {
            return Err(collinear(&moments.correlation(), moments.names(), condition, 1e7));
        }
        Ok(Self { moments, triangle: None, condition })
    }

    /// Returns the sums of products of the data.
    pub fn moments(&self) -> &Moments {
        &self.moments
    }

    /// Returns the condition number of the matrix Θ of the terms, with columns scaled to unit length.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Whether the solution is computed by orthogonal factorization, because the columns are nearly collinear.
    pub(crate) fn is_orthogonal(&self) -> bool {
        self.triangle.is_some()
    }

    /// Minimizes `‖y − Θ ξ‖² + ridge ‖ξ‖²` over the coefficients ξ of the terms `active`, with the target y
    /// and the columns Θ of these terms.
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if a term or the target is out of range, [`IdentificationError::Collinear`] if the
    /// factorization fails.
    pub(crate) fn solve(&self, target: usize, active: &[usize], ridge: f64) -> Result<DVector<f64>> {
        self.check(target, active)?;
        let small = match &self.triangle {
            None => solve_scaled(&self.moments.gram(), &self.moments.projection(target), active, ridge),
            Some(triangle) => solve_triangular(triangle, self.moments.terms() + target, active, ridge),
        };
        let small = small.ok_or_else(|| {
            let names: Vec<String> = active.iter().map(|&i| self.moments.names()[i].clone()).collect();
            IdentificationError::Collinear { terms: names, condition: self.condition, limit: COLLINEAR_LIMIT }
        })?;
        let mut coefficients = DVector::zeros(self.moments.terms());
        for (&i, value) in active.iter().zip(small.iter()) {
            coefficients[i] = *value;
        }
        Ok(coefficients)
    }

    /// Solves least squares on the terms `active`, with standard errors.
    ///
    /// - `target`: index of the target column
    /// - `active`: indices of the terms in ascending order
    ///
    /// # Errors
    /// [`IdentificationError::Shape`] if a term or the target is out of range, [`IdentificationError::Collinear`] if the
    /// terms are collinear.
    pub fn fit(&self, target: usize, active: &[usize]) -> Result<Solution> {
        let coefficients = self.solve(target, active, 0.0)?;
        let residual = self.residual(target, &coefficients);
        let freedom = self.moments.samples().saturating_sub(active.len());
        let variance = if freedom == 0 { 0.0 } else { residual / freedom as f64 };
        Ok(Solution {
            standard_errors: self.inverse_diagonal(active).iter().map(|d| (d * variance).sqrt()).collect(),
            coefficients,
            active: active.to_vec(),
            residual,
            variance,
        })
    }

    /// Returns the residual sum of squares for given coefficients.
    pub(crate) fn residual(&self, target: usize, coefficients: &DVector<f64>) -> f64 {
        let Some(triangle) = &self.triangle else {
            return self.moments.residual(target, coefficients);
        };
        let p = self.moments.terms();
        (triangle.column(p + target) - triangle.columns(0, p) * coefficients).norm_squared()
    }

    fn check(&self, target: usize, active: &[usize]) -> Result<()> {
        self.moments.require_target(target)?;
        match active.iter().find(|&&i| i >= self.moments.terms()) {
            Some(i) => require_length("terms", i + 1, self.moments.terms()),
            None => Ok(()),
        }
    }

    /// Returns the diagonal of `(ΘₐᵀΘₐ)⁻¹` for the columns Θₐ of the active terms.
    fn inverse_diagonal(&self, active: &[usize]) -> Vec<f64> {
        let r = match &self.triangle {
            Some(triangle) => triangle.select_columns(active).qr().r(),
            None => {
                let gram = self.moments.gram().select_rows(active).select_columns(active);
                match gram.cholesky() {
                    Some(factor) => factor.l().transpose(),
                    None => return vec![f64::INFINITY; active.len()],
                }
            }
        };
        let identity = DMatrix::identity(active.len(), active.len());
        match r.solve_upper_triangular(&identity) {
            Some(inverse) => inverse.row_iter().map(|row| row.norm_squared()).collect(),
            None => vec![f64::INFINITY; active.len()],
        }
    }
}

/// Solves the normal equations on the terms `active` with columns scaled to unit length; `None` if the equations are
/// singular.
pub(crate) fn solve_scaled(
    gram: &DMatrix<f64>,
    b: &DVector<f64>,
    active: &[usize],
    ridge: f64,
) -> Option<DVector<f64>> {
    let n = active.len();
    let diagonal: Vec<f64> = active.iter().map(|&i| (gram[(i, i)] + ridge).sqrt()).collect();
    if diagonal.iter().any(|d| *d <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        let ridge = if i == j { ridge } else { 0.0 };
        (gram[(active[i], active[j])] + ridge) / (diagonal[i] * diagonal[j])
    });
    let right = DVector::from_fn(n, |i, _| b[active[i]] / diagonal[i]);
    let solution = scaled.cholesky()?.solve(&right);
    Some(DVector::from_fn(n, |i, _| solution[i] / diagonal[i]))
}

fn solve_triangular(
    triangle: &DMatrix<f64>,
    target: usize,
    active: &[usize],
    ridge: f64,
) -> Option<DVector<f64>> {
    let (q, n) = (triangle.nrows(), active.len());
    let extra = if ridge > 0.0 { n } else { 0 };
    let mut matrix = DMatrix::zeros(q + extra, n);
    matrix.view_mut((0, 0), (q, n)).copy_from(&triangle.select_columns(active));
    for i in 0..extra {
        matrix[(q + i, i)] = ridge.sqrt();
    }
    let mut right = DVector::zeros(q + extra);
    right.rows_mut(0, q).copy_from(&triangle.column(target));
    let qr = matrix.qr();
    qr.q_tr_mul(&mut right);
    qr.r().solve_upper_triangular(&right.rows(0, n).into_owned())
}

/// Returns the factor R of the Householder factorization of `[Θ | Y]`, with the columns Θ of the terms and
/// the targets Y. R is a q × q matrix for q columns, and is computed block by block.
pub(crate) fn triangular_factor(samples: &Samples) -> DMatrix<f64> {
    let q = samples.width();
    let mut r = DMatrix::<f64>::zeros(q, q);
    samples.visit(0..samples.len(), &mut |columns| {
        let n = columns[0].len();
        let stacked = DMatrix::from_fn(q + n, q, |i, j| if i < q { r[(i, j)] } else { columns[j][i - q] });
        r = stacked.qr().r();
    });
    r
}

/// Returns the condition number of the terms' columns, scaled to unit length, from the triangular factor.
/// Fails above [`COLLINEAR_LIMIT`].
fn require_independent(triangle: &DMatrix<f64>, names: &[String]) -> Result<f64> {
    let p = names.len();
    let mut scaled = triangle.view((0, 0), (p, p)).into_owned();
    for mut column in scaled.column_iter_mut() {
        column.normalize_mut();
    }
    let decomposed = svd(scaled);
    let (least, largest) = (decomposed.singular_values.min(), decomposed.singular_values.max());
    let condition = if least > 0.0 { largest / least } else { f64::INFINITY };
    if condition <= COLLINEAR_LIMIT {
        return Ok(condition);
    }
    let index = decomposed.singular_values.imin();
    let direction = decomposed.v_t.map(|v| v.row(index).transpose()).unwrap_or_else(|| DVector::zeros(p));
    Err(IdentificationError::Collinear {
        terms: taking_part(&direction, names),
        condition,
        limit: COLLINEAR_LIMIT,
    })
}

fn collinear(
    correlation: &DMatrix<f64>,
    names: &[String],
    condition: f64,
    limit: f64,
) -> IdentificationError {
    let eigen = symmetric_eigen(correlation.clone());
    let direction = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    IdentificationError::Collinear { terms: taking_part(&direction, names), condition, limit }
}

/// Returns the terms with a noticeable share in a null direction.
fn taking_part(direction: &DVector<f64>, names: &[String]) -> Vec<String> {
    let bound = 0.1 * direction.amax();
    (0..names.len()).filter(|&i| direction[i].abs() >= bound).map(|i| names[i].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::library::Library;
    use super::*;
    use crate::numeric::random::SplitMix64;

    fn line(m: usize) -> (Vec<f64>, Vec<f64>) {
        let x: Vec<f64> = (0..m).map(|i| i as f64 / m as f64).collect();
        let y = x.iter().map(|x| 3.0 - 2.0 * x).collect();
        (x, y)
    }

    #[test]
    fn standard_errors_match_the_closed_form_of_a_line() {
        let (x, mut y) = line(50);
        let mut random = SplitMix64::new(3);
        y.iter_mut().for_each(|y| *y += random.normal());
        let library = Library::new(&["1", "x"], &["x"]).unwrap();
        let samples = Samples::from_library(&library, vec![&x], vec![&y]).unwrap();
        let fit = Reduced::new(&samples).unwrap().fit(0, &[0, 1]).unwrap();
        let mean = x.iter().sum::<f64>() / 50.0;
        let my = y.iter().sum::<f64>() / 50.0;
        let sxx: f64 = x.iter().map(|x| (x - mean).powi(2)).sum();
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mean) * (y - my)).sum::<f64>() / sxx;
        let rss: f64 = x.iter().zip(&y).map(|(x, y)| (y - my - slope * (x - mean)).powi(2)).sum();
        assert!((fit.coefficients[1] - slope).abs() < 1e-12);
        assert!((fit.standard_errors[1] - (rss / 48.0 / sxx).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn ill_conditioned_libraries_are_solved_orthogonally() {
        // Monomials up to degree 9 on [0, 1] have a condition number of about 1e7, at which the normal equations keep no
        // digit.
        let (x, _) = line(2000);
        let terms: Vec<String> = (0..10).map(|i| format!("powi(x, {i})")).collect();
        let library = Library::new(&terms, &["x"]).unwrap();
        let truth: Vec<f64> = (0..10).map(|i| f64::from(i - 4)).collect();
        let y: Vec<f64> = x.iter().map(|x| truth.iter().rev().fold(0.0, |s, c| s * x + c)).collect();
        let samples = Samples::from_library(&library, vec![&x], vec![&y]).unwrap();
        let reduced = Reduced::new(&samples).unwrap();
        assert!(reduced.is_orthogonal());
        let all: Vec<usize> = (0..10).collect();
        let solution = reduced.solve(0, &all, 0.0).unwrap();
        for (got, want) in solution.iter().zip(&truth) {
            assert!(
                (got - want).abs() < 1e-7,
                "{got} instead of {want}, condition {:e}",
                reduced.condition()
            );
        }
    }

    #[test]
    fn collinear_terms_are_named() {
        let (x, y) = line(300);
        let library = Library::new(&["1", "x", "powi(x, 2)", "3 - 2*x"], &["x"]).unwrap();
        let samples = Samples::from_library(&library, vec![&x], vec![&y]).unwrap();
        let message = Reduced::new(&samples).unwrap_err().to_string();
        assert!(message.contains("cannot distinguish the friction terms 1, x, 3 - 2*x."), "{message}");
        let library = Library::new(&["x", "0*x"], &["x"]).unwrap();
        let samples = Samples::from_library(&library, vec![&x], vec![&y]).unwrap();
        assert!(Reduced::new(&samples).unwrap_err().to_string().contains("0*x is zero in all 300 samples"));
        let library = Library::new(&["1", "x", "x*x"], &["x"]).unwrap();
        let samples = Samples::from_library(&library, vec![&x[..2]], vec![&y[..2]]).unwrap();
        let message = Reduced::new(&samples).unwrap_err().to_string();
        assert!(message.contains("at least 3 samples, but there are 2"));
    }

    #[test]
    fn ridge_agrees_between_both_solvers() {
        let (x, y) = line(400);
        let library = Library::new(&["1", "x", "sin(x)"], &["x"]).unwrap();
        let samples = Samples::from_library(&library, vec![&x], vec![&y]).unwrap();
        let reduced = Reduced::new(&samples).unwrap();
        let triangle = triangular_factor(&samples);
        for ridge in [0.5, 10.0] {
            let normal =
                solve_scaled(&reduced.moments.gram(), &reduced.moments.projection(0), &[0, 1, 2], ridge)
                    .unwrap();
            let orthogonal = solve_triangular(&triangle, 3, &[0, 1, 2], ridge).unwrap();
            assert!((normal - orthogonal).amax() < 1e-10);
        }
    }
}
