//! The plant against closed forms, conservation laws and its own promises.

#![allow(clippy::unwrap_used, reason = "test code")]

mod measurement;
mod push;

use gelenk_runtime::dynamics::{Dynamics, Limits};
use gelenk_runtime::plant::{Plant, PlantOptions};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Puma = gelenk_generated::puma560);

/// A mass on a line: `m ÿ = u − d ẏ − c (1 + k y) sign ẏ`.
#[derive(Clone, Copy)]
struct Slider {
    mass: f64,
    viscous: f64,
    coulomb: f64,
    /// k, how the dry friction grows along the line (1/m).
    tightening: f64,
}

impl Dynamics<1, 1> for Slider {
    fn limits(&self) -> Limits<1, 1> {
        Limits {
            position: [[f64::NEG_INFINITY, f64::INFINITY]],
            velocity: [f64::INFINITY],
            effort: [5.0],
            peak_effort: [10.0],
            input: [[-5.0, 5.0]],
            peak_input: [[-10.0, 10.0]],
            dependent: &[],
            torque_speed: &[],
        }
    }
    fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[self.mass]]
    }
    fn coriolis_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn gravity_forces(&self, _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn spring_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn friction_torques(&self, y: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
        let sign = if v[0] == 0.0 { 0.0 } else { v[0].signum() };
        [self.viscous * v[0] + self.coulomb * (1.0 + self.tightening * y[0]) * sign]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[[0, 0]]
    }
    fn input_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[1.0]]
    }
}

const SLIDER: Slider = Slider { mass: 2.0, viscous: 0.0, coulomb: 0.0, tightening: 0.0 };

/// A generated robot without friction.
struct Frictionless<D>(D);

impl<D: Dynamics<N, M>, const N: usize, const M: usize> Dynamics<N, M> for Frictionless<D> {
    fn limits(&self) -> Limits<N, M> {
        self.0.limits()
    }
    fn mass_matrix(&self, y: &[f64; N]) -> [[f64; N]; N] {
        self.0.mass_matrix(y)
    }
    fn coriolis_forces(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        self.0.coriolis_forces(y, v)
    }
    fn gravity_forces(&self, y: &[f64; N]) -> [f64; N] {
        self.0.gravity_forces(y)
    }
    fn spring_forces(&self, y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        self.0.spring_forces(y, v)
    }
    fn friction_torques(&self, _: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [0.0; N]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[]
    }
    fn input_matrix(&self, y: &[f64; N]) -> [[f64; M]; N] {
        self.0.input_matrix(y)
    }
}

fn ideal<D: Dynamics<N, M>, const N: usize, const M: usize>(model: D) -> Plant<D, N, M> {
    Plant::new(model, PlantOptions::default()).unwrap()
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} and {b}");
}

#[test]
fn a_plant_without_friction_conserves_energy() {
    let energy = |y: &[f64; 6], v: &[f64; 6]| {
        Puma.kinetic_energy(y, v) + gelenk_generated::puma560::potential_energy(y)
    };
    let mut plant = ideal(Frictionless(Puma));
    let start = [0.3, 0.4, -0.5, 0.2, 0.7, -0.1];
    plant.reset(start, [0.5, -0.2, 0.4, 1.0, -0.6, 0.3]).unwrap();
    let (y, v) = plant.state();
    let before = energy(&y, &v);
    let mut largest: f64 = 0.0;
    for _ in 0..250 {
        plant.apply(&[0.0; 6], 0.02).unwrap();
        let (y, v) = plant.state();
        largest = largest.max(Puma.kinetic_energy(&y, &v));
        close(energy(&y, &v), before, 1e-6 * largest.max(1.0));
    }
    assert!(largest > 20.0, "it swings: {largest} J");
}

#[test]
fn the_error_follows_the_tolerance() {
    let end = |tolerance: f64| {
        let options = PlantOptions {
            relative_tolerance: tolerance,
            absolute_tolerance: tolerance,
            ..PlantOptions::default()
        };
        let mut plant = Plant::new(Frictionless(PowerCube), options).unwrap();
        plant.reset([0.3, -0.4], [0.5, 1.0]).unwrap();
        plant.apply(&[0.02, -0.01], 2.0).unwrap();
        plant.state().0
    };
    let exact = end(1e-14);
    let error = |tolerance: f64| {
        let y = end(tolerance);
        (y[0] - exact[0]).hypot(y[1] - exact[1])
    };
    let errors = [1e-4, 1e-7, 1e-10].map(error);
    assert!(errors[0] < 1e-2 && errors[2] < 1e-9, "{errors:?}");
    assert!(errors[1] < 0.1 * errors[0] && errors[2] < 0.1 * errors[1], "{errors:?}");
}

