//! Where a configuration comes from: a file or a template, a preset under it, single values over it.

use std::path::{Component, Path, PathBuf};

use clap::Args;

use super::Failure;
use crate::write::source_of_set_with;
use pinswitch_diagnostic::excerpt;
use pinswitch_solid::files::read_three_mf;
use pinswitch_switch::config::{
    Configuration, Diagnostic, FieldLocations, Location, Name, assign, read, read_over, text,
};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::feasibility;
use pinswitch_switch::templates;

/// What a command shows that need not be told a configuration.
const UNNAMED: &str = "three-double";

/// The field that `--tolerance` gives.
const TOLERANCE: &str = "mesh.chord_tolerance_mm";

/// A configuration and what is laid over it.
#[derive(Args, Clone, Debug)]
pub(super) struct Source {
    /// A TOML file, the assembly.3mf of a set, which holds its configuration, or the name of a template (see `pinswitch
    /// layouts`).
    #[arg(required = true)]
    config: Option<String>,
    /// A template or file whose values lie under the configuration, such as printer-fff-0.4.
    #[arg(long, value_name = "NAME|FILE")]
    preset: Option<String>,
    /// Set one value, as in --set shell.width_mm=12; may be repeated.
    #[arg(long = "set", value_name = "TABLE.KEY=VALUE")]
    assignments: Vec<String>,
    /// Chord tolerance of the meshes in mm: how far they may lie from the true curves.
    #[arg(long, value_name = "MM")]
    tolerance: Option<f64>,
}

impl Source {
    /// The configuration of this name alone, with nothing laid over it.
    pub(super) fn named(config: &str) -> Self {
        Self { config: Some(config.to_owned()), preset: None, assignments: Vec::new(), tolerance: None }
    }

    fn config(&self) -> &str {
        self.config.as_deref().unwrap_or(UNNAMED)
    }

    /// Whether the command line says what to make: a configuration, or anything under or over it.
    pub(super) fn is_said(&self) -> bool {
        let Self { config, preset, assignments, tolerance } = self;
        config.is_some() || preset.is_some() || !assignments.is_empty() || tolerance.is_some()
    }

    /// The options that stand over the configuration, and the fields that they give.
    pub(super) fn options(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let sets = self
            .assignments
            .iter()
            .filter_map(|a| a.split_once('='))
            .map(|(field, _)| ("--set", field.trim()));
        sets.chain(self.tolerance.map(|_| ("--tolerance", TOLERANCE)))
    }

    /// The file that the configuration is read from; `None` for a template.
    pub(super) fn file(&self) -> Option<PathBuf> {
        Some(PathBuf::from(self.config())).filter(|path| path.exists() && !path.is_dir())
    }

    /// The same with `preset` under it, unless the command line named one.
    pub(super) fn with_preset(&self, preset: Option<&str>) -> Self {
        let preset = self.preset.clone().or_else(|| preset.map(str::to_owned));
        Self { preset, ..self.clone() }
    }

    /// Reads, overlays and validates.
    ///
    /// # Errors
    /// [`Failure::BadInput`] names file, line, field, value, bound and remedy.
    pub(super) fn design(&self) -> Result<Design, Failure> {
        self.made().map(|made| made.design)
    }

    /// As [`Self::design`], from these bytes of its file: they are what the design shows, whatever happens to the file.
    ///
    /// # Errors
    /// As [`Self::design`].
    pub(super) fn design_from(&self, bytes: Vec<u8>) -> Result<Design, Failure> {
        let (text, _) = configuration_text(bytes, self.config())?;
        self.design_of_text(&text, self.config())
    }

    /// The configuration of the text of its file, with what lies under and over it.
    ///
    /// # Errors
    /// As [`Self::design`]; what only a design finds is not looked for.
    pub(super) fn configuration_from(&self, text: &str) -> Result<Configuration, Failure> {
        self.configuration_of_text(text, self.config()).map(|(configuration, _)| configuration)
    }

    /// An error of what was read, with the option that gave the value, or the name of its file.
    pub(super) fn placed(&self, error: &Diagnostic) -> Failure {
        Failure::bad_input(self.with_place(error.clone(), &FieldLocations::default(), self.config()))
    }

