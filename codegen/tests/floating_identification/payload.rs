//! Payload identification from logs without and with the load, for a flying base whose rows have no sensor.

use std::fs;
use std::process::Command;

use gelenk_identification::robot::Robot;
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

use super::logs::{HEADERS, log};
use super::quadrotor::{Body, flight, flight_of, truth};
use super::{models, robot};

/// A parcel of 0.4 kg below the quadrotor, with the inertia of a cube of 0.1 m.
const MASS: f64 = 0.4;
const CENTER: [f64; 3] = [0.03, -0.02, -0.08];

fn loaded() -> Body {
    let (empty, center) = (truth(), Vector3::from(CENTER));
    let own = Matrix3::identity() * (MASS * 0.01 / 6.0);
    let shift = Matrix3::identity() * center.norm_squared() - center * center.transpose();
    let mass = empty.mass + MASS;
    Body {
        mass,
        center: (empty.mass * empty.center + MASS * center) / mass,
        inertia: empty.inertia + own + MASS * shift,
    }
}

/// The description is wrong by its camera, in both logs alike.
#[test]
fn a_parcel_is_found_from_flights_without_and_with_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("empty.csv"), log(HEADERS[0], &flight(40.0, 1))).unwrap();
    fs::write(folder.path().join("loaded.csv"), log(HEADERS[0], &flight_of(&loaded(), 40.0, 2))).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_gelenk"));
    command.current_dir(folder.path()).arg("identify").arg(models("quadrotor.toml"));
    command.args(["empty.csv", "--payload", "loaded.csv", "--output", "found.toml", "--format", "json"]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    println!("{found:#}");
    let value = |of: &Value| of["value"].as_f64().unwrap();
    assert!((value(&found["mass"]) / MASS - 1.0).abs() < 0.02);
    for (found, real) in found["center_of_mass"].as_array().unwrap().iter().zip(CENTER) {
        assert!((value(found) - real).abs() < 5e-3, "{found} {real}");
    }
    let [described, written] =
        [models("quadrotor.toml"), folder.path().join("found.toml")].map(|path| robot(&path));
    let carried = written.parameters()[0] - described.parameters()[0];
    // The file has the digits that mean something: they change the mass by less than a tenth of half its interval.
    let end = |which: usize| found["mass"]["interval"][which].as_f64().unwrap();
    let rounding = 0.1 * 0.5 * (end(1) - end(0));
    assert!((carried - value(&found["mass"])).abs() < rounding, "{carried} {rounding}");
}
