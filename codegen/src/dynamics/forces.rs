//! Forces of springs, friction and drives at joints.

use crate::graph::{Graph, Scalar};
use crate::kinematics::{Transmission, lower, lower_followed, lower_with};
use crate::model::{Drive, FrictionTerm, Input, Joint, Model, MovingJoint};
use crate::program::{Instruction, Operation, Program};
use gelenk_formula::{Formula, Function};

/// Forces of springs and dampers at joints, by coordinate. They are a part of the applied forces.
pub fn spring_forces<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let mut forces = vec![graph.constant(0.0); model.motion_count()];
    for moving in Moving::of(graph, model) {
        let position = position(&moving.transmission, moving.offset, y);
        let velocity = moving.transmission.motion(v);
        for spring in &moving.joint.springs {
            let force = lower_with(graph, spring, position, velocity);
            moving.transmission.add_force(force, &mut forces);
        }
    }
    forces
}

/// A moving joint, with its ratios to the coordinates as expressions of the graph.
struct Moving<'m, 'g> {
    joint: &'m Joint,
    transmission: Transmission<Scalar<'g>>,
    offset: f64,
}

impl<'m, 'g> Moving<'m, 'g> {
    fn of(graph: &'g Graph, model: &'m Model) -> Vec<Self> {
        let moving = |moving: MovingJoint<'m>| Self {
            joint: moving.joint,
            transmission: lower_followed(graph, &moving.follows),
            offset: moving.offset,
        };
        model.moving_joints().into_iter().map(moving).collect()
    }
}

/// Position `G y + g₀` of a joint that follows coordinates y with the ratios G and the offset g₀.
fn position<'g>(transmission: &Transmission<Scalar<'g>>, offset: f64, y: &[Scalar<'g>]) -> Scalar<'g> {
    let position = transmission.motion(y);
    if offset == 0.0 { position } else { position + position.constant(offset) }
}

/// An object with friction laws: a joint, or the shaft of a drive on several coordinates.
struct Rubbing<'m, 'g> {
    name: &'m str,
    terms: &'m [FrictionTerm],
    transmission: Transmission<Scalar<'g>>,
    offset: f64,
}

impl<'m, 'g> Rubbing<'m, 'g> {
    fn of(graph: &'g Graph, model: &'m Model) -> Vec<Self> {
        let joint = |moving: Moving<'m, 'g>| Self {
            name: &moving.joint.name,
            terms: &moving.joint.friction,
            transmission: moving.transmission,
            offset: moving.offset,
        };
        let shaft = |drive: &'m Drive| Self {
            name: &drive.name,
            terms: &drive.friction,
            transmission: lower_followed(graph, &drive.acts_on).scaled(lower(graph, &drive.gear_ratio)),
            offset: 0.0,
        };
        let joints = Moving::of(graph, model).into_iter().map(joint);
        joints.chain(model.rubbing_drives().map(shaft)).collect()
    }
}

/// Whether a friction law of the model depends on the position, so that the friction torques are τ(y, ẏ) and
/// not τ(ẏ).
pub fn friction_depends_on_position(model: &Model) -> bool {
    let moving = model.moving_joints();
    let shafts = model.rubbing_drives().flat_map(|drive| &drive.friction);
    let mut terms = moving.iter().flat_map(|moving| &moving.joint.friction).chain(shafts);
    terms.any(|term| term.basis.depends_on_position())
}

/// Friction torques τ by coordinate, without load-dependent friction. They are subtracted from the applied
/// forces.
///
/// - `y`: may be empty if no law depends on the position
pub fn friction_torques<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<Scalar<'g>> {
    let mut torques = vec![graph.constant(0.0); model.motion_count()];
    for rubbing in Rubbing::of(graph, model) {
        for term in rubbing.terms {
            let basis = rubbing.friction_basis(term, y, v);
            rubbing.transmission.add_force(lower(graph, &term.coefficient) * basis, &mut torques);
        }
    }
    torques
}

/// Sum of the friction terms of a joint at the position `y` and the velocity `v`. `y` may be `None` if no
/// term depends on the position.
pub(super) fn friction_sum<'g>(
    graph: &'g Graph,
    terms: &[FrictionTerm],
    y: Option<&Scalar<'g>>,
    v: Scalar<'g>,
) -> Scalar<'g> {
    terms.iter().fold(graph.constant(0.0), |sum, term| {
        let basis = friction_basis(graph, term, y, v);
        sum + lower(graph, &term.coefficient) * basis
    })
}

fn friction_basis<'g>(
    graph: &'g Graph,
    term: &FrictionTerm,
    y: Option<&Scalar<'g>>,
    v: Scalar<'g>,
) -> Scalar<'g> {
    let y = match (y, term.basis.depends_on_position()) {
        (Some(&y), _) => y,
        // This value is not used, because the basis does not depend on the position.
        (None, false) => graph.constant(0.0),
        (None, true) => unreachable!("friction that depends on positions is evaluated with positions"),
    };
    lower_with(graph, &term.basis, y, v)
}

