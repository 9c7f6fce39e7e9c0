//! Content-addressed parts: what is equal between variants is made once and kept once, under the hash of its bytes.

use std::io::Cursor;
use std::sync::Arc;

use pinswitch_diagnostic::Diagnostic;
use quick_cache::sync::Cache;
use sha2::{Digest, Sha256};

use super::destination::{Destination, DestinationError};
use super::hexadecimal;
use pinswitch_slicer::SlicerError;
use pinswitch_solid::files::{read_stl, stl_bytes};
use pinswitch_solid::solid::CapCache;
use pinswitch_solid::validity::MeshFacts;
use pinswitch_solid::verification::{Kernel, Verification};
use pinswitch_switch::built::{examined_print_mesh, verified};
use pinswitch_switch::design::Design;
use pinswitch_switch::output::SetError;
use pinswitch_switch::parts::Part;

/// Recipes kept in the cache, about 500 bytes each; an evicted part is made again, with the same bytes.
const CACHED_RECIPES: usize = 50_000;
/// Corners of caps in the cache, 3 MB: neighbours in a sweep share most of theirs, but for the labels.
const CACHED_CORNERS: usize = 65_536;

/// Makes the mesh file of a part: [`mesh_file`], or a stand-in that fails, in tests.
pub type MeshMaker = fn(&Part, &Design, &CapCache) -> Result<(Vec<u8>, MeshFacts), SetError>;

/// The part as binary STL, meshed and examined, with what the mesh measures.
///
/// # Errors
/// [`SetError`]; a mesh that the oracle refuses is never returned.
pub fn mesh_file(part: &Part, design: &Design, caps: &CapCache) -> Result<(Vec<u8>, MeshFacts), SetError> {
    let (mesh, facts) = examined_print_mesh(part, design, caps)?;
    Ok((stl_bytes(&mesh).map_err(SetError::encoding)?, facts))
}

/// A part stored at the destination.
#[derive(Clone, Debug)]
pub(super) struct StoredPart {
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Its size.
    pub bytes: usize,
    /// What its mesh measures.
    pub facts: MeshFacts,
    /// Agreement of its mesh with a second kernel, where that was requested.
    pub verification: Option<Verification>,
}

/// Why a part could not be stored.
#[derive(Debug, thiserror::Error)]
pub(super) enum ContentError {
    /// It cannot be made.
    #[error(transparent)]
    Set(#[from] SetError),
    /// It cannot be written.
    #[error(transparent)]
    Destination(#[from] DestinationError),
    /// A second kernel does not confirm its mesh.
    #[error(transparent)]
    Verification(Diagnostic),
    /// It cannot be sliced.
    #[error(transparent)]
    Slicer(#[from] SlicerError),
    /// What was kept is gone.
    #[error("{0} is gone; give the same command again")]
    Gone(String),
}

/// The parts of a batch at a destination.
pub(super) struct PartStore<'a> {
    destination: &'a Destination,
    mesh_maker: MeshMaker,
    known: Cache<[u8; 32], Arc<StoredPart>>,
    caps: CapCache,
    kernel: Option<Kernel>,
}

/// Path of the STL with this hash.
pub(super) fn content_path(sha256: &str) -> String {
    format!("parts/{}/{sha256}.stl", sha256.get(..2).unwrap_or_default())
}

impl<'a> PartStore<'a> {
    /// An empty cache for `destination`.
    pub(super) fn new(destination: &'a Destination, mesh_maker: MeshMaker) -> Self {
        Self {
            destination,
            mesh_maker,
            known: Cache::new(CACHED_RECIPES),
            caps: CapCache::new(CACHED_CORNERS),
            kernel: None,
        }
    }

    /// The same cache, which verifies every new mesh with `kernel`.
    pub(super) fn with_kernel(self, kernel: Option<Kernel>) -> Self {
        Self { kernel, ..self }
    }

    /// Stores the part unless it is stored already. Threads that need the same part wait for the first.
    ///
    /// # Errors
    /// [`ContentError`] if it cannot be made or written.
    pub(super) fn keep(&self, part: &Part, design: &Design) -> Result<Arc<StoredPart>, ContentError> {
        self.known.get_or_insert_with(&recipe(part, design), || {
            let (bytes, facts) = (self.mesh_maker)(part, design, &self.caps)?;
            let outcome = self.kernel.map(|kernel| verified_file(&bytes, part, design, kernel));
            let verification = outcome.transpose().map_err(ContentError::Verification)?;
            let sha256 = hexadecimal(&Sha256::digest(&bytes));
            self.write(&content_path(&sha256), &bytes)?;
            Ok(Arc::new(StoredPart { sha256, bytes: bytes.len(), facts, verification }))
        })
    }

    /// The bytes of the part with this hash, as kept.
    ///
    /// # Errors
    /// [`ContentError`] if they cannot be read.
    pub(super) fn stored(&self, sha256: &str) -> Result<Vec<u8>, ContentError> {
        let path = content_path(sha256);
        self.destination.get(&path)?.ok_or(ContentError::Gone(path))
    }

    /// Writes the file unless it is there already, whole: a file that is replaced would no longer be the same as the
    /// links to it. A store's objects are never half written, so that their size is enough.
    fn write(&self, place: &str, bytes: &[u8]) -> Result<(), DestinationError> {
        let there = self.destination.size(place)? == Some(bytes.len() as u64)
            && (!self.destination.links() || self.destination.get(place)?.as_deref() == Some(bytes));
        if there { Ok(()) } else { self.destination.put(place, bytes) }
    }
}

/// Verifies the mesh of a part as it is in its file, in single precision.
fn verified_file(
    bytes: &[u8],
    part: &Part,
    design: &Design,
    kernel: Kernel,
) -> Result<Verification, Diagnostic> {
    let mesh = read_stl(&mut Cursor::new(bytes))?.mesh;
    verified(part, &mesh, design, kernel)
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
        let caps = CapCache::new(CACHED_CORNERS);
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
                let (bytes, _) = mesh_file(&part, &design, &caps).unwrap();
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
        let _lock = destination.lock().unwrap();
        let design = design(&[]);
        let part = &printed(&design).unwrap()[0];
        let keep = || PartStore::new(&destination, mesh_file).keep(part, &design).unwrap();
        let kept = keep();
        let path = folder.path().join(content_path(&kept.sha256));
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.len(), kept.bytes);
        std::fs::write(&path, vec![0; kept.bytes]).unwrap();
        assert_eq!(keep().sha256, kept.sha256);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }
}
