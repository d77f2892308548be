//! The laws in Rust, over a module that gelenk wrote; law.h says what they compute. B is diagonal: each drive moves one joint.

#![no_std]

#[path = "robot.rs"]
#[allow(dead_code)]
mod robot;

use core::cell::Cell;
use robot::N;

/// Gains that `prepare` computes.
#[derive(Clone, Copy)]
struct Gains {
    inverse_input_matrix: [f32; N],
    position: [f32; N],
    velocity: [f32; N],
}

struct Prepared(Cell<Gains>);

// SAFETY: the processor runs one thread, and no interrupt calls these functions.
unsafe impl Sync for Prepared {}

static PREPARED: Prepared =
    Prepared(Cell::new(Gains { inverse_input_matrix: [0.0; N], position: [0.0; N], velocity: [0.0; N] }));

/// A desired motion at one time.
#[repr(C)]
pub struct Sample {
    positions: [f32; N],
    velocities: [f32; N],
    accelerations: [f32; N],
}

#[unsafe(no_mangle)]
pub extern "C" fn prepare(positions: &[f32; N], omega: f32, damping: f32) {
    let (b, m) = (robot::input_matrix(), robot::mass_matrix(positions));
    PREPARED.0.set(Gains {
        inverse_input_matrix: core::array::from_fn(|i| 1.0 / b[i][i]),
        position: core::array::from_fn(|i| m[i][i] * omega * omega),
        velocity: core::array::from_fn(|i| 2.0 * damping * m[i][i] * omega),
    });
}

fn forces(desired: &Sample) -> [f32; N] {
    robot::inverse_dynamics(&desired.positions, &desired.velocities, &desired.accelerations)
}

#[unsafe(no_mangle)]
pub extern "C" fn inverse_dynamics(desired: &Sample, result: &mut [f32; N]) {
    *result = forces(desired);
}

#[unsafe(no_mangle)]
pub extern "C" fn feed_forward(desired: &Sample, inputs: &mut [f32; N]) {
    let (forces, gains) = (forces(desired), PREPARED.0.get());
    *inputs = core::array::from_fn(|i| gains.inverse_input_matrix[i] * forces[i]);
}

#[unsafe(no_mangle)]
pub extern "C" fn joint_pd(desired: &Sample, positions: &[f32; N], velocities: &[f32; N], inputs: &mut [f32; N]) {
    let (forces, gains) = (forces(desired), PREPARED.0.get());
    *inputs = core::array::from_fn(|i| {
        let correction = gains.position[i] * (desired.positions[i] - positions[i])
            + gains.velocity[i] * (desired.velocities[i] - velocities[i]);
        gains.inverse_input_matrix[i] * (forces[i] + correction)
    });
}

/// The script refuses a program that holds it.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
