//! The code of a kind of fault, and its page.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::codes::AREAS;

/// A kind of fault: a short phrase such as `grooves-overlap`, with a page that explains it.
///
/// A code is stable: programs may compare it, while the text of a diagnostic may change. The table of all codes is
/// [`codes`](crate::codes).
///
/// ```
/// use pinswitch_diagnostic::{Code, codes};
///
/// let code = Code::from_name("grooves-overlap").unwrap();
/// assert_eq!(code, codes::GROOVES_OVERLAP);
/// assert_eq!(code.title(), "Grooves overlap");
/// ```
///
/// A code does not refer to its page: the linker leaves the pages out of a program that shows none.
#[derive(Clone, Copy)]
pub struct Code(&'static str);

/// What a code means.
#[derive(Debug)]
pub(crate) struct Page {
    pub(crate) title: &'static str,
    /// Paragraphs, separated by an empty line.
    pub(crate) text: &'static str,
    pub(crate) document: Option<&'static str>,
}

impl Area {
    /// Returns every area, in the order of the document.
    pub const fn all() -> &'static [Self] {
        AREAS
    }
}

impl Code {
    pub(crate) const fn new(name: &'static str) -> Self {
        Self(name)
    }

    fn page(self) -> Option<&'static Page> {
        let of_area =
            |area: &Area| area.codes.iter().position(|code| *code == self).map(|at| &area.pages[at]);
        AREAS.iter().find_map(of_area)
    }

    /// Returns the code with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|code| code.name() == name)
    }

    /// Returns every code, in the order of its area.
    pub fn all() -> impl Iterator<Item = Self> {
        AREAS.iter().flat_map(|area| area.codes).copied()
    }

    /// Returns the name, such as `grooves-overlap`.
    pub const fn name(self) -> &'static str {
        self.0
    }

    /// Returns the fault in one line.
    pub fn title(self) -> &'static str {
        self.page().map_or("", |page| page.title)
    }

    /// Returns the explanation: paragraphs that an empty line separates.
    pub fn text(self) -> &'static str {
        self.page().map_or("", |page| page.text)
    }

    /// Returns the path of the document of the repository with more about it.
    pub fn document(self) -> Option<&'static str> {
        self.page()?.document
    }
}

impl fmt::Debug for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Code").field(&self.name()).finish()
    }
}

impl fmt::Display for Code {
    /// Writes the name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl PartialEq for Code {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Code {}

impl Serialize for Code {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Codes of one subject.
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// Title, such as `Files and folders`.
    pub title: &'static str,
    /// Its codes.
    pub codes: &'static [Code],
    /// Their pages, in the same order.
    pub(crate) pages: &'static [Page],
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use super::*;

    #[test]
    fn names_are_unique_and_kebab_case() {
        let mut names = BTreeSet::new();
        for code in Code::all() {
            let name = code.name();
            assert!(names.insert(name), "{name}");
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{name}");
            assert!(name.starts_with(|c: char| c.is_ascii_lowercase()), "{name}");
            assert!(!name.ends_with('-') && !name.contains("--") && name.len() <= 32, "{name}");
        }
    }

    #[test]
    fn titles_are_unique_lines() {
        let titles: BTreeSet<_> = Code::all().map(Code::title).collect();
        assert_eq!(titles.len(), Code::all().count());
        for title in titles {
            assert!(title.len() <= 72 && title.starts_with(|c: char| c.is_uppercase()), "{title}");
            assert!(!title.ends_with('.') && !title.contains('\n'), "{title}");
        }
    }

    #[test]
    fn every_page_has_two_sentences() {
        for code in Code::all() {
            let sentences = code.text().split(". ").flat_map(|part| part.split(".\n")).count();
            assert!(sentences >= 2 && code.text().ends_with('.'), "{code}");
        }
    }

    #[test]
    fn pages_name_existing_files() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let is_path =
            |word: &&str| word.contains('/') && [".md", ".toml", ".rs"].iter().any(|e| word.ends_with(e));
        for code in Code::all() {
            let words = code.text().split(|c: char| c.is_whitespace() || "`(),;:".contains(c));
            let words = words.map(|word| word.trim_end_matches('.')).filter(is_path);
            for path in words.chain(code.document()) {
                assert!(root.join(path).is_file(), "{code}: {path}");
            }
        }
    }

    #[test]
    fn codes_are_found_by_name() {
        for code in Code::all() {
            assert_eq!(Code::from_name(code.name()), Some(code));
        }
        assert_eq!(Code::from_name("nonsense"), None);
    }
}
