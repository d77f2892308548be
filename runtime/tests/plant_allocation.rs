//! A plant allocates when it is made, not when it moves.

#![allow(clippy::unwrap_used, reason = "test code")]

use crate::allocations;
use gelenk_runtime::plant::{Plant, PlantOptions};

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

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
    let before = allocations::count();
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
    assert_eq!(allocations::count() - before, 0);
}
