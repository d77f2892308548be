//! Converts an identification to JSON.

use std::path::{Path, PathBuf};

use gelenk_findings::{Finding, Severity, texts};
use gelenk_identification::estimation::{Gravity, Uncertain};
use gelenk_identification::identify::Identification;
use gelenk_identification::validation::JointValidation;
use serde_json::{Value, json};

use super::super::print;
use crate::identify::{front_as_json, page, terms_as_json};

fn uncertain(p: &Uncertain) -> Value {
    json!({"value": p.value, "standard_error": p.standard_error, "interval": p.interval})
}

/// Returns how the efforts of the logs include the robot's weight, as text.
fn gravity(gravity: Gravity) -> &'static str {
    match gravity {
        Gravity::Recorded => "recorded",
        Gravity::Compensated => "compensated",
        Gravity::CompensatedAsDescribed => "compensated as described",
    }
}

/// Returns the identified values and the paths of the written files as JSON.
pub(super) fn as_json(
    found: &Identification,
    findings: &[Finding],
    validation: &[JointValidation],
    output: &Path,
    files: &[PathBuf],
) -> Value {
    let joints = found.estimate.joints.iter().enumerate().map(|(index, joint)| {
        let mut joint = json!({
            "name": joint.name,
            "moves": joint.moves,
            "measured": joint.measured,
            "r_squared_held_out": joint.held_out_r_squared,
            "r_squared_with_rest": joint.held_out_with_rest,
            "rest": joint.rest,
            "r_squared": joint.r_squared,
            "residual": joint.sigma,
            "offsets": joint.offsets,
            "unit": joint.unit,
            "friction": page::law(found, index),
            "load_friction": joint.load.as_ref().map(|term| json!({
                "term": term.basis, "coefficient": uncertain(&term.coefficient),
            })),
        });
        let law = found.law(index);
        joint["friction_terms"] = law.map_or(Value::Null, terms_as_json);
        joint["friction_pareto"] = law.map_or(Value::Null, front_as_json);
        joint["friction_resolved_from"] = json!(law.and_then(|report| report.result.resolved_from));
        if let Some(constant) = found.estimate.joints[index].gain {
            joint["motor_constant"] = uncertain(&constant);
        }
        if found.joint_terms().is_some() {
            joint["is_shaft"] = json!(found.shaft(index).is_some());
        }
        joint
    });
    let parameters = found.estimate.parameters.iter();
    let files = files.iter().map(|file| file.display().to_string());
    json!({
        "description": output.display().to_string(),
        "files": files.collect::<Value>(),
        "gravity": gravity(found.estimate.gravity),
        "joints": joints.collect::<Value>(),
        "inertial_parameters": parameters.map(uncertain).collect::<Value>(),
        "validation": validation.iter().map(|joint| json!({
            "name": joint.name, "r_squared": joint.r_squared, "r_squared_with_rest": joint.r_squared_with_rest,
            "residual": joint.residual, "offset": joint.offset, "r_squared_with_offset": joint.r_squared_with_offset,
        })).collect::<Value>(),
        "mapping": found.recording.columns,
        "unused_columns": found.recording.unused,
        "findings": print::findings(findings),
        "choices": texts(&found.estimate.findings, Severity::Note),
        "warnings": texts(findings, Severity::Warning),
    })
}
