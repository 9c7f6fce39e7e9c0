//! Removes from a compiled module what a browser does not need, to keep the page small.
//!
//! A module is its magic number, its version, and sections: an id, a length, the content
//! (WebAssembly core specification, chapter 5.5). [`strip`] removes
//!
//! - custom sections (names, notes for wasm-bindgen),
//! - exports that the page does not use,
//! - the bodies of functions that describe exports to wasm-bindgen; the functions keep their
//!   indices,
//! - texts that the page contains, too, such as the libraries of `report.html`: they become zeros,
//!   and the worker inserts them again before it compiles the module.

/// Exports that the page uses.
const EXPORTS: [&str; 4] = ["memory", "room", "answer", "free"];
/// Prefix of functions that only wasm-bindgen's tool calls: libraries describe their exports in
/// them.
const DESCRIBE_PREFIX: &[u8] = b"__wbindgen_describe";
/// Ids of sections.
const CUSTOM: u8 = 0;
const IMPORT: u8 = 2;
const EXPORT: u8 = 7;
const CODE: u8 = 10;
/// An empty body with its length: no locals, `unreachable`, `end`.
const EMPTY_BODY: [u8; 4] = [3, 0, 0x00, 0x0b];
/// Kinds of imports and exports.
const FUNCTION: u8 = 0;
const TABLE: u8 = 1;
const MEMORY: u8 = 2;
/// Bytes of magic number and version.
const HEADER: usize = 8;

/// A stripped module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StrippedModule {
    /// The module, with zeros in place of the texts.
    pub bytes: Vec<u8>,
    /// Offset of each text in bytes, in the order of the texts; `None` for a text that the module
    /// does not contain.
    pub text_offsets: Vec<Option<usize>>,
}

/// Strips a module and replaces each of `texts` in it by zeros; `None` if `module` is not a
/// WebAssembly module.
#[must_use]
pub fn strip(module: &[u8], texts: &[&str]) -> Option<StrippedModule> {
    let mut bytes = module.get(..HEADER).filter(|header| header.starts_with(b"\0asm"))?.to_vec();
    let mut offset = HEADER;
    // Indices of functions start with the imported ones.
    let (mut imported, mut descriptions) = (0, Vec::new());
    while let Some(&id) = module.get(offset) {
        let (length, content) = number_at(module, offset + 1)?;
        let end = content.checked_add(length)?;
        let section = module.get(content..end)?;
        match id {
            CUSTOM => {}
            IMPORT => {
                imported = imported_functions(section)?;
                bytes.extend(module.get(offset..end)?);
            }
            EXPORT => {
                let exports = exports(section)?;
                let describing =
                    exports.iter().filter(|e| e.kind == FUNCTION && e.name.starts_with(DESCRIBE_PREFIX));
                descriptions.extend(describing.map(|e| e.index));
                let used: Vec<&Export<'_>> =
                    exports.iter().filter(|e| EXPORTS.iter().any(|name| e.name == name.as_bytes())).collect();
                push_section(&mut bytes, EXPORT, used.len(), used.iter().map(|e| e.entry));
            }
            CODE => {
                let bodies = bodies(section)?;
                let entries = (imported..).zip(&bodies).map(|(index, body)| {
                    if descriptions.contains(&index) { EMPTY_BODY.as_slice() } else { body }
                });
                push_section(&mut bytes, CODE, bodies.len(), entries);
            }
            _ => bytes.extend(module.get(offset..end)?),
        }
        offset = end;
    }
    let text_offsets = texts.iter().map(|text| clear_text(&mut bytes, text)).collect();
    Some(StrippedModule { bytes, text_offsets })
}

/// Overwrites `text` with zeros and returns its offset.
fn clear_text(bytes: &mut [u8], text: &str) -> Option<usize> {
    let offset = bytes.windows(text.len().max(1)).position(|window| window == text.as_bytes())?;
    bytes.get_mut(offset..offset + text.len())?.fill(0);
    Some(offset)
}

/// An entry of the export section: its name, its kind, and the index of the exported item.
struct Export<'a> {
    entry: &'a [u8],
    name: &'a [u8],
    kind: u8,
    index: usize,
}

fn exports(section: &[u8]) -> Option<Vec<Export<'_>>> {
    let (count, mut offset) = number_at(section, 0)?;
    let mut exports = Vec::new();
    for _ in 0..count {
        let begin = offset;
        let (length, name) = number_at(section, offset)?;
        let end = name.checked_add(length)?;
        let kind = *section.get(end)?;
        let index;
        (index, offset) = number_at(section, end + 1)?;
        exports.push(Export {
            entry: section.get(begin..offset)?,
            name: section.get(name..end)?,
            kind,
            index,
        });
    }
    Some(exports)
}

