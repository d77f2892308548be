//! Functions over eight states: the bits of the scalar function in every state, for every function that has
//! the form.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write as _;
use std::process::Command;

use gelenk_codegen::emit::{EmitOptions, Scalar};
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};
use gelenk_codegen::program::Output;
use gelenk_tests::compiler::{clippy, rustc};
use gelenk_tests::workspace;

/// Functions of a robot over lanes; none means all.
fn robot(name: &str, functions: &[&str], scalar: Scalar, fused: bool) -> Generated {
    let description = workspace().join("models").join(format!("{name}.toml"));
    let mut options = GenerateOptions {
        functions: functions.iter().map(|&name| name.to_owned()).collect(),
        fused_multiply_add: fused,
        emit: EmitOptions { scalar, ..EmitOptions::default() },
        ..GenerateOptions::default()
    };
    let generate = |options: &GenerateOptions| {
        generate(&description, options).unwrap_or_else(|problems| panic!("{problems}"))
    };
    options.lanes = options.functions.clone();
    if functions.is_empty() {
        let plain = generate(&options).module.functions;
        options.lanes = plain.into_iter().map(|function| function.name).collect();
    }
    generate(&options)
}

/// Code that every comparison uses: states, one state of many, and bits.
const COMMON: &str = r#"
#[allow(warnings)]
mod robot { include!("robot.rs"); }
use robot::Lanes;

