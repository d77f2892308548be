//! Words by which other tools change the dynamics in a URDF, and their equivalents in TOML.

/// An effect on the dynamics that is not read.
#[derive(Debug)]
struct Effect {
    /// Tags and attributes without prefix, in small letters and without underscores.
    words: &'static [&'static str],
    /// Values without effect; 0 and `false` have none in the other rows.
    idle: &'static [&'static str],
    text: &'static str,
}

const IDLE: &[&str] = &["0", "0.0", "false"];

const EFFECTS: [Effect; 10] = [
    Effect {
        words: &ROTORS,
        idle: IDLE,
        text: "inertias of rotors were skipped, which add i² J to the diagonal of M; in a TOML file \
            `drive = { gear_ratio = i, rotor_inertia = J, coupling = \"diagonal\" }` of the joint is equivalent",
    },
    Effect {
        words: &["springstiffness", "springreference", "springref", "stiffness", "torsionalspring"],
        idle: IDLE,
        text: "springs at joints were skipped; in a TOML file `spring = { stiffness = 12, rest = 0.2 }` of the joint is equivalent",
    },
    Effect {
        words: &["damping", "dampingfactor", "frictionloss", "viscousfriction", "coulombfriction"],
        idle: IDLE,
        text: "friction and damping of other tools were skipped; in a TOML file `friction = { viscous = 0.5, coulomb = 2 }` of the joint is equivalent",
    },
    Effect {
        words: &["linearbushingrpy", "bushing", "linearspringdamper", "forceelement"],
        idle: IDLE,
        text: "forces between links were skipped; in a TOML file `[[forces]]` with `between = [\"a\", \"b\"]` and \
            `law = \"1200*(l - 0.3) + 40*dl\"` is equivalent",
    },
    Effect {
        words: &["buoyancy", "hydrodynamics", "liftdrag", "aerodynamics", "winddrag"],
        idle: &["false"],
        text: "forces of a medium were skipped; in a TOML file `[[forces]]` describes those that act along a line",
    },
    Effect {
        words: &["loopjoint", "ballconstraint", "connect", "weld", "distanceconstraint"],
        idle: &[],
        text: "closed loops were opened: the robot moves without them; in a TOML file `follows = { … }` of a joint describes the remaining motion of a loop, if that is linear",
    },
    Effect {
        words: &["mimicjoint"],
        idle: &[],
        text: "couplings of joints by plugins were skipped; use `<mimic>` of the joint, or in a TOML file \
            `follows = { leader = -1 }`",
    },
    Effect {
        words: &["turngravityoff", "gravcomp"],
        idle: IDLE,
        text: "links without gravity have it here; in a TOML file `gravity = [0, 0, 0]` takes it from all of them",
    },
    Effect {
        words: &["gravity"],
        idle: &["1", "true", "0 0 -9.81"],
        text: "another gravity was skipped; in a TOML file `gravity = [0, 0, -1.6]` is equivalent",
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
        text: "changes of masses and inertias by other tools were skipped; in a TOML file `mass` and `inertia` of a body are equivalent",
    },
];

/// Words of an inertia of a rotor, or of its reflected inertia on the diagonal of M.
pub(super) const ROTORS: [&str; 4] = ["rotorinertia", "motorinertia", "armature", "reflectedinertia"];

/// Inside of these, stiffness and damping are those of contacts.
pub(super) const CONTACTS: [&str; 3] = ["contact", "surface", "collision"];

/// The text about an effect, by its row.
pub(super) fn text(row: usize) -> &'static str {
    EFFECTS.get(row).map_or("", |effect| effect.text)
}

/// A word of any tool: `drake:rotor_inertia` is `rotorinertia`.
pub(super) fn plain(word: &str) -> String {
    let word = word.rsplit([':', '.']).next().unwrap_or(word);
    word.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect()
}

/// The effect of a word with this value.
pub(super) fn row(word: &str, value: &str) -> Option<usize> {
    let word = plain(word);
    let found = EFFECTS.iter().position(|effect| effect.words.contains(&word.as_str()))?;
    (!EFFECTS[found].idle.contains(&value.trim())).then_some(found)
}
