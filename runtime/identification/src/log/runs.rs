//! Conversion of the rows of a log to samples, and of samples to runs.

use super::super::error::{Result, at};
use super::super::robot::Robot;
use super::super::run::Run;
use super::bursts::require_steady;
use super::columns::{Column, Mapping, RobotColumns};
use super::joint_forces::move_to_joints;
use super::number::{Decimals, number};
use super::seconds::{Clock, UNIT_ASSUMED, assumed_unit, counter_finding};
use super::sheet::{Sheet, shortened};
use super::spikes::leave_out_spikes;
use super::unroll::unrolled;
use super::zeros::zero_rows;
use gelenk_findings::{Finding, Rule, counted};
use std::collections::BTreeMap;
use std::ops::Range;

/// Sees: empty fields of a column, or rows that end before the column.
/// Matters: rows without a time, a position or an effort are not used.
/// Example: a row `0.02,0.1,` of `t,q1,u1`.
/// Fixture: `incomplete_rows_are_left_out_by_number` in `log/tests/styles.rs`.
const MISSING: Rule = Rule::note("missing-values");

/// Sees: text in a column of numbers.
/// Matters: the rows with this text are not used; a unit or a thousands separator may be the reason.
/// Example: `x` below `u1`.
/// Fixture: `incomplete_rows_are_left_out_by_number` in `log/tests/styles.rs`.
const NOT_A_NUMBER: Rule = Rule::note("not-a-number");

/// Sees: rows and runs that are not used: incomplete rows, rows of zeros, rows with too many fields, runs of few samples.
/// Matters: the estimate uses the remaining samples.
/// Example: a driver writes 0 for all positions and efforts if a message was lost.
/// Fixture: `zero_rows` in `codegen/tests/findings/arm.rs`.
pub(super) const LEFT_OUT: Rule = Rule::note("rows-left-out");

/// Sees: consecutive samples with the same time.
/// Matters: only the first of these samples is used.
/// Example: two rows at 0.01 s.
/// Fixture: `times_cut_runs` in `log/tests/styles.rs`.
const REPEATED: Rule = Rule::note("repeated-times");

/// Sees: a time that is earlier than the time of the row before.
/// Matters: a new run begins at this row. Each run has its own offset of the efforts.
/// Example: two logs in one file.
/// Fixture: `times_cut_runs` in `log/tests/styles.rs`.
const NEW_RUN: Rule = Rule::note("time-goes-back");

/// Complete rows of a log.
#[derive(Debug, Default)]
pub(super) struct Samples {
    /// Times in 10⁻¹² of the time column's unit.
    times: Vec<i128>,
    /// Row of each sample in the file, as in an editor.
    lines: Vec<usize>,
    /// Index of each sample's run in the list of run names.
    labels: Vec<usize>,
    names: Vec<String>,
    numbers: BTreeMap<String, usize>,
    /// Positions, velocities (NaN if there is no column), efforts, and poses, one column each.
    values: Vec<Vec<f64>>,
}

/// Fields of one column that are not finite numbers.
#[derive(Debug, Default, Clone, PartialEq)]
struct Gaps {
    count: usize,
    rows: Option<(usize, usize)>,
    /// First field of the column that contains text; `None` if there is no text.
    text: Option<String>,
    /// Number of rows whose field is text but not a number.
    unread: usize,
    /// Number of rows that end before the column.
    short: usize,
    /// Whether the column has a finite value.
    alive: bool,
}

impl Gaps {
    fn add(&mut self, line: usize, field: Option<&[u8]>, decimals: Decimals) {
        self.count += 1;
        self.rows = Some((self.rows.map_or(line, |r| r.0), line));
        match field {
            None => self.short += 1,
            Some(bytes) if number(bytes, decimals).is_none() && !bytes.trim_ascii().is_empty() => {
                self.unread += 1;
                let text = String::from_utf8_lossy(bytes);
                self.text.get_or_insert_with(|| text.trim().chars().take(40).collect());
            }
            Some(_) => {}
        }
    }

