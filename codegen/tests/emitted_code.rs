//! The emitted text is what it should be, compiles without a warning, and computes what the interpreter
//! computes.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]
#![allow(clippy::approx_constant, reason = "numbers that look like constants are what is tested")]

use std::fs;
use std::process::Command;

use super::common::{self, chain, every_operation, mass_matrix, parameter, powercube, rustc, synthetic};
use gelenk_codegen::emit::{self, EmitOptions, Scalar};
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::layout::{Dimension, Extent};
use gelenk_codegen::model::{JointKind, Model};
use gelenk_codegen::module::Module;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::program::{InputArray, Operand, Operation, Output, Program, Shape};

const STRICT: &str =
    "#![deny(warnings, missing_docs, clippy::all, nonstandard_style, future_incompatible)]\n//! Test.\n";

fn emit_with(model: &Model, functions: &[Function], change: impl FnOnce(&mut EmitOptions)) -> String {
    let command = format!("gelenk generate models/{}.toml", model.name);
    let mut options = EmitOptions { command, ..EmitOptions::default() };
    change(&mut options);
    emit::module(&Module::new(model, functions.to_vec(), &[]), &options).text
}

/// Compiles alone and through `include!` in a crate that denies all warnings; clippy too, where there is one.
fn assert_compiles(name: &str, text: &str) {
    let folder = tempfile::tempdir().unwrap();
    rustc(folder.path(), name, text, &["--crate-type", "lib", "--emit", "metadata", "-D", "warnings"])
        .unwrap();
    let outer = format!("{STRICT}/// Robot.\npub mod robot {{ include!(\"{name}.rs\"); }}\n");
    let arguments = ["--crate-type", "lib", "--emit", "metadata"];
    rustc(folder.path(), "outer", &outer, &arguments).unwrap();
    match common::clippy(folder.path(), "outer", &outer, &arguments) {
        Some(result) => result.unwrap(),
        None => eprintln!("skipped: no clippy-driver"),
    }
}

#[test]
fn powercube_module() {
    let text = emit_with(&powercube(), &[mass_matrix()], |_| {});
    insta::assert_snapshot!(text);
    assert_compiles("powercube", &text);
}

#[test]
fn every_operation_in_both_scalars() {
    let mut model = chain("pair", &[("a", JointKind::Revolute), ("b", JointKind::Prismatic)]);
    model.parameters =
        vec![parameter("m1", 2.5, "kg", "Mass of the first link."), parameter("J_R", 3.1416, "", "")];
    let mut function = every_operation();
    function.program.outputs[0].entries = vec![Operand::Value(17)];
    for (scalar, name) in [(Scalar::F64, "f64"), (Scalar::F32, "f32")] {
        let text = emit_with(&model, &[function.clone()], |options| options.scalar = scalar);
        insta::assert_snapshot!(name, text);
        assert_compiles("pair", &text);
    }
}

#[test]
fn a_long_function_is_split() {
    let text = emit_with(&powercube(), &[mass_matrix()], |options| options.longest_function = 2);
    insta::assert_snapshot!(text.split_once("/// Mass matrix").unwrap().1);
    assert_compiles("powercube", &text);
}

/// Runs `function` of the module on all samples in one process; the results' bits, flat.
fn run_compiled(text: &str, function: &str, samples: &[Vec<Vec<f64>>]) -> Vec<Vec<u64>> {
    let folder = tempfile::tempdir().unwrap();
    let mut main = String::from("mod robot { include!(\"robot.rs\"); }\nfn main() {\n");
    for (i, sample) in samples.iter().enumerate() {
        let arrays: Vec<String> = sample
            .iter()
            .map(|array| {
                let entries: Vec<String> =
                    array.iter().map(|x| format!("f64::from_bits({})", x.to_bits())).collect();
                format!("&std::hint::black_box([{}])", entries.join(", "))
            })
            .collect();
        main.push_str(&format!(
            "    let r{i} = robot::{function}({});\n    print(&r{i});\n",
            arrays.join(", ")
        ));
    }
    main.push_str("}\nfn print<T>(value: &T) {\n    let n = size_of::<T>() / 8;\n");
    main.push_str(
        "    let bits = unsafe { core::slice::from_raw_parts((value as *const T).cast::<u64>(), n) };\n",
    );
    main.push_str("    println!(\"{bits:?}\");\n}\n");
    fs::write(folder.path().join("robot.rs"), text).unwrap();
    rustc(folder.path(), "main", &main, &["-O", "-A", "warnings"]).unwrap();
    let output = Command::new(folder.path().join("main")).output().unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    let parse = |line: &str| {
        line.trim_matches(['[', ']']).split(", ").map(|bits| bits.parse().unwrap()).collect::<Vec<u64>>()
    };
    lines.lines().map(parse).collect()
}

