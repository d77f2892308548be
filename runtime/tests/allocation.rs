//! Sums over the samples of a library do not allocate for each sample.

use crate::allocations;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::{Moments, Samples};

#[test]
fn sums_over_a_library_do_not_allocate_for_each_sample() {
    let library = Library::friction().unwrap();
    let velocities: Vec<f64> = (0..20_000).map(|i| (0.01 * f64::from(i)).sin()).collect();
    let allocated = |samples: usize| {
        let columns = vec![&velocities[..samples]];
        let samples = Samples::from_library(&library, columns.clone(), columns).unwrap();
        let before = allocations::count();
        assert!(Moments::new(&samples).unwrap().samples() > 0);
        allocations::count() - before
    };
    let [few, many] = [1000, 20_000].map(allocated);
    assert!(many < few + 1000, "{many} allocations for 20 000 samples, {few} for 1000");
}
