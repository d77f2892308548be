//! Replaces the numbers of a description by symbols, for example m₂, c₂, I₂, l₂, i₂, J₂ and g.
//!
//! The index of a symbol is the number of the body's coordinate. If a vector has several non-zero entries,
//! the index also contains the axis (c₂x, c₂z). Zeros and multiples of 90° get no symbol.

use std::f64::consts::FRAC_PI_2;

use symbolica::atom::Atom;

use super::algebra::{self, Kind, Matrix, Variables, Vector};
use super::bodies::{Bodies, Mass, MovingBody, PLACES};
use super::symbols::{Symbol, Symbols};
use crate::model::{Input, Joint, JointKind, Model};
use crate::numeric::{atan2, length};
use gelenk_formula::Formula;

/// Largest difference \[rad\] between an angle and a multiple of 90° for which the angle is treated as this
/// multiple.
const QUARTER_ROUNDING: f64 = 1e-12;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Assigns one symbol to each constant of the description.
pub(super) struct Letters<'m> {
    variables: Variables<'m>,
    model: &'m Model,
    pub symbols: Symbols,
    /// Symbols of constant angles. With n coordinates, the variable with index `n + k` is the phase `e^{iα}`
    /// of the angle `angles[k]`.
    pub angles: Vec<Symbol>,
    /// Gear ratio of each drive, as an expression.
    ratios: Vec<Atom>,
}

impl<'m> Letters<'m> {
    pub fn new(variables: Variables<'m>, model: &'m Model) -> Self {
        let mut letters =
            Self { variables, model, symbols: Symbols::new(model), angles: Vec::new(), ratios: Vec::new() };
        for index in 0..model.drives.len() {
            let ratio = letters.ratio(index);
            letters.ratios.push(ratio);
        }
        letters
    }

    /// Converts a formula to an expression. A formula that is a number becomes a symbol.
    fn constant(&mut self, formula: &Formula, stem: &str, index: &str, meaning: &str) -> Atom {
        match formula.as_number() {
            Some(0.0) => algebra::zero(),
            Some(_) => {
                let place = self.symbols.add(stem, index, formula.clone(), meaning.to_owned());
                self.variables.atom(Kind::Constant, place)
            }
            None => {
                let polynomial = self.polynomial(formula);
                self.variables.formula(&polynomial)
            }
        }
    }

    /// Converts a formula like [`Letters::constant`], but keeps its symbol out of lumped constants.
    fn visible(&mut self, formula: &Formula, stem: &str, index: &str, meaning: &str) -> Atom {
        let before = self.symbols.entries.len();
        let atom = self.constant(formula, stem, index, meaning);
        for symbol in &mut self.symbols.entries[before..] {
            symbol.is_visible = true;
        }
        self.show(formula);
        atom
    }

    /// Keeps the free parameters of a formula out of lumped constants.
    fn show(&mut self, formula: &Formula) {
        for index in 0..self.model.parameters.len() {
            if formula.any(&|part| *part == Formula::Parameter(index)) {
                self.symbols.entries[index].is_visible = true;
            }
        }
    }

    /// Replaces calls of functions, and divisors that are sums, by symbols, so that the rest is a polynomial.
    fn polynomial(&mut self, formula: &Formula) -> Formula {
        let mut go = |part: &Formula| Box::new(self.polynomial(part));
        match formula {
            Formula::Negate(a) => Formula::Negate(go(a)),
            Formula::Add(a, b) => Formula::Add(go(a), go(b)),
            Formula::Subtract(a, b) => Formula::Subtract(go(a), go(b)),
            Formula::Multiply(a, b) => Formula::Multiply(go(a), go(b)),
            Formula::Power(a, exponent) => Formula::Power(go(a), *exponent),
            Formula::Divide(a, b) if is_product(b) => Formula::Divide(go(a), go(b)),
            Formula::Divide(a, b) => {
                let a = go(a);
                Formula::Divide(a, Box::new(self.whole(b)))
            }
            Formula::Call(..) => self.whole(formula),
            Formula::Number(_) | Formula::Parameter(_) | Formula::Position | Formula::Velocity => {
                formula.clone()
            }
        }
    }

    /// Replaces a whole formula by a symbol.
    fn whole(&mut self, formula: &Formula) -> Formula {
        let known = self.symbols.entries.iter().position(|symbol| symbol.value == *formula);
        let place = known.unwrap_or_else(|| {
            let count = self.symbols.entries.iter().filter(|s| s.stem == "f").count();
            let index = (count + 1).to_string();
            self.symbols.add("f", &index, formula.clone(), String::new())
        });
        Formula::Parameter(place)
    }

