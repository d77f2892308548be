//! The robot of a new project: an example, or the robot of a URDF or MJCF.

use std::path::{Component, Path};

use super::choices::{body_key, held_key};
use super::failure::Failure;
use super::new_feet::{self, Foot};
use super::new_propellers;
use crate::diagnostic::Diagnostics;
use crate::model::{Joint, Model, QuaternionKind};
use crate::read::{DescriptionFiles, ReadOptions};
use crate::wording::{quoted, toml_text};
use gelenk_formula::Hold;

const BUILD: &str = include_str!("template/build.rs");

/// Build script of a crate with two models: one with dry friction for the plant, and one with smooth friction
/// for controllers.
const BUILD_BOTH: &str = include_str!("template/build_both.rs");

/// Description of the robot of a new project, and the files that it uses.
pub(super) struct Robot {
    /// Text of `robot.toml`.
    pub(super) description: String,
    /// Text of the build script `build.rs`.
    pub(super) build: &'static str,
    /// Paths in the project and contents of the files that the description extends.
    pub(super) copies: Vec<(String, Vec<u8>)>,
    /// Whether the base is floating.
    pub(super) floats: bool,
    /// Names of the independent joints.
    pub(super) joints: Vec<String>,
    /// Names of the joints without a motor.
    pub(super) passive: Vec<String>,
    /// Feet of the robot; empty if there are none.
    pub(super) feet: Vec<Foot>,
    /// Notes about the description, for example about legs with a fixed base.
    pub(super) notes: Diagnostics,
}

impl Robot {
    /// Returns an error if the effort of each coordinate cannot be commanded.
    ///
    /// - `who`: beginning of the message
    pub(super) fn require_efforts(&self, who: &str) -> Result<(), Failure> {
        let (fault, remedy) = match (self.floats, self.joints.is_empty(), self.passive.first()) {
            (true, ..) => (
                "its base floats, or it has a spherical joint".to_owned(),
                "use a robot with a fixed base and one coordinate per joint",
            ),
            (_, true, _) => ("use a robot with joints".to_owned(), "take a robot with joints"),
            (.., Some(joint)) => {
                (format!("no motor moves {}", quoted(joint)), "add a motor, or `--hold` the joint")
            }
            _ => return Ok(()),
        };
        Err(Failure::Usage(format!("{who} an effort for each joint, but {fault}\n  = help: {remedy}")))
    }
}

/// Choice of feet.
#[derive(Clone, Copy)]
pub(super) enum Feet<'a> {
    /// No feet.
    None,
    /// The links with these names, or the feet that the rule finds if the list is empty.
    Of(&'a [String]),
}

/// Held joints, and the body whose subtree is the robot.
type Parts<'a> = (&'a [Hold], Option<&'a str>);

/// The robot of the URDF or MJCF, or an example if there is no file.
///
/// - `floats`: whether the base becomes floating
pub(super) fn robot(
    xml: Option<&Path>,
    floats: bool,
    parts: Parts<'_>,
    feet: Feet<'_>,
) -> Result<Robot, Failure> {
    let example = match floats {
        true => include_str!("template/robot_floating.toml"),
        false => include_str!("template/robot.toml"),
    };
    match xml {
        None => {
            let (copies, feet, notes) = (vec![], vec![], Diagnostics::default());
            // The example arm has these joints; the quadrotor has no joints.
            let joints = if floats { vec![] } else { ["shoulder", "elbow"].map(str::to_owned).to_vec() };
            let (description, passive) = (example.to_owned(), vec![]);
            Ok(Robot { description, build: BUILD, copies, floats, joints, passive, feet, notes })
        }
        Some(path) => from_xml(path, floats, parts, feet),
    }
}