    fn finding(&self, columns: &[String], place: &str) -> Finding {
        let rule = if self.text.is_some() { NOT_A_NUMBER } else { MISSING };
        let is_first = if self.count == 1 { ": " } else { ". The first field with text is " };
        let text = self.text.as_ref().map_or(String::new(), |text| format!("{is_first}`{text}`"));
        let short = match (self.short, self.count) {
            (0, _) => String::new(),
            (1, 1) => ", which ends before the column".to_owned(),
            (n, _) => {
                format!("; {} before the column", counted(n, "of these rows ends", "of these rows end"))
            }
        };
        let has = if columns.len() == 1 { "has" } else { "have" };
        let (columns, rows) = (shortened(columns), counted(self.count, "row", "rows"));
        let message = format!("{columns} {has} no finite number in {rows}{short}{text}");
        rule.found(message).log(place, self.rows)
    }
}

impl Samples {
    /// Reads the mapped columns. Rows without a time, a position or an effort are left out, with a finding.
    ///
    /// # Errors
    /// [`IdentificationError::File`](crate::error::IdentificationError::File) if a column has no number, or if there are
    /// fewer than two complete rows.
    pub(super) fn read(
        sheet: &Sheet,
        mapping: &Mapping,
        robot: &RobotColumns,
        source: &str,
        findings: &mut Vec<Finding>,
    ) -> Result<Self> {
        let sources = sources(mapping);
        let (joints, first_pose) =
            (mapping.positions.columns.len(), sources.len() - pose_columns(mapping).count());
        let needed = |i: usize| i < joints || i >= first_pose;
        let mut samples = Self { values: vec![Vec::new(); sources.len()], ..Self::default() };
        let mut gaps = vec![Gaps::default(); sources.len() + 1];
        let mut row = vec![f64::NAN; sources.len()];
        let mut total = 0;
        let mut long = Tally::default();
        let widest = sheet.width.max(sheet.headers.len());
        sheet.rows(source, |line, record| {
            total += 1;
            // An additional field shifts the fields after it.
            if record.iter().skip(widest).any(|field| !field.trim_ascii().is_empty()) {
                long.add(line);
                return Ok(());
            }
            let mut complete = true;
            for (i, source) in sources.iter().enumerate() {
                let Some(source) = source else { continue };
                row[i] = value(record, source, sheet, line, &mut gaps[i]);
                complete &= row[i].is_finite() || !needed(i);
            }
            let Some(time) = mapping.time.read(record, line, sheet.decimals) else {
                gaps[sources.len()].add(
                    line,
                    mapping.time.column.and_then(|time| record.get(time)),
                    sheet.decimals,
                );
                return Ok(());
            };
            if complete {
                samples.push(time, line, mapping.run.and_then(|run| record.get(run)), &row);
            }
            Ok(())
        })?;
        let efforts = 2 * joints..2 * joints + mapping.efforts.columns.len();
        let long_rows = long.count;
        findings.extend(long.finding(source, LEFT_OUT, |n| {
            let rows = counted(
                n,
                "row is left out, because it has more fields than the header",
                "rows are left out, because they have more fields than the header",
            );
            format!("{rows}. Check whether a text contains the field separator")
        }));
        require_alive(sheet, &sources, &gaps, &efforts, source)?;
        let zeros = samples.leave_out_zeros(joints);
        let zero_rows = zeros.count;
        findings.extend(zeros.finding(source, LEFT_OUT, |n| {
            let rows = counted(
                n,
                "row is left out, because it contains only zeros and positions jump to it",
                "rows are left out, because they contain only zeros and positions jump to them",
            );
            format!("{rows}. No values were recorded there")
        }));
        for i in efforts.clone() {
            let name = sources[i].map(|column| label(sheet, column.index));
            findings.extend(leave_out_spikes(&mut samples.values[i], &samples.lines, name, source));
        }
        samples.leave_out_gaps(efforts);
        let left_out = total - samples.lines.len() - long_rows - zero_rows;
        findings.extend(gap_findings(sheet, mapping, &sources, &gaps, source, left_out));
        samples.require_some(robot, &gaps, total, source)?;
        let columns = labels(mapping, &sources);
        require_most_readable(sheet, &columns, &gaps, left_out, long_rows, total, source)?;
        Ok(samples)
    }

    fn push(&mut self, time: i128, line: usize, label: Option<&[u8]>, row: &[f64]) {
        self.times.push(time);
        self.lines.push(line);
        let label = label.map_or(String::new(), |l| String::from_utf8_lossy(l.trim_ascii()).into_owned());
        let next = self.names.len();
        let number = *self.numbers.entry(label).or_insert_with_key(|label| {
            self.names.push(label.clone());
            next
        });
        self.labels.push(number);
        for (column, value) in self.values.iter_mut().zip(row) {
            column.push(*value);
        }
    }

