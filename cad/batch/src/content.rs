//! Content-addressed parts: equal parts of different variants are made once and stored once, by the
//! hash of their bytes.

use std::io::Cursor;
use std::sync::Arc;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
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

/// Parts in the cache, about 500 bytes each; an evicted part is made again, with the same bytes.
const CACHED_PARTS: usize = 50_000;
/// Corners of caps in the cache, 3 MB: adjacent variants of a sweep share most caps, and those with a label all but the
/// letters that are new in their place.
const CACHED_CORNERS: usize = 65_536;

/// Makes the mesh file of a part: [`mesh_file`], or a function that fails in tests.
pub type MeshMaker = fn(&Part, &Design, &CapCache) -> Result<(Vec<u8>, MeshFacts), SetError>;

/// Meshes and examines a part; returns it as binary STL with the measurements of its mesh.
///
/// # Errors
/// [`SetError`], also for a mesh that is not valid.
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
    /// Measurements of its mesh.
    pub facts: MeshFacts,
    /// Agreement of its mesh with a second kernel, where that was requested.
    pub verification: Option<Verification>,
}

/// Why a variant could not be stored.
#[derive(Debug)]
pub(super) enum ContentError {
    /// A file cannot be made.
    Set(SetError),
    /// A second kernel does not confirm a mesh.
    Verification(Diagnostic),
    /// A file cannot be written or read.
    Destination(DestinationError),
    /// A part cannot be sliced.
    Slicer(SlicerError),
    /// A stored part was removed during the run.
    Removed(String),
}

impl From<ContentError> for Diagnostic {
    fn from(error: ContentError) -> Self {
        match error {
            ContentError::Set(error) => error.into(),
            ContentError::Verification(error) => error,
            ContentError::Destination(error) => error.into(),
            ContentError::Slicer(error) => error.into(),
            ContentError::Removed(path) => {
                Self::new(codes::CANNOT_READ, "the file was removed during the run")
                    .with_location(Location::file(path))
                    .with_help("run the same command again")
            }
        }
    }
}

impl From<SetError> for ContentError {
    fn from(error: SetError) -> Self {
        Self::Set(error)
    }
}

impl From<DestinationError> for ContentError {
    fn from(error: DestinationError) -> Self {
        Self::Destination(error)
    }
}

impl From<SlicerError> for ContentError {
    fn from(error: SlicerError) -> Self {
        Self::Slicer(error)
    }
}

/// The parts of a batch at a destination.
pub(super) struct PartStore<'a> {
    destination: &'a Destination,
    mesh_maker: MeshMaker,
    cache: Cache<[u8; 32], Arc<StoredPart>>,
    caps: CapCache,
    kernel: Option<Kernel>,
}

/// Returns the path of the STL with this hash.
pub(super) fn content_path(sha256: &str) -> String {
    format!("parts/{}/{sha256}.stl", sha256.get(..2).unwrap_or_default())
}

impl<'a> PartStore<'a> {
    /// A store at `destination` with an empty cache.
    pub(super) fn new(destination: &'a Destination, mesh_maker: MeshMaker) -> Self {
        Self {
            destination,
            mesh_maker,
            cache: Cache::new(CACHED_PARTS),
            caps: CapCache::new(CACHED_CORNERS),
            kernel: None,
        }
    }

    /// The same store, which verifies every new mesh with `kernel`.
    pub(super) fn with_kernel(self, kernel: Option<Kernel>) -> Self {
        Self { kernel, ..self }
    }

    /// Stores the part unless it is stored already. Threads that need the same part wait for the
    /// first one.
    ///
    /// # Errors
    /// A part that cannot be made or written.
    pub(super) fn store(&self, part: &Part, design: &Design) -> Result<Arc<StoredPart>, ContentError> {
        self.cache.get_or_insert_with(&recipe_hash(part, design), || {
            let (bytes, facts) = (self.mesh_maker)(part, design, &self.caps)?;
            let outcome = self.kernel.map(|kernel| verified_file(&bytes, part, design, kernel));
            let verification = outcome.transpose().map_err(ContentError::Verification)?;
            let sha256 = hexadecimal(&Sha256::digest(&bytes));
            self.write(&content_path(&sha256), &bytes)?;
            Ok(Arc::new(StoredPart { sha256, bytes: bytes.len(), facts, verification }))
        })
    }

    /// Reads the bytes of the stored part with this hash.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub(super) fn read(&self, sha256: &str) -> Result<Vec<u8>, ContentError> {
        let path = content_path(sha256);
        self.destination.get(&path)?.ok_or(ContentError::Removed(path))
    }

    /// Writes the file unless it exists with the same content: a replaced file would no longer be
    /// identical to the hard links to it. Objects of a store are never partly written, so that
    /// comparing their size is enough.
    fn write(&self, path: &str, bytes: &[u8]) -> Result<(), DestinationError> {
        let exists = self.destination.size(path)? == Some(bytes.len() as u64)
            && (!self.destination.has_links() || self.destination.get(path)?.as_deref() == Some(bytes));
        if exists { Ok(()) } else { self.destination.put(path, bytes) }
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

/// Returns the hash of the inputs of a part's mesh: its exact solid and the chord tolerance.
fn recipe_hash(part: &Part, design: &Design) -> [u8; 32] {
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
    fn equal_recipes_give_equal_bytes() {
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
                if let Some(before) = bytes_of.insert(recipe_hash(&part, &design), bytes.clone()) {
                    assert_eq!(before, bytes, "{}", part.name);
                    shared += 1;
                }
            }
        }
        // All eight parts of the second set, and the parts without a label of the third and the
        // last.
        assert!(shared >= 16, "{shared}");
        let different: std::collections::HashSet<_> = bytes_of.values().collect();
        assert_eq!(different.len(), bytes_of.len());
    }

    #[test]
    fn damaged_parts_are_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let destination = Destination::open(folder.path().to_str().unwrap(), ".partial").unwrap();
        let _lock = destination.lock().unwrap();
        let design = design(&[]);
        let part = &printed(&design).unwrap()[0];
        let store = || PartStore::new(&destination, mesh_file).store(part, &design).unwrap();
        let stored = store();
        let path = folder.path().join(content_path(&stored.sha256));
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(whole.len(), stored.bytes);
        std::fs::write(&path, vec![0; stored.bytes]).unwrap();
        assert_eq!(store().sha256, stored.sha256);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
    }
}
