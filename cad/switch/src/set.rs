//! A whole set in memory: nothing is written before everything is known to be right.

use crate::built::{BuildError, Built};
use crate::documents::{FileEntry, Manifest};
use crate::formats::Format;
use crate::prediction::Prediction;
use pinswitch_plot::PlotError;

/// A file to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFile {
    /// Its name in the folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl OutputFile {
    /// A file of these bytes.
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}

/// A set of parts with its curve, ready to be written; the manifest is the last file.
#[derive(Clone, Debug)]
pub struct Set {
    /// What the set holds.
    pub manifest: Manifest,
    /// The files, the manifest last.
    pub files: Vec<OutputFile>,
}

/// Why a set cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// A part cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The plot cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file cannot be put together.
    #[error("cannot put a file together: {0}")]
    Encoding(String),
}

impl SetError {
    /// A file that cannot be put together, for this reason.
    pub fn encoding(error: impl std::fmt::Display) -> Self {
        Self::Encoding(error.to_string())
    }
}

impl Set {
    /// The files of `built` in these formats, in the order given, and the manifest.
    ///
    /// ```
    /// use pinswitch_switch::{built::Built, config::Configuration, design::Design};
    /// use pinswitch_switch::{formats::named, prediction::Prediction, set::Set};
    ///
    /// let built = Built::new(Design::new(Configuration::default())?)?;
    /// let prediction = Prediction::of(built.design());
    /// let set = Set::new(&built, &prediction, &named(&["stl"])?)?;
    /// assert_eq!(set.files[0].name, "shell.stl");
    /// assert_eq!(set.files.last().unwrap().name, "manifest.json");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SetError`]; nothing is returned if one of them cannot be made.
    pub fn new(built: &Built, prediction: &Prediction, formats: &[&Format]) -> Result<Self, SetError> {
        let mut files = Vec::new();
        let parts = built.printed().iter().map(|p| (p.part(), &p.facts));
        let mut manifest = Manifest::new(built.design(), parts, prediction);
        for format in formats {
            // A format may list what was made before it: the manifest always lists the files so far.
            let made = (format.make)(built, prediction, &manifest)?;
            manifest.files.extend(made.iter().map(FileEntry::of));
            files.extend(made);
        }
        files.push(OutputFile::new("manifest.json", manifest.bytes()?));
        Ok(Self { manifest, files })
    }
}
