//! Rotations that depend on the state.

use super::matrix::Matrix3;
use super::vector::{Symmetric3, Vector3};
use crate::graph::Scalar;

/// A rotation matrix over scalars. Its columns are the axes x, y, z of the rotated frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude<S>(pub [Vector3<S>; 3]);

impl<S> Attitude<S> {
    /// Applies `f` to each entry of the rotation matrix.
    pub fn map<T>(self, mut f: impl FnMut(S) -> T) -> Attitude<T> {
        Attitude(self.0.map(|column| column.map(&mut f)))
    }
}

impl<'g> Attitude<Scalar<'g>> {
    /// Rotation of a unit quaternion x y z w (Shuster 1993, section V).
    pub fn of_quaternion([x, y, z, w]: [Scalar<'g>; 4]) -> Self {
        let one = x.constant(1.0);
        let (xx, yy, zz) = (x.squared(), y.squared(), z.squared());
        let (xy, xz, yz) = (x * y, x * z, y * z);
        let (xw, yw, zw) = (x * w, y * w, z * w);
        let diagonal = |a: Scalar<'g>, b: Scalar<'g>| one - (a + b) * 2.0;
        Self([
            Vector3([diagonal(yy, zz), (xy + zw) * 2.0, (xz - yw) * 2.0]),
            Vector3([(xy - zw) * 2.0, diagonal(xx, zz), (yz + xw) * 2.0]),
            Vector3([(xz + yw) * 2.0, (yz - xw) * 2.0, diagonal(xx, yy)]),
        ])
    }

    /// The same rotation for frames with permuted axes: axis i of the new frames is axis `axes[i]` of the old
    /// frames.
    pub fn permuted(self, axes: [usize; 3]) -> Self {
        Self(axes.map(|column| Vector3(axes.map(|row| self.0[column][row]))))
    }

    /// `R v`: transforms a vector from the rotated frame to the parent's frame.
    pub fn to_parent(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        let [x, y, z] = self.0;
        x.scaled(v[0]) + y.scaled(v[1]) + z.scaled(v[2])
    }

    /// `Rᵀ v`: transforms a vector from the parent's frame to the rotated frame.
    pub fn to_child(&self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        Vector3(self.0.map(|axis| axis.dot(v)))
    }

    /// `R A Rᵀ`: transforms a matrix from the rotated frame to the parent's frame.
    pub fn matrix_to_parent(&self, a: &Matrix3<'g>) -> Matrix3<'g> {
        let columns = [0, 1, 2].map(|k| self.to_parent(a.column(k)));
        let row = |i: usize| Vector3([columns[0][i], columns[1][i], columns[2][i]]);
        Matrix3([0, 1, 2].map(|i| self.to_parent(row(i)).0))
    }

    /// `R Σ Rᵀ`: transforms a symmetric matrix Σ from the rotated frame to the parent's frame.
    pub fn symmetric_to_parent(&self, s: Symmetric3<Scalar<'g>>) -> Symmetric3<Scalar<'g>> {
        let columns = s.columns().map(|column| self.to_parent(column));
        let row = |i: usize| Vector3([columns[0][i], columns[1][i], columns[2][i]]);
        // Product of row i of R Σ and column j of Rᵀ.
        let axis = |j: usize| Vector3([self.0[0][j], self.0[1][j], self.0[2][j]]);
        let entry = |i: usize, j: usize| row(i).dot(axis(j));
        Symmetric3::new([entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)])
    }
}
