//! Products of matrices whose entries are vectors. The numbers with the same index in all vectors (one lane) form one
//! matrix.

use crate::qp::lanes::{Vector, vectorized};

/// N rows of B blocks with C columns.
pub(super) type Blocks<V, const N: usize, const B: usize, const C: usize> = [[[V; C]; B]; N];

/// Upper or lower half of a matrix that acts on the state (y, ẏ). Each row has a left and a right block.
pub(super) type Half<V, const N: usize> = Blocks<V, N, 2, N>;

/// All entries of a matrix of blocks, row by row, as a mutable slice.
#[inline(always)]
pub(super) fn entries_mut<T, const N: usize, const B: usize, const C: usize>(
    blocks: &mut [[[T; C]; B]; N],
) -> &mut [T] {
    blocks.as_flattened_mut().as_flattened_mut()
}

/// All entries of a matrix of blocks, row by row, as a slice.
#[inline(always)]
pub(super) fn entries<T, const N: usize, const B: usize, const C: usize>(blocks: &[[[T; C]; B]; N]) -> &[T] {
    blocks.as_flattened().as_flattened()
}

/// First term of a sum.
#[derive(Clone, Copy)]
pub(super) enum Start<'a, V, const N: usize, const B: usize, const C: usize> {
    Zero,
    Scaled(f64, &'a Blocks<V, N, B, C>),
    /// The blocks shifted to the right by one, after a block of zeros.
    Shifted(&'a Blocks<V, N, B, C>),
}

/// Arguments of [`sum`].
///
/// `by` is a slice so that the compiler does not load all entries before the first product. The registers would not
/// suffice for all entries.
#[derive(Clone, Copy)]
struct Sum<'a, V, const N: usize, const B: usize, const C: usize> {
    start: Start<'a, V, N, B, C>,
    half: &'a Half<V, N>,
    by: &'a [(usize, &'a Blocks<V, N, B, C>)],
}

/// Computes `result = start + Σ H_b X_b`. `by` contains the index b of each block `H_b` of the half, and its
/// factor `X_b`.
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

/// Computes the sums in tiles of up to three rows and four columns. The sums of a tile fit in sixteen registers.
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

/// Computes R rows of a block, from row i on.
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

/// Computes a tile of R rows and T columns. Returns the number of columns.
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
