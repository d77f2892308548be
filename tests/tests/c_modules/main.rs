//! Modules in C compared with the Rust modules of the same value: they compile as C99 and as C++ without a warning, call no
//! library, and compute the same bits.
//!
//! The short form compares four robots in every variant, one with quaternions in each number type, and loops over the
//! joints of a Panda, driven joints, and forces at frames. All robots, with every compiler at hand:
//!
//! ```text
//! cargo test -p gelenk-tests --test all c_modules:: -- --ignored --nocapture
//! ```
//!
//! `GELENK_CC` names further compilers, separated by semicolons: `GELENK_CC='clang;python3 -m ziglang cc'`.
//! `GELENK_ROBOTS` limits the comparison to robots: `GELENK_ROBOTS=ur5,panda`. `GELENK_FUNCTIONS` limits it to
//! functions: `GELENK_FUNCTIONS=linearize`. All functions of a robot with seven joints take half an hour.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

mod compilers;
mod drivers;
mod lanes;

use std::path::{Path, PathBuf};

use compilers::{Compiler, c_and_others, c_compilers};
use drivers::Requests;
use fastrand::Rng;
use gelenk_codegen::emit::{self, Companion, EmitOptions, Language, Scalar, SourceFile};
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::module::Module;
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_tests::compiler::rustc;
use gelenk_tests::enumerated::{Chain, Role};
use gelenk_tests::{all_functions, descriptions, workspace};

/// Ordinary states of each function.
const SAMPLES: usize = 4;

/// Numbers at the ends of what a function may be given.
const SPECIAL: [f64; 10] =
    [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 5e-324, -1e-310, 1e300, -123_456.789, 3e-39];

/// A module in one form, which both printers print, with all lanes that a module for Python has.
///
/// - `functions`: all where there are none
fn derive(description: &Path, functions: &[&str], form: Form, fused: bool) -> Module {
    let functions = match functions {
        [] => all_functions(description),
        _ => functions.iter().map(|name| (*name).to_owned()).collect(),
    };
    let emit =
        EmitOptions { language: Language::C, companions: vec![Companion::Python], ..EmitOptions::default() };
    let options =
        GenerateOptions { functions, form, fused_multiply_add: fused, emit, ..GenerateOptions::default() };
    let robot = generate(description, &options).unwrap_or_else(|problems| panic!("{problems}"));
    robot.module
}

fn print(module: &Module, language: Language, scalar: Scalar) -> SourceFile {
    emit::module(module, &EmitOptions { language, scalar, ..EmitOptions::default() })
}

/// Compares a module in C with the one in Rust, compiled by some compilers; others only look for warnings.
fn compare(module: &Module, scalar: Scalar, is_fused: bool, compilers: &[Compiler], others: &[Compiler]) {
    let folder = tempfile::tempdir().expect("a folder");
    let requests = requests(module, scalar);
    let expected = run_rust(folder.path(), module, scalar, is_fused, &requests);
    let source = put(folder.path(), module, scalar);
    std::fs::write(folder.path().join("main.c"), drivers::c(module, &source, scalar)).expect("a file");
    let what =
        |compiler: &Compiler| format!("{} {scalar:?} fused {is_fused} {}", module.name, compiler.name());
    for compiler in others {
        let result = compiler.check(folder.path(), is_fused);
        result.unwrap_or_else(|message| panic!("{}: {message}", what(compiler)));
    }
    for compiler in compilers {
        let what = what(compiler);
        compiler.compile(folder.path(), is_fused).unwrap_or_else(|message| panic!("{what}: {message}"));
        let found = drivers::run(&folder.path().join("c_main"), &requests);
        assert_eq!(found.len(), expected.len(), "{what}");
        for (request, (found, expected)) in found.iter().zip(&expected).enumerate() {
            drivers::assert_same_bits(&format!("{what}: {}", requests.name(request)), found, expected);
        }
    }
}

