//! Totals of a batch or a shard.

use schemars::JsonSchema;
use serde::Serialize;

/// Totals over a number of variants.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Tally {
    /// Variants that were made, in this run or an earlier one.
    pub made: u64,
    /// Variants that cannot be built or do not meet a constraint.
    pub refused: u64,
    /// Variants that failed.
    pub failed: u64,
    /// Part files of all variants.
    pub parts: u64,
    /// Different part files among them.
    pub distinct_parts: u64,
    /// Bytes of all part files.
    pub part_bytes: u64,
    /// Bytes of the different part files.
    pub distinct_bytes: u64,
}

impl Tally {
    /// Returns the numbers of variants: `12 variants made, 1 refused, 0 failed`.
    pub fn summary(&self) -> String {
        let noun = if self.made == 1 { "variant" } else { "variants" };
        format!("{} {noun} made, {} refused, {} failed", self.made, self.refused, self.failed)
    }

    /// Counts a part file; `is_new` if it is the first one with its content.
    pub(super) fn count_part(&mut self, bytes: u64, is_new: bool) {
        self.parts += 1;
        self.part_bytes += bytes;
        if is_new {
            self.distinct_parts += 1;
            self.distinct_bytes += bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_variant_is_singular() {
        let tally = |made| Tally { made, refused: 2, ..Tally::default() }.summary();
        assert_eq!(tally(1), "1 variant made, 2 refused, 0 failed");
        assert_eq!(tally(0), "0 variants made, 2 refused, 0 failed");
    }
}
