//! Columns of poses: a place x, y, z and a quaternion for each joint that has one.

use super::super::error::Result;
use super::super::pose::QuaternionJoint;
use super::families::Targets;
use super::finder::Finder;
use super::options::Named;
use super::pose_words::{Group, PLACE, QUATERNION, angles, groups};
use super::search::Source;
use super::units::Unit;
use super::vocabulary::words;

/// The columns of all poses, in the order of the positions.
#[derive(Debug, Default)]
pub(super) struct PoseColumns {
    pub sources: Vec<Source>,
    pub sentences: Vec<String>,
}

/// Columns that the user has named, for one joint after the other, and their unit.
struct Told {
    columns: Vec<Vec<usize>>,
    unit: Option<Unit>,
}

/// Finds the columns of the poses.
///
/// # Errors
/// Poses without columns or with two sets of them, some letters alone, units that do not fit, and angles in place of
/// quaternions.
pub(super) fn find(finder: &Finder) -> Result<PoseColumns> {
    let mut found = PoseColumns::default();
    let joints = &finder.robot.quaternions;
    let floating = joints.iter().filter(|joint| joint.is_floating).count();
    let places = told(finder, Named::Place, floating, PLACE.len())?;
    let attitudes = told_attitudes(finder, joints.len())?;
    let mut place_of = 0;
    for (index, joint) in joints.iter().enumerate() {
        if joint.is_floating {
            let columns = match &places {
                Some(told) => told.columns[place_of].clone(),
                None => best(finder, joint, PLACE)?,
            };
            place_of += 1;
            let unit = places.as_ref().and_then(|told| told.unit);
            found.add(finder, joint, "place x, y, z", &columns, |column| metres(finder, column, unit))?;
        }
        let columns = match &attitudes {
            Some(told) => told.columns[index].clone(),
            None => best(finder, joint, QUATERNION)?,
        };
        let unit = attitudes.as_ref().and_then(|told| told.unit);
        found.add(finder, joint, "quaternion x, y, z, w", &columns, |column| {
            without_unit(finder, column, unit)
        })?;
    }
    Ok(found)
}

impl PoseColumns {
    fn add(
        &mut self,
        finder: &Finder,
        joint: &QuaternionJoint,
        what: &str,
        columns: &[usize],
        factor: impl Fn(usize) -> Result<f64>,
    ) -> Result<()> {
        for &column in columns {
            self.sources.push(Source { column, factor: factor(column)? });
        }
        let labels: Vec<String> = columns.iter().map(|column| finder.label(*column)).collect();
        self.sentences.push(format!("Columns {} are the {what} of {}.", labels.join(", "), joint.name));
        Ok(())
    }
}

/// Columns by `--columns`, `width` of them for each of `count` joints.
fn told(finder: &Finder, named: Named, count: usize, width: usize) -> Result<Option<Told>> {
    let Some(pattern) = finder.pattern(|n| n == named) else { return Ok(None) };
    let names: Vec<String> = (0..count * width).map(|i| format!("entry {}", i + 1)).collect();
    let chosen = pattern.resolve(finder.headers, finder.sheet.width, &Targets::new(&names, &[]))?;
    let columns = chosen.columns.chunks_exact(width.max(1)).map(<[usize]>::to_vec).collect();
    let unit = chosen.unit();
    if chosen.units.iter().any(|other| *other != unit) {
        return Err(finder.fault("the entries of a place, and those of a quaternion, have one unit".into()));
    }
    Ok(Some(Told { columns, unit }))
}

/// Quaternions by `--columns`, in the order x, y, z, w.
fn told_attitudes(finder: &Finder, count: usize) -> Result<Option<Told>> {
    let last = told(finder, Named::Xyzw, count, QUATERNION.len())?;
    let first = told(finder, Named::Wxyz, count, QUATERNION.len())?;
    match (last, first) {
        (Some(_), Some(_)) => {
            Err(finder
                .fault("--columns names quaternions twice, by `xyzw` and by `wxyz`: one settles it".into()))
        }
        (None, Some(mut told)) => {
            told.columns.iter_mut().for_each(|columns| columns.rotate_left(1));
            Ok(Some(told))
        }
        (told, None) => Ok(told),
    }
}

