//! Logs with as many faults as possible: whatever they hold, the output of a command is short.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use super::run;

/// Joints of a chain whose axes turn by a right angle from one to the next.
const JOINTS: usize = 6;

fn chain() -> String {
    let mut text = "name = \"chain\"\ngravity = [0, 0, -9.81]\n".to_owned();
    for i in 0..JOINTS {
        let axis = [[0, 0, 1], [0, 1, 0]][i % 2];
        let limits = "limits = { position = [-3, 3], velocity = 2, effort = 20 }";
        writeln!(
            text,
            "[[joints]]\nname = \"j{i}\"\naxis = {axis:?}\norigin = {{ xyz = [0, 0, 0.1] }}\n{limits}"
        )
        .unwrap();
        writeln!(
            text,
            "[[bodies]]\nlink = \"j{i}\"\nmass = 0.4\ncenter_of_mass = [0, 0, 0.05]\ninertia = 0.001"
        )
        .unwrap();
    }
    text
}

fn header(joints: usize) -> String {
    let of = |kind: &str| (0..joints).map(|i| format!(",{kind}{i}")).collect::<String>();
    format!("t{}{}{}", of("q"), of("dq"), of("tau"))
}

/// A log of a chain: each row by its number, time, and a function of joint and phase for position, velocity and effort.
fn log(rows: usize, row: impl Fn(usize, f64, usize) -> [f64; 3], time: impl Fn(usize) -> f64) -> String {
    let mut text = header(JOINTS) + "\n";
    for i in 0..rows {
        let values: Vec<[f64; 3]> = (0..JOINTS).map(|joint| row(i, 0.01 * i as f64, joint)).collect();
        let fields = (0..3).flat_map(|k| values.iter().map(move |of| of[k]));
        let fields: String = fields.map(|x| format!(",{x:.5}")).collect();
        writeln!(text, "{:.5}{fields}", time(i)).unwrap();
    }
    text
}

/// Position, velocity and effort of a joint on its own sine.
fn wave(t: f64, joint: usize) -> [f64; 3] {
    let w = 1.0 + 0.37 * joint as f64;
    [0.4 * (w * t).sin(), 0.4 * w * (w * t).cos(), 2.0 * (w * t).cos() + 0.3 * (7.0 * t + w).sin()]
}

/// Numbers of a seed between -1 and 1 that look like noise.
fn noise(i: usize, joint: usize) -> f64 {
    let x = (12.9898 * i as f64 + 78.233 * joint as f64).sin() * 43_758.545;
    2.0 * (x - x.floor()) - 1.0
}

fn faulty_logs() -> Vec<(&'static str, String)> {
    let usual = |i: usize| 0.01 * i as f64;
    let scaled = |t: f64, joint: usize, factors: [f64; 3]| {
        let of = wave(t, joint);
        [0, 1, 2].map(|k| of[k] * factors[k])
    };
    let each = |t: f64, joint: usize, i: usize| match joint % 6 {
        0 => scaled(t, joint, [1.0, 1.0, 0.0]),
        1 => [0.3, 0.0, wave(t, joint)[2]],
        2 => scaled(t, joint, [1.0, 3.0, 50.0]),
        3 => [noise(i, joint), noise(i + 7, joint), noise(i + 9, joint)],
        4 => [wave(t, joint)[0], wave(t, joint)[1], wave(t, joint)[2].clamp(-0.5, 0.5)],
        _ => scaled(t, joint, [57.3, 57.3, if i.is_multiple_of(90) { 1e6 } else { 1.0 }]),
    };
    vec![
        ("gaps", log(900, |_, t, joint| wave(t, joint), |i| usual(i) + 0.3 * (i / 12) as f64)),
        ("times_back", log(900, |_, t, joint| wave(t, joint), |i| usual(i % 30))),
        ("dead", log(400, |_, t, joint| scaled(t, joint, [1.0, 1.0, 0.0]), usual)),
        ("still", log(400, |_, t, joint| scaled(t, joint, [0.0, 0.0, 1.0]), usual)),
        ("noise", log(400, |i, _, joint| [noise(i, joint), noise(i + 3, joint), noise(i + 5, joint)], usual)),
        ("each_its_own", log(600, |i, t, joint| each(t, joint, i), usual)),
        ("degrees", log(400, |_, t, joint| scaled(t, joint, [57.3, 57.3, 1.0]), usual)),
        ("too_large", log(400, |_, t, joint| scaled(t, joint, [20.0, 20.0, 500.0]), usual)),
        ("held", log(600, |i, _, joint| wave(0.01 * (i / 20 * 20) as f64, joint), usual)),
        ("two_rows", log(2, |_, t, joint| wave(t, joint), usual)),
        ("no_rows", header(JOINTS)),
        ("empty", String::new()),
        ("words", "a report\nwithout a table\n".repeat(500)),
        ("not_numbers", log(300, |_, t, joint| wave(t, joint), usual).replace(",0.", ",x")),
        (
            "holes",
            log(500, |i, t, j| wave(t, j).map(|x| if noise(i, j) > 0.8 { f64::NAN } else { x }), usual),
        ),
        ("other_columns", log(300, |_, t, joint| wave(t, joint), usual).replace("tau", "temperature")),
    ]
}

#[test]
fn any_log_gives_few_lines() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| fs::write(folder.path().join(name), text).unwrap();
    write("chain.toml", chain().as_bytes());
    let identify = |log: &str, more: &[&str]| {
        run(folder.path(), &[&["chain.toml", log, "--output", "found.toml"], more].concat())
    };
    for (name, text) in faulty_logs() {
        let file = format!("{name}.csv");
        write(&file, text.as_bytes());
        let (_, [_, said]) = identify(&file, &[]);
        assert!(!said.contains("internal error"), "{name}: {said}");
        identify(&file, &["--accept-poor"]);
    }
    let bytes: Vec<u8> = (0..40_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    write("bytes.csv", &bytes);
    assert_eq!(identify("bytes.csv", &[]).0, 1);
    assert_many_columns_are_shortened(folder.path());
}

/// More columns than any log has, as they are and asked for.
fn assert_many_columns_are_shortened(folder: &Path) {
    let names: Vec<String> = (0..5000).map(|i| format!("topic_{i}/signal_{}", i % 7)).collect();
    let row = vec!["1"; names.len()].join(",");
    fs::write(folder.join("wide.csv"), format!("{}\n{row}\n{row}\n", names.join(","))).unwrap();
    let (code, [_, said]) = run(folder, &["chain.toml", "wide.csv"]);
    assert!(code == 1 && said.contains("(4960 more)"), "{said}");
    let (code, [line, _]) = run(folder, &["chain.toml", "wide.csv", "--columns", "?"]);
    assert!(code == 1 && line.starts_with("--columns 'time=?") && line.contains("--format json"), "{line}");
}
