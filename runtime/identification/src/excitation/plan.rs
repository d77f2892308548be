//! A motion to record for the identification of a robot.

use super::super::error::{IdentificationError, Result, require_setting};
use super::super::pose::position_names;
use super::super::random::SplitMix64;
use super::super::robot::{FollowerLimits, Robot};
use super::super::shafts::{RobotRows, ShaftRows};
use super::approach::{Approach, require_posture};
use super::chart::Chart;
use super::inputs::{FrameInputs, PlannedInput, keep_sides, require_driven};
use super::motors::{Motors, no_load_speeds};
use super::refusals::Refusals;
use super::search::condition_of_scaled;
use super::usable::{assumptions, usable};
use super::{Excitation, ExcitationLimits, FourierMotion, Instant};
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// What a plan may use of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSettings {
    /// Search, and period of the motion (s).
    pub excitation: Excitation,
    /// Share of the range of positions that is used, about its middle.
    pub position_share: f64,
    /// Share of the described speeds that is used.
    pub velocity_share: f64,
    /// Share of the described efforts that the motion may need by the described robot.
    pub effort_share: f64,
    /// Largest acceleration [rad/s² or m/s²]; twice the largest speed per second where there is none.
    pub acceleration: Option<f64>,
    /// Largest speed [rad/s or m/s] of joints without a described one.
    pub velocity: f64,
    /// Range of positions \[m\] of prismatic joints without described ones; revolute ones may turn by ±π.
    pub travel: f64,
    /// Largest turn \[rad\] of joints with a quaternion from where they stand at 0, below π: they have no described one.
    pub turn: f64,
    /// Posture from which the robot goes to the beginning of the motion [rad or m], by joint; of a joint with a quaternion the
    /// place and the rotation vector.
    pub start: Option<Vec<f64>>,
}

impl Default for PlanSettings {
    fn default() -> Self {
        Self {
            excitation: Excitation {
                period: 20.0,
                harmonics: 8,
                samples: 100,
                starts: 3,
                iterations: 300,
                seed: 1,
            },
            position_share: 0.9,
            velocity_share: 0.7,
            effort_share: 0.7,
            acceleration: None,
            velocity: 1.0,
            travel: 0.2,
            turn: 1.0,
            start: None,
        }
    }
}

/// A planned motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The motion; it begins and ends each period at rest. Of a joint with a quaternion it has the place of the origin in the
    /// parent's frame, where the joint slides, and the rotation vector φ of its attitude exp(φ); [`Plan::instant`] has positions,
    /// velocities and accelerations.
    pub motion: FourierMotion,
    /// The way from the given posture to the beginning of the motion.
    pub approach: Option<Approach>,
    /// Number of base parameters and of friction parameters that the plan asks for.
    pub parameters: [usize; 2],
    /// Condition number of their regressor, rows by the joints' efforts, columns scaled to unit length.
    pub condition: f64,
    /// The same for the best random motion before the search.
    pub start: f64,
    /// Largest speeds and efforts of the motion and of the way to it by joint, by the described robot.
    pub largest: [Vec<f64>; 2],
    /// The shafts of drives that act on several joints.
    pub shafts: Vec<PlannedShaft>,
    /// All inputs, where some of them act at frames.
    pub inputs: Vec<PlannedInput>,
    /// What was assumed, in sentences.
    pub notes: Vec<String>,
    chart: Chart,
}

/// What a planned motion asks of the motor of a drive that acts on several joints.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedShaft {
    /// Name of the drive.
    pub name: String,
    /// Largest speed of its shaft [rad/s].
    pub speed: f64,
    /// Largest torque of its motor without friction, by the described robot [N·m].
    pub torque: f64,
    /// Described limit of this torque; infinite where there is none.
    pub limit: f64,
}

/// Part of a limit, and of a unit of position, that counts as none.
const ROUNDING: f64 = 1e-9;
/// Friction columns of a joint: viscous, Coulomb, offset.
const FRICTION: usize = 3;
/// Speed within which Coulomb friction changes its sign, as a share of the joint's largest.
const SIGN_SHARE: f64 = 0.02;
/// So many times as many instants as the search has show what a motion asks of inputs at frames, whose levers change on the way.
const SHOWN: usize = 10;
/// States that tell dependent columns of the regressor from independent ones.
const STATES: usize = 60;

