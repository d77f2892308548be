//! The functions that CasADi is given: inputs, outputs, and where each entry comes from.

use super::super::context::Context;
use crate::emit::interface::{Callable, Interface, entries};
use crate::functions::function::Function;
use crate::program::nonzero_entries;

/// A function with its derivatives.
pub(super) struct External {
    /// The function.
    pub(super) value: Evaluation,
    /// Its derivatives; none where the module does not have them.
    pub(super) jacobian: Option<Evaluation>,
}

/// A function as CasADi calls it.
pub(super) struct Evaluation {
    /// Its name in C.
    pub(super) name: String,
    /// What it is.
    pub(super) about: String,
    /// Inputs, all of them dense.
    pub(super) inputs: Vec<Input>,
    /// Outputs.
    pub(super) outputs: Vec<Block>,
    /// Fill the array `e`, from [`VALUES`] on.
    pub(super) statements: Vec<String>,
    /// Entries of `e`.
    pub(super) size: usize,
}

/// An input.
#[derive(Clone)]
pub(super) struct Input {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// An output, of which only some entries are not zero in every state.
pub(super) struct Block {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Row, column, place in `e`; column by column.
    pub(super) entries: Vec<(usize, usize, usize)>,
}

/// The place in `e` of the number 1.
pub(super) const ONE: usize = 0;
/// Where the computed values begin in `e`.
pub(super) const VALUES: usize = 1;

impl Input {
    fn new(name: &str, rows: usize) -> Self {
        Self { name: name.to_owned(), rows, columns: 1 }
    }
}

impl Block {
    fn new(name: &str, [rows, columns]: [usize; 2], place: impl Fn(usize, usize) -> Option<usize>) -> Self {
        let all = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
        let entries = all.filter_map(|(row, column)| Some((row, column, place(row, column)?)));
        Self { name: name.to_owned(), rows, columns, entries: entries.collect() }
    }

    /// A column from a place on.
    fn column(name: &str, rows: usize, start: usize) -> Self {
        Self::new(name, [rows, 1], |row, _| Some(start + row))
    }
}

impl External {
    fn new(value: Evaluation, derivatives: Option<Derivatives>) -> Self {
        let of_outputs = value.outputs.iter().map(|output| Input {
            name: format!("out_{}", output.name),
            rows: output.rows,
            columns: output.columns,
        });
        let inputs = value.inputs.iter().cloned().chain(of_outputs).collect();
        let jacobian = derivatives.map(|Derivatives { statements, size, blocks }| Evaluation {
            name: format!("jac_{}", value.name),
            about: format!("Derivatives of `{}`.", value.name),
            inputs,
            outputs: blocks,
            statements,
            size,
        });
        Self { value, jacobian }
    }
}

/// The room of a result in `e`: no two begin at the same place, also where one has no entries.
fn room(entries: usize) -> usize {
    entries.max(1)
}

/// All of a module, in its order.
pub(super) fn all(context: &Context<'_>, interface: &Interface) -> Vec<External> {
    let robot = Robot { context, interface, n: context.module.coordinates, m: context.module.inputs };
    let frames =
        interface.functions.iter().filter_map(|function| robot.frame(function.name.strip_suffix("_pose")?));
    let functions = [robot.dynamics(), robot.inverse_dynamics(), robot.step()];
    functions.into_iter().flatten().chain(frames).collect()
}

/// A module, and what its functions are called by.
struct Robot<'a> {
    context: &'a Context<'a>,
    interface: &'a Interface,
    n: usize,
    m: usize,
}

/// The state's halves as arguments, and all other arguments by their own names.
const STATE: [(&str, &str); 2] = [("y", "x"), ("v", "v")];
const OWN: [(&str, &str); 0] = [];

/// How derivatives are computed: statements that fill `e`, and the blocks that are taken from it.
struct Derivatives {
    statements: Vec<String>,
    size: usize,
    blocks: Vec<Block>,
}

impl Derivatives {
    const fn new() -> Self {
        Self { statements: vec![], size: VALUES, blocks: vec![] }
    }

