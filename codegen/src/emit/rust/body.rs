//! Names of the values of a printed function, and tokens of operands and results.

use std::ops::Range;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::context::Context;
use super::names;
use crate::program::flow::{Flow, operands};
use crate::program::{Operand, Operation, Output, Program, Shape};

/// The program of a printed function with the names of its values.
#[derive(Clone)]
pub(super) struct Body<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) program: &'a Program,
    pub(super) flow: Flow,
    /// Names of the function's input arrays.
    pub(super) arguments: Vec<Ident>,
    /// Names of the arguments that receive results; empty if the function returns its results.
    pub(super) results: Vec<Ident>,
    /// Name of the variable for each value.
    pub(super) names: Vec<Ident>,
    /// Tokens of an additional index after each entry of an input or result. The index is the column of an
    /// array over joints, or the number of the state.
    pub(super) column: Option<TokenStream>,
    /// Whether each value is an entry of a result that is written in place.
    stored: Vec<bool>,
}

impl<'a> Body<'a> {
    /// Creates a body that writes large results in place and returns small results.
    pub(super) fn new(context: &'a Context<'a>, program: &'a Program) -> Self {
        Self::with_results(context, program, program.has_large_results())
    }

    /// Creates a body that writes all results in place.
    pub(super) fn in_place(context: &'a Context<'a>, program: &'a Program) -> Self {
        Self::with_results(context, program, true)
    }

    fn with_results(context: &'a Context<'a>, program: &'a Program, in_place: bool) -> Self {
        let names = names::SPELLING.of_program(program, &context.reserved, in_place);
        let mut body = Self {
            context,
            program,
            flow: Flow::new(program),
            arguments: names::idents(&names.arguments),
            results: names::idents(&names.results),
            stored: vec![false; names.values.len()],
            names: names::idents(&names.values),
            column: None,
        };
        for entry in program.entries().filter(|_| in_place) {
            if let Some(made) = body.made(entry) {
                body.stored[made] = true;
            }
        }
        body
    }

    /// This body, but without the statements that write results.
    pub(super) fn without_stores(&self) -> Self {
        Self { stored: vec![], ..self.clone() }
    }

    /// This body without the statements that write results, and with `column` as additional index after each
    /// entry.
    pub(super) fn with_column(&self, column: TokenStream) -> Self {
        Self { column: Some(column), ..self.without_stores() }
    }

    /// Variable name of the value with this index.
    pub(super) fn name(&self, index: usize) -> &Ident {
        &self.names[self.flow.canonical(index)]
    }

    /// Names of all values that occur in the text.
    pub(super) fn value_names(&self) -> impl Iterator<Item = &Ident> {
        self.value_names_in(0..self.names.len())
    }

    /// Names of the values of these instructions that occur in the text.
    pub(super) fn value_names_in(&self, range: Range<usize>) -> impl Iterator<Item = &Ident> {
        range.filter(|&index| self.flow.is_read[index]).map(|index| &self.names[index])
    }

