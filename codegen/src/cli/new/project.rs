//! Files of a new project in each language, from the templates, without its robot.

use super::super::failure::Failure;
use super::robot::Robot;
use super::source::Source;

/// Files of a new project, and texts for messages about it.
pub(super) struct Project {
    /// Names and texts of the project's files.
    pub(super) files: Vec<(&'static str, String)>,
    /// Purpose of the generated files, as the end of a message.
    pub(super) made: &'static str,
    /// Command that runs the new project.
    pub(super) next: &'static str,
}

impl Project {
    /// Creates the files of a Rust crate.
    ///
    /// - `learns`: whether its program learns friction
    pub(super) fn rust(name: &str, source: &Source, robot: &Robot, learns: bool) -> Self {
        let (main, made) = match (learns, robot.floats) {
            (true, _) => (
                include_str!("../template/rust/main_online_friction.rs"),
                "build.rs generates its equations, and src/main.rs moves it and learns its friction",
            ),
            (false, true) => (
                include_str!("../template/rust/main_floating.rs"),
                "build.rs generates its equations, and src/main.rs simulates it under control",
            ),
            (false, false) => (
                include_str!("../template/rust/main.rs"),
                "build.rs generates its equations, and src/main.rs simulates it",
            ),
        };
        // With dry friction, the plant gets the exact model and controllers get a smooth model.
        let build = match robot.has_dry_friction {
            true => include_str!("../template/rust/build_both.rs"),
            false => include_str!("../template/rust/build.rs"),
        };
        let values = [
            ("MY_CRATE", name.to_owned()),
            ("RUNTIME", source.key("runtime")),
            ("CODEGEN", source.key("codegen")),
        ];
        let texts = [
            ("Cargo.toml", include_str!("../template/rust/manifest.toml")),
            ("build.rs", build),
            ("src/main.rs", main),
            (".gitignore", include_str!("../template/rust/gitignore")),
        ];
        Self { files: all_filled(&texts, &values), made, next: "cargo run" }
    }

    /// Creates the files of a C project with a Makefile.
    ///
    /// - `floats`: whether the base is floating
    pub(super) fn c(floats: bool) -> Self {
        let main = match floats {
            true => include_str!("../template/c/main_floating.c"),
            false => include_str!("../template/c/main.c"),
        };
        let texts = [
            ("Makefile", include_str!("../template/c/Makefile")),
            ("main.c", main),
            (".gitignore", include_str!("../template/c/gitignore")),
        ];
        Self {
            files: all_filled(&texts, &[]),
            made: "the Makefile generates its equations, and main.c simulates it",
            next: "make run",
        }
    }

    /// Creates the files of a ROS 2 package for ros2_control.
    pub(super) fn ros2(name: &str, joints: &[String]) -> Self {
        let list = |text: &dyn Fn(&str) -> String| {
            joints.iter().map(|joint| text(joint)).collect::<Vec<_>>().join(", ")
        };
        let values = [
            ("my_package", name.to_owned()),
            ("MY_PACKAGE", name.to_uppercase()),
            ("ALL_JOINTS", list(&yaml_text)),
            ("REFERENCES", list(&|joint| yaml_text(&format!("computed_torque/{joint}")))),
            ("POSITION_GAINS", list(&|_| "100.0".to_owned())),
            ("VELOCITY_GAINS", list(&|_| "20.0".to_owned())),
        ];
        let texts = [
            ("CMakeLists.txt", include_str!("../template/ros2/CMakeLists.txt")),
            ("package.xml", include_str!("../template/ros2/package.xml")),
            ("controllers.xml", include_str!("../template/ros2/controllers.xml")),
            ("config/controllers.yaml", include_str!("../template/ros2/controllers.yaml")),
            ("src/joints.hpp", include_str!("../template/ros2/joints.hpp")),
            ("src/gravity_compensation.cpp", include_str!("../template/ros2/gravity_compensation.cpp")),
            ("src/computed_torque.cpp", include_str!("../template/ros2/computed_torque.cpp")),
            (".gitignore", include_str!("../template/ros2/gitignore")),
        ];
        Self {
            files: all_filled(&texts, &values),
            made: "CMakeLists.txt generates its equations, src/ has controllers for ros2_control, and \
                   config/ has their parameters",
            next: "colcon build",
        }
    }

    /// Creates the files of a Python project.
    pub(super) fn python(source: &Source, floats: bool) -> Result<Self, Failure> {
        let main = match floats {
            true => include_str!("../template/python/main_floating.py"),
            false => include_str!("../template/python/main.py"),
        };
        let texts = [
            ("main.py", main),
            ("requirements.txt", include_str!("../template/python/requirements.txt")),
            (".gitignore", include_str!("../template/python/gitignore")),
        ];
        Ok(Self {
            files: all_filled(&texts, &[("REQUIREMENT", source.requirement()?)]),
            made: "main.py generates its equations and simulates it",
            next: "python3 -m venv .venv && .venv/bin/pip install -r requirements.txt && .venv/bin/python main.py",
        })
    }
}

/// The text as a string of YAML. Each JSON string is also a YAML string.
fn yaml_text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn all_filled(texts: &[(&'static str, &str)], values: &[(&str, String)]) -> Vec<(&'static str, String)> {
    texts.iter().map(|(file, text)| (*file, filled(text, values))).collect()
}

/// A template with values for its placeholders. A value that contains a placeholder stays as it is.
pub(super) fn filled(text: &str, values: &[(&str, String)]) -> String {
    let places = values.iter().filter_map(|(name, value)| Some((text.find(name)?, name, value)));
    match places.min() {
        None => text.to_owned(),
        Some((at, name, value)) => {
            format!("{}{value}{}", &text[..at], filled(&text[at + name.len()..], values))
        }
    }
}
