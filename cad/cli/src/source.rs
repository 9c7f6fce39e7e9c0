//! Where a configuration comes from: a file or a template, a preset under it, single values over it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::Failure;
use pinswitch_switch::config::{Configuration, Name, Places, assign, read, read_over};
use pinswitch_switch::design::Design;
use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::templates;

/// A configuration and what is laid over it.
#[derive(Args, Clone, Debug)]
pub(super) struct Source {
    /// A TOML file, or the name of a template (see `pinswitch layouts`).
    config: String,
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
        Self { config: config.to_owned(), preset: None, assignments: Vec::new(), tolerance: None }
    }

    /// The file that the configuration is read from; `None` for a template.
    pub(super) fn file(&self) -> Option<PathBuf> {
        Some(PathBuf::from(&self.config)).filter(|path| path.exists())
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
        self.design_and_origin().map(|(design, _)| design)
    }

    /// An error of what was read, with the name of its file.
    pub(super) fn placed(&self, error: &impl std::fmt::Display) -> Failure {
        Failure::bad_input(format!("{}: {error}", self.config))
    }

    /// As [`Self::design`], with what the manifest says of the configuration.
    ///
    /// # Errors
    /// As [`Self::design`].
    pub(super) fn design_and_origin(&self) -> Result<(Design, SourceEntry), Failure> {
        let (text, file) = read_text(&self.config)?;
        let origin = SourceEntry::new(portable_name(&file, &text));
        let base = self.preset.as_ref().map_or(Ok(Configuration::default()), |preset| {
            let (text, file) = read_text(preset)?;
            read(&text, &file).map(|(base, _)| base).map_err(Failure::bad_input)
        })?;
        let (mut configuration, places) = read_over(base, &text, &file).map_err(Failure::bad_input)?;
        if !places.sets("switch.name") {
            configuration.switch.name = Name::cleaned(&stem(&file));
        }
        for assignment in &self.assignments {
            assign(&mut configuration, assignment).map_err(Failure::bad_input)?;
        }
        if let Some(mm) = self.tolerance {
            assign(&mut configuration, &format!("mesh.chord_tolerance_mm={mm:?}"))
                .map_err(|e| Failure::bad_input(e.to_string().replacen("--set", "--tolerance", 1)))?;
        }
        let design = Design::new(configuration).map_err(|e| Failure::bad_input(placed(e, &places, &file)))?;
        Ok((design, origin))
    }
}

/// The error with the place of its field in the file, or at least the file.
fn placed(error: pinswitch_switch::config::ConfigError, places: &Places, file: &str) -> String {
    match places.of(&error.field) {
        Some(place) => error.at(place.clone()).to_string(),
        None => format!("{file}: {error}"),
    }
}

/// The text of a file or template, and the name to use for it in errors.
pub(super) fn read_text(name: &str) -> Result<(String, String), Failure> {
    let path = Path::new(name);
    if path.exists() {
        let text = crate::input::read_text_file(path)?;
        return Ok((text, name.to_owned()));
    }
    let bare = name.strip_prefix("templates/").unwrap_or(name);
    let bare = bare.strip_suffix(".toml").unwrap_or(bare);
    templates::text(bare).map(|text| (text, name.to_owned())).ok_or_else(|| {
        let names = templates::names();
        let near = names.iter().max_by(|a, b| strsim::jaro_winkler(bare, a).total_cmp(&strsim::jaro_winkler(bare, b)));
        let near = near.copied().unwrap_or_default();
        Failure::bad_input(format!(
            "{name}: no such file or template; the nearest template is {near:?}, `pinswitch layouts` lists all"
        ))
    })
}

/// The name of a template; else the path of a file below the current folder, or its bare name: the same on every machine.
fn portable_name(file: &str, text: &str) -> String {
    let path = Path::new(file);
    let stem = stem(file);
    // A template's own file, as in this repository, is the template.
    if templates::text(&stem).is_some_and(|template| template == text) {
        return stem;
    }
    let below = || {
        let here = std::env::current_dir().ok()?.canonicalize().ok()?;
        Some(path.canonicalize().ok()?.strip_prefix(here).ok()?.to_owned())
    };
    let bare = || path.file_name().map_or_else(|| path.to_owned(), PathBuf::from);
    below().unwrap_or_else(bare).to_string_lossy().replace('\\', "/")
}

fn stem(file: &str) -> String {
    PathBuf::from(file).file_stem().map_or_else(|| "switch".to_owned(), |s| s.to_string_lossy().into_owned())
}
