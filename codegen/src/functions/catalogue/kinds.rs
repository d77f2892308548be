//! The table of kinds of robots, for example with prescribed motions of joints, and the functions and
//! products that differ or are missing.

use std::cell::OnceCell;

use super::frame_inputs::{self, beyond};
use super::kind::Difference::{self, Missing};
use super::kind::{Kind, MISSING, Otherwise, Product, equation, notes};
use super::load_friction::{self, KINK, LOAD, MOTION};
use super::motion::{FRICTION_BY_POSITION, INPUT_MATRIX_BY_POSITION, LINEARIZE_ON_TANGENT};
use super::{driven, regressors, wrenches};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::dynamics::forces;
use crate::model::{Drive, Joint, JointKind, Model};

/// All kinds of robots. If a robot is of several kinds, the notes of the kinds have this order.
pub static KINDS: [Kind; 11] = [
    Kind {
        robots: "a singular mass matrix",
        code: "singular-mass-matrix",
        condition: "the mass matrix is singular: no inertia moves with {}",
        example: |model| {
            Some(model.motions_without_inertia().join(", ")).filter(|motions| !motions.is_empty())
        },
        differences: &[
            (
                "forward_dynamics forward_dynamics_derivatives linearize discretize step step_derivatives \
                 forward_dynamics_with_wrenches forward_dynamics_derivatives_with_wrenches",
                Missing {
                    why: "",
                    help: "describe a mass or a rotor for this motion, or select only functions that do not need the inverse of M",
                },
            ),
            ("acados", MISSING),
        ],
        ..Kind::PLAIN
    },
    Kind {
        robots: "friction that depends on the position",
        code: "friction-by-position",
        condition: "the friction depends on the position",
        example: |model| forces::friction_depends_on_position(model).then(String::new),
        replaces: &[
            FRICTION_BY_POSITION,
            regressors::PARAMETERS_BY_POSITION,
            regressors::REGRESSOR_BY_POSITION,
        ],
        ..Kind::PLAIN
    },
    Kind {
        robots: "driven joints",
        code: "driven-joint",
        condition: "the motion of joint `{}` is prescribed",
        example: |model| name(model.driven_joints().next()),
        adds: driven::QUANTITIES,
        differences: &[
            (
                "coriolis_forces bias_forces equations_of_motion mass_matrix_and_bias_forces",
                notes(&[
                    "The forces include M_d d̈, the inertial forces of the driven joints' accelerations d̈, so that \
                     M ÿ + k = q + B u holds for the other joints.",
                ]),
            ),
            (
                "kinetic_energy",
                equation(
                    "½ (ẏ, ḋ)ᵀ M (ẏ, ḋ)",
                    &["M is the mass matrix of all joints, including driven joints."],
                ),
            ),
            ("joint_wrenches", notes(&["The rows of the driven joints follow the rows of the coordinates."])),
            (
                "center_of_mass_jacobian centroidal_momentum_matrix frame_NAME_jacobian",
                notes(&["The columns of the driven joints follow the columns of the coordinates."]),
            ),
            (
                "frame_NAME_jacobian_rate_times_velocity",
                notes(&["The accelerations of the driven joints are taken from d."]),
            ),
            (
                "discretize step step_derivatives",
                Missing {
                    why: ": this motion is needed throughout the sample time",
                    help: "`forward_dynamics` and `linearize` take the driven motion at one time; \
                           `DrivenRobot` of gelenk-runtime computes steps from them with a motion over time",
                },
            ),
            ("loops closed-forms casadi acados export identification", MISSING),
        ],
        ..Kind::PLAIN
    },
    Kind {
        robots: "forces between frames",
        code: "frame-forces",
        condition: "the force `{}` acts between frames",
        example: |model| model.point_forces.first().map(|force| force.name.clone()),
        differences: &[("joint_wrenches", beyond()), ("loops closed-forms", MISSING)],
        ..Kind::PLAIN
    },
    Kind {
        robots: "inputs at frames",
        code: "frame-forces",
        condition: "the input `{}` acts at a frame",
        example: |model| model.force_inputs.first().map(|input| input.name.clone()),
        adds: frame_inputs::QUANTITIES,
        replaces: &[INPUT_MATRIX_BY_POSITION],
        differences: &[
            ("joint_wrenches", beyond()),
            (
                "forward_dynamics_derivatives",
                equation("∂ÿ = −M⁻¹ ∂(M ÿ + k − q − B(y) u), ∂ÿ/∂(B u) = M⁻¹", &[]),
            ),
            (
                "inverse_dynamics_hessian",
                Difference::Documented(Otherwise {
                    only_note: Some(
                        "The constraint `M ÿ + k − q = B(y) u` with multipliers λ adds these blocks to the \
                         Hessian of the Lagrangian. It also adds the second derivatives of `−λᵀ B(y) u`, which \
                         are not included here.",
                    ),
                    ..Otherwise::ROW
                }),
            ),
            ("loops closed-forms", MISSING),
        ],
    },
    Kind {
        robots: "load-dependent friction",
        code: "load-friction",
        condition: "joint `{}` has load-dependent friction",
        example: |model| name(model.joints().find(|joint| !joint.load_friction.is_empty())),
        adds: load_friction::QUANTITIES,
        differences: &[
            (
                "mass_matrix coriolis_forces input_matrix equations_of_motion mass_matrix_and_bias_forces",
                equation(MOTION, &[LOAD]),
            ),
            (
                "applied_forces friction_torques friction_parameters friction_regressor",
                notes(&[
                    "Excludes the load-dependent friction `|τ_l| load_friction`, which depends on the accelerations.",
                ]),
            ),
            (
                "inverse_dynamics",
                equation(
                    "τ_l + friction_torques + |τ_l| s₁(y, ẏ), τ_l = M ÿ + k − gravity_forces − spring_forces",
                    &[LOAD],
                ),
            ),
            (
                "forward_dynamics",
                equation(
                    "ÿ = M⁻¹ (τ_l + gravity_forces + spring_forces − k), τ_l = w / (1 + s₁ sign w), w = B u − friction_torques",
                    &[
                        LOAD,
                        "Since `|s₁| < 1`, `w` (the drive force without `friction_torques`) has the sign of \
                         the load, so each joint is solved separately.",
                    ],
                ),
            ),
            (
                "inverse_dynamics_derivatives",
                Difference::Documented(Otherwise {
                    equation: Some("δ(B u) = ∂/∂y δy + ∂/∂ẏ δẏ + D M δÿ, D = diag(1 + s₁ sign τ_l)"),
                    first_result: Some("drive forces at the joints, including load-dependent friction"),
                    notes: &[LOAD, KINK],
                    ..Otherwise::ROW
                }),
            ),
            ("linearize", notes(&[LOAD, KINK])),
            (
                "inertial_regressor",
                notes(&[
                    "`W π − springs` is the load `τ_l`. The inverse dynamics also include `|τ_l| load_friction`.",
                ]),
            ),
            (
                "step",
                equation(
                    "x⁺ ≈ x + ∫ f(x, u) dt with x = (y, ẏ), f = (ẏ, forward_dynamics(y, ẏ, u)) and u held",
                    &[],
                ),
            ),
            (
                "inverse_dynamics_derivatives_and_mass_matrix forward_dynamics_derivatives inverse_dynamics_hessian",
                Missing {
                    why: ": the derivatives are not M and M⁻¹, but have an additional factor",
                    help: "use `inverse_dynamics_derivatives`, whose documentation has the factor D, or \
                           `linearize`",
                },
            ),
            ("loops closed-forms", MISSING),
        ],
        ..Kind::PLAIN
    },
    Kind {
        robots: "wrenches as arguments",
        code: "wrenches",
        condition: "the wrench `{}` is an argument",
        example: |model| model.wrenches.first().map(|wrench| wrench.name.clone()),
        adds: wrenches::QUANTITIES,
        differences: &[("joint_wrenches", beyond())],
        ..Kind::PLAIN
    },
    Kind {
        robots: "spherical or floating joints",
        code: "quaternion-joint",
        condition: "joint `{}` is spherical or floating",
        example: |model| model.quaternion_joints.first().map(|joint| joint.name.clone()),
        replaces: &[LINEARIZE_ON_TANGENT],
        differences: &[
            (
                "input_forces_derivatives inverse_dynamics_derivatives inverse_dynamics_derivatives_and_mass_matrix \
                 inverse_dynamics_derivatives_with_wrenches forward_dynamics_derivatives inverse_dynamics_hessian \
                 forward_dynamics_derivatives_with_wrenches wrench_forces_derivatives",
                notes(&[
                    "Column j of ∂/∂y is the derivative along ⊕: the derivative of `f(integrate(y, δ))` by δ_j at δ = 0. Velocities are \
                     constant in the frames of their bodies.",
                ]),
            ),
            (
                "joint_wrenches",
                notes(&["A spherical or floating joint has one row, at the index of its last velocity."]),
            ),
            (
                "discretize",
                equation(
                    "x⁺ = A_d x + B_d u + c_d with x = (δ, v), solves δ̇ = D δ + v, v̇ = A_y δ + A_v v + B_x u + c with u held",
                    &[],
                ),
            ),
            (
                "step",
                equation(
                    "(y⁺, ẏ⁺) ≈ the motion with ÿ = forward_dynamics(y, ẏ, u) after the period, u held",
                    &[],
                ),
            ),
            (
                "step_derivatives",
                equation("(y⁺ ⊕ δy⁺, ẏ⁺ + δẏ⁺) = step(y ⊕ δy, ẏ + δẏ, u + δu) to first order", &[]),
            ),
            ("closed-forms", MISSING),
        ],
        ..Kind::PLAIN
    },
    Kind {
        robots: "joints that follow others, or drives that move several joints",
        code: "coupled-joints",
        condition: "joints are coupled by `{}`",
        example: |model| {
            let follower = model.moving_joints().get(model.motion_count()).map(|moving| moving.joint);
            let shared: Option<&Drive> = model.moving_drives().find(|drive| drive.coordinate().is_none());
            name(follower).or_else(|| Some(shared?.name.clone()))
        },
        differences: &[("closed-forms", MISSING)],
        ..Kind::PLAIN
    },
    Kind {
        robots: "helical joints",
        code: "helical-joint",
        condition: "joint `{}` is helical",
        example: |model| {
            let mut moving = model.moving_joints().into_iter().map(|moving| moving.joint);
            name(moving.find(|joint| matches!(joint.kind, JointKind::Helical { .. })))
        },
        differences: &[("closed-forms", MISSING)],
        ..Kind::PLAIN
    },
    Kind {
        robots: "no inputs",
        code: "no-input",
        condition: "the robot has no inputs",
        example: |model| model.inputs().next().is_none().then(String::new),
        differences: &[("acados", MISSING)],
        ..Kind::PLAIN
    },
];

