//! Whole runs: shards in one folder or, with the feature `cloud`, in a store in memory; and meshes
//! that fail.

use std::sync::atomic::{AtomicU64, Ordering};

use super::*;
use pinswitch_solid::solid::CapCache;
use pinswitch_solid::validity::MeshFacts;
use pinswitch_switch::design::Design;
use pinswitch_switch::output::SetError;
use pinswitch_switch::parts::Part;

fn plan() -> (Variants, SweepSource) {
    let source = SweepSource {
        slice: false,
        verify: false,
        name: "memory".to_owned(),
        file: "memory.toml".to_owned(),
        sweep: "[sweep]\nparts = [\"shell\", \"coupon\"]\n[axes]\n\"layout.pins\" = [[], [8], [7, 9]]\n\
                \"shell.width_mm\" = [12, 13]\n"
            .to_owned(),
        base: String::new(),
        rows: None,
    };
    (Variants::new(Sweep::new(&source).unwrap(), &source), source)
}

/// An observer that counts finished variants.
struct Counter(AtomicU64);

impl Observer for Counter {
    fn variant_done(&self, _: &VariantOutcome) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
    fn stop_requested(&self) -> bool {
        false
    }
}

fn options(shard: Shard, fail_fast: bool, mesh_maker: MeshMaker) -> Options<'static> {
    Options { shard, threads: 2, fail_fast, mesh_maker, slicer: None, kernel: None }
}

/// An empty destination: a temporary folder, or a store in memory.
struct Fresh {
    folder: tempfile::TempDir,
    #[cfg(feature = "cloud")]
    store: std::sync::Arc<object_store::memory::InMemory>,
}

impl Fresh {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            #[cfg(feature = "cloud")]
            store: std::sync::Arc::default(),
        }
    }

    /// Opens the folder, as each process does.
    fn folder(&self) -> Destination {
        Destination::open(self.folder.path().to_str().unwrap(), ".partial-test").unwrap()
    }

    #[cfg(feature = "cloud")]
    fn store(&self) -> Destination {
        let prefix = object_store::path::Path::from("sweep");
        Destination::in_store("memory:///", self.store.clone(), prefix).unwrap()
    }
}

/// Fails for shells that are 13 mm wide.
fn fails(part: &Part, design: &Design, caps: &CapCache) -> Result<(Vec<u8>, MeshFacts), SetError> {
    if part.name == "shell" && design.configuration().shell.width_mm == 13.0 {
        return Err(SetError::Encoding("no paper left".to_owned()));
    }
    mesh_file(part, design, caps)
}

/// Panics for shells that are 13 mm wide.
fn panics(part: &Part, design: &Design, caps: &CapCache) -> Result<(Vec<u8>, MeshFacts), SetError> {
    assert!(part.name != "shell" || design.configuration().shell.width_mm != 13.0, "on purpose");
    mesh_file(part, design, caps)
}

fn shards_merge_to_one_run(open: fn(&Fresh) -> Destination) {
    let (variants, source) = plan();
    let (whole, shards) = (Fresh::new(), Fresh::new());
    let counter = Counter(AtomicU64::new(0));
    let tally =
        run(&variants, &source, &open(&whole), options(Shard::WHOLE, false, mesh_file), &counter).unwrap();
    assert_eq!((tally.made, tally.parts, tally.distinct_parts), (6, 12, 7));
    for shard in ["1/2", "2/2"] {
        let options = options(shard.parse().unwrap(), false, mesh_file);
        run(&variants, &source, &open(&shards), options, &counter).unwrap();
    }
    assert_eq!(counter.0.load(Ordering::Relaxed), 12);
    let merged = merge(&[open(&shards)], &open(&shards)).unwrap();
    assert_eq!(merged, tally);
    for product in ["variants.csv", "variants.parquet", "index.html", "curves.svg", "threshold.svg"] {
        let bytes = |store| open(store).get(product).unwrap().unwrap();
        assert_eq!(bytes(&whole), bytes(&shards), "{product}");
    }
}

#[test]
fn shards_in_a_folder_merge_to_one_run() {
    shards_merge_to_one_run(Fresh::folder);
}

#[cfg(feature = "cloud")]
#[test]
fn shards_in_a_store_merge_to_one_run() {
    shards_merge_to_one_run(Fresh::store);
}

#[test]
fn failing_variants_do_not_fail_others() {
    let (variants, source) = plan();
    for (mesh_maker, reason) in [
        (fails as MeshMaker, "cannot encode a file: no paper left"),
        (panics as MeshMaker, "internal error (panic); please report the configuration"),
    ] {
        let fresh = Fresh::new();
        let destination = fresh.folder();
        let counter = Counter(AtomicU64::new(0));
        let tally = run(&variants, &source, &destination, options(Shard::WHOLE, false, mesh_maker), &counter)
            .unwrap();
        assert_eq!((tally.made, tally.failed, tally.refused), (3, 3, 0));
        let table = String::from_utf8(destination.get("variants.csv").unwrap().unwrap()).unwrap();
        assert_eq!(table.matches(&format!("failed,{reason}")).count(), 3, "{table}");
        // The same run makes the rest once the cause is gone.
        let tally =
            run(&variants, &source, &destination, options(Shard::WHOLE, false, mesh_file), &counter).unwrap();
        assert_eq!((tally.made, tally.failed), (6, 0));

        let fresh = Fresh::new();
        let destination = fresh.folder();
        let result = run(&variants, &source, &destination, options(Shard::WHOLE, true, mesh_maker), &counter);
        assert!(matches!(result, Err(RunError::Failed { reason: r, .. }) if r.to_string() == reason));
        assert!(destination.get("variants.csv").unwrap().is_none());
    }
}
