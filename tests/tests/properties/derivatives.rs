//! Derivatives against slopes by dual numbers, and what wrenches add.

use super::*;

/// A function's first result differentiated by each entry of one input, rows first.
fn derivative(case: &Case, name: &str, inputs: &[&[f64]], by: usize) -> Vec<f64> {
    let column = |j: usize| {
        let arrays: Vec<Vec<Dual64>> = (0..inputs.len())
            .map(|array| {
                let unit = |i: usize| f64::from(u8::from(array == by && i == j));
                let entries = inputs[array].iter().enumerate();
                entries.map(|(i, &x)| Dual64::new(x, unit(i))).collect()
            })
            .collect();
        let arrays: Vec<&[Dual64]> = arrays.iter().map(Vec::as_slice).collect();
        case.rate(name, &arrays)
    };
    let columns: Vec<Vec<f64>> = (0..inputs[by].len()).map(column).collect();
    let rows = case.state.y.len();
    (0..rows).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
}

/// Largest entry, of a matrix whose errors are relative to it.
fn size(matrix: &[f64]) -> f64 {
    matrix.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[test]
fn derivatives_of_inverse_dynamics_are_its_slopes() {
    on_all(|case| {
        let (y, v, a) = (&case.state.y, &case.state.v, &case.state.a);
        let inputs: [&[f64]; 3] = [y, v, a];
        let forces = case.call("inverse_dynamics", &inputs);
        let by_y = derivative(case, "inverse_dynamics", &inputs, 0);
        let by_v = derivative(case, "inverse_dynamics", &inputs, 1);
        let scale = case.scales.forces();
        for name in ["inverse_dynamics_derivatives", "inverse_dynamics_derivatives_and_mass_matrix"] {
            let found = case.call_all(name, &inputs);
            case.close("forces", &found[0], &forces, scale);
            case.close("∂/∂y", &found[1], &by_y, scale + size(&by_y));
            case.close("∂/∂ẏ", &found[2], &by_v, scale + size(&by_v));
            if let Some(mass) = found.get(3) {
                case.close("M", mass, &case.call("mass_matrix", &[y]), case.scales.mass);
            }
        }
    });
}

/// Errors grow with the condition number of M, once for M⁻¹ and once for what is solved with it.
#[test]
fn derivatives_of_forward_dynamics_are_its_slopes() {
    on_all(|case| {
        let Sample { y, v, u, .. } = case.state;
        let inputs: [&[f64]; 3] = [y, v, u];
        let n = y.len();
        let accelerations = case.call("forward_dynamics", &inputs);
        let slopes = [0, 1, 2].map(|by| derivative(case, "forward_dynamics", &inputs, by));
        let growth = condition_of(&case.oracle.mass_matrix(y));
        // Loops do not know which terms cancel exactly: their errors are relative to what is summed.
        let has_loops = case.function("forward_dynamics_derivatives").arrays.is_some();
        let Scales { mass, coriolis, gravity, other, .. } = case.scales;
        let summed = match has_loops {
            true => (coriolis + gravity + other) / mass,
            false => 0.0,
        };
        let of = |matrix: &[f64]| growth * (size(matrix) + size(&accelerations) + summed);
        let found = case.call_all("forward_dynamics_derivatives", &inputs);
        case.close("ÿ", &found[0], &accelerations, of(&accelerations));
        case.close("∂ÿ/∂y", &found[1], &slopes[0], of(&slopes[0]));
        case.close("∂ÿ/∂ẏ", &found[2], &slopes[1], of(&slopes[1]));
        let mass = case.call("mass_matrix", &[y]);
        let identity: Vec<f64> = (0..n * n).map(|at| f64::from(u8::from(at / n == at % n))).collect();
        let product: Vec<f64> = (0..n * n)
            .map(|at| {
                let (i, j) = (at / n, at % n);
                (0..n).map(|k| mass[i * n + k] * found[3][k * n + j]).sum()
            })
            .collect();
        case.close("M M⁻¹", &product, &identity, growth);
        let linear = case.call_all("linearize", &inputs);
        for (k, slope) in slopes.iter().enumerate() {
            case.close("∂ÿ", &linear[k], slope, of(slope));
        }
        let parts = [(&linear[0], y), (&linear[1], v), (&linear[2], u)];
        let mut model = linear[3].clone();
        let mut scale = of(&accelerations);
        for (matrix, x) in parts.into_iter().filter(|(_, x)| !x.is_empty()) {
            model = plus(&model, &times(matrix, x));
            scale += of(matrix) * x.iter().map(|x| x.abs()).sum::<f64>();
        }
        case.close("A x + B u + c", &model, &accelerations, scale);
    });
}

/// The functions with wrenches, against `Jᵀ w` with the Jacobian of the frames by dual numbers, and against the
/// functions without them.
#[test]
fn wrenches_act_by_the_jacobians_of_their_frames() {
    let robots = ROBOTS.iter().filter(|(_, robot)| !robot.model.wrenches.is_empty());
    let mut tried = 0;
    for &(seed, ref robot) in robots {
        let mut rng = Rng::with_seed(seed ^ 0x77);
        let state = random_sample(&mut rng, &robot.model);
        let w: Vec<f64> = (0..6 * robot.model.wrenches.len()).map(|_| 4.0 * rng.f64() - 2.0).collect();
        let oracle = Oracle { model: &robot.model, parameters: &state.parameters };
        let case = Case { seed, robot, state: &state, scales: Scales::of(&oracle, &state), oracle };
        check_wrenches(&case, &w);
        tried += 1;
    }
    assert!(tried >= FORCE_SEEDS.count());
}

fn check_wrenches(case: &Case, w: &[f64]) {
    let Sample { y, v, a, u, .. } = case.state;
    let forces = case.call("wrench_forces", &[y, w]);
    let expected = case.oracle.wrench_forces(y, w);
    let own = size(&expected).max(1.0);
    case.close("Jᵀ w", &forces, &expected, own);
    let scale = case.scales.forces() + own;
    let slopes = case.call_all("wrench_forces_derivatives", &[y, w]);
    let by_y = derivative(case, "wrench_forces", &[y, w], 0);
    case.close("Jᵀ w", &slopes[0], &forces, own);
    case.close("∂(Jᵀ w)/∂y", &slopes[1], &by_y, own + size(&by_y));

    let held = case.call("inverse_dynamics_with_wrenches", &[y, v, a, w]);
    case.close("f", &held, &minus(&case.call("inverse_dynamics", &[y, v, a]), &forces), scale);
    let inputs: [&[f64]; 4] = [y, v, a, w];
    let found = case.call_all("inverse_dynamics_derivatives_with_wrenches", &inputs);
    case.close("f", &found[0], &held, scale);
    for by in [0, 1] {
        let slope = derivative(case, "inverse_dynamics_with_wrenches", &inputs, by);
        case.close("∂f", &found[1 + by], &slope, scale + size(&slope));
    }

    let inputs: [&[f64]; 4] = [y, v, u, w];
    let accelerations = case.call("forward_dynamics_with_wrenches", &inputs);
    let made = case.call("inverse_dynamics_with_wrenches", &[y, v, &accelerations, w]);
    let residual = scale + case.scales.mass * size(&accelerations) * y.len() as f64;
    case.close("f − B u", &made, &joint_forces(&case.oracle, y, u), residual);
    let found = case.call_all("forward_dynamics_derivatives_with_wrenches", &inputs);
    let growth = condition_of(&case.oracle.mass_matrix(y));
    let of = |matrix: &[f64]| growth * (size(matrix) + size(&accelerations));
    case.close("ÿ", &found[0], &accelerations, of(&accelerations));
    for by in [0, 1] {
        let slope = derivative(case, "forward_dynamics_with_wrenches", &inputs, by);
        case.close("∂ÿ", &found[1 + by], &slope, of(&slope));
    }
}
