//! Segmentation of raw logs, end to end, compared with the true plateaus.

use crate::harness::{binary, repository};

/// True plateaus of the two logs in `tests/data/raw`, which are copies of rig data.
const TRUTH: &str = include_str!("../data/raw/truth.csv");

fn run_toml(files: [&str; 2]) -> String {
    format!(
        "[rig]\nwrap_angle_deg = 63.89\nsample_rate_hz = 200.0\nhook_mass_g = 62.53\nstroke_mm = 152.4\non_s = 0.5\n\
         dwell_s = 3.0\n\n[[series]]\nfile = \"{}\"\nsubstrate = \"silicone\"\npins = []\nload_mass_g = 5002.5\n\
         speed_pct = 57\nsweep = \"up\"\n\n[[series]]\nfile = \"{}\"\nsubstrate = \"silicone\"\npins = [5, 8, 11]\n\
         load_mass_g = 2505.4\nspeed_pct = 52\nsweep = \"up\"\n",
        files[0], files[1]
    )
}

#[test]
fn plateaus_are_accurate() {
    let files = ["silicone_5002g.csv.gz", "device-three-double_2505g.csv.gz"];
    let folder = tempfile::tempdir().unwrap();
    let raw = repository("tests/data/raw");
    for file in files {
        std::fs::copy(raw.join(file), folder.path().join(file)).unwrap();
    }
    let run = folder.path().join("run.toml");
    std::fs::write(&run, run_toml(files)).unwrap();
    let out = folder.path().join("plateaus.csv");
    let done = binary().arg("segment").arg(&run).arg("--out").arg(&out).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let table = std::fs::read_to_string(&out).unwrap();
    let mut found = std::collections::BTreeMap::new();
    for line in table.lines().skip(1) {
        let c: Vec<&str> = line.split(',').collect();
        let file = files[c[0].parse::<usize>().unwrap()];
        found.insert(format!("{file},{},{}", c[8], c[9]), c[12].parse::<f64>().unwrap());
    }
    let (mut sum, mut count) = (0.0, 0);
    for line in TRUTH.lines().skip(1).filter(|l| files.iter().any(|f| l.starts_with(f))) {
        let (key, force) = line.rsplit_once(',').unwrap();
        let read = found.remove(key).unwrap_or_else(|| panic!("{key} was not found"));
        sum += (read - force.parse::<f64>().unwrap()).powi(2);
        count += 1;
    }
    assert!(found.is_empty(), "not in the log: {found:?}");
    assert!(count > 80);
    let rms = (sum / f64::from(count)).sqrt();
    assert!(rms < 0.02, "{rms}");
    assert!(folder.path().join("plateaus.json").exists());
    assert!(folder.path().join("plateaus-silicone_5002g.svg").exists());
}

/// Segments a run of `tests/data/raw` and returns the rows of its table by column.
fn segmented(name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plateaus.csv");
    let run = repository("tests/data/raw").join(name).join("run.toml");
    let done = binary().arg("segment").arg(run).arg("--out").arg(&out).arg("--no-plots").output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let table = std::fs::read_to_string(&out).unwrap();
    let (header, lines) = table.split_once('\n').unwrap();
    let names: Vec<&str> = header.split(',').collect();
    let row = |line: &str| {
        names.iter().zip(line.split(',')).map(|(n, c)| ((*n).to_owned(), c.to_owned())).collect()
    };
    lines.lines().map(row).collect()
}

/// Rests of 1.5, 3 and 8 s in a run that declares 3 s.
#[test]
fn dwells_are_measured() {
    let rows = segmented("dwells");
    assert_eq!(rows.len(), 24);
    for row in rows {
        assert_eq!(row["dwell_s"], ["1.5", "3", "8"][row["series"].parse::<usize>().unwrap()], "{row:?}");
    }
}

/// Logs that start with the motor: friction adds to a pulled load, and takes from a released one.
#[test]
fn moves_at_the_start_of_a_log_have_their_direction() {
    let rows = segmented("triggered");
    assert_eq!(rows.len(), 72);
    for row in rows {
        let [load_n, force_n] = ["load_N", "force_N"].map(|name| row[name].parse::<f64>().unwrap());
        assert_eq!(row["direction"] == "concentric", force_n > load_n, "{row:?}");
    }
}

/// Logs of a machine with other names, units and decimal signs give the same table with a map.
#[test]
fn foreign_logs_are_read_with_a_map() {
    use std::io::Read;
    let (folder, file) = (tempfile::tempdir().unwrap(), "silicone_5002g.csv.gz");
    let raw = std::fs::read(repository("tests/data/raw").join(file)).unwrap();
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(raw.as_slice()).read_to_string(&mut text).unwrap();
    // Seconds as milliseconds, newtons as kilonewtons: shifts of the decimal sign.
    let shifted = |cell: &str, places: i32| {
        let value: f64 = cell.parse().unwrap();
        let decimals = cell.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
        format!("{:.*}", usize::try_from(decimals - places).unwrap_or(0), value * 10f64.powi(places))
            .replace('.', ",")
    };
    let mut foreign = "Zeit [ms];Kraft [kN];Weg [mm];Leistung [W]\n".to_owned();
    for line in text.lines().skip(1) {
        let c: Vec<&str> = line.split(',').collect();
        if c.len() == 4 && c.iter().all(|cell| cell.parse::<f64>().is_ok()) {
            foreign += &format!(
                "{};{};{};{}\n",
                shifted(c[0], 3),
                shifted(c[1], -3),
                c[2].replace('.', ","),
                c[3].replace('.', ",")
            );
        }
    }
    std::fs::write(folder.path().join("a.csv"), &text).unwrap();
    std::fs::write(folder.path().join("b.csv"), foreign).unwrap();
    let ended = |arguments: &[&str]| {
        let done = binary().args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    };
    ended(&["import", "b.csv", "--out", "b-log.csv"]);
    let run = |log: &str| {
        run_toml([log, log]).split("\n[[series]]").take(2).collect::<Vec<_>>().join("\n[[series]]")
    };
    std::fs::write(folder.path().join("a.toml"), run("a.csv")).unwrap();
    std::fs::write(folder.path().join("b.toml"), format!("map = \"b-log.import.toml\"\n{}", run("b.csv")))
        .unwrap();
    ended(&["segment", "a.toml", "--out", "a-table.csv", "--no-plots"]);
    ended(&["segment", "b.toml", "--out", "b-table.csv", "--no-plots"]);
    let table = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert!(table("a-table.csv").lines().count() > 40);
    assert_eq!(table("a-table.csv"), table("b-table.csv"));
}

#[test]
fn missing_logs_and_columns_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run.toml");
    std::fs::write(&run, run_toml(["a.csv", "b.csv"])).unwrap();
    let out = folder.path().join("out.csv");
    let segment = || {
        let mut command = binary();
        let done = command.arg("segment").arg(&run).arg("--out").arg(&out).output().unwrap();
        assert_eq!(done.status.code(), Some(2));
        String::from_utf8_lossy(&done.stderr).into_owned()
    };
    assert!(segment().contains("a.csv"));
    std::fs::write(folder.path().join("a.csv"), "time_s,power_W,position_mm\n0,1,2\n").unwrap();
    let message = segment();
    assert!(message.contains("a.csv") && message.contains("column 'force_N' is missing"), "{message}");
    assert!(!out.exists());
}
