//! The implicit midpoint rule against its nonlinear equation, solved to rounding by the inverse dynamics alone, and against
//! differences of its solutions.

#![allow(clippy::unwrap_used, reason = "test code")]

use core::f64::consts::FRAC_PI_2;
use gelenk_runtime::driven::DrivenRobot;
use gelenk_runtime::dynamics::{Discretizable, Dynamics};
use gelenk_runtime::trajectory::RestToRest;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Ur5 = gelenk_generated::ur5);
gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda);
gelenk_runtime::dynamics!(struct Quadrotor = gelenk_generated::quadrotor);
// A floating base with a ball joint.
gelenk_runtime::dynamics!(struct Satellite = gelenk_generated::satellite);
// B depends on the positions.
gelenk_runtime::dynamics!(struct Excavator = gelenk_generated::excavator);
// Friction grows with the load.
gelenk_runtime::dynamics!(struct GearedArm = gelenk_generated::geared_arm);
gelenk_runtime::dynamics!(struct RailArm { driven } = gelenk_generated::rail_arm);

/// Derivatives of a block may be off by this part of its largest entry.
const TOLERANCE: f64 = 1e-9;

/// The scale of positions [rad or m], velocities [rad/s or m/s] and of inputs, and the length of differences.
struct Sizes<const M: usize> {
    turn: f64,
    velocity: f64,
    inputs: [f64; M],
    difference: f64,
}

/// Zeros and whole quarter turns as often as other numbers.
fn random_entry(random: &mut ChaCha8Rng, whole: f64) -> f64 {
    match random.random_range(0..4) {
        0 => 0.0,
        1 => whole * f64::from(random.random_range(-2..=2)),
        _ => 1.5 * whole * random.random_range(-1.0..1.0),
    }
}

struct Problem<'a, D, const N: usize, const M: usize> {
    robot: &'a D,
    period: f64,
    jacobian: Option<LU<f64, Dyn, Dyn>>,
}

type State<const N: usize, const M: usize, const NY: usize> = ([f64; NY], [f64; N], [f64; M]);

impl<D, const N: usize, const M: usize> Problem<'_, D, N, M> {
    /// `f(y_m, v_m, a) − B(y_m) u`
    fn residual<const NY: usize>(&self, (y, v, u): &State<N, M, NY>, a: &[f64; N]) -> [f64; N]
    where
        D: Dynamics<N, M, NY>,
    {
        let half = 0.5 * self.period;
        let mean: [f64; N] = core::array::from_fn(|i| v[i] + half * a[i]);
        let middle = self.robot.integrate(y, &mean.map(|v| half * v));
        let (forces, matrix) =
            (self.robot.inverse_dynamics(&middle, &mean, a), self.robot.input_matrix(&middle));
        core::array::from_fn(|i| forces[i] - (0..M).map(|j| matrix[i][j] * u[j]).sum::<f64>())
    }

    /// Newton's method with a Jacobian by differences; kept for states nearby.
    fn solve<const NY: usize>(&mut self, state: &State<N, M, NY>, guess: &[f64; N]) -> [f64; N]
    where
        D: Dynamics<N, M, NY>,
    {
        let (mut a, keep) = (*guess, self.jacobian.is_some());
        for k in 0..60 {
            if !keep {
                let columns = (0..N).map(|j| {
                    let [plus, minus] = [1e-4, -1e-4].map(|h| {
                        let mut a = a;
                        a[j] += h;
                        DVector::from_row_slice(&self.residual(state, &a))
                    });
                    (plus - minus) / 2e-4
                });
                let columns: Vec<_> = columns.collect();
                self.jacobian = Some(DMatrix::from_columns(&columns).lu());
            }
            let residual = DVector::from_row_slice(&self.residual(state, &a));
            let step = self.jacobian.as_ref().unwrap().solve(&residual).unwrap();
            let moved = |share: f64| core::array::from_fn(|i| a[i] - share * step[i]);
            let is_nearer =
                |a: &[f64; N]| DVector::from_row_slice(&self.residual(state, a)).norm() < residual.norm();
            let shares = (0..10).map(|k| moved(0.5_f64.powi(k)));
            a = match shares.into_iter().find(|a| !keep && is_nearer(a)) {
                Some(nearer) => nearer,
                None if keep => moved(1.0),
                None => break,
            };
            if k > 2 && step.amax() <= 1e-15 * (1.0 + a.iter().fold(0.0, |m: f64, a| m.max(a.abs()))) {
                break;
            }
        }
        a
    }

    /// State after the step from `state`.
    fn end<const NY: usize>(&mut self, state: &State<N, M, NY>, guess: &[f64; N]) -> ([f64; NY], [f64; N])
    where
        D: Dynamics<N, M, NY>,
    {
        let a = self.solve(state, guess);
        let way = core::array::from_fn(|i| self.period * (state.1[i] + 0.5 * self.period * a[i]));
        (self.robot.integrate(&state.0, &way), core::array::from_fn(|i| state.1[i] + self.period * a[i]))
    }
}

