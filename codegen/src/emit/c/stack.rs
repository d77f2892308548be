//! Estimates the stack size of calls from the number of values that are alive at the same time. gcc stores
//! values on the stack if there are not enough registers.

use super::context::Context;
use super::{arrays, straight};
use crate::emit::options::Scalar;
use crate::functions::composition::Composition;
use crate::functions::function::Function;
use crate::program::arrays::ArrayForm;
use crate::program::flow::Flow;
use crate::program::{Operation, Program, split};

/// Bytes on the stack for saved registers and the return address of a call.
const FRAME: usize = 64;
/// Bytes on the stack for the call of an elementary function.
const CALL: usize = 240;
/// Stack size in bytes below which no exact size is documented, because saved registers and padding are as
/// large as the values.
const LEAST: usize = 1000;

/// Sentence about the stack size of a function of the module.
pub(super) fn of_function(context: &Context<'_>, function: &Function) -> String {
    sentence(bytes(context, function))
}

/// Sentence about the stack size of a function over a sample time, for example `step`.
pub(super) fn of_composition(context: &Context<'_>, composition: Composition) -> String {
    let (n, m) = (context.module.coordinates, context.module.inputs);
    let numbers = match composition {
        // Powers and integrals of the state matrix.
        Composition::Discretize => 29 * n * n,
        Composition::Step => 10 * n,
        // Twelve stages with their derivatives, and the linearization of one stage.
        Composition::StepDerivatives => 12 * (n + 2 * n * n + n * m) + 3 * n * n,
    };
    sentence(numbers * number(context) + called(context, composition.calls()))
}

fn sentence(bytes: usize) -> String {
    let thousands = bytes as f64 / 1000.0;
    match bytes {
        0..LEAST => "Stack: below 2 kB.".to_owned(),
        LEAST..10_000 => format!("Stack: about {thousands:.1} kB."),
        _ => format!("Stack: about {thousands:.0} kB."),
    }
}

fn bytes(context: &Context<'_>, function: &Function) -> usize {
    let numbers = match &function.arrays {
        None => values(&function.program, straight::longest(context)),
        Some(ArrayForm::Steps(form)) => {
            arrays::local_numbers(context, function, form)
                + values(&form.setup, context.options.longest_function)
        }
        Some(ArrayForm::Affine(form)) => {
            let n = form.called.coordinates().len();
            return FRAME + number(context) * (n + n * n) + called(context, form.name);
        }
    };
    let is_call = |operation| matches!(operation, Operation::SinCos(_) | Operation::Call(..));
    let calls = function.program.instructions.iter().any(|each| is_call(each.operation));
    FRAME + number(context) * numbers + if calls { CALL } else { 0 }
}

/// Number of values of a program that are alive at the same time, plus the values that the parts of a long
/// program exchange.
fn values(program: &Program, longest: usize) -> usize {
    let flow = Flow::new(program);
    let parts = split::parts(program, &flow, longest);
    let exchanged = parts.iter().map(|part| part.takes.len() + part.returns.len());
    let exchanged = if parts.len() > 1 { exchanged.sum() } else { 0 };
    split::most_alive(program, &flow) + exchanged
}

/// Stack size of the module's function with this name, in bytes.
fn called(context: &Context<'_>, name: &str) -> usize {
    let function = context.module.functions.iter().find(|function| function.name == name);
    function.map_or(0, |function| bytes(context, function))
}

/// Size of a number of the module in bytes: 8 or 4.
fn number(context: &Context<'_>) -> usize {
    match context.options.scalar {
        Scalar::F64 => 8,
        Scalar::F32 => 4,
    }
}
