//! Keys that other formats have, or that another table of ours has, and what stands in their place.

/// What to write in place of a key, in a table whose keys are `known`.
pub(super) fn foreign(key: &str, known: &[&str]) -> Option<&'static str> {
    let has = |keys: &[&str]| keys.iter().all(|key| known.contains(key));
    match key {
        "link" | "links" if has(&["joints", "bodies"]) => {
            Some("joints name the links (`parent`, `child`), and `[[bodies]]` gives them mass")
        }
        "mimic" if has(&["follows"]) => Some("a joint follows others with `follows = { shoulder = -0.5 }`"),
        "gear_ratio" | "rotor_inertia" | "motor_constant" | "torque" | "speed" | "stall_torque"
        | "no_load_speed"
            if has(&["drive"]) =>
        {
            Some("a motor's keys stand in `drive = { gear_ratio = 100, … }` of its joint")
        }
        "actuated" | "actuator" | "motor" if has(&["drive"]) => Some(
            "`drive = \"ideal\"` is a force or torque at the joint as an input, `drive = \"none\"` is no input",
        ),
        "speed" if has(&["velocity", "effort"]) => Some("the highest speed of a joint is `velocity`"),
        "force" | "torque" if has(&["velocity", "effort"]) => {
            Some("the largest force or torque of a joint is `effort`")
        }
        "lower" | "upper" | "min" | "max" if has(&["position", "effort"]) => {
            Some("the lowest and the highest position stand in one list: `position = [-1.5, 1.5]`")
        }
        "com" | "cog" if has(&["center_of_mass"]) => {
            Some("the centre of mass is `center_of_mass = [0, 0, 0.1]`, in metres in the frame of its link")
        }
        "xyz" | "rpy" if has(&["origin"]) => {
            Some("`origin = { xyz = [0, 0, 0.1], rpy = [0, 0, \"pi/2\"] }` tells where it is")
        }
        "parent" if has(&["link", "origin"]) => Some("`link = \"forearm\"` names the link that carries it"),
        "type" if has(&["between", "law"]) => {
            Some("a force has no type: `law` makes it a spring or a damper, `input` a cylinder or a cable")
        }
        "stiffness" | "rest" | "damping" if has(&["between", "law"]) => Some(
            "`law = \"1200*(l - 0.3) + 40*dl\"` is a spring and damper over the distance l and its rate dl",
        ),
        "on" if has(&["gear_ratio"]) => Some(
            "a drive that acts on several joints stands by itself: `[[drives]]` with `on = { pitch = 1, roll = -1 }`",
        ),
        _ => None,
    }
}
