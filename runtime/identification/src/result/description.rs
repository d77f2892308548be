//! Writes identified values as a robot description in TOML, which `gelenk generate` accepts.
//!
//! The written description extends the description that was used for the identification. For example, this description
//! replaces only the friction of joint `beta`:
//!
//! ```toml
//! name = "arm_identified"
//! extends = "arm.toml"
//!
//! [[joints]]
//! name = "beta"
//! friction = { terms = [["v", 76.5], ["tanh(10*v)", 16.9]] }
//! ```

use super::super::error::{self, IdentificationError, Result, at};
use super::super::methods::expression::fault;
use super::{FrictionLaw, FrictionResult, FrictionTerm};
use gelenk_files::{is_same_file, write_whole};
use gelenk_findings::Finding;
use gelenk_findings::digits::{literal, plain, vanishes};
use gelenk_formula::{Allowed, Formula, FrictionPart, FrictionTerm as Written, parse, toml_text};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;

/// First line of every description with identified values.
const FIRST_LINE: &str = "# Identified by gelenk.\n";

/// Identified values, and the other keys of the written description.
#[derive(Debug, Clone, Copy, Default)]
pub struct Identified<'a> {
    /// Name of the robot and of its generated module.
    pub name: &'a str,
    /// Path of the description that was used for the identification, a URDF or a TOML. The path is absolute, or relative to
    /// the folder of the written description.
    pub extends: &'a str,
    /// Lines of text on the origin of the values. The lines become comments at the beginning of the file.
    pub provenance: &'a [String],
    /// Additional top-level keys, one line of TOML each. They determine how the extended description is read.
    pub settings: &'a [String],
    /// Friction law of each identified joint.
    pub friction: &'a [FrictionResult],
    /// Drive of each joint that has one: the name of the joint and its lines of TOML. The first line is `drive = …`.
    pub drives: &'a [(String, String)],
    /// TOML tables such as `[[bodies]]`, which are written unchanged.
    pub bodies: &'a [String],
}

/// Writes the [description](identified_toml) to a file. The file is written completely or not at all.
///
/// - `path`: a new file, an empty file, or a file that this function has written before. [`Identified::extends`] is an
///   absolute path, or relative to the folder of `path`.
///
/// # Errors
/// - The errors of [`identified_toml`]
/// - [`IdentificationError::File`]: the file is the extended description itself, was not written by gelenk, or cannot be
///   written
pub fn write_identified(path: &Path, identified: &Identified<'_>) -> Result<()> {
    let text = identified_toml(identified)?;
    let fault =
        |message: String| at(path.display().to_string()).fault(format!("cannot be written: {message}"));
    if is_same_file(path, &path.with_file_name(identified.extends)) {
        return Err(fault("it is the description that the result extends: name another file".into()));
    }
    if !may_be_replaced(path, FIRST_LINE.as_bytes()).map_err(|e| fault(e.to_string()))? {
        let message = "the existing file was not written by an identification. Name another file, or remove this one first";
        return Err(fault(message.into()));
    }
    write_whole(path, text).map_err(|e| fault(e.to_string()))
}

/// Returns whether a file may be replaced: it does not exist, is empty, or begins with `head`.
pub(crate) fn may_be_replaced(path: &Path, head: &[u8]) -> io::Result<bool> {
    match fs::metadata(path) {
        Ok(found) if found.is_file() && found.len() > 0 => Ok(fs::read(path)?.starts_with(head)),
        // If the path is not a file, writing fails later.
        _ => Ok(true),
    }
}

