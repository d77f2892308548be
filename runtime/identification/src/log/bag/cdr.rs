//! Decoder of messages `sensor_msgs/msg/JointState` in CDR (OMG, *DDS-RTPS*, section 10, encodings `CDR_BE` and `CDR_LE`).

use super::bytes::Bytes;

/// A message has fewer bytes of padding at its end than this number.
const PADDING: usize = 8;

/// A message `sensor_msgs/msg/JointState`. A list of values is empty, or it has one value for each name.
#[derive(Debug, PartialEq)]
pub(super) struct JointState {
    /// Time stamp in seconds and nanoseconds.
    pub(super) stamp: (i32, u32),
    pub(super) names: Vec<String>,
    /// Lists of positions, velocities and efforts of the message.
    pub(super) values: [Vec<f64>; 3],
}

impl JointState {
    /// Decodes a message; `None` if the bytes are not a message of this type.
    pub(super) fn decode(bytes: &[u8]) -> Option<Self> {
        let mut rest = Bytes(bytes);
        let is_little = match rest.array::<4>()? {
            [0, 0, ..] => false,
            [0, 1, ..] => true,
            _ => return None,
        };
        let mut cdr = Cdr { length: rest.0.len(), rest, is_little };
        let stamp = (cdr.number()?.cast_signed(), cdr.number()?);
        cdr.text()?;
        let names = (0..cdr.number()?).map(|_| cdr.text()).collect::<Option<Vec<_>>>()?;
        let mut values = [cdr.doubles()?, cdr.doubles()?, cdr.doubles()?];
        // A list whose length differs from the number of names is dropped.
        values.iter_mut().filter(|list| list.len() != names.len()).for_each(Vec::clear);
        let is_whole = cdr.rest.0.len() < PADDING;
        is_whole.then_some(Self { stamp, names, values })
    }
}

/// Reader of values that are aligned to multiples of their size, counted from the first value.
struct Cdr<'a> {
    rest: Bytes<'a>,
    length: usize,
    is_little: bool,
}

impl Cdr<'_> {
    fn item<const SIZE: usize>(&mut self) -> Option<[u8; SIZE]> {
        let at = self.length - self.rest.0.len();
        self.rest.take(at.next_multiple_of(SIZE) - at)?;
        let mut item: [u8; SIZE] = self.rest.array()?;
        if !self.is_little {
            item.reverse();
        }
        Some(item)
    }

    fn number(&mut self) -> Option<u32> {
        self.item().map(u32::from_le_bytes)
    }

    /// Reads a string that ends with a zero byte.
    fn text(&mut self) -> Option<String> {
        let count = usize::try_from(self.number()?).ok()?;
        let (_, text) = self.rest.take(count)?.split_last()?;
        String::from_utf8(text.to_vec()).ok()
    }

    fn doubles(&mut self) -> Option<Vec<f64>> {
        (0..self.number()?).map(|_| self.item().map(f64::from_le_bytes)).collect()
    }
}
