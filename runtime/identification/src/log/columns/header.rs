//! Headers: their words, units and meanings.

use super::super::units::{self, Unit};
use super::table::{Kind, Known, Origin, Role, known};

/// Quantity of a column according to its header.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Meaning {
    pub kind: Kind,
    pub origin: Origin,
    /// Uncertainty of the quantity: 0 for the usual words of a quantity, larger for less certain words.
    pub doubt: u8,
}

/// Words of a header, and its unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    /// Index of the column, from 0.
    pub index: usize,
    /// Header as written in the file.
    pub text: String,
    /// English words in lower case, and numbers.
    pub words: Vec<String>,
    /// Unit in brackets or in the row of units; `None` if there is no unit.
    pub unit: Option<Unit>,
    /// Text in brackets at the end that is neither a unit nor a number; `None` if there is no such text.
    pub odd: Option<String>,
    /// Whether the header has words of another language.
    pub is_translated: bool,
}

impl Header {
    /// The header of column `index`, split into words and unit.
    ///
    /// - `below`: field of the column in the row of units
    pub(super) fn new(index: usize, text: &str, below: Option<&str>) -> Self {
        let (rest, bracketed, odd) = take_unit(text);
        let is_translated = is_translated(text);
        let unit = bracketed.or_else(|| units::in_header(below?, is_translated));
        Self { index, text: text.to_owned(), words: words(&rest), unit, odd, is_translated }
    }

    /// Returns the meaning of all words; `None` if the words have no meaning.
    pub(super) fn own_meaning(&self) -> Option<Meaning> {
        meaning(&self.words)
    }

    /// Returns the meaning of the header without the words that name its joint. If the other words have no meaning, the
    /// unit in brackets decides (`A1 [deg]` is a position). `None` if the unit does not decide either.
    ///
    /// - `rest`: words without the name of the joint, with `#` for a number
    pub(super) fn meaning(&self, rest: &[String]) -> Option<Meaning> {
        let Some(kind) = self.kind_of_unit() else { return meaning(rest) };
        // The word `a` may be an axis or an acceleration.
        let is_silent =
            rest.iter().all(|w| is_number(w) || w == "#" || w == "a" || is_plain(w) && w.len() > 1);
        if is_silent {
            return Some(Meaning { kind, origin: Origin::Unsaid, doubt: 1 });
        }
        let meaning = meaning(rest)?;
        // An `effort` in ampere is a current.
        let is_current = meaning.kind.is_effort() && kind == Kind::Current;
        Some(if is_current { Meaning { kind, ..meaning } } else { meaning })
    }

    /// Returns the quantity of the unit in brackets; `None` if there is no unit, or if the unit does not decide.
    pub(super) fn kind_of_unit(&self) -> Option<Kind> {
        Kind::of_unit(self.unit?.si)
    }
}

/// Returns the text without the brackets of a unit, the unit, and the text of brackets at the end that are not a unit.
fn take_unit(text: &str) -> (String, Option<Unit>, Option<String>) {
    let mut odd = None;
    let mut from = 0;
    while let Some(open) = text[from..].find(['[', '(']).map(|at| at + from) {
        let Some(close) = text[open..].find([']', ')']).map(|at| at + open) else { break };
        let inner = text[open + 1..close].trim();
        let unit = units::in_header(inner, is_translated(&text[..open]));
        if let Some(unit) = unit.filter(|_| inner.parse::<f64>().is_err()) {
            return (format!("{} {}", &text[..open], &text[close + 1..]), Some(unit), None);
        }
        let is_last = text[close + 1..].trim().is_empty();
        if is_last && inner.parse::<u64>().is_err() && !inner.is_empty() {
            odd = Some(inner.to_owned());
        }
        from = close + 1;
    }
    (text.to_owned(), None, odd)
}

/// Returns the words and numbers of a text. The text is split at other characters, between letters and digits, and between
/// a lower-case letter and a capital. Words of other languages are translated to English.
pub(super) fn words(text: &str) -> Vec<String> {
    split(text).into_iter().flat_map(in_english).collect()
}

/// Returns whether a text has words of a language other than English.
fn is_translated(text: &str) -> bool {
    split(text) != words(text)
}

