//! Score of a planned motion, and the limits that it violates.

use super::super::robot::{FollowerLimits, Robot};
use super::super::shafts::RobotRows;
use super::chart::Chart;
use super::columns::independent_columns;
use super::inputs::Inputs;
use super::levels;
use super::motors::no_load_speeds;
use super::refusals::Refusals;
use super::settings::PlanSettings;
use super::{ExcitationLimits, FourierMotion, Instant};
use nalgebra::DMatrix;

/// Speed and torque that a planned motion requires from a drive that acts on several joints.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedShaft {
    /// Name of the drive.
    pub name: String,
    /// Largest speed of the drive's shaft [rad/s].
    pub speed: f64,
    /// Largest torque of the motor for the described robot without friction [N·m].
    pub torque: f64,
    /// Described limit of the torque [N·m]; infinite if the description has no limit.
    pub limit: f64,
}

/// Largest excess over a limit that counts as rounding: a share of a limit of speed, or a distance in rad or m.
const ROUNDING: f64 = 1e-9;
/// Number of friction columns of a joint: viscous, Coulomb, offset.
const FRICTION: usize = 3;
/// Robot, regressor columns and limits from which a motion's score is computed.
pub(super) struct Design<'a> {
    robot: &'a dyn Robot,
    rows: RobotRows<'a>,
    /// Indices of linearly independent columns of the regressor W.
    pub(super) independent: Vec<usize>,
    columns: usize,
    /// Largest force of each joint or shaft.
    efforts: Vec<f64>,
    /// Largest torque of each shaft's motor.
    torques: Vec<f64>,
    /// Weights 1/σ of the forces, with the standard deviation σ of each force.
    weights: Vec<f64>,
    sign_speeds: Vec<f64>,
    /// Limits of joints that follow other joints, and no-load speeds of the motors.
    followers: Vec<FollowerLimits>,
    /// Inputs; `None` if all inputs are drives without limits.
    pub(super) inputs: Option<Inputs<'a>>,
    velocity_share: f64,
    chart: &'a Chart,
    limits: &'a [ExcitationLimits],
    /// Reasons for which motions were rejected early.
    pub(super) refusals: Refusals,
    /// Rows whose friction and offset are estimated: all rows except those of joints with a quaternion.
    rubbing: Vec<usize>,
}

impl<'a> Design<'a> {
    pub(super) fn new(
        robot: &'a dyn Robot,
        rows: RobotRows<'a>,
        chart: &'a Chart,
        limits: &'a [ExcitationLimits],
        states: &[Instant],
        settings: &PlanSettings,
    ) -> Self {
        let states: Vec<Instant> = states.iter().map(|state| rows.instant(state)).collect();
        let usable = |robot: &dyn Robot| -> Vec<f64> {
            robot.limits().iter().map(|limit| settings.effort_share * limit.effort).collect()
        };
        let (efforts, of_rows) = (usable(robot), usable(&rows));
        let typical = largest_forces(&rows, &states);
        let mut torques = vec![f64::INFINITY; efforts.len()];
        rows.shafts_of_rows().iter().for_each(|shaft| torques[shaft.joint] = of_rows[shaft.joint]);
        let speeds: Vec<f64> = limits.iter().map(|limit| limit.velocity).collect();
        let weight = |(effort, typical): (&f64, &f64)| match [*effort, *typical] {
            [effort, _] if effort.is_finite() && effort > 0.0 => 1.0 / effort,
            [_, typical] if typical > 0.0 => 1.0 / typical,
            // Only friction moves this joint.
            _ => 1.0,
        };
        let turns = chart.turns();
        Self {
            robot,
            // Not all factors of described joint friction can be distinguished from friction of shafts.
            independent: independent_columns(&rows, robot.parameter_names().len(), &states),
            columns: rows.parameter_names().len(),
            weights: of_rows.iter().zip(&typical).map(weight).collect(),
            efforts,
            torques,
            followers: robot.followers().into_iter().chain(no_load_speeds(robot)).collect(),
            inputs: Inputs::of(robot, settings.effort_share),
            velocity_share: settings.velocity_share,
            chart,
            limits,
            refusals: Refusals::default(),
            rubbing: (0..limits.len()).filter(|row| !turns[*row]).collect(),
            sign_speeds: rows
                .speeds(&speeds)
                .into_iter()
                .map(|speed| levels::SIGN_SHARE.get() * speed)
                .collect(),
            rows,
        }
    }

