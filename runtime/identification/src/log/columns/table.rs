//! Tables of the quantities of columns (names, units, components, words) and of other words in headers.
//!
//! To add a quantity, add a row to [`QUANTITIES`]. This row also defines the name of its [`Kind`]. A row contains English
//! words and words of other languages, which are translated to the first English word. Words are spelled without accents:
//! `é` is `e`, `ß` is `ss`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use Role::{Angle, Body, Motor, Other, Plain};

/// A quantity that columns of a log can contain, for example position.
pub(super) struct Quantity {
    kind: Kind,
    /// Names of the quantity in `--columns`.
    pub keys: &'static [&'static str],
    /// Singular and plural in messages.
    pub names: [&'static str; 2],
    /// SI units for rotary joints and for linear joints. The first unit is used if no unit is named.
    pub units: [&'static [&'static str]; 2],
    /// Letters of the quantity's components, for example x, y and z. Each component has a column.
    pub components: &'static [&'static str],
    /// Words of the quantity: doubt (0 for the usual words), English words, words of other languages. Single letters count
    /// only if no longer word in the header names a quantity.
    words: &'static [(u8, &'static str, &'static str)],
}

const SECONDS: [&[&str]; 2] = [&["s"]; 2];
const NO_UNIT: [&[&str]; 2] = [&["1"]; 2];

