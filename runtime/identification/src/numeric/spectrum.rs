//! Eigenvalues and singular values. nalgebra panics on empty matrices. On matrices with NaN or infinity, which logs and
//! descriptions may cause, it panics or does not return. For all these matrices the functions of this module return NaN.
#![allow(
    clippy::disallowed_methods,
    reason = "this module guards the functions that other modules must not call"
)]

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, Dim, DimDiff, DimMin, DimMinimum, DimSub, OMatrix, OVector};
use nalgebra::{SVD, SymmetricEigen, U1};

/// Eigenvalues and eigenvectors of a symmetric matrix.
pub(crate) fn symmetric_eigen<D: DimSub<U1>>(matrix: OMatrix<f64, D, D>) -> SymmetricEigen<f64, D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<DimDiff<D, U1>>,
{
    if can_be_decomposed(&matrix) {
        return SymmetricEigen::new(matrix);
    }
    let (rows, columns) = matrix.shape_generic();
    SymmetricEigen {
        eigenvectors: OMatrix::from_element_generic(rows, columns, f64::NAN),
        eigenvalues: OVector::from_element_generic(rows, Const::<1>, f64::NAN),
    }
}

/// Eigenvalues of a symmetric matrix.
pub(crate) fn symmetric_eigenvalues<D: DimSub<U1>>(matrix: &OMatrix<f64, D, D>) -> OVector<f64, D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<DimDiff<D, U1>>,
{
    match can_be_decomposed(matrix) {
        true => matrix.symmetric_eigenvalues(),
        false => OVector::from_element_generic(matrix.shape_generic().0, Const::<1>, f64::NAN),
    }
}

/// Singular values in descending order, with left and right singular vectors.
pub(crate) fn svd<R: DimMin<C>, C: Dim>(matrix: OMatrix<f64, R, C>) -> SVD<f64, R, C>
where
    DimMinimum<R, C>: DimSub<U1>,
    DefaultAllocator: Allocator<R, C>
        + Allocator<R>
        + Allocator<C>
        + Allocator<DimMinimum<R, C>>
        + Allocator<DimMinimum<R, C>, C>
        + Allocator<R, DimMinimum<R, C>>
        + Allocator<DimDiff<DimMinimum<R, C>, U1>>,
{
    if can_be_decomposed(&matrix) {
        return SVD::new(matrix, true, true);
    }
    let (rows, columns) = matrix.shape_generic();
    let least = rows.min(columns);
    SVD {
        u: Some(OMatrix::from_element_generic(rows, least, f64::NAN)),
        v_t: Some(OMatrix::from_element_generic(least, columns, f64::NAN)),
        singular_values: OVector::from_element_generic(least, Const::<1>, f64::NAN),
    }
}

fn can_be_decomposed<R: Dim, C: Dim>(matrix: &OMatrix<f64, R, C>) -> bool
where
    DefaultAllocator: Allocator<R, C>,
{
    !matrix.is_empty() && matrix.iter().all(|entry| entry.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, Matrix4};

    #[test]
    fn matrices_without_a_spectrum_have_none() {
        let nothing = DMatrix::<f64>::zeros(0, 3);
        assert_eq!(svd(nothing).singular_values.len(), 0);
        assert_eq!(symmetric_eigen(DMatrix::<f64>::zeros(0, 0)).eigenvalues.len(), 0);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut matrix = Matrix4::identity();
            matrix[(2, 1)] = bad;
            assert!(svd(matrix).singular_values.iter().all(|value| value.is_nan()));
            assert!(symmetric_eigenvalues(&matrix).iter().all(|value| value.is_nan()));
            let eigen = symmetric_eigen(DMatrix::from_element(3, 3, bad));
            assert!(eigen.eigenvalues.iter().chain(&eigen.eigenvectors).all(|entry| entry.is_nan()));
        }
    }
}
