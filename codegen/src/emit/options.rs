//! How a module is printed.

use super::interface::Interface;

/// Largest number of statements of one function. With debug information, as in Cargo's dev profile, rustc 1.95 nests
/// one scope for each `let`, and LLVM recurses over them: 2 800 statements compile, 3 200 overflow the 2 MB
/// of its thread's stack and end rustc. Without it, at opt-level 3, 9 000 statements need 0.9 s and 200 MB,
/// 28 000 need 4 s and 490 MB: there parts of shorter functions are inlined, which makes no scopes within each other.
const LONGEST_FUNCTION: usize = 2_000;

/// How a module is printed.
#[derive(Debug, Clone, PartialEq)]
pub struct EmitOptions {
    /// The language of the module.
    pub language: Language,
    /// Further files for tools that call modules in C.
    pub companions: Vec<Companion>,
    /// Name of the module, if it is not the robot's: that of its files, and in C the beginning of its names.
    pub name: Option<String>,
    /// Number type of all functions and constants.
    pub scalar: Scalar,
    /// Where sine, cosine, tanh and exp come from.
    pub math: Math,
    /// The command that makes the file again, for its header, without absolute paths.
    pub command: String,
    /// Largest number of statements of a function; longer programs are split into private functions. Straight-line code in C
    /// may have five times as many.
    pub longest_function: usize,
}

impl Default for EmitOptions {
    fn default() -> Self {
        Self {
            language: Language::Rust,
            companions: vec![],
            name: None,
            scalar: Scalar::F64,
            math: Math::Embedded,
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
    /// Its whole text.
    pub text: String,
    /// The text of `<name>.h`, for a module in C.
    pub header: Option<String>,
    /// The further files: suffix of the module's name, and text of each.
    pub companions: Vec<(&'static str, String)>,
    /// How a module in C is called.
    pub interface: Option<Interface>,
}

impl SourceFile {
    /// The files of the module: suffix of its name, and text of each.
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
    /// C99 that is C++ too: `<name>.h` and `<name>.c`. Only Rust has tests in the module.
    C,
}

/// Files next to a module in C, for a tool that calls it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Companion {
    /// `<name>_acados.c` and `<name>_acados.py`: discrete dynamics in double precision, and an optimal control problem
    /// with them.
    Acados,
    /// `<name>_casadi.c`: external functions with their Jacobians, in double precision.
    Casadi,
    /// `<name>_python.c`: loops over many states, as NumPy calls them.
    Python,
}

/// Number type of a generated module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scalar {
    /// Double precision.
    #[default]
    F64,
    /// Single precision: every constant is rounded to it once, then all operations are in it.
    F32,
}

impl Scalar {
    /// The type's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}

/// Source of the functions that a module calls.
///
/// The interpreter must run with the same ones ([`crate::program::interpret::Functions`]), else the bits
/// differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Math {
    /// Our own functions, pasted into the module: `math::sin_cos(x)`. Only what is called, and what that
    /// requires. They need neither std nor libm and give the same bits everywhere.
    #[default]
    Embedded,
    /// Methods of std: `x.sin_cos()`.
    Std,
}
