//! Reader of TOML descriptions. It makes a [`RobotDescription`]. models/README.md documents the format.

mod couplings;
pub(crate) mod forces;
mod frame_forces;
pub(crate) mod joint_tables;
mod joints;
pub(crate) mod keys;
mod table;
pub(crate) mod values;

use self::couplings::read_drives;
use self::frame_forces::{read_point_forces, read_wrench_inputs, read_wrenches};
use self::joint_tables::{Extended, Joints, read_joints};
use self::keys::ROBOT;
use self::table::{Item, Table};
use self::values::{Reader, unsaid};
use crate::description::{BodyDescription, DriveChoice, FrameDescription, Name, RobotDescription};
use crate::diagnostic::{At, Span, nearest};
use crate::function_names;
use crate::model::{Options, Pose};
use gelenk_formula::{Allowed, Formula, Hold};
use std::collections::BTreeMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Top-level keys that affect the reading of all other keys and of the extended
/// description.
#[derive(Debug, Default)]
pub(super) struct Preamble {
    /// Path of the description that this file extends.
    pub extends: Option<Name>,
    pub snap_angles: Option<f64>,
    pub ignore_mimic: bool,
    pub no_friction: bool,
    /// Patterns of joints that are held, with their positions.
    pub held: Vec<At<Hold>>,
    /// Name of a body of an extended MJCF. The robot is the kinematic tree that contains this body.
    pub body: Option<Name>,
}

/// Parses the text. Reports all syntax errors; `None` if there are any.
pub(super) fn parse<'t>(
    reader: &mut Reader,
    text: &'t str,
    source: usize,
) -> Option<toml::Spanned<DeTable<'t>>> {
    let (table, wrong) = DeTable::parse_recoverable(text);
    let (mut last_line, mut repeated) = (None, None);
    for wrong in &wrong {
        let span = Span::new(source, wrong.span().unwrap_or(0..0));
        if wrong.message().starts_with(DUPLICATE) {
            let header = header(text, span.start);
            // All keys of a table that occurs twice are duplicates.
            if repeated.is_some() && repeated == header {
                continue;
            }
            repeated = header.filter(|header| header.contains(&span.start));
        }
        let line = text.get(..span.start).map(|before| before.matches('\n').count());
        // Further errors on the same line are usually consequences of the first error.
        if line.is_none() || line != last_line {
            reader.report.error(span, "toml-syntax", wrong.message());
            if let Some(help) = syntax_help(wrong.message(), text, span.start) {
                reader.report.help(help);
            }
        }
        last_line = line;
    }
    wrong.is_empty().then_some(table)
}

const DUPLICATE: &str = "duplicate key";

/// Header of the table that contains a place; `None` at the top level.
fn header(text: &str, at: usize) -> Option<Range<usize>> {
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        start += line.len();
        (start - line.len()..start, line)
    });
    let is_header = |line: &str| {
        let line = line.split('#').next().unwrap_or_default().trim();
        line.starts_with('[') && line.ends_with(']') && !line.contains([',', '='])
    };
    let before = lines.take_while(|(place, _)| place.start <= at);
    before.filter(|(_, line)| is_header(line)).last().map(|(place, _)| place)
}

/// Advice for a key or a table that occurs twice.
fn duplicate_help(line: &str) -> String {
    let name = line.split('#').next().unwrap_or_default().trim().strip_prefix('[');
    let name = name.and_then(|name| name.strip_suffix(']')).map(str::trim);
    match name {
        Some(name) if ROBOT.row(name).is_some_and(|row| row.value.is_tables()) => {
            format!("use double brackets for each of several tables: `[[{name}]]`")
        }
        Some(name) => format!("a table may occur only once: combine the keys of both under one `[{name}]`"),
        None => "a key may occur only once in a table: remove one entry".to_owned(),
    }
}

