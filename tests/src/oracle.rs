//! The equations of motion of a model as a textbook has them, to check the derived ones against.
//!
//! Energies are summed over the bodies in the base frame, and Lagrange's equations are formed with dual
//! numbers (Fike and Alonso 2011): no recursion over forces, no Denavit–Hartenberg frames, no lumping, no
//! expression graph. Only the [`Model`] is shared with the generator.

use gelenk_codegen::formula::{Formula, Function};
use gelenk_codegen::model::{
    Actuator, Attachment, Drive, FollowedCoordinate, ForceEffect, Frame, FrictionTerm, Input, Joint,
    JointKind, Model, Motion, Pose, RotorCoupling, WrenchAxes,
};
use num_dual::{Dual64, DualNum, HyperDual64};

/// Numbers that carry derivatives, or plain ones.
pub trait Number: DualNum<Primitive = f64> + Copy {}
impl<T: DualNum<Primitive = f64> + Copy> Number for T {}

/// A vector in the base frame.
pub type Vector<T> = [T; 3];

/// Rows first.
pub type Matrix<T> = [[T; 3]; 3];

/// Where a link is and how it moves, all in axes of the base.
#[derive(Debug, Clone, Copy)]
pub struct LinkState<T> {
    /// Origin (m).
    pub origin: Vector<T>,
    /// Columns are the link's axes.
    pub rotation: Matrix<T>,
    /// Velocity of the origin [m/s].
    pub velocity: Vector<T>,
    /// Angular velocity [rad/s].
    pub spin: Vector<T>,
    /// Whether any coordinate moves it.
    pub moves: bool,
}

/// A model with values for its free parameters.
#[derive(Debug, Clone, Copy)]
pub struct Oracle<'m> {
    /// The robot.
    pub model: &'m Model,
    /// Values of its parameters.
    pub parameters: &'m [f64],
}

