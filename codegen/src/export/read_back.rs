//! Checks an exported text. It is read with the readers of this crate, and its mass matrix and bias forces
//! are compared with those of the model.

use super::format::Format;
use super::numbers::Values;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::model::Model;
use crate::random::Random;
use crate::read::{ReadOptions, from_mjcf, from_urdf};
use crate::verify::mass_and_bias;
use crate::wording::{list, telling};
use gelenk_formula::Formula;

/// Largest relative difference of values of the model and the exported text that count as equal.
const SAME: f64 = 1e-9;
const SEED: u64 = 0x6261_636b;
const STATES: usize = 2;

/// First difference between the exported text and the model, as text; `None` if they are equal.
pub(super) fn difference(model: &Model, format: Format, text: &str) -> Option<String> {
    let again = match read(model, format, text) {
        Ok(again) => again,
        Err(problems) => return Some(format!("it cannot be read again ({})", first(&problems))),
    };
    let place = |name: &str| again.joints().position(|joint| joint.name == name);
    let places: Option<Vec<usize>> = model.joints().map(|joint| place(&joint.name)).collect();
    let Some(places) = places.filter(|places| places.len() == again.coordinates.len()) else {
        let names = |model: &Model| list(model.joints().map(|joint| joint.name.as_str()));
        return Some(format!("its coordinates are {}, not {}", names(&again), names(model)));
    };
    let mut random = Random::new(SEED);
    (0..STATES).find_map(|_| {
        let y = model.joints().map(|joint| joint.seeded_range());
        let y: Vec<f64> = y.map(|[low, high]| random.between(low, high)).collect();
        let v: Vec<f64> = y.iter().map(|_| random.either_side(0.1, 1.0)).collect();
        let by_place = |values: &[f64]| {
            let mut placed = values.to_vec();
            places.iter().zip(values).for_each(|(&place, value)| placed[place] = *value);
            placed
        };
        let own = mass_and_bias(model, &model.positions_by(&y), &v);
        let other = mass_and_bias(&again, &again.positions_by(&by_place(&y)), &by_place(&v));
        differing(model, &places, &own, &other)
    })
}

fn read(model: &Model, format: Format, text: &str) -> Result<Model, Diagnostics> {
    let options = ReadOptions { accept_unphysical: true, exact_sign: true, ..ReadOptions::default() };
    match format {
        Format::Mjcf => {
            let load = &mut |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
            from_mjcf(text, "again.xml", &options, load).map(|(again, _)| again)
        }
        Format::Urdf => {
            let (mut again, _) = from_urdf(text, "again.urdf", &options)?;
            // A URDF has no gravity, which is a separate loss.
            again.gravity = Values::of(model).numbers(&model.gravity).map(Formula::Number);
            Ok(again)
        }
    }
}

fn first(problems: &Diagnostics) -> &str {
    problems.entries().first().map_or("", |problem| &problem.message)
}

/// The largest difference of the mass matrix relative to its diagonal, or of the bias forces if the mass
/// matrix is equal; `None` if both are equal.
fn differing(model: &Model, places: &[usize], own: &[Vec<f64>; 2], other: &[Vec<f64>; 2]) -> Option<String> {
    let (n, joints) = (places.len(), model.joints().map(|joint| joint.name.as_str()).collect::<Vec<_>>());
    let [mass, bias] = own;
    let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let entries = pairs.map(|(i, j)| {
        let (own, other) = (mass[i * n + j], other[0][places[i] * n + places[j]]);
        let size = (mass[i * n + i] * mass[j * n + j]).abs().sqrt();
        ([i, j], own, other, (other - own).abs() / size.max(f64::MIN_POSITIVE))
    });
    let ([i, j], own, found, share) = entries.max_by(|a, b| a.3.total_cmp(&b.3))?;
    if share > SAME {
        let at = list([joints[i], joints[j]].into_iter().take(if i == j { 1 } else { 2 }));
        let [found, own] = telling([found, own], |[found, own]| found != own);
        return Some(format!("M has {found} instead of {own} at {at}"));
    }
    let size = mass.iter().chain(bias).fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
    let forces = (0..n).map(|i| (i, bias[i], other[1][places[i]]));
    let (i, own, found) = forces.max_by(|a, b| (a.2 - a.1).abs().total_cmp(&(b.2 - b.1).abs()))?;
    let text = || {
        let [found, own] = telling([found, own], |[found, own]| found != own);
        format!("the bias force is {found} instead of {own} at `{}`", joints[i])
    };
    ((found - own).abs() > SAME * size).then(text)
}
