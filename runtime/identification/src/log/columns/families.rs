//! Families of columns: columns of one quantity that differ only in the name or number of the joint.

use super::header::{Header, Meaning, is_number, is_plain, words};
use super::table::{Kind, Known, Origin, Role, known};
use std::collections::{BTreeMap, BTreeSet};

/// Property by which the columns of a family differ. Families are preferred in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key {
    /// The columns contain the names of the joints or inputs.
    Name,
    /// The columns are numbered, and the rows of the log (of a ROS message) list the names in this order.
    Listed,
    /// The columns are numbered. The value is the first number.
    Number(u64),
    /// There is only one joint, and its column has neither name nor number.
    Alone,
    /// The columns end with the letters of components, such as x, y and z.
    Component,
}

/// Columns of one quantity for several joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    pub meaning: Meaning,
    pub key: Key,
    /// Index of the column of each joint or input; `None` if the log does not have the column.
    pub columns: Vec<Option<usize>>,
    /// Numbers in the headers; empty if the columns are not numbered.
    pub numbers: Vec<u64>,
}

impl Family {
    /// Returns all columns; `None` if a column is missing.
    pub(super) fn complete(&self) -> Option<Vec<usize>> {
        self.columns.iter().copied().collect()
    }

    pub(super) fn rank(&self) -> (Origin, u8, Key) {
        // The first number does not affect the rank.
        let key = if let Key::Number(_) = self.key { Key::Number(0) } else { self.key };
        (self.meaning.origin, self.meaning.doubt, key)
    }
}

/// Names of joints or inputs with which headers are compared, as words.
#[derive(Debug, Clone, Default)]
pub(in crate::log) struct Targets {
    pub names: Vec<String>,
    /// Index of each name among all joints or inputs. Numbers in headers refer to these indices.
    pub places: Vec<usize>,
    aliases: Vec<Vec<Vec<String>>>,
}

impl Targets {
    /// Targets with the spellings of their names, by which columns are found.
    ///
    /// - `others`: second name of each joint or input, or an empty slice
    pub(super) fn new(names: &[String], others: &[Option<String>]) -> Self {
        let spelled: Vec<Vec<String>> = names.iter().map(|n| words(n)).collect();
        let short: Vec<Vec<String>> =
            spelled.iter().map(|all| all.iter().filter(|w| *w != "joint").cloned().collect()).collect();
        let aliases = (0..names.len()).map(|i| {
            let unique = short.iter().filter(|s| **s == short[i]).count() == 1;
            let named = short[i].iter().any(|w| !is_number(w) && w.chars().count() > 1);
            let mut aliases = vec![spelled[i].clone()];
            aliases.extend((unique && named).then(|| short[i].clone()));
            aliases.extend(others.get(i).and_then(Option::as_ref).map(|other| words(other)));
            aliases.retain(|a| !a.is_empty());
            aliases
        });
        Self { names: names.to_vec(), places: (0..names.len()).collect(), aliases: aliases.collect() }
    }

    /// Creates a single target for a quantity that belongs to no joint.
    pub(super) fn one(name: &str) -> Self {
        Self::new(&[name.to_owned()], &[])
    }

    /// Returns the targets for whose index in [`Self::places`] `is_kept` is true.
    pub(super) fn only(&self, is_kept: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.names.len()).filter(|i| is_kept(self.places[*i])).collect();
        Self {
            names: kept.iter().map(|i| self.names[*i].clone()).collect(),
            places: kept.iter().map(|i| self.places[*i]).collect(),
            aliases: kept.iter().map(|i| self.aliases[*i].clone()).collect(),
        }
    }

    /// Returns the joint whose name is part of the words, and the other words. If there are several names, the longest one
    /// counts. `None` if there is no name.
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

    /// Returns whether the words contain the name of a joint.
    pub(super) fn mentions(&self, words: &[String]) -> bool {
        self.find(words).is_some()
    }

    /// Returns the index of the joint with this name, which is a text in the rows of a log; `None` if no joint has the
    /// name.
    pub(super) fn named(&self, name: &str) -> Option<usize> {
        let exact = self.names.iter().position(|known| known == name);
        exact.or_else(|| self.find(&words(name)).map(|(joint, _)| joint))
    }

    /// Returns the columns of the targets by their numbers, which must ascend. If there are as many consecutive numbers as
    /// targets, they are in the order of the targets. Otherwise the numbers are the indices in [`Self::places`]: they count
    /// from 0 if there is a 0, otherwise from 1.
    pub(super) fn by_number(&self, numbered: &[(u64, usize)]) -> Vec<Option<usize>> {
        let first = numbered.first().map_or(0, |n| n.0);
        let is_consecutive = numbered.windows(2).all(|pair| pair[0].0.checked_add(1) == Some(pair[1].0));
        if numbered.len() == self.names.len() && is_consecutive {
            return numbered.iter().map(|n| Some(n.1)).collect();
        }
        let number = |place: usize| u64::from(first != 0) + place as u64;
        let column = |place: &usize| numbered.iter().find(|n| n.0 == number(*place)).map(|n| n.1);
        self.places.iter().map(column).collect()
    }
}

