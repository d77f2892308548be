//! Moving bodies of a model, in the frames of the description.
//!
//! Fixed and held links belong to the body that carries them. Masses of a body without free parameters are
//! combined to one mass. Masses with free parameters stay separate. The module `kinematics` is not used,
//! because closed forms serve as a check of its results.

use crate::model::{Body, Joint, JointKind, Model, Motion, Pose, RotorCoupling};
use crate::numeric::sin_cos;
use gelenk_formula::Formula;

type Matrix = [[f64; 3]; 3];

/// Entries below this fraction of the largest entry are rounding errors and are set to 0.
const ROUNDING: f64 = 1e-12;

/// A body that a joint moves, with its masses.
#[derive(Debug, Clone)]
pub(super) struct MovingBody {
    /// Index of the coordinate of the body's joint.
    pub coordinate: usize,
    /// Index of the body that carries the joint; `None` if the base carries the joint.
    pub parent: Option<usize>,
    /// Pose of the joint's frame in the frame of the body that carries the joint.
    pub pose: Pose,
    /// Unit vector of the joint's axis in the joint's frame.
    pub axis: [f64; 3],
    /// Whether the body's joint is prismatic.
    pub is_prismatic: bool,
    /// Rigid masses of the body.
    pub masses: Vec<Mass>,
}

/// A rigid mass in the frame of its body.
#[derive(Debug, Clone)]
pub(super) struct Mass {
    /// Mass of the body part (kg).
    pub mass: Formula,
    /// Centre of mass in the body's frame (m).
    pub center: [Formula; 3],
    /// Inertia about the centre of mass [kg m²]: xx, xy, xz, yy, yz, zz.
    pub inertia: [Formula; 6],
}

/// Rotor of a drive, with its carrier and coordinate.
#[derive(Debug, Clone)]
pub(super) struct Rotor {
    /// Index of the rotor's drive in the model.
    pub drive: usize,
    /// Index of the body that carries the rotor, and unit vector of the rotor's axis in this body's frame.
    /// `None` if the base carries the rotor or if the motion of the carrier is neglected.
    pub carrier: Option<(usize, [f64; 3])>,
    /// Index of the coordinate that turns the rotor; `None` if the rotor does not turn relative to its
    /// carrier.
    pub coordinate: Option<usize>,
}

/// Moving bodies and rotors of a model. Parents precede children.
#[derive(Debug, Clone)]
pub(super) struct Bodies {
    pub bodies: Vec<MovingBody>,
    pub rotors: Vec<Rotor>,
}

impl Bodies {
    /// Collects bodies and rotors of a model.
    pub fn new(model: &Model) -> Self {
        let (mut bodies, places) = moving(model);
        let mut rotors = Vec::new();
        for (index, drive) in model.drives.iter().enumerate() {
            let (body, pose) = &places[drive.carrier];
            let axis = cleaned(turned(&pose.rotation, drive.axis));
            let carrier = body.filter(|_| drive.coupling == RotorCoupling::Body);
            match (carrier, drive.coordinate(), drive.rotor_inertia.as_number()) {
                (_, _, Some(0.0)) | (None, None, _) => {}
                // A rotor that does not turn is part of its carrier.
                (Some(body), None, Some(inertia)) => {
                    bodies[body].masses.push(still_rotor(inertia, axis));
                }
                (carrier, coordinate, _) => {
                    rotors.push(Rotor { drive: index, carrier: carrier.map(|body| (body, axis)), coordinate })
                }
            }
        }
        for body in &mut bodies {
            body.masses = lumped(std::mem::take(&mut body.masses));
        }
        Self { bodies, rotors }
    }
}

/// Collects the moving bodies with all their masses. Also returns the body of each link, and the link's pose
/// in the body's frame.
fn moving(model: &Model) -> (Vec<MovingBody>, Vec<(Option<usize>, Pose)>) {
    let (mut bodies, mut places) = (Vec::new(), Vec::<(Option<usize>, Pose)>::new());
    for link in &model.links {
        let place = match &link.joint {
            None => (None, Pose::identity()),
            Some(joint) => attached(joint, &places, &mut bodies),
        };
        if let Some(body) = place.0 {
            let masses = link.bodies.iter().map(|body| in_frame(body, &place.1));
            bodies[body].masses.extend(masses);
        }
        places.push(place);
    }
    (bodies, places)
}

fn attached(
    joint: &Joint,
    places: &[(Option<usize>, Pose)],
    bodies: &mut Vec<MovingBody>,
) -> (Option<usize>, Pose) {
    let (parent, parent_pose) = &places[joint.parent];
    let pose = tidy(parent_pose.then(&joint.origin));
    let position = match joint.motion {
        Motion::Follower(_) => unreachable!("closed forms of coupled joints are refused"),
        Motion::Coordinate(coordinate) => {
            bodies.push(MovingBody {
                coordinate,
                parent: *parent,
                pose,
                axis: cleaned(joint.axis),
                is_prismatic: joint.kind == JointKind::Prismatic,
                masses: Vec::new(),
            });
            return (Some(bodies.len() - 1), Pose::identity());
        }
        Motion::Fixed => 0.0,
        Motion::Held(position) => position,
    };
    (*parent, tidy(pose.then(&displacement(joint, position))))
}

/// Pose of a link in its joint's frame if the joint is at `position`.
fn displacement(joint: &Joint, position: f64) -> Pose {
    let mut pose = Pose::identity();
    let [turn, slide] = joint.kind.turn_and_slide();
    if turn != 0.0 {
        pose.rotation = about(joint.axis, turn * position);
    }
    if slide != 0.0 {
        pose.translation = joint.axis.map(|x| Formula::Number(x * slide * position));
    }
    pose
}

