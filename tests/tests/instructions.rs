//! Instructions per call of the emitted functions, counted by Valgrind: a regression shows without timing.
//!
//! Of those over lanes it is the count of eight states. The counts belong to rustc 1.95 and x86-64-v2, or v3
//! with fused operations; another compiler moves them a little. Review with `cargo insta review`.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_codegen::read::ReadOptions;
use gelenk_tests::workspace;

/// Functions of y alone, of y and ẏ, and of y, ẏ and a third array.
const FUNCTIONS: [(&str, &str); 7] = [
    ("mass_matrix", "y"),
    ("bias_forces", "y, v"),
    ("inverse_dynamics", "y, v, a"),
    ("forward_dynamics", "y, v, a"),
    ("inverse_dynamics_derivatives", "y, v, a"),
    ("forward_dynamics_derivatives", "y, v, a"),
    ("linearize", "y, v, a"),
];

/// Functions over a sample time: name of the row, function, period. What `discretize` takes grows with the
/// period times the fastest rate of the robot; over the longest period it takes the most.
const OVER_TIME: [(&str, &str, &str); 4] = [
    ("discretize", "discretize", "0.02"),
    ("discretize_at_most", "discretize", "longest[k % 8]"),
    ("step", "step", "0.02"),
    ("step_derivatives", "step_derivatives", "0.02"),
];

/// Functions over eight states, in the form for AVX2 (Valgrind knows no AVX-512), and their results.
const LANES: [(&str, &str); 3] = [
    ("inverse_dynamics", "&mut x"),
    ("forward_dynamics", "&mut x"),
    ("linearize", "&mut dy, &mut dv, &mut du, &mut x"),
];

/// Ten rounds over the states: the counts of all rounds are equal.
const CALLS: u64 = 80;

