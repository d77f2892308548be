//! Limits of joints that follow several coordinates (followers) along polynomials of the coordinates.

use super::polynomial::Quintic;
use super::spline::{Piece, way_of};
use super::{MotionLimits, TrajectoryError};
use crate::dynamics::DependentJoint;
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// The joints in `limits` that follow several coordinates and have limits.
pub(super) fn of<const N: usize>(
    limits: &MotionLimits<N>,
) -> impl Iterator<Item = &'static DependentJoint<N>> {
    let is_limited = |joint: &DependentJoint<N>| joint.has_position_limit() || joint.has_velocity_limit();
    limits.dependent.iter().filter(move |joint| joint.is_sum() && is_limited(joint))
}

/// Checks the position limits of followers at all points.
///
/// # Errors
/// [`TrajectoryError::DependentOutside`] for a point at which a follower is outside its limits.
pub(super) fn check_points<const N: usize>(
    points: &[[f64; N]],
    limits: &MotionLimits<N>,
) -> Result<(), TrajectoryError> {
    for joint in of(limits) {
        let [low, high] = joint.position;
        for (point, positions) in points.iter().enumerate() {
            let [position, _] = joint.motion(positions, &[0.0; N], &[]);
            let slack = slack(position);
            if !(low - slack..=high + slack).contains(&position) {
                let (joint, limits) = (joint.name, joint.position);
                return Err(TrajectoryError::DependentOutside { joint, point, position, limits });
            }
        }
    }
    Ok(())
}

/// Index of the first polynomial along which a follower leaves its position limits, and the extreme position; `None` if the
/// follower keeps its limits.
pub(super) fn first_outside<const N: usize>(
    joint: &DependentJoint<N>,
    pieces: &[Piece<N>],
    spans: &[f64],
) -> Option<(usize, f64)> {
    if !joint.has_position_limit() {
        return None;
    }
    let [low, high] = joint.position;
    pieces.iter().zip(spans).enumerate().find_map(|(k, (piece, span))| {
        let [[least, most], ..] = sum(joint, piece).extremes(*span);
        if least < low - slack(least) {
            return Some((k, least));
        }
        (most > high + slack(most)).then_some((k, most))
    })
}

/// Checks the position limits of followers along all polynomials.
///
/// # Errors
/// [`TrajectoryError::DependentOvershoot`] for a follower that leaves its limits between two points.
pub(super) fn check<const N: usize>(
    pieces: &[Piece<N>],
    spans: &[f64],
    limits: &MotionLimits<N>,
    ways: usize,
) -> Result<(), TrajectoryError> {
    for joint in of(limits) {
        if let Some((piece, position)) = first_outside(joint, pieces, spans) {
            let (joint, limits, point) = (joint.name, joint.position, way_of(piece, ways));
            return Err(TrajectoryError::DependentOvershoot { joint, point, position, limits });
        }
    }
    Ok(())
}

/// Largest ratio of the speed of a follower to its limit along one polynomial.
pub(super) fn largest_ratio<const N: usize>(piece: &Piece<N>, span: f64, limits: &MotionLimits<N>) -> f64 {
    let ratio = |joint: &DependentJoint<N>| {
        let [_, [low, high], _] = sum(joint, piece).extremes(span);
        high.max(-low) / (limits.dependent_share * joint.velocity)
    };
    of(limits).filter(|joint| joint.has_velocity_limit()).map(ratio).fold(0.0, f64::max)
}

/// The polynomial of a follower, as a sum of the polynomials of its coordinates.
fn sum<const N: usize>(joint: &DependentJoint<N>, piece: &Piece<N>) -> Quintic {
    let start = Quintic::cubic([joint.offset, 0.0, 0.0, 0.0]);
    joint.ratios.iter().zip(piece).fold(start, |sum, (ratio, coordinate)| sum.plus(*ratio, coordinate))
}

/// Tolerance for rounding errors at a limit.
fn slack(position: f64) -> f64 {
    1e-12 * (1.0 + position.abs())
}
