//! acados with gelenk's discrete dynamics: values, Jacobians, limits, and robots under its real-time iterations.
//!
//! A third party's wheel has acados and its template. Where it cannot be had, or where `make` or a C compiler are missing, the
//! tests are skipped and say so.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::process::Command;

use gelenk_tests::python::{has_c_compiler, pytest, python_with_acados, test_files};

#[test]
fn acados_solves_problems_of_robots() {
    run("acados");
}

#[test]
fn acados_solves_problems_of_robots_with_quaternions() {
    run("acados_quaternions");
}

fn run(name: &str) {
    if !has_c_compiler() || !has_make() {
        return;
    }
    let Some(python) = python_with_acados() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    pytest(&python, &[test_files()[name].clone()], folder.path(), &[]);
}

fn has_make() -> bool {
    let is_there = Command::new("make").arg("--version").output().is_ok_and(|output| output.status.success());
    if !is_there {
        println!("skipped: no `make`, by which acados compiles");
    }
    is_there
}
