//! Straight-line code or loops over joints: the choice, by the size of the code.

use std::cell::OnceCell;

use super::base_frame;
use super::catalogue::{Quantity, arguments_of, quantities};
use super::equations::{Equations, Formulations};
use super::forces;
use crate::graph::{Graph, Node};
use crate::kinematics::Mechanism;
use crate::model::Model;
use crate::program::arrays::{Affine, ArrayForm};
use crate::program::cost::count;
use crate::program::{Operand, Program};

/// How functions that may be large are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// As loops over joints where straight-line code would be larger than [`LARGEST_STRAIGHT`].
    #[default]
    Cheapest,
    /// As straight-line code.
    Straight,
    /// As loops over joints, wherever there is such a form.
    Arrays,
}

/// Bytes of machine code that an operation of a large straight-line function takes, spilled registers included: 10 to
/// 20 of x86-64 with AVX-512, fewer where functions are small.
const BYTES_PER_OPERATION: usize = 12;

/// Bytes of machine code up to which a function stays straight-line code. Measured against Pinocchio in the same run,
/// straight-line code to loops: UR5 11 and 22 kB 12.5× to 4.3× and 10.9× to 4.0×; a generic chain of six joints 26 kB
/// 3.7× to 3.9×, of seven 34 kB 2.8× to 3.8×. The instruction cache of the first level holds 32 kB.
pub const LARGEST_STRAIGHT: usize = 27_000;

/// Loops may take so many times the operations of straight-line code, because they work on whole vectors. Measured, time of
/// loops over that of straight-line code with AVX-512, AVX2 and neither: LWA 4P's Jacobians of the forward dynamics,
/// 3.15 times the operations, 1.5, 2.0 and 2.1; Panda's, 2.2 times, 0.95, 1.1 and 1.2; Panda's of the inverse dynamics,
/// 2.7 times (3.0 with M), 0.8, 1.2 and 1.2.
const MOST_OPERATIONS: f64 = 3.1;

/// What the documentation of a function with loops says.
pub(super) const NOTE: &str = "Loops over joints, with spatial vectors in the frame of the base (Singh, Russell and Wensing 2022): \
    straight-line code would not fit into a processor's instruction cache. The cost counts each operation that contributes.";

/// The function that `linearize` calls.
const JACOBIANS: &str = "forward_dynamics_derivatives";

/// So many operations each pair of joints on one path takes at least, unless many of them are parallel.
const OPERATIONS_PER_PAIR: usize = 20;

/// The forms of a model's functions.
pub(super) struct Forms<'m> {
    model: &'m Model,
    formulations: &'m Formulations<'m>,
    form: Form,
    straight: &'m [String],
    /// Whether `forward_dynamics_derivatives` has loops.
    jacobians: OnceCell<bool>,
}

impl<'m> Forms<'m> {
    /// - `straight`: functions that are straight-line code in any case
    pub(super) fn new(
        model: &'m Model,
        formulations: &'m Formulations<'m>,
        form: Form,
        straight: &'m [String],
    ) -> Self {
        Self {
            model,
            formulations,
            form,
            straight,
            jacobians: OnceCell::new(),
        }
    }

    /// The array form of a function, where it is chosen; `straight` derives the other one, if it has to be measured.
    pub(super) fn choose(
        &self,
        quantity: &Quantity,
        straight: impl FnOnce() -> Program,
    ) -> Option<ArrayForm> {
        let is_chosen = match quantity.name {
            "linearize" => self.linearize_calls(),
            JACOBIANS => *self
                .jacobians
                .get_or_init(|| self.is_better(quantity, straight)),
            _ => self.is_better(quantity, straight),
        };
        match is_chosen {
            true => self.derive(quantity),
            false => None,
        }
    }

    /// Whether `linearize` calls `forward_dynamics_derivatives`.
    pub(super) fn linearize_calls(&self) -> bool {
        let is_free = !self.straight.iter().any(|name| name == "linearize");
        let jacobians = quantities().find(|quantity| quantity.name == JACOBIANS);
        is_free
            && gains(self.model).is_some()
            && jacobians.is_some_and(|quantity| {
                *self.jacobians.get_or_init(|| {
                    self.is_better(quantity, || {
                        super::catalogue::straight_program(self.model, self.formulations, quantity)
                    })
                })
            })
    }

    fn is_better(&self, quantity: &Quantity, straight: impl FnOnce() -> Program) -> bool {
        let is_excluded = self.form == Form::Straight
            || !NAMES.contains(&quantity.name)
            || self.straight.iter().any(|other| other == quantity.name);
        let mechanism_graph = Graph::new();
        let mechanism = Mechanism::new(&mechanism_graph, self.model);
        if is_excluded || !base_frame::is_possible(&mechanism) {
            return false;
        }
        let is_large = |operations: usize| BYTES_PER_OPERATION * operations > LARGEST_STRAIGHT;
        // Far beyond, straight-line code need not be derived to know.
        if self.form == Form::Arrays || is_large(OPERATIONS_PER_PAIR * pairs(&mechanism)) {
            return true;
        }
        let straight = operations(&straight());
        is_large(straight)
            && self.derive(quantity).is_some_and(|loops| {
                operations(&loops.unrolled()) as f64 <= MOST_OPERATIONS * straight as f64
            })
    }

    fn derive(&self, quantity: &Quantity) -> Option<ArrayForm> {
        let graph = Graph::new();
        let equations = Equations {
            graph: &graph,
            model: self.model,
            formulations: self.formulations,
        };
        let (arguments, inputs) = arguments_of(&graph, self.model, quantity.arguments);
        let inverse = |with_mass_matrix| {
            ArrayForm::Steps(base_frame::inverse_dynamics_derivatives(
                &equations,
                &arguments,
                inputs.clone(),
                with_mass_matrix,
            ))
        };
        let forward =
            || base_frame::forward_dynamics_derivatives(&equations, &arguments, inputs.clone());
        match quantity.name {
            "inverse_dynamics_derivatives" => Some(inverse(false)),
            "inverse_dynamics_derivatives_and_mass_matrix" => Some(inverse(true)),
            JACOBIANS => Some(ArrayForm::Steps(forward())),
            "linearize" => Some(ArrayForm::Affine(Affine {
                called: forward(),
                inputs: gains(self.model)?,
            })),
            _ => None,
        }
    }
}

/// Functions that have an array form of their own.
const NAMES: [&str; 3] = [
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    JACOBIANS,
];

fn operations(program: &Program) -> usize {
    let cost = count(program);
    cost.multiplications + cost.additions
}

/// Pairs of joints on one path to the base.
fn pairs(mechanism: &Mechanism<'_>) -> usize {
    let mut depths: Vec<usize> = Vec::with_capacity(mechanism.len());
    for body in &mechanism.bodies {
        depths.push(body.parent.map_or(0, |parent| depths[parent] + 1));
    }
    depths.iter().sum()
}

/// For each input its coordinate and gain; `None` where a gain has to be computed.
fn gains(model: &Model) -> Option<Vec<(usize, Operand)>> {
    let graph = Graph::new();
    let matrix = forces::input_matrix(&graph, model);
    let columns = matrix.first().map_or(0, Vec::len);
    let gain = |column: usize| {
        let row = matrix.iter().position(|row| !row[column].is_zero())?;
        let edge = matrix[row][column].edge();
        match graph.node(edge) {
            Node::Constant(_) => Some((row, Operand::Constant(graph.value(edge)?))),
            Node::Parameter(index) if !edge.is_negative() => {
                Some((row, Operand::Parameter(index as usize)))
            }
            _ => None,
        }
    };
    (0..columns).map(gain).collect()
}
