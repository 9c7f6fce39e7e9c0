//! Diagnostics for TOML text: the location of a field, and type errors in plain words.

use std::ops::Range;

use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt};
use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

/// Most characters of a value in a location.
const LONGEST_VALUE: usize = 60;

/// Converts an error of the TOML reader, with its line and column in `text`.
///
/// A value of the wrong type is reported with its field and the expected type in plain words:
/// `plan.toml:3:15: noise.series_walk = "a": expected a number`.
pub fn toml_error(file: &str, text: &str, error: &Error) -> Diagnostic {
    let message = error.message().trim().replace('\n', ", ");
    let span = error.span();
    let location =
        span.clone().map_or_else(|| Location::file(file), |span| Location::in_text(file, text, span));
    let kinds = ["invalid type: ", "invalid length ", "invalid value: ", "unknown variant "];
    if !kinds.iter().any(|kind| message.starts_with(kind)) {
        return Diagnostic::new(codes::of_toml(&message), message).with_location(location);
    }
    let value = span.clone().and_then(|span| text.get(span)).unwrap_or_default();
    let value = excerpt(value.trim(), LONGEST_VALUE).replace('\n', " ");
    let expected = message
        .rsplit_once("expected ")
        .and_then(|(_, expected)| expected_type(expected, &message, value.starts_with('-')));
    let root = DeTable::parse(text).ok();
    let field = span.zip(root.as_ref()).and_then(|(span, root)| field_in(root.get_ref(), &span, ""));
    let code = codes::of_toml(&message);
    let problem = expected.map_or(message, |expected| format!("expected {expected}"));
    let location = match field {
        Some(field) => location.with_field(field, value),
        None => location,
    };
    Diagnostic::new(code, problem).with_location(location)
}

/// Translates the type that serde expects from Rust's names; `None` where serde's own words are
/// plain.
fn expected_type(expected: &str, message: &str, is_negative: bool) -> Option<String> {
    let is_unsigned = matches!(expected, "u8" | "u16" | "u32" | "u64" | "usize");
    let is_whole = is_unsigned || matches!(expected, "i8" | "i16" | "i32" | "i64" | "isize");
    if let Some(count) = expected.strip_prefix("an array of length ") {
        let count = if count == "2" { "two" } else { count };
        return Some(format!("{count} values in brackets"));
    }
    let words = match expected {
        "f32" | "f64" => "a number",
        _ if is_unsigned && is_negative => "a whole number of at least 0",
        _ if is_whole && message.starts_with("invalid value") => "a whole number closer to 0",
        _ if is_whole => "a whole number",
        "a boolean" => "true or false",
        "a string" => "a string in quotes",
        "a sequence" => "a list in brackets",
        "a map" => "a table",
        _ if expected.starts_with("struct ") && !expected.starts_with("struct variant") => "a table",
        _ => return None,
    };
    Some(words.to_owned())
}

/// Finds the innermost field of a table whose value contains a part of the text.
fn field_in(table: &DeTable<'_>, part: &Range<usize>, parent: &str) -> Option<String> {
    let dot = if parent.is_empty() { "" } else { "." };
    table.iter().find_map(|(key, value)| field_at(value, part, &format!("{parent}{dot}{}", key.get_ref())))
}

/// Finds the innermost field inside `value`, which is the value of `field`.
fn field_at(value: &Spanned<DeValue<'_>>, part: &Range<usize>, field: &str) -> Option<String> {
    let inner = match value.get_ref() {
        DeValue::Table(table) => field_in(table, part, field),
        DeValue::Array(array) => {
            let mut all = array.iter().enumerate();
            all.find_map(|(i, value)| field_at(value, part, &format!("{field}[{i}]")))
        }
        _ => None,
    };
    let span = value.span();
    inner.or_else(|| (span.start <= part.start && part.end <= span.end).then(|| field.to_owned()))
}

/// Returns the location of a field such as `frame.conditions[0].pins` in a TOML text, without its
/// name and value.
///
/// A field that is absent has the location of its innermost parent that is present. Anything after
/// a space in `field` is ignored.
pub fn field_location(file: &str, text: &str, field: &str) -> Location {
    field_span(text, field).map_or_else(|| Location::file(file), |span| Location::in_text(file, text, span))
}