/// Defines the rows of quantities, and the names of their kinds.
macro_rules! quantities {
    ($($(#[$documentation:meta])* $kind:ident { $($row:tt)* },)*) => {
        /// The quantity of a column.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub(in crate::log) enum Kind {
            $($(#[$documentation])* $kind,)*
        }

        /// The quantities in the order of [`Kind`].
        static QUANTITIES: &[Quantity] = &[$(Quantity { kind: Kind::$kind, $($row)* },)*];
    };
}

quantities! {
    Time { keys: &["time"], names: ["time", "time"], units: SECONDS, components: &[], words: &[
        (0, "time times timestamp timestamps stamp t", "zeit tempo tiempo zeitstempel horodatage"),
        (0, "seconds sec secs nsec nsecs nanosec nanosecs nanosecond nanoseconds", "sekunde sekunden seconde secondes secondi segundos"),
        // English logs use `temps` for temperatures.
        (1, "elapsed clock", "temps"),
    ] },
    /// Names of the joints, as text in the rows.
    Name { keys: &[], names: ["name", "name"], units: NO_UNIT, components: &[], words: &[(0, "name names", "")] },
    Position { keys: &["position"], names: ["position", "positions"], units: [&["rad"], &["m"]], components: &[], words: &[
        (0, "position positions pos jpos qpos q", "lage posicion posiciones posizione posizioni stellung positionen"),
        (1, "angle angles ang phi theta y", "winkel drehwinkel angolo angoli angulo angulos"),
        (2, "encoder", ""),
    ] },
    Velocity { keys: &["velocity"], names: ["velocity", "velocities"], units: [&["rad/s"], &["m/s"]], components: &[], words: &[
        (0, "velocity velocities vel jvel speed speeds dq qd qdot qvel v", "geschwindigkeit geschwindigkeiten winkelgeschwindigkeit vitesse vitesses velocita velocidad velocidades"),
        // The word `drehzahl` is used for motors as often as for joints.
        (1, "omega qp dtheta thetadot dphi w", "drehzahl"),
    ] },
    Acceleration { keys: &[], names: ["acceleration", "acceleration"], units: [&["rad/s^2"], &["m/s^2"]], components: &[], words: &[
        (0, "acceleration accelerations acc accel ddq qdd qddot qdotdot a", "beschleunigung beschleunigungen winkelbeschleunigung accelerazione accelerazioni aceleracion aceleraciones"),
        (1, "thetadotdot", ""),
    ] },
    /// A force at the joint.
    Torque { keys: &["torque", "effort"], names: ["effort", "efforts"], units: [&["N*m"], &["N"]], components: &[], words: &[
        (0, "torque torques qfrc jtrq jtor effort efforts eff trq tau tauj", "drehmoment drehmomente couple couples coppia coppie par pares"),
        (1, "moment", "momente momento momenti momentos"),
        (1, "force forces", "kraft forza fuerza"),
    ] },
    // The motor of a spindle has a torque, the joint that the spindle moves has a force.
    /// Torque of a motor, on the motor side of the gear.
    Input { keys: &["input"], names: ["motor effort", "efforts"], units: [&["N*m", "N"], &["N", "N*m"]], components: &[], words: &[(0, "input inputs u", "")] },
    Current { keys: &["current"], names: ["current", "currents"], units: [&["A"]; 2], components: &[], words: &[
        (0, "current currents cur curr amp amps amperage iq imot i", "strom strome stroeme courant courants intensite corrente correnti corriente corrientes intensidad"),
    ] },
    Run { keys: &["run", "trial"], names: ["run", "run"], units: NO_UNIT, components: &[], words: &[
        (0, "run", "lauf messfahrt"),
        (0, "trial segment", "versuch essai prova ensayo"),
        (1, "episode", ""),
    ] },
    Place { keys: &["place"], names: ["place", "places"], units: [&["m"]; 2], components: &["x", "y", "z"], words: &[
        (0, "place pose translation transform trans", ""),
    ] },
    // The order of the letters in the key is the order of the columns.
    Attitude { keys: &["xyzw", "wxyz"], names: ["quaternion", "quaternions"], units: NO_UNIT, components: &["x", "y", "z", "w"], words: &[
        (0, "quat quaternion orientation rotation attitude rot ori", ""),
    ] },
}

/// Origin of the values of a column. Columns are preferred in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Origin {
    Measured,
    Unsaid,
    Filtered,
    Commanded,
}

/// The role of a word in a header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Quantity(Kind),
    Origin(Origin),
    /// A word for motors: torques with this word are torques of motors.
    Motor,
    /// A word that names no quantity.
    Plain,
    /// The name of a body with a pose.
    Body,
    /// A word for an orientation that is not a quaternion.
    Angle,
    /// A word for a quantity that joints do not have.
    Other,
}

const MEASURED: Role = Role::Origin(Origin::Measured);
const FILTERED: Role = Role::Origin(Origin::Filtered);
const COMMANDED: Role = Role::Origin(Origin::Commanded);

#[rustfmt::skip]
static WORDS: [(Role, &str, &str); 27] = [
    (MEASURED, "measured meas msr fb feedback sensor present", "gemessen gemessene mess mesure mesuree mesures mesurees misurata misurato misurate misurati medida medido medidas"),
    (MEASURED, "actual act real", "ist istwert istwerte reelle reale effettiva effettivo"),
    (FILTERED, "filtered filt smoothed smooth est estimate estimated interpolated", "gefiltert gefilterte geglattet geglaettet filtre filtree filtrata filtrato filtrada filtrado"),
    (COMMANDED, "setpoint set goal", "soll sollwert sollwerte consigne consigna"),
    (COMMANDED, "target", "ziel objetivo"),
    (COMMANDED, "reference ref nominal planned plan ipo control d", "fuhrungsgrosse fuehrungsgroesse riferimento referencia"),
    (COMMANDED, "command commanded commands cmd", "commande comando"),
    (COMMANDED, "desired des", "gewunscht gewuenscht desiree desire desiderata desiderato deseada deseado"),
    (Motor, "motor", "moteur motore"),
    (Motor, "drive", "antrieb antriebs"),
    (Plain, "joint joints jnt", "gelenk gelenke articulaire articulaires articolare articulation articulations articolazione articolazioni articulacion articulaciones giunto giunti junta"),
    (Plain, "axis axes", "achse achs achsen axe asse ejes eje"),
    (Plain, "robot", "roboter"),
    (Plain, "state states", "zustand etat stato estado"),
    (Plain, "value values", "wert werte valeur valeurs valore valori valor valores"),
    (Plain, "arm manipulator link field msg data header output id index no j", ""),
    (Body, "base root trunk body torso odom frame world floating mocap vicon local", ""),
    (Angle, "roll pitch yaw rpy euler heading", ""),
    (Other, "error err residual", "fehler abweichung regelabweichung schleppfehler schleppabstand erreur errore"),
    (Other, "limit limits min max", "grenze grenzen limite limites limiti"),
    (Other, "friction", "reibung frottement attrito friccion"),
    (Other, "temperature temp", "temperatur temperaturen temperatura"),
    (Other, "voltage", "spannung tension tensione"),
    (Other, "power", "leistung puissance potenza potencia"),
    (Other, "mean std ext external contact gravity coriolis model dtau pwm mode status window gain stiffness damping rate frequency robust", ""),
    (Other, "tcp cartesian tool ee eef flange", ""),
    (Other, "wrench ft imu accelerometer twist gyro mag covariance", ""),
];

/// Role and translation of a word.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub role: Role,
    /// Uncertainty of the word: 0 for the usual words of a quantity, larger for less certain words.
    pub doubt: u8,
    /// English translation of a word of another language; `None` for English words.
    pub english: Option<&'static str>,
}

