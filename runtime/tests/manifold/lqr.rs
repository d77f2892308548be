//! A regulator on the error state: the deviation `(y ⊖ y_ref, v − v_ref)` of a quadrotor that hovers.

use super::{Quadrotor, quadrotor};
use gelenk_runtime::dynamics::{Discretizable, Dynamics};
use gelenk_runtime::lqr::Lqr;
use std::array::from_fn;

const PERIOD: f64 = 0.02;
const HOVER: [f64; 4] = [quadrotor::MASS * 9.81 / 4.0; 4];

/// Turned about the vertical, so that the body's axes are not the world's.
fn reference() -> [f64; 7] {
    Quadrotor.integrate(&Quadrotor.neutral(), &[1.0, -2.0, 3.0, 0.0, 0.0, 2.0])
}

fn diagonal<const K: usize>(values: [f64; K]) -> [[f64; K]; K] {
    from_fn(|i| from_fn(|j| if i == j { values[i] } else { 0.0 }))
}

/// Weights of distances, angles and their rates.
const STATE: [f64; 12] = [4.0, 4.0, 4.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.1, 0.1, 0.1];
const INPUT: [f64; 4] = [0.2; 4];

fn regulator() -> Lqr<12, 4> {
    let discrete = Quadrotor.discretize(&reference(), &[0.0; 6], &HOVER, PERIOD);
    let a = from_fn(|i| from_fn(|j| discrete.state[i / 6][j / 6][i % 6][j % 6]));
    let b = from_fn(|i| discrete.input[i / 6][i % 6]);
    Lqr::new(&a, &b, &diagonal(STATE), &diagonal(INPUT)).unwrap()
}

type State = ([f64; 7], [f64; 6]);

fn deviation((y, v): &State) -> [f64; 12] {
    let d = Quadrotor.difference(&reference(), y);
    from_fn(|i| if i < 6 { d[i] } else { v[i - 6] })
}

/// The inputs about hovering, and the state after a period with them.
fn advanced(lqr: &Lqr<12, 4>, state: &State) -> ([f64; 4], State) {
    let by = lqr.input(&deviation(state));
    (by, Quadrotor.step(&state.0, &state.1, &from_fn(|j| HOVER[j] + by[j]), PERIOD))
}

fn cost(lqr: &Lqr<12, 4>, state: &State) -> f64 {
    let x = deviation(state);
    (0..12).map(|i| (0..12).map(|j| x[i] * lqr.cost_to_go[i][j] * x[j]).sum::<f64>()).sum()
}

/// Bellman's equation along the nonlinear motion: a period costs `xᵀQx + uᵀRu`, up to the square of the deviation.
#[test]
fn a_period_costs_what_the_regulator_says() {
    let lqr = regulator();
    for direction in 0..12 {
        let size = 1e-4;
        let d: [f64; 6] = from_fn(|i| if i == direction { size } else { 0.0 });
        let v = from_fn(|i| if i + 6 == direction { size } else { 0.0 });
        let state = (Quadrotor.integrate(&reference(), &d), v);
        let (by, next) = advanced(&lqr, &state);
        let x = deviation(&state);
        let spent = (0..12).map(|i| STATE[i] * x[i] * x[i]).sum::<f64>()
            + (0..4).map(|j| INPUT[j] * by[j] * by[j]).sum::<f64>();
        let (before, after) = (cost(&lqr, &state), cost(&lqr, &next));
        let error = (before - after - spent).abs();
        assert!(error <= 1e-3 * before, "{direction}: {before:e} became {after:e}, {spent:e} was spent");
    }
}

#[test]
fn a_tilted_start_comes_to_rest_at_the_reference() {
    let lqr = regulator();
    let start = Quadrotor.integrate(&reference(), &[0.4, -0.3, 0.2, 0.9, -0.6, 1.2]);
    let mut state = (start, [0.5, -0.5, 0.3, 1.0, -1.0, 0.5]);
    for _ in 0..1500 {
        state = advanced(&lqr, &state).1;
    }
    let rest = deviation(&state).iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!(rest <= 1e-9, "{rest:e}");
}