    /// Leaves out rows without an effort, if most rows have this effort. An effort that most rows lack removes no rows,
    /// unless most rows lack all efforts.
    fn leave_out_gaps(&mut self, efforts: Range<usize>) {
        let known = |i: &usize| self.values[*i].iter().filter(|u| u.is_finite()).count();
        let usual = efforts.clone().filter(|i| 2 * known(i) >= self.lines.len());
        let mut needed: Vec<usize> = usual.collect();
        if needed.is_empty() {
            needed = efforts.collect();
        }
        let kept: Vec<bool> = (0..self.lines.len())
            .map(|row| needed.iter().all(|i| self.values[*i][row].is_finite()))
            .collect();
        self.retain(&kept);
    }

    /// Leaves out rows of zeros, which were written without recorded values. Returns their number.
    fn leave_out_zeros(&mut self, positions: usize) -> Tally {
        let is_same_run = |row: usize| self.labels[row] == self.labels[row - 1];
        let zeros = zero_rows(&self.values, positions, is_same_run);
        let mut kept = vec![true; self.lines.len()];
        let mut tally = Tally::default();
        for row in zeros {
            kept[row] = false;
            tally.add(self.lines[row]);
        }
        self.retain(&kept);
        tally
    }

    fn retain(&mut self, kept: &[bool]) {
        retain(&mut self.times, kept);
        retain(&mut self.lines, kept);
        retain(&mut self.labels, kept);
        self.values.iter_mut().for_each(|column| retain(column, kept));
    }

    fn require_some(&self, robot: &RobotColumns, gaps: &[Gaps], total: usize, source: &str) -> Result<()> {
        if self.lines.len() >= 2 {
            return Ok(());
        }
        if let Some(Gaps { count, text: Some(text), .. }) = gaps.last().filter(|time| time.count == total) {
            return Err(at(source).fault(format!(
                "none of the {count} rows has a number in the column of times. The first field is `{text}`. Export the time in \
                 seconds, or name another column with --columns 'time=…[s]'"
            )));
        }
        let fullest = gaps.iter().map(|g| total - g.count.min(total)).min().unwrap_or(0);
        Err(at(source).fault(format!(
            "only {} of {total} rows have the time, all {} positions and the efforts. The column with the most gaps has {fullest} \
             values. If positions and efforts are in different rows, export the topic that has both",
            self.lines.len(),
            robot.joints.names.len()
        )))
    }
}

fn retain<T>(values: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    values.retain(|_| kept.next().copied().unwrap_or(true));
}

/// Returns the columns of a mapping in the order of [`Samples::values`].
fn sources(mapping: &Mapping) -> Vec<Option<&Column>> {
    let positions = &mapping.positions.columns;
    let velocities = mapping.velocities.as_ref().map(|found| &found.columns);
    let velocities = (0..positions.len()).map(|joint| velocities.map(|columns| &columns[joint]));
    let last = mapping.efforts.columns.iter().chain(pose_columns(mapping));
    positions.iter().map(Some).chain(velocities).chain(last.map(Some)).collect()
}

fn pose_columns(mapping: &Mapping) -> impl Iterator<Item = &Column> {
    mapping.poses.iter().flat_map(|found| &found.columns)
}

fn value(record: &csv::ByteRecord, source: &Column, sheet: &Sheet, line: usize, gaps: &mut Gaps) -> f64 {
    let field = record.get(source.index);
    let value = field.and_then(|f| number(f, sheet.decimals)).map_or(f64::NAN, |x| x * source.unit.factor);
    if value.is_finite() {
        gaps.alive = true;
    } else {
        gaps.add(line, field, sheet.decimals);
    }
    value
}

fn label(sheet: &Sheet, column: usize) -> String {
    sheet.headers.get(column).map_or_else(|| format!("column {}", column + 1), |h| format!("column `{h}`"))
}

/// Fails if a column has no number. However, a column of efforts without numbers is accepted if another one has numbers,
/// because only the effort of one joint is missing then.
fn require_alive(
    sheet: &Sheet,
    sources: &[Option<&Column>],
    gaps: &[Gaps],
    efforts: &Range<usize>,
    place: &str,
) -> Result<()> {
    let some_effort = gaps[efforts.clone()].iter().any(|gaps| gaps.alive);
    for (i, (source, gaps)) in sources.iter().zip(gaps).enumerate() {
        if let Some(source) = source
            && !gaps.alive
            && !(some_effort && efforts.contains(&i))
            && gaps.count > 0
        {
            let example =
                gaps.text.as_ref().map_or(String::new(), |text| format!(" (its first value is `{text}`)"));
            return Err(at(place).fault(format!(
                "{} has no finite number{example}: name another column with --columns",
                label(sheet, source.index)
            )));
        }
    }
    Ok(())
}

