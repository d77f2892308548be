//! Tables of the numbers of a robot, with their units.

use gelenk_report::{Cell, SceneSymbol, Table};

use super::robot::Robot;
use crate::diagnostic::Diagnostics;
use crate::model::{
    Actuator, Attachment, Drive, FollowedCoordinate, ForceEffect, Input, Joint, JointKind, Motion, Pose,
    RotorCoupling, TorqueSpeedLine, WrenchAxes,
};
use crate::numeric::{atan2, length};
use crate::program::cost::Cost;
use gelenk_formula::Formula;

/// Table of independent and driven joints (with a prescribed motion), with limits.
pub(super) fn coordinates(robot: &Robot<'_>) -> Table {
    let mut table = Table::new(
        "coordinates",
        "Coordinates and limits at the joint, in rad, rad/s and N m for revolute joints, in m, m/s and N for prismatic joints.",
    )
    .column("", "index", "");
    let has_quaternions = !robot.model.quaternion_joints.is_empty();
    if has_quaternions {
        table = table.column("", "velocity", "");
    }
    let table = table
        .column("joint", "joint", "")
        .column("kind", "kind", "")
        .column("lowest", "lowest position", "")
        .column("highest", "highest position", "")
        .column("speed", "velocity limit", "")
        .column("effort", "effort limit", "")
        .column("peak effort", "peak effort limit", "");
    let joints = robot.model.joints().chain(robot.model.driven_joints()).enumerate();
    table.rows(joints.map(|(coordinate, joint)| {
        let mut row = vec![match robot.named(coordinate) {
            SceneSymbol::Velocity(_) => Cell::Empty,
            SceneSymbol::Position(_) | SceneSymbol::Driven(_) => Cell::formula(robot.symbol(coordinate)),
        }];
        let velocity = [format!("\\dot{{y}}_{{{}}}", coordinate + 1), format!("v{}", coordinate + 1)];
        row.extend(has_quaternions.then(|| Cell::formula(velocity)));
        row.extend(limit_cells(joint, role(robot, coordinate, joint)));
        row
    }))
}

/// A joint's name, kind and limits.
fn limit_cells(joint: &Joint, role: String) -> [Cell; 7] {
    let limits = joint.limits;
    let position = limits.position;
    [
        Cell::Text(joint.name.clone()),
        Cell::Text(role),
        Cell::exact_or_empty(position.map(|[low, _]| low)),
        Cell::exact_or_empty(position.map(|[_, high]| high)),
        Cell::exact_or_empty(limits.velocity),
        Cell::exact_or_empty(limits.effort),
        Cell::exact_or_empty(limits.peak_effort),
    ]
}

/// Type of a coordinate's joint. For a velocity of a joint with a quaternion, the name of this joint.
fn role(robot: &Robot<'_>, coordinate: usize, joint: &Joint) -> String {
    match (robot.named(coordinate), robot.model.quaternion_joint_of(coordinate)) {
        (SceneSymbol::Driven(_), _) => format!("{}, motion given", kind(joint.kind)),
        (_, Some(whole)) => format!("velocity of {} joint {}", whole.kind.name(), whole.name),
        (_, None) => kind(joint.kind),
    }
}

/// Type of a joint. A helical joint has its pitch.
fn kind(kind: JointKind) -> String {
    match kind {
        JointKind::Helical { pitch } => format!("{}, {pitch:?} m/rad", kind.name()),
        _ => kind.name().to_owned(),
    }
}

/// Table cell with a number, or with a formula of free parameters.
fn cell(robot: &Robot<'_>, value: &Formula) -> Cell {
    match value.as_number() {
        Some(number) => Cell::Exact(number),
        None => Cell::formula(robot.formula(value)),
    }
}

fn cells(robot: &Robot<'_>, values: &[Formula]) -> Vec<Cell> {
    values.iter().map(|value| cell(robot, value)).collect()
}

fn link_name(robot: &Robot<'_>, link: usize) -> Cell {
    Cell::text(robot.model.links[link].name.as_str())
}

