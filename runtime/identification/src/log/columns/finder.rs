//! Search for columns, by the user's pattern or by the best family of headers.

use super::super::super::error::{IdentificationError, Result, at};
use super::super::sheet::{Sheet, shortened};
use super::super::units::{self, GRAD, Unit};
use super::families::{Family, Targets, families};
use super::found::{Column, Found};
use super::header::{Header, is_known, is_number, words};
use super::pattern::{Chosen, ColumnOptions, Pattern, is_spellable};
use super::robot::RobotColumns;
use super::table::{Kind, Origin};
use gelenk_findings::digits::plain;

/// Data for the search: a sheet, the joints of a robot, and the user's patterns for the columns.
pub(super) struct Finder<'a> {
    pub sheet: &'a Sheet<'a>,
    pub headers: Vec<Header>,
    pub robot: &'a RobotColumns,
    patterns: Vec<Pattern>,
    /// Names of the joints in the order of the log's messages; `None` if the rows do not list them.
    listed: Option<Vec<String>>,
    source: &'a str,
    /// End of messages that ask the user to name columns.
    hint: &'static str,
}

impl<'a> Finder<'a> {
    pub(super) fn new(
        sheet: &'a Sheet,
        robot: &'a RobotColumns,
        options: &ColumnOptions,
        source: &'a str,
        hint: &'static str,
    ) -> Result<Self> {
        let below = |i: usize| sheet.units.get(i).and_then(Option::as_deref);
        let headers = sheet.headers.iter().enumerate().map(|(i, text)| Header::new(i, text, below(i)));
        let headers: Vec<Header> = headers.collect();
        let listed = listed_names(sheet, &headers, robot);
        Ok(Self { sheet, headers, robot, patterns: options.patterns()?, listed, source, hint })
    }

    pub(super) fn fault(&self, message: String) -> IdentificationError {
        at(self.source).fault(message)
    }

    /// Returns the error that the headers are not sufficient, so that the user has to name the columns.
    pub(super) fn undecided(&self, message: String) -> IdentificationError {
        self.fault(format!("{message}{}", self.hint))
    }

    pub(super) fn pattern(&self, matches: impl Fn(Kind) -> bool) -> Option<&Pattern> {
        self.patterns.iter().find(|p| matches(p.kind))
    }

    /// Returns the name of a column for messages.
    pub(super) fn label(&self, column: usize) -> String {
        match self.headers.get(column) {
            Some(header) => format!("`{}`", header.text),
            None => format!("number {}", column + 1),
        }
    }

    /// Returns the name of a column for `--columns`: its header. If other columns have the same header, or if `--columns`
    /// cannot contain the header, the result is the number of the column.
    pub(super) fn unique(&self, column: usize) -> String {
        let Some(header) = self.headers.get(column) else { return (column + 1).to_string() };
        let is_only = self.headers.iter().filter(|h| h.text == header.text).count() == 1;
        if is_only && is_spellable(&header.text) { header.text.clone() } else { (column + 1).to_string() }
    }

    /// Returns the names of columns for `--columns`: a pattern if one fits exactly these columns, otherwise a list.
    pub(super) fn pattern_of(&self, columns: &[usize], targets: &Targets) -> String {
        let texts: Vec<String> = columns.iter().map(|column| self.unique(*column)).collect();
        let list = texts.join("|");
        if texts.iter().any(|text| text.parse::<usize>().is_ok()) {
            return list;
        }
        let named = texts.first().zip(targets.names.first());
        let named = named.map(|(text, name)| text.replacen(name.as_str(), "{name}", 1));
        let named = named.filter(|text| text.contains("{name}"));
        let names_them = |text: &String| {
            let chosen = Pattern::new(Kind::Position, text).resolve(&self.headers, self.sheet.width, targets);
            chosen.is_ok_and(|chosen| chosen.columns == columns)
        };
        named.into_iter().chain(numbered_patterns(&texts)).find(names_them).unwrap_or(list)
    }

