//! The encoding of a text: UTF-8, UTF-16 or a legacy one.

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
use pinswitch_diagnostic::{Diagnostic, codes};

/// Bytes in which a text without a mark is examined for UTF-16.
const SAMPLE: usize = 4096;

/// Decodes a text; returns it without its mark, and the name of its encoding.
///
/// `label` is an encoding that the user named.
///
/// # Errors
/// A [`Diagnostic`] for an unknown label, and for bytes that are not text.
pub(crate) fn decode(bytes: &[u8], label: Option<&str>) -> Result<(String, String), Diagnostic> {
    let (encoding, has_mark) = match label {
        Some(label) => {
            let encoding = Encoding::for_label(label.as_bytes()).ok_or_else(|| {
                Diagnostic::new(codes::UNKNOWN_WORD, format!("encoding: unknown encoding '{label}'"))
                    .with_help("use a name such as utf-8, utf-16le, iso-8859-1 or windows-1252")
            })?;
            (encoding, false)
        }
        None => match Encoding::for_bom(bytes) {
            Some((encoding, _)) => (encoding, true),
            None => (detect(bytes), false),
        },
    };
    let (text, _, has_errors) = encoding.decode(bytes);
    if text.contains('\0') {
        return Err(binary("contains NUL bytes"));
    }
    if has_errors && label.is_some() {
        return Err(Diagnostic::new(codes::NOT_A_TEXT, format!("the text is not {}", encoding.name()))
            .with_help("leave out the encoding, or name another one"));
    }
    let name = if has_mark { format!("{} with mark", encoding.name()) } else { encoding.name().to_owned() };
    Ok((text.into_owned(), name))
}

fn binary(problem: &str) -> Diagnostic {
    Diagnostic::new(codes::NOT_A_TEXT, format!("{problem}: this is not a text"))
        .with_help("export the data as CSV, or give an LVM, Excel, OpenDocument or Parquet file")
}

/// Returns the most probable encoding of bytes without a mark.
fn detect(bytes: &[u8]) -> &'static Encoding {
    let sample = &bytes[..bytes.len().min(SAMPLE)];
    let zeros = |first: usize| sample.iter().skip(first).step_by(2).filter(|b| **b == 0).count();
    let half = sample.len() / 2;
    // Numbers in UTF-16 have a zero in every second byte.
    let may_be_utf16 = bytes.len() >= 8 && bytes.len().is_multiple_of(2);
    if may_be_utf16 && zeros(1) * 4 > half * 3 && zeros(0) * 4 < half {
        return UTF_16LE;
    }
    if may_be_utf16 && zeros(0) * 4 > half * 3 && zeros(1) * 4 < half {
        return UTF_16BE;
    }
    if std::str::from_utf8(bytes).is_ok() {
        return UTF_8;
    }
    // Degree, micro, squares and umlauts of western Europe: too few letters for the detector.
    let is_western = |b: &u8| {
        b.is_ascii()
            || b"\xa0\xb0\xb1\xb2\xb3\xb5\xb7\xe4\xf6\xfc\xc4\xd6\xdc\xdf\xe9\xe8\xf3\xed\xe1\xf1\xe0"
                .contains(b)
    };
    if bytes.iter().all(is_western) {
        return WINDOWS_1252;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(&bytes[..bytes.len().min(1 << 20)], true);
    detector.guess(None, Utf8Detection::Deny)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_encodings_are_recognised() {
        let text = "Zeit [µs];Kraft (°)\n1,5;2\n";
        let utf16 = |big: bool, mark: bool| -> Vec<u8> {
            let units = mark.then_some(0xfeff).into_iter().chain(text.encode_utf16());
            units.flat_map(|u| if big { u.to_be_bytes() } else { u.to_le_bytes() }).collect()
        };
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        let cases = [
            (text.as_bytes().to_vec(), "UTF-8"),
            ([b"\xef\xbb\xbf", text.as_bytes()].concat(), "UTF-8 with mark"),
            (utf16(false, true), "UTF-16LE with mark"),
            (utf16(true, true), "UTF-16BE with mark"),
            (utf16(false, false), "UTF-16LE"),
            (utf16(true, false), "UTF-16BE"),
            (latin, "windows-1252"),
        ];
        for (bytes, name) in cases {
            assert_eq!(decode(&bytes, None).unwrap(), (text.to_owned(), name.to_owned()));
        }
        assert!(decode(b"a\0b", None).is_err());
        assert!(decode(b"a", Some("klingon")).is_err());
    }
}
