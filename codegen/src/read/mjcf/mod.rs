//! Reader of MJCF, the format of MuJoCo. It makes a [`RobotDescription`].
//!
//! Elements that affect the equations of motion are read as MuJoCo's compiler reads them. Other elements are
//! skipped with a note.

mod actuators;
mod attach;
mod bodies;
mod classes;
mod compiler;
mod equalities;
mod files;
mod inertia;
mod joints;
mod mesh;
mod meshes;
mod notes;
mod place;
mod schema;
mod vocabulary;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::description::angles::Angles;
use crate::description::{DriveChoice, Name, RobotDescription};
use crate::diagnostic::{At, Report, Span, nearest};
use crate::distinct::Distinct;
use crate::model::Pose;
use crate::read::fetch::Fetch;
use crate::read::one_tree;
use crate::read::options::ReadOptions;
use crate::read::skipped::Notes;
use classes::Classes;
use compiler::Compiler;
use files::{Element, Files, Given, Meshes, Text, plain_path};
use gelenk_formula::{Formula, LARGEST_NUMBER, too_large};

/// Name of the link of all parts that do not move.
const WORLD: &str = "world";

/// Sections of an MJCF that do not affect the equations of motion.
const HARMLESS: [&str; 9] =
    ["size", "visual", "statistic", "asset", "contact", "sensor", "keyframe", "custom", "extension"];

/// Properties of a joint that other sections need.
struct KnownJoint {
    name: Name,
    /// Position of the joint in the pose of the file (attribute `ref`).
    reference: f64,
    has_quaternion: bool,
    is_free: bool,
    /// Inertia that the joint's armature adds to the diagonal of the mass matrix.
    armature: f64,
}

pub(super) struct Reader<'r, 'a> {
    report: &'r mut Report,
    angles: &'r mut Angles,
    options: ReadOptions,
    files: &'a Files<'a>,
    classes: Classes<'a>,
    compiler: Compiler,
    meshes: Meshes<'a, 'r>,
    gravity: [f64; 3],
    notes: Notes,
    robot: RobotDescription,
    /// Properties of joints by their names in the file.
    joints: BTreeMap<String, KnownJoint>,
    sites: BTreeSet<String>,
    /// For each body, the index of its first joint in the list of joints.
    bodies: BTreeMap<String, usize>,
    /// Models that `<asset>` names, and the folder in which their paths begin.
    models: Vec<Element<'a>>,
    folder: PathBuf,
    /// Files of the models to which this model is attached, then its own file. They detect models that attach
    /// themselves.
    chain: Vec<PathBuf>,
    link_names: Distinct,
    joint_names: Distinct,
    drive_names: Distinct,
}

/// An element in a body, with the pose of the enclosing frames and its default class.
#[derive(Clone)]
struct Placed<'a> {
    element: Element<'a>,
    pose: Pose,
    class: usize,
    /// Suffix of the element's name, from the enclosing `<replicate>` elements.
    suffix: String,
}

impl<'a> Placed<'a> {
    /// An element outside of bodies, with the identity pose.
    fn outside(element: Element<'a>, class: usize) -> Self {
        Self { element, pose: Pose::identity(), class, suffix: String::new() }
    }
}

/// A model that can be attached to another model.
struct Part {
    robot: RobotDescription,
    joints: BTreeMap<String, KnownJoint>,
    sites: BTreeSet<String>,
    bodies: BTreeMap<String, usize>,
}

/// Reads an MJCF; `None` if the text is not XML or has no model.
///
/// - `text`: the text, and its index in the report
/// - `path`: path of the file; paths of included files are relative to its folder
pub(super) fn description(
    report: &mut Report,
    angles: &mut Angles,
    text: &str,
    source: usize,
    path: &Path,
    options: &ReadOptions,
    load: &mut dyn Fetch,
) -> Option<RobotDescription> {
    read(report, angles, Text::new(path, source, text), options, load, &[]).map(|part| part.robot)
}

