//! Conversion of inputs to joint forces. Inputs at frames, such as cylinders, have lever arms that depend on the positions.

use super::super::robot::Robot;
use super::super::run::{Effort, Run};

/// Replaces the inputs u of a run by the joint forces if the robot has inputs at frames.
pub(super) fn move_to_joints(run: &mut Run, robot: &dyn Robot) {
    if run.effort == Effort::Input && robot.has_inputs_at_frames() {
        run.efforts = forces_of_inputs(&run.positions, &run.efforts, robot);
        run.effort = Effort::Joint;
    }
}

/// Returns the joint forces `B(y) u` of all samples, one column for each joint. The column of a joint is NaN
/// in two cases: an input that acts on the joint was not measured in all samples, or the joint is moved from
/// outside.
///
/// The lever arms are computed from the measured positions, so they contain the noise of the positions.
///
/// - `positions`: positions y, one column for each entry, including the entries of quaternions
/// - `inputs`: inputs u, one column for each input
pub(super) fn forces_of_inputs(
    positions: &[Vec<f64>],
    inputs: &[Vec<f64>],
    robot: &dyn Robot,
) -> Vec<Vec<f64>> {
    let samples = positions.first().map_or(0, Vec::len);
    let is_known: Vec<bool> = inputs.iter().map(|column| column.iter().all(|u| u.is_finite())).collect();
    let mut is_missing = robot.unmeasured();
    let mut force = vec![0.0; is_missing.len()];
    let mut forces = vec![vec![0.0; samples]; is_missing.len()];
    for i in 0..samples {
        let y: Vec<f64> = positions.iter().map(|column| column[i]).collect();
        let known = inputs.iter().zip(&is_known).map(|(column, known)| if *known { column[i] } else { 0.0 });
        robot.input_forces(&y, &known.collect::<Vec<f64>>(), &mut force);
        forces.iter_mut().zip(&force).for_each(|(column, force)| column[i] = *force);
        for unknown in (0..inputs.len()).filter(|input| !is_known[*input]) {
            let unit: Vec<f64> =
                (0..inputs.len()).map(|input| f64::from(u8::from(input == unknown))).collect();
            robot.input_forces(&y, &unit, &mut force);
            is_missing.iter_mut().zip(&force).for_each(|(missing, lever)| *missing |= *lever != 0.0);
        }
    }
    let unknown = forces.iter_mut().zip(&is_missing).filter(|(_, missing)| **missing);
    unknown.for_each(|(column, _)| column.fill(f64::NAN));
    forces
}
