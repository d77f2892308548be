//! Moments as bytes: a line with the version, the values in little-endian order, and the SHA-256 of all of it.

use super::super::error::{IdentificationError, Result};
use super::super::log::hexadecimal;
use super::super::result::description::may_be_replaced;
use super::super::run::Effort;
use super::exact::Exact;
use super::logs::{About, Doubt, Hash, JointFacts, JointSums, LogMoments, ReducedLog, SHARES, Share};
use gelenk_files::write_whole;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;

/// First bytes of every version.
const MAGIC: &[u8] = b"gelenk moments ";
/// First line of this version.
const FIRST_LINE: &[u8] = b"gelenk moments 2\n";
/// Bytes of a SHA-256.
const HASH: usize = 32;
/// Largest file that is read: that of a robot with some hundred joints.
const LARGEST: u64 = 1 << 30;

impl LogMoments {
    /// Reads a file of moments.
    ///
    /// # Errors
    /// A file that cannot be read, holds something else, has another version, or was cut off or changed.
    pub fn read(path: &Path) -> Result<Self> {
        let place = path.display().to_string();
        let fault = |message: String| IdentificationError::File { place: place.clone(), message };
        let size = fs::metadata(path).map_err(|e| fault(e.to_string()))?.len();
        if size > LARGEST {
            return Err(fault(format!("{size} bytes are more than moments have ({LARGEST})")));
        }
        Self::from_bytes(&fs::read(path).map_err(|e| fault(e.to_string()))?, &place)
    }

    /// Writes a file of moments, whole or not at all: a new file, an empty one, or one that holds moments.
    ///
    /// - `description`: as for [`super::reduce()`]
    ///
    /// # Errors
    /// Moments of another description, a file that holds something else, or that cannot be written.
    pub fn write(&self, description: &[&[u8]], path: &Path) -> Result<()> {
        self.require_description(description)?;
        let fault = |message: String| IdentificationError::File {
            place: path.display().to_string(),
            message: format!("cannot be written: {message}"),
        };
        if !may_be_replaced(path, MAGIC).map_err(|e| fault(e.to_string()))? {
            return Err(fault("it holds no moments; name another file, or remove it first".into()));
        }
        write_whole(path, self.bytes()).map_err(|e| fault(e.to_string()))
    }

    /// The file's bytes: the same for the same logs, in whatever order they were added.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bytes = FIRST_LINE.to_vec();
        self.about.write(&mut bytes);
        count(self.logs.len(), &mut bytes);
        self.logs.iter().for_each(|log| log.write(&mut bytes));
        count(self.doubts.len(), &mut bytes);
        self.doubts.iter().for_each(|doubt| doubt.write(&mut bytes));
        self.joints.iter().for_each(|joint| joint.write(&mut bytes));
        for share in &self.shares {
            bytes.extend(share.samples.to_le_bytes());
            share.joints.iter().for_each(|joint| joint.write(&mut bytes));
        }
        let hash = Sha256::digest(&bytes);
        bytes.extend(hash);
        bytes
    }

    /// Moments of a file's bytes; `place` names them in messages.
    ///
    /// # Errors
    /// Bytes that do not hold moments, have another version, or are cut off or changed.
    pub(crate) fn from_bytes(bytes: &[u8], place: &str) -> Result<Self> {
        let fault =
            |message: &str| IdentificationError::File { place: place.into(), message: message.into() };
        if !bytes.starts_with(MAGIC) {
            return Err(fault(
                "it holds no moments: make them with `gelenk identify DESCRIPTION --reduce LOG.csv`",
            ));
        }
        if !bytes.starts_with(FIRST_LINE) {
            return Err(fault(
                "its moments are of another version than 2, which is all that this gelenk reads: reduce the logs again \
                 with this gelenk",
            ));
        }
        let altered = || {
            fault("it was cut off or changed after it was written: copy it again, or reduce its logs again")
        };
        let (content, hash) =
            bytes.split_at_checked(bytes.len() - HASH.min(bytes.len())).ok_or_else(altered)?;
        if content.len() < FIRST_LINE.len() || Sha256::digest(content).as_slice() != hash {
            return Err(altered());
        }
        let mut reader = Reader { rest: &content[FIRST_LINE.len()..] };
        let found = Self::parse(&mut reader).filter(|_| reader.rest.is_empty());
        found.ok_or_else(|| fault("its content contradicts itself: reduce its logs again"))
    }

    fn parse(reader: &mut Reader) -> Option<Self> {
        let about = About::parse(reader)?;
        let logs = reader.list(ReducedLog::parse)?;
        let doubts = reader.list(Doubt::parse)?;
        let joints: Option<Vec<_>> = about.widths.iter().map(|_| JointFacts::parse(reader)).collect();
        let shares: Option<Vec<_>> = (0..SHARES).map(|_| Share::parse(reader, &about.widths)).collect();
        let found = Self { about, logs, doubts, joints: joints?, shares: shares? };
        found.is_consistent().then_some(found)
    }

    fn is_consistent(&self) -> bool {
        let logs_ascend = self.logs.windows(2).all(|pair| pair[0].hash < pair[1].hash);
        let doubts_ascend = self.doubts.windows(2).all(|pair| pair[0].place() < pair[1].place());
        let add = |sum: u64, n: u64| sum.checked_add(n);
        let samples = self.logs.iter().map(|log| log.samples).try_fold(0, add);
        let in_shares = self.shares.iter().map(|share| share.samples).try_fold(0, add);
        let same = samples.is_some() && samples == in_shares;
        logs_ascend && doubts_ascend && same && !self.logs.is_empty()
    }
}

