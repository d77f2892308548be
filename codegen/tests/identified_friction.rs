//! Friction as identification writes it, read by the generator: the same torques.

#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gelenk_codegen::formula::{Formula, FrictionLaw as Described, FrictionPart, FrictionTerm as Term};
use gelenk_codegen::model::{FrictionTerm as Read, Joint, Model};
use gelenk_codegen::read::{ReadOptions, from_toml};
use gelenk_identification::friction::FrictionIdentification;
use gelenk_identification::result::description::{Identified, identified_toml};
use gelenk_identification::result::{FrictionLaw, FrictionResult, FrictionTerm};

const ARM: &str =
    "[[joints]]\nname = \"j\"\ndrive = \"ideal\"\n[[bodies]]\nlink = \"j\"\nmass = 1\ninertia = 1\n";

/// Velocities of both directions, at rest, and from creeping to fast.
const VELOCITIES: [f64; 9] = [-3.0, -0.7, -0.02, -1e-4, 0.0, 3e-4, 0.05, 0.4, 2.5];

/// The two sets of elementary functions are accurate to a few units in the last place each.
const ROUNDING: f64 = 1e-14;

fn load(text: &str) -> Model {
    let base = &mut |file: &str| Ok((file.to_owned(), ARM.to_owned()));
    let read = from_toml(text, "robot.toml", &ReadOptions::default(), base);
    read.unwrap_or_else(|wrong| panic!("{wrong}\n{text}")).0
}

fn joint(model: &Model) -> &Joint {
    model.links[model.coordinates[0]].joint.as_ref().unwrap()
}

/// Σ coefficient · basis, and Σ |coefficient · basis|.
fn torque(terms: &[Read], v: f64) -> [f64; 2] {
    let value = |formula: &Formula| formula.evaluate(&[], 0.0, v);
    let products = || terms.iter().map(|term| value(&term.coefficient) * value(&term.basis));
    [products().sum(), products().map(f64::abs).sum()]
}

fn reread(law: FrictionLaw, load_terms: Vec<FrictionTerm>) -> (FrictionResult, Model) {
    let mut result = FrictionResult::default();
    result.joint = "j".into();
    result.law = law;
    result.load = load_terms;
    let friction = std::slice::from_ref(&result);
    let identified = Identified { name: "arm", extends: "arm.toml", friction, ..Identified::default() };
    let text = identified_toml(&identified).unwrap();
    (result, load(&text))
}

fn terms(bases: &[String], scale: f64, error: Option<f64>) -> Vec<FrictionTerm> {
    let term = |(k, basis): (usize, &String)| FrictionTerm {
        basis: basis.clone(),
        coefficient: scale * (2.0 + k as f64 / 7.0),
        standard_error: error,
        ..FrictionTerm::default()
    };
    bases.iter().enumerate().map(term).collect()
}

/// Every term of the default library, and terms in other spellings, over velocity and under load.
#[test]
fn laws_of_terms_keep_their_values() {
    let mut bases = FrictionIdentification::new().unwrap().library.terms().to_vec();
    let spelled = ["sgn(v)", "v.powi(3)", "exp(-2*abs(v))*tanh(3*v)", "-(v - pi)/(1 + v*v)", "sqrt(abs(v))"];
    bases.extend(spelled.map(String::from));
    let (result, model) =
        reread(FrictionLaw::Terms(terms(&bases, 1.0, None)), terms(&bases[2..5], 0.01, None));
    assert_eq!(joint(&model).friction.len(), bases.len());
    for v in VELOCITIES {
        let [law, magnitude] = torque(&joint(&model).friction, v);
        let [share, under_load] = torque(&joint(&model).load_friction, v);
        for load in [0.0, 0.4, -1.5] {
            let expected = result.torque(v, load).unwrap();
            let allowed = ROUNDING * (magnitude + load.abs() * under_load);
            assert!((law + load.abs() * share - expected).abs() <= allowed, "{v}: {law} for {expected}");
        }
    }
}

/// Each coefficient lies within half a unit of the last digit that its error leaves: 5 % of the error at most.
#[test]
fn laws_with_errors_keep_the_digits_that_these_leave() {
    let error = 3.4e-3;
    let written = terms(FrictionIdentification::new().unwrap().library.terms(), 1.0, Some(error));
    let (_, model) = reread(FrictionLaw::Terms(written.clone()), Vec::new());
    assert_eq!(joint(&model).friction.len(), written.len());
    for (read, term) in joint(&model).friction.iter().zip(&written) {
        let change = (read.coefficient.as_number().unwrap() - term.coefficient).abs();
        assert!(change <= 0.05 * error && (change > 0.0 || term.coefficient.fract() == 0.0), "{change}");
    }
}

#[test]
fn stribeck_laws_keep_their_values() {
    for parameters in [[2.1, 1.4, 20.0 / 3.0, 0.9, 8e-17], [76.5561, 10.9, 31.25, -2.0 / 3.0, 5.5]] {
        let law = FrictionLaw::stribeck(parameters, [None; 5], [None; 5]);
        let (result, model) = reread(law, Vec::new());
        for v in VELOCITIES {
            let [read, magnitude] = torque(&joint(&model).friction, v);
            let expected = result.torque(v, 0.0).unwrap();
            assert!((read - expected).abs() <= ROUNDING * magnitude, "{v}: {read} for {expected}");
        }
    }
}

/// Every key that the type writes is read as the terms that it stands for.
#[test]
fn every_part_of_a_law_is_read_as_its_terms() {
    fn parts<C>(number: impl Fn(f64) -> C) -> Vec<FrictionPart<C>> {
        let both = |slope| FrictionPart::Asymmetric { positive: number(0.4), negative: number(-0.3), slope };
        let one = |slope| FrictionPart::Coulomb { level: number(0.7), slope };
        let term = Term { coefficient: number(1e-7), basis: Formula::power(Formula::Velocity, 2) };
        vec![
            FrictionPart::Viscous(number(2.0)),
            one(None),
            one(Some(50.0)),
            both(None),
            both(Some(12.5)),
            FrictionPart::Stribeck([0.1, 0.3, 20.0, 0.2, 4.0].map(&number)),
            FrictionPart::Terms(vec![term]),
        ]
    }
    for (written, expected) in parts(|number| number).into_iter().zip(parts(Formula::Number)) {
        let law = Described { parts: vec![written], load: Vec::new() }.toml();
        let model = load(&format!("extends = \"arm.toml\"\n[[joints]]\nname = \"j\"\nfriction = {law}\n"));
        assert_eq!(joint(&model).friction, expected.terms(), "{law}");
    }
}
