//! Detection of the format of a table: field separator, decimal sign, header, and first row of numbers.

use super::super::error::{Result, at};
use super::number::{Decimals, number};
use super::units;
use std::borrow::Cow;

/// Text that was recognized as a table. [`Self::rows`] reads its rows.
#[derive(Debug)]
pub(super) struct Sheet<'a> {
    /// Headers of the columns, without the row of units; empty if the file has no header.
    pub headers: Vec<String>,
    /// Units in a row below the header; `None` for a column without a unit in this row.
    pub units: Vec<Option<String>>,
    /// Number of fields in a row of numbers.
    pub width: usize,
    /// Character that separates the fields.
    pub separator: u8,
    /// Decimal sign of the numbers.
    pub decimals: Decimals,
    /// Fields of the first row of numbers, for messages and for names of joints.
    pub first: Vec<String>,
    /// Fields of several rows at the beginning of the numbers.
    pub sample: Vec<Vec<String>>,
    body: Cow<'a, [u8]>,
    /// Line of the first row of numbers, counted from 1.
    line: usize,
}

/// A counter of lines. The count of the CSV reader does not include the empty lines that it skips before a row.
struct Lines<'t> {
    text: &'t [u8],
    at: usize,
    line: usize,
}

impl Lines<'_> {
    /// Returns the line of the first row at or after `byte`. `byte` must increase from call to call.
    fn line_from(&mut self, byte: u64) -> usize {
        let byte = usize::try_from(byte).unwrap_or(usize::MAX);
        while let Some(&sign) = self.text.get(self.at)
            && (self.at < byte || sign == b'\n' || sign == b'\r')
        {
            self.line += usize::from(sign == b'\n');
            self.at += 1;
        }
        self.line
    }
}

/// Largest number of lines of a row. A row with more lines has a quotation mark that is not closed.
const MOST_LINES_OF_A_ROW: usize = 50;

/// Largest number of columns. A table with more columns is not a log of a robot.
const MOST_COLUMNS: usize = 20_000;

/// Number of lines from which the format of a file is detected.
const SAMPLE: usize = 600;

