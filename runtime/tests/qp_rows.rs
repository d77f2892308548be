//! Contract of the QP's rows `lo ≤ C x + D u ≤ hi` except the optimum, which `qp_oracle` and `qp_random`
//! compare with Clarabel's.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::kkt::kkt;
use crate::support::random_qp::Random;
use crate::support::wide_qp::row_value;
use crate::support::{oracle, random_qp, random_rows};
use clarabel::solver::SolverStatus;
use gelenk_runtime::qp::{
    Penalty, QpError, QpProblem, QpReport, QpRows, QpSettings, QpSolver, QpStage, QpStatus,
};

const SETTINGS: QpSettings = QpSettings { tolerance: 1e-10, feasibility: 1e-10, max_iterations: 50 };
const HORIZON: usize = 10;

fn problem(seed: u64) -> QpProblem<4, 2, 3> {
    let kind = random_qp::Kind { horizon: HORIZON, ..random_qp::kind_of(seed) };
    random_rows::random_rows(seed, kind)
}

/// The same without limits of rows.
fn without_rows(p: &QpProblem<4, 2, 3>) -> QpProblem<4, 2, 3> {
    let mut p = p.clone();
    p.terminal_rows = QpRows::default();
    p.stages.iter_mut().for_each(|stage| stage.rows = QpRows::default());
    p
}

fn solve<const NR: usize>(p: &QpProblem<4, 2, NR>) -> (QpSolver<4, 2, NR>, QpReport) {
    let mut solver = QpSolver::new(HORIZON, SETTINGS).unwrap();
    let report = solver.solve(p);
    (solver, report)
}

/// Bit patterns of all inputs and multipliers of rows.
fn bits(solver: &QpSolver<4, 2, 3>) -> Vec<u64> {
    let inputs = (0..HORIZON).flat_map(|k| solver.input(k));
    let forces = (0..=HORIZON).flat_map(|k| solver.row_multipliers(k)).flatten();
    inputs.chain(forces).map(f64::to_bits).collect()
}

#[test]
fn kkt_conditions_hold_with_rows() {
    for seed in 0..100 {
        let problem = problem(seed);
        let (solver, report) = solve(&problem);
        assert_eq!(report.status, QpStatus::Solved, "seed {seed}");
        let residual = kkt(&problem, &solver);
        // Rows in units of a thousand have violations in these.
        assert!(residual < 1e-6 * report.cost.abs().max(1.0), "seed {seed}: {residual:e} {report:?}");
    }
}

/// Rows that limit nothing, and rows that a problem does not have, give the same solution to the last bit.
#[test]
fn rows_without_limits_change_nothing() {
    for seed in 0..50 {
        let with = without_rows(&problem(seed));
        let mut without = QpProblem::<4, 2>::new(HORIZON);
        without.initial_state = with.initial_state;
        without.state_weight = with.state_weight;
        without.input_weight = with.input_weight;
        without.terminal_weight = with.terminal_weight;
        without.input_rate_weight = with.input_rate_weight;
        without.previous_input = with.previous_input;
        without.state_penalty = with.state_penalty;
        for (to, from) in without.stages.iter_mut().zip(&with.stages) {
            *to = QpStage {
                state_matrix: from.state_matrix,
                input_matrix: from.input_matrix,
                affine: from.affine,
                input_gradient: from.input_gradient,
                state_gradient: from.state_gradient,
                input_lower: from.input_lower,
                input_upper: from.input_upper,
                state_lower: from.state_lower,
                state_upper: from.state_upper,
                rows: QpRows::default(),
            };
        }
        // Soft limits that are none choose the arithmetic of soft bounds.
        let (a, of_rows) = solve(&QpProblem { row_penalty: [None; 3], ..with });
        let (b, plain) = solve(&without);
        assert_eq!(of_rows, plain, "seed {seed}");
        assert!((0..HORIZON).all(|k| a.input(k) == b.input(k)), "seed {seed}");
    }
}

