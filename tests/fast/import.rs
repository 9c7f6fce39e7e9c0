//! `import` on small files as machines and loggers write them: exports of other programs, wide
//! tables, folders, workbooks.

use std::io::Write;
use std::path::Path;

use pinswitch_calibration::table::PlateauTable;
use pinswitch_import::{Map, Output, Source, import};
use serde_json::Value;

use crate::harness::{done, ended, repository, shared_file};

/// Bytes of a file in the folder of laboratories' files.
fn file(name: &str) -> Vec<u8> {
    std::fs::read(repository("tests/data/laboratories-files").join(name)).unwrap()
}

/// Imports a file with the binary; returns the table or log and its map.
fn imported(name: &str, options: &[&str]) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), file(name)).unwrap();
    let mut arguments = vec!["import", name, "--out", "out.csv"];
    arguments.extend(options);
    done(folder.path(), &arguments);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    (read("out.csv"), read("out.import.toml"))
}

fn lines(text: &str) -> Vec<&str> {
    text.lines().collect()
}

#[test]
fn machine_exports_become_logs() {
    let (log, map) = imported("bluehill-quoted.csv", &[]);
    let log = lines(&log);
    assert_eq!(log[..3], ["time_s,force_N,position_mm", "0,1.2,0", "0.05,9.7,0.0105"]);
    assert_eq!(log.len(), 32);
    assert!(map.contains("unit = \"kN\"\nfactor = 1000.0"), "{map}");

    let (log, _) = imported("hx711-millis.csv", &[]);
    assert_eq!(lines(&log)[..3], ["time_s,force_N", "1.204,0.0612", "1.216,0.1835"]);
    assert_eq!(lines(&log).len(), 61);

    let (log, _) = imported("quoted-log.csv", &[]);
    assert_eq!(lines(&log)[..2], ["time_s,force_N,position_mm,power_W", "0,8.0421,0.014,0.15"]);
}

/// The times of LVM follow from the step and from the date of each segment.
#[test]
fn lvm_segments_are_joined() {
    let (log, _) = imported("segments.lvm", &[]);
    let log = lines(&log);
    assert_eq!(log[..3], ["time_s,force_N,position_mm", "0,12.5,0", "0.0125,12.501,0.1"]);
    assert_eq!((log[7], log.len()), ("2.5,8.25,1", 13));
    let Some(original) = shared_file("data/cases/labs/lvm_decimal_comma.lvm") else { return };
    let bytes = std::fs::read(original).unwrap();
    let log = Map::default().read_log(&bytes, "lvm_decimal_comma.lvm").unwrap();
    assert_eq!((log.force_n[1], log.time_s[1], log.time_s.len()), (0.537_321, 3.906_25e-5, 10));
}

#[test]
fn wide_tables_become_readings() {
    let (table, map) = imported("wide-european.csv", &[]);
    let table = lines(&table);
    assert_eq!(
        table[..3],
        [
            "series,substrate,pins,load_mass_g,load_N,direction,force_N",
            "V1,plain,,1000,9.80665,concentric,12.85",
            "V1,plain,,1000,9.80665,eccentric,7.45"
        ]
    );
    assert_eq!(table.len(), 11);
    assert!(map.contains("direction = \"concentric\""), "{map}");
}

/// The same table with decimal commas, with a row of units, and with other words for the
/// directions.
#[test]
fn rewritten_tables_are_equal() {
    let (expected, _) = imported("units-row.csv", &[]);
    for name in ["semicolon-decimal-comma.csv", "pull-release.csv"] {
        assert_eq!(imported(name, &[]).0, expected, "{name}");
    }
    // And equal to the original without its row of units.
    let original: String = String::from_utf8(file("units-row.csv"))
        .unwrap()
        .lines()
        .enumerate()
        .filter(|(i, _)| *i != 1)
        .map(|(_, line)| format!("{line}\n"))
        .collect();
    let read = |text: &str| PlateauTable::read(text.as_bytes(), "t.csv").unwrap().rows;
    assert_eq!(read(&expected), read(&original));
}

