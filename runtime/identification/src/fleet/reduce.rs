//! Reduction of a log to moments (sums of products of its samples).

use super::super::error::{IdentificationError, Result};
use super::super::estimation::{
    Columns, Estimate, Gravity, RunPiece, ShareSums, Weighted, correlation_time, estimate, huber,
    robust_deviation,
};
use super::super::identify::{
    IdentificationSettings, beyond_limits, faults, left_of_delays, of_signals, read_and_prepare,
};
use super::super::methods::moments::contiguous_blocks;
use super::super::numeric::statistics::extremes;
use super::super::preparation::PreparationReport;
use super::super::robot::{Robot, require_no_driven};
use super::super::run::{Effort, PreparedRun};
use super::super::shafts::RobotRows;
use super::exact::Exact;
use super::file::hash_of;
use super::levels;
use super::logs::{
    About, Doubt, DoubtedLog, Hash, JointFacts, LogMoments, ReducedLog, SHARES, Share, add_share,
};
use gelenk_findings::{Finding, Severity};
use std::path::Path;

/// Fails if an effort of a robot without quaternions is missing, because the log then has wrong columns. Robots with
/// quaternions may lack efforts, because the rows of the base can be fitted alone.
fn require_all_efforts(robot: &dyn Robot, preparation: &PreparationReport) -> Result<()> {
    match faults(preparation).next().filter(|_| robot.quaternion_joints().is_empty()) {
        None => Ok(()),
        Some(fault) => Err(IdentificationError::Found { findings: vec![fault.clone()] }),
    }
}

