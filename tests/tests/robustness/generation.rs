//! From a mutated description to a module, exports and a page: no panic, no hang, a module that compiles or a message. Half of
//! the descriptions are of random robots.
//!
//! `GELENK_MUTATIONS=50000 cargo test --release -p gelenk-tests --test all robustness::generation -- --nocapture`
//! is the long form; it takes an hour or two.

use super::mutation::{Random, rewritten};
use gelenk_codegen::diagnostic::Diagnostics;
use gelenk_codegen::emit::{self, EmitOptions, Language, Scalar};
use gelenk_codegen::export::{self, export};
use gelenk_codegen::function_names;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::selection::{self, Request};
use gelenk_codegen::model::Model;
use gelenk_codegen::output::{Planned, Replaces};
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate, generate_pair};
use gelenk_codegen::program::{Operand, Operation};
use gelenk_codegen::read::ReadOptions;
use gelenk_codegen::report::{Contents, report};
use gelenk_tests::quaternion_model::with_quaternions;
use gelenk_tests::random_model::{
    random_coupled_model, random_helical_model, random_model, random_model_with_frame_forces,
};
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
/// One of this number of generated modules is compiled.
const COMPILED: usize = 100;
/// One of this number of generated robots is exported, and one of this number of those has a page.
const EXPORTED: usize = 4;
const DRAWN: usize = 10;
/// Operations of the functions of a page.
const MOST_OPERATIONS: usize = 10_000;
/// Work of the processor on one description. It is fractions of a second in a release build, and more in a
/// debug build.
const MOST_WORK: Duration = Duration::from_secs(if cfg!(debug_assertions) { 60 } else { 10 });
/// Time until a description counts as one that never ends: a busy machine may take much longer than the work.
const PATIENCE: Duration = Duration::from_secs(300);

/// The first of them are small: the short form takes few others.
const SMALL: usize = 8;

/// Descriptions that are mutated.
const SEEDS: [&str; 24] = [
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
    "differential_wrist.toml",
    "excavator.toml",
    "gripper.toml",
    "palletizer.toml",
    "quadrotor.toml",
    "rail_arm.toml",
    "satellite.toml",
    "../tests/mujoco/robots/arm.xml",
    "../tests/mujoco/robots/cart.xml",
    "../tests/mujoco/robots/walker.xml",
];

/// Files that some of them extend or include.
const BASES: [&str; 3] = [
    "powercube_alpha.toml",
    "../tests/mujoco/robots/parts/defaults.xml",
    "../tests/mujoco/robots/parts/tail.xml",
];

/// Random robots, with up to this number of coordinates before some become free.
const LONGEST: usize = 3;
const ROBOTS: [fn(u64) -> Model; 5] = [
    |seed| random_model(seed, LONGEST),
    |seed| random_coupled_model(seed, LONGEST),
    |seed| random_helical_model(seed, LONGEST),
    |seed| random_model_with_frame_forces(seed, LONGEST),
    |seed| with_quaternions(random_model_with_frame_forces(seed, LONGEST), seed),
];

/// A description and what is asked of it.
#[derive(Debug, Clone)]
struct Case {
    index: usize,
    file: String,
    text: String,
    options: GenerateOptions,
    control_model: Option<f64>,
}

