//! Sums of products of the equations of motion over blocks of time, for estimates without the common fit.

use super::super::error::Result;
use super::super::numeric::statistics::largest;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::layout::{COULOMB, Layout, VISCOUS};
use super::result::Gravity;
use super::rows::Rows;
use super::sums::{Piece, Sums, sum};
use nalgebra::{DMatrix, DVector};

/// Number of columns of a joint's offset and friction: a constant, viscous friction, and smoothed Coulomb friction of several
/// widths.
pub(crate) const FRICTION: usize = 1 + COULOMB.end;

/// Sums over one block for one joint.
pub(crate) struct BlockSums {
    /// Products of the columns `[inertial parameters | constant and friction | described rigid force | measured force]`.
    pub(crate) products: DMatrix<f64>,
    /// Number of samples.
    pub(crate) samples: f64,
}

/// Returns the sums of each block and joint, `[block][joint]`. Samples in which a joint rests are left out. A joint with a
/// quaternion never rests.
///
/// - `pieces`: parts of the runs. Parts with the same fold are one block.
/// - `slow`: share of a joint's largest speed below which the joint counts as resting
///
/// # Errors
/// The errors are those of [`super::estimate`] about runs and robots.
pub(crate) fn sums_of_blocks(
    robot: &dyn Robot,
    runs: &[PreparedRun],
    pieces: &[Piece],
    slow: f64,
) -> Result<Vec<Vec<BlockSums>>> {
    let layout = Layout::new(robot, runs, None, false)?;
    let fastest = |joint: usize| largest(runs.iter().flat_map(|run| &run.velocities[joint]));
    let limits: Vec<f64> = (0..layout.joints).map(|joint| slow * fastest(joint)).collect();
    let weights = |_: usize, joint: usize, columns: &[&[f64]], moving: &[f64]| -> Vec<f64> {
        let speeds = columns[layout.first_term(joint) + VISCOUS].iter().zip(moving);
        let weight = |(v, moves): (&f64, &f64)| match layout.exact[joint] {
            true => f64::from(layout.measured[joint]),
            false if layout.moves[joint] && v.abs() > limits[joint] => *moves,
            false => 0.0,
        };
        speeds.map(weight).collect()
    };
    let mut rows = Rows::new(robot, &layout, Gravity::Recorded, None, None);
    let sums = sum(&mut rows, &layout, runs, pieces, &weights);
    let of_block =
        |block| (0..layout.joints).map(|joint| BlockSums::new(&layout, &sums, block, joint)).collect();
    Ok((0..sums.folds.len()).map(of_block).collect())
}

impl BlockSums {
    fn new(layout: &Layout, sums: &Sums, block: usize, joint: usize) -> Self {
        let (first, width) = (layout.first_term(joint), layout.width(joint));
        let (mut samples, mut columns) = (0.0, DVector::zeros(width));
        for piece in sums.pieces.iter().filter(|piece| piece.fold == block) {
            samples += piece.weight[joint];
            columns += &piece.columns[joint];
        }
        let mut products = sums.folds[block][joint].clone().resize(width + 1, width + 1, 0.0);
        products.view_mut((0, width), (width, 1)).copy_from(&columns);
        products.view_mut((width, 0), (1, width)).copy_from(&columns.transpose());
        products[(width, width)] = samples;
        let constant = layout.parameters;
        let mut map = DMatrix::zeros(width + 1, constant + FRICTION + 2);
        layout.local[joint][..first].iter().enumerate().for_each(|(k, &global)| map[(k, global)] = 1.0);
        map[(width, constant)] = 1.0;
        (VISCOUS..COULOMB.end).for_each(|term| map[(first + term, constant + 1 + term)] = 1.0);
        (0..2).for_each(|k| map[(width - 2 + k, constant + FRICTION + k)] = 1.0);
        Self { products: map.tr_mul(&(products * &map)), samples }
    }
}
