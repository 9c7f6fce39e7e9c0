//! The ZIP archive of a package: its parts by name, with a bound on the bytes that are unpacked.

use std::collections::HashMap;
use std::io::{Cursor, Read};

use pinswitch_diagnostic::excerpt;
use zip::CompressionMethod;
use zip::ZipArchive;
use zip::result::ZipError;

use super::error::ThreeMfReadError;
use super::part_name::normalized;
use super::xml::MAX_NAME_BYTES;

/// Longest message of a library that an error repeats, in characters.
const MAX_CHARACTERS: usize = 200;
/// Bytes that any archive may unpack to.
const FREE_BYTES: u64 = 8 << 20;
/// Bytes that an archive may unpack to for each of its own: the models of programs unpack to 4 to 12
/// times their size, and endless zeros to a thousand times.
const BYTES_PER_BYTE: u64 = 16;
/// Tags of XML that any archive may have, and bytes of the archive for each further one: meshes of programs have one for 5 to 8
/// bytes, a mesh that repeats one triangle a hundred for one.
const FREE_TAGS: usize = 200_000;
const BYTES_PER_TAG: usize = 4;
/// Most bytes that an archive may unpack to.
const MAX_BYTES: u64 = 1 << 30;
/// Bytes by which the format of a picture is recognised.
const BEGINNING: u64 = 16;
/// Length of the header of an entry in the central directory without name, extra field and comment, and the place of the lengths
/// of these three in it (APPNOTE 4.3.12).
const HEADER_BYTES: usize = 46;
const LENGTHS: std::ops::Range<usize> = 28..34;
/// Most entries of an archive.
const MAX_ENTRIES: usize = 10_000;

/// The parts of a package, by name.
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// Index of each part, by its normalized name.
    parts: HashMap<String, usize>,
    /// Names of the parts, in the order of the archive.
    names: Vec<String>,
    /// Names that are equivalent to an earlier one.
    repeated: Vec<String>,
    /// Whether several entries have exactly the same name; the others are not read.
    is_repeated: bool,
    /// Bytes that may still be unpacked.
    left: u64,
    /// Bytes that may be unpacked in all.
    most: u64,
    /// Tags that the texts may still have.
    tags_left: usize,
    /// Tags that the texts may have in all.
    most_tags: usize,
}

