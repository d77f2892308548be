//! Robots with quaternions in motion: what their generated functions promise, against differences along ⊕, finer steps,
//! conserved quantities and the matrix exponential.

use gelenk_test_robots::{quadrotor, satellite};
use gelenk_tests::relative_error;
use nalgebra::DMatrix;

const PERIOD: f64 = 0.02;

/// A satellite that tumbles while its boom swings.
fn tumbling() -> ([f64; satellite::NY], [f64; satellite::N]) {
    let v = [0.1, -0.3, 0.2, 0.7, -0.5, 0.9, 20.0, -15.0, 30.0, 0.4, 0.6, -0.8];
    let y = satellite::integrate(
        &satellite::NEUTRAL,
        &[0.4, 0.1, -0.2, 0.9, 1.4, -0.3, 0.2, 0.5, 0.1, 0.5, -0.7, 0.3],
    );
    (y, v)
}

/// A quadrotor on its back, in a turn.
fn upside_down() -> ([f64; quadrotor::NY], [f64; quadrotor::N], [f64; quadrotor::M]) {
    let y = quadrotor::integrate(&quadrotor::NEUTRAL, &[1.0, 2.0, 0.5, 2.9, 0.3, -0.4]);
    (y, [1.0, -0.5, 2.0, 3.0, -4.0, 1.5], [3.0, 4.5, 2.0, 5.0])
}

fn close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let error = relative_error(found, expected);
    assert!(error <= tolerance, "{what}: {error:e}");
}

fn unit<const N: usize>(k: usize, size: f64) -> [f64; N] {
    std::array::from_fn(|i| if i == k { size } else { 0.0 })
}

fn plus<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

fn advanced(steps: usize, seconds: f64) -> ([f64; satellite::NY], [f64; satellite::N]) {
    let (mut y, mut v) = tumbling();
    let u = [0.05, -0.1, 0.02];
    for _ in 0..steps {
        (y, v) = satellite::step(&y, &v, &u, seconds / steps as f64);
    }
    (y, v)
}

#[test]
fn steps_have_order_four() {
    let exact = advanced(2048, 0.5);
    let errors = [16, 32, 64].map(|steps| {
        let (y, v) = advanced(steps, 0.5);
        let apart = satellite::difference(&exact.0, &y);
        let faster = (0..satellite::N).map(|k| v[k] - exact.1[k]);
        apart.into_iter().chain(faster).map(|x| x * x).sum::<f64>().sqrt()
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.6..4.6).contains(&order), "order {order} of {errors:?}");
    }
}

#[test]
fn quaternions_keep_their_length() {
    let (y, _) = advanced(2000, 20.0);
    for quaternion in [&y[3..7], &y[10..14]] {
        let length: f64 = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() <= 1e-15, "{length}");
    }
}

/// A quadrotor that spins freely in all axes for three hours.
#[test]
fn a_million_steps_keep_the_length_too() {
    let (mut y, mut v, _) = upside_down();
    for _ in 0..1_000_000 {
        (y, v) = quadrotor::step(&y, &v, &[0.0; quadrotor::M], 0.01);
        // It would fall until its speed has no digits left.
        (v[0], v[1], v[2]) = (0.0, 0.0, 0.0);
    }
    let length: f64 = y[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((length - 1.0).abs() <= 1e-15, "{length}");
    assert!(v[3..].iter().map(|x| x.abs()).fold(f64::MAX, f64::min) > 1e-6, "it still turns: {v:?}");
}

/// Linear momentum in the axes of the world: nothing outside acts on the satellite. M's first three rows are that of the
/// hull's axes.
#[test]
fn momentum_stays() {
    let momentum = |y: &[f64; satellite::NY], v: &[f64; satellite::N]| {
        let mass = satellite::mass_matrix(y);
        let body: [f64; 6] =
            std::array::from_fn(|i| (0..satellite::N).map(|j| mass[i][j] * v[j]).sum::<f64>());
        let [x, yy, z, w] = [y[3], y[4], y[5], y[6]];
        let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, yy, z));
        let linear = turn * nalgebra::Vector3::new(body[0], body[1], body[2]);
        let about_hull = turn * nalgebra::Vector3::new(body[3], body[4], body[5]);
        let angular = about_hull + nalgebra::Vector3::new(y[0], y[1], y[2]).cross(&linear);
        [linear.as_slice(), angular.as_slice()].concat()
    };
    let (y, v) = tumbling();
    let before = momentum(&y, &v);
    let (y, v) = advanced(1000, 1.0);
    close("momentum", &momentum(&y, &v), &before, 1e-10);
}