    fn vector(&mut self, entries: &[Formula; 3], stem: &str, index: usize, meaning: &str) -> Vector {
        let is_single = entries.iter().filter(|entry| !entry.is_zero()).count() == 1;
        std::array::from_fn(|k| {
            let axis = if is_single { "" } else { AXES[k] };
            self.constant(&entries[k], stem, &format!("{}{axis}", index + 1), meaning)
        })
    }

    /// Gravitational acceleration g₀. A negative entry becomes −g with the positive symbol g.
    pub fn gravity(&mut self, gravity: &[Formula; 3]) -> Vector {
        const MEANING: &str = "gravitational acceleration [m/s²]";
        let is_single = gravity.iter().filter(|entry| !entry.is_zero()).count() == 1;
        std::array::from_fn(|k| {
            let axis = if is_single { "" } else { AXES[k] };
            match gravity[k].as_number() {
                Some(value) if value < 0.0 => -self.visible(&Formula::Number(-value), "g", axis, MEANING),
                _ => self.visible(&gravity[k], "g", axis, MEANING),
            }
        })
    }

    /// Rotation and translation of the joint's frame in the parent's frame.
    pub fn origin(&mut self, body: &MovingBody) -> (Matrix, Vector) {
        let name = self.joint_name(body.coordinate);
        let meaning = format!("origin of {name} in its parent's frame [m]");
        let translation = self.vector(&body.pose.translation, "l", body.coordinate, &meaning);
        let [roll, pitch, yaw] = roll_pitch_yaw(&body.pose.rotation);
        let mut turn = algebra::identity();
        for (axis, angle, stem) in [(2, yaw, "psi"), (1, pitch, "theta"), (0, roll, "phi")] {
            let meaning = format!("origin of {name}: rotation about {} [rad]", AXES[axis]);
            let (sine, cosine) = self.angle(angle, stem, body.coordinate, &meaning);
            turn = algebra::product(&turn, &algebra::rotation(axis, &sine, &cosine));
        }
        (turn, translation)
    }

    /// Rotation A with `A e_z` equal to the joint's axis.
    pub fn align_axis(&mut self, body: &MovingBody) -> Matrix {
        let meaning = format!("axis of {} [rad]", self.joint_name(body.coordinate));
        self.align(body.axis, ["alpha", "beta"], body.coordinate, &meaning)
    }

    /// Unit vector of a rotor's axis in the carrier's frame.
    pub fn rotor_axis(&mut self, drive: usize, axis: [f64; 3]) -> Vector {
        let meaning = format!("rotor axis of {} [rad]", self.model.drives[drive].name);
        let index = self.model.drives[drive].coordinate().unwrap_or(drive);
        let align = self.align(axis, ["mu", "nu"], index, &meaning);
        align.map(|[_, _, z]| z)
    }

    /// Rotation `R_z(azimuth) R_y(polar)`, which rotates the z axis to the given axis.
    fn align(&mut self, axis: [f64; 3], stems: [&str; 2], index: usize, meaning: &str) -> Matrix {
        let [azimuth, polar] = spherical(axis);
        let (sine, cosine) = self.angle(azimuth, stems[0], index, &format!("azimuth, {meaning}"));
        let turn = algebra::rotation(2, &sine, &cosine);
        let (sine, cosine) = self.angle(polar, stems[1], index, &format!("polar angle, {meaning}"));
        algebra::product(&turn, &algebra::rotation(1, &sine, &cosine))
    }

    /// Sine and cosine of a constant angle. Two angles have the same symbol if their sum or difference is a
    /// multiple of 90°.
    fn angle(&mut self, value: f64, stem: &str, index: usize, meaning: &str) -> (Atom, Atom) {
        let quarters = (value / FRAC_PI_2).round();
        if is_quarter(value) {
            return turned(quarters, Atom::num(0), Atom::num(1));
        }
        let known = self.angles.iter().enumerate().find_map(|(place, known)| {
            let other = known.value.as_number()?;
            if is_quarter(value - other) {
                Some((place, 1.0, ((value - other) / FRAC_PI_2).round()))
            } else if is_quarter(value + other) {
                Some((place, -1.0, ((value + other) / FRAC_PI_2).round()))
            } else {
                None
            }
        });
        let (place, sign, quarters) = known.unwrap_or_else(|| {
            self.angles.push(Symbol {
                stem: stem.to_owned(),
                index: (index + 1).to_string(),
                value: Formula::Number(value),
                meaning: meaning.to_owned(),
                is_visible: true,
            });
            (self.angles.len() - 1, 1.0, 0.0)
        });
        let phase = self.model.coordinates.len() + place;
        let sine = self.variables.sine(phase);
        let sine = if sign < 0.0 { -sine } else { sine };
        turned(quarters, sine, self.variables.cosine(phase))
    }

