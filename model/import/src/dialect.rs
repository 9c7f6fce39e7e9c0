//! The delimiter of a text, and its cells.

use pinswitch_diagnostic::{Diagnostic, codes};

use crate::clock::{self, DateOrder};
use crate::number::{is_missing, sign_evidence};
use crate::sheet::Sheet;

/// What separates the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// One sign.
    Sign(u8),
    /// Any number of blanks.
    Blanks,
    /// Each line is one cell.
    Nothing,
}

/// Delimiters with their words in a map, in order of preference.
const DELIMITERS: [(Delimiter, &str); 6] = [
    (Delimiter::Sign(b'\t'), "tab"),
    (Delimiter::Sign(b';'), "semicolon"),
    (Delimiter::Sign(b'|'), "pipe"),
    (Delimiter::Sign(b','), "comma"),
    (Delimiter::Blanks, "blanks"),
    (Delimiter::Nothing, "none"),
];

/// Lines at the start and at the end of a text that are compared.
const SAMPLE_LINES: usize = 300;
/// Most lines of a quoted cell in these.
const MAX_CELL_LINES: usize = 50;
/// Bytes of a text in which these lines are.
const SAMPLE_BYTES: usize = 1 << 16;
/// Most bytes of a line: rows of the most cells that are read, of a kilobyte each.
const MAX_LINE: usize = 2 << 20;
/// Difference of scores below which the preferred delimiter wins.
const CLEAR_LEAD: f64 = 0.05;

impl Delimiter {
    /// Returns the delimiter with this word, or that is this sign.
    pub fn parse(text: &str) -> Option<Self> {
        let sign = match text {
            "\\t" => Some(b'\t'),
            _ => text.bytes().next().filter(|b| {
                text.len() == 1
                    && !b.is_ascii_alphanumeric()
                    && !matches!(b, b'"' | b' ' | b'.' | b'\n' | b'\r')
            }),
        };
        let word = DELIMITERS.iter().find(|(_, word)| word.eq_ignore_ascii_case(text)).map(|(d, _)| *d);
        let blanks = (matches!(text, " " | "space" | "spaces" | "blank")).then_some(Self::Blanks);
        word.or(blanks).or(sign.map(Self::Sign))
    }

    /// Returns the word in a map.
    pub fn as_str(self) -> String {
        let word = DELIMITERS.iter().find(|(delimiter, _)| *delimiter == self).map(|(_, word)| *word);
        match (word, self) {
            (Some(word), _) => word.to_owned(),
            (None, Self::Sign(sign)) => char::from(sign).to_string(),
            (None, _) => String::new(),
        }
    }
}

/// Splits the delimiter that a first line `sep=;` declares from the rest of the text, and returns
/// the lines that were removed.
pub(crate) fn declared(text: &str) -> (Option<Delimiter>, &str, usize) {
    let first = text.lines().next().unwrap_or_default();
    let word = first.trim_matches(|c: char| c == '"' || c == '\r');
    let Some(sign) = word.get(..4).filter(|begin| begin.eq_ignore_ascii_case("sep=")).and(word.get(4..))
    else {
        return (None, text, 0);
    };
    let delimiter = Delimiter::parse(if sign == "\t" { "tab" } else { sign });
    (
        delimiter,
        text.get(first.len()..).unwrap_or_default().trim_start_matches('\r').strip_prefix('\n').unwrap_or(""),
        1,
    )
}

/// Returns the delimiter with which the lines of a text have the most consistent cells.
pub(crate) fn detect(text: &str) -> Delimiter {
    let lines = sample(text);
    let mut best = (Delimiter::Nothing, 0.0);
    for (delimiter, _) in DELIMITERS {
        let score = score(&lines, delimiter);
        if score > best.1 + CLEAR_LEAD {
            best = (delimiter, score);
        }
    }
    best.0
}

