//! The QP solver compared with Clarabel, cold and warm, over horizons and sizes:
//! `cargo bench -p gelenk-runtime --bench qp`.
//!
//! Problems: joints with random inertia coupling and gravity, sampled at 20 ms, thrown off their position,
//! with tight bounds of torque and speed; Clarabel is timed without its setup. Times are CPU times of the
//! thread, medians over the problems of the best of several rounds. Not wall-clock times: on a busy machine a
//! solve of several milliseconds is preempted while one of a fraction of a millisecond mostly is not, which
//! would flatter the quicker solver (seen: a ratio of 65 where it is 21).

#[path = "../tests/support/mod.rs"]
mod support;

use clarabel::solver::IPSolver;
use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
use rustix::time::{ClockId, clock_gettime};
use support::oracle;
use support::random_qp::Random;

const PROBLEMS: u64 = 20;
const ROUNDS: usize = 5;
const TOLERANCE: f64 = 1e-6;

/// `NX = 2 NU`: positions, then velocities.
fn arm<const NX: usize, const NU: usize>(horizon: usize, seed: u64) -> QpProblem<NX, NU> {
    const PERIOD: f64 = 0.02;
    let mut random = Random::new(seed);
    let mut problem = QpProblem::<NX, NU>::new(horizon);
    for i in 0..NU {
        problem.initial_state[i] = 0.3 * random.sym();
        problem.initial_state[NU + i] = 0.3 * random.sym();
        (problem.state_weight[i][i], problem.state_weight[NU + i][NU + i]) = (400.0, 4.0);
        (problem.terminal_weight[i][i], problem.terminal_weight[NU + i][NU + i]) = (2500.0, 10.0);
        problem.input_weight[i][i] = 0.01;
    }
    let (stiffness, inverse_inertia) = (random.matrix::<NU, NU>(), random.positive::<NU>(0.3));
    for stage in &mut problem.stages {
        for i in 0..NU {
            for j in 0..NU {
                let identity = if i == j { 1.0 } else { 0.0 };
                let pull = PERIOD * (3.0 * stiffness[i][j] + 0.3 * random.sym());
                let drag = PERIOD * (0.5 * identity + 0.2 * random.sym());
                stage.state_matrix[i][j] = identity + 0.5 * PERIOD * pull;
                stage.state_matrix[i][NU + j] = PERIOD * identity;
                stage.state_matrix[NU + i][j] = pull;
                stage.state_matrix[NU + i][NU + j] = identity - drag;
                stage.input_matrix[i][j] = 0.5 * PERIOD * PERIOD * inverse_inertia[i][j];
                stage.input_matrix[NU + i][j] = PERIOD * inverse_inertia[i][j];
            }
            (stage.input_lower[i], stage.input_upper[i]) = (-12.0, 12.0);
            (stage.state_lower[i], stage.state_upper[i]) = (-3.0, 3.0);
            (stage.state_lower[NU + i], stage.state_upper[NU + i]) = (-0.6, 0.6);
        }
    }
    problem
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

/// CPU time of this thread in microseconds.
fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

/// Microseconds of the quickest of several rounds.
fn quickest(mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = cpu_time();
        work();
        best = best.min(cpu_time() - start);
    }
    best
}

fn row<const NX: usize, const NU: usize>(horizon: usize) {
    let settings = QpSettings { tolerance: TOLERANCE, ..QpSettings::default() };
    let Ok(mut solver) = QpSolver::<NX, NU>::new(horizon, settings) else {
        return;
    };
    let (mut cold, mut warm, mut peer, mut iterations, mut warm_iterations, mut failures) =
        (vec![], vec![], vec![], vec![], vec![], 0);
    for seed in 0..PROBLEMS {
        let problem = arm::<NX, NU>(horizon, seed);
        cold.push(quickest(|| {
            std::hint::black_box(solver.solve(&problem));
        }));
        let report = solver.solve(&problem);
        failures += usize::from(report.status != QpStatus::Solved);
        iterations.push(report.iterations as f64);
        // The next problem of a receding horizon: one stage on, from where the first input leads.
        let mut next = problem.clone();
        next.initial_state = solver.state(1);
        let mut times = vec![];
        for _ in 0..ROUNDS {
            solver.solve(&problem);
            solver.shift();
            let start = cpu_time();
            let report = solver.solve_warm(&next);
            times.push(cpu_time() - start);
            warm_iterations.push(report.iterations as f64);
        }
        warm.push(times.into_iter().fold(f64::INFINITY, f64::min));
        let mut sparse = oracle::sparse(&problem, TOLERANCE).solver;
        peer.push(quickest(|| sparse.solve()));
    }
    let most = iterations.iter().copied().fold(0.0, f64::max);
    let (cold, warm, peer) = (median(cold), median(warm), median(peer));
    println!(
        "{NX:>3}/{NU:<2} N = {horizon:<4} {cold:>8.1} us ({:>6.3} per stage and iteration, {:.0} iterations, most {most:.0})  warm {warm:>8.1} us ({:.0})  Clarabel {peer:>9.1} us  ratio {:>5.1}  unsolved {failures}",
        cold / horizon as f64 / median(iterations.clone()).max(1.0),
        median(iterations),
        median(warm_iterations),
        peer / cold
    );
}

fn main() {
    for horizon in [10, 20, 50, 100] {
        row::<4, 2>(horizon);
    }
    for horizon in [10, 20, 50, 100] {
        row::<12, 6>(horizon);
    }
    row::<2, 1>(20);
    row::<14, 7>(20);
}
