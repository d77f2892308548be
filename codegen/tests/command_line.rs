//! The program `gelenk` from outside: help, messages, exit codes.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::model::{self, FrictionTerm, Model, ReadOptions};
use gelenk_identification::robot::Robot;

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gelenk")).args(arguments).current_dir(folder).output().unwrap()
}

fn shown(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!(
        "exit {}\n--- stdout\n{}--- stderr\n{}",
        output.status.code().unwrap(),
        text(&output.stdout),
        text(&output.stderr)
    )
}

#[test]
fn help_of_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("help", vec!["--help"]),
        ("help_generate", vec!["generate", "--help"]),
        ("help_check", vec!["check", "--help"]),
        ("help_inspect", vec!["inspect", "--help"]),
        ("help_new", vec!["new", "--help"]),
        ("help_report", vec!["report", "--help"]),
        ("help_identify", vec!["identify", "--help"]),
        ("help_export", vec!["export", "--help"]),
    ] {
        insta::assert_snapshot!(name, shown(&gelenk(folder.path(), &arguments)));
    }
}

#[test]
fn wrong_command_lines_end_with_2() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("unknown_command", vec!["generat"]),
        ("unknown_option", vec!["generate", "arm.urdf", "--snap-angle", "1"]),
        ("large_angle", vec!["generate", "arm.urdf", "--snap-angles", "1"]),
        ("no_workspace", vec!["generate"]),
        ("output_of_nothing", vec!["generate", "--output", "a.rs"]),
        ("latex_of_counts", vec!["inspect", "counts", "arm.urdf", "--latex"]),
    ] {
        let output = gelenk(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        insta::assert_snapshot!(name, shown(&output));
    }
}

#[test]
fn a_missing_description_ends_with_1_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["generate", "none.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("none.toml"));
    assert!(output.stdout.is_empty());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn diagnostics_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["generate", "none.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(1));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["diagnostics"][0]["severity"], "error");
}

const GRIPPER: &str = r#"<robot name="gripper">
  <link name="base"/>
  <link name="left"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <link name="right"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <joint name="left &quot;finger&quot;" type="prismatic"><parent link="base"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.2"/></joint>
  <joint name="right finger" type="prismatic"><parent link="base"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.2"/>MIMIC</joint>
</robot>
"#;

/// The description of the new crate builds on a copy of the URDF, can be generated, and stays so with its
/// hints made true.
#[test]
fn a_new_crate_has_the_robot_of_a_urdf() {
    let mimic = r#"<mimic joint="left &quot;finger&quot;"/>"#;
    let friction = r#"<dynamics damping="1" friction="0.5"/>"#;
    for (name, mimic) in [("two", ""), ("coupled", mimic), ("dry", friction)] {
        let folder = tempfile::tempdir().unwrap();
        let urdf = GRIPPER.replace("MIMIC", mimic);
        fs::write(folder.path().join("gripper.urdf"), &urdf).unwrap();
        let made = gelenk(folder.path(), &["new", name, "--urdf", "gripper.urdf"]);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));

        let home = folder.path().join(name);
        assert_eq!(fs::read_to_string(home.join("robot.urdf")).unwrap(), urdf);
        let build = fs::read_to_string(home.join("build.rs")).unwrap();
        assert_eq!(build.contains("\n        .control_model(50.0)"), name == "dry");
        let text = fs::read_to_string(home.join("robot.toml")).unwrap();
        assert_eq!(text.contains("<mimic>"), name == "coupled");
        let done = ["[[joints]]", "name = ", "friction = ", "drive = "]
            .iter()
            .fold(text.clone(), |text, key| text.replace(&format!("\n# {key}"), &format!("\n{key}")));
        assert_eq!(done.matches("\ndrive = ").count(), if name == "coupled" { 1 } else { 2 });
        for description in [text.clone(), done] {
            fs::write(home.join("robot.toml"), description).unwrap();
            let generated = gelenk(&home, &["generate", "robot.toml"]);
            assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
            assert!(home.join("robot.rs").is_file());
        }
    }
}

const HINGES: &str = r#"<mujoco><worldbody><body name="upper" pos="0 0 1">
  <joint name="shoulder" axis="0 1 0" damping="0.1"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".05"/>
  <body name="lower" pos="0 0 -.5"><joint name="el&quot;bow" axis="0 1 0"/><geom size=".05"/></body></body></worldbody>
  <include file="parts/motors.xml"/></mujoco>"#;
const MOTORS: &str =
    r#"<mujocoinclude><actuator><motor joint="shoulder" gear="50"/></actuator></mujocoinclude>"#;