/// A bound of a state or an input and the same limit as a row are one problem.
#[test]
fn a_row_of_one_variable_is_a_bound() {
    for seed in 0..60 {
        let mut bounded = without_rows(&problem(seed));
        bounded.row_penalty = [None; 3];
        let mut rowed = bounded.clone();
        rowed.row_penalty[1] = rowed.state_penalty[1];
        for k in 0..HORIZON {
            // The bounds of stage k are those of x_{k+1}, its rows those of x_k.
            let (lower, upper) = (bounded.stages[k].state_lower[1], bounded.stages[k].state_upper[1]);
            let from = &mut rowed.stages[k];
            (from.state_lower[1], from.state_upper[1]) = (f64::NEG_INFINITY, f64::INFINITY);
            from.rows.input_matrix[0] = [-20.0, 0.0];
            (from.rows.lower[0], from.rows.upper[0]) =
                (-20.0 * from.input_upper[0], -20.0 * from.input_lower[0]);
            (from.input_lower[0], from.input_upper[0]) = (f64::NEG_INFINITY, f64::INFINITY);
            if let Some(next) = rowed.stages.get_mut(k + 1) {
                next.rows.state_matrix[1][1] = 1.0;
                (next.rows.lower[1], next.rows.upper[1]) = (lower, upper);
            } else {
                rowed.terminal_rows.state_matrix[1][1] = 1.0;
                (rowed.terminal_rows.lower[1], rowed.terminal_rows.upper[1]) = (lower, upper);
            }
        }
        let ((a, of_bounds), (b, of_rows)) = (solve(&bounded), solve(&rowed));
        assert_eq!((of_bounds.status, of_rows.status), (QpStatus::Solved, QpStatus::Solved), "seed {seed}");
        for k in 0..HORIZON {
            for (a, b) in a.input(k).into_iter().zip(b.input(k)) {
                assert!((a - b).abs() < 1e-5 * a.abs().max(1.0), "seed {seed}, stage {k}: {a} and {b}");
            }
            let (force, of_row) = (a.input_multipliers(k)[0], b.row_multipliers(k)[0]);
            let error = (force[1] - 20.0 * of_row[0]).abs().max((force[0] - 20.0 * of_row[1]).abs());
            assert!(error < 1e-4 * force[0].max(force[1]).max(1.0), "seed {seed}: {force:?} {of_row:?}");
        }
    }
}

/// The same row twice, a row that repeats a bound, and one that limits nothing beyond it.
#[test]
fn degenerate_rows_do_no_harm() {
    for seed in 0..60 {
        let once = without_rows(&problem(seed));
        let mut once = QpProblem { row_penalty: [None; 3], ..once };
        let given = problem(seed);
        for k in 0..HORIZON {
            let (from, to) = (&given.stages[k].rows, &mut once.stages[k].rows);
            if given.row_penalty[0].is_none() {
                to.state_matrix[0] = from.state_matrix[0];
                to.input_matrix[0] = from.input_matrix[0];
                (to.lower[0], to.upper[0]) = (from.lower[0], from.upper[0]);
            }
        }
        let mut twice = once.clone();
        for stage in &mut twice.stages {
            let rows = &mut stage.rows;
            rows.state_matrix[1] = rows.state_matrix[0].map(|c| -3.0 * c);
            rows.input_matrix[1] = rows.input_matrix[0].map(|d| -3.0 * d);
            (rows.lower[1], rows.upper[1]) = (-3.0 * rows.upper[0], -3.0 * rows.lower[0]);
            rows.input_matrix[2][1] = 1.0;
            (rows.lower[2], rows.upper[2]) = (stage.input_lower[1], stage.input_upper[1]);
        }
        let ((a, one), (b, two)) = (solve(&once), solve(&twice));
        assert_eq!((one.status, two.status), (QpStatus::Solved, QpStatus::Solved), "seed {seed}: {two:?}");
        assert!((one.cost - two.cost).abs() < 1e-8 * one.cost.abs().max(1.0), "seed {seed}");
        for k in 0..HORIZON {
            for (a, b) in a.input(k).into_iter().zip(b.input(k)) {
                assert!((a - b).abs() < 1e-4 * a.abs().max(1.0), "seed {seed}, stage {k}: {a} and {b}");
            }
        }
    }
}

