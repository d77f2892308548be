//! The zero-order hold against the exponential of the lifted matrix in double-double arithmetic.

use fastrand::Rng;
use gelenk_runtime::dynamics::{Discretizable, Linearization};

use super::exponential::exponential;
use super::{for_each_robot, random_state, robots, rows};

/// Sample times [s].
const PERIODS: [f64; 3] = [0.001, 0.02, 0.1];

/// `[A B c; 0]` of `ẋ = A x + B u + c`.
fn lifted<const N: usize, const M: usize>(linear: &Linearization<N, M>) -> Vec<Vec<f64>> {
    let size = 2 * N + M + 1;
    let mut matrix = vec![vec![0.0; size]; size];
    for i in 0..N {
        matrix[i][N + i] = 1.0;
        matrix[N + i] = [
            &linear.by_coordinates[i][..],
            &linear.by_velocities[i],
            &linear.by_inputs[i],
            &linear.affine[i..=i],
        ]
        .concat();
    }
    matrix
}

/// Largest row sum.
fn norm<const N: usize>(matrix: &[[f64; N]; N]) -> f64 {
    let sums = matrix.iter().map(|row| row.iter().map(|x| x.abs()).sum());
    sums.fold(0.0, f64::max)
}

/// The bound of the fastest rate in the documentation [1/s].
fn rate<const N: usize, const M: usize>(linear: &Linearization<N, M>) -> f64 {
    let (a, b) = (norm(&linear.by_coordinates), norm(&linear.by_velocities));
    (b + (b * b + 4.0 * a).sqrt()) / 2.0
}

/// Largest difference of each block of columns (y, ẏ, u, 1) in each half, relative to the block's largest
/// entry; in the blocks that begin as the identity, 1 counts as one of them.
fn error<const N: usize, const M: usize>(linear: &Linearization<N, M>, period: f64) -> f64 {
    let discrete = linear.discretize(period);
    let mut found = rows(&discrete.state, &discrete.input);
    let affine = discrete.affine.concat();
    for (row, affine) in found.iter_mut().zip(affine) {
        row.push(affine);
    }
    let expected = exponential(&lifted(linear), period);
    let columns = [(0, N), (N, 2 * N), (2 * N, 2 * N + M), (2 * N + M, 2 * N + M + 1)];
    let mut worst = 0.0_f64;
    for half in 0..2 {
        for (from, to) in columns {
            let is_diagonal = from == half * N && to == from + N;
            let (mut difference, mut scale) = (0.0_f64, f64::from(u8::from(is_diagonal)));
            for i in half * N..(half + 1) * N {
                for j in from..to {
                    difference = difference.max((found[i][j] - expected[i][j]).abs());
                    scale = scale.max(expected[i][j].abs());
                }
            }
            worst = worst.max(difference / scale);
        }
    }
    worst
}

fn check<const N: usize, const M: usize>(name: &str, robot: &impl Discretizable<N, M>) {
    let mut rng = Rng::with_seed(1);
    for sample in 0..6 {
        let (y, mut v, u) = random_state(&mut rng);
        if sample % 3 == 0 {
            v = [0.0; N]; // where friction is steepest
        }
        let linear = robot.linearize(&y, &v, &u);
        for period in PERIODS {
            let reach = rate(&linear) * period;
            let error = error(&linear, period);
            println!("{name}: {period} s, ν T = {reach:.2}, {error:.1e}");
            assert!(error <= 1e-12, "{name}, {period} s: {error:e}");
            let generated = robot.discretize(&y, &v, &u, period);
            assert_eq!(generated, linear.discretize(period), "{name}");
        }
    }
}

#[test]
fn it_is_the_exponential_of_the_lifted_matrix() {
    for_each_robot!(check);
}

/// The stiffest state of the PowerCube: gamma at rest, where the slope of its friction is 896 N m s/rad.
#[test]
fn friction_at_standstill_is_within_the_bound() {
    use gelenk_runtime::dynamics::Differentiable;
    let (y, v) = ([0.2, -0.4], [0.0, 0.0]);
    let linear = robots::PowerCube.linearize(&y, &v, &[0.0; 2]);
    assert!(rate(&linear) > 400.0, "{}", rate(&linear));
    for (period, highest) in [(0.02, 1e-14), (0.1, 1e-12)] {
        let (reach, error) = (rate(&linear) * period, error(&linear, period));
        println!("ν T = {reach:.1}: {error:.1e}");
        assert!(reach <= 80.0 && error <= highest, "ν T = {reach}: {error:e}");
    }
}

