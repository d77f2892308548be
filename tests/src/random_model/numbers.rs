//! Numbers, directions and rotations by chance.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;

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

pub(super) fn principal(rng: &mut Rng) -> [f64; 3] {
    let mut axis = [0.0; 3];
    axis[rng.usize(0..3)] = if rng.bool() { 1.0 } else { -1.0 };
    axis
}

pub(super) fn axis(rng: &mut Rng) -> [f64; 3] {
    if chance(rng, 0.6) { principal(rng) } else { direction(rng) }
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

pub(super) fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| x * factor)
}

/// None, quarter turns, or any.
pub(super) fn rotation(rng: &mut Rng) -> [[f64; 3]; 3] {
    let x = principal(rng);
    match rng.u8(0..3) {
        0 => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        1 => loop {
            let y = principal(rng);
            let z = cross(x, y);
            if z != [0.0; 3] {
                return [x, y, z];
            }
        },
        _ => {
            let x = direction(rng);
            let other = cross(x, direction(rng));
            let length = other[0].hypot(other[1]).hypot(other[2]);
            let y = scaled(other, 1.0 / length);
            [x, y, cross(x, y)]
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
