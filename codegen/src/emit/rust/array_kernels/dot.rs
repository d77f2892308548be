/// Product `a b` in four partial sums, because a single sum would wait for each of its terms.
#[inline]
pub fn dot<const R: usize>(a: &[f64; R], b: &[f64; R]) -> f64 {
    let mut sums = [0.0; 4];
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] = add_product(sums[k], a[k], b[k]);
        }
    }
    for (sum, (a, b)) in sums.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *sum = add_product(*sum, *a, *b);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
