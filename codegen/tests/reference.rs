//! The models that come out of descriptions have the right mass matrix and gravity.
//!
//! M = Σ m JᵥᵀJᵥ + J_ωᵀ I J_ω and g = −Σ m Jᵥᵀ g₀ are summed body by body here, from frames alone, and
//! compared with published tables and with Pinocchio's values.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gelenk_codegen::model::{Joint, JointKind, Model, Motion, RotorCoupling};
use gelenk_codegen::read::{ReadOptions, from_toml, from_urdf, read};
use serde_json::Value;
use std::path::{Path, PathBuf};

type Vector = [f64; 3];
type Matrix = [[f64; 3]; 3];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn apply(a: &Matrix, x: &Vector) -> Vector {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * x[k]).sum())
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

struct Placed {
    origin: Vector,
    axes: Matrix,
    /// Unit axis in the base frame.
    axis: Vector,
}

fn position(joint: &Joint, y: &[f64]) -> f64 {
    match joint.motion {
        Motion::Fixed => 0.0,
        Motion::Held(position) => position,
        Motion::Follower(_) => unreachable!("no robot here has joints that follow others"),
        Motion::Coordinate(index) => y[index],
    }
}

fn place(model: &Model, y: &[f64]) -> Vec<Placed> {
    let p: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut placed: Vec<Placed> = Vec::new();
    for link in &model.links {
        let Some(joint) = &link.joint else {
            placed.push(Placed { origin: [0.0; 3], axes: identity, axis: [0.0; 3] });
            continue;
        };
        let parent = &placed[joint.parent];
        let shift: Vector = std::array::from_fn(|k| joint.origin.translation[k].evaluate(&p, 0.0, 0.0));
        let moved = apply(&parent.axes, &shift);
        let axes = product(&parent.axes, &joint.origin.rotation);
        let axis = apply(&axes, &joint.axis);
        let q = position(joint, y);
        let [x, y, z] = joint.axis;
        let [turn, along] = joint.kind.turn_and_slide().map(|share| share * q);
        let (s, c) = f64::sin_cos(turn);
        let t = 1.0 - c;
        let spin = [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
        ];
        let origin = std::array::from_fn(|k| parent.origin[k] + moved[k] + along * axis[k]);
        placed.push(Placed { origin, axes: product(&axes, &spin), axis });
    }
    placed
}

/// Columns of the Jacobians of a point on a link.
fn jacobian(model: &Model, placed: &[Placed], link: usize, point: &Vector) -> Vec<(Vector, Vector)> {
    let mut columns = vec![([0.0; 3], [0.0; 3]); model.coordinates.len()];
    let mut at = link;
    while let Some(joint) = &model.links[at].joint {
        if let Motion::Coordinate(index) = joint.motion {
            let Placed { origin, axis, .. } = &placed[at];
            let arm = std::array::from_fn(|k| point[k] - origin[k]);
            columns[index] = match joint.kind {
                JointKind::Prismatic => (*axis, [0.0; 3]),
                _ => (cross(axis, &arm), *axis),
            };
        }
        at = joint.parent;
    }
    columns
}

/// Mass matrix and gravity torque g (Pinocchio's sign: it holds the robot still).
fn mass_and_gravity(model: &Model, y: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let p: Vec<f64> = model.parameters.iter().map(|parameter| parameter.default).collect();
    let n = model.coordinates.len();
    let (mut mass, mut gravity) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    let placed = place(model, y);
    let g0: Vector = std::array::from_fn(|k| model.gravity[k].evaluate(&p, 0.0, 0.0));
    for (index, link) in model.links.iter().enumerate() {
        for body in &link.bodies {
            let m = body.mass.evaluate(&p, 0.0, 0.0);
            let center: Vector = std::array::from_fn(|k| body.center_of_mass[k].evaluate(&p, 0.0, 0.0));
            let turned = apply(&placed[index].axes, &center);
            let point = std::array::from_fn(|k| placed[index].origin[k] + turned[k]);
            let [xx, xy, xz, yy, yz, zz] = std::array::from_fn(|k| body.inertia[k].evaluate(&p, 0.0, 0.0));
            let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let columns = jacobian(model, &placed, index, &point);
            let local = |w: &Vector| {
                let axes = &placed[index].axes;
                std::array::from_fn(|j| (0..3).map(|i| axes[i][j] * w[i]).sum::<f64>())
            };
            for i in 0..n {
                gravity[i] -= m * dot(&columns[i].0, &g0);
                for j in 0..n {
                    let (wi, wj): (Vector, Vector) = (local(&columns[i].1), local(&columns[j].1));
                    mass[i][j] += m * dot(&columns[i].0, &columns[j].0) + dot(&wi, &apply(&inertia, &wj));
                }
            }
        }
    }
    add_rotors(model, &placed, &p, &mut mass);
    (mass, gravity)
}

