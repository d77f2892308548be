//! Expected results of every function of a module, by the name of the function.

use nalgebra::DMatrix;

use super::case::{By, Case, Rows, matrix_product, minus, multiplied, negative, plus, scaled, transposed};
use super::momentum;
use super::number::{Dual, Number};
use super::parameters;
use super::space;
use crate::function_names::{self as names, FrameKind};
use crate::functions::function::{Constant, Function};
use crate::model::Attachment;

/// Expected results of a function, each flat and row-major.
pub struct Expected<T> {
    pub results: Vec<Vec<T>>,
    /// Factor by which divisions amplify rounding errors:
    ///
    /// - for functions that divide by the mass matrix, the growth that `inverse` returns
    /// - infinity if the result is undefined because the mass is zero
    /// - 1 for all other functions
    pub condition: f64,
}

/// Expected results of a function; `None` if the name is unknown.
pub fn expected<T: Number>(case: &Case<'_, T>, function: &Function) -> Option<Expected<T>> {
    if let Some(results) =
        of_frame(case, &function.name).or_else(|| plain(case, &function.name, &function.constants))
    {
        let divides_by_mass = [
            names::CENTER_OF_MASS,
            names::CENTER_OF_MASS_JACOBIAN,
            names::CENTROIDAL_MOMENTUM_MATRIX,
            names::CENTROIDAL_MOMENTUM,
        ];
        let is_undefined = divides_by_mass.contains(&function.name.as_str()) && !momentum::has_mass(case);
        return Some(Expected { results, condition: if is_undefined { f64::INFINITY } else { 1.0 } });
    }
    divided(case, &function.name)
}

fn plain<T: Number>(case: &Case<'_, T>, name: &str, constants: &[Constant]) -> Option<Vec<Vec<T>>> {
    let mass_matrix = || case.mass_matrix(case.n()).concat();
    let applied = || minus(&plus(&case.gravity_forces(), &case.spring_forces()), &case.friction_torques());
    Some(match name {
        names::MASS_MATRIX => vec![mass_matrix()],
        names::CORIOLIS_FORCES => vec![case.coriolis_forces()],
        names::GRAVITY_FORCES => vec![case.gravity_forces()],
        names::SPRING_FORCES => vec![case.spring_forces()],
        names::FRICTION_TORQUES => vec![case.friction_torques()],
        names::LOAD_FRICTION => vec![case.load_friction()],
        names::APPLIED_FORCES => vec![applied()],
        names::BIAS_FORCES => vec![case.bias_forces()],
        names::INPUT_MATRIX => vec![case.input_matrix().concat()],
        names::INPUT_FORCES_DERIVATIVES => {
            let by_y = case.derivative(By::Positions, Case::input_forces);
            vec![case.input_forces(), by_y.concat()]
        }
        names::EQUATIONS_OF_MOTION => vec![mass_matrix(), case.coriolis_forces(), applied()],
        names::MASS_MATRIX_AND_BIAS_FORCES => vec![mass_matrix(), case.bias_forces()],
        names::INVERSE_DYNAMICS => vec![case.inverse_dynamics()],
        names::INVERSE_DYNAMICS_DERIVATIVES => inverse_derivatives(case),
        names::INVERSE_DYNAMICS_DERIVATIVES_AND_MASS_MATRIX => {
            [inverse_derivatives(case), vec![mass_matrix()]].concat()
        }
        names::WRENCH_FORCES => vec![case.wrench_forces()],
        names::WRENCH_FORCES_DERIVATIVES => {
            let by_y = case.derivative(By::Positions, Case::wrench_forces);
            vec![case.wrench_forces(), by_y.concat()]
        }
        names::INVERSE_DYNAMICS_WITH_WRENCHES => vec![case.inverse_dynamics_with_wrenches()],
        names::INVERSE_DYNAMICS_DERIVATIVES_WITH_WRENCHES => vec![
            case.inverse_dynamics_with_wrenches(),
            case.derivative(By::Positions, Case::inverse_dynamics_with_wrenches).concat(),
            case.derivative(By::Velocities, Case::inverse_dynamics_with_wrenches).concat(),
        ],
        names::INVERSE_DYNAMICS_HESSIAN => hessian(case),
        names::DRIVING_FORCES => vec![case.all_inverse_dynamics(&case.a).split_off(case.n())],
        names::JOINT_WRENCHES => vec![joint_wrenches(case)],
        names::KINETIC_ENERGY => vec![vec![momentum::kinetic_energy(case)]],
        names::POTENTIAL_ENERGY => vec![vec![momentum::potential_energy(case)]],
        names::CENTER_OF_MASS => vec![momentum::center(case).to_vec()],
        names::CENTER_OF_MASS_JACOBIAN => vec![momentum::center_jacobian(case).concat()],
        names::CENTROIDAL_MOMENTUM_MATRIX => vec![momentum::matrix(case).concat()],
        names::CENTROIDAL_MOMENTUM => vec![momentum::momentum(case, &case.v).to_vec()],
        names::INERTIAL_PARAMETERS => vec![parameters::inertial(case)],
        names::INERTIAL_REGRESSOR => vec![parameters::regressor(case).concat()],
        names::BASE_REGRESSOR => vec![parameters::base_regressor(case, constants)?.concat()],
        names::FRICTION_PARAMETERS => vec![parameters::friction(case)],
        names::FRICTION_REGRESSOR => vec![parameters::friction_regressor(case).concat()],
        _ => return None,
    })
}

