//! Simulates the Go2, which lifts and swings one leg after the other while its trunk sways, and records sensor data.

use crate::outcome::Outcome;
use crate::quadruped::{
    ACROSS, FEET, HIP, LENGTH, Wrenches, at_feet, standing, used_friction, used_torque, within_limits,
};
use crate::random::SplitMix64;
use gelenk_generated::go2::{self as robot, M, N, NY, WRENCHES};
use std::f64::consts::TAU;

/// Time between two rows of a log [s].
pub const PERIOD: f64 = 0.0025;
/// Duration of the turn of each leg [s].
const TURN: f64 = 6.0;
/// Duration of the return to rest [s].
const REST: f64 = 1.0;
const DURATION: f64 = 4.0 * TURN + REST;
/// Interval within the turn of a leg in which the leg is unloaded [s]. The leg then swings until it is loaded again.
const UNLOADED: [f64; 2] = [1.0, 1.3];
/// Interval within the turn of a leg in which the leg is loaded again [s].
const LOADED: [f64; 2] = [5.4, 5.7];
/// Order of the legs. Diagonal legs follow each other.
const ORDER: [usize; 4] = [0, 3, 1, 2];
/// Signs of x and y of the hip of each leg.
const SIDES: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
/// Distance by which the trunk leans away from the lifted leg [m].
const LEAN: [f64; 2] = [0.03, 0.045];
/// Amplitudes of the swaying trunk [m and rad].
const SWAY: [f64; N - M] = [0.012, 0.012, 0.012, 0.1, 0.1, 0.1];
/// Offsets of hip, thigh and calf of a lifted leg [rad].
const LIFTED: [f64; 3] = [0.0, 0.45, -0.75];
/// Amplitudes of hip, thigh and calf of a lifted leg [rad].
const SWING: [f64; 3] = [0.35, 0.6, 0.45];
/// Frequencies of swaying and swinging [Hz].
const FREQUENCIES: [[f64; 2]; 2] = [[0.5, 1.5], [0.8, 2.4]];
/// Standard deviations of the noise of trunk position [m], trunk attitude [rad], encoders [rad] and forces at the feet [N].
const NOISE: [f64; 4] = [2e-4, 3e-4, 1e-4, 0.2];

/// Measurements at one time.
#[derive(Debug, Clone, Copy)]
pub struct Measured {
    pub y: [f64; NY],
    /// Forces at the feet [N], in the axes of the world.
    pub feet: [[f64; 3]; 4],
}

/// A log of sensor data, and the true joint torques [N m], which are not measured.
#[derive(Debug)]
pub struct Log {
    pub rows: Vec<Measured>,
    pub torques: Vec<[f64; M]>,
    /// Smallest vertical force of a fully loaded foot [N].
    pub pressing: f64,
    /// Largest ratio of tangential force to available friction at a standing foot.
    pub friction: f64,
    /// Largest ratio of a joint torque to its limit.
    pub used_torque: f64,
    /// Smallest height of a fully swinging foot above its place on the ground [m].
    pub clearance: f64,
}

/// Parameters of three sines for each velocity.
type Waves = [[[f64; 2]; 3]; N];

/// The motion of a seed.
pub struct Lifting {
    waves: Waves,
    places: [[f64; 3]; 4],
    random: SplitMix64,
}

impl Lifting {
    pub fn new(seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let mut waves = [[[0.0; 2]; 3]; N];
        for (i, waves) in waves.iter_mut().enumerate() {
            let [low, high] = FREQUENCIES[usize::from(i >= N - M)];
            for (k, [rate, phase]) in waves.iter_mut().enumerate() {
                let share = (k as f64 + random.uniform()) / 3.0;
                *rate = TAU * (low + (high - low) * share);
                *phase = TAU * random.uniform();
            }
        }
        Self { waves, places: FEET.map(|foot| (foot.pose)(&standing()).0), random }
    }

