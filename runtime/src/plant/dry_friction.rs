//! Exact dry friction and brakes, with sliding and sticking joints.
//!
//! Friction with `sign ẏ` is discontinuous at ẏ = 0. At the discontinuity, an integration with error control would need
//! smaller and smaller steps, and a joint at rest would chatter. Therefore each joint with a discontinuity has one of
//! these modes:
//!
//! - "forward" and "backward": the joint slides. Its friction is continued smoothly beyond ẏ = 0, and the integration
//!   stops when the sign of ẏ changes.
//! - "stuck": ÿ = 0, and friction is the force that holds the joint. The integration stops when this force leaves the
//!   range between the friction of both directions at rest.
//!
//! ```text
//!     M ÿ + k = q + B u − σ        ẏ_i = ÿ_i = 0 and τ_i(0−) ≤ σ_i + τ_i(0) ≤ τ_i(0+) for joints that stick,  σ_i = 0 for others
//! ```
//!
//! Here τ_i is the friction law of joint i, and σ_i is the additional force that holds a stuck joint. With load-dependent
//! friction, the range of a sticking joint depends on the load τ_l, which is `B u` minus all friction. If s₁ is the
//! friction per unit of load, `|τ_l| s₁(0−)` and `|τ_l| s₁(0+)` are added to the ends of the range.
//!
//! An engaged brake is additional friction. The joints that stick are found by solving a linear complementarity problem.
//! The method changes the mode of the joint with the largest violation until no mode is violated (Pfeiffer, Glocker,
//! *Multibody Dynamics with Unilateral Contacts*, 1996, section 5; Filippov, *Differential Equations with
//! Discontinuous Righthand Sides*, 1988, chapter 2).

use super::integrator::{Flow, Motion};
use crate::dynamics::{Dynamics, JUST_MOVING, jumps, load, position_rates, under_load};
use nalgebra::{SMatrix, SVector};

/// Tolerance for the holding force of a sticking joint, relative to the width of the range of friction. The joint breaks
/// loose if the force exceeds the range by more than this tolerance.
const BREAK_LOOSE: f64 = 1e-9;

/// Mode of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    /// The friction of the joint has no discontinuity.
    Smooth,
    Forward,
    Backward,
    Stuck,
}

impl Mode {
    fn direction(self) -> f64 {
        match self {
            Self::Smooth | Self::Stuck => 0.0,
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }
}

/// Function that returns external generalized forces [N m or N] for positions.
pub(super) type PushForce<const N: usize, const NY: usize> = dyn Fn(&[f64; NY]) -> [f64; N] + Send + Sync;

/// Equations of motion with the mode of each joint.
pub(super) struct Joints<'d, D, const N: usize, const M: usize, const NY: usize> {
    pub model: &'d D,
    /// Time of the plant at which the time of the integration is 0 (s).
    pub start: f64,
    pub inputs: &'d [f64; M],
    /// Friction torques of the engaged brakes [N m or N].
    pub brakes: &'d [f64; N],
    /// External forces; `None` if there are no external forces.
    pub push: Option<&'d PushForce<N, NY>>,
    pub modes: [Mode; N],
    /// Small speed that the integration cannot resolve. A joint changes its direction if it moves backwards faster than
    /// this speed. A joint is at rest below twice this speed.
    pub rest: f64,
}

