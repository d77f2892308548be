//! Functions that run in the control loop do not allocate.

use crate::allocations;
use gelenk_identification::methods::library::Library;

#[test]
fn rows_of_a_library_do_not_allocate() {
    let library = Library::friction().unwrap();
    let mut workspace = library.workspace();
    let (mut theta, mut sum) = ([0.0; 7], 0.0);
    let before = allocations::count();
    for i in 0..1000 {
        library.row(&[(0.01 * f64::from(i)).sin()], &mut workspace, &mut theta).unwrap();
        sum += theta[1].abs();
    }
    assert_eq!(allocations::count() - before, 0);
    assert!(sum > 100.0);
}
