//! Names of the values of a printed function, and texts of operands and results.

use super::context::Context;
use super::group;
use crate::emit::names::ProgramNames;
use crate::program::flow::Flow;
use crate::program::{Operand, Operation, Output, Program, Shape};

/// The program of a printed function with the names of its values.
pub(super) struct Body<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) program: &'a Program,
    pub(super) flow: Flow,
    pub(super) names: ProgramNames,
    /// Whether the function evaluates several states at once. Arguments then contain [`group::COUNT`] states
    /// each.
    pub(super) over_lanes: bool,
    /// Length of an array row if inputs and results are rows in a loop over joints; otherwise `None`.
    pub(super) row: Option<usize>,
    /// Length of a row if results are matrices with padded rows; otherwise `None`.
    pub(super) stride: Option<usize>,
    /// For each value, the result entries to which it is written. Each is given by the index of the result
    /// and of the entry.
    pub(super) stored: Vec<Vec<(usize, usize)>>,
}

/// Name of the index of a loop over joints.
pub(super) const JOINT: &str = "joint";

impl<'a> Body<'a> {
    /// Creates a body whose results are arguments. If the only result is a number, the function returns this
    /// number instead.
    pub(super) fn new(context: &'a Context<'a>, program: &'a Program) -> Self {
        Self::with_results(context, program, !returns_number(program))
    }

    /// Creates a body that evaluates several states at once. All results are arguments.
    pub(super) fn over_lanes(context: &'a Context<'a>, program: &'a Program) -> Self {
        Self { over_lanes: true, ..Self::with_results(context, program, true) }
    }

    fn with_results(context: &'a Context<'a>, program: &'a Program, in_place: bool) -> Self {
        let names = context.spelling.of_program(program, &[JOINT.to_owned()], in_place);
        let mut body = Self {
            context,
            program,
            flow: Flow::new(program),
            stored: vec![vec![]; names.values.len()],
            names,
            over_lanes: false,
            row: None,
            stride: None,
        };
        if in_place {
            for (result, output) in program.outputs.iter().enumerate() {
                for (entry, &operand) in output.entries.iter().enumerate() {
                    if let Some(made) = body.made(operand) {
                        body.stored[made].push((result, entry));
                    }
                }
            }
        }
        body
    }

    /// This body, but without the statements that write results.
    pub(super) fn without_stores(mut self) -> Self {
        self.stored = vec![];
        self
    }

    /// Name in C of the value with this index.
    pub(super) fn name(&self, index: usize) -> &str {
        &self.names.values[self.flow.canonical(index)]
    }

    /// Makes names from the wanted names that the function does not use.
    pub(super) fn fresh<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Vec<String> {
        let ProgramNames { arguments, results, values } = &self.names;
        let mut taken: Vec<String> = [arguments.as_slice(), results, values].concat();
        taken.extend([JOINT.to_owned(), "p".to_owned()]);
        self.context.spelling.distinct(names, &taken)
    }

    /// Type in C of the function's values.
    pub(super) fn ty(&self) -> String {
        match self.over_lanes {
            true => group::ty(self.context),
            false => self.context.ty().to_owned(),
        }
    }

    /// Text of an operand with the type of the function's values, for the argument of a call or the entry of
    /// a result.
    pub(super) fn value(&self, operand: Operand) -> String {
        let text = self.operand(operand);
        match (self.over_lanes, operand) {
            (true, Operand::Constant(_) | Operand::Parameter(_)) => group::same(self.context, &text),
            _ => text,
        }
    }

    /// Text of an operand of an operator. In code over several states, a number is the same for all states.
    pub(super) fn operand(&self, operand: Operand) -> String {
        match operand {
            Operand::Value(index) => self.name(index).to_owned(),
            Operand::Input(array, index) => {
                let (name, len) = (&self.names.arguments[array], self.program.inputs[array].extent.len);
                match (self.over_lanes, self.row) {
                    (true, _) => group::gather(self.context, name, index, len),
                    (false, Some(len)) => in_row(name, index, len),
                    (false, None) => format!("{name}[{index}]"),
                }
            }
            Operand::Parameter(index) => format!("p->{}", self.context.parameters[index]),
            Operand::Constant(number) => self.context.literal(number),
        }
    }

    /// Index of the value to which an operand refers; `None` if the operand is not a value.
    pub(super) fn made(&self, entry: Operand) -> Option<usize> {
        match entry {
            Operand::Value(made) => Some(self.flow.canonical(made)),
            _ => None,
        }
    }

    /// Return statement; `None` if the function does not return a number.
    pub(super) fn return_statement(&self) -> Option<String> {
        let returns = returns_number(self.program) && !self.over_lanes;
        let number = self.program.outputs.first().filter(|_| returns)?;
        let entry = number.entries.first().map(|&entry| self.operand(entry));
        Some(format!("return {};", entry.unwrap_or_else(|| self.context.literal(0.0))))
    }

    /// Statements that mark unused arguments to avoid compiler warnings.
    pub(super) fn unused(&self) -> Vec<String> {
        let made = self.program.instructions.iter().enumerate();
        let made = made.filter(|(index, _)| self.flow.is_made(*index));
        let read = made.flat_map(|(_, each)| crate::program::flow::operands(each.operation));
        let read: Vec<Operand> = read.chain(self.program.entries()).collect();
        let reads = |wanted: &dyn Fn(&Operand) -> bool| read.iter().any(wanted);
        let arguments = self.names.arguments.iter().enumerate();
        let arguments = arguments
            .filter(|(array, _)| !reads(&|each| matches!(each, Operand::Input(read, _) if read == array)));
        let parameters = self.context.passed_parameters();
        let parameters = parameters.filter(|_| !reads(&|each| matches!(each, Operand::Parameter(_))));
        let results = self.program.outputs.iter().zip(&self.names.results);
        let results = results.filter(|(output, _)| output.entries.is_empty());
        arguments
            .map(|(_, name)| name.clone())
            .chain(parameters)
            .chain(results.map(|(_, name)| name.clone()))
            .map(|name| format!("(void){name};"))
            .collect()
    }

    pub(super) fn operation(&self, index: usize) -> Operation {
        self.program.instructions[index].operation
    }
}

/// Whether the only result of a program is one number.
pub(super) fn returns_number(program: &Program) -> bool {
    matches!(program.outputs.as_slice(), [Output { shape: Shape::Scalar, .. }])
}

/// Text of an array entry in a loop over joints.
pub(super) fn in_row(name: &str, row: usize, len: usize) -> String {
    match row {
        0 => format!("{name}[{JOINT}]"),
        _ => format!("{name}[{} + {JOINT}]", row * len),
    }
}
