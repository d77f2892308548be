//! The loop that drives a robot at a fixed rate.

mod clock;
mod controller;
mod decide;
mod feed_forward_pd;
mod guard;
mod log;
mod monitor;
mod realtime;
mod reference;
mod report;
mod run;
mod settings;
mod stop_request;

pub use clock::{Clock, MonotonicClock, VirtualClock};
pub use controller::{Command, Controller, ControllerFault, Cycle, Estimate};
pub use feed_forward_pd::{FeedForwardPd, JointGains, JointPd};
pub use guard::{EncoderFault, EncoderGuard, GuardSettings};
pub use log::{LogRecord, LogSink, LogSummary, LogWriter, log_to, log_to_file};
pub use monitor::LimitFault;
pub use realtime::{Grant, RealtimeReport, RealtimeRequest};
pub use report::{Counts, End, LoopReport, Refusal, STAGES, Source, Stage, StopReason};
pub use run::ControlLoop;
pub use settings::{LoopSettings, RATES, SettingError};
pub use stop_request::StopRequest;
