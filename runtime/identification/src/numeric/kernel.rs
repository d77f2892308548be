//! Sums of products over blocks of samples.
//!
//! The loop is compiled for AVX-512, AVX2 and the base target, and the version is chosen at run time. All versions have
//! eight partial sums ("lanes") in the same order and fused multiply-adds, so their results have the same bits. A processor
//! without fused multiply-adds (x86-64 before 2013) computes them in software, correctly but slowly.

use multiversion::multiversion;
use multiversion::target::match_target;
use nalgebra::DVectorView;
use std::ops::Range;

/// Samples per block. Eight columns of a block fit into the first-level cache.
pub(crate) const BLOCK: usize = 256;

const LANES: usize = 8;

/// Adds the products of all pairs of columns over one block: `sums[j·q + k] += Σ aⱼ aₖ` for k ≤ j.
///
/// Columns are processed in tiles of `ROWS` by four columns, so that the partial sums of each product stay in registers.
/// Two rows fit into the 32 registers of AVX-512, one row fits into the 16 registers of AVX2. The tile size does not change
/// the order in which a product's terms are added.
///
/// - `columns`: q slices of the same length, at most [`BLOCK`]
/// - `sums`: q × q, row by row, lower triangle
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(crate) fn add_products(columns: &[&[f64]], sums: &mut [f64]) {
    match_target! {
        "x86_64+avx512f+avx512dq+avx512vl" => add_tiles::<2>(columns, sums),
        _ => add_tiles::<1>(columns, sums),
    }
}

/// Scalar product `Σ aᵢ bᵢ` of two slices of the same length, in eight partial sums.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    DVectorView::from_slice(a, a.len()).dot(&DVectorView::from_slice(b, b.len()))
}

#[inline(always)]
fn add_tiles<const ROWS: usize>(columns: &[&[f64]], sums: &mut [f64]) {
    let q = columns.len();
    for j in (0..q).step_by(ROWS) {
        let last = (j + ROWS).min(q) - 1;
        for k in (0..=last).step_by(4) {
            // Missing columns of a tile repeat the last column. Results above the diagonal are dropped.
            let products = tile::<ROWS>(
                std::array::from_fn(|i| columns[(j + i).min(last)]),
                std::array::from_fn(|i| columns[(k + i).min(last)]),
            );
            for (row, products) in (j..=last).zip(products) {
                for (column, product) in (k..=row).zip(products) {
                    sums[row * q + column] += product;
                }
            }
        }
    }
}

#[inline(always)]
fn tile<const ROWS: usize>(a: [&[f64]; ROWS], b: [&[f64]; 4]) -> [[f64; 4]; ROWS] {
    let n = a[0].len();
    let count = n / LANES;
    let [b0, b1, b2, b3] = b.map(|b| &b[..n].as_chunks::<LANES>().0[..count]);
    let rows = a.map(|a| &a[..n].as_chunks::<LANES>().0[..count]);
    let mut lanes = [[[0.0; LANES]; 4]; ROWS];
    for i in 0..count {
        let b = [b0[i], b1[i], b2[i], b3[i]];
        // The loop runs over indices, because LLVM keeps the sums in memory if the loop runs over iterators.
        for r in 0..ROWS {
            let row = rows[r][i];
            for c in 0..4 {
                add_product(&mut lanes[r][c], row, b[c]);
            }
        }
    }
    let mut sums = std::array::from_fn(|r| horizontal_sums(&lanes[r]));
    if count * LANES < n {
        add_rest(a, b, count * LANES..n, &mut sums);
    }
    sums
}

/// Adds the samples after the last full group of eight. Only the last block of a log has such samples.
#[inline(never)]
fn add_rest<const ROWS: usize>(
    a: [&[f64]; ROWS],
    b: [&[f64]; 4],
    rest: Range<usize>,
    sums: &mut [[f64; 4]; ROWS],
) {
    for (a, sums) in a.iter().zip(sums) {
        for (b, sum) in b.iter().zip(sums) {
            for i in rest.clone() {
                *sum += a[i] * b[i];
            }
        }
    }
}

/// Returns the sum of the lanes of each of four products. The function must not be inlined. Otherwise its
/// order of additions makes LLVM combine lanes of different products in the loop of `tile`.
#[inline(never)]
fn horizontal_sums(lanes: &[[f64; LANES]; 4]) -> [f64; 4] {
    lanes.map(|[p, q, r, s, t, u, v, x]| ((p + q) + (r + s)) + ((t + u) + (v + x)))
}

#[inline(always)]
fn add_product(sum: &mut [f64; LANES], a: [f64; LANES], b: [f64; LANES]) {
    for l in 0..LANES {
        sum[l] = a[l].mul_add(b[l], sum[l]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_whole_numbers_are_exact() {
        for n in [0, 1, 31, 32, 33, 100] {
            let a: Vec<f64> = (0..n).map(f64::from).collect();
            assert_eq!(dot(&a, &a), f64::from(n * (n - 1) * (2 * n - 1) / 6));
        }
        let a: Vec<f64> = (0..251).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|a| 3.0 - a).collect();
        let mut sums = [0.0; 36];
        add_products(&[&a, &b, &a, &b, &a, &b], &mut sums);
        let (aa, ab): (f64, f64) =
            (a.iter().map(|a| a * a).sum(), a.iter().zip(&b).map(|(a, b)| a * b).sum());
        assert_eq!([sums[0], sums[6], sums[24], sums[30]], [aa, ab, aa, ab]);
        for q in 1..=9 {
            let columns: Vec<Vec<f64>> =
                (0..q).map(|j| a.iter().map(|a| a % f64::from(j + 2)).collect()).collect();
            let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let q = q as usize;
            let mut sums = vec![0.0; q * q];
            add_products(&slices, &mut sums);
            for j in 0..q {
                for k in 0..q {
                    let exact: f64 = slices[j].iter().zip(slices[k]).map(|(a, b)| a * b).sum();
                    let expected = if k <= j { exact } else { 0.0 };
                    assert_eq!(sums[j * q + k], expected, "{q} columns: {j}, {k}");
                }
            }
        }
    }
}
