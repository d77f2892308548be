//! Functions over a sample time, which call other generated functions.

use crate::function_names;
use crate::functions::function::Function;
use crate::layout::{Dimension, Extent};
use crate::model::Model;
use crate::program::cost::{Cost, count};
use gelenk_kernels::discrete_time::Text;
use gelenk_kernels::manifold;

/// Largest number of doublings in the text of `discretize`. `MOST_REPETITIONS` is the largest number of
/// squarings.
const MOST_DOUBLINGS: usize = 6;
const MOST_REPETITIONS: usize = 18;
const MOST_HALVINGS: usize = MOST_DOUBLINGS + MOST_REPETITIONS;

/// A result of a function over a sample time.
#[derive(Debug, Clone, PartialEq)]
pub struct ComposedResult {
    /// Symbol of the result, for example `y⁺`.
    pub name: &'static str,
    /// Lengths of the result's dimensions, outermost first.
    pub extents: Vec<Extent>,
    /// Meaning of the result, for documentation.
    pub meaning: &'static str,
}

/// A generated function that calls another generated function and computes the motion over one sample time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Composition {
    /// Exact discretization of the linearization with inputs that are constant over the sample time (zero-order
    /// hold).
    Discretize,
    /// State after the sample time. The function computes it by Runge–Kutta steps.
    Step,
    /// State after the sample time with its derivatives. The function computes them by Runge–Kutta steps.
    StepDerivatives,
}

impl Composition {
    /// All functions over a sample time, in the order of the generated module.
    pub const ALL: [Self; 3] = [Self::Discretize, Self::Step, Self::StepDerivatives];

