//! Optional contraction of products and sums to fused multiply-adds, which needs fewer instructions but
//! changes the last bits of results.
//!
//! The generator contracts, and not the compiler, so the interpreter and the compiled function agree bit for
//! bit. Each fused operation avoids one rounding. Results therefore differ from results without contraction
//! only by the roundings of the fused products.

use std::collections::BTreeSet;

use super::flow::operands;
use super::{Instruction, Operand, Operation, Output, Program};
use crate::distinct::Distinct;

/// Fuses products that are used only by sums and differences. Each of these sums and differences becomes
/// `a · b + c` with one rounding.
///
/// If a sum has two products, the product that is available later is fused, because this shortens the longest
/// chain. A product with other users is not fused, because its multiplication would still be needed.
#[must_use]
pub fn fuse_multiply_adds(program: &Program) -> Program {
    let fused = choose(program);
    let mut rewriting = Rewriting {
        places: vec![Operand::Constant(0.0); program.instructions.len()],
        instructions: Vec::with_capacity(program.instructions.len()),
        negatives: Vec::new(),
        negative_inputs: Vec::new(),
        names: program
            .instructions
            .iter()
            .map(|instruction| instruction.name.clone())
            .chain(program.inputs.iter().map(|input| input.name.clone()))
            .collect(),
    };
    let is_product = products_of(&fused, program.instructions.len());
    for (index, instruction) in program.instructions.iter().enumerate() {
        if is_product[index] {
            continue;
        }
        rewriting.rewrite(program, index, instruction, fused[index]);
    }
    let outputs = program.outputs.iter().map(|output| Output {
        entries: output.entries.iter().map(|&entry| rewriting.place(entry)).collect(),
        ..output.clone()
    });
    Program {
        inputs: program.inputs.clone(),
        outputs: outputs.collect(),
        instructions: rewriting.instructions,
    }
}

/// For each sum, the product that is fused with it; `None` if there is no such product.
fn choose(program: &Program) -> Vec<Option<usize>> {
    let count = program.instructions.len();
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (index, instruction) in program.instructions.iter().enumerate() {
        for operand in operands(instruction.operation) {
            if let Operand::Value(value) = operand {
                readers[value].push(index);
            }
        }
    }
    let results: BTreeSet<usize> = program
        .outputs
        .iter()
        .flat_map(|output| &output.entries)
        .filter_map(|entry| match entry {
            Operand::Value(value) => Some(*value),
            _ => None,
        })
        .collect();
    let depths = depths(program);
    let is_multiply =
        |index: &usize| matches!(program.instructions[*index].operation, Operation::Multiply(..));
    let mut products: Vec<usize> = (0..count).filter(is_multiply).collect();
    products.sort_by_key(|&product| (std::cmp::Reverse(depths[product]), product));
    let mut fused: Vec<Option<usize>> = vec![None; count];
    for product in products {
        let is_fusible = |&reader: &usize| {
            let sum = program.instructions[reader].operation;
            // In `x · y + x · y`, the product cannot be fused with both operands.
            let is_sum = matches!(sum, Operation::Add(a, b) | Operation::Subtract(a, b) if a != b);
            is_sum && fused[reader].is_none()
        };
        if !results.contains(&product) && readers[product].iter().all(is_fusible) {
            for &reader in &readers[product] {
                fused[reader] = Some(product);
            }
        }
    }
    fused
}

/// Length of the longest chain of operations that leads to each value.
fn depths(program: &Program) -> Vec<usize> {
    let mut depths: Vec<usize> = Vec::with_capacity(program.instructions.len());
    for instruction in &program.instructions {
        let below = operands(instruction.operation).map(|operand| match operand {
            Operand::Value(value) => depths[value],
            _ => 0,
        });
        let below = match instruction.operation {
            Operation::CosineOf(pair) => depths[pair],
            _ => below.max().unwrap_or(0) + 1,
        };
        depths.push(below);
    }
    depths
}

fn products_of(fused: &[Option<usize>], count: usize) -> Vec<bool> {
    let mut is_product = vec![false; count];
    for &product in fused.iter().flatten() {
        is_product[product] = true;
    }
    is_product
}

struct Rewriting {
    /// For each value of the old program, the operand that replaces it in the new program.
    places: Vec<Operand>,
    instructions: Vec<Instruction>,
    /// Negative of each value of the new program; `None` if no operation needed it.
    negatives: Vec<Option<Operand>>,
    /// Negatives of inputs and parameters that operations needed.
    negative_inputs: Vec<(Operand, Operand)>,
    names: Distinct,
}

impl Rewriting {
    fn place(&self, operand: Operand) -> Operand {
        match operand {
            Operand::Value(value) => self.places[value],
            other => other,
        }
    }