/// Writes `robot.c` and `robot.h`.
fn put(folder: &Path, module: &Module, scalar: Scalar) -> SourceFile {
    let source = print(module, Language::C, scalar);
    // Small processors compute `double` in software.
    let mut code = source.text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let is_single = code.all(|line| !line.contains("double "));
    assert!(scalar == Scalar::F64 || is_single, "{} holds `double`", module.name);
    for (ending, text) in source.files() {
        std::fs::write(folder.join(format!("robot{ending}")), text).expect("a file");
    }
    let text = source.text.replace(&format!("#include \"{}.h\"", source.name), "#include \"robot.h\"");
    std::fs::write(folder.join("robot.c"), text).expect("a file");
    source
}

fn run_rust(
    folder: &Path,
    module: &Module,
    scalar: Scalar,
    is_fused: bool,
    requests: &Requests,
) -> Vec<Vec<f64>> {
    // `tests/lanes.rs` compares those of Rust.
    let source = print(&Module { lanes: vec![], ..module.clone() }, Language::Rust, scalar);
    std::fs::write(folder.join("robot.rs"), &source.text).expect("a file");
    std::fs::write(folder.join("flat.rs"), include_str!("../../src/flat.rs")).expect("a file");
    let mut flags = vec!["-C", "opt-level=0", "-A", "warnings"];
    if is_fused {
        flags.extend(["-C", "target-feature=+fma"]);
    }
    let main = drivers::rust(module, &source.text);
    rustc(folder, "main", &main, &flags).unwrap_or_else(|message| panic!("{}: {message}", module.name));
    drivers::run(&folder.join("main"), requests)
}

/// Ordinary states, and some that hold a number of [`SPECIAL`].
fn requests(module: &Module, scalar: Scalar) -> Requests {
    let mut rng = Rng::with_seed(16);
    let mut requests = Requests::new(module);
    let short = |x: f64| match scalar {
        Scalar::F64 => x,
        Scalar::F32 => f64::from(x as f32),
    };
    for function in 0..requests.functions() {
        let rounds = if requests.is_of_positions(function) { 8 } else { 1 };
        for sample in (0..rounds).flat_map(|_| 0..SAMPLES + SPECIAL.len()) {
            let special = sample.checked_sub(SAMPLES).map(|index| SPECIAL[index]);
            let mut number = || match (special, rng.u8(0..10)) {
                (Some(special), 0..3) => short(special),
                (_, 3) => 0.0,
                (_, 4) => short(30.0 * (rng.f64() - 0.5)),
                _ => short(6.0 * (rng.f64() - 0.5)),
            };
            requests.add(function, &mut number);
        }
    }
    requests
}

fn model(name: &str) -> PathBuf {
    workspace().join("models").join(name)
}

fn variants() -> impl Iterator<Item = bool> {
    let has_fma = std::arch::is_x86_feature_detected!("fma");
    if !has_fma {
        println!("skipped: no fused multiply-add here");
    }
    [false, true].into_iter().filter(move |fused| has_fma || !fused)
}

/// Functions with loops in array form, and discrete time over them.
const LOOPS: [&str; 4] =
    ["inverse_dynamics_derivatives_and_mass_matrix", "linearize", "discretize", "step_derivatives"];

/// The functions over a sample time, and what they call.
const DISCRETE_TIME: [&str; 5] = ["forward_dynamics", "linearize", "discretize", "step", "step_derivatives"];

/// All functions as straight-line code with free parameters, then loops over a chain and over trees whose joints follow
/// others; the first three with discrete time. Those compiled as C run, those compiled as C++ are looked at for warnings.
#[test]
fn some_robots_compute_the_same_bits_in_every_variant() {
    let (compilers, others) = c_and_others();
    for (name, functions, form) in [
        ("powercube_parameters.toml", &[][..], Form::Cheapest),
        ("geared_arm.toml", &[], Form::Arrays),
        ("gripper.toml", &LOOPS, Form::Arrays),
        // Two motors act on two joints, one of them with both signs.
        ("differential_wrist.toml", &["linearize"], Form::Arrays),
    ] {
        for is_fused in variants() {
            let module = derive(&model(name), functions, form, is_fused);
            for scalar in [Scalar::F64, Scalar::F32] {
                compare(&module, scalar, is_fused, &compilers, &others);
            }
        }
    }
}

