//! Plateau tables that no rig can have measured are refused; plausible ones are accepted.

use std::path::PathBuf;

use pinswitch_calibration::table::{PlateauRow, PlateauTable, TableError, substrate_word};
use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::Direction;
use pinswitch_simulation::{EffectPlan, Plan, simulate};
use proptest::prelude::*;

use crate::harness::{ended, shared_file};

/// Most characters of an error.
const LONGEST: usize = 600;

fn written(rows: &[PlateauRow]) -> String {
    PlateauTable::write(rows)
}

/// Checks the text of a table; returns the first error of reading it or of its plausibility.
fn check(text: &str) -> Result<(), TableError> {
    PlateauTable::read(text.as_bytes(), "t.csv")?.require_baseline("t.csv")
}

fn opposite(direction: Direction) -> Direction {
    match direction {
        Direction::Eccentric => Direction::Concentric,
        Direction::Concentric => Direction::Eccentric,
    }
}

/// Returns all tables of rigs and machines in the folders next to this repository.
fn measured() -> Vec<PathBuf> {
    let mut tables: Vec<PathBuf> = ["data/rig", "data/rig2", "data/real"]
        .iter()
        .filter_map(|folder| shared_file(folder))
        .flat_map(|folder| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()))
        .filter(|path| path.extension().is_some_and(|e| e == "csv"))
        .collect();
    tables.sort();
    tables
}

/// Returns the text of a table with two column names swapped.
fn exchanged(text: &str, first: &str, second: &str) -> String {
    let (header, rest) = text.split_once('\n').unwrap();
    let name = |column: &str| match column {
        c if c == first => second.to_owned(),
        c if c == second => first.to_owned(),
        c => c.to_owned(),
    };
    format!("{}\n{rest}", header.split(',').map(name).collect::<Vec<_>>().join(","))
}

const PAIRS: [[&str; 2]; 10] = [
    ["load_N", "force_N"],
    ["position_mm", "force_N"],
    ["time_s", "force_N"],
    ["speed_pct", "force_N"],
    ["load_mass_g", "force_N"],
    ["load_mass_g", "load_N"],
    ["load_N", "position_mm"],
    ["load_N", "time_s"],
    ["speed_pct", "load_N"],
    ["position_mm", "time_s"],
];

/// Asserts that a table is refused as a whole, with file, column and help.
fn assert_refused(text: &str, what: &str) {
    let error = Diagnostic::from(check(text).expect_err(what));
    let location = error.location().expect(what);
    assert!(
        location.file.as_deref() == Some("t.csv")
            && (location.field.is_some() || error.problem().contains("column")),
        "{what}: {error}"
    );
    assert!(error.help().is_some(), "{what}: {error}");
    assert!(error.to_string().chars().count() < LONGEST, "{what}: {error}");
}

#[test]
fn measured_tables_and_directions_are_accepted() {
    for path in measured() {
        let table = PlateauTable::read(std::fs::File::open(&path).unwrap(), "t.csv").unwrap();
        table.require_baseline("t.csv").unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        for direction in [Direction::Eccentric, Direction::Concentric] {
            let mut one = table.clone();
            one.retain(|row| row.direction == direction);
            one.require_baseline("t.csv").unwrap_or_else(|e| panic!("{} {direction:?}: {e}", path.display()));
        }
    }
}

#[test]
fn implausible_changes_are_refused() {
    for path in measured() {
        let table = PlateauTable::read(std::fs::File::open(&path).unwrap(), "t.csv").unwrap();
        let name = path.display().to_string();
        let of = |change: &dyn Fn(&mut PlateauRow)| {
            let mut changed = table.clone();
            changed.rows.iter_mut().for_each(change);
            changed.require_baseline("t.csv")
        };
        let labels = of(&|r| r.direction = opposite(r.direction));
        assert!(matches!(labels, Err(TableError::SwappedDirections { .. })), "{name}: {labels:?}");
        let copied = of(&|r| r.force_n = r.load_n);
        assert!(matches!(copied, Err(TableError::NoFriction { .. })), "{name}: {copied:?}");
        let sign = of(&|r| r.force_n = -r.force_n);
        assert!(matches!(sign, Err(TableError::Unrelated { .. })), "{name}: {sign:?}");
    }
}

