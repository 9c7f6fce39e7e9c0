//! Reads ASCII STL: one solid or several, with or without names, as the programs of others write
//! them: in any case, with any ends of lines, on one line, without `endsolid`.

use std::io::Read;

use super::error::StlError;
use super::facets::Facets;

/// Most characters of a line that an error quotes.
const MAX_QUOTED: usize = 60;

/// Returns whether a file that begins with `head` is an ASCII STL.
///
/// The facet count of a binary STL contains a zero byte, unless the file is larger than a gigabyte.
pub(super) fn is_ascii(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let (word, rest) = head.split_at(head.len().min(5));
    !head.contains(&0)
        && word.eq_ignore_ascii_case(b"solid")
        && rest.first().is_none_or(u8::is_ascii_whitespace)
}

/// Reads every solid of an ASCII STL. Names may contain any bytes. Also returns the deviations from
/// the format that other readers accept.
///
/// # Errors
/// The first line that does not have the required form.
pub(super) fn read_ascii(source: &mut impl Read) -> Result<(Facets, Vec<&'static str>), StlError> {
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes)?;
    let start = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut words = Words { bytes: &bytes, at: start, last: start };
    let mut reader = Reader { facets: Facets::default(), deviations: Vec::new(), is_open: false };
    while let Some(word) = words.next() {
        if word.eq_ignore_ascii_case(b"facet") && reader.is_open {
            reader.facet(&mut words)?;
        } else if word.eq_ignore_ascii_case(b"solid") && !reader.is_open {
            reader.is_open = true;
            words.skip_name();
        } else if word.eq_ignore_ascii_case(b"endsolid") && reader.is_open {
            reader.is_open = false;
            words.skip_name();
        } else if reader.is_open {
            return Err(words.unexpected("facet normal X Y Z"));
        } else {
            reader.deviate("text follows endsolid");
            words.skip_line();
        }
    }
    if reader.is_open {
        reader.deviate("endsolid is missing");
    }
    Ok((reader.facets, reader.deviations))
}

/// The facets that were read.
struct Reader {
    facets: Facets,
    deviations: Vec<&'static str>,
    /// Whether a solid is open.
    is_open: bool,
}

impl Reader {
    fn deviate(&mut self, deviation: &'static str) {
        if !self.deviations.contains(&deviation) {
            self.deviations.push(deviation);
        }
    }

    /// Reads a facet after its first word.
    fn facet(&mut self, words: &mut Words<'_>) -> Result<(), StlError> {
        let form = "facet normal X Y Z";
        words.expect(b"normal", form)?;
        let mut normal = [0.0; 3];
        for coordinate in &mut normal {
            // Programs write `nan`, `-nan(ind)`, `1.#QNAN` or a word for facets without area, and
            // readers compute normals from the corners.
            let word = words.next().ok_or_else(|| words.missing(form))?;
            *coordinate = number(word).unwrap_or(f32::NAN);
        }
        words.expect(b"outer", "outer loop")?;
        words.expect(b"loop", "outer loop")?;
        let mut corners = [[0.0; 3]; 3];
        for corner in &mut corners {
            let form = "vertex X Y Z";
            words.expect(b"vertex", form)?;
            for coordinate in corner {
                let word = words.next().ok_or_else(|| words.missing(form))?;
                let number = number(word).filter(|number| number.is_finite());
                *coordinate = number.ok_or_else(|| words.unexpected(form))?;
            }
        }
        words.expect(b"endloop", "endloop")?;
        words.expect(b"endfacet", "endfacet")?;
        words.skip_remark();
        self.facets.add(normal, corners);
        Ok(())
    }
}

fn number(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn is_space(byte: &u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0b | 0x0c)
}

