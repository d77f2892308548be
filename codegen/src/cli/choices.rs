//! Arguments that several commands have: options for reading a description, and choices of modules.

use clap::{Args, ValueEnum};

use crate::diagnostic::nearest;
use crate::emit::{Companion, Language, Scalar};
use crate::function_names;
use crate::functions::position_functions::PositionFunction;
use crate::read::ReadOptions;
use crate::wording::toml_text;
use gelenk_formula::Hold;

/// Options for reading a description; they change the equations.
#[derive(Debug, Default, Args)]
pub(super) struct Reading {
    /// Round angles to a multiple of 90° within this tolerance [rad]
    #[arg(long, value_name = "RAD", value_parser = small_angle)]
    pub(super) snap_angles: Option<f64>,
    /// Omit friction
    #[arg(long)]
    pub(super) no_friction: bool,
    /// Treat mimic joints as independent coordinates
    #[arg(long)]
    pub(super) ignore_mimic: bool,
    /// Replace sign(v) in friction by the smooth tanh(SLOPE · v) [default: as described, else the exact sign]
    #[arg(long, value_name = "SLOPE", value_parser = positive)]
    pub(super) smooth_sign: Option<f64>,
    /// Accept a robot whose mass matrix is not positive definite
    #[arg(long)]
    pub(super) accept_unphysical: bool,
    /// Kind of base; a floating base moves freely in all six directions [default: as described]
    #[arg(long, value_enum)]
    pub(super) base: Option<BaseName>,
    /// Hold joints at VALUE [rad or m, default: 0], by a name or a pattern with `*`. Joints that mimic them are held
    /// too. May be given several times. For `identify`: joints without columns in the logs; their friction and
    /// drives stay as described
    #[arg(long, value_name = "PATTERN[=VALUE]", value_parser = Hold::parse)]
    pub(super) hold: Vec<Hold>,
    /// Read only the subtree of this body of an MJCF scene
    #[arg(long, value_name = "NAME")]
    pub(super) body: Option<String>,
}

/// Kind of base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum BaseName {
    // A floating joint carries it. (With documentation here all of the help would be in its long form.)
    Floating,
}

impl Reading {
    pub(super) fn options(&self) -> ReadOptions {
        ReadOptions {
            ignore_mimic: self.ignore_mimic,
            snap_angles: self.snap_angles,
            no_friction: self.no_friction,
            smooth_sign: self.smooth_sign,
            accept_unphysical: self.accept_unphysical,
            exact_sign: false,
            floating_base: self.floats(),
            free_driven: false,
            hold: self.hold.clone(),
            body: self.body.clone(),
        }
    }

    /// Whether the base is floating.
    pub(super) fn floats(&self) -> bool {
        self.base == Some(BaseName::Floating)
    }

    /// Returns these options as keys of a description, one line of TOML per key. Options about friction are left
    /// out.
    pub(super) fn keys(&self) -> Vec<String> {
        let snap = self.snap_angles.map(|angle| format!("snap_angles = {angle:?}"));
        let mimic = self.ignore_mimic.then(|| "ignore_mimic = true".to_owned());
        let unphysical = self.accept_unphysical.then(|| "accept_unphysical = true".to_owned());
        let base = self.floats().then(|| "base = { type = \"floating\" }".to_owned());
        snap.into_iter()
            .chain(mimic)
            .chain(unphysical)
            .chain(base)
            .chain(held_key(&self.hold))
            .chain(body_key(self.body.as_deref()))
            .collect()
    }

    /// Returns these options as arguments of the command line.
    pub(super) fn words(&self) -> Vec<String> {
        let number = |option: &str, value: Option<f64>| {
            let words = value.map(|value| vec![option.to_owned(), format!("{value:?}")]);
            words.unwrap_or_default()
        };
        let flag = |option: &str, is_set: bool| is_set.then(|| option.to_owned());
        number("--snap-angles", self.snap_angles)
            .into_iter()
            .chain(number("--smooth-sign", self.smooth_sign))
            .chain(flag("--no-friction", self.no_friction))
            .chain(flag("--ignore-mimic", self.ignore_mimic))
            .chain(flag("--accept-unphysical", self.accept_unphysical))
            .chain(self.floats().then(|| ["--base", "floating"].map(str::to_owned)).into_iter().flatten())
            .chain(self.hold.iter().flat_map(|hold| ["--hold".to_owned(), hold.text()]))
            .chain(self.body.iter().flat_map(|body| ["--body".to_owned(), body.clone()]))
            .collect()
    }
}

