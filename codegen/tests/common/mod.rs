//! Hand-made models and programs, and a compiler to try their text.
#![allow(dead_code, reason = "each test binary uses its part")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]
#![allow(clippy::approx_constant, reason = "rounded numbers, as descriptions have them")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::formula::{Formula, Function as Call};
use gelenk_codegen::functions::function::{ArgumentText, Function};
use gelenk_codegen::layout::{Dimension, Extent};
use gelenk_codegen::model::{
    Drive, Input, Joint, JointKind, Limits, Link, Model, Motion, MotorTorque, Options, Parameter, Pose,
    RotorCoupling,
};
use gelenk_codegen::program::{InputArray, Instruction, Operand, Operation, Output, Program, Shape};

/// Logs and descriptions of `tests/cases/`, which were made for this repository.
pub fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/cases/identification")
}

/// A folder of `$GELENK_SHARED`, or of the folder `shared` next to the repository; none with a note if it is missing.
pub fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("GELENK_SHARED").map(PathBuf::from);
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let found = folder.unwrap_or(beside).join(path);
    if found.exists() {
        return Some(found);
    }
    println!("skipped: {} is not there; set GELENK_SHARED", found.display());
    None
}

pub fn number(value: f64) -> Formula {
    Formula::Number(value)
}

fn pose() -> Pose {
    Pose {
        translation: [number(0.0), number(0.0), number(0.0)],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    }
}

/// A chain of joints with one drive each; only what emission reads is filled in.
pub fn chain(name: &str, joints: &[(&str, JointKind)]) -> Model {
    let mut links = vec![Link { name: "base".into(), joint: None, bodies: vec![] }];
    let mut drives = vec![];
    for (i, (joint, kind)) in joints.iter().enumerate() {
        links.push(Link {
            name: format!("link{}", i + 1),
            joint: Some(Joint {
                name: (*joint).into(),
                identifier: (*joint).into(),
                parent: i,
                kind: *kind,
                origin: pose(),
                axis: [0.0, 0.0, 1.0],
                motion: Motion::Coordinate(i),
                limits: Limits::default(),
                springs: vec![],
                friction: vec![],
                load_friction: vec![],
            }),
            bodies: vec![],
        });
        drives.push(Drive {
            stands_apart: false,
            name: (*joint).into(),
            identifier: (*joint).into(),
            acts_on: vec![gelenk_codegen::model::FollowedCoordinate::itself(i)],
            gear_ratio: number(1.0),
            rotor_inertia: number(0.0),
            carrier: i,
            axis: [0.0, 0.0, 1.0],
            coupling: RotorCoupling::Body,
            input: Input::Torque,
            torque: MotorTorque::default(),
            speed: None,
            line: None,
            friction: Vec::new(),
        });
    }
    Model {
        name: name.into(),
        description: vec![],
        gravity: [number(0.0), number(0.0), number(-9.81)],
        parameters: vec![],
        links,
        quaternion_joints: Vec::new(),
        followers: vec![],
        coordinates: (1..=joints.len()).collect(),
        drives,
        point_forces: Vec::new(),
        force_inputs: Vec::new(),
        driven: Vec::new(),
        wrenches: Vec::new(),
        frames: vec![],
        options: Options::default(),
    }
}

/// The PowerCube reduced to β and γ, as far as emission reads it.
pub fn powercube() -> Model {
    let mut model = chain("powercube", &[("beta", JointKind::Revolute), ("gamma", JointKind::Revolute)]);
    model.description = vec!["Schunk PowerCube, reduced to two axes.".into()];
    for drive in &mut model.drives {
        drive.gear_ratio = number(161.0);
        drive.rotor_inertia = number(5.267e-5);
        drive.torque = MotorTorque { nominal: None, peak: Some(0.5) };
    }
    for link in &mut model.links[1..] {
        if let Some(joint) = &mut link.joint {
            joint.limits = Limits {
                position: Some([-3.14, 3.14]),
                velocity: Some(2.618),
                effort: Some(44.8),
                peak_effort: Some(80.5),
                ..Limits::default()
            };
        }
    }
    model
}

