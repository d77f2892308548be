//! `qplus`, `qplus_by_q`, `qplus_by_d` of the reference files: `q ⊕ 0.1 v` and its Jacobians by Pinocchio.

use std::path::Path;

use gelenk_kernels::manifold::{difference, integrate, integrate_derivatives};
use serde_json::Value;

use super::random::distance;

/// Largest deviation from Pinocchio, of values of size 1.
const BOUND: f64 = 1e-13;

fn file(name: &str) -> Value {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/reference/mechanisms");
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn numbers<const K: usize>(list: &Value, first: usize) -> [f64; K] {
    core::array::from_fn(|i| list[first + i].as_f64().unwrap())
}

fn block<const K: usize>(matrix: &Value, first: usize) -> [[f64; K]; K] {
    core::array::from_fn(|i| numbers(&matrix[first + i], first))
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

fn check<const J: usize, const N: usize, const NY: usize>(
    widths: &[usize; J],
    sample: &Value,
    first: [usize; 2],
) {
    let [position, velocity] = first;
    let (y, v): ([f64; NY], [f64; N]) = (numbers(&sample["q"], position), numbers(&sample["v"], velocity));
    let d = v.map(|v| 0.1 * v);
    let next = integrate(widths, &y, &d);
    assert!(distance(&next, &numbers::<NY>(&sample["qplus"], position)) <= BOUND, "{next:?}");
    let (by_y, by_d) = integrate_derivatives(widths, &d);
    for (found, name) in [(by_y, "qplus_by_q"), (by_d, "qplus_by_d")] {
        let expected = block::<N>(&sample[name], velocity);
        assert!(distance(found.as_flattened(), expected.as_flattened()) <= BOUND, "{name}: {found:?}");
    }
    // The quotient of two lengths near 1 loses digits of Pinocchio's; that of ours does not.
    assert!(distance(&difference::<J, N, NY>(widths, &y, &next), &d) <= BOUND);
}

#[test]
fn joints_are_those_of_pinocchio() {
    let mut count = 0;
    for name in ["iris_floating", "go2_floating", "solo12_floating", "zoo_1", "zoo_2", "zoo_3", "zoo_4"] {
        let file = file(name);
        for sample in file["samples"].as_array().unwrap() {
            for joint in file["joints"].as_array().unwrap() {
                let first = [index(&joint["idx_q"]), index(&joint["idx_v"])];
                match (joint["type"].as_str().unwrap(), index(&joint["nq"])) {
                    ("FreeFlyer", _) => check::<1, 6, 7>(&[7], sample, first),
                    ("Spherical", _) => check::<1, 3, 4>(&[4], sample, first),
                    (_, 1) => check::<1, 1, 1>(&[1], sample, first),
                    // Pinocchio's planar joint has a cosine and a sine; ours are three joints.
                    _ => continue,
                }
                count += 1;
            }
        }
    }
    assert!(count > 200, "{count}");
}

#[test]
fn whole_robots_are_those_of_pinocchio() {
    for name in ["iris_floating", "go2_floating"] {
        let file = file(name);
        for sample in file["samples"].as_array().unwrap() {
            match name {
                "iris_floating" => check::<5, 10, 11>(&[7, 1, 1, 1, 1], sample, [0, 0]),
                _ => {
                    let widths = [7, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1];
                    check::<13, 18, 19>(&widths, sample, [0, 0]);
                }
            }
        }
    }
}
