//! Files that can be read in two ways, or whose header is not that of every row: each is a question or an error, never a
//! reading in silence.

use crate::{Import, Map, Output, Source, import};
use pinswitch_diagnostic::Diagnostic;

fn read(text: &str, options: &[&str]) -> Result<Import, Diagnostic> {
    let mut map = Map::default();
    options.iter().try_for_each(|option| map.set(option))?;
    import(&[Source::new("table.csv", text.as_bytes())], &map)
}

/// The problems of the questions, or of the error.
fn problems(text: &str, options: &[&str]) -> String {
    match read(text, options) {
        Err(diagnostic) => diagnostic.to_string(),
        Ok(import) => {
            import.understanding.questions.iter().map(|q| q.problem.clone()).collect::<Vec<_>>().join("\n")
        }
    }
}

/// The forces of the table, or of the log.
fn forces(text: &str, options: &[&str]) -> Vec<f64> {
    let import = read(text, options).unwrap();
    let csv = match &import.output {
        Some(output) => output.to_csv(),
        None => panic!("{:?}", import.understanding.questions),
    };
    let mut lines = csv.lines();
    let at = lines.next().unwrap().split(',').position(|name| name == "force_N").unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn another_header_is_not_skipped() {
    for (text, second) in [
        (
            "Load [kg],Up [N],Down [N]\n1,12.85,7.45\n2,25.69,14.91\n\nLoad [lb],Up [lbf],Down [lbf]\n5,6.5,3.8\n",
            "Load [lb]",
        ),
        (
            "Load [kg],Up [N],Down [N]\n1,12.85,7.45\nAngle [deg],Up [N],Down [N]\n45,11.3,8.5\n",
            "Angle [deg]",
        ),
        (
            "Load [kg],Up [N],Down [N]\n1,12.85,7.45\nLoad [kg],Down [N],Up [N]\n2,14.91,25.69\n",
            "Down [N], Up [N]",
        ),
        (
            "time_s,force_N,position_mm\n0,10.1,0.0\n0.01,10.2,0.1\ntime_s,position_mm,force_N\n0.04,0.4,10.2\n",
            "position_mm, force_N",
        ),
        (
            "Load,Direction,Force\nkg,,N\n1,up,12.85\n1,down,7.45\nLoad,Direction,Force\nkg,,kN\n2,up,0.02569\n",
            "Force [kN]",
        ),
        (
            "Load [N],Direction,Force (N)\n10,up,12.85\nLoad [N],Direction,Force (kN)\n10,up,0.01285\n",
            "Force (kN)",
        ),
    ] {
        let found = problems(text, &[]);
        assert!(found.contains("another header (") && found.contains(second), "{text}{found}");
    }
    let repeated =
        "Load [N],Direction,Force\n,,N\n10,up,12.85\nload [N],direction,force\n,,N\n10,down,7.45\n";
    assert_eq!(forces(repeated, &[]), [12.85, 7.45]);
}

#[test]
fn spreads_and_means_are_not_readings() {
    let columns = "Load [N],Up 1 [N],Up 2 [N],Up mean [N],Up SD [N],Down 1 [N],Down 2 [N],Down SD [N]\n\
                   10,12.8,12.9,12.85,0.03,7.4,7.5,0.03\n";
    assert_eq!(forces(columns, &[]), [12.8, 12.9, 7.4, 7.5]);
    assert_eq!(forces("Load [N],Mean up [N],Mean down [N]\n10,12.8,7.4\n", &[]), [12.8, 7.4]);
    let rows =
        "Versuch;Last [kg];Heben [N];Senken [N]\n1;1,0;12,85;7,45\nMW;1,0;12,85;7,45\nStabw;1,0;0,03;0,02\n";
    assert_eq!(forces(rows, &[]), [12.85, 7.45]);
}

#[test]
fn figures_computed_from_readings_are_not_readings() {
    for name in ["SD", "Std", "Std. Dev.", "StdDev", "SEM", "Range", "Min", "Max", "Error", "CV"] {
        for mean in [",Mean (N)", ""] {
            let value = if mean.is_empty() { "" } else { ",12.85" };
            let text = format!(
                "Load (N),Direction,F1 (N),F2 (N){mean},{name} (N)\n10,up,12.8,12.9{value},0.03\n10,down,7.4,7.5{value},0.03\n"
            );
            assert_eq!(forces(&text, &[]), [12.8, 12.9, 7.4, 7.5], "{text}");
        }
    }
    let hours = "Load [N],Direction,Force [N],STD\n10,up,12.8,0.03\n10,down,7.4,0.02\n";
    assert!(!read(hours, &[]).unwrap().output.unwrap().to_csv().contains("time_s"));
    let angles = "Load [N],Direction,90 deg (N),90 deg SD (N)\n10,up,12.8,0.03\n10,down,7.4,0.02\n";
    assert_eq!(forces(angles, &[]), [12.8, 7.4]);
    let counted = "Load (N),Direction,Reading 1,Reading 2,Average,St. Dev.,CV (%),n\n10,up,12.8,12.9,12.85,0.05,0.4,2\n";
    assert_eq!(problems(counted, &[]), "the columns of forces have no unit");
    assert_eq!(forces(counted, &["force_unit=N"]), [12.8, 12.9]);
    let decided = ["column.Reading 1=force", "column.Reading 2=force", "force_unit=N"];
    assert_eq!(forces(counted, &decided), [12.8, 12.9]);
}

/// What is the only force is a reading, whatever its name is.
#[test]
fn the_only_force_is_a_reading() {
    for text in [
        "time_s,N,Comment\n0,10.1,a\n0.01,10.2,b\n",
        "time_s,Max (N),Comment\n0,10.1,a\n0.01,10.2,b\n",
        "Load [N],Direction,Mean (N),SD (N)\n10,up,10.1,0.1\n10,down,10.2,0.1\n",
        "Load [N],Direction,N,Remark\n10,up,10.1,a\n10,down,10.2,b\n",
    ] {
        assert_eq!(forces(text, &["directions=as-named"]), [10.1, 10.2], "{text}");
    }
}

#[test]
fn a_unit_and_a_factor_are_a_question() {
    let text = "Load [N],Direction,adc\n10,up,12.8\n10,down,7.4\n";
    for options in [["unit.adc=kg", "factor.adc=2"], ["factor.adc=2", "unit.adc=kg"]] {
        assert_eq!(problems(text, &options), "column 'adc' has the unit kg and the factor 2");
    }
    assert_eq!(forces(text, &["factor.adc=2", "unit.adc=N"]), [25.6, 14.8]);
    assert_eq!(forces(text, &["factor.adc=19.6133", "unit.adc=N"])[0], 251.05024);
    assert_eq!(forces(text, &["unit.adc=counts", "factor.adc=2"]), [25.6, 14.8]);
}

#[test]
fn empty_cells_of_loads_and_angles_are_a_question() {
    let merged = "Load [N],Direction,Force [N]\n10,up,12.8\n,down,7.4\n20,up,25.6\n,down,14.8\n";
    assert_eq!(problems(merged, &[]), "2 readings have no load, the first in line 3");
    assert_eq!(forces(merged, &["fill.Load [N]=down"]), [12.8, 7.4, 25.6, 14.8]);
    assert_eq!(forces(merged, &["bad_rows=skip"]), [12.8, 25.6]);
    let angles = "Angle [deg],Load [N],Direction,Force [N]\n90,10,up,12.8\n,10,down,7.4\n";
    assert_eq!(problems(angles, &[]), "the reading in line 3 has no wrap angle");
    assert_eq!(forces(angles, &["wrap_angle_deg=90"]), [12.8, 7.4]);
    // The wrap angle of a switch is that of its rig.
    let mixed = "Substrate,Pins,Angle [deg],Load [N],Direction,Force [N]\nplain,,90,10,up,12.8\nsilicone,5;8;11,,10,up,14\n";
    assert_eq!(forces(mixed, &[]), [12.8, 14.0]);
    let directions = "Direction,Load [N],Force [N]\nup,10,12.8\n,20,25.6\ndown,10,7.4\n,20,14.8\n";
    assert_eq!(problems(directions, &[]), "some readings have no direction");
    assert_eq!(forces(directions, &["fill.Direction=down"]), [12.8, 25.6, 7.4, 14.8]);
    let last = "Direction,Force [N],Load [N]\nup,12.8,10\ndown,7.4\n";
    assert_eq!(forces(last, &["fill.Load [N]=down"]), [12.8, 7.4]);
    // A map repeats the decision.
    let mut map = Map::default();
    map.set("fill.Load [N]=down").unwrap();
    let import = import(&[Source::new("a.csv", merged.as_bytes())], &map).unwrap();
    let again = Map::parse(&import.map.to_toml(), "map.toml").unwrap();
    assert_eq!(
        super::import(&[Source::new("a.csv", merged.as_bytes())], &again).unwrap().output,
        import.output
    );
}

#[test]
fn texts_in_the_column_of_forces_are_named() {
    let found =
        problems("Load [N],Direction,Force (N)\n10,up,8.65 \u{b1} 0.05\n10,down,7.4 \u{b1} 0.05\n", &[]);
    assert!(found.contains("'Force (N)' are not numbers, such as '8.65 \u{b1} 0.05'"), "{found}");
}

#[test]
fn a_column_that_counts_the_rows_names_no_specimens() {
    let text = "Sample,Load [N],Direction,Force [N]\n1,10,up,12.8\n2,10,down,7.4\n";
    assert!(!read(text, &[]).unwrap().output.unwrap().to_csv().contains("specimen"));
}

#[test]
fn a_point_before_three_digits_next_to_commas_is_a_question() {
    let text = "Last [kg];Richtung;Kraft [N]\n2,5;heben;31.712\n2,5;senken;18.123\n5,0;heben;63.425\n";
    assert_eq!(problems(text, &[]), "'31.712' in line 2 has a decimal point or a thousands separator");
    assert_eq!(forces(text, &["decimal=comma"])[0], 31712.0);
    // A smaller number in the column shows what the point is.
    let grouped = "Last [g];Richtung;Kraft [N]\n500;heben;6,5\n2.500;heben;31,7\n";
    assert_eq!(forces(grouped, &[]), [6.5, 31.7]);
}

#[test]
fn an_empty_cell_between_blanks_is_refused() {
    let text = "time_s   force_N   position_mm\n0.00     10.1      3.0\n0.01               3.1\n0.02     10.2      3.2\n";
    assert!(problems(text, &[]).contains("fewer cells than names"), "{}", problems(text, &[]));
}

#[test]
fn speeds_of_at_most_one_percent_are_a_question() {
    let text = "Load [N],Direction,Speed [%],Force [N]\n10,up,0.5,12.8\n10,down,1,7.4\n";
    assert_eq!(problems(text, &[]), "column 'Speed [%]' in % has no value above 2");
    let speeds = |options: &[&str]| {
        let csv = read(text, options).unwrap().output.unwrap().to_csv();
        let at = csv.lines().next().unwrap().split(',').position(|name| name == "speed_pct").unwrap();
        csv.lines().skip(1).map(|line| line.split(',').nth(at).unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(speeds(&["factor.Speed [%]=100"]), ["50", "100"]);
    assert_eq!(speeds(&["unit.Speed [%]=%"]), ["0.5", "1"]);
    assert_eq!(problems(&text.replace("0.5", "50"), &[]), "");
}

#[test]
fn factors_and_numbers_in_names_are_questions() {
    for (text, options, problem) in [
        (
            "Angle [x pi rad],Load [N],Direction,Force [N]\n0.5,10,up,12\n",
            &[][..],
            "column 'Angle [x pi rad]' has no unit",
        ),
        ("Load [N],Direction,Force [x10 N]\n10,up,1.25\n", &[], "column 'Force [x10 N]' has no unit"),
        ("Load [N],Up 45 [N],Up 90 [N]\n10,11,12\n", &[], "the numbers 45, 90 in the names of columns"),
        (
            "Trial,\"1,000 g up [N]\",\"2,000 g up [N]\"\n1,12.85,25.69\n",
            &[],
            "the load in the name '1,000 g up [N]'",
        ),
        (
            "Load [N],Direction,Force [N]\n5,up,12.5\n",
            &["load_N=10"],
            "the column 'Load [N]' has other values",
        ),
        ("Zeit,Kraft [N]\n45356.4000000,1.5\n45356.4000012,1.6\n", &[], "column 'Zeit' has no unit"),
    ] {
        let found = problems(text, options);
        assert!(found.contains(problem), "{text}{found}");
    }
    let angles = "Load [N],Up 45 [N],Up 90 [N]\n10,11,12\n";
    let import = read(angles, &["wrap_angle_deg.Up 45 [N]=45", "wrap_angle_deg.Up 90 [N]=90"]).unwrap();
    let Some(Output::Table(csv)) = import.output else { panic!("{:?}", import.understanding.questions) };
    assert!(csv.contains("wrap_angle_deg"), "{csv}");
    let thousands = "Trial,\"1,000 g up [N]\",\"2,000 g up [N]\"\n1,12.85,25.69\n";
    let options = ["load.1,000 g up [N]=1000 g", "load.2,000 g up [N]=2000 g"];
    assert_eq!(forces(thousands, &options), [12.85, 25.69]);
}

/// What a first, stricter version of these rules refused or left out.
#[test]
fn ordinary_files_are_read() {
    for (text, options, count) in [
        (
            "operator,load_N,direction,force_N\nJD,10,up,12\nJD,10,down,8\nMW,10,up,12.1\nSE,10,down,8.1\n",
            &[][..],
            4,
        ),
        ("Run,Direction,Load [N],Force [N]\n1,up,10,12\nrun A,down,,\n2,down,10,8\n", &[], 2),
        ("time [s],force [N]\n0,1\n0.01,2\nTime (s),Force (N)\n0.02,3\n", &[], 3),
        ("Load [N],Direction,Force [N]\n10.0,up,12.5\n10.0,down,8\n", &["load_N=10"], 2),
        (
            "Load [kg],Direction,Force [N]\n1,up,12.5\n1,up,8\n",
            &["load_N=9.80665", "direction=concentric"],
            2,
        ),
        ("time_s  force_N  event\n0.00  10.1  start\n0.01  10.2\n0.02  10.3\n", &[], 3),
        ("time_s  force_N  position_mm\n0.00  10.1  1\n0.01  10.2  2\nMean  10.15\n", &[], 2),
        ("time_s,Load cell (sd card) [N]\n0,1\n0.01,2\n", &[], 2),
        ("Time,Force [N]\n0.01,1\n0.01005,2\n0.02,3\n0.03,4\n", &[], 4),
        ("Load [N],Up 0 [N],Up 1 [N],Down 0 [N],Down 1 [N]\n10,12,12.1,8,8.1\n", &[], 4),
    ] {
        assert_eq!(forces(text, options).len(), count, "{text}");
    }
    assert_eq!(
        problems("Load [N],Up 0 [N],Up 45 [N],Up 90 [N]\n10,10,11,12\n", &[]),
        "the numbers 0, 45, 90 in the names of columns"
    );
    assert!(problems("Load [N],Up 0 [N],Up 90 [N]\n10,10,12\n", &[]).contains("the numbers 0, 90"));
    assert!(
        problems("time_s,Force NW [N],Force SE [N]\n0,1,2\n0.01,2,3\n", &[])
            .contains("2 columns may be the force")
    );
    assert!(
        problems(
            "Neigungswinkel [\u{b0}],Load [N],Direction,Force [N]\n5,10,up,12\n",
            &["wrap_angle_deg=180"]
        )
        .is_empty()
    );
    let groups = "trial,1.500 kg,,2.500 kg,\n,up,down,up,down\n1,12,8,24,16\n";
    assert!(problems(groups, &[]).contains("the load in the name"), "{}", problems(groups, &[]));
    let earlier =
        "Load [kg],Up [N]\n1,12.85\n2,25.69\nLoad [kg],Up [N],Down [N]\n3,37,21\n4,50,29\n5,60,35\n";
    assert!(problems(earlier, &[]).contains("another header ("), "{}", problems(earlier, &[]));
}

/// Trials without a unit are forces of one: it is the only question.
#[test]
fn trials_are_columns_of_forces() {
    let rows = "5,pull,6.1,6.2,6.0\n5,release,4.1,4.2,4.0\n10,pull,12.1,12.2,12.0\n";
    for names in ["Trial 1,Trial 2,Trial 3", "1,2,3"] {
        let text = format!("load_N,direction,{names}\n{rows}");
        assert!(
            problems(&text, &[]).contains("the columns of forces have no unit"),
            "{}",
            problems(&text, &[])
        );
        assert_eq!(
            forces(&text, &["force_unit=N"]),
            [6.1, 6.2, 6.0, 4.1, 4.2, 4.0, 12.1, 12.2, 12.0],
            "{names}"
        );
    }
    // Numbers that do not count from one are data.
    assert!(problems(&format!("load_N,direction,2,3,5\n{rows}"), &[]).contains("have no names"));
}

#[test]
fn the_oldest_capstan_experiment_needs_two_options() {
    let text = "Wrap angle (deg),Force (N)\n30,11.1\n60,12.3\n90,13.7\n";
    assert_eq!(forces(text, &["load_N=10", "direction=concentric"]), [11.1, 12.3, 13.7]);
    // The angle of something else is not the wrap.
    assert!(
        !problems("Tilt angle [deg],Load [N],Direction,Force [N]\n5,10,up,12\n", &["wrap_angle_deg=180"])
            .contains("other values")
    );
}
