//! From a mutated description to a module: no panic, no hang, a module that compiles or a message.
//!
//! `GELENK_MUTATIONS=50000 cargo test --release -p gelenk-codegen --test all robustness::generation -- --nocapture`
//! is the long form; it takes an hour or two.

use super::mutation::{Random, rewritten};
use gelenk_codegen::emit::{self, EmitOptions, Language, Scalar};
use gelenk_codegen::function_names;
use gelenk_codegen::output::{Planned, Replaces};
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate, generate_pair};
use gelenk_codegen::program::{Operand, Operation};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{OnceLock, mpsc};
use std::time::{Duration, Instant};

/// Descriptions of the short form.
const MUTATIONS: usize = 500;
/// Each so many of what is generated is compiled.
const COMPILED: usize = 100;
/// Work of the processor on one description. It is fractions of a second in a release build, and more in a
/// debug build.
const MOST_WORK: Duration = Duration::from_secs(if cfg!(debug_assertions) { 60 } else { 10 });
/// Time until a description counts as one that never ends: a busy machine may take much longer than the work.
const PATIENCE: Duration = Duration::from_secs(300);

/// The first of them are small: the short form takes few others.
const SMALL: usize = 8;

/// What is mutated.
const SEEDS: [&str; 14] = [
    "cart_pole.toml",
    "cart_pole.toml",
    "double_pendulum.toml",
    "double_pendulum.toml",
    "powercube.toml",
    "powercube.toml",
    "powercube_alpha_parameters.toml",
    "powercube_parameters.toml",
    "powercube_six_axis.toml",
    "puma560.toml",
    "schunk_lwa4p.toml",
    "two_arm.toml",
    "urdf/ur5.urdf",
    "urdf/panda.urdf",
];

/// What some of them extend.
const BASES: [&str; 1] = ["powercube_alpha.toml"];

/// A description and what is asked of it.
#[derive(Debug, Clone)]
struct Case {
    index: usize,
    file: &'static str,
    text: String,
    options: GenerateOptions,
    control_model: Option<f64>,
}

impl Case {
    /// The same for the same index, whatever the others are.
    fn new(index: usize) -> Self {
        let mut random = Random(0x6d75_7461_7465 ^ (index as u64) << 20);
        let is_short = index < MUTATIONS && !random.chance(25);
        let file = random.one(if is_short { &SEEDS[..SMALL] } else { &SEEDS });
        Self {
            index,
            file,
            text: rewritten(&seed(file), &mut random),
            options: options(&mut random),
            control_model: random.chance(10).then_some(50.0),
        }
    }

    fn run(&self, path: &Path) -> Result<Vec<Generated>, String> {
        let found = match self.control_model {
            Some(slope) => generate_pair(path, &self.options, slope).map(Vec::from),
            None => generate(path, &self.options).map(|robot| vec![robot]),
        };
        found.map_err(|problems| problems.to_string())
    }
}

/// Mostly a few functions; all of them take longer.
fn options(random: &mut Random) -> GenerateOptions {
    let names: Vec<&str> = function_names::listed().collect();
    let some = |random: &mut Random, most: usize| -> Vec<String> {
        let count = random.below(most);
        (0..count).map(|_| (*random.one(&names)).to_owned()).collect()
    };
    let mut functions = some(random, 4);
    if functions.is_empty() && !random.chance(4) {
        functions.push("inverse_dynamics".to_owned());
    }
    let lanes = match random.chance(3) {
        true => functions.clone(),
        false => vec![],
    };
    GenerateOptions {
        functions,
        snap_angles: random.chance(5).then_some(1e-4),
        no_friction: random.chance(5),
        ignore_mimic: random.chance(2),
        smooth_sign: random.chance(5).then_some(20.0),
        fused_multiply_add: random.chance(8),
        emit: EmitOptions { scalar: [Scalar::F64, Scalar::F32][random.below(2)], ..EmitOptions::default() },
        lanes,
        ..GenerateOptions::default()
    }
}

fn seed(file: &str) -> String {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    fs::read_to_string(models.join(file)).expect(file)
}

/// What became of a case.
struct Finished {
    case: Case,
    took: Duration,
    /// Modules or the message; the message of a panic otherwise.
    result: Result<Result<Vec<Generated>, String>, String>,
}

/// Time that the processor worked for this thread; the time of day where the system does not tell.
fn work_of_thread() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| START.get_or_init(Instant::now).elapsed(), Duration::from_nanos)
}

/// The same modules for the other printer.
fn print_in_c(found: &Result<Vec<Generated>, String>) {
    for robot in found.iter().flatten() {
        let options = EmitOptions { language: Language::C, ..EmitOptions::default() };
        assert!(emit::module(&robot.module, &options).header.is_some());
    }
}

/// Runs the cases one after the other; who waits sees a hang.
fn work(cases: impl Iterator<Item = usize>, folder: &Path, to: &mpsc::Sender<Option<Finished>>) {
    for index in cases {
        let case = Case::new(index);
        let path = folder.join(format!("case_{index}.{}", extension(case.file)));
        fs::write(&path, &case.text).expect("a description");
        let start = work_of_thread();
        let result = catch_unwind(AssertUnwindSafe(|| case.run(&path)));
        let took = work_of_thread().saturating_sub(start);
        let result =
            result.and_then(|found| catch_unwind(AssertUnwindSafe(|| print_in_c(&found))).map(|()| found));
        let result = result.map_err(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            text.unwrap_or_else(|| "a panic".to_owned())
        });
        let finished = Finished { case, took, result };
        if to.send(Some(finished)).is_err() {
            return;
        }
    }
    let _ = to.send(None);
}

