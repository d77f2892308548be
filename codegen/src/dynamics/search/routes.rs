//! The cheapest formulation of each quantity of a model. A formulation is one way to write the equations, and
//! the cheapest formulation has the smallest weight of operations. It is searched when a quantity is first
//! used.

use std::cell::OnceCell;

use super::descent::{SearchSpace, cheapest, refined};
use crate::dynamics::formulation::Formulation;
use crate::dynamics::matrix::{FREE, Matrix, jacobian, subtract};
use crate::dynamics::parameters::base_parameters::BaseParameters;
use crate::dynamics::recursion::articulated;
use crate::dynamics::recursion::composite;
use crate::dynamics::recursion::derivatives::{ForceDerivatives, PairFrame, inverse_dynamics_derivatives};
use crate::dynamics::recursion::factorization::Factorization;
use crate::dynamics::recursion::motion::MotionInput;
use crate::dynamics::recursion::newton_euler;
use crate::graph::{Cost, Edge, Graph, Scalar, substitute};
use crate::kinematics::{Mechanism, Number};
use crate::model::Model;

/// Cheapest formulations of a model's quantities. Each formulation is searched when its quantity is first
/// used.
#[derive(Debug)]
pub struct Formulations<'m> {
    model: &'m Model,
    mechanism: &'m Mechanism<Number>,
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

/// Method to compute the accelerations from the forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForwardRoute {
    /// The mass matrix M is computed and factorized, `M = Lᵀ D L`, and `M ÿ = f` is solved for the forces f.
    Factorization,
    /// Recursion with articulated bodies, without the mass matrix M.
    ArticulatedBodies,
}

impl ForwardRoute {
    /// Accelerations for given joint forces and gravity, by coordinate.
    ///
    /// - `input`: state, with the accelerations of driven coordinates (with prescribed motion) and 0 for the
    ///   other accelerations
    /// - `forces`: joint forces without gravity, by coordinate
    pub fn accelerations<'g>(
        self,
        graph: &'g Graph,
        formulations: &Formulations<'_>,
        input: MotionInput<'_, 'g>,
        forces: impl FnOnce() -> Vec<Scalar<'g>>,
    ) -> Vec<Scalar<'g>> {
        match self {
            Self::Factorization => {
                let (matrix, bias) = formulations.mass_matrix_and_bias(graph, input);
                let factorization = Factorization::new(formulations.mechanism, &matrix);
                factorization.solve(&subtract(&forces(), &bias))
            }
            Self::ArticulatedBodies => {
                let mechanism = Formulation::plain(formulations.mechanism.bodies.len())
                    .mechanism(graph, formulations.mechanism);
                articulated::forward_dynamics(&mechanism, input.y, input.v, &forces())
            }
        }
    }

    /// Sentence about the method for the accelerations, for the documentation of a generated function.
    pub fn description(self) -> &'static str {
        match self {
            Self::Factorization => {
                "The factorization M = Lᵀ D L (Featherstone 2005) needed fewer operations than articulated bodies."
            }
            Self::ArticulatedBodies => {
                "Articulated bodies (Featherstone 2008, section 7.3) needed fewer operations than M and its factors."
            }
        }
    }
}

/// Method to differentiate the inverse dynamics with respect to positions and velocities.
#[derive(Debug, Clone, PartialEq)]
pub enum DerivativeRoute {
    /// Forward differentiation of the program of the inverse dynamics.
    Forward,
    /// Recursion with composite bodies (each body with all bodies beyond it). The derivatives for pairs of
    /// joints are computed in the [`PairFrame`].
    Composite(Formulation, PairFrame),
}

