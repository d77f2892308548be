//! Words in the headers of logs: what a column measures, and whether it was measured, filtered or commanded.

use super::languages::in_english;
use super::units::{self, Unit};

/// What a column is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Time,
    Position,
    Velocity,
    Acceleration,
    /// A force at the joint.
    Torque,
    /// A motor's torque, at its side of the gear.
    Input,
    Current,
    Run,
    /// Names of the joints, as text in the rows.
    Name,
}

/// How a column came to be. The order is the one in which columns are preferred.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Origin {
    Measured,
    Unsaid,
    Filtered,
    Commanded,
}

/// What the words of a header say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Meaning {
    pub kind: Kind,
    pub origin: Origin,
    /// 0 for the usual words; larger for words that mean it less surely.
    pub doubt: u8,
}

/// A header's words, with the unit taken out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    /// Position in the row, from 0.
    pub index: usize,
    /// As it stands in the file.
    pub text: String,
    /// Words in lower case and numbers.
    pub words: Vec<String>,
    /// Unit in brackets or in a row of units.
    pub unit: Option<Unit>,
    /// What stands in brackets at the end and is neither a unit nor a number.
    pub odd: Option<String>,
}

impl Header {
    /// - `below`: what a row of units says
    pub(super) fn new(index: usize, text: &str, below: Option<&str>) -> Self {
        let (rest, bracketed, odd) = take_unit(text);
        let german = || below.filter(|_| is_translated(text)).and_then(units::find_german);
        let unit = bracketed.or_else(|| below.and_then(units::find)).or_else(german);
        let odd =
            odd.or_else(|| below.filter(|text| unit.is_none() && units::is_grad(text)).map(str::to_owned));
        Self { index, text: text.to_owned(), words: words(&rest), unit, odd }
    }
}

