//! Energies and momenta of the moving bodies.

use super::case::{Case, Rows, product, transposed};
use super::number::Number;
use super::robot::{Inertia, LinkMotion};
use super::space::{
    Vector, add, constant, cross, dot, scale, subtract, sum, times, transposed as turned_back,
};
use crate::model::RotorCoupling;

/// Kinetic energy `½ (ẏ, ḋ)ᵀ M (ẏ, ḋ)` with the mass matrix M. ẏ are the velocities of the coordinates, and ḋ
/// the prescribed velocities of driven joints.
pub fn kinetic_energy<T: Number>(case: &Case<'_, T>) -> T {
    let zeros = case.robot.zeros();
    let momenta = case.newton_euler([&zeros, &case.v], constant([0.0; 3]));
    T::constant(0.5) * product(&case.v, &momenta)
}

/// Potential energy of the moving bodies in gravity, and of the forces between frames that have a potential.
pub fn potential_energy<T: Number>(case: &Case<'_, T>) -> T {
    let links = case.links();
    let gravity = case.robot.gravity();
    let of_gravity = moving(case, &links).fold(T::zero(), |sum, (link, [m, x, y, z, ..])| {
        sum - dot(gravity, add(scale(link.origin, m), times(&link.rotation, [x, y, z])))
    });
    case.model().point_forces.iter().fold(of_gravity, |sum, force| match force.law.energy() {
        Some(energy) => sum + case.robot.value(&energy, case.distance(&force.between, &links).0, T::zero()),
        None => sum,
    })
}

/// Every body of a link that moves.
fn moving<'a, T: Number>(
    case: &'a Case<'_, T>,
    links: &'a [LinkMotion<T>],
) -> impl Iterator<Item = (&'a LinkMotion<T>, Inertia<T>)> {
    let links = case.model().links.iter().zip(links).filter(|(_, motion)| motion.moves);
    links.flat_map(move |(link, motion)| {
        link.bodies.iter().map(move |body| (motion, case.robot.inertia(body)))
    })
}

/// Mass and centre of mass of the moving bodies.
fn mass_center<T: Number>(case: &Case<'_, T>, links: &[LinkMotion<T>]) -> (T, Vector<T>) {
    let none = (T::zero(), constant([0.0; 3]));
    let (mass, first) = moving(case, links).fold(none, |(mass, first), (link, [m, x, y, z, ..])| {
        (mass + m, sum([first, scale(link.origin, m), times(&link.rotation, [x, y, z])]))
    });
    (mass, first.map(|x| x / mass))
}

/// Whether the moving bodies have mass.
pub fn has_mass<T: Number>(case: &Case<'_, T>) -> bool {
    mass_center(case, &case.links()).0.value() != 0.0
}

pub fn center<T: Number>(case: &Case<'_, T>) -> Vector<T> {
    mass_center(case, &case.links()).1
}

/// Linear momentum of the moving bodies, then angular momentum about their centre of mass, at velocities v.
pub fn momentum<T: Number>(case: &Case<'_, T>, v: &[T]) -> [T; 6] {
    let zeros = case.robot.zeros();
    let links = case.links_in([v, &zeros], constant([0.0; 3]));
    let (_, center) = mass_center(case, &links);
    let (mut linear, mut angular) = (constant([0.0; 3]), constant([0.0; 3]));
    for (link, [m, x, y, z, xx, xy, yy, xz, yz, zz]) in moving(case, &links) {
        let h = times(&link.rotation, [x, y, z]);
        let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let spin = times(&turned_back(&link.rotation), link.spin);
        let p = add(scale(link.velocity, m), cross(link.spin, h));
        let own = add(times(&link.rotation, times(&inertia, spin)), cross(h, link.velocity));
        linear = add(linear, p);
        angular = sum([angular, own, cross(subtract(link.origin, center), p)]);
    }
    let bodies = case.model().drives.iter().filter(|drive| drive.coupling == RotorCoupling::Body);
    for drive in bodies.filter(|drive| links[drive.carrier].moves) {
        let [speed, _] = case.robot.shaft_rates(drive, &links, [v, &zeros]);
        let axis = times(&links[drive.carrier].rotation, constant(drive.axis));
        angular = add(angular, scale(axis, speed * case.robot.number(&drive.rotor_inertia)));
    }
    [linear[0], linear[1], linear[2], angular[0], angular[1], angular[2]]
}

/// Momentum matrix of the moving bodies. Rows are entries of the momentum, columns are velocities including
/// the prescribed ones.
pub fn matrix<T: Number>(case: &Case<'_, T>) -> Rows<T> {
    let zeros = case.robot.zeros();
    let column = |j: usize| {
        let mut unit = zeros.clone();
        unit[j] = T::constant(1.0);
        momentum(case, &unit).to_vec()
    };
    transposed(&(0..zeros.len()).map(column).collect::<Rows<T>>(), 6)
}

pub fn center_jacobian<T: Number>(case: &Case<'_, T>) -> Rows<T> {
    let (mass, _) = mass_center(case, &case.links());
    let rows = matrix(case).into_iter().take(3);
    rows.map(|row| row.into_iter().map(|x| x / mass).collect()).collect()
}