#[test]
fn swapped_columns_are_refused() {
    for path in measured().into_iter().filter(|p| !p.to_string_lossy().contains("real")) {
        let text = std::fs::read_to_string(&path).unwrap();
        for masses in [true, false] {
            let text = if masses { text.clone() } else { without_masses(&text) };
            for [first, second] in PAIRS {
                if !masses && (first == "load_mass_g" || [first, second] == ["speed_pct", "load_N"]) {
                    continue;
                }
                let what = format!("{}: {first} and {second}, masses {masses}", path.display());
                assert_refused(&exchanged(&text, first, second), &what);
            }
        }
    }
}

/// Returns the table with unknown masses.
fn without_masses(text: &str) -> String {
    let mut table = PlateauTable::read(text.as_bytes(), "t.csv").unwrap();
    table.rows.iter_mut().for_each(|r| r.load_mass_g = 0.0);
    written(&table.rows)
}

#[test]
fn swapped_columns_are_named() {
    let text = written(&simulate(&Plan::randomised()).rows);
    for [first, second] in PAIRS {
        match check(&exchanged(&text, first, second)) {
            Err(TableError::SwappedColumns { first: a, second: b, .. }) => {
                assert!([[a, b], [b, a]].contains(&[first, second]), "{first} and {second}: {a} and {b}");
            }
            other => panic!("{first} and {second}: {other:?}"),
        }
    }
}

#[test]
fn a_refused_table_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = simulate(&Plan::randomised()).rows;
    rows.iter_mut().for_each(|r| r.direction = opposite(r.direction));
    std::fs::write(folder.path().join("turned.csv"), written(&rows)).unwrap();
    let (code, output) = ended(folder.path(), &["-q", "calibrate", "turned.csv", "--out", "out"]);
    assert_eq!(code, Some(2), "{output}");
    let words =
        "turned.csv: direction: the concentric readings are below the eccentric ones in 7 of 7 condition(s)";
    assert!(output.contains(words), "{output}");
    assert!(output.chars().count() < LONGEST && !folder.path().join("out").exists(), "{output}");
}

/// Errors of a single condition, or of up to three series, are left to the fit. Swapped
/// directions are the exception: pulled readings are never below released ones, and more than three
/// such series would invalidate the results of the others.
#[test]
fn single_errors_reach_the_fit() {
    let rows = simulate(&Plan::randomised()).rows;
    type Wrong = fn(&mut PlateauRow);
    let wrongs: [Wrong; 4] = [
        |r| r.direction = opposite(r.direction),
        |r| r.force_n = r.load_n,
        |r| r.force_n = 20.0,
        |r| r.force_n = -r.force_n,
    ];
    for (i, wrong) in wrongs.iter().enumerate() {
        let mut condition = rows.clone();
        condition.iter_mut().filter(|r| r.pins.is_empty()).for_each(wrong);
        let result = check(&written(&condition));
        let is_exchanged = matches!(result, Err(TableError::ExchangedSeries { count: 22, .. }));
        assert!(
            if [0, 3].contains(&i) { is_exchanged } else { result.is_ok() },
            "condition, {i}: {result:?}"
        );
        let mut series = rows.clone();
        series.iter_mut().filter(|r| ["3", "17", "40"].contains(&r.series.as_str())).for_each(wrong);
        check(&written(&series)).unwrap_or_else(|e| panic!("series, {i}: {e}"));
    }
}

/// A case of [`no_simulated_rig_is_refused`]: the loads of each layout hardly vary, while friction
/// differs tenfold between layouts.
#[test]
fn different_layouts_are_judged_separately() {
    let mut plan = Plan::default();
    plan.noise.series_n = 0.0;
    let weights_g = vec![4293.4, 5074.1, 5419.3, 5448.2, 6639.8];
    let plan = Plan {
        wrap_angle_deg: 663.0,
        weights_g,
        silicone: false,
        repetitions: [1, 1],
        repetitions_spread: 0,
        ..plan
    };
    check(&written(&simulate(&plan).rows)).unwrap();
}

fn plans() -> impl Strategy<Value = Plan> {
    let weights = prop::collection::vec(200.0..8000.0f64, 2..9);
    (any::<u64>(), any::<bool>(), 15.0..720.0f64, weights, any::<[bool; 2]>(), 0.0..0.15f64, 1..6u32)
        .prop_map(
            |(seed, randomised, wrap_angle_deg, mut weights_g, [silicone, proxy], noise_n, repetitions)| {
                weights_g.sort_by(f64::total_cmp);
                let mut plan = if randomised { Plan::randomised() } else { Plan::default() };
                plan.noise.series_n = noise_n;
                Plan {
                    seed,
                    wrap_angle_deg,
                    weights_g,
                    silicone,
                    proxy,
                    repetitions: [repetitions, repetitions],
                    repetitions_spread: 0,
                    ..plan
                }
            },
        )
}