/// Loops over a chain of seven joints, whose rows are one block of eight entries. Compiled for fused operations these
/// are registers of AVX, otherwise those of SSE2 or Neon.
#[test]
fn loops_over_seven_joints_compute_the_same_bits() {
    let compilers: Vec<Compiler> = c_compilers().into_iter().take(1).collect();
    for (is_fused, scalar) in variants().zip([Scalar::F32, Scalar::F64]) {
        let module = derive(&model("panda.toml"), &["linearize"], Form::Arrays, is_fused);
        compare(&module, scalar, is_fused, &compilers, &[]);
    }
}

/// A quadruped, whose loops are products with M⁻¹ alone.
#[test]
fn products_with_the_inverse_compute_the_same_bits() {
    let compilers: Vec<Compiler> = c_compilers().into_iter().take(1).collect();
    for (is_fused, scalar) in variants().zip([Scalar::F64, Scalar::F32]) {
        let module = derive(&model("go2.toml"), &["linearize"], Form::Cheapest, is_fused);
        compare(&module, scalar, is_fused, &compilers, &[]);
    }
}

/// A floating body with a wheel and a boom on a ball joint: joints of every number of position entries, and a free parameter.
const FLOATING: &str = r#"
name = "floating"
parameters = { load = 1.5 }
base = { link = "hull", type = "floating" }
bodies = [
    { name = "hull", link = "hull", mass = 4, inertia = [0.2, 0.3, 0.4] },
    { name = "wheel", link = "wheel", mass = 1, inertia = [0.01, 0.02, 0.02] },
    { name = "boom", link = "boom", mass = "load", center_of_mass = [0, 0, 0.5], inertia = [0.1, 0.1, 0.01] },
]
joints = [
    { name = "wheel", parent = "hull", type = "continuous", axis = [1, 0, 0], drive = "ideal" },
    { name = "boom", parent = "hull", type = "spherical" },
]
"#;

/// Discrete time and functions of positions of trees with a floating base and a ball joint: positions with quaternions.
/// Their texts hold no fused operations.
#[test]
fn robots_with_quaternions_compute_the_same_bits() {
    let (compilers, others) = c_and_others();
    let folder = tempfile::tempdir().expect("a folder");
    for (description, scalar) in
        [(model("satellite.toml"), Scalar::F64), (floating_in(folder.path()), Scalar::F32)]
    {
        for form in [Form::Cheapest, Form::Arrays] {
            let module = derive(&description, &DISCRETE_TIME, form, false);
            let is_over_lanes = module.lanes.iter().any(|name| name == "linearize");
            assert_eq!(is_over_lanes, form == Form::Cheapest, "{:?}", module.lanes);
            compare(&module, scalar, false, &compilers, &others);
        }
    }
    // Over lanes: inputs at frames of a floating body.
    let module = derive(&model("quadrotor.toml"), &["linearize", "inverse_dynamics"], Form::Cheapest, true);
    assert_eq!(module.lanes.len(), module.functions.len());
    let is_there = variants().any(|is_fused| is_fused);
    compilers.iter().take(usize::from(is_there)).for_each(|compiler| {
        compare(&module, Scalar::F32, true, std::slice::from_ref(compiler), &[]);
    });
}

/// A spring between two frames, and wrenches, which are arrays of six.
#[test]
fn robots_with_forces_at_frames_compute_the_same_bits() {
    let compilers: Vec<Compiler> = c_compilers().into_iter().take(1).collect();
    let functions = [
        "linearize",
        "spring_forces",
        "wrench_forces",
        "wrench_forces_derivatives",
        "inverse_dynamics_with_wrenches",
        "forward_dynamics_with_wrenches",
    ];
    let module = derive(&model("balanced_arm.toml"), &functions, Form::Cheapest, false);
    compare(&module, Scalar::F64, false, &compilers, &[]);
}

/// An arm on a rail that is driven, whose gripper follows both.
const DRIVEN: &str = r#"
name = "driven"
joints = [
    { name = "rail", type = "prismatic", axis = [1, 0, 0], motion = "driven" },
    { name = "arm", axis = [0, 1, 0], drive = "ideal" },
    { name = "finger", axis = [0, 0, 1], follows = { arm = 0.5, rail = 2 }, friction = { viscous = 0.2 } },
]
bodies = [
    { link = "rail", mass = 4 },
    { link = "arm", mass = 1.5, center_of_mass = [0.1, 0, 0.3], inertia = 0.05 },
    { link = "finger", mass = 0.3, center_of_mass = [0.05, 0, 0], inertia = 0.001 },
]
frames = [{ name = "tip", link = "finger", origin = { xyz = [0, 0, 0.2] } }]
"#;

