//! Modules for choices that the robots of models/ do not make: lanes of functions without angles, single
//! functions, f32, fused operations, free parameters. Each compiles without a warning.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write as _;
use std::path::Path;

use fastrand::Rng;
use gelenk_codegen::emit::{EmitOptions, Scalar};
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_tests::compiler::clippy;
use gelenk_tests::workspace;

/// A joint with a drive with a rotor, friction and a spring; `#` numbers it.
const JOINT: &str = r#"
[[joints]]
name = "j#"
type = "TYPE"
axis = AXIS
origin = { xyz = [0.1, 0.2, 0.3], rpy = [0.1, 0, 0] }
drive = { gear_ratio = 20, rotor_inertia = INERTIA }
friction = FRICTION
spring = { stiffness = 3, rest = 0.1 }
"#;

/// A joint with a quaternion, with friction and a damper.
const QUATERNION_JOINT: &str = r#"
[[joints]]
name = "j#"
type = "TYPE"
origin = { xyz = [0.1, 0.2, 0.3], rpy = [0.1, 0, 0] }
drive = "ideal"
friction = { rx = FRICTION }
spring = { rz = { damping = 0.2 } }
"#;

/// The body of a joint, and a frame on it.
const BODY: &str = r#"
[[bodies]]
link = "j#"
mass = MASS
center_of_mass = [0.01, 0.02, 0.1]
inertia = [0.1, 0.1, 0.1]
[[frames]]
name = "f#"
link = "j#"
origin = { xyz = [0, 0, 0.5] }
"#;

/// A chain of joints, `p`rismatic, `r`evolute, `h`elical, `s`pherical or `f`loating.
fn chain(kinds: &str, is_free: bool) -> String {
    let mut text = String::from("description = \"A chain.\"\n");
    for (index, kind) in kinds.chars().enumerate() {
        let (kind, axis) = match kind {
            'p' => ("prismatic", "[0, 0, 1]"),
            'h' => ("helical\"\npitch = \"0.02", "[0, 1, 0]"),
            's' => ("spherical", ""),
            'f' => ("floating", ""),
            _ => ("revolute", "[0, 1, 0]"),
        };
        let (mass, friction, inertia) = match is_free {
            true => ("{ free = 2.0 }", "{ coulomb = { free = 0.3 }, viscous = 0.1 }", "{ free = 1e-4 }"),
            false => ("2.0", "\"0.1*v + 0.2*tanh(5*v)\"", "1e-4"),
        };
        let joint = if axis.is_empty() { QUATERNION_JOINT } else { JOINT };
        let joint = format!("{joint}{BODY}")
            .replace('#', &index.to_string())
            .replace("TYPE", kind)
            .replace("AXIS", axis)
            .replace("MASS", mass)
            .replace("FRICTION", friction)
            .replace("INERTIA", inertia);
        text.push_str(&joint);
    }
    text
}

/// Several modules in one crate: one run of the compiler.
#[derive(Default)]
struct Crate {
    text: String,
    modules: usize,
}

impl Crate {
    fn add(&mut self, description: &Path, options: &GenerateOptions) {
        let robot = generate(description, options).unwrap_or_else(|problems| panic!("{problems}"));
        let name = self.modules;
        // The header says what a warning is about.
        let _ = writeln!(
            self.text,
            "/// Robot.\npub mod m{name} {{\n// {} {:?} {:?} lanes {:?}\n{}}}",
            description.display(),
            options.emit.scalar,
            options.functions,
            options.lanes,
            robot.source.text
        );
        self.modules += 1;
    }

    fn check(&self, flags: &[&str]) {
        let text = format!(
            "#![deny(warnings, missing_docs, clippy::all, nonstandard_style, future_incompatible)]\n//! Robots.\n{}",
            self.text
        );
        let folder = tempfile::tempdir().expect("a folder");
        let arguments = [&["--crate-type", "lib", "--emit", "metadata"], flags].concat();
        let result = clippy(folder.path(), "robots", &text, &arguments);
        result.unwrap_or_else(|message| panic!("{message}"));
    }
}

fn options(functions: &[String], lanes: &[String], scalar: Scalar) -> GenerateOptions {
    GenerateOptions {
        functions: functions.to_vec(),
        emit: EmitOptions { scalar, ..EmitOptions::default() },
        lanes: lanes.to_vec(),
        ..GenerateOptions::default()
    }
}

/// Names of all functions that a robot has.
fn functions(description: &Path) -> Vec<String> {
    let robot = generate(description, &GenerateOptions::default());
    let robot = robot.unwrap_or_else(|problems| panic!("{problems}"));
    robot.module.costs().into_iter().map(|(name, _)| name).collect()
}

