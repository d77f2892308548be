//! Estimates inertial parameters, friction, effort offsets and drive gains from [`PreparedRun`](super::run::PreparedRun)s in
//! one weighted linear fit.

mod blocks;
mod checks;
mod choice;
mod consistent;
mod cosines;
mod delays;
mod described;
mod estimate;
mod estimated;
mod factors;
mod fit;
mod gains;
mod gravity;
mod hypotheses;
mod intervals;
mod joint_prior;
mod layout;
pub(crate) mod levels;
mod loads;
mod margin;
mod normal;
mod orders;
mod other_delay;
mod prior;
mod report;
mod residuals;
mod result;
mod rows;
mod sensitivity;
mod settings;
mod shares;
mod signs;
mod springs;
mod sums;
mod task;
#[cfg(test)]
mod tests;
mod tilt;
mod trial;
mod under_load;
mod unit;

pub use estimate::estimate;
pub use result::{Estimate, EstimatedTerm, Gravity, JointEstimate, Offsets, Uncertain};
pub use settings::EstimationSettings;
pub(crate) use {
    blocks::{BlockSums, FRICTION, sums_of_blocks},
    described::described_ratio,
    intervals::correlation_time,
    normal::{inverse, with_ridge},
    prior::distance,
    residuals::{huber, robust_deviation},
    result::CommonTerms,
    shares::{
        Columns, JointSums, RunPiece, ShareSums, SharedData, SharedEstimate, Weighted, estimate_shares,
    },
    sums::{FEWEST_MOTIONS, Piece, repeated_motions},
};
