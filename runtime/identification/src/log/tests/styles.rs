//! Styles of logs: one motion, written as different programs write it.

use super::super::super::doubts::limits::beyond;
use super::super::super::preparation::{PreparationSettings, prepare_all};
use super::super::super::robot::FollowerLimits;
use super::super::super::run::Effort;
use super::super::{ColumnOptions, Recording, runs_of};
use super::testing::{Fake, message};
use gelenk_findings::Finding;
use std::fmt::Write;

/// Returns position, velocity and effort of two joints, sampled at 100 Hz.
fn motion(i: usize) -> (f64, [[f64; 3]; 2]) {
    let t = 0.01 * i as f64;
    let joint = |a: f64, w: f64| [a * (w * t).sin(), a * w * (w * t).cos(), 3.0 * (w * t).cos() + 0.5 * a];
    (t, [joint(1.0, 2.0), joint(0.7, 3.0)])
}

/// Returns a log of `count` rows below `header`. Each row is written by `row(t, joints)`.
fn written(header: &str, count: usize, row: impl Fn(f64, [[f64; 3]; 2]) -> String) -> String {
    let mut text = format!("{header}\n");
    for i in 0..count {
        let (t, joints) = motion(i);
        writeln!(text, "{}", row(t, joints)).unwrap();
    }
    text
}

fn read(text: &str, options: &ColumnOptions) -> Recording {
    runs_of(text.as_bytes(), "log.csv", &Fake::numbered(2), options)
        .unwrap_or_else(|e| panic!("{e}\n{}", &text[..text.len().min(300)]))
}

/// Asserts that the recording contains the motion, with the accuracy of the log.
fn assert_motion(style: &str, recording: &Recording, count: usize) {
    let run = &recording.runs[0];
    assert_eq!(run.times.len(), count, "{style}: {:?}", recording.findings);
    for i in 0..count {
        let (t, joints) = motion(i);
        assert!((run.times[i] - t).abs() < 1e-9, "{style}: time {} of {t}", run.times[i]);
        for (joint, [q, v, e]) in joints.iter().enumerate() {
            assert!((run.positions[joint][i] - q).abs() < 1e-5, "{style}: position");
            assert!(
                (run.efforts[joint][i] - e).abs() < 1e-4,
                "{style}: effort {} {e}",
                run.efforts[joint][i]
            );
            if let Some(velocity) = &run.velocities[joint] {
                assert!((velocity[i] - v).abs() < 1e-4, "{style}: velocity");
            }
        }
    }
}

type Row = fn(f64, [[f64; 3]; 2]) -> String;

const DEG: f64 = 180.0 / std::f64::consts::PI;

