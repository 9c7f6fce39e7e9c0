//! Reliability of the forecasts that a session answers a question: of the questions with a forecast
//! of 80 %, four in five should be answered.

/// Forecast for a question of a proposed session, with its outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnswerForecast {
    /// Forecast probability of an answer.
    pub probability: f64,
    /// Whether the session answered the question.
    pub is_answered: bool,
}

/// Upper bounds of the forecast probability in the rows of the table.
const UPPER_BOUNDS: [f64; 7] = [0.05, 0.2, 0.5, 0.8, 0.95, 0.99, 1.0];

/// Returns the reliability table of both kinds of session, in Markdown: mean forecast and share of
/// answered questions, by forecast probability.
pub(super) fn table_of(proposed: &[AnswerForecast], repeated: &[AnswerForecast]) -> String {
    let mut text = String::from(
        "| forecast probability of an answer | questions of proposed sessions | mean forecast | answered | questions of repeated protocols | mean forecast | answered |\n|---|---|---|---|---|---|---|\n",
    );
    let mut from = 0.0;
    for to in UPPER_BOUNDS {
        let is_last = to >= 1.0;
        let within = |p: f64| p >= from && (p < to || is_last);
        let cells = [proposed, repeated].map(|all| cells(all, within));
        text.push_str(&format!(
            "| {:.0} to {:.0} % | {} | {} |\n",
            100.0 * from,
            100.0 * to,
            cells[0],
            cells[1]
        ));
        from = to;
    }
    text.push_str(&format!("| all | {} | {} |\n", cells(proposed, |_| true), cells(repeated, |_| true)));
    text
}

/// Returns the cells of the forecasts within a range: number, mean forecast, and answered
/// questions.
fn cells(all: &[AnswerForecast], within: impl Fn(f64) -> bool) -> String {
    let group: Vec<&AnswerForecast> = all.iter().filter(|p| within(p.probability)).collect();
    if group.is_empty() {
        return "0 |  | ".to_owned();
    }
    let mean = group.iter().map(|p| p.probability).sum::<f64>() / group.len() as f64;
    let answered = group.iter().filter(|p| p.is_answered).count();
    let share = 100.0 * answered as f64 / group.len() as f64;
    format!("{} | {:.1} % | {answered} ({share:.1} %)", group.len(), 100.0 * mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_question_is_counted_once() {
        let of = |probability, is_answered| AnswerForecast { probability, is_answered };
        let table =
            table_of(&[of(0.0, false), of(0.8, true), of(0.9, false), of(1.0, true)], &[of(0.5, true)]);
        let rows: Vec<&str> = table.lines().skip(2).collect();
        assert_eq!(rows[0], "| 0 to 5 % | 1 | 0.0 % | 0 (0.0 %) | 0 |  |  |");
        assert_eq!(rows[3], "| 50 to 80 % | 0 |  |  | 1 | 50.0 % | 1 (100.0 %) |");
        assert_eq!(rows[4], "| 80 to 95 % | 2 | 85.0 % | 1 (50.0 %) | 0 |  |  |");
        assert_eq!(rows[6], "| 99 to 100 % | 1 | 100.0 % | 1 (100.0 %) | 0 |  |  |");
        assert_eq!(rows[7], "| all | 4 | 67.5 % | 2 (50.0 %) | 1 | 50.0 % | 1 (100.0 %) |");
    }
}
