//! Findings in a log: suspicious times, missing values, wraps, units.

use super::super::digits::plain;
use super::super::statistics::median;
use super::schema::Quantity;
use super::{Channel, Log};
use std::fmt;
use std::ops::Range;

/// Kind of a [`Finding`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FindingKind {
    /// A field is absent.
    Missing,
    /// A field is no number.
    NotANumber,
    /// A value is NaN or infinite.
    NotFinite,
    /// A channel has no finite value.
    NoValues,
    /// A channel never changes.
    Constant,
    /// Time decreases.
    Unsorted,
    /// A time stands twice.
    Repeated,
    /// A step in time is longer than 1.5 times the median.
    Gap,
    /// Steps in time vary.
    Jitter,
    /// A jump like that of an overflowing counter.
    Wrap,
    /// A jump by the ratio of two units, or a position and a velocity that differ by one.
    MixedUnits,
    /// Rows or runs that are not used.
    LeftOut,
    /// Time goes back, a new run begins.
    NewRun,
    /// A unit that nobody names was taken for granted.
    UnitAssumed,
    /// A joint does not move.
    StoodStill,
    /// A single sample far from its neighbours.
    Outlier,
    /// Positions beyond the joint's limits.
    BeyondPosition,
    /// Speeds beyond the joint's limit.
    BeyondSpeed,
    /// Efforts beyond the joint's limit.
    BeyondEffort,
    /// Efforts that look as if they were on the other side of the gears.
    GearDoubtful,
    /// A column of velocities that is not the slope of the positions.
    VelocityDisagrees,
    /// Samples that repeat the values of the ones before.
    Stuck,
    /// Efforts that stand at their largest or smallest value.
    CutOff,
    /// Quaternions that are not quite of unit length.
    NotUnit,
}

/// Something suspicious, with the rows where it is (counted from 0, header not counted).
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// First row.
    pub first: usize,
    /// Last row.
    pub last: usize,
    /// Name of the channel; none for the whole row.
    pub channel: Option<String>,
    /// Kind.
    pub kind: FindingKind,
    /// Numbers, in words.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.first == self.last {
            write!(f, "row {}", self.first)?;
        } else {
            write!(f, "rows {} to {}", self.first, self.last)?;
        }
        if let Some(channel) = &self.channel {
            write!(f, ", channel {channel}")?;
        }
        write!(f, ": {}", self.message)
    }
}

/// Collects findings; consecutive rows of the same channel and kind become one.
#[derive(Debug, Default)]
pub(super) struct Findings {
    all: Vec<Finding>,
    /// Latest finding of each channel and kind, to be extended.
    open: Vec<usize>,
}

impl Findings {
    pub(super) fn add(
        &mut self,
        row: usize,
        channel: Option<&str>,
        kind: FindingKind,
        message: impl FnOnce() -> String,
    ) {
        let same = |f: &Finding| f.kind == kind && f.channel.as_deref() == channel;
        if let Some(slot) = self.open.iter().position(|&i| same(&self.all[i])) {
            let latest = &mut self.all[self.open[slot]];
            if row <= latest.last + 1 {
                latest.last = latest.last.max(row);
                return;
            }
            self.open.swap_remove(slot);
        }
        self.open.push(self.all.len());
        let channel = channel.map(String::from);
        self.all.push(Finding { first: row, last: row, channel, kind, message: message() });
    }

    /// The rows of a channel that have a finding.
    fn rows_of(&self, channel: &Channel) -> Vec<bool> {
        let mut rows = vec![false; channel.values.len()];
        let name = Some(channel.name.as_str());
        for finding in self.all.iter().filter(|f| f.channel.as_deref() == name) {
            if let Some(found) = rows.get_mut(finding.first..=finding.last) {
                found.fill(true);
            }
        }
        rows
    }

    fn finish(self) -> Vec<Finding> {
        self.all
    }
}

/// Checks times and values of a log.
pub fn check(log: &Log) -> Vec<Finding> {
    check_after(log, Findings::default())
}