/// The finest step of a difference.
const STEP: f64 = 1e-3;

/// Compares derivatives with differences of values of a size: rounding of some bits over the step, and what the
/// extrapolation leaves.
fn stepped_alike(what: &str, found: &[f64], expected: &[f64], size: f64) {
    let largest = |all: &[f64]| all.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let error = found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    let bound = 16.0 * f64::EPSILON * size / STEP + 1e-10 * largest(expected);
    assert!(error <= bound, "{what}: {error:e} is more than {bound:e}");
}

/// Derivative of a vector at 0 by central differences over three steps (Richardson's extrapolation): the errors of the
/// orders 2 and 4 cancel, so that rounding over the step is what is left.
fn derivative<const K: usize>(at: impl Fn(f64) -> [f64; K]) -> [f64; K] {
    let [coarse, middle, fine] = [4.0, 2.0, 1.0].map(|times| {
        let h = times * STEP;
        let (ahead, behind) = (at(h), at(-h));
        std::array::from_fn::<f64, K, _>(|i| (ahead[i] - behind[i]) / (2.0 * h))
    });
    std::array::from_fn(|i| {
        let [first, second] = [(4.0 * middle[i] - coarse[i]) / 3.0, (4.0 * fine[i] - middle[i]) / 3.0];
        (16.0 * second - first) / 15.0
    })
}

/// Compares the derivatives of a generated step by positions, velocities and inputs with differences of the step.
macro_rules! derivatives_are_those_along_small_motions {
    ($robot:ident, $y:expr, $v:expr, $u:expr) => {{
        use $robot::{M, N, NY, difference, integrate, step, step_derivatives};
        let (y, v, u): ([f64; NY], [f64; N], [f64; M]) = ($y, $v, $u);
        let (next, faster, by_state, by_input) = step_derivatives(&y, &v, &u, PERIOD);
        let halves = |(y, v): ([f64; NY], [f64; N])| [difference(&next, &y), v];
        let [moved, stepped] = halves(step(&y, &v, &u, PERIOD));
        assert!(moved.iter().all(|d| d.abs() <= 1e-14), "{moved:?}");
        close("step", &stepped, &faster, 1e-14);
        // Small motions are of the size of what moves in a step, velocities of their own.
        let sizes = [1.0, v.iter().fold(1.0_f64, |most, v| most.max(v.abs()))];
        for half in 0..2 {
            for k in 0..N {
                let moved = |h| halves(step(&integrate(&y, &unit(k, h)), &v, &u, PERIOD))[half];
                let pushed = |h| halves(step(&y, &plus(&v, &unit(k, h)), &u, PERIOD))[half];
                for (block, expected) in [derivative(moved), derivative(pushed)].iter().enumerate() {
                    let found: [f64; N] = std::array::from_fn(|i| by_state[half][block][i][k]);
                    stepped_alike(&format!("{half} {block} {k}"), &found, expected, sizes[half]);
                }
            }
            for k in 0..M {
                let driven = |h| halves(step(&y, &v, &plus(&u, &unit(k, 100.0 * h)), PERIOD))[half];
                let expected = derivative(driven).map(|x| 0.01 * x);
                let found: [f64; N] = std::array::from_fn(|i| by_input[half][i][k]);
                stepped_alike(&format!("{half} input {k}"), &found, &expected, sizes[half]);
            }
        }
    }};
}

#[test]
fn derivatives_of_a_step_are_those_along_small_motions() {
    let (y, v, u) = upside_down();
    derivatives_are_those_along_small_motions!(quadrotor, y, v, u);
    let (y, v) = tumbling();
    derivatives_are_those_along_small_motions!(satellite, y, v, [0.05, -0.1, 0.02]);
}

