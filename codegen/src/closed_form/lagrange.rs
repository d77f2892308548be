//! Equations of motion from the kinetic energy T and the potential energy V (Lagrange's equations of the
//! second kind).
//!
//! `L = T − V,  T = Σ ½ m ṗᵀṗ + ½ ωᵀ I ω + ½ J_R (aᵀω_c + i ẏ)²,  V = −Σ m g₀ᵀp`
//! `d/dt ∂L/∂ẏ − ∂L/∂y = q − q_gravity + B u`
//! (Goldstein, Poole and Safko, Classical Mechanics, 2002, sections 1.4 and 1.6)
//!
//! m, I and p are the mass, inertia and centre of mass of a body. ω is its angular velocity, and g₀ is the
//! gravitational acceleration. A rotor has the axial inertia J_R, the gear ratio i and the axis a; the
//! angular velocity of its carrier is ω_c. Velocities are derivatives of positions: `ṗ = Σ ∂p/∂yⱼ ẏⱼ`,
//! `[ω]ₓ = RᵀṘ` with the rotation R of the body. No code is shared with the recursive derivation in
//! `dynamics/`.

use symbolica::atom::{Atom, AtomCore};

use super::algebra::{self, Kind, Matrix, Variables, Vector};
use super::bodies::{Bodies, ENTRY, MovingBody, Rotor};
use super::letters::Letters;
use crate::model::{Model, RotorCoupling};

/// Results of Lagrange's equations. Sines and cosines are written as phases.
pub(super) struct Lagrange {
    /// Mass matrix `M = ∂²L/∂ẏ²` from the Lagrangian L.
    pub mass_matrix: Vec<Vec<Atom>>,
    /// Bias forces `k − q_gravity = Σⱼ ∂²L/∂ẏ∂yⱼ ẏⱼ − ∂L/∂y` from the Lagrangian L: Coriolis forces k minus
    /// gravity.
    pub bias_forces: Vec<Atom>,
}

/// Pose of a body's frame in the base frame, with expressions as entries.
struct Placed {
    rotation: Matrix,
    origin: Vector,
}

/// Derives the mass matrix and the bias forces (Coriolis forces minus gravity) of a model.
pub(super) fn derive(
    variables: Variables<'_>,
    model: &Model,
    bodies: &Bodies,
    letters: &mut Letters<'_>,
) -> Lagrange {
    let n = model.coordinates.len();
    let mut derivation = Derivation { variables, bodies, letters, is_prismatic: vec![false; n] };
    for body in &bodies.bodies {
        derivation.is_prismatic[body.coordinate] = body.is_prismatic;
    }
    let lagrangian = derivation.lagrangian(model);
    let momenta: Vec<Atom> = (0..n).map(|i| variables.by_velocity(&lagrangian, i)).collect();
    let row = |momentum: &Atom| (0..n).map(|j| variables.by_velocity(momentum, j)).collect();
    let bias = |(i, momentum): (usize, &Atom)| {
        (derivation.rate(momentum) - derivation.by_coordinate(&lagrangian, i)).expand()
    };
    Lagrange {
        mass_matrix: momenta.iter().map(row).collect(),
        bias_forces: momenta.iter().enumerate().map(bias).collect(),
    }
}

struct Derivation<'a, 'i, 'm> {
    variables: Variables<'i>,
    bodies: &'a Bodies,
    letters: &'a mut Letters<'m>,
    is_prismatic: Vec<bool>,
}