fn sample(text: &str) -> Vec<&str> {
    let cut = |at: usize| (0..=at.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
    let begin = &text[..cut(SAMPLE_BYTES)];
    let mut lines = records(begin);
    lines.truncate(SAMPLE_LINES);
    if begin.len() < text.len() {
        // Both lines at the cuts are incomplete.
        lines.pop();
        let end = &text[cut(text.len() - SAMPLE_BYTES.min(text.len()))..];
        lines.extend(end.lines().skip(1).filter(|line| !line.trim().is_empty()).take(SAMPLE_LINES));
    }
    lines
}

/// Splits a text into its rows: lines, without empty ones. A line whose quotes are open continues in the next line, unless
/// they stay open for too long: then the quote is a sign, such as that of inches.
fn records(text: &str) -> Vec<&str> {
    let mut records = Vec::new();
    let mut lines = text.split_inclusive('\n');
    let mut rest = text;
    while let Some(line) = lines.next() {
        let is_open = |record: &str| record.bytes().filter(|b| *b == b'"').count() % 2 == 1;
        let mut length = line.len();
        if is_open(line) {
            let mut ahead = lines.clone();
            for _ in 0..MAX_CELL_LINES {
                let Some(next) = ahead.next() else { break };
                length += next.len();
                if !is_open(&rest[..length]) {
                    lines = ahead;
                    break;
                }
            }
            if is_open(&rest[..length]) {
                length = line.len();
            }
        }
        let (record, after) = rest.split_at(length);
        rest = after;
        if !record.trim().is_empty() {
            records.push(record.trim_end_matches(['\r', '\n']));
        }
    }
    records
}

/// Returns how consistent the cells are: the share of lines with the usual number of cells, times
/// the share of their cells that are numbers or words.
fn score(lines: &[&str], delimiter: Delimiter) -> f64 {
    let rows: Vec<Vec<String>> = lines.iter().map(|line| split_line(line, delimiter)).collect();
    let mut counts: Vec<usize> = rows.iter().map(Vec::len).collect();
    counts.sort_unstable();
    let usual = counts.chunk_by(|a, b| a == b).max_by_key(|chunk| chunk.len()).map_or(0, |chunk| chunk[0]);
    if usual < 2 && delimiter != Delimiter::Nothing {
        return 0.0;
    }
    let (mut clean, mut all, mut usual_rows) = (0.0, 0.0, 0.0);
    for row in rows.iter().filter(|row| row.len() == usual) {
        usual_rows += 1.0;
        for cell in row {
            all += 1.0;
            clean += quality(cell);
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "a few hundred lines")]
    let count = rows.len().max(1) as f64;
    if all == 0.0 { 0.0 } else { usual_rows / count * clean / all }
}

fn quality(cell: &str) -> f64 {
    let cell = cell.trim();
    if is_missing(cell) || sign_evidence(cell).is_some() || clock::parse(cell, DateOrder::DayFirst).is_some()
    {
        return 1.0;
    }
    // A cell that another delimiter would split.
    let has_several = cell.contains(['\t', ';', '|'])
        || cell.split([',', ' ']).filter(|part| sign_evidence(part).is_some()).count() > 1;
    if has_several { 0.0 } else { 0.7 }
}

fn split_line(line: &str, delimiter: Delimiter) -> Vec<String> {
    match delimiter {
        Delimiter::Nothing => vec![line.to_owned()],
        Delimiter::Blanks => line.split_whitespace().map(str::to_owned).collect(),
        Delimiter::Sign(sign) => {
            let mut cells = vec![String::new()];
            let mut is_quoted = false;
            for c in line.chars() {
                match c {
                    '"' => is_quoted = !is_quoted,
                    _ if c == char::from(sign) && !is_quoted => cells.push(String::new()),
                    _ => {
                        if let Some(cell) = cells.last_mut() {
                            cell.push(c);
                        }
                    }
                }
            }
            cells
        }
    }
}

/// Reads the cells of a text; its first line has the number `first_line` + 1.
///
/// # Errors
/// A [`Diagnostic`] for a text that is too large.
pub(crate) fn cells(text: &str, delimiter: Delimiter, first_line: usize) -> Result<Sheet, Diagnostic> {
    let longest = text.lines().enumerate().max_by_key(|(_, line)| line.len());
    if let Some((i, line)) = longest.filter(|(_, line)| line.len() > MAX_LINE) {
        return Err(Diagnostic::new(
            codes::FILE_TOO_LARGE,
            format!("line {}: {} bytes, at most {MAX_LINE} are read", first_line + i + 1, line.len()),
        )
        .with_help("give a text with one row in each line"));
    }
    let mut sheet = Sheet::default();
    let Delimiter::Sign(sign) = delimiter else {
        for (i, line) in text.lines().enumerate() {
            if line.trim().is_empty() {
                continue;
            }
            if delimiter == Delimiter::Blanks {
                line.split_whitespace().for_each(|cell| sheet.push(cell.trim_matches('"')));
            } else {
                sheet.push(line.trim().trim_matches('"'));
            }
            sheet.end_row(first_line + i + 1)?;
        }
        return Ok(sheet);
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(sign)
        .has_headers(false)
        .flexible(true)
        .buffer_capacity(1 << 16)
        .from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    // The reader counts line feeds before a record to it.
    let (mut counted, mut line) = (0, first_line + 1);
    loop {
        let start = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
        if !reader.read_record(&mut record).map_err(|e| Diagnostic::from_error(codes::DAMAGED_FILE, e))? {
            return Ok(sheet);
        }
        let bytes = text.as_bytes();
        let start = start.min(bytes.len());
        let begin = start + bytes[start..].iter().take_while(|b| matches!(b, b'\n' | b'\r')).count();
        line += line_ends(&bytes[counted..begin]);
        counted = begin;
        if record.iter().all(|cell| cell.trim().is_empty()) {
            continue;
        }
        record.iter().for_each(|cell| sheet.push(cell));
        sheet.end_row(line)?;
    }
}

/// Counts line ends; a carriage return without a line feed is one, as on old Macintoshes.
fn line_ends(bytes: &[u8]) -> usize {
    let feeds = bytes.iter().filter(|b| **b == b'\n').count();
    if feeds > 0 { feeds } else { bytes.iter().filter(|b| **b == b'\r').count() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delimiters_are_recognised() {
        for (text, expected) in [
            ("a;b;c\n0;1,5;2,4\n1;2,5;3,4\n", "semicolon"),
            ("a,b,c\n0,1.5,2.4\n1,2.5,3.4\n", "comma"),
            ("a\tb\n1,5\t2,4\n2,5\t3,4\n", "tab"),
            ("a b\n1,5 2,4\n2,5 3,4\n", "blanks"),
            ("a, b\n1.5, 2.4\n2.5, 3.4\n", "comma"),
            ("a,pins\n1.5,5;8;11\n2.5,5;8;11\n", "comma"),
            ("a|b\n1.5|2\n2.5|3\n", "pipe"),
            ("a\n1.5\n2.5\n", "none"),
            ("\"a\",\"b\"\n\"1,5\",\"2,5\"\n", "comma"),
            ("title; with a sign\nt,F\n1.5,2\n2.5,3\n3.5,4\n", "comma"),
            ("t,F,n\n1,2,\"a\nb\nc; d\ne; f\"\n2,3,\"g\nh; i\nj; k\nl\"\n", "comma"),
            ("t,F,d\n1,2,3\"\n2,3,3\"\n3,4,3\n", "comma"),
        ] {
            assert_eq!(detect(text).as_str(), expected, "{text}");
        }
        assert_eq!(declared("sep=;\r\na;b\n"), (Some(Delimiter::Sign(b';')), "a;b\n", 1));
        assert_eq!(declared("sepia;b\n"), (None, "sepia;b\n", 0));
    }

    #[test]
    fn rows_have_their_lines() {
        let sheet = cells("a;b\r\n\r\n\"x\ny\";2\r\n;\r\n3;4", Delimiter::Sign(b';'), 0).unwrap();
        let lines: Vec<usize> = (0..sheet.len()).map(|row| sheet.line(row)).collect();
        assert_eq!(lines, [1, 3, 6]);
        assert_eq!(sheet.row(1).collect::<Vec<_>>(), ["x\ny", "2"]);
    }

    #[test]
    fn open_quotes_and_wide_rows_are_refused() {
        let open = format!("a,b\n1,\"{}\n", "2,3\n".repeat(10_000));
        assert!(cells(&open, Delimiter::Sign(b','), 0).unwrap_err().to_string().contains("line 2"));
        let wide = "1,".repeat(1_000_000);
        assert!(cells(&wide, Delimiter::Sign(b','), 0).unwrap_err().to_string().contains("cells in a row"));
    }
}
