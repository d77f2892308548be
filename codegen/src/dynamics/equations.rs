//! The equations of motion of one robot over a graph: every quantity once, from the cheapest formulation.

use super::composite;
use super::factorization::Factorization;
use super::forces;
use super::formulation::{Formulation, SearchSpace, cheapest};
use super::frame_motion::BasePoses;
use super::newton_euler::{self, MotionInput};
use crate::graph::{Cost, Edge, Graph, Scalar, Vector3};
use crate::kinematics::{Mechanism, RegroupChoice};
use crate::model::Model;

/// A matrix over the graph, rows first.
pub type Matrix<'g> = Vec<Vec<Scalar<'g>>>;

/// The cheapest formulations of a model, found once and used by every function.
#[derive(Debug, Clone)]
pub struct Formulations {
    /// Of the inverse dynamics.
    pub inverse_dynamics: Formulation,
    /// Of the bias forces: without accelerations.
    pub bias_forces: Formulation,
    /// Of the mass matrix.
    pub mass_matrix: Formulation,
}

impl Formulations {
    /// Searches for them.
    pub fn search(model: &Model) -> Self {
        let space = SearchSpace::new(model);
        let recursive = |accelerated: bool| {
            cheapest(&space, |formulation| {
                weigh(model, |graph, y, v, a| {
                    let still = vec![graph.constant(0.0); a.len()];
                    let a = if accelerated { a } else { &still };
                    let mechanism = formulation.mechanism(graph, model);
                    newton_euler::inverse_dynamics(&mechanism, formulation, MotionInput { y, v, a })
                })
            })
        };
        Self {
            inverse_dynamics: recursive(true),
            bias_forces: recursive(false),
            mass_matrix: cheapest(&space, |formulation| {
                weigh(model, |graph, y, _, _| {
                    let mechanism = formulation.mechanism(graph, model);
                    composite::mass_matrix(&mechanism, formulation, y).concat()
                })
            }),
        }
    }
}

/// Weight of a computation, and the nodes that it took.
fn weigh<'g, F>(model: &Model, build: F) -> (u64, usize)
where
    F: for<'a> FnOnce(&'a Graph, &[Scalar<'a>], &[Scalar<'a>], &[Scalar<'a>]) -> Vec<Scalar<'a>>,
{
    let graph = Graph::new();
    let arrays: [Vec<_>; 3] = [0, 1, 2].map(|array| {
        (0..model.coordinates.len())
            .map(|k| graph.input(array, k))
            .collect()
    });
    let results: Vec<Edge> = build(&graph, &arrays[0], &arrays[1], &arrays[2])
        .iter()
        .map(|x| x.edge())
        .collect();
    (Cost::of(&graph, &results).weight(), graph.len())
}

/// The equations of motion of a model on one graph.
#[derive(Debug, Clone, Copy)]
pub struct Equations<'a, 'g> {
    /// The graph.
    pub graph: &'g Graph,
    /// The model.
    pub model: &'a Model,
    /// How each quantity is derived.
    pub formulations: &'a Formulations,
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
        let formulation = &self.formulations.mass_matrix;
        composite::mass_matrix(
            &formulation.mechanism(self.graph, self.model),
            formulation,
            y,
        )
    }

    /// `k(y, ẏ)`
    pub fn coriolis_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        self.recursive(
            &self.formulations.bias_forces,
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
            &self.formulations.bias_forces,
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
            &self.formulations.bias_forces,
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

    /// τ(ẏ)
    pub fn friction_torques(&self, v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        forces::friction_torques(self.graph, self.model, v)
    }

    /// Springs and friction: what acts on single joints, as a share of q.
    pub fn joint_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        subtract(&self.spring_forces(y, v), &self.friction_torques(v))
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
            &self.formulations.inverse_dynamics,
            MotionInput { y, v, a },
            true,
        );
        subtract(&bodies, &self.joint_forces(y, v))
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
        let matrix = self.mass_matrix(y);
        let mechanism = Mechanism::new(self.graph, self.model);
        let driving = self
            .input_forces(u)
            .into_iter()
            .zip(self.joint_forces(y, v))
            .map(|(a, b)| a + b);
        let driving: Vec<_> = driving.collect();
        Factorization::new(&mechanism, &matrix).solve(&subtract(&driving, &self.bias_forces(y, v)))
    }

    /// `½ ẏᵀ M ẏ`, as the work of what accelerates by ẏ from rest.
    pub fn kinetic_energy(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Scalar<'g> {
        let formulation = &self.formulations.inverse_dynamics;
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
