//! Numbers, directions and rotations by chance. Most are exact: coordinate axes of both signs, zeros, equal lengths, quarter
//! turns. Rules for parallel axes and common origins show there alone.

use std::f64::consts::{FRAC_PI_2, PI};

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::Body;

/// Share of exact values: two axes and the rotation between them are exact half of the time, by its third power.
const EXACT: f64 = 0.8;

/// An exact value mostly, else a generic one.
fn exact_or<T>(rng: &mut Rng, exact: impl FnOnce(&mut Rng) -> T, generic: impl FnOnce(&mut Rng) -> T) -> T {
    if chance(rng, EXACT) { exact(rng) } else { generic(rng) }
}

pub(super) fn chance(rng: &mut Rng, probability: f64) -> bool {
    rng.f64() < probability
}

/// Between −size and size.
pub(super) fn within(rng: &mut Rng, size: f64) -> f64 {
    size * (2.0 * rng.f64() - 1.0)
}

pub(super) fn number(x: f64) -> Formula {
    Formula::Number(x)
}

pub(super) fn product(a: Formula, b: Formula) -> Formula {
    Formula::Multiply(Box::new(a), Box::new(b))
}

fn principal(rng: &mut Rng) -> [f64; 3] {
    let mut axis = [0.0; 3];
    axis[rng.usize(0..3)] = if rng.bool() { 1.0 } else { -1.0 };
    axis
}

pub(super) fn axis(rng: &mut Rng) -> [f64; 3] {
    exact_or(rng, principal, direction)
}

/// Within ±size.
pub(super) fn length(rng: &mut Rng, size: f64) -> f64 {
    let exact = |rng: &mut Rng| [0.0, 0.0, 0.5 * size, -0.5 * size][rng.usize(0..4)];
    exact_or(rng, exact, |rng| within(rng, size))
}

/// A point with coordinates within ±size.
pub(crate) fn place(rng: &mut Rng, size: f64) -> [f64; 3] {
    [0; 3].map(|_| length(rng, size))
}

/// Within a turn.
pub(super) fn angle(rng: &mut Rng) -> f64 {
    exact_or(rng, |rng| [0.0, FRAC_PI_2, -FRAC_PI_2, PI][rng.usize(0..4)], |rng| within(rng, PI))
}

pub(super) fn direction(rng: &mut Rng) -> [f64; 3] {
    loop {
        let a = [within(rng, 1.0), within(rng, 1.0), within(rng, 1.0)];
        let length = a[0].hypot(a[1]).hypot(a[2]);
        if (0.1..1.0).contains(&length) {
            return scaled(a, 1.0 / length);
        }
    }
}

fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}

/// None, quarter turns, or any.
pub(super) fn rotation(rng: &mut Rng) -> [[f64; 3]; 3] {
    exact_or(rng, quarter_turns, |rng| {
        let x = direction(rng);
        let other = cross(x, direction(rng));
        let length = other[0].hypot(other[1]).hypot(other[2]);
        let y = scaled(other, 1.0 / length);
        [x, y, cross(x, y)]
    })
}

fn quarter_turns(rng: &mut Rng) -> [[f64; 3]; 3] {
    if rng.bool() {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let x = principal(rng);
    loop {
        let y = principal(rng);
        let z = cross(x, y);
        if z != [0.0; 3] {
            return [x, y, z];
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn point_mass(rng: &mut Rng, name: &str) -> Body {
    Body {
        name: name.into(),
        mass: number(0.2 + 2.0 * rng.f64()),
        center_of_mass: place(rng, 0.3).map(number),
        inertia: [0.0; 6].map(number),
    }
}

/// Inertia from principal second moments in random axes, so that it is that of a real body.
pub(crate) fn rigid_body(rng: &mut Rng, name: &str) -> Body {
    let axes = rotation(rng);
    let second = [0; 3].map(|_| 0.03 + length(rng, 0.04).max(-0.025));
    let trace: f64 = second.iter().sum();
    let entry = |i: usize, j: usize| {
        let moment: f64 = (0..3).map(|k| axes[k][i] * second[k] * axes[k][j]).sum();
        number(if i == j { trace - moment } else { -moment })
    };
    Body {
        inertia: [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)],
        ..point_mass(rng, name)
    }
}
