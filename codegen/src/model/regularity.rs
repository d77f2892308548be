//! Check that the mass matrix is positive definite.
//!
//! The pivots of the mass matrix in its factorization along the tree are the divisors of the articulated-body
//! recursion: `Dᵢ = Sᵢᵀ Iᵢᴬ Sᵢ` with the joint's axis Sᵢ and the articulated inertia Iᵢᴬ (Featherstone, Rigid
//! Body Dynamics Algorithms, 2008, ch. 7). The mass matrix is positive definite if and only if all pivots are
//! positive.

mod coupled;

use super::{Joint, Link, Model, Motion, Pose};
use crate::random::Random;
use crate::wording::three_digits;

type Matrix = [[f64; 6]; 6];

/// A pivot of the mass matrix is treated as zero if it is below this fraction of a reference inertia. The
/// reference is the inertia of all bodies beyond the joint about the same axis.
const ROUNDING: f64 = 1e-12;

/// Number of states at which the mass matrix is tested. The first state is in general position. The positions
/// of the other states are within the limits.
pub(crate) const STATES: usize = 16;
const SEED: u64 = 0x7069_766f_7473;

/// Largest number of coordinates of robots for which messages quote the mass matrix. Its memory grows with
/// the square of this number, and the time for its factorization with the cube.
const LARGEST: usize = 500;

/// Signs of the pivots of the mass matrix at pseudo-random states.
#[derive(Debug, Default)]
pub(crate) struct Pivots {
    /// Links of the joints whose pivots in the mass matrix are zero at every state. Motions of these joints
    /// move no mass.
    pub zero: Vec<usize>,
    /// Links of the joints whose pivots in the mass matrix are negative at some state.
    pub negative: Vec<usize>,
    /// Number of states at which a pivot of the mass matrix is negative.
    pub indefinite_states: usize,
}

impl Pivots {
    /// Whether the mass matrix is positive definite at all states.
    pub fn are_positive(&self) -> bool {
        self.zero.is_empty() && self.negative.is_empty()
    }

    /// Motions x with M x = 0 at a general position for the mass matrix M, as text. There is one motion for
    /// each coordinate with a zero pivot. Its entry is 1 at this coordinate and 0 at the other coordinates
    /// with a zero pivot. Velocities of joints with a quaternion are in the frame of the body.
    ///
    /// If no pivot is zero at this position, or if the robot has more than 500 coordinates, the result
    /// contains only the joints' names.
    pub fn free_motions(&self, model: &Model) -> Vec<String> {
        let of_joints =
            || model.joints_of(&self.zero).iter().map(|joint| format!("`{}`", joint.name)).collect();
        if self.zero.is_empty() || model.coordinates.len() > LARGEST {
            return of_joints();
        }
        let described = model.described_parameters();
        let parts = model.quaternion_joints.iter().flat_map(|joint| joint.coordinates());
        let parts: Vec<usize> = parts.map(|part| model.coordinates[part]).collect();
        let position = |link: usize| if parts.contains(&link) { 0.0 } else { general(link) };
        let positions = positions(model, &described, |link, _| position(link));
        let (mass, _) = coupled::mass_matrix(model, &described, &positions);
        let pivots = coupled::pivots(model, &described, &positions);
        let is_zero = |coordinate: &usize| pivots[model.coordinates[*coordinate]] == Some(Pivot::Zero);
        let (zero, others): (Vec<usize>, Vec<usize>) = (0..model.coordinates.len()).partition(is_zero);
        let names: Vec<&str> = model.joints().map(|joint| joint.name.as_str()).collect();
        if zero.is_empty() {
            // At a rotated position, several parts of a joint with a quaternion may be singular together.
            return of_joints();
        }
        zero.iter().map(|&own| sum(&null_vector(&mass, &others, own), &names)).collect()
    }

