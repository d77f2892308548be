//! Moments as a file: a line with the version, the values in little-endian order, and the SHA-256 of both.

use super::super::error::{Result, at};
use super::super::result::description::may_be_replaced;
use super::super::run::Effort;
use super::exact::Exact;
use super::logs::{
    About, Doubt, DoubtedLog, Hash, JointFacts, JointSums, LogMoments, ReducedLog, SHARES, Share,
};
use gelenk_files::write_whole;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;

/// First bytes of a file of moments in every version.
const MAGIC: &[u8] = b"gelenk moments ";
/// First line of a file of moments in this version.
const FIRST_LINE: &[u8] = b"gelenk moments 4\n";
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
        let mut bytes = FIRST_LINE.to_vec();
        self.put(&mut bytes);
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
                "this version of gelenk reads only version 4 of the format. Reduce the logs again with this version",
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
        let mut rest = &content[FIRST_LINE.len()..];
        let found = Self::take(&mut rest).filter(Self::is_consistent);
        let found = found.filter(|_| rest.is_empty());
        found.ok_or_else(|| fault("its content is inconsistent: reduce its logs again"))
    }

    fn is_consistent(&self) -> bool {
        let logs_ascend = self.logs.windows(2).all(|pair| pair[0].hash < pair[1].hash);
        let doubts_ascend = self.doubts.windows(2).all(|pair| pair[0].place() < pair[1].place());
        let add = |sum: u64, n: u64| sum.checked_add(n);
        let samples = self.logs.iter().map(|log| log.samples).try_fold(0, add);
        let in_shares = self.shares.iter().map(|share| share.samples).try_fold(0, add);
        let same = samples.is_some() && samples == in_shares;
        let widths = &self.about.widths;
        let sizes = self.joints.len() == widths.len() && self.shares.len() == SHARES;
        let shares = self.shares.iter().all(|share| share.is_consistent(widths));
        logs_ascend && doubts_ascend && same && sizes && shares && !self.logs.is_empty()
    }
}

impl Share {
    fn is_consistent(&self, widths: &[usize]) -> bool {
        let widths = if self.samples == 0 { &[] } else { widths };
        let mut joints = self.joints.iter().zip(widths);
        self.joints.len() == widths.len() && joints.all(|(joint, width)| joint.is_consistent(*width))
    }
}

impl JointSums {
    /// Whether the sums may come from a log. Squares and weights must not be negative. If the weight is zero, no log has the
    /// effort of the joint, and all sums must be zero.
    fn is_consistent(&self, width: usize) -> bool {
        let size = width.checked_add(1).and_then(|next| width.checked_mul(next));
        if size.is_none_or(|size| size / 2 != self.products.len()) {
            return false;
        }
        let squares = (0..width).map(|row| self.products[row * (row + 3) / 2]).chain(self.lost);
        let is_empty = || self.products.iter().all(|product| product.value() == 0.0);
        let weight = self.weight.value();
        (weight > 0.0 || weight == 0.0 && is_empty())
            && squares.into_iter().all(|square| square.value() >= 0.0)
    }
}

/// A value in the file of moments.
trait Stored: Sized {
    fn put(&self, bytes: &mut Vec<u8>);

    /// Reads a value from the beginning of `rest` and removes its bytes; `None` if the bytes are not a valid value. The
    /// allocated memory is limited by the number of bytes.
    fn take(rest: &mut &[u8]) -> Option<Self>;
}

/// Implements [`Stored`] for structs, field after field.
macro_rules! stored {
    ($($kind:ty { $($field:ident),* })*) => {$(
        impl Stored for $kind {
            fn put(&self, bytes: &mut Vec<u8>) {
                $(self.$field.put(bytes);)*
            }

            fn take(rest: &mut &[u8]) -> Option<Self> {
                Some(Self { $($field: Stored::take(rest)?),* })
            }
        }
    )*};
}

stored! {
    LogMoments { about, logs, doubts, joints, shares }
    About { description, effort, gravity_compensated, bandwidth, delay, widths }
    ReducedLog { name, hash, content, samples, seconds, bandwidth, delays, correlation }
    Doubt { joint, kind, logs, first }
    DoubtedLog { hash, name, text }
    JointFacts { span, velocities, directions }
    Share { samples, joints }
    JointSums { weight, lost, products }
}

impl Stored for u8 {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.push(*self);
    }

    fn take(rest: &mut &[u8]) -> Option<Self> {
        rest.split_off_first().copied()
    }
}

/// Implements [`Stored`] for types that are stored as another type.
macro_rules! stored_as {
    ($($kind:ty as $other:ty: $there:expr, $back:expr;)*) => {$(
        impl Stored for $kind {
            fn put(&self, bytes: &mut Vec<u8>) {
                let there: fn(&Self) -> $other = $there;
                there(self).put(bytes);
            }

            fn take(rest: &mut &[u8]) -> Option<Self> {
                let back: fn($other) -> Option<Self> = $back;
                <$other>::take(rest).and_then(back)
            }
        }
    )*};
}

/// Kinds of efforts in the order of their numbers in the file.
const EFFORTS: [Effort; 3] = [Effort::Joint, Effort::Input, Effort::Current];

stored_as! {
    u64 as [u8; 8]: |n| n.to_le_bytes(), |bytes| Some(Self::from_le_bytes(bytes));
    f64 as [u8; 8]: |x| x.to_le_bytes(), |bytes| Some(Self::from_le_bytes(bytes)).filter(|x| x.is_finite());
    usize as u64: |n| *n as u64, |n| n.try_into().ok();
    u32 as u64: |n| u64::from(*n), |n| n.try_into().ok();
    bool as u8: |is| u8::from(*is), |byte| (byte < 2).then_some(byte == 1);
    String as Vec<u8>: |text| text.clone().into_bytes(), |bytes| String::from_utf8(bytes).ok();
    Effort as u8: |effort| EFFORTS.iter().position(|kind| kind == effort).unwrap_or_default() as u8,
        |byte| EFFORTS.get(usize::from(byte)).copied();
}

impl<T: Stored, const N: usize> Stored for [T; N] {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|value| value.put(bytes));
    }

    fn take(rest: &mut &[u8]) -> Option<Self> {
        let all: Option<Vec<T>> = (0..N).map(|_| T::take(rest)).collect();
        all?.try_into().ok()
    }
}

impl<T: Stored> Stored for Vec<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.len().put(bytes);
        self.iter().for_each(|value| value.put(bytes));
    }

    fn take(rest: &mut &[u8]) -> Option<Self> {
        let length = usize::take(rest)?;
        // Each entry has at least one byte.
        (length <= rest.len()).then(|| (0..length).map(|_| T::take(rest)).collect())?
    }
}

impl<T: Stored> Stored for Option<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.is_some().put(bytes);
        self.iter().for_each(|value| value.put(bytes));
    }

    fn take(rest: &mut &[u8]) -> Option<Self> {
        if bool::take(rest)? { T::take(rest).map(Some) } else { Some(None) }
    }
}

impl Stored for Exact {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.write(bytes);
    }

    fn take(rest: &mut &[u8]) -> Option<Self> {
        let [zeros, length] = Stored::take(rest)?;
        Self::read(zeros, rest.split_off(..usize::from(length))?)
    }
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
