//! Constants that document functions: names of columns, groups of parameters, and patterns of zeros in
//! matrices.

use crate::diagnostic::Diagnostic;
use crate::dynamics::forces;
use crate::dynamics::parameters::base_parameters::{BaseParameters, Term};
use crate::dynamics::parameters::regressor;
use crate::functions::function::{Constant, ConstantValue, Function};
use crate::layout::Dimension;
use crate::model::Model;
use crate::program::{Program, Shape, nonzero_entries};

/// Names of the constants that document functions.
pub const NAMES: [&str; 8] = [
    "INERTIAL_PARAMETER_NAMES",
    "BASE_PARAMETER_NAMES",
    "BASE_PARAMETER_TERMS",
    "FRICTION_PARAMETER_NAMES",
    "MASS_MATRIX_NONZERO",
    "A_Y_NONZERO",
    "A_V_NONZERO",
    "B_X_NONZERO",
];

/// Largest number of terms for which the documentation lists the groups of base parameters. With more terms,
/// only the constant `BASE_PARAMETER_TERMS` contains them.
const MOST_TERMS: usize = 1000;

pub(super) fn inertial_names(model: &Model) -> Constant {
    let summary = "Inertial parameters π, the columns of `inertial_regressor`. The parameters of each link, in the order of the \
         coordinates, include all bodies fixed to the link and are in the link's frame of the description. They are the \
         mass m [kg], first moments mcx, mcy, mcz [kg m], and the entries Ixx, Ixy, Iyy, Ixz, Iyz, Izz of the inertia \
         matrix about the frame's origin [kg m²] (Ixy = −∫ x y dm). Axial inertias J of rotors [kg m²] follow.";
    Constant {
        name: "INERTIAL_PARAMETER_NAMES",
        summary: summary.to_owned(),
        items: Vec::new(),
        value: ConstantValue::Names(Dimension::Parameters, regressor::parameter_names(model)),
    }
}

pub(super) fn friction_names(model: &Model) -> Constant {
    let motion = match forces::friction_depends_on_position(model) {
        true => "position and velocity",
        false => "velocity",
    };
    let summary = format!(
        "Friction parameters, the columns of `friction_regressor`. A name consists of the joint and the function of its \
         {motion} that the parameter multiplies."
    );
    Constant {
        name: "FRICTION_PARAMETER_NAMES",
        summary,
        items: Vec::new(),
        value: ConstantValue::Names(Dimension::Parameters, forces::friction_names(model)),
    }
}

pub(super) fn base_parameters(model: &Model, base: &BaseParameters) -> Vec<Constant> {
    let names = regressor::parameter_names(model);
    let leaders = base.leaders.iter().map(|&leader| names[leader].clone());
    let groups = base.groups().map(|group| group_text(group, &names));
    let items = match base.terms.len() <= MOST_TERMS {
        true => groups.collect(),
        false => Vec::new(),
    };
    let is_constant = base.constant_terms().is_some();
    let end = match (items.is_empty(), is_constant) {
        (true, true) => ", see `BASE_PARAMETER_TERMS`.",
        (true, false) => " that change with free parameters.",
        (false, true) => ":",
        (false, false) => {
            ". The factor c(p) changes with free parameters, so that no constant map holds for all of their values:"
        }
    };
    let summary = format!(
        "Base parameters β, the columns of `base_regressor`. Each base parameter is a sum of inertial parameters and has \
         the name of the leading one. {} of {} parameters enter the motion only in these sums{end}",
        names.len() - base.leaders.len(),
        names.len(),
    );
    let names = Constant {
        name: "BASE_PARAMETER_NAMES",
        summary,
        items,
        value: ConstantValue::Names(Dimension::Parameters, leaders.collect()),
    };
    let terms = base.constant_terms().map(|terms| Constant {
        name: BASE_TERMS,
        summary: terms_text(model),
        items: Vec::new(),
        value: ConstantValue::Sparse(terms),
    });
    std::iter::once(names).chain(terms).collect()
}

const BASE_TERMS: &str = "BASE_PARAMETER_TERMS";

fn terms_text(model: &Model) -> String {
    let map = "Map from the inertial parameters to the base parameters: β[i] = Σ c π[j] over all (i, j, c)";
    match model.parameters.is_empty() {
        true => format!("{map}."),
        false => format!("{map}. The map holds for all values of the free parameters."),
    }
}

/// Returns a note if a constant of the base parameters is missing; otherwise `None`. The constant has the map
/// from the inertial parameters to the base parameters, and is missing if this map depends on free
/// parameters.
pub fn notes(functions: &[Function]) -> Option<Diagnostic> {
    let base = functions.iter().find(|function| function.name == "base_regressor")?;
    if base.constants.iter().any(|constant| constant.name == BASE_TERMS) {
        return None;
    }
    let message = format!(
        "`{BASE_TERMS}` is omitted: the map to base parameters depends on free lengths, gear ratios or gravity"
    );
    let help = "write numbers instead of these parameters if you need a constant map; `BASE_PARAMETER_NAMES` and \
                `base_regressor` are valid for all values";
    Some(Diagnostic::note("base-parameters", message).help(help))
}

/// Writes a group of base parameters as text, for example `Izz_1 + 0.09 m_2 − Ixx_2 + c(p) J_1`.
fn group_text(group: &[Term], names: &[String]) -> String {
    let mut text = String::new();
    for (position, term) in group.iter().enumerate() {
        let is_negative = term.coefficient.is_some_and(|coefficient| coefficient < 0.0);
        text.push_str(match (position, is_negative) {
            (0, false) => "",
            (0, true) => "−",
            (_, false) => " + ",
            (_, true) => " − ",
        });
        match term.coefficient.map(f64::abs) {
            Some(1.0) => {}
            Some(size) => text.push_str(&format!("{size} ")),
            None => text.push_str("c(p) "),
        }
        text.push_str(&names[term.parameter]);
    }
    format!("`{text}`")
}

/// Constants that show which entries of results are always zero.
pub(super) fn patterns(program: &Program, blocks: &[(&'static str, &str)]) -> Vec<Constant> {
    let entries = nonzero_entries(program);
    let pattern = |&(name, output): &(&'static str, &str)| {
        let index = program.outputs.iter().position(|found| found.name == output)?;
        let (found, nonzero) = (&program.outputs[index], &entries[index]);
        let Shape::Matrix(_, columns) = found.shape else {
            return None;
        };
        let count = nonzero.iter().filter(|entry| **entry).count();
        let rows = match columns.len {
            0 => Vec::new(),
            columns => nonzero.chunks(columns).map(<[bool]>::to_vec).collect(),
        };
        let summary = format!(
            "Structure of `{output}`: `false` for entries that are zero in every state; {count} of {} entries are `true`.",
            found.entries.len()
        );
        Some(Constant { name, summary, items: Vec::new(), value: ConstantValue::Pattern(rows) })
    };
    blocks.iter().filter_map(pattern).collect()
}
