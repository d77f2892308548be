//! The command `gelenk identify` with logs: identifies a robot, and writes the description and the report page.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::ValueEnum;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use gelenk_identification::estimation::JointEstimate;
use gelenk_identification::identify::{Identification, IdentificationSettings, identify};
use gelenk_identification::log::ColumnOptions;
use gelenk_identification::result::FrictionResult;
use gelenk_identification::result::description::{Identified, write_identified};
use gelenk_identification::robot::Robot;
use gelenk_identification::run::Effort;
use gelenk_identification::validation::{JointValidation, validate};

use super::super::arguments::{DerivativeName, EffortName, Format, FrictionPlace, Identify};
use super::super::failure::Failure;
use super::super::place::{self, Workspace, shown};
use super::super::{print, report};
use super::found_json;
use super::moments::MOMENTS;
use super::motor_constants;
use super::read::{read, say};
use crate::dynamics::parameters::regressor::PER_LINK;
use crate::identify::{
    IdentifiedDrive, InterpretedRobot, LinkBodies, bodies, front, joint_tables, page, round_bodies,
    shaft_rotor, write_drives,
};
use crate::model::{Drive, Input, Joint, Model, Motion};
use crate::read::Loaded;
use crate::wording::{list, quoted};

/// Sees: wrenches of the description without columns in the logs.
/// Matters: these wrenches are assumed to be zero.
/// Example: a wrench at the tool.
/// Fixture: `codegen/tests/findings/online.rs`.
const WRENCHES: Rule = Rule::note("wrenches-zero");

/// Sees: described friction that is not identified.
/// Matters: this friction stays as described.
/// Example: friction of a joint that follows another joint.
/// Fixture: `codegen/tests/coupled_identification/described.rs`.
const KEPT: Rule = Rule::note("friction-kept");

/// Sees: rotors without an input.
/// Matters: a description has no key for their identified inertia.
/// Example: `armature` of a joint without an actuator in MJCF.
/// Fixture: `codegen/tests/coupled_identification/described.rs`.
const ROTORS: Rule = Rule::note("rotors-kept");

/// Sees: load-dependent friction that is described but was not identified.
/// Matters: laws of the velocity alone replace it.
/// Example: the key `load` of a described friction, without `--load-friction`.
/// Fixture: `codegen/tests/identified_friction.rs`.
const LOAD_LOST: Rule = Rule::note("load-friction-replaced");

/// Identifies the robot from logs, and writes the description and the page.
pub(super) fn write(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    let (loaded, robot) = read(arguments)?;
    let output = output(arguments, &loaded, "identified")?;
    let settings = settings(arguments)?;
    let mut found = print::identified(identify(&robot, &arguments.logs, &settings, &mut say))?;
    motor_constants::add_doubts(&mut found);
    let validation = match arguments.validate.as_slice() {
        [] => Vec::new(),
        logs => {
            let validation = print::identified(validate(&robot, &found, logs, &settings, &mut say));
            print::after(validation, &found.findings(&robot))?
        }
    };
    finish(arguments, format, &loaded, &robot, &found, &validation, &output)
}

/// Writes the results of an identification: the description, the page, and a table or JSON on standard
/// output.
pub(super) fn finish(
    arguments: &Identify,
    format: Format,
    loaded: &Loaded,
    robot: &InterpretedRobot,
    found: &Identification,
    validation: &[JointValidation],
    output: &Path,
) -> Result<ExitCode, Failure> {
    let command = &command(arguments);
    let remarks = [
        replaced_load(&loaded.model, found),
        without_wrenches(&loaded.model),
        as_described(arguments, &loaded.model, robot),
        friction_of_followers(&loaded.model),
        rotors_without_input(&loaded.model),
    ];
    let constants = motor_constants::findings(found);
    let findings: Vec<Finding> =
        found.findings(robot).into_iter().chain(remarks.into_iter().flatten()).chain(constants).collect();
    let described = describe(arguments, &loaded.model, robot, found, &findings, command, output);
    print::after(described, &findings)?;
    let name = &loaded.model.name;
    let files = match &arguments.report {
        Some(folder) => {
            let page = page::page(name, robot, found, command);
            print::after(report::written(&page, folder, "--report"), &findings)?
        }
        None => Vec::new(),
    };
    let front = arguments.method.as_ref().map(|_| front(found)).filter(|table| table.len() > 1);
    print::result(
        format,
        || found_json::as_json(found, &findings, validation, output, &files),
        || as_text(found, &findings, front, validation, output, &files),
    )
}