    /// Simulates the whole motion and returns its log.
    ///
    /// # Errors
    /// An error if a standing foot would slide or lift, if a swinging foot is below the ground, or if a joint exceeds its limits.
    pub fn record(mut self) -> Outcome<Log> {
        let mut log = Log {
            rows: vec![],
            torques: vec![],
            pressing: f64::INFINITY,
            friction: 0.0,
            used_torque: 0.0,
            clearance: f64::INFINITY,
        };
        for k in 0..=(DURATION / PERIOD).round() as u32 {
            let time = PERIOD * f64::from(k);
            let (y, v, a) = self.motion(time);
            let (torques, wrenches) = forces(&y, &v, &a, weights(time))?;
            within_limits(&y, &v, &torques).map_err(|error| format!("at {time:.3} s {error}"))?;
            for foot in 0..4 {
                self.check(foot, time, &y, &wrenches[foot], &mut log)
                    .map_err(|error| format!("at {time:.3} s {} {error}", robot::WRENCH_NAMES[foot]))?;
            }
            log.used_torque = log.used_torque.max(used_torque(&torques));
            log.rows.push(self.measured(&y, &wrenches));
            log.torques.push(torques);
        }
        Ok(log)
    }

    /// Checks a foot at a time: vertical force and friction if the foot stands, otherwise its height.
    fn check(&self, foot: usize, time: f64, y: &[f64; NY], force: &[f64; 6], log: &mut Log) -> Outcome<()> {
        let at = (FEET[foot].pose)(y).0;
        let moved: [f64; 3] = std::array::from_fn(|i| at[i] - self.places[foot][i]);
        let weight = weights(time)[foot];
        if weight > 0.0 {
            let friction = used_friction(force);
            if friction > 1.0 {
                return Err(format!("does not stand: it uses {friction:.2} of its friction").into());
            }
            if moved.iter().any(|x| x.abs() > 1e-9) {
                return Err(format!("slid by {moved:?} m").into());
            }
            log.friction = log.friction.max(friction);
        } else if moved[2] < -1e-9 {
            return Err(format!("is {:.1e} m below the ground", -moved[2]).into());
        }
        if weight == 1.0 {
            log.pressing = log.pressing.min(force[2]);
        } else if lifted(foot, time) == 1.0 {
            log.clearance = log.clearance.min(moved[2]);
        }
        Ok(())
    }

    fn measured(&mut self, y: &[f64; NY], wrenches: &Wrenches) -> Measured {
        let [place, attitude, encoder, force] = NOISE;
        let deviation = |i: usize| [place, attitude, encoder][usize::from(i >= 3) + usize::from(i >= 6)];
        let d: [f64; N] = std::array::from_fn(|i| deviation(i) * self.random.normal());
        let feet = std::array::from_fn(|foot| {
            std::array::from_fn(|axis| wrenches[foot][axis] + force * self.random.normal())
        });
        Measured { y: robot::integrate(y, &d), feet }
    }

    /// Positions, velocities and accelerations at a time, computed by differences (⊖).
    fn motion(&self, time: f64) -> ([f64; NY], [f64; N], [f64; N]) {
        let h = 1e-4;
        let at = self.posture(time);
        let [ahead, back] = [h, -h].map(|h| robot::difference(&at, &self.posture(time + h)));
        let v = std::array::from_fn(|i| (ahead[i] - back[i]) / (2.0 * h));
        (at, v, std::array::from_fn(|i| (ahead[i] + back[i]) / (h * h)))
    }

    fn posture(&self, time: f64) -> [f64; NY] {
        let grown = rise(time / REST) * rise((DURATION - time) / REST);
        let mut d = [0.0; N];
        for i in 0..N - M {
            d[i] = grown * SWAY[i] * self.wave(i, time);
        }
        let lean = lean(time);
        (d[0], d[1]) = (d[0] + grown * lean[0], d[1] + grown * lean[1]);
        let mut y = robot::integrate(&standing(), &d);
        for leg in 0..4 {
            let lifted = lifted(leg, time);
            for (i, angle) in leg_angles(&y, leg, &self.places[leg]).into_iter().enumerate() {
                let swing = LIFTED[i] + SWING[i] * self.wave(6 + 3 * leg + i, time);
                y[7 + 3 * leg + i] = angle + lifted * swing;
            }
        }
        y
    }