/// Returns all families of the headers.
///
/// - `listed`: names of the joints in the order of the log's messages; `None` if the rows do not list them
pub(super) fn families(headers: &[Header], targets: &Targets, listed: Option<&[String]>) -> Vec<Family> {
    let mut families = by_name(headers, targets);
    families.extend(by_number(headers, targets, listed));
    if targets.names.len() == 1 {
        families.extend(alone(headers));
    }
    families
}

/// Columns with the same phrase, in their order in the file.
type Groups = BTreeMap<Phrase, Vec<usize>>;

fn push(groups: &mut Groups, key: Phrase, column: usize) {
    groups.entry(key).or_default().push(column);
}

/// Quantity of the unit, and words of the header without the name of the joint. All columns of a quantity have the same
/// phrase.
type Phrase = (Option<Kind>, Vec<String>);

fn by_name(headers: &[Header], targets: &Targets) -> Vec<Family> {
    let mut groups = Groups::new();
    let mut joints = vec![None; headers.len()];
    for header in headers {
        let Some((joint, rest)) = targets.find(&header.words) else { continue };
        joints[header.index] = Some(joint);
        push(&mut groups, (header.kind_of_unit(), rest), header.index);
    }
    let meaning =
        |((_, rest), members): (Phrase, Vec<usize>)| Some((headers[members[0]].meaning(&rest)?, members));
    let family = |(meaning, members): (Meaning, Vec<usize>)| {
        let mut columns = vec![None; targets.names.len()];
        let mut twice = false;
        for member in members {
            let slot = &mut columns[joints[member]?];
            twice |= slot.replace(member).is_some();
        }
        let is_sure = !twice && !counts_from_zero(headers, &columns, targets);
        is_sure.then_some(Family { meaning, key: Key::Name, columns, numbers: Vec::new() })
    };
    with_combined(groups.into_iter().filter_map(meaning).collect()).into_iter().filter_map(family).collect()
}

/// Returns the groups, followed by combinations of groups with the same quantity and origin, one for each level of doubt.
/// Such groups belong together, because headers of rotary and linear joints often have different words (`turn_angle`,
/// `slide_position`) or units (`cart_pos_mm`, `pole_pos_deg`).
fn with_combined<T: Clone>(mut groups: Vec<(Meaning, Vec<T>)>) -> Vec<(Meaning, Vec<T>)> {
    let meanings: BTreeSet<Meaning> = groups.iter().map(|(meaning, _)| *meaning).collect();
    let combined = meanings.into_iter().map(|most| {
        let is_alike = |(own, _): &&(Meaning, Vec<T>)| {
            Meaning { doubt: most.doubt, ..*own } == most && own.doubt <= most.doubt
        };
        (most, groups.iter().filter(is_alike).flat_map(|(_, members)| members).cloned().collect())
    });
    let combined: Vec<(Meaning, Vec<T>)> = combined.collect();
    groups.extend(combined);
    groups
}

/// Returns whether columns count joints from 0, although the names of the joints count from 1. If so, column 1 may belong
/// to the second joint.
fn counts_from_zero(headers: &[Header], columns: &[Option<usize>], targets: &Targets) -> bool {
    let Some(first) = columns.iter().flatten().next() else { return false };
    let zero = |word: &String| if is_number(word) { "0".into() } else { word.clone() };
    let zeroed: Vec<String> = headers[*first].words.iter().map(zero).collect();
    let has_zero = zeroed.iter().any(|w| w == "0") && headers.iter().any(|h| h.words == zeroed);
    has_zero && !targets.names.iter().any(|name| words(name).iter().any(|w| w == "0"))
}

