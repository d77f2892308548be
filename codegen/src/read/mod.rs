//! Conversion of a description to a valid [`Model`].
//!
//! The readers of TOML, URDF and MJCF make a `RobotDescription`. The module `check` converts it to a model or
//! reports all problems.

mod composite;
mod description_files;
mod extended_frames;
mod fetch;
mod file_kind;
mod floating_base;
mod hold;
mod mjcf;
mod one_tree;
mod options;
mod skipped;
pub(crate) mod toml;
mod urdf;

pub use crate::description::angles::{NEARLY_RIGHT, NEARLY_RIGHT_ANGLE};
pub use description_files::{DescriptionFiles, read};
pub use fetch::Load;
pub use options::ReadOptions;

use self::fetch::{Fetch, Texts};
use self::toml::values::Reader;
use crate::check;
use crate::description::{BodyDescription, DriveChoice, JointDescription, Name, RobotDescription};
use crate::diagnostic::{At, Diagnostics, Report, Span, nearest};
use crate::model::{JointKind, Model, Pose};
use crate::wording::listed;
use gelenk_formula::Hold;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// A robot that was read, with notes and files.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The robot as a checked model.
    pub model: Model,
    /// Notes about elements of the description that were skipped or changed.
    pub notes: Diagnostics,
    /// All files that were read. The description is the first.
    pub files: Vec<PathBuf>,
}

/// Whether a file is XML. The extension of its name decides, or its content if the extension is unknown.
fn is_xml(name: &str, text: &str) -> bool {
    match Path::new(name).extension().and_then(|end| end.to_str()) {
        Some("toml") => false,
        Some("urdf" | "xml") => true,
        _ => without_mark(text).trim_start().starts_with('<'),
    }
}

/// The text without the byte order mark that some editors put before it.
fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Reads a TOML description.
///
/// - `text`: text of the description
/// - `name`: file name for messages; its stem is the name of the model if the text has no key `name`
/// - `load`: loads the TOML, URDF or MJCF that the description extends
///
/// # Errors
/// Returns all problems of the description.
pub fn from_toml(
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut Load<'_>,
) -> Result<(Model, Diagnostics), Diagnostics> {
    toml_with(text, name, options, &mut Texts(load))
}

/// Reads a TOML description. Unlike [`from_toml`], it can also load meshes of an extended MJCF.
fn toml_with(
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut dyn Fetch,
) -> Result<(Model, Diagnostics), Diagnostics> {
    let mut reader = Reader::new(options);
    let mut chain =
        Chain { load, files: Path::new(name).file_name().map(PathBuf::from).into_iter().collect() };
    let robot = read_toml(&mut reader, text, name, options, &mut chain);
    require_mjcf(&robot, options.body.is_some(), &mut reader.report);
    finish(reader, robot, options)
}

/// Reads the URDF `text`. `name` is its name in messages.
///
/// # Errors
/// Returns all problems of the description.
pub fn from_urdf(text: &str, name: &str, options: &ReadOptions) -> Result<(Model, Diagnostics), Diagnostics> {
    let mut reader = Reader::new(options);
    let robot = read_urdf(&mut reader, text, name, options);
    require_mjcf(&robot, options.body.is_some(), &mut reader.report);
    finish(reader, robot, options)
}

/// Reads an MJCF.
///
/// - `text`, `name`: text of the MJCF, and its name in messages
/// - `load`: loads included files, but no meshes, so geoms with meshes have no mass
///
/// # Errors
/// Returns all problems of the description.
pub fn from_mjcf(
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut Load<'_>,
) -> Result<(Model, Diagnostics), Diagnostics> {
    mjcf_with(text, name, options, &mut Texts(load))
}

fn mjcf_with(
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut dyn Fetch,
) -> Result<(Model, Diagnostics), Diagnostics> {
    let mut reader = Reader::new(options);
    let file = Path::new(name).file_name().map(PathBuf::from).unwrap_or_default();
    let robot = read_mjcf(&mut reader, text, name, &file, options, load);
    finish(reader, robot, options)
}

/// Reads XML: an MJCF if its root is `mujoco`, otherwise a URDF.
fn from_xml(
    text: &str,
    name: &str,
    options: &ReadOptions,
    load: &mut dyn Fetch,
) -> Result<(Model, Diagnostics), Diagnostics> {
    match file_kind::is_mjcf(text) {
        true => mjcf_with(text, name, options, load),
        false => from_urdf(text, name, options),
    }
}