    /// Value of the sines of velocity `i` at a time, between −1 and 1.
    fn wave(&self, i: usize, time: f64) -> f64 {
        self.waves[i].iter().map(|[rate, phase]| (rate * time + phase).sin()).sum::<f64>() / 3.0
    }
}

/// Smooth step from 0 to 1, with zero velocity and acceleration at both ends.
fn rise(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}

/// Time within the turn of a leg [s].
fn within_turn(leg: usize, time: f64) -> f64 {
    let before = ORDER.iter().take_while(|other| **other != leg).count();
    time - TURN * before as f64
}

/// Factor of the swing of a leg, from 0 (standing) to 1 (full swing).
fn lifted(leg: usize, time: f64) -> f64 {
    let s = within_turn(leg, time);
    rise((s - UNLOADED[1]) / 0.5) * rise((LOADED[0] - s) / 0.5)
}

/// Weights of the feet in the distribution of forces. The weight of a lifted foot is 0.
fn weights(time: f64) -> [f64; 4] {
    std::array::from_fn(|leg| {
        let share = |from: [f64; 2]| rise((within_turn(leg, time) - from[0]) / (from[1] - from[0]));
        1.0 - share(UNLOADED) + share(LOADED)
    })
}

/// Displacement of the leaning trunk [m]. It changes between two turns, while all feet stand.
fn lean(time: f64) -> [f64; 2] {
    let mut at = [0.0; 2];
    for leg in ORDER {
        let share = rise(within_turn(leg, time) / REST);
        let [front, left] = SIDES[leg];
        for (at, to) in at.iter_mut().zip([-front * LEAN[0], -left * LEAN[1]]) {
            *at += share * (to - *at);
        }
    }
    at
}

/// Joint angles [rad] with which the foot of a leg reaches a place.
fn leg_angles(y: &[f64; NY], leg: usize, place: &[f64; 3]) -> [f64; 3] {
    let [front, left] = SIDES[leg];
    let (origin, axes) = robot::frame_middle_pose(y);
    let from: [f64; 3] = std::array::from_fn(|i| place[i] - origin[i]);
    let inside = |c: usize| (0..3).map(|i| axes[i][c] * from[i]).sum::<f64>();
    let (x, across, up) = (inside(0) - front * HIP[0], inside(1) - left * HIP[1], inside(2));
    let side = left * ACROSS;
    let down = (across * across + up * up - side * side).sqrt();
    let hip = up.atan2(across) - (-down).atan2(side);
    let calf = -((x * x + down * down) / (2.0 * LENGTH * LENGTH) - 1.0).acos();
    let thigh = (-x).atan2(down) - (LENGTH * calf.sin()).atan2(LENGTH + LENGTH * calf.cos());
    // The hip angle is a difference of two angles, so it is wrapped to the range from −π to π.
    [hip.sin().atan2(hip.cos()), thigh, calf]
}

/// Joint torques, and forces at the feet, that cause these accelerations.
fn forces(y: &[f64; NY], v: &[f64; N], a: &[f64; N], weights: [f64; 4]) -> Outcome<([f64; M], Wrenches)> {
    let inverse = |w: &Wrenches| robot::inverse_dynamics_with_wrenches(y, v, a, w);
    let jacobians = FEET.map(|foot| (foot.jacobian)(y));
    let wrenches = at_feet(&inverse(&[[0.0; 6]; WRENCHES]), &jacobians, weights)?;
    let rows = inverse(&wrenches);
    Ok((std::array::from_fn(|j| rows[N - M + j]), wrenches))
}
