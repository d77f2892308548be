//! Doubts about data and model, as sentences with remedies.

use super::super::error::Result;
use super::layout::Layout;
use super::sums::Sums;

/// Gains with which the described rigid force has the size of the measured effort.
pub(super) fn first_gains(layout: &Layout, sums: &Sums) -> Result<Vec<f64>> {
    let gain = |joint: usize| {
        let products =
            super::normal::Centred::new(layout, sums, super::normal::Offsets::Common).all[joint].clone();
        let q = products.nrows();
        let (rigid, both, z) = (products[(q - 2, q - 2)], products[(q - 2, q - 1)], products[(q - 1, q - 1)]);
        if both != 0.0 { both.signum() * (rigid / z).sqrt() } else { 1.0 }
    };
    Ok((0..layout.joints).map(gain).collect())
}
