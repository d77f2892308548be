//! The pseudo-inertia of a body, and its margin from a physically impossible body.

use crate::numeric::spectrum::symmetric_eigenvalues;
use nalgebra::{Matrix3, Matrix4};

/// Number of parameters per body.
pub(crate) const PER_BODY: usize = 10;

/// Pseudo-inertia of ten parameters [kg, kg m, kg m²].
pub(crate) fn pseudo_inertia(pi: &[f64; PER_BODY]) -> Matrix4<f64> {
    let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *pi;
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let sigma = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
    let mut j = Matrix4::zeros();
    j.fixed_view_mut::<3, 3>(0, 0).copy_from(&sigma);
    for (i, h) in [hx, hy, hz].into_iter().enumerate() {
        j[(i, 3)] = h;
        j[(3, i)] = h;
    }
    j[(3, 3)] = m;
    j
}

/// Ten parameters of a pseudo-inertia. The parameters are linear functions of its entries.
pub(crate) fn from_pseudo_inertia(j: &Matrix4<f64>) -> [f64; PER_BODY] {
    let trace = j[(0, 0)] + j[(1, 1)] + j[(2, 2)];
    [
        j[(3, 3)],
        j[(0, 3)],
        j[(1, 3)],
        j[(2, 3)],
        trace - j[(0, 0)],
        -j[(0, 1)],
        trace - j[(1, 1)],
        -j[(0, 2)],
        -j[(1, 2)],
        trace - j[(2, 2)],
    ]
}

/// Whether a body with these parameters is physically possible.
#[cfg(test)]
pub(crate) fn is_physically_consistent(pi: &[f64; PER_BODY]) -> bool {
    pseudo_inertia(pi).cholesky().is_some()
}

/// Returns the margin between a body and physically impossible bodies: the smallest eigenvalue of the pseudo-inertia after
/// its diagonal is scaled to one. `pi` has the ten parameters of [`crate::inertial`].
///
/// The margin is positive if and only if the body is physically possible, and at most one. If every parameter is rounded
/// with a relative error well below a quarter of the margin, the body stays possible. The result is `-∞` if a diagonal entry
/// is not positive.
pub fn margin(pi: &[f64; 10]) -> f64 {
    let j = pseudo_inertia(pi);
    let d = j.diagonal();
    if d.iter().any(|&x| x <= 0.0 || !x.is_finite()) {
        return f64::NEG_INFINITY;
    }
    let unit = Matrix4::from_fn(|r, c| j[(r, c)] / (d[r] * d[c]).sqrt());
    symmetric_eigenvalues(&unit).min()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::numeric::random::SplitMix64;
    use nalgebra::Vector4;

    /// A body made of point masses [kg] in a box [m]: consistent by construction.
    pub(crate) fn body(random: &mut SplitMix64, mass: f64, size: f64) -> [f64; PER_BODY] {
        let mut j = Matrix4::zeros();
        let centre = [0, 1, 2].map(|_| size * (random.uniform() - 0.5));
        for _ in 0..8 {
            let [x, y, z] = centre.map(|c| c + size * (random.uniform() - 0.5));
            let x = Vector4::new(x, y, z, 1.0);
            j += x * x.transpose() * (mass / 8.0 * (0.5 + random.uniform()));
        }
        from_pseudo_inertia(&j)
    }

    #[test]
    fn parameters_and_pseudo_inertia_invert_each_other() {
        let mut random = SplitMix64::new(1);
        for _ in 0..20 {
            let pi = body(&mut random, 1.0, 0.2);
            let back = from_pseudo_inertia(&pseudo_inertia(&pi));
            assert!(pi.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-14));
            assert!(is_physically_consistent(&pi));
            assert!(margin(&pi) > 0.0 && margin(&pi) <= 1.0);
        }
    }

    #[test]
    fn margin_is_zero_where_bodies_cease_to_exist() {
        // Izz = Ixx + Iyy: a plate. Above it nothing exists.
        let plate = |zz: f64| [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, zz];
        assert!(!is_physically_consistent(&plate(2.5)));
        assert_eq!(margin(&plate(2.0)), f64::NEG_INFINITY);
        assert!(margin(&plate(1.9)) > 0.0);
        assert_eq!(margin(&[-1.0; PER_BODY]), f64::NEG_INFINITY);
        // Half of the mass at ±1 on the diagonal of the axes, the other half at the origin, plus a little.
        let rod = [1.0, 0.0, 0.0, 0.0, 1.0, -0.5 + 1e-4, 1.0, 0.0, 0.0, 1.0];
        assert!(margin(&rod) <= 2.1e-4, "{}", margin(&rod));
    }
}