/// Table of motors and gears; `None` without drives.
pub(super) fn drives(robot: &Robot<'_>) -> Option<Table> {
    let drives = &robot.model.drives;
    if drives.is_empty() {
        return None;
    }
    let mut table = Table::new("drives", "Drives and inputs. Torques are at the motor, forces at the joint.")
        .column("", "index", "")
        .column("drive", "drive", "")
        .column("joint", "joint", "")
        .column("gear ratio $i$", "gear ratio", "")
        .column("rotor inertia $J_R$", "rotor inertia", "kg m²")
        .column("carried by", "carrier", "")
        .column("rotor in $M$", "coupling", "")
        .column("input is", "input kind", "")
        .column("nominal torque", "nominal torque", "N m")
        .column("peak torque", "peak torque", "N m");
    let have_speeds = drives.iter().any(|drive| drive.speed.is_some());
    if have_speeds {
        table = table.column("highest speed", "highest speed of the motor", "rad/s");
    }
    let have_lines = drives.iter().any(|drive| drive.line.is_some());
    if have_lines {
        table = table.column("stall torque", "stall torque of the motor", "N m").column(
            "no-load speed",
            "no-load speed of the motor",
            "rad/s",
        );
    }
    let rows = drives.iter().map(|drive| {
        let mut inputs = robot.inputs().into_iter();
        let index = match inputs.position(|input| input.name() == drive.name) {
            Some(index) => Cell::formula([format!("u_{{{}}}", index + 1), format!("u{}", index + 1)]),
            None => Cell::Empty,
        };
        let speed = have_speeds.then(|| Cell::exact_or_empty(drive.speed));
        let line = have_lines.then(|| {
            let number = |of: fn(&TorqueSpeedLine) -> f64| Cell::exact_or_empty(drive.line.as_ref().map(of));
            [number(|line| line.stall_torque), number(|line| line.no_load_speed)]
        });
        let line = line.into_iter().flatten();
        std::iter::once(index).chain(drive_row(robot, drive)).chain(speed).chain(line).collect()
    });
    Some(table.rows(rows))
}

/// Table of forces between frames, and of inputs and wrenches at frames; `None` if there are none of these
/// forces.
pub(super) fn forces_at_frames(robot: &Robot<'_>) -> Option<Table> {
    let model = robot.model;
    let parameters = robot.names();
    let between = |[a, b]: &[Attachment; 2]| format!("{} – {}", a.name, b.name);
    let row = |input: Option<usize>, name: &str, place: String, force: String| -> Vec<Cell> {
        let index =
            input.map_or(Cell::Empty, |index| Cell::formula([format!("u_{{{index}}}"), format!("u{index}")]));
        let cells = [index, Cell::text(name), Cell::Text(place), Cell::Text(force)];
        cells.into_iter().chain([Cell::Empty, Cell::Empty, Cell::Empty]).collect()
    };
    let laws = model.point_forces.iter().map(|force| {
        let law = format!("pulls with {} N", force.law.distance_text(&parameters));
        row(None, &force.name, between(&force.between), law)
    });
    let drives = model.input_drives().count();
    let inputs = model.force_inputs.iter().enumerate().map(|(index, input)| {
        let (place, effect) = match &input.effect {
            ForceEffect::Pull(frames) => (between(frames), "pulls with u".to_owned()),
            ForceEffect::Wrench { at, wrench } => {
                let entries: Vec<String> = wrench.iter().map(|entry| entry.text(&parameters)).collect();
                (at.name.clone(), format!("u · ({})", entries.join(", ")))
            }
        };
        let mut row = row(Some(drives + index + 1), &input.name, place, effect);
        if let Some([low, high]) = input.limits {
            let unit = model.input_unit(Actuator::Force(input));
            row.splice(4.., [Cell::Exact(low), Cell::Exact(high), Cell::text(unit)]);
        }
        row
    });
    let wrenches = model.wrenches.iter().map(|wrench| {
        let axes = match wrench.axes {
            WrenchAxes::Frame => "an argument, in the axes of the frame",
            WrenchAxes::Base => "an argument, in the axes of the base",
        };
        row(None, &wrench.name, wrench.at.name.clone(), axes.to_owned())
    });
    let rows: Vec<Vec<Cell>> = laws.chain(inputs).chain(wrenches).collect();
    if rows.is_empty() {
        return None;
    }
    let table = Table::new(
        "frame-forces",
        "Forces at frames; l is the distance of two frames [m], dl its rate. Wrenches are force, then moment.",
    )
    .column("", "index", "")
    .column("name", "name", "")
    .column("acts at", "place", "")
    .column("force", "force", "")
    .column("lowest", "lowest input", "")
    .column("highest", "highest input", "")
    .column("unit", "unit", "");
    Some(table.rows(rows))
}

