//! A simulated arm whose logs have one fault each.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;

use super::{assert_said, said};

const ARM: &str = r#"
name = "arm"
gravity = [0, 0, -9.81]

[[joints]]
name = "pan"
axis = [0, 0, 1]
limits = { position = [-3, 3], velocity = 3, effort = 150 }

[[joints]]
name = "lift"
axis = [0, 1, 0]
origin = { xyz = [0, 0.1, 0.2] }
limits = { position = [-2, 2], velocity = 3, effort = 150 }

[[joints]]
name = "elbow"
axis = [0, 1, 0]
origin = { xyz = [0, -0.05, 0.42] }
limits = { position = [-2.5, 2.5], velocity = 3, effort = 60 }

[[bodies]]
link = "pan"
mass = 6
center_of_mass = [0, 0.01, 0.1]
inertia = [0.05, 0.05, 0.03]

[[bodies]]
link = "lift"
mass = 5.2
center_of_mass = [0, 0, 0.2]
inertia = [0.09, 0.09, 0.012]

[[bodies]]
link = "elbow"
mass = 2.9
center_of_mass = [0.02, 0, 0.18]
inertia = [0.04, 0.041, 0.005]
"#;

/// Masses that differ from the description by some percent.
const TRUTH: &str = r#"
extends = "arm.toml"

[[bodies]]
name = "lift"
mass = 5.8

[[bodies]]
name = "elbow"
mass = 2.7
"#;

/// The same, mounted at an angle of 25°.
const TILTED: &str = "extends = \"truth.toml\"\ngravity = [4.146, 0, -8.891]\n";

/// Bodies that the description makes 2.4 times too heavy.
const LIGHT: &str = r#"
extends = "arm.toml"

[[bodies]]
name = "pan"
mass = 2.5
inertia = [0.021, 0.021, 0.0125]

[[bodies]]
name = "lift"
mass = 2.17
inertia = [0.0375, 0.0375, 0.005]

[[bodies]]
name = "elbow"
mass = 1.21
inertia = [0.0167, 0.0171, 0.0021]
"#;

/// Viscous and Coulomb friction of each joint.
const FRICTION: [[f64; 2]; 3] = [[9.0, 6.0], [12.0, 8.5], [4.0, 3.1]];
const NAMES: [&str; 3] = ["pan", "lift", "elbow"];

/// Steps of a log at 100 Hz.
const STEPS: usize = 900;

/// Time, positions and efforts of one row.
type Row = (f64, [f64; 3], [f64; 3]);

fn motion(t: f64) -> [[f64; 3]; 3] {
    let at = |shape: fn(f64, f64) -> f64| {
        let wave = |[a, w, b, u]: [f64; 4]| a * shape(w, w * t + b) + 0.4 * a * shape(u, u * t + 2.0 * b);
        [[0.7, 1.9, 0.3, 4.1], [0.5, 1.3, 1.1, 4.7], [0.7, 2.3, 0.6, 5.3]].map(wave)
    };
    [at(|_, x| x.sin()), at(|w, x| w * x.cos()), at(|w, x| -w * w * x.sin())]
}

/// Seeded numbers between -1 and 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Rows of a simulated robot; efforts come late by some seconds.
fn record(folder: &Path, description: &str, late: f64, gravity: bool) -> Vec<Row> {
    let model = read::read(&folder.join(description), &ReadOptions::default()).unwrap().model;
    let robot = InterpretedRobot::new(&model).unwrap();
    let mut noise = Noise(5);
    let row = |i: usize| {
        let t = 0.01 * i as f64;
        let [now, ..] = motion(t);
        let [y, v, a] = motion(t - late);
        let (mut forces, mut weights) = ([0.0; 3], [0.0; 3]);
        robot.rigid_forces(&y, &v, &a, &mut forces);
        robot.rigid_forces(&y, &[0.0; 3], &[0.0; 3], &mut weights);
        let effort = |joint: usize, noise: f64| {
            let [viscous, coulomb] = FRICTION[joint];
            let weight = if gravity { 0.0 } else { weights[joint] };
            forces[joint] - weight + viscous * v[joint] + coulomb * (200.0 * v[joint]).tanh() + 0.15 * noise
        };
        let positions = now.map(|q| (q / 2e-5).round() * 2e-5);
        (t, positions, [0, 1, 2].map(|joint| effort(joint, noise.next())))
    };
    (0..STEPS).map(row).collect()
}