/// A measured table in kilonewtons, milliseconds, with decimal commas, shuffled columns and French
/// words.
#[test]
fn a_measured_table_survives_rewriting() {
    let Some(path) = shared_file("data/real/davinci_tool4.csv") else { return };
    let bytes = std::fs::read(path).unwrap();
    let table = |bytes: &[u8]| match import(&[Source::new("t.csv", bytes)], &Map::default()).unwrap().output {
        Some(Output::Table(csv)) => csv,
        other => panic!("{other:?}"),
    };
    let expected = table(&bytes);
    let original = PlateauTable::read(bytes.as_slice(), "davinci_tool4.csv").unwrap();
    assert_eq!(PlateauTable::read(expected.as_bytes(), "t.csv").unwrap().rows, original.rows);
    let text = String::from_utf8(bytes).unwrap();
    let mut rewritten = String::from(
        "Effort [kN]\tsens\tsérie\tsubstrate\tpins\tCharge [mN]\tmasse [kg]\tsweep\tvitesse [%]\tpause [ms]\ttemps [ms]\tposition [m]\trepetition\n",
    );
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let scaled = |i: usize, power: i32| shifted(cells[i], power).replace('.', ",");
        let word = if cells[8] == "concentric" { "montée" } else { "descente" };
        let columns = [
            scaled(12, -3),
            word.to_owned(),
            cells[0].to_owned(),
            cells[1].to_owned(),
            cells[2].to_owned(),
            scaled(5, 3),
            scaled(4, -3),
            cells[3].to_owned(),
            scaled(6, 0),
            scaled(7, 3),
            scaled(11, 3),
            scaled(10, -3),
            cells[9].to_owned(),
        ];
        rewritten.push_str(&columns.join("\t"));
        rewritten.push('\n');
    }
    assert_eq!(table(rewritten.as_bytes()), expected);
}

/// Moves the point of a decimal number by `power` digits to the right.
fn shifted(number: &str, power: i32) -> String {
    let (sign, digits) = number.strip_prefix('-').map_or(("", number), |digits| ("-", digits));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let digits = format!("{:0>8}{whole}{fraction}{:0<8}", "", "");
    let at = usize::try_from(8 + i32::try_from(whole.len()).unwrap() + power).unwrap();
    format!("{sign}{}.{}", digits[..at].trim_start_matches('0'), &digits[at..]).replacen("-.", "-0.", 1)
}

/// Two readings are not guessed: exit code 2, both readings, and nothing is written.
#[test]
fn uncertain_files_are_not_guessed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (text, option, other, expected) in [
        (
            "load_N;direction;force_N\n1;up;1,234\n1;down;1,111\n",
            "decimal=comma",
            "decimal=point",
            "1 N,plain,,1,concentric,1.234",
        ),
        (
            "load,direction,force [N]\n1,up,12.5\n1,down,8\n",
            "unit.load=kg",
            "unit.load=N",
            "1 kg,plain,,1000,9.80665,concentric,12.5",
        ),
        (
            "load_N,direction,force_N\n9,A,8.5\n9,B,12\n",
            "concentric=B",
            "concentric=A",
            "9 N,plain,,9,eccentric,8.5",
        ),
        (
            "load_N,direction,force_N\n9,pull,8.5\n9,release,12\n",
            "concentric=release",
            "directions=as-named",
            "9 N,plain,,9,eccentric,8.5",
        ),
        (
            "load_N,F_up [N],F_down [N]\n9,8.5,12\n",
            "directions=swapped",
            "directions=as-named",
            "9 N,plain,,9,eccentric,8.5",
        ),
        (
            "load_N,direction,force_N\n9,up,-12\n9,down,-8\n",
            "force_sign=-1",
            "force_sign=1",
            "9 N,plain,,9,concentric,12",
        ),
        // One column of a spreadsheet with thousands separators, and another without.
        (
            "Load (g),Up (g),Down (g)\n\"1,000\",1284,745\n\"2,000\",2569,1490\n",
            "decimal=point",
            "decimal=comma",
            "1000 g,plain,,1000,9.80665,concentric,12.5917386",
        ),
    ] {
        std::fs::write(at.join("in.csv"), text).unwrap();
        let arguments = ["import", "in.csv", "--out", "out.csv"];
        let (code, output) = ended(at, &arguments);
        assert_eq!(code, Some(2), "{option}: {output}");
        assert!(output.contains(option) && output.contains(other), "{option}: {output}");
        assert_eq!(std::fs::read_dir(at).unwrap().count(), 1, "{option}");
        done(at, &[&arguments[..], &["--set", option]].concat());
        let table = std::fs::read_to_string(at.join("out.csv")).unwrap();
        assert_eq!(lines(&table)[1], expected, "{option}");
        // The map of that decision repeats it.
        done(at, &["import", "in.csv", "--out", "again.csv", "--map", "out.import.toml"]);
        assert_eq!(std::fs::read_to_string(at.join("again.csv")).unwrap(), table, "{option}");
        for name in ["out.csv", "out.import.toml", "again.csv", "again.import.toml", "provenance.json"] {
            std::fs::remove_file(at.join(name)).unwrap();
        }
    }
}

