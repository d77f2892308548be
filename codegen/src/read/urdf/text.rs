//! Text of a URDF, changed so that a strict XML parser accepts it.
//!
//! The parsers of ROS are less strict than XML. Published files often have `--` in comments, white space
//! before the declaration, a document type, or undeclared prefixes. These places are overwritten byte by
//! byte, so positions do not change.

use crate::diagnostic::Span;
use roxmltree::{Document, Error, Node};

/// Largest number of undeclared prefixes in a file.
const MOST_PREFIXES: usize = 16;

/// Text with valid XML syntax and the same length.
pub(crate) struct UrdfText(Vec<u8>);

impl UrdfText {
    pub(crate) fn new(text: &str) -> Self {
        let mut result = Self(text.as_bytes().to_vec());
        result.blank_comments();
        result.blank_document_type();
        result.blank_late_declaration();
        result.mend_prefixes();
        result
    }

    pub(crate) fn as_str(&self) -> &str {
        // Only whole characters are overwritten.
        std::str::from_utf8(&self.0).unwrap_or("")
    }

    /// Overwrites comments. The parser reports a comment without an end.
    fn blank_comments(&mut self) {
        let mut at = 0;
        while let Some(start) = self.find(b"<!", at) {
            let (begin, end): (&[u8], &[u8]) = match self.0[start..].starts_with(b"<![CDATA[") {
                true => (b"<![CDATA[", b"]]>"),
                false => (b"<!--", b"-->"),
            };
            if !self.0[start..].starts_with(begin) {
                at = start + 2;
                continue;
            }
            let Some(last) = self.find(end, start + begin.len()) else {
                return;
            };
            at = last + end.len();
            if begin == b"<!--" {
                self.blank(start, at);
            }
        }
    }

    /// Overwrites `<!DOCTYPE robot>` with the content of its brackets.
    fn blank_document_type(&mut self) {
        let Some(start) = self.find(b"<!DOCTYPE", 0) else {
            return;
        };
        let mut depth = 0_usize;
        for at in start..self.0.len() {
            match self.0[at] {
                b'[' => depth += 1,
                b']' => depth = depth.saturating_sub(1),
                b'>' if depth == 0 => return self.blank(start, at + 1),
                _ => {}
            }
        }
    }

    /// Overwrites a `<?xml … ?>` after white space.
    fn blank_late_declaration(&mut self) {
        let first = self.0.iter().position(|byte| !byte.is_ascii_whitespace());
        let Some(start) = first.filter(|&first| first > 0) else {
            return;
        };
        let is_declaration = self.0[start..].starts_with(b"<?xml ");
        if let Some(end) = self.find(b"?>", start).filter(|_| is_declaration) {
            self.blank(start, end + 2);
        }
    }

    /// Replaces `<sensor:camera>` by `<sensor.camera>` if the prefix `sensor` is undeclared.
    fn mend_prefixes(&mut self) {
        for _ in 0..MOST_PREFIXES {
            match Document::parse(self.as_str()) {
                Err(Error::UnknownNamespace(prefix, _)) => self.mend(prefix.as_bytes()),
                _ => return,
            }
        }
    }

    fn mend(&mut self, prefix: &[u8]) {
        let mut at = 0;
        while let Some(start) = self.find(prefix, at) {
            at = start + prefix.len();
            let before = start.checked_sub(1).map_or(b' ', |before| self.0[before]);
            let is_tag = matches!(before, b'<' | b'/');
            let is_attribute = before.is_ascii_whitespace() && self.is_attribute_name(at);
            if self.0.get(at) == Some(&b':') && (is_tag || is_attribute) {
                self.0[at] = b'.';
            }
        }
    }

    /// Whether a name and an equals sign follow at this place.
    fn is_attribute_name(&self, at: usize) -> bool {
        let rest = self.0.get(at..).unwrap_or_default();
        let is_name = |byte: &u8| byte.is_ascii_alphanumeric() || b":_-.".contains(byte);
        let rest = rest.iter().skip_while(|byte| is_name(byte));
        rest.into_iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'=')
    }

    fn find(&self, what: &[u8], from: usize) -> Option<usize> {
        let rest = self.0.get(from..)?;
        let mut at = 0;
        // The first byte is found fast, also in files of many megabytes.
        while let Some(next) = rest[at..].iter().position(|byte| *byte == what[0]) {
            at += next;
            if rest[at..].starts_with(what) {
                return Some(from + at);
            }
            at += 1;
        }
        None
    }

    fn blank(&mut self, start: usize, end: usize) {
        for byte in &mut self.0[start..end] {
            if !matches!(byte, b'\n' | b'\r') {
                *byte = b' ';
            }
        }
    }
}

/// Place of the opening tag of an element, up to its first line end.
pub(crate) fn opening_tag(node: Node<'_, '_>, source: usize) -> Span {
    let range = node.range();
    let text = node.document().input_text().get(range.clone()).unwrap_or("");
    let length = text.find(['>', '\n']).map_or(text.len(), |at| at + 1);
    Span::new(source, range.start..range.start + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(text: &str) -> String {
        let result = UrdfText::new(text).as_str().to_owned();
        assert_eq!(result.len(), text.len());
        assert!(Document::parse(&result).is_ok(), "{result}");
        result
    }

    #[test]
    fn what_ros_takes_is_taken() {
        assert_eq!(taken("<r><!-- a -- ü --->\n</r>").trim_end_matches("</r>").trim(), "<r>");
        let data = "<r><![CDATA[<!-- a -- b]]></r>";
        assert_eq!(taken(data), data);
        assert_eq!(taken("\n <?xml version=\"1.0\"?><r/>").trim(), "<r/>");
        assert_eq!(taken("<!DOCTYPE r [<!ENTITY a \"b\">]><r/>").trim(), "<r/>");
        let prefixes = "<r><s:camera a:b = \"s:c a:d\"><x/></s:camera></r>";
        assert_eq!(taken(prefixes), "<r><s.camera a.b = \"s:c a:d\"><x/></s.camera></r>");
        let declared = "<r xmlns:s=\"n\"><s:camera/></r>";
        assert_eq!(taken(declared), declared);
    }

    #[test]
    fn what_is_broken_stays() {
        for broken in ["<r><!-- a", "<r>", "<!DOCTYPE r", "", "<r a:b:c='1'/>"] {
            assert!(Document::parse(UrdfText::new(broken).as_str()).is_err(), "{broken}");
        }
    }
}