    /// Room for so many values.
    const fn room(&mut self, count: usize) -> usize {
        let place = self.size;
        self.size += count;
        place
    }
}

/// A result in `e`: where it begins, and which entries are not zero in every state.
struct Stored {
    start: usize,
    nonzero: Vec<bool>,
}

impl Stored {
    fn at(&self, index: usize) -> Option<usize> {
        self.nonzero.get(index)?.then_some(self.start + index)
    }
}

impl Robot<'_> {
    /// ẋ = f(x, u).
    fn dynamics(&self) -> Option<External> {
        let (n, m) = (self.n, self.m);
        let [v, a] = [VALUES, VALUES + n];
        let call = self.call("forward_dynamics", &STATE, a)?;
        let copy = format!("memcpy(&e[{v}], v, {n} * sizeof *e);");
        let value = Evaluation {
            name: self.name("dynamics"),
            about: "Forward dynamics: ẋ = (ẏ, ÿ) of x = (y, ẏ) under the inputs u.".to_owned(),
            inputs: self.with_parameters(vec![Input::new("x", 2 * n), Input::new("u", m)]),
            outputs: vec![Block::column("xdot", 2 * n, v)],
            statements: vec![self.velocities(), copy, call],
            size: a + n,
        };
        let derivatives = self.derivatives_of_dynamics();
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_dynamics(&self) -> Option<Derivatives> {
        let (n, m) = (self.n, self.m);
        let mut made = Derivatives::new();
        made.statements.push(self.velocities());
        let stored = self.stored(&mut made, "linearize", &STATE)?;
        let [by_y, by_v, by_u, ..] = stored.as_slice() else { return None };
        made.blocks.push(Block::new("jac_xdot_x", [2 * n, 2 * n], |row, column| {
            match (row < n, column < n) {
                (true, _) => (column == row + n).then_some(ONE),
                (false, true) => by_y.at((row - n) * n + column),
                (false, false) => by_v.at((row - n) * n + column - n),
            }
        }));
        made.blocks.push(Block::new("jac_xdot_u", [2 * n, m], |row, column| {
            by_u.at(row.checked_sub(n)? * m + column)
        }));
        if let Some(count) = self.parameters() {
            let stored = self.stored(&mut made, "forward_dynamics_by_parameters", &STATE)?;
            let by_p = stored.first()?;
            let place = |row: usize, column| by_p.at(row.checked_sub(n)? * count + column);
            made.blocks.push(Block::new("jac_xdot_p", [2 * n, count], place));
        }
        Some(made)
    }

    /// The forces of a motion.
    fn inverse_dynamics(&self) -> Option<External> {
        let n = self.n;
        let value = Evaluation {
            name: self.name("inverse_dynamics"),
            about: "Inverse dynamics: the forces B u of a motion.".to_owned(),
            inputs: self.with_parameters(["y", "v", "a"].map(|name| Input::new(name, n)).to_vec()),
            outputs: vec![Block::column("b_u", n, VALUES)],
            statements: vec![self.call("inverse_dynamics", &OWN, VALUES)?],
            size: VALUES + n,
        };
        let derivatives = self.derivatives_of_inverse_dynamics();
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_inverse_dynamics(&self) -> Option<Derivatives> {
        let n = self.n;
        let mut made = Derivatives::new();
        let stored = self.stored(&mut made, "inverse_dynamics_derivatives_and_mass_matrix", &OWN)?;
        for (result, name) in stored.iter().skip(1).zip(["y", "v", "a"]) {
            let place = |row, column| result.at(row * n + column);
            made.blocks.push(Block::new(&format!("jac_b_u_{name}"), [n, n], place));
        }
        if let Some(count) = self.parameters() {
            let stored = self.stored(&mut made, "inverse_dynamics_by_parameters", &OWN)?;
            let by_p = stored.first()?;
            made.blocks
                .push(Block::new("jac_b_u_p", [n, count], |row, column| by_p.at(row * count + column)));
        }
        Some(made)
    }

    /// x⁺ after a period.
    fn step(&self) -> Option<External> {
        let (n, m) = (self.n, self.m);
        let call = self.call("step", &STATE, VALUES)?;
        let inputs = vec![Input::new("x", 2 * n), Input::new("u", m), Input::new("period", 1)];
        let value = Evaluation {
            name: self.name("step"),
            about: "The state after one period in s, over which u is held.".to_owned(),
            inputs: self.with_parameters(inputs),
            outputs: vec![Block::column("x_next", 2 * n, VALUES)],
            statements: vec![self.velocities(), call],
            size: VALUES + 2 * n,
        };
        let derivatives = self.derivatives_of_step();
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_step(&self) -> Option<Derivatives> {
        let (n, m) = (self.n, self.m);
        let mut made = Derivatives::new();
        let place = made.room(2 * n + 4 * n * n + room(2 * n * m));
        let call = self.call("step_derivatives", &STATE, place)?;
        made.statements.extend([self.velocities(), call]);
        let [by_x, by_u] = [place + 2 * n, place + 2 * n + 4 * n * n];
        // Blocks of N × N, those of y⁺ first.
        let by_state = |row: usize, column: usize| {
            let block = 2 * (row / n) + column / n;
            Some(by_x + block * n * n + row % n * n + column % n)
        };
        made.blocks.push(Block::new("jac_x_next_x", [2 * n, 2 * n], by_state));
        made.blocks.push(Block::new("jac_x_next_u", [2 * n, m], |row, column| Some(by_u + row * m + column)));
        let count = self.parameters().unwrap_or(0);
        let width = 1 + count;
        let place = made.room(2 * n * width);
        made.statements.push(self.sensitivities(place)?);
        made.blocks.push(Block::new("jac_x_next_period", [2 * n, 1], |row, _| Some(place + row * width)));
        if count > 0 {
            let entry = |row, column| Some(place + row * width + 1 + column);
            made.blocks.push(Block::new("jac_x_next_p", [2 * n, count], entry));
        }
        Some(made)
    }

    /// The call of the function that `sensitivities.rs` prints; none where what it calls is not in the module.
    fn sensitivities(&self, place: usize) -> Option<String> {
        let by_parameters = self.parameters().map(|_| "forward_dynamics_by_parameters");
        let called = ["forward_dynamics", "linearize"].into_iter().chain(by_parameters);
        called.map(|name| self.call(name, &STATE, 0)).collect::<Option<Vec<_>>>()?;
        let parameters = if self.parameters().is_some() { "&parameters, " } else { "" };
        Some(format!("{}(x, u, *period, {parameters}&e[{place}]);", self.name("sensitivities")))
    }

    /// The pose of a frame; `stem` is `frame_<name>`.
    fn frame(&self, stem: &str) -> Option<External> {
        let [position, rotation] = [VALUES, VALUES + 3];
        let turned = |row: usize, column: usize| Some(rotation + 3 * row + column);
        let about = "Pose of a frame in the base frame: the origin [m], and the rotation matrix, whose columns are its axes.";
        let value = Evaluation {
            name: self.name(stem),
            about: about.to_owned(),
            inputs: self.with_parameters(vec![Input::new("y", self.n)]),
            outputs: vec![Block::column("position", 3, position), Block::new("rotation", [3, 3], turned)],
            statements: vec![self.call(&format!("{stem}_pose"), &OWN, position)?],
            size: VALUES + 12,
        };
        let derivatives = self.derivatives_of_frame(stem);
        Some(External::new(value, derivatives))
    }

    fn derivatives_of_frame(&self, stem: &str) -> Option<Derivatives> {
        let n = self.n;
        let mut made = Derivatives::new();
        let pose = self.stored(&mut made, &format!("{stem}_pose"), &OWN)?;
        let [_, axes] = pose.as_slice() else { return None };
        let jacobian = self.stored(&mut made, &format!("{stem}_jacobian"), &OWN)?;
        let jacobian = jacobian.first()?;
        let turning = made.room(9 * n);
        let turn = self.name("turn");
        let omega = jacobian.start + 3 * n;
        made.statements.push(format!("{turn}(&e[{}], &e[{omega}], {n}, &e[{turning}]);", axes.start));
        // ∂R/∂y = ω × R, each axis of R a column of three rows.
        let by_rotation = |entry: usize, column: usize| {
            let (row, axis) = (entry % 3, entry / 3);
            let others = [(row + 1) % 3, (row + 2) % 3];
            let product = |omega: usize, part: usize| {
                jacobian.at((3 + omega) * n + column).is_some() && axes.at(3 * part + axis).is_some()
            };
            let is_there = product(others[0], others[1]) || product(others[1], others[0]);
            is_there.then_some(turning + entry * n + column)
        };
        let position = Block::new("jac_position_y", [3, n], |row, column| jacobian.at(row * n + column));
        let rotation = Block::new("jac_rotation_y", [9, n], by_rotation);
        made.blocks.extend([position, rotation]);
        if let Some(count) = self.parameters() {
            let stored = self.stored(&mut made, &format!("{stem}_pose_by_parameters"), &OWN)?;
            let [position, rotation] = stored.as_slice() else { return None };
            let place = |row: usize, column: usize| position.at(row * count + column);
            made.blocks.insert(1, Block::new("jac_position_p", [3, count], place));
            // Column by column here, rows first in the module.
            let place =
                |entry: usize, column: usize| rotation.at((3 * (entry % 3) + entry / 3) * count + column);
            made.blocks.push(Block::new("jac_rotation_p", [9, count], place));
        }
        Some(made)
    }

    /// Calls a function that writes to `e`; where its results stand, and which entries are not zero in every state.
    fn stored(&self, made: &mut Derivatives, name: &str, renamed: &[(&str, &str)]) -> Option<Vec<Stored>> {
        let nonzero = self.nonzero(name)?;
        let call = self.call(name, renamed, made.size)?;
        made.statements.push(call);
        Some(
            nonzero
                .into_iter()
                .map(|nonzero| Stored { start: made.room(room(nonzero.len())), nonzero })
                .collect(),
        )
    }

    fn name(&self, name: &str) -> String {
        self.context.function(&format!("casadi_{name}"))
    }

    /// How many free parameters there are, where there are any.
    fn parameters(&self) -> Option<usize> {
        Some(self.interface.parameters.len()).filter(|&count| count > 0)
    }

    fn with_parameters(&self, mut inputs: Vec<Input>) -> Vec<Input> {
        inputs.extend(self.parameters().map(|count| Input::new("p", count)));
        inputs
    }

    /// The velocities of a state.
    fn velocities(&self) -> String {
        format!("const double *v = &x[{}];", self.n)
    }

    /// The call of a function that writes its results to `e` from a place on; none where the module does not have it,
    /// or where it takes what CasADi is not given here.
    ///
    /// - `renamed`: names of arguments in the function and here, where they differ
    fn call(&self, name: &str, renamed: &[(&str, &str)], place: usize) -> Option<String> {
        let function = self.callable(name)?;
        let mut words: Vec<String> = vec![];
        for argument in &function.arguments {
            let known = renamed.iter().find(|(own, _)| *own == argument.name);
            let word = known.map_or(argument.name.as_str(), |(_, here)| here);
            if !["x", "y", "v", "a", "u", "period"].contains(&word) {
                return None;
            }
            words.push(if argument.is_number() { format!("*{word}") } else { word.to_owned() });
        }
        words.extend((!self.interface.parameters.is_empty()).then(|| "&parameters".to_owned()));
        let mut place = place;
        for result in &function.results {
            words.push(format!("&e[{place}]"));
            place += room(entries(&result.extents));
        }
        Some(format!("{}({});", self.context.function(name), words.join(", ")))
    }

    fn callable(&self, name: &str) -> Option<&Callable> {
        self.interface.functions.iter().find(|function| function.name == name)
    }

    /// Which entries of each result are not zero in every state.
    fn nonzero(&self, name: &str) -> Option<Vec<Vec<bool>>> {
        let functions = self.interface.functions.iter().zip(&self.context.module.functions);
        let found: Option<(&Callable, &Function)> = functions.into_iter().find(|(face, _)| face.name == name);
        found.map(|(_, function)| nonzero_entries(&function.program))
    }
}
