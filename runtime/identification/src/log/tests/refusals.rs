//! Logs that cannot be read. Each message names the fault and the option that solves it.

use super::super::{ColumnOptions, runs_of};
use super::testing::{Fake, message};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;

const ROWS: &str = "0,1,2,3,4\n0.1,1,2,3,4\n0.2,1,2,3,4\n";

/// Text of a log, the user's option for its columns, and a part of the message.
#[rustfmt::skip]
fn cases() -> Vec<(String, &'static str, &'static str)> {
    let under = |header: &str| format!("{header}\n{ROWS}");
    vec![
        (ROWS.into(), "", "the log has no header. Its first row is `0, 1, 2, 3, 4`. Name the columns by their numbers, as \
                           in --columns 'time=1,position=2..3,torque=4..5'"),
        (ROWS.into(), "time=t,position=2..3,torque=4..5", "the log has no header: give the numbers of the columns"),
        (ROWS.into(), "time=1,position=2..9,torque=4..5", "the log has columns 1 to 5"),
        (ROWS.into(), "time=1,position=2..4,torque=4..5", "the pattern names 3 columns, but 2 are needed"),
        (ROWS.into(), "time=1,position=2..3,torque=3..4", "column number 3 fits two quantities"),
        (under("t,q1,q2,x1,x2"), "", "the log has no columns with a usual name for the efforts of joint_1, joint_2. The \
                                      columns are: t, q1, q2, x1, x2. Name the right ones with --columns 'torque=…'"),
        (under("t,q1,q3,u1,u2"), "", "the log has no column for the position of `joint_2`"),
        (under("t,q1,q2,u1,q3"), "", "have 3 numbers (1 to 3), but the robot needs only 2."),
        (under("x,q1,q2,u1,u2"), "", "the log has no column with a usual name for the time"),
        (under("time_one,q1,q2,u1,time_two"), "", "both `time_one` and `time_two` (columns 1 and 5) could be the time"),
        (under("t,left_q1,left_q2,right_q1,right_q2"), "torque=4|5", "both `left_q{}` and `right_q{}` could be the positions: use \
                                                                      --columns 'position=left_q{}' or 'position=right_q{}'"),
        (under("t,joint1_position,joint2_position,u1,u2"), "position=joint{}_pos", "no column has this name. The most similar \
                                                                                    name is `joint1_position`. The columns are t, \
                                                                                    joint1_position"),
        (under("t,q1,q2,u1,u2"), "position=q{}[grad]", "the unit `grad` is unknown. The known units are s, ms"),
        (under("t,q1 [Grad],q2 [Grad],u1,u2"), "", "`q1 [Grad]` is in `Grad`, which is a degree in German, but a gon"),
        (under("t,q1_grad,q2_grad,u1,u2"), "", "Use --columns 'position=…[deg]' or 'position=…[gon]'"),
        (under("t,q1,q2,u1,u2"), "position=q{}[Nm]", "column `q1` is a position in N*m, but rad is expected here"),
        (under("t,q1,q2,u1,u2"), "positon=q{}", "there is no quantity `positon`. The quantities are time, position"),
        (under("t,q1,q2,u1,u2"), "q{}", "this part does not have the form `QUANTITY=COLUMNS`"),
        (under("t,q1,q2,u1,u2"), "torque=u{},current=u{}", "this quantity is named twice"),
        (under("t,q1,q2,u1,u2"), "position={name}_pos", "no column has this name"),
        (under("t,q1 [counts],q2 [counts],u1,u2"), "", "column `q1 [counts]` is in `counts`, which is not a known unit"),
        (under("t,joint_0_pos,joint_1_pos,joint_2_pos,u1"), "", "have 3 numbers (0 to 2), but the robot needs only 2."),
        (under("t,q1_count,q2_count,u1,u2"), "", "column `q1_count` is a position in count, but rad is expected here"),
        (under("t,q1,q2,u1"), "", "the header has 4 names (t, q1, q2, u1), but row 2 has 5 fields"),
        ("t,q1,q2,u1,u2\n".into(), "", "the file has no rows of numbers. It begins with `t,q1,q2,u1,u2`"),
        ("t,q1,q2,u1,u2\n12:00:01,1,2,3,4\n12:00:02,1,2,3,4\n".into(), "", "none of the 2 rows has a number in the column of \
                                                                            times. The first field is `12:00:01`"),
        ("t,q1,q2,u1,u2\n0,1,2,NaN,NaN\n1,1,2,NaN,NaN\n".into(), "", "column `u1` has no finite number"),
        ("t,q1,q2,u1,u2\n0,1,NaN,3,4\n1,1,NaN,3,4\n".into(), "", "column `q2` has no finite number"),
        ("t,q1,q2,u1,u2\n0,1,,3,4\n1,,2,,4\n2,1,,,4\n".into(), "", "only 0 of 3 rows have the time, all 2 positions and the \
                                                                    efforts"),
        (thousands(), "", "28 of 30 rows cannot be used: column `t [ms]` has no number in 28 of these rows. The first field \
                           is `1.000`"),
    ]
}

