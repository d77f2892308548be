//! Friction, springs and drives of a joint as TOML values.

use super::description::{DriveChoice, DriveDescription, FrictionDescription};
use super::table::{Item, Table};
use super::toml_values::Reader;
use super::{FrictionTerm, Input, MotorTorque, RotorCoupling};
use crate::diagnostic::At;
use crate::formula::{Formula, Function};
use toml::de::DeValue;

const FRICTION: [&str; 6] = ["viscous", "coulomb", "stribeck", "terms", "law", "load"];

/// Friction of a joint: a force law as text, or a table of named laws, which add up.
pub(super) fn friction(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<FrictionDescription> {
    if item.value.is_str() {
        return Some(FrictionDescription { terms: law(reader, item), load: None });
    }
    let table = item.table("a friction law", &FRICTION, &mut reader.report)?;
    let (mut terms, mut load) = (Vec::new(), None);
    for item in table.items() {
        match item.key {
            "viscous" => terms.extend(viscous(reader, *item, owner)),
            "coulomb" => terms.extend(coulomb(reader, *item, owner).unwrap_or_default()),
            "stribeck" => terms.extend(stribeck(reader, *item, owner).unwrap_or_default()),
            "terms" => terms.extend(weighted(reader, *item, owner)),
            "law" => terms.extend(law(reader, *item)),
            "load" => load = Some(At::new(load_share(reader, *item, owner), item.span)),
            _ => {} // complained about already
        }
    }
    Some(FrictionDescription { terms, load })
}

/// What friction gains for each unit of load: a formula, or a weighted sum as identification writes it.
fn load_share(reader: &mut Reader, item: Item<'_>, owner: &str) -> Vec<FrictionTerm> {
    match item.value {
        DeValue::Array(_) => weighted(reader, item, owner),
        _ => law(reader, item),
    }
}

fn law(reader: &mut Reader, item: Item<'_>) -> Vec<FrictionTerm> {
    let formula = reader.force_law(item).unwrap_or(Formula::ZERO);
    formula
        .linear_terms()
        .into_iter()
        .map(|(coefficient, basis)| FrictionTerm { coefficient, basis })
        .collect()
}

fn viscous(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<FrictionTerm> {
    let coefficient = reader.formula(item, owner)?;
    Some(FrictionTerm { coefficient, basis: Formula::Velocity })
}

/// `T sign(v)`, smooth with a slope; or T₊ for positive and T₋ for negative velocity.
///
/// Asymmetric: `(T₊ − T₋)/2 · sign(v) + (T₊ + T₋)/2 · |sign(v)|`, with T₋ ≤ 0. Smooth: tanh(s v) for sign(v)
/// and its square for |sign(v)|, so that the law stays differentiable at rest.
fn coulomb(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<Vec<FrictionTerm>> {
    let DeValue::Table(entries) = item.value else {
        let coefficient = reader.formula(item, owner)?;
        return Some(vec![FrictionTerm { coefficient, basis: sign_of_velocity() }]);
    };
    if entries.contains_key("free") {
        let coefficient = reader.formula(item, owner)?;
        return Some(vec![FrictionTerm { coefficient, basis: sign_of_velocity() }]);
    }
    let table =
        item.table("Coulomb friction", &["value", "positive", "negative", "slope"], &mut reader.report)?;
    let slope = match table.get("slope") {
        Some(slope) => Some(reader.positive(slope)?.value),
        None => None,
    };
    let (odd, even) = coulomb_bases(slope);
    let owner = &format!("{owner}_coulomb");
    let mut value = |key| table.get(key).map(|item| reader.formula(item, owner).unwrap_or(Formula::ZERO));
    match (value("value"), value("positive"), value("negative")) {
        (Some(coefficient), None, None) => Some(vec![FrictionTerm { coefficient, basis: odd }]),
        (None, Some(positive), Some(negative)) => Some(asymmetric(positive, negative, odd, even)),
        _ => {
            let message = "Coulomb friction needs `value`, or `positive` and `negative`";
            reader.report.error(item.span, "missing-key", message);
            reader.report.help("for example { positive = 0.126, negative = -0.071 }");
            None
        }
    }
}

fn sign_of_velocity() -> Formula {
    Formula::call(Function::Sign, Formula::Velocity)
}

fn coulomb_bases(slope: Option<f64>) -> (Formula, Formula) {
    match slope {
        None => (sign_of_velocity(), Formula::call(Function::Abs, sign_of_velocity())),
        Some(slope) => {
            let smooth =
                Formula::call(Function::Tanh, Formula::product(Formula::Number(slope), Formula::Velocity));
            (smooth.clone(), Formula::power(smooth, 2))
        }
    }
}

fn asymmetric(positive: Formula, negative: Formula, odd: Formula, even: Formula) -> Vec<FrictionTerm> {
    let half = |sum: Formula| Formula::quotient(sum, Formula::Number(2.0));
    let difference = half(Formula::difference(positive.clone(), negative.clone()));
    let mean = half(Formula::sum(positive, negative));
    let terms =
        [(difference, odd), (mean, even)].map(|(coefficient, basis)| FrictionTerm { coefficient, basis });
    terms.into_iter().filter(|term| !term.coefficient.is_zero()).collect()
}

/// `τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)`
fn stribeck(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<Vec<FrictionTerm>> {
    let keys = ["a1", "a2", "a3", "a4", "a5"];
    let table = item.table("a Stribeck law", &keys, &mut reader.report)?;
    for key in keys.iter().filter(|key| table.get(key).is_none()) {
        reader.report.error(item.span, "missing-key", format!("a Stribeck law without `{key}`"));
        reader.report.help("τ = a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v)");
    }
    let owner = &format!("{owner}_stribeck");
    let mut value = |key| table.get(key).and_then(|item| reader.formula(item, owner));
    let [a1, a2, a3, a4, a5] = [value("a1")?, value("a2")?, value("a3")?, value("a4")?, value("a5")?];
    let decay_rate = reader.at_defaults(&a5);
    if decay_rate < 0.0 {
        let message =
            format!("a Stribeck law with a5 = {decay_rate}: it would grow like exp({} |v|)", -decay_rate);
        reader.report.error(item.span, "stribeck-grows", message);
        reader.report.help("a5 is how fast the excess at low speeds decays, in s/rad or s/m: at least 0");
    }
    let v = || Formula::Velocity;
    let decay = Formula::negation(Formula::product(a5, Formula::call(Function::Abs, v())));
    let steep = Formula::product(Formula::product(Formula::Number(3.0), a3.clone()), v());
    let edge = Formula::product(Formula::call(Function::Exp, decay), Formula::call(Function::Tanh, steep));
    let flat = Formula::call(Function::Tanh, Formula::product(a3, v()));
    let terms = [(a1, v()), (a2, flat), (a4, edge)];
    Some(terms.map(|(coefficient, basis)| FrictionTerm { coefficient, basis }).into())
}

/// `[["v", 76.556], ["tanh(5*v)", 3.924]]`: basis and weight, as identification writes them.
fn weighted(reader: &mut Reader, item: Item<'_>, owner: &str) -> Vec<FrictionTerm> {
    let entries = item.array("a list of [basis, weight]", &mut reader.report).unwrap_or_default();
    let term = |(index, entry): (usize, Item<'_>)| {
        let pair = entry.array("a pair [basis, weight]", &mut reader.report)?;
        let [basis, weight] = pair.as_slice() else {
            reader.report.error(entry.span, "wrong-length", "a friction term is a pair [basis, weight]");
            reader.report.help("for example [\"tanh(5*v)\", 3.924]");
            return None;
        };
        let basis = reader.force_law(*basis)?;
        let coefficient = reader.formula(*weight, &format!("{owner}_friction_{}", index + 1))?;
        Some(FrictionTerm { coefficient, basis })
    };
    entries.into_iter().enumerate().filter_map(term).collect()
}

/// Springs of a joint: a force law as text, a table `{ stiffness, rest, damping }`, or a list of these.
pub(super) fn springs(reader: &mut Reader, item: Item<'_>, owner: &str) -> Vec<Formula> {
    match item.value {
        DeValue::Array(_) => {
            let entries = item.array("a list of springs", &mut reader.report).unwrap_or_default();
            entries.into_iter().filter_map(|entry| spring(reader, entry, owner)).collect()
        }
        _ => spring(reader, item, owner).into_iter().collect(),
    }
}

/// `−c (y − rest) − d v`
fn spring(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<Formula> {
    if item.value.is_str() {
        return reader.force_law(item);
    }
    let table = item.table("a spring", &["stiffness", "rest", "damping"], &mut reader.report)?;
    let owner = &format!("{owner}_spring");
    let mut value =
        |key| table.get(key).and_then(|item| reader.formula(item, owner)).unwrap_or(Formula::ZERO);
    let stretch = Formula::difference(Formula::Position, value("rest"));
    let elastic = Formula::product(value("stiffness"), stretch);
    let damping = Formula::product(value("damping"), Formula::Velocity);
    Some(Formula::difference(Formula::negation(elastic), damping))
}

pub(super) const DRIVE: [&str; 9] = [
    "name",
    "gear_ratio",
    "rotor_inertia",
    "carrier",
    "axis",
    "coupling",
    "torque",
    "motor_constant",
    "friction",
];

/// The drive of a joint: `"ideal"`, `"none"` or a motor.
pub(super) fn drive(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<At<DriveChoice>> {
    let choice = match item.value.as_str() {
        Some("ideal") => DriveChoice::Ideal,
        Some("none") => DriveChoice::Passive,
        Some(other) => {
            let message = format!("unknown drive {other:?}");
            reader.report.error(item.span, "unknown-value", message);
            reader.report.help("\"ideal\", \"none\", or a table with gear_ratio, rotor_inertia, …");
            return None;
        }
        None => {
            let table = item.table("a drive", &DRIVE, &mut reader.report)?;
            DriveChoice::Motor(Box::new(motor(reader, &table, owner)))
        }
    };
    Some(At::new(choice, item.span))
}

pub(super) fn motor(reader: &mut Reader, table: &Table<'_>, owner: &str) -> DriveDescription {
    let mut value = |key, default: f64| match table.get(key) {
        Some(item) => At::new(reader.formula(item, owner).unwrap_or(Formula::Number(default)), item.span),
        None => At::new(Formula::Number(default), table.span),
    };
    let (gear_ratio, rotor_inertia) = (value("gear_ratio", 1.0), value("rotor_inertia", 0.0));
    let shaft = table.get("friction").and_then(|item| shaft_friction(reader, item, owner));
    let current = table.get("motor_constant").and_then(|item| reader.formula(item, owner));
    DriveDescription {
        name: table.get("name").and_then(|item| reader.name(item)),
        gear_ratio,
        rotor_inertia,
        carrier: table.get("carrier").and_then(|item| reader.name(item)),
        axis: table.get("axis").and_then(|item| reader.axis(item)),
        coupling: table.get("coupling").map_or(RotorCoupling::Body, |item| coupling(reader, item)),
        input: current.map_or(Input::Torque, Input::Current),
        torque: table.get("torque").and_then(|item| torque(reader, item)).unwrap_or_default(),
        friction: shaft,
    }
}

/// Friction of a motor's shaft, over its angle and speed.
fn shaft_friction(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<At<Vec<FrictionTerm>>> {
    let described = friction(reader, item, &format!("{owner}_shaft"))?;
    if let Some(load) = &described.load {
        reader.report.error(
            load.span,
            "load-at-drive",
            "friction of a drive's shaft does not grow with a load",
        );
        reader.report.help("`load` stands at the joint: `friction = { load = … }` there");
    }
    Some(At::new(described.terms, item.span))
}

fn coupling(reader: &mut Reader, item: Item<'_>) -> RotorCoupling {
    match item.text(&mut reader.report) {
        Some("diagonal") => RotorCoupling::Diagonal,
        Some("body") | None => RotorCoupling::Body,
        Some(other) => {
            reader.report.error(item.span, "unknown-value", format!("unknown rotor coupling {other:?}"));
            reader.report.help("\"body\" (the rotor is a body, the default) or \"diagonal\" (only i² J_R)");
            RotorCoupling::Body
        }
    }
}

fn torque(reader: &mut Reader, item: Item<'_>) -> Option<MotorTorque> {
    if !item.value.is_table() {
        let nominal = reader.positive(item)?.value;
        return Some(MotorTorque { nominal: Some(nominal), peak: None });
    }
    let table = item.table("a motor torque", &["nominal", "peak"], &mut reader.report)?;
    let mut value = |key| table.get(key).and_then(|item| reader.positive(item)).map(|number| number.value);
    let torque = MotorTorque { nominal: value("nominal"), peak: value("peak") };
    if let (Some(nominal), Some(peak)) = (torque.nominal, torque.peak)
        && nominal > peak
    {
        let message = format!("nominal torque {nominal} exceeds the peak torque {peak}");
        reader.report.error(item.span, "limits-reversed", message);
    }
    Some(torque)
}
