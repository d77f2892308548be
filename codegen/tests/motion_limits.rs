//! Speeds of motors, and lengths and speeds of forces between frames, as limits of what follows from them.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::model::Limits;
use gelenk_codegen::read::{self, Loaded, ReadOptions};
use gelenk_identification::robot::Robot;

/// A boom that a cylinder lifts, and a wrist behind it.
fn robot(boom: &str, cylinder: &str, more: &str) -> String {
    format!(
        r#"
name = "crane"

[[joints]]
name = "boom"
axis = [0, -1, 0]
{boom}

[[joints]]
name = "pitch"
axis = [0, 1, 0]
origin = {{ xyz = [2, 0, 0] }}
drive = "none"

[[joints]]
name = "roll"
axis = [1, 0, 0]
drive = "none"

[[bodies]]
link = "boom"
mass = 60
center_of_mass = [1.2, 0, 0]
inertia = [0.5, 30, 30]

[[bodies]]
link = "pitch"
mass = 2
inertia = 0.01

[[bodies]]
link = "roll"
mass = 2
inertia = 0.01

[[frames]]
name = "foot"
link = "base"
origin = {{ xyz = [0, 0, -0.6] }}

[[frames]]
name = "rod"
link = "boom"
origin = {{ xyz = [0.9, 0, 0] }}

[[forces]]
between = ["foot", "rod"]
{cylinder}
{more}
"#
    )
}

fn loaded(description: &str) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("robot.toml");
    fs::write(&file, description).unwrap();
    read::read(&file, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn limits(loaded: &Loaded, joint: &str) -> Limits {
    loaded.model.joints().find(|found| found.name == joint).unwrap().limits
}

/// Law of cosines: the boom's angle counts from the horizontal, the foot stands below its joint.
fn length(y: f64) -> f64 {
    (0.9_f64.powi(2) + 0.6_f64.powi(2) + 2.0 * 0.9 * 0.6 * y.sin()).sqrt()
}

fn rate(y: f64) -> f64 {
    0.9 * 0.6 * y.cos() / length(y)
}

const RANGE: &str = "limits = { position = [-0.3, 1.3], velocity = 2 }\ndrive = \"none\"";

#[test]
fn a_stroke_narrows_the_joint_that_it_follows() {
    let found = loaded(&robot(RANGE, "input = \"cylinder\"\nstroke = [1.1, 1.4]", ""));
    let [low, high] = limits(&found, "boom").position.unwrap();
    let lengths = [length(low), length(high)];
    assert!(
        (1.1..1.1 + 1e-6).contains(&lengths[0]) && (1.4 - 1e-6..=1.4).contains(&lengths[1]),
        "{lengths:?}"
    );
    assert_eq!(limits(&found, "boom").velocity, Some(2.0));
    let said = found.notes.to_string();
    assert!(said.contains("the stroke of `cylinder` limits joint `boom` to positions"), "{said}");
    // An end that the joint does not reach stays, to the letter.
    let found = loaded(&robot(RANGE, "law = \"40*dl\"\nstroke = [1.0, 1.4]", ""));
    let joint = limits(&found, "boom").position.unwrap();
    assert!(length(-0.3) < 1.0 && joint[0] > -0.3 && joint[1] == high, "{joint:?}");
    let found = loaded(&robot(RANGE, "law = \"40*dl\"\nstroke = [0.1, 1.4]", ""));
    assert_eq!(limits(&found, "boom").position, Some([-0.3, high]));
    // A stroke that is shorter than the grid on which it is looked for.
    let found = loaded(&robot(RANGE, "law = \"40*dl\"\nstroke = [1.2, 1.2003]", ""));
    let [low, high] = limits(&found, "boom").position.unwrap();
    assert!(low < high && length(low) >= 1.2 && length(high) <= 1.2003, "{low} {high}");
}

/// Foot, joint and rod stand in one line at ±π/2: there the derivative of the law of cosines vanishes.
#[test]
fn a_cylinder_that_alone_moves_a_joint_through_its_dead_centre_is_told() {
    let said = |limits: &str, more: &str| {
        let boom = format!("{limits}\ndrive = \"none\"");
        loaded(&robot(&boom, "input = \"cylinder\"", more)).notes.to_string()
    };
    let within = said("limits = { position = [-0.3, 2] }", "");
    let words =
        "warning[dead-centre]: `cylinder` has a dead centre within the limits of joint `boom`, at 1.57 rad";
    assert!(within.contains(words) && within.contains("robot.toml:7:"), "{within}");
    let both = said("limits = { position = [-2, 2] }", "");
    assert!(both.contains("joint `boom`, at -1.57 rad and 1.57 rad"), "{both}");
    let at_the_end = said("limits = { position = [-0.3, \"pi/2\"] }", "");
    assert!(at_the_end.contains("joint `boom`, at 1.57 rad"), "{at_the_end}");
    let unlimited = said("", "");
    assert!(
        unlimited.contains("of joint `boom`, whose position has no limits, at -1.57 rad and 1.57 rad"),
        "{unlimited}"
    );
    assert!(!said("limits = { position = [-1.5, 1.5] }", "").contains("dead-centre"));
}

/// Between the distances at which a law is looked at it may have a pole, odd or even; steep laws have none.
#[test]
fn a_law_with_a_pole_within_reach_is_refused() {
    let read = |law: &str| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("robot.toml");
        fs::write(&file, robot(RANGE, &format!("law = \"{law}\""), "")).unwrap();
        read::read(&file, &ReadOptions::default()).map(|_| ()).map_err(|said| said.to_string())
    };
    for law in ["900/(l - 1.0123)", "-2/pow(l - 1.0123, 2)"] {
        let said = read(law).unwrap_err();
        assert!(said.contains("is unbounded at l = 1.01 m"), "{said}");
    }
    for law in ["900/(l - 0.3)", "1e4*tanh(1000*(l - 1.0123))", "3*pow(l, 9) + 40*dl", "40*dl"] {
        read(law).unwrap();
    }
}

