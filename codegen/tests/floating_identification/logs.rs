//! Logs of a quadrotor, as they are named and as they are broken, through the command.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use super::quadrotor::{Sample, flight, truth};
use super::{models, robot};
use gelenk_identification::robot::Robot;

/// Names of the columns: time, place, quaternion w x y z, thrusts.
pub const HEADERS: [&str; 4] = [
    // The runtime's control loop.
    "time,q_base_x,q_base_y,q_base_z,q_base_qw,q_base_qx,q_base_qy,q_base_qz,u_front_right,u_rear_left,u_front_left,u_rear_right",
    // ROS.
    "time,pose.position.x,pose.position.y,pose.position.z,pose.orientation.w,pose.orientation.x,pose.orientation.y,pose.orientation.z,\
     u_front_right,u_rear_left,u_front_left,u_rear_right",
    "t,x [mm],y [mm],z [mm],qw,qx,qy,qz,u0,u1,u2,u3",
    "t [s],a,b,c,d,e,f,g,h,i,j,k",
];
const NAMED: &str = "place=2..4,wxyz=5..8,input=9..12";

pub fn log(header: &str, samples: &[Sample]) -> String {
    let mut text = format!("{header}\n");
    let scale = if header.contains("[mm]") { 1e3 } else { 1.0 };
    for sample in samples {
        let (p, q, u) = (scale * sample.place, sample.attitude, sample.thrusts);
        let digits = if scale > 1.0 { 1 } else { 4 };
        write!(text, "{:.4},{:.digits$},{:.digits$},{:.digits$}", sample.time, p.x, p.y, p.z).unwrap();
        writeln!(
            text,
            ",{:.5},{:.5},{:.5},{:.5},{:.4},{:.4},{:.4},{:.4}",
            q.w, q.i, q.j, q.k, u[0], u[1], u[2], u[3]
        )
        .unwrap();
    }
    text
}

fn identify(folder: &Path, log: &str, more: &[&str]) -> Output {
    fs::write(folder.join("log.csv"), log).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    command.current_dir(folder).arg("identify").arg(models("quadrotor.toml")).arg("log.csv");
    command.args(["--output", "found.toml"]).args(more).output().unwrap()
}

/// The largest errors of mass, centre of mass [m] and inertia, relative to the truth's own, of a description.
pub fn errors(path: &Path) -> [f64; 3] {
    let found = robot(path).parameters();
    let (truth, mass) = (truth(), found[0]);
    let centre = (0..3).map(|i| (found[1 + i] / mass - truth.center[i]).abs()).fold(0.0, f64::max);
    let entries = [(4, 0, 0), (6, 1, 1), (9, 2, 2), (5, 0, 1), (7, 0, 2), (8, 1, 2)];
    let inertia = entries.map(|(k, i, j)| (found[k] - truth.inertia[(i, j)]).abs() / truth.inertia[(0, 0)]);
    [(mass / truth.mass - 1.0).abs(), centre, inertia.into_iter().fold(0.0, f64::max)]
}