    /// Determines the pivots of the mass matrix at pseudo-random states, with the parameter values of the
    /// description.
    pub fn of(model: &Model) -> Self {
        let described = model.described_parameters();
        let mut random = Random::new(SEED);
        let (mut zero, mut negative) = (vec![0; model.links.len()], vec![0; model.links.len()]);
        let mut indefinite_states = 0;
        for state in 0..STATES {
            let positions = positions(model, &described, |index, [low, high]| match state {
                0 => general(index),
                _ => random.between(low, high),
            });
            let pivots = match model.is_coupled() {
                true => coupled::pivots(model, &described, &positions),
                false => pivots(model, &described, &positions),
            };
            let is_negative = |pivot: &Option<Pivot>| *pivot == Some(Pivot::Negative);
            indefinite_states += usize::from(pivots.iter().any(is_negative));
            for (link, pivot) in pivots.into_iter().enumerate() {
                let Some(pivot) = pivot else { continue };
                zero[link] += usize::from(pivot == Pivot::Zero);
                negative[link] += usize::from(pivot == Pivot::Negative);
            }
        }
        let links = |counts: Vec<usize>, least: usize| {
            let found = counts.into_iter().enumerate();
            let found = found.filter(|&(_, count)| count >= least);
            found.map(|(link, _)| link).collect()
        };
        Self { zero: links(zero, STATES), negative: links(negative, 1), indefinite_states }
    }
}

/// Positions of the joints of all links. Positions of joints that follow coordinates are computed from the
/// coordinates.
///
/// - `choose`: maps the index of a link and the range of its joint to a position
pub(crate) fn positions(
    model: &Model,
    described: &[f64],
    mut choose: impl FnMut(usize, [f64; 2]) -> f64,
) -> Vec<f64> {
    let position = |(index, link): (usize, &Link)| match &link.joint {
        None => 0.0,
        Some(joint) => choose(index, joint.seeded_range()),
    };
    let mut positions: Vec<f64> = model.links.iter().enumerate().map(position).collect();
    for follower in &model.followers {
        let terms = follower.follows.iter().map(|term| {
            term.ratio.evaluate(described, 0.0, 0.0)
                * model.link_of(term.coordinate).map_or(0.0, |link| positions[link])
        });
        positions[follower.link] = terms.sum::<f64>() + follower.offset;
    }
    positions
}

/// Position of a link's joint. The irrational factor keeps the angles of different joints in general position.
fn general(link: usize) -> f64 {
    0.4 + (link as f64 * 0.618_033_988_75).fract()
}

/// The vector x with M x = 0 for the mass matrix M.
///
/// It has x = 1 at coordinate k (`own`), and `x_o = −M_oo⁻¹ M_ok` at the other coordinates o without a zero
/// pivot. It is computed by Gaussian elimination.
fn null_vector(mass: &[Vec<f64>], others: &[usize], own: usize) -> Vec<f64> {
    let row = |&i: &usize| others.iter().map(|&j| mass[i][j]).chain([-mass[i][own]]).collect();
    let mut rows: Vec<Vec<f64>> = others.iter().map(row).collect();
    for k in 0..rows.len() {
        let pivot = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).for_each(|(entry, from)| *entry -= factor * from);
        }
    }
    let mut direction = vec![0.0; mass.len()];
    direction[own] = 1.0;
    for (k, &coordinate) in others.iter().enumerate() {
        direction[coordinate] = rows[k][others.len()] / rows[k][k];
    }
    direction
}

/// Coefficients of a motion below this magnitude are treated as rounding errors.
const VISIBLE: f64 = 1e-6;

/// Writes a motion as a weighted sum over joints, for example `a` − 0.5 `b`.
fn sum(direction: &[f64], names: &[&str]) -> String {
    let mut text = String::new();
    for (share, name) in direction.iter().zip(names).filter(|(share, _)| share.abs() > VISIBLE) {
        let size = three_digits(share.abs());
        let factor = if size == "1" { String::new() } else { format!("{size} ") };
        let sign = match (text.is_empty(), *share < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, true) => " − ",
            (false, false) => " + ",
        };
        text += &format!("{sign}{factor}`{name}`");
    }
    text
}

