//! Do the functions agree with each other? Evaluated at seeded states by the interpreter.

use gelenk_report::{Claim, Criterion};
use nalgebra::{DMatrix, SymmetricEigen};

use super::motion;
use super::robot::Robot;
use super::states::State;
use crate::function_names::FrameKind;
use crate::model::Definiteness;
use crate::random::Random;

/// So many states are tried.
pub(super) const STATES: usize = 25;
const SEED: u64 = 20_220_519;

/// Step of the differences: small beside the width of steep friction laws, large beside rounding.
const STEP: f64 = 1e-5;

/// Measures one disagreement at a state; `None` where the robot lacks a function.
type Measure = fn(&Robot<'_>, &State) -> Option<f64>;

/// One row: identifier, statement, what is measured, threshold, what would flip it.
struct Check {
    id: &'static str,
    statement: &'static str,
    name: &'static str,
    bound: f64,
    flipped_by: &'static str,
    measure: Measure,
    /// Whether driven joints rest: what they do to the robot has no place in the statement.
    at_rest: bool,
}

/// Thresholds of differences are far above their error (10⁻¹¹ of rounding at this step) and far below any
/// mistake.
const CHECKS: &[Check] = &[
    Check {
        id: "check-symmetric",
        statement: "The mass matrix is symmetric: $M = M^T$.",
        name: "largest relative difference",
        bound: 1e-13,
        flipped_by: "one entry that differs from its mirror image",
        measure: asymmetry,
        at_rest: false,
    },
    Check {
        id: "check-inverse",
        statement: "Inverse dynamics undoes forward dynamics: the forces of the accelerations that $u$ causes are $B u$.",
        name: "largest relative difference",
        bound: 1e-9,
        flipped_by: "a term that only one of the two has",
        measure: inverse_of_forward,
        at_rest: false,
    },
    Check {
        id: "check-parts",
        statement: "Inverse dynamics, a recursion of its own, is $M \\ddot y + k - q$.",
        name: "largest relative difference",
        bound: 1e-10,
        flipped_by: "another sign of k or q in one of the functions",
        measure: parts,
        at_rest: false,
    },
    Check {
        id: "check-power",
        statement: "Energy balance: the kinetic energy changes by the power of the forces, $\\dot T = \\dot y^T (q + B u)$; so $k$ does what $\\dot M$ asks for.",
        name: "largest relative difference",
        bound: 1e-7,
        flipped_by: "a missing or doubled Coriolis term",
        measure: power,
        at_rest: true,
    },
    Check {
        id: "check-gravity",
        statement: "Gravity is the gradient of the potential energy: $q_\\text{gravity} = -\\partial V/\\partial y$.",
        name: "largest relative difference",
        bound: 1e-7,
        flipped_by: "a centre of mass that only one of the two knows",
        measure: gravity,
        at_rest: true,
    },
    Check {
        id: "check-linearize",
        statement: "The analytic linearization agrees with differences of the forward dynamics.",
        name: "largest relative difference",
        bound: 1e-6,
        flipped_by: "a derivative that is missing, friction's included",
        measure: linearization,
        at_rest: false,
    },
    Check {
        id: "check-frames",
        statement: "Jacobians of the named frames agree with differences of their poses.",
        name: "largest relative difference",
        bound: 1e-7,
        flipped_by: "a Jacobian in other axes, or about another point",
        measure: frames,
        at_rest: true,
    },
];

/// The rows of the self-check.
pub(super) fn claims(robot: &Robot<'_>) -> Vec<Claim> {
    let mut random = Random::new(SEED);
    let states: Vec<State> = (0..STATES).map(|_| State::seeded(robot, &mut random)).collect();
    let mut claims: Vec<Claim> = definiteness(robot, &states).into_iter().collect();
    for check in CHECKS {
        let measure = |state: &State| (check.measure)(&robot.driven_by(state.driven(check.at_rest)), state);
        let measured: Option<Vec<f64>> = states.iter().map(measure).collect();
        if let Some(measured) = measured {
            let criterion = Criterion::at_most(check.name, worst(&measured), check.bound, "");
            let claim = Claim::new(check.id, statement(robot, check)).criterion(criterion);
            claims.push(claim.flipped_by(check.flipped_by));
        }
    }
    claims
}

/// The statement of a check, which has friction under load where there is some.
fn statement(robot: &Robot<'_>, check: &Check) -> String {
    match (check.id, robot.has_load_friction()) {
        ("check-gravity", _) if !robot.laws_with_energy().is_empty() => {
            "Gravity and the forces between frames, as far as they have an energy, are the gradient of the potential energy: \
             $q_\\text{gravity} + q_\\text{laws} = -\\partial V/\\partial y$ at standstill."
                .to_owned()
        }
        (_, false) => check.statement.to_owned(),
        (_, true) => check
            .statement
            .replace("M \\ddot y + k - q$", "M \\ddot y + k - q + |\\tau_l| \\, \\sigma$")
            .replace("(q + B u)$", "(q + B u - |\\tau_l| \\, \\sigma)$"),
    }
}

fn worst(measured: &[f64]) -> f64 {
    // `max` would drop a NaN.
    measured.iter().copied().fold(0.0, |worst, value| if value <= worst { worst } else { value })
}

fn definiteness(robot: &Robot<'_>, states: &[State]) -> Option<Claim> {
    let ratio = |state: &State| definiteness_at(&robot.driven_by(state.driven(false)), state);
    let ratios: Option<Vec<f64>> = states.iter().map(ratio).collect();
    let least =
        ratios?.into_iter().fold(f64::INFINITY, |least, value| if value >= least { least } else { value });
    let is_singular = robot.model.definiteness() == Definiteness::Semidefinite;
    let (statement, bound) = match is_singular {
        true => (
            "The mass matrix has no negative eigenvalue; it is singular, since nothing that has inertia moves with some joints.",
            -ROUNDING,
        ),
        false => ("The mass matrix is positive definite.", ROUNDING),
    };
    let name = "smallest eigenvalue, with the diagonal scaled to 1";
    Some(
        Claim::new("check-definite", statement)
            .criterion(Criterion::at_least(name, least, bound, ""))
            .flipped_by("a negative mass, or a joint that moves nothing"),
    )
}

/// Eigenvalues of a scaled mass matrix below this are rounding.
const ROUNDING: f64 = 1e-12;

/// The smallest eigenvalue of `M_ij / √(M_ii M_jj)`, a number without unit: masses and inertias may differ by
/// any factor.
fn definiteness_at(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let mass = mass_matrix(robot, state)?;
    let diagonal = mass.diagonal();
    if diagonal.min() < 0.0 {
        return Some(diagonal.min() / diagonal.amax());
    }
    Some(SymmetricEigen::new(scaled(&mass)).eigenvalues.min())
}

fn asymmetry(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let mass = scaled(&mass_matrix(robot, state)?);
    Some((&mass - mass.transpose()).amax() / mass.amax())
}

fn mass_matrix(robot: &Robot<'_>, state: &State) -> Option<DMatrix<f64>> {
    let n = robot.n();
    let entries = robot.first("mass_matrix", &[&state.y])?;
    Some(DMatrix::from_row_slice(n, n, &entries))
}

/// With a diagonal of ones; rows and columns whose diagonal is 0 stay.
fn scaled(mass: &DMatrix<f64>) -> DMatrix<f64> {
    let scale = mass.diagonal().map(|entry| match entry > 0.0 {
        true => entry.sqrt(),
        false => 1.0,
    });
    DMatrix::from_fn(mass.nrows(), mass.ncols(), |i, j| mass[(i, j)] / (scale[i] * scale[j]))
}

/// Roots of the diagonal of M: forces over them, and accelerations times them, have one unit for slides and
/// hinges.
fn weights(robot: &Robot<'_>, state: &State) -> Option<Vec<f64>> {
    let diagonal = mass_matrix(robot, state)?.diagonal();
    let root = |entry: &f64| if *entry > 0.0 { entry.sqrt() } else { 1.0 };
    Some(diagonal.iter().map(root).collect())
}

fn magnitudes(values: &[f64]) -> Vec<f64> {
    values.iter().map(|x| x.abs()).collect()
}

fn over(values: &[f64], weights: &[f64]) -> Vec<f64> {
    values.iter().zip(weights).map(|(x, w)| x / w).collect()
}

fn times(values: &[f64], weights: &[f64]) -> Vec<f64> {
    values.iter().zip(weights).map(|(x, w)| x * w).collect()
}

/// `B u`
fn joint_forces(robot: &Robot<'_>, y: &[f64], u: &[f64]) -> Option<Vec<f64>> {
    if u.is_empty() {
        return Some(vec![0.0; robot.n()]);
    }
    let input_matrix = match robot.model.inputs_depend_on_position() {
        true => robot.first("input_matrix", &[y])?,
        false => robot.first("input_matrix", &[])?,
    };
    let rows = input_matrix.chunks(u.len());
    Some(rows.map(|row| product(row, u)).collect())
}

/// The forces at a state, beside which differences are judged. Those of the accelerations are sums of
/// magnitudes: where light bodies are flung about, M ÿ is small beside its terms, and rounding is that of the
/// terms.
fn forces(robot: &Robot<'_>, state: &State, a: &[f64]) -> Option<[Vec<f64>; 4]> {
    let (y, v) = (&state.y, &state.v);
    Some([
        matrix_times(&magnitudes(&robot.first("mass_matrix", &[y])?), &magnitudes(a)),
        robot.first("coriolis_forces", &[y, v])?,
        robot.first("applied_forces", &[y, v])?,
        joint_forces(robot, &state.y, &state.u)?,
    ])
}

/// The largest of them.
fn size_of_forces(robot: &Robot<'_>, state: &State, a: &[f64]) -> Option<f64> {
    let parts = forces(robot, state, a)?;
    Some(parts.iter().map(|part| largest(part)).fold(0.0, f64::max))
}

/// The difference of forces relative to the forces at a state, both weighted.
fn weighted_difference(
    robot: &Robot<'_>,
    state: &State,
    a: &[f64],
    [found, expected]: [&[f64]; 2],
) -> Option<f64> {
    let weights = weights(robot, state)?;
    let parts = forces(robot, state, a)?;
    let sizes = parts.iter().map(|part| largest(&over(part, &weights)));
    let size = sizes.fold(0.0, f64::max);
    Some(difference(&over(found, &weights), &over(expected, &weights)) / size)
}

fn inverse_of_forward(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let (y, v) = (&state.y, &state.v);
    let a = robot.first("forward_dynamics", &[y, v, &state.u])?;
    let forces = robot.first("inverse_dynamics", &[y, v, &a])?;
    let expected = joint_forces(robot, &state.y, &state.u)?;
    weighted_difference(robot, state, &a, [&forces, &expected])
}

fn parts(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let (y, v, a) = (&state.y, &state.v, &state.a);
    let forces = robot.first("inverse_dynamics", &[y, v, a])?;
    let inertial = matrix_times(&robot.first("mass_matrix", &[y])?, a);
    let coriolis = robot.first("coriolis_forces", &[y, v])?;
    let applied = robot.first("applied_forces", &[y, v])?;
    let forces_without: Vec<f64> = (0..robot.n()).map(|i| inertial[i] + coriolis[i] - applied[i]).collect();
    let more = load_friction(robot, state, &forces_without)?;
    let expected: Vec<f64> = forces_without.iter().zip(&more).map(|(force, more)| force + more).collect();
    weighted_difference(robot, state, a, [&forces, &expected])
}

/// `|τ_l| s₁` for the forces M ÿ + k − q, which hold friction without load: zero where friction does not grow
/// with the load.
fn load_friction(robot: &Robot<'_>, state: &State, forces: &[f64]) -> Option<Vec<f64>> {
    if !robot.has_load_friction() {
        return Some(vec![0.0; forces.len()]);
    }
    let friction = robot.friction_torques(&state.y, &state.v)?;
    let shares = robot.first("load_friction", &[&state.y, &state.v])?;
    let loads = forces.iter().zip(&friction).map(|(force, friction)| (force - friction).abs());
    Some(loads.zip(&shares).map(|(load, share)| load * share).collect())
}

fn power(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let (y, v) = (&state.y, &state.v);
    let a = robot.first("forward_dynamics", &[y, v, &state.u])?;
    let energy = |t: f64| {
        let (y, v) = (motion::moved(robot.model, y, t, v), moved(v, t, &a));
        robot.first("kinetic_energy", &[&y, &v])
    };
    let rate = derivative(energy)?[0];
    let applied = robot.first("applied_forces", &[y, v])?;
    let forces = joint_forces(robot, &state.y, &state.u)?;
    let inertial = matrix_times(&robot.first("mass_matrix", &[y])?, &a);
    let coriolis = robot.first("coriolis_forces", &[y, v])?;
    let forces_without: Vec<f64> = (0..robot.n()).map(|i| inertial[i] + coriolis[i] - applied[i]).collect();
    let more = load_friction(robot, state, &forces_without)?;
    let expected = product(v, &applied) + product(v, &forces) - product(v, &more);
    let size = size_of_forces(robot, state, &a)? * v.iter().map(|v| v.abs()).sum::<f64>();
    Some((rate - expected).abs() / size)
}

fn gravity(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let along = &state.v;
    let energy_at =
        |t: f64| robot.first("potential_energy", &[&motion::moved(robot.model, &state.y, t, along)]);
    let rate = derivative(energy_at)?[0];
    let forces = moved(&robot.first("gravity_forces", &[&state.y])?, 1.0, &robot.law_forces(&state.y)?);
    let energy = robot.first("potential_energy", &[&state.y])?[0].abs();
    let size = (largest(&forces) * largest(along)).max(energy);
    let error = (rate + product(along, &forces)).abs();
    // A robot that knows no gravity has neither energy nor forces.
    Some(if error == 0.0 { 0.0 } else { error / size })
}

/// Along one direction, which mixes coordinates, velocities and inputs.
fn linearization(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let State { y, v, a, u, .. } = state;
    let blocks = robot.call("linearize", &[y, v, u])?;
    let [by_y, by_v, by_u, ..] = blocks.as_slice() else { return None };
    let along = |t: f64| {
        let (y, v, u) = (motion::moved(robot.model, y, t, v), moved(v, t, a), moved(u, t, u));
        robot.first("forward_dynamics", &[&y, &v, &u])
    };
    let found = derivative(along)?;
    let parts = [
        matrix_times(by_y, v),
        matrix_times(by_v, a),
        if u.is_empty() {
            vec![0.0; v.len()]
        } else {
            by_u.chunks(u.len()).map(|row| product(row, u)).collect()
        },
    ];
    let expected: Vec<f64> = (0..v.len()).map(|i| parts.iter().map(|part| part[i]).sum()).collect();
    let weights = weights(robot, state)?;
    let weighted = |part: &[f64]| largest(&times(part, &weights));
    let size = parts.iter().map(|part| weighted(part)).fold(0.0, f64::max);
    // What rounding of the accelerations themselves leaves.
    let accelerations = robot.first("forward_dynamics", &[y, v, u])?;
    let error = difference(&times(&found, &weights), &times(&expected, &weights));
    Some(error / size.max(weighted(&accelerations)))
}

fn frames(robot: &Robot<'_>, state: &State) -> Option<f64> {
    let mut worst = 0.0;
    for frame in &robot.model.frames {
        let error = frame_error(robot, state, &frame.identifier)?;
        worst = if error <= worst { worst } else { error };
    }
    (!robot.model.frames.is_empty()).then_some(worst)
}

fn frame_error(robot: &Robot<'_>, state: &State, name: &str) -> Option<f64> {
    let [pose, jacobian] = [FrameKind::Pose, FrameKind::Jacobian].map(|kind| kind.function(name));
    let along = |t: f64| {
        let mut results =
            robot.call(&pose, &[&motion::moved(robot.model, &state.y, t, &state.v)])?.into_iter();
        let (mut origin, rotation) = (results.next()?, results.next()?);
        origin.extend(rotation);
        Some(origin)
    };
    let rates = derivative(along)?;
    let rotation = along(0.0)?.split_off(3);
    // Ṙ Rᵀ is the matrix of ω ×.
    let spin = |i: usize, j: usize| product(&rates[3 + 3 * i..6 + 3 * i], &rotation[3 * j..3 * j + 3]);
    let found = [rates[0], rates[1], rates[2], spin(2, 1), spin(0, 2), spin(1, 0)];
    // Its columns are those of the driven joints too.
    let expected = matrix_times(&robot.first(&jacobian, &[&state.y])?, &robot.all_velocities(&state.v));
    Some(difference(&found, &expected) / largest(&expected).max(largest(&state.v)))
}

/// `f′(0)` by five points; its error is h⁴ f⁗′/30.
fn derivative(f: impl Fn(f64) -> Option<Vec<f64>>) -> Option<Vec<f64>> {
    let at = [f(-2.0 * STEP)?, f(-STEP)?, f(STEP)?, f(2.0 * STEP)?];
    let slope = |i: usize| (at[0][i] - 8.0 * at[1][i] + 8.0 * at[2][i] - at[3][i]) / (12.0 * STEP);
    Some((0..at[0].len()).map(slope).collect())
}

fn moved(from: &[f64], by: f64, along: &[f64]) -> Vec<f64> {
    from.iter().zip(along).map(|(x, d)| x + by * d).collect()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A matrix, flat and rows first, times a vector that is not empty.
fn matrix_times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    let rows = matrix.chunks(vector.len().max(1));
    rows.map(|row| product(row, vector)).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
    worst(&differences)
}
