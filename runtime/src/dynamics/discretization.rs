//! Discrete time: the exact zero-order hold of an affine system, and Runge–Kutta steps with their sensitivities.

/// A square matrix, rows first.
pub type Matrix<const N: usize> = [[f64; N]; N];

/// The blocks `∂ÿ/∂y`, `∂ÿ/∂ẏ`, `∂ÿ/∂u` and the affine remainder of `ÿ`.
pub type Linear<const N: usize, const M: usize> = (Matrix<N>, Matrix<N>, [[f64; M]; N], [f64; N]);

/// The blocks `A_d`, `B_d` and `c_d` of `x⁺ = A_d x + B_d u + c_d` with `x = (y, ẏ)`.
pub type Blocks<const N: usize, const M: usize> =
    ([[Matrix<N>; 2]; 2], [[[f64; M]; N]; 2], [[f64; N]; 2]);

/// The period is halved so often and the solution doubled as often.
const DOUBLINGS: usize = 6;

/// Terms in each of the three parts of the Taylor polynomial.
const TERMS: usize = 6;

/// `1/(k + 1)!`.
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
/// With `A = [0 I; A_y A_v]` all follows from the two blocks of `∫ exp(A s) ds` that accelerations are multiplied by,
/// P for coordinates and Q = Ṗ for velocities: `A_d = [I + P A_y, Q; Q A_y, I + A_y P + A_v Q]`,
/// `B_d = [P B_x; Q B_x]`, `c_d = [P c; Q c]`. P and Q come from scaling and squaring (Higham, Functions of Matrices,
/// 2008, section 10.3) with fixed counts.
pub fn zero_order_hold<const N: usize, const M: usize>(
    (by_y, by_v, by_u, remainder): &Linear<N, M>,
    period: f64,
) -> Blocks<N, M> {
    let h = period / (1_u32 << DOUBLINGS) as f64;
    let (s_y, s_v) = (scaled(by_y, h * h), scaled(by_v, h));
    let mut integrals = taylor(&s_y, &s_v);
    for _ in 0..DOUBLINGS {
        integrals = doubled(&s_y, &s_v, &integrals);
    }
    let (p, q) = &integrals;
    let mut by_coordinates = identity();
    add_product(&mut by_coordinates, p, &s_y);
    let mut by_velocities = identity();
    add_product(&mut by_velocities, &s_y, p);
    add_product(&mut by_velocities, &s_v, q);
    let (p, q) = (scaled(p, h * h), scaled(q, h));
    (
        [[by_coordinates, q], [product(&q, by_y), by_velocities]],
        [product(&p, by_u), product(&q, by_u)],
        [applied(&p, remainder), applied(&q, remainder)],
    )
}

/// P and Q in units of the step by their Taylor polynomial of degree 17, in three parts (Paterson and Stockmeyer 1973).
///
/// The right half of `Aᵏ` is `[V_(k−1); V_k]` with `V_(k+1) = A_y V_(k−1) + A_v V_k`, the left half that of `Aᵏ⁻¹`
/// times A_y.
fn taylor<const N: usize>(s_y: &Matrix<N>, s_v: &Matrix<N>) -> (Matrix<N>, Matrix<N>) {
    let mut powers = [identity(); TERMS + 1];
    powers[1] = *s_v;
    for k in 1..TERMS {
        let mut next = product(s_y, &powers[k - 1]);
        add_product(&mut next, s_v, &powers[k]);
        powers[k + 1] = next;
    }
    let left = [
        product(&powers[TERMS - 2], s_y),
        product(&powers[TERMS - 1], s_y),
    ];
    let right = [&powers[TERMS - 1], &powers[TERMS]];
    let [first, second, third] = COEFFICIENTS;
    let (mut p, mut q) = combined(&third, &powers);
    for coefficients in [second, first] {
        let (mut next_p, mut next_q) = combined(&coefficients, &powers);
        add_product(&mut next_p, &left[0], &p);
        add_product(&mut next_p, right[0], &q);
        add_product(&mut next_q, &left[1], &p);
        add_product(&mut next_q, right[1], &q);
        (p, q) = (next_p, next_q);
    }
    (p, q)
}

/// A part of the polynomial: `Σ c_k [V_(k−1); V_k]`.
fn combined<const N: usize>(
    coefficients: &[f64; TERMS],
    powers: &[Matrix<N>; TERMS + 1],
) -> (Matrix<N>, Matrix<N>) {
    let (mut p, mut q) = ([[0.0; N]; N], scaled(&powers[0], coefficients[0]));
    for k in 1..TERMS {
        add_scaled(&mut p, coefficients[k], &powers[k - 1]);
        add_scaled(&mut q, coefficients[k], &powers[k]);
    }
    (p, q)
}

/// P and Q over twice the time: `∫ exp(A s) ds` over [0, 2t] is `(I + exp(A t))` times that over [0, t].
fn doubled<const N: usize>(
    s_y: &Matrix<N>,
    s_v: &Matrix<N>,
    (p, q): &(Matrix<N>, Matrix<N>),
) -> (Matrix<N>, Matrix<N>) {
    let by_y = product(s_y, p);
    let mut change = by_y;
    add_product(&mut change, s_v, q);
    let (mut next_p, mut next_q) = (scaled(p, 2.0), scaled(q, 2.0));
    add_product(&mut next_p, p, &by_y);
    add_product(&mut next_p, q, q);
    add_product(&mut next_q, q, &by_y);
    add_product(&mut next_q, &change, q);
    (next_p, next_q)
}

