//! The table of kinds of robots: every function and product with a robot of each kind, and the page that lists the table.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::diagnostic::Diagnostics;
use gelenk_codegen::emit::{Companion, EmitOptions, Language};
use gelenk_codegen::function_names::FrameKind;
use gelenk_codegen::functions::catalogue::{
    ACADOS, CASADI, Difference, EXPORT, KINDS, Kind, LOOPS, PRODUCTS, Product, names,
};
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::model::Model;
use gelenk_codegen::pipeline::{GenerateOptions, Generated, generate};
use gelenk_codegen::read::{ReadOptions, read};

const DRIVE: &str = "drive = { gear_ratio = 50, rotor_inertia = 1e-4 }";

const SWING: &str = r#"
name = "arm"
[[joints]]
name = "swing"
axis = [0, 1, 0]
"#;

const REST: &str = r#"
[[bodies]]
link = "swing"
mass = 2
center_of_mass = [0.1, 0, -0.5]
inertia = 0.1
[[bodies]]
link = "lift"
mass = 1
center_of_mass = [0.2, 0.1, 0.1]
inertia = 0.02
[[frames]]
name = "tool"
link = "lift"
origin = { xyz = [0.1, 0, 0.3] }
"#;

/// A robot of one kind: an arm with one more property.
fn sample(kind: &Kind) -> String {
    let arm = |swing: &str, lift: &str, rest: &str| {
        format!(
            "{SWING}{swing}\n[[joints]]\nname = \"lift\"\ntype = \"prismatic\"\naxis = [1, 0, 0]\n{lift}\n{REST}{rest}"
        )
    };
    let with = |rest: &str| arm(DRIVE, DRIVE, rest);
    match kind.robots {
        "a singular mass matrix" => {
            with("[[joints]]\nname = \"idle\"\naxis = [0, 1, 0]\ndrive = \"ideal\"\n")
        }
        "friction that depends on the position" => {
            arm(DRIVE, &format!("{DRIVE}\nfriction = {{ terms = [[\"v*(2 + cos(y))\", 0.1]] }}"), "")
        }
        "driven joints" => arm("motion = \"driven\"", DRIVE, ""),
        "forces between frames" => {
            with("[[forces]]\nname = \"spring\"\nbetween = [\"base\", \"tool\"]\nlaw = \"100*(l - 0.1)\"\n")
        }
        "inputs at frames" => {
            with("[[inputs]]\nname = \"fan\"\nframe = \"tool\"\nwrench = [1, 0, 2, 0, 0.1, 0]\n")
        }
        "load-dependent friction" => {
            arm(&format!("{DRIVE}\nfriction = {{ load = \"0.1*tanh(20*v)\" }}"), DRIVE, "")
        }
        "wrenches as arguments" => with("[[wrenches]]\nname = \"contact\"\nframe = \"tool\"\n"),
        "spherical or floating joints" => with(
            "[[joints]]\nname = \"ball\"\ntype = \"spherical\"\nparent = \"lift\"\n\
             [[bodies]]\nlink = \"ball\"\nmass = 1\ncenter_of_mass = [0, 0, 0.2]\ninertia = 0.02\n",
        ),
        "joints that follow others, or drives that move several joints" => with(
            "[[joints]]\nname = \"finger\"\naxis = [0, 1, 0]\nfollows = { swing = -1 }\n\
             [[bodies]]\nlink = \"finger\"\nmass = 1\ncenter_of_mass = [0, 0, 0.2]\ninertia = 0.02\n",
        ),
        "helical joints" => with(
            "[[joints]]\nname = \"screw\"\ntype = \"helical\"\npitch = 0.01\ndrive = \"ideal\"\n\
             [[bodies]]\nlink = \"screw\"\nmass = 1\ncenter_of_mass = [0, 0, 0.2]\ninertia = 0.02\n",
        ),
        "no inputs" => arm("", "", ""),
        other => panic!("no robot with {other}"),
    }
}

fn in_folder(kind: &Kind) -> (tempfile::TempDir, PathBuf, Model) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.toml");
    fs::write(&path, sample(kind)).unwrap();
    let model =
        read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{}: {error}", kind.robots));
    let others = KINDS.iter().filter(|other| other.includes(&model.model));
    assert_eq!(others.map(|other| other.robots).collect::<Vec<_>>(), [kind.robots]);
    (folder, path, model.model)
}

/// The name in the table: functions of the frame `tool` are those of any frame.
fn row(name: &str) -> &str {
    let of_tool = FrameKind::ALL.into_iter().find(|kind| kind.function("tool") == name);
    match of_tool {
        Some(kind) => kind.pattern(),
        None => name,
    }
}

fn with(path: &Path, functions: &[String], options: GenerateOptions) -> Result<Generated, Diagnostics> {
    generate(path, &GenerateOptions { functions: functions.to_vec(), ..options })
}

