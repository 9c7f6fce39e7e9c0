//! Variants: their settings, ids and labels.

use std::collections::HashMap;

use sha2::{Digest, Sha256};
use toml_edit::Value;

use super::axis::ParameterRef;
use super::parallel;
use super::source::SweepSource;
use super::sweep::Sweep;
use pinswitch_switch::config::{Configuration, Name, to_toml};

/// Letters of codes. I, L, O and U are easily misread on a print. M and W are missing since small
/// letters leave less than one printed line between their strokes.
const LETTERS: &[u8; 30] = b"0123456789ABCDEFGHJKNPQRSTVXYZ";
/// Letters of a code: as many as fit on the shell of the paper.
const CODE_LETTERS: usize = 5;
/// Letters of a code in a sweep of more than [`MAX_SHORT_CODES`] variants: enough for any number of
/// 64 bits.
const LONG_CODE_LETTERS: usize = 14;
/// Most variants with short codes, of which half are then free. In a larger sweep a code is the
/// index of the variant, which needs no memory, and repeated variants are not detected.
const MAX_SHORT_CODES: u64 = 12_000_000;
/// Most characters of an id, which is the name of the variant's folder and the title of its plot.
const MAX_ID_LENGTH: usize = 40;

/// One variant of a sweep.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Its index in the sweep, from 0.
    pub index: u64,
    /// Its settings and a code: `width12_pins5.8.11-k7qx2`.
    pub id: String,
    /// The engraved label: the code, unless the sweep sets `label.text`.
    pub label: String,
    /// Its configuration, not yet validated.
    pub configuration: Configuration,
    /// The index of the variant with the same settings.
    pub repeats: Option<u64>,
}

/// All variants of a sweep; each is computed on request.
#[derive(Debug)]
pub struct Variants {
    sweep: Sweep,
    count: u64,
    /// SHA-256 of the base.
    salt: Vec<u8>,
    /// Variants with the settings of an earlier one.
    repeats: HashMap<u64, u64>,
    /// Number of letters of every code.
    letters: usize,
    /// Hashes of variants for which the code of the settings was in use already.
    rehashed: HashMap<u64, u64>,
}

impl Variants {
    /// Counts the variants and determines their codes.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(sweep: Sweep, source: &SweepSource) -> Self {
        let count = sweep.count().unwrap_or(u64::MAX);
        let salt =
            Sha256::digest([source.base.as_bytes(), to_toml(&sweep.base).as_bytes()].concat()).to_vec();
        if count > MAX_SHORT_CODES {
            return Self {
                sweep,
                count,
                salt,
                repeats: HashMap::new(),
                letters: LONG_CODE_LETTERS,
                rehashed: HashMap::new(),
            };
        }
        let letters = CODE_LETTERS;
        let mut all = Self { sweep, count, salt, repeats: HashMap::new(), letters, rehashed: HashMap::new() };
        let mut hashes = parallel::map_range(0..count, |index| (all.hash(index), index));
        parallel::sort(&mut hashes);
        // One bit per code.
        let mut used = vec![0u64; codes(letters).div_ceil(64) as usize];
        let mut take = |code: u64| {
            let (word, bit) = (code as usize / 64, 1 << (code % 64));
            let is_free = used[word] & bit == 0;
            used[word] |= bit;
            is_free
        };
        let mut first = None;
        for (hash, index) in hashes {
            match first {
                Some((before, original)) if before == hash => {
                    all.repeats.insert(index, original);
                }
                _ => first = Some((hash, index)),
            }
            let mut candidate = hash;
            while !take(all.code_number(candidate)) {
                // Knuth's linear congruential generator has the full period.
                candidate =
                    candidate.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            }
            if candidate != hash {
                all.rehashed.insert(index, candidate);
            }
        }
        all
    }

    /// Returns the number of variants.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the sweep.
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// Returns the fields that vary.
    pub fn fields(&self) -> impl Iterator<Item = ParameterRef> + '_ {
        self.sweep.axes.iter().flat_map(|axis| axis.fields.iter().copied())
    }

    /// Returns the variant with this index, which is below [`Self::count`].
    pub fn get(&self, index: u64) -> Variant {
        let mut configuration = self.sweep.base.clone();
        for (field, value) in self.settings(index) {
            // Every value was accepted when the sweep was read.
            let outcome = (field.set)(&mut configuration, &value);
            debug_assert!(outcome.is_ok());
        }
        let number = if self.letters == CODE_LETTERS {
            self.code_number(self.rehashed.get(&index).copied().unwrap_or_else(|| self.hash(index)))
        } else {
            index
        };
        let code = code(number, self.letters);
        let summary = self.summary(index, MAX_ID_LENGTH - self.letters - 1);
        let id = format!("{summary}-{}", code.to_ascii_lowercase());
        if configuration.label.text.is_empty() {
            configuration.label.text.clone_from(&code);
        }
        configuration.switch.name = Name::cleaned(&id);
        let label = configuration.label.text.clone();
        Variant { index, id, label, configuration, repeats: self.repeats.get(&index).copied() }
    }

    /// Returns the fields that vary with the values of variant `index`.
    pub fn settings(&self, index: u64) -> Vec<(ParameterRef, Value)> {
        let mut rest = index;
        let mut all = Vec::new();
        for axis in self.sweep.axes.iter().rev() {
            let row = axis.row(rest % axis.count());
            rest /= axis.count();
            all.extend(axis.fields.iter().copied().zip(row).rev());
        }
        all.reverse();
        all
    }

    /// Returns the number of the code for a hash.
    fn code_number(&self, hash: u64) -> u64 {
        hash % codes(self.letters)
    }

    /// Returns the hash of the settings: equal settings have equal hashes, in whichever order the
    /// axes are.
    fn hash(&self, index: u64) -> u64 {
        let mut settings: Vec<_> = self
            .settings(index)
            .into_iter()
            .map(|(field, value)| format!("{}={value}\n", field.path()))
            .collect();
        settings.sort_unstable();
        let mut hash = Sha256::new_with_prefix(&self.salt);
        settings.iter().for_each(|s| hash.update(s));
        hash.finalize().iter().take(8).fold(0, |sum, byte| sum << 8 | u64::from(*byte))
    }

    /// Returns the first settings as text of at most `longest` characters.
    fn summary(&self, index: u64, longest: usize) -> String {
        let mut text = String::new();
        for (field, value) in self.settings(index) {
            let piece = format!("{}{}", short_key(field.key), short_value(&value));
            let with = if text.is_empty() { piece } else { format!("{text}_{piece}") };
            if with.len() > longest {
                break;
            }
            text = with;
        }
        if text.is_empty() { "variant".to_owned() } else { text }
    }
}

