//! Functions as CasADi calls them: inputs, outputs, and where each entry comes from.

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
    /// Description.
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
    /// It is true for the free parameters, which the module takes as a struct.
    pub(super) are_parameters: bool,
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
    /// The free parameters.
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

    /// A column from a place on.
    pub(super) fn column(name: &str, rows: usize, start: usize) -> Self {
        Self::new(name, [rows, 1], |row, _| Some(start + row))
    }
}

impl External {
    pub(super) fn new(value: Evaluation, derivatives: Option<Derivatives>) -> Self {
        let of_outputs = value.outputs.iter().map(|output| {
            let name = format!("out_{}", output.name);
            Input { columns: output.columns, ..Input::new(&name, output.rows) }
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
pub(super) fn room(entries: usize) -> usize {
    entries.max(1)
}

/// How derivatives are computed: statements that fill `e`, and the blocks that are taken from it.
pub(super) struct Derivatives {
    pub(super) statements: Vec<String>,
    pub(super) size: usize,
    pub(super) blocks: Vec<Block>,
}

impl Derivatives {
    pub(super) const fn new(statements: Vec<String>) -> Self {
        Self { statements, size: VALUES, blocks: vec![] }
    }

    /// Reserves room for `count` values.
    pub(super) const fn room(&mut self, count: usize) -> usize {
        let place = self.size;
        self.size += count;
        place
    }
}

/// A result in `e`: where it begins, and which entries are not zero in every state.
pub(super) struct Stored {
    pub(super) start: usize,
    pub(super) nonzero: Vec<bool>,
}

impl Stored {
    pub(super) fn at(&self, index: usize) -> Option<usize> {
        self.nonzero.get(index)?.then_some(self.start + index)
    }
}
