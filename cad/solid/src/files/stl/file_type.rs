//! Recognition of other formats by their first bytes (magic numbers).

use super::ascii::is_ascii;

/// Signatures and the names of their formats.
const SIGNATURES: [(&[u8], &str); 25] = [
    (b"PK\x03\x04", "a ZIP archive, such as 3MF"),
    (b"PK\x05\x06", "an empty ZIP archive"),
    (b"\x1f\x8b", "compressed with gzip"),
    (b"ISO-10303-21;", "a STEP file"),
    (b"ply\n", "a PLY file"),
    (b"ply\r\n", "a PLY file"),
    (b"glTF", "a glTF file"),
    (b"AutoCAD Binary DXF", "a binary DXF drawing"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"RIFF", "a WebP picture, a sound or a film"),
    (b"%PDF", "a PDF document"),
    (b"\x7fELF", "a program"),
    (b"\xcf\xfa\xed\xfe", "a program"),
    (b"\0asm", "a WebAssembly module"),
    (b"\x28\xb5\x2f\xfd", "compressed with zstd"),
    (b"\xfd7zXZ", "compressed with xz"),
    (b"7z\xbc\xaf", "a 7z archive"),
    (b"BZh", "compressed with bzip2"),
    (b"Rar!", "a RAR archive"),
    (b"SQLite format 3", "a database"),
    (b"PAR1", "a Parquet table"),
    (b"\xff\xfe", "a text in UTF-16"),
    (b"\xfe\xff", "a text in UTF-16"),
];
/// Signatures that may also begin the header of a binary STL.
const WEAK_SIGNATURES: [(&[u8], &str); 2] = [(b"MZ", "a program"), (b"BM", "a BMP picture")];

/// Returns the name of the format of a file that begins with `head`, if that cannot be an STL.
///
/// A binary STL begins with 80 bytes of any content. Where the file is as long as a binary header
/// announces (`fits`), only signatures count that no program writes there.
pub(super) fn other_format(head: &[u8], fits: bool) -> Option<&'static str> {
    let among = |list: &[(&[u8], &'static str)]| {
        list.iter().find(|(signature, _)| head.starts_with(signature)).map(|(_, name)| *name)
    };
    if let Some(name) = among(&SIGNATURES) {
        return Some(name);
    }
    if !fits && let Some(name) = among(&WEAK_SIGNATURES) {
        return Some(name);
    }
    let text = std::str::from_utf8(head).ok().or_else(|| {
        // The head may end within a character.
        head.get(..head.len().saturating_sub(3)).and_then(|whole| std::str::from_utf8(whole).ok())
    })?;
    // A binary STL has a zero in its count of facets unless it is longer than any file that is
    // read.
    if text.contains('\0') {
        return None;
    }
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let mut lines = text.lines().map(str::trim);
    let (first, second) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    let is_object = |line: &str| {
        ["v ", "o ", "g ", "mtllib ", "vn ", "# Blender", "# OBJ"].iter().any(|begin| line.starts_with(begin))
    };
    if text.starts_with("<?xml") || text.starts_with("<svg") || text.starts_with("<!doctype") {
        Some("a text in XML, SVG or HTML")
    } else if (first == "0" && second == "SECTION") || first == "999" {
        Some("a DXF drawing")
    } else if is_object(first) || (first.starts_with('#') && is_object(second)) {
        Some("an OBJ file")
    } else if first == "OFF" {
        Some("an OFF file")
    } else if fits || is_ascii(head) || text.chars().any(|c| c.is_control() && !c.is_whitespace()) {
        None
    } else {
        Some("a text that does not begin with the word solid")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_recognised() {
        for (head, word) in [
            (&b"PK\x03\x04\x14\0\0\0"[..], "3MF"),
            (b"\x1f\x8b\x08\0", "gzip"),
            (b"ISO-10303-21;\nHEADER;", "STEP"),
            (b"0\nSECTION\n2\nHEADER", "DXF"),
            (b"  0\r\nSECTION\r\n", "DXF"),
            (b"# a cube\nv 0 0 0\n", "OBJ"),
            (b"<?xml version=\"1.0\"?>", "XML"),
            (b"\x7fELF\x02\x01\x01\0", "program"),
            (b"MZ\x90\0\x03", "program"),
            (b"[switch]\nname = \"x\"\n", "text"),
            (b"{\"a\": 1}", "text"),
            (b"series,load_N\na,3\n", "text"),
            (b"x", "text"),
        ] {
            assert!(other_format(head, false).is_some_and(|name| name.contains(word)), "{word}");
        }
    }

    #[test]
    fn an_stl_has_no_other_format() {
        for head in [
            &b"solid a\nfacet normal 0 0 1"[..],
            &[0; 84],
            b"solid",
            b"MZ by a program of this name\0\0\0",
            b"Exported from Blender\0\0\0",
            b"# made by x\0\0",
        ] {
            assert_eq!(other_format(head, true), None, "{head:?}");
        }
    }
}
