//! Requirements of CasADi and acados, which call C modules.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::emit::{Companion, EmitOptions, Scalar};
use crate::functions::catalogue::{ACADOS, CASADI};
use crate::functions::composition::Composition;
use crate::functions::function::{FrameKind, Function};
use crate::model::Model;
use crate::program;
use crate::wording::listed;

/// Returns an error if CasADi or acados does not support the robot.
pub(crate) fn check(model: &Model, tools: &[Companion]) -> Result<(), Diagnostics> {
    let products = [(Companion::Acados, ACADOS), (Companion::Casadi, CASADI)].into_iter();
    let mut wanted = products.filter(|(tool, _)| tools.contains(tool));
    wanted.try_for_each(|(_, product)| product.check(model))
}

/// Returns the error `missing-function` if acados is a tool and the module lacks a function that acados
/// calls.
pub(crate) fn check_functions(
    functions: &[Function],
    compositions: &[Composition],
    tools: &[Companion],
) -> Result<(), Diagnostics> {
    let names = functions.iter().map(|function| function.name.as_str());
    let names: Vec<&str> = names.chain(compositions.iter().map(|each| each.name())).collect();
    let mut needed = ["step", "step_derivatives", "input_matrix"].into_iter();
    match needed.find(|name| !names.contains(name)) {
        Some(missing) if tools.contains(&Companion::Acados) => {
            let message = format!("acados needs the function `{missing}`, but the module lacks it");
            let help = "add `step`, `step_derivatives` and `input_matrix` to the chosen functions";
            Err(Diagnostic::error("missing-function", message).help(help).into())
        }
        _ => Ok(()),
    }
}

/// Functions for CasADi, except poses of frames, with the module's functions for the value and its
/// derivatives.
const OF_CASADI: [Given; 3] = [
    Given { name: "dynamics", value: "forward_dynamics", derivatives: "linearize" },
    Given {
        name: "inverse_dynamics",
        value: "inverse_dynamics",
        derivatives: "inverse_dynamics_derivatives_and_mass_matrix",
    },
    Given { name: "step", value: "step", derivatives: "step_derivatives" },
];

/// A function that CasADi calls, and the functions of the module that compute it.
struct Given {
    name: &'static str,
    /// Name of the module's function that computes the value.
    value: &'static str,
    /// Name of the module's function that computes the derivatives.
    derivatives: &'static str,
}

/// Returns a note about the functions for CasADi that are left out, because the module lacks functions that
/// they call.
pub(crate) fn notes(
    functions: &[Function],
    compositions: &[Composition],
    tools: &[Companion],
) -> Option<Diagnostic> {
    let names = functions.iter().map(|function| function.name.as_str());
    let names: Vec<&str> = names.chain(compositions.iter().map(|each| each.name())).collect();
    let lacking = OF_CASADI.iter().filter_map(|Given { name: given, value, derivatives }| {
        let missing = |what: String, needed: &&str| format!("{what} (`{needed}`)");
        match (names.contains(value), names.contains(derivatives)) {
            (true, true) => None,
            (true, false) => Some(missing(format!("derivatives of `{given}`"), derivatives)),
            (false, _) => Some(missing(format!("`{given}`"), value)),
        }
    });
    let lacking: Vec<String> = lacking.filter(|_| tools.contains(&Companion::Casadi)).collect();
    let given = listed(lacking.iter().cloned());
    let message = format!(
        "these functions for CasADi are not written, because the module lacks the functions in parentheses: {given}"
    );
    let help = "choose the missing functions with `--functions` or `functions` in [generate]; functions \
                that take wrenches have no form for CasADi";
    (!lacking.is_empty()).then(|| Diagnostic::note("not-for-casadi", message).help(help))
}

/// Returns two texts for a message: the files that do not exist in single precision, and the tool that computes
/// in double precision. `None` if the module is in double precision or these tools are not requested.
pub(crate) fn in_single_precision(emit: &EmitOptions) -> Option<[String; 2]> {
    let tools = [(Companion::Acados, "acados"), (Companion::Casadi, "CasADi")];
    let mut wanted = tools.iter().filter(|(tool, _)| emit.companions.contains(tool));
    let (_, name) = wanted.next().filter(|_| emit.scalar == Scalar::F32)?;
    Some([format!("functions for {name} in single precision"), format!("{name} computes")])
}

/// Derivatives with respect to the free parameters, for the functions that CasADi calls.
pub(crate) fn by_parameters(model: &Model, functions: &[Function]) -> Vec<Function> {
    let count = model.parameters.len();
    let is_differentiated = |function: &&Function| {
        let is_pose = function.frame.as_ref().is_some_and(|of| of.kind == FrameKind::Pose);
        is_pose || OF_CASADI.iter().any(|given| given.value == function.name)
    };
    let wanted = functions.iter().filter(is_differentiated).filter(|_| count > 0);
    let derivatives = wanted.map(|function| {
        let program = program::by_parameters(&function.program, count);
        let meaning =
            "one row per entry of the result (row-major), one column per free parameter in the order of their struct";
        Function {
            name: format!("{}_by_parameters", function.name),
            frame: None,
            summary: format!("Derivatives of `{}` with respect to the free parameters.", function.name),
            equation: String::new(),
            arguments: function.arguments.clone(),
            results: vec![meaning.to_owned(); program.outputs.len()],
            notes: vec!["Forward differentiation of the program.".to_owned()],
            constants: vec![],
            arrays: None,
            program,
        }
    });
    derivatives.collect()
}
