//! Seeded faults: over a run, the acting law is not worse than the described one by more than 5 %.

use super::faulty::{FAULTS, run};

#[test]
fn faults_do_not_make_the_law_worse_than_the_described_one() {
    for kind in 0..6 {
        let mut worst = (0.0, 0);
        for seed in (kind..COUNT).step_by(6) {
            let outcome = run(seed);
            let ratio = outcome.acting / outcome.described;
            if ratio > worst.0 {
                worst = (ratio, seed);
            }
        }
        println!(
            "{}: at most {:.3} of the described error (seed {})",
            FAULTS[kind as usize], worst.0, worst.1
        );
        assert!(worst.0 < 1.05, "{}: {worst:?}", FAULTS[kind as usize]);
    }
}

/// The example `warming` runs a thousand.
const COUNT: u64 = 60;
