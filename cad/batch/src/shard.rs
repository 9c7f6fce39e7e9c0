//! Shards: the block of variants that one machine makes.

use std::ops::Range;
use std::str::FromStr;

use pinswitch_diagnostic::{Diagnostic, codes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::diagnostics::diagnostic_error;

/// Shard `number` of `of`, counted from 1: a contiguous block of the sweep, since adjacent variants
/// share parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "UncheckedShard")]
pub struct Shard {
    /// Number of the shard, from 1.
    number: u64,
    /// Number of shards.
    of: u64,
}

/// A shard as a file contains it, not yet checked.
#[derive(Deserialize, JsonSchema)]
struct UncheckedShard {
    number: u64,
    of: u64,
}

impl TryFrom<UncheckedShard> for Shard {
    type Error = ShardError;

    fn try_from(UncheckedShard { number, of }: UncheckedShard) -> Result<Self, ShardError> {
        if (1..=of).contains(&number) { Ok(Self { number, of }) } else { Err(ShardError) }
    }
}

/// A text or a pair of numbers that is not a shard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShardError;

impl ShardError {
    fn diagnostic(self) -> Diagnostic {
        Diagnostic::new(codes::INVALID_SHARD, "invalid shard: expected K/N with 1 <= K <= N")
            .with_help("write a shard such as 2/8")
    }

    fn cause(&self) -> Option<&(dyn std::error::Error + 'static)> {
        None
    }
}

diagnostic_error!(ShardError);

impl Shard {
    /// The shard that is the whole sweep.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Returns the indices of this shard's variants among `count`.
    pub fn range(self, count: u64) -> Range<u64> {
        let cut = |k: u64| {
            let product = u128::from(count) * u128::from(k) / u128::from(self.of);
            u64::try_from(product).unwrap_or(count)
        };
        cut(self.number - 1)..cut(self.number)
    }

    /// Returns whether this is the whole sweep.
    pub fn is_whole(self) -> bool {
        self.of == 1
    }

    /// Returns the options for the shards that contain `variants` of `count`, if all shards are as
    /// large as this one: `--shard 2/8, --shard 3/8`.
    pub(super) fn options_for(self, count: u64, variants: Range<u64>) -> String {
        const MAX_LISTED: usize = 3;
        let (mut listed, mut next) = (Vec::new(), variants.start);
        while next < variants.end && listed.len() < MAX_LISTED {
            // The first shard that ends after this variant.
            let number = (u128::from(self.of) * (u128::from(next) + 1)).div_ceil(u128::from(count.max(1)));
            let shard =
                Self { number: u64::try_from(number).map_or(self.of, |n| n.clamp(1, self.of)), of: self.of };
            listed.push(format!("--shard {shard}"));
            next = shard.range(count).end.max(next + 1);
        }
        listed.join(", ") + if next < variants.end { " and the shards after it" } else { "" }
    }

    /// Returns the name of its folder.
    pub fn folder(self) -> String {
        format!("{}-of-{}", self.number, self.of)
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        parts.map_or(Err(ShardError), |(number, of)| Self::try_from(UncheckedShard { number, of }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn shards_divide_a_sweep_evenly(count in 0u64..5000, of in 1u64..40) {
            let ranges: Vec<_> = (1..=of).map(|number| Shard { number, of }.range(count)).collect();
            prop_assert_eq!(ranges[0].start, 0);
            prop_assert_eq!(ranges[ranges.len() - 1].end, count);
            prop_assert!(ranges.windows(2).all(|w| w[0].end == w[1].start));
            let sizes = ranges.iter().map(|r| r.end - r.start);
            prop_assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() <= 1);
        }
    }

    #[test]
    fn missing_variants_give_shard_options() {
        let shard = |text: &str| text.parse::<Shard>().unwrap();
        assert_eq!(shard("1/3").options_for(24, 16..24), "--shard 3/3");
        assert_eq!(shard("1/2").options_for(4, 0..4), "--shard 1/2, --shard 2/2");
        assert_eq!(
            shard("1/18446744073709551615").options_for(2, 1..2),
            "--shard 18446744073709551615/18446744073709551615"
        );
        let text = shard("1/24").options_for(24, 2..24);
        assert_eq!(text, "--shard 3/24, --shard 4/24, --shard 5/24 and the shards after it");
    }

    #[test]
    fn invalid_shards_are_refused() {
        assert_eq!("2/8".parse::<Shard>().unwrap().to_string(), "2/8");
        for text in ["0/8", "9/8", "2", "a/b", "-1/3", "1/0"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert!(serde_json::from_str::<Shard>(r#"{"number":1,"of":0}"#).is_err());
    }
}