    pub(super) fn by_pattern(&self, pattern: &Pattern, targets: &Targets) -> Result<Chosen> {
        pattern.resolve(&self.headers, self.sheet.width, targets)
    }

    pub(super) fn families(&self, kinds: &[Kind], targets: &Targets) -> Vec<Family> {
        let mut all = families(&self.headers, targets, self.listed.as_deref());
        all.retain(|f| kinds.contains(&f.meaning.kind));
        all.sort_by_key(|f| (kinds.iter().position(|k| *k == f.meaning.kind), f.rank()));
        all
    }

    /// Returns the best complete family; `None` if no family is complete.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if two families are equally good.
    pub(super) fn best(&self, kinds: &[Kind], targets: &Targets) -> Result<Option<Chosen>> {
        let mut complete: Vec<(Family, Vec<usize>)> = Vec::new();
        for family in self.families(kinds, targets) {
            if let Some(columns) = family.complete()
                && complete.iter().all(|(_, known)| *known != columns)
            {
                complete.push((family, columns));
            }
        }
        let Some((family, columns)) = complete.first() else { return Ok(None) };
        let is_rival =
            |other: &Family| other.meaning.kind == family.meaning.kind && other.rank() == family.rank();
        if let Some((_, others)) = complete.iter().skip(1).find(|(other, _)| is_rival(other)) {
            return Err(self.ambiguous(kinds[0], [columns, others].map(|of| self.pattern_of(of, targets))));
        }
        let is_commanded = family.meaning.origin == Origin::Commanded;
        Ok(Some(Chosen { is_commanded, ..Chosen::alike(columns.clone(), None) }))
    }

    /// Returns the columns that the user names, or else the best family; `None` if there are no columns.
    pub(super) fn optional(&self, kind: Kind, targets: &Targets) -> Result<Option<Chosen>> {
        match self.pattern(|k| k == kind) {
            Some(pattern) => self.by_pattern(pattern, targets).map(Some),
            None => self.best(&[kind], targets),
        }
    }

    /// Returns the columns with their units.
    ///
    /// # Errors
    /// [`IdentificationError::File`] if a unit is unknown or does not fit the quantity.
    pub(super) fn found(&self, chosen: Chosen, kind: Kind, targets: &Targets) -> Result<Found> {
        let of_inputs = matches!(kind, Kind::Input | Kind::Current);
        let units = if of_inputs { &self.robot.input_units } else { &self.robot.units };
        let all = chosen.columns.iter().zip(&chosen.units).zip(&targets.places);
        let column = |((index, stated), place): ((&usize, &Option<Unit>), &usize)| {
            self.column(*index, kind, units.get(*place) == Some(&"m"), *stated)
        };
        Ok(Found {
            kind,
            pattern: self.pattern_of(&chosen.columns, targets),
            columns: all.map(column).collect::<Result<_>>()?,
            names: targets.names.clone(),
            places: targets.places.clone(),
            is_commanded: chosen.is_commanded,
        })
    }

    /// Returns a column with its unit, which comes from the user, the header or the row of units.
    pub(super) fn column(
        &self,
        index: usize,
        kind: Kind,
        is_linear: bool,
        stated: Option<Unit>,
    ) -> Result<Column> {
        let wanted = kind.row().units[usize::from(is_linear)];
        let header = self.headers.get(index);
        let (label, written) = (self.label(index), self.unique(index));
        let named = stated.or_else(|| header.and_then(|h| h.unit));
        let odd =
            header.and_then(|h| h.odd.as_ref()).filter(|odd| named.is_none() && !self.is_described(odd));
        if let Some(odd) = odd {
            return Err(self.fault(format!(
                "column {} is in `{odd}`, which is not a known unit. Give the unit with --columns '{}=…[UNIT]', if necessary \
                 with a factor, as in [0.0879 deg]. Known units: {}",
                label,
                kind.key(),
                units::known_units()
            )));
        }
        let Some(unit) = named.or_else(|| header.and_then(|h| self.suffix(h, wanted))) else {
            let unit_words = format!("in {} because the header has no unit", wanted[0]);
            let (unit, is_stated) = (Unit { factor: 1.0, si: wanted[0] }, wanted[0] != "1");
            return Ok(Column { index, label, written, unit, unit_words, is_stated });
        };
        let fits = wanted.contains(&unit.si) || unit.si == "1";
        if !fits || kind == Kind::Attitude && unit.factor != 1.0 {
            return Err(self.fault(misfit(&label, kind, unit, wanted)));
        }
        let unit_words = match unit.factor {
            1.0 => format!("in {}", unit.si),
            factor => format!("times {} in {}", plain(factor, 6), unit.si),
        };
        Ok(Column { index, label, written, unit, unit_words, is_stated: stated.is_some() })
    }

