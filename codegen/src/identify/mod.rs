//! Identification of robots with a description.
//!
//! The crate [`gelenk_identification`] computes the estimates. This module provides the equations of motion
//! that this crate needs ([`InterpretedRobot`], without compiled code). It writes the estimates as a
//! description and as a report page.

mod bodies;
mod drives;
mod online;
pub mod page;
mod parameters;
mod robot;
mod rounding;
mod seats;
mod shafts;
mod terms;
mod words;

pub use bodies::{BodyValues, LinkBodies, bodies};
pub use drives::{IdentifiedDrive, WrittenDrives, write_drives};
pub use online::{DescribedForces, OnlineJoint, Replay, online_page, replay};
pub use robot::{InterpretedRobot, RobotChoices};
pub use rounding::{round_bodies, rounded_load};
pub use shafts::{joint_tables, shaft_rotor};
pub use terms::{front, front_as_json, terms_as_json};

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use gelenk_identification::result::description::{Identified, identified_toml};
    use gelenk_identification::robot::Robot;

    use super::*;
    use crate::dynamics::parameters::regressor::PER_LINK;
    use crate::model::{self, Drive};
    use crate::read::{self, ReadOptions};

    fn robot(path: &Path) -> InterpretedRobot {
        let loaded = read::read(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        InterpretedRobot::new(&loaded.model).unwrap_or_else(|e| panic!("{e}"))
    }

    fn models() -> Vec<PathBuf> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let names = ["powercube", "powercube_alpha", "cart_pole", "two_arm", "panda", "ur5"];
        names.map(|name| folder.join(format!("{name}.toml"))).to_vec()
    }

    #[test]
    fn inertia_of_a_drive_is_found_where_it_can_be_written() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let takes = |name: &str| robot(&folder.join(format!("{name}.toml"))).takes_inertia();
        // The drive of the cart has no rotor, and the pole has no drive.
        assert_eq!(takes("cart_pole"), [true, false]);
        // Rotors are parameters of this robot.
        assert_eq!(takes("geared_arm"), [false; 2]);
    }

    /// An arm whose friction is at its drives.
    const RUBBING_SHAFTS: &str = r#"
        name = "arm"
        gravity = [0, 0, -9.81]

        [[joints]]
        name = "shoulder"
        axis = [0, 1, 0]
        drive = { gear_ratio = 50, rotor_inertia = 1e-4, friction = { viscous = 2e-4 } }
        friction = { viscous = 3 }

        [[joints]]
        name = "elbow"
        axis = [0, 1, 0]
        origin = { xyz = [0, 0, 0.4] }

        [[bodies]]
        link = "shoulder"
        mass = 4
        inertia = 0.1

        [[bodies]]
        link = "elbow"
        mass = 2
        inertia = 0.1

        [[drives]]
        name = "motor"
        on = { elbow = 2 }
        gear_ratio = 30
        rotor_inertia = 3e-5
        friction = { viscous = 1e-4, coulomb = { value = 2e-3, slope = 20 } }
    "#;

    /// A drive of the written file completely replaces the drive of the description.
    #[test]
    fn friction_of_drives_stays_where_no_law_of_their_joints_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arm.toml");
        std::fs::write(&path, RUBBING_SHAFTS).unwrap();
        let described = read::read(&path, &ReadOptions::default()).unwrap().model;
        assert_eq!(InterpretedRobot::new(&described).unwrap().takes_inertia(), [false; 2]);
        let rotor = |drive: &Drive| if drive.name == "motor" { 5e-5 } else { 2e-4 };
        let identified =
            |drive: &Drive| (IdentifiedDrive { rotor: Some(rotor(drive)), ..Default::default() }, false);
        let drives = write_drives(&described, &described, identified).unwrap();
        let text = identified_toml(&Identified {
            name: "identified",
            extends: "arm.toml",
            drives: &drives.of_joints,
            bodies: &drives.tables,
            ..Default::default()
        });
        let path = folder.path().join("identified.toml");
        std::fs::write(&path, text.unwrap()).unwrap();
        let read = read::read(&path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).model;
        let rotors = read.drives.iter().map(|drive| drive.rotor_inertia.evaluate(&[], 0.0, 0.0));
        assert_eq!(rotors.collect::<Vec<_>>(), [2e-4, 5e-5]);
        let friction = |model: &model::Model, v: f64| -> Vec<f64> {
            let sum = |terms: &[model::FrictionTerm]| -> f64 {
                let terms = terms.iter();
                terms.map(|t| t.coefficient.evaluate(&[], 0.0, 0.0) * t.basis.evaluate(&[], 0.0, v)).sum()
            };
            model.joints().map(|joint| sum(&joint.friction)).collect()
        };
        for v in [-1.5, -0.01, 0.3] {
            assert_eq!(friction(&read, v), friction(&described, v));
        }
        // The friction is 3 + 50² · 2e-4 at the shoulder, and (60² · 1e-4) v + 60 · 2e-3 at the elbow.
        let [shoulder, elbow] = [0, 1].map(|joint: usize| friction(&read, 3.0)[joint]);
        assert!((shoulder - 3.5 * 3.0).abs() < 1e-12 && (elbow - (0.36 * 3.0 + 0.12)).abs() < 1e-12);
    }

    /// The written file replaces only the friction of the knuckle.
    #[test]
    fn friction_of_followers_is_known() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
        let gripper = robot(&folder.join("gripper.toml"));
        let [y, a] = [[0.3, 0.4], [0.0; 2]];
        let forces = |knuckle: f64| {
            let mut forces = [0.0; 2];
            gripper.rigid_forces(&y, &[0.0, knuckle], &a, &mut forces);
            forces[1]
        };
        // Two fingers turn as fast as the knuckle, with 0.002 N m s each. Terms in the square of the speed
        // are even functions of it.
        let friction = (forces(0.7) - forces(-0.7)) / 2.0;
        assert!((friction - 2.0 * 0.002 * 0.7).abs() < 1e-15, "{friction}");
    }

    /// Returns the parameters of heavier bodies and rotors.
    fn changed(robot: &InterpretedRobot) -> Vec<f64> {
        let parameters = robot.parameters();
        let heavier =
            parameters.iter().enumerate().map(|(i, value)| value * (1.1 + 0.05 * (i / PER_LINK) as f64));
        heavier.collect()
    }

    #[test]
    fn written_bodies_and_drives_are_read_back_with_their_values() {
        let folder = tempfile::tempdir().unwrap();
        for path in models() {
            let described = robot(&path);
            let (model, expected) = (described.model(), changed(&described));
            let (links, others) = expected.split_at(PER_LINK * described.bodies());
            let identified = |drive: &Drive| {
                let rotor = shaft_rotor(model, &drive.name).map(|place| others[place]);
                (IdentifiedDrive { rotor, ..Default::default() }, true)
            };
            let drives = write_drives(model, model, identified).unwrap();
            let written: Vec<String> =
                bodies(model, links).unwrap().iter().flat_map(LinkBodies::toml).collect();
            let text = identified_toml(&Identified {
                name: "identified",
                extends: &path.canonicalize().unwrap().display().to_string(),
                drives: &drives.of_joints,
                bodies: &written,
                ..Default::default()
            });
            let file = folder.path().join("identified.toml");
            std::fs::write(&file, text.unwrap()).unwrap();
            let found = robot(&file);
            assert_eq!(found.joint_names(), described.joint_names());
            assert_eq!(found.input_matrix(), described.input_matrix());
            for ((name, found), expected) in
                found.parameter_names().iter().zip(found.parameters()).zip(&expected)
            {
                let error = (found - expected).abs();
                assert!(
                    error < 1e-7 * (1e-3 + expected.abs()),
                    "{}: {name} {found} {expected}",
                    path.display()
                );
            }
        }
    }
}