/// `all` has the functions of a description that chooses none, and takes those on request with it.
#[test]
fn all_functions_are_a_choice() {
    let names = |robot: &str, functions: &[&str]| {
        let functions: Vec<String> = functions.iter().map(|&name| name.to_owned()).collect();
        let description = workspace().join(format!("models/{robot}.toml"));
        let robot = generate(&description, &options(&functions, &[], Scalar::F64));
        let costs = robot.unwrap_or_else(|problems| panic!("{problems}")).module.costs();
        costs.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
    };
    let all = names("cart_pole", &[]);
    assert_eq!(names("cart_pole", &["all"]), all);
    let more = names("cart_pole", &["joint_wrenches", "all"]);
    let (wrenches, others): (Vec<_>, Vec<_>) = more.into_iter().partition(|name| name == "joint_wrenches");
    assert_eq!((wrenches.len(), others), (1, all));
    // The description chooses eight, `all` chooses the others too.
    let (chosen, all) = (names("two_arm", &[]), names("two_arm", &["all"]));
    assert!(chosen.len() == 8 && all.len() > 25 && chosen.iter().all(|name| all.contains(name)), "{all:?}");
}

/// Functions that are asked for by name alone.
const ON_REQUEST: [&str; 2] = ["inverse_dynamics_hessian", "joint_wrenches"];

struct Robots(tempfile::TempDir);

impl Robots {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    /// The path of a chain, written where it is new.
    fn chain(&self, kinds: &str, is_free: bool) -> std::path::PathBuf {
        let path = self.0.path().join(format!("{kinds}_{is_free}.toml"));
        std::fs::write(&path, chain(kinds, is_free)).expect("a description");
        path
    }
}

/// Each function alone, over lanes: a slide has no angles, and nothing else uses what such a module may hold.
#[test]
fn single_functions_over_lanes_compile_without_a_warning() {
    let robots = Robots::new();
    let mut modules = Crate::default();
    for (kinds, is_free, scalar) in
        [("p", false, Scalar::F64), ("p", true, Scalar::F32), ("pr", false, Scalar::F32)]
    {
        let description = robots.chain(kinds, is_free);
        let mut names = functions(&description);
        names.extend(ON_REQUEST.map(str::to_owned));
        for name in names {
            let name = [name];
            modules.add(&description, &options(&name, &name, scalar));
        }
    }
    modules.check(&[]);
}

/// All functions of a robot with driven joints, over lanes and in single precision.
#[test]
fn modules_of_driven_joints_compile_without_a_warning() {
    const RAIL: &str = "[[joints]]\nname = \"rail\"\ntype = \"prismatic\"\nmotion = \"driven\"\n\
                        [[bodies]]\nlink = \"rail\"\nmass = 3\n";
    let robots = Robots::new();
    let path = robots.chain("rr", true);
    std::fs::write(&path, chain("rr", true).replacen("[[joints]]", &format!("{RAIL}[[joints]]"), 1))
        .expect("a description");
    let mut names = functions(&path);
    names.extend(ON_REQUEST.map(str::to_owned));
    names.push("driving_forces".to_owned());
    let mut modules = Crate::default();
    modules.add(&path, &GenerateOptions { self_test: true, ..options(&names, &names, Scalar::F64) });
    modules.add(&path, &options(&names, &[], Scalar::F32));
    modules.check(&[]);
}

/// The robots of seeded choices.
const KINDS: [&str; 14] = ["p", "r", "pp", "rp", "pr", "rr", "prp", "h", "rh", "f", "s", "fr", "rs", "fs"];

/// Seeded choices: robots, subsets of functions, some of them over lanes, scalars, the length of functions.
fn random_modules(count: usize, is_fused: bool) -> Crate {
    let robots = Robots::new();
    let mut rng = Rng::with_seed(11);
    let mut modules = Crate::default();
    for _ in 0..count {
        let kinds = KINDS[rng.usize(..KINDS.len())];
        let description = robots.chain(kinds, rng.bool());
        let mut names = functions(&description);
        names.extend(ON_REQUEST.map(str::to_owned));
        rng.shuffle(&mut names);
        names.truncate(1 + rng.usize(..6));
        let lanes = names[..rng.usize(..=names.len())].to_vec();
        let scalar = [Scalar::F64, Scalar::F32][rng.usize(..2)];
        let mut options = options(&names, &lanes, scalar);
        options.fused_multiply_add = is_fused;
        options.reading.no_friction = rng.u8(..4) == 0;
        options.emit.longest_function = [2000, 10][rng.usize(..2)];
        modules.add(&description, &options);
    }
    modules
}

#[test]
fn random_choices_compile_without_a_warning() {
    let mut modules = random_modules(26, false);
    modules.text.insert_str(0, "#![no_std]\n");
    modules.check(&[]);
}

#[test]
fn fused_modules_compile_without_a_warning() {
    let flags: &[&str] = match cfg!(target_arch = "x86_64") {
        true => &["-C", "target-feature=+fma"],
        false => &[],
    };
    random_modules(14, true).check(flags);
}
