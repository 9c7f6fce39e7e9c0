//! Batches with damaged, edited or deleted files: a resumed run makes them again, a merge reports
//! them; and sweeps that are refused before they are expanded, in a dry run as in a run.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::harness::{SWEEP, differences, done, ended, hashes, with_sweep};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Flips one bit of a file.
fn flip(path: &Path, random: &mut ChaCha8Rng) {
    let mut bytes = std::fs::read(path).unwrap();
    let bit = random.random_range(0..8 * bytes.len());
    bytes[bit / 8] ^= 1 << (bit % 8);
    // Creates a new file, since the parts of several variants are links to one file.
    std::fs::remove_file(path).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// Returns the JSON with a valid checksum, to test consistency checks behind it.
fn sealed(value: &serde_json::Value) -> String {
    let text = serde_json::to_string_pretty(value).unwrap();
    let body = text.strip_suffix("\n}").unwrap();
    format!("{body},\n  \"checksum\": \"{}\"\n}}\n", crate::harness::sha256(body.as_bytes()))
}

fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn damaged_files_are_made_again() {
    let folder = with_sweep(SWEEP);
    let (path, b) = (folder.path(), folder.path().join("b"));
    let run = || done(path, &["-q", "batch", "sweep.toml", "--out", "b"]);
    run();
    let whole = hashes(&b);
    let expect_repair = |what: &str| {
        assert_ne!(hashes(&b), whole, "{what}");
        run();
        assert_eq!(differences(&whole, &hashes(&b)), Vec::<String>::new(), "{what}");
    };
    let names: Vec<_> = whole.keys().filter(|n| n.contains('/')).collect();
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let manifests: Vec<_> = names.iter().filter(|n| n.ends_with("manifest.json")).collect();
    // Several at once, in different files: each must be seen.
    for round in 0..4 {
        for name in &manifests {
            flip(&b.join(name), &mut random);
        }
        expect_repair(&format!("manifests, round {round}"));
        for name in names.iter().filter(|n| n.starts_with("parts/") == (round % 2 == 0)).step_by(3) {
            flip(&b.join(name), &mut random);
        }
        expect_repair(&format!("files, round {round}"));
    }
    // A forged manifest that lists nothing, and the shell is gone.
    let manifest = b.join(manifests[0]);
    let mut forged = read_json(&manifest);
    forged["files"] = serde_json::json!([]);
    forged.as_object_mut().unwrap().remove("checksum");
    std::fs::write(&manifest, sealed(&forged)).unwrap();
    std::fs::remove_file(manifest.with_file_name("shell.stl")).unwrap();
    expect_repair("forged");
    // A stamp of the same sweep is written again.
    let stamp = std::fs::read_to_string(b.join("batch.json")).unwrap();
    for (from, to) in
        [("\"variants\": 24", "\"variants\": 23"), ("13, to", "12, to"), ("sweep.toml\"", "s.toml\"")]
    {
        assert!(stamp.contains(from), "{from}");
        std::fs::write(b.join("batch.json"), stamp.replace(from, to)).unwrap();
        expect_repair(from);
    }
}

#[test]
fn merges_report_damaged_files() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    for shard in ["1/2", "2/2"] {
        done(path, &["-q", "batch", "sweep.toml", "--out", "b", "--shard", shard]);
    }
    let copy = |name: &str| {
        let made = Command::new("cp").args(["-r", "b", name]).current_dir(path).status().unwrap();
        assert!(made.success());
        path.join(name)
    };
    let refused = |what: &str, name: &str, words: &[&str]| {
        let before = hashes(&path.join(name));
        let (code, output) = ended(path, &["-q", "merge", name]);
        assert_eq!(code, Some(2), "{what}: {output}");
        assert!(
            output.starts_with("error: ")
                && output.len() < 600
                && output.lines().skip(1).all(|l| l.starts_with("  help: ")),
            "{what}: {output}"
        );
        for word in words {
            assert!(output.contains(word), "{what}: {word}: {output}");
        }
        assert_eq!(hashes(&path.join(name)), before, "{what}: something was written");
    };
    let whole = path.join("b");
    let variant = std::fs::read_dir(whole.join("variants")).unwrap().next().unwrap().unwrap();
    let id = variant.file_name().to_string_lossy().into_owned();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let damaged = copy("damaged");
    for file in [
        "shards/1-of-2/variants.parquet",
        "shards/2-of-2/variants.csv",
        "shards/1-of-2/shard.json",
        "batch.json",
    ] {
        let rounds = if file.ends_with("parquet") { 24 } else { 8 };
        for round in 0..rounds {
            flip(&damaged.join(file), &mut random);
            let shard = if file.starts_with("shards") { "of damaged: " } else { "damaged" };
            refused(&format!("{file} {round}"), "damaged", &[shard]);
            std::fs::copy(whole.join(file), damaged.join(file)).unwrap();
        }
    }
    for (file, named) in
        [("shell.stl", "shell.stl"), ("friction.csv", "friction.csv"), ("manifest.json", "manifest.json")]
    {
        let place = damaged.join("variants").join(&id).join(file);
        flip(&place, &mut random);
        refused("changed", "damaged", &[&format!("{id}/{named} is missing or has changed"), "run it again"]);
        std::fs::remove_file(&place).unwrap();
        refused("deleted", "damaged", &[&format!("{id}/{named}")]);
        std::fs::copy(variant.path().join(file), &place).unwrap();
    }
    std::fs::remove_dir_all(damaged.join("variants").join(&id)).unwrap();
    refused("variant", "damaged", &[&format!("{id}/manifest.json is missing")]);
    std::fs::remove_dir_all(damaged.join("parts")).unwrap();
    refused("parts", "damaged", &[" more are missing or have changed"]);

    // Stamps that were edited and have a valid checksum.
    let edited = copy("edited");
    let stamp = read_json(&edited.join("batch.json"));
    for (pointer, value) in [
        ("/variants", serde_json::json!(12)),
        ("/variants", serde_json::json!(u64::MAX)),
        ("/source/sweep", serde_json::json!(SWEEP.replace("[200, 300]", "[200, 301]"))),
        ("/source/base", serde_json::json!("")),
        ("/source/name", serde_json::json!("../../x")),
        ("/schema", serde_json::json!("pinswitch.batch/9")),
    ] {
        let mut forged = stamp.clone();
        *forged.pointer_mut(pointer).unwrap() = value;
        forged.as_object_mut().unwrap().remove("checksum");
        std::fs::write(edited.join("batch.json"), sealed(&forged)).unwrap();
        refused(pointer, "edited", &["edited/batch.json: "]);
    }
    std::fs::copy(whole.join("batch.json"), edited.join("batch.json")).unwrap();
    let place = edited.join("shards/2-of-2/shard.json");
    let stamp = read_json(&place);
    for (pointer, value) in [
        ("/variants/start", serde_json::json!(13)),
        ("/variants/end", serde_json::json!(25)),
        ("/shard/of", serde_json::json!(0)),
        ("/shard/number", serde_json::json!(1)),
        ("/tables", serde_json::json!({})),
    ] {
        let mut forged = stamp.clone();
        *forged.pointer_mut(pointer).unwrap() = value;
        forged.as_object_mut().unwrap().remove("checksum");
        std::fs::write(&place, sealed(&forged)).unwrap();
        refused(pointer, "edited", &[]);
    }
    std::fs::copy(whole.join("shards/2-of-2/shard.json"), &place).unwrap();
    done(path, &["-q", "merge", "edited"]);
}

