//! Motor speeds, and stroke and speed of forces between two frames, converted to limits of one coordinate.

use super::distances::{Distances, crossing, places};
use super::frame_forces::between;
use crate::description::{PointForceDescription, RobotDescription};
use crate::diagnostic::{At, Report, Span};
use crate::model::{Attachment, Limits, Model, Motion};
use crate::wording::{as_written, list, three_digits};
use gelenk_findings::Rule;

/// Sees: a speed limit of a motor, or a stroke or speed limit of a cylinder, that restricts a joint more than the joint's own limits.
/// Matters: the joint's limits in the module are narrower than those described.
/// Example: a cylinder with `stroke = [0.8, 1.3]`.
/// Fixture: `codegen/tests/snapshots/bad/strokes.toml.snap`.
const NARROWER: Rule = Rule::note("narrower-limits");

/// Ends of a stroke are rounded inwards to whole multiples of 1/FINENESS, in rad or m.
const FINENESS: f64 = 1e6;

/// Narrows the limits of coordinates to the limits that motors and cylinders imply. Motors that move several
/// coordinates have separate rows ([`Model::dependent`]).
pub(super) fn narrow(robot: &RobotDescription, model: &mut Model, report: &mut Report) {
    for (name, motor) in robot.motors() {
        if let Some(speed) = &motor.speed {
            narrow_by_motor(name, speed, model, report);
        }
    }
    for force in &robot.point_forces {
        let Some(span) = force.stroke.as_ref().map(|l| l.span).or(force.speed.as_ref().map(|l| l.span))
        else {
            continue;
        };
        let Some(between) = between(force, model).cloned() else { continue };
        if let Some(found) = Path::find(force, &between, span, model, report) {
            narrow_by_force(force, &between, &found, model, report);
        }
    }
}

fn narrow_by_motor(name: &str, speed: &At<f64>, model: &mut Model, report: &mut Report) {
    // The motor of a held joint turns nothing.
    let Some(drive) = model.input_drives().find(|drive| drive.name == name) else { return };
    let ratios = drive
        .acts_on
        .iter()
        .map(|moved| Some((moved.coordinate, drive.gear_ratio.value(&[])? * moved.ratio.value(&[])?)));
    let Some(ratios) = ratios.collect::<Option<Vec<(usize, f64)>>>() else {
        let message = format!("motor `{name}` has a speed limit, but its ratio is a free parameter");
        report.error(speed.span, "speed-of-free-ratio", message);
        report.help(
            "give the ratio as a number, or limit the joint's `velocity`. The speed limit of a motor limits a joint only if the \
             ratio is known",
        );
        return;
    };
    let [(coordinate, ratio)] = ratios[..] else {
        return refuse_name_of_follower(name, speed.span, model, report);
    };
    let Some(link) = model.link_of(coordinate) else { return };
    narrow_speed(model, link, speed.value / ratio.abs(), &format!("motor `{name}`"), speed.span, report);
}

/// Reports an error if a motor of several coordinates has the name of a joint that follows others.
/// Controllers find the speed limit of the motor and the limits of such joints by name.
fn refuse_name_of_follower(name: &str, span: Span, model: &Model, report: &mut Report) {
    let mut joints = model.links.iter().filter_map(|link| link.joint.as_ref());
    if joints.any(|joint| joint.name == name && matches!(joint.motion, Motion::Follower(_))) {
        let message =
            format!("motor `{name}` has a speed limit, and a joint that follows others has the same name");
        report.error(span, "duplicate-name", message);
        report
            .help("controllers and messages find the limits of both by name: give the drive another `name`");
    }
}

/// Lowers the speed limit of a coordinate. Adds a note if a higher limit was described.
fn narrow_speed(model: &mut Model, link: usize, limit: f64, who: &str, span: Span, report: &mut Report) {
    let Some((joint, limits)) = limits_of(model, link) else { return };
    let described = limits.velocity;
    if described.is_some_and(|described| described <= limit) {
        return;
    }
    limits.velocity = Some(limit);
    if let Some(described) = described {
        let message = format!(
            "{who} limits the speed of joint `{joint}` to {}, below the joint's limit of {}",
            three_digits(limit),
            as_written(described)
        );
        report.push(Some(span), NARROWER.found(message));
    }
}

fn limits_of(model: &mut Model, link: usize) -> Option<(String, &mut Limits)> {
    let joint = model.links.get_mut(link)?.joint.as_mut()?;
    Some((joint.name.clone(), &mut joint.limits))
}

/// The only coordinate that changes the distance of two frames, with its limits.
struct Path {
    link: usize,
    /// Limits of the coordinate (rad or m).
    range: [f64; 2],
}

