/// A square matrix as a list of rows.
pub type Matrix<const N: usize> = [[f64; N]; N];

/// The upper or lower half of a matrix over the state (y, ẏ). Each row has a left and a right block.
pub type Half<const N: usize> = [[[f64; N]; 2]; N];

/// The derivatives `∂ÿ/∂y`, `∂ÿ/∂ẏ` and `∂ÿ/∂u`, and the affine remainder of `ÿ`.
pub type Linear<const N: usize, const M: usize> = (Matrix<N>, Matrix<N>, [[f64; M]; N], [f64; N]);

/// Adds the product `A B` of a square matrix A, given by its rows, and half a matrix B over the state.
///
/// Two rows are computed at a time, so B is read half as often.
#[inline]
fn add_product<'a, const N: usize>(
    sum: &mut Half<N>,
    mut a: impl Iterator<Item = &'a [f64; N]>,
    b: &Half<N>,
) {
    let (pairs, last) = sum.as_chunks_mut();
    for rows in pairs {
        if let (Some(first), Some(second)) = (a.next(), a.next()) {
            add_rows(rows, [first, second], b);
        }
    }
    for (row, a) in last.iter_mut().zip(a) {
        add_rows(core::array::from_mut(row), [a], b);
    }
}

/// Computes some rows of [`add_product`]. This function is not inlined, because otherwise the compiler would
/// vectorize a loop over all rows across the rows and read their entries one by one. The registers hold two
/// rows of up to 14 columns, or one block of longer rows.
#[inline(never)]
fn add_rows<const N: usize, const R: usize>(
    sum: &mut [[[f64; N]; 2]; R],
    a: [&[f64; N]; R],
    b: &Half<N>,
) {
    if N < 8 {
        let mut rows = *sum;
        for k in 0..N {
            for block in 0..2 {
                for j in 0..N {
                    for row in 0..R {
                        rows[row][block][j] += a[row][k] * b[k][block][j];
                    }
                }
            }
        }
        *sum = rows;
        return;
    }
    for block in 0..2 {
        let mut rows: [[f64; N]; R] = core::array::from_fn(|row| sum[row][block]);
        for k in 0..N {
            for j in 0..N {
                for row in 0..R {
                    rows[row][j] += a[row][k] * b[k][block][j];
                }
            }
        }
        for row in 0..R {
            sum[row][block] = rows[row];
        }
    }
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

/// Adds `factor · a` to half a matrix.
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
