//! Obstructions: a folder at the path of a file, or a file at the path of a folder. They are
//! checked before anything is made, so that a dry run and a run refuse the same destinations.

use std::collections::HashSet;
use std::io::ErrorKind;

use super::destination::{Destination, DestinationError};
use super::products::{PRODUCTS, TABLES};
use super::shard::Shard;
use super::stamp::STAMP;
use super::variant::Variants;

/// Refuses a destination with an obstruction at a path that `shard` writes. An obstruction at a
/// path of a single variant fails that variant only.
///
/// # Errors
/// The first obstructed path.
pub(super) fn check_paths(destination: &Destination, shard: Shard) -> Result<(), DestinationError> {
    let (mut folders, mut files) = (vec!["variants".to_owned(), "parts".to_owned()], vec![STAMP.to_owned()]);
    if shard.is_whole() {
        files.extend(TABLES.iter().chain(&PRODUCTS).map(|name| (*name).to_owned()));
    } else {
        let shard_folder = format!("shards/{}", shard.folder());
        files.extend(TABLES.iter().chain(&["shard.json"]).map(|name| format!("{shard_folder}/{name}")));
        folders.extend(["shards".to_owned(), shard_folder]);
    }
    // Parts are in folders with the first two digits of their hashes.
    folders.extend((0..=u8::MAX).map(|byte| format!("parts/{byte:02x}")));
    for folder in &folders {
        destination.refuse_if(folder, false, ErrorKind::NotADirectory)?;
    }
    for file in &files {
        destination.refuse_if(file, true, ErrorKind::IsADirectory)?;
    }
    Ok(())
}

/// Returns the paths of `shard` that are obstructed and would fail single variants: variants'
/// folders, their files, and parts.
///
/// # Errors
/// A folder that cannot be read.
pub fn obstructed_paths(
    destination: &Destination,
    variants: &Variants,
    shard: Shard,
) -> Result<Vec<String>, DestinationError> {
    let is_output = |name: &str| {
        ["manifest.json", "friction.csv", "friction.svg"].contains(&name) || name.ends_with(".stl")
    };
    let mut obstructed = Vec::new();
    let (mut candidates, mut names) = (Vec::new(), HashSet::new());
    for (id, is_folder) in destination.entries("variants")? {
        let place = format!("variants/{id}");
        let inside = if is_folder { destination.entries(&place)? } else { Vec::new() };
        let folders = inside.into_iter().filter(|(name, is_folder)| *is_folder && is_output(name));
        let folders: Vec<String> = folders.map(|(name, _)| format!("{place}/{name}")).collect();
        if !is_folder || !folders.is_empty() {
            names.insert(id.clone());
            candidates.push((id, if is_folder { folders } else { vec![place] }));
        }
    }
    if !names.is_empty() {
        // A stray file obstructs only if it has the name of a variant of this shard.
        let ids = shard.range(variants.count()).map(|index| variants.get(index).id);
        let obstructed_ids: HashSet<String> = ids.filter(|id| names.contains(id)).collect();
        let of_shard = candidates.into_iter().filter(|(id, _)| obstructed_ids.contains(id));
        obstructed.extend(of_shard.flat_map(|(_, paths)| paths));
    }
    for (folder, _) in destination.entries("parts")?.into_iter().filter(|(_, is_folder)| *is_folder) {
        let place = format!("parts/{folder}");
        let folders = destination
            .entries(&place)?
            .into_iter()
            .filter(|(name, is_folder)| *is_folder && is_output(name));
        obstructed.extend(folders.map(|(name, _)| format!("{place}/{name}")));
    }
    obstructed.sort();
    Ok(obstructed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obstructed_paths_are_refused() {
        let shard: Shard = "1/2".parse().unwrap();
        let refused = |name: &str, is_folder: bool, shard: Shard| {
            let place = tempfile::tempdir().unwrap();
            let path = place.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            if is_folder {
                std::fs::create_dir(&path).unwrap()
            } else {
                std::fs::write(&path, "x").unwrap()
            }
            let destination = Destination::open(place.path().to_str().unwrap(), ".partial-x").unwrap();
            check_paths(&destination, shard).err().map(|e| e.to_string())
        };
        for (name, is_folder, shard) in [
            ("variants.csv", true, Shard::WHOLE),
            ("index.html", true, Shard::WHOLE),
            ("threshold.svg", true, Shard::WHOLE),
            ("variants", false, Shard::WHOLE),
            ("parts", false, Shard::WHOLE),
            ("parts/7f", false, Shard::WHOLE),
            ("shards", false, shard),
            ("shards/1-of-2", false, shard),
            ("shards/1-of-2/shard.json", true, shard),
        ] {
            let error = refused(name, is_folder, shard).unwrap_or_default();
            assert!(error.contains(name) && error.contains("move it away"), "{name}: {error}");
            assert_eq!(refused(name, !is_folder, shard), None, "{name}");
        }
        assert_eq!(refused("variants.csv", true, shard), None);
        assert_eq!(refused("variants/notes.txt", false, Shard::WHOLE), None);
    }
}
