//! ASCII STL: one solid or several, with names or without.

use std::io::{Cursor, Read};

use super::stl::StlError;
use super::stl_facets::Facets;

/// Whether a file that begins with `head` is an ASCII STL: no binary one has a count of facets without a zero, unless it
/// is of a gigabyte.
pub(super) fn is_ascii(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    !head.contains(&0)
        && head.strip_prefix(b"solid").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// The lines of a facet, as a reader of ASCII STL wants them.
const FACET: [&str; 7] = [
    "facet normal X Y Z",
    "outer loop",
    "vertex X Y Z",
    "vertex X Y Z",
    "vertex X Y Z",
    "endloop",
    "endfacet",
];
/// Most characters of a line that a message repeats.
const SHOWN: usize = 60;

/// A solid on its way: the number of its first line, from 1, and its text, the name left out.
struct Body {
    first_line: usize,
    text: String,
}

/// Reads every solid of an ASCII STL. A name may hold any bytes.
///
/// # Errors
/// The first line that belongs to no solid, or is not what stands there in an STL.
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
                let problem = format!("{} stands where a solid must begin", shown(line));
                return Err(StlError::Line { line: number, problem });
            }
            (Some(begun), "endsolid") => {
                begun.text.push_str("endsolid x\n");
                begun.add_to(&mut facets)?;
                body = None;
            }
            (Some(begun), _) => begun.text.push_str(line),
        }
    }
    // What is not ended says what is missing.
    body.map_or(Ok(()), |unfinished| unfinished.add_to(&mut facets)).map(|()| facets)
}

impl Body {
    fn add_to(&self, facets: &mut Facets) -> Result<(), StlError> {
        for (facet, read) in stl_io::create_stl_reader(&mut Cursor::new(&self.text))?.zip(0..) {
            let facet = facet.map_err(|e| self.broken(read, &e))?;
            facets.add(facet.normal.0, facet.vertices.map(|v| v.0));
        }
        Ok(())
    }

    /// The error of the facet after `read` ones: every facet takes as many lines, blank ones left out, so that its line
    /// can be counted.
    fn broken(&self, read: usize, error: &std::io::Error) -> StlError {
        let lines = self.text.lines().zip(self.first_line..);
        let mut own = lines.skip(1).filter(|(line, _)| !line.trim().is_empty()).skip(FACET.len() * read);
        for form in FACET {
            match own.next() {
                Some((line, number)) if !fits(line, form) => {
                    let problem = format!("{} stands where '{form}' must stand", shown(line));
                    return StlError::Line { line: number, problem };
                }
                Some(_) => {}
                None => {
                    let last = self.first_line + self.text.lines().count() - 1;
                    let wanted = if form == FACET[0] { "'endsolid'" } else { form };
                    return StlError::Line { line: last, problem: format!("the file ends before {wanted}") };
                }
            }
        }
        StlError::Line { line: self.first_line, problem: error.to_string().chars().take(SHOWN).collect() }
    }
}

/// Whether a line has the words of `form`, with a finite number for each capital.
fn fits(line: &str, form: &str) -> bool {
    let is_number = |word: &str| word.parse::<f32>().is_ok_and(f32::is_finite);
    let (words, wanted) = (line.split_whitespace(), form.split(' '));
    words.clone().count() == wanted.clone().count()
        && words.zip(wanted).all(|(word, wanted)| match wanted {
            "X" | "Y" | "Z" => is_number(word),
            _ => word == wanted,
        })
}

/// The beginning of a line, in quotes.
fn shown(line: &str) -> String {
    let short: String = line.trim().chars().take(SHOWN).collect();
    if short.len() < line.trim().len() { format!("{short:?}...") } else { format!("{short:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &str =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 5 0 0\nvertex 0 5 0\nendloop\nendfacet\n";

    fn triangles(text: &str) -> Result<usize, String> {
        let facets = read_ascii(&mut Cursor::new(text)).map_err(|e| e.to_string())?;
        Ok(facets.finish().map_or(0, |stl| stl.mesh.triangles.len()))
    }

    #[test]
    fn every_solid_counts_with_a_name_or_without() {
        for (text, expected) in [
            (format!("solid a\n{ONE}endsolid a\n"), 1),
            (format!("solid\n{ONE}{ONE}endsolid\n"), 2),
            (format!("\u{feff}solid\r\n{ONE}endsolid"), 1),
            (format!("solid a\n{ONE}endsolid a\n\nsolid b\n{ONE}endsolid b\n"), 2),
        ] {
            assert!(is_ascii(text.as_bytes()), "{text}");
            assert_eq!(triangles(&text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_missing_or_too_much_is_an_error() {
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
    fn what_is_wrong_has_its_line() {
        let second = format!("solid a\n{ONE}\n{ONE}endsolid a\n");
        for (text, expected) in [
            (
                second.replacen("vertex 5 0 0", "vertex 5 zero 0", 1),
                "line 5: \"vertex 5 zero 0\" stands where",
            ),
            (format!("solid a\n{ONE}\n{}", ONE.replace("endloop", "endlop")), "line 15: \"endlop\" stands"),
            (
                format!("\n\nsolid a\n{ONE}endsolid\nsolid b\n{ONE}\n"),
                "line 20: the file ends before 'endsolid'",
            ),
            (
                format!("solid a\n{}", ONE.replace("vertex 0 5 0\nendloop\nendfacet\n", "")),
                "line 5: the file ends before vertex",
            ),
            (
                format!("solid a\n{ONE}endsolid a\nmore\n"),
                "line 10: \"more\" stands where a solid must begin",
            ),
            (format!("solid a\n{}\n", "facet ".repeat(100)), "line 2: \"facet facet"),
            (format!("solid a\n{}endsolid\n", ONE.replace("5 0 0", "inf 0 0")), "line 5: \"vertex inf 0 0\""),
        ] {
            let said = triangles(&text).unwrap_err();
            assert!(said.starts_with(expected) && said.ends_with("; export the part again"), "{said}");
            assert!(said.len() < 200, "{said}");
        }
    }
}
