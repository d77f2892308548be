//! Messages about logs in other styles: columns, numbers, and doubtful choices.

use super::{Arm, RIGHT, Recorded, number};
use std::fs;

/// Numbers like `3.162e1`, which nobody writes. Hashes look like them.
fn has_an_exponent(text: &str) -> bool {
    let words =
        text.lines().filter(|line| !line.contains("sha256")).flat_map(|line| line.split([' ', ',', ':']));
    let is_short = |word: &str| {
        let (digits, exponent) = word.split_once('e')?;
        digits.parse::<f64>().ok()?;
        Some((-4..6).contains(&exponent.parse::<i32>().ok()?))
    };
    words.filter_map(is_short).any(|is_short| is_short)
}

#[test]
fn columns_come_first_and_numbers_are_as_people_write_them() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    let done = arm.run(&["arm.toml", "log.csv", "--output", "found.toml"]);
    let text = String::from_utf8(done.stdout).unwrap();
    let head = "note[columns]: time: `t`\nnote[columns]: positions: `q_{name}`, in rad because the header has no \
                unit\nnote[columns]: efforts, as forces at the joints: `effort_{name}`, in N*m because the header has no \
                unit\n";
    assert!(text.starts_with(head), "{text}");
    assert!(text.contains("the description has the weight ") && !has_an_exponent(&text), "{text}");
    let written = fs::read_to_string(arm.at("found.toml")).unwrap();
    let comments: Vec<&str> = written.lines().filter(|line| line.starts_with('#')).collect();
    assert!(
        comments.contains(&"# note[columns]: positions: `q_{name}`, in rad because the header has no unit"),
        "{written}"
    );
    assert!(!has_an_exponent(&comments.join("\n")), "{written}");
    // What fails says it before the error: it may be the reason.
    let log = fs::read_to_string(arm.at("log.csv")).unwrap();
    fs::write(arm.at("short.csv"), log.lines().take(9).collect::<Vec<_>>().join("\n")).unwrap();
    let said = arm.refuses(&["arm.toml", "short.csv", "--output", "refused.toml"]);
    assert!(said.contains("note[columns]: positions: `q_{name}`"), "{said}");
}

#[test]
fn commanded_columns_are_a_warning_everywhere() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", None);
    let log = fs::read_to_string(arm.at("log.csv")).unwrap();
    let header = log.lines().next().unwrap();
    let commanded = header.replace("q_", "q_target_");
    fs::write(arm.at("log.csv"), log.replacen(header, &commanded, 1)).unwrap();
    let found = arm.identify(&["log.csv", "--output", "found.toml"]);
    let warning = "warning[column-doubtful]: the columns of the positions (`q_target_{name}`) have names of commanded values";
    assert!(found["warnings"][0].as_str().unwrap().starts_with(warning), "{:#}", found["warnings"]);
    let written = fs::read_to_string(arm.at("found.toml")).unwrap();
    assert!(written.contains(&format!("# {warning}")), "{written}");
}

/// The description's constants are 0.05 throughout.
#[test]
fn described_motor_constants_that_are_wrong_are_refused() {
    let arm = Arm::new();
    arm.record("arm.toml", "log.csv", Some([0.05, 0.16, 0.05]));
    let said = arm.refuses(&["arm.toml", "log.csv", "--output", "refused.toml"]);
    let doubt =
        "error[other-factor]: joint lift: the data are explained better if its effort is multiplied by";
    assert!(said.contains(doubt), "{said}");
    assert!(said.contains("motor constant") && said.contains("'current=i1|i2["), "{said}");
}

#[test]
fn motor_constants_that_no_motor_has_are_doubted() {
    let arm = Arm::new();
    let text = fs::read_to_string(arm.at("arm.toml")).unwrap();
    fs::write(arm.at("arm.toml"), text.replace(", motor_constant = 0.05", "")).unwrap();
    let doubts = |found: &serde_json::Value| -> Vec<String> {
        let warnings = found["warnings"].as_array().unwrap().iter().filter_map(serde_json::Value::as_str);
        warnings.filter(|said| said.contains("[motor-constant-doubtful]")).map(str::to_owned).collect()
    };
    for (factor, count) in [(1.0, 0), (1e3, 3)] {
        let how = Recorded { constants: Some([0.06, 0.05, 0.04]), factors: [1.0, 1.0, factor], ..RIGHT };
        arm.record_as("arm.toml", "log.csv", how);
        let found = arm.identify(&["log.csv", "--output", "found.toml"]);
        assert!(number(&found["joints"][1]["motor_constant"]["value"]) > 0.0);
        let said = doubts(&found);
        assert_eq!(said.len(), count, "{said:?}");
        assert!(said.iter().all(|said| said.contains("--columns 'current=…[mA]'")), "{said:?}");
    }
}
