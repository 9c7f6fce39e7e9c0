//! The configuration of a command: a file or a template, over a preset, under single values of the command line.

use std::path::{Path, PathBuf};

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_solid::files::read_three_mf;
use pinswitch_switch::config::{
    ClampedReading, Configuration, FieldLocations, Name, assign, read, read_clamped, rewritten,
    rewritten_fields, text,
};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::feasibility::{self, ParameterChange, Proposal};
use pinswitch_switch::templates;

use super::Failure;
use crate::provenance::path_from;
use crate::write::source_of_set_with;

/// Template of a command that was given no configuration.
const DEFAULT_TEMPLATE: &str = "three-double";
/// Similarity (Jaro-Winkler) from which a template is suggested for an unknown name.
const SIMILAR: f64 = 0.7;

/// Field that `--tolerance` sets.
const TOLERANCE: &str = "mesh.chord_tolerance_mm";

/// A configuration with its preset and the values that override it.
#[derive(Args, Clone, Debug)]
pub(super) struct Source {
    /// TOML file, assembly.3mf of a set (it contains its configuration), or name of a template (see `pinswitch
    /// layouts`).
    #[arg(required = true)]
    config: Option<String>,
    /// Template or file whose values the configuration overrides, such as printer-fff-0.4.
    #[arg(long, value_name = "NAME|FILE")]
    preset: Option<String>,
    /// Set one value, as in --set shell.width_mm=12; may be repeated.
    #[arg(long = "set", value_name = "TABLE.KEY=VALUE")]
    assignments: Vec<String>,
    /// Chord tolerance of the meshes in mm: largest distance from the true curves.
    #[arg(long, value_name = "MM")]
    tolerance: Option<f64>,
}

impl Source {
    /// Creates the source of this configuration alone, without preset and options.
    pub(super) fn new(config: &str) -> Self {
        Self { config: Some(config.to_owned()), preset: None, assignments: Vec::new(), tolerance: None }
    }

    fn config(&self) -> &str {
        self.config.as_deref().unwrap_or(DEFAULT_TEMPLATE)
    }

    /// Whether the command line gives a configuration, or anything that changes it.
    pub(super) fn has_arguments(&self) -> bool {
        let Self { config, preset, assignments, tolerance } = self;
        config.is_some() || preset.is_some() || !assignments.is_empty() || tolerance.is_some()
    }

    /// Returns the options that override the configuration, with the fields that they set, in the order in which they
    /// apply.
    pub(super) fn options(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let sets = self
            .assignments
            .iter()
            .filter_map(|a| a.split_once('='))
            .map(|(field, _)| ("--set", field.trim()));
        sets.chain(self.tolerance.map(|_| ("--tolerance", TOLERANCE)))
    }

    /// Returns the file of the configuration; `None` for a template.
    pub(super) fn file(&self) -> Option<PathBuf> {
        Some(PathBuf::from(self.config())).filter(|path| path.exists() && !path.is_dir())
    }

    /// Returns the same source over `preset`, unless the command line gave one.
    pub(super) fn with_preset(&self, preset: Option<&str>) -> Self {
        let preset = self.preset.clone().or_else(|| preset.map(str::to_owned));
        Self { preset, ..self.clone() }
    }

    /// Reads the configuration with everything that overrides it, and validates it.
    ///
    /// # Errors
    /// [`Failure::bad_input`] with file and line or option, field, value, bound and help.
    pub(super) fn design(&self) -> Result<Design, Failure> {
        self.load().map(|loaded| loaded.design)
    }

    /// As [`Self::design`], from bytes that were read from the file before.
    ///
    /// # Errors
    /// As [`Self::design`].
    pub(super) fn design_from(&self, bytes: Vec<u8>) -> Result<Design, Failure> {
        let (text, _) = configuration_text(bytes, self.config())?;
        self.design_of_text(&text, self.config())
    }

    /// Reads the configuration from the text of its file, with everything that overrides it.
    ///
    /// # Errors
    /// As [`Self::design`], without the rules that need a design.
    pub(super) fn configuration_from(&self, text: &str) -> Result<Configuration, Failure> {
        self.configuration_of_text(text, self.config()).map(|(configuration, _)| configuration)
    }

    /// Returns the failure of a configuration error, located at the option that set the field, or else in the file.
    pub(super) fn refusal(&self, error: &Diagnostic) -> Failure {
        Failure::bad_input(self.located(error.clone(), &FieldLocations::default(), self.config()))
    }