/// Reduces one log to its moments (sums of products).
///
/// First the log is fitted alone, as [`super::super::identify::identify`] does. This fit gives the weights of outliers, the
/// correlation time of the residuals, and findings about the log. It is not an error if the fit explains little.
///
/// - `description`: source of the robot, for example the contents of its files and the options for reading them. Moments
///   contain the hash of this source and can be added only to moments with the same hash.
/// - `progress`: receives a sentence at each step, and the findings about the log
///
/// # Errors
/// The errors are those of [`super::super::identify::identify`]. [`IdentificationError::Overflow`] if numbers are too large
/// for SI units, and [`IdentificationError::File`] if a joint of the robot is moved from outside.
pub fn reduce(
    robot: &dyn Robot,
    description: &[&[u8]],
    log: &Path,
    settings: &IdentificationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<LogMoments> {
    let help = "identify from the logs themselves, all of them in one call";
    require_no_driven(robot, "logs cannot be reduced to a file of moments", help)?;
    let logs = [log.to_owned()];
    let mut noted = Vec::new();
    let read = read_and_prepare(robot, &logs, settings, &mut noted, progress);
    noted.iter().for_each(|finding| progress(&finding.to_string()));
    let (recording, runs, mut preparation) = read?;
    let beyond = beyond_limits(robot, &recording, &runs, settings.accept_poor)?;
    require_all_efforts(robot, &preparation)?;
    let rows = RobotRows::of(robot);
    let (robot, runs): (&dyn Robot, _) = (&rows, rows.along(runs));
    let mut alone = of_signals(settings, &preparation, rows.of_shafts().is_some());
    alone.accept_poor = true;
    let mut estimate = estimate(robot, &runs, &alone, &mut |_| ())?;
    preparation.refine(&left_of_delays(&estimate));
    let left: Vec<f64> = estimate.delays.iter().map(|delay| delay.value).collect();
    let runs: Vec<PreparedRun> = runs.into_iter().map(|run| run.without_delays(&left)).collect();
    estimate.findings.retain(is_warning);
    beyond.iter().chain(&estimate.findings).for_each(|warning| progress(&warning.to_string()));
    estimate.findings.splice(0..0, noted.into_iter().chain(beyond).filter(is_warning));
    let hash = recording.hashes.first().and_then(|(_, hash)| from_hexadecimal(hash));
    let fitted = Fitted::new(&runs, &estimate, settings.estimation.robust_passes > 0);
    let facts = fitted.facts(robot)?;
    let spans: Vec<f64> = facts.iter().map(|row| row.span).collect();
    let measured = estimate.joints.iter().map(|joint| joint.measured).collect();
    let columns = Columns::new(robot, recording.effort, &spans, measured)?;
    let reduced = ReducedLog {
        name: log.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        hash: hash.ok_or_else(|| IdentificationError::Empty { what: "the log's hash".into() })?,
        content: recording.content(),
        // The samples are counted as in the shares.
        samples: runs.iter().map(|run| run.count_moving(0..run.times.len()) as u64).sum(),
        seconds: runs.iter().map(|run| run.times.len() as f64).sum::<f64>() / preparation.sample_rate,
        bandwidth: preparation.filter.bandwidth(),
        delays: delays(&preparation),
        correlation: fitted.correlation,
    };
    let pieces = pieces(&runs, fitted.correlation);
    let weighted = Weighted { weights: &fitted.weights, residuals: &fitted.residuals };
    let gravity = Gravity::of(settings.estimation.gravity_compensated);
    let sums = columns.sums(robot, &runs, gravity, Some(&preparation.filter), &weighted, &pieces);
    Ok(LogMoments {
        about: about(description, settings, recording.effort, &columns),
        shares: shares(&sums, &reduced.hash)?,
        doubts: doubts(&estimate, &reduced),
        logs: vec![reduced],
        joints: facts,
    })
}

/// Properties that must be equal for moments to be added.
fn about(
    description: &[&[u8]],
    settings: &IdentificationSettings,
    effort: Effort,
    columns: &Columns,
) -> About {
    About {
        description: hash_of(description),
        effort,
        gravity_compensated: settings.estimation.gravity_compensated,
        bandwidth: settings.preparation.bandwidth,
        delay: settings.preparation.delay,
        widths: columns.widths(),
    }
}

fn delays(preparation: &PreparationReport) -> [f64; 2] {
    let ends = extremes(preparation.delays.iter().map(|delay| delay.removed));
    ends.map(|end| if end.is_finite() { end } else { 0.0 })
}

fn is_warning(finding: &Finding) -> bool {
    finding.severity == Severity::Warning
}

/// Doubts by joint and rule, ascending. A joint that does not move gives no doubt, because it may move in other logs.
fn doubts(estimate: &Estimate, log: &ReducedLog) -> Vec<Doubt> {
    let joints = &estimate.joints;
    let doubt = |finding: &Finding| {
        let name = finding.about.subject.name();
        let joint = joints.iter().position(|joint| Some(joint.name.as_str()) == name);
        let remedy = finding.remedy.as_ref().map_or_else(String::new, |remedy| format!(": {remedy}"));
        let text = format!("{}{remedy}", finding.sentence());
        Doubt {
            joint: joint.map(|joint| joint as u32),
            kind: finding.code.to_owned(),
            logs: 1,
            first: DoubtedLog { hash: log.hash, name: log.name.clone(), text },
        }
    };
    let moves = |doubt: &Doubt| doubt.joint.is_none_or(|joint| joints[joint as usize].moves);
    let mut doubts: Vec<Doubt> = estimate.findings.iter().map(doubt).filter(moves).collect();
    doubts.sort_by(|a, b| a.place().cmp(&b.place()));
    doubts.dedup_by(|a, b| a.place() == b.place());
    doubts
}

/// Results of the fit to a single log from which its moments are computed.
struct Fitted<'a> {
    runs: &'a [PreparedRun],
    estimate: &'a Estimate,
    /// Residuals `[run][joint][sample]` in units of the effort times the input matrix B.
    residuals: Vec<Vec<Vec<f64>>>,
    weights: Vec<Vec<Vec<f64>>>,
    correlation: f64,
}

impl<'a> Fitted<'a> {
    fn new(runs: &'a [PreparedRun], estimate: &'a Estimate, robust: bool) -> Self {
        let gain = |joint: usize| estimate.joints[joint].gain.map_or(1.0, |gain| gain.value);
        let residual = |(joint, (measured, predicted)): (usize, (&Vec<f64>, &Vec<f64>))| -> Vec<f64> {
            measured.iter().zip(predicted).map(|(m, p)| (m - p) / gain(joint)).collect()
        };
        let of_run = |(measured, predicted): (&Vec<Vec<f64>>, &Vec<Vec<f64>>)| -> Vec<Vec<f64>> {
            measured.iter().zip(predicted).enumerate().map(residual).collect()
        };
        let residuals: Vec<Vec<Vec<f64>>> =
            estimate.measured.iter().zip(&estimate.predicted).map(of_run).collect();
        let used = |joint: usize| -> Vec<&[f64]> {
            let moves = estimate.joints[joint].moves;
            let used = runs.iter().zip(&residuals).flat_map(|(run, residuals)| {
                run.stretches(joint, moves).into_iter().map(move |rows| &residuals[joint][rows])
            });
            used.collect()
        };
        let joints = estimate.joints.len();
        let deviation = |joint: usize| robust_deviation(used(joint).concat().iter().map(|r| r.abs()));
        let deviations: Vec<f64> =
            (0..joints).map(|joint| if robust { deviation(joint) } else { f64::INFINITY }).collect();
        let weigh = |(run, residuals): (&PreparedRun, &Vec<Vec<f64>>)| {
            let weights = |(joint, residuals): (usize, &Vec<f64>)| -> Vec<f64> {
                let of_joint = &estimate.joints[joint];
                let is_used = |i: usize| of_joint.measured && !(of_joint.moves && run.rests(joint, i));
                let weights = huber(residuals, deviations[joint]).into_iter().enumerate();
                weights.map(|(i, weight)| if is_used(i) { weight } else { 0.0 }).collect()
            };
            residuals.iter().enumerate().map(weights).collect()
        };
        let times = (0..joints).map(|joint| correlation_time(&used(joint)));
        let correlation = times.filter(|time| time.is_finite()).fold(1.0, f64::max);
        Self {
            weights: runs.iter().zip(&residuals).map(weigh).collect(),
            residuals,
            correlation,
            runs,
            estimate,
        }
    }

