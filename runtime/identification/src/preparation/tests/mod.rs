//! The preparation on simulated and on measured logs, judged by plain least squares on unseen data.

mod arm;
mod contract;
mod fit;
mod measured;
mod simulated;