/// Reads a model, which may be attached to another model. Armatures and the sum of masses are applied to the
/// whole model only.
///
/// - `before`: files of the models to which this model is attached
fn read(
    report: &mut Report,
    angles: &mut Angles,
    text: Text,
    options: &ReadOptions,
    load: &mut dyn Fetch,
    before: &[PathBuf],
) -> Option<Part> {
    let path = text.path.clone();
    let texts = files::gather(text, &mut *load, report)?;
    let files = Files::parse(&texts);
    let root = files.root()?;
    if root.tag() != "mujoco" {
        let message = format!(
            "the root element is `{}`, but that of a robot is `robot` (URDF) or `mujoco` (MJCF)",
            root.tag()
        );
        report.error(root.span(), "not-a-robot", message);
        return None;
    }
    let sections = files.children(root);
    let defaults: Vec<Element<'_>> =
        sections.iter().copied().filter(|section| section.tag() == "default").collect();
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("robot");
    let mut reader = Reader {
        report,
        angles,
        options: options.clone(),
        classes: Classes::of(&defaults, &files),
        files: &files,
        compiler: Compiler {
            folder: path.parent().map(Path::to_owned).unwrap_or_default(),
            ..Compiler::default()
        },
        meshes: Meshes { load, assets: BTreeMap::new(), known: BTreeMap::new() },
        gravity: [0.0, 0.0, -9.81],
        notes: Notes::default(),
        robot: RobotDescription {
            name: At::new(stem.to_owned(), root.span()),
            default_drive: DriveChoice::Passive,
            is_mjcf: true,
            links: vec![At::new(WORLD.to_owned(), root.span())],
            ..RobotDescription::default()
        },
        joints: BTreeMap::new(),
        sites: BTreeSet::new(),
        bodies: BTreeMap::new(),
        models: Vec::new(),
        folder: path.parent().map(Path::to_owned).unwrap_or_default(),
        chain: before.iter().cloned().chain([path]).collect(),
        link_names: Distinct::from_iter([WORLD.to_owned()]),
        joint_names: Distinct::default(),
        drive_names: Distinct::default(),
    };
    reader.model(root, &sections);
    if before.is_empty() {
        reader.scale_masses();
        reader.armatures();
    }
    reader.notes.report(|_| true, reader.report);
    if let Some(body) = &options.body {
        one_tree::keep(&mut reader.robot, WORLD, body, root.span(), reader.report);
    }
    let Reader { robot, joints, sites, bodies, .. } = reader;
    Some(Part { robot, joints, sites, bodies })
}