/// Plans a motion that shows the base parameters and the friction of all joints.
///
/// Minus the logarithm of the determinant of the Fisher information `Σ Wᵀ Σ_τ⁻¹ W` is minimized (D-optimality),
/// Σ_τ with the squares of the described efforts: the volume of the parameters' confidence ellipsoid. W has a
/// column for each independent inertial parameter and for v, a smooth sign of v and 1 of each joint without a quaternion. Shafts of drives that
/// act on several joints take rows of joints ([`crate::shafts`]), with the torque of their motors.
///
/// The motion keeps the joints' limits, and its forces those of the described robot and of its motors, whose torque–speed lines
/// leave it the same share of what they leave at each speed. Where inputs act at frames, as cylinders do, it keeps their share of
/// the limits of the inputs. Obstacles, and links that
/// meet each other, are not known here.
///
/// # Errors
/// Shares out of range, a start beyond the described limits, a joint without a drive, a joint with a quaternion that the inputs
/// do not move in all directions, or a robot for which no motion tried shows all parameters within its efforts.
pub fn plan(robot: &dyn Robot, settings: &PlanSettings, progress: &mut dyn FnMut(&str)) -> Result<Plan> {
    check(settings)?;
    let chart = Chart::of(robot);
    settings.start.as_ref().map_or(Ok(()), |start| require_posture(robot, &chart, start))?;
    let mut limits = usable(robot, settings, &chart);
    let mut notes = assumptions(robot, settings, &chart);
    notes.extend(keep_sides(robot, &chart, &mut limits));
    let states = random_states(&limits, &chart);
    require_driven(robot, &states)?;
    let shafts = ShaftRows::of(robot);
    let rows = RobotRows::new(robot, shafts.as_ref());
    let design = Design::new(robot, rows, (&chart, &limits, &states), settings);
    progress(&format!(
        "searching a motion for {} base parameters and {} of friction",
        design.independent.len(),
        design.friction()
    ));
    let best = settings.excitation.minimize(
        &limits,
        |instants| design.score(instants),
        (
            |mut motion| {
                motion.start_at_rest();
                motion
            },
            |motion| {
                design.narrow(motion, settings.excitation.samples);
                chart.narrow(motion, &limits, settings.excitation.samples);
            },
        ),
    )?;
    let best = best.ok_or_else(|| IdentificationError::NotConverged {
        what: "the search for a motion".into(),
        iterations: settings.excitation.starts * settings.excitation.iterations,
        detail: design.refusals.detail(),
    })?;
    let instants = chart.instants(&best.motion.instants(settings.excitation.samples));
    let begin = &best.motion.instant(0.0)[0];
    let approach = settings.start.as_ref().map(|start| Approach::new(start, begin, (&chart, &limits)));
    let along = chart.instants(&approach.iter().flat_map(Approach::instants).collect::<Vec<_>>());
    notes.extend(design.doubts_about(&along));
    let all = [&instants[..], &along].concat();
    Ok(Plan {
        parameters: [design.independent.len(), design.friction()],
        condition: condition_of_scaled(&design.information(&instants)),
        start: best.start,
        largest: largest(robot, &all),
        shafts: design.shafts(&all),
        inputs: design.inputs.as_ref().map_or_else(Vec::new, |inputs| {
            let motion = chart.instants(&best.motion.instants(SHOWN * settings.excitation.samples));
            inputs.planned(&[&motion[..], &along].concat())
        }),
        motion: best.motion,
        approach,
        notes,
        chart,
    })
}

impl Plan {
    /// First line of the CSV, its end included.
    pub fn header(robot: &dyn Robot) -> String {
        let names = robot.joint_names();
        let positions = position_names(&robot.quaternion_joints(), &names);
        let columns = |kind: &str, names: &[String]| -> String {
            names.iter().map(|name| format!(",{kind}_{name}")).collect()
        };
        format!("t{}{}{}\n", columns("q", &positions), columns("dq", &names), columns("ddq", &names))
    }

    /// Positions y, velocities and accelerations of the motion at time `t` (s).
    pub fn instant(&self, t: f64) -> Instant {
        self.chart.instant(&self.motion.instant(t))
    }

    /// The motion as CSV, `t [s]`, then `q_`, `dq_`, `ddq_` and the joint's name: what
    /// `gelenk_runtime::trajectory::Recording::open` reads, and what a log of it is compared with. The approach comes first. A
    /// joint with a quaternion has a column for each of its position entries, `q_base_x` to `q_base_qw`.
    ///
    /// - `period`: of the rows (s); `periods`: how often the motion is repeated
    pub fn csv(&self, robot: &dyn Robot, period: f64, periods: usize) -> String {
        let mut text = Self::header(robot);
        let rows = (self.motion.period * periods as f64 / period).round() as usize;
        let approach = self.approach.as_ref().map_or(Vec::new(), |approach| approach.rows(period));
        let approach = approach.iter().map(|instant| self.chart.instant(instant));
        let motion = (0..=rows).map(|row| self.instant(row as f64 * period));
        for (row, instant) in approach.chain(motion).enumerate() {
            let (t, columns) = (row as f64 * period, instant.into_iter().flatten());
            text.push_str(&format!("{t:.6}{}\n", columns.map(|x| format!(",{x:.9}")).collect::<String>()));
        }
        text
    }
}