/// Advice for keys that occur twice, for numbers with units or a decimal comma, and for formulas without
/// quotes.
fn syntax_help(message: &str, text: &str, at: usize) -> Option<String> {
    let line_start = text.get(..at)?.rfind('\n').map_or(0, |last| last + 1);
    let line = text.get(line_start..)?.lines().next()?;
    if message.starts_with(DUPLICATE) {
        return Some(duplicate_help(line));
    }
    let (key, value) = line.split_once('=')?;
    let (key, value) = (key.trim(), value.split('#').next()?.trim());
    match gelenk_formula::parse(value, Allowed::Motion, &BTreeMap::new()) {
        Ok(_) => Some(format!("a formula needs quotes: `{key} = \"{value}\"`")),
        Err(wrong) if wrong.is_habit() => wrong.help,
        Err(_) => None,
    }
}

/// Opens the top-level table of a description. Unknown keys are reported.
pub(super) fn open<'t>(
    reader: &mut Reader,
    table: &'t toml::Spanned<DeTable<'t>>,
    source: usize,
) -> Table<'t> {
    Table::checked(table.get_ref(), Span::new(source, 0..0), &ROBOT, &mut reader.report)
}

/// Reads the top-level keys that affect the reading of all other keys.
pub(super) fn preamble(reader: &mut Reader, top: &Table<'_>) -> Preamble {
    let mut flag = |key| top.get(key).and_then(|item| item.boolean(&mut reader.report)).unwrap_or(false);
    let (ignore_mimic, no_friction) = (flag("ignore_mimic"), flag("no_friction"));
    let extends = ["urdf", "extends"].map(|key| top.get(key));
    if let [Some(_), Some(second)] = &extends {
        let message = "both `urdf` and `extends` name a file to extend";
        reader.report.error(second.key_span, "conflicting-keys", message).help("remove one of them");
    }
    let extends = extends.into_iter().flatten().next();
    let extends = extends.and_then(|item| reader.name(item));
    let snap_angles = top.get("snap_angles").and_then(|item| snap_tolerance(reader, item));
    let held = top.get("held").map_or(Vec::new(), |item| read_held(reader, item));
    let body = top.get("body").and_then(|item| reader.name(item));
    Preamble { extends, snap_angles, ignore_mimic, no_friction, held, body }
}

/// Reads a table of held joints, for example `held = { "finger_*" = 0 }`.
fn read_held(reader: &mut Reader, item: Item<'_>) -> Vec<At<Hold>> {
    let Some(joints) = item.named() else {
        item.expected("a table of joints with their positions", &mut reader.report);
        return Vec::new();
    };
    let hold = |item: Item<'_>| {
        let position = reader.number(item)?.value;
        Some(At::new(Hold { pattern: item.key.to_owned(), position }, item.key_span))
    };
    joints.into_iter().filter_map(hold).collect()
}

/// Largest tolerance for rounding angles to multiples of 90° (rad). A larger one would change angles that are
/// intended.
const WIDEST_SNAP: f64 = 0.1;

fn snap_tolerance(reader: &mut Reader, item: Item<'_>) -> Option<f64> {
    let tolerance = reader.number(item)?;
    if tolerance.value <= WIDEST_SNAP {
        return Some(tolerance.value);
    }
    let message = format!("`snap_angles` is {}, above the limit of {WIDEST_SNAP} rad", tolerance.value);
    reader.report.error(item.span, "snap-too-wide", message);
    reader.report.help("use 1e-4, which corrects angles written with at least four digits");
    None
}

