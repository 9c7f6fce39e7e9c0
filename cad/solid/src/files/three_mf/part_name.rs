//! Names of parts, compared as the Open Packaging Conventions require.

/// Returns the form of a part name in which equivalent names are equal: without the leading slash,
/// in lower case (ASCII only), with percent-encoded characters decoded unless they are a slash.
///
/// A ZIP item of a name outside ASCII and its percent-encoded part name are therefore equal.
pub(super) fn normalized(name: &str) -> String {
    let bytes = name.trim_start_matches('/').as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let digits = bytes.get(i + 1..i + 3).and_then(|digits| std::str::from_utf8(digits).ok());
        let byte = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        match byte {
            Some(byte) if bytes[i] == b'%' && !matches!(byte, b'/' | b'\\' | b'%' | 0) => {
                decoded.push(byte);
                i += 3;
            }
            _ => {
                decoded.push(bytes[i]);
                i += 1;
            }
        }
    }
    String::from_utf8(decoded).unwrap_or_else(|_| name.to_owned()).to_ascii_lowercase()
}

/// Returns the part that the target of a relationship refers to; `source` is the part that the
/// relationship starts from, empty for the package.
pub(super) fn resolved(source: &str, target: &str) -> String {
    let target = target.split(['#', '?']).next().unwrap_or_default();
    let folder = source.rsplit_once('/').map_or("", |(folder, _)| folder);
    let path = if target.starts_with('/') { target.to_owned() } else { format!("{folder}/{target}") };
    let mut segments = Vec::new();
    for segment in path.split('/') {
        match segment {
            "" | "." => {}
            ".." => drop(segments.pop()),
            other => segments.push(other),
        }
    }
    segments.join("/")
}

/// Returns the part with the relationships of `source`.
pub(super) fn relationships_of(source: &str) -> String {
    let (folder, name) = source.rsplit_once('/').unwrap_or(("", source));
    format!("{folder}/_rels/{name}.rels").trim_start_matches('/').to_owned()
}

/// Returns the extension of a part name, in lower case.
pub(super) fn extension(name: &str) -> String {
    let file = name.rsplit('/').next().unwrap_or_default();
    file.rsplit_once('.').map_or_else(String::new, |(_, extension)| extension.to_ascii_lowercase())
}

/// Returns what is wrong with the name of a part, with the paragraph that it breaks.
pub(super) fn problem(name: &str) -> Option<(&'static str, &'static str)> {
    let name = name.strip_prefix('/').unwrap_or(name);
    let (folder, file) = name.rsplit_once('/').unwrap_or(("", name));
    let is_relationships = folder.rsplit('/').next().is_some_and(|last| last.eq_ignore_ascii_case("_rels"))
        && extension(file) == "rels";
    if name.split('/').any(str::is_empty) {
        Some(("has an empty segment", "OPC M1.3"))
    } else if name.split('/').any(|segment| segment.ends_with('.')) {
        Some(("has a segment that ends with a dot", "OPC M1.9"))
    } else if let Some(problem) = escape_problem(name) {
        Some(problem)
    } else if file.starts_with('.') && !is_relationships {
        Some(("begins with a dot", "3MF core 2.2.3"))
    } else {
        None
    }
}

/// Returns what is wrong with the percent-encoded characters of a name.
fn escape_problem(name: &str) -> Option<(&'static str, &'static str)> {
    name.split('%').skip(1).find_map(|rest| {
        let digits = rest.get(..2).filter(|digits| digits.bytes().all(|byte| byte.is_ascii_hexdigit()));
        match digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            None => Some(("has a percent sign without two hexadecimal digits", "OPC M1.6")),
            Some(b'/' | b'\\') => Some(("has a percent-encoded slash", "OPC M1.7")),
            Some(byte) if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) => {
                Some(("has a percent-encoded character that needs none", "OPC M1.8"))
            }
            Some(_) => None,
        }
    })
}

/// Returns parts whose names are those of another part with more segments.
pub(super) fn derived<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<String> = names.map(normalized).collect();
    // By segments, so that a name is next to the first one with more segments.
    names.sort_unstable_by(|a, b| a.split('/').cmp(b.split('/')));
    let is_derived =
        |pair: &&[String]| pair[1].strip_prefix(pair[0].as_str()).is_some_and(|rest| rest.starts_with('/'));
    names.windows(2).filter(is_derived).map(|pair| pair[1].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equivalent_names_are_equal() {
        for (a, b) in [
            ("/3D/3dmodel.model", "3d/3DModel.MODEL"),
            ("/3D/%E6%A8%A1.model", "3D/\u{6a21}.model"),
            ("/3D/%c3%a9.model", "3D/\u{e9}.model"),
            ("/3D/%41.model", "3D/a.model"),
        ] {
            assert_eq!(normalized(a), normalized(b));
        }
        assert_ne!(normalized("/a%2Fb"), normalized("/a/b"));
        assert_eq!(normalized("/a%"), "a%");
        assert_eq!(normalized("/a%FF"), "/a%ff");
    }

    #[test]
    fn invalid_names_are_named() {
        for (name, paragraph) in [
            ("3D//a.png", "OPC M1.3"),
            ("3D/a./b.png", "OPC M1.9"),
            ("3D/.png", "3MF core 2.2.3"),
            ("3D/.rels", "3MF core 2.2.3"),
            ("3D/a%2Fb.png", "OPC M1.7"),
            ("3D/%41.png", "OPC M1.8"),
            ("3D/100%.png", "OPC M1.6"),
        ] {
            assert_eq!(problem(name).map(|(_, paragraph)| paragraph), Some(paragraph), "{name}");
        }
        for name in [
            "/3D/3dmodel.model",
            "_rels/.rels",
            "3D/_rels/a.model.rels",
            "[Content_Types].xml",
            "3D/%E6%A8%A1.model",
        ] {
            assert_eq!(problem(name), None, "{name}");
        }
        assert_eq!(
            derived(["3D/A.model/b", "3D/a.model-x", "3D/a.model", "3D/b"].into_iter()),
            ["3d/a.model/b"]
        );
    }

    #[test]
    fn targets_are_relative_to_their_source() {
        assert_eq!(resolved("", "3D/a.model"), "3D/a.model");
        assert_eq!(resolved("3D/a.model", "/Metadata/t.png"), "Metadata/t.png");
        assert_eq!(resolved("3D/a.model", "b.png"), "3D/b.png");
        assert_eq!(resolved("3D/a.model", "../M/./b.png#x"), "M/b.png");
        assert_eq!(relationships_of(""), "_rels/.rels");
        assert_eq!(relationships_of("3D/a.model"), "3D/_rels/a.model.rels");
        assert_eq!(extension("3D/a.B/C.MODEL"), "model");
    }
}