#[test]
fn a_damped_mass_follows_its_closed_form() {
    let mut plant = ideal(Slider { viscous: 0.5, ..SLIDER });
    for _ in 0..100 {
        plant.apply(&[3.0], 0.02).unwrap();
    }
    let (t, rate) = (2.0_f64, 0.5 / 2.0);
    let decay = (-rate * t).exp();
    let (y, v) = plant.state();
    close(plant.time(), t, 1e-12);
    close(v[0], 6.0 * (1.0 - decay), 1e-9);
    close(y[0], 6.0 * (t - (1.0 - decay) / rate), 1e-9);
}

/// Under dry friction alone a mass stops after m v/c, having slid m v²/2c, and stays.
#[test]
fn dry_friction_stops_a_mass_and_holds_it() {
    let mut plant = ideal(Slider { coulomb: 1.6, ..SLIDER });
    plant.reset([0.0], [1.0]).unwrap();
    for _ in 0..62 {
        plant.apply(&[0.0], 0.02).unwrap();
    }
    close(plant.state().1[0], 1.0 - 0.8 * 1.24, 1e-9);
    plant.apply(&[0.0], 0.02).unwrap();
    assert_eq!(plant.state().1, [0.0]);
    close(plant.state().0[0], 0.625, 1e-9);
    let at = plant.state();
    for u in [1.59, -1.59, 0.0] {
        plant.apply(&[u], 0.02).unwrap();
        assert_eq!(plant.state(), at, "held against {u} N");
    }
    plant.apply(&[-2.0], 0.5).unwrap();
    close(plant.state().1[0], -0.1, 1e-9);
    close(plant.state().0[0], 0.625 - 0.025, 1e-9);
}

/// A push against the motion: the mass stops within the period and leaves in the other direction. Dry
/// friction that grows along the way takes up `½ m v² = c (y + k y²/2)`, and where the mass stopped it holds
/// as much as it brakes there.
#[test]
fn dry_friction_of_the_position_stops_and_holds_by_it() {
    let mut plant = ideal(Slider { coulomb: 1.6, tightening: 2.0, ..SLIDER });
    plant.reset([0.0], [1.0]).unwrap();
    for _ in 0..100 {
        plant.apply(&[0.0], 0.02).unwrap();
    }
    let stop = (-1.0 + (1.0_f64 + 2.0 * 2.0 * 0.625).sqrt()) / 2.0;
    let at = plant.state();
    assert_eq!(at.1, [0.0]);
    close(at.0[0], stop, 1e-9);
    let holds = 1.6 * (1.0 + 2.0 * stop);
    assert!(holds > 2.0 * 1.49, "more than at y = 0");
    plant.apply(&[0.99 * holds], 0.02).unwrap();
    assert_eq!(plant.state(), at);
    plant.apply(&[1.01 * holds], 0.02).unwrap();
    assert!(plant.state().1[0] > 0.0);
}

/// A mass that a geared drive lifts: the load adds friction of the gear to the dry friction, `u = τ_l + (c + s |τ_l|)
/// sign ẏ` with `τ_l = m ÿ + W`.
struct Lift;

const LIFT: [f64; 4] = [2.0, 4.0, 0.5, 0.25];

impl Dynamics<1, 1> for Lift {
    fn limits(&self) -> Limits<1, 1> {
        SLIDER.limits()
    }
    fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[LIFT[0]]]
    }
    fn coriolis_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn gravity_forces(&self, _: &[f64; 1]) -> [f64; 1] {
        [-LIFT[1]]
    }
    fn spring_forces(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn friction_torques(&self, _: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
        [if v[0] == 0.0 { 0.0 } else { LIFT[2] * v[0].signum() }]
    }
    fn load_friction(&self, _: &[f64; 1], v: &[f64; 1]) -> [f64; 1] {
        [if v[0] == 0.0 { 0.0 } else { LIFT[3] * v[0].signum() }]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[[0, 0]]
    }
    fn input_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[1.0]]
    }
}

