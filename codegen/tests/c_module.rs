//! The emitted C is what it should be, compiles as C99 and as C++ without a warning, and computes what the interpreter
//! computes.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]
#![allow(clippy::approx_constant, reason = "numbers that look like constants are what is tested")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use super::common::{self, chain, every_operation, mass_matrix, parameter, powercube, synthetic};
use gelenk_codegen::emit::{self, Companion, EmitOptions, Language, Scalar, SourceFile};
use gelenk_codegen::formula::Function as Call;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::layout::Extent;
use gelenk_codegen::model::{JointKind, Model};
use gelenk_codegen::module::Module;
use gelenk_codegen::program::interpret::interpret;
use gelenk_codegen::program::{Operand, Operation, Output, Program, Shape};
use gelenk_kernels::math;

const COMPILERS: [[&str; 3]; 2] = [["cc", "-x", "c"], ["c++", "-x", "c++"]];

const WARNINGS: [&str; 4] = ["-Wall", "-Wextra", "-Werror", "-pedantic"];

fn emit_with(model: &Model, functions: &[Function], change: impl FnOnce(&mut EmitOptions)) -> SourceFile {
    let command = format!("gelenk generate models/{}.toml --language c", model.name);
    let mut options = EmitOptions { language: Language::C, command, ..EmitOptions::default() };
    change(&mut options);
    emit::module(&Module::new(model, functions.to_vec(), &[]), &options)
}

fn both(source: &SourceFile) -> String {
    let files = source.files().into_iter();
    files.map(|(ending, text)| format!("=== {}{ending}\n{text}\n", source.name)).collect()
}

fn put(folder: &Path, source: &SourceFile) {
    for (ending, text) in source.files() {
        fs::write(folder.join(format!("{}{ending}", source.name)), text).unwrap();
    }
}

/// Runs a compiler; `None`, with a note, where there is none.
fn compile(folder: &Path, compiler: [&str; 3], arguments: &[&str]) -> Option<Result<(), String>> {
    let [program, language @ ..] = compiler;
    let standard = if program == "cc" { &["-std=c99"][..] } else { &[] };
    let output = Command::new(program)
        .current_dir(folder)
        .args(language)
        .args(standard)
        .args(WARNINGS)
        .args(arguments)
        .output();
    let Ok(output) = output else {
        println!("skipped: no {program}");
        return None;
    };
    Some(match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    })
}

fn assert_compiles(source: &SourceFile, flags: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), source);
    let sources = source.files().into_iter().filter(|(ending, _)| ending.ends_with(".c"));
    let sources: Vec<String> = sources.map(|(ending, _)| format!("{}{ending}", source.name)).collect();
    for compiler in COMPILERS {
        for file in &sources {
            let arguments = [flags, &["-fsyntax-only", file]].concat();
            compile(folder.path(), compiler, &arguments).unwrap_or(Ok(())).unwrap();
        }
    }
}

fn has_fma() -> bool {
    let has_fma = std::arch::is_x86_feature_detected!("fma");
    if !has_fma {
        println!("skipped: no fused multiply-add here");
    }
    has_fma
}

