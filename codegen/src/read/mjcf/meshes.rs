//! Meshes of `<asset>`: their files, and their integrals for geoms with mass.

use super::files::{Element, Given};
use super::mesh::{Filling, MeshIntegrals, convex_hull, integrals, triangles};
use super::{Placed, Reader, plain_path};
use crate::model::pose::rotate_numbers;
use crate::numeric::length;

/// Values of the attribute `inertia` of a mesh, and the distribution of mass that each means.
const FILLINGS: [(&str, Filling); 4] = [
    ("legacy", Filling::Legacy),
    ("exact", Filling::Exact),
    (CONVEX, Filling::Exact),
    ("shell", Filling::Shell),
];
/// Value of the attribute `inertia` for the volume inside the convex hull of a mesh.
const CONVEX: &str = "convex";

impl<'a> Reader<'_, 'a> {
    /// Reads the models and meshes of an `<asset>`. A mesh without a name gets the name of its file.
    pub(super) fn assets(&mut self, section: Element<'a>) {
        let assets = self.files.children(section);
        self.models.extend(assets.iter().filter(|asset| asset.tag() == "model"));
        for mesh in assets.into_iter().filter(|asset| asset.tag() == "mesh") {
            let file = mesh.node.attribute("file").map(plain_path).unwrap_or_default();
            let stem = std::path::Path::new(&file).file_stem().and_then(|stem| stem.to_str());
            if let Some(name) = mesh.node.attribute("name").or(stem) {
                self.meshes.assets.insert(name.to_owned(), mesh);
            }
        }
    }

    /// Integrals of a mesh, or the reason why it has no integrals.
    pub(super) fn mesh(&mut self, name: &str) -> Result<MeshIntegrals, String> {
        if let Some(known) = self.meshes.known.get(name) {
            return known.clone();
        }
        let found = match self.meshes.assets.get(name).copied() {
            Some(asset) => self.read_mesh(asset),
            None => Err(format!("`{name}`, which <asset> does not have")),
        };
        self.meshes.known.insert(name.to_owned(), found.clone());
        found
    }

    fn read_mesh(&mut self, asset: Element<'a>) -> Result<MeshIntegrals, String> {
        let class = self.class(asset, "class", 0);
        let placed = Placed::outside(asset, class);
        let find = |reader: &Self, key: &str| -> Option<Given<'a>> { reader.find(&placed, key) };
        let own = asset.node.attribute("name").unwrap_or("a mesh");
        let file =
            asset.node.attribute("file").map(plain_path).ok_or(format!("`{own}`, which has no file"))?;
        let lower = file.to_lowercase();
        let is_obj = lower.ends_with(".obj");
        if !is_obj && !lower.ends_with(".stl") {
            return Err(format!("`{file}`, which is neither STL nor OBJ"));
        }
        let inertia = find(self, "inertia");
        let word = match inertia {
            Some(given) => self.one_of(given, "inertia", &FILLINGS.map(|(word, _)| word)),
            None => None,
        };
        let [first, ..] = FILLINGS;
        let (word, filling) = FILLINGS.into_iter().find(|(known, _)| Some(*known) == word).unwrap_or(first);
        if word == CONVEX && find(self, "maxhullvert").is_some() {
            return Err(format!("`{file}`, whose convex hull has a limited number of vertices"));
        }
        let [position, scale] = [("refpos", 0.0), ("scale", 1.0)].map(|(key, otherwise)| {
            let given = find(self, key);
            self.vector::<3>(given, key).map_or([otherwise; 3], |vector| vector.value)
        });
        let turned = self.vector::<4>(find(self, "refquat"), "refquat").map(|quaternion| quaternion.value);
        let turned = turned.filter(|quaternion| length(*quaternion) > 0.0);
        let back = turned.map(|[w, x, y, z]| {
            let size = length([w, x, y, z]);
            self.angles.quaternion([w / size, -x / size, -y / size, -z / size])
        });
        let bytes = self.meshes.load.bytes(&self.compiler.mesh_path(&file));
        let bytes = bytes.map_err(|_| format!("`{file}`, which cannot be read"))?;
        let wrong = |why: &str| format!("`{file}`: {why}");
        let mut triangles = triangles(&bytes, is_obj).map_err(wrong)?;
        if word == CONVEX {
            triangles = convex_hull(&triangles).map_err(wrong)?;
        }
        let is_mirrored = scale.iter().product::<f64>() < 0.0;
        for triangle in &mut triangles {
            for corner in triangle.iter_mut() {
                let moved = std::array::from_fn(|k| corner[k] - position[k]);
                let moved = back.as_ref().map_or(moved, |back| rotate_numbers(back, &moved));
                *corner = std::array::from_fn(|k| scale[k] * moved[k]);
            }
            if is_mirrored {
                triangle.swap(1, 2);
            }
        }
        integrals(&triangles, filling).map_err(wrong)
    }
}
