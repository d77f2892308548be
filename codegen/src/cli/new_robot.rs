//! The robot of a new crate: the example, or one that a URDF describes.

use std::path::Path;

use super::failure::Failure;
use super::new_feet::{self, Foot};
use crate::model::{DescriptionFiles, Joint, Model, QuaternionKind, ReadOptions};
use crate::wording::toml_text;

const BUILD: &str = include_str!("template/build.rs");

/// With dry friction a plant's model is none for controllers.
const BUILD_BOTH: &str = include_str!("template/build_both.rs");

/// The description of a new crate, and the URDF that it names.
pub(super) struct Robot {
    /// Text of `robot.toml`.
    pub(super) description: String,
    /// Text of `build.rs`.
    pub(super) build: &'static str,
    /// Content of `robot.urdf`.
    pub(super) urdf: Option<Vec<u8>>,
    /// Its base moves freely.
    pub(super) floats: bool,
    /// What it stands on.
    pub(super) feet: Vec<Foot>,
}

/// Which feet a robot is to have.
#[derive(Clone, Copy)]
pub(super) enum Feet<'a> {
    /// None: the program knows none.
    None,
    /// These links, or those that the rule finds where there are none.
    Of(&'a [String]),
}

/// The robot of the URDF, or an example.
///
/// - `floats`: the base moves freely, whatever the URDF says
pub(super) fn robot(urdf: Option<&Path>, floats: bool, feet: Feet<'_>) -> Result<Robot, Failure> {
    let example = match floats {
        true => include_str!("template/robot_floating.toml"),
        false => include_str!("template/robot.toml"),
    };
    match urdf {
        None => Ok(Robot { description: example.to_owned(), build: BUILD, urdf: None, floats, feet: vec![] }),
        Some(path) => from_urdf(path, floats, feet),
    }
}

/// The URDF must be one that can be generated: half a crate helps nobody.
fn from_urdf(path: &Path, floats: bool, feet: Feet<'_>) -> Result<Robot, Failure> {
    let wrong = |why| Failure::Descriptions(vec![why]);
    let mut files = DescriptionFiles::of(path);
    let options = ReadOptions { floating_base: floats, ..ReadOptions::default() };
    let loaded = files.load(&options).map_err(wrong)?;
    require_base(path, &loaded.model)?;
    if files.is_mjcf().map_err(wrong)? {
        return Err(Failure::Usage(format!(
            "{} is an MJCF, whose joints need not have motors; the program of a new crate moves each joint\n  = help: \
             make the crate without --urdf, and write `extends = \"FILE.xml\"` and the joints' drives into its robot.toml",
            path.display()
        )));
    }
    if !files.is_xml().map_err(wrong)? {
        return Err(Failure::Usage(format!(
            "{} is no URDF\n  = help: make the crate without --urdf, and put your description in the place of its robot.toml",
            path.display()
        )));
    }
    let feet = feet.of(&loaded.model)?;
    Ok(Robot {
        build: match loaded.model.moving_joints().iter().any(|moving| moving.joint.jumps()) {
            true => BUILD_BOTH,
            false => BUILD,
        },
        description: description(path, &loaded.model, floats, &feet),
        urdf: Some(files.content().map_err(wrong)?.to_vec()),
        floats: !loaded.model.quaternion_joints.is_empty(),
        feet,
    })
}

impl Feet<'_> {
    fn of(self, model: &Model) -> Result<Vec<Foot>, Failure> {
        match self {
            Self::Of(named) if !model.quaternion_joints.is_empty() => new_feet::feet(model, named),
            Self::Of([_, ..]) => Err(Failure::Usage(
                "--feet is for a robot whose base moves freely\n  = help: add --base floating".to_owned(),
            )),
            Self::Of([]) | Self::None => Ok(vec![]),
        }
    }
}

/// The program of a robot that moves freely takes its first position and velocity entries for those of the base.
fn require_base(path: &Path, model: &Model) -> Result<(), Failure> {
    let Some(joint) = model.quaternion_joints.first() else {
        return Ok(());
    };
    let is_base = joint.kind == QuaternionKind::Floating && joint.first == 0;
    if is_base && model.quaternion_joints.len() == 1 {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "joint `{}` of {} is {}; the programs of new crates are for arms, and for robots whose base alone floats\n  = help: `gelenk \
         generate` writes the module of such a robot",
        joint.name,
        path.display(),
        joint.kind.name()
    )))
}

fn description(path: &Path, model: &Model, floats: bool, feet: &[Foot]) -> String {
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# The robot of robot.urdf, which is a copy of {}.\n\
         # Every key is described in models/README.md of gelenk. `gelenk report robot.toml` draws the robot and checks it.\n\
         name = \"robot\"\n\
         urdf = \"robot.urdf\"\n",
        file.replace(char::is_control, " ")
    );
    if floats {
        text.push_str("# The base moves freely.\nbase = { type = \"floating\" }\n");
    }
    if !model.followers.is_empty() {
        text.push_str(
            "# Joints with <mimic> move with the joints that they follow. With `ignore_mimic = true` each is a coordinate of its own.\n",
        );
    }
    text.push_str(
        "\n# A URDF says nothing of drives, and seldom of friction. Inputs are joint torques until there are drives. Put in your robot's\n\
         # numbers and remove the signs # in front of them.\n",
    );
    for (joint, _) in described_joints(model) {
        text.push_str(&entry(&joint.name));
    }
    if !feet.is_empty() {
        text.push_str(&new_feet::description(feet));
    } else if !model.quaternion_joints.is_empty() {
        text.push_str(&propellers(model));
    }
    text
}

/// The joints that the description may say more of, with their links; not those that the base floats by.
fn described_joints(model: &Model) -> impl Iterator<Item = (&Joint, usize)> {
    let moves = model.coordinates.iter().enumerate();
    let plain = moves.filter(|(coordinate, _)| model.position_of(*coordinate).is_some());
    plain.filter_map(|(_, &link)| Some((model.links.get(link)?.joint.as_ref()?, link)))
}

/// How the links at the ends become propellers, as comments.
fn propellers(model: &Model) -> String {
    let mut text = String::from(
        "\n# Where a joint carries a propeller it is held, and the propeller is an input at its link: of a unit of the input, force in N,\n\
         # then moment in N m, whose sign is against the propeller's turn.\n",
    );
    let carries = |link: usize| described_joints(model).any(|(joint, _)| joint.parent == link);
    for (joint, link) in described_joints(model).filter(|(_, link)| !carries(*link)) {
        text.push_str(&format!(
            "\n# [[joints]]\n# name = {0}\n# held = 0\n# [[inputs]]\n# name = {1}\n# frame = {1}\n# wrench = [0, 0, 1, 0, 0, 0.016]\n\
             # limits = [0, 8]\n",
            toml_text(&joint.name),
            toml_text(&model.links[link].name)
        ));
    }
    text
}

/// A joint's entry, as a comment.
fn entry(joint: &str) -> String {
    format!(
        "\n# [[joints]]\n\
         # name = {}\n\
         # friction = {{ viscous = 0.4, coulomb = 0.2 }}\n\
         # drive = {{ gear_ratio = 100, rotor_inertia = 2e-5, torque = {{ nominal = 0.4, peak = 0.8 }} }}\n",
        toml_text(joint)
    )
}