    fn facts(&self, robot: &dyn Robot) -> Result<Vec<JointFacts>> {
        let scales = robot.speed_scales();
        let fact = |joint: usize| -> Result<JointFacts> {
            let mut facts =
                JointFacts { span: 0.0, velocities: [f64::MAX, f64::MIN], directions: [Exact::default(); 4] };
            for run in self.runs {
                let [low, high] = extremes(run.positions[joint].iter().copied());
                let samples = run.stretches(joint, self.estimate.joints[joint].moves).into_iter().flatten();
                let v: Vec<f64> = samples.map(|i| run.velocities[joint][i]).collect();
                facts.add(&JointFacts {
                    span: high - low,
                    velocities: extremes(v.iter().copied()),
                    directions: directions(&v, scales[joint])?,
                })?;
            }
            Ok(facts)
        };
        (0..self.estimate.joints.len()).map(fact).collect()
    }
}

/// Σ v², Σ v |v|, Σ t², Σ t |t| with t = tanh 20 v, for speeds in units of `scale`.
fn directions(velocities: &[f64], scale: f64) -> Result<[Exact; 4]> {
    let mut sums = [0.0; 4];
    for v in velocities.iter().map(|v| v / scale) {
        let t = (20.0 * v).tanh();
        sums.iter_mut().zip([v * v, v * v.abs(), t * t, t * t.abs()]).for_each(|(sum, x)| *sum += x);
    }
    let [a, b, c, d] = sums.map(Exact::new);
    Ok([a?, b?, c?, d?])
}

/// Contiguous pieces of the runs. The number of pieces is about the number of shares. There are fewer pieces if they would be
/// too short, but at least one for each run.
fn pieces(runs: &[PreparedRun], correlation: f64) -> Vec<RunPiece> {
    let total: usize = runs.iter().map(|run| run.times.len()).sum();
    let length = (levels::PIECE.get() * correlation).max(total as f64 / SHARES as f64).max(1.0);
    let of_run = |(run, samples): (usize, &PreparedRun)| {
        let count = ((samples.times.len() as f64 / length).round() as usize).clamp(1, SHARES);
        let blocks = contiguous_blocks(samples.times.len(), count);
        blocks.filter(|rows| !rows.is_empty()).map(move |rows| RunPiece { run, rows }).collect::<Vec<_>>()
    };
    runs.iter().enumerate().flat_map(of_run).collect()
}

/// Assigns the pieces to the shares. The hash of the log determines the first share, so that short logs fill all shares.
/// Neighbouring pieces are in neighbouring shares.
fn shares(sums: &[ShareSums<f64>], hash: &Hash) -> Result<Vec<Share>> {
    let first = usize::from(hash[0]);
    let most = sums.len().max(SHARES);
    let mut shares = vec![Share::default(); SHARES];
    for (piece, sums) in sums.iter().enumerate() {
        let place = (first + piece * SHARES / most) % SHARES;
        add_share(&mut shares[place], sums.converted(Exact::new)?)?;
    }
    Ok(shares)
}

fn from_hexadecimal(text: &str) -> Option<Hash> {
    let byte = |i: usize| u8::from_str_radix(text.get(2 * i..2 * i + 2)?, 16).ok();
    (0..text.len().div_ceil(2)).map(byte).collect::<Option<Vec<u8>>>()?.try_into().ok()
}
