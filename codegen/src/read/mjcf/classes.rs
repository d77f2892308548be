//! Default classes: attribute values of elements that do not set them.

use super::files::{Element, Files, Given};

/// Tags of actuators, which share one set of defaults.
const ACTUATORS: [&str; 13] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "orientation",
    "pid",
    "plugin",
];

/// A default class, with its attributes for each kind of element.
struct Class<'a> {
    name: &'a str,
    parent: Option<usize>,
    elements: Vec<Element<'a>>,
}

/// All default classes. The first class belongs to the elements without a class.
pub(super) struct Classes<'a>(Vec<Class<'a>>);

impl<'a> Classes<'a> {
    /// Collects the default classes of `<default>` sections.
    pub(super) fn of(sections: &[Element<'a>], files: &'a Files<'a>) -> Self {
        let mut classes = vec![Class { name: "main", parent: None, elements: Vec::new() }];
        let mut stack: Vec<(Element<'a>, Option<usize>)> =
            sections.iter().map(|&section| (section, None)).collect();
        while let Some((section, parent)) = stack.pop() {
            let name = section.node.attribute("class").unwrap_or("main");
            // The outermost class is the main one, whatever its name.
            let known = match parent {
                None => Some(0),
                Some(_) => classes.iter().position(|class| class.name == name),
            };
            let index = known.unwrap_or(classes.len());
            match known {
                None => classes.push(Class { name, parent, elements: Vec::new() }),
                Some(0) if name != "main" => classes[0].name = name,
                Some(_) => {}
            }
            for inner in files.children(section).into_iter().rev() {
                match inner.tag() {
                    "default" => stack.push((inner, Some(index))),
                    _ => classes[index].elements.push(inner),
                }
            }
        }
        Self(classes)
    }

    /// Index of the default class with this name; `None` if the class is unknown.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        match name {
            "main" => Some(0),
            name => self.0.iter().position(|class| class.name == name),
        }
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &'a str> {
        self.0.iter().map(|class| class.name)
    }

    /// Default value of an attribute for elements with this tag, from a class or an enclosing class; `None`
    /// without a default.
    pub(super) fn attribute(&self, class: usize, tag: &str, key: &str) -> Option<Given<'a>> {
        let kind = |tag: &str| if ACTUATORS.contains(&tag) { "general".to_owned() } else { tag.to_owned() };
        let wanted = kind(tag);
        let mut next = Some(class);
        while let Some(class) = next.and_then(|index| self.0.get(index)) {
            let said = class.elements.iter().filter(|element| kind(element.tag()) == wanted);
            // The elements are in reverse order, and the last element in the file counts.
            if let Some(found) = said.filter_map(|element| element.attribute(key)).next() {
                return Some(found);
            }
            next = class.parent;
        }
        None
    }
}
