//! Every code with its page, by subject.
//!
//! A code is for a kind of fault, not for a place in the program: two places share it if a reader would want the same
//! explanation. `pinswitch explain` prints a page, and `cad/doc/diagnostics.md` lists all of them.

use crate::code::{Area, Code, Page};

/// Declares the codes of an area: the constant, the name, the title, the document with more about it, and the
/// paragraphs of its page.
macro_rules! pages {
    ($area:literal; $($code:ident: $name:literal, $title:literal $(, in $document:literal)? {
        $first:literal $(, $next:literal)* $(,)?
    })*) => {
        $(
            #[doc = concat!($title, ".")]
            pub const $code: super::Code = super::Code::new($name);
        )*

        /// The codes of this file.
        pub(super) const AREA: super::Area = super::Area {
            title: $area,
            codes: &[$($code),*],
            pages: &[$(super::Page {
                title: $title,
                text: concat!($first $(, "\n\n", $next)*),
                document: super::document(&[$($document)?]),
            }),*],
        };
    };
}

mod batch;
mod calibration;
mod configuration;
mod files;
mod formulas;
mod import;
mod measured;
mod mould;
mod mounting;
mod parts;
mod prediction;
mod printing;
mod program;
mod segmentation;
mod shell;
mod supports;

pub use batch::*;
pub use calibration::*;
pub use configuration::*;
pub use files::*;
pub use formulas::*;
pub use import::*;
pub use measured::*;
pub use mould::*;
pub use mounting::*;
pub use parts::*;
pub use prediction::*;
pub use printing::*;
pub use program::*;
pub use segmentation::*;
pub use shell::*;
pub use supports::*;

/// Every area, in the order of the document.
pub(crate) const AREAS: &[Area] = &[
    configuration::AREA,
    files::AREA,
    shell::AREA,
    supports::AREA,
    mould::AREA,
    mounting::AREA,
    printing::AREA,
    parts::AREA,
    prediction::AREA,
    batch::AREA,
    measured::AREA,
    segmentation::AREA,
    import::AREA,
    formulas::AREA,
    calibration::AREA,
    program::AREA,
];

/// Returns the code of a message of the TOML reader.
pub fn of_toml(message: &str) -> Code {
    let kinds = [
        ("unknown field", UNKNOWN_FIELD),
        ("missing field", MISSING_FIELD),
        ("unknown variant", UNKNOWN_WORD),
        ("invalid type", WRONG_TYPE),
        ("invalid length", WRONG_TYPE),
        ("invalid value", WRONG_TYPE),
    ];
    kinds.iter().find(|(start, _)| message.starts_with(start)).map_or(INVALID_TOML, |(_, code)| *code)
}

/// Returns the only document of a list of at most one.
const fn document(documents: &[&'static str]) -> Option<&'static str> {
    match documents {
        [document, ..] => Some(document),
        [] => None,
    }
}
