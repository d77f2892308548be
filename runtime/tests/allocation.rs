//! What runs in the control loop does not allocate.

use gelenk_runtime::identification::library::Library;
use gelenk_runtime::identification::recursive::{RecursiveLeastSquares, RecursiveSettings};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    /// Of this thread alone: the test runner's own thread allocates whenever it likes.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static GLOBAL: Counting = Counting;

#[test]
fn recursive_updates_do_not_allocate() {
    let library = Library::friction().unwrap();
    let settings = RecursiveSettings {
        threshold: 0.1,
        period: 10,
        ..Default::default()
    };
    let mut estimator = RecursiveLeastSquares::new([0.0; 7], settings).unwrap();
    let mut workspace = library.workspace();
    let mut theta = [0.0; 7];
    let before = ALLOCATIONS.get();
    for i in 0..1000 {
        let v = (0.01 * f64::from(i)).sin();
        library.row(&[v], &mut workspace, &mut theta).unwrap();
        estimator.update(&theta, 3.0 * v + (5.0 * v).tanh());
    }
    assert_eq!(ALLOCATIONS.get() - before, 0);
    assert!(estimator.coefficients()[1] > 1.0);
}
