//! The online estimator of friction on the PowerCube, for online.c.

#![no_std]

mod robot;

use core::cell::UnsafeCell;
use gelenk_adaptation::{Adaptation, AdaptationSettings, DescribedForces, Measured};
use gelenk_kernels::math::sin_cos;

gelenk_dynamics::dynamics!(struct Arm = crate::robot);

const PERIOD: f64 = 0.01;
const PERIODS: usize = 1000;

/// The estimator, and measurements of a motion whose viscous and dry friction is a fifth less than described.
struct Online {
    adaptation: Adaptation<2>,
    positions: [[f64; 2]; PERIODS],
    torques: [[f64; 2]; PERIODS],
}

struct Shared(UnsafeCell<Option<Online>>);

// SAFETY: the processor runs one thread, and no interrupt calls these functions.
unsafe impl Sync for Shared {}

static ONLINE: Shared = Shared(UnsafeCell::new(None));

fn online() -> &'static mut Option<Online> {
    // SAFETY: as above, and no function keeps the reference.
    unsafe { &mut *ONLINE.0.get() }
}

fn motion(k: usize) -> [[f64; 2]; 3] {
    let wave = |rate: f64| {
        let (sin, cos) = sin_cos(rate * PERIOD * k as f64);
        [0.4 * sin, 0.4 * rate * cos, -0.4 * rate * rate * sin]
    };
    let [first, second] = [wave(1.0), wave(1.3)];
    core::array::from_fn(|i| [first[i], second[i]])
}

#[unsafe(no_mangle)]
pub extern "C" fn start() {
    let Ok(adaptation) = Adaptation::for_robot(&Arm, AdaptationSettings::new(PERIOD)) else { return };
    let mut all = Online { adaptation, positions: [[0.0; 2]; PERIODS], torques: [[0.0; 2]; PERIODS] };
    for (k, (positions, torques)) in all.positions.iter_mut().zip(&mut all.torques).enumerate() {
        let [y, v, a] = motion(k);
        let described = DescribedForces::of(&Arm, &y, &v, &a);
        (*positions, *torques) = (y, core::array::from_fn(|i| described.forces[i] - 0.2 * described.friction[i]));
    }
    *online() = Some(all);
}

/// One period of the estimator.
#[unsafe(no_mangle)]
pub extern "C" fn update(k: u32) {
    let Some(Online { adaptation, positions, torques }) = online() else { return };
    let (Some(y), Some(torques)) = (positions.get(k as usize), torques.get(k as usize)) else { return };
    let measured = Measured { positions: Some(*y), torques: *torques, saturated: [false; 2], periods: 1 };
    adaptation.step(&measured, |y, v, a| DescribedForces::of(&Arm, y, v, a));
}

/// Forces of the described robot, which are a part of `update`.
#[unsafe(no_mangle)]
pub extern "C" fn described(k: u32) {
    let [y, v, a] = motion(k as usize % 4);
    core::hint::black_box(DescribedForces::of(&Arm, &y, &v, &a));
}

/// Bits of a term of the acting law.
#[unsafe(no_mangle)]
pub extern "C" fn acting(joint: u32, term: u32) -> u64 {
    let laws = online().as_ref().map(|online| online.adaptation.acting());
    let term = laws.and_then(|laws| laws.get(joint as usize)?.get(term as usize).copied());
    term.unwrap_or(0.0).to_bits()
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