/// Other programs write the force of a damper with a minus.
#[test]
fn a_law_that_feeds_every_motion_is_told() {
    for (law, is_told) in
        [("-40*dl", true), ("900*(l - 0.4) - 3*tanh(dl)", true), ("40*dl", false), ("900*l", false)]
    {
        let said = loaded(&robot(RANGE, &format!("law = \"{law}\""), "")).notes.to_string();
        assert_eq!(said.contains("warning[driving-force]"), is_told, "{law}: {said}");
    }
}

/// A spring may stand at its dead centre, as those of lids do, and of two cylinders one moves the joint where the other cannot.
#[test]
fn what_something_else_moves_has_no_dead_centre() {
    let boom = "limits = { position = [-2, 2] }\ndrive = \"none\"";
    let second = "[[frames]]\nname = \"behind\"\nlink = \"base\"\norigin = { xyz = [-0.6, 0, 0] }\n\
                  [[forces]]\nbetween = [\"behind\", \"rod\"]\ninput = \"second\"\n";
    let drive = boom.replace("\"none\"", "\"ideal\"");
    for (boom, cylinder, more) in [
        (boom, "law = \"900*(l - 0.4)\"", ""),
        (boom, "input = \"cylinder\"", second),
        (drive.as_str(), "input = \"cylinder\"", ""),
    ] {
        let said = loaded(&robot(boom, cylinder, more)).notes.to_string();
        assert!(!said.contains("dead-centre"), "{said}");
    }
}

#[test]
fn a_length_that_shrinks_is_kept_too() {
    let turned = robot(RANGE, "input = \"cylinder\"\nstroke = [0.75, 1.0]", "")
        .replace("xyz = [0, 0, -0.6]", "xyz = [0, 0, 0.6]");
    let [low, high] = limits(&loaded(&turned), "boom").position.unwrap();
    assert!((length(-low) - 1.0).abs() < 2e-6 && (length(-high) - 0.75).abs() < 2e-6, "{low} {high}");
}

#[test]
fn a_cylinders_speed_holds_at_every_position_of_its_joint() {
    let found = loaded(&robot(RANGE, "input = \"cylinder\"\nspeed = 0.2\nstroke = [1.1, 1.4]", ""));
    let Limits { position, velocity, .. } = limits(&found, "boom");
    let [low, high] = position.unwrap();
    let steepest = (0..=10_000).map(|k| rate(low + (high - low) * f64::from(k) / 1e4)).fold(0.0, f64::max);
    let limit = velocity.unwrap();
    assert!((limit * steepest - 0.2).abs() < 1e-6, "{limit} {steepest}");
    let slow = RANGE.replace("velocity = 2", "velocity = 0.01");
    let found = loaded(&robot(&slow, "input = \"cylinder\"\nspeed = 0.2", ""));
    assert_eq!(limits(&found, "boom").velocity, Some(0.01), "its own limit is narrower");
}

