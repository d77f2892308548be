//! The rows of a robot with shafts, and signals along them.

use super::super::robot::{Instant, Robot};
use super::super::run::{Effort, PreparedRun};
use super::{JointTerm, Shaft};
use nalgebra::DMatrix;

/// Share of a row's largest entry below which an entry of the matrix from rows to joints counts as a rounding
/// error of zero.
const ROUNDING: f64 = 1e-12;

/// The rows of the equations of motion if shafts replace joints, in the coordinates `z = C y` with the joint positions y.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShaftRows {
    shafts: Vec<Shaft>,
    terms: Vec<JointTerm>,
    /// Matrix C of the coordinates `z = C y`, from joint positions y to positions z of the rows.
    motion: DMatrix<f64>,
    /// Inverse of the matrix C of `z = C y`, from positions z of the rows to joint positions y.
    back: DMatrix<f64>,
    has_quaternions: bool,
    /// Number of the robot's inertial parameters. The factors of the joints' friction terms follow them.
    parameters: usize,
}

impl ShaftRows {
    /// The rows of a robot; `None` if no shaft replaces a joint.
    pub(crate) fn of(robot: &dyn Robot) -> Option<Self> {
        let shafts = robot.shafts();
        let joints = robot.joint_names().len();
        let mut motion = DMatrix::identity(joints, joints);
        for shaft in &shafts {
            shaft.ratios.iter().enumerate().for_each(|(joint, ratio)| motion[(shaft.joint, joint)] = *ratio);
        }
        let mut back = motion.clone().try_inverse().filter(|_| !shafts.is_empty())?;
        for mut row in back.row_iter_mut() {
            let largest = row.amax();
            row.iter_mut().filter(|x| x.abs() < ROUNDING * largest).for_each(|x| *x = 0.0);
        }
        Some(Self {
            shafts,
            terms: robot.joint_terms(),
            motion,
            back,
            has_quaternions: !robot.quaternion_joints().is_empty(),
            parameters: robot.parameters().len(),
        })
    }

    /// The shafts that replace joints.
    pub(crate) fn shafts(&self) -> &[Shaft] {
        &self.shafts
    }

    /// The shaft that has this row; `None` if the row is that of a joint.
    pub(crate) fn shaft(&self, row: usize) -> Option<&Shaft> {
        self.shafts.iter().find(|shaft| shaft.joint == row)
    }

    /// Largest ratio of the speed of a row to the speed of a joint that turns its shaft; 1 for the row of a joint.
    pub(crate) fn speed_scale(&self, row: usize) -> f64 {
        let largest = |ratios: &[f64]| ratios.iter().fold(0.0_f64, |largest, ratio| largest.max(ratio.abs()));
        self.shaft(row).map_or(1.0, |shaft| largest(&shaft.ratios))
    }

    /// Described friction terms of replaced joints. The factors of these terms follow the inertial parameters of the estimate.
    pub(crate) fn joint_terms(&self) -> &[JointTerm] {
        &self.terms
    }

    /// Index of the factor of the first term of [`Self::joint_terms`] among the parameters of the estimate.
    pub(crate) fn first_term(&self) -> usize {
        self.parameters
    }

    /// A run with the signals of the rows, computed from a run with the signals of the joints.
    pub(crate) fn along(&self, run: PreparedRun) -> PreparedRun {
        let moved = |columns: &[Vec<f64>]| combined(&self.motion, columns);
        let efforts = match run.effort {
            Effort::Joint => combined(&self.back.transpose(), &run.efforts),
            Effort::Input | Effort::Current => run.efforts.clone(),
        };
        PreparedRun {
            positions: moved(&run.positions),
            velocities: moved(&run.velocities),
            accelerations: moved(&run.accelerations),
            efforts,
            resting: self.resting(&run.resting),
            ..run
        }
    }

    /// For each row and sample, whether the row rests. A shaft rests if all joints that turn it rest.
    fn resting(&self, joints: &[Vec<bool>]) -> Vec<Vec<bool>> {
        let row = |row: usize| {
            let turning = self.motion.row(row).into_iter().zip(joints).filter(|(ratio, _)| **ratio != 0.0);
            let all = turning.map(|(_, rests)| rests.clone());
            all.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| *a && *b).collect()).unwrap_or_default()
        };
        if joints.is_empty() { Vec::new() } else { (0..self.motion.nrows()).map(row).collect() }
    }

    /// Positions of the rows and their derivatives, from those of the joints.
    pub(super) fn instant(&self, [y, v, a]: &Instant) -> Instant {
        let row = |x: &[f64], row: usize| self.motion.row(row).iter().zip(x).map(|(c, x)| c * x).sum();
        let moved = |x: &[f64]| (0..self.motion.nrows()).map(|i| row(x, i)).collect();
        [if self.has_quaternions { y.clone() } else { moved(y) }, moved(v), moved(a)]
    }

    /// Largest speeds of the rows, from the largest speeds of the joints.
    pub(super) fn speeds(&self, joints: &[f64]) -> Vec<f64> {
        let row = |row: usize| {
            let turning = self.motion.row(row).into_iter().zip(joints).filter(|(ratio, _)| **ratio != 0.0);
            turning.map(|(ratio, speed)| ratio.abs() * speed).sum()
        };
        (0..self.motion.nrows()).map(row).collect()
    }

    /// Positions y of the joints from positions z of the rows. Positions of robots with quaternions are returned unchanged,
    /// because they cannot be added.
    pub(super) fn positions(&self, z: &[f64]) -> Vec<f64> {
        if self.has_quaternions { z.to_vec() } else { self.joint_motion(z) }
    }

    /// Velocities ẏ of the joints from velocities ż of the rows, or accelerations ÿ from z̈.
    pub(super) fn joint_motion(&self, z: &[f64]) -> Vec<f64> {
        let row = |row: usize| self.back.row(row).iter().zip(z).map(|(factor, z)| factor * z).sum();
        (0..self.back.nrows()).map(row).collect()
    }

    /// Generalized forces of the rows: C⁻ᵀ times forces at the joints, with the matrix C of the rows'
    /// positions `z = C y`. The forces are a matrix with `columns` columns, row by row.
    pub(super) fn forces(&self, joints: &[f64], columns: usize, rows: &mut [f64]) {
        rows.fill(0.0);
        for (row, found) in rows.chunks_exact_mut(columns.max(1)).enumerate() {
            for (joint, values) in joints.chunks_exact(columns.max(1)).enumerate() {
                let factor = self.back[(joint, row)];
                if factor != 0.0 {
                    found.iter_mut().zip(values).for_each(|(sum, x)| *sum += factor * x);
                }
            }
        }
    }
}

/// The product of a matrix and columns of samples. Columns with the factor 0 are skipped, because they may contain NaN.
fn combined(matrix: &DMatrix<f64>, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let samples = columns.first().map_or(0, Vec::len);
    let row = |row: usize| {
        let mut sum = vec![0.0; samples];
        for (factor, column) in matrix.row(row).iter().zip(columns).filter(|(factor, _)| **factor != 0.0) {
            sum.iter_mut().zip(column).for_each(|(sum, x)| *sum += factor * x);
        }
        sum
    };
    (0..matrix.nrows()).map(row).collect()
}
