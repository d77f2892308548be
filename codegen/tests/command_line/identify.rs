//! Identification by the program: plans, logs, moments, friction.

use super::{gelenk, shown};
use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::model::{FrictionTerm, Model};
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::robot::Robot;
use std::fs;
use std::path::Path;

const ARM: &str = r#"
name = "arm"
gravity = [0, 0, -9.80665]

[[joints]]
name = "shoulder"
axis = [0, 1, 0]
drive = "ideal"
limits = { position = [-2, 2], velocity = 2, effort = 80 }

[[joints]]
name = "elbow"
axis = [0, 1, 0]
origin = { xyz = [0, 0, 0.5] }
drive = { gear_ratio = 100, rotor_inertia = 5e-5 }
limits = { position = [-2, 2], velocity = 3, effort = 40 }

[[bodies]]
link = "shoulder"
mass = 5
center_of_mass = [0, 0, 0.2]
inertia = [0.1, 0.1, 0.01]

[[bodies]]
link = "elbow"
mass = 3
center_of_mass = [0, 0, 0.2]
inertia = [0.05, 0.05, 0.005]
"#;

/// True parameters of the arm.
const TRUTH: &str = r#"
name = "truth"
extends = "arm.toml"

[[joints]]
name = "shoulder"
friction = { viscous = 4, coulomb = { value = 3, slope = 20 } }

[[joints]]
name = "elbow"
drive = { gear_ratio = 100, rotor_inertia = 8e-5 }
friction = { viscous = 1.5 }

[[bodies]]
name = "shoulder"
mass = 6
center_of_mass = [0.03, 0, 0.25]

[[bodies]]
name = "elbow"
mass = 2.2
center_of_mass = [0, 0, 0.26]
"#;

/// Torques of a described arm along a plan, friction included, as sensors with noise would log them.
fn simulated_log(folder: &Path, plan: &str) -> String {
    let mut sensors = Noise(1);
    let mut log = String::from("t [s],q_shoulder [rad],q_elbow [rad],tau_shoulder [N m],tau_elbow [N m]\n");
    let truth = described(folder, "truth.toml");
    for row in plan.lines().skip(1) {
        let values: Vec<f64> = row.split(',').map(|value| value.parse().unwrap()).collect();
        let torque = truth.torques(&values[1..3], &values[3..5], &values[5..7]);
        let counts = [values[1], values[2]].map(|q| (q / 1e-5).round() * 1e-5);
        let [shoulder, elbow] = [torque[0] + 0.1 * sensors.next(), torque[1] + 0.1 * sensors.next()];
        log.push_str(&format!("{},{},{},{shoulder:.4},{elbow:.4}\n", values[0], counts[0], counts[1]));
    }
    log
}

/// Seeded numbers between -1 and 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A robot with its friction.
struct Described(InterpretedRobot, Model);

fn described(folder: &Path, file: &str) -> Described {
    let model = read::read(&folder.join(file), &ReadOptions::default()).unwrap().model;
    Described(InterpretedRobot::new(&model).unwrap(), model)
}

impl Described {
    /// Joint torques at a state and an acceleration.
    fn torques(&self, y: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
        let mut torques = vec![0.0; 2];
        self.0.rigid_forces(y, v, a, &mut torques);
        let joints = self.1.joints().zip(v).zip(&mut torques);
        joints.for_each(|((joint, v), torque)| {
            let sum = |terms: &[FrictionTerm]| -> f64 {
                let term = |term: &FrictionTerm| {
                    term.coefficient.evaluate(&[], 0.0, 0.0) * term.basis.evaluate(&[], 0.0, *v)
                };
                terms.iter().map(term).sum()
            };
            *torque += sum(&joint.friction) + torque.abs() * sum(&joint.load_friction);
        });
        torques
    }
}

/// How far the torques of the description and those of the identified one are off the truth's, in N m rms.
///
/// - `sizes`: of positions, velocities and accelerations
fn torques_off(folder: &Path, sizes: [f64; 3]) -> [f64; 2] {
    let [arm, truth, found] =
        ["arm.toml", "truth.toml", "arm_identified.toml"].map(|file| described(folder, file));
    let mut noise = Noise(7);
    let [mut before, mut after] = [0.0_f64; 2];
    for _ in 0..200 {
        let [y, v, a] = sizes.map(|size| vec![size * noise.next(), size * noise.next()]);
        let [described, true_, found] = [&arm, &truth, &found].map(|robot| robot.torques(&y, &v, &a));
        before += described.iter().zip(&true_).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        after += found.iter().zip(&true_).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    }
    let [before, after] = [before, after].map(|sum| (sum / 400.0).sqrt());
    println!("torques of the description are off by {before} N m rms, of the identified one by {after}");
    [before, after]
}