/// The only group of columns that is nearest to the joint's name.
fn best(finder: &Finder, joint: &QuaternionJoint, letters: &'static [&'static str]) -> Result<Vec<usize>> {
    let name = words(&joint.name);
    // Of several joints each has to be named.
    let farthest = if finder.robot.quaternions.len() > 1 { 0 } else { 2 };
    let mut near: Vec<(u8, Group)> =
        groups(finder.headers, letters).into_iter().map(|group| (group.distance(&name), group)).collect();
    near.retain(|(distance, _)| *distance <= farthest);
    near.sort_by_key(|(distance, group)| (group.complete().is_none(), *distance));
    let Some((distance, group)) = near.first() else { return Err(missing(finder, joint, letters)) };
    let Some(columns) = group.complete() else { return Err(incomplete(finder, joint, group, letters)) };
    let rival = near.iter().skip(1).find(|(other, group)| other == distance && group.complete().is_some());
    match rival {
        Some((_, other)) => Err(ambiguous(finder, joint, group, other, letters)),
        None => Ok(columns),
    }
}

fn what(letters: &[&str]) -> &'static str {
    if letters.len() == QUATERNION.len() { "quaternion" } else { "place" }
}

fn remedy(letters: &[&str]) -> &'static str {
    if letters.len() == QUATERNION.len() {
        "--columns 'xyzw=a|b|c|d' (or 'wxyz=…' where w stands first; numbers as in `5..8` do too)"
    } else {
        "--columns 'place=a|b|c' (numbers as in `2..4` do too)"
    }
}

fn labels(finder: &Finder, group: &Group) -> String {
    let known: Vec<String> = group.columns.iter().flatten().map(|column| finder.label(*column)).collect();
    known.join(", ")
}

fn missing(
    finder: &Finder,
    joint: &QuaternionJoint,
    letters: &[&str],
) -> super::super::error::IdentificationError {
    let (what, name) = (what(letters), &joint.name);
    let angles = angles(finder.headers);
    if letters.len() == QUATERNION.len() && !angles.is_empty() {
        return finder.fault(format!(
            "no columns are known as the quaternion of `{name}`, but {} look like angles. Attitudes are read as \
             quaternions alone: the order of angles is a convention that a log does not tell. Convert them \
             (scipy: Rotation.from_euler(…).as_quat()) and name the four columns qx, qy, qz, qw",
            angles.join(", ")
        ));
    }
    let several =
        if finder.robot.quaternions.len() > 1 { ", whose names have to hold the joint's" } else { "" };
    finder.fault(format!(
        "no columns are known as the {what} {} of `{name}`{several}. There are {}. Name them: {}",
        letters.join(", "),
        super::sheet::shortened(&finder.sheet.headers),
        remedy(letters)
    ))
}

fn incomplete(
    finder: &Finder,
    joint: &QuaternionJoint,
    group: &Group,
    letters: &[&str],
) -> super::super::error::IdentificationError {
    let pairs = letters.iter().zip(&group.columns);
    let absent: Vec<&str> = pairs.filter(|(_, column)| column.is_none()).map(|(letter, _)| *letter).collect();
    finder.fault(format!(
        "of the {} of `{}` only {} are there, {} is missing. Name all {}: {}",
        what(letters),
        joint.name,
        labels(finder, group),
        absent.join(", "),
        letters.len(),
        remedy(letters)
    ))
}

fn ambiguous(
    finder: &Finder,
    joint: &QuaternionJoint,
    one: &Group,
    other: &Group,
    letters: &[&str],
) -> super::super::error::IdentificationError {
    finder.fault(format!(
        "both {} and {} could be the {} of `{}`. Name the right ones: {}",
        labels(finder, one),
        labels(finder, other),
        what(letters),
        joint.name,
        remedy(letters)
    ))
}

fn metres(finder: &Finder, column: usize, told: Option<Unit>) -> Result<f64> {
    match told.or_else(|| finder.headers.get(column).and_then(|header| header.unit)) {
        None => Ok(1.0),
        Some(unit) if unit.si == "m" || unit.si == "1" => Ok(unit.factor),
        Some(unit) => Err(finder.fault(format!(
            "column {} is a place in {}, but m is expected here",
            finder.label(column),
            unit.si
        ))),
    }
}

fn without_unit(finder: &Finder, column: usize, told: Option<Unit>) -> Result<f64> {
    match told.or_else(|| finder.headers.get(column).and_then(|header| header.unit)) {
        None => Ok(1.0),
        Some(unit) if unit.si == "1" && unit.factor == 1.0 => Ok(1.0),
        Some(_) => Err(finder.fault(format!(
            "column {} would be an entry of a quaternion, which has no unit. Where these columns are angles, convert them \
             to quaternions (scipy: Rotation.from_euler(…).as_quat())",
            finder.label(column)
        ))),
    }
}
