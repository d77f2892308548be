//! The functions that can be generated: one row each, with what their documentation says.

use super::array_form::{self, Derived, Form, Forms};
use super::composition::Composition;
use super::equations::{Equations, Formulations, Matrix};
use super::forces;
use super::function::{ArgumentText, Constant, Function};
use super::newton_euler::MotionInput;
use super::selection::{self, Request};
use super::size::Estimate;
use super::{base_frame, hessian, module_constants, regressor_quantities};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::graph::{Graph, Scalar};
use crate::kinematics::ScalarPose;
use crate::layout::{Dimension, Extent};
use crate::model::{Definiteness, Drive, Frame, Joint, JointKind, Model};
use crate::program::arrays::Arrays;
use crate::program::{GraphOutput, InputArray, Program, Shape, lower};

/// An argument of a generated function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
    /// y
    Coordinates,
    /// ẏ
    Velocities,
    /// ÿ
    Accelerations,
    /// u
    Inputs,
    /// λ
    Multipliers,
}

use Argument::{Accelerations, Coordinates, Inputs, Multipliers, Velocities};

impl Argument {
    fn name(self) -> &'static str {
        match self {
            Coordinates => "y",
            Velocities => "v",
            Accelerations => "a",
            Inputs => "u",
            Multipliers => "lambda",
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Coordinates => "coordinates",
            Velocities => "velocities ẏ",
            Accelerations => "accelerations ÿ",
            Inputs => "inputs",
            Multipliers => "multipliers λ, one for each force",
        }
    }

    /// What its documentation says.
    fn text(self, model: &Model) -> ArgumentText {
        let by_joint = |units: [&'static str; 2]| {
            let entry = |joint: &Joint| {
                let row = usize::from(joint.kind == JointKind::Prismatic);
                (joint.name.clone(), units[row])
            };
            model.joints().map(entry).collect()
        };
        let entries = match self {
            Coordinates => by_joint(["rad", "m"]),
            Velocities => by_joint(["rad/s", "m/s"]),
            Accelerations => by_joint(["rad/s²", "m/s²"]),
            Inputs => {
                let entry = |drive: &Drive| (drive.name.clone(), model.input_unit(drive));
                model.inputs().map(entry).collect()
            }
            Multipliers => Vec::new(),
        };
        ArgumentText {
            meaning: self.meaning().to_owned(),
            entries,
        }
    }

    fn extent(self, model: &Model) -> Extent {
        let velocities = Extent::new(Dimension::Velocities, model.coordinates.len());
        match self {
            Inputs => Extent::new(Dimension::Inputs, model.inputs().count()),
            Coordinates => Extent::new(Dimension::Coordinates, model.coordinates.len()),
            Velocities | Accelerations | Multipliers => velocities,
        }
    }
}

/// Scalars of the arguments of a function.
pub struct Arguments<'g> {
    pub(super) y: Vec<Scalar<'g>>,
    pub(super) v: Vec<Scalar<'g>>,
    pub(super) a: Vec<Scalar<'g>>,
    pub(super) u: Vec<Scalar<'g>>,
    pub(super) lambda: Vec<Scalar<'g>>,
}

/// A result in the making.
pub struct Value<'g> {
    /// Its lengths, rows first.
    lengths: Vec<usize>,
    entries: Vec<Scalar<'g>>,
}

