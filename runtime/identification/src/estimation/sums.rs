//! Sums of products of each joint's columns (regressor and force) for each fold, and sums of columns for each piece, in one
//! pass over the runs.
//!
//! All choices (weights of the joints, terms, offsets, gains, the weight of the description) are made from these sums. The
//! size of the sums does not depend on the number of samples. Products square the condition number. This is accepted because
//! the unknowns are differences from the description. The squared numbers cannot resolve directions with singular values below
//! 1e-7 of the largest singular value. The description determines these directions.

use super::super::methods::moments::contiguous_blocks;
use super::super::numeric::kernel::{BLOCK, add_products};
use super::super::run::PreparedRun;
use super::layout::Layout;
use super::levels;
use super::rows::Rows;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A contiguous part of a run. All samples of a piece are in one fold.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    pub(crate) run: usize,
    pub(crate) fold: usize,
    pub(crate) rows: Range<usize>,
}

/// Sums over a piece of a run for each joint: the sum of the weights, and the sums of the weighted columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PieceSums {
    pub(super) run: usize,
    pub(super) fold: usize,
    pub(super) weight: Vec<f64>,
    pub(super) columns: Vec<DVector<f64>>,
}

/// Sums of products of the columns for each fold and joint, and sums of the columns for each piece of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    pub(super) folds: Vec<Vec<DMatrix<f64>>>,
    pub(super) pieces: Vec<PieceSums>,
    pub(super) samples: usize,
    /// Sums of products without samples near stops, from which gains are estimated. `None` if no gain is
    /// estimated.
    pub(super) away: Option<Box<Sums>>,
}

/// Cuts runs into contiguous pieces and assigns the pieces to folds.
///
/// If there are at most half as many runs as folds, each fold is one contiguous part of all samples. If there
/// are more runs, each run is halved, and the halves are in different folds. The offset of the run can then
/// be estimated from the other half. Runs that repeat a motion are in the same folds. Otherwise the fit would
/// know the motion of the held-out run, and the error would not measure the prediction of other motions.
pub(super) fn cut(runs: &[PreparedRun], folds: usize) -> Vec<Piece> {
    let pairs = (folds / 2).max(1);
    if runs.len() > pairs {
        let (motions, count) = motions(runs);
        let halves = runs.iter().enumerate().flat_map(|(i, run)| {
            let group =
                if count < 2 { i * pairs / runs.len() } else { motions[i] * pairs.min(count) / count };
            let halves = parts(std::slice::from_ref(run), 2).into_iter();
            halves.map(move |(_, half, rows)| Piece { run: i, fold: 2 * group + half, rows })
        });
        return halves.collect();
    }
    parts(runs, folds).into_iter().map(|(run, fold, rows)| Piece { run, fold, rows }).collect()
}

/// Cuts the sequence of all runs into contiguous parts with equal numbers of samples in motion. Each entry of the result has
/// the index of the run, the index of the part, and the rows of the run.
fn parts(runs: &[PreparedRun], count: usize) -> Vec<(usize, usize, Range<usize>)> {
    let moving = |run: &PreparedRun| run.count_moving(0..run.times.len());
    let blocks: Vec<Range<usize>> = contiguous_blocks(runs.iter().map(moving).sum(), count).collect();
    let mut parts: Vec<(usize, usize, Range<usize>)> = Vec::new();
    let mut before = 0;
    for (number, run) in runs.iter().enumerate() {
        for i in 0..run.times.len() {
            let part = blocks.partition_point(|block| block.end <= before).min(count.saturating_sub(1));
            match parts.last_mut() {
                Some((last, same, rows)) if *last == number && *same == part => rows.end = i + 1,
                _ => parts.push((number, part, i..i + 1)),
            }
            before += usize::from(run.is_moving(i));
        }
    }
    parts
}

/// Index of the motion of each run, in the order of the motions' first runs, and the number of motions.
fn motions(runs: &[PreparedRun]) -> (Vec<usize>, usize) {
    let mut first: Vec<usize> = Vec::new();
    let of_run = |run: usize| {
        let known = first.iter().position(|other| is_repeat(&runs[*other], &runs[run]));
        known.unwrap_or_else(|| {
            first.push(run);
            first.len() - 1
        })
    };
    let numbers = (0..runs.len()).map(of_run).collect();
    (numbers, first.len())
}

/// Smallest number of distinct motions for which the folds are whole motions.
pub(crate) const FEWEST_MOTIONS: usize = 3;

/// Index of the motion of each run; `None` if no motion is repeated or if there are fewer than [`FEWEST_MOTIONS`].
pub(crate) fn repeated_motions(runs: &[PreparedRun]) -> Option<Vec<usize>> {
    let (numbers, count) = motions(runs);
    (count >= FEWEST_MOTIONS && count < runs.len()).then_some(numbers)
}

/// Whether two runs have about the same positions at the same times.
fn is_repeat(one: &PreparedRun, other: &PreparedRun) -> bool {
    let counts = [one.times.len(), other.times.len()];
    let (fewest, most) = (counts[0].min(counts[1]), counts[0].max(counts[1]));
    if (fewest as f64) < levels::COVERED.get() * most as f64 {
        return false;
    }
    let (mut apart, mut way) = (0.0, 0.0);
    for (a, b) in one.positions.iter().zip(&other.positions) {
        for i in 0..fewest {
            apart += (a[i] - b[i]).powi(2);
            way += (a[i] - a[0]).powi(2);
        }
    }
    apart <= levels::ALIKE_MOTIONS.get() * way
}

