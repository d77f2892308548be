//! Operations of expressions on columns of samples.

use gelenk_formula::{Function, Operator, Unary};
use gelenk_kernels::math::{exp, sin_cos, sin_cos_lanes, tanh};
use multiversion::multiversion;

/// Returns −1, 0 or 1; NaN for NaN.
pub(crate) fn sign(x: f64) -> f64 {
    if x == 0.0 || x.is_nan() { x } else { x.signum() }
}

/// Number of angles whose sine and cosine are computed together.
const LANES: usize = 8;

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
#[expect(
    clippy::redundant_closure,
    reason = "a named function would be called, but a closure is inlined into lanes"
)]
pub(super) fn unary(f: Unary, a: &mut [f64]) {
    #[inline(always)]
    fn map(a: &mut [f64], f: impl Fn(f64) -> f64) {
        a.iter_mut().for_each(|a| *a = f(*a));
    }
    #[inline(always)]
    fn turn(angles: &mut [f64], choose: impl Fn((f64, f64)) -> f64) {
        let (mut sin, mut cos) = ([0.0; LANES], [0.0; LANES]);
        let (eights, rest) = angles.as_chunks_mut::<LANES>();
        for angles in eights {
            sin_cos_lanes(angles, &mut sin, &mut cos);
            *angles = std::array::from_fn(|lane| choose((sin[lane], cos[lane])));
        }
        map(rest, |angle| choose(sin_cos(angle)));
    }
    match f {
        Unary::Negate => map(a, |a| -a),
        Unary::Not => map(a, |a| 1.0 - a),
        Unary::Logarithm => map(a, f64::ln),
        Unary::Call(Function::Abs) => map(a, f64::abs),
        Unary::Call(Function::Sign) => map(a, sign),
        Unary::Call(Function::Sqrt) => map(a, f64::sqrt),
        Unary::Call(Function::Exp) => map(a, |a| exp(a)),
        Unary::Call(Function::Sin) => turn(a, |(sin, _)| sin),
        Unary::Call(Function::Cos) => turn(a, |(_, cos)| cos),
        Unary::Call(Function::Tanh) => map(a, |a| tanh(a)),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(super) fn binary(f: Operator, a: &mut [f64], b: &[f64]) {
    #[inline(always)]
    fn map(a: &mut [f64], b: &[f64], f: impl Fn(f64, f64) -> f64) {
        a.iter_mut().zip(b).for_each(|(a, b)| *a = f(*a, *b));
    }
    fn truth(flag: bool) -> f64 {
        f64::from(u8::from(flag))
    }
    match f {
        Operator::Add => map(a, b, |a, b| a + b),
        Operator::Subtract => map(a, b, |a, b| a - b),
        Operator::Multiply | Operator::And => map(a, b, |a, b| a * b),
        Operator::Divide => map(a, b, |a, b| a / b),
        Operator::Less => map(a, b, |a, b| truth(a < b)),
        Operator::LessEqual => map(a, b, |a, b| truth(a <= b)),
        Operator::Greater => map(a, b, |a, b| truth(a > b)),
        Operator::GreaterEqual => map(a, b, |a, b| truth(a >= b)),
        Operator::Equal => map(a, b, |a, b| truth(a == b)),
        Operator::NotEqual => map(a, b, |a, b| truth(a != b)),
        Operator::Or | Operator::Max => map(a, b, larger),
        Operator::Min => map(a, b, |a, b| -larger(-a, -b)),
    }
}

/// Returns the larger of two numbers; NaN if one of them is NaN, so that NaN is never hidden.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
