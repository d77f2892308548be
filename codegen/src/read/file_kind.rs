//! Recognition of files that are not descriptions by their first bytes.

use std::path::Path;

/// Message about a file that is not a description, and help text.
pub(super) type Foreign = (String, &'static str);

const MESH: &str = "a mesh has no joints. Give the URDF that uses it, or describe the robot in TOML";
const IMAGE: &str = "give a TOML, URDF or MJCF file";
const CONVERT: &str = "convert it to URDF first, or describe the robot in TOML";
const UTF_8: &str = "descriptions are UTF-8 text: save the file as UTF-8";

/// First bytes of binary files, kind of the file, and remedy.
const BEGINNINGS: [(&[u8], &str, &str); 10] = [
    (b"\x89PNG", "an image (PNG)", IMAGE),
    (b"\xff\xd8\xff", "an image (JPEG)", IMAGE),
    (b"GIF8", "an image (GIF)", IMAGE),
    (b"%PDF", "a PDF", IMAGE),
    (b"PK\x03\x04", "a ZIP archive", "unpack the archive, and give its TOML or URDF file"),
    (b"\x1f\x8b", "a gzip archive", "unpack the archive, and give its TOML or URDF file"),
    (b"glTF", "a mesh (glTF)", MESH),
    (b"\x7fELF", "a program", IMAGE),
    (b"\xff\xfe", "UTF-16 text", UTF_8),
    (b"\xfe\xff", "UTF-16 text", UTF_8),
];

/// Root tags of XML files that often accompany a URDF, kind of the file, and remedy.
const ROOTS: [(&str, &str, &str); 3] = [
    ("sdf", "a robot or world in SDF", CONVERT),
    ("COLLADA", "a mesh (COLLADA)", MESH),
    ("launch", "a launch file of ROS", "give the URDF that it loads"),
];

/// Recognizes files that cannot be descriptions. Returns message and help text; `None` for other files.
pub(super) fn foreign(name: &str, bytes: &[u8]) -> Option<Foreign> {
    let found = |what: &str, help: &'static str| {
        Some((format!("{name} is {what}, but gelenk reads robots in TOML, URDF and MJCF"), help))
    };
    let beginning = BEGINNINGS.iter().find(|(first, ..)| bytes.starts_with(first));
    if let Some((_, what, help)) = beginning {
        return found(what, help);
    }
    let is_text_stl = bytes.starts_with(b"solid ") && holds(bytes, b"facet normal");
    if is_binary_stl(bytes) || is_text_stl {
        return found("a mesh (STL)", MESH);
    }
    if bytes.contains(&0) {
        return found("binary data with zero bytes", IMAGE);
    }
    let text = std::str::from_utf8(bytes).ok()?;
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if text.is_empty() {
        let help = "a robot needs at least one [[joints]] entry, or <joint> in a URDF";
        return Some((format!("{name} is empty"), help));
    }
    let root = root(text);
    if let Some((_, what, help)) = ROOTS.iter().find(|(tag, ..)| Some(*tag) == root) {
        return found(what, help);
    }
    if text.starts_with('{') {
        return found("JSON", "describe the robot in TOML, or give a URDF");
    }
    let extension = Path::new(name).extension().and_then(|end| end.to_str());
    match (extension, text.starts_with('<')) {
        (Some("toml"), true) => {
            found("XML, although its name ends with `.toml`", "rename the file to end with `.urdf`")
        }
        (Some("urdf" | "xml"), false) => found(
            "not XML, although its name ends with `.urdf` or `.xml`",
            "if the file is TOML, rename it to end with `.toml`",
        ),
        (Some("yaml" | "yml"), _) => found("YAML", "describe the robot in TOML, or give a URDF"),
        (Some("obj" | "dae" | "step" | "stp"), _) => found("a mesh or a drawing", MESH),
        _ => None,
    }
}

/// Whether an XML text is an MJCF.
pub(super) fn is_mjcf(text: &str) -> bool {
    root(text.trim_start_matches('\u{feff}').trim_start()) == Some("mujoco")
}

/// Whether the expected bytes occur near the beginning of a file.
fn holds(bytes: &[u8], expected: &[u8]) -> bool {
    let near = &bytes[..bytes.len().min(1000)];
    near.windows(expected.len()).any(|part| part == expected)
}

/// Whether the file has the structure of a binary STL: 80 arbitrary bytes, the number of triangles, and 50
/// bytes for each triangle.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| count.try_into().ok());
    let Some(count) = count.map(u32::from_le_bytes) else {
        return false;
    };
    count > 0 && bytes.len() as u64 == 84 + 50 * u64::from(count)
}

/// Name of the first tag of an XML text.
fn root(text: &str) -> Option<&str> {
    let mut rest = text;
    loop {
        rest = rest.trim_start().strip_prefix('<')?;
        let skipped = match rest {
            _ if rest.starts_with("!--") => "-->",
            _ if rest.starts_with(['?', '!']) => ">",
            _ => {
                return rest.split(|c: char| c.is_whitespace() || ">/".contains(c)).next();
            }
        };
        rest = rest.split_once(skipped)?.1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn descriptions_are_not_foreign() {
        for (name, text) in [
            ("robot.toml", "name = \"a\"\n"),
            ("robot", "[[joints]]\n"),
            ("robot.urdf", "\u{feff}<?xml version=\"1.0\"?><!-- <sdf> --><robot name=\"a\"/>"),
            ("robot.urdf", "<robot"),
            ("solid.toml", "solid = 1\n"),
            ("arm.xml", "<mujoco/>"),
        ] {
            assert_eq!(foreign(name, text.as_bytes()), None, "{name} {text}");
        }
    }

    #[test]
    fn other_files_are_named() {
        let mut stl = vec![b'x'; 84 + 100];
        stl[80..84].copy_from_slice(&2_u32.to_le_bytes());
        for (name, bytes, what) in [
            ("a.png", &b"\x89PNG\r\n"[..], "an image (PNG)"),
            ("a.stl", &stl, "a mesh (STL)"),
            ("a.stl", b"solid cube\nfacet normal 0 0 1", "a mesh (STL)"),
            ("a.toml", b"a = 1\0", "binary data"),
            ("a.toml", b"\xff\xfea\0", "UTF-16"),
            ("a.sdf", b"<?xml version=\"1.0\"?>\n<!-- a -->\n<sdf version=\"1.7\">", "SDF"),
            ("a.json", b" {\"a\": 1}", "JSON"),
            ("a.yaml", b"a:\n  b", "YAML"),
            ("a.toml", b"<robot>", "XML, although its name"),
            ("a.urdf", b"name = 1", "not XML"),
            ("a.toml", b" \n", "empty"),
        ] {
            let (message, _) = foreign(name, bytes).unwrap_or_default();
            assert!(message.contains(what), "{name}: {message:?} instead of {what}");
        }
    }
}