/// Generates also compares the functions' numbers with the Newton–Euler equations of the model.
#[test]
fn each_function_is_there_or_refused_as_the_table_has_it() {
    for kind in &KINDS {
        let (_folder, path, model) = in_folder(kind);
        let is_missing =
            |name: &String| matches!(kind.difference(row(name)), Some(Difference::Missing { .. }));
        let (missing, present): (Vec<String>, Vec<String>) = names(&model).into_iter().partition(is_missing);
        let generated = with(&path, &present, GenerateOptions::default());
        let module = generated.unwrap_or_else(|error| panic!("{}: {error}", kind.robots)).module;
        for name in &present {
            let composed = module.compositions.iter().find(|each| each.composition.name() == name);
            let function = module.functions.iter().find(|function| function.name == *name);
            assert!(composed.is_some() || function.is_some(), "{}: {name}", kind.robots);
            let Some(Difference::Documented(other)) = kind.difference(row(name)) else { continue };
            let found = composed.map(|each| each.equation).or(function.map(|each| each.equation.as_str()));
            assert!(other.equation.is_none_or(|equation| found == Some(equation)), "{}: {name}", kind.robots);
            let notes = function.map_or(&[][..], |function| &function.notes);
            let has_notes = other.notes.iter().all(|note| notes.iter().any(|found| found == note));
            assert!(has_notes, "{}: {name}: {notes:?}", kind.robots);
        }
        for name in missing {
            let refused = with(&path, std::slice::from_ref(&name), GenerateOptions::default()).unwrap_err();
            let entry = refused.entries().iter().find(|entry| entry.code == kind.code);
            let entry = entry.unwrap_or_else(|| panic!("{}: {name}: {refused}", kind.robots));
            assert!(entry.message.contains(&format!("`{name}`")) && entry.remedy.is_some(), "{entry}");
        }
    }
}

/// Every function that the table names exists for some robot.
#[test]
fn names_in_the_table_exist() {
    let mut known: Vec<String> = PRODUCTS.iter().map(|product| product.name.to_owned()).collect();
    for kind in &KINDS {
        known.extend(names(&in_folder(kind).2).iter().map(|name| row(name).to_owned()));
    }
    let named =
        KINDS.iter().flat_map(|kind| kind.differences).flat_map(|(names, _)| names.split_whitespace());
    let unknown: Vec<_> = named.filter(|name| !known.iter().any(|known| known == name)).collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn each_product_is_there_or_refused_as_the_table_has_it() {
    for kind in &KINDS {
        let (folder, path, _) = in_folder(kind);
        let for_tool = |tool: Companion, functions: &[&str]| {
            let emit =
                EmitOptions { language: Language::C, companions: vec![tool], ..EmitOptions::default() };
            let functions: Vec<String> = functions.iter().map(|&name| name.to_owned()).collect();
            let made = with(&path, &functions, GenerateOptions { emit, ..GenerateOptions::default() });
            made.map(drop).map_err(|problems| problems.to_string())
        };
        let export = |format: &str| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
            command.current_dir(folder.path()).args(["export", "arm.toml", format, "--output", "-"]);
            let output = command.output().unwrap();
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            if output.status.success() { Ok(()) } else { Err(said) }
        };
        let agrees = |product: Product, made: Result<(), String>| {
            let is_missing = kind.difference(product.name).is_some();
            let name = format!("{} of a robot with {}", product.name, kind.robots);
            assert_eq!(made.is_err(), is_missing, "{name}: {made:?}");
            if let Err(said) = made {
                assert!(said.contains(&format!("error[{}]", kind.code)), "{name}: {said}");
            }
        };
        agrees(CASADI, for_tool(Companion::Casadi, &[]));
        agrees(ACADOS, for_tool(Companion::Acados, &["step", "step_derivatives", "input_matrix"]));
        agrees(EXPORT, export("--mjcf"));
        agrees(EXPORT, export("--urdf"));
        let form = GenerateOptions { form: Form::Arrays, ..GenerateOptions::default() };
        let functions = ["inverse_dynamics_derivatives".to_owned()];
        let straight = with(&path, &functions, form).unwrap().module.functions;
        let is_missing = kind.difference(LOOPS.name).is_some();
        assert_eq!(straight.iter().all(|each| each.arrays.is_none()), is_missing, "loops: {}", kind.robots);
    }
}

/// Functions as code, products in words.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let shown = |name: &str| match name {
        "loops" => "loops over joints".to_owned(),
        "closed-forms" => "closed forms".to_owned(),
        "casadi" | "acados" => format!("`--for {name}`"),
        "export" => "`gelenk export`".to_owned(),
        "identification" => "identification without the measured motion".to_owned(),
        function => format!("`{function}`"),
    };
    names.map(shown).collect::<Vec<_>>().join(", ")
}

/// `GELENK_UPDATE=kinds` writes the table.
#[test]
fn the_table_of_the_page_is_the_table_of_kinds() {
    let mut table =
        "| robots with | additional functions | other equations or notes | missing |\n|---|---|---|---|\n"
            .to_owned();
    for kind in &KINDS {
        let of = |is_missing: bool| {
            let own = kind.differences.iter();
            let own = own.filter(move |(_, each)| matches!(each, Difference::Missing { .. }) == is_missing);
            own.flat_map(|(names, _)| names.split_whitespace())
        };
        let others = kind.replaces.iter().map(|row| row.name).chain(of(false));
        let cells = [listed(kind.adds.iter().map(|row| row.name)), listed(others), listed(of(true))];
        writeln!(table, "| {} | {} |", kind.robots, cells.join(" | ")).unwrap();
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/limits.md");
    let page = fs::read_to_string(&file).unwrap();
    let (start, end) = ("<!-- keys: kinds -->\n", "<!-- end of keys -->\n");
    let (before, rest) = page.split_once(start).unwrap();
    let (_, after) = rest.split_once(end).unwrap();
    let fresh = format!("{before}{start}{table}{end}{after}");
    if std::env::var_os("GELENK_UPDATE").is_some_and(|value| value == "kinds") {
        fs::write(&file, &fresh).unwrap();
    }
    let written = fs::read_to_string(&file).unwrap();
    assert!(written == fresh, "codegen/docs/limits.md is not fresh: run this test with GELENK_UPDATE=kinds");
}