impl<'a> Sheet<'a> {
    /// Detects the format of a file's text.
    ///
    /// - `separator`: field separator; `None` detects it
    /// - `source`: name of the file in messages
    ///
    /// # Errors
    /// [`IdentificationError::File`](crate::error::IdentificationError::File) if the bytes are not text, if there are no
    /// rows of numbers, or if the header does not fit its rows.
    pub(super) fn new(bytes: &'a [u8], separator: Option<char>, source: &str) -> Result<Self> {
        let fault = |message: String| at(source).fault(message);
        refuse_binary(bytes).map_err(fault)?;
        let text = unify_line_ends(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
        let lines = sample(&text);
        let separator = match separator {
            Some(known) => u8::try_from(known).map_err(|_| {
                fault(format!("{known:?} cannot separate fields, because it is not an ASCII character"))
            })?,
            None => guess_separator(&lines).ok_or_else(|| fault(nothing(&lines)))?,
        };
        let body_of = |start: usize| match (separator, &text) {
            (b' ', text) => Cow::Owned(collapse_blanks(&text[start..])),
            (_, Cow::Borrowed(text)) => Cow::Borrowed(&text[start..]),
            (_, Cow::Owned(text)) => Cow::Owned(text[start..].to_vec()),
        };
        let split: Vec<Vec<String>> = lines.iter().map(|l| fields(l.text, separator)).collect();
        let data = first_data(&lines, &split).ok_or_else(|| fault(nothing(&lines)))?;
        let (headers, units) = header(&lines, &split, data);
        let sheet = Self {
            headers,
            units: units.iter().map(|f| unit_field(f)).collect(),
            width: split[data].len(),
            separator: if separator == b' ' { b'\t' } else { separator },
            decimals: decimals(&lines, &split),
            first: split[data].clone(),
            sample: split[data..].iter().take(50).cloned().collect(),
            body: body_of(lines[data].start),
            line: lines[data].number,
        };
        if sheet.width.max(sheet.headers.len()) > MOST_COLUMNS {
            return Err(fault(format!(
                "the table has more than {MOST_COLUMNS} columns: export only the columns of the robot"
            )));
        }
        sheet.require_alignment().map_err(fault)?;
        Ok(sheet)
    }

    /// Calls `each` for every row of numbers, with its line (counted from 1) and its fields.
    ///
    /// # Errors
    /// The errors of `each`, and [`IdentificationError::File`](crate::error::IdentificationError::File) for bytes that are
    /// not rows
    pub(super) fn rows(
        &self,
        source: &str,
        mut each: impl FnMut(usize, &csv::ByteRecord) -> Result<()>,
    ) -> Result<()> {
        let mut lines = Lines { text: &self.body, at: 0, line: self.line };
        let mut csv = csv::ReaderBuilder::new()
            .flexible(true)
            .has_headers(false)
            .delimiter(self.separator)
            .buffer_capacity(1 << 16)
            .from_reader(&*self.body);
        let mut record = csv::ByteRecord::new();
        while csv.read_byte_record(&mut record).map_err(|error| at(source).fault(error.to_string()))? {
            let line = lines.line_from(record.position().map_or(0, csv::Position::byte));
            if record.as_slice().iter().filter(|b| **b == b'\n').count() > MOST_LINES_OF_A_ROW {
                return Err(at(source)
                    .fault(format!("row {line} has a quotation mark that is not closed: remove it")));
            }
            let blank = record.iter().all(|field| field.trim_ascii().is_empty());
            if !blank && record.get(0).is_none_or(|field| comment(field).is_none()) {
                each(line, &record)?;
            }
        }
        Ok(())
    }

    /// Fails if the header has fewer names than the rows have fields, because columns would have wrong names.
    fn require_alignment(&self) -> std::result::Result<(), String> {
        let filled = self.first.iter().rposition(|f| !f.is_empty()).map_or(0, |last| last + 1);
        if self.headers.is_empty() || filled <= self.headers.len() {
            return Ok(());
        }
        Err(format!(
            "the header has {} names ({}), but row {} has {} fields, so the names of the columns are uncertain. Name every column \
             in the header, or remove the header and give numbers: `--columns 'time=1,position=2..7,…'`",
            self.headers.len(),
            shortened(&self.headers),
            self.line,
            filled
        ))
    }
}

/// Returns the first names of a list as text, and the number of the other names.
pub(super) fn shortened(names: &[String]) -> String {
    const SHOWN: usize = 40;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|n| n.chars().take(60).collect()).collect();
    let more = names.len().saturating_sub(SHOWN);
    let rest = if more > 0 { format!(", … ({more} more)") } else { String::new() };
    format!("{}{rest}", shown.join(", "))
}

/// First bytes of files that are not text, with their format and a remedy.
const BINARY: [(&[u8], &str); 6] = [
    (b"PK\x03\x04", "a zip archive or an Excel or NumPy file: export its table as CSV"),
    (
        b"\x93NUMPY",
        "a NumPy array: write it with `numpy.savetxt(…, delimiter=',', header='t,q1,…', comments='')`",
    ),
    (
        b"#ROSBAG V2",
        "a ROS 1 bag: export its JointState topic as CSV, with PlotJuggler or `rostopic echo -b FILE -p /joint_states`",
    ),
    (b"MATLAB 5.0", "a MATLAB file: write its table as CSV (`writetable`)"),
    (b"\x89HDF", "an HDF5 or MATLAB 7.3 file: write its table as CSV"),
    (b"PAR1", "a Parquet file: write its table as CSV"),
];

fn refuse_binary(bytes: &[u8]) -> std::result::Result<(), String> {
    if let Some((_, what)) = BINARY.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(format!("this is {what}"));
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err("the text is in UTF-16: save it as UTF-8".into());
    }
    if bytes.trim_ascii().is_empty() {
        return Err("the file is empty, so nothing can be identified".into());
    }
    Ok(())
}

/// Replaces carriage returns by line feeds if the text has no line feeds.
fn unify_line_ends(bytes: &[u8]) -> Cow<'_, [u8]> {
    if bytes.contains(&b'\n') || !bytes.contains(&b'\r') {
        return Cow::Borrowed(bytes);
    }
    Cow::Owned(bytes.iter().map(|b| if *b == b'\r' { b'\n' } else { *b }).collect())
}

