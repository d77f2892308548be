//! Robot of a new project: an example, or the robot of a URDF or MJCF.

use std::path::{Component, Path};

use super::super::choices::Reading;
use super::super::failure::Failure;
use super::project::filled;
use crate::diagnostic::Diagnostics;
use crate::model::{Joint, Model, QuaternionKind};
use crate::read::DescriptionFiles;
use crate::wording::{quoted, toml_text};

/// Description of a new project, and the files it uses.
pub(super) struct Robot {
    /// Text of the project's description `robot.toml`.
    pub(super) description: String,
    /// Whether the friction of the robot is discontinuous at rest.
    pub(super) has_dry_friction: bool,
    /// Files that the description extends: paths in the project, and contents.
    pub(super) copies: Vec<(String, Vec<u8>)>,
    /// Whether the base of the robot is floating.
    pub(super) floats: bool,
    /// Names of the joints that do not follow others.
    pub(super) joints: Vec<String>,
    /// Names of the joints without a motor.
    passive: Vec<String>,
    /// Notes of the description, for example about legs with a fixed base.
    pub(super) notes: Diagnostics,
}

impl Robot {
    /// Fails if an effort cannot be commanded for each coordinate.
    ///
    /// - `who`: subject and verb of the message
    pub(super) fn require_efforts(&self, who: &str) -> Result<(), Failure> {
        let (fault, remedy) = match (self.floats, self.joints.is_empty(), self.passive.first()) {
            (true, ..) => (
                "the robot has a floating base or a spherical joint".to_owned(),
                "use a robot with a fixed base and one coordinate per joint",
            ),
            (_, true, _) => ("the robot has no joints".to_owned(), "use a robot with joints"),
            (.., Some(joint)) => {
                (format!("no motor moves {}", quoted(joint)), "add a motor, or `--hold` the joint")
            }
            _ => return Ok(()),
        };
        Err(Failure::Usage(format!("{who} an effort for each joint, but {fault}\n  = help: {remedy}")))
    }
}

/// Robot of the URDF or MJCF, or an example: an arm or a quadrotor.
pub(super) fn robot(xml: Option<&Path>, reading: &Reading) -> Result<Robot, Failure> {
    if let Some(path) = xml {
        return from_xml(path, reading);
    }
    let floats = reading.floats();
    let (description, joints) = match floats {
        true => (include_str!("../template/robot/quadrotor.toml"), vec![]),
        false => {
            (include_str!("../template/robot/arm.toml"), vec!["shoulder".to_owned(), "elbow".to_owned()])
        }
    };
    Ok(Robot {
        description: description.to_owned(),
        has_dry_friction: false,
        copies: vec![],
        floats,
        joints,
        passive: vec![],
        notes: Diagnostics::default(),
    })
}

/// Reads the robot of a URDF or MJCF. Returns an error if no module can be generated from the file, so that no
/// incomplete project is created.
fn from_xml(path: &Path, reading: &Reading) -> Result<Robot, Failure> {
    let wrong = |why| Failure::Descriptions(vec![why]);
    let mut files = DescriptionFiles::of(path);
    let loaded = files.load(&reading.options()).map_err(wrong)?;
    let model = &loaded.model;
    require_base(path, model)?;
    let kind = match (files.is_xml().map_err(wrong)?, files.is_mjcf().map_err(wrong)?) {
        (_, true) => &MJCF,
        (true, false) => &URDF,
        (false, false) => {
            return Err(Failure::Usage(format!(
                "{} is neither URDF nor MJCF\n  = help: make the crate without --urdf, and replace its \
                 robot.toml by your description",
                path.display()
            )));
        }
    };
    let passive: Vec<String> = without_motor(model).map(str::to_owned).collect();
    if kind.has_motors {
        require_motors(path, model, &passive)?;
    }
    let notes = loaded.notes.entries().iter().filter(|note| note.code == "legs-on-fixed-base");
    Ok(Robot {
        description: kind.description(path, model, reading),
        has_dry_friction: model.has_dry_friction(),
        copies: kind.copies(path, &files)?,
        floats: !model.quaternion_joints.is_empty(),
        joints: described_joints(model).map(|(joint, _)| joint.name.clone()).collect(),
        passive,
        notes: Diagnostics::new(notes.cloned().collect()),
    })
}

