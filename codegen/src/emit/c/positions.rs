//! Prints the functions of positions with quaternions. The functions are fixed texts.

use gelenk_kernels::manifold::{Text, c_bodies};

use super::context::Context;
use super::{comment, layout, math, signature};
use crate::emit::documentation::{self, Labels, shape_text};
use crate::functions::position_functions::{PositionFunction, PositionValue, extents};

/// Include of the C library for the functions of positions with quaternions; empty without quaternions.
pub(super) fn include(context: &Context<'_>) -> &'static str {
    match context.module.has_quaternions() {
        true => "#include <stdbool.h>\n\n",
        false => "",
    }
}

/// Declarations of the functions of positions with their documentation, for the header; empty without
/// quaternions.
pub(super) fn declarations(context: &Context<'_>) -> Vec<String> {
    functions(context).iter().map(|&function| declaration(context, function)).collect()
}

/// Definitions of the functions of positions, after the texts that they share; empty without quaternions.
pub(super) fn text(context: &Context<'_>) -> String {
    if !context.module.has_quaternions() {
        return String::new();
    }
    let texts = [Text::Rotation, Text::Positions, Text::Tangents].map(Text::c_source).into_iter();
    let texts = texts.map(|text| context.pasted_loops(&format!("\n{text}")));
    let functions = functions(context).iter().map(|&function| {
        format!("\n{}\n{}", head(context, function, ""), context.pasted_loops(body(function)))
    });
    let text: String = texts.chain(functions).collect();
    // The texts call the function for double precision, which is replaced here.
    text.replace(&format!("{}(", context.function("sin_cos")), &format!("{}(", math::sin_cos(context)))
}

pub(super) fn functions(context: &Context<'_>) -> &'static [PositionFunction] {
    match context.module.has_quaternions() {
        true => &PositionFunction::ALL,
        false => &[],
    }
}

fn declaration(context: &Context<'_>, function: PositionFunction) -> String {
    let shape = |value: &PositionValue| {
        shape_text(&extents(value, context.module.positions, context.module.coordinates))
    };
    let arguments = function.arguments();
    let arguments =
        arguments.iter().map(|value| format!("`{}: [{}]`: {}", value.name, shape(value), value.meaning));
    let results = function.results();
    let results = results.iter().zip(results_of(function)).map(|(value, name)| {
        format!("{}: {}", signature::result_label(name, value.name, &shape(value)), value.meaning)
    });
    let documentation = comment::documentation(&documentation::of_position_function(
        function,
        &Labels {
            arguments: arguments.collect(),
            has_parameters: false,
            results: results.collect(),
            stack: None,
        },
    ));
    format!("{documentation}{}\n", head(context, function, ";"))
}

fn head(context: &Context<'_>, function: PositionFunction, tail: &str) -> String {
    let (ty, arguments) = match function {
        PositionFunction::Normalize => ("bool", vec![signature::written(context, "y")]),
        _ => {
            let read = function.arguments().into_iter().map(|value| signature::read(context, value.name));
            let written = results_of(function).iter().map(|name| signature::written(context, name));
            ("void", read.chain(written).collect())
        }
    };
    layout::call(0, &format!("{ty} {}", context.function(function.name())), &arguments, tail)
}

/// Names of the results of a function of positions in the fixed texts.
pub(super) fn results_of(function: PositionFunction) -> &'static [&'static str] {
    match function {
        PositionFunction::Integrate => &["y_next"],
        PositionFunction::Difference => &["d"],
        PositionFunction::IntegrateDerivatives => &["d_dy", "d_dd"],
        PositionFunction::Normalize => &[],
    }
}

fn body(function: PositionFunction) -> &'static str {
    match function {
        PositionFunction::Integrate => c_bodies::INTEGRATE,
        PositionFunction::Difference => c_bodies::DIFFERENCE,
        PositionFunction::IntegrateDerivatives => c_bodies::INTEGRATE_DERIVATIVES,
        PositionFunction::Normalize => c_bodies::NORMALIZE,
    }
}
