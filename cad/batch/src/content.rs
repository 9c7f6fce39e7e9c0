//! Content-addressed parts: what is equal between variants is made once and kept once, under the hash of its bytes.

use std::sync::Arc;

use quick_cache::sync::Cache;
use sha2::{Digest, Sha256};

use super::destination::{Destination, DestinationError};
use super::hexadecimal;
use pinswitch_solid::validity::Facts;
use pinswitch_switch::built::BuiltPart;
use pinswitch_switch::design::Design;
use pinswitch_switch::parts::Part;
use pinswitch_switch::set::SetError;

/// Recipes that are remembered, about 500 bytes each; what is forgotten is made again, to the same bytes.
const REMEMBERED: usize = 50_000;

/// Makes the mesh file of a part: [`mesh_file`], or a stand-in that fails, in tests.
pub type Workshop = fn(&Part, &Design) -> Result<(Vec<u8>, Facts), SetError>;

/// The part as binary STL, meshed and examined, with what the mesh measures.
///
/// # Errors
/// [`SetError`]; a mesh that the oracle refuses is never returned.
pub fn mesh_file(part: &Part, design: &Design) -> Result<(Vec<u8>, Facts), SetError> {
    let built = BuiltPart::new(part.clone(), design)?;
    Ok((built.stl().map_err(SetError::encoding)?, built.facts))
}

/// A part that lies at the destination.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Its size.
    pub bytes: usize,
    /// What its mesh measures.
    pub facts: Facts,
}

/// Why a part is not there.
#[derive(Debug, thiserror::Error)]
pub(super) enum ContentError {
    /// It cannot be made.
    #[error(transparent)]
    Set(#[from] SetError),
    /// It cannot be written.
    #[error(transparent)]
    Destination(#[from] DestinationError),
}

/// The parts of a batch at a destination.
pub(super) struct Contents<'a> {
    destination: &'a Destination,
    workshop: Workshop,
    known: Cache<[u8; 32], Arc<Kept>>,
}

/// Where the STL with this hash lies.
pub(super) fn place_of(sha256: &str) -> String {
    format!("parts/{}/{sha256}.stl", sha256.get(..2).unwrap_or_default())
}

impl<'a> Contents<'a> {
    /// An empty memory of what lies at `destination`.
    pub(super) fn new(destination: &'a Destination, workshop: Workshop) -> Self {
        Self { destination, workshop, known: Cache::new(REMEMBERED) }
    }

    /// The part at the destination, made there if need be. Threads that want the same part wait for the first.
    ///
    /// # Errors
    /// [`ContentError`] if it cannot be made or written.
    pub(super) fn keep(&self, part: &Part, design: &Design) -> Result<Arc<Kept>, ContentError> {
        self.known.get_or_insert_with(&recipe(part, design), || {
            let (bytes, facts) = (self.workshop)(part, design)?;
            let sha256 = hexadecimal(&Sha256::digest(&bytes));
            self.write(&place_of(&sha256), &bytes)?;
            Ok(Arc::new(Kept { sha256, bytes: bytes.len(), facts }))
        })
    }

    /// Writes the file unless it is there already, whole: a file that is replaced would no longer be the same as the
    /// links to it. A store's objects are never half written, so that their size is enough.
    fn write(&self, place: &str, bytes: &[u8]) -> Result<(), DestinationError> {
        let there = self.destination.size(place)? == Some(bytes.len() as u64)
            && (!self.destination.links() || self.destination.get(place)?.as_deref() == Some(bytes));
        if there { Ok(()) } else { self.destination.put(place, bytes) }
    }
}

/// Hash of all that decides the bytes of a part's mesh: its exact solid and the chord tolerance.
fn recipe(part: &Part, design: &Design) -> [u8; 32] {
    let tolerance = design.tolerance().mm().to_bits().to_le_bytes();
    Sha256::new_with_prefix(tolerance).chain_update(part.solid.content_bytes()).finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::config::{Configuration, assign};
    use pinswitch_switch::parts::printed;
    use std::collections::HashMap;

    fn design(assignments: &[&str]) -> Design {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        Design::new(c).unwrap()
    }

    #[test]
    fn equal_recipes_are_equal_bytes_and_only_they() {
        let mut bytes_of: HashMap<[u8; 32], Vec<u8>> = HashMap::new();
        let mut shared = 0;
        for assignments in [
            &["layout.pins=[5, 8, 11]"][..],
            &["layout.pins=[5, 8, 11]", "tendon.length_mm=200"],
            &["layout.pins=[3, 8]"],
            &["shell.width_mm=12"],
            &["mesh.chord_tolerance_mm=0.02"],
            &["label.text=A"],
        ] {
            let design = design(assignments);
            for part in printed(&design).unwrap() {
                let (bytes, _) = mesh_file(&part, &design).unwrap();
                if let Some(before) = bytes_of.insert(recipe(&part, &design), bytes.clone()) {
                    assert_eq!(before, bytes, "{}", part.name);
                    shared += 1;
                }
            }
        }
        // All eight of the second set, and what carries no label in the third and the last.
        assert!(shared >= 16, "{shared}");
        let different: std::collections::HashSet<_> = bytes_of.values().collect();
        assert_eq!(different.len(), bytes_of.len());
    }

    #[test]
    fn a_part_is_made_once_and_a_damaged_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let destination = Destination::open(folder.path().to_str().unwrap(), ".partial").unwrap();
        let _claim = destination.claim().unwrap();
        let design = design(&[]);
        let part = &printed(&design).unwrap()[0];
        let keep = || Contents::new(&destination, mesh_file).keep(part, &design).unwrap();
        let kept = keep();
        let path = folder.path().join(place_of(&kept.sha256));
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.len(), kept.bytes);
        std::fs::write(&path, vec![0; kept.bytes]).unwrap();
        assert_eq!(keep().sha256, kept.sha256);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }
}