    /// Locates an error at the option that set its field, at the field's line, or else in the file.
    fn located(&self, error: Diagnostic, locations: &FieldLocations, file: &str) -> Diagnostic {
        let field = error.location().and_then(|location| location.field.clone()).unwrap_or_default();
        // Options override the file, and the last option the others.
        match self.options().filter(|(_, given)| *given == field).last() {
            Some((option, _)) => error.or_in_file(option),
            None => error.or_at(locations.get(&field).unwrap_or(&Location::file(file))),
        }
    }

    /// Reads the configuration with everything that overrides it.
    ///
    /// # Errors
    /// As [`Self::design`], without the rules that need a design.
    pub(super) fn configuration(&self) -> Result<Configuration, Failure> {
        let (text, file, _) = read_configuration_text(self.config())?;
        self.configuration_of_text(&text, &file).map(|(configuration, _)| configuration)
    }

    /// As [`Self::design`], with the origin of the configuration and the law of its set.
    ///
    /// # Errors
    /// As [`Self::design`].
    pub(super) fn load(&self) -> Result<LoadedDesign, Failure> {
        let (text, file, kind) = read_configuration_text(self.config())?;
        let design = self.design_of_text(&text, &file)?;
        Ok(loaded(design, &text, &file, kind))
    }

    /// As [`Self::load`], of the nearest configuration that can be built.
    ///
    /// # Errors
    /// [`Failure::bad_input`] if the configuration cannot be read, [`Failure::failed`] if no configuration can be built.
    pub(super) fn load_fixed(&self) -> Result<(LoadedDesign, Fix), Failure> {
        let (text, file, kind) = read_configuration_text(self.config())?;
        let ClampedReading { configuration, out_of_range, .. } = self.clamped_reading(&text, &file)?;
        let proposal = feasibility::repair(&configuration).map_err(Failure::failed)?;
        let proposal = proposal.unwrap_or(Proposal { configuration, changes: Vec::new() });
        let text_of_fix = fixed_text(&text, &file, &proposal.configuration).map_err(Failure::bad_input)?;
        let changes = with_clamped(&out_of_range, &proposal);
        let design = Design::new(proposal.configuration).map_err(Failure::bad_input)?;
        let fix = Fix { changes, text: text_of_fix };
        Ok((loaded(design, &text, &file, kind), fix))
    }

    fn design_of_text(&self, text: &str, file: &str) -> Result<Design, Failure> {
        let (configuration, locations) = self.configuration_of_text(text, file)?;
        let placed = |e| Failure::bad_input(self.located(e, &locations, file));
        feasibility::design(configuration).map_err(placed)
    }

    fn configuration_of_text(
        &self,
        text: &str,
        file: &str,
    ) -> Result<(Configuration, FieldLocations), Failure> {
        let reading = self.clamped_reading(text, file)?;
        match reading.out_of_range.into_iter().next() {
            Some(error) => Err(Failure::bad_input(error)),
            None => Ok((reading.configuration, reading.locations)),
        }
    }

    /// Reads the configuration; replaces each number out of its range, in the file and in the options, by the nearest
    /// one in range.
    fn clamped_reading(&self, text: &str, file: &str) -> Result<ClampedReading, Failure> {
        let base = self.preset.as_ref().map_or(Ok(Configuration::default()), |preset| {
            let (text, file) = read_text(preset)?;
            read(&text, &file).map(|(base, _)| base).map_err(Failure::bad_input)
        })?;
        let mut reading = read_clamped(base, text, file).map_err(Failure::bad_input)?;
        if !reading.locations.contains("switch.name") {
            reading.configuration.switch.name = Name::from_file_stem(file);
        }
        let sets = self.assignments.iter().map(|assignment| ("--set", assignment.clone()));
        let tolerance = self.tolerance.map(|mm| ("--tolerance", format!("{TOLERANCE}={mm:?}")));
        for (option, assignment) in sets.chain(tolerance) {
            let Err(error) = assign(&mut reading.configuration, &assignment) else { continue };
            let nearest = error.changes().first().map(|change| format!("{}={}", change.field, change.value));
            let error = error.or_in_file(option);
            match nearest.map(|nearest| assign(&mut reading.configuration, &nearest)) {
                Some(Ok(())) => reading.out_of_range.push(error),
                // The first error comes first, whatever its kind.
                _ => {
                    return Err(Failure::bad_input(reading.out_of_range.into_iter().next().unwrap_or(error)));
                }
            }
        }
        Ok(reading)
    }
}

/// Returns `text` with the values of `fixed`, in place of those out of range and those that differ.
fn fixed_text(text: &str, file: &str, fixed: &Configuration) -> Result<String, Diagnostic> {
    let written = read_clamped(Configuration::default(), text, file)?;
    let fields: Vec<String> = written.out_of_range.iter().filter_map(field).collect();
    let text = rewritten_fields(text, file, &fields, &written.configuration)?;
    rewritten(&text, file, &written.configuration, fixed)
}