/// A map of kilonewtons is not applied to a row of units in newtons, and minutes are not hours.
#[test]
fn other_units_and_clocks_are_asked() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let write = |name: &str, text: &str| std::fs::write(at.join(name), text).unwrap();
    write("a.csv", "Load,Up,Down\nkg,kN,kN\n1,0.0125,0.0075\n2,0.025,0.015\n");
    write("b.csv", "Load,Up,Down\nkg,N,N\n1,12.5,7.5\n2,25,15\n");
    done(at, &["import", "a.csv", "--out", "a-table.csv"]);
    let with_map = ["import", "b.csv", "--out", "b-table.csv", "--map", "a-table.import.toml"];
    let (code, output) = ended(at, &with_map);
    assert!(code == Some(2) && output.contains("is in N here, and was in kN"), "{output}");
    done(at, &[&with_map[..], &["--set", "unit.Up=N", "--set", "unit.Down=N"]].concat());
    let table = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    assert_eq!(table("a-table.csv"), table("b-table.csv"));
    write("c.csv", "Time;Force [N]\n00:58;1.5\n00:59;1.6\n01:00;1.7\n");
    let (code, output) = ended(at, &["import", "c.csv", "--out", "c-log.csv"]);
    assert!(code == Some(2) && output.contains("clock=mm:ss"), "{output}");
    done(at, &["import", "c.csv", "--out", "c-log.csv", "--set", "clock=mm:ss"]);
    assert_eq!(lines(&table("c-log.csv"))[1..], ["0,1.5", "1,1.6", "2,1.7"]);
}

#[test]
fn loads_are_read_from_file_names() {
    let folder = tempfile::tempdir().unwrap();
    let day = folder.path().join("day");
    std::fs::create_dir(&day).unwrap();
    for (name, up, down) in [("500g_1", 6.0, 4.0), ("500g_2", 6.5, 4.5), ("1000g_1", 12.0, 8.0)] {
        std::fs::write(day.join(format!("{name}.csv")), format!("direction,force_N\nup,{up}\ndown,{down}\n"))
            .unwrap();
    }
    std::fs::write(day.join("notes.txt"), "nothing\n").unwrap();
    done(folder.path(), &["import", "day", "--out", "t.csv", "--pattern", "{load_g}g_{trial}.csv"]);
    let table = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    assert_eq!(
        lines(&table)[..4],
        [
            "series,substrate,pins,load_mass_g,load_N,direction,repetition,force_N",
            "500 g,plain,,500,4.903325,concentric,1,6",
            "500 g,plain,,500,4.903325,eccentric,1,4",
            "500 g,plain,,500,4.903325,concentric,2,6.5"
        ]
    );
}

