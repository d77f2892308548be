//! Numbers, formulas, vectors and poses in TOML.

use super::keys::FREE;
use super::table::{Item, Table};
use crate::description::Name;
use crate::description::angles::Angles;
use crate::diagnostic::{At, Report, Span};
use crate::model::name::{has_meaning, identifier, is_keyword};
use crate::model::pose::{IDENTITY, Unsaid, norm};
use crate::model::{Parameter, Pose};
use crate::numeric;
use crate::read::options::ReadOptions;
use crate::wording::{as_written, telling};
use gelenk_formula::{Allowed, Formula, LARGEST_NUMBER, parse, too_large};
use std::collections::{BTreeMap, BTreeSet};
use toml::de::DeValue;

/// State of the reader of a TOML description.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    pub report: Report,
    pub angles: Angles,
    /// Free parameters that the reader has found so far.
    pub parameters: Vec<At<Parameter>>,
    /// Indices of the free parameters by their names in formulas. These names may differ from the names of
    /// the generated fields.
    pub parameter_names: BTreeMap<String, usize>,
    /// Indices of the free parameters of `[parameters]` that no formula has used so far.
    pub unused: BTreeSet<usize>,
    /// Indices of the free parameters by the names of the generated fields.
    fields: BTreeMap<String, usize>,
}

/// Largest accepted difference of the length of axes and quaternions from 1 (seven written digits).
const UNIT: f64 = 1e-6;

/// Keys of Denavit–Hartenberg rows to which the coordinate is added, with help texts.
const OFFSETS: [(&str, &str); 2] = [
    (
        "theta",
        "`theta` is only the constant part of the angle, without the coordinate: `\"pi/2\"` instead of `\"q+pi/2\"`",
    ),
    (
        "d",
        "`d` is only the constant part of the distance, without the coordinate of a prismatic joint: `0.1` \
         instead of `\"q+0.1\"`",
    ),
];

impl Reader {
    /// Creates a reader before the first key of a description is read.
    pub fn new(options: &ReadOptions) -> Self {
        let mut reader = Self::default();
        reader.angles.snap = options.snap_angles;
        reader
    }

    /// Reads a finite number, or a formula without parameters. It must be positive if its key requires this.
    pub fn number(&mut self, item: Item<'_>) -> Option<At<f64>> {
        let formula = self.scalar(item, Allowed::Constants)?;
        let number = formula.as_number()?;
        if item.row.value.is_positive() && number <= 0.0 {
            let message = format!("`{}` must be greater than 0, not {number}", item.key);
            self.report.error(item.span, "not-positive", message);
            item.help_by_example(&mut self.report);
            return None;
        }
        Some(At::new(number, item.span))
    }

    /// A number, a formula of parameters, or `{ free = … }`, which defines a parameter with the name
    /// `<owner>_<key>`.
    pub fn formula(&mut self, item: Item<'_>, owner: &str) -> Option<Formula> {
        match item.value {
            DeValue::Table(_) => self.free_parameter(item, &format!("{owner}_{}", item.key)),
            _ => self.scalar(item, Allowed::Parameters),
        }
    }

    /// Value of a formula with the parameter values that the description gives.
    pub fn at_defaults(&self, formula: &Formula) -> f64 {
        let defaults = self.parameters.iter().map(|parameter| parameter.value.default);
        formula.evaluate(&defaults.collect::<Vec<f64>>(), 0.0, 0.0)
    }

    /// A force law: a formula of parameters, `y` and `v`.
    pub fn force_law(&mut self, item: Item<'_>) -> Option<Formula> {
        self.scalar(item, Allowed::Motion)
    }

    /// A force law between two frames: a formula of parameters, the distance `l` and its rate `dl`. The formula
    /// has `l` as its position and `dl` as its velocity.
    pub fn force_between_law(&mut self, item: Item<'_>) -> Option<Formula> {
        self.scalar(item, Allowed::Distance)
    }

    fn scalar(&mut self, item: Item<'_>, allowed: Allowed) -> Option<Formula> {
        match item.value {
            DeValue::Integer(_) | DeValue::Float(_) => self.literal(item).map(Formula::Number),
            DeValue::String(text) => self.text_formula(text, item, allowed),
            _ => {
                item.expected("a number or a formula", &mut self.report);
                None
            }
        }
    }

