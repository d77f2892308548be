//! Results of every function of the catalogue in a state, by the equations of the oracle.

use fastrand::Rng;
use gelenk_codegen::function_names::{self as names, FrameKind};
use gelenk_codegen::model::Model;
use nalgebra::{DMatrix, DVector};
use num_dual::{Dual, HyperDual, HyperDual64};

use crate::dual::Number;
use crate::oracle::{Oracle, vectors::unit};
use crate::positions::{bracket, moved, positions};
use crate::random_model::{Sample, condition_of, random_sample};

/// The arguments of functions.
#[derive(Debug, Clone)]
pub struct State {
    /// Positions, velocities, accelerations, inputs and free parameters.
    pub sample: Sample,
    /// Wrenches.
    pub w: Vec<f64>,
    /// Multipliers.
    pub lambda: Vec<f64>,
    /// Position, velocity and acceleration of each driven joint.
    pub d: Vec<f64>,
}

impl State {
    /// A random state of a robot.
    pub fn random(rng: &mut Rng, model: &Model) -> Self {
        let sample = random_sample(rng, model);
        let mut array = |len: usize| (0..len).map(|_| 3.0 * rng.f64() - 1.5).collect();
        Self {
            w: array(6 * model.wrenches.len()),
            lambda: array(model.coordinates.len()),
            d: array(3 * model.driven.len()),
            sample: Sample { y: positions(model, &sample.y), ..sample },
        }
    }

    /// An argument by its name.
    ///
    /// # Panics
    /// No function takes an argument of this name.
    pub fn argument(&self, name: &str) -> &[f64] {
        match name {
            "y" => &self.sample.y,
            "v" => &self.sample.v,
            "a" => &self.sample.a,
            "u" => &self.sample.u,
            "w" => &self.w,
            "lambda" => &self.lambda,
            "d" => &self.d,
            other => panic!("functions take {other}"),
        }
    }
}

/// A robot in a state: positions, velocities and accelerations of all joints, those of the driven ones last.
pub struct Truth<'a> {
    oracle: Oracle<'a>,
    state: &'a State,
    y: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// Inverse of the mass matrix.
    inverse: DMatrix<f64>,
    /// Condition number of the mass matrix: errors of what is multiplied by its inverse grow with it.
    pub condition: f64,
}

impl<'a> Truth<'a> {
    /// The equations in a state.
    pub fn new(model: &'a Model, state: &'a State) -> Self {
        let driven = |part: usize| state.d.iter().skip(part).step_by(3).copied();
        let all = |own: &[f64], part: usize| own.iter().copied().chain(driven(part)).collect::<Vec<_>>();
        let sample = &state.sample;
        let oracle = Oracle { model, parameters: &sample.parameters };
        let mut truth = Self {
            oracle,
            state,
            y: all(&sample.y, 0),
            v: all(&sample.v, 1),
            a: all(&sample.a, 2),
            inverse: DMatrix::zeros(0, 0),
            condition: 1.0,
        };
        let mass = truth.mass_matrix();
        truth.condition = condition_of(&mass);
        let n = truth.n();
        truth.inverse = DMatrix::from_row_slice(n, n, &mass).try_inverse().expect("M is regular");
        truth
    }

    fn n(&self) -> usize {
        self.state.sample.v.len()
    }

    /// The rows of the coordinates.
    fn rows<T: Clone>(&self, forces: Vec<T>) -> Vec<T> {
        forces[..self.n()].to_vec()
    }

    /// Accelerations of all joints, from those of the coordinates.
    fn accelerations(&self, own: &[f64]) -> Vec<f64> {
        own.iter().chain(&self.a[self.n()..]).copied().collect()
    }

    fn mass_matrix(&self) -> Vec<f64> {
        let all = self.oracle.mass_matrix(&self.y);
        all.chunks(self.v.len()).take(self.n()).flat_map(|row| &row[..self.n()]).copied().collect()
    }

    fn coriolis(&self) -> Vec<f64> {
        let steady = self.accelerations(&vec![0.0; self.n()]);
        self.rows(self.oracle.inertial_forces(&self.y, &self.v, &steady))
    }

    fn gravity(&self) -> Vec<f64> {
        self.rows(self.oracle.gravity_forces(&self.y))
    }

    fn springs(&self) -> Vec<f64> {
        self.rows(self.oracle.spring_forces(&self.y, &self.v))
    }

    /// Friction torques.
    pub fn friction(&self) -> Vec<f64> {
        self.rows(self.oracle.friction_torques(&self.y, &self.v))
    }

    /// q
    fn applied(&self) -> Vec<f64> {
        minus(&plus(&self.gravity(), &self.springs()), &self.friction())
    }

