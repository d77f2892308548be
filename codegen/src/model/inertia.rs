//! Is an inertia that of a real body?

use crate::numeric::length;

/// Relative room for rounding in published numbers.
const ROUNDING: f64 = 1e-6;

/// What is wrong with an inertia about the centre of mass.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Flaw {
    /// A principal moment is negative: the three moments, ascending.
    NotPositive([f64; 3]),
    /// The largest principal moment exceeds the sum of the others.
    Triangle([f64; 3]),
}

impl Flaw {
    /// The principal moments, ascending.
    pub fn moments(&self) -> [f64; 3] {
        let (Self::NotPositive(moments) | Self::Triangle(moments)) = self;
        *moments
    }

    /// Whether the triangle inequality is broken.
    pub fn is_triangle(&self) -> bool {
        matches!(self, Self::Triangle(_))
    }
}

/// Checks the entries xx, xy, xz, yy, yz, zz.
///
/// Principal moments are sums of two of the non-negative second moments ∫x², ∫y², ∫z², hence none is negative and none
/// exceeds the sum of the others. Limits are allowed: a point mass (all zero), a thin rod (one zero).
pub(super) fn check(inertia: [f64; 6]) -> Option<Flaw> {
    let moments = principal_moments(inertia);
    let [low, middle, high] = moments;
    let room = ROUNDING * high.abs();
    if low < -room {
        return Some(Flaw::NotPositive(moments));
    }
    (high > low + middle + room).then_some(Flaw::Triangle(moments))
}

/// Eigenvalues of a symmetric 3 × 3 matrix, ascending, by Jacobi rotations.
///
/// Golub and Van Loan, Matrix Computations, section 8.5.
fn principal_moments([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [f64; 3] {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    for sweep in 0..60 {
        let (p, q) = [(0, 1), (0, 2), (1, 2)][sweep % 3];
        rotate_away(&mut a, p, q);
    }
    let mut moments = [a[0][0], a[1][1], a[2][2]];
    moments.sort_by(f64::total_cmp);
    moments
}

/// One rotation in the plane p, q that makes `a[p][q]` zero.
fn rotate_away(a: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = ratio.signum() / (ratio.abs() + length([ratio, 1.0]));
    let c = 1.0 / length([t, 1.0]);
    let s = t * c;
    for k in 0..3 {
        let (x, y) = (a[k][p], a[k][q]);
        (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
    }
    for k in 0..3 {
        let (x, y) = (a[p][k], a[q][k]);
        (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_moments_do_not_depend_on_the_axes() {
        // diag(1, 2, 2.5) turned by 0.3 about z, then by −0.8 about x.
        let turn = super::super::pose::product(
            &super::super::pose::about_x(-0.8),
            &super::super::pose::about_z(0.3),
        );
        let d = [1.0, 2.0, 2.5];
        let entry =
            |i: usize, j: usize| (0..3).map(|k| turn[i][k] * d[k] * turn[j][k]).sum::<f64>();
        let moments = principal_moments([
            entry(0, 0),
            entry(0, 1),
            entry(0, 2),
            entry(1, 1),
            entry(1, 2),
            entry(2, 2),
        ]);
        assert!(
            moments.iter().zip(d).all(|(a, b)| (a - b).abs() < 1e-14),
            "{moments:?}"
        );
    }

    #[test]
    fn limits_of_real_bodies_pass() {
        assert_eq!(check([0.0; 6]), None);
        assert_eq!(check([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]), None);
        assert_eq!(check([1.0, 0.0, 0.0, 1.0, 0.0, 2.0]), None);
        assert!(matches!(
            check([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            Some(Flaw::Triangle(_))
        ));
        assert!(matches!(
            check([1.0, 2.0, 0.0, 1.0, 0.0, 1.0]),
            Some(Flaw::NotPositive(_))
        ));
    }
}
