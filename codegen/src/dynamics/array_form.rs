//! Straight-line code or loops over joints: the choice, by the size of the code.

use std::cell::OnceCell;

use super::base_frame;
use super::catalogue::{Quantity, arguments_of, quantities, straight_program};
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

/// Bytes of machine code up to which a function stays straight-line code. Measured with AVX-512, time of loops over that of
/// straight-line code: a generic chain of six joints, 26 and 43 kB, 1.1 and 0.75; of seven, 33 and 60 kB, 0.8 and 0.6; of
/// twelve 0.4 and 0.36; UR5, 10 and 22 kB, 3.8 and 2.4. The instruction cache of the first level holds 32 kB.
pub const LARGEST_STRAIGHT: usize = 27_000;

/// Loops may take so many times the operations of straight-line code, because they work on whole vectors. Measured, time
/// of loops over that of straight-line code with AVX-512, AVX2 and neither: LWA 4P's Jacobians of the forward dynamics,
/// 3.15 times the operations, 1.4, 1.7 and 2.1; Panda's, 2.2 times, 0.65, 0.85 and 1.15; Panda's of the inverse dynamics,
/// 2.7 times (3.0 with M), 0.95, 1.3 and 1.5 called alone, 0.8, 1.4 and 1.8 between other code.
const MOST_OPERATIONS: f64 = 3.1;

/// What the documentation of a function with loops says.
pub(super) const NOTE: &str = "Loops over joints, with spatial vectors in the frame of the base (Singh, Russell and Wensing 2022): \
    straight-line code would not fit into a processor's instruction cache. The cost counts each operation that contributes.";

/// The function that `linearize` calls.
const JACOBIANS: &str = "forward_dynamics_derivatives";

/// So many operations each pair of joints on one path takes at least, unless many of them are parallel.
const OPERATIONS_PER_PAIR: usize = 20;

/// A function as it is written.
#[derive(Clone)]
pub(super) struct Derived {
    /// Straight-line code; what the loops stand for, where there are some.
    pub(super) program: Program,
    pub(super) arrays: Option<ArrayForm>,
}

impl Derived {
    fn with_loops(form: ArrayForm) -> Self {
        Self {
            program: form.unrolled(),
            arrays: Some(form),
        }
    }

    fn operations(&self) -> usize {
        let cost = count(&self.program);
        cost.multiplications + cost.additions
    }
}

/// Derives a model's functions, each in the form that is cheaper.
pub(super) struct Forms<'m> {
    model: &'m Model,
    formulations: &'m Formulations<'m>,
    form: Form,
    straight: &'m [String],
    /// `forward_dynamics_derivatives`, which `linearize` may call.
    jacobians: OnceCell<Derived>,
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

    pub(super) fn derive(&self, quantity: &Quantity) -> Derived {
        match quantity.name {
            "linearize" => match self.linearization() {
                Some(affine) => Derived::with_loops(ArrayForm::Affine(affine)),
                None => self.straight(quantity),
            },
            JACOBIANS => self.jacobians(quantity).clone(),
            _ => self.cheaper(quantity),
        }
    }

    /// Whether `linearize` calls `forward_dynamics_derivatives`. Known without deriving what may be too large to be wanted.
    pub(super) fn linearize_calls(&self) -> bool {
        self.called().is_some()
    }

    /// The function that `linearize` calls, and the gains of the inputs.
    fn called(&self) -> Option<(&'static Quantity, Vec<(usize, Operand)>)> {
        if self.is_straight("linearize") || !self.may_loop(JACOBIANS) {
            return None;
        }
        let inputs = gains(self.model)?;
        let called = quantities().find(|quantity| quantity.name == JACOBIANS)?;
        let has_loops = self.is_far_beyond() || self.jacobians(called).arrays.is_some();
        has_loops.then_some((called, inputs))
    }

    fn linearization(&self) -> Option<Affine> {
        let (called, inputs) = self.called()?;
        match &self.jacobians(called).arrays {
            Some(ArrayForm::Steps(arrays)) => Some(Affine {
                called: arrays.clone(),
                inputs,
            }),
            _ => None,
        }
    }

    fn jacobians(&self, quantity: &Quantity) -> &Derived {
        self.jacobians.get_or_init(|| self.cheaper(quantity))
    }

    fn cheaper(&self, quantity: &Quantity) -> Derived {
        if !self.may_loop(quantity.name) {
            return self.straight(quantity);
        }
        if self.is_far_beyond() {
            return self.with_loops(quantity);
        }
        let straight = self.straight(quantity);
        let most = MOST_OPERATIONS * straight.operations() as f64;
        if !is_large(straight.operations()) {
            return straight;
        }
        let loops = self.with_loops(quantity);
        match loops.operations() as f64 <= most {
            true => loops,
            false => straight,
        }
    }

    /// Whether a function is written as loops; known without deriving it.
    pub(super) fn has_loops_surely(&self, name: &str) -> bool {
        match name {
            "linearize" => self.is_far_beyond() && self.linearize_calls(),
            _ => self.is_far_beyond() && self.may_loop(name),
        }
    }

    /// Whether straight-line code need not be derived to know that it is too large.
    fn is_far_beyond(&self) -> bool {
        self.form == Form::Arrays || is_large(OPERATIONS_PER_PAIR * pairs(self.model))
    }

    fn is_straight(&self, name: &str) -> bool {
        self.form == Form::Straight || self.straight.iter().any(|other| other == name)
    }

    fn may_loop(&self, name: &str) -> bool {
        NAMES.contains(&name)
            && !self.is_straight(name)
            && base_frame::is_possible(&Mechanism::new(&Graph::new(), self.model))
    }

    fn straight(&self, quantity: &Quantity) -> Derived {
        Derived {
            program: straight_program(self.model, self.formulations, quantity),
            arrays: None,
        }
    }

    /// One of [`NAMES`] as loops over joints.
    fn with_loops(&self, quantity: &Quantity) -> Derived {
        let graph = Graph::new();
        let equations = Equations {
            graph: &graph,
            model: self.model,
            formulations: self.formulations,
        };
        let (arguments, inputs) = arguments_of(&graph, self.model, quantity.arguments);
        let arrays = match quantity.name {
            JACOBIANS => base_frame::forward_dynamics_derivatives(&equations, &arguments, inputs),
            name => {
                let with_mass_matrix = name == WITH_MASS_MATRIX;
                base_frame::inverse_dynamics_derivatives(
                    &equations,
                    &arguments,
                    inputs,
                    with_mass_matrix,
                )
            }
        };
        Derived::with_loops(ArrayForm::Steps(arrays))
    }
}

const WITH_MASS_MATRIX: &str = "inverse_dynamics_derivatives_and_mass_matrix";

/// Functions that have an array form of their own.
const NAMES: [&str; 3] = ["inverse_dynamics_derivatives", WITH_MASS_MATRIX, JACOBIANS];

fn is_large(operations: usize) -> bool {
    BYTES_PER_OPERATION * operations > LARGEST_STRAIGHT
}

/// Pairs of joints on one path to the base.
fn pairs(model: &Model) -> usize {
    let graph = Graph::new();
    let mechanism = Mechanism::new(&graph, model);
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
