//! ASCII STL: one solid or several, with names or without.

use std::io::{Cursor, Error, ErrorKind, Read};

use super::stl_facets::Facets;

/// Whether a file that begins with `head` is an ASCII STL: no binary one has a count of facets without a zero, unless it
/// is of a gigabyte.
pub(super) fn is_ascii(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    !head.contains(&0)
        && head.strip_prefix(b"solid").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Reads every solid of an ASCII STL. A name may hold any bytes.
///
/// # Errors
/// The first line that belongs to no solid, or is not what stands there in an STL.
pub(super) fn read_ascii(source: &mut impl Read) -> std::io::Result<Facets> {
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut facets = Facets::default();
    // The first line of a solid, which may bear a name, and what follows it.
    let mut body: Option<String> = None;
    for line in text.trim_start_matches('\u{feff}').split_inclusive('\n') {
        let word = line.split_whitespace().next().unwrap_or_default();
        match (&mut body, word) {
            (None, "") => {}
            (None, "solid") => body = Some("solid x\n".to_owned()),
            (None, other) => {
                let shown: String = other.chars().take(40).collect();
                return Err(Error::new(
                    ErrorKind::InvalidData,
                    format!("{shown:?} stands where a solid must begin"),
                ));
            }
            (Some(all), "endsolid") => {
                all.push_str("endsolid x\n");
                add(all, &mut facets)?;
                body = None;
            }
            (Some(all), _) => all.push_str(line),
        }
    }
    match body {
        // The reader says what is missing.
        Some(unfinished) => add(&unfinished, &mut facets).map(|()| facets),
        None => Ok(facets),
    }
}

fn add(solid: &str, facets: &mut Facets) -> std::io::Result<()> {
    for facet in stl_io::create_stl_reader(&mut Cursor::new(solid))? {
        let facet = facet?;
        facets.add(facet.normal.0, facet.vertices.map(|v| v.0));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 5 0 0\nvertex 0 5 0\nendloop\nendfacet\n";

    fn triangles(text: &str) -> Result<usize, String> {
        let facets = read_ascii(&mut Cursor::new(text)).map_err(|e| e.to_string())?;
        Ok(facets.finish().map_or(0, |stl| stl.mesh.triangles.len()))
    }

    #[test]
    fn every_solid_counts_with_a_name_or_without() {
        for (text, expected) in [
            (format!("solid a\n{FACET}endsolid a\n"), 1),
            (format!("solid\n{FACET}{FACET}endsolid\n"), 2),
            (format!("\u{feff}solid\r\n{FACET}endsolid"), 1),
            (format!("solid a\n{FACET}endsolid a\n\nsolid b\n{FACET}endsolid b\n"), 2),
        ] {
            assert!(is_ascii(text.as_bytes()), "{text}");
            assert_eq!(triangles(&text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_missing_or_too_much_is_an_error() {
        for text in [
            format!("solid a\n{FACET}"),
            format!("solid a\n{FACET}endsolid a\n{FACET}"),
            format!("solid a\n{FACET}endsolid a\nmore\n"),
            format!("solid a\n{FACET}endsolid a\nsolid b\n{}", &FACET[..60]),
        ] {
            assert!(triangles(&text).is_err(), "{text}");
        }
        assert!(!is_ascii(b"solidity = 3") && !is_ascii(b"solid x\0\0"));
    }
}
