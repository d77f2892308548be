//! Joints that follow others, and drives that act on several coordinates.

use fastrand::Rng;
use gelenk_codegen::formula::Formula;
use gelenk_codegen::model::{FollowedCoordinate, Follower, Model, Motion};

use super::numbers::{chance, length, number, product, within};
use super::tree::{drives, shaft_friction};

/// Makes about a third of the coordinates followers, and lets drives act on several.
pub(super) fn couple(rng: &mut Rng, model: &mut Model) {
    let moving = std::mem::take(&mut model.coordinates);
    let (own, followers): (Vec<usize>, Vec<usize>) = moving
        .iter()
        .enumerate()
        .map(|(k, link)| (k > 0 && chance(rng, 0.35), *link))
        .fold((vec![], vec![]), |(mut own, mut followers), (follows, link)| {
            if follows {
                followers.push(link)
            } else {
                own.push(link)
            }
            (own, followers)
        });
    let n = own.len();
    let free = !model.parameters.is_empty();
    for (index, &link) in followers.iter().enumerate() {
        let follows = followed(rng, n, free);
        let offset = length(rng, 1.0);
        model.followers.push(Follower { link, follows, offset });
        set_motion(model, link, Motion::Follower(n + index));
    }
    for (index, &link) in own.iter().enumerate() {
        set_motion(model, link, Motion::Coordinate(index));
    }
    model.coordinates = own;
    let links = model.links.clone();
    model.drives = drives(rng, &links);
    for drive in &mut model.drives {
        if n > 1 && !drive.acts_on.is_empty() && chance(rng, 0.4) {
            drive.acts_on = followed(rng, n, free);
            drive.friction = shaft_friction(rng);
        }
    }
}

pub(super) fn set_motion(model: &mut Model, link: usize, motion: Motion) {
    if let Some(joint) = &mut model.links[link].joint {
        joint.motion = motion;
    }
}

/// One to three coordinates with ratios.
pub(super) fn followed(rng: &mut Rng, coordinates: usize, free: bool) -> Vec<FollowedCoordinate> {
    let mut all: Vec<usize> = (0..coordinates).collect();
    rng.shuffle(&mut all);
    all.truncate(rng.usize(1..=3));
    let ratio = |rng: &mut Rng| {
        let ratio = match rng.u8(0..4) {
            0 => 1.0,
            1 => -1.0,
            _ => within(rng, 2.0) + 0.1,
        };
        if free && chance(rng, 0.3) { product(Formula::Parameter(1), number(ratio)) } else { number(ratio) }
    };
    all.into_iter().map(|coordinate| FollowedCoordinate { coordinate, ratio: ratio(rng) }).collect()
}
