#![allow(clippy::unwrap_used, reason = "test code")]

use super::ZeroOrderHolds;
use super::batch::{Case, Held};
use super::rollout::{Rollouts, TOGETHER};
use crate::driven::DrivenRobot;
use crate::dynamics::{Differentiable, Discretizable, Discretization, Linearization, Point, Step};
use crate::trajectory::RestToRest;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

gelenk_dynamics::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_dynamics::dynamics!(struct CartPole = gelenk_generated::cart_pole);
gelenk_dynamics::dynamics!(struct Ur5 = gelenk_generated::ur5);
gelenk_dynamics::dynamics!(struct Panda = gelenk_generated::panda);
gelenk_dynamics::dynamics!(struct RailArm { driven } = gelenk_generated::rail_arm);
gelenk_dynamics::dynamics!(struct Quadrotor = gelenk_generated::quadrotor);
gelenk_dynamics::dynamics!(struct Satellite = gelenk_generated::satellite);

/// Twice the documented error bound, because both compared results have an error.
const BOUND: f64 = 2e-12;

fn largest(block: &[f64]) -> f64 {
    block.iter().fold(0.0, |largest, entry| entry.abs().max(largest))
}

/// Asserts that every block differs by less than `BOUND` times its largest entry, or times `least` if that is larger.
fn assert_blocks_near(found: &[f64], expected: &[f64], least: f64) {
    let scale = largest(expected).max(least);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= BOUND * scale, "{found} is not {expected}, of {scale}");
    }
}

fn assert_near<const N: usize, const M: usize, const NY: usize>(
    found: &Discretization<N, M, NY>,
    expected: &Discretization<N, M, NY>,
) {
    assert!(expected.is_finite());
    for half in 0..2 {
        for block in 0..2 {
            let least = if block == half { 1.0 } else { 0.0 };
            let expected = expected.state[half][block].as_flattened();
            assert_blocks_near(found.state[half][block].as_flattened(), expected, least);
        }
        assert_blocks_near(found.input[half].as_flattened(), expected.input[half].as_flattened(), 0.0);
        assert_blocks_near(&found.affine[half], &expected.affine[half], 0.0);
    }
}

fn held<const N: usize, const M: usize>(
    linear: &[Linearization<N, M>],
    period: f64,
) -> Vec<Discretization<N, M>> {
    let mut results = vec![linear[0].discretize(1.0); linear.len()];
    ZeroOrderHolds::new().discretize(linear, None, period, &mut results);
    results
}

fn random<const L: usize>(random: &mut ChaCha8Rng, size: f64) -> [f64; L] {
    core::array::from_fn(|_| size * random.random_range(-1.0..1.0))
}

/// Robots at random states.
fn robots<D: Differentiable<N, M>, const N: usize, const M: usize>(
    model: &D,
    count: usize,
) -> Vec<Linearization<N, M>> {
    let mut numbers = ChaCha8Rng::seed_from_u64(3);
    let mut state = || (random(&mut numbers, 1.5), random(&mut numbers, 2.0), random(&mut numbers, 1.0));
    let states: Vec<_> = (0..count).map(|_| state()).collect();
    states.iter().map(|(y, v, u)| model.linearize(y, v, u)).collect()
}

fn are_those_of_the_scalar_method<D, const N: usize, const M: usize>(model: D)
where
    D: Discretizable<N, M>,
{
    for count in [1, 3, 20, 21] {
        let linear = robots(&model, count);
        for period in [1e-4, 0.005, 0.02, 0.1] {
            let found = held(&linear, period);
            assert_eq!(found, held(&linear, period), "equal inputs give results that are equal bit for bit");
            for (found, linear) in found.iter().zip(&linear) {
                assert_near(found, &linear.discretize(period));
                assert_eq!(*found, held(&[*linear], period)[0], "a batch equals single holds bit for bit");
            }
        }
    }
}

#[test]
fn holds_of_arms_are_those_of_the_scalar_method() {
    are_those_of_the_scalar_method(PowerCube);
    are_those_of_the_scalar_method(CartPole);
    are_those_of_the_scalar_method(Ur5);
    are_those_of_the_scalar_method(Panda);
}