/// Rising, the load is (u − c)/(1 + s), falling (u + c)/(1 − s); at rest the drive may exert W ± (c + s W).
#[test]
fn friction_under_load_brakes_and_holds_by_the_load() {
    let [m, w, c, s] = LIFT;
    let rising = |u: f64| ((u - c) / (1.0 + s) - w) / m;
    let falling = |u: f64| ((u + c) / (1.0 - s) - w) / m;
    let mut plant = ideal(Lift);
    plant.reset([0.0], [1.0]).unwrap();
    plant.apply(&[4.0], 1.0).unwrap();
    close(plant.state().1[0], 1.0 + rising(4.0), 1e-9);
    plant.apply(&[4.0], 1.0).unwrap();
    assert_eq!(plant.state().1, [0.0]);
    close(plant.state().0[0], 0.5 / -rising(4.0), 1e-9);
    let at = plant.state();
    let range = [w - c - s * w, w + c + s * w];
    for u in [range[0] + 0.01, w, range[1] - 0.01] {
        plant.apply(&[u], 0.5).unwrap();
        assert_eq!(plant.state(), at, "held by {u} N");
    }
    for (u, acceleration) in
        [(range[0] - 0.01, falling(range[0] - 0.01)), (7.0, rising(7.0)), (1.0, falling(1.0))]
    {
        plant.reset([0.0], [0.0]).unwrap();
        plant.apply(&[u], 0.5).unwrap();
        close(plant.state().1[0], 0.5 * acceleration, 1e-9);
    }
    // Up, to a stop within the period, and down.
    plant.reset([0.0], [0.9]).unwrap();
    plant.apply(&[1.0], 1.0).unwrap();
    let stop = 0.9 / -rising(1.0);
    close(plant.state().1[0], falling(1.0) * (1.0 - stop), 1e-9);
    // Brakes are friction in addition to the load.
    plant.reset([0.0], [0.5]).unwrap();
    plant.brake();
    plant.apply(&[0.0], 0.01).unwrap();
    assert!(plant.state().1[0] < 0.5);
}

#[test]
fn a_reversal_within_a_period_is_located() {
    let mut plant = ideal(Slider { coulomb: 1.0, ..SLIDER });
    plant.reset([0.0], [0.7]).unwrap();
    plant.apply(&[-3.0], 1.0).unwrap();
    // Forward at −2 m/s² for 0.35 s, then back at −1 m/s².
    let (y, v) = plant.state();
    close(v[0], -0.65, 1e-9);
    close(y[0], 0.7 * 0.35 - 0.35 * 0.35 - 0.5 * 0.65 * 0.65, 1e-9);
}

/// All six joints of the Puma have Coulomb friction: the arm comes to rest in finite time, losing energy all
/// the way, and then does not move.
#[test]
fn an_arm_with_coulomb_friction_comes_to_rest() {
    let energy = |y: &[f64; 6], v: &[f64; 6]| {
        Puma.kinetic_energy(y, v) + gelenk_generated::puma560::potential_energy(y)
    };
    let mut plant = ideal(Puma);
    let hanging = [0.0, -1.6, 1.6, 0.1, 0.2, 0.0];
    plant.reset(hanging, [1.0, 0.5, -0.7, 2.0, -2.0, 3.0]).unwrap();
    let mut before = f64::INFINITY;
    for _ in 0..200 {
        let (y, v) = plant.state();
        let now = energy(&y, &v);
        assert!(now <= before + 1e-9, "{now} J after {before} J");
        before = now;
        plant.apply(&[0.0; 6], 0.02).unwrap();
    }
    assert_eq!(plant.state().1, [0.0; 6]);
    let rest = plant.state();
    plant.apply(&[0.0; 6], 1.0).unwrap();
    assert_eq!(plant.state(), rest);
}

#[test]
fn brakes_stop_and_hold_a_falling_arm() {
    let mut plant = ideal(PowerCube);
    plant.reset([0.8, 0.5], [1.0, 0.5]).unwrap();
    plant.brake();
    assert!(plant.is_braked());
    for _ in 0..25 {
        plant.apply(&[0.5, -0.5], 0.02).unwrap();
        assert_eq!(plant.applied(), [0.0; 2], "the drives are off");
    }
    let (y, v) = plant.state();
    assert_eq!(v, [0.0; 2]);
    assert!(y[0] > 0.8 && y[0] < 0.85, "{y:?}");
    plant.release();
    plant.hold(0.5).unwrap();
    assert!(plant.state().0[0] > y[0], "released, it falls");
}

/// The default brake of the slider is 20 N; an infinite one locks.
#[test]
fn brakes_decelerate_by_their_torque() {
    let mut plant = ideal(SLIDER);
    plant.reset([0.0], [1.0]).unwrap();
    plant.brake();
    plant.hold(0.05).unwrap();
    close(plant.state().1[0], 0.5, 1e-9);
    plant.hold(0.1).unwrap();
    assert_eq!(plant.state().1, [0.0]);
    close(plant.state().0[0], 0.05, 1e-9);

    let options = PlantOptions { brake_torque: Some([f64::INFINITY]), ..PlantOptions::default() };
    let mut locked = Plant::new(SLIDER, options).unwrap();
    locked.reset([0.3], [1.0]).unwrap();
    locked.brake();
    locked.hold(0.1).unwrap();
    assert_eq!(locked.state(), ([0.3], [0.0]));
}
