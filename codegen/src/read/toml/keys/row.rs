//! Types for the tables of keys: each row contains name, allowed values and meaning of one key.

/// All keys that one table of a description may have.
#[derive(Debug)]
pub(crate) struct Keys {
    /// Name of the table in the JSON schema.
    #[cfg_attr(not(feature = "cli"), expect(dead_code, reason = "of the schema alone"))]
    pub(crate) name: &'static str,
    /// The object that the table describes, with article, for example `a joint`.
    pub(crate) what: &'static str,
    /// Groups of keys that the table may have. Several tables may share a group.
    pub(crate) groups: &'static [&'static [Key]],
}

/// A key of a table in a description, with allowed values and meaning.
#[derive(Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) value: Value,
    /// SI unit of the value; empty if the value has no unit or several units.
    pub(crate) unit: &'static str,
    /// Value that applies if the key is absent, or the meaning of its absence, as text.
    #[cfg_attr(not(feature = "cli"), expect(dead_code, reason = "of the schema alone"))]
    pub(crate) default: &'static str,
    /// Example of the key's value in TOML.
    pub(crate) example: &'static str,
    /// Meaning of the key, for help texts and documentation.
    pub(crate) says: &'static str,
    /// Names of the same quantity in other formats, data sheets and tables, for suggestions.
    pub(crate) also: &'static [&'static str],
    /// Whether the table must have the key.
    pub(crate) is_needed: bool,
}

/// Type of the values that a key may have.
#[derive(Debug)]
pub(crate) enum Value {
    /// Any text, also with several lines.
    Text,
    /// A name: one line of text.
    Name,
    Flag,
    /// A number, or a formula of numbers.
    Number,
    /// A number or formula that is greater than 0.
    Positive,
    /// A number, a formula of parameters, or `{ free = … }`.
    Formula,
    /// A force law as text, a formula of position and velocity.
    Law,
    /// One of these words, as text.
    Words(&'static [&'static str]),
    /// A list of this number of values; `None` allows any number.
    List(&'static Self, Option<usize>),
    /// A list of two values of different kinds.
    Pair(&'static [Self; 2]),
    Table(&'static Keys),
    /// A table whose keys are names that the user chooses.
    Names(&'static Self),
    /// One value. For joints with several degrees of freedom, a table with a value for each part.
    ByPart(&'static Self),
    Either(&'static [Self]),
}

/// Creates a key with the fields that all keys have.
pub(super) const fn key(name: &'static str, value: Value, example: &'static str, says: &'static str) -> Key {
    Key { name, value, unit: "", default: "", example, says, also: &[], is_needed: false }
}

impl Key {
    pub(super) const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    pub(super) const fn default(self, default: &'static str) -> Self {
        Self { default, ..self }
    }

    pub(super) const fn also(self, also: &'static [&'static str]) -> Self {
        Self { also, ..self }
    }

    pub(super) const fn needed(self) -> Self {
        Self { is_needed: true, ..self }
    }

    /// Text of the key with its example value and unit.
    pub(crate) fn line(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(", in {}", self.unit) };
        format!("`{} = {}`{unit}", self.name, self.example)
    }

    /// Text of the key's meaning, with unit and default.
    #[cfg(feature = "cli")]
    pub(crate) fn description(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        let default = match (self.is_needed, self.default) {
            (true, _) => "; required".to_owned(),
            (false, "") => String::new(),
            (false, default) => format!("; default: {default}"),
        };
        let words: Vec<String> = self.value.words().iter().map(|word| format!("`{word:?}`")).collect();
        let words = if words.is_empty() { String::new() } else { format!("{}: ", words.join(", ")) };
        format!("{words}{}{unit}{default}", self.says)
    }
}

impl Keys {
    pub(crate) fn rows(&self) -> impl Iterator<Item = &'static Key> + use<> {
        self.groups.iter().copied().flatten()
    }

    pub(crate) fn row(&self, name: &str) -> Option<&'static Key> {
        self.rows().find(|row| row.name == name)
    }
}

impl Value {
    /// The types of the entries of a list, pair or table, or the alternatives if a value may have several
    /// types.
    fn parts(&self) -> &[Self] {
        match self {
            Self::List(entry, _) | Self::Names(entry) | Self::ByPart(entry) => std::slice::from_ref(entry),
            Self::Pair(entries) => &entries[..],
            Self::Either(values) => values,
            _ => &[],
        }
    }

    /// Keys of the table that the value is or contains; `None` if it contains no table.
    pub(crate) fn keys(&self) -> Option<&'static Keys> {
        match self {
            Self::Table(keys) => Some(keys),
            other => other.parts().iter().find_map(Self::keys),
        }
    }

    /// Words that the value may be; empty if the value is not a word.
    pub(crate) fn words(&self) -> &'static [&'static str] {
        match self {
            Self::Words(words) => words,
            other => {
                other.parts().iter().map(Self::words).find(|words| !words.is_empty()).unwrap_or_default()
            }
        }
    }

    /// Whether numbers in the value must be positive.
    pub(crate) fn is_positive(&self) -> bool {
        matches!(self, Self::Positive) || self.parts().iter().any(Self::is_positive)
    }

    /// Whether the value is a list of tables.
    pub(crate) fn is_tables(&self) -> bool {
        matches!(self, Self::List(Self::Table(_), None))
    }

    /// Text that lists the types that the value may have.
    pub(crate) fn kinds(&self) -> String {
        match self {
            Self::Text | Self::Name => "a text in quotes".to_owned(),
            Self::Flag => "true or false".to_owned(),
            Self::Number | Self::Positive | Self::Formula => "a number or a formula".to_owned(),
            Self::Law => "a force law in quotes".to_owned(),
            Self::Words(words) => words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", "),
            Self::List(_, Some(count)) => format!("a list of {count}"),
            Self::List(..) | Self::Pair(_) => "a list".to_owned(),
            Self::Table(_) | Self::Names(_) => "a table".to_owned(),
            Self::ByPart(value) => value.kinds(),
            Self::Either(values) => {
                let kinds: Vec<String> = values.iter().map(Self::kinds).collect();
                match kinds.split_last() {
                    Some((last, others)) if !others.is_empty() => format!("{}, or {last}", others.join(", ")),
                    _ => kinds.concat(),
                }
            }
        }
    }
}
