//! Parameters in which the equations of motion are linear, and their regressors.

use super::case::{Case, Rows, plus, transposed};
use super::number::Number;
use super::robot::{Inertia, LinkMotion};
use super::space::{
    Matrix, Vector, add, constant, dot, product, scale, subtract, times, transposed as turned_back,
};
use crate::functions::function::{Constant, ConstantValue};
use crate::model::{Drive, FrictionTerm, Input, Motion, RotorCoupling};
use gelenk_formula::Formula;

const SYMBOLS: [&str; 10] = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// Drives with a rotor. Drives with an input precede drives without input.
fn rotors<T: Number>(case: &Case<'_, T>) -> Vec<Drive> {
    let model = case.model();
    let without = model.moving_drives().filter(|drive| drive.input == Input::None);
    let is_ideal = |drive: &Drive| drive.gear_ratio == Formula::ONE && drive.rotor_inertia == Formula::ZERO;
    model.input_drives().chain(without).filter(|drive| !is_ideal(drive)).cloned().collect()
}

/// Inertial parameters π: first those of each moving link with all bodies that are fixed to it, then the rotor
/// inertias.
pub fn inertial<T: Number>(case: &Case<'_, T>) -> Vec<T> {
    let zeros = case.robot.zeros();
    let links = case.links_in([&zeros, &zeros], constant([0.0; 3]));
    let of_link = |link: usize| {
        let members = (0..links.len()).filter(|&other| carrier(case, other) == link);
        let parts = members.flat_map(|member| parts(case, &links, member, link));
        parts.fold([T::zero(); 10], |sum, part| std::array::from_fn(|k| sum[k] + part[k]))
    };
    let joints = case.model().carrying_joints();
    let links = joints.iter().flat_map(|joint| of_link(joint.moving.link));
    let rotors = rotors(case).into_iter().map(|drive| case.robot.number(&drive.rotor_inertia));
    links.chain(rotors).collect()
}

/// The link of the last moving joint before a link.
fn carrier<T: Number>(case: &Case<'_, T>, link: usize) -> usize {
    match &case.model().links[link].joint {
        Some(joint) if matches!(joint.motion, Motion::Fixed | Motion::Held(_)) => carrier(case, joint.parent),
        _ => link,
    }
}

/// Inertias of the bodies of a link and of the rotors that do not turn on it, in the frame of another link.
fn parts<T: Number>(
    case: &Case<'_, T>,
    links: &[LinkMotion<T>],
    member: usize,
    to: usize,
) -> Vec<Inertia<T>> {
    let back = turned_back(&links[to].rotation);
    let origin = times(&back, subtract(links[member].origin, links[to].origin));
    let rotation = product(&back, &links[member].rotation);
    let bodies = case.model().links[member].bodies.iter().map(|body| case.robot.inertia(body));
    let resting = case.model().drives.iter().filter(|drive| {
        drive.carrier == member && drive.acts_on.is_empty() && drive.coupling == RotorCoupling::Body
    });
    let rotors = resting.map(|drive| {
        let [x, y, z] = drive.axis.map(T::constant);
        let j = case.robot.number(&drive.rotor_inertia);
        let o = T::zero();
        [o, o, o, o, j * x * x, j * x * y, j * y * y, j * x * z, j * y * z, j * z * z]
    });
    bodies.chain(rotors).map(|part| moved(&part, origin, &rotation)).collect()
}

/// A body's inertia about another origin, in other axes.
fn moved<T: Number>(
    &[m, x, y, z, xx, xy, yy, xz, yz, zz]: &Inertia<T>,
    origin: Vector<T>,
    rotation: &Matrix<T>,
) -> Inertia<T> {
    let first = times(rotation, [x, y, z]);
    let h = add(first, scale(origin, m));
    let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let turned = product(&product(rotation, &inertia), &turned_back(rotation));
    // I + (2 r·h₀ + m r²) 1 − (r h₀ᵀ + h₀ rᵀ + m r rᵀ)
    let diagonal = dot(origin, add(first, h));
    let entry = |i: usize, j: usize| {
        let moved = turned[i][j] - origin[i] * h[j] - first[i] * origin[j];
        if i == j { moved + diagonal } else { moved }
    };
    [m, h[0], h[1], h[2], entry(0, 0), entry(0, 1), entry(1, 1), entry(0, 2), entry(1, 2), entry(2, 2)]
}