fn split(text: &str) -> Vec<String> {
    let characters: Vec<char> = text.chars().collect();
    let mut words: Vec<String> = Vec::new();
    let mut word = String::new();
    for (i, &c) in characters.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| characters[i]);
        let next = characters.get(i + 1);
        let digit_edge = before.is_some_and(|b| b.is_ascii_digit() != c.is_ascii_digit());
        let capital = before.is_some_and(char::is_lowercase) && c.is_uppercase();
        if !c.is_alphanumeric() || digit_edge || (capital && next.is_some_and(|n| n.is_lowercase())) {
            words.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        }
        if c.is_alphanumeric() {
            word.extend(c.to_lowercase());
        }
    }
    words.extend((!word.is_empty()).then_some(word));
    words
}

pub(super) fn is_number(word: &str) -> bool {
    word.bytes().all(|b| b.is_ascii_digit())
}

/// Smallest number of letters of a part of a German compound.
const SHORTEST: usize = 3;
/// Letters between two parts of a German compound.
const LINKS: [&str; 4] = ["", "s", "n", "en"];

/// Returns the English words for a word in lower case. A word without a translation is returned unchanged.
fn in_english(word: String) -> Vec<String> {
    if word.len() < SHORTEST {
        return vec![word];
    }
    let plain: String = word.chars().flat_map(without_accent).collect();
    match (known(&plain), compound(&plain)) {
        (Some(Known { english: Some(english), .. }), _) => vec![english.to_owned()],
        (_, Some(parts)) => parts.map(str::to_owned).into(),
        (Some(Known { role: Role::Quantity(_), .. }), None) => vec![plain],
        _ => vec![word],
    }
}

/// Returns the two parts of a German compound in English, for example of `motorstrom` or `positionsistwert`; `None` for
/// other words.
fn compound(word: &str) -> Option<[&str; 2]> {
    let part = |text: &str| {
        known(text).filter(|k| k.english.is_some() || matches!(k.role, Role::Quantity(_) | Role::Motor))
    };
    let cuts = SHORTEST..word.len().saturating_sub(SHORTEST - 1);
    cuts.filter(|at| word.is_char_boundary(*at)).find_map(|at| {
        let (head, tail) = word.split_at(at);
        let heads = LINKS.iter().filter_map(|link| head.strip_suffix(link));
        let (head, first) = heads.filter_map(|head| Some((head, part(head)?))).next()?;
        let last = part(tail)?;
        let is_german = first.role == Role::Motor || first.english.is_some() || last.english.is_some();
        (is_german && head.len() >= SHORTEST)
            .then(|| [first.english.unwrap_or(head), last.english.unwrap_or(tail)])
    })
}

/// Returns a letter without its accent, as in the table of words: `é` is `e`, `ß` is `ss`.
fn without_accent(letter: char) -> impl Iterator<Item = char> {
    const ACCENTS: [(&str, &str); 8] = [
        ("àáâä", "a"),
        ("èéêë", "e"),
        ("ìíîï", "i"),
        ("òóôö", "o"),
        ("ùúûü", "u"),
        ("ç", "c"),
        ("ñ", "n"),
        ("ß", "ss"),
    ];
    let plain = ACCENTS.iter().find(|(letters, _)| letters.contains(letter)).map(|(_, plain)| *plain);
    plain.is_none().then_some(letter).into_iter().chain(plain.unwrap_or_default().chars())
}

/// Returns the meaning of words without names and units; `None` if the words have no meaning or contradict each other.
fn meaning(words: &[String]) -> Option<Meaning> {
    let joined = join_derivatives(words.iter().filter(|w| !is_number(w) && *w != "#"));
    let all: Vec<Option<Known>> = joined.iter().map(|word| known(word)).collect();
    let has = |role: Role| all.iter().flatten().any(|known| known.role == role);
    if has(Role::Other) || has(Role::Body) {
        return None;
    }
    let (kind, mut doubt, at) = strong(&joined, &all)?;
    let kind = if has(Role::Motor) && kind == Kind::Torque { Kind::Input } else { kind };
    // A position on the output side of a gear is the position of the joint. The position of the motor may differ.
    doubt += u8::from(has(Role::Motor) && matches!(kind, Kind::Position | Kind::Velocity));
    doubt += 2 * u8::from(joined.iter().any(|w| is_unknown(w)));
    if kind == Kind::Time {
        doubt += time_doubt(&joined);
    }
    let present = all[..at].iter().flatten().any(|known| known.role == Role::Quantity(Kind::Current));
    let joint_states = joined.windows(2).any(|w| w[0].starts_with("joint") && w[1] == "states");
    let origin = if has(Role::Origin(Origin::Commanded)) {
        Origin::Commanded
    } else if has(Role::Origin(Origin::Filtered)) {
        Origin::Filtered
    } else if has(Role::Origin(Origin::Measured)) || present || joint_states {
        Origin::Measured
    } else {
        Origin::Unsaid
    };
    Some(Meaning { kind, origin, doubt })
}

