//! Vectors and matrices of numbers that carry derivatives.

use crate::dual::Number;

/// A vector in the base frame.
pub type Vector<T> = [T; 3];

/// Rows first.
pub type Matrix<T> = [[T; 3]; 3];

pub(super) const IDENTITY: Matrix<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The entry of the identity matrix.
pub(crate) fn unit(i: usize, j: usize) -> f64 {
    f64::from(u8::from(i == j))
}

pub(super) fn stacked<T: Number>(a: Vector<T>, b: Vector<T>) -> [T; 6] {
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// The vector of the antisymmetric part.
pub(super) fn axial<T: Number>(a: &Matrix<T>) -> Vector<T> {
    [(2, 1), (0, 2), (1, 0)].map(|(i, j)| (a[i][j] - a[j][i]) * 0.5)
}

pub(super) fn constant<T: Number>(a: [f64; 3]) -> Vector<T> {
    a.map(T::from)
}

pub(super) fn constant_matrix<T: Number>(a: Matrix<f64>) -> Matrix<T> {
    a.map(constant)
}

pub(super) fn symmetric<T: Number>([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix<T> {
    constant_matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
}

pub(super) fn add<T: Number>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn subtract<T: Number>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn scale<T: Number>(a: &Vector<T>, factor: T) -> Vector<T> {
    a.map(|a| a * factor)
}

pub(super) fn dot<T: Number>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<T: Number>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn times<T: Number>(a: &Matrix<T>, b: &Vector<T>) -> Vector<T> {
    a.each_ref().map(|row| dot(row, b))
}

pub(super) fn transposed<T: Number>(a: &Matrix<T>) -> Matrix<T> {
    [0, 1, 2].map(|i| [a[0][i], a[1][i], a[2][i]])
}

pub(super) fn product<T: Number>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    let columns = transposed(b);
    a.each_ref().map(|row| columns.each_ref().map(|column| dot(row, column)))
}

/// Rotation about a unit axis (Rodrigues 1840): `1 + sin θ [a] + (1 − cos θ) [a]²`.
pub(super) fn turn<T: Number>(axis: [f64; 3], angle: T) -> Matrix<T> {
    let [x, y, z] = axis;
    let hat = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let square = product(&hat, &hat);
    let (sine, cosine) = angle.sin_cos();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| sine * hat[i][j] + (-cosine + 1.0) * square[i][j] + unit(i, j)))
}
