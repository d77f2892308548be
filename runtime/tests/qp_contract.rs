//! Contract of the QP solver except the optimum: KKT conditions, infeasible and senseless problems, updates,
//! warm starts, horizons.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::kkt::kkt;
use crate::support::{oracle, random_qp};
use gelenk_runtime::qp::{Penalty, QpError, QpProblem, QpSettings, QpSolver, QpStatus};

const SETTINGS: QpSettings = QpSettings { tolerance: 1e-10, feasibility: 1e-10, max_iterations: 50 };

fn problem(seed: u64) -> QpProblem<4, 2> {
    random_qp::random_qp(seed, random_qp::Kind { horizon: 10, ..random_qp::kind_of(seed) })
}

/// Bit patterns of all inputs, states and multipliers.
fn bits<const NX: usize, const NU: usize>(solver: &QpSolver<NX, NU>) -> Vec<u64> {
    let mut all = vec![];
    for k in 0..solver.horizon() {
        all.extend(solver.input(k));
        all.extend(solver.state(k + 1));
        all.extend(solver.input_multipliers(k).as_flattened());
        all.extend(solver.state_multipliers(k + 1).as_flattened());
    }
    all.into_iter().map(f64::to_bits).collect()
}

#[test]
fn kkt_conditions_hold() {
    for seed in 0..200 {
        let problem = problem(seed);
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        let report = solver.solve(&problem);
        assert_eq!(report.status, QpStatus::Solved);
        let scale = report.cost.abs().max(1.0);
        let residual = kkt(&problem, &solver);
        assert!(residual < 1e-7 * scale, "seed {seed}: {residual:e} {report:?}");
        assert!(report.residuals.stationarity < 1e-7 * scale, "seed {seed}: {report:?}");
    }
}

/// Infinite or absurd data of one problem do not influence the next solution.
#[test]
fn a_solve_after_absurd_data_is_that_of_a_new_solver() {
    for seed in 0..20 {
        let sane = problem(seed);
        let expected = QpSolver::new(10, SETTINGS).unwrap().solve(&sane);
        for size in [1e30, 1e100, 1e160, 1e308] {
            let mut absurd = sane.clone();
            absurd.initial_state = [size; 4];
            let mut solver = QpSolver::new(10, SETTINGS).unwrap();
            for report in [solver.solve(&absurd), solver.solve_warm(&absurd)] {
                assert!(report.status != QpStatus::Solved || report.cost.is_finite());
            }
            assert_eq!(solver.solve(&sane), expected, "seed {seed}, {size:e}");
        }
    }
}

#[test]
fn inputs_never_leave_their_bounds() {
    for seed in 0..200 {
        let problem = problem(seed);
        for max_iterations in [0, 1, 3, 50] {
            let mut solver = QpSolver::new(10, QpSettings { max_iterations, ..SETTINGS }).unwrap();
            let report = solver.solve(&problem);
            assert!(report.iterations <= 3 * max_iterations);
            for (k, stage) in problem.stages.iter().enumerate() {
                for (i, u) in solver.input(k).into_iter().enumerate() {
                    assert!(
                        stage.input_lower[i] <= u && u <= stage.input_upper[i],
                        "seed {seed}, cap {max_iterations}"
                    );
                }
            }
        }
    }
}

/// A hard state bound out of reach: the violation is as small as Clarabel finds it can be, in bounded time.
#[test]
fn an_infeasible_state_bound_gives_the_least_violation() {
    for seed in 0..60 {
        let kind = random_qp::Kind {
            horizon: 10,
            spectral_radius: 0.9,
            state_bounds: false,
            soft: false,
            rate: seed % 2 == 0,
        };
        let mut problem = random_qp::random_qp::<4, 2>(seed, kind);
        for stage in &mut problem.stages {
            stage.state_lower[0] = 3.0;
            stage.state_upper[1] = -2.0;
            // Bounded on both sides, so that no input is large enough for its own cost to count relative to the
            // violation.
            stage.input_upper = stage.input_lower.map(|lower| lower + 0.4);
        }
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        let report = solver.solve(&problem);
        assert_eq!(report.status, QpStatus::Relaxed, "seed {seed}: {report:?}");
        assert!(report.iterations <= 100 && report.residuals.primal > 0.1);
        let mut least = problem.clone();
        least.state_penalty = [Some(Penalty { linear: 1e6, quadratic: 0.0 }); 4];
        let truth = oracle::solve(&least, 1e-10);
        let total = |state: &dyn Fn(usize) -> [f64; 4]| -> f64 {
            (0..10).map(|k| (3.0 - state(k)[0]).max(0.0) + (state(k)[1] + 2.0).max(0.0)).sum()
        };
        let (ours, theirs) = (total(&|k| solver.state(k + 1)), total(&|k| truth.states[k]));
        assert!(ours <= theirs * (1.0 + 1e-4), "seed {seed}: violation {ours} against {theirs}");
    }
}

