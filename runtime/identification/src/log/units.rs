//! Units as logs name them, and what they are in SI.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// A unit: its value in the SI unit of the same kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub factor: f64,
    /// The SI unit, which tells the kind: `s`, `rad`, `rad/s`, `m`, `N*m`, …
    pub si: &'static str,
}

const DEGREE: f64 = PI / 180.0;
/// Units by the SI unit of their kind, with their values in it.
const UNITS: [(&str, &[(&str, f64)]); 12] = [
    ("s", &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0)]),
    ("rad", &[("rad", 1.0), ("mrad", 1e-3), ("deg", DEGREE), ("gon", PI / 200.0), ("rev", 2.0 * PI)]),
    (
        "rad/s",
        &[("rad/s", 1.0), ("mrad/s", 1e-3), ("deg/s", DEGREE), ("rpm", PI / 30.0), ("rev/s", 2.0 * PI)],
    ),
    ("rad/s^2", &[("rad/s^2", 1.0), ("deg/s^2", DEGREE)]),
    ("m", &[("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("um", 1e-6)]),
    ("m/s", &[("m/s", 1.0), ("mm/s", 1e-3)]),
    ("m/s^2", &[("m/s^2", 1.0), ("mm/s^2", 1e-3)]),
    ("N*m", &[("N*m", 1.0), ("Nm", 1.0), ("mNm", 1e-3), ("Ncm", 1e-2), ("kNm", 1e3)]),
    ("N", &[("N", 1.0), ("kN", 1e3)]),
    ("A", &[("A", 1.0), ("mA", 1e-3)]),
    ("count", &[("count", 1.0)]),
    ("1", &[("1", 1.0)]),
];

/// Other spellings of units, in lower case and without blanks and multiplication signs.
const SPELLINGS: [(&str, &str); 19] = [
    ("s", "sec secs second seconds sekunde sekunden seconde secondes secondi segundos"),
    ("ms", "msec millis milliseconds"),
    ("us", "usec micros microseconds"),
    ("min", "minute minutes minuten minuti minutos"),
    ("ns", "nsec nanos nsecs nanosec nanosecs nanosecond nanoseconds"),
    ("rad", "radian radians radiant radianti radianes"),
    ("deg", "° degs degree degrees gradi grados"),
    ("gon", "gons gradian gradians"),
    ("rev", "turn turns revs revolutions"),
    ("rad/s", "rads radps rad/sec rads^-1"),
    ("deg/s", "°/s dps degps deg/sec"),
    ("rev/s", "rps"),
    ("rpm", "rev/min 1/min u/min umin^-1 tr/min giri/min"),
    ("m", "meter meters"),
    ("m/s", "mps"),
    ("N", "newton"),
    ("Nm", "newtonmeter newton-meter"),
    ("A", "amp amps ampere"),
    ("mA", "milliamps"),
];

/// All units with their names.
fn units() -> impl Iterator<Item = (&'static str, Unit)> {
    UNITS
        .iter()
        .flat_map(|(si, names)| names.iter().map(|(name, factor)| (*name, Unit { factor: *factor, si })))
}

/// The unit of exactly this name.
pub(super) fn conversion(unit: &str) -> Option<(f64, &'static str)> {
    units().find(|(name, _)| *name == unit).map(|(_, unit)| (unit.factor, unit.si))
}

/// The value of the unit of exactly this name, in the SI unit of its kind.
pub(crate) fn unit_value(unit: &str) -> Option<f64> {
    conversion(unit).map(|(value, _)| value)
}

/// Share of a limit that values use whose unit is right.
pub(crate) const SEEN: RangeInclusive<f64> = 0.05..=1.1;

/// Whether speeds that are so many times their limit would be within it, and use a part of it that can be seen, if times were
/// minutes.
pub(crate) fn are_minutes(times: f64) -> bool {
    SEEN.contains(&(times / 60.0))
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

/// The unit in a German header, where `Grad` is a degree.
pub(super) fn find_german(text: &str) -> Option<Unit> {
    behind_grad(text).and_then(|rest| find(&format!("deg{rest}")))
}

/// Whether a unit is `Grad`: a degree in German, and elsewhere a gon, a hundredth of a right angle.
pub(super) fn is_grad(text: &str) -> bool {
    behind_grad(text).is_some_and(|rest| find(&format!("deg{rest}")).is_some())
}

fn behind_grad(text: &str) -> Option<&str> {
    let text = text.trim();
    let (grad, rest) = (text.get(..4)?, text.get(4..)?);
    grad.eq_ignore_ascii_case("grad").then_some(rest)
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
    let is_spelled = |(_, spellings): &&(&str, &str)| spellings.split(' ').any(|other| other == lower);
    let spelled = SPELLINGS.iter().find(is_spelled).map_or(plain.as_str(), |(unit, _)| *unit);
    let exact = units().find(|(name, _)| *name == spelled);
    // `nm` and `NM` are newton metres: no joint moves by nanometres. `MA` and `MNm` are no milliampere and so on.
    let is_mega = ["MA", "MNm", "MN"].contains(&spelled);
    let loose = || units().find(|(name, _)| name.eq_ignore_ascii_case(spelled) && !is_mega);
    exact.or_else(loose).map(|(_, unit)| unit)
}

/// Names of all units, for messages.
pub(super) fn known_units() -> String {
    units().map(|(name, _)| name).collect::<Vec<_>>().join(", ")
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
            ("gon", PI / 200.0, "rad"),
            ("0.5*mm", 0.5e-3, "m"),
            ("U/min", PI / 30.0, "rad/s"),
            ("Sekunden", 1.0, "s"),
            ("min", 60.0, "s"),
        ];
        for (text, factor, si) in cases {
            let unit = find(text).unwrap_or_else(|| panic!("{text}"));
            assert!((unit.factor / factor - 1.0).abs() < 1e-15 && unit.si == si, "{text}: {unit:?}");
        }
        assert_eq!(find_german("Grad/s²").map(|unit| unit.si), Some("rad/s^2"));
        assert!(["Grad", "grad/s", " GRAD "].iter().all(|text| is_grad(text)));
        assert!(["gradi", "gradient", "rad", "gon", "µrad"].iter().all(|text| !is_grad(text)));
        for text in ["", "%", "counts per turn", "0 deg", "1e999 deg", "nan deg", "MA", "grad"] {
            assert_eq!(find(text), None, "{text}");
        }
    }
}
