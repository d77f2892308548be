//! Closed loops of LTV-MPC by its prediction rules: `cargo bench -p gelenk-runtime --bench prediction`.
//!
//! Each robot makes a slow and a fast motion at 5, 10 and 20 ms with 20 stages, on a simulated plant with exact friction. Each
//! is joined by a second of rest. The columns:
//!
//! - cost: `Σ ½ δxᵀ Q δx + ½ δuᵀ R δu` of the loop with the implicit midpoint rule, as a part of that with the exact hold
//! - ringing: the share of a full input by which inputs alternate at rest, `max_j rms(u_k − 2 u_{k−1} + u_{k−2})/(4 ū_j)`, with the
//!   hold and with the midpoint rule
//!
//! The last column says whether the rule may replace the hold there: neither cost nor ringing is more than 1 % larger.

use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::{Discretizable, LimitRows, PhaseSpace};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, PredictionRule};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, RestToRest, Trajectory};
use std::error::Error;

#[path = "../tests/support/rubbing.rs"]
#[allow(dead_code, missing_docs, reason = "a robot of the tests")]
mod rubbing;

use rubbing::{Rubbing, Sign};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
gelenk_runtime::dynamics!(struct Ur5 = gelenk_generated::ur5);
gelenk_runtime::dynamics!(struct Quadrotor = gelenk_generated::quadrotor);

const REST: f64 = 1.0;

/// Cost and ringing of a loop.
struct Outcome {
    cost: f64,
    ringing: f64,
}

/// Moves the plant along the motion and lets it rest.
fn run<D, P, T, const N: usize, const M: usize, const NX: usize, const NY: usize>(
    (model, plant): (&D, &P),
    motion: &T,
    options: &MpcOptions<N, M>,
) -> Result<Outcome, Box<dyn Error>>
where
    D: Discretizable<N, M, NY> + PhaseSpace<NX> + Copy,
    P: Discretizable<N, M, NY> + Copy,
    T: Trajectory<N, NY> + Clone,
{
    let period = options.period;
    let mut controller = LtvMpc::<D, _, N, M, NX, 0, NY>::new(*model, motion.clone(), options.clone())?;
    let feed_forward = FeedForward::new(*model)?;
    let mut plant = Plant::new(*plant, PlantOptions::default())?;
    let start = motion.sample(0.0);
    plant.reset(start.positions, [0.0; N])?;
    let mut last_inputs = feed_forward.at(&start).inputs;
    controller.reset(&start.positions, &last_inputs);
    let (mut cost, mut inputs) = (0.0, vec![]);
    for k in 0..((motion.duration() + REST) / period).round() as usize {
        let time = k as f64 * period;
        let cycle = Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            velocities: options.observer.velocity_sensor_noise.map(|_| plant.state().1),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle)?.inputs;
        let forward = feed_forward.at(&motion.sample(time + 0.5 * period)).inputs;
        plant.apply(&last_inputs, period)?;
        let ((y, v), desired) = (plant.state(), motion.sample(time + period));
        let error = model.difference(&desired.positions, &y);
        for i in 0..N {
            cost += 0.5 * options.position_weight[i] * error[i].powi(2);
            cost += 0.5 * options.velocity_weight[i] * (v[i] - desired.velocities[i]).powi(2);
        }
        for j in 0..M {
            cost += 0.5 * options.input_weight[j] * (last_inputs[j] - forward[j]).powi(2);
        }
        if time > motion.duration() {
            inputs.push(last_inputs);
        }
    }
    let alternating = |j: usize| {
        let squares = inputs.windows(3).map(|u| (u[2][j] - 2.0 * u[1][j] + u[0][j]).powi(2));
        let count = squares.len() as f64;
        let full = options.input_limits[j].iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        (squares.sum::<f64>() / count).sqrt() / (4.0 * full)
    };
    Ok(Outcome { cost, ringing: (0..M).map(alternating).fold(0.0, f64::max) })
}

/// Prints a row for each motion and period.
fn rows<D, P, T, const N: usize, const M: usize, const NX: usize, const NY: usize>(
    name: &str,
    robots: (&D, &P),
    motions: [T; 2],
    change: impl Fn(&mut MpcOptions<N, M>),
) -> Result<(), Box<dyn Error>>
where
    D: Discretizable<N, M, NY> + PhaseSpace<NX> + LimitRows<0> + Copy,
    P: Discretizable<N, M, NY> + Copy,
    T: Trajectory<N, NY> + Clone,
{
    for (motion, speed) in motions.iter().zip(["slow", "fast"]) {
        for period in [0.005, 0.01, 0.02] {
            let mut options = MpcOptions::new(robots.0, period, 20);
            change(&mut options);
            let mut with = |prediction| {
                options.prediction = prediction;
                run(robots, motion, &options)
            };
            let [hold, midpoint] =
                [with(PredictionRule::ExactHold)?, with(PredictionRule::ImplicitMidpoint)?];
            let is_as = |of: fn(&Outcome) -> f64| of(&midpoint) <= 1.01 * of(&hold);
            let serves = is_as(|outcome| outcome.cost) && is_as(|outcome| outcome.ringing);
            println!(
                "{name:<14} {speed}  {:>3} ms  cost {:.3e} {:>8.4}  ringing {:.1e} {:.1e}  {}",
                1e3 * period,
                hold.cost,
                midpoint.cost / hold.cost,
                hold.ringing,
                midpoint.ringing,
                if serves { "yes" } else { "no" }
            );
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let cube = |seconds| RestToRest::new([-0.4, -0.5], [0.3, 0.4], seconds);
    rows("PowerCube", (&PowerCube, &PowerCube), [cube(4.0)?, cube(1.2)?], |_| ())?;
    let arm = |seconds| {
        RestToRest::new([0.0, -1.2, 1.0, -0.5, 0.5, 0.0], [1.0, -0.6, 1.6, -1.2, 1.0, 0.8], seconds)
    };
    rows("UR5", (&Ur5, &Ur5), [arm(3.0)?, arm(0.8)?], |_| ())?;
    let panda = |seconds| {
        RestToRest::new(
            [0.0, -0.8, 0.0, -2.2, 0.0, 1.5, 0.8],
            [1.0, 0.3, -0.6, -1.2, 0.7, 2.3, -0.4],
            seconds,
        )
    };
    let smooth = |scale| Rubbing { scale: [scale; 7], sign: Sign::Smooth };
    let exact = |scale| Rubbing { scale: [scale; 7], sign: Sign::Exact };
    rows("Panda", (&smooth(0.0), &exact(0.0)), [panda(4.0)?, panda(1.5)?], |_| ())?;
    rows("Panda, rubbing", (&smooth(1.0), &exact(1.0)), [panda(4.0)?, panda(1.5)?], |_| ())?;
    let start = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let flight =
        |seconds| GeodesicMotion::between(Quadrotor, start, [1.5, -0.5, 1.4, 0.0, 0.0, 0.6, 0.8], seconds);
    rows("quadrotor", (&Quadrotor, &Quadrotor), [flight(4.0)?, flight(1.5)?], |options| {
        options.position_weight = [10.0; 6];
        options.velocity_weight = [10.0, 10.0, 10.0, 1.0, 1.0, 1.0];
        options.input_weight = [0.1; 4];
        options.observer.velocity_sensor_noise = Some([1e-5; 6]);
    })
}