/// An initial state outside its bounds is not an obstacle where the input can bring the next state back.
#[test]
fn an_exact_penalty_keeps_a_soft_bound_that_can_be_kept() {
    for seed in 0..50 {
        let kind = random_qp::Kind {
            horizon: 8,
            spectral_radius: 0.9,
            state_bounds: true,
            soft: false,
            rate: false,
        };
        let hard = random_qp::random_qp::<4, 2>(seed, kind);
        let mut soft = hard.clone();
        soft.state_penalty = [Some(Penalty { linear: 1e5, quadratic: 0.0 }); 4];
        let mut solvers = [0, 1].map(|_| QpSolver::new(8, SETTINGS).unwrap());
        assert_eq!(solvers[0].solve(&hard).status, QpStatus::Solved);
        assert_eq!(solvers[1].solve(&soft).status, QpStatus::Solved);
        for k in 0..8 {
            for (a, b) in solvers[0].input(k).into_iter().zip(solvers[1].input(k)) {
                assert!((a - b).abs() < 1e-5, "seed {seed}, stage {k}: {a} and {b}");
            }
        }
    }
}

#[test]
fn updated_data_equal_a_fresh_solve_bit_for_bit() {
    let mut used = QpSolver::new(10, SETTINGS).unwrap();
    for seed in 0..100 {
        let mut problem = problem(seed);
        if seed % 10 == 3 {
            problem.stages[4].state_lower = [40.0; 4];
        }
        if seed % 10 == 7 {
            problem.stages[4].affine[0] = f64::INFINITY;
        }
        let mut fresh = QpSolver::new(10, SETTINGS).unwrap();
        let (a, b) = (used.solve(&problem), fresh.solve(&problem));
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
        assert_eq!(bits(&used), bits(&fresh), "seed {seed}");
        used.solve_warm(&problem);
        used.shift();
    }
}

#[test]
fn a_warm_start_reaches_the_same_optimum() {
    let (mut cold, mut warm) = (0, 0);
    for seed in 0..200 {
        let mut problem = problem(seed);
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        solver.solve(&problem);
        for x in &mut problem.initial_state {
            *x += 1e-4;
        }
        let mut fresh = QpSolver::new(10, SETTINGS).unwrap();
        let (a, b) = (solver.solve_warm(&problem), fresh.solve(&problem));
        if b.status != QpStatus::Solved {
            continue;
        }
        assert_eq!(a.status, QpStatus::Solved, "seed {seed}");
        warm += a.iterations;
        cold += b.iterations;
        for k in 0..10 {
            for (a, b) in solver.input(k).into_iter().zip(fresh.input(k)) {
                assert!((a - b).abs() < 1e-4, "seed {seed}, stage {k}: {a} and {b}");
            }
        }
    }
    println!("iterations: {cold} cold, {warm} warm");
    assert!(warm < cold);
}

/// From period to period the active set changes little: warm solves of shifted plans take less than two thirds
/// of the iterations of cold ones.
#[test]
fn shifted_plans_keep_their_active_set() {
    let (mut cold, mut warm) = (0, 0);
    for seed in 0..50 {
        let mut problem = problem(seed);
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        solver.solve(&problem);
        for _ in 0..10 {
            problem.initial_state = solver.state(1).map(|x| x + 1e-4);
            problem.previous_input = solver.input(0);
            problem.stages.rotate_left(1);
            problem.stages[9] = problem.stages[8].clone();
            let fresh = QpSolver::new(10, SETTINGS).unwrap().solve(&problem);
            solver.shift();
            let report = solver.solve_warm(&problem);
            assert_eq!(report.status, fresh.status, "seed {seed}");
            if fresh.status != QpStatus::Solved {
                break;
            }
            let difference = (report.cost - fresh.cost).abs();
            assert!(difference <= 2e-10 * fresh.cost.abs() + 1e-12, "seed {seed}: {report:?} {fresh:?}");
            warm += report.iterations;
            cold += fresh.iterations;
        }
    }
    println!("iterations: {cold} cold, {warm} warm");
    assert!(3 * warm < 2 * cold);
}

