//! Choice between straight-line code and loops over joints by the size of the code.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use super::assemble::{arguments_of, straight_program};
use super::catalogue::{self, BuildLoops, Estimate, Loops, Quantity};
use crate::dynamics::equations::Equations;
use crate::dynamics::forces;
use crate::dynamics::per_joint;
use crate::dynamics::search::routes::Formulations;
use crate::dynamics::tangent;
use crate::function_names;
use crate::graph::{Graph, Node};
use crate::kinematics::{Mechanism, Number};
use crate::model::Model;
use crate::program::arrays::{Affine, ArrayForm, Drift, Step};
use crate::program::cost::count;
use crate::program::{Operand, Program};

/// Form of large functions: straight-line code or loops over joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// Loops over joints if straight-line code would exceed [`LARGEST_STRAIGHT`] bytes of machine code.
    #[default]
    Cheapest,
    /// Straight-line code for all functions.
    Straight,
    /// Loops over joints for all functions that have them.
    Arrays,
}

/// Bytes of machine code per operation in a large straight-line function, including spilled registers. Measured
/// values on x86-64 with AVX-512 are 10 to 20. Small functions need fewer.
const BYTES_PER_OPERATION: usize = 12;

/// Largest machine code of a straight-line function in bytes, chosen from measurements with AVX-512. Two
/// functions were measured for each robot. A ratio is the time of the loops divided by the time of the
/// straight-line code.
///
/// | robot | straight-line code (kB) | ratios |
/// |---|---|---|
/// | UR5 | 10 and 22 | 3.8 and 2.4 |
/// | generic chain of 6 joints | 26 and 43 | 1.1 and 0.75 |
/// | generic chain of 7 joints | 33 and 60 | 0.8 and 0.6 |
/// | generic chain of 12 joints | | 0.4 and 0.36 |
///
/// A first-level instruction cache has 32 kB.
pub const LARGEST_STRAIGHT: usize = 27_000;

/// Largest ratio of the operations of loops to the operations of straight-line code for which loops are used.
/// Loops may have more operations, because they work on whole vectors. The following values are the measured
/// times of the loops divided by the times of straight-line code, for processors with AVX-512, with AVX2, or
/// with neither.
///
/// | Jacobians | operations | AVX-512 | AVX2 | neither |
/// |---|---|---|---|---|
/// | forward dynamics, LWA 4P | 3.15 times | 1.4 | 1.7 | 2.1 |
/// | forward dynamics, Panda | 2.2 times | 0.65 | 0.85 | 1.15 |
/// | inverse dynamics, Panda, called alone | 2.7 times | 0.95 | 1.3 | 1.5 |
/// | inverse dynamics, Panda, between other code | 2.7 times | 0.8 | 1.4 | 1.8 |
///
/// The Jacobians of the inverse dynamics together with M have 3.0 times the operations.
const MOST_OPERATIONS: f64 = 3.1;

/// Documentation note of a function that consists of loops over joints.
pub(super) const NOTE: &str = "Loops over joints, with spatial vectors in the frame of the base (Singh, Russell and Wensing 2022): \
    straight-line code would not fit into a processor's instruction cache. The cost counts each operation that contributes.";

/// Documentation note of a function in which only the products with the inverse mass matrix are loops.
pub(super) const PRODUCTS_NOTE: &str = "The accelerations, M⁻¹ and the Jacobians of the inverse dynamics are straight-line code, the products with M⁻¹ are loops. \
    The cost counts each operation that contributes.";

/// Least number of operations of straight-line code for each pair of joints on one path from the base, unless
/// many joints are parallel.
const OPERATIONS_PER_PAIR: usize = 20;

/// Documentation note of a function with loops over joints.
pub(super) fn note(form: &ArrayForm) -> &'static str {
    let is_map = |step: &Step| matches!(step, Step::Map(_));
    match form.arrays().steps.iter().any(is_map) {
        true => NOTE,
        false => PRODUCTS_NOTE,
    }
}

/// A function after the choice between straight-line code and loops.
#[derive(Clone)]
pub(super) struct Derived {
    /// Straight-line code. If the function has loops, this is the code that the loops replace.
    pub(super) program: Program,
    pub(super) arrays: Option<ArrayForm>,
}

impl Derived {
    fn with_loops(form: ArrayForm) -> Self {
        Self { program: form.unrolled(), arrays: Some(form) }
    }

    fn operations(&self) -> usize {
        let cost = count(&self.program);
        cost.multiplications + cost.additions
    }
}