#[test]
fn a_motors_speed_limits_its_joint_by_the_gear() {
    let boom = |speed: &str| {
        let drive = format!("drive = {{ gear_ratio = -160, speed = {speed} }}");
        loaded(&robot(&format!("limits = {{ velocity = 2 }}\n{drive}"), "law = \"40*dl\"", ""))
    };
    let found = boom("240");
    assert_eq!(limits(&found, "boom").velocity, Some(1.5));
    let said = found.notes.to_string();
    assert!(said.contains("motor `boom` limits the speed of joint `boom` to 1.5"), "{said}");
    assert_eq!(limits(&boom("400"), "boom").velocity, Some(2.0));
    // Ratio and weight are one number at a drive that stands apart.
    let drive = "[[drives]]\nname = \"lift\"\non = { pitch = 0.5 }\ngear_ratio = 50\nspeed = 100\n";
    let found = loaded(&robot("drive = \"none\"", "law = \"40*dl\"", drive));
    assert_eq!(limits(&found, "pitch").velocity, Some(4.0));
}

#[test]
fn motors_of_several_joints_have_rows_beside_those_of_joints_that_follow() {
    let drives = "\
        [[drives]]\nname = \"left\"\non = { pitch = 1, roll = 0.5 }\ngear_ratio = 80\nspeed = 300\n\
        [[drives]]\nname = \"right\"\non = { pitch = 1, roll = -0.5 }\ngear_ratio = 80\n";
    let found = loaded(&robot("drive = \"none\"", "law = \"40*dl\"", drives));
    let rows = found.model.dependent(&[]);
    let [left] = &rows[..] else { panic!("{rows:?}") };
    assert_eq!((left.name, left.ratios.as_deref()), ("left", Some(&[0.0, 80.0, 40.0][..])));
    assert_eq!((left.velocity, left.position), (300.0, [f64::NEG_INFINITY, f64::INFINITY]));
    let identified = InterpretedRobot::new(&found.model).unwrap();
    let [planned] = &identified.followers()[..] else { panic!("{:?}", identified.followers()) };
    assert_eq!((planned.name.as_str(), planned.velocity), ("left", 300.0));
}

#[test]
fn one_free_ratio_hides_the_limits_of_its_joint_alone() {
    let follower = |name: &str, ratio: &str| {
        format!(
            "[[joints]]\nname = \"{name}\"\nparent = \"boom\"\nfollows = {{ pitch = {ratio} }}\nlimits = {{ position = [-1, 1] }}\n"
        )
    };
    let more = [follower("known", "2"), follower("unknown", "{ free = 0.5 }")].concat();
    let found = loaded(&robot("drive = \"none\"", "law = \"40*dl\"", &more));
    let rows = found.model.dependent(&[]);
    assert_eq!(rows[0].ratios.as_deref(), Some(&[0.0, 2.0, 0.0][..]));
    assert_eq!((rows[1].name, &rows[1].ratios), ("unknown", &None));
    let said = found.notes.to_string();
    assert!(said.contains("because their ratios depend on free parameters: `unknown`"), "{said}");
}

/// The joints before a cylinder turn both of its ends, and do not change its length.
#[test]
fn cylinders_behind_other_joints_are_kept_too() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/excavator.toml");
    let text = fs::read_to_string(file).unwrap();
    let stick = "input = \"stick_cylinder\"\n";
    let found = loaded(&text.replacen(stick, &format!("{stick}stroke = [0.9, 1.3]\nspeed = 0.25\n"), 1));
    let [low, high] = limits(&found, "stick").position.unwrap();
    // The foot seen from the stick's joint, and the rod, turned about y.
    let length = |y: f64| {
        let (foot, [x, z]) = ([0.75 - 1.75, 0.4], [-0.3, 0.1]);
        (x * y.cos() + z * y.sin() - foot[0]).hypot(z * y.cos() - x * y.sin() - foot[1])
    };
    let mut lengths = [length(low), length(high)];
    lengths.sort_by(f64::total_cmp);
    let [shortest, longest] = lengths;
    assert!(shortest >= 0.9 && longest <= 1.3 && longest - shortest > 0.2, "{lengths:?}");
    assert!(limits(&found, "stick").velocity.unwrap() < 1.2);
    assert_eq!(limits(&found, "boom"), limits(&loaded(&text), "boom"));
}

