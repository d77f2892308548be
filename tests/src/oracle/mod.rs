//! The equations of motion of a model as a textbook has them, to check the derived ones against.
//!
//! Energies are summed over the bodies in the base frame, and the equations of Lagrange and Poincaré (1901) are formed with dual
//! numbers (Fike and Alonso 2011): no recursion over forces, no Denavit–Hartenberg frames, no lumping, no
//! expression graph. Only the [`Model`] is shared with the generator. Numbers may carry derivatives themselves, so that
//! derivatives come from the same lines.
//!
//! Positions and velocities are those of generated modules; those of driven joints follow.

mod forces;
mod momentum;
pub(crate) mod vectors;

use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{
    FollowedCoordinate, Frame, Joint, JointKind, Model, Motion, Pose, QuaternionJoint, QuaternionKind,
};
use num_dual::{Dual, HyperDual64};

use crate::dual::{Number, call};
use crate::positions::{moved, turned};
use vectors::{
    IDENTITY, Matrix, Vector, add, axial, constant, constant_matrix, cross, product, scale, stacked,
    subtract, times, transposed, turn, unit,
};

/// The pose and the motion of a link, in axes of the base.
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
        let places = self.by_coordinate(y);
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
                Some(joint) => match self.quaternion_of(joint) {
                    Some(quaternion) => self.freed(&states[joint.parent], joint, quaternion, [y, v]),
                    None => self.carried(&states[joint.parent], joint, &places, v),
                },
            };
            states.push(state);
        }
        states
    }

    /// The position of each coordinate. Those of a quaternion have none: NaN.
    fn by_coordinate<T: Number>(&self, y: &[T]) -> Vec<T> {
        let position = |k: usize| match self.model.quaternion_joint_of(k) {
            Some(_) => T::from(f64::NAN),
            None => y[self.model.first_position(k)],
        };
        (0..self.model.motion_count()).map(position).collect()
    }

    fn quaternion_of(&self, joint: &Joint) -> Option<&QuaternionJoint> {
        match joint.motion {
            Motion::Coordinate(index) => self.model.quaternion_joint_of(index),
            _ => None,
        }
    }

    /// `Σ ratio · x[coordinate]`
    fn sum<T: Number>(&self, terms: &[FollowedCoordinate], x: &[T]) -> T {
        let terms = terms.iter().map(|term| x[term.coordinate] * self.number(&term.ratio));
        terms.fold(T::from(0.0), |sum, term| sum + term)
    }

    /// State of the link behind one of the joints that stand for a spherical or floating one: the last of them moves as it does,
    /// the others stand still.
    fn freed<T: Number>(
        &self,
        parent: &LinkState<T>,
        joint: &Joint,
        quaternion: &QuaternionJoint,
        [y, v]: [&[T]; 2],
    ) -> LinkState<T> {
        let (arm, rotation) = self.placed(parent, &joint.origin);
        let mut state = LinkState { origin: add(&parent.origin, &arm), rotation, moves: true, ..*parent };
        let velocities = quaternion.coordinates();
        if joint.motion == Motion::Coordinate(velocities.end - 1) {
            let three = |of: &[T], first: usize| [of[first], of[first + 1], of[first + 2]];
            let place = self.model.first_position(quaternion.first);
            let turn = place + quaternion.kind.quaternion();
            let column = |k: usize| turned(three(y, turn), y[turn + 3], constant(IDENTITY[k]));
            state.rotation = product(&rotation, &transposed(&[0, 1, 2].map(column)));
            let own = times(&state.rotation, &three(v, velocities.end - 3));
            state.spin = add(&parent.spin, &own);
            if quaternion.kind == QuaternionKind::Floating {
                state.origin = add(&state.origin, &times(&rotation, &three(y, place)));
                let slide = times(&state.rotation, &three(v, quaternion.first));
                state.velocity = add(&state.velocity, &slide);
            }
        }
        swept(parent, state)
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
        let mut state = LinkState { origin: add(&parent.origin, &arm), rotation, moves, ..*parent };
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
        swept(parent, state)
    }

    /// A pose in a link: translation in axes of the base, rotation to the base.
    fn placed<T: Number>(&self, link: &LinkState<T>, pose: &Pose) -> (Vector<T>, Matrix<T>) {
        let translation = constant(self.vector(&pose.translation));
        (times(&link.rotation, &translation), product(&link.rotation, &constant_matrix(pose.rotation)))
    }

    /// Origin and rotation of a named frame.
    pub fn frame<T: Number>(&self, frame: &Frame, y: &[T]) -> (Vector<T>, Matrix<T>) {
        self.attached(frame.link, &frame.pose, y)
    }

    fn attached<T: Number>(&self, link: usize, pose: &Pose, y: &[T]) -> (Vector<T>, Matrix<T>) {
        let still = vec![T::from(0.0); self.model.motion_count()];
        let link = self.links(y, &still)[link];
        let (arm, rotation) = self.placed(&link, pose);
        (add(&link.origin, &arm), rotation)
    }

    /// Column `j` of a frame's Jacobian: `∂p/∂y`, then the vector of `∂R/∂y Rᵀ`.
    pub fn jacobian_column(&self, frame: &Frame, y: &[f64], j: usize) -> [f64; 6] {
        self.column_of(frame.link, &frame.pose, y, j)
    }

    fn column_of<T: Number>(&self, link: usize, pose: &Pose, y: &[T], j: usize) -> [T; 6] {
        let (origin, rotation) = self.attached(link, pose, &self.along(y, &self.unit(j)));
        let rate = rotation.map(|row| row.map(|x| x.eps));
        let turned = product(&rate, &transposed(&rotation.map(|row| row.map(|x| x.re))));
        stacked(origin.map(|x| x.eps), axial(&turned))
    }

    /// `J̇ẏ`: acceleration of the frame on `y ⊕ v t`.
    pub fn jacobian_rate_times_velocity(&self, frame: &Frame, y: &[f64], v: &[f64]) -> [f64; 6] {
        let still: Vec<_> = y.iter().map(|&y| HyperDual64::from(y)).collect();
        let motion: Vec<_> = v.iter().map(|&v| HyperDual64::new(0.0, v, v, 0.0)).collect();
        let (origin, rotation) = self.frame(frame, &moved(self.model, &still, &motion));
        // Ω = Ṙ Rᵀ, Ω̇ = R̈ Rᵀ + Ṙ Ṙᵀ; the second part is symmetric.
        let second = rotation.map(|row| row.map(|x| x.eps1eps2));
        let turned = product(&second, &transposed(&rotation.map(|row| row.map(|x| x.re))));
        stacked(origin.map(|x| x.eps1eps2), axial(&turned))
    }

    /// Positions with the derivative along a small motion.
    pub fn along<T: Number>(&self, y: &[T], d: &[f64]) -> Vec<Dual<T>> {
        let zero = T::from(0.0);
        let still: Vec<_> = y.iter().map(|&y| Dual::new(y, zero)).collect();
        let motion: Vec<_> = d.iter().map(|&d| Dual::new(zero, T::from(d))).collect();
        moved(self.model, &still, &motion)
    }

    /// The small motion along velocity `j`.
    pub fn unit(&self, j: usize) -> Vec<f64> {
        (0..self.model.motion_count()).map(|k| unit(k, j)).collect()
    }
}

/// The state of a link with the velocity that the spin of its parent gives it.
fn swept<T: Number>(parent: &LinkState<T>, mut state: LinkState<T>) -> LinkState<T> {
    let lever = subtract(&state.origin, &parent.origin);
    state.velocity = add(&state.velocity, &cross(&parent.spin, &lever));
    state
}

/// Value of a formula.
pub fn value<T: Number>(formula: &Formula, parameters: &[f64], y: T, v: T) -> T {
    let of = |formula: &Formula| value(formula, parameters, y, v);
    match formula {
        Formula::Number(number) => T::from(*number),
        Formula::Parameter(index) => T::from(parameters[*index]),
        Formula::Position => y,
        Formula::Velocity => v,
        Formula::Negate(a) => -of(a),
        Formula::Add(a, b) => of(a) + of(b),
        Formula::Subtract(a, b) => of(a) - of(b),
        Formula::Multiply(a, b) => of(a) * of(b),
        Formula::Divide(a, b) => of(a) / of(b),
        Formula::Power(a, n) => (0..*n).fold(T::from(1.0), |power, _| power * of(a)),
        Formula::Call(function, a) => call(*function, of(a)),
    }
}