fn inverse_derivatives<T: Number>(case: &Case<'_, T>) -> Vec<Vec<T>> {
    let by = |by| case.derivative(by, Case::inverse_dynamics).concat();
    vec![case.inverse_dynamics(), by(By::Positions), by(By::Velocities)]
}

/// Blocks of the Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with multipliers λ.
fn hessian<T: Number>(case: &Case<'_, T>) -> Vec<Vec<T>> {
    let block = |first, second| {
        let gradient = |case: &Case<'_, Dual<T>>| {
            let rows = case.derivative(second, Case::inverse_dynamics);
            multiplied(&transposed(&rows, rows.len()), &case.lambda)
        };
        let rows = case.derivative(first, gradient);
        transposed(&rows, rows.len())
    };
    let by_positions = block(By::Positions, By::Positions);
    // Two small motions one after the other differ from their sum by half their commutator, which has both signs here.
    let mirrored = transposed(&by_positions, by_positions.len());
    let symmetric = by_positions.iter().zip(&mirrored);
    let symmetric: Rows<T> = symmetric.map(|(a, b)| scaled(&plus(a, b), T::constant(0.5))).collect();
    vec![
        symmetric.concat(),
        block(By::Positions, By::Velocities).concat(),
        block(By::Velocities, By::Velocities).concat(),
        // The gradient by the accelerations is M λ.
        transposed(&case.derivative(By::Positions, Case::mass_times_multipliers), case.n()).concat(),
    ]
}

/// Expected results of the functions that divide by the mass matrix; `None` if the name is unknown.
fn divided<T: Number>(case: &Case<'_, T>, name: &str) -> Option<Expected<T>> {
    let mut case = case.clone();
    if matches!(name, names::FORWARD_DYNAMICS | names::FORWARD_DYNAMICS_DERIVATIVES | names::LINEARIZE) {
        case.w.clear();
    }
    let (inverse, condition) = inverse(&case.mass_matrix(case.n()));
    let accelerations = case.forward_dynamics(&inverse);
    let case = case.accelerated(&accelerations);
    let results = match name {
        names::FORWARD_DYNAMICS | names::FORWARD_DYNAMICS_WITH_WRENCHES => vec![accelerations],
        names::FORWARD_DYNAMICS_DERIVATIVES | names::FORWARD_DYNAMICS_DERIVATIVES_WITH_WRENCHES => {
            let [by_y, by_v] = acceleration_derivatives(&case, &inverse);
            vec![accelerations, by_y.concat(), by_v.concat(), inverse.concat()]
        }
        names::LINEARIZE => linearize(&case, &accelerations),
        _ => return None,
    };
    Some(Expected { results, condition })
}

/// Derivatives `∂ÿ = −(∂r/∂ÿ)⁻¹ ∂r` of the accelerations with respect to positions and velocities. r is the
/// residual of the equations of motion.
fn acceleration_derivatives<T: Number>(case: &Case<'_, T>, inverse: &Rows<T>) -> [Rows<T>; 2] {
    [By::Positions, By::Velocities].map(|by| {
        let rows = matrix_product(inverse, &case.derivative(by, Case::residual));
        rows.iter().map(|row| negative(row)).collect()
    })
}

fn linearize<T: Number>(case: &Case<'_, T>, accelerations: &[T]) -> Vec<Vec<T>> {
    // With load-dependent friction, the derivative with respect to the accelerations differs from M.
    let (inverse, _) = inverse(&case.derivative(By::Accelerations, Case::inverse_dynamics));
    let [by_y, by_v] = acceleration_derivatives(case, &inverse);
    let by_u = matrix_product(&inverse, &case.input_matrix());
    let n = case.n();
    let explained = plus(&multiplied(&by_v, &case.v[..n]), &multiplied(&by_u, &case.u));
    let has_quaternions = !case.model().quaternion_joints.is_empty();
    let explained = match has_quaternions {
        true => explained,
        false => plus(&explained, &multiplied(&by_y, &case.at.scalars[..n])),
    };
    let remainder = minus(accelerations, &explained);
    let drift = has_quaternions.then(|| drift(case).concat());
    let blocks = [by_y.concat(), by_v.concat(), by_u.concat(), remainder];
    blocks.into_iter().chain(drift).collect()
}