/// The number of headers in the central directory, at most one more than `most`.
fn headers(bytes: &[u8], zip: &ZipArchive<Cursor<&[u8]>>, most: usize) -> usize {
    let start = usize::try_from(zip.central_directory_start()).unwrap_or(usize::MAX);
    let mut rest = bytes.get(start..).unwrap_or_default();
    let mut number = 0;
    while number <= most && rest.starts_with(b"PK\x01\x02") {
        number += 1;
        let lengths = rest.get(LENGTHS).unwrap_or_default().chunks_exact(2);
        let variable: usize = lengths.map(|pair| usize::from(u16::from_le_bytes([pair[0], pair[1]]))).sum();
        rest = rest.get(HEADER_BYTES + variable..).unwrap_or_default();
    }
    number
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ThreeMfReadError> {
        // The library's own messages name its internals.
        let damaged = || ThreeMfReadError::Archive("it is truncated or damaged".to_owned());
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|_| damaged())?;
        if zip.len() > MAX_ENTRIES {
            return Err(ThreeMfReadError::Bound(format!(
                "the ZIP archive has more than {MAX_ENTRIES} entries"
            )));
        }
        let (mut parts, mut names, mut repeated) = (HashMap::new(), Vec::new(), Vec::new());
        for i in 0..zip.len() {
            let name = zip.name_for_index(i).transpose().map_err(|_| damaged())?.unwrap_or_default();
            if name.len() > MAX_NAME_BYTES {
                return Err(ThreeMfReadError::Bound(format!(
                    "the ZIP archive has a name of more than {MAX_NAME_BYTES} bytes"
                )));
            }
            if name.ends_with('/') {
                continue;
            }
            if parts.insert(normalized(&name), i).is_some() {
                repeated.push(name.clone().into_owned());
            }
            names.push(name.into_owned());
        }
        // The library keeps the last of several entries of one name.
        let is_repeated = headers(bytes, &zip, zip.len()) > zip.len();
        let most = MAX_BYTES.min(FREE_BYTES + BYTES_PER_BYTE * bytes.len() as u64);
        let most_tags = FREE_TAGS + bytes.len() / BYTES_PER_TAG;
        Ok(Self {
            zip,
            parts,
            names,
            repeated,
            is_repeated,
            left: most,
            most,
            tags_left: most_tags,
            most_tags,
        })
    }

    /// Names of parts that are equivalent to an earlier one.
    pub(super) fn repeated(&self) -> &[String] {
        &self.repeated
    }

    /// Whether several entries have exactly the same name.
    pub(super) fn is_repeated(&self) -> bool {
        self.is_repeated
    }

    /// Names of all parts, in the order of the archive.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Names of parts that are compressed with another method than Deflate.
    pub(super) fn unusual(&mut self) -> Vec<String> {
        let usual = [CompressionMethod::Stored, CompressionMethod::Deflated];
        let mut unusual = Vec::new();
        for i in 0..self.zip.len() {
            if let Ok(file) = self.zip.by_index_raw(i)
                && !usual.contains(&file.compression())
            {
                unusual.push(String::from_utf8_lossy(file.name_raw()).into_owned());
            }
        }
        unusual
    }

    /// The first bytes of a part; `None` if it cannot be read.
    pub(super) fn beginning(&mut self, part: &str) -> Option<Vec<u8>> {
        let index = self.parts.get(&normalized(part))?;
        let mut bytes = Vec::new();
        self.zip.by_index(*index).ok()?.take(BEGINNING).read_to_end(&mut bytes).ok()?;
        Some(bytes)
    }

    /// Whether the package has a part of an equivalent name.
    pub(super) fn contains(&self, part: &str) -> bool {
        self.parts.contains_key(&normalized(part))
    }

    /// The name of a part as the archive has it.
    pub(super) fn name(&self, part: &str) -> String {
        let index = self.parts.get(&normalized(part));
        let name = index.and_then(|i| self.zip.name_for_index(*i)).and_then(Result::ok);
        name.map_or_else(|| part.to_owned(), |name| name.into_owned())
    }

    /// Returns a part as text; `None` if the package has no part of that name.
    pub(super) fn text(&mut self, part: &str) -> Result<Option<String>, ThreeMfReadError> {
        let damaged =
            || ThreeMfReadError::Archive(format!("{} in it is damaged", excerpt(part, MAX_CHARACTERS)));
        let Some(index) = self.parts.get(&normalized(part)) else { return Ok(None) };
        let file = match self.zip.by_index(*index) {
            Ok(file) => file,
            Err(ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED)) => {
                return Err(ThreeMfReadError::Unsupported(format!("{part} is encrypted")));
            }
            Err(ZipError::UnsupportedArchive(_)) => {
                let problem = format!("the compression method of {part} is not supported");
                return Err(ThreeMfReadError::Unsupported(problem));
            }
            Err(_) => return Err(damaged()),
        };
        let too_long = || {
            let most = self.most;
            ThreeMfReadError::Bound(format!(
                "the ZIP archive unpacks to more than {most} bytes, {BYTES_PER_BYTE} for each of its own"
            ))
        };
        if file.size() > self.left {
            return Err(too_long());
        }
        let mut bytes = Vec::new();
        file.take(self.left + 1).read_to_end(&mut bytes).map_err(|_| damaged())?;
        let Some(left) = self.left.checked_sub(bytes.len() as u64) else { return Err(too_long()) };
        self.left = left;
        let tags = bytes.iter().filter(|byte| **byte == b'<').count();
        self.tags_left = self.tags_left.checked_sub(tags).ok_or_else(|| {
            ThreeMfReadError::Bound(format!(
                "the models have more than {} XML tags, one for {BYTES_PER_TAG} bytes of the file",
                self.most_tags
            ))
        })?;
        String::from_utf8(bytes).map(Some).map_err(|_| malformed(part, "not UTF-8"))
    }
}

/// The error of a part that is not what it should be.
pub(super) fn malformed(part: &str, problem: &str) -> ThreeMfReadError {
    ThreeMfReadError::Malformed {
        part: excerpt(part, MAX_CHARACTERS),
        problem: excerpt(problem, MAX_CHARACTERS),
    }
}