pub(super) fn settings(arguments: &Identify) -> Result<IdentificationSettings, Failure> {
    let effort = arguments.effort.map(|name| match name {
        EffortName::Joint => Effort::Joint,
        EffortName::Input => Effort::Input,
        EffortName::Current => Effort::Current,
    });
    let mut settings = IdentificationSettings::new()?;
    settings.columns =
        ColumnOptions { columns: arguments.columns.clone(), effort, separator: arguments.separator };
    settings.preparation.bandwidth = arguments.bandwidth;
    settings.preparation.delay = arguments.delay;
    settings.preparation.total_variation = arguments.derivative == DerivativeName::Tvdiff;
    settings.estimation.gravity_compensated = arguments.gravity_compensated;
    settings.estimation.load_friction = arguments.load_friction;
    settings.estimation.accept_poor = arguments.accept_poor;
    settings.accept_poor = arguments.accept_poor;
    if let Some(terms) = &arguments.friction {
        settings.friction = settings.friction.of_terms(terms)?;
    }
    if let Some(word) = &arguments.method {
        settings.friction = settings.friction.by_method(word, arguments.threshold)?;
    }
    Ok(settings)
}

/// Returns a finding about parts of the description with these names; `None` if there are no names.
fn about<'a>(
    rule: Rule,
    names: impl Iterator<Item = &'a str>,
    said: impl Fn(String) -> String,
) -> Option<Finding> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| rule.found(said(list(names.into_iter()))))
}

/// Returns the finding that wrenches of the description are assumed to be zero.
fn without_wrenches(model: &Model) -> Option<Finding> {
    about(WRENCHES, model.wrenches.iter().map(|wrench| wrench.name.as_str()), |names| {
        format!(
            "the wrenches {names} are assumed to be zero. If a wrench acts, describe it by `[[inputs]]`, and add its columns to the log"
        )
    })
}

/// Returns the finding about described friction of shafts that is not identified.
fn as_described(arguments: &Identify, model: &Model, robot: &InterpretedRobot) -> Option<Finding> {
    let kept = robot.shafts_as_described();
    let names = model.rubbing_drives().map(|drive| drive.name.as_str()).filter(|name| kept.contains(name));
    let reason = match arguments.friction_on {
        FrictionPlace::Joints => "--friction-on joints was given",
        FrictionPlace::Shafts => "other drives move the same joints",
    };
    about(KEPT, names, |names| {
        format!("friction on the shafts of {names} stays as described, because {reason}")
    })
}

/// Returns the finding that friction of joints that follow others is not identified.
fn friction_of_followers(model: &Model) -> Option<Finding> {
    let joints = model.links.iter().filter_map(|link| link.joint.as_ref());
    let follows = |joint: &&Joint| matches!(joint.motion, Motion::Follower(_)) && !joint.friction.is_empty();
    about(KEPT, joints.filter(follows).map(|joint| joint.name.as_str()), |names| {
        format!(
            "friction of joints that follow other joints ({names}) is not identified and stays as described"
        )
    })
}

/// Returns the finding about rotors without an input, for example `armature` of MJCF joints without an
/// actuator. A description has no key for such rotors.
fn rotors_without_input(model: &Model) -> Option<Finding> {
    let drives = model.moving_drives().filter(|drive| drive.input == Input::None);
    about(ROTORS, drives.map(|drive| drive.name.as_str()), |names| {
        format!(
            "the written file has the described inertia of rotors without an input ({names}). Only the table of parameters has \
             their identified inertia"
        )
    })
}

/// Returns the finding about described load-dependent friction that is replaced by laws of the velocity.
fn replaced_load(model: &Model, found: &Identification) -> Option<Finding> {
    let laws = || found.friction.iter().filter_map(|joint| joint.report.as_ref().ok());
    let replaced = |name: &str| laws().any(|law| law.result.joint == name && law.result.load.is_empty());
    let described = model.joints().filter(|joint| !joint.load_friction.is_empty());
    about(LOAD_LOST, described.map(|joint| joint.name.as_str()).filter(|name| replaced(name)), |names| {
        format!(
            "the described load-dependent friction of {names} was not identified, and laws of the velocity replace it. Use \
             `--load-friction` to identify it"
        )
    })
}

/// Returns the path of the written description. Fails if this file is an input of the command.
///
/// - `kind`: end of the name without `--output`
pub(super) fn output(arguments: &Identify, loaded: &Loaded, kind: &str) -> Result<PathBuf, Failure> {
    let default = || PathBuf::from(format!("{}_{kind}.toml", loaded.model.name));
    let output = arguments.output.clone().unwrap_or_else(default);
    let logs = arguments.logs.iter().chain(&arguments.validate).chain(&arguments.payload);
    place::require_writable(&output, loaded.files.iter().chain(logs))?;
    Ok(output)
}

