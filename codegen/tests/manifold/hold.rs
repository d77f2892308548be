//! The zero-order hold with D, against the exponential of the whole matrix and against the robot itself.

use gelenk_kernels::discrete_time::{
    runge_kutta_on_manifold_derivatives, zero_order_hold, zero_order_hold_on_manifold,
};
use gelenk_kernels::manifold::{bracket, difference};

use super::body::{Body, WIDTHS};
use super::random::{Random, distance};

/// State, inputs and 1.
const SIZE: usize = 2 * 3 + 2 + 1;

type Whole = [[f64; SIZE]; SIZE];

fn times(a: &Whole, b: &Whole) -> Whole {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..SIZE).map(|k| a[i][k] * b[k][j]).sum()))
}

/// Matrix exponential minus 1: a Taylor polynomial of degree 3 for the time halved 30 times, then squared
/// back.
fn exponential(matrix: &Whole, time: f64) -> Whole {
    let h = time / f64::from(1_u32 << 30);
    let a: Whole = matrix.map(|row| row.map(|entry| h * entry));
    let (a2, mut change) = (times(&a, &a), a);
    let a3 = times(&a2, &a);
    for i in 0..SIZE {
        (0..SIZE).for_each(|j| change[i][j] += a2[i][j] / 2.0 + a3[i][j] / 6.0);
    }
    for _ in 0..30 {
        let square = times(&change, &change);
        for i in 0..SIZE {
            (0..SIZE).for_each(|j| change[i][j] = 2.0 * change[i][j] + square[i][j]);
        }
    }
    (0..SIZE).for_each(|i| change[i][i] += 1.0);
    change
}

#[test]
fn the_hold_is_the_exponential_of_the_whole_matrix() {
    let mut random = Random(41);
    for (size, time) in [(1.0, 0.1), (3.0, 0.7), (20.0, 0.05), (0.0, 1.0)] {
        let by_y: [[f64; 3]; 3] = random.matrix(size);
        let (by_v, drift) = (random.matrix::<3, 3>(size), random.matrix::<3, 3>(size));
        let (by_u, remainder): ([[f64; 2]; 3], [f64; 3]) = (random.matrix(size), random.vector(size));
        let mut whole = [[0.0; SIZE]; SIZE];
        for i in 0..3 {
            whole[i][..3].copy_from_slice(&drift[i]);
            whole[i][3 + i] = 1.0;
            whole[i + 3][..3].copy_from_slice(&by_y[i]);
            whole[i + 3][3..6].copy_from_slice(&by_v[i]);
            whole[i + 3][6..8].copy_from_slice(&by_u[i]);
            whole[i + 3][8] = remainder[i];
        }
        let expected = exponential(&whole, time);
        let (state, input, affine) = zero_order_hold_on_manifold(&(by_y, by_v, by_u, remainder, drift), time);
        for half in 0..2 {
            for i in 0..3 {
                let [by_d, by_v] = [state[half][0][i], state[half][1][i]];
                let found = [&by_d[..], &by_v[..], &input[half][i][..], &[affine[half][i]]].concat();
                let error = distance(&found, &expected[3 * half + i]);
                assert!(error <= 1e-12, "{size}: {error:e}");
            }
        }
    }
}

#[test]
fn without_drift_it_is_todays_hold() {
    let mut random = Random(42);
    let (by_y, by_v) = (random.matrix::<4, 4>(3.0), random.matrix(3.0));
    let (by_u, remainder): ([[f64; 3]; 4], [f64; 4]) = (random.matrix(1.0), random.vector(1.0));
    let found = zero_order_hold_on_manifold(&(by_y, by_v, by_u, remainder, [[0.0; 4]; 4]), 0.2);
    assert_eq!(found, zero_order_hold(&(by_y, by_v, by_u, remainder), 0.2));
}

/// The hold of a linearization with `D = −ad_v` predicts the robot with an error of order 3 in the period, and its
/// derivatives are those along ⊕ with an error of order 2; with any other D they are not.
#[test]
fn the_hold_of_a_linearization_is_the_robot() {
    let body = Body { mass: 1.3, inertia: [0.02, 0.03, 0.05], gravity: 9.81 };
    let mut random = Random(43);
    let (y, v) = (random.pose(), [0.4, -0.7, 0.2, 2.0, 5.0, -3.0]);
    let (u, (by_y, by_v, by_u, remainder)) = {
        let u = [9.0, 0.01, -0.02, 0.03];
        (u, body.linearize(&y, &v, &u))
    };
    let errors = |period: f64, sign: f64| {
        let mut drift = [[0.0; 6]; 6];
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = sign;
            let column = bracket(&WIDTHS, &v, &unit);
            (0..6).for_each(|i| drift[i][j] = column[i]);
        }
        let (state, input, affine) =
            zero_order_hold_on_manifold(&(by_y, by_v, by_u, remainder, drift), period);
        let (y_next, v_next, exact, _) =
            runge_kutta_on_manifold_derivatives(&WIDTHS, &y, &v, &u, period, 8, |y, v| {
                body.linearize(y, v, &u)
            });
        let d: [f64; 6] = difference(&WIDTHS, &y, &y_next);
        let predicted = |half: usize, i: usize| {
            let of_v: f64 = (0..6).map(|j| state[half][1][i][j] * v[j]).sum();
            let of_u: f64 = (0..4).map(|j| input[half][i][j] * u[j]).sum();
            of_v + of_u + affine[half][i]
        };
        let next: [f64; 12] = core::array::from_fn(|i| predicted(i / 6, i % 6));
        let value = distance(&next, &[d, v_next].concat());
        let flat = |blocks: &[[[[f64; 6]; 6]; 2]; 2]| blocks.as_flattened().as_flattened().concat();
        [value, distance(&flat(&state), &flat(&exact))]
    };
    let order = |sign: f64| {
        let (coarse, fine) = (errors(0.01, sign), errors(0.005, sign));
        [0, 1].map(|i| (coarse[i] / fine[i]).log2())
    };
    let right = order(-1.0);
    assert!(right[0] > 2.8 && right[1] > 1.8, "{right:?}");
    for wrong in [0.0, 1.0, -0.5] {
        assert!(order(wrong)[1] < 1.2, "{wrong}: {:?}", order(wrong));
    }
}