    fn wrench_forces(&self) -> Vec<f64> {
        self.rows(self.oracle.wrench_forces(&self.y, &self.state.w))
    }

    /// `M v̇ + k − q_gravity`
    pub fn inertial(&self) -> Vec<f64> {
        let forces = self.oracle.inertial_forces(&self.y, &self.v, &self.a);
        minus(&self.rows(forces), &self.gravity())
    }

    /// `B u`
    fn inputs<T: Number>(&self, y: &[T]) -> Vec<T> {
        let mut sum = vec![T::from(0.0); self.n()];
        for (column, u) in self.oracle.input_columns(y).iter().zip(&self.state.sample.u) {
            sum.iter_mut().zip(column).for_each(|(sum, &entry)| *sum += entry * *u);
        }
        sum
    }

    /// B, rows first.
    fn input_matrix(&self) -> Vec<f64> {
        let columns = self.oracle.input_columns(&self.y);
        (0..self.n()).flat_map(|row| columns.iter().map(move |column| column[row])).collect()
    }

    /// The derivatives of forces by the positions, rows first.
    fn by_positions(&self, forces: impl Fn(&[Dual<f64>]) -> Vec<Dual<f64>>) -> Vec<f64> {
        let column = |j: usize| forces(&self.oracle.along(&self.y, &self.oracle.unit(j)));
        self.by_columns(&(0..self.n()).map(column).collect::<Vec<_>>())
    }

    fn by_columns(&self, columns: &[Vec<Dual<f64>>]) -> Vec<f64> {
        (0..self.n()).flat_map(|row| columns.iter().map(move |column| column[row].eps)).collect()
    }

    /// Derivatives of `M v̇ + k − q` by the positions and the velocities.
    fn slopes(&self, a: &[f64]) -> [Vec<f64>; 2] {
        let still = |x: &[f64]| x.iter().map(|&x| Dual::from(x)).collect::<Vec<_>>();
        let (y, v, a) = (still(&self.y), still(&self.v), still(a));
        let column = |j: usize| {
            let v: Vec<_> = self.v.iter().enumerate().map(|(k, &v)| Dual::new(v, unit(k, j))).collect();
            self.oracle.inverse_dynamics(&y, &v, &a)
        };
        let by_velocities = self.by_columns(&(0..self.n()).map(column).collect::<Vec<_>>());
        [self.by_positions(|y| self.oracle.inverse_dynamics(y, &v, &a)), by_velocities]
    }

    fn wrench_slopes(&self) -> Vec<f64> {
        self.by_positions(|y| self.oracle.wrench_forces(y, &self.state.w))
    }

    fn inverse_dynamics(&self) -> Vec<f64> {
        self.rows(self.oracle.inverse_dynamics(&self.y, &self.v, &self.a))
    }

    /// The accelerations that the inputs and further forces cause.
    fn forward_dynamics(&self, more: &[f64]) -> Vec<f64> {
        let bias = minus(&self.coriolis(), &self.applied());
        let forces = minus(&plus(&self.inputs(&self.y), more), &bias);
        (&self.inverse * DVector::from_vec(forces)).as_slice().to_vec()
    }

    fn forward_derivatives(&self, has_wrenches: bool) -> Vec<Vec<f64>> {
        let n = self.n();
        let pushed = if has_wrenches { self.wrench_forces() } else { vec![0.0; n] };
        let accelerations = self.forward_dynamics(&pushed);
        let [by_y, by_v] = self.slopes(&self.accelerations(&accelerations));
        let mut by_y = minus(&by_y, &self.by_positions(|y| self.inputs(y)));
        if has_wrenches {
            by_y = minus(&by_y, &self.wrench_slopes());
        }
        let solved =
            |slopes: Vec<f64>| rows_first(&(-&self.inverse * DMatrix::from_row_slice(n, n, &slopes)));
        vec![accelerations, solved(by_y), solved(by_v), rows_first(&self.inverse)]
    }

    /// Linear model. With D (joints with quaternions), the remainder counts the positions as zero displacement.
    fn linearize(&self) -> Vec<Vec<f64>> {
        let (n, sample) = (self.n(), &self.state.sample);
        let [accelerations, by_y, by_v, _] =
            <[Vec<f64>; 4]>::try_from(self.forward_derivatives(false)).expect("four");
        let inputs = DMatrix::from_row_slice(n, sample.u.len(), &self.input_matrix());
        let by_u = rows_first(&(&self.inverse * inputs));
        let remainder = minus(&accelerations, &times(&by_v, &sample.v, n));
        let mut remainder = minus(&remainder, &times(&by_u, &sample.u, n));
        if self.oracle.model.quaternion_joints.is_empty() {
            remainder = minus(&remainder, &times(&by_y, &sample.y, n));
            return vec![by_y, by_v, by_u, remainder];
        }
        let columns: Vec<_> =
            (0..n).map(|j| bracket(self.oracle.model, &self.v, &self.oracle.unit(j))).collect();
        let drift = (0..n).flat_map(|i| columns.iter().map(move |column| -column[i])).collect();
        vec![by_y, by_v, by_u, remainder, drift]
    }