    fn rewrite(
        &mut self,
        program: &Program,
        index: usize,
        instruction: &Instruction,
        product: Option<usize>,
    ) {
        let product = product.map(|product| (product, program.instructions[product].operation));
        let operation = match (product, instruction.operation) {
            (Some((product, Operation::Multiply(a, b))), Operation::Add(x, y)) => {
                let addend = if x == Operand::Value(product) { y } else { x };
                Operation::MultiplyAdd(self.place(a), self.place(b), self.place(addend))
            }
            (Some((product, Operation::Multiply(a, b))), Operation::Subtract(x, y)) => {
                let (a, b) = (self.place(a), self.place(b));
                if x == Operand::Value(product) {
                    let addend = self.place(y);
                    Operation::MultiplyAdd(a, b, self.negative(addend))
                } else {
                    Operation::MultiplyAdd(self.negative(a), b, self.place(x))
                }
            }
            (_, Operation::CosineOf(pair)) => match self.places[pair] {
                Operand::Value(pair) => Operation::CosineOf(pair),
                _ => instruction.operation,
            },
            (_, operation) => operation.map(|operand| self.place(operand)),
        };
        self.places[index] = self.push(instruction.name.clone(), operation);
    }

    /// Negative of an operand of a fused operation. The negation is free, because processors support all
    /// combinations of signs.
    fn negative(&mut self, operand: Operand) -> Operand {
        let stem = match operand {
            Operand::Constant(number) => return Operand::Constant(-number),
            Operand::Value(value) => match self.instructions[value].operation {
                Operation::Negate(positive) => return positive,
                _ => format!("minus_{}", self.instructions[value].name),
            },
            Operand::Input(array, entry) => format!("minus_{array}_{entry}"),
            Operand::Parameter(index) => format!("minus_p_{index}"),
        };
        if let Some(negative) = self.known_negative(operand) {
            return negative;
        }
        let name = self.names.take(&stem);
        let negative = self.push(name, Operation::Negate(operand));
        match operand {
            Operand::Value(value) => self.negatives[value] = Some(negative),
            _ => self.negative_inputs.push((operand, negative)),
        }
        negative
    }

    fn known_negative(&self, operand: Operand) -> Option<Operand> {
        match operand {
            Operand::Value(value) => self.negatives[value],
            _ => {
                let mut known = self.negative_inputs.iter();
                known.find(|(positive, _)| *positive == operand).map(|(_, negative)| *negative)
            }
        }
    }

    fn push(&mut self, name: String, operation: Operation) -> Operand {
        self.instructions.push(Instruction { name, operation });
        self.negatives.push(None);
        Operand::Value(self.instructions.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Extent;
    use crate::program::cost::count;
    use crate::program::interpret::interpret;
    use crate::program::{InputArray, Shape};

    /// `r = (x y + z, x − y z, x y z − x)` with `x y` read twice.
    fn program() -> Program {
        let input = |index| Operand::Input(0, index);
        let (x, y, z, value) = (input(0), input(1), input(2), Operand::Value);
        let operations = [
            Operation::Multiply(x, y),
            Operation::Add(z, value(0)),
            Operation::Multiply(y, z),
            Operation::Subtract(x, value(2)),
            Operation::Multiply(value(0), z),
            Operation::Subtract(value(4), x),
        ];
        Program {
            inputs: vec![InputArray { name: "y".into(), extent: Extent::fixed(3) }],
            instructions: operations
                .into_iter()
                .enumerate()
                .map(|(i, operation)| Instruction { name: format!("t{i}"), operation })
                .collect(),
            outputs: vec![Output {
                name: "r".into(),
                shape: Shape::Vector(Extent::fixed(3)),
                entries: vec![value(1), value(3), value(5)],
            }],
        }
    }

    #[test]
    fn products_that_only_sums_read_are_fused() {
        let fused = fuse_multiply_adds(&program());
        let multiplied = |program: &Program| {
            let is_multiply = |i: &&Instruction| matches!(i.operation, Operation::Multiply(..));
            program.instructions.iter().filter(is_multiply).count()
        };
        // x y stays, since x y z reads it too.
        assert_eq!((multiplied(&program()), multiplied(&fused)), (3, 1));
        assert_eq!(count(&fused).additions, 3);
    }

    #[test]
    fn fused_results_are_the_rounded_exact_ones() {
        let x = [1.0 + f64::EPSILON, 1.0 - f64::EPSILON, 3.0];
        let fused = fuse_multiply_adds(&program());
        let result = interpret(&fused, &[&x], &[]).unwrap();
        assert_eq!(result[0][1], (-x[1]).mul_add(x[2], x[0]));
        assert_eq!(result[0][2], (x[0] * x[1]).mul_add(x[2], -x[0]));
        assert_eq!(result[0][0], x[0] * x[1] + x[2]);
    }
}
