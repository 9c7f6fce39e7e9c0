//! Batches, end to end: files and table of a run, shards and merges, failures and Ctrl-C.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{REFUSED, SWEEP, VARIANTS, differences, done, ended, hashes, table, with_sweep};
use pinswitch_batch::{Schema, Sweep, SweepSource, read_rows};

#[test]
fn batches_have_parts_table_and_page() {
    let folder = with_sweep(SWEEP);
    let output = done(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert!(output.contains("b: 12 variants made, 12 refused, 0 failed"), "{output}");
    // Two pin layouts, two tendon lengths, three widths: shells and supports with labels, one
    // coupon, one ring per width.
    assert!(output.contains("48 part files, 28 of them distinct"), "{output}");
    let b = folder.path().join("b");
    let rows = table(&b);
    assert_eq!(rows.len(), VARIANTS);
    let labels: BTreeSet<_> = rows.iter().map(|r| r["label"].clone()).collect();
    let ids: BTreeSet<_> = rows.iter().map(|r| r["id"].clone()).collect();
    assert_eq!((labels.len(), ids.len()), (VARIANTS, VARIANTS));
    let mut stl = Vec::new();
    for row in &rows {
        let of = b.join("variants").join(&row["id"]);
        if row["status"] == "refused" {
            assert!(
                row["reason"].contains("segment.grooves = 60: grooves overlap") && !of.exists(),
                "{row:?}"
            );
            continue;
        }
        assert_eq!((row["status"].as_str(), row["reason"].as_str()), ("made", ""));
        check_variant(&of, row);
        stl.extend(["shell", "mould-ring", "support-left", "coupon"].map(|p| of.join(format!("{p}.stl"))));
    }
    let mut check = vec!["check", "--bodies", "1"];
    check.extend(stl.iter().map(|p| p.to_str().unwrap()));
    assert_eq!(done(folder.path(), &check).matches(": valid;").count(), (VARIANTS - REFUSED) * 4);
    let page = std::fs::read_to_string(b.join("index.html")).unwrap();
    assert!(page.contains("<svg") && page.contains(&rows[0]["id"]) && !page.contains("{{DATA}}"));
    for outside in ["src=\"http", "href=\"http", "@import", "fetch("] {
        assert!(!page.contains(outside), "the page needs {outside}");
    }
    for plot in ["curves.svg", "threshold.svg"] {
        assert!(std::fs::read_to_string(b.join(plot)).unwrap().starts_with("<svg"), "{plot}");
    }
    assert!(
        !std::fs::read_dir(&b).unwrap().any(|e| e.unwrap().file_name().to_string_lossy().starts_with('.'))
    );
}

/// Asserts that the manifest has the hash of every file, and that parts are hard links.
fn check_variant(of: &Path, row: &BTreeMap<String, String>) {
    use std::os::unix::fs::MetadataExt;
    let manifest: serde_json::Value =
        serde_json::from_slice(&std::fs::read(of.join("manifest.json")).unwrap()).unwrap();
    let own = hashes(of);
    assert_eq!(own["manifest.json"], row["manifest_sha256"]);
    assert_eq!(manifest["batch"]["label"], row["label"]);
    // Counts of triangles are in the manifest only.
    assert!(!row.keys().any(|column| column.contains("triangles") || column.contains("beside")));
    let files = manifest["files"].as_array().unwrap();
    assert_eq!(files.len() + 1, own.len());
    for file in files {
        let name = file["file"].as_str().unwrap();
        assert_eq!(file["sha256"], own[name]);
        if let Some(part) = name.strip_suffix(".stl") {
            assert_eq!(row[&format!("{part}.sha256")], own[name]);
            let content = of.join("../..").join(file["content"].as_str().unwrap());
            let inode = |p: &Path| std::fs::metadata(p).unwrap().ino();
            assert_eq!(inode(&content), inode(&of.join(name)));
            let (exact, mesh): (f64, f64) = (
                row[&format!("{part}.volume_mm3")].parse().unwrap(),
                row[&format!("{part}.mesh_volume_mm3")].parse().unwrap(),
            );
            assert!((mesh / exact - 1.0).abs() < 1e-3);
        }
    }
    assert_eq!(
        row["friction_n"].parse::<f64>().unwrap(),
        manifest["friction"]["friction_n"].as_f64().unwrap()
    );
}

#[test]
fn parquet_and_csv_are_equal() {
    let folder = with_sweep(SWEEP);
    done(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    let source = SweepSource::read(&folder.path().join("sweep.toml")).unwrap();
    let schema = Schema::new(&Sweep::new(&source).unwrap());
    let bytes = std::fs::read(folder.path().join("b/variants.parquet")).unwrap();
    let rows: Vec<_> = read_rows(bytes, &schema).unwrap().map(|r| r.unwrap()).collect();
    let csv = table(&folder.path().join("b"));
    assert_eq!(rows.len(), csv.len());
    for (row, csv) in rows.iter().zip(&csv) {
        for (cell, column) in row.iter().zip(schema.columns()) {
            assert_eq!(cell.to_string(), csv[&column.name], "{}", column.name);
        }
    }
}

#[test]
fn dry_runs_write_nothing() {
    let folder = with_sweep(SWEEP);
    let output = done(folder.path(), &["batch", "sweep.toml", "--out", "b", "--dry-run"]);
    let lines: Vec<_> = output.lines().collect();
    assert_eq!(
        lines[..2],
        [
            "small: 24 variants over segment.grooves, shell.width_mm, layout.pins, tendon.length_mm",
            "refused: 12"
        ]
    );
    assert!(lines[2].starts_with("  12 for segment.grooves, such as grooves60_width13"), "{output}");
    assert!(output.contains("made: 12\ntime: about ") && output.contains("\nsize: about "), "{output}");
    assert!(!folder.path().join("b").exists());
    let estimate: serde_json::Value =
        serde_json::from_str(&done(folder.path(), &["batch", "sweep.toml", "--dry-run", "--json"])).unwrap();
    assert_eq!((estimate["variants"].as_u64(), estimate["made"].as_u64()), (Some(24), Some(12)));
    assert!(estimate["measured"]["bytes_per_variant"].as_f64().unwrap() > 50e3);
}

#[test]
fn samples_and_rows_behave_like_axes() {
    let folder = with_sweep(
        "[sweep]\nbase = \"three-single\"\nparts = [\"shell\"]\n[rows]\nfile = \"rows.csv\"\n\
         [sample]\ncount = 3\nseed = 5\n[sample.axes]\n\"shell.width_mm\" = { from = 12, to = 16 }\n",
    );
    std::fs::write(folder.path().join("rows.csv"), "layout.pins,label.text\n\"[5, 8]\",AB\n[7],CD\n")
        .unwrap();
    done(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    let rows = table(&folder.path().join("b"));
    assert_eq!(rows.len(), 6);
    assert_eq!(rows[0]["layout.pins"], "[5,8]");
    assert_eq!(rows[0]["label"], "AB");
    // The same three widths for both rows of the CSV.
    let widths = |rows: &[BTreeMap<String, String>]| {
        rows.iter().map(|r| r["shell.width_mm"].parse::<f64>().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(widths(&rows[..3]), widths(&rows[3..]));
    let mut thirds: Vec<_> = widths(&rows[..3]).iter().map(|w| ((w - 12.0) / 4.0 * 3.0) as usize).collect();
    thirds.sort_unstable();
    assert_eq!(thirds, [0, 1, 2]);
}

#[test]
fn merged_shards_equal_one_run() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "whole"]);
    for shard in ["2/3", "1/3"] {
        done(path, &["batch", "sweep.toml", "--out", "shards", "--shard", shard]);
    }
    let (code, output) = ended(path, &["merge", "shards"]);
    assert_eq!(code, Some(2));
    assert!(
        output.contains(
            "variants 17 to 24 of 24 are in no finished shard [shards-do-not-join]\n  help: run --shard 3/3"
        ),
        "{output}"
    );
    done(path, &["batch", "sweep.toml", "--out", "shards", "--shard", "3/3"]);
    done(path, &["merge", "shards"]);
    let mut merged = hashes(&path.join("shards"));
    merged.retain(|name, _| !name.starts_with("shards/"));
    let whole = hashes(&path.join("whole"));
    assert_eq!(differences(&whole, &merged), Vec::<String>::new());

    done(path, &["batch", "sweep.toml", "--out", "shards", "--shard", "1/2"]);
    let (code, output) = ended(path, &["merge", "shards"]);
    assert!(
        code == Some(2) && output.contains("are both in shard 1/3 of shards and in shard 1/2 of shards"),
        "{output}"
    );

    // Shards of different sizes in two folders, merged into a third one.
    for (out, shard) in [("a", "1/2"), ("b", "3/4"), ("b", "4/4")] {
        done(path, &["batch", "sweep.toml", "--out", out, "--shard", shard]);
    }
    assert_eq!(ended(path, &["merge", "a", "b"]).0, Some(2));
    done(path, &["merge", "a", "b", "--out", "c"]);
    let joined = hashes(&path.join("c"));
    for product in
        ["variants.csv", "variants.parquet", "index.html", "curves.svg", "threshold.svg", "batch.json"]
    {
        assert_eq!(joined[product], whole[product], "{product}");
    }
    std::fs::write(path.join("b/shards/4-of-4/variants.parquet"), "PAR1").unwrap();
    let (code, output) = ended(path, &["merge", "a", "b", "--out", "c"]);
    assert!(code == Some(2) && output.contains("shard 4/4 of b: "), "{output}");
}

#[test]
fn shards_share_a_file_url() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    let url = format!("file://{}/shared/sweep", path.display());
    for shard in ["1/2", "2/2"] {
        done(path, &["batch", "sweep.toml", "--out", &url, "--shard", shard]);
    }
    done(path, &["merge", &url]);
    done(path, &["batch", "sweep.toml", "--out", "whole"]);
    let differing = differences(&hashes(&path.join("shared/sweep")), &hashes(&path.join("whole")));
    // Records of shards are in addition to the files of one run.
    assert!(differing.iter().all(|name| name.starts_with("shards/")), "{differing:?}");
    let again = done(path, &["batch", "sweep.toml", "--out", &url, "--shard", "1/2"]);
    assert!(again.contains("; 12 existed before"), "{again}");
}

#[test]
fn changed_files_are_made_again() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    let before = hashes(&path.join("b"));
    let names: Vec<_> = before.keys().filter(|n| n.starts_with("variants/")).collect();
    let stl: Vec<_> = names.iter().filter(|n| n.ends_with("shell.stl")).collect();
    std::fs::write(path.join("b").join(stl[0]), "damaged, and so is the file it is a link to").unwrap();
    std::fs::remove_file(path.join("b").join(stl[1])).unwrap();
    let manifest = names.iter().find(|n| n.ends_with("manifest.json")).unwrap();
    std::fs::write(path.join("b").join(manifest), "{}").unwrap();
    std::fs::remove_file(path.join("b/variants.parquet")).unwrap();
    let content = before.keys().find(|n| n.starts_with("parts/")).unwrap();
    std::fs::remove_file(path.join("b").join(content)).unwrap();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    assert_eq!(differences(&before, &hashes(&path.join("b"))), Vec::<String>::new());
}

