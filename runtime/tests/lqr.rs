//! Regulators against published solutions, and the structure that every solution has.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::support::random_qp::Random;
use gelenk_runtime::lqr::{Lqr, LqrError, TimeVaryingLqr};
use gelenk_runtime::qp::{QpProblem, QpSettings, QpSolver, QpStatus};
use nalgebra::{DMatrix, SymmetricEigen};

fn m<const R: usize, const C: usize>(rows: &[[f64; C]; R]) -> DMatrix<f64> {
    DMatrix::from_fn(R, C, |i, j| rows[i][j])
}

fn residual<const NX: usize, const NU: usize>(
    a: &[[f64; NX]; NX],
    b: &[[f64; NU]; NX],
    q: &[[f64; NX]; NX],
    r: &[[f64; NU]; NU],
    p: &[[f64; NX]; NX],
) -> f64 {
    let (a, b, q, r, p) = (m(a), m(b), m(q), m(r), m(p));
    let h = r + b.transpose() * &p * &b;
    let coupling = b.transpose() * &p * &a;
    let next = q + a.transpose() * &p * &a - coupling.transpose() * h.try_inverse().unwrap() * &coupling;
    (next - &p).amax() / p.amax()
}

/// Benner, Laub, Mehrmann, *A collection of benchmark examples for the numerical solution of algebraic Riccati equations II: discrete-time case*
/// (TU Chemnitz SPC 95-23), example 1.1 with its exact solution: A = [4 3; −9/2 −7/2], B = [1; −1], R = 1, Q = [9 6; 6 4],
/// P = ½(1 + √5) Q.
#[test]
fn benchmark_example_1_1() {
    let q = [[9.0, 6.0], [6.0, 4.0]];
    let lqr = Lqr::new(&[[4.0, 3.0], [-4.5, -3.5]], &[[1.0], [-1.0]], &q, &[[1.0]]).unwrap();
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    for i in 0..2 {
        for j in 0..2 {
            assert!((lqr.cost_to_go[i][j] - golden * q[i][j]).abs() < 1e-10, "{:?}", lqr.cost_to_go);
        }
    }
}

/// The scalar equation `p² b² + p (r − a² r − q b²) − q r = 0`, solved by the quadratic formula (Anderson,
/// Moore 1990, chapter 2).
#[test]
fn the_scalar_equation() {
    for (a, b, q, r) in
        [(1.0, 1.0, 1.0, 1.0), (2.0, 0.5, 3.0, 0.1), (0.3, 1.0, 1.0, 5.0), (-1.5, 2.0, 0.01, 1.0)]
    {
        let (square, linear, constant): (f64, f64, f64) = (b * b, r - a * a * r - q * b * b, -q * r);
        let p = (-linear + (linear * linear - 4.0 * square * constant).sqrt()) / (2.0 * square);
        let lqr = Lqr::new(&[[a]], &[[b]], &[[q]], &[[r]]).unwrap_or_else(|e| panic!("{a} {b} {q} {r}: {e}"));
        assert!((lqr.cost_to_go[0][0] - p).abs() < 1e-9 * p, "{a} {b}: {} against {p}", lqr.cost_to_go[0][0]);
        assert!((lqr.gain[0][0] + a * b * p / (r + b * b * p)).abs() < 1e-9);
    }
}

fn structure<const NX: usize, const NU: usize>(seed: u64) {
    let mut random = Random::new(seed);
    let mut a = random.matrix::<NX, NX>();
    let radius = m(&a).complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max);
    let wanted = [0.5, 0.99, 1.0, 1.2, 2.0][(seed % 5) as usize];
    a.iter_mut().flatten().for_each(|v| *v *= wanted / radius);
    let (b, q, r) = (random.matrix::<NX, NU>(), random.positive::<NX>(0.01), random.positive::<NU>(0.01));
    let lqr = Lqr::new(&a, &b, &q, &r).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    let p = &lqr.cost_to_go;
    for i in 0..NX {
        for j in 0..NX {
            assert!((p[i][j] - p[j][i]).abs() <= 1e-10 * m(p).amax(), "P = Pᵀ");
        }
    }
    assert!(SymmetricEigen::new(m(p)).eigenvalues.min() > 0.0, "P > 0 for Q > 0");
    assert!(residual(&a, &b, &q, &r, p) < 1e-8, "seed {seed}: {}", residual(&a, &b, &q, &r, p));
    let closed = m(&a) + m(&b) * m(&lqr.gain);
    assert!(closed.complex_eigenvalues().iter().all(|e| e.norm() < 1.0), "A + B K stable");
    // The limit of the finite horizon, from any terminal weight.
    let mut long = TimeVaryingLqr::<NX, NU>::new(100).unwrap();
    for k in 0..100 {
        long.set_stage(k, &a, &b);
    }
    long.solve(&q, &r, p).unwrap();
    for (i, row) in long.gain(0).iter().enumerate() {
        for (j, k) in row.iter().enumerate() {
            assert!((k - lqr.gain[i][j]).abs() < 1e-7 * m(&lqr.gain).amax().max(1.0), "seed {seed}");
        }
    }
}

