//! Controllers of the PowerCube that learn its friction. The described friction is a quarter too large; the learned law, from an earlier
//! motion, acts from the first period on.

use super::robot::{PdOf, PowerCube, motion, pd_of};
use gelenk_runtime::adaptation::{
    Adaptation, AdaptationSettings, Adaptive, Carrying, DescribedForces, LearnedFriction, Measured, Trust,
};
use gelenk_runtime::dynamics::Dynamics;

gelenk_runtime::dynamics!(pub struct Described { parameters } = gelenk_generated::powercube_parameters);

/// Described over true friction.
const EXCESS: f64 = 1.25;

pub type Model = LearnedFriction<Described, 2, 2>;
pub type Made<C> = Adaptive<C, Described, 2, 2>;
pub type Pd = Made<PdOf<Model>>;

pub fn pd(rate: f64) -> Pd {
    made(rate, |model| pd_of(model, motion(), rate))
}

/// A controller that also learns the mass of a load.
pub fn carrying(friction: Pd) -> Carrying<PdOf<Model>, Described, 2, 2, 1> {
    Carrying::new(friction, [[0.0, 2.0]], |arm, [mass]| {
        let mut loaded = *arm;
        loaded.parameters.load = *mass;
        loaded
    })
    .unwrap()
}

/// A controller that learns, with what it has learned before.
pub fn made<C>(rate: f64, make: impl FnOnce(Model) -> C) -> Made<C> {
    let make = |model| Ok::<C, std::convert::Infallible>(make(model));
    let mut made = Adaptive::new(described(), AdaptationSettings::new(1.0 / rate), make).unwrap().unwrap();
    teach(made.adaptation_mut(), 1.0 / rate);
    made
}

pub fn described() -> Described {
    let mut arm = Described::default();
    let p = &mut arm.parameters;
    let of_beta = [&mut p.beta_viscous, &mut p.beta_tanh_5, &mut p.beta_tanh_10, &mut p.beta_tanh_20];
    let of_gamma = [&mut p.gamma_viscous, &mut p.gamma_sign, &mut p.gamma_tanh_5, &mut p.gamma_tanh_10];
    for parameter in of_beta.into_iter().chain(of_gamma).chain([&mut p.gamma_tanh_100]) {
        *parameter *= EXCESS;
    }
    arm
}

/// Moves the true arm for half a minute.
fn teach(adaptation: &mut Adaptation<2>, period: f64) {
    let described = described();
    for k in 0..(30.0 / period) as u32 {
        let t = period * f64::from(k);
        let [y, v, a] = [
            [0.4 * t.sin(), 0.4 * (1.3 * t).sin()],
            [0.4 * t.cos(), 0.52 * (1.3 * t).cos()],
            [-0.4 * t.sin(), -0.676 * (1.3 * t).sin()],
        ];
        let torques = PowerCube.inverse_dynamics(&y, &v, &a);
        let measured = Measured { positions: Some(y), torques, saturated: [false; 2], periods: 1 };
        adaptation.step(&measured, |y, v, a| DescribedForces::of(&described, y, v, a));
    }
    assert_acts(adaptation);
}

/// The learned law acts, with the described excess of its viscous term or of all terms.
pub fn assert_acts(adaptation: &Adaptation<2>) {
    for (i, v) in [0.3, -0.3].into_iter().enumerate() {
        let state = adaptation.states()[i].unwrap();
        assert_eq!(state.trust, Trust::Learned, "{state:?}");
        let described = described().friction_torques(&[0.0; 2], &[v; 2])[i];
        let [learned, half] = adaptation.friction(i, described, v).unwrap();
        let truth = PowerCube.friction_torques(&[0.0; 2], &[v; 2])[i];
        assert!((learned - truth).abs() < 0.03 * truth.abs(), "{learned} ± {half} {truth} {state:?}");
    }
}
