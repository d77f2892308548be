//! Times of strangers' logs: the column, its unit, values without a lost digit, and seconds.

use super::super::error::Result;
use super::families::{Targets, meaning_of};
use super::finder::Finder;
use super::finding::{COLUMN_DOUBTFUL, UNIT_ASSUMED};
use super::number::{Decimals, exact};
use super::options::Named;
use super::scale::is_described;
use super::vocabulary::{Header, Kind};
use gelenk_findings::Finding;

/// Where times stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TimeColumn {
    /// Times, or whole seconds; `None` where rows are counted.
    pub column: Option<usize>,
    /// Nanoseconds beside whole seconds.
    pub nanoseconds: Option<usize>,
    /// Seconds of its unit, where it is named.
    pub unit: Option<f64>,
    /// A sentence about the column.
    pub said: String,
    /// What stands in brackets as its unit and is none that is known.
    pub doubt: Option<Finding>,
}

impl TimeColumn {
    pub(super) fn columns(&self) -> Vec<usize> {
        [self.column, self.nanoseconds].into_iter().flatten().collect()
    }

    /// Time of a row in 10⁻¹² of its unit.
    ///
    /// - `line`: of the row in the file
    pub(super) fn read(&self, record: &csv::ByteRecord, line: usize, decimals: Decimals) -> Option<i128> {
        let Some(column) = self.column else { return Some(line as i128 * 1_000_000_000_000) };
        let whole = exact(record.get(column)?, decimals)?;
        match self.nanoseconds {
            None => Some(whole),
            Some(column) => whole.checked_add(exact(record.get(column)?, decimals)? / 1_000_000_000),
        }
    }
}

/// Finds the time: by the user's pattern, otherwise a message's stamp before `t`, `time` and `timestamp`, and these
/// before the time when a message came.
///
/// # Errors
/// No column or several equally good ones.
pub(super) fn find_time(finder: &Finder) -> Result<TimeColumn> {
    if let Some(pattern) = finder.pattern(|n| n == Named::Time) {
        if let Some(period) = pattern.counts_rows(finder.headers) {
            let said = format!("Rows are counted as the time, every {period} s.");
            return Ok(TimeColumn { column: None, nanoseconds: None, unit: Some(period), said, doubt: None });
        }
        let one = Targets::new(&["time".into()], &[]);
        let chosen = pattern.resolve(finder.headers, finder.sheet.width, &one)?;
        let column = chosen.columns[0];
        let header = finder.headers.get(column);
        let pair = header.and_then(|h| partner(h, finder.headers)).filter(|_| chosen.unit().is_none());
        return Ok(time_column(finder, column, pair, chosen.unit().map(|u| u.factor)));
    }
    let mut found: Vec<(u8, &Header)> = finder
        .headers
        .iter()
        .filter(|h| !is_nanoseconds(h) || whole_partner(h, finder.headers).is_none())
        .filter_map(|h| meaning_of(h, &h.words).filter(|m| m.kind == Kind::Time).map(|m| (m.doubt, h)))
        .collect();
    found.sort_by_key(|(doubt, _)| *doubt);
    let (still, moving): (Vec<_>, Vec<_>) = found.iter().copied().partition(|(_, h)| stands_still(finder, h));
    let candidates = if moving.is_empty() { still } else { moving };
    let Some((doubt, header)) = candidates.first() else {
        return Err(finder.fault(format!(
            "no column is known as the time. There are {}. Name it: --columns 'time=…[s]', or where a column counts samples, its \
             period: --columns 'time=…[4 ms]'",
            super::sheet::shortened(&finder.sheet.headers)
        )));
    };
    let mut rivals = candidates.iter().skip(1).filter(|(d, _)| d == doubt);
    if let Some((_, other)) = rivals.find(|(_, other)| !are_equal(finder, header, other)) {
        return Err(finder.fault(format!(
            "both `{}` and `{}` (columns {} and {}) could be the time: --columns 'time={}' or 'time={}' settles it",
            header.text,
            other.text,
            header.index + 1,
            other.index + 1,
            finder.unique(header),
            finder.unique(other)
        )));
    }
    Ok(time_column(finder, header.index, partner(header, finder.headers), None))
}

fn time_column(finder: &Finder, column: usize, pair: Option<usize>, told: Option<f64>) -> TimeColumn {
    let header = finder.headers.get(column);
    let named = header.and_then(|h| h.unit.filter(|u| u.si == "s").or_else(|| super::scale::time_suffix(h)));
    let unit = told.or_else(|| named.map(|u| u.factor));
    let said = match (pair, unit) {
        (Some(nano), _) => {
            format!("Columns {} and {} are the time, in s and ns.", finder.label(column), finder.label(nano))
        }
        (None, Some(unit)) => format!("Column {} is the time, times {unit} in s.", finder.label(column)),
        (None, None) => format!("Column {} is the time.", finder.label(column)),
    };
    let odd = header.and_then(|h| h.odd.as_ref().map(|odd| (h, odd)));
    let odd = odd.filter(|(_, odd)| unit.is_none() && pair.is_none() && !is_described(finder, odd));
    let doubt = odd.map(|(header, odd)| {
        let message = format!(
            "the time is in `{odd}`, which is no known unit: it is taken for seconds, or for ms, µs or ns if its steps are long"
        );
        let remedy = format!("give its unit, as in --columns 'time={}[0.001 s]'", finder.unique(header));
        COLUMN_DOUBTFUL.found(message).help(remedy)
    });
    TimeColumn {
        column: Some(column),
        nanoseconds: pair,
        unit: if pair.is_some() { Some(1.0) } else { unit },
        said,
        doubt,
    }
}

