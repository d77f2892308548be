//! Functions that run in the control loop do not allocate.

use crate::allocations;
use crate::methods::recursive::{RecursiveLeastSquares, RecursiveSettings};
use gelenk_identification::methods::library::Library;

#[test]
fn recursive_updates_do_not_allocate() {
    let library = Library::friction().unwrap();
    let settings = RecursiveSettings { threshold: 0.1, period: 10, ..Default::default() };
    let mut estimator = RecursiveLeastSquares::new([0.0; 7], settings).unwrap();
    let mut workspace = library.workspace();
    let mut theta = [0.0; 7];
    let before = allocations::count();
    for i in 0..1000 {
        let v = (0.01 * f64::from(i)).sin();
        library.row(&[v], &mut workspace, &mut theta).unwrap();
        estimator.update(&theta, 3.0 * v + (5.0 * v).tanh());
    }
    assert_eq!(allocations::count() - before, 0);
    assert!(estimator.coefficients()[1] > 1.0);
}
