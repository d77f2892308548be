//! Planning of a motion that is to be recorded for the identification of a robot.

use super::super::error::{IdentificationError, Result};
use super::super::pose::position_names;
use super::super::robot::Robot;
use super::super::shafts::RobotRows;
use super::approach::{Approach, require_posture};
use super::chart::Chart;
use super::columns::random_states;
use super::design::{Design, PlannedShaft, largest};
use super::inputs::{PlannedInput, keep_sides, require_driven};
use super::search::condition_of_scaled;
use super::settings::{PlanSettings, check};
use super::usable::{assumptions, usable};
use super::{FourierMotion, Instant};
use gelenk_findings::{Finding, Rule};

/// Sees: limits that a plan assumes because the description has none.
/// Matters: the motion may be too fast or too far for the robot.
/// Example: a joint without a limit of speed.
/// Fixture: `codegen/tests/motion_limits.rs`.
const ASSUMED: Rule = Rule::note("assumed-limits");

/// Sees: a motion that is smaller than the limits allow.
/// Matters: a smaller motion excites inertia and friction less.
/// Example: 60 % of the size.
/// Fixture: `codegen/tests/motion_limits.rs`.
const SMALLER: Rule = Rule::note("smaller-motion");

/// Sees: a path to the motion that exceeds a limit.
/// Matters: the robot may be unable to follow it.
/// Example: efforts on the path from a given posture.
/// Fixture: `codegen/tests/motion_limits.rs`.
const APPROACH: Rule = Rule::note("approach-beyond-limits");

/// A planned motion with the approach, the required speeds and efforts, and findings.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The motion. It is at rest at the beginning and end of each period. The coordinates of a joint with a quaternion are the
    /// rotation vector φ of its orientation exp(φ). If the joint is floating, the position of its origin in the parent's frame
    /// comes before φ. The CSV file has positions, velocities and accelerations instead of these coordinates.
    pub motion: FourierMotion,
    /// The approach from the given posture to the beginning of the motion; `None` if no posture is given.
    pub approach: Option<Approach>,
    /// Number of base parameters (independent combinations of inertial parameters) and number of friction parameters that the
    /// motion has to determine.
    pub parameters: [usize; 2],
    /// Condition number of the regressor of the base and friction parameters. Its rows are divided by the joints' efforts, and
    /// its columns are scaled to unit length.
    pub condition: f64,
    /// Smallest score of the random motions from which the search started. The score is minus the logarithm of the determinant
    /// of the Fisher information.
    pub start: f64,
    /// Largest speeds [rad/s or m/s] and largest efforts [N·m or N] of the motion and the approach, one entry for each joint,
    /// for the described robot without friction.
    pub largest: [Vec<f64>; 2],
    /// Speeds and torques that the motion and the approach require from drives that act on several joints.
    pub shafts: Vec<PlannedShaft>,
    /// Ranges of all inputs that the motion and the approach require, if some inputs act at frames; otherwise empty.
    pub inputs: Vec<PlannedInput>,
    /// Findings about assumed limits, about the size of the motion, and about limits that the approach exceeds.
    pub findings: Vec<Finding>,
    chart: Chart,
}

/// Factor between the number of times at which required inputs at frames are computed and the number of times in the search.
/// More times are necessary because the levers of these inputs change with the position.
const SHOWN: usize = 10;

