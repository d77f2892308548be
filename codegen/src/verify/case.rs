//! The equations of motion at one state, evaluated independently of the generator.

use super::number::{Dual, Number};
use super::robot::{LinkMotion, Positions, Robot, Wrench, add_wrenches};
use super::space::{Vector, add, constant, cross, dot, scale, subtract, times};
use crate::model::{
    Actuator, Attachment, FollowedCoordinate, ForceEffect, FrictionTerm, Input, Model, WrenchAxes,
};

/// A robot with the arguments of a function. In positions, velocities and accelerations, driven coordinates
/// (with a prescribed motion) are last.
#[derive(Clone)]
pub struct Case<'m, T> {
    /// The robot with the values of its parameters.
    pub robot: Robot<'m, T>,
    /// Positions y of the coordinates and of joints with quaternions.
    pub at: Positions<T>,
    /// Velocities ẏ of all coordinates.
    pub v: Vec<T>,
    /// Accelerations ÿ of all coordinates.
    pub a: Vec<T>,
    /// Inputs u of the robot.
    pub u: Vec<T>,
    /// Wrenches that act at frames, each a force and a moment.
    pub w: Vec<T>,
    /// Multipliers λ of the Hessian of the inverse dynamics.
    pub lambda: Vec<T>,
}

/// Variable with respect to which a function is differentiated.
#[derive(Clone, Copy)]
pub enum By {
    /// Positions, differentiated along small motions δ in y ⊕ δ.
    Positions,
    /// Velocities of all coordinates.
    Velocities,
    /// Accelerations of all coordinates.
    Accelerations,
}

/// A matrix as a list of rows.
pub type Rows<T> = Vec<Vec<T>>;

