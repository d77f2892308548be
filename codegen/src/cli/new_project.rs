//! The files of a new project besides its robot, in each language.

/// A project.
pub(super) struct Project {
    /// Names and texts.
    pub(super) files: Vec<(&'static str, String)>,
    /// What the files do, after the description.
    pub(super) made: &'static str,
    /// The command that runs it.
    pub(super) next: &'static str,
}

impl Project {
    /// A crate.
    pub(super) fn rust(manifest: String, build: &str) -> Self {
        Self {
            files: vec![
                ("Cargo.toml", manifest),
                ("build.rs", build.to_owned()),
                ("src/main.rs", include_str!("template/main.rs").to_owned()),
                (".gitignore", "/target\n/report\n".to_owned()),
            ],
            made: "build.rs generates its equations, src/main.rs simulates it",
            next: "cargo run",
        }
    }

    /// A Makefile and a program in C.
    pub(super) fn c() -> Self {
        Self {
            files: vec![
                ("Makefile", include_str!("template/Makefile").to_owned()),
                ("main.c", include_str!("template/main.c").to_owned()),
                (".gitignore", "/simulation\n/robot.c\n/robot.h\n/report\n".to_owned()),
            ],
            made: "the Makefile generates its equations, main.c simulates it",
            next: "make run",
        }
    }

    /// A program in Python.
    ///
    /// - `requirement`: the package `gelenk` as pip takes it
    pub(super) fn python(requirement: &str) -> Self {
        let requirements = format!(
            "# The package has the program gelenk, which generates C: a C compiler compiles it.\n{requirement}\n"
        );
        Self {
            files: vec![
                ("main.py", include_str!("template/main.py").to_owned()),
                ("requirements.txt", requirements),
                (".gitignore", "/.venv\n/report\n__pycache__\n".to_owned()),
            ],
            made: "main.py generates its equations and simulates it",
            next: "python3 -m venv .venv && .venv/bin/pip install -r requirements.txt && .venv/bin/python main.py",
        }
    }
}
