//! Stop of a running loop from another thread or by Ctrl-C.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that the loop checks in every period. Clones share the flag.
#[derive(Debug, Clone, Default)]
pub struct StopRequest(Arc<AtomicBool>);

impl StopRequest {
    /// A request that is not raised.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A request that the signals SIGINT (Ctrl-C) and SIGTERM raise. These signals then no longer end the process.
    /// Instead, the loop makes a controlled stop and engages the brakes. Further signals have no effect.
    ///
    /// # Errors
    /// [`io::Error`] if the system rejects the signal handlers.
    pub fn on_signals() -> io::Result<Self> {
        let request = Self::new();
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            signal_hook::flag::register(signal, Arc::clone(&request.0))?;
        }
        Ok(request)
    }

    /// Requests the stop.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was requested.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
