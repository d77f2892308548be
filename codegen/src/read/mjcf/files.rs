//! Files of an MJCF: the model and its included files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use roxmltree::{Attribute, Document, Node};

use super::mesh::MeshIntegrals;
use crate::diagnostic::{At, Report, Span};
use crate::read::fetch::Fetch;
use crate::read::urdf::text::{UrdfText, opening_tag};

/// Largest number of files that include each other.
const MOST_FILES: usize = 100;

/// A file of the model, with its path and text.
pub(super) struct Text {
    /// Path of the file, relative to the folder of the first description.
    pub(super) path: PathBuf,
    /// Index of the including file, and the name of this file in its `<include>`; `None` for the model itself.
    included: Option<(usize, String)>,
    source: usize,
    text: UrdfText,
}

impl Text {
    /// Creates the text of a model.
    ///
    /// - `source`: index of the text in the report
    pub(super) fn new(path: &Path, source: usize, text: &str) -> Self {
        Self { path: path.to_owned(), included: None, source, text: UrdfText::new(text) }
    }
}

/// Reads the included files of a model. Their paths are relative to the folder of the model, or otherwise to the folder of
/// the including file. Returns `None` after it has reported an error.
pub(super) fn gather(model: Text, load: &mut dyn Fetch, report: &mut Report) -> Option<Vec<Text>> {
    let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let path = model.path.clone();
    let mut texts = vec![model];
    let mut next = 0;
    while next < texts.len() {
        for file in includes(&texts[next], report)? {
            let name = plain_path(&file.value);
            // As in MuJoCo: first in the folder of the model, then in the folder of the including file.
            let [first, second] = [&path, &texts[next].path].map(|from| folder(from).join(&name));
            let mut read = |path: &Path| load.text(&path.to_string_lossy());
            let (path, found) = match read(&first) {
                Err(wrong) => match read(&second) {
                    Ok(found) => (second, Ok(found)),
                    Err(_) => (first, Err(wrong)),
                },
                found => (first, found),
            };
            if texts.iter().any(|known| known.path == path) || texts.len() >= MOST_FILES {
                let message =
                    format!("`{}` is included twice, or nested deeper than {MOST_FILES} files", file.value);
                report
                    .error(file.span, "included-twice", message)
                    .help("remove the repeated <include>: MuJoCo includes each file once");
                return None;
            }
            match found {
                Ok((name, text)) => {
                    let included = Some((texts[next].source, file.value));
                    let source = report.add_source(&name, &text);
                    texts.push(Text { path, included, source, text: UrdfText::new(&text) });
                }
                Err(wrong) => {
                    for entry in wrong.into_entries() {
                        let here = entry.location().is_none().then_some(file.span);
                        report.push(here, entry);
                    }
                    return None;
                }
            }
        }
        next += 1;
    }
    Some(texts)
}

/// The files that a text includes, with the places of the `<include>` elements.
fn includes(text: &Text, report: &mut Report) -> Option<Vec<At<String>>> {
    let document = match Document::parse(text.text.as_str()) {
        Ok(document) => document,
        Err(wrong) => {
            crate::read::urdf::report_syntax(&wrong, text.text.as_str(), text.source, report);
            return None;
        }
    };
    let includes = document.descendants().filter(|node| node.has_tag_name("include"));
    let file = |node: Node<'_, '_>| {
        let attribute = node.attribute_node("file")?;
        Some(At::new(attribute.value().to_owned(), Span::new(text.source, attribute.range_value())))
    };
    Some(includes.filter_map(file).collect())
}

/// A path with `/` as the separator. Paths from Windows may have backslashes.
pub(super) fn plain_path(path: &str) -> String {
    path.replace('\\', "/")
}

/// Index of the including file, and the name of the included file in its `<include>`; `None` for the model
/// itself.
type Included<'t> = Option<(usize, &'t str)>;

/// Parsed texts of the model and its included files.
pub(super) struct Files<'t> {
    files: Vec<(Included<'t>, usize, Document<'t>)>,
}

/// An XML element, with the index of its file.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) node: Node<'a, 'a>,
    source: usize,
}

impl<'t> Files<'t> {
    /// Parses the texts from [`gather`].
    pub(super) fn parse(texts: &'t [Text]) -> Self {
        let parsed = texts.iter().filter_map(|text| {
            let document = Document::parse(text.text.as_str()).ok()?;
            let included = text.included.as_ref().map(|(by, name)| (*by, name.as_str()));
            Some((included, text.source, document))
        });
        Self { files: parsed.collect() }
    }

    /// Root element of the model; `None` without a file.
    pub(super) fn root(&'t self) -> Option<Element<'t>> {
        self.files
            .first()
            .map(|(_, source, document)| Element { node: document.root_element(), source: *source })
    }

    /// Child elements. An `<include>` is replaced by the elements of the included file.
    pub(super) fn children(&'t self, element: Element<'t>) -> Vec<Element<'t>> {
        let inside = |element: Element<'t>| {
            let nodes = element.node.children().filter(Node::is_element);
            nodes.map(move |node| Element { node, source: element.source })
        };
        let mut result = Vec::new();
        let mut stack: Vec<Element<'t>> = inside(element).collect();
        stack.reverse();
        while let Some(next) = stack.pop() {
            if next.tag() != "include" {
                result.push(next);
                continue;
            }
            let wanted = next.node.attribute("file").map(|file| (next.source, file));
            let found = self.files.iter().skip(1).find(|(included, ..)| *included == wanted);
            if let Some((_, source, document)) = found {
                let root = Element { node: document.root_element(), source: *source };
                let included: Vec<_> = inside(root).collect();
                stack.extend(included.into_iter().rev());
            }
        }
        result
    }
}

impl<'a> Element<'a> {
    pub(super) fn tag(self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn attribute(self, key: &str) -> Option<Given<'a>> {
        let attribute = self.node.attribute_node(key)?;
        Some(Given::of(attribute, self.source))
    }

    /// Names and places of the element's attributes.
    pub(super) fn attributes(self) -> impl Iterator<Item = (&'a str, Span)> {
        let own = self.node.attributes().filter(|attribute| attribute.namespace().is_none());
        own.map(move |attribute| (attribute.name(), Span::new(self.source, attribute.range())))
    }

    /// Place of the element's opening tag.
    pub(super) fn span(self) -> Span {
        opening_tag(self.node, self.source)
    }
}

/// Value of an attribute, with its place in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given<'a> {
    pub(super) text: &'a str,
    pub(super) span: Span,
}

impl<'a> Given<'a> {
    fn of(attribute: Attribute<'a, 'a>, source: usize) -> Self {
        Self { text: attribute.value(), span: Span::new(source, attribute.range_value()) }
    }
}

/// Meshes of a file. Each mesh is read when a geom needs it.
pub(super) struct Meshes<'a, 'l> {
    pub(super) load: &'l mut dyn Fetch,
    pub(super) assets: BTreeMap<String, Element<'a>>,
    pub(super) known: BTreeMap<String, Result<MeshIntegrals, String>>,
}
