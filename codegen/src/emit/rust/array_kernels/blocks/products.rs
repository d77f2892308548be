/// The sums `Σ by_i[r][i] by_j[r][j]` over r, for K columns j.
#[inline(always)]
fn products<const L: usize, const R: usize>(
    (by_i, by_j): (&[[f64; L]; R], &[[f64; L]; R]),
    i: usize,
    block: usize,
) -> [f64; K] {
    let mut sums = [0.0; K];
    for (r, (by_i, by_j)) in by_i.iter().zip(by_j).enumerate() {
        let by_j = &by_j.as_chunks::<K>().0[block];
        for lane in 0..K {
            sums[lane] = match r {
                0 => by_i[i] * by_j[lane],
                _ => add_product(sums[lane], by_i[i], by_j[lane]),
            };
        }
    }
    sums
}