fn extension(file: &str) -> &str {
    file.rsplit('.').next().unwrap_or_default()
}

/// Every constant is a number: what is not finite would be silently wrong.
fn check_numbers(robot: &Generated, index: usize) {
    for function in &robot.module.functions {
        let entries = function.program.outputs.iter().flat_map(|output| &output.entries);
        let instructions = function.program.instructions.iter();
        let operands = instructions.flat_map(|made| operands(made.operation));
        for operand in entries.copied().chain(operands) {
            let is_number = !matches!(operand, Operand::Constant(x) if !x.is_finite());
            assert!(is_number, "case {index}: {operand:?} in {}", function.name);
        }
    }
}

fn operands(operation: Operation) -> Vec<Operand> {
    match operation {
        Operation::Add(a, b)
        | Operation::Subtract(a, b)
        | Operation::Multiply(a, b)
        | Operation::Divide(a, b) => vec![a, b],
        Operation::MultiplyAdd(a, b, c) => vec![a, b, c],
        Operation::Negate(a) | Operation::SinCos(a) | Operation::Call(_, a) => vec![a],
        Operation::CosineOf(_) => vec![],
    }
}

/// Modules that wait for the compiler.
#[derive(Default)]
struct Crate {
    text: String,
    modules: usize,
}

impl Crate {
    fn add(&mut self, robot: &Generated, index: usize) {
        let _ = writeln!(
            self.text,
            "/// Case {index}.\npub mod case_{index}_{} {{\n{}}}",
            robot.source.name, robot.source.text
        );
        self.modules += 1;
    }

    fn compile(&mut self, folder: &Path) {
        let file = folder.join("modules.rs");
        let text = format!("#![deny(warnings, missing_docs)]\n//! Robots.\n{}", self.text);
        fs::write(&file, text).expect("the modules");
        let fma: &[&str] = match cfg!(target_arch = "x86_64") {
            true => &["-C", "target-feature=+fma"],
            false => &[],
        };
        let output = Command::new(std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned()))
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env_remove("RUSTFLAGS")
            .args(["--edition", "2024", "--crate-type", "lib", "--emit", "metadata", "-o"])
            .arg(folder.join("modules.rmeta"))
            .arg(&file)
            .args(fma)
            .output()
            .expect("rustc starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        *self = Self::default();
    }
}

/// Writes the modules as the program does: nothing but them is then in the folder.
fn write(robots: &[Generated], folder: &Path) {
    let _ = fs::remove_dir_all(folder);
    for robot in robots {
        let path: PathBuf = folder.join(format!("{}.rs", robot.source.name));
        let planned = Planned::new(&path, &robot.source.text, Replaces::Module, &robot.files);
        planned.and_then(|file| file.write()).expect("a module");
        let written = fs::read_to_string(&path).expect("the module");
        assert!(written == robot.source.text);
    }
    assert_eq!(fs::read_dir(folder).expect("a folder").count(), robots.len());
}

#[test]
fn mutated_descriptions_generate_or_are_explained() {
    let asked = std::env::var("GELENK_MUTATIONS").ok();
    let count = asked.and_then(|count| count.parse().ok()).unwrap_or(MUTATIONS);
    // To look at a case again, or to go on behind it.
    let first = std::env::var("GELENK_FIRST_MUTATION").ok();
    let first: usize = first.and_then(|first| first.parse().ok()).unwrap_or(0);
    let folder = tempfile::tempdir().expect("a folder");
    let (to, from) = mpsc::channel();
    let place = folder.path().join("models");
    fs::create_dir_all(place.join("urdf")).expect("a folder");
    // What others extend.
    for file in SEEDS.iter().chain(&BASES) {
        fs::write(place.join(file), seed(file)).expect(file);
    }
    std::thread::spawn(move || work(first..first + count, &place, &to));
    let (mut generated, mut refused, mut slowest) = (0_usize, 0_usize, Duration::ZERO);
    let mut codes = BTreeMap::new();
    let mut modules = Crate::default();
    for next in first.. {
        let Ok(finished) = from.recv_timeout(PATIENCE) else {
            panic!("case {next} never ends: {:#?}", Case::new(next));
        };
        let Some(Finished { case, took, result }) = finished else {
            break;
        };
        if took > slowest {
            slowest = took;
            eprintln!("case {next}, {}: {took:?}", case.file);
        }
        assert!(took <= MOST_WORK, "case {next} takes {took:?}: {case:#?}");
        let result = result.unwrap_or_else(|panic| panic!("case {next} panics: {panic}\n{}", case.text));
        let robots = match result {
            Ok(robots) => robots,
            Err(message) => {
                let code = message.split(']').next().unwrap_or_default();
                assert!(message.contains("error["), "case {next}: {message}");
                *codes.entry(code.to_owned()).or_insert(0_usize) += 1;
                refused += 1;
                continue;
            }
        };
        robots.iter().for_each(|robot| check_numbers(robot, next));
        if generated.is_multiple_of(COMPILED) {
            write(&robots, &folder.path().join("modules"));
            robots.iter().for_each(|robot| modules.add(robot, case.index));
        }
        generated += 1;
        if modules.modules >= 10 {
            modules.compile(folder.path());
        }
    }
    modules.compile(folder.path());
    eprintln!("{generated} generated, {refused} refused, at most {slowest:?}: {codes:#?}");
    assert!(generated > count / 10 && refused > count / 10);
}
