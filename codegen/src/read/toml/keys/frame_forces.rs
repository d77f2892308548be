//! Keys of forces at frames.

use super::row::{Keys, Value, key};
use super::values::RANGE;

#[rustfmt::skip]
pub(super) static FORCE: Keys = Keys {
    name: "force",
    what: "a force",
    groups: &[&[
        key("name", Value::Name, r#""ram""#, "name for messages and generated code").default("the input's name, or the frames' names"),
        key("between", Value::List(&Value::Name, Some(2)), r#"["anchor", "hook"]"#, "two frames or links, on bodies that move relative to each other").needed(),
        key("law", Value::Number, r#""1200*(l - 0.3) + 40*dl""#, "force as a formula in the distance l and its rate dl, positive if it pulls, for example a spring or a damper").unit("N").also(&["type", "stiffness", "rest", "damping"]),
        key("input", Value::Name, r#""cylinder""#, "name of an input force, positive if it pulls; may be combined with `law`").unit("N"),
        key("limits", RANGE, "[-60e3, 35e3]", "lowest and highest value of the input; must include 0").unit("N"),
        key("stroke", RANGE, "[0.8, 1.3]", "shortest and longest distance of the two frames").unit("m"),
        key("speed", Value::Positive, "0.4", "largest rate of change of the distance").unit("m/s"),
    ]],
};

#[rustfmt::skip]
pub(super) static INPUT: Keys = Keys {
    name: "input",
    what: "an input",
    groups: &[&[
        key("name", Value::Name, r#""fan""#, "name of the input").needed(),
        key("frame", Value::Name, r#""tip""#, "the frame or link at which the wrench acts").needed(),
        key("wrench", Value::List(&Value::Formula, Some(6)), "[0, 0, 1, 0, 0, 0.02]", "force, then moment, per unit of the input, in the axes of the frame and about its origin").unit("N and N m").needed(),
        key("limits", RANGE, "[0, 8]", "lowest and highest value of the input"),
    ]],
};

#[rustfmt::skip]
pub(super) static WRENCH: Keys = Keys {
    name: "wrench",
    what: "a wrench",
    groups: &[&[
        key("name", Value::Name, r#""contact""#, "name of the argument").needed(),
        key("frame", Value::Name, r#""tool""#, "the frame or link at which the wrench acts").needed(),
        key("in", Value::Words(&["frame", "base"]), r#""base""#, "frame whose axes the wrench uses").default(r#"`"frame"`"#),
    ]],
};
