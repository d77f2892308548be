//! Prints functions with loops over joints: straight-line code for the first arrays, then calls of the loops.

use super::body::{Body, JOINT};
use super::context::Context;
use super::{layout, parts, public, signature};
use crate::emit::arrays::{self, Row, is_only_result, table};
use crate::emit::options::Scalar;
use crate::functions::function::Function;
use crate::program::arrays::{Arrays, Map, Pairs, Step};
use crate::program::split;
use crate::program::{Operand, Program, Shape};

/// Name of the table that says for each pair of joints whether one carries the other ([`arrays::relation`]).
pub(super) const RELATIONS: &str = "relations";
pub(super) const MEETINGS: &str = "meetings";

/// Initial value of arrays in which not every entry is written.
const CLEARED: &str = " = {0}";

/// The texts of a function with loops over joints: the straight-line code before the loops, the loops, and
/// the public function.
pub(super) fn items(context: &Context<'_>, function: &Function, form: &Arrays, name: &str) -> Vec<String> {
    let face = function.program.face();
    let body = Body::new(context, &face);
    let emission = Emission::new(form, &body, name);
    let mut items = emission.setup_items();
    items.push(layout::function(&public::head(&body, name), &emission.statements()));
    items
}

/// Number of entries of the local arrays of a function.
pub(super) fn local_numbers(context: &Context<'_>, function: &Function, form: &Arrays) -> usize {
    let face = function.program.face();
    let body = Body::new(context, &face);
    let emission = Emission::new(form, &body, "");
    let arrays = (0..form.arrays.len()).filter(|&array| matches!(emission.places[array], Place::Local));
    arrays.map(|array| form.arrays[array].rows * emission.row.of(form, array)).sum()
}

/// Place of an array's entries in the printed function.
enum Place {
    /// The array is a constant of the module.
    Table,
    /// The array is a local variable of the function.
    Local,
    /// The array is the result of the function with this name.
    Result(String),
}

pub(super) struct Emission<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) form: &'a Arrays,
    body: &'a Body<'a>,
    name: &'a str,
    pub(super) row: Row,
    names: Vec<String>,
    places: Vec<Place>,
}

impl<'a> Emission<'a> {
    fn new(form: &'a Arrays, body: &'a Body<'a>, name: &'a str) -> Self {
        let place = |index: usize| {
            let output = form.outputs.iter().position(|output| output.array == index);
            match output {
                _ if table(form, index).is_some() => Place::Table,
                Some(output) if is_only_result(form, index) => {
                    Place::Result(body.names.results[output].clone())
                }
                _ => Place::Local,
            }
        };
        Self {
            context: body.context,
            form,
            body,
            name,
            row: Row::new(form),
            names: body.fresh(form.arrays.iter().map(|array| array.name.as_str())),
            places: (0..form.arrays.len()).map(place).collect(),
        }
    }

    /// All statements of the function with loops over joints, in order.
    fn statements(&self) -> Vec<String> {
        let arrays = 0..self.form.setup.outputs.len();
        let mut statements: Vec<String> = arrays.filter_map(|array| self.setup_array(array)).collect();
        statements.push(self.setup_call());
        statements.extend(self.form.steps.iter().flat_map(|step| self.step(step)));
        let outputs = self.form.outputs.iter().zip(&self.body.names.results);
        statements
            .extend(outputs.filter_map(|(output, result)| self.copy(output.array, output.shape, result)));
        statements
    }

    /// Declaration of an array that the straight-line code before the loops fills, or definition of a
    /// constant array.
    fn setup_array(&self, array: usize) -> Option<String> {
        match table(self.form, array) {
            Some(entries) => Some(self.table(array, &entries)),
            None => self.declaration(array, CLEARED),
        }
    }

    fn table(&self, array: usize, entries: &[f64]) -> String {
        let padding = self.row.len - self.form.joints.len();
        let entries = entries
            .chunks(self.form.joints.len())
            .flat_map(|row| row.iter().copied().chain(std::iter::repeat_n(0.0, padding)));
        let entries: Vec<String> = entries.map(|entry| self.context.literal(entry)).collect();
        let (aligned, ty) = (self.context.constant("ALIGNED"), self.context.ty());
        let head = format!("{aligned} static const {ty} {}[{}]", self.names[array], entries.len());
        format!("{head} = {};", layout::braces(4, &entries))
    }

    /// Declaration of a local variable; `None` if the array is not a local variable.
    fn declaration(&self, array: usize, value: &str) -> Option<String> {
        let len = self.form.arrays[array].rows * self.row.of(self.form, array);
        let (aligned, ty) = (self.context.constant("ALIGNED"), self.context.ty());
        match self.places[array] {
            Place::Local => Some(format!("{aligned} {ty} {}[{len}]{value};", self.names[array])),
            Place::Table | Place::Result(_) => None,
        }
    }