/// IEEE 754 leaves sign and payload of a NaN open; all other values must agree in every bit.
fn assert_same_bits(interpreted: &[f64], compiled: &[u64]) {
    assert_eq!(interpreted.len(), compiled.len());
    for (&a, &b) in interpreted.iter().zip(compiled) {
        assert!(
            a.to_bits() == b || (a.is_nan() && f64::from_bits(b).is_nan()),
            "{a:?} and {:?}",
            f64::from_bits(b)
        );
    }
}

fn assert_interpreter_agrees(model: &Model, function: &Function, longest: usize, samples: &[Vec<Vec<f64>>]) {
    let text = emit_with(model, std::slice::from_ref(function), |options| options.longest_function = longest);
    let compiled = run_compiled(&text, &function.name, samples);
    assert_eq!(compiled.len(), samples.len());
    for (sample, bits) in samples.iter().zip(compiled) {
        let inputs: Vec<&[f64]> = sample.iter().map(Vec::as_slice).collect();
        let results = interpret(&function.program, &inputs, &[]).unwrap();
        assert_same_bits(&results.concat(), &bits);
    }
}

#[test]
fn interpreter_and_compiled_code_agree_in_every_bit() {
    let model = chain("pair", &[("a", JointKind::Revolute), ("b", JointKind::Prismatic)]);
    let special = [0.0, -0.0, f64::NAN, f64::INFINITY, -1.5, 1e-310, 3.0, 1e300];
    let samples: Vec<Vec<Vec<f64>>> = special
        .iter()
        .flat_map(|&a| special.iter().map(move |&b| vec![vec![a, b], vec![0.0, 0.0]]))
        .collect();
    assert_interpreter_agrees(&model, &every_operation(), usize::MAX, &samples);
}

#[test]
fn a_split_function_keeps_every_bit() {
    let joints = ["a", "b", "c", "d", "e", "f"].map(|name| (name, JointKind::Revolute));
    let model = chain("six", &joints);
    let mut random = common::Random(7);
    let samples: Vec<Vec<Vec<f64>>> =
        (0..20).map(|_| (0..3).map(|_| (0..6).map(|_| random.number()).collect()).collect()).collect();
    for (seed, longest) in [(1, usize::MAX), (1, 97), (2, 300)] {
        assert_interpreter_agrees(&model, &synthetic(1500, seed), longest, &samples);
    }
}

#[test]
fn no_text_of_a_description_becomes_code() {
    let evil = "*/ \"; panic!(); /* } \\ \r\n\u{202e} [x] <b> ` #![feature(x)] 'ü' {} // https://e.org";
    let mut model = chain("fn", &[(evil, JointKind::Revolute), ("β", JointKind::Revolute)]);
    model.description = vec![evil.into(), "- list".into(), "1. list".into()];
    model.parameters =
        vec![parameter(evil, 1.0, evil, evil), parameter("p", 1.0, "", "- a"), parameter("p", 0.0, "", "")];
    let mut function = mass_matrix();
    function.name = "a b".into();
    function.summary = evil.into();
    function.equation = evil.into();
    function.arguments = vec![common::argument(evil, &[(evil, "rad")])];
    function.results = vec![evil.into()];
    function.notes = vec![evil.into()];
    function.program.inputs[0].name = "p".into();
    for (instruction, name) in
        function.program.instructions.iter_mut().zip(["sin_cos", evil, "fn", "p", "M", "y"])
    {
        instruction.name = name.into();
    }
    function.program.outputs[0].name = evil.into();
    let text = emit_with(&model, &[function], |options| options.command = evil.into());
    insta::assert_snapshot!(text);
    assert_compiles("evil", &text);
}

/// Reads sine and cosine of `count` angles, in one call as far as possible.
fn angles(count: usize) -> Function {
    let mut instructions = vec![];
    for i in 0..count {
        let pair = Operation::SinCos(Operand::Input(0, i));
        instructions.push(common::instruction(&format!("sin_{i}"), pair));
        let cosine = Operation::CosineOf(2 * i);
        instructions.push(common::instruction(&format!("cos_{i}"), cosine));
    }
    let mut function = zeros("angles", &[("y", count)], &[("r", Shape::Vector(Extent::fixed(2 * count)))]);
    function.program.outputs[0].entries = (0..2 * count).map(Operand::Value).collect();
    function.program.instructions = instructions;
    function
}

