//! Programs evaluated with dual numbers: exact derivatives of what was derived.

use gelenk_codegen::formula::Function;
use gelenk_codegen::program::{Operand, Operation, Program};
use num_dual::DualNum;

/// Numbers that carry derivatives, or plain ones.
pub trait Number: DualNum<Primitive = f64> + Copy {}
impl<T: DualNum<Primitive = f64> + Copy> Number for T {}

/// Results of a program, each flattened rows first.
pub fn evaluate<T: Number>(program: &Program, inputs: &[&[T]], parameters: &[f64]) -> Vec<Vec<T>> {
    let mut values: Vec<T> = Vec::with_capacity(program.instructions.len());
    // The cosine of each sine, by instruction.
    let mut cosines: Vec<Option<T>> = vec![None; program.instructions.len()];
    let read = |values: &[T], operand: Operand| match operand {
        Operand::Value(index) => values[index],
        Operand::Input(array, index) => inputs[array][index],
        Operand::Parameter(index) => T::from(parameters[index]),
        Operand::Constant(number) => T::from(number),
    };
    for (index, instruction) in program.instructions.iter().enumerate() {
        let of = |operand| read(&values, operand);
        let value = match instruction.operation {
            Operation::Add(a, b) => of(a) + of(b),
            Operation::Subtract(a, b) => of(a) - of(b),
            Operation::Multiply(a, b) => of(a) * of(b),
            Operation::Divide(a, b) => of(a) / of(b),
            Operation::Negate(a) => -of(a),
            Operation::MultiplyAdd(a, b, c) => of(a) * of(b) + of(c),
            Operation::SinCos(a) => {
                let (sine, cosine) = of(a).sin_cos();
                cosines[index] = Some(cosine);
                sine
            }
            Operation::CosineOf(pair) => cosines[pair].unwrap_or_else(|| panic!("a cosine follows its sine")),
            Operation::Call(function, a) => call(function, of(a)),
        };
        values.push(value);
    }
    let output = |entries: &[Operand]| entries.iter().map(|&entry| read(&values, entry)).collect();
    program.outputs.iter().map(|result| output(&result.entries)).collect()
}

/// Value of an elementary function.
pub fn call<T: Number>(function: Function, x: T) -> T {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tanh => x.tanh(),
        Function::Exp => x.exp(),
        Function::Abs => x.abs(),
        Function::Sqrt => x.sqrt(),
        Function::Sign if x.re() == 0.0 => T::from(0.0),
        Function::Sign => T::from(x.re().signum()),
    }
}
