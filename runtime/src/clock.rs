//! Clocks of the control loop: the monotonic clock, and a virtual clock for tests.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// A monotonic clock. Times are relative to a fixed moment in the past.
pub trait Clock {
    /// Current time.
    fn now(&self) -> Duration;

    /// Sleeps until the absolute time `wake`. Returns immediately if `wake` is in the past. With absolute times,
    /// delays do not accumulate.
    fn sleep_until(&self, wake: Duration);
}

/// The monotonic clock of the system. On Linux it reads `CLOCK_MONOTONIC` and sleeps with `clock_nanosleep`
/// until absolute times. On other systems it uses the clock of the standard library.
#[derive(Debug, Clone, Copy, Default)]
pub struct MonotonicClock;

#[cfg(target_os = "linux")]
impl Clock for MonotonicClock {
    fn now(&self) -> Duration {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        // The monotonic clock starts at 0 when the machine does.
        Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
    }

    fn sleep_until(&self, wake: Duration) {
        let request = timespec(wake);
        // A signal can end the sleep early. The sleep is then repeated with the same absolute time.
        while let Err(rustix::io::Errno::INTR) =
            rustix::thread::clock_nanosleep_absolute(rustix::thread::ClockId::Monotonic, &request)
        {}
    }
}

/// Converts a time for the system. A time beyond the range of the system becomes the last time of this range.
#[cfg(target_os = "linux")]
fn timespec(time: Duration) -> rustix::time::Timespec {
    rustix::time::Timespec {
        tv_sec: i64::try_from(time.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: time.subsec_nanos().into(),
    }
}

/// Clock for systems other than Linux. It converts the absolute time to a relative sleep of the standard library.
#[cfg(not(target_os = "linux"))]
impl Clock for MonotonicClock {
    fn now(&self) -> Duration {
        static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
        START.get_or_init(std::time::Instant::now).elapsed()
    }

    fn sleep_until(&self, wake: Duration) {
        std::thread::sleep(wake.saturating_sub(self.now()));
    }
}

/// A simulated clock. Only [`sleep_until`](Clock::sleep_until) and [`advance`](VirtualClock::advance) advance
/// its time. A loop with this clock runs as fast as possible and is deterministic. Clones share the time.
#[derive(Debug, Clone, Default)]
pub struct VirtualClock(Arc<AtomicU64>);

impl VirtualClock {
    /// A simulated clock whose time is 0.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Advances the time by `span`, to simulate a computation or a stall.
    pub fn advance(&self, span: Duration) {
        let later = |now: u64| Some(now.saturating_add(nanoseconds(span)));
        // This call cannot fail because `later` always returns a value.
        let _ = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, later);
    }
}

impl Clock for VirtualClock {
    fn now(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }

    fn sleep_until(&self, wake: Duration) {
        self.0.fetch_max(nanoseconds(wake), Ordering::Relaxed);
    }
}

/// Converts a time to nanoseconds. Times above 584 years are clamped.
fn nanoseconds(span: Duration) -> u64 {
    u64::try_from(span.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_virtual_clock_moves_when_told() {
        let clock = VirtualClock::new();
        let other = clock.clone();
        clock.sleep_until(Duration::from_millis(20));
        other.advance(Duration::from_millis(7));
        assert_eq!(clock.now(), Duration::from_millis(27));
        clock.sleep_until(Duration::from_millis(5));
        assert_eq!(other.now(), Duration::from_millis(27), "never back");
    }

    #[test]
    fn a_virtual_clock_does_not_wrap_around() {
        let clock = VirtualClock::new();
        clock.advance(Duration::from_millis(20));
        clock.advance(Duration::MAX);
        let end = clock.now();
        clock.advance(Duration::MAX);
        clock.sleep_until(Duration::MAX);
        assert_eq!(clock.now(), end);
        assert!(end > Duration::from_secs(500 * 365 * 86_400));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_end_of_time_is_not_its_beginning() {
        assert_eq!(timespec(Duration::MAX).tv_sec, i64::MAX);
        assert_eq!(timespec(Duration::from_millis(1500)).tv_sec, 1);
        assert_eq!(timespec(Duration::from_millis(1500)).tv_nsec, 500_000_000);
    }

    #[test]
    fn the_monotonic_clock_does_not_wake_early() {
        let clock = MonotonicClock;
        let wake = clock.now() + Duration::from_millis(2);
        clock.sleep_until(wake);
        assert!(clock.now() >= wake);
        clock.sleep_until(Duration::ZERO);
    }
}