fn with_drift<D, const N: usize, const M: usize, const NY: usize>(model: &D, size: f64)
where
    D: Discretizable<N, M, NY>,
{
    let mut numbers = ChaCha8Rng::seed_from_u64(5);
    let mut cases = [Case::<N, M>::ZERO; 3];
    let states: [([f64; NY], [f64; N], [f64; M]); 3] = core::array::from_fn(|_| {
        let y = model.integrate(&model.neutral(), &random(&mut numbers, size));
        (y, random(&mut numbers, size), random(&mut numbers, 1.0))
    });
    for (case, (y, v, u)) in cases.iter_mut().zip(&states) {
        case.set_robot(&model.linearize(y, v, u));
        (case.drift, case.state, case.input) = (model.drift(v), [[0.0; N], *v], *u);
    }
    let linear = states.map(|(y, v, u)| model.linearize(&y, &v, &u));
    let drifts = states.map(|(_, v, _)| model.drift(&v));
    let mut discrete = linear.map(|linear| linear.discretize_with(&[[0.0; N]; N], 1.0));
    let mut holds = ZeroOrderHolds::new();
    holds.discretize(&linear, Some(&drifts), 0.02, &mut discrete);
    for (found, (y, v, u)) in discrete.iter().zip(&states) {
        assert_near(found, &model.discretize(y, v, u, 0.02));
    }
    let mut holds = ZeroOrderHolds::new();
    let found = holds.hold(&cases, true, 0.02);
    for (found, (y, v, u)) in found.iter().zip(&states) {
        let Held { input, next, is_finite, .. } = *found;
        assert!(is_finite);
        let expected = model.discretize(y, v, u, 0.02);
        assert_near(&Discretization { state: found.blocks(), input, affine: expected.affine }, &expected);
        let (positions, velocities) = expected.displaced(&[0.0; N], v, u);
        assert_blocks_near(&next[0], &positions, 0.0);
        assert_blocks_near(&next[1], &velocities, 0.0);
    }
}

#[test]
fn holds_of_robots_with_quaternions_are_those_of_the_scalar_method() {
    with_drift(&Quadrotor, 1.0);
    with_drift(&Quadrotor, 5.0);
    with_drift(&Satellite, 1.0);
}

/// Tests matrices of one size, which leave different numbers of rows and columns for the last tiles.
fn of_size<const N: usize, const M: usize>() {
    let mut numbers = ChaCha8Rng::seed_from_u64(N as u64);
    let mut matrix = |size| -> [[f64; N]; N] { core::array::from_fn(|_| random(&mut numbers, size)) };
    let blocks: [_; 5] = core::array::from_fn(|_| (matrix(20.0), matrix(3.0)));
    let linear: [Linearization<N, M>; 5] = blocks.map(|(by_coordinates, by_velocities)| Linearization {
        by_coordinates,
        by_velocities,
        by_inputs: core::array::from_fn(|_| random(&mut numbers, 1.0)),
        affine: random(&mut numbers, 1.0),
    });
    for period in [0.01, 0.3] {
        let found = held(&linear, period);
        found.iter().zip(&linear).for_each(|(found, linear)| assert_near(found, &linear.discretize(period)));
    }
}

#[test]
fn sizes_need_not_be_multiples_of_the_tiles() {
    of_size::<1, 1>();
    of_size::<2, 5>();
    of_size::<3, 2>();
    of_size::<4, 0>();
    of_size::<5, 7>();
    of_size::<8, 3>();
    of_size::<10, 4>();
    of_size::<11, 11>();
}

/// The robot `linear` with all rates multiplied by `factor`.
fn faster<const N: usize, const M: usize>(linear: &Linearization<N, M>, factor: f64) -> Linearization<N, M> {
    let mut faster = *linear;
    faster.by_coordinates.as_flattened_mut().iter_mut().for_each(|entry| *entry *= factor * factor);
    faster.by_velocities.as_flattened_mut().iter_mut().for_each(|entry| *entry *= factor);
    faster
}

