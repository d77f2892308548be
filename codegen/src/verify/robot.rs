//! Numeric model: poses of the links, their motion, and forces (Newton 1687, Euler 1776).
//!
//! All vectors are in the axes of the base. No frames are chosen, no bodies are combined and no terms are
//! omitted. Only the [`Model`] is shared with the derivation that is checked.

use std::rc::Rc;

use super::number::{Dual, Number};
use super::space::{
    Matrix, Vector, add, attitude, constant, cross, dot, quaternion_product, rotation, rotation_product,
    scale, subtract, sum, times, transposed, turn,
};
use crate::model::{
    Attachment, Body, Drive, FollowedCoordinate, Joint, Model, Motion, MovingJoint, QuaternionJoint,
    RotorCoupling,
};
use gelenk_formula::{Formula, Function};

/// A model with values of its free parameters.
#[derive(Clone)]
pub struct Robot<'m, T> {
    pub model: &'m Model,
    pub parameters: Vec<T>,
    pub moving: Rc<Vec<MovingJoint<'m>>>,
    /// Largest coordinate of a joint or of a centre of mass in the description. The derivation expresses
    /// points in other frames, so each point gets a rounding error of this size (m).
    length: T,
}

/// Positions of all coordinates. Driven coordinates are last. Joints with quaternions have poses instead of
/// positions.
#[derive(Clone)]
pub struct Positions<T> {
    pub scalars: Vec<T>,
    /// Origin and quaternion x y z w of each quaternion joint.
    pub poses: Vec<(Vector<T>, [T; 4])>,
}

/// Pose and motion of a link, in the axes of the base.
#[derive(Clone, Copy)]
pub struct LinkMotion<T> {
    /// Position of the link's origin in the base frame.
    pub origin: Vector<T>,
    /// Rotation from the axes of the link to the axes of the base.
    pub rotation: Matrix<T>,
    /// Velocity of the link's origin.
    pub velocity: Vector<T>,
    /// Angular velocity of the link.
    pub spin: Vector<T>,
    /// Acceleration of the link's origin minus the gravitational acceleration.
    pub acceleration: Vector<T>,
    /// Angular acceleration of the link.
    pub spin_rate: Vector<T>,
    /// Whether a coordinate moves the link.
    pub moves: bool,
}

/// Force and moment about the origin of a link.
pub type Wrench<T> = [Vector<T>; 2];

/// The motion of a joint relative to the parent. The displacement is in the axes of the joint, and the rates
/// are in the axes of the link.
struct Relative<T> {
    slide: Vector<T>,
    rotation: Matrix<T>,
    velocity: Wrench<T>,
    acceleration: Wrench<T>,
}

/// Mass (kg), first moments (kg m) and moments of inertia (kg m²) about the origin of a link: m, h, and I as
/// xx, xy, yy, xz, yz, zz.
pub type Inertia<T> = [T; 10];

impl<'m, T: Number> Robot<'m, T> {
    pub fn new(model: &'m Model, parameters: Vec<T>) -> Self {
        let moving = Rc::new(model.moving_joints());
        let mut robot = Self { model, parameters, moving, length: T::zero() };
        let joints = model.links.iter().filter_map(|link| link.joint.as_ref());
        let centers = model.links.iter().flat_map(|link| &link.bodies).map(|body| &body.center_of_mass);
        let points = joints.map(|joint| &joint.origin.translation).chain(centers);
        let coordinates = points.flat_map(|point| robot.vector(point));
        let length = coordinates.fold(T::zero(), |length, x| length.larger(x));
        robot.length = T::constant(length.value());
        robot
    }