/// The words of a text.
struct Words<'a> {
    bytes: &'a [u8],
    /// The byte after the last word.
    at: usize,
    /// The first byte of the last word.
    last: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let start = self.at + rest.iter().position(|byte| !is_space(byte))?;
        let length = self.bytes[start..].iter().position(is_space);
        let end = length.map_or(self.bytes.len(), |length| start + length);
        (self.last, self.at) = (start, end);
        Some(&self.bytes[start..end])
    }

    fn expect(&mut self, expected: &[u8], form: &str) -> Result<(), StlError> {
        match self.next() {
            Some(word) if word.eq_ignore_ascii_case(expected) => Ok(()),
            Some(_) => Err(self.unexpected(form)),
            None => Err(self.missing(form)),
        }
    }

    /// The end of the line at the last word.
    fn end_of_line(&self) -> usize {
        let rest = &self.bytes[self.at..];
        rest.iter()
            .position(|byte| matches!(byte, b'\r' | b'\n'))
            .map_or(self.bytes.len(), |end| self.at + end)
    }

    /// Skips text between `endfacet` and the end of its line, unless that continues the solid.
    fn skip_remark(&mut self) {
        let end = self.end_of_line();
        let mut ahead = Words { bytes: &self.bytes[..end], at: self.at, last: self.last };
        let is_keyword = |word: &[u8]| {
            [&b"facet"[..], b"endsolid"].iter().any(|keyword| word.eq_ignore_ascii_case(keyword))
        };
        if ahead.next().is_some_and(|word| !is_keyword(word)) {
            self.at = end;
        }
    }

    fn skip_line(&mut self) {
        self.at = self.end_of_line();
    }

    /// Skips the name of a solid: the rest of the line, or the words before the next keyword if the
    /// whole file is on one line.
    fn skip_name(&mut self) {
        let end = self.end_of_line();
        let mut ahead = Words { bytes: &self.bytes[..end], at: self.at, last: self.last };
        while let Some(word) = ahead.next() {
            let start = ahead.last;
            let is_facet = word.eq_ignore_ascii_case(b"facet")
                && ahead.next().is_some_and(|next| next.eq_ignore_ascii_case(b"normal"));
            let is_solid = word.eq_ignore_ascii_case(b"solid") && self.has_facet(ahead.at, end);
            if is_facet || is_solid || word.eq_ignore_ascii_case(b"endsolid") {
                self.at = start;
                return;
            }
            ahead.at = start + word.len();
        }
        self.at = end;
    }

    /// Whether a facet follows on the same line.
    fn has_facet(&self, from: usize, end: usize) -> bool {
        let mut ahead = Words { bytes: &self.bytes[..end], at: from, last: from };
        let mut words = std::iter::from_fn(|| ahead.next()).take(MAX_NAME_WORDS);
        words.any(|word| word.eq_ignore_ascii_case(b"facet"))
    }

    /// The line of a byte, from 1. A line ends with CR, LF or both.
    fn line(&self, at: usize) -> usize {
        let before = &self.bytes[..at];
        let is_end = |(i, byte): (usize, &u8)| {
            *byte == b'\n' || (*byte == b'\r' && self.bytes.get(i + 1) != Some(&b'\n'))
        };
        1 + before.iter().enumerate().filter(|end| is_end((end.0, end.1))).count()
    }

    /// The error of the last word.
    fn unexpected(&self, form: &str) -> StlError {
        let is_end = |byte: &u8| matches!(byte, b'\r' | b'\n');
        let start = self.bytes[..self.last].iter().rposition(is_end).map_or(0, |end| end + 1);
        let line = String::from_utf8_lossy(&self.bytes[start..self.end_of_line()]);
        let problem = format!("expected '{form}', found {}", quoted(&line));
        StlError::Line { line: self.line(self.last), problem }
    }

    /// The error of a word that is missing at the end of the file.
    fn missing(&self, form: &str) -> StlError {
        let problem = format!("expected '{form}', found the end of the file");
        StlError::Line { line: self.line(self.last), problem }
    }
}

/// Most words of a name on a line with facets.
const MAX_NAME_WORDS: usize = 20;

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
        let (facets, _) = read_ascii(&mut std::io::Cursor::new(text))?;
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
    fn deviations_of_other_programs_are_read() {
        let one_line = format!("solid a {}endsolid a solid b {}endsolid b", ONE, ONE).replace('\n', " ");
        for (text, expected, deviation) in [
            (format!("SOLID A\n{}ENDSOLID A\n", ONE.to_uppercase()), 1, None),
            (format!("Solid a\r{}EndSolid a\r", ONE.replace('\n', "\r")), 1, None),
            (
                format!("solid a\n{}endsolid\n", ONE.replace("normal 0 0 1", "normal nan -nan(ind) word")),
                1,
                None,
            ),
            (one_line, 2, None),
            (format!("solid a\n{}endsolid\n", ONE.replace("endfacet", "endfacet remark")), 1, None),
            (format!("solid facet of a thing\n{ONE}endsolid facet of a thing\n"), 1, None),
            (format!("solid a\n{ONE}"), 1, Some("endsolid is missing")),
            (format!("solid a\n{ONE}endsolid a\nmade by a program\n\n"), 1, Some("text follows endsolid")),
            (
                format!("solid a\n{ONE}endsolid a\n--\nsolid b\n{ONE}endsolid"),
                2,
                Some("text follows endsolid"),
            ),
        ] {
            assert!(is_ascii(text.as_bytes()), "{text}");
            let (facets, deviations) = read_ascii(&mut std::io::Cursor::new(&text)).unwrap();
            assert_eq!(facets.len(), expected, "{text}");
            assert_eq!(deviations.first().copied(), deviation, "{text}");
        }
    }

    #[test]
    fn missing_and_extra_words_are_refused() {
        for text in [
            format!("solid a\n{ONE}endsolid a\nsolid b\n{}", &ONE[..60]),
            format!("solid a\n{}", ONE.replace("endloop", "vertex 1 1 1\nendloop")),
            format!("solid a\n{}endsolid", ONE.replace("vertex 5 0 0", "vertex nan 0 0")),
            format!("solid a\nsolid b\n{ONE}\nsolid c\nendsolid"),
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
                format!("solid a\n{}", ONE.replace("vertex 0 5 0\nendloop\nendfacet\n", "")),
                "line 5: expected 'vertex X Y Z', found the end of the file",
            ),
            (
                format!("solid a\r{}", ONE.replace("endloop", "endlop").replace('\n', "\r\n")),
                "line 7: expected 'endloop', found \"endlop\"",
            ),
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
