//! Planned motions of joints with quaternions: what the file says is one motion, and identifies the robot.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use gelenk_identification::excitation::{Excitation, PlanSettings, plan};
use gelenk_identification::robot::Robot;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::moments::{BALL, ball};
use super::{Noise, robot};

/// A box in free fall that six wrenches at its frame move.
const BOX: &str = "name = \"box\"\nbase = { link = \"box\", type = \"floating\" }\n[[bodies]]\nlink = \"box\"\nmass = 3\n\
    center_of_mass = [0.02, 0, 0.01]\ninertia = [0.1, 0.2, 0.15]\n[[frames]]\nname = \"tool\"\nlink = \"box\"\norigin = { xyz = [0.1, 0, 0] }\n";

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    command.current_dir(folder).arg("identify").args(arguments).output().unwrap()
}

fn rows(csv: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect();
    csv.lines().skip(1).map(row).collect()
}

fn attitude(q: &[f64]) -> UnitQuaternion<f64> {
    assert!((q.iter().map(|q| q * q).sum::<f64>() - 1.0).abs() < 1e-8, "{q:?}");
    UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2]))
}

fn three(x: &[f64]) -> Vector3<f64> {
    Vector3::from_column_slice(&x[..3])
}

#[test]
fn a_ball_joint_is_planned_and_identified_along_its_plan() {
    let folder = tempfile::tempdir().unwrap();
    let [_, truth] = ball(folder.path());
    let plan = ["--plan", "described.toml", "--output", "plan.csv", "--seconds", "20", "--rate", "200"];
    let output =
        gelenk(folder.path(), &[&plan[..], &["--start", "hip_rx=0.1,hip_ry=-0.2,hip_rz=0"]].concat());
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    println!("{said}");
    assert!(
        said.contains("they rotate by up to 0.90 rad") && said.contains("and 0 friction parameters"),
        "{said}"
    );
    let text = fs::read_to_string(folder.path().join("plan.csv")).unwrap();
    let head = "t,q_hip_qx,q_hip_qy,q_hip_qz,q_hip_qw,dq_hip_rx,dq_hip_ry,dq_hip_rz,ddq_hip_rx,ddq_hip_ry,ddq_hip_rz\n";
    assert!(text.starts_with(head), "{}", text.lines().next().unwrap());
    let rows = rows(&text);
    let start = attitude(&rows[0][1..5]).scaled_axis() - Vector3::new(0.1, -0.2, 0.0);
    assert!(start.norm() < 1e-8, "{start}");
    let mut worst = [0.0_f64; 2];
    for pair in rows.windows(3) {
        let [before, now, after] = [0, 1, 2].map(|k| &pair[k]);
        let h = after[0] - before[0];
        // A turn by the velocity in the middle, to second order in the step.
        let turn = (attitude(&before[1..5]).inverse() * attitude(&after[1..5])).scaled_axis() / h;
        worst[0] = worst[0].max((turn - three(&now[5..])).norm());
        // Where the way to the motion ends, and the motion itself, the third derivative jumps.
        let rests = now[5..8].iter().all(|v| v.abs() < 1e-3);
        let change = (three(&after[5..]) - three(&before[5..])) / h - three(&now[8..]);
        worst[1] = worst[1].max(if rests { 0.3 * change.norm() } else { change.norm() });
        assert!(attitude(&now[1..5]).angle() < 0.905, "{now:?}");
        assert!(now[5..8].iter().all(|v| v.abs() < 0.703), "{now:?}");
        assert!(now[8..11].iter().all(|a| a.abs() < 1.42), "{now:?}");
    }
    assert!(worst[0] < 1e-3 && worst[1] < 1e-2, "{worst:?}");
    for end in [&rows[0], rows.last().unwrap()] {
        assert!(end[5..11].iter().all(|x| x.abs() < 1e-8), "{end:?}");
    }
    // The log of a robot that follows the plan has the plan's own columns.
    let mut noise = Noise::new(3);
    let mut log = String::from("t,q_hip_qx,q_hip_qy,q_hip_qz,q_hip_qw");
    truth.input_names().iter().for_each(|name| write!(log, ",u_{name}").unwrap());
    for row in &rows {
        let mut forces = vec![0.0; 3];
        truth.rigid_forces(&row[1..5], &row[5..8], &row[8..11], &mut forces);
        let q = attitude(&row[1..5]) * UnitQuaternion::from_scaled_axis(Vector3::from(noise.vector(1e-4)));
        write!(log, "\n{:.4},{:.6},{:.6},{:.6},{:.6}", row[0], q.i, q.j, q.k, q.w).unwrap();
        forces.iter().for_each(|force| write!(log, ",{:.5}", force + 1e-3 * noise.normal()).unwrap());
    }
    fs::write(folder.path().join("log.csv"), log).unwrap();
    let output = gelenk(folder.path(), &["described.toml", "log.csv", "--output", "found.toml"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = robot(&folder.path().join("found.toml")).parameters();
    let real = truth.parameters();
    println!("found {found:.4?}\nreal  {real:.4?}");
    // A mass at the joint moves nothing.
    for (found, real) in found[1..].iter().zip(&real[1..]) {
        assert!((found - real).abs() < 2e-3, "{found} {real}");
    }
}

/// Six wrenches hold the box at every instant, so that every direction is planned.
#[test]
fn a_base_that_wrenches_move_in_all_directions_is_planned() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = BOX.to_owned();
    for k in 0..6 {
        let wrench: Vec<&str> = (0..6).map(|i| if i == k { "1" } else { "0" }).collect();
        write!(
            text,
            "[[inputs]]\nname = \"w{k}\"\nframe = \"tool\"\nwrench = [{}]\nlimits = [-60, 60]\n",
            wrench.join(", ")
        )
        .unwrap();
    }
    let path = folder.path().join("box.toml");
    fs::write(&path, &text).unwrap();
    let described = robot(&path);
    let excitation = Excitation { iterations: 40, starts: 1, ..PlanSettings::default().excitation };
    let found =
        plan(&described, &PlanSettings { excitation, ..PlanSettings::default() }, &mut |_| ()).unwrap();
    println!("condition {:.1}, {:?}", found.condition, found.parameters);
    assert_eq!(found.parameters, [10, 0]);
    assert!(
        found.inputs.iter().all(|input| input.range.iter().all(|u| u.abs() < 0.71 * 60.0)),
        "{:?}",
        found.inputs
    );
    let rows = rows(&found.csv(&described, 0.01, 1));
    for pair in rows.windows(3) {
        let [before, now, after] = [0, 1, 2].map(|k| &pair[k]);
        let h = after[0] - before[0];
        // In the body's own frame, from places in that of the world.
        let speed = attitude(&now[4..8]).inverse() * ((three(&after[1..]) - three(&before[1..])) / h);
        assert!((speed - three(&now[8..])).norm() < 1e-3, "{now:?}");
        let change = (three(&after[8..]) - three(&before[8..])) / h;
        assert!((change - three(&now[14..])).norm() < 1e-2, "{now:?}");
    }
    // Without one of the wrenches a direction is missing.
    fs::write(&path, text.replace("wrench = [0, 0, 1, 0, 0, 0]", "wrench = [0, 1, 0, 0, 0, 0]")).unwrap();
    let said = plan(&robot(&path), &PlanSettings::default(), &mut |_| ()).unwrap_err().to_string();
    let words = [
        "joint base",
        "the inputs move this floating joint in only 5 of its 6 directions",
        "Record free motions",
        "wrench",
    ];
    words.iter().for_each(|word| assert!(said.contains(word), "{word}: {said}"));
}

#[test]
fn a_ball_joint_without_drives_is_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{BALL}mass = 1\ninertia = 0.1\n").replace("drive = \"ideal\"\n", "");
    fs::write(folder.path().join("ball.toml"), text).unwrap();
    let output = gelenk(folder.path(), &["--plan", "ball.toml"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    let words = [
        "joint hip: no motion is planned, because the inputs move this spherical joint in only 0 of its 3 directions",
        "type = \"fixed\"",
    ];
    words.iter().for_each(|word| assert!(said.contains(word), "{word}: {said}"));
}

#[test]
fn turns_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    ball(folder.path());
    let cases = [
        (vec!["--turn", "3.2"], "turn = 3.2 is not possible"),
        (vec!["--start", "hip_rx=2,hip_ry=2,hip_rz=2"], "rotation of joint hip at the start = 3.46"),
    ];
    for (more, words) in cases {
        let output = gelenk(folder.path(), &[&["--plan", "described.toml"], &more[..]].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(words), "{words}: {said}");
    }
}
