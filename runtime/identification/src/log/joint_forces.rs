//! Forces at the joints of what acts at frames: cylinders and wrench inputs, whose levers depend on the positions.

use super::super::robot::Robot;
use super::super::run::{Effort, Run};

/// Replaces the inputs u of a run by the forces at the joints, B(y) u, where inputs act at frames. NaN where an input acts that
/// was not measured.
///
/// The positions are the measured ones: their noise passes through the levers of the forces.
pub(super) fn at_joints(run: &mut Run, robot: &dyn Robot) {
    if run.effort != Effort::Input || !robot.has_inputs_at_frames() {
        return;
    }
    let (joints, samples) = (run.positions.len(), run.times.len());
    let mut forces = vec![vec![0.0; samples]; joints];
    let mut force = vec![0.0; joints];
    for i in 0..samples {
        let y: Vec<f64> = run.positions.iter().map(|column| column[i]).collect();
        let u: Vec<f64> = run.efforts.iter().map(|column| column[i]).collect();
        let known: Vec<f64> = u.iter().map(|u| if u.is_nan() { 0.0 } else { *u }).collect();
        robot.input_forces(&y, &known, &mut force);
        forces.iter_mut().zip(&force).for_each(|(column, force)| column[i] = *force);
        for input in (0..u.len()).filter(|input| u[*input].is_nan()) {
            let unit: Vec<f64> = (0..u.len()).map(|k| f64::from(u8::from(k == input))).collect();
            robot.input_forces(&y, &unit, &mut force);
            let reached = forces.iter_mut().zip(&force).filter(|(_, lever)| **lever != 0.0);
            reached.for_each(|(column, _)| column[i] = f64::NAN);
        }
    }
    (run.efforts, run.effort) = (forces, Effort::Joint);
}
