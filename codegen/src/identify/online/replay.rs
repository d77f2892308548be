//! Replay of a log: the estimator receives its rows as measurements of the control loop.

use gelenk_adaptation::{
    Adaptation, AdaptationSettings, DescribedForces, JointScale, JointState, MOST_DELAY, Magnitudes,
    Measured, Prediction, Trust, input_inverse,
};
use gelenk_dynamics::dynamics::Limits;
use gelenk_findings::Rule;
use gelenk_identification::robot::{JointLimits, Robot};
use gelenk_identification::run::{Effort, Run};
use gelenk_identification::{IdentificationError, Result};

/// Largest number of joints and of inputs of a robot, for which the estimator has fixed arrays. Unused
/// entries are not learned.
const MOST: usize = 32;
/// Significant digits to which the rate of a log is rounded, because clocks and printed times disturb it.
const RATE_DIGITS: usize = 6;
/// Smallest relative difference of the rates of two runs that is too large for two clocks of the same rate.
const OTHER_RATE: f64 = 0.01;
/// Largest deviation of a time step from a whole number of periods, in periods, for which velocities are
/// accurate enough.
const LARGEST_JITTER: f64 = 0.1;

/// Function that returns the described forces at positions y (rad or m), velocities ẏ (rad/s or m/s) and
/// accelerations ÿ (rad/s² or m/s²), for example [`DescribedForces::at`](super::DescribedForces::at). It
/// returns three vectors with an entry for each joint:
///
/// - forces of the inverse dynamics including friction, in N·m or N
/// - friction without its load-dependent part, in N·m or N
/// - load-dependent friction per unit of load. The load is the force of the drive without all friction.
pub type Forces<'a> = dyn Fn(&[f64], &[f64], &[f64]) -> [Vec<f64>; 3] + 'a;

/// Result of a replay: the learned friction of each joint.
#[derive(Debug, Clone)]
pub struct Replay {
    /// Settings of the friction estimator.
    pub settings: AdaptationSettings,
    /// Replay of each joint, in the order of the robot. It is `None` for a joint without an input or without
    /// a measured effort, because the friction of such a joint is not learned.
    pub joints: Vec<Option<JointReplay>>,
}

/// Learned friction of a joint in the course of the log.
#[derive(Debug, Clone)]
pub struct JointReplay {
    /// State of the joint's estimator after the last row of the log.
    pub state: JointState,
    /// Standard deviations of the learned coefficients before the first sample, one for each of the
    /// [terms](gelenk_adaptation::terms).
    pub prior: [f64; gelenk_adaptation::TERMS],
    /// Root mean square of the joint's speed in motion, in rad/s or m/s.
    pub speed: f64,
    /// Described friction at [`JointReplay::speed`], in N·m or N.
    pub described: f64,
    /// Samples that the estimator took, in the order of time.
    pub samples: Vec<OnlineSample>,
}

/// A sample that the estimator took, with its prediction and the friction that was learned up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnlineSample {
    /// Time since the first row in s. The times of a run follow those of the run before.
    pub time: f64,
    /// Time in s at which the run of this sample begins.
    pub begin: f64,
    /// Prediction of this sample's friction by the law that was learned from earlier samples.
    pub prediction: Prediction,
    /// Prediction error in N·m or N of the acting law, which a controller would have used.
    pub acting: f64,
    /// Learned friction (N·m or N) at the speed [`JointReplay::speed`] after this sample, and the half width
    /// (N·m or N) of its 90 % confidence interval.
    pub friction: [f64; 2],
    /// Friction of the acting law (which a controller would use) at the speed [`JointReplay::speed`] after
    /// this sample, in N·m or N.
    pub acting_friction: f64,
    /// State that determines which law a controller would use after this sample.
    pub trust: Trust,
}

impl JointReplay {
    /// Returns the root mean square over all samples of the error that `of` returns, in N·m or N; NaN if
    /// there are no samples.
    pub fn error(&self, of: impl Fn(&OnlineSample) -> f64) -> f64 {
        rms(self.samples.iter().map(of))
    }

    /// Returns the time in s of the last change of the acting law, which a controller would use.
    #[must_use]
    pub fn since(&self) -> f64 {
        let changed = self.samples.iter().rposition(|sample| sample.trust != self.state.trust);
        changed.and_then(|last| self.samples.get(last + 1)).map_or(0.0, |sample| sample.time)
    }
}