#[test]
fn several_angles_keep_every_bit() {
    for count in [1, 2, 3, 5, 7, 9] {
        let names: Vec<String> = (0..count).map(|i| format!("j{i}")).collect();
        let joints: Vec<_> = names.iter().map(|name| (name.as_str(), JointKind::Revolute)).collect();
        let mut random = common::Random(count as u64);
        let mut samples: Vec<Vec<Vec<f64>>> =
            (0..20).map(|_| vec![(0..count).map(|_| 10.0 * random.number()).collect()]).collect();
        samples.push(vec![(0..count).map(|i| if i == 0 { 1e22 } else { 0.5 }).collect()]);
        samples.push(vec![vec![f64::NAN; count]]);
        assert_interpreter_agrees(&chain("many", &joints), &angles(count), usize::MAX, &samples);
    }
}

#[test]
fn modules_need_no_std() {
    let function = angles(7);
    let names: Vec<String> = (0..7).map(|i| format!("j{i}")).collect();
    let joints: Vec<_> = names.iter().map(|name| (name.as_str(), JointKind::Revolute)).collect();
    for scalar in [Scalar::F64, Scalar::F32] {
        let text = emit_with(&chain("seven", &joints), std::slice::from_ref(&function), |options| {
            options.scalar = scalar
        });
        assert!(text.contains("math::sin_cos_8"));
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("seven.rs"), text).unwrap();
        let outer = format!("#![no_std]\n{STRICT}/// Robot.\npub mod robot {{ include!(\"seven.rs\"); }}\n");
        let arguments = ["--crate-type", "lib", "--emit", "metadata"];
        rustc(folder.path(), "outer", &outer, &arguments).unwrap();
    }
}

/// A function that returns zeros of these shapes.
fn zeros(name: &str, inputs: &[(&str, usize)], results: &[(&str, Shape)]) -> Function {
    let entries = |shape: Shape| shape.extents().iter().map(|extent| extent.len).product();
    let output = |&(name, shape): &(&str, Shape)| Output {
        name: name.into(),
        shape,
        entries: vec![Operand::Constant(0.0); entries(shape)],
    };
    Function {
        name: name.into(),
        frame: None,
        summary: "Zeros.".into(),
        equation: String::new(),
        arguments: vec![],
        results: vec![],
        notes: vec![],
        constants: vec![],
        program: Program {
            inputs: inputs
                .iter()
                .map(|&(name, len)| match name {
                    "u" => {
                        InputArray { extent: Extent::new(Dimension::Inputs, len), ..common::input(name, len) }
                    }
                    _ => common::input(name, len),
                })
                .collect(),
            instructions: vec![],
            outputs: results.iter().map(output).collect(),
        },
        arrays: None,
    }
}

#[test]
fn lengths_are_named_where_they_follow_from_the_model() {
    let joints = ["a", "b", "c", "d", "e", "f"].map(|name| (name, JointKind::Revolute));
    let square = |name| (name, common::square(6));
    let by_inputs = Shape::new(&[Dimension::Velocities, Dimension::Inputs], &[6, 6]);
    let space = Extent::fixed;
    let each = Extent::new(Dimension::Velocities, 6);
    let state = [("y", 6), ("v", 6), ("u", 6)];
    let blocks = [square("da_dy"), square("da_dv"), ("da_du", by_inputs), ("affine", Shape::Vector(each))];
    let functions = [
        zeros("linearize", &state, &blocks),
        zeros("input_matrix", &state[..1], &[("B", by_inputs)]),
        zeros("kinetic_energy", &state[..2], &[("T", Shape::Scalar)]),
        zeros(
            "frame_tool_pose",
            &state[..1],
            &[("p", Shape::Vector(space(3))), ("R", Shape::Matrix(space(3), space(3)))],
        ),
        zeros("frame_tool_jacobian", &state[..1], &[("J", Shape::Matrix(space(6), each))]),
        zeros("frame_tool_jacobian_rate", &state[..2], &[("a", Shape::Vector(space(6)))]),
    ];
    let text = emit_with(&chain("six", &joints), &functions, |_| {});
    let signatures: Vec<&str> =
        text.split("pub fn ").skip(1).filter_map(|item| item.split(" {").next()).collect();
    insta::assert_snapshot!(signatures.join("\n"));
    assert_compiles("six", &text);
}

#[test]
fn fused_operations_refuse_processors_without_them() {
    let model = chain("pair", &[("a", JointKind::Revolute), ("b", JointKind::Prismatic)]);
    let text = emit_with(&model, &[every_operation()], |_| {});
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--crate-type", "lib", "--emit", "metadata", "-Ctarget-feature=-fma"];
    let error = rustc(folder.path(), "pair", &text, &arguments);
    if cfg!(target_arch = "x86_64") {
        assert!(error.unwrap_err().contains("target-feature=+fma"));
    }
}

