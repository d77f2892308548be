//! Reader of the tables of a bag in SQLite ([file format](https://sqlite.org/fileformat2.html)).

use super::bytes::Bytes;
use super::topics::Bag;

/// First bytes of an SQLite file.
pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";

const BROKEN: &str = "the SQLite file is incomplete: repair it with `sqlite3 FILE .recover`";

/// Reads all joint states of the file into `bag`.
pub(super) fn read(bytes: &[u8], bag: &mut Bag) -> Result<(), String> {
    let file = File::new(bytes).ok_or(BROKEN)?;
    let mut tables = [None; 2];
    file.rows(1, &mut |_, columns| {
        if let [Value::Bytes(b"table"), Value::Bytes(name), _, Value::Number(root), ..] = columns {
            let place = [&b"topics"[..], b"messages"].iter().position(|table| table == name);
            place.into_iter().for_each(|place| tables[place] = u32::try_from(*root).ok());
        }
        Ok(())
    })?;
    let [Some(topics), Some(messages)] = tables else {
        return Err("the SQLite file lacks the tables of a ROS 2 bag: give a bag".to_owned());
    };
    file.rows(topics, &mut |id, columns| {
        if let [_, Value::Bytes(name), Value::Bytes(kind), Value::Bytes(encoding), ..] = columns {
            let [name, kind, encoding] = [name, kind, encoding].map(|text| String::from_utf8_lossy(text));
            bag.topic(id, &name, &kind, &encoding);
        }
        Ok(())
    })?;
    file.rows(messages, &mut |_, columns| match columns {
        [_, Value::Number(topic), Value::Number(time), Value::Bytes(data), ..] => {
            bag.message(*topic, *time, data)
        }
        _ => Err("the SQLite file is not a ROS 2 bag, because its table of messages differs. Give a bag"
            .to_owned()),
    })
}

enum Value<'a> {
    Null,
    Number(i64),
    Bytes(&'a [u8]),
}

/// Function that is called with the number of a row and its columns.
type Visit<'v> = dyn FnMut(i64, &[Value<'_>]) -> Result<(), String> + 'v;

struct File<'a> {
    bytes: &'a [u8],
    page: usize,
    /// Number of bytes of a page without the reserved bytes at its end.
    usable: usize,
}

impl<'a> File<'a> {
    fn new(bytes: &'a [u8]) -> Option<Self> {
        let page = match u16::from_be_bytes(bytes.get(16..18)?.try_into().ok()?) {
            1 => 1 << 16,
            size => usize::from(size),
        };
        let usable = page.checked_sub(usize::from(*bytes.get(20)?)).filter(|usable| *usable >= 480)?;
        Some(Self { bytes, page, usable })
    }

    /// Returns the bytes of a page. Pages are counted from 1.
    fn page(&self, number: u32) -> Option<&'a [u8]> {
        let start = usize::try_from(number).ok()?.checked_sub(1)?.checked_mul(self.page)?;
        self.bytes.get(start..)?.get(..self.usable)
    }

    /// Calls `visit` for the rows of a table in their order.
    fn rows(&self, root: u32, visit: &mut Visit<'_>) -> Result<(), String> {
        let mut pages = vec![root];
        // In an intact file each page is visited once.
        let mut left = self.bytes.len() / self.page;
        while let Some(number) = pages.pop() {
            left = left.checked_sub(1).ok_or(BROKEN)?;
            let page = self.page(number).ok_or(BROKEN)?;
            let head = if number == 1 { 100 } else { 0 };
            let kind = page[head];
            let first = head + if kind == 5 { 12 } else { 8 };
            let count = usize::from(u16::from_be_bytes([page[head + 3], page[head + 4]]));
            let cells = page.get(first..first + 2 * count).ok_or(BROKEN)?.chunks_exact(2);
            let cells =
                cells.map(|at| page.get(usize::from(u16::from_be_bytes([at[0], at[1]]))..).map(Bytes));
            let cells = cells.collect::<Option<Vec<_>>>().ok_or(BROKEN)?;
            match kind {
                5 => {
                    let last = Bytes(&page[head + 8..]);
                    let children =
                        cells.into_iter().chain([last]).map(|mut cell| cell.array().map(u32::from_be_bytes));
                    let children = children.collect::<Option<Vec<_>>>().ok_or(BROKEN)?;
                    pages.extend(children.into_iter().rev());
                }
                13 => cells.into_iter().try_for_each(|cell| self.row(cell, visit))?,
                _ => return Err(BROKEN.to_owned()),
            }
        }
        Ok(())
    }

    fn row(&self, mut cell: Bytes<'a>, visit: &mut Visit<'_>) -> Result<(), String> {
        let (length, id) = varint(&mut cell).zip(varint(&mut cell)).ok_or(BROKEN)?;
        let payload = self.payload(cell, length).ok_or(BROKEN)?;
        visit(id, &columns(&payload).ok_or(BROKEN)?)
    }

    /// Returns the bytes of a row. Long rows continue on overflow pages.
    fn payload(&self, mut cell: Bytes<'a>, length: i64) -> Option<Vec<u8>> {
        let length = usize::try_from(length).ok().filter(|length| *length <= self.bytes.len())?;
        let most = self.usable - 35;
        let least = (self.usable - 12) * 32 / 255 - 23;
        let local = match least + length.saturating_sub(least) % (self.usable - 4) {
            _ if length <= most => length,
            local if local <= most => local,
            _ => least,
        };
        let mut payload = cell.take(local)?.to_vec();
        while payload.len() < length {
            cell = Bytes(self.page(u32::from_be_bytes(cell.array()?))?);
            let next = Bytes(cell.0);
            cell.take(4)?;
            payload.extend(cell.0.iter().take(length - payload.len()));
            cell = next;
        }
        Some(payload)
    }
}

/// Reads a number of up to nine bytes. Each byte except the ninth has seven bits of the number.
fn varint(bytes: &mut Bytes<'_>) -> Option<i64> {
    let mut number = 0_i64;
    for place in 0..9 {
        let [byte] = bytes.array()?;
        if place == 8 {
            return Some((number << 8) | i64::from(byte));
        }
        number = (number << 7) | i64::from(byte & 0x7f);
        if byte < 0x80 {
            break;
        }
    }
    Some(number)
}

fn columns(payload: &[u8]) -> Option<Vec<Value<'_>>> {
    let mut body = Bytes(payload);
    let length = usize::try_from(varint(&mut body)?).ok()?;
    let head = payload.get(..length)?;
    let mut kinds = Bytes(head.get(payload.len() - body.0.len()..)?);
    body = Bytes(&payload[length..]);
    let mut columns = Vec::new();
    while !kinds.0.is_empty() {
        columns.push(column(varint(&mut kinds)?, &mut body)?);
    }
    Some(columns)
}

fn column<'a>(kind: i64, body: &mut Bytes<'a>) -> Option<Value<'a>> {
    Some(match kind {
        0 => Value::Null,
        1..=6 => {
            let bytes = body.take([1, 2, 3, 4, 6, 8][usize::try_from(kind - 1).ok()?])?;
            let sign = if bytes[0] < 0x80 { 0 } else { -1 };
            Value::Number(bytes.iter().fold(sign, |number, byte| (number << 8) | i64::from(*byte)))
        }
        7 => {
            body.take(8)?;
            Value::Null
        }
        8 | 9 => Value::Number(kind - 8),
        12.. => Value::Bytes(body.take(usize::try_from((kind - 12) / 2).ok()?)?),
        _ => return None,
    })
}
