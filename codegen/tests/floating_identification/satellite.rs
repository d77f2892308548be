//! A satellite with reaction wheels and a boom on a ball joint: quaternions of two joints, and no force on the hull.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_identification::estimation::Estimate;
use gelenk_identification::identify::{IdentificationSettings, identify};
use gelenk_identification::robot::Robot;
use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

use super::{Noise, models, robot};

const N: usize = 12;

/// The hull has another inertia than described.
fn truth() -> String {
    format!(
        "name = \"truth\"\nextends = {:?}\n[[bodies]]\nname = \"hull\"\nmass = 40\ncenter_of_mass = [0.01, 0, 0.05]\n\
         inertia = [2.8, 2.0, 2.2]\n",
        models("satellite.toml").display().to_string()
    )
}

/// Hull, wheels and boom; y is (place, quaternion, wheels, quaternion).
struct State {
    place: Vector3<f64>,
    hull: UnitQuaternion<f64>,
    wheels: [f64; 3],
    boom: UnitQuaternion<f64>,
    v: DVector<f64>,
}

impl State {
    fn positions(&self) -> Vec<f64> {
        let place = self.place.iter().chain(self.hull.coords.iter()).copied();
        place.chain(self.wheels).chain(self.boom.coords.iter().copied()).collect()
    }

    fn moved(&self, v: &DVector<f64>, h: f64) -> Self {
        let turn = |first: usize| h * Vector3::new(v[first], v[first + 1], v[first + 2]);
        let half = self.hull * UnitQuaternion::from_scaled_axis(0.5 * turn(3));
        Self {
            place: self.place + half * turn(0),
            hull: self.hull * UnitQuaternion::from_scaled_axis(turn(3)),
            wheels: std::array::from_fn(|i| self.wheels[i] + h * v[6 + i]),
            boom: self.boom * UnitQuaternion::from_scaled_axis(turn(9)),
            v: self.v.clone(),
        }
    }
}

fn acceleration(robot: &InterpretedRobot, y: &[f64], v: &DVector<f64>, torques: &[f64; 3]) -> DVector<f64> {
    let forces = |v: &[f64], a: &[f64]| {
        let mut forces = vec![0.0; N];
        robot.rigid_forces(y, v, a, &mut forces);
        DVector::from_vec(forces)
    };
    let (zero, bias) = ([0.0; N], forces(v.as_slice(), &[0.0; N]));
    let rest = forces(&zero, &zero);
    let column = |i: usize| {
        let unit: Vec<f64> = (0..N).map(|k| f64::from(u8::from(k == i))).collect();
        forces(&zero, &unit) - &rest
    };
    let matrix = DMatrix::from_columns(&(0..N).map(column).collect::<Vec<_>>());
    let mut right = -bias;
    (0..3).for_each(|i| right[6 + i] += torques[i]);
    matrix.lu().solve(&right).unwrap()
}

fn torques(t: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let i = i as f64;
        0.12 * (TAU * (0.05 + 0.02 * i) * t + i).cos() + 0.15 * (TAU * (0.17 + 0.05 * i) * t).sin()
    })
}

/// Noise of 0.2 mm and 0.2 mrad at 50 Hz.
fn log(robot: &InterpretedRobot, seconds: f64) -> String {
    const STEP: f64 = 0.01;
    let mut noise = Noise::new(11);
    let mut state = State {
        place: Vector3::zeros(),
        hull: UnitQuaternion::identity(),
        wheels: [0.0; 3],
        boom: UnitQuaternion::identity(),
        v: DVector::zeros(N),
    };
    let mut text = String::from("t,hull_base_x,hull_base_y,hull_base_z");
    ["base", "boom"]
        .iter()
        .for_each(|name| write!(text, ",{name}_qw,{name}_qx,{name}_qy,{name}_qz").unwrap());
    text.push_str(
        ",wheel_x_position,wheel_y_position,wheel_z_position,wheel_x_effort,wheel_y_effort,wheel_z_effort\n",
    );
    for i in 0..(seconds / STEP) as usize {
        let t = STEP * i as f64;
        if i % 2 == 0 {
            let p = state.place + Vector3::from(noise.vector(2e-4));
            write!(text, "{t:.3},{:.5},{:.5},{:.5}", p.x, p.y, p.z).unwrap();
            for attitude in [state.hull, state.boom] {
                let q = attitude * UnitQuaternion::from_scaled_axis(Vector3::from(noise.vector(2e-4)));
                write!(text, ",{:.7},{:.7},{:.7},{:.7}", q.w, q.i, q.j, q.k).unwrap();
            }
            state.wheels.iter().for_each(|y| write!(text, ",{:.5}", y + 1e-4 * noise.normal()).unwrap());
            torques(t).iter().for_each(|u| write!(text, ",{:.5}", u + 1e-3 * noise.normal()).unwrap());
            text.push('\n');
        }
        // The midpoint rule: its error is far below the noise.
        let first = acceleration(robot, &state.positions(), &state.v, &torques(t));
        let half = state.moved(&(&state.v + 0.25 * STEP * &first), 0.5 * STEP);
        let middle = &state.v + 0.5 * STEP * &first;
        let second = acceleration(robot, &half.positions(), &middle, &torques(t + 0.5 * STEP));
        state = state.moved(&middle, STEP);
        state.v += STEP * second;
    }
    text
}

fn fit(folder: &Path, described: &InterpretedRobot, log: &str) -> Estimate {
    let path = folder.join("log.csv");
    fs::write(&path, log).unwrap();
    let settings = IdentificationSettings::new().unwrap();
    identify(described, &[path], &settings, &mut |_| ()).unwrap().estimate
}

/// About its centre of mass: xx, yy, zz.
fn inertia(p: &[f64]) -> [f64; 3] {
    let square = |i: usize| p[1 + i] * p[1 + i] / p[0];
    [p[4] - square(1) - square(2), p[6] - square(0) - square(2), p[9] - square(0) - square(1)]
}

#[test]
fn a_satellite_has_the_inertia_of_its_hull_back() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("truth.toml"), truth()).unwrap();
    let (described, truth) = (robot(&models("satellite.toml")), robot(&folder.path().join("truth.toml")));
    let found = fit(folder.path(), &described, &log(&truth, 60.0));
    let values: Vec<f64> = found.parameters.iter().map(|parameter| parameter.value).collect();
    let [before, after, real] = [&described.parameters(), &values, &truth.parameters()].map(|p| inertia(p));
    println!("inertia of the hull: {before:.3?} described, {after:.3?} estimated, {real:.3?} true");
    for (joint, name) in found.joints.iter().zip(described.joint_names()) {
        println!("{name} {:.4} {:.2e} {}", joint.held_out_r_squared, joint.sigma, joint.exact);
    }
    for (after, real) in after.iter().zip(real) {
        assert!((after / real - 1.0).abs() < 0.05, "{after} {real}");
    }
}
