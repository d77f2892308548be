//! Converts values of a model to the numbers that other formats need.

use crate::model::{Body, FrictionTerm, Joint, JointKind, Model, Motion, Pose};
use crate::numeric::{atan2, length};
use crate::spatial::rotation_about;
use gelenk_formula::{Formula, Function};

pub(super) type Matrix = [[f64; 3]; 3];

/// Values of the free parameters in the description, with which formulas are evaluated.
pub(super) struct Values(Vec<f64>);

/// A pose whose entries are numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    pub(super) origin: [f64; 3],
    pub(super) rotation: Matrix,
}

/// Mass (kg), centre of mass (m) and inertia about the centre of mass (kg m²). The inertia is in the link's
/// axes, with the entries xx, xy, xz, yy, yz, zz.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Lump {
    pub(super) mass: f64,
    pub(super) center: [f64; 3],
    pub(super) inertia: [f64; 6],
}

/// An affine force law `constant + position · y + velocity · v` of a joint with the position y and the
/// velocity v.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Affine {
    pub(super) constant: f64,
    pub(super) position: f64,
    pub(super) velocity: f64,
}

/// A friction law `viscous · v + dry · sign(v)` of a joint with the velocity v, with a flag for further
/// terms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Friction {
    pub(super) viscous: f64,
    pub(super) dry: f64,
    pub(super) has_others: bool,
}

impl Values {
    pub(super) fn of(model: &Model) -> Self {
        Self(model.described_parameters())
    }

    pub(super) fn number(&self, formula: &Formula) -> f64 {
        formula.evaluate(&self.0, 0.0, 0.0)
    }

    pub(super) fn numbers<const N: usize>(&self, formulas: &[Formula; N]) -> [f64; N] {
        formulas.each_ref().map(|formula| self.number(formula))
    }

    pub(super) fn placed(&self, pose: &Pose) -> Placed {
        Placed { origin: self.numbers(&pose.translation), rotation: pose.rotation }
    }

    /// Pose of a joint's link in the parent link, at position 0 or at the held position.
    pub(super) fn resting(&self, joint: &Joint) -> Placed {
        let Placed { origin, rotation } = self.placed(&joint.origin);
        let Motion::Held(position) = joint.motion else { return Placed { origin, rotation } };
        let [turn, slide] = joint.kind.turn_and_slide();
        let turned = rotation_about(joint.axis, turn * position);
        let turned = std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)]));
        let slid = times(&rotation, &joint.axis.map(|x| x * slide * position));
        Placed { origin: std::array::from_fn(|k| origin[k] + slid[k]), rotation: product(&rotation, &turned) }
    }

    /// Mass and inertia of all bodies of a link together, including the rotors of held joints on this link.
    pub(super) fn lump(&self, model: &Model, link: usize) -> Lump {
        let mut lump = self.bodies(&model.links[link].bodies);
        for drive in model.held_rotors().filter(|drive| drive.carrier == link) {
            lump.add_about_axis(drive.axis, self.number(&drive.rotor_inertia), 0.0);
        }
        lump
    }

    fn bodies(&self, bodies: &[Body]) -> Lump {
        let masses = bodies.iter().map(|body| self.number(&body.mass));
        let mass: f64 = masses.clone().sum();
        let centers: Vec<[f64; 3]> = bodies.iter().map(|body| self.numbers(&body.center_of_mass)).collect();
        let center = match (mass == 0.0, &centers[..]) {
            (false, [only]) => *only,
            (false, _) => std::array::from_fn(|k| {
                masses.clone().zip(&centers).map(|(mass, at)| mass * at[k]).sum::<f64>() / mass
            }),
            (true, _) => [0.0; 3],
        };
        let mut inertia = [0.0; 6];
        for ((body, mass), at) in bodies.iter().zip(masses).zip(&centers) {
            let own = self.numbers(&body.inertia);
            let moved = point_mass(mass, &std::array::from_fn(|k| at[k] - center[k]));
            inertia = std::array::from_fn(|k| inertia[k] + own[k] + moved[k]);
        }
        Lump { mass, center, inertia }
    }

    /// Converts a force law to an affine function of position and velocity; `None` if the law is not affine.
    pub(super) fn affine(&self, law: &Formula) -> Option<Affine> {
        let scaled = |a: Affine, factor: f64| Affine {
            constant: a.constant * factor,
            position: a.position * factor,
            velocity: a.velocity * factor,
        };
        let sum = |a: Affine, b: Affine| Affine {
            constant: a.constant + b.constant,
            position: a.position + b.position,
            velocity: a.velocity + b.velocity,
        };
        let go = |part: &Formula| self.affine(part);
        if !law.depends_on_motion() {
            return Some(Affine { constant: self.number(law), ..Affine::default() });
        }
        match law {
            Formula::Position => Some(Affine { position: 1.0, ..Affine::default() }),
            Formula::Velocity => Some(Affine { velocity: 1.0, ..Affine::default() }),
            Formula::Negate(a) => Some(scaled(go(a)?, -1.0)),
            Formula::Add(a, b) => Some(sum(go(a)?, go(b)?)),
            Formula::Subtract(a, b) => Some(sum(go(a)?, scaled(go(b)?, -1.0))),
            Formula::Multiply(a, b) if !a.depends_on_motion() => Some(scaled(go(b)?, self.number(a))),
            Formula::Multiply(a, b) if !b.depends_on_motion() => Some(scaled(go(a)?, self.number(b))),
            Formula::Divide(a, b) if !b.depends_on_motion() => Some(scaled(go(a)?, 1.0 / self.number(b))),
            _ => None,
        }
    }

    pub(super) fn friction(&self, terms: &[FrictionTerm]) -> Friction {
        let mut friction = Friction::default();
        for term in terms {
            let coefficient = self.number(&term.coefficient);
            let [viscous, dry] = self.viscous_and_dry(&term.basis).unwrap_or([f64::NAN; 2]);
            match [coefficient * viscous, coefficient * dry] {
                [viscous, dry] if viscous >= 0.0 && dry >= 0.0 => {
                    friction.viscous += viscous;
                    friction.dry += dry;
                }
                _ => friction.has_others |= coefficient != 0.0,
            }
        }
        friction
    }

    /// Factors of `v` and of `sign(v)` in a basis function; `None` for other functions.
    fn viscous_and_dry(&self, basis: &Formula) -> Option<[f64; 2]> {
        let rate = |law: &Formula| {
            let law = self.affine(law)?;
            (law.constant == 0.0 && law.position == 0.0).then_some(law.velocity)
        };
        match basis {
            Formula::Call(Function::Sign, inner) => Some([0.0, Function::Sign.evaluate(rate(inner)?)]),
            basis => Some([rate(basis)?, 0.0]),
        }
    }
}

