//! The campaign: thousands of configurations, tables, models, sweeps, meshes and batches, random or
//! damaged. For any input, the program does the work or prints one short error with its remedy.
//!
//! `fuzz/run` runs the campaign, which is not part of the ordinary tests. The command is:
//!
//! ```sh
//! PINSWITCH_CAMPAIGN=1 cargo test --release --test slow campaign -- --ignored --nocapture
//! ```
//!
//! `PINSWITCH_CAMPAIGN` multiplies the numbers of cases (default 1), `PINSWITCH_SEED` is the first
//! seed (default 1), and `PINSWITCH_LEAVE` is the folder for the inputs of failed cases. Each case
//! has its seed, which a failure reports; the same seed gives the same case.

mod requests;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use pinswitch_calibration::effects::Vocabulary;
use pinswitch_calibration::evidence::Session;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_calibration::{ModelFile, calibrate};
use pinswitch_switch::config::{Configuration, read, to_toml};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::random_configurations::{Outcome, build, configurations};
use crate::harness::{done, ended, hashes, pinswitch, repository};
use crate::readers::{LONGEST, Reading, in_memory, judge};

/// The outcome of a case, or its fault.
type Verdict = Result<&'static str, String>;

fn number(name: &str, otherwise: f64) -> f64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise)
}

/// Runs the cases on all processors and prints the number of each outcome. Panics if a case failed.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn campaign(what: &str, cases: u64, case: impl Fn(u64, &mut ChaCha8Rng) -> (Vec<u8>, Verdict) + Sync) {
    let count = ((cases as f64) * number("PINSWITCH_CAMPAIGN", 1.0)).ceil().max(1.0) as u64;
    let first = number("PINSWITCH_SEED", 1.0) as u64;
    let (next, tally, faults) =
        (AtomicU64::new(first), Mutex::new(BTreeMap::<&str, u64>::new()), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count {
                        break;
                    }
                    let mut random = ChaCha8Rng::seed_from_u64(seed);
                    let outcome = catch_unwind(AssertUnwindSafe(|| case(seed, &mut random)));
                    let (given, verdict) = outcome.unwrap_or_else(|panic| {
                        let message = panic.downcast_ref::<String>().cloned();
                        let message =
                            message.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
                        (Vec::new(), Err(format!("a panic: {}", message.unwrap_or_default())))
                    });
                    let word = match verdict {
                        Ok(word) => word,
                        Err(fault) => {
                            leave(what, seed, &given);
                            faults.lock().unwrap().push(format!("seed {seed}: {fault}"));
                            "FAILED"
                        }
                    };
                    *tally.lock().unwrap().entry(word).or_default() += 1;
                }
            });
        }
    });
    let tally = tally.into_inner().unwrap();
    let table: Vec<_> = tally.iter().map(|(word, n)| format!("{n} {word}")).collect();
    println!("{what}: {count} cases, seeds {first} to {}: {}", first + count - 1, table.join(", "));
    let faults = faults.into_inner().unwrap();
    assert!(faults.is_empty(), "{what}: {} failed:\n{}", faults.len(), faults.join("\n"));
}

/// Writes the input of a failed case to the folder in `PINSWITCH_LEAVE`, if it is set.
fn leave(what: &str, seed: u64, given: &[u8]) {
    if let Ok(folder) = std::env::var("PINSWITCH_LEAVE") {
        let folder = Path::new(&folder).join(what.replace(' ', "-"));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(format!("seed-{seed}")), given).unwrap();
    }
}

/// Checks that the output is one short error of exit code 2 that contains these words.
fn is_clear(code: Option<i32>, output: &str, words: &[&str]) -> Result<(), String> {
    let lines: Vec<_> = output.lines().filter(|line| line.starts_with("error: ")).collect();
    if code != Some(2) {
        return Err(format!("exit code {code:?}: {output:.300}"));
    }
    let error = output.split("error: ").last().unwrap_or_default();
    if lines.len() != 1 || error.chars().count() >= LONGEST {
        return Err(format!(
            "{} errors, the last of {} characters: {output:.300}",
            lines.len(),
            error.chars().count()
        ));
    }
    words
        .iter()
        .find(|word| !error.contains(**word))
        .map_or(Ok(()), |word| Err(format!("no {word:?} in: {output}")))
}

/// Returns a random element.
fn one<'a, T: ?Sized>(random: &mut ChaCha8Rng, of: &[&'a T]) -> &'a T {
    of[random.random_range(0..of.len())]
}