/// The robot of a URDF or MJCF. Returns an error if no module can be generated from the file.
fn from_xml(path: &Path, floats: bool, parts: Parts<'_>, feet: Feet<'_>) -> Result<Robot, Failure> {
    let wrong = |why| Failure::Descriptions(vec![why]);
    let mut files = DescriptionFiles::of(path);
    let options = ReadOptions {
        floating_base: floats,
        hold: parts.0.to_vec(),
        body: parts.1.map(str::to_owned),
        ..ReadOptions::default()
    };
    let loaded = files.load(&options).map_err(wrong)?;
    require_base(path, &loaded.model)?;
    let kind = match (files.is_xml().map_err(wrong)?, files.is_mjcf().map_err(wrong)?) {
        (_, true) => Kind::Mjcf,
        (true, false) => Kind::Urdf,
        (false, false) => {
            return Err(Failure::Usage(format!(
                "{} is neither URDF nor MJCF\n  = help: make the crate without --urdf, and replace its \
                 robot.toml by your description",
                path.display()
            )));
        }
    };
    kind.require_motors(path, &loaded.model)?;
    let feet = feet.of(&loaded.model)?;
    let copies = kind.copies(path, &files)?;
    let notes = loaded.notes.entries().iter().filter(|note| note.code == "legs-on-fixed-base");
    Ok(Robot {
        build: match loaded.model.has_dry_friction() {
            true => BUILD_BOTH,
            false => BUILD,
        },
        description: description((path, kind), &loaded.model, (floats, parts), &feet),
        copies,
        floats: !loaded.model.quaternion_joints.is_empty(),
        joints: described_joints(&loaded.model).map(|(joint, _)| joint.name.clone()).collect(),
        passive: without_motor(&loaded.model).map(str::to_owned).collect(),
        feet,
        notes: Diagnostics::new(notes.cloned().collect()),
    })
}

/// Format of the robot's file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Urdf,
    Mjcf,
}

impl Kind {
    /// Name of the copy in the project.
    const fn file(self) -> &'static str {
        match self {
            Self::Urdf => "robot.urdf",
            Self::Mjcf => "robot.xml",
        }
    }

    /// Comment of the description about drives and friction.
    const fn of_drives(self) -> &'static str {
        match self {
            Self::Urdf => {
                "\n# A URDF says nothing of drives, and seldom of friction. Inputs are joint torques until there are drives. Put in your robot's\n\
                 # numbers and remove the signs # in front of them.\n"
            }
            Self::Mjcf => {
                "\n# Inputs are those of the file's motors, whose gears and armatures are taken over. Friction that stands here takes the place\n\
                 # of the file's damping and friction loss: put in your robot's numbers and remove the signs # in front of them.\n"
            }
        }
    }

    /// Returns an error if the program of a new crate cannot move the robot. Each joint of a URDF has an
    /// input. In an MJCF a joint has an input only if it has an actuator.
    fn require_motors(self, path: &Path, model: &Model) -> Result<(), Failure> {
        let without: Vec<&str> = without_motor(model).collect();
        let floats = !model.quaternion_joints.is_empty();
        let enough =
            if floats { without.is_empty() } else { without.len() < described_joints(model).count() };
        if self == Self::Urdf || enough || without.is_empty() {
            return Ok(());
        }
        Err(Failure::Usage(format!(
            "{} has no motor at {}; the program of a new crate moves {}\n  = help: add `<motor joint=\"{}\"/>` to its <actuator>",
            path.display(),
            without.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
            if floats { "each joint of a robot with a floating base" } else { "at least one joint" },
            without[0],
        )))
    }

    /// The file and the files that it includes, with their paths relative to the file.
    fn copies(self, path: &Path, files: &DescriptionFiles) -> Result<Vec<(String, Vec<u8>)>, Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let copy = |(file, bytes): (&Path, &[u8])| {
            if file == path {
                return Ok((self.file().to_owned(), bytes.to_vec()));
            }
            let place = file
                .strip_prefix(folder)
                .ok()
                .filter(|place| is_inside(place) && *place != Path::new(self.file()));
            match place.and_then(Path::to_str) {
                Some(place) => Ok((place.to_owned(), bytes.to_vec())),
                None => Err(Failure::Usage(format!(
                    "{} includes {}, which cannot have the same relative path in the new crate\n  = help: \
                     include only files of its own folder, by relative paths, and give none of them the \
                     name {}",
                    path.display(),
                    file.display(),
                    self.file()
                ))),
            }
        };
        files.contents().map(copy).collect()
    }
}

