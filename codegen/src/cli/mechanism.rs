//! The command `gelenk inspect mechanism`, which prints the frames and masses from which the equations are
//! derived.

use serde_json::{Value, json};

use super::print;
use crate::dynamics::formulation::Formulation;
use crate::graph::Graph;
use crate::kinematics::{Body, Followed, Mechanism, Number};
use crate::model::{Model, QuaternionJoint, QuaternionKind};
use crate::numeric;

pub(super) fn as_text(model: &Model) -> String {
    let shown = Shown::new(model);
    let quaternions = match model.quaternion_joints.is_empty() {
        true => "",
        false => {
            ".\nA spherical joint is at x y z of the parent's frame; positions of a joint with a quaternion place and turn its \
             body,\nand the joints behind it lead on from the frame of its link"
        }
    };
    format!(
        "Modified Denavit–Hartenberg frames: R_z(gamma) R_x(alpha) and the shift x y z lead from the parent's frame to the \
         joint's axis,\n`lift` along it to the origin (m, degrees){quaternions}\n\n{}\nMoments of mass about the origins; masses that act only through their sum are moved towards the base\n(kg, kg m, kg m²; `free` depends on parameters)\n\n{}",
        print::table(&shown.frames()),
        print::table(&shown.moments()),
    )
}

pub(super) fn as_json(model: &Model) -> Value {
    let shown = Shown::new(model);
    shown.bodies().map(|(body, whole)| shown.entry(body, whole)).collect()
}

/// A mechanism with its model. The bodies of a joint with a quaternion are shown as one body, because only
/// the last one has a mass.
struct Shown<'m> {
    model: &'m Model,
    mechanism: Mechanism<Number>,
}

impl<'m> Shown<'m> {
    /// The mechanism in the plain formulation, because the cheapest formulation differs from function to
    /// function.
    fn new(model: &'m Model) -> Self {
        let mechanism = Mechanism::new(model);
        let plain = Formulation::plain(mechanism.bodies.len());
        Self { model, mechanism: plain.mechanism(&Graph::new(), &mechanism).by_itself() }
    }

    /// The shown bodies. The second value is the joint if it has a quaternion.
    fn bodies(&self) -> impl Iterator<Item = (&Body<Number>, Option<&'m QuaternionJoint>)> {
        let bodies = self.mechanism.bodies.iter().enumerate();
        let whole = bodies.filter(|(index, body)| body.chain.is_none_or(|place| place.last == *index));
        whole.map(|(_, body)| (body, self.model.quaternion_joint_of(body.joint)))
    }

    fn name<'a>(&'a self, body: &'a Body<Number>) -> &'a str {
        match self.model.quaternion_joint_of(body.joint) {
            Some(whole) => &whole.name,
            None => &body.name,
        }
    }

    /// The body that has the place of the joint. For a joint with a quaternion it is the first body of the
    /// joint.
    fn stand<'a>(&'a self, body: &'a Body<Number>) -> &'a Body<Number> {
        body.chain.map_or(body, |place| &self.mechanism.bodies[place.first])
    }

    /// Name of the joint that carries the body's joint. For joints on the base it is `base`, or the name of
    /// the base link if the robot has quaternions, because a floating joint is usually called `base`.
    fn parent<'a>(&'a self, body: &'a Body<Number>) -> &'a str {
        match (self.stand(body).parent, self.model.quaternion_joints.is_empty()) {
            (Some(parent), _) => self.name(&self.mechanism.bodies[parent]),
            (None, true) => "base",
            (None, false) => self.model.links.first().map_or("base", |link| link.name.as_str()),
        }
    }

    /// Number of the first position entry of a coordinate, from 1.
    fn position(&self, coordinate: usize) -> usize {
        self.model.first_position(coordinate) + 1
    }

    /// Numbers of the first and last position entry of a joint, from 1.
    fn positions(&self, joint: &QuaternionJoint) -> [usize; 2] {
        let first = self.position(joint.first);
        [first, first + joint.kind.positions() - 1]
    }

