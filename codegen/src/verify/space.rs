//! Vectors and rotation matrices in space. Matrices are row-major.

use super::number::Number;

pub type Vector<T> = [T; 3];
pub type Matrix<T> = [[T; 3]; 3];

pub fn constant<T: Number>(a: [f64; 3]) -> Vector<T> {
    a.map(T::constant)
}

pub fn add<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn subtract<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    add(a, b.map(|x| -x))
}

pub fn sum<T: Number, const K: usize>(parts: [Vector<T>; K]) -> Vector<T> {
    parts.into_iter().fold(constant([0.0; 3]), add)
}

pub fn scale<T: Number>(a: Vector<T>, factor: T) -> Vector<T> {
    a.map(|x| x * factor)
}

pub fn dot<T: Number>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross<T: Number>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn times<T: Number>(a: &Matrix<T>, b: Vector<T>) -> Vector<T> {
    a.map(|row| dot(row, b))
}

pub fn transposed<T: Number>(a: &Matrix<T>) -> Matrix<T> {
    [0, 1, 2].map(|i| [a[0][i], a[1][i], a[2][i]])
}

pub fn product<T: Number>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    let columns = transposed(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

/// Product of two rotation matrices. All its entries have the same error. Along a chain of joints this error
/// only adds up. Errors of separate sums of products would grow by a factor with each joint.
pub fn rotation_product<T: Number>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    let error = largest(a) * largest(b);
    product(a, b).map(|row| row.map(|x| x.with_error_of(error)))
}

fn largest<T: Number>(a: &Matrix<T>) -> T {
    a.iter().flatten().fold(T::zero(), |largest, &x| largest.larger(x))
}

/// A constant rotation matrix with entries of the number type.
pub fn rotation<T: Number>(a: [[f64; 3]; 3]) -> Matrix<T> {
    a.map(|row| row.map(|x| T::constant(x).with_error_of(T::constant(1.0))))
}

/// Rotation matrix `1 + sin θ [a] + (1 − cos θ) [a]²` about a unit axis a (Rodrigues 1840).
pub fn turn<T: Number>([x, y, z]: [f64; 3], angle: T) -> Matrix<T> {
    let hat = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]].map(constant::<T>);
    let square = product(&hat, &hat);
    let (sine, cosine) = angle.sin_cos();
    let unit = |i: usize, j: usize| T::constant(f64::from(u8::from(i == j)));
    let entry = |i: usize, j: usize| {
        let sum = sine * hat[i][j] + (T::constant(1.0) - cosine) * square[i][j] + unit(i, j);
        sum.with_error_of(sine.larger(cosine))
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// Rotation matrix of a unit quaternion x y z w.
pub fn attitude<T: Number>([x, y, z, w]: [T; 4]) -> Matrix<T> {
    let two = T::constant(2.0);
    let one = T::constant(1.0);
    let norm = x.larger(y).larger(z).larger(w);
    let rows = [
        [one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)],
        [two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)],
        [two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)],
    ];
    rows.map(|row| row.map(|entry| entry.with_error_of(two * norm * norm)))
}

/// The product of two quaternions x y z w.
pub fn quaternion_product<T: Number>([x, y, z, w]: [T; 4], [a, b, c, d]: [T; 4]) -> [T; 4] {
    let vector = sum([scale([a, b, c], w), scale([x, y, z], d), cross([x, y, z], [a, b, c])]);
    [vector[0], vector[1], vector[2], w * d - dot([x, y, z], [a, b, c])]
}
