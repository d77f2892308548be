//! Test of the described direction of gravity.
//!
//! Gravity forces are linear in the gravity vector. If this vector turns by small angles ε₁ and ε₂, the gravity forces change
//! by `ε₁ W₁(y) π + ε₂ W₂(y) π`. W₁ and W₂ are regressors at rest for two gravity vectors perpendicular to the original one,
//! and π are the inertial parameters. The angles are fitted together with all other unknowns. Bodies are almost free, so an
//! effect that other bodies explain equally well does not count as a tilt. Each pass starts from the gravity of the previous
//! pass until the direction converges (Gauss–Newton).

use super::super::error::Result;
use super::super::numeric::spectrum::symmetric_eigen;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::choice::Chosen;
use super::levels;
use super::normal::inverse;
use super::result::Gravity;
use super::sums::moving;
use super::task::Task;
use super::trial::{Case, Change, Hypothesis, at_rest};
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use nalgebra::{DMatrix, DVector, Vector3};

/// Change of the direction below which the passes end [rad].
const STAYS: f64 = 1e-3;
const PASSES: usize = 10;

/// Sees: gravity forces that another direction of gravity explains.
/// Matters: the tilt causes errors of the bodies.
/// Example: a robot on a wedge of 5°.
/// Fixture: `tilted` in `codegen/tests/findings/arm.rs`.
const TILT: Rule = Rule::warning("tilted-gravity");

pub(super) const TILTED: Hypothesis = Hypothesis::of(TILT, tilts, finding);

/// The direction of gravity that the data determine; empty if the described direction is not doubted, or if the equations
/// have no solution.
fn tilts(case: &Case) -> Result<Vec<Change>> {
    let found = case.checked.and_then(|checked| tilt(checked.task, case.chosen).ok().flatten());
    Ok(found.into_iter().collect())
}

/// Direction of gravity that the data determine; `None` if it agrees with the described direction or cannot be estimated.
///
/// - `last`: fit with the described gravity
fn tilt(task: &Task, last: &Chosen) -> Result<Option<Change>> {
    let is_usual = task.gravity == Gravity::Recorded && !task.layout.known_gains.contains(&false);
    let described = task.robot.gravity().filter(|_| is_usual && !task.layout.exact.contains(&true));
    let Some(described) = described.map(Vector3::from).filter(|g| g.norm() > 0.0) else { return Ok(None) };
    let (mut gravity, mut changes) = (described, last.values.unknowns.clone());
    for pass in 0..PASSES {
        let pi = task.prior.described.iter().zip(&changes).map(|(pi, change)| pi + change).collect();
        let turning = Turning { robot: task.robot, described, gravity, across: across(gravity), pi };
        let angles;
        [angles, changes] = turning.angles(task, last)?;
        gravity = turning.turned(&angles);
        if turning.weighs_less_than_nothing(task.runs, &changes) {
            (gravity, changes) = (-gravity, changes * 0.0);
        } else if pass == 0 && angles.norm() < 0.5 * levels::LEAST_TILT.get() {
            break;
        } else if pass > 0 && angles.norm() < STAYS {
            let is_noticeable = gravity.angle(&described) > levels::LEAST_TILT.get();
            return Ok(is_noticeable.then_some(Change::Tilt(gravity)));
        }
    }
    Ok(None)
}

/// Two unit vectors perpendicular to gravity and to each other.
fn across(gravity: Vector3<f64>) -> [Vector3<f64>; 2] {
    let down = gravity.normalize();
    let mut axis = Vector3::zeros();
    axis[down.iamin()] = 1.0;
    let first = (axis - down * down.dot(&axis)).normalize();
    [first, down.cross(&first)]
}

/// A gravity vector that differs from the described one, and the two directions in which it is turned further.
struct Turning<'a> {
    robot: &'a dyn Robot,
    described: Vector3<f64>,
    gravity: Vector3<f64>,
    across: [Vector3<f64>; 2],
    /// Inertial parameters π of the bodies.
    pi: Vec<f64>,
}