/// Runs a function of arrays of 8 entries on all samples in one process, the result of `count` entries; both compilers.
///
/// - `ty`: `double` or `float`
fn run(
    source: &SourceFile,
    call: &str,
    ty: &str,
    inputs: usize,
    outputs: usize,
    samples: &[u8],
) -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), source);
    let main = format!(
        "#include \"{}.h\"\n#include <stdio.h>\nint main(void)\n{{\n    {ty} x[{inputs}], r[{outputs}];\n    \
         while (fread(x, sizeof *x, {inputs}, stdin) == {inputs}) {{\n        {call};\n        \
         fwrite(r, sizeof *r, {outputs}, stdout);\n    }}\n    return 0;\n}}\n",
        source.name
    );
    fs::write(folder.path().join("main.c"), main).unwrap();
    let file = format!("{}.c", source.name);
    let compilers = COMPILERS.into_iter().filter_map(|compiler| {
        let fma = if source.text.contains("__FMA__") { &["-mfma"][..] } else { &[] };
        let arguments = [&["-O2", "main.c", &file, "-o", "main"], fma].concat();
        compile(folder.path(), compiler, &arguments)?.unwrap();
        let mut child = Command::new(folder.path().join("main"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let given = samples.to_vec();
        let writer = std::thread::spawn(move || stdin.write_all(&given));
        let found = child.wait_with_output().unwrap().stdout;
        writer.join().unwrap().unwrap();
        Some(found)
    });
    compilers.collect()
}

/// IEEE 754 leaves sign and payload of a NaN open; all other values must agree in every bit.
fn assert_same_bits(found: &[u8], expected: &[f64]) {
    let found: Vec<u64> = found.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
    assert_eq!(found.len(), expected.len());
    for (index, (&bits, &b)) in found.iter().zip(expected).enumerate() {
        let a = f64::from_bits(bits);
        assert!(bits == b.to_bits() || (a.is_nan() && b.is_nan()), "[{index}]: {a:?} and {b:?}");
    }
}

fn bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn powercube_module() {
    let mut model = powercube();
    model.parameters = vec![parameter("g", 9.80665, "m/s²", "Gravity."), parameter("class", 1.0, "", "")];
    let source = emit_with(&model, &[mass_matrix()], |_| {});
    insta::assert_snapshot!(both(&source));
    assert_compiles(&source, &[]);
}

#[test]
fn every_operation_in_both_scalars() {
    let mut function = every_operation();
    function.program.outputs[0].entries = vec![Operand::Value(17)];
    for (scalar, name) in [(Scalar::F64, "f64"), (Scalar::F32, "f32")] {
        let model = chain("pair", &[("a", JointKind::Revolute), ("b", JointKind::Prismatic)]);
        let source = emit_with(&model, std::slice::from_ref(&function), |options| options.scalar = scalar);
        let body = source.text.split_once(" pair_every_operation(").unwrap().1;
        insta::assert_snapshot!(name, body);
        if has_fma() {
            assert_compiles(&source, &["-mfma"]);
        }
    }
}

#[test]
fn interpreter_and_compiled_code_agree_in_every_bit() {
    if !has_fma() {
        return;
    }
    let model = chain("pair", &[("a", JointKind::Revolute), ("b", JointKind::Prismatic)]);
    let function = every_operation();
    let special = [0.0, -0.0, f64::NAN, f64::INFINITY, -1.5, 1e-310, 3.0, 1e300];
    let samples: Vec<f64> = special.iter().flat_map(|&a| special.iter().flat_map(move |&b| [a, b])).collect();
    let source = emit_with(&model, std::slice::from_ref(&function), |_| {});
    let expected: Vec<f64> = samples
        .chunks(2)
        .flat_map(|y| interpret(&function.program, &[y, &[0.0; 2]], &[]).unwrap().concat())
        .collect();
    for found in run(&source, "r[0] = pair_every_operation(x, x)", "double", 2, 1, &bytes(&samples)) {
        assert_same_bits(&found, &expected);
    }
}

#[test]
fn a_split_function_keeps_every_bit() {
    let joints = ["a", "b", "c", "d", "e", "f"].map(|name| (name, JointKind::Revolute));
    let model = chain("six", &joints);
    let mut random = common::Random(7);
    let samples: Vec<f64> = (0..18 * 20).map(|_| random.number()).collect();
    for (seed, longest) in [(1, usize::MAX), (1, 19), (2, 60)] {
        let function = synthetic(1500, seed);
        let source = emit_with(&model, std::slice::from_ref(&function), |options| {
            options.longest_function = longest;
        });
        assert_eq!(source.text.contains("_part_2("), longest < 1500);
        let expected: Vec<f64> = samples
            .chunks(18)
            .flat_map(|x| {
                let inputs: Vec<&[f64]> = x.chunks(6).collect();
                interpret(&function.program, &inputs, &[]).unwrap().concat()
            })
            .collect();
        let outputs = expected.len() / 20;
        let call = match outputs {
            1 => format!("r[0] = six_{}(x, x + 6, x + 12)", function.name),
            _ => {
                let mut at = 0;
                let results = function.program.outputs.iter().map(|output| {
                    at += output.entries.len();
                    format!(", r + {}", at - output.entries.len())
                });
                format!("six_{}(x, x + 6, x + 12{})", function.name, results.collect::<String>())
            }
        };
        for found in run(&source, &call, "double", 18, outputs, &bytes(&samples)) {
            assert_same_bits(&found, &expected);
        }
    }
}

/// A function of eight numbers: sines, cosines, tanh and exp of each; angles alone and in calls of several.
fn elementary() -> Function {
    let mut function = every_operation();
    function.name = "elementary".into();
    let mut instructions = vec![];
    let mut entries = vec![];
    let mut push = |name: String, operation| {
        instructions.push(common::instruction(&name, operation));
        entries.push(Operand::Value(instructions.len() - 1));
        instructions.len() - 1
    };
    for i in 0..8 {
        let pair = push(format!("sine_{i}"), Operation::SinCos(Operand::Input(0, i)));
        push(format!("cosine_{i}"), Operation::CosineOf(pair));
    }
    for i in 0..8 {
        push(format!("sin_{i}"), Operation::Call(Call::Sin, Operand::Input(0, i)));
        push(format!("tanh_{i}"), Operation::Call(Call::Tanh, Operand::Input(0, i)));
        push(format!("exp_{i}"), Operation::Call(Call::Exp, Operand::Input(0, i)));
        push(format!("sign_{i}"), Operation::Call(Call::Sign, Operand::Input(0, i)));
        push(format!("abs_{i}"), Operation::Call(Call::Abs, Operand::Input(0, i)));
    }
    let shape = Shape::Vector(Extent::fixed(entries.len()));
    function.program = Program {
        inputs: vec![common::input("x", 8)],
        instructions,
        outputs: vec![Output { name: "r".into(), shape, entries }],
    };
    function
}

/// Random bits, which are of any size and also not a number; and angles around the limit of the fast path.
fn anything(random: &mut common::Random) -> u64 {
    match random.below(3) {
        0 => random.next() << 32 ^ random.next(),
        1 => (60_000.0 * random.number()).to_bits(),
        _ => (5.0 * random.number()).to_bits(),
    }
}

#[test]
fn elementary_functions_have_the_bits_of_the_kernels() {
    let model = chain("pair", &[("a", JointKind::Revolute)]);
    let function = elementary();
    let mut random = common::Random(11);
    let samples: Vec<f64> = (0..8 * 10_000).map(|_| f64::from_bits(anything(&mut random))).collect();
    let source = emit_with(&model, std::slice::from_ref(&function), |_| {});
    let expected: Vec<f64> =
        samples.chunks(8).flat_map(|x| interpret(&function.program, &[x], &[]).unwrap().concat()).collect();
    for found in run(&source, "pair_elementary(x, r)", "double", 8, 56, &bytes(&samples)) {
        assert_same_bits(&found, &expected);
    }
}

#[test]
fn elementary_functions_in_single_precision_have_the_bits_of_the_kernels() {
    let model = chain("pair", &[("a", JointKind::Revolute)]);
    let source = emit_with(&model, &[elementary()], |options| options.scalar = Scalar::F32);
    let mut random = common::Random(12);
    let samples: Vec<f32> = (0..8 * 10_000)
        .map(|index| match index % 2 {
            0 => f32::from_bits(random.next() as u32),
            _ => f64::from_bits(anything(&mut random)) as f32,
        })
        .collect();
    let sign = |x: f32| if x == 0.0 { 0.0 } else { x.signum() };
    let expected: Vec<f32> = samples
        .chunks(8)
        .flat_map(|x| {
            let pairs = x.iter().flat_map(|&x| <[f32; 2]>::from(math::sin_cos_f32(x)));
            let others = x.iter().flat_map(|&x| {
                [math::sin_cos_f32(x).0, math::tanh_f32(x), math::exp_f32(x), sign(x), x.abs()]
            });
            pairs.chain(others).collect::<Vec<f32>>()
        })
        .collect();
    let given: Vec<u8> = samples.iter().flat_map(|x| x.to_le_bytes()).collect();
    for found in run(&source, "pair_elementary(x, r)", "float", 8, 56, &given) {
        let found: Vec<f32> = found.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!(found.len(), expected.len());
        for (index, (a, b)) in found.iter().zip(&expected).enumerate() {
            let same = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
            assert!(same, "[{index}]: {a:?} and {b:?} of {:?}", samples[index / 56 * 8]);
        }
    }
}

#[test]
fn no_text_of_a_description_becomes_code() {
    let evil = "*/ \"; abort(); /* } \\ \r\n\u{202e} [x] <b> ` #error ??/ 'ü' {} // https://e.org \\";
    let mut model = chain("switch", &[(evil, JointKind::Revolute), ("β", JointKind::Revolute)]);
    model.description = vec![evil.into(), "- list".into(), "ends with a trigraph ??/".into()];
    model.parameters = vec![
        parameter(evil, 1.0, evil, evil),
        parameter("p", 1.0, "", "- a"),
        parameter("p", 0.0, "", ""),
        parameter("__FILE__", 0.0, "", "ends with \\"),
        parameter("template", 0.0, "", ""),
        parameter("linux", 0.0, "", ""),
    ];
    let mut function = mass_matrix();
    function.name = "a b".into();
    function.summary = evil.into();
    function.equation = evil.into();
    function.arguments = vec![common::argument(evil, &[(evil, "rad")])];
    function.results = vec![evil.into()];
    function.notes = vec![evil.into()];
    function.program.inputs[0].name = "p".into();
    for (instruction, name) in
        function.program.instructions.iter_mut().zip(["switch_sin_cos", evil, "class", "p", "SWITCH_N", "y"])
    {
        instruction.name = name.into();
    }
    function.program.outputs[0].name = evil.into();
    let source = emit_with(&model, &[function], |options| {
        options.command = evil.into();
        options.companions = vec![Companion::Python];
    });
    insta::assert_snapshot!(both(&source));
    assert_compiles(&source, &[]);
}

#[test]
fn loops_for_python() {
    let mut model = powercube();
    model.parameters = vec![parameter("g", 9.80665, "m/s²", "Gravity.")];
    let source = emit_with(&model, &[mass_matrix()], |options| options.companions = vec![Companion::Python]);
    let (_, text) = source.companions.first().unwrap();
    insta::assert_snapshot!(text);
    assert_compiles(&source, &[]);
    // In single precision, without inputs, and by another name.
    model.drives.clear();
    let source = emit_with(&model, &[mass_matrix()], |options| {
        options.companions = vec![Companion::Python];
        options.scalar = Scalar::F32;
        options.name = Some("my-arm.v2".into());
    });
    assert!(!source.companions[0].1.contains("double"));
    assert_compiles(&source, &[]);
}

/// A robot without inputs has constants without entries, which C does not know.
#[test]
fn a_robot_without_inputs_compiles() {
    let mut model = powercube();
    model.drives.clear();
    let source = emit_with(&model, &[mass_matrix()], |_| {});
    assert!(source.header.as_deref().unwrap().contains("#define POWERCUBE_M 0\n"));
    assert_compiles(&source, &[]);
}

/// The text refuses compiler options that silently change results.
#[test]
fn options_that_change_the_results_are_refused() {
    let model = chain("pair", &[("a", JointKind::Revolute), ("b", JointKind::Prismatic)]);
    let source = emit_with(&model, &[every_operation()], |_| {});
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), &source);
    for (flags, reason) in [
        (&["-mfma", "-ffast-math"][..], "-ffast-math and its parts change the results"),
        (&["-mfma", "-ffinite-math-only"][..], "-ffast-math and its parts change the results"),
        (&["-mno-fma"][..], "these functions contain fused multiply-adds"),
    ] {
        let arguments = [flags, &["-fsyntax-only", "pair.c"]].concat();
        if let Some(result) = compile(folder.path(), COMPILERS[0], &arguments) {
            let message = result.unwrap_err();
            assert!(message.contains(reason), "{message}");
        }
    }
}

#[test]
fn names_begin_with_the_name_of_the_files() {
    let source = emit_with(&powercube(), &[mass_matrix()], |options| options.name = Some("my-arm.v2".into()));
    assert!(
        source.text.contains("#include \"my-arm.v2.h\"") && source.text.contains(" my_arm_v2_mass_matrix(")
    );
    assert_compiles(&source, &[]);
}
