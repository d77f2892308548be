//! 3 × 3 matrices.

use std::ops::{Add, Index, IndexMut};

use super::twist::Twist;
use super::vector::{Symmetric3, Vector3};
use crate::graph::Scalar;

/// A 3 × 3 matrix of expressions, as a list of rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matrix3<'g>(pub [[Scalar<'g>; 3]; 3]);

impl<'g> Matrix3<'g> {
    /// The matrix with the entries `entry(row, column)`.
    pub fn from_fn(entry: impl Fn(usize, usize) -> Scalar<'g>) -> Self {
        Self([0, 1, 2].map(|row| [0, 1, 2].map(|column| entry(row, column))))
    }

    /// The zero matrix on the graph of the scalar `any`.
    pub fn zero(any: Scalar<'g>) -> Self {
        Self([[any.constant(0.0); 3]; 3])
    }

    /// `factor · 1`: a multiple of the identity.
    pub fn diagonal(factor: Scalar<'g>) -> Self {
        let zero = factor.constant(0.0);
        Self::from_fn(|row, column| if row == column { factor } else { zero })
    }

    /// `v×`: the matrix of the cross product with a vector.
    pub fn cross(v: Vector3<Scalar<'g>>) -> Self {
        let zero = v[0].constant(0.0);
        Self([[zero, -v[2], v[1]], [v[2], zero, -v[0]], [-v[1], v[0], zero]])
    }

    /// `ω× Σ`: the cross product of ω with each column of the symmetric matrix Σ.
    pub fn cross_of(omega: Vector3<Scalar<'g>>, second: Symmetric3<Scalar<'g>>) -> Self {
        let columns = second.columns().map(|column| omega.cross(column));
        Self::from_fn(|row, column| columns[column][row])
    }

    /// Column `k` of the matrix.
    pub fn column(&self, k: usize) -> Vector3<Scalar<'g>> {
        Vector3([self[0][k], self[1][k], self[2][k]])
    }

    /// The transpose `Aᵀ` of this matrix A.
    pub fn transposed(&self) -> Self {
        Self([0, 1, 2].map(|k| self.column(k).0))
    }

    /// The product `A v` of this matrix A and a vector.
    pub fn times(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        Vector3(self.0.map(|row| Vector3(row).dot(v)))
    }

    /// The product `Aᵀ v` of the transpose of this matrix A and a vector.
    pub fn transposed_times(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        Vector3([0, 1, 2].map(|k| self.column(k).dot(v)))
    }

    /// The product `A B` of this matrix A and the other matrix B.
    pub fn product(&self, other: &Self) -> Self {
        Self(self.0.map(|row| other.transposed_times(Vector3(row)).0))
    }

    /// The product `(tr A − A) v` of this matrix A and a vector v.
    pub fn complement_times(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let a = self;
        Vector3([
            (a[1][1] + a[2][2]) * v[0] - a[0][1] * v[1] - a[0][2] * v[2],
            (a[0][0] + a[2][2]) * v[1] - a[1][0] * v[0] - a[1][2] * v[2],
            (a[0][0] + a[1][1]) * v[2] - a[2][0] * v[0] - a[2][1] * v[1],
        ])
    }

    /// This matrix A after a rotation about z, `R_z(φ) A R_z(φ)ᵀ`. The argument is the sine and cosine of φ.
    ///
    /// The product needs only 12 multiplications and 11 additions, because the rotation changes neither the
    /// trace nor the antisymmetric part of the block of x and y.
    pub fn turned(&self, (s, c): (Scalar<'g>, Scalar<'g>)) -> Self {
        let a = self;
        let across = s * (a[0][0] - a[1][1]) + c * (a[0][1] + a[1][0]);
        let (moved, sheared) = (s * across, c * across);
        let column = a.column(2).turned((s, c));
        let row = Vector3(a[2]).turned((s, c));
        Self([
            [a[0][0] - moved, sheared - a[1][0], column[0]],
            [sheared - a[0][1], a[1][1] + moved, column[1]],
            row.0,
        ])
    }

    /// Transforms this matrix A to the parent's axes, `R A Rᵀ` with the constant rotation R.
    pub fn twisted(&self, twist: &Twist) -> Self {
        let columns = [0, 1, 2].map(|k| twist.to_parent(self.column(k)));
        let row = |i: usize| Vector3([columns[0][i], columns[1][i], columns[2][i]]);
        Self([0, 1, 2].map(|i| twist.to_parent(row(i)).0))
    }
}

impl<'g> Index<usize> for Matrix3<'g> {
    type Output = [Scalar<'g>; 3];
    fn index(&self, row: usize) -> &[Scalar<'g>; 3] {
        &self.0[row]
    }
}

impl<'g> IndexMut<usize> for Matrix3<'g> {
    fn index_mut(&mut self, row: usize) -> &mut [Scalar<'g>; 3] {
        &mut self.0[row]
    }
}

impl Add for Matrix3<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::from_fn(|row, column| self[row][column] + other[row][column])
    }
}