fn name(joint: Option<&Joint>) -> Option<String> {
    joint.map(|joint| joint.name.clone())
}

impl Product {
    /// Whether a robot has the product.
    ///
    /// # Errors
    /// An error with the code of the first kind of the robot that lacks the product.
    pub fn check(&self, model: &Model) -> Result<(), Diagnostics> {
        let refusal = Refusals::new(model).of(self.name);
        let refusal = refusal.map(|refusal| refusal.error(self.missing).help(self.help));
        refusal.map_or(Ok(()), |refusal| Err(refusal.into()))
    }
}

/// Reason why a model lacks a function or product.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refusal {
    code: &'static str,
    because: String,
    help: &'static str,
}

impl Refusal {
    /// Error for a function or product that was requested by name.
    pub(crate) fn error(&self, missing: &str) -> Diagnostic {
        Diagnostic::error(self.code, format!("{missing}, because {}", self.because)).help(self.help)
    }

    /// Note for a function or product that was not requested by name.
    pub(crate) fn note(&self, missing: &str) -> Diagnostic {
        Diagnostic::note("left-out", format!("{missing}, because {}", self.because)).help(self.help)
    }
}

/// Finds missing functions and products of a model. Each kind is tested only once for the model, because some
/// conditions require the mass matrix.
pub(crate) struct Refusals<'m> {
    model: &'m Model,
    examples: [OnceCell<Option<String>>; KINDS.len()],
}

impl<'m> Refusals<'m> {
    pub(crate) fn new(model: &'m Model) -> Self {
        Self { model, examples: [const { OnceCell::new() }; KINDS.len()] }
    }

    /// Reason why the model lacks a function or product; `None` if the model has it.
    ///
    /// - `name`: name of a product, or of a function with `NAME` instead of the frame's name
    pub(crate) fn of(&self, name: &str) -> Option<Refusal> {
        KINDS.iter().zip(&self.examples).find_map(|(kind, example)| {
            let Missing { why, help } = *kind.difference(name)? else { return None };
            let example = example.get_or_init(|| (kind.example)(self.model)).as_ref()?;
            Some(Refusal { code: kind.code, because: kind.condition.replace("{}", example) + why, help })
        })
    }
}

/// Changes of a function's documentation: one for each kind of robots that includes the model.
pub(crate) fn otherwise(model: &Model, name: &str) -> impl Iterator<Item = &'static Otherwise> {
    KINDS.iter().filter_map(move |kind| match kind.difference(name)? {
        Difference::Documented(other) => kind.includes(model).then_some(other),
        Missing { .. } => None,
    })
}
