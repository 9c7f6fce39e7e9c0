//! A compiled module without what a browser does not need, so that a page is small.
//!
//! A module is its magic, its version, and sections: a number, a length, the content (WebAssembly core specification,
//! chapter 5.5). Custom sections (names, notes for bindgen) are left out, and of the exports all but the engine's own. The
//! libraries that `report.html` holds are in the module as text, and in the configurator's page, too: they become holes,
//! filled with zeros, which the worker fills again from the page before the module is compiled.

use std::ops::Range;

/// What the page asks the module for.
const EXPORTS: [&str; 4] = ["memory", "room", "answer", "free"];
const CUSTOM: u8 = 0;
const EXPORT: u8 = 7;
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
    while let Some(&number) = module.get(place) {
        let (length, content) = number_at(module, place + 1)?;
        let end = content.checked_add(length)?;
        let section = module.get(content..end)?;
        match number {
            CUSTOM => {}
            EXPORT => {
                let kept = exports(section)?;
                bytes.push(EXPORT);
                push_number(&mut bytes, kept.len());
                bytes.extend(kept);
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

/// The export section with the engine's own exports only: a name, a kind and an index each.
fn exports(section: &[u8]) -> Option<Vec<u8>> {
    let (count, mut place) = number_at(section, 0)?;
    let mut kept: Vec<Range<usize>> = Vec::new();
    for _ in 0..count {
        let begin = place;
        let (length, name) = number_at(section, place)?;
        let end = name.checked_add(length)?;
        let is_own = EXPORTS.iter().any(|own| section.get(name..end) == Some(own.as_bytes()));
        place = number_at(section, end + 1)?.1;
        if is_own {
            kept.push(begin..place);
        }
    }
    let mut slim = Vec::new();
    push_number(&mut slim, kept.len());
    kept.into_iter().for_each(|range| slim.extend(section.get(range).unwrap_or_default()));
    Some(slim)
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
            (7, b"\x03\x04room\x00\x05\x0a__describe\x00\x81\x01\x06memory\x02\x00"),
            (11, b"..a text that stands twice.."),
        ]);
        let made = slim(&whole, &["a text that stands twice", "elsewhere"]).unwrap();
        let expected = module(&[
            (1, &long),
            (7, b"\x02\x04room\x00\x05\x06memory\x02\x00"),
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
