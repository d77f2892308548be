//! Effect of the thresholds for logs. Each threshold is halved and doubled, and the page lists the findings of small logs
//! that change.

use super::super::super::doubts::{self, limits::beyond};
use super::super::super::numeric::levels::varied::{Outcomes, page};
use super::super::super::preparation::{PreparationSettings, prepare_all};
use super::super::super::robot::Robot;
use super::super::{ColumnOptions, levels, runs_of};
use super::testing::Fake;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Values of a row: position, velocity and effort of a joint.
type Row = fn(usize, f64) -> [f64; 3];

fn wave(t: f64) -> [f64; 3] {
    [(2.0 * t).sin(), 2.0 * (2.0 * t).cos(), 20.0 * (2.0 * t).cos()]
}

/// Logs of one joint. Each log has one fault whose size is near the threshold for this fault.
const LOGS: [(&str, Row); 15] = [
    ("spike", |i, t| if i == 150 { [wave(t)[0], wave(t)[1], 260.0] } else { wave(t) }),
    ("long spike", |i, t| if (150..154).contains(&i) { [wave(t)[0], wave(t)[1], 900.0] } else { wave(t) }),
    ("many spikes", |i, t| if i % 140 == 10 { [wave(t)[0], wave(t)[1], 900.0] } else { wave(t) }),
    ("coarse positions", |_, t| [(wave(t)[0] / 0.15).round() * 0.15, wave(t)[1], wave(t)[2]]),
    ("cut off", |_, t| [wave(t)[0], wave(t)[1], wave(t)[2].min(19.98)]),
    ("coarse", |_, t| [wave(t)[0], wave(t)[1], (wave(t)[2] / 3.0).round()]),
    ("other velocity", |_, t| [wave(t)[0], 1.2 * wave(t)[1], wave(t)[2]]),
    ("slightly other velocity", |_, t| [wave(t)[0], 1.1 * wave(t)[1], wave(t)[2]]),
    ("unrelated velocity", |_, t| [wave(t)[0], (2.0 * t + 1.0).cos(), wave(t)[2]]),
    ("little travel", |_, t| [1e-3 * wave(t)[0], wave(t)[1], wave(t)[2]]),
    ("turns", |_, t| [(3.0 * t + 3.1).rem_euclid(6.0) - 3.0, 3.0, wave(t)[2]]),
    ("effort beyond", |_, t| [wave(t)[0], wave(t)[1], 5.75 * wave(t)[2]]),
    ("effort far beyond", |_, t| [wave(t)[0], wave(t)[1], 20.0 * wave(t)[2]]),
    ("position beyond", |_, t| [3.1 * t.sin(), 3.1 * t.cos(), wave(t)[2]]),
    ("position far beyond", |_, t| [60.0 * wave(t)[0], 60.0 * wave(t)[1], wave(t)[2]]),
];

/// The time of a row.
type Time = fn(usize) -> f64;

/// Times of logs.
const TIMES: [(&str, Time); 5] = [
    ("short pauses", |i| 0.032 * (i / 5) as f64 + 2e-3 * (i % 5) as f64),
    ("bursts", |i| 0.01 * ((i / 20) * 20) as f64 + 1e-4 * (i % 20) as f64),
    ("few bursts", |i| 0.01 * ((i / 35) * 35) as f64 + 2e-3 * (i % 35) as f64),
    ("counter", |i| i as f64),
    ("epoch", |i| 1.5e6 + 0.01 * i as f64),
];

/// Returns the codes and times of the findings about a log, or the reason why it is rejected.
fn outcome(rows: usize, time: Time, row: Row) -> BTreeSet<String> {
    let mut text = "t,q1,dq1,tau1\n".to_owned();
    for i in 0..rows {
        let [q, v, tau] = row(i, 0.01 * i as f64);
        writeln!(text, "{:.4},{q:.6},{v:.6},{tau:.6}", time(i)).unwrap();
    }
    let robot = Fake::numbered(1);
    let read = runs_of(text.as_bytes(), "log.csv", &robot, &ColumnOptions::default());
    let recording = match read {
        Ok(recording) => recording,
        Err(error) => return BTreeSet::from([error.to_string()]),
    };
    let begin = format!("begins at {}", recording.runs[0].times[0]);
    let settings = PreparationSettings { bandwidth: Some(5.0), ..PreparationSettings::default() };
    let prepared = prepare_all(&recording.runs, None, &settings).map(|(prepared, _)| prepared);
    let beyond = beyond(&robot as &dyn Robot, &recording, &prepared.unwrap_or_default());
    let codes = recording.findings.iter().chain(&beyond).map(|finding| finding.code.to_string());
    let remedies = beyond.iter().filter_map(|finding| finding.remedy.clone());
    codes.chain(remedies).chain([begin]).collect()
}

/// Returns the findings about a flight whose quaternions have this length.
fn flight(length: f64) -> BTreeSet<String> {
    let mut text = "t,x,y,z,qx,qy,qz,qw,u_front_right,u_rear_left,u_front_left,u_rear_right\n".to_owned();
    for i in 0..100 {
        let t = 0.01 * f64::from(i);
        writeln!(text, "{t:.2},{t:.4},0,1,0,0,0,{length},1,1,1,{:.4}", t.cos()).unwrap();
    }
    match runs_of(text.as_bytes(), "log.csv", &Fake::floating(), &ColumnOptions::default()) {
        Ok(recording) => recording.findings.iter().map(|finding| finding.code.to_string()).collect(),
        Err(error) => BTreeSet::from([error.to_string()]),
    }
}

fn outcomes() -> Outcomes {
    let usual = |i: usize| 0.01 * i as f64;
    let logs = LOGS.map(|(name, row)| (name.to_owned(), outcome(1000, usual, row)));
    let times = TIMES.map(|(name, time)| (name.to_owned(), outcome(1000, time, |_, t| wave(t))));
    let poses = [1.008, 1.015, 1.03].map(|length| (format!("quaternions of {length}"), flight(length)));
    logs.into_iter().chain(times).chain(poses).map(|(name, found)| (name, format!("{found:?}"))).collect()
}

#[test]
fn each_number_of_a_log_is_halved_and_doubled() {
    let names = levels::NAMES.iter().chain(doubts::levels::NAMES);
    insta::assert_snapshot!("numbers_of_a_log", page(names, &outcomes));
}
