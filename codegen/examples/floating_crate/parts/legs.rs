//! Finds the feet of a legged robot by a rule, or takes the links that the user names.

use super::toml_text;
use gelenk_codegen::formula::nearest;
use gelenk_codegen::model::{Model, Motion, Pose};

/// A foot and its leg, as names of links.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Foot {
    /// First link of the leg that a joint moves.
    hip: String,
    /// Link whose origin is on the ground.
    foot: String,
}

/// Smallest number of feet that can carry a robot by forces without moments.
const FEWEST: usize = 3;

/// Smallest number of joints of a leg with which the foot can be placed.
const JOINTS: usize = 3;

/// Feet of a robot with a floating base; empty if the rule finds none.
///
/// Legs are branches of the base without further branching, with the same number of joints (at least three).
/// The largest group of such legs is used if it has at least three. The foot is the last link of a leg,
/// farthest from its last joint.
pub fn feet(model: &Model, named: &[String]) -> Result<Vec<Foot>, String> {
    let legs = Legs { model, base: base(model) };
    if !named.is_empty() {
        return legs.named(named);
    }
    let all: Vec<(usize, Foot)> = legs.all();
    let alike = |joints: usize| all.iter().filter(|(count, _)| *count == joints).count();
    let most = all.iter().map(|(joints, _)| (alike(*joints), *joints)).max();
    let Some((_, joints)) = most.filter(|(count, _)| *count >= FEWEST) else { return Ok(vec![]) };
    Ok(all.into_iter().filter(|(count, _)| *count == joints).map(|(_, foot)| foot).collect())
}

/// The floating link.
pub fn base(model: &Model) -> Option<usize> {
    let joint = model.quaternion_joints.first()?;
    model.coordinates.get(joint.coordinates().end - 1).copied()
}

struct Legs<'m> {
    model: &'m Model,
    base: Option<usize>,
}