/// Replays runs in their order. Between two runs the estimator keeps its laws, as if the control loop were
/// restarted.
///
/// Efforts at the joints are the values at the times of their rows, and are interpolated linearly between
/// rows. Inputs act over the period after their row, because the control loop writes them after it has
/// measured the positions of the row.
///
/// - `delay`: time in s from the writing of an input until it acts
///
/// # Errors
/// [`IdentificationError`] in these cases:
///
/// - The robot has quaternions, driven joints or inputs at frames.
/// - The size of a joint's friction is unknown, because limits are missing.
/// - The log has currents, but a motor constant is not described.
/// - The period of the log is not constant, or is too long for the filter.
/// - `delay` is negative, too long, or not a multiple of the period.
pub fn replay(robot: &dyn Robot, forces: &Forces<'_>, runs: &[Run], delay: f64) -> Result<Replay> {
    let robot = Described::new(robot, forces, runs)?;
    let rate = rate(runs)?;
    let settings = settings(rate, delay)?;
    let adaptation = Adaptation::new(robot.scales()?, settings, |y, v, a| robot.forces(y, v, a));
    let mut adaptation = adaptation.map_err(|error| fault("the log", error.to_string()))?;
    let speeds: Vec<f64> = (0..robot.joints).map(|joint| speed(runs, joint, rate)).collect();
    let described: Vec<f64> = (0..robot.joints).map(|joint| robot.friction(joint, speeds[joint])).collect();
    let mut samples = vec![Vec::new(); robot.joints];
    let mut begin = 0.0;
    for run in runs {
        adaptation.restart();
        let mut periods = 0.0;
        for measured in robot.measurements(run, rate) {
            let acting = adaptation.acting();
            adaptation.step(&measured, |y, v, a| robot.forces(y, v, a));
            periods += f64::from(measured.periods);
            let time = begin + periods / rate;
            for (joint, prediction) in adaptation.predictions().into_iter().enumerate() {
                let Some(prediction) = prediction else { continue };
                let explained: f64 = acting[joint].iter().zip(&prediction.terms).map(|(d, p)| d * p).sum();
                let friction = adaptation.friction(joint, described[joint], speeds[joint]);
                let acts = adaptation.acting_friction(joint, described[joint], speeds[joint]);
                samples[joint].push(OnlineSample {
                    time,
                    begin,
                    prediction,
                    acting: prediction.torque - explained,
                    friction: friction.unwrap_or_default(),
                    acting_friction: acts.unwrap_or_default(),
                    trust: adaptation.states()[joint].map_or(Trust::Unknown, |state| state.trust),
                });
            }
        }
        begin += periods / rate;
    }
    let joints = samples.into_iter().enumerate().map(|(joint, samples)| {
        Some(JointReplay {
            state: adaptation.states()[joint]?,
            prior: adaptation.scales()[joint]?.bounds(settings.largest_change).map(|bound| 0.5 * bound),
            speed: speeds[joint],
            described: described[joint],
            samples,
        })
    });
    Ok(Replay { settings, joints: joints.collect() })
}

/// Sees: a log or a robot for which the estimator of the control loop cannot learn friction.
/// Matters: the log is not replayed.
/// Example: a drive that loads two joints together.
/// Fixture: `drives_that_load_joints_together_are_refused_online`.
const NOT_REPLAYED: Rule = Rule::error("not-replayed");

fn fault(place: impl Into<String>, message: impl Into<String>) -> IdentificationError {
    IdentificationError::File(Box::new(NOT_REPLAYED.found(message).log(place, None)))
}

/// Returns the number of periods per second: the inverse of the median time step of the log, rounded to few
/// digits. Fails if a run has another rate.
fn rate(runs: &[Run]) -> Result<f64> {
    let steps = |run: &Run| run.times.windows(2).map(|t| t[1] - t[0]).collect::<Vec<f64>>();
    let rate = 1.0
        / median(runs.iter().flat_map(steps).collect())
            .ok_or(IdentificationError::Empty { what: "the log".into() })?;
    for run in runs {
        let steps = steps(run);
        let jitter = |step: &f64| step * rate - (step * rate).round().max(1.0);
        let irregular = steps.iter().filter(|step| jitter(step).abs() > LARGEST_JITTER).count();
        let own = 1.0 / median(steps.clone()).unwrap_or(1.0 / rate);
        if (own / rate - 1.0).abs() > OTHER_RATE {
            let message = format!(
                "it has {own:.6} rows per second, but the median of all logs is {rate:.6}. Replay only logs with the same rate"
            );
            return Err(fault(&run.name, message));
        }
        if irregular * 10 > steps.len() {
            let message = format!(
                "{irregular} of its {} time steps differ from the period of {:.6} s by more than a tenth. Replay a log with a \
                 constant period",
                steps.len(),
                1.0 / rate
            );
            return Err(fault(&run.name, message));
        }
    }
    let digits = RATE_DIGITS - 1;
    format!("{rate:.digits$e}")
        .parse()
        .map_err(|_| fault("the log", format!("its rate of {rate} rows per second is not valid")))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn settings(rate: f64, delay: f64) -> Result<AdaptationSettings> {
    let periods = (delay * rate).round();
    let is_whole = (delay * rate - periods).abs() < LARGEST_JITTER;
    if !is_whole || !(0.0..=MOST_DELAY as f64).contains(&periods) {
        return Err(IdentificationError::Setting {
            name: "--delay".into(),
            value: -delay,
            requirement: format!(
                "minus this value is the time until an input acts, and must be 0 to {MOST_DELAY} whole periods of {:.6} s",
                1.0 / rate
            ),
        });
    }
    Ok(AdaptationSettings { delay: periods as usize, ..AdaptationSettings::new(1.0 / rate) })
}

/// Returns the root mean square of a joint's speed in the rows in which its position changes. Time steps
/// over rows that were left out do not count.
fn speed(runs: &[Run], joint: usize, rate: f64) -> f64 {
    let speeds = runs.iter().flat_map(|run| {
        let steps = run.positions[joint].windows(2).zip(run.times.windows(2));
        let neighbours = steps.filter(|(_, t)| rate * (t[1] - t[0]) < 1.5);
        neighbours.map(|(y, _)| rate * (y[1] - y[0]))
    });
    let moving = rms(speeds.filter(|speed| *speed != 0.0));
    if moving.is_finite() { moving } else { 0.0 }
}

/// Returns the root mean square of the values; NaN if there are none.
pub(super) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (squares, count) = values.fold((0.0, 0.0), |(squares, count), x| (squares + x * x, count + 1.0));
    f64::sqrt(squares / count)
}