    fn entry(&self, body: &Body<Number>, whole: Option<&QuaternionJoint>) -> Value {
        let numbers = |entries: &[Number]| entries.iter().map(|x| x.value()).collect::<Vec<_>>();
        let angle = |value: f64| whole.is_none().then_some(value);
        let mut entry = json!({
            "joint": self.name(body),
            "parent": self.parent(body),
            "kind": whole.map_or(body.axis.name(), |whole| whole.kind.name()),
            "follows": if whole.is_none() { self.follows(body) } else { vec![] },
            "gamma": angle(degrees(body.twist.gamma)),
            "alpha": angle(degrees(body.twist.alpha)),
            "translation": numbers(&self.stand(body).translation.0),
            "lift": whole.map_or(body.lift.value(), |_| None),
            "offset": angle(body.offset.radians().to_degrees()),
            "mass": body.moments.mass.value(),
            "first_moment": numbers(&body.moments.first.0),
            "second_moment": numbers(&body.moments.second.entries()),
        });
        if let Some(whole) = whole {
            let velocities = whole.coordinates();
            entry["positions"] = json!(self.positions(whole));
            entry["velocities"] = json!([velocities.start + 1, velocities.end]);
        }
        entry
    }

    /// The coordinates and driven coordinates that a joint follows, with ratios. A ratio is `null` if it
    /// depends on free parameters.
    fn follows(&self, body: &Body<Number>) -> Vec<Value> {
        let terms = body.transmission.terms.iter();
        let entry = |term: &Followed<Number>| {
            let ratio = term.ratio.value();
            match term.coordinate.checked_sub(self.mechanism.free()) {
                None => {
                    let position = self.position(term.coordinate);
                    json!({ "coordinate": term.coordinate + 1, "position": position, "ratio": ratio })
                }
                Some(driven) => json!({ "driven": driven + 1, "ratio": ratio }),
            }
        };
        terms.map(entry).collect()
    }

    /// The followed coordinates as text, for example `y1`, `-y2`, `2 y1 + y3`, or `d1` for a driven
    /// coordinate.
    fn followed(&self, body: &Body<Number>) -> String {
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
            text += &match term.coordinate.checked_sub(self.mechanism.free()) {
                None => format!("y{}", self.position(term.coordinate)),
                Some(driven) => format!("d{}", driven + 1),
            };
        }
        text
    }

    fn frames(&self) -> Vec<Vec<String>> {
        let head = ["joint", "parent", "kind", "follows", "gamma", "alpha", "x", "y", "z", "lift", "offset"];
        with_head(
            &head,
            self.bodies().map(|(body, whole)| {
                let mut row = vec![self.name(body).to_owned(), self.parent(body).to_owned()];
                match whole {
                    Some(whole) => row.extend(self.quaternion_frame(body, whole)),
                    None => row.extend(self.frame(body)),
                }
                row
            }),
        )
    }

    /// Table cells of the frame of a body. They follow the cells of the names.
    fn frame(&self, body: &Body<Number>) -> [String; 9] {
        let [x, y, z] = body.translation.0.map(shown);
        [
            body.axis.name().to_owned(),
            self.followed(body),
            number(degrees(body.twist.gamma)),
            number(degrees(body.twist.alpha)),
            x,
            y,
            z,
            shown(body.lift),
            number(body.offset.radians().to_degrees()),
        ]
    }

    /// Table cells of the frame of a joint with a quaternion. Such a joint has no angles, and the place of a
    /// floating joint is part of its positions.
    fn quaternion_frame(&self, body: &Body<Number>, whole: &QuaternionJoint) -> [String; 9] {
        let [x, y, z] = match whole.kind {
            QuaternionKind::Floating => Default::default(),
            QuaternionKind::Spherical => self.stand(body).translation.0.map(shown),
        };
        let [first, last] = self.positions(whole);
        let none = String::new;
        [whole.kind.name().to_owned(), format!("y{first} … y{last}"), none(), none(), x, y, z, none(), none()]
    }

    fn moments(&self) -> Vec<Vec<String>> {
        let head = ["body", "m", "h_x", "h_y", "h_z", "S_xx", "S_xy", "S_xz", "S_yy", "S_yz", "S_zz"];
        let rows = self.bodies().map(|(body, _)| {
            let entries = body.moments.entries().map(shown);
            std::iter::once(self.name(body).to_owned()).chain(entries).collect()
        });
        with_head(&head, rows)
    }
}

fn with_head(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Vec<Vec<String>> {
    let head = head.iter().map(|&title| title.to_owned()).collect();
    std::iter::once(head).chain(rows).collect()
}

fn degrees((sine, cosine): (f64, f64)) -> f64 {
    numeric::atan2(sine, cosine).to_degrees()
}

fn shown(x: Number) -> String {
    x.value().map_or_else(|| "free".to_owned(), number)
}

/// The number with six digits, for reading.
fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    format!("{}", rounded + 0.0)
}
