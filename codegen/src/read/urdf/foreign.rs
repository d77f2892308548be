//! Extensions of URDF by other tools that change the dynamics, with their equivalents in TOML.

/// An effect on the dynamics that other tools read from a URDF, but gelenk does not.
#[derive(Debug)]
struct Effect {
    /// Tags and attributes that have the effect, in small letters, without prefix and underscores.
    words: &'static [&'static str],
    /// Values of the tags and attributes for which they have no effect.
    idle: &'static [&'static str],
    text: &'static str,
}

const IDLE: &[&str] = &["0", "0.0", "false"];

const EFFECTS: [Effect; 10] = [
    Effect {
        words: &ROTORS,
        idle: IDLE,
        text: "rotor inertias, which add i² J to the diagonal of M, are not read from a URDF; write them in a \
               TOML file as `drive = { gear_ratio = i, rotor_inertia = J, coupling = \"diagonal\" }` of the \
               joint; skipped",
    },
    Effect {
        words: &["springstiffness", "springreference", "springref", "stiffness", "torsionalspring"],
        idle: IDLE,
        text: "springs at joints are not read from a URDF; write them in a TOML file as `spring = { stiffness \
               = 12, rest = 0.2 }` of the joint; skipped",
    },
    Effect {
        words: &["damping", "dampingfactor", "frictionloss", "viscousfriction", "coulombfriction"],
        idle: IDLE,
        text: "friction and damping in the notation of other tools are not read; write them in a TOML file as \
               `friction = { viscous = 0.5, coulomb = 2 }` of the joint; skipped",
    },
    Effect {
        words: &["linearbushingrpy", "bushing", "linearspringdamper", "forceelement"],
        idle: IDLE,
        text: "forces between links are not read from a URDF; write them in a TOML file as `[[forces]]` with \
               `between = [\"a\", \"b\"]` and `law = \"1200*(l - 0.3) + 40*dl\"`; skipped",
    },
    Effect {
        words: &["buoyancy", "hydrodynamics", "liftdrag", "aerodynamics", "winddrag"],
        idle: &["false"],
        text: "fluid forces are not read from a URDF; describe forces along a line with `[[forces]]` in a TOML \
               file; skipped",
    },
    Effect {
        words: &["loopjoint", "ballconstraint", "connect", "weld", "distanceconstraint"],
        idle: &[],
        text: "the constraints of closed loops are not read, so the robot moves without them; if the remaining \
               motion is linear, describe it in a TOML file with `follows = { … }` of a joint; skipped",
    },
    Effect {
        words: &["mimicjoint"],
        idle: &[],
        text: "joint couplings by plugins are not read; use `<mimic>` of the joint, or `follows = { leader = \
               -1 }` in a TOML file; skipped",
    },
    Effect {
        words: &["turngravityoff", "gravcomp"],
        idle: IDLE,
        text: "gravity acts on all links in gelenk, and `gravity = [0, 0, 0]` in a TOML file removes it from \
               all links; skipped",
    },
    Effect {
        words: &["gravity"],
        idle: &["1", "true", "0 0 -9.81"],
        text: "gravity other than (0, 0, -9.81) is not read from a URDF; write it in a TOML file as `gravity = \
               [0, 0, -1.6]`; skipped",
    },
    Effect {
        words: &[
            "inertiascaling",
            "settotalmass",
            "boundmass",
            "boundinertia",
            "balanceinertia",
            "inertiafromgeom",
        ],
        idle: &["0", "0.0", "1", "1.0", "-1", "false", "auto"],
        text: "changes of masses and inertias by other tools are not read; write `mass` and `inertia` of the \
               body in a TOML file; skipped",
    },
];

/// Names for the inertia of a rotor, or for its reflected inertia on the diagonal of the mass matrix.
pub(super) const ROTORS: [&str; 4] = ["rotorinertia", "motorinertia", "armature", "reflectedinertia"];

/// Elements in which stiffness and damping are properties of contacts.
pub(super) const CONTACTS: [&str; 3] = ["contact", "surface", "collision"];

/// A name without the prefix of its tool: `drake:rotor_inertia` becomes `rotorinertia`.
pub(super) fn plain(word: &str) -> String {
    let word = word.rsplit([':', '.']).next().unwrap_or(word);
    word.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect()
}

/// Note about the effect that a tag or attribute with this value has in other tools; `None` without an
/// effect.
pub(super) fn effect(word: &str, value: &str) -> Option<&'static str> {
    let word = plain(word);
    let found = EFFECTS.iter().find(|effect| effect.words.contains(&word.as_str()))?;
    (!found.idle.contains(&value.trim())).then_some(found.text)
}
