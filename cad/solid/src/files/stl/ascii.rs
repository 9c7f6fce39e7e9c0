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
    let mut words = Words { bytes: &bytes, at: start, last: start, line: None };
    let mut reader = Reader { facets: Facets::default(), deviations: Vec::new(), is_open: false };
    while let Some(word) = words.next() {
        if word.eq_ignore_ascii_case(b"facet") && reader.is_open {
            reader.facet(&mut words)?;
        } else if word.eq_ignore_ascii_case(b"solid") && !reader.is_open {
            reader.is_open = true;
            words.skip_name(false);
        } else if word.eq_ignore_ascii_case(b"endsolid") && reader.is_open {
            reader.is_open = false;
            words.skip_name(true);
        } else if reader.is_open {
            if is_keyword(word) {
                return Err(words.unexpected("facet normal X Y Z"));
            }
            reader.deviate("text is between facets");
            words.skip_remark();
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
        let mut normal = [0.0; 3];
        let has_normal = !words.is_next(b"outer");
        if has_normal {
            words.expect(b"normal", form)?;
        } else {
            self.deviate("facets have no normal");
        }
        for coordinate in normal.iter_mut().filter(|_| has_normal) {
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
        words.expect_end(b"endloop", b"loop", "endloop")?;
        words.skip_remark();
        words.expect_end(b"endfacet", b"facet", "endfacet")?;
        words.skip_remark();
        self.facets.add(normal, corners);
        Ok(())
    }
}

fn number(word: &[u8]) -> Option<f32> {
    let word = std::str::from_utf8(word).ok()?;
    // Programs in Fortran write the exponent of double precision with a D.
    word.parse().or_else(|_| word.replace(['d', 'D'], "e").parse()).ok()
}

/// Whether a word belongs to the format.
fn is_keyword(word: &[u8]) -> bool {
    let keywords: [&[u8]; 9] =
        [b"solid", b"endsolid", b"facet", b"endfacet", b"normal", b"outer", b"loop", b"endloop", b"vertex"];
    keywords.iter().any(|keyword| word.eq_ignore_ascii_case(keyword))
}

/// Whether a line that begins with this word has a colour or texture coordinates, which programs add.
fn is_attribute(word: &[u8]) -> bool {
    let attributes: [&[u8]; 4] = [b"vt", b"vn", b"color", b"colour"];
    attributes.iter().any(|attribute| word.eq_ignore_ascii_case(attribute))
}

fn is_line_end(byte: &u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}

fn is_space(byte: &u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0b | 0x0c)
}

/// The words of a text.
#[derive(Clone)]
struct Words<'a> {
    bytes: &'a [u8],
    /// The byte after the last word.
    at: usize,
    /// The first byte of the last word.
    last: usize,
    /// The line of the last name.
    line: Option<Line>,
}

/// The end of a line.
#[derive(Clone, Copy)]
struct Line {
    end: usize,
    /// Whether the next word is `facet`.
    is_before_facet: bool,
}