/// Returns the changes of a proposal after those of values out of range, each field once.
fn with_clamped(out_of_range: &[Diagnostic], proposal: &Proposal) -> Vec<ParameterChange> {
    let mut changes: Vec<ParameterChange> = Vec::new();
    for error in out_of_range {
        let Some(field) = field(error) else { continue };
        let from = error.location().and_then(|location| location.value.clone()).unwrap_or_default();
        let to = proposal.configuration.shown(&field).unwrap_or_default();
        changes.retain(|change| change.field != field);
        changes.push(ParameterChange { field, from, to, reason: error.problem().to_owned() });
    }
    let others = proposal.changes.iter().filter(|change| changes.iter().all(|c| c.field != change.field));
    let others: Vec<ParameterChange> = others.cloned().collect();
    changes.extend(others);
    changes
}

/// Returns the field of an error.
fn field(error: &Diagnostic) -> Option<String> {
    error.location()?.field.clone()
}

/// Reads the text of a file or template; also returns its name for errors.
///
/// # Errors
/// [`Failure::bad_input`] if there is neither, or the file cannot be read.
pub(super) fn read_text(name: &str) -> Result<(String, String), Failure> {
    read_configuration_text(name).map(|(text, file, _)| (text, file))
}

/// What a configuration is read from.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Kind {
    /// A TOML file, or a template.
    Text,
    /// A 3MF that contains a configuration: the source in the manifest of its set, and the law of its curve if it was
    /// chosen.
    Package(Option<SourceEntry>, Option<String>),
}

fn read_configuration_text(name: &str) -> Result<(String, String, Kind), Failure> {
    let path = Path::new(name);
    let bare = name.strip_prefix("templates/").unwrap_or(name);
    let bare = bare.strip_suffix(".toml").unwrap_or(bare);
    // A folder with the name of a template, such as the folder of its set, does not hide the template.
    if path.exists() && !(path.is_dir() && templates::text(bare).is_some()) {
        let (text, kind) = configuration_text(crate::input::read_configuration(path)?, name)?;
        return Ok((text, name.to_owned(), kind));
    }
    templates::text(bare).map(|text| (text, name.to_owned(), Kind::Text)).ok_or_else(|| {
        let names = templates::names();
        let similarity = |a: &str| strsim::jaro_winkler(bare, a);
        let nearest = names.iter().filter(|name| similarity(name) >= SIMILAR);
        let nearest = nearest.max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
        let suggestion =
            nearest.map_or_else(String::new, |name| format!("the nearest template is {name:?}; "));
        Failure::bad_input(
            Diagnostic::new(codes::FILE_NOT_FOUND, "no such file or template")
                .with_location(Location::file(name))
                .with_help(format!("{suggestion}`pinswitch layouts` lists all templates")),
        )
    })
}

/// Returns the text of a configuration: the file itself, or the configuration in a 3MF that pinswitch wrote.
fn configuration_text(bytes: Vec<u8>, file: &str) -> Result<(String, Kind), Failure> {
    if !bytes.starts_with(b"PK") {
        let text = text(bytes, file).map_err(Failure::bad_input)?;
        if text.trim().is_empty() {
            // Valid, since every field has a default, but hardly intended.
            return Err(Failure::bad_input(
                Diagnostic::new(codes::DAMAGED_FILE, "the file is empty")
                    .with_location(Location::file(file))
                    .with_help("write a configuration with `pinswitch init`, or give a template"),
            ));
        }
        return Ok((text, Kind::Text));
    }
    let package =
        read_three_mf(&bytes).map_err(|e| Failure::bad_input(Diagnostic::from(e).or_in_file(file)))?;
    let source = source_of_set_with(Path::new(file), &bytes);
    let law = package.law;
    package.configuration.map(|text| (text, Kind::Package(source, law))).ok_or_else(|| {
        Failure::bad_input(
            Diagnostic::new(codes::OTHER_KIND_OF_FILE, "the 3MF contains no configuration")
                .with_location(Location::file(file))
                .with_help("give a TOML file, or an assembly.3mf that pinswitch wrote"),
        )
    })
}

/// The changes that make a configuration feasible, and the text of the changed configuration.
#[derive(Clone, Debug)]
pub(super) struct Fix {
    /// Each change with its reason; empty if the configuration was feasible.
    pub(super) changes: Vec<ParameterChange>,
    /// The text of the source with the changed values, and with those of preset and options.
    pub(super) text: String,
}