/// Robots of models/ with limits of motors on two joints, and of a joint that follows two: the rows with which the runtime tests
/// controllers, checks and the loop (`runtime/tests/dependent_limits.rs`), and which plans and checks of logs take.
#[test]
fn limits_of_motors_and_followers_of_the_models_are_rows() {
    let level = "\n[[joints]]\nname = \"level\"\nparent = \"undercarriage\"\naxis = [0, 0, 1]\nfollows = { boom = 1, stick = 1 }\noffset = -1\n\
                 limits = { position = [-0.5, 0.12] }\n\n[[bodies]]\nlink = \"level\"\nmass = 0.1\ninertia = 1e-4\n\n[[forces]]\n";
    let speed = |name: &str, speed: &str| {
        let key = format!("name = \"{name}\"\n");
        (key.clone(), format!("{key}speed = {speed}\n"))
    };
    let cases = [
        ("differential_wrist", speed("left_motor", "350"), vec![0.0, 0.0, 80.0, 80.0], 350.0),
        ("tx40_like", speed("motor_6", "120"), vec![0.0, 0.0, 0.0, 0.0, 32.0, 32.0], 120.0),
        ("scara", speed("screw_nut", "60"), vec![0.0, 0.0, 1.0, -314.159_265_358_979_3, 0.0], 60.0),
        (
            "excavator",
            ("\n[[forces]]\n".to_owned(), level.to_owned()),
            vec![0.0, 1.0, 1.0, 0.0],
            f64::INFINITY,
        ),
    ];
    for (name, (from, to), ratios, velocity) in cases {
        let file = [env!("CARGO_MANIFEST_DIR"), "/../models/", name, ".toml"].concat();
        let text = fs::read_to_string(file).unwrap();
        assert!(text.contains(&from), "{name}");
        let found = loaded(&text.replacen(&from, &to, 1));
        let rows = found.model.dependent(&[]);
        let [row] = &rows[..] else { panic!("{name}: {rows:?}") };
        assert_eq!((row.ratios.as_ref(), row.velocity), (Some(&ratios), velocity), "{name}");
        let robot = InterpretedRobot::new(&found.model).unwrap();
        let [limits] = &robot.followers()[..] else { panic!("{name}: {:?}", robot.followers()) };
        assert_eq!(
            (&limits.ratios, limits.velocity, limits.position),
            (&ratios, velocity, row.position),
            "{name}"
        );
    }
}

/// Sites and bodies of an MJCF may have the same names: `frame` means the site, and `between`, which takes both, is refused.
#[test]
fn a_site_that_is_called_as_another_body_is_no_end_of_a_force() {
    let body = |name: &str, more: &str| {
        format!(
            "<body name=\"{name}\" pos=\"0 0 0.3\"><joint axis=\"0 1 0\"/><geom size=\"0.05\"/>{more}</body>"
        )
    };
    let inner = body("stick", "<site name=\"boom\" pos=\"0.1 0 0.2\"/>");
    let mjcf = format!("<mujoco><worldbody>{}</worldbody></mujoco>", body("boom", &inner));
    let read = |more: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("robot.xml"), &mjcf).unwrap();
        let file = folder.path().join("robot.toml");
        fs::write(&file, format!("extends = \"robot.xml\"\n{more}")).unwrap();
        read::read(&file, &ReadOptions::default()).map_err(|said| said.to_string())
    };
    let said = read("[[forces]]\nbetween = [\"world\", \"boom\"]\nlaw = \"10*l\"\n").unwrap_err();
    assert!(
        said.contains("`boom` is the name of a site on body `stick` and of a body at another place"),
        "{said}"
    );
    let found = read("[[wrenches]]\nname = \"load\"\nframe = \"boom\"\n").unwrap();
    let at = &found.model.wrenches[0].at;
    assert_eq!(found.model.links[at.link].name, "stick");
}