#[test]
fn every_solution_has_its_structure() {
    for seed in 0..100 {
        structure::<1, 1>(seed);
        structure::<3, 2>(seed);
        structure::<4, 2>(seed);
        structure::<6, 3>(seed);
    }
}

/// Units do not matter: with states x = D z and inputs u = E w the solution is D P D. Powers of two, so that
/// the data are scaled without rounding.
fn scaled<const NX: usize, const NU: usize>(seed: u64) {
    let mut random = Random::new(seed);
    let (a, b) = (random.matrix::<NX, NX>(), random.matrix::<NX, NU>());
    let (q, r) = (random.positive::<NX>(0.1), random.positive::<NU>(0.1));
    let expected = Lqr::new(&a, &b, &q, &r).unwrap();
    let mut power = || (2.0_f64).powi((20.0 * random.vector::<1>()[0]) as i32);
    let d: [f64; NX] = core::array::from_fn(|_| power());
    let e: [f64; NU] = core::array::from_fn(|_| power());
    let lqr = Lqr::<NX, NU>::new(
        &core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] * d[j] / d[i])),
        &core::array::from_fn(|i| core::array::from_fn(|j| b[i][j] * e[j] / d[i])),
        &core::array::from_fn(|i| core::array::from_fn(|j| q[i][j] * d[i] * d[j])),
        &core::array::from_fn(|i| core::array::from_fn(|j| r[i][j] * e[i] * e[j])),
    )
    .unwrap_or_else(|error| panic!("seed {seed}, {d:?} {e:?}: {error}"));
    let p = &expected.cost_to_go;
    for i in 0..NX {
        for j in 0..NX {
            let found = lqr.cost_to_go[i][j] / (d[i] * d[j]);
            let size = (p[i][i] * p[j][j]).sqrt();
            assert!((found - p[i][j]).abs() < 1e-9 * size, "seed {seed} P {i} {j}");
        }
    }
}

#[test]
fn units_do_not_matter() {
    for seed in 0..100 {
        scaled::<2, 1>(seed);
        scaled::<6, 3>(seed);
        scaled::<8, 2>(seed);
    }
}

/// Joints of 1 to 1e-6 kg m², whose motors bear 100 to 0.1 N m, over periods from 0.1 to 20 ms: P is the cost
/// that a simulation adds up.
#[test]
fn light_joints_beside_heavy_ones_have_a_regulator() {
    let (inertia, torque) = ([1.0_f64, 1e-2, 1e-4, 1e-6], [100.0, 30.0, 1.0, 0.1]);
    for period in [1e-4, 1e-3, 5e-3, 2e-2] {
        let (mut a, mut b, mut q, mut r) = ([[0.0; 8]; 8], [[0.0; 4]; 8], [[0.0; 8]; 8], [[0.0; 4]; 4]);
        for i in 0..4 {
            (a[i][i], a[4 + i][4 + i], a[i][4 + i]) = (1.0, 1.0, period);
            (q[i][i], q[4 + i][4 + i]) = (1e4, 1e2);
            b[i][i] = 0.5 * period * period / inertia[i];
            b[4 + i][i] = period / inertia[i];
            // Inertias couple: every torque accelerates all joints a little.
            for j in 0..4 {
                if i != j {
                    b[4 + i][j] = 0.1 * period / (inertia[i] * inertia[j]).sqrt();
                    b[i][j] = 0.5 * period * b[4 + i][j];
                }
            }
            r[i][i] = 1e-3 / (torque[i] * torque[i]);
        }
        let lqr = Lqr::new(&a, &b, &q, &r).unwrap_or_else(|error| panic!("{period} s: {error}"));
        assert!(lqr.residual < 1e-12, "{period} s: {}", lqr.residual);
        assert!(lqr.residual <= lqr.rounding, "{period} s: {lqr:?}");
        let (k, q, r) = (m(&lqr.gain), m(&q), m(&r));
        let closed = m(&a) + m(&b) * &k;
        let mut x = nalgebra::DVector::from_element(8, 0.1);
        let (first, mut cost, mut steps) = (x.clone(), 0.0, 0);
        while x.amax() > 1e-7 {
            let u = &k * &x;
            cost += x.dot(&(&q * &x)) + u.dot(&(&r * &u));
            x = &closed * x;
            steps += 1;
            assert!(f64::from(steps) * period < 5.0, "{period} s: not stable");
        }
        let promised = (first.transpose() * m(&lqr.cost_to_go) * &first)[0];
        assert!((cost - promised).abs() < 1e-9 * promised, "{period} s: {cost} {promised}");
    }
}

