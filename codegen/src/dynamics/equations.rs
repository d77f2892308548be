//! The equations of motion of one robot over a graph: every quantity once, from the cheapest formulation.

use std::cell::OnceCell;

use super::articulated;
use super::base_parameters::BaseParameters;
use super::composite;
use super::derivatives::{ForceDerivatives, PairFrame, inverse_dynamics_derivatives};
use super::factorization::Factorization;
use super::forces;
use super::formulation::{Formulation, SearchSpace, cheapest};
use super::frame_motion::BasePoses;
use super::matrix::Matrix;
use super::newton_euler::{self, MotionInput};
use super::regressor;
use crate::graph::{Cost, Edge, Graph, Scalar, differentiate, substitute};
use crate::kinematics::{Mechanism, RegroupChoice};
use crate::model::Model;
use crate::spatial::Vector3;

/// The cheapest formulations of a model, each searched for when it is first needed.
#[derive(Debug)]
pub struct Formulations<'m> {
    model: &'m Model,
    space: SearchSpace,
    inverse_dynamics: OnceCell<Formulation>,
    bias_forces: OnceCell<Formulation>,
    gravity_forces: OnceCell<Formulation>,
    mass_matrix: OnceCell<Formulation>,
    derivatives: OnceCell<DerivativeRoute>,
    mass_and_bias: OnceCell<(Formulation, Formulation)>,
    beside_derivatives: OnceCell<(Formulation, Formulation)>,
    base_parameters: OnceCell<BaseParameters>,
    forward_dynamics: OnceCell<ForwardRoute>,
}

/// How the accelerations are solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForwardRoute {
    /// By M and its factors.
    Factorization,
    /// By articulated bodies.
    ArticulatedBodies,
}

impl ForwardRoute {
    /// What the documentation says about it.
    pub fn description(self) -> &'static str {
        match self {
            Self::Factorization => {
                "M = Lᵀ D L along the branches of the tree (Featherstone 2005) was cheaper than articulated bodies."
            }
            Self::ArticulatedBodies => {
                "Articulated bodies (Featherstone 2008, section 7.3) were cheaper than M and its factors."
            }
        }
    }
}

/// How the inverse dynamics are differentiated.
#[derive(Debug, Clone, PartialEq)]
pub enum DerivativeRoute {
    /// By the program of the inverse dynamics, forwards.
    Forward,
    /// By composite bodies.
    Composite(Formulation, PairFrame),
}

impl<'m> Formulations<'m> {
    /// Of a model; nothing is searched for yet.
    pub fn new(model: &'m Model) -> Self {
        Self {
            model,
            space: SearchSpace::new(model),
            inverse_dynamics: OnceCell::new(),
            bias_forces: OnceCell::new(),
            gravity_forces: OnceCell::new(),
            mass_matrix: OnceCell::new(),
            derivatives: OnceCell::new(),
            mass_and_bias: OnceCell::new(),
            beside_derivatives: OnceCell::new(),
            base_parameters: OnceCell::new(),
            forward_dynamics: OnceCell::new(),
        }
    }

    /// The cheaper way to the accelerations.
    pub fn forward_dynamics(&self) -> ForwardRoute {
        *self.forward_dynamics.get_or_init(|| {
            let is_possible = {
                let graph = Graph::new();
                Mechanism::new(&graph, self.model).rotors_are_neighbours()
            };
            let weight = |route| {
                let weighed = weigh(self.model, |graph, input| {
                    let equations = Equations {
                        graph,
                        model: self.model,
                        formulations: self,
                    };
                    equations.accelerations(route, input.y, input.v, || input.a.to_vec())
                });
                weighed.0
            };
            let routes = [ForwardRoute::ArticulatedBodies, ForwardRoute::Factorization];
            match is_possible && weight(routes[0]) < weight(routes[1]) {
                true => routes[0],
                false => routes[1],
            }
        })
    }

    /// The base parameters.
    pub fn base_parameters(&self) -> &BaseParameters {
        self.base_parameters
            .get_or_init(|| BaseParameters::new(self.model))
    }

    /// Of the inverse dynamics.
    pub fn inverse_dynamics(&self) -> &Formulation {
        self.inverse_dynamics
            .get_or_init(|| self.recursive(Moving::Accelerated))
    }

    /// Of the bias forces: without accelerations.
    pub fn bias_forces(&self) -> &Formulation {
        self.bias_forces
            .get_or_init(|| self.recursive(Moving::Steadily))
    }

