//! Sequence of the preparation: channels, noise, bandwidth from the positions, delay, and finally the bandwidth that the
//! efforts confirm.

use super::super::error::{IdentificationError, Result};
use super::super::methods::filter::{Band, Filter};
use super::super::numeric::statistics::{extremes, largest, median};
use super::super::pose::rows_of;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun, Run};
use super::bandwidth::{PositionQuality, from_positions, speed_noise};
use super::channel::Channel;
use super::check::{check, effort_fault};
use super::delay::{DelayEstimate, Delays, estimate};
use super::grid::{Piece, interpolate, pieces};
use super::levels;
use super::regression::Columns;
use super::rest::Speeds;
use super::result::{Delay, PreparationReport};
use super::settings::PreparationSettings;
use super::signals::{Signals, Smoothed, Smoothing, smooth};
use super::spectrum::Spectrum;
use gelenk_findings::Finding;

/// Runs as signals, with the properties that are known before the choice of a bandwidth.
pub(super) struct Recorded<'a> {
    pub(super) signals: Vec<Signals>,
    pub(super) robot: Option<&'a dyn Robot>,
    pub(super) settings: &'a PreparationSettings,
    pub(super) quality: Vec<PositionQuality>,
    pub(super) faults: Vec<Option<Finding>>,
    pub(super) step: f64,
}

/// Prepares runs as [`super::prepare_all`] does, also with the filter of other runs.
///
/// - `known`: filter of the identification, if these runs are prepared for a validation. The low-pass filter of its efforts
///   is used, and no other one is searched.
pub(super) fn prepare_all(
    runs: &[Run],
    robot: Option<&dyn Robot>,
    settings: &PreparationSettings,
    known: Option<&Filter>,
) -> Result<(Vec<PreparedRun>, PreparationReport)> {
    check(runs, robot, settings)?;
    let mut recorded = Recorded::new(runs, robot, settings)?;
    let widest = recorded.widest()?;
    recorded.find_rests(widest)?;
    let first = recorded.delays_at(widest, None)?;
    let bandwidth = match (settings.bandwidth, robot) {
        (None, Some(robot)) => {
            recorded.confirmed(robot, widest, &removed(settings, &first, recorded.efforts()))?
        }
        _ => widest,
    };
    let mut found = if bandwidth == widest { first } else { recorded.delays_at(bandwidth, None)? };
    let mut delays = removed(settings, &found, recorded.efforts());
    let band = match (known, settings.bandwidth, robot) {
        (Some(filter), ..) => filter.band(),
        (None, None, Some(robot)) => recorded.band(robot, bandwidth, &delays)?,
        _ => None,
    };
    if band.is_some() {
        found = recorded.delays_at(bandwidth, band)?;
        delays = removed(settings, &found, recorded.efforts());
    }
    let how = recorded.smoothing(bandwidth, band, delays.iter().map(|d| d.removed).collect());
    let smoothed = recorded.smooth(&how, bandwidth)?;
    if smoothed.is_empty() {
        return Err(recorded.too_short(&how));
    }
    let report = recorded.report(&how, delays, &smoothed)?;
    Ok((smoothed.into_iter().map(|s| s.run).collect(), report))
}

impl<'a> Recorded<'a> {
    fn new(runs: &[Run], robot: Option<&'a dyn Robot>, settings: &'a PreparationSettings) -> Result<Self> {
        let mut signals: Vec<Signals> = runs.iter().map(|run| Signals::new(run, robot)).collect();
        if settings.total_variation {
            signals.iter_mut().try_for_each(Signals::regularize)?;
        }
        let step = median(signals.iter().map(|s| s.step).filter(|h| *h > 0.0)).unwrap_or(1.0);
        let mut recorded = Self { signals, robot, settings, quality: Vec::new(), faults: Vec::new(), step };
        let quaternions = robot.map(Robot::quaternion_joints).unwrap_or_default();
        let exact = rows_of(&quaternions, recorded.joints());
        let is_exact = |m: usize| runs[0].effort == Effort::Joint && exact[m];
        recorded.faults = (0..recorded.efforts()).map(|m| effort_fault(runs, m, is_exact(m))).collect();
        recorded.quality = (0..recorded.joints()).map(|j| recorded.quality_of(j)).collect();
        Ok(recorded)
    }

    pub(super) fn joints(&self) -> usize {
        self.signals[0].positions.len()
    }