/// Returns a TOML description with identified values.
///
/// Coefficients of friction are rounded to the digits that their errors justify ([`gelenk_findings::digits`]). Terms whose
/// coefficient rounds to zero are not written.
///
/// # Errors
/// - [`Empty`](IdentificationError::Empty): there are no identified values, or a law has no terms
/// - [`Expression`](IdentificationError::Expression): a joint occurs twice, or a description cannot contain a term
/// - [`Found`](IdentificationError::Found): a law was rejected, and the user did not accept it
/// - [`NotFinite`](IdentificationError::NotFinite): a coefficient is not finite
pub fn identified_toml(identified: &Identified<'_>) -> Result<String> {
    let Identified { name, extends, provenance, settings, friction, drives, bodies } = *identified;
    if friction.is_empty() && drives.is_empty() && bodies.is_empty() {
        return Err(IdentificationError::Empty { what: format!("the list of identified joints of {name}") });
    }
    let key = if extends.to_ascii_lowercase().ends_with(".urdf") { "urdf" } else { "extends" };
    let mut text = FIRST_LINE.to_owned();
    provenance.iter().for_each(|line| comment(line, &mut text));
    let _ = writeln!(text, "name = {}\n{key} = {}", toml_text(name), toml_text(extends));
    settings.iter().for_each(|line| {
        let _ = writeln!(text, "{line}");
    });
    for (i, result) in friction.iter().enumerate() {
        if friction[..i].iter().any(|r| r.joint == result.joint) {
            return Err(fault(&result.joint, "this joint has two results: give only one result per joint"));
        }
        let value = friction_value(result)?;
        text.push_str("\n[[joints]]\n");
        comments(result, &mut text);
        let _ = writeln!(text, "name = {}", toml_text(&result.joint));
        if let Some((_, drive)) = drives.iter().find(|(joint, _)| *joint == result.joint) {
            let _ = writeln!(text, "{drive}");
        }
        let _ = writeln!(text, "friction = {value}");
    }
    let has_law = |joint: &str| friction.iter().any(|result| result.joint == joint);
    for (joint, drive) in drives.iter().filter(|(joint, _)| !has_law(joint)) {
        let _ = writeln!(text, "\n[[joints]]\nname = {}\n{drive}", toml_text(joint));
    }
    bodies.iter().for_each(|body| {
        let _ = write!(text, "\n{body}");
    });
    Ok(text)
}

/// Returns the TOML value of the key `friction` of a joint or a drive.
///
/// # Errors
/// The errors are those of [`identified_toml`] that concern a law.
pub fn friction_value(result: &FrictionResult) -> Result<String> {
    let findings: Vec<Finding> =
        result.refusals().cloned().map(|reason| reason.joint(&result.joint)).collect();
    if !findings.is_empty() {
        return Err(IdentificationError::Found { findings });
    }
    let (curve, mut terms) = match &result.law {
        FrictionLaw::Terms(terms) => (None, written(&result.joint, terms)?),
        FrictionLaw::Stribeck(parameters) => {
            require_finite(&result.joint, &**parameters)?;
            let text = |parameter: &FrictionTerm| literal(parameter.coefficient, parameter.written_error());
            (Some(FrictionPart::Stribeck(parameters.each_ref().map(text))), Vec::new())
        }
    };
    if curve.is_none() && terms.is_empty() {
        return Err(IdentificationError::Empty { what: format!("the friction law of {}", result.joint) });
    }
    terms.extend(written(&result.joint, result.constant.as_slice())?);
    let terms = (!terms.is_empty()).then_some(FrictionPart::Terms(terms));
    let law = gelenk_formula::FrictionLaw {
        parts: curve.into_iter().chain(terms).collect(),
        load: written(&result.joint, &result.load)?,
    };
    Ok(law.toml())
}

/// Returns the terms with rounded coefficients, without terms whose coefficient rounds to zero.
fn written(joint: &str, terms: &[FrictionTerm]) -> Result<Vec<Written<String>>> {
    require_finite(joint, terms)?;
    let kept = terms.iter().filter(|t| !vanishes(t.coefficient, t.written_error()));
    kept.map(|t| {
        Ok(Written { basis: basis(&t.basis)?, coefficient: literal(t.coefficient, t.written_error()) })
    })
    .collect()
}

fn require_finite(joint: &str, terms: &[FrictionTerm]) -> Result<()> {
    let what = |term: &FrictionTerm| format!("the coefficient of {} of joint {joint}", term.basis);
    terms.iter().try_for_each(|term| error::require_finite(&what(term), &[term.coefficient]))
}

