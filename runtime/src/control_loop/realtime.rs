//! Requests for real-time scheduling and locked memory.

use std::fmt;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
};

/// Answer of the operating system to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Grant {
    /// The request was granted.
    Granted,
    /// No request was made.
    NotRequested,
    /// The system rejected the request for this reason.
    Refused(String),
}

impl fmt::Display for Grant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Granted => write!(f, "granted"),
            Self::NotRequested => write!(f, "not requested"),
            Self::Refused(reason) => write!(f, "refused: {reason}"),
        }
    }
}

/// Real-time requests to the operating system for the thread of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RealtimeRequest {
    /// Priority 1 to 98 of the real-time scheduler `SCHED_FIFO`; `None` for the usual scheduling.
    pub priority: Option<u8>,
    /// Whether all memory of the process is kept in RAM.
    pub lock_memory: bool,
}

impl Default for RealtimeRequest {
    /// Priority 80 and locked memory. This priority is above the interrupt threads of disks and network cards
    /// (50) and below the threads of the kernel.
    fn default() -> Self {
        Self { priority: Some(80), lock_memory: true }
    }
}

/// Results of the requests. Show this report to the operator: without real-time scheduling the loop runs, but
/// misses deadlines on a busy machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RealtimeReport {
    /// Result of the request for `SCHED_FIFO` for the calling thread.
    pub scheduling: Grant,
    /// Result of the request for locked memory of the process.
    pub memory: Grant,
}

impl fmt::Display for RealtimeReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SCHED_FIFO {}; locked memory {}", self.scheduling, self.memory)
    }
}

impl RealtimeRequest {
    /// Makes both requests for the calling thread. Call this method in the thread of the loop after all objects
    /// are constructed and all threads are started. Threads that are started later inherit the priority. Only
    /// memory that is already allocated is locked, and the loop allocates no other memory.
    ///
    /// The process needs the capabilities `CAP_SYS_NICE` and `CAP_IPC_LOCK`, or sufficient limits `rtprio` and
    /// `memlock` in `/etc/security/limits.conf`.
    #[must_use]
    pub fn apply(&self) -> RealtimeReport {
        RealtimeReport {
            scheduling: self.priority.map_or(Grant::NotRequested, request_scheduling),
            memory: if self.lock_memory { lock_memory() } else { Grant::NotRequested },
        }
    }
}

#[cfg(target_os = "linux")]
fn request_scheduling(priority: u8) -> Grant {
    // The crate rejects 99, which the kernel uses for its watchdogs.
    let Ok(value) = ThreadPriorityValue::try_from(priority) else {
        return Grant::Refused(format!("the priority is {priority}, but must be 1 to 98"));
    };
    if !(1..=98).contains(&priority) {
        return Grant::Refused(format!("the priority is {priority}, but must be 1 to 98"));
    }
    let granted = thread_priority::set_thread_priority_and_policy(
        thread_priority::thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    );
    match granted {
        Ok(()) => Grant::Granted,
        Err(thread_priority::Error::OS(code)) => {
            Grant::Refused(std::io::Error::from_raw_os_error(code).to_string())
        }
        Err(e) => Grant::Refused(format!("{e:?}")),
    }
}

#[cfg(not(target_os = "linux"))]
fn request_scheduling(_: u8) -> Grant {
    Grant::Refused("available only on Linux".into())
}

/// Locks the allocated memory with `MCL_CURRENT`. If `MCL_FUTURE` were used and the limit were small, the first
/// allocation of another thread would end the process.
#[cfg(target_os = "linux")]
fn lock_memory() -> Grant {
    match rustix::mm::mlockall(rustix::mm::MlockAllFlags::CURRENT) {
        Ok(()) => Grant::Granted,
        Err(e) => Grant::Refused(std::io::Error::from(e).to_string()),
    }
}

#[cfg(not(target_os = "linux"))]
fn lock_memory() -> Grant {
    Grant::Refused("available only on Linux".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_says_what_was_granted() {
        let request = RealtimeRequest { priority: None, lock_memory: false };
        assert_eq!(request.apply().to_string(), "SCHED_FIFO not requested; locked memory not requested");
    }

    /// Runs in a separate thread, so that other tests do not inherit the priority.
    #[test]
    fn a_request_ends_in_a_grant_or_a_reason() {
        let report = std::thread::spawn(|| {
            let priority = Some(10);
            RealtimeRequest { priority, lock_memory: false }.apply()
        })
        .join()
        .unwrap();
        match report.scheduling {
            Grant::Granted => {}
            Grant::Refused(reason) => assert!(!reason.is_empty()),
            Grant::NotRequested => panic!("it was requested"),
        }
    }

    #[test]
    fn a_priority_out_of_range_is_refused() {
        let report = RealtimeRequest { priority: Some(100), lock_memory: false }.apply();
        assert_eq!(report.scheduling, Grant::Refused("the priority is 100, but must be 1 to 98".into()));
    }
}