    /// Of gravity alone.
    pub fn gravity_forces(&self) -> &Formulation {
        self.gravity_forces
            .get_or_init(|| self.recursive(Moving::Not))
    }

    fn recursive(&self, moving: Moving) -> Formulation {
        cheapest(&self.space, |formulation| {
            recursion(self.model, formulation, moving)
        })
    }

    /// Of the mass matrix.
    pub fn mass_matrix(&self) -> &Formulation {
        self.mass_matrix.get_or_init(|| {
            cheapest(&self.space, |formulation| {
                weigh(self.model, |graph, input| {
                    let mechanism = formulation.mechanism(graph, self.model);
                    composite::mass_matrix(&mechanism, formulation, input.y).concat()
                })
            })
        })
    }

    /// Of M and the bias forces where both are needed: what they share is computed once.
    pub fn mass_and_bias(&self) -> &(Formulation, Formulation) {
        self.mass_and_bias.get_or_init(|| {
            self.cheapest_pair(&[self.mass_matrix(), self.bias_forces()], |_, _| Vec::new())
        })
    }

    /// Of M and the bias forces beside the derivatives of the inverse dynamics.
    pub fn mass_and_bias_beside_derivatives(&self) -> &(Formulation, Formulation) {
        self.beside_derivatives.get_or_init(|| {
            let mut candidates = vec![self.mass_matrix(), self.bias_forces()];
            if let DerivativeRoute::Composite(formulation, _) = self.derivatives() {
                candidates.push(formulation);
            }
            if self.model.coordinates.len() > LARGEST_SEARCHED {
                return (self.mass_matrix().clone(), self.bias_forces().clone());
            }
            self.cheapest_pair(&candidates, |graph, input| {
                let result =
                    self.derivatives()
                        .derive(graph, self.model, self.inverse_dynamics(), input);
                [
                    result.by_coordinates.concat(),
                    result.by_velocities.concat(),
                ]
                .concat()
            })
        })
    }

    /// The pair of formulations of M and the bias forces that costs least beside other results.
    fn cheapest_pair(
        &self,
        candidates: &[&Formulation],
        beside: impl for<'g> Fn(&'g Graph, MotionInput<'_, 'g>) -> Vec<Scalar<'g>>,
    ) -> (Formulation, Formulation) {
        let weight = |mass: &Formulation, bias: &Formulation| {
            let (weight, _) = weigh(self.model, |graph, input| {
                let still = vec![graph.constant(0.0); input.y.len()];
                let matrix =
                    composite::mass_matrix(&mass.mechanism(graph, self.model), mass, input.y);
                let steady = MotionInput { a: &still, ..input };
                let forces = newton_euler::inverse_dynamics(
                    &bias.mechanism(graph, self.model),
                    bias,
                    steady,
                );
                [matrix.concat(), forces, beside(graph, input)].concat()
            });
            weight
        };
        let pairs = candidates
            .iter()
            .flat_map(|mass| candidates.iter().map(move |bias| (*mass, *bias)));
        let best = pairs.min_by_key(|(mass, bias)| weight(mass, bias));
        best.map_or_else(
            || (self.mass_matrix().clone(), self.bias_forces().clone()),
            |(mass, bias)| (mass.clone(), bias.clone()),
        )
    }

    /// Of the derivatives of the inverse dynamics.
    pub fn derivatives(&self) -> &DerivativeRoute {
        self.derivatives.get_or_init(|| self.cheapest_derivatives())
    }

    fn cheapest_derivatives(&self) -> DerivativeRoute {
        let (model, inverse) = (self.model, self.inverse_dynamics());
        let weight = |route: &DerivativeRoute| {
            weigh(model, |graph, input| {
                let result = route.derive(graph, model, inverse, input);
                [
                    result.forces,
                    result.by_coordinates.concat(),
                    result.by_velocities.concat(),
                ]
                .concat()
            })
        };
        let composite = |formulation: &Formulation, pairs| {
            DerivativeRoute::Composite(formulation.clone(), pairs)
        };
        let mut routes = vec![
            composite(&inverse.massless(), PairFrame::Links),
            composite(&inverse.massless().in_metres(), PairFrame::Root),
        ];
        if model.coordinates.len() <= LARGEST_SEARCHED {
            let links = cheapest(&self.space, |formulation| {
                weight(&composite(formulation, PairFrame::Links))
            });
            routes.push(composite(&links, PairFrame::Links));
        }
        if model.coordinates.len() <= LARGEST_FORWARD {
            routes.push(DerivativeRoute::Forward);
        }
        let best = routes
            .iter()
            .enumerate()
            .min_by_key(|(_, route)| weight(route).0)
            .map_or(0, |(index, _)| index);
        routes.swap_remove(best)
    }
}

