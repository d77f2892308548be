//! "Identification of Friction Models for MPC-based Control of a PowerCube Serial Robot" (Fehr, Kargl, Eschmann),
//! reproduced on the simulated arm.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example powercube [FOLDER]
//! ```
//!
//! Runs the paper's experiments with seeded plants, prints each claim with its verdict, and writes a report into FOLDER
//! (`report`): `index.html`, and its numbers as JSON and CSV. `GELENK_EXAMPLE_SHORT=1` takes fewer samples through the
//! same code.
//!
//! Verdicts follow from numbers and thresholds; `tests.rs` asserts them, and flips each by what its claim names:
//! `cargo test --release -p gelenk-runtime --example powercube`.

mod arm;
mod control;
mod friction;
mod study;
#[cfg(test)]
mod tests;

use gelenk_runtime::report::{Block, Report, Section, text};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use study::{Outcome, Study};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Outcome<()> {
    let study = Study::from_environment();
    let folder = std::env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("report"), PathBuf::from);
    let report = report(&study)?;
    for claim in report.claims() {
        println!("{:<28} {}", claim.id, claim.verdict());
    }
    for file in report.write(&folder)? {
        if file.extension().is_some_and(|kind| kind == "html") {
            println!("written: {}", file.display());
        }
    }
    Ok(())
}

/// Runs all experiments; progress goes to the terminal.
fn report(study: &Study) -> Outcome<Report> {
    let experiments: Vec<_> = control::EXPERIMENTS
        .iter()
        .chain(friction::EXPERIMENTS)
        .collect();
    let mut claims = Vec::new();
    let mut sections = Vec::new();
    for (number, (title, experiment)) in experiments.iter().enumerate() {
        let start = Instant::now();
        eprint!("[{:>2}/{}] {title} … ", number + 1, experiments.len());
        let part = experiment(study)?;
        eprintln!("{:.1} s", start.elapsed().as_secs_f64());
        claims.extend(part.claims);
        sections.push(part.section);
    }
    let report = Report::new("Friction models for the MPC of a PowerCube, reproduced")
        .section(
            Section::new("claims", "The claims")
                .block(text("Each verdict follows from its numbers and thresholds; each names what would flip it."))
                .block(Block::Claims(claims)),
        );
    Ok(sections.into_iter().fold(report, Report::section))
}
