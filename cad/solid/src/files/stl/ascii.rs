//! Reads ASCII STL: one solid or several, with or without names.

use std::io::{Cursor, Read};

use super::error::StlError;
use super::facets::Facets;

/// Returns whether a file that begins with `head` is an ASCII STL.
///
/// The facet count of a binary STL contains a zero byte, unless the file is larger than a gigabyte.
pub(super) fn is_ascii(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    !head.contains(&0)
        && head.strip_prefix(b"solid").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// The lines of a facet. Each capital is a number.
const FACET: [&str; 7] = [
    "facet normal X Y Z",
    "outer loop",
    "vertex X Y Z",
    "vertex X Y Z",
    "vertex X Y Z",
    "endloop",
    "endfacet",
];
/// Most characters of a line that an error quotes.
const MAX_QUOTED: usize = 60;

/// A solid that is being read.
struct Body {
    /// Its first line, from 1.
    first_line: usize,
    /// Its text, with a fixed name.
    text: String,
}

/// Reads every solid of an ASCII STL. Names may contain any bytes.
///
/// # Errors
/// The first line that is outside of a solid or that does not have the required form.
pub(super) fn read_ascii(source: &mut impl Read) -> Result<Facets, StlError> {
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut facets = Facets::default();
    let mut body: Option<Body> = None;
    let lines = text.trim_start_matches('\u{feff}').split_inclusive('\n');
    for (line, number) in lines.zip(1..) {
        let word = line.split_whitespace().next().unwrap_or_default();
        match (&mut body, word) {
            (None, "") => {}
            (None, "solid") => body = Some(Body { first_line: number, text: "solid x\n".to_owned() }),
            (None, _) => {
                let problem = format!("expected 'solid', found {}", quoted(line));
                return Err(StlError::Line { line: number, problem });
            }
            (Some(open), "endsolid") => {
                open.text.push_str("endsolid x\n");
                open.add_to(&mut facets)?;
                body = None;
            }
            (Some(open), _) => open.text.push_str(line),
        }
    }
    // A solid without its last line is an error that names the missing line.
    body.map_or(Ok(()), |unfinished| unfinished.add_to(&mut facets)).map(|()| facets)
}

impl Body {
    fn add_to(&self, facets: &mut Facets) -> Result<(), StlError> {
        for (facet, read) in stl_io::create_stl_reader(&mut Cursor::new(&self.text))?.zip(0..) {
            let facet = facet.map_err(|e| self.error_after(read, &e))?;
            facets.add(facet.normal.0, facet.vertices.map(|v| v.0));
        }
        Ok(())
    }

    /// The error of the facet that follows `read` valid ones. Every facet has the same number of
    /// lines, blank ones not counted, which gives its line.
    fn error_after(&self, read: usize, error: &std::io::Error) -> StlError {
        let lines = self.text.lines().zip(self.first_line..);
        let mut rest = lines.skip(1).filter(|(line, _)| !line.trim().is_empty()).skip(FACET.len() * read);
        for form in FACET {
            match rest.next() {
                Some((line, number)) if !has_form(line, form) => {
                    let problem = format!("expected '{form}', found {}", quoted(line));
                    return StlError::Line { line: number, problem };
                }
                Some(_) => {}
                None => {
                    let last = self.first_line + self.text.lines().count() - 1;
                    let missing = if form == FACET[0] { "endsolid" } else { form };
                    let problem = format!("expected '{missing}', found the end of the file");
                    return StlError::Line { line: last, problem };
                }
            }
        }
        StlError::Line {
            line: self.first_line,
            problem: error.to_string().chars().take(MAX_QUOTED).collect(),
        }
    }
}

/// Whether a line has the words of `form`, with a finite number for each capital.
fn has_form(line: &str, form: &str) -> bool {
    let is_number = |word: &str| word.parse::<f32>().is_ok_and(f32::is_finite);
    let (words, required) = (line.split_whitespace(), form.split(' '));
    words.clone().count() == required.clone().count()
        && words.zip(required).all(|(word, required)| match required {
            "X" | "Y" | "Z" => is_number(word),
            _ => word == required,
        })
}

/// The beginning of a line, in quotes.
fn quoted(line: &str) -> String {
    let short: String = line.trim().chars().take(MAX_QUOTED).collect();
    if short.len() < line.trim().len() { format!("{short:?}...") } else { format!("{short:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &str =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 5 0 0\nvertex 0 5 0\nendloop\nendfacet\n";

    fn triangles(text: &str) -> Result<usize, StlError> {
        let facets = read_ascii(&mut Cursor::new(text))?;
        Ok(facets.finish().map_or(0, |stl| stl.mesh.triangles.len()))
    }

    #[test]
    fn named_and_unnamed_solids_are_read() {
        for (text, expected) in [
            (format!("solid a\n{ONE}endsolid a\n"), 1),
            (format!("solid\n{ONE}{ONE}endsolid\n"), 2),
            (format!("\u{feff}solid\r\n{ONE}endsolid"), 1),
            (format!("solid a\n{ONE}endsolid a\n\nsolid b\n{ONE}endsolid b\n"), 2),
        ] {
            assert!(is_ascii(text.as_bytes()), "{text}");
            assert_eq!(triangles(&text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn missing_and_extra_lines_are_refused() {
        for text in [
            format!("solid a\n{ONE}"),
            format!("solid a\n{ONE}endsolid a\n{ONE}"),
            format!("solid a\n{ONE}endsolid a\nmore\n"),
            format!("solid a\n{ONE}endsolid a\nsolid b\n{}", &ONE[..60]),
        ] {
            assert!(triangles(&text).is_err(), "{text}");
        }
        assert!(!is_ascii(b"solidity = 3") && !is_ascii(b"solid x\0\0"));
    }

    #[test]
    fn an_error_names_its_line() {
        let second = format!("solid a\n{ONE}\n{ONE}endsolid a\n");
        for (text, expected) in [
            (
                second.replacen("vertex 5 0 0", "vertex 5 zero 0", 1),
                "line 5: expected 'vertex X Y Z', found \"vertex 5 zero 0\"",
            ),
            (
                format!("solid a\n{ONE}\n{}", ONE.replace("endloop", "endlop")),
                "line 15: expected 'endloop', found \"endlop\"",
            ),
            (
                format!("\n\nsolid a\n{ONE}endsolid\nsolid b\n{ONE}\n"),
                "line 20: expected 'endsolid', found the end of the file",
            ),
            (
                format!("solid a\n{}", ONE.replace("vertex 0 5 0\nendloop\nendfacet\n", "")),
                "line 5: expected 'vertex X Y Z', found the end of the file",
            ),
            (format!("solid a\n{ONE}endsolid a\nmore\n"), "line 10: expected 'solid', found \"more\""),
            (
                format!("solid a\n{}\n", "facet ".repeat(100)),
                "line 2: expected 'facet normal X Y Z', found \"facet facet",
            ),
            (
                format!("solid a\n{}endsolid\n", ONE.replace("5 0 0", "inf 0 0")),
                "line 5: expected 'vertex X Y Z', found \"vertex inf 0 0\"",
            ),
        ] {
            let message = triangles(&text).unwrap_err().to_string();
            assert!(message.starts_with(expected) && message.len() < 200, "{message}");
        }
    }
}