/// Converts a term of a library to a formula of descriptions. Every formula of descriptions is also a valid term of a
/// library.
fn basis(text: &str) -> Result<Formula> {
    parse(text, Allowed::Velocity, &BTreeMap::new()).map_err(|wrong| {
        let advice = "use a library whose terms are valid in descriptions";
        fault(text, format!("{wrong}; {advice}"))
    })
}

/// Returns the statistics of a law as lines of comments.
#[must_use]
pub fn comment_lines(result: &FrictionResult) -> String {
    let mut text = String::new();
    comments(result, &mut text);
    text
}

fn comments(result: &FrictionResult, text: &mut String) {
    let mut line = |content: String| comment(&content, text);
    let [slowest, fastest] = result.velocity_range;
    line(format!("identified from {}, {} samples", result.data, result.samples));
    line(format!(
        "velocities {} to {} {}; torque in {}",
        plain(slowest, 4),
        plain(fastest, 4),
        result.velocity_unit,
        result.unit
    ));
    result.coefficient_lines().into_iter().for_each(&mut line);
    result.summary_lines().into_iter().for_each(&mut line);
    result.settings.iter().for_each(|note| line(note.sentence()));
    result.findings.iter().for_each(|finding| line(finding.to_string()));
}

/// Adds a comment line. Control characters become blanks, so that a line break does not end the comment.
fn comment(content: &str, text: &mut String) {
    let _ = writeln!(text, "# {}", content.replace(|c: char| c.is_control(), " "));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description_toml(name: &str, extends: &str, friction: &[FrictionResult]) -> Result<String> {
        identified_toml(&Identified { name, extends, friction, ..Identified::default() })
    }
    use crate::result::tests::example;

    #[test]
    fn toml_is_read_back_unchanged() {
        let named = FrictionResult { joint: "beta \"2\"".into(), ..example() };
        let text = description_toml("arm_identified", "arm.toml", &[named, example()]).unwrap();
        let table: toml::Table = toml::from_str(&text).unwrap();
        assert_eq!(table["extends"].as_str(), Some("arm.toml"));
        let joint = &table["joints"][0];
        assert_eq!(joint["name"].as_str(), Some("beta \"2\""));
        let terms = &joint["friction"]["terms"];
        assert_eq!(terms[0][0].as_str(), Some("v"));
        assert_eq!(terms[0][1].as_float(), Some(76.5561));
        assert_eq!(terms[1][1].as_float(), Some(-3.9245));
        assert!(
            text.contains(
                "# v: 76.556 ± 0.031, 95 % interval 76.494 … 76.619, in the law with a probability of 75 %\n"
            ),
            "{text}"
        );
        assert!(text.contains("# two lines\n") && text.contains("sha256 00ff"));
    }

    #[test]
    fn friction_under_load_has_a_key_of_its_own() {
        let share = FrictionTerm {
            basis: "tanh(20*v)".into(),
            coefficient: 0.1,
            standard_error: Some(0.01),
            ..FrictionTerm::default()
        };
        let result = FrictionResult { load: vec![share], ..example() };
        let text = description_toml("a", "arm.toml", std::slice::from_ref(&result)).unwrap();
        let table: toml::Table = toml::from_str(&text).unwrap();
        let friction = &table["joints"][0]["friction"];
        assert_eq!(friction["load"][0][0].as_str(), Some("tanh(20*v)"));
        assert_eq!(friction["load"][0][1].as_float(), Some(0.1));
        assert_eq!(friction["terms"][0][0].as_str(), Some("v"));
        assert!(text.contains("# load: tanh(20*v): 0.1"), "{text}");
    }

    #[test]
    fn refused_laws_and_vanished_terms_are_not_written() {
        let text = |result: FrictionResult| description_toml("a", "arm.toml", &[result]);
        let mut refused = FrictionResult {
            findings: vec![Finding::error("poor-law", "the law explains nothing")],
            ..example()
        };
        let message = text(refused.clone()).unwrap_err().to_string();
        assert!(message.starts_with("error[poor-law]: joint beta: the law explains nothing"), "{message}");
        refused.accept();
        assert!(text(refused).unwrap().contains("# warning[poor-law]: the law explains nothing\n"));
        let FrictionLaw::Terms(mut terms) = example().law else { panic!("a law of terms") };
        terms[1].coefficient = 4e-5;
        let written = text(FrictionResult { law: FrictionLaw::Terms(terms.clone()), ..example() }).unwrap();
        assert!(written.ends_with("friction = { terms = [[\"v\", 76.5561]] }\n"), "{written}");
        terms.remove(0);
        let empty = text(FrictionResult { law: FrictionLaw::Terms(terms), ..example() }).unwrap_err();
        assert!(empty.to_string().starts_with("the friction law of beta is empty"));
    }

    #[test]
    fn only_descriptions_of_its_own_are_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let friction = [example()];
        let identified =
            Identified { name: "arm", extends: "arm.toml", friction: &friction, ..Identified::default() };
        let write = |name: &str| write_identified(&at(name), &identified);
        fs::write(at("arm.toml"), "name = \"arm\"\n").unwrap();
        fs::write(at("other.toml"), "name = \"other\"\n").unwrap();
        fs::write(at("empty.toml"), "").unwrap();
        for name in ["new.toml", "new.toml", "empty.toml"] {
            write(name).unwrap();
            let text = fs::read_to_string(at(name)).unwrap();
            assert!(toml::from_str::<toml::Table>(&text).is_ok());
        }
        let message = |name: &str| write(name).unwrap_err().to_string();
        assert!(message("arm.toml").contains("the description that the result extends"));
        assert!(message("other.toml").contains("was not written by an identification"));
        assert_eq!(fs::read_to_string(at("arm.toml")).unwrap(), "name = \"arm\"\n");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[test]
    fn a_stribeck_law_keeps_every_digit() {
        let parameters = [2.1, 1.4, 20.0 / 3.0, 0.9, 8e-17];
        let result =
            FrictionResult { law: FrictionLaw::stribeck(parameters, [None; 5], [None; 5]), ..example() };
        let text = description_toml("a", "arm.urdf", &[result]).unwrap();
        let table: toml::Table = toml::from_str(&text).unwrap();
        assert_eq!(table["urdf"].as_str(), Some("arm.urdf"));
        let law = &table["joints"][0]["friction"]["stribeck"];
        for (i, a) in parameters.iter().enumerate() {
            assert_eq!(law[crate::methods::stribeck::NAMES[i]].as_float(), Some(*a));
        }
    }

    #[test]
    fn what_a_description_cannot_hold_is_refused() {
        let with = |basis: &str, coefficient: f64| {
            let mut result = example();
            result.law = FrictionLaw::Terms(vec![FrictionTerm {
                basis: basis.into(),
                coefficient,
                ..FrictionTerm::default()
            }]);
            description_toml("a", "b.toml", &[result])
        };
        let message = |basis: &str| with(basis, 1.0).unwrap_err().to_string();
        assert!(message("ln(1 + abs(v))").contains("the function `ln` is not available in descriptions"));
        assert!(message("v*y").contains("unknown name `y`"));
        assert!(message("powi(v, 40)").contains("an exponent must be a whole number from 0 to 16"));
        assert!(message("v*(v").contains("expression `v*(v`"));
        let nan = with("v", f64::NAN).unwrap_err().to_string();
        assert!(nan.contains("the coefficient of v of joint beta is not finite (NaN)"), "{nan}");
        let spelled = with("sgn(v)*exp(-2*abs(v)) + v.powi(3)", 1.0).unwrap();
        assert!(spelled.contains("\"sign(v)*exp(-2*abs(v)) + pow(v, 3)\""), "{spelled}");
        let empty = FrictionResult { law: FrictionLaw::Terms(vec![]), ..example() };
        let text =
            |results: &[FrictionResult]| description_toml("a", "b.toml", results).unwrap_err().to_string();
        assert!(text(&[empty]).starts_with("the friction law of beta is empty"));
        assert!(text(&[]).starts_with("the list of identified joints of a is empty"));
        assert!(text(&[example(), example()]).contains("has two results"));
    }
}
