//! What stands in the way of a batch: a folder where a file must be, or a file where a folder must be. Found before
//! anything is made, so that a dry run and the run refuse the same.

use std::io::ErrorKind;

use super::destination::{Destination, DestinationError};
use super::products::{PRODUCTS, TABLES};
use super::shard::Shard;
use super::stamp::STAMP;

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
