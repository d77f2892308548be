//! Calls of a module by functions for CasADi. For robots with quaternions, positions are small motions d from
//! a reference.

use super::super::context::Context;
use super::external::{Derivatives, Input, Stored, room};
use crate::emit::interface::{Callable, Interface, entries};
use crate::functions::function::Function;
use crate::layout::{Dimension, Extent};
use crate::program::nonzero_entries;

/// A module as functions for CasADi call it, with n velocities and m inputs.
pub(super) struct Robot<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) interface: &'a Interface,
    pub(super) n: usize,
    pub(super) m: usize,
}

/// Derivatives of a result with respect to the arguments that determine the positions.
pub(super) struct ByPositions {
    /// Derivatives with respect to the positions, or for robots with quaternions to the small motions from
    /// the reference.
    pub(super) own: Stored,
    /// Derivatives with respect to the entries of the reference positions; `None` for robots without
    /// quaternions.
    pub(super) reference: Option<Stored>,
}

/// The argument that gives the positions to a function for CasADi.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Given {
    /// The state: positions (or small motions from a reference), then velocities.
    State,
    /// The positions alone, or the small motions from a reference.
    Positions,
}

/// Variable with respect to which the positions are differentiated.
#[derive(Clone, Copy)]
enum Chart {
    /// The small motions from the reference positions.
    Motion,
    /// The entries of the reference positions.
    Reference,
}