/// Equal sides of a hard row are an equality, kept to the tolerance; Clarabel finds the same optimum.
#[test]
fn equal_sides_are_an_equality() {
    let mut judged = 0;
    for seed in 0..60 {
        let mut problem = QpProblem { row_penalty: [None; 3], ..without_rows(&problem(seed)) };
        let (free, _) = solve(&problem);
        let mut r = Random::new(seed);
        for k in [0, 3, 7] {
            let rows = &mut problem.stages[k].rows;
            (rows.state_matrix[k % 3], rows.input_matrix[k % 3]) = (r.vector(), r.vector());
            let x = if k == 0 { problem.initial_state } else { free.state(k) };
            // Between where the optimum is and the middle of the input bounds, which can be reached.
            let u = free.input(k);
            let value = row_value(rows, k % 3, &x, &u);
            (rows.lower[k % 3], rows.upper[k % 3]) = (value, value);
        }
        let stage = &mut problem.stages[5];
        (stage.input_lower, stage.input_upper) = ([-50.0; 2], [50.0; 2]);
        stage.rows.input_matrix[0] = [1.0, -2.0];
        (stage.rows.lower[0], stage.rows.upper[0]) = (0.2, 0.2);
        for stage in &mut problem.stages[6..] {
            (stage.input_lower, stage.input_upper) = ([-50.0; 2], [50.0; 2]);
        }
        let (solver, report) = solve(&problem);
        let truth = oracle::solve(&problem, 1e-10);
        if truth.status != SolverStatus::Solved {
            assert_ne!(report.status, QpStatus::Invalid, "seed {seed}");
            continue;
        }
        judged += 1;
        assert_eq!(report.status, QpStatus::Solved, "seed {seed}: {report:?}");
        let u = solver.input(5);
        assert!((u[0] - 2.0 * u[1] - 0.2).abs() < 1e-9, "seed {seed}: {u:?}");
        assert!((report.cost - truth.cost).abs() < 1e-6 * truth.cost.abs().max(1.0), "seed {seed}");
    }
    assert!(judged >= 50, "{judged}");
}

/// Hard rows that cannot be kept are never called solved; the violation is as small as Clarabel finds it can
/// be.
#[test]
fn infeasible_rows_give_the_least_violation() {
    for seed in 0..60 {
        let kind = random_qp::Kind {
            horizon: HORIZON,
            spectral_radius: 0.9,
            state_bounds: false,
            soft: false,
            rate: seed % 2 == 0,
        };
        let mut problem: QpProblem<4, 2, 3> = random_rows::random_rows(seed, kind);
        problem = QpProblem { row_penalty: [None; 3], ..without_rows(&problem) };
        for stage in &mut problem.stages {
            stage.input_upper = stage.input_lower.map(|lower| lower + 0.4);
            stage.rows.state_matrix[0] = [1.0, 0.5, 0.0, 0.0];
            stage.rows.input_matrix[0] = [0.3, 0.0];
            stage.rows.lower[0] = 4.0;
            stage.rows.input_matrix[1] = [1.0, 1.0];
            stage.rows.upper[1] = stage.input_lower[0] + stage.input_lower[1] - 0.5;
        }
        let (solver, report) = solve(&problem);
        assert_eq!(report.status, QpStatus::Relaxed, "seed {seed}: {report:?}");
        assert!(report.iterations <= 100 && report.residuals.primal > 0.1);
        let mut least = problem.clone();
        least.row_penalty = [Some(Penalty { linear: 1e6, quadratic: 0.0 }); 3];
        let truth = oracle::solve(&least, 1e-10);
        let total = |state: &dyn Fn(usize) -> [f64; 4], input: &dyn Fn(usize) -> [f64; 2]| -> f64 {
            let of = |k: usize| {
                let rows = &problem.stages[k].rows;
                let x = if k == 0 { problem.initial_state } else { state(k) };
                let value = |r| row_value(rows, r, &x, &input(k));
                (rows.lower[0] - value(0)).max(0.0) + (value(1) - rows.upper[1]).max(0.0)
            };
            (0..HORIZON).map(of).sum()
        };
        let ours = total(&|k| solver.state(k), &|k| solver.input(k));
        let theirs = total(&|k| truth.states[k - 1], &|k| truth.inputs[k]);
        assert!(ours <= theirs * (1.0 + 1e-4), "seed {seed}: violation {ours} against {theirs}");
    }
}

