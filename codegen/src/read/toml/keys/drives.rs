//! Keys of drives.

use super::force_laws::SHAFT_FRICTION;
use super::row::{Key, Keys, Value, key};
use super::values::NUMBERS;

#[rustfmt::skip]
pub(super) static DRIVE: Keys = Keys {
    name: "drive",
    what: "a drive",
    groups: &[&[key("name", Value::Name, r#""motor""#, "name of the input").default("the joint's name")], MOTOR],
};

#[rustfmt::skip]
pub(super) static SHARED_DRIVE: Keys = Keys {
    name: "shared_drive",
    what: "a drive of `[[drives]]`",
    groups: &[
        &[
            key("name", Value::Name, r#""left""#, "name of the input").needed(),
            key("on", Value::Names(&Value::Formula), "{ pitch = 1, roll = -1 }", "the joints that the drive moves, each with its weight in the motor's motion").also(&["joints", "acts_on", "follows", "weights"]).needed(),
        ],
        MOTOR,
    ],
};

#[rustfmt::skip]
static MOTOR: &[Key] = &[
    key("gear_ratio", Value::Formula, "100", "gear ratio i: motor angle divided by joint angle; may be negative").default("1"),
    key("rotor_inertia", Value::Formula, "2e-5", "inertia J_R of the rotor about its own axis").unit("kg m²").default("0").also(&["inertia"]),
    key("coupling", Value::Words(&["body", "diagonal"]), r#""diagonal""#, "`body`: the rotor is a body that spins with i ẏ relative to its carrier; `diagonal`: i² J_R is added to the diagonal of M").default(r#"`"body"`"#),
    key("carrier", Value::Name, r#""forearm""#, "link that carries the rotor").default("the joint's parent"),
    key("axis", NUMBERS, "[0, 1, 0]", "the rotor's axis in the frame of `carrier`; required with `carrier`").default("the joint's axis"),
    key("torque", Value::Either(&[Value::Positive, Value::Table(&TORQUE)]), "{ nominal = 0.4, peak = 0.9 }", "largest torque at the motor's shaft; for limits at the joint use `limits` of the joint").unit("N m").also(&["effort", "limits"]),
    key("speed", Value::Positive, "300", "highest speed of the motor's shaft").unit("rad/s").default("unlimited"),
    key("stall_torque", Value::Positive, "1.2", "torque of the shaft at rest; needs `no_load_speed`").unit("N m"),
    key("no_load_speed", Value::Positive, "600", "speed of the shaft without torque; needs `stall_torque`").unit("rad/s"),
    key("motor_constant", Value::Formula, "0.06", "motor torque per ampere; the input is then the motor current").unit("N m/A").default("the input is the torque"),
    key("friction", Value::Either(&[Value::Law, Value::Table(&SHAFT_FRICTION)]), "{ viscous = 1e-4 }", "friction law of the motor's shaft, as a function of its angle and speed").default("none"),
];

#[rustfmt::skip]
static TORQUE: Keys = Keys {
    name: "torque",
    what: "a motor torque",
    groups: &[&[
        key("nominal", Value::Positive, "0.4", "continuous torque of the motor").unit("N m").also(&["rated", "continuous"]),
        key("peak", Value::Positive, "0.9", "short-time torque of the motor").unit("N m").also(&["max", "maximum"]),
    ]],
};
