//! Files of a description, each read from the disk once.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::fetch::Fetch;
use super::options::ReadOptions;
use super::{Loaded, file_kind, from_xml, is_xml, toml_with};
use crate::diagnostic::{Diagnostic, Diagnostics, Report, Span};

/// Largest accepted size of a description's file, in bytes.
const LARGEST: u64 = 256 << 20;

/// A description and the files that it extends, with their contents at the first reading. Later calls of
/// [`load`](Self::load), also with other options, use the same contents.
#[derive(Debug, Clone, PartialEq)]
pub struct DescriptionFiles {
    /// Path and content of each file. The description is the first.
    files: Vec<(PathBuf, Vec<u8>)>,
    description: PathBuf,
}

impl DescriptionFiles {
    /// Creates the files of the description at `path`. Nothing is read yet.
    pub fn of(path: &Path) -> Self {
        Self { files: Vec::new(), description: path.to_owned() }
    }

    /// Path and content of each file that was read: the description, and the files that it extends or includes.
    pub fn contents(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.files.iter().map(|(path, content)| (path.as_path(), content.as_slice()))
    }

    /// Whether the description is XML. The extension of the file name decides. If the extension is unknown, the
    /// content decides.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is not a description.
    pub fn is_xml(&mut self) -> Result<bool, Diagnostics> {
        let path = self.description.clone();
        let (name, text) = self.text(&path)?;
        Ok(is_xml(&name, &text))
    }

    /// Whether the description is an MJCF.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is not a description.
    pub fn is_mjcf(&mut self) -> Result<bool, Diagnostics> {
        let path = self.description.clone();
        let (name, text) = self.text(&path)?;
        Ok(is_xml(&name, &text) && file_kind::is_mjcf(&text))
    }

    /// Interprets the TOML, URDF or MJCF description. The extension of the file name determines the format,
    /// or the content if the extension is unknown.
    ///
    /// # Errors
    /// Returns all problems of the description, or an error if a file cannot be read.
    pub fn load(&mut self, options: &ReadOptions) -> Result<Loaded, Diagnostics> {
        let path = self.description.clone();
        let (name, text) = self.text(&path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut from = FromFolder { files: self, folder };
        let (model, notes) = match is_xml(&name, &text) {
            true => from_xml(&text, &name, options, &mut from),
            false => toml_with(&text, &name, options, &mut from),
        }?;
        let files = self.files.iter().map(|(path, _)| path.clone()).collect();
        Ok(Loaded { model, notes, files })
    }

    fn bytes(&mut self, path: &Path) -> Result<&[u8], Diagnostics> {
        let known = self.files.iter().position(|(other, _)| other == path);
        let index = match known {
            Some(index) => index,
            None => {
                self.files.push((path.to_owned(), read_file(path)?));
                self.files.len() - 1
            }
        };
        Ok(&self.files[index].1)
    }

    /// Reads a file. Returns its name in diagnostics, and its text.
    fn text(&mut self, path: &Path) -> Result<(String, String), Diagnostics> {
        let name = path.display().to_string();
        let bytes = self.bytes(path)?;
        if let Some((message, help)) = file_kind::foreign(&name, bytes) {
            return Err(Diagnostic::error("not-a-description", message).help(help).into());
        }
        let text = String::from_utf8(bytes.to_vec()).or_else(|why| decoded(&name, why))?;
        Ok((name, text))
    }
}

/// Loader of files whose paths are relative to the folder of a description.
struct FromFolder<'f> {
    files: &'f mut DescriptionFiles,
    folder: &'f Path,
}

impl Fetch for FromFolder<'_> {
    fn text(&mut self, path: &str) -> Result<(String, String), Diagnostics> {
        self.files.text(&self.folder.join(path))
    }

    fn bytes(&mut self, path: &str) -> Result<Vec<u8>, Diagnostics> {
        self.files.bytes(&self.folder.join(path)).map(<[u8]>::to_vec)
    }
}

/// Reads a TOML, URDF or MJCF description. The extension of the file name determines the format, or the
/// content if the extension is unknown.
///
/// # Errors
/// Returns all problems of the description, or an error if a file cannot be read.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Loaded, Diagnostics> {
    DescriptionFiles::of(path).load(options)
}