/// Format of the robot's file, URDF or MJCF, with texts for the new description.
struct Kind {
    /// Name of the file's copy in the project.
    file: &'static str,
    /// Key of the description that names the copy.
    key: &'static str,
    /// Whether the file has motors. Otherwise every joint is an input.
    has_motors: bool,
    /// Comment about drives and friction in the new description, which the file may lack.
    drives: &'static str,
    /// Comment about one joint in the new description.
    joint: &'static str,
}

const URDF: Kind = Kind {
    file: "robot.urdf",
    key: "urdf",
    has_motors: false,
    drives: include_str!("../template/robot/drives_urdf.toml"),
    joint: include_str!("../template/robot/joint_urdf.toml"),
};

const MJCF: Kind = Kind {
    file: "robot.xml",
    key: "extends",
    has_motors: true,
    drives: include_str!("../template/robot/drives_mjcf.toml"),
    joint: include_str!("../template/robot/joint_mjcf.toml"),
};

impl Kind {
    fn description(&self, path: &Path, model: &Model, reading: &Reading) -> String {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        let head = [
            ("FILE", self.file.to_owned()),
            ("SOURCE", file.replace(char::is_control, " ")),
            ("KEY", self.key.to_owned()),
        ];
        let mut text = filled(include_str!("../template/robot/head.toml"), &head);
        if reading.floats() {
            text.push_str("# Legs and propellers: codegen/docs/floating.md of gelenk.\n");
        }
        text.extend(reading.keys().into_iter().map(|key| key + "\n"));
        if !model.followers.is_empty() {
            text.push_str(include_str!("../template/robot/mimic.toml"));
        }
        let joint = |(joint, _): (&Joint, usize)| filled(self.joint, &[("JOINT", toml_text(&joint.name))]);
        let joints: String = described_joints(model).map(joint).collect();
        let drives = if joints.is_empty() { "" } else { self.drives };
        text + drives + joints.as_str()
    }

    /// Returns copies of the file and of its included files, with their paths relative to the file.
    fn copies(&self, path: &Path, files: &DescriptionFiles) -> Result<Vec<(String, Vec<u8>)>, Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let copy = |(file, bytes): (&Path, &[u8])| {
            if file == path {
                return Ok((self.file.to_owned(), bytes.to_vec()));
            }
            let place = file
                .strip_prefix(folder)
                .ok()
                .filter(|place| is_inside(place) && *place != Path::new(self.file));
            match place.and_then(Path::to_str) {
                Some(place) => Ok((place.to_owned(), bytes.to_vec())),
                None => Err(Failure::Usage(format!(
                    "{} includes {}, whose relative path does not fit into the new project\n  = help: \
                     move included files below the folder of the file that includes them. None may have the name {}",
                    path.display(),
                    file.display(),
                    self.file
                ))),
            }
        };
        files.contents().map(copy).collect()
    }
}

fn is_inside(place: &Path) -> bool {
    place.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// Returns an error if no motor moves the robot, or if a robot with a floating base has passive joints. The
/// program of a new crate does not control these robots.
fn require_motors(path: &Path, model: &Model, passive: &[String]) -> Result<(), Failure> {
    let floats = !model.quaternion_joints.is_empty();
    let enough = !floats && passive.len() < described_joints(model).count();
    if enough || passive.is_empty() {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{} has no motor at {}, but the program of a new project needs a motor for {}\n  = help: \
         add `<motor joint=\"{}\"/>` to its <actuator>",
        path.display(),
        passive.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
        if floats { "each joint of a robot with a floating base" } else { "at least one joint" },
        passive[0],
    )))
}

/// Returns an error if the robot has a joint with a quaternion that is not its floating base. The program of a
/// new crate treats the first position and velocity entries of such a robot as those of the base.
fn require_base(path: &Path, model: &Model) -> Result<(), Failure> {
    let Some(joint) = model.quaternion_joints.first() else {
        return Ok(());
    };
    let is_base = joint.kind == QuaternionKind::Floating && joint.first == 0;
    if is_base && model.quaternion_joints.len() == 1 {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "joint `{}` of {} is {}, but the program of a new project supports only a floating base and joints with one \
         position and one velocity\n  = help: first make it a fixed joint, or call `gelenk generate` and \
         write the program yourself. The example `satellite` of gelenk-runtime moves a robot with a \
         spherical joint",
        joint.name,
        path.display(),
        joint.kind.name()
    )))
}

/// Joints with one position entry and their links. The description can add drives and friction to these joints.
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