impl Robot<'_> {
    /// Whether positions are small motions from a reference. This is the case for robots with quaternions.
    pub(super) fn has_reference(&self) -> bool {
        self.context.module.has_quaternions()
    }

    fn positions(&self) -> usize {
        self.context.module.positions
    }

    /// Name of the argument in C that gives the positions.
    pub(super) fn name_of(&self, argument: Given) -> &'static str {
        match argument {
            Given::State => "x",
            Given::Positions if self.has_reference() => "d",
            Given::Positions => "y",
        }
    }

    /// Name with the module's prefix of a private function or type in the file for CasADi.
    pub(super) fn name(&self, name: &str) -> String {
        self.context.function(&format!("casadi_{name}"))
    }

    /// Number of free parameters of the module; `None` if there are none.
    pub(super) fn parameters(&self) -> Option<usize> {
        Some(self.interface.parameters.len()).filter(|&count| count > 0)
    }

    /// Appends the reference positions and the free parameters to the inputs of a function.
    ///
    /// - `references`: names of the inputs for reference positions, which only robots with quaternions have
    pub(super) fn with_rest(&self, mut inputs: Vec<Input>, references: &[&str]) -> Vec<Input> {
        let references = references.iter().filter(|_| self.has_reference());
        inputs.extend(references.map(|name| Input::new(name, self.positions())));
        inputs.extend(self.parameters().map(Input::parameters));
        inputs
    }

    /// Statements that compute the positions y from an argument, and the velocities v if the argument is a
    /// state.
    pub(super) fn begin(&self, argument: Given) -> Vec<String> {
        let n = self.n;
        let is_state = argument == Given::State;
        let velocities = is_state.then(|| format!("const double *v = &x[{n}];"));
        if !self.has_reference() {
            let positions = is_state.then(|| "const double *y = x;".to_owned());
            return positions.into_iter().chain(velocities).collect();
        }
        let (ny, positions) = (self.positions(), self.name("positions"));
        let references = format!("double unit[{ny}], y[{ny}];");
        let argument = self.name_of(argument);
        let call = format!("if (!{positions}(y_ref, {argument}, unit, y)) return 1;");
        velocities.into_iter().chain([references, call]).collect()
    }

    /// Begins the computation of derivatives, with the statements of [`Self::begin`]. For robots with
    /// quaternions, the derivatives of the positions with respect to the small motions and to the reference
    /// are computed, too.
    pub(super) fn begin_derivatives(&self, given: Given) -> Derivatives {
        let (mut statements, argument) = (self.begin(given), self.name_of(given));
        if self.has_reference() {
            let (n, ny, tangents) = (self.n, self.positions(), self.name("tangents"));
            statements.push(format!("double by_d[{}], by_ref[{}];", n * n, n * ny));
            statements.push(format!("{tangents}(y_ref, unit, {argument}, by_d, by_ref);"));
        }
        Derivatives::new(statements)
    }

    /// Derivatives of the rate ḋ of the small motions d from the reference with respect to d and the
    /// velocities; `None` if positions are not small motions.
    pub(super) fn rates(&self, made: &mut Derivatives) -> Option<[Stored; 2]> {
        let n = self.n;
        let [by_d, by_v] = self.has_reference().then(|| [made.room(n * n), made.room(n * n)])?;
        made.statements.push(format!(
            "{}(x, v, 1, NULL, &e[{by_d}], &e[{by_v}]);",
            self.context.function("about_rates")
        ));
        let all = self.nonzero_blocks(Chart::Motion);
        let turning: Vec<usize> = self
            .joints()
            .into_iter()
            .filter(|joint| joint.size() > 1)
            .flat_map(|joint| joint.velocities())
            .collect();
        let of_d = all.iter().enumerate().map(|(index, &nonzero)| nonzero && turning.contains(&(index / n)));
        let of_d = Stored { start: by_d, nonzero: of_d.collect() };
        Some([of_d, Stored { start: by_v, nonzero: all }])
    }

    /// Computes the derivatives with respect to the arguments that determine the positions. `along` contains
    /// the derivatives along small motions, with one column per velocity.
    pub(super) fn by_positions(&self, made: &mut Derivatives, along: Stored) -> ByPositions {
        if !self.has_reference() {
            return ByPositions { own: along, reference: None };
        }
        let [own, reference] =
            [Chart::Motion, Chart::Reference].map(|chart| self.product(made, &along, chart));
        ByPositions { own, reference: Some(reference) }
    }

    fn product(&self, made: &mut Derivatives, along: &Stored, chart: Chart) -> Stored {
        let (n, columns) = (self.n, self.columns(chart));
        let rows = along.nonzero.len() / n;
        let start = made.room(rows * columns);
        let matrix = match chart {
            Chart::Motion => "by_d",
            Chart::Reference => "by_ref",
        };
        let (blocks, from) = (self.context.function("about_blocks"), along.start);
        made.statements.push(format!("{blocks}({rows}, &e[{from}], {matrix}, {columns}, &e[{start}]);"));
        let of_chart = self.nonzero_blocks(chart);
        let is_there = |row: usize, column: usize| {
            (0..n).any(|k| along.nonzero[row * n + k] && of_chart[k * columns + column])
        };
        let nonzero = (0..rows * columns).map(|index| is_there(index / columns, index % columns));
        Stored { start, nonzero: nonzero.collect() }
    }

    fn columns(&self, chart: Chart) -> usize {
        match chart {
            Chart::Motion => self.n,
            Chart::Reference => self.positions(),
        }
    }

    /// For each entry of a matrix with one block per joint and one row per velocity, whether it can be
    /// non-zero.
    fn nonzero_blocks(&self, chart: Chart) -> Vec<bool> {
        let columns = self.columns(chart);
        let mut nonzero = vec![false; self.n * columns];
        for joint in self.joints() {
            let of_columns = match chart {
                Chart::Motion => joint.velocities(),
                Chart::Reference => joint.position..joint.position + joint.entries,
            };
            // The orientation of a floating joint does not depend on its translation.
            let linear = if joint.entries == 7 { 3 } else { 0 };
            for (i, row) in joint.velocities().enumerate() {
                for (j, column) in of_columns.clone().enumerate() {
                    nonzero[row * columns + column] = i < linear || j >= linear;
                }
            }
        }
        nonzero
    }

    /// Indices of the positions and velocities of the joints; empty for robots without quaternions.
    fn joints(&self) -> Vec<JointEntries> {
        let (mut position, mut velocity) = (0, 0);
        let place = |&entries: &usize| {
            let joint = JointEntries { entries, position, velocity };
            position += entries;
            velocity += joint.size();
            joint
        };
        self.context.module.joint_positions.iter().map(place).collect()
    }

    /// Adds the call of a module's function that writes its results to the array `e` of computed values.
    /// Returns the places of the results in this array, or `None` if [`Self::call`] returns `None`.
    pub(super) fn stored(&self, made: &mut Derivatives, name: &str) -> Option<std::vec::IntoIter<Stored>> {
        let nonzero = self.nonzero(name)?;
        let call = self.call(name, made.size)?;
        made.statements.push(call);
        let stored =
            nonzero.into_iter().map(|nonzero| Stored { start: made.room(room(nonzero.len())), nonzero });
        Some(stored.collect::<Vec<_>>().into_iter())
    }

    /// Call of a function of the module that writes its results to the array `e` of computed values, from
    /// index `place` on. `None` if the module lacks the function, or if wrenches or prescribed motions are
    /// arguments of the function.
    pub(super) fn call(&self, name: &str, place: usize) -> Option<String> {
        let function = self.callable(name)?;
        let mut words: Vec<String> = vec![];
        for argument in &function.arguments {
            let is_unknown =
                |extent: &Extent| matches!(extent.dimension, Dimension::Wrenches | Dimension::Driven);
            if argument.extents.iter().any(is_unknown) {
                return None;
            }
            let word = argument.name.as_str();
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

    /// For each result of a module's function, the flags of the entries that can be non-zero.
    fn nonzero(&self, name: &str) -> Option<Vec<Vec<bool>>> {
        let functions = self.interface.functions.iter().zip(&self.context.module.functions);
        let found: Option<(&Callable, &Function)> = functions.into_iter().find(|(face, _)| face.name == name);
        found.map(|(_, function)| nonzero_entries(&function.program))
    }
}

/// Indices of the positions and velocities of a joint.
struct JointEntries {
    /// Number of the joint's position entries.
    entries: usize,
    /// Index of the joint's first position entry.
    position: usize,
    /// Index of the joint's first velocity.
    velocity: usize,
}

impl JointEntries {
    /// Number of the joint's velocities.
    fn size(&self) -> usize {
        if self.entries > 1 { self.entries - 1 } else { 1 }
    }

    fn velocities(&self) -> std::ops::Range<usize> {
        self.velocity..self.velocity + self.size()
    }
}