impl<'m> Formulations<'m> {
    /// Creates the formulations of a model and its mechanism, without a search.
    pub fn new(model: &'m Model, mechanism: &'m Mechanism<Number>) -> Self {
        Self {
            model,
            mechanism,
            space: SearchSpace::new(mechanism),
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

    /// Bodies, joints and rotors of the model.
    pub fn mechanism(&self) -> &'m Mechanism<Number> {
        self.mechanism
    }

    /// The method that computes the accelerations with fewer operations.
    pub fn forward_dynamics(&self) -> ForwardRoute {
        *self.forward_dynamics.get_or_init(|| {
            let weight = |route: ForwardRoute| {
                let weighed = weigh(self.mechanism, |graph, MotionInput { y, v, a }| {
                    let still = vec![graph.constant(0.0); y.len()];
                    route.accelerations(graph, self, MotionInput { y, v, a: &still }, || a.to_vec())
                });
                weighed.0
            };
            let routes = [ForwardRoute::ArticulatedBodies, ForwardRoute::Factorization];
            let is_tree = !self.mechanism.is_coupled()
                && !self.mechanism.has_quaternions()
                && self.mechanism.driven == 0
                && self.mechanism.rotors_are_neighbours();
            match is_tree && weight(routes[0]) < weight(routes[1]) {
                true => routes[0],
                false => routes[1],
            }
        })
    }

    /// The base parameters (identifiable combinations of inertial parameters) of the model.
    pub fn base_parameters(&self) -> &BaseParameters {
        self.base_parameters.get_or_init(|| BaseParameters::new(self.model, self.mechanism))
    }

    /// The cheapest formulation of the inverse dynamics.
    pub fn inverse_dynamics(&self) -> &Formulation {
        self.inverse_dynamics.get_or_init(|| {
            let weight =
                |formulation: &Formulation| recursion(self.mechanism, formulation, Moving::Accelerated);
            refined(&self.space, self.recursive(Moving::Accelerated), weight)
        })
    }

    /// The cheapest formulation of the bias forces (Coriolis forces minus gravity).
    pub fn bias_forces(&self) -> &Formulation {
        self.bias_forces.get_or_init(|| self.recursive_or_refined(Moving::Steadily))
    }

    /// The cheapest formulation of the gravity forces.
    pub fn gravity_forces(&self) -> &Formulation {
        self.gravity_forces.get_or_init(|| self.recursive_or_refined(Moving::Not))
    }

    fn recursive(&self, moving: Moving) -> Formulation {
        cheapest(&self.space, |formulation| recursion(self.mechanism, formulation, moving))
    }

    /// Returns the cheapest formulation of the plain search, or the formulation of the inverse dynamics if
    /// that one is cheaper. Only robots with quaternions are compared, because their search for the inverse
    /// dynamics is finer.
    fn recursive_or_refined(&self, moving: Moving) -> Formulation {
        let own = self.recursive(moving);
        if !self.mechanism.has_quaternions() {
            return own;
        }
        let weight = |formulation: &Formulation| recursion(self.mechanism, formulation, moving).0;
        let refined = self.inverse_dynamics();
        if weight(refined) < weight(&own) { refined.clone() } else { own }
    }

    /// The cheapest formulation of the mass matrix.
    pub fn mass_matrix(&self) -> &Formulation {
        self.mass_matrix.get_or_init(|| {
            cheapest(&self.space, |formulation| {
                weigh(self.mechanism, |graph, input| {
                    let mechanism = formulation.mechanism(graph, self.mechanism);
                    composite::mass_matrix(&mechanism, formulation, input.y).concat()
                })
            })
        })
    }

    /// The pair of formulations of the mass matrix and of the bias forces with the smallest total weight of
    /// operations. Common terms count once.
    pub fn mass_and_bias(&self) -> &(Formulation, Formulation) {
        self.mass_and_bias
            .get_or_init(|| self.cheapest_pair(&[self.mass_matrix(), self.bias_forces()], |_, _| Vec::new()))
    }

    /// Mass matrix `M(y)` and bias forces `k − q_gravity` (Coriolis forces minus gravity) in the formulations
    /// of [`Self::mass_and_bias`].
    pub fn mass_matrix_and_bias<'g>(
        &self,
        graph: &'g Graph,
        input: MotionInput<'_, 'g>,
    ) -> (Matrix<'g>, Vec<Scalar<'g>>) {
        let (mass, bias) = self.mass_and_bias();
        self.mass_matrix_and_bias_by(mass, bias, graph, input)
    }

