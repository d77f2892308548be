//! Robots in the formats of other programs: MuJoCo computes the same of them, and gelenk of what it reads again.
//!
//! MuJoCo is a package of Python (`tests/python/mujoco.txt`); where it cannot be had, the comparisons with it are skipped and
//! say so.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use gelenk_codegen::diagnostic::Severity;
use gelenk_codegen::export::{Exported, Format, export};
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{Body, JointPosition, Model, QuaternionJoint};
use gelenk_codegen::read::{ReadOptions, from_urdf, read};
use gelenk_tests::mujoco::{Compared, independent_values, values};
use gelenk_tests::python::{program, python_with_mujoco};
use gelenk_tests::quaternion_model::with_quaternions;
use gelenk_tests::random_model::{
    random_coupled_model, random_helical_model, random_model, random_model_with_frame_forces,
};
use gelenk_tests::{Robot, descriptions, published, relative_error, workspace};
use serde_json::Value;

/// The models of this repository with their names.
fn models() -> Vec<(String, Model)> {
    let load = |path: PathBuf| {
        let loaded = read(&path, &ReadOptions { exact_sign: true, ..ReadOptions::default() });
        let model = loaded.unwrap_or_else(|problems| panic!("{problems}")).model;
        (path.file_stem().expect("a name").to_string_lossy().into_owned(), model)
    };
    // Those with driven joints are not exported.
    descriptions().into_iter().map(load).filter(|(_, model)| model.driven.is_empty()).collect()
}

/// A rack that follows a light pinion.
fn rack() -> Model {
    let joints = "[[joints]]\nname = \"pinion\"\naxis = [0, 1, 0]\n\
        [[joints]]\nname = \"rack\"\nparent = \"base\"\ntype = \"prismatic\"\naxis = [1, 0, 0]\nfollows = { pinion = 0.01 }\n";
    let bodies = "[[bodies]]\nlink = \"pinion\"\nmass = 0.1\ncenter_of_mass = [0.01, 0, 0]\ninertia = 1e-6\n\
        [[bodies]]\nlink = \"rack\"\nmass = 0.3\ninertia = 1e-4\n";
    let file = tempfile::NamedTempFile::with_suffix(".toml").expect("a file");
    std::fs::write(file.path(), [joints, bodies].concat()).expect("a file");
    read(file.path(), &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}")).model
}

fn says(exported: &Exported, part: &str) -> bool {
    exported.notes.entries().iter().any(|note| note.message.contains(part))
}

/// Compares values with MuJoCo, where it can be had.
fn compare(values: &[Value], folder: &Path) {
    if let Some((text, agrees)) = compared(values, folder) {
        assert!(agrees, "{text}");
    }
}

/// Output of the comparison, and whether all robots agree.
fn compared(values: &[Value], folder: &Path) -> Option<(String, bool)> {
    let python = python_with_mujoco()?;
    let file = folder.join("values.json");
    std::fs::write(&file, Value::from(values).to_string()).expect("a file");
    let script = workspace().join("tests/mujoco/compare.py");
    // MuJoCo leaves a log where it runs.
    let output =
        Command::new(python).arg(script).arg(file).current_dir(folder).output().expect("Python starts");
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text).into_owned();
    println!("{text}");
    Some((text, output.status.success()))
}

/// M, k, B, springs and dampers of all models.
#[test]
fn mujoco_computes_the_same_of_exported_robots() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut compared = Vec::new();
    for (name, model) in models().into_iter().chain([("rack".to_owned(), rack())]) {
        let exported = export(&model, Format::Mjcf, &name);
        if says(&exported, "MuJoCo rejects") {
            println!("{name}: {}", exported.notes);
            assert_eq!(name, "puma560");
            continue;
        }
        let file = folder.path().join(format!("{name}.xml"));
        std::fs::write(&file, &exported.text).expect("a file");
        let what = Compared {
            by_name: true,
            passive: !says(&exported, "linear springs") && !says(&exported, "one damping"),
            inputs: true,
            couples: true,
        };
        compared.push(values(&name, &file, &model, what));
    }
    assert!(compared.len() >= 20);
    compare(&compared, folder.path());
}

/// The code of the warning that an export is another robot.
const DIFFERS: &str = "exported-robot-differs";

/// The code of what the format does not hold.
const NOT_HELD: &str = "not-in-mjcf";

/// The answer of MuJoCo to an export.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Answer {
    Agrees,
    Differs,
    Refuses,
}

