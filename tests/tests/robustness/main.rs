//! No text makes the readers panic, and large ones are read in reasonable time.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use gelenk_codegen::diagnostic::{Diagnostic, Diagnostics};
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{ReadOptions, from_toml, from_urdf};
use mutation::{Random, mutated};
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

mod elements;
mod generation;
mod mutation;

type Outcome = Result<(Model, Diagnostics), Diagnostics>;

fn toml(text: &str) -> Outcome {
    let none = &mut |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
    from_toml(text, "robot.toml", &ReadOptions::default(), none)
}

fn urdf(text: &str) -> Outcome {
    let options = ReadOptions { ignore_mimic: true, ..ReadOptions::default() };
    from_urdf(text, "robot.urdf", &options)
}

fn file(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(path)).unwrap()
}

/// Invariants of any outcome: an error has errors, all of them placed within the text; a model has
/// coordinates.
fn check(outcome: Outcome) -> bool {
    match outcome {
        Ok((model, notes)) => {
            assert!(!notes.has_errors() && !model.coordinates.is_empty());
            true
        }
        Err(diagnostics) => {
            assert!(diagnostics.has_errors());
            let placed = |entry: &Diagnostic| entry.location().is_some_and(|at| at.line > 0 && at.column > 0);
            let unplaced = diagnostics.entries().iter().find(|entry| !placed(entry));
            assert!(unplaced.is_none_or(|entry| entry.code == "too-many-problems"), "{unplaced:?}");
            assert!(!diagnostics.to_string().is_empty());
            false
        }
    }
}

#[test]
fn mutated_descriptions_never_panic() {
    let mut random = Random(7);
    let (mut accepted, mut refused) = (0, 0);
    for name in ["puma560.toml", "powercube.toml", "double_pendulum.toml", "two_arm.toml", "urdf/ur5.urdf"] {
        let text = file(name);
        for _ in 0..300 {
            let text = mutated(&text, &mut random);
            let good = check(if name.ends_with("toml") { toml(&text) } else { urdf(&text) });
            if good { accepted += 1 } else { refused += 1 }
        }
    }
    // Both kinds occur, otherwise the mutations are too weak or too strong to test anything.
    assert!(accepted > 50 && refused > 500, "{accepted} accepted, {refused} refused");
}

#[test]
fn mutated_formulas_never_panic() {
    let mut random = Random(11);
    let seeds = ["a1*v + a2*tanh(a3*v)", "-sign(v)*(a1 + v.powi(2))/exp(-abs(v))", "pow(v, 2) - pi*y"];
    for _ in 0..1500 {
        let law = mutated(seeds[random.below(3)], &mut random);
        let quoted = law.replace('\\', "\\\\").replace('"', "\\\"").replace(char::is_control, " ");
        let parameters = "[parameters]\na1 = 1\na2 = 2\na3 = 3\n";
        let body = "[[bodies]]\nlink = \"j\"\nmass = 1\ncenter_of_mass = [0, 1, 0]\ninertia = 1\n";
        check(toml(&format!("{parameters}[[joints]]\nname = \"j\"\nfriction = \"{quoted}\"\n{body}")));
    }
}

fn chain_toml(joints: usize) -> String {
    let mut text = String::new();
    for k in 0..joints {
        let axis = if k % 2 == 0 { "[0, 0, 1]" } else { "[0, 1, 0]" };
        write!(
            text,
            "[[joints]]\nname = \"j{k}\"\naxis = {axis}\norigin = {{ xyz = [0.1, 0, 0.2] }}\ndrive = \"ideal\"\n\
             [[bodies]]\nlink = \"j{k}\"\nmass = 1\ncenter_of_mass = [0, 0, 0.1]\ninertia = 0.01\n"
        )
        .unwrap();
    }
    text
}