/// A warm start that leads nowhere, here since the bounds are out of reach, leaves the cold one what a new solver has.
#[test]
fn a_start_that_fails_is_followed_by_that_of_a_new_solver() {
    let mut failed = 0;
    for seed in 0..50 {
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        solver.solve(&problem(seed));
        let mut other = problem(seed + 25);
        for stage in &mut other.stages[4..6] {
            (stage.state_lower, stage.state_upper) = ([30.0; 4], [31.0; 4]);
        }
        let mut fresh = QpSolver::new(10, SETTINGS).unwrap();
        let (a, b) = (solver.solve_warm(&other), fresh.solve(&other));
        assert_eq!((a.status, b.status), (QpStatus::Relaxed, QpStatus::Relaxed), "seed {seed}");
        assert_eq!(bits(&solver), bits(&fresh), "seed {seed}");
        failed += u32::from(a.iterations > b.iterations);
    }
    assert!(failed > 40, "{failed} warm starts");
}

#[test]
fn without_active_bounds_one_factorization_is_enough() {
    let mut problem = problem(0);
    for stage in &mut problem.stages {
        stage.input_lower = [-1e6; 2];
        stage.input_upper = [1e6; 2];
        stage.state_lower = [f64::NEG_INFINITY; 4];
        stage.state_upper = [f64::INFINITY; 4];
    }
    let mut solver = QpSolver::new(10, SETTINGS).unwrap();
    let report = solver.solve(&problem);
    assert_eq!((report.status, report.iterations), (QpStatus::Solved, 0));
    assert!(kkt(&problem, &solver) < 1e-9);
}

/// Without bounds there is no complementarity that could tell a warm start how far it is from the new
/// optimum.
#[test]
fn a_warm_start_without_bounds_takes_in_new_data() {
    for seed in 0..20 {
        let mut problem = problem(seed);
        for stage in &mut problem.stages {
            (stage.input_lower, stage.input_upper) = ([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]);
            (stage.state_lower, stage.state_upper) = ([f64::NEG_INFINITY; 4], [f64::INFINITY; 4]);
        }
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        solver.solve(&problem);
        problem.initial_state = problem.initial_state.map(|x| 2.0 - 3.0 * x);
        solver.shift();
        let report = solver.solve_warm(&problem);
        assert_eq!(report.status, QpStatus::Solved, "seed {seed}");
        let residual = kkt(&problem, &solver);
        assert!(residual < 1e-9 * report.cost.abs().max(1.0), "seed {seed}: {residual:e}");
    }
}

/// One stage, one input, no state cost: `½ u² + ½ w (u − u₋₁)²` is least at `u = w u₋₁/(1 + w)`.
#[test]
fn the_cost_holds_the_first_change_of_the_input() {
    let mut problem = QpProblem::<1, 1>::new(1);
    problem.input_weight = [[1.0]];
    problem.input_rate_weight = [[3.0]];
    problem.previous_input = [4.0];
    problem.stages[0].input_matrix = [[1.0]];
    let mut solver = QpSolver::new(1, SETTINGS).unwrap();
    let report = solver.solve(&problem);
    assert!((solver.input(0)[0] - 3.0).abs() < 1e-12);
    assert!((report.cost - 6.0).abs() < 1e-12, "{report:?}");
}

/// Whatever overflows on the way: what counts as solved satisfies the KKT conditions, and every input is a
/// number within its bounds.
#[test]
fn numbers_that_overflow_are_never_called_solved() {
    let spoil: [fn(&mut QpProblem<4, 2>, f64); 7] = [
        |p, v| p.initial_state[0] = v,
        |p, v| p.state_weight[1][1] = v,
        |p, v| p.stages[2].affine = [v; 4],
        |p, v| p.stages[2].state_matrix[1][1] = v,
        |p, v| p.stages[3].input_gradient = [v; 2],
        |p, v| p.stages[3].state_gradient = [-v; 4],
        |p, v| p.stages[3].state_lower = [v; 4],
    ];
    let mut invalid = 0;
    for (case, spoil) in spoil.into_iter().enumerate() {
        for size in [1e20, 1e100, 1e155, 1e200, 1e300] {
            let mut problem = problem(1);
            spoil(&mut problem, size);
            for (state, upper) in
                problem.stages.iter_mut().flat_map(|s| s.state_lower.iter().zip(&mut s.state_upper))
            {
                *upper = upper.max(*state);
            }
            let mut solver = QpSolver::new(10, SETTINGS).unwrap();
            for report in [solver.solve(&problem), solver.solve_warm(&problem)] {
                let what = format!("case {case}, {size:e}: {report:?}");
                let finite = (0..10).all(|k| solver.state(k + 1).iter().all(|x| x.is_finite()));
                assert!(finite, "{what}");
                if report.status == QpStatus::Solved {
                    assert!(report.cost.is_finite(), "{what}");
                    let residual = kkt(&problem, &solver);
                    assert!(residual <= 1e-6 * report.cost.abs().max(1.0), "{what}, {residual:e}");
                }
                invalid += usize::from(report.status == QpStatus::Invalid);
                for (k, stage) in problem.stages.iter().enumerate() {
                    for (i, u) in solver.input(k).into_iter().enumerate() {
                        assert!(stage.input_lower[i] <= u && u <= stage.input_upper[i], "{what}");
                    }
                }
            }
        }
    }
    assert!(invalid > 0);
}