/// Each friction term has a probability, those that were left out too, in JSON, on the page and in the file.
fn says_how_sure_terms_are(result: &serde_json::Value, folder: &Path) {
    let page = fs::read_to_string(folder.join("page/friction_terms.csv")).unwrap();
    for (joint, viscous) in [(0, 4.0), (1, 1.5)] {
        let terms = result["joints"][joint]["friction_terms"].as_array().unwrap();
        let chosen = |term: &&serde_json::Value| !term["coefficient"].is_null();
        assert!(terms.iter().any(|term| !chosen(&term)), "{terms:#?}");
        let is_share = |x: &serde_json::Value| x.as_f64().is_some_and(|x| (0.0..=1.0).contains(&x));
        assert!(terms.iter().all(|term| is_share(&term["probability"])));
        let of = terms.iter().find(|term| term["term"] == "v").unwrap();
        let end = |k: usize| of["interval"][k].as_f64().unwrap();
        assert!(end(0) < end(1) && (end(0) + end(1) - 2.0 * viscous).abs() < 0.2 * viscous, "{of:#}");
        assert!(of["probability"].as_f64().unwrap() > 0.99, "{of:#}");
        let name = ["shoulder", "elbow"][joint];
        assert_eq!(page.lines().filter(|line| line.starts_with(name)).count(), terms.len(), "{page}");
    }
    let text = fs::read_to_string(folder.join("arm_identified.toml")).unwrap();
    assert!(text.contains(", in the law with a probability of 100 %"), "{text}");
}

/// Masses, centres and moments have two digits of half their intervals or some more, and are those that were found.
fn writes_digits_that_mean_something(result: &serde_json::Value, file: &Path) {
    let text = fs::read_to_string(file).unwrap();
    let parameter = |place: usize| {
        let of = &result["inertial_parameters"][place];
        let end = |k: usize| of["interval"][k].as_f64().unwrap();
        (of["value"].as_f64().unwrap(), 0.5 * (end(1) - end(0)))
    };
    for ((place, name), body) in
        [(0, "shoulder"), (10, "elbow")].into_iter().zip(text.split("[[bodies]]").skip(1))
    {
        assert!(body.contains(&format!("name = \"{name}\"")), "{text}");
        let mass = body.lines().find_map(|line| line.strip_prefix("mass = ")).unwrap();
        let (value, half) = parameter(place);
        assert!((mass.parse::<f64>().unwrap() - value).abs() <= 0.05 * half, "{mass} {value} {half}");
        for number in body.split(['=', '[', ']', ',', '{', '}', '\n']).map(str::trim) {
            let digits = number.split('e').next().unwrap().trim_start_matches(['0', '.', '-']);
            let is_number = number.parse::<f64>().is_ok();
            assert!(!is_number || digits.chars().filter(char::is_ascii_digit).count() <= 7, "{body}");
        }
    }
}

#[test]
fn a_plan_begins_where_the_robot_stands() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("arm.toml"), ARM).unwrap();
    let plan = |start: &[&str]| {
        let arguments =
            ["identify", "--plan", "arm.toml", "--rate", "100", "--seconds", "8", "--format", "json"];
        gelenk(folder.path(), &[&arguments[..], start].concat())
    };
    let rows = |output: &std::process::Output| -> (serde_json::Value, Vec<Vec<f64>>) {
        assert!(output.status.success(), "{}", shown(output));
        let text = fs::read_to_string(folder.path().join("plan.csv")).unwrap();
        let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect();
        (serde_json::from_slice(&output.stdout).unwrap(), text.lines().skip(1).map(row).collect())
    };
    let (_, alone) = rows(&plan(&[]));
    let (said, from) = rows(&plan(&["--start", "elbow=-0.2, shoulder=0.3"]));
    assert_eq!(from[0], [0.0, 0.3, -0.2, 0.0, 0.0, 0.0, 0.0]);
    let lead = from.len() - alone.len();
    let seconds = said["approach"]["seconds"].as_f64().unwrap();
    assert!(seconds > 0.1 && (0.0..0.01 + 1e-9).contains(&(0.01 * lead as f64 - seconds)), "{said:#}");
    for (row, motion) in from[lead..].iter().zip(&alone) {
        assert_eq!(row[1..], motion[1..]);
    }
    for pair in from.windows(2) {
        assert!((pair[1][0] - pair[0][0] - 0.01).abs() < 1e-9);
        for joint in [1, 2] {
            let slope = (pair[1][joint] - pair[0][joint]) / 0.01;
            assert!((slope - 0.5 * (pair[0][joint + 2] + pair[1][joint + 2])).abs() < 0.01, "{pair:?}");
        }
    }
    for (start, reason) in [
        ("shoulder=0.3", "add the positions of elbow"),
        ("shoulder=0.3,wrist=1", "there is no joint 'wrist'. The joints are shoulder, elbow"),
        ("shoulder=0.3,elbow=up", "'elbow=up' needs a number"),
        ("shoulder=1,shoulder=2", "joint shoulder is given twice"),
        ("shoulder=99,elbow=0", "start of joint shoulder = 99 is not possible"),
    ] {
        let refused = plan(&["--start", start]);
        assert!(!refused.status.success() && shown(&refused).contains(reason), "{}", shown(&refused));
    }
}

