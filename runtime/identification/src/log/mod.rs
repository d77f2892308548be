//! Logs of a robot as runs: the columns of the robot are found in tables that other programs wrote.
//!
//! Nothing is repaired silently: what is suspicious or left out is a finding of the recording.
//! The order of work is one file for each step: `sheet` (separators, header, rows), `vocabulary` and `languages`
//! (words of a header), `families` (the columns of one quantity), `mapping` and `scale` (which family, in which unit), `time`,
//! `runs` (samples, cut into runs), `bursts` (times of arrival), `unroll` (poses with quaternions), `joint_forces` (inputs at frames), `health` (what the runs say about their log).

mod acting;
mod brief;
mod bursts;
mod families;
mod finder;
mod finding;
mod health;
mod joint_forces;
mod labels;
mod languages;
mod mapping;
mod number;
mod options;
mod pose_columns;
mod pose_words;
mod recording;
#[cfg(test)]
mod refusals;
mod runs;
mod saturation;
mod scale;
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
mod zeros;

pub(crate) use finding::GEAR_DOUBTFUL;
pub use labels::{ColumnLabels, Labels};
pub use options::ColumnOptions;
pub(crate) use recording::runs_noting;
pub use recording::{Recording, runs, runs_of};
pub(crate) use units::{SEEN, are_minutes, unit_value};
