//! Options of the printer.

use super::interface::Interface;

/// Largest number of statements of one function. With debug information, as in Cargo's dev profile, rustc 1.95 nests
/// one scope for each `let`, and LLVM recurses over them: 2 800 statements compile, 3 200 overflow the 2 MB
/// of its thread's stack and end rustc. Without it, at opt-level 3, 9 000 statements need 0.9 s and 200 MB,
/// 28 000 need 4 s and 490 MB: there parts of shorter functions are inlined, which makes no scopes within each other.
const LONGEST_FUNCTION: usize = 2_000;

/// Options of the printer.
#[derive(Debug, Clone, PartialEq)]
pub struct EmitOptions {
    /// The language of the module.
    pub language: Language,
    /// Additional files for tools that call C modules.
    pub companions: Vec<Companion>,
    /// Name of the module, if it differs from the robot's; used for its files and, in C, as prefix of its
    /// names.
    pub name: Option<String>,
    /// Number type of all functions and constants.
    pub scalar: Scalar,
    /// Command that regenerates the file, for its header; without absolute paths.
    pub command: String,
    /// Largest number of statements of a function. Longer programs are split into private functions.
    /// Straight-line code in C may have five times as many.
    pub longest_function: usize,
}

impl Default for EmitOptions {
    fn default() -> Self {
        Self {
            language: Language::Rust,
            companions: vec![],
            name: None,
            scalar: Scalar::F64,
            command: "gelenk generate".to_owned(),
            longest_function: LONGEST_FUNCTION,
        }
    }
}

/// The text of a generated module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Name of the module; the file is `<name>.rs` or `<name>.c`.
    pub name: String,
    /// Text of the module.
    pub text: String,
    /// Text of `<name>.h`, for a C module.
    pub header: Option<String>,
    /// Additional files: suffix of the module's name, and text.
    pub companions: Vec<(&'static str, String)>,
    /// Calling convention of a C module.
    pub interface: Option<Interface>,
}

impl SourceFile {
    /// Files of the module: suffix of its name, and text.
    #[must_use]
    pub fn files(&self) -> Vec<(&'static str, &str)> {
        let mut files = match &self.header {
            None => vec![(".rs", self.text.as_str())],
            Some(header) => vec![(".h", header.as_str()), (".c", &self.text)],
        };
        files.extend(self.companions.iter().map(|(ending, text)| (*ending, text.as_str())));
        files
    }
}

/// The language of a generated module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Language {
    /// One file, `<name>.rs`.
    #[default]
    Rust,
    /// C99 that also compiles as C++: `<name>.h` and `<name>.c`. Only Rust modules can contain tests.
    C,
}

/// Additional file of a C module, for a tool that calls it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Companion {
    /// `<name>_acados.c` and `<name>_acados.py`: discrete dynamics in double precision, and an optimal
    /// control problem with these dynamics.
    Acados,
    /// `<name>_casadi.c`: external functions with their Jacobians, in double precision.
    Casadi,
    /// `<name>_python.c`: loops over many states for NumPy.
    Python,
}

/// Number type of a generated module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scalar {
    /// Double precision.
    #[default]
    F64,
    /// Single precision: constants are rounded once, and all operations are in single precision.
    F32,
}

impl Scalar {
    /// Name of the type.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}
