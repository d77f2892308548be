//! `gelenk new --base floating` and the example `floating_crate` as `codegen/docs/floating.md` shows them: from the URDF of a
//! robot with four legs or propellers to a simulated, controlled robot.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_tests::cargo::{aloud, cargo, lock_like_here, success, text};
use gelenk_tests::packages::use_published;
use gelenk_tests::python::program;

#[path = "../../codegen/examples/floating_crate/parts/mod.rs"]
mod parts;

/// A body with four arms, each with a joint at its end: propellers, or lower legs.
fn urdf(axis: &str, limit: &str) -> String {
    let inertial = |mass: f64, inertia: f64, z: f64| {
        format!(
            "<inertial><origin xyz=\"0 0 {z}\"/><mass value=\"{mass}\"/><inertia ixx=\"{inertia}\" ixy=\"0\" ixz=\"0\" \
             iyy=\"{inertia}\" iyz=\"0\" izz=\"{inertia}\"/></inertial>"
        )
    };
    let mut urdf = format!("<robot name=\"four\"><link name=\"body\">{}</link>", inertial(1.5, 0.03, 0.0));
    for (k, [x, y]) in [[0.13, -0.22], [-0.13, 0.2], [0.13, 0.22], [-0.13, -0.2]].into_iter().enumerate() {
        let _ = write!(
            urdf,
            "<link name=\"rotor_{k}\">{}</link><joint name=\"rotor_{k}_joint\" type=\"revolute\"><parent link=\"body\"/>\
             <child link=\"rotor_{k}\"/><origin xyz=\"{x} {y} 0.02\"/><axis xyz=\"{axis}\"/>{limit}</joint>",
            inertial(0.05, 2e-4, -0.05)
        );
    }
    urdf + "</robot>\n"
}

/// A trunk with four legs of three joints and a foot, and a head on one joint.
fn legs() -> String {
    let link = |name: &str, mass: f64, z: f64| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0 0 {z}\"/><mass value=\"{mass}\"/><inertia ixx=\"{0}\" ixy=\"0\" \
             ixz=\"0\" iyy=\"{0}\" iyz=\"0\" izz=\"{0}\"/></inertial></link>",
            0.004 * mass
        )
    };
    let joint = |parent: &str, child: &str, kind: &str, xyz: &str, axis: &str, range: [f64; 2]| {
        format!(
            "<joint name=\"{child}_joint\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{xyz}\"/><axis xyz=\"{axis}\"/><limit lower=\"{}\" upper=\"{}\" effort=\"40\" velocity=\"20\"/></joint>",
            range[0], range[1]
        )
    };
    let mut urdf = format!("<robot name=\"dog\">{}", link("body", 9.0, 0.0));
    urdf += &[link("head", 0.5, 0.05), joint("body", "head", "revolute", "0.3 0 0.1", "0 1 0", [-1.0, 1.0])]
        .concat();
    for (leg, x, y) in [("fl", 0.2, 0.1), ("fr", 0.2, -0.1), ("rl", -0.2, 0.1), ("rr", -0.2, -0.1)] {
        let [hip, thigh, shank, heel, foot] =
            ["hip", "thigh", "shank", "heel", "foot"].map(|part| format!("{leg}_{part}"));
        urdf += &[link(&hip, 0.6, 0.0), link(&thigh, 1.0, -0.05), link(&shank, 0.2, -0.1)].concat();
        urdf += &[link(&heel, 0.01, 0.0), link(&foot, 0.05, 0.0)].concat();
        urdf += &joint("body", &hip, "revolute", &format!("{x} {y} 0"), "1 0 0", [-0.8, 0.8]);
        urdf += &joint(&hip, &thigh, "revolute", &format!("0 {} 0", 0.8 * y), "0 1 0", [-1.0, 3.0]);
        urdf += &joint(&thigh, &shank, "revolute", "0 0 -0.2", "0 1 0", [-2.7, -0.7]);
        urdf += &joint(&shank, &heel, "fixed", "0.01 0 -0.1", "0 1 0", [0.0; 2]);
        urdf += &joint(&shank, &foot, "fixed", "0 0 -0.2", "0 1 0", [0.0; 2]);
    }
    urdf + "</robot>\n"
}

/// The crate of a URDF, on the packages that a registry would have.
fn new(folder: &Path, name: &str, urdf: &str) -> PathBuf {
    let (file, made) = (folder.join(format!("{name}.urdf")), folder.join(name));
    fs::write(&file, urdf).expect("written");
    let mut new = Command::new(program());
    new.arg("new").arg(&made).arg("--urdf").arg(&file).args(["--base", "floating"]);
    new.args(["--version", env!("CARGO_PKG_VERSION")]);
    success(&new.output().expect("the program starts"));
    use_published(&made);
    lock_like_here(&made);
    made
}

