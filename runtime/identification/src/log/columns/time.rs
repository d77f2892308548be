//! Search for the column of times and its unit.

use super::super::super::error::{IdentificationError, Result};
use super::super::number::{Decimals, exact};
use super::super::sheet::shortened;
use super::super::units::Unit;
use super::families::Targets;
use super::finder::Finder;
use super::found::COLUMN_DOUBTFUL;
use super::header::Header;
use super::pattern::Chosen;
use super::table::Kind;
use gelenk_findings::Finding;

/// Column of the times of a log, with its unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct TimeColumn {
    /// Column of the times, or of their whole seconds; `None` if rows are counted.
    pub column: Option<usize>,
    /// Column of the nanoseconds that belong to the whole seconds; `None` if there is no such column.
    pub nanoseconds: Option<usize>,
    /// Unit of the times, in s; `None` if no unit is named.
    pub unit: Option<f64>,
    /// Name of the column in `--columns`.
    pub text: String,
    /// Whether the user named the unit.
    pub is_stated: bool,
    /// Finding about brackets in the header that contain an unknown unit; `None` if there are no such brackets.
    pub doubt: Option<Finding>,
}

impl TimeColumn {
    pub(super) fn columns(&self) -> Vec<usize> {
        [self.column, self.nanoseconds].into_iter().flatten().collect()
    }

    /// Returns the part of `--columns` that names the column.
    pub(super) fn option(&self) -> String {
        let unit = self.unit.filter(|_| self.is_stated).map(|factor| Unit { factor, si: "s" }.text());
        format!("time={}{}", self.text, unit.map_or(String::new(), |unit| format!("[{unit}]")))
    }

    /// Returns the time of a row in 10⁻¹² of the unit; `None` if the field is not a number.
    ///
    /// - `line`: line of the row in the file
    pub(in crate::log) fn read(
        &self,
        record: &csv::ByteRecord,
        line: usize,
        decimals: Decimals,
    ) -> Option<i128> {
        let Some(column) = self.column else { return Some(line as i128 * 1_000_000_000_000) };
        let whole = exact(record.get(column)?, decimals)?;
        match self.nanoseconds {
            None => Some(whole),
            Some(column) => whole.checked_add(exact(record.get(column)?, decimals)? / 1_000_000_000),
        }
    }
}