    /// Positions with derivatives along each small motion, and the forces of gravity and of laws between frames at rest.
    pub fn conservative(&self) -> (Vec<Vec<Dual<f64>>>, Vec<f64>) {
        let along = |j: usize| self.oracle.along(&self.y, &self.oracle.unit(j));
        let laws = self.rows(self.oracle.law_forces_at_rest(&self.y));
        ((0..self.n()).map(along).collect(), plus(&self.gravity(), &laws))
    }

    /// The Hessian of `λᵀ (M v̇ + k − q)` by positions, velocities and accelerations, times a direction of these.
    pub fn hessian_along(&self, direction: [&[f64]; 3]) -> Vec<Vec<f64>> {
        let count = self.v.len();
        let padded = |x: &[f64]| x.iter().copied().chain(vec![0.0; count - x.len()]).collect::<Vec<_>>();
        let (lambda, direction) = (padded(&self.state.lambda), direction.map(padded));
        let entry = |by: usize, j: usize| {
            let still = vec![0.0; count];
            let dual = |x: &[f64], part: usize| -> Vec<HyperDual64> {
                let first = |k: usize| if part == by { unit(k, j) } else { 0.0 };
                (0..count).map(|k| HyperDual::new(x[k], first(k), direction[part][k], 0.0)).collect()
            };
            let y: Vec<_> = self.y.iter().map(|&y| HyperDual64::from(y)).collect();
            let y = moved(self.oracle.model, &y, &dual(&still, 0));
            self.oracle.work([&y, &dual(&self.v, 1), &dual(&self.a, 2)], &lambda).eps1eps2
        };
        [0, 1, 2].map(|by| (0..self.n()).map(|j| entry(by, j)).collect()).into()
    }

    /// The results of a function of the masses and their momentum.
    fn of_masses(&self, name: &str) -> Option<Vec<Vec<f64>>> {
        let oracle = &self.oracle;
        let by_unit = |j: usize| oracle.centroidal_momentum(&self.y, &oracle.unit(j));
        Some(match name {
            names::JOINT_WRENCHES => vec![oracle.joint_wrenches([&self.y, &self.v, &self.a])],
            names::CENTER_OF_MASS => vec![oracle.center_of_mass(&self.y).to_vec()],
            names::CENTER_OF_MASS_JACOBIAN => {
                let column =
                    |j: usize| oracle.center_of_mass(&oracle.along(&self.y, &oracle.unit(j))).map(|x| x.eps);
                vec![from_columns((0..self.v.len()).map(column).collect())]
            }
            names::CENTROIDAL_MOMENTUM => vec![oracle.centroidal_momentum(&self.y, &self.v).to_vec()],
            names::CENTROIDAL_MOMENTUM_MATRIX => {
                vec![from_columns((0..self.v.len()).map(by_unit).collect())]
            }
            _ => return None,
        })
    }

    /// The results of a function of a named frame.
    fn frame(&self, name: &str) -> Option<Vec<Vec<f64>>> {
        let is_called = |frame: &str, kind: FrameKind| kind.function(frame) == name;
        let mut of_frames =
            self.oracle.model.frames.iter().flat_map(|f| FrameKind::ALL.map(|kind| (f, kind)));
        let (frame, kind) = of_frames.find(|(frame, kind)| is_called(&frame.identifier, *kind))?;
        let (oracle, y) = (&self.oracle, &self.y);
        let column = |j: usize| oracle.jacobian_column(frame, y, j);
        Some(match kind {
            FrameKind::Pose => {
                let (origin, rotation) = oracle.frame(frame, y);
                vec![origin.to_vec(), rotation.as_flattened().to_vec()]
            }
            FrameKind::Jacobian => vec![from_columns((0..self.v.len()).map(column).collect())],
            FrameKind::JacobianRateTimesVelocity => {
                let mut rate = oracle.jacobian_rate_times_velocity(frame, y, &self.v);
                for j in self.n()..self.v.len() {
                    rate.iter_mut().zip(column(j)).for_each(|(rate, entry)| *rate += entry * self.a[j]);
                }
                vec![rate.to_vec()]
            }
        })
    }