fn add_rotors(model: &Model, placed: &[Placed], p: &[f64], mass: &mut [Vec<f64>]) {
    for drive in &model.drives {
        let (ratio, rotor) =
            (drive.gear_ratio.evaluate(p, 0.0, 0.0), drive.rotor_inertia.evaluate(p, 0.0, 0.0));
        let axis = apply(&placed[drive.carrier].axes, &drive.axis);
        let columns = jacobian(model, placed, drive.carrier, &placed[drive.carrier].origin);
        let mut spin: Vec<f64> = columns.iter().map(|(_, w)| dot(w, &axis)).collect();
        if drive.coupling == RotorCoupling::Diagonal {
            spin.fill(0.0);
        }
        if let Some(coordinate) = drive.coordinate() {
            spin[coordinate] += ratio;
        }
        for i in 0..spin.len() {
            for j in 0..spin.len() {
                mass[i][j] += rotor * spin[i] * spin[j];
            }
        }
    }
}

fn workspace(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn reference(name: &str) -> Value {
    let path = workspace("tests/reference").join(format!("{name}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

/// Largest deviation relative to the largest entry; absolute where all are zero.
fn deviation(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let scale = if largest == 0.0 { 1.0 } else { largest };
    found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / scale
}

fn compare_with_pinocchio(model: &Model, reference: &Value, tolerance: f64) {
    let joints: Vec<&str> =
        reference["joints"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let own: Vec<&str> = model
        .coordinates
        .iter()
        .map(|link| model.links[*link].joint.as_ref().unwrap().name.as_str())
        .collect();
    assert_eq!(joints, own);
    for sample in reference["samples"].as_array().unwrap() {
        let (mass, gravity) = mass_and_gravity(model, &numbers(&sample["y"]));
        assert!(deviation(&mass.concat(), &numbers(&sample["M"])) < tolerance);
        assert!(deviation(&gravity, &numbers(&sample["g"])) < tolerance);
    }
}

#[test]
fn a_urdf_agrees_with_pinocchio() {
    let loaded = read(&workspace("models/urdf/ur5.urdf"), &ReadOptions::default());
    let model = loaded.unwrap_or_else(|wrong| panic!("{wrong}")).model;
    compare_with_pinocchio(&model, &reference("ur5"), 1e-13);
}

#[test]
fn committed_vendor_models_agree_with_pinocchio() {
    // The UR5's 1.57079632679 is snapped, 5e-12 rad away.
    for (name, tolerance) in [("ur5", 1e-10), ("panda", 1e-13)] {
        compare_with_pinocchio(&committed(name), &reference(name), tolerance);
    }
}

fn committed(name: &str) -> Model {
    let path = workspace(&format!("models/{name}.toml"));
    read(&path, &ReadOptions::default()).unwrap_or_else(|wrong| panic!("{wrong}")).model
}

#[test]
fn powercube_has_the_published_constants() {
    let model = committed("powercube");
    let (i, j_r, h, g) = (161.0, 5.267e-5, 0.3107549862, 9.80665);
    for [b, c] in [[0.3_f64, -1.1_f64], [0.0, 0.0], [2.0, 0.7]] {
        let (mass, gravity) = mass_and_gravity(&model, &[b, c]);
        let m12 = j_r * i + h * c.cos() + 0.6608899068565;
        let m11 = j_r * i * i + 2.0 * h * c.cos() + 0.9560375168565;
        let expected = [m11, m12, m12, j_r * i * i + 0.6608899068565];
        assert!(deviation(&mass.concat(), &expected) < 1e-15 * 8.0);
        let q2 = 1.72641659 * g * (b + c).sin();
        let expected = [-1.626138 * g * b.sin() - q2, -q2];
        assert!(gravity.iter().zip(expected).all(|(a, e)| (a - e).abs() < 1e-13));
    }
}

#[test]
fn powercube_agrees_with_its_published_states() {
    let model = committed("powercube");
    let reference = reference("powercube/dynamics");
    for sample in reference["samples"].as_array().unwrap() {
        let (y, v) = (numbers(&sample["y"]), numbers(&sample["v"]));
        let (mass, gravity) = mass_and_gravity(&model, &y);
        assert!(deviation(&mass.concat(), &numbers(&sample["M"])) < 1e-14);
        let q: Vec<f64> = (0..2).map(|k| -gravity[k] - friction(&model, k, v[k])).collect();
        assert!(deviation(&q, &numbers(&sample["q"])) < 1e-14);
    }
}

fn friction(model: &Model, coordinate: usize, v: f64) -> f64 {
    let joint = model.links[model.coordinates[coordinate]].joint.as_ref().unwrap();
    let terms = joint.friction.iter();
    terms.map(|term| term.coefficient.evaluate(&[], 0.0, v) * term.basis.evaluate(&[], 0.0, v)).sum()
}

/// Robotics Toolbox for Python, tests/test_DHRobot.py: four decimals.
#[test]
fn puma_has_the_published_tables() {
    let model = committed("puma560");
    let pi = std::f64::consts::PI;
    let (mass, gravity) = mass_and_gravity(&model, &[0.0, pi / 4.0, pi, 0.0, pi / 4.0, 0.0]);
    let table = [
        [3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0],
        [-0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0],
        [0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0],
        [-0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0],
        [0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.1941],
    ];
    for (row, expected) in mass.iter().zip(table) {
        assert!(row.iter().zip(expected).all(|(a, e)| (a - e).abs() < 5.1e-5), "{row:?}");
    }
    let expected = [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0];
    assert!(gravity.iter().zip(expected).all(|(a, e)| (a - e).abs() < 5.1e-5), "{gravity:?}");
    // (q̇ = 1, q̈ = 1, g = 0) − (q̇ = 0, q̈ = 1, with g): the last joint has no other velocity torque.
    assert!((friction(&model, 5, 1.0) - (0.713781 - 0.194133)).abs() < 2e-4);
}

#[test]
fn held_powercube_moves_the_masses_of_the_reduced_one() {
    let whole = committed("powercube_six_axis");
    let reduced = committed("powercube");
    let y = [0.0, 0.4, -0.9, 0.0, 0.0, 0.0];
    let (_, g6) = mass_and_gravity(&whole, &y);
    let (_, g2) = mass_and_gravity(&reduced, &[0.4, -0.9]);
    assert!((g6[1] - g2[0]).abs() < 1e-12 && (g6[2] - g2[1]).abs() < 1e-12, "{g6:?} {g2:?}");
    let alpha = committed("powercube_alpha");
    assert_eq!(alpha.coordinates.len(), 1);
    let (m1, _) = mass_and_gravity(&alpha, &[0.3]);
    let (m6, _) = mass_and_gravity(&whole, &[0.3, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0]);
    assert!((m1[0][0] - m6[0][0]).abs() < 1e-12, "{m1:?} {m6:?}");
}

/// The same arm in modified Denavit–Hartenberg rows and in joint origins.
#[test]
fn dh_rows_and_origins_describe_the_same_arm() {
    let joint = |name: &str, row: &str, place: &str| {
        format!(
            "[[joints]]\nname = \"{name}\"\n{}\n[[bodies]]\nlink = \"{name}\"\nmass = 2\n\
             center_of_mass = [0.1, 0.2, 0.3]\ninertia = {{ xx = 0.5, yy = 0.6, zz = 0.7, xy = 0.1 }}\n",
            if row.is_empty() { place } else { row }
        )
    };
    let rows = joint("a1", "modified_dh = { d = 0.3 }", "")
        + joint("a2", "modified_dh = { alpha = \"-pi/2\", a = 0.1, theta = 0.4 }", "").as_str();
    let places = joint("a1", "", "origin = { xyz = [0, 0, 0.3] }")
        // Turned by −90° about x, then by 0.4 about the new z.
        + joint(
            "a2",
            "",
            "origin = { xyz = [0.1, 0, 0], quaternion = { w = 0.6930117232058354, x = -0.6930117232058354, y = 0.1404804310189812, z = 0.1404804310189812 } }",
        )
        .as_str();
    let load = |text: &str| {
        let none = &mut |_: &str| unreachable!();
        from_toml(text, "arm.toml", &ReadOptions::default(), none).unwrap_or_else(|wrong| panic!("{wrong}")).0
    };
    let (a, b) = (load(&rows), load(&places));
    let (ma, ga) = mass_and_gravity(&a, &[0.3, 0.7]);
    let (mb, gb) = mass_and_gravity(&b, &[0.3, 0.7]);
    assert!(deviation(&ma.concat(), &mb.concat()) < 1e-14, "{ma:?} {mb:?}");
    assert!(deviation(&ga, &gb) < 1e-14, "{ga:?} {gb:?}");
}

#[test]
fn urdf_text_needs_no_file() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/urdf/ur5.urdf"))
        .unwrap();
    let (model, notes) = from_urdf(&text, "ur5.urdf", &ReadOptions::default()).unwrap();
    assert_eq!(model.coordinates.len(), 6);
    assert!(notes.to_string().contains("within 1e-4 rad of a multiple of 90°"), "{notes}");
}