    /// The error with the option that gave its field, the field's place in the file, or at least the file.
    fn with_place(&self, error: Diagnostic, locations: &FieldLocations, file: &str) -> Diagnostic {
        let field = error.location().and_then(|location| location.field.clone()).unwrap_or_default();
        let gives =
            |assignment: &&String| assignment.split_once('=').is_some_and(|(path, _)| path.trim() == field);
        // The last one wins, over the file too.
        if let Some(assignment) = self.assignments.iter().rfind(gives) {
            let option = format!("--set {}", excerpt(assignment, 60));
            return error.or_in_file(&option);
        }
        error.or_at(locations.get(&field).unwrap_or(&Location::file(file)))
    }

    /// As [`Self::design`], with where the configuration comes from, and the law of its set.
    ///
    /// # Errors
    /// As [`Self::design`].
    pub(super) fn made(&self) -> Result<Made, Failure> {
        let (text, file, kind) = read_configuration_text(self.config())?;
        let design = self.design_of_text(&text, &file)?;
        let (origin, law) = match kind {
            Kind::Text => (Origin::of(&file, &text), None),
            Kind::Package(set_s, law) => {
                let from_set = set_s.and_then(|source| Origin::from_set(source, &file));
                (from_set.unwrap_or_else(|| Origin::of_package(&file, design.configuration())), law)
            }
        };
        Ok(Made { design, origin, law })
    }

    fn design_of_text(&self, text: &str, file: &str) -> Result<Design, Failure> {
        let (configuration, locations) = self.configuration_of_text(text, file)?;
        let placed = |e| Failure::bad_input(self.with_place(e, &locations, file));
        feasibility::design(configuration).map_err(placed)
    }

    fn configuration_of_text(
        &self,
        text: &str,
        file: &str,
    ) -> Result<(Configuration, FieldLocations), Failure> {
        let base = self.preset.as_ref().map_or(Ok(Configuration::default()), |preset| {
            let (text, file) = read_text(preset)?;
            read(&text, &file).map(|(base, _)| base).map_err(Failure::bad_input)
        })?;
        let (mut configuration, locations) = read_over(base, text, file).map_err(Failure::bad_input)?;
        if !locations.contains("switch.name") {
            configuration.switch.name = Name::from_file_stem(file);
        }
        for assignment in &self.assignments {
            assign(&mut configuration, assignment).map_err(|e| Failure::bad_input(e.or_in_file("--set")))?;
        }
        if let Some(mm) = self.tolerance {
            assign(&mut configuration, &format!("{TOLERANCE}={mm:?}"))
                .map_err(|e| Failure::bad_input(e.or_in_file("--tolerance")))?;
        }
        Ok((configuration, locations))
    }
}

/// The text of a file or template, and the name to use for it in errors.
pub(super) fn read_text(name: &str) -> Result<(String, String), Failure> {
    read_configuration_text(name).map(|(text, file, _)| (text, file))
}

/// What a configuration is read from.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Kind {
    /// A TOML file, or a template.
    Text,
    /// A 3MF with a configuration in it, what the set beside it says that it was made from, and the law of its curve where
    /// that was chosen.
    Package(Option<SourceEntry>, Option<String>),
}

fn read_configuration_text(name: &str) -> Result<(String, String, Kind), Failure> {
    let path = Path::new(name);
    let bare = name.strip_prefix("templates/").unwrap_or(name);
    let bare = bare.strip_suffix(".toml").unwrap_or(bare);
    // A folder that has the name of a template, such as the one that its set went to, is not in the way.
    if path.exists() && !(path.is_dir() && templates::text(bare).is_some()) {
        let (text, kind) = configuration_text(crate::input::read_configuration(path)?, name)?;
        return Ok((text, name.to_owned(), kind));
    }
    templates::text(bare).map(|text| (text, name.to_owned(), Kind::Text)).ok_or_else(|| {
        let names = templates::names();
        let near = names.iter().max_by(|a, b| strsim::jaro_winkler(bare, a).total_cmp(&strsim::jaro_winkler(bare, b)));
        let near = near.copied().unwrap_or_default();
        Failure::bad_input(format!(
            "{name}: no such file or template; the nearest template is {near:?}, `pinswitch layouts` lists all"
        ))
    })
}

/// The text of a configuration: the file itself, or what a 3MF of ours has in it.
fn configuration_text(bytes: Vec<u8>, file: &str) -> Result<(String, Kind), Failure> {
    if !bytes.starts_with(b"PK") {
        return text(bytes, file).map(|text| (text, Kind::Text)).map_err(Failure::bad_input);
    }
    let package = read_three_mf(&bytes).map_err(|e| Failure::bad_input(format!("{file}: {e}")))?;
    let set_s = source_of_set_with(Path::new(file), &bytes);
    let law = package.law;
    package.configuration.map(|text| (text, Kind::Package(set_s, law))).ok_or_else(|| {
        Failure::bad_input(format!(
            "{file}: holds no configuration; give a TOML file, or an assembly.3mf that pinswitch wrote"
        ))
    })
}