impl<'g> Rubbing<'_, 'g> {
    fn friction_basis(&self, term: &FrictionTerm, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Scalar<'g> {
        let position = (!y.is_empty()).then(|| position(&self.transmission, self.offset, y));
        let velocity = self.transmission.motion(v);
        friction_basis(velocity.graph(), term, position.as_ref(), velocity)
    }
}

/// A column of the friction regressor, the matrix of friction forces per unit of each friction coefficient.
#[derive(Debug, Clone)]
pub struct FrictionColumn<'g> {
    /// Coordinates on which the friction acts, with ratios. They are the coordinates that the joint or shaft
    /// follows.
    pub transmission: Transmission<Scalar<'g>>,
    /// Basis function of the friction term, at the position and velocity of the joint or shaft.
    pub basis: Scalar<'g>,
}

/// Columns of the friction regressor: one column for each distinct basis function of each moving joint, then
/// of each shaft.
///
/// - `y`: may be empty if no law depends on the position
pub fn friction_columns<'g>(
    graph: &'g Graph,
    model: &Model,
    y: &[Scalar<'g>],
    v: &[Scalar<'g>],
) -> Vec<FrictionColumn<'g>> {
    let columns = |rubbing: &Rubbing<'_, 'g>| {
        let groups = terms_by_basis(rubbing.terms).into_iter();
        let column = |(_, terms): (_, Vec<&FrictionTerm>)| FrictionColumn {
            transmission: rubbing.transmission.clone(),
            basis: rubbing.friction_basis(terms[0], y, v),
        };
        groups.map(column).collect::<Vec<_>>()
    };
    Rubbing::of(graph, model).iter().flat_map(columns).collect()
}

/// Friction coefficients of the description, one for each column of the friction regressor. Coefficients of
/// terms with the same basis function are added.
pub fn friction_coefficients<'g>(graph: &'g Graph, model: &Model) -> Vec<Scalar<'g>> {
    let sum = |(_, terms): (&Formula, Vec<&FrictionTerm>)| {
        let coefficients = terms.iter().map(|term| lower(graph, &term.coefficient));
        coefficients.fold(graph.constant(0.0), |sum, c| sum + c)
    };
    Rubbing::of(graph, model)
        .iter()
        .flat_map(|rubbing| terms_by_basis(rubbing.terms).into_iter().map(sum))
        .collect()
}

/// Names of the columns of the friction regressor, for example `joint: tanh(10*v)`.
pub fn friction_names(model: &Model) -> Vec<String> {
    let parameters: Vec<&str> = model.parameters.iter().map(|p| p.name.as_str()).collect();
    let names = |rubbing: &Rubbing<'_, '_>| {
        let bases = terms_by_basis(rubbing.terms).into_iter();
        let name = |(basis, _): (&Formula, _)| format!("{}: {}", rubbing.name, basis.text(&parameters));
        bases.map(name).collect::<Vec<_>>()
    };
    Rubbing::of(&Graph::new(), model).iter().flat_map(names).collect()
}

/// The distinct basis functions of friction terms in order of appearance, each with its terms.
fn terms_by_basis(terms: &[FrictionTerm]) -> Vec<(&Formula, Vec<&FrictionTerm>)> {
    let mut groups: Vec<(&Formula, Vec<&FrictionTerm>)> = Vec::new();
    for term in terms {
        match groups.iter_mut().find(|(basis, _)| **basis == term.basis) {
            Some((_, terms)) => terms.push(term),
            None => groups.push((&term.basis, vec![term])),
        }
    }
    groups
}

/// Columns of the input matrix B for the drives, as a list of rows. An entry is the gear ratio times the
/// weight of the coordinate. If the input is a current, the entry is also multiplied by the motor constant.
pub fn drive_matrix<'g>(graph: &'g Graph, model: &Model) -> Vec<Vec<Scalar<'g>>> {
    let zero = graph.constant(0.0);
    let drives: Vec<_> = model.input_drives().collect();
    let mut matrix = vec![vec![zero; drives.len()]; model.motion_count()];
    for (column, drive) in drives.iter().enumerate() {
        let ratio = lower(graph, &drive.gear_ratio);
        let gain = match &drive.input {
            Input::Torque | Input::None => ratio,
            Input::Current(constant) => ratio * lower(graph, constant),
        };
        lower_followed(graph, &drive.acts_on).add_row_entry(column, gain, &mut matrix);
    }
    matrix
}

/// Documentation note for a function whose program contains an exact `sign` of a force law; `None` for other
/// functions.
pub fn jump_note(model: &Model, program: &Program) -> Option<String> {
    let is_sign = |step: &Instruction| matches!(step.operation, Operation::Call(Function::Sign, _));
    let at_frames = model.point_forces.iter().any(|force| force.law.calls(Function::Sign));
    let shafts = model.rubbing_drives().any(Drive::jumps);
    let jumps = at_frames || shafts || model.moving_joints().iter().any(|moving| moving.joint.jumps());
    (jumps && program.instructions.iter().any(is_sign)).then(|| {
        "`sign` is exact: it jumps at zero, and its derivative is set to zero everywhere. `--smooth-sign SLOPE`, or \
         `smooth_sign` in the description, replaces it by `tanh(SLOPE v)`."
            .to_owned()
    })
}