#[test]
fn the_time_varying_limit_is_the_infinite_horizon() {
    let (a, b) = ([[1.0, 0.1], [0.05, 1.0]], [[0.005], [0.1]]);
    let (q, r) = ([[1.0, 0.0], [0.0, 0.1]], [[0.01]]);
    let lqr = Lqr::new(&a, &b, &q, &r).unwrap();
    let mut last = f64::INFINITY;
    for horizon in [5, 20, 100] {
        let mut finite = TimeVaryingLqr::<2, 1>::new(horizon).unwrap();
        for k in 0..horizon {
            finite.set_stage(k, &a, &b);
        }
        finite.solve(&q, &r, &q).unwrap();
        let gap = (finite.cost_to_go()[0][0] - lqr.cost_to_go[0][0]).abs();
        assert!(gap < last);
        last = gap;
    }
    assert!(last < 1e-9);
}

/// The QP without active bounds equals the regulator if P is the terminal weight.
#[test]
fn equals_the_qp_without_active_bounds() {
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let (a, b) = (random.matrix::<4, 4>(), random.matrix::<4, 2>());
        let (q, r) = (random.positive::<4>(0.1), random.positive::<2>(0.1));
        let lqr = Lqr::new(&a, &b, &q, &r).unwrap();
        let mut problem = QpProblem::<4, 2>::new(15);
        (problem.state_weight, problem.input_weight, problem.terminal_weight) = (q, r, lqr.cost_to_go);
        problem.initial_state = random.vector();
        for stage in &mut problem.stages {
            (stage.state_matrix, stage.input_matrix) = (a, b);
        }
        let mut solver = QpSolver::new(15, QpSettings::default()).unwrap();
        assert_eq!(solver.solve(&problem).status, QpStatus::Solved);
        let mut x = problem.initial_state;
        for k in 0..15 {
            let u = lqr.input(&x);
            for i in 0..2 {
                assert!((solver.input(k)[i] - u[i]).abs() < 1e-8, "seed {seed}, stage {k}");
            }
            x = solver.state(k + 1);
        }
    }
}

#[test]
fn systems_without_a_regulator_are_refused() {
    let (q, r) = ([[1.0, 0.0], [0.0, 1.0]], [[1.0]]);
    let unreachable = Lqr::new(&[[1.2, 0.0], [0.0, 0.5]], &[[0.0], [1.0]], &q, &r);
    assert!(matches!(unreachable, Err(LqrError::NotStabilizable(_))), "{unreachable:?}");
    let marginal = Lqr::new(&[[1.0, 0.0], [0.0, 0.5]], &[[1.0], [1.0]], &[[0.0, 0.0], [0.0, 1.0]], &r);
    assert!(matches!(marginal, Err(LqrError::NotStabilizable(_))), "{marginal:?}");
    let invisible = Lqr::new(&[[1.5]], &[[1.0]], &[[0.0]], &[[1.0]]);
    assert!(matches!(invisible, Err(LqrError::NotStabilizable(_))), "{invisible:?}");
    let negative = Lqr::new(&[[0.5, 0.0], [0.0, 0.5]], &[[0.0], [1.0]], &q, &[[-1.0]]);
    assert_eq!(negative, Err(LqrError::NotPositive));
    let nan = Lqr::new(&[[f64::NAN, 0.0], [0.0, 0.5]], &[[0.0], [1.0]], &q, &r);
    assert_eq!(nan, Err(LqrError::NotFinite));
    assert_eq!(TimeVaryingLqr::<2, 1>::new(0).err(), Some(LqrError::Size));
    let stable_but_unreachable = Lqr::new(&[[0.9, 0.0], [0.0, 0.5]], &[[0.0], [1.0]], &q, &r);
    assert!(stable_but_unreachable.is_ok());
}

