//! Constants of a robot's module: names, limits, drives.

mod quaternions;

pub(super) use quaternions::joint_positions;

use crate::functions::function::{Constant, ConstantValue};
use crate::layout::Dimension;
use crate::model::{Actuator, Dependent, Drive, ForceInput, Input, Joint, Model, Options};
use gelenk_formula::Formula;
use gelenk_kernels::hash::fnv1a;

/// Names of all constants that a module can have, except those of its functions.
pub const NAMES: [&str; 48] = [
    "HASH",
    "NY",
    "JOINTS",
    "JOINT_KINDS",
    "JOINT_POSITIONS",
    "FIRST_POSITIONS",
    "FIRST_VELOCITIES",
    "POSITION_NAMES",
    "POSITION_UNITS",
    "VELOCITY_NAMES",
    "VELOCITY_UNITS",
    "NEUTRAL",
    "JOINT_NAMES",
    "JOINT_UNITS",
    "EFFORT_UNITS",
    "INPUT_NAMES",
    "INPUT_UNITS",
    "INPUT_JOINTS",
    "FRAME_NAMES",
    "POSITION_LIMITS",
    "VELOCITY_LIMITS",
    "EFFORT_LIMITS",
    "PEAK_EFFORT_LIMITS",
    "ACCELERATION_LIMITS",
    "JERK_LIMITS",
    "FOLLOWER_NAMES",
    "DEPENDENT_JOINT_NAMES",
    "DEPENDENT_JOINT_RATIOS",
    "DEPENDENT_DRIVEN_RATIOS",
    "DEPENDENT_JOINT_OFFSETS",
    "DEPENDENT_POSITION_LIMITS",
    "DEPENDENT_VELOCITY_LIMITS",
    "INPUT_LIMITS",
    "PEAK_INPUT_LIMITS",
    "INPUT_RANGES",
    "TORQUE_SPEED_SLOPES",
    "TORQUE_SPEED_LIMITS",
    "WRENCHES",
    "WRENCH_NAMES",
    "DRIVEN",
    "DRIVEN_NAMES",
    "DRIVES",
    "GEAR_RATIOS",
    "ROTOR_INERTIAS",
    "FRICTION_JUMPS",
    "GRAVITY",
    "FUNCTIONS",
    "SUBSTEPS",
];

/// All constants of a robot, in their order in the module.
pub(super) fn all(model: &Model) -> Vec<Constant> {
    let joints: Vec<&Joint> = model.joints().collect();
    let inputs: Vec<Actuator<'_>> = model.inputs().collect();
    let mut constants = vec![hash(model)];
    constants.extend(quaternions::sizes(model));
    constants.extend(names(model, &joints, &inputs));
    constants.extend(joint_limits(&joints));
    constants.extend(dependent(model));
    constants.extend(input_limits(model, &inputs));
    constants.extend(torque_speed_lines(model).into_iter().flatten());
    constants.extend(drives(model));
    constants.push(friction_jumps(model));
    constants.extend(gravity(model));
    constants
}

/// The hash of a robot. It identifies the model that a controller ran, independent of the functions in the
/// module.
fn hash(model: &Model) -> Constant {
    let options = Options { functions: vec![], lanes: vec![], ..model.options.clone() };
    let text = format!("{} {:?}", env!("CARGO_PKG_VERSION"), Model { options, ..model.clone() });
    let summary = "Hash of the description and of the version of gelenk, the same in every language.";
    constant("HASH", summary, ConstantValue::Hash(fnv1a(text.bytes())))
}

/// Constant with the names of a module's functions, for macros that check which functions exist.
pub(super) fn functions<'a>(names: impl Iterator<Item = &'a str>) -> Constant {
    constant("FUNCTIONS", "Names of the functions.", strings(Dimension::Fixed, names))
}