/// Returns the text with one tab instead of blanks and tabs between fields, and without blanks at the ends of lines.
fn collapse_blanks(bytes: &[u8]) -> Vec<u8> {
    let lines = bytes.split(|b| *b == b'\n').map(|line| {
        let words: Vec<&[u8]> =
            line.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty()).collect();
        words.join(&b'\t')
    });
    lines.collect::<Vec<_>>().join(&b'\n')
}

/// A line that is not blank.
struct Line<'t> {
    /// Line in the file, counted from 1.
    number: usize,
    /// Index of the line's first byte.
    start: usize,
    /// Text without the characters that mark a comment.
    text: &'t [u8],
    is_comment: bool,
}

fn sample(text: &[u8]) -> Vec<Line<'_>> {
    let mut start = 0;
    let mut lines = Vec::new();
    for (index, line) in text.split(|b| *b == b'\n').enumerate() {
        let trimmed = line.strip_suffix(b"\r").unwrap_or(line);
        if !trimmed.trim_ascii().is_empty() {
            let inner = comment(trimmed);
            lines.push(Line {
                number: index + 1,
                start,
                text: inner.unwrap_or(trimmed),
                is_comment: inner.is_some(),
            });
        }
        if lines.len() >= SAMPLE {
            break;
        }
        start += line.len() + 1;
    }
    lines
}

/// Returns the text after the characters that mark a comment; `None` if the line is not a comment.
fn comment(line: &[u8]) -> Option<&[u8]> {
    let trimmed = line.trim_ascii_start();
    let signs = [&b"#"[..], b"%", b"//"];
    signs.iter().find_map(|sign| trimmed.strip_prefix(*sign))
}

/// Returns the fields of a line, without surrounding blanks and quotation marks.
fn fields(line: &[u8], separator: u8) -> Vec<String> {
    if separator == b' ' {
        let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        return words.map(decoded).collect();
    }
    let mut csv = csv::ReaderBuilder::new()
        .flexible(true)
        .has_headers(false)
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(trim_start_but(line, separator));
    let mut record = csv::ByteRecord::new();
    let _ = csv.read_byte_record(&mut record); // a line that is no record has no fields
    let mut fields: Vec<String> = record.iter().map(decoded).collect();
    // A separator at the end of a line does not begin a field.
    if fields.len() > 1 && fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    fields
}

/// Returns the text of a field. If the bytes are not UTF-8, they are decoded as Windows-1252, whose letters have the
/// numbers of Unicode.
fn decoded(field: &[u8]) -> String {
    let letter = |byte: &u8| match byte {
        0..=0x7f | 0xc0..=0xff => char::from(*byte),
        _ => char::REPLACEMENT_CHARACTER,
    };
    let text = str::from_utf8(field).map(str::to_owned);
    text.unwrap_or_else(|_| field.iter().map(letter).collect())
}

/// Returns a line without blanks at its beginning. A blank before a quotation mark would make the mark part of the field.
fn trim_start_but(line: &[u8], separator: u8) -> &[u8] {
    let start = line.iter().position(|b| !b.is_ascii_whitespace() || *b == separator);
    start.map_or(&[], |start| &line[start..])
}

/// Returns the number of fields that are not empty, and how many of them are numbers.
fn count(fields: &[String]) -> (usize, usize) {
    let filled = fields.iter().filter(|f| !f.is_empty());
    let numbers = filled.clone().filter(|f| {
        let bytes = f.as_bytes();
        number(bytes, Decimals::Point).or_else(|| number(bytes, Decimals::Comma)).is_some()
    });
    (filled.count(), numbers.count())
}

