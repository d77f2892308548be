//! Reproduces "Identification of Friction Models for MPC-based Control of a PowerCube Serial Robot" (Fehr, Kargl, Eschmann) on
//! the simulated arm.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example powercube [FOLDER]
//! ```
//!
//! The program runs the experiments of the paper with seeded plants, and prints each claim with its verdict. It writes a report
//! with `index.html`, JSON and CSV to FOLDER (default `report`). `GELENK_EXAMPLE_SHORT=1` runs the same code with fewer samples.
//!
//! Verdicts follow from numbers and thresholds. `control/tests.rs` and `friction/tests.rs` assert the verdicts, and reverse each
//! verdict by the change that its claim names: `cargo test --release -p gelenk-runtime --example powercube`.

mod arm;
mod control;
mod equations;
mod friction;
mod methods;
#[path = "../support/outcome.rs"]
mod outcome;
mod page;
mod study;

use gelenk_report::Report;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use study::{Experiment, Outcome, Part, Study};

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("report"), PathBuf::from);
    write(&Study::from_environment(), &folder)
}

/// Prints the verdicts, and writes the report to a folder.
fn write(study: &Study, folder: &Path) -> Outcome<()> {
    // The folder is created first, so that an error appears before the long computation.
    std::fs::create_dir_all(folder).map_err(|error| format!("cannot write {}: {error}", folder.display()))?;
    let report = report(study)?;
    for claim in report.claims() {
        println!("{:<10} {}", claim.id, claim.verdict());
    }
    for file in report.write(folder)? {
        if file.extension().is_some_and(|kind| kind == "html") {
            println!("written: {}", file.display());
        }
    }
    Ok(())
}

/// Runs all experiments, several at a time. The results do not depend on the number of threads. Progress is printed to the
/// terminal.
fn report(study: &Study) -> Outcome<Report> {
    let experiments: Vec<Experiment> =
        control::EXPERIMENTS.iter().chain(friction::EXPERIMENTS).copied().collect();
    let found: Vec<_> = experiments.iter().map(|_| Mutex::new(None)).collect();
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers.min(experiments.len()) {
            scope.spawn(|| {
                while let Some((place, experiment)) = taken(&next, &found, &experiments) {
                    let start = Instant::now();
                    // Errors cannot be sent to another thread, but their text can.
                    let outcome = experiment.1(study).map_err(|error| error.to_string());
                    eprintln!(
                        "[{:>2}/{}] {}, {:.1} s",
                        done.fetch_add(1, Ordering::Relaxed) + 1,
                        experiments.len(),
                        experiment.0,
                        start.elapsed().as_secs_f64()
                    );
                    if let Ok(mut place) = place.lock() {
                        *place = Some(outcome);
                    }
                }
            });
        }
    });
    let mut parts: Vec<Part> = Vec::new();
    for (place, (title, _)) in found.into_iter().zip(experiments) {
        let outcome = place.into_inner().map_err(|error| error.to_string())?;
        let outcome = outcome.ok_or_else(|| format!("{title}: nothing came back"))?;
        parts.push(outcome.map_err(|error| format!("{title}: {error}"))?);
    }
    page::report(study, parts)
}

type Place = Mutex<Option<Result<Part, String>>>;

/// Returns the next experiment that no thread has begun, and the place for its result.
fn taken<'e>(
    next: &AtomicUsize,
    found: &'e [Place],
    experiments: &'e [Experiment],
) -> Option<(&'e Place, &'e Experiment)> {
    let k = next.fetch_add(1, Ordering::Relaxed);
    Some((found.get(k)?, experiments.get(k)?))
}

/// Writes the report to the folder in `GELENK_REPORT`, if this variable is set.
#[test]
fn the_report_is_written() -> Outcome<()> {
    let folder = tempfile::tempdir()?;
    let place = std::env::var_os("GELENK_REPORT").map_or_else(|| folder.path().to_owned(), PathBuf::from);
    write(&Study { is_short: true }, &place)?;
    assert!(std::fs::read_to_string(place.join("index.html"))?.contains("</html>"));
    Ok(())
}
