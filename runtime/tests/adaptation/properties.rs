//! Limits of learning, on simulated joints.

use super::random::SplitMix64;
use super::warming::{Drift, PERIOD, Simulated, coverage};
use gelenk_runtime::adaptation::{
    Adaptation, AdaptationError, AdaptationSettings, DescribedForces, JointState, LoadEstimator, Measured,
    TERMS, Trust,
};
use gelenk_runtime::dynamics::Dynamics;

gelenk_runtime::dynamics!(struct Panda = gelenk_generated::panda);

fn settings() -> AdaptationSettings {
    AdaptationSettings::new(PERIOD)
}

fn state(adaptation: &Adaptation<1>) -> JointState {
    adaptation.states()[0].unwrap()
}

/// A joint and its estimator after some seconds.
fn after(seconds: u32, mut joint: Simulated) -> (Simulated, Adaptation<1>) {
    let mut adaptation = joint.estimator(settings());
    for _ in 0..100 * seconds {
        joint.step(&mut adaptation);
    }
    (joint, adaptation)
}

/// Shares of intervals that hold in the first and in the second half of the run: friction drifts with 40 to 160 s.
fn halves(held: &[f64; 10]) -> [f64; 2] {
    [&held[..5], &held[5..]].map(|half| half.iter().sum::<f64>() / 5.0)
}

#[test]
fn intervals_hold_during_drift() {
    let found = coverage(1, 120, settings());
    let all = found.held.iter().sum::<f64>() / 10.0;
    let [during, after] = halves(&found.held);
    println!("90 % intervals hold {:.1} %, {during:.3}, {after:.3}: {:?}", 100.0 * all, found.held);
    assert!([all, during].iter().all(|held| (0.87..=0.93).contains(held)), "{all}, {:?}", found.held);
    assert!(found.errors[0] < 0.04 * found.errors[1], "{:?}", found.errors);
    assert!(found.learned > 0.99, "{}", found.learned);
}

#[test]
fn a_joint_at_rest_learns_nothing_and_its_intervals_do_not_shrink() {
    let mut joint = Simulated::new(3);
    joint.motion = [[0.0; 3]; 3];
    let mut adaptation = joint.estimator(settings());
    let prior = state(&adaptation);
    for _ in 0..60_000 {
        joint.step(&mut adaptation);
        let now = state(&adaptation);
        assert_eq!((now.learned, now.is_learning), ([0.0; TERMS], false));
        assert!((0..TERMS).all(|k| now.half_widths[k] >= prior.half_widths[k] * (1.0 - 1e-12)));
    }
    let now = state(&adaptation);
    assert_eq!((now.trust, now.is_excited), (Trust::Unknown, [false; TERMS]));
}

#[test]
fn rest_after_motion_widens_the_intervals_and_keeps_the_law() {
    for seed in 3..13 {
        let (mut joint, mut adaptation) = after(100, Simulated::new(seed));
        joint.motion = [[0.0; 3]; 3];
        for _ in 0..500 {
            joint.step(&mut adaptation);
        }
        let first = state(&adaptation);
        let mut last = first;
        for _ in 0..60_000 {
            joint.step(&mut adaptation);
            let now = state(&adaptation);
            assert!((0..TERMS).all(|k| now.half_widths[k] >= last.half_widths[k] * (1.0 - 1e-9)), "{now:?}");
            last = now;
        }
        assert!(last.half_widths[0] > 1.5 * first.half_widths[0], "{last:?} {first:?}");
        assert_eq!((last.trust, last.learned), (Trust::Learned, first.learned));
    }
}

