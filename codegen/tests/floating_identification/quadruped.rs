//! A quadruped on measured feet: from all of its rows, and from those of its base alone.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_identification::estimation::Estimate;
use gelenk_identification::fleet::{LogMoments, identify_moments, reduce};
use gelenk_identification::identify::{IdentificationSettings, identify};
use gelenk_identification::robot::Robot;
use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

use super::{Noise, models, robot};

const N: usize = 18;
const FEET: [&str; 4] = ["FL_foot", "FR_foot", "RL_foot", "RR_foot"];
/// Rows of a log for each second.
const RATE: f64 = 400.0;

/// True parameters of the Go2 of `models/`: its trunk carries a load, one thigh is heavier and one lighter.
const TRUTH: &str = r#"
name = "truth"
extends = "feet.toml"

[[bodies]]
link = "trunk"
mass = 9
center_of_mass = [-0.01, 0.01, 0.02]
inertia = [0.04, 0.13, 0.14]

[[bodies]]
link = "FL_thigh"
mass = 1.5
center_of_mass = [0, -0.02, -0.05]
inertia = [8e-3, 8e-3, 1.5e-3]

[[bodies]]
link = "RR_thigh"
mass = 0.8
center_of_mass = [0.01, 0.02, -0.02]
inertia = [5e-3, 5e-3, 1e-3]
"#;

/// The Go2 of `models/` with forces at its feet as inputs, in the axes of its calves.
fn described() -> String {
    let mut text = format!("name = \"feet\"\nextends = {:?}\n", models("go2.toml").display().to_string());
    for foot in FEET {
        for (axis, wrench) in [("x", "1, 0, 0"), ("y", "0, 1, 0"), ("z", "0, 0, 1")] {
            write!(
                text,
                "\n[[inputs]]\nname = \"{foot}_f{axis}\"\nframe = \"{foot}\"\nwrench = [{wrench}, 0, 0, 0]\n"
            )
            .unwrap();
        }
    }
    text
}

/// A sum of sines, with its derivative.
fn sines(t: f64, amplitude: f64, seed: usize) -> [f64; 2] {
    (0..3).fold([0.0; 2], |[value, rate], k| {
        let w = TAU * (0.31 + 0.17 * ((seed * 7 + k * 5) % 9) as f64);
        let phase = 1.3 * seed as f64 + 2.1 * k as f64;
        [value + amplitude / 3.0 * (w * t + phase).sin(), rate + amplitude / 3.0 * w * (w * t + phase).cos()]
    })
}

/// Velocities and accelerations: of the base in its own frame, then of the joints.
fn motion(t: f64, shift: usize) -> [Vec<f64>; 2] {
    let amplitude = |i: usize| match i {
        0..3 => 0.5,
        3..6 => 1.2,
        _ => 2.0,
    };
    let all: Vec<[f64; 2]> = (0..N).map(|i| sines(t, amplitude(i), i + shift)).collect();
    [0, 1].map(|order| all.iter().map(|sine| sine[order]).collect())
}

/// Forces of the feet by least norm, and torques of the joints, that move the robot so.
fn inputs(robot: &InterpretedRobot, y: &[f64], forces: &[f64]) -> Vec<f64> {
    let m = robot.input_names().len();
    let mut matrix = DMatrix::zeros(N, m);
    let mut column = vec![0.0; N];
    for input in 0..m {
        let unit: Vec<f64> = (0..m).map(|i| f64::from(u8::from(i == input))).collect();
        robot.input_forces(y, &unit, &mut column);
        matrix.column_mut(input).copy_from_slice(&column);
    }
    let feet = matrix.view((0, 12), (6, 12)).into_owned();
    let feet = feet.pseudo_inverse(1e-9).unwrap() * DVector::from_column_slice(&forces[..6]);
    let rest = DVector::from_column_slice(&forces[6..]) - matrix.view((6, 12), (12, 12)) * &feet;
    rest.iter().chain(feet.iter()).copied().collect()
}

/// Poses along the motion, and the rows of a log with noise of 0.5 mm, 1 mrad, 0.05 N m at the joints and
/// 0.1 N at the feet.
struct Recorded {
    text: String,
}

