//! TOML tables with places: every key is known or complained about, every value has the type that is asked
//! for.

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

/// What says the same here as a key of other formats or tables.
fn foreign(key: &str, keys: &[&str]) -> Option<&'static str> {
    match key {
        "mimic" if keys.contains(&"follows") => {
            Some("a joint follows others with `follows = { shoulder = -0.5 }`")
        }
        "stiffness" | "rest" | "damping" if keys.contains(&"law") && keys.contains(&"between") => Some(
            "`law = \"1200*(l - 0.3) + 40*dl\"` is a spring and damper over the distance l and its rate dl",
        ),
        _ => None,
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
        if let Some(example) = example(self.key) {
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
                self.expected("a table", report);
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

/// How the value of a key may be written, where its type says too little.
pub(super) fn example(key: &str) -> Option<&'static str> {
    Some(match key {
        "gravity" => "`gravity = [0, 0, -9.81]`",
        "axis" => "`axis = [0, 1, 0]`",
        "origin" => "`origin = { xyz = [0, 0, 0.5], rpy = [0, 0, 0] }`",
        "quaternion" => "`quaternion = { w = 1, x = 0, y = 0, z = 0 }`",
        "dh" | "modified_dh" => "`{ a = 0.4, alpha = \"pi/2\", d = 0, theta = 0 }`",
        "center_of_mass" => "`center_of_mass = [0, 0, 0.1]`",
        "inertia" => INERTIA,
        "limits" => "`limits = { position = [-1.5, 1.5], velocity = 2, effort = 40 }`",
        "position" => "`position = [-1.5, 1.5]`",
        "friction" => "`friction = { viscous = 0.4 }` or `friction = \"0.4*v + 0.2*sign(v)\"`",
        "spring" => "`spring = { stiffness = 3, rest = 0.1 }`",
        "drive" => "`drive = { gear_ratio = 100, rotor_inertia = 2e-5 }` or `drive = \"ideal\"`",
        "joints" => "`[[joints]]`, in two brackets, before the keys of each joint",
        "bodies" => "`[[bodies]]`, in two brackets, before the keys of each body",
        "frames" => "`[[frames]]`, in two brackets, before the keys of each frame",
        "parameters" => "`[parameters]`, and below it `m1 = 2.5`",
        "name" => "`name = \"elbow\"`",
        "held" => "`held = 0.5` or `held = \"pi/4\"`",
        "mass" => "`mass = 2.5` or `mass = \"payload\"`",
        "follows" => "`follows = { shoulder = -0.5 }`: the joints that are followed, with their ratios",
        "on" => "`on = { pitch = 1, roll = -1 }`: the joints that the drive moves, with their weights",
        "pitch" => "`pitch = \"0.02/(2*pi)\"`: metres for each radian, here 20 mm a turn",
        "frame" => "`frame = \"tool\"`: the name of a frame or link",
        "wrench" => "`wrench = [0, 0, 1, 0, 0, 0.02]`: the force of a unit input, then its moment",
        "between" => "`between = [\"anchor\", \"hook\"]`: the names of two frames or links",
        "carrier" => "`carrier = \"forearm\"`: the link that the motor sits on",
        "torque" => "`torque = { nominal = 0.4, peak = 0.9 }`",
        "nominal" | "peak" => "`torque = { nominal = 0.4, peak = 0.9 }`, in newton metres at the motor",
        "stroke" => "`stroke = [0.8, 1.3]`: shortest and longest distance of the two frames, in m",
        "speed" => "`speed = 300`: rad/s of a motor's shaft, m/s of a force between two frames",
        "velocity" => "`velocity = 2`, in rad/s or m/s",
        "effort" | "peak_effort" => "`effort = 40`, in N m or N",
        _ => return None,
    })
}

/// The forms of an inertia.
const INERTIA: &str = "`0.1` for all axes, the principal moments `[0.1, 0.1, 0.02]`, or `{ xx = 0.1, yy = 0.1, zz = 0.02, xy = 0, xz = 0, yz = 0 }`";

fn article(found: &str) -> &'static str {
    if found.starts_with(['a', 'i', 'o']) { "an" } else { "a" }
}
