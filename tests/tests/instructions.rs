//! Instructions per call of the emitted functions, counted by Valgrind: a regression shows without timing.
//!
//! The counts belong to rustc 1.95 and x86-64-v3; another compiler moves them a little. Review with `cargo insta review`.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_tests::workspace;

/// Functions of y alone, of y and ẏ, and of y, ẏ and a third array.
const FUNCTIONS: [(&str, &str); 7] = [
    ("mass_matrix", "y"),
    ("bias_forces", "y, v"),
    ("inverse_dynamics", "y, v, a"),
    ("forward_dynamics", "y, v, a"),
    ("inverse_dynamics_derivatives", "y, v, a"),
    ("forward_dynamics_derivatives", "y, v, a"),
    ("linearize", "y, v, a"),
];

const CALLS: u64 = 1000;

/// A program that calls one function so many times: both are its arguments.
fn main_text() -> String {
    let mut arms = String::new();
    for (name, arguments) in FUNCTIONS {
        let _ = writeln!(
            arms,
            "        {name:?} => for k in 0..calls {{ let [y, v, a] = &states[k % 8]; \
             let (y, v, a) = (black_box(y), black_box(v), black_box(a)); _ = (v, a); \
             black_box(robot::{name}({arguments})); }},"
        );
    }
    format!(
        "mod robot {{ include!(\"robot.rs\"); }}
use std::hint::black_box;
fn main() {{
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap();
    let calls: usize = arguments.next().unwrap().parse().unwrap();
    let states: [[[f64; robot::N]; 3]; 8] = core::array::from_fn(|s| core::array::from_fn(|k| core::array::from_fn(|i|
        ((s * 31 + k * 7 + i) as f64 * 0.7).rem_euclid(4.0) - 2.0)));
    match name.as_str() {{
{arms}        _ => panic!(),
    }}
}}
"
    )
}

/// The instructions that Valgrind counts in one run.
fn count(program: &Path, function: &str, calls: u64) -> u64 {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args([function, &calls.to_string()])
        .output()
        .expect("valgrind runs");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let collected = text
        .lines()
        .find_map(|line| line.split_once("Collected : "));
    let (_, number) = collected.unwrap_or_else(|| panic!("{text}"));
    number.trim().parse().expect("a count")
}

fn report(robot: &str, fused: bool) -> String {
    let options = GenerateOptions {
        no_friction: true,
        fused_multiply_add: fused,
        functions: FUNCTIONS
            .iter()
            .map(|(name, _)| (*name).to_owned())
            .collect(),
        ..GenerateOptions::default()
    };
    let description = workspace().join("models").join(format!("{robot}.toml"));
    let generated =
        generate(&description, &options).unwrap_or_else(|problems| panic!("{problems}"));
    let folder = tempfile::tempdir().expect("a folder");
    let (main, program) = (folder.path().join("main.rs"), folder.path().join("main"));
    std::fs::write(folder.path().join("robot.rs"), &generated.source.text).expect("a file");
    std::fs::write(&main, main_text()).expect("a file");
    let output = Command::new("rustc")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .args([
            "--edition",
            "2024",
            "-Copt-level=3",
            "-Ccodegen-units=1",
            "-Ctarget-cpu=x86-64-v3",
            "-Awarnings",
            "-o",
        ])
        .args([&program, &main])
        .output()
        .expect("rustc runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let form = if fused { "fused" } else { "plain" };
    let lines = FUNCTIONS.iter().map(|(name, _)| {
        let calls = count(&program, name, CALLS) - count(&program, name, 0);
        format!("{robot} {form} {name}: {}\n", (calls + CALLS / 2) / CALLS)
    });
    lines.collect()
}

#[test]
fn instructions_per_call() {
    let has_valgrind = Command::new("valgrind").arg("--version").output().is_ok();
    if !has_valgrind || !cfg!(target_arch = "x86_64") {
        println!("skipped: no valgrind, or no x86-64");
        return;
    }
    let reports = [
        ("ur5", false),
        ("ur5", true),
        ("panda", false),
        ("panda", true),
    ];
    let text: String = reports
        .iter()
        .map(|(robot, fused)| report(robot, *fused))
        .collect();
    insta::assert_snapshot!(text);
}
