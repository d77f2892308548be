//! Units in the headers of logs, with their values in SI units.

use super::levels;
use std::f64::consts::PI;

/// A unit with its value in the SI unit of the same kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub factor: f64,
    /// The SI unit, which identifies the kind of the quantity: `s`, `rad`, `rad/s`, `m`, `N*m`, …
    pub si: &'static str,
}

const DEGREE: f64 = PI / 180.0;

/// Units, grouped by the SI unit of their kind. Each unit has its value in the SI unit, and its spellings without blanks
/// and multiplication signs. Messages use the first spelling.
#[rustfmt::skip]
const UNITS: [(&str, &[(f64, &str)]); 12] = [
    ("s", &[
        (1.0, "s sec secs second seconds sekunde sekunden seconde secondes secondi segundos"),
        (1e-3, "ms msec millis milliseconds"),
        (1e-6, "us usec micros microseconds"),
        (1e-9, "ns nsec nanos nsecs nanosec nanosecs nanosecond nanoseconds"),
        (60.0, "min minute minutes minuten minuti minutos"),
    ]),
    ("rad", &[
        (1.0, "rad radian radians radiant radianti radianes"),
        (1e-3, "mrad"),
        (DEGREE, "deg ° degs degree degrees gradi grados"),
        (PI / 200.0, "gon gons gradian gradians"),
        (2.0 * PI, "rev turn turns revs revolutions"),
    ]),
    ("rad/s", &[
        (1.0, "rad/s rads radps rad/sec rads^-1"),
        (1e-3, "mrad/s"),
        (DEGREE, "deg/s °/s dps degps deg/sec"),
        (PI / 30.0, "rpm rev/min 1/min u/min umin^-1 tr/min giri/min"),
        (2.0 * PI, "rev/s rps"),
    ]),
    ("rad/s^2", &[(1.0, "rad/s^2"), (DEGREE, "deg/s^2")]),
    ("m", &[(1.0, "m meter meters"), (1e-3, "mm"), (1e-2, "cm"), (1e-6, "um")]),
    ("m/s", &[(1.0, "m/s mps"), (1e-3, "mm/s")]),
    ("m/s^2", &[(1.0, "m/s^2"), (1e-3, "mm/s^2")]),
    ("N*m", &[(1.0, "Nm newtonmeter newton-meter"), (1e-3, "mNm"), (1e-2, "Ncm"), (1e3, "kNm")]),
    ("N", &[(1.0, "N newton"), (1e3, "kN")]),
    ("A", &[(1.0, "A amp amps ampere"), (1e-3, "mA milliamps")]),
    ("count", &[(1.0, "count")]),
    ("1", &[(1.0, "1")]),
];

/// `Grad` in headers that are not German. It can be a degree, or a gon (a hundredth of a right angle).
pub(super) const GRAD: &str = "grad";

/// Returns all units with their spellings.
fn units() -> impl Iterator<Item = (&'static str, Unit)> {
    let of = |(si, units): &(&'static str, &'static [(f64, &'static str)])| {
        let si = *si;
        units.iter().map(move |(factor, spellings)| (*spellings, Unit { factor: *factor, si }))
    };
    UNITS.iter().flat_map(of)
}

/// Returns the value of a unit in the SI unit of its kind; `None` for unknown units.
pub(crate) fn unit_value(unit: &str) -> Option<f64> {
    named(unit).map(|unit| unit.factor)
}

/// Returns whether values may be in the right unit: they are within their limit and use a noticeable part of it.
///
/// - `share`: ratio of the values to their limit
pub(crate) fn is_seen(share: f64) -> bool {
    let [least, most] = levels::SEEN.get();
    (least..=most).contains(&share)
}

/// Returns whether speeds may be per minute: divided by 60, they are within their limit and use a noticeable part of it.
///
/// - `times`: ratio of the speeds to their limit
pub(crate) fn are_minutes(times: f64) -> bool {
    is_seen(times / 60.0)
}

impl Unit {
    /// Returns the unit in a spelling that [`find`] can read.
    pub(super) fn text(&self) -> String {
        let known = units().find(|(_, unit)| unit == self);
        let name = known.and_then(|(spellings, _)| spellings.split(' ').next());
        name.map_or_else(|| format!("{} {}", self.factor, self.si), str::to_owned)
    }
}

/// Returns the unit with a spelling; `None` for unknown units. A number before the unit is a factor, for example `0.0879
/// deg`.
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

/// Returns the unit in a header. `Grad` is a degree if the header is in a language in which the word means a degree.
pub(super) fn in_header(text: &str, is_translated: bool) -> Option<Unit> {
    let grad = || {
        let lower = text.trim().to_lowercase();
        let degrees = find(&format!("deg{}", lower.strip_prefix(GRAD)?))?;
        Some(if is_translated { degrees } else { Unit { si: GRAD, ..degrees } })
    };
    find(text).or_else(grad)
}

fn named(text: &str) -> Option<Unit> {
    let plain: String = text
        .chars()
        .filter(|c| !c.is_whitespace() && !"*·⋅.".contains(*c))
        .map(|c| match c {
            'µ' | 'μ' => 'u',
            '²' => '2',
            // This character is a degree sign in a file that is not UTF-8.
            'º' | char::REPLACEMENT_CHARACTER => '°',
            c => c,
        })
        .collect();
    let plain = plain.replace("s2", "s^2").replace("s^^2", "s^2").replace("s**2", "s^2");
    let spelled = |is_same: &dyn Fn(&str) -> bool| units().find(|(names, _)| names.split(' ').any(is_same));
    // `nm` and `NM` are newton metres, because no joint moves by nanometres. `MA`, `MNm` and `MN` are not read as `mA`,
    // `mNm` and `mN`.
    let is_mega = ["MA", "MNm", "MN"].contains(&plain.as_str());
    let loose = || spelled(&|name| !is_mega && name.to_lowercase() == plain.to_lowercase());
    spelled(&|name| name == plain).or_else(loose).map(|(_, unit)| unit)
}

/// Returns the names of all units, for messages.
pub(super) fn known_units() -> String {
    units().filter_map(|(spellings, _)| spellings.split(' ').next()).collect::<Vec<_>>().join(", ")
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
            assert_eq!(find(&unit.text()), Some(unit), "{text}: {}", unit.text());
        }
        assert_eq!(in_header("Grad/s²", true).map(|unit| unit.si), Some("rad/s^2"));
        let is_grad = |text: &str| in_header(text, false).is_some_and(|unit| unit.si == GRAD);
        assert!(["Grad", "grad/s", " GRAD "].iter().all(|text| is_grad(text)));
        assert!(["gradi", "gradient", "rad", "gon", "µrad"].iter().all(|text| !is_grad(text)));
        for text in ["", "%", "counts per turn", "0 deg", "1e999 deg", "nan deg", "MA", "grad"] {
            assert_eq!(find(text), None, "{text}");
        }
    }
}
