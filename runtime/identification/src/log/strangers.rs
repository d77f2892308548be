//! Logs in strangers' styles: the same motion, written as other programs write it.

use super::super::run::Effort;
use super::testing::Fake;
use super::{ColumnOptions, FindingKind, Recording, runs_of};
use std::fmt::Write;

/// Two joints at 100 Hz: position, velocity, effort.
fn motion(i: usize) -> (f64, [[f64; 3]; 2]) {
    let t = 0.01 * i as f64;
    let joint = |a: f64, w: f64| [a * (w * t).sin(), a * w * (w * t).cos(), 3.0 * (w * t).cos() + 0.5 * a];
    (t, [joint(1.0, 2.0), joint(0.7, 3.0)])
}

/// A log of `count` rows below `header`, each written by `row(t, joints)`.
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

fn message(text: &str, columns: &str) -> String {
    let columns = Some(columns.to_owned()).filter(|c| !c.is_empty());
    let options = ColumnOptions { columns, ..ColumnOptions::default() };
    runs_of(text.as_bytes(), "log.csv", &Fake::numbered(2), &options).unwrap_err().to_string()
}

/// The motion stands in the recording, up to what was written.
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

/// Styles: name, header, row, options of the user, what the efforts are, whether velocities are found.
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
        ("rtde", "timestamp target_q_0 target_q_1 actual_q_0 actual_q_1 actual_qd_0 actual_qd_1 actual_current_0 actual_current_1 actual_TCP_pose_0 actual_TCP_pose_1", |t, [a, b]| format!("{} 0 1 {} {} {} {} {} {} 5 6", 8123.5 + t - 8123.5, a[0], b[0], a[1], b[1], a[2], b[2]), "", Current, true),
        ("franka", "time [ms],q[0],q[1],q_d[0],q_d[1],dq[0],dq[1],tau_J[0],tau_J[1],tau_J_d[0],tau_J_d[1],dtau_J[0],dtau_J[1],tau_ext_hat_filtered[0],tau_ext_hat_filtered[1]", |t, [a, b]| format!("{},{},{},9,9,{},{},{},{},9,9,9,9,9,9", (t * 1000.0).round(), a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("german excel", "Zeit;Time (s);Position 1 [deg];Position 2 [deg];Torque 1 (Nm);Torque 2 (Nm);", |t, [a, b]| format!("x;{t};{};{};{};{};", a[0] * DEG, b[0] * DEG, a[2], b[2]).replace('.', ","), "", Joint, false),
        ("matlab", "Time (s)\tq(1)\tq(2)\tu(1)\tu(2)", |t, [a, b]| format!("{t}\t{}\t{}\t{}\t{}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("savetxt", "# a robot\n# t q_0 q_1 tau_0 tau_1", |t, [a, b]| format!("{t:.18e} {:.18e} {:.18e} {:.18e} {:.18e}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("row of units", "\u{feff}\"t\",\"pos_1\",\"pos_2\",\"vel_1\",\"vel_2\",\"eff_1\",\"eff_2\"\ns,deg,deg,deg/s,deg/s,Nm,mNm", |t, [a, b]| format!("{t},{},{},{},{},{},{}\r", a[0] * DEG, b[0] * DEG, a[1] * DEG, b[1] * DEG, a[2], b[2] * 1e3), "", Joint, true),
        ("suffixes", "t_ms,q1_deg,q2_deg,dq1_deg_s,dq2_deg_s,cur_1_ma,cur_2_ma", |t, [a, b]| format!("{},{},{},{},{},{},{}", t * 1e3, a[0] * DEG, b[0] * DEG, a[1] * DEG, b[1] * DEG, a[2] * 1e3, b[2] * 1e3), "", Current, true),
        ("preamble", "Recorder 3.1\nDate,2024-03-01\n\nSample rate,100\nTime,J1 ActPos,J2 ActPos,J1 ActTorque,J2 ActTorque", |t, [a, b]| format!("{t}, {}, {}, {}, {}", a[0], b[0], a[2], b[2]), "", Joint, false),
        ("index column", ",t,q1,q2,u1,u2", |t, [a, b]| format!("{},{t},{},{},{},{}", (t * 100.0).round(), a[0], b[0], a[2], b[2]), "", Joint, false),
        ("loop", "time,q_joint_1,q_joint_2,dq_joint_1,dq_joint_2,desired_joint_1,desired_joint_2,u_joint_1,u_joint_2,source,believed,iterations,lateness_ns,read_ns,control_ns,check_ns,write_ns", |t, [a, b]| format!("{t},{},{},{},{},0,0,{},{},controller,1,3,100,1,2,3,4", a[0], b[0], a[1], b[1], a[2], b[2]), "", Joint, true),
        ("blanks and dots", "Sample;robot.Joint 1.Actual Position (rad);robot.Joint 2.Actual Position (rad);robot.Joint 1.Motor Torque (Nm);robot.Joint 2.Motor Torque (Nm);elapsed time (us)", |t, [a, b]| format!("1;{};{};{};{};{}", a[0], b[0], a[2], b[2], (t * 1e6).round()), "", Joint, false),
        ("told", "a,b,c,d,e", |t, [a, b]| format!("{},{},{t},{},{}", a[0] * DEG, b[0] * DEG, a[2], b[2]), "position=a|b[deg],torque=4..5,time=c", Joint, false),
        ("told by numbers", "", |t, [a, b]| format!("{t},{},{},{},{}", a[0], b[0], a[2], b[2]), "time=1, position=2..3, current=4..5", Current, false),
        ("told by pattern", "clock,enc_0_raw,enc_1_raw,enc_2_raw,x0,x1", |t, [a, b]| format!("{t},{},{},0,{},{}", a[0] * DEG / 0.1, b[0] * DEG / 0.1, a[2], b[2]), "position=ENC_{}_raw[0.1 deg],effort=x{}", Joint, false),
    ]
}

#[test]
fn strangers_logs_are_read() {
    for (style, header, row, columns, effort, has_velocity) in styles() {
        let text = written(header, 200, row);
        let columns = Some(columns.to_owned()).filter(|c| !c.is_empty());
        let recording =
            read(text.trim_start_matches('\n'), &ColumnOptions { columns, ..ColumnOptions::default() });
        assert_motion(style, &recording, 200);
        assert_eq!(recording.effort, effort, "{style}");
        assert_eq!(
            recording.runs[0].velocities[0].is_some(),
            has_velocity,
            "{style}: {:?}",
            recording.mapping
        );
        let suspicious = recording.findings.iter().filter(|f| f.kind != FindingKind::UnitAssumed);
        assert_eq!(suspicious.map(ToString::to_string).collect::<Vec<_>>(), Vec::<String>::new(), "{style}");
    }
}
