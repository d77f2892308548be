//! Reports elements and attributes that MuJoCo does not know. MuJoCo's schema rejects them.

use super::Reader;
use super::files::Element;
use super::schema::{ORIENTATIONS, Place, attributes, inside, tags};
use crate::diagnostic::nearest;

impl<'a> Reader<'_, 'a> {
    /// Reports elements and attributes that MuJoCo does not know. Without the report their values would be
    /// ignored without a message.
    pub(super) fn vocabulary(&mut self, sections: &[Element<'a>]) {
        let files = self.files;
        let mut stack: Vec<_> = sections.iter().rev().map(|section| (Place::Model, *section)).collect();
        while let Some((place, element)) = stack.pop() {
            if !tags(place).contains(&element.tag()) {
                self.unknown_element(place, element);
                continue;
            }
            if let Some(known) = attributes(place, element.tag()) {
                self.unknown_attributes(element, &known);
                self.several_orientations(element, &known);
            }
            if let Some(inner) = inside(place, element.tag()) {
                stack.extend(files.children(element).into_iter().rev().map(|element| (inner, element)));
            }
        }
    }

    /// Elements of a section that MuJoCo knows. [`Self::vocabulary`] reports all other elements.
    pub(super) fn known_children(&self, place: Place, section: Element<'a>) -> Vec<Element<'a>> {
        let mut children = self.files.children(section);
        children.retain(|child| tags(place).contains(&child.tag()));
        children
    }

    fn unknown_element(&mut self, place: Place, element: Element<'a>) {
        self.report.error(element.span(), "unknown-element", format!("unknown element <{}>", element.tag()));
        self.report.help(nearest(element.tag(), tags(place)).unwrap_or_default());
    }

    fn unknown_attributes(&mut self, element: Element<'a>, known: &[&'static str]) {
        for (name, span) in element.attributes().filter(|(name, _)| !known.contains(name)) {
            let message = format!("unknown attribute `{name}` of <{}>", element.tag());
            self.report.error(span, "unknown-attribute", message);
            let help = nearest(name, known.iter().copied().filter(|key| element.attribute(key).is_none()));
            self.report.help(
                help.unwrap_or_else(|| {
                    "remove the attribute: this element has no other attributes".to_owned()
                }),
            );
        }
    }

    fn several_orientations(&mut self, element: Element<'a>, known: &[&'static str]) {
        let given = ORIENTATIONS.map(|key| element.attribute(key).filter(|_| known.contains(&key)));
        let keys = ORIENTATIONS.iter().zip(&given).filter(|(_, given)| given.is_some());
        let keys: Vec<String> = keys.map(|(key, _)| format!("`{key}`")).collect();
        if let (2.., Some(last)) = (keys.len(), given.iter().flatten().max_by_key(|given| given.span.start)) {
            let message = format!("<{}> has several orientations: {}", element.tag(), keys.join(", "));
            self.report
                .error(last.span, "several-orientations", message)
                .help("give exactly one orientation");
        }
    }
}