/// Rotation `R = 1 + sin φ [a]ₓ + (1 − cos φ) [a]ₓ²` about the axis a by the angle φ (Rodrigues).
fn about([x, y, z]: [f64; 3], angle: f64) -> Matrix {
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let (sine, cosine) = sin_cos(angle);
    let versine = 1.0 - cosine;
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let square: f64 = (0..3).map(|k| cross[i][k] * cross[k][j]).sum();
            f64::from(u8::from(i == j)) + sine * cross[i][j] + versine * square
        })
    })
}

fn turned(rotation: &Matrix, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|j| rotation[i][j] * v[j]).sum())
}

/// Rounds entries that are close to an integer to this integer, so that rounding errors of unit vectors
/// vanish.
fn cleaned(v: [f64; 3]) -> [f64; 3] {
    v.map(|x| if (x - x.round()).abs() < ROUNDING { x.round() + 0.0 } else { x })
}

/// Sets rounding errors in the pose to exact integers or 0.
fn tidy(mut pose: Pose) -> Pose {
    pose.rotation = pose.rotation.map(cleaned);
    let numbers = pose.translation.each_ref().map(Formula::as_number);
    let largest = numbers.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    for (entry, number) in pose.translation.iter_mut().zip(numbers) {
        if number.is_some_and(|x| x.abs() < ROUNDING * largest) {
            *entry = Formula::ZERO;
        }
    }
    pose
}

fn in_frame(body: &Body, pose: &Pose) -> Mass {
    Mass {
        mass: body.mass.clone(),
        center: pose.point(&body.center_of_mass),
        inertia: turned_inertia(&pose.rotation, &body.inertia),
    }
}

/// Index of the inertia entry in row i and column j, in the order xx, xy, xz, yy, yz, zz.
pub(super) const ENTRY: [[usize; 3]; 3] = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];

/// Row and column of the inertia entries xx, xy, xz, yy, yz, zz.
pub(super) const PLACES: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Inertia `R I Rᵀ` in axes rotated by R.
fn turned_inertia(r: &Matrix, inertia: &[Formula; 6]) -> [Formula; 6] {
    PLACES.map(|(i, j)| {
        let mut sum = Formula::ZERO;
        for k in 0..3 {
            for l in 0..3 {
                let factor = Formula::Number(r[i][k] * r[j][l]);
                let part = Formula::product(factor, inertia[ENTRY[k][l]].clone());
                sum = Formula::sum(sum, part);
            }
        }
        sum
    })
}

fn still_rotor(inertia: f64, axis: [f64; 3]) -> Mass {
    Mass {
        mass: Formula::ZERO,
        center: [Formula::ZERO; 3],
        inertia: PLACES.map(|(i, j)| Formula::Number(inertia * axis[i] * axis[j])),
    }
}

/// Mass, centre and inertia of a mass without free parameters.
struct NumericMass {
    mass: f64,
    center: [f64; 3],
    inertia: [f64; 6],
}

impl NumericMass {
    fn new(mass: &Mass) -> Option<Self> {
        let [x, y, z] = mass.center.each_ref().map(Formula::as_number);
        let mut inertia = [0.0; 6];
        for (entry, formula) in inertia.iter_mut().zip(&mass.inertia) {
            *entry = formula.as_number()?;
        }
        Some(Self { mass: mass.mass.as_number()?, center: [x?, y?, z?], inertia })
    }
}

/// Combines the masses without free parameters to one mass, which becomes the first mass of the list.
fn lumped(masses: Vec<Mass>) -> Vec<Mass> {
    let (numeric, others): (Vec<_>, Vec<_>) =
        masses.into_iter().partition(|mass| NumericMass::new(mass).is_some());
    let numeric: Vec<NumericMass> = numeric.iter().filter_map(NumericMass::new).collect();
    let mut all: Vec<Mass> = Vec::new();
    all.extend((!numeric.is_empty()).then(|| lump(&numeric)));
    all.extend(others);
    all
}

/// Combines masses to one mass: `m = Σ mᵢ`, `c = Σ mᵢ cᵢ / m` and `I = Σ Iᵢ + mᵢ (|dᵢ|² 1 − dᵢ dᵢᵀ)` with
/// `dᵢ = cᵢ − c`.
fn lump(masses: &[NumericMass]) -> Mass {
    let total: f64 = masses.iter().map(|part| part.mass).sum();
    let center: [f64; 3] = std::array::from_fn(|i| {
        let first: f64 = masses.iter().map(|part| part.mass * part.center[i]).sum();
        if total > 0.0 { first / total } else { 0.0 }
    });
    let inertia = PLACES.map(|(i, j)| {
        let about = |part: &NumericMass| {
            let d: [f64; 3] = std::array::from_fn(|k| part.center[k] - center[k]);
            let square: f64 = d.iter().map(|x| x * x).sum();
            let steiner = f64::from(u8::from(i == j)) * square - d[i] * d[j];
            part.inertia[ENTRY[i][j]] + part.mass * steiner
        };
        masses.iter().map(about).sum::<f64>()
    });
    Mass {
        mass: Formula::Number(total),
        center: without_rounding(center).map(Formula::Number),
        inertia: without_rounding(inertia).map(Formula::Number),
    }
}

fn without_rounding<const K: usize>(entries: [f64; K]) -> [f64; K] {
    let largest = entries.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    entries.map(|x| if x.abs() < ROUNDING * largest { 0.0 } else { x })
}