/// Plans a motion that determines the base parameters and the friction of all joints.
///
/// The search minimizes minus the logarithm of the determinant of the Fisher information `Σ Wᵀ Σ_τ⁻¹ W` (D-optimality). The
/// determinant is large if the confidence ellipsoid of the parameters is small.
/// - W is the regressor at one time. It has a column for each independent inertial parameter, and three columns for each
///   joint without a quaternion: the velocity v, a smooth sign of v, and 1.
/// - Σ_τ is the diagonal matrix of the squares of the usable efforts. If a joint has no limit of the effort, its typical force
///   is used instead.
/// - Shafts of drives that act on several joints replace rows of joints ([`crate::shafts`]), with the torque of their motors.
///
/// The motion keeps the limits of the joints. Its forces keep the usable share of the efforts, of the motors' torques, and
/// of the range that torque–speed lines leave at each speed. If inputs act at frames, for example cylinders, the motion keeps
/// the usable share of their limits. The plan does not consider obstacles and collisions of links.
///
/// - `progress`: receives a sentence about the search
///
/// # Errors
/// - [`Setting`](IdentificationError::Setting): a setting out of its range, or a start beyond the described limits
/// - [`Shape`](IdentificationError::Shape): a start with a wrong number of positions
/// - [`File`](IdentificationError::File): a joint that no input moves, or a joint with a quaternion that the inputs do not
///   move in all directions
/// - [`NotConverged`](IdentificationError::NotConverged): no tried motion, down to a tenth of the size that the limits allow,
///   determines all parameters within the limits
pub fn plan(robot: &dyn Robot, settings: &PlanSettings, progress: &mut dyn FnMut(&str)) -> Result<Plan> {
    check(settings)?;
    let chart = Chart::of(robot);
    settings.start.as_ref().map_or(Ok(()), |start| require_posture(robot, &chart, start))?;
    let mut limits = usable(robot, settings, &chart);
    let mut notes = assumptions(robot, settings, &chart);
    notes.extend(keep_sides(robot, &chart, &mut limits));
    let mut findings: Vec<Finding> = notes.into_iter().map(|note| ASSUMED.found(note)).collect();
    let states = random_states(&limits, &chart);
    require_driven(robot, &states)?;
    let design = Design::new(robot, RobotRows::of(robot), &chart, &limits, &states, settings);
    progress(&format!(
        "searching for a motion that determines {} base parameters and {} friction parameters",
        design.independent.len(),
        design.friction()
    ));
    let best = settings.excitation.minimize(
        &limits,
        |instants| design.score(instants),
        |mut motion| {
            motion.start_at_rest();
            motion
        },
        |motion| {
            design.narrow(motion, settings.excitation.samples);
            chart.narrow(motion, &limits, settings.excitation.samples);
        },
    )?;
    let best = best.ok_or_else(|| IdentificationError::NotConverged {
        what: "the search for a motion".into(),
        iterations: settings.excitation.starts * settings.excitation.iterations,
        detail: design.refusals.detail(&design.beyond_at_rest()),
    })?;
    findings.extend(smaller(best.size));
    let instants = chart.instants(&best.motion.instants(settings.excitation.samples));
    let begin = &best.motion.instant(0.0)[0];
    let approach = settings.start.as_ref().map(|start| Approach::new(start, begin, &chart, &limits));
    let along = chart.instants(&approach.iter().flat_map(Approach::instants).collect::<Vec<_>>());
    findings.extend(design.doubts_about(&along).into_iter().map(|doubt| APPROACH.found(doubt)));
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
        findings,
        chart,
    })
}

/// The finding about a motion that is smaller than the limits allow, because a larger motion would exceed the efforts; `None`
/// if the motion has its full size.
fn smaller(size: f64) -> Option<Finding> {
    (size < 1.0).then(|| {
        let message = format!(
            "this motion has only {:.0} % of the size that the limits allow. Larger motions need more effort than the plan may use",
            100.0 * size
        );
        SMALLER.found(message).help("give a longer period (--seconds) for a larger motion")
    })
}

impl Plan {
    /// Returns the first line of the CSV file, including its line break.
    pub fn header(robot: &dyn Robot) -> String {
        let names = robot.joint_names();
        let positions = position_names(&robot.quaternion_joints(), &names);
        let columns = |kind: &str, names: &[String]| -> String {
            names.iter().map(|name| format!(",{kind}_{name}")).collect()
        };
        format!("t{}{}{}\n", columns("q", &positions), columns("dq", &names), columns("ddq", &names))
    }

    /// Positions y, velocities and accelerations of the motion at time `t` [s].
    pub(crate) fn instant(&self, t: f64) -> Instant {
        self.chart.instant(&self.motion.instant(t))
    }

    /// Returns the approach and the motion as the text of a CSV file. The columns are `t` \[s\], and `q_`, `dq_` and `ddq_`
    /// (position, velocity, acceleration) with the names of the joints. A joint with a quaternion has a column for each
    /// position entry, for example `q_base_x` to `q_base_qw`. `gelenk_runtime::trajectory::Recording::open` reads this file,
    /// for example to compare a log of the motion with the plan.
    ///
    /// - `period`: time between rows \[s\]
    /// - `periods`: number of periods of the motion
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
