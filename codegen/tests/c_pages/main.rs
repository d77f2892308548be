//! The page about C: its code compiles, and its numbers are those of the compiler.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

const PAGE: &str = include_str!("../../docs/c.md");

/// The block of C on the page that has these words.
fn block(words: &str) -> &'static str {
    let blocks = PAGE.split("```c\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    blocks.into_iter().find(|block| block.contains(words)).unwrap()
}

/// A folder with the module of a robot and the declarations of Simulink and FreeRTOS.
fn module(robot: &str, functions: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let texts = [
        ("simstruc.h", include_str!("simstruc.h")),
        ("FreeRTOS.h", include_str!("FreeRTOS.h")),
        ("task.h", include_str!("task.h")),
        ("call.c", include_str!("call.c")),
        ("cg_sfun.h", ""),
    ];
    for (name, text) in texts {
        fs::write(folder.path().join(name), text).unwrap();
    }
    generate(robot, functions, folder.path());
    folder
}

fn generate(robot: &str, functions: &str, folder: &Path) {
    let description = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../models/{robot}.toml"));
    generate_from(&description, functions, folder);
}

fn generate_from(description: &Path, functions: &str, folder: &Path) {
    let output = Command::new(env!("CARGO_BIN_EXE_gelenk"))
        .args(["generate", "--language", "c", "--functions", functions, "--output", "."])
        .arg(description)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Messages of a compiler; none, with a note, where it is missing.
fn compile(folder: &Path, line: &str) -> Option<String> {
    let mut words = line.split(' ');
    let name = words.next().unwrap();
    let Ok(output) = Command::new(name).args(words).current_dir(folder).output() else {
        println!("skipped: no {name}");
        return None;
    };
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.success(), said.is_empty(), "{said}");
    Some(said)
}

#[test]
fn the_block_for_simulink_computes_what_the_module_computes() {
    let folder = module("ur5", "inverse_dynamics");
    fs::write(folder.path().join("ur5_forces.c"), block("S_FUNCTION_NAME")).unwrap();
    let line = "cc -std=c99 -Wall -Wextra -Werror -pedantic -O2 call.c ur5.c -o call";
    let Some(said) = compile(folder.path(), line) else { return };
    assert_eq!(said, "");
    assert!(Command::new(folder.path().join("call")).status().unwrap().success());
}

/// The lines that the first program of the page prints for a robot: names, efforts and their units.
fn printed(folder: &Path, robot: &str, program: &str) -> Option<Vec<(String, f64, String)>> {
    fs::write(folder.join("main.c"), program).unwrap();
    let line = format!("cc -std=c99 -Wall -Wextra -Werror -pedantic -O2 main.c {robot}.c -o hold");
    assert_eq!(compile(folder, &line)?, "");
    let output = Command::new(folder.join("hold")).output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let line = |line: &str| {
        let (name, rest) = line.split_once(": ").unwrap();
        let (effort, unit) = rest.split_once(' ').unwrap();
        (name.to_owned(), effort.parse().unwrap(), unit.to_owned())
    };
    Some(text.lines().map(line).collect())
}

#[test]
fn the_first_program_prints_the_numbers_of_the_page() {
    let folder = module("ur5", "inverse_dynamics");
    let program = block("int main(void)");
    assert_eq!(PAGE.split("```c\n").nth(1).unwrap().split("```").next(), Some(program));
    let Some(printed) = printed(folder.path(), "ur5", program) else { return };
    let prose = PAGE.split_whitespace().collect::<Vec<_>>().join(" ").replace('−', "-");
    let told = prose.split_once(" N m for the second and the third joint").unwrap().0;
    let (told, third) = told.rsplit_once(" and ").unwrap();
    let second = told.rsplit_once(' ').unwrap().1;
    assert_eq!(printed.len(), 6);
    assert!(printed.iter().all(|(.., unit)| unit == "N m"), "{printed:?}");
    for ((name, effort, _), told) in printed[1..].iter().zip([second, third]) {
        assert_eq!(format!("{effort:.3}"), told, "{name}");
    }
}