/// Applies the options of the caller to the model, in addition to the options in the description.
fn apply(options: &ReadOptions, model: &mut Model) {
    model.options.smooth_sign = match options.exact_sign {
        true => None,
        false => options.smooth_sign.or(model.options.smooth_sign),
    };
    let slope = model.options.smooth_sign;
    for drive in &mut model.drives {
        if options.no_friction {
            drive.friction.clear();
        }
    }
    if let Some(slope) = slope {
        for term in model.drives.iter_mut().flat_map(|drive| &mut drive.friction) {
            term.basis = term.basis.with_smooth_sign(slope);
        }
        for force in &mut model.point_forces {
            force.law = force.law.with_smooth_sign(slope);
        }
    }
    let joints = model.links.iter_mut().filter_map(|link| link.joint.as_mut());
    for joint in joints {
        if options.no_friction {
            joint.friction.clear();
            joint.load_friction.clear();
        }
        let Some(slope) = slope else { continue };
        for term in joint.friction.iter_mut().chain(&mut joint.load_friction) {
            term.basis = term.basis.with_smooth_sign(slope);
        }
        for spring in &mut joint.springs {
            *spring = spring.with_smooth_sign(slope);
        }
    }
}

fn finish(
    mut reader: Reader,
    robot: Option<RobotDescription>,
    options: &ReadOptions,
) -> Result<(Model, Diagnostics), Diagnostics> {
    let unused = unused(&reader);
    let mut model = robot.and_then(|mut robot| {
        robot.parameters = std::mem::take(&mut reader.parameters);
        robot.accept_unphysical |= options.accept_unphysical;
        if options.floating_base {
            robot.floating_base.get_or_insert(robot.name.span);
        }
        floating_base::free(&mut robot, &mut reader.report);
        if options.ignore_mimic {
            note_followers(&robot, &mut reader.report);
        }
        if options.free_driven {
            free_driven(&mut robot);
        }
        let place = robot.name.span;
        let asked: Vec<_> = options.hold.iter().map(|hold| At::new(hold.clone(), place)).collect();
        hold::apply(&mut robot, &asked, &mut reader.report);
        hold::settle(&mut robot, &mut reader.report);
        check::model(&robot, &mut reader.report)
    });
    reader.angles.report(&mut reader.report);
    if let Some(model) = &mut model {
        if let Some((span, names)) = unused {
            let message = format!("no formula uses these parameters: {names}");
            reader.report.warning(span, "unused-parameter", message);
            reader
                .report
                .help("use them in formulas, as in `mass = \"2*m\"`, or remove them from [parameters]");
        }
        apply(options, model);
    }
    let failed = reader.report.has_errors();
    let diagnostics = reader.report.finish();
    match model {
        Some(model) if !failed => Ok((model, diagnostics)),
        _ => Err(diagnostics),
    }
}

/// The place of the first parameter that no formula uses, and a list of all unused parameters; `None` if all
/// are used.
fn unused(reader: &Reader) -> Option<(Span, String)> {
    let parameters: Vec<_> = reader.unused.iter().filter_map(|&index| reader.parameters.get(index)).collect();
    let names = listed(parameters.iter().map(|parameter| format!("`{}`", parameter.value.name)));
    Some((parameters.first()?.span, names))
}

/// Adds a note about joints that still follow other joints because of `follows` in a TOML file, although the
/// caller frees mimic joints.
fn note_followers(robot: &RobotDescription, report: &mut Report) {
    let follows = robot.joints.iter().filter_map(|joint| Some((joint, joint.follows.as_ref()?)));
    let found: Vec<_> = follows.collect();
    let Some((_, first)) = found.first() else { return };
    let names = listed(found.iter().map(|(joint, _)| joint.name.quoted()));
    let message = format!("these joints still follow other joints, because `follows` is given: {names}");
    report.note(Some(first.span), "mimic-not-ignored", message);
    report.help(
        "`--ignore-mimic` frees joints with <mimic> in a URDF and joints of equalities in an MJCF. Remove `follows` to free other joints",
    );
}

