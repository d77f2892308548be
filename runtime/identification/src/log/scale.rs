//! Factors of columns to SI, by the unit that the user, the header or the row below it names.

use super::super::error::{IdentificationError, Result};
use super::finder::Finder;
use super::units::{self, Unit};
use super::vocabulary::{Header, Kind, is_known, is_number, words};
use super::wording::singular;

/// Factor of a column to SI, and what was taken as its unit, in words.
///
/// - `joint`: number of the joint or input
/// - `told`: the unit that the user names
///
/// # Errors
/// Units that are not known, or that are none of the quantity.
pub(super) fn factor(
    finder: &Finder,
    column: usize,
    kind: Kind,
    joint: usize,
    told: Option<Unit>,
) -> Result<(f64, String)> {
    let units = match kind {
        Kind::Input | Kind::Current => &finder.robot.input_units,
        Kind::Torque => &finder.robot.torque_units,
        _ => &finder.robot.units,
    };
    let wanted = accepted(kind, units.get(joint).copied().unwrap_or("rad"));
    let header = finder.headers.get(column);
    let named = told.or_else(|| header.and_then(|h| h.unit));
    if let Some(unit) = named {
        return fitting(finder, column, kind, &wanted, unit);
    }
    if let Some(odd) = header.and_then(|h| h.odd.as_ref()).filter(|odd| !is_described(finder, odd)) {
        return Err(finder.fault(format!(
            "column {} is in `{odd}`, which is no known unit; name it with --columns '{}=…[UNIT]' (known are {}; a factor \
             may precede, as in [0.0879 deg])",
            finder.label(column),
            singular(kind),
            units::known_units()
        )));
    }
    if let Some(unit) = header.and_then(|h| suffix(h, &wanted, &|words| is_named(finder, words))) {
        return fitting(finder, column, kind, &wanted, unit);
    }
    Ok((1.0, format!("in {} as its header names no unit", wanted[0])))
}

fn fitting(finder: &Finder, column: usize, kind: Kind, wanted: &[&str], unit: Unit) -> Result<(f64, String)> {
    if wanted.contains(&unit.si) || unit.si == "1" {
        let said = if unit.factor == 1.0 {
            format!("in {}", unit.si)
        } else {
            format!("times {} in {}", unit.factor, unit.si)
        };
        return Ok((unit.factor, said));
    }
    Err(IdentificationError::File {
        place: finder.source.into(),
        message: format!(
            "column {} is {} {} in {}, but {} is expected here",
            finder.label(column),
            article(kind),
            singular(kind),
            unit.si,
            wanted.join(" or ")
        ),
    })
}

fn article(kind: Kind) -> &'static str {
    if singular(kind).starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" }
}

/// SI units of a quantity; the first is assumed where none is named.
fn accepted(kind: Kind, position: &'static str) -> Vec<&'static str> {
    let linear = position == "m";
    match kind {
        Kind::Time => vec!["s"],
        Kind::Position => vec![position],
        Kind::Velocity if linear => vec!["m/s"],
        Kind::Velocity => vec!["rad/s"],
        Kind::Acceleration if linear => vec!["m/s^2"],
        Kind::Acceleration => vec!["rad/s^2"],
        Kind::Torque if linear => vec!["N"],
        Kind::Torque => vec!["N*m"],
        // A motor before a spindle has a torque, the joint behind it a force.
        Kind::Input if linear => vec!["N", "N*m"],
        Kind::Input => vec!["N*m", "N"],
        Kind::Current => vec!["A"],
        Kind::Run | Kind::Name => vec!["1"],
    }
}

/// Text in brackets that says something else than a unit: words of headers, or a joint's name.
fn is_described(finder: &Finder, text: &str) -> bool {
    let spelled = words(text);
    let known: Vec<&str> = spelled.iter().map(String::as_str).collect();
    is_known(&known) || finder.robot.joints.mentions(&spelled) || finder.robot.inputs.mentions(&spelled)
}

/// Whether words are the name of a joint or an input: `tau_turn` of a joint `turn` is in no revolutions.
fn is_named(finder: &Finder, spelled: &[&str]) -> bool {
    let spelled: Vec<String> = spelled.iter().map(|word| (*word).to_owned()).collect();
    finder.robot.joints.mentions(&spelled) || finder.robot.inputs.mentions(&spelled)
}

/// A unit that ends the words: `q1_deg`, `vel_2_deg_s`.
///
/// - `is_name`: whether words mean something else
fn suffix(header: &Header, wanted: &[&str], is_name: &dyn Fn(&[&str]) -> bool) -> Option<Unit> {
    let words: Vec<&str> = header.words.iter().map(String::as_str).filter(|w| !is_number(w)).collect();
    let tails = (1..=3.min(words.len().saturating_sub(1))).rev().map(|n| &words[words.len() - n..]);
    let mut named = tails.filter(|tail| !is_name(tail)).filter_map(|tail| {
        let parts: Vec<&str> = tail.iter().copied().filter(|w| *w != "per").collect();
        // A letter at the end may mean something else (`q_m`, measured): it counts where it fits.
        let is_sure = parts.first().is_some_and(|p| p.len() > 1);
        units::find(&parts.join("/")).filter(|unit| is_sure || wanted.contains(&unit.si))
    });
    named.next()
}

/// The unit at the end of the words of a time column.
pub(super) fn time_suffix(header: &Header) -> Option<Unit> {
    suffix(header, &["s"], &|_| false).filter(|unit| unit.si == "s")
}