/// As [`check`]; what reading the log has `found` comes first and is not said again.
pub(super) fn check_after(log: &Log, found: Findings) -> Vec<Finding> {
    let unread: Vec<Vec<bool>> = log.channels().iter().map(|c| found.rows_of(c)).collect();
    let mut findings = Findings { all: found.all, open: Vec::new() };
    let time = log.channels().iter().find(|c| c.quantity == Quantity::Time);
    if let Some(time) = time {
        check_times(time, log.segments(), &mut findings);
    }
    for (channel, unread) in log.channels().iter().zip(&unread) {
        check_values(channel, unread, &mut findings);
        let continuous =
            matches!(channel.quantity, Quantity::Position | Quantity::Velocity | Quantity::Torque);
        if continuous {
            log.segments().iter().for_each(|rows| check_jumps(channel, rows.clone(), &mut findings));
        }
    }
    if let Some(time) = time {
        check_rates(log, time, &mut findings);
    }
    findings.finish()
}

fn check_times(time: &Channel, segments: &[Range<usize>], findings: &mut Findings) {
    let t = &time.values;
    let steps = |rows: &Range<usize>| rows.clone().skip(1).map(|i| (i, t[i] - t[i - 1])).collect::<Vec<_>>();
    let mut all: Vec<(usize, f64)> = segments.iter().flat_map(steps).filter(|(_, d)| d.is_finite()).collect();
    let Some(median) = median(all.iter().map(|s| s.1).filter(|d| *d > 0.0)) else {
        return;
    };
    let name = Some(time.name.as_str());
    for &(row, step) in &all {
        let (before, after) = (t[row - 1], t[row]);
        if step < 0.0 {
            findings
                .add(row, name, FindingKind::Unsorted, || format!("time falls from {before} s to {after} s"));
        } else if step == 0.0 {
            findings.add(row, name, FindingKind::Repeated, || format!("time {after} s stands twice"));
        } else if is_near(step / median, 1000.0, 0.05) || is_near(step / median, 1e-3, 0.05) {
            findings.add(row, name, FindingKind::MixedUnits, || {
                format!(
                    "a step of {} s is {} times the median {} s: ms among s?",
                    plain(step, 6),
                    plain(step / median, 4),
                    plain(median, 6)
                )
            });
        } else if step > 1.5 * median {
            findings.add(row, name, FindingKind::Gap, || {
                format!("a gap of {step:.6} s, {:.0} samples are missing", (step / median).round() - 1.0)
            });
        }
    }
    all.retain(|(_, d)| *d > 0.0 && *d <= 1.5 * median);
    check_jitter(&all, median, name, findings);
}

fn check_jitter(steps: &[(usize, f64)], median: f64, name: Option<&str>, findings: &mut Findings) {
    let rms =
        (steps.iter().map(|(_, d)| (d - median).powi(2)).sum::<f64>() / steps.len().max(1) as f64).sqrt();
    let worst = steps.iter().max_by(|a, b| (a.1 - median).abs().total_cmp(&(b.1 - median).abs()));
    if let Some(&(row, step)) = worst
        && rms > 0.01 * median
    {
        findings.add(row, name, FindingKind::Jitter, || {
            format!(
                "steps vary by {:.2} % rms around {median:.6} s, at most here: {step:.6} s",
                100.0 * rms / median
            )
        });
    }
}

/// - `unread`: rows where no number was read, which is known already
fn check_values(channel: &Channel, unread: &[bool], findings: &mut Findings) {
    let name = Some(channel.name.as_str());
    let count = channel.values.len();
    let finite = channel.values.iter().filter(|x| x.is_finite());
    let Some(first) = finite.clone().next() else {
        if unread.contains(&false) {
            findings
                .add(0, name, FindingKind::NoValues, || format!("none of {count} values is a finite number"));
        }
        return;
    };
    for (row, (x, unread)) in channel.values.iter().zip(unread).enumerate() {
        if !x.is_finite() && !unread {
            findings.add(row, name, FindingKind::NotFinite, || format!("the value is {x}"));
        }
    }
    if channel.quantity != Quantity::Segment && finite.clone().all(|x| x == first) {
        findings.add(0, name, FindingKind::Constant, || match finite.count() {
            equal if equal == count => format!("all {count} values are {first}"),
            equal => format!("all {equal} finite values of {count} are {first}"),
        });
    }
}