impl<'a> Words<'a> {
    /// Returns the next word, after comments.
    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            let word = self.next_with_comments()?;
            if !(word.starts_with(b"#") || word.starts_with(b";") || word.starts_with(b"//")) {
                return Some(word);
            }
            self.skip_line();
        }
    }

    fn next_with_comments(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let start = self.at + rest.iter().position(|byte| !is_space(byte))?;
        let length = self.bytes[start..].iter().position(is_space);
        let end = length.map_or(self.bytes.len(), |length| start + length);
        (self.last, self.at) = (start, end);
        Some(&self.bytes[start..end])
    }

    /// Returns the next word of the line.
    fn next_on_line(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|byte| !is_space(byte) || is_line_end(byte))?;
        if is_line_end(&rest[start]) {
            return None;
        }
        self.next_with_comments()
    }

    /// Whether the next word is this one.
    fn is_next(&self, expected: &[u8]) -> bool {
        self.clone().next().is_some_and(|word| word.eq_ignore_ascii_case(expected))
    }

    fn expect(&mut self, expected: &[u8], form: &str) -> Result<(), StlError> {
        loop {
            match self.next() {
                Some(word) if word.eq_ignore_ascii_case(expected) => return Ok(()),
                Some(word) if is_attribute(word) => self.skip_line(),
                Some(_) => return Err(self.unexpected(form)),
                None => return Err(self.missing(form)),
            }
        }
    }

    /// Expects `endloop` or `endfacet`, which programs also write as two words.
    fn expect_end(&mut self, expected: &[u8], second: &[u8], form: &str) -> Result<(), StlError> {
        let mut ahead = self.clone();
        let is_end = ahead.next().is_some_and(|word| word.eq_ignore_ascii_case(b"end"));
        if is_end && ahead.is_next(second) {
            self.expect(b"end", form)?;
            return self.expect(second, form);
        }
        self.expect(expected, form)
    }

    /// The end of the line at the last word.
    fn end_of_line(&self) -> usize {
        let rest = &self.bytes[self.at..];
        rest.iter().position(is_line_end).map_or(self.bytes.len(), |end| self.at + end)
    }

    /// Skips text up to the end of the line, or to a word that continues the solid.
    fn skip_remark(&mut self) {
        let start = self.at;
        loop {
            let before = self.at;
            let Some(word) = self.next_on_line() else { return };
            let is_facet = word.eq_ignore_ascii_case(b"facet") && (before == start || self.is_facet());
            let is_end = [b"endsolid".as_slice(), b"endfacet", b"end"];
            if is_facet || is_end.iter().any(|end| word.eq_ignore_ascii_case(end)) {
                self.at = before;
                return;
            }
        }
    }

    fn skip_line(&mut self) {
        self.at = self.end_of_line();
    }

    /// Skips the name of a solid after `solid` or `endsolid`: the rest of the line, or the words before
    /// the next keyword if the line contains facets or another solid. A name may contain keywords.
    fn skip_name(&mut self, is_end: bool) {
        let line = self.line_of_name();
        loop {
            let before = self.at;
            let Some(word) = self.next_on_line() else { return };
            let is = |keyword: &[u8]| word.eq_ignore_ascii_case(keyword);
            let ends = match is_end {
                false => (is(b"facet") && self.is_facet()) || (is(b"endsolid") && !line.is_before_facet),
                true => is(b"solid") && (line.is_before_facet || self.has_facet()),
            };
            if ends {
                self.at = before;
                return;
            }
        }
    }

    /// The line at the last word, which is sought once for all names on it.
    fn line_of_name(&mut self) -> Line {
        if let Some(line) = self.line.filter(|line| self.at <= line.end) {
            return line;
        }
        let end = self.end_of_line();
        let after = Words { at: end, ..self.clone() };
        let line = Line { end, is_before_facet: after.is_next(b"facet") };
        self.line = Some(line);
        line
    }

    /// Whether the words after `facet` are those of a facet, and not of a name.
    fn is_facet(&self) -> bool {
        let mut ahead = self.clone();
        if ahead.is_next(b"normal") {
            for _ in 0..4 {
                ahead.next();
            }
        }
        ahead.next().is_some_and(|word| word.eq_ignore_ascii_case(b"outer")) && ahead.is_next(b"loop")
    }

    /// Whether a facet follows on the same line.
    fn has_facet(&self) -> bool {
        let mut ahead = self.clone();
        (0..MAX_NAME_WORDS).any(|_| {
            ahead.next_on_line().is_some_and(|word| word.eq_ignore_ascii_case(b"facet")) && ahead.is_facet()
        })
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
        let start = self.bytes[..self.last].iter().rposition(is_line_end).map_or(0, |end| end + 1);
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
            (format!("solid a\n{}endsolid\n", ONE.replace("endloop", "endloop remark")), 1, None),
            (format!("solid a\n{}endsolid\n", ONE.replace("endloop\nend", "endloop remark end")), 1, None),
            (format!("solid facet of a thing\n{ONE}endsolid facet of a thing\n"), 1, None),
            (format!("solid my facet normal part\n{ONE}endsolid my facet normal part\n"), 1, None),
            (format!("solid solid facet tool\n{ONE}endsolid solid facet tool\n"), 1, None),
            (format!("solid part of solid with facet holes\n{ONE}endsolid solid facet\n"), 1, None),
            (format!("solid the endsolid\n{ONE}endsolid the endsolid\n"), 1, None),
            (format!("solid empty endsolid empty\nsolid a\n{ONE}endsolid a\n"), 1, None),
            (
                format!("solid a\n# b\n{ONE}; c\n{}endsolid\n", ONE.replace("endloop", "// d\nendloop")),
                2,
                None,
            ),
            (format!("solid a\ncolor 0 1 0\n{ONE}endsolid\n"), 1, Some("text is between facets")),
            (format!("solid a\n{}endsolid\n", ONE.replace("endloop", "vt 0 0\nvt 0 1\nendloop")), 1, None),
            (format!("solid a\n{}endsolid\n", ONE.replace("endloop\nend", "end loop\nend ")), 1, None),
            (
                format!("solid a\n{}endsolid\n", ONE.replace(" normal 0 0 1", "")),
                1,
                Some("facets have no normal"),
            ),
            (format!("solid a\n{}endsolid\n", ONE.replace('5', "5.0D+00")), 1, None),
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

    /// Names and remarks on one line are sought once: otherwise this test takes minutes.
    #[test]
    fn long_lines_are_read() {
        let solids = "solid x endsolid x ".repeat(100_000);
        let facets =
            format!("solid {}", ONE.replace('\n', " ").replace("endfacet", "endfacet r").repeat(20_000));
        assert_eq!(triangles(&format!("{solids}solid {}", ONE.replace('\n', " "))).unwrap(), 1);
        assert_eq!(triangles(&facets).unwrap(), 20_000);
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