/// Matrix D in `δ̇ = D δ + v − v̄`. δ is the deviation from a motion with the velocities v̄. D is `−ad_v`
/// (the Lie bracket with v) in the rows of joints with quaternions, and 0 in all other rows.
fn drift<T: Number>(case: &Case<'_, T>) -> Rows<T> {
    let n = case.n();
    let mut rows = vec![vec![T::zero(); n]; n];
    let mut set = |row: usize, column: usize, first: usize| {
        let [x, y, z] = [case.v[first], case.v[first + 1], case.v[first + 2]];
        let o = T::zero();
        for (i, entries) in [[o, z, -y], [-z, o, x], [y, -x, o]].into_iter().enumerate() {
            rows[row + i][column..column + 3].copy_from_slice(&entries);
        }
    };
    for joint in &case.model().quaternion_joints {
        let turning = joint.coordinates().end - 3;
        set(turning, turning, turning);
        if joint.first < turning {
            set(joint.first, joint.first, turning);
            set(joint.first, turning, joint.first);
        }
    }
    rows
}

/// The inverse of a matrix with derivatives, and the growth of errors in a product with this inverse.
///
/// The growth is a product of two condition numbers: that of the matrix scaled to a diagonal of ones (Higham
/// 2002, section 10.1), and that of the scaling, because the error of a large component reaches small
/// components. A singular matrix has NaN and an infinite growth.
fn inverse<T: Number>(rows: &Rows<T>) -> (Rows<T>, f64) {
    let n = rows.len();
    let values = DMatrix::from_fn(n, n, |i, j| rows[i][j].value());
    let roots = values.diagonal().map(|entry| if entry == 0.0 { 1.0 } else { entry.abs().sqrt() });
    let scaled = DMatrix::from_fn(n, n, |i, j| values[(i, j)] / (roots[i] * roots[j]));
    let Some(inverse) = scaled.clone().try_inverse() else {
        return (vec![vec![T::constant(f64::NAN); n]; n], f64::INFINITY);
    };
    let norm =
        |m: &DMatrix<f64>| m.row_iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max);
    let condition = norm(&scaled) * norm(&inverse) * (roots.max() / roots.min());
    let start = |i: usize, j: usize| T::constant(inverse[(i, j)] / (roots[i] * roots[j]));
    let start: Rows<T> = (0..n).map(|i| (0..n).map(|j| start(i, j)).collect()).collect();
    // Each step of Newton's method X (2 − A X) (Schulz 1933) makes one more order of derivatives exact.
    let step = |x: Rows<T>| -> Rows<T> {
        let product = matrix_product(&x, &matrix_product(rows, &x));
        let entry = |(&x, &product): (&T, &T)| (x + x - product).exact();
        x.iter().zip(&product).map(|(x, product)| x.iter().zip(product).map(entry).collect()).collect()
    };
    (step(step(start)), condition)
}

fn of_frame<T: Number>(case: &Case<'_, T>, name: &str) -> Option<Vec<Vec<T>>> {
    let frames = case.model().frames.iter();
    let mut functions = frames.flat_map(|frame| FrameKind::ALL.map(|kind| (frame, kind)));
    let (frame, kind) = functions.find(|(frame, kind)| kind.function(&frame.identifier) == name)?;
    let at = Attachment { name: frame.name.clone(), link: frame.link, pose: frame.pose.clone() };
    let n = case.v.len();
    Some(match kind {
        FrameKind::Pose => {
            let links = case.links();
            let (arm, rotation) = case.robot.attached(&at, &links);
            vec![space::add(links[at.link].origin, arm).to_vec(), rotation.concat()]
        }
        FrameKind::Jacobian => {
            let columns: Rows<T> = (0..n).map(|j| twist(case, &at, j)).collect();
            vec![transposed(&columns, 6).concat()]
        }
        FrameKind::JacobianRateTimesVelocity => {
            let links = case.links_in([&case.v, &case.unaccelerated()], [T::zero(); 3]);
            let (arm, _) = case.robot.attached(&at, &links);
            let link = &links[at.link];
            vec![link.point_acceleration(arm).into_iter().chain(link.spin_rate).collect()]
        }
    })
}

/// Velocity and angular velocity of a frame if velocity j is 1 and all other velocities are 0.
fn twist<T: Number>(case: &Case<'_, T>, at: &Attachment, j: usize) -> Vec<T> {
    let (mut unit, zeros) = (case.robot.zeros(), case.robot.zeros());
    unit[j] = T::constant(1.0);
    let links = case.links_in([&unit, &zeros], [T::zero(); 3]);
    let (arm, _) = case.robot.attached(at, &links);
    let link = &links[at.link];
    space::add(link.velocity, space::cross(link.spin, arm)).into_iter().chain(link.spin).collect()
}

/// Wrenches that the joints transmit, in the frames of their links.
fn joint_wrenches<T: Number>(case: &Case<'_, T>) -> Vec<T> {
    let rates = [&case.v[..], &case.a[..]];
    let links = case.links_in(rates, case.robot.gravity());
    let (wrenches, _) = case.robot.inertial_wrenches(&links, rates);
    let (_, through) = case.robot.projected(&links, wrenches);
    let joints = case.model().carrying_joints();
    let row = |link: usize| {
        let back = space::transposed(&links[link].rotation);
        through[link].into_iter().flat_map(move |part| space::times(&back, part))
    };
    joints.into_iter().flat_map(|joint| row(joint.moving.link)).collect()
}
