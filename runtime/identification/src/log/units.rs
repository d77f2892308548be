//! Units as logs name them, and what they are in SI.

use std::f64::consts::PI;

/// A unit: its value in the SI unit of the same kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub factor: f64,
    /// The SI unit, which tells the kind: `s`, `rad`, `rad/s`, `m`, `N*m`, …
    pub si: &'static str,
}

const DEGREE: f64 = PI / 180.0;
const UNITS: [(&str, f64, &str); 34] = [
    ("s", 1.0, "s"),
    ("ms", 1e-3, "s"),
    ("us", 1e-6, "s"),
    ("ns", 1e-9, "s"),
    ("rad", 1.0, "rad"),
    ("mrad", 1e-3, "rad"),
    ("deg", DEGREE, "rad"),
    ("rev", 2.0 * PI, "rad"),
    ("rad/s", 1.0, "rad/s"),
    ("mrad/s", 1e-3, "rad/s"),
    ("deg/s", DEGREE, "rad/s"),
    ("rpm", PI / 30.0, "rad/s"),
    ("rev/s", 2.0 * PI, "rad/s"),
    ("rad/s^2", 1.0, "rad/s^2"),
    ("deg/s^2", DEGREE, "rad/s^2"),
    ("m", 1.0, "m"),
    ("mm", 1e-3, "m"),
    ("cm", 1e-2, "m"),
    ("um", 1e-6, "m"),
    ("m/s", 1.0, "m/s"),
    ("mm/s", 1e-3, "m/s"),
    ("m/s^2", 1.0, "m/s^2"),
    ("mm/s^2", 1e-3, "m/s^2"),
    ("N*m", 1.0, "N*m"),
    ("Nm", 1.0, "N*m"),
    ("mNm", 1e-3, "N*m"),
    ("Ncm", 1e-2, "N*m"),
    ("kNm", 1e3, "N*m"),
    ("N", 1.0, "N"),
    ("kN", 1e3, "N"),
    ("A", 1.0, "A"),
    ("mA", 1e-3, "A"),
    ("count", 1.0, "count"),
    ("1", 1.0, "1"),
];

/// Other spellings, in lower case and without blanks and multiplication signs.
const SPELLINGS: [(&str, &str); 48] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("millis", "ms"),
    ("milliseconds", "ms"),
    ("usec", "us"),
    ("micros", "us"),
    ("microseconds", "us"),
    ("nsec", "ns"),
    ("nanos", "ns"),
    ("nsecs", "ns"),
    ("nanosec", "ns"),
    ("nanosecs", "ns"),
    ("nanosecond", "ns"),
    ("nanoseconds", "ns"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("°", "deg"),
    ("degs", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("turn", "rev"),
    ("turns", "rev"),
    ("revs", "rev"),
    ("revolutions", "rev"),
    ("rads", "rad/s"),
    ("radps", "rad/s"),
    ("rad/sec", "rad/s"),
    ("rads^-1", "rad/s"),
    ("°/s", "deg/s"),
    ("dps", "deg/s"),
    ("degps", "deg/s"),
    ("deg/sec", "deg/s"),
    ("rps", "rev/s"),
    ("rev/min", "rpm"),
    ("1/min", "rpm"),
    ("meter", "m"),
    ("meters", "m"),
    ("mps", "m/s"),
    ("newton", "N"),
    ("newtonmeter", "Nm"),
    ("newton-meter", "Nm"),
    ("amp", "A"),
    ("amps", "A"),
    ("ampere", "A"),
    ("milliamps", "mA"),
];

/// The unit of exactly this name.
pub(super) fn conversion(unit: &str) -> Option<(f64, &'static str)> {
    UNITS.iter().find(|u| u.0 == unit).map(|u| (u.1, u.2))
}

/// The unit that a stranger's log names, in one of its spellings; a number before it is a factor, as in
/// `0.0879 deg`.
pub(super) fn find(text: &str) -> Option<Unit> {
    let text = text.trim();
    if let Some(unit) = named(text) {
        return Some(unit);
    }
    let split = text.find(|c: char| !c.is_ascii_digit() && !"+-.".contains(c))?;
    let factor: f64 = text[..split].parse().ok().filter(|f: &f64| f.is_finite() && *f != 0.0)?;
    let unit = named(text[split..].trim_start_matches(['*', ' ']))?;
    Some(Unit { factor: factor * unit.factor, ..unit })
}

fn named(text: &str) -> Option<Unit> {
    let plain: String = text
        .chars()
        .filter(|c| !c.is_whitespace() && !"*·⋅.".contains(*c))
        .map(|c| match c {
            'µ' | 'μ' => 'u',
            '²' => '2',
            // What is left of a degree sign in a file that is not UTF-8.
            'º' | char::REPLACEMENT_CHARACTER => '°',
            c => c,
        })
        .collect();
    let plain = plain.replace("s2", "s^2").replace("s^^2", "s^2").replace("s**2", "s^2");
    let lower = plain.to_lowercase();
    let spelled = SPELLINGS.iter().find(|s| s.0 == lower).map_or(plain.as_str(), |s| s.1);
    let exact = UNITS.iter().find(|u| u.0 == spelled);
    // `nm` and `NM` are newton metres: no joint moves by nanometres. `MA` and `MNm` are no milliampere and so on.
    let is_mega = ["MA", "MNm", "MN"].contains(&spelled);
    let loose = || UNITS.iter().find(|u| u.0.eq_ignore_ascii_case(spelled) && !is_mega);
    exact.or_else(loose).map(|u| Unit { factor: u.1, si: u.2 })
}

/// Names of all units, for messages.
pub(super) fn known_units() -> String {
    UNITS.map(|u| u.0).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_are_known() {
        let cases = [
            ("Nm", 1.0, "N*m"),
            ("N·m", 1.0, "N*m"),
            ("N m", 1.0, "N*m"),
            ("nm", 1.0, "N*m"),
            ("mNm", 1e-3, "N*m"),
            ("deg", DEGREE, "rad"),
            ("Degrees", DEGREE, "rad"),
            ("°/s", DEGREE, "rad/s"),
            ("RPM", PI / 30.0, "rad/s"),
            ("rad/s²", 1.0, "rad/s^2"),
            ("rad/s2", 1.0, "rad/s^2"),
            ("µs", 1e-6, "s"),
            ("mA", 1e-3, "A"),
            ("2.0 deg", 2.0 * DEGREE, "rad"),
            ("0.5*mm", 0.5e-3, "m"),
        ];
        for (text, factor, si) in cases {
            let unit = find(text).unwrap_or_else(|| panic!("{text}"));
            assert!((unit.factor / factor - 1.0).abs() < 1e-15 && unit.si == si, "{text}: {unit:?}");
        }
        for text in ["", "%", "counts per turn", "0 deg", "1e999 deg", "nan deg", "MA", "grad"] {
            assert_eq!(find(text), None, "{text}");
        }
    }
}