/// Table of the limits of joints that follow coordinates, and of motors that move several joints; `None`
/// without limits.
pub(super) fn dependent(robot: &Robot<'_>) -> Option<Table> {
    let all = robot.model.dependent(&robot.parameters).into_iter();
    let limited = all.filter(|one| one.velocity.is_finite() || one.position.iter().any(|x| x.is_finite()));
    let finite = |value: f64| Cell::exact_or_empty(value.is_finite().then_some(value));
    let rows: Vec<Vec<Cell>> = limited
        .map(|one| {
            let ratios = one.ratios.iter().flatten().enumerate().filter(|(_, ratio)| **ratio != 0.0);
            let term = |(coordinate, ratio): (usize, &f64)| FollowedCoordinate {
                coordinate,
                ratio: Formula::Number(*ratio),
            };
            let motion = robot.followed(&ratios.map(term).collect::<Vec<_>>(), one.offset);
            let [low, high] = one.position.map(finite);
            vec![Cell::Text(one.name.to_owned()), Cell::formula(motion), low, high, finite(one.velocity)]
        })
        .collect();
    if rows.is_empty() {
        return None;
    }
    let table = Table::new(
        "dependent-limits",
        "Limits of joints that follow others, and of motors that move several joints, in rad and rad/s, or in m and m/s for \
         prismatic joints.",
    )
    .column("joint or drive", "name", "")
    .column("its position", "position", "")
    .column("lowest", "lowest position", "")
    .column("highest", "highest position", "")
    .column("speed", "velocity limit", "");
    Some(table.rows(rows))
}

fn drive_row(robot: &Robot<'_>, drive: &Drive) -> Vec<Cell> {
    let joint = match drive.coordinate() {
        Some(index) => Cell::text(robot.joints()[index].name.as_str()),
        None if drive.acts_on.is_empty() => Cell::text(""),
        None => Cell::formula(robot.followed(&drive.acts_on, 0.0)),
    };
    let coupling = match drive.coupling {
        RotorCoupling::Body => "a body",
        RotorCoupling::Diagonal => "diagonal only",
    };
    let input = match (&drive.input, drive.acts_on.first()) {
        (_, None) => Cell::text("none: the joint is held"),
        (Input::None, _) => Cell::text("none"),
        (Input::Torque, _) if robot.model.input_unit(Actuator::Drive(drive)) == "N" => Cell::text("force"),
        (Input::Torque, _) => Cell::text("torque"),
        (Input::Current(constant), _) => match constant.as_number() {
            Some(value) => Cell::text(format!("current, {value} N m/A")),
            None => Cell::text("current"),
        },
    };
    vec![
        Cell::Text(drive.name.clone()),
        joint,
        cell(robot, &drive.gear_ratio),
        cell(robot, &drive.rotor_inertia),
        link_name(robot, drive.carrier),
        Cell::text(coupling),
        input,
        Cell::exact_or_empty(drive.torque.nominal),
        Cell::exact_or_empty(drive.torque.peak),
    ]
}

/// Table of masses and centres of mass; `None` without bodies.
pub(super) fn bodies(robot: &Robot<'_>) -> Option<Table> {
    let caption = "Bodies: mass, and centre of mass in the frame of the link.";
    let mut table = Table::new("bodies", caption)
        .column("body", "body", "")
        .column("link", "link", "")
        .column("mass", "mass", "kg");
    for axis in ["x", "y", "z"] {
        table = table.column(&format!("$c_{axis}$"), format!("c_{axis}"), "m");
    }
    let bodies = robot.bodies();
    let rows = bodies.iter().map(|(link, body)| {
        let mut row =
            vec![Cell::Text(body.name.clone()), Cell::Text(link.name.clone()), cell(robot, &body.mass)];
        row.extend(cells(robot, &body.center_of_mass));
        row
    });
    (!bodies.is_empty()).then(|| table.rows(rows))
}