/// Text without the brackets that hold a unit, the unit, and a bracket's text at the end that is none.
fn take_unit(text: &str) -> (String, Option<Unit>, Option<String>) {
    let mut odd = None;
    let mut from = 0;
    while let Some(open) = text[from..].find(['[', '(']).map(|at| at + from) {
        let Some(close) = text[open..].find([']', ')']).map(|at| at + open) else { break };
        let inner = text[open + 1..close].trim();
        let german = || units::find_german(inner).filter(|_| is_translated(&text[..open]));
        if let Some(unit) = units::find(inner).or_else(german).filter(|_| inner.parse::<f64>().is_err()) {
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

/// Words and numbers of a text: split at other characters, between letters and digits, and where a small letter
/// is followed by a word with a capital. Words of other languages are in English.
pub(super) fn words(text: &str) -> Vec<String> {
    split(text).into_iter().flat_map(in_english).collect()
}

/// Whether a text has words of another language.
pub(super) fn is_translated(text: &str) -> bool {
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

/// Words of a kind, with their doubt, that stand for nothing else.
const STRONG: [(Kind, u8, &str); 15] = [
    (
        Kind::Time,
        0,
        "time times timestamp timestamps stamp sec secs seconds nsec nsecs nanosec nanosecs nanosecond \
         nanoseconds",
    ),
    (Kind::Time, 1, "elapsed clock"),
    (Kind::Position, 0, "position positions pos jpos qpos"),
    (Kind::Position, 1, "angle angles ang phi theta"),
    (Kind::Position, 2, "encoder"),
    (Kind::Velocity, 0, "velocity velocities vel jvel speed speeds dq qd qdot qvel"),
    (Kind::Velocity, 1, "qp dtheta thetadot dphi omega"),
    (Kind::Acceleration, 0, "acceleration accelerations acc accel ddq qdd qddot qdotdot"),
    (Kind::Acceleration, 1, "thetadotdot"),
    (Kind::Torque, 0, "qfrc jtrq jtor effort efforts eff torque torques trq tau tauj"),
    (Kind::Torque, 1, "moment force"),
    (Kind::Input, 0, "input inputs"),
    (Kind::Run, 0, "run trial segment"),
    (Kind::Run, 1, "episode"),
    (Kind::Name, 0, "name names"),
];

/// Currents: `current` before another word means "present".
const CURRENT: &str = "current currents cur curr amp amps amperage iq imot";

/// Whether a word names a quantity by itself, and is no single letter.
pub(super) fn is_quantity(word: &str) -> bool {
    is_in(CURRENT, word) || STRONG.iter().any(|(_, _, list)| is_in(list, word))
}

/// Single letters count where no longer word says something.
const WEAK: [(Kind, u8, &str); 8] = [
    (Kind::Time, 0, "t"),
    (Kind::Position, 0, "q"),
    (Kind::Position, 1, "y"),
    (Kind::Velocity, 0, "v"),
    (Kind::Velocity, 1, "w"),
    (Kind::Acceleration, 0, "a"),
    (Kind::Input, 0, "u"),
    (Kind::Current, 0, "i"),
];

const MEASURED: &str = "measured meas msr actual act real fb feedback sensor present";
const FILTERED: &str = "filtered filt smoothed smooth est estimate estimated interpolated";
const COMMANDED: &str = "target desired des command commanded commands cmd ref reference setpoint goal nominal planned plan ipo \
    set soll control d";

/// Words that say nothing of the quantity.
const NEUTRAL: &str = "joint joints jnt j state states axis axes robot arm manipulator link field msg data value values \
    header output id index no";

/// Words of quantities that are not a joint's, or not its own.
const FOREIGN: &str = "error err limit limits min max mean std residual ext external contact friction gravity coriolis model \
    dtau tcp cartesian tool ee eef flange wrench ft imu accelerometer pose temperature temp voltage power \
    pwm mode status window gain stiffness damping rate frequency robust base";

/// Whether a word stands in a list of them.
fn is_in(list: &str, word: &str) -> bool {
    list.split(' ').any(|known| known == word)
}

/// What words say without names, numbers and units; none if they say nothing or contradict each other.
pub(super) fn meaning(words: &[&str]) -> Option<Meaning> {
    if words.iter().any(|w| is_in(FOREIGN, w)) {
        return None;
    }
    let joined = join_derivatives(words);
    let (kind, mut doubt, at) = strong(&joined)?;
    let origin = origin(&joined, at);
    let motor = joined.iter().any(|w| w == "motor" || w == "drive");
    let kind = if motor && kind == Kind::Torque { Kind::Input } else { kind };
    // The position behind a gear is the joint's, the one before it may not be.
    doubt += u8::from(motor && matches!(kind, Kind::Position | Kind::Velocity));
    doubt += 2 * u8::from(joined.iter().any(|w| is_unknown(w)));
    if kind == Kind::Time {
        doubt += time_doubt(&joined);
    }
    Some(Meaning { kind, origin, doubt })
}

/// `q dot`, `q dot dot` and `q ddot` as one word.
fn join_derivatives(words: &[&str]) -> Vec<String> {
    let mut joined: Vec<String> = Vec::new();
    for word in words {
        match joined.last_mut() {
            Some(last) if *word == "dot" => last.push_str("dot"),
            Some(last) if *word == "ddot" => last.push_str("dotdot"),
            _ => joined.push((*word).to_owned()),
        }
    }
    joined
}

/// The kind that the words name, how sure that is, and where the word stands.
fn strong(words: &[String]) -> Option<(Kind, u8, usize)> {
    let find = |table: &[(Kind, u8, &str)]| -> Vec<(Kind, u8, usize)> {
        let hits = words.iter().enumerate().filter_map(|(at, word)| {
            let row = table.iter().find(|(_, _, list)| is_in(list, word));
            row.map(|(kind, doubt, _)| (*kind, *doubt, at))
        });
        hits.collect()
    };
    let mut found = find(&STRONG);
    let current = words.iter().rposition(|w| is_in(CURRENT, w));
    match (current, found.first()) {
        (Some(at), None) => return Some((Kind::Current, 0, at)),
        // The torque current of a drive; but the present torque.
        (Some(at), Some(first)) if at > first.2 => return Some((Kind::Current, 0, at)),
        _ => {}
    }
    if found.is_empty() {
        found = find(&WEAK);
    }
    let (kind, ..) = *found.first()?;
    let agrees = found.iter().all(|f| f.0 == kind);
    agrees.then(|| found.into_iter().min_by_key(|f| f.1)).flatten()
}

fn origin(words: &[String], at: usize) -> Origin {
    let has = |list: &str| words.iter().any(|w| is_in(list, w));
    let present = words[..at].iter().any(|w| is_in(CURRENT, w));
    let joint_states = words.windows(2).any(|w| w[0].starts_with("joint") && w[1] == "states");
    if has(COMMANDED) {
        Origin::Commanded
    } else if has(FILTERED) {
        Origin::Filtered
    } else if has(MEASURED) || present || joint_states {
        Origin::Measured
    } else {
        Origin::Unsaid
    }
}

fn is_unknown(word: &str) -> bool {
    let lists = [MEASURED, FILTERED, COMMANDED, NEUTRAL, CURRENT, "motor drive"];
    let kinds = STRONG.iter().chain(&WEAK).map(|(_, _, list)| *list);
    let known = lists.into_iter().chain(kinds).any(|list| is_in(list, word));
    !(known || is_number(word) || units::find(word).is_some())
}

/// A word that says nothing of the quantity, or a letter.
pub(super) fn is_plain(word: &str) -> bool {
    is_in(NEUTRAL, word) || word.chars().count() == 1
}

/// Whether all words are ones that headers have beside units, or numbers.
pub(super) fn is_known(words: &[&str]) -> bool {
    // `[V]` is a unit that nothing here is in, not the letter of velocities.
    let is_word = |w: &&str| w.chars().count() > 1 && (is_in(FOREIGN, w) || !is_unknown(w));
    !words.is_empty() && words.iter().all(|w| is_number(w) || is_word(w))
}

/// The time in a message's header is when it was measured; a bag's is when it came.
fn time_doubt(words: &[String]) -> u8 {
    let has = |list: &str| words.iter().any(|w| is_in(list, w));
    let stamped = has("header") && has("stamp");
    let received = has("rosbag bag received receive recv log logged wall system host");
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
        let words: Vec<&str> = header.words.iter().map(String::as_str).filter(|w| !is_number(w)).collect();
        meaning(&words).map(|m| (m.kind, m.origin))
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
        assert_eq!(Header::new(0, "q1 [Grad]", None).odd.as_deref(), Some("Grad"));
        assert_eq!(Header::new(0, "tau", Some("mNm")).unit.map(|u| u.factor), Some(1e-3));
    }
}