    /// Mass, centre of mass, and inertia about the centre of mass (xx, xy, xz, yy, yz, zz) as expressions.
    pub fn mass(&mut self, coordinate: usize, mass: &Mass) -> (Atom, Vector, [Atom; 6]) {
        let name = self.joint_name(coordinate);
        let index = coordinate + 1;
        let m = self.constant(
            &mass.mass,
            "m",
            &index.to_string(),
            &format!("mass of the body that {name} carries [kg]"),
        );
        let center =
            self.vector(&mass.center, "c", coordinate, &format!("centre of mass in the frame of {name} [m]"));
        let mut entry = |k: usize| {
            let (i, j) = PLACES[k];
            let index = format!("{index}{}{}", AXES[i], AXES[j]);
            self.constant(&mass.inertia[k], "I", &index, "inertia about the centre of mass [kg m²]")
        };
        let inertia = [entry(0), entry(1), entry(2), entry(3), entry(4), entry(5)];
        (m, center, inertia)
    }

    /// Axial inertia and gear ratio of a drive's rotor as expressions.
    pub fn rotor(&mut self, drive: usize) -> (Atom, Atom) {
        let model = self.model;
        let meaning = format!("axial inertia of the rotor of {} [kg m²]", model.drives[drive].name);
        let index = self.drive_index(drive);
        let inertia = self.visible(&model.drives[drive].rotor_inertia, "J", &index, &meaning);
        (inertia, self.ratios[drive].clone())
    }

    /// Input matrix B as a list of rows. An entry is the drive's gear ratio, times the motor constant if the
    /// input is a current.
    pub fn input_matrix(&mut self) -> Vec<Vec<Atom>> {
        let model = self.model;
        let drives: Vec<_> =
            model.drives.iter().enumerate().filter(|(_, drive)| drive.coordinate().is_some()).collect();
        let mut matrix = vec![vec![algebra::zero(); drives.len()]; model.coordinates.len()];
        for (column, (index, drive)) in drives.iter().enumerate() {
            let mut entry = self.ratios[*index].clone();
            if let Input::Current(constant) = &drive.input {
                let meaning = format!("motor constant of {} [N m/A]", drive.name);
                entry *= self.visible(constant, "K", &self.drive_index(*index), &meaning);
            }
            if let Some(row) = drive.coordinate() {
                matrix[row][column] = entry;
            }
        }
        matrix
    }

    /// Spring and friction terms of each coordinate, each with its coefficient and basis function.
    /// Coefficients of friction are negated.
    pub fn joint_forces(&mut self) -> Vec<Vec<(Atom, Formula)>> {
        let model = self.model;
        let joints = model.coordinates.iter().enumerate();
        joints
            .map(|(coordinate, &link)| match &model.links[link].joint {
                Some(joint) => self.forces_of(coordinate, joint),
                None => Vec::new(),
            })
            .collect()
    }

    fn forces_of(&mut self, coordinate: usize, joint: &Joint) -> Vec<(Atom, Formula)> {
        let springs = joint.springs.iter().cloned().flat_map(Formula::linear_terms);
        let springs: Vec<_> = springs.collect();
        let mut forces = Vec::new();
        for (number, (coefficient, basis)) in springs.into_iter().enumerate() {
            let index = format!("{}{}", coordinate + 1, part(number));
            let meaning = format!("spring or damper of {}{}", joint.name, unit(joint, &basis));
            forces.push((self.visible(&coefficient, "s", &index, &meaning), basis));
        }
        for (number, term) in joint.friction.iter().enumerate() {
            let index = format!("{}{}", coordinate + 1, part(number));
            let meaning = format!("friction of {}{}", joint.name, unit(joint, &term.basis));
            let coefficient = self.visible(&term.coefficient, "d", &index, &meaning);
            forces.push((-coefficient, term.basis.clone()));
        }
        forces
    }

