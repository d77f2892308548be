//! Frames that move, and laws of the forces between them.

use fastrand::Rng;
use gelenk_codegen::formula::{Formula, Function};
use gelenk_codegen::model::{Attachment, Model, Pose};

use super::moves;
use super::numbers::{direction, number, place, product, rotation};

fn attachment(rng: &mut Rng, model: &Model, translation: [f64; 3]) -> Attachment {
    let link = rng.usize(0..model.links.len());
    let pose = Pose { translation: translation.map(number), rotation: rotation(rng) };
    Attachment { name: format!("on {link}"), link, pose }
}

/// The first link on the way to the base whose own joint moves; the base for what does not move.
pub(super) fn carrier(model: &Model, mut link: usize) -> usize {
    while let Some(joint) = &model.links[link].joint {
        if moves(&model.links[link]) {
            break;
        }
        link = joint.parent;
    }
    link
}

pub(super) fn moving(rng: &mut Rng, model: &Model) -> Attachment {
    loop {
        let translation = place(rng, 0.5);
        let at = attachment(rng, model, translation);
        if carrier(model, at.link) != 0 {
            return at;
        }
    }
}

/// Two frames that move relative to each other. Exact places would make some of them meet: no force has a direction there.
pub(super) fn separated(rng: &mut Rng, model: &Model) -> [Attachment; 2] {
    loop {
        let between = [0; 2].map(|_| {
            let translation = direction(rng).map(|x| 0.3 + x);
            attachment(rng, model, translation)
        });
        if carrier(model, between[0].link) != carrier(model, between[1].link) {
            return between;
        }
    }
}

/// A spring with a damper, or a smooth law.
pub(super) fn pull(rng: &mut Rng, free: bool) -> Formula {
    let stretch = Formula::Subtract(Box::new(Formula::Position), Box::new(number(rng.f64())));
    let stiffness = number(30.0 * rng.f64());
    let stiffness = if free { product(Formula::Parameter(0), stiffness) } else { stiffness };
    let spring = product(stiffness, if rng.bool() { stretch } else { Formula::Power(Box::new(stretch), 3) });
    let damper = Formula::Call(Function::Tanh, Box::new(product(number(3.0), Formula::Velocity)));
    let damper = if rng.bool() { damper } else { Formula::Velocity };
    Formula::sum(spring, product(number(2.0 * rng.f64()), damper))
}