/// Beyond so many joints a search among the derivatives takes longer than it saves: the formulation of the inverse
/// dynamics serves them as well.
const LARGEST_SEARCHED: usize = 12;

/// Forward differentiation of the program never paid beyond three joints.
const LARGEST_FORWARD: usize = 4;

impl DerivativeRoute {
    fn derive<'g>(
        &self,
        graph: &'g Graph,
        model: &Model,
        inverse: &Formulation,
        input: MotionInput<'_, 'g>,
    ) -> ForceDerivatives<'g> {
        match self {
            Self::Composite(formulation, pairs) => inverse_dynamics_derivatives(
                &formulation.mechanism(graph, model),
                formulation,
                *pairs,
                input,
            ),
            Self::Forward => differentiate_forwards(graph, model, inverse, input),
        }
    }

    /// What the documentation says about it.
    pub fn description(&self) -> &'static str {
        match self {
            Self::Forward => "Forward differentiation of the inverse dynamics was cheapest.",
            Self::Composite(_, PairFrame::Links) => {
                "Composite bodies with pairs of joints in link frames were cheapest."
            }
            Self::Composite(_, PairFrame::Root) => {
                "Composite bodies with pairs of joints in the frame of the first body were cheapest."
            }
        }
    }
}

/// Inverse dynamics and its derivatives by their program, at accelerations that may themselves depend on the state.
fn differentiate_forwards<'g>(
    graph: &'g Graph,
    model: &Model,
    formulation: &Formulation,
    input: MotionInput<'_, 'g>,
) -> ForceDerivatives<'g> {
    let MotionInput { y, v, a } = input;
    let free: Vec<_> = (0..a.len())
        .map(|k| graph.input(FREE_ACCELERATIONS, k))
        .collect();
    let mechanism = formulation.mechanism(graph, model);
    let forces =
        newton_euler::inverse_dynamics(&mechanism, formulation, MotionInput { y, v, a: &free });
    let at = |matrix: Matrix<'g>| -> Matrix<'g> {
        matrix
            .iter()
            .map(|row| substitute(graph, row, &free, a))
            .collect()
    };
    ForceDerivatives {
        by_coordinates: at(jacobian(graph, &forces, y)),
        by_velocities: at(jacobian(graph, &forces, v)),
        mass_matrix: at(jacobian(graph, &forces, &free)),
        forces: substitute(graph, &forces, &free, a),
    }
}

/// Input array that no function has: it stands for the accelerations while they are differentiated by.
const FREE_ACCELERATIONS: usize = 1 << 20;

/// `∂ results / ∂ variables`, row i = result i.
pub fn jacobian<'g>(
    graph: &'g Graph,
    results: &[Scalar<'g>],
    variables: &[Scalar<'g>],
) -> Matrix<'g> {
    let columns: Vec<_> = variables
        .iter()
        .map(|&variable| differentiate(graph, results, variable))
        .collect();
    (0..results.len())
        .map(|row| columns.iter().map(|column| column[row]).collect())
        .collect()
}

/// What moves when a recursion is weighed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Moving {
    /// Velocities and accelerations.
    Accelerated,
    /// Velocities.
    Steadily,
    /// Nothing.
    Not,
}

/// Weight of the recursive equations.
fn recursion(model: &Model, formulation: &Formulation, moving: Moving) -> (u64, usize) {
    weigh(model, |graph, MotionInput { y, v, a }| {
        let still = vec![graph.constant(0.0); y.len()];
        let input = match moving {
            Moving::Accelerated => MotionInput { y, v, a },
            Moving::Steadily => MotionInput { y, v, a: &still },
            Moving::Not => MotionInput {
                y,
                v: &still,
                a: &still,
            },
        };
        newton_euler::inverse_dynamics(&formulation.mechanism(graph, model), formulation, input)
    })
}

/// Weight of a computation, and the nodes that it took.
fn weigh<F>(model: &Model, build: F) -> (u64, usize)
where
    F: for<'a> FnOnce(&'a Graph, MotionInput<'_, 'a>) -> Vec<Scalar<'a>>,
{
    let graph = Graph::new();
    let [y, v, a]: [Vec<_>; 3] = [0, 1, 2].map(|array| {
        (0..model.coordinates.len())
            .map(|k| graph.input(array, k))
            .collect()
    });
    let input = MotionInput {
        y: &y,
        v: &v,
        a: &a,
    };
    let results: Vec<Edge> = build(&graph, input).iter().map(|x| x.edge()).collect();
    (Cost::of(&graph, &results).weight(), graph.len())
}