/// Constant with the number of Runge–Kutta steps in one sample time.
pub(super) fn substeps(model: &Model) -> Constant {
    let summary =
        "Runge–Kutta steps in one period of `step` and `step_derivatives`: `substeps` of the description.";
    let count = model.options.substeps.unwrap_or(1);
    constant("SUBSTEPS", summary, ConstantValue::Count(count))
}

fn constant(name: &'static str, summary: &str, value: ConstantValue) -> Constant {
    Constant { name, summary: summary.to_owned(), items: vec![], value }
}

fn strings<'a>(dimension: Dimension, names: impl Iterator<Item = &'a str>) -> ConstantValue {
    ConstantValue::Names(dimension, names.map(str::to_owned).collect())
}

fn names(model: &Model, joints: &[&Joint], inputs: &[Actuator<'_>]) -> Vec<Constant> {
    use Dimension::{Coordinates, Fixed, Inputs};
    let acted_on: Option<Vec<usize>> = inputs.iter().map(|input| input.coordinate()).collect();
    let acted_on = acted_on.map(|acted_on| {
        let value = ConstantValue::Indices(Inputs, acted_on);
        constant("INPUT_JOINTS", "The coordinate that each input acts on.", value)
    });
    let frames = (!model.frames.is_empty()).then(|| {
        let names = model.frames.iter().map(|frame| frame.name.as_str());
        constant("FRAME_NAMES", "Names of the frames.", strings(Fixed, names))
    });
    let of_joints = match model.quaternion_joints.is_empty() {
        false => quaternions::names(model),
        true => vec![
            constant(
                "JOINT_NAMES",
                "Names of the joints, in the order of the coordinates.",
                strings(Coordinates, joints.iter().map(|joint| joint.name.as_str())),
            ),
            constant(
                "JOINT_UNITS",
                "Units of the coordinates: `rad` or `m`.",
                strings(Coordinates, joints.iter().map(|joint| joint.kind.unit())),
            ),
        ],
    };
    let of_forces = [
        constant(
            "EFFORT_UNITS",
            "Units of the forces at the joints, for example of the results of `inverse_dynamics`: `N m` or `N`.",
            strings(Coordinates, joints.iter().map(|joint| joint.kind.effort_unit())),
        ),
        constant(
            "INPUT_NAMES",
            "Names of the inputs.",
            strings(Inputs, inputs.iter().map(|input| input.name())),
        ),
        constant(
            "INPUT_UNITS",
            "Units of the inputs: `N m` or `N` for ideal drives and motor torques, `A` for motor currents.",
            strings(Inputs, inputs.iter().map(|input| model.input_unit(*input))),
        ),
    ];
    let wrenches = (!model.wrenches.is_empty()).then(|| {
        let names = model.wrenches.iter().map(|wrench| wrench.name.as_str());
        [
            constant("WRENCHES", "Number of wrenches.", ConstantValue::Count(model.wrenches.len())),
            constant("WRENCH_NAMES", "Names of the wrenches.", strings(Fixed, names)),
        ]
    });
    let constants = of_joints.into_iter().chain(of_forces).chain(acted_on).chain(frames);
    let driven = (!model.driven.is_empty()).then(|| {
        let names = model.driven_joints().map(|joint| joint.name.as_str());
        [
            constant("DRIVEN", "Number of driven coordinates.", ConstantValue::Count(model.driven.len())),
            constant("DRIVEN_NAMES", "Names of the driven joints.", strings(Fixed, names)),
        ]
    });
    constants.chain(wrenches.into_iter().flatten()).chain(driven.into_iter().flatten()).collect()
}

/// Constants of the dependent joints: joints that follow coordinates, and motors that move several coordinates.
/// They exist if the ratios are numbers.
fn dependent(model: &Model) -> Vec<Constant> {
    let all = model.dependent(&[]);
    let free = free_followers(model, &all);
    let dependent: Vec<(&Dependent<'_>, &Vec<f64>)> =
        all.iter().filter_map(|one| Some((one, one.ratios.as_ref()?))).collect();
    if dependent.is_empty() {
        return Vec::from_iter(free);
    }
    let ratios = ratios(model.coordinates.len(), dependent.iter().map(|(_, row)| *row));
    let dependent: Vec<&Dependent<'_>> = dependent.into_iter().map(|(one, _)| one).collect();
    let numbers = |name, summary, value: fn(&Dependent<'_>) -> f64| {
        let values = dependent.iter().map(|one| value(one)).collect();
        constant(name, summary, ConstantValue::Numbers(Dimension::Fixed, values))
    };
    let summary = match model.limited_shafts().next() {
        Some(_) => {
            "Names of the joints that follow other joints, then of the motors that move several joints and have a speed limit."
        }
        None => "Names of the joints that follow other joints.",
    };
    let names = strings(Dimension::Fixed, dependent.iter().map(|one| one.name));
    let limits = [
        numbers(
            "DEPENDENT_JOINT_OFFSETS",
            "g₀: position of each dependent joint if all coordinates are 0 (rad or m).",
            |one| one.offset,
        ),
        constant(
            "DEPENDENT_POSITION_LIMITS",
            "Lowest and highest position of each dependent joint (rad or m); infinite if not described.",
            ConstantValue::Ranges(Dimension::Fixed, dependent.iter().map(|one| one.position).collect()),
        ),
        numbers(
            "DEPENDENT_VELOCITY_LIMITS",
            "Highest speed of each dependent joint (rad/s or m/s); infinite if not described.",
            |one| one.velocity,
        ),
    ];
    let names = constant("DEPENDENT_JOINT_NAMES", summary, names);
    free.into_iter().chain([names]).chain(ratios).chain(limits).collect()
}

/// Constant with the names of all joints that follow coordinates, if some of them have no row of ratios
/// because their ratios depend on free parameters.
fn free_followers(model: &Model, dependent: &[Dependent<'_>]) -> Option<Constant> {
    let followers = &dependent[..model.followers.len()];
    followers.iter().any(|one| one.ratios.is_none()).then(|| {
        let summary = "Names of all joints that follow other joints. A joint whose ratios depend on free parameters has no row in \
             the constants of dependent joints.";
        let names = followers.iter().map(|one| one.name);
        constant("FOLLOWER_NAMES", summary, strings(Dimension::Fixed, names))
    })
}

/// Constants with the ratios of joints that follow coordinates. If a joint follows a joint with prescribed
/// motion, the ratios to such joints are added.
fn ratios<'a>(coordinates: usize, rows: impl Iterator<Item = &'a Vec<f64>>) -> Vec<Constant> {
    let (of_coordinates, of_driven): (Vec<_>, Vec<_>) = rows
        .map(|row| row.split_at(coordinates))
        .map(|(own, driven)| (own.to_vec(), driven.to_vec()))
        .unzip();
    let summary = "G in `G y + g₀`, the positions of the dependent joints: one row per dependent joint.";
    let value = ConstantValue::Rows(Dimension::Coordinates, of_coordinates);
    let mut constants = vec![constant("DEPENDENT_JOINT_RATIOS", summary, value)];
    if of_driven.iter().flatten().any(|ratio| *ratio != 0.0) {
        let summary = "G_d in `G y + G_d d + g₀`, with the positions d of the driven joints: one row per dependent joint.";
        let value = ConstantValue::Rows(Dimension::Fixed, of_driven);
        constants.push(constant("DEPENDENT_DRIVEN_RATIOS", summary, value));
    }
    constants
}

fn joint_limits(joints: &[&Joint]) -> Vec<Constant> {
    const UNLIMITED: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    let positions = joints.iter().map(|joint| joint.limits.position);
    let positions = positions.map(|limits| limits.unwrap_or(UNLIMITED)).collect();
    let of_joints = |name, summary, limit: fn(&Joint) -> Option<f64>| {
        let limits = joints.iter().map(|joint| limit(joint));
        let limits = limits.map(|limit| limit.unwrap_or(f64::INFINITY)).collect();
        let value = ConstantValue::Numbers(Dimension::Coordinates, limits);
        constant(name, summary, value)
    };
    let further = [
        of_joints(
            "ACCELERATION_LIMITS",
            "Highest acceleration of each joint (rad/s² or m/s²); infinite if not described.",
            |joint| joint.limits.acceleration,
        ),
        of_joints(
            "JERK_LIMITS",
            "Highest jerk of each joint (rad/s³ or m/s³); infinite if not described.",
            |joint| joint.limits.jerk,
        ),
    ];
    // Few descriptions have them.
    let is_described = |joint: &&&Joint| joint.limits.acceleration.or(joint.limits.jerk).is_some();
    let further = joints.iter().find(is_described).map(|_| further);
    let limits = [
        constant(
            "POSITION_LIMITS",
            "Lowest and highest position of each joint (rad or m); infinite if not described.",
            ConstantValue::Ranges(Dimension::Coordinates, positions),
        ),
        of_joints(
            "VELOCITY_LIMITS",
            "Highest speed of each joint (rad/s or m/s); infinite if not described.",
            |joint| joint.limits.velocity,
        ),
        of_joints(
            "EFFORT_LIMITS",
            "Nominal force at each joint (N m or N); infinite if not described.",
            |joint| joint.limits.effort,
        ),
        of_joints(
            "PEAK_EFFORT_LIMITS",
            "Peak force at each joint (N m or N); the nominal force if no peak is described.",
            |joint| joint.limits.peak_effort.or(joint.limits.effort),
        ),
    ];
    limits.into_iter().chain(further.into_iter().flatten()).collect()
}

/// Constants with the limits of the inputs. If an input is a current, its limit is the torque limit divided
/// by the motor constant of the description.
fn input_limits(model: &Model, inputs: &[Actuator<'_>]) -> Vec<Constant> {
    let described = model.described_parameters();
    let limits = |torque: fn(&Drive) -> Option<f64>| -> Option<Vec<f64>> {
        let limit = |input: &Actuator<'_>| match input {
            Actuator::Drive(drive) => {
                Some(torque(drive).unwrap_or(f64::INFINITY) / torque_per_input(drive, &described)?)
            }
            Actuator::Force(force) => Some(magnitude(force)),
        };
        inputs.iter().map(limit).collect()
    };
    let nominal = limits(|drive| drive.torque.nominal);
    let peak = limits(|drive| drive.torque.peak.or(drive.torque.nominal));
    let numbers =
        |name, summary, values| constant(name, summary, ConstantValue::Numbers(Dimension::Inputs, values));
    let nominal = nominal.map(|values| {
        numbers(
            "INPUT_LIMITS",
            "Largest magnitude of each input that its motor bears continuously, in the unit of the input; infinite \
             if not described. `EFFORT_LIMITS` at the joint also applies.",
            values,
        )
    });
    let ranges = peak.as_ref().and_then(|peak| ranges(model, inputs, peak));
    let peak = peak.map(|values| {
        numbers(
            "PEAK_INPUT_LIMITS",
            "Largest magnitude of each input that its motor bears for a short time, in the unit of the input; the \
             nominal magnitude if no peak is described.",
            values,
        )
    });
    nominal.into_iter().chain(peak).chain(ranges).collect()
}

/// Constant with lowest and highest values of the inputs; `None` if no inputs act at frames.
fn ranges(model: &Model, inputs: &[Actuator<'_>], peak: &[f64]) -> Option<Constant> {
    if model.force_inputs.is_empty() {
        return None;
    }
    let range = |(input, &peak): (&Actuator<'_>, &f64)| match input {
        Actuator::Force(force) => force.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
        Actuator::Drive(_) => [-peak, peak],
    };
    let ranges = inputs.iter().zip(peak).map(range).collect();
    let summary = "Lowest and highest value of each input, in its unit; infinite if not described.";
    Some(constant("INPUT_RANGES", summary, ConstantValue::Ranges(Dimension::Inputs, ranges)))
}

/// Constants with the torque–speed lines of the motors, by input; `None` if no motor has a line.
fn torque_speed_lines(model: &Model) -> Option<[Constant; 2]> {
    let described = model.described_parameters();
    let lines = model.limited_inputs(&described);
    if lines.is_empty() {
        return None;
    }
    let (mut slopes, mut limits) = (vec![vec![0.0; model.coordinates.len()]; model.inputs().count()], vec![]);
    limits.resize(slopes.len(), f64::INFINITY);
    for line in lines {
        slopes[line.input] = line.slopes;
        limits[line.input] = line.limit;
    }
    Some([
        constant(
            "TORQUE_SPEED_SLOPES",
            "C in `|u + C ẏ| ≤ limit`, the torque–speed lines of the motors: one row per input, in its unit; 0 if \
             not described.",
            ConstantValue::Rows(Dimension::Coordinates, slopes),
        ),
        constant(
            "TORQUE_SPEED_LIMITS",
            "Limits of the torque–speed lines: the force of each input's motor at rest, in the unit of the input; infinite if not \
             described.",
            ConstantValue::Numbers(Dimension::Inputs, limits),
        ),
    ])
}

/// Constants of the drives. Constants that depend on free parameters are left out.
fn drives(model: &Model) -> Vec<Constant> {
    let count = model.input_drives().count();
    let are_all = model.force_inputs.is_empty();
    // If all inputs are drives, the number of values is the number of inputs.
    let dimension = if are_all { Dimension::Inputs } else { Dimension::Fixed };
    let number = (!are_all).then(|| {
        let summary = "Number of drives among the inputs. Drives come first; the other inputs act at frames.";
        constant("DRIVES", summary, ConstantValue::Count(count))
    });
    let of_drives = |name, summary, value: fn(&Drive) -> &Formula| {
        let values: Option<Vec<f64>> = model.input_drives().map(|drive| value(drive).value(&[])).collect();
        let values = values.filter(|values| are_all || !values.is_empty())?;
        Some(constant(name, summary, ConstantValue::Numbers(dimension, values)))
    };
    let constants = [
        of_drives("GEAR_RATIOS", "Gear ratio of each drive: motor angle divided by joint angle.", |drive| {
            &drive.gear_ratio
        }),
        of_drives(
            "ROTOR_INERTIAS",
            "Axial inertia of each rotor, on the motor side of the gear [kg m²].",
            |drive| &drive.rotor_inertia,
        ),
    ];
    number.into_iter().chain(constants.into_iter().flatten()).collect()
}

/// Constant with pairs of coordinates at which friction jumps. It exists even if it is empty, because
/// simulations need it.
fn friction_jumps(model: &Model) -> Constant {
    let summary = "Pairs of coordinates i, j: friction at i may jump if velocity j changes its sign, because a law has an \
         exact `sign`.";
    constant("FRICTION_JUMPS", summary, ConstantValue::Pairs(model.friction_jumps()))
}

/// Largest magnitude of a force or moment at a frame that is an input; infinite without limits.
fn magnitude(force: &ForceInput) -> f64 {
    force.limits.map_or(f64::INFINITY, |[low, high]| low.abs().max(high.abs()))
}

/// Motor torque per unit of a drive's input: 1, or the magnitude of the motor constant if the input is a
/// current.
fn torque_per_input(drive: &Drive, described: &[f64]) -> Option<f64> {
    match &drive.input {
        Input::Torque | Input::None => Some(1.0),
        Input::Current(motor_constant) => motor_constant.value(described).map(f64::abs),
    }
}

/// Constant with the gravitational acceleration; `None` if it depends on free parameters.
fn gravity(model: &Model) -> Option<Constant> {
    let values: Option<Vec<f64>> = model.gravity.iter().map(|g| g.value(&[])).collect();
    Some(constant(
        "GRAVITY",
        "Gravitational acceleration in the base frame [m/s²].",
        ConstantValue::Numbers(Dimension::Fixed, values?),
    ))
}
