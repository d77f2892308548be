//! Logs, recordings and the mappings of their columns, spoilt.

use super::*;

/// A log of the loop, as it writes it.
fn loop_log() -> Vec<u8> {
    #[derive(Clone, Default)]
    struct Shared(std::sync::Arc<std::sync::Mutex<Vec<u8>>>);
    impl std::io::Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let text = Shared::default();
    let (mut sink, writer) = log_to(text.clone(), &PowerCube, 100).unwrap();
    for k in 0..40_u32 {
        let t = 0.02 * f64::from(k);
        sink.push(gelenk_runtime::control_loop::LogRecord {
            time: t,
            positions: [t.sin(), t.cos()],
            velocities: [t.cos(), -t.sin()],
            measured_velocities: Some([t.cos(), -t.sin()]),
            measured_torques: None,
            desired: [t.sin(), t.cos()],
            inputs: [0.1, 0.2],
            source: Source::Controller,
            believed: true,
            iterations: k,
            lateness: 100,
            stages: [1, 2, 3, 4],
            learned: [None; 2],
        });
    }
    drop(sink);
    writer.finish().unwrap();
    text.0.lock().unwrap().clone()
}

/// A log of another kind: units, runs, counters.
fn measured_log() -> Vec<u8> {
    let mut text = String::from("run,t [ms],q1 [deg],q2 [deg],dq1 [rpm],dq2 [rpm],u1,u2,count\n");
    for k in 0..40_u32 {
        let t = f64::from(k % 20);
        text += &format!(
            "{},{t},{:.4},{:.4},{:.3},{:.3},{:.2},{:.2},{}\n",
            1 + k / 20,
            10.0 * (0.2 * t).sin(),
            10.0 * (0.2 * t).cos(),
            0.3 * (0.2 * t).cos(),
            -0.3 * (0.2 * t).sin(),
            0.1 * t,
            -0.1 * t,
            (k * 7) % 256
        );
    }
    text.into_bytes()
}

const PIECES: [&[u8]; 28] = [
    b",",
    b"\n",
    b"\r\n",
    b"\"",
    b"\"\"",
    b"NaN",
    b"inf",
    b"-inf",
    b"1e999",
    b"-1e308",
    b"5e-324",
    b"0",
    b"-",
    b"e",
    b"0x10",
    b";",
    b"\t",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\0",
    b" ",
    b"q1",
    b"time",
    b"[deg]",
    b"[1]",
    b"q_beta",
    b"1,2,3,4,5,6,7,8,9",
    b"1e15",
];

fn spoil_log(bytes: &mut Vec<u8>, generator: &mut ChaCha8Rng) {
    if bytes.is_empty() {
        return;
    }
    let at = generator.random_range(0..bytes.len());
    // Somewhere on, but not far.
    let to = (at + generator.random_range(0..80)).min(bytes.len());
    match generator.random_range(0..8) {
        0 => bytes[at] = generator.random(),
        1 => bytes.truncate(at),
        2 => drop(bytes.drain(at..to)),
        3 => {
            let copied = bytes[at..to].to_vec();
            let place = generator.random_range(0..=bytes.len());
            bytes.splice(place..place, copied);
        }
        _ => {
            let piece = PIECES[generator.random_range(0..PIECES.len())];
            let end = if generator.random_bool(0.5) { at } else { to.min(at + piece.len()) };
            bytes.splice(at..end, piece.iter().copied());
        }
    }
}

#[test]
fn logs() {
    let mut generator = ChaCha8Rng::seed_from_u64(9);
    let count = rounds(400, 100_000);
    let (mut slowest, mut read) = (Slowest::default(), 0_u64);
    let sound = [loop_log(), measured_log()];
    assert!(sound.iter().all(|bytes| work_as_runs(bytes, None)));
    for k in 0..count {
        let mut bytes = sound[(k % 2) as usize].clone();
        for _ in 0..generator.random_range(1..6) {
            spoil_log(&mut bytes, &mut generator);
        }
        let columns = (k / 2 % 2 == 1).then(|| "time=1,position=q{}|2[deg],effort=u_{name}".into());
        read += u64::from(slowest.time(|| work_as_runs(&bytes, columns)));
        slowest.time(|| record(&bytes));
    }
    assert!(read > count / 10, "{read} of {count} could be read");
    slowest.report("logs", count);
}

/// A file as runs of a robot: refused, or runs that are whole.
fn work_as_runs(bytes: &[u8], columns: Option<String>) -> bool {
    let robot = NamedRobot { names: vec!["beta".into(), "gamma".into()], ..NamedRobot::default() };
    let options = ColumnOptions { columns, ..ColumnOptions::default() };
    let recording = match runs_of(bytes, "spoilt", &robot, &options) {
        Ok(recording) => recording,
        Err(error) => {
            assert!(error.to_string().len() < 100_000, "{error}");
            return false;
        }
    };
    let shown: usize = recording.findings.iter().map(|finding| finding.to_string().len()).sum();
    assert!(shown < 1_000_000, "{shown} characters of findings");
    assert!(!recording.runs.is_empty());
    for run in &recording.runs {
        assert!(run.times.len() > 1 && run.times.windows(2).all(|t| t[0] <= t[1]), "{:?}", run.times);
        let columns = run.positions.iter().chain(run.velocities.iter().flatten()).chain(&run.efforts);
        assert!(
            columns.clone().all(|column| column.len() == run.times.len() && column.len() == run.rows.len())
        );
        assert!(columns.flatten().chain(&run.times).all(|x| x.is_finite()));
    }
    true
}

/// The same file as a recording of a trajectory: refused, or a motion that is finite everywhere.
fn record(bytes: &[u8]) {
    let columns =
        Columns { time: "time", positions: ["q_beta", "q_gamma"], velocities: Some(["dq_beta", "dq_gamma"]) };
    let Ok(recording) = Recording::<2>::read(bytes, "spoilt", &columns) else {
        return;
    };
    let _ = recording.inconsistencies(1e-3);
    let smoothed = recording.smoothed(&Smoothing::of(recording.period()));
    let motions = [recording.raw(), smoothed.map(|s| s.trajectory)];
    for motion in motions.into_iter().flatten() {
        for k in 0..=50 {
            let sample = motion.sample(motion.duration() * f64::from(k) / 50.0);
            assert!(sample.is_finite());
        }
    }
}

#[test]
fn mappings() {
    let mut generator = ChaCha8Rng::seed_from_u64(10);
    let loop_log = loop_log();
    let count = rounds(1000, 50_000);
    let mut slowest = Slowest::default();
    for _ in 0..count {
        let mut line = b"position=q{}[deg],time=t[ms],input=u{name}|5..6,run=run".to_vec();
        spoil_log(&mut line, &mut generator);
        slowest.time(|| work_as_runs(&loop_log, Some(String::from_utf8_lossy(&line).into_owned())));
    }
    slowest.report("mappings of columns", count);
}
