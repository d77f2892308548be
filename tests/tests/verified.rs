//! The check that every `generate` makes of its functions: no right robot is refused, and wrong functions are.

use fastrand::Rng;
use gelenk_codegen::diagnostic::Diagnostic;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::functions::catalogue;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::functions::selection;
use gelenk_codegen::model::Model;
use gelenk_codegen::program::Operation;
use gelenk_codegen::read::{ReadOptions, from_toml, read};
use gelenk_codegen::verify;
use gelenk_tests::in_parallel;
use gelenk_tests::quaternion_model::with_quaternions;
use gelenk_tests::random_model::{
    random_coupled_model, random_driven_model, random_helical_model, random_model,
    random_model_with_frame_forces, random_model_with_near_rotors,
};
use gelenk_tests::workspace;

/// All functions of a model, those on request included; without those that do not exist for it.
fn functions(model: &Model, form: Form) -> Vec<Function> {
    let composed = ["discretize", "step", "step_derivatives"];
    let names = catalogue::names(model).into_iter().filter(|name| !composed.contains(&name.as_str()));
    let names: Vec<String> = names.collect();
    let derive = |names: &[String]| selection::derive_in_form(model, names, 400_000, form, &[]);
    derive(&names).unwrap_or_else(|_| {
        let alone = |name: &String| derive(std::slice::from_ref(name)).unwrap_or_default();
        let each = names.iter().map(|name| alone(name).into_iter().find(|function| function.name == *name));
        each.flatten().collect()
    })
}

fn refused(model: &Model, form: Form) -> Vec<String> {
    let functions = functions(model, form);
    assert!(functions.len() > 10, "{}: {}", model.name, functions.len());
    let found = functions.iter().map(|function| verify::worst(model, function));
    found.filter(|found| !found.is_rounding()).map(|found| format!("{found:?}")).collect()
}

/// A model with bodies and springs that are larger or smaller by up to nine powers of ten: stiff ones and nearly singular ones.
fn uneven(mut model: Model, seed: u64) -> Model {
    let mut rng = Rng::with_seed(seed);
    let scaled = |formula: &mut Formula, factor: f64| {
        *formula = Formula::Multiply(Box::new(Formula::Number(factor)), Box::new(formula.clone()));
    };
    for link in &mut model.links {
        let factor = 10_f64.powi(rng.i32(-9..=9));
        for body in &mut link.bodies {
            scaled(&mut body.mass, factor);
            body.inertia.iter_mut().for_each(|entry| scaled(entry, factor));
        }
        if let Some(joint) = &mut link.joint {
            joint.springs.iter_mut().for_each(|law| scaled(law, factor));
        }
    }
    model
}

/// The random robots of one seed.
fn robots(seed: u64) -> Vec<Model> {
    let even = [
        random_model(seed, 7),
        random_model_with_near_rotors(seed, 4),
        random_coupled_model(seed, 6),
        random_model_with_frame_forces(seed, 5),
        random_driven_model(seed, 5),
        random_helical_model(seed, 6),
        with_quaternions(random_model(seed, 5), seed),
        with_quaternions(random_coupled_model(seed, 5), seed),
    ];
    even.into_iter().flat_map(|model| [uneven(model.clone(), seed), model]).collect()
}

/// Its inertias differ by 15 powers of ten.
const MOST_UNEVEN: usize = 1684;

