/// The blocks of `A_d`, `B_d` and `c_d` in `x⁺ = A_d x + B_d u + c_d` with `x = (y, ẏ)`.
pub type Discrete<const N: usize, const M: usize> =
    ([[Matrix<N>; 2]; 2], [[[f64; M]; N]; 2], [[f64; N]; 2]);

/// The period is halved so often, and the solution over the short time doubled as often.
const DOUBLINGS: usize = 6;

/// Terms in each of the three parts of the Taylor polynomial.
const TERMS: usize = 6;

/// `1/(k + 1)!`
const COEFFICIENTS: [[f64; TERMS]; 3] = {
    let mut coefficients = [[1.0; TERMS]; 3];
    let (mut k, mut last) = (0, 1.0);
    while k < 3 * TERMS {
        last /= (k + 1) as f64;
        coefficients[k / TERMS][k % TERMS] = last;
        k += 1;
    }
    coefficients
};

/// Exact solution of `ẋ = A x + B_x u + c` over a period in which the inputs are held.
///
/// With `A = [0 I; A_y A_v]` the upper half `[C P]` of `Φ = ∫ exp(A s) ds` gives everything:
/// `exp(A t) = I + Φ A`, whose upper half is `[I 0] + [C P] A = [I + X, Q]`, the lower one `[0 I] + [X Q] A`, and
/// `B_d = [P B_x; Q B_x]`. Φ comes from scaling and squaring (Higham, Functions of Matrices, 2008, section 10.3).
pub fn zero_order_hold<const N: usize, const M: usize>(
    (by_y, by_v, by_u, remainder): &Linear<N, M>,
    period: f64,
) -> Discrete<N, M> {
    // In units of the short time h, ẏ counts as h ẏ.
    let h = period / (1_u32 << DOUBLINGS) as f64;
    let lower = lower_half(by_y, h * h, by_v, h);
    let mut integral = taylor(&lower);
    for _ in 0..DOUBLINGS {
        integral = doubled(&lower, &integral);
    }
    let upper_change = times_system(&integral, &lower);
    let lower_change = times_system(&upper_change, &lower_half(by_y, h, by_v, h));
    let (mut state, mut input, mut affine) =
        ([[[[0.0; N]; N]; 2]; 2], [[[0.0; M]; N]; 2], [[0.0; N]; 2]);
    for i in 0..N {
        let [x, q] = &upper_change[i];
        state[0][0][i] = *x;
        state[0][0][i][i] += 1.0;
        state[0][1][i] = scaled(q, h);
        state[1][0][i] = lower_change[i][0];
        state[1][1][i] = lower_change[i][1];
        state[1][1][i][i] += 1.0;
        let by_acceleration = [scaled(&integral[i][1], h * h), scaled(q, h)];
        for half in 0..2 {
            add_combination(&mut input[half][i], &by_acceleration[half], by_u);
            affine[half][i] = dot(&by_acceleration[half], remainder);
        }
    }
    (state, input, affine)
}

/// The upper half of Φ over one unit of time, `Σ Aᵏ/(k + 1)!` up to k = 17, in three parts with the common factor A⁶
/// (Paterson and Stockmeyer 1973).
fn taylor<const N: usize>(lower: &Half<N>) -> Half<N> {
    // Upper halves of Aᵏ; that of A⁷ is the lower one of A⁶.
    let mut powers = [[[[0.0; N]; 2]; N]; TERMS + 2];
    for i in 0..N {
        powers[0][i][0][i] = 1.0;
        powers[1][i][1][i] = 1.0;
    }
    powers[2] = *lower;
    for k in 2..=TERMS {
        powers[k + 1] = times_system(&powers[k], lower);
    }
    let mut sum = combination(&COEFFICIENTS[2], &powers);
    for part in [1, 0] {
        let mut next = combination(&COEFFICIENTS[part], &powers);
        for i in 0..N {
            add_row(&mut next[i], &sum[i][0], &powers[TERMS]);
            add_row(&mut next[i], &sum[i][1], &powers[TERMS + 1]);
        }
        sum = next;
    }
    sum
}

/// `Σ c_k Aᵏ` over the terms of one part.
fn combination<const N: usize>(
    coefficients: &[f64; TERMS],
    powers: &[Half<N>; TERMS + 2],
) -> Half<N> {
    let mut sum = [[[0.0; N]; 2]; N];
    for k in 0..TERMS {
        add_scaled_half(&mut sum, coefficients[k], &powers[k]);
    }
    sum
}

/// The upper half of Φ over twice the time: `Φ + exp(A t) Φ = 2 Φ + (Φ A) Φ`.
fn doubled<const N: usize>(lower: &Half<N>, integral: &Half<N>) -> Half<N> {
    let change = times_system(integral, lower);
    let mut next = [[[0.0; N]; 2]; N];
    add_scaled_half(&mut next, 2.0, integral);
    for i in 0..N {
        // The left block of the lower half of Φ is that of the change, since exp(A t) = I + A Φ as well; so is the right.
        add_row(&mut next[i], &change[i][0], integral);
        add_row(&mut next[i], &change[i][1], &change);
    }
    next
}

/// `[L R] A = [0 L] + R [A_y A_v]`.
fn times_system<const N: usize>(half: &Half<N>, lower: &Half<N>) -> Half<N> {
    let mut result = [[[0.0; N]; 2]; N];
    for i in 0..N {
        result[i][1] = half[i][0];
        add_row(&mut result[i], &half[i][1], lower);
    }
    result
}

/// `[A_y A_v]`, the blocks scaled.
fn lower_half<const N: usize>(
    by_y: &Matrix<N>,
    unit_y: f64,
    by_v: &Matrix<N>,
    unit_v: f64,
) -> Half<N> {
    let mut lower = [[[0.0; N]; 2]; N];
    for i in 0..N {
        lower[i] = [scaled(&by_y[i], unit_y), scaled(&by_v[i], unit_v)];
    }
    lower
}

#[inline]
fn scaled<const N: usize>(a: &[f64; N], factor: f64) -> [f64; N] {
    let mut result = *a;
    for entry in &mut result {
        *entry *= factor;
    }
    result
}