/// Returns the command line as text for the written description and the report page. The text does not depend on
/// the machine.
pub(super) fn command(arguments: &Identify) -> String {
    let workspace = Workspace::find();
    let logs = if arguments.merge { &[][..] } else { &arguments.logs };
    let files = std::iter::once(&arguments.description).chain(logs);
    let files = files.map(|file| quoted(&shown(file, workspace.as_ref())));
    let word =
        |option: &str, value: Option<String>| value.map(|value| format!("{option} {}", quoted(&value)));
    let loaded = arguments.payload.iter().map(|log| word("--payload", Some(shown(log, workspace.as_ref()))));
    let options = [
        arguments.merge.then(|| format!("--merge *.{MOMENTS}")),
        word("--columns", arguments.columns.clone()),
        word("--separator", arguments.separator.map(String::from)),
        word("--effort", arguments.effort.and_then(name_of)),
        word("--bandwidth", arguments.bandwidth.map(|hertz| format!("{hertz:?}"))),
        word("--delay", arguments.delay.map(|seconds| format!("{seconds:?}"))),
        arguments.gravity_compensated.then(|| "--gravity-compensated".to_owned()),
        arguments.load_friction.then(|| "--load-friction".to_owned()),
        word("--friction", arguments.friction.clone()),
        word("--method", arguments.method.clone()),
        word("--threshold", arguments.threshold.map(|threshold| format!("{threshold:?}"))),
        word(
            "--derivative",
            Some(arguments.derivative).filter(|name| *name != DerivativeName::Filter).and_then(name_of),
        ),
        word("--payload-on", arguments.payload_on.clone()),
        (arguments.friction_on == FrictionPlace::Joints).then(|| "--friction-on joints".to_owned()),
        arguments.accept_poor.then(|| "--accept-poor".to_owned()),
        arguments.online.then(|| "--online".to_owned()),
    ];
    let words = std::iter::once("gelenk identify".to_owned())
        .chain(files)
        .chain(options.into_iter().chain(loaded).flatten());
    words.chain(arguments.reading.words()).collect::<Vec<_>>().join(" ")
}

/// Returns the word with which an option's value is written on the command line.
fn name_of(value: impl ValueEnum) -> Option<String> {
    Some(value.to_possible_value()?.get_name().to_owned())
}

fn describe(
    arguments: &Identify,
    described: &Model,
    robot: &InterpretedRobot,
    found: &Identification,
    findings: &[Finding],
    command: &str,
    output: &Path,
) -> Result<(), Failure> {
    let values: Vec<f64> = found.estimate.parameters.iter().map(|parameter| parameter.value).collect();
    let (links, others) = values.split_at(PER_LINK * robot.bodies());
    if !found.estimate.consistent {
        let message = "nothing is written, because the estimate contains a body that is physically impossible. Record a motion \
                       that moves the bodies more";
        return Err(Failure::Problem(message.to_owned()));
    }
    let bodies_of = |parameters: &[f64]| {
        bodies(robot.model(), parameters).map_err(|problems| Failure::Descriptions(vec![problems]))
    };
    let mut bodies = bodies_of(links)?;
    round_bodies(&mut bodies, &bodies_of(&robot.parameters()[..links.len()])?, &found.estimate);
    let mut tables: Vec<String> = bodies.iter().flat_map(LinkBodies::toml).collect();
    if let Some(terms) = found.joint_terms() {
        tables.extend(joint_tables(robot.model(), &terms));
    }
    let rotor = |drive: &Drive| shaft_rotor(robot.model(), &drive.name).map(|place| others[place]);
    let drives =
        write_drives(robot.model(), described, |drive| identified_drive(found, drive, rotor(drive)))?;
    tables.extend(drives.tables);
    let of_joints = found.friction.iter().filter(|law| found.shaft(law.joint).is_none());
    let friction = of_joints.filter_map(|law| law.report.as_ref().ok());
    let friction: Vec<FrictionResult> = friction.map(|report| report.result.clone()).collect();
    let provenance = provenance(found, findings, command);
    let identified = Identified {
        provenance: &provenance,
        friction: &friction,
        drives: &drives.of_joints,
        bodies: &tables,
        ..Identified::default()
    };
    write_description(arguments, identified, output)
}

/// Returns the identified values of a drive, and whether a friction law of its joint was found.
fn identified_drive<'a>(
    found: &'a Identification,
    drive: &Drive,
    rotor: Option<f64>,
) -> (IdentifiedDrive<'a>, bool) {
    let shaft = (0..found.estimate.joints.len()).find(|row| found.shaft(*row) == Some(&drive.name));
    let joint = shaft.or(drive.coordinate()).map(|row| &found.estimate.joints[row]);
    let identified = IdentifiedDrive {
        friction: shaft.and_then(|row| found.law(row)).map(|report| &report.result),
        rotor,
        added: joint.and_then(|joint| joint.armature).map(|inertia| inertia.value),
        motor_constant: joint.and_then(|joint| joint.gain).map(|gain| gain.value),
    };
    (identified, drive.coordinate().is_some_and(|joint| found.law(joint).is_some()))
}

