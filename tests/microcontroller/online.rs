//! The online estimator of friction on the PowerCube, for online.c.

#![no_std]

#[allow(dead_code)]
mod robot;

use core::cell::UnsafeCell;
use gelenk_adaptation::{Adaptation, AdaptationSettings, DescribedForces, Measured};
use gelenk_kernels::math::sin_cos;

gelenk_dynamics::dynamics!(struct Arm = crate::robot);

const PERIOD: f64 = 0.01;
const PERIODS: usize = 1000;

/// Positions and torques.
type Sample = [[f64; 2]; 2];

struct Shared<T>(UnsafeCell<T>);

// SAFETY: the processor runs one thread, and no interrupt calls these functions.
unsafe impl<T> Sync for Shared<T> {}

impl<T> Shared<T> {
    #[allow(clippy::mut_from_ref)]
    fn get(&self) -> &mut T {
        // SAFETY: as above, and no function keeps the reference.
        unsafe { &mut *self.0.get() }
    }
}

static ESTIMATOR: Shared<Option<Adaptation<2>>> = Shared(UnsafeCell::new(None));

/// Measurements of a motion whose friction is a fifth less than described.
static SAMPLES: Shared<[Sample; PERIODS]> = Shared(UnsafeCell::new([[[0.0; 2]; 2]; PERIODS]));

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
    *ESTIMATOR.get() = Adaptation::for_robot(&Arm, AdaptationSettings::new(PERIOD)).ok();
    for (k, [positions, torques]) in SAMPLES.get().iter_mut().enumerate() {
        let [y, v, a] = motion(k);
        let described = DescribedForces::of(&Arm, &y, &v, &a);
        (*positions, *torques) = (y, core::array::from_fn(|i| described.forces[i] - 0.2 * described.friction[i]));
    }
}

/// One period of the estimator.
#[unsafe(no_mangle)]
pub extern "C" fn update(k: u32) {
    let (Some(adaptation), Some([y, torques])) = (ESTIMATOR.get(), SAMPLES.get().get(k as usize)) else { return };
    let measured = Measured { positions: Some(*y), torques: *torques, saturated: [false; 2], periods: 1 };
    adaptation.step(&measured, |y, v, a| DescribedForces::of(&Arm, y, v, a));
}

/// Forces of the described robot, which are a part of `update`.
#[unsafe(no_mangle)]
pub extern "C" fn described(k: u32) {
    let [y, v] = SAMPLES.get().get(k as usize).copied().unwrap_or_default();
    core::hint::black_box(DescribedForces::of(&Arm, &y, &v, &y));
}

/// Bits of a term of the acting law.
#[unsafe(no_mangle)]
pub extern "C" fn acting(joint: u32, term: u32) -> u64 {
    let laws = ESTIMATOR.get().as_ref().map(Adaptation::acting);
    let term = laws.and_then(|laws| laws.get(joint as usize)?.get(term as usize).copied());
    term.unwrap_or(0.0).to_bits()
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