/// Makes driven joints (with a prescribed motion) independent joints without a drive.
fn free_driven(robot: &mut RobotDescription) {
    for joint in robot.joints.iter_mut().filter(|joint| joint.is_driven()) {
        let span = joint.driven.take().map_or(joint.name.span, |driven| driven.span);
        joint.drive = Some(At::new(DriveChoice::Passive, span));
    }
}

fn stem(name: &str) -> &str {
    let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str());
    stem.unwrap_or("robot")
}

fn read_urdf(reader: &mut Reader, text: &str, name: &str, options: &ReadOptions) -> Option<RobotDescription> {
    let text = without_mark(text);
    let source = reader.report.add_source(name, text);
    let Reader { report, angles, .. } = reader;
    urdf::description(report, angles, text, source, name, options)
}

/// Reads an MJCF to a robot description; `None` after an error.
///
/// - `path`: path of the file; paths of included files are relative to its folder
fn read_mjcf(
    reader: &mut Reader,
    text: &str,
    name: &str,
    path: &Path,
    options: &ReadOptions,
    load: &mut dyn Fetch,
) -> Option<RobotDescription> {
    let text = without_mark(text);
    let source = reader.report.add_source(name, text);
    let Reader { report, angles, .. } = reader;
    mjcf::description(report, angles, text, source, path, options, load)
}

/// Largest number of descriptions that extend each other in sequence.
const DEEPEST: usize = 8;

/// Descriptions that extend each other, and the function that loads the next description.
struct Chain<'l> {
    load: &'l mut dyn Fetch,
    /// Paths of the descriptions that were read, relative to the folder of the first description.
    files: Vec<PathBuf>,
}

impl Chain<'_> {
    /// Path of a file that the last description names, relative to the folder of the first description.
    fn path_of(&self, file: &str) -> PathBuf {
        let folder = self.files.last().and_then(|file| file.parent());
        folder.unwrap_or(Path::new("")).join(file)
    }

    fn contains(&self, path: &Path) -> bool {
        self.files.iter().any(|file| plain(file) == plain(path))
    }
}

/// A path without detours, for comparisons: `./a/../b` becomes `b`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        let last = plain.components().next_back();
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(last, Some(Component::Normal(_))) => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

fn read_toml(
    reader: &mut Reader,
    text: &str,
    name: &str,
    options: &ReadOptions,
    chain: &mut Chain<'_>,
) -> Option<RobotDescription> {
    let text = without_mark(text);
    let source = reader.report.add_source(name, text);
    let document = toml::parse(reader, text, source)?;
    let top = toml::open(reader, &document, source);
    let preamble = toml::preamble(reader, &top);
    let options = ReadOptions {
        ignore_mimic: options.ignore_mimic || preamble.ignore_mimic,
        no_friction: options.no_friction || preamble.no_friction,
        snap_angles: options.snap_angles.or(preamble.snap_angles),
        body: options.body.clone().or(preamble.body.as_ref().map(|body| body.value.clone())),
        ..options.clone()
    };
    reader.angles.snap = reader.angles.snap.or(options.snap_angles);
    let Some(file) = preamble.extends else {
        if let Some(body) = &preamble.body {
            reader.report.error(body.span, "body-without-scene", BODY_OF_MJCF);
            reader.report.help("name the MJCF with `extends`, or remove `body`");
        }
        let robot = toml::description(reader, &top, stem(name), None);
        return Some(held(robot, &preamble.held, &mut reader.report));
    };
    let base = read_base(reader, &file, &options, chain);
    let asked = options.floating_base.then_some(file.span);
    let extended = base.as_ref().map(|base| floating_base::extended(base, asked.is_some()));
    let extension = toml::description(reader, &top, stem(name), Some(extended.unwrap_or_default()));
    require_mjcf(&base, preamble.body.is_some(), &mut reader.report);
    let robot = base.map(|base| extend_freed(base, extension, asked, &mut reader.report));
    robot.map(|robot| held(robot, &preamble.held, &mut reader.report))
}

const BODY_OF_MJCF: &str = "`body` chooses a body of an MJCF scene, but the description extends no MJCF";