/// Derives the functions of a model, each as straight-line code or as loops, whichever is cheaper.
pub(super) struct Forms<'m> {
    model: &'m Model,
    formulations: &'m Formulations<'m>,
    form: Form,
    straight: &'m [String],
    /// Derived functions that other functions may call, by name.
    derived: RefCell<BTreeMap<&'static str, Rc<Derived>>>,
}

impl<'m> Forms<'m> {
    /// Prepares the derivation of a model's functions. No function is derived yet.
    ///
    /// - `straight`: functions that are always straight-line code
    pub(super) fn new(
        model: &'m Model,
        formulations: &'m Formulations<'m>,
        form: Form,
        straight: &'m [String],
    ) -> Self {
        Self { model, formulations, form, straight, derived: RefCell::default() }
    }

    pub(super) fn derive(&self, quantity: &'static Quantity) -> Derived {
        match quantity.loops {
            Some(Loops::Affine { called }) => match self.affine(quantity, called) {
                Some(affine) => Derived::with_loops(ArrayForm::Affine(affine)),
                None => self.straight(quantity),
            },
            Some(Loops::PerJoint { .. }) => Derived::clone(&self.derived(quantity)),
            None => self.straight(quantity),
        }
    }

    /// Name of the function that the function `name` calls; `None` if it calls no function. Neither function is
    /// derived for this answer.
    pub(super) fn callee(&self, name: &str) -> Option<&'static str> {
        let quantity = catalogue::row(name)?;
        let Some(Loops::Affine { called }) = quantity.loops else {
            return None;
        };
        self.called(quantity, called).map(|(called, _)| called.name)
    }

    /// Returns the function that a function with affine results calls, and the gains of the inputs.
    fn called(&self, quantity: &Quantity, called: &str) -> Option<(&'static Quantity, Vec<Gains>)> {
        let called = catalogue::row(called)?;
        if self.is_straight(quantity) || !self.may_loop(called) {
            return None;
        }
        let inputs = gains(self.model)?;
        let has_loops = self.is_far_beyond() || self.derived(called).arrays.is_some();
        has_loops.then_some((called, inputs))
    }

    fn affine(&self, quantity: &Quantity, called: &str) -> Option<Affine> {
        let (called, inputs) = self.called(quantity, called)?;
        match &self.derived(called).arrays {
            Some(ArrayForm::Steps(arrays)) => {
                Some(Affine { name: called.name, called: arrays.clone(), inputs, drift: drift(self.model) })
            }
            _ => None,
        }
    }

    /// Derives a function that other functions may call. The result is kept for further calls.
    fn derived(&self, quantity: &'static Quantity) -> Rc<Derived> {
        if let Some(known) = self.derived.borrow().get(quantity.name) {
            return Rc::clone(known);
        }
        let derived = Rc::new(self.cheaper(quantity));
        self.derived.borrow_mut().insert(quantity.name, Rc::clone(&derived));
        derived
    }

    fn cheaper(&self, quantity: &Quantity) -> Derived {
        let build = match quantity.loops {
            Some(Loops::PerJoint { build, .. }) if self.may_loop(quantity) => build,
            _ => return self.straight(quantity),
        };
        if self.is_far_beyond() {
            return self.with_loops(quantity, build);
        }
        let straight = self.straight(quantity);
        let most = MOST_OPERATIONS * straight.operations() as f64;
        if !is_large(straight.operations()) {
            return straight;
        }
        let loops = self.with_loops(quantity, build);
        match loops.operations() as f64 <= most {
            true => self.products(quantity).unwrap_or(loops),
            false => straight,
        }
    }

    /// Derives straight-line code with loops only for the products with the inverse mass matrix, if this form
    /// is faster. It is faster if the other factors are long straight-line code that is not yet replaced by
    /// loops. For a Go2, the matrices of the linearization then take 0.89 of the time, or 0.82 with fused
    /// multiply-adds.
    fn products(&self, quantity: &Quantity) -> Option<Derived> {
        let Some(Loops::PerJoint { products: Some(products), .. }) = quantity.loops else {
            return None;
        };
        let beside = self.derived(catalogue::row(products.beside)?);
        let pays = beside.arrays.is_none() && is_large(beside.operations());
        let is_possible = pays && per_joint::products_are_possible(self.mechanism());
        is_possible.then(|| self.with_loops(quantity, products.build))
    }

    /// Returns how to estimate the operations of a function before it is derived, and whether the function is
    /// certainly written as loops. `None` if no estimate is known.
    pub(super) fn estimate(&self, quantity: &Quantity) -> Option<(Estimate, bool)> {
        let loops = quantity.loops.filter(|loops| match *loops {
            Loops::PerJoint { .. } => self.is_far_beyond() && self.may_loop(quantity),
            Loops::Affine { called } => self.is_far_beyond() && self.called(quantity, called).is_some(),
        });
        match loops {
            None => quantity.straight_size.map(|size| (size, false)),
            Some(Loops::PerJoint { size, .. }) => Some((size, true)),
            Some(Loops::Affine { called }) => match catalogue::row(called)?.loops {
                Some(Loops::PerJoint { size, .. }) => Some((size, true)),
                _ => None,
            },
        }
    }

    /// Whether straight-line code is certainly too large. The function is not derived for this answer. Robots
    /// with a floating base are uncertain: straight-line code omits pairs of joints on different limbs, but
    /// loops compute these pairs and discard the results.
    fn is_far_beyond(&self) -> bool {
        let is_known = !self.mechanism().has_quaternions();
        self.form == Form::Arrays || (is_known && is_large(OPERATIONS_PER_PAIR * self.mechanism().pairs()))
    }

    fn is_straight(&self, quantity: &Quantity) -> bool {
        let is_named = |name: &String| [quantity.name, function_names::ALL].contains(&name.as_str());
        self.form == Form::Straight || self.straight.iter().any(is_named)
    }

    fn may_loop(&self, quantity: &Quantity) -> bool {
        matches!(quantity.loops, Some(Loops::PerJoint { .. }))
            && !self.is_straight(quantity)
            && catalogue::LOOPS.check(self.model).is_ok()
            && per_joint::is_possible(self.mechanism())
    }

    /// Bodies, joints and rotors of the model.
    pub(super) fn mechanism(&self) -> &'m Mechanism<Number> {
        self.formulations.mechanism()
    }

    fn straight(&self, quantity: &Quantity) -> Derived {
        Derived { program: straight_program(self.model, self.formulations, quantity), arrays: None }
    }

    fn with_loops(&self, quantity: &Quantity, build: BuildLoops) -> Derived {
        let graph = Graph::new();
        let (arguments, inputs) = arguments_of(&graph, self.model, quantity.arguments);
        let equations = Equations {
            graph: &graph,
            model: self.model,
            formulations: self.formulations,
            driven: &arguments.driven,
        };
        Derived::with_loops(ArrayForm::Steps(build(&equations, &arguments, inputs)))
    }
}

