//! Reading CSV: one pass over the bytes, hashed as they come, parsed straight into columns.

use super::super::error::{IdentificationError, Result};
use super::check::{FindingKind, Findings, check_after};
use super::number::{Decimals, number};
use super::schema::{Column, LogSchema, Quantity};
use super::{Channel, Finding, Log};
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::Path;

impl Log {
    /// Reads a file; see [`Self::read`].
    ///
    /// # Errors
    /// As [`Self::read`], or a file that cannot be opened.
    pub fn open(path: &Path, schema: &LogSchema) -> Result<(Self, Vec<Finding>)> {
        let place = path.display().to_string();
        let file = std::fs::File::open(path)
            .map_err(|e| IdentificationError::File { place: place.clone(), message: e.to_string() })?;
        Self::read(file, &place, schema)
    }

    /// Reads CSV with a header row. Values become SI units; what is not a number becomes NaN and a
    /// [`Finding`].
    ///
    /// - `source`: name for messages and results
    /// - returns the log and everything suspicious in it, by row
    ///
    /// # Errors
    /// No rows, a mapped column that is missing, columns that something else than commas separates where the
    /// schema names no separator, or bytes that are no CSV.
    pub fn read(reader: impl Read, source: &str, schema: &LogSchema) -> Result<(Self, Vec<Finding>)> {
        let separator = u8::try_from(schema.separator.unwrap_or(',')).unwrap_or(b',');
        let mut reader = Hashing { inner: reader, hasher: Sha256::new() };
        let mut columns: Option<Vec<Column>> = None;
        let mut values: Vec<Vec<f64>> = Vec::new();
        let mut findings = Findings::default();
        let mut row = 0;
        records(&mut reader, separator, source, |_, record| {
            let Some(columns) = &columns else {
                let resolved = header(record, schema, source)?;
                values = vec![Vec::new(); resolved.len()];
                columns = Some(resolved);
                return Ok(());
            };
            for (column, values) in columns.iter().zip(&mut values) {
                values.push(field(record, column, row, &mut findings));
            }
            row += 1;
            Ok(())
        })?;
        if row == 0 {
            return Err(IdentificationError::Empty { what: format!("the log {source}") });
        }
        let hash = hexadecimal(&reader.hasher.finalize());
        let log = assemble(columns.unwrap_or_default(), values, hash, source);
        let findings = check_after(&log, findings);
        Ok((log, findings))
    }
}

/// Calls `each` with the fields of every row that is not empty, and the byte behind the row before it: the one place
/// where rows are read.
///
/// # Errors
/// What `each` returns, and what the reader does.
pub(super) fn records(
    reader: impl Read,
    separator: u8,
    source: &str,
    mut each: impl FnMut(u64, &csv::ByteRecord) -> Result<()>,
) -> Result<()> {
    let mut csv = csv::ReaderBuilder::new()
        .flexible(true)
        .has_headers(false)
        .delimiter(separator)
        .buffer_capacity(1 << 16)
        .from_reader(reader);
    let mut record = csv::ByteRecord::new();
    let fault = |e: csv::Error| IdentificationError::File { place: source.into(), message: e.to_string() };
    while csv.read_byte_record(&mut record).map_err(fault)? {
        each(record.position().map_or(0, csv::Position::byte), &record)?;
    }
    Ok(())
}

/// The columns that a header names.
fn header(record: &csv::ByteRecord, schema: &LogSchema, source: &str) -> Result<Vec<Column>> {
    let text = |field: &[u8]| String::from_utf8_lossy(field.trim_ascii()).into_owned();
    let headers: Vec<String> = record.iter().map(text).collect();
    if schema.separator.is_none() {
        require_commas(&headers, source)?;
    }
    let columns = schema.resolve(&headers)?;
    require_distinct(&columns)?;
    Ok(columns)
}

/// One number; NaN with a finding where there is none.
fn field(record: &csv::ByteRecord, column: &Column, row: usize, findings: &mut Findings) -> f64 {
    let Some(bytes) = record.get(column.index) else {
        findings
            .add(row, Some(&column.name), FindingKind::Missing, || "the row ends before this column".into());
        return f64::NAN;
    };
    let text = bytes.trim_ascii();
    if text.is_empty() {
        findings.add(row, Some(&column.name), FindingKind::Missing, || "the field is empty".into());
        return f64::NAN;
    }
    let Some(number) = number(text, Decimals::Point) else {
        let shown = String::from_utf8_lossy(&text[..text.len().min(40)]).into_owned();
        findings
            .add(row, Some(&column.name), FindingKind::NotANumber, || format!("`{shown}` is not a number"));
        return f64::NAN;
    };
    number * column.factor + column.offset
}

/// A header that is one field with semicolons or tabs in it belongs to a file separated by those.
fn require_commas(headers: &[String], source: &str) -> Result<()> {
    let [header] = headers else { return Ok(()) };
    match header.chars().find(|c| [';', '\t'].contains(c)) {
        None => Ok(()),
        Some(separator) => Err(IdentificationError::File {
            place: source.into(),
            message: format!(
                "no comma in the header, but {separator:?}: if that separates the columns, set `LogSchema::separator`; \
                 decimals have points"
            ),
        }),
    }
}

