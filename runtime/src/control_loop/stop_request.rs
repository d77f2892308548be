//! Asking a running loop to stop: from another thread, or by Ctrl-C.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that a loop looks at once in every period. Clones share it.
#[derive(Debug, Clone, Default)]
pub struct StopRequest(Arc<AtomicBool>);

impl StopRequest {
    /// Not raised.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A request that SIGINT (Ctrl-C) and SIGTERM raise. Neither ends the process any more: the loop does,
    /// after the robot stands and its brakes are engaged. Further signals change nothing.
    ///
    /// # Errors
    /// [`io::Error`] if the system refuses the handlers.
    pub fn on_signals() -> io::Result<Self> {
        let request = Self::new();
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            signal_hook::flag::register(signal, Arc::clone(&request.0))?;
        }
        Ok(request)
    }

    /// Asks for the stop.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// True once somebody asked.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