/// What a Runge–Kutta step advances: coordinates or velocities, with or without their sensitivities.
pub trait Advance: Copy {
    /// `self + factor · rate`.
    fn advanced(&self, factor: f64, rate: &Self) -> Self;
}

impl<const N: usize> Advance for [f64; N] {
    fn advanced(&self, factor: f64, rate: &Self) -> Self {
        let mut sum = *self;
        for i in 0..N {
            sum[i] += factor * rate[i];
        }
        sum
    }
}

/// Coordinates, velocities or accelerations with their derivatives by the initial state and the inputs.
#[derive(Clone, Copy)]
pub struct Motion<const N: usize, const M: usize> {
    pub value: [f64; N],
    pub by_y: Matrix<N>,
    pub by_v: Matrix<N>,
    pub by_u: [[f64; M]; N],
}

impl<const N: usize, const M: usize> Advance for Motion<N, M> {
    fn advanced(&self, factor: f64, rate: &Self) -> Self {
        let mut sum = *self;
        sum.value = self.value.advanced(factor, &rate.value);
        add_scaled(&mut sum.by_y, factor, &rate.by_y);
        add_scaled(&mut sum.by_v, factor, &rate.by_v);
        add_scaled(&mut sum.by_u, factor, &rate.by_u);
        sum
    }
}

/// Steps of the classical Runge–Kutta method of order 4 (Hairer, Nørsett and Wanner, Solving Ordinary Differential
/// Equations I, 1993, table II.1.2).
pub fn runge_kutta<V: Advance>(
    mut y: V,
    mut v: V,
    period: f64,
    substeps: usize,
    acceleration: impl Fn(&V, &V) -> V,
) -> (V, V) {
    let h = period / substeps as f64;
    for _ in 0..substeps {
        let a1 = acceleration(&y, &v);
        let v2 = v.advanced(h / 2.0, &a1);
        let a2 = acceleration(&y.advanced(h / 2.0, &v), &v2);
        let v3 = v.advanced(h / 2.0, &a2);
        let a3 = acceleration(&y.advanced(h / 2.0, &v2), &v3);
        let v4 = v.advanced(h, &a3);
        let a4 = acceleration(&y.advanced(h, &v3), &v4);
        let weights = [h / 6.0, h / 3.0, h / 3.0, h / 6.0];
        let rates = [v, v2, v3, v4];
        for k in 0..4 {
            y = y.advanced(weights[k], &rates[k]);
            v = v.advanced(weights[k], &[a1, a2, a3, a4][k]);
        }
    }
    (y, v)
}

/// Such steps with their exact derivatives, by the chain rule over the stages.
pub fn runge_kutta_derivatives<const N: usize, const M: usize>(
    y: &[f64; N],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
    substeps: usize,
    linearize: impl Fn(&[f64; N], &[f64; N]) -> Linear<N, M>,
) -> (Motion<N, M>, Motion<N, M>) {
    let (zero, one) = ([[0.0; N]; N], identity());
    let motion = |value, by_y, by_v| Motion {
        value,
        by_y,
        by_v,
        by_u: [[0.0; M]; N],
    };
    runge_kutta(
        motion(*y, one, zero),
        motion(*v, zero, one),
        period,
        substeps,
        |y, v| {
            let (by_y, by_v, mut by_u, mut value) = linearize(&y.value, &v.value);
            for i in 0..N {
                value[i] += dot(&by_y[i], &y.value) + dot(&by_v[i], &v.value) + dot(&by_u[i], u);
            }
            add_product(&mut by_u, &by_y, &y.by_u);
            add_product(&mut by_u, &by_v, &v.by_u);
            let chained = |y, v| {
                let mut sum = product(&by_y, y);
                add_product(&mut sum, &by_v, v);
                sum
            };
            Motion {
                value,
                by_y: chained(&y.by_y, &v.by_y),
                by_v: chained(&y.by_v, &v.by_v),
                by_u,
            }
        },
    )
}

fn identity<const N: usize>() -> Matrix<N> {
    let mut identity = [[0.0; N]; N];
    for i in 0..N {
        identity[i][i] = 1.0;
    }
    identity
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}

fn applied<const N: usize>(a: &Matrix<N>, b: &[f64; N]) -> [f64; N] {
    let mut result = [0.0; N];
    for i in 0..N {
        result[i] = dot(&a[i], b);
    }
    result
}

fn scaled<const N: usize>(a: &Matrix<N>, factor: f64) -> Matrix<N> {
    let mut result = [[0.0; N]; N];
    add_scaled(&mut result, factor, a);
    result
}

fn add_scaled<const N: usize, const M: usize>(
    sum: &mut [[f64; M]; N],
    factor: f64,
    a: &[[f64; M]; N],
) {
    for i in 0..N {
        for j in 0..M {
            sum[i][j] += factor * a[i][j];
        }
    }
}

fn product<const N: usize, const M: usize>(a: &Matrix<N>, b: &[[f64; M]; N]) -> [[f64; M]; N] {
    let mut result = [[0.0; M]; N];
    add_product(&mut result, a, b);
    result
}

fn add_product<const N: usize, const M: usize>(
    sum: &mut [[f64; M]; N],
    a: &Matrix<N>,
    b: &[[f64; M]; N],
) {
    for i in 0..N {
        for k in 0..N {
            for j in 0..M {
                sum[i][j] += a[i][k] * b[k][j];
            }
        }
    }
}