impl<'d, D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> Joints<'d, D, N, M, NY> {
    /// Joints with the present modes and another model, for example the model at another time.
    fn of<'e>(&self, model: &'e D) -> Joints<'e, D, N, M, NY>
    where
        'd: 'e,
    {
        Joints { model, ..*self }
    }

    /// Sets the modes for a motion at `time` (s) of the integration. Sets the speeds of joints at rest to zero.
    pub fn settle_at(&mut self, time: f64, motion: &mut Motion<N, NY>) {
        self.modes = self.model.at_time(self.start + time, |model| {
            let mut joints = self.of(model);
            joints.settle(motion);
            joints.modes
        });
    }

    /// Friction just before and just after rest, including brakes.
    fn friction_range(&self, y: &[f64; NY]) -> [Range; N] {
        let (at_rest, shares) = (self.model.friction_at_rest(y), self.model.load_friction_at_rest(y));
        core::array::from_fn(|i| {
            let ([low, high], brake) = (at_rest[i], self.brakes[i]);
            Range { unloaded: [low - brake, high + brake], shares: shares[i] }
        })
    }

    fn settle(&mut self, motion: &mut Motion<N, NY>) {
        let range = self.friction_range(&motion.positions);
        let mut at_rest = [false; N];
        for i in 0..N {
            let ([_, high], jumps) = (range[i].unloaded, range[i].jumps());
            at_rest[i] = jumps && (motion.velocities[i].abs() <= 2.0 * self.rest || high == f64::INFINITY);
            self.modes[i] = match (jumps, at_rest[i]) {
                (false, _) => Mode::Smooth,
                (true, true) => Mode::Stuck,
                (true, false) if motion.velocities[i] > 0.0 => Mode::Forward,
                (true, false) => Mode::Backward,
            };
            if at_rest[i] {
                motion.velocities[i] = 0.0;
            }
        }
        // Each pass changes the mode of the joint with the largest violation. Few passes are needed if M is positive
        // definite. The bound ends the loop in case of rounding errors.
        for _ in 0..4 * N {
            let Some((joint, mode)) = self.worst(motion, &range, &at_rest) else {
                return;
            };
            self.modes[joint] = mode;
        }
    }

    /// The joint at rest whose mode has the largest violation, and the correct mode of this joint; `None` if no mode is
    /// violated.
    fn worst(
        &self,
        motion: &Motion<N, NY>,
        range: &[Range; N],
        at_rest: &[bool; N],
    ) -> Option<(usize, Mode)> {
        let Solution { accelerations, friction, loads } = self.solve(motion);
        let mut worst = None;
        let mut largest = 0.0;
        for i in (0..N).filter(|i| at_rest[*i]) {
            let range = range[i].under(loads[i]);
            let violation = match self.modes[i] {
                Mode::Stuck => overload(friction[i], range).abs(),
                mode => {
                    let [low, high] = range;
                    let against = -mode.direction() * accelerations[i];
                    // The violation is converted to a torque, to compare it with overloads. The conversion assumes that
                    // the other joints are at rest.
                    against * self.model.mass_matrix(&motion.positions)[i][i] - BREAK_LOOSE * (high - low)
                }
            };
            if violation > largest {
                largest = violation;
                let next = match self.modes[i] {
                    Mode::Stuck if friction[i] > range[1] => Mode::Forward,
                    Mode::Stuck => Mode::Backward,
                    _ => Mode::Stuck,
                };
                worst = Some((i, next));
            }
        }
        worst
    }

    /// Accelerations, friction forces of the joints that stick, and loads of all joints.
    fn solve(&self, motion: &Motion<N, NY>) -> Solution<N> {
        let y = &motion.positions;
        let v = self.directed(&motion.velocities);
        let (mass, coriolis, applied) = self.model.equations_of_motion(y, &v);
        let (friction, shares) = (self.model.friction_torques(y, &v), self.model.load_friction(y, &v));
        let input_matrix = self.model.input_matrix(y);
        let stuck = |i: usize| self.modes[i] == Mode::Stuck;
        let mut loads = [0.0; N];
        let push = self.push.map_or([0.0; N], |push| push(y));
        let forces: [f64; N] = core::array::from_fn(|i| {
            let input: f64 = input_matrix[i].iter().zip(self.inputs).map(|(b, u)| b * u).sum();
            // The torque of a sticking brake is part of the unknown friction.
            let brake = match self.modes[i].direction() {
                0.0 => 0.0,
                direction => direction * self.brakes[i],
            };
            let rest = applied[i] + input + push[i] - coriolis[i] - brake;
            if stuck(i) {
                loads[i] = input;
                return rest;
            }
            loads[i] = load(input - friction[i] - brake, shares[i]);
            rest - under_load(loads[i], shares[i])
        });
        let reduced = SMatrix::<f64, N, N>::from_fn(|i, j| match (stuck(i) || stuck(j), i == j) {
            (true, true) => 1.0,
            (true, false) => 0.0,
            (false, _) => mass[i][j],
        });
        let right = SVector::<f64, N>::from_fn(|i, _| if stuck(i) { 0.0 } else { forces[i] });
        let Some(cholesky) = reduced.cholesky() else {
            return Solution { accelerations: [f64::NAN; N], friction: [f64::NAN; N], loads };
        };
        let solution = cholesky.solve(&right);
        let accelerations: [f64; N] = core::array::from_fn(|i| solution[i]);
        let friction = core::array::from_fn(|i| {
            let inertial: f64 = mass[i].iter().zip(&accelerations).map(|(m, a)| m * a).sum();
            forces[i] - inertial + friction[i]
        });
        for i in (0..N).filter(|i| stuck(*i)) {
            loads[i] -= friction[i];
        }
        Solution { accelerations, friction, loads }
    }

    /// Whether the friction cannot hold a joint that sticks.
    fn is_overloaded(&self, motion: &Motion<N, NY>) -> bool {
        let Solution { friction, loads, .. } = self.solve(motion);
        let range = self.friction_range(&motion.positions);
        (0..N).any(|i| self.modes[i] == Mode::Stuck && overload(friction[i], range[i].under(loads[i])) != 0.0)
    }

    /// Velocities for the friction laws. Sliding joints keep the direction of their mode.
    fn directed(&self, v: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| match self.modes[i] {
            Mode::Smooth => v[i],
            Mode::Stuck => 0.0,
            Mode::Forward => v[i].max(JUST_MOVING),
            Mode::Backward => v[i].min(-JUST_MOVING),
        })
    }
}

