//! The files of a design: those of `pinswitch generate`, byte for byte.

use std::io::{Cursor, Write};

use pinswitch_switch::config::to_toml;
use pinswitch_switch::documents::SourceEntry;
use pinswitch_switch::formats::{ALL, named};
use pinswitch_switch::output::OutputFile;
use pinswitch_switch::set::Set;
use serde::Serialize;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::design::{built, trouble};
use crate::kept::Kept;
use crate::request::Asked;
use crate::trouble::Trouble;
use crate::values::configuration;
use crate::{Answer, Engine};

/// The files of one design.
#[derive(Debug)]
pub(crate) struct Made {
    design: Asked,
    files: Vec<OutputFile>,
}

#[derive(Serialize)]
struct Listed<'a> {
    name: &'a str,
    bytes: usize,
}

impl Engine {
    /// An answer from the files of a design, made anew only where it is another one.
    pub(crate) fn files(&mut self, design: &Asked, of: impl FnOnce(&Made) -> Answer) -> Answer {
        if self.made.as_ref().is_none_or(|made| made.design != *design) {
            match Made::new(&mut self.kept, design) {
                Ok(made) => self.made = Some(made),
                Err(trouble) => return Answer::json(&serde_json::json!({ "trouble": trouble })),
            }
        }
        self.made.as_ref().map_or_else(|| Answer::error("nothing was made"), of)
    }
}

impl Made {
    /// Every file that `pinswitch generate NAME.toml --format all --out .` writes beside a `NAME.toml` with this
    /// configuration, and that file.
    fn new(kept: &mut Kept, design: &Asked) -> Result<Self, Trouble> {
        let configuration = configuration(&design.values)?;
        let own = OutputFile::new(format!("{}.toml", configuration.switch.name), to_toml(&configuration));
        let (built, prediction) = built(kept, configuration, design.model.as_deref())?;
        let formats = named(&[ALL]).map_err(Trouble::general)?;
        let set = Set::new(&built, &prediction, &formats).map_err(trouble)?;
        let set = set.made_from(SourceEntry::new(own.name.clone())).map_err(trouble)?;
        let files = std::iter::once(own).chain(set.files).collect();
        Ok(Self { design: design.clone(), files })
    }

    /// Names and sizes.
    pub(crate) fn list(&self) -> Answer {
        let listed: Vec<Listed<'_>> =
            self.files.iter().map(|file| Listed { name: &file.name, bytes: file.bytes.len() }).collect();
        Answer::json(&serde_json::json!({ "files": listed }))
    }

    /// The content of the file called `name`.
    pub(crate) fn file(&self, name: &str) -> Answer {
        match self.files.iter().find(|file| file.name == name) {
            Some(file) => Answer::Bytes(file.bytes.clone()),
            None => Answer::error(format!("{name}: this design has no such file")),
        }
    }

    /// All files in one archive, without a date: the same files are the same archive.
    pub(crate) fn zip(&self) -> Answer {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default());
        for file in &self.files {
            let started = writer.start_file(file.name.as_str(), options).map_err(|e| e.to_string());
            let written = started.and_then(|()| writer.write_all(&file.bytes).map_err(|e| e.to_string()));
            if let Err(e) = written {
                return Answer::error(format!("cannot pack {}: {e}", file.name));
            }
        }
        writer.finish().map_or_else(Answer::error, |bytes| Answer::Bytes(bytes.into_inner()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_is_listed_given_and_packed() {
        let mut engine = Engine::default();
        let question = |ask: &str, more: &str| {
            format!(r#"{{"ask": "{ask}", "values": {{"layout.pins": [8], "switch.name": "one"}}{more}}}"#)
        };
        let Answer::Json(text) = engine.answer(&question("files", "")) else { panic!("no list") };
        let listed: serde_json::Value = serde_json::from_str(&text).unwrap();
        let sizes: Vec<(&str, u64)> = listed["files"]
            .as_array()
            .unwrap()
            .iter()
            .map(|f| (f["name"].as_str().unwrap(), f["bytes"].as_u64().unwrap()))
            .collect();
        assert_eq!(sizes[0].0, "one.toml");
        let shell = question("file", r#", "name": "shell.stl""#);
        let Answer::Bytes(shell) = engine.answer(&shell) else { panic!("no shell") };
        assert!(sizes.contains(&("shell.stl", shell.len() as u64)));
        let Answer::Bytes(packed) = engine.answer(&question("zip", "")) else { panic!("no zip") };
        let mut archive = zip::ZipArchive::new(Cursor::new(packed)).unwrap();
        assert_eq!(archive.len(), sizes.len());
        let mut inside = Vec::new();
        std::io::Read::read_to_end(&mut archive.by_name("shell.stl").unwrap(), &mut inside).unwrap();
        assert_eq!(inside, shell);
        let elsewhere = question("file", r#", "name": "../x""#);
        let Answer::Json(text) = engine.answer(&elsewhere) else { panic!("a file of elsewhere") };
        assert!(text.contains("no such file"));
    }
}
