//! Notes on what friction does to the functions that were generated.

use crate::diagnostic::Diagnostic;
use crate::functions::catalogue;
use crate::functions::composition::Composition;
use crate::functions::function::Function;
use crate::model::{Joint, JointKind, Model};
use crate::wording::{list, three_digits};
use gelenk_formula::{Formula, Function as Call};

/// Longest usual period of a control loop [s].
const LONGEST_PERIOD: f64 = 0.02;
/// Shortest one.
const SHORTEST_PERIOD: f64 = 0.001;

/// Classical Runge–Kutta steps of order 4 are unstable beyond so much of step length times rate (Hairer and
/// Wanner 1996, section IV.2).
const UNSTABLE: f64 = 2.785_3;

/// Notes for a model and the functions that are generated of it.
pub fn notes(model: &Model, functions: &[Function], compositions: &[Composition]) -> Vec<Diagnostic> {
    let mut names = functions.iter().map(|function| &function.name);
    let has_derivatives = names.any(|name| catalogue::differentiates_friction(name));
    let steps = compositions.iter().any(|each| each.has_substeps());
    let jumps = has_derivatives.then(|| jumps(model)).flatten();
    let stiff = steps.then(|| stiff(model)).flatten();
    jumps.into_iter().chain(stiff).collect()
}

/// Where friction or a spring has an exact sign.
fn jumps(model: &Model) -> Option<Diagnostic> {
    let moving = model.moving_joints();
    let joints = moving.iter().filter(|moving| moving.joint.jumps()).map(|moving| moving.joint.name.as_str());
    let shafts = model.drives.iter().filter(|drive| drive.jumps()).map(|drive| drive.name.as_str());
    let at_frames = model.point_forces.iter().filter(|force| force.law.calls(Call::Sign));
    let names: Vec<&str> = joints.chain(shafts).chain(at_frames.map(|force| force.name.as_str())).collect();
    if names.is_empty() {
        return None;
    }
    let message = format!(
        "the force laws of {} have an exact `sign`, whose derivative is 0: Jacobians and linearizations know nothing of it",
        list(names.into_iter())
    );
    let note = Diagnostic::note("sign-derivative", message);
    Some(note.help(
        "for control with derivatives: `--smooth-sign 100`, or `smooth_sign = 100` in [generate], makes it tanh(100 v)",
    ))
}

/// Where friction makes the robot so fast at standstill that Runge–Kutta steps of a usual period are not
/// stable.
///
/// The fastest rate of M v̇ = −D v is at least `Dᵢ / pᵢ`, p the pivots of M, since `(M⁻¹)ᵢᵢ ≥ 1/pᵢ`.
fn stiff(model: &Model) -> Option<Diagnostic> {
    let described = model.parameters.iter().map(|parameter| parameter.default);
    let described: Vec<f64> = described.collect();
    let rates = model.joints().zip(model.least_pivots());
    let rates = rates.filter_map(|(joint, pivot)| {
        let slope = slope_at_standstill(joint, &described);
        (pivot > 0.0).then_some((joint, slope, slope / pivot))
    });
    let (joint, slope, rate) = rates.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let substeps = model.options.substeps.unwrap_or(1);
    let longest = UNSTABLE * substeps as f64 / rate;
    if rate <= 0.0 || longest >= LONGEST_PERIOD {
        return None;
    }
    let unit = match joint.kind {
        JointKind::Prismatic => "N s/m",
        JointKind::Fixed | JointKind::Revolute | JointKind::Continuous | JointKind::Helical { .. } => {
            "N m s/rad"
        }
    };
    let is_damper = joint.friction.is_empty() && joint.load_friction.is_empty();
    let message = format!(
        "{} of `{}`{} rises by {} {unit} at standstill and slows down at a rate of {} 1/s: with {substeps} substep{} \
         `step` is unstable for periods beyond {} ms",
        if is_damper { "damping" } else { "friction" },
        joint.name,
        if joint.load_friction.is_empty() { "" } else { ", under the load of its effort limit," },
        three_digits(slope),
        three_digits(rate),
        if substeps == 1 { "" } else { "s" },
        three_digits(1000.0 * longest),
    );
    let needed = |period: f64| (rate * period / UNSTABLE).ceil();
    let note = Diagnostic::note("stiff-friction", message);
    Some(note.help(format!(
        "`substeps` in [generate] have to be at least {} for {} ms, {} for {} ms; or choose a smaller {}; `discretize` has \
         no such limit",
        needed(SHORTEST_PERIOD),
        1000.0 * SHORTEST_PERIOD,
        needed(LONGEST_PERIOD),
        1000.0 * LONGEST_PERIOD,
        if is_damper { "damping" } else { "slope" },
    )))
}

/// Largest dτ/dv at v = 0 for positions over the seeded range, under the load of the effort limit; exact signs
/// have none.
fn slope_at_standstill(joint: &Joint, described: &[f64]) -> f64 {
    let [low, high] = joint.seeded_range();
    let positions = (0..=10).map(|k| low + (high - low) * f64::from(k) / 10.0);
    // The largest load that a description tells of.
    let load = joint.limits.peak_effort.or(joint.limits.effort).unwrap_or(0.0);
    let torque = |position: f64, velocity: f64| -> f64 {
        let smooth = joint.friction.iter();
        let smooth = smooth.filter(|term| !term.basis.calls(Call::Sign));
        let value = |formula: &Formula| formula.evaluate(described, position, velocity);
        let friction = smooth.map(|term| value(&term.coefficient) * value(&term.basis));
        let under_load = joint.load_friction.iter().filter(|term| !term.basis.calls(Call::Sign));
        let under_load = under_load.map(|term| value(&term.coefficient) * value(&term.basis));
        let dampers = joint.springs.iter().filter(|law| !law.calls(Call::Sign));
        friction.sum::<f64>() + load * under_load.sum::<f64>() - dampers.map(value).sum::<f64>()
    };
    // Steep laws have a width of 1e-3 and more.
    const STEP: f64 = 1e-7;
    let slopes = positions.map(|y| (torque(y, STEP) - torque(y, -STEP)) / (2.0 * STEP));
    slopes.fold(0.0, f64::max)
}
