//! The C and C++ compilers at hand.

use std::path::Path;
use std::process::Command;

/// Warnings that a module must not cause.
const WARNINGS: [&str; 4] = ["-Wall", "-Wextra", "-Werror", "-pedantic"];

/// A compiler with the words that choose its language.
pub struct Compiler {
    words: Vec<String>,
}

/// `cc` and `c++` where they are, and those that `GELENK_CC` names; a note where there is none.
pub fn c_compilers() -> Vec<Compiler> {
    let mut commands = vec!["cc -std=c99".to_owned(), "c++ -x c++".to_owned()];
    for other in std::env::var("GELENK_CC").unwrap_or_default().split(';').filter(|each| !each.is_empty()) {
        commands.extend([format!("{other} -std=c99"), format!("{other} -x c++")]);
    }
    let compilers = commands.iter().map(|command| Compiler::new(command));
    compilers.filter(Compiler::is_there).collect()
}

/// Those of C, whose programs are run, and the others, which only look for warnings.
pub fn c_and_others() -> (Vec<Compiler>, Vec<Compiler>) {
    c_compilers().into_iter().partition(|compiler| compiler.words.iter().any(|word| word == "-std=c99"))
}

impl Compiler {
    fn new(command: &str) -> Self {
        Self { words: command.split_whitespace().map(str::to_owned).collect() }
    }

    fn is_there(&self) -> bool {
        let is_there = self.command().arg("--version").output().is_ok_and(|output| output.status.success());
        if !is_there {
            println!("skipped: no compiler {}", self.name());
        }
        is_there
    }

    /// The command line.
    pub fn name(&self) -> String {
        self.words.join(" ")
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.words[0]);
        command.args(&self.words[1..]);
        command
    }

    /// Makes `c_main` of `main.c` and `robot.c`. It is linked without the mathematical library: a call would not be
    /// found. Square roots are the processor's instruction where they need not set `errno`.
    ///
    /// # Errors
    /// What the compiler said.
    pub fn compile(&self, folder: &Path, is_fused: bool) -> Result<(), String> {
        self.run(folder, is_fused, &["-O2", "-fno-math-errno", "main.c", "robot.c", "-o", "c_main"])
    }

    /// Makes an object of `robot.c`. Unlike [`Self::check`] gcc then warns of functions that nothing calls, and of numbers
    /// that it takes for unset where it inlines much.
    ///
    /// # Errors
    /// What the compiler said.
    pub fn compile_alone(&self, folder: &Path) -> Result<(), String> {
        self.run(folder, false, &["-O3", "-c", "robot.c", "-o", "robot.o"])
    }

    /// Looks for warnings only.
    ///
    /// # Errors
    /// What the compiler said.
    pub fn check(&self, folder: &Path, is_fused: bool) -> Result<(), String> {
        self.run(folder, is_fused, &["-fsyntax-only", "main.c", "robot.c"])
    }

    fn run(&self, folder: &Path, is_fused: bool, arguments: &[&str]) -> Result<(), String> {
        let mut command = self.command();
        command.current_dir(folder).args(WARNINGS).args(arguments);
        if is_fused {
            command.arg("-mfma");
        }
        let output = command.output().map_err(|error| error.to_string())?;
        match output.status.success() {
            true => Ok(()),
            false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
        }
    }
}
