//! TOML tables with the places of keys and values. Unknown keys are reported, and each value is read as the
//! requested type.

use super::keys::{Key, Keys, advice};
use crate::diagnostic::{Report, Span, nearest};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table whose keys were checked.
#[derive(Debug)]
pub(crate) struct Table<'t> {
    entries: Vec<Item<'t>>,
    /// Place of the table in the text.
    pub span: Span,
    /// All keys that the table may have.
    pub keys: &'static Keys,
}

/// A key of a table with its value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Item<'t> {
    /// Name of the key. An entry of an array has the name of the array's key.
    pub key: &'t str,
    /// Place of the key in the text.
    pub key_span: Span,
    /// The value as TOML data.
    pub value: &'t DeValue<'t>,
    /// Place of the value in the text.
    pub span: Span,
    /// Allowed values and meaning of the key. For a key that the user chose, those of the enclosing table.
    pub row: &'static Key,
}

impl<'t> Table<'t> {
    /// Checks the entries of a table and keeps them in the order of the file. Unknown keys and missing
    /// required keys are reported.
    pub fn checked(table: &'t DeTable<'t>, span: Span, keys: &'static Keys, report: &mut Report) -> Self {
        let mut entries = Vec::new();
        for (key, value) in in_order(table) {
            match keys.row(key.get_ref()) {
                Some(row) => entries.push(item(key, value, span.source, row)),
                None => unknown(key, span.source, keys, report),
            }
        }
        let table = Self { entries, span, keys };
        for row in keys.rows().filter(|row| row.is_needed && table.get(row.name).is_none()) {
            report.error(span, "missing-key", format!("{} needs `{}`", keys.what, row.name));
            report.help(format!("for example {}", row.line()));
        }
        table
    }

    /// Value of a key; `None` if the table lacks the key.
    pub fn get(&self, key: &str) -> Option<Item<'t>> {
        debug_assert!(self.keys.row(key).is_some(), "{} has no row `{key}`", self.keys.what);
        self.entries.iter().find(|item| item.key == key).copied()
    }

    /// All keys of the table with their values, in the order of the file.
    pub fn items(&self) -> &[Item<'t>] {
        &self.entries
    }
}

fn in_order<'t>(
    table: &'t DeTable<'t>,
) -> Vec<(&'t Spanned<toml::de::DeString<'t>>, &'t Spanned<DeValue<'t>>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

fn unknown(key: &Spanned<toml::de::DeString<'_>>, source: usize, keys: &Keys, report: &mut Report) {
    let message = format!("unknown key `{}` in {}", key.get_ref(), keys.what);
    report.error(Span::new(source, key.span()), "unknown-key", message);
    if !report.is_full()
        && let Some(help) = advice(key.get_ref(), keys)
    {
        report.help(help);
    }
}

fn item<'t>(
    key: &'t Spanned<toml::de::DeString<'t>>,
    value: &'t Spanned<DeValue<'t>>,
    source: usize,
    row: &'static Key,
) -> Item<'t> {
    Item {
        key: key.get_ref(),
        key_span: Span::new(source, key.span()),
        value: value.get_ref(),
        span: Span::new(source, value.span()),
        row,
    }
}

impl<'t> Item<'t> {
    /// Reports that the value has the wrong type. `what` is the expected type.
    pub fn expected(&self, what: &str, report: &mut Report) {
        let found = self.value.type_str();
        report.error(
            self.span,
            "wrong-type",
            format!("`{}` must be {what}, not {} {found}", self.key, article(found)),
        );
        self.help_by_example(report);
    }

    /// Adds an example of a valid value to the last message.
    pub fn help_by_example(&self, report: &mut Report) {
        report.help(format!("for example {}", self.row.line()));
    }

    /// The value as text. After an error the result is `None`.
    pub fn text(&self, report: &mut Report) -> Option<&'t str> {
        let text = self.value.as_str();
        if text.is_none() {
            self.expected("a text in quotes", report);
        }
        text
    }

    /// The value as true or false. After an error the result is `None`.
    pub fn boolean(&self, report: &mut Report) -> Option<bool> {
        let value = self.value.as_bool();
        if value.is_none() {
            self.expected("true or false", report);
        }
        value
    }

    /// The value as a list of entries. After an error the result is `None`.
    pub fn array(&self, what: &str, report: &mut Report) -> Option<Vec<Item<'t>>> {
        let Some(array) = self.value.as_array() else {
            self.expected(what, report);
            return None;
        };
        let source = self.span.source;
        let item = |value: &'t Spanned<DeValue<'t>>| Item {
            value: value.get_ref(),
            span: Span::new(source, value.span()),
            ..*self
        };
        Some(array.iter().map(item).collect())
    }

    /// The value as a table with the keys that are allowed for it. After an error the result is `None`.
    pub fn table(&self, report: &mut Report) -> Option<Table<'t>> {
        let Some(keys) = self.row.value.keys() else {
            self.expected(&self.row.value.kinds(), report);
            return None;
        };
        self.table_of(keys, report)
    }

    /// The value as a table with these keys. After an error the result is `None`.
    pub fn table_of(&self, keys: &'static Keys, report: &mut Report) -> Option<Table<'t>> {
        match self.value {
            DeValue::Table(table) => Some(Table::checked(table, self.span, keys, report)),
            _ => {
                self.expected(&self.row.value.kinds(), report);
                None
            }
        }
    }

    /// The value as a list of tables. Entries that are not tables are reported and left out.
    pub fn tables(&self, report: &mut Report) -> Vec<Table<'t>> {
        let expected = format!("a list of tables, each written [[{}]]", self.key);
        let items = self.array(&expected, report).unwrap_or_default();
        items.iter().filter_map(|item| item.table(report)).collect()
    }

    /// Entries of a table whose keys the user chooses; `None` if the value is not a table.
    pub fn named(&self) -> Option<Vec<Self>> {
        let entries = in_order(self.value.as_table()?).into_iter();
        Some(entries.map(|(key, value)| item(key, value, self.span.source, self.row)).collect())
    }

    /// The value as one of the allowed words. After an error the result is `None`.
    pub fn word(&self, report: &mut Report) -> Option<&'static str> {
        let text = self.text(report)?;
        let words = self.row.value.words();
        let word = words.iter().copied().find(|word| *word == text);
        if word.is_none() {
            report.error(self.span, "unknown-value", format!("`{}` cannot be {text:?}", self.key));
            let near = nearest(text, words.iter().copied()).unwrap_or_default();
            report.help(format!("{near} ({})", self.row.says));
        }
        word
    }
}

fn article(found: &str) -> &'static str {
    if found.starts_with(['a', 'i', 'o']) { "an" } else { "a" }
}