    fn literal(&mut self, item: Item<'_>) -> Option<f64> {
        let value = match item.value {
            DeValue::Integer(integer) => {
                i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64)
            }
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        };
        match value {
            // Adding 0 makes −0 a plain 0.
            Some(value) if value.abs() <= LARGEST_NUMBER => Some(value + 0.0),
            Some(value) if value.is_finite() => {
                let message = too_large(&format!("`{}`", item.key));
                self.report.error(item.span, "number-too-large", message);
                None
            }
            _ => {
                let message = format!("`{}` must be finite, not {}", item.key, self.report.text(item.span));
                self.report.error(item.span, "number-not-finite", message);
                item.help_by_example(&mut self.report);
                None
            }
        }
    }

    fn text_formula(&mut self, text: &str, item: Item<'_>, allowed: Allowed) -> Option<Formula> {
        let span = item.span;
        match parse(text, allowed, &self.parameter_names) {
            Ok(formula) => {
                let names = |index: &usize| formula.any(&|part| *part == Formula::Parameter(*index));
                self.unused.retain(|index| !names(index));
                Some(formula)
            }
            Err(wrong) => {
                // A plain string literal has its text one byte after the quote. In other literals the whole value is
                // marked.
                let plain = self.report.text(span).get(1..).is_some_and(|rest| rest.starts_with(text));
                let start = span.start + 1;
                let place = Span { start: start + wrong.range.start, end: start + wrong.range.end, ..span };
                self.report.error(if plain { place } else { span }, wrong.code, wrong.message);
                let of_key = OFFSETS.iter().find(|(key, _)| wrong.code == "unknown-name" && *key == item.key);
                if let Some(help) = of_key.map(|(_, help)| (*help).to_owned()).or(wrong.help) {
                    self.report.help(help);
                }
                None
            }
        }
    }

    fn free_parameter(&mut self, item: Item<'_>, name: &str) -> Option<Formula> {
        let table = item.table_of(&FREE, &mut self.report)?;
        let default = self.number(table.get("free")?)?;
        let name = match table.get("name") {
            Some(own) => At::new(own.text(&mut self.report)?.to_owned(), own.span),
            None => At::new(identifier(name), item.span),
        };
        self.add_parameter(name, default.value, &table)
    }

    /// Adds a free parameter after a check of its name. `table` may have its unit and description.
    pub fn add_parameter(&mut self, name: Name, default: f64, table: &Table<'_>) -> Option<Formula> {
        let unit = self.one_line(table, "unit");
        let description = self.one_line(table, "description");
        self.push_parameter(name, default, unit, description)
    }

    /// Adds a free parameter after a check of its name.
    pub fn push_parameter(
        &mut self,
        name: Name,
        default: f64,
        unit: String,
        description: String,
    ) -> Option<Formula> {
        let text = &name.value;
        let usable = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && text.chars().any(|c| c.is_ascii_alphanumeric());
        if !usable || is_keyword(text) || has_meaning(text) {
            self.report.error(name.span, "parameter-name", format!("{text:?} is not a valid parameter name"));
            self.report.help(
                "begin with a letter or `_`, and use only letters, digits and `_`. Rust keywords and the names y, v, pi, sin, … are not allowed",
            );
            return None;
        }
        let field = identifier(text);
        let other = self.fields.get(&field).and_then(|other| self.parameters.get(*other));
        if let Some(other) = other {
            let place = self.report.place(other.span);
            let message =
                format!("two parameters are named `{field}`: rename this one or the one at {place}");
            self.report.error(name.span, "duplicate-name", message);
            return None;
        }
        let index = self.parameters.len();
        self.fields.insert(field.clone(), index);
        self.parameter_names.insert(name.value, index);
        self.parameters.push(At::new(Parameter { name: field, default, unit, description }, name.span));
        Some(Formula::Parameter(index))
    }

    fn one_line(&mut self, table: &Table<'_>, key: &str) -> String {
        let text = table.get(key).and_then(|item| item.text(&mut self.report)).unwrap_or("");
        text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
    }

    /// Reads a name: non-empty text without control characters.
    pub fn name(&mut self, item: Item<'_>) -> Option<Name> {
        let text = item.text(&mut self.report)?;
        if text.is_empty() || text.chars().any(char::is_control) {
            let message = format!("`{}` must be one line of text, not {text:?}", item.key);
            self.report.error(item.span, "unusable-name", message);
            return None;
        }
        Some(At::new(text.to_owned(), item.span))
    }

    /// Entries of a top-level list of tables; empty if the key is absent. Unreadable entries are left out.
    pub fn all<T>(
        &mut self,
        top: &Table<'_>,
        key: &str,
        read: fn(&mut Self, &Table<'_>) -> Option<T>,
    ) -> Vec<T> {
        let Some(item) = top.get(key) else {
            return Vec::new();
        };
        let tables = item.tables(&mut self.report);
        tables.iter().filter_map(|table| read(self, table)).collect()
    }

    /// Reads the name that is the value of a key; `None` without the key.
    pub fn name_of(&mut self, table: &Table<'_>, key: &str) -> Option<Name> {
        table.get(key).and_then(|item| self.name(item))
    }

    /// Reads a list of `N` formulas. A wrong formula is reported and becomes 0.
    pub fn formulas<const N: usize>(&mut self, item: Item<'_>, owner: &str) -> Option<[Formula; N]> {
        let entries = self.entries::<N>(item)?;
        let label = |index: usize| ["x", "y", "z"].get(index).copied().unwrap_or("");
        let mut result = [Formula::ZERO; N];
        for (index, entry) in entries.into_iter().enumerate() {
            let value = match entry.value {
                DeValue::Table(_) => {
                    self.free_parameter(entry, &format!("{owner}_{}_{}", item.key, label(index)))
                }
                _ => self.scalar(entry, Allowed::Parameters),
            };
            result[index] = value.unwrap_or(Formula::ZERO);
        }
        Some(result)
    }

    /// Reads a list of `N` numbers.
    pub fn numbers<const N: usize>(&mut self, item: Item<'_>) -> Option<At<[f64; N]>> {
        let entries = self.entries::<N>(item)?;
        let numbers: Vec<Option<At<f64>>> = entries.into_iter().map(|entry| self.number(entry)).collect();
        let mut result = [0.0; N];
        for (into, number) in result.iter_mut().zip(numbers) {
            *into = number?.value;
        }
        Some(At::new(result, item.span))
    }

    fn entries<'t, const N: usize>(&mut self, item: Item<'t>) -> Option<Vec<Item<'t>>> {
        let what = format!("a list of {N} numbers");
        let entries = item.array(&what, &mut self.report)?;
        if entries.len() == N {
            return Some(entries);
        }
        let message = format!("`{}` must be {what}, not {}", item.key, entries.len());
        self.report.error(item.span, "wrong-length", message);
        item.help_by_example(&mut self.report);
        None
    }

    /// Reads a unit vector. Other lengths are reported.
    pub fn axis(&mut self, item: Item<'_>) -> Option<[f64; 3]> {
        let axis = self.numbers::<3>(item)?.value;
        let length = norm(&axis);
        if (length - 1.0).abs() <= UNIT {
            return Some(axis.map(|x| x / length));
        }
        let message = format!("`{}` = [{}] has length {}, not 1", item.key, join(&axis), not_one(length));
        self.report.error(item.span, "axis-not-unit", message);
        if length > 0.0 && length.is_finite() {
            let unit = axis.map(|x| x / length);
            self.report.help(format!("write [{}]", join(&unit)));
        } else {
            item.help_by_example(&mut self.report);
        }
        None
    }

    /// Reads a pose: `{ xyz, rpy }` or `{ xyz, quaternion = { w, x, y, z } }`.
    pub fn pose(&mut self, item: Item<'_>, owner: &str) -> Option<Pose> {
        let table = item.table(&mut self.report)?;
        let xyz = table.get("xyz").and_then(|xyz| self.formulas::<3>(xyz, owner));
        let rotation = match (table.get("rpy"), table.get("quaternion")) {
            (Some(rpy), None) => self.numbers::<3>(rpy).map(|angles| self.angles.rpy(&angles, owner)),
            (None, Some(quaternion)) => self.quaternion(quaternion),
            (None, None) => None,
            (Some(_), Some(second)) => {
                self.report.error(
                    second.key_span,
                    "conflicting-keys",
                    "both `rpy` and `quaternion` are given",
                );
                self.report.help("remove one of them");
                None
            }
        };
        let translation = xyz.unwrap_or([Formula::ZERO; 3]);
        Some(Pose { translation, rotation: rotation.unwrap_or(IDENTITY) })
    }

    fn quaternion(&mut self, item: Item<'_>) -> Option<[[f64; 3]; 3]> {
        let table = item.table(&mut self.report)?;
        let parts = ["w", "x", "y", "z"]
            .map(|key| table.get(key).map_or(Some(0.0), |part| self.number(part).map(|n| n.value)));
        let [w, x, y, z] = [parts[0]?, parts[1]?, parts[2]?, parts[3]?];
        let length = numeric::length([w, x, y, z]);
        if (length - 1.0).abs() <= UNIT {
            return Some(self.angles.quaternion([w, x, y, z].map(|part| part / length)));
        }
        self.report.error(
            item.span,
            "quaternion-not-unit",
            format!("the quaternion has length {}, not 1", not_one(length)),
        );
        self.report.help(match length {
            0.0 => "the identity is { w = 1, x = 0, y = 0, z = 0 }",
            _ => "divide the quaternion by its length",
        });
        None
    }
}

/// Parts of a pose (translation, rotation) that its table leaves out.
pub(crate) fn unsaid(item: Option<Item<'_>>) -> Unsaid {
    let lacks = |keys: &[&str]| {
        let table = item.and_then(|item| item.value.as_table());
        table.is_some_and(|table| !keys.iter().any(|key| table.contains_key(*key)))
    };
    Unsaid { translation: lacks(&["xyz"]), rotation: lacks(&["rpy", "quaternion"]) }
}

/// Text of a length that is not 1, with enough digits to show the difference.
fn not_one(length: f64) -> String {
    let [length] = telling([length], |[length]| length != 1.0);
    length
}

/// Numbers as a comma-separated list in the syntax of descriptions.
pub(crate) fn join(numbers: &[f64]) -> String {
    numbers.iter().map(|&number| as_written(number)).collect::<Vec<_>>().join(", ")
}