/// Compares steps from random states. Returns the largest error of a derivative as a part of its block's largest.
fn compare<D, const N: usize, const M: usize, const NY: usize>(
    name: &str,
    robot: &D,
    sizes: &Sizes<M>,
    count: usize,
) where
    D: Discretizable<N, M, NY>,
{
    let mut random = ChaCha8Rng::seed_from_u64(45);
    let mut worst = 0.0_f64;
    for k in 0..count {
        let period = [0.01, 0.02, 0.05][k % 3];
        let turns = core::array::from_fn(|_| random_entry(&mut random, sizes.turn));
        let y = robot.integrate(&robot.neutral(), &turns);
        let v = core::array::from_fn(|_| random_entry(&mut random, sizes.velocity));
        let u = core::array::from_fn(|j| random_entry(&mut random, sizes.inputs[j]));
        let state = (y, v, u);
        let mut problem = Problem::<D, N, M> { robot, period, jacobian: None };
        let a = problem.solve(&state, &robot.forward_dynamics(&y, &v, &u));
        let residual = problem.residual(&state, &a).map(f64::abs).iter().sum::<f64>();
        let forces = 1.0 + robot.inverse_dynamics(&y, &v, &a).map(f64::abs).iter().sum::<f64>();
        assert!(residual <= 1e-11 * forces, "{name} {k}: no solution, {residual}");

        let step = robot.midpoint_step(&y, &v, &a, &u, period);
        let (end, velocities) = problem.end(&state, &a);
        let moved = robot.difference(&end, &step.coordinates);
        for i in 0..N {
            let fast = 1.0 + velocities[i].abs();
            assert!(moved[i].abs() <= 1e-12 * fast, "{name} {k}: {moved:?}");
            assert!((step.velocities[i] - velocities[i]).abs() <= 1e-11 * fast, "{name} {k}");
        }
        // From another guess Newton's method arrives there too.
        let mut guess = core::array::from_fn(|i| a[i] + 0.01 * sizes.velocity * turns[i]);
        for _ in 0..8 {
            let next = robot.midpoint_step(&y, &v, &guess, &u, period).velocities;
            guess = core::array::from_fn(|i| (next[i] - v[i]) / period);
        }
        for i in 0..N {
            let error = (guess[i] - a[i]).abs() / (1.0 + a[i].abs() + velocities[i].abs() / period);
            assert!(error <= 1e-9, "{name} {k}: from another guess {guess:?}, {a:?}");
        }

        let mut differences = [[[0.0; N]; 2]; 3].map(|halves| vec![halves; N.max(M)]);
        for (kind, count) in [(0, N), (1, N), (2, M)] {
            for j in 0..count {
                // Inputs change a step by little, and almost linearly.
                let unit = if kind == 2 { 10.0 * sizes.inputs[j] } else { 1.0 };
                let length = sizes.difference * unit;
                let quotient = |h: f64| {
                    let [plus, minus] = [h, -h].map(|h| {
                        let (mut y, mut v, mut u) = state;
                        match kind {
                            0 => {
                                let mut d = [0.0; N];
                                d[j] = h;
                                y = robot.integrate(&y, &d);
                            }
                            1 => v[j] += h,
                            _ => u[j] += h,
                        }
                        problem.end(&(y, v, u), &a)
                    });
                    let [y_plus, y_minus] = [&plus.0, &minus.0].map(|y| robot.difference(&end, y));
                    [
                        core::array::from_fn(|i| (y_plus[i] - y_minus[i]) / (2.0 * h)),
                        core::array::from_fn(|i| (plus.1[i] - minus.1[i]) / (2.0 * h)),
                    ]
                };
                differences[kind][j] = derivative(length, quotient);
            }
        }
        for half in 0..2 {
            for kind in 0..3 {
                let columns = if kind == 2 { M } else { N };
                let exact = |i: usize, j: usize| differences[kind][j][half][i];
                let found = |i: usize, j: usize| match kind {
                    2 => step.input[half][i][j],
                    _ => step.state[half][kind][i][j],
                };
                // Columns of inputs have units of their own.
                let largest = |j: usize| {
                    let columns = if kind == 2 { j..j + 1 } else { 0..columns };
                    let entries = columns.flat_map(|j| (0..N).map(move |i| (i, j)));
                    entries.fold(0.0, |m: f64, (i, j)| m.max(exact(i, j).abs()))
                };
                for j in 0..columns {
                    let scale = largest(j);
                    for i in 0..N {
                        let error = (found(i, j) - exact(i, j)).abs();
                        worst = worst.max(error / scale);
                        assert!(
                            error <= TOLERANCE * scale,
                            "{name} {k}, block {half} {kind}, ({i}, {j}): {} is not {}, {scale}",
                            found(i, j),
                            exact(i, j)
                        );
                    }
                }
            }
        }
    }
    println!("{name}: {worst:.1e}");
}

