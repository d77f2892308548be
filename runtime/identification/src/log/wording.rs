//! What is said of columns: why some were taken, and the line of `--columns` that settles what is not known.

use super::super::error::IdentificationError;
use super::families::{Family, Key, Targets, meaning_of};
use super::finder::Finder;
use super::sheet::shortened;
use super::vocabulary::{Kind, Origin};

impl Finder<'_> {
    pub(super) fn ambiguous(
        &self,
        kind: Kind,
        one: &[usize],
        other: &[usize],
        targets: &Targets,
    ) -> IdentificationError {
        let (one, other) = (self.pattern_of(one, targets), self.pattern_of(other, targets));
        self.fault(format!(
            "both `{one}` and `{other}` could be the {}: --columns '{}={one}' or '{}={other}' settles it",
            plural(kind),
            key(kind),
            key(kind)
        ))
    }

    /// Columns as `--columns` takes them.
    pub(super) fn pattern_of(&self, columns: &[usize], targets: &Targets) -> String {
        let text = |column: &usize| {
            self.headers.get(*column).map_or_else(|| (column + 1).to_string(), |header| self.unique(header))
        };
        let texts: Vec<String> = columns.iter().map(text).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let is_number = |text: &&str| text.parse::<usize>().is_ok();
        if texts.iter().any(is_number) {
            return texts.join("|");
        }
        let named =
            texts.iter().zip(&targets.names).map(|(text, name)| text.replacen(name.as_str(), "{name}", 1));
        let named: Vec<String> = named.collect();
        if named.first().is_some_and(|first| first.contains("{name}") && named.iter().all(|n| n == first)) {
            return named[0].clone();
        }
        numbered_pattern(&texts).unwrap_or_else(|| texts.join("|"))
    }

    pub(super) fn missing(&self, kinds: &[Kind], targets: &Targets) -> IdentificationError {
        let n = targets.names.len();
        if n == 0 {
            return self.fault(format!(
                "the description has no {}: give its joints a drive, as in `drive = {{ gear_ratio = 100 }}`, or say that efforts \
                 are torques of joints, --effort joint",
                plural(kinds[0])
            ));
        }
        let best = self.families(kinds, targets).into_iter().max_by_key(|f| {
            (f.columns.iter().flatten().count(), f.numbers.len(), std::cmp::Reverse(f.rank()))
        });
        let why = match best {
            Some(family) if family.numbers.len() > n => format!(
                "the columns like {} have {} numbers ({} to {}), the description has {n}: which of them are its own is \
                 not known",
                family.numbers_like(self),
                family.numbers.len(),
                family.numbers[0],
                family.numbers[family.numbers.len() - 1]
            ),
            Some(family) if family.columns.iter().any(Option::is_some) => {
                let missing = family.columns.iter().zip(&targets.names).filter(|(c, _)| c.is_none());
                let missing: Vec<String> = missing.map(|(_, name)| format!("`{name}`")).collect();
                format!("no column is the {} of {}", singular(kinds[0]), missing.join(", "))
            }
            _ => format!("no columns are known as the {} of {}", plural(kinds[0]), shortened(&targets.names)),
        };
        self.fault(format!(
            "{why}. There are {}. Name them: --columns '{}=…', with {{}} for a number, {{name}} for a joint's name, or \
             columns as in `a|b|c` or `2..7`",
            shortened(&self.sheet.headers),
            key(kinds[0])
        ))
    }
}

impl Family {
    fn numbers_like(&self, finder: &Finder) -> String {
        let words = finder
            .headers
            .iter()
            .find(|h| meaning_of(h, &h.words).is_some_and(|m| m.kind == self.meaning.kind));
        words.map_or("these".into(), |h| format!("`{}`", h.text))
    }
}

/// `q{}` of `q1`, `q2`, …; none where the numbers do not ascend: the pattern takes them in their order.
fn numbered_pattern(texts: &[&str]) -> Option<String> {
    let first = texts.first()?;
    let digits = |c: char| c.is_ascii_digit();
    let same = |at: usize, end: usize| {
        let (before, after) = (&first[..at], &first[end..]);
        let fits = |text: &&str| {
            let middle = text.strip_prefix(before).and_then(|rest| rest.strip_suffix(after))?;
            middle.parse::<u64>().ok().filter(|_| middle.chars().all(digits))
        };
        let numbers: Option<Vec<u64>> = texts.iter().map(fits).collect();
        let ascends = numbers?.windows(2).all(|pair| pair[0] < pair[1]);
        ascends.then(|| format!("{before}{{}}{after}"))
    };
    let mut at = 0;
    while let Some(start) = first[at..].find(digits).map(|s| s + at) {
        let end = first[start..].find(|c| !digits(c)).map_or(first.len(), |e| e + start);
        if let Some(pattern) = same(start, end) {
            return Some(pattern);
        }
        at = end;
    }
    None
}

pub(super) fn reason(family: &Family, other: &Family) -> String {
    let origin = |f: &Family| match f.meaning.origin {
        Origin::Measured => "measured",
        Origin::Unsaid => "neither measured nor commanded by their name",
        Origin::Filtered => "filtered",
        Origin::Commanded => "commanded",
    };
    if family.meaning.origin != other.meaning.origin {
        return format!("they are {}, the ones taken are {}", origin(other), origin(family));
    }
    if family.meaning.doubt != other.meaning.doubt {
        return "their names say it less surely".into();
    }
    "names of joints go before numbers".into()
}

/// Numbers say less than names: what they are taken for is said.
pub(super) fn order_said(family: &Family, kind: Kind) -> Option<String> {
    match family.key {
        Key::Number(first) if family.columns.len() > 1 => Some(format!(
            "The {} are told apart by numbers from {first} on, in the order of the description's joints; a message that \
             lists its joints in another order (ROS: often by the alphabet) would be mixed up.",
            plural(kind)
        )),
        Key::Listed => Some(format!("The {} are in the order of the names in the log's rows.", plural(kind))),
        _ => None,
    }
}

pub(super) fn singular(kind: Kind) -> &'static str {
    match kind {
        Kind::Time => "time",
        Kind::Position => "position",
        Kind::Velocity => "velocity",
        Kind::Acceleration => "acceleration",
        Kind::Torque => "effort",
        Kind::Input => "motor effort",
        Kind::Current => "current",
        Kind::Run => "run",
        Kind::Name => "name",
    }
}

pub(super) fn plural(kind: Kind) -> &'static str {
    match kind {
        Kind::Position => "positions",
        Kind::Velocity => "velocities",
        Kind::Torque | Kind::Input => "efforts",
        Kind::Current => "currents",
        other => singular(other),
    }
}

pub(super) fn key(kind: Kind) -> &'static str {
    match kind {
        Kind::Torque => "torque",
        Kind::Input => "input",
        other => singular(other),
    }
}