impl Finder<'_> {
    /// Finds the column of times, by the user's pattern or by the headers. The time stamp of a message is preferred to `t`,
    /// `time` and `timestamp`. The time of a message's arrival is the last choice.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if there is no column of times, or if several columns fit equally well.
    pub(super) fn time(&self) -> Result<TimeColumn> {
        if let Some(pattern) = self.pattern(|kind| kind == Kind::Time) {
            if let Some(period) = pattern.counts_rows(&self.headers) {
                let (unit, text) = (Some(period), "row".into());
                return Ok(TimeColumn { unit, text, is_stated: true, ..TimeColumn::default() });
            }
            let Chosen { columns, units, .. } =
                pattern.resolve(&self.headers, self.sheet.width, &Targets::one("time"))?;
            return Ok(self.time_column(columns[0], units[0]));
        }
        let is_first = |h: &&Header| !self.headers.iter().any(|other| are_pair(other, h));
        let time = |h| Some((Header::meaning(h, &h.words).filter(|m| m.kind == Kind::Time)?.doubt, h));
        let mut found: Vec<(u8, &Header)> = self.headers.iter().filter(is_first).filter_map(time).collect();
        found.sort_by_key(|(doubt, _)| *doubt);
        let (still, moving): (Vec<_>, Vec<_>) =
            found.iter().copied().partition(|(_, h)| self.stands_still(h));
        let candidates = if moving.is_empty() { still } else { moving };
        let Some((doubt, header)) = candidates.first() else { return Err(self.no_time()) };
        let mut rivals = candidates.iter().skip(1).filter(|(d, _)| d == doubt);
        if let Some((_, other)) = rivals.find(|(_, other)| !self.are_equal(header, other)) {
            return Err(self.undecided(format!(
                "both `{}` and `{}` (columns {} and {}) could be the time. Use --columns 'time={}' or 'time={}'",
                header.text,
                other.text,
                header.index + 1,
                other.index + 1,
                self.unique(header.index),
                self.unique(other.index)
            )));
        }
        Ok(self.time_column(header.index, None))
    }

    fn no_time(&self) -> IdentificationError {
        self.undecided(format!(
            "the log has no column with a usual name for the time. The columns are: {}. Name the column with --columns \
             'time=…[s]'. If it counts samples, give the period: --columns 'time=…[4 ms]'",
            shortened(&self.sheet.headers)
        ))
    }

    fn time_column(&self, column: usize, stated: Option<Unit>) -> TimeColumn {
        let header = self.headers.get(column);
        let nanoseconds = header.and_then(|h| self.nanoseconds(h)).filter(|_| stated.is_none());
        let in_seconds = |unit: &Unit| unit.si == "s";
        let named = header
            .and_then(|h| h.unit.filter(in_seconds).or_else(|| self.suffix(h, &["s"]).filter(in_seconds)));
        let unit = stated.or(named).map(|u| u.factor);
        let text = self.unique(column);
        let odd = header.and_then(|h| h.odd.as_ref()).filter(|odd| !self.is_described(odd));
        let doubt = odd.filter(|_| unit.is_none() && nanoseconds.is_none()).map(|odd| {
            let message = format!(
                "the time is in `{odd}`, which is not a known unit. The times are read as seconds, or as ms, µs or ns if the \
                 steps are large"
            );
            COLUMN_DOUBTFUL.found(message).help(format!("give the unit of the time, as in --columns 'time={text}[0.001 s]'"))
        });
        TimeColumn {
            column: Some(column),
            unit: if nanoseconds.is_some() { Some(1.0) } else { unit },
            nanoseconds,
            text,
            is_stated: stated.is_some(),
            doubt,
        }
    }

    /// Returns whether all sampled rows have the same time, for example a time stamp that was never set.
    fn stands_still(&self, header: &Header) -> bool {
        let sample = &self.sheet.sample;
        let mut values = sample.iter().filter_map(|row| row.get(header.index)).filter(|f| !f.is_empty());
        let nano = self.nanoseconds(header);
        let nanos: Vec<Option<&String>> = sample.iter().map(|row| nano.and_then(|n| row.get(n))).collect();
        let first = values.next();
        sample.len() > 3 && values.all(|v| Some(v) == first) && nanos.windows(2).all(|w| w[0] == w[1])
    }

    /// Returns whether two columns have the same values in the sampled rows. Some programs repeat the time before each
    /// signal.
    fn are_equal(&self, one: &Header, other: &Header) -> bool {
        self.sheet.sample.iter().all(|row| row.get(one.index) == row.get(other.index))
    }

    /// Returns the column of nanoseconds that belongs to a column of seconds; `None` if there is no such column.
    fn nanoseconds(&self, header: &Header) -> Option<usize> {
        self.headers.iter().find(|other| are_pair(header, other)).map(|other| other.index)
    }
}

const SECONDS: [&str; 3] = ["sec", "secs", "seconds"];
const NANOSECONDS: [&str; 6] = ["nsec", "nsecs", "nanosec", "nanosecs", "nanosecond", "nanoseconds"];

fn are_pair(whole: &Header, nano: &Header) -> bool {
    let is_nanoseconds = |header: &Header| header.words.iter().any(|w| NANOSECONDS.contains(&w.as_str()));
    let fits = |(a, b): (&String, &String)| {
        a == b || SECONDS.contains(&a.as_str()) && NANOSECONDS.contains(&b.as_str())
    };
    whole.words.len() == nano.words.len()
        && is_nanoseconds(nano)
        && !is_nanoseconds(whole)
        && whole.words.iter().zip(&nano.words).all(fits)
}
