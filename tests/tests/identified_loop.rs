//! The loop identify → regenerate → track: friction found in a log becomes a description, a build script
//! makes a module of it, and a program that links the runtime tracks a reference on the published arm with
//! it.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

#[path = "../../runtime/examples/powercube/methods/mod.rs"]
mod methods;

use std::fs;
use std::path::Path;

use gelenk_generated::powercube;
use gelenk_identification::friction::{FrictionData, FrictionIdentification, FrictionMethod};
use gelenk_identification::methods::differentiation::quantization_noise;
use gelenk_identification::methods::stribeck::StribeckRegression;
use gelenk_identification::result::description::{Identified, identified_toml};
use gelenk_identification::result::{FrictionLaw, FrictionResult};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_tests::cargo::{cargo, lock_like_here, success};
use gelenk_tests::packages::use_published;
use gelenk_tests::workspace;
use methods::kalman::KalmanSmoother;
use methods::torque::{Motion, friction_torques};

gelenk_runtime::dynamics!(struct Arm = powercube);

const RESOLUTION: f64 = 1e-4;

/// Times, positions and motor torques.
type Columns = (Vec<f64>, [Vec<f64>; 2], [Vec<f64>; 2]);

/// 40 s at 50 Hz of the published arm, as encoders and torque sensors see it.
fn recorded() -> Columns {
    let (mut times, mut positions, mut inputs) = Columns::default();
    for i in 0..2000 {
        let t = 0.02 * f64::from(i);
        let wave = |a: f64, w: f64, b: f64, x: f64| {
            [
                a * (w * t).sin() + b * (x * t).cos(),
                a * w * (w * t).cos() - b * x * (x * t).sin(),
                -a * w * w * (w * t).sin() - b * x * x * (x * t).cos(),
            ]
        };
        let (first, second) = (wave(0.4, 1.1, 0.1, 2.3), wave(0.5, 0.9, 0.15, 1.9));
        let at = |k: usize| [first[k], second[k]];
        let torques = Arm.inverse_dynamics(&at(0), &at(1), &at(2));
        times.push(t);
        for joint in 0..2 {
            positions[joint].push((at(0)[joint] / RESOLUTION).round() * RESOLUTION);
            inputs[joint].push(torques[joint] / powercube::input_matrix()[0][0]);
        }
    }
    (times, positions, inputs)
}

/// Friction of both joints: terms of the library for the first, a Stribeck law for the second.
fn identified() -> [FrictionResult; 2] {
    let (times, positions, inputs) = recorded();
    let smoother = KalmanSmoother::from_noise(quantization_noise(RESOLUTION));
    let smooth = positions.map(|y| smoother.differentiate(&times, &y).expect("derivatives"));
    // The smoother knows one side at the ends.
    let inner = 50..times.len() - 50;
    let columns = |of: [&'_ Vec<f64>; 2]| of.map(|column| column[inner.clone()].to_vec());
    let velocities = columns(smooth.each_ref().map(|d| &d.first));
    let [y, a] =
        [columns(smooth.each_ref().map(|d| &d.value)), columns(smooth.each_ref().map(|d| &d.second))];
    let u = columns(inputs.each_ref());
    let motion = Motion {
        positions: y.each_ref().map(Vec::as_slice),
        velocities: velocities.each_ref().map(Vec::as_slice),
        accelerations: a.each_ref().map(Vec::as_slice),
        inputs: u.each_ref().map(Vec::as_slice),
    };
    let torques = friction_torques(&Arm, &motion).expect("friction torques");
    let methods = [FrictionMethod::BestSubset, FrictionMethod::Stribeck(StribeckRegression::default())];
    let mut joint = 0;
    methods.map(|method| {
        let settings = FrictionIdentification { method, ..FrictionIdentification::new().expect("settings") };
        let data = FrictionData::of(powercube::JOINT_NAMES[joint], &velocities[joint], &torques[joint]);
        joint += 1;
        let mut result = settings.identify(&data).expect("a friction law").result;
        // The published friction falls nowhere: Stribeck's words would mean nothing, his curve can still be tracked with.
        assert!(result.refusals().all(|refusal| refusal.code == "no-stribeck-law"), "{:?}", result.findings);
        result.findings.clear();
        result
    })
}

/// The largest coefficient of the first law made half as large again.
fn altered(results: &[FrictionResult; 2]) -> [FrictionResult; 2] {
    let mut altered = results.clone();
    let FrictionLaw::Terms(terms) = &mut altered[0].law else {
        panic!("a law of terms");
    };
    let viscous = terms.iter_mut().find(|term| term.basis == "v");
    viscous.expect("viscous friction").coefficient *= 1.5;
    altered
}

fn write_package(folder: &Path, results: &[FrictionResult; 2]) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file");
    fs::create_dir(folder.join("src")).expect("a folder");
    let models = workspace().join("models/powercube.toml");
    fs::copy(models, folder.join("powercube.toml")).expect("the description");
    let toml = |name: &str, results: &[FrictionResult]| {
        identified_toml(&Identified {
            name,
            extends: "powercube.toml",
            friction: results,
            ..Identified::default()
        })
        .expect("a description")
    };
    write("identified.toml", &toml("identified", results));
    write("altered.toml", &toml("altered", &altered(results)));
    write(
        "build.rs",
        "fn main() {\n    gelenk_codegen::build(\"identified.toml\");\n    gelenk_codegen::build(\"altered.toml\");\n}\n",
    );
    write("src/main.rs", include_str!("../identified_loop/main.rs"));
    let manifest = format!(
        "[workspace]\n[package]\nname = \"tracking\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\
         [dependencies]\ngelenk-runtime = {version:?}\ngelenk-generated = {{ path = {:?} }}\n\
         [build-dependencies]\ngelenk-codegen = {{ version = {version:?}, default-features = false }}\n",
        workspace().join("generated"),
        version = env!("CARGO_PKG_VERSION"),
    );
    write("Cargo.toml", &manifest);
    use_published(folder);
    lock_like_here(folder);
}

/// Builds and runs the program; its tracking errors by model, rms in rad.
fn track(folder: &Path) -> Vec<(String, f64)> {
    let text = success(&cargo(folder, &["run"]));
    print!("{text}");
    text.lines()
        .map(|line| {
            let (name, error) = line.split_once(' ').expect("a name and an error");
            (name.to_owned(), error.parse().expect("a number"))
        })
        .collect()
}

#[test]
fn identified_friction_tracks_and_a_changed_coefficient_shows() {
    let results = identified();
    for result in &results {
        println!("{}: {}", result.joint, result.formula());
    }
    let folder = tempfile::tempdir().expect("a folder");
    write_package(folder.path(), &results);
    let errors = track(folder.path());
    let error = |name: &str| {
        let found = errors.iter().find(|(model, _)| model == name);
        found.unwrap_or_else(|| panic!("no line of {name}")).1
    };
    let (published, identified) = (error("published"), error("identified"));
    // Worse by less than half a step of the encoders that the log was recorded with.
    assert!(identified < published + 0.5 * RESOLUTION, "{errors:?}");
    assert!(error("altered") > 100.0 * identified, "{errors:?}");
    assert!(error("frictionless") > error("altered"), "{errors:?}");
}
