//! The operations of a program over blocks of samples.

use crate::kernel::{exp_block, sin_block, tanh_block};
use gelenk_formula::{Function, Operator, Unary};
use multiversion::multiversion;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    Constant(f64),
    Channel(usize),
    Unary(Unary, usize),
    Power(usize, u32),
    Binary(Operator, usize, usize),
}

pub(super) fn power(a: &[f64], exponent: u32, out: &mut [f64]) {
    for (o, a) in out.iter_mut().zip(a) {
        *o = a.powi(exponent as i32); // at most 16
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
        Unary::Logarithm => map(f64::ln, out),
        Unary::Call(Function::Abs) => map(f64::abs, out),
        Unary::Call(Function::Sign) => map(sign, out),
        Unary::Call(Function::Sqrt) => map(f64::sqrt, out),
        Unary::Call(Function::Exp) => exp_block(a, out),
        Unary::Call(Function::Sin) => sin_block(a, out),
        Unary::Call(Function::Cos) => map(f64::cos, out),
        Unary::Call(Function::Tanh) => tanh_block(a, out),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2+fma"))]
pub(super) fn binary(f: Operator, a: &[f64], b: &[f64], out: &mut [f64]) {
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
        Operator::Add => map(a, b, out, |a, b| a + b),
        Operator::Subtract => map(a, b, out, |a, b| a - b),
        Operator::Multiply | Operator::And => map(a, b, out, |a, b| a * b),
        Operator::Divide => map(a, b, out, |a, b| a / b),
        Operator::Less => map(a, b, out, |a, b| truth(a < b)),
        Operator::LessEqual => map(a, b, out, |a, b| truth(a <= b)),
        Operator::Greater => map(a, b, out, |a, b| truth(a > b)),
        Operator::GreaterEqual => map(a, b, out, |a, b| truth(a >= b)),
        Operator::Equal => map(a, b, out, |a, b| truth(a == b)),
        Operator::NotEqual => map(a, b, out, |a, b| truth(a != b)),
        Operator::Or | Operator::Max => map(a, b, out, larger),
        Operator::Min => map(a, b, out, |a, b| -larger(-a, -b)),
    }
}

/// The larger of two numbers; NaN if one is NaN, so that it is never hidden.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
