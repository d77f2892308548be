//! The functions that CasADi calls, with their derivatives.

use super::super::context::Context;
use super::external::{Block, Body, Derivatives, Evaluation, External, Input, ONE, Stored, VALUES, room};
use super::robot::{Given, Robot};
use crate::emit::interface::Interface;
use crate::functions::function::{FrameFunction, FrameKind};

/// All functions for CasADi that a module has, in order.
pub(super) fn all(context: &Context<'_>, interface: &Interface) -> Vec<External> {
    let robot = Robot { context, interface, n: context.module.coordinates, m: context.module.inputs };
    let of_frames = context.module.functions.iter().filter_map(|function| function.frame.as_ref());
    let poses = of_frames.filter(|of| of.kind == FrameKind::Pose);
    let frames = poses.filter_map(|of| robot.frame(&of.frame));
    let functions = [robot.dynamics(), robot.inverse_dynamics(), robot.step()];
    functions.into_iter().flatten().chain(frames).collect()
}

/// Name of the module's function for a quantity of a frame.
fn of_frame(frame: &str, kind: FrameKind) -> String {
    FrameFunction { frame: frame.to_owned(), kind }.name()
}

const REFERENCE: [&str; 1] = ["y_ref"];

impl Robot<'_> {
    /// The function for CasADi of the forward dynamics ẋ = f(x, u) with state x and inputs u; `None` if the
    /// module lacks them.
    fn dynamics(&self) -> Option<External> {
        let (n, m) = (self.n, self.m);
        let [rate, a] = [VALUES, VALUES + n];
        let call = self.call("forward_dynamics", a)?;
        let (about, rates) = match self.has_reference() {
            false => (
                "Forward dynamics: ẋ = (ẏ, ÿ) of the state x = (y, ẏ) with the inputs u.",
                format!("memcpy(&e[{rate}], v, {n} * sizeof *e);"),
            ),
            true => (
                "Forward dynamics: ẋ = (ḋ, v̇) of the state x = (d, v) with the inputs u, at the positions y_ref ⊕ d. A rotation in d is \
                 less than a full turn; otherwise ḋ is not a number.",
                format!("{}(x, v, 1, &e[{rate}], NULL, NULL);", self.context.function("about_rates")),
            ),
        };
        let mut statements = self.begin(Given::State);
        statements.extend([rates, call]);
        let value = Evaluation {
            name: self.name("dynamics"),
            about: about.to_owned(),
            inputs: self.with_rest(vec![Input::new("x", 2 * n), Input::new("u", m)], &REFERENCE),
            outputs: vec![Block::column("xdot", 2 * n, rate)],
            body: Body::Filled { statements, size: a + n },
        };
        let derivatives = self.derivatives_of_dynamics();
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_dynamics(&self) -> Option<Derivatives> {
        let (n, m) = (self.n, self.m);
        let mut made = self.begin_derivatives(Given::State);
        let mut stored = self.stored(&mut made, "linearize")?;
        let (by_y, by_v, by_u) = (stored.next()?, stored.next()?, stored.next()?);
        let by_y = self.by_positions(&mut made, by_y);
        let rates = self.rates(&mut made);
        made.blocks.push(Block::new("jac_xdot_x", [2 * n, 2 * n], |row, column| {
            match (row.checked_sub(n), column.checked_sub(n), &rates) {
                (None, _, None) => (column == row + n).then_some(ONE),
                (None, None, Some([by_d, _])) => by_d.at(row * n + column),
                (None, Some(column), Some([_, by_v])) => by_v.at(row * n + column),
                (Some(row), None, _) => by_y.own.at(row * n + column),
                (Some(row), Some(column), _) => by_v.at(row * n + column),
            }
        }));
        // The first half of the rows does not depend on the inputs after x.
        let lower = |name: &str, columns: usize, by: &Stored| {
            Block::new(name, [2 * n, columns], |row, column| by.at(row.checked_sub(n)? * columns + column))
        };
        made.blocks.push(lower("jac_xdot_u", m, &by_u));
        let reference = by_y.reference.as_ref();
        made.blocks.extend(reference.map(|by| lower("jac_xdot_y_ref", by.nonzero.len() / n, by)));
        if let Some(count) = self.parameters() {
            let by_p = self.stored(&mut made, "forward_dynamics_by_parameters")?.next()?;
            made.blocks.push(lower("jac_xdot_p", count, &by_p));
        }
        Some(made)
    }

    /// The function for CasADi of the inverse dynamics; `None` if the module lacks them.
    fn inverse_dynamics(&self) -> Option<External> {
        let n = self.n;
        let positions = self.name_of(Given::Positions);
        let about = match self.has_reference() {
            false => "Inverse dynamics: the forces B u that produce a motion.",
            true => "Inverse dynamics: the forces B u that produce a motion at the positions y_ref ⊕ d.",
        };
        let mut statements = self.begin(Given::Positions);
        statements.push(self.call("inverse_dynamics", VALUES)?);
        let inputs = [positions, "v", "a"].map(|name| Input::new(name, n));
        let value = Evaluation {
            name: self.name("inverse_dynamics"),
            about: about.to_owned(),
            inputs: self.with_rest(inputs.to_vec(), &REFERENCE),
            outputs: vec![Block::column("b_u", n, VALUES)],
            body: Body::Filled { statements, size: VALUES + n },
        };
        let derivatives = self.derivatives_of_inverse_dynamics();
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_inverse_dynamics(&self) -> Option<Derivatives> {
        let n = self.n;
        let positions = self.name_of(Given::Positions);
        let mut made = self.begin_derivatives(Given::Positions);
        let mut stored = self.stored(&mut made, "inverse_dynamics_derivatives_and_mass_matrix")?.skip(1);
        let (by_y, by_v, by_a) = (stored.next()?, stored.next()?, stored.next()?);
        let by_y = self.by_positions(&mut made, by_y);
        let by_p = match self.parameters() {
            Some(_) => Some(self.stored(&mut made, "inverse_dynamics_by_parameters")?.next()?),
            None => None,
        };
        let known = [(positions, by_y.own), ("v", by_v), ("a", by_a)].into_iter();
        let all = known.chain(by_y.reference.map(|by| ("y_ref", by))).chain(by_p.map(|by| ("p", by)));
        made.blocks.extend(all.map(|(name, by)| {
            let columns = by.nonzero.len() / n;
            Block::new(&format!("jac_b_u_{name}"), [n, columns], |row, column| by.at(row * columns + column))
        }));
        Some(made)
    }

    /// The function for CasADi of the state after one period; `None` if the module lacks `step`.
    fn step(&self) -> Option<External> {
        let (n, m) = (self.n, self.m);
        let call = self.call("step", VALUES)?;
        let inputs = vec![Input::new("x", 2 * n), Input::new("u", m), Input::new("period", 1)];
        let mut statements = self.begin(Given::State);
        statements.push(call);
        let ny = self.context.module.positions;
        let (about, entries) = match self.has_reference() {
            false => ("State after one period (s) with constant u.", VALUES..VALUES + 2 * n),
            true => {
                statements.extend(self.next_reference());
                let [v, d] = [VALUES + ny, VALUES + ny + n];
                let difference = self.context.function("difference");
                statements.push(format!("{difference}(unit_next, &e[{VALUES}], &e[{d}]);"));
                statements.push(format!("memcpy(&e[{}], &e[{v}], {n} * sizeof *e);", d + n));
                let about = "State after one period (s) with constant u. The positions of x = (d, v) are y_ref ⊕ d \
                        before the period, and y_ref_next ⊕ d after the period. Rotations in d are at most \
                        half a turn.";
                (about, d..d + 2 * n)
            }
        };
        let value = Evaluation {
            name: self.name("step"),
            about: about.to_owned(),
            inputs: self.with_rest(inputs, &["y_ref", "y_ref_next"]),
            outputs: vec![Block::column("x_next", 2 * n, entries.start)],
            body: Body::Filled { statements, size: entries.end },
        };
        let derivatives = self.derivatives_of_step();
        Some(External::new(value, derivatives))
    }

    /// Statements that normalize the quaternions of the reference positions after the period.
    fn next_reference(&self) -> [String; 3] {
        let ny = self.context.module.positions;
        [
            format!("double unit_next[{ny}];"),
            "memcpy(unit_next, y_ref_next, sizeof unit_next);".to_owned(),
            format!("if (!{}(unit_next)) return 1;", self.context.function("normalize")),
        ]
    }

    fn derivatives_of_step(&self) -> Option<Derivatives> {
        let (n, m, ny) = (self.n, self.m, self.context.module.positions);
        let mut made = self.begin_derivatives(Given::State);
        let after = made.room(ny + n + 4 * n * n + room(2 * n * m));
        let call = self.call("step_derivatives", after)?;
        made.statements.push(call);
        let [by_x, by_u] = [after + ny + n, after + ny + n + 4 * n * n];
        let width = 1 + self.parameters().unwrap_or(0);
        let others = made.room(2 * n * width);
        // These derivatives take as long as all others together, and solvers seldom need them.
        let places = [Some(2), self.parameters().map(|_| if self.has_reference() { 5 } else { 3 })];
        let wanted = places.into_iter().flatten().map(|place| format!("res[{place}]"));
        let wanted = wanted.collect::<Vec<_>>().join(" || ");
        made.statements.push(format!("const int others = {wanted} ? {width} : 0;"));
        made.statements.push(format!("if (others) {}", self.sensitivities(others)?));
        let references = self.has_reference().then(|| [made.room(2 * n * ny), made.room(n * ny)]);
        if let Some([by_ref, by_next]) = references {
            made.statements.extend(self.next_reference());
            made.statements.push(format!(
                "{}(y_ref_next, unit_next, &e[{after}], by_d, by_ref, &e[{by_x}], &e[{by_u}], &e[{by_ref}], &e[{by_next}], \
                 others, &e[{others}]);",
                self.name("step_about")
            ));
        }
        // Blocks of N × N entries. The blocks of the positions y⁺ are first.
        let by_state = |row: usize, column: usize| {
            let block = 2 * (row / n) + column / n;
            Some(by_x + block * n * n + row % n * n + column % n)
        };
        made.blocks.push(Block::new("jac_x_next_x", [2 * n, 2 * n], by_state));
        made.blocks.push(Block::new("jac_x_next_u", [2 * n, m], |row, column| Some(by_u + row * m + column)));
        made.blocks.push(Block::new("jac_x_next_period", [2 * n, 1], |row, _| Some(others + row * width)));
        if let Some([by_ref, by_next]) = references {
            let place = |row, column| Some(by_ref + row * ny + column);
            made.blocks.push(Block::new("jac_x_next_y_ref", [2 * n, ny], place));
            // The velocities do not depend on the next reference.
            let place = |row, column| (row < n).then_some(by_next + row * ny + column);
            made.blocks.push(Block::new("jac_x_next_y_ref_next", [2 * n, ny], place));
        }
        if width > 1 {
            let entry = |row, column| Some(others + row * width + 1 + column);
            made.blocks.push(Block::new("jac_x_next_p", [2 * n, width - 1], entry));
        }
        Some(made)
    }

    /// Call of the function for the derivatives of a step with respect to period and free parameters; `None`
    /// if the module lacks a function that it calls.
    fn sensitivities(&self, place: usize) -> Option<String> {
        let by_parameters = self.parameters().map(|_| "forward_dynamics_by_parameters");
        let called = ["forward_dynamics", "linearize"].into_iter().chain(by_parameters);
        called.map(|name| self.call(name, 0)).collect::<Option<Vec<_>>>()?;
        let parameters = if self.parameters().is_some() { "&parameters, " } else { "" };
        Some(format!("{}(y, v, u, *period, {parameters}&e[{place}]);", self.name("sensitivities")))
    }

    /// The function for CasADi of a frame's pose; `None` if the module lacks it.
    fn frame(&self, frame: &str) -> Option<External> {
        let [position, rotation] = [VALUES, VALUES + 3];
        let turned = |row: usize, column: usize| Some(rotation + 3 * row + column);
        let about = "Pose of a frame in the base frame: the origin [m], and the rotation matrix, whose columns are the frame's axes.";
        let positions = self.name_of(Given::Positions);
        let mut statements = self.begin(Given::Positions);
        statements.push(self.call(&of_frame(frame, FrameKind::Pose), position)?);
        let value = Evaluation {
            name: self.name(&format!("frame_{frame}")),
            about: about.to_owned(),
            inputs: self.with_rest(vec![Input::new(positions, self.n)], &REFERENCE),
            outputs: vec![Block::column("position", 3, position), Block::new("rotation", [3, 3], turned)],
            body: Body::Filled { statements, size: VALUES + 12 },
        };
        let derivatives = self.derivatives_of_frame(frame);
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_frame(&self, frame: &str) -> Option<Derivatives> {
        let positions = self.name_of(Given::Positions);
        let mut made = self.begin_derivatives(Given::Positions);
        let axes = self.stored(&mut made, &of_frame(frame, FrameKind::Pose))?.nth(1)?;
        let jacobian = self.stored(&mut made, &of_frame(frame, FrameKind::Jacobian))?.next()?;
        let by = self.by_positions(&mut made, jacobian);
        let by_motions = [Some((positions, by.own)), by.reference.map(|by| ("y_ref", by))];
        let mut of_rotation = vec![];
        for (name, by) in by_motions.into_iter().flatten() {
            let columns = by.nonzero.len() / 6;
            let position = |row, column| by.at(row * columns + column);
            made.blocks.push(Block::new(&format!("jac_position_{name}"), [3, columns], position));
            of_rotation.push(self.turned(&mut made, name, &axes, &by));
        }
        if let Some(count) = self.parameters() {
            let by_parameters = format!("{}_by_parameters", of_frame(frame, FrameKind::Pose));
            let mut stored = self.stored(&mut made, &by_parameters)?;
            let (position, rotation) = (stored.next()?, stored.next()?);
            let place = |row: usize, column: usize| position.at(row * count + column);
            made.blocks.push(Block::new("jac_position_p", [3, count], place));
            // CasADi stores matrices column by column, the module row by row.
            let place =
                |entry: usize, column: usize| rotation.at((3 * (entry % 3) + entry / 3) * count + column);
            of_rotation.push(Block::new("jac_rotation_p", [9, count], place));
        }
        made.blocks.extend(of_rotation);
        Some(made)
    }

    /// Derivatives ∂R = ω × R of a rotation matrix R along angular velocities ω. The nine entries of R are in
    /// the order of its columns.
    ///
    /// - `axes`: the entries of R
    /// - `jacobian`: Jacobian of the frame, whose last three rows give the angular velocities
    fn turned(&self, made: &mut Derivatives, name: &str, axes: &Stored, jacobian: &Stored) -> Block {
        let columns = jacobian.nonzero.len() / 6;
        let turning = made.room(9 * columns);
        let turn = self.name("turn");
        let omega = jacobian.start + 3 * columns;
        made.statements.push(format!("{turn}(&e[{}], &e[{omega}], {columns}, &e[{turning}]);", axes.start));
        let by_rotation = |entry: usize, column: usize| {
            let (row, axis) = (entry % 3, entry / 3);
            let others = [(row + 1) % 3, (row + 2) % 3];
            let product = |omega: usize, part: usize| {
                jacobian.at((3 + omega) * columns + column).is_some() && axes.at(3 * part + axis).is_some()
            };
            let is_there = product(others[0], others[1]) || product(others[1], others[0]);
            is_there.then_some(turning + entry * columns + column)
        };
        Block::new(&format!("jac_rotation_{name}"), [9, columns], by_rotation)
    }
}