/// Two links whose motors take currents. Horizontal links are held by −(1 · 0.2 + 2 · 0.4) g and −2 · 0.1 g.
const CURRENTS: &str = r#"
name = "currents"
joints = [
    { name = "shoulder", axis = [0, 1, 0], drive = { gear_ratio = 80, rotor_inertia = 6e-5, motor_constant = 0.05 } },
    { name = "elbow", axis = [0, 1, 0], origin = { xyz = [0, 0, 0.3] }, drive = { gear_ratio = 50, motor_constant = 0.03 } },
]
bodies = [
    { link = "shoulder", mass = 1, center_of_mass = [0, 0, 0.2], inertia = 0.01 },
    { link = "elbow", mass = 2, center_of_mass = [0, 0, 0.1], inertia = 0.01 },
]
"#;

#[test]
fn the_first_program_prints_torques_of_a_robot_whose_inputs_are_currents() {
    let folder = tempfile::tempdir().unwrap();
    let description = folder.path().join("currents.toml");
    fs::write(&description, CURRENTS).unwrap();
    generate_from(&description, "inverse_dynamics", folder.path());
    let header = fs::read_to_string(folder.path().join("currents.h")).unwrap();
    let source = fs::read_to_string(folder.path().join("currents.c")).unwrap();
    let mut units = header.lines().chain(source.lines()).filter(|line| line.contains("CURRENTS_INPUT_UNITS"));
    assert!(units.any(|line| line.contains("{\"A\", \"A\"}")), "{header}{source}");
    let y = "{0.0, -1.57, 1.57, 0.0, 0.5, 0.0}";
    let program = block("int main(void)");
    assert!(program.contains(y), "{program}");
    let program =
        program.replace(y, "{1.5707963267948966, 0.0}").replace("ur5", "currents").replace("UR5", "CURRENTS");
    let Some(printed) = printed(folder.path(), "currents", &program) else { return };
    let expected = [("shoulder", -9.81), ("elbow", -1.962)];
    let expected = expected.map(|(name, effort)| (name.to_owned(), effort, "N m".to_owned()));
    assert_eq!(printed, expected);
}

const MATH: &str = "double fabs(double); double sqrt(double);\n\
    #define INFINITY __builtin_inff()\n#define NAN __builtin_nanf(\"\")\n";

const STRING: &str =
    "#include <stddef.h>\nvoid *memcpy(void *, const void *, size_t);\nvoid *memset(void *, int, size_t);\n";

#[test]
fn the_task_for_freertos_compiles() {
    let folder = module("ur5", "inverse_dynamics");
    fs::write(folder.path().join("task.c"), block("FreeRTOS.h")).unwrap();
    let zynq =
        "arm-none-eabi-gcc -mcpu=cortex-a9 -mfpu=vfpv3 -mfloat-abi=hard -fno-math-errno -idirafter libc";
    // Where the compiler comes without a library, which has them otherwise.
    let libc = folder.path().join("libc");
    fs::create_dir(&libc).unwrap();
    fs::write(libc.join("math.h"), MATH).unwrap();
    fs::write(libc.join("string.h"), STRING).unwrap();
    for compiler in ["cc", zynq] {
        let line = format!("{compiler} -std=c99 -Wall -Wextra -Werror -O2 -c task.c ur5.c");
        assert_eq!(compile(folder.path(), &line).unwrap_or_default(), "");
    }
}

/// The hash in the module of the robot `currents`.
fn hashed(folder: &Path, description: &str, options: &[&str]) -> u64 {
    fs::write(folder.join("currents.toml"), description).unwrap();
    let mut gelenk = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    gelenk.args(["generate", "currents.toml", "--output", "."]).args(options).current_dir(folder);
    assert!(gelenk.status().unwrap().success());
    let file = folder.join(if options.contains(&"c") { "currents.h" } else { "currents.rs" });
    let text = fs::read_to_string(file).unwrap();
    let line = text.lines().find(|line| line.contains("HASH")).unwrap();
    let digits = line.split_once("0x").unwrap().1.replace('_', "");
    u64::from_str_radix(digits.trim_end_matches(['U', 'L', ';']), 16).unwrap()
}