#[test]
fn a_planned_motion_identifies_what_a_simulated_arm_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("arm.toml"), ARM).unwrap();
    fs::write(at("truth.toml"), TRUTH).unwrap();
    let planned = gelenk(folder.path(), &["identify", "--plan", "arm.toml", "--rate", "200"]);
    assert!(planned.status.success(), "{}", shown(&planned));
    let log = simulated_log(folder.path(), &fs::read_to_string(at("plan.csv")).unwrap());
    fs::write(at("log.csv"), log).unwrap();
    let arguments = ["identify", "arm.toml", "log.csv", "--report", "page", "--format", "json"];
    let identified = gelenk(folder.path(), &arguments);
    assert!(identified.status.success(), "{}", shown(&identified));
    let result: serde_json::Value = serde_json::from_slice(&identified.stdout).unwrap();
    for joint in result["joints"].as_array().unwrap() {
        assert!(joint["r_squared_held_out"].as_f64().unwrap() > 0.999, "{result:#}");
    }
    assert!(at("page/index.html").exists());
    says_how_sure_terms_are(&result, folder.path());
    writes_digits_that_mean_something(&result, &at("arm_identified.toml"));
    let [before, after] = torques_off(folder.path(), [1.2, 1.0, 3.0]);
    assert!(before > 2.0 && after < 0.1);
    // A joint whose efforts cannot be used is named with its row, the other goes on, and the file says so.
    let log = fs::read_to_string(at("log.csv")).unwrap();
    let without = log.lines().enumerate().map(|(i, line)| match (i, line.rsplit_once(',')) {
        (1.., Some((rest, _))) => format!("{rest},0\n"),
        _ => format!("{line}\n"),
    });
    fs::write(at("without.csv"), without.collect::<String>()).unwrap();
    let arguments = ["identify", "arm.toml", "without.csv", "--output", "half.toml", "--report", "half"];
    let half = gelenk(folder.path(), &arguments);
    assert!(half.status.success(), "{}", shown(&half));
    for text in [fs::read_to_string(at("half.toml")).unwrap(), String::from_utf8(half.stdout).unwrap()] {
        assert!(text.contains("its effort is 0 in every row from row 2 on"), "{text}");
        assert!(
            text.contains("it has no measured effort, or only currents while it rests. Its friction, drive and offset stay as described"),
            "{text}"
        );
    }
    // What was noticed in a log is said also where an error follows.
    let (header, rows) = log.split_once('\n').unwrap();
    let first = rows.lines().next().unwrap();
    fs::write(at("repeated.csv"), format!("{header}\n{first}\n{rows}")).unwrap();
    let arguments =
        ["identify", "arm.toml", "repeated.csv", "--validate", "missing.csv", "--output", "x.toml"];
    let failed = gelenk(folder.path(), &arguments);
    let said = String::from_utf8(failed.stderr.clone()).unwrap();
    let place = |words: &str| said.find(words).unwrap_or_else(|| panic!("{words}: {said}"));
    assert!(
        place("1 sample has the same time as the sample before")
            < place("error[unusable-input]: missing.csv"),
        "{said}"
    );
    assert_eq!(failed.status.code(), Some(1));
    // Once more over its own output, never over what was read.
    assert!(gelenk(folder.path(), &["identify", "arm.toml", "log.csv"]).status.success());
    for kept in ["arm.toml", "log.csv"] {
        let refused = gelenk(folder.path(), &["identify", "arm.toml", "log.csv", "--output", kept]);
        assert_eq!(refused.status.code(), Some(1), "{}", shown(&refused));
    }
    assert_eq!(fs::read_to_string(at("arm.toml")).unwrap(), ARM);
}

