//! Raw logs: time, force, position and actuator power at 200 Hz.

use pinswitch_diagnostic::{Diagnostic, Location};

/// Samples of one log, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Seconds since the log began.
    pub time_s: Vec<f64>,
    /// Force in newtons.
    pub force_n: Vec<f64>,
    /// Actuator position in millimetres.
    pub position_mm: Vec<f64>,
    /// Actuator power in watts.
    pub power_w: Vec<f64>,
    /// Number of lines without four finite numbers, or with a time that is not later; they are
    /// skipped.
    pub unusable: usize,
}

const COLUMNS: [&str; 4] = ["time_s", "force_N", "position_mm", "power_W"];
/// Fewest usable samples of a log: half a second.
const MIN_SAMPLES: usize = 100;

impl Log {
    /// Parses a log. `file` is its name in errors. Unusable lines are counted and skipped, since
    /// real logs have them.
    ///
    /// # Errors
    /// If the text is UTF-16, a column is missing, or there are fewer than 100 usable samples.
    pub fn parse(text: &[u8], file: &str) -> Result<Self, Diagnostic> {
        // UTF-16 has a byte order mark, or a zero byte in every Latin letter.
        let has_mark = text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff");
        if has_mark || matches!(text, [0, 1..=127, 0, 1..=127, ..] | [1..=127, 0, 1..=127, 0, ..]) {
            return Err(Diagnostic::new("the text is UTF-16")
                .with_location(Location::file(file))
                .with_help("save it as CSV in UTF-8"));
        }
        let mut lines = text.split(|b| *b == b'\n');
        let header = lines.next().unwrap_or_default();
        let header = String::from_utf8_lossy(header);
        let names: Vec<&str> = header
            .trim_start_matches('\u{feff}')
            .trim()
            .split(',')
            .map(|n| n.trim().trim_matches('"'))
            .collect();
        let mut at = [0; 4];
        for (slot, column) in at.iter_mut().zip(COLUMNS) {
            *slot = names.iter().position(|n| *n == column).ok_or_else(|| {
                Diagnostic::new(format!("column '{column}' is missing"))
                    .with_location(Location::in_csv(file, &header, 0, None))
                    .with_help(format!("name the columns {}", COLUMNS.join(", ")))
            })?;
        }
        let mut log = Self::default();
        for line in lines.filter(|l| !l.trim_ascii().is_empty()) {
            let mut values = [f64::NAN; 4];
            for (i, cell) in line.split(|b| *b == b',').enumerate() {
                if let Some(slot) = at.iter().position(|a| *a == i) {
                    values[slot] = std::str::from_utf8(cell.trim_ascii())
                        .ok()
                        .and_then(|c| c.parse().ok())
                        .unwrap_or(f64::NAN);
                }
            }
            let later = log.time_s.last().is_none_or(|last| values[0] > *last);
            if values.iter().all(|v| v.is_finite()) && later {
                log.time_s.push(values[0]);
                log.force_n.push(values[1]);
                log.position_mm.push(values[2]);
                log.power_w.push(values[3]);
            } else {
                log.unusable += 1;
            }
        }
        let count = log.time_s.len();
        if count < MIN_SAMPLES {
            return Err(Diagnostic::new(format!(
                "{count} usable samples, at least {MIN_SAMPLES} are needed"
            ))
            .with_location(Location::file(file))
            .with_help("give a log with one sample every 5 ms"));
        }
        Ok(log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusable_lines_are_counted_and_skipped() {
        let mut text = "power_W,time_s,force_N,position_mm\n".to_owned();
        for i in 0..120 {
            text.push_str(&format!("0,{},1.5,2\n", f64::from(i) * 0.005));
        }
        text.push_str("0,oops,1,2\n0,0.1,1,2\n0,9\n\n");
        let log = Log::parse(text.as_bytes(), "a.csv").unwrap();
        assert_eq!((log.time_s.len(), log.unusable), (120, 3));
        assert_eq!(log.force_n[0], 1.5);
    }

    #[test]
    fn utf16_is_named() {
        let little: Vec<u8> = "time_s,force_N\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = "\u{feff}time_s\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = [b"\xff\xfe".to_vec(), little.clone()].concat();
        for text in [little, big, marked] {
            let error = Log::parse(&text, "a.csv").unwrap_err().to_string();
            assert_eq!(error, "a.csv: the text is UTF-16; save it as CSV in UTF-8");
        }
    }

    #[test]
    fn incomplete_logs_are_refused() {
        let error = Log::parse(b"time_s,force_N\n", "a").unwrap_err();
        assert_eq!(error.problem(), "column 'position_mm' is missing");
        assert!(
            error.render("error").contains("a:1: column 'position_mm' is missing\n  1 | time_s,force_N\n")
        );
        let empty = Log::parse(b"time_s,force_N,position_mm,power_W\n", "a").unwrap_err();
        assert_eq!(empty.problem(), "0 usable samples, at least 100 are needed");
    }
}