/// Table of inertias; `None` without bodies.
pub(super) fn inertias(robot: &Robot<'_>) -> Option<Table> {
    let caption =
        "Inertia of the bodies about their centres of mass, in axes of the links (I_xy = −∫ x y dm).";
    let mut table = Table::new("inertias", caption).column("body", "body", "");
    for entry in ["xx", "xy", "xz", "yy", "yz", "zz"] {
        table = table.column(&format!("$I_{{{entry}}}$"), format!("I_{entry}"), "kg m²");
    }
    let bodies = robot.bodies();
    let rows = bodies.iter().map(|(_, body)| {
        let mut row = vec![Cell::Text(body.name.clone())];
        row.extend(cells(robot, &body.inertia));
        row
    });
    (!bodies.is_empty()).then(|| table.rows(rows))
}

/// Table of poses and axes of joints; `None` without joints.
pub(super) fn geometry(robot: &Robot<'_>) -> Option<Table> {
    let joints: Vec<&Joint> = robot.model.links.iter().filter_map(|link| link.joint.as_ref()).collect();
    if joints.is_empty() {
        return None;
    }
    let table = Table::new(
        "geometry",
        "Joints: origin, roll, pitch and yaw of the joint frame in the parent link's frame (R = R_z R_y R_x), and the axis in the joint \
         frame.",
    )
    .column("joint", "joint", "")
    .column("parent", "parent", "")
    .column("motion", "motion", "");
    let table = pose_columns(table).column("axis", "axis", "");
    Some(table.rows(joints.into_iter().map(|joint| {
        let motion = match joint.motion {
            Motion::Fixed => Cell::text("fixed"),
            Motion::Held(position) => {
                let position = short(position).to_string().replace('-', "−");
                Cell::text(format!("held at {position} {}", joint.kind.unit()))
            }
            Motion::Coordinate(index) => Cell::formula(robot.symbol(index)),
            Motion::Follower(index) => {
                let moving = robot.model.moving_joints();
                Cell::formula(robot.followed(&moving[index].follows, moving[index].offset))
            }
        };
        let mut row = vec![Cell::Text(joint.name.clone()), link_name(robot, joint.parent), motion];
        row.extend(pose_cells(robot, &joint.origin));
        let axis = joint.axis.map(|x| short(x).to_string()).join(", ");
        row.push(Cell::Text(axis.replace('-', "−")));
        row
    })))
}

/// Table of named frames; `None` without frames.
pub(super) fn frames(robot: &Robot<'_>) -> Option<Table> {
    let frames = &robot.model.frames;
    if frames.is_empty() {
        return None;
    }
    let table = Table::new("frames", "Named frames in the frames of their links.")
        .column("frame", "frame", "")
        .column("link", "link", "");
    Some(pose_columns(table).rows(frames.iter().map(|frame| {
        let mut row = vec![Cell::Text(frame.name.clone()), link_name(robot, frame.link)];
        row.extend(pose_cells(robot, &frame.pose));
        row
    })))
}

fn pose_columns(table: Table) -> Table {
    let table =
        ["x", "y", "z"].iter().fold(table, |table, axis| table.column(&format!("${axis}$"), *axis, "m"));
    ["roll", "pitch", "yaw"].iter().fold(table, |table, angle| table.column(angle, *angle, "rad"))
}

fn pose_cells(robot: &Robot<'_>, pose: &Pose) -> Vec<Cell> {
    let mut row = cells(robot, &pose.translation);
    row.extend(roll_pitch_yaw(&pose.rotation).map(|angle| Cell::Exact(short(angle))));
    row
}