/// A row that nothing moves holds, and changes nothing, or is violated, and said to be.
#[test]
fn rows_of_zeros_hold_or_are_violated() {
    for (lower, upper, holds) in [(0.0, 0.0, true), (-1.0, 2.0, true), (0.5, 1.0, false), (-2.0, -2.0, false)]
    {
        let plain = QpProblem { row_penalty: [None; 3], ..without_rows(&problem(3)) };
        let mut with = plain.clone();
        (with.stages[4].rows.lower[1], with.stages[4].rows.upper[1]) = (lower, upper);
        let ((a, before), (b, after)) = (solve(&plain), solve(&with));
        assert_eq!(before.status, QpStatus::Solved);
        let expected = if holds { QpStatus::Solved } else { QpStatus::Relaxed };
        assert_eq!(after.status, expected, "{lower} to {upper}: {after:?}");
        if holds {
            assert_eq!((before, a.input(0)), (after, b.input(0)));
        } else {
            assert!(after.residuals.primal > 0.4);
        }
        // Soft, it is a constant cost.
        with.row_penalty[1] = Some(Penalty { linear: 2.0, quadratic: 4.0 });
        let (_, soft) = solve(&with);
        let away = lower.max(-upper).max(0.0);
        let cost = before.cost + 2.0 * away + 2.0 * away * away;
        assert_eq!(soft.status, QpStatus::Solved);
        assert!((soft.cost - cost).abs() < 1e-7 * cost.abs().max(1.0), "{soft:?}, {cost}");
    }
}

/// Rows of the given state alone do not restrict the inputs.
#[test]
fn a_row_of_the_first_state_is_judged_as_it_is() {
    let mut problem = QpProblem { row_penalty: [None; 3], ..without_rows(&problem(5)) };
    problem.stages[0].rows.state_matrix[2] = [1e3, 0.0, 0.0, 0.0];
    let value = 1e3 * problem.initial_state[0];
    problem.stages[0].rows.upper[2] = value;
    assert_eq!(solve(&problem).1.status, QpStatus::Solved);
    problem.stages[0].rows.upper[2] = value - 1.0;
    let (_, report) = solve(&problem);
    assert_eq!(report.status, QpStatus::Relaxed, "{report:?}");
}

#[test]
fn updated_rows_equal_a_fresh_solve_bit_for_bit() {
    let mut used = QpSolver::new(HORIZON, SETTINGS).unwrap();
    for seed in 0..60 {
        let mut problem = problem(seed);
        match seed % 10 {
            3 => problem.stages[4].rows.lower = [40.0; 3],
            5 => problem.stages[2].rows.upper = problem.stages[2].rows.lower,
            7 => problem.stages[4].rows.state_matrix[0][0] = f64::INFINITY,
            _ => {}
        }
        if seed % 10 == 3 {
            problem.stages[4].rows.upper = [50.0; 3];
        }
        let mut fresh = QpSolver::new(HORIZON, SETTINGS).unwrap();
        let (a, b) = (used.solve(&problem), fresh.solve(&problem));
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
        assert_eq!(bits(&used), bits(&fresh), "seed {seed}");
        used.solve_warm(&problem);
        used.shift();
    }
}

#[test]
fn a_warm_start_with_rows_reaches_the_same_optimum() {
    let (mut cold, mut warm) = (0, 0);
    for seed in 0..100 {
        let mut problem = problem(seed);
        let (mut solver, _) = solve(&problem);
        problem.initial_state = problem.initial_state.map(|x| x + 1e-4);
        let (fresh, of_fresh) = solve(&problem);
        if of_fresh.status != QpStatus::Solved {
            continue;
        }
        let report = solver.solve_warm(&problem);
        assert_eq!(report.status, QpStatus::Solved, "seed {seed}: {report:?}");
        warm += report.iterations;
        cold += of_fresh.iterations;
        for k in 0..HORIZON {
            for (a, b) in solver.input(k).into_iter().zip(fresh.input(k)) {
                assert!((a - b).abs() < 1e-4, "seed {seed}, stage {k}: {a} and {b}");
            }
        }
    }
    println!("iterations: {cold} cold, {warm} warm");
    assert!(warm < cold);
}

/// The multipliers of the rows move on with the stages, those of the end stay.
#[test]
fn shifting_moves_the_rows_multipliers() {
    for seed in 0..10 {
        let (mut solver, _) = solve(&problem(seed));
        let before: Vec<_> = (0..=HORIZON).map(|k| solver.row_multipliers(k)).collect();
        solver.shift();
        // The units of the rows do not move: they are data.
        let sum = |forces: &[[f64; 2]; 3]| forces.as_flattened().iter().filter(|l| **l > 1e-9).count();
        for k in 0..HORIZON - 1 {
            assert_eq!(sum(&solver.row_multipliers(k)), sum(&before[k + 1]), "seed {seed}, node {k}");
        }
        assert_eq!(solver.row_multipliers(HORIZON - 1), before[HORIZON - 1]);
        assert_eq!(solver.row_multipliers(HORIZON), before[HORIZON]);
    }
}

