//! Recursive estimation of friction during motion.
//!
//! Friction changes while gears warm up. For each joint, [`Adaptation`] estimates the coefficients δ₁ … δ₅ by which the actual
//! friction τ differs from the described friction:
//!
//! ```text
//!     τ(v) = τ_d(v) + |τ_l| s₁(v) + δ₁ s(v) + δ₂ v + δ₃ + δ₄ |s(v)| + δ₅ |τ_l| s₁(v)        [`terms`]
//! ```
//!
//! - v: velocity of the joint
//! - τ_d: described friction without its load-dependent part
//! - |τ_l| s₁: described load-dependent friction. The load τ_l is the force of the drive without all friction, and s₁ is the
//!   friction per unit of load.
//! - s: shape of the friction. It is τ_d, or smooth Coulomb friction if τ_d is zero.
//!
//! The estimator needs only measured positions and torques. Each period has these steps:
//!
//! 1. **Filter.** The same low-pass filter with two poles is applied to the five terms and to the torque that the described
//!    robot does not explain (Ljung, *System Identification*, 1999, section 14.4). The torque of the inertia enters as
//!    differences of the momentum (Slotine, Li, 1987), so the filter limits the noise of the encoders.
//! 2. **Exclusion.** These samples are not used:
//!    - samples at rest
//!    - samples soon after a rest, a reversal, a gap, or a torque that is at a limit or repeats bit for bit, until the filter
//!      has settled
//!    - samples beyond four standard deviations of their prediction, for example in contact
//! 3. **Estimation.** Kalman filters for four rates of drift are weighted by their predictions (Raftery, Kárný, Ettler, 2010).
//!    The filters take into account that consecutive samples are correlated (Kish, 1965), and that friction drifts gradually
//!    (integrated Ornstein–Uhlenbeck process, 1930).
//! 4. **Average of nested laws.** The laws with the first 0, 1, … 5 terms are averaged, weighted by their marginal likelihoods
//!    (Dickey, 1971).
//! 5. **Trust.** Terms beyond their bounds are set to the bounds, and the correlated terms change with them (Simon, Chia,
//!    2002). The bounds ensure that friction dissipates energy ([`JointScale::admissible`]). The result is the *learned law*.
//!    The *acting law*, which controllers use, follows the learned law under two conditions. The prediction errors of the
//!    learned law must be smaller than those of the described law (Dawid, 1984), and the law without bounds must dissipate
//!    energy at the largest speed. Otherwise the acting law follows the described law.
//!
//! A [`LoadEstimator`] can also learn the parameters of a load from the torques that the acting law does not explain.
//!
//! `gelenk-runtime` offers the estimator as an option of the control loop (module `adaptation`). `gelenk identify --online`
//! applies the estimator to a log.
//!
//! # Limits
//!
//! - Robots with quaternions, inputs at frames or driven joints are not supported.
//! - The factor of load-dependent friction is learned only for joints with described load-dependent friction.
//! - A constant contact that lasts longer than [`AdaptationSettings::patience`] is learned as an offset.
//! - Confidence intervals do not include errors of inertia and gravity of the description.
//! - `runtime/examples/warming.rs` simulates 3000 runs with a fault (a stuck or swapped sensor, rests, gaps, saturation). In
//!   two runs, the error of the acting law was 1.05 to 1.22 times the error of the described law. In both runs, the torque
//!   sensor saturates.

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
