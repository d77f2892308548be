//! Samples from files: reading, contradictions, smoothing; the published PowerCube trajectory.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::trajectory::{
    Columns, Recording, RestToRest, Sampled, Smoothing, Trajectory, TrajectoryError,
};

const COLUMNS: Columns<2> = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };

/// The published trajectory.
fn published() -> Recording<2> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/powercube_trajectory.csv");
    Recording::open(path, &COLUMNS).unwrap()
}

/// Largest jump of the third derivative [rad/s³]: a spline of degree five with single knots has none.
fn largest_jerk_jump(trajectory: &Sampled<2>) -> f64 {
    let h = 1e-3 * trajectory.period();
    let mut largest = 0.0_f64;
    for k in 1..trajectory.samples().len() - 1 {
        let t = k as f64 * trajectory.period();
        let [a, b, c] = [t - h, t, t + h].map(|t| trajectory.sample(t).accelerations);
        for i in 0..2 {
            let change = (c[i] - b[i]) - (b[i] - a[i]);
            largest = largest.max((change / h).abs());
        }
    }
    largest
}

/// Largest difference of velocities and accelerations from the central differences of what they derive, in
/// the middle of the periods.
fn disagreement(trajectory: &Sampled<2>) -> [f64; 2] {
    let h = 1e-2 * trajectory.period();
    let mut largest = [0.0_f64; 2];
    for k in 0..trajectory.samples().len() - 1 {
        let t = (k as f64 + 0.5) * trajectory.period();
        let [a, b, c] = [t - h, t, t + h].map(|t| trajectory.sample(t));
        for i in 0..2 {
            let velocity = (c.positions[i] - a.positions[i]) / (2.0 * h);
            let acceleration = (c.velocities[i] - a.velocities[i]) / (2.0 * h);
            largest[0] = largest[0].max((velocity - b.velocities[i]).abs());
            largest[1] = largest[1].max((acceleration - b.accelerations[i]).abs());
        }
    }
    largest
}

#[test]
fn the_published_trajectory_contradicts_itself_at_fourteen_borders() {
    let recording = published();
    assert_eq!(recording.positions().len(), 1220);
    assert!((recording.period() - 0.02).abs() < 1e-12);
    let found = recording.inconsistencies(1e-5);
    let mut borders: Vec<usize> = found.iter().map(|f| f.sample).collect();
    borders.dedup();
    assert_eq!(borders, [96, 197, 239, 262, 420, 463, 534, 613, 699, 781, 905, 992, 1082, 1131]);
    let largest = found.iter().max_by(|a, b| a.defect.abs().total_cmp(&b.defect.abs())).unwrap();
    assert_eq!((largest.sample, largest.coordinate), (699, 0));
    assert!((largest.defect - 7.3697e-3).abs() < 1e-6, "{largest:?}");
    // Elsewhere the defect is that of the trapezoidal rule.
    let elsewhere = recording.inconsistencies(1e-6);
    assert_eq!(elsewhere.len(), found.len());
}

#[test]
fn the_published_trajectory_is_smoothed() {
    let recording = published();
    let smoothed = recording.smoothed(&Smoothing::of(0.02)).unwrap();
    let motion = &smoothed.trajectory;
    println!("deviations {:?} {:?}", smoothed.position_deviation, smoothed.velocity_deviation);
    for i in 0..2 {
        // Half the largest jump and a little more.
        assert!(smoothed.position_deviation[i] < 5e-3);
        assert!(smoothed.velocity_deviation[i] < 15e-3);
    }
    let first = motion.sample(0.0);
    assert_eq!(first.positions, recording.positions()[0]);
    let last = motion.sample(motion.duration());
    for sample in [first, last] {
        for rate in [sample.velocities, sample.accelerations] {
            assert!(rate.iter().all(|x| x.abs() < 1e-9), "{sample:?}");
        }
    }
    let [velocity, acceleration] = disagreement(motion);
    assert!(velocity < 1e-6 && acceleration < 1e-3, "{velocity} {acceleration}");
    let jump = largest_jerk_jump(motion);
    assert!(jump < 1.0, "{jump}");
    // No ripple between the samples: the trapezoidal rule holds, except where the motion sets in and where it
    // is slowed down.
    let last = motion.samples().len() - 1;
    for (k, w) in motion.samples().windows(2).enumerate().skip(10) {
        for i in 0..2 {
            let trapezoid = 0.01 * (w[0].velocities[i] + w[1].velocities[i]);
            let defect = w[1].positions[i] - w[0].positions[i] - trapezoid;
            assert!(defect.abs() < 1e-6 || k >= last - 3, "{defect} at {k}");
        }
    }
}