/// A gear whose torque ripples with the position, and one motion over and over.
#[test]
fn a_repeated_motion_does_not_shrink_the_interval_below_the_error() {
    let mut held = 0;
    for seed in 0..20 {
        let mut joint = Simulated::new(100 + seed);
        joint.drift = Drift::NONE;
        joint.motion[1] = [0.0; 3];
        joint.motion[2] = [0.0; 3];
        let ripple = 0.2 * joint.friction.coulomb;
        let mut adaptation = joint.estimator(settings());
        let mut step = |joint: &mut Simulated| {
            let period = joint.period();
            // The torque that the ripple of the gear needs.
            let torques = [period.torque + ripple * (9.0 * period.position + seed as f64).sin()];
            let measured =
                Measured { positions: Some([period.position]), torques, saturated: [false], periods: 1 };
            adaptation.step(&measured, |y, v, a| joint.forces(y[0], v[0], a[0]));
        };
        (0..60_000).for_each(|_| step(&mut joint));
        let v = 0.8 * joint.motion[0][0] * joint.motion[0][1];
        let [law, half] = adaptation.friction(0, joint.described(v), v).unwrap();
        held += u32::from((law - joint.true_friction(v)).abs() <= half);
    }
    println!("{held} of 20 intervals hold");
    assert!(held >= 15, "{held} of 20");
}

#[test]
fn a_jump_of_friction_is_followed() {
    let mut joint = Simulated::new(5);
    joint.drift = Drift::NONE;
    let (mut joint, mut adaptation) = after(60, joint);
    joint.drift = Drift { viscous: 0.5, dry: 0.4, time: 1e-3 };
    let mut followed = None;
    for k in 0..12_000 {
        joint.step(&mut adaptation);
        let [law, _] = adaptation.friction(0, joint.described(0.8), 0.8).unwrap();
        let (truth, change) = (joint.true_friction(0.8), joint.described(0.8) - joint.true_friction(0.8));
        followed = if (law - truth).abs() < 0.1 * change { followed.or(Some(k)) } else { None };
    }
    println!("90 % of a jump are followed after {followed:?} periods");
    assert!(followed.is_some_and(|periods| f64::from(periods) * PERIOD < 60.0), "{followed:?}");
    assert_eq!(state(&adaptation).trust, Trust::Learned);
}

/// The acting law differs from the described one by less than 5 % of the friction at the largest speed in each period, and in the end
/// not at all.
#[test]
fn a_swapped_sign_of_the_torque_is_not_learned() {
    let mut most = 0.0_f64;
    for seed in 0..10 {
        let mut joint = Simulated::new(200 + seed);
        joint.drift = Drift::NONE;
        let mut adaptation = joint.estimator(settings());
        let scale = adaptation.scales()[0].unwrap();
        let bounds = scale.bounds(1.0);
        for _ in 0..30_000 {
            let period = joint.period();
            let (positions, torques) = (Some([period.position]), [-period.torque]);
            let measured = Measured { positions, torques, saturated: [false], periods: 1 };
            adaptation.step(&measured, |y, v, a| joint.forces(y[0], v[0], a[0]));
            let shares =
                state(&adaptation).acting.into_iter().zip(bounds).map(|(delta, bound)| delta.abs() / bound);
            most = shares.fold(most, f64::max);
        }
        assert_eq!(state(&adaptation).trust, Trust::Contradicted);
    }
    println!("a term changes by at most {:.1} % of its box", 100.0 * most);
    assert!(most < 0.05, "{most}");
}

#[test]
fn a_stuck_encoder_and_saturation_teach_nothing() {
    for is_stuck in [true, false] {
        let mut joint = Simulated::new(9);
        let mut adaptation = joint.estimator(settings());
        let before = state(&adaptation).half_widths;
        for _ in 0..20_000 {
            let period = joint.period();
            let measured = Measured {
                positions: Some([if is_stuck { 0.1 } else { period.position }]),
                torques: [period.torque],
                saturated: [!is_stuck],
                periods: 1,
            };
            adaptation.step(&measured, |y, v, a| joint.forces(y[0], v[0], a[0]));
        }
        let now = state(&adaptation);
        assert_eq!((now.learned, now.acting), ([0.0; TERMS], [0.0; TERMS]));
        assert!((0..TERMS).all(|k| now.half_widths[k] >= before[k] * (1.0 - 1e-12)));
    }
}

