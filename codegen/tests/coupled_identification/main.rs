//! Robots whose wrist is a differential gear, identified in their motors' torques: B is full there, and friction stands on
//! joints or on the motors' shafts.
#![cfg(feature = "cli")]
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

mod described;
mod least_squares;
mod shafts;

use described::{Wrist, differences};

/// True parameters of the arm of `models/`, with friction on its joints.
const TRUTH: &str = r#"
name = "truth"
extends = "arm.toml"

[[joints]]
name = "elbow"
friction = { viscous = 5, coulomb = { value = 3, slope = 50 } }

[[joints]]
name = "wrist_pitch"
friction = { viscous = 0.5, coulomb = { value = 0.4, slope = 50 } }

[[joints]]
name = "wrist_roll"
friction = { viscous = 0.35 }

[[bodies]]
name = "wrist_roll"
mass = 1.4
center_of_mass = [0.02, 0.01, 0.1]
inertia = [0.004, 0.003, 0.002]

[[bodies]]
name = "elbow"
mass = 3
center_of_mass = [0, 0.02, 0.16]
"#;

#[test]
fn a_coupled_wrist_is_identified_in_its_motors_torques() {
    let wrist = Wrist::new(TRUTH);
    let text = wrist.identify("found.toml", &["--friction-on", "joints"]);
    println!("{text}");
    let [arm, truth, found] = ["arm.toml", "truth.toml", "found.toml"].map(|name| wrist.robot(name));
    let [before, after] = [&arm, &found].map(|robot| differences(robot, &truth));
    println!("forces are off by {before:?}, identified by {after:?}");
    for (joint, (before, after)) in before.iter().zip(&after).enumerate() {
        assert!(*after < 0.03 * before, "joint {joint}: {after} of {before}");
    }
    for (joint, speeds) in [("wrist_pitch", [-1.5, 0.8]), ("wrist_roll", [-1.5, 0.8])] {
        for v in speeds {
            let [described, true_, found] =
                [&arm, &truth, &found].map(|robot| robot.joint_friction(joint, v));
            println!("{joint} at {v}: described {described}, true {true_}, found {found}");
            assert!((found - true_).abs() < 0.05 * true_.abs(), "{joint} at {v}: {found} for {true_}");
        }
    }
}