/// Repeatable numbers between −3 and 3: Knuth's linear congruential generator. Some are zero, some far out.
struct Numbers(u64);
impl Numbers {
    fn next(&mut self) -> Real {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let number = ((self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 6.0;
        (match self.0 >> 40 & 63 { 0 => 0.0, 1 => number * 1e5, _ => number }) as Real
    }
    fn many<const K: usize>(&mut self) -> [Lanes; K] {
        core::array::from_fn(|_| Lanes(core::array::from_fn(|_| self.next())))
    }
}

fn one<const K: usize>(many: &[Lanes; K], i: usize) -> [Real; K] { many.each_ref().map(|x| x.0[i]) }

trait Bits { fn push(&self, bits: &mut Vec<Real>); }
impl Bits for Real { fn push(&self, bits: &mut Vec<Real>) { bits.push(*self); } }
impl<T: Bits, const K: usize> Bits for [T; K] {
    fn push(&self, bits: &mut Vec<Real>) { self.iter().for_each(|x| x.push(bits)); }
}

trait Many {
    /// Not a number in every place: what is not written shows.
    fn unwritten() -> Self;
    fn push(&self, i: usize, bits: &mut Vec<Real>);
}
impl Many for Lanes {
    fn unwritten() -> Self { Lanes([Real::NAN; 8]) }
    fn push(&self, i: usize, bits: &mut Vec<Real>) { bits.push(self.0[i]); }
}
impl<T: Many, const K: usize> Many for [T; K] {
    fn unwritten() -> Self { core::array::from_fn(|_| T::unwritten()) }
    fn push(&self, i: usize, bits: &mut Vec<Real>) { self.iter().for_each(|x| x.push(i, bits)); }
}

fn compare(name: &str, form: &str, i: usize, found: &[Real], expected: &[Real]) {
    assert_eq!(found.len(), expected.len(), "{name}");
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(a.to_bits() == b.to_bits(), "{name}{form}[{k}] of state {i}: {a:?} instead of {b:?}");
    }
}
"#;

/// The variable of a result over lanes.
fn unwritten(index: usize, output: &Output) -> String {
    let extents = output.shape.extents().into_iter().rev();
    let ty = extents.fold("Lanes".to_owned(), |entry, extent| format!("[{entry}; {}]", extent.len));
    format!("            let mut r{index} = <{ty}>::unwritten();\n")
}

/// One function: its scalar form on each state, and its forms over lanes.
fn comparison(robot: &Generated, name: &str) -> String {
    let function = robot.module.functions.iter().find(|function| function.name == name);
    let program = &function.unwrap_or_else(|| panic!("{name}")).program;
    let inputs = 0..program.inputs.len();
    let p = (!robot.model.parameters.is_empty()).then_some("&p");
    let (mut many, mut single) = (String::new(), String::new());
    for input in inputs {
        let len = program.inputs[input].extent.len;
        let _ = writeln!(many, "        let x{input} = numbers.many::<{len}>();");
        let _ = write!(single, "&one(&x{input}, i), ");
    }
    let outputs = &program.outputs;
    let results: String = outputs.iter().enumerate().map(|(k, output)| unwritten(k, output)).collect();
    let list = |prefix: &str, count: usize, before: &str| -> String {
        (0..count).map(|k| format!("{before}{prefix}{k}, ")).collect()
    };
    let arguments = format!(
        "{}{}{}",
        list("x", program.inputs.len(), "&"),
        p.map(|p| format!("{p}, ")).unwrap_or_default(),
        list("r", outputs.len(), "&mut ")
    );
    let pushes: String = match outputs.len() {
        1 => "result.push(&mut expected);".to_owned(),
        count => (0..count).map(|k| format!("result.{k}.push(&mut expected);")).collect(),
    };
    let found: String = (0..outputs.len()).map(|k| format!("r{k}.push(i, &mut found);")).collect();
    let check = |form: &str, call: &str| {
        format!(
            "{results}            {call};
            for i in 0..8 {{
                let result = robot::{name}({single}{});
                let (mut expected, mut found) = (vec![], vec![]);
                {pushes} {found}
                compare(\"{name}\", \"{form}\", i, &found, &expected);
            }}\n",
            p.unwrap_or_default()
        )
    };
    let on_x86 = |form: &str, feature: &str| {
        let call = format!("unsafe {{ robot::{name}_lanes_{form}({arguments}) }}");
        format!(
            "        #[cfg(target_arch = \"x86_64\")]\n        if is_x86_feature_detected!(\"{feature}\") {{\n{}        }}\n",
            check(&format!(" {form}"), &call)
        )
    };
    let call = format!("robot::{name}_lanes({arguments})");
    format!(
        "    for _ in 0..20 {{\n{many}        {{\n{}        }}\n{}{}    }}\n",
        check("", &call),
        on_x86("avx2", "avx2"),
        on_x86("avx512", "avx512dq")
    )
}

/// The functions of a module that have a form over lanes.
fn over_lanes(text: &str) -> Vec<String> {
    let lines = text.lines().filter_map(|line| line.strip_prefix("pub fn "));
    let names = lines.filter_map(|line| line.split('(').next()?.strip_suffix("_lanes"));
    names.map(str::to_owned).collect()
}

/// Compiles and runs all comparisons of a robot; how many functions they were.
fn check(robot: &Generated, scalar: Scalar, flags: &[&str]) -> usize {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("robot.rs"), &robot.source.text).expect("a file");
    let names = over_lanes(&robot.source.text);
    let comparisons = names.iter().map(|name| comparison(robot, name));
    let comparisons: String = comparisons.collect();
    let parameters = match robot.model.parameters.is_empty() {
        true => "",
        false => "    let p = robot::Parameters::default();\n",
    };
    let real = match scalar {
        Scalar::F64 => "f64",
        Scalar::F32 => "f32",
    };
    let main = format!(
        "type Real = {real};\n{}\nfn main() {{\n    let mut numbers = Numbers(7);\n{parameters}{comparisons}    println!(\"same\");\n}}\n",
        COMMON
    );
    // Level 2 makes SIMD code too.
    let flags = [&["-C", "opt-level=2", "-A", "warnings"], flags].concat();
    rustc(folder.path(), "main", &main, &flags).unwrap_or_else(|message| panic!("{message}"));
    let output = Command::new(folder.path().join("main")).output();
    let output = output.expect("the program starts");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {message}", robot.source.name);
    names.len()
}

/// Number of functions of a robot without a state: the input matrix, parameters of bodies and of friction.
const WITHOUT_STATE: usize = 3;

#[test]
fn all_functions_have_the_bits_of_single_states() {
    for name in ["cart_pole", "powercube", "powercube_parameters"] {
        let robot = robot(name, &[], Scalar::F64, false);
        let count = check(&robot, Scalar::F64, &[]);
        assert_eq!(count, robot.module.functions.len() - WITHOUT_STATE, "{name}");
    }
}

/// Functions that are cut into several loops.
const LONG: [&str; 4] = ["inverse_dynamics", "forward_dynamics", "inverse_dynamics_derivatives", "linearize"];

#[test]
fn long_functions_have_the_bits_of_single_states() {
    for name in ["ur5", "panda"] {
        let robot = robot(name, &LONG, Scalar::F64, false);
        assert_eq!(check(&robot, Scalar::F64, &[]), LONG.len(), "{name}");
        // A Panda's Jacobians would be loops over joints.
        let is_noted = robot.notes.to_string().contains("`linearize` is straight-line code of");
        assert_eq!(is_noted, name == "panda", "{}", robot.notes);
    }
}

/// Followers, an input matrix that depends on the state, quaternions, and inputs at frames of a floating body.
#[test]
fn mechanisms_have_the_bits_of_single_states() {
    for name in ["palletizer", "excavator", "satellite", "quadrotor"] {
        let functions = ["inverse_dynamics", "linearize"];
        let robot = robot(name, &functions, Scalar::F64, false);
        assert_eq!(check(&robot, Scalar::F64, &[]), functions.len(), "{name}");
    }
}

#[test]
fn f32_has_the_bits_of_single_states() {
    let robot = robot("ur5", &LONG, Scalar::F32, false);
    assert_eq!(check(&robot, Scalar::F32, &[]), LONG.len());
}

#[test]
fn fused_functions_have_the_bits_of_single_states() {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("fma") {
        let robot = robot("ur5", &LONG[..2], Scalar::F64, true);
        assert_eq!(check(&robot, Scalar::F64, &["-C", "target-feature=+fma"]), 2);
        return;
    }
    println!("skipped: no x86-64 with fma");
}

#[test]
fn modules_compile_without_a_warning() {
    for (name, scalar) in
        [("powercube_parameters", Scalar::F64), ("ur5", Scalar::F32), ("cart_pole", Scalar::F64)]
    {
        let robot = robot(name, &[], scalar, false);
        check_warnings(name, &robot);
    }
}

/// In short parts the angles, which stand first, fill the first ones.
#[test]
fn parts_of_angles_alone_are_no_loops() {
    let mut options =
        GenerateOptions { functions: vec!["inverse_dynamics".to_owned()], ..GenerateOptions::default() };
    options.lanes = options.functions.clone();
    options.emit.longest_function = 4;
    let robot = generate(&workspace().join("models/ur5.toml"), &options);
    let robot = robot.unwrap_or_else(|problems| panic!("{problems}"));
    check_warnings("ur5", &robot);
    assert_eq!(check(&robot, Scalar::F64, &[]), 1);
}

fn check_warnings(name: &str, robot: &Generated) {
    let arguments = ["--crate-type", "lib", "--emit", "metadata"];
    let text = format!(
        "#![deny(warnings, missing_docs, clippy::all, nonstandard_style)]\n#![no_std]\n//! Robots.\n\
         /// Robot.\npub mod robot {{\n{}}}\n",
        robot.source.text
    );
    let folder = tempfile::tempdir().expect("a folder");
    let result = clippy(folder.path(), name, &text, &arguments);
    result.unwrap_or_else(|message| panic!("{name}: {message}"));
}

#[test]
fn unknown_names_are_errors_and_impossible_ones_are_noted() {
    let description = workspace().join("models/cart_pole.toml");
    let asked = |functions: &[&str], lanes: &[&str]| {
        let strings = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let mut options = GenerateOptions { functions: strings(functions), ..GenerateOptions::default() };
        options.lanes = strings(lanes);
        generate(&description, &options)
    };
    let unknown = asked(&[], &["linearise"]).expect_err("there is no such function");
    let as_function = asked(&["linearise"], &[]).expect_err("there is no such function");
    assert_eq!(unknown.to_string(), as_function.to_string());
    let robot = asked(&["mass_matrix"], &["linearize", "step", "input_matrix"]).expect("a robot");
    assert_eq!(over_lanes(&robot.source.text), ["linearize"]);
    let notes = robot.notes.to_string();
    for name in ["`step`", "`input_matrix`"] {
        assert!(
            notes.contains(&format!("{name} cannot be generated for eight states at once (lanes)")),
            "{notes}"
        );
    }
}

#[test]
fn descriptions_may_ask_for_lanes() {
    let folder = tempfile::tempdir().expect("a folder");
    let description = folder.path().join("cart_pole.toml");
    let text = std::fs::read_to_string(workspace().join("models/cart_pole.toml")).expect("a file");
    let of = |lanes: &str| {
        let text = format!("{text}\n[generate]\nlanes = [{lanes}]\n");
        std::fs::write(&description, text).expect("a file");
        generate(&description, &GenerateOptions::default())
    };
    let robot = of("\"mass_matrix\", \"linearize\"").expect("a robot");
    assert_eq!(over_lanes(&robot.source.text), ["mass_matrix", "linearize"]);
    let problem = of("\"linearise\"").expect_err("no such function").to_string();
    assert!(problem.contains("did you mean `linearize`?"), "{problem}");
}
