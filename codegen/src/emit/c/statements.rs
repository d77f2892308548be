//! Prints the statements of a C function: one declaration per instruction.

use std::ops::Range;

use super::body::Body;
use super::{group, layout, math};
use crate::emit::sequence::{self, Run};
use crate::program::{Operand, Operation};
use gelenk_formula::Function as Call;

impl Body<'_> {
    /// All statements of a function. Each result entry is written as soon as it is computed. If the only
    /// result is a number, it is returned.
    pub(super) fn all_statements(&self) -> Vec<String> {
        let constants = match self.return_statement() {
            None => self.stores(|entry| self.made(entry).is_none()),
            Some(_) => vec![],
        };
        let statements = self.statements(0..self.program.instructions.len());
        constants.into_iter().chain(statements).chain(self.return_statement()).collect()
    }

    /// Statements for the instructions in this range.
    pub(super) fn statements(&self, range: Range<usize>) -> Vec<String> {
        let made: Vec<usize> = range.filter(|&index| self.flow.is_made(index)).collect();
        // In code over several states, one call computes the angles of all states, so it does not take
        // several different angles.
        let groups = sequence::groups(self.program, &self.flow, &made, !self.over_lanes);
        let runs = || groups.iter().flat_map(|group| &group.runs);
        let mut helpers = self.fresh(runs().map(helper)).into_iter();
        let mut statements = Vec::with_capacity(made.len());
        for group in &groups {
            for (run, helper) in group.runs.iter().zip(&mut helpers) {
                match run {
                    Run::One(index) => statements.extend(self.statement(*index, &helper)),
                    Run::Angles { batch, lanes } => statements.extend(self.batch(batch, *lanes, &helper)),
                }
            }
            statements.extend(group.instructions.iter().flat_map(|&index| self.stores_of(index)));
        }
        statements
    }

    /// Statements for one instruction.
    ///
    /// - `helper`: name for an unused value
    fn statement(&self, index: usize, helper: &str) -> Vec<String> {
        let (ty, name) = (self.ty(), &self.names.values[index]);
        let pair = |angle: Operand, sine: &str, cosine: &str| {
            let callee = match self.over_lanes {
                true => group::sin_cos(self.context),
                false => math::sin_cos(self.context),
            };
            vec![
                format!("{ty} {sine}, {cosine};"),
                format!("{callee}({}, &{sine}, &{cosine});", self.value(angle)),
            ]
        };
        match self.operation(index) {
            Operation::CosineOf(_) => vec![],
            Operation::SinCos(angle) => {
                let cosine = self.flow.cosine[index].map(|cosine| self.names.values[cosine].as_str());
                pair(angle, name, cosine.unwrap_or(helper))
            }
            Operation::Call(Call::Sin, angle) => pair(angle, name, helper),
            Operation::Call(Call::Cos, angle) => pair(angle, helper, name),
            operation => vec![format!("const {ty} {name} = {};", self.expression(operation))],
        }
    }

    /// Statement with one call that computes the sines and cosines of several angles.
    fn batch(&self, batch: &[(usize, Operand)], lanes: usize, helper: &str) -> Vec<String> {
        let ty = self.context.ty();
        let zero = self.context.literal(0.0);
        let angles = batch.iter().map(|&(_, angle)| self.operand(angle));
        let padding = std::iter::repeat_n(zero, lanes.saturating_sub(batch.len()));
        let arguments: Vec<String> = angles.chain(padding).chain([helper.to_owned()]).collect();
        let callee = math::sin_cos_of(self.context, lanes);
        let mut statements =
            vec![format!("{ty} {helper}[{}];", 2 * lanes), layout::call(4, &callee, &arguments, ";")];
        for (lane, &(index, _)) in batch.iter().enumerate() {
            if self.flow.is_read[index] {
                let name = &self.names.values[index];
                statements.push(format!("const {ty} {name} = {helper}[{lane}];"));
            }
            if let Some(cosine) = self.flow.cosine[index] {
                let name = &self.names.values[cosine];
                statements.push(format!("const {ty} {name} = {helper}[{}];", lanes + lane));
            }
        }
        statements
    }

    /// Call of an elementary function, or of its version for several states.
    fn call(&self, callee: &str, operands: &[Operand]) -> String {
        let callee = match self.over_lanes {
            true => group::of_each(self.context, callee, operands.len()),
            false => callee.to_owned(),
        };
        let operands: Vec<String> = operands.iter().map(|&operand| self.value(operand)).collect();
        format!("{callee}({})", operands.join(", "))
    }

    fn is_fused(&self, value: usize) -> bool {
        matches!(self.operation(value), Operation::MultiplyAdd(..))
    }

    /// Expression with two operands and an operator. In code over several states, at least one operand is a
    /// vector.
    fn binary(&self, a: Operand, operator: &str, b: Operand) -> String {
        let is_number = |operand| matches!(operand, Operand::Constant(_) | Operand::Parameter(_));
        let first = if is_number(b) { self.value(a) } else { self.operand(a) };
        format!("{first} {operator} {}", self.operand(b))
    }

    /// The right-hand side of an instruction's statement. Sines and cosines are not included.
    fn expression(&self, operation: Operation) -> String {
        let binary = |a, operator, b| self.binary(a, operator, b);
        match operation {
            Operation::Add(a, b) => binary(a, "+", b),
            Operation::Subtract(a, b) => binary(a, "-", b),
            Operation::Multiply(a, b) => binary(a, "*", b),
            Operation::Divide(a, b) => binary(a, "/", b),
            Operation::Negate(Operand::Constant(number)) => self.value(Operand::Constant(-number)),
            Operation::Negate(Operand::Value(value)) if self.is_fused(value) => {
                self.call(&math::negate_fused(self.context), &[Operand::Value(value)])
            }
            Operation::Negate(a) => format!("-{}", self.value(a)),
            Operation::MultiplyAdd(a, b, c) => self.call(&math::multiply_add(self.context), &[a, b, c]),
            Operation::Call(function, a) => self.call(&math::callee(self.context, function), &[a]),
            Operation::SinCos(_) | Operation::CosineOf(_) => {
                unreachable!("`statement` writes sines and cosines as pairs")
            }
        }
    }
}

/// Beginning of the name of an auxiliary variable in a statement.
fn helper(run: &Run) -> &'static str {
    match run {
        Run::One(_) => "unused",
        Run::Angles { .. } => "sines_cosines",
    }
}
