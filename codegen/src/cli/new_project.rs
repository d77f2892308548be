//! The files of a new project besides its robot, in each language.

use super::new_feet;
use super::new_robot::Robot;

/// A project.
pub(super) struct Project {
    /// Names and texts.
    pub(super) files: Vec<(&'static str, String)>,
    /// Purpose of the generated files; follows the description's name.
    pub(super) made: &'static str,
    /// The command that runs it.
    pub(super) next: &'static str,
}

impl Project {
    /// A crate.
    pub(super) fn rust(manifest: String, robot: &Robot) -> Self {
        let (main, made) = match (robot.floats, robot.feet.len()) {
            (true, 0) => (
                include_str!("template/main_floating.rs").to_owned(),
                "build.rs generates its equations, src/main.rs simulates it under control",
            ),
            (true, count) => (
                new_feet::program(count),
                "build.rs generates its equations, src/main.rs lets it stand on its feet, by given forces",
            ),
            (false, _) => (
                include_str!("template/main.rs").to_owned(),
                "build.rs generates its equations, src/main.rs simulates it",
            ),
        };
        Self {
            files: vec![
                ("Cargo.toml", manifest),
                ("build.rs", robot.build.to_owned()),
                ("src/main.rs", main),
                (".gitignore", "/target\n/report\n".to_owned()),
            ],
            made,
            next: "cargo run",
        }
    }

    /// A Makefile and a program in C.
    ///
    /// - `floats`: the base of the robot moves freely, also in Python
    pub(super) fn c(floats: bool) -> Self {
        let main = match floats {
            true => include_str!("template/main_floating.c"),
            false => include_str!("template/main.c"),
        };
        Self {
            files: vec![
                ("Makefile", include_str!("template/Makefile").to_owned()),
                ("main.c", main.to_owned()),
                (".gitignore", "/simulation\n/robot.c\n/robot.h\n/report\n".to_owned()),
            ],
            made: "the Makefile generates its equations, main.c simulates it",
            next: "make run",
        }
    }

    /// A program in Python.
    ///
    /// - `requirement`: the package `gelenk` as pip takes it
    pub(super) fn python(requirement: &str, floats: bool) -> Self {
        let main = match floats {
            true => include_str!("template/main_floating.py"),
            false => include_str!("template/main.py"),
        };
        let requirements = format!(
            "# The package has the program gelenk, which generates C: a C compiler compiles it.\n{requirement}\n"
        );
        Self {
            files: vec![
                ("main.py", main.to_owned()),
                ("requirements.txt", requirements),
                (".gitignore", "/.venv\n/report\n__pycache__\n".to_owned()),
            ],
            made: "main.py generates its equations and simulates it",
            next: "python3 -m venv .venv && .venv/bin/pip install -r requirements.txt && .venv/bin/python main.py",
        }
    }
}