/// Returns the diagnostic of a field's value with file, line and column of that field in a TOML
/// text.
pub fn locate_field(diagnostic: Diagnostic, file: &str, text: &str) -> Diagnostic {
    let Some(Location { field: Some(field), value, .. }) = diagnostic.location().cloned() else {
        return diagnostic.or_in_file(file);
    };
    let location = Location { value, ..field_location(file, text, &field) };
    diagnostic.with_location(Location { field: Some(field), ..location })
}

fn field_span(text: &str, field: &str) -> Option<Range<usize>> {
    let root = DeTable::parse(text).ok()?;
    let field = field.split(' ').next().unwrap_or_default();
    let keys = field.split(['.', '[']).map(|key| key.trim_end_matches(']'));
    let (mut value, mut span) = (None::<&DeValue<'_>>, None);
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
        span = Some(next.span());
    }
    span
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_located_at_any_depth() {
        let text = "a = 1\n[[b]]\nc = [1,\n 2]\n[[b]]\nd.e = 3\n[f]\ng = 4\n";
        // The last two are absent: their innermost parents are located.
        for (field, line) in
            [("a", 1), ("b[0].c[1]", 4), ("b[1].d.e (kappa)", 6), ("f.g", 8), ("f.h", 7), ("b[7].c", 2)]
        {
            assert_eq!(field_location("m.toml", text, field).line, Some(line), "{field}");
        }
        assert_eq!(field_location("m.toml", text, "z"), Location::file("m.toml"));
    }

    #[test]
    fn syntax_errors_show_a_caret() {
        let text = "a = 1\nb = = 2\n";
        let error = toml::from_str::<toml::Table>(text).unwrap_err();
        let shown = toml_error("m.toml", text, &error).render("error");
        assert!(shown.starts_with("error: m.toml:2:5: "), "{shown}");
        assert!(shown.ends_with("\n  2 | b = = 2\n    |     ^"), "{shown}");
    }

    #[test]
    fn type_errors_name_field_and_type() {
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
        for (text, field, value, problem) in [
            ("loads_g = [100, \"a\"]", "loads_g[1]", "\"a\"", "expected a number"),
            ("loads_g = 100", "loads_g", "100", "expected a list in brackets"),
            ("speeds_pct = [40]", "speeds_pct", "[40]", "expected two values in brackets"),
            ("silicone = 1", "silicone", "1", "expected true or false"),
            ("layouts = [[1.5, 3]]", "layouts[0][0]", "1.5", "expected a whole number"),
            ("layouts = [[-1, 3]]", "layouts[0][0]", "-1", "expected a whole number of at least 0"),
            ("count = 5000000000", "count", "5000000000", "expected a whole number closer to 0"),
            ("[noise]\nwalk = \"a\"", "noise.walk", "\"a\"", "expected a number"),
            ("noise.name = 3", "noise.name", "3", "expected a string in quotes"),
            ("noise = { walk = true }", "noise.walk", "true", "expected a number"),
            ("noise = 3", "noise", "3", "expected a table"),
            (
                "[[series]]\nwalk = 1\n[[series]]\nwalk = \"a\"",
                "series[1].walk",
                "\"a\"",
                "expected a number",
            ),
            (
                "sweep = \"sideways\"",
                "sweep",
                "\"sideways\"",
                "unknown variant `sideways`, expected `up` or `down`",
            ),
        ] {
            let error = toml::from_str::<File>(text).unwrap_err();
            let diagnostic = toml_error("m.toml", text, &error);
            assert_eq!(diagnostic.problem(), problem, "{text}");
            let location = diagnostic.location().unwrap();
            assert_eq!(location.line, Some(text.lines().count()), "{text}");
            let named = (location.field.as_deref(), location.value.as_deref());
            assert_eq!(named, (Some(field), Some(value)), "{text}");
        }
        let error = toml::from_str::<File>("colour = 3").unwrap_err();
        let diagnostic = toml_error("m.toml", "colour = 3", &error);
        assert!(diagnostic.problem().starts_with("unknown field `colour`"), "{diagnostic}");
        assert_eq!(diagnostic.location().unwrap().line, Some(1));
    }
}