fn count(n: usize, bytes: &mut Vec<u8>) {
    bytes.extend((n as u64).to_le_bytes());
}

fn text(content: &str, bytes: &mut Vec<u8>) {
    count(content.len(), bytes);
    bytes.extend(content.as_bytes());
}

fn floats(values: &[f64], bytes: &mut Vec<u8>) {
    values.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
}

fn option(value: Option<f64>, bytes: &mut Vec<u8>) {
    bytes.push(u8::from(value.is_some()));
    floats(&[value.unwrap_or(0.0)], bytes);
}

fn exacts(values: &[Exact], bytes: &mut Vec<u8>) {
    values.iter().for_each(|value| value.write(bytes));
}

/// Unread rest of the bytes. A read fails if too little is left; nothing is allocated beyond it.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(head)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn u8(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    fn flag(&mut self) -> Option<bool> {
        match self.u8()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn count(&mut self) -> Option<usize> {
        usize::try_from(self.u64()?).ok()
    }

    fn finite(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes).filter(|x| x.is_finite())
    }

    fn option(&mut self) -> Option<Option<f64>> {
        let (is_some, value) = (self.flag()?, self.finite()?);
        Some(is_some.then_some(value))
    }

    fn text(&mut self) -> Option<String> {
        let length = self.count()?;
        String::from_utf8(self.take(length)?.to_vec()).ok()
    }

    fn exact(&mut self) -> Option<Exact> {
        let [zeros, length] = self.array()?;
        Exact::read(zeros, self.take(usize::from(length))?)
    }

    fn exacts<const N: usize>(&mut self) -> Option<[Exact; N]> {
        let mut all = [Exact::default(); N];
        for place in &mut all {
            *place = self.exact()?;
        }
        Some(all)
    }

    fn list<T>(&mut self, parse: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let length = self.count()?;
        // Each entry takes at least a byte.
        (length <= self.rest.len()).then(|| (0..length).map(|_| parse(self)).collect())?
    }
}

impl About {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.description);
        bytes.push(match self.effort {
            Effort::Joint => 0,
            Effort::Input => 1,
            Effort::Current => 2,
        });
        bytes.push(u8::from(self.gravity_compensated));
        option(self.bandwidth, bytes);
        option(self.delay, bytes);
        count(self.widths.len(), bytes);
        self.widths.iter().for_each(|width| count(*width, bytes));
    }

    fn parse(reader: &mut Reader) -> Option<Self> {
        Some(Self {
            description: reader.array()?,
            effort: match reader.u8()? {
                0 => Effort::Joint,
                1 => Effort::Input,
                2 => Effort::Current,
                _ => return None,
            },
            gravity_compensated: reader.flag()?,
            bandwidth: reader.option()?,
            delay: reader.option()?,
            widths: reader.list(Reader::count)?,
        })
    }
}

