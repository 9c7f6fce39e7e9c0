//! The files of a set: one file per format, and one line of the list below.

mod markdown;

use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use pinswitch_solid::render::{Body, View, render};

pub use curve::curve_files;

/// Makes the files of a format; the manifest lists the files made before it.
pub type Make = fn(&Built, &Prediction, &Manifest) -> Result<Vec<OutputFile>, SetError>;

/// When a format is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inclusion {
    /// In every set; it has no name on the command line.
    Always,
    /// Unless other formats are named.
    Default,
    /// Only when it is named.
    Named,
}

/// A file format of a set.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, for the help.
    pub about: &'static str,
    /// When it is made.
    pub inclusion: Inclusion,
    /// Makes its files.
    pub make: Make,
}

/// Declares the files of the formats and the registry of what they hold.
macro_rules! formats {
    ($($file:ident,)*) => {
        $(pub mod $file;)*

        /// Every format, in the order in which a set is made and listed. The page comes last: it shows the list.
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
    guide,
    page,
}

/// The name that stands for every format.
pub const ALL: &str = "all";

/// The formats called `names`, with those that are always made, in the order of [`FORMATS`].
///
/// # Errors
/// A message that lists the known names.
pub fn named(names: &[&str]) -> Result<Vec<&'static Format>, String> {
    let known = || FORMATS.iter().filter(|f| f.inclusion != Inclusion::Always).map(|f| f.name);
    if let Some(unknown) = names.iter().find(|n| **n != ALL && !known().any(|k| k == **n)) {
        return Err(format!(
            "{unknown} is no known format; known are {}",
            known().collect::<Vec<_>>().join(", ")
        ));
    }
    let is_wanted =
        |f: &&Format| f.inclusion == Inclusion::Always || names.contains(&ALL) || names.contains(&f.name);
    Ok(FORMATS.iter().filter(is_wanted).collect())
}

/// A picture as PNG.
fn png(bodies: &[Body], view: View, width: u32, height: u32) -> Result<Vec<u8>, SetError> {
    render(bodies, view, width, height).png().map_err(SetError::encoding)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_come_in_their_order_with_the_curve() {
        let names =
            |wanted: &[&str]| -> Vec<&str> { named(wanted).unwrap().iter().map(|f| f.name).collect() };
        assert_eq!(names(&["page", "stl"]), ["stl", "curve", "page"]);
        assert_eq!(names(&[]), ["curve"]);
        assert_eq!(names(&[ALL]).len(), FORMATS.len());
        assert!(named(&["curve"]).unwrap_err().starts_with("curve is no known format; known are stl, 3mf"));
    }
}
