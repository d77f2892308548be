//! Chains of joints of every type: how each lies to the one before, in all special directions and places, and how it moves.

use std::fmt::Write as _;

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{ReadOptions, from_toml};

use crate::random_model::numbers::{place, rigid_body};

/// A type of joint.
#[derive(Debug, PartialEq)]
pub struct Type {
    /// The type as descriptions call it.
    pub name: &'static str,
    has_axis: bool,
    /// Its velocities, if it stands for several joints.
    parts: &'static [&'static str],
}

const fn of_one(name: &'static str, has_axis: bool) -> Type {
    Type { name, has_axis, parts: &[] }
}

/// Every type.
pub const TYPES: [Type; 10] = [
    of_one("fixed", false),
    of_one("continuous", true),
    of_one("helical", true),
    Type { name: "cylindrical", has_axis: true, parts: &["turn", "slide"] },
    Type { name: "universal", has_axis: false, parts: &["x", "y"] },
    Type { name: "planar", has_axis: true, parts: &["x", "y", "theta"] },
    of_one("revolute", true),
    of_one("prismatic", true),
    Type { name: "spherical", has_axis: false, parts: &["rx", "ry", "rz"] },
    Type { name: "floating", has_axis: false, parts: &["x", "y", "z", "rx", "ry", "rz"] },
];

impl Type {
    fn has_quaternion(&self) -> bool {
        matches!(self.name, "spherical" | "floating")
    }

    fn moves(&self) -> bool {
        self.name != "fixed"
    }
}

/// The directions of x of one joint in the frame of the joint before, with the angles that turn x there.
pub const DIRECTIONS: [([f64; 3], &str); 6] = [
    ([1.0, 0.0, 0.0], "0, 0, 0"),
    ([-1.0, 0.0, 0.0], "0, 0, 'pi'"),
    ([0.0, 1.0, 0.0], "0, 0, 'pi/2'"),
    ([0.0, -1.0, 0.0], "0, 0, '-pi/2'"),
    ([0.0, 0.0, 1.0], "0, '-pi/2', 0"),
    ([0.48, -0.6, 0.64], "0.3, -0.7, 1.1"),
];

/// The place of a joint on the link before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The origin of the link.
    Same,
    /// On the axis of the joint before.
    Along,
    /// Anywhere.
    Generic,
}

impl Origin {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Same, Self::Along, Self::Generic];
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// It moves as a coordinate of its own.
    Free,
    /// As a further joint does.
    Follows,
    /// As it is prescribed.
    Driven,
}

impl Role {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Free, Self::Follows, Self::Driven];
}

/// A chain of joints.
#[derive(Debug, Clone)]
pub struct Chain {
    /// Their types.
    pub types: Vec<&'static Type>,
    /// How they move.
    pub roles: Vec<Role>,
    /// For each but the first, its direction in the joint before, by the number in [`DIRECTIONS`].
    pub directions: Vec<usize>,
    /// For each but the first, its origin.
    pub origins: Vec<Origin>,
    /// Whether a spring and an input act at frames.
    pub has_forces: bool,
}

impl Chain {
    /// Joints of types by their names.
    ///
    /// - `first`: the number of the first direction; each further joint has the next one. Numbers from 0 to 5 have all directions
    ///   and all origins, and the six numbers behind them have the directions with other origins.
    ///
    /// # Panics
    /// There is no such type.
    pub fn placed(types: &[&str], roles: &[Role], first: usize) -> Self {
        let named = |name: &&str| TYPES.iter().find(|of| of.name == *name).expect("a type");
        let numbers = first..first + types.len() - 1;
        Self {
            types: types.iter().map(named).collect(),
            roles: roles.to_vec(),
            directions: numbers.clone().map(|number| number % DIRECTIONS.len()).collect(),
            origins: numbers
                .map(|number| Origin::ALL[(number + number / DIRECTIONS.len() + 1) % 3])
                .collect(),
            has_forces: false,
        }
    }

