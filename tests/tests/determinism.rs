//! Same description, same bytes: across runs, threads, the order of work, working directories, processes, and
//! C libraries whose functions round differently.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use gelenk_codegen::emit::Scalar;
use gelenk_tests::{descriptions, generate_whole_model, workspace};

/// Where a child process of this test writes its modules.
const OUTPUT: &str = "GELENK_TEST_OUTPUT";

/// Names and texts of all modules, in the given order.
fn modules(descriptions: &[PathBuf]) -> Vec<(String, String)> {
    descriptions
        .iter()
        .map(|path| {
            let source = generate_whole_model(path, Scalar::F64).source;
            (source.name, source.text)
        })
        .collect()
}

fn sorted(mut modules: Vec<(String, String)>) -> Vec<(String, String)> {
    modules.sort();
    modules
}

#[test]
fn order_of_work_and_threads_change_nothing() {
    let robots: Vec<_> = expected().iter().filter(|(name, _)| name != "curved").cloned().collect();
    assert!(robots.len() >= 9, "{} robots", robots.len());
    let paths = descriptions();
    let backwards = paths.iter().rev().cloned().collect();
    let threads =
        [paths, backwards].map(|paths: Vec<PathBuf>| std::thread::spawn(move || sorted(modules(&paths))));
    for thread in threads {
        assert_same(&thread.join().expect("no panic"), &robots);
    }
}

/// The difference of two large texts says little; their names do.
fn assert_same(found: &[(String, String)], expected: &[(String, String)]) {
    assert_eq!(found.len(), expected.len());
    for ((name, text), (expected_name, expected)) in found.iter().zip(expected) {
        assert_eq!(name, expected_name);
        assert!(text == expected, "{name} differs");
    }
}

/// No test by itself: what the children of others run.
#[test]
fn child() {
    let Some(folder) = std::env::var_os(OUTPUT) else {
        return;
    };
    for (name, text) in all_modules() {
        std::fs::write(Path::new(&folder).join(name), text).expect("a file");
    }
    for function in FUNCTIONS {
        println!("{VALUE}{:?}", function(std::hint::black_box(0.7)).to_bits());
    }
}

/// Functions of the C library, and what their values are printed after.
const FUNCTIONS: [fn(f64) -> f64; 5] = [f64::sin, f64::cos, f64::exp, f64::tanh, f64::atan];
const VALUE: &str = "value: ";

/// Where the dynamic linker looks for functions first.
const PRELOAD: &str = "LD_PRELOAD";

/// A robot whose constants come from every function that a description may reach: angles as rpy and
/// Denavit–Hartenberg rows, quaternions, held joints, leaves whose frames are turned, formulas of numbers.
const CURVED: &str = r#"
name = "curved"
[[joints]]
name = "first"
origin = { xyz = [0.1, "cos(0.3)", "exp(-1.1)"], rpy = [0.31, -0.7, 1.1] }
axis = [0, "sin(0.4)", "cos(0.4)"]
[[joints]]
name = "held"
parent = "first"
held = 0.83
origin = { xyz = [0.2, 0, "tanh(0.9)"] }
axis = [0, 1, 0]
[[joints]]
name = "third"
parent = "held"
dh = { a = 0.3, alpha = 0.77, d = 0.1, theta = 0.2 }
friction = "0.1*exp(0.3)*tanh(20*v)"
[[joints]]
name = "slide"
parent = "third"
type = "prismatic"
origin = { xyz = [0.05, 0.2, 0], rpy = [1.3, 0.4, 0.2] }
axis = [0.6, 0.8, 0]
[[joints]]
name = "last"
parent = "slide"
origin = { xyz = [0.05, 0.2, 0], quaternion = { w = 0.8, x = 0.6 } }
axis = [0, 0.6, 0.8]
[[bodies]]
link = "first"
mass = 2
center_of_mass = [0.1, 0.2, 0.05]
inertia = [0.02, 0.03, 0.025]
[[bodies]]
link = "third"
mass = 1.5
center_of_mass = [0.1, -0.2, 0.15]
inertia = [0.02, 0.03, 0.025]
[[bodies]]
link = "last"
mass = "sin(0.9)"
center_of_mass = [0.11, 0.07, 0.02]
inertia = { xx = 0.01, yy = 0.02, zz = 0.015, xy = 0.003 }
[[frames]]
name = "tool"
link = "last"
origin = { xyz = [0.1, 0, 0.2], rpy = [0.2, 0.5, -0.3] }
"#;

