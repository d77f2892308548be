//! Logs: the measured Schunk runs, and a log of a million rows.

#[path = "support/data.rs"]
mod data;

use data::shared;
use gelenk_identification::log::{FindingKind, Log, LogSchema, Quantity};
use std::fmt::Write;

#[test]
fn the_schunk_runs_are_read_with_their_known_gaps() {
    let Some(path) = shared("data/schunk_lwa4p/runs.csv") else {
        return;
    };
    let (log, findings) = Log::open(&path, &LogSchema::default()).unwrap();
    assert_eq!(log.rows(), 19_598);
    assert_eq!(log.segments().len(), 28);
    assert_eq!(log.channels().iter().filter(|c| c.quantity == Quantity::Torque).count(), 6);
    assert!(log.time().unwrap()[1] == 0.004 && log.channel("q3").unwrap()[0] == -1.368);
    // Its README: the torques of each run's last row are NaN.
    let ends: Vec<usize> = log.segments().iter().map(|s| s.end - 1).collect();
    for name in ["u1", "u6"] {
        let missing: Vec<usize> = findings
            .iter()
            .filter(|f| f.kind == FindingKind::NotFinite && f.channel.as_deref() == Some(name))
            .map(|f| f.first)
            .collect();
        assert_eq!(missing, ends);
    }
    let wrong: Vec<String> = findings
        .iter()
        .filter(|f| !matches!(f.kind, FindingKind::NotFinite | FindingKind::Jitter))
        .map(ToString::to_string)
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    assert_eq!(log.select("abs(dq5) > 0.05 && run < 6").unwrap().first(), Some(&0));
}

#[test]
fn a_million_rows_are_ordinary() {
    let mut text = String::from("t,q1,dq1,u1\n");
    for i in 0..1_000_000 {
        let t = 1e-3 * f64::from(i);
        writeln!(text, "{t:.3},{:.6},{:.6},{:.4}", (0.3 * t).sin(), 0.3 * (0.3 * t).cos(), t.cos()).unwrap();
    }
    let (log, findings) = Log::read(text.as_bytes(), "million", &LogSchema::default()).unwrap();
    assert_eq!(log.rows(), 1_000_000);
    assert!(findings.is_empty(), "{findings:?}");
}
