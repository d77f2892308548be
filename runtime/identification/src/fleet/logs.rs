//! Moments of logs, and their sum.

use super::super::error::{IdentificationError, Result};
use super::super::log::hexadecimal;
use super::super::run::Effort;
use super::exact::Exact;
use super::levels;
use gelenk_findings::{Finding, Rule};
use std::collections::BTreeMap;

/// Sees: warnings of fits to single logs, counted.
/// Matters: what a part of the logs has in common may be a fault of the robot.
/// Example: a delay in 12 of 100 logs.
/// Fixture: `a_wrong_sign_is_refused_and_named` in `fleet/tests.rs`.
const OF_LOGS: Rule = Rule::warning("doubts-of-logs");

/// Shares that pieces of logs belong to: folds of the held-out error, and blocks of intervals.
pub(super) const SHARES: usize = 16;
/// A SHA-256.
pub(super) type Hash = [u8; 32];

/// Moments of a log, of a size that does not grow with its length: sums of products of the columns of
/// each joint's equation, offsets of the runs taken out, in 16 shares.
#[derive(Debug, Clone, PartialEq)]
pub struct LogMoments {
    pub(super) about: About,
    /// Ascending by hash.
    pub(super) logs: Vec<ReducedLog>,
    /// Ascending.
    pub(super) doubts: Vec<Doubt>,
    pub(super) joints: Vec<JointFacts>,
    /// [`SHARES`] of them.
    pub(super) shares: Vec<Share>,
}

/// Properties that have to agree between moments that are added.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct About {
    /// SHA-256 of the description and of how it is read.
    pub(super) description: Hash,
    pub(super) effort: Effort,
    pub(super) gravity_compensated: bool,
    /// Requested bandwidth \[Hz\]; `None` if each log has its own.
    pub(super) bandwidth: Option<f64>,
    /// Requested delay \[s\]; `None` if each log has its own.
    pub(super) delay: Option<f64>,
    /// Columns of each joint.
    pub(super) widths: Vec<usize>,
}

/// A log that was reduced.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedLog {
    /// File name.
    pub name: String,
    /// SHA-256 of its bytes.
    pub(super) hash: Hash,
    /// SHA-256 of its samples: the same for copies that differ in empty lines or comments.
    pub(super) content: Hash,
    /// Samples on the even grid, after smoothing.
    pub samples: u64,
    /// Their duration \[s\].
    pub seconds: f64,
    /// Half-amplitude frequency of the filter \[Hz\].
    pub bandwidth: f64,
    /// Least and largest delay that was removed from an effort \[s\].
    pub delays: [f64; 2],
    /// Samples after which residuals of the fit to this log forget, the largest of all joints.
    pub correlation: f64,
}

/// A doubt that the fits to single logs gave: as many kinds as joints and sentences, not as logs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Doubt {
    /// None if all joints are meant.
    pub(super) joint: Option<u32>,
    /// The sentence without its numbers.
    pub(super) kind: String,
    /// How many logs gave it.
    pub(super) logs: u64,
    /// The one with the smallest hash, its name, and its sentence.
    pub(super) first: (Hash, String, String),
}

/// Knowledge about a joint in addition to its sums of products.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointFacts {
    /// Largest range of positions in a run [rad or m].
    pub(super) span: f64,
    pub(super) velocities: [f64; 2],
    /// Σ v², Σ v |v|, Σ t², Σ t |t| with t = tanh 20 v, not centred.
    pub(super) directions: [Exact; 4],
}

/// Sums over the pieces of a share.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Share {
    pub(super) samples: u64,
    /// Sums of each joint; empty in a share without samples.
    pub(super) joints: Vec<JointSums>,
}

/// A joint's sums.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointSums {
    /// Σ w.
    pub(super) weight: Exact,
    /// Sums of squares that outliers lost with their weight: Σ (1 − w) r² and Σ (1 − w)(z − z̄)², in units of the effort.
    pub(super) lost: [Exact; 2],
    /// Σ w (x − x̄)(x − x̄)ᵀ, or Σ w x xᵀ in the row of a joint with a quaternion: rows of the lower triangle.
    pub(super) products: Vec<Exact>,
}

impl ReducedLog {
    /// SHA-256 of the log's bytes, in hexadecimal.
    pub fn hash(&self) -> String {
        hexadecimal(&self.hash)
    }
}

impl LogMoments {
    /// The logs, ascending by their hashes.
    pub fn logs(&self) -> &[ReducedLog] {
        &self.logs
    }

    /// Samples of all logs.
    pub(super) fn samples(&self) -> u64 {
        self.logs.iter().map(|log| log.samples).sum()
    }

    /// Doubts of the fits to single logs: those of at least a tenth of them, and how many others there are.
    pub fn doubts(&self) -> Vec<Finding> {
        let logs = self.logs.len();
        let is_rare = |doubt: &&Doubt| (doubt.logs as f64) < levels::RARE.get() * logs as f64;
        let finding = |doubt: &Doubt| {
            let (_, name, text) = &doubt.first;
            OF_LOGS.found(match logs {
                1 => format!("{name}: {text}"),
                _ => format!("in {} of {logs} logs, as in {name}: {text}", doubt.logs),
            })
        };
        let rare = self.doubts.iter().filter(is_rare).count();
        let rare = (rare > 0).then(|| {
            let message = format!("{rare} more doubts are of less than a tenth of the logs each");
            OF_LOGS.found(message).help("--reduce names them for each log")
        });
        self.doubts.iter().filter(|doubt| !is_rare(doubt)).map(finding).chain(rare).collect()
    }