    /// Returns whether text in brackets is not a unit, but consists of known words of headers or of a joint's name.
    pub(super) fn is_described(&self, text: &str) -> bool {
        let spelled = words(text);
        is_known(&spelled) || self.is_named(&spelled)
    }

    /// Returns whether words are the name of a joint or an input. For example, `turn` in `tau_turn` is not a unit if a
    /// joint is called `turn`.
    fn is_named(&self, spelled: &[String]) -> bool {
        self.robot.all_joints.mentions(spelled) || self.robot.inputs.mentions(spelled)
    }

    /// Returns the unit at the end of the words, for example of `q1_deg` or `vel_2_deg_s`; `None` if there is no unit.
    pub(super) fn suffix(&self, header: &Header, wanted: &[&str]) -> Option<Unit> {
        let words: Vec<String> = header.words.iter().filter(|w| !is_number(w)).cloned().collect();
        let tails = (1..=3.min(words.len().saturating_sub(1))).rev().map(|n| &words[words.len() - n..]);
        let mut named = tails.filter(|tail| !self.is_named(tail)).filter_map(|tail| {
            let parts: Vec<&str> = tail.iter().map(String::as_str).filter(|w| *w != "per").collect();
            // A single letter may have another meaning (`q_m` for measured). It counts only if it fits the quantity.
            let is_sure = parts.first().is_some_and(|p| p.len() > 1);
            let unit = units::in_header(&parts.join("/"), header.is_translated);
            unit.filter(|unit| is_sure || wanted.contains(&unit.si))
        });
        named.next()
    }

    /// Returns the error that two sets of columns are possible for one quantity.
    pub(super) fn ambiguous(&self, kind: Kind, [one, other]: [String; 2]) -> IdentificationError {
        let key = kind.key();
        self.undecided(format!(
            "both `{one}` and `{other}` could be the {}: use --columns '{key}={one}' or '{key}={other}'",
            kind.plural()
        ))
    }

    /// Returns the error that a quantity has no columns, or no column for some joints.
    pub(super) fn missing(&self, kinds: &[Kind], targets: &Targets) -> IdentificationError {
        let (n, kind) = (targets.names.len(), kinds[0]);
        if n == 0 {
            return self.fault(format!(
                "the description has no drives, so the columns cannot be {} of motors. Give the joints a drive, as in `drive = {{ \
                 gear_ratio = 100 }}`. If the efforts are torques at the joints, use --effort joint",
                kind.plural()
            ));
        }
        let best = self.families(kinds, targets).into_iter().max_by_key(|f| {
            (f.columns.iter().flatten().count(), f.numbers.len(), std::cmp::Reverse(f.rank()))
        });
        let mut hold = String::new();
        let why = match best {
            Some(family) if family.numbers.len() > n => format!(
                "it is not clear which columns like {} belong to the robot. They have {} numbers ({} to {}), but the robot needs only {n}",
                self.example(family.meaning.kind),
                family.numbers.len(),
                family.numbers[0],
                family.numbers[family.numbers.len() - 1]
            ),
            Some(family) if family.columns.iter().any(Option::is_some) => {
                let missing = family.columns.iter().zip(&targets.names).filter(|(c, _)| c.is_none());
                let missing: Vec<&str> = missing.map(|(_, name)| name.as_str()).collect();
                if kind == Kind::Position {
                    let options: Vec<String> =
                        missing.iter().map(|name| format!("--hold {name}=0")).collect();
                    hold = format!(
                        ". If a joint without a column was at rest, give its position: {}",
                        options.join(" ")
                    );
                }
                format!("the log has no column for the {} of `{}`", kind.singular(), missing.join("`, `"))
            }
            _ => format!(
                "the log has no columns with a usual name for the {} of {}",
                kind.plural(),
                shortened(&targets.names)
            ),
        };
        self.undecided(format!(
            "{why}. The columns are: {}. Name the right ones with --columns '{}=…', with {{}} for a number, {{name}} for a \
             joint's name, or columns as in `a|b|c` or `2..7`{hold}",
            shortened(&self.sheet.headers),
            kind.key()
        ))
    }

