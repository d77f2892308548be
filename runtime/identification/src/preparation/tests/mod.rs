//! Preparation of simulated and measured logs, judged by ordinary least squares on unseen data.

mod arm;
mod contract;
mod fit;
mod measured;
mod simulated;