/// Roll, pitch and yaw of `R = R_z(yaw) R_y(pitch) R_x(roll)`. If pitch is ±90°, roll is 0.
fn roll_pitch_yaw(r: &[[f64; 3]; 3]) -> [f64; 3] {
    let cosine = length([r[0][0], r[1][0]]);
    let pitch = atan2(-r[2][0], cosine);
    if cosine < 1e-9 {
        return [0.0, pitch, atan2(-r[0][1], r[1][1])];
    }
    [atan2(r[2][1], r[2][2]), pitch, atan2(r[1][0], r[0][0])]
}

/// Rounds to nine decimals, because further digits are rounding errors of rotation matrices.
fn short(value: f64) -> f64 {
    let rounded = (value * 1e9).round() / 1e9;
    // No negative zero.
    rounded + 0.0
}

/// Table of free parameters; `None` without free parameters.
pub(super) fn parameters(robot: &Robot<'_>) -> Option<Table> {
    let parameters = &robot.model.parameters;
    if parameters.is_empty() {
        return None;
    }
    let table = Table::new(
        "free-parameters",
        "Free parameters: fields of `Parameters`, an argument of the generated functions.",
    )
    .column("name", "name", "")
    .column("described value", "described value", "")
    .column("unit", "unit", "")
    .column("meaning", "meaning", "");
    Some(table.rows(parameters.iter().map(|one| {
        vec![
            Cell::Code(one.name.clone()),
            Cell::Exact(one.default),
            Cell::text(one.unit.clone()),
            Cell::text(one.description.clone()),
        ]
    })))
}

/// Gravity as text, for example `(0, 0, −9.81) m/s²`.
pub(super) fn gravity(robot: &Robot<'_>) -> String {
    let numbers = robot.vector(&robot.model.gravity).map(|x| short(x).to_string());
    format!("({}) m/s²", numbers.join(", ").replace('-', "−"))
}

/// Table of the operation counts of functions, with the bytes of machine code if given. The number of bytes is
/// `None` for inlined functions.
pub(crate) fn counts(functions: &[(String, Cost)], bytes: &[Option<u64>]) -> Table {
    let mut table = Table::new(
        "operations",
        "Operations of each generated function, counted as in robotics papers: a subtraction counts as an \
         addition, and one call computes sine and cosine of an angle.",
    );
    let counts = ["multiplications", "additions", "divisions", "sin_cos", "other calls", "selections"];
    let bytes_column = (!bytes.is_empty()).then_some("bytes");
    for name in ["function"].into_iter().chain(counts).chain(bytes_column) {
        table = table.column(if name == "sin_cos" { "sin and cos" } else { name }, name, "");
    }
    table.rows(functions.iter().enumerate().map(|(index, (name, cost))| {
        let Cost { multiplications, additions, divisions, sin_cos, other_calls, selections } = *cost;
        let counts = [multiplications, additions, divisions, sin_cos, other_calls, selections];
        let size = bytes.get(index).map(|size| match size {
            Some(size) => Cell::Count(usize::try_from(*size).unwrap_or(usize::MAX)),
            None => Cell::text("inlined"),
        });
        [Cell::Code(name.clone())].into_iter().chain(counts.map(Cell::Count)).chain(size).collect()
    }))
}

/// Table of notes on the description.
pub(super) fn notes(notes: &Diagnostics) -> Table {
    let table = Table::new(
        "description-notes",
        "Parts of the description that were skipped or changed, and other remarks.",
    )
    .column("place", "place", "")
    .column("note", "note", "")
    .column("what to do", "help", "");
    table.rows(notes.entries().iter().map(|note| {
        let place = note.location().map(|at| format!("{}:{}", at.file, at.line));
        vec![
            Cell::text(place.unwrap_or_default()),
            Cell::text(note.message.clone()),
            Cell::text(note.remedy.clone().unwrap_or_default()),
        ]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_rotations() {
        let close = |found: [f64; 3], expected: [f64; 3]| {
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(close(roll_pitch_yaw(&identity), [0.0; 3]));
        let about_z = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(close(roll_pitch_yaw(&about_z), [0.0, 0.0, quarter]));
        let about_y = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
        assert!(close(roll_pitch_yaw(&about_y), [0.0, quarter, 0.0]));
    }
}
