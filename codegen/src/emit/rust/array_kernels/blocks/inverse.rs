/// Inverse of a symmetric positive definite matrix in place, by Gauss and Jordan without pivots. From the leaves to the
/// base, only joints on one path meet.
///
/// Whole rows are combined, and single entries set afterwards: the loops stay free of choices, and no row is read right
/// after one of its entries was stored alone, which would wait for the store.
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
        for entry in &mut own {
            *entry *= reciprocal;
        }
        for (i, row) in matrix.iter_mut().enumerate() {
            if i == k {
                *row = own;
                row[k] = reciprocal;
            } else if meet(i, k) {
                let factor = -row[k];
                for (entry, own) in row.iter_mut().zip(&own) {
                    *entry = add_product(*entry, factor, *own);
                }
                row[k] = factor * reciprocal;
            }
        }
    }
}