/// Whether a function with this number of operations in straight-line code is written as loops, if loops are
/// available.
pub(crate) fn is_large(operations: usize) -> bool {
    BYTES_PER_OPERATION * operations > LARGEST_STRAIGHT
}

/// The coordinates on which an input acts, each with the gain from the input to the generalized force.
type Gains = Vec<(usize, Operand)>;

/// Gains of each input. `None` if a gain is not a plain number or parameter, or depends on the positions.
fn gains(model: &Model) -> Option<Vec<Gains>> {
    if model.inputs_depend_on_position() {
        return None;
    }
    let graph = Graph::new();
    let matrix = forces::drive_matrix(&graph, model);
    let columns = matrix.first().map_or(0, Vec::len);
    let gain = |row: usize, column: usize| {
        let edge = matrix[row][column].edge();
        match graph.node(edge) {
            Node::Constant(_) => Some((row, Operand::Constant(graph.value(edge)?))),
            Node::Parameter(index) if !edge.is_negative() => Some((row, Operand::Parameter(index as usize))),
            _ => None,
        }
    };
    let of_input = |column: usize| {
        let rows = (0..matrix.len()).filter(|&row| !matrix[row][column].is_zero());
        let gains: Option<Vec<_>> = rows.map(|row| gain(row, column)).collect();
        gains.filter(|gains| !gains.is_empty())
    };
    (0..columns).map(of_input).collect()
}

/// Non-zero entries of the matrix D in `δ̇ = D δ + v − v̄`; `None` if no position is a quaternion. δ is the
/// deviation from a motion with the velocities v̄.
fn drift(model: &Model) -> Option<Vec<Drift>> {
    if model.quaternion_joints.is_empty() {
        return None;
    }
    const VELOCITIES: u32 = 1;
    let graph = Graph::new();
    let v: Vec<_> = (0..model.motion_count()).map(|k| graph.input(VELOCITIES as usize, k)).collect();
    let mut entries = Vec::new();
    for (row, drifts) in tangent::drift(&graph, model, &v).iter().enumerate() {
        for (column, entry) in drifts.iter().enumerate() {
            let edge = entry.edge();
            if let Node::Input(_, velocity) = graph.node(edge) {
                let (velocity, is_negative) = (velocity as usize, edge.is_negative());
                entries.push(Drift { row, column, velocity, is_negative });
            }
        }
    }
    Some(entries)
}