/// Reports an error if a body of a scene is chosen but the description extends no MJCF.
///
/// - `is_chosen`: whether a body is chosen
fn require_mjcf(robot: &Option<RobotDescription>, is_chosen: bool, report: &mut Report) {
    if let Some(robot) = robot.as_ref().filter(|robot| is_chosen && !robot.is_mjcf) {
        report.error(robot.name.span, "body-without-scene", BODY_OF_MJCF).help("remove `body`");
    }
}

/// Holds the joints that the description holds by name patterns.
fn held(mut robot: RobotDescription, holds: &[At<Hold>], report: &mut Report) -> RobotDescription {
    hold::apply(&mut robot, holds, report);
    robot
}

fn read_base(
    reader: &mut Reader,
    file: &Name,
    options: &ReadOptions,
    chain: &mut Chain<'_>,
) -> Option<RobotDescription> {
    let path = chain.path_of(&file.value);
    if chain.contains(&path) {
        let message = format!("the description extends itself through `{}`", file.value);
        reader.report.error(file.span, "extends-itself", message);
        reader.report.help("extend another description, or remove `extends`");
        return None;
    }
    chain.files.push(path.clone());
    if chain.files.len() > DEEPEST + 1 {
        let message =
            format!("the chain of `extends` has more than {DEEPEST} descriptions: shorten the chain");
        reader.report.error(file.span, "extends-too-deep", message);
        return None;
    }
    match chain.load.text(&path.to_string_lossy()) {
        Ok((name, text)) if is_xml(&name, &text) && file_kind::is_mjcf(&text) => {
            read_mjcf(reader, &text, &name, &path, options, chain.load)
        }
        Ok((name, text)) if is_xml(&name, &text) => read_urdf(reader, &text, &name, options),
        Ok((name, text)) => read_toml(reader, &text, &name, options, chain),
        Err(wrong) => {
            for entry in wrong.into_entries() {
                let here = entry.location().is_none().then_some(file.span);
                reader.report.push(here, entry);
            }
            None
        }
    }
}

/// Returns the extended description with the changes of the extension.
fn extend(mut base: RobotDescription, extension: RobotDescription, report: &mut Report) -> RobotDescription {
    let joints = index(base.joints.iter().map(|joint| &joint.name));
    for joint in extension.joints {
        extend_joint(&mut base, &joints, joint, report);
    }
    let bodies = index(base.bodies.iter().map(|body| &body.name));
    for body in extension.bodies {
        match bodies.get(&body.name.value) {
            Some(known) => extend_body(&mut base.bodies[*known], body),
            None => base.bodies.push(body),
        }
    }
    replace_or_add(&mut base.drives, extension.drives, |drive| &drive.name);
    replace_or_add(&mut base.point_forces, extension.point_forces, |force| &force.name);
    replace_or_add(&mut base.wrench_inputs, extension.wrench_inputs, |input| &input.name);
    replace_or_add(&mut base.wrenches, extension.wrenches, |wrench| &wrench.name);
    if !extension.description.is_empty() {
        base.description = extension.description;
    }
    let mut whole = RobotDescription {
        name: extension.name,
        gravity: extension.gravity.or(base.gravity),
        base: extension.base.or(base.base),
        coordinates: extension.coordinates.or(base.coordinates),
        options: extension.options.or(base.options),
        accept_unphysical: extension.accept_unphysical || base.accept_unphysical,
        ..base
    };
    extended_frames::replace(&mut whole, extension.frames);
    whole
}

/// Applies an extension to the description that it extends. If the base link is freed, its floating joint is
/// added first, so that the extension can refer to the joint.
fn extend_freed(
    mut base: RobotDescription,
    mut extension: RobotDescription,
    asked: Option<Span>,
    report: &mut Report,
) -> RobotDescription {
    if let Some(span) = extension.floating_base.take().or(base.floating_base).or(asked) {
        base.floating_base.get_or_insert(span);
        base.base = extension.base.take().or(base.base);
        floating_base::free(&mut base, report);
    }
    extend(base, extension, report)
}

/// Adds the entries of an extension. An entry replaces the entry of the base with the same name.
fn replace_or_add<T>(base: &mut Vec<T>, extension: Vec<T>, name: fn(&T) -> &Name) {
    for entry in extension {
        match base.iter_mut().find(|known| name(known).value == name(&entry).value) {
            Some(known) => *known = entry,
            None => base.push(entry),
        }
    }
}