impl Lump {
    /// Adds moments of inertia about an axis (`along`) and across the axis (`across`) (kg m²).
    pub(super) fn add_about_axis(&mut self, [x, y, z]: [f64; 3], along: f64, across: f64) {
        let own = [x * x, x * y, x * z, y * y, y * z, z * z];
        let unit = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];
        self.inertia =
            std::array::from_fn(|k| self.inertia[k] + across * unit[k] + (along - across) * own[k]);
    }
}

impl Joint {
    /// Whether the joint is prismatic.
    pub(super) fn slides(&self) -> bool {
        self.kind == JointKind::Prismatic
    }
}

/// Inertia of a point mass about the origin, with the entries xx, xy, xz, yy, yz, zz.
fn point_mass(mass: f64, [x, y, z]: &[f64; 3]) -> [f64; 6] {
    [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y].map(|entry| mass * entry)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn times(a: &Matrix, b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * b[k]).sum())
}

impl Placed {
    pub(super) const IDENTITY: Self =
        Self { origin: [0.0; 3], rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    pub(super) fn is_turned(&self) -> bool {
        self.rotation != Self::IDENTITY.rotation
    }

    /// Unit quaternion (w, x, y, z) of the pose's rotation. It is computed from its largest entry, so no
    /// digits are lost.
    pub(super) fn quaternion(&self) -> [f64; 4] {
        quaternion(&self.rotation)
    }

    /// Roll, pitch and yaw of the pose's rotation `R = R_z(yaw) R_y(pitch) R_x(roll)`. Roll is computed from
    /// the rotation without yaw, so the rotation is exact even if pitch is close to ±90°.
    pub(super) fn rpy(&self) -> [f64; 3] {
        let r = &self.rotation;
        let level = length([r[0][0], r[1][0]]);
        let (s, c) = match level > 0.0 {
            true => (r[1][0] / level, r[0][0] / level),
            false => (0.0, 1.0),
        };
        let row: [f64; 3] = std::array::from_fn(|k| c * r[1][k] - s * r[0][k]);
        [atan2(-row[2], row[1]), atan2(-r[2][0], level), atan2(s, c)]
    }
}

pub(super) fn quaternion(r: &Matrix) -> [f64; 4] {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = *r;
    // Row k is four times entry k of the quaternion, times the quaternion.
    let rows = [
        [1.0 + xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, 1.0 + xx - yy - zz, xy + yx, xz + zx],
        [xz - zx, xy + yx, 1.0 - xx + yy - zz, yz + zy],
        [yx - xy, xz + zx, yz + zy, 1.0 - xx - yy + zz],
    ];
    let largest = (1..4).fold(0, |best, k| if rows[k][k] > rows[best][best] { k } else { best });
    let size = length(rows[largest]);
    rows[largest].map(|entry| entry / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rotation: nalgebra::Matrix3<f64>) -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)]))
    }

    /// Angles of CAD programs are close to right ones.
    #[test]
    #[expect(clippy::approx_constant, reason = "what CAD programs write")]
    fn rotations_come_back() {
        for roll in [0.0, 0.7, -1.570_796_3, 3.141_592_6] {
            for pitch in [0.0, -0.4, 1.570_796, -1.570_796_326_794_896_6, 1.2] {
                for yaw in [0.0, 2.1, -3.1, 1.570_796_326_794_896_6] {
                    let about = |axis: [f64; 3], angle: f64| rotation_about(axis, angle);
                    let rotation = about([0.0, 0.0, 1.0], yaw)
                        * about([0.0, 1.0, 0.0], pitch)
                        * about([1.0, 0.0, 0.0], roll);
                    let placed = Placed { rotation: matrix(rotation), ..Placed::IDENTITY };
                    let [roll, pitch, yaw] = placed.rpy();
                    let again = about([0.0, 0.0, 1.0], yaw)
                        * about([0.0, 1.0, 0.0], pitch)
                        * about([1.0, 0.0, 0.0], roll);
                    assert!((again - rotation).abs().max() < 16.0 * f64::EPSILON, "{rotation} {again}");
                    let [w, x, y, z] = placed.quaternion();
                    let again = nalgebra::Quaternion::new(w, x, y, z);
                    let again = nalgebra::UnitQuaternion::new_unchecked(again).to_rotation_matrix();
                    assert!(
                        (again.matrix() - rotation).abs().max() < 16.0 * f64::EPSILON,
                        "{rotation} {again}"
                    );
                }
            }
        }
    }
}
