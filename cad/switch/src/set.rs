//! A complete set in memory, so that nothing is written unless all files can be made.

use crate::built::Built;
use crate::documents::{FileEntry, Manifest, PrintEntry, SourceEntry, plate_entries};
use crate::formats::Format;
use crate::measured::Comparison;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use pinswitch_solid::verification::Verification;

/// Name of the file that lists a set. A folder without it does not contain a complete set.
pub const MANIFEST: &str = "manifest.json";

/// A set of parts with its documents.
#[derive(Clone, Debug)]
pub struct Set {
    /// The manifest.
    pub manifest: Manifest,
    /// All files, the manifest last.
    pub files: Vec<OutputFile>,
}

impl Set {
    /// Makes the files of a built design in these formats, in the given order, and the manifest.
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
    /// [`SetError`] of the first file that cannot be made.
    pub fn new(built: &Built, prediction: &Prediction, formats: &[&Format]) -> Result<Self, SetError> {
        let mut files = Vec::new();
        let parts = built.printed().iter().map(|p| (p.part(), &p.facts));
        let mut manifest = Manifest::new(built.design(), parts, prediction);
        for format in formats {
            // A format may list the files of the formats before it.
            let made = (format.make)(built, prediction, &manifest)?;
            manifest.files.extend(made.iter().map(FileEntry::of));
            if made.iter().any(|file| file.name.ends_with(".3mf")) {
                manifest.plates = plate_entries(built);
            }
            files.extend(made);
        }
        files.push(OutputFile::new(MANIFEST, manifest.bytes()?));
        Ok(Self { manifest, files })
    }

    /// The same set with its configuration in the manifest.
    ///
    /// # Errors
    /// As [`Manifest::bytes`].
    pub fn made_from(mut self, source: SourceEntry) -> Result<Self, SetError> {
        self.manifest.source = Some(source);
        self.with_manifest()
    }

    /// The same set with the SHA-256 of the model file of its curve in the manifest, in hexadecimal digits.
    ///
    /// # Errors
    /// As [`Manifest::bytes`].
    pub fn predicted_from(mut self, model_sha256: String) -> Result<Self, SetError> {
        self.manifest.friction.model_sha256 = Some(model_sha256);
        self.with_manifest()
    }

    /// The same set, whose curve is that of the made switch: with the comparison in the manifest and in MEASURED.md.
    ///
    /// # Errors
    /// As [`Manifest::bytes`].
    pub fn measured(mut self, comparison: Comparison) -> Result<Self, SetError> {
        let text = comparison.text();
        self.manifest.measured = Some(comparison);
        self.with_file(OutputFile::new("MEASURED.md", text.into_bytes()))
    }

    /// The same set with print time, filament and files of a slicer.
    ///
    /// # Errors
    /// As [`Manifest::bytes`].
    pub fn sliced(mut self, print: PrintEntry, files: Vec<OutputFile>) -> Result<Self, SetError> {
        self.manifest.print = Some(print);
        self.manifest.files.extend(files.iter().map(FileEntry::of));
        self.files.extend(files);
        self.with_manifest()
    }

    /// The same set with another file.
    ///
    /// # Errors
    /// As [`Manifest::bytes`].
    pub fn with_file(mut self, file: OutputFile) -> Result<Self, SetError> {
        self.manifest.files.push(FileEntry::of(&file));
        self.files.push(file);
        self.with_manifest()
    }

    /// The same set, whose manifest records the agreement of its parts with a second kernel, in the order of the parts.
    ///
    /// # Errors
    /// As [`Manifest::bytes`].
    pub fn verified(mut self, verifications: Vec<Verification>) -> Result<Self, SetError> {
        for (entry, verification) in self.manifest.parts.iter_mut().zip(verifications) {
            entry.verification = Some(verification);
        }
        self.with_manifest()
    }

    /// Writes the manifest again, as the last file.
    fn with_manifest(mut self) -> Result<Self, SetError> {
        self.files.retain(|file| file.name != MANIFEST);
        self.files.push(OutputFile::new(MANIFEST, self.manifest.bytes()?));
        Ok(self)
    }
}
