//! Geometries that the literature counts operations for, with full inertias and general centres of mass.

use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{Body, Joint, JointKind, Limits, Link, Model, Motion, Options, Pose};

/// A row of modified Denavit–Hartenberg parameters: α [°], d, r (m).
pub type Row = (f64, f64, f64);

/// Two parallel axes.
pub const PLANAR: [Row; 2] = [(0.0, 0.0, 0.0), (0.0, 0.5, 0.0)];

/// The Stäubli RX-90 (Khalil and Dombre, Modeling, Identification and Control of Robots, 2002).
pub const RX90: [Row; 6] = [
    (0.0, 0.0, 0.0),
    (90.0, 0.0, 0.0),
    (0.0, 0.45, 0.0),
    (-90.0, 0.0, 0.45),
    (90.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0),
];

/// The Puma 560 (Armstrong, Khatib and Burdick 1986).
pub const PUMA: [Row; 6] = [
    (0.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0),
    (0.0, 0.4318, 0.15005),
    (-90.0, 0.0203, 0.4318),
    (90.0, 0.0, 0.0),
    (-90.0, 0.0, 0.0),
];

/// Six axes without any special angle or length.
pub const GENERAL: [Row; 6] = [
    (0.0, 0.0, 0.0),
    (31.0, 0.11, 0.23),
    (-47.0, 0.31, 0.13),
    (58.0, 0.17, -0.19),
    (-23.0, 0.29, 0.07),
    (71.0, 0.05, 0.37),
];

/// `count` axes with twists of ±90°.
pub fn right_angles(count: usize) -> Vec<Row> {
    let row = |k: usize| match k {
        0 => (0.0, 0.0, 0.0),
        _ => {
            let twist = if k.is_multiple_of(2) { 90.0 } else { -90.0 };
            (twist, 0.1 + 0.01 * k as f64, 0.2 + 0.007 * k as f64)
        }
    };
    (0..count).map(row).collect()
}

/// A chain of revolute joints without drives; nothing about its bodies is special.
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
        followers: vec![],
        drives: Vec::new(),
        point_forces: Vec::new(),
        force_inputs: Vec::new(),
        driven: vec![],
        wrenches: Vec::new(),
        frames: Vec::new(),
        options: Options::default(),
    }
}

fn link(k: usize, (alpha, d, r): Row) -> Link {
    let (s, c) = exact_sin_cos(alpha);
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
        bodies: vec![body(k)],
    }
}

/// Sine and cosine of an angle in degrees; exact at multiples of 90°.
fn exact_sin_cos(degrees: f64) -> (f64, f64) {
    match degrees {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        -90.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// Ten numbers that differ from body to body.
fn body(k: usize) -> Body {
    let vary =
        |base: f64, size: f64, phase: f64| Formula::Number(base + size * (1.7 * k as f64 + phase).sin());
    Body {
        name: format!("body{}", k + 1),
        mass: vary(3.0, 1.0, 0.1),
        center_of_mass: [vary(0.2, 0.05, 0.2), vary(0.0, 0.05, 0.9), vary(0.07, 0.03, 1.3)],
        inertia: [
            vary(0.11, 0.01, 0.3),
            vary(0.0, 0.013, 0.7),
            vary(0.0, 0.017, 1.9),
            vary(0.14, 0.01, 2.3),
            vary(0.0, 0.011, 2.9),
            vary(0.12, 0.01, 3.1),
        ],
    }
}