/// Neither the inputs nor what they lead to costs anything: the optimum is not unique, and there is nothing
/// to factorize.
#[test]
fn a_problem_without_curvature_is_invalid() {
    let mut problem = problem(1);
    (problem.input_weight, problem.input_rate_weight) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
    (problem.state_weight, problem.terminal_weight) = ([[0.0; 4]; 4], [[0.0; 4]; 4]);
    let mut solver = QpSolver::new(10, SETTINGS).unwrap();
    assert_eq!(solver.solve(&problem).status, QpStatus::Invalid);
}

/// A state that must pass through a point does so, within the tolerance; where that cannot be, the report
/// says so.
#[test]
fn equal_bounds_of_a_state_are_an_equality() {
    let mut problem = problem(2);
    for stage in &mut problem.stages {
        (stage.state_lower, stage.state_upper) = ([f64::NEG_INFINITY; 4], [f64::INFINITY; 4]);
        (stage.input_lower, stage.input_upper) = ([-50.0; 2], [50.0; 2]);
    }
    problem.state_penalty = [None; 4];
    for (target, status) in [(0.3, QpStatus::Solved), (1e6, QpStatus::Relaxed)] {
        problem.stages[6].state_lower[1] = target;
        problem.stages[6].state_upper[1] = target;
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        let report = solver.solve(&problem);
        assert_eq!(report.status, status, "{report:?}");
        let kept = (solver.state(7)[1] - target).abs() <= 1e-9;
        assert_eq!(kept, status == QpStatus::Solved, "{:?}", solver.state(7));
    }
}

#[test]
fn senseless_data_are_refused_with_a_usable_input() {
    let spoil: [fn(&mut QpProblem<4, 2>); 7] = [
        |p| p.initial_state[1] = f64::NAN,
        |p| p.stages[3].state_matrix[0][0] = f64::INFINITY,
        |p| p.stages[3].state_lower[0] = f64::NAN,
        |p| p.stages[2].input_lower = [0.75; 2],
        |p| p.input_weight = [[-100.0, 0.0], [0.0, -100.0]],
        |p| p.state_penalty[0] = Some(Penalty { linear: -1.0, quadratic: 0.0 }),
        |p| p.stages.truncate(5),
    ];
    for (i, spoil) in spoil.into_iter().enumerate() {
        let mut problem = problem(0);
        for stage in &mut problem.stages {
            (stage.input_lower, stage.input_upper) = ([0.25; 2], [0.5; 2]);
        }
        spoil(&mut problem);
        let mut solver = QpSolver::new(10, SETTINGS).unwrap();
        assert_eq!(solver.solve(&problem).status, QpStatus::Invalid, "case {i}");
        assert_eq!(solver.input(0), [0.25; 2], "case {i}");
    }
}

#[test]
fn fixed_inputs_are_allowed() {
    let mut problem = problem(3);
    for stage in &mut problem.stages {
        stage.input_lower[0] = 0.1;
        stage.input_upper[0] = 0.1;
        stage.state_lower = [f64::NEG_INFINITY; 4];
        stage.state_upper = [f64::INFINITY; 4];
    }
    let mut solver = QpSolver::new(10, SETTINGS).unwrap();
    let report = solver.solve(&problem);
    assert_eq!(report.status, QpStatus::Solved, "{report:?}");
    assert!((0..10).all(|k| solver.input(k)[0] == 0.1));
}

#[test]
fn horizons_from_one_to_a_hundred() {
    for horizon in [1, 2, 50, 100] {
        let kind =
            random_qp::Kind { horizon, spectral_radius: 0.95, state_bounds: true, soft: false, rate: false };
        let mut solver = QpSolver::<4, 2>::new(horizon, SETTINGS).unwrap();
        assert_eq!(solver.solve(&random_qp::random_qp(1, kind)).status, QpStatus::Solved);
    }
    assert_eq!(QpSolver::<4, 2>::new(0, SETTINGS).err(), Some(QpError::Horizon(0)));
    assert_eq!(QpSolver::<4, 2>::new(101, SETTINGS).err(), Some(QpError::Horizon(101)));
    assert_eq!(QpSolver::<33, 2>::new(10, SETTINGS).err(), Some(QpError::Size));
}
