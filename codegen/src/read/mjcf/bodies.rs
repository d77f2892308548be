//! Reading of nested bodies.

use super::files::Element;
use super::schema::{ORIENTATIONS, Place, tags};
use super::{Placed, Reader, WORLD, notes};
use crate::description::{FrameDescription, JointDescription, Name};
use crate::diagnostic::At;
use crate::model::{JointKind, Pose};
use gelenk_formula::Formula;

/// Tags of elements that MuJoCo expands to several bodies.
const GENERATORS: [&str; 2] = ["composite", "flexcomp"];

/// Tags of elements that contain bodies.
const BODIES: [&str; 2] = ["body", "attach"];

/// Largest number of elements in a body. It limits the attribute `count` of `<replicate>`.
const MOST_ELEMENTS: usize = 10_000;

/// A body that is read after the bodies before it, with the name of its parent.
struct Waiting<'a> {
    body: Placed<'a>,
    parent: Name,
}

impl<'a> Reader<'_, 'a> {
    /// Reads all bodies in MuJoCo's order, parents first.
    pub(super) fn bodies(&mut self, worlds: &[Element<'a>]) {
        let mut waiting = Vec::new();
        for &world in worlds {
            let name = At::new(WORLD.to_owned(), world.span());
            let class = self.class(world, "childclass", 0);
            let contents = self.contents(world, class, "");
            for placed in &contents {
                match placed.element.tag() {
                    "site" => self.site(placed, &name),
                    "geom" | "body" | "attach" | "light" | "camera" => {}
                    _ => self.unread(placed),
                }
            }
            let bodies = contents.into_iter().filter(|placed| BODIES.contains(&placed.element.tag()));
            waiting.extend(bodies.map(|body| Waiting { body, parent: name.clone() }));
        }
        waiting.reverse();
        while let Some(Waiting { body, parent }) = waiting.pop() {
            if body.element.tag() == "attach" {
                self.attach(&body, &parent);
                continue;
            }
            let (name, contents) = self.body(body, parent);
            let inner = contents.into_iter().rev().filter(|placed| BODIES.contains(&placed.element.tag()));
            waiting.extend(inner.map(|body| Waiting { body, parent: name.clone() }));
        }
    }

    /// Reads a body without the bodies inside it. Returns the name of the body and its content.
    fn body(&mut self, body: Placed<'a>, parent: Name) -> (Name, Vec<Placed<'a>>) {
        let element = body.element;
        let named = self.placed_name(&body);
        let wanted = named.as_ref().map_or_else(|| "body".to_owned(), |name| name.value.clone());
        let own = self.link_names.take(&wanted);
        let name = At::new(own, named.as_ref().map_or(element.span(), |name| name.span));
        if named.is_some() && name.value != wanted {
            self.report.error(name.span, "duplicate-name", format!("two bodies have the name `{wanted}`"));
        }
        self.robot.links.push(name.clone());
        let pose = body.pose.then(&self.pose(element, &format!("body `{}`", name.value)));
        let class = self.class(element, "childclass", body.class);
        let contents = self.contents(element, class, &body.suffix);
        let joints: Vec<&Placed<'a>> =
            contents.iter().filter(|placed| ["joint", "freejoint"].contains(&placed.element.tag())).collect();
        if let Some(given) = element.attribute("gravcomp").filter(|given| given.text.trim() != "0") {
            self.notes.remark(notes::GRAVITY_COMPENSATION, given.span, name.quoted());
        }
        self.bodies.insert(name.value.clone(), self.robot.joints.len());
        match joints.is_empty() {
            true => self.fix(&name, parent, pose),
            false => self.joints(&name, parent, pose, &joints),
        }
        self.inertia(&name, element, &contents);
        for placed in &contents {
            match placed.element.tag() {
                "site" => self.site(placed, &name),
                "geom" | "body" | "attach" | "light" | "camera" | "joint" | "freejoint" | "inertial" => {}
                _ => self.unread(placed),
            }
        }
        (name, contents)
    }

    fn fix(&mut self, name: &Name, parent: Name, pose: Pose) {
        let own = self.joint_names.take(&format!("{}_fixed", name.value));
        self.robot.joints.push(JointDescription {
            kind: Some(JointKind::Fixed),
            parent: Some(parent),
            child: Some(name.clone()),
            origin: Some(pose),
            ..JointDescription::named(At::new(own, name.span))
        });
    }

    fn unread(&mut self, placed: &Placed<'a>) {
        let tag = placed.element.tag();
        if GENERATORS.contains(&tag) {
            self.refuse(placed.element);
        } else if tag == "plugin" {
            self.notes.remark(notes::ELASTIC, placed.element.span(), "`plugin`".to_owned());
        } else if tags(Place::Body).contains(&tag) {
            self.notes.skip(format!("<{tag}>"), placed.element.span());
        }
    }

    fn site(&mut self, placed: &Placed<'a>, link: &Name) {
        let Some(name) = self.placed_name(placed) else { return };
        let class = self.class(placed.element, "class", placed.class);
        let placed = Placed { class, ..placed.clone() };
        let pose = self.pose_of(&placed, &format!("site `{}`", name.value));
        self.sites.insert(name.value.clone());
        let pose = placed.pose.then(&pose);
        self.robot.frames.push(FrameDescription { name, link: link.clone(), pose, is_site: true });
    }

    /// Pose of an element, from its attributes or from its class.
    pub(super) fn pose_of(&mut self, placed: &Placed<'a>, owner: &str) -> Pose {
        let element = placed.element;
        let is_turned = ORIENTATIONS.iter().any(|key| element.attribute(key).is_some());
        let keys = ["pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"];
        let found = keys.map(|key| match is_turned && ORIENTATIONS.contains(&key) {
            // An orientation of the element replaces all orientations of the class.
            true => element.attribute(key),
            false => self.find(placed, key),
        });
        let at = |wanted: &str| keys.iter().position(|key| *key == wanted).and_then(|index| found[index]);
        self.pose_by(&at, owner)
    }

    /// Elements of a body, with frames and replicated elements expanded.
    fn contents(&mut self, element: Element<'a>, class: usize, suffix: &str) -> Vec<Placed<'a>> {
        let files = self.files;
        let inside = |around: &Placed<'a>| {
            let inner = files.children(around.element).into_iter().rev();
            let around = around.clone();
            inner.map(move |element| Placed { element, ..around.clone() }).collect::<Vec<_>>()
        };
        let outer = Placed { suffix: suffix.to_owned(), ..Placed::outside(element, class) };
        let mut stack = inside(&outer);
        let mut contents = Vec::new();
        while let Some(next) = stack.pop() {
            match next.element.tag() {
                "frame" => {
                    let pose = next.pose.then(&self.pose(next.element, "a frame"));
                    let class = self.class(next.element, "childclass", next.class);
                    stack.extend(inside(&Placed { pose, class, ..next }));
                }
                "replicate" => {
                    let copies =
                        self.copies(&next, MOST_ELEMENTS.saturating_sub(stack.len() + contents.len()));
                    stack.extend(copies.iter().rev().flat_map(inside));
                }
                _ => contents.push(next),
            }
        }
        contents
    }

    /// The copies that `<replicate>` makes. Each copy is moved by `offset` in the frame of the previous copy,
    /// and turned by its number times the angles `euler`. Names in a copy end with `sep` and the number of
    /// the copy.
    fn copies(&mut self, replicate: &Placed<'a>, most: usize) -> Vec<Placed<'a>> {
        let element = replicate.element;
        let count = self.number(element.attribute("count"), "count");
        let is_whole = |count: &f64| count.fract() == 0.0 && (1.0..=most as f64).contains(count);
        let count = count.map(|count| count.value).filter(is_whole).map_or(0, |count| count as usize);
        if count == 0 {
            self.report.error(element.span(), "replicate-count", "<replicate> needs a valid `count`");
            self.report
                .help(format!("give a whole number from 1. A body has at most {MOST_ELEMENTS} elements"));
            return Vec::new();
        }
        let offset =
            self.vector::<3>(element.attribute("offset"), "offset").map_or([0.0; 3], |offset| offset.value);
        let euler = self.vector::<3>(element.attribute("euler"), "euler");
        let separator = element.node.attribute("sep").unwrap_or("");
        let digits = (count - 1).to_string().len();
        let mut moved = Pose::identity();
        let copy = |number: usize| {
            if let Some(At { value, span }) = &euler {
                let angles = At::new(value.map(|angle| number as f64 * angle), *span);
                moved.rotation = self.euler(&angles, "a copy");
            }
            let copy = Placed {
                pose: replicate.pose.then(&moved),
                suffix: format!("{separator}{number:0digits$}{}", replicate.suffix),
                ..replicate.clone()
            };
            moved.translation = moved.point(&offset.map(Formula::Number));
            copy
        };
        (0..count).map(copy).collect()
    }
}
