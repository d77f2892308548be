/// A square matrix, rows first.
pub type Matrix<const N: usize> = [[f64; N]; N];

/// The upper or lower half of a matrix over the state (y, ẏ): row by row its left and its right block.
pub type Half<const N: usize> = [[[f64; N]; 2]; N];

/// The blocks `∂ÿ/∂y`, `∂ÿ/∂ẏ`, `∂ÿ/∂u` and the affine remainder of `ÿ`.
pub type Linear<const N: usize, const M: usize> = (Matrix<N>, Matrix<N>, [[f64; M]; N], [f64; N]);

/// Adds `a B` to a row, where B is half a matrix over the state.
///
/// A loop over rows would be vectorized across them, which gathers numbers one by one: from five columns on, rows are
/// calls.
#[inline]
fn add_row<const N: usize>(sum: &mut [[f64; N]; 2], a: &[f64; N], b: &Half<N>) {
    if N < 5 {
        add_row_inline(sum, a, b)
    } else {
        add_row_called(sum, a, b)
    }
}

#[inline(never)]
fn add_row_called<const N: usize>(sum: &mut [[f64; N]; 2], a: &[f64; N], b: &Half<N>) {
    add_row_inline(sum, a, b);
}

#[inline(always)]
fn add_row_inline<const N: usize>(sum: &mut [[f64; N]; 2], a: &[f64; N], b: &Half<N>) {
    let mut row = *sum;
    for k in 0..N {
        for block in 0..2 {
            for j in 0..N {
                row[block][j] += a[k] * b[k][block][j];
            }
        }
    }
    *sum = row;
}

/// Adds `Σ a_k b_k` to a row.
#[inline]
fn add_combination<const N: usize, const M: usize>(
    sum: &mut [f64; M],
    a: &[f64; N],
    b: &[[f64; M]; N],
) {
    for k in 0..N {
        add_scaled(sum, a[k], &b[k]);
    }
}

/// Adds `factor · a`.
#[inline]
fn add_scaled_half<const N: usize>(sum: &mut Half<N>, factor: f64, a: &Half<N>) {
    let (sum, a) = (sum.as_flattened_mut(), a.as_flattened());
    add_scaled(sum.as_flattened_mut(), factor, a.as_flattened());
}

#[inline]
fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}
