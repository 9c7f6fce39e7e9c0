//! Bad input: one error with field, value, bound and help, exit code 2, and nothing written.

use crate::harness::{binary, ended};

/// Runs `generate` on `text`; returns the exit code, the output, and the number of new files.
fn generate(text: &str) -> (Option<i32>, String, usize) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my.toml"), text).unwrap();
    let (code, output) = ended(folder.path(), &["generate", "my.toml", "--out", "set"]);
    (code, output, std::fs::read_dir(folder.path()).unwrap().count() - 1)
}

/// Every rule in cad/doc/dimensions.md that refuses a configuration.
const REFUSED: [(&str, &[&str]); 29] = [
    ("[segment]\ngrooves = 40", &["my.toml:2:11: segment.grooves = 40", "overlap", "lower it to"]),
    (
        "[segment]\nend_margin_mm = 0\n[print]\nelephant_foot_mm = 0.3",
        &["my.toml:4:20: print.elephant_foot_mm = 0.3", "raise segment.end_margin_mm to"],
    ),
    (
        "[shell]\nouter_radius_mm = 14",
        &["my.toml:2:19: shell.outer_radius_mm = 14", "between neighbouring slots", "raise it to"],
    ),
    (
        "[shell]\nwall_mm = 1.2",
        &["my.toml:2:11: shell.wall_mm = 1.2", "under the grooves", "raise it to 4.9"],
    ),
    ("[shell]\nwall_mm = 19.5", &["shell.wall_mm = 19.5", "lower it to 14.555"]),
    ("[layout]\npins = [5, 5]", &["my.toml:2:8: layout.pins = [5, 5]", "two pins in groove 5"]),
    ("[layout]\npins = [5, 16]", &["layout.pins = [5, 16]", "grooves 1 to 15"]),
    ("[layout]\npins = [0]", &["layout.pins = [0]", "groove 0"]),
    ("[pins]\ndiameter_mm = 1.2", &["pins.diameter_mm = 1.2", "wider than their groove", "lower it to 0.99"]),
    ("[silicone]\nthickness_mm = 0.8", &["silicone.thickness_mm = 0.8", "raise it to 1.141"]),
    ("[support]\nrise_mm = 0.5", &["support.rise_mm = 0.5", "outside the slots", "raise it to"]),
    ("[support]\ntravel_margin_mm = 1.5", &["support.travel_margin_mm = 1.5", "into the shell"]),
    (
        "[support]\nslot_floor_mm = 2.9",
        &["support.slot_floor_mm = 2.9", "lower it to", "set support.slot_kind = \"through\""],
    ),
    ("[support]\nplate_mm = 1.5", &["support.plate_mm = 1.5", "pins engage too little"]),
    (
        "[tendon]\nrope_diameter_mm = 6.0\n[shell]\nwidth_mm = 6.0",
        &["tendon.rope_diameter_mm = 6", "channel"],
    ),
    ("[tendon]\nrope_diameter_mm = 5.0", &["tendon.rope_diameter_mm = 5", "bend radius"]),
    (
        "[layout]\nwrap_angle_deg = 95.0",
        &["layout.wrap_angle_deg = 95", "exceeds the segment (95 deg, at most 89.45 deg)"],
    ),
    ("[shell]\nwidth_mm = nan", &["my.toml:2:12: shell.width_mm = nan", "2 to 100"]),
    ("[shell]\nwidth_mm = inf", &["shell.width_mm = inf", "2 to 100"]),
    ("[fasteners]\nhole_diameter_mm = 8.0", &["fasteners.hole_diameter_mm = 8", "wall"]),
    ("[fasteners]\ncount = 12", &["fasteners.count = 12", "do not fit"]),
    (
        "[shell]\nstop_mm = 0\n[fasteners]\nend_distance_mm = 1.5",
        &["fasteners.end_distance_mm = 1.5", "raise it to"],
    ),
    (
        "[support]\ncorner_radius_mm = 4.7\n[shell]\nstop_mm = 0",
        &["my.toml:2:20: support.corner_radius_mm = 4.7", "outermost slot", "lower it to"],
    ),
    (
        "[mould]\nkey_diameter_mm = 9.5",
        &["my.toml:2:19: mould.key_diameter_mm = 9.5", "between the keys", "lower it to"],
    ),
    ("[mould]\nkey_height_mm = 10.0", &["my.toml:2:17: mould.key_height_mm = 10", "at most", "lower it to"]),
    ("[friction]\nload_min_n = 60", &["friction.load_min_n = 60", "load_max_n = 49.671"]),
    (
        "[print]\nbed_mm = 50\n[shell]\nouter_radius_mm = 60",
        &["print.bed_mm = 50: bed too small for mould-core", "raise it to 107.787"],
    ),
    (
        "[print]\nbed_mm = 55",
        &["print.bed_mm = 55: bed too small for coupon", "54.5 x", "raise it to 60.5", "parts.coupon"],
    ),
    ("[layout]\nsubstrate = \"abs\"\npins = []", &["layout.pins = []", "no pin within the wrap"]),
];

