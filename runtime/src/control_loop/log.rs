//! The log: a lock-free queue from the loop to a thread that writes CSV.

use super::report::Source;
use rtrb::{Consumer, Producer, RingBuffer};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long the writer sleeps when there is nothing to write. The loop never wakes it: that would be a system call.
const IDLE: Duration = Duration::from_millis(5);

/// One period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogRecord<const N: usize, const M: usize> {
    /// Time since the trajectory began, by the clock, which goes on while a stop slows the trajectory down (s).
    pub time: f64,
    /// Positions as read, also where they were not believed [rad or m]; NaN where nothing arrived.
    pub positions: [f64; N],
    /// Estimated velocities: the controller's, or else the loop's [rad/s or m/s].
    pub velocities: [f64; N],
    /// Desired positions [rad or m].
    pub desired: [f64; N],
    /// Inputs that the robot has from now on, in their units.
    pub inputs: [f64; M],
    /// Where they came from.
    pub source: Source,
    /// True if the reading was believed.
    pub believed: bool,
    /// Iterations of the controller's optimizer.
    pub iterations: u32,
    /// Lateness of the wake-up (ns).
    pub lateness: u64,
    /// Time of read, control, check and write (ns).
    pub stages: [u64; 4],
}

/// The loop's end of the log.
#[derive(Debug)]
pub struct LogSink<const N: usize, const M: usize> {
    producer: Producer<LogRecord<N, M>>,
    dropped: Arc<AtomicU64>,
}