/// A description whose export lost something once.
struct Case {
    file: &'static str,
    /// M of the export, rows first, where it is the same at all states; computed by hand.
    mass: &'static [f64],
    /// Code, severity and a part of each finding that names a loss; there are no other warnings.
    findings: &'static [(&'static str, Severity, &'static str)],
    answer: Answer,
}

const CASES: [Case; 8] = [
    // 0.04 + 3 · 0.1² + 0.1, the last one from a body without mass.
    Case { file: "massless_body_with_inertia.urdf", mass: &[0.17], findings: &[], answer: Answer::Agrees },
    // A drive on joints of two branches: 0.14 · 1 + 50² · 1e-3 · 𝟙𝟙ᵀ.
    Case {
        file: "tendon_branches.toml",
        mass: &[2.64, 2.5, 2.5, 2.64],
        findings: &[],
        answer: Answer::Agrees,
    },
    Case {
        file: "turned_base.toml",
        mass: &[],
        findings: &[(DIFFERS, Severity::Warning, "the bias force is 0.462 instead of -21.4 at `hull_x`")],
        answer: Answer::Differs,
    },
    // Gravity is the same everywhere.
    Case {
        file: "moved_base.toml",
        mass: &[],
        findings: &[(
            NOT_HELD,
            Severity::Note,
            "has floating joints with positions in the base frame. The positions differ at: `hull`",
        )],
        answer: Answer::Agrees,
    },
    Case { file: "keyframe.xml", mass: &[], findings: &[], answer: Answer::Agrees },
    Case {
        file: "triangle.toml",
        mass: &[],
        findings: &[(NOT_HELD, Severity::Warning, "MuJoCo rejects: `a`")],
        answer: Answer::Refuses,
    },
    Case {
        file: "inner_floating_joint.toml",
        mass: &[],
        findings: &[
            (NOT_HELD, Severity::Warning, "has floating joints only at the base. MuJoCo rejects: `hull`"),
            (DIFFERS, Severity::Warning, "only joint of a body in <worldbody>)): other programs reject it"),
        ],
        answer: Answer::Refuses,
    },
    // 0.1 + 1 · 0.1², raised by what the triangle inequality lacks.
    Case {
        file: "rounded_triangle.toml",
        mass: &[0.110_001],
        findings: &[(DIFFERS, Severity::Warning, "M has 0.110001 instead of 0.11 at `a`")],
        answer: Answer::Agrees,
    },
];

/// Each loss has its finding, with its size where the robot is another one, and MuJoCo's M is the one computed elsewhere.
#[test]
fn exports_that_lost_something_name_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robots = Vec::new();
    for Case { file, mass, findings, .. } in &CASES {
        let path = workspace().join("tests/mujoco/exports").join(file);
        let loaded = read(&path, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
        let exported = export(&loaded.model, Format::Mjcf, file);
        let found = exported.notes.entries().iter();
        let found: Vec<_> = found.map(|note| (note.code, note.severity, note.message.as_str())).collect();
        let warnings = found.iter().filter(|note| note.1 == Severity::Warning).count();
        let expected = findings.iter().filter(|finding| finding.1 == Severity::Warning).count();
        assert_eq!(warnings, expected, "{file}: {found:?}");
        for (code, severity, part) in *findings {
            let is_it = |note: &&(&str, Severity, &str)| {
                note.0 == *code && note.1 == *severity && note.2.contains(part)
            };
            assert_eq!(found.iter().filter(is_it).count(), 1, "{file}: {found:?}");
        }
        let written = folder.path().join(file).with_extension("xml");
        std::fs::write(&written, &exported.text).expect("a file");
        let mut robot = independent_values(file, &written, &loaded.model);
        for state in robot["states"].as_array_mut().expect("states").iter_mut().filter(|_| !mass.is_empty()) {
            state["mass_matrix"] = mass.to_vec().into();
        }
        robots.push(robot);
    }
    let keyframe = read(&workspace().join("tests/mujoco/exports/keyframe.xml"), &ReadOptions::default());
    let notes = keyframe.unwrap_or_else(|problems| panic!("{problems}")).notes;
    let codes: Vec<&str> = notes.entries().iter().map(|note| note.code).collect();
    assert_eq!(codes, ["start-pose", "skipped"], "the start of a robot and keyframes are lost in reading");
    let Some((text, _)) = compared(&robots, folder.path()) else { return };
    for Case { file, answer, .. } in &CASES {
        let line = text.lines().find(|line| line.split(' ').next() == Some(file)).expect(file);
        let found = match line {
            _ if line.contains("Error:") => Answer::Refuses,
            _ if line.ends_with("DIFFERS") => Answer::Differs,
            _ => Answer::Agrees,
        };
        assert_eq!(found, *answer, "{line}");
    }
}

