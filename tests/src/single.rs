//! Programs in single precision: evaluated as emitted, and with bounds of what rounding may do.

use gelenk_codegen::formula::Function;
use gelenk_codegen::program::{Operand, Operation, Program};
use gelenk_kernels::math;

/// Unit roundoff of f32.
const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Error of the elementary functions in units of roundoff: their errors stay below 1 ulp.
const LIBRARY: f64 = 2.0;

/// The arithmetic of an evaluation.
trait Arithmetic {
    type Value: Copy;
    fn constant(x: f64) -> Self::Value;
    fn sum(a: Self::Value, b: Self::Value) -> Self::Value;
    fn negative(a: Self::Value) -> Self::Value;
    fn product(a: Self::Value, b: Self::Value) -> Self::Value;
    fn quotient(a: Self::Value, b: Self::Value) -> Self::Value;
    fn multiply_add(a: Self::Value, b: Self::Value, c: Self::Value) -> Self::Value;
    fn call(function: Function, a: Self::Value) -> Self::Value;
}

/// All results of a program in f32 arithmetic, rows first; inputs and parameters must be exact in f32.
pub fn interpret(program: &Program, inputs: &[Vec<f64>], parameters: &[f64]) -> Vec<f64> {
    let results = evaluate::<Plain>(program, inputs, parameters);
    results.into_iter().map(f64::from).collect()
}

/// All results in f64, each with a bound on the error of f32 arithmetic: running error analysis (Higham,
/// Accuracy and Stability of Numerical Algorithms, 2002, section 3.3).
pub fn bounds(program: &Program, inputs: &[Vec<f64>], parameters: &[f64]) -> Vec<Bounded> {
    evaluate::<Bounded>(program, inputs, parameters)
}

struct Plain;

impl Arithmetic for Plain {
    type Value = f32;
    fn constant(x: f64) -> f32 {
        x as f32
    }
    fn sum(a: f32, b: f32) -> f32 {
        a + b
    }
    fn negative(a: f32) -> f32 {
        -a
    }
    fn product(a: f32, b: f32) -> f32 {
        a * b
    }
    fn quotient(a: f32, b: f32) -> f32 {
        a / b
    }
    fn multiply_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }
    fn call(function: Function, x: f32) -> f32 {
        match function {
            Function::Sin => math::sin_cos_f32(x).0,
            Function::Cos => math::sin_cos_f32(x).1,
            Function::Tanh => math::tanh_f32(x),
            Function::Exp => math::exp_f32(x),
            Function::Abs => x.abs(),
            Function::Sign if x == 0.0 => 0.0,
            Function::Sign => x.signum(),
            Function::Sqrt => math::sqrt_f32(x),
        }
    }
}

/// A value in f64, and how far f32 may be from it.
#[derive(Debug, Clone, Copy)]
pub struct Bounded {
    /// The value.
    pub value: f64,
    /// Bound of the error.
    pub error: f64,
}

impl Bounded {
    /// A result with the error of its operands, rounded once more to `units` of roundoff.
    fn rounded(value: f64, error: f64, units: f64) -> Self {
        let rounding = units * ROUNDOFF * (value.abs() + error);
        Self { value, error: error + rounding + f64::from(f32::MIN_POSITIVE) }
    }
}

impl Arithmetic for Bounded {
    type Value = Self;
    fn constant(x: f64) -> Self {
        Self { value: x, error: (x - f64::from(x as f32)).abs() }
    }
    fn sum(a: Self, b: Self) -> Self {
        Self::rounded(a.value + b.value, a.error + b.error, 1.0)
    }
    fn negative(a: Self) -> Self {
        Self { value: -a.value, error: a.error }
    }
    fn product(a: Self, b: Self) -> Self {
        let error = a.value.abs() * b.error + b.value.abs() * a.error + a.error * b.error;
        Self::rounded(a.value * b.value, error, 1.0)
    }
    fn quotient(a: Self, b: Self) -> Self {
        let value = a.value / b.value;
        let least = b.value.abs() - b.error;
        let error = if least > 0.0 { (a.error + value.abs() * b.error) / least } else { f64::INFINITY };
        Self::rounded(value, error, 1.0)
    }
    fn multiply_add(a: Self, b: Self, c: Self) -> Self {
        Self::sum(Self::product(a, b), c)
    }
    fn call(function: Function, a: Self) -> Self {
        let x = a.value;
        match function {
            // Slopes are at most 1.
            Function::Sin => Self::rounded(x.sin(), a.error, LIBRARY),
            Function::Cos => Self::rounded(x.cos(), a.error, LIBRARY),
            Function::Tanh => Self::rounded(x.tanh(), a.error, LIBRARY),
            Function::Exp => Self::rounded(x.exp(), x.exp() * a.error.exp_m1(), LIBRARY),
            Function::Abs => Self { value: x.abs(), error: a.error },
            // The slope is largest at the lower end.
            Function::Sqrt => {
                let low = x - a.error;
                let error = if low > 0.0 { 0.5 * a.error / low.sqrt() } else { f64::INFINITY };
                Self::rounded(x.sqrt(), error, 1.0)
            }
            Function::Sign => Self {
                value: if x == 0.0 { 0.0 } else { x.signum() },
                error: if a.error < x.abs() || a.error == 0.0 { 0.0 } else { 2.0 },
            },
        }
    }
}

fn evaluate<A: Arithmetic>(program: &Program, inputs: &[Vec<f64>], parameters: &[f64]) -> Vec<A::Value> {
    let mut values: Vec<A::Value> = Vec::with_capacity(program.instructions.len());
    let read = |values: &[A::Value], operand: Operand| match operand {
        Operand::Value(index) => values[index],
        Operand::Input(array, index) => A::constant(inputs[array][index]),
        Operand::Parameter(index) => A::constant(parameters[index]),
        Operand::Constant(number) => A::constant(number),
    };
    for instruction in &program.instructions {
        let of = |operand| read(&values, operand);
        let value = match instruction.operation {
            Operation::Add(a, b) => A::sum(of(a), of(b)),
            Operation::Subtract(a, b) => A::sum(of(a), A::negative(of(b))),
            Operation::Multiply(a, b) => A::product(of(a), of(b)),
            Operation::Divide(a, b) => A::quotient(of(a), of(b)),
            Operation::Negate(a) => A::negative(of(a)),
            Operation::MultiplyAdd(a, b, c) => A::multiply_add(of(a), of(b), of(c)),
            Operation::SinCos(a) => A::call(Function::Sin, of(a)),
            Operation::CosineOf(pair) => {
                let Operation::SinCos(a) = program.instructions[pair].operation else {
                    panic!("a cosine of no sine");
                };
                A::call(Function::Cos, of(a))
            }
            Operation::Call(function, a) => A::call(function, of(a)),
        };
        values.push(value);
    }
    let entries = program.outputs.iter().flat_map(|output| &output.entries);
    entries.map(|&entry| read(&values, entry)).collect()
}