/// Solution of the equations of motion for the modes of the joints.
struct Solution<const N: usize> {
    accelerations: [f64; N],
    /// Friction forces of the joints that stick [N m or N].
    friction: [f64; N],
    /// Forces of the drives without friction [N m or N].
    loads: [f64; N],
}

/// Friction of a joint just before and just after rest.
#[derive(Debug, Clone, Copy)]
struct Range {
    /// Friction just before and just after rest without its load-dependent part [N m or N].
    unloaded: [f64; 2],
    /// Load-dependent friction per unit of load, just before and just after rest.
    shares: [f64; 2],
}

impl Range {
    fn jumps(self) -> bool {
        jumps(self.unloaded) || jumps(self.shares)
    }

    fn under(self, load: f64) -> [f64; 2] {
        core::array::from_fn(|k| self.unloaded[k] + under_load(load, self.shares[k]))
    }
}

/// Amount by which the holding force `friction` of a sticking joint exceeds the range of friction, with its sign; 0 within
/// the range.
fn overload(friction: f64, [low, high]: [f64; 2]) -> f64 {
    let margin = BREAK_LOOSE * (high - low);
    if friction > high + margin {
        friction - high
    } else if friction < low - margin {
        friction - low
    } else {
        0.0
    }
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> Flow<N, NY>
    for Joints<'_, D, N, M, NY>
{
    fn rates(&self, motion: &Motion<N, NY>) -> [f64; NY] {
        position_rates(self.model.quaternion_joints(), &motion.positions, &motion.velocities)
    }

    fn accelerations(&self, time: f64, motion: &Motion<N, NY>) -> [f64; N] {
        let braked = self.brakes.iter().any(|b| *b > 0.0);
        let sticks = self.modes.contains(&Mode::Stuck);
        self.model.at_time(self.start + time, |model| {
            if braked || sticks || self.push.is_some() {
                return self.of(model).solve(motion).accelerations;
            }
            let v = self.directed(&motion.velocities);
            model.forward_dynamics(&motion.positions, &v, self.inputs)
        })
    }

    fn has_ended(&self, time: f64, motion: &Motion<N, NY>) -> bool {
        let turned = |i: usize| self.modes[i].direction() * motion.velocities[i] < -self.rest;
        if (0..N).any(turned) {
            return true;
        }
        if !self.modes.contains(&Mode::Stuck) {
            return false;
        }
        self.model.at_time(self.start + time, |model| self.of(model).is_overloaded(motion))
    }
}
