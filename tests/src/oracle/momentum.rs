//! Momentum of the bodies, and the wrenches through joints by its rates: the laws of Newton and Euler in the base frame.

use gelenk_codegen::model::RotorCoupling;
use num_dual::Dual64;

use super::Oracle;
use super::vectors::{Vector, add, constant, cross, scale, stacked, subtract, symmetric, times, transposed};
use crate::dual::Number;
use crate::positions::rates;

/// Mass, moment of mass and momentum of the bodies and rotors on a link, about the origin of the base.
#[derive(Debug, Clone, Copy)]
struct Moments<T> {
    mass: f64,
    first: Vector<T>,
    linear: Vector<T>,
    angular: Vector<T>,
}

impl<T: Number> Moments<T> {
    fn zero() -> Self {
        let zero = constant([0.0; 3]);
        Self { mass: 0.0, first: zero, linear: zero, angular: zero }
    }

    fn plus(self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: add(&self.first, &other.first),
            linear: add(&self.linear, &other.linear),
            angular: add(&self.angular, &other.angular),
        }
    }
}

impl Oracle<'_> {
    /// Momentum by links.
    fn moments<T: Number>(&self, y: &[T], v: &[T]) -> Vec<Moments<T>> {
        let states = self.links(y, v);
        let mut all = vec![Moments::zero(); states.len()];
        for ((link, state), moments) in self.model.links.iter().zip(&states).zip(&mut all) {
            for body in &link.bodies {
                let arm = times(&state.rotation, &constant(self.vector(&body.center_of_mass)));
                let (center, mass) = (add(&state.origin, &arm), self.number(&body.mass));
                let linear = add(&state.velocity, &cross(&state.spin, &arm)).map(|v| v * mass);
                let inertia = symmetric(body.inertia.each_ref().map(|entry| self.number(entry)));
                let own = times(&inertia, &times(&transposed(&state.rotation), &state.spin));
                let angular = add(&cross(&center, &linear), &times(&state.rotation, &own));
                *moments = moments.plus(&Moments { mass, first: center.map(|c| c * mass), linear, angular });
            }
        }
        for drive in self.model.drives.iter().filter(|drive| drive.coupling == RotorCoupling::Body) {
            let carrier = &states[drive.carrier];
            let spin = self.rotor_spin(drive, carrier, v) * self.number(&drive.rotor_inertia);
            let axis = times(&carrier.rotation, &constant(drive.axis));
            let moments = &mut all[drive.carrier];
            moments.angular = add(&moments.angular, &scale(&axis, spin));
        }
        all
    }

    /// All that moves.
    fn moving<T: Number>(&self, y: &[T], v: &[T]) -> Moments<T> {
        let states = self.links(y, v);
        let moments = self.moments(y, v);
        let moving = moments.iter().zip(&states).filter(|(_, state)| state.moves);
        moving.fold(Moments::zero(), |sum, (moments, _)| sum.plus(moments))
    }

    /// Centre of mass of the moving bodies.
    pub fn center_of_mass<T: Number>(&self, y: &[T]) -> Vector<T> {
        let still = vec![T::from(0.0); self.model.motion_count()];
        let all = self.moving(y, &still);
        all.first.map(|first| first / all.mass)
    }

    /// Momentum of the moving bodies, and their angular momentum about the centre of mass.
    pub fn centroidal_momentum(&self, y: &[f64], v: &[f64]) -> [f64; 6] {
        let all = self.moving(y, v);
        let center = self.center_of_mass(y);
        stacked(all.linear, subtract(&all.angular, &cross(&center, &all.linear)))
    }

    /// Force and moment through each joint that carries a link, in the axes of that link and about its origin.
    pub fn joint_wrenches(&self, [y, v, a]: [&[f64]; 3]) -> Vec<f64> {
        let dual = |x: &[f64], rates: &[f64]| -> Vec<Dual64> {
            x.iter().zip(rates).map(|(&x, &rate)| Dual64::new(x, rate)).collect()
        };
        let (y, v) = (dual(y, &rates(self.model, y, v)), dual(v, a));
        let states = self.links(&y, &v);
        let mut beyond = self.moments(&y, &v);
        for (link, joint) in
            self.model.links.iter().enumerate().rev().filter_map(|(k, l)| Some((k, l.joint.as_ref()?)))
        {
            beyond[joint.parent] = beyond[joint.parent].plus(&beyond[link]);
        }
        let gravity = self.vector(&self.model.gravity);
        let wrench = |link: usize| {
            let (state, moments) = (&states[link], &beyond[link]);
            let real = |x: Vector<Dual64>| x.map(|x| x.re);
            let force = subtract(&moments.linear.map(|p| p.eps), &gravity.map(|g| g * moments.mass));
            let moment = subtract(&moments.angular.map(|l| l.eps), &cross(&real(moments.first), &gravity));
            let moment = subtract(&moment, &cross(&real(state.origin), &force));
            let to_link = transposed(&state.rotation.map(real));
            stacked(times(&to_link, &force), times(&to_link, &moment))
        };
        self.model.carrying_joints().iter().flat_map(|joint| wrench(joint.moving.link)).collect()
    }
}
