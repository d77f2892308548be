//! The layouts of Drake and MuJoCo by the table of `models/README.md`, against values of these programs:
//! `tests/reference/make_layouts.py` made them.

use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_tests::{Robot, workspace};
use nalgebra::{DMatrix, DVector, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde_json::Value;

use super::reference::numbers;
use super::{VALUES, check, rows};

/// The joints of `layouts.toml` in order.
#[derive(Clone, Copy)]
enum Kind {
    Floating,
    Spherical,
    Hinge,
}
const JOINTS: [Kind; 4] = [Kind::Floating, Kind::Spherical, Kind::Hinge, Kind::Spherical];

/// A joint's positions in another program, read as what gelenk calls them, and its velocities there for a unit of each
/// velocity of gelenk.
struct Place {
    y: Vec<f64>,
    /// The columns are gelenk's velocities, the rows those of the other program.
    columns: DMatrix<f64>,
}

type Layout = fn(Kind, &mut dyn Iterator<Item = f64>) -> Place;

fn next<const K: usize>(q: &mut dyn Iterator<Item = f64>) -> [f64; K] {
    std::array::from_fn(|_| q.next().expect("a position"))
}

/// Quaternion w x y z to x y z w, and its rotation.
fn w_first([w, x, y, z]: [f64; 4]) -> ([f64; 4], Matrix3<f64>) {
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    ([x, y, z, w], turn.to_rotation_matrix().into_inner())
}

fn hinge(q: &mut dyn Iterator<Item = f64>) -> Place {
    Place { y: next::<1>(q).to_vec(), columns: DMatrix::identity(1, 1) }
}

/// Six columns: linear, then angular; blocks begin at these rows.
fn floating(place: [f64; 3], x: [f64; 4], blocks: [(usize, Matrix3<f64>); 2]) -> Place {
    let mut columns = DMatrix::zeros(6, 6);
    for (part, (row, block)) in blocks.iter().enumerate() {
        columns.fixed_view_mut::<3, 3>(*row, 3 * part).copy_from(block);
    }
    Place { y: [&place[..], &x].concat(), columns }
}

/// Drake: quaternion w x y z before the place, angular before linear velocity, both along the axes of the parent; balls
/// have roll, pitch and yaw, and angular velocities along the axes of the parent.
fn drake(kind: Kind, q: &mut dyn Iterator<Item = f64>) -> Place {
    match kind {
        Kind::Floating => {
            let (x, turn) = w_first(next(q));
            floating(next(q), x, [(3, turn), (0, turn)])
        }
        Kind::Spherical => {
            let [roll, pitch, yaw] = next(q);
            let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
            let x = UnitQuaternion::from_rotation_matrix(&turn);
            let columns = DMatrix::from_column_slice(3, 3, turn.matrix().as_slice());
            Place { y: x.coords.as_slice().to_vec(), columns }
        }
        Kind::Hinge => hinge(q),
    }
}

/// MuJoCo: the place before the quaternion w x y z, linear velocity along the axes of the world, angular velocity along
/// those of the body.
fn mujoco(kind: Kind, q: &mut dyn Iterator<Item = f64>) -> Place {
    match kind {
        Kind::Floating => {
            let place = next(q);
            let (x, turn) = w_first(next(q));
            floating(place, x, [(0, turn), (3, Matrix3::identity())])
        }
        Kind::Spherical => Place { y: w_first(next(q)).0.to_vec(), columns: DMatrix::identity(3, 3) },
        Kind::Hinge => hinge(q),
    }
}

/// All joints after another.
fn converted(layout: Layout, q: Vec<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let mut q = q.into_iter();
    let places = JOINTS.map(|kind| layout(kind, &mut q));
    let size = places.iter().map(|place| place.columns.ncols()).sum();
    let (mut all, mut first) = (DMatrix::zeros(size, size), 0);
    for Place { columns, .. } in &places {
        let width = columns.ncols();
        all.view_mut((first, first), (width, width)).copy_from(columns);
        first += width;
    }
    (places.into_iter().flat_map(|place| place.y).collect(), all)
}

fn agrees(program: &str, layout: Layout) {
    let folder = workspace().join("tests/reference");
    let robot = Robot::derive(&folder.join("layouts.toml"), &GenerateOptions::default());
    let text = std::fs::read_to_string(folder.join("layouts.json")).expect("committed values");
    let reference: Value = serde_json::from_str(&text).expect("JSON");
    let samples = reference[program]["samples"].as_array().expect("samples");
    assert_eq!(samples.len(), 3);
    for (number, sample) in samples.iter().enumerate() {
        let get = |key: &str| DVector::from_vec(numbers(&sample[key]));
        let what = |key: &str| format!("{program} {number} {key}");
        let (y, columns) = converted(layout, numbers(&sample["q"]));
        // The columns are orthogonal: velocities and forces are converted by their transpose.
        let to_ours = columns.transpose();
        let v = &to_ours * get("v");
        let mut a = &to_ours * get("a");
        let [linear, angular] =
            [0, 3].map(|first| Vector3::from_column_slice(&v.as_slice()[first..first + 3]));
        let turning = angular.cross(&linear);
        (0..3).for_each(|i| a[i] -= turning[i]);
        let theirs = &to_ours * get("id");
        let found = robot.first("inverse_dynamics", &[&y, v.as_slice(), a.as_slice()]);
        check(&what("id"), &found, theirs.as_slice(), VALUES);
        let mass = DMatrix::from_row_slice(v.len(), v.len(), &numbers(&sample["M"]));
        check(&what("M"), &robot.first("mass_matrix", &[&y]), &rows(&(&to_ours * mass * &columns)), VALUES);
    }
}

#[test]
fn drake_computes_the_same_in_its_layout() {
    agrees("drake", drake);
}

#[test]
fn mujoco_computes_the_same_in_its_layout() {
    agrees("mujoco", mujoco);
}
