//! Simulates seeded robots with Coulomb friction and stiction. Prints the coverage of the confidence intervals while friction drifts,
//! and the errors of the acting law with faults of sensors and connection.
//!
//! ```text
//! cargo run --release --example warming -- 1000 1
//! ```
//!
//! The second argument is the seed of the first robot.

#[path = "support/faulty.rs"]
mod faulty;
#[path = "support/random.rs"]
mod random;
#[path = "support/warming.rs"]
mod warming;

use gelenk_runtime::adaptation::AdaptationSettings;

fn main() {
    let argument = |place: usize| std::env::args().nth(place).and_then(|number| number.parse().ok());
    let (count, first) = (argument(1).unwrap_or(100), argument(2).unwrap_or(1));
    let found = warming::coverage(first, count, AdaptationSettings::new(warming::PERIOD));
    let all = found.held.iter().sum::<f64>() / 10.0;
    println!("{count} joints from seed {first} on: 90 % intervals hold {:.1} %", 100.0 * all);
    println!("  by instant: {:.1?} %", found.held.map(|held| 100.0 * held));
    println!("  half width over friction {:.1} %", 100.0 * found.width);
    let [learned, described] = found.errors.map(|error| 100.0 * error);
    println!("  rms error over friction: learned {learned:.2} %, described {described:.2} %");
    for (kind, name) in faulty::FAULTS.iter().enumerate() {
        let outcomes = (kind as u64..count).step_by(faulty::FAULTS.len()).map(faulty::run);
        let ratios: Vec<f64> = outcomes.map(|one| one.acting / one.described).collect();
        let (worst, beyond) = (
            ratios.iter().fold(0.0_f64, |a, b| a.max(*b)),
            ratios.iter().filter(|ratio| **ratio > 1.05).count(),
        );
        println!(
            "  {name}: error at most {worst:.3} of the described law's, above 1.05 in {beyond} of {} runs",
            ratios.len()
        );
    }
    println!("  the learned law acts at {:.1} % of the instants", 100.0 * found.learned);
}
