//! Interface for build scripts.

use std::path::{Path, PathBuf};

use super::cargo::{command, warn, watch};
use super::modules::{BuildError, Robot, write};
use super::out_dir::OutDir;
use crate::diagnostic::Diagnostics;
use crate::emit::{Language, Scalar};
use crate::pipeline::{self, GenerateOptions, Generated};
use gelenk_files::is_same_file;

/// Generates `$OUT_DIR/<name>.rs` from a description, for `build.rs`. `<name>` is the name of the robot. In a
/// TOML file, the name is the key `name`, or the file name if this key is missing. In a URDF, it is the name of
/// `<robot>`.
///
/// If the description has errors, the build script prints all of them and ends with exit code 1. Cargo watches every
/// file that was read. The path `description` is relative to the package.
pub fn build(description: impl AsRef<Path>) {
    Builder::new().description(description).generate();
}

/// Options of a build script, which generates modules like [`build`].
///
/// ```no_run
/// gelenk_codegen::Builder::new()
///     .description("arm.urdf")
///     .functions(["inverse_dynamics", "mass_matrix"])
///     .snap_angles(1e-4)
///     .generate();
/// ```
#[derive(Debug, Clone, Default)]
pub struct Builder {
    descriptions: Vec<PathBuf>,
    options: GenerateOptions,
    folder: Option<PathBuf>,
    control_model: Option<f64>,
    hides_notes: bool,
}

impl Builder {
    /// Creates a builder without descriptions.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a TOML, URDF or MJCF description. The path is relative to the package.
    #[must_use]
    pub fn description(mut self, path: impl AsRef<Path>) -> Self {
        self.descriptions.push(path.as_ref().to_owned());
        self
    }

    /// Generates only the functions with these names, and the functions that they call.
    #[must_use]
    pub fn functions<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.options.functions = names.into_iter().map(Into::into).collect();
        self
    }

    /// Sets the language of the modules. C modules consist of `<name>.h` and `<name>.c`, which a build script
    /// can compile with the crate `cc`. `include_model!` requires Rust.
    #[must_use]
    pub fn language(mut self, language: Language) -> Self {
        self.options.emit.language = language;
        self
    }

    /// Sets the number type of the modules.
    #[must_use]
    pub fn scalar(mut self, scalar: Scalar) -> Self {
        self.options.emit.scalar = scalar;
        self
    }

    /// Rounds an angle to a multiple of 90° if they differ by at most this value \[rad\].
    #[must_use]
    pub fn snap_angles(mut self, radians: f64) -> Self {
        self.options.reading.snap_angles = Some(radians);
        self
    }

    /// Leaves out the friction of all joints and drives.
    #[must_use]
    pub fn no_friction(mut self) -> Self {
        self.options.reading.no_friction = true;
        self
    }

    /// Accepts robots whose mass matrix is not positive definite. A warning then replaces the error.
    #[must_use]
    pub fn accept_unphysical(mut self) -> Self {
        self.options.reading.accept_unphysical = true;
        self
    }

    /// Ignores the mimic tags of a URDF: mimic joints become independent joints.
    #[must_use]
    pub fn ignore_mimic(mut self) -> Self {
        self.options.reading.ignore_mimic = true;
        self
    }

    /// Makes the base floating. A floating joint then connects the base to the world.
    #[must_use]
    pub fn floating_base(mut self) -> Self {
        self.options.reading.floating_base = true;
        self
    }

    /// Replaces `sign(v)` by `tanh(slope · v)` in friction and springs. The slope must be positive.
    #[must_use]
    pub fn smooth_sign(mut self, slope: f64) -> Self {
        self.options.reading.smooth_sign = Some(slope);
        self
    }

    /// Writes two modules per description:
    ///
    /// - `<name>` with the exact `sign(v)`, for plants
    /// - `<name>_control` with `tanh(slope · v)` instead of `sign(v)` in friction and springs, for controllers
    ///
    /// Controllers need the derivatives of friction, and the derivative of an exact sign is zero. Plants need
    /// the exact law, because they would creep at standstill with the smooth law.
    ///
    /// ```no_run
    /// gelenk_codegen::Builder::new().description("robot.toml").control_model(50.0).generate();
    /// ```
    #[must_use]
    pub fn control_model(mut self, slope: f64) -> Self {
        self.control_model = Some(slope);
        self
    }

    /// Also generates variants of these functions that evaluate eight states at once. Without this call, the
    /// description selects the functions. Names are checked as in [`functions`](Self::functions).
    #[must_use]
    pub fn lanes<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.options.lanes = names.into_iter().map(Into::into).collect();
        self
    }

    /// Fuses products and sums to multiply-adds with one rounding. The modules then require std and a
    /// processor with these instructions.
    #[must_use]
    pub fn fused_multiply_add(mut self) -> Self {
        self.options.fused_multiply_add = true;
        self
    }

    /// Adds tests to each module. They compare the module's functions at pseudo-random states with the
    /// generator's interpreter. `cargo test` runs them on the target machine.
    #[must_use]
    pub fn self_test(mut self) -> Self {
        self.options.self_test = true;
        self
    }

    /// Sets the largest number of operations of a generated function. Larger functions and their callers are omitted with a note. A
    /// larger function that was requested by name is an error. The default is
    /// [`MOST_OPERATIONS`](crate::functions::size::MOST_OPERATIONS).
    #[must_use]
    pub fn max_operations(mut self, count: usize) -> Self {
        self.options.max_operations = Some(count);
        self
    }

    /// Hides the notes about the descriptions. Without this call, each note becomes a Cargo warning, which is
    /// shown in one build only.
    #[must_use]
    pub fn hide_notes(mut self) -> Self {
        self.hides_notes = true;
        self
    }

    /// Writes to this folder instead of `$OUT_DIR`.
    #[must_use]
    pub fn output_folder(mut self, folder: impl AsRef<Path>) -> Self {
        self.folder = Some(folder.as_ref().to_owned());
        self
    }

    /// Generates all descriptions. If there are errors, prints them and ends the process with exit code 1.
    pub fn generate(self) {
        if let Err(error) = self.try_generate() {
            eprintln!("{error}");
            std::process::exit(1);
        }
    }

    /// Generates all descriptions and returns the paths of the written files. If a description has errors, no
    /// file is written.
    ///
    /// Modules that this build script generated earlier and no longer writes, for example because a robot was
    /// renamed, are removed from `$OUT_DIR`. Other folders keep such modules.
    ///
    /// # Errors
    /// [`BuildError`] with the problems of all descriptions.
    pub fn try_generate(mut self) -> Result<Vec<PathBuf>, BuildError> {
        let out_dir = std::env::var_os("OUT_DIR").map(PathBuf::from);
        let folder = self.folder.clone().or_else(|| out_dir.clone());
        let folder = folder.ok_or(BuildError::NoFolder)?;
        self.options.emit.command = command();
        let robots = self.derive_all()?;
        refuse_same_names(&robots)?;
        let is_rust = self.options.emit.language == Language::Rust;
        if is_rust && out_dir.is_some_and(|out_dir| is_same_file(&out_dir, &folder)) {
            return OutDir::new(folder).write(&robots, self.hides_notes);
        }
        let notes = robots.iter().flat_map(|robot| robot.generated.notes.entries());
        notes.filter(|_| !self.hides_notes).for_each(warn);
        write(&folder, &robots)
    }

    fn derive_all(&self) -> Result<Vec<Robot>, BuildError> {
        if self.descriptions.is_empty() {
            return Err(BuildError::NothingToDo);
        }
        let (mut robots, mut problems) = (Vec::new(), Vec::new());
        for description in &self.descriptions {
            watch(description);
            match self.derive(description) {
                Ok(derived) => robots.extend(
                    derived
                        .into_iter()
                        .map(|generated| Robot { description: description.clone(), generated }),
                ),
                Err(diagnostics) => problems.push(diagnostics),
            }
        }
        if !problems.is_empty() {
            return Err(BuildError::Descriptions(problems));
        }
        let read = robots.iter().flat_map(|robot| &robot.generated.files);
        let mut read: Vec<&PathBuf> = read.filter(|file| !self.descriptions.contains(file)).collect();
        read.dedup();
        read.into_iter().for_each(|file| watch(file));
        Ok(robots)
    }

    fn derive(&self, description: &Path) -> Result<Vec<Generated>, Diagnostics> {
        match self.control_model {
            Some(slope) => pipeline::generate_pair(description, &self.options, slope).map(Vec::from),
            None => pipeline::generate(description, &self.options).map(|robot| vec![robot]),
        }
    }
}

