//! Check that an inertia is physically possible.

use crate::numeric::length;
use crate::wording::telling;

/// Tolerance for a physically possible inertia, relative to the largest principal moment. Published inertias
/// have about six digits.
const DIGITS: f64 = 1e-6;

/// Tolerance for a physically possible inertia, relative to m l², for rounding errors of a few thousand
/// operations. m is the mass and l the distance from the link's origin to the centre of mass. CAD programs
/// shift inertias by m l² from the origin to the centre of mass.
const ARITHMETIC: f64 = 1e-12;

/// Smallest length l (m) in the tolerance m l² of an inertia with the mass m. The tolerance is therefore
/// positive even if the centre of mass is at the link's origin.
const SMALLEST_EXTENT: f64 = 1e-3;

/// Reason why a body is physically impossible.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Flaw {
    /// The body has an inertia but no mass.
    Massless,
    /// A principal moment is negative. The field has the three principal moments, ascending.
    NotPositive([f64; 3]),
    /// The largest principal moment exceeds the sum of the other two. The field has the three principal
    /// moments, ascending.
    Triangle([f64; 3]),
}

impl std::fmt::Display for Flaw {
    /// Writes the reason for a message, for example `principal moments 0.1 + 0.2 < 0.4`.
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Massless => out.write_str("an inertia but no mass"),
            Self::NotPositive(moments) => {
                let shown = telling(without_rounding(*moments), |[low, ..]| low < 0.0);
                write!(out, "principal moments {}", shown.join(", "))
            }
            Self::Triangle(moments) => {
                let [low, middle, high] =
                    telling(without_rounding(*moments), |[low, middle, high]| low + middle < high);
                write!(out, "principal moments {low} + {middle} < {high}")
            }
        }
    }
}

/// Replaces principal moments by 0 if they are rounding errors of the largest moment.
fn without_rounding(moments: [f64; 3]) -> [f64; 3] {
    let largest = largest(&moments);
    moments.map(|moment| match moment.abs() > ARITHMETIC * largest {
        true => moment,
        false => 0.0,
    })
}

fn largest(moments: &[f64]) -> f64 {
    moments.iter().fold(0.0, |most, moment| most.max(moment.abs()))
}

/// Checks a body with mass (kg), centre of mass in the link's frame (m) and inertia about the centre of mass
/// (kg m²). The inertia has the entries xx, xy, xz, yy, yz, zz. Returns `None` if the inertia is physically
/// possible.
///
/// Principal moments are sums of two of the second moments ∫x², ∫y², ∫z², which are not negative. Therefore
/// no principal moment is negative or exceeds the sum of the other two. A point mass (all moments zero) and a
/// thin rod (one moment zero) are allowed. Violations below `1e-6 max |Iᵢ| + 1e-12 m l²` are rounding. Here l
/// is the distance of the centre of mass from the link's origin, at least 1 mm.
pub(crate) fn check(mass: f64, center: [f64; 3], inertia: [f64; 6]) -> Option<Flaw> {
    let moments = principal_moments(inertia);
    let [low, middle, high] = moments;
    let extent = center.iter().map(|x| x * x).sum::<f64>();
    let extent = extent.max(SMALLEST_EXTENT * SMALLEST_EXTENT);
    let room = DIGITS * largest(&moments) + ARITHMETIC * mass * extent;
    if low < -room {
        return Some(Flaw::NotPositive(moments));
    }
    if high > low + middle + room {
        return Some(Flaw::Triangle(moments));
    }
    (mass == 0.0 && high > 0.0).then_some(Flaw::Massless)
}

/// Eigenvalues of a symmetric 3 × 3 matrix, ascending.
fn principal_moments(inertia: [f64; 6]) -> [f64; 3] {
    let (mut moments, _) = principal_axes(inertia);
    moments.sort_by(f64::total_cmp);
    moments
}

/// Eigenvalues of a symmetric 3 × 3 matrix and the rotation whose columns are its eigenvectors, by Jacobi rotations.
///
/// Golub and Van Loan, Matrix Computations, section 8.5.
pub(crate) fn principal_axes([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut axes = super::pose::IDENTITY;
    for sweep in 0..60 {
        let (p, q) = [(0, 1), (0, 2), (1, 2)][sweep % 3];
        rotate_away(&mut a, &mut axes, p, q);
    }
    ([a[0][0], a[1][1], a[2][2]], axes)
}

/// Performs one Jacobi rotation in the plane p, q, which makes `a[p][q]` zero. The columns of `axes` are
/// rotated, too.
fn rotate_away(a: &mut [[f64; 3]; 3], axes: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = ratio.signum() / (ratio.abs() + length([ratio, 1.0]));
    let c = 1.0 / length([t, 1.0]);
    let s = t * c;
    for row in a.iter_mut().chain(axes) {
        let (x, y) = (row[p], row[q]);
        (row[p], row[q]) = (c * x - s * y, s * x + c * y);
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
        let entry = |i: usize, j: usize| (0..3).map(|k| turn[i][k] * d[k] * turn[j][k]).sum::<f64>();
        let moments =
            principal_moments([entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]);
        assert!(moments.iter().zip(d).all(|(a, b)| (a - b).abs() < 1e-14), "{moments:?}");
    }

    fn of_unit_mass(inertia: [f64; 6]) -> Option<Flaw> {
        check(1.0, [0.0; 3], inertia)
    }

    #[test]
    fn limits_of_real_bodies_pass() {
        assert_eq!(of_unit_mass([0.0; 6]), None);
        assert_eq!(of_unit_mass([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]), None);
        assert_eq!(of_unit_mass([1.0, 0.0, 0.0, 1.0, 0.0, 2.0]), None);
        assert!(matches!(of_unit_mass([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), Some(Flaw::Triangle(_))));
        assert!(matches!(of_unit_mass([1.0, 2.0, 0.0, 1.0, 0.0, 1.0]), Some(Flaw::NotPositive(_))));
    }

    #[test]
    fn an_inertia_needs_a_mass() {
        assert_eq!(check(0.0, [0.0; 3], [0.1, 0.0, 0.0, 0.1, 0.0, 0.1]), Some(Flaw::Massless));
        assert_eq!(check(0.0, [0.0; 3], [0.0; 6]), None);
    }

    /// The first two are the head and the first right ankle link of iCub.
    #[test]
    fn rounding_is_relative_to_mass_and_extent() {
        let head = [0.0, 0.0, 2.407_41e-35, 0.0, 0.0, 0.0];
        assert_eq!(check(1.336_87, [0.0185, -0.1108, 0.0], head), None);
        let ankle = [2.7e-20, -1.7e-21, 1.4e-20, 5.4e-20, 3.4e-21, 1.4e-20];
        assert_eq!(check(0.746, [-0.0054, 0.0016, -0.0172], ankle), None);
        let beside = [3e-6, 0.0, 0.0, 3e-6, 0.0, -1.2e-22];
        assert_eq!(check(1e-3, [0.0; 3], beside), None);
        let tiny = [1e-9, 0.0, 0.0, 1e-9, 0.0, -1e-9];
        assert!(matches!(check(1e-3, [0.01; 3], tiny), Some(Flaw::NotPositive(_))));
        let dummy = check(1e-6, [0.0; 3], [1e-6; 6]).map(|flaw| flaw.to_string());
        assert_eq!(dummy.as_deref(), Some("principal moments 0 + 0 < 3e-6"));
    }
}
