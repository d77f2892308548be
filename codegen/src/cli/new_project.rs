//! Files of a new project in each language, without the files of the robot.

use super::new_feet;
use super::new_robot::Robot;

/// A new project.
pub(super) struct Project {
    /// Paths and texts of the files.
    pub(super) files: Vec<(&'static str, String)>,
    /// Text about the purpose of the files, for the end of a message.
    pub(super) made: &'static str,
    /// Command that runs the project.
    pub(super) next: &'static str,
}

impl Project {
    /// A Rust crate.
    pub(super) fn rust(manifest: String, robot: &Robot) -> Self {
        let (main, made) = match (robot.floats, robot.feet.len()) {
            (true, 0) => (
                include_str!("template/main_floating.rs").to_owned(),
                "build.rs generates its equations, and src/main.rs simulates it under control",
            ),
            (true, count) => (
                new_feet::program(count),
                "build.rs generates its equations, and src/main.rs lets it stand with chosen forces at its feet",
            ),
            (false, _) => (
                include_str!("template/main.rs").to_owned(),
                "build.rs generates its equations, and src/main.rs simulates it",
            ),
        };
        Self::of_crate(manifest, robot, main, made)
    }

    /// A Rust crate whose program learns friction.
    pub(super) fn online_friction(manifest: String, robot: &Robot) -> Self {
        let made = "build.rs generates its equations, and src/main.rs moves it and learns its friction";
        Self::of_crate(manifest, robot, include_str!("template/main_online_friction.rs").to_owned(), made)
    }

    fn of_crate(manifest: String, robot: &Robot, main: String, made: &'static str) -> Self {
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

    /// A C project with a Makefile.
    ///
    /// - `floats`: whether the base is floating
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
            made: "the Makefile generates its equations, and main.c simulates it",
            next: "make run",
        }
    }

    /// A ROS 2 package for ros2_control.
    ///
    /// - `name`: name of the package
    pub(super) fn ros2(name: &str, joints: &[String]) -> Self {
        let list = |text: &dyn Fn(&str) -> String| {
            joints.iter().map(|joint| text(joint)).collect::<Vec<_>>().join(", ")
        };
        let yaml = include_str!("template/ros2/controllers.yaml")
            .replace("JOINTS", &list(&yaml_text))
            .replace("REFERENCES", &list(&|joint| yaml_text(&format!("computed_torque/{joint}"))))
            .replace("POSITION_GAINS", &list(&|_| "100.0".to_owned()))
            .replace("VELOCITY_GAINS", &list(&|_| "20.0".to_owned()));
        let texts = [
            ("CMakeLists.txt", include_str!("template/ros2/CMakeLists.txt")),
            ("package.xml", include_str!("template/ros2/package.xml")),
            ("controllers.xml", include_str!("template/ros2/controllers.xml")),
            ("config/controllers.yaml", &yaml),
            ("src/joints.hpp", include_str!("template/ros2/joints.hpp")),
            ("src/gravity_compensation.cpp", include_str!("template/ros2/gravity_compensation.cpp")),
            ("src/computed_torque.cpp", include_str!("template/ros2/computed_torque.cpp")),
            (".gitignore", "/build\n/install\n/log\n/report\n"),
        ];
        let named = |text: &str| text.replace("my_package", name).replace("MY_PACKAGE", &name.to_uppercase());
        Self {
            files: texts.into_iter().map(|(file, text)| (file, named(text))).collect(),
            made: "CMakeLists.txt generates its equations, src/ has controllers for ros2_control, and \
                   config/ has their parameters",
            next: "colcon build",
        }
    }

    /// A Python project.
    ///
    /// - `requirement`: the package `gelenk` in the form for pip
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

/// The text as a string of YAML, for which strings of JSON are valid.
fn yaml_text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
