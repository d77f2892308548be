//! Parts of the array form (functions as loops over joints) that all languages have in common.

use crate::program::Operand;
use crate::program::arrays::{Arrays, Coordinates, Over, Relation, Step};

/// Lengths of the rows of arrays over joints. Rows are padded to whole blocks of SIMD width.
#[derive(Clone, Copy)]
pub(super) struct Row {
    /// Number of entries of a row over joints, including padding.
    pub(super) len: usize,
    /// Number of entries of a row over coordinates, including padding. It is equal to `len` if each joint is
    /// independent.
    pub(super) coordinates: usize,
    /// Number of array entries that are computed at once in one SIMD block: 4 or 8.
    pub(super) block: usize,
    /// Whether the joints are a chain without quaternions, in which each joint is on the body of the previous
    /// joint.
    pub(super) is_chain: bool,
    /// Whether a joint follows the coordinates of other joints.
    is_coupled: bool,
}

impl Row {
    pub(super) fn new(form: &Arrays) -> Self {
        let joints = form.joints.len();
        // A long block that is half padding costs more than blocks of half the length.
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

    /// Whether a row is one block and the joints are a chain. The text of the loops is then unrolled. Other
    /// loops leave this choice to the compiler.
    pub(super) fn is_one_block(self) -> bool {
        self.is_chain && self.len == self.block && !self.is_coupled
    }

    /// Number of entries of a row of the array with this index, including padding.
    pub(super) fn of(self, form: &Arrays, array: usize) -> usize {
        match form.arrays[array].over {
            Over::Joints => self.len,
            Over::Coordinates => self.coordinates,
        }
    }
}

/// Beginning of the comment about the straight-line code that a function runs before its loops.
pub(super) fn about_setup(form: &Arrays) -> &'static str {
    match form.steps.iter().any(|step| matches!(step, Step::Map(_))) {
        true => "Poses and single joints of",
        false => "Accelerations, M⁻¹ and Jacobians of forces for",
    }
}

/// Entries of an array that is computed before the loops, if all of them are constant; otherwise `None`.
pub(super) fn table(form: &Arrays, array: usize) -> Option<Vec<f64>> {
    let output = form.setup.outputs.get(array)?;
    let constant = |entry: &Operand| match entry {
        Operand::Constant(number) => Some(*number),
        _ => None,
    };
    output.entries.iter().map(constant).collect()
}

/// Whether an array is a matrix that no loop reads, so that it can be written directly to the result.
pub(super) fn is_only_result(form: &Arrays, array: usize) -> bool {
    let is_made = |step: &Step| match step {
        Step::Pairs(pairs) => pairs.to == array,
        Step::NegativeProduct { to, .. } | Step::Project { to, .. } => *to == array,
        _ => false,
    };
    form.steps.iter().any(is_made) && !form.steps.iter().any(|step| step.reads(array))
}

/// Relation of joint j to joint i: −1 if j is on the path from i to the base, 1 if j is i or beyond i,
/// otherwise 0. For the padding entries of a row it is 0.
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

/// Returns 1 if the entry of coordinates i and j in the inverse of the mass matrix can be non-zero, otherwise
/// 0.
pub(super) fn meeting(form: &Arrays, i: usize, j: usize) -> i8 {
    let tree = form.coordinates();
    i8::from(j < tree.len() && tree.meet(i, j))
}

/// For each coordinate, the joints that follow it. The independent joint of the coordinate is first.
pub(super) fn followers(form: &Arrays) -> Vec<Vec<usize>> {
    let mut joints: Vec<Vec<usize>> = (0..form.coordinates().len()).map(|own| vec![own]).collect();
    for (joint, coordinate) in form.coordinates.iter().flat_map(Coordinates::followers) {
        joints[coordinate].push(joint);
    }
    joints
}
