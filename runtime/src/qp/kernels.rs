//! Matrix products in registers, which take most of the time of the Riccati recursion.

use super::lanes::{Vector, lanes};

/// The right factor of a product: entry (i, c) is `numbers[i · by_row + c · by_column]`.
#[derive(Clone, Copy)]
pub(super) struct Right<'a> {
    numbers: &'a [f64],
    by_row: usize,
    by_column: usize,
}

impl<'a> Right<'a> {
    /// View of a matrix in padded columns, or of the transpose of a matrix in padded rows.
    #[inline(always)]
    pub(super) fn columns(numbers: &'a [f64], stride: usize) -> Self {
        Self { numbers, by_row: 1, by_column: stride }
    }
    /// View of a matrix in padded rows.
    #[inline(always)]
    pub(super) fn rows(numbers: &'a [f64], stride: usize) -> Self {
        Self { numbers, by_row: stride, by_column: 1 }
    }
}

/// One product of a sum, `Σ_i left[i] · right(i, c)`. `left` has `depth` vectors.
#[derive(Clone, Copy)]
pub(super) struct Term<'a, V> {
    pub(super) left: &'a [V],
    pub(super) right: Right<'a>,
    pub(super) depth: usize,
}

impl<V: Vector> Term<'_, V> {
    /// Whether the factors contain all entries that a product with `columns` columns of `n` lanes reads.
    #[inline(always)]
    fn covers(&self, n: usize, columns: usize) -> bool {
        let last = (self.depth - 1) * self.right.by_row + (columns - 1) * self.right.by_column;
        self.depth * n <= self.left.len() && last < self.right.numbers.len()
    }
}

/// Computes `out[c] = start[c] + Σ terms` for `COLS` columns of `⌈ROWS/W⌉` lanes. With `LOWER`, only the
/// lanes on and below the diagonal are computed.
#[inline(always)]
pub(super) fn product<
    V: Vector,
    const ROWS: usize,
    const COLS: usize,
    const LOWER: bool,
    const TERMS: usize,
>(
    out: &mut [V],
    start: Option<&[V]>,
    terms: [Term<'_, V>; TERMS],
) {
    let n = lanes::<V>(ROWS);
    assert!(out.len() >= COLS * n && start.is_none_or(|s| s.len() >= COLS * n));
    assert!(terms.iter().all(|t| t.covers(n, COLS)));
    let mut r = 0;
    // SAFETY: the entries exist by the assertions above, for columns below COLS and lanes below n.
    unsafe {
        if LOWER {
            for r in 0..n {
                columns::<V, 1, TERMS>(out, start, &terms, n, [r, COLS.min((r + 1) * V::WIDTH)]);
            }
            return;
        }
        while n - r > 4 || n - r == 3 {
            columns::<V, 3, TERMS>(out, start, &terms, n, [r, COLS]);
            r += 3;
        }
        while n - r >= 2 {
            columns::<V, 2, TERMS>(out, start, &terms, n, [r, COLS]);
            r += 2;
        }
        if n - r == 1 {
            columns::<V, 1, TERMS>(out, start, &terms, n, [r, COLS]);
        }
    }
}

/// Computes the first `count` columns of `R` lanes from lane `r` on, block by block. A block has at least eight sums, which
/// hide the latency of a fused multiply-add. The sums, a column of the left factor and one number of the right factor must
/// fit in 14 of the 16 registers. The compiler needs the other two registers to load the next numbers early.
///
/// # Safety
/// The conditions of [`block`] must be satisfied for these columns.
#[inline(always)]
unsafe fn columns<V: Vector, const R: usize, const TERMS: usize>(
    out: &mut [V],
    start: Option<&[V]>,
    terms: &[Term<'_, V>; TERMS],
    n: usize,
    [r, count]: [usize; 2],
) {
    let mut c = 0;
    // SAFETY: the caller satisfies the conditions of this function.
    unsafe {
        while c < count {
            let left = count - c;
            let width = match R {
                1 if left == 12 => 12,
                1 if left >= 8 => 8,
                1 | 2 if left >= 6 && left != 8 => 6,
                1 | 2 if left >= 4 => 4,
                _ => left.min(3),
            };
            match width {
                12 => block::<V, R, 12, TERMS>(out, start, terms, n, [r, c]),
                8 => block::<V, R, 8, TERMS>(out, start, terms, n, [r, c]),
                6 => block::<V, R, 6, TERMS>(out, start, terms, n, [r, c]),
                4 => block::<V, R, 4, TERMS>(out, start, terms, n, [r, c]),
                3 => block::<V, R, 3, TERMS>(out, start, terms, n, [r, c]),
                2 => block::<V, R, 2, TERMS>(out, start, terms, n, [r, c]),
                _ => block::<V, R, 1, TERMS>(out, start, terms, n, [r, c]),
            }
            c += width;
        }
    }
}

/// A block of `R` lanes by `C` columns, accumulated in registers.
///
/// # Safety
/// `out` and `start` must hold `(c + C) n` lanes with `r + R ≤ n`, and each term [`Term::covers`] `c + C`
/// columns.
#[inline(always)]
unsafe fn block<V: Vector, const R: usize, const C: usize, const TERMS: usize>(
    out: &mut [V],
    start: Option<&[V]>,
    terms: &[Term<'_, V>; TERMS],
    n: usize,
    [r0, c0]: [usize; 2],
) {
    let mut sums = [[V::zero(); R]; C];
    // SAFETY: the conditions of this function ensure that all indices are in range.
    unsafe {
        if let Some(start) = start {
            for c in 0..C {
                for r in 0..R {
                    sums[c][r] = *start.get_unchecked((c0 + c) * n + r0 + r);
                }
            }
        }
        for term in terms {
            let right = term.right;
            for i in 0..term.depth {
                let mut column = [V::zero(); R];
                for r in 0..R {
                    column[r] = *term.left.get_unchecked(i * n + r0 + r);
                }
                for c in 0..C {
                    let index = i * right.by_row + (c0 + c) * right.by_column;
                    let factor = V::splat(*right.numbers.get_unchecked(index));
                    for r in 0..R {
                        sums[c][r] = column[r].mul_add(factor, sums[c][r]);
                    }
                }
            }
        }
        for c in 0..C {
            for r in 0..R {
                *out.get_unchecked_mut((c0 + c) * n + r0 + r) = sums[c][r];
            }
        }
    }
}

/// Adds the product of a matrix in padded columns of `n` lanes and a vector:
/// `sums += Σ_i left[i] factors[i]`.
#[inline(always)]
pub(super) fn add_combination<V: Vector>(sums: &mut [V], left: &[V], factors: &[f64], n: usize) {
    for (column, factor) in left.chunks_exact(n).zip(factors) {
        let factor = V::splat(*factor);
        for r in 0..n {
            sums[r] = column[r].mul_add(factor, sums[r]);
        }
    }
}
