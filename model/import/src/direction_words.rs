//! Words for the two directions of the load, in five languages.

use pinswitch_friction::Direction;

use crate::vocabulary::words;

/// Words for a load that is pulled, then for a load that is released.
const DIRECTIONS: [(Direction, &[&str]); 2] = [
    (
        Direction::Concentric,
        &[
            "concentric",
            "con",
            "konzentrisch",
            "concentrique",
            "concentrico",
            "pull",
            "pulled",
            "pulling",
            "up",
            "upward",
            "upwards",
            "lift",
            "lifted",
            "lifting",
            "raise",
            "raised",
            "raising",
            "tighten",
            "tightening",
            "forward",
            "forwards",
            "fwd",
            "in",
            "load",
            "loading",
            "hoist",
            "heben",
            "hebe",
            "gehoben",
            "anheben",
            "ziehen",
            "gezogen",
            "auf",
            "hoch",
            "rauf",
            "hinauf",
            "aufwarts",
            "hochziehen",
            "vor",
            "spannen",
            "montee",
            "monter",
            "lever",
            "levage",
            "tirer",
            "subir",
            "subida",
            "levantar",
            "tirar",
            "salita",
            "sollevare",
            "sollevamento",
            "tirare",
            "wind",
            "winding",
            "plus",
            "pos",
            "positive",
            "+",
            "1",
            "+1",
        ],
    ),
    (
        Direction::Eccentric,
        &[
            "eccentric",
            "ecc",
            "exzentrisch",
            "excentrique",
            "eccentrico",
            "excentrico",
            "release",
            "released",
            "releasing",
            "down",
            "downward",
            "downwards",
            "lower",
            "lowered",
            "lowering",
            "loosen",
            "loosening",
            "back",
            "backward",
            "backwards",
            "bwd",
            "reverse",
            "return",
            "out",
            "unload",
            "unloading",
            "senken",
            "senke",
            "gesenkt",
            "absenken",
            "ablassen",
            "lassen",
            "nachlassen",
            "ab",
            "runter",
            "hinunter",
            "abwarts",
            "herunter",
            "zuruck",
            "ruck",
            "losen",
            "descente",
            "descendre",
            "baisser",
            "relacher",
            "relachement",
            "relache",
            "bajar",
            "bajada",
            "soltar",
            "discesa",
            "abbassare",
            "rilasciare",
            "unwind",
            "unwinding",
            "minus",
            "neg",
            "negative",
            "-",
            "-1",
        ],
    ),
];

/// Returns the direction that a cell means; `None` for a word without a known meaning.
pub(crate) fn direction(cell: &str) -> Option<Direction> {
    let cell = cell.trim().replace('\u{2212}', "-");
    let number = cell.parse::<f64>().ok();
    let is_word = |names: &[&str], word: &str| names.contains(&word);
    for (direction, names) in DIRECTIONS {
        let sign = if direction == Direction::Concentric { 1.0 } else { -1.0 };
        if number == Some(sign) || is_word(names, cell.as_str()) {
            return Some(direction);
        }
    }
    let words = words(&cell);
    let of_word = |word: &String| {
        DIRECTIONS.iter().find(|(_, names)| is_word(names, word.as_str())).map(|(direction, _)| *direction)
    };
    let mut all: Vec<_> = words.iter().filter(|w| w.parse::<f64>().is_err()).filter_map(of_word).collect();
    all.dedup_by_key(|d| d.as_str());
    // "pull back" has two meanings.
    if let [one] = all.as_slice() { Some(*one) } else { None }
}

/// Returns the direction in the words of a column name, such as `F_heben`.
pub(crate) fn direction_in_name(words: &[String]) -> Option<Direction> {
    // Words that mean other things in names: "in" an inch or an input, "load" the load, "pos" a
    // position.
    const OTHER: [&str; 6] = ["in", "out", "load", "pos", "1", "vor"];
    let words: Vec<&str> = words.iter().map(String::as_str).filter(|word| !OTHER.contains(word)).collect();
    let mut all: Vec<_> = words.iter().filter_map(|word| direction(word)).collect();
    if all.is_empty() {
        // Fup and Fdown.
        all = words.iter().filter_map(|word| direction(word.strip_prefix('f')?)).collect();
    }
    if all.is_empty() {
        // German compounds, such as Hebekraft and Senkkraft.
        let starts = [
            ("heb", Direction::Concentric),
            ("zieh", Direction::Concentric),
            ("senk", Direction::Eccentric),
            ("ablass", Direction::Eccentric),
        ];
        all = words.iter().filter_map(|w| starts.iter().find(|s| w.starts_with(s.0)).map(|s| s.1)).collect();
    }
    all.dedup_by_key(|d| d.as_str());
    if let [one] = all.as_slice() { Some(*one) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn direction_words_are_known() {
        for word in
            ["pull", "Up", "LIFT", "+", "1", "1.0", "heben", "tighten", "forward", "concentric", "Salita"]
        {
            assert_eq!(direction(word).map(Direction::as_str), Some("concentric"), "{word}");
        }
        for word in
            ["release", "down", "lower", "-", "\u{2212}1", "senken", "loosen", "back", "Zurück", "eccentric"]
        {
            assert_eq!(direction(word).map(Direction::as_str), Some("eccentric"), "{word}");
        }
        for word in ["", "A", "2", "pull back", "sideways"] {
            assert_eq!(direction(word), None, "{word}");
        }
    }
}