/// Derivatives of a state by differences over 1/16 to 256 times `length`, extrapolated; of each entry that whose
/// last extrapolation changed it least (Ridders 1982), rounding included.
fn derivative<const N: usize>(length: f64, mut quotient: impl FnMut(f64) -> [[f64; N]; 2]) -> [[f64; N]; 2] {
    let lengths: Vec<_> = (-2..5).map(|k| length * 4.0_f64.powi(k)).collect();
    let quotients: Vec<_> = lengths.iter().map(|h| quotient(*h)).collect();
    let extrapolated = |half: usize, i: usize| {
        let entry = |k: usize| quotients[k][half][i];
        let once = |k: usize| entry(k) + (entry(k) - entry(k + 1)) / 15.0;
        let twice = |k: usize| once(k) + (once(k) - once(k + 1)) / 255.0;
        let error = |k: &usize| (once(*k) - once(*k + 1)).abs() / 15.0 + f64::EPSILON / lengths[*k];
        twice((0..5).min_by(|a, b| error(a).total_cmp(&error(b))).unwrap())
    };
    core::array::from_fn(|half| core::array::from_fn(|i| extrapolated(half, i)))
}

#[test]
fn arms_step_with_the_exact_sensitivity() {
    let sizes = Sizes { turn: FRAC_PI_2, velocity: 1.0, inputs: [0.3; 2], difference: 2e-5 };
    compare("PowerCube", &PowerCube, &sizes, 60);
    let sizes = Sizes {
        turn: FRAC_PI_2,
        velocity: 1.0,
        inputs: [50.0, 50.0, 50.0, 10.0, 10.0, 5.0],
        difference: 1e-4,
    };
    compare("UR5", &Ur5, &sizes, 60);
    let sizes = Sizes {
        turn: FRAC_PI_2,
        velocity: 1.0,
        inputs: [15.0, 15.0, 15.0, 15.0, 2.0, 2.0, 2.0],
        difference: 1e-4,
    };
    compare("Panda", &Panda, &sizes, 60);
}

#[test]
fn robots_with_quaternions_step_with_the_exact_sensitivity() {
    compare(
        "quadrotor",
        &Quadrotor,
        &Sizes { turn: FRAC_PI_2, velocity: 2.0, inputs: [4.0; 4], difference: 1e-4 },
        60,
    );
    compare(
        "satellite",
        &Satellite,
        &Sizes { turn: FRAC_PI_2, velocity: 1.0, inputs: [0.1; 3], difference: 1e-4 },
        30,
    );
}

#[test]
fn inputs_at_frames_and_friction_under_load_are_in_the_sensitivity() {
    let sizes = Sizes { turn: 0.2, velocity: 0.3, inputs: [2e4; 4], difference: 1e-4 };
    compare("excavator", &Excavator, &sizes, 60);
    compare(
        "geared arm",
        &GearedArm,
        &Sizes { turn: FRAC_PI_2, velocity: 1.0, inputs: [0.3, 0.1], difference: 2e-5 },
        60,
    );
    let rail = RestToRest::new([-0.5], [0.5], 1.5).unwrap();
    let robot = DrivenRobot::new(RailArm::default(), rail).at(0.4);
    compare(
        "rail arm",
        &robot,
        &Sizes { turn: FRAC_PI_2, velocity: 1.0, inputs: [1.0; 2], difference: 1e-4 },
        30,
    );
}
