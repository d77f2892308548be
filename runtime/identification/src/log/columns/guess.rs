//! The columns of a log as an argument of `--columns`, which the user can edit.

use super::super::super::error::Result;
use super::super::sheet::Sheet;
use super::super::units::Unit;
use super::finder::Finder;
use super::found::{Column, Found};
use super::mapping::Parts;
use super::pattern::ColumnOptions;
use super::robot::RobotColumns;
use gelenk_findings::Finding;

/// Columns of a log that were found, as an argument of `--columns`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnGuess {
    /// Argument of `--columns`. The text `QUANTITY=?` means that no columns of this quantity were found.
    pub line: String,
    /// Errors of the quantities whose columns were not found.
    pub faults: Vec<Finding>,
    /// All columns of the log: their headers, or the fields of the first row if there are no headers.
    pub columns: Vec<String>,
}

/// Finds the columns of a sheet.
///
/// # Errors
/// The errors are those of options that are not valid. A missing column is not an error.
pub(in crate::log) fn guess(
    sheet: &Sheet,
    robot: &RobotColumns,
    options: &ColumnOptions,
    source: &str,
) -> Result<ColumnGuess> {
    let finder = Finder::new(sheet, robot, options, source, "")?;
    let mut guess = finder.guess(finder.parts(options.effort));
    guess.columns = if sheet.headers.is_empty() { sheet.first.clone() } else { sheet.headers.clone() };
    if let Err(fault) = finder.require_header() {
        guess.faults = fault.refusals().to_vec();
    }
    Ok(guess)
}

/// Columns of a quantity, and the part of the argument that names them; `None` if there are no columns.
type Part = Option<(Vec<usize>, String)>;

impl Finder<'_> {
    fn guess(&self, parts: Parts) -> ColumnGuess {
        let one = |found: Found| self.part(vec![found]);
        let several = |found: Option<Found>| self.part(found.into_iter().collect());
        let run = |column: usize| (vec![column], format!("run={}", self.unique(column)));
        let all: [(&str, Result<Part>); 7] = [
            ("time", parts.time.map(|time| Some((time.columns(), time.option())))),
            ("run", parts.run.map(|column| column.map(run))),
            ("place", parts.places.map(|found| self.part(found))),
            ("xyzw", parts.attitudes.map(|found| self.part(found))),
            ("position", parts.position.map(one)),
            ("velocity", parts.velocity.map(several)),
            ("torque", parts.efforts.map(|(_, found)| one(found))),
        ];
        let (mut line, mut used, mut guess) = (Vec::new(), Vec::new(), ColumnGuess::default());
        for (key, part) in all {
            match part {
                Ok(part) => {
                    let (columns, text) = part.unzip();
                    used.extend(columns.into_iter().flatten());
                    line.extend(text);
                }
                Err(fault) => {
                    line.push(format!("{key}=?"));
                    guess.faults.extend_from_slice(fault.refusals());
                }
            }
        }
        if let Err(fault) = self.require_distinct(&used) {
            guess.faults.extend_from_slice(fault.refusals());
        }
        line.extend(self.robot.hold_option());
        ColumnGuess { line: line.join(","), ..guess }
    }

    /// Returns the columns of one quantity, joint by joint.
    fn part(&self, found: Vec<Found>) -> Part {
        let columns: Vec<usize> = found.iter().flat_map(Found::indices).collect();
        let texts: Vec<String> = columns.iter().map(|column| self.unique(*column)).collect();
        let pattern = if found.len() == 1 { found[0].pattern.clone() } else { texts.join("|") };
        let all: Vec<&Column> = found.iter().flat_map(|found| &found.columns).collect();
        let shown: Vec<Option<Unit>> =
            all.iter().map(|column| column.is_stated.then_some(column.unit)).collect();
        let bracket = |unit: Unit| format!("[{}]", unit.text());
        let key = found.first()?.kind.key();
        let text = if shown.windows(2).all(|pair| pair[0] == pair[1]) {
            format!("{pattern}{}", (*shown.first()?).map_or(String::new(), bracket))
        } else {
            let each = texts.iter().zip(&all).map(|(text, column)| format!("{text}{}", bracket(column.unit)));
            each.collect::<Vec<_>>().join("|")
        };
        Some((columns, format!("{key}={text}")))
    }
}
