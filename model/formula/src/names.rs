//! Names that the language itself uses.

use crate::token::KEYWORDS;
use crate::tree::{FUNCTIONS, PAIRS};

/// Returns whether a name cannot be a variable: a keyword, or a function.
///
/// `round`, `floor` and `ceil` can be variables, too: files of effects may use these names since
/// before the functions existed, and a bracket tells a function from a variable.
pub fn is_reserved(name: &str) -> bool {
    let is_keyword = KEYWORDS.iter().any(|(keyword, _)| *keyword == name);
    let is_function = is_function(name) && !["round", "floor", "ceil"].contains(&name);
    is_keyword || is_function
}

/// Returns whether a name followed by a bracket is a call.
pub(crate) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|(known, _)| *known == name) || PAIRS.iter().any(|(known, _)| *known == name)
}
