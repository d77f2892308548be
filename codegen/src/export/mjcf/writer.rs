//! Data of an MJCF file while it is written.

use crate::export::losses::Losses;
use crate::export::numbers::{Placed, Values};
use crate::export::xml::{Attributes, Xml, numbers};
use crate::model::{Drive, Model};

/// A site of an MJCF file, with the link that carries it.
pub(super) struct Site {
    pub(super) link: usize,
    pub(super) name: String,
    pub(super) placed: Placed,
}

/// A rotor that becomes a separate body of the MJCF file.
pub(super) struct Rotor<'m> {
    pub(super) drive: &'m Drive,
    pub(super) inertia: f64,
    /// Index of the link that carries the rotor.
    pub(super) carrier: usize,
}

/// A model, and the parts of its MJCF file that are finished.
pub(super) struct Writer<'m> {
    pub(super) model: &'m Model,
    pub(super) values: Values,
    pub(super) xml: Xml,
    pub(super) losses: Losses,
    pub(super) sites: Vec<Site>,
    pub(super) tendons: Vec<Tendon>,
    pub(super) equalities: Vec<(&'static str, Attributes)>,
    pub(super) actuators: Vec<Attributes>,
    pub(super) rotors: Vec<Rotor<'m>>,
}

/// A tendon of an MJCF file. Its length is a weighted sum of joint positions, or the distance of two sites.
pub(super) struct Tendon {
    tag: &'static str,
    pub(super) attributes: Attributes,
    parts: Vec<(&'static str, Attributes)>,
}

impl Tendon {
    pub(super) fn fixed(name: String, joints: Vec<(String, f64)>, further: Attributes) -> Self {
        let part = |(joint, weight)| ("joint", vec![("joint", joint), ("coef", numbers(&[weight]))]);
        let attributes = [vec![("name", name)], further].concat();
        Self { tag: "fixed", attributes, parts: joints.into_iter().map(part).collect() }
    }

    pub(super) fn spatial(name: String, sites: [String; 2], further: Attributes) -> Self {
        let parts = sites.map(|site| ("site", vec![("site", site)])).into();
        Self { tag: "spatial", attributes: [vec![("name", name)], further].concat(), parts }
    }

    pub(super) fn write(self, xml: &mut Xml) {
        xml.open(self.tag, self.attributes);
        for (tag, attributes) in self.parts {
            xml.element(tag, attributes);
        }
        xml.close();
    }
}
