//! Diagnostic of an unknown name, with the closest known one.

use pinswitch_diagnostic::{Diagnostic, excerpt};

/// Returns a diagnostic of an unknown name whose help suggests the closest known name, or lists
/// all.
pub(crate) fn unknown_name<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str>) -> Diagnostic {
    let known: Vec<&str> = known.collect();
    let nearest = known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(k, name), k))
        .min()
        .filter(|(distance, k)| *distance <= (k.len().max(name.len()) / 3).max(2));
    let help = match nearest {
        Some((_, nearest)) => format!("did you mean {nearest}?"),
        None => format!("use one of {}", known.join(", ")),
    };
    Diagnostic::new(format!("unknown {what} '{}'", excerpt(name, 40))).with_help(help)
}