impl ReducedLog {
    fn write(&self, bytes: &mut Vec<u8>) {
        text(&self.name, bytes);
        bytes.extend(self.hash);
        bytes.extend(self.content);
        bytes.extend(self.samples.to_le_bytes());
        let [least, largest] = self.delays;
        floats(&[self.seconds, self.bandwidth, least, largest, self.correlation], bytes);
    }

    fn parse(reader: &mut Reader) -> Option<Self> {
        Some(Self {
            name: reader.text()?,
            hash: reader.array::<HASH>()? as Hash,
            content: reader.array::<HASH>()? as Hash,
            samples: reader.u64()?,
            seconds: reader.finite()?,
            bandwidth: reader.finite()?,
            delays: [reader.finite()?, reader.finite()?],
            correlation: reader.finite()?,
        })
    }
}

impl Doubt {
    fn write(&self, bytes: &mut Vec<u8>) {
        // 0 is none.
        bytes.extend(self.joint.map_or(0, |joint| joint + 1).to_le_bytes());
        text(&self.kind, bytes);
        bytes.extend(self.logs.to_le_bytes());
        let (hash, name, sentence) = &self.first;
        bytes.extend(hash);
        text(name, bytes);
        text(sentence, bytes);
    }

    fn parse(reader: &mut Reader) -> Option<Self> {
        Some(Self {
            joint: reader.array().map(u32::from_le_bytes)?.checked_sub(1),
            kind: reader.text()?,
            logs: reader.u64()?,
            first: (reader.array()?, reader.text()?, reader.text()?),
        })
    }
}

impl JointFacts {
    fn write(&self, bytes: &mut Vec<u8>) {
        let [slowest, fastest] = self.velocities;
        floats(&[self.span, slowest, fastest, self.largest_friction], bytes);
        self.beyond.iter().for_each(|count| bytes.extend(count.to_le_bytes()));
        exacts(&self.directions, bytes);
    }

    fn parse(reader: &mut Reader) -> Option<Self> {
        Some(Self {
            span: reader.finite()?,
            velocities: [reader.finite()?, reader.finite()?],
            largest_friction: reader.finite()?,
            beyond: [reader.u64()?, reader.u64()?],
            directions: reader.exacts()?,
        })
    }
}

impl Share {
    fn parse(reader: &mut Reader, widths: &[usize]) -> Option<Self> {
        let samples = reader.u64()?;
        let widths = if samples == 0 { &[] } else { widths };
        let joints: Option<Vec<_>> = widths.iter().map(|width| JointSums::parse(reader, *width)).collect();
        Some(Self { samples, joints: joints? })
    }
}

impl JointSums {
    fn write(&self, bytes: &mut Vec<u8>) {
        exacts(&[self.weight, self.lost[0], self.lost[1]], bytes);
        exacts(&self.products, bytes);
    }

    fn parse(reader: &mut Reader, width: usize) -> Option<Self> {
        let [weight, lost @ ..] = reader.exacts::<3>()?;
        let mut products = Vec::new();
        for row in 0..width {
            for column in 0..=row {
                let product = reader.exact()?;
                // A square is not negative, and no more is a weight.
                if row == column && product.value() < 0.0 {
                    return None;
                }
                products.push(product);
            }
        }
        // Without weight there is nothing: the effort of the joint is in no log.
        let is_empty = || products.iter().all(|product| product.value() == 0.0);
        let weighs = weight.value() > 0.0 || weight.value() == 0.0 && is_empty();
        (weighs && lost.iter().all(|x| x.value() >= 0.0)).then_some(Self { weight, lost, products })
    }
}

/// SHA-256 of files' contents and of the words on how they are read, in hexadecimal: what moments know their
/// description by. Paths do not count.
pub(super) fn hash_of(parts: &[&[u8]]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hexadecimal(&hasher.finalize())
}
