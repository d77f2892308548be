//! The operations of a program over blocks of samples.

use crate::kernel::{exp_block, sin_block, tanh_block};
use multiversion::multiversion;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    Constant(f64),
    Channel(usize),
    Unary(Unary, usize),
    Power(usize, i32),
    Binary(Binary, usize, usize),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unary {
    Negate,
    Not,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tanh,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Min,
    Max,
}

pub(super) fn power(a: &[f64], exponent: i32, out: &mut [f64]) {
    for (o, a) in out.iter_mut().zip(a) {
        *o = a.powi(exponent);
    }
}

/// −1, 0 or 1; NaN stays NaN.
pub(crate) fn sign(x: f64) -> f64 {
    if x == 0.0 || x.is_nan() { x } else { x.signum() }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(super) fn unary(f: Unary, a: &[f64], out: &mut [f64]) {
    let map = |f: fn(f64) -> f64, out: &mut [f64]| {
        for (o, a) in out.iter_mut().zip(a) {
            *o = f(*a);
        }
    };
    match f {
        Unary::Negate => map(|a| -a, out),
        Unary::Not => map(|a| 1.0 - a, out),
        Unary::Abs => map(f64::abs, out),
        Unary::Sign => map(sign, out),
        Unary::Sqrt => map(f64::sqrt, out),
        Unary::Exp => exp_block(a, out),
        Unary::Ln => map(f64::ln, out),
        Unary::Sin => sin_block(a, out),
        Unary::Cos => map(f64::cos, out),
        Unary::Tanh => tanh_block(a, out),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(super) fn binary(f: Binary, a: &[f64], b: &[f64], out: &mut [f64]) {
    #[inline(always)]
    fn map(a: &[f64], b: &[f64], out: &mut [f64], f: impl Fn(f64, f64) -> f64) {
        for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
            *o = f(*a, *b);
        }
    }
    fn truth(flag: bool) -> f64 {
        f64::from(u8::from(flag))
    }
    match f {
        Binary::Add => map(a, b, out, |a, b| a + b),
        Binary::Subtract => map(a, b, out, |a, b| a - b),
        Binary::Multiply | Binary::And => map(a, b, out, |a, b| a * b),
        Binary::Divide => map(a, b, out, |a, b| a / b),
        Binary::Less => map(a, b, out, |a, b| truth(a < b)),
        Binary::LessEqual => map(a, b, out, |a, b| truth(a <= b)),
        Binary::Greater => map(a, b, out, |a, b| truth(a > b)),
        Binary::GreaterEqual => map(a, b, out, |a, b| truth(a >= b)),
        Binary::Equal => map(a, b, out, |a, b| truth(a == b)),
        Binary::NotEqual => map(a, b, out, |a, b| truth(a != b)),
        Binary::Or | Binary::Max => map(a, b, out, larger),
        Binary::Min => map(a, b, out, |a, b| -larger(-a, -b)),
    }
}

/// The larger of two numbers; NaN if one is NaN, so that it is never hidden.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