#[test]
fn large_results_are_written_in_place() {
    let joints = ["a", "b", "c", "d", "e", "f"].map(|name| (name, JointKind::Revolute));
    // Long enough for several blocks.
    let mut function = synthetic(2500, 3);
    function.program.outputs[0].entries[5] = Operand::Value(300);
    for instruction in &mut function.program.instructions {
        // Clippy would ask whether it is meant.
        if let Operation::Subtract(a, b) = instruction.operation
            && a == b
        {
            instruction.operation = Operation::Negate(a);
        }
    }
    function.program.outputs[0].entries[7] = Operand::Constant(2.5);
    function.program.outputs[0].entries[8] = Operand::Input(1, 2);
    let model = chain("six", &joints);
    let text = emit_with(&model, std::slice::from_ref(&function), |_| {});
    assert!(text.contains("pub fn synthetic_into(") && text.contains("r[1][1] = 2.5;"));
    assert_compiles("six", &text);
    let mut random = common::Random(9);
    let mut arrays = || (0..3).map(|_| (0..6).map(|_| random.number()).collect()).collect();
    assert_interpreter_agrees(&model, &function, usize::MAX, &[arrays()]);
}

/// Angles of one joint and of a sum, what no function of std would give, an input that nothing reads.
fn laned(entries: usize) -> Function {
    let mut function = synthetic(80, 11);
    let value = Operand::Value;
    let operations = [
        Operation::Add(Operand::Input(0, 1), Operand::Input(0, 2)),
        Operation::SinCos(value(0)),
        Operation::CosineOf(1),
        Operation::SinCos(Operand::Input(0, 0)),
        Operation::CosineOf(3),
    ];
    for (instruction, operation) in function.program.instructions.iter_mut().zip(operations) {
        instruction.operation = operation;
    }
    for instruction in &mut function.program.instructions[5..] {
        match instruction.operation {
            Operation::SinCos(a) | Operation::Call(_, a) => {
                instruction.operation = Operation::Negate(a);
            }
            // Clippy would ask whether it is meant.
            Operation::Subtract(a, b) if a == b => instruction.operation = Operation::Negate(a),
            _ => {}
        }
    }
    let output = &mut function.program.outputs[0];
    output.entries.truncate(entries);
    output.entries[0] = value(4);
    output.entries[1] = Operand::Input(1, 3);
    output.shape = match entries {
        36 => common::square(6),
        entries => Shape::Vector(Extent::fixed(entries)),
    };
    function
}

#[test]
fn lanes_have_the_bits_of_single_states() {
    let joints = ["a", "b", "c", "d", "e", "f"].map(|name| (name, JointKind::Revolute));
    let model = chain("six", &joints);
    let main = "mod robot { include!(\"robot.rs\"); }
        use robot::Lanes;
        fn main() {
            let many = |k: usize| -> [Lanes; 6] {
                core::array::from_fn(|i| Lanes(core::array::from_fn(|l| ((k * 48 + i * 8 + l) as f64 * 0.7).rem_euclid(5.0) - 2.5)))
            };
            let (y, v, a) = (many(1), many(2), many(3));
            let mut r = ZERO;
            robot::synthetic_lanes(&y, &v, &a, &mut r);
            for l in 0..8 {
                let one = |x: &[Lanes; 6]| -> [f64; 6] { core::array::from_fn(|i| x[i].0[l]) };
                let expected = robot::synthetic(&one(&y), &one(&v), &one(&a));
                COMPARE
            }
            println!(\"same\");
        }";
    let forms = [
        (
            36,
            "[[Lanes([0.0; 8]); 6]; 6]",
            "for i in 0..6 { for j in 0..6 { assert_eq!(r[i][j].0[l].to_bits(), expected[i][j].to_bits()); } }",
        ),
        (
            6,
            "[Lanes([0.0; 8]); 6]",
            "for i in 0..6 { assert_eq!(r[i].0[l].to_bits(), expected[i].to_bits()); }",
        ),
    ];
    for (entries, zero, compare) in forms {
        let module =
            Module { lanes: vec!["synthetic".into()], ..Module::new(&model, vec![laned(entries)], &[]) };
        let text = emit::module(&module, &EmitOptions::default()).text;
        assert_compiles("six", &text);
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("robot.rs"), text).unwrap();
        let main = main.replace("ZERO", zero).replace("COMPARE", compare);
        rustc(folder.path(), "main", &main, &["-O", "-A", "warnings"]).unwrap();
        let output = Command::new(folder.path().join("main")).output().unwrap();
        assert_eq!(
            String::from_utf8_lossy(&output.stdout),
            "same\n",
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn same_arguments_give_the_same_bytes() {
    let emit = || emit_with(&powercube(), &[mass_matrix(), every_operation()], |_| {});
    assert_eq!(emit(), emit());
}
