//! Keys of bodies and frames.

use super::row::{Keys, Value, key};
use super::values::{POSE, VECTOR};

#[rustfmt::skip]
pub(super) static BODY: Keys = Keys {
    name: "body",
    what: "a body",
    groups: &[&[
        key("name", Value::Name, r#""payload""#, "name of the body; several bodies on a link need names").default("the link's name"),
        key("link", Value::Name, r#""forearm""#, "the link that the body is fixed to").default("the body's name"),
        key("mass", Value::Formula, "2.5", "mass, at least 0; required for a new body; an inertia without mass gives a warning").unit("kg"),
        key("center_of_mass", VECTOR, "[0, 0, 0.1]", "centre of mass in the frame of the link").unit("m").default("[0, 0, 0]").also(&["com", "cog", "center_of_gravity"]),
        key("inertia", Value::Either(&[Value::Formula, VECTOR, Value::Table(&INERTIA)]), "[0.1, 0.1, 0.02]", "inertia about the centre of mass: one moment for all axes, three principal moments, or the matrix as a table").unit("kg m²").default("0"),
        key("origin", POSE, "{ xyz = [0.2, 0, 0.05] }", "pose of the body's frame in the link's frame; centre of mass and inertia are given in the body's frame").default("identity"),
        key("accept_unphysical", Value::Flag, "true", "accepts a published inertia that no real body has").default("false"),
    ]],
};

#[rustfmt::skip]
static INERTIA: Keys = Keys {
    name: "inertia",
    what: "an inertia",
    groups: &[&[
        key("xx", Value::Formula, "0.1", "moment about x").unit("kg m²").default("0"),
        key("xy", Value::Formula, "0", "matrix entry −∫ x y dm, with the sign of URDF").unit("kg m²").default("0"),
        key("xz", Value::Formula, "0", "matrix entry −∫ x z dm").unit("kg m²").default("0"),
        key("yy", Value::Formula, "0.1", "moment about y").unit("kg m²").default("0"),
        key("yz", Value::Formula, "0", "matrix entry −∫ y z dm").unit("kg m²").default("0"),
        key("zz", Value::Formula, "0.02", "moment about z").unit("kg m²").default("0"),
    ]],
};

#[rustfmt::skip]
pub(super) static FRAME: Keys = Keys {
    name: "frame",
    what: "a frame",
    groups: &[&[
        key("name", Value::Name, r#""tool""#, "name of the frame").needed(),
        key("link", Value::Name, r#""forearm""#, "the link that carries the frame").also(&["parent"]).needed(),
        key("origin", POSE, "{ xyz = [0, 0, 0.1] }", "pose of the frame in the frame of its link").default("identity"),
    ]],
};