/// Ratios of units that are mixed up: degrees and radians, thousandths, rpm and rad/s.
const UNIT_RATIOS: [f64; 3] = [180.0 / std::f64::consts::PI, 1000.0, 30.0 / std::f64::consts::PI];

/// Smaller jumps, as a share of the channel's range, have any ratio near a zero crossing and say nothing of
/// units.
const LEAST_UNIT_JUMP: f64 = 0.1;

fn check_jumps(channel: &Channel, rows: Range<usize>, findings: &mut Findings) {
    let x = &channel.values[rows.clone()];
    let Some(typical) = median(x.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0)) else {
        return;
    };
    let (low, high) = x
        .iter()
        .filter(|x| x.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    for i in 1..x.len() {
        let jump = x[i] - x[i - 1];
        if jump.is_nan() || jump.abs() <= 20.0 * typical {
            continue;
        }
        let stays = x.get(i + 1).is_none_or(|next| (next - x[i]).abs() < 0.2 * jump.abs());
        let name = Some(channel.name.as_str());
        let ratio = (x[i] / x[i - 1]).abs().max((x[i - 1] / x[i]).abs());
        if let Some(unit) = UNIT_RATIOS
            .iter()
            .find(|u| stays && jump.abs() > LEAST_UNIT_JUMP * (high - low) && is_near(ratio, **u, 0.03))
        {
            findings.add(rows.start + i, name, FindingKind::MixedUnits, || {
                format!(
                    "from {} to {}: a factor of {ratio:.2}, close to {unit:.2} between two units",
                    x[i - 1],
                    x[i]
                )
            });
        } else if stays && channel.quantity == Quantity::Position && jump.abs() > 0.5 * (high - low) {
            findings.add(rows.start + i, name, FindingKind::Wrap, || {
                format!(
                    "from {} to {}: a jump of {jump}, like a counter that overflows ({})",
                    x[i - 1],
                    x[i],
                    period(jump)
                )
            });
        }
    }
}

/// The known counter period next to a jump.
fn period(jump: f64) -> String {
    let size = jump.abs();
    let turn = 2.0 * std::f64::consts::PI;
    let power = size.log2().round();
    if is_near(size, turn, 0.05) {
        "one turn, 2π".into()
    } else if is_near(size, 360.0, 0.05) {
        "one turn, 360".into()
    } else if power >= 8.0 && is_near(size, power.exp2(), 0.05) {
        format!("2^{power}")
    } else {
        "no usual period".into()
    }
}

/// Positions against velocities of the same joint, window by window.
fn check_rates(log: &Log, time: &Channel, findings: &mut Findings) {
    const WINDOW: usize = 200;
    let of = |q: Quantity| log.channels().iter().filter(move |c| c.quantity == q && c.joint.is_some());
    for position in of(Quantity::Position) {
        let Some(velocity) = of(Quantity::Velocity).find(|v| v.joint == position.joint) else {
            continue;
        };
        for segment in log.segments() {
            let mut start = segment.start;
            while start + 10 <= segment.end {
                let rows = start..segment.end.min(start + WINDOW);
                start = rows.end;
                let Some(ratio) = rate_ratio(
                    &time.values[rows.clone()],
                    &position.values[rows.clone()],
                    &velocity.values[rows.clone()],
                ) else {
                    continue;
                };
                let unit = UNIT_RATIOS.iter().flat_map(|u| [*u, 1.0 / u]).find(|u| is_near(ratio, *u, 0.2));
                if let Some(unit) = unit {
                    for row in rows {
                        findings.add(row, Some(&position.name), FindingKind::MixedUnits, || {
                            format!(
                                "its slope is {ratio:.4} times {}, close to {unit:.4} between two units",
                                velocity.name
                            )
                        });
                    }
                }
            }
        }
    }
}

/// Slope of `Δq/Δt` over the mean velocity, where the two are correlated.
fn rate_ratio(t: &[f64], q: &[f64], v: &[f64]) -> Option<f64> {
    let (mut rr, mut rv, mut vv) = (0.0, 0.0, 0.0);
    for i in 1..t.len() {
        let rate = (q[i] - q[i - 1]) / (t[i] - t[i - 1]);
        let mean = 0.5 * (v[i] + v[i - 1]);
        if rate.is_finite() && mean.is_finite() {
            rr += rate * rate;
            rv += rate * mean;
            vv += mean * mean;
        }
    }
    (rv > 0.9 * (rr * vv).sqrt() && vv > 0.0).then(|| rv / vv)
}