    /// Shares with samples.
    pub fn shares(&self) -> usize {
        self.shares.iter().filter(|share| share.samples > 0).count()
    }

    /// The sum of moments with the place of each: whatever the order, it is the same bytes.
    ///
    /// # Errors
    /// None of them, moments of different descriptions or options, and a log that is in two of them.
    pub fn sum<E: From<IdentificationError>>(
        parts: impl IntoIterator<Item = std::result::Result<(Self, String), E>>,
    ) -> std::result::Result<Self, E> {
        let mut sum = Sum::default();
        for part in parts {
            let (moments, place) = part?;
            sum.add(moments, &place)?;
        }
        Ok(sum.total.ok_or_else(|| IdentificationError::Empty { what: "the list of moments".into() })?)
    }

    /// Adds moments that belong to the same robot and options.
    fn add(&mut self, other: Self) -> Result<()> {
        self.logs.extend(other.logs);
        self.logs.sort_by_key(|log| log.hash);
        other.doubts.into_iter().for_each(|doubt| self.add_doubt(doubt));
        for (joint, other) in self.joints.iter_mut().zip(&other.joints) {
            joint.add(other)?;
        }
        for (share, other) in self.shares.iter_mut().zip(other.shares) {
            share.add(other)?;
        }
        Ok(())
    }

    fn add_doubt(&mut self, doubt: Doubt) {
        match self.doubts.binary_search_by(|known| known.place().cmp(&doubt.place())) {
            Err(place) => self.doubts.insert(place, doubt),
            Ok(place) => {
                let known = &mut self.doubts[place];
                known.logs = known.logs.saturating_add(doubt.logs);
                if doubt.first.0 < known.first.0 {
                    known.first = doubt.first;
                }
            }
        }
    }
}

impl Doubt {
    /// Key that distinguishes doubts.
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

impl Share {
    pub(super) fn add(&mut self, other: Self) -> Result<()> {
        self.samples = self.samples.saturating_add(other.samples);
        if self.joints.is_empty() {
            self.joints = other.joints;
            return Ok(());
        }
        for (joint, other) in self.joints.iter_mut().zip(&other.joints) {
            joint.weight = joint.weight.plus(other.weight)?;
            add_all(&mut joint.lost, &other.lost)?;
            add_all(&mut joint.products, &other.products)?;
        }
        Ok(())
    }
}

fn add_all(sums: &mut [Exact], others: &[Exact]) -> Result<()> {
    sums.iter_mut().zip(others).try_for_each(|(sum, other)| {
        *sum = sum.plus(*other)?;
        Ok(())
    })
}

/// A sum of moments in the making.
#[derive(Debug, Default)]
struct Sum {
    total: Option<LogMoments>,
    /// Where the first moments came from.
    first: String,
    /// Where each log came from, by the hash of its samples: the file of moments, and the log's name in it.
    places: BTreeMap<Hash, (String, String)>,
}

impl Sum {
    /// Adds moments that come from `place`.
    fn add(&mut self, moments: LogMoments, place: &str) -> Result<()> {
        if let Some(total) = &self.total {
            require_same(&total.about, &moments.about, &self.first, place)?;
        } else {
            place.clone_into(&mut self.first);
        }
        for log in &moments.logs {
            let known = self.places.insert(log.content, (place.to_owned(), log.name.clone()));
            if let Some((before, name)) = known {
                return Err(twice(place, &log.name, &before, &name));
            }
        }
        match &mut self.total {
            Some(total) => total.add(moments),
            None => {
                self.total = Some(moments);
                Ok(())
            }
        }
    }
}

fn twice(place: &str, name: &str, before: &str, other: &str) -> IdentificationError {
    let message = if place == name && before == other {
        format!("it holds the same samples as {before}: give a log once")
    } else {
        format!(
            "the log {name} in it is the log {other} in {before}, sample by sample: leave out one of the two files"
        )
    };
    IdentificationError::File { place: place.into(), message }
}

/// Moments add up where everything that they were made with is the same.
fn require_same(first: &About, other: &About, before: &str, place: &str) -> Result<()> {
    let fault = |message: String| Err(IdentificationError::File { place: place.into(), message });
    if first.description != other.description {
        return fault(format!(
            "its moments belong to another description than those of {before}: reduce its logs again with the one \
             that is meant, and the same options of reading"
        ));
    }
    for ((mine, remedy), (theirs, _)) in made_with(first).into_iter().zip(made_with(other)) {
        if mine != theirs {
            return fault(format!("{theirs}; of {before}: {mine}. Reduce the logs {remedy}"));
        }
    }
    if first.widths != other.widths {
        return fault(format!(
            "its joints have other columns than those of {before}: reduce both with one gelenk"
        ));
    }
    Ok(())
}

/// Options by which moments were made, and how logs are reduced that agree in them.
fn made_with(about: &About) -> [(String, &'static str); 4] {
    let said = |option: &str, value: Option<String>| {
        let option =
            value.map_or_else(|| format!("without {option}"), |value| format!("with {option}{value}"));
        format!("it was reduced {option}")
    };
    let number = |value: Option<f64>| value.map(|value| format!(" {value:?}"));
    let compensated = about.gravity_compensated.then(String::new);
    [
        (format!("its efforts are {}", about.effort.plural()), "with one --effort"),
        (said("--gravity-compensated", compensated), "alike"),
        (said("--bandwidth", number(about.bandwidth)), "with the same one"),
        (said("--delay", number(about.delay)), "with the same one"),
    ]
}
