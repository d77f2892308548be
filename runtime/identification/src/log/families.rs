//! Columns that belong together: one quantity of all joints, told apart by the joints' names or by numbers.

use super::units;
use super::vocabulary::{Header, Kind, Meaning, Origin, is_number, is_plain, meaning, words};
use std::collections::BTreeMap;

/// What the columns of a family are told apart by. The order is the one in which families are preferred.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key {
    /// The names of the joints or inputs.
    Name,
    /// Names that stand in the rows of the log (a ROS message's), by their numbers.
    Listed,
    /// Numbers, of which the first is this.
    Number(u64),
    /// Nothing: there is one joint.
    Alone,
}

/// One quantity of several joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    pub meaning: Meaning,
    pub key: Key,
    /// Column of each joint or input; none where the log has no such column.
    pub columns: Vec<Option<usize>>,
    /// Numbers of columns that told the joints apart, where numbers did.
    pub numbers: Vec<u64>,
}

impl Family {
    /// All columns, where none is missing.
    pub(super) fn complete(&self) -> Option<Vec<usize>> {
        self.columns.iter().copied().collect()
    }

    pub(super) fn rank(&self) -> (Origin, u8, Key) {
        // Which number is the first is no reason to prefer a family.
        let key = if let Key::Number(_) = self.key { Key::Number(0) } else { self.key };
        (self.meaning.origin, self.meaning.doubt, key)
    }
}

/// Names that columns are matched with: for each joint or input, the words of its names.
#[derive(Debug, Clone)]
pub(super) struct Targets {
    pub names: Vec<String>,
    aliases: Vec<Vec<Vec<String>>>,
}

impl Targets {
    /// - `others`: a second name of each, or an empty slice
    pub(super) fn new(names: &[String], others: &[Option<String>]) -> Self {
        let spelled: Vec<Vec<String>> = names.iter().map(|n| words(n)).collect();
        let short: Vec<Vec<String>> = spelled.iter().map(|w| without_joint(w)).collect();
        let aliases = (0..names.len()).map(|i| {
            let unique = short.iter().filter(|s| **s == short[i]).count() == 1;
            let named = short[i].iter().any(|w| !is_number(w) && w.chars().count() > 1);
            let mut aliases = vec![spelled[i].clone()];
            aliases.extend((unique && named).then(|| short[i].clone()));
            aliases.extend(others.get(i).and_then(Option::as_ref).map(|other| words(other)));
            aliases.retain(|a| !a.is_empty());
            aliases
        });
        Self { names: names.to_vec(), aliases: aliases.collect() }
    }

    /// The joint whose name stands in the words, by the longest name, and the words without it.
    fn find(&self, header: &[String]) -> Option<(usize, Vec<String>)> {
        let mut best: Option<(usize, usize, usize)> = None;
        for (joint, alias) in self.aliases.iter().enumerate().flat_map(|(j, a)| a.iter().map(move |a| (j, a)))
        {
            let at = header.windows(alias.len()).rposition(|window| window == alias.as_slice());
            if let Some(at) = at
                && best.is_none_or(|(_, _, length)| alias.len() > length)
            {
                best = Some((joint, at, alias.len()));
            }
        }
        let (joint, at, length) = best?;
        Some((joint, [&header[..at], &header[at + length..]].concat()))
    }

    /// The words name a joint.
    pub(super) fn mentions(&self, words: &[String]) -> bool {
        self.mentioned(words).is_some()
    }

    /// The joint that the words name.
    pub(super) fn mentioned(&self, words: &[String]) -> Option<usize> {
        self.find(words).map(|(joint, _)| joint)
    }

    /// The joint of exactly this name.
    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }
}

/// `wrist_1` of `wrist_1_joint`.
fn without_joint(words: &[String]) -> Vec<String> {
    words.iter().filter(|w| *w != "joint").cloned().collect()
}

/// All families of the headers.
///
/// - `listed`: joints by their number in the log's messages, where the rows name them
pub(super) fn families(
    headers: &[Header],
    targets: &Targets,
    listed: Option<&[Option<usize>]>,
) -> Vec<Family> {
    let mut families = by_name(headers, targets);
    families.extend(by_number(headers, targets.names.len(), listed));
    if targets.names.len() == 1 {
        families.extend(alone(headers));
    }
    families
}

/// Columns with the same phrase, in the order of the file.
type Groups = BTreeMap<Phrase, Vec<usize>>;

fn push(groups: &mut Groups, key: Phrase, column: usize) {
    groups.entry(key).or_default().push(column);
}

fn said(words: &[String]) -> Option<Meaning> {
    let words: Vec<&str> = words.iter().map(String::as_str).filter(|w| !is_number(w) && *w != "#").collect();
    meaning(&words)
}

/// The quantity that a unit in brackets belongs to.
fn kind_of_unit(header: &Header) -> Option<Kind> {
    match header.unit?.si {
        "rad" | "m" => Some(Kind::Position),
        "rad/s" | "m/s" => Some(Kind::Velocity),
        "rad/s^2" | "m/s^2" => Some(Kind::Acceleration),
        "N*m" | "N" => Some(Kind::Torque),
        "A" => Some(Kind::Current),
        "s" => Some(Kind::Time),
        _ => None,
    }
}

