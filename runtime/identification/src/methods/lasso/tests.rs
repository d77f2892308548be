//! Comparison of the path with closed forms and with an interior-point solver.

use super::super::moments::Samples;
use super::*;
use crate::numeric::random::SplitMix64;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SupportedConeT};

fn random_moments(seed: u64, m: usize, p: usize, correlated: bool) -> Moments {
    let mut random = SplitMix64::new(seed);
    let mut theta = DMatrix::from_fn(m, p, |_, _| random.normal());
    if correlated {
        for j in 1..p {
            let previous = theta.column(j - 1).into_owned();
            theta.column_mut(j).axpy(0.9, &previous, 0.4);
        }
    }
    let truth = DVector::from_fn(p, |j, _| if j % 3 == 0 { 1.5 - j as f64 / 4.0 } else { 0.0 });
    let noise = DVector::from_fn(m, |_, _| 0.3 * random.normal());
    let y = &theta * truth + noise;
    let names: Vec<String> = (0..p).map(|j| format!("t{j}")).collect();
    Moments::new(&Samples::from_matrix(&names, &theta, vec![y.as_slice()]).unwrap()).unwrap()
}

/// Solves the same problem as a quadratic program in (w⁺, w⁻) ≥ 0 by an interior-point solver.
fn by_interior_points(moments: &Moments, lambda: f64, weights: &[f64]) -> DVector<f64> {
    let (p, n) = (moments.terms(), moments.samples() as f64);
    let (g, b) = (moments.gram() / n, moments.projection(0) / n);
    let sign = |i: usize| if i < p { 1.0 } else { -1.0 };
    let hessian: Vec<Vec<f64>> = (0..2 * p)
        .map(|i| {
            (0..2 * p).map(|j| if i <= j { sign(i) * sign(j) * g[(i % p, j % p)] } else { 0.0 }).collect()
        })
        .collect();
    let q: Vec<f64> = (0..2 * p).map(|i| lambda * weights[i % p] - sign(i) * b[i % p]).collect();
    let rows: Vec<Vec<f64>> =
        (0..2 * p).map(|i| (0..2 * p).map(|j| if i == j { -1.0 } else { 0.0 }).collect()).collect();
    let zeros = vec![0.0; rows.len()];
    let cones: [SupportedConeT<f64>; 1] = [NonnegativeConeT(rows.len())];
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-13)
        .tol_gap_rel(1e-13)
        .tol_feas(1e-13)
        .build()
        .unwrap();
    let mut solver =
        DefaultSolver::new(&CscMatrix::from(&hessian), &q, &CscMatrix::from(&rows), &zeros, &cones, settings)
            .unwrap();
    solver.solve();
    DVector::from_fn(p, |j, _| solver.solution.x[j] - solver.solution.x[p + j])
}

#[test]
fn orthogonal_columns_are_soft_thresholded() {
    // Closed form for ΘᵀΘ = N I: ξ = S(Θᵀy/N, λ).
    let names: Vec<String> = ["a", "b", "c"].map(String::from).to_vec();
    let m = 8;
    let theta = DMatrix::from_fn(m, 3, |i, j| if i >> j & 1 == 0 { 1.0 } else { -1.0 });
    let y = &theta * DVector::from_column_slice(&[2.0, -0.7, 0.3]);
    let moments = Moments::new(&Samples::from_matrix(&names, &theta, vec![y.as_slice()]).unwrap()).unwrap();
    let lasso = Lasso::default();
    let path = lasso.path(&moments, 0, &[0.5]).unwrap();
    let expected = DVector::from_column_slice(&[1.5, -0.2, 0.0]);
    assert!((path.coefficients.column(0) - expected).amax() < 1e-14);
    assert!((lasso.largest_lambda(&moments, 0).unwrap() - 2.0).abs() < 1e-14);
    assert_eq!(paper_lambda(0.5, m), 8.0);
}

#[test]
fn agrees_with_clarabel_on_random_problems() {
    for seed in 0..12 {
        let moments = random_moments(seed, 60, 9, seed % 2 == 0);
        let lasso = Lasso { standardize: seed % 3 == 0, tolerance: 1e-13, ..Default::default() };
        let weights: Vec<f64> = (0..9)
            .map(|j| if lasso.standardize { (moments.gram()[(j, j)] / 60.0).sqrt() } else { 1.0 })
            .collect();
        let grid = lasso.lambda_grid(&moments, 0, 8, 1e-3).unwrap();
        let path = lasso.path(&moments, 0, &grid).unwrap();
        for (k, &lambda) in grid.iter().enumerate() {
            let reference = by_interior_points(&moments, lambda, &weights);
            let difference = (path.coefficients.column(k) - reference).amax();
            assert!(difference < 2e-6, "seed {seed}, λ {lambda:e}: {difference:e}");
        }
        assert!(path.coefficients.column(0).amax() < 1e-12);
    }
}

#[test]
fn more_terms_than_samples_still_have_a_solution() {
    let moments = random_moments(5, 12, 20, false);
    let lasso = Lasso { tolerance: 1e-9, ..Default::default() };
    let grid = lasso.lambda_grid(&moments, 0, 5, 0.05).unwrap();
    let path = lasso.path(&moments, 0, &grid).unwrap();
    assert!(path.gaps.iter().all(|g| *g <= 1e-9 * moments.energy(0)));
}

#[test]
fn equal_columns_share_a_coefficient() {
    let one = vec![1.0; 40];
    let y: Vec<f64> = (0..40).map(|i| 2.0 + f64::from(i % 3)).collect();
    let x: Vec<f64> = (0..40).map(f64::from).collect();
    let names: Vec<String> = ["1", "x", "sign"].map(String::from).to_vec();
    let samples = Samples::from_columns(&names, vec![&one, &x, &one], vec![&y]).unwrap();
    let lasso = Lasso { tolerance: 1e-12, ..Default::default() };
    let twice = Moments::new(&samples).unwrap();
    let samples = Samples::from_columns(&names[..2], vec![&one, &x], vec![&y]).unwrap();
    let once = Moments::new(&samples).unwrap();
    let grid = lasso.lambda_grid(&once, 0, 20, 1e-4).unwrap();
    let (a, b) = (lasso.path(&twice, 0, &grid).unwrap(), lasso.path(&once, 0, &grid).unwrap());
    for k in 0..20 {
        let sum = a.coefficients[(0, k)] + a.coefficients[(2, k)];
        assert!((sum - b.coefficients[(0, k)]).abs() < 1e-6, "{k}: {sum} {}", b.coefficients[(0, k)]);
    }
}

#[test]
fn a_lambda_that_removes_everything_is_an_error_with_the_bound() {
    let moments = random_moments(1, 50, 4, false);
    let error = Lasso::default().fit(&moments, 0, 1e6).unwrap_err().to_string();
    assert!(
        error.starts_with("lambda = 1e6 removes every term. The largest value that keeps a term is"),
        "{error}"
    );
}