/// A program that calls one function `count` times; both are arguments.
fn main_text() -> String {
    let mut arms = String::new();
    let single = FUNCTIONS.map(|(name, arguments)| (name, "robot", name, arguments.to_owned()));
    let over_time =
        OVER_TIME.map(|(row, name, period)| (row, "discrete", name, format!("y, v, a, {period}")));
    for (row, module, name, arguments) in single.into_iter().chain(over_time) {
        let _ = writeln!(
            arms,
            "        {row:?} => for k in 0..calls {{ let [y, v, a] = &states[k % 8]; \
             let (y, v, a) = (black_box(y), black_box(v), black_box(a)); _ = (v, a); \
             black_box({module}::{name}({arguments})); }},"
        );
    }
    for (name, results) in LANES {
        let _ = writeln!(
            arms,
            "        \"{name}_lanes\" => for k in 0..calls {{ let [y, v, a] = black_box(&groups[k % 8]); \
             unsafe {{ many::{name}_lanes_avx2(y, v, a, {results}); }} black_box((&x, &dy, &dv, &du)); }},"
        );
    }
    format!(
        "mod robot {{ include!(\"robot.rs\"); }}
mod discrete {{ include!(\"discrete.rs\"); }}
mod many {{ include!(\"many.rs\"); }}
use std::hint::black_box;
/// The period that needs the most halvings.
fn longest([y, v, u]: &[[f64; robot::N]; 3]) -> f64 {{
    let norm = |matrix: &[[f64; robot::N]; robot::N]| matrix.map(|row| row.map(f64::abs).iter().sum()).into_iter().fold(0.0, f64::max);
    let (by_y, by_v, _, _) = discrete::linearize(y, v, u);
    let (a, b) = (norm(&by_y), norm(&by_v));
    let mut t = 1.0;
    while (a * t + b) * t > 1.0 {{ t *= 0.5; }}
    80.0 * f64::from(1 << 18) * t
}}
fn main() {{
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap();
    let calls: usize = arguments.next().unwrap().parse().unwrap();
    let states: [[[f64; robot::N]; 3]; 8] = core::array::from_fn(|s| core::array::from_fn(|k| core::array::from_fn(|i|
        ((s * 31 + k * 7 + i) as f64 * 0.7).rem_euclid(4.0) - 2.0)));
    let longest = states.each_ref().map(longest);
    let groups: [[[many::Lanes; robot::N]; 3]; 8] = core::array::from_fn(|s| core::array::from_fn(|k| core::array::from_fn(|i|
        many::Lanes(core::array::from_fn(|lane| states[(s + lane) % 8][k][i])))));
    let zero = many::Lanes([0.0; 8]);
    let mut x = [zero; robot::N];
    let (mut dy, mut dv, mut du) = ([[zero; robot::N]; robot::N], [[zero; robot::N]; robot::N], [[zero; robot::N]; robot::N]);
    match name.as_str() {{
{arms}        _ => panic!(),
    }}
}}
"
    )
}

/// The file of Valgrind, which is started without the variable that says where programs are.
fn valgrind() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join("valgrind")).find(|file| file.is_file())
}

/// The instructions that Valgrind counts in one run.
fn count(program: &Path, function: &str, calls: u64) -> u64 {
    // Environment and path lie on the stack below the program's arrays. How long they are decides how the arrays are
    // aligned, and so a count or two.
    let output = Command::new(valgrind().expect("looked for before"))
        .env_clear()
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .current_dir(program.parent().expect("it lies in a folder"))
        .arg(Path::new("./").join(program.file_name().expect("it is a file")))
        .args([function, &calls.to_string()])
        .output()
        .expect("valgrind runs");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{function}: {text}");
    let collected = text.lines().find_map(|line| line.split_once("Collected : "));
    let (_, number) = collected.unwrap_or_else(|| panic!("{text}"));
    number.trim().parse().expect("a count")
}

/// The text of a robot's module with these functions.
fn module(robot: &str, fused: bool, functions: &[&str], lanes: bool) -> String {
    let functions: Vec<String> = functions.iter().map(|&name| name.to_owned()).collect();
    let mut options = GenerateOptions {
        reading: ReadOptions { no_friction: true, ..ReadOptions::default() },
        fused_multiply_add: fused,
        functions,
        ..GenerateOptions::default()
    };
    if lanes {
        options.lanes = options.functions.clone();
    }
    let description = workspace().join("models").join(format!("{robot}.toml"));
    let generated = generate(&description, &options).unwrap_or_else(|problems| panic!("{problems}"));
    generated.source.text
}

fn report(robot: &str, fused: bool) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let (main, program) = (folder.path().join("main.rs"), folder.path().join("main"));
    // Modules of their own: who else calls a function decides where it is inlined.
    let modules = [
        ("robot.rs", FUNCTIONS.map(|(name, _)| name).to_vec(), false),
        ("discrete.rs", OVER_TIME.map(|(_, name, _)| name).to_vec(), false),
        ("many.rs", LANES.map(|(name, _)| name).to_vec(), true),
    ];
    for (file, functions, lanes) in modules {
        let text = module(robot, fused, &functions, lanes);
        std::fs::write(folder.path().join(file), text).expect("a file");
    }
    std::fs::write(&main, main_text()).expect("a file");
    // Fused operations need v3. Without them v2: Valgrind 3.19 does not know `vmovq` between two registers.
    let target = match fused {
        true => "-Ctarget-cpu=x86-64-v3",
        false => "-Ctarget-cpu=x86-64-v2",
    };
    let output = Command::new("rustc")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .args(["--edition", "2024", "-Copt-level=3", "-Ccodegen-units=1", target, "-Awarnings", "-o"])
        .args([&program, &main])
        .output()
        .expect("rustc runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let form = if fused { "fused" } else { "plain" };
    let singles = FUNCTIONS.iter().map(|(name, _)| (*name).to_owned());
    let over_time = OVER_TIME.iter().map(|(row, ..)| (*row).to_owned());
    let names = singles.chain(over_time).chain(LANES.iter().map(|(name, _)| format!("{name}_lanes")));
    let lines = names.map(|name| {
        let calls = count(&program, &name, CALLS) - count(&program, &name, 0);
        format!("{robot} {form} {name}: {}\n", (calls + CALLS / 2) / CALLS)
    });
    lines.collect()
}

#[test]
fn instructions_per_call() {
    if valgrind().is_none() || !cfg!(target_arch = "x86_64") {
        println!("skipped: no valgrind, or no x86-64");
        return;
    }
    let reports = [("ur5", false), ("ur5", true), ("panda", false), ("panda", true)];
    // Two at a time: instructions are counted, not seconds.
    let text: String = reports
        .chunks(2)
        .flat_map(|pair| {
            std::thread::scope(|scope| {
                let both: Vec<_> =
                    pair.iter().map(|&(robot, fused)| scope.spawn(move || report(robot, fused))).collect();
                both.into_iter().map(|one| one.join().expect("a report")).collect::<Vec<String>>()
            })
        })
        .collect();
    insta::assert_snapshot!(text);
}
