//! Products of matrices whose entries are vectors: one lane of them is a matrix of numbers.

use crate::qp::lanes::{Vector, vectorized};

/// N rows of B blocks with C columns.
pub(super) type Blocks<V, const N: usize, const B: usize, const C: usize> = [[[V; C]; B]; N];

/// The upper or lower half of a matrix over the state (y, ẏ): row by row its left and its right block.
pub(super) type Half<V, const N: usize> = Blocks<V, N, 2, N>;

/// First term of a sum.
#[derive(Clone, Copy)]
pub(super) enum Start<'a, V, const N: usize, const B: usize, const C: usize> {
    Zero,
    Scaled(f64, &'a Blocks<V, N, B, C>),
    /// The blocks moved to the right by one, behind a block of zeros.
    Shifted(&'a Blocks<V, N, B, C>),
}

/// The arguments of [`sum`].
///
/// A slice keeps the compiler from loading all entries before the first product, for which it has no registers.
#[derive(Clone, Copy)]
struct Sum<'a, V, const N: usize, const B: usize, const C: usize> {
    start: Start<'a, V, N, B, C>,
    half: &'a Half<V, N>,
    by: &'a [(usize, &'a Blocks<V, N, B, C>)],
}

/// `result = start + Σ H_b X`: the blocks `H_b` of a half with the numbers b, and what each is multiplied by.
#[inline(always)]
pub(super) fn sum<V: Vector, const N: usize, const B: usize, const C: usize>(
    result: &mut Blocks<V, N, B, C>,
    start: Start<'_, V, N, B, C>,
    half: &Half<V, N>,
    by: &[(usize, &Blocks<V, N, B, C>)],
) {
    let sum = Sum { start, half, by };
    vectorized!(V, { by_tiles(result, &sum) });
}

/// Sums by tiles of up to three rows and four columns, whose sums stay in sixteen registers.
#[inline(always)]
fn by_tiles<V: Vector, const N: usize, const B: usize, const C: usize>(
    result: &mut Blocks<V, N, B, C>,
    sum: &Sum<'_, V, N, B, C>,
) {
    for block in 0..B {
        for i in (0..N).step_by(3) {
            match N - i {
                1 => rows::<V, N, B, C, 1>(result, sum, [i, block]),
                2 => rows::<V, N, B, C, 2>(result, sum, [i, block]),
                _ => rows::<V, N, B, C, 3>(result, sum, [i, block]),
            }
        }
    }
}

/// R rows of a block, from row i on.
#[inline(always)]
fn rows<V: Vector, const N: usize, const B: usize, const C: usize, const R: usize>(
    result: &mut Blocks<V, N, B, C>,
    sum: &Sum<'_, V, N, B, C>,
    [i, block]: [usize; 2],
) {
    let mut j = 0;
    while j < C {
        let at = [i, block, j];
        j += match C - j {
            1 => tile::<V, N, B, C, R, 1>(result, sum, at),
            2 => tile::<V, N, B, C, R, 2>(result, sum, at),
            4 => tile::<V, N, B, C, R, 4>(result, sum, at),
            _ => tile::<V, N, B, C, R, 3>(result, sum, at),
        };
    }
}

/// R rows and T columns; how many columns.
#[inline(always)]
fn tile<V: Vector, const N: usize, const B: usize, const C: usize, const R: usize, const T: usize>(
    result: &mut Blocks<V, N, B, C>,
    Sum { start, half, by }: &Sum<'_, V, N, B, C>,
    [i, block, j]: [usize; 3],
) -> usize {
    let mut sums = [[V::zero(); T]; R];
    for r in 0..R {
        for c in 0..T {
            sums[r][c] = match start {
                Start::Scaled(factor, start) => V::splat(*factor) * start[i + r][block][j + c],
                Start::Shifted(start) if block > 0 => start[i + r][block - 1][j + c],
                _ => V::zero(),
            };
        }
    }
    for (of, by) in *by {
        for k in 0..N {
            for c in 0..T {
                for r in 0..R {
                    sums[r][c] = half[i + r][*of][k].mul_add(by[k][block][j + c], sums[r][c]);
                }
            }
        }
    }
    for r in 0..R {
        for c in 0..T {
            result[i + r][block][j + c] = sums[r][c];
        }
    }
    T
}
