//! A run as channels of informative samples, and the smoothing of its pieces.

use super::super::error::Result;
use super::super::methods::differentiation::TotalVariation;
use super::super::methods::filter::{Band, Filter, convolved, kernel, weighted};
use super::super::pose::plain_positions;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun, Run};
use super::channel::{Channel, median_step, nearest};
use super::grid::{Piece, interpolate};
use super::poses::PoseSignal;
use super::rest::Rests;

/// Measured signals of a run, each reduced to its informative samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Signals {
    pub name: String,
    pub times: Vec<f64>,
    pub rows: Vec<usize>,
    pub positions: Vec<Channel>,
    /// Poses of the joints with a quaternion.
    poses: Vec<PoseSignal>,
    /// Index of the entry of the positions y for each velocity; `None` for joints with a quaternion.
    plain: Vec<Option<usize>>,
    pub efforts: Vec<Channel>,
    pub effort: Effort,
    /// Time intervals in which each joint rests.
    pub rests: Rests,
    /// Median time step of the log in s.
    pub step: f64,
}

impl Signals {
    /// Creates the channels of a run with increasing times.
    pub(crate) fn new(run: &Run, robot: Option<&dyn Robot>) -> Self {
        let channel = |values: &Vec<f64>, is_position| Channel::new(&run.times, values, is_position);
        let quaternions = robot.map(Robot::quaternion_joints).unwrap_or_default();
        let joints = run.positions.len();
        let positions: Vec<Channel> = run.positions.iter().map(|q| channel(q, true)).collect();
        let poses =
            quaternions.iter().map(|joint| PoseSignal::new(joint, run, &positions[joint.velocities()]));
        Self {
            name: run.name.clone(),
            times: run.times.clone(),
            rows: run.rows.clone(),
            poses: poses.collect(),
            plain: plain_positions(&quaternions, joints),
            positions,
            efforts: run.efforts.iter().map(|u| channel(u, false)).collect(),
            effort: run.effort,
            rests: Rests::default(),
            step: median_step(&run.times),
        }
    }

    /// Regularizes positions, and paths of joints with a quaternion, by their total variation at the level of their noise.
    pub(crate) fn regularize(&mut self) -> Result<()> {
        for channel in &mut self.positions {
            let noise = channel.noise();
            if noise > 0.0 {
                let method = TotalVariation::from_noise(noise);
                channel.values = method.differentiate(&channel.times, &channel.values)?.value;
            }
        }
        Ok(())
    }

    /// Returns the columns of the robot's positions y at `times`, computed from the smoothed `positions` of
    /// its joints; empty if no joint has a quaternion.
    fn coordinates(&self, times: &[f64], positions: &[Vec<f64>]) -> Vec<Vec<f64>> {
        if self.poses.is_empty() {
            return Vec::new();
        }
        let mut y = vec![vec![f64::NAN; times.len()]; positions.len() + self.poses.len()];
        for (column, entry) in positions.iter().zip(&self.plain) {
            if let Some(entry) = entry {
                y[*entry].clone_from(column);
            }
        }
        self.poses.iter().for_each(|poses| poses.write(times, positions, &mut y));
        y
    }

    /// Returns the row of the log that is nearest to a time.
    pub(crate) fn row(&self, time: f64) -> usize {
        self.rows[nearest(&self.times, time)]
    }
}

/// Settings for the smoothing of a piece.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smoothing {
    /// Half-amplitude frequency of the filter in Hz.
    pub bandwidth: f64,
    /// Half-amplitude frequency in Hz of the filter that decides how far rests are extended.
    pub lowest: f64,
    /// Time between the smoothed samples in s.
    pub step: f64,
    /// Time in s that is cut off at each end of a piece.
    pub cut: f64,
    /// Delay of each effort in s.
    pub delays: Vec<f64>,
    /// Whether each effort is unusable. The columns of an unusable effort contain NaN.
    pub faulty: Vec<bool>,
    /// Low-pass filter that the efforts passed before they were recorded. All other signals pass this filter here. `None`
    /// if the efforts were not filtered.
    pub band: Option<Band>,
}

impl Smoothing {
    /// Returns the filter of all signals.
    pub(super) fn filter(&self) -> Result<Filter> {
        Ok(Filter::new(self.bandwidth, self.step)?.behind(self.band))
    }
}

