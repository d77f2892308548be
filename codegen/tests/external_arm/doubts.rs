//! Defects of a log are reported with a remedy that works.

use super::{Arm, RIGHT, Recorded};
use std::fs;

/// Rewrites the fields of each row of a log, the rows counted from zero.
fn rewrite(arm: &Arm, from: &str, to: &str, change: impl Fn(usize, &mut Vec<String>)) {
    let text = fs::read_to_string(arm.at(from)).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let rows = rows.lines().enumerate().map(|(i, row)| {
        let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
        change(i, &mut fields);
        fields.join(",")
    });
    let rows: Vec<String> = rows.collect();
    fs::write(arm.at(to), format!("{header}\n{}\n", rows.join("\n"))).unwrap();
}

fn times(field: &mut String, factor: f64) {
    *field = (factor * field.parse::<f64>().unwrap()).to_string();
}

#[test]
fn one_effort_with_another_factor_is_refused_and_its_remedy_helps() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    rewrite(&arm, "log.csv", "half.csv", |_, fields| times(&mut fields[5], 0.5));
    let said = arm.refuses(&["arm.toml", "half.csv", "--effort", "joint", "--output", "refused.toml"]);
    assert!(
        said.contains("joint lift: its fit is refused") && said.contains("its effort is multiplied by 2"),
        "{said}"
    );
    let columns = "torque=effort_turn|effort_lift[2 Nm]|effort_reach";
    let done = arm.run(&["arm.toml", "half.csv", "--columns", columns, "--output", "found.toml"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn lost_bits_of_an_effort_are_left_out_and_said() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    rewrite(&arm, "log.csv", "spike.csv", |row, fields| {
        if row == 700 {
            fields[5] = "-999999".into();
        }
    });
    let done = arm.run(&["arm.toml", "spike.csv", "--effort", "joint", "--output", "found.toml"]);
    let text = String::from_utf8(done.stdout).unwrap();
    let said = "row 702: column `effort_lift` has 1 effort far beyond all others, -999999. It is left out";
    assert!(done.status.success() && text.contains(said), "{text}");
}

/// A channel that holds something else than the joint's effort: the other joints have their laws.
#[test]
fn a_joint_that_nothing_explains_keeps_its_description() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    rewrite(&arm, "log.csv", "dead.csv", |row, fields| {
        fields[6] = (((row * 7919) % 613) as f64 / 100.0).to_string();
    });
    let whole = arm.identify(&["log.csv", "--effort", "joint", "--output", "whole.toml"]);
    let found = arm.identify(&["dead.csv", "--effort", "joint", "--output", "found.toml"]);
    let codes: Vec<&str> =
        found["findings"].as_array().unwrap().iter().filter_map(|finding| finding["code"].as_str()).collect();
    assert!(codes.contains(&"joint-left-out"), "{codes:?}");
    assert_eq!(found["joints"][2]["friction"], "–");
    for joint in 0..2 {
        let [with, without] = [&whole, &found].map(|found| {
            let law = found["joints"][joint]["friction"].as_str().unwrap();
            law.split('*').next().unwrap().parse::<f64>().unwrap()
        });
        assert!((without / with - 1.0).abs() < 0.1, "{with} {without}");
    }
    let text = fs::read_to_string(arm.at("found.toml")).unwrap();
    let reach = text.split("[[joints]]").find(|table| table.contains("name = \"reach\""));
    assert!(reach.is_none_or(|table| !table.contains("friction")), "{text}");
}

/// R² of a law that was asked for, and not of the terms that explain the data.
#[test]
fn numbers_are_those_of_the_law_that_is_written() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    let all = arm.identify(&["log.csv", "--output", "all.toml"]);
    let viscous = arm.identify(&["log.csv", "--friction", "viscous", "--output", "viscous.toml"]);
    for joint in 0..3 {
        let of = |found: &serde_json::Value, key: &str| found["joints"][joint][key].as_f64().unwrap();
        for key in ["r_squared_held_out", "r_squared"] {
            assert!(of(&viscous, key) < of(&all, key) - 0.01, "{key} of joint {joint}: {viscous:#}");
        }
    }
    let findings = viscous["findings"].as_array().unwrap();
    let few: Vec<&str> = findings
        .iter()
        .filter(|finding| finding["code"] == "too-few-terms")
        .map(|few| few["message"].as_str().unwrap())
        .collect();
    let joint = &viscous["joints"][0];
    let shown =
        format!("R² on held-out data is {:.3} instead of ", joint["r_squared_held_out"].as_f64().unwrap());
    assert!(few.iter().any(|few| few.contains(shown.trim_end_matches('0'))), "{shown}: {few:?}");
    assert!(!all["warnings"].to_string().contains("[too-few-terms]"), "{:#}", all["warnings"]);
}

#[test]
fn a_log_that_was_fitted_validates_nothing() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    fs::copy(arm.at("log.csv"), arm.at("copy.csv")).unwrap();
    let arguments =
        ["arm.toml", "log.csv", "--effort", "joint", "--validate", "copy.csv", "--output", "found.toml"];
    let done = arm.run(&arguments);
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(
        said.contains("[fitted-log]") && said.contains("copy.csv: it is one of the fitted logs"),
        "{said}"
    );
}

/// Efforts with the other sign.
#[test]
fn a_log_that_is_not_predicted_is_named() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    arm.record_as("arm.toml", "other.csv", Recorded { factors: [1.0, 1.0, -1.0], ..RIGHT });
    let validated = |log: &str| {
        let done = arm.run(&["arm.toml", "log.csv", "--validate", log, "--output", "found.toml"]);
        assert!(done.status.success());
        String::from_utf8(done.stderr).unwrap()
    };
    let said = validated("other.csv");
    for joint in ["turn", "lift", "reach"] {
        let warning = format!(
            "in the logs to validate, warning[validation-failed]: joint {joint}: the efforts are farther from the prediction"
        );
        assert!(said.contains(&warning), "{said}");
    }
    assert!(!validated("log.csv").contains("validation-failed"));
}

#[test]
fn currents_may_be_called_efforts() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", Some([0.05; 3]));
    let text = fs::read_to_string(arm.at("log.csv")).unwrap().replace("current_", "effort_");
    fs::write(arm.at("log.csv"), text).unwrap();
    let done = arm.run(&["arm.toml", "log.csv", "--effort", "current", "--output", "found.toml"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn a_counter_of_samples_is_no_time() {
    let arm = Arm::new();
    arm.record_as("arm.toml", "log.csv", Recorded { factors: [100.0, 1.0, 1.0], ..RIGHT });
    rewrite(&arm, "log.csv", "counted.csv", |row, fields| fields[0] = row.to_string());
    let arguments = |unit| {
        let columns = format!("time=t[{unit}]");
        arm.run(&[
            "arm.toml",
            "counted.csv",
            "--effort",
            "joint",
            "--accept-poor",
            "--columns",
            &columns,
            "--output",
            "found.toml",
        ])
    };
    let said = |done: std::process::Output| {
        format!("{}{}", String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr))
    };
    assert!(said(arguments("s")).contains("all time steps are exactly 1 s"));
    assert!(!said(arguments("10 ms")).contains("all time steps are exactly 1 s"));
}
