//! Columns of the input matrix at pseudo-random states.

use crate::layout::Dimension;
use crate::model::Model;
use crate::random::Random;
use crate::self_test;
use crate::verify;

/// Relative difference below which directions, ratios and places are equal, because a description writes them
/// in decimals.
pub(super) const ROUNDING: f64 = 1e-9;

/// Number of pseudo-random states at which columns are computed.
const STATES: u64 = 16;

/// Columns of the input matrix at each pseudo-random state. An entry is a pair: its value, and a running
/// bound of its rounding error in units of the unit roundoff.
///
/// - `parameters`: values of the free parameters
pub(super) fn columns(model: &Model, parameters: &[f64]) -> Vec<Vec<Vec<[f64; 2]>>> {
    let at = |seed: u64| {
        let mut random = Random::new(seed);
        let [y, d] = [Dimension::Positions, Dimension::Driven]
            .map(|argument| self_test::entries(model, argument, &mut random));
        verify::input_columns(model, parameters, [&y, &d])
    };
    (0..STATES).map(at).collect()
}