/// Returns a design with its origin.
fn loaded(design: Design, text: &str, file: &str, kind: Kind) -> LoadedDesign {
    let (origin, law) = match kind {
        Kind::Text => (Origin::of(file, text), None),
        Kind::Package(source, law) => {
            let from_set = source.and_then(|source| Origin::from_set(source, file));
            (from_set.unwrap_or_else(|| Origin::of_package(file, design.configuration())), law)
        }
    };
    LoadedDesign { design, origin, law }
}

/// A validated design with its origin.
#[derive(Clone, Debug)]
pub(super) struct LoadedDesign {
    pub(super) design: Design,
    pub(super) origin: Origin,
    /// Law that was chosen for the set that contains the configuration.
    pub(super) law: Option<String>,
}

/// Origin of a configuration.
#[derive(Clone, Debug)]
pub(super) enum Origin {
    /// A template of this name, or its own file.
    Template(String),
    /// A file.
    File(PathBuf),
}

impl Origin {
    /// Returns the origin of a 3MF in the folder of its set, from the source in the manifest; `None` if that file no
    /// longer exists.
    fn from_set(source: SourceEntry, package: &str) -> Option<Self> {
        if templates::names().contains(&source.name.as_str()) {
            return Some(Self::Template(source.name));
        }
        let folder = Path::new(package).canonicalize().ok()?;
        let file = folder.parent()?.join(source.name);
        file.is_file().then_some(Self::File(file))
    }

    /// Returns the origin of a 3MF outside of its set: the template with the same configuration, or else the file
    /// itself.
    fn of_package(file: &str, configuration: &Configuration) -> Self {
        let name = configuration.switch.name.to_string();
        let template = templates::text(&name).and_then(|text| read(&text, &name).ok());
        // A template takes its name from its file.
        let is_same = template.is_some_and(|(mut template, _)| {
            template.switch.name.clone_from(&configuration.switch.name);
            template == *configuration
        });
        if is_same { Self::Template(name) } else { Self::File(PathBuf::from(file)) }
    }

    fn of(file: &str, text: &str) -> Self {
        let (path, stem) = (Path::new(file), stem(file));
        // A file that equals its template, as in this repository, is the template.
        if !path.exists() || path.is_dir() || templates::text(&stem).is_some_and(|template| template == text)
        {
            Self::Template(stem)
        } else {
            Self::File(path.to_owned())
        }
    }

    /// Returns the entry for a manifest in `folder`, which exists. A file is named by its path from that folder, which
    /// depends neither on the working directory nor on the place of both.
    pub(super) fn entry(&self, folder: &Path) -> SourceEntry {
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        match self {
            Self::Template(name) => SourceEntry::new(name),
            Self::File(path) => {
                let name = path_from(&real(folder), &real(path)).to_string_lossy().replace('\\', "/");
                let is_template = templates::names().contains(&name.as_str());
                SourceEntry::new(if is_template { format!("./{name}") } else { name })
            }
        }
    }
}

fn stem(file: &str) -> String {
    PathBuf::from(file).file_stem().map_or_else(|| "switch".to_owned(), |s| s.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_located_at_options() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("u.toml");
        std::fs::write(&file, "[layout]\npins = [5]\n").unwrap();
        let source = Source::new(&file.to_string_lossy());
        let location = |source: &Source| {
            let error = source.design().unwrap_err();
            error.diagnostics()[0].location().cloned().unwrap()
        };
        let with = |assignments: &[&str]| Source {
            assignments: assignments.iter().map(|a| (*a).to_owned()).collect(),
            ..source.clone()
        };
        let at = |option: &str, field: &str, value: &str| Location::file(option).with_field(field, value);
        assert_eq!(
            location(&with(&["layout.pins=[5, 98]", "layout.pins=[99]"])),
            at("--set", "layout.pins", "[99]")
        );
        assert_eq!(location(&with(&["shell.width_mm=1"])), at("--set", "shell.width_mm", "1"));
        let coarse = Source { tolerance: Some(1.0), ..source.clone() };
        assert_eq!(location(&coarse), at("--tolerance", TOLERANCE, "1.0"));
        // A field that no option sets keeps its line.
        let line = location(&with(&["segment.grooves=4"]));
        assert_eq!((line.line, line.field.as_deref()), (Some(2), Some("layout.pins")));
    }

    #[test]
    fn the_file_of_a_template_is_the_template() {
        let text = templates::text("three-double").unwrap();
        for file in ["three-double", "templates/three-double.toml"] {
            assert_eq!(Origin::of(file, &text).entry(Path::new(".")), SourceEntry::new("three-double"));
        }
    }
}