/// Modules that this process generates, once for all tests that compare with them.
fn expected() -> &'static [(String, String)] {
    static MODULES: OnceLock<Vec<(String, String)>> = OnceLock::new();
    MODULES.get_or_init(all_modules)
}

/// The modules of all robots and of [`CURVED`].
fn all_modules() -> Vec<(String, String)> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("curved.toml");
    std::fs::write(&path, CURVED).expect("a file");
    let mut paths = descriptions();
    paths.push(path);
    sorted(modules(&paths))
}

/// A library of which each function differs from the C library's in the last bit of its results.
const OTHER_LIBRARY: &str = r#"
use std::ffi::{c_char, c_void};
unsafe extern "C" { fn dlsym(handle: *mut c_void, name: *const c_char) -> *mut c_void; }
fn other(x: f64) -> f64 { if x == 0.0 || !x.is_finite() { x } else { f64::from_bits(x.to_bits() ^ 1) } }
macro_rules! one { ($($name:ident)*) => { $(
    #[unsafe(no_mangle)]
    pub extern "C" fn $name(x: f64) -> f64 {
        let name = concat!(stringify!($name), "\0").as_ptr().cast();
        // SAFETY: RTLD_NEXT, −1, finds the function that this one stands before.
        let next: extern "C" fn(f64) -> f64 = unsafe { std::mem::transmute(dlsym(-1_isize as *mut c_void, name)) };
        other(next(x))
    }
)* } }
macro_rules! two { ($($name:ident)*) => { $(
    #[unsafe(no_mangle)]
    pub extern "C" fn $name(x: f64, y: f64) -> f64 {
        let name = concat!(stringify!($name), "\0").as_ptr().cast();
        // SAFETY: as above.
        let next: extern "C" fn(f64, f64) -> f64 = unsafe { std::mem::transmute(dlsym(-1_isize as *mut c_void, name)) };
        other(next(x, y))
    }
)* } }
one! { sin cos tan asin acos atan sinh cosh tanh exp exp2 expm1 log log2 log10 log1p cbrt }
two! { atan2 hypot pow }
/// # Safety
/// The places can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sincos(x: f64, s: *mut f64, c: *mut f64) { unsafe { *s = sin(x); *c = cos(x); } }
"#;

/// Runs this program again in another working directory and environment, perhaps with a library before the C
/// library: the modules that [`child`] writes, and what it prints.
fn in_a_process(current: &Path, home: &str, library: Option<&Path>) -> (Vec<(String, String)>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let program = std::env::current_exe().expect("this program");
    let mut command = Command::new(program);
    command.envs(library.map(|library| (PRELOAD, library)));
    let output = command
        .args(["--exact", "determinism::child", "--nocapture"])
        .env(OUTPUT, folder.path())
        .env("HOME", home)
        .env("LANG", "de_DE.UTF-8")
        .env("TZ", "Asia/Kolkata")
        .current_dir(current)
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let entries = std::fs::read_dir(folder.path()).expect("the folder");
    let read = |path: PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        (name, std::fs::read_to_string(&path).expect("a text"))
    };
    let modules = sorted(entries.map(|entry| read(entry.expect("an entry").path())).collect());
    (modules, String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn processes_and_working_directories_change_nothing() {
    let elsewhere = tempfile::tempdir().expect("a folder");
    let (modules, _) = in_a_process(elsewhere.path(), "/nowhere", None);
    assert_same(&modules, expected());
}

/// std's functions are those of the C library, which differ between platforms: no constant of the text may
/// come from them.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn another_c_library_changes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let flags = ["--crate-type", "cdylib", "-Copt-level=1"];
    gelenk_tests::compiler::rustc(folder.path(), "other", OTHER_LIBRARY, &flags)
        .unwrap_or_else(|message| panic!("{message}"));
    let library = folder.path().join("libother.so");
    let (modules, printed) = in_a_process(&workspace().join("models"), "/", Some(&library));
    let values = printed.lines().filter_map(|line| line.split_once(VALUE));
    let values: Vec<u64> = values.map(|(_, bits)| bits.parse().expect("bits")).collect();
    let changed = FUNCTIONS.map(|function| function(0.7).to_bits() ^ 1);
    assert_eq!(values, changed, "the library stands before the C library");
    assert_same(&modules, expected());
}
