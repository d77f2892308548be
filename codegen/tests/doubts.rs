//! Probable mistakes in descriptions of mechanisms are reported; descriptions without them give no message.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gelenk_codegen::diagnostic::{Diagnostic, Diagnostics, Severity};
use gelenk_codegen::model::Model;
use gelenk_codegen::pipeline::{GenerateOptions, generate};
use gelenk_codegen::read::{ReadOptions, from_toml};

fn load_onto(text: &str, base: &str) -> Result<(Model, Diagnostics), Diagnostics> {
    let load = &mut |file: &str| match file {
        "base.toml" => Ok((file.to_owned(), base.to_owned())),
        _ => Err(Diagnostic::error("file-unreadable", file).into()),
    };
    from_toml(text, "robot.toml", &ReadOptions::default(), load)
}

/// Messages about a description, with their severities.
fn told(text: &str) -> Vec<(Severity, String)> {
    let (_, notes) = load_onto(text, "").unwrap_or_else(|wrong| panic!("{wrong}"));
    notes.entries().iter().map(|entry| (entry.severity, entry.to_string())).collect()
}

/// The only message.
fn only(text: &str) -> (Severity, String) {
    let mut told = told(text);
    assert_eq!(told.len(), 1, "{told:?}");
    told.remove(0)
}

/// A boom between two cylinders, and a thruster on it.
const BOOM: &str = r#"
[parameters]
lever = 0.0

[[joints]]
name = "boom"
axis = [0, -1, 0]
limits = { position = [0.1, 1.3] }

[[bodies]]
link = "boom"
mass = 60
inertia = [0.5, 30, 30]

[[frames]]
name = "foot"
link = "base"
origin = { xyz = [0.1, 0, -0.6] }

[[frames]]
name = "other_foot"
link = "base"
origin = { xyz = [0.1, 0.4, -0.6] }

[[frames]]
name = "rod"
link = "boom"
origin = { xyz = [0.9, 0, 0] }

[[frames]]
name = "tip"
link = "boom"
origin = { xyz = [2.4, 0, 0] }

[[frames]]
name = "pin"
link = "boom"
origin = { xyz = ["lever", 0, 0] }
"#;

fn boom(more: &str) -> String {
    format!("{BOOM}{more}")
}

const CYLINDER: &str = "[[forces]]\nbetween = [\"foot\", \"rod\"]\ninput = \"cylinder\"\n";

#[test]
fn inputs_that_act_alike_are_noted() {
    assert_eq!(told(&boom(CYLINDER)), []);
    let thruster = "[[inputs]]\nname = \"thruster\"\nframe = \"tip\"\nwrench = [0, 0, 1, 0, 0, 0]\n";
    for second in ["[[forces]]\nbetween = [\"tip\", \"other_foot\"]\ninput = \"thruster\"\n", thruster] {
        let (severity, told) = only(&boom(&[CYLINDER, second].concat()));
        assert_eq!(severity, Severity::Note);
        let words = "[inputs-alike]: inputs `cylinder` and `thruster` have the same effect at every position";
        assert!(told.contains(words), "{told}");
    }
    // On a second joint a thruster moves both, and neither input does what the other does.
    let stick = "[[joints]]\nname = \"stick\"\naxis = [0, -1, 0]\norigin = { xyz = [2.4, 0, 0] }\n\
        [[bodies]]\nlink = \"stick\"\nmass = 20\ninertia = 5\n";
    let thruster =
        thruster.replace("\"tip\"", "\"stick\"").replace("[0, 0, 1, 0, 0, 0]", "[0, 0, 1, 0, 1, 0]");
    assert_eq!(told(&boom(&[stick, CYLINDER, &thruster].concat())), []);
    // A drive next to a cylinder has one note, not two.
    let driven = boom(CYLINDER).replace("axis = [0, -1, 0]", "axis = [0, -1, 0]\ndrive = \"ideal\"");
    assert!(only(&driven).1.contains("note[drive-beside-input]"));
    let driven = driven
        .replace(CYLINDER, "[[inputs]]\nname = \"wind\"\nframe = \"tip\"\nwrench = [0, 0, 1, 0, 0, 0]\n");
    assert!(only(&driven).1.contains("inputs `boom` and `wind` have the same effect"));
}

