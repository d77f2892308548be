//! Keys that other formats have, or that another table of ours has, and what stands in their place.

/// Replacement of a foreign key, in a table whose keys are `known`.
pub(super) fn foreign(key: &str, known: &[&str]) -> Option<&'static str> {
    let has = |keys: &[&str]| keys.iter().all(|key| known.contains(key));
    let of_joint = || has(&["follows", "drive"]).then(|| in_joint(key)).flatten();
    let of_drive = || has(&["gear_ratio", "torque"]).then(|| in_drive(key, known.contains(&"on"))).flatten();
    let of_limits = || has(&["velocity", "effort"]).then(|| in_limits(key)).flatten();
    let of_force = || has(&["between", "law"]).then(|| in_force(key)).flatten();
    of_joint().or_else(of_drive).or_else(of_limits).or_else(of_force).or_else(|| match key {
        "link" | "links" if has(&["joints", "bodies"]) => {
            Some("joints name the links (`parent`, `child`), and `[[bodies]]` gives them mass")
        }
        "com" | "cog" if has(&["center_of_mass"]) => {
            Some("the centre of mass is `center_of_mass = [0, 0, 0.1]`, in metres in the frame of its link")
        }
        "xyz" | "rpy" if has(&["origin"]) => {
            Some("`origin = { xyz = [0, 0, 0.1], rpy = [0, 0, \"pi/2\"] }` tells where it is")
        }
        "static" | "dry" | "kinetic" if has(&["viscous", "coulomb"]) => {
            Some("dry friction is `coulomb = 0.2`; `stribeck` has more of it at low speeds than at high ones")
        }
        "max" | "maximum" | "rated" | "continuous" if has(&["nominal", "peak"]) => {
            Some("`nominal` is what the motor may give all the time, `peak` what it may give for a moment")
        }
        "parent" if has(&["link", "origin"]) => Some("`link = \"forearm\"` names the link that carries it"),
        _ => None,
    })
}

fn in_joint(key: &str) -> Option<&'static str> {
    match key {
        "mimic" => Some("a joint follows others with `follows = { shoulder = -0.5 }`"),
        "gear_ratio" | "rotor_inertia" | "motor_constant" | "torque" | "speed" | "stall_torque"
        | "no_load_speed" => Some("a motor's keys stand in `drive = { gear_ratio = 100, … }` of its joint"),
        "actuated" | "actuator" | "motor" => Some(
            "`drive = \"ideal\"` is a force or torque at the joint as an input, `drive = \"none\"` is no input",
        ),
        "mass" | "inertia" | "center_of_mass" => {
            Some("masses stand in `[[bodies]]`, which names the joint's link: `link = \"forearm\"`")
        }
        "position" | "velocity" | "effort" | "peak_effort" | "acceleration" | "jerk" => Some(
            "limits of a joint stand together: `limits = { position = [-1.5, 1.5], velocity = 2, effort = 40 }`",
        ),
        "damping" | "viscous" => Some("damping of a joint is friction: `friction = { viscous = 0.5 }`"),
        "stiffness" => Some("a spring at a joint is `spring = { stiffness = 100, rest = 0.2 }`"),
        _ => None,
    }
}

/// - `is_shared`: whether it stands apart from joints
fn in_drive(key: &str, is_shared: bool) -> Option<&'static str> {
    match key {
        "effort" | "limits" => Some(
            "`torque` and `speed` limit a motor, at its shaft; `limits = { velocity = 2, effort = 40 }` stands at the joint",
        ),
        "inertia" => Some("`rotor_inertia` is the inertia of the rotor about its axis, in kg m²"),
        "joints" | "acts_on" | "follows" | "weights" if is_shared => Some(
            "the joints that the drive moves stand in `on = { pitch = 1, roll = -1 }`, with their weights",
        ),
        "on" => Some(
            "a drive that acts on several joints stands by itself: `[[drives]]` with `on = { pitch = 1, roll = -1 }`",
        ),
        _ => None,
    }
}

fn in_limits(key: &str) -> Option<&'static str> {
    match key {
        "speed" => Some("the highest speed of a joint is `velocity`"),
        "force" | "torque" => Some("the largest force or torque of a joint is `effort`"),
        "lower" | "upper" | "min" | "max" => {
            Some("the lowest and the highest position stand in one list: `position = [-1.5, 1.5]`")
        }
        _ => None,
    }
}

fn in_force(key: &str) -> Option<&'static str> {
    match key {
        "type" => {
            Some("a force has no type: `law` makes it a spring or a damper, `input` a cylinder or a cable")
        }
        "stiffness" | "rest" | "damping" => Some(
            "`law = \"1200*(l - 0.3) + 40*dl\"` is a spring and damper over the distance l and its rate dl",
        ),
        _ => None,
    }
}
