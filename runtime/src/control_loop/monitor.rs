//! Checks of the limits of inputs, positions, speeds and following errors.

use super::settings::{LoopSettings, SPEED_MARGIN};
use crate::dynamics::{DependentJoint, Named};
use std::fmt;

/// A limit that the robot violates, or would violate before its brakes stop it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitFault {
    /// The position is outside its limits, or would be outside after braking.
    Position {
        /// Index of the coordinate. An index i ≥ N refers to the joint i − N in
        /// [`LoopSettings::dependent_joints`](super::LoopSettings::dependent_joints).
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Position of the joint [rad or m].
        position: f64,
        /// Position at which the brakes would stop the joint [rad or m].
        stopping: f64,
        /// Lower and upper limit of the position [rad or m].
        limits: [f64; 2],
        /// Name of the setting with these limits.
        setting: &'static str,
    },
    /// The speed is above its limit.
    Speed {
        /// Index of the coordinate. An index i ≥ N refers to the joint i − N in
        /// [`LoopSettings::dependent_joints`](super::LoopSettings::dependent_joints).
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Speed of the joint [rad/s or m/s].
        speed: f64,
        /// Limit of the speed [rad/s or m/s].
        limit: f64,
        /// Name of the setting with this limit.
        setting: &'static str,
    },
    /// The robot is too far from its desired position.
    FollowingError {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
        /// Measured minus desired position [rad or m].
        error: f64,
        /// Limit of the magnitude of the error [rad or m].
        limit: f64,
    },
}

impl fmt::Display for LimitFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position { name, position, stopping, limits: [low, high], setting, .. } => write!(
                f,
                "joint {} at {position:.4} can only stop at {stopping:.4}, outside the range {low:.4} to {high:.4} rad (or m) of \
                 `{setting}`",
                Named(name)
            ),
            Self::Speed { name, speed, limit, setting, .. } => write!(
                f,
                "joint {} moves at {speed:.4} rad/s (or m/s), faster than the limit {limit:.4} of `{setting}`",
                Named(name)
            ),
            Self::FollowingError { name, error, limit, .. } => write!(
                f,
                "joint {} is {error:.4} rad (or m) away from its desired position, above the limit {limit:.4} of \
                 `following_error`. Right after the start, check signs and order of inputs and encoders. Later, check that inputs \
                 and soft limits allow the trajectory: see `notes` of a predictive controller and `limits::violations`",
                Named(name)
            ),
        }
    }
}

/// Clamps inputs to their limits. Returns the number of changed inputs. The inputs must be finite.
pub(super) fn limit_inputs<const M: usize>(inputs: &mut [f64; M], limits: &[[f64; 2]; M]) -> u64 {
    let mut limited = 0;
    for (u, [low, high]) in inputs.iter_mut().zip(limits) {
        if *u < *low || *u > *high {
            *u = u.clamp(*low, *high);
            limited += 1;
        }
    }
    limited
}

/// Checks position limits without braking distance. `names` are the names of the coordinates.
///
/// # Errors
/// [`LimitFault::Position`] for the first position outside its limits.
pub(super) fn check_positions<const N: usize, const M: usize>(
    settings: &LoopSettings<N, M>,
    names: &[&'static str; N],
    positions: &[f64; N],
    dependent: DependentMotion<'_, N>,
) -> Result<(), LimitFault> {
    check_stop(settings, names, positions, positions)?;
    check_dependent(settings.dependent_joints, [positions, positions], &[0.0; N], dependent)
}

/// Function that returns position and velocity of a joint that follows other joints, for given positions and
/// velocities of the coordinates.
pub(super) type DependentMotion<'a, const N: usize> =
    &'a dyn Fn(&DependentJoint<N>, &[f64; N], &[f64; N]) -> [f64; 2];

/// State of the robot for the check of its limits.
pub(super) struct Situation<'a, const N: usize> {
    pub positions: &'a [f64; N],
    pub velocities: &'a [f64; N],
    /// Time since the positions were measured (s).
    pub age: f64,
    /// Following error, the measured positions minus the desired positions (`y ⊖ y_d`).
    pub error: &'a [f64; N],
    pub dependent: DependentMotion<'a, N>,
}