/// The meaning of a header without the words that tell its joint: what these words say, or the unit in brackets where
/// they say nothing (`A1 [deg]`).
pub(super) fn meaning_of(header: &Header, words: &[String]) -> Option<Meaning> {
    let Some(kind) = kind_of_unit(header) else { return said(words) };
    // `a` is an axis as often as an acceleration.
    let is_silent = words.iter().all(|w| is_number(w) || w == "#" || w == "a" || is_plain(w) && w.len() > 1);
    if is_silent {
        return Some(Meaning { kind, origin: Origin::Unsaid, doubt: 1 });
    }
    let meaning = said(words)?;
    // An `effort` in ampere is a current.
    let is_current = matches!(meaning.kind, Kind::Torque | Kind::Input) && kind == Kind::Current;
    Some(if is_current { Meaning { kind, ..meaning } } else { meaning })
}

/// Words without those that tell the joint, and the quantity of the unit: columns of one quantity have the same.
type Phrase = (Option<Kind>, Vec<String>);

fn by_name(headers: &[Header], targets: &Targets) -> Vec<Family> {
    let mut groups = Groups::new();
    let mut joints = vec![None; headers.len()];
    for header in headers {
        let Some((joint, rest)) = targets.find(&header.words) else { continue };
        if meaning_of(header, &rest).is_some() {
            joints[header.index] = Some(joint);
            push(&mut groups, (kind_of_unit(header), rest), header.index);
        }
    }
    let stems = by_stem(&groups);
    let family = |((_, rest), members): (Phrase, Vec<usize>)| {
        let meaning = meaning_of(&headers[members[0]], &rest)?;
        let mut columns = vec![None; targets.names.len()];
        let mut twice = false;
        for member in members {
            let slot = &mut columns[joints[member]?];
            twice |= slot.replace(member).is_some();
        }
        let is_sure = !twice && !counts_from_zero(headers, &columns, targets);
        is_sure.then_some(Family { meaning, key: Key::Name, columns, numbers: Vec::new() })
    };
    groups.into_iter().chain(stems).filter_map(family).collect()
}

/// Groups that differ in a unit at the end only, as one: `cart_pos_mm` and `pole_pos_deg`.
fn by_stem(groups: &Groups) -> Groups {
    let mut stems: BTreeMap<Phrase, (usize, Vec<usize>)> = BTreeMap::new();
    for ((unit, rest), members) in groups {
        let (parts, all) = stems.entry((*unit, without_unit(rest))).or_default();
        *parts += 1;
        all.extend(members);
    }
    stems.into_iter().filter(|(_, (parts, _))| *parts > 1).map(|(phrase, (_, all))| (phrase, all)).collect()
}

/// The joints' names are numbers from 1 on, and the columns have a 0 besides: their 1 may be the second joint.
fn counts_from_zero(headers: &[Header], columns: &[Option<usize>], targets: &Targets) -> bool {
    let Some(first) = columns.iter().flatten().next() else { return false };
    let zero = |word: &String| if is_number(word) { "0".into() } else { word.clone() };
    let zeroed: Vec<String> = headers[*first].words.iter().map(zero).collect();
    let has_zero = zeroed.iter().any(|w| w == "0") && headers.iter().any(|h| h.words == zeroed);
    has_zero && !targets.names.iter().any(|name| words(name).iter().any(|w| w == "0"))
}

/// Words without a unit of several letters at their end.
fn without_unit(words: &[String]) -> Vec<String> {
    let is_unit = |tail: &[String]| tail[0].chars().count() > 1 && units::find(&tail.join("/")).is_some();
    let tail = (1..=2).rev().find(|n| words.len() > *n && is_unit(&words[words.len() - n..]));
    words[..words.len() - tail.unwrap_or(0)].to_vec()
}

fn by_number(headers: &[Header], count: usize, listed: Option<&[Option<usize>]>) -> Vec<Family> {
    let mut shapes = Groups::new();
    for header in headers.iter().filter(|h| h.words.iter().any(|w| is_number(w))) {
        let shape = header.words.iter().map(|w| if is_number(w) { "#".into() } else { w.clone() }).collect();
        push(&mut shapes, (kind_of_unit(header), shape), header.index);
    }
    let mut families = Vec::new();
    for ((unit, shape), members) in shapes {
        let slot = varying_slot(headers, &shape, &members);
        let mut groups = Groups::new();
        for member in members {
            let number = headers[member].words[slot].clone();
            let mut rest = headers[member].words.clone();
            rest.remove(slot);
            // `joint1_q1` says its number twice.
            rest.iter_mut().filter(|word| **word == number).for_each(|word| "#".clone_into(word));
            push(&mut groups, (unit, rest), member);
        }
        let stems = by_stem(&groups);
        families.extend(groups.iter().chain(&stems).filter_map(|((_, rest), members)| {
            let meaning = meaning_of(&headers[members[0]], rest)?;
            numbered(headers, members, slot, count, listed).map(|(key, columns, numbers)| Family {
                meaning,
                key,
                columns,
                numbers,
            })
        }));
    }
    families
}

