//! Time of an update of all joints of a seven-axis arm, as a ratio to its inverse dynamics:
//!
//! ```text
//! cargo bench -p gelenk-runtime --bench adaptation
//! ```
//!
//! The update contains one inverse dynamics and one evaluation of the friction.

use gelenk_runtime::adaptation::{Adaptation, AdaptationSettings, DescribedForces, Measured};
use gelenk_runtime::dynamics::Dynamics;
use std::hint::black_box;
use std::time::Instant;

gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda);

const PERIOD: f64 = 1e-3;
const PERIODS: u32 = 200_000;

/// Motion of the arm in period k.
fn motion(k: u32) -> [[f64; 7]; 3] {
    let rates: [f64; 7] = core::array::from_fn(|i| 0.6 + 0.1 * i as f64);
    let t = PERIOD * f64::from(k);
    [
        rates.map(|rate| 0.4 * (rate * t).sin()),
        rates.map(|rate| 0.4 * rate * (rate * t).cos()),
        rates.map(|rate| -0.4 * rate * rate * (rate * t).sin()),
    ]
}

fn main() {
    let mut adaptation = match Adaptation::for_robot(&Panda, AdaptationSettings::new(PERIOD)) {
        Ok(adaptation) => adaptation,
        Err(error) => {
            eprintln!("{error}");
            return;
        }
    };
    let samples: Vec<_> = (0..PERIODS).map(motion).collect();
    let torques: Vec<[f64; 7]> =
        samples.iter().map(|[y, v, a]| Panda.inverse_dynamics(y, v, a).map(|torque| 1.02 * torque)).collect();
    let begin = Instant::now();
    for [y, v, a] in &samples {
        black_box(Panda.inverse_dynamics(black_box(y), v, a));
    }
    let inverse = begin.elapsed().as_nanos() as f64 / f64::from(PERIODS);
    let mut worst = 0.0_f64;
    let begin = Instant::now();
    for ([y, ..], torques) in samples.iter().zip(&torques) {
        let measured = Measured { positions: Some(*y), torques: *torques, saturated: [false; 7], periods: 1 };
        let one = Instant::now();
        adaptation.step(black_box(&measured), |y, v, a| DescribedForces::of(&Panda, y, v, a));
        worst = worst.max(one.elapsed().as_nanos() as f64);
    }
    let update = begin.elapsed().as_nanos() as f64 / f64::from(PERIODS);
    println!(
        "inverse dynamics {inverse:.0} ns, update of seven joints {update:.0} ns (mean), {worst:.0} ns (worst)"
    );
    println!("ratio of the means {:.1}", update / inverse);
}
