//! Factors of columns to SI, by the unit that the user, the header or the row below it names.

use super::super::error::{IdentificationError, Result};
use super::super::numeric::digits::plain;
use super::finder::Finder;
use super::units::{self, Unit};
use super::vocabulary::{Header, Kind, is_known, is_number, is_translated, words};
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
    if let Some(grad) = header.and_then(|h| grad(finder, h)) {
        return grad.map_or_else(
            || Err(finder.fault(grad_said(&finder.label(column), kind))),
            |degrees| fitting(finder, column, kind, &wanted, degrees),
        );
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
            format!("times {} in {}", plain(unit.factor, 6), unit.si)
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

/// Degrees where a German header is in `Grad`, nothing where another one is.
fn grad(finder: &Finder, header: &Header) -> Option<Option<Unit>> {
    let is_last = |words: &[String]| match words {
        [.., grad, second] if second == "s" => grad == "grad",
        [.., grad] => grad == "grad",
        [] => false,
    };
    let is_named = || finder.robot.joints.mentions(&["grad".to_owned()]);
    let words: Vec<String> = header.words.iter().filter(|w| !is_number(w)).cloned().collect();
    let in_words = (is_last(&words) && words.len() > 1 && !is_named()).then(|| {
        let behind = if words.last().is_some_and(|word| word == "s") { "/s" } else { "" };
        format!("grad{behind}")
    });
    let unit = header.odd.clone().filter(|odd| units::is_grad(odd)).or(in_words)?;
    Some(units::find_german(&unit).filter(|_| is_translated(&header.text)))
}

fn grad_said(label: &str, kind: Kind) -> String {
    let (key, behind) = (singular(kind), if kind == Kind::Velocity { "/s" } else { "" });
    let gon = if kind == Kind::Position { format!(" or '{key}=…[gon]'") } else { String::new() };
    format!(
        "column {label} is in Grad, which are degrees in German and gons, hundredths of a right angle, elsewhere: \
         --columns '{key}=…[deg{behind}]'{gon} settles it"
    )
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
pub(super) fn is_described(finder: &Finder, text: &str) -> bool {
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