    fn array(&self, array: usize) -> String {
        match &self.places[array] {
            Place::Table | Place::Local => self.names[array].clone(),
            Place::Result(name) => name.clone(),
        }
    }

    /// Distance between two rows of an array over joints, in entries.
    fn width(&self, array: usize) -> usize {
        match self.places[array] {
            Place::Table | Place::Local => self.row.of(self.form, array),
            Place::Result(_) => self.form.coordinates().len(),
        }
    }

    /// Statement that copies a local array to a result; `None` if the array is not a local variable.
    fn copy(&self, array: usize, shape: Shape, result: &str) -> Option<String> {
        let Place::Local = self.places[array] else {
            return None;
        };
        let (name, joints) = (&self.names[array], self.form.coordinates().len());
        let len = self.row.of(self.form, array);
        let size = format!("{joints} * sizeof *{result}");
        Some(match shape {
            Shape::Matrix(..) => format!(
                "for (int i = 0; i < {joints}; ++i) {{\n    memcpy(&{result}[{joints} * i], &{name}[{len} * i], {size});\n}}"
            ),
            _ => format!("memcpy({result}, {name}, {size});"),
        })
    }

    fn step(&self, step: &Step) -> Vec<String> {
        match step {
            Step::Map(map) => self.map(map),
            Step::SumAncestors { from, to } => self.sums(&self.sum_ancestors(), *from, *to),
            Step::SumSubtrees { from, to } => self.sums(&self.sum_subtrees(), *from, *to),
            Step::Pairs(pairs) => self.pairs(pairs),
            Step::Collect { from, to } => self.rows(&self.collect(), *from, *to, CLEARED),
            Step::Project { from, to } => {
                let arguments = [self.array(*from), self.width(*to).to_string(), self.array(*to)];
                let call = layout::call(4, &self.project(), &arguments, ";");
                self.declaration(*to, CLEARED).into_iter().chain([call]).collect()
            }
            Step::Spread { from, to } => self.rows(&self.spread(), *from, *to, CLEARED),
            Step::GatherCarriers { from, to } => self.rows(&self.gather_carriers(), *from, *to, CLEARED),
            Step::GatherLast { from, to } => self.rows(&self.gather_last(), *from, *to, CLEARED),
            Step::Invert { from, to } => self.invert(*from, *to),
            Step::NegativeProduct { left, right, to } => {
                let (left, right, width) = (self.array(*left), self.array(*right), self.width(*to));
                self.call("negative_product", &[left, right, width.to_string()], *to)
            }
            Step::Apply { matrix, vector, to } => {
                self.call("apply", &[self.array(*matrix), self.array(*vector)], *to)
            }
        }
    }

    fn call(&self, callee: &str, from: &[String], to: usize) -> Vec<String> {
        let arguments = [from, &[self.array(to)]].concat();
        let call = layout::call(4, &self.context.function(callee), &arguments, ";");
        self.declaration(to, "").into_iter().chain([call]).collect()
    }

    /// Statements that invert a copy of a matrix, because a later step may read the matrix itself.
    fn invert(&self, from: usize, to: usize) -> Vec<String> {
        match self.form.coordinates {
            None => self.add_relations(),
            Some(_) => self.add_meetings(),
        }
        let (from, name) = (self.array(from), self.array(to));
        let copy = format!("memcpy({name}, {from}, sizeof {name});");
        let call = format!("{}({name});", self.context.function("invert"));
        self.declaration(to, "").into_iter().chain([copy, call]).collect()
    }

    fn pairs(&self, pairs: &Pairs) -> Vec<String> {
        self.add_relations();
        let rows = |array: usize| self.form.arrays[array].rows.to_string();
        let (before, beyond) = (pairs.before, pairs.beyond);
        let arguments = [
            rows(before.0),
            self.array(before.0),
            self.array(before.1),
            rows(beyond.0),
            self.array(beyond.0),
            self.array(beyond.1),
            self.array(pairs.diagonal),
            self.width(pairs.to).to_string(),
        ];
        self.call("pairs", &arguments, pairs.to)
    }

    /// Adds the table that says which joints carry each other, if the joints are not a chain.
    fn add_relations(&self) {
        let about = "Relation of joint j to joint i: -1 if j is before i on its path to the base, 1 if j is i or beyond i, otherwise 0.";
        if !self.form.is_chain() {
            // The entries have the size of a number, so masks and columns have registers of the same length.
            let ty = match self.context.options.scalar {
                Scalar::F64 => "int64_t",
                Scalar::F32 => "int32_t",
            };
            self.add_table(ty, RELATIONS, about, self.form.joints.len(), self.row.len, arrays::relation);
        }
    }

