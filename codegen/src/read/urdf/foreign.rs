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
        text: "skipped: rotor inertias are not read from a URDF. Write them in a TOML file as `drive = { gear_ratio = i, \
               rotor_inertia = J, coupling = \"diagonal\" }` of the joint",
    },
    Effect {
        words: &["springstiffness", "springreference", "springref", "stiffness", "torsionalspring"],
        idle: IDLE,
        text: "skipped: springs at joints are not read from a URDF. Write them in a TOML file as `spring = { stiffness = 12, rest \
               = 0.2 }` of the joint",
    },
    Effect {
        words: &["damping", "dampingfactor", "frictionloss", "viscousfriction", "coulombfriction"],
        idle: IDLE,
        text: "skipped: friction and damping in the notation of other tools are not read. Write them in a TOML file as `friction \
               = { viscous = 0.5, coulomb = 2 }` of the joint",
    },
    Effect {
        words: &["linearbushingrpy", "bushing", "linearspringdamper", "forceelement"],
        idle: IDLE,
        text: "skipped: forces between links are not read from a URDF. Write them in a TOML file as `[[forces]]` with `between = \
               [\"a\", \"b\"]` and `law = \"1200*(l - 0.3) + 40*dl\"`",
    },
    Effect {
        words: &["buoyancy", "hydrodynamics", "liftdrag", "aerodynamics", "winddrag"],
        idle: &["false"],
        text: "skipped: fluid forces are not read from a URDF. Describe forces along a line with `[[forces]]` in a TOML file",
    },
    Effect {
        words: &["loopjoint", "ballconstraint", "connect", "weld", "distanceconstraint"],
        idle: &[],
        text: "skipped: the constraints of closed loops are not read, so the robot moves without them. Describe a linear \
               dependence of joints in a TOML file with `follows = { … }`",
    },
    Effect {
        words: &["mimicjoint"],
        idle: &[],
        text: "skipped: joint couplings by plugins are not read. Use `<mimic>` of the joint, or `follows = { leader = -1 }` in a \
               TOML file",
    },
    Effect {
        words: &["turngravityoff", "gravcomp"],
        idle: IDLE,
        text: "skipped: in gelenk, gravity acts on all links. `gravity = [0, 0, 0]` in a TOML file removes it from all links",
    },
    Effect {
        words: &["gravity"],
        idle: &["1", "true", "0 0 -9.81"],
        text: "skipped: gravity other than 0, 0, -9.81 m/s² is not read from a URDF. Write it in a TOML file as `gravity = [0, 0, -1.6]`",
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
        text: "skipped: changes of masses and inertias by other tools are not read. Write `mass` and `inertia` of the body in a TOML file",
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