#[test]
fn a_quadrotor_has_its_mass_and_inertia_back() {
    let (folder, flight) = (tempfile::tempdir().unwrap(), flight(40.0, 1));
    let described = errors(&models("quadrotor.toml"));
    assert!(described[0] > 0.19 && described[1] > 0.01 && described[2] > 0.1, "{described:?}");
    for header in HEADERS {
        let mut more = vec!["--format", "json", "--report", "page"];
        more.extend(header.contains(",a,").then_some(["--columns", NAMED]).into_iter().flatten());
        let output = identify(folder.path(), &log(header, &flight), &more);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{header}: {said}");
        let [mass, centre, inertia] = errors(&folder.path().join("found.toml"));
        println!("mass {mass:.1e}, centre {centre:.1e} m, inertia {inertia:.1e}");
        assert!(mass < 1e-3 && centre < 1e-3 && inertia < 1e-2, "{header}: {mass} {centre} {inertia}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let joints = found["joints"].as_array().unwrap();
        let share = |joint: usize| joints[joint]["r_squared_held_out"].as_f64();
        assert_eq!((share(0), share(1)), (None, None), "nothing acts along x and y");
        assert!((2..6).all(|joint| share(joint).unwrap() > 0.98), "{joints:?}");
        assert!(joints.iter().all(|joint| joint["friction"] == "–"), "{joints:?}");
    }
}

/// At 50 Hz a step turns the robot by several degrees. What is left is noise: without it the centre of mass has an error of
/// 0.12 mm and the inertia of 0.04 %.
#[test]
fn a_slow_log_is_enough() {
    let folder = tempfile::tempdir().unwrap();
    let slow: Vec<Sample> = flight(40.0, 4).into_iter().step_by(4).collect();
    let output = identify(folder.path(), &log(HEADERS[0], &slow), &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let [mass, centre, inertia] = errors(&folder.path().join("found.toml"));
    println!("at 50 Hz: mass {mass:.1e}, centre {centre:.1e} m, inertia {inertia:.1e}");
    assert!(mass < 2e-3 && centre < 2e-3 && inertia < 3e-2, "{mass} {centre} {inertia}");
}

/// The paths of joints with a quaternion pass TVDiff like positions. The inertia is less accurate than by the filter alone: 1.6 % instead
/// of 0.5 %.
#[test]
fn poses_are_differentiated_by_total_variation_on_request() {
    let (folder, flight) = (tempfile::tempdir().unwrap(), flight(40.0, 1));
    let mut found = [[0.0; 3]; 2];
    for (found, derivative) in found.iter_mut().zip(["filter", "tvdiff"]) {
        let output = identify(folder.path(), &log(HEADERS[0], &flight), &["--derivative", derivative]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        *found = errors(&folder.path().join("found.toml"));
    }
    println!("{found:?}");
    let [mass, centre, inertia] = found[1];
    assert!(mass < 1e-3 && centre < 1e-3 && inertia < 2e-2 && found[0] != found[1], "{found:?}");
}

#[test]
fn unseen_flights_are_predicted() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("other.csv"), log(HEADERS[0], &flight(15.0, 2))).unwrap();
    let output = identify(folder.path(), &log(HEADERS[0], &flight(25.0, 1)), &["--validate", "other.csv"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let validated = said.split("R² in validation logs").nth(1).unwrap();
    let row = validated.lines().find(|line| line.contains("base_rx")).unwrap();
    let share: f64 = row.split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!(share > 0.99, "{said}");
    assert!(!said.contains("NaN"), "{said}");
}

/// A log, what is said about its columns, and words of the message.
fn broken() -> Vec<(String, &'static str, &'static [&'static str])> {
    let flight = flight(3.0, 3);
    let good = log(HEADERS[0], &flight);
    let changed = |row: usize, q: &str| {
        let line = good.lines().nth(row).unwrap();
        let fields: Vec<&str> = line.split(',').collect();
        good.replace(line, &[&fields[..4].join(","), q, &fields[8..].join(",")].join(","))
    };
    let renamed = |from: &str, to: &str| good.replacen(from, to, 1);
    let angles = renamed("q_base_qw,q_base_qx,q_base_qy,q_base_qz", "other,roll_deg,pitch_deg,yaw_deg");
    vec![
        (
            changed(100, "0,0,0,0"),
            "",
            &["log.csv, row 101", "is zero, so it is not an orientation", "Remove the rows"],
        ),
        (changed(7, "3,40,2,1"), "", &["row 8", "has the length 40.1", "The columns may be angles"]),
        (
            renamed("q_base_qz", "other"),
            "",
            &["the quaternion of `base` has only", "`q_base_qw`", "z is missing", "'xyzw=a|b|c|d'"],
        ),
        (
            renamed("q_base_z", "height"),
            "",
            &["the place of `base` has only the columns `q_base_x`, `q_base_y`, but z is missing"],
        ),
        (angles, "", &["`base`, but roll_deg, pitch_deg, yaw_deg look like angles", "as_quat()"]),
        (
            renamed("q_base_qx", "q_base_qx [deg]"),
            "",
            &["`q_base_qx [deg]` has a unit, but entries of a quaternion have none"],
        ),
        (
            renamed("q_base_x", "q_base_x [rad]"),
            "",
            &["`q_base_x [rad]` is a place in rad, but m is expected"],
        ),
        (good.clone(), "wxyz=5..7", &["the pattern names 3 columns, but 4 are needed"]),
        (good.clone(), "wxyz=5..8,xyzw=5..8", &["the quaternions are named twice"]),
        (good.clone(), "desired=q_base_x", &["`desired`"]),
        (
            good.clone(),
            "torque=9..12",
            &["inputs of this robot act at frames: front_right, rear_left", "'input=…'"],
        ),
        (
            good.clone(),
            "current=9..12",
            &["currents are not supported for robots with spherical or floating joints"],
        ),
        (renamed("u_front_left", "other"), "", &["the log has no column for the", "front_left"]),
        (log(HEADERS[1], &flight), "xyzw=pose.orientation.x|nothing", &["no column has this name"]),
    ]
}

#[test]
fn what_is_no_pose_is_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for (text, columns, words) in broken() {
        let more: Vec<&str> = if columns.is_empty() { vec![] } else { vec!["--columns", columns] };
        let output = identify(folder.path(), &text, &more);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        for word in words {
            assert!(said.contains(word), "{word}\n{said}");
        }
        assert!(!folder.path().join("found.toml").exists(), "{said}");
    }
}

#[test]
fn what_is_not_done_for_such_robots_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let text = log(HEADERS[0], &flight(3.0, 3));
    let cases: [(&[&str], &str); 2] = [
        (&["--gravity-compensated"], "gravity is not compensated if a joint is floating"),
        (
            &["--plan"],
            "joint base: no motion is planned, because the inputs move this floating joint in only 4 of its 6 directions",
        ),
    ];
    for (more, words) in cases {
        fs::write(folder.path().join("log.csv"), &text).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
        command.current_dir(folder.path()).arg("identify").arg(models("quadrotor.toml"));
        if !more.contains(&"--plan") {
            command.arg("log.csv");
        }
        let output = command.args(more).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && said.contains(words), "{words}\n{said}");
    }
}