/// Counts the imported functions. An import is the name of a module, a name, a kind, and a type.
fn imported_functions(section: &[u8]) -> Option<usize> {
    let (count, mut offset) = number_at(section, 0)?;
    let mut functions = 0;
    for _ in 0..count {
        for _ in 0..2 {
            let (length, name) = number_at(section, offset)?;
            offset = name.checked_add(length)?;
        }
        let kind = *section.get(offset)?;
        // The type of a table begins with its element type; a global has a value type and a
        // mutability flag.
        offset += if kind == TABLE { 2 } else { 1 };
        if matches!(kind, TABLE | MEMORY) {
            let (flags, minimum) = number_at(section, offset)?;
            offset = number_at(section, minimum)?.1;
            if flags & 1 == 1 {
                offset = number_at(section, offset)?.1;
            }
        } else if kind == FUNCTION {
            functions += 1;
            offset = number_at(section, offset)?.1;
        } else {
            offset += 2;
        }
    }
    Some(functions)
}

/// Returns the bodies of the code section, each with its length.
fn bodies(section: &[u8]) -> Option<Vec<&[u8]>> {
    let (count, mut offset) = number_at(section, 0)?;
    let mut bodies = Vec::new();
    for _ in 0..count {
        let begin = offset;
        let (length, body) = number_at(section, offset)?;
        offset = body.checked_add(length)?;
        bodies.push(section.get(begin..offset)?);
    }
    Some(bodies)
}

/// Appends a section of `count` entries.
fn push_section<'a>(bytes: &mut Vec<u8>, id: u8, count: usize, entries: impl Iterator<Item = &'a [u8]>) {
    let mut content = Vec::new();
    push_number(&mut content, count);
    entries.for_each(|entry| content.extend(entry));
    bytes.push(id);
    push_number(bytes, content.len());
    bytes.extend(content);
}

/// Returns the unsigned LEB128 number at `offset`, and the offset after it.
fn number_at(bytes: &[u8], mut offset: usize) -> Option<(usize, usize)> {
    let mut number = 0;
    for shift in (0..32).step_by(7) {
        let byte = *bytes.get(offset)?;
        offset += 1;
        number |= usize::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some((number, offset));
        }
    }
    None
}

/// Appends a number as unsigned LEB128.
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
        for (id, content) in sections {
            bytes.push(*id);
            push_number(&mut bytes, content.len());
            bytes.extend(*content);
        }
        bytes
    }

    #[test]
    fn unused_sections_and_bodies_are_removed() {
        let long = [1; 300];
        let whole = module(&[
            (0, b"\x04name..."),
            (1, &long),
            (2, b"\x03\x01m\x03now\x00\x07\x01m\x01t\x01\x70\x01\x01\x80\x01\x01m\x01g\x03\x7f\x00"),
            (7, b"\x04\x04room\x00\x05\x0a__describe\x00\x81\x01\x15__wbindgen_describe_f\x00\x02\x06memory\x02\x00"),
            (10, b"\x03\x02\x00\x0b\x05\x00abc\x0b\x03\x00d\x0b"),
            (11, b"..a text of the page too.."),
        ]);
        let stripped = strip(&whole, &["a text of the page too", "another"]).unwrap();
        let expected = module(&[
            (1, &long),
            (2, b"\x03\x01m\x03now\x00\x07\x01m\x01t\x01\x70\x01\x01\x80\x01\x01m\x01g\x03\x7f\x00"),
            (7, b"\x02\x04room\x00\x05\x06memory\x02\x00"),
            // The second body is function 2, after one imported function.
            (10, b"\x03\x02\x00\x0b\x03\x00\x00\x0b\x03\x00d\x0b"),
            (11, b"..\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0.."),
        ]);
        assert_eq!(stripped.bytes, expected);
        assert_eq!(stripped.text_offsets, [Some(expected.len() - 24), None]);
    }

    #[test]
    fn invalid_modules_are_refused() {
        assert_eq!(strip(b"", &[]), None);
        assert_eq!(strip(b"MZ......", &[]), None);
        let whole = module(&[(7, b"\x02\x04room\x00\x05")]);
        assert_eq!(strip(&whole, &[]), None, "fewer exports than counted");
        assert_eq!(strip(&whole[..whole.len() - 1], &[]), None, "cut off");
    }
}
