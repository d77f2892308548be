//! Settings of the MJCF elements `<compiler>` and `<option>`, which affect all other elements.

use std::path::{Path, PathBuf};

use super::Reader;
use super::files::{Element, plain_path};

/// Settings of the MJCF element `<compiler>`. The defaults are MuJoCo's.
pub(super) struct Compiler {
    /// Size of the unit of angles in the file, in rad.
    pub(super) angle: f64,
    /// Axes of the three angles of the attribute `euler`. Capital letters mean axes of the parent frame.
    pub(super) eulerseq: [char; 3],
    /// Whether a range is a limit if no attribute says otherwise.
    pub(super) autolimits: bool,
    /// Cases in which the inertia of a body is computed from its geoms.
    pub(super) inertia_from_geoms: FromGeoms,
    /// Lowest and highest group number of geoms with mass.
    pub(super) groups: [f64; 2],
    /// Smallest mass of a body in kg (`boundmass`).
    pub(super) least_mass: f64,
    /// Smallest principal moment of a body in kg m² (`boundinertia`).
    pub(super) least_inertia: f64,
    /// Whether moments that violate the triangle inequality are replaced by their mean (`balanceinertia`).
    pub(super) balances: bool,
    /// Sum of all masses in kg, to which the masses are scaled (`settotalmass`); `None` for unscaled masses.
    pub(super) total_mass: Option<f64>,
    /// Folder of the model, to which paths of meshes are relative.
    pub(super) folder: PathBuf,
    /// Folder of the meshes, relative to `folder` (`meshdir`).
    pub(super) mesh_folder: PathBuf,
    /// Whether folders are removed from file names (`strippath`).
    pub(super) strips_paths: bool,
}

/// Cases in which the inertia of a body is computed from its geoms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FromGeoms {
    Never,
    WithoutInertial,
    Always,
}

impl Default for Compiler {
    fn default() -> Self {
        Self {
            angle: std::f64::consts::PI / 180.0,
            eulerseq: ['x', 'y', 'z'],
            autolimits: true,
            inertia_from_geoms: FromGeoms::WithoutInertial,
            groups: [0.0, 5.0],
            least_mass: 0.0,
            least_inertia: 0.0,
            balances: false,
            total_mass: None,
            folder: PathBuf::new(),
            mesh_folder: PathBuf::new(),
            strips_paths: false,
        }
    }
}

impl Compiler {
    /// Path of a mesh relative to the folder of the first description.
    pub(super) fn mesh_path(&self, file: &str) -> String {
        let name =
            Path::new(file).file_name().filter(|_| self.strips_paths).map_or(Path::new(file), Path::new);
        self.folder.join(&self.mesh_folder).join(name).to_string_lossy().into_owned()
    }
}

/// Flags that disable parts of the model: forces of springs, dampers and friction, couplings, inputs.
const DISABLING: [&str; 6] = ["passive", "spring", "damper", "frictionloss", "equality", "actuation"];

impl<'a> Reader<'_, 'a> {
    /// Reads the settings of a `<compiler>` element.
    pub(super) fn compiler(&mut self, element: Element<'a>) {
        if let Some(unit) = self.word(element, "angle", &["degree", "radian"]) {
            self.compiler.angle = if unit == "degree" { std::f64::consts::PI / 180.0 } else { 1.0 };
        }
        if let Some(given) = element.attribute("eulerseq") {
            let letters: Vec<char> = given.text.chars().collect();
            match <[char; 3]>::try_from(letters) {
                Ok(letters) if letters.iter().all(|letter| "xyzXYZ".contains(*letter)) => {
                    self.compiler.eulerseq = letters;
                }
                _ => {
                    let message = format!(
                        "`eulerseq` must be three of the letters x, y, z, X, Y, Z, not {:?}",
                        given.text
                    );
                    self.report.error(given.span, "not-a-word", message);
                }
            }
        }
        const SWITCH: [&str; 2] = ["false", "true"];
        if let Some(word) = self.word(element, "autolimits", &SWITCH) {
            self.compiler.autolimits = word == "true";
        }
        if let Some(word) = self.word(element, "inertiafromgeom", &["false", "true", "auto"]) {
            self.compiler.inertia_from_geoms = match word {
                "false" => FromGeoms::Never,
                "true" => FromGeoms::Always,
                _ => FromGeoms::WithoutInertial,
            };
        }
        for key in ["assetdir", "meshdir"] {
            if let Some(given) = element.attribute(key) {
                self.compiler.mesh_folder = plain_path(given.text).into();
            }
        }
        if let Some(word) = self.word(element, "strippath", &SWITCH) {
            self.compiler.strips_paths = word == "true";
        }
        if let Some(word) = self.word(element, "balanceinertia", &SWITCH) {
            self.compiler.balances = word == "true";
        }
        if let Some(groups) = self.vector(element.attribute("inertiagrouprange"), "inertiagrouprange") {
            self.compiler.groups = groups.value;
        }
        if let Some(least) = self.number(element.attribute("boundmass"), "boundmass") {
            self.compiler.least_mass = least.value;
        }
        if let Some(least) = self.number(element.attribute("boundinertia"), "boundinertia") {
            self.compiler.least_inertia = least.value;
        }
        if let Some(total) = self.number(element.attribute("settotalmass"), "settotalmass") {
            self.compiler.total_mass = (total.value > 0.0).then_some(total.value);
        }
        if let Some(global) = element.attribute("coordinate").filter(|given| given.text == "global") {
            self.report.error(
                global.span,
                "global-coordinates",
                "MuJoCo no longer supports global coordinates",
            );
            self.report.help(
                "load the file in MuJoCo 2.3.3 or older and save it. MuJoCo then converts the coordinates",
            );
        }
    }

    /// Reads gravity from `<option>`. Adds remarks about other global forces and about flags.
    pub(super) fn option(&mut self, element: Element<'a>) {
        if let Some(gravity) = self.vector(element.attribute("gravity"), "gravity") {
            self.gravity = gravity.value;
        }
        for key in ["density", "viscosity"] {
            if let Some(given) = element.attribute(key)
                && given.text.trim().parse::<f64>() != Ok(0.0)
            {
                self.notes.remark(super::notes::MEDIUM, given.span, format!("`{key}`"));
            }
        }
        for flag in self.files.children(element).into_iter().filter(|inner| inner.tag() == "flag") {
            if flag.node.attribute("gravity") == Some("disable") {
                self.gravity = [0.0; 3];
            }
            for key in DISABLING {
                if let Some(given) = flag.attribute(key).filter(|given| given.text == "disable") {
                    self.notes.remark(super::notes::FLAG, given.span, format!("`{key}`"));
                }
            }
        }
    }

    /// Reads an attribute whose value is one of several words.
    pub(super) fn word(
        &mut self,
        element: Element<'a>,
        key: &str,
        known: &[&'static str],
    ) -> Option<&'static str> {
        let given = element.attribute(key)?;
        self.one_of(given, key, known)
    }
}
