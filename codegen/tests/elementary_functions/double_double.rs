//! Reference of about 100 bits from the textbook: Taylor series in double-double arithmetic (Dekker 1971),
//! after a reduction by its own constants. It shares nothing with the kernels and takes about a microsecond
//! per value, so that 10⁷ points are feasible; what it finds suspicious is decided by a multiple-precision
//! crate.

/// `hi + low` with `|low| ≤ ulp(hi) / 2`.
#[derive(Debug, Clone, Copy)]
pub struct DoubleDouble {
    pub hi: f64,
    pub low: f64,
}

const fn double(hi: f64, low: f64) -> DoubleDouble {
    DoubleDouble { hi, low }
}

fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let sum = a + b;
    let other = sum - a;
    double(sum, (a - (sum - other)) + (b - other))
}

fn two_product(a: f64, b: f64) -> DoubleDouble {
    let product = a * b;
    double(product, a.mul_add(b, -product))
}

fn add(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let (hi, low) = (two_sum(a.hi, b.hi), two_sum(a.low, b.low));
    let first = two_sum(hi.hi, hi.low + low.hi);
    two_sum(first.hi, first.low + low.low)
}

fn multiply(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let product = two_product(a.hi, b.hi);
    two_sum(product.hi, product.low + (a.hi * b.low + a.low * b.hi))
}

fn divide(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let first = a.hi / b.hi;
    let rest = add(a, multiply(b, double(-first, 0.0)));
    let second = rest.hi / b.hi;
    let rest = add(rest, multiply(b, double(-second, 0.0)));
    add(two_sum(first, second), double(rest.hi / b.hi, 0.0))
}

/// `x − n c` with `c` in three parts, each product exact.
fn reduce(x: f64, n: f64, parts: [f64; 3]) -> DoubleDouble {
    parts.iter().fold(double(x, 0.0), |rest, &part| add(rest, two_product(-n, part)))
}

/// `Σ tᵏ / (first + step k)! · first!` by Horner's rule.
fn series(t: DoubleDouble, first: u32, step: u32, terms: u32) -> DoubleDouble {
    let one = double(1.0, 0.0);
    (1..terms).rev().fold(one, |sum, k| {
        let top = first + step * k;
        let divisor: f64 = (top - step + 1..=top).map(f64::from).product();
        add(one, multiply(sum, divide(t, double(divisor, 0.0))))
    })
}

/// `(sin x, cos x)` for `|x| ≤ 1e5`.
pub fn sin_cos(x: f64) -> [DoubleDouble; 2] {
    // π/2 to 160 bits, each part rounded to nearest.
    const HALF_PI: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591833e-33];
    let n = (x * std::f64::consts::FRAC_2_PI).round();
    let r = reduce(x, n, HALF_PI);
    let square = multiply(r, r);
    let minus_square = double(-square.hi, -square.low);
    let sin = multiply(r, series(minus_square, 1, 2, 14));
    let cos = series(minus_square, 0, 2, 14);
    let negative = |a: DoubleDouble| double(-a.hi, -a.low);
    match n.rem_euclid(4.0) as u8 {
        0 => [sin, cos],
        1 => [cos, negative(sin)],
        2 => [negative(sin), negative(cos)],
        _ => [negative(cos), sin],
    }
}

/// `exp x` where neither `x` nor the result is near the ends of the range.
pub fn exp(x: f64) -> DoubleDouble {
    // ln 2 to 160 bits, each part rounded to nearest.
    const LN_2: [f64; 3] = [std::f64::consts::LN_2, 2.3190468138462996e-17, 5.707708438416212e-34];
    let k = (x * std::f64::consts::LOG2_E).round();
    let sum = series(reduce(x, k, LN_2), 0, 1, 26);
    let power = 2.0_f64.powi(k as i32);
    double(sum.hi * power, sum.low * power)
}

/// `tanh x`.
pub fn tanh(x: f64) -> DoubleDouble {
    if x.abs() < 1e-6 {
        let square = two_product(x, x);
        let square = double(square.hi / -3.0, 0.0); // x − x³/3; the next term is below 2^−80
        return multiply(double(x, 0.0), add(double(1.0, 0.0), square));
    }
    let e = exp(2.0 * x.abs().min(100.0));
    let value = divide(add(e, double(-1.0, 0.0)), add(e, double(1.0, 0.0)));
    double(value.hi.copysign(x), value.low * x.signum())
}
