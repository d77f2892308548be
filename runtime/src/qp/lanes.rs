//! Vectors of four numbers, and the few dense kernels of the Riccati recursion on them.
//!
//! A vector of length `n` is stored as `⌈n/4⌉` lanes, padded with zeros; a matrix as a sequence of such vectors (its rows or its columns, said at
//! each field). Padding stays zero under every operation here, so no kernel needs a remainder loop. `wide` compiles the lanes to the vector unit that
//! the compiler may use (`-C target-cpu=native` brings AVX and fused multiply-add) and to pairs of SSE2 registers otherwise.

pub(super) use wide::f64x4 as Lane;

/// Numbers per lane.
pub(super) const WIDTH: usize = 4;

/// Lanes that hold `n` numbers.
pub(super) const fn lanes(n: usize) -> usize {
    n.div_ceil(WIDTH)
}

/// `n` zero lanes.
pub(super) fn zeros(n: usize) -> Vec<Lane> {
    vec![Lane::ZERO; n]
}

/// The number at position `i` of a padded vector.
#[inline(always)]
pub(super) fn at(v: &[Lane], i: usize) -> f64 {
    v[i / WIDTH].as_array()[i % WIDTH]
}

/// Writes `values` into a padded vector; the padding is left as it is.
#[inline(always)]
pub(super) fn pack(v: &mut [Lane], values: &[f64]) {
    let flat: &mut [f64] = bytemuck::cast_slice_mut(v);
    flat[..values.len()].copy_from_slice(values);
}

/// The numbers of a padded vector, padding included.
#[inline(always)]
pub(super) fn flat(v: &[Lane]) -> &[f64] {
    bytemuck::cast_slice(v)
}

/// The numbers of a padded vector, padding included, to be written.
#[inline(always)]
pub(super) fn flat_mut(v: &mut [Lane]) -> &mut [f64] {
    bytemuck::cast_slice_mut(v)
}

/// `acc[c][r] += Σ_i left(i)[first + r] · right(i, c)` for `i` in `0..depth`: a block of a matrix product in registers.
#[inline(always)]
pub(super) fn accumulate<const R: usize, const C: usize>(
    acc: &mut [[Lane; R]; C],
    depth: usize,
    left: impl Fn(usize, usize) -> Lane,
    right: impl Fn(usize, usize) -> f64,
) {
    for i in 0..depth {
        let column: [Lane; R] = core::array::from_fn(|r| left(i, r));
        for c in 0..C {
            let factor = Lane::splat(right(i, c));
            for r in 0..R {
                acc[c][r] = column[r].mul_add(factor, acc[c][r]);
            }
        }
    }
}

/// `Σ_r a[r] · b[r]` over padded vectors.
#[inline(always)]
pub(super) fn dot(a: &[Lane], b: &[Lane]) -> f64 {
    let mut sum = a[0] * b[0];
    for r in 1..a.len().min(b.len()) {
        sum = a[r].mul_add(b[r], sum);
    }
    sum.reduce_add()
}

/// The sums over each of four lanes, as one lane.
#[inline(always)]
pub(super) fn reduce4(v: [Lane; 4]) -> Lane {
    let t = Lane::transpose(v);
    (t[0] + t[1]) + (t[2] + t[3])
}

/// Largest number of a lane.
#[inline(always)]
pub(super) fn largest(v: Lane) -> f64 {
    let a = v.to_array();
    (a[0].max(a[1])).max(a[2].max(a[3]))
}
