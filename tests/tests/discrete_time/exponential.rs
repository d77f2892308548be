//! The exponential of a matrix to about 28 digits: Taylor series with scaling and squaring in double-double
//! arithmetic (Dekker 1971).

/// `hi + low` with `|low| ≤ ulp(hi) / 2`.
#[derive(Clone, Copy)]
struct Double(f64, f64);

fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let other = sum - a;
    Double(sum, (a - (sum - other)) + (b - other))
}

fn add(a: Double, b: Double) -> Double {
    let (hi, low) = (two_sum(a.0, b.0), two_sum(a.1, b.1));
    let first = two_sum(hi.0, hi.1 + low.0);
    two_sum(first.0, first.1 + low.1)
}

fn multiply(a: Double, b: Double) -> Double {
    let product = a.0 * b.0;
    let rest = a.0.mul_add(b.0, -product);
    two_sum(product, rest + (a.0 * b.1 + a.1 * b.0))
}

/// Quotient of the leading parts, corrected by one Newton step.
fn divide(a: Double, b: f64) -> Double {
    let first = a.0 / b;
    let rest = add(a, multiply(Double(-first, 0.0), Double(b, 0.0)));
    let second = rest.0 / b;
    let rest = add(rest, multiply(Double(-second, 0.0), Double(b, 0.0)));
    add(two_sum(first, second), Double(rest.0 / b, 0.0))
}

type Matrix = Vec<Vec<Double>>;

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = 0..b[0].len();
    let row = |row: &Vec<Double>| {
        let entry = |j: usize| {
            let terms = row.iter().zip(b).map(|(&x, row)| multiply(x, row[j]));
            terms.fold(Double(0.0, 0.0), add)
        };
        columns.clone().map(entry).collect()
    };
    a.iter().map(row).collect()
}

fn sum(a: &Matrix, b: &Matrix) -> Matrix {
    let rows = a.iter().zip(b);
    rows.map(|(a, b)| a.iter().zip(b).map(|(&a, &b)| add(a, b)).collect()).collect()
}

/// `exp(a t)`, rounded to f64.
pub fn exponential(a: &[Vec<f64>], t: f64) -> Vec<Vec<f64>> {
    let norm = |row: &Vec<f64>| row.iter().map(|x| x.abs()).sum::<f64>();
    let norm = t * a.iter().map(norm).fold(0.0, f64::max);
    // The series then falls by 2⁻⁶ and more with each term.
    let doublings = (norm.log2().ceil() as i32 + 6).max(0);
    let unit = t * f64::powi(2.0, -doublings);
    let scaled = |x: &f64| multiply(Double(*x, 0.0), Double(unit, 0.0));
    let scaled: Matrix = a.iter().map(|row| row.iter().map(scaled).collect()).collect();
    let identity = |i: usize| {
        let entry = |j: usize| Double(f64::from(u8::from(i == j)), 0.0);
        (0..a.len()).map(entry).collect()
    };
    let identity: Matrix = (0..a.len()).map(identity).collect();
    // exp − 1 is squared, (1 + e)² − 1 = 2 e + e², so that no digit of small entries is lost.
    let (mut change, mut term) = (scaled.clone(), scaled.clone());
    for k in 2..20 {
        let next = product(&term, &scaled);
        let divided = |row: &Vec<Double>| row.iter().map(|&x| divide(x, f64::from(k))).collect();
        term = next.iter().map(divided).collect();
        change = sum(&change, &term);
    }
    for _ in 0..doublings {
        change = sum(&sum(&change, &change), &product(&change, &change));
    }
    let result = sum(&change, &identity);
    let rounded = |row: &Vec<Double>| row.iter().map(|x| x.0 + x.1).collect();
    result.iter().map(rounded).collect()
}

#[test]
fn it_agrees_with_closed_forms() {
    // A nilpotent matrix and a rotation: exp([0 −w; w 0] t) turns by w t.
    let jordan = [vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0], vec![0.0; 3]];
    let t = 0.3;
    let found = exponential(&jordan, t);
    assert_eq!(found[0], [1.0, t, t * t / 2.0]);
    let found = exponential(&[vec![0.0, -7.0], vec![7.0, 0.0]], 1.5);
    let (sin, cos) = 10.5_f64.sin_cos();
    for (found, expected) in found.concat().iter().zip([cos, -sin, sin, cos]) {
        assert!((found - expected).abs() < 2e-16, "{found} and {expected}");
    }
    let found = exponential(&[vec![-50.0]], 1.0)[0][0];
    // Digits are those of 1: exp − 1 is what is computed.
    assert!((found - (-50.0_f64).exp()).abs() < 1e-30, "{found}");
}
