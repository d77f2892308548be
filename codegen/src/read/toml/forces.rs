//! Friction, springs and drives of a joint as TOML values.

use super::table::{Item, Table};
use super::values::Reader;
use crate::description::{DriveChoice, DriveDescription, FrictionDescription};
use crate::diagnostic::{At, Report};
use crate::model::{Input, MotorTorque, RotorCoupling, TorqueSpeedLine};
use crate::wording::as_written;
use gelenk_formula::{Formula, FrictionPart, FrictionTerm};
use toml::de::DeValue;

/// Reads the friction of a joint: a force law as text, or a table of named laws, which are added.
pub(crate) fn friction(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<FrictionDescription> {
    if item.value.is_str() {
        return Some(FrictionDescription { terms: law(reader, item), load: None });
    }
    let table = item.table(&mut reader.report)?;
    let (mut parts, mut load) = (Vec::new(), None);
    for item in table.items() {
        match item.key {
            "viscous" => parts.extend(reader.formula(*item, owner).map(FrictionPart::Viscous)),
            "coulomb" => parts.extend(coulomb(reader, *item, owner)),
            "stribeck" => parts.extend(stribeck(reader, *item, owner)),
            "terms" => parts.push(FrictionPart::Terms(weighted(reader, *item, owner))),
            "law" => parts.push(FrictionPart::Terms(law(reader, *item))),
            "load" => load = Some(At::new(load_share(reader, *item, owner), item.span)),
            _ => {} // complained about already
        }
    }
    let terms = parts.into_iter().flat_map(FrictionPart::terms).collect();
    Some(FrictionDescription { terms, load })
}

/// Friction per unit of load: a formula, or a weighted sum of basis functions as identification writes it.
fn load_share(reader: &mut Reader, item: Item<'_>, owner: &str) -> Vec<FrictionTerm> {
    match item.value {
        DeValue::Array(_) => weighted(reader, item, owner),
        _ => law(reader, item),
    }
}

fn law(reader: &mut Reader, item: Item<'_>) -> Vec<FrictionTerm> {
    let formula = reader.force_law(item).unwrap_or(Formula::ZERO);
    let terms = formula.linear_terms().into_iter();
    terms.map(|(coefficient, basis)| FrictionTerm { coefficient, basis }).collect()
}

/// Reads Coulomb friction: one value, or a table with one value or one value for each direction. With a slope
/// the law is smooth.
fn coulomb(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<FrictionPart> {
    if item.value.as_table().is_none_or(|entries| entries.contains_key("free")) {
        let level = reader.formula(item, owner)?;
        return Some(FrictionPart::Coulomb { level, slope: None });
    }
    let table = item.table(&mut reader.report)?;
    let slope = match table.get("slope") {
        Some(slope) => Some(reader.number(slope)?.value),
        None => None,
    };
    let owner = &format!("{owner}_coulomb");
    let mut value = |key| table.get(key).map(|item| reader.formula(item, owner).unwrap_or(Formula::ZERO));
    match (value("value"), value("positive"), value("negative")) {
        (Some(level), None, None) => Some(FrictionPart::Coulomb { level, slope }),
        (None, Some(positive), Some(negative)) => {
            Some(FrictionPart::Asymmetric { positive, negative, slope })
        }
        _ => {
            let message = "Coulomb friction needs `value`, or `positive` and `negative`";
            reader.report.error(item.span, "missing-key", message);
            reader.report.help("for example { positive = 0.126, negative = -0.071 }");
            None
        }
    }
}

fn stribeck(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<FrictionPart> {
    let keys = FrictionPart::STRIBECK_KEYS;
    let table = item.table(&mut reader.report)?;
    let owner = &format!("{owner}_stribeck");
    let mut value = |key| table.get(key).and_then(|item| reader.formula(item, owner));
    let [a1, a2, a3, a4, a5] = keys.map(&mut value);
    let parameters = [a1?, a2?, a3?, a4?, a5?];
    let decay_rate = reader.at_defaults(&parameters[4]);
    if decay_rate < 0.0 {
        let message =
            format!("a Stribeck law with a5 = {decay_rate} would grow like exp({} |v|)", -decay_rate);
        reader.report.error(item.span, "stribeck-grows", message);
        reader
            .report
            .help("a5 is the decay rate of low-speed friction in s/rad or s/m. It must be at least 0");
    }
    Some(FrictionPart::Stribeck(parameters))
}

/// Reads pairs of basis function and weight, as identification writes them:
/// `[["v", 76.556], ["tanh(5*v)", 3.924]]`.
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

/// Reads the springs of a joint: a force law as text, a table `{ stiffness, rest, damping }`, or a list of
/// both.
pub(crate) fn springs(reader: &mut Reader, item: Item<'_>, owner: &str) -> Vec<Formula> {
    match item.value {
        DeValue::Array(_) => {
            let entries = item.array("a list of springs", &mut reader.report).unwrap_or_default();
            entries.into_iter().filter_map(|entry| spring(reader, entry, owner)).collect()
        }
        _ => spring(reader, item, owner).into_iter().collect(),
    }
}

/// The force of a spring, `−c (y − rest) − d v` with stiffness c and damping d at the position y and velocity
/// v.
fn spring(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<Formula> {
    if item.value.is_str() {
        return reader.force_law(item);
    }
    let table = item.table(&mut reader.report)?;
    let joint = owner;
    let owner = &format!("{owner}_spring");
    let mut value =
        |key| table.get(key).and_then(|item| reader.formula(item, owner)).unwrap_or(Formula::ZERO);
    let [rest, stiffness, damping] = ["rest", "stiffness", "damping"].map(&mut value);
    let factors = ["stiffness", "damping"].map(|key| table.get(key));
    match factors {
        [None, None] if table.get("rest").is_some() => {
            let message =
                format!("the spring of `{joint}` has a rest position but neither stiffness nor damping");
            reader.report.error(item.span, "missing-key", message);
            reader.report.help("for example `spring = { stiffness = 100, rest = 0.1 }`");
        }
        _ => check_signs(reader, factors, [&stiffness, &damping], joint),
    }
    let stretch = Formula::difference(Formula::Position, rest);
    let elastic = Formula::product(stiffness, stretch);
    let damping = Formula::product(damping, Formula::Velocity);
    Some(Formula::difference(Formula::negation(elastic), damping))
}

/// Warns of negative stiffness, which may be intended. Reports an error for negative damping, which would add
/// energy.
fn check_signs(reader: &mut Reader, items: [Option<Item<'_>>; 2], factors: [&Formula; 2], joint: &str) {
    let [stiffness, damping] = factors.map(|factor| reader.at_defaults(factor));
    if let Some(item) = items[0].filter(|_| stiffness < 0.0) {
        warn_of_negative_stiffness(joint, At::new(stiffness, item.span), &mut reader.report);
    }
    if let Some(item) = items[1].filter(|_| damping < 0.0) {
        let message = format!("the spring of `{joint}` has negative damping {}", as_written(damping));
        reader.report.error(item.span, "negative-damping", message);
        reader.report.help("damping that brakes has a positive coefficient: change the sign");
    }
}

pub(crate) fn warn_of_negative_stiffness(joint: &str, stiffness: At<f64>, report: &mut Report) {
    let message = format!(
        "the spring of `{joint}` has negative stiffness {}, so it pushes away from its rest position",
        as_written(stiffness.value)
    );
    report.warning(stiffness.span, "negative-stiffness", message);
    report.help(
        "negative stiffness describes a spring beyond its dead centre. A spring that pulls back has positive stiffness",
    );
}

/// Reads the drive of a joint: `"ideal"`, `"none"` or a motor.
pub(crate) fn drive(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<At<DriveChoice>> {
    let choice = match item.value.is_str().then(|| item.word(&mut reader.report)) {
        Some(word) if word? == "ideal" => DriveChoice::Ideal,
        Some(_) => DriveChoice::Passive,
        None => {
            let table = item.table(&mut reader.report)?;
            DriveChoice::Motor(Box::new(motor(reader, &table, owner)))
        }
    };
    Some(At::new(choice, item.span))
}

pub(crate) fn motor(reader: &mut Reader, table: &Table<'_>, owner: &str) -> DriveDescription {
    let mut value = |key, default: f64| match table.get(key) {
        Some(item) => At::new(reader.formula(item, owner).unwrap_or(Formula::Number(default)), item.span),
        None => At::new(Formula::Number(default), table.span),
    };
    let (gear_ratio, rotor_inertia) = (value("gear_ratio", 1.0), value("rotor_inertia", 0.0));
    let shaft = table.get("friction").and_then(|item| {
        let described = friction(reader, item, &format!("{owner}_shaft"))?;
        Some(At::new(described.terms, item.span))
    });
    let current = table.get("motor_constant").and_then(|item| reader.formula(item, owner));
    let coupling = table.get("coupling").map_or(RotorCoupling::Body, |item| coupling(reader, item));
    warn_of_unused_mounting(reader, table, coupling);
    DriveDescription {
        name: table.get("name").and_then(|item| reader.name(item)),
        gear_ratio,
        rotor_inertia,
        carrier: table.get("carrier").and_then(|item| reader.name(item)),
        // A wrong axis was reported; it is not missing.
        axis: table.get("axis").map(|item| reader.axis(item).unwrap_or([0.0, 0.0, 1.0])),
        coupling,
        input: current.map_or(Input::Torque, Input::Current),
        input_span: table.get("motor_constant").map_or(table.span, |item| item.span),
        torque: table.get("torque").and_then(|item| torque(reader, item)).unwrap_or_default(),
        speed: table.get("speed").and_then(|item| reader.number(item)),
        line: torque_speed_line(reader, table),
        friction: shaft,
    }
}

/// Reads the line from stall torque to no-load speed of a motor. Both values are required.
fn torque_speed_line(reader: &mut Reader, table: &Table<'_>) -> Option<At<TorqueSpeedLine>> {
    let keys @ [torque, speed] = ["stall_torque", "no_load_speed"].map(|key| table.get(key));
    let [stall_torque, no_load_speed] = keys.map(|item| item.and_then(|item| reader.number(item)));
    let (present, missing) = match (torque, speed) {
        (Some(present), None) => (present, "no_load_speed"),
        (None, Some(present)) => (present, "stall_torque"),
        _ => {
            let (stall_torque, no_load_speed) = (stall_torque?, no_load_speed?);
            let line =
                TorqueSpeedLine { stall_torque: stall_torque.value, no_load_speed: no_load_speed.value };
            return Some(At::new(line, stall_torque.span));
        }
    };
    reader.report.error(present.span, "missing-key", format!("`{}` also needs `{missing}`", present.key));
    reader.report.help(
        "give both, because a motor's torque falls from `stall_torque` at rest to 0 at `no_load_speed`. `speed` limits only the \
         speed, `torque` only the torque",
    );
    None
}

fn coupling(reader: &mut Reader, item: Item<'_>) -> RotorCoupling {
    match item.word(&mut reader.report) {
        Some("diagonal") => RotorCoupling::Diagonal,
        _ => RotorCoupling::Body,
    }
}

/// Warns of `carrier` or `axis` if the rotor only adds its inertia to the diagonal of the mass matrix,
/// because both keys then have no effect.
fn warn_of_unused_mounting(reader: &mut Reader, table: &Table<'_>, coupling: RotorCoupling) {
    let mounting = ["carrier", "axis"].into_iter().filter_map(|key| table.get(key));
    for item in mounting.filter(|_| coupling == RotorCoupling::Diagonal) {
        let message = format!("`{}` has no effect with `coupling = \"diagonal\"`", item.key);
        reader.report.warning(item.span, "unused-key", message);
        reader.report.help("remove `coupling` to describe the rotor as a body. Otherwise remove this key");
    }
}

fn torque(reader: &mut Reader, item: Item<'_>) -> Option<MotorTorque> {
    if !item.value.is_table() {
        let nominal = reader.number(item)?.value;
        return Some(MotorTorque { nominal: Some(nominal), peak: None });
    }
    let table = item.table(&mut reader.report)?;
    let mut value = |key| table.get(key).and_then(|item| reader.number(item)).map(|number| number.value);
    let torque = MotorTorque { nominal: value("nominal"), peak: value("peak") };
    if let (Some(nominal), Some(peak)) = (torque.nominal, torque.peak)
        && nominal > peak
    {
        let message = format!("nominal torque {nominal} exceeds the peak torque {peak}");
        reader.report.error(item.span, "limits-reversed", message);
        reader.report.help(
            "`nominal` is the motor's continuous torque and `peak` its short-time torque. Exchange them, or correct one",
        );
    }
    Some(torque)
}