/// Weight of each sample in a block. The arguments are the indices of the run and of the joint, the joint's columns, and
/// [`Rows::moving`].
pub(super) type Weights<'w> = &'w dyn Fn(usize, usize, &[&[f64]], &[f64]) -> Vec<f64>;

/// Weight one for the samples in which the joint moves, otherwise zero.
pub(super) fn moving(_run: usize, _joint: usize, _columns: &[&[f64]], moving: &[f64]) -> Vec<f64> {
    moving.to_vec()
}

/// Weight one for the samples in which the joint rests, otherwise zero.
pub(super) fn resting(_run: usize, _joint: usize, _columns: &[&[f64]], moving: &[f64]) -> Vec<f64> {
    moving.iter().map(|moves| 1.0 - moves).collect()
}

/// The sums over all pieces. Each sample of a joint is multiplied by its weight.
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
            rows.evaluate((piece.run, &runs[piece.run]), start..piece.rows.end.min(start + BLOCK));
            for joint in 0..layout.joints {
                let columns = rows.joint(joint);
                let weight = weights(piece.run, joint, &columns, rows.moving(joint));
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
    Sums {
        folds: folds.collect(),
        pieces: sums,
        samples: runs.iter().map(|r| r.times.len()).sum(),
        away: None,
    }
}

fn add(columns: &[&[f64]], weight: &[f64], sums: &mut [f64]) {
    if weight.iter().all(|w| *w == 0.0) {
        return;
    }
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
    /// The sum of `self` and `other` over the same pieces.
    pub(super) fn with(&self, other: &Self) -> Self {
        let mut sum = Self { away: None, ..self.clone() };
        for (fold, other) in sum.folds.iter_mut().zip(&other.folds) {
            fold.iter_mut().zip(other).for_each(|(a, b)| *a += b);
        }
        for (piece, other) in sum.pieces.iter_mut().zip(&other.pieces) {
            piece.weight.iter_mut().zip(&other.weight).for_each(|(a, b)| *a += b);
            piece.columns.iter_mut().zip(&other.columns).for_each(|(a, b)| *a += b);
        }
        sum
    }

    /// Sums of products of a joint's columns over all folds, or over all folds except `without`.
    pub(super) fn products(&self, joint: usize, without: Option<usize>) -> DMatrix<f64> {
        let q = self.folds[0][joint].nrows();
        let chosen = self.folds.iter().enumerate().filter(|(k, _)| Some(*k) != without);
        chosen.fold(DMatrix::zeros(q, q), |sum, (_, fold)| sum + &fold[joint])
    }

    /// Weight and sums of columns of each run, over all folds except `without`.
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

#[cfg(test)]
mod tests {
    use super::super::super::run::Effort;
    use super::*;

    /// A run along a sine, a little off the motion.
    fn run(frequency: f64, off: f64) -> PreparedRun {
        let times: Vec<f64> = (0..200).map(|i| 0.01 * f64::from(i)).collect();
        let positions: Vec<f64> = times.iter().map(|t| (frequency * t + off).sin()).collect();
        PreparedRun {
            poses: Vec::new(),
            resting: Vec::new(),
            name: "run".into(),
            rows: (2..202).collect(),
            positions: vec![positions],
            velocities: vec![vec![0.0; 200]],
            accelerations: vec![vec![0.0; 200]],
            efforts: vec![vec![0.0; 200]],
            effort: Effort::Joint,
            times,
        }
    }

    #[test]
    fn runs_that_repeat_a_motion_share_their_folds() {
        let runs: Vec<PreparedRun> = [(1.0, 0.0), (2.0, 0.0), (1.0, 0.01), (3.0, 0.0), (2.0, 0.01)]
            .map(|(f, off)| run(f, off))
            .to_vec();
        let pieces = cut(&runs, 8);
        let folds = |run: usize| pieces.iter().filter(|p| p.run == run).map(|p| p.fold).collect::<Vec<_>>();
        assert_eq!([0, 1, 2, 3, 4].map(folds), [[0, 1], [2, 3], [0, 1], [4, 5], [2, 3]]);
        // If all runs have the same motion, or all have different ones, neighbours share folds.
        let same = vec![run(1.0, 0.0); 6];
        assert_eq!(
            cut(&same, 4).iter().map(|p| p.fold).collect::<Vec<_>>(),
            [0, 1, 0, 1, 0, 1, 2, 3, 2, 3, 2, 3]
        );
        let other: Vec<PreparedRun> = (1..=6).map(|k| run(f64::from(k), 0.0)).collect();
        assert_eq!(cut(&other, 4), cut(&same, 4));
    }

    #[test]
    fn motions_are_numbered_where_some_of_several_are_repeated() {
        let of = |frequencies: &[f64]| {
            repeated_motions(&frequencies.iter().map(|f| run(*f, 0.0)).collect::<Vec<_>>())
        };
        assert_eq!(of(&[1.0, 2.0, 1.0, 3.0, 2.0]), Some(vec![0, 1, 0, 2, 1]));
        assert_eq!(of(&[1.0, 2.0, 3.0]), None);
        assert_eq!(of(&[1.0, 2.0, 1.0, 2.0]), None);
    }
}
