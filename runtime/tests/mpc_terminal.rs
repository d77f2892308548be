//! The weight at the end of the horizon, where no input reaches a part of the robot.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::{
    Differentiable, Discretizable, Dynamics, ForceDerivatives, LimitRows, Limits, Linearization, PhaseSpace,
};
use gelenk_runtime::mpc::{LtvMpc, MpcError, MpcOptions, Nmpc, TerminalWeight};
use gelenk_runtime::trajectory::RestToRest;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const PERIOD: f64 = 0.05;

/// A hull of 3 kg m² that turns freely, by a wheel of 0.01 kg m² on it: y = (hull, wheel relative to the hull).
#[derive(Debug, Clone, Copy)]
struct FreeHull;

impl Dynamics<2, 1> for FreeHull {
    fn limits(&self) -> Limits<2, 1> {
        let free = [-f64::INFINITY, f64::INFINITY];
        Limits {
            position: [free; 2],
            velocity: [f64::INFINITY; 2],
            effort: [f64::INFINITY; 2],
            peak_effort: [f64::INFINITY; 2],
            input: [[-1.0, 1.0]],
            peak_input: [[-1.0, 1.0]],
            dependent: &[],
            torque_speed: &[],
        }
    }
    fn mass_matrix(&self, _: &[f64; 2]) -> [[f64; 2]; 2] {
        [[3.01, 0.01], [0.01, 0.01]]
    }
    fn coriolis_forces(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn gravity_forces(&self, _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn spring_forces(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn friction_torques(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
        [0.0; 2]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[]
    }
    fn input_matrix(&self, _: &[f64; 2]) -> [[f64; 1]; 2] {
        [[0.0], [1.0]]
    }
}

impl Differentiable<2, 1> for FreeHull {
    fn inverse_dynamics_derivatives(&self, y: &[f64; 2], v: &[f64; 2], a: &[f64; 2]) -> ForceDerivatives<2> {
        let by_coordinates = [[0.0; 2]; 2];
        ForceDerivatives {
            forces: self.inverse_dynamics(y, v, a),
            by_coordinates,
            by_velocities: by_coordinates,
        }
    }
    fn linearize(&self, _: &[f64; 2], _: &[f64; 2], _: &[f64; 1]) -> Linearization<2, 1> {
        Linearization {
            by_coordinates: [[0.0; 2]; 2],
            by_velocities: [[0.0; 2]; 2],
            // M⁻¹ B: the hull gets the opposite torque.
            by_inputs: [[-1.0 / 3.0], [100.0 + 1.0 / 3.0]],
            affine: [0.0; 2],
        }
    }
}

impl Discretizable<2, 1> for FreeHull {}

impl PhaseSpace<4> for FreeHull {}

impl LimitRows<0> for FreeHull {}

/// The hull alone is asked for.
fn options(terminal_weight: TerminalWeight) -> MpcOptions<2, 1> {
    MpcOptions {
        position_weight: [10.0, 0.0],
        velocity_weight: [10.0, 0.0],
        terminal_weight,
        ..MpcOptions::new(&FreeHull, PERIOD, 20)
    }
}

const DISCOUNTED: TerminalWeight = TerminalWeight::Discounted { time_constant: 30.0 };

#[test]
fn a_free_body_is_refused_with_the_remedy() {
    let motion = || RestToRest::new([0.0; 2], [1.0, 0.0], 2.0).unwrap();
    let linear = LtvMpc::new(FreeHull, motion(), options(TerminalWeight::Riccati)).unwrap_err();
    let nonlinear = Nmpc::new(FreeHull, motion(), options(TerminalWeight::Riccati)).unwrap_err();
    for error in [linear, nonlinear] {
        assert!(matches!(error, MpcError::Terminal { time: 0.0, .. }), "{error}");
        assert!(error.to_string().contains("TerminalWeight::Discounted"), "{error}");
    }
    for time_constant in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let wrong = options(TerminalWeight::Discounted { time_constant });
        let error = LtvMpc::new(FreeHull, motion(), wrong).unwrap_err().to_string();
        assert!(error.starts_with("terminal_weight.time_constant is"), "{error}");
    }
}

/// A turn by 1 rad from a hull that rotates: it ends at rest, and the wheel has taken up the momentum.
fn turned(controller: &mut impl Controller<2, 1>) {
    let (mut y, mut v, mut u) = ([0.0; 2], [0.3, 0.0], [0.0]);
    let momentum = 3.01 * v[0] + 0.01 * v[1];
    controller.reset(&y, &u);
    for k in 0..600 {
        let cycle = Cycle {
            time: PERIOD * f64::from(k),
            periods: u32::from(k > 0),
            positions: Some(y),
            last_inputs: u,
            ..Cycle::default()
        };
        u = controller.step(&cycle).unwrap().inputs;
        assert!(u[0].abs() <= 1.0);
        (y, v) = FreeHull.step(&y, &v, &u, PERIOD);
    }
    assert!((y[0] - 1.0).abs() <= 1e-4 && v[0].abs() <= 1e-4, "{y:?} {v:?}");
    assert!((0.01 * v[1] - momentum).abs() <= 1e-3, "the wheel has {} N m s", 0.01 * v[1]);
}

#[test]
fn with_a_discount_hull_and_wheel_exchange_the_momentum() {
    let motion = || RestToRest::new([0.0; 2], [1.0, 0.0], 2.0).unwrap();
    turned(&mut LtvMpc::new(FreeHull, motion(), options(DISCOUNTED)).unwrap());
    turned(&mut Nmpc::new(FreeHull, motion(), options(DISCOUNTED)).unwrap());
}

/// The first input of a short horizon, where the terminal weight counts.
fn first_input(terminal_weight: TerminalWeight) -> f64 {
    let motion = RestToRest::new([0.1, -0.2], [0.5, 0.4], 2.0).unwrap();
    let mut options =
        MpcOptions { terminal_weight, input_weight: [10.0; 2], ..MpcOptions::new(&PowerCube, 0.02, 2) };
    options.qp.tolerance = 1e-10;
    let mut mpc = LtvMpc::new(PowerCube, motion, options).unwrap();
    mpc.reset(&[0.1, -0.2], &[0.0; 2]);
    let cycle = Cycle { positions: Some([0.1001, -0.2]), ..Cycle::default() };
    mpc.step(&cycle).unwrap().inputs[0]
}

/// Where all is reached, the cost without discount is the limit of those with less and less of it.
#[test]
fn the_discount_vanishes_with_its_time_constant() {
    let without = first_input(TerminalWeight::Riccati);
    let apart = |time_constant| (first_input(TerminalWeight::Discounted { time_constant }) - without).abs();
    let [short, long, longest] = [0.1, 1e2, 1e5].map(apart);
    assert!(short > 1e-3 * without.abs(), "{short:e} of {without:e}");
    assert!(long < 0.01 * short && longest < 0.01 * long, "{short:e} {long:e} {longest:e}");
}
