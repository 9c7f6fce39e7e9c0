//! One raw log: time, force, position and actuator power at 200 Hz.

/// Why a log cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// The header lacks a column.
    #[error("{file}, line 1: column '{column}' is missing; a log has time_s, force_N, position_mm, power_W")]
    MissingColumn {
        /// File name as given.
        file: String,
        /// The absent column.
        column: &'static str,
    },
    /// The text is UTF-16, as spreadsheets save it.
    #[error("{file}: is UTF-16 text; save it as CSV in UTF-8")]
    Utf16 {
        /// File name as given.
        file: String,
    },
    /// Too few usable samples.
    #[error("{file}: {found} usable samples; a log has one per 5 ms, at least {needed}")]
    TooShort {
        /// File name as given.
        file: String,
        /// Usable samples found.
        found: usize,
        /// Samples needed.
        needed: usize,
    },
}

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
    /// Lines that hold no four finite numbers or step back in time; they are left out.
    pub unusable: usize,
}

const COLUMNS: [&str; 4] = ["time_s", "force_N", "position_mm", "power_W"];
const MIN: usize = 100;

impl Log {
    /// Reads the text of a log. `file` is the name used in errors. Broken lines are counted and left out:
    /// real logs have them.
    ///
    /// # Errors
    /// [`LogError`] if a column is absent or hardly any sample is usable.
    pub fn parse(text: &[u8], file: &str) -> Result<Self, LogError> {
        // With its mark, or known by the empty half of every Latin letter.
        let has_mark = text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff");
        if has_mark || matches!(text, [0, 1..=127, 0, 1..=127, ..] | [1..=127, 0, 1..=127, 0, ..]) {
            return Err(LogError::Utf16 { file: file.to_owned() });
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
            *slot = names
                .iter()
                .position(|n| *n == column)
                .ok_or(LogError::MissingColumn { file: file.to_owned(), column })?;
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
        if log.time_s.len() < MIN {
            return Err(LogError::TooShort { file: file.to_owned(), found: log.time_s.len(), needed: MIN });
        }
        Ok(log)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_lines_are_counted_and_left_out() {
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
    fn utf16_is_called_by_its_name() {
        let little: Vec<u8> = "time_s,force_N\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = "\u{feff}time_s\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = [b"\xff\xfe".to_vec(), little.clone()].concat();
        for text in [little, big, marked] {
            let said = Log::parse(&text, "a.csv").unwrap_err().to_string();
            assert_eq!(said, "a.csv: is UTF-16 text; save it as CSV in UTF-8");
        }
    }

    #[test]
    fn absent_columns_and_empty_logs_are_refused() {
        assert!(matches!(Log::parse(b"time_s,force_N\n", "a"), Err(LogError::MissingColumn { .. })));
        let empty = Log::parse(b"time_s,force_N,position_mm,power_W\n", "a");
        assert!(matches!(empty, Err(LogError::TooShort { found: 0, .. })));
    }
}