/// The files lie in their places in the new crate, which has the robot and stays so with its hints made true.
#[test]
fn a_new_crate_has_the_robot_of_an_mjcf() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    fs::write(folder.path().join("arm.xml"), HINGES).unwrap();
    fs::write(folder.path().join("parts/motors.xml"), MOTORS).unwrap();
    for (name, option) in [("one", "--mjcf"), ("other", "--urdf")] {
        let made = gelenk(folder.path(), &["new", name, option, "arm.xml"]);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
        let home = folder.path().join(name);
        assert_eq!(fs::read_to_string(home.join("robot.xml")).unwrap(), HINGES);
        assert_eq!(fs::read_to_string(home.join("parts/motors.xml")).unwrap(), MOTORS);
        let text = fs::read_to_string(home.join("robot.toml")).unwrap();
        assert!(text.contains("\nextends = \"robot.xml\"\n") && !text.contains("drive"), "{text}");
        let done = ["[[joints]]", "name = ", "friction = "]
            .iter()
            .fold(text.clone(), |text, key| text.replace(&format!("\n# {key}"), &format!("\n{key}")));
        assert_eq!(done.matches("\nfriction = ").count(), 2);
        for (description, viscous) in [(text, "v[0] * 0.1"), (done, "v[0] * 0.4")] {
            fs::write(home.join("robot.toml"), description).unwrap();
            let generated = gelenk(&home, &["generate", "robot.toml", "--functions", "friction_torques"]);
            assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
            let module = fs::read_to_string(home.join("robot.rs")).unwrap();
            assert!(module.contains(viscous), "{module}");
        }
    }
}