impl Legs<'_> {
    fn parent(&self, link: usize) -> Option<usize> {
        self.model.links[link].joint.as_ref().map(|joint| joint.parent)
    }

    fn moves(&self, link: usize) -> bool {
        let joint = self.model.links[link].joint.as_ref();
        joint.is_some_and(|joint| matches!(joint.motion, Motion::Coordinate(_) | Motion::Follower(_)))
    }

    /// The links with moving joints on the path from a link to the base, without the base; `None` if the base
    /// does not carry the link.
    fn way(&self, link: usize) -> Option<Vec<usize>> {
        let mut way = vec![];
        let mut at = link;
        while Some(at) != self.base {
            way.extend(self.moves(at).then_some(at));
            at = self.parent(at)?;
        }
        Some(way)
    }

    /// All legs that end in a foot, with the numbers of joints.
    fn all(&self) -> Vec<(usize, Foot)> {
        let links = 0..self.model.links.len();
        let ways = links.filter(|&link| self.moves(link)).filter_map(|link| self.way(link));
        let ways: Vec<Vec<usize>> = ways.filter(|way| !way.is_empty()).collect();
        let carries = |link: usize| ways.iter().any(|way| way[1..].contains(&link));
        let ends = ways.iter().filter(|way| !carries(way[0]));
        let is_beside = |way: &[usize], link: &usize| {
            ways.iter().any(|other| !way.contains(&other[0]) && other.contains(link))
        };
        let shared = |way: &[usize]| way[1..].iter().any(|link| is_beside(way, link));
        let legs = ends.filter(|way| way.len() >= JOINTS && !shared(way));
        let foot = |way: &Vec<usize>| Some((way.len(), self.foot(*way.last()?, self.farthest(way[0])?)));
        legs.filter_map(foot).collect()
    }

    /// The link that is fixed to the link `end` and has the farthest origin; `None` if no origin is apart
    /// from that of `end`.
    fn farthest(&self, end: usize) -> Option<usize> {
        let links = 0..self.model.links.len();
        let distances = links.filter_map(|link| Some((self.distance(end, link)?, link)));
        let far = distances.filter(|(distance, _)| *distance > 1e-6);
        far.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, link)| link)
    }

    /// Distance of the origins of `link` and `from` [m]; `None` if `link` is not fixed to `from`.
    fn distance(&self, from: usize, link: usize) -> Option<f64> {
        let mut pose = Pose::identity();
        let mut at = link;
        while at != from {
            let joint = self.model.links[at].joint.as_ref().filter(|joint| joint.motion == Motion::Fixed)?;
            pose = joint.origin.then(&pose);
            at = joint.parent;
        }
        let entries: Option<Vec<f64>> = pose.translation.iter().map(|entry| entry.as_number()).collect();
        Some(entries?.iter().map(|x| x * x).sum::<f64>().sqrt())
    }

    fn foot(&self, hip: usize, foot: usize) -> Foot {
        let name = |link: usize| self.model.links[link].name.clone();
        Foot { hip: name(hip), foot: name(foot) }
    }

    fn named(&self, names: &[String]) -> Result<Vec<Foot>, String> {
        let feet: Result<Vec<(usize, Foot)>, String> = names.iter().map(|name| self.of(name)).collect();
        let feet = feet?;
        for (k, (hip, foot)) in feet.iter().enumerate() {
            if let Some((_, other)) = feet[..k].iter().find(|(other, _)| other == hip) {
                return Err(format!(
                    "`{}` and `{}` are on the same leg\n  = help: name one foot per leg",
                    other.foot, foot.foot
                ));
            }
        }
        if feet.len() < FEWEST {
            return Err(format!(
                "only {} feet are named\n  = help: forces at the feet alone can carry a robot with {FEWEST} \
                 feet or more",
                feet.len()
            ));
        }
        Ok(feet.into_iter().map(|(_, foot)| foot).collect())
    }

    /// The leg of a foot, and the foot.
    fn of(&self, name: &str) -> Result<(usize, Foot), String> {
        let links = || self.model.links.iter().map(|link| link.name.as_str());
        let Some(link) = links().position(|link| link == name) else {
            let near = nearest(name, links()).unwrap_or_default();
            return Err(format!("`{name}` is not a link of the robot\n  = help: {near}"));
        };
        match self.way(link).as_deref() {
            Some(way @ [.., hip]) if way.len() >= JOINTS => Ok((*hip, self.foot(*hip, link))),
            Some(way) => Err(format!(
                "the leg of `{name}` has {} of the {JOINTS} joints that it needs\n  = help: name the last link \
                 of a leg that begins at the base",
                way.len()
            )),
            None => {
                Err(format!("the base does not carry `{name}`\n  = help: name the last links of the legs"))
            }
        }
    }
}

/// Entries of `robot.toml` for the feet: frames, and wrenches of the ground.
pub fn description(feet: &[Foot]) -> String {
    let mut text = String::from(
        "\n# The feet, and what the ground exerts on them. Contact is not simulated: src/main.rs chooses these forces, in the axes of the\n\
         # world.\n",
    );
    for (k, Foot { hip, foot }) in feet.iter().enumerate() {
        text.push_str(&format!(
            "\n[[frames]]\nname = \"hip_{k}\"\nlink = {}\n[[frames]]\nname = \"foot_{k}\"\nlink = {}\n\
             [[wrenches]]\nname = \"ground_{k}\"\nframe = \"foot_{k}\"\nin = \"base\"\n",
            toml_text(hip),
            toml_text(foot)
        ));
    }
    text
}

/// Text of the program with its list of feet.
pub fn program(count: usize) -> String {
    let foot = |k: usize| {
        format!(
            "    foot!(\n        frame_hip_{k}_pose,\n        frame_foot_{k}_pose,\n        frame_foot_{k}_jacobian,\n        \
             frame_foot_{k}_jacobian_rate_times_velocity\n    ),"
        )
    };
    let feet = Vec::from_iter((0..count).map(foot)).join("\n");
    include_str!("on_legs.rs").replace("    // FEET", &feet)
}