/// Acting laws dissipate, whatever was learned.
#[test]
fn laws_dissipate_at_all_speeds() {
    let joint = Simulated::new(11);
    let adaptation = joint.estimator(settings());
    let scale = adaptation.scales()[0].unwrap();
    let bounds = scale.bounds(0.9);
    let mut random = joint.random.clone();
    for _ in 0..2000 {
        let delta = core::array::from_fn(|k| 3.0 * bounds[k] * random.normal());
        let delta = scale.admissible(delta, &bounds);
        assert!((0..TERMS).all(|k| delta[k].abs() <= bounds[k]));
        for step in -200..=200 {
            let v = 2.0 * scale.speed * f64::from(step) / 200.0;
            let shape = joint.described(v);
            let friction = shape + delta[0] * shape + delta[1] * v + delta[3] * shape.abs();
            assert!(v * friction >= -1e-9 * scale.torque, "{v}: {friction} by {delta:?}");
        }
    }
}

#[test]
fn what_was_learned_is_saved_and_restored() {
    let (mut joint, adaptation) = after(60, Simulated::new(13));
    let mut saved = vec![0.0; Adaptation::<1>::SAVED];
    adaptation.save(&mut saved).unwrap();
    let mut again = joint.estimator(settings());
    again.restore(&saved).unwrap();
    let mut twice = vec![0.0; saved.len()];
    again.save(&mut twice).unwrap();
    assert_eq!(saved, twice);
    assert_eq!(state(&again).learned, state(&adaptation).learned);
    joint.step(&mut again);
    assert_eq!(state(&again).trust, Trust::Learned);

    let wrong = |change: fn(&mut Vec<f64>)| {
        let mut numbers = saved.clone();
        change(&mut numbers);
        let mut estimator = joint.estimator(settings());
        let before = estimator.clone();
        let error = estimator.restore(&numbers).unwrap_err();
        assert_eq!(estimator, before);
        error
    };
    assert_eq!(wrong(|numbers| numbers[0] += 1.0), AdaptationError::Origin("description"));
    assert_eq!(wrong(|numbers| numbers[4] *= 2.0), AdaptationError::Origin("time constant"));
    assert_eq!(wrong(|numbers| numbers[9] = f64::NAN), AdaptationError::Number(6));
    assert!(matches!(wrong(|numbers| numbers.truncate(5)), AdaptationError::Length { found: 5, .. }));
}

/// Inertia and weight of a load, two parameters of one joint: picked up, then put down.
#[test]
fn a_load_is_learned_and_forgotten() {
    let mut joint = Simulated::new(21);
    joint.drift = Drift::NONE;
    let empty = joint.clone();
    let mut adaptation = empty.estimator(settings());
    let most = [empty.inertia, 10.0 * empty.inertia];
    let mut load = LoadEstimator::<1, 2>::new(most.map(|most| [0.0, most])).unwrap();
    for share in [0.0, 0.4, 0.0] {
        let truth = most.map(|most| share * most);
        (joint.inertia, joint.gravity) = (empty.inertia + truth[0], empty.gravity + truth[1]);
        for _ in 0..6000 {
            let (period, acting) = (joint.period(), *load.acting());
            let mut columns = None;
            let (positions, torques) = (Some([period.position]), [period.torque]);
            let measured = Measured { positions, torques, saturated: [false], periods: 1 };
            adaptation.step(&measured, |y, v, a| {
                columns = Some([[a[0], y[0].sin()]]);
                let mut forces = empty.forces(y[0], v[0], a[0]);
                forces.forces[0] += acting[0] * a[0] + acting[1] * y[0].sin();
                forces
            });
            load.step(columns.as_ref(), &adaptation);
        }
        let state = load.state();
        println!("{truth:?}: {state:?}");
        let held = |k: usize| (state.learned[k] - truth[k]).abs() < 2.0 * state.half_widths[k];
        assert!((0..2).all(held), "{truth:?}: {state:?}");
        let is_found = state.half_widths[1] < 0.1 * most[1] && state.trust == Trust::Learned;
        assert!(share == 0.0 || is_found, "{state:?}");
    }
    let error = LoadEstimator::<1, 1>::new([[1.0, 2.0]]).unwrap_err();
    assert_eq!(error, AdaptationError::Load(0));
}