/// A described robot, with its data in arrays of the estimator's size.
struct Described<'a> {
    robot: &'a dyn Robot,
    forces: &'a Forces<'a>,
    joints: usize,
    effort: Effort,
    /// Input matrix of the robot, padded with zeros.
    matrix: [[f64; MOST]; MOST],
    limits: Vec<JointLimits>,
    /// Lowest and highest value of each input at which the drive reaches its limit.
    ends: [[f64; 2]; MOST],
    /// Whether the effort of each joint was measured.
    is_measured: Vec<bool>,
}

impl<'a> Described<'a> {
    fn new(robot: &'a dyn Robot, forces: &'a Forces<'a>, runs: &[Run]) -> Result<Self> {
        const HELP: &str = "the estimator needs an input at each joint whose friction it learns";
        let (joints, inputs) = (robot.joint_names().len(), robot.input_names().len());
        let effort = runs.first().map_or(Effort::Joint, |run| run.effort);
        let cases = [
            ("some joints have quaternions", !robot.quaternion_joints().is_empty()),
            ("the motion of some joints is prescribed (`driven`)", robot.unmeasured().contains(&true)),
            ("some inputs act at frames", robot.has_inputs_at_frames()),
        ];
        if let Some((reason, _)) = cases.iter().find(|(_, holds)| *holds) {
            return Err(fault(
                "the robot",
                format!("{reason}, so friction cannot be learned online: {HELP}"),
            ));
        }
        if joints.max(inputs) > MOST {
            let message = format!("the estimator supports at most {MOST} joints and inputs");
            return Err(fault("the robot", message));
        }
        if effort == Effort::Current && robot.described_currents().contains(&false) {
            let message = "its efforts are motor currents, but the description has no motor constant. Describe it, as in `drive = \
                           { motor_constant = 0.06 }`";
            return Err(fault("the log", message));
        }
        let mut matrix = [[0.0; MOST]; MOST];
        for (row, entries) in matrix.iter_mut().zip(robot.input_matrix().chunks(inputs.max(1))) {
            row[..inputs].copy_from_slice(entries);
        }
        let has_input = |joint: usize| matrix[joint].iter().any(|b| *b != 0.0);
        input_inverse(&matrix, has_input).map_err(|error| fault("the robot", error.to_string()))?;
        let limits = robot.limits();
        let ends = ends(robot, &limits, &matrix);
        let known = |effort: usize| runs.iter().all(|run| run.efforts[effort].iter().all(|u| u.is_finite()));
        let is_measured = |joint: usize| match effort {
            Effort::Joint => known(joint),
            _ => (0..inputs).all(|input| matrix[joint][input] == 0.0 || known(input)),
        };
        let is_measured = (0..joints).map(is_measured).collect();
        Ok(Self { robot, forces, joints, effort, matrix, limits, ends, is_measured })
    }

    fn forces(&self, y: &[f64; MOST], v: &[f64; MOST], a: &[f64; MOST]) -> DescribedForces<MOST> {
        let n = self.joints;
        let [forces, friction, shares] =
            (self.forces)(&y[..n], &v[..n], &a[..n]).map(|values| padded(&values));
        DescribedForces::new(forces, friction, &shares)
    }

    fn friction(&self, joint: usize, speed: f64) -> f64 {
        let mut v = [0.0; MOST];
        v[joint] = speed;
        self.forces(&[0.0; MOST], &v, &[0.0; MOST]).friction[joint]
    }