/// What nothing moves is no robot for a simulation, and a file elsewhere has no place in the crate.
#[test]
fn a_new_crate_is_not_made_of_an_mjcf_that_it_cannot_move_or_hold() {
    let folder = tempfile::tempdir().unwrap();
    let still = HINGES.replace(r#"<include file="parts/motors.xml"/>"#, "");
    let free = still.replace(r#"<joint name="shoulder" axis="0 1 0" damping="0.1"/>"#, "<freejoint/>");
    let outside = HINGES.replace("parts/", "../");
    fs::create_dir(folder.path().join("robots")).unwrap();
    let taken = HINGES.replace("parts/motors.xml", "build.rs");
    fs::write(folder.path().join("motors.xml"), MOTORS).unwrap();
    fs::write(folder.path().join("robots/build.rs"), MOTORS).unwrap();
    for (text, message) in [
        (still, "has no motor at `shoulder`, `el\"bow`; the program of a new crate moves one joint at least"),
        (
            free,
            "has no motor at `el\"bow`; the program of a new crate moves each joint of a robot whose base floats",
        ),
        (outside, "which cannot lie at the same place in the new crate"),
        (taken, "the MJCF includes build.rs, and the project has a file of that name"),
    ] {
        fs::write(folder.path().join("robots/arm.xml"), text).unwrap();
        let refused = gelenk(folder.path(), &["new", "arm", "--mjcf", "robots/arm.xml"]);
        assert_eq!(refused.status.code(), Some(2), "{}", shown(&refused));
        assert!(shown(&refused).contains(message), "{}", shown(&refused));
        assert!(!folder.path().join("arm").exists());
    }
}

/// With a free base the description says so, and its hints make propellers of the links at the ends.
#[test]
fn a_new_crate_has_a_robot_that_floats() {
    let folder = tempfile::tempdir().unwrap();
    let massless = GRIPPER.replace("MIMIC", "");
    fs::write(folder.path().join("massless.urdf"), &massless).unwrap();
    let refused = gelenk(folder.path(), &["new", "none", "--urdf", "massless.urdf", "--base", "floating"]);
    assert_eq!(refused.status.code(), Some(1), "{}", shown(&refused));
    let body = r#"<link name="base"><inertial><mass value="2"/><inertia ixx="1e-2" ixy="0" ixz="0" iyy="1e-2" iyz="0" izz="1e-2"/></inertial></link>"#;
    let urdf = massless.replace(r#"<link name="base"/>"#, body);
    fs::write(folder.path().join("gripper.urdf"), urdf).unwrap();
    for (name, language) in [("rust", None), ("c", Some("--c")), ("python", Some("--python"))] {
        let mut arguments = vec!["new", name, "--urdf", "gripper.urdf", "--base", "floating"];
        arguments.extend(language);
        let made = gelenk(folder.path(), &arguments);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
        let text = fs::read_to_string(folder.path().join(name).join("robot.toml")).unwrap();
        assert!(text.contains("\nbase = { type = \"floating\" }\n"), "{text}");
    }
    let main = fs::read_to_string(folder.path().join("rust/src/main.rs")).unwrap();
    assert!(main.contains("LtvMpc"), "{main}");
    let home = folder.path().join("rust");
    let text = fs::read_to_string(home.join("robot.toml")).unwrap();
    // Neither the base's own entries are offered, nor others than the two fingers.
    assert_eq!(
        (text.matches("\n# drive = ").count(), text.matches("\n# [[inputs]]").count()),
        (2, 2),
        "{text}"
    );
    let (joints, propellers) = text.split_once("\n# Where a joint carries a propeller").unwrap();
    let propellers: String =
        propellers.split_inclusive('\n').skip(2).map(|line| line.trim_start_matches("# ")).collect();
    for description in [text.clone(), format!("{joints}\n{propellers}")] {
        fs::write(home.join("robot.toml"), description).unwrap();
        let generated = gelenk(&home, &["generate", "robot.toml"]);
        assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
    }
    let module = fs::read_to_string(home.join("robot.rs")).unwrap();
    assert!(module.contains("pub const N: usize = 6;") && module.contains("pub const M: usize = 2;"));
    // Without a URDF it is a quadrotor.
    let made = gelenk(folder.path(), &["new", "drone", "--base", "floating"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    let generated = gelenk(&folder.path().join("drone"), &["generate", "robot.toml"]);
    assert_eq!(generated.status.code(), Some(0), "{}", shown(&generated));
}

#[test]
fn a_new_crate_is_not_made_of_a_file_that_is_no_urdf() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("broken.urdf"), "<robot name=\"r\"><link/></robot>").unwrap();
    fs::write(folder.path().join("arm.toml"), include_str!("../src/cli/template/robot.toml")).unwrap();
    for (file, code, message) in [
        ("none.urdf", 1, "none.urdf"),
        ("broken.urdf", 1, "name"),
        ("arm.toml", 2, "arm.toml is neither URDF nor MJCF"),
    ] {
        let refused = gelenk(folder.path(), &["new", "arm", "--urdf", file]);
        assert_eq!(refused.status.code(), Some(code), "{}", shown(&refused));
        assert!(shown(&refused).contains(message), "{}", shown(&refused));
        assert!(!folder.path().join("arm").exists());
    }
}

#[test]
fn a_new_crate_is_made_once_and_only_under_a_good_name() {
    let folder = tempfile::tempdir().unwrap();
    let made = gelenk(folder.path(), &["new", "my-arm", "--format", "json"]);
    assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    let said: serde_json::Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!(said["package"], "my-arm");
    for file in said["files"].as_array().unwrap() {
        assert!(folder.path().join("my-arm").join(file.as_str().unwrap()).is_file(), "{file}");
    }
    for (arguments, code, message) in [
        (vec!["new", "my-arm"], 1, "my-arm exists already"),
        (vec!["new", "2nd"], 2, "must begin with a letter"),
        (vec!["new", "a b"], 2, "letters from a to z"),
        (vec!["new", "fn"], 2, "a word of Rust"),
        (vec!["new", ".."], 2, "does not end in a name"),
        (vec!["new", "other", "--git", "git@host:a/b"], 2, "ssh://git@host/a/b"),
        (vec!["new", "other", "--version", "newest"], 2, "is no version"),
        (vec!["new", "my-arm/robot.toml/arm"], 1, "choose a folder in which you may write"),
        (vec!["new", "other", "--checkout", "."], 1, "no checkout of gelenk"),
        (vec!["new", "other", "--git", "x", "--version", "1"], 2, "cannot be used with"),
    ] {
        let refused = gelenk(folder.path(), &arguments);
        assert_eq!(refused.status.code(), Some(code), "{}", shown(&refused));
        let stderr = String::from_utf8_lossy(&refused.stderr);
        assert!(stderr.contains(message), "{stderr}");
    }
    // Nothing is left behind by what was refused.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let made = gelenk(folder.path(), &["new", "elsewhere", "--git", "https://example.org/gelenk.git"]);
    assert_eq!(made.status.code(), Some(0));
    let manifest = fs::read_to_string(folder.path().join("elsewhere/Cargo.toml")).unwrap();
    assert_eq!(manifest.matches("git = \"https://example.org/gelenk.git\"").count(), 2);
}

/// A pendulum: small enough that its page is made in no time.
const PENDULUM: &str = "[[joints]]\nname = \"swing\"\naxis = [0, 1, 0]\ndrive = \"ideal\"\nfriction = \"0.1*v + 0.2*sign(v)\"\n\
    [[bodies]]\nlink = \"swing\"\nmass = 1\ncenter_of_mass = [0, 0, -0.5]\n";

#[test]
fn a_page_and_its_numbers_are_written() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("pendulum.toml"), PENDULUM).unwrap();
    let output = gelenk(folder.path(), &["report", "pendulum.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["files"][0], "report/pendulum/index.html");
    for check in said["self_check"].as_array().unwrap() {
        assert_eq!(check["verdict"], "holds", "{check}");
    }
    let read = |name: &str| fs::read_to_string(folder.path().join("report/pendulum").join(name)).unwrap();
    let data: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(data["title"], "The robot pendulum");
    assert!(read("index.html").contains("gelenk report pendulum.toml"));
    assert!(read("bodies.csv").starts_with("body,link,mass [kg],c_x [m]"), "{}", read("bodies.csv"));
    // Choices that change the equations are those of `generate`, and stand at the foot of the page.
    let smooth = ["report", "pendulum.toml", "--smooth-sign", "80", "--output", "smooth"];
    assert_eq!(gelenk(folder.path(), &smooth).status.code(), Some(0));
    let smooth = fs::read_to_string(folder.path().join("smooth/report.json")).unwrap();
    assert!(smooth.contains(r"\\tanh\\left(80"), "{smooth}");
    assert!(smooth.contains("gelenk report pendulum.toml --smooth-sign 80.0"));
    // The same description, the same bytes.
    let first = read("index.html");
    gelenk(folder.path(), &["report", "pendulum.toml", "--output", "again"]);
    assert_eq!(first, fs::read_to_string(folder.path().join("again/index.html")).unwrap());
}

#[test]
fn a_page_that_cannot_be_written_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("pendulum.toml"), PENDULUM).unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    let output = gelenk(folder.path(), &["report", "pendulum.toml", "--output", "taken"]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("cannot write taken") && said.contains("--output FOLDER"), "{said}");
    let output = gelenk(folder.path(), &["report", "none.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.path().join("report").exists());
}

/// Exit code and standard error of a command that is refused.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = gelenk(folder, arguments);
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What was read, and what was not generated, is never written over.
#[test]
fn descriptions_and_foreign_files_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("base.toml"), PENDULUM).unwrap();
    let extension = "extends = \"base.toml\"\n";
    fs::write(at("arm.toml"), extension).unwrap();
    fs::write(at("main.rs"), "fn main() {}\n").unwrap();
    fs::write(at("empty.rs"), "").unwrap();
    let generate = |output: &str| refused(folder.path(), &["generate", "arm.toml", "-o", output]);
    for output in ["arm.toml", "./arm.toml", "base.toml"] {
        let said = generate(output);
        assert!(said.contains("read"), "{said}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("arm.toml", at("symbolic.rs")).unwrap();
        fs::hard_link(at("base.toml"), at("hard.rs")).unwrap();
        let said = generate("symbolic.rs");
        assert!(said.contains("symbolic.rs: it is arm.toml, which was read"), "{said}");
        let said = generate("hard.rs");
        assert!(said.contains("hard.rs: it is base.toml, which was read"), "{said}");
    }
    let said = generate("main.rs");
    assert!(said.contains("main.rs: it holds what gelenk has not generated"), "{said}");
    fs::write(at("arm.rs"), "fn mine() {}\n").unwrap();
    let said = generate(".");
    assert!(said.contains("arm.rs: it holds what gelenk has not generated"), "{said}");
    // A name without an ending is a folder that is made.
    assert!(gelenk(folder.path(), &["generate", "arm.toml", "-o", "src"]).status.success());
    assert!(at("src/arm.rs").is_file());
    // The smooth module of a pair is written to a name that nobody gave.
    fs::write(at("new_control.rs"), "fn mine() {}\n").unwrap();
    let pair = ["generate", "arm.toml", "-o", "new.rs", "--control-model", "50"];
    let said = refused(folder.path(), &pair);
    assert!(said.contains("new_control.rs: it holds"), "{said}");
    assert!(!at("new.rs").exists(), "one of two was written");
    for (file, text) in [("base.toml", PENDULUM), ("arm.toml", extension), ("main.rs", "fn main() {}\n")] {
        assert_eq!(fs::read_to_string(at(file)).unwrap(), text);
    }
    for output in ["empty.rs", "new.rs", "new.rs"] {
        let made = gelenk(folder.path(), &["generate", "arm.toml", "-o", output]);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    }
}

/// A folder that looks like a workspace may have a crate root of its own.
#[test]
fn a_foreign_crate_root_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["models", "generated/src"] {
        fs::create_dir_all(at(name)).unwrap();
    }
    fs::write(at("models/pendulum.toml"), PENDULUM).unwrap();
    fs::write(at("generated/src/lib.rs"), "pub mod mine;\n").unwrap();
    for arguments in [&["generate"][..], &["generate", "models/pendulum.toml"]] {
        let said = refused(folder.path(), arguments);
        assert!(said.contains("lib.rs: it holds"), "{said}");
        assert!(!at("generated/src/pendulum.rs").exists());
    }
    assert_eq!(fs::read_to_string(at("generated/src/lib.rs")).unwrap(), "pub mod mine;\n");
}

/// The exact model and the smooth one, in one command; `check` knows both.
#[test]
fn a_plant_and_a_controller_have_models_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let smooth = format!("{PENDULUM}[generate]\nsmooth_sign = 5\n");
    fs::write(folder.path().join("pendulum.toml"), smooth).unwrap();
    let pair = ["pendulum.toml", "--control-model", "50", "--output", "arm.rs"];
    let run = |command: &str| {
        let output = gelenk(folder.path(), &[&[command], &pair[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    };
    run("generate");
    run("check");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (exact, smooth) = (read("arm.rs"), read("arm_control.rs"));
    assert!(exact.contains("The exact model, for plants."), "{exact}");
    assert!(!exact.contains("math::tanh(") && exact.contains("sign(v[0])"));
    assert!(smooth.contains("tanh(50 v) stands for the sign(v) of pendulum"));
    assert!(smooth.contains("v[0] * 50.0") && smooth.contains("tanh("), "{smooth}");
    fs::remove_file(folder.path().join("arm_control.rs")).unwrap();
    let stale = refused(folder.path(), &[&["check"], &pair[..]].concat());
    assert!(stale.contains("missing: arm_control.rs"), "{stale}");
    let piped = ["generate", "pendulum.toml", "--control-model", "50", "-o", "-"];
    assert_eq!(gelenk(folder.path(), &piped).status.code(), Some(2));
}

/// On a full disk the old page and the old module stay as they were. A limit on the size of files stands for
/// the disk.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("pendulum.toml"), PENDULUM).unwrap();
    let commands = ["report pendulum.toml", "generate pendulum.toml"];
    for command in commands {
        let words: Vec<&str> = command.split(' ').collect();
        assert_eq!(gelenk(folder.path(), &words).status.code(), Some(0));
    }
    let files = || {
        let mut files = Vec::new();
        for folder in [folder.path().to_owned(), at("report/pendulum")] {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let content = fs::read(&path).unwrap_or_default();
                files.push((path, content));
            }
        }
        files.sort();
        files
    };
    fs::write(at("pendulum.toml"), PENDULUM.replace("mass = 1", "mass = 2")).unwrap();
    let before = files();
    for command in commands {
        // The signal of the limit is ignored, so that writing fails as on a full disk.
        let script = format!("trap '' XFSZ; ulimit -f 8; exec \"$0\" {command}");
        let output = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_gelenk")])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
        assert!(shown(&output).contains("cannot write"), "{}", shown(&output));
        assert_eq!(files(), before, "{command}");
    }
    // What is meant to stay is not replaced either.
    let mut rights = fs::metadata(at("pendulum.rs")).unwrap().permissions();
    rights.set_readonly(true);
    fs::set_permissions(at("pendulum.rs"), rights).unwrap();
    let said = refused(folder.path(), &["generate", "pendulum.toml"]);
    assert!(said.contains("pendulum.rs: it is read-only"), "{said}");
    assert_eq!(files(), before);
}

#[cfg(not(feature = "symbolica"))]
#[test]
fn closed_forms_say_what_they_need() {
    let folder = tempfile::tempdir().unwrap();
    let output = gelenk(folder.path(), &["inspect", "--closed-form", "arm.urdf"]);
    insta::assert_snapshot!(shown(&output));
}

/// What stands in front of a derivation, with the numbers of a real arm.
#[test]
fn mechanism_of_the_powercube() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let output = gelenk(&models, &["inspect", "mechanism", "powercube.toml"]);
    insta::assert_snapshot!(shown(&output));
}