    /// The results of a function, each flattened rows first; `None` for what is compared by products or slopes: parameters,
    /// regressors, the Hessian, and an energy with that of springs.
    ///
    /// # Panics
    /// The function is not known here: a new one needs its equation.
    pub fn results(&self, name: &str) -> Option<Vec<Vec<f64>>> {
        let (oracle, n) = (&self.oracle, self.n());
        let results = match name {
            names::MASS_MATRIX => vec![self.mass_matrix()],
            names::CORIOLIS_FORCES => vec![self.coriolis()],
            names::GRAVITY_FORCES => vec![self.gravity()],
            names::SPRING_FORCES => vec![self.springs()],
            names::FRICTION_TORQUES => vec![self.friction()],
            names::APPLIED_FORCES => vec![self.applied()],
            names::BIAS_FORCES => vec![minus(&self.coriolis(), &self.gravity())],
            names::INPUT_MATRIX => vec![self.input_matrix()],
            names::INPUT_FORCES_DERIVATIVES => {
                vec![self.inputs(&self.y), self.by_positions(|y| self.inputs(y))]
            }
            names::EQUATIONS_OF_MOTION => vec![self.mass_matrix(), self.coriolis(), self.applied()],
            names::MASS_MATRIX_AND_BIAS_FORCES => {
                vec![self.mass_matrix(), minus(&self.coriolis(), &self.gravity())]
            }
            names::INVERSE_DYNAMICS => vec![self.inverse_dynamics()],
            names::INVERSE_DYNAMICS_DERIVATIVES | names::INVERSE_DYNAMICS_DERIVATIVES_AND_MASS_MATRIX => {
                let mass = (name != names::INVERSE_DYNAMICS_DERIVATIVES).then(|| self.mass_matrix());
                std::iter::once(self.inverse_dynamics()).chain(self.slopes(&self.a)).chain(mass).collect()
            }
            names::INVERSE_DYNAMICS_DERIVATIVES_WITH_WRENCHES => {
                let [by_y, by_v] = self.slopes(&self.a);
                let forces = minus(&self.inverse_dynamics(), &self.wrench_forces());
                vec![forces, minus(&by_y, &self.wrench_slopes()), by_v]
            }
            names::INVERSE_DYNAMICS_WITH_WRENCHES => {
                vec![minus(&self.inverse_dynamics(), &self.wrench_forces())]
            }
            names::FORWARD_DYNAMICS => vec![self.forward_dynamics(&vec![0.0; n])],
            names::FORWARD_DYNAMICS_WITH_WRENCHES => vec![self.forward_dynamics(&self.wrench_forces())],
            names::FORWARD_DYNAMICS_DERIVATIVES => self.forward_derivatives(false),
            names::FORWARD_DYNAMICS_DERIVATIVES_WITH_WRENCHES => self.forward_derivatives(true),
            names::LINEARIZE => self.linearize(),
            names::KINETIC_ENERGY => vec![vec![oracle.kinetic_energy(&self.y, &self.v)]],
            names::POTENTIAL_ENERGY if oracle.model.point_forces.is_empty() => {
                vec![vec![oracle.potential_energy(&self.y)]]
            }
            names::WRENCH_FORCES => vec![self.wrench_forces()],
            names::WRENCH_FORCES_DERIVATIVES => vec![self.wrench_forces(), self.wrench_slopes()],
            names::DRIVING_FORCES => vec![oracle.inverse_dynamics(&self.y, &self.v, &self.a)[n..].to_vec()],
            names::INERTIAL_PARAMETERS
            | names::INERTIAL_REGRESSOR
            | names::BASE_REGRESSOR
            | names::FRICTION_PARAMETERS
            | names::FRICTION_REGRESSOR
            | names::INVERSE_DYNAMICS_HESSIAN
            | names::POTENTIAL_ENERGY => return None,
            other => {
                let found = self.of_masses(other).or_else(|| self.frame(other));
                found.unwrap_or_else(|| panic!("{other} has no equation here"))
            }
        };
        Some(results)
    }
}

/// A matrix by its columns, flattened rows first.
fn from_columns<const R: usize>(columns: Vec<[f64; R]>) -> Vec<f64> {
    (0..R).flat_map(|row| columns.iter().map(move |column| column[row])).collect()
}

fn rows_first(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Product of a matrix of `rows` rows with a vector.
fn times(matrix: &[f64], x: &[f64], rows: usize) -> Vec<f64> {
    let row = |i: usize| matrix[i * x.len()..].iter().zip(x).map(|(entry, x)| entry * x).sum();
    (0..rows).map(row).collect()
}
