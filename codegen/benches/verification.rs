//! The share of `gelenk generate` that compares every function with its independent evaluation, for all functions of a robot.
//! Medians of processor time, in turns.
//!
//! ```text
//! cargo bench -p gelenk-codegen --bench verification
//! ```

#![allow(clippy::expect_used, reason = "a model of this repository is right")]

use std::path::Path;
use std::time::Instant;

use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_codegen::verify::verify;

const ROUNDS: usize = 7;
const ROBOTS: [&str; 6] = ["double_pendulum", "powercube", "ur5", "panda", "quadrotor", "go2"];

/// Seconds of a call.
fn seconds<T>(call: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = call();
    (start.elapsed().as_secs_f64(), result)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    println!("robot             generate ms  of it verify ms   share");
    for robot in ROBOTS {
        for (selection, functions) in [("default", Vec::new()), ("all", vec!["all".to_owned()])] {
            let options = GenerateOptions { functions, ..GenerateOptions::default() };
            let description = models.join(format!("{robot}.toml"));
            let round = |_| {
                let (whole, generated) =
                    seconds(|| generate(&description, &options).expect("a model of this repository"));
                let (check, result) = seconds(|| verify(&generated.model, &generated.module.functions));
                result.expect("the module is right");
                (whole, check)
            };
            let (whole, check): (Vec<f64>, Vec<f64>) = (0..ROUNDS).map(round).unzip();
            let (whole, check) = (1e3 * median(whole), 1e3 * median(check));
            println!("{robot:<16} {selection:<8} {whole:8.1} {check:8.1} {:7.1} %", 100.0 * check / whole);
        }
    }
}