    pub(super) fn friction(&self) -> usize {
        FRICTION * self.rubbing.len()
    }

    /// Scales down and shifts the motion of joints that other joints follow, so that the following joints keep their limits.
    pub(super) fn narrow(&self, motion: &mut FourierMotion, samples: usize) {
        for joint in &self.followers {
            let instants = motion.instants(samples);
            let fastest = instants.iter().map(|[_, v, _]| joint.sum(v.iter().copied(), 0.0).abs());
            let fastest = fastest.fold(0.0, f64::max);
            let middle = joint.sum(motion.center.iter().copied(), joint.offset);
            let positions =
                instants.iter().map(|[y, ..]| joint.sum(y.iter().copied(), joint.offset) - middle);
            let [low, high] = positions.fold([0.0_f64; 2], |[low, high], y| [low.min(y), high.max(y)]);
            let [least, most] = joint.position;
            // If the motion does not move the following joint, a quotient has the divisor 0 and does not scale the motion.
            let share = 1.0_f64
                .min((most - least) / (high - low))
                .min(self.velocity_share * joint.velocity / fastest);
            let share = if share < 1.0 { share * (1.0 - ROUNDING) } else { 1.0 };
            let shift = (least - middle - share * low).max(0.0) - (middle + share * high - most).max(0.0);
            let square: f64 = joint.ratios.iter().map(|ratio| ratio * ratio).sum();
            let followed = joint.ratios.iter().zip(&mut motion.center).zip(&mut motion.coefficients);
            for ((ratio, center), pairs) in followed.filter(|((ratio, _), _)| **ratio != 0.0) {
                *center += ratio * shift / square;
                pairs.iter_mut().for_each(|pair| *pair = pair.map(|x| share * x));
            }
        }
    }

    /// Whether the motion leaves the limits of a joint that follows other joints, or of a joint whose motion was shifted for
    /// such a joint.
    fn leaves_limits(&self, [y, v, _]: &Instant) -> bool {
        if self.followers.is_empty() {
            return false;
        }
        let outside = |(y, limit): (&f64, &ExcitationLimits)| {
            *y < limit.position[0] - ROUNDING || *y > limit.position[1] + ROUNDING
        };
        if y.iter().zip(self.limits).any(outside) {
            return true;
        }
        self.followers.iter().any(|joint| {
            let position = joint.sum(y.iter().copied(), joint.offset);
            let is_within =
                joint.position[0] - ROUNDING <= position && position <= joint.position[1] + ROUNDING;
            let speed = joint.sum(v.iter().copied(), 0.0).abs();
            !is_within || speed > self.velocity_share * joint.velocity * (1.0 + ROUNDING)
        })
    }

    /// Minus the logarithm of the determinant of the Fisher information; infinite if the motion exceeds the efforts, the
    /// limits of joints that follow other joints, or the limits of rotating bodies.
    ///
    /// - `coordinates`: states in the coordinates of the motion ([`Chart`])
    pub(super) fn score(&self, coordinates: &[Instant]) -> f64 {
        if coordinates.iter().any(|instant| self.leaves_limits(instant)) {
            return self.refusals.refuse("a joint that follows others exceeds its limits");
        }
        let instants = self.chart.instants(coordinates);
        if self.chart.largest_excess(&instants, self.limits) > 1.0 + ROUNDING {
            return self.refusals.refuse("a rotating body exceeds its speed limit");
        }
        if let Some(name) = self.beyond(&instants).next() {
            return self.refusals.refuse(&name);
        }
        match self.information(&instants).cholesky() {
            Some(factor) => -2.0 * factor.l().diagonal().iter().map(|x| x.ln()).sum::<f64>(),
            None => self.refusals.refuse("the motion does not determine all parameters"),
        }
    }