/// `GELENK_ROBOTS=2000` tries as many.
#[test]
fn no_right_robot_is_refused() {
    let count: usize = std::env::var("GELENK_ROBOTS").ok().and_then(|count| count.parse().ok()).unwrap_or(16);
    let indices: Vec<usize> = (0..count).chain([MOST_UNEVEN]).collect();
    let problems = in_parallel(&indices, |&index| {
        let model = robots((index / 16) as u64).swap_remove(index % 16);
        let form = [Form::Straight, Form::Arrays][index / 16 % 2];
        refused(&model, form).into_iter().map(|found| format!("robot {index}: {found}")).collect::<Vec<_>>()
    });
    let problems = problems.concat();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Robots with results that are exact zeros in the evaluation and roundings in the derivation: a spin times itself, a point on an
/// axis in a turned frame; and one without a centre of mass.
const EXACT_ZEROS: [&str; 3] = [
    r#"
    name = "spins"
    joints = [
        { name = "slide", type = "prismatic", axis = [0.48, -0.6, 0.64] },
        { name = "hinge", axis = [0.1379060415289607, 0.27486032649965797, 0.9515428128183796], origin = { xyz = [0.3, -0.4, 0.2] } },
    ]
    bodies = [{ link = "hinge", mass = 1, center_of_mass = [0.1, 0.2, 0.3], inertia = 0.1 }]
    frames = [{ name = "tip", link = "hinge" }]
    "#,
    r#"
    name = "centered"
    joints = [
        { name = "slide", type = "prismatic", axis = [0, -1, 0], origin = { xyz = [0.25, 0.25, 0] }, motion = "driven" },
        { name = "hinge", axis = [0.2126658104457907, -0.4565959748569784, -0.8638827286222597],           origin = { xyz = [0.3845066387289433, 0.4868199651210907, -0.25], rpy = ["pi/2", 0, "pi/2"] } },
    ]
    bodies = [{ link = "hinge", mass = 1.4, center_of_mass = [0, 0, 0], inertia = [0.08, 0.08, 0.06] }]
    "#,
    r#"
    name = "massless"
    joints = [{ name = "hinge", axis = [0, 0, 1], drive = { gear_ratio = 50, rotor_inertia = 1e-4 } }]
    "#,
];

#[test]
fn exact_zeros_agree_with_roundings() {
    for text in EXACT_ZEROS {
        let none = &mut |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
        let loaded = from_toml(text, "robot.toml", &ReadOptions::default(), none);
        let (model, _) = loaded.unwrap_or_else(|problems| panic!("{problems}"));
        for form in [Form::Straight, Form::Arrays] {
            let problems = refused(&model, form);
            assert!(problems.is_empty(), "{}: {problems:#?}", model.name);
        }
    }
}

/// Exchanges a sum and a difference at one instruction; `None` where it is neither.
fn mutated(function: &Function, index: usize) -> Option<Function> {
    let mut function = function.clone();
    let operation = &mut function.program.instructions.get_mut(index)?.operation;
    *operation = match *operation {
        Operation::Add(a, b) => Operation::Subtract(a, b),
        Operation::Subtract(a, b) => Operation::Add(a, b),
        Operation::Multiply(a, _) => Operation::Negate(a),
        _ => return None,
    };
    Some(function)
}

#[test]
fn one_wrong_operation_is_refused() {
    let (mut tried, mut noticed) = (0, 0);
    for name in
        ["two_arm.toml", "differential_wrist.toml", "excavator.toml", "quadrotor.toml", "palletizer.toml"]
    {
        let loaded = read(&workspace().join("models").join(name), &ReadOptions::default());
        let model = loaded.unwrap_or_else(|problems| panic!("{problems}")).model;
        for function in functions(&model, Form::Cheapest) {
            let count = function.program.instructions.len();
            let places = (0..8).map(|k| (2 * k + 1) * count / 16);
            for wrong in places.filter_map(|place| mutated(&function, place)) {
                let found = verify::worst(&model, &wrong);
                // Some operations have a zero or a square behind them: their sign changes no result.
                let is_without_effect = found.excess < 1e-4;
                assert!(!found.is_rounding() || is_without_effect, "{name}: {found:?}");
                noticed += usize::from(!is_without_effect);
                tried += 1;
            }
        }
    }
    assert!(tried > 500 && noticed * 20 > tried * 19, "{noticed} of {tried}");
}

#[test]
fn the_evaluation_shares_no_code_with_the_derivation() {
    let folder = workspace().join("codegen/src/verify");
    let files: Vec<_> =
        std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{error}")).flatten().collect();
    assert!(files.len() > 5, "{files:?}");
    for file in files {
        let text = std::fs::read_to_string(file.path()).unwrap_or_default();
        for place in ["crate::dynamics", "crate::kinematics", "crate::graph", "crate::spatial"] {
            assert!(!text.contains(place), "{place} in {:?}", file.path());
        }
    }
}