#[test]
fn a_hash_tells_robots_apart() {
    let folder = tempfile::tempdir().unwrap();
    let in_c = |description: &str, functions: &str| {
        let options = ["--language", "c", "--functions", functions];
        hashed(folder.path(), description, &options)
    };
    let one = in_c(CURRENTS, "inverse_dynamics");
    assert_eq!(in_c(CURRENTS, "mass_matrix"), one);
    assert_eq!(in_c(&format!("# A comment.\n{CURRENTS}"), "mass_matrix"), one);
    assert_eq!(hashed(folder.path(), CURRENTS, &[]), one);
    assert_ne!(hashed(folder.path(), CURRENTS, &["--smooth-sign", "50"]), one);
    let source = fs::read(folder.path().join("currents.c")).unwrap();
    assert_ne!(in_c(&CURRENTS.replace("mass = 2", "mass = 2.0000001"), "mass_matrix"), one);
    fs::write(folder.path().join("currents.c"), source).unwrap();
    let Some(said) = compile(folder.path(), "cc -std=c99 -c currents.c") else { return };
    assert!(said.contains("currents.h and currents.c were not generated together"), "{said}");
}

/// The bytes of stack of each function with all that it calls, from gcc's graph of calls.
fn stack(graph: &str) -> BTreeMap<String, usize> {
    let part = |line: &str, name: &str| {
        let rest = line.split_once(&format!("{name}: \""))?.1;
        Some(rest.split('"').next()?.to_owned())
    };
    let nodes = graph.lines().filter(|line| line.starts_with("node:"));
    let own: BTreeMap<String, usize> = nodes
        .filter_map(|line| {
            let label = part(line, "label")?;
            let bytes = label.split("\\n").find_map(|each| each.split_once(" bytes")?.0.parse().ok());
            Some((part(line, "title")?, bytes.unwrap_or(0)))
        })
        .collect();
    let edges = graph.lines().filter(|line| line.starts_with("edge:"));
    let edges: Vec<(String, String)> =
        edges.filter_map(|line| Some((part(line, "sourcename")?, part(line, "targetname")?))).collect();
    let mut all = own.clone();
    // Calls go no deeper than there are functions.
    for _ in 0..own.len() {
        for (from, to) in &edges {
            let through = own.get(from).unwrap_or(&0) + all.get(to).unwrap_or(&0);
            all.entry(from.clone()).and_modify(|bytes| *bytes = through.max(*bytes));
        }
    }
    all
}

/// The estimate of the stack of each function in a header: whether it is a bound, and kB.
fn estimates(header: &str) -> BTreeMap<String, (bool, f64)> {
    let paragraphs = header.split("\n\n").filter(|paragraph| paragraph.contains("Stack:"));
    let estimate = |paragraph: &str| {
        let lines = paragraph.lines();
        let (comment, code): (Vec<&str>, Vec<&str>) = lines.partition(|line| line.starts_with("///"));
        let comment: Vec<&str> = comment.iter().flat_map(|line| line[3..].split_whitespace()).collect();
        let at = comment.iter().position(|word| *word == "Stack:").unwrap();
        let name = code[0].split_once('(').unwrap().0.rsplit(' ').next().unwrap();
        (name.to_owned(), (comment[at + 1] == "below", comment[at + 2].parse().unwrap()))
    };
    paragraphs.map(estimate).collect()
}

#[test]
fn the_stack_of_calls_is_near_that_of_the_header() {
    let version = Command::new("gcc").arg("-dumpfullversion").output();
    if !version.is_ok_and(|output| output.stdout.starts_with(b"12.")) || cfg!(not(target_arch = "x86_64")) {
        println!("skipped: the factor of the page is that of gcc 12 on x86-64");
        return;
    }
    let functions = "mass_matrix,inverse_dynamics,forward_dynamics,forward_dynamics_derivatives,linearize,step,\
        step_derivatives,discretize,inertial_regressor";
    let mut compared = 0;
    for robot in ["ur5", "panda", "go2", "satellite", "excavator"] {
        let folder = module(robot, functions);
        let line = format!("gcc -std=c99 -O2 -fno-math-errno -fcallgraph-info=su -c {robot}.c");
        assert_eq!(compile(folder.path(), &line).unwrap(), "");
        let found = stack(&fs::read_to_string(folder.path().join(format!("{robot}.ci"))).unwrap());
        let header = fs::read_to_string(folder.path().join(format!("{robot}.h"))).unwrap();
        for (function, (is_bound, estimate)) in estimates(&header) {
            let kilobytes = found[&function] as f64 / 1000.0;
            let is_near = (0.5..=2.0).contains(&(kilobytes / estimate));
            assert!(
                if is_bound { kilobytes < estimate } else { is_near },
                "{function}: {kilobytes}, {estimate}"
            );
            compared += usize::from(!is_bound);
        }
    }
    assert!(compared > 25, "{compared}");
}
