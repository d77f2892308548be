/// Product `to = matrix vector` of a symmetric matrix and a vector.
#[inline]
pub fn apply<const N: usize, const L: usize>(
    matrix: &[[f64; L]; N],
    vector: &[[f64; L]; 1],
    to: &mut [[f64; L]; 1],
) {
    for (k, (factor, row)) in vector[0].iter().zip(matrix).enumerate() {
        for (sum, entry) in to[0].iter_mut().zip(row) {
            *sum = match k {
                0 => factor * entry,
                _ => add_product(*sum, *factor, *entry),
            };
        }
    }
}