/// Returns the words with `q dot`, `q dot dot` and `q ddot` joined to one word.
fn join_derivatives<'w>(words: impl Iterator<Item = &'w String>) -> Vec<String> {
    let mut joined: Vec<String> = Vec::new();
    for word in words {
        match joined.last_mut() {
            Some(last) if word == "dot" => last.push_str("dot"),
            Some(last) if word == "ddot" => last.push_str("dotdot"),
            _ => joined.push(word.clone()),
        }
    }
    joined
}

/// Returns the quantity that the words name, its doubt, and the index of the word; `None` if the words name no quantity.
fn strong(words: &[String], all: &[Option<Known>]) -> Option<(Kind, u8, usize)> {
    let quantity = |(at, known): (usize, &Option<Known>)| match known.as_ref()?.role {
        Role::Quantity(kind) => Some((kind, known.as_ref()?.doubt, at)),
        _ => None,
    };
    let named = all.iter().enumerate().filter_map(quantity);
    let (letters, named): (Vec<_>, Vec<_>) = named.partition(|(_, _, at)| words[*at].len() == 1);
    let (currents, mut found): (Vec<_>, Vec<_>) =
        named.into_iter().partition(|(kind, ..)| *kind == Kind::Current);
    // `torque current` of a drive is a current, but `current torque` means the present torque.
    if let Some(current) = currents.last()
        && found.first().is_none_or(|first| current.2 > first.2)
    {
        return Some(*current);
    }
    if found.is_empty() {
        found = letters;
    }
    let (kind, ..) = *found.first()?;
    let agrees = found.iter().all(|f| f.0 == kind);
    agrees.then(|| found.into_iter().min_by_key(|f| f.1)).flatten()
}

fn is_unknown(word: &str) -> bool {
    let is_known =
        known(word).is_some_and(|known| !matches!(known.role, Role::Angle | Role::Body | Role::Other));
    !(is_known || is_number(word) || units::find(word).is_some())
}

/// Returns whether a word names no quantity, or is a single letter.
pub(super) fn is_plain(word: &str) -> bool {
    word.chars().count() == 1 || known(word).is_some_and(|known| known.role == Role::Plain)
}

/// Returns whether all words are numbers or known words of headers.
pub(super) fn is_known(words: &[String]) -> bool {
    // `[V]` is a unit that no quantity here has. It does not mean velocities.
    let is_word = |w: &String| w.chars().count() > 1 && (known(w).is_some() || !is_unknown(w));
    !words.is_empty() && words.iter().all(|w| is_number(w) || is_word(w))
}

