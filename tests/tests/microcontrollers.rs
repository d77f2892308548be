//! Laws of UR5 and PowerCube in single precision on a Cortex-M4F and a Cortex-M7 that QEMU plays, in C and in Rust, and the online
//! estimator of friction in double precision.
//!
//! The script compares their bits with the host's, and refuses images of the laws that hold a panic or arithmetic in software. It needs
//! a cross compiler and QEMU; what is missing is skipped and says so.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::process::Command;

use gelenk_tests::cargo::target;
use gelenk_tests::python::program;
use gelenk_tests::workspace;

/// Most instructions of `inverse_dynamics`; the page `codegen/docs/microcontrollers.md` has the numbers.
const MOST_INSTRUCTIONS: u32 = 1000;

/// Instructions of `inverse_dynamics` in a row `| robot, language, processor | instructions, stack | … |`.
fn instructions(row: &str) -> u32 {
    let cell = row.split('|').nth(2).expect("a cell");
    let number = cell.split(',').next().expect("a number").trim();
    number.parse().unwrap_or_else(|_| panic!("no number of instructions in {row}"))
}

#[test]
fn laws_on_microcontrollers_have_the_bits_of_the_host() {
    let script = Command::new("sh")
        .arg("tests/microcontroller/measure.sh")
        .env("GELENK", program())
        .env("CARGO_TARGET_DIR", target())
        .current_dir(workspace())
        .output();
    let Ok(output) = script else {
        println!("skipped: no shell `sh`");
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout);
    println!("{text}");
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let skipped: Vec<&str> = text.lines().filter(|line| line.starts_with("skipped: ")).collect();
    let rows: Vec<&str> = text.lines().filter(|line| line.contains(", cortex-m")).collect();
    let (laws, online) = match skipped[..] {
        [] => (8, 2),
        [line] if line.starts_with("skipped: Rust:") => (4, 0),
        _ => (0, 0),
    };
    assert_eq!(rows.len(), laws + online, "{text}");
    for row in &rows[..laws] {
        assert!((1..=MOST_INSTRUCTIONS).contains(&instructions(row)), "{row}");
    }
    // The Cortex-M4F computes doubles in software.
    for (row, most) in rows[laws..].iter().zip([100_000, 4000]) {
        assert!((1..=most).contains(&instructions(row)), "{row}");
    }
}
