//! `gelenk new` as a new user meets it: from an empty folder to a simulation that runs.

use std::fs;

use gelenk_tests::cargo::{aloud, cargo, lock_like_here, success, text};
use gelenk_tests::packages::use_published;
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
    let path = made.to_string_lossy();
    let gelenk = ["run", "-p", "gelenk-codegen", "--", "new", &path];
    let version = ["--version", env!("CARGO_PKG_VERSION")];
    let said = success(&cargo(&workspace(), &[&gelenk[..], &version].concat()));
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
    assert!(faulty.contains("robot.toml:31"), "{faulty}");

    // A robot that was renamed is not simulated under its old name.
    let renamed = build_with("name = \"robot\"", "name = \"walker\"");
    let says = "generates no robot `robot`, but `walker` from robot.toml. A module is named after its robot: the key `name`";
    assert!(renamed.contains(says), "{renamed}");
}

/// Without options it depends on the checkout that the program was built from.
#[test]
fn a_new_crate_finds_the_checkout() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("arm-of-checkout");
    let path = made.to_string_lossy();
    let gelenk = ["run", "-p", "gelenk-codegen", "--", "new", &path];
    success(&cargo(&workspace(), &gelenk));
    lock_like_here(&made);
    let tree = ["tree", "--depth", "1", "--prefix", "none"];
    let resolved = success(&cargo(&made, &tree));
    for (name, part) in [("gelenk-runtime", "runtime"), ("gelenk-codegen", "codegen")] {
        let place = workspace().join(part);
        let line = format!("{name} v{} ({})", env!("CARGO_PKG_VERSION"), place.display());
        assert!(resolved.contains(&line), "{line} not in:\n{resolved}");
    }
}