/// The exponential of the linearization, with a column for what is constant.
#[test]
fn the_hold_is_the_exponential() {
    let (y, v, u) = upside_down();
    let (by_y, by_v, by_u, remainder, drift) = quadrotor::linearize(&y, &v, &u);
    let mut system = DMatrix::<f64>::zeros(17, 17);
    for i in 0..6 {
        for j in 0..6 {
            system[(i, j)] = drift[i][j];
            system[(i + 6, j)] = by_y[i][j];
            system[(i + 6, j + 6)] = by_v[i][j];
        }
        for j in 0..4 {
            system[(i + 6, j + 12)] = by_u[i][j];
        }
        system[(i, i + 6)] = 1.0;
        system[(i + 6, 16)] = remainder[i];
    }
    let exact = (system * PERIOD).exp();
    let (state, input, affine) = quadrotor::discretize(&y, &v, &u, PERIOD);
    let (mut found, mut expected) = (vec![], vec![]);
    for half in 0..2 {
        for i in 0..6 {
            found.extend(state[half][0][i].iter().chain(&state[half][1][i]).chain(&input[half][i]));
            found.push(affine[half][i]);
            expected.extend((0..17).map(|j| exact[(6 * half + i, j)]));
        }
    }
    close("hold", &found, &expected, 1e-12);
}

/// D, A_y and A_v predict how two motions drift apart.
#[test]
fn the_linearization_predicts_neighbours() {
    const H: f64 = 1e-5;
    let (y, v, u) = upside_down();
    let (state, _, _) = quadrotor::discretize(&y, &v, &u, 1e-3);
    let (next, faster) = quadrotor::step(&y, &v, &u, 1e-3);
    for k in 0..6 {
        let (moved, rates) = quadrotor::step(&quadrotor::integrate(&y, &unit(k, H)), &v, &u, 1e-3);
        let motion = quadrotor::difference(&next, &moved).map(|x| x / H);
        let rates: [f64; 6] = std::array::from_fn(|i| (rates[i] - faster[i]) / H);
        let found: [[f64; 6]; 2] = [0, 1].map(|half| std::array::from_fn(|i| state[half][0][i][k]));
        // Both differ by what changes during the period.
        close("motion", &found[0], &motion, 1e-4);
        close("rates", &found[1], &rates, 5e-2);
    }
}

#[test]
fn quaternions_without_length_become_the_identity() {
    let mut y = satellite::NEUTRAL;
    y[3..7].copy_from_slice(&[0.0, 3.0, 0.0, 4.0]);
    assert!(satellite::normalize(&mut y));
    close("unit", &y[3..7], &[0.0, 0.6, 0.0, 0.8], 1e-15);
    y[10..14].copy_from_slice(&[f64::NAN, 0.0, 0.0, 1.0]);
    assert!(!satellite::normalize(&mut y));
    assert_eq!(y[10..14], [0.0, 0.0, 0.0, 1.0]);
    y[3..7].fill(0.0);
    assert!(!satellite::normalize(&mut y));
    assert_eq!(y[3..7], [0.0, 0.0, 0.0, 1.0]);
}

/// Without torque sensors: the six rows of a floating base hold what acts from outside, here nothing but a thrust that is
/// known, and its inertial parameters follow from motions alone (Ayusawa, Venture and Nakamura 2014).
#[test]
fn base_rows_identify_a_floating_robot() {
    const P: usize = quadrotor::BASE_PARAMETER_NAMES.len();
    let (mut y, mut v, _) = upside_down();
    let (mut rows, mut thrusts) = (vec![], vec![]);
    for k in 0..40 {
        let phase = f64::from(k);
        let u: [f64; 4] = std::array::from_fn(|j| 4.0 + 3.0 * (0.7 * phase * (1.0 + j as f64)).sin());
        let a = quadrotor::forward_dynamics(&y, &v, &u);
        rows.extend(quadrotor::base_regressor(&y, &v, &a).into_iter().flatten());
        let input_matrix = quadrotor::input_matrix(&y);
        thrusts.extend(input_matrix.map(|row| row.iter().zip(&u).map(|(b, u)| b * u).sum::<f64>()));
        (y, v) = quadrotor::step(&y, &v, &u, 0.05);
    }
    let regressor = DMatrix::from_row_slice(thrusts.len(), P, &rows);
    let solved = regressor.svd(true, true).solve(&nalgebra::DVector::from_vec(thrusts), 1e-12);
    let found = solved.expect("both factors were asked for");
    let described = quadrotor::inertial_parameters();
    assert_eq!(quadrotor::BASE_PARAMETER_NAMES, quadrotor::INERTIAL_PARAMETER_NAMES);
    close("parameters", found.as_slice(), &described, 1e-9);
}
