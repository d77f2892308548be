//! Triangle meshes: their mass, centre of mass and inertia.

use crate::numeric::{cross, length};

type Point = [f64; 3];
type Triangle = [Point; 3];

/// Distribution of mass over a mesh, with the names in MuJoCo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filling {
    /// Mass in the pyramids from the centre to all triangles, whose absolute volumes are added. The surface
    /// may be open.
    Legacy,
    /// Mass in the volume inside a closed surface.
    Exact,
    /// Mass on the surface alone, without the volume.
    Shell,
}

/// Volume, centre and inertia of a mesh with density 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeshIntegrals {
    /// Volume (m³), or area of a shell (m²).
    pub size: f64,
    pub center: Point,
    /// Inertia about the centre, with the entries xx, xy, xz, yy, yz, zz.
    pub inertia: [f64; 6],
}

/// Smallest size of a mesh for which a centre is computed. This is the bound of MuJoCo.
const LEAST_SIZE: f64 = 1e-15;

/// Volume, centre and inertia of a mesh from pyramids between a point and each triangle (Tonon, Explicit
/// exact formulas for the 3-D tetrahedron inertia tensor, 2004). In the first step the point is the centroid
/// of the surface, in the second step the centre of mass.
///
/// # Errors
/// Returns the reason if the mesh has no volume.
pub(super) fn integrals(triangles: &[Triangle], filling: Filling) -> Result<MeshIntegrals, &'static str> {
    let area: f64 = triangles.iter().map(area).sum();
    if area < LEAST_SIZE {
        return Err("its surface has no area");
    }
    let centroid =
        weighted(triangles.iter().map(|triangle| (area_center(triangle), self::area(triangle) / area)));
    let sizes = |point: Point| triangles.iter().map(move |triangle| size(triangle, point, filling));
    let total: f64 = sizes(centroid).sum();
    if total < LEAST_SIZE {
        return Err("its volume is not positive, because its triangles face inwards or its surface is open");
    }
    let center = match filling {
        Filling::Shell => centroid,
        _ => {
            let parts = triangles.iter().zip(sizes(centroid));
            let pyramid = |(triangle, size): (&Triangle, f64)| {
                let base = area_center(triangle);
                (std::array::from_fn(|k| 0.75 * base[k] + 0.25 * centroid[k]), size / total)
            };
            weighted(parts.map(pyramid))
        }
    };
    let mut products = [0.0; 6];
    let per_size = if filling == Filling::Shell { 1.0 / 12.0 } else { 1.0 / 20.0 };
    for (triangle, size) in triangles.iter().zip(sizes(center)) {
        let [d, e, f] = triangle.map(|corner| minus(corner, center));
        let sum: Point = std::array::from_fn(|k| d[k] + e[k] + f[k]);
        // 2 Σ dᵢdⱼ + the mixed products is Σ dᵢdⱼ + (d + e + f)ᵢ (d + e + f)ⱼ.
        for (entry, [i, j]) in products.iter_mut().zip(PAIRS) {
            *entry += size * per_size * (d[i] * d[j] + e[i] * e[j] + f[i] * f[j] + sum[i] * sum[j]);
        }
    }
    let [xx, xy, xz, yy, yz, zz] = products;
    let inertia = [yy + zz, -xy, -xz, xx + zz, -yz, xx + yy];
    Ok(MeshIntegrals { size: sizes(center).sum(), center, inertia })
}

/// Rows and columns of the inertia entries xx, xy, xz, yy, yz, zz.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

/// Volume of the pyramid between a point and a triangle, or the triangle's area.
fn size(triangle: &Triangle, point: Point, filling: Filling) -> f64 {
    let [d, e, f] = triangle.map(|corner| minus(corner, point));
    let volume = dot(d, cross(&e, &f)) / 6.0;
    match filling {
        Filling::Legacy => volume.abs(),
        Filling::Exact => volume,
        Filling::Shell => area(triangle),
    }
}

