/// The blocks of [`Linear`], and the matrix D in `δ̇ = D δ + v`. δ is the displacement from the positions of
/// the linearization.
pub type LinearOnManifold<const N: usize, const M: usize> =
    (Matrix<N>, Matrix<N>, [[f64; M]; N], [f64; N], Matrix<N>);

/// Exact solution of `δ̇ = D δ + v`, `v̇ = A_y δ + A_v v + B_x u + c` over a period with constant inputs, for
/// the state `x = (δ, v)`. δ is the displacement from the positions of the linearization.
///
/// With `w = D δ + v`, the system is `δ̇ = w`, `ẇ = (A_y − A_v D) δ + (A_v + D) w + B_x u + c`, which
/// [`zero_order_hold`] solves.
pub fn zero_order_hold_on_manifold<const N: usize, const M: usize>(
    (by_y, by_v, by_u, remainder, drift): &LinearOnManifold<N, M>,
    period: f64,
) -> Discrete<N, M> {
    let (mut by_d, mut by_w) = (*by_y, *by_v);
    for i in 0..N {
        add_combination(&mut by_d[i], &negative(&by_v[i]), drift);
        add_scaled(&mut by_w[i], 1.0, &drift[i]);
    }
    let (mut state, mut input, mut affine) =
        zero_order_hold(&(by_d, by_w, *by_u, *remainder), period);
    // The rate w is replaced by v + D δ, first in the initial state, then in the final state.
    for [by_d, by_w] in &mut state {
        for (by_d, by_w) in by_d.iter_mut().zip(by_w) {
            add_combination(by_d, by_w, drift);
        }
    }
    let ([upper, lower], [input_upper, input_lower]) = (&mut state, &mut input);
    for i in 0..N {
        let row = negative(&drift[i]);
        for block in 0..2 {
            add_combination(&mut lower[block][i], &row, &upper[block]);
        }
        add_combination(&mut input_lower[i], &row, input_upper);
        affine[1][i] += dot(&row, &affine[0]);
    }
    (state, input, affine)
}

#[inline]
fn negative<const N: usize>(row: &[f64; N]) -> [f64; N] {
    row.map(|entry| -entry)
}
