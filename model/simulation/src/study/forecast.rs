//! Reliability of forecast probabilities: of the forecasts of 80 %, four in five should come true.

use schemars::JsonSchema;
use serde::Serialize;

/// Probability that something is so, with whether it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Forecast {
    /// Forecast probability.
    pub probability: f64,
    /// Whether it came true.
    pub is_true: bool,
}

/// Number of ranges of the probability in a table.
const BINS: usize = 10;

/// Returns a reliability table in Markdown: number, mean probability and share that came true, by
/// forecast probability. `kinds` names the forecasts of each group of columns.
pub(super) fn reliability_table(what: &str, kinds: [&str; 2], forecasts: [&[Forecast]; 2]) -> String {
    let columns = kinds.map(|kind| format!("{kind} | mean probability | came true"));
    let mut text = format!("| {what} | {} |\n|---|---|---|---|---|---|---|\n", columns.join(" | "));
    let bin = |f: &Forecast| ((f.probability * BINS as f64) as usize).min(BINS - 1);
    for at in 0..BINS {
        let row = forecasts.map(|all| cells(all.iter().filter(|f| bin(f) == at)));
        let percent = 100 / BINS;
        text.push_str(&format!("| {} to {} % | {} |\n", at * percent, (at + 1) * percent, row.join(" | ")));
    }
    text.push_str(&format!("| all | {} |\n", forecasts.map(|all| cells(all.iter())).join(" | ")));
    text
}

/// Returns the cells of some forecasts: number, mean probability, and those that came true.
fn cells<'a>(forecasts: impl Iterator<Item = &'a Forecast>) -> String {
    let (mut count, mut sum, mut came_true) = (0, 0.0, 0);
    for forecast in forecasts {
        count += 1;
        sum += forecast.probability;
        came_true += usize::from(forecast.is_true);
    }
    if count == 0 {
        return "0 |  | ".to_owned();
    }
    let share = 100.0 / f64::from(count);
    format!("{count} | {:.1} % | {came_true} ({:.1} %)", share * sum, share * came_true as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_forecast_is_counted_once() {
        let of = |probability, is_true| Forecast { probability, is_true };
        let all = [of(0.0, false), of(0.85, true), of(0.8, false), of(1.0, true)];
        let table = reliability_table("probability", ["a", "b"], [&all, &[of(0.5, true)]]);
        let rows: Vec<&str> = table.lines().skip(2).collect();
        assert_eq!(rows[0], "| 0 to 10 % | 1 | 0.0 % | 0 (0.0 %) | 0 |  |  |");
        assert_eq!(rows[5], "| 50 to 60 % | 0 |  |  | 1 | 50.0 % | 1 (100.0 %) |");
        assert_eq!(rows[8], "| 80 to 90 % | 2 | 82.5 % | 1 (50.0 %) | 0 |  |  |");
        assert_eq!(rows[9], "| 90 to 100 % | 1 | 100.0 % | 1 (100.0 %) | 0 |  |  |");
        assert_eq!(rows[10], "| all | 4 | 66.2 % | 2 (50.0 %) | 1 | 50.0 % | 1 (100.0 %) |");
    }
}
