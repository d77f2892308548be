//! Types of values that several tables of keys share.

use super::row::{Key, Keys, Value, key};

pub(super) const VECTOR: Value = Value::List(&Value::Formula, Some(3));
pub(super) const NUMBERS: Value = Value::List(&Value::Number, Some(3));
pub(super) const RANGE: Value = Value::List(&Value::Number, Some(2));
pub(super) const POSE: Value = Value::Table(&PLACE);

#[rustfmt::skip]
pub(super) const UNIT: Key = key("unit", Value::Text, r#""kg""#, "unit of the parameter, for documentation");
#[rustfmt::skip]
pub(super) const DESCRIPTION: Key =
    key("description", Value::Text, r#""payload""#, "meaning of the parameter, for documentation");

/// A free parameter instead of a number.
#[rustfmt::skip]
pub(crate) static FREE: Keys = Keys {
    name: "free",
    what: "a free value",
    groups: &[&[
        key("free", Value::Number, "2.5", "default value of the parameter").needed(),
        key("name", Value::Name, r#""payload""#, "name of the parameter").default("owner and key, for example `arm_mass`"),
        UNIT,
        DESCRIPTION,
    ]],
};

#[rustfmt::skip]
static PLACE: Keys = Keys {
    name: "pose",
    what: "a pose",
    groups: &[&[
        key("xyz", VECTOR, "[0, 0, 0.5]", "position of the origin").unit("m").default("[0, 0, 0]"),
        key("rpy", NUMBERS, r#"[0, "pi/2", 0]"#, "roll, pitch and yaw: R = R_z(yaw) R_y(pitch) R_x(roll)").unit("rad").default("[0, 0, 0]"),
        key("quaternion", Value::Table(&QUATERNION), "{ w = 1, x = 0, y = 0, z = 0 }", "unit quaternion, replaces `rpy`"),
    ]],
};

#[rustfmt::skip]
static QUATERNION: Keys = Keys {
    name: "quaternion",
    what: "a quaternion",
    groups: &[&[
        key("w", Value::Number, "1", "real part").default("0"),
        key("x", Value::Number, "0", "imaginary part along x").default("0"),
        key("y", Value::Number, "0", "imaginary part along y").default("0"),
        key("z", Value::Number, "0", "imaginary part along z").default("0"),
    ]],
};