/// TOML line that holds these joints; `None` without joints.
fn held_key(hold: &[Hold]) -> Option<String> {
    let is_last = |index: usize| hold[index + 1..].iter().all(|later| later.pattern != hold[index].pattern);
    let last = hold.iter().enumerate().filter(|(index, _)| is_last(*index));
    let entries = last.map(|(_, hold)| format!("{} = {:?}", toml_text(&hold.pattern), hold.position));
    let entries: Vec<String> = entries.collect();
    (!entries.is_empty()).then(|| format!("held = {{ {} }}", entries.join(", ")))
}

/// TOML line that selects the subtree of a body; `None` without a body.
fn body_key(body: Option<&str>) -> Option<String> {
    body.map(|body| format!("body = {}", toml_text(body)))
}

/// Modules generated from a description: one or a pair.
#[derive(Debug, Args)]
pub(super) struct Modules {
    /// Language of the module: NAME.rs, or NAME.h and NAME.c (C99, also C++). Both compute bit-identical results
    #[arg(long, value_enum, default_value_t = LanguageName::Rust)]
    pub(super) language: LanguageName,
    /// Tools that call the C module, separated by commas; each adds files. acados: discrete dynamics and an
    /// optimal control problem (NAME_acados.c, NAME_acados.py). CasADi: external functions with Jacobians
    /// (NAME_casadi.c). Python: loops over many states (NAME_python.c)
    #[arg(long = "for", value_name = "TOOLS", value_enum, value_delimiter = ',')]
    pub(super) tools: Vec<ToolName>,
    #[command(flatten)]
    pub(super) choices: Choices,
    /// Write two modules: the exact model for the plant, and the smooth model <NAME>_control for the controller,
    /// with tanh(SLOPE · v) for sign(v) in friction and springs
    #[arg(long, value_name = "SLOPE", value_parser = positive, conflicts_with = "smooth_sign")]
    pub(super) control_model: Option<f64>,
}

impl Modules {
    /// The tools for which files are written, in sorted order without duplicates.
    pub(super) fn tools(&self) -> Vec<ToolName> {
        let mut tools = self.tools.clone();
        tools.sort_unstable();
        tools.dedup();
        tools
    }

    pub(super) fn companions(&self) -> Vec<Companion> {
        self.tools().into_iter().map(Companion::from).collect()
    }
}

/// Options that change the generated code; the header of the file lists them.
#[derive(Debug, Args)]
pub(super) struct Choices {
    /// Functions to generate, separated by commas; `all` means all functions that models/README.md does not mark as
    /// on request [default: as described, else all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = function)]
    pub(super) functions: Vec<String>,
    /// Number type of the module
    #[arg(long, value_enum, default_value_t = ScalarName::F64)]
    pub(super) scalar: ScalarName,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Functions that are also generated for eight states at once, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = function)]
    pub(super) lanes: Vec<String>,
    /// Contract products and sums to fused multiply-adds. The module then needs std and a processor with FMA
    #[arg(long)]
    pub(super) fused_multiply_add: bool,
    /// Append tests to the module: they compare its functions at seeded states with the generator's interpreter
    #[arg(long)]
    pub(super) self_test: bool,
    /// Largest number of operations of a generated function [default: 300000]
    #[arg(long, value_name = "COUNT")]
    pub(super) max_operations: Option<usize>,
}

/// Defines command-line enums for enums of the printers. The variants have no documentation, to keep the help short.
macro_rules! words {
    ($($name:ident for $value:ident { $($variant:ident),* })*) => {$(
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
        pub(super) enum $name {
            $($variant),*
        }

        impl From<$name> for $value {
            fn from(name: $name) -> Self {
                match name {
                    $($name::$variant => Self::$variant),*
                }
            }
        }
    )*};
}

words! {
    ScalarName for Scalar { F64, F32 }
    LanguageName for Language { Rust, C }
    ToolName for Companion { Acados, Casadi, Python }
}

/// Parses the name of a function. The robot may lack the function's frame, which is checked later.
fn function(text: &str) -> Result<String, String> {
    let name = text.trim();
    if function_names::is_known(name) {
        return Ok(name.to_owned());
    }
    if name.contains(char::is_whitespace) {
        return Err("separate names with commas".to_owned());
    }
    if PositionFunction::ALL.iter().any(|function| function.name() == name) {
        return Err(
            "leave this function out. It is always generated for robots with spherical or floating joints, and never for others"
                .to_owned(),
        );
    }
    let near = nearest(name, function_names::listed()).unwrap_or_default();
    Err(format!("this function does not exist; {near}"))
}

fn small_angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(angle) if (0.0..=0.1).contains(&angle) => Ok(angle),
        Ok(_) => Err("must be from 0 to 0.1 rad".to_owned()),
        Err(_) => Err("must be a number of radians, e.g. 1e-4".to_owned()),
    }
}

/// Parses a number above 0 and at most 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number <= 1.0 => Ok(number),
        _ => Err("must be above 0 and at most 1, e.g. 0.7".to_owned()),
    }
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a positive number, e.g. 100".to_owned()),
    }
}