    fn mass_matrix_and_bias_by<'g>(
        &self,
        mass: &Formulation,
        bias: &Formulation,
        graph: &'g Graph,
        input: MotionInput<'_, 'g>,
    ) -> (Matrix<'g>, Vec<Scalar<'g>>) {
        let matrix = composite::mass_matrix(&mass.mechanism(graph, self.mechanism), mass, input.y);
        (matrix, newton_euler::inverse_dynamics(&bias.mechanism(graph, self.mechanism), bias, input))
    }

    /// The pair of formulations of the mass matrix and of the bias forces that is cheapest if the derivatives
    /// of the inverse dynamics are also computed. Its total weight of operations is the smallest; common
    /// terms count once.
    pub fn mass_and_bias_beside_derivatives(&self) -> &(Formulation, Formulation) {
        self.beside_derivatives.get_or_init(|| {
            let mut candidates = vec![self.mass_matrix(), self.bias_forces()];
            if let DerivativeRoute::Composite(formulation, _) = self.derivatives() {
                candidates.push(formulation);
            }
            if self.mechanism.bodies.len() > LARGEST_SEARCHED {
                return (self.mass_matrix().clone(), self.bias_forces().clone());
            }
            self.cheapest_pair(&candidates, |graph, input| {
                let result = self.derivatives().derive(graph, self.mechanism, self.inverse_dynamics(), input);
                [result.by_coordinates.concat(), result.by_velocities.concat()].concat()
            })
        })
    }

    /// The pair of formulations of the mass matrix and of the bias forces that has the smallest total weight
    /// together with the results of `beside`.
    fn cheapest_pair(
        &self,
        candidates: &[&Formulation],
        beside: impl for<'g> Fn(&'g Graph, MotionInput<'_, 'g>) -> Vec<Scalar<'g>>,
    ) -> (Formulation, Formulation) {
        let weight = |mass: &Formulation, bias: &Formulation| {
            let (weight, _) = weigh(self.mechanism, |graph, input| {
                let still = vec![graph.constant(0.0); input.y.len()];
                let steady = MotionInput { a: &still, ..input };
                let (matrix, forces) = self.mass_matrix_and_bias_by(mass, bias, graph, steady);
                [matrix.concat(), forces, beside(graph, input)].concat()
            });
            weight
        };
        let pairs = candidates.iter().flat_map(|mass| candidates.iter().map(move |bias| (*mass, *bias)));
        let best = pairs.min_by_key(|(mass, bias)| weight(mass, bias));
        best.map_or_else(
            || (self.mass_matrix().clone(), self.bias_forces().clone()),
            |(mass, bias)| (mass.clone(), bias.clone()),
        )
    }

    /// The cheapest method to compute the derivatives of the inverse dynamics.
    pub fn derivatives(&self) -> &DerivativeRoute {
        self.derivatives.get_or_init(|| self.cheapest_derivatives())
    }

    fn cheapest_derivatives(&self) -> DerivativeRoute {
        let (mechanism, inverse) = (self.mechanism, self.inverse_dynamics());
        let weight = |route: &DerivativeRoute| {
            weigh(mechanism, |graph, input| {
                let result = route.derive(graph, mechanism, inverse, input);
                [result.forces, result.by_coordinates.concat(), result.by_velocities.concat()].concat()
            })
        };
        let composite =
            |formulation: &Formulation, pairs| DerivativeRoute::Composite(formulation.clone(), pairs);
        let mut routes = vec![composite(&inverse.massless(), PairFrame::Links)];
        if !mechanism.has_quaternions() {
            routes.push(composite(&inverse.massless().in_metres(), PairFrame::Root));
        }
        if mechanism.bodies.len() <= LARGEST_SEARCHED {
            let links =
                cheapest(&self.space, |formulation| weight(&composite(formulation, PairFrame::Links)));
            routes.push(composite(&links, PairFrame::Links));
        }
        if mechanism.bodies.len() <= LARGEST_FORWARD && !mechanism.has_quaternions() {
            routes.push(DerivativeRoute::Forward);
        }
        let best =
            routes.iter().enumerate().min_by_key(|(_, route)| weight(route).0).map_or(0, |(index, _)| index);
        routes.swap_remove(best)
    }
}

/// Largest number of bodies for which formulations of the derivatives are searched. For more bodies the
/// search takes too long, and the formulation of the inverse dynamics is nearly as good.
const LARGEST_SEARCHED: usize = 12;

/// Largest number of bodies for which forward differentiation is tried. It has never been the cheapest method
/// for more than three joints.
const LARGEST_FORWARD: usize = 4;

