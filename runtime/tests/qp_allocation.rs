//! A solve allocates nothing, whatever its outcome.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::allocations;
use crate::support::{random_qp, random_rows};
use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};

/// Solves `kinds` in turn, `solves` problems. Returns how many were solved, relaxed and refused.
fn solve_in_turn<const NR: usize>(kinds: &[QpProblem<4, 2, NR>], solves: usize) -> [u32; 3] {
    let mut solver = QpSolver::<4, 2, NR>::new(10, QpSettings::default()).unwrap();
    let mut counts = [0; 3];
    let before = allocations::count();
    for i in 0..solves {
        let problem = &kinds[i % kinds.len()];
        let report = if i % 3 == 0 { solver.solve_warm(problem) } else { solver.solve(problem) };
        match report.status {
            QpStatus::Solved => counts[0] += 1,
            QpStatus::Relaxed => counts[1] += 1,
            QpStatus::Invalid => counts[2] += 1,
            QpStatus::IterationLimit => {}
        }
        solver.shift();
    }
    assert_eq!(allocations::count(), before);
    counts
}

#[test]
fn ten_thousand_solves_allocate_nothing() {
    let mut kinds: Vec<QpProblem<4, 2>> = vec![];
    for seed in 0..12 {
        let kind = random_qp::Kind { horizon: 10, ..random_qp::kind_of(seed) };
        kinds.push(random_qp::random_qp(seed, kind));
    }
    let mut infeasible = kinds[0].clone();
    for stage in &mut infeasible.stages {
        stage.state_lower = [50.0; 4];
    }
    kinds.push(infeasible);
    let mut invalid = kinds[0].clone();
    invalid.initial_state[0] = f64::NAN;
    kinds.push(invalid);
    let [solved, relaxed, refused] = solve_in_turn(&kinds, 10_000);
    assert!(solved > 8000 && relaxed > 500 && refused > 500, "{solved} {relaxed} {refused}");
    let before = allocations::count();
    drop(std::hint::black_box(vec![0_u8; 32]));
    assert!(allocations::count() > before, "the counter counts");
}

#[test]
fn solves_with_rows_allocate_nothing() {
    let kind = |seed| random_qp::Kind { horizon: 10, ..random_qp::kind_of(seed) };
    let mut kinds: Vec<QpProblem<4, 2, 2>> =
        (0..12).map(|seed| random_rows::random_rows(seed, kind(seed))).collect();
    let mut infeasible = kinds[0].clone();
    infeasible.row_penalty = [None; 2];
    for stage in &mut infeasible.stages[1..] {
        (stage.rows.lower, stage.rows.upper) = ([500.0; 2], [f64::INFINITY; 2]);
    }
    kinds.push(infeasible);
    let mut invalid = kinds[0].clone();
    invalid.stages[3].rows.lower[1] = f64::NAN;
    kinds.push(invalid);
    let [solved, relaxed, refused] = solve_in_turn(&kinds, 1400);
    assert!(solved > 1000 && relaxed > 50 && refused > 50, "{solved} {relaxed} {refused}");
}