/// Returns a value for a parameter with this range: inside it, outside it, or of another type.
fn value(random: &mut ChaCha8Rng, range: &str) -> String {
    let numbers = range.split_once(" to ").and_then(|(low, high)| {
        let high = high.split(' ').next()?;
        Some((low.parse::<f64>().ok()?, high.parse::<f64>().ok()?))
    });
    let junk = [
        "true",
        "\"x\"",
        "[]",
        "[1, 2]",
        "{ a = 1 }",
        "nan",
        "inf",
        "-1",
        "1e300",
        "1979-05-27",
        "\"\"",
        "0",
    ];
    match (random.random_range(0..20), numbers) {
        (0, _) => one(random, &junk).to_owned(),
        (1, Some((low, _))) => format!("{low:?}"),
        (2, Some((_, high))) => format!("{high:?}"),
        (3, Some((low, high))) => {
            let beyond = (high - low) * random.random_range(1e-9..0.5);
            if random.random() { format!("{:?}", low - beyond) } else { format!("{:?}", high + beyond) }
        }
        // A whole number is valid for an integer and for a real parameter.
        (4..8, Some((low, high))) => format!("{}", random.random_range(low..=high).round()),
        (_, Some((low, high))) => format!("{:?}", random.random_range(low..=high)),
        (_, None) if range.starts_with('"') => {
            let words: Vec<_> =
                range.split(['"', ' ']).filter(|w| !w.is_empty() && *w != "or" && *w != ",").collect();
            format!("{:?}", one(random, &words))
        }
        (_, None) if range.contains("groove numbers") => {
            let count = random.random_range(0..6);
            format!("{:?}", (0..count).map(|_| random.random_range(0..17)).collect::<Vec<u32>>())
        }
        (_, None) if range.contains("true") => if random.random() { "true" } else { "false" }.to_owned(),
        (_, None) => {
            one(random, &["\"A 1\"", "\"..\"", "\"\\u0007\"", "\"Zoë\"", "\"a/b\"", "\"ABC-12\""]).to_owned()
        }
    }
}