    /// Returns a text that names a header of a quantity.
    fn example(&self, kind: Kind) -> String {
        let header = self.headers.iter().find(|h| h.meaning(&h.words).is_some_and(|m| m.kind == kind));
        header.map_or("these".into(), |h| format!("`{}`", h.text))
    }

    /// Returns whether columns are commanded. The header of the first column decides.
    pub(super) fn is_commanded(&self, columns: &[usize]) -> bool {
        let header = columns.first().and_then(|column| self.headers.get(*column));
        header.and_then(Header::own_meaning).is_some_and(|m| m.origin == Origin::Commanded)
    }
}

/// Returns the message about a unit that does not fit the quantity.
fn misfit(label: &str, kind: Kind, unit: Unit, wanted: &[&str]) -> String {
    let name = kind.singular();
    if kind == Kind::Attitude {
        return format!(
            "column {label} has a unit, but entries of a quaternion have none. If the columns are angles, convert them to \
             quaternions, e.g. by `Rotation.from_euler(…).as_quat()` of scipy"
        );
    }
    if unit.si == GRAD {
        let key = kind.key();
        let behind = if kind == Kind::Velocity { "/s" } else { "" };
        let gon = if kind == Kind::Position { format!(" or '{key}=…[gon]'") } else { String::new() };
        return format!(
            "column {label} is in `Grad`, which is a degree in German, but a gon (a hundredth of a right angle) in other \
             languages. Use --columns '{key}=…[deg{behind}]'{gon}"
        );
    }
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("column {label} is {article} {name} in {}, but {} is expected here", unit.si, wanted.join(" or "))
}

/// Returns patterns such as `q{}` for `q1`, `q2`, …, one for each number in the first text.
fn numbered_patterns(texts: &[String]) -> Vec<String> {
    let Some(first) = texts.first() else { return Vec::new() };
    let is_digit = |c: char| c.is_ascii_digit();
    let starts = first.char_indices().filter(|(at, c)| is_digit(*c) && !first[..*at].ends_with(is_digit));
    let pattern = |(start, _): (usize, char)| {
        let end = first[start..].find(|c| !is_digit(c)).map_or(first.len(), |e| e + start);
        format!("{}{{}}{}", &first[..start], &first[end..])
    };
    starts.map(pattern).collect()
}

/// Returns the names of the joints in the order of a message whose rows list them (`field.name0`, … or one list of names);
/// `None` if a name is missing.
fn listed_names(sheet: &Sheet, headers: &[Header], robot: &RobotColumns) -> Option<Vec<String>> {
    let is_name = |h: &&Header| h.own_meaning().is_some_and(|m| m.kind == Kind::Name);
    let columns: Vec<&Header> = headers.iter().filter(is_name).collect();
    let value = |h: &&Header| sheet.first.get(h.index).map(|text| text.trim().to_owned());
    let names: Vec<String> = match columns.as_slice() {
        [only] => value(only)?.split(['\'', '"']).skip(1).step_by(2).map(str::to_owned).collect(),
        several => several.iter().filter_map(value).collect(),
    };
    let listed: Vec<Option<usize>> = names.iter().map(|name| robot.joints.named(name)).collect();
    let all = (0..robot.joints.names.len()).all(|j| listed.contains(&Some(j)));
    (all && !names.is_empty()).then_some(names)
}
