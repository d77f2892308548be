//! One pass over the runs: sums of products of each joint's columns, by fold, and sums of columns by piece.
//!
//! Everything that is chosen later (weights of the joints, terms, offsets, gains, the weight of the
//! description) is chosen from these sums. They do not grow with the number of samples. Forming them squares
//! the condition number; this is borne because the unknowns count from the description and the directions that
//! the squared numbers cannot resolve (singular values below 1e-7 of the largest) are held there.

use super::super::kernel::{BLOCK, add_products};
use super::super::moments::contiguous_blocks;
use super::super::run::PreparedRun;
use super::layout::Layout;
use super::rows::Rows;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A contiguous part of a run, all in one fold.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    pub(super) run: usize,
    pub(super) fold: usize,
    pub(super) rows: Range<usize>,
}

/// Sums over a piece: of the weights and of the weighted columns, for each joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PieceSums {
    pub(super) run: usize,
    pub(super) fold: usize,
    pub(super) weight: Vec<f64>,
    pub(super) columns: Vec<DVector<f64>>,
}

/// Sums of products for each fold and joint, and the pieces' sums.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    pub(super) folds: Vec<Vec<DMatrix<f64>>>,
    pub(super) pieces: Vec<PieceSums>,
    pub(super) samples: usize,
}

/// Cuts runs into contiguous pieces and deals these into folds.
///
/// Few runs are cut into one piece for each fold. Where there are more than half as many runs as folds, each run
/// is halved, and the halves of neighbouring runs go into different folds: so an offset of the run can be
/// estimated from its other half.
pub(super) fn cut(runs: &[PreparedRun], folds: usize) -> Vec<Piece> {
    let pairs = (folds / 2).max(1);
    if runs.len() > pairs {
        let halves = runs.iter().enumerate().flat_map(|(i, run)| {
            let group = i * pairs / runs.len();
            let halves = contiguous_blocks(run.times.len(), 2).enumerate();
            halves.map(move |(half, rows)| Piece { run: i, fold: 2 * group + half, rows })
        });
        return halves.collect();
    }
    let total: usize = runs.iter().map(|r| r.times.len()).sum();
    let mut pieces = Vec::new();
    let mut start = 0;
    for (i, run) in runs.iter().enumerate() {
        let end = start + run.times.len();
        for (fold, block) in contiguous_blocks(total, folds).enumerate() {
            let (from, to) = (block.start.max(start), block.end.min(end));
            if from < to {
                pieces.push(Piece { run: i, fold, rows: from - start..to - start });
            }
        }
        start = end;
    }
    pieces
}

/// Weight of each sample in a block: of run, rows, joint and the joint's columns.
pub(super) type Weights<'w> = &'w dyn Fn(usize, usize, &[&[f64]]) -> Vec<f64>;

/// The sums over all pieces, each sample of a joint times its weight.
pub(super) fn sum(
    rows: &mut Rows,
    layout: &Layout,
    runs: &[PreparedRun],
    pieces: &[Piece],
    weights: Weights,
) -> Sums {
    let folds = pieces.iter().map(|p| p.fold + 1).max().unwrap_or(0);
    let empty = |joint: usize| vec![0.0; layout.width(joint).pow(2)];
    let mut products: Vec<Vec<Vec<f64>>> = vec![(0..layout.joints).map(empty).collect(); folds];
    let mut sums = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let mut of_piece = PieceSums::empty(layout, piece);
        for start in piece.rows.clone().step_by(BLOCK) {
            rows.evaluate(&runs[piece.run], start..piece.rows.end.min(start + BLOCK));
            for joint in 0..layout.joints {
                let columns = rows.joint(joint);
                let weight = weights(piece.run, joint, &columns);
                add(&columns, &weight, &mut products[piece.fold][joint]);
                of_piece.add(joint, &columns, &weight);
            }
        }
        sums.push(of_piece);
    }
    let square = |joint: usize, sums: &[f64]| {
        let q = layout.width(joint);
        DMatrix::from_fn(q, q, |i, j| sums[i.max(j) * q + i.min(j)])
    };
    let folds = products.iter().map(|fold| fold.iter().enumerate().map(|(j, s)| square(j, s)).collect());
    Sums { folds: folds.collect(), pieces: sums, samples: runs.iter().map(|r| r.times.len()).sum() }
}

fn add(columns: &[&[f64]], weight: &[f64], sums: &mut [f64]) {
    if weight.iter().all(|w| *w == 1.0) {
        return add_products(columns, sums);
    }
    let roots: Vec<f64> = weight.iter().map(|w| w.sqrt()).collect();
    let scale = |c: &&[f64]| -> Vec<f64> { c.iter().zip(&roots).map(|(x, w)| x * w).collect() };
    let scaled: Vec<Vec<f64>> = columns.iter().map(scale).collect();
    add_products(&scaled.iter().map(Vec::as_slice).collect::<Vec<_>>(), sums);
}

impl PieceSums {
    fn empty(layout: &Layout, piece: &Piece) -> Self {
        Self {
            run: piece.run,
            fold: piece.fold,
            weight: vec![0.0; layout.joints],
            columns: (0..layout.joints).map(|j| DVector::zeros(layout.width(j))).collect(),
        }
    }

    fn add(&mut self, joint: usize, columns: &[&[f64]], weight: &[f64]) {
        self.weight[joint] += weight.iter().sum::<f64>();
        for (sum, column) in self.columns[joint].iter_mut().zip(columns) {
            *sum += column.iter().zip(weight).map(|(x, w)| x * w).sum::<f64>();
        }
    }
}

impl Sums {
    /// Products of a joint over all folds but one.
    pub(super) fn products(&self, joint: usize, without: Option<usize>) -> DMatrix<f64> {
        let q = self.folds[0][joint].nrows();
        let chosen = self.folds.iter().enumerate().filter(|(k, _)| Some(*k) != without);
        chosen.fold(DMatrix::zeros(q, q), |sum, (_, fold)| sum + &fold[joint])
    }

    /// Sums of each run over all folds but one: weight and columns.
    pub(super) fn by_run(&self, joint: usize, without: Option<usize>) -> Vec<(f64, DVector<f64>)> {
        let runs = self.pieces.iter().map(|p| p.run + 1).max().unwrap_or(0);
        let q = self.folds[0][joint].nrows();
        let mut sums = vec![(0.0, DVector::zeros(q)); runs];
        for piece in self.pieces.iter().filter(|p| Some(p.fold) != without) {
            let (weight, columns) = &mut sums[piece.run];
            *weight += piece.weight[joint];
            *columns += &piece.columns[joint];
        }
        sums
    }
}
