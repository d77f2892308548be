//! Friction just before and just after rest.

/// Speed [rad/s or m/s] at which friction is evaluated just before or just after rest. At this speed, a discontinuous friction
/// law has its limit for motion in this direction. A continuous law has its value at rest. The speed does not underflow when
/// it is multiplied by a gear ratio.
pub const JUST_MOVING: f64 = 1e-300;

/// Largest difference between both sides of rest for friction without a jump. This difference is the slope of friction times
/// [`JUST_MOVING`]. It remains if free parameters make a jump zero.
const OF_SLOPES: f64 = 1e-200;

/// Returns whether friction is discontinuous at rest, for example dry friction. The arguments are the two values of a joint in
/// [`Dynamics::friction_at_rest`](super::Dynamics::friction_at_rest).
pub fn jumps([backward, forward]: [f64; 2]) -> bool {
    backward < forward
}

/// Returns whether friction at joint i is discontinuous when the velocity of joint j changes its sign and all other velocities are
/// 0. An example is friction on a shaft that both joints rotate. NaN counts as discontinuous.
///
/// - `friction`: function that returns the friction torques for velocities
pub fn jumps_with<const N: usize>([i, j]: [usize; 2], friction: impl Fn(&[f64; N]) -> [f64; N]) -> bool {
    let [backward, forward] = [-JUST_MOVING, JUST_MOVING].map(|speed| {
        let mut velocities = [0.0; N];
        velocities[j] = speed;
        friction(&velocities)[i]
    });
    let is_smooth = (forward - backward).abs() <= OF_SLOPES;
    !is_smooth
}

/// Friction of each joint just before and just after rest. The two values are equal for friction without a jump.
pub(super) fn either_side<const N: usize>(
    jumps: &[[usize; 2]],
    friction: impl Fn(&[f64; N]) -> [f64; N],
) -> [[f64; 2]; N] {
    let rest = friction(&[0.0; N]);
    let mut sides = rest.map(|torque| [torque; 2]);
    if jumps.is_empty() {
        return sides;
    }
    let [backward, forward] = [-JUST_MOVING, JUST_MOVING].map(|speed| friction(&[speed; N]));
    for &[i, _] in jumps.iter().filter(|[i, j]| i == j) {
        if forward[i] - backward[i] > OF_SLOPES {
            sides[i] = [backward[i], forward[i]];
        }
    }
    sides
}