pub fn parameter(name: &str, default: f64, unit: &str, description: &str) -> Parameter {
    Parameter { name: name.into(), default, unit: unit.into(), description: description.into() }
}

/// An array with an entry for each coordinate.
pub fn input(name: &str, len: usize) -> InputArray {
    InputArray { name: name.into(), extent: Extent::new(Dimension::Velocities, len) }
}

/// A square matrix, rows and columns by coordinate.
pub fn square(n: usize) -> Shape {
    Shape::new(&[Dimension::Velocities; 2], &[n, n])
}

pub fn argument(meaning: &str, entries: &[(&str, &'static str)]) -> ArgumentText {
    let entries = entries.iter();
    ArgumentText {
        meaning: meaning.into(),
        entries: entries.map(|&(name, unit)| (name.into(), unit)).collect(),
    }
}

pub fn instruction(name: &str, operation: Operation) -> Instruction {
    Instruction { name: name.into(), operation }
}

/// M of the reduced PowerCube, written by hand from its published form.
pub fn mass_matrix() -> Function {
    let (y2, constant) = (Operand::Input(0, 1), Operand::Constant);
    let program = Program {
        inputs: vec![input("y", 2)],
        instructions: vec![
            instruction("s2", Operation::SinCos(y2)),
            instruction("c2", Operation::CosineOf(0)),
            instruction("h_c2", Operation::Multiply(constant(0.310_754_986_2), Operand::Value(1))),
            instruction("m12", Operation::Add(Operand::Value(2), constant(0.669_369_776_856_5))),
            instruction("m11_half", Operation::Add(Operand::Value(2), constant(1.160_650_163_428_25))),
            instruction("m11", Operation::Multiply(constant(2.0), Operand::Value(4))),
        ],
        outputs: vec![Output {
            name: "M".into(),
            shape: square(2),
            entries: vec![
                Operand::Value(5),
                Operand::Value(3),
                Operand::Value(3),
                constant(2.026_138_976_856_5),
            ],
        }],
    };
    Function {
        name: "mass_matrix".into(),
        frame: None,
        summary: "Mass matrix `M(y)`.".into(),
        equation: "M = Σᵢ Jᵢᵀ Iᵢ Jᵢ".into(),
        arguments: vec![argument("coordinates", &[("beta", "rad"), ("gamma", "rad")])],
        results: vec!["symmetric [kg m²]".into()],
        notes: vec!["Composite rigid bodies in link frames were cheapest.".into()],
        constants: vec![],
        program,
        arrays: None,
    }
}

/// A function with one scalar result, an argument that it never reads, and every operation.
pub fn every_operation() -> Function {
    let (x, y) = (Operand::Input(0, 0), Operand::Input(0, 1));
    let value = Operand::Value;
    let operations = [
        Operation::SinCos(x),
        Operation::CosineOf(0),
        Operation::Call(Call::Tanh, y),
        Operation::Call(Call::Exp, Operand::Constant(-0.5)),
        Operation::Call(Call::Abs, value(2)),
        Operation::Call(Call::Sign, y),
        Operation::Call(Call::Sin, y),
        Operation::Call(Call::Cos, y),
        Operation::Negate(value(1)),
        Operation::Divide(value(8), Operand::Constant(-3.0)),
        Operation::MultiplyAdd(value(3), value(4), value(5)),
        Operation::Subtract(value(9), Operand::Constant(-0.707_106_781_186_547_6)),
        Operation::Multiply(value(10), value(11)),
        Operation::Add(value(12), value(6)),
        Operation::SinCos(value(7)),
        Operation::CosineOf(14),
        Operation::Multiply(value(15), value(0)),
        Operation::MultiplyAdd(Operand::Constant(-1.5), value(13), value(16)),
    ];
    let instructions = operations
        .into_iter()
        .enumerate()
        .map(|(i, operation)| instruction(&format!("t{i}"), operation))
        .collect();
    Function {
        name: "every_operation".into(),
        frame: None,
        summary: "Every operation once.".into(),
        equation: String::new(),
        arguments: vec![argument("numbers", &[]), argument("never read", &[])],
        results: vec!["a number".into()],
        notes: vec![],
        constants: vec![],
        program: Program {
            inputs: vec![input("y", 2), input("v", 2)],
            instructions,
            outputs: vec![Output { name: "r".into(), shape: Shape::Scalar, entries: vec![value(17)] }],
        },
        arrays: None,
    }
}

/// Repeatable numbers without a crate: Knuth's 64-bit linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 16
    }

    pub fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    /// In [-2, 2).
    pub fn number(&mut self) -> f64 {
        (self.next() % (1 << 40)) as f64 / (1_u64 << 38) as f64 - 2.0
    }
}