/// All sampled rows have the same time: a stamp that nobody set.
fn stands_still(finder: &Finder, header: &Header) -> bool {
    let mut values =
        finder.sheet.sample.iter().filter_map(|row| row.get(header.index)).filter(|f| !f.is_empty());
    let nano = partner(header, finder.headers);
    let nanos: Vec<Option<&String>> =
        finder.sheet.sample.iter().map(|row| nano.and_then(|n| row.get(n))).collect();
    let first = values.next();
    finder.sheet.sample.len() > 3
        && values.all(|v| Some(v) == first)
        && nanos.windows(2).all(|w| w[0] == w[1])
}

/// Two columns that hold the same in the sampled rows, as programs write that repeat the time before each signal.
fn are_equal(finder: &Finder, one: &Header, other: &Header) -> bool {
    finder.sheet.sample.iter().all(|row| row.get(one.index) == row.get(other.index))
}

const SECONDS: [&str; 3] = ["sec", "secs", "seconds"];
const NANOSECONDS: [&str; 6] = ["nsec", "nsecs", "nanosec", "nanosecs", "nanosecond", "nanoseconds"];

fn is_nanoseconds(header: &Header) -> bool {
    header.words.iter().any(|w| NANOSECONDS.contains(&w.as_str()))
}

/// The column of nanoseconds beside one of seconds.
fn partner(header: &Header, headers: &[Header]) -> Option<usize> {
    headers.iter().find(|other| are_pair(header, other)).map(|other| other.index)
}

fn whole_partner(header: &Header, headers: &[Header]) -> Option<usize> {
    headers.iter().find(|other| are_pair(other, header)).map(|other| other.index)
}

fn are_pair(whole: &Header, nano: &Header) -> bool {
    let fits = |(a, b): (&String, &String)| {
        a == b || SECONDS.contains(&a.as_str()) && NANOSECONDS.contains(&b.as_str())
    };
    whole.words.len() == nano.words.len()
        && is_nanoseconds(nano)
        && !is_nanoseconds(whole)
        && whole.words.iter().zip(&nano.words).all(fits)
}

/// Seconds of a unit that nobody names, by the usual step: robots are sampled between 5 Hz and 20 kHz.
///
/// - `step`: median step in 10⁻¹² of the unit
/// - returns the factor, and a sentence where it is not 1
pub(super) fn assumed_unit(step: i128) -> (f64, Option<String>) {
    let steps = step as f64 / 1e12;
    let (factor, name) = match steps {
        s if s <= 0.2 => return (1.0, None),
        s if s < 100.0 => (1e-3, "ms"),
        s if s < 1e5 => (1e-6, "µs"),
        _ => (1e-9, "ns"),
    };
    let said = format!(
        "the time has no unit and steps by {steps}: taken as {name} ({:.6} Hz); --columns 'time=…[s]' says otherwise{}",
        1.0 / (steps * factor),
        if steps == 1.0 { ", and the period of a counter of samples, as in 'time=…[4 ms]'" } else { "" }
    );
    (factor, Some(said))
}

/// Fewest samples by which a counter is told from a clock.
const COUNTED: usize = 100;

/// What is said where times step by exactly one second throughout: nobody records a robot so slowly, and a counter of
/// samples looks like that.
///
/// - `times`: in 10⁻¹² of the unit; `unit`: in seconds
pub(super) fn counter_finding(times: &[i128], unit: f64, place: &str) -> Option<Finding> {
    const ONE: i128 = 1_000_000_000_000;
    let counts =
        unit == 1.0 && times.len() >= COUNTED && times.windows(2).all(|pair| pair[1] - pair[0] == ONE);
    counts.then(|| {
        let message = "its times step by exactly 1 s: where they are a counter of samples, name the period, as in --columns \
                       'time=…[4 ms]'";
        UNIT_ASSUMED.found(message).log(place, None)
    })
}

/// From counts to seconds since the log's beginning, or since 0 where times are no epoch.
pub(super) struct Clock {
    zero: i128,
    per_second: f64,
}

/// Beyond, times are taken as counted from an epoch or from when a machine was started [s].
const EPOCH: f64 = 1e6;

impl Clock {
    /// The clock of times that count `unit` seconds in 10⁻¹² of it.
    pub(super) fn new(times: &[i128], unit: f64) -> Self {
        // Powers of ten that are doubles: a quotient by them is the double that is nearest to the decimal.
        let exact = [1e12, 1e15, 1e18, 1e21].into_iter().find(|p| (p * unit / 1e12 - 1.0).abs() < 1e-9);
        let per_second = exact.unwrap_or(1e12 / unit);
        let first = times.first().copied().unwrap_or(0);
        let is_epoch = first as f64 / per_second > EPOCH;
        Self { zero: if is_epoch { first } else { 0 }, per_second }
    }

    pub(super) fn seconds(&self, time: i128) -> f64 {
        time.saturating_sub(self.zero) as f64 / self.per_second
    }
}