/// Reads all keys of the file except those of the preamble.
///
/// - `extended`: properties of the extended description; `None` if the file extends no description
pub(super) fn description(
    reader: &mut Reader,
    top: &Table<'_>,
    name: &str,
    extended: Option<Extended>,
) -> RobotDescription {
    if let Some(parameters) = top.get("parameters") {
        read_parameters(reader, parameters);
    }
    let fallback = At::new(name.to_owned(), top.span);
    let (base, floating_base) = top.get("base").map_or((None, None), |item| read_base(reader, item));
    let Joints { joints, velocities } =
        read_joints(reader, top, base.as_ref(), floating_base.is_some(), extended);
    RobotDescription {
        name: top.get("name").and_then(|item| reader.name(item)).unwrap_or(fallback),
        description: top
            .get("description")
            .and_then(|item| item.text(&mut reader.report))
            .map(lines)
            .unwrap_or_default(),
        gravity: top.get("gravity").and_then(|item| reader.formulas::<3>(item, "gravity")),
        base,
        floating_base,
        is_freed: false,
        velocities,
        is_mjcf: false,
        bodies: read_bodies(reader, top),
        frames: read_frames(reader, top),
        coordinates: top.get("coordinates").and_then(|item| names(reader, item, "a list of joint names")),
        options: top.get("generate").map(|item| read_options(reader, item)),
        parameters: Vec::new(), // of all files together, in the reader
        joints,
        resting: Vec::new(),
        drives: read_drives(reader, top),
        point_forces: read_point_forces(reader, top),
        wrench_inputs: read_wrench_inputs(reader, top),
        wrenches: read_wrenches(reader, top),
        default_drive: DriveChoice::Passive,
        accept_unphysical: top
            .get("accept_unphysical")
            .and_then(|item| item.boolean(&mut reader.report))
            .unwrap_or(false),
        sort_joints: false,
        skipped_rotors: Vec::new(),
        links: Vec::new(),
        weightless_shapes: Vec::new(),
    }
}

/// Reads the name of the base link, and the place of the key that makes the base floating.
fn read_base(reader: &mut Reader, item: Item<'_>) -> (Option<Name>, Option<Span>) {
    if item.value.is_str() {
        return (reader.name(item), None);
    }
    let Some(table) = item.table(&mut reader.report) else {
        return (None, None);
    };
    let link = table.get("link").and_then(|item| reader.name(item));
    // An unknown type counts as floating, so that it causes no further error.
    let floats = table.get("type").filter(|kind| kind.word(&mut reader.report) != Some("fixed"));
    let floats = floats.map(|kind| kind.span);
    (link, floats)
}

fn lines(text: &str) -> Vec<String> {
    let clean = |line: &str| line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
    let lines: Vec<String> = text.trim().lines().map(|line| clean(line.trim_end())).collect();
    lines
}

fn names(reader: &mut Reader, item: Item<'_>, what: &str) -> Option<Vec<Name>> {
    let entries = item.array(what, &mut reader.report)?;
    Some(entries.into_iter().filter_map(|entry| reader.name(entry)).collect())
}

fn read_parameters(reader: &mut Reader, item: Item<'_>) {
    let Some(parameters) = item.named() else {
        return item.expected("a table of parameters", &mut reader.report);
    };
    let before = reader.parameters.len();
    for item in parameters {
        read_parameter(reader, item);
    }
    reader.unused.extend(before..reader.parameters.len());
}

fn read_parameter(reader: &mut Reader, item: Item<'_>) {
    let name = At::new(item.key.to_owned(), item.key_span);
    if !item.value.is_table() {
        let value = reader.number(item).map_or(1.0, |number| number.value);
        reader.push_parameter(name, value, String::new(), String::new());
        return;
    }
    let Some(table) = item.table(&mut reader.report) else {
        return;
    };
    let value = table.get("value").and_then(|value| reader.number(value)).map_or(1.0, |number| number.value);
    reader.add_parameter(name, value, &table);
}

fn read_options(reader: &mut Reader, item: Item<'_>) -> Options {
    let Some(table) = item.table(&mut reader.report) else {
        return Options::default();
    };
    let functions = table.get("functions");
    let functions = functions.map(|item| function_names(reader, item));
    let lanes = table.get("lanes");
    let lanes = lanes.map(|item| function_names(reader, item));
    let smooth_sign =
        table.get("smooth_sign").and_then(|item| reader.number(item)).map(|number| number.value);
    Options {
        functions: functions.unwrap_or_default(),
        lanes: lanes.unwrap_or_default(),
        smooth_sign,
        substeps: table.get("substeps").and_then(|item| substeps(reader, item)),
    }
}

fn function_names(reader: &mut Reader, item: Item<'_>) -> Vec<String> {
    let functions = names(reader, item, "a list of function names").unwrap_or_default();
    for unknown in functions.iter().filter(|name| !function_names::is_known(&name.value)) {
        reader.report.error(
            unknown.span,
            "unknown-function",
            format!("unknown function `{}`", unknown.value),
        );
        if let Some(help) = nearest(&unknown.value, function_names::listed()) {
            reader.report.help(help);
        }
    }
    functions.into_iter().map(|name| name.value).collect()
}

