//! A solve allocates nothing, whatever its outcome.

mod support;

use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use support::random_qp;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is handed to the system allocator unchanged; the counter is a plain thread-local number.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: as this function's own contract.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as this function's own contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn ten_thousand_solves_allocate_nothing() {
    let mut kinds: Vec<QpProblem<4, 2>> = vec![];
    for seed in 0..12 {
        let kind = random_qp::Kind {
            horizon: 10,
            ..random_qp::kind_of(seed)
        };
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
    let before = ALLOCATIONS.with(Cell::get);
    for i in 0..10_000 {
        let problem = &kinds[i % kinds.len()];
        let report = if i % 3 == 0 {
            solver.solve_warm(problem)
        } else {
            solver.solve(problem)
        };
        match report.status {
            QpStatus::Solved => solved += 1,
            QpStatus::Relaxed => relaxed += 1,
            QpStatus::Invalid => refused += 1,
            QpStatus::IterationLimit => {}
        }
        solver.shift();
    }
    let after = ALLOCATIONS.with(Cell::get);
    assert_eq!(after, before);
    assert!(
        solved > 8000 && relaxed > 500 && refused > 500,
        "{solved} {relaxed} {refused}"
    );
    drop(std::hint::black_box(vec![0_u8; 32]));
    assert!(ALLOCATIONS.with(Cell::get) > after, "the counter counts");
}
