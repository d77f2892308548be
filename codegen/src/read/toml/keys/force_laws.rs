//! Keys of friction and springs.

use super::row::{Key, Keys, Value, key};

const WEIGHTED: Value = Value::List(&Value::Pair(&[Value::Number, Value::Formula]), None);

#[rustfmt::skip]
pub(super) static FRICTION: Keys = Keys {
    name: "friction",
    what: "a friction law",
    groups: &[
        LAWS,
        &[key("load", Value::Either(&[Value::Number, WEIGHTED]), r#""0.15*tanh(20*v)""#, "ratio of friction to the load of the gear: a formula in `v` and `y`, or pairs as in `terms`")],
    ],
};

/// Keys of the friction of a drive's shaft.
#[rustfmt::skip]
pub(super) static SHAFT_FRICTION: Keys =
    Keys { name: "shaft_friction", what: "a friction law of a shaft", groups: &[LAWS] };

#[rustfmt::skip]
static LAWS: &[Key] = &[
    key("viscous", Value::Formula, "0.4", "viscous friction d v").unit("N m s/rad or N s/m").also(&["damping"]),
    key("coulomb", Value::Either(&[Value::Formula, Value::Table(&COULOMB)]), "{ value = 0.2, slope = 50 }", "dry friction T sign(v), exactly 0 at rest; a table with `slope` makes it smooth").unit("N m or N").also(&["static", "dry", "kinetic"]),
    key("stribeck", Value::Table(&STRIBECK), "{ a1 = 0.4, a2 = 0.2, a3 = 50, a4 = 0.1, a5 = 20 }", "a1 v + a2 tanh(a3 v) + a4 exp(−a5 |v|) tanh(3 a3 v), with more friction at low speeds"),
    key("terms", WEIGHTED, r#"[["v", 0.4], ["tanh(5*v)", 3.9]]"#, "weighted sum of functions of `v` and `y`, as `gelenk identify` writes it"),
    key("law", Value::Number, r#""0.4*v + 0.2*tanh(20*v)""#, "formula in `v` and `y`; a linear formula is split into coefficient · basis"),
];

#[rustfmt::skip]
static COULOMB: Keys = Keys {
    name: "coulomb",
    what: "Coulomb friction",
    groups: &[&[
        key("value", Value::Formula, "0.2", "friction T in both directions").unit("N m or N"),
        key("positive", Value::Formula, "0.4", "friction for v > 0").unit("N m or N"),
        key("negative", Value::Formula, "-0.3", "friction for v < 0").unit("N m or N"),
        key("slope", Value::Positive, "50", "slope s of tanh(s v), which replaces sign(v)").unit("s/rad or s/m").default("the exact sign"),
    ]],
};

#[rustfmt::skip]
static STRIBECK: Keys = Keys {
    name: "stribeck",
    what: "a Stribeck law",
    groups: &[&[
        key("a1", Value::Formula, "0.4", "viscous friction").unit("N m s/rad or N s/m").needed(),
        key("a2", Value::Formula, "0.2", "Coulomb friction").unit("N m or N").needed(),
        key("a3", Value::Formula, "50", "slope a3 of the smooth sign tanh(a3 v)").unit("s/rad or s/m").needed(),
        key("a4", Value::Formula, "0.1", "excess of static friction over Coulomb friction").unit("N m or N").needed(),
        key("a5", Value::Formula, "20", "decay rate of a4 with speed, at least 0").unit("s/rad or s/m").needed(),
    ]],
};

#[rustfmt::skip]
pub(super) static SPRING: Keys = Keys {
    name: "spring",
    what: "a spring",
    groups: &[&[
        key("stiffness", Value::Formula, "100", "stiffness c in the force −c (y − rest) − d v").unit("N m/rad or N/m").default("0"),
        key("rest", Value::Formula, "0.2", "position without force").unit("rad or m").default("0"),
        key("damping", Value::Formula, "2", "damping d in the force −c (y − rest) − d v, not negative").unit("N m s/rad or N s/m").default("0"),
    ]],
};
