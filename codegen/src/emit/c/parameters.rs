//! Prints the C struct of a model's free parameters.

use super::comment;
use super::context::Context;
use crate::emit::documentation::of_parameter;

/// The struct of the free parameters, and the declaration of the values that the description gives them;
/// empty if there are no free parameters.
pub(super) fn declarations(context: &Context<'_>) -> Vec<String> {
    if !context.has_parameters() {
        return vec![];
    }
    let (ty, name) = (context.ty(), context.function("parameters"));
    let fields = context.module.parameters.iter().zip(&context.parameters);
    let fields = fields.map(|(parameter, field)| {
        let documentation = comment::paragraph(&of_parameter(parameter, str::to_owned));
        let documentation: String = documentation.lines().map(|line| format!("    {line}\n")).collect();
        format!("{documentation}    {ty} {field};\n")
    });
    let fields: String = fields.collect();
    let about = comment::paragraph(&format!(
        "Free parameters of the model; `{}` contains the values of the description.",
        defaults(context)
    ));
    vec![
        format!("{about}typedef struct {{\n{fields}}} {name};\n"),
        format!(
            "{}extern const {name} {};\n",
            comment::paragraph("Values of the free parameters in the description."),
            defaults(context)
        ),
    ]
}

/// Definition of the constant with the description's values of the free parameters; `None` if there are no
/// free parameters.
pub(super) fn definition(context: &Context<'_>) -> Option<String> {
    let parameters = context.module.parameters.iter().zip(&context.parameters);
    let values = parameters
        .map(|(parameter, field)| format!("    {}, // {field}\n", context.literal(parameter.default)));
    let values: String = values.collect();
    let head = format!("const {} {}", context.function("parameters"), defaults(context));
    context.has_parameters().then(|| format!("{head} = {{\n{values}}};\n"))
}

fn defaults(context: &Context<'_>) -> String {
    context.function("default_parameters")
}