/// Accelerations and their derivatives.
#[derive(Debug, Clone)]
pub struct AccelerationDerivatives<'g> {
    /// ÿ
    pub accelerations: Vec<Scalar<'g>>,
    /// ∂ÿ/∂y
    pub by_coordinates: Matrix<'g>,
    /// ∂ÿ/∂ẏ
    pub by_velocities: Matrix<'g>,
    /// M⁻¹
    pub inverse: Matrix<'g>,
}

/// `ÿ = A_y y + A_v ẏ + B_x u + c`
#[derive(Debug, Clone)]
pub struct AffineAccelerations<'g> {
    /// A_y
    pub by_coordinates: Matrix<'g>,
    /// A_v
    pub by_velocities: Matrix<'g>,
    /// B_x
    pub by_inputs: Matrix<'g>,
    /// c
    pub remainder: Vec<Scalar<'g>>,
}

/// The equations of motion of a model on one graph.
#[derive(Debug, Clone, Copy)]
pub struct Equations<'a, 'g> {
    /// The graph.
    pub graph: &'g Graph,
    /// The model.
    pub model: &'a Model,
    /// How each quantity is derived.
    pub formulations: &'a Formulations<'a>,
}

impl<'g> Equations<'_, 'g> {
    fn zeros(&self) -> Vec<Scalar<'g>> {
        vec![self.graph.constant(0.0); self.model.coordinates.len()]
    }

    fn recursive(
        &self,
        formulation: &Formulation,
        input: MotionInput<'_, 'g>,
        with_gravity: bool,
    ) -> Vec<Scalar<'g>> {
        let mut mechanism = formulation.mechanism(self.graph, self.model);
        if !with_gravity {
            mechanism.gravity = Vector3::zero(self.graph.constant(0.0));
        }
        newton_euler::inverse_dynamics(&mechanism, formulation, input)
    }

    /// `M(y)`
    pub fn mass_matrix(&self, y: &[Scalar<'g>]) -> Matrix<'g> {
        self.mass_matrix_by(self.formulations.mass_matrix(), y)
    }

    fn mass_matrix_by(&self, formulation: &Formulation, y: &[Scalar<'g>]) -> Matrix<'g> {
        composite::mass_matrix(
            &formulation.mechanism(self.graph, self.model),
            formulation,
            y,
        )
    }

    /// `M(y)` and `k − q_gravity` in the formulations that cost least together.
    pub fn mass_matrix_and_bias(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
    ) -> (Matrix<'g>, Vec<Scalar<'g>>) {
        let (mass, bias) = self.formulations.mass_and_bias();
        (self.mass_matrix_by(mass, y), self.bias_by(bias, y, v))
    }

    fn bias_by(
        &self,
        formulation: &Formulation,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        self.recursive(
            formulation,
            MotionInput {
                y,
                v,
                a: &self.zeros(),
            },
            true,
        )
    }

    /// `k(y, ẏ)`
    pub fn coriolis_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        self.recursive(
            self.formulations.bias_forces(),
            MotionInput {
                y,
                v,
                a: &self.zeros(),
            },
            false,
        )
    }

    /// Gravity's share of q.
    pub fn gravity_forces(&self, y: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let still = self.zeros();
        let held = self.recursive(
            self.formulations.gravity_forces(),
            MotionInput {
                y,
                v: &still,
                a: &still,
            },
            true,
        );
        held.into_iter().map(|x| -x).collect()
    }

    /// `k − q_gravity`
    pub fn bias_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        self.recursive(
            self.formulations.bias_forces(),
            MotionInput {
                y,
                v,
                a: &self.zeros(),
            },
            true,
        )
    }

    /// Springs' and dampers' share of q.
    pub fn spring_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        forces::spring_forces(self.graph, self.model, y, v)
    }

    /// τ(ẏ), or τ(y, ẏ) where a law depends on the position; `y` may be empty where none does.
    pub fn friction_torques(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        forces::friction_torques(self.graph, self.model, y, v)
    }

    /// Springs and friction: what acts on single joints, as a share of q.
    pub fn joint_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        subtract(&self.spring_forces(y, v), &self.friction_torques(y, v))
    }

    /// `q = q_gravity + q_springs − τ`
    pub fn applied_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let joint = self.joint_forces(y, v);
        self.gravity_forces(y)
            .iter()
            .zip(&joint)
            .map(|(&gravity, &joint)| gravity + joint)
            .collect()
    }

    /// `M ÿ + k − q`
    pub fn inverse_dynamics(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        a: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        let bodies = self.recursive(
            self.formulations.inverse_dynamics(),
            MotionInput { y, v, a },
            true,
        );
        subtract(&bodies, &self.joint_forces(y, v))
    }

    /// `M ÿ + k − q` with its derivatives by y and ẏ, and M.
    pub fn inverse_dynamics_derivatives(&self, input: MotionInput<'_, 'g>) -> ForceDerivatives<'g> {
        let (derivatives, inverse_dynamics) = (
            self.formulations.derivatives(),
            self.formulations.inverse_dynamics(),
        );
        let mut result = derivatives.derive(self.graph, self.model, inverse_dynamics, input);
        let joint = self.joint_forces(input.y, input.v);
        for (row, &force) in joint.iter().enumerate() {
            // What acts on single joints has diagonal derivatives.
            let by = |variable| differentiate(self.graph, &[force], variable)[0];
            let (y, v) = (
                &mut result.by_coordinates[row][row],
                &mut result.by_velocities[row][row],
            );
            (*y, *v) = (*y - by(input.y[row]), *v - by(input.v[row]));
        }
        result.forces = subtract(&result.forces, &joint);
        result
    }

    /// Accelerations with their derivatives by y, ẏ and the joint forces (M⁻¹).
    pub fn forward_dynamics_derivatives(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> AccelerationDerivatives<'g> {
        let (mass, bias) = self.formulations.mass_and_bias_beside_derivatives();
        let matrix = self.mass_matrix_by(mass, y);
        let factorization = Factorization::new(&Mechanism::new(self.graph, self.model), &matrix);
        let inverse = factorization.inverse(self.graph);
        let accelerating = subtract(&self.driving_forces(y, v, u), &self.bias_by(bias, y, v));
        let by_inverse = self.weighs_less_by_inverse(&factorization, &inverse);
        let solve = |right: &[Scalar<'g>]| match by_inverse {
            true => inverse
                .iter()
                .map(|row| dot(self.graph, row, right))
                .collect(),
            false => factorization.solve(right),
        };
        let solve_negative = |right: &Matrix<'g>| {
            let columns: Vec<Vec<_>> = (0..y.len())
                .map(|j| solve(&right.iter().map(|row| -row[j]).collect::<Vec<_>>()))
                .collect();
            (0..y.len())
                .map(|i| columns.iter().map(|column| column[i]).collect())
                .collect()
        };
        let accelerations = solve(&accelerating);
        let forces = self.inverse_dynamics_derivatives(MotionInput {
            y,
            v,
            a: &accelerations,
        });
        AccelerationDerivatives {
            by_coordinates: solve_negative(&forces.by_coordinates),
            by_velocities: solve_negative(&forces.by_velocities),
            inverse,
            accelerations,
        }
    }

    /// Whether products with M⁻¹ cost no more than solutions by the factors. The products are preferred where both
    /// cost the same: their terms do not wait for each other.
    fn weighs_less_by_inverse(
        &self,
        factorization: &Factorization<'g>,
        inverse: &Matrix<'g>,
    ) -> bool {
        let right: Vec<_> = (0..inverse.len())
            .map(|k| self.graph.input(FREE_ACCELERATIONS, k))
            .collect();
        let weight = |results: Vec<Scalar<'g>>| {
            let all: Vec<Edge> = inverse
                .concat()
                .iter()
                .chain(&results)
                .map(|result| result.edge())
                .collect();
            Cost::of(self.graph, &all).weight()
        };
        let product = inverse
            .iter()
            .map(|row| dot(self.graph, row, &right))
            .collect();
        weight(product) <= weight(factorization.solve(&right))
    }

    /// `ÿ = A_y y + A_v ẏ + B_x u + c` at a state and input.
    pub fn linearize(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> AffineAccelerations<'g> {
        let derivatives = self.forward_dynamics_derivatives(y, v, u);
        let input_matrix = forces::input_matrix(self.graph, self.model);
        let zero = self.graph.constant(0.0);
        let by_inputs: Matrix<'g> = derivatives
            .inverse
            .iter()
            .map(|row| {
                (0..u.len())
                    .map(|j| {
                        row.iter()
                            .zip(&input_matrix)
                            .fold(zero, |sum, (&x, b)| sum + x * b[j])
                    })
                    .collect()
            })
            .collect();
        let remainder = (0..y.len()).map(|i| {
            let known = dot(self.graph, &derivatives.by_coordinates[i], y)
                + dot(self.graph, &derivatives.by_velocities[i], v)
                + dot(self.graph, &by_inputs[i], u);
            derivatives.accelerations[i] - known
        });
        let remainder = remainder.collect();
        let AccelerationDerivatives {
            by_coordinates,
            by_velocities,
            ..
        } = derivatives;
        AffineAccelerations {
            by_coordinates,
            by_velocities,
            by_inputs,
            remainder,
        }
    }

    /// `B u`
    pub fn input_forces(&self, u: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let matrix = forces::input_matrix(self.graph, self.model);
        let zero = self.graph.constant(0.0);
        matrix
            .iter()
            .map(|row| row.iter().zip(u).fold(zero, |sum, (&b, &u)| sum + b * u))
            .collect()
    }

    /// `M⁻¹ (q + B u − k)`
    pub fn forward_dynamics(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        let route = self.formulations.forward_dynamics();
        self.accelerations(route, y, v, || self.driving_forces(y, v, u))
    }

    /// What joint forces, gravity and motion make of the accelerations.
    fn accelerations(
        &self,
        route: ForwardRoute,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        forces: impl FnOnce() -> Vec<Scalar<'g>>,
    ) -> Vec<Scalar<'g>> {
        match route {
            ForwardRoute::Factorization => {
                let (matrix, bias) = self.mass_matrix_and_bias(y, v);
                let mechanism = Mechanism::new(self.graph, self.model);
                Factorization::new(&mechanism, &matrix).solve(&subtract(&forces(), &bias))
            }
            ForwardRoute::ArticulatedBodies => {
                let mechanism = Formulation::plain(y.len()).mechanism(self.graph, self.model);
                articulated::forward_dynamics(&mechanism, y, v, &forces())
            }
        }
    }

    /// `B u`, springs and friction.
    pub(super) fn driving_forces(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        self.input_forces(u)
            .into_iter()
            .zip(self.joint_forces(y, v))
            .map(|(a, b)| a + b)
            .collect()
    }

    /// W with `W π = M ÿ + k − q_gravity`
    pub fn inertial_regressor(&self, input: MotionInput<'_, 'g>) -> Matrix<'g> {
        let mechanism = Mechanism::new(self.graph, self.model);
        regressor::inertial_regressor(&mechanism, self.model, input)
    }

    /// The columns of W that lead a group of base parameters.
    pub fn base_regressor(&self, input: MotionInput<'_, 'g>) -> Matrix<'g> {
        let leaders = &self.formulations.base_parameters().leaders;
        let rows = self.inertial_regressor(input).into_iter();
        rows.map(|row| leaders.iter().map(|&column| row[column]).collect())
            .collect()
    }

    /// `½ ẏᵀ M ẏ`, as the work of what accelerates by ẏ from rest.
    pub fn kinetic_energy(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Scalar<'g> {
        let formulation = self.formulations.inverse_dynamics();
        let momentum = self.recursive(
            formulation,
            MotionInput {
                y,
                v: &self.zeros(),
                a: v,
            },
            false,
        );
        dot(self.graph, &momentum, v) * 0.5
    }

    /// `−g · Σ m c` over the moving bodies.
    pub fn potential_energy(&self, y: &[Scalar<'g>]) -> Scalar<'g> {
        let plain = Formulation::plain(self.model.coordinates.len());
        let choices = vec![RegroupChoice::Massless; plain.bodies.len()];
        let mechanism = Mechanism::new(self.graph, self.model).regrouped(&choices);
        -mechanism
            .gravity
            .dot(composite::first_moment(&mechanism, &plain, y))
    }

    /// The bodies as seen from the base.
    pub fn base_poses(&self, y: &[Scalar<'g>]) -> BasePoses<'g> {
        BasePoses::new(Mechanism::new(self.graph, self.model), y)
    }
}

/// `a − b`
pub fn subtract<'g>(a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

/// `a · b`
pub fn dot<'g>(graph: &'g Graph, a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Scalar<'g> {
    a.iter()
        .zip(b)
        .fold(graph.constant(0.0), |sum, (&a, &b)| sum + a * b)
}