/// An error is two parts: the location and the problem, then the help.
#[test]
fn every_rule_refuses_with_help() {
    for (text, words) in REFUSED {
        let (code, output, written) = generate(text);
        assert_eq!(code, Some(2), "{text}: {output}");
        assert_eq!(written, 0, "{text}");
        let lines = |start: &str| output.lines().filter(|line| line.starts_with(start)).count();
        assert_eq!((lines("error: "), lines("  help: ")), (1, 1), "{text}: {output}");
        assert!(output.starts_with("error: my.toml:"), "{output}");
        for word in words {
            assert!(output.contains(word), "{word} is not in {output}");
        }
    }
}

#[test]
fn unreadable_configurations_are_refused() {
    for (text, word) in [
        ("[shell", "invalid TOML"),
        ("[shell]\nwidht_mm = 3", "did you mean \"width_mm\"?"),
        ("[sehll]\nwidth_mm = 3", "did you mean \"shell\"?"),
        ("[shell]\nwidth_mm = \"14\"", "without quotes"),
        ("\u{0}", "invalid TOML"),
    ] {
        let (code, output, written) = generate(text);
        assert!(code == Some(2) && output.contains(word), "{text:?}: {output}");
        assert_eq!(written, 0);
    }
}

/// Errors name the option that gave a value.
#[test]
fn invalid_arguments_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (&["three-dubble"][..], &["three-dubble: no such file", "nearest template is \"three-double\""][..]),
        (&["three-double", "--set", "shell.width_mm=1"], &["error: --set: shell.width_mm = 1: "]),
        (
            &["three-double", "--set", "layout.pins=[99]"],
            &["error: --set: layout.pins = [99]: ", "pin in groove 99"],
        ),
        (&["three-double", "--set", "silicone=3"], &["error: --set: ", "--set silicone.thickness_mm=3"]),
        (
            &["three-double", "--tolerance", "1"],
            &["error: --tolerance: mesh.chord_tolerance_mm = 1.0: ", "  help: "],
        ),
        (&[], &["<CONFIG>"]),
    ] {
        let (code, output) = ended(folder.path(), &[&["generate"], arguments].concat());
        assert_eq!(code, Some(2), "{arguments:?}: {output}");
        for word in words {
            assert!(output.contains(word), "{word} is not in {output}");
        }
    }
    // Only built-in effects explain the maxima of the paper.
    let (code, output) =
        ended(folder.path(), &["calibrate", "--published", "--effects", "mine.toml", "--out", "x"]);
    assert!(code == Some(2) && output.contains("cannot be used with '--effects <FILE>'"), "{output}");
}

/// Negative numbers are values, not options, so that the error contains the bound.
#[test]
fn negative_numbers_are_compared_with_bounds() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (
            "generate three-double --tolerance -1",
            ["--tolerance: mesh.chord_tolerance_mm = -1.0: ", "0.001 to 0.1"],
        ),
        (
            "experiment x --minutes -5 --out y",
            ["--minutes = -5: not a time", "minutes above 0 and up to 2400"],
        ),
        ("check --min-wall -1 x.stl", ["--min-wall = -1: not a wall thickness", "give 0 or more mm"]),
        ("batch sweep.toml --dry-run --threads -1", ["'-1' for '--threads <N>'", "not in 0..=256"]),
        ("simulate --seed -1", ["'-1' for '--seed <SEED>'", "invalid digit"]),
    ] {
        let (code, output) = ended(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
        assert_eq!(code, Some(2), "{arguments}: {output}");
        assert!(words.iter().all(|word| output.contains(word)), "{arguments}: {output}");
        assert!(!output.contains("unexpected argument"), "{output}");
    }
}

/// A valid configuration whose set cannot be written gives exit code 1.
#[test]
fn obstructing_files_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("taken"), "mine").unwrap();
    let (code, output) = ended(folder.path(), &["generate", "three-double", "--out", "taken"]);
    assert!(code == Some(1) && output.contains("taken: cannot write"), "{output}");
    assert_eq!(std::fs::read_to_string(folder.path().join("taken")).unwrap(), "mine");
}

