/// The blocks of `A_d`, `B_d` and `c_d` in `x⁺ = A_d x + B_d u + c_d` with the state `x = (y, ẏ)`.
pub type Discrete<const N: usize, const M: usize> =
    ([[Matrix<N>; 2]; 2], [[[f64; M]; N]; 2], [[f64; N]; 2]);

/// The halves of `A_d − 1`, `B_d` and `c_d`.
type Held<const N: usize, const M: usize> = ([Half<N>; 2], [[[f64; M]; N]; 2], [[f64; N]; 2]);

/// Largest number of doublings of the integral Φ. A period that needs more halvings is divided into equal
/// steps.
const MOST_DOUBLINGS: u32 = 6;

/// Largest number of doublings of a step.
const MOST_REPETITIONS: u32 = 18;

/// Number of terms in each of the three parts of the Taylor polynomial.
const TERMS: usize = 6;

/// Coefficients `1/(k + 1)!` of the Taylor polynomial.
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

/// Exact solution of `ẋ = A x + B_x u + c` over a period with constant inputs.
///
/// The solution is first computed over a part of the period that is short enough for an accurate result. Two
/// equal steps are combined to one of twice the time by `A_d ← A_d A_d`, `B_d ← (A_d + 1) B_d` and
/// `c_d ← (A_d + 1) c_d` until the period is reached. Every entry is +∞ if `MOST_REPETITIONS` doublings of
/// the step do not suffice.
pub fn zero_order_hold<const N: usize, const M: usize>(
    linear: &Linear<N, M>,
    period: f64,
) -> Discrete<N, M> {
    let Some(halvings) = halvings(&linear.0, &linear.1, period) else {
        let infinite = f64::INFINITY;
        return (
            [[[[infinite; N]; N]; 2]; 2],
            [[[infinite; M]; N]; 2],
            [[infinite; N]; 2],
        );
    };
    let repetitions = halvings.saturating_sub(MOST_DOUBLINGS);
    let time = period / (1_u32 << repetitions) as f64;
    let (mut change, mut input, mut affine) = held(linear, time, halvings - repetitions);
    for _ in 0..repetitions {
        (input, affine) = (twice_by(&change, &input), twice_affine(&change, &affine));
        change = twice(&change);
    }
    let mut state = [[[[0.0; N]; N]; 2]; 2];
    for half in 0..2 {
        for i in 0..N {
            for block in 0..2 {
                state[half][block][i] = change[half][i][block];
            }
            state[half][half][i][i] += 1.0;
        }
    }
    (state, input, affine)
}

/// Number of halvings of the period until `ν h ≤ 5/4` for the halved period h. `None` if more than
/// `MOST_DOUBLINGS + MOST_REPETITIONS` halvings are needed.
///
/// ν is a bound for the rates of the system, the positive root of `ν² = b ν + a` with `a = ‖A_y‖` and
/// `b = ‖A_v‖`. With `t = h / (5/4)`, the condition is equivalent to `(a t + b) t ≤ 1`.
fn halvings<const N: usize>(by_y: &Matrix<N>, by_v: &Matrix<N>, period: f64) -> Option<u32> {
    let (a, b) = (norm(by_y), norm(by_v));
    let mut t = period / 1.25;
    let mut halvings = 0;
    while (a * t + b) * t > 1.0 {
        if halvings == MOST_DOUBLINGS + MOST_REPETITIONS {
            return None;
        }
        t *= 0.5;
        halvings += 1;
    }
    Some(halvings)
}

/// The largest sum of magnitudes in a row.
fn norm<const N: usize>(matrix: &Matrix<N>) -> f64 {
    let mut largest = 0.0;
    for i in 0..N {
        let mut sum = 0.0;
        for j in 0..N {
            sum += matrix[i][j].abs();
        }
        if sum > largest {
            largest = sum;
        }
    }
    largest
}

/// The matrix `A_d − 1` over twice the time, `2 (A_d − 1) + (A_d − 1)²`, as two halves.
fn twice<const N: usize>(change: &[Half<N>; 2]) -> [Half<N>; 2] {
    let mut next = [[[[0.0; N]; 2]; N]; 2];
    for half in 0..2 {
        add_scaled_half(&mut next[half], 2.0, &change[half]);
        for block in 0..2 {
            let rows = change[half].iter().map(|row| &row[block]);
            add_product(&mut next[half], rows, &change[block]);
        }
    }
    next
}

/// The matrix `B_d` over twice the time, `2 B_d + (A_d − 1) B_d`.
fn twice_by<const N: usize, const M: usize>(
    change: &[Half<N>; 2],
    input: &[[[f64; M]; N]; 2],
) -> [[[f64; M]; N]; 2] {
    let mut next = [[[0.0; M]; N]; 2];
    for half in 0..2 {
        for i in 0..N {
            add_scaled(&mut next[half][i], 2.0, &input[half][i]);
            for block in 0..2 {
                add_combination(&mut next[half][i], &change[half][i][block], &input[block]);
            }
        }
    }
    next
}

