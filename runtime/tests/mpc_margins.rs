//! Limits that the plan keeps with a distance, because friction is uncertain.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::methods::random::SplitMix64;
use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::{
    Differentiable, Discretizable, Dynamics, ForceDerivatives, LimitRows, Limits, Linearization, PhaseSpace,
};
use gelenk_runtime::lqr::Lqr;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::trajectory::RestToRest;

const PERIOD: f64 = 0.02;
const MASS: f64 = 2.0;
/// Standard deviation of the friction [N].
const DEVIATION: f64 = 3.0;
const GOAL: f64 = 0.4;

/// A slider whose friction is a constant force, which its model takes for zero.
#[derive(Debug, Clone, Copy)]
struct Slider;

impl Dynamics<1, 1> for Slider {
    fn limits(&self) -> Limits<1, 1> {
        Limits {
            position: [[-1.0, GOAL]],
            velocity: [2.0],
            effort: [f64::INFINITY],
            peak_effort: [f64::INFINITY],
            input: [[-40.0, 40.0]],
            peak_input: [[-40.0, 40.0]],
            dependent: &[],
            torque_speed: &[],
        }
    }
    fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[MASS]]
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
    fn friction_torques(&self, _: &[f64; 1], _: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }
    fn friction_uncertainty(&self, _: &[f64; 1], _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[DEVIATION]]
    }
    fn friction_jumps(&self) -> &'static [[usize; 2]] {
        &[]
    }
    fn input_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[1.0]]
    }
}

impl Differentiable<1, 1> for Slider {
    fn inverse_dynamics_derivatives(&self, y: &[f64; 1], v: &[f64; 1], a: &[f64; 1]) -> ForceDerivatives<1> {
        ForceDerivatives {
            forces: self.inverse_dynamics(y, v, a),
            by_coordinates: [[0.0]],
            by_velocities: [[0.0]],
        }
    }
    fn linearize(&self, _: &[f64; 1], _: &[f64; 1], _: &[f64; 1]) -> Linearization<1, 1> {
        Linearization {
            by_coordinates: [[0.0]],
            by_velocities: [[0.0]],
            by_inputs: [[1.0 / MASS]],
            affine: [0.0],
        }
    }
}

impl Discretizable<1, 1> for Slider {}
impl PhaseSpace<2> for Slider {}
impl LimitRows<0> for Slider {}

const STAGES: usize = 15;
const A: [[f64; 2]; 2] = [[1.0, PERIOD], [0.0, 1.0]];
const B: [[f64; 1]; 2] = [[0.5 * PERIOD * PERIOD / MASS], [PERIOD / MASS]];

/// State after a period.
fn after([y, v]: [f64; 2], force: f64) -> [f64; 2] {
    [y + PERIOD * v + B[0][0] * force, v + B[1][0] * force]
}

fn controller(limit_probability: Option<f64>) -> LtvMpc<Slider, RestToRest<1>, 1, 1, 2> {
    // The goal lies beyond the limit, so that the plan ends at it.
    let motion = RestToRest::new([0.0], [1.1 * GOAL], 0.6).unwrap();
    let options = MpcOptions { limit_probability, ..MpcOptions::<1, 1>::new(&Slider, PERIOD, STAGES) };
    LtvMpc::new(Slider, motion, options).unwrap()
}

/// Largest share, over the stages, of sliders beyond the position limit: sliders with random constant friction follow one plan with
/// the regulator of its weights.
fn exceeded(limit_probability: Option<f64>) -> f64 {
    const SLIDERS: usize = 4000;
    let mut mpc = controller(limit_probability);
    let options = MpcOptions::<1, 1>::new(&Slider, PERIOD, STAGES);
    let start = [0.9 * GOAL, 0.0];
    mpc.reset(&[start[0]], &[0.0]);
    mpc.step(&Cycle { time: 0.6, periods: 0, positions: Some([start[0]]), ..Cycle::default() }).unwrap();
    let plan: Vec<f64> = (0..STAGES).map(|k| mpc.planned(k as u32).unwrap()[0]).collect();
    let state_weight = [[options.position_weight[0], 0.0], [0.0, options.velocity_weight[0]]];
    let [[by_y, by_v]] = Lqr::new(&A, &B, &state_weight, &[options.input_weight]).unwrap().gain;
    let mut random = SplitMix64::new(7);
    let mut beyond = [0; STAGES];
    for _ in 0..SLIDERS {
        let friction = DEVIATION * random.normal();
        let (mut planned, mut actual) = (start, start);
        for (k, input) in plan.iter().enumerate() {
            let feedback = by_y * (actual[0] - planned[0]) + by_v * (actual[1] - planned[1]);
            actual = after(actual, input + feedback - friction);
            planned = after(planned, *input);
            beyond[k] += usize::from(actual[0] > GOAL);
        }
    }
    beyond.into_iter().max().unwrap_or(0) as f64 / SLIDERS as f64
}

#[test]
fn a_limit_holds_with_its_probability() {
    let [plain, even, sure] = [None, Some(0.8), Some(0.95)].map(exceeded);
    println!("exceeded: {plain:.3} without a margin, {even:.3} with 80 %, {sure:.3} with 95 %");
    assert!(plain > 0.4, "{plain}");
    // Three standard deviations of the share of 4000 sliders.
    assert!((even - 0.2).abs() < 0.02, "{even}");
    assert!((sure - 0.05).abs() < 0.011, "{sure}");
}

#[test]
fn probabilities_outside_their_range_are_refused() {
    for probability in [0.5, 1.0, f64::NAN] {
        let options = MpcOptions {
            limit_probability: Some(probability),
            ..MpcOptions::<1, 1>::new(&Slider, PERIOD, 5)
        };
        let motion = RestToRest::new([0.0], [GOAL], 0.6).unwrap();
        let error = LtvMpc::<_, _, 1, 1, 2>::new(Slider, motion, options).unwrap_err().to_string();
        assert!(error.starts_with("limit_probability is"), "{error}");
    }
}
