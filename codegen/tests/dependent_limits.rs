//! Limits of joints that follow others, in modules and in planned motions, and what is said of them.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;
use std::process::Command;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::excitation::{Excitation, Plan, PlanSettings, plan};
use gelenk_identification::robot::Robot;

/// Two joints of a parallelogram, and the forearm that follows both.
fn robot(forearm: &str) -> String {
    format!(
        r#"
name = "parallelogram"

[[joints]]
name = "arm"
parent = "base"
axis = [0, 1, 0]
limits = {{ position = [-1, 1], velocity = 2, effort = 100 }}
drive = "ideal"

[[joints]]
name = "crank"
parent = "base"
axis = [0, 1, 0]
limits = {{ position = [-0.5, 1.5], velocity = 3, effort = 100 }}
drive = "ideal"

[[joints]]
name = "forearm"
parent = "arm"
origin = {{ xyz = [0, 0, 0.5] }}
axis = [0, 1, 0]
{forearm}

[[bodies]]
link = "arm"
mass = 4
center_of_mass = [0, 0, 0.25]
inertia = [0.1, 0.1, 0.01]

[[bodies]]
link = "crank"
mass = 1
center_of_mass = [0.1, 0, 0]
inertia = [0.01, 0.01, 0.01]

[[bodies]]
link = "forearm"
mass = 3
center_of_mass = [0.2, 0, 0]
inertia = [0.01, 0.05, 0.05]
"#
    )
}

fn planned(forearm: &str) -> (Plan, InterpretedRobot) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("robot.toml");
    fs::write(&file, robot(forearm)).unwrap();
    let model = read::read(&file, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).model;
    let robot = InterpretedRobot::new(&model).unwrap();
    let excitation =
        Excitation { period: 10.0, harmonics: 3, samples: 60, starts: 2, iterations: 40, seed: 1 };
    let settings = PlanSettings { excitation, ..PlanSettings::default() };
    (plan(&robot, &settings, &mut |_| {}).unwrap(), robot)
}

/// The least and the largest value over a planned motion of y or v.
fn range(plan: &Plan, which: usize, value: impl Fn(&[f64]) -> f64) -> [f64; 2] {
    let step = plan.motion.period / 60.0;
    let values = (0..60).map(|k| value(&plan.motion.instant(step * f64::from(k))[which]));
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

#[test]
fn a_planned_motion_keeps_the_limits_of_a_joint_that_follows_several() {
    let forearm = |of: &[f64]| of[1] - of[0];
    let follows = "follows = { crank = 1, arm = -1 }";
    let (free, _) = planned(follows);
    let [low, high] = range(&free, 0, forearm);
    assert!(low < -0.3 && high > 0.9, "{low} {high}");
    let (kept, robot) = planned(&format!("{follows}\nlimits = {{ position = [-0.2, 0.8], velocity = 0.5 }}"));
    let [low, high] = range(&kept, 0, forearm);
    assert!(low >= -0.2 - 1e-8 && high <= 0.8 + 1e-8 && high - low > 0.3, "{low} {high}");
    let [low, high] = range(&kept, 1, forearm);
    assert!(low >= -0.35 - 1e-8 && high <= 0.35 + 1e-8, "seven tenths of the speed: {low} {high}");
    let [follower] = &robot.followers()[..] else { panic!("{:?}", robot.followers()) };
    assert_eq!((follower.name.as_str(), &follower.ratios[..]), ("forearm", &[-1.0, 1.0][..]));
}

#[test]
fn a_planned_motion_keeps_the_limits_of_a_joint_that_follows_one() {
    let limits = "limits = { position = [-1, 0.6], velocity = 1 }";
    let (kept, _) = planned(&format!("follows = {{ crank = -2 }}\noffset = 0.2\n{limits}"));
    // 0.2 − 2 y within −1 … 0.6 is y within −0.2 … 0.6, of which nine tenths are used.
    let [low, high] = range(&kept, 0, |y| y[1]);
    assert!(low >= -0.16 - 1e-9 && high <= 0.56 + 1e-9 && high - low > 0.4, "{low} {high}");
    let [_, fastest] = range(&kept, 1, |v| v[1].abs());
    assert!(fastest <= 0.35 + 1e-9, "{fastest}");
}

/// Messages about a description, and the generated module.
fn generated(description: &str) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), description).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let arguments = ["generate", "robot.toml", "--functions", "mass_matrix", "--output", "robot.rs"];
    let output = program.current_dir(folder.path()).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    (said, fs::read_to_string(folder.path().join("robot.rs")).unwrap())
}