/// A scalar system a > 1 with a vanishing state weight: the regulator moves the pole to 1/a (Kwakernaak, Sivan, *Linear
/// Optimal Control Systems*, 1972, section 6.4), and |a + k b K| < 1 for a/(a + 1) < k < a/(a − 1). The margins are exact.
#[test]
fn margins_of_an_unstable_pole_are_exact() {
    for a in [1.05, 1.5, 2.0, 10.0] {
        let lqr = Lqr::new(&[[a]], &[[0.3]], &[[1e-12]], &[[1.0]]).unwrap();
        let [low, high] = lqr.margins().gain;
        assert!((low - a / (a + 1.0)).abs() < 1e-9, "{a}: {low}");
        assert!((high - a / (a - 1.0)).abs() < 1e-6 * high, "{a}: {high}");
        let printed = lqr.margins().to_string();
        assert!(printed.contains(&format!("from {low:.2} to {high:.2} and")), "{printed}");
    }
}

/// Regulators in continuous time have gain margins from ½ to ∞ and phase margins of 60° (Safonov, Athans, *Gain and phase
/// margin for multiloop LQG regulators*, IEEE Trans. Automatic Control 22, 1977): the limit of short periods.
#[test]
fn margins_of_short_periods_are_those_of_continuous_time() {
    let short = |period: f64| {
        let (a, b) = ([[1.0, period], [0.0, 1.0]], [[0.5 * period * period], [period]]);
        Lqr::new(&a, &b, &[[period, 0.0], [0.0, 0.0]], &[[period]]).unwrap().margins()
    };
    for (coarse, fine) in [(short(1e-2), short(1e-3)), (short(1e-3), short(1e-4))] {
        let distance = |margins: &gelenk_runtime::lqr::Margins| {
            [margins.gain[0] - 0.5, 1.0 / margins.gain[1], std::f64::consts::FRAC_PI_3 - margins.phase]
        };
        for (coarse, fine) in distance(&coarse).into_iter().zip(distance(&fine)) {
            assert!(fine > 0.0 && (9.0..11.0).contains(&(coarse / fine)), "{coarse} {fine}");
        }
    }
}

/// The largest magnitude of a pole of A + B D K with `D = diag(k_i exp(j φ_i))`, as real blocks.
fn slowest<const NU: usize>(
    (a, b, k): (&DMatrix<f64>, &DMatrix<f64>, &DMatrix<f64>),
    gains: [f64; NU],
    phases: [f64; NU],
) -> f64 {
    let n = a.nrows();
    let part = |of: fn(f64) -> f64| {
        let d = DMatrix::from_fn(NU, NU, |i, j| if i == j { gains[i] * of(phases[i]) } else { 0.0 });
        b * d * k
    };
    let (real, imaginary) = (a + part(f64::cos), part(f64::sin));
    let whole = DMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, false) => -imaginary[(i, j - n)],
        (false, true) => imaginary[(i - n, j)],
        _ => real[(i % n, j % n)],
    });
    whole.complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max)
}

/// A change of each input within the margins, of gains or of phases, leaves every closed loop stable.
fn within_margins<const NX: usize, const NU: usize>(seed: u64) {
    let mut random = Random::new(seed);
    let (mut a, b) = (random.matrix::<NX, NX>(), random.matrix::<NX, NU>());
    let radius = m(&a).complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max);
    a.iter_mut().flatten().for_each(|v| *v *= [0.9, 1.0, 1.3, 3.0][(seed % 4) as usize] / radius);
    let q = random.positive::<NX>(0.01);
    let mut r = [[0.0; NU]; NU];
    (0..NU).for_each(|i| r[i][i] = 10.0_f64.powf(2.0 * random.vector::<1>()[0]));
    let lqr = Lqr::new(&a, &b, &q, &r).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
    let margins = lqr.margins();
    let [low, high] = [margins.gain[0].ln(), margins.gain[1].min(1e3).ln()];
    let (a, b, k) = (m(&a), m(&b), m(&lqr.gain));
    for corner in 0..20 {
        let mut share =
            || if corner < 10 { random.vector::<1>()[0] } else { random.vector::<1>()[0].signum() };
        let gains: [f64; NU] =
            core::array::from_fn(|_| (low + 0.5 * (1.0 + 0.999 * share()) * (high - low)).exp());
        let phases: [f64; NU] = core::array::from_fn(|_| 0.999 * share() * margins.phase);
        let by_gain = slowest((&a, &b, &k), gains, [0.0; NU]);
        assert!(by_gain < 1.0, "seed {seed}: gains {gains:?}: {by_gain}");
        let by_phase = slowest((&a, &b, &k), [1.0; NU], phases);
        assert!(by_phase < 1.0, "seed {seed}: phases {phases:?}: {by_phase}");
    }
}

#[test]
fn changes_within_the_margins_leave_the_loop_stable() {
    for seed in 0..100 {
        within_margins::<1, 1>(seed);
        within_margins::<4, 2>(seed);
        within_margins::<6, 3>(seed);
    }
}
