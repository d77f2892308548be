//! Words of a URDF that are not known, with the words that were probably meant.

use super::urdf::{Reader, XmlNode};
use super::urdf_notes::{HARMLESS, Remark};
use crate::diagnostic::{Span, nearest};

/// Attributes of the elements that are read.
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
    /// Warns of attributes that nobody reads: these elements describe the dynamics.
    pub(super) fn known_attributes(&mut self, node: XmlNode<'_>) {
        let tag = node.tag_name().name();
        let Some((_, known)) = ATTRIBUTES.iter().find(|(known, _)| *known == tag) else { return };
        for unknown in node.attributes().filter(|attribute| !known.contains(&attribute.name())) {
            let (name, span) = (unknown.name(), Span::new(self.source, unknown.range()));
            let is_foreign = self.foreign_word(node, name, unknown.value(), span);
            if !is_foreign && unknown.namespace().is_none() && !name.contains('.') {
                let absent = known.iter().copied().filter(|key| !node.has_attribute(*key));
                self.notes.remark(Remark::Unknown, span, format!("<{tag} {name}>{}", meant(name, absent)));
            }
        }
    }

    /// Notes an element that is not read.
    ///
    /// - `known`: those that are read in its place
    pub(super) fn skip(&mut self, node: XmlNode<'_>, known: &[&str]) {
        let tag = format!("<{}>", node.tag_name().name());
        let is_foreign = self.foreign(node);
        let is_harmless = HARMLESS.contains(&tag.as_str());
        let meant = meant(node.tag_name().name(), known.iter().copied().filter(|_| !is_harmless));
        let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
        match ["joint", "inertial"].contains(&parent) && !is_harmless {
            _ if is_foreign => {}
            true => self.notes.remark(Remark::Unknown, self.span(node), format!("{tag}{meant}")),
            false => self.notes.skip(format!("{tag}{meant}"), self.span(node)),
        }
    }
}

/// The word that was probably meant, in brackets.
fn meant<'k>(word: &str, known: impl Iterator<Item = &'k str>) -> String {
    let help = nearest(word, known).filter(|help| help.starts_with("did you mean"));
    help.map_or(String::new(), |help| format!(" ({help})"))
}
