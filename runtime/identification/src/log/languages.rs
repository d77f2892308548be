//! Words of other languages in headers: German with its compounds, French, Italian and Spanish.
//!
//! A header is translated word by word before anything is looked for in it, and so are the names of the description's
//! joints: `Achse 2 Winkel` is an angle of the joint `axis_2` too.

use super::vocabulary::is_quantity;

/// An English word, and the words that stand for it. Letters have no accents here: `é` is `e`, `ß` is `ss`.
#[rustfmt::skip]
const TRANSLATIONS: [(&str, &str); 36] = [
    ("time", "zeit tempo tiempo"),
    // English logs have temperatures as `temps`.
    ("elapsed", "temps"),
    ("timestamp", "zeitstempel horodatage"),
    ("seconds", "sekunde sekunden seconde secondes secondi segundos"),
    ("position", "lage posicion posiciones posizione posizioni stellung positionen"),
    ("angle", "winkel drehwinkel angolo angoli angulo angulos"),
    ("velocity", "geschwindigkeit geschwindigkeiten winkelgeschwindigkeit vitesse vitesses velocita velocidad velocidades"),
    // Of the motor as often as of the joint.
    ("omega", "drehzahl"),
    ("acceleration", "beschleunigung beschleunigungen winkelbeschleunigung accelerazione accelerazioni aceleracion aceleraciones"),
    ("torque", "drehmoment drehmomente couple couples coppia coppie par pares"),
    ("moment", "momente momento momenti momentos"),
    ("force", "kraft forza fuerza"),
    ("current", "strom strome stroeme courant courants intensite corrente correnti corriente corrientes intensidad"),
    ("run", "lauf messfahrt"),
    ("trial", "versuch essai prova ensayo"),
    ("joint", "gelenk gelenke articulaire articulaires articolare articulation articulations articolazione articolazioni articulacion articulaciones giunto giunti junta"),
    ("axis", "achse achs achsen axe asse ejes eje"),
    ("robot", "roboter"),
    ("state", "zustand etat stato estado"),
    ("value", "wert werte valeur valeurs valore valori valor valores"),
    ("motor", "moteur motore"),
    ("drive", "antrieb antriebs"),
    ("measured", "gemessen gemessene mess mesure mesuree mesures mesurees misurata misurato misurate misurati medida medido medidas"),
    ("actual", "ist istwert istwerte reelle reale effettiva effettivo"),
    ("filtered", "gefiltert gefilterte geglattet geglaettet filtre filtree filtrata filtrato filtrada filtrado"),
    ("setpoint", "soll sollwert sollwerte consigne consigna"),
    ("target", "ziel objetivo"),
    ("reference", "fuhrungsgrosse fuehrungsgroesse riferimento referencia"),
    ("command", "commande comando"),
    ("desired", "gewunscht gewuenscht desiree desire desiderata desiderato deseada deseado"),
    ("error", "fehler abweichung regelabweichung schleppfehler schleppabstand erreur errore"),
    ("limit", "grenze grenzen limite limites limiti"),
    ("friction", "reibung frottement attrito friccion"),
    ("temperature", "temperatur temperaturen temperatura"),
    ("voltage", "spannung tension tensione"),
    ("power", "leistung puissance potenza potencia"),
];

/// What German puts between the parts of a compound.
const LINKS: [&str; 4] = ["", "s", "n", "en"];

/// The same in German and English.
const MOTOR: &str = "motor";

/// The shortest part of a compound.
const SHORTEST: usize = 3;

/// The English words that a word stands for: itself where it is none of another language.
///
/// - `word`: in lower case
pub(super) fn in_english(word: String) -> Vec<String> {
    if word.len() < SHORTEST {
        return vec![word];
    }
    let plain: String = word.chars().flat_map(without_accent).collect();
    match (translated(&plain), compound(&plain)) {
        (Some(english), _) => vec![english.to_owned()],
        (None, Some(parts)) => parts.map(str::to_owned).into(),
        (None, None) if is_quantity(&plain) => vec![plain],
        (None, None) => vec![word],
    }
}

fn translated(word: &str) -> Option<&'static str> {
    let row = TRANSLATIONS.iter().find(|(_, words)| words.split(' ').any(|known| known == word));
    row.map(|(english, _)| *english)
}

/// The two parts of a German compound, `motorstrom` or `positionsistwert`.
fn compound(word: &str) -> Option<[&str; 2]> {
    let part = |text: &'_ str| translated(text).is_some() || is_quantity(text) || text == MOTOR;
    let mut cuts =
        (SHORTEST..word.len().saturating_sub(SHORTEST - 1)).filter(|at| word.is_char_boundary(*at));
    cuts.find_map(|at| {
        let (head, tail) = word.split_at(at);
        let head = LINKS.iter().filter_map(|link| head.strip_suffix(link)).find(|head| part(head))?;
        let is_german = head == MOTOR || translated(head).is_some() || translated(tail).is_some();
        let both = [translated(head).unwrap_or(head), translated(tail).unwrap_or(tail)];
        (part(tail) && is_german && head.len() >= SHORTEST).then_some(both)
    })
}

/// A letter of these languages as the table writes it.
fn without_accent(letter: char) -> impl Iterator<Item = char> {
    let plain = match letter {
        'à' | 'á' | 'â' | 'ä' => "a",
        'è' | 'é' | 'ê' | 'ë' => "e",
        'ì' | 'í' | 'î' | 'ï' => "i",
        'ò' | 'ó' | 'ô' | 'ö' => "o",
        'ù' | 'ú' | 'û' | 'ü' => "u",
        'ç' => "c",
        'ñ' => "n",
        'ß' => "ss",
        _ => "",
    };
    let own = plain.is_empty().then_some(letter);
    own.into_iter().chain(plain.chars())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_other_languages_are_translated() {
        let cases = [
            ("zeit", "time"),
            ("drehmoment", "torque"),
            ("motorstrom", "motor current"),
            ("gelenkwinkelgeschwindigkeit", "joint velocity"),
            ("positionsistwert", "positions actual"),
            ("momentensollwert", "moment setpoint"),
            ("istposition", "actual position"),
            ("lageregelabweichung", "position error"),
            ("positionsfehler", "positions error"),
            ("motortemperatur", "motor temperature"),
            ("accélération", "acceleration"),
            ("mesurée", "measured"),
            ("velocità", "velocity"),
            ("ángulo", "angle"),
            // English words and names stay as they are.
            ("position", "position"),
            ("jointtorque", "jointtorque"),
            ("wrist", "wrist"),
            ("list", "list"),
            ("größe", "größe"),
            ("東京", "東京"),
            ("t", "t"),
        ];
        for (word, english) in cases {
            assert_eq!(in_english(word.to_owned()).join(" "), english, "{word}");
        }
    }

    #[test]
    fn no_word_stands_for_two() {
        let words: Vec<&str> = TRANSLATIONS.iter().flat_map(|(_, words)| words.split(' ')).collect();
        for (i, word) in words.iter().enumerate() {
            assert!(word.is_ascii() && !words[..i].contains(word), "{word}");
        }
    }
}