/// Returns the separator that gives the largest share of numbers in the last sampled lines, which contain numbers; `None`
/// if no separator fits.
fn guess_separator(lines: &[Line]) -> Option<u8> {
    let plain: Vec<&Line> = lines.iter().filter(|l| !l.is_comment).collect();
    let last = &plain[plain.len().saturating_sub(50).max(plain.len() / 3)..];
    let mut best = None;
    for separator in [b';', b'\t', b',', b' '] {
        let (mut all, mut numbers, mut wide) = (0, 0, 0);
        for line in last {
            let split = fields(line.text, separator);
            wide += usize::from(split.len() > 1);
            let (filled, numeric) = count(&split);
            all += filled;
            numbers += numeric;
        }
        let share = numbers as f64 / all.max(1) as f64;
        let score = (share, numbers);
        if 2 * wide > last.len() && share >= 0.25 && best.is_none_or(|(_, other)| score > other) {
            best = Some((separator, score));
        }
    }
    best.map(|(separator, _)| separator)
}

/// Returns the index of the first line of numbers. At least half of its fields are numbers, and it has at least half of the
/// usual number of fields.
fn first_data(lines: &[Line], split: &[Vec<String>]) -> Option<usize> {
    let is_row = |i: &usize| {
        let (filled, numbers) = count(&split[*i]);
        !lines[*i].is_comment && numbers > 0 && 2 * numbers >= filled
    };
    let mut widths: Vec<usize> = (0..lines.len()).filter(is_row).map(|i| split[i].len()).collect();
    let middle = widths.len().checked_sub(1)? / 2;
    let usual = *widths.select_nth_unstable(middle).1;
    (0..lines.len()).find(|i| is_row(i) && 2 * split[*i].len() >= usual)
}

/// Returns the headers of the columns, and the row of units.
fn header(lines: &[Line], split: &[Vec<String>], data: usize) -> (Vec<String>, Vec<String>) {
    let width = split[data].len();
    let is_header = |i: &usize| {
        let (filled, numbers) = count(&split[*i]);
        let is_text = filled > 1 && 2 * numbers < filled;
        // A comment is a header if it has a name for every column.
        is_text && (!lines[*i].is_comment || numbers == 0 && split[*i].len() + 1 >= width)
    };
    let mut before = (0..data).rev().filter(is_header);
    let Some(last) = before.next() else {
        return (otherwise_separated(&lines[..data], width).unwrap_or_default(), Vec::new());
    };
    let are_units = split[last].iter().all(|f| f.is_empty() || f == "-" || unit_field(f).is_some());
    match before.next().filter(|h| are_units && split[*h].len() == split[last].len()) {
        Some(names) => (split[names].clone(), split[last].clone()),
        None => (split[last].clone(), Vec::new()),
    }
}

/// Returns the fields of a header whose separator differs from the separator of the numbers, for example `# t,q1,q2` above
/// `0 0.1 0.2`; `None` if there is no such header.
fn otherwise_separated(before: &[Line], width: usize) -> Option<Vec<String>> {
    let last = before.last()?;
    let mut split = [b',', b';', b'\t', b' '].into_iter().map(|separator| fields(last.text, separator));
    split.find(|names| names.len() == width && width > 1 && count(names) == (width, 0))
}

/// Returns a unit from a row of units, with or without brackets; `None` for other text.
fn unit_field(field: &str) -> Option<String> {
    let inner = field.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']);
    units::find(inner).map(|_| inner.to_owned())
}

/// Returns the decimal sign of most numbers. If commas separate fields, a field with a comma needs quotation marks.
fn decimals(lines: &[Line], split: &[Vec<String>]) -> Decimals {
    let rows = lines.iter().zip(split).filter(|(line, _)| !line.is_comment);
    let (mut points, mut commas) = (0_usize, 0_usize);
    for field in rows.flat_map(|(_, fields)| fields) {
        let is = |decimals: Decimals| number(field.as_bytes(), decimals).is_some();
        points += usize::from(field.contains('.') && is(Decimals::Point));
        commas += usize::from(field.contains(',') && is(Decimals::Comma));
    }
    if commas > points { Decimals::Comma } else { Decimals::Point }
}

fn nothing(lines: &[Line]) -> String {
    let shown =
        lines.first().map_or(String::new(), |l| String::from_utf8_lossy(l.text).chars().take(80).collect());
    format!(
        "the file has no rows of numbers. It begins with `{shown}`. It needs a header and rows of numbers that are separated by \
         commas, semicolons, tabs, blanks or the character of `--separator`"
    )
}