pub(super) fn scalar(x: Scalar<'_>) -> Value<'_> {
    Value {
        lengths: Vec::new(),
        entries: vec![x],
    }
}

pub(super) fn vector(entries: Vec<Scalar<'_>>) -> Value<'_> {
    Value {
        lengths: vec![entries.len()],
        entries,
    }
}

pub(super) fn matrix(rows: Matrix<'_>) -> Value<'_> {
    Value {
        lengths: vec![rows.len(), rows.first().map_or(0, Vec::len)],
        entries: rows.concat(),
    }
}

/// A result of a quantity: its symbol, what its dimensions are, rows first, and its meaning.
pub(super) type QuantityResult = (&'static str, &'static [Dimension], &'static str);

pub(super) const SCALAR: &[Dimension] = &[];
pub(super) const VECTOR: &[Dimension] = &[Dimension::Velocities];
pub(super) const SQUARE: &[Dimension] = &[Dimension::Velocities, Dimension::Velocities];
pub(super) const BY_INPUTS: &[Dimension] = &[Dimension::Velocities, Dimension::Inputs];
pub(super) const PARAMETERS: &[Dimension] = &[Dimension::Parameters];
pub(super) const REGRESSOR: &[Dimension] = &[Dimension::Velocities, Dimension::Parameters];
const IN_SPACE: &[Dimension] = &[Dimension::Fixed];
const ROTATION: &[Dimension] = &[Dimension::Fixed, Dimension::Fixed];
const FRAME_JACOBIAN: &[Dimension] = &[Dimension::Fixed, Dimension::Velocities];

/// How a quantity is built from the equations of motion.
pub(super) type Build = for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>;

/// A row of the catalogue.
pub struct Quantity {
    /// Name of the generated function.
    pub name: &'static str,
    pub(super) summary: &'static str,
    pub(super) equation: &'static str,
    pub(super) arguments: &'static [Argument],
    pub(super) results: &'static [QuantityResult],
    pub(super) notes: &'static [&'static str],
    pub(super) build: Build,
    /// Which of several derivations was cheapest, for the documentation.
    pub(super) route: fn(&Formulations<'_>) -> Option<&'static str>,
    /// Constants that stand before the function.
    pub(super) constants: fn(&Model, &Formulations<'_>, &Program) -> Vec<Constant>,
    /// Whether it divides by the pivots of the mass matrix.
    pub(super) needs_inverse: bool,
    /// Operations that straight-line code takes at least, for robots that make it very large.
    pub(super) straight_size: Option<Estimate>,
    /// How it is written as loops over joints, where it can be.
    pub(super) loops: Option<Loops>,
}

/// A function as loops over joints.
#[derive(Clone, Copy)]
pub(super) enum Loops {
    /// The loops of the function itself, and the operations that they stand for.
    PerJoint { build: BuildLoops, size: Estimate },
    /// Its results are affine in those of another function, which it calls.
    Affine { called: &'static str },
}

/// How loops over joints are built.
pub(super) type BuildLoops =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>, Vec<InputArray>) -> Arrays;

impl Quantity {
    /// What a row does not say: nothing of it is large, and it needs nothing beside it.
    pub(super) const PLAIN: Self = Self {
        name: "",
        summary: "",
        equation: "",
        arguments: &[],
        results: &[],
        notes: &[],
        build: |_, _| Vec::new(),
        route: |_| None,
        constants: |_, _, _| Vec::new(),
        needs_inverse: false,
        straight_size: None,
        loops: None,
    };
}

/// The row of a function that every robot has.
pub(super) fn quantity(name: &str) -> Option<&'static Quantity> {
    let mut rows = quantities().chain(ON_REQUEST);
    rows.find(|row| row.name == name)
}

/// Every function but those of named frames, in the order of the generated module.
pub fn quantities() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES.iter().chain(regressor_quantities::QUANTITIES)
}

/// [`quantities()`] with the rows of friction that a model needs: where a friction law depends on the position of its
/// joint, they take y too.
fn quantities_of(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    let by_position: &[Quantity] = match forces::friction_depends_on_position(model) {
        true => FRICTION_BY_POSITION,
        false => &[],
    };
    quantities().map(move |quantity| {
        let replacement = by_position.iter().find(|row| row.name == quantity.name);
        replacement.unwrap_or(quantity)
    })
}

/// Rows that replace those of the same name where a friction law depends on the position.
const FRICTION_BY_POSITION: &[Quantity] = &[
    Quantity {
        name: "friction_torques",
        summary: "Joint friction `τ(y, ẏ)`.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "τ",
            VECTOR,
            "positive where friction brakes a positive velocity, at the joint",
        )],
        notes: &[],
        build: friction_torques,
        ..Quantity::PLAIN
    },
    regressor_quantities::FRICTION_PARAMETERS_BY_POSITION,
    regressor_quantities::FRICTION_REGRESSOR_BY_POSITION,
];

fn friction_torques<'g>(
    equations: &Equations<'_, 'g>,
    arguments: &Arguments<'g>,
) -> Vec<Value<'g>> {
    vec![vector(
        equations.friction_torques(&arguments.y, &arguments.v),
    )]
}

