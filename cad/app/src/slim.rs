//! A compiled module without what a browser does not need, so that a page is small.
//!
//! A module is its magic, its version, and sections: a number, a length, the content (WebAssembly core specification,
//! chapter 5.5). Custom sections (names, notes for bindgen) are left out, and of the exports all but the engine's own; what
//! described functions to bindgen keeps its number and has no body. Texts that the configurator's page holds as well, as the
//! libraries of `report.html`, become holes filled with zeros, which the worker fills again from the page before the module is
//! compiled.

/// What the page asks the module for.
const EXPORTS: [&str; 4] = ["memory", "room", "answer", "free"];
/// Functions that nobody but bindgen's own tool calls: libraries describe to it what they export.
const DESCRIPTION: &[u8] = b"__wbindgen_describe";
const CUSTOM: u8 = 0;
const IMPORT: u8 = 2;
const EXPORT: u8 = 7;
const CODE: u8 = 10;
/// A body, with its length: no locals, `unreachable`, `end`.
const NO_BODY: [u8; 4] = [3, 0, 0x00, 0x0b];
/// Kinds of imports and exports.
const FUNCTION: u8 = 0;
const TABLE: u8 = 1;
const MEMORY: u8 = 2;
/// Magic and version.
const HEADER: usize = 8;

/// A module that was made slim, and where its holes are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slim {
    /// The module with its holes.
    pub bytes: Vec<u8>,
    /// Where each text begins, in the order of the texts; `None` for one that the module does not hold.
    pub holes: Vec<Option<usize>>,
}

/// `module` without what a browser does not need, with a hole for each of `texts`; `None` if it is no module.
#[must_use]
pub fn slim(module: &[u8], texts: &[&str]) -> Option<Slim> {
    let mut bytes = module.get(..HEADER).filter(|header| header.starts_with(b"\0asm"))?.to_vec();
    let mut place = HEADER;
    // Imported functions are counted before the module's own.
    let (mut imported, mut descriptions) = (0, Vec::new());
    while let Some(&number) = module.get(place) {
        let (length, content) = number_at(module, place + 1)?;
        let end = content.checked_add(length)?;
        let section = module.get(content..end)?;
        match number {
            CUSTOM => {}
            IMPORT => {
                imported = imported_functions(section)?;
                bytes.extend(module.get(place..end)?);
            }
            EXPORT => {
                let exports = exports(section)?;
                let described =
                    exports.iter().filter(|e| e.kind == FUNCTION && e.name.starts_with(DESCRIPTION));
                descriptions.extend(described.map(|e| e.index));
                let own: Vec<&Export<'_>> =
                    exports.iter().filter(|e| EXPORTS.iter().any(|own| e.name == own.as_bytes())).collect();
                push_section(&mut bytes, EXPORT, own.len(), own.iter().map(|e| e.entry));
            }
            CODE => {
                let bodies = bodies(section)?;
                let kept = (imported..).zip(&bodies).map(|(index, body)| {
                    if descriptions.contains(&index) { NO_BODY.as_slice() } else { body }
                });
                push_section(&mut bytes, CODE, bodies.len(), kept);
            }
            _ => bytes.extend(module.get(place..end)?),
        }
        place = end;
    }
    let holes = texts.iter().map(|text| hole(&mut bytes, text)).collect();
    Some(Slim { bytes, holes })
}

/// Fills the place of `text` with zeros.
fn hole(bytes: &mut [u8], text: &str) -> Option<usize> {
    let place = bytes.windows(text.len().max(1)).position(|window| window == text.as_bytes())?;
    bytes.get_mut(place..place + text.len())?.fill(0);
    Some(place)
}

/// An entry of the export section: its name, its kind, and the number of what it stands for.
struct Export<'a> {
    entry: &'a [u8],
    name: &'a [u8],
    kind: u8,
    index: usize,
}

fn exports(section: &[u8]) -> Option<Vec<Export<'_>>> {
    let (count, mut place) = number_at(section, 0)?;
    let mut found = Vec::new();
    for _ in 0..count {
        let begin = place;
        let (length, name) = number_at(section, place)?;
        let end = name.checked_add(length)?;
        let kind = *section.get(end)?;
        let index;
        (index, place) = number_at(section, end + 1)?;
        found.push(Export { entry: section.get(begin..place)?, name: section.get(name..end)?, kind, index });
    }
    Some(found)
}