/// Returns the number of codes with this number of letters.
fn codes(letters: usize) -> u64 {
    (0..letters).fold(1, |all, _| all * LETTERS.len() as u64)
}

/// Returns a key without its unit.
fn short_key(key: &str) -> String {
    const UNITS: [&str; 7] = ["_mm", "_deg", "_n", "_g", "_pct", "_a", "_cm3"];
    let stem = UNITS.iter().find_map(|unit| key.strip_suffix(unit)).unwrap_or(key);
    stem.replace('_', "-")
}

/// Returns a value for a folder's name, rounded to four decimals: the code distinguishes similar
/// variants.
fn short_value(value: &Value) -> String {
    let text = match value {
        Value::Float(x) => format!("{}", (x.value() * 1e4).round() / 1e4),
        Value::Array(list) => {
            list.iter().map(|v| v.to_string().trim().to_owned()).collect::<Vec<_>>().join(".")
        }
        Value::String(s) => format!("-{}", s.value()),
        other => other.to_string().trim().to_owned(),
    };
    text.chars().map(|c| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '-' }).collect()
}

/// Returns `number` as a code with this number of letters.
fn code(mut number: u64, letters: usize) -> String {
    let mut code = Vec::with_capacity(letters);
    for _ in 0..letters {
        let digit = usize::try_from(number % LETTERS.len() as u64).unwrap_or_default();
        code.push(char::from(LETTERS[digit]));
        number /= LETTERS.len() as u64;
    }
    code.into_iter().rev().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    fn variants(sweep: &str) -> Variants {
        let source = SweepSource {
            slice: false,
            verify: false,
            name: "s".to_owned(),
            file: "s.toml".to_owned(),
            sweep: sweep.to_owned(),
            base: String::new(),
            rows: None,
        };
        Variants::new(Sweep::new(&source).unwrap(), &source)
    }

    #[test]
    fn ids_stay_when_a_sweep_grows() {
        let ids = |axes: &str| -> Vec<String> {
            let all = variants(axes);
            (0..all.count()).map(|i| all.get(i).id).collect()
        };
        let few = ids("[axes]\n\"shell.width_mm\" = [12, 14]\n\"layout.pins\" = [[5, 8, 11], []]\n");
        assert!(few[0].starts_with("width12_pins5.8.11-"), "{few:?}");
        assert!(few[1].starts_with("width12_pins-"), "{few:?}");
        let more =
            ids("[axes]\n\"layout.pins\" = [[3], [5, 8, 11], []]\n\"shell.width_mm\" = [10, 12, 14]\n");
        let code = |id: &str| id.rsplit('-').next().unwrap().to_owned();
        let codes: Vec<_> = more.iter().map(|id| code(id)).collect();
        assert!(few.iter().all(|id| codes.contains(&code(id))));
        assert_eq!(more.iter().collect::<std::collections::HashSet<_>>().len(), 9);
        assert!(more.iter().all(|id| id.len() <= MAX_ID_LENGTH));
    }

    #[test]
    fn labels_are_codes_unless_given() {
        let all = variants("[axes]\n\"shell.width_mm\" = { from = 10, to = 14, step = 0.01 }\n");
        let labels: std::collections::HashSet<_> = (0..all.count()).map(|i| all.get(i).label).collect();
        assert_eq!(labels.len(), 401);
        assert!(labels.iter().all(|l| l.len() == CODE_LETTERS));
        let given = variants("[axes]\n\"label.text\" = [\"A\", \"B\"]\n");
        assert_eq!(given.get(1).label, "B");
    }

    #[test]
    fn colliding_hashes_get_different_codes() {
        // About 19 of 30,000 hashes collide in 30^5 codes.
        let all = variants("[axes]\n\"tendon.length_mm\" = { from = 100, to = 400, count = 30000 }\n");
        assert!(!all.rehashed.is_empty());
        let labels: HashSet<_> = (0..all.count()).map(|i| all.get(i).label).collect();
        assert_eq!(labels.len(), 30_000);
    }

    #[test]
    fn sweeps_may_exceed_memory() {
        let step = |field: &str| format!("\"{field}\" = {{ from = 10, to = 12, step = 1e-6 }}\n");
        let axes: String = ["shell.width_mm", "support.plate_mm", "tendon.length_mm"].map(step).concat();
        let all = variants(&format!("[axes]\n{axes}"));
        assert_eq!(all.count(), 2_000_001 * 2_000_001 * 2_000_001);
        let ids: HashSet<_> = [0, 1, 1 << 40, all.count() - 1].map(|i| all.get(i).id).into();
        assert!(ids.len() == 4 && ids.iter().all(|id| id.len() <= MAX_ID_LENGTH), "{ids:?}");
        assert_eq!(all.get(all.count() - 1).configuration.tendon.length_mm, 12.0);
        let all = variants(
            "[sample]\nmethod = \"random\"\ncount = 10000000\n[sample.axes]\n\"shell.width_mm\" = { from = 10, to = 14 }\n\
             [axes]\n\"support.plate_mm\" = { from = 3, to = 4, count = 2 }\n",
        );
        assert_eq!(all.count(), 20_000_000);
        assert_ne!(all.get(7).configuration.shell.width_mm, all.get(8).configuration.shell.width_mm);
    }

    #[test]
    fn repeated_variants_are_detected() {
        let all = variants(
            "[sample]\nmethod = \"random\"\ncount = 20\n[sample.axes]\n\"segment.grooves\" = { from = 3, to = 5 }\n",
        );
        let repeated = (0..20).filter(|i| all.get(*i).repeats.is_some()).count();
        assert_eq!(repeated, 17);
        for i in 0..20 {
            if let Some(original) = all.get(i).repeats {
                assert!(original < i && all.get(original).repeats.is_none());
                assert_ne!(all.get(i).id, all.get(original).id);
                assert_eq!(all.get(i).configuration.segment, all.get(original).configuration.segment);
            }
        }
    }

    proptest! {
        #[test]
        fn combinations_occur_once(a in 1usize..5, b in 1usize..5, c in 1usize..5) {
            let axis = |field: &str, n: usize| format!("\"{field}\" = {{ from = 10, to = 12, count = {n} }}\n");
            let text = format!(
                "[axes]\n{}{}{}",
                axis("shell.width_mm", a), axis("support.plate_mm", b), axis("tendon.length_mm", c)
            );
            let all = variants(&text);
            prop_assert_eq!(all.count(), (a * b * c) as u64);
            let ids: std::collections::HashSet<_> = (0..all.count()).map(|i| all.get(i).id).collect();
            prop_assert_eq!(ids.len(), a * b * c);
        }
    }
}
