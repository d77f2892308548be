//! Forces that `gelenk inspect model` lists after links and joints: drives on several coordinates, and forces
//! at frames.

use serde_json::{Value, json};

use super::print;
use crate::model::{
    Actuator, Attachment, Drive, FollowedCoordinate, ForceEffect, Model, PointForce, Wrench, WrenchAxes,
};
use gelenk_formula::Formula;

/// Tables of the forces of a model. Each table follows an empty line.
pub(super) fn as_text(model: &Model) -> String {
    let drives = shared_drives(model).map(|drive| {
        vec![drive.name.clone(), followed(model, &drive.acts_on, 0.0), drive.gear_ratio.text(&names(model))]
    });
    let laws = model.point_forces.iter().map(|force| {
        vec![force.name.clone(), between(&force.between), format!("pulls with {} N", law(model, force))]
    });
    let inputs = model.force_inputs.iter().map(|input| {
        let (place, effect) = effect(model, &input.effect);
        let limits = input.limits.map_or(String::new(), |[low, high]| {
            format!(
                "{} … {} {}",
                print::number(low),
                print::number(high),
                model.input_unit(Actuator::Force(input))
            )
        });
        vec![input.name.clone(), place, effect, limits]
    });
    let wrenches = model
        .wrenches
        .iter()
        .map(|wrench| vec![wrench.name.clone(), wrench.at.name.clone(), axes(wrench).to_owned()]);
    [
        table(["drive", "acts on", "gear ratio"], drives.collect()),
        table(["force", "between", "law"], laws.collect()),
        table(["input", "acts at", "force", "limits"], inputs.collect()),
        table(["wrench", "acts at", "in the axes of"], wrenches.collect()),
    ]
    .concat()
}

/// Adds the lists of shared drives, forces between frames, inputs at frames and wrenches. A list may be
/// empty.
pub(super) fn add_json(model: &Model, object: &mut Value) {
    let drive = |drive: &Drive| {
        json!({
            "drive": drive.name,
            "acts_on": followed(model, &drive.acts_on, 0.0),
            "gear_ratio": drive.gear_ratio.text(&names(model)),
        })
    };
    let ends = |frames: &[Attachment; 2]| frames.each_ref().map(|frame| frame.name.clone());
    let force = |force: &PointForce| json!({ "name": force.name, "between": ends(&force.between), "law": law(model, force) });
    let wrench =
        |wrench: &Wrench| json!({ "name": wrench.name, "frame": wrench.at.name, "in": axes(wrench) });
    let inputs = model.force_inputs.iter().map(|input| {
        let mut entry = json!({ "name": input.name, "limits": input.limits });
        match &input.effect {
            ForceEffect::Pull(frames) => entry["between"] = json!(ends(frames)),
            ForceEffect::Wrench { at, wrench } => {
                entry["frame"] = json!(at.name);
                entry["wrench"] = json!(entries(model, wrench));
            }
        }
        entry
    });
    object["shared_drives"] = shared_drives(model).map(drive).collect();
    object["forces"] = model.point_forces.iter().map(force).collect();
    object["inputs_at_frames"] = inputs.collect();
    object["wrenches"] = model.wrenches.iter().map(wrench).collect();
}

/// Symbol of a coordinate, for example `y2`, or `d1` for a driven coordinate.
pub(super) fn position(model: &Model, coordinate: usize) -> String {
    match coordinate.checked_sub(model.coordinates.len()) {
        None => format!("y{}", model.first_position(coordinate) + 1),
        Some(driven) => format!("d{}", driven + 1),
    }
}

/// Position of a follower as text, for example `(0.5) y1 + y2 + 0.1`.
pub(super) fn followed(model: &Model, follows: &[FollowedCoordinate], offset: f64) -> String {
    let names: Vec<&str> = model.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    let terms = follows.iter().map(|term| match term.ratio.as_number() {
        Some(1.0) => position(model, term.coordinate),
        _ => format!("({}) {}", term.ratio.text(&names), position(model, term.coordinate)),
    });
    let offset = (offset != 0.0).then(|| print::number(offset));
    terms.chain(offset).collect::<Vec<_>>().join(" + ")
}

/// Drives that act on several coordinates.
fn shared_drives(model: &Model) -> impl Iterator<Item = &Drive> {
    model.moving_drives().filter(|drive| drive.coordinate().is_none())
}

fn names(model: &Model) -> Vec<&str> {
    model.parameters.iter().map(|parameter| parameter.name.as_str()).collect()
}

fn between([a, b]: &[Attachment; 2]) -> String {
    format!("{} – {}", a.name, b.name)
}

fn law(model: &Model, force: &PointForce) -> String {
    force.law.distance_text(&names(model))
}

fn entries(model: &Model, wrench: &[Formula; 6]) -> Vec<String> {
    wrench.iter().map(|entry| entry.text(&names(model))).collect()
}

/// Names of the frames of an input, and its force as text.
fn effect(model: &Model, effect: &ForceEffect) -> (String, String) {
    match effect {
        ForceEffect::Pull(frames) => (between(frames), "pulls with u".to_owned()),
        ForceEffect::Wrench { at, wrench } => {
            (at.name.clone(), format!("u · ({})", entries(model, wrench).join(", ")))
        }
    }
}

fn axes(wrench: &Wrench) -> &'static str {
    match wrench.axes {
        WrenchAxes::Frame => "frame",
        WrenchAxes::Base => "base",
    }
}

fn table<const COLUMNS: usize>(head: [&str; COLUMNS], rows: Vec<Vec<String>>) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let head = head.map(str::to_owned).to_vec();
    format!("\n{}", print::table(&std::iter::once(head).chain(rows).collect::<Vec<_>>()))
}