fn check(settings: &PlanSettings) -> Result<()> {
    let shares = [
        ("position share", settings.position_share),
        ("velocity share", settings.velocity_share),
        ("effort share", settings.effort_share),
    ];
    for (name, share) in shares {
        require_setting(name, share, share > 0.0 && share <= 1.0, "it must be above 0 and at most 1")?;
    }
    for (name, value) in [("velocity", settings.velocity), ("travel", settings.travel)] {
        require_setting(name, value, value > 0.0 && value.is_finite(), "it must be positive and finite")?;
    }
    let turns = settings.turn > 0.0 && settings.turn < PI;
    require_setting("turn", settings.turn, turns, "it must be above 0 and below π")?;
    let acceleration = settings.acceleration.unwrap_or(1.0);
    require_setting("acceleration", acceleration, acceleration > 0.0, "it must be positive")
}

/// What the score is made of.
struct Design<'a> {
    robot: &'a dyn Robot,
    rows: RobotRows<'a>,
    /// Columns of W that no others replace.
    independent: Vec<usize>,
    columns: usize,
    /// Efforts that the motion may need of the joints, torques that it may need of the motors of shafts, by rows, and weights
    /// 1/σ of the rows.
    efforts: Vec<f64>,
    torques: Vec<f64>,
    weights: Vec<f64>,
    sign_speeds: Vec<f64>,
    /// Joints that follow others, and motors by the speeds at which they have no torque left.
    followers: Vec<FollowerLimits>,
    /// Where something limits motors.
    motors: Option<Motors<'a>>,
    /// Where some inputs act at frames.
    inputs: Option<FrameInputs<'a>>,
    velocity_share: f64,
    chart: &'a Chart,
    limits: &'a [ExcitationLimits],
    /// What kept motions from being tried further.
    refusals: Refusals,
    /// Rows whose friction and offset are estimated: not those of joints with a quaternion.
    rubbing: Vec<usize>,
}