/// Adds legs or propellers to the crate.
fn with_parts(made: PathBuf) -> PathBuf {
    let added = parts::add(&made, &[]);
    assert!(added.is_ok(), "{added:?}");
    made
}

/// The second column: how far the robot is from where it should be.
fn distances(printed: &str) -> Vec<f64> {
    let second = |line: &str| line.split_whitespace().nth(1)?.parse().ok();
    printed.lines().skip(2).filter_map(second).collect()
}

fn run(made: &Path) -> String {
    let build = aloud(made, &["build"]);
    success(&build);
    let said = text(&build.stderr);
    // A propeller's joint in a URDF has limits that are none.
    let warnings =
        said.lines().filter(|line| line.contains("warning") && !line.contains("limits that are 0"));
    assert_eq!(warnings.count(), 0, "{said}");
    success(&cargo(made, &["run"]))
}

/// Its legs are found, and neither the head nor the heels are taken for them.
#[test]
fn a_quadruped_stands_on_its_feet() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = with_parts(new(folder.path(), "dog", &legs()));
    let description = fs::read_to_string(made.join("robot.toml")).expect("the description");
    let feet: Vec<&str> = description.lines().filter(|line| line.contains("_foot\"")).collect();
    assert_eq!(feet, ["fl", "fr", "rl", "rr"].map(|leg| format!("link = \"{leg}_foot\"")), "{description}");
    let printed = run(&made);
    assert!(printed.starts_with("The robot stands on its feet"), "{printed}");
    let numbers = |line: &str| -> Vec<f64> { line.split_whitespace().flat_map(str::parse).collect() };
    let rows: Vec<Vec<f64>> = printed.lines().map(numbers).filter(|row| row.len() == 4).collect();
    assert_eq!(rows.len(), 16, "{printed}");
    for row in &rows {
        // A controller that follows by feedback of accelerations is off by what a period changes.
        assert!(row[1] < 1e-3 && row[2] > 1.0 && row[3] < 0.6, "{printed}");
    }
}

/// Feet that are named, and names that are none.
#[test]
fn feet_are_named_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let described = |feet: &str| {
        let crates = tempfile::tempdir_in(folder.path()).expect("a folder");
        let made = new(crates.path(), "dog", &legs());
        let feet: Vec<String> = feet.split(',').map(str::to_owned).collect();
        let added = parts::add(&made, &feet);
        added.map(|_| fs::read_to_string(made.join("robot.toml")).expect("the description"))
    };
    let description = described("fl_heel,rr_foot,rl_foot").expect("three feet");
    assert!(description.contains("name = \"foot_0\"\nlink = \"fl_heel\""), "{description}");
    assert_eq!(description.matches("[[wrenches]]").count(), 3);
    for (feet, said) in [
        ("fl_fot,fr_foot,rl_foot", "did you mean `fl_foot`"),
        ("fl_foot,fl_heel,rl_foot", "are on the same leg"),
        ("fl_foot,fr_foot", "3 feet or more"),
        ("head,fr_foot,rl_foot", "the leg of `head` has 1 of the 3 joints"),
    ] {
        let message = described(feet).expect_err(feet);
        assert!(message.contains(said), "{feet}: {message}");
    }
}

