//! The statements of a function: one `let` per instruction.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::literal::Scalar;
use super::{Context, math, names};
use crate::dynamics::function::Function;
use crate::program::flow::{Flow, operands};
use crate::program::{Operand, Operation, Output, Program, Shape};

/// Prints the parts of one function's body.
pub(super) struct Body<'a> {
    context: &'a Context<'a>,
    scalar: Scalar,
    pub(super) program: &'a Program,
    pub(super) flow: Flow,
    /// Names of the input arrays.
    pub(super) arguments: Vec<Ident>,
    /// Name of each value.
    names: Vec<Ident>,
}

impl<'a> Body<'a> {
    pub(super) fn new(context: &'a Context<'a>, function: &'a Function) -> Self {
        let program = &function.program;
        let mut taken = context.reserved.clone();
        taken.push("p".to_owned());
        let arguments = names::distinct(
            program.inputs.iter().map(|input| input.name.as_str()),
            &taken,
        );
        taken.extend(arguments.iter().map(ToString::to_string));
        let values = program
            .instructions
            .iter()
            .map(|instruction| instruction.name.as_str());
        let names = names::distinct(values, &taken);
        Self {
            context,
            scalar: context.options.scalar,
            program,
            flow: Flow::new(program),
            arguments,
            names,
        }
    }

    /// Name of a value.
    pub(super) fn name(&self, index: usize) -> &Ident {
        &self.names[self.flow.canonical(index)]
    }

    /// Names of all values that the text mentions.
    pub(super) fn value_names(&self) -> impl Iterator<Item = &Ident> {
        (0..self.names.len())
            .filter(|&index| self.flow.is_read[index])
            .map(|index| &self.names[index])
    }

    /// All numbers in the text.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        let read = self
            .program
            .instructions
            .iter()
            .flat_map(|instruction| operands(instruction.operation));
        let results = self
            .program
            .outputs
            .iter()
            .flat_map(|output| output.entries.iter().copied());
        read.chain(results).filter_map(|operand| match operand {
            Operand::Constant(number) => Some(number),
            _ => None,
        })
    }

    /// The statement of an instruction; `None` where nothing reads its value, or another statement makes it.
    pub(super) fn statement(&self, index: usize) -> Option<TokenStream> {
        if !self.flow.is_made(index) {
            return None;
        }
        let operation = self.program.instructions[index].operation;
        let value = self.expression(operation)?;
        let Operation::SinCos(_) = operation else {
            let name = &self.names[index];
            return Some(quote!(let #name = #value;));
        };
        let or_nothing =
            |name: Option<&Ident>| name.map_or_else(|| quote!(_), |name| quote!(#name));
        let sine = or_nothing(self.flow.is_read[index].then(|| &self.names[index]));
        let cosine = or_nothing(self.flow.cosine[index].map(|cosine| &self.names[cosine]));
        Some(quote!(let (#sine, #cosine) = #value;))
    }

    /// The right-hand side of an instruction; `None` for the cosine of a pair.
    pub(super) fn expression(&self, operation: Operation) -> Option<TokenStream> {
        // Two bare literals would leave the number type open for a method called on the value.
        let binary = |a, b| match b {
            Operand::Constant(_) => (self.receiver(a), self.operand(b)),
            _ => (self.operand(a), self.operand(b)),
        };
        Some(match operation {
            Operation::Add(a, b) => {
                let (a, b) = binary(a, b);
                quote!(#a + #b)
            }
            Operation::Subtract(a, b) => {
                let (a, b) = binary(a, b);
                quote!(#a - #b)
            }
            Operation::Multiply(a, b) => {
                let (a, b) = binary(a, b);
                quote!(#a * #b)
            }
            Operation::Divide(a, b) => {
                let (a, b) = binary(a, b);
                quote!(#a / #b)
            }
            Operation::Negate(a) => self.negated(a),
            Operation::MultiplyAdd(a, b, c) => {
                let (a, b, c) = (self.receiver(a), self.operand(b), self.operand(c));
                quote!(#a.mul_add(#b, #c))
            }
            Operation::SinCos(a) => self.call("sin_cos", a),
            Operation::CosineOf(_) => return None,
            Operation::Call(crate::formula::Function::Sign, a) => {
                let a = self.operand(a);
                quote!(sign(#a))
            }
            Operation::Call(function, a) => self.call(math::function_name(function), a),
        })
    }

    fn call(&self, name: &str, argument: Operand) -> TokenStream {
        math::call(
            self.context.options,
            name,
            &self.receiver(argument),
            &self.operand(argument),
        )
    }

    fn negated(&self, operand: Operand) -> TokenStream {
        match operand {
            Operand::Constant(number) => self.scalar.typed(-number),
            _ => {
                let operand = self.operand(operand);
                quote!(-#operand)
            }
        }
    }

    /// An operand of an operator, an argument or an entry of a result.
    pub(super) fn operand(&self, operand: Operand) -> TokenStream {
        match operand {
            Operand::Value(index) => {
                let name = self.name(index);
                quote!(#name)
            }
            Operand::Input(array, index) => {
                let (name, index) = (&self.arguments[array], Literal::usize_unsuffixed(index));
                quote!(#name[#index])
            }
            Operand::Parameter(index) => {
                let field = &self.context.parameters[index];
                quote!(p.#field)
            }
            Operand::Constant(number) => self.scalar.literal(number),
        }
    }

    /// An operand that a method is called on.
    fn receiver(&self, operand: Operand) -> TokenStream {
        match operand {
            Operand::Constant(number) => self.scalar.receiver(number),
            _ => self.operand(operand),
        }
    }

    /// The results as one expression: a value, or a tuple of several.
    pub(super) fn results(&self) -> TokenStream {
        let outputs = self
            .program
            .outputs
            .iter()
            .map(|output| self.result(output));
        match self.program.outputs.len() {
            1 => quote!(#(#outputs)*),
            _ => quote!((#(#outputs),*)),
        }
    }

    fn result(&self, output: &Output) -> TokenStream {
        let mut entries = output.entries.iter().map(|&entry| self.operand(entry));
        match output.shape {
            Shape::Scalar => entries.next().unwrap_or_else(|| self.scalar.literal(0.0)),
            Shape::Vector(_) => quote!([#(#entries),*]),
            Shape::Matrix(rows, columns) => {
                let entries: Vec<TokenStream> = entries.collect();
                let rows = (0..rows).map(|row| {
                    let row = &entries[row * columns..(row + 1) * columns];
                    quote!([#(#row),*])
                });
                quote!([#(#rows),*])
            }
        }
    }
}