impl Case {
    /// The same for the same index, whatever the others are.
    fn new(index: usize) -> Self {
        let mut random = Random(0x6d75_7461_7465 ^ (index as u64) << 20);
        let (file, text) = if random.chance(2) {
            random_robot(&mut random)
        } else {
            let is_short = index < MUTATIONS && !random.chance(25);
            let file = *random.one(if is_short { &SEEDS[..SMALL] } else { &SEEDS });
            (file.to_owned(), seed(file))
        };
        Self {
            index,
            file,
            text: rewritten(&text, &mut random),
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

/// A random robot as another program would describe it.
fn random_robot(random: &mut Random) -> (String, String) {
    let model = random.one(&ROBOTS)(random.next() % 10_000);
    let format = *random.one(&[export::Format::Mjcf, export::Format::Urdf]);
    (format!("random.{}", format.extension()), export(&model, format, "random").text)
}

/// Mostly a few functions; all of them take longer.
fn options(random: &mut Random) -> GenerateOptions {
    // Second derivatives of the larger robots take half a minute.
    let is_second = |name: &&str| name.ends_with("_hessian");
    let with_second = random.chance(20);
    let names: Vec<&str> = function_names::listed().filter(|name| with_second || !is_second(name)).collect();
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
        reading: ReadOptions {
            snap_angles: random.chance(5).then_some(1e-4),
            no_friction: random.chance(5),
            ignore_mimic: random.chance(2),
            smooth_sign: random.chance(5).then_some(20.0),
            ..ReadOptions::default()
        },
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

/// Outcome of a case.
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

/// Exports and pages of some robots.
fn export_and_draw(found: &Result<Vec<Generated>, String>, index: usize) {
    let Some(Generated { model, .. }) = found.iter().flatten().next() else { return };
    if !index.is_multiple_of(EXPORTED) || !model.driven.is_empty() {
        return;
    }
    for format in [export::Format::Mjcf, export::Format::Urdf] {
        assert!(!export(model, format, "robot").text.is_empty());
    }
    let request = Request { names: &[], most: MOST_OPERATIONS, form: Form::Cheapest, straight: &[] };
    if !index.is_multiple_of(EXPORTED * DRAWN) {
        return;
    }
    if let Ok(selected) = selection::derive(model, &request) {
        let contents = Contents {
            model,
            functions: &selected.functions,
            notes: &Diagnostics::new(selected.notes.clone()),
            closed_form: Err("none"),
            command: "gelenk report",
        };
        // A figure that cannot be drawn is an error with its reason.
        let _ = report(&contents);
    }
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
        let path = folder.join(format!("case_{index}.{}", extension(&case.file)));
        fs::write(&path, &case.text).expect("a description");
        let start = work_of_thread();
        let result = catch_unwind(AssertUnwindSafe(|| {
            let found = case.run(&path);
            found.iter().flatten().for_each(check_numbers);
            print_in_c(&found);
            export_and_draw(&found, index);
            found
        }));
        let took = work_of_thread().saturating_sub(start);
        let result = result.map_err(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            text.unwrap_or_else(|| "a panic".to_owned())
        });
        fs::remove_file(&path).expect("the description");
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
fn check_numbers(robot: &Generated) {
    for function in &robot.module.functions {
        let entries = function.program.outputs.iter().flat_map(|output| &output.entries);
        let instructions = function.program.instructions.iter();
        let operands = instructions.flat_map(|made| operands(made.operation));
        for operand in entries.copied().chain(operands) {
            let is_number = !matches!(operand, Operand::Constant(x) if !x.is_finite());
            assert!(is_number, "{operand:?} in {}", function.name);
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

/// Outcomes of all cases.
#[derive(Default)]
struct Tally {
    generated: usize,
    refused: usize,
    slowest: Duration,
    codes: BTreeMap<String, usize>,
    faults: Vec<String>,
    modules: Crate,
}

impl Tally {
    fn add(&mut self, Finished { case, took, result }: Finished, folder: &Path) {
        if took > self.slowest {
            self.slowest = took;
            eprintln!("case {}, {}: {took:?}", case.index, case.file);
        }
        if took > MOST_WORK {
            self.fault(&case, &format!("takes {took:?}"));
        }
        match result {
            Err(panic) => self.fault(&case, &format!("panics: {panic}")),
            Ok(Err(message)) if !message.contains("error[") => self.fault(&case, &message),
            Ok(Err(message)) => {
                let code = message.split(']').next().unwrap_or_default();
                *self.codes.entry(code.to_owned()).or_default() += 1;
                self.refused += 1;
            }
            Ok(Ok(robots)) => self.compile_some(&robots, case.index, folder),
        }
    }

    fn fault(&mut self, case: &Case, what: &str) {
        let fault = format!("case {}, {}: {what}", case.index, case.file);
        eprintln!("{fault}\n{}", case.text);
        self.faults.push(fault);
    }

    fn compile_some(&mut self, robots: &[Generated], index: usize, folder: &Path) {
        if self.generated.is_multiple_of(COMPILED) {
            write(robots, &folder.join("modules"));
            robots.iter().for_each(|robot| self.modules.add(robot, index));
        }
        self.generated += 1;
        if self.modules.modules >= 10 {
            self.modules.compile(folder);
        }
    }
}

/// A number in an environment variable.
fn asked(name: &str, otherwise: usize) -> usize {
    std::env::var(name).ok().and_then(|number| number.parse().ok()).unwrap_or(otherwise)
}

#[test]
fn mutated_descriptions_generate_or_are_explained() {
    let count = asked("GELENK_MUTATIONS", MUTATIONS);
    // To look at a case again, or to go on behind it.
    let first = asked("GELENK_FIRST_MUTATION", 0);
    let folder = tempfile::tempdir().expect("a folder");
    let (to, from) = mpsc::channel();
    let place = folder.path().join("models");
    for part in ["urdf", "parts"] {
        fs::create_dir_all(place.join(part)).expect("a folder");
    }
    // What others extend.
    for file in SEEDS.iter().chain(&BASES) {
        fs::write(place.join(file.rsplit("robots/").next().unwrap_or(file)), seed(file)).expect(file);
    }
    std::thread::spawn(move || work(first..first + count, &place, &to));
    let mut tally = Tally::default();
    for next in first.. {
        let Ok(finished) = from.recv_timeout(PATIENCE) else {
            panic!("case {next} never ends: {:#?}", Case::new(next));
        };
        let Some(finished) = finished else { break };
        tally.add(finished, folder.path());
    }
    tally.modules.compile(folder.path());
    let Tally { generated, refused, slowest, codes, faults, .. } = tally;
    eprintln!("{generated} generated, {refused} refused, at most {slowest:?}: {codes:#?}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(generated > count / 10 && refused > count / 10);
}
