//! The file formats of a set. A format is a module and a line in the list below.

mod markdown;

use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_solid::render::{Body, View, render};

pub use curve::curve_files;

/// Makes the files of a format. The manifest lists the files of the formats before it.
pub type Make = fn(&Built, &Prediction, &Manifest) -> Result<Vec<OutputFile>, SetError>;

/// The sets that include a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inclusion {
    /// Every set. The format cannot be selected on the command line.
    Always,
    /// Sets without named formats.
    Default,
    /// Sets that name the format.
    Named,
}

/// A file format of a set.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Name on the command line.
    pub name: &'static str,
    /// Description in the help.
    pub about: &'static str,
    /// Sets that include it.
    pub inclusion: Inclusion,
    /// Makes the files.
    pub make: Make,
}

/// Declares the modules of the formats, and the list of the formats.
macro_rules! formats {
    ($($file:ident,)*) => {
        $(pub mod $file;)*

        /// All formats, in the order of a set. The page is last, since it shows the list of files.
        pub const FORMATS: &[Format] = &[$($file::FORMAT),*];
    };
}

formats! {
    stl,
    curve,
    three_mf,
    step,
    glb,
    drawing,
    dxf,
    rig,
    guide,
    manual,
    page,
}

/// The name of all formats together.
pub const ALL: &str = "all";

/// Returns the formats with these names and those of every set, in the order of [`FORMATS`].
///
/// # Errors
/// A [`Diagnostic`] that lists the known names.
pub fn named(names: &[&str]) -> Result<Vec<&'static Format>, Diagnostic> {
    let known = || FORMATS.iter().filter(|f| f.inclusion != Inclusion::Always).map(|f| f.name);
    if let Some(unknown) = names.iter().find(|n| **n != ALL && !known().any(|k| k == **n)) {
        return Err(Diagnostic::new(codes::UNSUPPORTED_FORMAT, format!("unknown format {unknown}"))
            .with_help(format!("use {}", known().collect::<Vec<_>>().join(", "))));
    }
    let is_included =
        |f: &&Format| f.inclusion == Inclusion::Always || names.contains(&ALL) || names.contains(&f.name);
    Ok(FORMATS.iter().filter(is_included).collect())
}

/// Returns the names of the formats of a set for which none is named.
pub fn default_names() -> Vec<&'static str> {
    FORMATS.iter().filter(|f| f.inclusion == Inclusion::Default).map(|f| f.name).collect()
}

/// Renders a picture as PNG.
fn png(bodies: &[Body], view: View, width: u32, height: u32) -> Result<Vec<u8>, SetError> {
    render(bodies, view, width, height).png().map_err(SetError::encoding)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_ordered_and_include_the_curve() {
        let names = |names: &[&str]| -> Vec<&str> { named(names).unwrap().iter().map(|f| f.name).collect() };
        assert_eq!(names(&["page", "stl"]), ["stl", "curve", "page"]);
        assert_eq!(names(&[]), ["curve"]);
        assert_eq!(names(&[ALL]).len(), FORMATS.len());
        let error = named(&["curve"]).unwrap_err();
        assert_eq!(error.problem(), "unknown format curve");
        assert!(error.help().is_some_and(|help| help.starts_with("use stl, 3mf")), "{error}");
    }
}