    /// Tells whether descriptions may say this: one joint of a robot floats, driven joints and quaternions exclude each other, and
    /// a joint that follows has one axis.
    pub fn is_describable(&self) -> bool {
        let has = |wanted: fn(&Type) -> bool| self.types.iter().filter(|of| wanted(of)).count();
        let suits = |(of, role): (&&Type, &Role)| match role {
            Role::Free => true,
            Role::Follows => of.moves() && of.has_axis && of.parts.is_empty(),
            Role::Driven => of.moves() && has(Type::has_quaternion) == 0,
        };
        has(|of| of.name == "floating") < 2 && self.types.iter().zip(&self.roles).all(suits)
    }

    /// Whether a hinge stands before the chain: others may follow it, and something has to move.
    fn has_leader(&self) -> bool {
        self.roles.contains(&Role::Follows) || !self.has_coordinate()
    }

    fn has_coordinate(&self) -> bool {
        let mut places = self.types.iter().zip(&self.roles);
        places.any(|(of, role)| of.moves() && *role == Role::Free)
    }

    /// A joint that follows may undo the motion of its leader: then no coordinate moves the tip, and descriptions of forces on
    /// it are refused.
    fn moves_its_tip(&self) -> bool {
        !self.roles.contains(&Role::Follows) || self.has_coordinate()
    }

    /// The chain as a description. The first letters of the alphabet are its joints; what is not enumerated is drawn.
    pub fn text(&self, seed: u64) -> String {
        let mut rng = Rng::with_seed(seed);
        let mut text = format!("name = \"chain\"\ngravity = {:?}\n", gravity(&mut rng));
        if self.has_leader() {
            text += "[[joints]]\nname = \"lead\"\naxis = [1, 0, 0]\ndrive = \"ideal\"\n";
            text += &body("lead", &mut rng);
        }
        for place in 0..self.types.len() {
            text += &self.joint(place, &mut rng);
            text += &body(name(place), &mut rng);
        }
        text += &self.frames(&mut rng);
        let axes = if rng.bool() { "frame" } else { "base" };
        _ = writeln!(text, "[[wrenches]]\nname = \"push\"\nframe = \"tip\"\nin = \"{axes}\"");
        if self.has_forces && self.moves_its_tip() {
            text += "[[forces]]\nbetween = [\"anchor\", \"tip\"]\nlaw = \"30*(l - 0.4) + 2*dl\"\n";
            text += "[[inputs]]\nname = \"thrust\"\nframe = \"tip\"\nlimits = [-9, 9]\nwrench = [0.13, -0.07, 1, 0.05, 0.21, 0.11]\n";
        }
        text
    }

    /// A distance between exact places may stay as it is, and an exact wrench may move nothing: both are refused.
    fn frames(&self, rng: &mut Rng) -> String {
        let tip = if self.has_forces { [0.17, 0.23, -0.31] } else { place_of(rng, 0.4) };
        let last = name(self.types.len() - 1);
        let places =
            [("tip", last, tip), ("mid", name(0), [0.0; 3]), ("anchor", "base", [0.35, -0.27, 0.19])];
        let frame = |(frame, link, xyz): (&str, &str, [f64; 3])| {
            let rpy = place_of(rng, 2.0);
            let origin = format!("{{ xyz = {xyz:?}, rpy = {rpy:?} }}");
            format!("[[frames]]\nname = \"{frame}\"\nlink = \"{link}\"\norigin = {origin}\n")
        };
        places.map(frame).concat()
    }

