//! Random robots with spherical and floating joints, with rotors, springs, friction, couplings and forces at frames: functions
//! against the equations of Poincaré.

use fastrand::Rng;
use gelenk_codegen::model::Model;
use gelenk_tests::agreement::truth::State;
use gelenk_tests::agreement::{LOOPS, a_third, assert_agreement};
use gelenk_tests::quaternion_model::with_quaternions;
use gelenk_tests::random_model::{
    random_coupled_model, random_helical_model, random_model, random_model_with_frame_forces,
};

/// Every fourth robot is of one kind, and has another third of the functions compared.
const KINDS: [fn(u64, usize) -> Model; 4] =
    [random_model, random_coupled_model, random_helical_model, random_model_with_frame_forces];

#[test]
fn functions_of_robots_with_quaternions_agree_with_the_equations() {
    let (mut floating, mut spherical, mut carried, mut pushed, mut all_loops) = (0, 0, 0, 0, 0);
    for (number, kind) in (0..12).zip(KINDS.into_iter().cycle()) {
        let seed = number as u64;
        let model = with_quaternions(kind(seed, 3), seed);
        for joint in &model.quaternion_joints {
            *(if joint.kind.velocities() == 6 { &mut floating } else { &mut spherical }) += 1;
            carried += usize::from(joint.kind.velocities() == 6 && joint.name == "ball");
        }
        pushed += usize::from(!model.wrenches.is_empty());
        let state = State::random(&mut Rng::with_seed(seed), &model);
        let compared = assert_agreement(&format!("seed {seed}"), &model, &state, &a_third(&model, number));
        all_loops += usize::from(compared.iter().filter(|each| each.is_loops).count() == LOOPS.len());
    }
    // Those with forces at frames have none.
    assert!(all_loops >= 2, "{all_loops} with loops");
    assert!(floating >= 8 && spherical >= 3, "{floating} floating, {spherical} spherical");
    assert!(carried >= 1, "{carried} floating joints on arms");
    assert!(pushed >= 2, "{pushed} with wrenches");
}