fn chain_urdf(joints: usize) -> String {
    let mut text = String::from("<robot name=\"chain\">\n<link name=\"l0\"/>\n");
    for k in 1..=joints {
        write!(
            text,
            "<link name=\"l{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" \
             izz=\"1\"/></inertial></link>\n<joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{}\"/>\
             <child link=\"l{k}\"/><origin xyz=\"0 0 1\" rpy=\"1.5707 0 0\"/></joint>\n",
            k - 1
        )
        .unwrap();
    }
    text + "</robot>\n"
}

/// Generous: a debug build on a busy machine; a quadratic reader takes minutes.
const PATIENCE: Duration = Duration::from_secs(60);

fn timed(read: impl FnOnce() -> Outcome) -> Outcome {
    let start = Instant::now();
    let outcome = read();
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
    eprintln!("{:?}", start.elapsed());
    outcome
}

#[test]
fn five_hundred_joints() {
    assert_eq!(timed(|| toml(&chain_toml(500))).unwrap().0.coordinates.len(), 500);
    assert_eq!(timed(|| urdf(&chain_urdf(500))).unwrap().0.coordinates.len(), 500);
}

#[test]
fn ten_megabytes_of_joints() {
    // Its M is singular, and has no clear place for a rotor: messages about M do not form all of it.
    let singular = "<link name=\"tip\"/><joint name=\"tip\" type=\"continuous\"><parent link=\"l45000\"/><child link=\"tip\"/>\
                    </joint>\n<transmission name=\"t\"><joint name=\"j1\"/><joint name=\"j2\"/><actuator name=\"a\">\
                    <motorInertia>1</motorInertia></actuator></transmission></robot>";
    let text = chain_urdf(45_000).replace("</robot>", singular);
    assert!(text.len() > 10_000_000);
    let (model, said) = timed(|| urdf(&text)).unwrap();
    let codes: Vec<&str> = said.entries().iter().map(|each| each.code).collect();
    assert_eq!(model.coordinates.len(), 45_001);
    assert!(codes.contains(&"joints-without-inertia") && codes.contains(&"rotor-skipped"), "{codes:?}");
    let text = chain_toml(70_000);
    assert!(text.len() > 10_000_000);
    assert_eq!(timed(|| toml(&text)).unwrap().0.coordinates.len(), 70_000);
}

#[test]
fn ten_megabytes_of_nonsense() {
    let repeated = |part: &str| part.repeat(10_000_000 / part.len());
    for text in
        [repeated("["), repeated("a"), repeated("a = 1 "), repeated("x.y.z = {\n"), repeated("\u{7f}")]
    {
        check(timed(|| toml(&text)));
    }
    let keys: String = (0..700_000).fold(String::new(), |mut text, k| {
        writeln!(text, "key_{k} = {k}").unwrap();
        text
    });
    check(timed(|| toml(&keys)));
    let parameters = format!("[parameters]\n{keys}");
    check(timed(|| toml(&parameters)));
    for part in ["<a>", "<robot ", "<robot name='", "&lt;", "<robot/>"] {
        check(timed(|| urdf(&repeated(part))));
    }
}

#[test]
fn deep_nesting() {
    for depth in [1_000, 100_000] {
        let text = format!("<robot name=\"r\">{}{}</robot>", "<a>".repeat(depth), "</a>".repeat(depth));
        check(timed(|| urdf(&text)));
        check(timed(|| toml(&format!("a = {}{}", "[".repeat(depth), "]".repeat(depth)))));
        check(timed(|| toml(&format!("a = {}1{}", "{ b = ".repeat(depth), " }".repeat(depth)))));
        check(timed(|| toml(&format!("[{}a]", "a.".repeat(depth)))));
    }
}

#[test]
fn entities_do_not_explode() {
    let mut text = String::from("<!DOCTYPE r [<!ENTITY a0 \"x\">");
    for k in 1..30 {
        write!(text, "<!ENTITY a{k} \"&a{};&a{};\">", k - 1, k - 1).unwrap();
    }
    text += "]><robot name=\"&a29;\"/>";
    assert!(urdf(&text).is_err());
}
