//! `gelenk new` as a new user meets it: from an empty folder to a simulation that runs.

use std::fs;
use std::path::Path;
use std::process::Command;

use gelenk_tests::cargo::{aloud, cargo, lock_like_here, success, text};
use gelenk_tests::packages::use_published;
use gelenk_tests::python::{has_c_compiler, program, python};
use gelenk_tests::workspace;

/// Lines of numbers: time, joints, energy.
fn rows(printed: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>();
    printed
        .lines()
        .skip(1)
        .map(|line| numbers(line).unwrap_or_else(|error| panic!("{error}: {line}")))
        .collect()
}

#[test]
fn a_new_crate_builds_and_simulates() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("first-arm");
    let new =
        Command::new(program()).arg("new").arg(&made).args(["--version", env!("CARGO_PKG_VERSION")]).output();
    let said = success(&new.expect("the program starts"));
    assert!(said.contains("cargo run"), "{said}");

    // From the packages that a registry would have.
    use_published(&made);
    lock_like_here(&made);
    let build = aloud(&made, &["build"]);
    success(&build);
    let said = text(&build.stderr);
    assert!(!said.contains("warning"), "warnings greet a new user: {said}");

    let rows = rows(&success(&cargo(&made, &["run"])));
    assert_eq!(rows.len(), 21);
    assert_eq!(rows[0][..3], [0.0, 1.0, 0.0]);
    // Without inputs, friction only takes energy; at rest at 1 rad it is V = -g (3 * 0.2 + 2 * 0.4) cos 1 - g
    // 2 * 0.15 cos 1.
    let start = -9.81 * 1.7 * 1.0_f64.cos();
    assert!((rows[0][3] - start).abs() < 1e-6, "{}", rows[0][3]);
    for pair in rows.windows(2) {
        assert!(pair[1][3] < pair[0][3], "energy grows: {pair:?}");
    }

    // What one changes first: the description.
    let description = made.join("robot.toml");
    let original = fs::read_to_string(&description).expect("the description");
    let build_with = |from: &str, to: &str| {
        fs::write(&description, original.replace(from, to)).expect("the description");
        let output = cargo(&made, &["build"]);
        assert!(!output.status.success());
        text(&output.stderr)
    };
    let faulty = build_with("mass = 2.0", "mass = -2.0");
    assert!(faulty.contains("robot.toml:32"), "{faulty}");

    // A robot that was renamed is not simulated under its old name.
    let renamed = build_with("name = \"robot\"", "name = \"walker\"");
    let says = "generates no robot `robot`, but `walker` from robot.toml. A module has the name of its robot, which is `name`";
    assert!(renamed.contains(says), "{renamed}");
}

/// The simulated robot of the program has 70 % of the described friction.
#[test]
fn a_new_crate_learns_friction() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("warm-arm");
    let options = ["--online-friction", "--version", env!("CARGO_PKG_VERSION")];
    success(
        &Command::new(program()).arg("new").arg(&made).args(options).output().expect("the program starts"),
    );
    use_published(&made);
    lock_like_here(&made);
    let build = aloud(&made, &["build"]);
    success(&build);
    let said = text(&build.stderr);
    assert!(!said.contains("warning"), "warnings greet a new user: {said}");
    let printed = success(&cargo(&made, &["run"]));
    println!("{printed}");
    // The report comes after the table.
    let row = |line: &str| {
        let words = line.replace('±', "");
        words.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>()
    };
    let numbers =
        printed.lines().rev().filter_map(row).find(|row| row.len() == 7).expect("a row of two joints");
    for joint in numbers[1..].chunks(3) {
        let (learned, described) = (joint[0], joint[2]);
        assert!((learned / described - 0.7).abs() < 0.05, "{printed}");
    }
}