    /// All numbers that occur in the text of the function.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.numbers_in(0..self.program.instructions.len()).chain(self.program.entries().filter_map(constant))
    }

    /// All numbers that occur in the text of these instructions.
    pub(super) fn numbers_in(&self, range: Range<usize>) -> impl Iterator<Item = f64> {
        self.program.instructions[range]
            .iter()
            .flat_map(|instruction| operands(instruction.operation))
            .filter_map(constant)
    }

    /// Tokens of an operand, for an operator, an argument, or the entry of a result.
    pub(super) fn operand(&self, operand: Operand) -> TokenStream {
        match operand {
            Operand::Value(index) => {
                let name = self.name(index);
                quote!(#name)
            }
            Operand::Input(array, index) => {
                let (name, column) = (&self.arguments[array], &self.column);
                let number = Literal::usize_unsuffixed;
                match self.program.inputs[array].extent.row() {
                    Some(row) => {
                        let (row, entry) = (number(index / row), number(index % row));
                        quote!(#name[#row][#entry]#column)
                    }
                    None => {
                        let index = number(index);
                        quote!(#name[#index]#column)
                    }
                }
            }
            Operand::Parameter(index) => {
                let field = &self.context.parameters[index];
                quote!(p.#field)
            }
            Operand::Constant(number) => self.context.options.scalar.literal(number),
        }
    }

    /// Index of the value to which an operand refers; `None` if the operand is not a value.
    pub(super) fn made(&self, entry: Operand) -> Option<usize> {
        match entry {
            Operand::Value(made) => Some(self.flow.canonical(made)),
            _ => None,
        }
    }

    /// Statements that write all result entries for which `is_wanted` is true.
    pub(super) fn stores(&self, is_wanted: impl Fn(Operand) -> bool) -> Vec<TokenStream> {
        let mut stores = Vec::new();
        for (output, name) in self.program.outputs.iter().zip(&self.results) {
            let entries = output.entries.iter().copied().enumerate();
            for (index, entry) in entries.filter(|&(_, entry)| is_wanted(entry)) {
                let (place, entry) = (place(output, name, index), self.operand(entry));
                let star = matches!(output.shape, Shape::Scalar).then(|| quote!(*));
                let column = &self.column;
                stores.push(quote!(#star #place #column = #entry;));
            }
        }
        stores
    }

    /// Statements that write the value with this index to results in place.
    pub(super) fn stores_of(&self, index: usize) -> Vec<TokenStream> {
        match self.stored.get(index) {
            Some(true) => self.stores(|entry| self.made(entry) == Some(index)),
            _ => vec![],
        }
    }

    /// The returned results as an expression: a value, or a tuple of several values.
    pub(super) fn returned(&self) -> TokenStream {
        let outputs = self.program.outputs.iter();
        tuple(outputs.map(|output| self.result(output)))
    }

    fn result(&self, output: &Output) -> TokenStream {
        let mut entries = output.entries.iter().map(|&entry| self.operand(entry));
        match output.shape {
            Shape::Scalar => entries.next().unwrap_or_else(|| self.context.zero()),
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

    /// Index of the last value if it is the only result. This value needs no name, as clippy's lint
    /// `let_and_return` requires.
    pub(super) fn returned_value(&self) -> Option<usize> {
        let [output] = self.program.outputs.as_slice() else {
            return None;
        };
        let (Shape::Scalar, [Operand::Value(index)]) = (output.shape, output.entries.as_slice()) else {
            return None;
        };
        let instructions = &self.program.instructions;
        let last = (0..instructions.len()).rev().find(|&index| self.flow.is_made(index))?;
        let is_pair = matches!(instructions[last].operation, Operation::SinCos(_));
        (last == *index && !is_pair).then_some(last)
    }
}

/// Tokens of one value, or of a tuple of several values.
pub(super) fn tuple(values: impl ExactSizeIterator<Item = TokenStream>) -> TokenStream {
    match values.len() {
        1 => quote!(#(#values)*),
        _ => quote!((#(#values),*)),
    }
}

/// Names of the arguments that receive a program's results.
pub(super) fn result_names(program: &Program, taken: &[String]) -> Vec<Ident> {
    names::idents(&names::SPELLING.results(program, taken))
}

/// Tokens of an entry of a result, for example `result[i][j]`.
pub(super) fn place(output: &Output, name: &Ident, index: usize) -> TokenStream {
    let literal = Literal::usize_unsuffixed;
    match output.shape {
        Shape::Scalar => quote!(#name),
        Shape::Vector(_) => {
            let index = literal(index);
            quote!(#name[#index])
        }
        Shape::Matrix(_, columns) => {
            let (row, column) = (literal(index / columns.len), literal(index % columns.len));
            quote!(#name[#row][#column])
        }
    }
}

fn constant(operand: Operand) -> Option<f64> {
    match operand {
        Operand::Constant(number) => Some(number),
        _ => None,
    }
}