/// The number that tells the columns of a shape apart: the one with the most values, the last of several.
fn varying_slot(headers: &[Header], shape: &[String], members: &[usize]) -> usize {
    let values = |slot: usize| {
        let mut values: Vec<&str> = members.iter().map(|m| headers[*m].words[slot].as_str()).collect();
        values.sort_unstable();
        values.dedup();
        values.len()
    };
    let slots = shape.iter().enumerate().filter(|(_, word)| *word == "#").map(|(slot, _)| slot);
    slots.max_by_key(|slot| values(*slot)).unwrap_or(0)
}

type Numbered = (Key, Vec<Option<usize>>, Vec<u64>);

/// Columns in the order of their numbers: from 0, from 1, or as many consecutive ones as there are joints.
fn numbered(
    headers: &[Header],
    members: &[usize],
    slot: usize,
    count: usize,
    listed: Option<&[Option<usize>]>,
) -> Option<Numbered> {
    let mut sorted: Vec<(u64, usize)> = Vec::new();
    for member in members {
        sorted.push((headers[*member].words.get(slot)?.parse().ok()?, *member));
    }
    sorted.sort_unstable();
    let numbers: Vec<u64> = sorted.iter().map(|s| s.0).collect();
    if numbers.windows(2).any(|w| w[0] == w[1]) {
        return None;
    }
    let first = *numbers.first()?;
    if let Some(listed) = listed.filter(|l| first == 0 && l.len() == numbers.len()) {
        let mut columns = vec![None; count];
        for (joint, (_, member)) in listed.iter().zip(&sorted) {
            if let Some(slot) = joint.and_then(|j| columns.get_mut(j)) {
                *slot = Some(*member);
            }
        }
        return Some((Key::Listed, columns, numbers));
    }
    let consecutive = numbers.last()? - first == numbers.len() as u64 - 1;
    let columns = if numbers.len() == count && consecutive {
        sorted.iter().map(|s| Some(s.1)).collect()
    } else {
        let base = u64::from(first != 0);
        let found = |joint: u64| sorted.iter().find(|s| Some(s.0) == base.checked_add(joint)).map(|s| s.1);
        let mut columns: Vec<Option<usize>> = (0..count as u64).map(found).collect();
        // More numbers than joints: which of them are the robot's is not known.
        if numbers.len() > count {
            columns.fill(None);
        }
        columns
    };
    Some((Key::Number(first), columns, numbers))
}

fn alone(headers: &[Header]) -> Vec<Family> {
    let plain = headers.iter().filter(|h| !h.words.iter().any(|w| is_number(w)));
    let family = |header: &Header| {
        let meaning = meaning_of(header, &header.words)?;
        Some(Family { meaning, key: Key::Alone, columns: vec![Some(header.index)], numbers: Vec::new() })
    };
    plain.filter_map(family).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(headers: &[&str], names: &[&str]) -> Vec<(Kind, Key, Option<Vec<usize>>)> {
        let headers: Vec<Header> = headers.iter().enumerate().map(|(i, h)| Header::new(i, h, None)).collect();
        let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        let families = families(&headers, &Targets::new(&names, &[]), None);
        families.iter().map(|f| (f.meaning.kind, f.key, f.complete())).collect()
    }

    #[test]
    fn joints_are_told_by_name() {
        let names = ["shoulder_joint", "wrist_1_joint", "wrist_2_joint"];
        let headers = ["wrist_1_joint_effort", "wrist_2_joint_effort", "shoulder_joint_effort", "t"];
        assert!(found(&headers, &names).contains(&(Kind::Torque, Key::Name, Some(vec![2, 0, 1]))));
        let short = ["/js/wrist2/position", "/js/wrist_1/position", "/js/Shoulder/position"];
        assert!(found(&short, &names).contains(&(Kind::Position, Key::Name, Some(vec![2, 1, 0]))));
    }

    #[test]
    fn joints_are_told_by_numbers() {
        let names = ["a", "b", "c"];
        let cases: [(&[&str], Key); 5] = [
            (&["q0", "q1", "q2"], Key::Number(0)),
            (&["q3", "q2", "q1"], Key::Number(1)),
            (&["iiwa7.joint_1.pos", "iiwa7.joint_2.pos", "iiwa7.joint_3.pos"], Key::Number(1)),
            (&["joint1_q1", "joint2_q2", "joint3_q3"], Key::Number(1)),
            (&["pos_11", "pos_12", "pos_13"], Key::Number(11)),
        ];
        for (headers, key) in cases {
            let order = if headers[0] == "q3" { vec![2, 1, 0] } else { vec![0, 1, 2] };
            let found = found(headers, &names);
            assert!(found.contains(&(Kind::Position, key, Some(order))), "{headers:?} {found:?}");
        }
        for headers in [&["q0", "q1", "q2", "q3"][..], &["q1", "q2"], &["q1", "q3", "q5"]] {
            assert!(found(headers, &names).iter().all(|f| f.2.is_none()), "{headers:?}");
        }
    }
}
