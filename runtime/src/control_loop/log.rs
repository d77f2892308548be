//! The log: a lock-free queue from the control loop to a thread that writes CSV.

use super::report::Source;
use crate::dynamics::Dynamics;
use gelenk_adaptation::Trust;
use rtrb::{Consumer, Producer, RingBuffer};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time for which the writer sleeps if the queue is empty. The loop never wakes the writer, because this
/// would be a system call.
const IDLE: Duration = Duration::from_millis(5);

/// Log record of one period of the control loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogRecord<const N: usize, const M: usize, const NY: usize = N> {
    /// Time since the start of the trajectory (s) on the clock of the loop. A controlled stop, which slows the
    /// trajectory down, does not change this time.
    pub time: f64,
    /// Measured positions [rad or m], also if they are implausible; NaN if no reading arrived.
    pub positions: [f64; NY],
    /// Estimated velocities [rad/s or m/s]. The source is the controller, or the loop if the controller has no
    /// estimator.
    pub velocities: [f64; N],
    /// Measured velocities [rad/s or m/s]; NaN if no reading arrived; `None` in all records if the robot does
    /// not measure velocities.
    pub measured_velocities: Option<[f64; N]>,
    /// Measured drive forces at the joints [N m or N]; NaN if no reading arrived; `None` in all records if the
    /// robot does not measure forces.
    pub measured_torques: Option<[f64; N]>,
    /// Desired positions [rad or m].
    pub desired: [f64; NY],
    /// Inputs that act from now on [N m, N or A].
    pub inputs: [f64; M],
    /// Source of the inputs.
    pub source: Source,
    /// Whether the reading was plausible.
    pub believed: bool,
    /// Iterations of the controller's optimizer.
    pub iterations: u32,
    /// Lateness of the wake-up (ns).
    pub lateness: u64,
    /// Times for reading, control, check and writing (ns).
    pub stages: [u64; 4],
    /// Learned friction [N m or N] at `velocities`, the half width [N m or N] of its 90 % confidence interval, and the
    /// acting law; `None` for joints whose friction is not learned.
    pub learned: [Option<([f64; 2], Trust)>; N],
}

/// End of the queue at which the loop adds records.
#[derive(Debug)]
pub struct LogSink<const N: usize, const M: usize, const NY: usize = N> {
    producer: Producer<LogRecord<N, M, NY>>,
    dropped: Arc<AtomicU64>,
}