    /// The robot with dual numbers, that is numbers with an additional derivative.
    pub fn lifted(&self) -> Robot<'m, Dual<T>> {
        let parameters = self.parameters.iter().map(|&p| Dual::fixed(p)).collect();
        let length = Dual::fixed(self.length);
        Robot { model: self.model, parameters, moving: Rc::clone(&self.moving), length }
    }

    pub fn number(&self, formula: &Formula) -> T {
        self.value(formula, T::zero(), T::zero())
    }

    pub fn vector(&self, formulas: &[Formula; 3]) -> Vector<T> {
        formulas.each_ref().map(|formula| self.number(formula))
    }

    /// A point of the description, with the error that it has in a frame of the derivation.
    fn point(&self, formulas: &[Formula; 3]) -> Vector<T> {
        self.vector(formulas).map(|x| x.with_error_of(x.larger(self.length)))
    }

    /// Value of a formula of position and velocity.
    pub fn value(&self, formula: &Formula, y: T, v: T) -> T {
        let of = |formula: &Formula| self.value(formula, y, v);
        match formula {
            Formula::Number(number) => T::constant(*number),
            Formula::Parameter(index) => self.parameters[*index],
            Formula::Position => y,
            Formula::Velocity => v,
            Formula::Negate(a) => -of(a),
            Formula::Add(a, b) => of(a) + of(b),
            Formula::Subtract(a, b) => of(a) - of(b),
            Formula::Multiply(a, b) => of(a) * of(b),
            Formula::Divide(a, b) => of(a) / of(b),
            Formula::Power(a, n) => (0..*n).fold(T::constant(1.0), |power, _| power * of(a)),
            Formula::Call(function, a) => match function {
                Function::Sin => of(a).sin_cos().0,
                Function::Cos => of(a).sin_cos().1,
                Function::Tanh => of(a).tanh(),
                Function::Exp => of(a).exp(),
                Function::Abs => of(a).abs(),
                Function::Sqrt => of(a).sqrt(),
                Function::Sign => of(a).sign(),
            },
        }
    }

    /// The motion `Σ ratio · x[coordinate]` of a joint or shaft, for positions, velocities or accelerations x
    /// of the coordinates.
    pub fn followed(&self, terms: &[FollowedCoordinate], x: &[T]) -> T {
        let terms = terms.iter().map(|term| self.number(&term.ratio) * x[term.coordinate]);
        terms.fold(T::zero(), |sum, term| sum + term)
    }

    /// Adds a force along a sum of coordinates to the generalized forces.
    pub fn add_force(&self, terms: &[FollowedCoordinate], force: T, forces: &mut [T]) {
        for term in terms {
            forces[term.coordinate] = forces[term.coordinate] + self.number(&term.ratio) * force;
        }
    }

    /// The coordinates that a joint follows, and its offset.
    fn follows(&self, motion: Motion) -> (&[FollowedCoordinate], f64) {
        match motion {
            Motion::Fixed => (&[], 0.0),
            Motion::Held(position) => (&[], position),
            Motion::Coordinate(index) | Motion::Follower(index) => {
                (&self.moving[index].follows, self.moving[index].offset)
            }
        }
    }

    pub fn gravity(&self) -> Vector<T> {
        self.vector(&self.model.gravity)
    }

    pub fn zeros(&self) -> Vec<T> {
        vec![T::zero(); self.model.motion_count()]
    }

    /// Motion of every link at the given positions, velocities and accelerations.
    pub fn motions(&self, at: &Positions<T>, [v, a]: [&[T]; 2], gravity: Vector<T>) -> Vec<LinkMotion<T>> {
        let still = constant([0.0; 3]);
        let mut links: Vec<LinkMotion<T>> = Vec::with_capacity(self.model.links.len());
        for link in &self.model.links {
            let motion = match &link.joint {
                None => LinkMotion {
                    origin: still,
                    rotation: rotation([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
                    velocity: still,
                    spin: still,
                    acceleration: gravity.map(|g| -g),
                    spin_rate: still,
                    moves: false,
                },
                Some(joint) => self.carried(links[joint.parent], joint, at, [v, a]),
            };
            links.push(motion);
        }
        links
    }

    fn carried(
        &self,
        parent: LinkMotion<T>,
        joint: &Joint,
        at: &Positions<T>,
        rates: [&[T]; 2],
    ) -> LinkMotion<T> {
        let relative = match self.quaternion_joint(joint) {
            // The first link of its chain moves like the last one.
            Some((index, of)) if joint.motion == Motion::Coordinate(of.first) => {
                self.of_pose(&at.poses[index], of, rates)
            }
            Some(_) => return parent,
            None => self.of_axis(joint, at, rates),
        };
        let frame = rotation_product(&parent.rotation, &rotation(joint.origin.rotation));
        let rotation = rotation_product(&frame, &relative.rotation);
        let lever = add(
            times(&parent.rotation, self.point(&joint.origin.translation)),
            times(&frame, relative.slide),
        );
        let [velocity, spin] = relative.velocity.map(|part| times(&rotation, part));
        let [acceleration, spin_rate] = relative.acceleration.map(|part| times(&rotation, part));
        let whole_spin = add(parent.spin, spin);
        LinkMotion {
            origin: add(parent.origin, lever),
            rotation,
            velocity: sum([parent.velocity, cross(parent.spin, lever), velocity]),
            spin: whole_spin,
            acceleration: sum([
                parent.point_acceleration(lever),
                scale(cross(parent.spin, velocity), T::constant(2.0)),
                cross(spin, velocity),
                acceleration,
            ]),
            // The spin times itself is zero. The derivation forms this zero, with its rounding.
            spin_rate: sum([parent.spin_rate, spin_rate, cross(whole_spin, spin)]),
            moves: parent.moves || matches!(joint.motion, Motion::Coordinate(_) | Motion::Follower(_)),
        }
    }

    fn quaternion_joint(&self, joint: &Joint) -> Option<(usize, &'m QuaternionJoint)> {
        let Motion::Coordinate(coordinate) = joint.motion else { return None };
        let mut joints = self.model.quaternion_joints.iter().enumerate();
        joints.find(|(_, joint)| joint.coordinates().contains(&coordinate))
    }

    fn of_pose(
        &self,
        (origin, quaternion): &(Vector<T>, [T; 4]),
        joint: &QuaternionJoint,
        rates: [&[T]; 2],
    ) -> Relative<T> {
        let turning = joint.coordinates().end - 3;
        let parts = |rates: &[T]| {
            let part = |first: usize| [rates[first], rates[first + 1], rates[first + 2]];
            let slides = turning > joint.first;
            [if slides { part(joint.first) } else { constant([0.0; 3]) }, part(turning)]
        };
        let [velocity, acceleration] = rates.map(parts);
        Relative { slide: *origin, rotation: attitude(*quaternion), velocity, acceleration }
    }

    fn of_axis(&self, joint: &Joint, at: &Positions<T>, rates: [&[T]; 2]) -> Relative<T> {
        let (follows, offset) = self.follows(joint.motion);
        let position = self.followed(follows, &at.scalars) + T::constant(offset);
        let [turns, slides] =
            joint.kind.turn_and_slide().map(|gain| joint.axis.map(|x| T::constant(gain * x)));
        let [velocity, acceleration] = rates.map(|rates| {
            let rate = self.followed(follows, rates);
            [slides, turns].map(|axis| scale(axis, rate))
        });
        let rotation = match joint.kind.turn_and_slide()[0] == 0.0 {
            true => rotation([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
            false => turn(joint.axis, position),
        };
        Relative { slide: scale(slides, position), rotation, velocity, acceleration }
    }

    /// Generalized forces of wrenches on links, and the total wrench that each link's joint transmits.
    pub fn projected(
        &self,
        links: &[LinkMotion<T>],
        mut wrenches: Vec<Wrench<T>>,
    ) -> (Vec<T>, Vec<Wrench<T>>) {
        let mut forces = self.zeros();
        for (index, link) in self.model.links.iter().enumerate().rev() {
            let Some(joint) = &link.joint else { continue };
            let [force, moment] = wrenches[index];
            let [turns, slides] = joint.kind.turn_and_slide();
            let axis = times(&links[index].rotation, constant(joint.axis));
            let along = dot(axis, moment) * T::constant(turns) + dot(axis, force) * T::constant(slides);
            self.add_force(self.follows(joint.motion).0, along, &mut forces);
            let lever = subtract(links[index].origin, links[joint.parent].origin);
            let [of_parent, about_parent] = wrenches[joint.parent];
            wrenches[joint.parent] =
                [add(of_parent, force), sum([about_parent, moment, cross(lever, force)])];
        }
        (forces, wrenches)
    }

    /// Wrenches that accelerate the bodies and rotors of each link, and generalized forces on the rotors
    /// along their shafts.
    pub fn inertial_wrenches(&self, links: &[LinkMotion<T>], [v, a]: [&[T]; 2]) -> (Vec<Wrench<T>>, Vec<T>) {
        let bodies = self.model.links.iter().zip(links);
        let mut wrenches: Vec<Wrench<T>> = bodies
            .map(|(link, motion)| {
                let wrenches = link.bodies.iter().map(|body| motion.wrench_of(&self.inertia(body)));
                wrenches.fold([constant([0.0; 3]); 2], add_wrenches)
            })
            .collect();
        let mut forces = self.zeros();
        for drive in &self.model.drives {
            let inertia = self.number(&drive.rotor_inertia);
            let moment = self.rotor(drive, inertia, links, [v, a], &mut forces);
            let [_, sum] = &mut wrenches[drive.carrier];
            *sum = add(*sum, moment);
        }
        (wrenches, forces)
    }

    /// Speed and acceleration of a rotor about its axis. If the rotor is a body, the motion of its carrier is
    /// included.
    pub fn shaft_rates(&self, drive: &Drive, links: &[LinkMotion<T>], [v, a]: [&[T]; 2]) -> [T; 2] {
        let carrier = &links[drive.carrier];
        let axis = times(&carrier.rotation, constant(drive.axis));
        let own = [v, a].map(|x| self.followed(&drive.acts_on, x) * self.number(&drive.gear_ratio));
        match drive.coupling {
            RotorCoupling::Body => [own[0] + dot(axis, carrier.spin), own[1] + dot(axis, carrier.spin_rate)],
            RotorCoupling::Diagonal => own,
        }
    }

    /// Moment of a rotor with this inertia on its carrier. Adds the generalized forces along the rotor's
    /// shaft.
    pub fn rotor(
        &self,
        drive: &Drive,
        inertia: T,
        links: &[LinkMotion<T>],
        rates: [&[T]; 2],
        forces: &mut [T],
    ) -> Vector<T> {
        let [speed, acceleration] = self.shaft_rates(drive, links, rates);
        let along = self.number(&drive.gear_ratio) * inertia * acceleration;
        self.add_force(&drive.acts_on, along, forces);
        let carrier = &links[drive.carrier];
        let axis = times(&carrier.rotation, constant(drive.axis));
        match drive.coupling {
            RotorCoupling::Body => {
                // The axis times itself is zero, with a rounding as in `carried`.
                let spin = add(carrier.spin, scale(axis, speed));
                scale(add(scale(axis, acceleration), scale(cross(spin, axis), speed)), inertia)
            }
            RotorCoupling::Diagonal => constant([0.0; 3]),
        }
    }

    /// A body's inertia about the origin of its link.
    pub fn inertia(&self, body: &Body) -> Inertia<T> {
        let m = self.number(&body.mass);
        let c = self.point(&body.center_of_mass);
        let h = scale(c, m);
        let [xx, xy, xz, yy, yz, zz] = body.inertia.each_ref().map(|entry| self.number(entry));
        let square = dot(h, c);
        let diagonal = |own: T, k: usize| own + square - h[k] * c[k];
        let product = |own: T, i: usize, j: usize| own - h[i] * c[j];
        [
            m,
            h[0],
            h[1],
            h[2],
            diagonal(xx, 0),
            product(xy, 0, 1),
            diagonal(yy, 1),
            product(xz, 0, 2),
            product(yz, 1, 2),
            diagonal(zz, 2),
        ]
    }

    /// Origin of a frame relative to the origin of its link, in the axes of the base, and the rotation of the
    /// frame.
    pub fn attached(&self, at: &Attachment, links: &[LinkMotion<T>]) -> (Vector<T>, Matrix<T>) {
        let link = &links[at.link];
        let arm = times(&link.rotation, self.point(&at.pose.translation));
        (arm, rotation_product(&link.rotation, &rotation(at.pose.rotation)))
    }

    /// The positions `y ⊕ δ`, to first order in δ.
    pub fn moved(&self, at: &Positions<T>, d: &[T]) -> Positions<T> {
        let scalars = at.scalars.iter().zip(d).map(|(&y, &d)| y + d).collect();
        let pose = |(joint, &(origin, quaternion)): (&QuaternionJoint, &(Vector<T>, [T; 4]))| {
            let turning = joint.coordinates().end - 3;
            let [x, y, z] = [d[turning], d[turning + 1], d[turning + 2]].map(|x| x * T::constant(0.5));
            let slide = match turning > joint.first {
                true => [d[joint.first], d[joint.first + 1], d[joint.first + 2]],
                false => constant([0.0; 3]),
            };
            let origin = add(origin, times(&attitude(quaternion), slide));
            (origin, quaternion_product(quaternion, [x, y, z, T::constant(1.0)]))
        };
        let poses = self.model.quaternion_joints.iter().zip(&at.poses).map(pose).collect();
        Positions { scalars, poses }
    }
}

impl<T: Number> Positions<T> {
    pub fn lifted(&self) -> Positions<Dual<T>> {
        let poses = self.poses.iter().map(|(origin, q)| (origin.map(Dual::fixed), q.map(Dual::fixed)));
        Positions { scalars: self.scalars.iter().map(|&y| Dual::fixed(y)).collect(), poses: poses.collect() }
    }
}

impl<T: Number> LinkMotion<T> {
    /// Acceleration of a point of the link, minus the gravitational acceleration.
    pub fn point_acceleration(&self, arm: Vector<T>) -> Vector<T> {
        sum([self.acceleration, cross(self.spin_rate, arm), cross(self.spin, cross(self.spin, arm))])
    }

    /// The wrench about the link's origin that a body with this inertia requires for the link's motion
    /// (Atkeson, An and Hollerbach 1986).
    pub fn wrench_of(&self, &[m, hx, hy, hz, xx, xy, yy, xz, yz, zz]: &Inertia<T>) -> Wrench<T> {
        let h = times(&self.rotation, [hx, hy, hz]);
        let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let [spin, spin_rate] = [self.spin, self.spin_rate].map(|x| times(&transposed(&self.rotation), x));
        let own = add(times(&inertia, spin_rate), cross(spin, times(&inertia, spin)));
        let force = sum([
            scale(self.acceleration, m),
            cross(self.spin_rate, h),
            cross(self.spin, cross(self.spin, h)),
        ]);
        [force, add(cross(h, self.acceleration), times(&self.rotation, own))]
    }
}

pub fn add_wrenches<T: Number>(a: Wrench<T>, b: Wrench<T>) -> Wrench<T> {
    [add(a[0], b[0]), add(a[1], b[1])]
}
