//! The statements of a function: one `let` per instruction.

use std::ops::Range;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::literal::Scalar;
use super::math::Math;
use super::{Context, into, math, names};
use crate::functions::function::Function;
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
    /// Names of the results, where they are written in place.
    pub(super) results: Vec<Ident>,
    /// Name of each value.
    names: Vec<Ident>,
    /// What follows an entry of an input or result: the column of an array.
    pub(super) column: Option<TokenStream>,
    /// Whether each value is an entry of a result that is written in place.
    entries: Vec<bool>,
}

impl<'a> Body<'a> {
    pub(super) fn new(context: &'a Context<'a>, function: &'a Function) -> Self {
        Self::with_results(
            context,
            &function.program,
            into::is_large(&function.program),
        )
    }

    /// With all results written in place.
    pub(super) fn in_place(context: &'a Context<'a>, program: &'a Program) -> Self {
        Self::with_results(context, program, true)
    }

    fn with_results(context: &'a Context<'a>, program: &'a Program, in_place: bool) -> Self {
        let mut taken = context.reserved.clone();
        taken.push("p".to_owned());
        let arguments = names::distinct(
            program.inputs.iter().map(|input| input.name.as_str()),
            &taken,
        );
        taken.extend(arguments.iter().map(ToString::to_string));
        let results = match in_place {
            true => into::result_names(program, &taken),
            false => vec![],
        };
        taken.extend(results.iter().map(ToString::to_string));
        let values = program
            .instructions
            .iter()
            .map(|instruction| instruction.name.as_str());
        let names = names::distinct(values, &taken);
        let flow = Flow::new(program);
        let mut entries = vec![false; program.instructions.len()];
        for entry in program.outputs.iter().flat_map(|output| &output.entries) {
            if let (Operand::Value(value), false) = (entry, results.is_empty()) {
                entries[flow.canonical(*value)] = true;
            }
        }
        Self {
            context,
            scalar: context.options.scalar,
            program,
            flow,
            entries,
            arguments,
            results,
            names,
            column: None,
        }
    }

    /// Name of a value.
    pub(super) fn name(&self, index: usize) -> &Ident {
        &self.names[self.flow.canonical(index)]
    }

    /// Names of all values that the text mentions.
    pub(super) fn value_names(&self) -> impl Iterator<Item = &Ident> {
        self.value_names_in(0..self.names.len())
    }

    /// Names of the values that these instructions define, as far as they are mentioned.
    pub(super) fn value_names_in(&self, range: Range<usize>) -> impl Iterator<Item = &Ident> {
        range
            .filter(|&index| self.flow.is_read[index])
            .map(|index| &self.names[index])
    }

