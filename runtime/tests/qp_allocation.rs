//! A solve allocates nothing, whatever its outcome.

#[path = "support/allocations.rs"]
mod allocations;
mod support;

use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
use support::random_qp;

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
    let mut solver = QpSolver::<4, 2>::new(10, QpSettings::default()).unwrap();
    let (mut solved, mut relaxed, mut refused) = (0, 0, 0);
    let before = allocations::count();
    for i in 0..10_000 {
        let problem = &kinds[i % kinds.len()];
        let report = if i % 3 == 0 { solver.solve_warm(problem) } else { solver.solve(problem) };
        match report.status {
            QpStatus::Solved => solved += 1,
            QpStatus::Relaxed => relaxed += 1,
            QpStatus::Invalid => refused += 1,
            QpStatus::IterationLimit => {}
        }
        solver.shift();
    }
    let after = allocations::count();
    assert_eq!(after, before);
    assert!(solved > 8000 && relaxed > 500 && refused > 500, "{solved} {relaxed} {refused}");
    drop(std::hint::black_box(vec![0_u8; 32]));
    assert!(allocations::count() > after, "the counter counts");
}