/// A stiff arm: `M ÿ = −K y − D ẏ + B u + f` with joints from a shoulder to a light wrist, and steep friction
/// on each.
fn stiff_arm(rng: &mut Rng, steepest: f64) -> Linearization<3, 2> {
    let mut normal = || 2.0 * rng.f64() - 1.0;
    // M⁻¹ = S (1 + ½ symmetric) S is positive definite, from 1 to 3e4 1/(kg m²).
    let scale = [1.0, 10.0, 170.0];
    let mut coupling = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..i {
            (coupling[i][j], coupling[j][i]) = {
                let x = 0.3 * normal();
                (x, x)
            };
        }
        coupling[i][i] = 1.0;
    }
    let inverse: [[f64; 3]; 3] =
        core::array::from_fn(|i| core::array::from_fn(|j| scale[i] * coupling[i][j] * scale[j]));
    let stiffness = [-20.0, -5.0, -0.3];
    let damping = [steepest * 0.1, steepest, steepest * 0.03];
    let scaled = |factors: [f64; 3]| inverse.map(|row| core::array::from_fn(|j| -row[j] * factors[j]));
    Linearization {
        by_coordinates: scaled(stiffness),
        by_velocities: scaled(damping),
        by_inputs: inverse.map(|row| [row[0], row[2]]),
        affine: core::array::from_fn(|i| inverse[i][i] * normal()),
    }
}

/// Steep friction on light wrists. Six doublings, whatever the robot, once gave |A_d| of 1e105 here; more
/// doublings of the same kind would be unstable, since they magnify rounding by the ratio of the rates.
#[test]
fn stiff_robots_are_within_the_same_error() {
    let mut rng = Rng::with_seed(2);
    let mut reaches = Vec::new();
    for steepest in [1.0, 30.0, 1e3, 3e4, 1e6] {
        for _ in 0..4 {
            let linear = stiff_arm(&mut rng, steepest);
            for period in [0.001, 0.005, 0.02] {
                let reach = rate(&linear) * period;
                if reach > 2e7 {
                    continue;
                }
                let error = error(&linear, period);
                println!("ν T = {reach:.2e}: {error:.1e}");
                assert!(error <= 1e-12, "ν T = {reach:e}: {error:e}");
                reaches.push(reach);
            }
        }
    }
    let beyond = |bound: f64| reaches.iter().filter(|reach| **reach > bound).count();
    assert!(beyond(80.0) > 20 && beyond(1e5) > 10 && beyond(1e6) > 2, "{reaches:?}");
}

/// All results are infinite for a system that the largest number of repetitions does not reach, and only then.
#[test]
fn beyond_the_bound_everything_is_infinite() {
    let linear = |damping: f64| Linearization {
        by_coordinates: [[0.0]],
        by_velocities: [[-damping]],
        by_inputs: [[1.0]],
        affine: [0.5],
    };
    let period = 0.02;
    let most = 80.0 * f64::from(1 << 18) / period;
    let within = linear(0.999 * most).discretize(period);
    assert!(within.state[1][1][0][0].abs() < 1e-12);
    let expected = period / (0.999 * most);
    assert!((within.input[0][0][0] / expected - 1.0).abs() < 1e-6);
    for damping in [1.001 * most, -1.001 * most, 1e300, f64::INFINITY] {
        let beyond = linear(damping).discretize(period);
        let all = [
            beyond.state.as_flattened().as_flattened().as_flattened(),
            beyond.input.as_flattened().as_flattened(),
            beyond.affine.as_flattened(),
        ];
        assert!(all.concat().iter().all(|x| *x == f64::INFINITY), "{beyond:?}");
    }
    let nan = linear(f64::NAN).discretize(period);
    assert!(nan.state[1][1][0][0].is_nan());
}

#[test]
fn no_time_changes_nothing() {
    use gelenk_runtime::dynamics::Discretization;
    let discrete = robots::PowerCube.discretize(&[0.2, -0.4], &[0.3, 0.1], &[0.0; 2], 0.0);
    let (one, zero) = ([[1.0, 0.0], [0.0, 1.0]], [[0.0; 2]; 2]);
    let expected =
        Discretization { state: [[one, zero], [zero, one]], input: [zero; 2], affine: [[0.0; 2]; 2] };
    assert_eq!(discrete, expected);
}
