//! Runs a controller on a simulated robot period by period.
#![allow(dead_code, reason = "no example reads all of a period")]

use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::plant::Plant;
use std::error::Error;

/// State at the end of a period.
#[derive(Debug, Clone, Copy)]
pub struct Period<const N: usize, const M: usize, const NY: usize = N> {
    /// Time since the start [s].
    pub time: f64,
    pub positions: [f64; NY],
    pub velocities: [f64; N],
    /// Inputs that acted during the period.
    pub inputs: [f64; M],
}

/// Runs `controller` on `plant` for `steps` periods from the present state of the plant. `inputs` are the inputs before the first
/// period. Positions and velocities are measured. The options of the controller determine whether it uses the velocities.
pub fn run<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize>(
    plant: &mut Plant<D, N, M, NY>,
    controller: &mut impl Controller<N, M, NY>,
    mut inputs: [f64; M],
    period: f64,
    steps: u32,
) -> Result<Vec<Period<N, M, NY>>, Box<dyn Error>> {
    controller.reset(&plant.measure().positions, &inputs);
    let mut periods = Vec::new();
    for k in 0..steps {
        let start = period * f64::from(k);
        let command = controller.step(&Cycle {
            time: start,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            velocities: Some(plant.state().1),
            last_inputs: inputs,
            ..Cycle::default()
        })?;
        inputs = command.inputs;
        plant.apply(&inputs, period)?;
        let (positions, velocities) = plant.state();
        periods.push(Period { time: start + period, positions, velocities, inputs });
    }
    Ok(periods)
}