fn area([a, b, c]: &Triangle) -> f64 {
    length(cross(&minus(*b, *a), &minus(*c, *a))) / 2.0
}

fn area_center([a, b, c]: &Triangle) -> Point {
    std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
}

fn weighted(points: impl Iterator<Item = (Point, f64)>) -> Point {
    points.fold([0.0; 3], |sum, (point, weight)| std::array::from_fn(|k| sum[k] + weight * point[k]))
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Triangles of an STL file (binary or text) or an OBJ file. Coordinates have single precision, as in MuJoCo.
///
/// # Errors
/// Returns the reason if the file is damaged, has another format, or has no finite triangles.
pub(super) fn triangles(bytes: &[u8], is_obj: bool) -> Result<Vec<Triangle>, &'static str> {
    let found = match is_obj {
        true => obj(&String::from_utf8_lossy(bytes)),
        false => binary_stl(bytes).or_else(|| text_stl(&String::from_utf8_lossy(bytes))),
    };
    let found = found.ok_or("it is damaged, or its format differs from its name")?;
    let is_finite = found.iter().flatten().flatten().all(|x| x.is_finite());
    if is_finite && !found.is_empty() {
        Ok(found)
    } else {
        Err("it has no triangles, or they are not finite")
    }
}

/// Reads a binary STL: 80 bytes of a header, the number of triangles, and 50 bytes for each triangle (normal,
/// corners, two more bytes).
fn binary_stl(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let (head, body) = (bytes.get(80..84)?, bytes.get(84..)?);
    let count = u32::from_le_bytes(head.try_into().ok()?) as usize;
    if body.len() != count.checked_mul(50)? {
        return None;
    }
    let number =
        |bytes: &[u8]| bytes.try_into().map_or(f64::NAN, |bytes| f64::from(f32::from_le_bytes(bytes)));
    let triangle = |row: &[u8]| -> Triangle {
        std::array::from_fn(|corner| {
            std::array::from_fn(|k| number(&row[12 + 12 * corner + 4 * k..16 + 12 * corner + 4 * k]))
        })
    };
    Some(body.chunks_exact(50).map(triangle).collect())
}

/// Reads a text STL: three lines `vertex X Y Z` for each triangle.
fn text_stl(text: &str) -> Option<Vec<Triangle>> {
    let vertices = text.lines().filter_map(|line| line.trim_start().strip_prefix("vertex"));
    let corners: Vec<Point> = vertices.map(point).collect::<Option<_>>()?;
    let (triangles, rest) = corners.as_chunks::<3>();
    rest.is_empty().then(|| triangles.to_vec())
}

/// Reads three numbers in single precision.
fn point(text: &str) -> Option<Point> {
    let numbers = text.split_whitespace().take(3).map(|word| word.parse::<f32>().map(f64::from));
    numbers.collect::<Result<Vec<f64>, _>>().ok()?.try_into().ok()
}

/// Reads an OBJ: lines `v X Y Z`, and lines `f A B C …` with indices of corners. Positive indices count from
/// 1, negative indices count back from the last corner.
fn obj(text: &str) -> Option<Vec<Triangle>> {
    let mut corners: Vec<Point> = Vec::new();
    let mut triangles = Vec::new();
    for line in text.lines().map(str::trim_start) {
        if let Some(numbers) = line.strip_prefix("v ") {
            corners.push(point(numbers)?);
        } else if let Some(face) = line.strip_prefix("f ") {
            let corner = |word: &str| {
                let number: i64 = word.split('/').next()?.parse().ok()?;
                let from = if number < 0 { corners.len() as i64 } else { -1 };
                corners.get(usize::try_from(number + from).ok()?).copied()
            };
            let face: Vec<Point> = face.split_whitespace().map(corner).collect::<Option<_>>()?;
            let fan = face.windows(2).skip(1).map(|edge| [face[0], edge[0], edge[1]]);
            triangles.extend(fan);
        }
    }
    Some(triangles)
}

