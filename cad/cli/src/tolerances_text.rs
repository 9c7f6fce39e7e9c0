//! The scatter of a threshold as text: the tables for the terminal and tolerances.csv.

use std::fmt::Write;

use pinswitch_switch::tolerances::{Contribution, NORMAL_95, Simulated};

use super::tolerances::{Allotted, Report};

/// Decimal places of a tolerance and of a nominal value.
const PLACES: i32 = 4;

/// Formats a number with at most four decimal places, without trailing zeros.
fn number(value: f64) -> String {
    let scale = 10f64.powi(PLACES);
    ((value * scale).round() / scale).to_string()
}

/// Returns the root of the sum of the squared slopes of all occurrences, with the sign of a single one.
fn slope(contribution: &Contribution) -> f64 {
    match contribution.slopes[..] {
        [only] => only,
        _ => contribution.slopes.iter().map(|slope| slope * slope).sum::<f64>().sqrt(),
    }
}

/// Returns the contributions in descending order of their shares, with their indices.
fn by_share(report: &Report) -> Vec<(usize, &Contribution)> {
    let mut all: Vec<_> = report.dimensions.iter().enumerate().collect();
    all.sort_by(|a, b| b.1.share.total_cmp(&a.1.share));
    all
}

fn simulated_line(simulated: &Simulated) -> String {
    let missing = match simulated.without_threshold {
        0 => String::new(),
        n => format!("; {n} without a threshold"),
    };
    format!(
        "mean {:.2} \u{b1} {:.2} N, standard deviation {:.2} \u{b1} {:.2} N, 95 % from {:.1} to {:.1} N ({} switches, seed {}{missing})",
        simulated.mean_n,
        simulated.mean_error_n,
        simulated.standard_deviation_n,
        simulated.standard_deviation_error_n,
        simulated.interval_n[0],
        simulated.interval_n[1],
        simulated.draws,
        simulated.seed,
    )
}

/// Formats the table of contributions, both scatters, the play of the pins, and the allotted tolerances.
pub(super) fn table(report: &Report) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail, here and below.
    let _ = writeln!(
        text,
        "{}: switches at {:.1} N; 95 % of the switches from {:.1} to {:.1} N, to first order\n",
        report.name, report.threshold_n, report.linear.interval_n[0], report.linear.interval_n[1]
    );
    let _ = writeln!(
        text,
        "{:<24} {:>9} {:>10} {:<8} {:>10} {:>7}  source of the tolerance",
        "dimension", "nominal", "tolerance", "unit", "N per unit", "share"
    );
    for (_, c) in by_share(report) {
        let count = if c.link.count > 1 { format!(" ({}x)", c.link.count) } else { String::new() };
        let _ = writeln!(
            text,
            "{:<24} {:>9} {:>10} {:<8} {:>10.2} {:>5.1} %  {}",
            format!("{}{count}", c.link.dimension.title()),
            number(c.link.nominal),
            format!("\u{b1}{}", number(c.link.process.plus_minus)),
            c.link.dimension.unit(),
            slope(c),
            100.0 * c.share,
            c.link.process.source
        );
    }
    let _ = writeln!(
        text,
        "\nfirst order: standard deviation {:.2} N, 95 % within \u{b1}{:.2} N",
        report.linear.standard_deviation_n,
        NORMAL_95 * report.linear.standard_deviation_n
    );
    let _ = writeln!(text, "simulated:   {}", simulated_line(&report.simulated));
    let play = &report.play;
    let verdict = if play.groove_to_slot_mm > play.half_mm {
        "some slots press their pin sideways"
    } else {
        "pins are free"
    };
    let _ = writeln!(
        text,
        "play:        half of the play of a pin is {} mm; 95 % of the grooves are within {} mm of their slot: {verdict}; \
         the drawing allows {} mm",
        number(play.half_mm),
        number(play.groove_to_slot_mm),
        number(play.drawing_mm)
    );
    if let Some(allotted) = &report.allocation {
        allotted_table(&mut text, report, allotted);
    }
    text
}

fn allotted_table(text: &mut String, report: &Report, allotted: &Allotted) {
    let allocation = &allotted.allocation;
    let Some(tolerances) = &allocation.tolerances else {
        let _ = writeln!(
            text,
            "\nwanted \u{b1}{:.2} N: impossible, the best processes reach \u{b1}{:.2} N:",
            allocation.wanted_n, allocation.best_n
        );
        for (_, c) in by_share(report) {
            let _ = writeln!(
                text,
                "  {:<24} \u{b1}{:<8} {:<8} {}",
                c.link.dimension.title(),
                number(c.link.best.plus_minus),
                c.link.dimension.unit(),
                c.link.best.source
            );
        }
        return;
    };
    let _ = writeln!(
        text,
        "\nwanted \u{b1}{:.2} N: reached \u{b1}{:.2} N to first order, at the least cost, with",
        allocation.wanted_n, allocation.reached_n
    );
    for (i, c) in by_share(report) {
        let tolerance = tolerances[i];
        let how = if tolerance >= c.link.process.plus_minus {
            "as the process gives"
        } else if tolerance <= c.link.best.plus_minus {
            c.link.best.source
        } else {
            "tighter than the process gives"
        };
        let _ = writeln!(
            text,
            "  {:<24} \u{b1}{:<8} {:<8} {how}",
            c.link.dimension.title(),
            number(tolerance),
            c.link.dimension.unit()
        );
    }
    if let Some(simulated) = &allotted.simulated {
        let _ = writeln!(text, "simulated:   {}", simulated_line(simulated));
    }
}

/// Formats tolerances.csv: one row per dimension.
pub(super) fn csv(report: &Report) -> String {
    let mut text =
        "dimension,unit,nominal,count,tolerance,drawing_tolerance,best_tolerance,slope_n_per_unit,share,allotted_tolerance,\
                    source,best_source\n"
            .to_owned();
    let allotted = report.allocation.as_ref().and_then(|a| a.allocation.tolerances.as_ref());
    for (i, c) in report.dimensions.iter().enumerate() {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{:.6},{:.6},{},\"{}\",\"{}\"",
            c.link.dimension.as_str(),
            c.link.dimension.unit(),
            number(c.link.nominal),
            c.link.count,
            number(c.link.process.plus_minus),
            number(c.link.drawing),
            number(c.link.best.plus_minus),
            slope(c),
            c.share,
            allotted.map(|all| number(all[i])).unwrap_or_default(),
            c.link.process.source,
            c.link.best.source
        );
    }
    text
}