/// Row of a table of words: role, doubt, English words, and words of other languages.
type Row = (Role, u8, &'static str, &'static str);

fn rows() -> impl Iterator<Item = Row> {
    let of = |quantity: &'static Quantity| {
        let role = Role::Quantity(quantity.kind);
        quantity.words.iter().map(move |(doubt, english, others)| (role, *doubt, *english, *others))
    };
    QUANTITIES
        .iter()
        .flat_map(of)
        .chain(WORDS.iter().map(|(role, english, others)| (*role, 0, *english, *others)))
}

/// Known words of headers, each with its role and translation.
static INDEX: LazyLock<BTreeMap<&str, Known>> = LazyLock::new(|| {
    let of = |(role, doubt, english, others): Row| {
        let first = english.split(' ').next();
        let english = english.split(' ').map(move |word| (word, Known { role, doubt, english: None }));
        english.chain(others.split(' ').map(move |word| (word, Known { role, doubt, english: first })))
    };
    rows().flat_map(of).filter(|(word, _)| !word.is_empty()).collect()
});

/// Returns role and translation of a word in lower case; `None` for unknown words.
pub(super) fn known(word: &str) -> Option<Known> {
    INDEX.get(word).copied()
}

impl Kind {
    /// Returns the quantity with this name in `--columns`, and the name; `None` for unknown names.
    pub(super) fn of_key(name: &str) -> Option<(Self, &'static str)> {
        let key =
            |quantity: &Quantity| Some((quantity.kind, *quantity.keys.iter().find(|key| **key == name)?));
        QUANTITIES.iter().find_map(key)
    }

    /// Returns all names of quantities in `--columns`.
    pub(super) fn keys() -> impl Iterator<Item = &'static str> {
        QUANTITIES.iter().flat_map(|quantity| quantity.keys).copied()
    }

    /// Returns the row of the quantity in the table.
    pub(super) fn row(self) -> &'static Quantity {
        &QUANTITIES[self as usize]
    }

    /// Returns the first name of the quantity in `--columns`.
    pub(super) fn key(self) -> &'static str {
        self.row().keys.first().copied().unwrap_or(self.singular())
    }

    pub(super) fn singular(self) -> &'static str {
        self.row().names[0]
    }

    pub(super) fn plural(self) -> &'static str {
        self.row().names[1]
    }

    pub(super) fn is_effort(self) -> bool {
        matches!(self, Self::Torque | Self::Input | Self::Current)
    }

    /// Returns the quantity that has this SI unit; `None` if no quantity has the unit.
    pub(super) fn of_unit(si: &str) -> Option<Self> {
        let measured = QUANTITIES.iter().filter(|quantity| quantity.units != NO_UNIT);
        measured
            .filter(|quantity| quantity.units.iter().any(|units| units.contains(&si)))
            .map(|q| q.kind)
            .next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_word_stands_for_two() {
        let words: Vec<&str> = rows().flat_map(|(_, _, a, b)| a.split(' ').chain(b.split(' '))).collect();
        let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
        for (i, word) in words.iter().enumerate() {
            assert!(word.is_ascii() && !words[..i].contains(word), "{word}");
        }
    }

    #[test]
    fn units_name_the_first_quantity_that_has_them() {
        use Kind::*;
        let units = ["rad", "m/s", "rad/s^2", "N", "A", "s"].map(Kind::of_unit);
        assert_eq!(units, [Position, Velocity, Acceleration, Torque, Current, Time].map(Some));
        assert_eq!(Kind::of_unit("1"), None);
    }
}