#[test]
fn friction_under_load_is_identified_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("arm.toml"), ARM).unwrap();
    let friction =
        "friction = { viscous = 1.5, coulomb = { value = 1, slope = 20 }, load = \"0.15*tanh(20*v)\" }";
    fs::write(at("truth.toml"), TRUTH.replace("friction = { viscous = 1.5 }", friction)).unwrap();
    fs::write(at("log.csv"), simulated_log(folder.path(), &motion(1))).unwrap();
    let run = |arguments: &[&str]| {
        let all: Vec<&str> = ["identify", "arm.toml"].iter().chain(arguments).copied().collect();
        let output = gelenk(folder.path(), &all);
        assert!(output.status.success(), "{}", shown(&output));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let plain = run(&["log.csv", "--output", "plain.toml", "--format", "json"]);
    let findings = plain["findings"].as_array().unwrap();
    let load = findings.iter().find(|finding| finding["code"] == "friction-under-load").unwrap();
    assert_eq!(load["help"], "use --load-friction");
    assert!((load["values"][0]["value"].as_f64().unwrap() - 0.15).abs() < 0.05, "{load:#}");
    assert!(plain["joints"][1]["load_friction"].is_null());
    let found = run(&["log.csv", "--load-friction", "--output", "load.toml", "--format", "json"]);
    let share = &found["joints"][1]["load_friction"]["coefficient"];
    let [value, error] = ["value", "standard_error"].map(|key| share[key].as_f64().unwrap());
    println!("{value} ± {error} of the load is friction, 0.15 is true");
    assert!((value - 0.15).abs() < 4.0 * error && error < 0.015, "{found:#}");
    assert!(found["joints"][1]["friction"].as_str().unwrap().contains("abs(load)"), "{found:#}");
    let text = fs::read_to_string(at("load.toml")).unwrap();
    assert!(text.contains("--load-friction") && text.contains("load = [[\"tanh("), "{text}");
    // The written file is read again, and its torques are nearer to the truth's.
    let truth = described(folder.path(), "truth.toml");
    let mut errors = ["plain.toml", "load.toml"].map(|file| {
        let robot = described(folder.path(), file);
        let mut noise = Noise(7);
        let errors = (0..300).flat_map(|_| {
            let [y, v, a] = [1.0, 1.0, 2.0].map(|size| vec![size * noise.next(), size * noise.next()]);
            let pairs = robot.torques(&y, &v, &a).into_iter().zip(truth.torques(&y, &v, &a));
            pairs.map(|(found, truth)| (found - truth).powi(2)).collect::<Vec<_>>()
        });
        (errors.sum::<f64>() / 600.0).sqrt()
    });
    println!("torques are off by {} N m rms without the load's share, by {} with it", errors[0], errors[1]);
    errors[0] *= 0.5;
    assert!(errors[1] < errors[0], "{errors:?}");
    let refused = ["identify", "arm.toml", "--reduce", "log.csv", "--load-friction", "--output", "x.moments"];
    assert_eq!(gelenk(folder.path(), &refused).status.code(), Some(2));
}

/// A motion as a plan has it: sines with phases of their own.
fn motion(number: u32) -> String {
    let mut plan = String::from("t,q_shoulder,q_elbow,dq_shoulder,dq_elbow,ddq_shoulder,ddq_elbow\n");
    for i in 0..800 {
        let t = 0.01 * f64::from(i);
        let at = |shape: &dyn Fn(f64, f64) -> f64| {
            [[0.6, 1.3, 0.3, 3.7], [0.7, 1.9, 0.25, 4.3]].map(|[a, w, b, u]| {
                let phase = f64::from(number);
                a * shape(w, w * t + phase) + b * shape(u, u * t + 2.0 * phase)
            })
        };
        let [y, v, a] = [at(&|_, x| x.sin()), at(&|w, x| w * x.cos()), at(&|w, x| -w * w * x.sin())];
        plan.push_str(&format!("{t},{},{},{},{},{},{}\n", y[0], y[1], v[0], v[1], a[0], a[1]));
    }
    plan
}