impl<const N: usize, const M: usize, const NY: usize> LogSink<N, M, NY> {
    /// Adds a record without waiting. If the queue is full, the record is dropped and counted.
    pub fn push(&mut self, record: LogRecord<N, M, NY>) {
        if self.producer.push(record).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Number of written and dropped records of a complete log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogSummary {
    /// Number of records in the file.
    pub written: u64,
    /// Number of records that were dropped because the queue was full.
    pub dropped: u64,
}

/// Handle of the thread that writes the log.
#[derive(Debug)]
pub struct LogWriter {
    thread: JoinHandle<io::Result<u64>>,
    dropped: Arc<AtomicU64>,
}

impl LogWriter {
    /// Waits until all records are in the file. Drop the loop, and with it its [`LogSink`], before this call.
    ///
    /// # Errors
    /// [`io::Error`] if the file cannot be written.
    pub fn finish(self) -> io::Result<LogSummary> {
        let written = self.thread.join().map_err(|_| io::Error::other("the log's writer panicked"))??;
        Ok(LogSummary { written, dropped: self.dropped.load(Ordering::Relaxed) })
    }
}

/// Largest capacity of the queue. Its memory is allocated at the start.
pub const MAX_LOG_CAPACITY: usize = 1 << 20;

/// Creates a log in a CSV file and starts the thread that writes it. The queue holds `capacity` records. The
/// thread empties the queue every 5 ms, so 1000 records are enough. Call this function before you request
/// real-time scheduling, so that the thread does not inherit the priority.
///
/// `NAME` is the name of a joint or input of `model`. The columns are:
///
/// - `time`
/// - `q_NAME` …: measured positions, NaN without a reading
/// - `dq_NAME` …: estimated velocities
/// - `measured_dq_NAME` …, `measured_tau_NAME` …: measured velocities and forces, if the robot measures them
/// - `desired_NAME` …: desired positions
/// - `u_NAME` …: inputs
/// - `learned_NAME` …, `half_width_NAME` …, `trust_NAME` …: learned friction at the estimated velocity, half
///   width of its 90 % confidence interval, and the acting law, if any friction is learned
/// - `source`, `believed`, `iterations`, `lateness_ns`, `read_ns`, `control_ns`, `check_ns`, `write_ns`
///
/// [`LogRecord`] has the units. `q` and `desired` have one column for each position entry. Robots with
/// quaternions have more positions than velocities. Names with commas or quotation marks are quoted.
///
/// # Errors
/// [`io::Error`] if the file cannot be created or no thread can be started, or if the capacity is 0 or above
/// [`MAX_LOG_CAPACITY`].
pub fn log_to_file<const N: usize, const M: usize, const NY: usize>(
    path: &Path,
    model: &impl Dynamics<N, M, NY>,
    capacity: usize,
) -> io::Result<(LogSink<N, M, NY>, LogWriter)> {
    check_capacity(capacity)?;
    log_to(BufWriter::new(File::create(path)?), model, capacity)
}

/// Creates a log like [`log_to_file`], but for any writer instead of a file.
///
/// # Errors
/// [`io::Error`] if no thread can be started, or if the capacity is 0 or above [`MAX_LOG_CAPACITY`].
pub fn log_to<const N: usize, const M: usize, const NY: usize>(
    output: impl Write + Send + 'static,
    model: &impl Dynamics<N, M, NY>,
    capacity: usize,
) -> io::Result<(LogSink<N, M, NY>, LogWriter)> {
    start(output, (model.position_names(), model.joint_names(), model.input_names()), capacity)
}

fn start<const N: usize, const M: usize, const NY: usize>(
    output: impl Write + Send + 'static,
    names: Names<N, M, NY>,
    capacity: usize,
) -> io::Result<(LogSink<N, M, NY>, LogWriter)> {
    check_capacity(capacity)?;
    let (producer, consumer) = RingBuffer::new(capacity);
    let dropped = Arc::new(AtomicU64::new(0));
    let thread = std::thread::Builder::new()
        .name("loop-log".into())
        .spawn(move || write_all(consumer, &names, csv::Writer::from_writer(output)))?;
    let sink = LogSink { producer, dropped: Arc::clone(&dropped) };
    Ok((sink, LogWriter { thread, dropped }))
}

fn check_capacity(capacity: usize) -> io::Result<()> {
    if (1..=MAX_LOG_CAPACITY).contains(&capacity) {
        return Ok(());
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        format!("the log's capacity is {capacity} records, but must be 1 to {MAX_LOG_CAPACITY}"),
    ))
}

/// Names of positions, joints and inputs.
type Names<const N: usize, const M: usize, const NY: usize> =
    ([&'static str; NY], [&'static str; N], [&'static str; M]);

fn write_all<const N: usize, const M: usize, const NY: usize>(
    mut records: Consumer<LogRecord<N, M, NY>>,
    names: &Names<N, M, NY>,
    mut output: csv::Writer<impl Write>,
) -> io::Result<u64> {
    let mut written = 0;
    // The first record determines the columns.
    let mut measures = None;
    loop {
        // Checked before the queue is emptied, so records that were pushed before the sink was dropped are written.
        let last = records.is_abandoned();
        while let Ok(record) = records.pop() {
            let shown = Measures::of(&record);
            let columns = *measures.get_or_insert(shown);
            if written == 0 {
                output.write_record(header(names, columns))?;
            }
            output.write_record(fields(&record, columns))?;
            written += 1;
        }
        if last {
            if measures.is_none() {
                output.write_record(header(names, Measures::default()))?;
            }
            output.flush()?;
            return Ok(written);
        }
        std::thread::sleep(IDLE);
    }
}

/// Measured velocities and forces of the log.
#[derive(Clone, Copy, Default)]
struct Measures {
    velocities: bool,
    torques: bool,
    learned: bool,
}

impl Measures {
    fn of<const N: usize, const M: usize, const NY: usize>(record: &LogRecord<N, M, NY>) -> Self {
        Self {
            velocities: record.measured_velocities.is_some(),
            torques: record.measured_torques.is_some(),
            learned: record.learned.iter().any(Option::is_some),
        }
    }
}

fn header<const N: usize, const M: usize, const NY: usize>(
    (positions, joints, inputs): &Names<N, M, NY>,
    measures: Measures,
) -> Vec<String> {
    let rest =
        ["source", "believed", "iterations", "lateness_ns", "read_ns", "control_ns", "check_ns", "write_ns"];
    let mut header = vec!["time".to_owned()];
    let mut add = |prefix: &str, names: &[&str]| {
        header.extend(names.iter().map(|name| format!("{prefix}_{name}")));
    };
    add("q", positions);
    add("dq", joints);
    if measures.velocities {
        add("measured_dq", joints);
    }
    if measures.torques {
        add("measured_tau", joints);
    }
    add("desired", positions);
    add("u", inputs);
    if measures.learned {
        ["learned", "half_width", "trust"].into_iter().for_each(|prefix| add(prefix, joints));
    }
    header.extend(rest.map(str::to_owned));
    header
}

fn fields<const N: usize, const M: usize, const NY: usize>(
    record: &LogRecord<N, M, NY>,
    measures: Measures,
) -> impl Iterator<Item = String> {
    // The number of fields is that of the header, for every record.
    let column = |measured: bool, values: Option<[f64; N]>| {
        measured.then(|| values.unwrap_or([f64::NAN; N])).into_iter().flatten()
    };
    let learned = |k: usize| record.learned.map(|joint| joint.map_or(f64::NAN, |(friction, _)| friction[k]));
    let trust = record.learned.map(|joint| joint.map_or("", |(_, trust)| trust.name()).to_owned());
    let numbers = std::iter::once(record.time)
        .chain(record.positions)
        .chain(record.velocities)
        .chain(column(measures.velocities, record.measured_velocities))
        .chain(column(measures.torques, record.measured_torques))
        .chain(record.desired)
        .chain(record.inputs)
        .chain(column(measures.learned, Some(learned(0))))
        .chain(column(measures.learned, Some(learned(1))));
    numbers
        .map(|x| x.to_string())
        .chain(measures.learned.then_some(trust).into_iter().flatten())
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

    /// Names of two joints and one input. One name contains quotation marks and a comma.
    const NAMES: Names<2, 1, 2> = (["beta", "left \"arm\", upper"], ["beta", "left \"arm\", upper"], ["1"]);

    fn record(time: f64) -> LogRecord<2, 1> {
        LogRecord {
            time,
            positions: [0.25, f64::NAN],
            velocities: [0.0, -1.5],
            measured_velocities: None,
            measured_torques: None,
            desired: [0.5, 0.1],
            inputs: [0.125],
            source: Source::Held,
            believed: false,
            iterations: 7,
            lateness: 1,
            stages: [2, 3, 4, 5],
            learned: [None; 2],
        }
    }

    fn written(records: &[LogRecord<2, 1>]) -> String {
        let text = Shared::default();
        let (mut sink, writer) = start(text.clone(), NAMES, 8).unwrap();
        records.iter().for_each(|record| sink.push(*record));
        drop(sink);
        let summary = writer.finish().unwrap();
        assert_eq!((summary.written, summary.dropped), (records.len() as u64, 0));
        let bytes = text.0.lock().unwrap().clone();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn what_is_pushed_is_written_in_order() {
        let header = "time,q_beta,\"q_left \"\"arm\"\", upper\",dq_beta,\"dq_left \"\"arm\"\", upper\",\
                      desired_beta,\"desired_left \"\"arm\"\", upper\",u_1,\
                      source,believed,iterations,lateness_ns,read_ns,control_ns,check_ns,write_ns\n";
        assert_eq!(
            written(&[record(0.0), record(0.02)]),
            format!(
                "{header}0,0.25,NaN,0,-1.5,0.5,0.1,0.125,held,0,7,1,2,3,4,5\n\
                 0.02,0.25,NaN,0,-1.5,0.5,0.1,0.125,held,0,7,1,2,3,4,5\n"
            )
        );
        assert_eq!(written(&[]), header, "a log without records has its head");
    }

    #[test]
    fn what_the_robot_measures_has_columns() {
        let measured = LogRecord {
            measured_velocities: Some([0.1, 0.2]),
            measured_torques: Some([3.0, f64::NAN]),
            ..record(0.0)
        };
        // A record with other measured quantities than the first has the same columns.
        let text = written(&[measured, record(0.02)]);
        let rows: Vec<&str> = text.lines().collect();
        assert!(rows[0].contains(",measured_dq_beta,"), "{text}");
        assert!(rows[0].contains(",measured_tau_beta,"), "{text}");
        assert!(rows[1].starts_with("0,0.25,NaN,0,-1.5,0.1,0.2,3,NaN,0.5,"));
        assert!(rows[2].starts_with("0.02,0.25,NaN,0,-1.5,NaN,NaN,NaN,NaN,0.5,"));
    }

    #[test]
    fn learned_friction_has_columns() {
        let learned = [Some(([12.5, 0.5], Trust::Learned)), None];
        let text = written(&[LogRecord { learned, ..record(0.0) }, record(0.02)]);
        let rows: Vec<&str> = text.lines().collect();
        let names = ["learned_", "half_width_", "trust_"]
            .map(|prefix| format!("{prefix}beta,\"{prefix}left \"\"arm\"\", upper\""));
        assert!(rows[0].contains(&format!(",u_1,{},source,", names.join(","))), "{text}");
        assert!(rows[1].contains(",0.125,12.5,NaN,0.5,NaN,learned,,held,"), "{text}");
        assert!(rows[2].contains(",0.125,NaN,NaN,NaN,NaN,,,held,"), "{text}");
    }

    #[test]
    fn capacities_are_checked() {
        for capacity in [0, MAX_LOG_CAPACITY + 1, usize::MAX] {
            let refused = start(io::sink(), NAMES, capacity).err().unwrap();
            assert_eq!(refused.kind(), io::ErrorKind::InvalidInput);
        }
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
