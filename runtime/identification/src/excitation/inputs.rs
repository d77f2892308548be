//! Required values of inputs along a planned motion: of drives, and of inputs that act at frames (for example cylinders).

use super::chart::Chart;
use super::levels;
use super::motors::Torques;
use super::smallest_inputs::{SINGULAR, SmallestInputs, first_outside, rigid_forces, smallest_inputs};
use super::{ExcitationLimits, Instant};
use crate::error::{Result, at_joint};
use crate::numeric::spectrum::svd;
use crate::numeric::statistics::extremes;
use crate::pose::QuaternionJoint;
use crate::robot::Robot;
use nalgebra::DMatrix;

/// Range of the values of an input that a planned motion requires, for the described robot without friction.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedInput {
    /// Name of the input.
    pub name: String,
    /// Lowest and highest required value, in the unit of the input.
    pub range: [f64; 2],
    /// Described lowest and highest value, in the unit of the input; infinite if the description has no limit.
    pub limits: [f64; 2],
}

/// Number of intervals into which a joint's range is divided. Dead centres are searched at the ends of the intervals.
const PLACES: u32 = 200;
/// Inputs of a robot, and their limits.
pub(super) struct Inputs<'a> {
    robot: &'a dyn Robot,
    torques: Torques,
    /// The constant input matrix; `None` if inputs act at frames.
    drives: Option<SmallestInputs>,
}

impl<'a> Inputs<'a> {
    /// Returns the inputs with a share of their limits; `None` if all inputs are drives without limits. The efforts of drives
    /// are also checked at joints and shafts.
    ///
    /// - `share`: usable share of the described limits
    pub(super) fn of(robot: &'a dyn Robot, share: f64) -> Option<Self> {
        let (torques, at_frames) = (Torques::of(robot, share), robot.has_inputs_at_frames());
        let drives = (!at_frames).then(|| SmallestInputs::new(drive_matrix(robot)));
        (at_frames || torques.are_limited()).then_some(Self { robot, torques, drives })
    }

    /// Name of the first limit that a motion exceeds; `None` if all limits are kept. It is the limit of an
    /// input or motor that would need more than its usable range. It can also be a dead centre, near which
    /// inputs need very large forces.
    pub(super) fn exceeded(&self, instants: &[Instant]) -> Option<String> {
        let mut side = 0.0;
        instants.iter().find_map(|instant| {
            let ranges = self.torques.ranges(&instant[1]);
            let inputs = match &self.drives {
                Some(drives) => drives.closest(&rigid_forces(self.robot, instant))?.as_slice().to_vec(),
                None => {
                    let matrix = input_matrix(self.robot, &instant[0]);
                    // The determinant has a sign only if there are as many inputs as joints.
                    let now = if matrix.is_square() { matrix.determinant().signum() } else { 0.0 };
                    let turned = side * now < 0.0;
                    side = now;
                    if turned {
                        return Some("the inputs at frames pass a dead centre".into());
                    }
                    let Some(inputs) = smallest_inputs(self.robot, &matrix, instant, &ranges) else {
                        return Some("the inputs cannot produce the forces".into());
                    };
                    inputs
                }
            };
            let input = first_outside(&inputs, &ranges)?;
            let is_motor = self.drives.is_some() || self.torques.has_line(input);
            let what = if is_motor { "motor" } else { "input" };
            self.robot.input_names().into_iter().nth(input).map(|name| format!("{what} {name}"))
        })
    }

    /// Values of the inputs that the motion and the approach require, if some inputs act at frames; otherwise empty.
    pub(super) fn planned(&self, instants: &[Instant]) -> Vec<PlannedInput> {
        if self.drives.is_some() {
            return Vec::new();
        }
        let needed: Vec<Vec<f64>> = instants
            .iter()
            .filter_map(|each| {
                let ranges = self.torques.ranges(&each[1]);
                smallest_inputs(self.robot, &input_matrix(self.robot, &each[0]), each, &ranges)
            })
            .collect();
        let names = self.robot.input_names().into_iter().zip(self.robot.input_limits()).enumerate();
        let planned = names.map(|(input, (name, limits))| {
            let values = needed.iter().map(|inputs| inputs[input]);
            PlannedInput { name, range: extremes(values), limits }
        });
        planned.collect()
    }
}

/// Input matrix B of a robot whose inputs are all drives.
fn drive_matrix(robot: &dyn Robot) -> DMatrix<f64> {
    DMatrix::from_row_slice(robot.joint_names().len(), robot.input_names().len(), &robot.input_matrix())
}

/// Input matrix B(y): the joint forces of unit inputs.
pub(super) fn input_matrix(robot: &dyn Robot, y: &[f64]) -> DMatrix<f64> {
    let (joints, count) = (robot.joint_names().len(), robot.input_names().len());
    let mut matrix = DMatrix::zeros(joints, count);
    let (mut unit, mut forces) = (vec![0.0; count], vec![0.0; joints]);
    for input in 0..count {
        unit[input] = 1.0;
        robot.input_forces(y, &unit, &mut forces);
        unit[input] = 0.0;
        matrix.column_mut(input).copy_from_slice(&forces);
    }
    matrix
}