fn by_number(headers: &[Header], targets: &Targets, listed: Option<&[String]>) -> Vec<Family> {
    let mut shapes = Groups::new();
    for header in headers.iter().filter(|h| h.words.iter().any(|w| is_number(w))) {
        let shape = header.words.iter().map(|w| if is_number(w) { "#".into() } else { w.clone() }).collect();
        push(&mut shapes, (header.kind_of_unit(), shape), header.index);
    }
    let mut found: Vec<(Meaning, Vec<(u64, usize)>)> = Vec::new();
    for ((unit, shape), members) in shapes {
        let slot = varying_slot(headers, &shape, &members);
        let mut groups = Groups::new();
        for member in members {
            let number = headers[member].words[slot].clone();
            let mut rest = headers[member].words.clone();
            rest.remove(slot);
            // The header `joint1_q1` contains its number twice.
            rest.iter_mut().filter(|word| **word == number).for_each(|word| "#".clone_into(word));
            push(&mut groups, (unit, rest), member);
        }
        found.extend(groups.into_iter().filter_map(|((_, rest), members)| {
            let meaning = headers[members[0]].meaning(&rest)?;
            let number = |member: usize| Some((headers[member].words.get(slot)?.parse().ok()?, member));
            Some((meaning, members.into_iter().map(number).collect::<Option<_>>()?))
        }));
    }
    let family = |(meaning, sorted)| numbered(meaning, sorted, targets, listed);
    with_combined(found).into_iter().filter_map(family).collect()
}

/// Returns the index of the number by which columns with otherwise equal words differ: the number with the
/// most different values. If several numbers have the most values, it is the last one.
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

/// Returns the family of numbered columns; `None` if a number occurs twice.
fn numbered(
    meaning: Meaning,
    mut sorted: Vec<(u64, usize)>,
    targets: &Targets,
    listed: Option<&[String]>,
) -> Option<Family> {
    sorted.sort_unstable();
    let numbers: Vec<u64> = sorted.iter().map(|s| s.0).collect();
    if numbers.windows(2).any(|w| w[0] == w[1]) {
        return None;
    }
    let first = *numbers.first()?;
    let mut columns = vec![None; targets.names.len()];
    if let Some(listed) = listed.filter(|l| first == 0 && l.len() == numbers.len()) {
        for (name, (_, member)) in listed.iter().zip(&sorted) {
            targets.named(name).into_iter().for_each(|joint| columns[joint] = Some(*member));
        }
        return Some(Family { meaning, key: Key::Listed, columns, numbers });
    }
    // If there are more numbers than joints, it is unknown which of them belong to the robot.
    if numbers.len() <= columns.len() {
        columns = targets.by_number(&sorted);
    }
    Some(Family { meaning, key: Key::Number(first), columns, numbers })
}

fn alone(headers: &[Header]) -> Vec<Family> {
    let plain = headers.iter().filter(|h| !h.words.iter().any(|w| is_number(w)));
    let family = |header: &Header| {
        let meaning = header.meaning(&header.words)?;
        Some(Family { meaning, key: Key::Alone, columns: vec![Some(header.index)], numbers: Vec::new() })
    };
    plain.filter_map(family).collect()
}

/// Returns the families of a quantity with components. Their columns differ only in the letter of the
/// component. The doubt (uncertainty) is 0 if the header has the joint's name, 1 if the header has no name,
/// otherwise 2.
///
/// - `joint`: words of the joint's name
pub(super) fn by_component(headers: &[Header], kind: Kind, joint: &[String]) -> Vec<Family> {
    let letters = kind.row().components;
    let mut groups: BTreeMap<Vec<String>, Vec<Option<usize>>> = BTreeMap::new();
    for header in headers {
        let Some((stem, letter, found)) = component(&header.words) else { continue };
        let Some(place) = letters.iter().position(|known| *known == letter) else { continue };
        if found == kind {
            let columns = groups.entry(stem).or_insert_with(|| vec![None; letters.len()]);
            // If two columns have the same name, the first one is used. The other one is not part of the pose.
            columns[place].get_or_insert(header.index);
        }
    }
    let family = |(stem, columns): (Vec<String>, Vec<Option<usize>>)| {
        let is_named = !joint.is_empty() && stem.windows(joint.len()).any(|window| window == joint);
        let doubt = if is_named { 0 } else { 2 - u8::from(stem.iter().all(|word| has_no_name(word))) };
        let meaning = Meaning { kind, origin: Origin::Unsaid, doubt };
        Family { meaning, key: Key::Component, columns, numbers: Vec::new() }
    };
    groups.into_iter().map(family).collect()
}