/// A program like those of large robots: mostly recent values, now and then an old one, sums of products.
pub fn synthetic(length: usize, seed: u64) -> Function {
    synthetic_with(length, seed, 60)
}

/// As [`synthetic`]; values are read again within `window` instructions.
pub fn synthetic_with(length: usize, seed: u64, window: usize) -> Function {
    let mut random = Random(seed);
    let mut instructions: Vec<Instruction> = vec![];
    let read = |random: &mut Random, len: usize| match random.below(10) {
        0 => Operand::Constant(random.number()),
        1 | 2 => Operand::Input(random.below(3), random.below(6)),
        3 if len > 0 => Operand::Value(random.below(len)),
        _ if len > 0 => Operand::Value(len - 1 - random.below(len.min(window))),
        _ => Operand::Input(0, 0),
    };
    for i in 0..length {
        let (a, b) = (read(&mut random, i), read(&mut random, i));
        let operation = match random.below(400) {
            0 => Operation::SinCos(a),
            1 => Operation::Call(Call::Tanh, a),
            2..=190 => Operation::Multiply(a, b),
            191..=300 => Operation::Add(a, b),
            _ => Operation::Subtract(a, b),
        };
        instructions.push(instruction(&format!("t{i}"), operation));
    }
    let entries = (0..36).map(|_| Operand::Value(length - 1 - random.below(length.min(200)))).collect();
    Function {
        name: "synthetic".into(),
        frame: None,
        summary: "A synthetic program.".into(),
        equation: String::new(),
        arguments: vec![],
        results: vec![],
        notes: vec![],
        constants: vec![],
        program: Program {
            inputs: vec![input("y", 6), input("v", 6), input("a", 6)],
            instructions,
            outputs: vec![Output { name: "r".into(), shape: square(6), entries }],
        },
        arrays: None,
    }
}

/// Compiles `text` as `name.rs` with the given arguments; the message of a failure is the error.
pub fn rustc(folder: &Path, name: &str, text: &str, arguments: &[&str]) -> Result<(), String> {
    run("rustc", folder, name, text, arguments)
}

/// As [`rustc`], by clippy; `None` where there is no clippy.
pub fn clippy(folder: &Path, name: &str, text: &str, arguments: &[&str]) -> Option<Result<(), String>> {
    Command::new("clippy-driver").arg("--version").output().ok()?;
    Some(run("clippy-driver", folder, name, text, arguments))
}

fn run(program: &str, folder: &Path, name: &str, text: &str, arguments: &[&str]) -> Result<(), String> {
    let file = format!("{name}.rs");
    fs::write(folder.join(&file), text).unwrap();
    let mut command = Command::new(program);
    // The flags of the calling cargo would be taken for this file's.
    command
        // The user's clippy knows nothing of what this crate may not call.
        .env("CLIPPY_CONF_DIR", folder)
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .current_dir(folder);
    if cfg!(target_arch = "x86_64") {
        // Modules with fused multiply-adds compile for nothing less.
        command.arg("-Ctarget-feature=+fma");
    }
    let output = command.args(["--edition", "2024", &file]).args(arguments).output().unwrap();
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}
