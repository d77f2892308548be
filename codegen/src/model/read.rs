//! From files and texts to a [`Model`].

use super::description::{JointDescription, RobotDescription};
use super::toml_values::Reader;
use super::urdf::{self, UrdfOptions};
use super::{Model, toml_file, validate};
use crate::diagnostic::{At, Diagnostic, Diagnostics, Report, nearest};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Larger files are refused [bytes].
const LARGEST: u64 = 32 << 20;

/// How to read a description; the description's own keys of the same names count too.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReadOptions {
    /// Mimic joints of a URDF become independent.
    pub ignore_mimic: bool,
    /// Angles within this of a multiple of 90° become that multiple [rad].
    pub snap_angles: Option<f64>,
    /// All friction is left out.
    pub no_friction: bool,
}

/// A description that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The robot.
    pub model: Model,
    /// What was skipped or changed.
    pub notes: Diagnostics,
    /// Every file that was read, the description first.
    pub files: Vec<PathBuf>,
}

/// Reads a description, TOML or URDF by its content.
///
/// # Errors
/// All problems of the description, or that a file cannot be read.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Loaded, Diagnostics> {
    let text = read_file(path)?;
    let name = path.display().to_string();
    let mut files = vec![path.to_owned()];
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut load = |relative: &str| {
        let path = folder.join(relative);
        let text = read_file(&path)?;
        let name = path.display().to_string();
        files.push(path);
        Ok((name, text))
    };
    let (model, notes) = match is_xml(&text) {
        true => from_urdf(&text, &name, options),
        false => from_toml(&text, &name, options, &mut load),
    }?;
    Ok(Loaded {
        model,
        notes,
        files,
    })
}

fn is_xml(text: &str) -> bool {
    text.trim_start_matches('\u{feff}')
        .trim_start()
        .starts_with('<')
}

fn read_file(path: &Path) -> Result<String, Diagnostic> {
    let unreadable = |why: String| {
        Diagnostic::error(
            "file-unreadable",
            format!("cannot read {}: {why}", path.display()),
        )
    };
    let file = std::fs::File::open(path).map_err(|why| unreadable(why.to_string()))?;
    let mut bytes = Vec::new();
    file.take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(|why| unreadable(why.to_string()))?;
    if bytes.len() as u64 > LARGEST {
        return Err(unreadable(format!(
            "it is larger than {} MiB",
            LARGEST >> 20
        )));
    }
    String::from_utf8(bytes).map_err(|why| {
        let at = why.utf8_error().valid_up_to();
        unreadable(format!("byte {at} is no UTF-8")).help("descriptions are UTF-8 text")
    })
}

/// Fetches a file that a description names: its name for diagnostics, and its text.
pub type Load<'l> = dyn FnMut(&str) -> Result<(String, String), Diagnostic> + 'l;

/// Reads a TOML description.
///
/// - `text`, `name`: the text and the name to show for it; the model's name where the text gives none
/// - `load`: fetches the URDF that the description extends
///
/// # Errors
/// All problems of the description.
pub fn from_toml(
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut Load<'_>,
) -> Result<(Model, Diagnostics), Diagnostics> {
    let mut reader = Reader::default();
    let robot = read_toml(&mut reader, text, name, options, load);
    finish(reader, robot, options)
}

/// Reads a URDF.
///
/// # Errors
/// All problems of the description.
pub fn from_urdf(
    text: &str,
    name: &str,
    options: &ReadOptions,
) -> Result<(Model, Diagnostics), Diagnostics> {
    let mut reader = Reader::default();
    reader.angles.snap = options.snap_angles;
    let read = UrdfOptions {
        ignore_mimic: options.ignore_mimic,
        no_friction: options.no_friction,
    };
    let robot = read_urdf(&mut reader, text, name, read);
    finish(reader, robot, options)
}

fn finish(
    mut reader: Reader,
    robot: Option<RobotDescription>,
    options: &ReadOptions,
) -> Result<(Model, Diagnostics), Diagnostics> {
    let mut model = robot.and_then(|robot| validate::model(&robot, &mut reader.report));
    reader.angles.report(&mut reader.report);
    if let Some(model) = model.as_mut().filter(|_| options.no_friction) {
        let joints = model
            .links
            .iter_mut()
            .filter_map(|link| link.joint.as_mut());
        joints.for_each(|joint| joint.friction.clear());
    }
    let failed = reader.report.has_errors();
    let diagnostics = reader.report.finish();
    match model {
        Some(model) if !failed => Ok((model, diagnostics)),
        _ => Err(diagnostics),
    }
}