/// Diagonal of the mass matrix if all coordinates are 0. Rotors add only i² J to the diagonal, even on moving
/// links, with gear ratio i and axial inertia J. The result is empty for robots with more than 500
/// coordinates.
pub(crate) fn diagonal_at_zero(model: &Model) -> Vec<f64> {
    if model.coordinates.len() > LARGEST {
        return Vec::new();
    }
    let described = model.described_parameters();
    let positions = positions(model, &described, |_, _| 0.0);
    let (mass, _) = coupled::mass_matrix(model, &described, &positions);
    mass.iter().enumerate().map(|(k, row)| row[k]).collect()
}

/// Sign of a pivot of the mass matrix. A pivot within the rounding error is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pivot {
    Negative,
    Zero,
    Positive,
}

/// Pivot of the mass matrix for each link's joint; `None` if the joint is not independent.
fn pivots(model: &Model, described: &[f64], positions: &[f64]) -> Vec<Option<Pivot>> {
    let links = model.links.iter();
    let mut articulated: Vec<Matrix> = links.map(|link| link_inertia(link, described)).collect();
    let mut composite = articulated.clone();
    let armature = armatures(model, described);
    let mut pivots = vec![None; model.links.len()];
    for (index, link) in model.links.iter().enumerate().rev() {
        let Some(joint) = &link.joint else { continue };
        let transform = child_from_parent(joint, positions[index], described);
        let whole = composite[index];
        let mut rest = articulated[index];
        if matches!(joint.motion, Motion::Coordinate(coordinate) if coordinate < model.coordinates.len()) {
            let axis = motion_axis(joint);
            let pivot = quadratic(&rest, &axis) + armature[index];
            let rounding = ROUNDING * (quadratic(&whole, &axis).abs() + armature[index]);
            // A negative pivot is reported as a fault of the description. Rounding errors of large terms must
            // not count.
            let large = ROUNDING * (magnitude(&whole, &axis) + armature[index]);
            pivots[index] = Some(match pivot {
                pivot if pivot > rounding => Pivot::Positive,
                pivot if pivot < -large => Pivot::Negative,
                _ => Pivot::Zero,
            });
            if pivots[index] != Some(Pivot::Zero) {
                project(&mut rest, &axis, pivot);
            }
        }
        add(&mut articulated[joint.parent], &congruent(&rest, &transform));
        add(&mut composite[joint.parent], &congruent(&whole, &transform));
    }
    pivots
}

/// Inertia `i² J_R` at each link's joint: squared gear ratio times the rotor's axial inertia.
fn armatures(model: &Model, defaults: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; model.links.len()];
    for drive in &model.drives {
        let link = drive.coordinate().and_then(|coordinate| model.coordinates.get(coordinate));
        let ratio = drive.gear_ratio.evaluate(defaults, 0.0, 0.0);
        if let Some(link) = link {
            result[*link] += ratio * ratio * drive.rotor_inertia.evaluate(defaults, 0.0, 0.0);
        }
    }
    result
}

/// Spatial inertia of a link about its frame's origin, rotation first.
fn link_inertia(link: &Link, defaults: &[f64]) -> Matrix {
    let mut sum = [[0.0; 6]; 6];
    for body in &link.bodies {
        let value = |formula: &gelenk_formula::Formula| formula.evaluate(defaults, 0.0, 0.0);
        let m = value(&body.mass);
        let [x, y, z] = [0, 1, 2].map(|k| value(&body.center_of_mass[k]));
        let [xx, xy, xz, yy, yz, zz] = [0, 1, 2, 3, 4, 5].map(|k| value(&body.inertia[k]));
        let (a, b, c) = (m * x, m * y, m * z);
        let body = [
            [xx + b * y + c * z, xy - a * y, xz - a * z, 0.0, -c, b],
            [xy - a * y, yy + a * x + c * z, yz - b * z, c, 0.0, -a],
            [xz - a * z, yz - b * z, zz + a * x + b * y, -b, a, 0.0],
            [0.0, c, -b, m, 0.0, 0.0],
            [-c, 0.0, a, 0.0, m, 0.0],
            [b, -a, 0.0, 0.0, 0.0, m],
        ];
        add(&mut sum, &body);
    }
    sum
}

