//! Words of a URDF that are not known: they are told with the words that were probably meant.

use super::urdf::{Reader, XmlNode};
use super::urdf_notes::HARMLESS;
use crate::diagnostic::{Span, nearest};

/// Attributes of the elements that are read.
const ATTRIBUTES: [(&str, &[&str]); 10] = [
    ("origin", &["xyz", "rpy"]),
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
    /// Notes attributes that nobody reads.
    pub(super) fn known_attributes(&mut self, node: XmlNode<'_>) {
        let tag = node.tag_name().name();
        let Some((_, known)) = ATTRIBUTES.iter().find(|(known, _)| *known == tag) else { return };
        let own = node.attributes().filter(|attribute| attribute.namespace().is_none());
        for unknown in own.filter(|attribute| !known.contains(&attribute.name())) {
            let absent = known.iter().copied().filter(|key| !node.has_attribute(*key));
            let meant = meant(unknown.name(), absent);
            self.notes
                .skip(format!("<{tag} {}>{meant}", unknown.name()), Span::new(self.source, unknown.range()));
        }
    }

    /// Notes an element that is not read.
    ///
    /// - `known`: those that are read in its place
    pub(super) fn skip(&mut self, node: XmlNode<'_>, known: &[&str]) {
        let tag = format!("<{}>", node.tag_name().name());
        let meant = match HARMLESS.contains(&tag.as_str()) {
            true => String::new(),
            false => meant(node.tag_name().name(), known.iter().copied()),
        };
        self.notes.skip(format!("{tag}{meant}"), self.span(node));
    }
}

/// The word that was probably meant, in brackets.
fn meant<'k>(word: &str, known: impl Iterator<Item = &'k str>) -> String {
    let help = nearest(word, known).filter(|help| help.starts_with("did you mean"));
    help.map_or(String::new(), |help| format!(" ({help})"))
}
