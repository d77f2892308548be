//! Energies, and the forces that follow from them and from virtual work.

use gelenk_codegen::model::{
    Actuator, Attachment, Drive, ForceEffect, FrictionTerm, Input, Joint, Motion, RotorCoupling, WrenchAxes,
};
use num_dual::{Dual, DualNum, HyperDual, HyperDual64};

use super::vectors::{add, constant, cross, dot, stacked, subtract, symmetric, times, transposed, unit};
use super::{LinkState, Oracle, value};
use crate::dual::Number;
use crate::positions::{bracket, rates};

impl Oracle<'_> {
    /// `T = Σ ½ m vᵀv + ½ ωᵀ I ω`, and for each rotor `½ J_R (a·ω_carrier + i ẏ)²`.
    pub fn kinetic_energy<T: Number>(&self, y: &[T], v: &[T]) -> T {
        let states = self.links(y, v);
        let mut energy = T::from(0.0);
        for (link, state) in self.model.links.iter().zip(&states) {
            for body in &link.bodies {
                let center = times(&state.rotation, &constant(self.vector(&body.center_of_mass)));
                let velocity = add(&state.velocity, &cross(&state.spin, &center));
                let spin = times(&transposed(&state.rotation), &state.spin);
                let inertia = body.inertia.each_ref().map(|entry| self.number(entry));
                energy += dot(&velocity, &velocity) * (0.5 * self.number(&body.mass));
                energy += dot(&spin, &times(&symmetric(inertia), &spin)) * 0.5;
            }
        }
        for drive in &self.model.drives {
            let spin = self.rotor_spin(drive, &states[drive.carrier], v);
            energy += spin * spin * (0.5 * self.number(&drive.rotor_inertia));
        }
        energy
    }

    pub(super) fn rotor_spin<T: Number>(&self, drive: &Drive, carrier: &LinkState<T>, v: &[T]) -> T {
        let own = self.sum(&drive.acts_on, v) * self.number(&drive.gear_ratio);
        let axis = times(&carrier.rotation, &constant(drive.axis));
        match drive.coupling {
            RotorCoupling::Body => dot(&axis, &carrier.spin) + own,
            RotorCoupling::Diagonal => own,
        }
    }

    /// `V = −Σ m g·c` over the bodies that move.
    pub fn potential_energy<T: Number>(&self, y: &[T]) -> T {
        let still = vec![T::from(0.0); self.model.motion_count()];
        let gravity = constant(self.vector(&self.model.gravity));
        let mut energy = T::from(0.0);
        for (link, state) in self.model.links.iter().zip(self.links(y, &still)) {
            for body in link.bodies.iter().filter(|_| state.moves) {
                let center = times(&state.rotation, &constant(self.vector(&body.center_of_mass)));
                let height = dot(&gravity, &add(&state.origin, &center));
                energy -= height * self.number(&body.mass);
            }
        }
        energy
    }

    /// `M v̇ + k`, by [`Self::inertial_work`].
    pub fn inertial_forces<T: Number>(&self, y: &[T], v: &[T], a: &[T]) -> Vec<T> {
        (0..v.len()).map(|j| self.inertial_work([y, v, a], &self.unit(j))).collect()
    }

    /// The work of M v̇ + k on a small motion d: `(d/dt ∂T/∂v) d − ∂T/∂v [v, d] − ∂T(y ⊕ d)/∂d`, the equations of Poincaré
    /// (1901). Without quaternions they are those of Lagrange.
    pub fn inertial_work<T: Number>(&self, [y, v, a]: [&[T]; 3], d: &[f64]) -> T {
        let (model, zero) = (self.model, T::from(0.0));
        let d: Vec<T> = d.iter().map(|&d| T::from(d)).collect();
        let path = y.iter().zip(rates(model, y, v)).map(|(&y, rate)| HyperDual::new(y, rate, zero, zero));
        let path: Vec<_> = path.collect();
        let speeds = (0..v.len()).map(|k| HyperDual::new(v[k], a[k], d[k], zero));
        let momentum_rate = self.kinetic_energy(&path, &speeds.collect::<Vec<_>>()).eps1eps2;
        let aside: Vec<_> = y.iter().zip(rates(model, y, &d)).map(|(&y, rate)| Dual::new(y, rate)).collect();
        let turned = v.iter().zip(bracket(model, v, &d)).map(|(&v, turned)| Dual::new(v, turned));
        momentum_rate - self.kinetic_energy(&aside, &turned.collect::<Vec<_>>()).eps
    }

    /// `−∂V/∂y`
    pub fn gravity_forces<T: Number>(&self, y: &[T]) -> Vec<T> {
        (0..self.model.motion_count()).map(|j| self.gravity_work(y, &self.unit(j))).collect()
    }

    fn gravity_work<T: Number>(&self, y: &[T], d: &[f64]) -> T {
        -self.potential_energy(&self.along(y, d)).eps
    }

    /// `∂²T/∂v∂v`, rows first.
    pub fn mass_matrix(&self, y: &[f64]) -> Vec<f64> {
        let position: Vec<_> = y.iter().map(|&y| HyperDual64::from(y)).collect();
        let n = self.model.motion_count();
        let entry = |i: usize, j: usize| {
            let v: Vec<_> = (0..n).map(|k| HyperDual64::new(0.0, unit(k, i), unit(k, j), 0.0)).collect();
            self.kinetic_energy(&position, &v).eps1eps2
        };
        (0..n * n).map(|at| entry(at / n, at % n)).collect()
    }

    /// `M v̇ + k − q`
    pub fn inverse_dynamics<T: Number>(&self, y: &[T], v: &[T], a: &[T]) -> Vec<T> {
        let (springs, friction) = (self.spring_forces(y, v), self.friction_torques(y, v));
        let (inertial, gravity) = (self.inertial_forces(y, v, a), self.gravity_forces(y));
        (0..v.len()).map(|k| inertial[k] - gravity[k] - springs[k] + friction[k]).collect()
    }

    /// The work of M v̇ + k − q on a small motion.
    pub fn work<T: Number>(&self, [y, v, a]: [&[T]; 3], d: &[f64]) -> T {
        let (springs, friction) = (self.spring_forces(y, v), self.friction_torques(y, v));
        let braking = d.iter().enumerate().map(|(k, &d)| (friction[k] - springs[k]) * d);
        let inertial = self.inertial_work([y, v, a], d) - self.gravity_work(y, d);
        braking.fold(inertial, |sum, work| sum + work)
    }

    /// Forces of springs and dampers: of joints, and between frames.
    pub fn spring_forces<T: Number>(&self, y: &[T], v: &[T]) -> Vec<T> {
        let mut forces = self.joint_forces(y, v, |joint, y, v| {
            let laws = joint.springs.iter().map(|law| value(law, self.parameters, y, v));
            laws.fold(T::from(0.0), |sum, force| sum + force)
        });
        for (force, of_law) in forces.iter_mut().zip(self.law_forces(y, v)) {
            *force += of_law;
        }
        forces
    }

    /// Forces of the laws between frames, where nothing moves.
    pub fn law_forces_at_rest(&self, y: &[f64]) -> Vec<f64> {
        self.law_forces(y, &vec![0.0; self.model.motion_count()])
    }

    fn law_forces<T: Number>(&self, y: &[T], v: &[T]) -> Vec<T> {
        let mut forces = vec![T::from(0.0); v.len()];
        for force in &self.model.point_forces {
            let (length, slope) = self.distance(&force.between, y);
            let rate = slope.iter().zip(v).fold(T::from(0.0), |sum, (&slope, &v)| sum + slope * v);
            let pull = value(&force.law, self.parameters, length, rate);
            for (force, &slope) in forces.iter_mut().zip(&slope) {
                *force -= pull * slope;
            }
        }
        forces
    }

    /// Distance of two frames' origins, and its derivatives by y.
    fn distance<T: Number>(&self, between: &[Attachment; 2], y: &[T]) -> (T, Vec<T>) {
        let by = |j: usize| {
            let [a, b] = between
                .each_ref()
                .map(|at| self.attached(at.link, &at.pose, &self.along(y, &self.unit(j))).0);
            let across = subtract(&b, &a);
            dot(&across, &across).sqrt()
        };
        let distances: Vec<Dual<T>> = (0..self.model.motion_count()).map(by).collect();
        (distances[0].re, distances.iter().map(|distance| distance.eps).collect())
    }

    /// B by columns: what the power of a unit of each input is for a unit of each velocity.
    pub fn input_columns<T: Number>(&self, y: &[T]) -> Vec<Vec<T>> {
        let column = |input: Actuator<'_>| match input {
            Actuator::Drive(drive) => {
                let constant = match &drive.input {
                    Input::Torque | Input::None => 1.0,
                    Input::Current(constant) => self.number(constant),
                };
                let mut column = vec![T::from(0.0); self.model.motion_count()];
                for term in &drive.acts_on {
                    column[term.coordinate] +=
                        self.number(&drive.gear_ratio) * self.number(&term.ratio) * constant;
                }
                column
            }
            Actuator::Force(force) => match &force.effect {
                ForceEffect::Pull(between) => {
                    self.distance(between, y).1.iter().map(|&slope| -slope).collect()
                }
                ForceEffect::Wrench { at, wrench } => {
                    let wrench = wrench.each_ref().map(|entry| self.number(entry));
                    self.wrench_forces_at(at, WrenchAxes::Frame, &wrench, y)
                }
            },
        };
        self.model.inputs().map(column).collect()
    }

    /// Forces of the wrenches, six entries each.
    pub fn wrench_forces<T: Number>(&self, y: &[T], w: &[f64]) -> Vec<T> {
        let mut forces = vec![T::from(0.0); self.model.motion_count()];
        for (described, w) in self.model.wrenches.iter().zip(w.chunks(6)) {
            let w: [f64; 6] = w.try_into().expect("six entries");
            let own = self.wrench_forces_at(&described.at, described.axes, &w, y);
            forces.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        forces
    }

    fn wrench_forces_at<T: Number>(
        &self,
        at: &Attachment,
        axes: WrenchAxes,
        w: &[f64; 6],
        y: &[T],
    ) -> Vec<T> {
        let (_, rotation) = self.attached(at.link, &at.pose, y);
        let in_base = |part: [f64; 3]| match axes {
            WrenchAxes::Frame => times(&rotation, &constant(part)),
            WrenchAxes::Base => constant(part),
        };
        let (force, moment) = (in_base([w[0], w[1], w[2]]), in_base([w[3], w[4], w[5]]));
        let wrench = stacked(force, moment);
        let work = |j: usize| {
            let column = self.column_of(at.link, &at.pose, y, j);
            column.iter().zip(&wrench).fold(T::from(0.0), |sum, (&column, &wrench)| sum + column * wrench)
        };
        (0..self.model.motion_count()).map(work).collect()
    }

    /// `τ = Σ coefficient · basis`
    pub fn friction_torques<T: Number>(&self, y: &[T], v: &[T]) -> Vec<T> {
        let sum = |terms: &[FrictionTerm], y: T, v: T| -> T {
            let torque = |term: &FrictionTerm| {
                value(&term.basis, self.parameters, y, v) * self.number(&term.coefficient)
            };
            terms.iter().map(torque).fold(T::from(0.0), |sum, torque| sum + torque)
        };
        let mut torques = self.joint_forces(y, v, |joint, y, v| sum(&joint.friction, y, v));
        let places = self.by_coordinate(y);
        for drive in &self.model.drives {
            let ratio = self.number(&drive.gear_ratio);
            let at_shaft = |x: &[T]| self.sum(&drive.acts_on, x) * ratio;
            let torque = sum(&drive.friction, at_shaft(&places), at_shaft(v));
            for term in &drive.acts_on {
                torques[term.coordinate] += torque * (ratio * self.number(&term.ratio));
            }
        }
        torques
    }

    /// Forces along joints, at their positions and speeds, as forces on the coordinates: by virtual work.
    fn joint_forces<T: Number>(&self, y: &[T], v: &[T], force: impl Fn(&Joint, T, T) -> T) -> Vec<T> {
        let mut forces = vec![T::from(0.0); v.len()];
        let y = self.by_coordinate(y);
        for joint in self.model.links.iter().filter_map(|link| link.joint.as_ref()) {
            match joint.motion {
                Motion::Fixed | Motion::Held(_) => {}
                Motion::Coordinate(index) => forces[index] += force(joint, y[index], v[index]),
                Motion::Follower(index) => {
                    let follower = &self.model.followers[index - v.len()];
                    let position = self.sum(&follower.follows, &y) + follower.offset;
                    let force = force(joint, position, self.sum(&follower.follows, v));
                    for term in &follower.follows {
                        forces[term.coordinate] += force * self.number(&term.ratio);
                    }
                }
            }
        }
        forces
    }
}
