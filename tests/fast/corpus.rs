//! Reads every file of `tests/corpus/READER`, so that fixed faults stay fixed and the seeds of the
//! fuzz targets keep their outcomes.

use std::path::PathBuf;

use crate::harness::repository;
use crate::readers::{READERS, Reading, finished_shard_table, judge};

/// Returns the paths of a folder, sorted.
fn files(folder: &std::path::Path) -> Vec<PathBuf> {
    let mut all: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    all.sort();
    all
}

#[test]
fn corpus_files_behave_as_named() {
    if std::env::var_os("PINSWITCH_ACCEPT").is_some() {
        let seed = repository("tests/corpus/shard_table/accepted-one-row.parquet");
        std::fs::write(seed, finished_shard_table().unwrap()).unwrap();
    }
    let mut faults = Vec::new();
    for reader in &READERS {
        let of_reader = files(&repository("tests/corpus").join(reader.name));
        let (mut accepted, mut refused) = (0, 0);
        for path in of_reader {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            match judge(reader.name, &std::fs::read(&path).unwrap()) {
                Ok(Reading::Accepted) if name.starts_with("accepted-") => accepted += 1,
                Ok(Reading::Refused) if name.starts_with("refused-") => refused += 1,
                other => faults.push(format!("{}/{name}: {other:?}", reader.name)),
            }
        }
        // A fuzzer finds little unless its seeds cover both outcomes.
        if accepted == 0 || refused == 0 {
            faults.push(format!("{}: {accepted} accepted, {refused} refused", reader.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn readers_fuzz_targets_and_corpus_agree() {
    for path in files(&repository("tests/corpus")).iter().filter(|path| path.is_dir()) {
        let name = path.file_name().unwrap().to_string_lossy();
        assert!(READERS.iter().any(|reader| reader.name == name), "{name}");
    }
    let manifest = std::fs::read_to_string(repository("fuzz/Cargo.toml")).unwrap();
    for reader in &READERS {
        let name = reader.name;
        assert!(
            manifest.contains(&format!("path = \"targets/{name}.rs\"")),
            "fuzz/Cargo.toml has no target {name}"
        );
        let target = std::fs::read_to_string(repository(&format!("fuzz/targets/{name}.rs"))).unwrap();
        assert!(target.contains(&format!("target!(\"{name}\")")), "{name}");
    }
}

#[test]
fn shipped_files_are_accepted() {
    // The folder is also a crate, so its Cargo.toml is not a configuration.
    let is_configuration =
        |path: &&PathBuf| path.extension().is_some_and(|e| e == "toml") && !path.ends_with("Cargo.toml");
    for path in files(&repository("templates")).iter().filter(is_configuration) {
        let bytes = std::fs::read(path).unwrap();
        assert_eq!(judge("configuration", &bytes), Ok(Reading::Accepted), "{}", path.display());
    }
    for path in files(&repository("templates/requests")) {
        let reading = judge("request", &std::fs::read(&path).unwrap());
        assert!(reading.is_ok(), "{}: {reading:?}", path.display());
    }
    for name in ["effects", "plan", "run", "rig", "measured"] {
        let bytes = std::fs::read(repository(&format!("templates/rig/{name}.toml"))).unwrap();
        assert_eq!(judge(name, &bytes), Ok(Reading::Accepted), "{name}");
    }
    for (name, file) in [("sweep", "sweep.toml"), ("configurations", "configurations.csv")] {
        let bytes = std::fs::read(repository("templates/batch").join(file)).unwrap();
        assert_eq!(judge(name, &bytes), Ok(Reading::Accepted), "{file}");
    }
}