/// Motion axis of a joint in its own frame, rotation first.
fn motion_axis(joint: &Joint) -> [f64; 6] {
    let [x, y, z] = joint.axis;
    let [turn, slide] = joint.kind.turn_and_slide();
    [x * turn, y * turn, z * turn, x * slide, y * slide, z * slide]
}

/// Transform of spatial motions from the parent link's frame to this link's frame.
///
/// - `position`: position of the joint, if it moves
pub(crate) fn child_from_parent(joint: &Joint, position: f64, defaults: &[f64]) -> Matrix {
    let position = match joint.motion {
        Motion::Fixed => 0.0,
        Motion::Held(position) => position,
        Motion::Coordinate(_) | Motion::Follower(_) => position,
    };
    let [turn, shift] = joint.kind.turn_and_slide().map(|share| share * position);
    let Pose { translation, rotation } = &joint.origin;
    let inner = about_axis(&joint.axis, turn);
    let r: [f64; 3] = std::array::from_fn(|i| {
        let along: f64 = (0..3).map(|k| rotation[i][k] * joint.axis[k]).sum();
        translation[i].evaluate(defaults, 0.0, 0.0) + along * shift
    });
    motion_transform(&super::pose::product(rotation, &inner), &r)
}

/// Transform `[Rᵀ 0; −Rᵀ [r]ₓ  Rᵀ]` of spatial motions to a frame at r with the axes R.
fn motion_transform(rotation: &[[f64; 3]; 3], r: &[f64; 3]) -> Matrix {
    let cross = [[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]];
    let mut x = [[0.0; 6]; 6];
    for i in 0..3 {
        for j in 0..3 {
            x[i][j] = rotation[j][i];
            x[i + 3][j + 3] = rotation[j][i];
            x[i + 3][j] = -(0..3).map(|k| rotation[k][i] * cross[k][j]).sum::<f64>();
        }
    }
    x
}

/// Rotation matrix about a unit axis a: `cos I + sin [a]ₓ + (1 − cos) a aᵀ` (Rodrigues).
fn about_axis(a: &[f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let (s, c) = crate::numeric::sin_cos(angle);
    let cross = [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (if i == j { c } else { 0.0 }) + s * cross[i][j] + (1.0 - c) * a[i] * a[j])
    })
}

/// The sum `R p + r` of a rotated point and a translation.
pub(crate) fn product_and_sum(rotation: &[[f64; 3]; 3], p: &[f64; 3], r: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| rotation[i][k] * p[k]).sum::<f64>() + r[i])
}

fn add(sum: &mut Matrix, other: &Matrix) {
    for (row, from) in sum.iter_mut().zip(other) {
        for (entry, from) in row.iter_mut().zip(from) {
            *entry += from;
        }
    }
}

/// The sum of the magnitudes of all terms of the quadratic form `aᵀ M a`, which bounds its rounding error.
fn magnitude(matrix: &Matrix, a: &[f64; 6]) -> f64 {
    let row = |i: usize| (0..6).map(move |j| (a[i] * matrix[i][j] * a[j]).abs());
    (0..6).flat_map(row).sum()
}

fn quadratic(matrix: &Matrix, a: &[f64; 6]) -> f64 {
    (0..6).map(|i| (0..6).map(|j| a[i] * matrix[i][j] * a[j]).sum::<f64>()).sum()
}

/// Replaces a spatial inertia I by `I − I S Sᵀ I / D` with the joint's axis S and the pivot D.
fn project(matrix: &mut Matrix, axis: &[f64; 6], pivot: f64) {
    let u: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| matrix[i][j] * axis[j]).sum());
    for i in 0..6 {
        for j in 0..6 {
            matrix[i][j] -= u[i] * u[j] / pivot;
        }
    }
}

/// The spatial inertia `Xᵀ I X` after a transformation X of motions.
fn congruent(matrix: &Matrix, x: &Matrix) -> Matrix {
    let right: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| matrix[i][k] * x[k][j]).sum()));
    std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| x[k][i] * right[k][j]).sum()))
}