    pub(super) fn efforts(&self) -> usize {
        self.signals[0].efforts.len()
    }

    /// Returns the pieces of a run between its gaps. A lower `bandwidth` (in Hz) allows longer pauses within a piece.
    pub(super) fn pieces(&self, signals: &Signals, bandwidth: f64) -> Vec<Piece> {
        let by_itself =
            (levels::SHORT_PAUSE.get() * signals.step).max(levels::SHORT_PERIOD.get() / bandwidth);
        let efforts = signals.efforts.iter().zip(&self.faults).filter(|(_, f)| f.is_none()).map(|(c, _)| c);
        let channels: Vec<&Channel> = signals.positions.iter().chain(efforts).collect();
        pieces(&channels, self.settings.largest_gap.unwrap_or(by_itself))
    }

    fn quality_of(&self, joint: usize) -> PositionQuality {
        let mut spectrum = Spectrum::new();
        let (mut rounding, mut noise_band, mut range) = (0.0_f64, f64::INFINITY, 0.0_f64);
        for signals in &self.signals {
            let channel = &signals.positions[joint];
            let step = signals.step.max(1e-9);
            for piece in self.pieces(signals, levels::USUAL_BANDWIDTH.get()) {
                spectrum.add(&interpolate(channel, &piece.grid(step)), step);
            }
            let half_rate = 0.5 / channel.step().max(step);
            noise_band = noise_band.min(half_rate);
            // If a rounding error changes seldom, its power is at low frequencies.
            let band = half_rate.min(channel.change_rate().max(1e-3));
            rounding = rounding.max(channel.resolution.powi(2) / 12.0 / band);
            let [low, high] = extremes(channel.values.iter().copied());
            range = range.max(high - low);
        }
        let density = spectrum.floor(0.7 * noise_band).max(rounding);
        let noise = (density * noise_band).sqrt();
        PositionQuality { spectrum, density, noise, moves: range > 10.0 * noise }
    }

    /// Returns the lowest bandwidth in Hz for which enough of the pieces remains after their ends are cut off. If rests are
    /// known, only the motion of each joint counts.
    ///
    /// - `split`: bandwidth in Hz that decides how runs are split into pieces
    pub(super) fn lowest(&self, split: f64) -> f64 {
        let motion = |s: &Signals| -> Vec<f64> {
            self.pieces(s, split)
                .into_iter()
                .flat_map(|piece| s.rests.between([piece.start, piece.end]))
                .collect()
        };
        let durations: Vec<f64> = self.signals.iter().flat_map(motion).collect();
        let all: f64 = durations.iter().sum();
        let left = |f: f64| durations.iter().map(|d| (d - 2.0 / f).max(0.0)).sum::<f64>();
        let mut bandwidth = 0.1;
        while bandwidth < 1e4 && left(bandwidth) < levels::KEPT.get() * all {
            bandwidth *= 1.1;
        }
        bandwidth
    }

    /// Returns the highest bandwidth in Hz that the sample rate of the slowest channel allows.
    pub(super) fn highest(&self) -> f64 {
        let slowest = |channels: fn(&Signals) -> &Vec<Channel>| {
            self.signals.iter().flat_map(channels).map(Channel::step).fold(self.step, f64::max)
        };
        let [positions, efforts] = [slowest(|s| &s.positions), slowest(|s| &s.efforts)];
        (levels::HIGHEST_BANDWIDTH.get() / positions).min(0.5 / efforts)
    }

    /// Returns the bandwidth of the settings, or else the bandwidth that follows from the positions alone, in Hz.
    fn widest(&self) -> Result<f64> {
        if let Some(given) = self.settings.bandwidth {
            Filter::new(given, self.output_step(given))?;
            return Ok(given);
        }
        let joints: Vec<&PositionQuality> = self.quality.iter().collect();
        let (lowest, highest) = (self.lowest(levels::USUAL_BANDWIDTH.get()), self.highest());
        from_positions(&joints, lowest.min(highest), highest).ok_or_else(|| {
            let samples = self.signals.iter().map(|s| s.times.len()).sum();
            let what = "each joint's position (apart from its noise)".to_string();
            IdentificationError::Constant { what, value: self.signals[0].positions[0].values[0], samples }
        })
    }