fn stem(name: &str) -> &str {
    Path::new(name)
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or("robot")
}

fn read_urdf(
    reader: &mut Reader,
    text: &str,
    name: &str,
    options: UrdfOptions,
) -> Option<RobotDescription> {
    let text = text.trim_start_matches('\u{feff}');
    let source = reader.report.add_source(name, text);
    urdf::description(
        &mut reader.report,
        &mut reader.angles,
        text,
        source,
        stem(name),
        options,
    )
}

fn read_toml(
    reader: &mut Reader,
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut Load<'_>,
) -> Option<RobotDescription> {
    let source = reader.report.add_source(name, text);
    let document = toml_file::parse(reader, text, source)?;
    let top = toml_file::open(reader, &document, source);
    let preamble = toml_file::preamble(reader, &top);
    reader.angles.snap = options.snap_angles.or(preamble.snap_angles);
    let Some(urdf) = preamble.urdf else {
        return Some(toml_file::description(reader, &top, stem(name), false));
    };
    let read = UrdfOptions {
        ignore_mimic: options.ignore_mimic || preamble.ignore_mimic,
        no_friction: options.no_friction || preamble.no_friction,
    };
    let base = match load(&urdf.value) {
        Ok((name, text)) => read_urdf(reader, &text, &name, read),
        Err(wrong) => {
            reader.report.push(Some(urdf.span), wrong);
            None
        }
    };
    let extension = toml_file::description(reader, &top, stem(name), true);
    base.map(|base| extend(base, extension, &mut reader.report))
}

/// The base with everything that the extension says instead or besides.
fn extend(
    mut base: RobotDescription,
    extension: RobotDescription,
    report: &mut Report,
) -> RobotDescription {
    for joint in extension.joints {
        extend_joint(&mut base, joint, report);
    }
    for body in extension.bodies {
        match base
            .bodies
            .iter_mut()
            .find(|known| known.name.value == body.name.value)
        {
            Some(known) => {
                known.origin =
                    body.origin
                        .or(if body.center_of_mass.is_some() || body.inertia.is_some() {
                            None
                        } else {
                            known.origin.take()
                        });
                known.mass = body.mass.or(known.mass.take());
                known.center_of_mass = body.center_of_mass.or(known.center_of_mass.take());
                known.inertia = body.inertia.or(known.inertia.take());
                known.accept_unphysical |= body.accept_unphysical;
            }
            None => base.bodies.push(body),
        }
    }
    if !extension.frames.is_empty() {
        base.frames = extension.frames;
    }
    RobotDescription {
        name: extension.name,
        description: extension.description,
        gravity: extension.gravity.or(base.gravity),
        parameters: extension.parameters,
        base: extension.base.or(base.base),
        coordinates: extension.coordinates,
        options: extension.options,
        ..base
    }
}

fn extend_joint(base: &mut RobotDescription, joint: JointDescription, report: &mut Report) {
    let Some(known) = base
        .joints
        .iter_mut()
        .find(|known| known.name.value == joint.name.value)
    else {
        if joint.parent.is_some() && joint.child.is_some() {
            base.links.extend(joint.child.clone());
            base.joints.push(joint);
            return;
        }
        let message = format!("the base URDF has no joint `{}`", joint.name.value);
        report.error(joint.name.span, "unknown-joint", message);
        let known = nearest(
            &joint.name.value,
            base.joints.iter().map(|known| known.name.value.as_str()),
        );
        report.help(format!(
            "{}; a new joint needs `parent` and `child`",
            known.unwrap_or_default()
        ));
        return;
    };
    known.name = At::new(joint.name.value, joint.name.span);
    known.kind = joint.kind.or(known.kind);
    known.parent = joint.parent.or(known.parent.take());
    known.child = joint.child.or(known.child.take());
    known.link_frame = joint.link_frame.or(known.link_frame.take());
    known.origin = joint.origin.or(known.origin.take());
    known.axis = joint.axis.or(known.axis);
    known.held = joint.held.or(known.held);
    known.springs = joint.springs.or(known.springs.take());
    known.friction = joint.friction.or(known.friction.take());
    known.drive = joint.drive.or(known.drive.take());
    let limits = joint.limits;
    known.limits.position = limits.position.or(known.limits.position.take());
    known.limits.velocity = limits.velocity.or(known.limits.velocity.take());
    known.limits.effort = limits.effort.or(known.limits.effort.take());
    known.limits.peak_effort = limits.peak_effort.or(known.limits.peak_effort.take());
}