fn read_file(path: &Path) -> Result<Vec<u8>, Diagnostics> {
    let name = path.display().to_string();
    let unreadable = |why: String| {
        let problem = Diagnostic::error("file-unreadable", format!("cannot read {name}: {why}"));
        Diagnostics::from(problem.help("give the path of a readable TOML, URDF or MJCF file"))
    };
    // A pipe without a writer would never end.
    if std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        return Err(unreadable("it is a pipe or a device, not a file".to_owned()));
    }
    let file = std::fs::File::open(path).map_err(|why| unreadable(why.to_string()))?;
    let mut bytes = Vec::new();
    let mut limited = file.take(LARGEST + 1);
    limited.read_to_end(&mut bytes).map_err(|why| unreadable(why.to_string()))?;
    if bytes.len() as u64 > LARGEST {
        return Err(unreadable(format!("it is larger than {} MiB", LARGEST >> 20)));
    }
    Ok(bytes)
}

/// Text of an XML file in Latin-1, which some CAD programs write. Latin-1 has a character for each byte, so
/// different names stay different.
fn decoded(name: &str, why: std::string::FromUtf8Error) -> Result<String, Diagnostics> {
    let start: Vec<u8> = why.as_bytes().iter().take(200).copied().collect();
    let start = String::from_utf8_lossy(&start).to_lowercase();
    let is_latin = start.contains("<?xml")
        && ["iso-8859-1", "windows-1252", "latin1"].iter().any(|known| start.contains(known));
    match is_latin {
        true => Ok(why.as_bytes().iter().map(|&byte| char::from(byte)).collect()),
        false => Err(not_utf8(name, &why)),
    }
}

fn not_utf8(name: &str, why: &std::string::FromUtf8Error) -> Diagnostics {
    let at = why.utf8_error().valid_up_to();
    let mut report = Report::default();
    let source = report.add_source(name, &String::from_utf8_lossy(why.as_bytes()));
    let message = format!("byte {at} of the file is not UTF-8");
    report
        .error(Span::new(source, at..at + 1), "not-utf-8", message)
        .help("descriptions are UTF-8 text: save the file as UTF-8");
    report.finish()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests fail with their files")]
mod tests {
    use std::fs;

    use super::*;

    const ARM: &str = "[[joints]]\nname = \"swing\"\naxis = [0, 1, 0]\n[[bodies]]\nlink = \"swing\"\nmass = 2\ninertia = 1\n";

    #[test]
    fn bases_are_found_from_the_file_that_names_them() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        put("mine/arm.toml", "extends = \"../vendor/arm.toml\"\n");
        put("vendor/arm.toml", "extends = \"parts/arm.toml\"\n");
        put("vendor/parts/arm.toml", ARM);
        // What a path from the first file would find.
        put("mine/parts/arm.toml", &ARM.replace("mass = 2", "mass = 3"));
        let path = folder.path().join("mine/arm.toml");
        let loaded = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(loaded.model.links[1].bodies[0].mass.as_number(), Some(2.0));
        assert_eq!(loaded.files.len(), 3);
        assert!(loaded.files.iter().all(|file| file.is_file()));
    }

    /// A file that changes on the disk between two interpretations does not give two different robots.
    #[test]
    fn each_file_is_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let [first, base] = ["first.toml", "base.toml"].map(|name| folder.path().join(name));
        fs::write(&first, "extends = \"base.toml\"\n").unwrap();
        fs::write(&base, ARM).unwrap();
        let mut files = DescriptionFiles::of(&first);
        let loaded = files.load(&ReadOptions::default()).unwrap();
        assert_eq!(loaded.files, [first.clone(), base.clone()]);
        fs::write(&first, "no description").unwrap();
        fs::remove_file(&base).unwrap();
        assert_eq!(files.load(&ReadOptions::default()).unwrap(), loaded);
        let frictionless = ReadOptions { no_friction: true, ..ReadOptions::default() };
        assert_eq!(files.load(&frictionless).unwrap().files, loaded.files);
        assert_eq!(
            files.contents().next().unwrap(),
            (first.as_path(), b"extends = \"base.toml\"\n".as_slice())
        );
        assert!(read(&first, &ReadOptions::default()).is_err());
    }
}
