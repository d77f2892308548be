//! Logs of a real or simulated robot: channels read from CSV, with everything suspicious reported by row.
//!
//! Nothing is repaired silently: a value that cannot be read is NaN and reported; gaps, jitter, wraps and
//! mixed units are [`Finding`]s, and the caller decides (select rows, split).
//!
//! [`runs`] goes further for logs of strangers: it finds the columns of a robot by itself and gives whole runs.
//! Its order of work is one file for each step: `sheet` (separators, header, rows), `vocabulary` and `languages`
//! (words of a header), `families` (the columns of one quantity), `mapping` and `scale` (which family, in which unit), `time`,
//! `runs` (samples, cut into runs), `unroll` (poses with quaternions), `joint_forces` (inputs at frames), `health` (what the runs say about their log).

mod acting;
mod brief;
mod check;
mod families;
mod finder;
mod finding;
mod health;
mod joint_forces;
mod labels;
mod languages;
mod mapping;
mod motion;
mod number;
mod options;
mod pose_columns;
mod pose_words;
mod read;
mod recording;
#[cfg(test)]
mod refusals;
mod runs;
mod saturation;
mod scale;
mod schema;
mod search;
mod sheet;
mod spikes;
#[cfg(test)]
mod strangers;
#[cfg(test)]
mod testing;
mod time;
mod units;
mod unroll;
mod vocabulary;
mod wording;

pub use check::{Finding, FindingKind, check};
pub use finding::RunFinding;
pub use labels::{ColumnLabels, Labels};
pub use motion::{Differentiation, MotionColumns};
pub use options::ColumnOptions;
pub(crate) use recording::runs_noting;
pub use recording::{Recording, runs, runs_of};
pub use schema::{ChannelSchema, LogSchema, Quantity};
pub(crate) use units::{SEEN, are_minutes, unit_value};

use super::error::{IdentificationError, Result};
use super::expression::select;
use std::ops::Range;

/// One column of a log, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in expressions, an identifier.
    pub name: String,
    /// The quantity that the channel measures.
    pub quantity: Quantity,
    /// Unit of the values after conversion, e.g. `rad/s`.
    pub unit: String,
    /// Joint it belongs to, by the number in the schema or in the name.
    pub joint: Option<usize>,
    /// Samples; NaN where the file has no number.
    pub values: Vec<f64>,
}

/// Channels of equal length, and where they came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    channels: Vec<Channel>,
    segments: Vec<Range<usize>>,
    hash: String,
    source: String,
}

impl Log {
    /// All channels, in the order of the file or schema.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Names of the channels, as expressions need them.
    pub fn names(&self) -> Vec<String> {
        self.channels.iter().map(|c| c.name.clone()).collect()
    }

    /// Samples of all channels, as expressions need them.
    pub fn columns(&self) -> Vec<&[f64]> {
        self.channels.iter().map(|c| c.values.as_slice()).collect()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.channels.first().map_or(0, |c| c.values.len())
    }

    /// Rows between changes of the segment channel; one range if there is none.
    pub fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    /// SHA-256 of the file's bytes, in hexadecimal.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// Where the log came from, for messages.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Samples of one channel.
    ///
    /// # Errors
    /// [`IdentificationError::UnknownChannel`]
    pub fn channel(&self, name: &str) -> Result<&[f64]> {
        self.channels
            .iter()
            .find(|c| c.name == name)
            .map(|c| c.values.as_slice())
            .ok_or_else(|| IdentificationError::UnknownChannel { name: name.into(), known: self.names() })
    }

    /// The time channel.
    ///
    /// # Errors
    /// [`IdentificationError::UnknownChannel`] if the log has none.
    pub fn time(&self) -> Result<&[f64]> {
        let channel = self.channels.iter().find(|c| c.quantity == Quantity::Time);
        channel
            .map(|c| c.values.as_slice())
            .ok_or_else(|| IdentificationError::UnknownChannel { name: "time".into(), known: self.names() })
    }

    /// Rows where the expression is true, see [`select`].
    ///
    /// # Errors
    /// As [`select`].
    pub fn select(&self, expression: &str) -> Result<Vec<usize>> {
        select(expression, &self.names(), &self.columns())
    }

    /// Adds a computed channel, e.g. a differentiated velocity.
    ///
    /// # Errors
    /// A name that exists, or a wrong length.
    pub fn add(&mut self, channel: Channel) -> Result<()> {
        super::error::require_length(
            &format!("samples of channel {}", channel.name),
            self.rows(),
            channel.values.len(),
        )?;
        if self.channels.iter().any(|c| c.name == channel.name) {
            return Err(IdentificationError::Expression {
                text: channel.name,
                message: "this channel exists already".into(),
            });
        }
        self.channels.push(channel);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_do_not_exist_are_left_out_or_refused() {
        let text = "t,q1\n0,1\n0.1,-1e300\n0.2,NaN\n";
        let (log, _) = Log::read(text.as_bytes(), "test", &LogSchema::default()).unwrap();
        for margin in [2, usize::MAX / 2, usize::MAX] {
            assert!(log.inner_rows(&[0, 1, 2], margin).is_err(), "{margin}");
        }
        assert_eq!(log.inner_rows(&[0, 1, 2, usize::MAX], 1).unwrap(), [1]);
        assert!(log.values("q1", &[usize::MAX]).is_err());
    }
}