fn refuse_same_names(robots: &[Robot]) -> Result<(), BuildError> {
    let names = robots.iter().map(|robot| robot.generated.source.name.as_str());
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(BuildError::SameName(pair[0].to_owned())),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_is_missing() {
        let folder = tempfile::tempdir().unwrap();
        let builder = || Builder::new().output_folder(folder.path());
        assert!(matches!(builder().try_generate(), Err(BuildError::NothingToDo)));
        let error =
            builder().description("no.toml").description("none.urdf").try_generate().unwrap_err().to_string();
        assert!(error.contains("no.toml") && error.contains("none.urdf"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_pair_is_two_modules_and_neither_takes_the_name_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let joint = "[[joints]]\nname = \"swing\"\nfriction = { coulomb = 1 }\n[[bodies]]\nlink = \"swing\"\nmass = 1\ninertia = 1\n";
        let description = |name: &str| {
            let path = folder.path().join(format!("{name}.toml"));
            std::fs::write(&path, joint).unwrap();
            path
        };
        let output = folder.path().join("out");
        let builder = || {
            let builder = Builder::new().output_folder(&output).control_model(50.0);
            builder.functions(["friction_torques"]).description(description("arm"))
        };
        let names = |paths: Vec<PathBuf>| -> Vec<String> {
            let names = paths.iter().filter_map(|path| path.file_name()?.to_str());
            names.map(str::to_owned).collect()
        };
        let paths = builder().try_generate().unwrap();
        assert_eq!(names(paths), ["arm.rs", "arm_control.rs"]);
        let text = |name: &str| std::fs::read_to_string(output.join(name)).unwrap();
        assert!(text("arm.rs").contains("sign(v[0])"));
        assert!(text("arm_control.rs").contains("math::tanh("));
        // A robot of that name would be written over, or write over.
        let both = builder().description(description("arm_control"));
        let error = both.try_generate().unwrap_err();
        assert!(matches!(&error, BuildError::SameName(name) if name == "arm_control"), "{error}");
    }
}
