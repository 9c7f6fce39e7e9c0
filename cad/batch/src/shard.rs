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
    fn only_shards_are_shards() {
        assert_eq!("2/8".parse::<Shard>().unwrap().to_string(), "2/8");
        for text in ["0/8", "9/8", "2", "a/b", "-1/3", "1/0"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert!(serde_json::from_str::<Shard>(r#"{"number":1,"of":0}"#).is_err());
    }
}
