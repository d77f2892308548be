//! Smooth motions through poses for robots with quaternions.

use super::{Sample, Trajectory, TrajectoryError};
use crate::dynamics::{Dynamics, Named};
#[cfg(not(feature = "std"))]
use crate::no_std::*;

/// Smallest angle of rotation that counts as 180° (rad), so that the shortest direction is not unique.
const HALF_TURN: f64 = core::f64::consts::PI - 1e-6;

/// A smooth (C²) motion of a robot with quaternions through positions at given times. Attitudes turn in the shortest
/// direction. Before its start and after its end the motion is at rest.
///
/// The motion between the points y_k at t_k and y_{k+1} at t_k + T_k is a Bézier curve on the manifold (Kim, Kim and Shin,
/// *A general construction scheme for unit quaternion curves with simple high order derivatives*, SIGGRAPH 1995). At its
/// ends it has the velocities v_k and v_{k+1} and zero accelerations:
///
/// ```text
///     y(t) = y_k ⊕ β₁(s) d₁ ⊕ β₂(s) d₂ ⊕ β₃(s) d₃,    s = (t − t_k)/T_k,    d₁ = 2 v_k T_k/5,    d₃ = 2 v_{k+1} T_k/5
/// ```
///
/// β₁, β₂, β₃ are sums of Bernstein polynomials of degree 5 that grow from 0 to 1. d₂ is chosen so that the curve ends in
/// y_{k+1}. Velocities v and accelerations v̇ are the exact derivatives. Coordinates of joints without quaternions are
/// polynomials of degree 5. For two points, the motion is from rest to rest along the geodesic `y_0 ⊕ β₂ (y_1 ⊖ y_0)`,
/// which is a screw motion for a floating joint.
///
/// Samples can have accelerations a_k ([`Self::sampled`]). The curve then has two more factors, which add these
/// accelerations at the ends: `⊕ T_k² γ(s) a_k` after the first factor and `⊕ T_k² γ(1 − s) a_{k+1}` after the last factor,
/// with γ(s) = s² (1 − s)³/2.
#[derive(Debug, Clone, PartialEq)]
pub struct GeodesicMotion<D, const N: usize, const M: usize, const NY: usize = N> {
    robot: D,
    pieces: Vec<Piece<N, NY>>,
    end: [f64; NY],
    duration: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Piece<const N: usize, const NY: usize> {
    begin: f64,
    length: f64,
    start: [f64; NY],
    ways: [[f64; N]; 3],
    /// Accelerations at both ends, times the square of the segment's duration.
    bends: Option<[[f64; N]; 2]>,
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> GeodesicMotion<D, N, M, NY> {
    /// Motion from rest at `start` to rest at `end` in `duration` (s).
    ///
    /// # Errors
    /// The errors of [`Self::through`].
    pub fn between(
        robot: D,
        start: [f64; NY],
        end: [f64; NY],
        duration: f64,
    ) -> Result<Self, TrajectoryError> {
        Self::through(robot, &[(0.0, start), (duration, end)])
    }

    /// Motion through `points`, at rest at both ends. Each point has a time (s) and positions [rad or m]. The first time
    /// must be 0. The velocity at an inner point is a weighted mean of the velocities of the two neighbouring segments. The
    /// weights reproduce a parabola exactly.
    ///
    /// # Errors
    /// - [`TrajectoryError::TooFew`] for fewer than two points.
    /// - [`TrajectoryError::OutOfRange`] for times that do not increase from 0.
    /// - [`TrajectoryError::NotFinite`] for an entry that is not finite.
    /// - [`TrajectoryError::Attitude`] for a quaternion that is not an attitude.
    /// - [`TrajectoryError::HalfTurn`] for a rotation by 180° between two points.
    pub fn through(robot: D, points: &[(f64, [f64; NY])]) -> Result<Self, TrajectoryError> {
        let (times, positions) = checked(&robot, points)?;
        let ways: Vec<[f64; N]> =
            positions.windows(2).map(|pair| robot.difference(&pair[0], &pair[1])).collect();
        check_turns(&robot, &ways)?;
        let lengths: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let velocities = velocities(&ways, &lengths);
        Self::of_pieces(robot, &times, &positions, &velocities, &|_| None)
    }

    /// Motion through samples at a fixed `period` T (s), with the positions, velocities and accelerations of
    /// the samples. If all rotations are about one axis, the motion between two samples is the polynomial of
    /// degree 5 that has these values. For other rotations with the angular velocity ω, the accelerations
    /// deviate by an amount proportional to T |ω × ω̇|, because rotations do not commute.
    ///
    /// # Errors
    /// The errors of [`Self::through`].
    pub fn sampled(robot: D, samples: &[Sample<N, NY>], period: f64) -> Result<Self, TrajectoryError> {
        let points: Vec<(f64, [f64; NY])> =
            samples.iter().enumerate().map(|(k, sample)| (k as f64 * period, sample.positions)).collect();
        let (times, positions) = checked(&robot, &points)?;
        if let Some(k) = samples.iter().position(|sample| !sample.is_finite()) {
            return Err(TrajectoryError::NotFinite { what: format!("sample {}", k + 1), value: f64::NAN });
        }
        let ways: Vec<[f64; N]> =
            positions.windows(2).map(|pair| robot.difference(&pair[0], &pair[1])).collect();
        check_turns(&robot, &ways)?;
        let velocities: Vec<[f64; N]> = samples.iter().map(|sample| sample.velocities).collect();
        let bend = |k: usize| samples[k].accelerations.map(|a| period * period * a);
        Self::of_pieces(robot, &times, &positions, &velocities, &|k| Some([bend(k), bend(k + 1)]))
    }

    /// The robot of the motion.
    pub(super) fn into_robot(self) -> D {
        self.robot
    }

    fn of_pieces(
        robot: D,
        times: &[f64],
        positions: &[[f64; NY]],
        velocities: &[[f64; N]],
        bends: &dyn Fn(usize) -> Option<[[f64; N]; 2]>,
    ) -> Result<Self, TrajectoryError> {
        let piece = |k: usize| {
            let length = times[k + 1] - times[k];
            let [first, last] = [velocities[k], velocities[k + 1]].map(|v| v.map(|v| 0.4 * v * length));
            // The middle factor leads from the end of the first factor to the beginning of the last factor.
            let from = robot.integrate(&positions[k], &first);
            let to = robot.integrate(&positions[k + 1], &last.map(|d| -d));
            let ways = [first, robot.difference(&from, &to), last];
            Piece { begin: times[k], length, start: positions[k], ways, bends: bends(k) }
        };
        let pieces: Vec<Piece<N, NY>> = (0..times.len() - 1).map(piece).collect();
        let middles: Vec<[f64; N]> = pieces.iter().map(|piece| piece.ways[1]).collect();
        check_turns(&robot, &middles)?;
        let duration = times.iter().copied().fold(0.0, f64::max);
        let end = positions.last().copied().unwrap_or_else(|| robot.neutral());
        Ok(Self { robot, pieces, end, duration })
    }

    fn inside(&self, piece: &Piece<N, NY>, t: f64) -> Sample<N, NY> {
        let mut sample = Sample::at_rest(piece.start);
        let s = (t - piece.begin) / piece.length;
        let mut add = |way: &[f64; N], [value, rate, change]: [f64; 3]| {
            let (rate, change) = (rate / piece.length, change / (piece.length * piece.length));
            self.add(&mut sample, way, [value, rate, change]);
        };
        let [first, middle, last] = blends(s);
        add(&piece.ways[0], first);
        piece.bends.iter().for_each(|[bend, _]| add(bend, bump(s)));
        add(&piece.ways[1], middle);
        add(&piece.ways[2], last);
        let [value, rate, change] = bump(1.0 - s);
        piece.bends.iter().for_each(|[_, bend]| add(bend, [value, -rate, change]));
        sample
    }

    /// Adds one factor `⊕ β d` with a displacement d and a polynomial β to the curve with the positions y,
    /// velocities v and accelerations v̇: `y ← y ⊕ β d`, `v ← Ad(exp(−β d)) v + β̇ d`, `v̇ ← Ad(exp(−β d)) v̇
    /// − β̇ [d, Ad(exp(−β d)) v] + β̈ d`.
    fn add(&self, sample: &mut Sample<N, NY>, way: &[f64; N], [value, rate, change]: [f64; 3]) {
        let d = way.map(|d| value * d);
        let (by_y, _) = self.robot.integrate_derivatives(&sample.positions, &d);
        let turned = |a: &[f64; N]| -> [f64; N] {
            core::array::from_fn(|i| by_y[i].iter().zip(a).map(|(m, a)| m * a).sum())
        };
        let (v, a) = (turned(&sample.velocities), turned(&sample.accelerations));
        let bracket = self.robot.bracket(way, &v);
        sample.positions = self.robot.integrate(&sample.positions, &d);
        sample.velocities = core::array::from_fn(|i| v[i] + rate * way[i]);
        sample.accelerations = core::array::from_fn(|i| a[i] - rate * bracket[i] + change * way[i]);
    }
}

/// The polynomials β₁, β₂, β₃ with their first and second derivatives. β₁ begins with the slope 5/2, β₃ ends with this
/// slope, and β₂ begins and ends with the slope 0.
fn blends(s: f64) -> [[f64; 3]; 3] {
    let r = 1.0 - s;
    // β₁ is half of 2 − (1 − s)⁵ − (1 − s)⁴ (1 + 4 s), and β₃(s) = 1 − β₁(1 − s).
    let outer = |s: f64, r: f64| {
        let (r2, r3) = (r * r, r * r * r);
        [1.0 - 0.5 * r2 * r2 * (r + 1.0 + 4.0 * s), 0.5 * r3 * (5.0 + 15.0 * s), -30.0 * s * r2]
    };
    let [value, rate, change] = outer(r, s);
    let last = [1.0 - value, rate, -change];
    let middle = [s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * s * s * r * r, 60.0 * s * r * (r - s)];
    [outer(s, r), middle, last]
}

/// γ(s) = s² (1 − s)³/2 with its first and second derivatives. At both ends all three values are 0, except the second
/// derivative at s = 0, which is 1.
fn bump(s: f64) -> [f64; 3] {
    let r = 1.0 - s;
    let value = 0.5 * s * s * r * r * r;
    let rate = 0.5 * s * r * r * (2.0 - 5.0 * s);
    [value, rate, r * (1.0 - 8.0 * s + 10.0 * s * s)]
}

type Points<const NY: usize> = (Vec<f64>, Vec<[f64; NY]>);

fn checked<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    points: &[(f64, [f64; NY])],
) -> Result<Points<NY>, TrajectoryError> {
    if points.len() < 2 {
        return Err(TrajectoryError::TooFew { what: "points", needed: 2, given: points.len() });
    }
    let mut last = None;
    let mut positions = Vec::with_capacity(points.len());
    for (point, (time, y)) in points.iter().enumerate() {
        if let Some(i) = y.iter().position(|entry| !entry.is_finite()) {
            let what = format!("point {}, {},", point + 1, Named(robot.position_names()[i]));
            return Err(TrajectoryError::NotFinite { what, value: y[i] });
        }
        robot.check_attitudes(y).map_err(|error| TrajectoryError::Attitude { point, error })?;
        let grows = last.map_or(*time == 0.0, |last| time.is_finite() && *time > last);
        if !grows {
            let range = "0 for the first point, and later than the point before for other points";
            return Err(TrajectoryError::OutOfRange { what: "the time of a point", value: *time, range });
        }
        last = Some(*time);
        let mut exact = *y;
        let _ = robot.normalize(&mut exact);
        positions.push(exact);
    }
    Ok((points.iter().map(|(time, _)| *time).collect(), positions))
}

/// Checks that no rotation between points is by 180°, because its shortest direction would not be unique.
fn check_turns<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize>(
    robot: &D,
    ways: &[[f64; N]],
) -> Result<(), TrajectoryError> {
    for (k, way) in ways.iter().enumerate() {
        for joint in robot.quaternion_joints() {
            let turn = way.iter().skip(joint.angular_velocity()).take(3);
            let angle = turn.map(|w| w * w).sum::<f64>().sqrt();
            // This form rejects NaN.
            let is_short = angle < HALF_TURN;
            if !is_short {
                return Err(TrajectoryError::HalfTurn { joint: joint.name, point: k + 1, angle });
            }
        }
    }
    Ok(())
}

/// Velocities at the points, in the body frames at the points. They are zero at both ends, and weighted means of the two
/// neighbouring segments at inner points.
fn velocities<const N: usize>(ways: &[[f64; N]], lengths: &[f64]) -> Vec<[f64; N]> {
    let mean = |k: usize| {
        let [before, after] = [lengths[k - 1], lengths[k]];
        core::array::from_fn(|i| {
            let [slow, fast] = [ways[k - 1][i] / before, ways[k][i] / after];
            (slow * after + fast * before) / (before + after)
        })
    };
    (0..=ways.len()).map(|k| if k == 0 || k == ways.len() { [0.0; N] } else { mean(k) }).collect()
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> Trajectory<N, NY>
    for GeodesicMotion<D, N, M, NY>
{
    fn duration(&self) -> f64 {
        self.duration
    }

    fn sample(&self, t: f64) -> Sample<N, NY> {
        let after = self.pieces.partition_point(|piece| piece.begin <= t);
        match after.checked_sub(1).and_then(|k| self.pieces.get(k)) {
            Some(piece) if t < self.duration => self.inside(piece, t),
            Some(_) => Sample::at_rest(self.end),
            // The time is NaN or before the start.
            None => Sample::at_rest(self.pieces.first().map_or(self.end, |piece| piece.start)),
        }
    }
}