impl<'a> Design<'a> {
    fn new(
        robot: &'a dyn Robot,
        rows: RobotRows<'a>,
        (chart, limits, states): (&'a Chart, &'a [ExcitationLimits], &[Instant]),
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
            // Nothing moves this joint but friction.
            _ => 1.0,
        };
        Self {
            robot,
            rows,
            // Friction that is described on joints cannot be told from that of shafts by all of its factors.
            independent: independent_columns(&rows, robot.parameter_names().len(), &states),
            columns: rows.parameter_names().len(),
            weights: of_rows.iter().zip(&typical).map(weight).collect(),
            efforts,
            torques,
            followers: robot.followers().into_iter().chain(no_load_speeds(robot)).collect(),
            motors: Motors::of(robot, settings.effort_share),
            inputs: FrameInputs::of(robot, settings.effort_share),
            velocity_share: settings.velocity_share,
            chart,
            limits,
            refusals: Refusals::default(),
            rubbing: chart
                .turns()
                .iter()
                .enumerate()
                .filter(|(_, turns)| !**turns)
                .map(|(row, _)| row)
                .collect(),
            sign_speeds: rows.speeds(&speeds).into_iter().map(|speed| SIGN_SHARE * speed).collect(),
        }
    }

    fn friction(&self) -> usize {
        FRICTION * self.rubbing.len()
    }

    /// Shrinks and shifts a motion of the joints that others follow, so that those keep their limits.
    fn narrow(&self, motion: &mut FourierMotion, samples: usize) {
        for joint in &self.followers {
            let instants = motion.instants(samples);
            let fastest = instants.iter().map(|[_, v, _]| joint.sum(v.iter().copied(), 0.0).abs());
            let fastest = fastest.fold(0.0, f64::max);
            let middle = joint.sum(motion.center.iter().copied(), joint.offset);
            let positions =
                instants.iter().map(|[y, ..]| joint.sum(y.iter().copied(), joint.offset) - middle);
            let [low, high] = positions.fold([0.0_f64; 2], |[low, high], y| [low.min(y), high.max(y)]);
            let [least, most] = joint.position;
            // Quotients by 0, of a motion that does not move it, shrink nothing.
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

    /// Tells whether the motion leaves the limits of a joint that follows others, or of one that was shifted for it.
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

    /// Minus the logarithm of the determinant of the information; infinite beyond the efforts and the limits of joints
    /// that follow others and of bodies that turn.
    ///
    /// - `coordinates`: of the chart
    fn score(&self, coordinates: &[Instant]) -> f64 {
        if coordinates.iter().any(|instant| self.leaves_limits(instant)) {
            return self.refusals.refuse("the limits of joints that follow others");
        }
        let instants = self.chart.instants(coordinates);
        if self.chart.largest_excess(&instants, self.limits) > 1.0 + ROUNDING {
            return self.refusals.refuse("the speeds of bodies that turn");
        }
        if let Some(name) = self.beyond(&instants).next() {
            return self.refusals.refuse(&name);
        }
        match self.information(&instants).cholesky() {
            Some(factor) => -2.0 * factor.l().diagonal().iter().map(|x| x.ln()).sum::<f64>(),
            None => self.refusals.refuse("parameters that the motion does not show"),
        }
    }

    /// `Σ Wᵀ Σ_τ⁻¹ W` over the instants.
    fn information(&self, instants: &[Instant]) -> DMatrix<f64> {
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

    /// Joints, inputs at frames and shafts of which a motion asks more than it may, each found when it is asked for.
    fn beyond<'b>(&'b self, instants: &'b [Instant]) -> impl Iterator<Item = String> + use<'a, 'b> {
        let joints = || named_beyond(self.robot, instants, &self.efforts);
        let inputs = || self.inputs.as_ref().and_then(|inputs| inputs.exceeded(instants));
        let shafts = || {
            let along: Vec<Instant> = instants.iter().map(|instant| self.rows.instant(instant)).collect();
            named_beyond(&self.rows, &along, &self.torques)
        };
        let motors = || self.motors.as_ref().and_then(|motors| motors.exceeded(instants));
        let have_torques = self.torques.iter().any(|torque| torque.is_finite());
        std::iter::once_with(joints)
            .flatten()
            .chain(std::iter::once_with(inputs).flatten())
            .chain(std::iter::once_with(motors).flatten().map(|name| format!("motor {name}")))
            .chain(have_torques.then(|| std::iter::once_with(shafts)).into_iter().flatten().flatten())
    }

    /// What the way to the motion asks too much of, as a sentence.
    fn doubts_about(&self, approach: &[Instant]) -> Option<String> {
        let beyond: Vec<String> = self.beyond(approach).collect();
        (!beyond.is_empty()).then(|| {
            format!(
                "the way from the start needs more effort than the share that the plan may use: {}; go there more slowly, or start nearer",
                beyond.join(", ")
            )
        })
    }

    /// What the motion asks of the motors of shafts.
    fn shafts(&self, instants: &[Instant]) -> Vec<PlannedShaft> {
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

/// Largest speeds and forces.
fn largest(robot: &dyn Robot, instants: &[Instant]) -> [Vec<f64>; 2] {
    let speed = |i: usize| instants.iter().map(|[_, v, _]| v[i].abs()).fold(0.0, f64::max);
    [(0..robot.joint_names().len()).map(speed).collect(), largest_forces(robot, instants)]
}

/// Names of the rows whose largest forces exceed their limits.
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

fn random_states(limits: &[ExcitationLimits], chart: &Chart) -> Vec<Instant> {
    let mut random = SplitMix64::new(1);
    let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
    let mut state = || {
        let y = limits.iter().map(|l| between(l.position[0], l.position[1])).collect();
        let v = limits.iter().map(|l| between(-l.velocity, l.velocity)).collect();
        let a = limits.iter().map(|l| between(-l.acceleration, l.acceleration)).collect();
        chart.instant(&[y, v, a])
    };
    (0..STATES).map(|_| state()).collect()
}

/// Columns of W that are independent at random states, the strongest first found (Gautier 1991).
///
/// - `columns`: how many of them count
fn independent_columns(robot: &dyn Robot, columns: usize, states: &[Instant]) -> Vec<usize> {
    let (n, all) = (robot.joint_names().len(), robot.parameter_names().len());
    let mut stacked = DMatrix::zeros(n * states.len(), columns);
    let mut regressor = vec![0.0; n * all];
    for (i, [y, v, a]) in states.iter().enumerate() {
        robot.inertial_regressor(y, v, a, &mut regressor);
        for (joint, row) in regressor.chunks_exact(all.max(1)).enumerate() {
            row.iter().take(columns).enumerate().for_each(|(k, value)| stacked[(i * n + joint, k)] = *value);
        }
    }
    let largest = stacked.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    let (mut kept, mut basis): (Vec<usize>, Vec<nalgebra::DVector<f64>>) = (Vec::new(), Vec::new());
    for (k, column) in stacked.column_iter().enumerate() {
        let mut rest = column.clone_owned();
        // Twice is enough (Parlett 1980, section 6-9).
        for _ in 0..2 {
            basis.iter().for_each(|q| rest.axpy(-q.dot(&rest), q, 1.0));
        }
        if rest.norm() > 1e-8 * largest {
            basis.push(rest.normalize());
            kept.push(k);
        }
    }
    kept
}
