//! Pivots of the mass matrix for robots whose joints follow coordinates. The matrix is `Gᵀ M_joints G` with
//! the ratios G of joints to coordinates. M_joints is computed by composite bodies (Walker and Orin 1982;
//! Featherstone 2008, ch. 6). The factorization goes from the last coordinate to the first.

use super::{
    Matrix, Model, Motion, Pivot, ROUNDING, add, child_from_parent, congruent, link_inertia, magnitude,
    motion_axis,
};

/// The mass matrix, and for each coordinate the sum of the magnitudes of all terms in its diagonal entry.
/// This sum is a bound for the rounding error.
pub(super) fn mass_matrix(model: &Model, described: &[f64], positions: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let all = model.motion_count();
    let (mut mass, mut sizes) = (vec![vec![0.0; all]; all], vec![0.0; all]);
    add_bodies(model, described, positions, &mut mass, &mut sizes);
    add_rotors(model, described, &mut mass, &mut sizes);
    (mass, sizes)
}

/// Signs of the mass matrix's pivots by link; `None` for links without an independent joint.
pub(super) fn pivots(model: &Model, described: &[f64], positions: &[f64]) -> Vec<Option<Pivot>> {
    let n = model.coordinates.len();
    let (mut mass, sizes) = mass_matrix(model, described, positions);
    let mut pivots = vec![None; model.links.len()];
    for k in (0..n).rev() {
        let (pivot, rounding) = (mass[k][k], ROUNDING * sizes[k]);
        let found = match pivot {
            pivot if pivot > rounding => Pivot::Positive,
            pivot if pivot < -rounding => Pivot::Negative,
            _ => Pivot::Zero,
        };
        if found != Pivot::Zero {
            eliminate(&mut mass, k);
        }
        pivots[model.coordinates[k]] = Some(found);
    }
    pivots
}

fn eliminate(mass: &mut [Vec<f64>], k: usize) {
    let row = mass[k].clone();
    for i in 0..k {
        for j in 0..k {
            mass[i][j] -= row[i] * row[j] / row[k];
        }
    }
}

/// Ratios of each link's joint to the coordinates, each with the index of the coordinate. Empty if the joint
/// does not move.
fn rows(model: &Model, described: &[f64]) -> Vec<Vec<(usize, f64)>> {
    let mut rows = vec![Vec::new(); model.links.len()];
    for moving in model.moving_joints() {
        let terms = moving.follows.iter();
        rows[moving.link] =
            terms.map(|term| (term.coordinate, term.ratio.evaluate(described, 0.0, 0.0))).collect();
    }
    rows
}

fn add_bodies(model: &Model, described: &[f64], positions: &[f64], mass: &mut [Vec<f64>], sizes: &mut [f64]) {
    let rows = rows(model, described);
    let mut composite: Vec<Matrix> = model.links.iter().map(|link| link_inertia(link, described)).collect();
    for (index, link) in model.links.iter().enumerate().rev() {
        let Some(joint) = &link.joint else { continue };
        if matches!(joint.motion, Motion::Coordinate(_) | Motion::Follower(_)) {
            let axis = motion_axis(joint);
            let size = magnitude(&composite[index], &axis);
            for &(coordinate, ratio) in &rows[index] {
                sizes[coordinate] += ratio * ratio * size;
            }
            add_column(model, described, positions, &rows, index, &composite[index], mass);
        }
        let transform = child_from_parent(joint, positions[index], described);
        let carried = congruent(&composite[index], &transform);
        add(&mut composite[joint.parent], &carried);
    }
}

/// Adds one column to the mass matrix: the forces for a unit acceleration of one joint, at the joint itself
/// and at all joints between it and the base.
fn add_column(
    model: &Model,
    described: &[f64],
    positions: &[f64],
    rows: &[Vec<(usize, f64)>],
    start: usize,
    composite: &Matrix,
    mass: &mut [Vec<f64>],
) {
    let Some(joint) = &model.links[start].joint else { return };
    let axis = motion_axis(joint);
    let mut force: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| composite[i][j] * axis[j]).sum());
    let mut index = start;
    while let Some(joint) = &model.links[index].joint {
        let axis = motion_axis(joint);
        let entry: f64 = (0..6).map(|i| axis[i] * force[i]).sum();
        for &(row, by_row) in &rows[index] {
            for &(column, by_column) in &rows[start] {
                mass[row][column] += by_row * entry * by_column;
                if index != start {
                    mass[column][row] += by_row * entry * by_column;
                }
            }
        }
        let transform = child_from_parent(joint, positions[index], described);
        force = std::array::from_fn(|i| (0..6).map(|k| transform[k][i] * force[k]).sum());
        index = joint.parent;
    }
}

/// Adds the inertia `i² J_R` of each drive to the entries of the mass matrix for all coordinates that the
/// drive acts on. i is the gear ratio, J_R the rotor inertia.
fn add_rotors(model: &Model, described: &[f64], mass: &mut [Vec<f64>], sizes: &mut [f64]) {
    let value = |formula: &gelenk_formula::Formula| formula.evaluate(described, 0.0, 0.0);
    for drive in &model.drives {
        let ratio = value(&drive.gear_ratio);
        let inertia = ratio * ratio * value(&drive.rotor_inertia);
        for row in &drive.acts_on {
            for column in &drive.acts_on {
                mass[row.coordinate][column.coordinate] += value(&row.ratio) * value(&column.ratio) * inertia;
            }
            sizes[row.coordinate] += value(&row.ratio) * value(&row.ratio) * inertia;
        }
    }
}
