//! Keys at the top level of a description.

use super::bodies::{BODY, FRAME};
use super::drives::SHARED_DRIVE;
use super::frame_forces::{FORCE, INPUT, WRENCH};
use super::joints::JOINT;
use super::row::{Keys, Value, key};
use super::values::{DESCRIPTION, UNIT, VECTOR};

const NAMES: Value = Value::List(&Value::Name, None);

#[rustfmt::skip]
pub(crate) static ROBOT: Keys = Keys {
    name: "robot",
    what: "a robot",
    groups: &[&[
        key("name", Value::Name, r#""arm""#, "name of the module").default("the file's name"),
        key("description", Value::Text, r#""An arm with two joints""#, "text for the documentation; may have several lines"),
        key("urdf", Value::Name, r#""arm.urdf""#, "the URDF that this file extends, a path relative to this file"),
        key("extends", Value::Name, r#""arm.toml""#, "the TOML, URDF or MJCF that this file extends, a path relative to this file"),
        key("gravity", VECTOR, "[0, 0, -9.81]", "gravitational acceleration in the base frame").unit("m/s²").default("[0, 0, -9.81]"),
        key("coordinates", NAMES, r#"["shoulder", "elbow"]"#, "names of all moving joints that follow no other joint, in the desired order").default("order of the description"),
        key("base", Value::Either(&[Value::Name, Value::Table(&BASE)]), r#"{ link = "trunk", type = "floating" }"#, "name of the base link, or a table that lets the base move freely").default(r#"`"base"`, or the only link without a joint; fixed"#),
        key("held", Value::Names(&Value::Number), r#"{ "finger_*" = 0, gripper = 0.02 }"#, "joints that are held at a position, by names or patterns with `*`; replaces `held` of a joint").unit("rad or m"),
        key("body", Value::Name, r#""link0""#, "a body in the scene of an extended MJCF; the kinematic tree with this body is the robot").default("all bodies"),
        key("snap_angles", Value::Positive, "1e-4", "angles within this distance of a multiple of 90° are rounded to this multiple").unit("rad").default("off"),
        key("ignore_mimic", Value::Flag, "true", "makes mimic joints of the URDF or MJCF independent coordinates").default("false"),
        key("no_friction", Value::Flag, "true", "ignores damping and friction of the URDF or MJCF").default("false"),
        key("accept_unphysical", Value::Flag, "true", "accepts a robot whose mass matrix is not positive definite").default("false"),
        key("generate", Value::Table(&GENERATE), r#"{ functions = ["inverse_dynamics"] }"#, "functions to generate, and their form").default("all functions except those on request"),
        key("parameters", Value::Names(&Value::Either(&[Value::Number, Value::Table(&PARAMETER)])), "{ m1 = 2.5 }", "parameters that stay free in the generated code"),
        key("bodies", Value::List(&Value::Table(&BODY), None), r#"[{ link = "forearm", mass = 2.5 }]"#, "rigid bodies, fixed to links").also(&["links", "link", "masses"]),
        key("joints", Value::List(&Value::Table(&JOINT), None), r#"[{ name = "elbow", axis = [0, 1, 0] }]"#, "joints"),
        key("drives", Value::List(&Value::Table(&SHARED_DRIVE), None), r#"[{ name = "left", on = { pitch = 1, roll = 1 } }]"#, "drives that act on several joints").also(&["motors", "actuators"]),
        key("forces", Value::List(&Value::Table(&FORCE), None), r#"[{ between = ["foot", "rod"], input = "cylinder" }]"#, "forces between two frames, for example springs and cylinders"),
        key("inputs", Value::List(&Value::Table(&INPUT), None), r#"[{ name = "fan", frame = "tip", wrench = [0, 1, 0, 0, 0, 0] }]"#, "inputs that are wrenches at a frame, for example propellers"),
        key("wrenches", Value::List(&Value::Table(&WRENCH), None), r#"[{ name = "contact", frame = "tip" }]"#, "wrenches that are arguments of functions, for example contact forces"),
        key("frames", Value::List(&Value::Table(&FRAME), None), r#"[{ name = "tool", link = "forearm" }]"#, "named frames, whose poses and Jacobians are generated"),
    ]],
};

#[rustfmt::skip]
static BASE: Keys = Keys {
    name: "base",
    what: "the base",
    groups: &[&[
        key("link", Value::Name, r#""trunk""#, "name of the base link").default(r#"`"base"`, or the only link without a joint"#),
        key("type", Value::Words(&["fixed", "floating"]), r#""floating""#, "fixed base or floating base").default(r#"`"fixed"`"#),
    ]],
};

#[rustfmt::skip]
static GENERATE: Keys = Keys {
    name: "generate",
    what: "the choice of functions",
    groups: &[&[
        key("functions", NAMES, r#"["inverse_dynamics", "linearize"]"#, "functions to generate; `frames` selects the functions of all named frames, and `all` selects all except those on request").default("all except those on request"),
        key("lanes", NAMES, r#"["inverse_dynamics"]"#, "functions that are also generated for eight states at once").default("none"),
        key("smooth_sign", Value::Positive, "50", "slope s: `sign(v)` becomes `tanh(s v)` in friction, springs and forces between frames, and `abs(sign(v))` becomes its square").default("the exact sign"),
        key("substeps", Value::Positive, "2", "Runge–Kutta steps within one period of `step`, from 1 to 1000").default("1"),
    ]],
};

#[rustfmt::skip]
static PARAMETER: Keys = Keys {
    name: "parameter",
    what: "a parameter",
    groups: &[&[
        key("value", Value::Number, "2.5", "default value of the parameter").needed(),
        UNIT,
        DESCRIPTION,
    ]],
};