#[test]
fn large_sweeps_are_refused_unexpanded() {
    let fine = |field: &str| format!("\"{field}\" = {{ from = 10, to = 12, step = 1e-6 }}\n");
    let three = ["shell.width_mm", "support.plate_mm", "tendon.length_mm"].map(fine).concat();
    let sample = "[sample]\ncount = 10000000\n[sample.axes]\n\"shell.width_mm\" = { from = 12, to = 16 }\n\
                  \"support.plate_mm\" = { from = 3, to = 4 }\n\"support.slots\" = [\"all\", \"occupied\"]\n";
    let many = "[axes]\n\"shell.width_mm\" = { from = 12, to = 16, count = 9999999 }\n";
    let start = Instant::now();
    for sweep in
        [&format!("[axes]\n{three}"), sample, many, &format!("{sample}[axes]\n{}", fine("tendon.length_mm"))]
    {
        let folder = with_sweep(sweep);
        for more in ["--out b", "--dry-run", "--dry-run --out b"] {
            // 256 MB of address space; threads and the program itself need most of it.
            let command = format!("ulimit -v 262144; exec \"$0\" batch sweep.toml {more}");
            let mut run = Command::new("sh");
            run.args(["-c", &command, env!("CARGO_BIN_EXE_pinswitch")]).current_dir(folder.path());
            let output = run.output().unwrap();
            let message = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(
                message.contains(
                    " variants are more than 10000 [too-many-variants]\n  help: allow them with --yes"
                ),
                "{message}"
            );
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
    assert!(start.elapsed() < Duration::from_secs(5), "12 refusals took {:?}", start.elapsed());
}

#[test]
fn dry_runs_refuse_like_runs() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    std::fs::write(path.join("file"), "").unwrap();
    std::fs::create_dir(path.join("papers")).unwrap();
    std::fs::write(path.join("papers/thesis"), "dear").unwrap();
    std::fs::write(path.join("other.toml"), SWEEP.replace("\"small\"", "\"other\"")).unwrap();
    done(path, &["-q", "batch", "other.toml", "--out", "other"]);
    std::fs::create_dir(path.join("broken")).unwrap();
    std::fs::write(path.join("broken/batch.json"), "{").unwrap();
    let before = hashes(path);
    let places: Vec<&str> =
        vec!["file", "file/b", "/proc/b", "gopher://x/b", "file://b", "papers", "other", "broken"];
    for out in places {
        let run = ended(path, &["batch", "sweep.toml", "--out", out]);
        let dry = ended(path, &["batch", "sweep.toml", "--out", out, "--dry-run"]);
        assert_eq!(run, dry);
        assert_eq!(run.0, Some(2), "{out}");
        assert_eq!(hashes(path), before, "{out}");
    }
    for more in [&["--shard", "1/99"][..], &["--shard", "3/2"]] {
        let run = ended(path, &[&["batch", "sweep.toml", "--out", "new"], more].concat());
        let dry = ended(path, &[&["batch", "sweep.toml", "--out", "new", "--dry-run"], more].concat());
        assert_eq!(run, dry);
    }
    // A dry run leaves no folders.
    done(path, &["-q", "batch", "sweep.toml", "--out", "deep/new", "--dry-run"]);
    assert!(!path.join("deep").exists());

    // Refusals that occur when the mould is built are in the estimate, too.
    let sweep = "[sweep]\nparts = [\"shell\", \"mould-ring\"]\n[axes]\n\"mould.key_height_mm\" = [2, 10]\n\
                 \"shell.width_mm\" = [5, 14]\n\"mould.key_diameter_mm\" = [3, 9.5]\n\"support.corner_radius_mm\" = [1.5, 4.7]\n";
    std::fs::write(path.join("keys.toml"), sweep).unwrap();
    let estimate: serde_json::Value =
        serde_json::from_str(&done(path, &["-q", "batch", "keys.toml", "--dry-run", "--json"])).unwrap();
    let refused: u64 =
        estimate["refused"].as_array().unwrap().iter().map(|r| r["count"].as_u64().unwrap()).sum();
    let tally: serde_json::Value =
        serde_json::from_str(&done(path, &["-q", "batch", "keys.toml", "--out", "keys", "--json"])).unwrap();
    assert_eq!((tally["refused"].as_u64().unwrap(), tally["failed"].as_u64().unwrap()), (refused, 0));
    assert!(refused > 0 && tally["made"].as_u64().unwrap() == estimate["made"].as_u64().unwrap());
}