/// Returns comments for the top of the written description: command, hashes of the logs, fits and findings.
fn provenance(found: &Identification, findings: &[Finding], command: &str) -> Vec<String> {
    let hashes = found.recording.hashes.iter().map(|(path, hash)| {
        let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        format!("{name}: sha256 {hash}")
    });
    let judged = found.estimate.joints.iter().filter(|joint| page::is_judged(joint));
    let fits = judged.map(|joint| {
        let JointEstimate { name, held_out_r_squared, r_squared, held_out_with_rest, rest, .. } = joint;
        let at_rest = if *rest > 0.0 {
            format!(", {held_out_with_rest:.4} with the {:.0} % of the samples at rest", 100.0 * rest)
        } else {
            String::new()
        };
        let residual = residual(joint);
        format!(
            "{name}: R² {held_out_r_squared:.4} on held-out data{at_rest}, {r_squared:.4} in the fit, residual {residual}"
        )
    });
    std::iter::once(command.to_owned())
        .chain(hashes)
        .chain(fits)
        .chain(findings.iter().map(ToString::to_string))
        .collect()
}

/// Returns the residual of a joint with its unit as text.
fn residual(joint: &JointEstimate) -> String {
    format!("{} {}", plain(joint.sigma, 3), joint.unit)
}

/// Writes a description that extends the described robot. The path of the extended description is relative if
/// it is in the folder of the output or below it, otherwise absolute.
pub(super) fn write_description(
    arguments: &Identify,
    identified: Identified<'_>,
    output: &Path,
) -> Result<(), Failure> {
    let name = output.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let fault = |error| Failure::Problem(format!("{}: {error}", arguments.description.display()));
    let description = arguments.description.canonicalize().map_err(fault)?;
    let path = description.strip_prefix(place::folder(output)?).unwrap_or(&description);
    let (extends, settings) = (path.display().to_string(), arguments.reading.keys());
    let identified = Identified { name: &name, extends: &extends, settings: &settings, ..identified };
    Ok(write_identified(output, &identified)?)
}

fn as_text(
    found: &Identification,
    findings: &[Finding],
    front: Option<Vec<Vec<String>>>,
    validation: &[JointValidation],
    output: &Path,
    files: &[PathBuf],
) -> String {
    let mut text = print::lines(findings);
    text.push('\n');
    let rest = page::has_rest(found);
    let with_rest: &[&str] = if rest { &["with rest"] } else { &[] };
    let last = ["R² fit", "residual", "offset", "friction"];
    let head = [&[page::rows_are(found), "R² held-out"], with_rest, &last].concat();
    let rows = found.estimate.joints.iter().enumerate().map(|(index, joint)| {
        let number =
            |value: f64| if page::is_judged(joint) { format!("{value:.4}") } else { "–".to_owned() };
        let first = [joint.name.clone(), number(joint.held_out_r_squared)].into_iter();
        let last = [
            number(joint.r_squared),
            if joint.measured { residual(joint) } else { "–".to_owned() },
            page::offsets(joint),
            page::law(found, index),
        ];
        first.chain(rest.then(|| number(joint.held_out_with_rest))).chain(last).collect()
    });
    text.push_str(&print::headed(&head, rows));
    if let Some(front) = front {
        text.push_str(&format!("\n{}", print::table(&front)));
    }
    text.push_str(&validated(validation));
    text.push_str(&format!("\nwrote {}\n", output.display()));
    if let Some(page) = files.first() {
        text.push_str(&format!("wrote {} and {} data files\n", page.display(), files.len() - 1));
    }
    text
}

/// Returns the table about the prediction of the logs of `--validate`; empty if there are no such logs.
fn validated(validation: &[JointValidation]) -> String {
    if validation.is_empty() {
        return String::new();
    }
    let head = ["joint", "R² in validation logs", "with rest", "residual", "offset", "R² with it"];
    let rows = validation.iter().map(|joint| {
        let share = |r: f64| if r.is_nan() { "–".to_owned() } else { format!("{r:.4}") };
        vec![
            joint.name.clone(),
            share(joint.r_squared),
            share(joint.r_squared_with_rest),
            plain(joint.residual, 3),
            plain(joint.offset, 2),
            share(joint.r_squared_with_offset),
        ]
    });
    format!("\n{}", print::headed(&head, rows))
}
