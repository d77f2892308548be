//! `gelenk inspect mechanism`: the frames and the masses that the derivation starts from.

use serde_json::{Value, json};

use super::print;
use crate::dynamics::formulation::Formulation;
use crate::graph::Graph;
use crate::kinematics::{Body, Followed, Mechanism, Number};
use crate::model::Model;
use crate::numeric;

pub(super) fn as_text(model: &Model) -> String {
    let mechanism = mechanism(model);
    format!(
        "Modified Denavit–Hartenberg frames: R_z(gamma) R_x(alpha) and the shift x y z lead from the parent's frame to the \
         joint's axis,\n`lift` along it to the origin (m, degrees)\n\n{}\nMoments of mass about the origins, what acts \
         only through its sum moved towards the base\n(kg, kg m, kg m²; `free` depends on parameters)\n\n{}",
        print::table(&frames(&mechanism)),
        print::table(&moments(&mechanism)),
    )
}

pub(super) fn as_json(model: &Model) -> Value {
    let mechanism = mechanism(model);
    let numbers = |entries: &[Number]| entries.iter().map(|x| x.value()).collect::<Vec<_>>();
    let body = |body: &Body<Number>| {
        json!({
            "joint": body.name,
            "parent": parent(&mechanism, body),
            "kind": body.axis.name(),
            "follows": follows(&mechanism, body),
            "gamma": degrees(body.twist.gamma),
            "alpha": degrees(body.twist.alpha),
            "translation": numbers(&body.translation.0),
            "lift": body.lift.value(),
            "offset": body.offset.radians().to_degrees(),
            "mass": body.moments.mass.value(),
            "first_moment": numbers(&body.moments.first.0),
            "second_moment": numbers(&body.moments.second.entries()),
        })
    };
    mechanism.bodies.iter().map(body).collect()
}

/// The coordinates, or driven ones, that a joint follows with its axis, each with its ratio; `null` where that depends
/// on parameters.
fn follows(mechanism: &Mechanism<Number>, body: &Body<Number>) -> Vec<Value> {
    let terms = body.transmission.terms.iter();
    let entry = |term: &Followed<Number>| {
        let ratio = term.ratio.value();
        match term.coordinate.checked_sub(mechanism.free()) {
            None => json!({ "coordinate": term.coordinate + 1, "ratio": ratio }),
            Some(driven) => json!({ "driven": driven + 1, "ratio": ratio }),
        }
    };
    terms.map(entry).collect()
}

/// `y1`, `-y2`, `2 y1 + y3`, `d1` of a driven joint
fn followed(mechanism: &Mechanism<Number>, body: &Body<Number>) -> String {
    let mut text = String::new();
    for term in &body.transmission.terms {
        let ratio = term.ratio.value();
        let (sign, size) = match ratio {
            Some(ratio) if ratio < 0.0 => ("-", Some(-ratio)),
            ratio => ("+", ratio),
        };
        text += match (text.is_empty(), sign) {
            (true, "+") => "",
            (true, _) => "-",
            (false, "+") => " + ",
            (false, _) => " - ",
        };
        text += &match size {
            Some(1.0) => String::new(),
            Some(size) => format!("{} ", number(size)),
            None => "free ".to_owned(),
        };
        text += &match term.coordinate.checked_sub(mechanism.free()) {
            None => format!("y{}", term.coordinate + 1),
            Some(driven) => format!("d{}", driven + 1),
        };
    }
    text
}

/// The plain formulation; the cheapest one differs from function to function.
fn mechanism(model: &Model) -> Mechanism<Number> {
    let mechanism = Mechanism::new(model);
    Formulation::plain(mechanism.bodies.len()).mechanism(&Graph::new(), &mechanism).by_itself()
}

fn frames(mechanism: &Mechanism<Number>) -> Vec<Vec<String>> {
    let head = ["joint", "parent", "kind", "follows", "gamma", "alpha", "x", "y", "z", "lift", "offset"];
    let rows = mechanism.bodies.iter().map(|body| {
        let [x, y, z] = body.translation.0.map(shown);
        vec![
            body.name.clone(),
            parent(mechanism, body).to_owned(),
            body.axis.name().to_owned(),
            followed(mechanism, body),
            number(degrees(body.twist.gamma)),
            number(degrees(body.twist.alpha)),
            x,
            y,
            z,
            shown(body.lift),
            number(body.offset.radians().to_degrees()),
        ]
    });
    with_head(&head, rows)
}

fn moments(mechanism: &Mechanism<Number>) -> Vec<Vec<String>> {
    let head = ["body", "m", "h_x", "h_y", "h_z", "S_xx", "S_xy", "S_xz", "S_yy", "S_yz", "S_zz"];
    let rows = mechanism.bodies.iter().map(|body| {
        let entries = body.moments.entries().map(shown);
        std::iter::once(body.name.clone()).chain(entries).collect()
    });
    with_head(&head, rows)
}

fn with_head(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Vec<Vec<String>> {
    let head = head.iter().map(|&title| title.to_owned()).collect();
    std::iter::once(head).chain(rows).collect()
}

fn parent<'a>(mechanism: &'a Mechanism<Number>, body: &Body<Number>) -> &'a str {
    body.parent.map_or("base", |parent| mechanism.bodies[parent].name.as_str())
}

fn degrees((sine, cosine): (f64, f64)) -> f64 {
    numeric::atan2(sine, cosine).to_degrees()
}

fn shown(x: Number) -> String {
    x.value().map_or_else(|| "free".to_owned(), number)
}

/// Six digits: this is for reading, the generated code holds all of them.
fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    format!("{}", rounded + 0.0)
}