    fn ratio(&mut self, drive: usize) -> Atom {
        let model = self.model;
        let ratio = &model.drives[drive].gear_ratio;
        match ratio.as_number() {
            Some(value) if value.abs() == 1.0 => algebra::number(value),
            _ => {
                let meaning = format!("gear ratio of {}", model.drives[drive].name);
                self.visible(ratio, "i", &self.drive_index(drive), &meaning)
            }
        }
    }

    /// Index of a drive's symbols: the number of the drive's coordinate, or the name of the drive if its
    /// joint is held.
    fn drive_index(&self, drive: usize) -> String {
        let drive = &self.model.drives[drive];
        match drive.coordinate() {
            Some(coordinate) => (coordinate + 1).to_string(),
            None => format!("_{}", drive.identifier),
        }
    }

    fn joint_name(&self, coordinate: usize) -> String {
        let link = self.model.coordinates.get(coordinate);
        let joint = link.and_then(|&link| self.model.links[link].joint.as_ref());
        joint.map_or_else(String::new, |joint| joint.name.clone())
    }
}

/// Sine and cosine of α + 90° n from sine and cosine of α, with n = `quarters`.
fn turned(quarters: f64, sine: Atom, cosine: Atom) -> (Atom, Atom) {
    // The cast is exact, because angles are at most a few turns.
    match quarters.rem_euclid(4.0) as u8 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// Number of constant angles between the bodies' axes that are not multiples of 90° and need a symbol.
pub(super) fn count_angles(bodies: &Bodies) -> usize {
    let joints = bodies.bodies.iter().flat_map(|body| {
        let origin = roll_pitch_yaw(&body.pose.rotation);
        origin.into_iter().chain(spherical(body.axis))
    });
    let carried = bodies.rotors.iter().filter_map(|rotor| rotor.carrier);
    let rotors = carried.flat_map(|(_, axis)| spherical(axis));
    let mut angles: Vec<f64> = Vec::new();
    for angle in joints.chain(rotors).filter(|&angle| !is_quarter(angle)) {
        let is_same = |known: &f64| is_quarter(angle - known) || is_quarter(angle + known);
        if !angles.iter().any(is_same) {
            angles.push(angle);
        }
    }
    angles.len()
}

fn is_quarter(angle: f64) -> bool {
    let quarters = (angle / FRAC_PI_2).round();
    (angle - quarters * FRAC_PI_2).abs() < QUARTER_ROUNDING
}

/// Azimuth and polar angle of an axis in rad.
fn spherical([x, y, z]: [f64; 3]) -> [f64; 2] {
    [atan2(y, x), atan2(length([x, y]), z)]
}

/// Unit of the coefficient of a basis function, in brackets. The text is empty if the unit is unknown, for
/// example for powers.
fn unit(joint: &Joint, basis: &Formula) -> &'static str {
    let slides = joint.kind == JointKind::Prismatic;
    match (basis, slides) {
        (Formula::Velocity, false) => " [N m s/rad]",
        (Formula::Velocity, true) => " [N s/m]",
        (Formula::Position, false) => " [N m/rad]",
        (Formula::Position, true) => " [N/m]",
        (Formula::Number(_) | Formula::Call(..), false) => " [N m]",
        (Formula::Number(_) | Formula::Call(..), true) => " [N]",
        _ => "",
    }
}

/// Letter a, b, c, … for the term of a force law with this number.
fn part(number: usize) -> char {
    char::from(b'a' + (number % 26) as u8)
}

fn is_product(formula: &Formula) -> bool {
    match formula {
        Formula::Number(_) | Formula::Parameter(_) => true,
        Formula::Negate(a) | Formula::Power(a, _) => is_product(a),
        Formula::Multiply(a, b) | Formula::Divide(a, b) => is_product(a) && is_product(b),
        _ => false,
    }
}

/// Roll, pitch and yaw of `R_z(yaw) R_y(pitch) R_x(roll)` (rad). If pitch is ±90°, roll is 0.
fn roll_pitch_yaw(r: &[[f64; 3]; 3]) -> [f64; 3] {
    let level = length([r[0][0], r[1][0]]);
    let pitch = atan2(-r[2][0], level);
    if level < QUARTER_ROUNDING {
        return [0.0, pitch, atan2(-r[0][1], r[1][1])];
    }
    [atan2(r[2][1], r[2][2]), pitch, atan2(r[1][0], r[0][0])]
}