/// The step length of each robot of a batch is halved as often as this robot needs, up to 24 times. The result equals
/// the result of a single robot bit for bit.
#[test]
fn robots_of_very_different_rates_share_a_batch() {
    let mut slow = robots(&PowerCube, 4);
    for factor in [1e-3, 1.0, 30.0, 1e3, 1e5] {
        // The robot is damped, so the exact result is finite.
        slow[2] = Linearization {
            by_coordinates: [[-1.0, 0.0], [0.0, -2.0]],
            by_velocities: [[-3.0, 0.5], [0.5, -4.0]],
            ..slow[2]
        };
        let mut batch = slow.clone();
        batch[2] = faster(&slow[2], factor);
        for (k, (found, linear)) in held(&batch, 0.02).iter().zip(&batch).enumerate() {
            assert_eq!(*found, held(&[*linear], 0.02)[0]);
            let expected = linear.discretize(0.02);
            if k != 2 || factor <= 30.0 {
                assert_near(found, &expected);
                continue;
            }
            // The motion has decayed. The small remaining numbers are inaccurate in both methods.
            assert_blocks_near(entries(found), entries(&expected), 1.0);
        }
    }
}

fn entries<const N: usize, const M: usize>(discrete: &Discretization<N, M>) -> &[f64] {
    discrete.state.as_flattened().as_flattened().as_flattened()
}

#[test]
fn robots_that_are_not_finite_or_too_fast_do_not_spoil_the_others() {
    let linear = robots(&Ur5, 4);
    let rates = |rate: f64| Linearization { by_velocities: [[rate; 6]; 6], ..linear[1] };
    for spoiled in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e12] {
        let mut batch = linear.clone();
        batch[1] = rates(spoiled);
        let found = held(&batch, 0.02);
        assert_eq!(found[1].state, [[[[f64::INFINITY; 6]; 6]; 2]; 2], "{spoiled}");
        assert_eq!(
            (found[1].input, found[1].affine),
            ([[[f64::INFINITY; 6]; 6]; 2], [[f64::INFINITY; 6]; 2])
        );
        for k in [0, 2, 3] {
            assert_near(&found[k], &linear[k].discretize(0.02));
            assert_eq!(found[k], held(&linear[k..=k], 0.02)[0]);
        }
        batch[1] = Linearization { affine: [spoiled; 6], ..linear[1] };
        let found = held(&batch, 0.02);
        assert_eq!(found[1].is_finite(), spoiled == 1e12);
        assert_near(&found[3], &linear[3].discretize(0.02));
    }
}

#[test]
fn nothing_is_done_for_no_robots() {
    ZeroOrderHolds::<2, 2>::default().discretize::<2>(&[], None, 0.02, &mut []);
    let linear = robots(&PowerCube, 5);
    let mut results = [linear[0].discretize(1.0); 4];
    let kept = results[3];
    ZeroOrderHolds::new().discretize(&linear[..3], None, 0.02, &mut results);
    assert_eq!(results[3], kept);
    ZeroOrderHolds::new().discretize(&linear, None, 0.02, &mut results[..1]);
    assert_near(&results[0], &linear[0].discretize(0.02));
}

fn integrated<D, const N: usize, const M: usize, const NY: usize>(
    model: &D,
    starts: &[Point<N, M, NY>],
) -> Vec<Step<N, M, NY>>
where
    D: Discretizable<N, M, NY>,
{
    Rollouts::new(model).integrate(model, starts.iter().copied(), 0.02, 1).to_vec()
}

