//! Conversion between rows of arrays and spatial vectors, matrices and moments of mass.

use super::builder::Rows;
use crate::graph::Scalar;
use crate::spatial::{Force, MassMoments, Matrix3, Motion, Symmetric3, Vector3};

pub(super) fn vector<'g>(rows: &Rows<'g>) -> Vector3<Scalar<'g>> {
    Vector3([rows[0], rows[1], rows[2]])
}

pub(super) fn motion_of<'g>(rows: &Rows<'g>) -> Motion<'g> {
    let (angular, linear) = (vector(&rows[..3]), vector(&rows[3..]));
    Motion { angular, linear }
}

pub(super) fn force_of<'g>(rows: &Rows<'g>) -> Force<'g> {
    let (moment, force) = (vector(&rows[..3]), vector(&rows[3..]));
    Force { moment, force }
}

pub(super) fn flat(f: Force<'_>) -> Vec<Scalar<'_>> {
    f.entries().to_vec()
}

pub(super) fn moments_of<'g>(rows: &Rows<'g>) -> MassMoments<Scalar<'g>> {
    MassMoments {
        mass: rows[0],
        first: vector(&rows[1..]),
        second: Symmetric3::new([rows[4], rows[5], rows[6], rows[7], rows[8], rows[9]]),
    }
}

pub(super) fn entries_of<'g>(moments: &MassMoments<Scalar<'g>>) -> Vec<Scalar<'g>> {
    [&[moments.mass][..], &moments.first.0, &moments.second.entries()].concat()
}

/// Moments of mass of a body about the base's origin, in the axes of the base, from the moments `own` in the
/// body's frame.
pub(super) fn moved<'g>(
    axes: &Rows<'g>,
    origin: Vector3<Scalar<'g>>,
    own: MassMoments<Scalar<'g>>,
) -> MassMoments<Scalar<'g>> {
    let axes: [Vector3<Scalar<'g>>; 3] = [0, 1, 2].map(|k| vector(&axes[3 * k..]));
    let direction =
        |v: Vector3<Scalar<'g>>| axes[0].scaled(v[0]) + axes[1].scaled(v[1]) + axes[2].scaled(v[2]);
    let (s, first) = (own.second, direction(own.first));
    // First R Σ column by column, then (R Σ) Rᵀ.
    let half = s.columns().map(direction);
    let turned =
        |i: usize, j: usize| (0..3).fold(own.mass.constant(0.0), |sum, k| sum + half[k][i] * axes[k][j]);
    let turned = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| turned(i, j));
    let carried = origin.scaled(own.mass);
    let middle = first + carried.map(|x| x * 0.5);
    MassMoments {
        mass: own.mass,
        first: first + carried,
        second: Symmetric3::new(turned) + Symmetric3::symmetric_product(middle, origin),
    }
}

/// The moments `2 ∫ ṙ dm` and `2 ∫ ṙ rᵀ dm` of a moving body with points r, about the base's origin.
pub(super) fn flow_of<'g>(
    moments: &MassMoments<Scalar<'g>>,
    velocity: Motion<'g>,
) -> (Vector3<Scalar<'g>>, Matrix3<'g>) {
    let Motion { angular: omega, linear: v } = velocity.map(|x| x * 2.0);
    let spin = Matrix3::cross_of(omega, moments.second);
    (
        v.scaled(moments.mass) + omega.cross(moments.first),
        Matrix3::from_fn(|i, j| spin[i][j] + v[i] * moments.first[j]),
    )
}

/// Force that the velocities ṙ of a body's points add for a motion with the angular part `angular`.
///
/// - `spin`: tr(A) 1 − A with A = 2 ∫ ṙ rᵀ dm
/// - `momentum`: 2 ∫ ṙ dm
pub(super) fn swept<'g>(
    spin: &Matrix3<'g>,
    momentum: Vector3<Scalar<'g>>,
    angular: Vector3<Scalar<'g>>,
) -> Force<'g> {
    Force { moment: spin.times(angular), force: angular.cross(momentum) }
}

/// Matrix `tr(A) 1 − A` of a matrix A with nine entries in row-major order.
pub(super) fn complement<'g>(a: &Rows<'g>) -> Matrix3<'g> {
    Matrix3([[a[4] + a[8], -a[1], -a[2]], [-a[3], a[0] + a[8], -a[5]], [-a[6], -a[7], a[0] + a[4]]])
}