    fn joint(&self, place: usize, rng: &mut Rng) -> String {
        let (of, role) = (self.types[place], self.roles[place]);
        let mut text = format!("[[joints]]\nname = \"{}\"\ntype = \"{}\"\n", name(place), of.name);
        text += &self.origin(place, rng);
        if of.has_axis {
            let axis = self.directions.get(place).map_or(DIRECTIONS[0].0, |&k| DIRECTIONS[k].0);
            _ = writeln!(text, "axis = {axis:?}");
        }
        if of.name == "helical" {
            text += "pitch = 0.15\n";
        }
        match role {
            Role::Free if of.moves() => text += drive(of, rng),
            Role::Free => {}
            Role::Follows => text += "follows = { lead = -1 }\noffset = 0.2\n",
            Role::Driven => text += "motion = \"driven\"\n",
        }
        text + friction(of).as_str()
    }

    /// The direction is said by the axis of the joint before, or here where it has none.
    fn origin(&self, place: usize, rng: &mut Rng) -> String {
        let Some(before) = place.checked_sub(1) else {
            return format!("origin = {{ xyz = {:?} }}\n", place_of(rng, 0.3));
        };
        let (direction, turn) = DIRECTIONS[self.directions[before]];
        let xyz = match self.origins[before] {
            Origin::Same => [0.0; 3],
            Origin::Along => direction.map(|x| 0.3 * x),
            Origin::Generic => [0.1, -0.25, 0.2],
        };
        let rpy = if self.types[before].has_axis { DIRECTIONS[0].1 } else { turn };
        format!("origin = {{ xyz = {xyz:?}, rpy = [{rpy}] }}\n")
    }

    /// The model of the description.
    ///
    /// # Panics
    /// The description is refused.
    pub fn model(&self, seed: u64) -> Model {
        let text = self.text(seed);
        let options = ReadOptions::default();
        let read = from_toml(&text, "chain.toml", &options, &mut |file| unreachable!("{file}"));
        read.unwrap_or_else(|problems| panic!("{text}\n{problems}")).0
    }
}

fn name(place: usize) -> &'static str {
    ["a", "b", "c"][place]
}

fn gravity(rng: &mut Rng) -> [f64; 3] {
    if rng.bool() { [0.0, 0.0, -9.81] } else { [3.0, -4.0, 8.0] }
}

/// Numbers of which most are exact.
fn place_of(rng: &mut Rng, size: f64) -> [f64; 3] {
    place(rng, size).map(|x| (x * 1e3).round() / 1e3)
}

fn body(link: &str, rng: &mut Rng) -> String {
    let body = rigid_body(rng, link);
    let numbers = |formulas: &[Formula]| -> Vec<f64> {
        let value = |formula: &Formula| crate::oracle::value(formula, &[], 0.0, 0.0);
        formulas.iter().map(value).collect()
    };
    let [xx, xy, xz, yy, yz, zz] = <[f64; 6]>::try_from(numbers(&body.inertia)).expect("six");
    format!(
        "[[bodies]]\nlink = \"{link}\"\nmass = {:?}\ncenter_of_mass = {:?}\n\
         inertia = {{ xx = {xx:?}, xy = {xy:?}, xz = {xz:?}, yy = {yy:?}, yz = {yz:?}, zz = {zz:?} }}\n",
        numbers(std::slice::from_ref(&body.mass))[0],
        numbers(&body.center_of_mass),
    )
}

fn drive(of: &Type, rng: &mut Rng) -> &'static str {
    match of.parts {
        [] if rng.bool() => {
            "drive = { gear_ratio = -20, rotor_inertia = 2e-4 }\nspring = \"-5*y - 2*pow(y, 3)\"\n"
        }
        _ => "drive = \"ideal\"\n",
    }
}

fn friction(of: &Type) -> String {
    let law = "\"0.3*v + 0.2*tanh(4*v)\"";
    let of_parts = of.parts.iter().map(|part| format!("{part} = {law}")).collect::<Vec<_>>().join(", ");
    match of.parts {
        _ if !of.moves() => String::new(),
        [] => format!("friction = {law}\n"),
        _ => format!("friction = {{ {of_parts} }}\n"),
    }
}