impl Oracle<'_> {
    fn number(&self, formula: &Formula) -> f64 {
        value(formula, self.parameters, 0.0, 0.0)
    }

    fn vector(&self, formulas: &[Formula; 3]) -> [f64; 3] {
        formulas.each_ref().map(|formula| self.number(formula))
    }

    /// State of every link.
    pub fn links<T: Number>(&self, y: &[T], v: &[T]) -> Vec<LinkState<T>> {
        let zero = constant([0.0; 3]);
        let mut states: Vec<LinkState<T>> = Vec::new();
        for link in &self.model.links {
            let state = match &link.joint {
                None => LinkState {
                    origin: zero,
                    rotation: constant_matrix(IDENTITY),
                    velocity: zero,
                    spin: zero,
                    moves: false,
                },
                Some(joint) => self.carried(&states[joint.parent], joint, y, v),
            };
            states.push(state);
        }
        states
    }

    /// `Σ ratio · x[coordinate]`
    fn sum<T: Number>(&self, terms: &[FollowedCoordinate], x: &[T]) -> T {
        let terms = terms.iter().map(|term| x[term.coordinate] * self.number(&term.ratio));
        terms.fold(T::from(0.0), |sum, term| sum + term)
    }

    /// State of the link behind a joint.
    fn carried<T: Number>(&self, parent: &LinkState<T>, joint: &Joint, y: &[T], v: &[T]) -> LinkState<T> {
        let (position, speed, moves) = match joint.motion {
            Motion::Fixed => (T::from(0.0), T::from(0.0), parent.moves),
            Motion::Held(position) => (T::from(position), T::from(0.0), parent.moves),
            Motion::Coordinate(index) => (y[index], v[index], true),
            Motion::Follower(index) => {
                let follower = &self.model.followers[index - self.model.motion_count()];
                let position = self.sum(&follower.follows, y) + follower.offset;
                (position, self.sum(&follower.follows, v), true)
            }
        };
        let (arm, rotation) = self.placed(parent, &joint.origin);
        let axis = times(&rotation, &constant(joint.axis));
        let mut state = LinkState {
            origin: add(&parent.origin, &arm),
            rotation,
            velocity: parent.velocity,
            spin: parent.spin,
            moves,
        };
        match joint.kind {
            JointKind::Fixed => {}
            JointKind::Revolute | JointKind::Continuous => {
                state.rotation = product(&rotation, &turn(joint.axis, position));
                state.spin = add(&parent.spin, &scale(&axis, speed));
            }
            JointKind::Prismatic => {
                state.origin = add(&state.origin, &scale(&axis, position));
                state.velocity = add(&state.velocity, &scale(&axis, speed));
            }
            JointKind::Helical { pitch } => {
                state.rotation = product(&rotation, &turn(joint.axis, position));
                state.spin = add(&parent.spin, &scale(&axis, speed));
                state.origin = add(&state.origin, &scale(&axis, position * pitch));
                state.velocity = add(&state.velocity, &scale(&axis, speed * pitch));
            }
        }
        let lever = subtract(&state.origin, &parent.origin);
        state.velocity = add(&state.velocity, &cross(&parent.spin, &lever));
        state
    }

    /// A pose in a link: translation in axes of the base, rotation to the base.
    fn placed<T: Number>(&self, link: &LinkState<T>, pose: &Pose) -> (Vector<T>, Matrix<T>) {
        let translation = constant(self.vector(&pose.translation));
        (times(&link.rotation, &translation), product(&link.rotation, &constant_matrix(pose.rotation)))
    }

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
            energy += self.rotor_energy(drive, &states[drive.carrier], v);
        }
        energy
    }

    fn rotor_energy<T: Number>(&self, drive: &Drive, carrier: &LinkState<T>, v: &[T]) -> T {
        let own = self.sum(&drive.acts_on, v) * self.number(&drive.gear_ratio);
        let axis = times(&carrier.rotation, &constant(drive.axis));
        let spin = match drive.coupling {
            RotorCoupling::Body => dot(&axis, &carrier.spin) + own,
            RotorCoupling::Diagonal => own,
        };
        spin * spin * (0.5 * self.number(&drive.rotor_inertia))
    }

    /// `V = −Σ m g·c` over the bodies that move.
    pub fn potential_energy<T: Number>(&self, y: &[T]) -> T {
        let still = vec![T::from(0.0); y.len()];
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

    /// `d/dt ∂T/∂ẏ − ∂T/∂y`, that is M ÿ + k.
    pub fn inertial_forces(&self, y: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
        let force = |j: usize| {
            let along_y: Vec<_> = (0..y.len()).map(|i| HyperDual64::new(y[i], 0.0, v[i], 0.0)).collect();
            let along_v: Vec<_> =
                (0..y.len()).map(|i| HyperDual64::new(v[i], unit(i, j), a[i], 0.0)).collect();
            let constant: Vec<_> = v.iter().map(|&v| Dual64::from(v)).collect();
            self.kinetic_energy(&along_y, &along_v).eps1eps2
                - self.kinetic_energy(&seeded(y, j), &constant).eps
        };
        (0..y.len()).map(force).collect()
    }

    /// `−∂V/∂y`
    pub fn gravity_forces(&self, y: &[f64]) -> Vec<f64> {
        (0..y.len()).map(|j| -self.potential_energy(&seeded(y, j)).eps).collect()
    }

    /// `∂²T/∂ẏ∂ẏ`, rows first.
    pub fn mass_matrix(&self, y: &[f64]) -> Vec<f64> {
        let position: Vec<_> = y.iter().map(|&y| HyperDual64::from(y)).collect();
        let n = y.len();
        let entry = |i: usize, j: usize| {
            let v: Vec<_> = (0..n).map(|k| HyperDual64::new(0.0, unit(k, i), unit(k, j), 0.0)).collect();
            self.kinetic_energy(&position, &v).eps1eps2
        };
        (0..n * n).map(|at| entry(at / n, at % n)).collect()
    }

    /// Forces of springs and dampers: of joints, and between frames.
    pub fn spring_forces(&self, y: &[f64], v: &[f64]) -> Vec<f64> {
        let mut forces = self.joint_forces(y, v, |joint, y, v| {
            joint.springs.iter().map(|law| value(law, self.parameters, y, v)).sum()
        });
        for (force, of_law) in forces.iter_mut().zip(self.law_forces(y, v)) {
            *force += of_law;
        }
        forces
    }

    /// Forces of the laws between frames, where nothing moves.
    pub fn law_forces_at_rest(&self, y: &[f64]) -> Vec<f64> {
        self.law_forces(y, &vec![0.0; y.len()])
    }

    fn law_forces(&self, y: &[f64], v: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; y.len()];
        for force in &self.model.point_forces {
            let (length, slope) = self.distance(&force.between, y);
            let rate: f64 = slope.iter().zip(v).map(|(slope, v)| slope * v).sum();
            let pull = value(&force.law, self.parameters, length, rate);
            for (force, slope) in forces.iter_mut().zip(&slope) {
                *force -= pull * slope;
            }
        }
        forces
    }

    /// Distance of two frames' origins, and its derivatives by y.
    fn distance(&self, between: &[Attachment; 2], y: &[f64]) -> (f64, Vec<f64>) {
        let by = |j: usize| {
            let [a, b] = between.each_ref().map(|at| self.attached(at.link, &at.pose, &seeded(y, j)).0);
            let across = subtract(&b, &a);
            dot(&across, &across).sqrt()
        };
        let distances: Vec<Dual64> = (0..y.len()).map(by).collect();
        (distances[0].re, distances.iter().map(|distance| distance.eps).collect())
    }

    /// B by columns: what the power of a unit of each input is for a unit of each velocity.
    pub fn input_columns(&self, y: &[f64]) -> Vec<Vec<f64>> {
        let column = |input: Actuator<'_>| match input {
            Actuator::Drive(drive) => {
                let constant = match &drive.input {
                    Input::Torque | Input::None => 1.0,
                    Input::Current(constant) => self.number(constant),
                };
                let mut column = vec![0.0; y.len()];
                for term in &drive.acts_on {
                    column[term.coordinate] +=
                        self.number(&drive.gear_ratio) * self.number(&term.ratio) * constant;
                }
                column
            }
            Actuator::Force(force) => match &force.effect {
                ForceEffect::Pull(between) => {
                    self.distance(between, y).1.iter().map(|slope| -slope).collect()
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
    pub fn wrench_forces(&self, y: &[f64], w: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; y.len()];
        for (described, w) in self.model.wrenches.iter().zip(w.chunks(6)) {
            let w: [f64; 6] = w.try_into().expect("six entries");
            let own = self.wrench_forces_at(&described.at, described.axes, &w, y);
            forces.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        forces
    }

    fn wrench_forces_at(&self, at: &Attachment, axes: WrenchAxes, w: &[f64; 6], y: &[f64]) -> Vec<f64> {
        let (_, rotation) = self.attached(at.link, &at.pose, y);
        let in_base = |part: [f64; 3]| match axes {
            WrenchAxes::Frame => times(&rotation, &part),
            WrenchAxes::Base => part,
        };
        let (force, moment) = (in_base([w[0], w[1], w[2]]), in_base([w[3], w[4], w[5]]));
        let wrench = stacked(force, moment);
        let work = |j: usize| {
            let column = self.column_of(at.link, &at.pose, y, j);
            column.iter().zip(&wrench).map(|(column, wrench)| column * wrench).sum()
        };
        (0..y.len()).map(work).collect()
    }

    /// `τ = Σ coefficient · basis`
    pub fn friction_torques(&self, y: &[f64], v: &[f64]) -> Vec<f64> {
        let sum = |terms: &[FrictionTerm], y: f64, v: f64| -> f64 {
            let torque = |term: &FrictionTerm| {
                self.number(&term.coefficient) * value(&term.basis, self.parameters, y, v)
            };
            terms.iter().map(torque).sum()
        };
        let mut torques = self.joint_forces(y, v, |joint, y, v| sum(&joint.friction, y, v));
        for drive in &self.model.drives {
            let ratio = self.number(&drive.gear_ratio);
            let at_shaft = |x: &[f64]| ratio * self.sum(&drive.acts_on, x);
            let torque = sum(&drive.friction, at_shaft(y), at_shaft(v));
            for term in &drive.acts_on {
                torques[term.coordinate] += ratio * self.number(&term.ratio) * torque;
            }
        }
        torques
    }

    /// Forces along joints, at their positions and speeds, as forces on the coordinates: by virtual work.
    fn joint_forces(&self, y: &[f64], v: &[f64], force: impl Fn(&Joint, f64, f64) -> f64) -> Vec<f64> {
        let mut forces = vec![0.0; y.len()];
        for joint in self.model.links.iter().filter_map(|link| link.joint.as_ref()) {
            match joint.motion {
                Motion::Fixed | Motion::Held(_) => {}
                Motion::Coordinate(index) => forces[index] += force(joint, y[index], v[index]),
                Motion::Follower(index) => {
                    let follower = &self.model.followers[index - y.len()];
                    let position = self.sum(&follower.follows, y) + follower.offset;
                    let force = force(joint, position, self.sum(&follower.follows, v));
                    for term in &follower.follows {
                        forces[term.coordinate] += self.number(&term.ratio) * force;
                    }
                }
            }
        }
        forces
    }

    /// Origin and rotation of a named frame.
    pub fn frame<T: Number>(&self, frame: &Frame, y: &[T]) -> (Vector<T>, Matrix<T>) {
        self.attached(frame.link, &frame.pose, y)
    }

    fn attached<T: Number>(&self, link: usize, pose: &Pose, y: &[T]) -> (Vector<T>, Matrix<T>) {
        let still = vec![T::from(0.0); y.len()];
        let link = self.links(y, &still)[link];
        let (arm, rotation) = self.placed(&link, pose);
        (add(&link.origin, &arm), rotation)
    }

    /// Column `j` of a frame's Jacobian: `∂p/∂y`, then the vector of `∂R/∂y Rᵀ`.
    pub fn jacobian_column(&self, frame: &Frame, y: &[f64], j: usize) -> [f64; 6] {
        self.column_of(frame.link, &frame.pose, y, j)
    }

    fn column_of(&self, link: usize, pose: &Pose, y: &[f64], j: usize) -> [f64; 6] {
        let (origin, rotation) = self.attached(link, pose, &seeded(y, j));
        let rate = rotation.map(|row| row.map(|x| x.eps));
        let turned = product(&rate, &transposed(&rotation.map(|row| row.map(|x| x.re))));
        stacked(origin.map(|x| x.eps), axial(&turned))
    }

    /// `J̇ẏ`: acceleration of the frame on `y + ẏ t`.
    pub fn jacobian_rate_times_velocity(&self, frame: &Frame, y: &[f64], v: &[f64]) -> [f64; 6] {
        let path: Vec<_> = (0..y.len()).map(|i| HyperDual64::new(y[i], v[i], v[i], 0.0)).collect();
        let (origin, rotation) = self.frame(frame, &path);
        // Ω = Ṙ Rᵀ, Ω̇ = R̈ Rᵀ + Ṙ Ṙᵀ; the second part is symmetric.
        let second = rotation.map(|row| row.map(|x| x.eps1eps2));
        let turned = product(&second, &transposed(&rotation.map(|row| row.map(|x| x.re))));
        stacked(origin.map(|x| x.eps1eps2), axial(&turned))
    }
}

/// Value of a formula.
pub fn value(formula: &Formula, parameters: &[f64], y: f64, v: f64) -> f64 {
    let of = |formula: &Formula| value(formula, parameters, y, v);
    match formula {
        Formula::Number(number) => *number,
        Formula::Parameter(index) => parameters[*index],
        Formula::Position => y,
        Formula::Velocity => v,
        Formula::Negate(a) => -of(a),
        Formula::Add(a, b) => of(a) + of(b),
        Formula::Subtract(a, b) => of(a) - of(b),
        Formula::Multiply(a, b) => of(a) * of(b),
        Formula::Divide(a, b) => of(a) / of(b),
        Formula::Power(a, n) => (0..*n).map(|_| of(a)).product(),
        Formula::Call(function, a) => {
            let x = of(a);
            match function {
                Function::Sin => x.sin(),
                Function::Cos => x.cos(),
                Function::Tanh => x.tanh(),
                Function::Exp => x.exp(),
                Function::Abs => x.abs(),
                Function::Sqrt => x.sqrt(),
                Function::Sign if x == 0.0 => 0.0,
                Function::Sign => x.signum(),
            }
        }
    }
}

const IDENTITY: Matrix<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn unit(i: usize, j: usize) -> f64 {
    f64::from(u8::from(i == j))
}

/// `y` with the derivative by its entry `j`.
fn seeded(y: &[f64], j: usize) -> Vec<Dual64> {
    (0..y.len()).map(|i| Dual64::new(y[i], unit(i, j))).collect()
}

fn stacked(a: [f64; 3], b: [f64; 3]) -> [f64; 6] {
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// The vector of the antisymmetric part.
fn axial(a: &Matrix<f64>) -> [f64; 3] {
    [(2, 1), (0, 2), (1, 0)].map(|(i, j)| 0.5 * (a[i][j] - a[j][i]))
}

fn constant<T: Number>(a: [f64; 3]) -> Vector<T> {
    a.map(T::from)
}

fn constant_matrix<T: Number>(a: Matrix<f64>) -> Matrix<T> {
    a.map(constant)
}

fn symmetric<T: Number>([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix<T> {
    constant_matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
}

fn add<T: Number>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn subtract<T: Number>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn scale<T: Number>(a: &Vector<T>, factor: T) -> Vector<T> {
    a.map(|a| a * factor)
}

fn dot<T: Number>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<T: Number>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn times<T: Number>(a: &Matrix<T>, b: &Vector<T>) -> Vector<T> {
    a.each_ref().map(|row| dot(row, b))
}

fn transposed<T: Number>(a: &Matrix<T>) -> Matrix<T> {
    [0, 1, 2].map(|i| [a[0][i], a[1][i], a[2][i]])
}

fn product<T: Number>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    let columns = transposed(b);
    a.each_ref().map(|row| columns.each_ref().map(|column| dot(row, column)))
}

/// Rotation about a unit axis (Rodrigues 1840): `1 + sin θ [a] + (1 − cos θ) [a]²`.
fn turn<T: Number>(axis: [f64; 3], angle: T) -> Matrix<T> {
    let [x, y, z] = axis;
    let hat = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let square = product(&hat, &hat);
    let (sine, cosine) = angle.sin_cos();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| sine * hat[i][j] + (-cosine + 1.0) * square[i][j] + unit(i, j)))
}