/// Writes a workbook with one sheet (ECMA-376, part 1).
fn workbook(path: &Path, rows: &[&[&str]]) {
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
    let mut sheet = format!("<worksheet xmlns=\"{MAIN}\"><sheetData>");
    for (r, row) in rows.iter().enumerate() {
        sheet.push_str(&format!("<row r=\"{}\">", r + 1));
        for (cell, column) in row.iter().zip('A'..) {
            let at = format!("{column}{}", r + 1);
            sheet.push_str(&match cell.parse::<f64>() {
                Ok(_) => format!("<c r=\"{at}\"><v>{cell}</v></c>"),
                Err(_) => format!("<c r=\"{at}\" t=\"inlineStr\"><is><t>{cell}</t></is></c>"),
            });
        }
        sheet.push_str("</row>");
    }
    sheet.push_str("</sheetData></worksheet>");
    let parts = [
        (
            "[Content_Types].xml",
            format!(
                "<Types xmlns=\"{PACKAGE}/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"xml\" ContentType=\"application/xml\"/></Types>"
            ),
        ),
        (
            "_rels/.rels",
            format!(
                "<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"a\" Type=\"{OFFICE}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml",
            format!(
                "<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OFFICE}\"><sheets><sheet name=\"Data\" sheetId=\"1\" r:id=\"a\"/></sheets></workbook>"
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels",
            format!(
                "<Relationships xmlns=\"{PACKAGE}/relationships\"><Relationship Id=\"a\" Type=\"{OFFICE}/worksheet\" Target=\"worksheets/sheet1.xml\"/></Relationships>"
            ),
        ),
        ("xl/worksheets/sheet1.xml", sheet),
    ];
    let mut archive = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    for (name, text) in parts {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn workbooks_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let rows: [&[&str]; 4] = [
        &["Rig 3"],
        &["Last [kg]", "Richtung", "Kraft [N]"],
        &["2.5", "heben", "31.7"],
        &["2.5", "senken", "18.1"],
    ];
    workbook(&folder.path().join("a.xlsx"), &rows);
    done(folder.path(), &["import", "a.xlsx", "--out", "t.csv"]);
    let table = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    assert_eq!(lines(&table)[1], "2.5 kg,plain,,2500,24.516625,concentric,31.7");
    let (code, output) =
        ended(folder.path(), &["import", "a.xlsx", "--out", "u.csv", "--set", "sheet=Other"]);
    assert!(code == Some(2) && output.contains("the sheets are: Data"), "{output}");
}

#[test]
fn understanding_is_printed_as_json() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), file("wide-european.csv")).unwrap();
    let output = done(folder.path(), &["import", "a.csv", "--dry-run", "--json"]);
    let report: Value = serde_json::from_str(&output).unwrap();
    assert_eq!((&report["kind"], &report["rows"]), (&"table".into(), &10.into()));
    let file = &report["files"][0];
    assert_eq!((&file["decimal"], &file["delimiter"]), (&"comma".into(), &"semicolon".into()));
    assert_eq!(file["columns"][4]["ignored"], "a date without a time of day");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn inputs_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = file("wide-european.csv");
    std::fs::write(folder.path().join("a.csv"), &bytes).unwrap();
    let (code, output) = ended(folder.path(), &["import", "a.csv", "--out", "a.csv"]);
    assert!(code == Some(2) && output.contains("is an input of this command"), "{output}");
    assert_eq!(std::fs::read(folder.path().join("a.csv")).unwrap(), bytes);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_template_is_a_valid_map() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "init", "import", "--out", "map.toml"]);
    let text = std::fs::read_to_string(folder.path().join("map.toml")).unwrap();
    Map::parse(&text, "map.toml").unwrap();
    std::fs::write(folder.path().join("a.csv"), "Last;Richtung;Zelle\n2,5;heben;20000\n2,5;senken;15000\n")
        .unwrap();
    done(folder.path(), &["import", "a.csv", "--out", "t.csv", "--map", "map.toml"]);
    let table = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    assert_eq!(lines(&table)[1], "2.5 kg at 180 deg,plain,,2500,24.516625,concentric,21.8,180");
}

/// Unreadable files end with one error and exit code 2.
#[test]
fn unreadable_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let wide = format!("a,b\n{}\n", "1,".repeat(1_000_000));
    let open_quote = format!("time_s,force_N\n0,\"1\n{}", "1,2\n".repeat(30_000));
    for (bytes, problem) in [
        (b"".as_slice(), "the file is empty"),
        (b"time_s,force_N\n", "no line with numbers"),
        (b"0.1,0.2\n0.3,0.4\n", "the 2 columns have no names"),
        (b"t/s,F/N\n0,00,1,25\n0,05,1,30\n", "4 cells, but 2 columns have names"),
        (b"load_N,direction,force_N\n1,up,12x\n1,down,8\n", "not a number"),
        (b"a,b\n1,\0\n", "NUL"),
        (b"\x89HDF\r\n\x1a\n", "HDF5"),
        (b"PK\x03\x04 damaged", "workbook"),
        (b"PAR1 damaged PAR1", "Parquet"),
        (wide.as_bytes(), "cells in a row"),
        (open_quote.as_bytes(), "a cell has"),
    ] {
        std::fs::write(folder.path().join("in.csv"), bytes).unwrap();
        let (code, output) = ended(folder.path(), &["import", "in.csv", "--out", "out.csv"]);
        assert_eq!(code, Some(2), "{problem}: {output}");
        assert!(output.contains(problem) && output.contains("help: "), "{problem}: {output}");
        assert!(!folder.path().join("out.csv").exists());
    }
}