fn is_near(x: f64, target: f64, share: f64) -> bool {
    (x / target - 1.0).abs() < share
}

#[cfg(test)]
mod tests {
    use super::super::LogSchema;
    use super::*;
    use std::fmt::Write;

    /// A log of one joint at 100 Hz, changed by `change(row, [t, q, v])`.
    fn findings(change: impl Fn(usize, &mut [f64; 3])) -> Vec<(FindingKind, usize, usize, String)> {
        let mut text = String::from("t,q1,dq1\n");
        for i in 0..1000 {
            let t = 0.01 * i as f64;
            let mut row = [t, 1.0 + 0.5 * t.sin(), 0.5 * t.cos()];
            change(i, &mut row);
            writeln!(text, "{},{},{}", row[0], row[1], row[2]).unwrap();
        }
        let (_, findings) = Log::read(text.as_bytes(), "test", &LogSchema::default()).unwrap();
        findings.into_iter().map(|f| (f.kind, f.first, f.last, f.to_string())).collect()
    }

    fn kinds(found: &[(FindingKind, usize, usize, String)]) -> Vec<(FindingKind, usize, usize)> {
        found.iter().map(|f| (f.0, f.1, f.2)).collect()
    }

    #[test]
    fn a_clean_log_has_no_findings() {
        assert_eq!(findings(|_, _| {}), []);
    }

    #[test]
    fn times_are_checked_by_row() {
        let found = findings(|i, row| match i {
            100 => row[0] = 0.99,
            200 => row[0] -= 0.015,
            i if i >= 500 => row[0] += 0.05,
            _ => {}
        });
        let kinds = kinds(&found);
        assert!(kinds.contains(&(FindingKind::Repeated, 100, 100)), "{found:?}");
        assert!(kinds.contains(&(FindingKind::Unsorted, 200, 200)), "{found:?}");
        assert!(
            found
                .iter()
                .any(|f| f.0 == FindingKind::Gap && f.1 == 500 && f.3.contains("5 samples are missing")),
            "{found:?}"
        );
        let jitter = findings(|i, row| row[0] += 0.002 * (i as f64 * 1.7).sin());
        assert!(
            jitter.len() == 1
                && jitter[0].0 == FindingKind::Jitter
                && jitter[0].3.contains("% rms around 0.00999"),
            "{jitter:?}"
        );
        let mixed = findings(|i, row| {
            if i >= 700 {
                row[0] = 7.0 + (row[0] - 7.0) * 1000.0
            }
        });
        assert!(
            mixed.iter().any(|f| f.0 == FindingKind::MixedUnits && f.3.contains("channel t")),
            "{mixed:?}"
        );
    }

    #[test]
    fn values_are_checked_by_row() {
        let found = findings(|i, row| {
            if (300..320).contains(&i) {
                row[1] = f64::NAN;
            }
            row[2] = 0.25;
        });
        assert_eq!(kinds(&found), [(FindingKind::NotFinite, 300, 319), (FindingKind::Constant, 0, 0)]);
        let nothing = findings(|_, row| row[1] = f64::NAN);
        assert_eq!(kinds(&nothing), [(FindingKind::NoValues, 0, 0)]);
    }

    #[test]
    fn wraps_and_units_are_found() {
        let wrap = findings(|i, row| {
            if i >= 400 {
                row[1] -= std::f64::consts::TAU
            }
        });
        assert_eq!(kinds(&wrap), [(FindingKind::Wrap, 400, 400)]);
        assert!(wrap[0].3.contains("one turn, 2π"));
        let degrees = findings(|i, row| {
            if i >= 600 {
                row[1] = row[1].to_degrees()
            }
        });
        assert_eq!(kinds(&degrees), [(FindingKind::MixedUnits, 600, 999)]);
        assert!(degrees[0].3.contains("a factor of 57.62"), "{degrees:?}");
        let all = findings(|_, row| row[1] = row[1].to_degrees());
        assert_eq!(kinds(&all), [(FindingKind::MixedUnits, 0, 999)]);
    }
}
