/// Inverse of a symmetric positive definite matrix in place, by Gauss–Jordan elimination without pivoting.
/// From the leaves to the base, only rows of joints on one path are combined.
///
/// Whole rows are combined, and a bit mask selects the new entries of the pivot column. If these entries were
/// stored separately, the next step would have to wait for these stores.
#[inline]
pub fn invert<const N: usize, const L: usize>(
    matrix: &mut [[f64; L]; N],
    order: impl DoubleEndedIterator<Item = usize>,
    meet: impl Fn(usize, usize) -> bool,
) {
    for k in order.rev() {
        let Some(&(mut own)) = matrix.get(k) else {
            continue;
        };
        let reciprocal = 1.0 / own[k];
        for j in 0..L {
            own[j] = choose(mask(j == k), reciprocal, own[j] * reciprocal);
        }
        for (i, row) in matrix.iter_mut().enumerate() {
            if i == k {
                *row = own;
            } else if meet(i, k) {
                let factor = -row[k];
                for j in 0..L {
                    // −0 + x is x, even for the sign of zero.
                    let old = choose(mask(j == k), -0.0, row[j]);
                    row[j] = add_product(old, factor, own[j]);
                }
            }
        }
    }
}
