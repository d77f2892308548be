//! Reader of MCAP files ([specification](https://mcap.dev/spec)).

use super::super::packed::{LARGEST, unpacked};
use super::bytes::Bytes;
use super::topics::Bag;
use std::borrow::Cow;
use std::collections::BTreeMap;

const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const END_OF_DATA: u8 = 15;

/// First bytes of an MCAP file.
pub(super) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Reads all joint states of the file into `bag`.
pub(super) fn read(bytes: &[u8], bag: &mut Bag) -> Result<(), String> {
    let mut schemas = BTreeMap::new();
    let records = bytes.get(MAGIC.len()..).unwrap_or_default();
    read_records(records, &mut schemas, bag, false)
}

fn read_records(
    bytes: &[u8],
    schemas: &mut BTreeMap<u16, String>,
    bag: &mut Bag,
    is_chunk: bool,
) -> Result<(), String> {
    let cut = || "the MCAP file ends within a record: repair it with `mcap recover`".to_owned();
    let mut rest = Bytes(bytes);
    while !rest.0.is_empty() {
        let (kind, record) = record(&mut rest).ok_or_else(cut)?;
        match kind {
            SCHEMA => {
                let (id, name) = schema(record).ok_or_else(cut)?;
                schemas.insert(id, name);
            }
            CHANNEL => channel(record, schemas, bag).ok_or_else(cut)?,
            MESSAGE => {
                let (id, time, data) = message(record).ok_or_else(cut)?;
                bag.message(id.into(), time, data)?;
            }
            CHUNK if !is_chunk => {
                let (packing, size, records) = chunk(record).ok_or_else(cut)?;
                let records = match &*packing {
                    "" => Cow::Borrowed(records),
                    "zstd" | "lz4" => unpacked(records, size.min(LARGEST))?,
                    _ => {
                        return Err(format!(
                            "the chunks of the MCAP file are compressed with `{packing}`. Record it with zstd or lz4, or without \
                             compression"
                        ));
                    }
                };
                read_records(&records, schemas, bag, true)?;
            }
            END_OF_DATA => return Ok(()),
            _ => {}
        }
    }
    Ok(())
}

fn record<'a>(rest: &mut Bytes<'a>) -> Option<(u8, Bytes<'a>)> {
    let [kind] = rest.array()?;
    let length = u64::from_le_bytes(rest.array()?);
    Some((kind, Bytes(rest.take(usize::try_from(length).ok()?)?)))
}

fn schema(mut record: Bytes<'_>) -> Option<(u16, String)> {
    Some((u16::from_le_bytes(record.array()?), record.text()?.into_owned()))
}

fn channel(mut record: Bytes<'_>, schemas: &BTreeMap<u16, String>, bag: &mut Bag) -> Option<()> {
    let [id, schema] = [record.array()?, record.array()?].map(u16::from_le_bytes);
    let (topic, encoding) = (record.text()?, record.text()?);
    bag.topic(id.into(), &topic, schemas.get(&schema).map_or("", String::as_str), &encoding);
    Some(())
}

fn message<'a>(mut record: Bytes<'a>) -> Option<(u16, i64, &'a [u8])> {
    let id = u16::from_le_bytes(record.array()?);
    record.take(4)?;
    let time = i64::from_le_bytes(record.array()?);
    record.take(8)?;
    Some((id, time, record.0))
}

/// Returns the compression of the records of a chunk, their uncompressed size, and the records.
fn chunk<'a>(mut record: Bytes<'a>) -> Option<(Cow<'a, str>, u64, &'a [u8])> {
    record.take(8 + 8)?;
    let size = u64::from_le_bytes(record.array()?);
    record.take(4)?;
    let packing = record.text()?;
    let length = u64::from_le_bytes(record.array()?);
    Some((packing, size, record.take(usize::try_from(length).ok()?)?))
}
