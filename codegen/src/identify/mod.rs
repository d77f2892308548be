//! Identification of described robots: their regressors by the interpreter, and estimates as descriptions.
//!
//! The estimation is [`gelenk_identification`]'s; here stand the robot that it asks for, and what is written of
//! its results.

mod bodies;
mod drives;
pub mod page;
mod robot;
mod shafts;

pub use bodies::{BodyValues, bodies};
pub use drives::{IdentifiedDrive, drives, rotors};
pub use robot::{InterpretedRobot, RobotChoices};
pub use shafts::{IdentifiedShaft, drive_table, joint_tables, shaft_rotor};

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use gelenk_identification::description::{Identified, identified_toml};
    use gelenk_identification::robot::Robot;

    use super::*;
    use crate::dynamics::parameters::regressor::PER_LINK;
    use crate::model::{self, ReadOptions};

    fn robot(path: &Path) -> InterpretedRobot {
        let loaded = model::read(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
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
        // A cart whose drive has no rotor, and a pole without a drive.
        assert_eq!(takes("cart_pole"), [true, false]);
        // Rotors are parameters.
        assert_eq!(takes("geared_arm"), [false; 2]);
    }

    /// The file replaces the knuckle's friction alone.
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
        // Two fingers turn as fast as the knuckle, with 0.002 N m s each. What depends on the square of the speed is even.
        let friction = (forces(0.7) - forces(-0.7)) / 2.0;
        assert!((friction - 2.0 * 0.002 * 0.7).abs() < 1e-15, "{friction}");
    }

    /// Parameters of heavier bodies, and of rotors.
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
            let identified: Vec<IdentifiedDrive> = rotors(model)
                .iter()
                .map(|place| IdentifiedDrive {
                    rotor: place.map(|place| others[place]),
                    ..Default::default()
                })
                .collect();
            let written: Vec<String> = bodies(model, links).unwrap().iter().map(BodyValues::toml).collect();
            let text = identified_toml(&Identified {
                name: "identified",
                extends: &path.canonicalize().unwrap().display().to_string(),
                drives: &drives(model, &identified),
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
