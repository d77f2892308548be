//! ROS 2 bags that the package `rosbags` wrote by `bags/make.py`.

use super::super::{ColumnOptions, runs, runs_of};
use super::testing::Fake;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;

const BAGS: [(&str, &[u8]); 7] = [
    ("sqlite.db3", include_bytes!("bags/sqlite.db3")),
    ("unstamped.db3", include_bytes!("bags/unstamped.db3")),
    ("packed_messages.db3", include_bytes!("bags/packed_messages.db3")),
    ("packed.db3.zstd", include_bytes!("bags/packed.db3.zstd")),
    ("plain.mcap", include_bytes!("bags/plain.mcap")),
    ("zstd.mcap", include_bytes!("bags/zstd.mcap")),
    ("lz4.mcap", include_bytes!("bags/lz4.mcap")),
];

fn said(bytes: &[u8], columns: &str) -> String {
    let columns = (!columns.is_empty()).then(|| columns.to_owned());
    let columns = ColumnOptions { columns, ..ColumnOptions::default() };
    runs_of(bytes, "bag", &Fake::numbered(2), &columns).unwrap_err().to_string()
}

#[test]
fn bags_have_the_states_that_were_written() {
    let robot = Fake::numbered(2);
    for (name, bytes) in BAGS {
        let recording = runs_of(bytes, name, &robot, &ColumnOptions::default()).unwrap();
        let [run] = recording.runs.as_slice() else { panic!("{name}: {} runs", recording.runs.len()) };
        assert_eq!(run.times.len(), 60, "{name}");
        for k in 0..60 {
            let part = k as f64;
            assert!((run.times[k] - run.times[0] - 0.008 * part).abs() < 1e-12, "{name}: {:?}", run.times);
            assert_eq!(
                [run.positions[0][k], run.positions[1][k]],
                [part / 64.0, 1.0 - part / 32.0],
                "{name}"
            );
            assert_eq!([run.efforts[0][k], run.efforts[1][k]], [part / 16.0, -part / 8.0], "{name}");
        }
        let time = if name.starts_with("unstamped") { "bag/time" } else { "header/stamp" };
        assert_eq!(recording.labels.time, time, "{name}");
        let left = recording.findings.iter().find(|finding| finding.code == "rows-left-out");
        assert!(left.unwrap().sentence().contains("120 incomplete rows are left out"));
    }
}

/// The gripper is a second robot on the same topic, and a bag may be compressed like any log.
#[test]
fn bags_are_read_as_other_logs_are() {
    let (_, bytes) = BAGS[0];
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(bytes).unwrap();
    let packed = packed.finish().unwrap();
    let recording = runs_of(&packed, "bag.gz", &Fake::numbered(2), &ColumnOptions::default()).unwrap();
    assert_eq!(recording.runs[0].times.len(), 60);
    assert!(said(bytes, "position=/arm/{name}/position").contains("/joint_states/joint_2/position"));
}

#[test]
fn files_that_are_no_bags_of_joint_states_are_refused() {
    let (_, sqlite) = BAGS[0];
    let (_, mcap) = BAGS[4];
    let renamed = |from: &str, to: &str, bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        let places: Vec<usize> =
            (0..bytes.len()).filter(|at| bytes[*at..].starts_with(from.as_bytes())).collect();
        assert!(!places.is_empty(), "{from}");
        places.into_iter().for_each(|at| bytes[at..at + to.len()].copy_from_slice(to.as_bytes()));
        bytes
    };
    for (bytes, message) in [
        (sqlite[..40_000].to_vec(), "the SQLite file is incomplete"),
        (mcap[..40_000].to_vec(), "the MCAP file ends within a record"),
        (renamed("topics", "tropic", sqlite), "the SQLite file lacks the tables of a ROS 2 bag"),
        (
            renamed("sensor_msgs/msg/JointState", "sensor_msgs/msg/JointTrack", mcap),
            "the bag has no messages of type sensor_msgs/msg/JointState. Record a topic of this type. The topics of the bag \
             are: /joint_states (sensor_msgs/msg/JointTrack)",
        ),
    ] {
        let said = said(&bytes, "");
        assert!(said.contains(message), "{said}");
    }
}

/// Rows that SQLite has not yet written back are in a separate file.
#[test]
fn a_bag_that_is_not_closed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag.db3");
    std::fs::write(&path, BAGS[0].1).unwrap();
    let read = || runs(std::slice::from_ref(&path), &Fake::numbered(2), &ColumnOptions::default());
    assert!(read().is_ok());
    std::fs::write(folder.path().join("bag.db3-wal"), "rows").unwrap();
    assert!(read().unwrap_err().to_string().contains("Write them back"));
}

/// Damaged bags are read or rejected without a panic.
#[test]
fn damaged_bags_do_not_panic() {
    let robot = Fake::numbered(2);
    let mut random = numbers();
    let mut refused = 0;
    for (name, bytes) in BAGS {
        for _ in 0..60 {
            let mut damaged = bytes.to_vec();
            for _ in 0..=random() % 8 {
                let at = random() % damaged.len();
                damaged[at] = u8::try_from(random() % 256).unwrap();
            }
            if random().is_multiple_of(4) {
                damaged.truncate(random() % bytes.len());
            }
            let read = runs_of(&damaged, name, &robot, &ColumnOptions::default());
            refused += usize::from(read.is_err());
        }
    }
    assert!((100..420).contains(&refused), "{refused}");
}

/// Numbers of a linear congruential generator (Knuth).
fn numbers() -> impl FnMut() -> usize {
    let mut state = 1_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 40).unwrap()
    }
}
