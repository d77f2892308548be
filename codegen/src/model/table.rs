//! TOML tables with places: every key is known or complained about, every value has the type that is asked
//! for.

use super::foreign_keys::foreign;
use super::key_examples::example;
use crate::diagnostic::{Report, Span, nearest};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table whose keys were checked.
#[derive(Debug)]
pub(super) struct Table<'t> {
    entries: Vec<Item<'t>>,
    /// Where it stands.
    pub span: Span,
    /// The thing that the table describes, with article: `a joint`.
    pub what: &'static str,
}

/// A key with its value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item<'t> {
    /// The key; in arrays that of the whole array.
    pub key: &'t str,
    /// Where the key stands.
    pub key_span: Span,
    /// The value.
    pub value: &'t DeValue<'t>,
    /// Where the value stands.
    pub span: Span,
}

impl<'t> Table<'t> {
    /// All entries in the order of their description.
    pub fn open(table: &'t DeTable<'t>, span: Span, what: &'static str) -> Self {
        let mut entries: Vec<Item<'t>> =
            table.iter().map(|(key, value)| entry(key, value, span.source)).collect();
        entries.sort_by_key(|item| item.key_span.start);
        Self { entries, span, what }
    }

    /// The same with an error for each key that is not among `keys`.
    pub fn checked(
        table: &'t DeTable<'t>,
        span: Span,
        what: &'static str,
        keys: &[&'static str],
        report: &mut Report,
    ) -> Self {
        let table = Self::open(table, span, what);
        for item in table.entries.iter().filter(|item| !keys.contains(&item.key)) {
            report.error(item.key_span, "unknown-key", format!("unknown key `{}` in {what}", item.key));
            if report.is_full() {
                continue;
            }
            let help = foreign(item.key, keys).map(str::to_owned);
            if let Some(help) = help.or_else(|| nearest(item.key, keys.iter().copied())) {
                report.help(help);
            }
        }
        table
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<Item<'t>> {
        self.entries.iter().find(|item| item.key == key).copied()
    }

    /// All keys with their values.
    pub fn items(&self) -> &[Item<'t>] {
        &self.entries
    }
}

/// Allowed values of a key if it is read as a table.
fn table_or(key: &str) -> &'static str {
    match key {
        "base" => "the name of a link in quotes, or a table",
        "spring" | "friction" => "a force law in quotes, or a table",
        "drive" => "\"ideal\", \"none\", or a table",
        _ => "a table",
    }
}

fn entry<'t>(
    key: &'t Spanned<toml::de::DeString<'t>>,
    value: &'t Spanned<DeValue<'t>>,
    source: usize,
) -> Item<'t> {
    Item {
        key: key.get_ref(),
        key_span: Span::new(source, key.span()),
        value: value.get_ref(),
        span: Span::new(source, value.span()),
    }
}

impl<'t> Item<'t> {
    /// Complains that the value should have been something else.
    pub fn expected(&self, what: &str, report: &mut Report) {
        let found = self.value.type_str();
        report.error(
            self.span,
            "wrong-type",
            format!("`{}` must be {what}, not {} {found}", self.key, article(found)),
        );
        self.help_by_example(what.starts_with("a list"), report);
    }

    /// Adds an example of the value to the last message.
    ///
    /// - `is_list`: whether the value has to be a list
    pub fn help_by_example(&self, is_list: bool, report: &mut Report) {
        if let Some(example) = example(self.key, is_list) {
            report.help(format!("for example {example}"));
        }
    }

    /// The value as text.
    pub fn text(&self, report: &mut Report) -> Option<&'t str> {
        let text = self.value.as_str();
        if text.is_none() {
            self.expected("a text in quotes", report);
        }
        text
    }

    /// The value as true or false.
    pub fn boolean(&self, report: &mut Report) -> Option<bool> {
        let value = self.value.as_bool();
        if value.is_none() {
            self.expected("true or false", report);
        }
        value
    }

    /// The value as a list of entries.
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

    /// The value as a table with known keys.
    pub fn table(&self, what: &'static str, keys: &[&'static str], report: &mut Report) -> Option<Table<'t>> {
        match self.value {
            DeValue::Table(table) => Some(Table::checked(table, self.span, what, keys, report)),
            _ => {
                self.expected(table_or(self.key), report);
                None
            }
        }
    }

    /// The value as a list of tables with known keys.
    pub fn tables(&self, what: &'static str, keys: &[&'static str], report: &mut Report) -> Vec<Table<'t>> {
        let expected = format!("a list of tables, each written [[{}]]", self.key);
        let items = self.array(&expected, report).unwrap_or_default();
        items.iter().filter_map(|item| item.table(what, keys, report)).collect()
    }
}

fn article(found: &str) -> &'static str {
    if found.starts_with(['a', 'i', 'o']) { "an" } else { "a" }
}
