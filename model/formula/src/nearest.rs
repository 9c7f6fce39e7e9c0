//! The known name that is most similar to a misspelt one.

/// Returns the known name that is most similar to `name`, if one is: at most a third of the letters
/// differ, or two.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let distances = known.into_iter().map(|k| (strsim::damerau_levenshtein(k, name), k));
    let (distance, near) = distances.min()?;
    (distance <= (near.len().max(name.len()) / 3).max(2)).then_some(near)
}