/// Largest number of Runge–Kutta steps in one sample time. A robot that needs more steps is stiff and needs a
/// shorter sample time.
const MOST_SUBSTEPS: usize = 1000;

fn substeps(reader: &mut Reader, item: Item<'_>) -> Option<usize> {
    let number = reader.number(item)?;
    let count = (1..=MOST_SUBSTEPS).find(|&count| count as f64 == number.value);
    if count.is_none() {
        let message =
            format!("`substeps` must be a whole number from 1 to {MOST_SUBSTEPS}, not {}", number.value);
        reader.report.error(number.span, "bad-count", message);
        reader.report.help("give the number of Runge–Kutta steps in one period of `step`");
    }
    count
}

fn read_bodies(reader: &mut Reader, top: &Table<'_>) -> Vec<BodyDescription> {
    reader.all(top, "bodies", read_body)
}

fn read_body(reader: &mut Reader, table: &Table<'_>) -> Option<BodyDescription> {
    let link = table.get("link").and_then(|item| reader.name(item));
    let name = table.get("name").and_then(|item| reader.name(item)).or_else(|| link.clone());
    let Some(name) = name else {
        reader.report.error(table.span, "missing-key", "a body needs `name` or `link`");
        reader.report.help("`link = \"forearm\"` gives the link of the body");
        return None;
    };
    let owner = name.value.clone();
    let mass = table.get("mass").map(|item| (item, reader.formula(item, &owner)));
    let center_of_mass = table.get("center_of_mass").and_then(|item| reader.formulas::<3>(item, &owner));
    let inertia =
        table.get("inertia").and_then(|item| Some(At::new(read_inertia(reader, item, &owner)?, item.span)));
    let accepts = table.get("accept_unphysical").and_then(|item| item.boolean(&mut reader.report));
    Some(BodyDescription {
        link: link.unwrap_or_else(|| name.clone()),
        name,
        origin: table.get("origin").and_then(|item| reader.pose(item, &owner)),
        unsaid: unsaid(table.get("origin")),
        mass: mass.map(|(item, value)| At::new(value.unwrap_or(Formula::ONE), item.span)),
        center_of_mass,
        inertia,
        accept_unphysical: accepts.unwrap_or(false),
        is_published: false,
    })
}

/// Reads an inertia: one moment for all axes, three principal moments, or a table of entries.
fn read_inertia(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<[Formula; 6]> {
    let zero = || Formula::ZERO;
    match item.value {
        DeValue::Array(_) => {
            let [xx, yy, zz] = reader.formulas::<3>(item, owner)?;
            Some([xx, zero(), zero(), yy, zero(), zz])
        }
        DeValue::Table(entries) if !entries.contains_key("free") => {
            let table = item.table(&mut reader.report)?;
            let owner = &format!("{owner}_inertia");
            Some(
                ["xx", "xy", "xz", "yy", "yz", "zz"].map(|key| {
                    table.get(key).and_then(|item| reader.formula(item, owner)).unwrap_or_else(zero)
                }),
            )
        }
        _ => {
            let moment = reader.formula(item, owner)?;
            Some([moment.clone(), zero(), zero(), moment.clone(), zero(), moment])
        }
    }
}

fn read_frames(reader: &mut Reader, top: &Table<'_>) -> Vec<FrameDescription> {
    reader.all(top, "frames", read_frame)
}

fn read_frame(reader: &mut Reader, table: &Table<'_>) -> Option<FrameDescription> {
    let name = reader.name_of(table, "name");
    let link = reader.name_of(table, "link");
    let owner = name.as_ref().map_or("frame", |name| &name.value).to_owned();
    let pose = table.get("origin").and_then(|item| reader.pose(item, &owner)).unwrap_or_else(Pose::identity);
    Some(FrameDescription { name: name?, link: link?, pose, is_site: false })
}
