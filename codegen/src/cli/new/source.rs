//! Source of the crates that a new project depends on.

use std::fs;
use std::path::{Path, PathBuf};

use super::super::arguments::New;
use super::super::failure::Failure;
use crate::wording::toml_text;

/// Source of gelenk's crates: a checkout, a repository or a registry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Source {
    /// Folder of a checkout of gelenk.
    Path(PathBuf),
    /// URL of a Git repository of gelenk.
    Git(String),
    /// Version of gelenk in a registry.
    Version(String),
}

pub(super) fn source(arguments: &New) -> Result<Source, Failure> {
    if let Some(url) = &arguments.git {
        return git(url);
    }
    if let Some(version) = &arguments.version {
        return registry(version);
    }
    let built = Path::new(env!("CARGO_MANIFEST_DIR"));
    let Some(folder) = arguments.checkout.as_deref().or(checkout_of(built)) else {
        return Ok(Source::Version(env!("CARGO_PKG_VERSION").to_owned()));
    };
    let is_checkout =
        ["codegen", "runtime"].iter().all(|part| folder.join(part).join("Cargo.toml").is_file());
    if !is_checkout {
        return Err(Failure::Problem(format!(
            "there is no checkout of gelenk at {}\n  = help: give the source of its crates with --checkout \
             FOLDER, --git URL or --version VERSION",
            folder.display()
        )));
    }
    let folder = fs::canonicalize(folder)?;
    if folder.to_str().is_none() {
        return Err(Failure::Problem(format!(
            "the path {} has characters that a manifest cannot contain\n  = help: move the checkout to a \
             folder whose path is valid Unicode",
            folder.display()
        )));
    }
    Ok(Source::Path(folder))
}

/// Returns the checkout from which this program was built. It may have moved since. Returns `None` if the
/// package came from a registry, because Cargo then unpacks it to a folder with its name and version.
fn checkout_of(package: &Path) -> Option<&Path> {
    let unpacked = concat!(env!("CARGO_PKG_NAME"), "-", env!("CARGO_PKG_VERSION"));
    let folder = package.parent()?;
    (!package.ends_with(unpacked)).then_some(folder)
}

/// Checks the address of a Git repository. Cargo accepts addresses with a scheme, but not the short form
/// `git@host:path`.
fn git(url: &str) -> Result<Source, Failure> {
    let is_whole = url.split_once("://").is_some_and(|(scheme, rest)| !scheme.is_empty() && !rest.is_empty());
    if is_whole && !url.contains(char::is_whitespace) {
        return Ok(Source::Git(url.to_owned()));
    }
    let ssh = url
        .split_once(':')
        .map_or_else(|| "ssh://git@HOST/PATH".to_owned(), |(host, path)| format!("ssh://{host}/{path}"));
    Err(Failure::Usage(format!(
        "`--git {url}` is not an address that Cargo accepts\n  = help: give the whole address, for example \
         https://HOST/PATH, {ssh} or file:///PATH"
    )))
}

/// Checks a version of the registry. Cargo reads one to three numbers with an optional suffix.
fn registry(version: &str) -> Result<Source, Failure> {
    let numbers = version.trim_start_matches(['^', '=', '~']);
    let core = numbers.split(['-', '+']).next().unwrap_or_default();
    let parts: Vec<&str> = core.split('.').collect();
    let is_number = |part: &&str| part.parse::<u64>().is_ok();
    if parts.len() <= 3 && parts.iter().all(is_number) {
        return Ok(Source::Version(version.to_owned()));
    }
    Err(Failure::Usage(format!(
        "`--version {version}` is not a version\n  = help: give one to three numbers, for example `--version 0.1`"
    )))
}

impl Source {
    /// The Python package as a line of `requirements.txt`.
    pub(super) fn requirement(&self) -> Result<String, Failure> {
        match self {
            Self::Path(folder) => {
                let package = folder.join("codegen/python");
                match package.join("pyproject.toml").is_file() {
                    true => Ok(package.to_string_lossy().into_owned()),
                    false => Err(Failure::Problem(format!(
                        "there is no Python package at {}\n  = help: give another checkout with --checkout FOLDER",
                        package.display()
                    ))),
                }
            }
            Self::Git(url) => Ok(format!("gelenk @ git+{url}#subdirectory=codegen/python")),
            Self::Version(version) => Ok(format!("gelenk=={}", version.trim_start_matches(['^', '=', '~']))),
        }
    }

    /// The key in `Cargo.toml` for a dependency on a crate in the folder `part`.
    pub(super) fn key(&self, part: &str) -> String {
        match self {
            Self::Path(folder) => format!("path = {}", toml_text(&folder.join(part).to_string_lossy())),
            Self::Git(url) => format!("git = {}", toml_text(url)),
            Self::Version(version) => format!("version = {}", toml_text(version)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_those_that_cargo_takes() {
        for good in ["https://example.org/gelenk.git", "ssh://git@host/a", "file:///srv/gelenk"] {
            assert!(git(good).is_ok(), "{good}");
        }
        for bad in ["", "x", "git@host:a/b.git", "../gelenk", "https://a b", "://x"] {
            assert!(git(bad).is_err(), "{bad}");
        }
        let Err(Failure::Usage(message)) = git("git@host:a/b.git") else {
            panic!("Cargo takes none of this form");
        };
        assert!(message.contains("ssh://git@host/a/b.git"), "{message}");
        for good in ["1", "0.1", "=0.1.2", "^1.2.3", "0.1.0-alpha.1"] {
            assert!(registry(good).is_ok(), "{good}");
        }
        for bad in ["", "banana", "1.", "1.2.3.4", "-1", "v1"] {
            assert!(registry(bad).is_err(), "{bad}");
        }
    }

    /// A package of a registry lies next to other packages, without a checkout.
    #[test]
    fn a_program_from_a_registry_has_no_checkout() {
        let registry = Path::new("/home/a/.cargo/registry/src/index");
        let unpacked = format!("gelenk-codegen-{}", env!("CARGO_PKG_VERSION"));
        assert_eq!(checkout_of(&registry.join(unpacked)), None);
        let checkout = Path::new("/home/a/gelenk");
        assert_eq!(checkout_of(&checkout.join("codegen")), Some(checkout));
    }

    #[test]
    fn any_address_stays_one_text() {
        assert_eq!(toml_text("C:\\a \"b\"\n"), r#""C:\\a \"b\"\u000A""#);
    }
}