/// Propellers on fixed joints, as in many URDFs, and a body alone: links become inputs. An arm has none.
#[test]
fn links_that_are_fixed_to_what_floats_become_propellers() {
    let folder = tempfile::tempdir().expect("a folder");
    let inertial = r#"<inertial><mass value="1"/><inertia ixx="1e-2" ixy="0" ixz="0" iyy="1e-2" iyz="0" izz="1e-2"/></inertial>"#;
    let body = format!("<link name=\"frame\">{inertial}</link>");
    let fixed = |name: &str, inertial: &str, origin: &str| {
        format!(
            "<link name=\"{name}\">{inertial}</link><joint name=\"{name}_joint\" type=\"fixed\"><parent link=\"frame\"/>\
             <child link=\"{name}\"/><origin {origin}/></joint>"
        )
    };
    let parts = [
        fixed("left", inertial, r#"xyz="0 0.1 0""#),
        fixed("right", inertial, r#"xyz="0 -0.1 0" rpy="3.141592653589793 0 0""#),
        fixed("imu", "", r#"xyz="0 0 0""#),
    ];
    for (name, links, inputs) in [
        ("propellers", parts.concat(), vec!["left: 0, 0, 1, 0, 0, -0.016", "right: 0, 0, -1, 0, 0, -0.016"]),
        ("alone", String::new(), vec!["frame: 0, 0, 1, 0, 0, 0.016"]),
    ] {
        let urdf = format!("<robot name=\"r\">{body}{links}</robot>");
        let made = with_parts(new(folder.path(), name, &urdf));
        let text = fs::read_to_string(made.join("robot.toml")).expect("the description");
        let of = |key: &str| -> Vec<String> {
            let lines = text.lines().filter_map(|line| line.strip_prefix("# ")?.strip_prefix(key));
            lines.map(|value| value.trim_matches(&['"', '[', ']'][..]).to_owned()).collect()
        };
        let found =
            of("name = ").into_iter().zip(of("wrench = ")).map(|(name, wrench)| format!("{name}: {wrench}"));
        assert_eq!(found.collect::<Vec<_>>(), inputs, "{text}");
        let (head, blocks) = text.split_at(text.find("# [[inputs]]").expect("a block"));
        let description = made.join("robot.toml");
        fs::write(&description, format!("{head}{}", blocks.replace("# ", ""))).expect("written");
        let read = gelenk_codegen::read::read(&description, &gelenk_codegen::read::ReadOptions::default());
        assert_eq!(read.expect("a robot").model.force_inputs.len(), inputs.len());
    }
    let limit = "<limit lower=\"-2\" upper=\"-0.5\" effort=\"20\" velocity=\"20\"/>";
    let made = new(folder.path(), "fingers", &urdf("0 1 0", limit));
    assert!(parts::add(&made, &[]).is_err());
}

#[test]
#[ignore = "builds one more crate, for ten seconds: cargo test -p gelenk-tests --test all new_floating_crate:: -- --ignored"]
fn a_quadruped_falls_with_its_joints_held() {
    let folder = tempfile::tempdir().expect("a folder");
    let limit = "<limit lower=\"-2\" upper=\"-0.5\" effort=\"20\" velocity=\"20\"/>";
    let printed = run(&new(folder.path(), "legs", &urdf("0 1 0", limit)));
    assert!(printed.starts_with("The inputs cannot carry the robot"), "{printed}");
    let distances = distances(&printed);
    assert_eq!(distances.len(), 6);
    // Four joints by 0.2 rad each.
    assert!((distances[0] - 0.4).abs() < 1e-6 && distances[5] < 1e-2, "{printed}");
    let height: f64 =
        printed.lines().last().and_then(|line| line.split_whitespace().last()?.parse().ok()).expect("z");
    assert!((height + 0.5 * 9.81).abs() < 0.3, "it has fallen for a second: {printed}");
}

#[test]
fn a_quadrotor_flies_once_its_propellers_are_inputs() {
    let folder = tempfile::tempdir().expect("a folder");
    let limit = "<limit lower=\"-1e16\" upper=\"1e16\" effort=\"0\" velocity=\"0\"/>";
    let made = with_parts(new(folder.path(), "rotors", &urdf("0 0 1", limit)));
    // As the guide says: the comments of the propellers become lines.
    let description = fs::read_to_string(made.join("robot.toml")).expect("the description");
    let (head, propellers) = description.split_once("\n# Where a joint carries a propeller").expect("hints");
    let (_, propellers) = propellers.split_once("\n\n").expect("blocks");
    let propellers = propellers.replace("# ", "");
    fs::write(made.join("robot.toml"), format!("{head}\n{propellers}\n")).expect("written");
    let printed = run(&made);
    assert!(printed.starts_with("The inputs can carry the robot"), "{printed}");
    let distances = distances(&printed);
    assert_eq!(distances.len(), 21, "{printed}");
    assert!(distances[0] > 0.4 && distances[20] < 0.02, "{printed}");
    // Propellers that all turn the same way, or are too weak.
    for (from, to, why) in [
        ("-0.016", "0.016", "To hold the robot at rest, the inputs lack a force of"),
        ("[0, 8]", "[0, 4]", "To hold the robot at rest, the input rotor_0 must be 4.169"),
    ] {
        fs::write(made.join("robot.toml"), format!("{head}\n{}\n", propellers.replace(from, to)))
            .expect("written");
        let printed = success(&cargo(&made, &["run"]));
        assert!(printed.starts_with("The inputs cannot carry the robot"), "{printed}");
        assert!(printed.contains(why), "{why}: {printed}");
    }
}
