//! Inner loops over blocks of samples: elementary functions and sums of products.
//!
//! Each loop is compiled for AVX-512, AVX2 and the base target and chosen at run time. Sums run in eight
//! fixed lanes, and where a product is fused with a sum it is so in all versions, so they give the same bits.
//! A processor without fused multiply-adds (x86-64 before 2013) computes them in software, correctly and
//! slowly.

use multiversion::multiversion;
use multiversion::target::match_target;
use std::ops::Range;

/// Samples per block: eight columns of a block stay in the first-level cache.
pub(crate) const BLOCK: usize = 256;

const LANES: usize = 8;
/// 1.5·2⁵²: adding and subtracting it rounds to an integer, and leaves that integer in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
const LN2_HIGH: f64 = 0.693_147_180_136_293_2;
const LN2_LOW: f64 = 4.236_521_365_809_284e-10;

/// Reciprocals of 2!, 3! … 14!: the Taylor series of eʳ − 1 − r on |r| ≤ ln 2 / 2 (remainder below 1e-19).
const EXP_SERIES: [f64; 13] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
    1.0 / 87_178_291_200.0,
];

/// `x = k ln 2 + r`: returns `eʳ − 1` and `2ᵏ`, for −708 ≤ x ≤ 709 (arguments beyond are clamped).
#[inline(always)]
fn reduced_exponential(x: f64) -> (f64, f64) {
    let x = if x < -708.0 { -708.0 } else { x };
    let x = if x > 709.0 { 709.0 } else { x };
    let k = x.mul_add(std::f64::consts::LOG2_E, ROUND) - ROUND;
    let r = (-k).mul_add(LN2_LOW, (-k).mul_add(LN2_HIGH, x));
    let mut s = EXP_SERIES[12];
    for i in (0..12).rev() {
        s = s.mul_add(r, EXP_SERIES[i]);
    }
    let scale = f64::from_bits((k + (ROUND + 1023.0)).to_bits() << 52);
    ((r * r).mul_add(s, r), scale)
}

/// eˣ for x ≤ 709, clamped beyond; 0 below −708.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let (p, scale) = reduced_exponential(x);
    if x < -708.0 { 0.0 } else { scale.mul_add(p, scale) }
}

/// tanh x from expm1(−2|x|), accurate to a few units in the last place also near zero.
#[inline(always)]
pub(crate) fn tanh(x: f64) -> f64 {
    let (p, scale) = reduced_exponential(-2.0 * x.abs());
    let e = scale.mul_add(p, scale - 1.0);
    (-e / (2.0 + e)).copysign(x)
}

/// π in three parts, the first two with 31 bits: multiples below 2²¹ are exact.
const PI_PARTS: [f64; 3] = [3.141_592_653_468_251_2, 1.215_420_100_718_692e-10, 5.825_464_112_186_712e-20];
/// Beyond this magnitude the three-part reduction loses bits and the standard library is used.
const LARGEST_REDUCED: f64 = 1.0e6;

/// Reciprocals with signs of 3!, 5! … 23!: sin r on |r| ≤ π/2 (remainder below 1e-19).
const SIN_SERIES: [f64; 11] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
    -1.0 / 121_645_100_408_832_000.0,
    1.0 / 51_090_942_171_709_440_000.0,
    -1.0 / 25_852_016_738_884_978_000_000.0,
];

