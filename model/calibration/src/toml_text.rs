//! Where in a TOML text something stands, for errors.

use toml::de::{DeTable, DeValue, Error};

/// File and line of an error of TOML, and what is wrong: `my.toml:3` and its message in one line.
pub fn toml_error(file: &str, text: &str, error: &Error) -> (String, String) {
    let problem = error.message().trim().replace('\n', ", ");
    (placed(file, text, error.span().map(|span| span.start)), problem)
}

/// The file with the line of a field such as `frame.conditions[0].pins`, or of the last on the way there that is in the
/// text. What follows a space is no part of the field.
pub(crate) fn place_of(file: &str, text: &str, field: &str) -> String {
    placed(file, text, offset_of(text, field))
}

fn placed(file: &str, text: &str, offset: Option<usize>) -> String {
    let line = |offset| 1 + text.bytes().take(offset).filter(|b| *b == b'\n').count();
    offset.map_or(file.to_owned(), |offset| format!("{file}:{}", line(offset)))
}

fn offset_of(text: &str, field: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let field = field.split(' ').next().unwrap_or_default();
    let keys = field.split(['.', '[']).map(|key| key.trim_end_matches(']'));
    let (mut value, mut at) = (None::<&DeValue<'_>>, None);
    for key in keys {
        let table = match value {
            None => Some(root.get_ref()),
            Some(value) => value.as_table(),
        };
        let next = match (table, value.and_then(DeValue::as_array)) {
            (Some(table), _) => table.get(key),
            (None, Some(array)) => key.parse().ok().and_then(|index: usize| array.get(index)),
            (None, None) => None,
        };
        let Some(next) = next else { break };
        value = Some(next.get_ref());
        at = Some(next.span().start);
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_found_at_any_depth_or_the_last_above_it() {
        let text = "a = 1\n[[b]]\nc = [1,\n 2]\n[[b]]\nd.e = 3\n[f]\ng = 4\n";
        for (field, line) in
            [("a", 1), ("b[0].c[1]", 4), ("b[1].d.e (kappa)", 6), ("f.g", 8), ("f.h", 7), ("b[7].c", 2)]
        {
            assert_eq!(place_of("m.toml", text, field), format!("m.toml:{line}"), "{field}");
        }
        assert_eq!(place_of("m.toml", text, "z"), "m.toml");
        let error = toml::from_str::<toml::Table>("a = 1\nb = = 2\n").unwrap_err();
        let (place, problem) = toml_error("m.toml", "a = 1\nb = = 2\n", &error);
        assert_eq!(place, "m.toml:2");
        assert!(!problem.is_empty() && !problem.contains('\n'), "{problem}");
    }
}