/// A smooth recording stays as it is: the error of a smoothing spline is of order τ⁶.
#[test]
fn a_smooth_recording_is_kept() {
    let motion = RestToRest::new([0.2, -1.0], [1.0, 0.5], 5.0).unwrap();
    let sampled = Sampled::of(&motion, 0.02).unwrap();
    let positions: Vec<_> = sampled.samples().iter().map(|s| s.positions).collect();
    let velocities: Vec<_> = sampled.samples().iter().map(|s| s.velocities).collect();
    for velocities in [None, Some(velocities)] {
        let recording = Recording::new(0.02, positions.clone(), velocities).unwrap();
        assert_eq!(recording.inconsistencies(1e-5), []);
        let smoothed = recording.smoothed(&Smoothing::of(0.02)).unwrap();
        assert!(smoothed.position_deviation.iter().all(|d| *d < 2e-4), "{smoothed:?}");
        let middle = (smoothed.trajectory.sample(2.5), motion.sample(2.5));
        for i in 0..2 {
            assert!((middle.0.positions[i] - middle.1.positions[i]).abs() < 1e-6);
            assert!((middle.0.accelerations[i] - middle.1.accelerations[i]).abs() < 1e-3);
        }
    }
}

/// Far from the ends and for positions alone, a sine passes with the gain 1/(1 + (ωτ)⁶), and without delay.
#[test]
fn a_sine_passes_with_the_gain_of_the_filter() {
    let period = 0.02;
    for (omega, tau) in [(5.0_f64, 0.1), (10.0, 0.1), (15.0, 0.1), (5.0, 0.2)] {
        let positions: Vec<_> =
            (0..=2000).map(|k| [(omega * (f64::from(k) - 1000.0) * period).cos()]).collect();
        let recording = Recording::new(period, positions, None).unwrap();
        let smoothing = Smoothing { time_constant: tau, correction_time: 1.0 };
        let motion = recording.smoothed(&smoothing).unwrap().trajectory;
        let gain = 1.0 / (1.0 + (omega * tau).powi(6));
        let middle = motion.sample(20.0);
        assert!((middle.positions[0] - gain).abs() < 1e-4, "{omega} {tau}: {middle:?}, {gain}");
        assert!((middle.accelerations[0] + gain * omega * omega).abs() < 1e-3 * omega * omega);
        assert!(middle.velocities[0].abs() < 1e-5);
    }
}

/// A jump of positions that the velocities do not know is spread over a second, not made in one step.
#[test]
fn a_jump_is_spread() {
    let positions: Vec<_> = (0..500).map(|k| [if k < 250 { 0.0 } else { 7e-3 }]).collect();
    let velocities = vec![[0.0]; 500];
    let recording = Recording::new(0.02, positions, Some(velocities)).unwrap();
    let found = recording.inconsistencies(1e-5);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].sample, found[0].defect), (249, 7e-3));
    let smoothed = recording.smoothed(&Smoothing::of(0.02)).unwrap();
    assert!(smoothed.velocity_deviation[0] < 0.02, "{smoothed:?}");
    assert!((smoothed.position_deviation[0] - 3.5e-3).abs() < 3e-4, "{smoothed:?}");
}

#[test]
fn files_that_cannot_be_used_say_where() {
    let one = Columns { time: "t", positions: ["y"], velocities: None };
    let read = |text: &str| Recording::read(text.as_bytes(), "log.csv", &one).unwrap_err();
    let message = |text: &str| read(text).to_string();
    assert_eq!(message("t,x\n0,1\n"), "log.csv: column y is missing. The file has the columns t, x");
    assert_eq!(message("t,y\n0,1\n1,two\n"), "log.csv, row 2: \"two\" in column y is not a number");
    assert!(message("t,y\n0,1\n1,2\n3,3\n4,4\n").starts_with("log.csv, row 2: the time is 1 s"));
    assert!(matches!(read("t,y\n0,1\n"), TrajectoryError::TooFew { needed: 3, given: 1, .. }));
    assert!(message("t,y\n0,1\n1,inf\n2,1\n").contains("positions of sample 1"));
    assert!(message("t,y\n0,1\n0,1\n0,1\n").contains("period is 0"));
    assert!(
        Recording::open("/nowhere/log.csv", &one).unwrap_err().to_string().starts_with("/nowhere/log.csv: ")
    );
    let recording = Recording::read("t, y\n0, 1\n1, 2\n2, 3\n".as_bytes(), "", &one).unwrap();
    assert_eq!(recording.positions(), [[1.0], [2.0], [3.0]]);
    let error = recording.smoothed(&Smoothing { time_constant: 50.0, correction_time: 1.0 });
    assert_eq!(error.unwrap_err().to_string(), "time constant in periods is 50, but must be 1 to 20");
}
