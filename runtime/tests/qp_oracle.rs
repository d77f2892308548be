//! The QP solver against Clarabel on 1000 random problems, and on 400 with rows. Thousands with rows:
//! `cargo test --release -p gelenk-runtime --test all qp_oracle:: -- --ignored --nocapture`.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::{oracle, random_qp, random_rows};
use clarabel::solver::SolverStatus;
use gelenk_runtime::qp::{QpSettings, QpSolver, QpStatus};

/// Largest difference of inputs and states, relative to their size where that exceeds 1.
fn difference<const NX: usize, const NU: usize, const NR: usize>(
    solver: &QpSolver<NX, NU, NR>,
    truth: &oracle::Solution<NX, NU>,
) -> f64 {
    let mut worst = 0.0_f64;
    for k in 0..solver.horizon() {
        let inputs = solver.input(k).into_iter().zip(truth.inputs[k]);
        let states = solver.state(k + 1).into_iter().zip(truth.states[k]);
        for (ours, theirs) in inputs.chain(states) {
            worst = worst.max((ours - theirs).abs() / theirs.abs().max(1.0));
        }
    }
    worst
}

fn compare<const NX: usize, const NU: usize>(seeds: impl Iterator<Item = u64>) {
    let settings = QpSettings { tolerance: 1e-14, ..QpSettings::default() };
    let mut iterations = vec![];
    let mut worst = 0.0_f64;
    let mut failures = vec![];
    for seed in seeds {
        let kind = random_qp::kind_of(seed);
        let problem = random_qp::random_qp::<NX, NU>(seed, kind);
        let truth = oracle::solve(&problem, 1e-13);
        assert!(
            matches!(truth.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
            "seed {seed}: Clarabel says {:?}",
            truth.status
        );
        let mut solver = QpSolver::<NX, NU>::new(kind.horizon, settings).unwrap();
        let report = solver.solve(&problem);
        let difference = difference(&solver, &truth);
        let excess = (report.cost - truth.cost).abs() / truth.cost.abs().max(1.0);
        let equal = report.status == QpStatus::Solved
            && difference < 1e-6
            && excess < 1e-7
            && report.residuals.primal < 1e-9;
        if !equal {
            failures.push(format!(
                "seed {seed} {kind:?}: difference {difference:.1e}, cost by {excess:.1e}, {report:?}"
            ));
        }
        worst = worst.max(difference);
        iterations.push(report.iterations);
    }
    iterations.sort_unstable();
    let n = iterations.len();
    println!(
        "{NX}/{NU}: {n} problems, largest difference {worst:.1e}, iterations median {} largest {}",
        iterations[n / 2],
        iterations[n - 1]
    );
    assert!(failures.is_empty(), "{} of {n} differ:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn equals_clarabel_on_two_states_one_input() {
    compare::<2, 1>(0..250);
}

#[test]
fn equals_clarabel_on_four_states_two_inputs() {
    compare::<4, 2>(250..600);
}

#[test]
fn equals_clarabel_on_five_states_three_inputs() {
    compare::<5, 3>(600..850);
}

#[test]
fn equals_clarabel_on_twelve_states_six_inputs() {
    compare::<12, 6>(850..1000);
}

/// At the default tolerance every problem is solved, in a number of iterations that hardly varies.
#[test]
fn iterations_vary_little() {
    let mut iterations: Vec<usize> = (0..1000)
        .map(|seed| {
            let kind = random_qp::kind_of(seed);
            let mut solver = QpSolver::<4, 2>::new(kind.horizon, QpSettings::default()).unwrap();
            let report = solver.solve(&random_qp::random_qp(seed, kind));
            assert_eq!(report.status, QpStatus::Solved, "seed {seed}: {report:?}");
            report.iterations
        })
        .collect();
    iterations.sort_unstable();
    println!("median {}, 99 % {}, largest {}", iterations[500], iterations[990], iterations[999]);
    assert!(
        iterations[999] <= 2 * iterations[500],
        "median {}, largest {}",
        iterations[500],
        iterations[999]
    );
}

fn compare_rows<const NX: usize, const NU: usize, const NR: usize>(seeds: impl Iterator<Item = u64>) {
    let settings = QpSettings { tolerance: 1e-14, ..QpSettings::default() };
    let (mut iterations, mut failures, mut active, mut worst) = (vec![], vec![], 0, 0.0_f64);
    for seed in seeds {
        let kind = random_qp::kind_of(seed);
        let problem = random_rows::random_rows::<NX, NU, NR>(seed, kind);
        let truth = oracle::solve(&problem, 1e-13);
        assert!(
            matches!(truth.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
            "seed {seed}: Clarabel says {:?}",
            truth.status
        );
        let mut solver = QpSolver::<NX, NU, NR>::new(kind.horizon, settings).unwrap();
        let report = solver.solve(&problem);
        let difference = difference(&solver, &truth);
        let excess = (report.cost - truth.cost).abs() / truth.cost.abs().max(1.0);
        let equal = report.status == QpStatus::Solved && difference < 1e-6 && excess < 1e-7;
        if !equal {
            failures.push(format!(
                "seed {seed} {kind:?}: difference {difference:.1e}, cost by {excess:.1e}, {report:?}"
            ));
        }
        let multipliers = (0..=kind.horizon).flat_map(|k| solver.row_multipliers(k));
        active += usize::from(multipliers.flatten().any(|l| l > 1e-6));
        worst = worst.max(difference);
        iterations.push(report.iterations);
    }
    iterations.sort_unstable();
    let n = iterations.len();
    println!(
        "{NX}/{NU}/{NR}: {n} problems, rows active in {active}, largest difference {worst:.1e}, iterations median {} largest {}",
        iterations[n / 2],
        iterations[n - 1]
    );
    assert!(failures.is_empty(), "{} of {n} differ:\n{}", failures.len(), failures.join("\n"));
    assert!(2 * active > n, "rows matter in {active} of {n} problems");
}

#[test]
fn equals_clarabel_on_random_rows() {
    compare_rows::<2, 1, 1>(0..150);
    compare_rows::<4, 2, 2>(150..300);
    compare_rows::<5, 3, 5>(300..400);
}

#[test]
#[ignore = "thousands of problems: minutes without optimization"]
fn equals_clarabel_on_thousands_of_random_rows() {
    compare_rows::<2, 1, 1>(0..2000);
    compare_rows::<4, 2, 3>(2000..5000);
    compare_rows::<5, 3, 5>(5000..6500);
    compare_rows::<12, 6, 6>(6500..7000);
}
