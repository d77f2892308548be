//! Functions for CasADi: inputs, outputs, and the source of each entry.

/// A function with its derivatives.
pub(super) struct External {
    /// The function.
    pub(super) value: Evaluation,
    /// First and second derivatives; `None` if the module lacks the first.
    pub(super) derivatives: Option<[Evaluation; 2]>,
}

/// A function for CasADi.
pub(super) struct Evaluation {
    /// Name in C.
    pub(super) name: String,
    /// Description.
    pub(super) about: String,
    /// Inputs; all are dense.
    pub(super) inputs: Vec<Input>,
    /// Outputs.
    pub(super) outputs: Vec<Block>,
    /// Computation of the outputs.
    pub(super) body: Body,
}

/// Computation of the outputs of a function.
pub(super) enum Body {
    /// Statements fill an array `e` of this size from index [`VALUES`] on; the outputs are entries of `e`.
    Filled { statements: Vec<String>, size: usize },
    /// Central differences with respect to the first inputs.
    Differences {
        /// The differentiated function.
        of: String,
        /// How many inputs they are, and how many outputs the function has.
        counts: [usize; 2],
        /// The numbers that they store.
        work: usize,
    },
}

/// An input.
#[derive(Clone)]
pub(super) struct Input {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Whether these are the free parameters, which the module takes as a struct.
    pub(super) are_parameters: bool,
}

/// An output; only some entries are non-zero in some state.
pub(super) struct Block {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Row, column and index in `e` of each entry, column by column.
    pub(super) entries: Vec<(usize, usize, usize)>,
}

/// Index in `e` of the number 1.
pub(super) const ONE: usize = 0;
/// First index of computed values in `e`.
pub(super) const VALUES: usize = 1;

impl Input {
    /// The free parameters as an input.
    pub(super) fn parameters(count: usize) -> Self {
        Self { are_parameters: true, ..Self::new("p", count) }
    }

    pub(super) fn new(name: &str, rows: usize) -> Self {
        Self { name: name.to_owned(), rows, columns: 1, are_parameters: false }
    }
}

impl Block {
    pub(super) fn new(
        name: &str,
        [rows, columns]: [usize; 2],
        place: impl Fn(usize, usize) -> Option<usize>,
    ) -> Self {
        let all = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
        let entries = all.filter_map(|(row, column)| Some((row, column, place(row, column)?)));
        Self { name: name.to_owned(), rows, columns, entries: entries.collect() }
    }

    /// A column of `e` from an index on.
    pub(super) fn column(name: &str, rows: usize, start: usize) -> Self {
        Self::new(name, [rows, 1], |row, _| Some(start + row))
    }
}

impl External {
    pub(super) fn new(value: Evaluation, derivatives: Option<Derivatives>) -> Self {
        let derivatives = derivatives.map(|Derivatives { statements, size, blocks }| {
            let jacobian = Evaluation {
                name: format!("jac_{}", value.name),
                about: format!("Derivatives of `{}`.", value.name),
                inputs: with_outputs(&value),
                outputs: blocks,
                body: Body::Filled { statements, size },
            };
            let second = second_derivatives(&jacobian, value.inputs.len());
            [jacobian, second]
        });
        Self { value, derivatives }
    }
}

/// The inputs of a function's derivatives: its own, then its outputs.
fn with_outputs(evaluation: &Evaluation) -> Vec<Input> {
    let of_outputs = evaluation.outputs.iter().map(|output| {
        let name = format!("out_{}", output.name);
        Input { columns: output.columns, ..Input::new(&name, output.rows) }
    });
    evaluation.inputs.iter().cloned().chain(of_outputs).collect()
}

/// Central differences of derivatives by the first `by` inputs: no derivative depends on the outputs, which follow.
fn second_derivatives(jacobian: &Evaluation, by: usize) -> Evaluation {
    let blocks = jacobian.outputs.iter().flat_map(|output| {
        jacobian.inputs.iter().enumerate().map(move |(index, input)| {
            let is_there = index < by && !output.entries.is_empty();
            let name = format!("jac_{}_{}", output.name, input.name);
            let shape = [output.rows * output.columns, input.rows * input.columns];
            Block::new(&name, shape, |_, _| is_there.then_some(0))
        })
    });
    let entries: usize = jacobian.outputs.iter().map(|output| output.entries.len()).sum();
    let longest = jacobian.inputs[..by].iter().map(|input| input.rows).max().unwrap_or(0);
    let counts = [by, jacobian.outputs.len()];
    Evaluation {
        name: format!("jac_{}", jacobian.name),
        about: format!("Derivatives of `{}`, by central differences.", jacobian.name),
        outputs: blocks.collect(),
        body: Body::Differences { of: jacobian.name.clone(), counts, work: 2 * entries + longest },
        inputs: with_outputs(jacobian),
    }
}

/// Room of a result in `e`. Empty results also get an index of their own.
pub(super) fn room(entries: usize) -> usize {
    entries.max(1)
}

/// Computation of derivatives: statements that fill `e`, and the blocks read from it.
pub(super) struct Derivatives {
    pub(super) statements: Vec<String>,
    pub(super) size: usize,
    pub(super) blocks: Vec<Block>,
}

impl Derivatives {
    pub(super) const fn new(statements: Vec<String>) -> Self {
        Self { statements, size: VALUES, blocks: vec![] }
    }

    /// Reserves `count` values; returns the first index.
    pub(super) const fn room(&mut self, count: usize) -> usize {
        let place = self.size;
        self.size += count;
        place
    }
}

/// A result in `e`: first index, and the entries that are not always zero.
pub(super) struct Stored {
    pub(super) start: usize,
    pub(super) nonzero: Vec<bool>,
}

impl Stored {
    pub(super) fn at(&self, index: usize) -> Option<usize> {
        self.nonzero.get(index)?.then_some(self.start + index)
    }
}
