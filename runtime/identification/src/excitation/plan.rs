//! A motion to record for the identification of a robot.

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
/// Example: no limit of the speed.
/// Fixture: `codegen/tests/motion_limits.rs`.
const ASSUMED: Rule = Rule::note("assumed-limits");

/// Sees: a motion that is smaller than the limits allow.
/// Matters: it shows less of inertia and friction.
/// Example: 60 % of the size.
/// Fixture: `codegen/tests/motion_limits.rs`.
const SMALLER: Rule = Rule::note("smaller-motion");

/// Sees: a way to the motion that goes beyond a limit.
/// Matters: the robot may not bear it.
/// Example: efforts on the way from a given posture.
/// Fixture: `codegen/tests/motion_limits.rs`.
const APPROACH: Rule = Rule::note("approach-beyond-limits");

/// A planned motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The motion; it begins and ends each period at rest. Of a joint with a quaternion it has the place of the origin in the
    /// parent's frame, where the joint slides, and the rotation vector φ of its attitude exp(φ); the CSV file has positions,
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
    /// All inputs, if some of them act at frames.
    pub inputs: Vec<PlannedInput>,
    /// Assumptions, and limits that the motion exceeds.
    pub findings: Vec<Finding>,
    chart: Chart,
}

/// Instants per instant of the search that show the requirements on inputs at frames, because their levers change on the way.
const SHOWN: usize = 10;

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
/// do not move in all directions, or a robot for which no motion tried, down to a tenth of the size, shows all parameters within
/// its efforts.
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
    let design = Design::new(robot, RobotRows::of(robot), (&chart, &limits, &states), settings);
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
        detail: design.refusals.detail(&design.beyond_at_rest()),
    })?;
    findings.extend(smaller(best.size));
    let instants = chart.instants(&best.motion.instants(settings.excitation.samples));
    let begin = &best.motion.instant(0.0)[0];
    let approach = settings.start.as_ref().map(|start| Approach::new(start, begin, (&chart, &limits)));
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

/// A motion that is smaller than the limits allow, because the efforts bear no more.
fn smaller(size: f64) -> Option<Finding> {
    (size < 1.0).then(|| {
        let message = format!(
            "motions that use all of their share of positions, speeds or accelerations need more than the share of the efforts: this \
             one has {:.0} % of their size",
            100.0 * size
        );
        SMALLER.found(message).help("with a longer period it can be larger")
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
    pub(crate) fn instant(&self, t: f64) -> Instant {
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
