//! Words of column names, in five languages.

use crate::quantity::Quantity;

/// Splits a name into lower-case words without accents. Words end at signs, at `camelCase` and
/// between letters and digits.
pub(crate) fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut previous = ' ';
    for c in name.chars().take(200) {
        let is_boundary = (previous.is_lowercase() && c.is_uppercase())
            || (previous.is_alphabetic() && c.is_ascii_digit())
            || (previous.is_ascii_digit() && c.is_alphabetic());
        if !c.is_alphanumeric() || is_boundary {
            words.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            for lower in c.to_lowercase() {
                word.push_str(&without_accent(lower));
            }
        }
        previous = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

fn without_accent(c: char) -> String {
    let plain = match c {
        'à' | 'á' | 'â' | 'ã' | 'ä' | 'å' => "a",
        'è' | 'é' | 'ê' | 'ë' => "e",
        'ì' | 'í' | 'î' | 'ï' => "i",
        'ò' | 'ó' | 'ô' | 'õ' | 'ö' => "o",
        'ù' | 'ú' | 'û' | 'ü' => "u",
        'ñ' => "n",
        'ç' => "c",
        'ß' => "ss",
        'α' => "alpha",
        'θ' | 'ϑ' => "theta",
        'φ' | 'ϕ' => "phi",
        _ => return c.to_string(),
    };
    plain.to_owned()
}

/// Words of each quantity. The first quantity with a word of a name is that of the name.
const NAMES: [(Quantity, &[&str]); 20] = [
    (
        Quantity::WrapAngle,
        &[
            "angle",
            "winkel",
            "umschlingung",
            "bend",
            "bends",
            "bending",
            "biegung",
            "biegungen",
            "wrap",
            "angolo",
            "angulo",
            "theta",
            "phi",
            "alpha",
            "avvolgimento",
            "enroulement",
        ],
    ),
    (Quantity::LoadMass, &["mass", "masse", "masa", "massa"]),
    (
        Quantity::Force,
        &[
            "force",
            "forces",
            "kraft",
            "krafte",
            "fuerza",
            "forza",
            "effort",
            "f",
            "fx",
            "fy",
            "fz",
            "loadcell",
            "cell",
            "messkraft",
            "tension",
            "kraftmessdose",
            "zugkraft",
        ],
    ),
    (
        Quantity::Load,
        &[
            "load",
            "last",
            "belastung",
            "charge",
            "carga",
            "carico",
            "weight",
            "gewicht",
            "poids",
            "peso",
            "deadweight",
            "loads",
            "stack",
            "plates",
        ],
    ),
    (
        Quantity::Direction,
        &[
            "direction",
            "dir",
            "richtung",
            "sens",
            "direccion",
            "direzione",
            "verso",
            "sentido",
            "bewegung",
            "branch",
            "stroke direction",
        ],
    ),
    (
        Quantity::Dwell,
        &[
            "dwell",
            "pause",
            "haltezeit",
            "wartezeit",
            "ruhezeit",
            "attente",
            "espera",
            "attesa",
            "reposo",
            "rest",
        ],
    ),
    (
        Quantity::Speed,
        &["speed", "geschwindigkeit", "velocity", "vitesse", "velocidad", "velocita", "v", "rpm", "drehzahl"],
    ),
    (Quantity::Date, &["date", "datum", "fecha", "data"]),
    (
        Quantity::Time,
        &[
            "time",
            "zeit",
            "t",
            "temps",
            "tiempo",
            "tempo",
            "timestamp",
            "zeitstempel",
            "elapsed",
            "uhrzeit",
            "hora",
            "heure",
            "ora",
            "clock",
            "millis",
            "micros",
            "sekunden",
            "seconds",
            "runtime",
        ],
    ),
    (
        Quantity::Position,
        &[
            "position",
            "pos",
            "weg",
            "displacement",
            "extension",
            "crosshead",
            "stroke",
            "hub",
            "travel",
            "deplacement",
            "course",
            "desplazamiento",
            "posicion",
            "posizione",
            "spostamento",
            "corsa",
            "x",
            "traverse",
            "traversenweg",
            "encoder",
            "verfahrweg",
            "recorrido",
        ],
    ),
    (Quantity::Power, &["power", "leistung", "puissance", "potencia", "potenza", "p", "wattage"]),
    (
        Quantity::Repetition,
        &[
            "repetition",
            "rep",
            "reps",
            "wiederholung",
            "wdh",
            "repeticion",
            "ripetizione",
            "trial",
            "cycle",
            "zyklus",
            "cycles",
            "ciclo",
            "repeat",
        ],
    ),
    (
        Quantity::Series,
        &[
            "series",
            "serie",
            "reihe",
            "messreihe",
            "test",
            "versuch",
            "run",
            "lauf",
            "essai",
            "ensayo",
            "prova",
            "experiment",
        ],
    ),
    (Quantity::Substrate, &["substrate", "substrat", "sustrato", "substrato"]),
    (Quantity::Pins, &["pins", "pin", "stifte"]),
    (Quantity::Sweep, &["sweep"]),
    (Quantity::Session, &["session", "day", "tag", "sitzung", "jour", "dia", "giorno"]),
    (Quantity::Mount, &["mount", "montage", "montaje", "montaggio", "einbau"]),
    (Quantity::Operator, &["operator", "bediener", "prufer", "operateur", "operador", "operatore"]),
    (
        Quantity::Specimen,
        &["specimen", "sample", "probe", "prufling", "provino", "probeta", "eprouvette", "part"],
    ),
];

/// Ends of German compounds, such as `Hebekraft`.
const COMPOUNDS: [(&str, Quantity); 10] = [
    ("kraft", Quantity::Force),
    ("winkel", Quantity::WrapAngle),
    ("position", Quantity::Position),
    ("weg", Quantity::Position),
    ("geschwindigkeit", Quantity::Speed),
    ("richtung", Quantity::Direction),
    ("masse", Quantity::LoadMass),
    ("gewicht", Quantity::Load),
    ("last", Quantity::Load),
    ("zeit", Quantity::Time),
];

/// Returns whether a name is that of friction: the pull minus the load in the one laboratory, the pull itself in another.
pub(crate) fn is_friction(words: &[String]) -> bool {
    const FRICTION: [&str; 5] = ["friction", "frottement", "attrito", "friccion", "rozamiento"];
    let is_word = |word: &String| FRICTION.contains(&word.as_str()) || word.starts_with("reib");
    words.iter().any(is_word)
}

/// Returns the quantities that the words of a name may mean, most specific first.
pub(crate) fn quantities(words: &[String]) -> Vec<Quantity> {
    // A torque, or how fast or how well something is measured.
    const OTHER: [&str; 9] =
        ["torque", "moment", "drehmoment", "couple", "coppia", "rate", "error", "uncertainty", "std"];
    if words.iter().any(|word| OTHER.contains(&word.as_str()) || SPREAD.contains(&word.as_str())) {
        return Vec::new();
    }
    let joined = words.join(" ");
    // A load cell reads force; "x value" is the time axis of LVM.
    if joined.contains("load cell") {
        return vec![Quantity::Force];
    }
    if joined.starts_with("x value") {
        return vec![Quantity::Time];
    }
    let mut possible: Vec<Quantity> = NAMES
        .iter()
        .filter(|(_, names)| words.iter().any(|word| names.contains(&word.as_str())))
        .map(|(quantity, _)| *quantity)
        .collect();
    if possible.is_empty() {
        let compound = |word: &String| COMPOUNDS.iter().find(|(end, _)| word.ends_with(end)).map(|c| c.1);
        possible.extend(words.iter().filter_map(compound));
    }
    // The angle of something else than the tendon's wrap, also in compounds such as Neigungswinkel.
    const TURNING: [&str; 11] = [
        "tilt", "joint", "motor", "crank", "shaft", "encoder", "phase", "rotor", "servo", "neigung", "gelenk",
    ];
    if words.iter().any(|word| TURNING.iter().any(|turning| word.starts_with(turning))) {
        possible.retain(|q| *q != Quantity::WrapAngle);
    }
    let has = |possible: &[Quantity], quantity| possible.contains(&quantity);
    // "load mass", "test time", "direction of force": the noun decides, and it is first in the list
    // above.
    if has(&possible, Quantity::Direction) && has(&possible, Quantity::Position) {
        possible.retain(|q| *q != Quantity::Position);
    }
    // "load force" is ambiguous: the declared load, or the reading.
    if has(&possible, Quantity::Force) && has(&possible, Quantity::Load) {
        possible.sort_by_key(|q| *q != Quantity::Load);
    }
    possible
}

/// Words for the spread of readings, wherever they are in a name.
const SPREAD: [&str; 12] = [
    "stdev",
    "stddev",
    "stdabw",
    "stabw",
    "standardabweichung",
    "standardfehler",
    "variance",
    "varianz",
    "rsd",
    "desviacion",
    "deviazione",
    "scarto",
];
/// Words that also have other meanings: they are for the spread at the end of a name that has a column of readings.
const MAYBE_SPREAD: [&str; 13] = [
    "sd",
    "st",
    "std",
    "se",
    "sem",
    "cv",
    "error",
    "uncertainty",
    "unsicherheit",
    "deviation",
    "abweichung",
    "ecart",
    "spread",
];
/// Words for what is computed from several readings.
const AVERAGE: [&str; 12] = [
    "mean",
    "average",
    "avg",
    "mittelwert",
    "mittel",
    "mw",
    "median",
    "moyenne",
    "media",
    "promedio",
    "medio",
    "moy",
];
/// Further words of a row of a summary.
const SUMMARY: [&str; 11] =
    ["maximum", "max", "minimum", "min", "standard", "sum", "summe", "total", "range", "of", "dev"];

/// Words of a name without its unit.
fn stem_words(name: &str) -> Vec<String> {
    words(name.split(['[', '(', '{']).next().unwrap_or_default())
}

/// Whether a name is that of a measure of spread; `others` are the names of all columns.
pub(crate) fn is_spread(name: &str, others: &[String]) -> bool {
    let stem = stem_words(name);
    if stem.iter().any(|word| SPREAD.contains(&word.as_str())) {
        return true;
    }
    let Some((last, rest)) = stem.split_last() else { return false };
    let is_reading = |other: &String| {
        let is_counted = |word: &String| AVERAGE.contains(&word.as_str()) || word.parse::<u32>().is_ok();
        let all = stem_words(other);
        let left: Vec<&String> = all.iter().filter(|word| !is_counted(word)).collect();
        other != name && (all == rest || left == rest.iter().collect::<Vec<_>>())
    };
    MAYBE_SPREAD.contains(&last.as_str()) && !rest.is_empty() && others.iter().any(is_reading)
}

/// Whether a name has nothing but words for figures that are computed from readings, such as `SD (N)`, `Max` or `n`.
pub(crate) fn is_statistic(name: &str) -> bool {
    let stem = name.split(['[', '(', '{']).next().unwrap_or_default();
    matches!(stem.trim(), "n" | "N") || is_summary(stem, false)
}

/// Whether a name is that of a mean of readings.
pub(crate) fn is_average(name: &str) -> bool {
    stem_words(name).iter().any(|word| AVERAGE.contains(&word.as_str()))
}

/// Whether a label is that of a row with figures computed from the rows above: it has nothing but words for that, and
/// counts. Two letters may be initials, unless the label can be no name (`is_name`).
pub(crate) fn is_summary(label: &str, is_name: bool) -> bool {
    let words = words(label);
    let lists = [&SPREAD[..], &MAYBE_SPREAD, &AVERAGE, &SUMMARY];
    let is_known =
        |word: &str| lists.iter().any(|list| list.contains(&word)) && !(is_name && word.len() == 2);
    let is_count = |word: &str| word == "n" || word.parse::<u32>().is_ok();
    words.iter().any(|word| is_known(word)) && words.iter().all(|word| is_known(word) || is_count(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_split_into_words() {
        let split = |name| words(name).join(" ");
        assert_eq!(split("F_heben [N]"), "f heben n");
        assert_eq!(split("loadCell2"), "load cell 2");
        assert_eq!(split("Rückweg/mm"), "ruckweg mm");
        assert_eq!(split("Umschlingungswinkel (°)"), "umschlingungswinkel");
    }

    #[test]
    fn names_of_five_languages_have_a_quantity() {
        for (name, quantity) in [
            ("Kraft", Quantity::Force),
            ("Fuerza", Quantity::Force),
            ("Forza", Quantity::Force),
            ("Effort", Quantity::Force),
            ("Messzeit", Quantity::Time),
            ("Temps", Quantity::Time),
            ("Tiempo", Quantity::Time),
            ("Tempo", Quantity::Time),
            ("Weg", Quantity::Position),
            ("Déplacement", Quantity::Position),
            ("Posición", Quantity::Position),
            ("Corsa", Quantity::Position),
            ("Last", Quantity::Load),
            ("Charge", Quantity::Load),
            ("Carico", Quantity::Load),
            ("Gewicht", Quantity::Load),
            ("Richtung", Quantity::Direction),
            ("Sens", Quantity::Direction),
            ("Dirección", Quantity::Direction),
            ("Umschlingungswinkel", Quantity::WrapAngle),
            ("Angolo di avvolgimento", Quantity::WrapAngle),
            ("θ", Quantity::WrapAngle),
            ("load cell", Quantity::Force),
            ("Load mass", Quantity::LoadMass),
            ("Vitesse", Quantity::Speed),
        ] {
            assert_eq!(quantities(&words(name)).first(), Some(&quantity), "{name}");
        }
        for name in ["Humidity", "Load torque", "Sample rate"] {
            assert!(quantities(&words(name)).is_empty(), "{name}");
        }
    }
}