/// A design with what else its source says.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub(super) design: Design,
    pub(super) origin: Origin,
    /// The law that was chosen for the curve of the set that the configuration was read from.
    pub(super) law: Option<String>,
}

/// Where a configuration comes from.
#[derive(Clone, Debug)]
pub(super) enum Origin {
    /// A template of this name, or its own file.
    Template(String),
    /// A file.
    File(PathBuf),
}

impl Origin {
    /// Of a 3MF in the folder of its set, whose manifest says what made both; `None` where that is no longer there.
    fn from_set(source: SourceEntry, package: &str) -> Option<Self> {
        if templates::names().contains(&source.name.as_str()) {
            return Some(Self::Template(source.name));
        }
        let folder = Path::new(package).canonicalize().ok()?;
        let file = folder.parent()?.join(source.name);
        file.is_file().then_some(Self::File(file))
    }

    /// Of a 3MF by itself: a template that makes the same set made it, and otherwise the file stands for what did.
    fn of_package(file: &str, configuration: &Configuration) -> Self {
        let name = configuration.switch.name.to_string();
        let template = templates::text(&name).and_then(|text| read(&text, &name).ok());
        // A template takes its name from its file.
        let makes_it = template.is_some_and(|(mut template, _)| {
            template.switch.name.clone_from(&configuration.switch.name);
            template == *configuration
        });
        if makes_it { Self::Template(name) } else { Self::File(PathBuf::from(file)) }
    }

    fn of(file: &str, text: &str) -> Self {
        let (path, stem) = (Path::new(file), stem(file));
        // A template's own file, as in this repository, is the template.
        if !path.exists() || path.is_dir() || templates::text(&stem).is_some_and(|template| template == text)
        {
            Self::Template(stem)
        } else {
            Self::File(path.to_owned())
        }
    }

    /// What a manifest in `folder`, which is there, says of it: of a file its path from that folder, which is the same
    /// wherever the command is given, and wherever a machine keeps the folder of both.
    pub(super) fn entry(&self, folder: &Path) -> SourceEntry {
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        match self {
            Self::Template(name) => SourceEntry::new(name),
            Self::File(path) => {
                let name = from_folder(&real(path), &real(folder)).to_string_lossy().replace('\\', "/");
                let is_a_template_s = templates::names().contains(&name.as_str());
                SourceEntry::new(if is_a_template_s { format!("./{name}") } else { name })
            }
        }
    }
}

/// The path to `file` from `folder`, both absolute; `file` itself where they have no root in common.
fn from_folder(file: &Path, folder: &Path) -> PathBuf {
    let shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file.to_owned();
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(file.components().skip(shared)).collect()
}

fn stem(file: &str) -> String {
    PathBuf::from(file).file_stem().map_or_else(|| "switch".to_owned(), |s| s.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_of_an_option_is_refused_at_the_option() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("u.toml");
        std::fs::write(&file, "[layout]\npins = [5]\n").unwrap();
        let of = |assignments: &[&str]| {
            let mut source = Source::named(&file.to_string_lossy());
            source.assignments = assignments.iter().map(|a| (*a).to_owned()).collect();
            source.design().unwrap_err().message().to_owned()
        };
        let said = of(&["layout.pins=[5, 98]", "layout.pins=[99]"]);
        assert!(said.starts_with("--set layout.pins=[99]: layout.pins = [99]: pin in groove 99"), "{said}");
        // What the option did not give still has its line.
        let said = of(&["segment.grooves=4"]);
        assert!(said.contains("u.toml:2:8: layout.pins = [5]: pin in groove 5"), "{said}");
    }

    #[test]
    fn every_file_has_its_own_name_and_no_templates() {
        let from =
            |file: &str, folder: &str| from_folder(Path::new(file), Path::new(folder)).display().to_string();
        assert_eq!(from("/a/b/x.toml", "/a/b"), "x.toml");
        assert_eq!(from("/a/c/x.toml", "/a/b"), "../c/x.toml");
        assert_eq!(from("/x.toml", "/a/b"), "../../x.toml");
        let text = templates::text("three-double").unwrap();
        for own in ["three-double", "templates/three-double.toml"] {
            assert_eq!(Origin::of(own, &text).entry(Path::new(".")), SourceEntry::new("three-double"));
        }
    }
}