impl Path {
    /// Reports an error unless exactly one coordinate with limits changes the distance. A constant distance
    /// is reported elsewhere.
    fn find(
        force: &PointForceDescription,
        between: &[Attachment; 2],
        span: Span,
        model: &Model,
        report: &mut Report,
    ) -> Option<Self> {
        let distances = Distances::new(model, between);
        let changing = distances.changing();
        let name = &force.name.value;
        let [link] = changing[..] else {
            if !changing.is_empty() {
                let names: Vec<String> = changing.iter().map(|link| distances.name(*link)).collect();
                let names = list(names.iter().map(String::as_str));
                let message = format!(
                    "`{name}` has a `stroke` or `speed`, but its length changes with several joints: {names}"
                );
                report.error(span, "length-of-several", message).help(HELP_JOINTS);
            }
            return None;
        };
        let joint = distances.name(link);
        if !model.coordinates.contains(&link) {
            let message = format!(
                "`{name}` has a `stroke` or `speed`, but its length changes with joint `{joint}`, whose motion is prescribed"
            );
            report.error(span, "length-of-several", message);
            report.help("a prescribed motion cannot be limited: remove `stroke` and `speed`");
            return None;
        }
        if depends_on_parameters(model, between) {
            let message =
                format!("`{name}` has a `stroke` or `speed`, but its length depends on free parameters");
            report.error(span, "length-of-parameters", message);
            report.help(
                "give the parameters as numbers, or remove both keys and limit the joint by `position` and `velocity`",
            );
            return None;
        }
        let joint_limits = model.links[link].joint.as_ref().and_then(|joint| joint.limits.position);
        let Some(range) = joint_limits.filter(|range| range.iter().all(|end| end.is_finite())) else {
            let message =
                format!("`{name}` has a `stroke` or `speed`, but joint `{joint}` has no `position` limits");
            report.error(span, "length-without-range", message);
            report.help(
                "give the joint `position` limits within which the length is monotonic. The stroke then narrows these limits",
            );
            return None;
        };
        Some(Self { link, range })
    }
}

const HELP_JOINTS: &str = "`stroke` and `speed` need a length that changes with a single joint. Remove both, and limit the joints \
                           by `position` and `velocity`";

/// Whether the distance of the frames depends on free parameters.
fn depends_on_parameters(model: &Model, between: &[Attachment; 2]) -> bool {
    let described = Distances::new(model, between).at_states();
    (0..model.parameters.len()).any(|changed| {
        let values = model.parameters.iter().enumerate().map(|(index, parameter)| match index == changed {
            true => parameter.default + 1e-3 * (1.0 + parameter.default.abs()),
            false => parameter.default,
        });
        let moved = Distances::with_parameters(model, between, values.collect()).at_states();
        moved.iter().zip(&described).any(|(a, b)| (a - b).abs() > 1e-12 * (1.0 + b.abs()))
    })
}

fn narrow_by_force(
    force: &PointForceDescription,
    between: &[Attachment; 2],
    path: &Path,
    model: &mut Model,
    report: &mut Report,
) {
    let distances = Distances::new(model, between);
    let range = match &force.stroke {
        Some(stroke) => allowed(force, stroke, &distances, path, report),
        None => Some(path.range),
    };
    let Some(range) = range else { return };
    let places = places(range);
    let slopes = places.iter().map(|position| distances.slope(path.link, *position).abs());
    let steepest = slopes.fold(0.0, f64::max);
    if let (Some(stroke), Some((joint, limits))) = (&force.stroke, limits_of(model, path.link))
        && range != path.range
    {
        limits.position = Some(range);
        let message = format!(
            "the stroke of `{}` limits joint `{joint}` to positions {} … {}",
            force.name.value,
            as_written(range[0]),
            as_written(range[1])
        );
        report.push(Some(stroke.span), NARROWER.found(message));
    }
    if let Some(speed) = force.speed.as_ref().filter(|_| steepest > 0.0) {
        let who = format!("`{}`", force.name.value);
        narrow_speed(model, path.link, speed.value / steepest, &who, speed.span, report);
    }
}

/// Range of the coordinate in which the distance of the frames is within the stroke.
fn allowed(
    force: &PointForceDescription,
    stroke: &At<[f64; 2]>,
    distances: &Distances<'_>,
    path: &Path,
    report: &mut Report,
) -> Option<[f64; 2]> {
    let (name, joint) = (&force.name.value, distances.name(path.link));
    let length = |position: f64| distances.with(path.link, position);
    let lengths: Vec<f64> = places(path.range).into_iter().map(length).collect();
    let grows = lengths[lengths.len() - 1] > lengths[0];
    let goes_on = |pair: &[f64]| if grows { pair[1] > pair[0] } else { pair[1] < pair[0] };
    if !lengths.windows(2).all(goes_on) {
        let message = format!("the length of `{name}` has an extremum within the limits of joint `{joint}`");
        report.error(stroke.span, "length-turns-back", message);
        report.help(
            "a stroke requires a joint range in which the length is monotonic. Narrow the joint's `position` to one side",
        );
        return None;
    }
    let [shortest, longest] = stroke.value;
    let (least, most) = lengths.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), l| (a.min(*l), b.max(*l)));
    if longest <= least || shortest >= most {
        let message = format!(
            "`{name}` is {} to {} m long within the limits of joint `{joint}`, outside its stroke {} … {}",
            three_digits(least),
            three_digits(most),
            as_written(shortest),
            as_written(longest)
        );
        report.error(stroke.span, "limits-exclude", message);
        report.help("no position satisfies all limits. Correct the stroke, the places of the frames or the joint limits");
        return None;
    }
    let is_within = |position: &f64| (shortest..=longest).contains(&length(*position));
    let inside = places(path.range).into_iter().find(is_within).unwrap_or_else(|| {
        // The stroke lies between two of the places. This is the position of its middle.
        crossing(path.range, |position| (length(position) > 0.5 * (shortest + longest)) == grows)[0]
    });
    let [low, high] = path.range.map(|end| {
        if is_within(&end) { end } else { crossing([inside, end], |position| !is_within(&position))[0] }
    });
    let rounded = [
        if low == path.range[0] { low } else { (low * FINENESS).ceil() / FINENESS },
        if high == path.range[1] { high } else { (high * FINENESS).floor() / FINENESS },
    ];
    Some(if rounded[0] < rounded[1] { rounded } else { [low, high] })
}