    fn scales(&self) -> Result<[Option<JointScale>; MOST]> {
        let mut scales = [None; MOST];
        for (joint, limits) in self.limits.iter().enumerate() {
            if self.matrix[joint].iter().all(|b| *b == 0.0) || !self.is_measured[joint] {
                continue;
            }
            let magnitudes = Magnitudes {
                speed: limits.velocity,
                effort: limits.effort,
                range: limits.position[1] - limits.position[0],
            };
            let friction = |v: &[f64; MOST]| self.friction(joint, v[joint]);
            scales[joint] = Some(magnitudes.scale(joint, friction).ok_or_else(|| {
                fault(
                    format!("joint {}", self.robot.joint_names()[joint]),
                    "the magnitude of its friction is unknown, because the description lacks its speed limit, or both its \
                     friction and its effort limit. Add the `limits` of the joint",
                )
            })?);
        }
        Ok(scales)
    }

    /// Returns the rows of a run as measurements, and an empty measurement for each row that was left out.
    fn measurements(&self, run: &'a Run, rate: f64) -> impl Iterator<Item = Measured<MOST>> {
        (0..run.times.len()).flat_map(move |row| {
            let before = row.saturating_sub(1);
            let periods = ((run.times[row] - run.times[before]) * rate).round().max(1.0) as u32;
            let missing = (run.rows[row] - run.rows[before]).saturating_sub(1) as u32;
            let missing = missing.min(periods - 1);
            let (torques, saturated) = match self.effort {
                Effort::Joint => self.at_joints(run, row),
                _ => self.by_inputs(run, row.checked_sub(1)),
            };
            let lost =
                Measured { positions: None, torques: [f64::NAN; MOST], saturated: [false; MOST], periods: 1 };
            let positions = Some(padded_row(&run.positions, row));
            let last = Measured { positions, torques, saturated, periods: periods - missing };
            std::iter::repeat_n(lost, missing as usize).chain([last])
        })
    }

    /// Returns the efforts at the joints over the period before a row. They are the mean of the efforts at
    /// both ends of the period.
    fn at_joints(&self, run: &Run, row: usize) -> ([f64; MOST], [bool; MOST]) {
        let before = padded_row(&run.efforts, row.saturating_sub(1));
        let mut torques = padded_row(&run.efforts, row);
        let mut saturated = [false; MOST];
        for joint in 0..self.joints {
            saturated[joint] = torques[joint].abs() >= self.limits[joint].effort;
            let mean = 0.5 * (before[joint] + torques[joint]);
            torques[joint] = if self.is_measured[joint] { mean } else { 0.0 };
        }
        (torques, saturated)
    }

    /// Returns the joint forces B u of the inputs u of a row, and whether the drive of each joint is at its
    /// limit. Inputs before the run are unknown.
    fn by_inputs(&self, run: &Run, row: Option<usize>) -> ([f64; MOST], [bool; MOST]) {
        let Some(row) = row else { return ([f64::NAN; MOST], [false; MOST]) };
        let inputs = padded_row(&run.efforts, row);
        let of_inputs = |joint: usize| {
            let force = self.matrix[joint].iter().zip(&inputs).map(|(b, u)| b * u).sum();
            if self.is_measured.get(joint).copied().unwrap_or(false) { force } else { 0.0 }
        };
        let at_limit = |j: usize| inputs[j] <= self.ends[j][0] || inputs[j] >= self.ends[j][1];
        let saturated = |joint: usize| (0..MOST).any(|j| self.matrix[joint][j] != 0.0 && at_limit(j));
        (std::array::from_fn(of_inputs), std::array::from_fn(saturated))
    }
}

/// Returns the lowest and the highest value of each input that motors and joints tolerate for a short time.
fn ends(robot: &dyn Robot, limits: &[JointLimits], matrix: &[[f64; MOST]; MOST]) -> [[f64; 2]; MOST] {
    const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    let mut inputs = [ANY; MOST];
    inputs.iter_mut().zip(robot.input_limits()).for_each(|(ends, limits)| *ends = limits);
    let mut efforts = [f64::INFINITY; MOST];
    efforts.iter_mut().zip(limits).for_each(|(effort, limits)| *effort = limits.effort);
    let limits = Limits {
        position: [ANY; MOST],
        velocity: [f64::INFINITY; MOST],
        effort: efforts,
        peak_effort: efforts,
        input: inputs,
        peak_input: inputs,
        dependent: &[],
        torque_speed: &[],
    };
    limits.at_inputs(matrix).peak
}

fn padded(values: &[f64]) -> [f64; MOST] {
    std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

/// Returns a row of values from several columns, padded with zeros.
fn padded_row(columns: &[Vec<f64>], row: usize) -> [f64; MOST] {
    std::array::from_fn(|i| columns.get(i).map_or(0.0, |column| column[row]))
}