    /// Fisher information `Σ Wᵀ Σ_τ⁻¹ W` over the states, with the regressor W and the covariance Σ_τ of the
    /// forces.
    pub(super) fn information(&self, instants: &[Instant]) -> DMatrix<f64> {
        let n = self.efforts.len();
        let count = self.independent.len() + self.friction();
        let mut matrix = DMatrix::zeros(count, n * instants.len());
        let mut regressor = vec![0.0; n * self.columns];
        for (i, instant) in instants.iter().enumerate() {
            let [y, v, a] = self.rows.instant(instant);
            self.rows.inertial_regressor(&y, &v, &a, &mut regressor);
            for (joint, row) in regressor.chunks_exact(self.columns.max(1)).enumerate() {
                let mut column = matrix.column_mut(i * n + joint);
                for (entry, index) in self.independent.iter().enumerate() {
                    column[entry] = row[*index] * self.weights[joint];
                }
                let Some(place) = self.rubbing.iter().position(|row| *row == joint) else { continue };
                let first = self.independent.len() + FRICTION * place;
                let friction = [v[joint], (v[joint] / self.sign_speeds[joint]).tanh(), 1.0];
                for (k, value) in friction.into_iter().enumerate() {
                    column[first + k] = value * self.weights[joint];
                }
            }
        }
        &matrix * matrix.transpose()
    }

    /// Names of joints, inputs at frames, motors and shafts whose limits a motion exceeds. The names are computed lazily.
    fn beyond<'b>(&'b self, instants: &'b [Instant]) -> impl Iterator<Item = String> + use<'a, 'b> {
        let joints = || named_beyond(self.robot, instants, &self.efforts);
        let inputs = || self.inputs.as_ref().and_then(|inputs| inputs.exceeded(instants));
        let shafts = || {
            let along: Vec<Instant> = instants.iter().map(|instant| self.rows.instant(instant)).collect();
            named_beyond(&self.rows, &along, &self.torques)
        };
        let have_torques = self.torques.iter().any(|torque| torque.is_finite());
        std::iter::once_with(joints)
            .flatten()
            .chain(std::iter::once_with(inputs).flatten())
            .chain(have_torques.then(|| std::iter::once_with(shafts)).into_iter().flatten().flatten())
    }

    /// Names of the limits that the robot exceeds if it rests at the middle of its positions.
    pub(super) fn beyond_at_rest(&self) -> Vec<String> {
        let middle = self.limits.iter().map(|limit| 0.5 * (limit.position[0] + limit.position[1]));
        let rest = vec![0.0; self.limits.len()];
        let still = [self.chart.instant(&[middle.collect(), rest.clone(), rest])];
        self.beyond(&still).collect()
    }

    /// Sentence on the limits that the approach exceeds; `None` if it exceeds none.
    pub(super) fn doubts_about(&self, approach: &[Instant]) -> Option<String> {
        let beyond: Vec<String> = self.beyond(approach).collect();
        (!beyond.is_empty()).then(|| {
            format!(
                "the path from the start posture needs more effort than the plan may use, at {}. Move more slowly, or start from \
                 a nearer posture",
                beyond.join(", ")
            )
        })
    }

    /// Speeds and torques that the motion requires from the motors of shafts.
    pub(super) fn shafts(&self, instants: &[Instant]) -> Vec<PlannedShaft> {
        let along: Vec<Instant> = instants.iter().map(|instant| self.rows.instant(instant)).collect();
        let [speeds, torques] = largest(&self.rows, &along);
        let shafts = self.rows.shafts_of_rows().iter().map(|shaft| PlannedShaft {
            name: shaft.name.clone(),
            speed: speeds[shaft.joint],
            torque: torques[shaft.joint],
            limit: shaft.torque,
        });
        shafts.collect()
    }
}

/// Largest speed and largest force of each joint or shaft over the states.
pub(super) fn largest(robot: &dyn Robot, instants: &[Instant]) -> [Vec<f64>; 2] {
    let speed = |i: usize| instants.iter().map(|[_, v, _]| v[i].abs()).fold(0.0, f64::max);
    [(0..robot.joint_names().len()).map(speed).collect(), largest_forces(robot, instants)]
}

/// Names of the joints or shafts whose largest forces exceed their limits.
fn named_beyond(robot: &dyn Robot, instants: &[Instant], limits: &[f64]) -> Vec<String> {
    let forces = largest_forces(robot, instants).into_iter().zip(limits);
    let names = robot.joint_names().into_iter().zip(forces);
    names.filter(|(_, (force, most))| force > most).map(|(name, _)| name).collect()
}

fn largest_forces(robot: &dyn Robot, instants: &[Instant]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; robot.joint_names().len()];
    let mut forces = largest.clone();
    for [y, v, a] in instants {
        robot.rigid_forces(y, v, a, &mut forces);
        largest.iter_mut().zip(&forces).for_each(|(most, force)| *most = most.max(force.abs()));
    }
    largest
}
