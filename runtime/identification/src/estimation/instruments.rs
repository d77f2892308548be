//! Motions that noise of the measurement is not in: instruments for the regressor.
//!
//! A controller acts on measured positions, so their noise is in the regressor and in the forces, and least squares
//! takes it for dynamics. The columns of W at a motion that has the same course and other noise, or none, are
//! instruments: correlated with the true columns, and not with the noise (Janot, Vandanjon, Gautier 2014). Two motions
//! are honest without knowledge of the controller: the commanded one where the log has it, and another repeat of
//! the same motion, in another run or in another period. Encoders that round a repeat to the very same steps
//! would make it no instrument; repeats of real robots differ by more than that.

use super::super::run::PreparedRun;
use std::fmt;

/// Largest squared difference between two repeats, as a share of the variance of each joint's velocity.
const ALIKE: f64 = 0.1;
/// Least correlation of each joint's velocity with the commanded one: columns with other things have less.
const FOLLOWED: f64 = 0.3;
/// Squared difference, as a share of a joint's velocity, below which the commanded motion copies the measured one.
const COPIED: f64 = 1e-12;
/// Share of a run that its repeat has to cover.
const COVERED: f64 = 0.5;
/// Samples by which repeats are compared and periods are looked for.
const COMPARED: usize = 400;
/// Samples by which a period is at least longer than the noise's correlation, in correlation times.
const APART: f64 = 10.0;

/// Where instruments come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstrumentSource {
    /// The commanded motion.
    Commanded,
    /// Other runs with the same motion, or other periods of it.
    Repeats,
}

impl fmt::Display for InstrumentSource {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Commanded => "the commanded motion",
            Self::Repeats => "repeats of the same motion",
        })
    }
}

/// The runs with the instruments' motion in place of the measured one.
pub(super) struct Instruments {
    pub(super) source: InstrumentSource,
    pub(super) runs: Vec<PreparedRun>,
    /// Whether each sample has an instrument.
    pub(super) known: Vec<Vec<bool>>,
}

impl Instruments {
    /// The best instruments that the runs offer. At least half of all samples have one.
    pub(super) fn find(runs: &[PreparedRun], moves: &[bool], correlation_time: f64) -> Option<Self> {
        // Poses of commanded or repeated motions would have to be replaced too, and no log has the former.
        if runs.iter().any(|run| !run.poses.is_empty()) {
            return None;
        }
        Self::commanded(runs, moves).or_else(|| Self::repeated(runs, moves, correlation_time))
    }

    fn commanded(runs: &[PreparedRun], moves: &[bool]) -> Option<Self> {
        let replaced = |run: &PreparedRun| {
            let desired = run.desired.clone()?;
            Some(PreparedRun {
                positions: desired.positions,
                velocities: desired.velocities,
                accelerations: desired.accelerations,
                ..run.clone()
            })
        };
        let replaced: Option<Vec<PreparedRun>> = runs.iter().map(replaced).collect();
        let replaced = replaced.filter(|replaced| serves(runs, replaced, moves))?;
        let known = runs.iter().map(|run| vec![true; run.times.len()]).collect();
        Some(Self { source: InstrumentSource::Commanded, runs: replaced, known })
    }

    fn repeated(runs: &[PreparedRun], moves: &[bool], correlation_time: f64) -> Option<Self> {
        let twins: Vec<Option<Twin>> =
            (0..runs.len()).map(|run| twin(runs, run, moves, correlation_time)).collect();
        let taken: Vec<(PreparedRun, Vec<bool>)> =
            runs.iter().zip(&twins).map(|(run, twin)| repeat(runs, run, twin.as_ref())).collect();
        let (with, all) = taken.iter().fold((0, 0), |(with, all), (_, known)| {
            (with + known.iter().filter(|k| **k).count(), all + known.len())
        });
        let (runs, known) = taken.into_iter().unzip();
        (with as f64 >= COVERED * all as f64).then_some(Self {
            source: InstrumentSource::Repeats,
            runs,
            known,
        })
    }
}