/// Words without their line breaks.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_module_has_the_ratios_to_driven_joints() {
    let text = robot("follows = { crank = 1, arm = -2 }\nlimits = { position = [-0.2, 0.8] }");
    let driven = text.replacen("drive = \"ideal\"", "motion = \"driven\"", 1);
    let (said, module) = generated(&driven);
    assert!(module.contains("DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[1.0]];"), "{module}");
    assert!(module.contains("DEPENDENT_DRIVEN_RATIOS: [[f64; 1]; 1] = [[-2.0]];"), "{module}");
    assert!(
        flat(&said).contains(
            "Predictive controllers report that they do not enforce limits that depend on driven joints"
        ),
        "{said}"
    );
    let (_, module) = generated(&text);
    assert!(module.contains("DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[-2.0, 1.0]];"), "{module}");
    assert!(!module.contains("DEPENDENT_DRIVEN_RATIOS"), "{module}");
}

#[test]
fn what_keeps_limits_is_said() {
    let limits = "limits = { position = [-0.2, 0.8] }";
    let (said, _) = generated(&robot(&format!("follows = {{ crank = 1, arm = -1 }}\n{limits}")));
    assert!(
        flat(&said).contains("Predictive controllers keep them with rows from `MpcRow::of_limits`"),
        "{said}"
    );
    let (said, _) = generated(&robot(&format!("follows = {{ crank = 1 }}\n{limits}")));
    assert!(flat(&said).contains("narrows the limits of the followed joint"), "{said}");
    let free = format!("follows = {{ crank = {{ free = 0.5, name = \"ratio\" }} }}\n{limits}");
    let (said, module) = generated(&robot(&free));
    assert!(flat(&said).contains("warning[limits-not-kept]: no controller keeps the limits"), "{said}");
    assert!(flat(&said).contains("because their ratios depend on free parameters: `forearm`"), "{said}");
    assert!(!module.contains("DEPENDENT_JOINT_RATIOS"), "{module}");
    let (said, _) =
        generated(&robot("follows = { crank = 1 }\nlimits = { position = [-2, 2], velocity = 3 }"));
    assert!(!said.contains("limits"), "the coordinates keep these: {said}");
}

/// Rows of joints whose ratios are free parameters would hold no numbers: they are left out, under all names of rows alike.
#[test]
fn joints_with_free_ratios_have_no_rows() {
    let limits = "limits = { position = [-0.2, 0.8] }";
    let more = "[[joints]]\nname = \"idler\"\nparent = \"arm\"\nfollows = { crank = 2 }\noffset = 0.1\nlimits = { velocity = 9 }\n";
    let free = format!("follows = {{ crank = {{ free = 0.5, name = \"ratio\" }} }}\n{limits}\n{more}");
    let (said, module) = generated(&robot(&free));
    assert!(!said.contains("keep them"), "nothing keeps limits of free ratios, which a warning says: {said}");
    for constant in [
        "FOLLOWER_NAMES: [&str; 2] = [\"forearm\", \"idler\"];",
        "DEPENDENT_JOINT_NAMES: [&str; 1] = [\"idler\"];",
        "DEPENDENT_JOINT_RATIOS: [[f64; N]; 1] = [[0.0, 2.0]];",
        "DEPENDENT_JOINT_OFFSETS: [f64; 1] = [0.1];",
        "DEPENDENT_POSITION_LIMITS: [[f64; 2]; 1] = [ [f64::NEG_INFINITY, f64::INFINITY], ];",
        "DEPENDENT_VELOCITY_LIMITS: [f64; 1] = [9.0];",
    ] {
        assert!(flat(&module).contains(constant), "{constant}\n{module}");
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), robot(&free)).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    let line = "generate robot.toml --language c --for acados --functions step,step_derivatives,input_matrix";
    let output = program.current_dir(folder.path()).args(line.split(' ')).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| flat(&fs::read_to_string(folder.path().join(name)).unwrap());
    let header = read("parallelogram.h");
    assert!(header.contains("DEPENDENT_JOINT_NAMES") && !header.to_lowercase().contains("nan"), "{header}");
    let setup = read("parallelogram_acados.py");
    assert!(setup.contains("DEPENDENT_JOINT_RATIOS = np.array([ [0.0, 2.0], ])"), "{setup}");
    assert!(setup.contains("LEFT_OUT = (\"limits of joints that follow others\",)"), "{setup}");
}
