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
        });
    }
    drop(sink);
    writer.finish().unwrap();
    text.0.lock().unwrap().clone()
}

/// A log of another kind: units, runs, counters.
fn measured_log() -> Vec<u8> {
    let mut text = String::from("run,t [ms],q1 [deg],dq1 [rpm],u1,count\n");
    for k in 0..40_u32 {
        let t = f64::from(k % 20);
        text += &format!(
            "{},{t},{:.4},{:.3},{:.2},{}\n",
            1 + k / 20,
            10.0 * (0.2 * t).sin(),
            0.3 * (0.2 * t).cos(),
            0.1 * t,
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

/// Everything that can be done to a log, with what is left of one.
fn work_through(bytes: &[u8], schema: &LogSchema) -> bool {
    let Ok((mut log, findings)) = Log::read(bytes, "spoilt", schema) else {
        return false;
    };
    let shown: usize = findings.iter().map(|finding| finding.to_string().len()).sum();
    assert!(shown < 1_000_000, "{shown} characters of findings");
    check(&log);
    for name in log.names() {
        assert_eq!(log.channel(&name).unwrap().len(), log.rows());
        let _ = log.select(&format!("abs({name}) > 0.1"));
    }
    let position = log.names().into_iter().find(|name| name.starts_with('q'));
    let methods = [
        Differentiation::KalmanSmoother(KalmanSmoother::from_noise(1e-4)),
        Differentiation::SavitzkyGolay(SavitzkyGolay::with_window(7, 3)),
        Differentiation::TotalVariation(TotalVariation::with_gamma(1e-3)),
    ];
    for method in methods {
        if let Some(position) = &position {
            let mut log = log.clone();
            if log.differentiate(position, &method).is_ok() {
                let velocity = log.channel(&format!("{position}_velocity")).unwrap();
                assert_eq!(velocity.len(), log.rows());
            }
        }
    }
    let rows: Vec<usize> = (0..log.rows()).collect();
    let _ = log.inner_rows(&rows, 3);
    let _ = log.motion(&["q_beta"], &["u_beta"], &rows);
    let again = log.channels()[0].clone();
    assert!(log.add(again).is_err());
    true
}

#[test]
fn logs() {
    let mut generator = ChaCha8Rng::seed_from_u64(9);
    let mapped = LogSchema::from_toml(
        "[[channel]]\nname = \"time\"\n\n[[channel]]\nname = \"q_beta\"\n\n[[channel]]\nname = \"u_beta\"\n",
    )
    .unwrap();
    let count = rounds(400, 100_000);
    let (mut slowest, mut read, mut as_runs) = (Slowest::default(), 0_u64, 0_u64);
    let mut strange = false;
    let sound = [loop_log(), measured_log()];
    assert!(work_as_runs(&sound[0], None));
    for bytes in &sound {
        assert!(work_through(bytes, &LogSchema::default()));
    }
    for k in 0..count {
        let which = (k % 2) as usize;
        let mut bytes = sound[which].clone();
        for _ in 0..generator.random_range(1..6) {
            spoil_log(&mut bytes, &mut generator);
        }
        let schema = if k % 5 == 0 { &mapped } else { &LogSchema::default() };
        read += u64::from(slowest.time(|| work_through(&bytes, schema)));
        let columns = strange.then(|| "time=1,position=q{}|2[deg],effort=u_{name}".into());
        strange = !strange;
        as_runs += u64::from(slowest.time(|| work_as_runs(&bytes, columns)));
        slowest.time(|| record(&bytes));
    }
    assert!(read > count / 4, "{read} of {count} could be read");
    assert!(as_runs > count / 10, "{as_runs} of {count} could be read as runs");
    slowest.report("logs", count);
}

/// The same file as runs of a robot: refused, or runs that are whole.
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
    let sound = b"separator = \";\"\n[[channel]]\nname = \"u1\"\ncolumn = \"i1\"\nquantity = \"current\"\nunit = \"mA\"\n\
                  joint = 1\nscale = 2.0\noffset = 1.0\nmotor_constant = 0.12\n";
    let mut generator = ChaCha8Rng::seed_from_u64(10);
    let loop_log = loop_log();
    let count = rounds(1000, 50_000);
    let mut slowest = Slowest::default();
    for _ in 0..count {
        let mut bytes = sound.to_vec();
        for _ in 0..generator.random_range(1..4) {
            spoil_log(&mut bytes, &mut generator);
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let schema = slowest.time(|| LogSchema::from_toml(&text));
        if let Ok(schema) = schema {
            let _ = Log::read(&b"i1;t\n1;0\n2;0.1\n3;0.2\n"[..], "sound", &schema);
        }
        let mut line = b"position=q{}[deg],time=t[ms],input=u{name}|5..6,run=run".to_vec();
        spoil_log(&mut line, &mut generator);
        slowest.time(|| work_as_runs(&loop_log, Some(String::from_utf8_lossy(&line).into_owned())));
    }
    slowest.report("mappings of columns", count);
}