/// Whether the robot followed a commanded motion, and the columns are no copy of what was measured.
fn serves(runs: &[PreparedRun], commanded: &[PreparedRun], moves: &[bool]) -> bool {
    let moving = || moves.iter().enumerate().filter(|(_, moves)| **moves).map(|(joint, _)| joint);
    let sum = |joint: usize, of: &dyn Fn(f64, f64) -> f64| -> f64 {
        let pairs = runs.iter().zip(commanded);
        let pairs = pairs.flat_map(|(a, b)| a.velocities[joint].iter().zip(&b.velocities[joint]));
        pairs.map(|(a, b)| of(*a, *b)).sum()
    };
    let follows = |joint: usize| {
        let size = (sum(joint, &|a, _| a * a) * sum(joint, &|_, b| b * b)).sqrt();
        sum(joint, &|a, b| a * b) >= FOLLOWED * size && size > 0.0
    };
    let is_own = |joint: usize| sum(joint, &|a, b| (a - b).powi(2)) > COPIED * sum(joint, &|a, _| a * a);
    moving().all(follows) && moving().any(is_own)
}

/// Another run, or the same run later.
struct Twin {
    run: usize,
    lag: usize,
}

/// The next run with the same motion, or the period of the run itself.
fn twin(runs: &[PreparedRun], own: usize, moves: &[bool], correlation_time: f64) -> Option<Twin> {
    let others = (1..runs.len()).map(|k| (own + k) % runs.len());
    let mut others = others.filter(|other| is_alike(&runs[own], &runs[*other], 0, moves));
    others.next().map(|run| Twin { run, lag: 0 }).or_else(|| {
        let lag = period(&runs[own], moves, correlation_time)?;
        Some(Twin { run: own, lag })
    })
}

/// The motion of a run's twin, and where it is known. At the end of a run the period before serves.
fn repeat(runs: &[PreparedRun], run: &PreparedRun, twin: Option<&Twin>) -> (PreparedRun, Vec<bool>) {
    let count = run.times.len();
    let place = |i: usize| -> Option<usize> {
        let Twin { run, lag } = twin?;
        let later = i + lag;
        let place = if later < runs[*run].times.len() { later } else { i.checked_sub(*lag)? };
        (place < runs[*run].times.len()).then_some(place)
    };
    let places: Vec<Option<usize>> = (0..count).map(place).collect();
    let from = twin.map_or(run, |twin| &runs[twin.run]);
    let moved = |columns: &[Vec<f64>], own: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let column = |(column, own): (&Vec<f64>, &Vec<f64>)| {
            places.iter().zip(own).map(|(place, own)| place.map_or(*own, |k| column[k])).collect()
        };
        columns.iter().zip(own).map(column).collect()
    };
    let repeated = PreparedRun {
        positions: moved(&from.positions, &run.positions),
        velocities: moved(&from.velocities, &run.velocities),
        accelerations: moved(&from.accelerations, &run.accelerations),
        ..run.clone()
    };
    (repeated, places.iter().map(Option::is_some).collect())
}

/// Whether a run's velocities follow another's, `lag` samples later.
fn is_alike(one: &PreparedRun, other: &PreparedRun, lag: usize, moves: &[bool]) -> bool {
    let common = one.times.len().min(other.times.len().saturating_sub(lag));
    if (common as f64) < COVERED * one.times.len() as f64 {
        return false;
    }
    let stride = common.div_ceil(COMPARED).max(1);
    let joint = |j: usize| {
        let (mut difference, mut all) = (0.0, 0.0);
        for i in (0..common).step_by(stride) {
            let (a, b) = (one.velocities[j][i], other.velocities[j][i + lag]);
            difference += (a - b).powi(2);
            all += a * a;
        }
        difference <= ALIKE * all
    };
    moves.iter().enumerate().filter(|(_, moves)| **moves).all(|(j, _)| joint(j))
}

/// The shortest lag after which a run's velocities come again, well after the noise is forgotten.
fn period(run: &PreparedRun, moves: &[bool], correlation_time: f64) -> Option<usize> {
    let count = run.times.len();
    let shortest = (APART * correlation_time).ceil() as usize;
    let stride = count.div_ceil(4 * COMPARED).max(1);
    let mut lags = (shortest..count / 2).step_by(stride);
    // Slow motions are like themselves a moment later; that is no repeat.
    lags.find(|lag| !is_alike(run, run, *lag, moves))?;
    let first = lags.find(|lag| is_alike(run, run, *lag, moves))?;
    // The first lag that passes stands at the foot of the valley.
    let difference = |lag: usize| -> f64 {
        let pairs =
            |v: &Vec<f64>| (0..count - lag).step_by(stride).map(|i| (v[i] - v[i + lag]).powi(2)).sum();
        let sums: Vec<f64> = run.velocities.iter().map(pairs).collect();
        sums.iter().sum::<f64>() / (count - lag) as f64
    };
    (first..(first + first / 4 + 2).min(count / 2 + 1))
        .min_by(|a, b| difference(*a).total_cmp(&difference(*b)))
}
