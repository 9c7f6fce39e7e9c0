//! Where in a TOML text something stands, for errors.

use std::ops::Range;

use pinswitch_diagnostic::excerpt;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

/// File and line of an error of TOML, and what is wrong in one line: `my.toml:3`, and its message, or, of a value of a wrong
/// type, its field and what must stand there: `noise.series_walk = "a" must be a number`.
pub fn toml_error(file: &str, text: &str, error: &Error) -> (String, String) {
    let problem = error.message().trim().replace('\n', ", ");
    let problem = wrong_type(text, error, &problem).unwrap_or(problem);
    (placed(file, text, error.span().map(|span| span.start)), problem)
}

/// What must stand in a field whose value is of a wrong type; `None` of any other error.
fn wrong_type(text: &str, error: &Error, problem: &str) -> Option<String> {
    let kinds = ["invalid type: ", "invalid length ", "invalid value: ", "unknown variant "];
    if !kinds.iter().any(|kind| problem.starts_with(kind)) {
        return None;
    }
    let span = error.span();
    let root = DeTable::parse(text).ok();
    let field = span.clone().zip(root.as_ref()).and_then(|(span, root)| field_in(root.get_ref(), &span, ""));
    let value = excerpt(span.and_then(|span| text.get(span)).unwrap_or_default().trim(), 60);
    let is_negative = value.starts_with('-');
    let wanted =
        problem.rsplit_once("expected ").and_then(|(_, wanted)| plain_words(wanted, problem, is_negative));
    match (field, wanted) {
        (Some(field), Some(wanted)) => {
            Some(format!("{field} = {} must be {wanted}", value.replace('\n', " ")))
        }
        (Some(field), None) => Some(format!("{field}: {problem}")),
        (None, Some(wanted)) => Some(format!("{problem}: it must be {wanted}")),
        (None, None) => None,
    }
}

/// What serde expects by the names of Rust, in words.
fn plain_words(wanted: &str, problem: &str, is_negative: bool) -> Option<String> {
    let is_unsigned = matches!(wanted, "u8" | "u16" | "u32" | "u64" | "usize");
    let is_whole = is_unsigned || matches!(wanted, "i8" | "i16" | "i32" | "i64" | "isize");
    if let Some(count) = wanted.strip_prefix("an array of length ") {
        let count = if count == "2" { "two" } else { count };
        return Some(format!("{count} values in brackets"));
    }
    let words = match wanted {
        "f32" | "f64" => "a number",
        _ if is_unsigned && is_negative => "a whole number, 0 or more",
        _ if is_whole && problem.starts_with("invalid value") => "a whole number nearer to 0",
        _ if is_whole => "a whole number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "a sequence" => "a list in brackets",
        "a map" => "a table",
        _ if wanted.starts_with("struct ") && !wanted.starts_with("struct variant") => "a table",
        _ => return None,
    };
    Some(words.to_owned())
}

/// The field of a table, or of what lies in it, whose value holds a part of the text: the innermost one.
fn field_in(table: &DeTable<'_>, part: &Range<usize>, above: &str) -> Option<String> {
    let dot = if above.is_empty() { "" } else { "." };
    table.iter().find_map(|(key, value)| value_in(value, part, &format!("{above}{dot}{}", key.get_ref())))
}

fn value_in(value: &Spanned<DeValue<'_>>, part: &Range<usize>, field: &str) -> Option<String> {
    let inner = match value.get_ref() {
        DeValue::Table(table) => field_in(table, part, field),
        DeValue::Array(array) => {
            let mut all = array.iter().enumerate();
            all.find_map(|(i, value)| value_in(value, part, &format!("{field}[{i}]")))
        }
        _ => None,
    };
    let span = value.span();
    inner.or_else(|| (span.start <= part.start && part.end <= span.end).then(|| field.to_owned()))
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
    #[test]
    fn a_wrong_type_names_its_field_and_what_must_stand_there() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        #[allow(dead_code)]
        struct Inner {
            walk: f64,
            name: String,
        }
        impl Default for Inner {
            fn default() -> Self {
                Self { walk: 0.0, name: String::new() }
            }
        }
        #[derive(Debug, Default, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        #[allow(dead_code)]
        struct File {
            loads_g: Vec<f64>,
            speeds_pct: [f64; 2],
            silicone: bool,
            layouts: Vec<Vec<usize>>,
            sweep: Option<crate::table::Sweep>,
            noise: Inner,
            series: Vec<Inner>,
            count: u32,
        }
        for (text, words) in [
            ("loads_g = [100, \"a\"]", "loads_g[1] = \"a\" must be a number"),
            ("loads_g = 100", "loads_g = 100 must be a list in brackets"),
            ("speeds_pct = [40]", "speeds_pct = [40] must be two values in brackets"),
            ("silicone = 1", "silicone = 1 must be true or false"),
            ("layouts = [[1.5, 3]]", "layouts[0][0] = 1.5 must be a whole number"),
            ("layouts = [[-1, 3]]", "layouts[0][0] = -1 must be a whole number, 0 or more"),
            ("count = 5000000000", "count = 5000000000 must be a whole number nearer to 0"),
            ("[noise]\nwalk = \"a\"", "noise.walk = \"a\" must be a number"),
            ("noise.name = 3", "noise.name = 3 must be a text in quotes"),
            ("noise = { walk = true }", "noise.walk = true must be a number"),
            ("noise = 3", "noise = 3 must be a table"),
            ("[[series]]\nwalk = 1\n[[series]]\nwalk = \"a\"", "series[1].walk = \"a\" must be a number"),
            ("sweep = \"sideways\"", "sweep: unknown variant `sideways`, expected `up` or `down`"),
            ("colour = 3", "unknown field `colour`"),
        ] {
            let error = toml::from_str::<File>(text).unwrap_err();
            let (place, problem) = toml_error("m.toml", text, &error);
            assert!(problem.starts_with(words), "{text}: {problem}");
            assert_eq!(place, format!("m.toml:{}", text.lines().count()), "{text}");
        }
    }
}