/// Triangles of the convex hull of the corners, in single precision.
///
/// # Errors
/// Returns the reason if the corners have no convex hull.
pub(super) fn convex_hull(triangles: &[Triangle]) -> Result<Vec<Triangle>, &'static str> {
    let single = |point: &Point| glam::Vec3A::from(point.map(|x| x as f32));
    let points: Vec<_> = triangles.iter().flatten().map(single).collect();
    let hull = quickhull::ConvexTriangleMesh::try_from_points(&points, None).map_err(|_| NO_HULL)?;
    let corners = hull.vertices();
    let corner = |index: u32| corners.get(index as usize).map(|corner| corner.to_array().map(f64::from));
    let triangle = |[a, b, c]: &[u32; 3]| Some([corner(*a)?, corner(*b)?, corner(*c)?]);
    hull.indices().iter().map(triangle).collect::<Option<_>>().ok_or(NO_HULL)
}

const NO_HULL: &str = "it has no convex hull";

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]
mod tests {
    use super::*;

    /// A box of the edges 2, 4 and 6 with a corner at the origin.
    const BOX: &str = "v 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\n\
        f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2/1/1 3/1/1 7/1/1 6/1/1\nf 3 4 8 7\nf -8 -4 -1 -5\n";

    fn near(found: &[f64], expected: &[f64]) {
        assert!(
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + b.abs())),
            "{found:?}"
        );
    }

    #[test]
    fn a_box_has_the_integrals_of_a_box() {
        let triangles = triangles(BOX.as_bytes(), true).unwrap();
        assert_eq!(triangles.len(), 12);
        let hull = convex_hull(&triangles).unwrap();
        let cases = [(&triangles, Filling::Legacy), (&triangles, Filling::Exact), (&hull, Filling::Exact)];
        for (triangles, filling) in cases {
            let found = integrals(triangles, filling).unwrap();
            near(&[found.size], &[48.0]);
            near(&found.center, &[1.0, 2.0, 3.0]);
            near(&found.inertia, &[208.0, 0.0, 0.0, 160.0, 0.0, 80.0]);
        }
        // Six plates: their own inertias and those of their distances.
        let found = integrals(&triangles, Filling::Shell).unwrap();
        near(&[found.size], &[88.0]);
        near(&found.center, &[1.0, 2.0, 3.0]);
        let [a, b, c] = [1.0_f64, 2.0, 3.0];
        let second = |a: f64, b: f64, c: f64| 8.0 * (b * c * a * a + (a * c + a * b) * a * a / 3.0);
        let [x, y, z] = [second(a, b, c), second(b, c, a), second(c, a, b)];
        near(&found.inertia, &[y + z, 0.0, 0.0, x + z, 0.0, x + y]);
    }

    #[test]
    fn formats_hold_the_same_triangles() {
        let of_obj = triangles(BOX.as_bytes(), true).unwrap();
        let mut binary = vec![0; 80];
        binary.extend((of_obj.len() as u32).to_le_bytes());
        let mut text = "solid box\n".to_owned();
        for triangle in &of_obj {
            binary.extend([0; 12]);
            for [x, y, z] in triangle {
                [x, y, z].iter().for_each(|x| binary.extend((**x as f32).to_le_bytes()));
                text.push_str(&format!("vertex {x} {y} {z}\n"));
            }
            binary.extend([0; 2]);
        }
        assert_eq!(triangles(&binary, false).unwrap(), of_obj);
        assert_eq!(triangles(text.as_bytes(), false).unwrap(), of_obj);
        assert!(triangles(&binary[..200], false).is_err());
        assert!(triangles(b"v 0 0 0\nf 1 2 3\n", true).is_err());
    }

    #[test]
    fn surfaces_that_enclose_nothing_are_refused() {
        let mut inwards = triangles(BOX.as_bytes(), true).unwrap();
        inwards.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert!(integrals(&inwards, Filling::Exact).is_err());
        assert!(integrals(&inwards, Filling::Legacy).is_ok());
        assert!(integrals(&[[[0.0; 3]; 3]], Filling::Shell).is_err());
    }
}