/// The vendor's 1.57079632679 is noted with the operations that taking it for π/2 saves, and those are the
/// snapped ones.
#[test]
fn snapping_is_priced() {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/urdf");
    let count = |options: &[&str]| {
        let arguments =
            [&["inspect", "counts", "ur5.urdf", "--functions", "inverse_dynamics"], options].concat();
        let output = gelenk(&urdf, &arguments);
        let table = String::from_utf8_lossy(&output.stdout).into_owned();
        let row = table.lines().nth(1).unwrap_or_default();
        let cells: Vec<&str> = row.split_whitespace().skip(1).take(2).collect();
        (cells.join("/"), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (described, notes) = count(&[]);
    let (snapped, none) = count(&["--snap-angles", "1e-4"]);
    assert_ne!(described, snapped);
    let price = format!("`inverse_dynamics` {snapped} instead of {described}");
    assert!(notes.contains(&price), "{price} is not in {notes}");
    assert!(!none.contains("instead of"), "{none}");
}

#[test]
fn a_closed_pipe_is_no_panic() {
    use std::io::Read;
    use std::process::Stdio;
    let mut child = Command::new(env!("CARGO_BIN_EXE_gelenk"))
        .args(["generate", "none.toml", "--format", "json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(stderr, "");
}

const ARM: &str = r#"
name = "arm"
gravity = [0, 0, -9.80665]

[[joints]]
name = "shoulder"
axis = [0, 1, 0]
drive = "ideal"
limits = { position = [-2, 2], velocity = 2, effort = 80 }

[[joints]]
name = "elbow"
axis = [0, 1, 0]
origin = { xyz = [0, 0, 0.5] }
drive = { gear_ratio = 100, rotor_inertia = 5e-5 }
limits = { position = [-2, 2], velocity = 3, effort = 40 }

[[bodies]]
link = "shoulder"
mass = 5
center_of_mass = [0, 0, 0.2]
inertia = [0.1, 0.1, 0.01]

[[bodies]]
link = "elbow"
mass = 3
center_of_mass = [0, 0, 0.2]
inertia = [0.05, 0.05, 0.005]
"#;

/// What the arm really is.
const TRUTH: &str = r#"
name = "truth"
extends = "arm.toml"

[[joints]]
name = "shoulder"
friction = { viscous = 4, coulomb = { value = 3, slope = 20 } }

[[joints]]
name = "elbow"
drive = { gear_ratio = 100, rotor_inertia = 8e-5 }
friction = { viscous = 1.5 }

[[bodies]]
name = "shoulder"
mass = 6
center_of_mass = [0.03, 0, 0.25]

[[bodies]]
name = "elbow"
mass = 2.2
center_of_mass = [0, 0, 0.26]
"#;

/// Torques of a described arm along a plan, friction included, as sensors with noise would log them.
fn simulated_log(folder: &Path, plan: &str) -> String {
    let mut sensors = Noise(1);
    let mut log = String::from("t [s],q_shoulder [rad],q_elbow [rad],tau_shoulder [N m],tau_elbow [N m]\n");
    let truth = described(folder, "truth.toml");
    for row in plan.lines().skip(1) {
        let values: Vec<f64> = row.split(',').map(|value| value.parse().unwrap()).collect();
        let torque = truth.torques(&values[1..3], &values[3..5], &values[5..7]);
        let counts = [values[1], values[2]].map(|q| (q / 1e-5).round() * 1e-5);
        let [shoulder, elbow] = [torque[0] + 0.1 * sensors.next(), torque[1] + 0.1 * sensors.next()];
        log.push_str(&format!("{},{},{},{shoulder:.4},{elbow:.4}\n", values[0], counts[0], counts[1]));
    }
    log
}

/// Seeded numbers between -1 and 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A robot with its friction.
struct Described(InterpretedRobot, Model);

fn described(folder: &Path, file: &str) -> Described {
    let model = model::read(&folder.join(file), &ReadOptions::default()).unwrap().model;
    Described(InterpretedRobot::new(&model).unwrap(), model)
}

impl Described {
    /// Joint torques at a state and an acceleration.
    fn torques(&self, y: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
        let mut torques = vec![0.0; 2];
        self.0.rigid_forces(y, v, a, &mut torques);
        let joints = self.1.joints().zip(v).zip(&mut torques);
        joints.for_each(|((joint, v), torque)| {
            let sum = |terms: &[FrictionTerm]| -> f64 {
                let term = |term: &FrictionTerm| {
                    term.coefficient.evaluate(&[], 0.0, 0.0) * term.basis.evaluate(&[], 0.0, *v)
                };
                terms.iter().map(term).sum()
            };
            *torque += sum(&joint.friction) + torque.abs() * sum(&joint.load_friction);
        });
        torques
    }
}

#[test]
fn a_planned_motion_identifies_what_a_simulated_arm_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("arm.toml"), ARM).unwrap();
    fs::write(at("truth.toml"), TRUTH).unwrap();
    let planned = gelenk(folder.path(), &["identify", "--plan", "arm.toml", "--rate", "200"]);
    assert!(planned.status.success(), "{}", shown(&planned));
    let log = simulated_log(folder.path(), &fs::read_to_string(at("plan.csv")).unwrap());
    fs::write(at("log.csv"), log).unwrap();
    let arguments = ["identify", "arm.toml", "log.csv", "--report", "page", "--format", "json"];
    let identified = gelenk(folder.path(), &arguments);
    assert!(identified.status.success(), "{}", shown(&identified));
    let result: serde_json::Value = serde_json::from_slice(&identified.stdout).unwrap();
    for joint in result["joints"].as_array().unwrap() {
        assert!(joint["r_squared_held_out"].as_f64().unwrap() > 0.999, "{result:#}");
    }
    assert!(at("page/index.html").exists());
    let (arm, truth, found) = (
        described(folder.path(), "arm.toml"),
        described(folder.path(), "truth.toml"),
        described(folder.path(), "arm_identified.toml"),
    );
    let mut noise = Noise(7);
    let [mut before, mut after] = [0.0; 2];
    for _ in 0..200 {
        let [y, v, a] = [1.2, 1.0, 3.0].map(|size| vec![size * noise.next(), size * noise.next()]);
        let [described, true_, found] = [&arm, &truth, &found].map(|robot| robot.torques(&y, &v, &a));
        before += described.iter().zip(&true_).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        after += found.iter().zip(&true_).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    }
    let [before, after] = [before, after].map(|sum| (sum / 400.0).sqrt());
    println!("torques of the description are off by {before} N m rms, of the identified one by {after}");
    assert!(before > 2.0 && after < 0.1);
    // A joint whose efforts cannot be used is named with its row, the other goes on, and the file says so.
    let log = fs::read_to_string(at("log.csv")).unwrap();
    let without = log.lines().enumerate().map(|(i, line)| match (i, line.rsplit_once(',')) {
        (1.., Some((rest, _))) => format!("{rest},0\n"),
        _ => format!("{line}\n"),
    });
    fs::write(at("without.csv"), without.collect::<String>()).unwrap();
    let arguments = ["identify", "arm.toml", "without.csv", "--output", "half.toml", "--report", "half"];
    let half = gelenk(folder.path(), &arguments);
    assert!(half.status.success(), "{}", shown(&half));
    for text in [fs::read_to_string(at("half.toml")).unwrap(), String::from_utf8(half.stdout).unwrap()] {
        assert!(text.contains("its effort is 0 in every row from row 2 on; name other columns"), "{text}");
        assert!(
            text.contains("has no measured effort: its friction, drive and offset stay as described"),
            "{text}"
        );
    }
    // What was noticed in a log is said also where an error follows.
    let (header, rows) = log.split_once('\n').unwrap();
    let first = rows.lines().next().unwrap();
    fs::write(at("repeated.csv"), format!("{header}\n{first}\n{rows}")).unwrap();
    let arguments =
        ["identify", "arm.toml", "repeated.csv", "--validate", "missing.csv", "--output", "x.toml"];
    let failed = gelenk(folder.path(), &arguments);
    let said = String::from_utf8(failed.stderr.clone()).unwrap();
    let place = |words: &str| said.find(words).unwrap_or_else(|| panic!("{words}: {said}"));
    assert!(place("1 samples have the time of the one before") < place("error: missing.csv"), "{said}");
    assert_eq!(failed.status.code(), Some(1));
    // Once more over its own output, never over what was read.
    assert!(gelenk(folder.path(), &["identify", "arm.toml", "log.csv"]).status.success());
    for kept in ["arm.toml", "log.csv"] {
        let refused = gelenk(folder.path(), &["identify", "arm.toml", "log.csv", "--output", kept]);
        assert_eq!(refused.status.code(), Some(1), "{}", shown(&refused));
    }
    assert_eq!(fs::read_to_string(at("arm.toml")).unwrap(), ARM);
}

#[test]
fn friction_under_load_is_identified_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("arm.toml"), ARM).unwrap();
    let friction =
        "friction = { viscous = 1.5, coulomb = { value = 1, slope = 20 }, load = \"0.15*tanh(20*v)\" }";
    fs::write(at("truth.toml"), TRUTH.replace("friction = { viscous = 1.5 }", friction)).unwrap();
    fs::write(at("log.csv"), simulated_log(folder.path(), &motion(1))).unwrap();
    let run = |arguments: &[&str]| {
        let all: Vec<&str> = ["identify", "arm.toml"].iter().chain(arguments).copied().collect();
        let output = gelenk(folder.path(), &all);
        assert!(output.status.success(), "{}", shown(&output));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let plain = run(&["log.csv", "--output", "plain.toml", "--format", "json"]);
    assert!(plain["warnings"].to_string().contains("Say --load-friction"), "{plain:#}");
    assert!(plain["joints"][1]["load_friction"].is_null());
    let found = run(&["log.csv", "--load-friction", "--output", "load.toml", "--format", "json"]);
    let share = &found["joints"][1]["load_friction"]["coefficient"];
    let [value, error] = ["value", "standard_error"].map(|key| share[key].as_f64().unwrap());
    println!("{value} ± {error} of the load is friction, 0.15 is true");
    assert!((value - 0.15).abs() < 4.0 * error && error < 0.015, "{found:#}");
    assert!(found["joints"][1]["friction"].as_str().unwrap().contains("abs(load)"), "{found:#}");
    let text = fs::read_to_string(at("load.toml")).unwrap();
    assert!(text.contains("--load-friction") && text.contains("load = [[\"tanh("), "{text}");
    // The written file is read again, and its torques are nearer to the truth's.
    let truth = described(folder.path(), "truth.toml");
    let mut errors = ["plain.toml", "load.toml"].map(|file| {
        let robot = described(folder.path(), file);
        let mut noise = Noise(7);
        let errors = (0..300).flat_map(|_| {
            let [y, v, a] = [1.0, 1.0, 2.0].map(|size| vec![size * noise.next(), size * noise.next()]);
            let pairs = robot.torques(&y, &v, &a).into_iter().zip(truth.torques(&y, &v, &a));
            pairs.map(|(found, truth)| (found - truth).powi(2)).collect::<Vec<_>>()
        });
        (errors.sum::<f64>() / 600.0).sqrt()
    });
    println!("torques are off by {} N m rms without the load's share, by {} with it", errors[0], errors[1]);
    errors[0] *= 0.5;
    assert!(errors[1] < errors[0], "{errors:?}");
    let refused = ["identify", "arm.toml", "--reduce", "log.csv", "--load-friction", "--output", "x.moments"];
    assert_eq!(gelenk(folder.path(), &refused).status.code(), Some(2));
}

/// A motion as a plan has it: sines with phases of their own.
fn motion(number: u32) -> String {
    let mut plan = String::from("t,q_shoulder,q_elbow,dq_shoulder,dq_elbow,ddq_shoulder,ddq_elbow\n");
    for i in 0..800 {
        let t = 0.01 * f64::from(i);
        let at = |shape: &dyn Fn(f64, f64) -> f64| {
            [[0.6, 1.3, 0.3, 3.7], [0.7, 1.9, 0.25, 4.3]].map(|[a, w, b, u]| {
                let phase = f64::from(number);
                a * shape(w, w * t + phase) + b * shape(u, u * t + 2.0 * phase)
            })
        };
        let [y, v, a] = [at(&|_, x| x.sin()), at(&|w, x| w * x.cos()), at(&|w, x| -w * w * x.sin())];
        plan.push_str(&format!("{t},{},{},{},{},{},{}\n", y[0], y[1], v[0], v[1], a[0], a[1]));
    }
    plan
}

#[test]
fn logs_reduce_to_moments_and_moments_to_a_description() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let succeeds = |arguments: &[&str]| {
        let output = gelenk(folder.path(), arguments);
        assert!(output.status.success(), "{}", shown(&output));
        output
    };
    let refused = |code: i32, arguments: &[&str]| {
        let output = gelenk(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(code), "{}", shown(&output));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    fs::write(at("arm.toml"), ARM).unwrap();
    fs::write(at("truth.toml"), TRUTH).unwrap();
    for number in 1..=3 {
        fs::write(at(&format!("{number}.csv")), simulated_log(folder.path(), &motion(number))).unwrap();
        let (log, moments) = (format!("{number}.csv"), format!("{number}.moments"));
        let output = succeeds(&["identify", "arm.toml", "--reduce", &log, "--output", &moments]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with(&format!("wrote {moments}: 1 log, ")), "{text}");
    }
    // In any order, by a tree, and in one process: the same bytes.
    let bytes = |name: &str| fs::read(at(name)).unwrap();
    succeeds(&["identify", "arm.toml", "--merge", "3.moments", "1.moments", "--output", "two.moments"]);
    succeeds(&["identify", "arm.toml", "--merge", "2.moments", "two.moments", "--output", "tree.moments"]);
    succeeds(&["identify", "arm.toml", "--reduce", "1.csv", "2.csv", "3.csv", "--output", "one.moments"]);
    assert_eq!(bytes("tree.moments"), bytes("one.moments"));
    let merge = |files: &[&str], output: &str| {
        let arguments = ["identify", "arm.toml", "--merge"].iter().chain(files).copied();
        let all: Vec<&str> =
            arguments.chain(["--output", output, "--report", "page", "--format", "json"]).collect();
        serde_json::from_slice::<serde_json::Value>(&succeeds(&all).stdout).unwrap()
    };
    let result = merge(&["1.moments", "2.moments", "3.moments"], "arm_identified.toml");
    let first = bytes("arm_identified.toml");
    merge(&["tree.moments"], "arm_identified.toml");
    assert_eq!(bytes("arm_identified.toml"), first);
    for joint in result["joints"].as_array().unwrap() {
        assert!(joint["r_squared_held_out"].as_f64().unwrap() > 0.99, "{result:#}");
    }
    let page = String::from_utf8(bytes("page/index.html")).unwrap();
    assert!(page.contains("these are moments") && !page.contains("NaN"));
    // The description is one: it reads, and says what the arm is.
    let (arm, truth, found) = (
        described(folder.path(), "arm.toml"),
        described(folder.path(), "truth.toml"),
        described(folder.path(), "arm_identified.toml"),
    );
    let mut noise = Noise(7);
    let [mut before, mut after] = [0.0; 2];
    for _ in 0..200 {
        let [y, v, a] = [1.0, 1.5, 3.0].map(|size| vec![size * noise.next(), size * noise.next()]);
        let [described, true_, found] = [&arm, &truth, &found].map(|robot| robot.torques(&y, &v, &a));
        before += described.iter().zip(&true_).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        after += found.iter().zip(&true_).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    }
    let [before, after] = [before, after].map(|sum| (sum / 400.0_f64).sqrt());
    println!("torques of the description are off by {before} N m rms, of the identified one by {after}");
    assert!(before > 2.0 && after < 0.3);
    // What does not fit is refused.
    fs::write(at("copy.csv"), bytes("1.csv")).unwrap();
    let twice =
        refused(1, &["identify", "arm.toml", "--reduce", "1.csv", "copy.csv", "--output", "x.moments"]);
    assert!(twice.contains("1.csv") && twice.contains("copy.csv"), "{twice}");
    let twice = refused(1, &["identify", "arm.toml", "--merge", "1.moments", "two.moments"]);
    assert!(
        twice.contains("1.moments") && twice.contains("two.moments") && twice.contains("1.csv"),
        "{twice}"
    );
    let other = refused(1, &["identify", "truth.toml", "--merge", "1.moments", "--output", "x.toml"]);
    assert!(other.contains("another description"), "{other}");
    let log = refused(1, &["identify", "arm.toml", "--merge", "1.csv", "--output", "x.toml"]);
    assert!(log.contains("holds no moments"), "{log}");
    let kept = refused(1, &["identify", "arm.toml", "--merge", "1.moments", "--output", "1.moments"]);
    assert!(kept.contains("not written over"), "{kept}");
    fs::write(at("arm.toml"), ARM.replace("mass = 5", "mass = 5.5")).unwrap();
    let changed = refused(1, &["identify", "arm.toml", "--merge", "1.moments", "--output", "x.toml"]);
    assert!(changed.contains("another state of its files"), "{changed}");
    // Usage.
    for arguments in [
        vec!["identify", "arm.toml", "--reduce", "1.csv"],
        vec!["identify", "arm.toml", "--reduce", "1.csv", "--output", "x.toml"],
        vec!["identify", "arm.toml", "--merge", "1.moments", "--delay", "0"],
        vec!["identify", "arm.toml", "--merge", "1.moments", "--output", "x.moments", "--report", "page"],
        vec!["identify", "arm.toml", "--merge", "--reduce", "1.moments", "--output", "x.moments"],
    ] {
        refused(2, &arguments);
    }
    assert!(!at("x.moments").exists() && !at("x.toml").exists());
}

/// The file is written anew over one of its own, and over nothing else.
#[test]
fn an_export_writes_over_exports_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("arm.toml"), include_str!("../src/cli/template/robot.toml")).unwrap();
    fs::write(path("mine.xml"), "<mujoco/>\n").unwrap();
    let export = |words: &[&str]| gelenk(folder.path(), &[&["export", "arm.toml"], words].concat());
    for format in ["--mjcf", "--urdf"] {
        let output = ["out", &format[2..]].join(".");
        for said in ["wrote", "unchanged"] {
            let done = export(&[format, "--output", &output]);
            assert_eq!(done.status.code(), Some(0), "{}", shown(&done));
            assert!(shown(&done).contains(said), "{}", shown(&done));
        }
        fs::write(path(&output), fs::read_to_string(path(&output)).unwrap() + "<!-- older -->").unwrap();
        assert!(shown(&export(&[format, "--output", &output])).contains("wrote"));
        for (file, why) in [("mine.xml", "has not generated"), ("arm.toml", "was read from it")] {
            let before = fs::read(path(file)).unwrap();
            let refused = export(&[format, "--output", file]);
            assert_eq!(refused.status.code(), Some(1), "{}", shown(&refused));
            assert!(shown(&refused).contains(why), "{}", shown(&refused));
            assert_eq!(fs::read(path(file)).unwrap(), before);
        }
    }
    for words in [&[][..], &["--mjcf", "--urdf"]] {
        assert_eq!(export(words).status.code(), Some(2));
    }
    let described = fs::read_to_string(path("arm.toml")).unwrap();
    // A motor of 0.4 N m behind a gear of 50 gives 20 N m, whatever the joint bears.
    fs::write(path("arm.toml"), described.replace("effort = 20", "effort = 90")).unwrap();
    let exported = String::from_utf8(export(&["--urdf", "--output", "-"]).stdout).unwrap();
    assert!(exported.contains("effort=\"20\""), "{exported}");
    let driven = "name = \"shoulder\"\nmotion = \"driven\"\n";
    fs::write(
        path("arm.toml"),
        described.replacen("name = \"shoulder\"\n", driven, 1).replacen("drive =", "# drive =", 1),
    )
    .unwrap();
    let refused = export(&["--mjcf"]);
    assert!(
        shown(&refused).contains("a robot is not exported where joints are driven"),
        "{}",
        shown(&refused)
    );
}
