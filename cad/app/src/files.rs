//! The files of a design: those of `pinswitch generate`, byte for byte.

use std::io::{Cursor, Write};

use pinswitch_switch::config::to_toml;
use pinswitch_switch::documents::{FileEntry as ManifestEntry, SourceEntry};
use pinswitch_switch::formats::{ALL, named};
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::set::Set;
use serde::Serialize;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::cache::Cache;
use crate::design::{build, set_refusal};
use crate::refusal::Refusal;
use crate::request::DesignRequest;
use crate::values::configuration;
use crate::{Answer, Engine};

/// The files of one design.
#[derive(Debug)]
pub(crate) struct FileSet {
    design: DesignRequest,
    files: Vec<OutputFile>,
}

#[derive(Serialize)]
struct FileEntry<'a> {
    name: &'a str,
    bytes: usize,
}

impl Engine {
    /// Returns an answer from the files of a design, which are generated again only if the design
    /// is another one.
    pub(crate) fn with_files(
        &mut self,
        design: &DesignRequest,
        answer: impl FnOnce(&FileSet) -> Answer,
    ) -> Answer {
        if self.files.as_ref().is_none_or(|files| files.design != *design) {
            match FileSet::generate(&mut self.cache, design) {
                Ok(files) => self.files = Some(files),
                Err(refusal) => return Answer::json(&serde_json::json!({ "trouble": refusal })),
            }
        }
        self.files.as_ref().map_or_else(|| Answer::error("no files were generated"), answer)
    }
}

impl FileSet {
    /// Generates the files of `pinswitch generate NAME.toml --format all --out .` in a folder with
    /// a `NAME.toml` of this configuration, and that file.
    fn generate(cache: &mut Cache, design: &DesignRequest) -> Result<Self, Refusal> {
        let configuration = configuration(&design.values)?;
        let source = OutputFile::new(format!("{}.toml", configuration.switch.name), to_toml(&configuration));
        let (built, prediction) = build(cache, configuration, design.model.as_deref())?;
        let formats = named(&[ALL])?;
        let set = Set::new(&built, &prediction, &formats).map_err(set_refusal)?;
        let mut set = set.made_from(SourceEntry::new(source.name.clone())).map_err(set_refusal)?;
        if let Some(model) = &design.model {
            let entry = ManifestEntry::of(&OutputFile::new("model.toml", model.clone().into_bytes()));
            set = set.predicted_from(entry.sha256).map_err(set_refusal)?;
        }
        let files = std::iter::once(source).chain(set.files).collect();
        Ok(Self { design: design.clone(), files })
    }

    /// Lists names and sizes.
    pub(crate) fn list(&self) -> Answer {
        let entries: Vec<FileEntry<'_>> =
            self.files.iter().map(|file| FileEntry { name: &file.name, bytes: file.bytes.len() }).collect();
        Answer::json(&serde_json::json!({ "files": entries }))
    }

    /// Returns the content of the file with this name.
    pub(crate) fn content(&self, name: &str) -> Answer {
        match self.files.iter().find(|file| file.name == name) {
            Some(file) => Answer::Bytes(file.bytes.clone()),
            None => Answer::error(format!("{name}: no such file in this design")),
        }
    }

    /// Packs all files in one archive, without dates: equal files give equal archives.
    pub(crate) fn zip(&self) -> Answer {
        self.packed()
            .map_or_else(|e| Answer::error(format!("cannot create the ZIP archive: {e}")), Answer::Bytes)
    }

    fn packed(&self) -> Result<Vec<u8>, ZipError> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default());
        for file in &self.files {
            writer.start_file(file.name.as_str(), options)?;
            writer.write_all(&file.bytes)?;
        }
        Ok(writer.finish()?.into_inner())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn list_files_and_archive_agree() {
        let mut engine = Engine::default();
        let request = |command: &str, more: &str| {
            format!(
                r#"{{"command": "{command}", "values": {{"layout.pins": [8], "switch.name": "one"}}{more}}}"#
            )
        };
        let Answer::Json(text) = engine.answer(&request("files", "")) else { panic!("no list") };
        let list: serde_json::Value = serde_json::from_str(&text).unwrap();
        let sizes: Vec<(&str, u64)> = list["files"]
            .as_array()
            .unwrap()
            .iter()
            .map(|f| (f["name"].as_str().unwrap(), f["bytes"].as_u64().unwrap()))
            .collect();
        assert_eq!(sizes[0].0, "one.toml");
        let shell = request("file", r#", "name": "shell.stl""#);
        let Answer::Bytes(shell) = engine.answer(&shell) else { panic!("no shell") };
        assert!(sizes.contains(&("shell.stl", shell.len() as u64)));
        let Answer::Bytes(packed) = engine.answer(&request("zip", "")) else { panic!("no archive") };
        let mut archive = zip::ZipArchive::new(Cursor::new(packed)).unwrap();
        assert_eq!(archive.len(), sizes.len());
        let mut inside = Vec::new();
        std::io::Read::read_to_end(&mut archive.by_name("shell.stl").unwrap(), &mut inside).unwrap();
        assert_eq!(inside, shell);
        let outside = request("file", r#", "name": "../x""#);
        let Answer::Json(text) = engine.answer(&outside) else { panic!("a file outside of the set") };
        assert!(text.contains("no such file"));
    }
}