/// The files and commands of docs/tutorial.md, in its order: the identified law tracks ten times better than the guess.
#[test]
fn the_tutorial_identifies_friction_and_controls_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("powercube");
    let gelenk = |folder: &Path, arguments: &[&str]| {
        success(&Command::new(program()).args(arguments).current_dir(folder).output().expect("gelenk"))
    };
    gelenk(folder.path(), &["new", "powercube", "--version", env!("CARGO_PKG_VERSION")]);
    use_published(&made);
    lock_like_here(&made);
    fs::remove_file(made.join("src/main.rs")).expect("a program");
    fs::create_dir(made.join("src/bin")).expect("a folder");
    let copy = |name: &str, place: &str| {
        let text = fs::read_to_string(workspace().join("docs/tutorial").join(name)).expect("a file");
        fs::write(made.join(place), &text).expect("written");
        text
    };
    copy("robot.toml", "robot.toml");
    copy("arm.toml", "arm.toml");
    let build = copy("build.rs", "build.rs");
    gelenk(&made, &["identify", "--plan", "robot.toml"]);
    copy("record.rs", "src/bin/record.rs");
    let recorded = success(&cargo(&made, &["run", "--bin", "record"]));
    assert!(recorded.contains("finished"), "{recorded}");
    gelenk(&made, &["identify", "robot.toml", "log.csv", "--method", "stls"]);

    let last_line = "// gelenk_codegen";
    assert!(build.contains(last_line));
    fs::write(made.join("build.rs"), build.replace(last_line, "gelenk_codegen")).expect("written");
    copy("mpc.rs", "src/bin/mpc.rs");
    let moved = success(&cargo(&made, &["run", "--bin", "mpc"]));
    let errors = moved.lines().last().and_then(|line| line.strip_prefix("largest error: guessed "));
    let (guessed, identified) =
        errors.and_then(|line| line.split_once(" mrad, identified ")).expect("errors");
    let number = |text: &str| text.trim_end_matches(" mrad").parse::<f64>().expect("a number");
    assert!(number(identified) < 0.1 * number(guessed), "{moved}");
}

/// The simulations of projects in C and Python print the same motion, digit by digit.
#[test]
fn new_projects_in_c_and_python_simulate() {
    if !has_c_compiler() || Command::new("make").arg("--version").output().is_err() {
        println!("skipped: no `make`");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let gelenk = program();
    let new = |name: &str, language: &str| {
        success(
            &Command::new(&gelenk)
                .args(["new", name, language])
                .current_dir(&folder)
                .output()
                .expect("gelenk"),
        );
        folder.path().join(name)
    };
    let made = new("arm in c", "--c");
    let mut make = Command::new("make");
    make.args(["-s", "run", "CFLAGS=-O2 -Wall -Wextra -Werror -pedantic"])
        .env("GELENK", &gelenk)
        .current_dir(&made);
    let printed = success(&make.output().expect("make"));
    let motion = &printed[printed.find("   t [s]").expect("a table")..];
    let swings = rows(motion);
    assert_eq!(swings.len(), 21);
    for pair in swings.windows(2) {
        assert!(pair[1][3] < pair[0][3], "energy grows: {pair:?}");
    }
    let again = success(&make.output().expect("make"));
    assert_eq!(again, motion, "what is fresh is not generated again");

    let made = new("arm in python", "--python");
    let package = workspace().join("codegen/python");
    let requirements = fs::read_to_string(made.join("requirements.txt")).expect("the requirements");
    assert!(requirements.ends_with(&format!("\n{}\n", package.display())), "{requirements}");
    let Some(python) = python() else { return };
    let mut simulate = Command::new(python);
    simulate.arg(made.join("main.py")).env("PYTHONPATH", package.join("src")).env("GELENK_PROGRAM", &gelenk);
    simulate.env("GELENK_CACHE", folder.path().join("cache")).env("PYTHONDONTWRITEBYTECODE", "1");
    assert_eq!(success(&simulate.output().expect("Python")), motion);
}

/// Without options it depends on the checkout that the program was built from.
#[test]
fn a_new_crate_finds_the_checkout() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("arm-of-checkout");
    success(&Command::new(program()).arg("new").arg(&made).output().expect("the program starts"));
    lock_like_here(&made);
    let tree = ["tree", "--depth", "1", "--prefix", "none"];
    let resolved = success(&cargo(&made, &tree));
    for (name, part) in [("gelenk-runtime", "runtime"), ("gelenk-codegen", "codegen")] {
        let place = workspace().join(part);
        let line = format!("{name} v{} ({})", env!("CARGO_PKG_VERSION"), place.display());
        assert!(resolved.contains(&line), "{line} not in:\n{resolved}");
    }
}
