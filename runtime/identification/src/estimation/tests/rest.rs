//! Logs with rests, in which stiction holds the joints by any torque.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::preparation::{PreparationSettings, prepare_all};
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun, Run};
use super::super::{Estimate, EstimationSettings, estimate};
use super::measured::predicted;
use super::pendulum::{FRICTION, Pendulum, STEEPNESS};

const RATE: f64 = 125.0;
/// Delay of the efforts behind the positions [s].
const DELAY: f64 = 0.02;

/// Both joints at `t` into a motion of 10 s that begins and ends at rest: position, velocity, acceleration.
fn motion(t: f64, phases: &[f64; 6]) -> [[f64; 2]; 3] {
    const DURATION: f64 = 10.0;
    let place = (t / DURATION).clamp(0.0, 1.0);
    // A window that rises and falls within a fifth of the motion, by quintics.
    let edge = |x: f64| {
        let x = x.clamp(0.0, 1.0);
        let [x2, x3] = [x * x, x * x * x];
        [
            x3 * (10.0 - 15.0 * x + 6.0 * x2),
            30.0 * x2 * (1.0 - x).powi(2),
            60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
        ]
    };
    let (rise, fall) = (edge(5.0 * place), edge(5.0 * (1.0 - place)));
    let rate = 5.0 / DURATION;
    let window = [rise[0] * fall[0], rate * (rise[1] - fall[1]), rate * rate * (rise[2] + fall[2])];
    let mut sums = [[0.0; 2]; 3];
    for (k, phase) in phases.iter().enumerate() {
        let (joint, w) = (k % 2, 2.0 + 1.3 * (k / 2) as f64 + 0.5 * (k % 2) as f64);
        let ((s, c), size) = ((w * t + phase).sin_cos(), 0.7 / (1.0 + (k / 2) as f64));
        let wave = [size * s, size * w * c, -size * w * w * s];
        sums[0][joint] += window[0] * wave[0];
        sums[1][joint] += window[1] * wave[0] + window[0] * wave[1];
        sums[2][joint] += window[2] * wave[0] + 2.0 * window[1] * wave[1] + window[0] * wave[2];
    }
    sums
}

/// Two motions after each other, with `rest` seconds before, between and after them. At rest, stiction takes a share of
/// the Coulomb friction that is another one each time.
fn log(truth: &Pendulum, rest: f64, random: &mut SplitMix64) -> Run {
    let phases: [[f64; 6]; 2] =
        std::array::from_fn(|_| std::array::from_fn(|_| std::f64::consts::TAU * random.uniform()));
    let shares: [[f64; 2]; 3] = [[0.9, -0.8], [-0.7, 0.9], [0.95, 0.6]];
    let count = ((20.0 + 3.0 * rest) * RATE) as usize;
    let mut columns = vec![Vec::new(); 4];
    for i in 0..count {
        let t = i as f64 / RATE;
        // Which of the motions comes next or is going on, and the time into it.
        let of = |t: f64| if t < 10.0 + 1.5 * rest { (0, t - rest) } else { (1, t - 10.0 - 2.0 * rest) };
        let at = |(part, t): (usize, f64)| motion(t, &phases[part]);
        let late = of(t - DELAY);
        let [y, v, a] = at(late);
        let mut forces = [0.0; 2];
        truth.rigid_forces(&y, &v, &a, &mut forces);
        let now = at(of(t));
        for j in 0..2 {
            let rests = !(0.0..=10.0).contains(&late.1);
            let held = shares[late.0 + usize::from(late.1 > 10.0)][j] * FRICTION[j][1];
            let friction = FRICTION[j][0] * v[j] + FRICTION[j][1] * (STEEPNESS * v[j]).tanh();
            columns[j].push(now[0][j] + 2e-5 * random.normal());
            columns[2 + j].push(forces[j] + if rests { held } else { friction } + 0.1 * random.normal());
        }
    }
    Run {
        poses: Vec::new(),
        name: "simulated".into(),
        times: (0..count).map(|i| i as f64 / RATE).collect(),
        rows: (2..count + 2).collect(),
        positions: columns[..2].to_vec(),
        velocities: vec![None; 2],
        efforts: columns[2..].to_vec(),
        effort: Effort::Input,
    }
}

struct Found {
    estimate: Estimate,
    runs: Vec<PreparedRun>,
    bandwidth: f64,
    delay: f64,
}

fn found(truth: &Pendulum, rest: f64, seed: u64) -> Found {
    let described = Pendulum::described();
    let run = log(truth, rest, &mut SplitMix64::new(seed));
    let (runs, report) = prepare_all(&[run], Some(&described), &PreparationSettings::default()).unwrap();
    let settings = EstimationSettings {
        steepness: Some(vec![STEEPNESS; 2]),
        filter: Some(report.filter.clone()),
        ..EstimationSettings::default()
    };
    Found {
        estimate: estimate(&described, &runs, &settings, &mut |_| ()).unwrap(),
        runs,
        bandwidth: report.filter.bandwidth(),
        delay: report.delays[0].removed,
    }
}

#[test]
fn rests_before_between_and_after_change_neither_fit_nor_delay_nor_bandwidth() {
    let truth = Pendulum::described().other(0.1, &mut SplitMix64::new(4));
    let [without, with] = [0.3, 6.0].map(|rest| found(&truth, rest, 5));
    println!(
        "{:.2} Hz, {:.1} ms; {:.2} Hz, {:.1} ms",
        without.bandwidth,
        1e3 * without.delay,
        with.bandwidth,
        1e3 * with.delay
    );
    assert!(
        (with.bandwidth / without.bandwidth).log2().abs() < 0.6,
        "{} {}",
        with.bandwidth,
        without.bandwidth
    );
    assert!((with.delay - without.delay).abs() < 2e-3 && (with.delay - DELAY).abs() < 2e-3, "{}", with.delay);
    let unseen = &found(&truth, 0.3, 6).runs[0];
    let described = Pendulum::described();
    let [before, after] = [&without, &with].map(|found| predicted(&described, &found.estimate, unseen));
    println!("{before:.4?} {after:.4?}");
    for j in 0..2 {
        assert!(after[j] > before[j] - 0.01, "{before:?} {after:?}");
        let joint = &with.estimate.joints[j];
        let shares = [&without, &with].map(|found| found.estimate.joints[j].rest);
        assert!(shares[0] < 0.3 && (0.25..0.5).contains(&(shares[1] - shares[0])), "{shares:?}");
        // Stiction does not count as an error of the law, because no law of the velocity predicts it.
        assert!(joint.held_out_r_squared > joint.held_out_with_rest + 0.005, "{joint:?}");
        let friction: Vec<f64> = joint.terms.iter().map(|term| term.coefficient.value).collect();
        assert!((friction[1] / FRICTION[j][1] - 1.0).abs() < 0.1, "{friction:?}");
    }
}
