//! Linear system of equations for a step of the implicit midpoint rule.

/// Right-hand sides of the linear system. [`solve`] overwrites them by the solutions: the derivatives of the
/// velocity change with respect to positions, velocities and inputs, and the velocity change due to the
/// residual.
pub(super) struct Columns<const N: usize, const M: usize> {
    pub by_y: [[f64; N]; N],
    pub by_v: [[f64; N]; N],
    pub by_u: [[f64; M]; N],
    pub rest: [f64; N],
}

impl<const N: usize, const M: usize> Columns<N, M> {
    /// Subtracts `factor` times row `k` from row `i`.
    #[inline]
    fn subtract(&mut self, i: usize, factor: f64, k: usize) {
        subtract(&mut self.by_y, i, factor, k);
        subtract(&mut self.by_v, i, factor, k);
        subtract(&mut self.by_u, i, factor, k);
        self.rest[i] -= factor * self.rest[k];
    }

    #[inline]
    fn scale(&mut self, i: usize, factor: f64) {
        self.by_y[i].iter_mut().for_each(|entry| *entry *= factor);
        self.by_v[i].iter_mut().for_each(|entry| *entry *= factor);
        self.by_u[i].iter_mut().for_each(|entry| *entry *= factor);
        self.rest[i] *= factor;
    }

    #[inline]
    fn swap(&mut self, i: usize, k: usize) {
        self.by_y.swap(i, k);
        self.by_v.swap(i, k);
        self.by_u.swap(i, k);
        self.rest.swap(i, k);
    }
}

/// Subtracts `factor` times row `k` from row `i`. The compiler vectorizes this operation on whole rows.
#[inline]
fn subtract<const N: usize, const C: usize>(rows: &mut [[f64; C]; N], i: usize, factor: f64, k: usize) {
    let other = rows[k];
    for (entry, other) in rows[i].iter_mut().zip(&other) {
        *entry -= factor * other;
    }
}

/// Solves the system by Gaussian elimination with partial pivoting (Golub and Van Loan, Matrix Computations, 2013, section 3.4).
/// The result is not finite if the matrix is singular.
#[inline]
pub(super) fn solve<const N: usize, const M: usize>(matrix: &mut [[f64; N]; N], columns: &mut Columns<N, M>) {
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if matrix[i][k].abs() > matrix[pivot][k].abs() {
                pivot = i;
            }
        }
        if pivot != k {
            matrix.swap(k, pivot);
            columns.swap(k, pivot);
        }
        let inverse = 1.0 / matrix[k][k];
        for i in k + 1..N {
            let factor = matrix[i][k] * inverse;
            subtract(matrix, i, factor, k);
            columns.subtract(i, factor, k);
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            columns.subtract(k, matrix[k][j], j);
        }
        columns.scale(k, 1.0 / matrix[k][k]);
    }
}

/// Product of the matrices a and b.
#[inline]
pub(super) fn times<const N: usize, const C: usize>(a: &[[f64; N]; N], b: &[[f64; C]; N]) -> [[f64; C]; N] {
    let mut result = [[0.0; C]; N];
    for i in 0..N {
        for k in 0..N {
            for j in 0..C {
                result[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    result
}