/// Torques at the joints of a unit of mass, of first moments and of moments of inertia `xx, yy, zz, xy, xz, yz` about the tool.
fn columns_of_a_body([y, v, a]: &[[f64; 7]; 3]) -> [[f64; 10]; 7] {
    const H: f64 = 1e-5;
    use gelenk_generated::panda::{frame_tool_jacobian, frame_tool_pose};
    let turned = |sign: f64| frame_tool_jacobian(&core::array::from_fn(|i| y[i] + sign * H * v[i]));
    let (jacobian, [ahead, behind]) = (frame_tool_jacobian(y), [turned(1.0), turned(-1.0)]);
    let sum = |row: &[f64; 7], x: &[f64; 7]| row.iter().zip(x).map(|(j, x)| j * x).sum::<f64>();
    let spatial: [f64; 6] =
        core::array::from_fn(|k| sum(&jacobian[k], a) + (sum(&ahead[k], v) - sum(&behind[k], v)) / (2.0 * H));
    let axes = frame_tool_pose(y).1;
    // In the axes of the tool; gravity is an acceleration upwards.
    let inside =
        |x: [f64; 3]| -> [f64; 3] { core::array::from_fn(|i| (0..3).map(|k| axes[k][i] * x[k]).sum()) };
    let up = inside([spatial[0], spatial[1], spatial[2] + 9.80665]);
    let alpha = inside([spatial[3], spatial[4], spatial[5]]);
    let omega = inside(core::array::from_fn(|k| sum(&jacobian[3 + k], v)));
    let cross = |a: &[f64; 3], b: &[f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let wrench = |k: usize| -> [[f64; 3]; 2] {
        let zero = [0.0; 3];
        match k {
            0 => [up, zero],
            1..4 => {
                let unit = core::array::from_fn(|i| f64::from(u8::from(i == k - 1)));
                let (tangential, inwards) = (cross(&alpha, &unit), cross(&omega, &cross(&omega, &unit)));
                [core::array::from_fn(|i| tangential[i] + inwards[i]), cross(&unit, &up)]
            }
            _ => {
                let (i, j) = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)][k - 4];
                let times = |x: &[f64; 3]| {
                    let mut product = zero;
                    product[i] = x[j];
                    product[j] = x[i];
                    product
                };
                let (of_alpha, of_omega) = (times(&alpha), cross(&omega, &times(&omega)));
                [zero, core::array::from_fn(|i| of_alpha[i] + of_omega[i])]
            }
        }
    };
    let of_parameter: [[f64; 7]; 10] = core::array::from_fn(|k| {
        let [force, moment] = wrench(k)
            .map(|x| -> [f64; 3] { core::array::from_fn(|i| (0..3).map(|k| axes[i][k] * x[k]).sum()) });
        core::array::from_fn(|i| {
            (0..3).map(|r| jacobian[r][i] * force[r] + jacobian[3 + r][i] * moment[r]).sum()
        })
    });
    core::array::from_fn(|i| core::array::from_fn(|k| of_parameter[k][i]))
}