/// Times in ms with a point between thousands, together with decimal commas.
fn thousands() -> String {
    let row = |i: usize| format!("{}.{:03};0,5;0,{i};0,1;0,{i}\n", i / 2, 500 * (i % 2));
    let rows: String = (2..30).map(row).collect();
    format!("t [ms];q1;q2;u1;u2\n0;0,5;0,1;0,1;0,2\n500;0,5;0,2;0,1;0,2\n{rows}")
}

#[test]
fn what_cannot_be_read_is_explained() {
    for (text, columns, part) in cases() {
        let said = message(&text, columns);
        assert!(said.contains(part), "{text}\n{columns}\n{said}");
        assert!(said.starts_with("error[unusable-input]: "), "{said}");
    }
}

/// A joint may have the name of a unit.
#[test]
fn names_of_joints_are_no_units() {
    let robot = Fake::new(&["turn", "m"]);
    let text = format!("t,q_turn,q_m,tau_turn,tau_m\n{ROWS}");
    let found = runs_of(text.as_bytes(), "log", &robot, &ColumnOptions::default()).unwrap();
    assert_eq!(found.runs[0].efforts[0], [3.0; 3]);
    // A unit follows the name of the joint.
    let text = text.replace("q_turn", "q_turn_deg");
    let found = runs_of(text.as_bytes(), "log", &robot, &ColumnOptions::default()).unwrap();
    assert!((found.runs[0].positions[0][0] - 1.0_f64.to_radians()).abs() < 1e-15);
}

#[test]
fn currents_of_a_robot_without_drives_are_refused() {
    let robot = Fake { inputs: Vec::new(), ..Fake::numbered(2) };
    let text = format!("t,q1,q2,i1,i2\n{ROWS}");
    let effort = Some(super::super::super::run::Effort::Current);
    let said = runs_of(text.as_bytes(), "log", &robot, &ColumnOptions { effort, ..ColumnOptions::default() });
    let said = said.unwrap_err().to_string();
    assert!(said.contains("the description has no") && said.contains("--effort joint"), "{said}");
}

/// Without a limit, a quotation mark in a text would include the rest of the log.
#[test]
fn open_quotation_marks_are_named() {
    let rows: Vec<String> =
        (0..200).map(|i| format!("{i},1,2,3,4,{}", if i == 60 { "\"" } else { "ok" })).collect();
    let said = message(&format!("t,q1,q2,u1,u2,mode\n{}\n", rows.join("\n")), "");
    assert!(said.contains("row 62 has a quotation mark that is not closed"), "{said}");
}

#[test]
fn files_of_other_kinds_are_named() {
    let cases: [(&[u8], &str); 4] = [
        (b"\x1f\x8b\x08\0", "the file begins as a gzip file, but cannot be decompressed"),
        (b"PK\x03\x04", "zip"),
        (b"\xff\xfet\0", "UTF-16"),
        (b" \n", "the file is empty"),
    ];
    for (bytes, part) in cases {
        let said = runs_of(bytes, "log", &Fake::numbered(2), &ColumnOptions::default());
        let said = said.unwrap_err().to_string();
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn packed_logs_are_read() {
    let text = format!("t,q1,q2,u1,u2\n{ROWS}");
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).unwrap();
    let [plain, packed] = [text.into_bytes(), packed.finish().unwrap()]
        .map(|bytes| runs_of(&bytes, "log", &Fake::numbered(2), &ColumnOptions::default()).unwrap().runs);
    assert_eq!(plain, packed);
}

/// Findings about one log are kept after an error in the next log.
#[test]
fn findings_survive_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["first.csv", "second.csv"].map(|name| folder.path().join(name));
    std::fs::write(&paths[0], format!("t,q1,q2,u1,u2\n0,1,2,3,4\n{ROWS}")).unwrap();
    std::fs::write(&paths[1], format!("t,q1,q2,x1,x2\n{ROWS}")).unwrap();
    let mut findings = Vec::new();
    let options = ColumnOptions::default();
    let error = super::super::runs_noting(&paths, &Fake::numbered(2), &options, &mut findings).unwrap_err();
    assert!(
        error.to_string().contains("the log has no columns with a usual name for the efforts"),
        "{error}"
    );
    let said: Vec<String> = findings.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|said| said.contains("has the same time as the sample before")), "{said:?}");
}
