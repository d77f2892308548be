//! Unknown names in a URDF, with the names that were probably intended.

use super::foreign::{CONTACTS, effect, plain};
use super::notes::{self, HARMLESS};
use super::{Reader, XmlNode};
use crate::diagnostic::{Span, nearest};
use crate::read::skipped::Remark;
use crate::wording::as_written;
use roxmltree::Node;

/// Attributes that the elements of a URDF may have.
const ATTRIBUTES: [(&str, &[&str]); 10] = [
    ("origin", &["xyz", "rpy", "quat_xyzw"]),
    ("mass", &["value"]),
    ("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]),
    ("axis", &["xyz"]),
    ("limit", &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"]),
    ("dynamics", &["damping", "friction"]),
    ("mimic", &["joint", "multiplier", "offset"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("joint", &["name", "type"]),
];

impl Reader<'_> {
    /// Warns of unknown attributes of elements that describe the dynamics.
    pub(super) fn known_attributes(&mut self, node: XmlNode<'_>) {
        let tag = node.tag_name().name();
        let Some((_, known)) = ATTRIBUTES.iter().find(|(known, _)| *known == tag) else { return };
        for unknown in node.attributes().filter(|attribute| !known.contains(&attribute.name())) {
            let (name, span) = (unknown.name(), Span::new(self.source, unknown.range()));
            let is_foreign = self.foreign_word(node, name, unknown.value(), span);
            if !is_foreign && unknown.namespace().is_none() && !name.contains('.') {
                let absent = known.iter().copied().filter(|key| !node.has_attribute(*key));
                self.notes.remark(notes::UNKNOWN, span, format!("<{tag} {name}>{}", meant(name, absent)));
            }
        }
    }

    /// Warns of an element that changes the dynamics in other tools, and of elements and attributes inside it
    /// that change the dynamics. Returns whether there are any.
    pub(super) fn foreign(&mut self, node: XmlNode<'_>) -> bool {
        let mut is_known = false;
        for inner in node.descendants().filter(Node::is_element) {
            let tag = inner.tag_name().name();
            let is_joint = tag == "joint" && inner.children().any(|end| end.has_tag_name("child"));
            let word = if is_joint { "loop_joint" } else { tag };
            is_known |= self.foreign_word(inner, word, value_of(inner), self.span(inner));
            // `<param name="rotor_inertia">0.1</param>`, `<plugin name="gz::sim::systems::Buoyancy"/>`
            if let Some(name) = inner.attribute("name").filter(|_| ["param", "plugin"].contains(&tag)) {
                let node = inner.parent_element().unwrap_or(inner);
                is_known |= self.foreign_word(node, name, value_of(inner), self.span(inner));
            }
            for attribute in inner.attributes() {
                let span = Span::new(self.source, attribute.range());
                is_known |= self.foreign_word(inner, attribute.name(), attribute.value(), span);
            }
        }
        is_known
    }

    /// Whether the name has an effect on the dynamics in other tools. If so, adds a remark.
    pub(super) fn foreign_word(&mut self, node: XmlNode<'_>, word: &str, value: &str, span: Span) -> bool {
        let Some(text) = effect(word, value) else { return false };
        let is_contact = |node: XmlNode<'_>| CONTACTS.contains(&node.tag_name().name());
        let is_of_contact = ["stiffness", "damping"].contains(&word) && node.ancestors().any(is_contact);
        if is_of_contact || (plain(word) == "mimicjoint" && is_coupled(node, value)) {
            return false;
        }
        let of = owner(node).map_or(String::new(), |owner| format!(" of `{owner}`"));
        let value = value.parse().map_or(String::new(), |number| format!(" {}", as_written(number)));
        self.notes.remark(
            Remark::warning("dynamics-skipped", text),
            span,
            format!("`{}`{value}{of}", word.replace('.', ":")),
        );
        true
    }

    /// Adds a note about an element that is skipped.
    ///
    /// - `known`: tags of the elements that are read at this place
    pub(super) fn skip(&mut self, node: XmlNode<'_>, known: &[&str]) {
        let tag = format!("<{}>", node.tag_name().name());
        let is_foreign = self.foreign(node);
        let is_harmless = HARMLESS.contains(&tag.as_str());
        let meant = meant(node.tag_name().name(), known.iter().copied().filter(|_| !is_harmless));
        let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
        match ["joint", "inertial"].contains(&parent) && !is_harmless {
            _ if is_foreign => {}
            true => self.notes.remark(notes::UNKNOWN, self.span(node), format!("{tag}{meant}")),
            false => self.notes.skip(format!("{tag}{meant}"), self.span(node)),
        }
    }
}

/// The known word that was probably meant, in brackets; empty without a similar word.
fn meant<'k>(word: &str, known: impl Iterator<Item = &'k str>) -> String {
    let help = nearest(word, known).filter(|help| help.starts_with("did you mean"));
    help.map_or(String::new(), |help| format!(" ({help})"))
}

/// Value of an element: its attribute `value` or its text.
pub(super) fn value_of<'a>(node: XmlNode<'a>) -> &'a str {
    node.attribute("value").or_else(|| node.text()).unwrap_or("").trim()
}

/// Name of the element that encloses this element.
fn owner(node: XmlNode<'_>) -> Option<&str> {
    node.ancestors().find_map(|node| node.attribute("reference").or_else(|| node.attribute("name")))
}

/// Whether a `<mimic>` of some joint names the same leading joint as a plugin.
fn is_coupled(node: XmlNode<'_>, leader: &str) -> bool {
    let mut mimics = node.document().descendants().filter(|node| node.has_tag_name("mimic"));
    mimics.any(|mimic| mimic.attribute("joint") == Some(leader))
}
