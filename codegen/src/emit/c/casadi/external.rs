//! Functions for CasADi as data: inputs, outputs, and the index of each output entry in an array of computed
//! values, which is named `e` in C.

/// A function that CasADi calls, with its derivatives.
pub(super) struct External {
    /// The C function that computes the value.
    pub(super) value: Evaluation,
    /// The C functions that compute the first and second derivatives; `None` if the module has no first
    /// derivatives.
    pub(super) derivatives: Option<[Evaluation; 2]>,
}

/// One C function that CasADi calls: a function or one of its derivatives.
pub(super) struct Evaluation {
    /// Name in C of the function that CasADi calls.
    pub(super) name: String,
    /// Description of the function that CasADi calls, for a comment.
    pub(super) about: String,
    /// Inputs of the function that CasADi calls. All of them are dense.
    pub(super) inputs: Vec<Input>,
    /// Outputs of the function that CasADi calls. They may be sparse.
    pub(super) outputs: Vec<Block>,
    /// Way in which the function computes its outputs.
    pub(super) body: Body,
}

/// Method to compute the outputs of a function.
pub(super) enum Body {
    /// Statements fill an array `e` of the given size, from index [`VALUES`] on. The outputs are entries of
    /// this array.
    Filled { statements: Vec<String>, size: usize },
    /// The outputs are central differences of another function with respect to its first inputs (second
    /// derivatives).
    Differences {
        /// Name of the function whose differences are computed.
        of: String,
        /// Number of inputs with respect to which the function is differentiated, and number of its outputs.
        counts: [usize; 2],
        /// Length of the work array in which the differences are computed.
        work: usize,
    },
}

/// An input of a function that CasADi calls.
#[derive(Clone)]
pub(super) struct Input {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Whether the input consists of the free parameters, for which the module has a struct.
    pub(super) are_parameters: bool,
}

/// An output of a function that CasADi calls. Entries that are zero in every state are left out.
pub(super) struct Block {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Row, column and index in the array `e` of computed values for each entry that can be non-zero, column
    /// by column.
    pub(super) entries: Vec<(usize, usize, usize)>,
}

/// Index of the number 1 in the array `e` of computed values.
pub(super) const ONE: usize = 0;
/// Index of the first computed value in the array `e`.
pub(super) const VALUES: usize = 1;

impl Input {
    /// An input for `count` free parameters.
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

    /// A dense column whose entries are adjacent in the array `e` of computed values, from index `start` on.
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

/// Inputs of a function's derivatives: the function's inputs, then its outputs.
fn with_outputs(evaluation: &Evaluation) -> Vec<Input> {
    let of_outputs = evaluation.outputs.iter().map(|output| {
        let name = format!("out_{}", output.name);
        Input { columns: output.columns, ..Input::new(&name, output.rows) }
    });
    evaluation.inputs.iter().cloned().chain(of_outputs).collect()
}

/// Second derivatives by central differences with respect to the first `by` inputs. All further inputs are
/// outputs of the function, and derivatives do not depend on them.
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
        about: format!("Derivatives of `{}` by central differences.", jacobian.name),
        outputs: blocks.collect(),
        body: Body::Differences { of: jacobian.name.clone(), counts, work: 2 * entries + longest },
        inputs: with_outputs(jacobian),
    }
}

/// Number of entries that a result with `entries` entries occupies in the array `e` of computed values. An
/// empty result occupies one entry.
pub(super) fn room(entries: usize) -> usize {
    entries.max(1)
}

/// Code under construction for derivatives: statements that fill an array `e`, the size of this array, and
/// the outputs that are read from it.
pub(super) struct Derivatives {
    pub(super) statements: Vec<String>,
    pub(super) size: usize,
    pub(super) blocks: Vec<Block>,
}

impl Derivatives {
    pub(super) const fn new(statements: Vec<String>) -> Self {
        Self { statements, size: VALUES, blocks: vec![] }
    }

    /// Reserves `count` entries of the array `e` of computed values and returns the first index.
    pub(super) const fn room(&mut self, count: usize) -> usize {
        let place = self.size;
        self.size += count;
        place
    }
}

/// A result in the array `e` of computed values: index of its first entry, and a flag for each entry that can
/// be non-zero.
pub(super) struct Stored {
    pub(super) start: usize,
    pub(super) nonzero: Vec<bool>,
}

impl Stored {
    pub(super) fn at(&self, index: usize) -> Option<usize> {
        self.nonzero.get(index)?.then_some(self.start + index)
    }
}