impl Turning<'_> {
    /// Adds to the regressor the gravity columns under this gravity minus those under the described gravity,
    /// and the columns of the angles.
    fn add(&self, y: &[f64], joints: usize, regressor: &mut [f64]) {
        let count = self.pi.len();
        let turned = at_rest(self.robot, y, joints, self.gravity - self.described);
        let across = self.across.map(|axis| at_rest(self.robot, y, joints, axis * self.gravity.norm()));
        for (joint, row) in regressor.chunks_exact_mut(count + 2).enumerate() {
            let columns = joint * count..(joint + 1) * count;
            row[..count].copy_from_slice(&turned[columns.clone()]);
            for (k, across) in across.iter().enumerate() {
                row[count + k] = across[columns.clone()].iter().zip(&self.pi).map(|(w, pi)| w * pi).sum();
            }
        }
    }

    /// Whether bodies that differ by these changes have gravity forces opposite to those of the described bodies. The assumed
    /// gravity is then upside down.
    fn weighs_less_than_nothing(&self, runs: &[PreparedRun], changes: &DVector<f64>) -> bool {
        let described = self.robot.parameters();
        let of_sample = |run: &PreparedRun, i: usize| -> f64 {
            let y: Vec<f64> = run.coordinates().iter().map(|column| column[i]).collect();
            let weights = at_rest(self.robot, &y, run.velocities.len(), self.gravity);
            let rows = weights.chunks_exact(described.len().max(1)).map(|row| {
                let dot = |pi: &[f64]| row.iter().zip(pi).map(|(w, pi)| w * pi).sum::<f64>();
                let own = dot(&described);
                own * (own + dot(changes.as_slice()))
            });
            rows.sum()
        };
        let of_run = |run: &PreparedRun| {
            let count = run.times.len();
            (0..count)
                .step_by((count / levels::COMPARED_WEIGHTS.get()).max(1))
                .map(|i| of_sample(run, i))
                .sum::<f64>()
        };
        runs.iter().map(of_run).sum::<f64>() < 0.0
    }

    /// Gravity, turned by the small `angles` [rad] towards two directions perpendicular to it.
    fn turned(&self, angles: &DVector<f64>) -> Vector3<f64> {
        let size = self.gravity.norm();
        let turned = self.gravity + (self.across[0] * angles[0] + self.across[1] * angles[1]) * size;
        turned * (size / turned.norm())
    }

    /// The fitted angles by which gravity turns in the directions that the data determine, and the fitted changes of all
    /// unknowns.
    fn angles(&self, task: &Task, last: &Chosen) -> Result<[DVector<f64>; 2]> {
        let more = |y: &[f64], regressor: &mut [f64]| self.add(y, task.layout.joints, regressor);
        task.with_more(2, &more, |task| {
            let sums = task.sums_of(&moving);
            let mut chosen = last.with_more(task.layout, &sums, 1.0 / levels::FREE_BODIES.get());
            chosen.weighting.description = levels::FREE_BODIES.get();
            chosen.model.consistent = false;
            chosen.reweight(task.prior)?;
            let solved = chosen.solved(task.prior)?;
            let first = task.layout.parameters - 2;
            let place = |k: usize| solved.active.iter().position(|global| *global == first + k);
            let places: Vec<usize> = (0..2).filter_map(place).collect();
            let seen = seen(inverse(&solved.regularized)?.select_rows(&places).select_columns(&places));
            let changes = solved.values.unknowns;
            Ok([&seen * seen.tr_mul(&changes.rows(first, 2)), changes])
        })
    }
}

/// Columns of the directions whose variance is below [`levels::UNTOLD`].
fn seen(variance: DMatrix<f64>) -> DMatrix<f64> {
    if variance.nrows() != 2 {
        return DMatrix::zeros(2, 0);
    }
    let eigen = symmetric_eigen(variance);
    let observable: Vec<usize> = (0..2).filter(|k| eigen.eigenvalues[*k] < levels::UNTOLD.get()).collect();
    eigen.eigenvectors.select_columns(&observable)
}

fn finding(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let (Change::Tilt(found), Some(described)) = (change, case.robot.gravity()) else {
        return Ok(None);
    };
    let described = Vector3::from(described);
    let angle = found.angle(&described).to_degrees();
    let axis = described.cross(found).try_normalize(1e-9 * found.norm_squared());
    let axis = axis.unwrap_or(across(described)[0]);
    let [axis, found] = [(axis, 2), (*found, 3)].map(|(vector, digits)| {
        let unit = 10_f64.powi(digits);
        let entry = |x: &f64| plain((x * unit).round() / unit, 6);
        vector.iter().map(entry).collect::<Vec<_>>().join(", ")
    });
    let message = format!(
        "the efforts show gravity {angle:.1}° off its described direction, rotated about the axis [{axis}] of the base: the base is \
         mounted at an angle, or `gravity` is wrong. Bodies and friction were fitted with the described gravity"
    );
    let remedy = format!("set `gravity = [{found}]`, and identify again");
    Ok(Some(rule.found(message).with("angle", angle, "°").help(remedy)))
}