/// sin x for |x| ≤ [`LARGEST_REDUCED`]; NaN stays NaN.
#[inline(always)]
fn sin_reduced(x: f64) -> f64 {
    let k = x.mul_add(std::f64::consts::FRAC_1_PI, ROUND) - ROUND;
    let r = PI_PARTS.iter().fold(x, |r, part| (-k).mul_add(*part, r));
    let z = r * r;
    let mut s = SIN_SERIES[10];
    for i in (0..10).rev() {
        s = s.mul_add(z, SIN_SERIES[i]);
    }
    let odd = (k + ROUND).to_bits() << 63;
    f64::from_bits((r * z).mul_add(s, r).to_bits() ^ odd)
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(crate) fn exp_block(x: &[f64], out: &mut [f64]) {
    for (o, &x) in out.iter_mut().zip(x) {
        *o = exp(x);
    }
    if x.iter().any(|x| *x > 709.0) {
        exp_outliers(x, out);
    }
}

#[cold]
fn exp_outliers(x: &[f64], out: &mut [f64]) {
    for (o, &x) in out.iter_mut().zip(x) {
        if x > 709.0 {
            *o = x.exp();
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(crate) fn tanh_block(x: &[f64], out: &mut [f64]) {
    for (o, &x) in out.iter_mut().zip(x) {
        *o = tanh(x);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
fn sin_block_reduced(x: &[f64], out: &mut [f64]) {
    for (o, &x) in out.iter_mut().zip(x) {
        *o = sin_reduced(x);
    }
}

pub(crate) fn sin_block(x: &[f64], out: &mut [f64]) {
    if x.iter().all(|x| x.abs() <= LARGEST_REDUCED) {
        return sin_block_reduced(x, out);
    }
    for (o, x) in out.iter_mut().zip(x) {
        *o = x.sin();
    }
}

/// Adds the products of all pairs of columns over one block: `sums[j·q + k] += Σ aⱼ aₖ` for k ≤ j.
///
/// Columns are taken in tiles of so many by four, that each product has vector sums of its own in registers:
/// two rows fit the 32 registers of AVX-512, one the 16 of AVX2. The tile does not change a product's order
/// of additions.
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

#[inline(always)]
fn add_tiles<const ROWS: usize>(columns: &[&[f64]], sums: &mut [f64]) {
    let q = columns.len();
    for j in (0..q).step_by(ROWS) {
        let last = (j + ROWS).min(q) - 1;
        for k in (0..=last).step_by(4) {
            // Beyond the last column it is repeated, and above the diagonal the result dropped.
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
        // By index: with iterators LLVM keeps the sums in memory.
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

/// The samples behind the last full set of lanes; the last block of a log alone has any.
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

/// Not inlined: next to the loop above, this order of additions makes LLVM pair up lanes of different sums
/// there.
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

/// Columns ∂τ/∂a and residual of the Stribeck law over one block, see [`super::stribeck`].
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(crate) fn stribeck_block(v: &[f64], torque: &[f64], a: &[f64; 5], columns: &mut [[f64; BLOCK]; 6]) {
    let n = v.len().min(torque.len()).min(BLOCK);
    let [c1, c2, c3, c4, c5, residual] = columns;
    for i in 0..n {
        let (x, s) = (v[i], v[i].abs());
        let e = exp(-2.0 * a[2] * s);
        let e3 = e * e * e;
        // Written with e instead of tanh: absolute errors of 1e-16 are enough for sums of squares.
        let t = ((1.0 - e) / (1.0 + e)).copysign(x);
        let u = ((1.0 - e3) / (1.0 + e3)).copysign(x);
        let decay = exp(-a[4] * s);
        c1[i] = x;
        c2[i] = t;
        c3[i] = a[1] * x * (1.0 - t * t) + 3.0 * a[3] * decay * x * (1.0 - u * u);
        c4[i] = decay * u;
        c5[i] = -a[3] * s * decay * u;
        residual[i] = torque[i] - (a[0] * x + a[1] * t + a[3] * decay * u);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest_relative_error(f: fn(&[f64], &mut [f64]), exact: fn(f64) -> f64, range: f64) -> f64 {
        let x: Vec<f64> = (0..20_001).map(|i| range * (i as f64 / 10_000.0 - 1.0)).collect();
        let mut y = vec![0.0; x.len()];
        f(&x, &mut y);
        x.iter().zip(&y).map(|(&x, &y)| (y - exact(x)).abs() / exact(x).abs().max(1e-300)).fold(0.0, f64::max)
    }

    #[test]
    fn elementary_functions_agree_with_the_standard_library() {
        let ulp = f64::EPSILON;
        assert!(largest_relative_error(exp_block, f64::exp, 700.0) < 3.0 * ulp);
        assert!(largest_relative_error(exp_block, f64::exp, 1e-3) < 2.0 * ulp);
        assert!(largest_relative_error(tanh_block, f64::tanh, 30.0) < 4.0 * ulp);
        assert!(largest_relative_error(tanh_block, f64::tanh, 1e-9) < 4.0 * ulp);
        assert!(largest_relative_error(sin_block, f64::sin, 3.0) < 4.0 * ulp);
        let x = [123_456.789, -999_999.0, 1e9, 0.0];
        let mut y = [0.0; 4];
        sin_block(&x, &mut y);
        for (x, y) in x.iter().zip(y) {
            assert!((y - x.sin()).abs() < 4.0 * ulp);
        }
        sin_block(&[999_999.5], &mut y[..1]);
        assert!((y[0] - 999_999.5_f64.sin()).abs() < 4.0 * ulp);
    }

    #[test]
    fn special_values_pass_through() {
        let x = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 710.0, -750.0, 709.5];
        let mut y = [0.0; 6];
        exp_block(&x, &mut y);
        assert!(
            y[0].is_nan() && y[1] == f64::INFINITY && y[2] == 0.0 && y[3] == f64::INFINITY && y[4] == 0.0
        );
        assert!((y[5] / 709.5_f64.exp() - 1.0).abs() < 1e-14);
        tanh_block(&x, &mut y);
        assert!(y[0].is_nan() && y[1] == 1.0 && y[2] == -1.0);
        sin_block(&x, &mut y);
        assert!(y[0].is_nan() && y[1].is_nan());
    }

    #[test]
    fn products_of_whole_numbers_are_exact() {
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
