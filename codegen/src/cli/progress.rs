//! Progress messages for work that takes more than a second.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Prints a message about the current work to standard error until it is dropped: after one second, after
/// five seconds, and then every five seconds.
#[derive(Debug)]
pub(super) struct Progress {
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Progress {
    pub(super) fn start(what: String) -> Self {
        let (end, ended) = mpsc::channel();
        let report = move || {
            let (mut seconds, mut pause) = (0, 1);
            while ended.recv_timeout(Duration::from_secs(pause)) == Err(RecvTimeoutError::Timeout) {
                seconds += pause;
                pause = if seconds < 5 { 5 - seconds } else { 5 };
                super::print::err(&format!("gelenk: working on {what} for {seconds} s\n"));
            }
        };
        // Without a thread there is no progress, but the work goes on.
        let thread = thread::Builder::new().name("progress".to_owned()).spawn(report).ok();
        Self { end: Some(end), thread }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            // A panic of the progress thread is ignored.
            let _ = thread.join();
        }
    }
}
