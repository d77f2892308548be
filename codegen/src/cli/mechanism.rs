//! The command `gelenk inspect mechanism`, which prints the frames and masses from which the equations are
//! derived.

use gelenk_report::{Cell, Table};

use crate::dynamics::formulation::Formulation;
use crate::graph::Graph;
use crate::kinematics::{Body, Mechanism, Number};
use crate::model::{Model, QuaternionJoint, QuaternionKind};
use crate::numeric;

/// Tables of the frames and of the moments of mass.
pub(super) fn tables(model: &Model) -> [Table; 2] {
    let shown = Shown::new(model);
    [shown.frames(), shown.moments()]
}

/// The bodies, joints and rotors of a model as they are printed. The bodies of a joint with a quaternion are
/// shown as one body, because only the last one has a mass.
struct Shown<'m> {
    model: &'m Model,
    mechanism: Mechanism<Number>,
}

impl<'m> Shown<'m> {
    /// Creates the mechanism with the usual recursive equations, because the cheapest formulation differs
    /// from function to function.
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

    /// Returns the body whose frame is the frame of the joint: the first body of a joint with a quaternion,
    /// otherwise `body`.
    fn stand<'a>(&'a self, body: &'a Body<Number>) -> &'a Body<Number> {
        body.chain.map_or(body, |place| &self.mechanism.bodies[place.first])
    }

    /// Name of the joint before the body's joint. For joints on the base it is `base`, or the name of the
    /// base link if the robot has quaternions, because a floating joint is usually called `base`.
    fn parent<'a>(&'a self, body: &'a Body<Number>) -> &'a str {
        match (self.stand(body).parent, self.model.quaternion_joints.is_empty()) {
            (Some(parent), _) => self.name(&self.mechanism.bodies[parent]),
            (None, true) => "base",
            (None, false) => self.model.links.first().map_or("base", |link| link.name.as_str()),
        }
    }

    /// Number of a coordinate's first position entry, from 1.
    fn position(&self, coordinate: usize) -> usize {
        self.model.first_position(coordinate) + 1
    }

    /// The coordinates that a body's joint follows as text, for example `y1`, `-y2`, `2 y1 + y3`, or `d1` for
    /// a coordinate with prescribed motion.
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
                Some(size) => format!("{size} "),
                None => "free ".to_owned(),
            };
            text += &match term.coordinate.checked_sub(self.mechanism.free()) {
                None => format!("y{}", self.position(term.coordinate)),
                Some(driven) => format!("d{}", driven + 1),
            };
        }
        text
    }

    fn frames(&self) -> Table {
        let quaternions = match self.model.quaternion_joints.is_empty() {
            true => "",
            false => {
                " A spherical joint is at x y z of the parent's frame. The positions of a joint with a quaternion are the pose of \
                 its body. The next joints begin at the frame of its link."
            }
        };
        let caption = format!(
            "Modified Denavit–Hartenberg frames: R_z(gamma) R_x(alpha) and the shift x y z transform the parent's frame to the \
             joint's axis. `lift` is the distance along the axis to the origin.{quaternions}"
        );
        let mut table = Table::new("frames", &caption);
        for name in ["joint", "parent", "kind", "follows"] {
            table = table.column(name, name, "");
        }
        for (name, unit) in [
            ("gamma", "°"),
            ("alpha", "°"),
            ("x", "m"),
            ("y", "m"),
            ("z", "m"),
            ("lift", "m"),
            ("offset", "°"),
        ] {
            table = table.column(name, name, unit);
        }
        table.rows(self.bodies().map(|(body, whole)| {
            let names = [self.name(body), self.parent(body)].map(Cell::text);
            let frame = match whole {
                Some(whole) => self.quaternion_frame(body, whole),
                None => self.frame(body),
            };
            names.into_iter().chain(frame).collect()
        }))
    }

    /// Cells of the frame of a body, after the names.
    fn frame(&self, body: &Body<Number>) -> [Cell; 9] {
        let [x, y, z] = body.translation.0.map(shown);
        [
            Cell::text(body.axis.name()),
            Cell::text(self.followed(body)),
            Cell::Exact(degrees(body.twist.gamma)),
            Cell::Exact(degrees(body.twist.alpha)),
            x,
            y,
            z,
            shown(body.lift),
            Cell::Exact(body.offset.radians().to_degrees()),
        ]
    }

    /// Cells of the frame of a joint with a quaternion. The frame has no angles. The positions of a floating joint contain its place.
    fn quaternion_frame(&self, body: &Body<Number>, whole: &QuaternionJoint) -> [Cell; 9] {
        let [x, y, z] = match whole.kind {
            QuaternionKind::Floating => [Cell::Empty, Cell::Empty, Cell::Empty],
            QuaternionKind::Spherical => self.stand(body).translation.0.map(shown),
        };
        let first = self.position(whole.first);
        let positions = format!("y{first} … y{}", first + whole.kind.positions() - 1);
        let none = || Cell::Empty;
        [Cell::text(whole.kind.name()), Cell::Text(positions), none(), none(), x, y, z, none(), none()]
    }

    fn moments(&self) -> Table {
        let caption = "Masses and their moments about the origins. Masses that matter only as a sum are moved towards the base. \
                       `free` marks values that depend on free parameters.";
        let mut table = Table::new("moments", caption).column("body", "body", "").column("m", "m", "kg");
        for (names, unit) in [
            (&["h_x", "h_y", "h_z"][..], "kg m"),
            (&["S_xx", "S_xy", "S_xz", "S_yy", "S_yz", "S_zz"], "kg m²"),
        ] {
            for name in names {
                table = table.column(name, *name, unit);
            }
        }
        table.rows(self.bodies().map(|(body, _)| {
            let entries = body.moments.entries().map(shown);
            std::iter::once(Cell::text(self.name(body))).chain(entries).collect()
        }))
    }
}

fn degrees((sine, cosine): (f64, f64)) -> f64 {
    numeric::atan2(sine, cosine).to_degrees()
}

fn shown(x: Number) -> Cell {
    x.value().map_or_else(|| Cell::text("free"), Cell::Exact)
}
