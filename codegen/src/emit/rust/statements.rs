//! Prints the statements of a function: one `let` per instruction.

use std::ops::Range;

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::body::Body;
use super::math;
use crate::emit::sequence::{self, Run};
use crate::program::split;
use crate::program::{Operand, Operation};

/// Largest number of statements of one block. Each `let` opens a scope within the previous scope. With full
/// debug information, rustc 1.95 visits scopes recursively, and 4 600 scopes overflow its stack. Blocks do
/// not slow down optimized code.
const LONGEST_BLOCK: usize = 1000;

impl Body<'_> {
    /// All statements of the function, with the returned results as last expression.
    pub(super) fn returning_statements(&self) -> TokenStream {
        let len = self.program.instructions.len();
        if len > LONGEST_BLOCK {
            let (statements, results) = (self.blocks(), self.returned());
            return quote!(#statements #results);
        }
        self.returning(self.statements(0..len))
    }

    /// Appends the results to statements. If the last value is the only result, its expression replaces its
    /// `let`.
    pub(super) fn returning(&self, mut statements: Vec<TokenStream>) -> TokenStream {
        let last = self.returned_value();
        let last = last.and_then(|last| self.expression(self.program.instructions[last].operation));
        if last.is_some() {
            statements.pop();
        }
        let value = last.unwrap_or_else(|| self.returned());
        quote!(#(#statements)* #value)
    }

    /// All statements of a function that writes its results in place. Each result entry is stored as soon as
    /// it is computed, so fewer values are alive at the same time.
    pub(super) fn storing_statements(&self) -> TokenStream {
        let constants = self.stores(|entry| self.made(entry).is_none());
        let statements = self.blocks();
        quote!(#(#constants)* #statements)
    }

    /// All statements of the function. A long function is divided into blocks that return the values that
    /// later blocks read.
    pub(super) fn blocks(&self) -> TokenStream {
        let parts = split::parts(self.program, &self.flow, LONGEST_BLOCK);
        let blocks = parts.iter().enumerate().map(|(index, part)| {
            let statements = self.statements(part.range.clone());
            // A value that is only stored in place needs no name after its block.
            let is_read = |value: &&usize| {
                let mut later = parts[index + 1..].iter();
                self.results.is_empty() || later.any(|part| part.takes.contains(value))
            };
            let returns = part.returns.iter().filter(is_read);
            let returns: Vec<_> = returns.map(|&value| self.name(value)).collect();
            match (index + 1 == parts.len(), returns.is_empty()) {
                (true, _) => quote!(#(#statements)*),
                (false, true) => quote!({ #(#statements)* }),
                (false, false) => {
                    quote!(let [#(#returns),*] = { #(#statements)* [#(#returns),*] };)
                }
            }
        });
        quote!(#(#blocks)*)
    }

    /// Statements for the instructions in this range.
    pub(super) fn statements(&self, range: Range<usize>) -> Vec<TokenStream> {
        self.statements_among(range, |_| true)
    }

    /// Statements for the instructions in this range for which `is_wanted` is true.
    pub(super) fn statements_among(
        &self,
        range: Range<usize>,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Vec<TokenStream> {
        let is_made = |index: &usize| self.flow.is_made(*index) && is_wanted(*index);
        let made: Vec<usize> = range.filter(is_made).collect();
        let groups = sequence::groups(self.program, &self.flow, &made, true);
        let mut statements = Vec::with_capacity(made.len());
        for group in groups {
            for run in &group.runs {
                statements.extend(match run {
                    Run::One(index) => self.statement(*index),
                    Run::Angles { batch, lanes } => Some(self.batch(batch, *lanes)),
                });
            }
            statements.extend(group.instructions.iter().flat_map(|&index| self.stores_of(index)));
        }
        statements
    }

    fn batch(&self, batch: &[(usize, Operand)], lanes: usize) -> TokenStream {
        let pairs = batch.iter().map(|&(index, _)| self.sine_and_cosine(index));
        let (sines, cosines): (Vec<_>, Vec<_>) = pairs.unzip();
        let angles = batch.iter().map(|&(_, angle)| self.operand(angle));
        let call = math::sin_cos_of(self.context, lanes, &angles.collect::<Vec<_>>());
        let (sines, cosines) = (pattern(sines, lanes), pattern(cosines, lanes));
        quote!(let (#sines, #cosines) = #call;)
    }

    /// The statement for an instruction; `None` if its value is not read or is computed by another statement.
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

    /// Names of the sine and the cosine of a `SinCos`; `None` for a value that is not read.
    fn sine_and_cosine(&self, index: usize) -> (Option<&Ident>, Option<&Ident>) {
        (
            self.flow.is_read[index].then(|| &self.names[index]),
            self.flow.cosine[index].map(|cosine| &self.names[cosine]),
        )
    }

    /// The right-hand side of an instruction's `let`; `None` for the cosine of a `SinCos`.
    fn expression(&self, operation: Operation) -> Option<TokenStream> {
        let binary = |a, operator, b| {
            // Two literals would leave the number type open if a method is called on the value, so one
            // literal gets its type.
            let left = match b {
                Operand::Constant(_) => self.receiver(a),
                _ => self.operand(a),
            };
            let right = self.operand(b);
            quote!(#left #operator #right)
        };
        Some(match operation {
            Operation::Add(a, b) => binary(a, quote!(+), b),
            Operation::Subtract(a, b) => binary(a, quote!(-), b),
            Operation::Multiply(a, b) => binary(a, quote!(*), b),
            Operation::Divide(a, b) => binary(a, quote!(/), b),
            Operation::Negate(Operand::Constant(number)) => self.context.options.scalar.typed(-number),
            Operation::Negate(a) => {
                let operand = self.operand(a);
                quote!(-#operand)
            }
            Operation::MultiplyAdd(a, b, c) => {
                let (a, b, c) = (self.receiver(a), self.operand(b), self.operand(c));
                quote!(#a.mul_add(#b, #c))
            }
            Operation::SinCos(a) => math::sin_cos(self.context, &self.operand(a)),
            Operation::CosineOf(_) => return None,
            Operation::Call(function, a) => {
                math::call(self.context, function, &self.receiver(a), &self.operand(a))
            }
        })
    }

    /// Tokens of an operand on which a method is called.
    fn receiver(&self, operand: Operand) -> TokenStream {
        match operand {
            Operand::Constant(number) => self.context.options.scalar.receiver(number),
            _ => self.operand(operand),
        }
    }
}

fn or_nothing(name: Option<&Ident>) -> TokenStream {
    name.map_or_else(|| quote!(_), |name| quote!(#name))
}

/// Pattern for an array of `len` entries. Unused entries at its end are not named.
fn pattern(mut names: Vec<Option<&Ident>>, len: usize) -> TokenStream {
    while names.last().is_some_and(Option::is_none) {
        names.pop();
    }
    let rest = (names.len() < len).then(|| quote!(..));
    let names = names.into_iter().map(or_nothing).chain(rest);
    quote!([#(#names),*])
}