impl<const N: usize, const M: usize> LogSink<N, M> {
    /// Hands a record over; never waits. Where the queue is full, the record is dropped and counted.
    pub fn push(&mut self, record: LogRecord<N, M>) {
        if self.producer.push(record).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// What was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogSummary {
    /// Records in the file.
    pub written: u64,
    /// Records that found the queue full.
    pub dropped: u64,
}

/// The writer's end of the log.
#[derive(Debug)]
pub struct LogWriter {
    thread: JoinHandle<io::Result<u64>>,
    dropped: Arc<AtomicU64>,
}

impl LogWriter {
    /// Waits until everything is in the file. Drop the loop (and with it its [`LogSink`]) first.
    ///
    /// # Errors
    /// [`io::Error`] of the file.
    pub fn finish(self) -> io::Result<LogSummary> {
        let written = self
            .thread
            .join()
            .map_err(|_| io::Error::other("the log's writer panicked"))??;
        Ok(LogSummary {
            written,
            dropped: self.dropped.load(Ordering::Relaxed),
        })
    }
}

/// A log into a CSV file, for `capacity` records between two looks of the writer (every 5 ms; 1000 is plenty). Call it
/// before real-time scheduling is requested, so that the writer does not inherit it.
///
/// Columns, with 1-based numbers: `time`, `q1…` (positions as read, NaN where nothing arrived), `dq1…` (estimated velocities),
/// `desired1…`, `u1…`, `source`, `believed`, `iterations`, `lateness_ns`, `read_ns`, `control_ns`, `check_ns`, `write_ns`.
///
/// # Errors
/// [`io::Error`] where the file cannot be made or no thread can be started.
pub fn log_to_file<const N: usize, const M: usize>(
    path: &Path,
    capacity: usize,
) -> io::Result<(LogSink<N, M>, LogWriter)> {
    log_to(BufWriter::new(File::create(path)?), capacity)
}

/// As [`log_to_file`], into anything that can be written to.
///
/// # Errors
/// [`io::Error`] where no thread can be started.
pub fn log_to<const N: usize, const M: usize>(
    output: impl Write + Send + 'static,
    capacity: usize,
) -> io::Result<(LogSink<N, M>, LogWriter)> {
    let (producer, consumer) = RingBuffer::new(capacity.max(1));
    let dropped = Arc::new(AtomicU64::new(0));
    let thread = std::thread::Builder::new()
        .name("loop-log".into())
        .spawn(move || write_all(consumer, csv::Writer::from_writer(output)))?;
    let sink = LogSink {
        producer,
        dropped: Arc::clone(&dropped),
    };
    Ok((sink, LogWriter { thread, dropped }))
}

fn write_all<const N: usize, const M: usize>(
    mut records: Consumer<LogRecord<N, M>>,
    mut output: csv::Writer<impl Write>,
) -> io::Result<u64> {
    output.write_record(header::<N, M>())?;
    let mut written = 0;
    loop {
        // Asked before the queue is emptied: what was pushed before the sink was dropped is then still found.
        let last = records.is_abandoned();
        while let Ok(record) = records.pop() {
            output.write_record(fields(&record))?;
            written += 1;
        }
        if last {
            output.flush()?;
            return Ok(written);
        }
        std::thread::sleep(IDLE);
    }
}

fn header<const N: usize, const M: usize>() -> impl Iterator<Item = String> {
    let numbered = |name: &'static str, n: usize| (1..=n).map(move |i| format!("{name}{i}"));
    let rest = [
        "source",
        "believed",
        "iterations",
        "lateness_ns",
        "read_ns",
        "control_ns",
        "check_ns",
        "write_ns",
    ];
    std::iter::once("time".to_owned())
        .chain(numbered("q", N))
        .chain(numbered("dq", N))
        .chain(numbered("desired", N))
        .chain(numbered("u", M))
        .chain(rest.into_iter().map(str::to_owned))
}

fn fields<const N: usize, const M: usize>(
    record: &LogRecord<N, M>,
) -> impl Iterator<Item = String> {
    let numbers = std::iter::once(record.time)
        .chain(record.positions)
        .chain(record.velocities)
        .chain(record.desired)
        .chain(record.inputs);
    numbers
        .map(|x| x.to_string())
        .chain([
            record.source.name().to_owned(),
            u8::from(record.believed).to_string(),
            record.iterations.to_string(),
            record.lateness.to_string(),
        ])
        .chain(record.stages.map(|x| x.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn record(time: f64) -> LogRecord<2, 1> {
        LogRecord {
            time,
            positions: [0.25, f64::NAN],
            velocities: [0.0, -1.5],
            desired: [0.5, 0.1],
            inputs: [0.125],
            source: Source::Held,
            believed: false,
            iterations: 7,
            lateness: 1,
            stages: [2, 3, 4, 5],
        }
    }

    #[test]
    fn what_is_pushed_is_written_in_order() {
        let text = Shared::default();
        let (mut sink, writer) = log_to::<2, 1>(text.clone(), 8).unwrap();
        sink.push(record(0.0));
        sink.push(record(0.02));
        drop(sink);
        let summary = writer.finish().unwrap();
        assert_eq!((summary.written, summary.dropped), (2, 0));
        let text = String::from_utf8(text.0.lock().unwrap().clone()).unwrap();
        assert_eq!(
            text,
            "time,q1,q2,dq1,dq2,desired1,desired2,u1,source,believed,iterations,lateness_ns,read_ns,control_ns,check_ns,write_ns\n\
             0,0.25,NaN,0,-1.5,0.5,0.1,0.125,held,0,7,1,2,3,4,5\n\
             0.02,0.25,NaN,0,-1.5,0.5,0.1,0.125,held,0,7,1,2,3,4,5\n"
        );
    }

    #[test]
    fn a_full_queue_drops_and_counts() {
        let (producer, mut consumer) = RingBuffer::new(2);
        let dropped = Arc::new(AtomicU64::new(0));
        let mut sink = LogSink { producer, dropped };
        for k in 0..5 {
            sink.push(record(f64::from(k)));
        }
        assert_eq!(sink.dropped.load(Ordering::Relaxed), 3);
        assert_eq!(consumer.pop().unwrap().time, 0.0, "the oldest stay");
    }
}
