//! No changed character in a file between two commands is believed.

use crate::harness::flips::{assert_no_flip_is_believed, make_chain};

/// Number of changed characters, or of `PINSWITCH_CASES`.
const FLIPS: usize = 2_000;

#[test]
fn no_changed_character_is_believed() {
    let folder = tempfile::tempdir().unwrap();
    make_chain(folder.path());
    let count = std::env::var("PINSWITCH_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(FLIPS);
    assert_no_flip_is_believed(folder.path(), count, 2);
}
