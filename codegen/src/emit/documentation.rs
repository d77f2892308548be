//! Documentation of generated items as blocks of Markdown, for all languages.

use super::text::code;
use crate::functions::function::{Constant, Function};
use crate::functions::position_functions::PositionFunction;
use crate::layout::Extent;
use crate::model::Parameter;
use crate::module::{ComposedFunction, Module};

/// A paragraph, list item or empty line of documentation. The Markdown is written by the generator and does
/// not come from a description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Block {
    /// A paragraph, after an empty line.
    Paragraph(String),
    /// An item of a list, without its dash.
    Item(String),
    /// An empty line of documentation.
    Gap,
}

/// Names and shapes of a function's arguments and results in the syntax of a language, for example ``
/// `y: [N]` ``.
pub(super) struct Labels {
    /// Labels of the arguments, for example `` `y: [N]` ``.
    pub(super) arguments: Vec<String>,
    /// Whether the free parameters are an argument of the function.
    pub(super) has_parameters: bool,
    /// Labels of the results, for example ``returns `M: [N × N]` ``.
    pub(super) results: Vec<String>,
    /// Sentence about the function's stack size, after the operation count; `None` for Rust.
    pub(super) stack: Option<String>,
}

/// Text of a length: the name of a constant if the length depends on the robot, otherwise a number.
fn length_text(extent: Extent) -> String {
    extent.dimension.length().map_or_else(|| extent.len.to_string(), str::to_owned)
}

/// Shape of an argument in documentation, for example `N`, or `WRENCHES × 6` if the entries form rows.
pub(super) fn argument_shape(extent: Extent) -> String {
    let row = extent.row().map_or(String::new(), |row| format!(" × {row}"));
    format!("{}{row}", length_text(extent))
}

/// Shape of a result in documentation, for example `N × N`.
pub(super) fn shape_text(extents: &[Extent]) -> String {
    let lengths = extents.iter().map(|&extent| length_text(extent));
    lengths.collect::<Vec<_>>().join(" × ")
}

/// Documentation of a function with the given names and shapes of arguments and results.
pub(super) fn of_function(function: &Function, labels: &Labels) -> Vec<Block> {
    let mut blocks = vec![Block::Paragraph(function.summary.clone())];
    if !function.equation.trim().is_empty() {
        blocks.push(Block::Paragraph(code(&function.equation)));
    }
    blocks.push(Block::Gap);
    for (i, label) in labels.arguments.iter().enumerate() {
        let told = function.arguments.get(i);
        let meaning = told.map_or("", |argument| argument.meaning.as_str());
        let entries = told.map_or(String::new(), |argument| list(&argument.entries));
        blocks.push(Block::Item(sentence([label, meaning, &entries])));
    }
    blocks.extend(parameters(labels));
    for (i, label) in labels.results.iter().enumerate() {
        let meaning = function.results.get(i).map_or("", String::as_str);
        blocks.push(Block::Item(sentence([label, meaning, ""])));
    }
    blocks.push(cost(&format!("Cost: {}.", function.cost()), labels));
    blocks.extend(function.notes.iter().cloned().map(Block::Paragraph));
    blocks
}

/// Documentation of a function over a sample time, for example `step`. All arguments except the period have
/// one label in common.
pub(super) fn of_composition(composed: &ComposedFunction, labels: &Labels) -> Vec<Block> {
    let function = composed.composition;
    let mut blocks = vec![
        Block::Paragraph(function.summary().to_owned()),
        Block::Paragraph(code(composed.equation)),
        Block::Gap,
    ];
    for label in &labels.arguments {
        let meaning = "coordinates, velocities and inputs, as in all functions of this module";
        blocks.push(Block::Item(sentence([label, meaning, ""])));
    }
    blocks.push(Block::Item("`period`: sample time in s, over which u is constant".to_owned()));
    blocks.extend(parameters(labels));
    for (result, label) in composed.results.iter().zip(&labels.results) {
        blocks.push(Block::Item(sentence([label, result.meaning, ""])));
    }
    blocks.push(cost(&composed.cost_text, labels));
    blocks.extend(
        function.notes(composed.has_quaternions).iter().map(|&note| Block::Paragraph(note.to_owned())),
    );
    blocks
}

/// Label of the arguments y, v and u of a function over a sample time.
pub(super) fn state_label(module: &Module) -> String {
    let y = if module.has_quaternions() { "NY" } else { "N" };
    format!("`y: [{y}]`, `v: [N]`, `u: [M]`")
}

/// Documentation of a function of positions with quaternions, for example `integrate`. The labels already
/// include the meanings.
pub(super) fn of_position_function(function: PositionFunction, labels: &Labels) -> Vec<Block> {
    let mut blocks = vec![
        Block::Paragraph(function.summary().to_owned()),
        Block::Paragraph(code(function.equation())),
        Block::Gap,
    ];
    blocks.extend(labels.arguments.iter().chain(&labels.results).cloned().map(Block::Item));
    blocks.extend(function.notes().iter().map(|&note| Block::Paragraph(note.to_owned())));
    blocks
}

/// Documentation of a constant of the module.
pub(super) fn of_constant(constant: &Constant) -> Vec<Block> {
    let mut blocks = vec![Block::Paragraph(constant.summary.clone())];
    if !constant.items.is_empty() {
        blocks.push(Block::Gap);
        blocks.extend(constant.items.iter().cloned().map(Block::Item));
    }
    blocks
}

/// Sentence about a free parameter.
///
/// - `plain`: removes markup from a text of the description
pub(super) fn of_parameter(parameter: &Parameter, plain: impl Fn(&str) -> String) -> String {
    let meaning = match parameter.description.trim() {
        "" => format!("Parameter {}", code(&parameter.name)),
        text => plain(text),
    };
    let unit = match parameter.unit.trim() {
        "" => String::new(),
        _ => format!(" ({})", plain(&parameter.unit)),
    };
    format!("{}{unit}; described as {:?}.", meaning.trim_end_matches('.'), parameter.default)
}

fn cost(text: &str, labels: &Labels) -> Block {
    let sentences = std::iter::once(text).chain(labels.stack.as_deref());
    Block::Paragraph(sentences.collect::<Vec<_>>().join(" "))
}

fn parameters(labels: &Labels) -> Option<Block> {
    labels.has_parameters.then(|| Block::Item("`p`: free parameters".to_owned()))
}

fn sentence(parts: [&str; 3]) -> String {
    let parts = parts.map(str::trim).into_iter();
    let parts = parts.filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(": ")
}

/// Text of the entries of an argument with their units. Adjacent entries with the same unit are followed by
/// one unit.
fn list(entries: &[(String, &'static str)]) -> String {
    let shown = entries.iter().enumerate().map(|(i, (name, unit))| {
        let is_last_of_unit = entries.get(i + 1).is_none_or(|(_, next)| next != unit);
        match is_last_of_unit {
            true if *unit == "1" => format!("{} without unit", code(name)),
            true => format!("{} in {unit}", code(name)),
            false => code(name),
        }
    });
    shown.collect::<Vec<_>>().join(", ")
}