/// A rotor on two branches: 1 N m at one of the joints accelerates it by 2.64 / (2.64² − 2.5²).
#[test]
fn mujoco_accelerates_a_rotor_on_two_branches() {
    let path = workspace().join("tests/mujoco/exports/tendon_branches.toml");
    let model = read(&path, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}")).model;
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("tendon_branches.xml");
    std::fs::write(&file, export(&model, Format::Mjcf, "tendon_branches").text).expect("a file");
    let Some(python) = python_with_mujoco() else { return };
    let script = "import mujoco, sys\nmodel = mujoco.MjModel.from_xml_path(sys.argv[1])\ndata = mujoco.MjData(model)\n\
        joint = model.joint('a').dofadr[0]\ndata.qfrc_applied[joint] = 1\nmujoco.mj_forward(model, data)\nprint(data.qacc[joint])";
    let output = Command::new(python).args(["-c", script]).arg(&file).current_dir(&folder).output();
    let output = output.expect("Python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    let found: f64 = text.trim().parse().unwrap_or_else(|_| panic!("{output:?}"));
    // The equality that holds the rotor leaves some 1e-4.
    assert!((found - 3.669).abs() < 4e-3, "{found}");
}

/// The number of random robots of each kind; `GELENK_EXPORTS=3600` is the long run.
fn exports() -> usize {
    std::env::var("GELENK_EXPORTS").map_or(50, |count| count.parse().expect("a number"))
}

/// Exports robots for seeds and compares their M and k with MuJoCo's; where they differ, the warning [`DIFFERS`] has to say so, and
/// where MuJoCo refuses the file, that warning or [`NOT_HELD`]. The number of those whose M agrees; nothing where MuJoCo cannot be had.
fn agreeing(robot: impl Fn(u64) -> Model) -> Option<usize> {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut robots, mut warned) = (Vec::new(), BTreeMap::new());
    for seed in 0..exports() as u64 {
        let (model, name) = (robot(seed), format!("robot_{seed}"));
        let exported = export(&model, Format::Mjcf, &name);
        let warnings = exported.notes.entries().iter().filter(|note| note.severity == Severity::Warning);
        let codes: BTreeSet<&str> = warnings.map(|note| note.code).collect();
        if !codes.is_empty() {
            warned.insert(name.clone(), codes);
        }
        let file = folder.path().join(format!("{name}.xml"));
        std::fs::write(&file, &exported.text).expect("a file");
        robots.push(independent_values(&name, &file, &model));
    }
    let (text, _) = compared(&robots, folder.path())?;
    let is_named = |line: &&str| {
        let codes = line.split(' ').next().and_then(|name| warned.get(name));
        let is_refused = line.contains("Error:");
        codes.is_some_and(|codes| codes.contains(DIFFERS) || is_refused && codes.contains(NOT_HELD))
    };
    let differing = text.lines().filter(|line| line.ends_with("DIFFERS"));
    let silent: Vec<&str> = differing.filter(|line| !is_named(line)).collect();
    assert!(silent.is_empty(), "they differ without a warning that says so: {silent:#?}");
    let mass =
        |line: &str| line.split_whitespace().skip_while(|word| *word != "mass_matrix").nth(1)?.parse().ok();
    let agreeing = text.lines().filter(|line| mass(line).is_some_and(|error: f64| error <= 1e-9)).count();
    println!("{agreeing} of {} random exports have the same M; {} have warnings", robots.len(), warned.len());
    Some(agreeing)
}

/// Trees, couplings, screws, forces at frames, spherical and floating joints; MuJoCo has floating ones on the base alone.
fn random(seed: u64) -> Model {
    let kinds: [fn(u64, usize) -> Model; 4] =
        [random_model, random_coupled_model, random_helical_model, random_model_with_frame_forces];
    let model = kinds[seed as usize % 4](seed, 6);
    let free = with_quaternions(model.clone(), seed);
    let parent = |joint: &QuaternionJoint| {
        let first = &free.links[free.coordinates[joint.first]];
        first.joint.as_ref().map_or(0, |joint| joint.parent)
    };
    let inner =
        free.quaternion_joints.iter().find(|joint| joint.coordinates().len() == 6 && parent(joint) != 0);
    if seed.is_multiple_of(3) && inner.is_none() { free } else { model }
}

