//! Recursive estimation of friction during motion.
//!
//! Friction changes while gears warm up. [`Adaptation`] estimates the difference from the described friction
//! τ_d for each joint,
//!
//! ```text
//!     τ(v) = τ_d(v) + |τ_l| s₁(v) + δ₁ s(v) + δ₂ v + δ₃ + δ₄ |s(v)| + δ₅ |τ_l| s₁(v)        [`terms`]
//! ```
//!
//! from positions and torques alone. Each period it goes through these steps, in the order of the files:
//!
//! 1. **Filter.** The torque that the described robot does not explain and the five terms pass the same two poles (Ljung, *System
//!    Identification*, 1999, section 14.4). The inertia enters as differences of the momentum (Slotine, Li, 1987), so the filter limits
//!    what noise of the encoders adds.
//! 2. **Exclusion.** A sample is left out at rest, within the filter's memory of a rest, a reversal, a gap, a limit of the torque or
//!    a torque that has repeated bit for bit, and beyond four standard deviations of its prediction, as in contact.
//! 3. **Estimation.** Kalman filters for three rates of drift, weighted by their predictions (Raftery, Kárný, Ettler, 2010), with the
//!    number of correlated samples that count as one (Kish, 1965).
//! 4. **Average of nested laws**, from the described law on, by their marginal likelihoods (Dickey, 1971).
//! 5. **Trust.** Terms beyond their bounds are conditioned on them (Simon, Chia, 2002), so that the law dissipates
//!    ([`JointScale::admissible`]). The learned law acts while its prediction errors are smaller than the described law's (Dawid, 1984),
//!    and the law without bounds dissipates at the largest speed.
//!
//! On request a [`LoadEstimator`] learns the parameters of a load from the torques that the acting friction leaves.
//!
//! `gelenk-runtime` makes it an option of the loop under the same name, and `gelenk identify --online` replays a log.
//!
//! # Limits
//!
//! - Robots with quaternions, inputs at frames or driven joints are not supported.
//! - The factor of load-dependent friction is learned only for joints with described load-dependent friction.
//! - A constant contact that lasts longer than [`AdaptationSettings::patience`] is learned as an offset.
//! - Intervals do not include errors of inertia and gravity of the description.
//! - In two of 3000 simulated runs with a fault (a stuck or swapped sensor, rests, gaps, saturation; `runtime/examples/warming.rs`),
//!   the acting law had more than 1.05 times the error of the described law, at most 1.20 times. In both, the torque sensor saturates.

#![no_std]
#![warn(unreachable_pub)]

mod bank;
mod correlation;
mod estimator;
mod filter;
mod inputs;
mod joint;
mod law;
mod load;
mod nested;
mod persistent;
mod settings;
mod trust;

pub use estimator::{Adaptation, DescribedForces, JointState, Magnitudes, Measured, TermState};
pub use inputs::input_inverse;
pub use joint::Prediction;
pub use law::{JointScale, TERM_NAMES, TERMS, terms};
pub use load::{LoadEstimator, LoadState};
pub use settings::{AdaptationError, AdaptationSettings, MOST_DELAY};
pub use trust::Trust;