/// Returns the text of a configuration: a template, or one that can often be built, with some
/// parameters set at random.
fn configuration_text(seed: u64, random: &mut ChaCha8Rng) -> String {
    let mut tables: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    let base = match random.random_range(0..3) {
        0 => {
            let names = ["three-double", "three-single", "six-single", "silicone-only", "proxy-six-single"];
            let path = repository("templates").join(format!("{}.toml", one(random, &names)));
            read(&std::fs::read_to_string(path).unwrap(), "template").unwrap().0
        }
        1 => Configuration::default(),
        _ => {
            let mut bytes = [0; 32];
            bytes[..8].copy_from_slice(&seed.to_le_bytes());
            let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
            configurations()
                .new_tree(&mut TestRunner::new_with_rng(Config::default(), rng))
                .unwrap()
                .current()
        }
    };
    let document: toml_edit::DocumentMut = to_toml(&base).parse().unwrap();
    for (section, table) in document.as_table() {
        for (key, item) in table.as_table().unwrap() {
            let text = item.as_value().unwrap().clone().decorated("", "").to_string();
            tables.entry(section.to_owned()).or_default().insert(key.to_owned(), text);
        }
    }
    let changes = random.random_range(0..5);
    for _ in 0..changes {
        let parameter = &Configuration::PARAMETERS[random.random_range(0..Configuration::PARAMETERS.len())];
        let value = value(random, &(parameter.range)());
        tables.entry(parameter.section.to_owned()).or_default().insert(parameter.key.to_owned(), value);
    }
    tables.iter().fold(String::new(), |mut text, (section, keys)| {
        text += &format!("[{section}]\n");
        keys.iter().for_each(|(key, value)| text += &format!("{key} = {value}\n"));
        text
    })
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn configurations_are_built_or_refused() {
    campaign("configurations", 5000, |seed, random| {
        let text = configuration_text(seed, random);
        let verdict = (|| {
            let error = match read(&text, "my.toml") {
                Ok((configuration, _)) => match build(&configuration)? {
                    Outcome::Parts => None,
                    Outcome::Refused(text) => Some(text),
                },
                Err(error) => {
                    let location = error.location().cloned().unwrap_or_default();
                    let known = Configuration::PARAMETERS.iter().any(|p| Some(p.path()) == location.field);
                    let is_placed = location.value.is_some() && location.line.is_some();
                    if !known || !is_placed || error.help().is_none() {
                        return Err(format!("an error without field, value, remedy or place: {error}"));
                    }
                    Some(error.to_string())
                }
            };
            if let Some(error) = error.as_ref().filter(|e| e.chars().count() >= LONGEST) {
                return Err(format!("an error of {} characters: {error:.200}", error.chars().count()));
            }
            // The command line gives the same result; one case in ten checks that.
            if seed % 10 == 0 {
                let folder = in_memory()?;
                std::fs::write(folder.path().join("my.toml"), &text).map_err(|e| e.to_string())?;
                let (code, output) =
                    ended(folder.path(), &["-q", "generate", "my.toml", "--out", "o", "--format", "stl"]);
                match &error {
                    None if code == Some(0) => {
                        let parts: Vec<_> = std::fs::read_dir(folder.path().join("o"))
                            .unwrap()
                            .map(|e| format!("o/{}", e.unwrap().file_name().to_string_lossy()))
                            .filter(|name| name.ends_with(".stl"))
                            .collect();
                        let arguments: Vec<&str> = ["check", "--min-wall", "0"]
                            .into_iter()
                            .chain(parts.iter().map(String::as_str))
                            .collect();
                        let (code, output) = ended(folder.path(), &arguments);
                        if code != Some(0) {
                            return Err(format!("check refuses the generated parts: {output:.400}"));
                        }
                    }
                    None => return Err(format!("built here, but not by the command: {output:.300}")),
                    Some(_) => {
                        is_clear(code, &output, &["my.toml", "\n  help: "])?;
                        if folder.path().join("o").exists() {
                            return Err("something was written".to_owned());
                        }
                    }
                }
            }
            Ok(if error.is_some() { "refused with one clear error" } else { "built, all parts valid" })
        })();
        (text.into_bytes(), verdict)
    });
}

/// Damages bytes in one of many ways, some of which edit numbers and words of a text.
fn damage(random: &mut ChaCha8Rng, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let at = |random: &mut ChaCha8Rng, bytes: &[u8]| random.random_range(0..bytes.len().max(1));
    for _ in 0..random.random_range(1..4) {
        if bytes.is_empty() {
            break;
        }
        let place = at(random, &bytes);
        match random.random_range(0..10) {
            0 => bytes[place] ^= 1 << random.random_range(0..8),
            1 => bytes.truncate(place),
            2 => {
                let end = (place + random.random_range(1..40)).min(bytes.len());
                bytes.drain(place..end);
            }
            3 => {
                let end = (place + random.random_range(1..200)).min(bytes.len());
                let copy = bytes[place..end].to_vec();
                bytes.splice(end..end, copy);
            }
            4 => bytes[place] = random.random(),
            _ => {
                // One number or word of a text.
                let is_part = |b: &u8| b.is_ascii_alphanumeric() || b".-+_".contains(b);
                let start = bytes[..place].iter().rposition(|b| !is_part(b)).map_or(0, |i| i + 1);
                let end = bytes[place..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |i| place + i);
                let others = [
                    "",
                    "0",
                    "-0",
                    "1",
                    "-1",
                    "1e308",
                    "-1e308",
                    "1e-308",
                    "inf",
                    "nan",
                    "-inf",
                    "x",
                    "\"",
                    ",",
                    "99999999999999999999",
                    "0.5",
                    "2",
                    "1000000",
                    "silicone",
                    "abs",
                    "[]",
                    "true",
                    "\u{feff}",
                    "'",
                ];
                let scaled = std::str::from_utf8(&bytes[start..end.max(start)])
                    .ok()
                    .and_then(|w| w.parse::<f64>().ok());
                let factor = one(random, &[&1e-3, &0.5, &1.01, &2.0, &-1.0, &10.0, &1e3, &1e9]);
                let other = match scaled {
                    Some(n) if random.random() => format!("{}", n * factor),
                    _ => one(random, &others).to_owned(),
                };
                bytes.splice(start..end.max(start), other.into_bytes());
            }
        }
    }
    bytes
}

/// Returns a table whose calibration is fast, and the models of its calibration.
fn small_table_and_models() -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let plan = "seed = 5\nprotocol = \"randomised\"\nlayouts = [[5, 8, 11]]\nweights_g = [251.2, 1003.2, 2005.0, 3007.2, 5002.5]\n\
                speeds_pct = [40, 60]\ndwells_s = [3]\nrepetitions = [3, 3]\n[[effects]]\nid = \"thermal_drift\"\nvalues = [0.8]\n";
    std::fs::write(folder.path().join("plan.toml"), plan).unwrap();
    done(folder.path(), &["-q", "simulate", "plan.toml", "--out", "rig"]);
    done(folder.path(), &["-q", "calibrate", "rig/plateaus.csv", "--out", "c"]);
    let corpus = repository("tests/corpus/model");
    let mut models: Vec<String> = std::fs::read_dir(corpus)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.file_name().unwrap().to_string_lossy().starts_with("accepted-"))
        .map(|p| std::fs::read_to_string(p).unwrap())
        .collect();
    models.sort();
    let model = std::fs::read_to_string(folder.path().join("c/model.toml")).unwrap();
    // Without its hash, so that damaged values are read.
    models.push(model.trim_end().rsplit_once('\n').unwrap().0.to_owned());
    (std::fs::read(folder.path().join("rig/plateaus.csv")).unwrap(), models)
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn damaged_tables_are_calibrated_or_refused() {
    let (whole, models) = small_table_and_models();
    let model = ModelFile::parse(models.last().unwrap(), "model.toml").unwrap();
    campaign("plateau tables", 2000, |seed, random| {
        let bytes = damage(random, &whole);
        let verdict = (|| {
            judge("plateaus", &bytes)?;
            judge("conditions", &bytes)?;
            if let Ok(table) = PlateauTable::read_conditions(bytes.as_slice(), "t.csv") {
                match model.predict(&table.rows, Session::New, "m.toml") {
                    Ok((n, sd)) if n.iter().chain(&sd).any(|x| !x.is_finite()) => {
                        return Err("a prediction that is not finite".to_owned());
                    }
                    Ok(_) => {}
                    Err(e) if e.to_string().chars().count() >= LONGEST => return Err(e.to_string()),
                    Err(_) => {}
                }
            }
            let table = PlateauTable::read(bytes.as_slice(), "t.csv").map_err(|e| e.to_string());
            let table =
                table.and_then(|t| t.require_baseline("t.csv").map(|()| t).map_err(|e| e.to_string()));
            let word = match table {
                Err(_) => "refused with one clear error",
                Ok(table) => match calibrate(&table.rows, &Vocabulary::built_in(), 1) {
                    Err(e) if e.to_string().chars().count() < LONGEST => "refused with one clear error",
                    Err(e) => return Err(e.to_string()),
                    Ok(found) => {
                        let text = ModelFile::new(&found.augmented).to_text().map_err(|e| e.to_string())?;
                        let read = ModelFile::parse(&text, "model.toml")
                            .map_err(|e| format!("its own model is refused: {e}"))?;
                        let (n, sd) = read
                            .predict(&table.rows, Session::Fitted, "model.toml")
                            .map_err(|e| format!("its own table: {e}"))?;
                        if n.iter().chain(&sd).any(|x| !x.is_finite()) {
                            return Err("a prediction that is not finite".to_owned());
                        }
                        "calibrated, and predicted by its own model"
                    }
                },
            };
            if seed % 20 == 0 {
                let folder = in_memory()?;
                std::fs::write(folder.path().join("t.csv"), &bytes).map_err(|e| e.to_string())?;
                let (code, output) = ended(folder.path(), &["-q", "calibrate", "t.csv", "--out", "c"]);
                if word.starts_with("refused") {
                    is_clear(code, &output, &["t.csv"])?;
                } else if code != Some(0) {
                    return Err(format!("calibrated here, but not by the command: {output:.300}"));
                }
            }
            Ok(word)
        })();
        (bytes, verdict)
    });
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn damaged_models_are_refused() {
    let (table, models) = small_table_and_models();
    campaign("model files", 1000, |seed, random| {
        let chosen = &models[random.random_range(0..models.len())];
        let bytes = damage(random, chosen.as_bytes());
        let verdict = (|| {
            let reading = judge("model", &bytes)?;
            if seed % 10 == 0 {
                let folder = in_memory()?;
                std::fs::write(folder.path().join("m.toml"), &bytes).map_err(|e| e.to_string())?;
                std::fs::write(folder.path().join("t.csv"), &table).map_err(|e| e.to_string())?;
                for more in [&["--rows", "t.csv"][..], &["three-double"]] {
                    let (code, output) =
                        ended(folder.path(), &[&["-q", "predict", "--model", "m.toml"], more].concat());
                    match code {
                        Some(0) if output.contains("NaN") || output.contains("inf") => {
                            return Err("NaN is printed".to_owned());
                        }
                        Some(0) => {}
                        _ => is_clear(code, &output, &[])?,
                    }
                }
            }
            Ok(if reading == Reading::Accepted {
                "predicts finite numbers"
            } else {
                "refused with one clear error"
            })
        })();
        (bytes, verdict)
    });
}

/// Returns the text of a sweep of few variants, with random axes, sets and constraints, inside or
/// outside their ranges.
fn sweep_text(random: &mut ChaCha8Rng) -> String {
    let fields = [
        "shell.width_mm",
        "support.plate_mm",
        "tendon.length_mm",
        "segment.grooves",
        "layout.pins",
        "label.text",
        "mould.key_height_mm",
        "mould.kind",
        "support.corner_radius_mm",
        "shell.wall_mm",
        "mesh.chord_tolerance_mm",
        "shell.colour",
    ];
    let parameter = |random: &mut ChaCha8Rng| {
        let field = one(random, &fields);
        let range = Configuration::PARAMETERS
            .iter()
            .find(|p| p.path() == field)
            .map_or(String::new(), |p| (p.range)());
        (field, range)
    };
    let mut text = "[sweep]\nname = \"s\"\nparts = [\"coupon\", \"shell\"]\n[set]\n\"friction.points\" = 3\n\"mesh.chord_tolerance_mm\" = 0.05\n".to_owned();
    if random.random_range(0..4) == 0 {
        let (field, range) = parameter(random);
        text += &format!("\"{field}\" = {}\n", value(random, &range));
    }
    let axis = |random: &mut ChaCha8Rng| {
        let (field, range) = parameter(random);
        let low = value(random, &range);
        let high = value(random, &range);
        match random.random_range(0..6) {
            0 => format!(
                "\"{field}\" = {{ from = {low}, to = {high}, count = {} }}\n",
                random.random_range(0..4)
            ),
            1 => format!(
                "\"{field}\" = {{ from = {low}, to = {high}, step = {:?} }}\n",
                random.random_range(-1.0..20.0)
            ),
            2 => format!("\"{field}\" = {{ from = {low}, to = {high} }}\n"),
            _ => format!("\"{field}\" = [{low}, {high}]\n"),
        }
    };
    match random.random_range(0..4) {
        0 => {
            let method = one(random, &["latin-hypercube", "random", "x"]);
            let count = random.random_range(0..5);
            text += &format!("[sample]\nmethod = \"{method}\"\ncount = {count}\n[sample.axes]\n");
            text += &axis(random);
        }
        1 => text += "[rows]\nfile = \"rows.csv\"\n",
        _ => {
            text += "[axes]\n";
            for _ in 0..random.random_range(1..3) {
                text += &axis(random);
            }
        }
    }
    if random.random_range(0..3) == 0 {
        let constraint = one(
            random,
            &[
                "shell.width_mm > 10",
                "threshold_n > 5",
                "1/0 > shell.width_mm",
                "friction.max_n >",
                "tendon.length_mm < 300 && true",
                "shell.width_mm",
            ],
        );
        text += &format!("[[constraints]]\nrequire = \"{constraint}\"\n");
    }
    text
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn random_sweeps_match_dry_run() {
    campaign("sweeps", 1000, |seed, random| {
        let mut text = sweep_text(random).into_bytes();
        if seed % 4 == 0 {
            text = damage(random, &text);
        }
        let verdict = (|| {
            judge("sweep", &text)?;
            let folder = in_memory()?;
            let path = folder.path();
            std::fs::write(path.join("s.toml"), &text).map_err(|e| e.to_string())?;
            std::fs::write(
                path.join("rows.csv"),
                "\"shell.width_mm\",\"layout.pins\"\n14,\"[5, 8, 11]\"\n3,\"[4, 8]\"\n",
            )
            .map_err(|e| e.to_string())?;
            let dry = pinswitch(path, &["-q", "batch", "s.toml", "--out", "b", "--dry-run", "--json"]);
            let output = String::from_utf8_lossy(&dry.stderr).into_owned();
            if path.join("b").exists() {
                return Err("a dry run wrote".to_owned());
            }
            if dry.status.code() != Some(0) {
                is_clear(dry.status.code(), &output, &[])?;
            } else if let Ok(estimate) = serde_json::from_slice::<serde_json::Value>(&dry.stdout)
                && estimate["variants"].as_u64().is_some_and(|n| n > 60)
            {
                // A run of so many variants takes too long.
                return Ok("dry run only, of many variants");
            }
            let run = pinswitch(path, &["-q", "batch", "s.toml", "--out", "b", "--json"]);
            let run_output = String::from_utf8_lossy(&run.stderr).into_owned();
            if run.status.code() != dry.status.code()
                || (run.status.code() != Some(0) && run_output != output)
            {
                return Err(format!(
                    "dry {:?} {output:.200}\nrun {:?} {run_output:.200}",
                    dry.status.code(),
                    run.status.code()
                ));
            }
            if run.status.code() != Some(0) {
                return Ok("refused alike, with one clear error");
            }
            let read =
                |bytes: &[u8]| serde_json::from_slice::<serde_json::Value>(bytes).map_err(|e| e.to_string());
            let (estimate, tally) = (read(&dry.stdout)?, read(&run.stdout)?);
            let refused: u64 = estimate["refused"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(|r| r["count"].as_u64())
                .sum();
            let is_same = tally["made"] == estimate["made"]
                && tally["refused"].as_u64() == Some(refused)
                && tally["failed"] == 0;
            if is_same { Ok("made, equal to the dry run") } else { Err(format!("{estimate}\n{tally}")) }
        })();
        (text, verdict)
    });
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn damaged_meshes_are_examined_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    done(
        folder.path(),
        &["-q", "generate", "three-double", "--out", "set", "--format", "stl", "--tolerance", "0.1"],
    );
    let mut whole: Vec<Vec<u8>> = ["set", "../corpus"]
        .iter()
        .map(|name| if *name == "set" { folder.path().join("set") } else { repository("tests/corpus/stl") })
        .flat_map(|folder| std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()))
        .filter(|p| p.extension().is_some_and(|e| e == "stl"))
        .map(|p| std::fs::read(p).unwrap())
        .collect();
    whole.sort();
    campaign("STL and 3MF", 2000, |seed, random| {
        let chosen = whole[random.random_range(0..whole.len())].clone();
        let bytes = if random.random_range(0..3) == 0 && chosen.len() > 134 && !chosen.starts_with(b"PK") {
            // A number of a facet of a binary STL.
            let mut bytes = chosen;
            for _ in 0..random.random_range(1..20) {
                let at = 84
                    + 50 * random.random_range(0..(bytes.len() - 84) / 50)
                    + 4 * random.random_range(0..12);
                let n = *one(
                    random,
                    &[
                        &f32::NAN,
                        &f32::INFINITY,
                        &f32::MAX,
                        &0.0,
                        &-1.0,
                        &f32::MIN_POSITIVE,
                        &1e-40,
                        &1e20,
                        &12.5,
                    ],
                );
                if let Some(place) = bytes.get_mut(at..at + 4) {
                    place.copy_from_slice(&n.to_le_bytes());
                }
            }
            bytes
        } else {
            damage(random, &chosen)
        };
        let verdict = (|| {
            let reading = judge("stl", &bytes)?;
            if seed % 20 == 0 {
                let folder = in_memory()?;
                std::fs::write(folder.path().join("a.stl"), &bytes).map_err(|e| e.to_string())?;
                let (code, output) = ended(folder.path(), &["-q", "check", "a.stl"]);
                match (reading, code) {
                    (Reading::Accepted, Some(0 | 1)) => {}
                    (Reading::Refused, _) => is_clear(code, &output, &["a.stl"])?,
                    _ => return Err(format!("{code:?} {output:.300}")),
                }
            }
            Ok(if reading == Reading::Accepted { "examined" } else { "refused with one clear error" })
        })();
        (bytes, verdict)
    });
}

/// A batch to damage: 4 variants, some of them refused.
const BATCH: &str = "[sweep]\nname = \"small\"\nparts = [\"coupon\", \"shell\"]\nplots = true\n[set]\n\"friction.points\" = 3\n\
                     [axes]\n\"segment.grooves\" = [15, 60]\n\"tendon.length_mm\" = [200, 300]\n";

/// Flips bits of files of a folder, or cuts, replaces or deletes them; returns a log of the
/// changes.
fn damage_files(random: &mut ChaCha8Rng, folder: &Path, names: &[String]) -> String {
    let mut log = String::new();
    for _ in 0..random.random_range(1..4) {
        let path = folder.join(&names[random.random_range(0..names.len())]);
        let Ok(bytes) = std::fs::read(&path) else { continue };
        // Creates a new file in most cases, since parts are links to one file.
        let by_link = random.random_range(0..4) == 0;
        if !by_link {
            std::fs::remove_file(&path).unwrap();
        }
        let how = random.random_range(0..4);
        log += &format!("{} {how} {by_link}\n", path.display());
        match how {
            0 if !bytes.is_empty() => {
                let mut bytes = bytes;
                let bit = random.random_range(0..8 * bytes.len());
                bytes[bit / 8] ^= 1 << (bit % 8);
                std::fs::write(&path, bytes).unwrap();
            }
            1 => std::fs::write(&path, &bytes[..random.random_range(0..bytes.len().max(1))]).unwrap(),
            2 => std::fs::write(&path, damage(random, &bytes)).unwrap(),
            _ => drop(std::fs::remove_file(&path)),
        }
    }
    log
}

fn copied(from: &Path, to: &Path) {
    let done = std::process::Command::new("cp").arg("-a").args([from, to]).status().unwrap();
    assert!(done.success());
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn damaged_batches_are_repaired_or_reported() {
    let made = in_memory().unwrap();
    std::fs::write(made.path().join("s.toml"), BATCH).unwrap();
    done(made.path(), &["-q", "batch", "s.toml", "--out", "b"]);
    let whole = hashes(&made.path().join("b"));
    let names: Vec<String> = whole.keys().cloned().collect();
    campaign("damaged batches", 200, |_, random| {
        let folder = in_memory().unwrap();
        let path = folder.path();
        copied(&made.path().join("b"), &path.join("b"));
        std::fs::copy(made.path().join("s.toml"), path.join("s.toml")).unwrap();
        let log = damage_files(random, &path.join("b"), &names);
        let verdict = (|| {
            let stamp = hashes(&path.join("b")).get("batch.json").cloned();
            let (code, output) = ended(path, &["-q", "batch", "s.toml", "--out", "b"]);
            if code == Some(0) {
                let now = hashes(&path.join("b"));
                return if now == whole {
                    Ok("mended")
                } else {
                    Err(format!("after the run: {:?}", crate::harness::differences(&whole, &now)))
                };
            }
            is_clear(code, &output, &["b"])?;
            if stamp == whole.get("batch.json").cloned() {
                return Err(format!("refused though the stamp is whole: {output}"));
            }
            Ok("named, nothing made of it")
        })();
        (log.into_bytes(), verdict)
    });
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn damaged_shards_are_reported() {
    let made = in_memory().unwrap();
    std::fs::write(made.path().join("s.toml"), BATCH).unwrap();
    for shard in ["1/2", "2/2"] {
        done(made.path(), &["-q", "batch", "s.toml", "--out", "b", "--shard", shard]);
    }
    let names: Vec<String> = hashes(&made.path().join("b")).into_keys().collect();
    copied(&made.path().join("b"), &made.path().join("whole"));
    done(made.path(), &["-q", "merge", "whole"]);
    let whole = hashes(&made.path().join("whole"));
    let before = hashes(&made.path().join("b"));
    campaign("damaged shards", 200, |_, random| {
        let folder = in_memory().unwrap();
        let path = folder.path();
        copied(&made.path().join("b"), &path.join("b"));
        let log = damage_files(random, &path.join("b"), &names);
        let verdict = (|| {
            let damaged = hashes(&path.join("b"));
            let (code, output) = ended(path, &["-q", "merge", "b"]);
            let now = hashes(&path.join("b"));
            if damaged == before {
                return if now == whole {
                    Ok("whole after all, and merged")
                } else {
                    Err("merged otherwise".to_owned())
                };
            }
            // A shard without its stamp never ran: the error gives its variants, and the option
            // that makes them.
            let names_variants =
                output.contains("in no finished shard [shards-do-not-join]\n  help: run --shard ");
            is_clear(code, &output, if names_variants { &[] } else { &["b"] })?;
            if now != damaged {
                return Err(format!(
                    "something was written: {:?}",
                    crate::harness::differences(&damaged, &now)
                ));
            }
            Ok("refused and named")
        })();
        (log.into_bytes(), verdict)
    });
}
