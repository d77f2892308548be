//! Fastest rate of a robot at standstill, from its linearization.
//!
//! The forward dynamics are differentiated by finite differences, so all forces are included.

use crate::functions::function::Function;
use crate::model::{Actuator, Input, Model};
use crate::program::interpret::interpret;
use crate::random::Random;

const STATES: usize = 4;
const SEED: u64 = 0x7374_6966;

/// Step of the finite differences. Steep friction laws have a width of 1e-3 or more.
const STEP: f64 = 1e-7;

/// Number of matrix squarings after which `‖A^k‖^(1/k)` gives the spectral radius to three digits.
const SQUARINGS: usize = 12;

/// An eigenvalue of the linearized robot, with the coordinate that moves most.
pub(crate) struct Mode {
    /// Magnitude of the eigenvalue (1/s).
    pub rate: f64,
    /// Index of the coordinate with the largest entry in the eigenvector.
    pub coordinate: usize,
}

/// The eigenvalue of largest magnitude at four random positions with a fixed seed, with inputs at the effort
/// limits. `None` if no result is finite.
pub(crate) fn fastest(model: &Model, forward: &Function) -> Option<Mode> {
    let mut random = Random::new(SEED);
    let modes =
        (0..STATES).filter_map(|_| mode(&linearization(model, forward, &positions(model, &mut random))?));
    modes.max_by(|a, b| a.rate.total_cmp(&b.rate))
}

/// Returns random positions of the coordinates. A joint with a quaternion stays at its neutral position.
fn positions(model: &Model, random: &mut Random) -> Vec<f64> {
    let value = |(coordinate, [low, high]): (usize, [f64; 2])| match model.quaternion_joint_of(coordinate) {
        Some(_) => 0.0,
        None => random.between(low, high),
    };
    model.joints().map(|joint| joint.seeded_range()).enumerate().map(value).collect()
}

/// The matrix ((0, 1), (∂ÿ/∂y, ∂ÿ/∂ẏ)) as a list of rows; `None` if the forward dynamics fail at these
/// positions.
fn linearization(model: &Model, forward: &Function, y: &[f64]) -> Option<Vec<Vec<f64>>> {
    let n = y.len();
    let (u, rest) = (inputs(model), vec![0.0; n]);
    let at = |values: &[f64], v: &[f64]| acceleration(model, forward, values, v, &u);
    let mut a = vec![vec![0.0; 2 * n]; 2 * n];
    for column in 0..n {
        let moved = |from: &[f64], by: f64| {
            let mut moved = from.to_vec();
            moved[column] += by;
            moved
        };
        // Both velocities are on one side of 0, where no exact sign jumps.
        let [near, far] = [at(y, &moved(&rest, STEP))?, at(y, &moved(&rest, 2.0 * STEP))?];
        let [below, above] = [at(&moved(y, -STEP), &rest)?, at(&moved(y, STEP), &rest)?];
        for row in 0..n {
            a[n + row][column] = (above[row] - below[row]) / (2.0 * STEP);
            a[n + row][n + column] = (far[row] - near[row]) / STEP;
        }
        a[column][n + column] = 1.0;
    }
    Some(a)
}

fn acceleration(model: &Model, forward: &Function, values: &[f64], v: &[f64], u: &[f64]) -> Option<Vec<f64>> {
    let y = model.positions_by(values);
    let inputs = forward.program.inputs.iter().map(|input| match input.name.as_str() {
        "y" => &y[..],
        "u" => u,
        _ => v,
    });
    let inputs: Vec<&[f64]> = inputs.collect();
    let parameters = model.described_parameters();
    let results = interpret(&forward.program, &inputs, &parameters).ok()?;
    results.into_iter().next()
}

/// The inputs that exert the effort limits of their joints. An input is 0 if its joint has no limit.
fn inputs(model: &Model) -> Vec<f64> {
    let parameters = model.described_parameters();
    let joints: Vec<_> = model.joints().collect();
    let input = |input: Actuator<'_>| {
        let drive = input.drive()?;
        let limits = joints.get(drive.coordinate()?)?.limits;
        let constant = match &drive.input {
            Input::Current(constant) => constant.value(&parameters)?,
            Input::Torque | Input::None => 1.0,
        };
        Some(limits.peak_effort.or(limits.effort)? / (constant * drive.gear_ratio.value(&parameters)?))
    };
    model.inputs().map(|each| input(each).unwrap_or(0.0)).collect()
}

/// The dominant eigenvalue of the matrix from norms of powers, `‖A^k‖^(1/k)`; `None` if a norm is 0 or not
/// finite.
fn mode(a: &[Vec<f64>]) -> Option<Mode> {
    let n = a.len() / 2;
    let (mut rate, mut power) = (1.0, a.to_vec());
    for squaring in 0..=SQUARINGS {
        let norm = power.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        if !norm.is_finite() || norm == 0.0 {
            return None;
        }
        rate *= (0..squaring).fold(norm, |root, _| root.sqrt());
        let scaled: Vec<Vec<f64>> = power.iter().map(|row| row.iter().map(|x| x / norm).collect()).collect();
        power = product(&scaled, &scaled);
    }
    let size = |coordinate: &usize| power[n + coordinate].iter().map(|x| x * x).sum::<f64>();
    let coordinate = (0..n).max_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some(Mode { rate, coordinate })
}

fn product(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let columns = 0..b.len();
    let entry = |row: &[f64], column: usize| row.iter().zip(b).map(|(x, other)| x * other[column]).sum();
    a.iter().map(|row| columns.clone().map(|column| entry(row, column)).collect()).collect()
}