fn record(truth: &InterpretedRobot, seconds: f64, shift: usize, torques: bool) -> Recorded {
    const FINE: usize = 10;
    let mut noise = Noise::new(7 + shift as u64);
    let (mut place, mut attitude) = (Vector3::zeros(), UnitQuaternion::identity());
    let mut joints = [0.1, 0.8, -1.6, -0.1, 0.8, -1.6, 0.1, 0.8, -1.6, -0.1, 0.8, -1.6];
    let mut text = header(truth, torques);
    for i in 0..(seconds * RATE) as usize {
        let t = i as f64 / RATE;
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(noise.vector(1e-3)));
        let measured = attitude * turn;
        let p = place + Vector3::from(noise.vector(5e-4));
        let q = attitude.coords;
        let y: Vec<f64> = place.iter().chain(q.iter()).copied().chain(joints).collect();
        let [v, a] = motion(t, shift);
        let mut forces = vec![0.0; N];
        truth.rigid_forces(&y, &v, &a, &mut forces);
        let u = inputs(truth, &y, &forces);
        write!(
            text,
            "{t:.5},{:.5},{:.5},{:.5},{:.6},{:.6},{:.6},{:.6}",
            p.x, p.y, p.z, measured.i, measured.j, measured.k, measured.w
        )
        .unwrap();
        joints.iter().for_each(|y| write!(text, ",{:.5}", y + 2e-4 * noise.normal()).unwrap());
        let skipped = if torques { 0 } else { 12 };
        for (k, u) in u.iter().enumerate().skip(skipped) {
            let size = if k < 12 { 0.05 } else { 0.1 };
            write!(text, ",{:.3}", u + size * noise.normal()).unwrap();
        }
        text.push('\n');
        for k in 0..FINE {
            let h = 1.0 / (RATE * FINE as f64);
            let [v, _] = motion(t + (k as f64 + 0.5) * h, shift);
            let w = Vector3::new(v[3], v[4], v[5]);
            let half = attitude * UnitQuaternion::from_scaled_axis(0.5 * h * w);
            place += h * (half * Vector3::new(v[0], v[1], v[2]));
            attitude *= UnitQuaternion::from_scaled_axis(h * w);
            joints.iter_mut().zip(&v[6..]).for_each(|(y, v)| *y += h * v);
        }
    }
    Recorded { text }
}

fn header(robot: &InterpretedRobot, torques: bool) -> String {
    let mut header = String::from("time,pose.position.x,pose.position.y,pose.position.z");
    ["x", "y", "z", "w"].iter().for_each(|letter| write!(header, ",pose.orientation.{letter}").unwrap());
    robot.joint_names()[6..].iter().for_each(|name| write!(header, ",{name}_position").unwrap());
    let names = robot.input_names();
    let kept = if torques { &names[..] } else { &names[12..] };
    kept.iter().for_each(|name| write!(header, ",u_{name}").unwrap());
    header + "\n"
}

/// Errors of the forces in the rows of the base along another motion, relative to their size: as described
/// and as estimated.
fn base_errors(described: &InterpretedRobot, truth: &InterpretedRobot, found: &Estimate) -> [f64; 2] {
    let values: Vec<f64> = found.parameters.iter().map(|parameter| parameter.value).collect();
    let [mut before, mut after, mut size] = [0.0; 3];
    for i in 0..50 {
        let [v, a] = motion(0.37 * f64::from(i), 5);
        let q = UnitQuaternion::from_euler_angles(0.2 * v[0], 0.3 * v[1], 0.5 * v[2]).coords;
        let y: Vec<f64> =
            [0.0; 3].into_iter().chain(q.iter().copied()).chain(v[6..].iter().map(|x| 0.3 * x)).collect();
        let mut w = vec![0.0; N * values.len()];
        described.inertial_regressor(&y, &v, &a, &mut w);
        let row = |parameters: &[f64], row: usize| -> f64 {
            w[row * values.len()..(row + 1) * values.len()].iter().zip(parameters).map(|(w, p)| w * p).sum()
        };
        for j in 0..6 {
            let true_force = row(&truth.parameters(), j);
            before += (row(&described.parameters(), j) - true_force).powi(2);
            after += (row(&values, j) - true_force).powi(2);
            size += true_force.powi(2);
        }
    }
    [before, after].map(|error| f64::sqrt(error / size))
}

fn robots(folder: &Path) -> [InterpretedRobot; 2] {
    fs::write(folder.join("feet.toml"), described()).unwrap();
    fs::write(folder.join("truth.toml"), TRUTH).unwrap();
    ["feet.toml", "truth.toml"].map(|name| robot(&folder.join(name)))
}