/// Narrows the limits of joints to one side of the dead centre of their cylinder. There the lever is at least
/// the share [`levels::SHORT`] of the longest lever. Returns a sentence for each of these joints.
pub(super) fn keep_sides(robot: &dyn Robot, chart: &Chart, limits: &mut [ExcitationLimits]) -> Vec<String> {
    if !robot.has_inputs_at_frames() {
        return Vec::new();
    }
    let (turns, rest) = (chart.turns(), vec![0.0; limits.len()]);
    let (joints, inputs) = (robot.joint_names(), robot.input_names());
    let middle: Vec<f64> = limits.iter().map(|limit| 0.5 * (limit.position[0] + limit.position[1])).collect();
    let mut notes = Vec::new();
    for (joint, limit) in limits.iter_mut().enumerate().filter(|(joint, _)| !turns[*joint]) {
        let [low, high] = limit.position;
        let places = (0..=PLACES).map(|k| low + (high - low) * f64::from(k) / f64::from(PLACES));
        let places: Vec<f64> = places.collect();
        let rows = places.iter().map(|place| {
            let mut coordinates = middle.clone();
            coordinates[joint] = *place;
            let [y, ..] = chart.instant(&[coordinates, rest.clone(), rest.clone()]);
            input_matrix(robot, &y).row(joint).iter().copied().collect::<Vec<f64>>()
        });
        let rows: Vec<Vec<f64>> = rows.collect();
        let mut acting = (0..inputs.len()).filter(|input| rows.iter().any(|row| row[*input] != 0.0));
        let (Some(input), None) = (acting.next(), acting.next()) else { continue };
        let levers: Vec<f64> = rows.iter().map(|row| row[input]).collect();
        if let Some([first, last]) = longest_side(&levers) {
            limit.position = [places[first], places[last]];
            notes.push(format!(
                "the input {} has a dead centre within the limits of joint {}. Therefore the plan moves this joint only from \
                 {:.2} to {:.2}",
                inputs[input], joints[joint], places[first], places[last]
            ));
        }
    }
    notes
}

/// First and last index of the longest sequence of levers with one sign and at least the smallest length; `None` if all
/// levers have one sign.
pub(super) fn longest_side(levers: &[f64]) -> Option<[usize; 2]> {
    let longest = levers.iter().fold(0.0_f64, |most, lever| most.max(lever.abs()));
    let has_both = levers.iter().any(|lever| *lever > 0.0) && levers.iter().any(|lever| *lever < 0.0);
    let side = |lever: f64| if lever.abs() < levels::SHORT.get() * longest { 0.0 } else { lever.signum() };
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (place, lever) in levers.iter().enumerate().filter(|(_, lever)| side(**lever) != 0.0) {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == place && side(levers[*last]) == side(*lever) => *last = place,
            _ => runs.push([place, place]),
        }
    }
    let found = runs.into_iter().max_by_key(|[first, last]| last - first);
    found.filter(|[first, last]| has_both && last > first)
}

/// Fails if no input moves a joint, or if the inputs do not move a joint with a quaternion in all directions. A planned
/// motion would then need forces that no input produces.
pub(super) fn require_driven(robot: &dyn Robot, states: &[Instant]) -> Result<()> {
    let matrices: Vec<DMatrix<f64>> = match robot.has_inputs_at_frames() {
        true => states.iter().map(|[y, ..]| input_matrix(robot, y)).collect(),
        false => vec![drive_matrix(robot)],
    };
    robot.quaternion_joints().iter().try_for_each(|joint| require_all_directions(joint, &matrices))?;
    let is_moved = |joint: usize| matrices.iter().any(|matrix| matrix.row(joint).iter().any(|b| *b != 0.0));
    match robot.joint_names().into_iter().enumerate().find(|(joint, _)| !is_moved(*joint)) {
        Some((_, joint)) => Err(at_joint(joint).fault(
            "no motion can be planned, because neither a drive nor an input at a frame moves this joint. Describe the force that \
             moves it by `drive`, `[[drives]]`, or `[[forces]]` with an `input`, or hold it by `held = 0` for the plan and its \
             logs",
        )),
        None => Ok(()),
    }
}

/// Fails unless the inputs move a joint with a quaternion in all its directions.
fn require_all_directions(joint: &QuaternionJoint, matrices: &[DMatrix<f64>]) -> Result<()> {
    let rows = joint.velocities();
    let directions = |matrix: &DMatrix<f64>| {
        let values = svd(matrix.rows(rows.start, rows.len()).into_owned()).singular_values;
        let least = SINGULAR * values.max();
        values.iter().filter(|value| **value > least).count()
    };
    let moved = matrices.iter().map(directions).min().unwrap_or(0);
    if moved == rows.len() {
        return Ok(());
    }
    let (kind, fixed) = match joint.is_floating {
        true => ("floating", "a base without --base floating"),
        false => ("spherical", "a joint by `type = \"fixed\"`"),
    };
    Err(at_joint(&joint.name).fault(format!(
        "no motion is planned, because the inputs move this {kind} joint in only {moved} of its {} directions. Record free \
         motions, which `gelenk identify` accepts. Or describe the inputs that hold the joint while it moves: `[[inputs]]` with \
         `frame` and `wrench`. Or clamp its bodies, describe the joint as fixed ({fixed}) for the plan and its logs, and identify \
         the other parameters from free motions",
        rows.len()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_side_of_a_dead_centre_is_kept() {
        assert_eq!(longest_side(&[0.2, 0.5, 1.0, 0.5, 0.1, -0.1, -0.5]), Some([1, 3]));
        assert_eq!(longest_side(&[0.4, -0.5, -0.6, -0.7]), Some([1, 3]));
        assert_eq!(longest_side(&[0.1, 0.5, 1.0]), None, "one side");
        assert_eq!(longest_side(&[1.0, -1.0]), None, "no side is long");
        assert_eq!(longest_side(&[]), None);
    }
}