/// Returns the doubt about a column of times. The time in the header of a message is the time of the measurement. The time
/// of a bag is the time of arrival.
fn time_doubt(words: &[String]) -> u8 {
    let has = |list: &[&str]| words.iter().any(|w| list.contains(&w.as_str()));
    let stamped = has(&["header"]) && has(&["stamp"]);
    let received =
        has(&["rosbag", "bag", "received", "receive", "recv", "log", "logged", "wall", "system", "host"]);
    match (stamped, received) {
        (true, _) => 0,
        (_, false) => 1,
        (_, true) => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> Option<(Kind, Origin)> {
        let header = Header::new(0, text, None);
        header.own_meaning().map(|m| (m.kind, m.origin))
    }

    #[test]
    fn headers_say_what_they_measure() {
        use Kind::{Acceleration, Current, Input, Position, Run, Time, Torque, Velocity};
        use Origin::{Commanded, Filtered, Measured, Unsaid};
        let cases = [
            ("joint1_position", Position, Unsaid),
            ("/joint_states/position[0]", Position, Measured),
            ("actual_q_0", Position, Measured),
            ("target_q_0", Position, Commanded),
            ("q_d[3]", Position, Commanded),
            ("qMeas1", Position, Measured),
            ("Axis 2 Angle (°)", Position, Unsaid),
            ("actual_qd_0", Velocity, Measured),
            ("q_dot_1", Velocity, Unsaid),
            ("dQ1", Velocity, Unsaid),
            ("target_qdd_5", Acceleration, Commanded),
            ("tau_J[0]", Torque, Unsaid),
            ("tauJ_0", Torque, Unsaid),
            ("joint_control_torque_0", Torque, Commanded),
            ("motor torque 1 [Nm]", Input, Unsaid),
            ("u3", Input, Unsaid),
            ("actual_current_0", Current, Measured),
            ("current_position_1", Position, Measured),
            ("torque_current_1", Current, Unsaid),
            ("eff_1", Torque, Unsaid),
            ("dq_filtered_1", Velocity, Filtered),
            ("%time", Time, Unsaid),
            ("Time (s)", Time, Unsaid),
            ("t", Time, Unsaid),
            ("run", Run, Unsaid),
            ("Zeit", Time, Unsaid),
            ("Gelenkwinkel_1", Position, Unsaid),
            ("Lageistwert Achse 1", Position, Measured),
            ("Sollwinkel 2", Position, Commanded),
            ("Geschwindigkeit 3", Velocity, Unsaid),
            ("Motormoment 1", Input, Unsaid),
            ("Iststrom_2", Current, Measured),
            ("vitesse articulaire 1", Velocity, Unsaid),
            ("couple mesuré 1", Torque, Measured),
            ("accélération_4", Acceleration, Unsaid),
            ("corriente_motor_2", Current, Unsaid),
            ("posizione comando 1", Position, Commanded),
        ];
        for (text, kind, origin) in cases {
            assert_eq!(said(text), Some((kind, origin)), "{text}");
        }
        for text in [
            "tau_ext_hat_filtered[0]",
            "dtau_J[0]",
            "actual_TCP_pose_0",
            "joint_temperatures_0",
            "seq",
            "",
            "Motorspannung",
            "Lagefehler 1",
        ] {
            assert_eq!(said(text), None, "{text}");
        }
    }

    #[test]
    fn units_are_taken_out_of_headers() {
        let header = Header::new(0, "Position 1 [deg]", None);
        assert_eq!((header.words.join(" ").as_str(), header.unit.map(|u| u.si)), ("position 1", Some("rad")));
        let header = Header::new(0, "position[0] (rad)", None);
        assert_eq!((header.words.join(" ").as_str(), header.unit.is_some()), ("position 0", true));
        let header = Header::new(0, "q_arm[1]", None);
        assert_eq!((header.words.join(" ").as_str(), header.unit, header.odd), ("q arm 1", None, None));
        assert_eq!(Header::new(0, "position [counts]", None).odd.as_deref(), Some("counts"));
        let header = Header::new(0, "Winkel 1 [Grad]", None);
        assert_eq!((header.words.join(" ").as_str(), header.unit.map(|u| u.si)), ("angle 1", Some("rad")));
        assert_eq!(Header::new(0, "q1 [Grad]", None).unit.map(|u| u.si), Some(units::GRAD));
        assert_eq!(Header::new(0, "tau", Some("mNm")).unit.map(|u| u.factor), Some(1e-3));
    }

    #[test]
    fn words_of_other_languages_are_translated() {
        let cases = [
            ("zeit", "time"),
            ("drehmoment", "torque"),
            ("motorstrom", "motor current"),
            ("gelenkwinkelgeschwindigkeit", "joint velocity"),
            ("positionsistwert", "positions actual"),
            ("momentensollwert", "moment setpoint"),
            ("istposition", "actual position"),
            ("lageregelabweichung", "position error"),
            ("positionsfehler", "positions error"),
            ("motortemperatur", "motor temperature"),
            ("accélération", "acceleration"),
            ("mesurée", "measured"),
            ("velocità", "velocity"),
            ("ángulo", "angle"),
            // English words and names stay as they are.
            ("position", "position"),
            ("jointtorque", "jointtorque"),
            ("wrist", "wrist"),
            ("list", "list"),
            ("größe", "größe"),
            ("東京", "東京"),
            ("t", "t"),
        ];
        for (word, english) in cases {
            assert_eq!(in_english(word.to_owned()).join(" "), english, "{word}");
        }
    }
}