/// Links that carry rotors are balls if they were point masses or empty: a rotor cannot be a part of these.
fn with_balls(mut model: Model) -> Model {
    for drive in &model.drives {
        let link = &mut model.links[drive.carrier];
        if link.bodies.iter().flat_map(|body| &body.inertia).all(Formula::is_zero) {
            link.bodies.push(Body {
                name: "ball".into(),
                mass: Formula::Number(0.1),
                center_of_mass: [0.0; 3].map(Formula::Number),
                inertia: [5e-3, 0.0, 0.0, 5e-3, 0.0, 5e-3].map(Formula::Number),
            });
        }
    }
    model
}

/// At least 99 % of the robots have the same M in MuJoCo; a warning names what others lose.
#[test]
fn mujoco_computes_the_same_of_random_exports() {
    if let Some(agreeing) = agreeing(|seed| with_balls(random(seed))) {
        assert!(100 * agreeing >= 99 * exports(), "{agreeing}");
    }
    agreeing(random);
}

/// Hinges, slides, balls and free bodies, classes, frames, includes, shapes, meshes, tendons and equalities, as MuJoCo reads them.
#[test]
fn mujoco_computes_the_same_of_what_it_is_read_from() {
    let folder = workspace().join("tests/mujoco/robots");
    let mut compared = Vec::new();
    for name in ["arm", "attached", "cart", "meshes", "walker"] {
        let file = folder.join(format!("{name}.xml"));
        let loaded = read(&file, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
        let what = Compared { by_name: false, passive: true, inputs: true, couples: true };
        compared.push(values(name, &file, &loaded.model, what));
        // What is written again is the same robot, too.
        let again = tempfile::NamedTempFile::with_suffix(".xml").expect("a file");
        std::fs::write(again.path(), export(&loaded.model, Format::Mjcf, name).text).expect("a file");
        let loaded =
            read(again.path(), &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
        compared.push(values(&format!("{name}, again"), &file, &loaded.model, what));
    }
    let folder = tempfile::tempdir().expect("a folder");
    compare(&compared, folder.path());
}

/// Published files of installed packages, against the outcomes in `tests/mujoco/robots.txt`: which are read, which agree, and
/// why others do not.
#[test]
#[ignore = "takes packages with robots in MJCF, and minutes"]
fn published_robots_in_mjcf() {
    let Some(python) = python_with_mujoco() else { return };
    let script = workspace().join("tests/mujoco/compare.py");
    let output = Command::new(&python).arg(script).arg("--list").output().expect("Python starts");
    let (mut values, mut outcomes) = (Vec::new(), Vec::new());
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let [package, file, path] = line.split('\t').collect::<Vec<_>>()[..] else { continue };
        let (name, path) = (format!("{package}/{file}"), Path::new(path));
        let options = ReadOptions { no_friction: true, accept_unphysical: true, ..ReadOptions::default() };
        match read(path, &options) {
            Ok(loaded) => {
                let has_meshes = loaded.notes.entries().iter().any(|note| note.code == "mesh-inertia");
                outcomes.push((name.clone(), if has_meshes { "meshes" } else { "differs" }));
                let what = Compared { couples: true, ..Compared::default() };
                values.push(gelenk_tests::mujoco::values(&name, path, &loaded.model, what));
            }
            Err(problems) => {
                let mut entries = problems.entries().iter();
                let first = entries.find(|entry| entry.severity == Severity::Error);
                outcomes.push((name, first.map_or("", |entry| entry.code)));
            }
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let (text, _) = compared(&values, folder.path()).expect("MuJoCo");
    let lines = outcomes.into_iter().map(|(name, outcome)| {
        let line = text.lines().find(|line| line.split(' ').next() == Some(&name));
        let outcome = match line {
            Some(line) if !line.ends_with("DIFFERS") => "agrees",
            Some(line) if line.contains("Error:") => "refused by MuJoCo",
            _ => outcome,
        };
        format!("{outcome}: {name}")
    });
    let found: Vec<String> = lines.collect();
    println!("{}", found.join("\n"));
    let known = std::fs::read_to_string(workspace().join("tests/mujoco/robots.txt")).expect("robots.txt");
    let new: Vec<&String> = found.iter().filter(|line| !known.lines().any(|known| known == **line)).collect();
    assert!(new.is_empty(), "not in robots.txt: {new:#?}");
}

/// Robots and scenes of MuJoCo's menagerie, by the script for folders of such files.
#[test]
#[ignore = "takes minutes"]
fn robots_of_the_menagerie_have_the_same_mass_matrix() {
    let (Some(python), Some(folder)) = (python_with_mujoco(), published("data/menagerie")) else { return };
    let script = workspace().join("tests/mujoco/folder.py");
    let output = Command::new(python).arg(script).arg(folder).arg(program()).output().expect("Python starts");
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success());
}

/// Without the rotors, which a URDF does not have.
fn without_rotors(model: &Model) -> Model {
    let mut model = model.clone();
    model.drives.clear();
    model
}

/// M and k of what is read again, joint by joint; those of Pinocchio where it is installed.
#[test]
fn exported_urdfs_are_the_same_robots() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut compared = Vec::new();
    for (name, model) in models() {
        let exported = export(&model, Format::Urdf, &name);
        if says(&exported, "move freely in the file") {
            println!("{name}: {}", exported.notes);
            continue;
        }
        let options = ReadOptions { accept_unphysical: true, ..ReadOptions::default() };
        let read = from_urdf(&exported.text, "robot.urdf", &options);
        let (mut read, _) = read.unwrap_or_else(|problems| panic!("{name}: {problems}\n{}", exported.text));
        read.gravity =
            model.gravity.clone().map(|g| Formula::Number(g.value(&described(&model)).expect("a number")));
        let [ours, theirs] = [&model, &read].map(|model| robot(&without_rotors(model)));
        assert_same(&name, &ours, &theirs);
        let file = folder.path().join(format!("{name}.urdf"));
        std::fs::write(&file, &exported.text).expect("a file");
        if read.followers.is_empty()
            && model.quaternion_joints.iter().all(|joint| joint.kind.velocities() == 6)
        {
            let what = Compared { by_name: true, ..Compared::default() };
            compared.push(values(&name, &file, &without_rotors(&read), what));
        }
    }
    assert!(compared.len() >= 14, "{}", compared.len());
    compare(&compared, folder.path());
}

fn described(model: &Model) -> Vec<f64> {
    model.parameters.iter().map(|parameter| parameter.default).collect()
}

fn robot(model: &Model) -> Robot {
    Robot::of_model(model.clone(), &["mass_matrix", "bias_forces"])
}

/// Compares M and k; the joints may stand in another order.
fn assert_same(name: &str, ours: &Robot, theirs: &Robot) {
    let names =
        |robot: &Robot| -> Vec<String> { robot.model.joints().map(|joint| joint.name.clone()).collect() };
    let velocities = order(&names(ours), &names(theirs));
    let positions = order(&position_names(&ours.model), &position_names(&theirs.model));
    let n = velocities.len();
    for seed in 1..4 {
        let (y, v) = (numbers(seed, positions.len()), numbers(seed + 5, n));
        let (other_y, other_v) = (ordered(&y, &positions), ordered(&v, &velocities));
        let bias = ordered(&ours.first("bias_forces", &[&y, &v]), &velocities);
        let error = relative_error(&theirs.first("bias_forces", &[&other_y, &other_v]), &bias);
        assert!(error < 1e-12, "{name}: bias {error:e}");
        let mass = ours.first("mass_matrix", &[&y]);
        let rows = velocities.iter().flat_map(|&row| velocities.iter().map(move |column| row * n + column));
        let expected: Vec<f64> = rows.map(|entry| mass[entry]).collect();
        let error = relative_error(&theirs.first("mass_matrix", &[&other_y]), &expected);
        assert!(error < 1e-12, "{name}: mass matrix {error:e}");
    }
}

/// Numbers between −0.7 and 0.9. Quaternions of them are not unit quaternions, which changes both robots alike.
fn numbers(seed: usize, count: usize) -> Vec<f64> {
    (0..count).map(|k| ((7 * k + 3 * seed) % 11) as f64 / 7.0 - 0.7).collect()
}

/// For each of the second names its place among the first.
fn order(first: &[String], second: &[String]) -> Vec<usize> {
    assert_eq!(first.len(), second.len());
    second.iter().map(|name| first.iter().position(|other| other == name).expect(name)).collect()
}

fn ordered(values: &[f64], order: &[usize]) -> Vec<f64> {
    order.iter().map(|&at| values[at]).collect()
}

fn position_names(model: &Model) -> Vec<String> {
    let joints: Vec<_> = model.joints().collect();
    let names = model.joint_positions().flat_map(|joint| match joint {
        JointPosition::Coordinate(coordinate) => vec![joints[coordinate].name.clone()],
        JointPosition::Quaternion(joint) => {
            joint.kind.position_names().iter().map(|name| format!("{}_{name}", joint.name)).collect()
        }
    });
    names.collect()
}