/// A smoothed piece, and its unfiltered efforts without their delay at the same times.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smoothed {
    pub run: PreparedRun,
    pub measured: Vec<Vec<f64>>,
}

/// Smallest number of samples of a smoothed piece. Derivatives need a neighbour on each side.
const FEWEST: usize = 3;

/// Selection of every `ratio`-th sample of a grid with equal time steps.
struct Sampler {
    grid: Vec<f64>,
    step: f64,
    ratio: usize,
    first: usize,
    count: usize,
}

/// Smooths a piece of a run. Returns `None` if too few samples remain between the ends that are cut off.
pub(super) fn smooth(signals: &Signals, piece: &Piece, how: &Smoothing) -> Result<Option<Smoothed>> {
    let Some(sampler) = Sampler::new(signals.step, piece, how) else { return Ok(None) };
    let times: Vec<f64> = sampler.centres().map(|c| sampler.grid[c as usize]).collect();
    let band = how.band.map(|band| band.taps(sampler.step));
    let through = |channel: &Channel, order: usize, shift: f64| -> Result<Vec<f64>> {
        let taps = kernel(how.bandwidth, sampler.step, order, shift)?;
        let taps = band.as_ref().map_or_else(|| taps.clone(), |band| convolved(&taps, band));
        Ok(weighted(&interpolate(channel, &sampler.grid), &taps, sampler.centres()))
    };
    let all =
        |order: usize| signals.positions.iter().map(|c| through(c, order, 0.0)).collect::<Result<Vec<_>>>();
    let (mut efforts, mut measured) = (Vec::new(), Vec::new());
    for (m, channel) in signals.efforts.iter().enumerate() {
        if how.faulty[m] {
            efforts.push(vec![f64::NAN; times.len()]);
            measured.push(vec![f64::NAN; times.len()]);
            continue;
        }
        efforts.push(sampler.delayed(channel, how, m)?);
        let late: Vec<f64> = times.iter().map(|t| t + how.delays[m]).collect();
        measured.push(interpolate(channel, &late));
    }
    let positions = all(0)?;
    let run = PreparedRun {
        poses: signals.coordinates(&times, &positions),
        name: signals.name.clone(),
        rows: times.iter().map(|t| signals.row(*t)).collect(),
        positions,
        velocities: all(1)?,
        accelerations: all(2)?,
        efforts,
        resting: signals.rests.at(&times, how.lowest),
        effort: signals.effort,
        times,
    };
    Ok(Some(Smoothed { run, measured }))
}

/// Returns whether too few samples of a piece remain between the ends that are cut off.
pub(super) fn is_too_short(signals: &Signals, piece: &Piece, how: &Smoothing) -> bool {
    Sampler::new(signals.step, piece, how).is_none()
}

impl Sampler {
    fn new(log_step: f64, piece: &Piece, how: &Smoothing) -> Option<Self> {
        let ratio = (how.step / log_step).round().max(1.0) as usize;
        let step = how.step / ratio as f64;
        let grid = piece.grid(step);
        // The filter windows of positions and efforts must lie within the piece.
        let early = how.delays.iter().fold(0.0_f64, |a, d| a.min(*d));
        let late = how.delays.iter().fold(0.0_f64, |a, d| a.max(*d));
        let first = ((how.cut - early) / step).ceil() as usize;
        let last = grid.len().checked_sub(1 + ((how.cut + late) / step).ceil() as usize)?;
        let count = last.checked_sub(first)? / ratio + 1;
        (count >= FEWEST).then_some(Self { grid, step, ratio, first, count })
    }

    fn centres(&self) -> impl Iterator<Item = isize> + Clone + '_ {
        (0..self.count).map(|i| (self.first + i * self.ratio) as isize)
    }

    /// Returns effort `m` without its delay. The index is shifted by the whole time steps of the delay, and the kernel is
    /// shifted by the rest.
    fn delayed(&self, channel: &Channel, how: &Smoothing, m: usize) -> Result<Vec<f64>> {
        let steps = (how.delays[m] / self.step).round();
        let taps = kernel(how.bandwidth, self.step, 0, how.delays[m] - steps * self.step)?;
        let signal = interpolate(channel, &self.grid);
        Ok(weighted(&signal, &taps, self.centres().map(|centre| centre + steps as isize)))
    }
}