/// Two steps of one integration equal two integrations of one step. Derivatives are compared along a direction.
fn two_steps_are_composed<D, const N: usize, const M: usize, const NY: usize>(
    model: &D,
    start: &Point<N, M, NY>,
) where
    D: Discretizable<N, M, NY>,
{
    let mut rollouts = Rollouts::new(model);
    let mut steps = |start: Point<N, M, NY>, period: f64, count: usize| {
        rollouts.integrate(model, core::iter::once(start), period, count)[0]
    };
    let whole = steps(*start, 0.02, 2);
    let first = steps(*start, 0.01, 1);
    let Step { coordinates: positions, velocities, .. } = first;
    let second = steps(Point { time: start.time + 0.01, positions, velocities, ..*start }, 0.01, 1);
    assert_blocks_near(&whole.coordinates, &second.coordinates, 0.0);
    assert_blocks_near(&whole.velocities, &second.velocities, 0.0);
    let direction = [0.3, -0.7].map(|entry| [entry; N]);
    let moved = |step: &Step<N, M, NY>, [y, v]: [[f64; N]; 2], u: f64| {
        [0, 1].map(|half| {
            core::array::from_fn(|i| {
                let row = |block: usize, by: &[f64; N]| -> f64 {
                    step.state[half][block][i].iter().zip(by).map(|(a, b)| a * b).sum()
                };
                row(0, &y) + row(1, &v) + u * step.input[half][i].iter().sum::<f64>()
            })
        })
    };
    let found: [[f64; N]; 2] = moved(&whole, direction, 0.5);
    let expected: [[f64; N]; 2] = moved(&second, moved(&first, direction, 0.5), 0.5);
    assert_blocks_near(found.as_flattened(), expected.as_flattened(), 1.0);
}

fn integrations_are_those_of_single_robots<D, const N: usize, const M: usize, const NY: usize>(
    model: D,
    rest: &[f64; NY],
) where
    D: Discretizable<N, M, NY>,
{
    let mut numbers = ChaCha8Rng::seed_from_u64(7);
    let starts: Vec<Point<N, M, NY>> = (0..TOGETHER + 1)
        .map(|k| Point {
            time: 0.1 * k as f64,
            positions: model.integrate(rest, &random(&mut numbers, 1.5)),
            velocities: random(&mut numbers, 2.0),
            inputs: random(&mut numbers, 1.0),
        })
        .collect();
    for count in [1, 4, 5, TOGETHER] {
        let found = integrated(&model, &starts[..count]);
        assert_eq!(found.len(), count);
        for (found, start) in found.iter().zip(&starts) {
            assert_eq!(*found, integrated(&model, &[*start])[0], "a group equals single robots bit for bit");
            let Point { time, positions, velocities, inputs } = start;
            let expected =
                model.at_time(*time, |model| model.step_derivatives(positions, velocities, inputs, 0.02));
            assert!(expected.is_finite());
            assert_blocks_near(&found.coordinates, &expected.coordinates, 0.0);
            assert_blocks_near(&found.velocities, &expected.velocities, 0.0);
            for half in 0..2 {
                for block in 0..2 {
                    let expected = expected.state[half][block].as_flattened();
                    assert_blocks_near(found.state[half][block].as_flattened(), expected, 1.0);
                }
                let expected = expected.input[half].as_flattened();
                assert_blocks_near(found.input[half].as_flattened(), expected, 0.0);
            }
        }
    }
    assert_eq!(integrated(&model, &starts).len(), TOGETHER, "further robots are ignored");
    two_steps_are_composed(&model, &starts[0]);
    let mut with_nan = starts[..3].to_vec();
    with_nan[1].velocities[0] = f64::NAN;
    let (found, alone) = (integrated(&model, &with_nan), integrated(&model, &starts[..3]));
    assert!(!found[1].is_finite());
    assert_eq!([found[0], found[2]], [alone[0], alone[2]], "the other robots are not concerned");
}

#[test]
fn integrations_of_groups_are_those_of_single_robots() {
    integrations_are_those_of_single_robots(PowerCube, &[0.0; _]);
    integrations_are_those_of_single_robots(CartPole, &[0.0; _]);
    integrations_are_those_of_single_robots(Ur5, &[0.0; _]);
    integrations_are_those_of_single_robots(Panda, &[0.0; _]);
    let rail = RestToRest::new([-0.5], [0.5], 1.5).unwrap();
    integrations_are_those_of_single_robots(DrivenRobot::new(RailArm::default(), rail), &[0.0; _]);
    integrations_are_those_of_single_robots(Quadrotor, &gelenk_generated::quadrotor::NEUTRAL);
    integrations_are_those_of_single_robots(Satellite, &gelenk_generated::satellite::NEUTRAL);
}
