//! The robot of a new crate: the example, or one that a URDF describes.

use std::path::Path;

use super::Failure;
use crate::model::{DescriptionFiles, Model, ReadOptions};
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
}

/// The robot of the URDF, or the example.
pub(super) fn robot(urdf: Option<&Path>) -> Result<Robot, Failure> {
    match urdf {
        None => Ok(Robot {
            description: include_str!("template/robot.toml").to_owned(),
            build: BUILD,
            urdf: None,
        }),
        Some(path) => from_urdf(path),
    }
}

/// The URDF must be one that can be generated: half a crate helps nobody.
fn from_urdf(path: &Path) -> Result<Robot, Failure> {
    let wrong = |why| Failure::Descriptions(vec![why]);
    let mut files = DescriptionFiles::of(path);
    let loaded = files.load(&ReadOptions::default()).map_err(wrong)?;
    if let Some(joint) = loaded.model.quaternion_joints.first() {
        return Err(Failure::Usage(format!(
            "joint `{}` of {} is {}; the program of a new crate is one for arms\n  = help: `gelenk generate` writes the module of such a robot",
            joint.name,
            path.display(),
            joint.kind.name()
        )));
    }
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
    Ok(Robot {
        build: match loaded.model.moving_joints().iter().any(|moving| moving.joint.jumps()) {
            true => BUILD_BOTH,
            false => BUILD,
        },
        description: description(path, &loaded.model),
        urdf: Some(files.content().map_err(wrong)?.to_vec()),
    })
}

fn description(path: &Path, model: &Model) -> String {
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# The robot of robot.urdf, which is a copy of {}.\n\
         # Every key is described in models/README.md of gelenk. `gelenk report robot.toml` draws the robot and checks it.\n\
         name = \"robot\"\n\
         urdf = \"robot.urdf\"\n",
        file.replace(char::is_control, " ")
    );
    if !model.followers.is_empty() {
        text.push_str(
            "# Joints with <mimic> move with the joints that they follow. With `ignore_mimic = true` each is a coordinate of its own.\n",
        );
    }
    text.push_str(
        "\n# A URDF says nothing of drives, and seldom of friction. Inputs are joint torques until there are drives. Put in your robot's\n\
         # numbers and remove the signs # in front of them.\n",
    );
    for joint in model.joints() {
        text.push_str(&entry(&joint.name));
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