/// Returns the columns in the order of their gaps: first the columns of the samples, then the column of times.
fn labels(mapping: &Mapping, sources: &[Option<&Column>]) -> Vec<Option<usize>> {
    sources.iter().map(|s| s.map(|s| s.index)).chain([mapping.time.column]).collect()
}

/// Fails if most rows of a log are not readable, because the remaining rows would not represent the recorded motion. Empty
/// fields are accepted: for example, two topics may share one table.
fn require_most_readable(
    sheet: &Sheet,
    columns: &[Option<usize>],
    gaps: &[Gaps],
    left_out: usize,
    long: usize,
    total: usize,
    place: &str,
) -> Result<()> {
    if 2 * (left_out + long) <= total {
        return Ok(());
    }
    let all = columns.iter().zip(gaps);
    let worst = all.filter(|(_, gaps)| 2 * gaps.unread > total).max_by_key(|(_, gaps)| gaps.unread);
    let reason = match worst {
        Some((column, gaps)) => format!(
            "{} has no number in {} of these rows. The first field is `{}`. Export plain numbers, without thousands separators, \
             units, or a mixture of decimal commas and points",
            column.map_or_else(String::new, |column| label(sheet, column)),
            gaps.unread,
            gaps.text.as_deref().unwrap_or("")
        ),
        None if 2 * long > total => {
            "they have more fields than the header, because a text or a number contains the field separator"
                .to_owned()
        }
        None => return Ok(()),
    };
    let message = format!("{} of {total} rows cannot be used: {reason}", left_out + long);
    Err(at(place).fault(message))
}

fn gap_findings(
    sheet: &Sheet,
    mapping: &Mapping,
    sources: &[Option<&Column>],
    gaps: &[Gaps],
    place: &str,
    left_out: usize,
) -> Vec<Finding> {
    let columns = labels(mapping, sources);
    // Columns with the same gaps give one finding.
    let mut alike: Vec<(Vec<String>, &Gaps)> = Vec::new();
    for (column, gaps) in columns.into_iter().zip(gaps).filter(|(_, gaps)| gaps.count > 0) {
        let Some(column) = column else { continue };
        match alike.iter_mut().find(|(_, known)| *known == gaps) {
            Some((names, _)) => names.push(label(sheet, column)),
            None => alike.push((vec![label(sheet, column)], gaps)),
        }
    }
    let mut findings: Vec<Finding> =
        alike.into_iter().map(|(names, gaps)| gaps.finding(&names, place)).collect();
    if left_out > 0 {
        let message = counted(left_out, "incomplete row is left out", "incomplete rows are left out");
        findings.push(LEFT_OUT.found(message).log(place, None));
    }
    findings
}

/// Splits samples into runs. A new run begins if the run number changes or the time goes back. Samples with repeated times
/// are left out.
///
/// # Errors
/// [`IdentificationError::File`](crate::error::IdentificationError::File) if no run has at least two samples
pub(super) fn split(
    samples: Samples,
    mapping: &Mapping,
    robot: &dyn Robot,
    names: &RobotColumns,
    source: &str,
    findings: &mut Vec<Finding>,
) -> Result<Vec<Run>> {
    let (parts, step) = parts(&samples, source, findings);
    let (unit, said) = match mapping.time.unit {
        Some(unit) => (unit, None),
        None => assumed_unit(step),
    };
    findings.extend(said.map(|message| UNIT_ASSUMED.found(message).log(source, None)));
    let clock = Clock::new(&samples.times, unit);
    findings.extend(counter_finding(&samples.times, unit, source));
    require_steady(&parts, &samples.times, unit, source)?;
    let short = parts.iter().filter(|p| p.len() < 2).count();
    if short > 0 {
        let message =
            counted(short, "run with a single sample is left out", "runs with a single sample are left out");
        findings.push(LEFT_OUT.found(message).log(source, None));
    }
    let kept: Vec<Vec<usize>> = parts.into_iter().filter(|p| p.len() > 1).collect();
    if kept.is_empty() {
        return Err(
            at(source).fault("no run has two samples with increasing times: check the column of times")
        );
    }
    let named = kept.iter().zip(run_names(&samples, &kept, source));
    let mut runs: Vec<Run> = named.map(|(part, name)| samples.run(part, name, &clock, mapping)).collect();
    for run in &mut runs {
        names.add_unrecorded(run, &mapping.efforts.places);
        match mapping.poses.is_empty() {
            true => move_to_joints(run, robot),
            false => *run = unrolled(run, robot, source)?,
        }
    }
    for run in &mut runs {
        findings.extend(super::health::unwrap_turns(run, robot, source));
    }
    Ok(runs)
}

