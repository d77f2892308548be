//! Prints functions over a sample time, such as `step`. They are fixed texts that call functions of the
//! module.

use std::collections::BTreeSet;

use gelenk_kernels::discrete_time::{C_ACCELERATION, Text, c_bodies};
use gelenk_kernels::manifold;

use super::context::Context;
use super::{comment, layout, signature, stack};
use crate::emit::documentation::{self, Labels, shape_text};
use crate::emit::names::spelled;
use crate::functions::composition::Composition;
use crate::module::ComposedFunction;

/// Declaration of a function over a sample time with its documentation, for the header.
pub(super) fn declaration(context: &Context<'_>, composed: &ComposedFunction) -> String {
    let results = composed.results.iter().map(|result| {
        signature::result_label(&spelled(result.name), result.name, &shape_text(&result.extents))
    });
    let labels = Labels {
        arguments: vec![documentation::state_label(context.module)],
        has_parameters: context.has_parameters(),
        results: results.collect(),
        stack: Some(stack::of_composition(context, composed.composition)),
    };
    let documentation = comment::documentation(&documentation::of_composition(composed, &labels));
    format!("{documentation}{}\n", head(context, composed, ";"))
}

fn head(context: &Context<'_>, composed: &ComposedFunction, tail: &str) -> String {
    let inputs = ["y", "v", "u"].map(|name| signature::read(context, name)).into_iter();
    let results = composed.results.iter().map(|result| signature::written(context, &spelled(result.name)));
    let period = format!("{} period", context.ty());
    let arguments: Vec<String> =
        inputs.chain([period]).chain(context.declared_parameters()).chain(results).collect();
    let name = context.function(composed.composition.name());
    layout::call(0, &format!("void {name}"), &arguments, tail)
}

/// Definitions of the functions over a sample time, after the texts that they share.
pub(super) fn text(context: &Context<'_>) -> String {
    let compositions = context.module.compositions.iter();
    let texts = [shared(context), own(context)].concat().into_iter().filter(|text| !text.is_empty());
    let texts = texts.map(|text| context.pasted_loops(&format!("\n{text}")));
    let functions = compositions.map(|composed| {
        format!("\n{}\n{}", head(context, composed, ""), context.pasted_loops(body(composed)))
    });
    texts.chain(functions).collect()
}

/// The shared texts that functions over a sample time need for every robot.
fn shared(context: &Context<'_>) -> Vec<&'static str> {
    let compositions = context.module.compositions.iter();
    let texts: BTreeSet<Text> = compositions.flat_map(|each| each.composition.texts()).copied().collect();
    let has_matrices = texts.contains(&Text::Halves);
    let texts = texts.into_iter().filter(|text| has_matrices || *text != Text::Sums);
    texts.map(Text::c_source).collect()
}

/// The texts that functions over a sample time need either with or without quaternions.
fn own(context: &Context<'_>) -> Vec<&'static str> {
    let compositions = context.module.compositions.iter().map(|each| each.composition);
    if context.module.has_quaternions() {
        let texts: BTreeSet<manifold::Text> =
            compositions.flat_map(Composition::manifold_texts).copied().collect();
        return texts.into_iter().map(manifold::Text::c_source).collect();
    }
    let differentiated = compositions.filter(|composition| *composition == Composition::StepDerivatives);
    differentiated.map(|_| C_ACCELERATION).collect()
}

fn body(composed: &ComposedFunction) -> &'static str {
    match (composed.composition, composed.has_quaternions) {
        (Composition::Discretize, false) => c_bodies::DISCRETIZE,
        (Composition::Step, false) => c_bodies::STEP,
        (Composition::StepDerivatives, false) => c_bodies::STEP_DERIVATIVES,
        (Composition::Discretize, true) => manifold::c_bodies::DISCRETIZE,
        (Composition::Step, true) => manifold::c_bodies::STEP,
        (Composition::StepDerivatives, true) => manifold::c_bodies::STEP_DERIVATIVES,
    }
}