/// Regressor W of the inertial parameters as a list of rows. Each row belongs to a coordinate.
pub fn regressor<T: Number>(case: &Case<'_, T>) -> Rows<T> {
    let rates = [&case.v[..], &case.a[..]];
    let links = case.links_in(rates, case.robot.gravity());
    let none = [constant([0.0; 3]); 2];
    let mut columns: Rows<T> = Vec::new();
    for joint in case.model().carrying_joints() {
        let link = joint.moving.link;
        for k in 0..10 {
            let unit: Inertia<T> = std::array::from_fn(|i| T::constant(f64::from(u8::from(i == k))));
            let mut wrenches = vec![none; links.len()];
            wrenches[link] = links[link].wrench_of(&unit);
            columns.push(case.robot.projected(&links, wrenches).0);
        }
    }
    for drive in rotors(case) {
        let mut own = case.robot.zeros();
        let moment = case.robot.rotor(&drive, T::constant(1.0), &links, rates, &mut own);
        let mut wrenches = vec![none; links.len()];
        wrenches[drive.carrier] = [constant([0.0; 3]), moment];
        columns.push(plus(&case.robot.projected(&links, wrenches).0, &own));
    }
    transposed(&columns, case.n())
}

/// Columns of the inertial regressor that form the base regressor. The column of a base parameter is that of
/// the first inertial parameter of its sum. `None` if the names of the base parameters are unknown.
pub fn base_regressor<T: Number>(case: &Case<'_, T>, constants: &[Constant]) -> Option<Rows<T>> {
    let leaders = constants.iter().find_map(|constant| match &constant.value {
        ConstantValue::Names(_, names) if constant.name == "BASE_PARAMETER_NAMES" => Some(names),
        _ => None,
    })?;
    let joints = case.model().carrying_joints();
    let links = joints.iter().flat_map(|joint| SYMBOLS.map(|symbol| format!("{symbol}_{}", joint.name)));
    let rotors = rotors(case).into_iter().map(|drive| format!("J_{}", drive.name));
    let names: Vec<String> = links.chain(rotors).collect();
    let indices: Option<Vec<usize>> =
        leaders.iter().map(|leader| names.iter().position(|name| name == leader)).collect();
    let indices = indices?;
    Some(regressor(case).iter().map(|row| indices.iter().map(|&k| row[k]).collect()).collect())
}

/// Friction terms grouped by their basis function, in the order of the first term of each group.
fn groups(terms: &[FrictionTerm]) -> Vec<Vec<&FrictionTerm>> {
    let mut groups: Vec<Vec<&FrictionTerm>> = Vec::new();
    for term in terms {
        match groups.iter_mut().find(|group| group[0].basis == term.basis) {
            Some(group) => group.push(term),
            None => groups.push(vec![term]),
        }
    }
    groups
}

/// Coefficients of friction by basis function: first the coefficients of joints, then of shafts.
pub fn friction<T: Number>(case: &Case<'_, T>) -> Vec<T> {
    let groups = case.rubbing().flat_map(|rubbing| groups(rubbing.terms));
    let sum = |group: Vec<&FrictionTerm>| {
        let coefficients = group.iter().map(|term| case.robot.number(&term.coefficient));
        coefficients.fold(T::zero(), |sum, c| sum + c)
    };
    groups.map(sum).collect()
}

pub fn friction_regressor<T: Number>(case: &Case<'_, T>) -> Rows<T> {
    let mut columns: Rows<T> = Vec::new();
    for rubbing in case.rubbing() {
        for group in groups(rubbing.terms) {
            let basis = case.robot.value(&group[0].basis, rubbing.y, rubbing.v);
            let mut column = case.robot.zeros();
            case.robot.add_force(rubbing.follows, basis * rubbing.gain, &mut column);
            columns.push(column);
        }
    }
    transposed(&columns, case.n())
}