/// A coarse load cell reads the same few values in two series.
#[test]
fn coarse_readings_are_not_copies() {
    for seed in 1..=6 {
        let mut rows = simulate(&Plan { seed, ..Plan::randomised() }).rows;
        rows.iter_mut().for_each(|r| r.force_n = (2.0 * r.force_n).round() / 2.0);
        check(&written(&rows)).unwrap_or_else(|e| panic!("{seed}: {e}"));
    }
}

/// Each of these tables was once accepted, and most of them gave an effect that is absent.
#[test]
fn wrong_units_and_series_are_refused() {
    let rows = simulate(&Plan { seed: 5, ..Plan::randomised() }).rows;
    let refused = |what: &str, change: &dyn Fn(&mut Vec<PlateauRow>)| {
        let mut rows = rows.clone();
        rows.iter_mut().for_each(|r| r.load_mass_g = 0.0);
        change(&mut rows);
        assert_refused(&written(&rows), what);
    };
    let both = |factor: f64| {
        move |rows: &mut Vec<PlateauRow>| {
            for row in rows {
                (row.load_n, row.force_n) = (factor * row.load_n, factor * row.force_n);
            }
        }
    };
    refused("grams", &both(101.97));
    refused("kilonewtons", &both(1e-3));
    refused("pounds", &|rows| rows.iter_mut().for_each(|r| r.force_n *= 0.2248));
    refused("a pulley", &|rows| rows.iter_mut().for_each(|r| r.force_n *= 2.0));
    refused("one series", &|rows| rows.iter_mut().for_each(|r| r.series = "1".to_owned()));
    refused("a series for each layout", &|rows| {
        rows.iter_mut().for_each(|r| r.series = format!("{:?}{:?}", r.substrate, r.pins))
    });
    refused("a wrap for each row", &|rows| {
        rows.iter_mut().enumerate().for_each(|(i, r)| r.wrap_angle_deg += 0.001 * i as f64);
    });
    for direction in [Direction::Eccentric, Direction::Concentric] {
        refused("one direction under the other's name", &|rows| {
            rows.retain(|r| r.direction == direction);
            rows.iter_mut().for_each(|r| r.direction = opposite(r.direction));
        });
    }
    refused("four exchanged series", &|rows| {
        let heavy =
            |r: &&mut PlateauRow| ["30", "31", "32", "33", "34", "35", "36"].contains(&r.series.as_str());
        rows.iter_mut().filter(heavy).for_each(|r| r.direction = opposite(r.direction));
    });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any wrap, weights, conditions and noise; with or without masses; both directions or one;
    /// also as `plain`.
    #[test]
    fn no_simulated_rig_is_refused(plan in plans(), masses: bool, plain: bool, only: Option<bool>, offset_n in -2.0..2.0f64) {
        let mut plan = plan;
        plan.effects.push(EffectPlan { id: "load_cell_offset".to_owned(), values: vec![offset_n], form: 0 });
        let mut rows = simulate(&plan).rows;
        rows.retain(|r| only.is_none_or(|up| up == (r.direction == Direction::Concentric)));
        // Tables with nearly one load are refused for that reason.
        let ends = rows.iter().fold((f64::INFINITY, 0.0f64), |(a, b), r| (a.min(r.load_n), b.max(r.load_n)));
        prop_assume!(!rows.is_empty() && ends.1 - ends.0 > 3.0);
        for row in &mut rows {
            row.load_mass_g *= f64::from(u8::from(masses));
            if plain {
                row.series = format!("{} {:?} {}", substrate_word(row.substrate), row.pins, row.series);
            }
        }
        if plain {
            let first = (rows[0].substrate, rows[0].pins.clone());
            rows.retain(|r| (r.substrate, &r.pins) == (first.0, &first.1));
            rows.iter_mut().for_each(|r| (r.substrate, r.pins) = (None, Vec::new()));
        }
        if let Err(error) = check(&written(&rows)) {
            prop_assert!(false, "{error}");
        }
    }

    /// Swapped directions on any rig, unless it has so little friction that noise may hide it.
    #[test]
    fn swapped_labels_are_always_refused(plan in plans()) {
        let mut rows = simulate(&plan).rows;
        rows.iter_mut().for_each(|r| r.direction = opposite(r.direction));
        prop_assume!(rows.len() > 30 && plan.weights_g.len() > 3 && plan.wrap_angle_deg > 40.0);
        prop_assert!(check(&written(&rows)).is_err());
    }
}