    /// Name of the generated function, for example `step`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Discretize => function_names::DISCRETIZE,
            Self::Step => function_names::STEP,
            Self::StepDerivatives => function_names::STEP_DERIVATIVES,
        }
    }

    /// Name of the generated function that this function calls.
    #[must_use]
    pub fn calls(self) -> &'static str {
        match self {
            Self::Discretize | Self::StepDerivatives => function_names::LINEARIZE,
            Self::Step => function_names::FORWARD_DYNAMICS,
        }
    }

    /// Whether the function divides the sample time into substeps.
    #[must_use]
    pub fn has_substeps(self) -> bool {
        self != Self::Discretize
    }

    /// First line of the function's documentation.
    pub(crate) fn summary(self) -> &'static str {
        match self {
            Self::Discretize => "Exact zero-order hold of the linearization, over one period.",
            Self::Step => {
                "State after one period, computed by Runge–Kutta steps of order 4 with the nonlinear dynamics."
            }
            Self::StepDerivatives => "`step` with the exact derivatives of its result, in one pass.",
        }
    }

    /// The function's equation in Unicode.
    pub(crate) fn equation(self) -> &'static str {
        match self {
            Self::Discretize => {
                "x⁺ = A_d x + B_d u + c_d with x = (y, ẏ), solves ẋ = A x + B_x u + c with u held"
            }
            Self::Step => "x⁺ ≈ x + ∫ f(x, u) dt with x = (y, ẏ), f = (ẏ, M⁻¹ (q + B u − k)) and u held",
            Self::StepDerivatives => "δx⁺ = ∂x⁺/∂x δx + ∂x⁺/∂u δu with x = (y, ẏ)",
        }
    }

    /// The function's results for a model, with symbols and shapes.
    pub(crate) fn results(self, model: &Model) -> Vec<ComposedResult> {
        let n = Extent::new(Dimension::Coordinates, model.coordinates.len());
        let positions = match model.quaternion_joints.is_empty() {
            true => n,
            false => Extent::new(Dimension::Positions, model.position_count()),
        };
        let inputs = input_count(model);
        let (m, two) = (Extent::new(Dimension::Inputs, inputs), Extent::fixed(2));
        let result =
            |name, extents: &[Extent], meaning| ComposedResult { name, extents: extents.to_vec(), meaning };
        let motion = [
            result("y⁺", &[positions], "coordinates after the period"),
            result("ẏ⁺", &[n], "velocities after the period"),
        ];
        let by_state = |name| {
            let meaning = "blocks ((∂y⁺/∂y, ∂y⁺/∂ẏ), (∂ẏ⁺/∂y, ∂ẏ⁺/∂ẏ))";
            result(name, &[two, two, n, n], meaning)
        };
        let by_inputs = |name| result(name, &[two, n, m], "blocks (∂y⁺/∂u, ∂ẏ⁺/∂u)");
        match self {
            Self::Discretize => {
                let remainders = result("c_d", &[two, n], "affine remainders of y⁺ and ẏ⁺");
                vec![by_state("A_d"), by_inputs("B_d"), remainders]
            }
            Self::Step => motion.to_vec(),
            Self::StepDerivatives => {
                let [y, v] = motion;
                vec![y, v, by_state("∂x⁺/∂x"), by_inputs("∂x⁺/∂u")]
            }
        }
    }

    /// Notes of the function's documentation: method, error and limits.
    pub(crate) fn notes(self, has_quaternions: bool) -> &'static [&'static str] {
        match self {
            Self::Discretize if has_quaternions => &[
                "δ is the displacement from y, 0 at the start of the period. v̄ is the argument `v`. Since D \
                 v̄ = 0, δ − v̄ t is the deviation from the motion with the velocities v̄; it satisfies δ̇ = D \
                 δ + v − v̄. Derivatives of δ⁺ are taken along ⊕ at the final positions.",
                "The function integrates w = δ̇ = D δ + v by scaling and squaring (Higham 2008, section 10.3). ν = (b + √(b² + \
                 4 a))/2 bounds the rates of the robot, with a = ‖A_y − A_v D‖ and b = ‖A_v + D‖ (largest sums of magnitudes \
                 in a row; A_y = ∂ÿ/∂y, A_v = ∂ÿ/∂ẏ). If ν · period is above 2e7, all results are +∞.",
            ],
            Self::Step if has_quaternions => &[
                "`SUBSTEPS` Runge–Kutta–Munthe-Kaas steps of order 4 (Munthe-Kaas 1999): the classical method \
                 for δ in y ⊕ δ keeps the unit length of quaternions. The error is proportional to the fourth \
                 power of the step length.",
            ],
            Self::Discretize => &[
                "Scaling and squaring of the lifted exponential (Higham 2008, section 10.3) in blocks of N × N: a Taylor \
                 polynomial of degree 17 over a step h, at most 6 doublings of the integral and at most 18 of the result.",
                "The period is halved until ν · h is at most 5/4. ν = (b + √(b² + 4 a))/2 bounds the rates of the robot, with a = \
                 ‖∂ÿ/∂y‖ and b = ‖∂ÿ/∂ẏ‖ (largest sums of magnitudes in a row). If 24 halvings do not suffice \
                 (ν · period above 2e7), all results are +∞.",
                "Error: the truncated terms are below 1e-15 relative to their sum. Rounding stays below 1e-12 \
                 of the largest entry of each block; diagonal blocks count as at least 1.",
            ],
            Self::Step => &[
                "`SUBSTEPS` steps of the classical method of order 4. The error is proportional to the fourth \
                 power of the step length. The steps are stable if period / `SUBSTEPS` times the fastest rate \
                 of the robot is below 2.7.",
            ],
            Self::StepDerivatives => &[
                "The chain rule over the stages of each step gives the exact derivatives of the result of `step`, not \
                 of the exact solution.",
            ],
        }
    }

    /// Number of calls of the function [`Self::calls`] in one sample time.
    pub(crate) fn call_count(self, substeps: usize) -> usize {
        match self {
            Self::Discretize => 1,
            Self::Step | Self::StepDerivatives => 4 * substeps,
        }
    }

    /// Number of operations for n coordinates and m inputs. It is the sum of the operations of all calls and
    /// the operations of the function's own loops, including multiplications by 0 and 1. If the number depends
    /// on the data, the largest number is returned.
    ///
    /// - `called`: operations of one call
    #[must_use]
    pub fn cost(self, n: usize, m: usize, substeps: usize, called: Cost) -> Cost {
        called * self.call_count(substeps) + self.own_cost(n, m, substeps, MOST_HALVINGS)
    }

    /// Smallest number of operations, counted as in [`Self::cost`]. It differs from that cost if the number
    /// depends on the data.
    #[must_use]
    pub fn least_cost(self, n: usize, m: usize, substeps: usize, called: Cost) -> Cost {
        called * self.call_count(substeps) + self.own_cost(n, m, substeps, 0)
    }

    /// Number of operations in the module of a robot; `None` if the module lacks the called function.
    pub(crate) fn cost_in(self, model: &Model, functions: &[Function]) -> Option<Cost> {
        let called = functions.iter().find(|function| function.name == self.calls())?;
        let substeps = model.options.substeps.unwrap_or(1);
        Some(self.cost(model.coordinates.len(), input_count(model), substeps, count(&called.program)))
    }

    /// Documentation note about a number of operations that depends on the data; `None` if it does not.
    pub(crate) fn cost_note(self, model: &Model, functions: &[Function]) -> Option<String> {
        if self != Self::Discretize {
            return None;
        }
        let called = functions.iter().find(|function| function.name == self.calls())?;
        let (n, m) = (model.coordinates.len(), input_count(model));
        let Cost { multiplications, additions, .. } = self.least_cost(n, m, 1, count(&called.program));
        Some(format!(
            "This is the largest cost, which {MOST_HALVINGS} halvings of the period need. Without halvings the function needs \
             {multiplications} multiplications and {additions} additions."
        ))
    }

    /// Number of operations in the function's own loops, without called functions.
    ///
    /// - `halvings`: number of halvings of the sample time in `discretize`
    fn own_cost(self, n: usize, m: usize, substeps: usize, halvings: usize) -> Cost {
        // Number of entries of a coordinate vector together with its derivatives with respect to state and inputs.
        let motion = n + 2 * n * n + n * m;
        match self {
            Self::Discretize => discretize_cost(n, m, halvings),
            Self::Step => cost(14 * n, 14 * n, 12) * substeps + cost(0, 0, 1),
            Self::StepDerivatives => {
                let chain_rule = 4 * n.pow(3) + 2 * n * n + n * m + 2 * n * n * m;
                let common = 4 * chain_rule + 14 * motion;
                cost(common, common + 12 * n, 12) * substeps + cost(0, 0, 1)
            }
        }
    }

    /// Additional texts that the module includes if the robot has joints with quaternions.
    pub(crate) fn manifold_texts(self) -> &'static [manifold::Text] {
        use manifold::Text::{RungeKutta, Sensitivities, ZeroOrderHold};
        match self {
            Self::Discretize => &[ZeroOrderHold],
            Self::Step => &[RungeKutta],
            Self::StepDerivatives => &[RungeKutta, Sensitivities],
        }
    }

    /// Texts of discrete-time functions that the module includes.
    pub(crate) fn texts(self) -> &'static [Text] {
        match self {
            Self::Discretize => &[Text::Sums, Text::Halves, Text::ZeroOrderHold],
            Self::Step => &[Text::Sums, Text::RungeKutta],
            Self::StepDerivatives => &[Text::Sums, Text::Halves, Text::RungeKutta, Text::Sensitivities],
        }
    }
}

fn input_count(model: &Model) -> usize {
    model.inputs().count()
}

/// Number of operations of `discretize` with this number of halvings of the sample time, without the called
/// function.
fn discretize_cost(n: usize, m: usize, halvings: usize) -> Cost {
    let doublings = halvings.min(MOST_DOUBLINGS);
    let common = 22 * n.pow(3) + 38 * n.pow(2) + 2 * n * n * m + (6 * n.pow(3) + 2 * n.pow(2)) * doublings;
    let trials = cost(2 + 3 * halvings, 1 + halvings + 2 * n * n, 2);
    let twice = 8 * n.pow(3) + 4 * n * n + (2 * n + 4 * n * n) * (m + 1);
    let repeated = cost(twice, twice + 4 * n, 0) * (halvings - doublings);
    cost(common + 6 * n * n + n + 1, common + 2 * n, 1) + trials + repeated
}

fn cost(multiplications: usize, additions: usize, divisions: usize) -> Cost {
    Cost { multiplications, additions, divisions, ..Cost::default() }
}