fn is_inside(place: &Path) -> bool {
    place.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

impl Feet<'_> {
    fn of(self, model: &Model) -> Result<Vec<Foot>, Failure> {
        match self {
            Self::Of(named) if !model.quaternion_joints.is_empty() => new_feet::feet(model, named),
            Self::Of([_, ..]) => Err(Failure::Usage(
                "--feet requires a floating base\n  = help: add --base floating".to_owned(),
            )),
            Self::Of([]) | Self::None => Ok(vec![]),
        }
    }
}

/// Returns an error unless the only joint with a quaternion is a floating base with the first positions and
/// velocities, as the program of a new crate requires.
fn require_base(path: &Path, model: &Model) -> Result<(), Failure> {
    let Some(joint) = model.quaternion_joints.first() else {
        return Ok(());
    };
    let is_base = joint.kind == QuaternionKind::Floating && joint.first == 0;
    if is_base && model.quaternion_joints.len() == 1 {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "joint `{}` of {} is {}; the program of a new crate supports a floating base and joints with one \
         position and one velocity\n  = help: first make it a fixed joint, or call `gelenk generate` and \
         write the program yourself: the example `satellite` of gelenk-runtime moves a robot with a \
         spherical joint",
        joint.name,
        path.display(),
        joint.kind.name()
    )))
}

fn description(
    (path, kind): (&Path, Kind),
    model: &Model,
    (floats, (hold, body)): (bool, Parts<'_>),
    feet: &[Foot],
) -> String {
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# The robot of {0}, which is a copy of {1}.\n\
         # Every key is described in models/README.md of gelenk. `gelenk report robot.toml` draws the robot and checks it.\n\
         name = \"robot\"\n\
         {2} = \"{0}\"\n",
        kind.file(),
        file.replace(char::is_control, " "),
        match kind {
            Kind::Urdf => "urdf",
            Kind::Mjcf => "extends",
        }
    );
    if floats {
        text.push_str("# The base moves freely.\nbase = { type = \"floating\" }\n");
    }
    text.extend(held_key(hold).into_iter().chain(body_key(body)).map(|key| key + "\n"));
    if !model.followers.is_empty() {
        text.push_str(
            "# Joints with <mimic> move with the joints that they follow. With `ignore_mimic = true` each is a coordinate of its own.\n",
        );
    }
    if described_joints(model).next().is_none() {
        text.push_str(&new_propellers::of_fixed_links(model));
        return text;
    }
    text.push_str(kind.of_drives());
    for (joint, _) in described_joints(model) {
        text.push_str(&entry(&joint.name, kind));
    }
    if !feet.is_empty() {
        text.push_str(&new_feet::description(feet));
    } else if !model.quaternion_joints.is_empty() {
        text.push_str(&new_propellers::description(model, &Vec::from_iter(described_joints(model))));
    }
    text
}

/// The independent joints with one coordinate, with their links.
fn described_joints(model: &Model) -> impl Iterator<Item = (&Joint, usize)> {
    let moves = model.coordinates.iter().enumerate();
    let plain = moves.filter(|(coordinate, _)| model.position_of(*coordinate).is_some());
    plain.filter_map(|(_, &link)| Some((model.links.get(link)?.joint.as_ref()?, link)))
}

/// Names of the joints that no drive moves.
fn without_motor(model: &Model) -> impl Iterator<Item = &str> {
    let driven = |coordinate: usize| {
        model.drives.iter().any(|drive| drive.acts_on.iter().any(|of| of.coordinate == coordinate))
    };
    let still =
        move |link: &usize| model.coordinates.iter().position(|of| of == link).is_some_and(|c| !driven(c));
    described_joints(model).filter(move |(_, link)| still(link)).map(|(joint, _)| joint.name.as_str())
}

/// Entry of a joint in `robot.toml`, as comment lines.
fn entry(joint: &str, kind: Kind) -> String {
    let drive = match kind {
        Kind::Urdf => {
            "# drive = { gear_ratio = 100, rotor_inertia = 2e-5, torque = { nominal = 0.4, peak = 0.8 } }\n"
        }
        Kind::Mjcf => "",
    };
    format!(
        "\n# [[joints]]\n# name = {}\n# friction = {{ viscous = 0.4, coulomb = 0.2 }}\n{drive}",
        toml_text(joint)
    )
}