fn require_distinct(columns: &[Column]) -> Result<()> {
    for (i, column) in columns.iter().enumerate() {
        if columns[..i].iter().any(|c| c.name == column.name) {
            return Err(IdentificationError::Expression {
                text: column.name.clone(),
                message: "two columns have this name; map them to different names".into(),
            });
        }
    }
    Ok(())
}

fn assemble(columns: Vec<Column>, values: Vec<Vec<f64>>, hash: String, source: &str) -> Log {
    let rows = values.first().map_or(0, Vec::len);
    let mut starts = vec![0];
    if let Some(i) = columns.iter().position(|c| c.quantity == Quantity::Segment) {
        starts.extend((1..rows).filter(|&r| values[i][r].to_bits() != values[i][r - 1].to_bits()));
    }
    let ends = starts.iter().skip(1).copied().chain([rows]);
    let segments = starts.iter().copied().zip(ends).map(|(a, b)| a..b).collect();
    let channels = columns
        .into_iter()
        .zip(values)
        .map(|(c, values)| Channel {
            name: c.name,
            quantity: c.quantity,
            unit: c.unit,
            joint: c.joint,
            values,
        })
        .collect();
    Log { channels, segments, hash, source: source.into() }
}

struct Hashing<R> {
    inner: R,
    hasher: Sha256,
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.hasher.update(&buffer[..count]);
        Ok(count)
    }
}

/// SHA-256 in hexadecimal.
pub(super) fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(Log, Vec<Finding>)> {
        Log::read(text.as_bytes(), "test.csv", &LogSchema::default())
    }

    #[test]
    fn values_units_and_hash() {
        let (log, findings) = read("t,q1 [deg],u1\n0,180,1\n0.1,90,-2.5e-1\n0.2,0,0\n").unwrap();
        assert_eq!(log.channel("q1").unwrap()[0], std::f64::consts::PI);
        assert_eq!(log.channel("u1").unwrap(), [1.0, -0.25, 0.0]);
        assert_eq!(log.time().unwrap(), [0.0, 0.1, 0.2]);
        // From `printf 't,q1 [deg],u1\n0,180,1\n0.1,90,-2.5e-1\n0.2,0,0\n' | sha256sum`.
        assert_eq!(log.hash(), "e4e6b7f2f04511277405314903245d5e284deb52ce6ff55377a28660d5c602c1");
        assert!(findings.is_empty(), "{findings:?}");
    }

    #[test]
    fn unreadable_fields_are_reported_by_row() {
        let (log, findings) = read("t,q1\n0,1\n0.1,abc\n0.2,\n0.3\n0.4,5\n").unwrap();
        assert!(log.channel("q1").unwrap()[1..4].iter().all(|x| x.is_nan()));
        let text: Vec<String> = findings.iter().map(ToString::to_string).collect();
        assert!(text[0].starts_with("row 1, channel q1: `abc` is not a number"), "{text:?}");
        assert!(text[1].starts_with("rows 2 to 3, channel q1: the field is empty"), "{text:?}");
    }

    #[test]
    fn one_fault_is_one_finding() {
        let all = |text: &str| -> Vec<String> {
            let (_, findings) = read(text).unwrap();
            findings.iter().map(ToString::to_string).collect()
        };
        assert_eq!(
            all("t,q1\n0,1\n0.1,abc\n0.2,2\n0.3,inf\n"),
            ["row 1, channel q1: `abc` is not a number", "row 3, channel q1: the value is inf",]
        );
        assert_eq!(
            all("t,q1\n0,0\n0.1,x\n0.2,0\n"),
            ["row 1, channel q1: `x` is not a number", "row 0, channel q1: all 2 finite values of 3 are 0",]
        );
        assert_eq!(all("t,q1\n0,\n0.1,\n"), ["rows 0 to 1, channel q1: the field is empty"]);
        assert_eq!(
            all("t,q1\n0,\n0.1,NaN\n"),
            [
                "row 0, channel q1: the field is empty",
                "row 0, channel q1: none of 2 values is a finite number",
            ]
        );
    }

    #[test]
    fn empty_logs_and_repeated_headers_are_errors() {
        assert_eq!(
            read("t,q1\n").unwrap_err().to_string(),
            "the log test.csv is empty: there is nothing to identify from"
        );
        assert!(read("").unwrap_err().to_string().contains("empty"));
        assert!(read("a,a\n1,2\n").unwrap_err().to_string().contains("two columns have this name"));
    }

    #[test]
    fn other_separators_are_named() {
        for (text, separator) in [("t [s];q1 [rad]\n0;0\n", "';'"), ("t\tq1\n0\t0\n", "'\\t'")] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(&format!("no comma in the header, but {separator}")), "{message}");
        }
    }

    #[test]
    fn segments_follow_the_run_number() {
        let (log, findings) = read("run,t\n1,0\n1,0.1\n1,0.2\n7,0\n7,0.1\n7,0.2\n").unwrap();
        assert_eq!(log.segments(), [0..3, 3..6]);
        assert!(findings.is_empty(), "{findings:?}");
    }
}