impl DerivativeRoute {
    /// Computes the inverse dynamics, their derivatives with respect to y and ẏ, and the mass matrix.
    ///
    /// - `inverse`: formulation of the inverse dynamics
    pub fn derive<'g>(
        &self,
        graph: &'g Graph,
        mechanism: &Mechanism<Number>,
        inverse: &Formulation,
        input: MotionInput<'_, 'g>,
    ) -> ForceDerivatives<'g> {
        match self {
            Self::Composite(formulation, pairs) => inverse_dynamics_derivatives(
                &formulation.mechanism(graph, mechanism),
                formulation,
                *pairs,
                input,
            ),
            Self::Forward => differentiate_forwards(graph, mechanism, inverse, input),
        }
    }

    /// Sentence about the method for the derivatives, for the documentation of a generated function.
    pub fn description(&self) -> &'static str {
        match self {
            Self::Forward => "Forward differentiation of the inverse dynamics needed the fewest operations.",
            Self::Composite(_, PairFrame::Links) => {
                "Composite bodies with pairs of joints in link frames needed the fewest operations."
            }
            Self::Composite(_, PairFrame::Root) => {
                "Composite bodies with pairs of joints in the frame of the first body needed the fewest operations."
            }
        }
    }
}

/// Inverse dynamics and their derivatives by forward differentiation. Accelerations that are expressions of
/// the state are treated as constants.
fn differentiate_forwards<'g>(
    graph: &'g Graph,
    mechanism: &Mechanism<Number>,
    formulation: &Formulation,
    input: MotionInput<'_, 'g>,
) -> ForceDerivatives<'g> {
    let MotionInput { y, v, a } = input;
    let free: Vec<_> = (0..a.len()).map(|k| graph.input(FREE, k)).collect();
    let mechanism = formulation.mechanism(graph, mechanism);
    let forces = newton_euler::inverse_dynamics(&mechanism, formulation, MotionInput { y, v, a: &free });
    let at = |matrix: Matrix<'g>| -> Matrix<'g> {
        matrix.iter().map(|row| substitute(graph, row, &free, a)).collect()
    };
    ForceDerivatives {
        by_coordinates: at(jacobian(graph, &forces, y)),
        by_velocities: at(jacobian(graph, &forces, v)),
        mass_matrix: at(jacobian(graph, &forces, &free)),
        forces: substitute(graph, &forces, &free, a),
    }
}

/// Motion for which the operations of a recursion are counted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Moving {
    /// Velocities and accelerations are non-zero, as in the inverse dynamics.
    Accelerated,
    /// Only velocities are non-zero, as in the bias forces.
    Steadily,
    /// Velocities and accelerations are zero, as in the gravity forces.
    Not,
}

/// Weight of the operations of the recursive inverse dynamics, and number of the graph's nodes.
fn recursion(mechanism: &Mechanism<Number>, formulation: &Formulation, moving: Moving) -> (u64, usize) {
    weigh(mechanism, |graph, MotionInput { y, v, a }| {
        let still = vec![graph.constant(0.0); y.len()];
        let input = match moving {
            Moving::Accelerated => MotionInput { y, v, a },
            Moving::Steadily => MotionInput { y, v, a: &still },
            Moving::Not => MotionInput { y, v: &still, a: &still },
        };
        newton_euler::inverse_dynamics(&formulation.mechanism(graph, mechanism), formulation, input)
    })
}

/// Weight of the operations of a computation over a mechanism, and number of the graph's nodes.
fn weigh<F>(mechanism: &Mechanism<Number>, build: F) -> (u64, usize)
where
    F: for<'a> FnOnce(&'a Graph, MotionInput<'_, 'a>) -> Vec<Scalar<'a>>,
{
    let graph = Graph::new();
    let y = mechanism.positions_on(&graph);
    let [v, a]: [Vec<_>; 2] =
        [1, 2].map(|array| (0..mechanism.coordinates).map(|k| graph.input(array, k)).collect());
    let input = MotionInput { y: &y, v: &v, a: &a };
    let results: Vec<Edge> = build(&graph, input).iter().map(|x| x.edge()).collect();
    (Cost::of(&graph, &results).weight(), graph.len())
}
