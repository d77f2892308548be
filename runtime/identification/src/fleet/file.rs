//! Moments as a file: a line with the version, the values in the format `postcard`, and the SHA-256 of both.

use super::super::error::{Result, at};
use super::super::estimation::JointSums;
use super::super::result::description::may_be_replaced;
use super::exact::Exact;
use super::logs::{Hash, LogMoments, ReducedLog, SHARES, Share};
use gelenk_files::write_whole;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;

/// First bytes of a file of moments in every version.
const MAGIC: &[u8] = b"gelenk moments ";
/// First line of a file of moments in this version.
const FIRST_LINE: &[u8] = b"gelenk moments 5\n";
/// Number of bytes of a SHA-256.
const HASH: usize = 32;
/// Largest size of a file that is read [bytes]. It is enough for a robot with several hundred joints.
const LARGEST: u64 = 1 << 30;

impl LogMoments {
    /// Reads a file of moments (sums of products of logs).
    ///
    /// # Errors
    /// [`IdentificationError::File`](crate::error::IdentificationError::File) if the file cannot be read, is not a file of
    /// moments, has another version, or was truncated or changed.
    pub fn read(path: &Path) -> Result<Self> {
        let place = path.display().to_string();
        let fault = |message: String| at(&place).fault(message);
        let size = fs::metadata(path).map_err(|e| fault(e.to_string()))?.len();
        if size > LARGEST {
            return Err(fault(format!(
                "it has {size} bytes, but a file of moments has at most {LARGEST}. Name another file"
            )));
        }
        Self::from_bytes(&fs::read(path).map_err(|e| fault(e.to_string()))?, &place)
    }

    /// Writes a file of moments. The file is written completely or not at all. It may be a new file, an empty file, or a
    /// file of moments.
    ///
    /// - `description`: source of the robot: contents of its files and the options for reading them
    ///
    /// # Errors
    /// [`IdentificationError::File`](crate::error::IdentificationError::File) if the moments belong to another description,
    /// if the file has other content, or if it cannot be written.
    pub fn write(&self, description: &[&[u8]], path: &Path) -> Result<()> {
        self.require_description(description)?;
        let fault =
            |message: String| at(path.display().to_string()).fault(format!("cannot be written: {message}"));
        if !may_be_replaced(path, MAGIC).map_err(|e| fault(e.to_string()))? {
            return Err(fault(
                "the existing file is not a file of moments. Name another file, or remove this one first"
                    .into(),
            ));
        }
        write_whole(path, self.bytes()).map_err(|e| fault(e.to_string()))
    }

    /// The bytes of the file. They do not depend on the order in which logs were added.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        // Writing to memory does not fail, and the lengths of all lists are known.
        let mut bytes = postcard::to_extend(self, FIRST_LINE.to_vec()).unwrap_or_default();
        let hash = Sha256::digest(&bytes);
        bytes.extend(hash);
        bytes
    }

    /// Moments from the bytes of a file.
    ///
    /// - `place`: name of the file in messages
    ///
    /// # Errors
    /// [`IdentificationError::File`](crate::error::IdentificationError::File) if the bytes are not those of a file of moments,
    /// have another version, or were truncated or changed.
    pub(crate) fn from_bytes(bytes: &[u8], place: &str) -> Result<Self> {
        let fault = |message: &str| at(place).fault(message);
        if !bytes.starts_with(MAGIC) {
            return Err(fault(
                "it is not a file of moments: make one with `gelenk identify DESCRIPTION --reduce LOG.csv`",
            ));
        }
        if !bytes.starts_with(FIRST_LINE) {
            return Err(fault(
                "this version of gelenk reads only version 5 of the format. Reduce the logs again with this version",
            ));
        }
        let altered = || {
            fault("it was cut off or changed after it was written. Copy it again, or reduce its logs again")
        };
        let (content, hash) =
            bytes.split_at_checked(bytes.len() - HASH.min(bytes.len())).ok_or_else(altered)?;
        if content.len() < FIRST_LINE.len() || Sha256::digest(content).as_slice() != hash {
            return Err(altered());
        }
        let found = postcard::take_from_bytes(&content[FIRST_LINE.len()..]).ok();
        let found = found.filter(|(found, rest)| Self::is_consistent(found) && rest.is_empty());
        let (found, _) = found.ok_or_else(|| fault("its content is inconsistent: reduce its logs again"))?;
        Ok(found)
    }

    fn is_consistent(&self) -> bool {
        let logs_ascend = self.logs.windows(2).all(|pair| pair[0].hash < pair[1].hash);
        let doubts_ascend = self.doubts.windows(2).all(|pair| pair[0].place() < pair[1].place());
        let add = |sum: u64, n: u64| sum.checked_add(n);
        let samples = self.logs.iter().map(|log| log.samples).try_fold(0, add);
        let in_shares = self.shares.iter().map(|share| share.samples).try_fold(0, add);
        let same = samples.is_some() && samples == in_shares;
        let numbers =
            |log: &ReducedLog| [log.seconds, log.bandwidth, log.delays[0], log.delays[1], log.correlation];
        let are_finite = self.logs.iter().flat_map(numbers).all(f64::is_finite);
        let widths = &self.about.widths;
        let sizes = self.joints.len() == widths.len() && self.shares.len() == SHARES;
        let shares = self.shares.iter().all(|share| is_possible(share, widths));
        logs_ascend && doubts_ascend && are_finite && same && sizes && shares && !self.logs.is_empty()
    }
}

/// Whether the sums of a share may come from logs. `widths` are the numbers of columns of the joints.
fn is_possible(share: &Share, widths: &[usize]) -> bool {
    let widths = if share.samples == 0 { &[] } else { widths };
    let mut joints = share.joints.iter().zip(widths);
    share.joints.len() == widths.len() && joints.all(|(joint, width)| are_possible(joint, *width))
}

/// Whether the sums of a joint may come from a log. Squares and weights must not be negative. If the weight is zero, no log
/// has the effort of the joint, and all sums must be zero.
fn are_possible(sums: &JointSums<Exact>, width: usize) -> bool {
    let size = width.checked_add(1).and_then(|next| width.checked_mul(next));
    if size.is_none_or(|size| size / 2 != sums.products.len()) {
        return false;
    }
    let squares = (0..width).map(|row| sums.products[row * (row + 3) / 2]).chain(sums.lost);
    let is_empty = || sums.products.iter().all(|product| product.value() == 0.0);
    let weight = sums.weight.value();
    (weight > 0.0 || weight == 0.0 && is_empty()) && squares.into_iter().all(|square| square.value() >= 0.0)
}

/// SHA-256 of the contents of files and of the options for reading them. Moments identify their description
/// by this hash. The hash does not depend on paths.
pub(super) fn hash_of(parts: &[&[u8]]) -> Hash {
    let mut hasher = Sha256::new();
    for part in parts {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().into()
}
