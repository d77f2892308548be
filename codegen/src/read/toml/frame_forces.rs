//! Forces at frames: forces between two frames, wrenches, and inputs that are wrenches.

use super::table::{Item, Table};
use super::values::Reader;
use crate::description::{
    Name, PointForceDescription, PullDescription, WrenchDescription, WrenchInputDescription,
};
use crate::diagnostic::At;
use crate::model::WrenchAxes;
use crate::wording::as_written;
use gelenk_formula::Formula;

/// Reads the forces between two frames, `[[forces]]`.
pub(crate) fn read_point_forces(reader: &mut Reader, top: &Table<'_>) -> Vec<PointForceDescription> {
    reader.all(top, "forces", read_point_force)
}

fn read_point_force(reader: &mut Reader, table: &Table<'_>) -> Option<PointForceDescription> {
    let name = reader.name_of(table, "name");
    let between = table.get("between").and_then(|item| two_names(reader, item));
    let law = table.get("law").map(|item| {
        let formula = reader.force_between_law(item).unwrap_or(Formula::ZERO);
        At::new(formula, item.span)
    });
    let input = table.get("input").and_then(|item| reader.name(item));
    let limits = table.get("limits").map(|item| (item.key_span, reader.numbers::<2>(item)));
    let stroke = table.get("stroke").and_then(|item| stroke(reader, item));
    let speed = table.get("speed").and_then(|item| reader.number(item));
    if table.get("law").is_none() && table.get("input").is_none() {
        reader.report.error(table.span, "missing-key", "a force needs `law` or `input`");
        reader.report.help(
            "`law = \"1200*(l - 0.3) + 40*dl\"` is a spring and damper with distance l and its rate dl. `input = \"cylinder\"` is \
             an input. Positive forces pull the frames together",
        );
        return None;
    }
    if let (Some((span, _)), None) = (&limits, table.get("input")) {
        reader.report.error(*span, "limits-without-input", "`limits` apply only to a force that is an input");
        reader.report.help("name the input with `input = …`, or remove `limits`");
    }
    let between = between?;
    let name = name.or_else(|| input.clone());
    let name =
        name.unwrap_or_else(|| At::new(format!("{} – {}", between[0].value, between[1].value), table.span));
    let input = input.map(|name| PullDescription { name, limits: limits.and_then(|(_, limits)| limits) });
    Some(PointForceDescription { name, between, law, input, stroke, speed })
}

/// Reads the shortest and the longest distance between two frames. Both must be greater than 0.
fn stroke(reader: &mut Reader, item: Item<'_>) -> Option<At<[f64; 2]>> {
    let stroke = reader.numbers::<2>(item)?;
    let [shortest, longest] = stroke.value;
    if shortest > 0.0 && shortest < longest {
        return Some(stroke);
    }
    let message = format!("the stroke [{}, {}] is an empty range", as_written(shortest), as_written(longest));
    reader.report.error(item.span, "limits-reversed", message);
    reader
        .report
        .help("give the shortest, then the longest distance of the two frames in m: stroke = [0.8, 1.3]");
    None
}

fn two_names(reader: &mut Reader, item: Item<'_>) -> Option<[Name; 2]> {
    let entries = item.array("a list of two frames or links", &mut reader.report)?;
    let [first, second] = entries[..] else {
        let message = format!("`{}` must name two frames or links, not {}", item.key, entries.len());
        reader.report.error(item.span, "wrong-length", message);
        item.help_by_example(&mut reader.report);
        return None;
    };
    Some([reader.name(first)?, reader.name(second)?])
}

/// Reads the inputs that are wrenches, `[[inputs]]`.
pub(crate) fn read_wrench_inputs(reader: &mut Reader, top: &Table<'_>) -> Vec<WrenchInputDescription> {
    reader.all(top, "inputs", read_wrench_input)
}

fn read_wrench_input(reader: &mut Reader, table: &Table<'_>) -> Option<WrenchInputDescription> {
    let name = reader.name_of(table, "name")?;
    let frame = reader.name_of(table, "frame");
    let wrench = table.get("wrench");
    let wrench = wrench.and_then(|item| {
        let errors = reader.report.error_count();
        let parts = reader.formulas::<6>(item, &name.value)?;
        // A part that could not be read counts as 0, and would make a wrench that is zero.
        (reader.report.error_count() == errors).then(|| At::new(parts, item.span))
    });
    let limits = table.get("limits").and_then(|item| reader.numbers::<2>(item));
    Some(WrenchInputDescription { name, frame: frame?, wrench: wrench?, limits })
}

/// Reads the wrenches that are arguments of functions, `[[wrenches]]`.
pub(crate) fn read_wrenches(reader: &mut Reader, top: &Table<'_>) -> Vec<WrenchDescription> {
    reader.all(top, "wrenches", read_wrench)
}

fn read_wrench(reader: &mut Reader, table: &Table<'_>) -> Option<WrenchDescription> {
    let name = reader.name_of(table, "name")?;
    let frame = reader.name_of(table, "frame");
    let axes = table.get("in").map_or(Some(WrenchAxes::Frame), |item| wrench_axes(reader, item));
    Some(WrenchDescription { name, frame: frame?, axes: axes? })
}

fn wrench_axes(reader: &mut Reader, item: Item<'_>) -> Option<WrenchAxes> {
    let word = item.word(&mut reader.report)?;
    Some(if word == "base" { WrenchAxes::Base } else { WrenchAxes::Frame })
}