/// Checks all limits of the state. NaN violates each limit.
///
/// # Errors
/// The first [`LimitFault`].
pub(super) fn check_state<const N: usize, const M: usize>(
    settings: &LoopSettings<N, M>,
    names: &[&'static str; N],
    situation: &Situation<'_, N>,
) -> Result<(), LimitFault> {
    let (positions, velocities) = (situation.positions, situation.velocities);
    let stopping = core::array::from_fn(|i| {
        let v = velocities[i];
        positions[i] + v * situation.age + 0.5 * v * v.abs() / settings.braking_deceleration[i]
    });
    check_stop(settings, names, positions, &stopping)?;
    for joint in 0..N {
        let (speed, limit) = (velocities[joint], settings.speed_limit[joint]);
        let within = speed.is_finite() && speed.abs() <= limit;
        if !within {
            let setting = "speed_limit";
            return Err(LimitFault::Speed { joint, name: names[joint], speed, limit, setting });
        }
    }
    check_dependent(settings.dependent_joints, [positions, &stopping], velocities, situation.dependent)?;
    // An old position does not show the present following error.
    for joint in (0..N).filter(|_| situation.age == 0.0) {
        let (error, limit) = (situation.error[joint], settings.following_error[joint]);
        let within = error.abs() <= limit;
        if !within {
            return Err(LimitFault::FollowingError { joint, name: names[joint], error, limit });
        }
    }
    Ok(())
}

fn check_stop<const N: usize, const M: usize>(
    settings: &LoopSettings<N, M>,
    names: &[&'static str; N],
    positions: &[f64; N],
    stopping: &[f64; N],
) -> Result<(), LimitFault> {
    for joint in 0..N {
        let limits = settings.position_limits[joint];
        let within = |x: f64| (limits[0]..=limits[1]).contains(&x);
        if !(within(positions[joint]) && within(stopping[joint])) {
            return Err(LimitFault::Position {
                joint,
                name: names[joint],
                position: positions[joint],
                stopping: stopping[joint],
                limits,
                setting: "position_limits",
            });
        }
    }
    Ok(())
}

/// Checks position and speed limits of joints that follow coordinates.
///
/// - `stopping`: positions of the coordinates at which the brakes would stop them
fn check_dependent<const N: usize>(
    joints: &[DependentJoint<N>],
    [positions, stopping]: [&[f64; N]; 2],
    velocities: &[f64; N],
    motion: DependentMotion<'_, N>,
) -> Result<(), LimitFault> {
    for (k, joint) in joints.iter().enumerate() {
        let (place, name, setting) = (N + k, joint.name, "dependent_joints");
        let [position, speed] = motion(joint, positions, velocities);
        let [stopping, _] = motion(joint, stopping, velocities);
        let (limits, limit) = (joint.position, SPEED_MARGIN * joint.velocity);
        let within = |x: f64| (limits[0]..=limits[1]).contains(&x);
        if joint.has_position_limit() && !(within(position) && within(stopping)) {
            return Err(LimitFault::Position { joint: place, name, position, stopping, limits, setting });
        }
        let is_slow = speed.abs() <= limit;
        if joint.has_velocity_limit() && !is_slow {
            return Err(LimitFault::Speed { joint: place, name, speed, limit, setting });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Limits;

    const NONE: DependentMotion<'static, 1> = &|joint, y, v| joint.motion(y, v, &[]);

    fn settings() -> LoopSettings<1, 1> {
        LoopSettings::within(
            100.0,
            &Limits {
                position: [[-1.0, 1.0]],
                velocity: [2.0],
                effort: [10.0],
                peak_effort: [20.0],
                input: [[-1.0, 1.0]],
                peak_input: [[-2.0, 2.0]],
                dependent: &[],
                torque_speed: &[],
            },
            [[-2.0, 2.0]],
        )
    }

    #[test]
    fn inputs_are_cut_off() {
        let mut inputs = [3.0, -4.0, 0.5];
        assert_eq!(limit_inputs(&mut inputs, &[[-2.0, 2.0], [-3.0, 3.0], [-1.0, 1.0]]), 2);
        assert_eq!(inputs, [2.0, -3.0, 0.5]);
    }

    fn check(y: f64, v: f64, age: f64, desired: f64) -> Result<(), LimitFault> {
        let situation =
            Situation { positions: &[y], velocities: &[v], age, error: &[y - desired], dependent: NONE };
        check_state(&settings(), &["upper arm"], &situation)
    }

    #[test]
    fn the_braking_distance_counts() {
        // The braking distance at 2 rad/s with 10 rad/s² is 0.2 rad.
        let at = |y: f64, v: f64| check(y, v, 0.0, y);
        assert_eq!(at(0.79, 2.0), Ok(()));
        let fault = at(0.81, 2.0).unwrap_err();
        assert!(matches!(fault, LimitFault::Position { .. }));
        assert_eq!(
            fault.to_string(),
            "joint \"upper arm\" at 0.8100 can only stop at 1.0100, outside the range -1.0000 to 1.0000 rad (or m) of `position_limits`"
        );
        assert_eq!(at(0.81, -2.0), Ok(()), "it moves away");
        assert!(matches!(at(-0.81, -2.0), Err(LimitFault::Position { .. })));
        assert!(matches!(at(1.01, 0.0), Err(LimitFault::Position { .. })));
        // Predictive controllers reach the described limit of 2 rad/s. The loop brakes 10 % above it.
        assert_eq!(at(0.0, 2.19), Ok(()));
        let fault = at(0.0, 2.21).unwrap_err();
        assert_eq!(
            fault.to_string(),
            "joint \"upper arm\" moves at 2.2100 rad/s (or m/s), faster than the limit 2.2000 of `speed_limit`"
        );
    }

    #[test]
    fn an_old_position_is_extrapolated() {
        let at = |age: f64| check(0.7, 2.0, age, 0.7);
        assert_eq!(at(0.04), Ok(()));
        assert!(matches!(at(0.06), Err(LimitFault::Position { .. })));
    }

    /// A dependent joint that moves in the opposite direction at twice the speed.
    const ROD: DependentJoint<1> = DependentJoint {
        name: "rod",
        ratios: [-2.0],
        driven_ratios: &[],
        offset: 0.1,
        position: [-1.0, 1.5],
        velocity: 3.0,
    };

    #[test]
    fn joints_that_follow_have_limits_of_their_own() {
        let settings = LoopSettings { dependent_joints: const { &[ROD] }, ..settings() };
        let check = |y: f64, v: f64| {
            let situation =
                Situation { positions: &[y], velocities: &[v], age: 0.0, error: &[0.0], dependent: NONE };
            check_state(&settings, &["upper arm"], &situation)
        };
        // The limits of the rod correspond to 0.55 and −0.7 rad of the coordinate and to 1.5 rad/s (1.65 with the margin).
        assert_eq!(check(0.54, 0.0), Ok(()));
        assert_eq!(check(-0.69, 0.0), Ok(()));
        let fault = check(0.56, 0.0).unwrap_err();
        assert!(matches!(fault, LimitFault::Position { joint: 1, name: "rod", .. }), "{fault}");
        assert!(matches!(check(-0.71, 0.0), Err(LimitFault::Position { joint: 1, .. })));
        // The braking distance at 1 rad/s with 10 rad/s² is 0.05 rad, and 0.1 rad at the rod.
        assert_eq!(check(0.49, 1.0), Ok(()));
        let fault = check(0.51, 1.0).unwrap_err();
        let text = "joint rod at -0.9200 can only stop at -1.0200, outside the range -1.0000 to 1.5000 rad (or m) of `dependent_joints`";
        assert_eq!(fault.to_string(), text);
        assert_eq!(check(0.0, -1.64), Ok(()));
        assert!(matches!(check(0.0, -1.66), Err(LimitFault::Speed { joint: 1, .. })));
    }

    /// A law that does not know the driven joints returns NaN. The loop then brakes.
    #[test]
    fn a_joint_that_follows_something_unknown_is_beyond_its_limits() {
        let follower = DependentJoint { driven_ratios: &[1.0], ..ROD };
        let check = |joint| check_dependent(&[joint], [&[0.0], &[0.0]], &[0.0], NONE);
        assert!(check(follower).is_err());
        let unlimited = [f64::NEG_INFINITY, f64::INFINITY];
        let free = DependentJoint { position: unlimited, velocity: f64::INFINITY, ..follower };
        assert_eq!(check(free), Ok(()));
        let known =
            |joint: &DependentJoint<1>, y: &[f64; 1], v: &[f64; 1]| joint.motion(y, v, &[[1.3, 0.0, 0.0]]);
        assert_eq!(check_dependent(&[follower], [&[0.0], &[0.0]], &[0.0], &known), Ok(()));
        assert!(check_dependent(&[follower], [&[-0.1], &[-0.1]], &[0.0], &known).is_err());
    }

    #[test]
    fn the_following_error_has_a_limit() {
        let fault = check(0.2, 0.0, 0.0, 0.05).unwrap_err();
        assert!(fault.to_string().contains("check signs"), "{fault}");
    }

    /// NaN violates every limit, also infinite limits.
    #[test]
    fn what_is_no_number_is_beyond_every_limit() {
        let unlimited = LoopSettings {
            position_limits: [[f64::NEG_INFINITY, f64::INFINITY]],
            speed_limit: [f64::INFINITY],
            braking_deceleration: [f64::INFINITY],
            following_error: [f64::INFINITY],
            ..settings()
        };
        let check = |y: f64, v: f64, desired: f64| {
            let situation = Situation {
                positions: &[y],
                velocities: &[v],
                age: 0.0,
                error: &[y - desired],
                dependent: NONE,
            };
            check_state(&unlimited, &["1"], &situation)
        };
        assert_eq!(check(0.0, 1e100, 0.0), Ok(()));
        for (y, v, desired) in [(0.0, f64::NAN, 0.0), (0.0, f64::INFINITY, 0.0), (0.0, 0.0, f64::NAN)] {
            assert!(check(y, v, desired).is_err(), "{y} {v} {desired}");
        }
    }
}
