//! Models for tests: geometries from the literature with full inertias and general centres of mass.

use crate::model::*;
use gelenk_formula::Formula;

/// A row of modified Denavit–Hartenberg parameters: α (°) about x, d (m) along x, r (m) along z.
pub type Row = (f64, f64, f64);

/// The geometry of the Stäubli RX-90 (Khalil and Dombre 2002).
pub const RX90: [Row; 6] = [
    (0.0, 0.0, 0.0),
    (90.0, 0.0, 0.0),
    (0.0, 0.45, 0.0),
    (-90.0, 0.0, 0.45),
    (90.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0),
];

/// The geometry of the Puma 560 in the parameters of [`Row`].
pub const PUMA: [Row; 6] = [
    (0.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0),
    (0.0, 0.4318, 0.15005),
    (-90.0, 0.0203, 0.4318),
    (90.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0),
];

/// Six joints without any special angle or length.
pub const GENERAL: [Row; 6] = [
    (0.0, 0.0, 0.0),
    (31.0, 0.11, 0.23),
    (-47.0, 0.31, 0.13),
    (58.0, 0.17, -0.19),
    (-23.0, 0.29, 0.07),
    (71.0, 0.05, 0.37),
];

/// Creates a chain of revolute joints with full inertias and general centres of mass.
pub fn chain(rows: &[Row], gravity: [f64; 3]) -> Model {
    let base = Link { name: "base".into(), joint: None, bodies: Vec::new() };
    let links = rows.iter().enumerate().map(|(k, &row)| link(k, row));
    Model {
        name: "chain".into(),
        description: Vec::new(),
        gravity: gravity.map(Formula::Number),
        parameters: Vec::new(),
        links: std::iter::once(base).chain(links).collect(),
        coordinates: (1..=rows.len()).collect(),
        quaternion_joints: Vec::new(),
        followers: Vec::new(),
        drives: Vec::new(),
        point_forces: Vec::new(),
        force_inputs: Vec::new(),
        driven: Vec::new(),
        wrenches: Vec::new(),
        frames: Vec::new(),
        options: Options::default(),
    }
}

fn link(k: usize, (alpha, d, r): Row) -> Link {
    let x = k as f64;
    let (s, c) = crate::spatial::exact_sin_cos(alpha);
    let wobble = |phase: f64| (1.7 * x + phase).sin();
    Link {
        name: format!("link{}", k + 1),
        joint: Some(Joint {
            name: format!("q{}", k + 1),
            identifier: format!("q{}", k + 1),
            parent: k,
            kind: JointKind::Revolute,
            origin: Pose {
                translation: [d, -s * r, c * r].map(Formula::Number),
                rotation: [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
            },
            axis: [0.0, 0.0, 1.0],
            motion: Motion::Coordinate(k),
            limits: Limits::default(),
            springs: Vec::new(),
            friction: Vec::new(),
            load_friction: Vec::new(),
        }),
        bodies: vec![Body {
            name: format!("body{}", k + 1),
            mass: Formula::Number(3.0 + wobble(0.1)),
            center_of_mass: [0.2 + 0.05 * wobble(0.2), 0.05 * wobble(0.9), 0.07 + 0.03 * wobble(1.3)]
                .map(Formula::Number),
            inertia: [
                0.11 + 0.01 * wobble(0.3),
                0.013 * wobble(0.7),
                0.017 * wobble(1.9),
                0.14 + 0.01 * wobble(2.3),
                0.011 * wobble(2.9),
                0.12 + 0.01 * wobble(3.1),
            ]
            .map(Formula::Number),
        }],
    }
}