impl Derivation<'_, '_, '_> {
    /// Computes the Lagrangian `L = T − V`.
    fn lagrangian(&mut self, model: &Model) -> Atom {
        let gravity = self.letters.gravity(&model.gravity);
        let mut placed: Vec<Placed> = Vec::new();
        let mut spins: Vec<Vector> = Vec::new();
        let mut sum = algebra::zero();
        for body in &self.bodies.bodies {
            let frame = self.place(body, body.parent.and_then(|parent| placed.get(parent)));
            let spin = self.spin(&frame.rotation);
            sum += self.of_body(body, &frame, &spin, &gravity);
            placed.push(frame);
            spins.push(spin);
        }
        for rotor in &self.bodies.rotors {
            sum += self.of_rotor(rotor, model, &spins);
        }
        sum.expand()
    }

    /// Pose of a body in the base frame.
    fn place(&mut self, body: &MovingBody, parent: Option<&Placed>) -> Placed {
        let base = Placed { rotation: algebra::identity(), origin: std::array::from_fn(|_| algebra::zero()) };
        let parent = parent.unwrap_or(&base);
        let (turn, offset) = self.letters.origin(body);
        let before = algebra::product(&parent.rotation, &turn);
        let origin = algebra::sum(&parent.origin, &algebra::rotate(&parent.rotation, &offset));
        let align = self.letters.align_axis(body);
        let aligned = algebra::product(&before, &align);
        if body.is_prismatic {
            let position = self.variables.atom(Kind::Coordinate, body.coordinate);
            let slide = std::array::from_fn(|k| &aligned[k][2] * &position);
            return Placed { rotation: before, origin: algebra::sum(&origin, &slide) };
        }
        let (sine, cosine) = (self.variables.sine(body.coordinate), self.variables.cosine(body.coordinate));
        let turned = algebra::product(&aligned, &algebra::rotation(2, &sine, &cosine));
        Placed { rotation: algebra::product(&turned, &algebra::transpose(&align)), origin }
    }

    /// Angular velocity ω in the body's frame, from `[ω]ₓ = RᵀṘ` with the body's rotation R.
    fn spin(&self, rotation: &Matrix) -> Vector {
        let rate = rotation.each_ref().map(|row| row.each_ref().map(|entry| self.rate(entry)));
        let (columns, rates) = (algebra::transpose(rotation), algebra::transpose(&rate));
        let entry = |i: usize, j: usize| algebra::dot(&columns[i], &rates[j]);
        [entry(2, 1), entry(0, 2), entry(1, 0)]
    }

    /// A body's part `½ m ṗᵀṗ + ½ ωᵀ I ω + m g₀ᵀp` of the Lagrangian, summed over its masses. Each mass m has
    /// the centre p and the inertia I. ω is the body's angular velocity, and g₀ the gravitational
    /// acceleration.
    fn of_body(&mut self, body: &MovingBody, frame: &Placed, spin: &Vector, gravity: &Vector) -> Atom {
        let mut sum = algebra::zero();
        for mass in &body.masses {
            let (m, center, inertia) = self.letters.mass(body.coordinate, mass);
            let place = algebra::sum(&frame.origin, &algebra::rotate(&frame.rotation, &center));
            let velocity = place.each_ref().map(|entry| self.rate(entry));
            let inertia: Matrix =
                std::array::from_fn(|i| std::array::from_fn(|j| inertia[ENTRY[i][j]].clone()));
            let translation = &m * algebra::dot(&velocity, &velocity);
            let rotation = algebra::dot(spin, &algebra::rotate(&inertia, spin));
            let potential = &m * algebra::dot(gravity, &place);
            sum += half(translation + rotation) + potential;
        }
        sum.expand()
    }

    /// Part `½ J_R (aᵀω_c + i ẏ)²` of the Lagrangian for one rotor with axial inertia J_R, axis a and gear
    /// ratio i. ω_c is the angular velocity of its carrier.
    fn of_rotor(&mut self, rotor: &Rotor, model: &Model, spins: &[Vector]) -> Atom {
        let (inertia, ratio) = self.letters.rotor(rotor.drive);
        let mut speed = algebra::zero();
        if let Some((body, axis)) = rotor.carrier {
            let axis = self.letters.rotor_axis(rotor.drive, axis);
            speed = algebra::dot(&axis, &spins[body]);
        }
        if let Some(coordinate) = rotor.coordinate {
            speed += ratio * self.variables.atom(Kind::Velocity, coordinate);
        }
        debug_assert!(rotor.carrier.is_none() || model.drives[rotor.drive].coupling == RotorCoupling::Body);
        half(inertia * &speed * &speed).expand()
    }

    /// Time derivative `Σ ∂f/∂yⱼ ẏⱼ` of an expression in the coordinates.
    fn rate(&self, f: &Atom) -> Atom {
        let part = |j: usize| self.by_coordinate(f, j) * self.variables.atom(Kind::Velocity, j);
        let sum = (0..self.is_prismatic.len()).fold(algebra::zero(), |sum, j| sum + part(j));
        sum.expand()
    }

    fn by_coordinate(&self, f: &Atom, index: usize) -> Atom {
        match self.is_prismatic[index] {
            true => self.variables.by_position(f, index),
            false => self.variables.by_angle(f, index),
        }
    }
}

fn half(a: Atom) -> Atom {
    a * Atom::num((1, 2))
}