    /// Finds the rests of the joints from speeds that passed a filter of `bandwidth` in Hz. Joints with a quaternion have
    /// no rests.
    fn find_rests(&mut self, bandwidth: f64) -> Result<()> {
        let how = self.smoothing(bandwidth, None, vec![0.0; self.efforts()]);
        let mut pieces = Vec::new();
        for (run, signals) in self.signals.iter().enumerate() {
            for piece in self.pieces(signals, bandwidth) {
                pieces.extend(smooth(signals, &piece, &how)?.map(|smoothed| (run, smoothed.run)));
            }
        }
        let largest = |joint: usize| largest(pieces.iter().flat_map(|(_, piece)| &piece.velocities[joint]));
        let quaternions = self.robot.map(Robot::quaternion_joints).unwrap_or_default();
        let exact = rows_of(&quaternions, self.joints());
        let speeds = |(joint, quality): (usize, &PositionQuality)| {
            let noise = speed_noise(quality.density, bandwidth);
            let largest = if quality.moves { largest(joint) } else { f64::INFINITY };
            (!exact[joint]).then_some(Speeds { largest, noise })
        };
        let speeds: Vec<Option<Speeds>> = self.quality.iter().enumerate().map(speeds).collect();
        for (run, piece) in &pieces {
            self.signals[*run].rests.add(piece, &speeds, bandwidth, how.cut);
        }
        Ok(())
    }

    pub(super) fn output_step(&self, bandwidth: f64) -> f64 {
        let rate = self.settings.rate.unwrap_or(levels::OVERSAMPLING.get() * bandwidth);
        self.step * (1.0 / (self.step * rate)).floor().max(1.0)
    }

    pub(super) fn smoothing(&self, bandwidth: f64, band: Option<Band>, delays: Vec<f64>) -> Smoothing {
        // One octave above the low-pass filter of the efforts, little of the efforts remains.
        let bandwidth = band.map_or(bandwidth, |band| bandwidth.min(2.0 * band.frequency));
        Smoothing {
            bandwidth,
            lowest: bandwidth,
            step: self.output_step(bandwidth),
            cut: self.settings.cut.unwrap_or(1.0 / bandwidth),
            delays,
            faulty: self.faults.iter().map(Option::is_some).collect(),
            band,
        }
    }

    /// Smooths all pieces of the runs.
    ///
    /// - `split`: bandwidth in Hz that decides how runs are split into pieces
    pub(super) fn smooth(&self, how: &Smoothing, split: f64) -> Result<Vec<Smoothed>> {
        let mut all = Vec::new();
        for signals in &self.signals {
            for piece in self.pieces(signals, split) {
                all.extend(smooth(signals, &piece, how)?);
            }
        }
        Ok(all)
    }

    /// Returns the columns of the regression that explains the efforts of `runs`.
    pub(super) fn columns(
        &self,
        robot: &'a dyn Robot,
        runs: &[&PreparedRun],
        filter: Option<Filter>,
        roundings: &[f64],
    ) -> Columns<'a> {
        Columns::new(robot, runs, filter, self.settings.gravity_compensated, roundings)
    }

    fn delays_at(&self, bandwidth: f64, band: Option<Band>) -> Result<Option<Delays>> {
        let (None, Some(robot)) = (self.settings.delay, self.robot) else { return Ok(None) };
        let how = self.smoothing(bandwidth, band, vec![0.0; self.efforts()]);
        let smoothed = self.smooth(&how, bandwidth)?;
        let runs: Vec<&PreparedRun> = smoothed.iter().map(|s| &s.run).collect();
        let columns = self.columns(robot, &runs, Some(how.filter()?), &[levels::SHARP.get()]);
        Ok(estimate(&columns, &runs, how.step))
    }
}

/// Returns the delay that is removed from each effort. It is the given delay, or an estimated one that is too large for the
/// linear correction in the common estimate.
fn removed(settings: &PreparationSettings, found: &Option<Delays>, efforts: usize) -> Vec<Delay> {
    let none = Delay { removed: settings.delay.unwrap_or(0.0), error: f64::NAN, own: false };
    let Some(found) = found else { return vec![none; efforts] };
    let of_effort = |own: &DelayEstimate| {
        let differs = own.drop > levels::DROP.get();
        let removed = if differs { own.if_far() } else { found.common.if_far() };
        Delay { removed, error: own.error, own: differs }
    };
    found.own.iter().map(of_effort).collect()
}
