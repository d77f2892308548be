//! Seeded edits that know the structure of XML and of lists: elements with all that is in them, vectors, empty lists.

use super::mutation::{Random, with};
use std::ops::Range;

/// An element of an XML goes, loses what is in it, comes twice, or takes the place of another one: joints without actuators,
/// bodies without joints, links with another parent.
pub fn with_element(text: &str, random: &mut Random) -> String {
    let starts: Vec<usize> =
        text.match_indices('<').map(|(at, _)| at).filter(|at| is_start(text, *at)).collect();
    if starts.is_empty() {
        return text.to_owned();
    }
    let [one, other] = [0; 2].map(|_| element(text, *random.one(&starts)));
    match random.below(5) {
        0 | 1 => with(text, one, ""),
        2 => {
            let head = text[one.clone()].find('>').map_or(one.end, |end| one.start + end + 1);
            let is_whole = text[..head].ends_with("/>");
            let foot = text[one.clone()].rfind("</").map_or(head, |at| one.start + at);
            if is_whole { with(text, one, "") } else { with(text, head..foot.max(head), "") }
        }
        3 => with(text, one.end..one.end, &text[other]),
        _ => with(text, one, &text[other]),
    }
}

fn is_start(text: &str, at: usize) -> bool {
    text[at + 1..].starts_with(|letter: char| letter.is_ascii_alphabetic())
}

/// The element that begins here, to its own end; to that of the text where it has none.
fn element(text: &str, start: usize) -> Range<usize> {
    let mut depth = 0;
    for (at, _) in text[start..].match_indices('<').map(|(at, tag)| (start + at, tag)) {
        let Some(end) = text[at..].find('>').map(|end| at + end + 1) else { break };
        if text[at..].starts_with("</") {
            depth -= 1;
        } else if is_start(text, at) && !text[..end].ends_with("/>") {
            depth += 1;
        }
        if depth <= 0 {
            return start..end;
        }
    }
    start..text.len()
}

/// Mutations of a list of numbers.
const LISTS: [&str; 10] = [
    "",
    "0",
    "0 0 0",
    "0 0 -1",
    "1 2",
    "nan 0 1",
    "inf 0 0",
    "1e300 1e300 1e300",
    "0 0 1e-200",
    "0 0 0 0 0 0",
];

/// A list in brackets or in quotes becomes another one: an empty one, an axis of zeros.
pub fn with_list(text: &str, random: &mut Random) -> String {
    let is_xml = text.trim_start().starts_with('<');
    let (open, close) = if is_xml { ('"', '"') } else { ('[', ']') };
    let begins: Vec<usize> = text.match_indices(open).map(|(at, _)| at + 1).collect();
    let within = |begin: usize| text[begin..].find(close).map(|end| begin..begin + end);
    let is_list = |run: &Range<usize>| {
        let list = &text[run.clone()];
        list.contains([' ', ',']) && !list.contains(['=', '[', '<'])
    };
    let lists: Vec<Range<usize>> = begins.into_iter().filter_map(within).filter(is_list).collect();
    if lists.is_empty() {
        return text.to_owned();
    }
    let list = *random.one(&LISTS);
    let list = if is_xml { list.to_owned() } else { list.replace(' ', ", ") };
    with(text, random.one(&lists).clone(), &list)
}
