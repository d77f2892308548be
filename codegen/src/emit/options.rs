//! Options for printing modules: language, number type, names and additional files.

use super::interface::Interface;

/// Default of [`EmitOptions::longest_function`].
///
/// In a build with debug information, for example in Cargo's dev profile, rustc 1.95 nests one scope for each
/// `let`, and LLVM visits the scopes recursively. A function of 2800 statements compiles. A function of 3200
/// statements overflows the stack of 2 MB of LLVM's thread, which ends rustc.
///
/// Without debug information at opt-level 3, 9000 statements need 0.9 s and 200 MB, and 28 000 statements
/// need 4 s and 490 MB. In these builds, parts of shorter functions are inlined, which does not nest scopes.
const LONGEST_FUNCTION: usize = 2_000;

/// Options for printing a module.
#[derive(Debug, Clone, PartialEq)]
pub struct EmitOptions {
    /// Programming language of the module.
    pub language: Language,
    /// Additional files for tools that call C modules.
    pub companions: Vec<Companion>,
    /// Name of the module. The files have this name, and in C it is also the prefix of all names. If `None`,
    /// the name is made from the robot's name.
    pub name: Option<String>,
    /// Number type of all functions and constants of the module.
    pub scalar: Scalar,
    /// Command that regenerates the module. The comment at the top of each file contains it. It must not
    /// contain absolute paths.
    pub command: String,
    /// Largest number of statements of a printed function. Longer programs are split into private functions.
    /// Straight-line functions in C may have five times this number of statements.
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

/// The text of a generated module and of its additional files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Name of the module. Its file is `<name>.rs` or `<name>.c`.
    pub name: String,
    /// Text of the file `<name>.rs` or `<name>.c`.
    pub text: String,
    /// Text of the header `<name>.h`; `None` for a Rust module.
    pub header: Option<String>,
    /// Files for acados, CasADi and Python. Each entry has the suffix that follows the module's name, and the
    /// text.
    pub companions: Vec<(&'static str, String)>,
    /// Signatures and documentation of the functions; `None` for a Rust module.
    pub interface: Option<Interface>,
}

impl SourceFile {
    /// All files of the module. Each entry has the suffix that follows the module's name, and the text.
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
    /// Rust, in one file `<name>.rs`.
    #[default]
    Rust,
    /// C99 that also compiles as C++, in two files `<name>.h` and `<name>.c`. C modules do not support
    /// self-tests.
    C,
}

/// Additional file of a C module for a tool that calls the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Companion {
    /// Files `<name>_acados.c` and `<name>_acados.py`: discrete dynamics in double precision, and an optimal
    /// control problem with them.
    Acados,
    /// File `<name>_casadi.c`: external functions with Jacobians, in double precision.
    Casadi,
    /// File `<name>_python.c`: loops over many states for NumPy.
    Python,
}

/// Number type of a generated module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scalar {
    /// Double precision (`f64`, `double`).
    #[default]
    F64,
    /// Single precision (`f32`, `float`). Constants are rounded once, and all operations are in single
    /// precision.
    F32,
}

impl Scalar {
    /// Name of the number type in Rust: `f64` or `f32`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}