#[test]
fn logs_reduce_to_moments_and_moments_to_a_description() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let succeeds = |arguments: &[&str]| {
        let output = gelenk(folder.path(), arguments);
        assert!(output.status.success(), "{}", shown(&output));
        output
    };
    let refused = |code: i32, arguments: &[&str]| {
        let output = gelenk(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(code), "{}", shown(&output));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    fs::write(at("arm.toml"), ARM).unwrap();
    fs::write(at("truth.toml"), TRUTH).unwrap();
    for number in 1..=3 {
        fs::write(at(&format!("{number}.csv")), simulated_log(folder.path(), &motion(number))).unwrap();
        let (log, moments) = (format!("{number}.csv"), format!("{number}.moments"));
        let output = succeeds(&["identify", "arm.toml", "--reduce", &log, "--output", &moments]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.starts_with(&format!("wrote {moments}: 1 log, ")), "{text}");
    }
    // In any order, by a tree, and in one process: the same bytes.
    let bytes = |name: &str| fs::read(at(name)).unwrap();
    succeeds(&["identify", "arm.toml", "--merge", "3.moments", "1.moments", "--output", "two.moments"]);
    succeeds(&["identify", "arm.toml", "--merge", "2.moments", "two.moments", "--output", "tree.moments"]);
    succeeds(&["identify", "arm.toml", "--reduce", "1.csv", "2.csv", "3.csv", "--output", "one.moments"]);
    assert_eq!(bytes("tree.moments"), bytes("one.moments"));
    let merge = |files: &[&str], output: &str| {
        let arguments = ["identify", "arm.toml", "--merge"].iter().chain(files).copied();
        let all: Vec<&str> =
            arguments.chain(["--output", output, "--report", "page", "--format", "json"]).collect();
        serde_json::from_slice::<serde_json::Value>(&succeeds(&all).stdout).unwrap()
    };
    let result = merge(&["1.moments", "2.moments", "3.moments"], "arm_identified.toml");
    let first = bytes("arm_identified.toml");
    merge(&["tree.moments"], "arm_identified.toml");
    assert_eq!(bytes("arm_identified.toml"), first);
    for joint in result["joints"].as_array().unwrap() {
        assert!(joint["r_squared_held_out"].as_f64().unwrap() > 0.99, "{result:#}");
    }
    let page = String::from_utf8(bytes("page/index.html")).unwrap();
    assert!(page.contains("Files of moments do not contain samples") && !page.contains("NaN"));
    // The description is one: it reads, and says what the arm is.
    let [before, after] = torques_off(folder.path(), [1.0, 1.5, 3.0]);
    assert!(before > 2.0 && after < 0.3);
    // What does not fit is refused.
    fs::write(at("copy.csv"), bytes("1.csv")).unwrap();
    let twice =
        refused(1, &["identify", "arm.toml", "--reduce", "1.csv", "copy.csv", "--output", "x.moments"]);
    assert!(twice.contains("1.csv") && twice.contains("copy.csv"), "{twice}");
    let twice = refused(1, &["identify", "arm.toml", "--merge", "1.moments", "two.moments"]);
    assert!(
        twice.contains("1.moments") && twice.contains("two.moments") && twice.contains("1.csv"),
        "{twice}"
    );
    let method = refused(
        2,
        &["identify", "arm.toml", "--merge", "1.moments", "--output", "x.moments", "--method", "lasso"],
    );
    assert!(method.contains("--method needs an identification"), "{method}");
    let other = refused(1, &["identify", "truth.toml", "--merge", "1.moments", "--output", "x.toml"]);
    assert!(other.contains("another description"), "{other}");
    let log = refused(1, &["identify", "arm.toml", "--merge", "1.csv", "--output", "x.toml"]);
    assert!(log.contains("is not a file of moments"), "{log}");
    let kept = refused(1, &["identify", "arm.toml", "--merge", "1.moments", "--output", "1.moments"]);
    assert!(kept.contains("is not overwritten"), "{kept}");
    fs::write(at("arm.toml"), ARM.replace("mass = 5", "mass = 5.5")).unwrap();
    let changed = refused(1, &["identify", "arm.toml", "--merge", "1.moments", "--output", "x.toml"]);
    assert!(changed.contains("files that have changed since"), "{changed}");
    // Usage.
    for arguments in [
        vec!["identify", "arm.toml", "--reduce", "1.csv"],
        vec!["identify", "arm.toml", "--reduce", "1.csv", "--output", "x.toml"],
        vec!["identify", "arm.toml", "--merge", "1.moments", "--delay", "0"],
        vec!["identify", "arm.toml", "--merge", "1.moments", "--output", "x.moments", "--report", "page"],
        vec!["identify", "arm.toml", "--merge", "--reduce", "1.moments", "--output", "x.moments"],
    ] {
        refused(2, &arguments);
    }
    assert!(!at("x.moments").exists() && !at("x.toml").exists());
}