#[test]
fn senseless_rows_are_refused() {
    let spoil: [fn(&mut QpProblem<4, 2, 3>); 8] = [
        |p| p.stages[1].rows.state_matrix[0][1] = f64::NAN,
        |p| p.stages[1].rows.input_matrix[2][0] = f64::NEG_INFINITY,
        |p| (p.stages[2].rows.lower[1], p.stages[2].rows.upper[1]) = (1.0, 0.5),
        |p| p.stages[2].rows.lower[1] = f64::INFINITY,
        |p| p.terminal_rows.upper[1] = f64::NAN,
        |p| p.terminal_rows.state_matrix[0][0] = f64::INFINITY,
        |p| p.row_penalty[0] = Some(Penalty { linear: 0.0, quadratic: 1.0 }),
        // Nothing finite is left of this side in units of the row.
        |p| {
            p.stages[3].rows.state_matrix[0] = [1e-200; 4];
            p.stages[3].rows.input_matrix[0] = [0.0; 2];
            (p.stages[3].rows.lower[0], p.stages[3].rows.upper[0]) = (1e200, f64::INFINITY);
        },
    ];
    for (i, spoil) in spoil.into_iter().enumerate() {
        let mut problem = problem(0);
        spoil(&mut problem);
        let (solver, report) = solve(&problem);
        assert_eq!(report.status, QpStatus::Invalid, "case {i}");
        for (u, [low, high]) in solver
            .input(0)
            .into_iter()
            .zip([0, 1].map(|i| [problem.stages[0].input_lower[i], problem.stages[0].input_upper[i]]))
        {
            assert!(low <= u && u <= high, "case {i}");
        }
    }
    assert_eq!(QpSolver::<2, 1, 33>::new(5, SETTINGS).err(), Some(QpError::Size));
}

/// A row in other units is the same row.
#[test]
fn units_of_rows_do_not_matter() {
    for seed in 0..30 {
        let plain = problem(seed);
        let (a, of_plain) = solve(&plain);
        for unit in [2.0_f64.powi(40), 2.0_f64.powi(-40)] {
            let mut scaled = plain.clone();
            let all = scaled.stages.iter_mut().map(|stage| &mut stage.rows);
            for rows in all {
                rows.state_matrix.as_flattened_mut().iter_mut().for_each(|c| *c *= unit);
                rows.input_matrix.as_flattened_mut().iter_mut().for_each(|d| *d *= unit);
                rows.lower.iter_mut().chain(&mut rows.upper).for_each(|side| *side *= unit);
            }
            let end = &mut scaled.terminal_rows;
            end.state_matrix.as_flattened_mut().iter_mut().for_each(|c| *c *= unit);
            end.lower.iter_mut().chain(&mut end.upper).for_each(|side| *side *= unit);
            for penalty in scaled.row_penalty.iter_mut().flatten() {
                penalty.linear /= unit;
                penalty.quadratic /= unit * unit;
            }
            let (b, of_scaled) = solve(&scaled);
            assert_eq!(of_plain, of_scaled, "seed {seed}");
            assert!((0..HORIZON).all(|k| a.input(k) == b.input(k)), "seed {seed}");
        }
    }
}

/// An input whose bounds are equal is not a variable, whatever rows say of it.
#[test]
fn rows_do_not_move_fixed_inputs() {
    for seed in 0..40 {
        let mut problem = problem(seed);
        for stage in &mut problem.stages {
            let value = stage.input_lower[1] + 0.005;
            (stage.input_lower[1], stage.input_upper[1]) = (value, value);
        }
        let (solver, report) = solve(&problem);
        let truth = oracle::solve(&problem, 1e-10);
        assert_eq!(truth.status, SolverStatus::Solved, "seed {seed}");
        assert_eq!(report.status, QpStatus::Solved, "seed {seed}: {report:?}");
        let scale = truth.cost.abs().max(1.0);
        assert!((report.cost - truth.cost).abs() < 1e-7 * scale, "seed {seed}: {report:?}");
        assert!(report.residuals.gap < 1e-7 * scale, "seed {seed}: {report:?}");
        let fixed = problem.stages.iter().enumerate().all(|(k, s)| solver.input(k)[1] == s.input_lower[1]);
        assert!(fixed, "seed {seed}");
    }
}
