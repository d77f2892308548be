//! Steps on the manifold: order, invariants, a closed form, sensitivities.

use gelenk_kernels::discrete_time::{
    runge_kutta, runge_kutta_on_manifold, runge_kutta_on_manifold_derivatives,
};
use gelenk_kernels::manifold::{difference, integrate};

use super::body::{Body, WIDTHS, in_base};
use super::random::{Random, distance};

const TUMBLING: Body = Body { mass: 1.3, inertia: [0.02, 0.03, 0.05], gravity: 9.81 };

type State = ([f64; 7], [f64; 6]);

fn start() -> State {
    let mut random = Random(31);
    (random.pose(), [0.4, -0.7, 0.2, 2.0, 5.0, -3.0])
}

fn step(body: &Body, (y, v): State, u: &[f64; 4], period: f64, substeps: usize) -> State {
    runge_kutta_on_manifold(&WIDTHS, &y, &v, period, substeps, |y, v| body.acceleration(y, v, u))
}

/// Difference of two states, positions along ⊕.
fn error((y, v): &State, (y_other, v_other): &State) -> f64 {
    let d: [f64; 6] = difference(&WIDTHS, y, y_other);
    distance(&d, &[0.0; 6]).max(distance(v, v_other))
}

#[test]
fn steps_have_order_4() {
    let u = [9.0, 0.01, -0.02, 0.03];
    let run = |substeps| step(&TUMBLING, start(), &u, 0.4, substeps);
    let exact = run(4096);
    let errors = [32, 64, 128].map(|substeps| error(&run(substeps), &exact));
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((3.8..4.3).contains(&order), "{order} from {errors:?}");
    }
}

#[test]
fn a_free_body_keeps_energy_and_momentum_to_the_order_of_the_method() {
    let body = Body { gravity: 0.0, ..TUMBLING };
    let (y, v) = start();
    let drift = |substeps: usize| {
        let (y_end, v_end) = step(&body, (y, v), &[0.0; 4], 2.0, substeps);
        let energy = (body.kinetic_energy(&v_end) - body.kinetic_energy(&v)).abs();
        let momentum = distance(&body.angular_momentum(&y_end, &v_end), &body.angular_momentum(&y, &v));
        // No force acts: the centre of mass moves on a straight line.
        let l = in_base(&y, [v[0], v[1], v[2]]);
        let straight: [f64; 3] = core::array::from_fn(|i| y[i] + 2.0 * l[i]);
        [energy, momentum, distance(&y_end[..3], &straight)]
    };
    let (coarse, fine, finest) = (drift(250), drift(500), drift(16_000));
    for i in 0..3 {
        let order = (coarse[i] / fine[i]).log2();
        assert!(order > 3.7, "{i}: {order} from {coarse:?}, {fine:?}");
        assert!(finest[i] <= 1e-11, "{i}: {:e}", finest[i]);
    }
}

/// A torque-free symmetric top in closed form: in the body's frame ω precesses about the axis with the rate
/// `(1 − J₃/J₁) ω₃`, and the attitude is a turn about the momentum by `|L|/J₁` after one about the axis (Landau and
/// Lifshitz, Mechanics, 1976, section 33).
#[test]
fn a_symmetric_top_moves_as_in_closed_form() {
    let body = Body { mass: 2.0, inertia: [0.04, 0.04, 0.07], gravity: 0.0 };
    let mut random = Random(32);
    let (y, v) = (random.pose(), [0.0, 0.0, 0.0, 1.5, 0.0, 4.0]);
    let time = 1.7;
    let [axial, lateral] = [body.inertia[2], body.inertia[0]];
    let rate = (1.0 - axial / lateral) * v[5];
    let spin = [0.0, 0.0, 0.0, 0.0, 0.0, rate * time];
    let momentum = [lateral * v[3], 0.0, axial * v[5]];
    let precession = [0.0, 0.0, 0.0, momentum[0], momentum[1], momentum[2]].map(|l| l / lateral * time);
    let expected = integrate(&WIDTHS, &integrate(&WIDTHS, &y, &precession), &spin);
    let (found, w) = step(&body, (y, v), &[0.0; 4], time, 4000);
    let d: [f64; 6] = difference(&WIDTHS, &expected, &found);
    assert!(distance(&d, &[0.0; 6]) <= 1e-11, "{d:?}");
    let angle = rate * time;
    let expected = [v[3] * angle.cos(), -v[3] * angle.sin(), v[5]];
    assert!(distance(&w[3..], &expected) <= 1e-11, "{w:?} is not {expected:?}");
}