/// The quantities of a model, and those that are derived where they are asked for by name.
pub(super) fn all_quantities(model: &Model) -> impl Iterator<Item = &'static Quantity> {
    quantities_of(model).chain(ON_REQUEST)
}

/// Whether a function is derived only where it is asked for by name.
pub(super) fn is_on_request(name: &str) -> bool {
    ON_REQUEST.iter().any(|quantity| quantity.name == name)
}

/// The equations of motion and what follows from them.
const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "mass_matrix",
        summary: "Mass matrix `M(y)`.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates],
        results: &[(
            "M",
            SQUARE,
            "symmetric, positive definite, both triangles filled",
        )],
        notes: &[
            "Composite rigid bodies (Walker and Orin 1982; Featherstone 2008, ch. 6), rotors included.",
        ],
        build: |equations, arguments| vec![matrix(equations.mass_matrix(&arguments.y))],
        constants: |_, _, program| {
            module_constants::patterns(program, &[("MASS_MATRIX_NONZERO", "M")])
        },
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "coriolis_forces",
        summary: "Coriolis, centrifugal and gyroscopic forces `k(y, ẏ)`.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "k",
            VECTOR,
            "on the left-hand side: without gravity, springs and friction",
        )],
        notes: &["Recursive Newton–Euler equations without gravity and accelerations."],
        build: |equations, arguments| {
            vec![vector(
                equations.coriolis_forces(&arguments.y, &arguments.v),
            )]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "gravity_forces",
        summary: "Gravity's share of the applied forces.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates],
        results: &[(
            "q_gravity",
            VECTOR,
            "positive where gravity drives the joint forwards; −∂V/∂y",
        )],
        notes: &[],
        build: |equations, arguments| vec![vector(equations.gravity_forces(&arguments.y))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: "spring_forces",
        summary: "Springs' and dampers' share of the applied forces.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "q_springs",
            VECTOR,
            "positive where a spring drives the joint forwards",
        )],
        notes: &[],
        build: |equations, arguments| {
            vec![vector(equations.spring_forces(&arguments.y, &arguments.v))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "friction_torques",
        summary: "Joint friction `τ(ẏ)`.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Velocities],
        results: &[("τ", VECTOR, "positive for positive velocity, at the joint")],
        notes: &[],
        build: friction_torques,
        ..Quantity::PLAIN
    },
    Quantity {
        name: "applied_forces",
        summary: "Applied forces `q(y, ẏ)`.",
        equation: "q = gravity_forces + spring_forces − friction_torques",
        arguments: &[Coordinates, Velocities],
        results: &[("q", VECTOR, "on the right-hand side, without the inputs")],
        notes: &[],
        build: |equations, arguments| {
            vec![vector(equations.applied_forces(&arguments.y, &arguments.v))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "bias_forces",
        summary: "Bias forces `k − q_gravity`.",
        equation: "k − gravity_forces",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "b",
            VECTOR,
            "what holds the accelerations at zero, without springs and friction",
        )],
        notes: &["Recursive Newton–Euler equations at ÿ = 0. Pinocchio calls this `nle`."],
        build: |equations, arguments| {
            vec![vector(equations.bias_forces(&arguments.y, &arguments.v))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "input_matrix",
        summary: "Input matrix `B`.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[],
        results: &[(
            "B",
            BY_INPUTS,
            "gear ratios, times motor constants where inputs are currents",
        )],
        notes: &[],
        build: |equations, _| {
            vec![matrix(forces::input_matrix(
                equations.graph,
                equations.model,
            ))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "equations_of_motion",
        summary: "Mass matrix, Coriolis forces and applied forces at once.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates, Velocities],
        results: &[
            (
                "M",
                SQUARE,
                "symmetric, positive definite, both triangles filled",
            ),
            ("k", VECTOR, "Coriolis, centrifugal and gyroscopic forces"),
            ("q", VECTOR, "gravity, springs and friction"),
        ],
        notes: &["What the three have in common is computed once."],
        build: |equations, arguments| {
            let (y, v) = (&arguments.y, &arguments.v);
            let k = equations.coriolis_forces(y, v);
            vec![
                matrix(equations.mass_matrix(y)),
                vector(k),
                vector(equations.applied_forces(y, v)),
            ]
        },
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "inverse_dynamics",
        summary: "Inverse dynamics: the joint forces of a motion.",
        equation: "M(y) ÿ + k(y, ẏ) − q(y, ẏ)",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[(
            "B u",
            VECTOR,
            "what the drives exert at the joints; u_ff = B⁻¹ times it",
        )],
        notes: &[
            "Recursive Newton–Euler equations (Luh, Walker and Paul 1980) with base parameters.",
        ],
        build: |equations, arguments| {
            vec![vector(equations.inverse_dynamics(
                &arguments.y,
                &arguments.v,
                &arguments.a,
            ))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "forward_dynamics",
        summary: "Forward dynamics: the accelerations that inputs cause.",
        equation: "ÿ = M⁻¹ (q + B u − k)",
        arguments: &[Coordinates, Velocities, Inputs],
        results: &[("ÿ", VECTOR, "accelerations")],
        notes: &[],
        build: |equations, arguments| {
            vec![vector(equations.forward_dynamics(
                &arguments.y,
                &arguments.v,
                &arguments.u,
            ))]
        },
        route: |formulations| Some(formulations.forward_dynamics().description()),
        needs_inverse: true,
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "mass_matrix_and_bias_forces",
        summary: "Mass matrix and bias forces at once.",
        equation: "M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u",
        arguments: &[Coordinates, Velocities],
        results: &[
            (
                "M",
                SQUARE,
                "symmetric, positive definite, both triangles filled",
            ),
            (
                "b",
                VECTOR,
                "k − gravity_forces: what holds the accelerations at zero, without springs and friction",
            ),
        ],
        notes: &["What both have in common is computed once."],
        build: |equations, arguments| {
            let (mass, bias) = equations.mass_matrix_and_bias(&arguments.y, &arguments.v);
            vec![matrix(mass), vector(bias)]
        },
        straight_size: Some(Estimate::MassMatrix),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "inverse_dynamics_derivatives",
        summary: "Inverse dynamics with its Jacobians.",
        equation: "δ(M ÿ + k − q) = ∂/∂y δy + ∂/∂ẏ δẏ + M δÿ",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[
            ("B u", VECTOR, "the forces M ÿ + k − q, on the joint side"),
            ("∂/∂y", SQUARE, "row i = force i"),
            ("∂/∂ẏ", SQUARE, "row i = force i, friction included"),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, a, .. }| {
            let result = equations.inverse_dynamics_derivatives(MotionInput { y, v, a });
            vec![
                vector(result.forces),
                matrix(result.by_coordinates),
                matrix(result.by_velocities),
            ]
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::PerJoint {
            build: base_frame::inverse_dynamics_derivatives,
            size: Estimate::Pairs,
        }),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "inverse_dynamics_derivatives_and_mass_matrix",
        summary: "Inverse dynamics with all its Jacobians; that by the accelerations is `M(y)`.",
        equation: "δ(M ÿ + k − q) = ∂/∂y δy + ∂/∂ẏ δẏ + M δÿ",
        arguments: &[Coordinates, Velocities, Accelerations],
        results: &[
            ("B u", VECTOR, "the forces M ÿ + k − q, on the joint side"),
            ("∂/∂y", SQUARE, "row i = force i"),
            ("∂/∂ẏ", SQUARE, "row i = force i, friction included"),
            (
                "M",
                SQUARE,
                "symmetric, positive definite, both triangles filled",
            ),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, a, .. }| {
            let result = equations.inverse_dynamics_derivatives(MotionInput { y, v, a });
            let jacobians = [
                result.by_coordinates,
                result.by_velocities,
                result.mass_matrix,
            ]
            .map(matrix);
            std::iter::once(vector(result.forces))
                .chain(jacobians)
                .collect()
        },
        route: |formulations| Some(formulations.derivatives().description()),
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::PerJoint {
            build: base_frame::inverse_dynamics_derivatives_and_mass_matrix,
            size: Estimate::Pairs,
        }),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "forward_dynamics_derivatives",
        summary: "Forward dynamics with its Jacobians.",
        equation: "∂ÿ = −M⁻¹ ∂(M ÿ + k − q), ∂ÿ/∂(B u) = M⁻¹",
        arguments: &[Coordinates, Velocities, Inputs],
        results: &[
            ("ÿ", VECTOR, "accelerations"),
            ("∂ÿ/∂y", SQUARE, "row i = acceleration i"),
            ("∂ÿ/∂ẏ", SQUARE, "row i = acceleration i"),
            (
                "M⁻¹",
                SQUARE,
                "symmetric, both triangles filled; ∂ÿ/∂u = M⁻¹ B",
            ),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, u, .. }| {
            let result = equations.forward_dynamics_derivatives(y, v, u);
            let jacobians =
                [result.by_coordinates, result.by_velocities, result.inverse].map(matrix);
            std::iter::once(vector(result.accelerations))
                .chain(jacobians)
                .collect()
        },
        route: |formulations| Some(formulations.derivatives().description()),
        needs_inverse: true,
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::PerJoint {
            build: base_frame::forward_dynamics_derivatives,
            size: Estimate::Inverse,
        }),
        ..Quantity::PLAIN
    },
    Quantity {
        name: "linearize",
        summary: "Linearization of the accelerations in continuous time.",
        equation: "ÿ ≈ A_y y + A_v ẏ + B_x u + c; with x = (y, ẏ) the upper halves of A, B_x and c are [0 I], 0 and 0",
        arguments: &[Coordinates, Velocities, Inputs],
        results: &[
            ("A_y", SQUARE, "∂ÿ/∂y, row i = acceleration i"),
            ("A_v", SQUARE, "∂ÿ/∂ẏ, row i = acceleration i"),
            ("B_x", BY_INPUTS, "∂ÿ/∂u, row i = acceleration i"),
            ("c", VECTOR, "affine remainder ÿ − A_y y − A_v ẏ − B_x u"),
        ],
        notes: DERIVATIVE_NOTES,
        build: |equations, Arguments { y, v, u, .. }| {
            let result = equations.linearize(y, v, u);
            let jacobians = [
                result.by_coordinates,
                result.by_velocities,
                result.by_inputs,
            ]
            .map(matrix);
            jacobians
                .into_iter()
                .chain([vector(result.remainder)])
                .collect()
        },
        route: |formulations| Some(formulations.derivatives().description()),
        needs_inverse: true,
        constants: |_, _, program| {
            module_constants::patterns(
                program,
                &[
                    ("A_Y_NONZERO", "A_y"),
                    ("A_V_NONZERO", "A_v"),
                    ("B_X_NONZERO", "B_x"),
                ],
            )
        },
        straight_size: Some(Estimate::MassMatrix),
        loops: Some(Loops::Affine {
            called: "forward_dynamics_derivatives",
        }),
    },
    Quantity {
        name: "kinetic_energy",
        summary: "Kinetic energy, rotors included.",
        equation: "T = ½ ẏᵀ M ẏ",
        arguments: &[Coordinates, Velocities],
        results: &[("T", SCALAR, "energy [J]")],
        notes: &[],
        build: |equations, arguments| {
            vec![scalar(equations.kinetic_energy(&arguments.y, &arguments.v))]
        },
        ..Quantity::PLAIN
    },
    Quantity {
        name: "potential_energy",
        summary: "Potential energy of gravity.",
        equation: "V = −g · Σ m c",
        arguments: &[Coordinates],
        results: &[(
            "V",
            SCALAR,
            "energy [J], of the moving bodies, zero with their masses at the height of the base frame; springs not included",
        )],
        notes: &[],
        build: |equations, arguments| vec![scalar(equations.potential_energy(&arguments.y))],
        ..Quantity::PLAIN
    },
];

/// Functions that are derived where they are asked for by name: they are large, and few need them.
const ON_REQUEST: &[Quantity] = &[hessian::QUANTITY];

const DERIVATIVE_NOTES: &[&str] = &[
    "Analytic, with composite bodies (Carpentier and Mansard 2018; Singh, Russell and Wensing 2022).",
];

/// How a quantity of a named frame is built.
type FrameBuild =
    for<'g> fn(&Equations<'_, 'g>, &Arguments<'g>, usize, &ScalarPose<'g>) -> Vec<Value<'g>>;

/// A function of each named frame: `frame_<name>_<suffix>`.
pub(super) struct FrameQuantity {
    suffix: &'static str,
    summary: &'static str,
    equation: &'static str,
    arguments: &'static [Argument],
    results: &'static [QuantityResult],
    build: FrameBuild,
}

pub(super) const FRAME_QUANTITIES: &[FrameQuantity] = &[
    FrameQuantity {
        suffix: "pose",
        summary: "Pose of the frame",
        equation: "r_base = p + R r_frame",
        arguments: &[Coordinates],
        results: &[
            ("p", IN_SPACE, "origin in the base frame [m]"),
            (
                "R",
                ROTATION,
                "rotation matrix, columns are the frame's axes",
            ),
        ],
        build: |equations, arguments, link, pose| {
            let pose = equations.base_poses(&arguments.y).pose(link, pose);
            let rows = (0..3)
                .map(|row| pose.axes.iter().map(|axis| axis[row]).collect())
                .collect();
            vec![vector(pose.origin.0.to_vec()), matrix(rows)]
        },
    },
    FrameQuantity {
        suffix: "jacobian",
        summary: "Jacobian of the frame",
        equation: "(ṗ, ω) = J(y) ẏ",
        arguments: &[Coordinates],
        results: &[(
            "J",
            FRAME_JACOBIAN,
            "rows: velocity of the origin, then angular velocity, in the axes of the base frame",
        )],
        build: |equations, arguments, link, pose| {
            vec![matrix(
                equations.base_poses(&arguments.y).jacobian(link, pose),
            )]
        },
    },
    FrameQuantity {
        suffix: "jacobian_rate_times_velocity",
        summary: "Acceleration of the frame at ÿ = 0",
        equation: "(p̈, ω̇) = J(y) ÿ + J̇ ẏ",
        arguments: &[Coordinates, Velocities],
        results: &[(
            "J̇ẏ",
            IN_SPACE,
            "acceleration of the origin [m/s²], then angular acceleration [rad/s²], in the axes of the base frame",
        )],
        build: |equations, arguments, link, pose| {
            let (y, v) = (&arguments.y, &arguments.v);
            vec![vector(
                equations.base_poses(y).jacobian_rate(link, pose, y, v),
            )]
        },
    },
];

/// Names of all functions of a model, in the order of the generated module.
pub fn names(model: &Model) -> Vec<String> {
    let quantities = all_quantities(model).map(|quantity| quantity.name.to_owned());
    let frames = model
        .frames
        .iter()
        .flat_map(|frame| FRAME_QUANTITIES.iter().map(|q| frame_name(frame, q)));
    let compositions = Composition::ALL.iter().map(|each| each.name().to_owned());
    quantities.chain(frames).chain(compositions).collect()
}

pub(super) fn frame_name(frame: &Frame, quantity: &FrameQuantity) -> String {
    format!("frame_{}_{}", frame.identifier, quantity.suffix)
}

/// The selected functions that call others; an empty selection means all.
pub fn compositions(selection: &[String]) -> Vec<Composition> {
    let is_selected = |each: &Composition| {
        selection.is_empty() || selection.iter().any(|name| name == each.name())
    };
    Composition::ALL.into_iter().filter(is_selected).collect()
}

/// Derives the selected functions of a model, and those that selected ones call; an empty selection means all but those
/// on request and those that cannot be generated, `frames` all functions of named frames.
///
/// - `most`: operations of the largest function that is wanted, see [`MOST_OPERATIONS`](super::size::MOST_OPERATIONS)
///
/// # Errors
/// As [`selection::derive`](super::selection::derive()).
pub fn derive(
    model: &Model,
    selection: &[String],
    most: usize,
) -> Result<Vec<Function>, Diagnostics> {
    derive_in_form(model, selection, most, Form::Cheapest, &[])
}

/// As [`derive()`], with the form of large functions chosen.
///
/// - `straight`: functions that are straight-line code in any case
///
/// # Errors
/// As [`derive()`].
pub fn derive_in_form(
    model: &Model,
    selection: &[String],
    most: usize,
    form: Form,
    straight: &[String],
) -> Result<Vec<Function>, Diagnostics> {
    let request = Request {
        names: selection,
        most,
        form,
        straight,
    };
    Ok(selection::derive(model, &request)?.functions)
}

/// # Errors
/// `unknown-function` for each name that the model does not have; `frames` stands for all of named frames.
pub(crate) fn check_names(model: &Model, selection: &[String]) -> Result<(), Diagnostics> {
    let known = names(model);
    let unknown = selection
        .iter()
        .filter(|name| *name != "frames" && !known.contains(name));
    let problems: Vec<_> = unknown
        .map(|name| {
            Diagnostic::error("unknown-function", format!("there is no function `{name}`"))
                .help(format!("choose from: {}, frames", known.join(", ")))
        })
        .collect();
    if problems.is_empty() {
        Ok(())
    } else {
        Err(Diagnostics::new(problems))
    }
}

pub(super) fn derive_quantity(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &'static Quantity,
    forms: &Forms<'_>,
) -> Function {
    let Derived { program, arrays } = forms.derive(quantity);
    let mut notes: Vec<String> = quantity.notes.iter().map(|&note| note.to_owned()).collect();
    if arrays.is_some() {
        notes = vec![array_form::NOTE.to_owned()];
    } else {
        notes.extend((quantity.route)(formulations).map(str::to_owned));
    }
    let mut function = described(model, quantity.arguments, quantity.results, program).named(
        quantity.name.to_owned(),
        quantity.summary.to_owned(),
        quantity.equation,
        notes,
    );
    function.arrays = arrays;
    function
        .notes
        .extend(forces::jump_note(model, &function.program));
    function.constants = (quantity.constants)(model, formulations, &function.program);
    function
}

/// The mass matrix is positive definite, unless the description has it otherwise.
pub(super) fn say_definiteness(found: Definiteness, function: &mut Function) {
    const REGULAR: &str = "positive definite";
    let found = match found {
        Definiteness::Positive => return,
        Definiteness::Semidefinite => "positive semidefinite",
        Definiteness::Indefinite => "indefinite as described",
    };
    for result in &mut function.results {
        *result = result.replace(REGULAR, found);
    }
}

pub(super) fn derive_frame(
    model: &Model,
    formulations: &Formulations<'_>,
    frame: &Frame,
    quantity: &FrameQuantity,
) -> Function {
    let summary = format!("{} `{}`.", quantity.summary, frame.name);
    let program = assemble(
        model,
        formulations,
        quantity.arguments,
        quantity.results,
        |equations, arguments| {
            let pose = ScalarPose::new(equations.graph, &frame.pose);
            (quantity.build)(equations, arguments, frame.link, &pose)
        },
    );
    described(model, quantity.arguments, quantity.results, program).named(
        frame_name(frame, quantity),
        summary,
        quantity.equation,
        Vec::new(),
    )
}

/// Inputs of a graph for the arguments of a function.
pub(super) fn arguments_of<'g>(
    graph: &'g Graph,
    model: &Model,
    arguments: &[Argument],
) -> (Arguments<'g>, Vec<InputArray>) {
    let scalars = |argument: Argument| match arguments.iter().position(|&other| other == argument) {
        Some(array) => (0..argument.extent(model).len)
            .map(|index| graph.input(array, index))
            .collect(),
        None => Vec::new(),
    };
    let inputs = arguments.iter().map(|argument| InputArray {
        name: argument.name().to_owned(),
        extent: argument.extent(model),
    });
    let inputs = inputs.collect();
    let arguments = Arguments {
        y: scalars(Coordinates),
        v: scalars(Velocities),
        a: scalars(Accelerations),
        u: scalars(Inputs),
        lambda: scalars(Multipliers),
    };
    (arguments, inputs)
}

/// A function as straight-line code.
pub(super) fn straight_program(
    model: &Model,
    formulations: &Formulations<'_>,
    quantity: &Quantity,
) -> Program {
    assemble(
        model,
        formulations,
        quantity.arguments,
        quantity.results,
        |equations, arguments| (quantity.build)(equations, arguments),
    )
}

/// Builds the graph of a function and lowers it.
fn assemble(
    model: &Model,
    formulations: &Formulations<'_>,
    arguments: &[Argument],
    results: &[QuantityResult],
    build: impl for<'g> FnOnce(&Equations<'_, 'g>, &Arguments<'g>) -> Vec<Value<'g>>,
) -> Program {
    let graph = Graph::new();
    let (inputs_of_graph, inputs) = arguments_of(&graph, model, arguments);
    let values = build(
        &Equations {
            graph: &graph,
            model,
            formulations,
        },
        &inputs_of_graph,
    );
    let outputs: Vec<_> = values
        .iter()
        .zip(results)
        .map(|(value, (symbol, dimensions, _))| GraphOutput {
            name: (*symbol).to_owned(),
            shape: Shape::new(dimensions, &value.lengths),
            entries: value.entries.iter().map(|x| x.edge()).collect(),
        })
        .collect();
    lower(&graph, inputs, &outputs)
}

/// A function without a name.
fn described(
    model: &Model,
    arguments: &[Argument],
    results: &[QuantityResult],
    program: Program,
) -> Function {
    Function {
        name: String::new(),
        summary: String::new(),
        equation: String::new(),
        arguments: arguments
            .iter()
            .map(|argument| argument.text(model))
            .collect(),
        results: results
            .iter()
            .map(|(.., meaning)| (*meaning).to_owned())
            .collect(),
        notes: Vec::new(),
        constants: Vec::new(),
        program,
        arrays: None,
    }
}

impl Function {
    fn named(self, name: String, summary: String, equation: &str, notes: Vec<String>) -> Self {
        Self {
            name,
            summary,
            equation: equation.to_owned(),
            notes,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::composition::Composition;
    use crate::model::FUNCTIONS;

    #[test]
    fn descriptions_may_ask_for_every_function() {
        let names = quantities().chain(ON_REQUEST).map(|quantity| quantity.name);
        let composed = Composition::ALL.map(Composition::name);
        let mut names: Vec<&str> = names.chain(composed).chain(["frames"]).collect();
        let mut known = FUNCTIONS.to_vec();
        names.sort_unstable();
        known.sort_unstable();
        assert_eq!(names, known);
    }
}