impl<'m, T: Number> Case<'m, T> {
    pub fn model(&self) -> &'m Model {
        self.robot.model
    }

    /// Number of coordinates without the coordinates whose motion is prescribed.
    pub fn n(&self) -> usize {
        self.model().coordinates.len()
    }

    fn own(&self, mut forces: Vec<T>) -> Vec<T> {
        forces.truncate(self.n());
        forces
    }

    /// Prescribed accelerations of the driven joints, and zero for all other coordinates.
    pub fn unaccelerated(&self) -> Vec<T> {
        let n = self.n();
        self.a.iter().enumerate().map(|(k, &a)| if k < n { T::zero() } else { a }).collect()
    }

    pub fn links(&self) -> Vec<LinkMotion<T>> {
        self.links_in([&self.v, &self.a], constant([0.0; 3]))
    }

    pub fn links_in(&self, rates: [&[T]; 2], gravity: Vector<T>) -> Vec<LinkMotion<T>> {
        self.robot.motions(&self.at, rates, gravity)
    }

    /// `M a + k(v) − q_gravity` for the given gravity, by recursive Newton–Euler equations: inertial and
    /// Coriolis forces minus gravity. Rows of coordinates with prescribed motion are included.
    pub fn newton_euler(&self, rates: [&[T]; 2], gravity: Vector<T>) -> Vec<T> {
        let links = self.links_in(rates, gravity);
        let (wrenches, of_rotors) = self.robot.inertial_wrenches(&links, rates);
        let (forces, _) = self.robot.projected(&links, wrenches);
        forces.into_iter().zip(of_rotors).map(|(force, rotor)| force + rotor).collect()
    }

    fn weightless(&self) -> Vector<T> {
        constant([0.0; 3])
    }

    /// Mass matrix of the first `n` coordinates. Driven coordinates are last.
    pub fn mass_matrix(&self, n: usize) -> Rows<T> {
        let zeros = self.robot.zeros();
        let columns = (0..n).map(|j| {
            let mut unit = zeros.clone();
            unit[j] = T::constant(1.0);
            self.newton_euler([&zeros, &unit], self.weightless())
        });
        transposed(&columns.collect::<Rows<T>>(), n)
    }

    pub fn mass_times_multipliers(&self) -> Vec<T> {
        let zeros = self.robot.zeros();
        let mut lambda = self.lambda.clone();
        lambda.resize(zeros.len(), T::zero());
        self.own(self.newton_euler([&zeros, &lambda], self.weightless()))
    }

    pub fn coriolis_forces(&self) -> Vec<T> {
        self.own(self.newton_euler([&self.v, &self.unaccelerated()], self.weightless()))
    }

    pub fn bias_forces(&self) -> Vec<T> {
        self.own(self.newton_euler([&self.v, &self.unaccelerated()], self.robot.gravity()))
    }

    pub fn gravity_forces(&self) -> Vec<T> {
        let zeros = self.robot.zeros();
        negative(&self.own(self.newton_euler([&zeros, &zeros], self.robot.gravity())))
    }

    /// Generalized forces of springs and dampers, at joints and between frames.
    fn all_spring_forces(&self) -> Vec<T> {
        let mut forces = self.robot.zeros();
        for moving in self.robot.moving.iter() {
            let y = self.robot.followed(&moving.follows, &self.at.scalars) + T::constant(moving.offset);
            let v = self.robot.followed(&moving.follows, &self.v);
            for spring in &moving.joint.springs {
                self.robot.add_force(&moving.follows, self.robot.value(spring, y, v), &mut forces);
            }
        }
        if self.model().point_forces.is_empty() {
            return forces;
        }
        let links = self.links();
        let none = [constant([0.0; 3]); 2];
        let mut wrenches = vec![none; links.len()];
        for force in &self.model().point_forces {
            let (length, rate, direction) = self.distance(&force.between, &links);
            let pull = self.robot.value(&force.law, length, rate);
            self.pull(&force.between, scale(direction, pull), &links, &mut wrenches);
        }
        plus(&forces, &self.robot.projected(&links, wrenches).0)
    }

    pub fn spring_forces(&self) -> Vec<T> {
        self.own(self.all_spring_forces())
    }

    /// Distance of two frames, rate of the distance, and direction from the first frame to the second.
    pub fn distance(&self, between: &[Attachment; 2], links: &[LinkMotion<T>]) -> (T, T, Vector<T>) {
        let [(p, rate_p), (q, rate_q)] = between.each_ref().map(|at| {
            let (arm, _) = self.robot.attached(at, links);
            let link = &links[at.link];
            (add(link.origin, arm), add(link.velocity, cross(link.spin, arm)))
        });
        let across = subtract(q, p);
        let length = dot(across, across).sqrt();
        let direction = across.map(|x| x / length);
        (length, dot(direction, subtract(rate_q, rate_p)), direction)
    }

    /// Adds a force on the first of two frames, and the opposite force on the second.
    fn pull(
        &self,
        between: &[Attachment; 2],
        force: Vector<T>,
        links: &[LinkMotion<T>],
        wrenches: &mut [Wrench<T>],
    ) {
        for (at, force) in between.iter().zip([force, force.map(|x| -x)]) {
            let (arm, _) = self.robot.attached(at, links);
            wrenches[at.link] = add_wrenches(wrenches[at.link], [force, cross(arm, force)]);
        }
    }

    /// Generalized forces of a wrench at a frame, by coordinate. Coordinates with prescribed motion are
    /// included.
    fn wrench_at(&self, at: &Attachment, axes: WrenchAxes, w: &[T], links: &[LinkMotion<T>]) -> Vec<T> {
        let (arm, rotation) = self.robot.attached(at, links);
        let in_base = |part: Vector<T>| match axes {
            WrenchAxes::Frame => times(&rotation, part),
            WrenchAxes::Base => part,
        };
        let (force, moment) = (in_base([w[0], w[1], w[2]]), in_base([w[3], w[4], w[5]]));
        let mut wrenches = vec![[constant([0.0; 3]); 2]; links.len()];
        wrenches[at.link] = [force, add(moment, cross(arm, force))];
        self.robot.projected(links, wrenches).0
    }

    fn all_wrench_forces(&self) -> Vec<T> {
        let links = self.links();
        let wrenches = self.model().wrenches.iter().zip(self.w.chunks(6));
        wrenches.fold(self.robot.zeros(), |sum, (wrench, w)| {
            plus(&sum, &self.wrench_at(&wrench.at, wrench.axes, w, &links))
        })
    }

    pub fn wrench_forces(&self) -> Vec<T> {
        self.own(self.all_wrench_forces())
    }

    /// Input matrix B as a list of rows. Each row belongs to a coordinate.
    pub fn input_matrix(&self) -> Rows<T> {
        transposed(&self.input_columns(), self.n())
    }

    /// Columns of the input matrix B. Each column belongs to an input.
    pub fn input_columns(&self) -> Rows<T> {
        let links = self.links();
        let column = |input: Actuator<'_>| match input {
            Actuator::Drive(drive) => {
                let gain = match &drive.input {
                    Input::Torque | Input::None => T::constant(1.0),
                    Input::Current(constant) => self.robot.number(constant),
                };
                let mut column = self.robot.zeros();
                self.robot.add_force(
                    &drive.acts_on,
                    gain * self.robot.number(&drive.gear_ratio),
                    &mut column,
                );
                column
            }
            Actuator::Force(force) => match &force.effect {
                ForceEffect::Pull(between) => {
                    let mut wrenches = vec![[constant([0.0; 3]); 2]; links.len()];
                    self.pull(between, self.distance(between, &links).2, &links, &mut wrenches);
                    self.robot.projected(&links, wrenches).0
                }
                ForceEffect::Wrench { at, wrench } => {
                    let wrench = wrench.each_ref().map(|entry| self.robot.number(entry));
                    self.wrench_at(at, WrenchAxes::Frame, &wrench, &links)
                }
            },
        };
        self.model().inputs().map(|input| self.own(column(input))).collect()
    }

    fn friction_sum(&self, terms: &[FrictionTerm], y: T, v: T) -> T {
        let torques = terms
            .iter()
            .map(|term| self.robot.number(&term.coefficient) * self.robot.value(&term.basis, y, v));
        torques.fold(T::zero(), |sum, torque| sum + torque)
    }

    fn all_friction_torques(&self) -> Vec<T> {
        let mut torques = self.robot.zeros();
        for rubbing in self.rubbing() {
            let torque = self.friction_sum(rubbing.terms, rubbing.y, rubbing.v);
            self.robot.add_force(rubbing.follows, torque * rubbing.gain, &mut torques);
        }
        torques
    }

    pub fn friction_torques(&self) -> Vec<T> {
        self.own(self.all_friction_torques())
    }

    /// Joints with their friction, then shafts with friction.
    pub fn rubbing(&self) -> impl Iterator<Item = Rubbing<'_, T>> {
        let rubbing = |terms, follows, offset: f64, gain: T| Rubbing {
            terms,
            follows,
            gain,
            y: gain * self.robot.followed(follows, &self.at.scalars) + T::constant(offset),
            v: gain * self.robot.followed(follows, &self.v),
        };
        let joints = self.robot.moving.iter().map(move |moving| {
            rubbing(&moving.joint.friction, &moving.follows, moving.offset, T::constant(1.0))
        });
        let shafts = self.model().rubbing_drives().map(move |drive| {
            rubbing(&drive.friction, &drive.acts_on, 0.0, self.robot.number(&drive.gear_ratio))
        });
        joints.chain(shafts)
    }

    /// Load-dependent friction per unit of load by coordinate; 0 for coordinates with prescribed motion.
    pub fn load_friction(&self) -> Vec<T> {
        let joints = self.model().joints().enumerate();
        let shares =
            joints.map(|(k, joint)| self.friction_sum(&joint.load_friction, self.at.scalars[k], self.v[k]));
        shares.collect()
    }

    /// Forces `M ÿ + k − q` of the drives at the accelerations `a`, with Coriolis forces k and applied forces
    /// q. Coordinates with prescribed motion and load-dependent friction are included.
    pub fn all_inverse_dynamics(&self, a: &[T]) -> Vec<T> {
        let load = self.load(a);
        let with_friction = plus(&load, &self.all_friction_torques());
        let mut forces = with_friction;
        for (k, share) in self.load_friction().into_iter().enumerate() {
            forces[k] = forces[k] + load[k].abs() * share;
        }
        forces
    }

    /// Loads by coordinate: the forces of the drives without friction.
    fn load(&self, a: &[T]) -> Vec<T> {
        minus(&self.newton_euler([&self.v, a], self.robot.gravity()), &self.all_spring_forces())
    }

    pub fn inverse_dynamics(&self) -> Vec<T> {
        self.own(self.all_inverse_dynamics(&self.a))
    }

    /// Generalized forces `B(y) u` of the inputs u.
    pub fn input_forces(&self) -> Vec<T> {
        multiplied(&self.input_matrix(), &self.u)
    }

    pub fn inverse_dynamics_with_wrenches(&self) -> Vec<T> {
        minus(&self.inverse_dynamics(), &self.wrench_forces())
    }

    /// Residual `M ÿ + k − q − B(y) u − Σ Jᵀ w` of the equations of motion, from which derivatives with
    /// respect to y, ẏ and ÿ are computed. If the input matrix B does not depend on y, `B u` is omitted,
    /// because its derivatives are zero.
    pub fn residual(&self) -> Vec<T> {
        let forces = match self.model().inputs_depend_on_position() {
            true => minus(&self.inverse_dynamics(), &self.input_forces()),
            false => self.inverse_dynamics(),
        };
        if self.w.is_empty() { forces } else { minus(&forces, &self.wrench_forces()) }
    }

    /// Accelerations ÿ of the coordinates. `inverse` is the inverse of the mass matrix.
    pub fn forward_dynamics(&self, inverse: &Rows<T>) -> Vec<T> {
        let exerted = minus(&self.input_forces(), &self.friction_torques());
        let one = T::constant(1.0);
        let shares = exerted.iter().zip(self.load_friction());
        let load: Vec<T> = shares.map(|(&w, share)| w / (one + share * w.sign())).collect();
        let load = if self.w.is_empty() { load } else { plus(&load, &self.wrench_forces()) };
        multiplied(inverse, &minus(&load, &self.own(self.load(&self.unaccelerated()))))
    }

    /// The same state with other accelerations of the coordinates.
    pub fn accelerated(&self, own: &[T]) -> Self {
        let mut other = self.clone();
        other.a[..own.len()].copy_from_slice(own);
        other
    }

    /// The same state with dual numbers, for the derivative along coordinate j of the variable `by`.
    pub fn along(&self, by: By, j: usize) -> Case<'m, Dual<T>> {
        let lift = |x: &[T]| x.iter().map(|&x| Dual::fixed(x)).collect::<Vec<_>>();
        let robot = self.robot.lifted();
        let mut small = robot.zeros();
        small[j].eps = T::constant(1.0);
        let mut case = Case {
            at: self.at.lifted(),
            v: lift(&self.v),
            a: lift(&self.a),
            u: lift(&self.u),
            w: lift(&self.w),
            lambda: lift(&self.lambda),
            robot,
        };
        match by {
            By::Positions => case.at = case.robot.moved(&case.at, &small),
            By::Velocities => case.v = plus(&case.v, &small),
            By::Accelerations => case.a = plus(&case.a, &small),
        }
        case
    }

    /// Derivative of a function of the state. Rows are the entries of its result, columns are coordinates.
    pub fn derivative(&self, by: By, function: impl Fn(&Case<'m, Dual<T>>) -> Vec<Dual<T>>) -> Rows<T> {
        let column = |j| function(&self.along(by, j)).into_iter().map(|x| x.eps).collect();
        let columns: Rows<T> = (0..self.n()).map(column).collect();
        transposed(&columns, columns.first().map_or(0, Vec::len))
    }
}

