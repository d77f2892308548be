//! Vectors and symmetric matrices in three dimensions.

use std::fmt;
use std::ops::{Add, Index, Neg, Sub};

use crate::graph::Scalar;

/// A vector with components x, y, z.
#[derive(Clone, Copy, PartialEq)]
pub struct Vector3<S>(pub [S; 3]);

impl<S> Vector3<S> {
    /// Applies `f` to each component of the vector.
    pub fn map<T>(self, f: impl FnMut(S) -> T) -> Vector3<T> {
        Vector3(self.0.map(f))
    }
}

impl<'g> Vector3<Scalar<'g>> {
    /// The zero vector on the graph of the scalar `any`.
    pub fn zero(any: Scalar<'g>) -> Self {
        Self([any.constant(0.0); 3])
    }

    /// The dot product `self · other`.
    pub fn dot(self, other: Self) -> Scalar<'g> {
        self[0] * other[0] + self[1] * other[1] + self[2] * other[2]
    }

    /// The cross product `self × other`.
    pub fn cross(self, other: Self) -> Self {
        let component = |i: usize, j: usize| self[i] * other[j] - self[j] * other[i];
        Self([component(1, 2), component(2, 0), component(0, 1)])
    }

    /// The product `factor · self` of a number and this vector.
    pub fn scaled(self, factor: Scalar<'g>) -> Self {
        Self(self.0.map(|x| x * factor))
    }

    /// Whether all components are the constant 0.
    pub fn is_zero(self) -> bool {
        self.0.iter().all(|x| x.is_zero())
    }

    /// The values of constant components; `None` if a component is not a constant.
    pub fn values(self) -> Option<[f64; 3]> {
        Some([self[0].value()?, self[1].value()?, self[2].value()?])
    }

    /// Rotation about z: `R_z(φ) · self`. The arguments are sine and cosine of φ.
    pub fn turned(self, (s, c): (Scalar<'g>, Scalar<'g>)) -> Self {
        Self([c * self[0] - s * self[1], s * self[0] + c * self[1], self[2]])
    }

    /// Inverse rotation about z: `R_z(φ)ᵀ · self`. The arguments are sine and cosine of φ.
    pub fn turned_back(self, (s, c): (Scalar<'g>, Scalar<'g>)) -> Self {
        self.turned((-s, c))
    }

    /// Suggests the names `stem_x`, `stem_y`, `stem_z` for the components in generated code.
    pub fn named(self, stem: &str) -> Self {
        for (component, axis) in self.0.iter().zip(["x", "y", "z"]) {
            component.named(|| format!("{stem}_{axis}"));
        }
        self
    }
}

/// Shows the components on one line.
impl<S: fmt::Debug> fmt::Debug for Vector3<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = &self.0;
        write!(f, "[{x:?}, {y:?}, {z:?}]")
    }
}

impl<S> Index<usize> for Vector3<S> {
    type Output = S;
    fn index(&self, axis: usize) -> &S {
        &self.0[axis]
    }
}

impl Add for Vector3<Scalar<'_>> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self([self[0] + other[0], self[1] + other[1], self[2] + other[2]])
    }
}

impl Sub for Vector3<Scalar<'_>> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl Neg for Vector3<Scalar<'_>> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

/// A symmetric 3 × 3 matrix, stored by its upper triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symmetric3<S> {
    /// Entry (x, x) of the symmetric matrix.
    pub xx: S,
    /// Entry (x, y) of the symmetric matrix.
    pub xy: S,
    /// Entry (x, z) of the symmetric matrix.
    pub xz: S,
    /// Entry (y, y) of the symmetric matrix.
    pub yy: S,
    /// Entry (y, z) of the symmetric matrix.
    pub yz: S,
    /// Entry (z, z) of the symmetric matrix.
    pub zz: S,
}

impl<S> Symmetric3<S> {
    /// Creates the symmetric matrix from the entries xx, xy, xz, yy, yz, zz.
    pub fn new([xx, xy, xz, yy, yz, zz]: [S; 6]) -> Self {
        Self { xx, xy, xz, yy, yz, zz }
    }

    /// The six entries xx, xy, xz, yy, yz, zz of the symmetric matrix.
    pub fn entries(self) -> [S; 6] {
        [self.xx, self.xy, self.xz, self.yy, self.yz, self.zz]
    }

    /// Applies `f` to each of the six entries.
    pub fn map<T>(self, f: impl FnMut(S) -> T) -> Symmetric3<T> {
        Symmetric3::new(self.entries().map(f))
    }
}

impl<'g> Symmetric3<Scalar<'g>> {
    /// The columns of the symmetric matrix, which are also its rows.
    pub fn columns(self) -> [Vector3<Scalar<'g>>; 3] {
        let s = self;
        [[s.xx, s.xy, s.xz], [s.xy, s.yy, s.yz], [s.xz, s.yz, s.zz]].map(Vector3)
    }

    /// The zero matrix on the graph of the scalar `any`.
    pub fn zero(any: Scalar<'g>) -> Self {
        Self::new([any.constant(0.0); 6])
    }

    /// The symmetric matrix `a bᵀ + b aᵀ`.
    pub fn symmetric_product(a: Vector3<Scalar<'g>>, b: Vector3<Scalar<'g>>) -> Self {
        let entry = |i: usize, j: usize| {
            if i == j { (a[i] * b[i]) * 2.0 } else { a[i] * b[j] + a[j] * b[i] }
        };
        Self::new([entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)])
    }

    /// The symmetric matrix `a aᵀ`.
    pub fn square(a: Vector3<Scalar<'g>>) -> Self {
        Self::new([a[0] * a[0], a[0] * a[1], a[0] * a[2], a[1] * a[1], a[1] * a[2], a[2] * a[2]])
    }

    /// Rotation about z: `R_z(φ) · self · R_z(φ)ᵀ` with 9 multiplications and 7 additions. The arguments are
    /// sine and cosine of φ.
    pub fn turned(self, (s, c): (Scalar<'g>, Scalar<'g>)) -> Self {
        let across = s * (self.xx - self.yy) + (self.xy * 2.0) * c;
        let moved = s * across;
        let side = Vector3([self.xz, self.yz, self.zz]).turned((s, c));
        Self {
            xx: self.xx - moved,
            xy: c * across - self.xy,
            xz: side[0],
            yy: self.yy + moved,
            yz: side[1],
            zz: self.zz,
        }
    }

    /// The product `self · v` of this matrix and a vector.
    pub fn times(self, v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        Vector3([
            self.xx * v[0] + self.xy * v[1] + self.xz * v[2],
            self.xy * v[0] + self.yy * v[1] + self.yz * v[2],
            self.xz * v[0] + self.yz * v[1] + self.zz * v[2],
        ])
    }
}

impl Add for Symmetric3<Scalar<'_>> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.entries(), other.entries());
        Self::new(std::array::from_fn(|k| a[k] + b[k]))
    }
}

impl Sub for Symmetric3<Scalar<'_>> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let (a, b) = (self.entries(), other.entries());
        Self::new(std::array::from_fn(|k| a[k] - b[k]))
    }
}