/// Returns the words before the letter of a component, the letter, and the quantity; `None` if the words do not name a
/// component.
fn component(words: &[String]) -> Option<(Vec<String>, &str, Kind)> {
    let (last, before) = words.split_last()?;
    if before.iter().any(|word| is_no_pose(word)) {
        return None;
    }
    let letter_of =
        |kind: Kind, text: &str| kind.row().components.iter().find(|letter| **letter == text).copied();
    let marked =
        |mark: char, kind| letter_of(kind, last.strip_prefix(mark)?).map(|l| (before.to_vec(), l, kind));
    let of_words = || {
        let letter = letter_of(Kind::Attitude, last)?;
        let is_mark = |word: &String| word == "q" || is_role(word, Role::Quantity(Kind::Attitude));
        Some(match before.split_last() {
            Some((mark, stem)) if is_mark(mark) => (stem.to_vec(), letter, Kind::Attitude),
            _ => (before.to_vec(), letter, Kind::Place),
        })
    };
    marked('q', Kind::Attitude).or_else(|| marked('p', Kind::Place)).or_else(of_words)
}

fn is_role(word: &str, role: Role) -> bool {
    known(word).is_some_and(|known| known.role == role)
}

/// Returns whether a word names a quantity other than a pose, or a pose that was not measured.
fn is_no_pose(word: &str) -> bool {
    let is_pose = |Known { role, doubt, .. }: Known| match role {
        Role::Quantity(kind) => doubt == 0 && matches!(kind, Kind::Position | Kind::Place | Kind::Attitude),
        Role::Origin(origin) => origin != Origin::Commanded,
        Role::Plain | Role::Body | Role::Angle => true,
        Role::Motor | Role::Other => false,
    };
    known(word).is_some_and(|known| !is_pose(known))
}

/// Returns whether a word is not the name of a joint.
fn has_no_name(word: &str) -> bool {
    is_plain(word)
        || known(word)
            .is_some_and(|known| !matches!(known.role, Role::Angle | Role::Origin(Origin::Filtered)))
}

/// Returns the headers of columns that contain angles of an orientation.
pub(super) fn angles(headers: &[Header]) -> Vec<String> {
    let is_angle = |header: &&Header| {
        let is_measured = !header.words.iter().any(|word| is_no_pose(word));
        is_measured && header.words.iter().any(|word| is_role(word, Role::Angle))
    };
    headers.iter().filter(is_angle).map(|header| header.text.clone()).collect()
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
    fn joints_differ_by_name() {
        let names = ["shoulder_joint", "wrist_1_joint", "wrist_2_joint"];
        let headers = ["wrist_1_joint_effort", "wrist_2_joint_effort", "shoulder_joint_effort", "t"];
        assert!(found(&headers, &names).contains(&(Kind::Torque, Key::Name, Some(vec![2, 0, 1]))));
        let short = ["/js/wrist2/position", "/js/wrist_1/position", "/js/Shoulder/position"];
        assert!(found(&short, &names).contains(&(Kind::Position, Key::Name, Some(vec![2, 1, 0]))));
    }

    #[test]
    fn joints_differ_by_numbers() {
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

    fn components(texts: &[&str], kind: Kind) -> Vec<Vec<Option<usize>>> {
        let headers: Vec<Header> = texts.iter().enumerate().map(|(i, t)| Header::new(i, t, None)).collect();
        by_component(&headers, kind, &[]).into_iter().map(|family| family.columns).collect()
    }

    #[test]
    fn quaternions_differ_by_their_letters() {
        let cases: [[&str; 4]; 7] = [
            ["qw", "qx", "qy", "qz"],
            ["quat_w", "quat_x", "quat_y", "quat_z"],
            ["pose.orientation.w", "pose.orientation.x", "pose.orientation.y", "pose.orientation.z"],
            ["q_base_qw", "q_base_qx", "q_base_qy", "q_base_qz"],
            [
                "/odom/pose/pose/orientation/w",
                "/odom/pose/pose/orientation/x",
                "/odom/pose/pose/orientation/y",
                "/odom/pose/pose/orientation/z",
            ],
            ["Rotation W", "Rotation X", "Rotation Y", "Rotation Z"],
            ["q_w", "q_x", "q_y", "q_z"],
        ];
        for texts in cases {
            assert_eq!(
                components(&texts, Kind::Attitude),
                [[Some(1), Some(2), Some(3), Some(0)]],
                "{texts:?}"
            );
            assert!(components(&texts, Kind::Place).is_empty(), "{texts:?}");
        }
    }

    #[test]
    fn places_are_neither_velocities_nor_commanded() {
        let texts = ["x", "y", "z", "dq_base_x", "twist.linear.y", "desired_base_z", "base_x", "px"];
        assert_eq!(components(&texts, Kind::Place), [[Some(0), Some(1), Some(2)], [Some(6), None, None]]);
        let headers = [Header::new(0, "roll_deg", None), Header::new(1, "desired_yaw", None)];
        assert_eq!(angles(&headers), ["roll_deg"]);
    }
}
