//! Joints that follow a coordinate by one ratio: their forces are those of joints that move by themselves, and share a product.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;

/// Two fingers and a thumb on a turning palm; what moves them stands in the keys.
fn hand(keys: [&str; 3]) -> String {
    let finger = |(name, key): (&str, &str)| {
        let x = if name == "thumb" { -0.04 } else { 0.05 };
        format!(
            "[[joints]]\nname = \"{name}\"\nparent = \"palm\"\naxis = [0.6, 0, 0.8]\norigin = {{ xyz = [{x}, 0.03, 0.1] }}\n{key}\n\
             [[bodies]]\nlink = \"{name}\"\nmass = 0.2\ncenter_of_mass = [0.01, 0.02, 0.03]\ninertia = [2e-4, 3e-4, 1e-4]\n"
        )
    };
    let joint = |name: &str, axis: &str| {
        format!(
            "[[joints]]\nname = \"{name}\"\naxis = {axis}\norigin = {{ xyz = [0, 0.1, 0.2] }}\ndrive = \"ideal\"\n"
        )
    };
    let body = "[[bodies]]\nlink = \"palm\"\nmass = 1\ncenter_of_mass = [0.02, 0, 0.05]\ninertia = [0.02, 0.03, 0.01]\n";
    let fingers: String = ["left", "right", "thumb"].into_iter().zip(keys).map(finger).collect();
    [joint("arm", "[0, 0, 1]"), joint("palm", "[0, 1, 0]"), body.to_owned(), fingers].concat()
}

fn file(text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hand.toml");
    fs::write(&file, text).unwrap();
    (folder, file)
}

fn forces(text: &str, motion: [&[f64]; 3]) -> Vec<f64> {
    let (_kept, file) = file(text);
    let model = read::read(&file, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).model;
    let robot = InterpretedRobot::new(&model).unwrap();
    let mut forces = vec![0.0; robot.joint_names().len()];
    robot.rigid_forces(motion[0], motion[1], motion[2], &mut forces);
    forces
}

/// τ = Gᵀ τ_joints(G y, G ẏ, G ÿ)
#[test]
fn forces_of_followers_are_summed_by_their_ratios() {
    let ratios = [0.7, -0.7, 0.7];
    let coupled =
        hand(ratios.map(|ratio| format!("follows = {{ palm = {ratio} }}")).each_ref().map(String::as_str));
    let free = hand(["drive = \"ideal\""; 3]);
    let motion = [[0.3, -0.8], [1.1, 0.7], [-2.0, 3.0]];
    let joints = motion.map(|[arm, palm]| [arm, palm, 0.7 * palm, -0.7 * palm, 0.7 * palm]);
    let [y, v, a] = &joints;
    let all = forces(&free, [y, v, a]);
    let expected = [all[0], all[1] + 0.7 * (all[2] - all[3] + all[4])];
    let [y, v, a] = &motion;
    let found = forces(&coupled, [y, v, a]);
    let largest = expected.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-13 * largest, "{found} {expected}");
    }
}

/// Lines of inverse dynamics that multiply by 0.7.
fn products(text: &str) -> usize {
    let (_kept, file) = file(text);
    let options =
        GenerateOptions { functions: vec!["inverse_dynamics".into()], ..GenerateOptions::default() };
    let generated = generate(&file, &options).unwrap_or_else(|e| panic!("{e}"));
    let lines = generated.source.text.lines();
    lines.filter(|line| line.contains("* 0.7;") || line.contains("= 0.7 *")).count()
}

/// Three joints with equal ratios share the products of the ratio with y, ẏ, ÿ and the sum of their forces.
#[test]
fn joints_of_one_ratio_share_four_products() {
    let follows = |ratios: [&str; 3]| {
        let keys = ratios.map(|ratio| format!("follows = {{ palm = {ratio} }}"));
        products(&hand(keys.each_ref().map(String::as_str)))
    };
    assert_eq!(follows(["0.7", "-0.7", "0.7"]), 4);
    assert_eq!(follows(["0.7", "-0.6", "0.8"]), 4);
}
