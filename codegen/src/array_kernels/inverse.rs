/// Inverse of a symmetric positive definite matrix in place, by Gauss and Jordan without pivots. From the leaves to the
/// base, only joints on one path meet.
///
/// Single entries are chosen within the loops: one that is stored alone would delay the row that is read next.
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
            own[j] = if j == k { reciprocal } else { own[j] * reciprocal };
        }
        for (i, row) in matrix.iter_mut().enumerate() {
            if i == k {
                *row = own;
            } else if meet(i, k) {
                let factor = -row[k];
                for j in 0..L {
                    let entry = if j == k { 0.0 } else { row[j] };
                    row[j] = add_product(entry, factor, own[j]);
                }
            }
        }
    }
}
