//! Moments (sums of products) of logs, and the sum of the moments of several logs.

use super::super::error::{IdentificationError, Result, at};
use super::super::estimation::ShareSums;
use super::super::log::hexadecimal;
use super::super::run::Effort;
use super::exact::Exact;
use gelenk_findings::{Finding, Rule};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Sees: warnings of fits to single logs, counted.
/// Matters: a warning that many logs share may be a fault of the robot.
/// Example: a delay in 12 of 100 logs.
/// Fixture: `a_wrong_sign_is_refused_and_named` in `fleet/tests.rs`.
const OF_LOGS: Rule = Rule::warning("doubts-of-logs");

/// Number of shares to which the pieces of logs belong. Shares are the folds of the held-out error and the blocks of
/// intervals.
pub(super) const SHARES: usize = 16;
/// The 32 bytes of a SHA-256.
pub(super) type Hash = [u8; 32];

/// Moments of one or several logs: sums of products of the columns of each joint's equation (regressor and measured force).
/// First the mean of each run is subtracted from the columns, except in the equations of joints with a quaternion. The samples
/// are divided into 16 groups (shares) with separate sums. The size of moments does not depend on the length of the logs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LogMoments {
    pub(super) about: About,
    /// Logs, ascending by their hashes.
    pub(super) logs: Vec<ReducedLog>,
    /// Doubts of the fits to single logs, ascending by joint and kind.
    pub(super) doubts: Vec<Doubt>,
    pub(super) joints: Vec<JointFacts>,
    /// Sums of products of each share (group of samples), [`SHARES`] entries.
    pub(super) shares: Vec<Share>,
}

/// Properties that must be equal for moments to be added.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct About {
    /// SHA-256 of the description and of the options for reading it.
    pub(super) description: Hash,
    pub(super) effort: Effort,
    pub(super) gravity_compensated: bool,
    /// Requested bandwidth \[Hz\]; `None` if it was chosen for each log.
    pub(super) bandwidth: Option<f64>,
    /// Requested delay \[s\]; `None` if it was estimated for each log.
    pub(super) delay: Option<f64>,
    /// Number of columns of each joint.
    pub(super) widths: Vec<usize>,
}

/// A log that was reduced to moments (sums of products).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReducedLog {
    /// File name of the log.
    pub name: String,
    /// SHA-256 of the bytes of the log.
    pub(super) hash: Hash,
    /// SHA-256 of the samples of the log. Copies that differ in empty lines or comments have the same hash.
    pub(super) content: Hash,
    /// Number of samples of the smoothed log at which a joint moves.
    pub samples: u64,
    /// Duration of the smoothed log \[s\].
    pub seconds: f64,
    /// Half-amplitude frequency of the filter \[Hz\].
    pub bandwidth: f64,
    /// Least and largest delay that was removed from an effort \[s\].
    pub delays: [f64; 2],
    /// Largest correlation time \[samples\] of the residuals of the fit to this log, over all joints.
    pub correlation: f64,
}

/// A doubt of the fits to single logs. Doubts with the same joint and kind are combined and counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Doubt {
    /// Index of the joint; `None` if the doubt is about all joints.
    pub(super) joint: Option<u32>,
    /// Code of the doubt's rule.
    pub(super) kind: String,
    /// Number of logs with this doubt.
    pub(super) logs: u64,
    /// The log with the smallest hash that has this doubt.
    pub(super) first: DoubtedLog,
}

/// A log, and a doubt about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct DoubtedLog {
    pub(super) hash: Hash,
    pub(super) name: String,
    /// The doubt as a sentence.
    pub(super) text: String,
}

/// Properties of a joint in addition to its sums of products.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct JointFacts {
    /// Largest range of positions in a run [rad or m].
    pub(super) span: f64,
    pub(super) velocities: [f64; 2],
    /// Σ v², Σ v |v|, Σ t², Σ t |t| of the velocities v, with t = tanh 20 v, without subtraction of means.
    pub(super) directions: [Exact; 4],
}

/// Sums over the pieces of a share.
pub(super) type Share = ShareSums<Exact>;

impl ReducedLog {
    /// Returns the SHA-256 of the log's bytes, in hexadecimal.
    pub fn hash(&self) -> String {
        hexadecimal(&self.hash)
    }
}

impl LogMoments {
    /// Returns the logs in ascending order of their hashes.
    pub fn logs(&self) -> &[ReducedLog] {
        &self.logs
    }

    /// Number of samples of all logs.
    pub(super) fn samples(&self) -> u64 {
        self.logs.iter().map(|log| log.samples).sum()
    }

    /// Returns findings about the doubts of the fits to single logs: one finding for each doubt that at least a tenth of the
    /// logs have, and one finding with the number of the other doubts.
    pub fn doubts(&self) -> Vec<Finding> {
        let logs = self.logs.len();
        let finding = |doubt: &Doubt| {
            let DoubtedLog { name, text, .. } = &doubt.first;
            OF_LOGS.found(match logs {
                1 => format!("{name}: {text}"),
                _ => format!("in {} of {logs} logs, for example in {name}: {text}", doubt.logs),
            })
        };
        self.doubts.iter().map(finding).collect()
    }

    /// Returns the number of shares (groups of samples) that have samples, at most 16.
    pub fn shares(&self) -> usize {
        self.shares.iter().filter(|share| share.samples > 0).count()
    }