impl<'a> Reader<'_, 'a> {
    fn model(&mut self, root: Element<'a>, sections: &[Element<'a>]) {
        if let Some(name) = self.name(root, "model") {
            self.robot.name = name;
        }
        let with = |tag: &'static str| sections.iter().copied().filter(move |section| section.tag() == tag);
        with("compiler").for_each(|section| self.compiler(section));
        with("option").for_each(|section| self.option(section));
        self.robot.gravity = Some(self.gravity.map(Formula::Number));
        self.vocabulary(sections);
        with("asset").for_each(|section| self.assets(section));
        self.bodies(&with("worldbody").collect::<Vec<_>>());
        let mut sums = BTreeMap::new();
        with("tendon").for_each(|section| self.tendons(section, &mut sums));
        with("equality").for_each(|section| self.equalities(section, &sums));
        with("actuator").for_each(|section| self.actuators(section, &sums));
        for elastic in with("deformable").flat_map(|section| self.files.children(section)) {
            let name = elastic.node.attribute("name").unwrap_or(elastic.tag());
            self.notes.remark(notes::ELASTIC, elastic.span(), format!("`{name}`"));
        }
        for section in sections.iter().filter(|section| HARMLESS.contains(&section.tag())) {
            self.notes.skip(format!("<{}>", section.tag()), section.span());
        }
    }

    /// Reports an error for an element that would generate bodies or forces.
    fn refuse(&mut self, element: Element<'a>) {
        let message = format!("<{}> is not supported", element.tag());
        self.report.error(element.span(), "unsupported-element", message);
        self.report.help(
            "give the file that `mujoco.mj_saveLastXML` writes: it has only plain bodies, joints and geoms",
        );
    }

    /// Attribute of an element, or of its default class; `None` if neither has it.
    fn find(&self, placed: &Placed<'a>, key: &str) -> Option<Given<'a>> {
        let own = placed.element.attribute(key);
        own.or_else(|| self.classes.attribute(placed.class, placed.element.tag(), key))
    }

    /// Index of the default class that an element names, or of the enclosing class.
    fn class(&mut self, element: Element<'a>, key: &str, around: usize) -> usize {
        let Some(given) = element.attribute(key) else { return around };
        match self.classes.find(given.text) {
            Some(class) => class,
            None => {
                let message = format!("unknown default class `{}`", given.text);
                self.report.error(given.span, "unknown-class", message);
                if let Some(help) = nearest(given.text, self.classes.names()) {
                    self.report.help(help);
                }
                around
            }
        }
    }

    fn name(&mut self, element: Element<'a>, key: &str) -> Option<Name> {
        let given = element.attribute(key).filter(|given| !given.text.is_empty())?;
        if given.text.chars().any(char::is_control) {
            let message = format!("`{key}` must be one line of text, not {:?}", given.text);
            self.report.error(given.span, "unusable-name", message);
            return None;
        }
        Some(At::new(given.text.to_owned(), given.span))
    }

    /// Name of an element in a body, with its suffix.
    fn placed_name(&mut self, placed: &Placed<'a>) -> Option<Name> {
        let name = self.name(placed.element, "name")?;
        Some(At::new(name.value + placed.suffix.as_str(), name.span))
    }

    fn one_of(&mut self, given: Given<'a>, key: &str, known: &[&'static str]) -> Option<&'static str> {
        let found = known.iter().find(|word| **word == given.text);
        if found.is_none() {
            self.report.error(
                given.span,
                "unknown-word",
                format!("`{key}` has the unknown value {:?}", given.text),
            );
            self.report.help(nearest(given.text, known.iter().copied()).unwrap_or_default());
        }
        found.copied()
    }

    fn number(&mut self, given: Option<Given<'a>>, key: &str) -> Option<At<f64>> {
        self.vector::<1>(given, key).map(|found| At::new(found.value[0], found.span))
    }

    fn vector<const N: usize>(&mut self, given: Option<Given<'a>>, key: &str) -> Option<At<[f64; N]>> {
        let numbers = self.numbers(given?, key)?;
        match <[f64; N]>::try_from(numbers.value) {
            Ok(value) => Some(At::new(value, numbers.span)),
            Err(found) => {
                let wanted = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
                let message = format!("`{key}` must be {wanted}, not {}", found.len());
                self.report.error(numbers.span, "not-a-number", message);
                None
            }
        }
    }

    /// Reads a list of numbers of any length.
    fn numbers(&mut self, given: Given<'a>, key: &str) -> Option<At<Vec<f64>>> {
        let words = given.text.split_whitespace().map(|word| word.parse::<f64>().map(|number| number + 0.0));
        let numbers: Result<Vec<f64>, _> = words.collect();
        let fault = match &numbers {
            Err(_) => {
                Some(("not-a-number", format!("`{key}` must be numbers, not {:?}", shortened(given.text))))
            }
            Ok(numbers) if numbers.iter().any(|number| !number.is_finite()) => {
                Some(("number-not-finite", format!("`{key}` must be finite, not {}", shortened(given.text))))
            }
            Ok(numbers) if numbers.iter().any(|number| number.abs() > LARGEST_NUMBER) => {
                Some(("number-too-large", too_large(&format!("`{key}`"))))
            }
            Ok(_) => None,
        };
        match (fault, numbers) {
            (None, Ok(numbers)) => Some(At::new(numbers, given.span)),
            (fault, _) => {
                let (code, message) = fault.unwrap_or_default();
                self.report.error(given.span, code, message);
                None
            }
        }
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(60).collect()
}

/// The number that a file gives, or the default.
fn or(given: Option<At<f64>>, default: f64) -> f64 {
    given.map_or(default, |given| given.value)
}

/// Place of a number if it is given, otherwise the place of its element.
fn span_of<T>(given: Option<&At<T>>, otherwise: Span) -> Span {
    given.map_or(otherwise, |given| given.span)
}