/// Styles: name, header, row, options of the user, kind of the efforts, and whether velocities are found.
#[rustfmt::skip]
fn styles() -> Vec<(&'static str, &'static str, Row, &'static str, Effort, bool)> {
    use Effort::{Current, Joint};
    vec![
        ("plain", "t,q1,q2,dq1,dq2,tau1,tau2", |t, [a, b]| format!("{t},{},{},{},{},{},{}", a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("underscores", "timestamp,joint1_position,joint2_position,joint1_effort,joint2_effort", |t, [a, b]| format!("{t},{},{},{},{}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("plotjuggler", "__time,/joint_states/joint_2/effort,/joint_states/joint_1/effort,/joint_states/joint_1/position,/joint_states/joint_2/position,/joint_states/header/stamp", |t, [a, b]| format!("{},{},{},{},{},{:.6}", t + 0.3 * (t * 7e3).sin().abs(), b[2], a[2], a[0], b[0], 1.7e9 + t), "", Joint, false),
        ("rostopic", "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.name0,field.name1,field.position0,field.position1,field.velocity0,field.velocity1,field.effort0,field.effort1", |t, [a, b]| {
            let ns = 1_700_000_000_000_000_000_u64 + (t * 1e9).round() as u64;
            format!("{},{},{ns},base,joint_2,joint_1,{},{},{},{},{},{}", ns + 123_456, (t * 100.0).round(), b[0], a[0], b[1], a[1], b[2], a[2])
        }, "", Joint, true),
        ("bagpy", "Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,name,position_0,position_1,effort_0,effort_1", |t, [a, b]| {
            let ns = 1_700_000_000_123_456_789_u64 + (t * 1e9).round() as u64;
            format!("{},1,{},{},,\"['joint_2', 'joint_1']\",{},{},{},{}", 1.7e9 + 1.1 * t, ns / 1_000_000_000, ns % 1_000_000_000, b[0], a[0], b[2], a[2])
        }, "", Joint, false),
        ("rtde", "timestamp target_q_0 target_q_1 actual_q_0 actual_q_1 actual_qd_0 actual_qd_1 actual_current_0 actual_current_1 \
                  actual_TCP_pose_0 actual_TCP_pose_1", |t, [a, b]| format!("{} 0 1 {} {} {} {} {} {} 5 6", 8123.5 + t - 8123.5, a[0], b[0], a[1], b[1], a[2], b[2]), "", Current, true),
        ("franka", "time \
                    [ms],q[0],q[1],q_d[0],q_d[1],dq[0],dq[1],tau_J[0],tau_J[1],tau_J_d[0],tau_J_d[1],dtau_J[0],dtau_J[1],tau_ext_hat_filtered[0],tau_ext_hat_filtered[1]", |t, [a, b]| format!("{},{},{},9,9,{},{},{},{},9,9,9,9,9,9", (t * 1000.0).round(), a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("libfranka", "time, success_rate, state.q[0], state.q[1],state.q_d[0], state.q_d[1],state.dq[0], \
                       state.dq[1],state.dq_d[0], state.dq_d[1],state.tau_J[0], state.tau_J[1],state.tau_ext_hat_filtered[0], \
                       state.tau_ext_hat_filtered[1],cmd.q_d[0], cmd.q_d[1],cmd.dq_d[0], cmd.dq_d[1],cmd.O_T_EE_d[0], \
                       cmd.O_T_EE_d[1],cmd.tau_J_d[0], cmd.tau_J_d[1]", |t, [a, b]| format!("{},1,{},{},9,9,{},{},9,9,{},{},9,9,9,9,9,9,9,9,9,9", (t * 1000.0).round(), a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("german excel", "Zeit;Time (s);Position 1 [deg];Position 2 [deg];Torque 1 (Nm);Torque 2 (Nm);", |t, [a, b]| format!("x;{t};{};{};{};{};", a[0] * DEG, b[0] * DEG, a[2], b[2]).replace('.', ","), "", Joint, false),
        ("german", "Zeit [s];Winkel 1 [Grad];Winkel 2 [Grad];Geschwindigkeit 1 [Grad/s];Geschwindigkeit 2 [Grad/s];Drehmoment 1 \
                    [Nm];Drehmoment 2 [Nm];Motorspannung 1 [V];Motorspannung 2 [V]", |t, [a, b]| format!("{t};{};{};{};{};{};{};24;24", a[0] * DEG, b[0] * DEG, a[1] * DEG, b[1] * DEG, a[2], b[2]).replace('.', ","), "", Joint, true),
        ("german drive", "Zeitstempel;Lageistwert Achse 1;Lageistwert Achse 2;Lagesollwert Achse 1;Lagesollwert Achse 2;Iststrom \
                          Achse 1 [mA];Iststrom Achse 2 [mA];Schleppfehler Achse 1;Schleppfehler Achse 2", |t, [a, b]| format!("{t};{};{};9;9;{};{};0;0", a[0], b[0], a[2] * 1e3, b[2] * 1e3).replace('.', ","), "", Current, false),
        ("french", "temps (s);position_articulaire_1;position_articulaire_2;vitesse_articulaire_1;vitesse_articulaire_2;couple_1;couple_2", |t, [a, b]| format!("{t};{};{};{};{};{};{}", a[0], b[0], a[1], b[1], a[2], b[2]).replace('.', ","), "", Joint, true),
        ("italian", "tempo;posizione giunto 1;posizione giunto 2;velocità giunto 1;velocità giunto 2;coppia giunto 1;coppia giunto 2", |t, [a, b]| format!("{t};{};{};{};{};{};{}", a[0], b[0], a[1], b[1], a[2], b[2]).replace('.', ","), "", Joint, true),
        ("spanish", "Tiempo,Ángulo articulación 1 (°),Ángulo articulación 2 (°),Velocidad 1,Velocidad 2,Par 1,Par 2", |t, [a, b]| format!("{t},{},{},{},{},{},{}", a[0] * DEG, b[0] * DEG, a[1], b[1], a[2], b[2]), "", Joint, true),
        ("matlab", "Time (s)\tq(1)\tq(2)\tu(1)\tu(2)", |t, [a, b]| format!("{t}\t{}\t{}\t{}\t{}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("savetxt", "# a robot\n# t q_0 q_1 tau_0 tau_1", |t, [a, b]| format!("{t:.18e} {:.18e} {:.18e} {:.18e} {:.18e}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("row of units", "\u{feff}\"t\",\"pos_1\",\"pos_2\",\"vel_1\",\"vel_2\",\"eff_1\",\"eff_2\"\ns,deg,deg,deg/s,deg/s,Nm,mNm", |t, [a, b]| format!("{t},{},{},{},{},{},{}\r", a[0] * DEG, b[0] * DEG, a[1] * DEG, b[1] * DEG, a[2], b[2] * 1e3), "", Joint, true),
        ("suffixes", "t_ms,q1_deg,q2_deg,dq1_deg_s,dq2_deg_s,cur_1_ma,cur_2_ma", |t, [a, b]| format!("{},{},{},{},{},{},{}", t * 1e3, a[0] * DEG, b[0] * DEG, a[1] * DEG, b[1] * DEG, a[2] * 1e3, b[2] * 1e3), "", Current, true),
        ("preamble", "Recorder 3.1\nDate,2024-03-01\n\nSample rate,100\nTime,J1 ActPos,J2 ActPos,J1 ActTorque,J2 ActTorque", |t, [a, b]| format!("{t}, \
                                                                                                                                                  {}, \
                                                                                                                                                  {}, \
                                                                                                                                                  {}, \
                                                                                                                                                  {}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("index column", ",t,q1,q2,u1,u2", |t, [a, b]| format!("{},{t},{},{},{},{}", (t * 100.0).round(), a[0], b[0], a[2], b[2]), "", Joint, false),
        ("loop", "time,q_joint_1,q_joint_2,dq_joint_1,dq_joint_2,desired_joint_1,desired_joint_2,u_joint_1,u_joint_2,source,believed,iterations,lateness_ns,read_ns,control_ns,check_ns,write_ns", |t, [a, b]| format!("{t},{},{},{},{},0,0,{},{},controller,1,3,100,1,2,3,4", a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("blanks and dots", "Sample;robot.Joint 1.Actual Position (rad);robot.Joint 2.Actual Position (rad);robot.Joint 1.Motor \
                             Torque (Nm);robot.Joint 2.Motor Torque (Nm);elapsed time (us)", |t, [a, b]| format!("1;{};{};{};{};{}", a[0], b[0], a[2], b[2], (t * 1e6).round()), "", Joint, false),
        ("savetxt with commas", "# t,q_0,q_1,tau_0,tau_1", |t, [a, b]| format!("{t:.18e} {:.18e} {:.18e} {:.18e} {:.18e}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("mujoco", "time,qpos_0,qpos_1,qvel_0,qvel_1,ctrl_0,ctrl_1,qfrc_actuator_0,qfrc_actuator_1", |t, [a, b]| format!("{t},{},{},{},{},0,0,{},{}", a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("unitree", "stamp_us,motor_state[0].q,motor_state[1].q,motor_state[0].dq,motor_state[1].dq,motor_state[0].tauEst,motor_state[1].tauEst", |t, [a, b]| format!("{},{},{},{},{},{},{}", (t * 1e6).round(), a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("dynamixel", "time,present_position_1,present_position_2,goal_position_1,goal_position_2,present_current_1 \
                       [mA],present_current_2 [mA]", |t, [a, b]| format!("{t},{},{},9,9,{},{}", a[0], b[0], a[2] * 1e3, b[2] * 1e3), "", Current, false),
        ("dots and derivatives", "t,theta1,theta2,theta1_dot,theta2_dot,theta1_ddot,theta2_ddot,tau1,tau2", |t, [a, b]| format!("{t},{},{},{},{},0,0,{},{}", a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("voltages beside", "t,q1,q2,u1 [Nm],u2 [Nm],v1 [V],v2 [V]", |t, [a, b]| format!("{t},{},{},{},{},24,24", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("a time before each signal", "Time,Pos1,Time,Pos2,Time,Torque1,Time,Torque2", |t, [a, b]| format!("{t},{},{t},{},{t},{},{t},{}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("old line ends", "t,q1,q2,u1,u2", |t, [a, b]| format!("{t},{},{},{},{}\r", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("units alone", "Time;A1 [deg];A2 [deg];A1 [Nm];A2 [Nm]", |t, [a, b]| format!("{t};{};{};{};{}", a[0] * DEG, b[0] * DEG, a[2], b[2]), "", Joint, false),
        ("quoted decimals", "t,q1,q2,u1,u2", |t, [a, b]| [t, a[0], b[0], a[2], b[2]].map(|x| format!("\"{x}\"").replace('.', ",")).join(","), "", Joint, false),
        ("from zero with a gripper told", "t,joint_0_pos,joint_1_pos,joint_2_pos,joint_0_eff,joint_1_eff,joint_2_eff", |t, [a, b]| format!("{t},{},{},0,{},{},0", a[0], b[0], a[2], b[2]), "position=joint_{}_pos,torque=joint_{}_eff", Joint, false),
        ("told", "a,b,c,d,e", |t, [a, b]| format!("{},{},{t},{},{}", a[0] * DEG, b[0] * DEG, a[2], b[2]), "position=a|b[deg],torque=4..5,time=c", Joint, false),
        ("told by numbers", "", |t, [a, b]| format!("{t},{},{},{},{}", a[0], b[0], a[2], b[2]), "time=1, position=2..3, current=4..5", Current, false),
        ("told by pattern", "clock,enc_0_raw,enc_1_raw,enc_2_raw,x0,x1", |t, [a, b]| format!("{t},{},{},0,{},{}", a[0] * DEG / 0.1, b[0] * DEG / 0.1, a[2], b[2]), "position=ENC_{}_raw[0.1 \
                                                                                                                                                                    deg],effort=x{}", Joint, false),
    ]
}

/// Returns the text of a log and the options of the user.
fn log_of_style(style: &str, header: &str, row: Row, columns: &str, count: usize) -> (String, ColumnOptions) {
    let text = written(header, count, row);
    let text = if style == "old line ends" { text.replace("\r\n", "\r").replace('\n', "\r") } else { text };
    let columns = Some(columns.to_owned()).filter(|c| !c.is_empty());
    (text.trim_start_matches('\n').to_owned(), ColumnOptions { columns, ..ColumnOptions::default() })
}

/// Returns a short log of each style.
pub(super) fn logs() -> Vec<(&'static str, Vec<u8>, ColumnOptions)> {
    let styles = styles().into_iter().map(|(style, header, row, columns, ..)| {
        let (text, options) = log_of_style(style, header, row, columns, 20);
        (style, text.into_bytes(), options)
    });
    styles.collect()
}

#[test]
fn logs_of_each_style_are_read() {
    for (style, header, row, columns, effort, has_velocity) in styles() {
        let (text, options) = log_of_style(style, header, row, columns, 200);
        let recording = read(&text, &options);
        assert_motion(style, &recording, 200);
        assert_eq!(recording.effort, effort, "{style}");
        assert_eq!(
            recording.runs[0].velocities[0].is_some(),
            has_velocity,
            "{style}: {:?}",
            recording.columns
        );
        let suspicious = recording.findings.iter().filter(|f| f.code != "unit-assumed");
        assert_eq!(suspicious.map(ToString::to_string).collect::<Vec<_>>(), Vec::<String>::new(), "{style}");
    }
}

/// Printed columns of each style.
#[test]
fn columns_of_each_style_are_named() {
    let said = styles().into_iter().map(|(style, header, row, columns, ..)| {
        let columns = Some(columns.to_owned()).filter(|c| !c.is_empty());
        let text = written(header, 20, row);
        let options = ColumnOptions { columns, ..ColumnOptions::default() };
        let recording = read(text.trim_start_matches('\n'), &options);
        let findings = recording.findings.iter().map(ToString::to_string);
        let columns = recording.columns_found();
        let lines: Vec<String> = columns.iter().map(ToString::to_string).chain(findings).collect();
        format!("== {style}\n{}\n", lines.join("\n"))
    });
    insta::assert_snapshot!("styles", said.collect::<String>());
}

/// An Excel table from western Europe, whose letters are not UTF-8.
#[test]
fn letters_of_windows_are_read() {
    let (_, header, row, ..) = styles().into_iter().find(|style| style.0 == "italian").unwrap();
    let text: Vec<u8> =
        written(header, 20, row).chars().map(|letter| u8::try_from(letter).unwrap()).collect();
    let recording = runs_of(&text, "log.csv", &Fake::numbered(2), &ColumnOptions::default()).unwrap();
    assert_motion("Windows", &recording, 20);
    assert!(recording.runs[0].velocities[0].is_some(), "{:?}", recording.columns);
}

/// Returns a log of two joints with the given times and run labels. Its values differ from sample to sample.
fn log_of(rows: &[(&str, &str)]) -> String {
    let mut text = String::from("time,trial,q1,q2,tau1,tau2\n");
    for (i, (time, trial)) in rows.iter().enumerate() {
        writeln!(text, "{time},{trial},{i},0.{i},{i},{i}").unwrap();
    }
    text
}

#[test]
fn times_cut_runs() {
    let rows = [
        ("0", "a"),
        ("0.01", "a"),
        ("0.01", "a"),
        ("0.02", "a"),
        ("0", "b"),
        ("0.01", "b"),
        ("0.005", "b"),
        ("0.02", "b"),
        ("9", "c"),
    ];
    let recording = read(&log_of(&rows), &ColumnOptions::default());
    let runs: Vec<(&str, &[f64], &[usize])> =
        recording.runs.iter().map(|r| (r.name.as_str(), r.times.as_slice(), r.rows.as_slice())).collect();
    assert_eq!(
        runs,
        [
            ("log.csv, run a", &[0.0, 0.01, 0.02][..], &[2, 3, 5][..]),
            ("log.csv, run b, part 1", &[0.0, 0.01], &[6, 7]),
            ("log.csv, run b, part 2", &[0.005, 0.02], &[8, 9]),
        ]
    );
    let said: Vec<String> = recording.findings.iter().take(3).map(Finding::sentence).collect();
    assert_eq!(said[0], "log.csv, row 4: 1 sample has the same time as the sample before and is left out");
    assert_eq!(said[1], "log.csv, row 8: the time goes back once, and a new run begins at this row");
    assert_eq!(said[2], "log.csv: 1 run with a single sample is left out");
    assert!(recording.findings.iter().take(3).map(|f| f.code).eq([
        "repeated-times",
        "time-goes-back",
        "rows-left-out"
    ]));
}

/// Jitter below a microsecond in times since 1970, which a double cannot represent.
#[test]
fn epoch_times_keep_their_digits() {
    let rows = [("1700000000000000001", ""), ("1700000000008000003", ""), ("1700000000016000000", "")];
    let recording = read(&log_of(&rows).replace("time,", "stamp_ns,"), &ColumnOptions::default());
    assert_eq!(recording.runs[0].times, [0.0, 0.008_000_002, 0.015_999_999]);
    let rows = [("1700000000.000000001", ""), ("1700000000.004", ""), ("1700000000.008", "")];
    let recording = read(&log_of(&rows), &ColumnOptions::default());
    assert_eq!(recording.runs[0].times, [0.0, 0.003_999_999, 0.007_999_999]);
    // Without a unit, the time step decides, and there is a finding.
    for (step, said) in [(4_u64, "ms (rate 250"), (4000, "µs (rate 250"), (4_000_000, "ns (rate 250")] {
        let times: Vec<String> = (0..4).map(|i| (i * step).to_string()).collect();
        let rows: Vec<(&str, &str)> = times.iter().map(|t| (t.as_str(), "")).collect();
        let recording = read(&log_of(&rows), &ColumnOptions::default());
        assert_eq!(recording.runs[0].times, [0.0, 0.004, 0.008, 0.012]);
        let finding = recording.findings.iter().find(|f| f.code == "unit-assumed").unwrap();
        assert!(finding.message.contains(said), "{finding}");
    }
}

#[test]
fn incomplete_rows_are_left_out_by_number() {
    let text = "# made by hand\n\nt,q1,q2,u1,u2\n0,1,1,1,1\n1,1,,1,1\n2,1,1,x,1\n3,1,1,1\n# stop\n4,2,2,2,2\n\n5,3,3,3,3\n";
    let recording = read(text, &ColumnOptions::default());
    assert_eq!(recording.runs[0].rows, [4, 9, 11]);
    let said: Vec<String> = recording.findings.iter().map(Finding::sentence).collect();
    assert_eq!(
        said[..4],
        [
            "log.csv, row 5: column `q2` has no finite number in 1 row",
            "log.csv, row 6: column `u1` has no finite number in 1 row: `x`",
            "log.csv, row 7: column `u2` has no finite number in 1 row, which ends before the column",
            "log.csv: 3 incomplete rows are left out",
        ]
    );
    let codes: Vec<&str> = recording.findings.iter().map(|f| f.code).take(3).collect();
    assert_eq!(codes, ["missing-values", "not-a-number", "missing-values"]);
}

/// Returns the findings about an ordinary log after a change of its rows.
fn found(
    robot: &Fake,
    columns: &str,
    change: impl Fn(usize, &mut [[f64; 3]; 2]),
) -> Vec<(&'static str, String)> {
    let mut text = String::from("t,q1,q2,dq1,dq2,u1,u2\n");
    for i in 0..400 {
        let (t, mut joints) = motion(i);
        change(i, &mut joints);
        let [a, b] = joints;
        writeln!(text, "{t},{},{},{},{},{},{}", a[0], b[0], a[1], b[1], a[2], b[2]).unwrap();
    }
    let columns = Some(columns.to_owned()).filter(|c| !c.is_empty());
    let options = ColumnOptions { columns, ..ColumnOptions::default() };
    let recording = runs_of(text.as_bytes(), "log.csv", robot, &options).unwrap();
    let (prepared, _) = prepare_all(&recording.runs, None, &PreparationSettings::default()).unwrap();
    let beyond = beyond(robot, &recording, &prepared);
    recording.findings.iter().chain(&beyond).map(|f| (f.code, f.to_string())).collect()
}

#[test]
fn joints_that_look_wrong_are_named() {
    let robot = Fake::numbered(2);
    assert_eq!(found(&robot, "", |_, _| {}), []);
    type Change = fn(usize, &mut [[f64; 3]; 2]);
    let cases: [(&str, Change, &[&str], &str); 7] = [
        (
            "degrees",
            |_, j| j[0].iter_mut().take(2).for_each(|x| *x *= DEG),
            &["far-beyond-limits"],
            "the positions seem to be in deg: use --columns 'position=q{}[deg]'",
        ),
        (
            "position",
            |_, j| j[1][0] *= 4.5,
            &["velocity-disagrees", "beyond-limits", "beyond-limits"],
            "limits are -3 and 3",
        ),
        ("effort", |_, j| j[1][2] *= 1000.0, &["far-beyond-limits"], "the efforts may be in Ncm"),
        ("sign", |_, j| j[0][1] = -j[0][1], &["velocity-disagrees"], "the opposite sign of the derivative"),
        (
            "velocity unit",
            |_, j| j[0][1] *= DEG,
            &["velocity-disagrees"],
            "The derivative is 0.01745 times the column. Velocities in deg/s would explain it",
        ),
        ("other joint", |_, j| j[0][1] = j[1][1], &["velocity-disagrees"], "does not match"),
        ("no velocity", |_, j| j[0][1] = 0.0, &["velocity-disagrees"], "is zero although the joint moves"),
    ];
    for (name, change, kinds, part) in cases {
        let found = found(&robot, "", change);
        assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), kinds, "{name}: {found:?}");
        assert!(kinds.is_empty() || found.iter().any(|f| f.1.contains(part)), "{name}: {found:?}");
    }
    // With a gear ratio of 100, efforts of 3 N·m at the joint are far beyond its limits if they are read as efforts of the
    // motor.
    let geared = Fake { gear: 100.0, ..Fake::numbered(2) };
    assert_eq!(found(&geared, "torque=u{}", |_, _| {}), []);
    let doubted = found(&geared, "", |_, _| {});
    assert_eq!(doubted.iter().map(|f| f.0).collect::<Vec<_>>(), ["far-beyond-limits"], "{doubted:?}");
    assert_eq!(found(&geared, "input=u{}", |_, j| j.iter_mut().for_each(|j| j[2] /= 100.0)), []);
}

/// An option for all logs would change the units of the correct run.
#[test]
fn a_run_that_alone_is_in_another_unit_is_named() {
    let mut text = String::from("t,q1,q2,u1,u2\n");
    for (unit, i) in [1.0, DEG].into_iter().flat_map(|unit| (0..400).map(move |i| (unit, i))) {
        let (t, [a, b]) = motion(i);
        writeln!(text, "{t},{},{},{},{}", unit * a[0], b[0], a[2], b[2]).unwrap();
    }
    let robot = Fake::numbered(2);
    let recording = runs_of(text.as_bytes(), "log.csv", &robot, &ColumnOptions::default()).unwrap();
    assert_eq!(recording.runs.len(), 2);
    let (prepared, _) = prepare_all(&recording.runs, None, &PreparationSettings::default()).unwrap();
    let [found] = &beyond(&robot, &recording, &prepared)[..] else { panic!("one finding") };
    let name = &recording.runs[1].name;
    assert!(found.message.contains(&format!("rad, only in run {name}, but the described limits")), "{found}");
    assert!(
        found.remedy.as_ref().is_some_and(|help| help.contains("Convert this log to the units")),
        "{found}"
    );
}

#[test]
fn turns_are_unwrapped() {
    let wrapped = |i: usize, joints: &mut [[f64; 3]; 2]| {
        let angle = 0.02 * i as f64 - 1.0;
        joints[0][0] =
            (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        joints[0][1] = 2.0;
    };
    let mut robot = Fake::numbered(2);
    robot.limits[0].position = [f64::NEG_INFINITY, f64::INFINITY];
    let free = found(&robot, "", wrapped);
    assert_eq!(free.iter().map(|f| f.0).collect::<Vec<_>>(), ["turns"]);
    assert!(
        free[0]
            .1
            .contains("row 210, joint joint_1: its position jumps by a full turn once. The jump is removed"),
        "{free:?}"
    );
    robot.limits[0].position = [-3.5, 3.5];
    assert_eq!(
        found(&robot, "", wrapped).iter().map(|f| f.0).collect::<Vec<_>>(),
        ["turns", "beyond-limits"]
    );
}

/// Inputs of an underactuated robot whose sliding joint is logged in millimetres.
#[test]
fn slides_and_inputs_have_their_units() {
    let mut cart = Fake::new(&["cart", "pole"]);
    cart.inputs.truncate(1);
    cart.units[0] = "m";
    let text = "t,cart_pos_mm,pole_pos_deg,u_cart\n0,1000,180,5\n0.01,1001,181,6\n0.02,1002,182,7\n";
    let recording = runs_of(text.as_bytes(), "log.csv", &cart, &ColumnOptions::default()).unwrap();
    let run = &recording.runs[0];
    assert_eq!((run.positions[0][0], run.positions[1][0]), (1.0, std::f64::consts::PI));
    assert_eq!((recording.effort, run.efforts.as_slice()), (Effort::Input, &[vec![5.0, 6.0, 7.0]][..]));
    assert!(
        recording.columns.iter().any(|line| line.starts_with("efforts, as inputs")
            && line.ends_with("in N because the header has no unit")),
        "{:?}",
        recording.columns
    );
}

#[test]
fn what_was_measured_goes_before_what_was_commanded() {
    let (_, header, row, ..) = styles().into_iter().find(|s| s.0 == "rtde").unwrap();
    let recording = read(&written(header, 20, row), &ColumnOptions::default());
    let said = recording.columns.join("\n");
    assert!(
        said.contains("positions: `actual_q_{}`") && said.contains("as motor currents: `actual_current_{}`"),
        "{said}"
    );
    assert_eq!(recording.unused, ["target_q_0", "target_q_1", "actual_TCP_pose_0", "actual_TCP_pose_1"]);
}

#[test]
fn an_effort_that_is_missing_leaves_the_other_joints_their_rows() {
    let text = |effort: &str| {
        let row = |i: u32| format!("{i},0.{i},0.2{i},1.{i},{effort}\n");
        "t,q1,q2,u1,u2\n".to_owned() + &(1..30).map(row).collect::<String>()
    };
    for (missing, rows) in [("", 29), ("nan", 29), ("broken", 29)] {
        let run = read(&text(missing), &ColumnOptions::default()).runs.remove(0);
        assert_eq!(run.times.len(), rows, "{missing}");
        assert!(run.efforts[1].iter().all(|u| u.is_nan()) && run.efforts[0].iter().all(|u| u.is_finite()));
    }
    let none = text("").replace(",1.", ",x1.");
    assert!(message(&none, "").contains("has no finite number"), "{}", message(&none, ""));
}

#[test]
fn several_logs_are_one_recording() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let row: Row = |t, [a, b]| format!("{t},{},{},{},{}", a[0], b[0], a[2], b[2]);
    let one = write("one.csv", &written("t,q1,q2,tau1,tau2", 50, row));
    let two = write("two.csv", &written("t,pos_1,pos_2,u1,u2", 60, row));
    let same = write("same.csv", &written("t,q1,q2,tau1,tau2", 50, row));
    let current = write("current.csv", &written("t,q1,q2,i1,i2", 50, row));
    let robot = Fake::numbered(2);
    let read = |paths: &[&std::path::PathBuf]| {
        let paths: Vec<std::path::PathBuf> = paths.iter().map(|p| (*p).clone()).collect();
        super::super::runs(&paths, &robot, &ColumnOptions::default())
    };
    let recording = read(&[&one, &two]).unwrap();
    let names: Vec<(&str, usize)> = recording.runs.iter().map(|r| (r.name.as_str(), r.times.len())).collect();
    assert_eq!(names, [("one.csv", 50), ("two.csv", 60)]);
    assert_eq!(recording.hashes.len(), 2);
    let message = |paths: &[&std::path::PathBuf]| read(paths).unwrap_err().to_string();
    assert!(message(&[&one, &same]).contains("same.csv: this log has the same samples as"));
    std::fs::write(&same, format!("{}\n", std::fs::read_to_string(&one).unwrap())).unwrap();
    assert!(message(&[&one, &same]).contains("same.csv: this log has the same samples as"));
    assert!(
        message(&[&one, &current])
            .contains("the efforts of this log are currents, but those of the logs before it are forces")
    );
    assert!(message(&[]).contains("the list of logs is empty"));
    assert!(message(&[&folder.path().join("none.csv")]).contains("none.csv"));
}

/// PlotJuggler exports several topics to one table: each row has the columns of one topic, and the other columns are empty.
#[test]
fn topics_between_each_other_are_told_apart() {
    let mut text = String::from(
        "__time,/imu/acceleration/x,/joint_states/joint_1/position,/joint_states/joint_2/position,/joint_states/joint_1/effort,/joint_states/joint_2/effort,/cmd/joint_1/position,/cmd/joint_2/position\n",
    );
    for i in 0..100 {
        let (t, [a, b]) = motion(i);
        writeln!(text, "{t},9.81,,,,,,").unwrap();
        writeln!(text, "{t},,{},{},{},{},,", a[0], b[0], a[2], b[2]).unwrap();
        writeln!(text, "{},,,,,,{},{}", t + 0.001, a[0], b[0]).unwrap();
    }
    let recording = read(&text, &ColumnOptions::default());
    assert_motion("topics", &recording, 100);
    assert_eq!(recording.runs[0].rows[..2], [3, 6]);
    let left = recording.findings.iter().find(|f| f.code == "rows-left-out").map(Finding::sentence);
    assert_eq!(left.as_deref(), Some("log.csv: 200 incomplete rows are left out"));
}

/// All readers must meet this requirement: their time grows at most linearly with the length of the input.
#[test]
fn odd_logs_are_read_in_time() {
    // Every row is a separate run, or its time goes back.
    let rows = |row: &dyn Fn(usize) -> String| -> String {
        let rows: Vec<String> = (0..20_000).map(row).collect();
        format!("t,run,q1,q2,u1,u2\n{}\n", rows.join("\n"))
    };
    let said = message(&rows(&|i| format!("{i},{i},1,2,3,4")), "");
    assert!(said.contains("no run has two samples with increasing times"), "{said}");
    let recording = read(&rows(&|i| format!("{},1,1,2,3,4", i % 2)), &ColumnOptions::default());
    assert_eq!(recording.runs.len(), 10_000);
    assert!(recording.findings.len() < 20, "{}", recording.findings.len());
    // The table has more columns than any log.
    let header: Vec<String> = (0..5000).map(|i| format!("topic_{i}/signal_{}", i % 7)).collect();
    let row = vec!["1"; 5000].join(",");
    let said = message(&format!("{}\n{row}\n{row}\n", header.join(",")), "");
    assert!(said.contains("(4960 more)"), "{}", &said[..200]);
}

/// A rod that follows both joints moves from −0.8 rad to 1.8 rad with up to 4.1 rad/s.
#[test]
fn joints_that_follow_beyond_their_limits_are_named() {
    let rod = |position: [f64; 2], velocity: f64| Fake {
        followers: vec![FollowerLimits {
            name: "rod".into(),
            ratios: vec![1.0, 1.0],
            offset: 0.2,
            position,
            velocity,
        }],
        ..Fake::numbered(2)
    };
    assert_eq!(found(&rod([-1.5, 1.9], 4.1), "", |_, _| {}), []);
    let far = found(&rod([-1.5, 1.0], 4.1), "", |_, _| {});
    assert_eq!(far.len(), 1, "{far:?}");
    assert_eq!(far[0].0, "beyond-limits");
    let from = "joint rod: its positions (computed from the joints that it follows) range from -0.7";
    assert!(far[0].1.contains(from), "{far:?}");
    let fast = found(&rod([-1.5, 1.9], 2.0), "", |_, _| {});
    assert_eq!(fast.len(), 1, "{fast:?}");
    assert_eq!(fast[0].0, "beyond-limits");
    assert!(fast[0].1.ends_with("the described limits are -2 and 2"), "{fast:?}");
}
