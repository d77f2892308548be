//! Variables that several arrays use in sequence.
//!
//! Each variable is first filled with zeros. One variable per array would need 62 kB for a quadruped instead of
//! 31 kB. A first-level cache is smaller than 62 kB, so the linearization would take 7 % more time.

use crate::emit::arrays::Row;
use crate::program::arrays::Arrays;

/// Assignment of arrays over joints to variables that several arrays use one after another.
pub(super) struct SharedRows {
    /// Number of rows of each variable, and length of a row including padding.
    pub(super) sizes: Vec<[usize; 2]>,
    /// For each array, the index of its variable; `None` if the array is not a local variable.
    pub(super) of_arrays: Vec<Option<usize>>,
}

/// A variable that stores an array until the last loop that reads the array.
struct Taken {
    place: usize,
    /// Index of the last loop that reads the array in the variable.
    until: usize,
}

impl SharedRows {
    /// Assigns variables to the arrays. An array gets a variable whose current array is not read by later
    /// loops. Each array that is computed before the loops gets its own variable, because its code relies on
    /// initial zeros.
    pub(super) fn new(form: &Arrays, row: Row, is_local: impl Fn(usize) -> bool) -> Self {
        let mut shared = Self { sizes: Vec::new(), of_arrays: vec![None; form.arrays.len()] };
        let mut taken = Vec::new();
        let of_setup = (0..form.setup.outputs.len()).map(|array| (None, array));
        let of_steps = form.steps.iter().enumerate().flat_map(|(index, step)| {
            let arrays = 0..form.arrays.len();
            arrays.filter(|&array| step.writes(array)).map(move |array| (Some(index), array))
        });
        for (step, array) in of_setup.chain(of_steps).filter(|&(_, array)| is_local(array)) {
            let size = [form.arrays[array].rows, row.of(form, array)];
            let place = shared.take(size, step, &mut taken);
            taken.push(Taken { place, until: last_step(form, array).max(step.unwrap_or(0)) });
            shared.of_arrays[array] = Some(place);
        }
        shared
    }

    /// Index of a variable with this size that no array occupies during a loop, or of a new variable.
    fn take(&mut self, size: [usize; 2], step: Option<usize>, taken: &mut Vec<Taken>) -> usize {
        let is_free = |taken: &Taken| step.is_some_and(|step| taken.until < step);
        match taken.iter().position(|taken| self.sizes[taken.place] == size && is_free(taken)) {
            Some(index) => taken.swap_remove(index).place,
            None => {
                self.sizes.push(size);
                self.sizes.len() - 1
            }
        }
    }
}

/// Index of the last loop that reads an array. For a result, it is the number of loops.
fn last_step(form: &Arrays, array: usize) -> usize {
    if form.outputs.iter().any(|output| output.array == array) {
        return form.steps.len();
    }
    form.steps.iter().rposition(|step| step.reads(array)).unwrap_or(0)
}
