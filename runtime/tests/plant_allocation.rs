//! A plant allocates when it is made, not when it moves.

#![allow(clippy::unwrap_used, reason = "test code")]

use gelenk_runtime::plant::{Plant, PlantOptions};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

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
fn a_moving_plant_does_not_allocate() {
    let options = PlantOptions {
        delay: 1,
        encoder_noise: [1e-4; 2],
        encoder_resolution: [1e-4; 2],
        input_loss: 0.1,
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(PowerCube, options).unwrap();
    let before = ALLOCATIONS.get();
    for k in 0..1000 {
        // Reversals, so that joints stick and slide.
        let u = 0.3 * (0.05 * f64::from(k)).sin();
        plant.apply(&[u, -u], 0.02).unwrap();
        if k % 100 == 50 {
            plant.brake();
        }
        if k % 100 == 60 {
            plant.release();
        }
        let _ = plant.measure();
    }
    assert_eq!(ALLOCATIONS.get() - before, 0);
}