    /// Adds the table of the pairs of coordinates with common non-zero entries in the inverse mass matrix, if
    /// they are not a chain.
    fn add_meetings(&self) {
        let about = "Whether the inversion of the mass matrix combines the rows of coordinates i and j: 1 if it does, otherwise 0.";
        let tree = self.form.coordinates();
        if !tree.is_chain() {
            self.add_table("signed char", MEETINGS, about, tree.len(), self.row.coordinates, arrays::meeting);
        }
    }

    fn add_table(
        &self,
        ty: &str,
        stem: &str,
        about: &str,
        count: usize,
        len: usize,
        entry: fn(&Arrays, usize, usize) -> i8,
    ) {
        let row = |i: usize| {
            let entries: Vec<String> = (0..len).map(|j| entry(self.form, i, j).to_string()).collect();
            format!("    {{{}}},\n", entries.join(", "))
        };
        let rows: String = (0..count).map(row).collect();
        self.context.tables.add(&self.context.function(stem), |name| {
            format!("// {about}\nstatic const {ty} {name}[{count}][{len}] = {{\n{rows}}};\n")
        });
    }

    fn sums(&self, callee: &str, from: usize, to: usize) -> Vec<String> {
        self.rows(callee, from, to, "")
    }

    /// Declaration of an array, and call of a function over all rows of two arrays.
    fn rows(&self, callee: &str, from: usize, to: usize, value: &str) -> Vec<String> {
        let arguments = [self.form.arrays[from].rows.to_string(), self.array(from), self.array(to)];
        let call = layout::call(4, callee, &arguments, ";");
        self.declaration(to, value).into_iter().chain([call]).collect()
    }

    /// Declarations of the arrays that a loop over joints writes, and call of the loop.
    fn map(&self, map: &Map) -> Vec<String> {
        let callee = self.map_function(map);
        let arrays = map.reads.iter().chain(&map.writes);
        let arguments: Vec<String> = arrays.map(|&array| self.array(array)).collect();
        let declarations = map.writes.iter().filter_map(|&array| self.declaration(array, ""));
        declarations.chain([layout::call(4, &callee, &arguments, ";")]).collect()
    }

    fn map_function(&self, map: &Map) -> String {
        let mut body = Body::new(self.context, &map.body);
        body.row = Some(self.row.len);
        let reads = body.names.arguments.iter().map(|name| signature::read(self.context, name));
        let writes = body.names.results.iter().map(|name| signature::written(self.context, name));
        let arguments: Vec<String> = reads.chain(writes).collect();
        let statements: String = body.all_statements().iter().map(|each| layout::indented(each)).collect();
        let each = format!("for (int {JOINT} = 0; {JOINT} < {}; ++{JOINT}) {{\n{statements}}}", self.row.len);
        self.context.shared.add(&self.context.function(&map.name), |name| {
            let head = layout::call(0, &format!("static void {name}"), &arguments, "");
            format!("// {}\n{}", map.about, layout::function(&head, std::slice::from_ref(&each)))
        })
    }

    fn setup_name(&self) -> String {
        format!("{}_setup", self.name)
    }

    /// Indices of the arrays that the straight-line code before the loops fills.
    fn filled(&self) -> impl Iterator<Item = usize> {
        (0..self.form.setup.outputs.len()).filter(|&array| matches!(self.places[array], Place::Local))
    }

    fn setup_call(&self) -> String {
        let arguments = self.body.names.arguments.iter().cloned();
        let arguments = arguments.chain(self.context.passed_parameters());
        let arguments: Vec<String> = arguments.chain(self.filled().map(|array| self.array(array))).collect();
        layout::call(4, &self.setup_name(), &arguments, ";")
    }

    /// The straight-line code before the loops as a function, which is split into parts if it is long.
    fn setup_items(&self) -> Vec<String> {
        let outputs = self.filled().map(|array| self.form.setup.outputs[array].clone()).collect();
        let program = Program { outputs, ..self.form.setup.clone() };
        let (name, mut body) = (self.setup_name(), Body::new(self.context, &program));
        body.stride = Some(self.row.len);
        let split = split::parts(&program, &body.flow, self.context.options.longest_function);
        let (mut items, statements) = match split.as_slice() {
            [_] => {
                // Arrays are initialized with zeros.
                let is_known = |entry| !matches!(entry, Operand::Value(_) | Operand::Constant(0.0));
                (vec![], [body.stores(is_known), body.statements(0..program.instructions.len())].concat())
            }
            _ => {
                let private = Body::new(self.context, &program).without_stores();
                (parts::items(&private, &name, &split), parts::calls(&body, &name, &split))
            }
        };
        let head = layout::call(0, &format!("static void {name}"), &signature::arguments(&body), "");
        let function = layout::function(&head, &[body.unused(), statements].concat());
        let about = format!(
            "// {} {}; the arrays contain zeros before the call.\n",
            arrays::about_setup(self.form),
            self.name
        );
        items.push([about, function].concat());
        items
    }
}