#[test]
fn sensitivities_are_those_by_quotients_along_the_manifold() {
    let u = [9.0, 0.01, -0.02, 0.03];
    let (y, v) = start();
    let (period, substeps) = (0.3, 3);
    let (y_next, v_next, state, input) =
        runge_kutta_on_manifold_derivatives(&WIDTHS, &y, &v, &u, period, substeps, |y, v| {
            TUMBLING.linearize(y, v, &u)
        });
    let next = step(&TUMBLING, (y, v), &u, period, substeps);
    assert!(error(&(y_next, v_next), &next) <= 1e-14);
    let at = |j: usize, h: f64| {
        let (mut d, mut v, mut u) = ([0.0; 6], v, u);
        match j {
            0..6 => d[j] = h,
            6..12 => v[j - 6] += h,
            _ => u[j - 12] += h,
        }
        let (y_end, v_end) = step(&TUMBLING, (integrate(&WIDTHS, &y, &d), v), &u, period, substeps);
        let d: [f64; 6] = difference(&WIDTHS, &next.0, &y_end);
        [d, core::array::from_fn(|i| v_end[i] - next.1[i])]
    };
    for j in 0..16 {
        let (after, before) = (at(j, 1e-5), at(j, -1e-5));
        for half in 0..2 {
            for i in 0..6 {
                let quotient = (after[half][i] - before[half][i]) / 2e-5;
                let found = match j {
                    0..6 => state[half][0][i][j],
                    6..12 => state[half][1][i][j - 6],
                    _ => input[half][i][j - 12],
                };
                let error = (found - quotient).abs();
                assert!(error <= 1e-8 * found.abs().max(1.0), "{half} {i} {j}: {found} is not {quotient}");
            }
        }
    }
}

/// A spherical joint and two plain ones: a free rotor, and a pendulum whose acceleration depends on both.
#[test]
fn several_joints_have_sensitivities_too() {
    const MIXED: [usize; 3] = [1, 4, 1];
    let acceleration = |y: &[f64; 6], v: &[f64; 5]| {
        let w = [v[1], v[2], v[3]];
        [
            -9.0 * y[0].sin() + 0.3 * v[2] * v[4],
            0.7 * w[1] * w[2] + 0.2 * y[5],
            -0.4 * w[0] * w[2] + 2.0 * (y[1] * y[4] + y[2] * y[3]),
            0.1 * w[0] * w[1],
            -3.0 * y[5] + v[0] * v[1],
        ]
    };
    // Its linearization by quotients: what counts here is the chain rule around it.
    let linearize = |y: &[f64; 6], v: &[f64; 5]| {
        let (mut by_y, mut by_v) = ([[0.0; 5]; 5], [[0.0; 5]; 5]);
        for j in 0..5 {
            let at = |h: f64| {
                let mut d = [0.0; 5];
                d[j] = h;
                let moved = acceleration(&integrate(&MIXED, y, &d), v);
                (moved, acceleration(y, &core::array::from_fn(|i| v[i] + d[i])))
            };
            let (after, before) = (at(1e-4), at(-1e-4));
            for i in 0..5 {
                by_y[i][j] = (after.0[i] - before.0[i]) / 2e-4;
                by_v[i][j] = (after.1[i] - before.1[i]) / 2e-4;
            }
        }
        let value = acceleration(y, v);
        let remainder = core::array::from_fn(|i| value[i] - (0..5).map(|j| by_v[i][j] * v[j]).sum::<f64>());
        (by_y, by_v, [[0.0; 0]; 5], remainder)
    };
    let mut random = Random(33);
    let [a, b, c, d] = random.quaternion();
    let (y, v) = ([0.3, a, b, c, d, -0.2], [0.5, 1.0, -2.0, 1.5, 0.4]);
    let run = |y: &[f64; 6], v: &[f64; 5]| runge_kutta_on_manifold(&MIXED, y, v, 0.2, 2, acceleration);
    let (y_next, v_next) = run(&y, &v);
    let (_, _, state, _) = runge_kutta_on_manifold_derivatives(&MIXED, &y, &v, &[], 0.2, 2, linearize);
    for j in 0..10 {
        let at = |h: f64| -> [[f64; 5]; 2] {
            let (mut d, mut v) = ([0.0; 5], v);
            if j < 5 {
                d[j] = h
            } else {
                v[j - 5] += h
            }
            let (y_end, v_end) = run(&integrate(&MIXED, &y, &d), &v);
            [difference(&MIXED, &y_next, &y_end), core::array::from_fn(|i| v_end[i] - v_next[i])]
        };
        let (after, before) = (at(1e-5), at(-1e-5));
        for half in 0..2 {
            for i in 0..5 {
                let quotient = (after[half][i] - before[half][i]) / 2e-5;
                let found = state[half][j / 5][i][j % 5];
                assert!((found - quotient).abs() <= 1e-7, "{half} {i} {j}: {found} is not {quotient}");
            }
        }
    }
}

/// Where all joints have ẏ = v the method is the classical one.
#[test]
fn robots_without_quaternions_step_as_ever() {
    let acceleration = |y: &[f64; 2], v: &[f64; 2]| [-y[0].sin() + v[1] * v[0], -4.0 * y[1] - 0.2 * v[1]];
    let (y, v) = ([0.4, -0.9], [1.0, 2.0]);
    let (y_found, v_found) = runge_kutta_on_manifold(&[1, 1], &y, &v, 0.3, 3, acceleration);
    let (y_expected, v_expected) = runge_kutta(y, v, 0.3, 3, acceleration);
    assert!(distance(&y_found, &y_expected) <= 1e-15 && distance(&v_found, &v_expected) <= 1e-15);
}

#[test]
fn steps_keep_unit_length_a_million_times() {
    let mut state = start();
    for _ in 0..1_000_000 {
        state = step(&TUMBLING, state, &[0.0; 4], 0.01, 1);
        let length = state.0[3..].iter().map(|q| q * q).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() <= 1e-15, "{length}");
    }
}