#[test]
fn failed_variants_are_recorded() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    let whole = hashes(&path.join("b"));
    let victim = table(&path.join("b"))[3]["id"].clone();
    let obstacle = path.join("b/variants").join(&victim);
    std::fs::remove_dir_all(&obstacle).unwrap();
    std::fs::write(&obstacle, "a file where a folder must be").unwrap();
    let (code, output) = ended(path, &["batch", "sweep.toml", "--out", "b"]);
    assert!(code == Some(1) && output.contains("11 variants made, 12 refused, 1 failed"), "{output}");
    let row = table(&path.join("b")).swap_remove(3);
    assert_eq!(row["status"], "failed");
    assert!(row["reason"].contains(&victim), "{row:?}");
    let (code, output) = ended(path, &["batch", "sweep.toml", "--out", "b", "--fail-fast"]);
    assert!(
        code == Some(1)
            && output.contains(&format!("variant {victim} failed: "))
            && output.contains("omit --fail-fast to make the other variants"),
        "{output}"
    );
    std::fs::remove_file(&obstacle).unwrap();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    assert_eq!(differences(&whole, &hashes(&path.join("b"))), Vec::<String>::new());
}

#[test]
fn ctrl_c_finishes_started_variants() {
    // Long enough to be interrupted: 400 variants on one thread.
    let folder = with_sweep(
        "[sweep]\nbase = \"three-double\"\n[axes]\n\"shell.width_mm\" = { from = 12, to = 16, count = 400 }\n",
    );
    let mut child = crate::harness::binary()
        .args(["batch", "sweep.toml", "--out", "b", "--threads", "1"])
        .current_dir(folder.path())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let variants = folder.path().join("b/variants");
    let start = Instant::now();
    while std::fs::read_dir(&variants).map_or(0, Iterator::count) < 3 {
        assert!(start.elapsed() < Duration::from_secs(60), "no variant was started");
        std::thread::sleep(Duration::from_millis(5));
    }
    let interrupted = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupted.success());
    let mut output = String::new();
    std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut output).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{output}");
    assert!(
        output.contains("error: stopped: ") && output.contains(" of 400 variants are finished"),
        "{output}"
    );
    // A pipe gets no progress bar.
    assert!(!output.contains('\r') && !output.contains('\u{1b}'), "{output:?}");
    for variant in std::fs::read_dir(&variants).unwrap() {
        assert!(variant.unwrap().path().join("manifest.json").exists());
    }
    assert!(!folder.path().join("b/variants.csv").exists());
    assert!(!folder.path().join("b/.partial-1-of-1").exists());
}

#[test]
fn meshing_errors_are_refusals() {
    let folder = with_sweep(
        "[sweep]\nbase = \"base.toml\"\nparts = [\"proxy\", \"shell\"]\n[set]\n\"friction.points\" = 3\n\
         [axes]\n\"tendon.length_mm\" = [200]\n\"segment.groove_radius_mm\" = [0.9, 1.0]\n",
    );
    let base = crate::harness::repository("tests/corpus/proxy-contours-cross.toml");
    std::fs::copy(base, folder.path().join("base.toml")).unwrap();
    done(folder.path(), &["-q", "batch", "sweep.toml", "--out", "b"]);
    let rows = crate::harness::table(&folder.path().join("b"));
    let of = |status: &str| rows.iter().filter(|row| row["status"] == status).collect::<Vec<_>>();
    assert_eq!((of("made").len(), of("refused").len()), (1, 1), "{rows:?}");
    let reason = &of("refused")[0]["reason"];
    assert!(
        reason.starts_with("segment.groove_radius_mm = 1") && reason.contains("; lower it to"),
        "{reason}"
    );
}