#[test]
fn springs_between_the_same_points_are_noted() {
    let spring = |name: &str, between: &str| {
        format!("[[forces]]\nname = \"{name}\"\nbetween = [{between}]\nlaw = \"100*(l - 0.5)\"\n")
    };
    let first = spring("spring", r#""foot", "rod""#);
    for (between, alike) in
        [(r#""rod", "foot""#, true), (r#""tip", "foot""#, false), (r#""other_foot", "rod""#, false)]
    {
        let told = told(&boom(&[&first[..], &spring("other", between)].concat()));
        assert_eq!(told.len(), usize::from(alike), "{between}: {told:?}");
        let words =
            "note[forces-alike]: forces `spring` and `other` act between the same points, so they add up";
        assert!(told.iter().all(|(_, told)| told.contains(words)), "{told:?}");
    }
    // A law next to a cylinder is one strut.
    assert_eq!(told(&boom(&[&first[..], CYLINDER].concat())), []);
}

#[test]
fn a_force_that_jumps_with_the_sign_of_its_rate_is_noted() {
    let brake = "[[forces]]\nname = \"brake\"\nbetween = [\"foot\", \"rod\"]\nlaw = \"50*sign(dl)\"\n";
    let (severity, told) = only(&boom(brake));
    assert_eq!(severity, Severity::Note);
    assert!(told.starts_with("note[dry-force]: the force `brake` is discontinuous at dl = 0"), "{told}");
}

/// A lever that is a free parameter may be 0 as it is described.
#[test]
fn an_input_without_effect_at_the_described_parameters_is_a_warning() {
    let input = "[[inputs]]\nname = \"jet\"\nframe = \"pin\"\nwrench = [0, 0, 1, 0, 0, 0]\n";
    let (severity, told) = only(&boom(input));
    assert_eq!(severity, Severity::Warning);
    let words =
        "its wrench at `pin` does no work along any joint at the described values of the free parameters";
    assert!(told.contains(words), "{told}");
    assert_eq!(self::told(&boom(input).replace("lever = 0.0", "lever = 0.2")), []);
}

/// A wrist behind a parallelogram.
fn wrist(follows: &str) -> String {
    let joint = |name: &str, more: &str| {
        format!(
            "[[joints]]\nname = \"{name}\"\naxis = [0, 1, 0]\norigin = {{ xyz = [0, 0, 0.3] }}\n{more}\n\
             [[bodies]]\nlink = \"{name}\"\nmass = 1\ninertia = 0.1\n"
        )
    };
    let rod = "follows = { shoulder = -0.1, elbow = 1 }";
    [joint("shoulder", ""), joint("elbow", ""), joint("rod", rod), joint("hand", follows)].concat()
}

#[test]
fn ways_that_cancel_are_noted() {
    assert_eq!(told(&wrist("follows = { shoulder = -1, elbow = -1 }")), []);
    // In binary 0.1 + 0.2 is not 0.3.
    for follows in ["{ rod = 1, elbow = -1 }", "{ rod = 3, shoulder = 0.3 }"] {
        let told = told(&wrist(&format!("follows = {follows}")));
        let [(severity, told)] = &told[..] else { panic!("{follows}: {told:?}") };
        assert_eq!(*severity, Severity::Note);
        let gone = if follows.contains("elbow") { "elbow" } else { "shoulder" };
        let words = format!(
            "joint `hand` does not move with `{gone}`: the ratios of all paths from `follows` to `{gone}` add up to 0"
        );
        assert!(told.contains(&words), "{told}");
    }
    let drive = "[[drives]]\nname = \"motor\"\non = { rod = 1, elbow = -1 }\n";
    let (_, told) = only(&[&wrist("")[..], drive].concat());
    assert!(
        told.contains("drive `motor` does not move with `elbow`: the ratios of all paths from `on` to `elbow` add up to 0"),
        "{told}"
    );
}

/// The row of a joint has no rest of rounding where ways cancel.
#[test]
fn what_cancels_leaves_nothing() {
    let (model, _) = load_onto(&wrist("follows = { rod = 3, shoulder = 0.3 }"), "").unwrap();
    let coordinates: Vec<usize> = model.followers[1].follows.iter().map(|term| term.coordinate).collect();
    assert_eq!(coordinates, [1]);
}

fn motor(keys: &str, limits: &str) -> String {
    format!(
        "[[joints]]\nname = \"arm\"\naxis = [0, 1, 0]\nlimits = {{ velocity = 3{limits} }}\n\
         drive = {{ gear_ratio = 100, rotor_inertia = 2e-5, stall_torque = 1.2, no_load_speed = 600{keys} }}\n\
         [[bodies]]\nlink = \"arm\"\nmass = 2\ninertia = 0.1\n"
    )
}

#[test]
fn limits_beyond_a_torque_speed_line_are_told() {
    assert_eq!(told(&motor(", torque = 1.2, speed = 600", ", effort = 120")), []);
    for (keys, limits, severity, words) in [
        (
            ", torque = 1.5",
            "",
            Severity::Warning,
            "warning[beyond-stall-torque]: the torque limit of motor `arm` is 1.5 N m, but its stall torque allows at most 1.2 N m",
        ),
        (
            ", torque = { nominal = 0.5, peak = 1.5 }",
            "",
            Severity::Note,
            "note[beyond-stall-torque]: the peak torque limit of motor `arm` is 1.5 N m, but its stall torque allows at most 1.2 N m",
        ),
        (
            ", speed = 700",
            "",
            Severity::Note,
            "note[beyond-no-load-speed]: motor `arm` has no torque at its `no_load_speed` of 600 rad/s, but its `speed` allows 700 rad/s",
        ),
        (
            "",
            ", effort = 150",
            Severity::Note,
            "note[beyond-stall-torque]: joint `arm` has an effort limit of 150 N m, but its motor `arm` gives at most 120 N m, at rest",
        ),
    ] {
        let (found, told) = only(&motor(keys, limits));
        assert_eq!(found, severity);
        assert!(told.contains(words), "{told}");
    }
}

/// Frames of an extension replace those of its base, but for those that the whole still names.
#[test]
fn frames_that_an_extension_needs_stay() {
    let base = boom(&[CYLINDER, "[generate]\nfunctions = [\"frame_tip_pose\", \"mass_matrix\"]\n"].concat());
    let extension = "extends = \"base.toml\"\n[[frames]]\nname = \"tool\"\nlink = \"boom\"\n\
        [[frames]]\nname = \"rod\"\nlink = \"boom\"\norigin = { xyz = [1, 0, 0] }\n";
    let (model, _) = load_onto(extension, &base).unwrap_or_else(|wrong| panic!("{wrong}"));
    let names: Vec<&str> = model.frames.iter().map(|frame| frame.name.as_str()).collect();
    // The cylinder needs `foot`, a function `tip`; nothing needs `other_foot` and `pin`.
    assert_eq!(names, ["foot", "tip", "tool", "rod"]);
    assert_eq!(model.frames[3].pose.translation[0].as_number(), Some(1.0));
    let contact = "[[wrenches]]\nname = \"contact\"\nframe = \"pin\"\n";
    let (model, _) = load_onto(&[extension, contact].concat(), &base).unwrap();
    assert!(model.frames.iter().any(|frame| frame.name == "pin"));
}

/// A help names links that somebody has described, not those between the parts of a joint.
#[test]
fn help_lists_described_links_alone() {
    let hook = "[[joints]]\nname = \"hook\"\ntype = \"universal\"\n[[bodies]]\nlink = \"hook\"\nmass = 1\ninertia = 0.1\n";
    let wrong =
        load_onto(&[hook, "[[wrenches]]\nname = \"pull\"\nframe = \"rope\"\n"].concat(), "").unwrap_err();
    let told = wrong.to_string();
    assert!(told.contains("known names are `base`, `hook`") && !told.contains("hook_x"), "{told}");
}

/// A part of an origin that an extension does not name stays, as those of limits do.
#[test]
fn an_origin_keeps_the_part_that_is_not_named() {
    let base = "[[joints]]\nname = \"j\"\norigin = { xyz = [1, 2, 3], rpy = [0, 0, 0.5] }\n\
                [[bodies]]\nlink = \"j\"\norigin = { xyz = [4, 5, 6] }\nmass = 1\ninertia = [1, 2, 2.5]\n";
    let on_top = |lines: &str| {
        let text = format!("extends = \"base.toml\"\n{lines}");
        let (model, _) = load_onto(&text, base).unwrap_or_else(|wrong| panic!("{wrong}"));
        let link = &model.links[1];
        let origin = &link.joint.as_ref().unwrap().origin;
        let number = |formula: &gelenk_codegen::formula::Formula| formula.evaluate(&[], 0.0, 0.0);
        let center = link.bodies[0].center_of_mass.each_ref().map(number);
        (origin.translation.each_ref().map(number), origin.rotation[1][0], center)
    };
    let (place, turn, center) = on_top("");
    assert_eq!((place, center), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
    let joint = |origin: &str| on_top(&format!("[[joints]]\nname = \"j\"\norigin = {origin}\n"));
    assert_eq!(joint("{ xyz = [7, 8, 9] }"), ([7.0, 8.0, 9.0], turn, center));
    assert_eq!(joint("{ rpy = [0, 0, 0] }"), (place, 0.0, center));
    assert_eq!(joint("{ xyz = [0, 0, 0], rpy = [0, 0, 0] }"), ([0.0; 3], 0.0, center));
    let body = on_top("[[bodies]]\nname = \"j\"\norigin = { rpy = [0, 0, 1] }\n");
    assert_eq!(body, (place, turn, center));
}

#[test]
fn springs_and_inertias_that_are_hardly_meant_are_told() {
    let arm = |spring: &str, inertia: &str| {
        format!(
            "[[joints]]\nname = \"j\"\n{spring}\n[[bodies]]\nlink = \"j\"\nmass = 1\ninertia = {inertia}\n"
        )
    };
    assert_eq!(told(&arm("spring = { stiffness = 5, rest = 0.1, damping = 1 }", "2000")), []);
    let (severity, said) = only(&arm("spring = { stiffness = -5 }", "1"));
    assert_eq!(severity, Severity::Warning);
    assert!(
        said.contains(
            "the spring of `j` has negative stiffness -5, so it pushes away from its rest position"
        ),
        "{said}"
    );
    let (severity, said) = only(&arm("", "100000"));
    assert_eq!(severity, Severity::Note);
    assert!(said.contains("`j` of 1 kg has 100000 kg m², a radius of gyration of 316 m"), "{said}");
}

/// The option is for the joints of other files.
#[test]
fn joints_that_follow_by_the_description_do_so_all_the_same() {
    let text = "[[joints]]\nname = \"a\"\n[[joints]]\nname = \"b\"\nfollows = { a = 1 }\n\
                [[bodies]]\nlink = \"a\"\nmass = 1\ninertia = 1\n[[bodies]]\nlink = \"b\"\nmass = 1\ninertia = 1\n";
    let told = |ignore_mimic: bool| {
        let options = ReadOptions { ignore_mimic, ..ReadOptions::default() };
        let load = &mut |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
        from_toml(text, "robot.toml", &options, load).unwrap().1.to_string()
    };
    assert_eq!(told(false), "");
    assert!(
        told(true).contains("these joints still follow other joints, because `follows` is given: `b`"),
        "{}",
        told(true)
    );
}

/// A ball of 0.02 kg m² with 0.3 N m s/rad slows down at 15 1/s; two of three hinges that nearly share an axis said 2700.
#[test]
fn the_rate_of_a_damped_ball_is_that_of_its_inertia() {
    let stiff = |damping: f64| {
        stiffness(&format!(
            "[[joints]]\nname = \"top\"\ntype = \"spherical\"\nspring = {{ rx = {{ damping = {damping} }} }}\n\
             [[bodies]]\nlink = \"top\"\nmass = 3\ninertia = 0.02\n"
        ))
    };
    assert_eq!(stiff(0.3), None);
    let said = stiff(30.0).unwrap();
    assert!(
        said.contains(
            "friction, dampers and springs give the motion of `top_rx` an eigenvalue of magnitude 1500 1/s at standstill"
        ),
        "{said}"
    );
    assert!(said.contains("reduce the slopes of friction, damping"), "{said}");
}

/// Message about stiff forces of a robot.
fn stiffness(text: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, text).unwrap();
    let options = GenerateOptions { functions: vec!["step".to_owned()], ..GenerateOptions::default() };
    let notes = generate(&path, &options).unwrap().notes;
    notes.entries().iter().find(|entry| entry.code == "stiff-friction").map(ToString::to_string)
}

/// NumPy: of M = diag(0.2, 0.1) kg m² and F = 1e4 · 𝟙𝟙ᵀ N m s/rad the rate is 150 000 1/s; of a spring of k N/m, 0.5 m from the
/// hinge and at a right angle to it, √(0.25 k / M).
#[test]
fn stiff_forces_are_noted_wherever_they_are_described() {
    let two = "[[joints]]\nname = \"a\"\naxis = [0, 1, 0]\n[[joints]]\nname = \"b\"\n[[drives]]\nname = \"m\"\n\
               on = { a = 1, b = 1 }\ngear_ratio = 100\nfriction = { viscous = 1 }\n\
               [[bodies]]\nlink = \"a\"\nmass = 1\ninertia = 0.1\n[[bodies]]\nlink = \"b\"\nmass = 1\ninertia = 0.1\n";
    let said = stiffness(two).unwrap();
    assert!(said.contains("the motion of `b` an eigenvalue of magnitude 150000 1/s"), "{said}");
    assert!(said.contains("unstable for periods longer than 0.0186 ms"), "{said}");
    let spring = |law: &str| {
        stiffness(&format!(
            "[[joints]]\nname = \"a\"\nlimits = {{ position = [-1e-3, 1e-3] }}\n[[frames]]\nname = \"tip\"\nlink = \"a\"\n\
             origin = {{ xyz = [0.5, 0, 0] }}\n[[frames]]\nname = \"foot\"\nlink = \"base\"\norigin = {{ xyz = [0.5, -1, 0] }}\n\
             [[forces]]\nname = \"s\"\nbetween = [\"tip\", \"foot\"]\nlaw = \"{law}\"\n\
             [[bodies]]\nlink = \"a\"\nmass = 1\ninertia = 0.25\n"
        ))
    };
    let said = spring("4e6*(l - 1)").unwrap();
    assert!(said.contains("an eigenvalue of magnitude 2000 1/s"), "{said}");
    let said = spring("2000*dl").unwrap();
    assert!(said.contains("an eigenvalue of magnitude 2000 1/s"), "{said}");
    assert_eq!(spring("100*(l - 1) + 10*dl"), None);
}

/// Each is used as described, and probably a mistake.
#[test]
fn values_that_are_probably_mistakes_are_warnings() {
    let body = "[[bodies]]\nlink = \"j\"\nmass = 1\ninertia = 1\n";
    for (code, text) in [
        ("limits-equal", format!("[[joints]]\nname = \"j\"\nlimits = {{ position = [1, 1] }}\n{body}")),
        ("unused-parameter", format!("[parameters]\nm = 2\n[[joints]]\nname = \"j\"\n{body}")),
        ("motor-constant", format!("[[joints]]\nname = \"j\"\ndrive = {{ motor_constant = -1 }}\n{body}")),
        (
            "inertia-without-mass",
            format!("[[joints]]\nname = \"j\"\n{}", body.replace("mass = 1", "mass = 0")),
        ),
    ] {
        let (severity, message) = only(&text);
        assert_eq!(severity, Severity::Warning, "{message}");
        assert!(message.starts_with(&format!("warning[{code}]")), "{message}");
        assert!(message.contains("= help"), "{message}");
    }
    let accepted = body.replace("mass = 1", "mass = 0\naccept_unphysical = true");
    assert_eq!(only(&format!("[[joints]]\nname = \"j\"\n{accepted}")).0, Severity::Note);
}

/// Two hinges about one axis with one body, a point mass on three parallel hinges, an arm with a point mass alone.
#[test]
fn free_motions_of_a_singular_mass_matrix_are_named() {
    let singular = |text: &str| {
        let told = told(text);
        let found = told.iter().find(|(_, message)| message.starts_with("warning[joints-without-inertia]"));
        found.unwrap_or_else(|| panic!("{told:?}")).1.clone()
    };
    let joint = |name: &str, more: &str| format!("[[joints]]\nname = \"{name}\"\n{more}\n");
    let body = "[[bodies]]\nlink = \"b\"\nmass = 1\ninertia = 1\n";
    let coaxial = singular(&format!("{}{}{body}", joint("a", ""), joint("b", "")));
    assert!(coaxial.contains("no inertia moves with `a` − `b`"), "{coaxial}");
    let point = "[[bodies]]\nlink = \"c\"\nmass = 1\ncenter_of_mass = [0.3, 0, 0]\n";
    let along = "origin = { xyz = [0.4, 0, 0] }";
    let planar = singular(&format!("{}{}{}{point}", joint("a", ""), joint("b", along), joint("c", along)));
    assert!(planar.contains("`a` − ") && planar.contains("`b`") && planar.contains("`c`"), "{planar}");
    let axes = ["axis = [0, 1, 0]", "axis = [1, 0, 0]", ""];
    let chain: String =
        (0..7).map(|k| joint(&format!("j{k}"), &format!("{along}\n{}", axes[k % 3]))).collect();
    let arm = singular(&format!("{chain}{}", point.replace("\"c\"", "\"j6\"")));
    assert_eq!(arm.matches("`j0`").count(), 1, "{arm}");
    assert!(["`j1`", "`j2`", "`j3`"].iter().all(|free| arm.contains(free)), "{arm}");
}
