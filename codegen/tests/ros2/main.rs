//! `gelenk new --ros2`: the controllers compile against declarations of the interfaces that they use, in this folder's words, and compute
//! what the module in C computes.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn gelenk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gelenk")).args(arguments).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes)).concat()
}

/// The command of CMakeLists.txt that generates the module, for the folder `built`.
fn generation(cmake: &str) -> Vec<String> {
    let rest = cmake.split("${GELENK} ").nth(1).unwrap();
    let command = rest.split("COMMAND").next().unwrap();
    command.split_whitespace().map(|word| word.replace("${CMAKE_CURRENT_BINARY_DIR}", "built")).collect()
}

/// Efforts against the weight of the palletizer: derivatives of its potential energy by hand.
fn weight(boom: f64, level: f64) -> [f64; 4] {
    const G: f64 = 9.81;
    let gripper = 1.5 * G * 0.1 * (boom + level).sin();
    let arm = -G * (3.0 * (0.25 * boom.cos() + 0.03 * boom.sin()) + 1.5 * 0.5 * boom.cos());
    [0.0, (5.0 + 3.0 + 1.5) * G, arm + gripper, gripper]
}

/// The package of the palletizer, and the folder of its URDF.
fn pallets(folder: &Path) -> [PathBuf; 2] {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ros2");
    let robot = here.join("palletizer.urdf");
    let made = gelenk(folder, &["new", "pallets", "--ros2", "--urdf", robot.to_str().unwrap()]);
    assert!(made.status.success(), "{}", said(&made));
    [folder.join("pallets"), here]
}

#[test]
fn controllers_for_ros2_control_compute_what_the_module_computes() {
    let folder = tempfile::tempdir().unwrap();
    let [package, here] = pallets(folder.path());
    let read = |file: &str| fs::read_to_string(package.join(file)).unwrap();
    for file in ["CMakeLists.txt", "package.xml", "controllers.xml", "src/joints.hpp"] {
        assert!(!read(file).contains("my_package"), "{file}");
    }
    let yaml = read("config/controllers.yaml");
    assert!(yaml.contains("joints: [\"turn\", \"lift\", \"boom\", \"level\"]\n"), "{yaml}");
    assert!(yaml.contains("command_joints: [\"computed_torque/turn\", \"computed_torque/lift\""), "{yaml}");

    let command = generation(&read("CMakeLists.txt"));
    let generated = gelenk(&package, &command.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(generated.status.success(), "{}", said(&generated));
    let include = here.join("include");
    for (c, compiler) in [("gcc", "g++"), ("clang", "clang++")] {
        let module =
            ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-c", "built/robot.c", "-o", "robot.o"];
        let module = Command::new(c).args(module).current_dir(&package).output();
        assert!(module.as_ref().is_ok_and(|output| output.status.success()) || module.is_err(), "{module:?}");
        let compiled = Command::new(compiler)
            .args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-O1", "-Isrc", "-Ibuilt", "-I"])
            .arg(&include)
            .args(["src/gravity_compensation.cpp", "src/computed_torque.cpp", "robot.o", "-o", compiler])
            .arg(here.join("call.cpp"))
            .current_dir(&package)
            .output();
        let Ok(compiled) = compiled else {
            println!("skipped: no {compiler}");
            continue;
        };
        assert!(compiled.status.success(), "{}", said(&compiled));
        let plugins = ["pallets::GravityCompensation", "pallets::ComputedTorque"];
        let xml = read("controllers.xml");
        assert!(plugins.iter().all(|plugin| xml.contains(&format!("type=\"{plugin}\""))), "{xml}");
        let called = Command::new(package.join(compiler)).args(plugins).output().unwrap();
        assert!(called.status.success(), "{}", said(&called));
        let text = said(&called);
        let rows: Vec<Vec<f64>> = text
            .lines()
            .filter(|line| ["turn", "lift", "boom", "level"].contains(&line.split(' ').next().unwrap()))
            .map(|line| line.split(' ').skip(1).map(|word| word.parse().unwrap()).collect())
            .collect();
        let by_hand = weight(rows[2][0], rows[3][0]);
        for (row, expected) in rows.iter().zip(by_hand) {
            assert!((row[1] - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{text}\n{by_hand:?}");
        }
    }
}

/// A controller has no value for a parameter that stays free.
#[test]
fn a_controller_of_a_robot_with_free_parameters_does_not_compile() {
    let folder = tempfile::tempdir().unwrap();
    let [package, here] = pallets(folder.path());
    let load = "\n[[bodies]]\nname = \"load\"\nlink = \"gripper\"\nmass = { free = 2 }\n";
    let description = fs::read_to_string(package.join("robot.toml")).unwrap();
    fs::write(package.join("robot.toml"), description + load).unwrap();
    let generated = gelenk(&package, &["generate", "robot.toml", "--language", "c", "--output", "built"]);
    assert!(generated.status.success(), "{}", said(&generated));
    let compiled = Command::new("g++")
        .args(["-std=c++17", "-Isrc", "-Ibuilt", "-fsyntax-only", "src/gravity_compensation.cpp", "-I"])
        .arg(here.join("include"))
        .current_dir(&package)
        .output();
    let Ok(compiled) = compiled else {
        println!("skipped: no g++");
        return;
    };
    assert!(said(&compiled).contains("robot.toml has free parameters"), "{}", said(&compiled));
}

/// A ball joint, a passive joint and a name that ROS does not take are refused.
#[test]
fn a_package_for_ros2_needs_an_effort_at_each_joint() {
    let folder = tempfile::tempdir().unwrap();
    let hinge = |joint: &str, motor: &str| {
        format!(
            "<mujoco><worldbody><body name=\"a\"><joint name=\"j\" axis=\"0 1 0\"/><geom size=\".1\"/>\
             <body name=\"b\" pos=\"0 0 1\">{joint}<geom size=\".1\"/></body></body></worldbody>\
             <actuator><motor joint=\"j\"/>{motor}</actuator></mujoco>"
        )
    };
    let passive = hinge("<joint name=\"k\" axis=\"1 0 0\"/>", "");
    let free =
        "<mujoco><worldbody><body name=\"a\"><freejoint/><geom size=\".1\"/></body></worldbody></mujoco>";
    let driven = hinge("<joint name=\"k\" axis=\"1 0 0\"/>", "<motor joint=\"k\"/>");
    for (name, text, message) in [
        ("arm", passive.as_str(), "no motor moves k"),
        ("arm", free, "the robot has a floating base"),
        ("my-arm", driven.as_str(), "is not a valid ROS package name"),
    ] {
        fs::write(folder.path().join("arm.xml"), text).unwrap();
        let refused = gelenk(folder.path(), &["new", name, "--ros2", "--mjcf", "arm.xml"]);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(said(&refused).contains(message), "{}", said(&refused));
        assert!(!folder.path().join(name).exists());
    }
}
