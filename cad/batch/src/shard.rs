//! Shards: which variants a machine makes.

use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Shard `number` of `of`, counted from 1: a contiguous block of the sweep, so that neighbours share parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "UncheckedShard")]
pub struct Shard {
    number: u64,
    of: u64,
}

/// A shard as a file says it, which may be none.
#[derive(Deserialize)]
struct UncheckedShard {
    number: u64,
    of: u64,
}

impl TryFrom<UncheckedShard> for Shard {
    type Error = ShardError;

    fn try_from(UncheckedShard { number, of }: UncheckedShard) -> Result<Self, ShardError> {
        let is_shard = (1..=of).contains(&number);
        if is_shard { Ok(Self { number, of }) } else { Err(ShardError(format!("{number}/{of}"))) }
    }
}

/// Text that is not a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no shard; give K/N with K from 1 to N, as in --shard 2/8")]
pub struct ShardError(String);

impl Shard {
    /// The whole sweep.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// The variants of this shard among `count`.
    pub fn range(self, count: u64) -> Range<u64> {
        let cut = |k: u64| {
            let product = u128::from(count) * u128::from(k) / u128::from(self.of);
            u64::try_from(product).unwrap_or(count)
        };
        cut(self.number - 1)..cut(self.number)
    }

    /// Whether this is the whole sweep.
    pub fn is_whole(self) -> bool {
        self.of == 1
    }

    /// The options for those of as many shards that make these variants among `count`: `--shard 2/8, --shard 3/8`.
    pub(super) fn siblings(self, count: u64, variants: Range<u64>) -> String {
        const NAMED: usize = 3;
        let (mut named, mut next) = (Vec::new(), variants.start);
        while next < variants.end && named.len() < NAMED {
            // The first shard that ends behind it.
            let number = (u128::from(self.of) * (u128::from(next) + 1)).div_ceil(u128::from(count.max(1)));
            let shard =
                Self { number: u64::try_from(number).map_or(self.of, |n| n.clamp(1, self.of)), of: self.of };
            named.push(format!("--shard {shard}"));
            next = shard.range(count).end.max(next + 1);
        }
        named.join(", ") + if next < variants.end { " and those after it" } else { "" }
    }

    /// Name of its folder.
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
        match parts {
            Some((number, of)) => Self::try_from(UncheckedShard { number, of }),
            None => Err(ShardError(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn shards_cover_every_variant_once_and_evenly(count in 0u64..5000, of in 1u64..40) {
            let ranges: Vec<_> = (1..=of).map(|number| Shard { number, of }.range(count)).collect();
            prop_assert_eq!(ranges[0].start, 0);
            prop_assert_eq!(ranges[ranges.len() - 1].end, count);
            prop_assert!(ranges.windows(2).all(|w| w[0].end == w[1].start));
            let sizes = ranges.iter().map(|r| r.end - r.start);
            prop_assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() <= 1);
        }
    }

    #[test]
    fn the_shards_of_some_variants_are_named() {
        let shard = |text: &str| text.parse::<Shard>().unwrap();
        assert_eq!(shard("1/3").siblings(24, 16..24), "--shard 3/3");
        assert_eq!(shard("1/2").siblings(4, 0..4), "--shard 1/2, --shard 2/2");
        assert_eq!(
            shard("1/18446744073709551615").siblings(2, 1..2),
            "--shard 18446744073709551615/18446744073709551615"
        );
        let text = shard("1/24").siblings(24, 2..24);
        assert_eq!(text, "--shard 3/24, --shard 4/24, --shard 5/24 and those after it");
    }

    #[test]
    fn only_shards_are_shards() {
        assert_eq!("2/8".parse::<Shard>().unwrap().to_string(), "2/8");
        for text in ["0/8", "9/8", "2", "a/b", "-1/3", "1/0"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert!(serde_json::from_str::<Shard>(r#"{"number":1,"of":0}"#).is_err());
    }
}
