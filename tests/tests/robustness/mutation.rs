//! Seeded edits of descriptions: of bytes, lines, numbers, names and whole parts.

use super::elements::{with_element, with_list};

/// SplitMix64 (Steele, Lea and Flood, 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % (bound.max(1) as u64)).unwrap()
    }
}

impl Random {
    /// One of several.
    pub fn one<'t, T>(&mut self, of: &'t [T]) -> &'t T {
        &of[self.below(of.len())]
    }

    pub fn chance(&mut self, one_in: usize) -> bool {
        self.below(one_in) == 0
    }
}

const TOKENS: [&str; 24] = [
    "\"",
    "'",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "/>",
    "=",
    "\n",
    "-",
    "nan",
    "1e999",
    "0",
    "*/",
    "\\u0000",
    "é",
    "\u{feff}",
    "[[joints]]\n",
    "<link name=\"x\"/>",
    "&amp;",
    "((((",
    "-----",
];

/// A few random edits: a byte changed, a part removed or repeated, a token put in.
pub fn mutated(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        let end = (at + random.below(80)).min(bytes.len());
        match random.below(4) {
            0 if at < bytes.len() => bytes[at] = random.next().to_le_bytes()[0],
            1 => drop(bytes.drain(at..end)),
            2 => {
                let part = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, part);
            }
            _ => {
                let token = TOKENS[random.below(TOKENS.len())];
                bytes.splice(at..at, token.bytes());
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Mutations of a number.
const NUMBERS: [&str; 36] = [
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "1e-3",
    "1e-12",
    "1e-30",
    "5e-324",
    "1e-308",
    "1e6",
    "1e15",
    "1e30",
    "1.1e30",
    "1e308",
    "1e309",
    "-1e30",
    "nan",
    "inf",
    "-inf",
    "90",
    "-180",
    "1.5708",
    "3.14159265",
    "9007199254740993",
    "99999999999999999999",
    "0x10",
    "1_000",
    "\"pi/2\"",
    "\"1/0\"",
    "\"sin(1e22)\"",
    "\"pow(1e10, 16)\"",
    "{ free = 0 }",
    "{ free = 1e-300 }",
    "[1, 2, 3]",
    "true",
];

/// Force laws, right and wrong.
const LAWS: [&str; 9] = [
    "\"0.1*v + 0.2*sign(v)\"",
    "\"tanh(1e6*v)\"",
    "\"exp(v)\"",
    "\"1/v\"",
    "\"exp(-abs(v))*sign(v) - y*v\"",
    "\"pow(v, 16)\"",
    "\"1e30*v\"",
    "{ coulomb = { value = 1, slope = 1e9 }, viscous = 0 }",
    "{ stribeck = { a1 = 1, a2 = 1, a3 = 1e9, a4 = 1, a5 = 1e9 } }",
];

/// One to four edits that mostly leave a text that can be read: numbers, names, lines and parts change,
/// rarely bytes.
pub fn rewritten(text: &str, random: &mut Random) -> String {
    let mut text = text.to_owned();
    for _ in 0..=random.below(3) {
        text = match random.below(16) {
            0..5 => with_number(&text, random),
            5 => with_law(&text, random),
            6 | 7 => with_name(&text, random),
            8 => with_lines(&text, random),
            9 | 10 => with_parts(&text, random),
            11 => with_word(&text, random),
            12 | 13 => with_element(&text, random),
            14 => with_list(&text, random),
            _ => mutated(&text, random),
        };
        if text.is_empty() {
            return text;
        }
    }
    text
}

/// Where runs of matching characters stand.
fn runs(text: &str, is_in: impl Fn(char) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for (at, c) in text.char_indices().filter(|(_, c)| is_in(*c)) {
        match runs.last_mut() {
            Some(run) if run.end == at => run.end += c.len_utf8(),
            _ => runs.push(at..at + c.len_utf8()),
        }
    }
    runs
}

pub fn with(text: &str, range: std::ops::Range<usize>, new: &str) -> String {
    format!("{}{new}{}", &text[..range.start], &text[range.end..])
}

/// Another number, or the same scaled.
fn with_number(text: &str, random: &mut Random) -> String {
    let is_number = |c: char| c.is_ascii_digit() || ".-+eE".contains(c);
    let mut numbers = runs(text, is_number);
    let is_in_name = |c: char| c.is_alphanumeric() || c == '_';
    numbers.retain(|run| {
        let before = text[..run.start].chars().next_back();
        text[run.clone()].parse::<f64>().is_ok() && !before.is_some_and(is_in_name)
    });
    if numbers.is_empty() {
        return text.to_owned();
    }
    let run = random.one(&numbers).clone();
    let new = match (random.below(4), text[run.clone()].parse::<f64>()) {
        (1.., Ok(number)) => {
            let factor = [0.0, 1e-9, 1e-3, 0.5, 0.9, 1.1, 2.0, 1e3, 1e9, -1.0][random.below(10)];
            format!("{:?}", number * factor)
        }
        _ => (*random.one(&NUMBERS)).to_owned(),
    };
    with(text, run, &new)
}

/// Another law in place of one, or below the name of a joint (or of something else).
fn with_law(text: &str, random: &mut Random) -> String {
    let law = format!("friction = {}", random.one(&LAWS));
    let mut lines: Vec<&str> = text.lines().collect();
    let places = |start: &str| -> Vec<usize> {
        let lines = lines.iter().enumerate();
        let found = lines.filter(|(_, line)| line.trim_start().starts_with(start));
        found.map(|(at, _)| at).collect()
    };
    let (laws, names) = (places("friction"), places("name"));
    match (laws.is_empty(), names.is_empty()) {
        (false, _) => lines[*random.one(&laws)] = &law,
        (true, false) => lines.insert(random.one(&names) + 1, &law),
        (true, true) => {}
    }
    lines.join("\n")
}

/// A name in quotes becomes another one of the text.
fn with_name(text: &str, random: &mut Random) -> String {
    let quotes: Vec<usize> = text.match_indices('"').map(|(at, _)| at).collect();
    let names: Vec<std::ops::Range<usize>> =
        quotes.chunks_exact(2).map(|pair| pair[0] + 1..pair[1]).collect();
    if names.is_empty() {
        return text.to_owned();
    }
    let run = random.one(&names).clone();
    let other = random.one(&names).clone();
    let new = match random.below(3) {
        0 => random.one(&["", "base", "world", "x y", "ä", "fn", "0", "a/b", "frames"]).to_string(),
        _ => text[other].to_owned(),
    };
    with(text, run, &new)
}

/// A line goes, comes twice, or changes its place.
fn with_lines(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let (at, to) = (random.below(lines.len()), random.below(lines.len()));
    match random.below(3) {
        0 => drop(lines.remove(at)),
        1 => lines.insert(to, lines[at]),
        _ => lines.swap(at, to),
    }
    lines.join("\n")
}

/// The same with parts: tables of a TOML, links and joints of a URDF.
fn with_parts(text: &str, random: &mut Random) -> String {
    let starts = ["[[", "[", "<link", "<joint", "  <link", "  <joint"];
    let mut parts: Vec<String> = vec![String::new()];
    for line in text.lines() {
        if starts.iter().any(|start| line.starts_with(start)) {
            parts.push(String::new());
        }
        if let Some(part) = parts.last_mut() {
            part.push_str(line);
            part.push('\n');
        }
    }
    let (at, to) = (random.below(parts.len()), random.below(parts.len()));
    match random.below(3) {
        0 => drop(parts.remove(at)),
        1 => parts.insert(to, parts[at].clone()),
        _ => parts.swap(at, to),
    }
    parts.concat()
}

/// A word becomes another one of the text: keys, types, numbers without their signs.
fn with_word(text: &str, random: &mut Random) -> String {
    let words = runs(text, |c| c.is_alphanumeric() || c == '_');
    if words.is_empty() {
        return text.to_owned();
    }
    let (run, other) = (random.one(&words).clone(), random.one(&words).clone());
    let new = text[other].to_owned();
    with(text, run, &new)
}