    /// Returns the sum of moments. Its bytes do not depend on the order of the parts.
    ///
    /// - `parts`: moments, each with the name of its file
    ///
    /// # Errors
    /// [`IdentificationError::Empty`] if there are no parts, and [`IdentificationError::File`] if the parts have different
    /// descriptions or options, or if a log occurs in two parts.
    pub fn sum<E: From<IdentificationError>>(
        parts: impl IntoIterator<Item = std::result::Result<(Self, String), E>>,
    ) -> std::result::Result<Self, E> {
        let mut sum: Option<(Self, String)> = None;
        // Origin of each log, with the hash of its samples as key: the name of the file of moments, and the log's name there.
        let mut places: BTreeMap<Hash, (String, String)> = BTreeMap::new();
        for part in parts {
            let (moments, place) = part?;
            if let Some((total, first)) = &sum {
                require_same(&total.about, &moments.about, first, &place)?;
            }
            for log in &moments.logs {
                let known = places.insert(log.content, (place.clone(), log.name.clone()));
                if let Some((before, name)) = known {
                    return Err(twice(&place, &log.name, &before, &name).into());
                }
            }
            match &mut sum {
                Some((total, _)) => total.add(moments)?,
                None => sum = Some((moments, place)),
            }
        }
        let sum = sum.map(|(total, _)| total);
        Ok(sum.ok_or_else(|| IdentificationError::Empty { what: "the list of moments".into() })?)
    }

    /// Adds moments of the same robot and options.
    fn add(&mut self, other: Self) -> Result<()> {
        self.logs.extend(other.logs);
        self.logs.sort_by_key(|log| log.hash);
        other.doubts.into_iter().for_each(|doubt| self.add_doubt(doubt));
        for (joint, other) in self.joints.iter_mut().zip(&other.joints) {
            joint.add(other)?;
        }
        for (share, other) in self.shares.iter_mut().zip(other.shares) {
            add_share(share, other)?;
        }
        Ok(())
    }

    fn add_doubt(&mut self, doubt: Doubt) {
        match self.doubts.binary_search_by(|known| known.place().cmp(&doubt.place())) {
            Err(place) => self.doubts.insert(place, doubt),
            Ok(place) => {
                let known = &mut self.doubts[place];
                known.logs = known.logs.saturating_add(doubt.logs);
                if doubt.first.hash < known.first.hash {
                    known.first = doubt.first;
                }
            }
        }
    }
}

impl Doubt {
    /// Joint and kind of a doubt, by which doubts are distinguished.
    pub(super) fn place(&self) -> (Option<u32>, &str) {
        (self.joint, &self.kind)
    }
}

impl JointFacts {
    pub(super) fn add(&mut self, other: &Self) -> Result<()> {
        self.span = self.span.max(other.span);
        self.velocities =
            [self.velocities[0].min(other.velocities[0]), self.velocities[1].max(other.velocities[1])];
        add_all(&mut self.directions, &other.directions)
    }
}

/// Adds the sums of another share.
pub(super) fn add_share(share: &mut Share, other: Share) -> Result<()> {
    share.samples = share.samples.saturating_add(other.samples);
    if share.joints.is_empty() {
        share.joints = other.joints;
        return Ok(());
    }
    for (joint, other) in share.joints.iter_mut().zip(&other.joints) {
        joint.weight = joint.weight.plus(other.weight)?;
        add_all(&mut joint.lost, &other.lost)?;
        add_all(&mut joint.products, &other.products)?;
    }
    Ok(())
}

fn add_all(sums: &mut [Exact], others: &[Exact]) -> Result<()> {
    sums.iter_mut().zip(others).try_for_each(|(sum, other)| {
        *sum = sum.plus(*other)?;
        Ok(())
    })
}

fn twice(place: &str, name: &str, before: &str, other: &str) -> IdentificationError {
    let message = if place == name && before == other {
        format!("it has the same samples as {before}: give each log only once")
    } else {
        format!(
            "its log {name} has the same samples as the log {other} in {before}. Leave out one of the two files"
        )
    };
    at(place).fault(message)
}

/// Fails unless two moments were made with the same description and options.
fn require_same(first: &About, other: &About, before: &str, place: &str) -> Result<()> {
    let fault = |message: String| Err(at(place).fault(message));
    if first.description != other.description {
        return fault(format!(
            "it was made with another description than {before}. Reduce its logs again with the intended description and the same \
             options for reading"
        ));
    }
    for ((mine, remedy), (theirs, _)) in made_with(first).into_iter().zip(made_with(other)) {
        if mine != theirs {
            return fault(format!("{theirs}, but {before} differs: {mine}. Reduce the logs {remedy}"));
        }
    }
    if first.widths != other.widths {
        return fault(format!(
            "it has other columns than {before}. Reduce all logs with the same version of gelenk"
        ));
    }
    Ok(())
}

/// Sentences on the options with which moments were made, each with a remedy for different options.
fn made_with(about: &About) -> [(String, &'static str); 4] {
    let said = |option: &str, value: Option<String>| {
        let option =
            value.map_or_else(|| format!("without {option}"), |value| format!("with {option}{value}"));
        format!("it was reduced {option}")
    };
    let number = |value: Option<f64>| value.map(|value| format!(" {value:?}"));
    let compensated = about.gravity_compensated.then(String::new);
    [
        (format!("its efforts are {}", about.effort.plural()), "with the same --effort"),
        (said("--gravity-compensated", compensated), "either all with this option or all without it"),
        (said("--bandwidth", number(about.bandwidth)), "with the same --bandwidth"),
        (said("--delay", number(about.delay)), "with the same --delay"),
    ]
}
