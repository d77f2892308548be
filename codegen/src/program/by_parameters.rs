//! Derivatives of a program with respect to the free parameters.

use super::{GraphOutput, InputArray, Operand, Operation, Output, Program, Shape, lower};
use crate::graph::{Graph, Scalar, differentiate};
use crate::layout::{Dimension, Extent};
use gelenk_formula::Function;

/// Returns a program that computes the derivatives of all results with respect to the free parameters. Each
/// result becomes a matrix with one row per entry (row-major) and one column per parameter.
///
/// The derivative of `sign` is 0.
#[must_use]
pub fn by_parameters(program: &Program, parameters: usize) -> Program {
    let graph = Graph::new();
    let values = values(&graph, program);
    let operand = |operand: Operand| of(&graph, &values, operand);
    let outputs = program.outputs.iter();
    let entries: Vec<Scalar<'_>> =
        outputs.flat_map(|output| output.entries.iter().map(|&entry| operand(entry))).collect();
    let columns: Vec<Vec<Scalar<'_>>> = (0..parameters)
        .map(|parameter| differentiate(&graph, &entries, graph.parameter(parameter)))
        .collect();
    let mut start = 0;
    let outputs: Vec<GraphOutput> = program
        .outputs
        .iter()
        .map(|output| {
            let rows = start..start + output.entries.len();
            start = rows.end;
            let entries = rows.flat_map(|row| columns.iter().map(move |column| column[row].edge()));
            GraphOutput {
                name: format!("∂{}/∂p", output.name),
                shape: shape(output, parameters),
                entries: entries.collect(),
            }
        })
        .collect();
    let inputs: Vec<InputArray> = program.inputs.clone();
    lower(&graph, inputs, &outputs)
}

fn shape(output: &Output, parameters: usize) -> Shape {
    let rows = match output.shape {
        Shape::Vector(extent) => extent,
        Shape::Scalar | Shape::Matrix(..) => Extent::fixed(output.entries.len()),
    };
    Shape::Matrix(rows, Extent::new(Dimension::Parameters, parameters))
}

/// Converts all values of a program to scalars of a graph.
fn values<'g>(graph: &'g Graph, program: &Program) -> Vec<Scalar<'g>> {
    let mut values: Vec<Scalar<'g>> = Vec::with_capacity(program.instructions.len());
    for instruction in &program.instructions {
        let operand = |operand: Operand| of(graph, &values, operand);
        let value = match instruction.operation {
            Operation::Add(a, b) => operand(a) + operand(b),
            Operation::Subtract(a, b) => operand(a) - operand(b),
            Operation::Multiply(a, b) => operand(a) * operand(b),
            Operation::Divide(a, b) => operand(a).divided_by(operand(b)),
            Operation::Negate(a) => -operand(a),
            Operation::MultiplyAdd(a, b, c) => operand(a) * operand(b) + operand(c),
            Operation::SinCos(a) => operand(a).call(Function::Sin),
            Operation::CosineOf(pair) => angle(graph, &values, program, pair).call(Function::Cos),
            Operation::Call(function, a) => operand(a).call(function),
        };
        values.push(value);
    }
    values
}

/// The angle whose sine and cosine an instruction computes.
fn angle<'g>(graph: &'g Graph, values: &[Scalar<'g>], program: &Program, pair: usize) -> Scalar<'g> {
    match program.instructions[pair].operation {
        Operation::SinCos(a) => of(graph, values, a),
        other => unreachable!("a cosine belongs to the call that makes it, not to {other:?}"),
    }
}

fn of<'g>(graph: &'g Graph, values: &[Scalar<'g>], operand: Operand) -> Scalar<'g> {
    match operand {
        Operand::Value(index) => values[index],
        Operand::Input(array, index) => graph.input(array, index),
        Operand::Parameter(index) => graph.parameter(index),
        Operand::Constant(number) => graph.constant(number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::interpret::interpret;
    use crate::program::{Instruction, fuse_multiply_adds};

    /// Every operation that a program can hold, over x and two parameters.
    fn program() -> Program {
        use Operand::{Constant, Input, Parameter, Value};
        let (x, p, q) = (Input(0, 0), Parameter(0), Parameter(1));
        let operations = [
            Operation::Multiply(x, p),
            Operation::SinCos(Value(0)),
            Operation::CosineOf(1),
            Operation::Subtract(Value(1), q),
            Operation::Divide(Value(3), p),
            Operation::Negate(Value(4)),
            Operation::MultiplyAdd(Value(2), q, Value(5)),
            Operation::Call(Function::Tanh, Value(6)),
            Operation::Add(Value(7), Constant(2.0)),
            Operation::Call(Function::Sqrt, Value(8)),
        ];
        let instructions = operations.into_iter().enumerate();
        let instructions =
            instructions.map(|(index, operation)| Instruction { name: format!("t{index}"), operation });
        let vector = Shape::Vector(Extent::new(Dimension::Velocities, 3));
        let outputs = [("f", Shape::Scalar, vec![Value(9)]), ("g", vector, vec![Value(6), x, Value(2)])];
        let outputs = outputs.map(|(name, shape, entries)| Output { name: name.to_owned(), shape, entries });
        Program {
            inputs: vec![InputArray { name: "x".to_owned(), extent: Extent::fixed(1) }],
            instructions: instructions.collect(),
            outputs: outputs.to_vec(),
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let evaluate = |program: &Program, p: [f64; 2]| interpret(program, &[&[0.7]], &p).unwrap().concat();
        let (at, h) = ([0.8, -0.4], 1e-6);
        let plain = program();
        for program in [fuse_multiply_adds(&plain), plain] {
            let derivatives = by_parameters(&program, 2);
            let found = evaluate(&derivatives, at);
            assert_eq!(found.len(), 8);
            for parameter in 0..2 {
                let moved = |by: f64| {
                    let mut p = at;
                    p[parameter] += by;
                    evaluate(&program, p)
                };
                for (row, (high, low)) in moved(h).iter().zip(moved(-h)).enumerate() {
                    let (found, expected) = (found[2 * row + parameter], (high - low) / (2.0 * h));
                    assert!((found - expected).abs() < 1e-9, "{row}, {parameter}: {found} is not {expected}");
                }
            }
            // The entry that is the input itself.
            assert_eq!(found[4..6], [0.0, 0.0]);
            let shapes = derivatives
                .outputs
                .iter()
                .map(|output| output.shape.extents().iter().map(|extent| extent.len).collect::<Vec<_>>());
            assert_eq!(shapes.collect::<Vec<_>>(), [vec![1, 2], vec![3, 2]]);
        }
    }
}