/// A body at the tool of a seven-axis arm, with noisy torques: the ten parameters are within their intervals, and explain its torques.
#[test]
fn the_ten_parameters_of_a_body_are_learned() {
    const TRUTH: [f64; 10] = [2.0, 0.1, -0.06, 0.3, 0.08, 0.085, 0.02, 0.003, -0.015, 0.009];
    let most = [4.0, 1.0, 1.0, 1.0, 0.2, 0.2, 0.2, 0.1, 0.1, 0.1];
    let mut load = LoadEstimator::<7, 10>::new(most.map(|most| [-most, most])).unwrap();
    let mut adaptation = Adaptation::for_robot(&Panda, settings()).unwrap();
    let mut random = SplitMix64::new(3);
    let with = |columns: &[[f64; 10]; 7], load: &[f64; 10]| {
        columns.map(|row| row.iter().zip(load).map(|(column, value)| column * value).sum::<f64>())
    };
    let (mut of_load, mut left) = (0.0, 0.0);
    for k in 0..6000 {
        let t = PERIOD * f64::from(k);
        let rates: [f64; 7] = core::array::from_fn(|i| 0.9 + 0.17 * i as f64);
        let center = [0.0, 0.0, 0.0, -1.5, 0.0, 1.5, 0.0];
        let [y, v, a]: [[f64; 7]; 3] = [
            core::array::from_fn(|i| center[i] + 0.5 * (rates[i] * t).sin()),
            rates.map(|rate| 0.5 * rate * (rate * t).cos()),
            rates.map(|rate| -0.5 * rate * rate * (rate * t).sin()),
        ];
        let columns = columns_of_a_body(&[y, v, a]);
        let (forces, more) = (Panda.inverse_dynamics(&y, &v, &a), with(&columns, &TRUTH));
        let torques = core::array::from_fn(|i| forces[i] + more[i] + 0.05 * random.normal());
        let measured = Measured { positions: Some(y), torques, saturated: [false; 7], periods: 1 };
        let (acting, mut at) = (*load.acting(), None);
        adaptation.step(&measured, |y, v, a| {
            let columns = columns_of_a_body(&[*y, *v, *a]);
            at = Some(columns);
            let mut described = DescribedForces::of(&Panda, y, v, a);
            described.forces.iter_mut().zip(with(&columns, &acting)).for_each(|(force, more)| *force += more);
            described
        });
        load.step(at.as_ref(), &adaptation);
        if k > 5000 {
            for (truth, acting) in more.iter().zip(with(&columns, load.acting())) {
                of_load += truth * truth;
                left += (truth - acting).powi(2);
            }
        }
    }
    let state = load.state();
    println!("{state:?}, error {:.4} of the load's torques", f64::sqrt(left / of_load));
    assert_eq!(state.trust, Trust::Learned);
    for k in 0..10 {
        let (learned, half) = (state.learned[k], state.half_widths[k]);
        assert!(
            (learned - TRUTH[k]).abs() < 2.0 * half && half < 0.5 * most[k],
            "{k}: {learned} ± {half}, {}",
            TRUTH[k]
        );
    }
    assert!(left < 0.05 * 0.05 * of_load, "{left} {of_load}");
}

#[test]
fn settings_are_checked() {
    let joint = Simulated::new(1);
    let wrong = AdaptationSettings { memory: 1.0, ..settings() };
    let scale = joint.estimator(settings()).scales()[0];
    let error = Adaptation::new([scale], wrong, |y, v, a| joint.forces(y[0], v[0], a[0])).unwrap_err();
    assert_eq!(
        error.to_string(),
        "setting memory of the adaptation is 1, but must be at least 100 time constants (s)"
    );
}

/// Viscous friction drops by more than an offline interval allows.
#[test]
fn a_term_stops_at_the_bound_of_an_offline_interval() {
    let joint = Simulated::new(6);
    let mut adaptation = joint.estimator(settings());
    let free = state(&adaptation);
    let usual = adaptation.scales()[0].unwrap().bounds(settings().largest_change);
    let most = [0.0, 0.05 * joint.friction.viscous, usual[2], f64::INFINITY, 0.0];
    adaptation.set_bounds(0, most).unwrap();
    let mut joint = joint;
    joint.drift = Drift { viscous: 0.5, dry: 1.0, time: 1e-3 };
    for _ in 0..12_000 {
        joint.step(&mut adaptation);
        let now = state(&adaptation);
        assert!((0..TERMS).all(|k| now.learned[k].abs() <= most[k].min(usual[k])), "{now:?}");
    }
    let now = state(&adaptation);
    assert_eq!((now.learned[0], now.learned[1], now.trust), (0.0, -most[1], Trust::Learned));
    assert_eq!(now.terms().map(|term| term.name).collect::<Vec<_>>(), ["viscous", "offset", "asymmetry"]);
    assert!(free.half_widths[1] > 5.0 * now.half_widths[1]);

    let mut numbers = vec![0.0; Adaptation::<1>::SAVED];
    adaptation.save(&mut numbers).unwrap();
    assert!(matches!(
        joint.estimator(settings()).restore(&numbers),
        Err(AdaptationError::Origin("description"))
    ));
    let mut same = joint.estimator(settings());
    same.set_bounds(0, [1.0; TERMS]).unwrap();
    same.set_bounds(0, most).unwrap();
    same.restore(&numbers).unwrap();
    assert_eq!(state(&same).learned, now.learned);
    for wrong in [[f64::NAN; TERMS], [-1.0; TERMS]] {
        assert_eq!(adaptation.set_bounds(0, wrong), Err(AdaptationError::Bounds(0)));
    }
    assert_eq!(adaptation.set_bounds(1, most), Err(AdaptationError::Bounds(1)));
}