fn index<'n>(names: impl Iterator<Item = &'n Name>) -> BTreeMap<String, usize> {
    names.enumerate().map(|(at, name)| (name.value.clone(), at)).collect()
}

/// Replaces mass, centre and inertia of a body by those values that the extension has. A new centre or
/// inertia is in the frame of the link, unless the extension has a new origin.
fn extend_body(known: &mut BodyDescription, body: BodyDescription) {
    let moved = body.center_of_mass.is_some() || body.inertia.is_some();
    let replaced = moved || body.mass.is_some();
    let below = known.origin.take();
    let origin = body.origin.map(|origin| body.unsaid.filled(origin, below.as_ref()));
    let kept = below.filter(|_| !moved);
    if moved && origin.is_none() {
        // Centre and inertia were in the old frame. The value that is kept is converted to the frame of the link.
        let unmoved = BodyDescription { origin: kept.clone(), ..known.clone() };
        known.center_of_mass = Some(unmoved.center_in_link());
        if let Some(inertia) = &mut known.inertia {
            inertia.value = unmoved.inertia_in_link();
        }
    }
    known.origin = origin.or(kept);
    known.mass = body.mass.or(known.mass.take());
    known.center_of_mass = body.center_of_mass.or(known.center_of_mass.take());
    known.inertia = body.inertia.or(known.inertia.take());
    known.accept_unphysical |= body.accept_unphysical;
    // A body with replaced numbers is checked like a body of the TOML file.
    known.is_published &= !replaced;
}

fn extend_joint(
    base: &mut RobotDescription,
    known: &BTreeMap<String, usize>,
    joint: JointDescription,
    report: &mut Report,
) {
    let Some(at) = known.get(&joint.name.value) else {
        return add_joint(base, known, joint, report);
    };
    let known = &mut base.joints[*at];
    // Its diagnostics point at the extension from now on.
    known.name = joint.name;
    known.kind = joint.kind.or(known.kind);
    known.parent = joint.parent.or(known.parent.take());
    known.child = joint.child.or(known.child.take());
    if let Some(origin) = joint.origin {
        // After a Denavit–Hartenberg row, or away from the body frame of an MJCF, a part of a pose would have another meaning.
        let is_plain = known.link_frame.as_ref().is_none_or(Pose::is_identity);
        let below = known.origin.as_ref().filter(|_| is_plain);
        known.origin = Some(joint.unsaid.filled(origin, below));
        known.link_frame = joint.link_frame;
    }
    known.axis = joint.axis.or(known.axis);
    if joint.follows.is_some() {
        known.held = None;
    }
    known.held = joint.held.or(known.held);
    known.driven = joint.driven.or(known.driven.take());
    if joint.follows.is_some() {
        (known.follows, known.offset) = (joint.follows, None);
    }
    known.offset = joint.offset.or(known.offset.take());
    known.springs = joint.springs.or(known.springs.take());
    known.friction = joint.friction.or(known.friction.take());
    known.drive = joint.drive.or(known.drive.take());
    let (limits, new) = (&mut known.limits, joint.limits);
    limits.position = new.position.or(limits.position.take());
    limits.velocity = new.velocity.or(limits.velocity.take());
    limits.effort = new.effort.or(limits.effort.take());
    limits.peak_effort = new.peak_effort.or(limits.peak_effort.take());
    limits.acceleration = new.acceleration.or(limits.acceleration.take());
    limits.jerk = new.jerk.or(limits.jerk.take());
}

fn add_joint(
    base: &mut RobotDescription,
    known: &BTreeMap<String, usize>,
    mut joint: JointDescription,
    report: &mut Report,
) {
    if joint.parent.is_none() {
        let message = format!("the file that `extends` or `urdf` names has no joint `{}`", joint.name.value);
        report.error(joint.name.span, "unknown-joint", message);
        let near = nearest(&joint.name.value, known.keys().map(String::as_str));
        report.help(format!("a new joint needs `parent`; {}", near.unwrap_or_default()));
        return;
    }
    joint.complete();
    if joint.kind != Some(JointKind::Fixed) {
        // The ideal drives of a URDF are those of its own joints.
        let passive = At::new(DriveChoice::Passive, joint.name.span);
        joint.drive.get_or_insert(passive);
    }
    if !base.links.is_empty() {
        base.links.extend(joint.child.clone());
    }
    base.joints.push(joint);
}
