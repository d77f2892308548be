//! Control loop that drives a robot at a fixed rate between 50 Hz and 1 kHz.
//!
//! Each period k has these stages (T is the period, n is [`LoopSettings::hold_periods`]):
//!
//! ```text
//!        sleep until t_k = t_0 + k T (absolute time); shortly before, warm up the caches with a controller step
//!          │
//!        read ── missing, NaN, jump, frozen, velocity contradicts position ──► tolerated for n periods, then brakes
//!          │
//!        control ── fails ──► shifted plan ──► fallback law (joint PD) ──► controlled stop
//!          │
//!        check ── position, braking distance, speed or following error beyond its limit ──► brakes
//!          │      (inputs are clamped to their limits)
//!          │
//!        write ── t_{k+1} is past, so the deadline is missed ──► inputs held for n periods, then brakes
//!          │
//!        log: lock-free queue to a thread that writes CSV
//! ```
//!
//! [`ControlLoop`] connects a [`Controller`], a [`Transport`](crate::transport::Transport) and a [`Clock`].
//! [`write_a_controller`] is the guide for writing a controller. The loop itself checks limits and measurements
//! and does not rely on the controller. [`attaching_hardware`](crate::transport::attaching_hardware) lists
//! the reaction to each fault. The [`LoopReport`] counts the faults of a run.
//!
//! Speed limit, braking distance, fallback law and log use the velocities that the robot measures. The
//! [`EncoderGuard`] first compares these velocities with the positions. If the robot does not measure
//! velocities, low-pass filtered differences of positions are used ([`VelocityFilter`]).
//!
//! For real time, call [`RealtimeRequest::apply`] in the thread of the loop after all objects are
//! constructed. In tests, a [`VirtualClock`] makes a run deterministic and fast:
//!
//! ```
//! use gelenk_runtime::control_loop::{
//!     ControlLoop, End, FeedForwardPd, JointGains, JointPd, LoopSettings, VirtualClock,
//! };
//! use gelenk_runtime::plant::{Plant, PlantOptions};
//! use gelenk_runtime::trajectory::RestToRest;
//! use gelenk_runtime::transport::{Brakes, InProcess};
//!
//! gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_generated::powercube);
//!
//! let motion = RestToRest::new([0.0, 0.0], [0.2, -0.1], 1.0)?;
//! let settings = LoopSettings::for_robot(50.0, &PowerCube);
//! let law = JointPd::new(PowerCube, JointGains::from_bandwidth(&PowerCube, &[0.0; 2], 10.0, 0.7))?;
//! let controller = FeedForwardPd::new(law.clone(), motion, 0.02, 0.01)?;
//! let clock = VirtualClock::new();
//! let plant = Plant::new(PowerCube, PlantOptions::default())?;
//! let robot = InProcess::new(plant, clock.clone(), settings.period());
//!
//! let mut control = ControlLoop::new(settings, law, motion, controller, robot, clock)?;
//! let report = control.run();
//! assert_eq!(report.end, End::Finished);
//! assert_eq!(report.brakes, Brakes::Engaged);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod computed_torque;
mod controller;
#[cfg(feature = "std")]
mod decide;
mod guard;
mod joint_lqr;
mod joint_pd;
#[cfg(feature = "std")]
mod lateness;
mod law;
mod law_controller;
#[cfg(feature = "std")]
mod log;
#[cfg(feature = "std")]
mod monitor;
#[cfg(feature = "std")]
mod realtime;
#[cfg(feature = "std")]
mod reference;
#[cfg(feature = "std")]
mod report;
#[cfg(feature = "std")]
mod run;
mod settings;
mod stage;
#[cfg(feature = "std")]
mod start;
#[cfg(feature = "std")]
mod stop_request;
mod unwrapped;
mod velocity_filter;
#[cfg(feature = "std")]
mod warm_up;
pub(crate) mod zero_order_hold;
#[doc = include_str!("write_a_controller.md")]
pub mod write_a_controller {}

#[cfg(feature = "std")]
pub use crate::clock::{Clock, MonotonicClock, VirtualClock};
pub use computed_torque::{AccelerationGains, ComputedTorque, ComputedTorqueError};
pub use controller::{Command, Controller, ControllerFault, Cycle, Estimate, LearnedJoint, TooFast};
pub use guard::{EncoderFault, EncoderGuard, GuardSettings};
pub use joint_lqr::{JointLqr, JointLqrError, LqrWeights};
pub use joint_pd::{JointGains, JointPd, JointPdError};
#[cfg(feature = "std")]
pub use lateness::Lateness;
pub use law::JointLaw;
pub use law_controller::{FeedForwardPd, LawController};
#[cfg(feature = "std")]
pub use log::{LogRecord, LogSink, LogSummary, LogWriter, MAX_LOG_CAPACITY, log_to, log_to_file};
#[cfg(feature = "std")]
pub use monitor::LimitFault;
#[cfg(feature = "std")]
pub use realtime::{Grant, RealtimeReport, RealtimeRequest};
#[cfg(feature = "std")]
pub use report::{Counts, End, LoopReport, Refusal, Source, StopReason};
#[cfg(feature = "std")]
pub use run::ControlLoop;
pub use settings::{LoopSettings, RATES, SPEED_MARGIN, SettingError};
pub use stage::{STAGES, Stage};
#[cfg(feature = "std")]
pub use stop_request::StopRequest;
pub use velocity_filter::VelocityFilter;