fn written(header: &str, rows: &[Row]) -> String {
    let mut text = format!("{header}\n");
    for (t, [a, b, c], [d, e, f]) in rows {
        writeln!(text, "{t:.5},{a:.5},{b:.5},{c:.5},{d:.4},{e:.4},{f:.4}").unwrap();
    }
    text
}

fn named() -> String {
    let of = |kind: &str| NAMES.map(|name| format!("{name}_{kind}")).join(",");
    format!("time,{},{}", of("position"), of("effort"))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in
        [("arm.toml", ARM), ("truth.toml", TRUTH), ("tilted.toml", TILTED), ("light.toml", LIGHT)]
    {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// Snapshot of what is said of logs, each of them identified by itself.
fn assert_logs(group: &str, folder: &Path, logs: &[(&str, String)]) {
    let write = |(name, text): &(&str, String)| fs::write(folder.join(format!("{name}.csv")), text).unwrap();
    logs.iter().for_each(write);
    let files: Vec<String> = logs.iter().map(|(name, _)| format!("{name}.csv")).collect();
    let commands: Vec<(&str, Vec<&str>)> = logs
        .iter()
        .zip(&files)
        .map(|((name, _), file)| (*name, vec!["arm.toml", file, "--output", "found.toml"]))
        .collect();
    assert_said(group, &said(folder, &commands));
}

/// The recorded rows, each changed.
fn changed(rows: &[Row], change: impl Fn(usize, &mut Row)) -> Vec<Row> {
    let mut rows = rows.to_vec();
    rows.iter_mut().enumerate().for_each(|(i, row)| change(i, row));
    rows
}

/// Efforts through a filter of first order at 2.4 Hz, there and back.
fn low_passed(rows: &[Row]) -> Vec<Row> {
    let mut rows = rows.to_vec();
    for _ in 0..2 {
        let mut state = rows[0].2;
        for row in &mut rows {
            state = [0, 1, 2].map(|joint| state[joint] + 0.14 * (row.2[joint] - state[joint]));
            row.2 = state;
        }
        rows.reverse();
    }
    rows
}

#[test]
fn rows_that_lie_are_named() {
    let folder = folder();
    let good = record(folder.path(), "truth.toml", 0.0, true);
    let header = named();
    let log = |rows: &[Row]| written(&header, rows);
    let burst = |i: usize, row: &mut Row| row.0 = 0.1 * (i / 10 + 1) as f64 + 2e-5 * (i % 10) as f64;
    let zeroed = |i: usize, row: &mut Row| {
        if i % 70 >= 40 && i % 70 < 43 {
            (row.1, row.2) = ([0.0; 3], [0.0; 3]);
        }
    };
    let spiked = |i: usize, row: &mut Row| {
        if i == 400 {
            row.2[1] = 999_999.0;
        } else if i == 600 {
            row.1[0] += 0.5;
        }
    };
    // Between two gaps a piece of 0.07 s is left.
    let is_lost = |i: &usize| (395..405).contains(i) || (412..422).contains(i);
    let dropped: Vec<Row> =
        (0..STEPS).filter(|i| i % 90 < 80 && i % 300 != 1 && !is_lost(i)).map(|i| good[i]).collect();
    let logs = [
        ("good", log(&good)),
        ("held", log(&changed(&good, |i, row| row.2 = good[i / 10 * 10].2))),
        ("low_passed", log(&low_passed(&good))),
        ("bursts", log(&changed(&good, burst))),
        ("zero_rows", log(&changed(&good, zeroed))),
        ("dropouts", log(&dropped)),
        ("repeated", log(&[&good[..300], &good[299..]].concat())),
        ("dead", log(&changed(&good, |_, row| row.2[0] = 0.0))),
        ("still", log(&changed(&good, |_, row| row.1[0] = 0.3))),
        ("degrees", log(&changed(&good, |_, row| row.1 = row.1.map(f64::to_degrees)))),
        ("spikes", log(&changed(&good, spiked))),
        ("short", log(&good[..20])),
        ("two_joints", written(&header, &good).lines().map(without_elbow).collect()),
    ];
    assert_logs("rows", folder.path(), &logs);
}

/// A line without the columns of the elbow.
fn without_elbow(line: &str) -> String {
    let fields: Vec<&str> = line.split(',').collect();
    format!("{}\n", [0, 1, 2, 4, 5].map(|i| fields[i]).join(","))
}

#[test]
fn efforts_that_the_robot_does_not_explain_are_named() {
    let folder = folder();
    let good = record(folder.path(), "truth.toml", 0.0, true);
    let header = named();
    let log = |rows: &[Row]| written(&header, rows);
    let numbered = "time,position_0,position_1,position_2,effort_0,effort_1,effort_2";
    let exchanged = |order: [usize; 3]| {
        let change = |_: usize, row: &mut Row| {
            (row.1, row.2) = (order.map(|joint| row.1[joint]), order.map(|joint| row.2[joint]));
        };
        written(numbered, &changed(&good, change))
    };
    let logs = [
        ("alphabetic", exchanged([2, 1, 0])),
        ("pan_lift", exchanged([1, 0, 2])),
        ("without_gravity", log(&record(folder.path(), "truth.toml", 0.0, false))),
        ("sign", log(&changed(&good, |_, row| row.2[2] *= -1.0))),
        ("factor", log(&changed(&good, |_, row| row.2[2] *= 2.5))),
        ("hundredths", log(&changed(&good, |_, row| row.2 = row.2.map(|u| 0.01 * u)))),
        ("late", log(&record(folder.path(), "truth.toml", 0.015, true))),
        ("tilted", log(&record(folder.path(), "tilted.toml", 0.0, true))),
        ("light", log(&record(folder.path(), "light.toml", 0.0, true))),
        ("spring", log(&changed(&good, |_, row| row.2[1] += 30.0 * row.1[1]))),
        ("cable", log(&changed(&good, |_, row| row.2[0] += 25.0 * row.1[0]))),
        ("warming_up", log(&changed(&good, |i, row| row.2[0] += 8.0 * i as f64 / STEPS as f64))),
    ];
    assert_logs("efforts", folder.path(), &logs);
}

#[test]
fn moments_and_loads_say_what_was_noticed() {
    let folder = folder();
    let good = record(folder.path(), "truth.toml", 0.0, true);
    let late = record(folder.path(), "truth.toml", 0.02, true);
    let write =
        |name: &str, rows: &[Row]| fs::write(folder.path().join(name), written(&named(), rows)).unwrap();
    write("all.csv", &good);
    write("one.csv", &good[..450]);
    write("two.csv", &[&late[450..700], &late[699..]].concat());
    let sprung = r#"extends = "arm.toml"
joints = [{ name = "lift", spring = { stiffness = 40 } }]"#;
    fs::write(folder.path().join("sprung.toml"), sprung).unwrap();
    let commands = [
        ("reduce", vec!["arm.toml", "--reduce", "one.csv", "two.csv", "--output", "all.moments"]),
        ("merge", vec!["arm.toml", "--merge", "all.moments", "--output", "found.toml"]),
        ("twice", vec!["arm.toml", "one.csv", "one.csv"]),
        ("payload", vec!["arm.toml", "one.csv", "--payload", "two.csv", "--output", "load.toml"]),
        ("stiff", vec!["sprung.toml", "all.csv"]),
        ("plan", vec!["arm.toml", "--plan", "--seconds", "4", "--rate", "50"]),
    ];
    assert_said("moments", &said(folder.path(), &commands));
}
