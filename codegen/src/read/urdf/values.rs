//! Names, numbers and elements of a URDF, with their places.

use super::notes;
use super::text::opening_tag;
use super::{Reader, XmlNode};
use crate::description::Name;
use crate::diagnostic::{At, Span};
use gelenk_formula::{LARGEST_NUMBER, too_large};
use roxmltree::{Attribute, Node};

/// An attribute by its name, with or without the prefix of a tool, for example `drake:acceleration`.
pub(super) fn of_any_tool<'a>(node: XmlNode<'a>, key: &str) -> Option<Attribute<'a, 'a>> {
    let mut attributes = node.attributes();
    let prefixed = |name: &str| name.rsplit('.').next() == Some(key);
    node.attribute_node(key).or_else(|| attributes.find(|attribute| prefixed(attribute.name())))
}

impl Reader<'_> {
    pub(super) fn span(&self, node: XmlNode<'_>) -> Span {
        opening_tag(node, self.source)
    }

    pub(super) fn attribute_span(&self, attribute: Attribute<'_, '_>) -> Span {
        Span::new(self.source, attribute.range_value())
    }

    /// First child element with this tag, as in ROS. Further child elements with this tag give a warning.
    ///
    /// - `owner`: name of the enclosing element, for the warning
    pub(super) fn single<'a>(&mut self, node: XmlNode<'a>, tag: &str, owner: &str) -> Option<XmlNode<'a>> {
        let mut found = node.children().filter(|inner| inner.is_element() && inner.tag_name().name() == tag);
        let first = found.next()?;
        self.known_attributes(first);
        if let Some(second) = found.next() {
            let span = self.span(second);
            let owner = format!("<{tag}> of {owner}");
            self.notes.remark(notes::DUPLICATE_ELEMENT, span, owner);
        }
        Some(first)
    }

    pub(super) fn known_children(&mut self, node: XmlNode<'_>, known: &[&str]) {
        for inner in node.children().filter(Node::is_element) {
            if !known.contains(&inner.tag_name().name()) {
                self.skip(inner, known);
            }
        }
    }

    pub(super) fn name(&mut self, node: XmlNode<'_>, key: &str) -> Option<Name> {
        let attribute = node.attribute_node(key)?;
        let (text, span) = (attribute.value(), self.attribute_span(attribute));
        if text.is_empty() || text.chars().any(char::is_control) {
            self.report.error(
                span,
                "unusable-name",
                format!("`{key}` must be one line of text, not {text:?}"),
            );
            return None;
        }
        Some(At::new(text.to_owned(), span))
    }

    pub(super) fn required_name(&mut self, node: XmlNode<'_>, key: &str) -> Option<Name> {
        if !node.has_attribute(key) {
            self.missing(node, key);
        }
        self.name(node, key)
    }

    pub(super) fn missing(&mut self, node: XmlNode<'_>, key: &str) {
        let message = format!("<{}> has no `{key}`", node.tag_name().name());
        self.report.error(self.span(node), "missing-attribute", message);
    }

    pub(super) fn required_number(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<f64>> {
        if !node.has_attribute(key) {
            self.missing(node, key);
        }
        self.number(node, key)
    }

    pub(super) fn number(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<f64>> {
        self.numbers::<1>(node, key).map(|found| At::new(found.value[0], found.span))
    }

    pub(super) fn vector(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<[f64; 3]>> {
        self.numbers::<3>(node, key)
    }

    pub(super) fn numbers<const N: usize>(&mut self, node: XmlNode<'_>, key: &str) -> Option<At<[f64; N]>> {
        let attribute = of_any_tool(node, key)?;
        let span = self.attribute_span(attribute);
        let numbers: Vec<Option<f64>> =
            attribute.value().split_whitespace().map(|word| word.parse().ok()).collect();
        let mut result = [0.0; N];
        let readable = numbers.len() == N && numbers.iter().all(Option::is_some);
        for (into, number) in result.iter_mut().zip(numbers.into_iter().flatten()) {
            *into = number + 0.0; // −0 becomes 0
        }
        if !readable {
            let wanted = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
            let found: String = attribute.value().chars().take(60).collect();
            self.report.error(span, "not-a-number", format!("`{key}` must be {wanted}, not {found:?}"));
            let example = ["0.5"; N].join(" ");
            self.report.help(format!(
                "for example `{key}=\"{example}\"`: numbers with decimal points, separated by spaces"
            ));
            return None;
        }
        if result.iter().any(|number| !number.is_finite()) {
            let message = format!("`{key}` must be finite, not {}", attribute.value());
            self.report.error(span, "number-not-finite", message);
            return None;
        }
        if result.iter().any(|number| number.abs() > LARGEST_NUMBER) {
            let message = too_large(&format!("`{key}`"));
            self.report.error(span, "number-too-large", message);
            return None;
        }
        Some(At::new(result, span))
    }
}
