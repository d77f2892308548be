//! Keys of joints.

use super::drives::DRIVE;
use super::force_laws::{FRICTION, SPRING};
use super::row::{Key, Keys, Value, key};
use super::values::{NUMBERS, POSE, RANGE};

const TYPES: Value = Value::Words(&[
    "fixed",
    "revolute",
    "continuous",
    "prismatic",
    "helical",
    "cylindrical",
    "universal",
    "planar",
    "spherical",
    "floating",
]);

#[rustfmt::skip]
pub(super) static JOINT: Keys = Keys {
    name: "joint",
    what: "a joint",
    groups: &[
        PLACE,
        &[
            key("held", Value::ByPart(&Value::Number), "0.5", "position at which the joint is held; a held joint is not a coordinate").unit("rad or m"),
            key("motion", Value::ByPart(&Value::Words(&["free", "driven"])), r#""driven""#, "`free`: the motion follows from forces; `driven`: the motion is prescribed").default(r#"`"free"`"#),
            key("follows", Value::Names(&Value::Formula), "{ shoulder = -0.5 }", "the joints that this joint follows, with their ratios").also(&["mimic"]),
            key("offset", Value::Number, "0.1", "position of this joint if the followed joints are at 0").unit("rad or m").default("0"),
            key("limits", Value::ByPart(&Value::Table(&LIMITS)), "{ position = [-1.5, 1.5], velocity = 2, effort = 40 }", "limits at the joint; controllers use the smaller of `effort` divided by the gear ratio and the motor's `torque`"),
            key("spring", Value::ByPart(&Value::Either(&[Value::Law, Value::Table(&SPRING), Value::List(&Value::Either(&[Value::Law, Value::Table(&SPRING)]), None)])), "{ stiffness = 100, rest = 0.2 }", "a spring, a list of springs, or a force law in `y` and `v`; its force is added to the other forces").default("none"),
            key("friction", Value::ByPart(&Value::Either(&[Value::Law, Value::Table(&FRICTION)])), "{ viscous = 0.4 }", "a law in `v` and `y` for the force that opposes the motion, or a table of laws, which are added").default("none"),
            key("drive", Value::ByPart(&Value::Either(&[Value::Words(&["ideal", "none"]), Value::Table(&DRIVE)])), "{ gear_ratio = 100, rotor_inertia = 2e-5 }", "`ideal`: the force or torque at the joint is an input; `none`: no input; a table: a motor").default(r#"`"none"`; that of the URDF or MJCF"#).also(&["actuated", "actuator", "motor"]),
        ],
    ],
};

#[rustfmt::skip]
static PLACE: &[Key] = &[
    key("name", Value::Name, r#""elbow""#, "name of the coordinate").needed(),
    key("type", TYPES, r#""helical""#, "kind of motion").default(r#"`"revolute"`"#),
    key("parent", Value::Name, r#""upper_arm""#, "the link that carries the joint; naming a link creates it").default("the link of the previous joint"),
    key("child", Value::Name, r#""forearm""#, "the link that the joint moves; naming a link creates it").default("a link with the joint's name"),
    key("origin", POSE, "{ xyz = [0, 0, 0.5], rpy = [0, 0, 0] }", "the joint's frame in the frame of the parent link").default("identity"),
    key("dh", Value::Table(&DH), r#"{ a = 0.4, alpha = "pi/2", d = 0, theta = 0 }"#, "standard Denavit–Hartenberg row, replaces `origin` and `axis`: R_z(θ + y) T_z(d) T_x(a) R_x(α)"),
    key("modified_dh", Value::Table(&DH), r#"{ a = 0.4, alpha = "pi/2", d = 0, theta = 0 }"#, "modified Denavit–Hartenberg row (Craig, Khalil), replaces `origin` and `axis`: R_x(α) T_x(a) R_z(θ + y) T_z(d)"),
    key("axis", NUMBERS, "[0, 1, 0]", "unit vector in the joint's frame").default("[0, 0, 1]"),
    key("pitch", Value::Number, r#""0.02/(2*pi)""#, "translation along the axis per rotation angle; required for a helical joint").unit("m/rad"),
];

#[rustfmt::skip]
static DH: Keys = Keys {
    name: "dh",
    what: "a Denavit–Hartenberg row",
    groups: &[&[
        key("a", Value::Formula, "0.4", "length along x").unit("m").default("0"),
        key("alpha", Value::Number, r#""pi/2""#, "angle about x").unit("rad").default("0"),
        key("d", Value::Formula, "0.1", "constant length along z; the position of a prismatic joint is added").unit("m").default("0"),
        key("theta", Value::Number, r#""pi/2""#, "constant angle about z; the position of a revolute joint is added").unit("rad").default("0"),
    ]],
};

#[rustfmt::skip]
static LIMITS: Keys = Keys {
    name: "limits",
    what: "limits",
    groups: &[&[
        key("position", RANGE, "[-1.5, 1.5]", "lowest and highest position").unit("rad or m").also(&["lower", "upper", "min", "max"]),
        key("velocity", Value::Positive, "2", "highest speed").unit("rad/s or m/s").also(&["speed"]),
        key("effort", Value::Positive, "40", "largest torque or force of the drive at the joint").unit("N m or N").also(&["force", "torque"]),
        key("peak_effort", Value::Positive, "60", "largest short-time torque or force").unit("N m or N"),
        key("acceleration", Value::Positive, "5", "highest acceleration, written to `ACCELERATION_LIMITS` of the module").unit("rad/s² or m/s²"),
        key("jerk", Value::Positive, "50", "highest jerk, written to `JERK_LIMITS` of the module").unit("rad/s³ or m/s³"),
    ]],
};