    /// All numbers in the text.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        let results = self
            .program
            .outputs
            .iter()
            .flat_map(|output| output.entries.iter().copied());
        self.numbers_in(0..self.program.instructions.len())
            .chain(results.filter_map(constant))
    }

    /// The numbers in these instructions.
    pub(super) fn numbers_in(&self, range: Range<usize>) -> impl Iterator<Item = f64> {
        self.program.instructions[range]
            .iter()
            .flat_map(|instruction| operands(instruction.operation))
            .filter_map(constant)
    }

    /// From now on statements do not store into the results.
    pub(super) fn stop_storing(&mut self) {
        self.entries.clear();
    }

    /// The statements of a run of instructions.
    pub(super) fn statements(&self, range: Range<usize>) -> Vec<TokenStream> {
        self.statements_among(range, |_| true)
    }

    /// Those statements of a run whose instructions are wanted.
    pub(super) fn statements_among(
        &self,
        range: Range<usize>,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Vec<TokenStream> {
        self.statements_with(range, is_wanted, |index| self.stores(index))
    }

    /// The same, where nothing is stored into the results.
    pub(super) fn statements_without_stores(
        &self,
        range: Range<usize>,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Vec<TokenStream> {
        self.statements_with(range, is_wanted, |_| vec![])
    }

    fn statements_with(
        &self,
        mut range: Range<usize>,
        is_wanted: impl Fn(usize) -> bool,
        stores: impl Fn(usize) -> Vec<TokenStream>,
    ) -> Vec<TokenStream> {
        let is_made = |index: &usize| self.flow.is_made(*index) && is_wanted(*index);
        let made: Vec<usize> = range.by_ref().filter(is_made).collect();
        let mut statements = Vec::with_capacity(made.len());
        let mut rest = made.as_slice();
        while let Some((&first, others)) = rest.split_first() {
            let (angles, after) = rest.split_at(self.leading_angles(rest));
            if angles.len() > 1 {
                statements.extend(self.angles(angles));
                statements.extend(angles.iter().flat_map(|&angle| stores(angle)));
                rest = after;
            } else {
                statements.extend(self.statement(first));
                statements.extend(stores(first));
                rest = others;
            }
        }
        statements
    }

    /// What the results take from a new value, where they are written in place.
    fn stores(&self, index: usize) -> Vec<TokenStream> {
        match self.entries.get(index) {
            Some(true) => into::stores(self, |made| made == Some(index)),
            _ => vec![],
        }
    }

    /// How many of the first instructions make sine and cosine of angles that are known before all of them.
    fn leading_angles(&self, instructions: &[usize]) -> usize {
        let start = instructions.first().copied().unwrap_or(0);
        let is_early = |&&index: &&usize| match self.program.instructions[index].operation {
            Operation::SinCos(Operand::Value(angle)) => self.flow.made_at[angle] < start,
            Operation::SinCos(_) => true,
            Operation::CosineOf(_) => true,
            _ => false,
        };
        match self.context.options.math {
            Math::Embedded => instructions.iter().take_while(is_early).count(),
            Math::Std => 0,
        }
    }

    /// One call for up to eight angles: they become lanes, and angles in registers avoid the way through memory.
    /// Seven angles took 22 ns as one padded call of eight, 31 ns as calls of 4, 2 and 1, 54 ns one by one (AVX2).
    fn angles(&self, instructions: &[usize]) -> Vec<TokenStream> {
        let mut rest: Vec<usize> = instructions.to_vec();
        rest.retain(|&index| {
            matches!(
                self.program.instructions[index].operation,
                Operation::SinCos(_)
            )
        });
        let mut statements = Vec::new();
        while !rest.is_empty() {
            let lanes = match rest.len() {
                1 => 1,
                2 => 2,
                3..=6 => 4,
                _ => 8,
            };
            let batch: Vec<usize> = rest.drain(..lanes.min(rest.len())).collect();
            match batch.as_slice() {
                [angle] => statements.extend(self.statement(*angle)),
                batch => statements.push(self.batch(batch, lanes)),
            }
        }
        statements
    }

    fn batch(&self, batch: &[usize], lanes: usize) -> TokenStream {
        let (sines, cosines): (Vec<_>, Vec<_>) = batch
            .iter()
            .map(|&index| self.sine_and_cosine(index))
            .unzip();
        let angles: Vec<TokenStream> = batch
            .iter()
            .filter_map(|&index| match self.program.instructions[index].operation {
                Operation::SinCos(angle) => Some(self.operand(angle)),
                _ => None,
            })
            .collect();
        let call = math::sin_cos_of(self.context, lanes, &angles);
        let (sines, cosines) = (pattern(sines, lanes), pattern(cosines, lanes));
        quote!(let (#sines, #cosines) = #call;)
    }

    /// The statement of an instruction; `None` where nothing reads its value, or another statement makes it.
    fn statement(&self, index: usize) -> Option<TokenStream> {
        if !self.flow.is_made(index) {
            return None;
        }
        let operation = self.program.instructions[index].operation;
        let value = self.expression(operation)?;
        let Operation::SinCos(_) = operation else {
            let name = &self.names[index];
            return Some(quote!(let #name = #value;));
        };
        let (sine, cosine) = self.sine_and_cosine(index);
        let (sine, cosine) = (or_nothing(sine), or_nothing(cosine));
        Some(quote!(let (#sine, #cosine) = #value;))
    }

    /// Names for what a `SinCos` makes, where it is read.
    fn sine_and_cosine(&self, index: usize) -> (Option<&Ident>, Option<&Ident>) {
        (
            self.flow.is_read[index].then(|| &self.names[index]),
            self.flow.cosine[index].map(|cosine| &self.names[cosine]),
        )
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
            Operation::SinCos(a) => {
                math::sin_cos(self.context, &self.receiver(a), &self.operand(a))
            }
            Operation::CosineOf(_) => return None,
            Operation::Call(function, a) => {
                math::call(self.context, function, &self.receiver(a), &self.operand(a))
            }
        })
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
                let column = &self.column;
                quote!(#name[#index]#column)
            }
            Operand::Parameter(index) => {
                let field = &self.context.parameters[index];
                quote!(p.#field)
            }
            Operand::Constant(number) => self.scalar.literal(number),
        }
    }

    /// An operand of one state, where inputs are arrays of lanes.
    pub(super) fn operand_in_lane(&self, operand: Operand) -> TokenStream {
        let value = self.operand(operand);
        match operand {
            Operand::Input(..) => quote!(#value.0[W * group + lane]),
            _ => value,
        }
    }

    /// Statements of sums, differences and the like where inputs are arrays of lanes.
    pub(super) fn statements_in_lane(
        &self,
        instructions: impl Iterator<Item = usize>,
    ) -> Vec<TokenStream> {
        let made = instructions.filter_map(|index| {
            let lane = |operand| self.operand_in_lane(operand);
            let value = match self.program.instructions[index].operation {
                Operation::Add(a, b) => binary(lane(a), quote!(+), lane(b)),
                Operation::Subtract(a, b) => binary(lane(a), quote!(-), lane(b)),
                Operation::Multiply(a, b) => binary(lane(a), quote!(*), lane(b)),
                Operation::Divide(a, b) => binary(lane(a), quote!(/), lane(b)),
                Operation::Negate(a) => {
                    let a = lane(a);
                    quote!(-#a)
                }
                Operation::MultiplyAdd(a, b, c) => {
                    let (a, b, c) = (lane(a), lane(b), lane(c));
                    quote!(#a.mul_add(#b, #c))
                }
                _ => return None,
            };
            let name = &self.names[index];
            Some(quote!(let #name = #value;))
        });
        made.collect()
    }

    /// An operand that a method is called on.
    fn receiver(&self, operand: Operand) -> TokenStream {
        match operand {
            Operand::Constant(number) => self.scalar.receiver(number),
            _ => self.operand(operand),
        }
    }

    /// The results as one expression: a value, or a tuple of several.
    pub(super) fn returned(&self) -> TokenStream {
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
                let rows = (0..rows.len).map(|row| {
                    let row = &entries[row * columns.len..(row + 1) * columns.len];
                    quote!([#(#row),*])
                });
                quote!([#(#rows),*])
            }
        }
    }
}

fn binary(a: TokenStream, operator: TokenStream, b: TokenStream) -> TokenStream {
    quote!(#a #operator #b)
}

fn or_nothing(name: Option<&Ident>) -> TokenStream {
    name.map_or_else(|| quote!(_), |name| quote!(#name))
}

/// An array pattern of `len` entries; what is not read at its end is not named.
fn pattern(mut names: Vec<Option<&Ident>>, len: usize) -> TokenStream {
    while names.last().is_some_and(Option::is_none) {
        names.pop();
    }
    let rest = (names.len() < len).then(|| quote!(..));
    let names = names.into_iter().map(or_nothing).chain(rest);
    quote!([#(#names),*])
}

fn constant(operand: Operand) -> Option<f64> {
    match operand {
        Operand::Constant(number) => Some(number),
        _ => None,
    }
}