fn fit(folder: &Path, described: &InterpretedRobot, log: &Recorded) -> (Estimate, Vec<String>) {
    let path = folder.join("log.csv");
    fs::write(&path, &log.text).unwrap();
    let settings = IdentificationSettings::new().unwrap();
    let found = identify(described, &[path], &settings, &mut |_| ()).unwrap();
    (found.estimate, found.recording.columns)
}

#[test]
fn the_rows_of_the_base_alone_tell_what_its_forces_are() {
    let folder = tempfile::tempdir().unwrap();
    let [described, truth] = robots(folder.path());
    let (found, said) = fit(folder.path(), &described, &record(&truth, 20.0, 0, false));
    let [before, after] = base_errors(&described, &truth, &found);
    println!("base rows alone: {before:.4} as described, {after:.4} as estimated");
    assert!(before > 0.1 && after < 0.01, "{before} {after}");
    assert!(found.joints[..6].iter().all(|joint| joint.measured && joint.exact));
    assert!(found.joints[6..].iter().all(|joint| !joint.measured && joint.terms.is_empty()));
    assert!(said.iter().any(|line| line.starts_with("the log has no efforts of the joints")), "{said:?}");
}

/// Neither torques nor forces at the feet: what would be enough is said, by what the description has.
#[test]
fn logs_without_any_force_are_refused_with_what_is_enough() {
    let folder = tempfile::tempdir().unwrap();
    let [feet, truth] = robots(folder.path());
    let path = folder.path().join("log.csv");
    let poses = |line: &str| line.split(',').take(1 + 7 + 12).collect::<Vec<_>>().join(",") + "\n";
    fs::write(&path, record(&truth, 2.0, 0, false).text.lines().map(poses).collect::<String>()).unwrap();
    let settings = IdentificationSettings::new().unwrap();
    let refused = |robot: &InterpretedRobot| {
        identify(robot, std::slice::from_ref(&path), &settings, &mut |_| ()).unwrap_err().to_string()
    };
    let plain = refused(&robot(&models("go2.toml")));
    for words in [
        "the efforts of FL_hip",
        "the six equations of the base `base` are enough",
        "[[inputs]]",
        "ratios of masses",
    ] {
        assert!(plain.contains(words), "{words}: {plain}");
    }
    let measured = refused(&feet);
    for words in ["the efforts of FL_foot_fx", "It does not need efforts of the joints"] {
        assert!(measured.contains(words), "{words}: {measured}");
    }
}

#[test]
fn torques_of_the_joints_tell_more() {
    let folder = tempfile::tempdir().unwrap();
    let [described, truth] = robots(folder.path());
    let (found, _) = fit(folder.path(), &described, &record(&truth, 20.0, 0, true));
    let [before, after] = base_errors(&described, &truth, &found);
    println!("all rows: {before:.4} as described, {after:.4} as estimated");
    assert!(before > 0.1 && after < 0.01, "{before} {after}");
    for joint in &found.joints {
        assert!(
            joint.measured && joint.held_out_r_squared > 0.95,
            "{} {}",
            joint.name,
            joint.held_out_r_squared
        );
    }
}

/// Nothing is known of the legs' torques, in any log: their rows are in no sum.
#[test]
fn moments_hold_the_rows_of_the_base_alone() {
    let folder = tempfile::tempdir().unwrap();
    let [described, truth] = robots(folder.path());
    let path = folder.path().join("log.csv");
    fs::write(&path, record(&truth, 20.0, 0, false).text).unwrap();
    let settings = IdentificationSettings::new().unwrap();
    let parts: &[&[u8]] = &[b"feet"];
    let moments = reduce(&described, parts, &path, &settings, &mut |_| ()).unwrap();
    let file = folder.path().join("log.moments");
    moments.write(parts, &file).unwrap();
    let copied = LogMoments::read(&file).unwrap();
    let found = identify_moments(&described, parts, &copied, &settings, &mut |_| ()).unwrap().estimate;
    let [before, after] = base_errors(&described, &truth, &found);
    println!("moments of base rows alone: {before:.4} as described, {after:.4} as estimated");
    assert!(before > 0.1 && after < 0.01, "{before} {after}");
    assert!(found.joints[6..].iter().all(|joint| !joint.measured && joint.terms.is_empty()));
    assert!(
        found.findings.iter().any(|finding| finding.sentence().contains("_calf: it has no measured effort")),
        "{:?}",
        found.findings
    );
}