/// How many imports are functions. An import is the name of a module, its own name, a kind, and what it must be like.
fn imported_functions(section: &[u8]) -> Option<usize> {
    let (count, mut place) = number_at(section, 0)?;
    let mut functions = 0;
    for _ in 0..count {
        for _ in 0..2 {
            let (length, name) = number_at(section, place)?;
            place = name.checked_add(length)?;
        }
        let kind = *section.get(place)?;
        // A table begins with the type of what it holds; a global is a type and whether it changes.
        place += if kind == TABLE { 2 } else { 1 };
        if matches!(kind, TABLE | MEMORY) {
            let (flags, least) = number_at(section, place)?;
            place = number_at(section, least)?.1;
            if flags & 1 == 1 {
                place = number_at(section, place)?.1;
            }
        } else if kind == FUNCTION {
            functions += 1;
            place = number_at(section, place)?.1;
        } else {
            place += 2;
        }
    }
    Some(functions)
}

/// The bodies of the code section, each with its length.
fn bodies(section: &[u8]) -> Option<Vec<&[u8]>> {
    let (count, mut place) = number_at(section, 0)?;
    let mut found = Vec::new();
    for _ in 0..count {
        let begin = place;
        let (length, body) = number_at(section, place)?;
        place = body.checked_add(length)?;
        found.push(section.get(begin..place)?);
    }
    Some(found)
}

/// Adds a section of so many entries.
fn push_section<'a>(bytes: &mut Vec<u8>, number: u8, count: usize, entries: impl Iterator<Item = &'a [u8]>) {
    let mut content = Vec::new();
    push_number(&mut content, count);
    entries.for_each(|entry| content.extend(entry));
    bytes.push(number);
    push_number(bytes, content.len());
    bytes.extend(content);
}

/// A number of seven bits to a byte, the lowest first, and the place behind it.
fn number_at(bytes: &[u8], mut place: usize) -> Option<(usize, usize)> {
    let mut number = 0;
    for shift in (0..32).step_by(7) {
        let byte = *bytes.get(place)?;
        place += 1;
        number |= usize::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some((number, place));
        }
    }
    None
}

fn push_number(bytes: &mut Vec<u8>, mut number: usize) {
    loop {
        let low = (number & 0x7f).to_le_bytes()[0];
        number >>= 7;
        if number == 0 {
            bytes.push(low);
            return;
        }
        bytes.push(low | 0x80);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn module(sections: &[(u8, &[u8])]) -> Vec<u8> {
        let mut bytes = b"\0asm\x01\0\0\0".to_vec();
        for (number, content) in sections {
            bytes.push(*number);
            push_number(&mut bytes, content.len());
            bytes.extend(*content);
        }
        bytes
    }

    #[test]
    fn what_no_browser_needs_goes_and_the_rest_stays() {
        let long = [1; 300];
        let whole = module(&[
            (0, b"\x04name..."),
            (1, &long),
            (2, b"\x03\x01m\x03now\x00\x07\x01m\x01t\x01\x70\x01\x01\x80\x01\x01m\x01g\x03\x7f\x00"),
            (7, b"\x04\x04room\x00\x05\x0a__describe\x00\x81\x01\x15__wbindgen_describe_f\x00\x02\x06memory\x02\x00"),
            (10, b"\x03\x02\x00\x0b\x05\x00abc\x0b\x03\x00d\x0b"),
            (11, b"..a text that stands twice.."),
        ]);
        let made = slim(&whole, &["a text that stands twice", "elsewhere"]).unwrap();
        let expected = module(&[
            (1, &long),
            (2, b"\x03\x01m\x03now\x00\x07\x01m\x01t\x01\x70\x01\x01\x80\x01\x01m\x01g\x03\x7f\x00"),
            (7, b"\x02\x04room\x00\x05\x06memory\x02\x00"),
            // The second body is function 2, after one that is imported.
            (10, b"\x03\x02\x00\x0b\x03\x00\x00\x0b\x03\x00d\x0b"),
            (11, b"..\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0.."),
        ]);
        assert_eq!(made.bytes, expected);
        assert_eq!(made.holes, [Some(expected.len() - 26), None]);
    }

    #[test]
    fn what_is_no_module_is_none() {
        assert_eq!(slim(b"", &[]), None);
        assert_eq!(slim(b"MZ......", &[]), None);
        let whole = module(&[(7, b"\x02\x04room\x00\x05")]);
        assert_eq!(slim(&whole, &[]), None, "an export that is announced, and missing");
        assert_eq!(slim(&whole[..whole.len() - 1], &[]), None, "cut off");
    }
}
