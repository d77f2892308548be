//! The published crates as a registry would hand them out: packed by Cargo and unpacked below the target
//! folder.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use serde_json::Value;

use crate::cargo::{aloud, success, target};
use crate::workspace;

/// The crates that a package of a robot depends on, directly or through the others.
const OF_ROBOTS: [&str; 8] = [
    "gelenk-adaptation",
    "gelenk-codegen",
    "gelenk-dynamics",
    "gelenk-files",
    "gelenk-findings",
    "gelenk-formula",
    "gelenk-kernels",
    "gelenk-runtime",
];

/// The unpacked crates, by name.
///
/// # Panics
/// Where a crate cannot be packed: a field is missing, or a dependency has a path and no version.
pub fn published() -> &'static BTreeMap<String, PathBuf> {
    static PACKAGES: OnceLock<BTreeMap<String, PathBuf>> = OnceLock::new();
    PACKAGES.get_or_init(packed)
}

/// Lets the package in a folder find this version of the crates where it asks a registry for them.
///
/// # Panics
/// Where the crates cannot be packed, or the configuration cannot be written.
pub fn use_published(folder: &Path) {
    let mut text = String::from("[patch.crates-io]\n");
    for name in OF_ROBOTS {
        text += &format!("{name} = {{ path = {:?} }}\n", published()[name]);
    }
    fs::create_dir_all(folder.join(".cargo")).expect("a folder");
    fs::write(folder.join(".cargo/config.toml"), text).expect("the configuration");
}

/// The packages of this workspace that may be published, as Cargo describes them.
///
/// # Panics
/// Where Cargo does not describe the workspace.
pub fn manifests() -> Vec<Value> {
    let arguments = ["metadata", "--no-deps", "--format-version", "1"];
    let text = success(&aloud(&workspace(), &arguments));
    let metadata: Value = serde_json::from_str(&text).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages").iter();
    // `publish = false` is an empty list of registries.
    packages.filter(|package| package["publish"].is_null()).cloned().collect()
}

fn packed() -> BTreeMap<String, PathBuf> {
    let folder = target().join("published");
    fs::create_dir_all(&folder).expect("a folder");
    // Another test program may be at it.
    let lock = fs::File::create(folder.join("lock")).expect("a file");
    lock.lock().expect("the lock");
    let manifests = manifests();
    let of = |key: &str| {
        let text = |package: &Value| package[key].as_str().expect("a text").to_owned();
        manifests.iter().map(text).collect::<Vec<String>>()
    };
    let mut arguments = vec!["package", "--quiet", "--no-verify", "--allow-dirty"];
    let (names, versions) = (of("name"), of("version"));
    arguments.extend(names.iter().flat_map(|name| ["--package", name]));
    success(&aloud(&workspace(), &arguments));
    let unpacked = |(name, version): (String, String)| {
        let place = folder.join(&name);
        unpack(&format!("{name}-{version}"), &place);
        (name, place)
    };
    names.into_iter().zip(versions).map(unpacked).collect()
}

/// Unpacks a crate. A file that stays as it is keeps its time, so that Cargo compiles a crate only after a
/// change: in the archive all files have one time.
fn unpack(package: &str, place: &Path) {
    let fresh = tempfile::tempdir().expect("a folder");
    let archive = target().join(format!("package/{package}.crate"));
    let mut tar = Command::new("tar");
    tar.arg("-xzf").arg(archive).arg("-C").arg(fresh.path());
    success(&tar.output().expect("tar starts"));
    mirror(&fresh.path().join(package), place);
}

fn mirror(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    let names = |folder: &Path| {
        let entries = fs::read_dir(folder).expect("a folder");
        let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
        entries.map(name).collect::<Vec<_>>()
    };
    for gone in names(to).iter().filter(|name| !from.join(name).exists()) {
        let gone = to.join(gone);
        let removed = fs::remove_file(&gone).or_else(|_| fs::remove_dir_all(&gone));
        removed.expect("removed");
    }
    for name in names(from) {
        let (from, to) = (from.join(&name), to.join(&name));
        if from.is_dir() {
            mirror(&from, &to);
        } else {
            let text = fs::read(&from).expect("a file");
            // The commit that was packed changes nothing.
            if name != ".cargo_vcs_info.json" && fs::read(&to).ok().as_ref() != Some(&text) {
                fs::write(&to, text).expect("written");
            }
        }
    }
}
