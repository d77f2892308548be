//! Conversion of recorded poses to displacements that can be filtered, and of inputs to forces, for robots with
//! quaternions.

use super::super::error::{Result, at};
use super::super::pose::QuaternionJoint;
use super::super::robot::Robot;
use super::super::run::{Effort, Run};
use super::joint_forces::forces_of_inputs;
use super::levels;

/// Completes a run of a robot with quaternions. The given run has the positions of the joints without a quaternion, and the
/// poses of the joints with a quaternion.
///
/// # Errors
/// [`IdentificationError::File`](crate::error::IdentificationError::File) if a quaternion is zero or far from unit length,
/// or if no known force acts on the robot in the run
pub(super) fn unrolled(read: &Run, robot: &dyn Robot, source: &str) -> Result<Run> {
    let joints = robot.quaternion_joints();
    let n = robot.joint_names().len();
    let mut read = read.clone();
    normalize(&mut read, &joints, source)?;
    let plain = super::super::pose::plain_positions(&joints, n);
    let mut run = Run {
        positions: vec![Vec::new(); n],
        velocities: vec![None; n],
        poses: vec![Vec::new(); n + joints.len()],
        ..read.clone()
    };
    let joints_read = plain.iter().enumerate().filter_map(|(joint, entry)| Some((joint, (*entry)?)));
    for (column, (joint, entry)) in joints_read.enumerate() {
        run.positions[joint].clone_from(&read.positions[column]);
        run.velocities[joint].clone_from(&read.velocities[column]);
        run.poses[entry].clone_from(&read.positions[column]);
    }
    let mut first = 0;
    for joint in &joints {
        let poses = &read.poses[first..first + joint.positions().len()];
        run.poses[joint.positions()].clone_from_slice(poses);
        run.positions[joint.velocities()].clone_from_slice(&ways(joint, poses));
        first += joint.positions().len();
    }
    run.efforts = forces(&run, read, robot);
    run.effort = Effort::Joint;
    require_some_force(&run, source)?;
    Ok(run)
}

/// Returns the sums of the displacements from sample to sample.
fn ways(joint: &QuaternionJoint, poses: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pose = |i: usize| poses.iter().map(|column| column[i]).collect::<Vec<f64>>();
    let samples = poses.first().map_or(0, Vec::len);
    let mut ways = vec![vec![0.0; samples]; joint.velocities().len()];
    for i in 1..samples {
        let way = joint.way(&pose(i - 1), &pose(i));
        ways.iter_mut().zip(way).for_each(|(column, step)| column[i] = column[i - 1] + step);
    }
    ways
}

/// Scales all quaternions to unit length. Of the two signs of each quaternion, it takes the one that is nearer to the
/// quaternion before.
fn normalize(run: &mut Run, joints: &[QuaternionJoint], source: &str) -> Result<()> {
    let mut first = 0;
    for joint in joints {
        let begin = first + joint.quaternion();
        let mut before: Option<[f64; 4]> = None;
        for i in 0..run.times.len() {
            let read: [f64; 4] = std::array::from_fn(|k| run.poses[begin + k][i]);
            let length = read.iter().map(|q| q * q).sum::<f64>().sqrt();
            require_unit(&read, length, joint, run.rows[i], source)?;
            let along = before.map_or(1.0, |b| b.iter().zip(&read).map(|(a, b)| a * b).sum::<f64>().signum());
            let unit = read.map(|q| q * along / length);
            (0..4).for_each(|k| run.poses[begin + k][i] = unit[k]);
            before = Some(unit);
        }
        first += joint.positions().len();
    }
    Ok(())
}

fn require_unit(q: &[f64; 4], length: f64, joint: &QuaternionJoint, row: usize, source: &str) -> Result<()> {
    if (length - 1.0).abs() <= levels::FARTHEST_LENGTH.get() {
        return Ok(());
    }
    let [x, y, z, w] = q;
    let why = if length == 0.0 {
        "is zero, so it is not an orientation. Remove the rows without an orientation".to_owned()
    } else {
        format!(
            "has the length {length:.4} instead of 1. The columns may be angles or other quantities. Name the right columns with \
             --columns 'xyzw=…' or 'wxyz=…'"
        )
    };
    Err(at(source)
        .row(row)
        .fault(format!("the quaternion of `{}`, x {x} y {y} z {z} w {w}, {why}", joint.name)))
}

/// Returns the forces in each row of the equations of motion: measured forces of joints without a quaternion, or forces of
/// the inputs. A force is NaN if it depends on an input that the log does not have.
fn forces(run: &Run, read: Run, robot: &dyn Robot) -> Vec<Vec<f64>> {
    if read.effort != Effort::Joint {
        return forces_of_inputs(&run.poses, &read.efforts, robot);
    }
    let n = run.positions.len();
    let mut forces = vec![vec![0.0; run.times.len()]; n];
    let rows = super::super::pose::rows_of(&robot.quaternion_joints(), n);
    let plain = forces.iter_mut().zip(rows).filter(|(_, has_quaternion)| !has_quaternion);
    plain.zip(read.efforts).for_each(|((force, _), effort)| *force = effort);
    forces
}

/// Fails if no force acts. Without a force, the equations determine only ratios of the parameters, and a robot without mass
/// would fulfil them exactly.
fn require_some_force(run: &Run, source: &str) -> Result<()> {
    if run.efforts.iter().flatten().any(|force| force.is_finite() && *force != 0.0) {
        return Ok(());
    }
    Err(at(source).fault(
        "the log has no force that acts on the robot. Without a force, only ratios of masses and inertias can be determined. \
         Record the inputs or the torques of the joints. Or describe the forces on the base as `[[inputs]]` with `frame` and \
         `wrench`, and add them to the log",
    ))
}
