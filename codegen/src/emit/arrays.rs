//! Array form: parts common to all languages.

use crate::program::Operand;
use crate::program::arrays::{Arrays, Coordinates, Over, Relation, Step};

/// Length of an array row with one entry per joint. The row is padded to whole blocks of SIMD width.
#[derive(Clone, Copy)]
pub(super) struct Row {
    /// Entries including padding.
    pub(super) len: usize,
    /// Entries of a row over coordinates; equal to `len` if each joint is a coordinate.
    pub(super) coordinates: usize,
    /// Entries of a block.
    pub(super) block: usize,
    /// Whether each joint except the first follows the previous one, and none has a quaternion.
    pub(super) is_chain: bool,
    /// Whether joints follow the coordinates of other joints.
    is_coupled: bool,
}

impl Row {
    pub(super) fn new(form: &Arrays) -> Self {
        let joints = form.joints.len();
        // Half a block of padding costs more than blocks of half the length.
        let block = match joints.next_multiple_of(4) < joints.next_multiple_of(8) {
            true => 4,
            false => 8,
        };
        Self {
            len: joints.next_multiple_of(block),
            coordinates: form.coordinates().len().next_multiple_of(block),
            block,
            is_chain: form.is_chain(),
            is_coupled: form.coordinates.is_some(),
        }
    }

    /// Whether the loops are those for chains in one block. These loops are written out; other loops leave
    /// choices to the compiler.
    pub(super) fn is_one_block(self) -> bool {
        self.is_chain && self.len == self.block && !self.is_coupled
    }

    /// Entries of a row of an array, including padding.
    pub(super) fn of(self, form: &Arrays, array: usize) -> usize {
        match form.arrays[array].over {
            Over::Joints => self.len,
            Over::Coordinates => self.coordinates,
        }
    }
}

/// Beginning of the sentence about a function's setup.
pub(super) fn about_setup(form: &Arrays) -> &'static str {
    match form.steps.iter().any(|step| matches!(step, Step::Map(_))) {
        true => "Poses and single joints of",
        false => "Accelerations, M⁻¹ and Jacobians of forces for",
    }
}

/// Entries of a constant array.
pub(super) fn table(form: &Arrays, array: usize) -> Option<Vec<f64>> {
    let output = form.setup.outputs.get(array)?;
    let constant = |entry: &Operand| match entry {
        Operand::Constant(number) => Some(*number),
        _ => None,
    };
    output.entries.iter().map(constant).collect()
}

/// Whether an array is a matrix used only as result, so that it can be written in place.
pub(super) fn is_only_result(form: &Arrays, array: usize) -> bool {
    let is_made = |step: &Step| match step {
        Step::Pairs(pairs) => pairs.to == array,
        Step::NegativeProduct { to, .. } | Step::Project { to, .. } => *to == array,
        _ => false,
    };
    form.steps.iter().any(is_made) && !form.steps.iter().any(|step| step.reads(array))
}

/// Relation of joint j to joint i: −1 before it on its path to the base, 1 beyond it or the same, else 0; 0
/// beyond the last joint of a row.
pub(super) fn relation(form: &Arrays, i: usize, j: usize) -> i8 {
    if j >= form.joints.len() {
        return 0;
    }
    match form.relation(i, j) {
        Relation::Before => -1,
        Relation::Same | Relation::Beyond => 1,
        Relation::Apart => 0,
    }
}

/// Whether the entry of two coordinates in the inverse of the mass matrix can be non-zero: 1 or 0.
pub(super) fn meeting(form: &Arrays, i: usize, j: usize) -> i8 {
    let tree = form.coordinates();
    i8::from(j < tree.len() && tree.meet(i, j))
}

/// Joints that follow each coordinate; its own joint is first.
pub(super) fn followers(form: &Arrays) -> Vec<Vec<usize>> {
    let mut joints: Vec<Vec<usize>> = (0..form.coordinates().len()).map(|own| vec![own]).collect();
    for (joint, coordinate) in form.coordinates.iter().flat_map(Coordinates::followers) {
        joints[coordinate].push(joint);
    }
    joints
}