/// The vector `c_d` over twice the time, `2 c_d + (A_d − 1) c_d`.
fn twice_affine<const N: usize>(change: &[Half<N>; 2], affine: &[[f64; N]; 2]) -> [[f64; N]; 2] {
    let mut next = [[0.0; N]; 2];
    for half in 0..2 {
        add_scaled(&mut next[half], 2.0, &affine[half]);
        for i in 0..N {
            for block in 0..2 {
                next[half][i] += dot(&change[half][i][block], &affine[block]);
            }
        }
    }
    next
}

/// The halves of `A_d − 1`, `B_d` and `c_d` over a time t with `ν t ≤ 80`. ν is a bound for the rates of the
/// system.
///
/// With `A = [0 I; A_y A_v]`, all results follow from the upper half `[C P]` of the integral
/// `Φ = ∫ exp(A s) ds`:
///
/// - `exp(A t) = I + Φ A`; its upper half is `[I 0] + [C P] A = [I + X, Q]`, and its lower half is `[0 I] +
///   [X Q] A`
/// - `B_d = [P B_x; Q B_x]`
///
/// Φ is computed by scaling and squaring (Higham, Functions of Matrices, 2008, section 10.3): Φ is known for
/// a short time h with `ν h ≤ 5/4`, and is doubled `doublings` times. A doubling of Φ needs fewer operations
/// than a doubling of the step. However, it multiplies rounding errors by the ratio of the rates, so Φ is
/// doubled only up to `ν t = 80`.
fn held<const N: usize, const M: usize>(
    (by_y, by_v, by_u, remainder): &Linear<N, M>,
    time: f64,
    doublings: u32,
) -> Held<N, M> {
    // The unit of time is the short time h, so ẏ is scaled to h ẏ.
    let h = time / (1_u32 << doublings) as f64;
    let lower = lower_half(by_y, h * h, by_v, h);
    let mut integral = taylor(&lower);
    for _ in 0..doublings {
        double_integral(&lower, &mut integral);
    }
    let mut changes = [[[[0.0; N]; 2]; N]; 2];
    let [upper_change, lower_change] = &mut changes;
    times_system(&integral, &lower, upper_change);
    times_system(upper_change, &lower_half(by_y, h, by_v, h), lower_change);
    let (mut input, mut affine) = ([[[0.0; M]; N]; 2], [[0.0; N]; 2]);
    for i in 0..N {
        upper_change[i][1] = scaled(&upper_change[i][1], h);
        let by_acceleration = [scaled(&integral[i][1], h * h), upper_change[i][1]];
        for half in 0..2 {
            add_combination(&mut input[half][i], &by_acceleration[half], by_u);
            affine[half][i] = dot(&by_acceleration[half], remainder);
        }
    }
    (changes, input, affine)
}

/// The upper half of Φ over one unit of time. It is `Σ Aᵏ/(k + 1)!` up to k = 17, in three parts with the
/// common factor A⁶ (Paterson and Stockmeyer 1973). If `ν ≤ 5/4`, the remaining terms of the series are below
/// `(5/4)¹⁸/19! = 5e-16`.
fn taylor<const N: usize>(lower: &Half<N>) -> Half<N> {
    // Upper halves of Aᵏ. The upper half of A⁷ is the lower half of A⁶.
    let mut powers = [[[[0.0; N]; 2]; N]; TERMS + 2];
    for i in 0..N {
        powers[0][i][0][i] = 1.0;
        powers[1][i][1][i] = 1.0;
    }
    powers[2] = *lower;
    for k in 2..=TERMS {
        let (known, next) = powers.split_at_mut(k + 1);
        times_system(&known[k], lower, &mut next[0]);
    }
    let mut sum = combination(&COEFFICIENTS[2], &powers);
    for part in [1, 0] {
        let mut next = combination(&COEFFICIENTS[part], &powers);
        add_product(&mut next, left(&sum), &powers[TERMS]);
        add_product(&mut next, right(&sum), &powers[TERMS + 1]);
        sum = next;
    }
    sum
}

/// The sum `Σ c_k Aᵏ` of the terms of one part.
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
fn double_integral<const N: usize>(lower: &Half<N>, integral: &mut Half<N>) {
    let mut change = [[[0.0; N]; 2]; N];
    times_system(integral, lower, &mut change);
    let mut next = [[[0.0; N]; 2]; N];
    add_scaled_half(&mut next, 2.0, integral);
    // The blocks of the lower half of Φ are obtained from the change Φ A, because exp(A t) = I + A Φ.
    add_product(&mut next, left(&change), integral);
    add_product(&mut next, right(&change), &change);
    *integral = next;
}

/// The product `[L R] A = [0 L] + R [A_y A_v]`.
fn times_system<const N: usize>(half: &Half<N>, lower: &Half<N>, result: &mut Half<N>) {
    for i in 0..N {
        result[i] = [[0.0; N], half[i][0]];
    }
    add_product(result, right(half), lower);
}

/// The rows of the left block.
fn left<const N: usize>(half: &Half<N>) -> impl Iterator<Item = &[f64; N]> {
    half.iter().map(|row| &row[0])
}

/// The rows of the right block.
fn right<const N: usize>(half: &Half<N>) -> impl Iterator<Item = &[f64; N]> {
    half.iter().map(|row| &row[1])
}

/// The matrix `[A_y A_v]` with scaled blocks.
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
