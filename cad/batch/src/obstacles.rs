//! What stands in the way of a batch: a folder where a file must be, or a file where a folder must be. Found before
//! anything is made, so that a dry run and the run refuse the same.

use std::collections::HashSet;
use std::io::ErrorKind;

use super::destination::{Destination, DestinationError};
use super::products::{PRODUCTS, TABLES};
use super::shard::Shard;
use super::stamp::STAMP;
use super::variant::Variants;

/// Refuses a destination with something in the way of what `shard` writes. What is in the way of a single variant lets that
/// one fail, and no other.
///
/// # Errors
/// [`DestinationError`] names the first file or folder that stands in the way.
pub(super) fn refuse_obstacles(destination: &Destination, shard: Shard) -> Result<(), DestinationError> {
    let (mut folders, mut files) = (vec!["variants".to_owned(), "parts".to_owned()], vec![STAMP.to_owned()]);
    if shard.is_whole() {
        files.extend(TABLES.iter().chain(&PRODUCTS).map(|name| (*name).to_owned()));
    } else {
        let own = format!("shards/{}", shard.folder());
        files.extend(TABLES.iter().chain(&["shard.json"]).map(|name| format!("{own}/{name}")));
        folders.extend(["shards".to_owned(), own]);
    }
    // The parts lie in folders named by the first two digits of their hashes.
    folders.extend((0..=u8::MAX).map(|byte| format!("parts/{byte:02x}")));
    for folder in &folders {
        destination.refuse_if(folder, false, ErrorKind::NotADirectory)?;
    }
    for file in &files {
        destination.refuse_if(file, true, ErrorKind::IsADirectory)?;
    }
    Ok(())
}

/// What would let single variants of `shard` fail, and no other: the names of what stands in the place of a variant's
/// folder, of one of its files, or of a part.
///
/// # Errors
/// [`DestinationError`] if a folder cannot be read.
pub fn would_fail(
    destination: &Destination,
    variants: &Variants,
    shard: Shard,
) -> Result<Vec<String>, DestinationError> {
    let is_ours = |name: &str| {
        ["manifest.json", "friction.csv", "friction.svg"].contains(&name) || name.ends_with(".stl")
    };
    let mut found = Vec::new();
    let (mut suspects, mut names) = (Vec::new(), HashSet::new());
    for (id, is_folder) in destination.entries("variants")? {
        let place = format!("variants/{id}");
        let inside = if is_folder { destination.entries(&place)? } else { Vec::new() };
        let wrong = inside.into_iter().filter(|(name, is_folder)| *is_folder && is_ours(name));
        let wrong: Vec<String> = wrong.map(|(name, _)| format!("{place}/{name}")).collect();
        if !is_folder || !wrong.is_empty() {
            names.insert(id.clone());
            suspects.push((id, if is_folder { wrong } else { vec![place] }));
        }
    }
    if !names.is_empty() {
        // Of a stray file it is only known now whether it has the name of a variant.
        let own = shard.range(variants.count()).map(|index| variants.get(index).id);
        let in_the_way: HashSet<String> = own.filter(|id| names.contains(id)).collect();
        let all = suspects.into_iter().filter(|(id, _)| in_the_way.contains(id));
        found.extend(all.flat_map(|(_, places)| places));
    }
    for (folder, _) in destination.entries("parts")?.into_iter().filter(|(_, is_folder)| *is_folder) {
        let place = format!("parts/{folder}");
        let wrong =
            destination.entries(&place)?.into_iter().filter(|(name, is_folder)| *is_folder && is_ours(name));
        found.extend(wrong.map(|(name, _)| format!("{place}/{name}")));
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_has_the_wrong_kind_is_named_and_nothing_else_is() {
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
            refuse_obstacles(&destination, shard).err().map(|e| e.to_string())
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