/// A joint or shaft with friction: friction terms, followed coordinates with the gain, position and speed.
pub struct Rubbing<'a, T> {
    pub terms: &'a [FrictionTerm],
    pub follows: &'a [FollowedCoordinate],
    pub gain: T,
    pub y: T,
    pub v: T,
}

pub fn plus<T: Number>(a: &[T], b: &[T]) -> Vec<T> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}

pub fn minus<T: Number>(a: &[T], b: &[T]) -> Vec<T> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

pub fn negative<T: Number>(a: &[T]) -> Vec<T> {
    a.iter().map(|&a| -a).collect()
}

pub fn scaled<T: Number>(a: &[T], factor: T) -> Vec<T> {
    a.iter().map(|&a| a * factor).collect()
}

pub fn product<T: Number>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (&a, &b)| sum + a * b)
}

pub fn multiplied<T: Number>(rows: &[Vec<T>], x: &[T]) -> Vec<T> {
    rows.iter().map(|row| product(row, x)).collect()
}

/// The product `A B` of two matrices.
pub fn matrix_product<T: Number>(a: &[Vec<T>], b: &[Vec<T>]) -> Rows<T> {
    let columns = transposed(b, b.first().map_or(0, Vec::len));
    a.iter().map(|row| columns.iter().map(|column| product(row, column)).collect()).collect()
}

/// The first `n` entries of the columns, as rows.
pub fn transposed<T: Number>(columns: &[Vec<T>], n: usize) -> Rows<T> {
    (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
}