/// Functions that take the driven coordinates.
#[test]
fn robots_with_driven_joints_compute_the_same_bits() {
    let (compilers, others) = c_and_others();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("driven.toml");
    std::fs::write(&path, DRIVEN).expect("a description");
    let functions = ["linearize", "inverse_dynamics", "driving_forces", "friction_torques", "frames"];
    let module = derive(&path, &functions, Form::Cheapest, false);
    compare(&module, Scalar::F64, false, &compilers, &others);
}

/// Chains in every direction and origin: loops over the joints, and frames.
#[test]
fn chains_of_every_kind_of_motion_compute_the_same_bits() {
    let compilers: Vec<Compiler> = c_compilers().into_iter().take(1).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let chains: [(&[&str], &[Role], usize); 4] = [
        (&["revolute", "spherical", "revolute"], &[Role::Free; 3], 0),
        (&["universal", "floating"], &[Role::Free; 2], 2),
        (&["helical", "cylindrical"], &[Role::Follows, Role::Free], 3),
        (&["planar", "prismatic", "prismatic"], &[Role::Driven, Role::Free, Role::Free], 4),
    ];
    for (types, roles, first) in chains {
        let path = folder.path().join("chain.toml");
        std::fs::write(&path, Chain::placed(types, roles, first).text(1)).expect("a description");
        let functions = ["frames", "inverse_dynamics", "forward_dynamics_derivatives", "linearize"];
        let module = derive(&path, &functions, Form::Arrays, false);
        compare(&module, Scalar::F64, false, &compilers, &[]);
    }
}

/// Writes [`FLOATING`].
fn floating_in(folder: &Path) -> PathBuf {
    let path = folder.join("floating.toml");
    std::fs::write(&path, FLOATING).expect("a file");
    path
}

/// Unused functions are warnings: each function over a sample time brings only what it needs.
#[test]
fn each_function_over_a_sample_time_compiles_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    // The first compiler, for time; the others see the same texts in the long form.
    let compilers: Vec<Compiler> = c_compilers().into_iter().take(1).collect();
    for description in [model("cart_pole.toml"), floating_in(folder.path())] {
        for functions in
            [&["linearize", "discretize"], &["forward_dynamics", "step"], &["linearize", "step_derivatives"]]
        {
            let module = derive(&description, functions, Form::Cheapest, false);
            put(folder.path(), &module, Scalar::F64);
            for compiler in &compilers {
                let result = compiler.compile_alone(folder.path());
                let what = |message| panic!("{} {functions:?} {}: {message}", module.name, compiler.name());
                result.unwrap_or_else(what);
            }
        }
    }
}

/// All robots, in every variant and form.
#[test]
#[ignore = "compiles every robot some dozen times; see the head of this file"]
fn all_robots_compute_the_same_bits_in_every_variant() {
    let compilers = c_compilers();
    let wanted = std::env::var("GELENK_ROBOTS").ok();
    let functions = std::env::var("GELENK_FUNCTIONS").unwrap_or_default();
    let functions: Vec<&str> = functions.split(',').filter(|name| !name.is_empty()).collect();
    let is_wanted = |path: &PathBuf| {
        let name = path.file_stem().unwrap_or_default();
        wanted.as_ref().is_none_or(|wanted| wanted.split(',').any(|wanted| name == wanted))
    };
    for description in descriptions().into_iter().filter(is_wanted) {
        for form in [Form::Cheapest, Form::Arrays] {
            for is_fused in variants() {
                let module = derive(&description, &functions, form, is_fused);
                for scalar in [Scalar::F64, Scalar::F32] {
                    compare(&module, scalar, is_fused, &compilers, &[]);
                    println!("{} {form:?} {scalar:?} fused {is_fused}", module.name);
                }
            }
        }
    }
}