/// Returns the indices of the samples of each run, and the median step between samples.
fn parts(samples: &Samples, source: &str, findings: &mut Vec<Finding>) -> (Vec<Vec<usize>>, i128) {
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut steps: Vec<i128> = Vec::new();
    let (mut repeated, mut back) = (Tally::default(), Tally::default());
    for i in 0..samples.times.len() {
        let last = parts.last().and_then(|part| part.last()).copied();
        let Some(last) = last.filter(|last| samples.labels[*last] == samples.labels[i]) else {
            parts.push(vec![i]);
            continue;
        };
        let step = samples.times[i].saturating_sub(samples.times[last]);
        if step == 0 {
            repeated.add(samples.lines[i]);
            continue;
        }
        if step < 0 {
            back.add(samples.lines[i]);
            parts.push(vec![i]);
            continue;
        }
        steps.push(step);
        if let Some(part) = parts.last_mut() {
            part.push(i);
        }
    }
    findings.extend(repeated.finding(source, REPEATED, |n| {
        counted(
            n,
            "sample has the same time as the sample before and is left out",
            "samples have the same time as the sample before and are left out",
        )
    }));
    findings.extend(back.finding(source, NEW_RUN, |n| match n {
        1 => "the time goes back once, and a new run begins at this row".to_owned(),
        n => format!("the time goes back {n} times, and a new run begins at each of these rows"),
    }));
    let middle = steps.len() / 2;
    let step = if steps.is_empty() { 0 } else { *steps.select_nth_unstable(middle).1 };
    (parts, step)
}

#[derive(Default)]
struct Tally {
    count: usize,
    rows: Option<(usize, usize)>,
}

impl Tally {
    fn add(&mut self, row: usize) {
        self.count += 1;
        self.rows = Some((self.rows.map_or(row, |r| r.0), row));
    }

    fn finding(self, source: &str, rule: Rule, say: impl Fn(usize) -> String) -> Option<Finding> {
        (self.count > 0).then(|| rule.found(say(self.count)).log(source, self.rows))
    }
}

/// Returns the name of each run: the file, the run, and a number if several runs have the same name.
fn run_names(samples: &Samples, parts: &[Vec<usize>], source: &str) -> Vec<String> {
    let label = |part: &Vec<usize>| samples.labels[part[0]];
    let mut same = vec![0_usize; samples.names.len()];
    parts.iter().for_each(|part| same[label(part)] += 1);
    let mut seen = vec![0_usize; samples.names.len()];
    let name = |part: &Vec<usize>| {
        let label = label(part);
        seen[label] += 1;
        let run = match samples.names[label].as_str() {
            "" => String::new(),
            name => format!(", run {name}"),
        };
        let part = if same[label] > 1 { format!(", part {}", seen[label]) } else { String::new() };
        format!("{source}{run}{part}")
    };
    parts.iter().map(name).collect()
}

impl Samples {
    fn run(&self, part: &[usize], name: String, clock: &Clock, mapping: &Mapping) -> Run {
        let n = mapping.positions.columns.len();
        let behind = 2 * n + mapping.efforts.columns.len();
        let column = |i: usize| -> Vec<f64> { part.iter().map(|s| self.values[i][*s]).collect() };
        let velocity = |joint: usize| {
            let values = column(n + joint);
            values.iter().all(|v| v.is_finite()).then_some(values)
        };
        Run {
            name,
            times: part.iter().map(|s| clock.seconds(self.times[*s])).collect(),
            rows: part.iter().map(|s| self.lines[*s]).collect(),
            positions: (0..n).map(column).collect(),
            poses: (self.values.len() - pose_columns(mapping).count()..self.values.len())
                .map(column)
                .collect(),
            velocities: (0..n).map(velocity).collect(),
            efforts: (2 * n..behind).map(column).collect(),
            effort: mapping.effort,
        }
    }
}