#[test]
fn missing_files_suggest_a_starter() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        ("power", "tip: `pinswitch init plan --out plan.toml` writes one to start from"),
        ("segment --out x.csv", "tip: `pinswitch init run --out run.toml` writes one to start from"),
        ("segment", "pinswitch init run"),
        ("batch --out x", "pinswitch init sweep"),
        (
            "init rigs",
            "the nearest is `pinswitch init rig`; the kinds are sweep, configurations, effects, plan, run, rig,",
        ),
        ("init power", "`power` needs `pinswitch init plan`"),
    ] {
        let (code, output) = ended(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
        assert!(code == Some(2) && output.contains(words), "{arguments}: {output}");
    }
}

/// A closed or full standard error does not change the exit code.
#[test]
#[cfg(target_os = "linux")]
fn unwritable_errors_keep_their_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let long = format!("simulate --effect {} --out k1 --seed {}", "x".repeat(2000), "y".repeat(2000));
    for arguments in ["simulate --effect nosuch=1 --out k1", "--nosuch", &long] {
        let code = |stderr: std::process::Stdio| {
            let mut command = binary();
            command.args(arguments.split(' ')).current_dir(folder.path()).stderr(stderr);
            command.status().unwrap().code()
        };
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        assert_eq!(code(full.into()), Some(2), "{arguments}");
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        assert_eq!(code(writer.into()), Some(2), "{arguments}");
    }
    // A command that only logs does its work.
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = binary();
    command.args(["-v", "simulate", "--out", "k2"]).current_dir(folder.path()).stderr(full);
    assert_eq!(command.status().unwrap().code(), Some(0));
}

/// Every value out of range, in the file or an option, becomes the nearest one in range.
#[test]
fn fix_moves_values_into_range() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[shell]\nwidth_mm = 500 # wide\n[segment]\ngrooves = 1000\n";
    std::fs::write(folder.path().join("mine.toml"), text).unwrap();
    let generate = ["generate", "mine.toml", "--format", "stl", "--out", "set"];
    let (code, output) = ended(folder.path(), &generate);
    assert!(code == Some(2) && output.contains("mine.toml:2:12: shell.width_mm = 500: outside"), "{output}");
    let fix = [&generate[..], &["--fix", "--set", "print.line_mm=99"]].concat();
    let (code, output) = ended(folder.path(), &fix);
    assert!(code == Some(0), "{output}");
    for (change, reason) in [
        ("shell.width_mm: 500 -> ", "outside 2 to 100"),
        ("segment.grooves: 1000 -> ", "outside 1 to 60"),
        ("print.line_mm: 99 -> 1.5", "outside 0.1 to 1.5"),
    ] {
        let is_reported = |line: &str| {
            line.contains(&format!("changed {change}"))
                && line.ends_with(&format!("{reason} [configuration-changed]"))
        };
        assert!(output.lines().any(is_reported), "{output}");
    }
    let fixed = std::fs::read_to_string(folder.path().join("set").join("fixed.toml")).unwrap();
    assert!(fixed.contains(" # wide") && !fixed.contains("500"), "{fixed}");
    let (code, output) =
        ended(folder.path(), &["generate", "set/fixed.toml", "--format", "stl", "--out", "again"]);
    assert!(code == Some(0), "{output}");
}

/// `--fix` builds the nearest feasible configuration, reports what it changed, and keeps the rest
/// of the file.
#[test]
fn fix_builds_the_nearest_configuration() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.toml"), "# mine\n[segment]\ngrooves = 40 # many\n").unwrap();
    let (code, output) =
        ended(folder.path(), &["generate", "mine.toml", "--format", "stl", "--out", "refused"]);
    assert!(code == Some(2) && !folder.path().join("refused").join("manifest.json").exists(), "{output}");
    let (code, output) =
        ended(folder.path(), &["generate", "mine.toml", "--fix", "--format", "stl", "--out", "fixed"]);
    assert!(code == Some(0) && output.contains("segment.grooves: 40 -> 20: grooves overlap"), "{output}");
    let fixed = folder.path().join("fixed").join("fixed.toml");
    let text = std::fs::read_to_string(&fixed).unwrap();
    assert!(text.contains("# mine") && text.contains("grooves = 20 # many"), "{text}");
    // The fixed configuration makes the same parts, and has nothing left to fix.
    let again = ["generate", "fixed/fixed.toml", "--fix", "--format", "stl", "--out", "again"];
    let (code, output) = ended(folder.path(), &again);
    assert!(code == Some(0) && output.contains("nothing to fix"), "{output}");
    let shell = |set: &str| std::fs::read(folder.path().join(set).join("shell.stl")).unwrap();
    assert_eq!(shell("fixed"), shell("again"));
}
